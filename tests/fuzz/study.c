/* Studies' files: refused in a sentence, or a plan all of whose runs can be told and made. */
#define _GNU_SOURCE /* memfd_create */
#include "study/study.h"
#include "fuzz/files.h"

#include <math.h>
#include <string.h>

enum { LOOKED_AT = 50 }; /* runs, from the first to the last */

static void look_at(const scree_study *study) {
  size_t count = scree_study_run_count(study);
  FUZZ_CHECK(count > 0 && count == study->point_count * study->replicate_count);
  for (size_t i = 0; i < LOOKED_AT; i++) {
    size_t index = (count - 1) / (LOOKED_AT - 1) * i;
    scree_study_run run;
    scree_scene_file *file;
    scree_error error;
    FUZZ_CHECK(scree_study_get_run(study, index, &run, &error) == SCREE_OK);
    FUZZ_CHECK(run.point < study->point_count && run.replicate < study->replicate_count);
    FUZZ_CHECK(study->points[run.point].set < study->set_count);
    FUZZ_CHECK(scree_study_run_scene(study, index, &file, &error) == SCREE_OK);
    FUZZ_CHECK(scree_scene_file_check(file, &error) == SCREE_OK);
    scree_scene_file_free(file);
  }
  for (size_t i = 0; i < study->shape_count; i++) FUZZ_CHECK(!strchr(study->shapes[i].name, '/'));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  scree_study *study = NULL;
  scree_error error = {0};
  size_t used = scree_memory_used();
  char path[64];
  int fd = fuzz_file(data, size, path);
  scree_status status = scree_study_read(path, &study, &error);
  close(fd);
  FUZZ_CHECK(status == SCREE_OK || status == SCREE_BAD_FILE || status == SCREE_BAD_ARGUMENT);
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK)
    look_at(study);
  else
    FUZZ_CHECK(error.message[0] && !strchr(error.message, '\n') && !study);
  scree_study_free(study);
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
