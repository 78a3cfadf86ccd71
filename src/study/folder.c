/* A study's folder:
 *
 *   study.yaml      the file as last given
 *   scene.yaml      of a scene its text, and where it came from
 *   shapes/         NAME.yaml: what was found; NAME-LEVEL.ply: the particles' surfaces, in metres
 *   leases/         who works on what
 *   runs/KEY/       checkpoint while a run is on, last frame after it
 *   results/        KEY.yaml: a run that ended
 *   study.sqlite    all of it as tables
 */
#include "base/file.h"
#include "base/platform.h"
#include "study/study.h"

#include <string.h>

scree_study_options scree_default_study_options(void) {
  return (scree_study_options){.lease_s = 300, .poll_s = 1, .wait = true};
}

const char *scree_study_path(const scree_study *study, const char *kind, const char *name,
                             const char *ending, char path[SCREE_PATH_BYTES]) {
  snprintf(path, SCREE_PATH_BYTES, "%s/%s%s%s%s", study->folder, kind, *kind && *name ? "/" : "",
           name, ending);
  return path;
}

static scree_status make_folders(const scree_study *study, scree_error *error) {
  static const char *const kinds[] = {"shapes", "leases", "runs", "results"};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    SCREE_TRY(scree_folder_create(SCREE_STUDY_PATH(study, kinds[i], "", ""), error));
  return SCREE_OK;
}

/* Writes the copy where it is not the same already, so that a folder in use is left alone. */
static scree_status keep_copy(const scree_study *study, scree_error *error) {
  const char *path = SCREE_STUDY_PATH(study, "", "study.yaml", "");
  char *old = NULL;
  size_t size = 0;
  bool same = scree_path_exists(path) && scree_file_read(path, 0, &old, &size, NULL) == SCREE_OK &&
              size == study->text_size && !memcmp(old, study->text, size);
  scree_free(old);
  return same ? SCREE_OK : scree_text_write(study->text, path, true, error);
}

scree_status scree_study_open(scree_study *study, const char *folder, scree_error *error) {
  char *copy = scree_strdup(folder);
  if (!copy) return scree_fail_memory(error, strlen(folder), "a path");
  scree_free(study->folder);
  study->folder = copy;
  SCREE_TRY(make_folders(study, error));
  SCREE_TRY(keep_copy(study, error));
  return scree_study_keep_scene(study, error);
}

scree_status scree_study_open_folder(const char *folder, scree_study **study, scree_error *error) {
  const char *path = SCREE_PATH_IN(folder, "study.yaml");
  scree_study *made = NULL;
  scree_status status =
      scree_path_exists(path)
          ? scree_study_read(path, &made, error)
          : scree_fail(error, SCREE_IO, "%s: is no folder of a study: no study.yaml in it", folder);
  if (status == SCREE_OK && !(made->folder = scree_strdup(folder)))
    status = scree_fail_memory(error, strlen(folder), "a path");
  if (status == SCREE_OK) status = scree_study_know_shapes(made, error);
  if (status == SCREE_OK)
    *study = made;
  else
    scree_study_free(made);
  return status;
}
