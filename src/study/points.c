/* From factors to points, and what names the runs of these. */
#include "base/file.h"
#include "base/number.h"
#include "base/platform.h"
#include "scene/file.h"
#include "study/design.h"
#include "study/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- values ---- */

/* The value at u in [0, 1): a level, or a number of the range, whole where the key takes no other.
 */
static const char *value_at(scree_study *study, const scree_factor *f, double u) {
  if (!f->range) return f->levels[(size_t)(u * (double)f->level_count)];
  double value =
      f->logarithmic ? f->from * pow(f->to / f->from, u) : f->from + u * (f->to - f->from);
  char text[SCREE_NUMBER_SIZE];
  scree_number_format_digits(value, 9, text);
  bool fits = study->command.count || scree_study_is_own(study, f->key) ||
              scree_study_try(study, f->key, text, NULL) == SCREE_OK;
  if (!fits) snprintf(text, sizeof text, "%.0f", value);
  return scree_arena_text(&study->arena, text);
}

static const char *grid_value(const scree_study *study, size_t point, size_t factor) {
  if (study->design == SCREE_DESIGN_LIST) return study->factors[factor].levels[point];
  for (size_t f = study->factor_count; f-- > factor + 1;) point /= study->factors[f].level_count;
  const scree_factor *f = &study->factors[factor];
  return f->levels[point % f->level_count];
}

static size_t set_of(const scree_factor *f, const char *value) {
  for (size_t i = 0; i < f->level_count; i++)
    if (!strcmp(f->levels[i], value)) return f->sets[i];
  return 0;
}

static const char *make_label(scree_study *study, const char **values) {
  size_t size = 1;
  for (size_t f = 0; f < study->factor_count; f++)
    size += strlen(study->factors[f].key) + strlen(values[f]) + 3;
  char *label = scree_arena_take(&study->arena, size, 1), *end = label;
  if (!label) return NULL;
  *end = 0;
  for (size_t f = 0; f < study->factor_count; f++)
    end += snprintf(end, size - (size_t)(end - label), "%s%s %s", f ? ", " : "",
                    study->factors[f].key, values[f]);
  return label;
}

/* Checks what only a point's values together can say. */
static scree_status check_point(const scree_study *study, const scree_study_point *point,
                                scree_error *error) {
  SCREE_OWNED(scree_scene_file, file);
  scree_error reason;
  if (study->command.count) return SCREE_OK; /* its values are the command's to judge */
  SCREE_TRY(scree_study_scene(study, point, &file, error));
  scree_status status = scree_scene_file_check(file, &reason);
  if (status == SCREE_OK) return SCREE_OK;
  return scree_fail(error, status, "%s: at the point %s: %.500s", study->path, point->label,
                    reason.message);
}

static scree_status make_point(scree_study *study, size_t index, const double *unit,
                               scree_error *error) {
  scree_study_point *point = &study->points[index];
  *point = (scree_study_point){.rp = "scan"};
  SCREE_TRY_TAKE(point->values, &study->arena, study->factor_count, error);
  for (size_t f = 0; f < study->factor_count; f++) {
    const scree_factor *factor = &study->factors[f];
    point->values[f] = unit ? value_at(study, factor, unit[index * study->factor_count + f])
                            : grid_value(study, index, f);
    if (!point->values[f]) return scree_fail_memory(error, 0, study->path);
    if (!scree_study_is_own(study, factor->key)) continue;
    if (!strcmp(factor->key, "rp")) point->rp = point->values[f];
    if (!strcmp(factor->key, "shapes")) point->set = set_of(factor, point->values[f]);
  }
  point->label = make_label(study, point->values);
  if (!point->label) return scree_fail_memory(error, 0, study->path);
  return check_point(study, point, error);
}

scree_status scree_study_make_points(scree_study *study, scree_error *error) {
  size_t dimensions = study->factor_count, *order = NULL;
  double *unit = NULL;
  study->point_count = study->wanted_points;
  if (study->design == SCREE_DESIGN_LIST) {
    study->point_count = study->factors[0].level_count;
  } else if (study->design == SCREE_DESIGN_GRID) {
    study->point_count = 1;
    for (size_t f = 0; f < dimensions; f++) study->point_count *= study->factors[f].level_count;
  } else {
    SCREE_TRY_TAKE(unit, &study->arena, study->point_count * dimensions, error);
    SCREE_TRY_TAKE(order, &study->arena, study->point_count, error);
  }
  SCREE_TRY_TAKE(study->points, &study->arena, study->point_count, error);
  if (study->design == SCREE_DESIGN_LATIN)
    scree_design_latin(study->seed, study->point_count, dimensions, order, unit);
  if (study->design == SCREE_DESIGN_SOBOL)
    scree_design_sobol(study->seed, study->point_count, dimensions, unit);
  for (size_t i = 0; i < study->point_count; i++) SCREE_TRY(make_point(study, i, unit, error));
  return SCREE_OK;
}

/* ---- runs ---- */

/* Whether a path is that of one of the study's own shapes, which their checksums name. */
static bool is_own_file(const scree_study *study, const char *path) {
  for (size_t i = 0; i < study->shape_count; i++)
    if (!strcmp(study->shapes[i].word, path)) return true;
  return false;
}

static scree_status write_files(const scree_study *study, const scree_scene_file *file,
                                FILE *stream, scree_error *error) {
  for (size_t i = 0;; i++) {
    char path[4096], sum[SCREE_CHECKSUM_TEXT];
    SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
    size_t count;
    SCREE_TRY(scree_scene_file_find_input(file, i, path, sizeof path, error));
    if (!*path) return SCREE_OK;
    if (is_own_file(study, path)) continue;
    SCREE_TRY(scree_file_read(path, 0, &bytes, &count, error));
    fprintf(stream, "file=%s\n", scree_checksum_text(scree_checksum_of(bytes, count), sum));
  }
}

/* The same of a command: its words. */
static scree_status write_command_identity(const scree_study *study, size_t run, FILE *stream,
                                           scree_error *error) {
  char text[1024];
  for (size_t i = 0; i < study->command.count; i++) {
    SCREE_TRY(scree_study_command_word(study, run, i, NULL, text, sizeof text, error));
    fprintf(stream, "word=%s\n", text);
  }
  return SCREE_OK;
}

/* Everything that the run's numbers follow from, as text: the scene but for how often it is
 * written, the files that it names, the shapes' checksums and what is made of them. */
static scree_status write_identity(const scree_study *study, size_t run, FILE *stream,
                                   scree_error *error) {
  SCREE_OWNED(scree_scene_file, file);
  char unit[SCREE_NUMBER_SIZE];
  if (study->command.count) return write_command_identity(study, run, stream, error);
  SCREE_TRY(scree_study_run_scene(study, run, &file, error));
  SCREE_TRY(scree_scene_file_set(file, "output.frames", "0", error));
  SCREE_TRY(scree_scene_file_set(file, "output.checkpoint", "60", error));
  SCREE_TRY(scree_scene_file_print(file, stream, error));
  SCREE_TRY(write_files(study, file, stream, error));
  if (!study->own_shapes) return SCREE_OK;
  scree_number_format_digits(study->unit_m, 9, unit);
  fprintf(stream, "unit=%s\n", unit);
  const scree_shape_set *set = &study->sets[study->points[scree_study_run_point(study, run)].set];
  for (size_t i = 0; i < set->count; i++) {
    char sum[SCREE_CHECKSUM_TEXT];
    scree_checksum_text(study->shapes[set->shapes[i]].checksum, sum);
    fprintf(stream, "shape=%s\n", sum);
  }
  return SCREE_OK;
}

static scree_status make_key(const scree_study *study, size_t run, char key[SCREE_RUN_KEY_BYTES],
                             scree_error *error) {
  char *text = NULL;
  size_t size = 0;
  FILE *stream = scree_memory_open(&text, &size);
  scree_status status = stream ? write_identity(study, run, stream, error)
                               : scree_fail_memory(error, 0, "a run's name");
  bool good = stream && !ferror(stream);
  if (stream && !scree_memory_close(stream)) good = false;
  if (status == SCREE_OK && (!good || !text))
    status = scree_fail_memory(error, size, "a run's name");
  if (status == SCREE_OK)
    snprintf(key, SCREE_RUN_KEY_BYTES, "%016llx",
             (unsigned long long)scree_checksum_of(text, size).high);
  free(text);
  return status;
}

scree_status scree_study_make_keys(scree_study *study, scree_error *error) {
  size_t count = scree_study_run_count(study);
  if (study->keys) return SCREE_OK;
  SCREE_CLEANUP(scree_free_at) char(*keys)[SCREE_RUN_KEY_BYTES] = NULL;
  SCREE_TRY_ALLOC(keys, count, error);
  for (size_t i = 0; i < count; i++) SCREE_TRY(make_key(study, i, keys[i], error));
  study->keys = keys;
  keys = NULL;
  return SCREE_OK;
}

scree_status scree_study_get_run(const scree_study *study, size_t index, scree_study_run *run,
                                 scree_error *error) {
  if (index >= scree_study_run_count(study))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "run %zu: the study has %zu", index,
                      scree_study_run_count(study));
  size_t point = scree_study_run_point(study, index);
  *run = (scree_study_run){.point = point,
                           .replicate = scree_study_run_replicate(study, index),
                           .seed = scree_study_run_seed(study, index),
                           .label = study->points[point].label,
                           .rp = study->points[point].rp,
                           .shapes = study->sets[study->points[point].set].label,
                           .key = study->keys ? study->keys[index] : NULL};
  return SCREE_OK;
}
