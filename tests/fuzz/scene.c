/* Checkpoints and frames of scenes with lengths and checksums made to fit, those of the worlds in
 * them too: refused in a sentence, or a scene that can be asked, measured, advanced and freed. */
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

static void use(scree_scene *scene) {
  scree_error error = {0};
  size_t count, shapes = 0;
  (void)scree_scene_series(scene, &count);
  while (scree_scene_shape_name(scene, shapes)) shapes++;
  for (size_t i = 0; i < scree_world_body_count(scree_scene_view(scene)); i++)
    FUZZ_CHECK(scree_scene_body_shape(scene, i) < shapes);
  for (size_t i = 0; scree_scene_pile_name(scene, i); i++) {
    scree_pile pile;
    scree_status status = scree_scene_measure_pile(scene, i, NULL, &pile, &error);
    FUZZ_CHECK(status == SCREE_OK || error.message[0]);
  }
  if (scree_world_body_count(scree_scene_view(scene)) > 50) return;
  scree_status status = scree_scene_advance(scene, 2, &error);
  FUZZ_CHECK(status == SCREE_OK || error.message[0]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static uint8_t forged[MOST_BYTES];
  scree_scene *scene = NULL;
  scree_error error = {0};
  size_t used = scree_memory_used();
  char path[64];
  if (size < FORGE_HEADER || size > MOST_BYTES) return 0;
  memcpy(forged, data, size);
  forge(forged, size);
  scree_set_threads(1);
  int fd = fuzz_file(forged, size, path);
  scree_status status = scree_scene_load(path, &scene, &error);
  close(fd);
  FUZZ_CHECK(status == SCREE_OK || status == SCREE_BAD_FILE || status == SCREE_BAD_ARGUMENT);
  FUZZ_CHECK(status == SCREE_OK || (error.message[0] && !strchr(error.message, '\n') && !scene));
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK) use(scene);
  scree_scene_free(scene);
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
