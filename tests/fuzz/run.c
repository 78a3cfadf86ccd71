/* Checkpoints and frames of runs with lengths and checksums made to fit, those of the worlds in
 * them too: refused in a sentence, or a run that can be asked, measured, advanced and freed. */
#define _GNU_SOURCE /* memfd_create, memmem */
#include "fuzz/files.h"
#include "fuzz/forge.h"
#include "scree.h"

#include <string.h>

enum { MOST_BYTES = 1 << 16 };

/* Worlds first: a world's length stands before it. */
static void forge(uint8_t *bytes, size_t size) {
  for (uint8_t *world = bytes + FORGE_HEADER;
       (world = memmem(world, size - (size_t)(world - bytes), "screeWLD", 8)); world++) {
    uint64_t length = forge_get(world - 8);
    if (length >= FORGE_HEADER && length <= size - (size_t)(world - bytes))
      forge_header(world, (size_t)length);
  }
  forge_header(bytes, size);
}

static void use(scree_run *run) {
  scree_error error = {0};
  scree_run_result result;
  scree_run_costs costs;
  size_t count;
  scree_run_series(run, &count);
  scree_run_get_costs(run, &costs);
  for (size_t i = 0; i < scree_world_body_count(scree_run_view(run)); i++)
    FUZZ_CHECK(scree_run_body_shape(run, i) < scree_run_shape_count(run));
  scree_status status = scree_run_measure(run, &result, &error);
  FUZZ_CHECK(status == SCREE_OK || error.message[0]);
  if (scree_world_body_count(scree_run_view(run)) > 50) return;
  status = scree_run_advance(run, 2, &error);
  FUZZ_CHECK(status == SCREE_OK || error.message[0]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static uint8_t forged[MOST_BYTES];
  scree_run *run = NULL;
  scree_error error = {0};
  size_t used = scree_memory_used();
  char path[64];
  if (size < FORGE_HEADER || size > MOST_BYTES) return 0;
  memcpy(forged, data, size);
  forge(forged, size);
  scree_set_threads(1);
  int fd = fuzz_file(forged, size, path);
  scree_status status = scree_run_load(path, &run, &error);
  close(fd);
  FUZZ_CHECK(status == SCREE_OK || status == SCREE_BAD_FILE || status == SCREE_BAD_ARGUMENT);
  FUZZ_CHECK(status == SCREE_OK || (error.message[0] && !strchr(error.message, '\n') && !run));
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK) use(run);
  scree_run_free(run);
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
