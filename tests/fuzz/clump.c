/* Tables of spheres: a particle, or a sentence. */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz/files.h"
#include "scree.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  scree_particle *particle = NULL;
  scree_error error = {0};
  size_t used = scree_memory_used();
  char path[64];
  int fd = fuzz_file(data, size, path);
  scree_status status = scree_particle_clump_read(path, NULL, &particle, &error);
  close(fd);
  FUZZ_CHECK(status == SCREE_OK || (error.message[0] && !strchr(error.message, '\n')));
  FUZZ_CHECK((status == SCREE_OK) == (particle != NULL));
  fuzz_taken += status == SCREE_OK;
  scree_particle_free(particle);
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
