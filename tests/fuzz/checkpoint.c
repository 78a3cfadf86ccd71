/* Checkpoints with the length and the checksum made to fit, as who forges one would: refused in a
 * sentence, or a world that packs to bytes that load to the same world, and that can be asked,
 * stepped and freed. */
#include "world/step/checkpoint.h"
#include "base/alloc.h"
#include "fuzz/forge.h"
#include "world/state/save.h"

#include <string.h>

enum { MOST_BYTES = 1 << 16 };

static void use(scree_world *world) {
  unsigned char *bytes = NULL;
  size_t count;
  scree_error error;
  scree_world *again = NULL;
  scree_observation seen;
  scree_checksum hash = scree_world_hash(world);
  FUZZ_CHECK(scree_world_pack(world, true, &bytes, &count, &error) == SCREE_OK);
  FUZZ_CHECK(scree_world_unpack(bytes, count, "again", &again, &error) == SCREE_OK);
  scree_checksum same = scree_world_hash(again);
  FUZZ_CHECK(hash.high == same.high && hash.low == same.low);
  scree_free(bytes);
  scree_world_free(again);
  scree_world_observe(world, &seen);
  scree_status status = scree_world_step(world, 2, &error);
  FUZZ_CHECK(status == SCREE_OK || (status == SCREE_DIVERGED && error.message[0]));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static uint8_t forged[MOST_BYTES];
  scree_world *world = NULL;
  scree_error error = {0};
  size_t used = scree_memory_used();
  if (size < FORGE_HEADER || size > MOST_BYTES) return 0;
  memcpy(forged, data, size);
  forge_header(forged, size);
  scree_set_threads(1);
  scree_status status = scree_world_unpack(forged, size, "fuzz", &world, &error);
  FUZZ_CHECK(status == SCREE_OK || (status == SCREE_BAD_FILE && error.message[0] && !world));
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK) use(world);
  scree_world_free(world);
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
