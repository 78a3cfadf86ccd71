/* The study's file, strictly: every key is known, every value in its range, every error has line
 * and column. Values of the scene are tried on a copy at once, so that no run meets one that cannot
 * be. */
#include "scene/plan.h"
#include "base/file.h"
#include "base/number.h"
#include "study/design.h"
#include "study/study.h"

#include <math.h>
#include <string.h>

enum { LARGEST_FILE = 1 << 20 };
static const double most_points = 1e6;

/* ---- what its fields are ---- */

#define SCREE_STUDY_SAMPLE(ROW, T)                                                                 \
  ROW(T, REAL, resolution, NAN, 0.02e-3, 5e-3, "m", "")                                            \
  ROW(T, REAL, noise, NAN, 0, 1.25e-3, "m", "")                                                    \
  ROW(T, SEED, seed, 1, "")
SCREE_RECORD_TYPE(scree_study_sample, SCREE_STUDY_SAMPLE)
SCREE_RECORD_TABLE(scree_study_sample, SCREE_STUDY_SAMPLE, "sample", NULL, NULL)

#define SCREE_STUDY_ANALYSIS(ROW, T)                                                               \
  ROW(T, WORD, angle, 0, "sector|cone|silhouette", "")                                             \
  ROW(T, REAL, margin_deg, 2, 1e-6, 90, "deg", "")                                                 \
  ROW(T, REAL, confidence, 0.95, 0.5, 0.9999, "", "")
SCREE_RECORD_TYPE(scree_study_analysis, SCREE_STUDY_ANALYSIS)
SCREE_RECORD_TABLE(scree_study_analysis, SCREE_STUDY_ANALYSIS, "analysis", NULL, NULL)

#define SCREE_STUDY(ROW, T)                                                                        \
  ROW(T, TEXT, name, "")                                                                           \
  ROW(T, SEED, seed, 0, "")                                                                        \
  ROW(T, COUNT, replicates, 10, 1, 100000, "")                                                     \
  ROW(T, COUNT, attempts, 5, 1, 1000, "")                                                          \
  ROW(T, NODE, shapes, "")                                                                         \
  ROW(T, WORD, unit, 2, SCREE_PLAN_UNITS, "")                                                      \
  ROW(T, GROUP, sample, scree_study_sample, "")                                                    \
  ROW(T, WORD, method, 0, "volume|qecd", "")                                                       \
  ROW(T, NODE, base, "")                                                                           \
  ROW(T, NODE, answers, "")                                                                        \
  ROW(T, NODE, factors, "")                                                                        \
  ROW(T, WORD, design, 0, "grid|latin|sobol|list", "")                                             \
  ROW(T, COUNT, points, 0, 1, 1e6, "")                                                             \
  ROW(T, GROUP, analysis, scree_study_analysis, "")
SCREE_RECORD_TYPE(scree_study_fields, SCREE_STUDY)
SCREE_RECORD_TABLE(scree_study_fields, SCREE_STUDY, "a study", NULL, NULL)

#define SCREE_STUDY_RANGE(ROW, T)                                                                  \
  ROW(T, REAL, from, NAN, -1e300, 1e300, "", "")                                                   \
  ROW(T, REAL, to, NAN, -1e300, 1e300, "", "")                                                     \
  ROW(T, WORD, scale, 0, "linear|log", "")                                                         \
  ROW(T, COUNT, levels, 0, 2, 10000, "")
SCREE_RECORD_TYPE(scree_study_range, SCREE_STUDY_RANGE)
SCREE_RECORD_TABLE(scree_study_range, SCREE_STUDY_RANGE, "a range", NULL, NULL)

#define SCREE_STUDY_WINDOW(ROW, T)                                                                 \
  ROW(T, REAL, from, NAN, 0, 1e9, "s", "")                                                         \
  ROW(T, REAL, until, NAN, 0, 1e9, "s", "")                                                        \
  ROW(T, REAL, at, NAN, -1e9, 1e9, "s", "")
SCREE_RECORD_TYPE(scree_study_window, SCREE_STUDY_WINDOW)
SCREE_RECORD_TABLE(scree_study_window, SCREE_STUDY_WINDOW, "an answer", NULL, NULL)

/* ---- reading ---- */

typedef struct reader {
  scree_study *study;
  const char *name; /* of the file */
  scree_error *error;
} reader;

#define fail_at(r, node, ...)                                                                      \
  scree_fail_place(&(const scree_reader){(r)->name, NULL, (r)->error, ""},                         \
                   &(const scree_place){NULL, "", (node)->line, (node)->column}, __VA_ARGS__)

static scree_status fail_memory(const reader *r) {
  return scree_fail_memory(r->error, 0, r->name);
}

/* A group of fields; `path` stands before their names in errors. */
static scree_status read_record(const reader *r, const scree_yaml *node, const char *path,
                                const scree_record *kind, void *record) {
  const scree_reader in = {r->name, &r->study->arena, r->error, path};
  return scree_record_read(&in, node, kind, record);
}

static scree_status need_scalar(const reader *r, const scree_yaml *node) {
  if (node->kind == SCREE_YAML_SCALAR) return SCREE_OK;
  return fail_at(r, node, "%s: must be one value", node->key ? node->key : "an item");
}

/* ---- base ---- */

static size_t count_items(const scree_yaml *node) {
  size_t count = 1;
  for (size_t i = 0; i < node->item_count; i++) count += count_items(&node->items[i]);
  return count;
}

/* An error of the scene's, which knows no place, with the node's. */
static scree_status place_error(const reader *r, const scree_yaml *node, scree_status status,
                                const scree_error *error) {
  if (status == SCREE_OK || status == SCREE_OUT_OF_MEMORY) {
    if (status != SCREE_OK && r->error) *r->error = *error;
    return status;
  }
  return fail_at(r, node, "%.400s", error->message);
}

/* Settings of the base, each tried where it stands; what one alone cannot be, all together may. */
typedef struct settings {
  const reader *r;
  scree_scene_file *file;
  scree_error first;
  scree_status status;
} settings;

static void add_setting(settings *s, const scree_yaml *node, const char *key) {
  const reader kept = {s->r->study, s->r->name, &s->first};
  scree_error why;
  if (s->status == SCREE_OUT_OF_MEMORY) return;
  if (node->kind == SCREE_YAML_MAPPING) {
    for (size_t i = 0; i < node->item_count; i++) {
      char inner[256];
      snprintf(inner, sizeof inner, "%.120s.%.120s", key, node->items[i].key);
      add_setting(s, &node->items[i], inner);
    }
    return;
  }
  scree_status status = need_scalar(&kept, node);
  if (status != SCREE_OK) {
    s->status = SCREE_BAD_ARGUMENT;
    return;
  }
  status = scree_scene_file_try(s->file, key, node->text, &why);
  if (status != SCREE_OK && s->status == SCREE_OK) {
    (void)place_error(&kept, node, status, &why);
    s->status = status;
  }
  status = scree_study_add_setting(s->r->study, key, node->text, &why);
  if (status != SCREE_OK) s->status = place_error(&kept, node, status, &why);
}

static scree_status read_settings(const reader *r, const scree_yaml *base, const scree_yaml *but) {
  scree_study *study = r->study;
  settings s = {.r = r};
  scree_error error;
  size_t most = count_items(base);
  study->settings = scree_arena_take(&study->arena, most, sizeof *study->settings);
  if (!study->settings) return fail_memory(r);
  scree_status status = scree_study_scene(study, NULL, &s.file, &error);
  if (status != SCREE_OK) return place_error(r, base, status, &error);
  const scree_yaml *preset = scree_yaml_find(base, "preset");
  if (preset) add_setting(&s, preset, "preset");
  for (size_t i = 0; i < base->item_count; i++) {
    const scree_yaml *item = &base->items[i];
    if (item != but && item != preset) add_setting(&s, item, item->key);
  }
  status = scree_scene_file_check(s.file, &error);
  bool forgiven = status == SCREE_OK && s.status == SCREE_BAD_FILE;
  scree_scene_file_free(s.file);
  if (s.status != SCREE_OK && !forgiven) {
    if (r->error) *r->error = s.first;
    return s.first.status;
  }
  return place_error(r, base, status, &error);
}

/* {scene: FILE, FIELD: VALUE, ...}, or {template: NAME, ...}: repose where none is named; or
 * {command: [PROGRAM, WORD, ...]}. */
static scree_status read_base(const reader *r, const scree_yaml *base) {
  scree_study *study = r->study;
  scree_error error;
  if (base->kind != SCREE_YAML_MAPPING)
    return fail_at(r, base, "base: must be `key: value` lines of a scene");
  const scree_yaml *command = scree_yaml_find(base, "command"),
                   *timeout = command ? scree_yaml_find(base, "timeout") : NULL;
  if (command && base->item_count > (timeout ? 2 : 1))
    return fail_at(r, base, "command: stands alone, but for timeout; its values are factors");
  study->timeout = INFINITY;
  if (timeout && (!timeout->text || !scree_number_read(timeout->text, &study->timeout) ||
                  !(study->timeout > 0)))
    return fail_at(r, timeout, "timeout: must be seconds, above 0");
  study->seed = 1;
  if (command)
    return place_error(r, command, scree_study_read_command(study, command, &error), &error);
  const scree_yaml *scene = scree_yaml_find(base, "scene"),
                   *template = scree_yaml_find(base, "template"), *of = scene ? scene : template;
  SCREE_TRY(of ? need_scalar(r, of) : SCREE_OK);
  if (scene && template) return fail_at(r, template, "template: the base is a scene already");
  scree_status status =
      scene ? scree_study_read_scene(study, scene->text, &error)
            : scree_study_take_template(study, template ? template->text : "repose", &error);
  if (status != SCREE_OK) return place_error(r, of ? of : base, status, &error);
  SCREE_TRY(read_settings(r, base, of));
  return place_error(r, base, scree_study_look(study, &error), &error);
}

/* What an answer is called in tables. */
static void name_answer(const scree_answer *a, char name[200]) {
  char *end = name;
  end += snprintf(name, 120, "%s%.100s", a->mean ? "mean " : a->sd ? "sd " : "", a->column);
  if (!isnan(a->at))
    snprintf(end, 80, " at %g %s", a->at, a->outline ? "m" : "s");
  else if (a->until < INFINITY)
    snprintf(end, 80, " %g to %g s", a->from, a->until);
  else if (a->from > 0)
    snprintf(end, 80, " from %g s", a->from);
}

/* COLUMN for its last value, {COLUMN: mean} and {COLUMN: sd} over its sensor's window, {COLUMN:
 * {from: T, until: T}} for the mean over another, {COLUMN: {at: T}} for the value at a time,
 * {outline: {at: X}} for the height of what is seen along y. */
static scree_status read_answer(const reader *r, const scree_yaml *item, scree_answer *a) {
  *a = (scree_answer){.from = 0, .until = INFINITY, .at = NAN};
  const char *column = item->text;
  const scree_yaml *only =
      item->kind == SCREE_YAML_MAPPING && item->item_count == 1 ? &item->items[0] : NULL;
  if (only && only->kind == SCREE_YAML_SCALAR) {
    column = only->key;
    a->mean = !strcmp(only->text, "mean");
    a->sd = !strcmp(only->text, "sd");
    a->from = a->until = NAN;
    if (!a->mean && !a->sd) return fail_at(r, only, "%s: must be mean, sd, or a window", column);
  } else if (only && only->kind == SCREE_YAML_MAPPING) {
    scree_study_window window;
    column = only->key;
    SCREE_TRY(read_record(r, only, column, &scree_study_window_record, &window));
    bool at = !isnan(window.at), mean = !isnan(window.from) || !isnan(window.until);
    if (at && mean) return fail_at(r, only, "%s: at, or from and until", column);
    a->mean = !at;
    a->at = window.at;
    if (!isnan(window.from)) a->from = window.from;
    if (!isnan(window.until)) a->until = window.until;
  } else if (item->kind != SCREE_YAML_SCALAR) {
    return fail_at(r, item,
                   "an answer must be a column such as torque.power, {torque.power: mean} for its "
                   "mean, or {torque.power: {from: 2}} for that from 2 s on");
  }
  a->column = scree_arena_text(&r->study->arena, column);
  if (!a->column) return fail_memory(r);
  a->outline = r->study->scene_text && !strcmp(column, "outline");
  if (a->outline && isnan(a->at))
    return fail_at(r, item, "outline: needs a place, as in {outline: {at: 0.01}}");
  if (r->study->command.count && (a->mean || a->sd || !isnan(a->at)))
    return fail_at(r, item, "%s: what a command prints has no times", column);
  if (!a->outline && a->at < 0)
    return fail_at(r, item, "%s: at %g s: must not be below 0", column, a->at);
  char name[200];
  name_answer(a, name);
  a->name = scree_arena_text(&r->study->arena, name);
  return a->name ? SCREE_OK : fail_memory(r);
}

static scree_status read_answers(const reader *r, const scree_yaml *node) {
  scree_study *study = r->study;
  if (node->kind != SCREE_YAML_SEQUENCE || node->item_count == 0)
    return fail_at(r, node, "answers: must be a list of columns, as in [torque.power]");
  study->answers = scree_arena_take(&study->arena, node->item_count, sizeof *study->answers);
  if (!study->answers) return fail_memory(r);
  for (size_t i = 0; i < node->item_count; i++) {
    scree_answer *answer = &study->answers[i];
    SCREE_TRY(read_answer(r, &node->items[i], answer));
    if (study->scene_text && !answer->outline &&
        !scree_study_has_column(study, answer->column, &answer->unit))
      return fail_at(r, &node->items[i], "no column '%s' in the scene%s", answer->column,
                     scree_study_column_hint(study, answer->column));
    study->answer_count++;
  }
  return SCREE_OK;
}

/* ---- shapes ---- */

static void short_name(const char *word, char *buffer, size_t size) {
  const char *slash = strrchr(word, '/');
  snprintf(buffer, size, "%s", !strncmp(word, "sample:", 7) ? word + 7 : slash ? slash + 1 : word);
  char *dot = strrchr(buffer, '.');
  if (dot && dot != buffer) *dot = 0;
  for (char *c = buffer; *c; c++)
    if ((unsigned char)*c <= ' ' || strchr("'\"/\\+,.*", *c)) *c = '_';
}

static bool name_taken(const scree_study *study, const char *name) {
  for (size_t i = 0; i < study->shape_count; i++)
    if (!strcmp(study->shapes[i].name, name)) return true;
  return false;
}

/* A relative path stands beside the study's file. */
static const char *resolve(const reader *r, const char *word) {
  const char *slash = strrchr(r->study->path, '/');
  if (word[0] == '/' || !slash) return scree_arena_text(&r->study->arena, word);
  size_t folder = (size_t)(slash - r->study->path) + 1, size = folder + strlen(word) + 1;
  char *path = scree_arena_take(&r->study->arena, size, 1);
  if (path) snprintf(path, size, "%.*s%s", (int)folder, r->study->path, word);
  return path;
}

static bool known_sample(const char *name) {
  for (size_t i = 0; i < scree_sample_count(); i++)
    if (!strcmp(scree_sample_name(i), name)) return true;
  return !strncmp(name, "icosphere-", 10);
}

/* The index of the shape of this word, a new one where it is not there yet. */
static scree_status find_shape(const reader *r, const scree_yaml *node, size_t *index) {
  scree_study *study = r->study;
  SCREE_TRY(need_scalar(r, node));
  for (*index = 0; *index < study->shape_count; ++*index)
    if (!strcmp(study->shapes[*index].word, node->text)) return SCREE_OK;
  if (study->shape_count == SCREE_MOST_SHAPES)
    return fail_at(r, node, "more than %d shapes", SCREE_MOST_SHAPES);
  bool is_sample = !strncmp(node->text, "sample:", 7);
  if (!*node->text || (is_sample && !known_sample(node->text + 7)))
    return fail_at(r, node, "no built-in sample '%s'", node->text);
  char plain[64], name[96];
  short_name(node->text, plain, sizeof plain);
  snprintf(name, sizeof name, "%s", plain);
  for (int n = 2; name_taken(study, name); n++) snprintf(name, sizeof name, "%s-%d", plain, n);
  scree_study_shape shape = {.word = scree_arena_text(&study->arena, node->text),
                             .path = is_sample ? NULL : resolve(r, node->text),
                             .name = scree_arena_text(&study->arena, name)};
  if (!shape.word || !shape.name || (!is_sample && !shape.path)) return fail_memory(r);
  study->shapes[study->shape_count++] = shape;
  return SCREE_OK;
}

/* One set: a word or a list of words. */
static scree_status read_set(const reader *r, const scree_yaml *node, size_t *index) {
  scree_study *study = r->study;
  bool list = node->kind == SCREE_YAML_SEQUENCE;
  size_t count = list ? node->item_count : 1;
  if (node->kind == SCREE_YAML_MAPPING || count == 0)
    return fail_at(r, node, "shapes: must be files or sample:NAME");
  size_t *shapes = scree_arena_take(&study->arena, count, sizeof *shapes), size = 1;
  if (!shapes) return fail_memory(r);
  for (size_t i = 0; i < count; i++) {
    SCREE_TRY(find_shape(r, list ? &node->items[i] : node, &shapes[i]));
    for (size_t j = 0; j < i; j++)
      if (shapes[j] == shapes[i])
        return fail_at(r, &node->items[i], "the shape '%s' stands here twice", node->items[i].text);
    size += strlen(study->shapes[shapes[i]].name) + 1;
  }
  char *label = scree_arena_take(&study->arena, size, 1), *end = label;
  if (!label) return fail_memory(r);
  for (size_t i = 0; i < count; i++)
    end += snprintf(end, size - (size_t)(end - label), "%s%s", i ? "+" : "",
                    study->shapes[shapes[i]].name);
  *index = study->set_count;
  study->sets[study->set_count++] = (scree_shape_set){label, shapes, count};
  return SCREE_OK;
}

/* ---- factors ---- */

/* Tries a value on the base. */
static scree_status try_value(const reader *r, const scree_yaml *node, const char *key,
                              const char *text) {
  if (r->study->command.count)
    return !strcmp(key, "seed") ||
                   scree_command_has(&r->study->command, key) /* or it has no scatter */
               ? SCREE_OK
               : fail_at(r, node, "%s: the command has no word with {%s}", key, key);
  scree_error error;
  const char *wrong = scree_study_is_own(r->study, key) ? scree_shape_level_error(text) : NULL;
  if (wrong) return fail_at(r, node, "%s: '%s': %s", key, text, wrong);
  if (scree_study_is_own(r->study, key)) return SCREE_OK;
  return place_error(r, node, scree_study_try(r->study, key, text, &error), &error);
}

static scree_status read_levels(const reader *r, const scree_yaml *node, scree_factor *f) {
  scree_arena *arena = &r->study->arena;
  f->levels = scree_arena_take(arena, node->item_count, sizeof *f->levels);
  bool sets = !strcmp(f->key, "shapes") && scree_study_is_own(r->study, f->key);
  if (sets) f->sets = scree_arena_take(arena, node->item_count, sizeof *f->sets);
  if (!f->levels || (sets && !f->sets)) return fail_memory(r);
  if (node->item_count == 0) return fail_at(r, node, "%s: needs at least one level", f->key);
  for (size_t i = 0; i < node->item_count; i++) {
    const scree_yaml *item = &node->items[i];
    scree_status status = sets ? read_set(r, item, &f->sets[i]) : need_scalar(r, item);
    if (status == SCREE_OK && !sets) status = try_value(r, item, f->key, item->text);
    if (status != SCREE_OK) return status;
    f->levels[i] = sets ? r->study->sets[f->sets[i]].label : scree_arena_text(arena, item->text);
    if (!f->levels[i]) return fail_memory(r);
    for (size_t j = 0; j < i && r->study->design != SCREE_DESIGN_LIST; j++)
      if (!strcmp(f->levels[j], f->levels[i]))
        return fail_at(r, item, "%s: the level '%s' stands here twice", f->key, f->levels[i]);
    f->level_count++;
  }
  return SCREE_OK;
}

/* The number as text that the key takes: whole where it must be. */
static scree_status level_text(const reader *r, const scree_yaml *node, const char *key,
                               double value, const char **text) {
  char number[SCREE_NUMBER_SIZE];
  scree_error *kept = r->error;
  reader quiet = {r->study, r->name, NULL};
  scree_number_format_digits(value, 9, number);
  if (try_value(&quiet, node, key, number) != SCREE_OK)
    snprintf(number, sizeof number, "%.0f", value);
  reader loud = {r->study, r->name, kept};
  SCREE_TRY(try_value(&loud, node, key, number));
  *text = scree_arena_text(&r->study->arena, number);
  return *text ? SCREE_OK : fail_memory(r);
}

static double at_fraction(const scree_factor *f, double u) {
  return f->logarithmic ? f->from * pow(f->to / f->from, u) : f->from + u * (f->to - f->from);
}

static scree_status check_range(const reader *r, const scree_yaml *node, scree_factor *f,
                                size_t levels) {
  const char *text;
  if (!strcmp(f->key, "shapes") && scree_study_is_own(r->study, f->key))
    return fail_at(r, node, "shapes: must be a list, not a range");
  if (r->study->design == SCREE_DESIGN_LIST)
    return fail_at(r, node, "%s: design list needs a list of levels, one for each point", f->key);
  if (!(f->from < f->to)) return fail_at(r, node, "%s: from must be below to", f->key);
  if (f->logarithmic && !(f->from > 0))
    return fail_at(r, node, "%s: from %g: must be above 0 on a log scale", f->key, f->from);
  scree_status status = level_text(r, node, f->key, f->from, &text);
  if (status == SCREE_OK) status = level_text(r, node, f->key, f->to, &text);
  if (status != SCREE_OK || r->study->design != SCREE_DESIGN_GRID) return status;
  if (levels == 0) return fail_at(r, node, "%s: a range in a grid needs levels: N", f->key);
  f->levels = scree_arena_take(&r->study->arena, levels, sizeof *f->levels);
  if (!f->levels) return fail_memory(r);
  for (size_t i = 0; status == SCREE_OK && i < levels; i++)
    status = level_text(r, node, f->key, at_fraction(f, (double)i / (double)(levels - 1)),
                        &f->levels[i]);
  f->level_count = levels;
  return status;
}

/* {from: A, to: B, scale: linear|log, levels: N} */
static scree_status read_range(const reader *r, const scree_yaml *node, scree_factor *f) {
  scree_study_range range;
  SCREE_TRY(read_record(r, node, f->key, &scree_study_range_record, &range));
  if (isnan(range.from) || isnan(range.to))
    return fail_at(r, node, "%s: a range needs from and to", f->key);
  f->range = true;
  f->from = range.from;
  f->to = range.to;
  f->logarithmic = range.scale == 1;
  return check_range(r, node, f, range.levels);
}

static scree_status add_factor(const reader *r, const char *key, const scree_yaml *node) {
  scree_study *study = r->study;
  scree_factor f = {
      .key = scree_arena_text(&study->arena, key), .line = node->line, .column = node->column};
  if (!f.key) return fail_memory(r);
  if (!strcmp(key, "seed") && study->design != SCREE_DESIGN_LIST)
    return fail_at(r, node, "seed is no factor: `replicates: N` counts it up");
  scree_status status =
      node->kind == SCREE_YAML_SEQUENCE ? read_levels(r, node, &f)
      : node->kind == SCREE_YAML_MAPPING
          ? read_range(r, node, &f)
          : fail_at(r, node, "%s: must be a list of levels or {from: A, to: B}", key);
  if (status == SCREE_OK) study->factors[study->factor_count++] = f;
  return status;
}

static bool is_range(const scree_yaml *node) {
  return node->kind == SCREE_YAML_MAPPING &&
         (scree_yaml_find(node, "from") || scree_yaml_find(node, "to"));
}

/* A mapping that is no range is a group of keys, as in a scene. */
static scree_status read_factors(const reader *r, const scree_yaml *node) {
  if (node->kind != SCREE_YAML_MAPPING)
    return fail_at(r, node, "factors: must be `key: [levels]` lines");
  for (size_t i = 0; i < node->item_count; i++) {
    const scree_yaml *item = &node->items[i];
    if (item->kind != SCREE_YAML_MAPPING || is_range(item)) {
      SCREE_TRY(add_factor(r, item->key, item));
      continue;
    }
    for (size_t k = 0; k < item->item_count; k++) {
      char key[128];
      snprintf(key, sizeof key, "%s.%s", item->key, item->items[k].key);
      SCREE_TRY(add_factor(r, key, &item->items[k]));
    }
  }
  return SCREE_OK;
}

/* ---- the whole ---- */

/* Checks the design `list`: every factor has as many levels. */
static scree_status check_list(const reader *r, const scree_yaml *root) {
  const scree_study *study = r->study;
  if (study->wanted_points)
    return fail_at(r, scree_yaml_find(root, "points"),
                   "points belongs to design latin or sobol; a list has as many as its levels");
  if (study->factor_count == 0)
    return fail_at(r, scree_yaml_find(root, "design"), "this design needs factors");
  for (size_t f = 1; f < study->factor_count; f++)
    if (study->factors[f].level_count != study->factors[0].level_count)
      return fail_at(r, scree_yaml_find(root, "design"),
                     "a list needs as many levels of each factor: %zu of %s, %zu of %s",
                     study->factors[0].level_count, study->factors[0].key,
                     study->factors[f].level_count, study->factors[f].key);
  return SCREE_OK;
}

/* What only the whole can say. */
static scree_status check_whole(const reader *r, const scree_yaml *root) {
  scree_study *study = r->study;
  double points = 1;
  bool varied = false;
  for (size_t i = 0; i < study->factor_count; i++) {
    varied = varied || (study->factors[i].sets != NULL);
    points *= (double)study->factors[i].level_count;
  }
  if (!study->has_pile && !study->answer_count)
    return fail_at(
        r, root, "a study of a command, or of a scene without a pile, needs answers: [NAME, ...]");
  const scree_yaml *replicates = scree_yaml_find(root, "replicates");
  bool alike = study->command.count && !scree_command_has(&study->command, "seed");
  if (alike && replicates && study->replicate_count > 1)
    return fail_at(r, replicates,
                   "replicates: %zu runs of a command without {seed} would all be alike: give it a "
                   "word with {seed}",
                   study->replicate_count);
  if (alike) study->replicate_count = 1;
  if (varied && scree_yaml_find(root, "shapes"))
    return fail_at(r, root, "shapes stands both by itself and as a factor");
  bool named = study->scene_is_file || study->command.count;
  if (!named && !varied && !scree_yaml_find(root, "shapes"))
    return fail_at(r, root, "needs shapes: [FILE or sample:NAME, ...]");
  if (study->design == SCREE_DESIGN_LIST) return check_list(r, root);
  if (study->design == SCREE_DESIGN_GRID && study->wanted_points)
    return fail_at(r, scree_yaml_find(root, "points"),
                   "points belongs to design latin or sobol; a grid has as many as its levels");
  if (study->design == SCREE_DESIGN_GRID && points > most_points)
    return fail_at(r, root, "the grid has %.3g points; at most %g", points, most_points);
  if (study->design == SCREE_DESIGN_GRID) return SCREE_OK;
  if (!study->wanted_points)
    return fail_at(r, scree_yaml_find(root, "design"), "this design needs points: N");
  if (study->factor_count == 0)
    return fail_at(r, scree_yaml_find(root, "design"), "this design needs factors");
  if (study->design == SCREE_DESIGN_SOBOL && study->factor_count > SCREE_SOBOL_DIMENSIONS)
    return fail_at(r, scree_yaml_find(root, "design"), "sobol takes at most %d factors, not %zu",
                   SCREE_SOBOL_DIMENSIONS, study->factor_count);
  return SCREE_OK;
}

const char *scree_study_design_name(const scree_study *study) {
  static const char *const designs[] = {"grid", "latin", "sobol", "list"};
  return designs[study->design];
}

static void take_fields(scree_study *study, const scree_study_fields *f) {
  static const char *const angles[] = {"sector", "cone", "silhouette"};
  const scree_study_analysis *analysis = f->analysis ? f->analysis : &scree_study_analysis_defaults;
  if (f->name) study->name = f->name;
  study->replicate_count = f->replicates;
  study->attempt_limit = f->attempts;
  study->wanted_points = f->points;
  study->design = (scree_design)f->design;
  study->method = (scree_method)f->method;
  study->unit_m = scree_plan_unit(f->unit);
  study->sample = scree_default_sample_options();
  if (f->sample && !isnan(f->sample->resolution)) study->sample.resolution = f->sample->resolution;
  if (f->sample && !isnan(f->sample->noise)) study->sample.noise = f->sample->noise;
  if (f->sample) study->sample.seed = f->sample->seed;
  study->analysis_angle = angles[analysis->angle];
  study->margin_deg = analysis->margin_deg;
  study->confidence = analysis->confidence;
}

static scree_status read_root(const reader *r, const scree_yaml *root) {
  scree_study *study = r->study;
  scree_study_fields f;
  if (root->kind != SCREE_YAML_MAPPING) return fail_at(r, root, "a study is `key: value` lines");
  size_t most = count_items(root); /* factors, sets: no more than there are nodes */
  study->factors = scree_arena_take(&study->arena, most, sizeof *study->factors);
  study->sets = scree_arena_take(&study->arena, most, sizeof *study->sets);
  study->shapes = scree_arena_take(&study->arena, SCREE_MOST_SHAPES, sizeof *study->shapes);
  if (!study->factors || !study->sets || !study->shapes) return fail_memory(r);
  size_t set;
  SCREE_TRY(read_record(r, root, "", &scree_study_fields_record, &f));
  take_fields(study, &f);
  const scree_yaml none = {.kind = SCREE_YAML_MAPPING, .line = root->line, .column = root->column};
  SCREE_TRY(read_base(r, f.base ? f.base : &none));
  if (f.shapes && study->command.count)
    return fail_at(r, f.shapes, "shapes: what a command needs stands in its words");
  bool varied =
      f.factors && f.factors->kind == SCREE_YAML_MAPPING && scree_yaml_find(f.factors, "shapes");
  study->own_shapes = !study->command.count && (f.shapes || varied);
  if (scree_yaml_find(root, "seed")) study->seed = f.seed;
  if (f.shapes) SCREE_TRY(read_set(r, f.shapes, &set));
  if (f.answers) SCREE_TRY(read_answers(r, f.answers));
  if (f.factors) SCREE_TRY(read_factors(r, f.factors));
  if (study->set_count == 0) study->sets[study->set_count++] = (scree_shape_set){"", NULL, 0};
  return check_whole(r, root);
}

static scree_status start(scree_study *study, const char *path, scree_error *error) {
  study->path = scree_arena_text(&study->arena, path);
  const char *slash = strrchr(path, '/');
  char name[96];
  snprintf(name, sizeof name, "%s", slash ? slash + 1 : path);
  char *dot = strrchr(name, '.');
  if (dot && dot != name) *dot = 0;
  study->name = scree_arena_text(&study->arena, name);
  if (!study->path || !study->name) return scree_fail_memory(error, strlen(path), path);
  return SCREE_OK;
}

static scree_status read_text(scree_study *study, const char *path, scree_error *error) {
  char *bytes;
  size_t count;
  SCREE_TRY(scree_file_read(path, LARGEST_FILE, &bytes, &count, error));
  char *text = scree_arena_take(&study->arena, count + 1, 1);
  if (text) memcpy(text, bytes, count + 1);
  scree_free(bytes);
  if (!text) return scree_fail_memory(error, count, path);
  study->text = text;
  study->text_size = count;
  return SCREE_OK;
}

scree_status scree_study_read(const char *path, scree_study **study, scree_error *error) {
  SCREE_OWNED(scree_study, made);
  SCREE_CLEANUP(scree_yaml_free) scree_yaml root = {0};
  SCREE_TRY_ALLOC_ZERO(made, 1, error);
  reader r = {made, path, error};
  SCREE_TRY(start(made, path, error));
  SCREE_TRY(read_text(made, path, error));
  SCREE_TRY(scree_yaml_parse(made->text, made->text_size, path, &root, error));
  SCREE_TRY(read_root(&r, &root));
  SCREE_TRY(scree_study_make_points(made, error));
  *study = made;
  made = NULL;
  return SCREE_OK;
}

void scree_study_free(scree_study *study) {
  if (!study) return;
  scree_free(study->folder);
  scree_free(study->keys);
  scree_arena_free(&study->arena);
  scree_free(study);
}
