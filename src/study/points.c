/* From factors to points, from points to runs. Run r is point r mod P in replicate r / P, so that
 * every point has its first replicate before any has its second; its seed is the study's plus the
 * replicate's number: one run can be repeated by `seed` alone, more replicates leave the earlier
 * ones as they were, and the same seeds at all points only matter before the first contact. */
#include "base/file.h"
#include "base/number.h"
#include "base/platform.h"
#include "study/design.h"
#include "study/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char friction[] = "contact.friction"; /* both: particle on particle and on wall */

scree_status scree_study_set(scree_experiment *experiment, const char *key, const char *value,
                             scree_error *error) {
  if (strcmp(key, friction) != 0) return scree_experiment_set(experiment, key, value, error);
  scree_status status = scree_experiment_set(experiment, "contact.friction_particle", value, error);
  if (status != SCREE_OK) return status;
  return scree_experiment_set(experiment, "contact.friction_wall", value, error);
}

/* ---- values ---- */

/* The value at u in [0, 1): a level, or a number of the range, whole where the key takes no other.
 */
static const char *value_at(scree_study *study, const scree_factor *f, double u) {
  if (!f->range) return f->levels[(size_t)(u * (double)f->level_count)];
  double value =
      f->logarithmic ? f->from * pow(f->to / f->from, u) : f->from + u * (f->to - f->from);
  char text[SCREE_NUMBER_SIZE];
  scree_experiment copy = study->base;
  scree_number_format_digits(value, 9, text);
  bool fits = study->command.count ? true
              : study->scene_text
                  ? scree_study_try_scene(study, f->key, text, NULL) == SCREE_OK
                  : !strcmp(f->key, "rp") || scree_study_set(&copy, f->key, text, NULL) == SCREE_OK;
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

static scree_status check_scene_point(const scree_study *study, const scree_study_point *point,
                                      scree_error *error) {
  scree_scene_file *file;
  scree_error reason;
  scree_status status = scree_study_scene(study, point->values, &file, error);
  if (status != SCREE_OK) return status;
  status = scree_scene_file_check(file, &reason);
  scree_scene_file_free(file);
  if (status == SCREE_OK) return SCREE_OK;
  return scree_fail(error, status, "%s: at the point %s: %.500s", study->path, point->label,
                    reason.message);
}

/* Checks what only a point's values together can say. */
static scree_status check_point(scree_study *study, const scree_study_point *point,
                                scree_error *error) {
  if (study->scene_text) return check_scene_point(study, point, error);
  if (study->command.count) return SCREE_OK; /* its values are the command's to judge */
  scree_experiment copy = study->base;
  scree_error reason;
  for (size_t f = 0; f < study->factor_count; f++) {
    const char *key = study->factors[f].key;
    if (!strcmp(key, "rp") || !strcmp(key, "shapes")) continue;
    scree_status status = scree_study_set(&copy, key, point->values[f], error);
    if (status != SCREE_OK) return status;
  }
  if (scree_experiment_check(&copy, &reason) == SCREE_OK) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_FILE, "%s: at the point %s: %.500s", study->path, point->label,
                    reason.message);
}

static scree_status make_point(scree_study *study, size_t index, const double *unit,
                               scree_error *error) {
  scree_study_point *point = &study->points[index];
  *point = (scree_study_point){.rp = "scan"};
  point->values = scree_arena_take(&study->arena, study->factor_count, sizeof *point->values);
  if (!point->values) return scree_fail_memory(error, 0, study->path);
  for (size_t f = 0; f < study->factor_count; f++) {
    const scree_factor *factor = &study->factors[f];
    point->values[f] = unit ? value_at(study, factor, unit[index * study->factor_count + f])
                            : grid_value(study, index, f);
    if (!point->values[f]) return scree_fail_memory(error, 0, study->path);
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
    unit = scree_arena_take(&study->arena, study->point_count * dimensions, sizeof *unit);
    order = scree_arena_take(&study->arena, study->point_count, sizeof *order);
    if (!unit || !order) return scree_fail_memory(error, 0, study->path);
  }
  study->points = scree_arena_take(&study->arena, study->point_count, sizeof *study->points);
  if (!study->points) return scree_fail_memory(error, 0, study->path);
  if (study->design == SCREE_DESIGN_LATIN)
    scree_design_latin(study->seed, study->point_count, dimensions, order, unit);
  if (study->design == SCREE_DESIGN_SOBOL)
    scree_design_sobol(study->seed, study->point_count, dimensions, unit);
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < study->point_count; i++)
    status = make_point(study, i, unit, error);
  return status;
}

/* ---- runs ---- */

uint64_t scree_study_run_seed(const scree_study *study, size_t run) {
  const scree_study_point *point = &study->points[scree_study_run_point(study, run)];
  uint64_t seed = study->seed;
  for (size_t f = 0; f < study->factor_count; f++)
    if (!strcmp(study->factors[f].key, "seed")) seed = strtoull(point->values[f], NULL, 10);
  return seed + scree_study_run_replicate(study, run);
}

scree_status scree_study_experiment(const scree_study *study, size_t run,
                                    scree_experiment *experiment, scree_error *error) {
  const scree_study_point *point = &study->points[scree_study_run_point(study, run)];
  scree_experiment made;
  scree_status status = scree_experiment_copy(&study->base, &made, error);
  if (status != SCREE_OK) return status;
  for (size_t f = 0; status == SCREE_OK && f < study->factor_count; f++) {
    const char *key = study->factors[f].key;
    if (!scree_study_has_answers(study) && strcmp(key, "rp") != 0 && strcmp(key, "shapes") != 0)
      status = scree_study_set(&made, key, point->values[f], error);
  }
  made.seed = scree_study_run_seed(study, run);
  if (status == SCREE_OK)
    *experiment = made;
  else
    scree_experiment_free(&made);
  return status;
}

/* The same of a scene: its text, and what the files are that it names. */
static scree_status write_scene_identity(const scree_study *study, size_t run, FILE *stream,
                                         scree_error *error) {
  scree_scene_file *file;
  scree_status status = scree_study_run_scene(study, run, &file, error);
  if (status != SCREE_OK) return status;
  status = scree_scene_file_print(file, stream, error);
  for (size_t i = 0; status == SCREE_OK; i++) {
    char path[4096], *bytes, sum[SCREE_CHECKSUM_TEXT];
    size_t count;
    if (!scree_scene_file_input(file, i, path, sizeof path)) break;
    status = scree_file_read(path, 0, &bytes, &count, error);
    if (status != SCREE_OK) break;
    fprintf(stream, "file=%s\n", scree_checksum_text(scree_checksum_of(bytes, count), sum));
    scree_free(bytes);
  }
  for (size_t i = 0; i < study->answer_count; i++)
    fprintf(stream, "answer=%s\n", study->answers[i].name);
  scree_scene_file_free(file);
  return status;
}

/* The same of a command: its words. */
static scree_status write_command_identity(const scree_study *study, size_t run, FILE *stream,
                                           scree_error *error) {
  char text[1024];
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < study->command.count; i++) {
    status = scree_study_command_word(study, run, i, NULL, text, sizeof text, error);
    if (status == SCREE_OK) fprintf(stream, "word=%s\n", text);
  }
  for (size_t i = 0; i < study->answer_count; i++)
    fprintf(stream, "answer=%s\n", study->answers[i].name);
  return status;
}

/* Everything that the run's numbers follow from, as text: all fields but those of output, which
 * change no number; the shapes' checksums; what is made of them. */
static void write_identity(const scree_study *study, const scree_study_point *point,
                           const scree_experiment *e, FILE *stream) {
  const char *key;
  char value[64], unit[SCREE_NUMBER_SIZE];
  for (size_t i = 0; (key = scree_experiment_key(i)); i++)
    if (strncmp(key, "output.frame", 12) != 0 && strncmp(key, "output.checkpoint", 17) != 0 &&
        scree_experiment_get(e, key, value, sizeof value))
      fprintf(stream, "%s=%s\n", key, value);
  scree_number_format_digits(study->unit_m, 9, unit);
  fprintf(stream, "rp=%s\nmethod=%s\nunit=%s\n", point->rp, scree_method_name(study->method), unit);
  const scree_shape_set *set = &study->sets[point->set];
  for (size_t i = 0; i < set->count; i++) {
    const scree_study_shape *shape = &study->shapes[set->shapes[i]];
    char sum[SCREE_CHECKSUM_TEXT];
    scree_checksum_text(shape->checksum, sum);
    fprintf(stream, "shape=%s\n", sum);
  }
}

static scree_status make_key(const scree_study *study, size_t run, char key[SCREE_RUN_KEY_BYTES],
                             scree_error *error) {
  scree_experiment e;
  scree_status status = scree_study_experiment(study, run, &e, error);
  if (status != SCREE_OK) return status;
  char *text = NULL;
  size_t size = 0;
  FILE *stream = scree_memory_open(&text, &size);
  if (stream) {
    if (study->scene_text)
      status = write_scene_identity(study, run, stream, error);
    else if (study->command.count)
      status = write_command_identity(study, run, stream, error);
    else
      write_identity(study, &study->points[scree_study_run_point(study, run)], &e, stream);
    bool good = !ferror(stream);
    if (!scree_memory_close(stream) || !good) {
      free(text);
      text = NULL;
    }
  }
  scree_experiment_free(&e);
  if (status != SCREE_OK) {
    free(text);
    return status;
  }
  if (!text) return scree_fail_memory(error, 0, "a run's name");
  snprintf(key, SCREE_RUN_KEY_BYTES, "%016llx",
           (unsigned long long)scree_checksum_of(text, size).high);
  free(text);
  return SCREE_OK;
}

scree_status scree_study_make_keys(scree_study *study, scree_error *error) {
  size_t count = scree_study_run_count(study);
  if (study->keys) return SCREE_OK;
  char(*keys)[SCREE_RUN_KEY_BYTES] = scree_alloc(count, sizeof *keys);
  if (!keys) return scree_fail_memory(error, count * sizeof *keys, "the runs' names");
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < count; i++)
    status = make_key(study, i, keys[i], error);
  if (status == SCREE_OK)
    study->keys = keys;
  else
    scree_free(keys);
  return status;
}

size_t scree_study_run_count(const scree_study *study) {
  return study->point_count * study->replicate_count;
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
