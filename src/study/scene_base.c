/* Studies whose base is a scene: its file with any field as a factor, and any column of its sensors
 * as an answer. The scene stands in the study as its own text, with every default. */
#include "base/file.h"
#include "base/platform.h"
#include "study/outline.h"
#include "study/record.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static const char copy_name[] = "scene.yaml";

/* ---- the file ---- */

static const char copy_mark[] = "# scene of ";

/* Beside the study's file; in a study's folder its copy. To be freed; NULL when memory is out. */
static char *scene_path(const scree_study *study, const char *name) {
  const char *slash = strrchr(study->path, '/');
  int folder = slash ? (int)(slash + 1 - study->path) : 0;
  size_t size = (size_t)folder + strlen(name) + sizeof copy_name + 1;
  char *path = scree_alloc(size, 1);
  if (!path) return NULL;
  snprintf(path, size, "%.*s%s", *name == '/' ? 0 : folder, study->path, name);
  if (scree_path_exists(path)) return path;
  char *copy = scree_alloc(size, 1);
  if (copy) snprintf(copy, size, "%.*s%s", folder, study->path, copy_name);
  if (!copy || !scree_path_exists(copy)) {
    scree_free(copy);
    return path;
  }
  scree_free(path);
  return copy;
}

/* A copy's first line says where its original lies, beside which the files are that it names. */
static scree_status keep_text(scree_study *study, const char *path, const char *text,
                              scree_error *error) {
  char original[4096] = "";
  if (!strncmp(text, copy_mark, sizeof copy_mark - 1)) {
    text += sizeof copy_mark - 1;
    snprintf(original, sizeof original, "%.*s", (int)strcspn(text, "\n"), text);
    text += strcspn(text, "\n");
    text += *text != 0;
    path = original;
  }
  study->scene_text = scree_arena_text(&study->arena, text);
  study->scene_path = scree_arena_text(&study->arena, path);
  return study->scene_text && study->scene_path ? SCREE_OK : scree_fail_memory(error, 0, path);
}

scree_status scree_study_read_scene(scree_study *study, const char *name, scree_error *error) {
  char *path = scene_path(study, name), *bytes;
  size_t count;
  if (!path) return scree_fail_memory(error, strlen(name), "a path");
  scree_status status = scree_file_read(path, 1 << 20, &bytes, &count, error);
  if (status == SCREE_OK) {
    status = keep_text(study, path, bytes, error);
    scree_free(bytes);
  }
  scree_free(path);
  return status;
}

scree_status scree_study_scene(const scree_study *study, const char *const *values,
                               scree_scene_file **file, scree_error *error) {
  scree_scene_file *made = NULL;
  scree_status status = scree_scene_file_parse(study->scene_text, strlen(study->scene_text),
                                               study->scene_path, &made, error);
  for (size_t i = 0; status == SCREE_OK && i < study->setting_count; i++)
    status = scree_scene_file_set(made, study->settings[i][0], study->settings[i][1], error);
  for (size_t f = 0; status == SCREE_OK && values && f < study->factor_count; f++)
    status = scree_scene_file_set(made, study->factors[f].key, values[f], error);
  if (status == SCREE_OK)
    *file = made;
  else
    scree_scene_file_free(made);
  return status;
}

scree_status scree_study_run_scene(const scree_study *study, size_t run, scree_scene_file **file,
                                   scree_error *error) {
  const scree_study_point *point = &study->points[scree_study_run_point(study, run)];
  char seed[32];
  scree_status status = scree_study_scene(study, point->values, file, error);
  if (status != SCREE_OK) return status;
  snprintf(seed, sizeof seed, "%" PRIu64, scree_study_run_seed(study, run));
  status = scree_scene_file_set(*file, "seed", seed, error);
  if (status != SCREE_OK) scree_scene_file_free(*file);
  return status;
}

scree_status scree_study_try_scene(const scree_study *study, const char *key, const char *value,
                                   scree_error *error) {
  scree_scene_file *file;
  scree_status status = scree_study_scene(study, NULL, &file, error);
  if (status == SCREE_OK) {
    status = scree_scene_file_set(file, key, value, error);
    if (status == SCREE_OK) status = scree_scene_file_check(file, error);
    scree_scene_file_free(file);
  }
  return status;
}

scree_status scree_study_keep_scene(const scree_study *study, scree_error *error) {
  char full[4096], *path;
  if (!study->scene_text) return SCREE_OK;
  if (!scree_path_full(study->scene_path, full, sizeof full))
    return scree_fail(error, SCREE_IO, "%s: cannot be found", study->scene_path);
  if (!(path = scree_study_path(study, "", copy_name, "")))
    return scree_fail_memory(error, 0, "a path");
  scree_output output;
  scree_status status = scree_output_open(path, true, &output, error);
  if (status == SCREE_OK) {
    fprintf(output.stream, "%s%s\n%s", copy_mark, full, study->scene_text);
    status = scree_output_commit(&output, error);
  }
  scree_free(path);
  return status;
}

/* ---- answers ---- */

bool scree_study_has_column(const scree_study *study, const char *column) {
  scree_scene_file *file;
  char name[96] = "?";
  bool found = false;
  if (scree_study_scene(study, NULL, &file, NULL) != SCREE_OK) return false;
  for (size_t i = 0; !found && *name; i++) {
    if (scree_scene_file_column(file, i, name, NULL) != SCREE_OK) break;
    found = !strcmp(name, column);
  }
  scree_scene_file_free(file);
  return found;
}

const char *scree_study_sensor_names(const scree_study *study) {
  static const char none[] = "not known";
  scree_scene_file *file;
  char name[96] = "?", list[400] = "";
  if (scree_study_scene(study, NULL, &file, NULL) != SCREE_OK) return none;
  for (size_t i = 0; *name && scree_scene_file_column(file, i, name, NULL) == SCREE_OK; i++) {
    size_t used = strlen(list);
    if (strchr(name, '.'))
      snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "", name);
  }
  scree_scene_file_free(file);
  scree_study *owner = (scree_study *)(uintptr_t)study; /* its arena keeps the text */
  const char *kept = scree_arena_text(&owner->arena, list);
  return kept ? kept : none;
}

/* Between two rows of the series as on a straight line. */
static double value_at(const double *series, size_t rows, size_t columns, size_t k, double time) {
  size_t i = 0;
  while (i < rows && series[i * columns] < time) i++;
  if (i == rows) return NAN;
  const double *row = series + i * columns, *before = i ? row - columns : row;
  if (i == 0 && row[0] > time) return NAN;
  double part = row[0] > before[0] ? (time - before[0]) / (row[0] - before[0]) : 1;
  return part == 1 ? row[k] : before[k] + part * (row[k] - before[k]);
}

static double answer_of(const scree_answer *answer, const scree_scene *scene) {
  size_t rows, columns = scree_scene_column_count(scene), k = 0, count = 0;
  const double *series = scree_scene_series(scene, &rows);
  double sum = 0;
  if (answer->outline) return scree_outline_height(scree_scene_view(scene), answer->at);
  while (k < columns && strcmp(scree_scene_column_name(scene, k), answer->column) != 0) k++;
  if (k == columns || rows == 0) return NAN;
  if (!isnan(answer->at)) return value_at(series, rows, columns, k, answer->at);
  if (!answer->mean) return series[(rows - 1) * columns + k];
  for (size_t i = 0; i < rows; i++) {
    double time = series[i * columns], value = series[i * columns + k];
    if (time < answer->from || time > answer->until || isnan(value)) continue;
    sum += value;
    count++;
  }
  return count ? sum / (double)count : (double)NAN;
}

scree_status scree_study_record_scene(const scree_study *study, scree_scene *scene,
                                      scree_study_record *record, scree_error *error) {
  const scree_world *world = scree_scene_view(scene);
  scree_scene_book book;
  scree_scene_get_book(scene, &book);
  scree_checksum_text(scree_world_hash(world), record->hash);
  record->answers = scree_alloc(study->answer_count, sizeof *record->answers);
  if (!record->answers) return scree_fail_memory(error, 0, "a run's answers");
  record->answer_count = study->answer_count;
  for (size_t i = 0; i < study->answer_count; i++)
    record->answers[i] = answer_of(&study->answers[i], scene);
  scree_observation o;
  scree_world_observe(world, &o);
  record->costs.time_step = scree_world_time_step(world, NULL);
  record->costs.step_count = scree_world_step_count(world);
  record->costs.piece_count = 1;
  record->costs.largest_overlap = o.largest_overlap;
  record->result = scree_no_result();
  record->result.body_count = book.inside_count;
  record->result.left_count = book.left_count;
  record->result.coordination = o.coordination;
  record->result.kinetic = o.kinetic + o.rotational;
  record->result.time = o.time;
  return SCREE_OK;
}
