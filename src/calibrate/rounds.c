/* A calibration's folder:
 *
 *   calibrate.yaml    the file as last given
 *   rounds/0001.yaml  the runs that were planned at a time
 *   rounds/end.yaml   why it stopped
 *   EXPERIMENT/       a study of all runs of an experiment (study/folder.c)
 *
 * A round is written when all runs before it have ended, by whoever holds the lease; it depends on
 * their results alone. Seeds count up over all runs, so that no two share one. */
#include "base/array.h"
#include "base/file.h"
#include "base/number.h"
#include "base/platform.h"
#include "base/quote.h"
#include "calibrate/calibration.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A file of the folder, until the end of the block. */
#define PATH(c, name) SCREE_PATH_IN((c)->folder, name)

/* ---- opening ---- */

static const char origin_mark[] = "# calibration of ";

/* The file's text, and where the original lies, beside which its scenes and curves are. */
static scree_status keep_copy(const scree_calibration *c, scree_error *error) {
  char full[4096];
  SCREE_CLEANUP(scree_free_at) char *text = NULL;
  if (!scree_path_full(c->path, full, sizeof full))
    return scree_fail(error, SCREE_IO, "%s: cannot be found", c->path);
  size_t size = sizeof origin_mark + strlen(full) + strlen(c->text) + 2;
  SCREE_TRY_ALLOC(text, size, error);
  snprintf(text, size, "%s%s\n%s", origin_mark, full, c->text);
  return scree_study_keep_text(text, PATH(c, "calibrate.yaml"), error);
}

scree_status scree_calibration_open(scree_calibration *c, const char *folder, scree_error *error) {
  char *copy = scree_strdup(folder);
  if (!copy) return scree_fail_memory(error, strlen(folder), "a path");
  scree_free(c->folder);
  c->folder = copy;
  SCREE_TRY(scree_folder_create(folder, error));
  SCREE_TRY(scree_folder_create(PATH(c, "rounds"), error));
  SCREE_TRY(scree_rounds_read(c, error));
  return keep_copy(c, error);
}

scree_status scree_calibration_open_folder(const char *folder, scree_calibration **calibration,
                                           scree_error *error) {
  char original[4096] = "";
  const char *path = SCREE_PATH_IN(folder, "calibrate.yaml");
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  size_t size;
  if (!scree_path_exists(path))
    return scree_fail(error, SCREE_IO, "%s: is no folder of a calibration: no calibrate.yaml in it",
                      folder);
  SCREE_TRY(scree_file_read(path, 2 << 20, &bytes, &size, error));
  if (!strncmp(bytes, origin_mark, sizeof origin_mark - 1))
    snprintf(original, sizeof original, "%.*s",
             (int)strcspn(bytes, "\n") - (int)sizeof origin_mark + 1,
             bytes + sizeof origin_mark - 1);
  SCREE_TRY(scree_calibration_read(original[0] ? original : path, calibration, error));
  scree_status status = scree_calibration_open(*calibration, folder, error);
  if (status != SCREE_OK) scree_calibration_free(*calibration);
  return status;
}

/* ---- rounds ---- */

/* What was asked: another file goes on. */
static void mark_of(const scree_calibration *c, char mark[SCREE_CHECKSUM_TEXT]) {
  scree_checksum_text(scree_checksum_of(c->text, c->text_size), mark);
}

static const char *round_path(const scree_calibration *c, size_t number,
                              char path[SCREE_PATH_BYTES]) {
  char name[40];
  snprintf(name, sizeof name, "rounds/%04zu.yaml", number);
  return scree_path_put(path, c->folder, name);
}
#define ROUND_PATH(c, number) round_path(c, number, (char[SCREE_PATH_BYTES]){0})

static scree_status refuse(const char *path, scree_error *error) {
  return scree_fail(error, SCREE_BAD_FILE,
                    "%s: is no round of this calibration; take another folder, or remove what is "
                    "in this one",
                    path);
}

static const char *text_of(const scree_yaml *node, const char *key) {
  const scree_yaml *item = scree_yaml_find(node, key);
  return item && item->kind == SCREE_YAML_SCALAR ? item->text : NULL;
}

static scree_status check_names(const scree_calibration *c, const char *path,
                                const scree_yaml *names, scree_error *error) {
  bool same =
      names && names->kind == SCREE_YAML_SEQUENCE && names->item_count == c->parameter_count;
  for (size_t p = 0; same && p < c->parameter_count; p++)
    same = names->items[p].kind == SCREE_YAML_SCALAR &&
           !strcmp(names->items[p].text, c->parameters[p].place.name);
  if (same) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_FILE,
                    "%s: was planned for other parameters than those of %s; take another folder",
                    path, c->path);
}

static scree_status read_run(scree_calibration *c, const char *path, const scree_yaml *node,
                             scree_error *error) {
  scree_planned_run run = {.round = c->round_count};
  const scree_yaml *values =
      node->kind == SCREE_YAML_MAPPING ? scree_yaml_find(node, "values") : NULL;
  const char *experiment = values ? text_of(node, "experiment") : NULL,
             *seed = values ? text_of(node, "seed") : NULL;
  if (!experiment || !seed || values->kind != SCREE_YAML_SEQUENCE ||
      values->item_count != c->parameter_count)
    return refuse(path, error);
  run.seed = strtoull(seed, NULL, 10);
  while (run.experiment < c->experiment_count &&
         strcmp(c->experiments[run.experiment].plan->place.name, experiment) != 0)
    run.experiment++;
  if (run.experiment == c->experiment_count)
    return scree_fail(error, SCREE_BAD_FILE,
                      "%s: has a run of the experiment '%s', which %s has no more", path,
                      experiment, c->path);
  for (size_t p = 0; p < c->parameter_count; p++) {
    if (values->items[p].kind != SCREE_YAML_SCALAR) return refuse(path, error);
    run.values[p] = scree_arena_text(&c->run_arena, values->items[p].text);
    if (!run.values[p]) return scree_fail_memory(error, 0, path);
    run.x[p] = scree_parameter_coordinate(&c->parameters[p], run.values[p]);
    if (isnan(run.x[p])) return refuse(path, error);
  }
  scree_planned_run *more = scree_resize(c->runs, c->run_count + 1, sizeof *more);
  if (!more) return scree_fail_memory(error, 0, path);
  c->runs = more;
  c->runs[c->run_count++] = run;
  return SCREE_OK;
}

static scree_status read_round(scree_calibration *c, const char *path, scree_error *error) {
  SCREE_CLEANUP(scree_yaml_free) scree_yaml root = {0};
  char mark[SCREE_CHECKSUM_TEXT];
  SCREE_TRY(scree_yaml_read(path, &root, error));
  bool mapping = root.kind == SCREE_YAML_MAPPING;
  const scree_yaml *runs = mapping ? scree_yaml_find(&root, "runs") : NULL;
  c->checked = false;
  if (!runs || runs->kind != SCREE_YAML_SEQUENCE) return refuse(path, error);
  SCREE_TRY(check_names(c, path, scree_yaml_find(&root, "parameters"), error));
  for (size_t i = 0; i < runs->item_count; i++)
    SCREE_TRY(read_run(c, path, &runs->items[i], error));
  const char *check = text_of(&root, "check");
  mark_of(c, mark);
  c->checked = check && !strcmp(check, mark);
  c->check_rounds = c->checked ? c->check_rounds + 1 : 0;
  return SCREE_OK;
}

scree_status scree_rounds_read(scree_calibration *c, scree_error *error) {
  scree_arena_free(&c->run_arena);
  c->run_count = c->round_count = c->check_rounds = 0;
  c->checked = false;
  for (;; c->round_count++) {
    const char *path = ROUND_PATH(c, c->round_count + 1);
    if (!scree_path_exists(path)) return SCREE_OK;
    SCREE_TRY(read_round(c, path, error));
  }
}

size_t scree_rounds_fitted(const scree_calibration *c) {
  return c->round_count - c->checked;
}

size_t scree_rounds_until(const scree_calibration *c, size_t experiment, size_t round_count) {
  size_t count = 0;
  for (size_t i = 0; i < c->run_count && c->runs[i].round < round_count; i++)
    count += c->runs[i].experiment == experiment;
  return count;
}

scree_status scree_rounds_add(scree_calibration *c, const scree_place_pick *picks, size_t count,
                              bool check, double seconds, scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(ROUND_PATH(c, c->round_count + 1), true, &output, error));
  FILE *s = output.stream;
  fprintf(s, "seconds: %.3f\n", seconds);
  if (check) {
    char mark[SCREE_CHECKSUM_TEXT];
    mark_of(c, mark);
    fprintf(s, "check: \"%s\"\n", mark);
  }
  fputs("parameters: [", s);
  for (size_t p = 0; p < c->parameter_count; p++) {
    fputs(p ? ", " : "", s);
    scree_quote(s, SCREE_QUOTE_YAML, c->parameters[p].place.name);
  }
  fputs("]\nruns:\n", s);
  for (size_t i = 0; i < count; i++) {
    fputs("  - {experiment: ", s);
    scree_quote(s, SCREE_QUOTE_YAML, c->experiments[picks[i].experiment].plan->place.name);
    fprintf(s, ", seed: %" PRIu64 ", values: [", c->plan.seed + c->run_count + i);
    for (size_t p = 0; p < c->parameter_count; p++) {
      const char *value = scree_parameter_text(&c->parameters[p], picks[i].x[p], &c->run_arena);
      fputs(p ? ", " : "", s);
      scree_quote(s, SCREE_QUOTE_YAML, value ? value : "");
    }
    fputs("]}\n", s);
  }
  return scree_output_commit(&output, error);
}

/* ---- the end ---- */

scree_status scree_rounds_stop(scree_calibration *c, const char *reason, double seconds,
                               scree_error *error) {
  char text[400], mark[SCREE_CHECKSUM_TEXT];
  mark_of(c, mark);
  snprintf(text, sizeof text, "seconds: %.3f\nfile: \"%s\"\nreason: \"%s\"\n", seconds, mark,
           reason);
  return scree_study_keep_text(text, PATH(c, "rounds/end.yaml"), error);
}

scree_status scree_rounds_end(scree_calibration *c, const char **reason, scree_error *error) {
  const char *path = PATH(c, "rounds/end.yaml");
  char mark[SCREE_CHECKSUM_TEXT];
  SCREE_CLEANUP(scree_yaml_free) scree_yaml root = {0};
  *reason = "";
  if (!scree_path_exists(path)) return SCREE_OK;
  SCREE_TRY(scree_yaml_read(path, &root, error));
  mark_of(c, mark);
  const char *file = root.kind == SCREE_YAML_MAPPING ? text_of(&root, "file") : NULL;
  const char *said = file ? text_of(&root, "reason") : NULL;
  if (said && !strcmp(file, mark)) *reason = scree_arena_text(&c->run_arena, said);
  return *reason ? SCREE_OK : scree_fail_memory(error, 0, "an end");
}

static double seconds_in(const char *path) {
  SCREE_CLEANUP(scree_yaml_free) scree_yaml root = {0};
  double seconds = 0;
  if (!scree_path_exists(path) || scree_yaml_read(path, &root, NULL) != SCREE_OK) return 0;
  const char *text = root.kind == SCREE_YAML_MAPPING ? text_of(&root, "seconds") : NULL;
  if (text) scree_number_read(text, &seconds);
  return seconds;
}

double scree_rounds_seconds(const scree_calibration *c) {
  double sum = seconds_in(PATH(c, "rounds/end.yaml"));
  for (size_t i = 1; i <= c->round_count; i++) sum += seconds_in(ROUND_PATH(c, i));
  return sum;
}

/* ---- an experiment's study ---- */

/* {here} is the folder of the calibration's file. */
void scree_calibration_word(const scree_calibration *c, const char *word, char *text, size_t size) {
  char full[4096];
  if (!scree_path_full(c->path, full, sizeof full)) snprintf(full, sizeof full, "%s", c->path);
  char *slash = strrchr(full, '/');
  const char *here = strstr(word, "{here}");
  if (slash) *slash = 0;
  if (here)
    snprintf(text, size, "%.*s%s%s", (int)(here - word), word, slash ? full : ".", here + 6);
  else
    snprintf(text, size, "%s", word);
}

static void put_word(const scree_calibration *c, FILE *stream, const char *word) {
  char text[8192];
  scree_calibration_word(c, word, text, sizeof text);
  scree_quote(stream, SCREE_QUOTE_YAML, text);
}

static void put_factor(const scree_calibration *c, FILE *s, size_t experiment, const char *key,
                       size_t parameter) {
  bool first = true;
  fputs("  ", s);
  scree_quote(s, SCREE_QUOTE_YAML, key);
  fputs(": [", s);
  for (size_t i = 0; i < c->run_count; i++) {
    if (c->runs[i].experiment != experiment) continue;
    fputs(first ? "" : ", ", s);
    if (parameter < c->parameter_count)
      scree_quote(s, SCREE_QUOTE_YAML, c->runs[i].values[parameter]);
    else
      fprintf(s, "%" PRIu64, c->runs[i].seed);
    first = false;
  }
  fputs("]\n", s);
}

/* Its fields that the scene has; of a command the parameter's name. */
static void put_parameter(const scree_calibration *c, FILE *s, size_t experiment,
                          size_t parameter) {
  const scree_plan_parameter *p = &c->parameters[parameter];
  if (c->experiments[experiment].plan->command.count) {
    put_factor(c, s, experiment, p->place.name, parameter);
    return;
  }
  for (size_t f = 0; f < p->fields.count; f++)
    put_factor(c, s, experiment, p->fields.items[f], parameter);
}

static void put_study(const scree_calibration *c, size_t experiment, FILE *s) {
  const scree_experiment_plan *e = &c->experiments[experiment];
  fputs("name: ", s);
  scree_quote(s, SCREE_QUOTE_YAML, e->plan->place.name);
  if (e->plan->command.count) {
    fputs("\nbase:\n  command: [", s);
    for (size_t i = 0; i < e->plan->command.count; i++) {
      fputs(i ? ", " : "", s);
      put_word(c, s, e->plan->command.items[i]);
    }
    fputs("]\n", s);
    if (!isnan(e->plan->timeout)) fprintf(s, "  timeout: %.17g\n", e->plan->timeout);
  } else {
    fputs("\nbase:\n  scene: ", s);
    scree_quote(s, SCREE_QUOTE_YAML, e->scene_path);
    putc('\n', s);
    for (size_t i = 0; e->plan->set && i < e->plan->set->item_count; i++) {
      fputs("  ", s);
      scree_quote(s, SCREE_QUOTE_YAML, e->plan->set->items[i].key);
      fputs(": ", s);
      scree_quote(s, SCREE_QUOTE_YAML, e->plan->set->items[i].text);
      putc('\n', s);
    }
  }
  fprintf(s, "design: list\nreplicates: 1\nanswers:\n%sfactors:\n", e->answers);
  put_factor(c, s, experiment, "seed", SIZE_MAX);
  for (size_t a = 0; a < e->active_count; a++) put_parameter(c, s, experiment, e->active[a]);
}

static scree_status write_study(const scree_calibration *c, size_t experiment, const char *folder,
                                scree_error *error) {
  char *text = NULL;
  size_t size = 0;
  FILE *stream = scree_memory_open(&text, &size);
  if (!stream) return scree_fail_memory(error, 0, "a study");
  put_study(c, experiment, stream);
  scree_status status = scree_memory_close(stream) ? scree_folder_create(folder, error)
                                                   : scree_fail_memory(error, 0, "a study");
  if (status == SCREE_OK)
    status = scree_study_keep_text(text, SCREE_PATH_IN(folder, "study.yaml"), error);
  free(text);
  return status;
}

scree_status scree_rounds_study(const scree_calibration *c, size_t experiment, scree_study **study,
                                scree_error *error) {
  const char *folder = PATH(c, c->experiments[experiment].plan->place.name);
  SCREE_OWNED(scree_study, made);
  *study = NULL;
  if (!scree_rounds_until(c, experiment, SIZE_MAX)) return SCREE_OK;
  SCREE_TRY(write_study(c, experiment, folder, error));
  SCREE_TRY(scree_study_read(SCREE_PATH_IN(folder, "study.yaml"), &made, error));
  SCREE_TRY(scree_study_open(made, folder, error));
  SCREE_TRY(scree_study_prepare(made, NULL, NULL, error));
  *study = made;
  made = NULL;
  return SCREE_OK;
}
