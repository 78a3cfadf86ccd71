/* A study takes its folder, or is found in one. */
#include "base/file.h"
#include "base/platform.h"
#include "study/study.h"

#include <string.h>

static scree_status make_folders(const scree_study *study, scree_error *error) {
  static const char *const kinds[] = {"shapes", "leases", "runs", "results"};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    SCREE_TRY(scree_folder_create(SCREE_STUDY_PATH(study, kinds[i], "", ""), error));
  return SCREE_OK;
}

scree_status scree_study_open(scree_study *study, const char *folder, scree_error *error) {
  char *copy = scree_strdup(folder);
  if (!copy) return scree_fail_memory(error, strlen(folder), "a path");
  scree_free(study->folder);
  study->folder = copy;
  SCREE_TRY(make_folders(study, error));
  SCREE_TRY(
      scree_study_keep_text(study->text, SCREE_STUDY_PATH(study, "", "study.yaml", ""), error));
  return scree_study_keep_scene(study, error);
}

scree_status scree_study_open_folder(const char *folder, scree_study **study, scree_error *error) {
  const char *path = SCREE_PATH_IN(folder, "study.yaml");
  SCREE_OWNED(scree_study, made);
  if (!scree_path_exists(path))
    return scree_fail(error, SCREE_IO, "%s: is no folder of a study: no study.yaml in it", folder);
  SCREE_TRY(scree_study_read(path, &made, error));
  if (!(made->folder = scree_strdup(folder)))
    return scree_fail_memory(error, strlen(folder), "a path");
  SCREE_TRY(scree_study_know_shapes(made, error));
  *study = made;
  made = NULL;
  return SCREE_OK;
}
