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

scree_status scree_study_pause(const scree_study_options *options, const scree_progress *progress,
                               const char *what, scree_error *error) {
  scree_sleep(options->poll_s);
  if (progress && progress->report && !progress->report(progress->context, what, 0))
    return scree_fail(error, SCREE_CANCELLED, "cancelled");
  return SCREE_OK;
}

const char *scree_study_path(const scree_study *study, const char *kind, const char *name,
                             const char *ending, char path[SCREE_PATH_BYTES]) {
  snprintf(path, SCREE_PATH_BYTES, "%s/%s%s%s%s", study->folder, kind, *kind && *name ? "/" : "",
           name, ending);
  return path;
}

scree_status scree_study_keep_text(const char *text, const char *path, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) char *old = NULL;
  size_t size = 0;
  bool same = scree_path_exists(path) && scree_file_read(path, 0, &old, &size, NULL) == SCREE_OK &&
              size == strlen(text) && !memcmp(old, text, size);
  return same ? SCREE_OK : scree_text_write(text, path, true, error);
}
