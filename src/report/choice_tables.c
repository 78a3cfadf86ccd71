/* A choice as JSON and CSV. Every object carries its provenance: version, command, options, input
 * checksum, unit, and for samples how they were made. */
#include "base/file.h"
#include "base/quote.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/program.h"

#include <math.h>

static const char *reference_name(scree_reference reference) {
  return reference == SCREE_REFERENCE_SMOOTH ? "smooth" : "scan";
}

static void json_pick(scree_json *json, const char *key, const scree_pick *pick) {
  SCREE_JSON_ROW(json, key, OF(pick, rp), OF(pick, triangle_count), OF(pick, eps_s), OF(pick, ip),
                 OF(pick, worst_eps_s), OF(pick, robust_ip), OF(pick, area), OF(pick, volume),
                 AS("similar_fewest", pick->fewest), AS("similar_most", pick->most));
}

/* Those that are known, or bounded. */
static void json_errors(scree_json *json, const char *key,
                        const double errors[SCREE_SHAPE_ERROR_COUNT]) {
  scree_json_row_object(json, key);
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    if (isfinite(errors[e]))
      scree_json_number(json, scree_shape_error_name((scree_shape_error)e), errors[e]);
  scree_json_end(json);
}

typedef size_t tell_sentences(const scree_choice_report *report, size_t entry,
                              char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES]);

static void json_sentences(scree_json *json, const char *key, const scree_choice_report *report,
                           size_t entry, tell_sentences *tell) {
  char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES];
  size_t count = tell(report, entry, texts);
  SCREE_JSON_LIST (json, key, i, count) scree_json_text(json, NULL, texts[i]);
}

static void json_changes(scree_json *json, const scree_fidelity *fidelity, size_t row) {
#define NAME(name, text) text,
  static const char *const names[] = {SCREE_CHANGE_LIST(NAME)};
#undef NAME
  scree_json_row_object(json, "changes");
  for (int k = 0; k < SCREE_CHANGE_COUNT; k++) {
    double change = scree_fidelity_change(fidelity, row, (scree_shape_change)k);
    if (isfinite(change)) scree_json_number(json, names[k], change);
  }
  scree_json_end(json);
}

static void recommended_errors(const scree_choice *c, double errors[SCREE_SHAPE_ERROR_COUNT]) {
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    errors[e] = scree_fidelity_error(c->fidelity, c->recommended_row, (scree_shape_error)e);
}

/* Writes the recommended level; a choice without the errors of levels has none. */
static void json_recommended(scree_json *json, const scree_choice_report *report, size_t entry) {
  const scree_choice *c = report->entries[entry].choice;
  const scree_fidelity *f = c->fidelity;
  double errors[SCREE_SHAPE_ERROR_COUNT], at[3];
  if (!f) return;
  recommended_errors(c, errors);
  scree_fidelity_farthest(f, c->recommended_row, at);
  scree_json_object(json, "recommended");
  SCREE_JSON_MEMBERS(json, OF(&c->recommended, rp), OF(&c->recommended, triangle_count),
                     OF(&c->recommended, area), OF(&c->recommended, volume),
                     OF(&c->recommended, eps_s), OF(&c->recommended, ip));
  json_errors(json, "errors", errors);
  json_changes(json, f, c->recommended_row);
  scree_json_numbers(json, "farthest", at, 3);
  SCREE_JSON_MEMBERS(json, AS("limited_by", scree_shape_error_name(c->limited_by)),
                     OF(c, limit_beyond), OF(c, largest_over_tolerance));
  json_sentences(json, "warnings", report, entry, scree_choice_warnings);
  scree_json_end(json);
  scree_json_row_object(json, "scan");
  SCREE_JSON_MEMBERS(json, AS("size", scree_fidelity_scan(f, SCREE_SCAN_LENGTH)),
                     AS("noise", scree_fidelity_scan(f, SCREE_SCAN_NOISE)),
                     AS("clean_area", scree_fidelity_scan(f, SCREE_SCAN_CLEAN_AREA)),
                     AS("thickness", scree_fidelity_scan(f, SCREE_SCAN_THICKNESS)),
                     AS("thinnest", scree_fidelity_scan(f, SCREE_SCAN_THINNEST)));
  SCREE_JSON_ROW_LIST (json, "dimensions", i, 3)
    scree_json_number(json, NULL,
                      scree_fidelity_scan(f, (scree_scan_fact)(SCREE_SCAN_BOX_LENGTH + i)));
  scree_json_end(json);
  scree_json_text(json, "limited_by", scree_shape_error_name(c->limited_by));
}

static void json_levels(scree_json *json, const scree_choice *choice) {
  SCREE_JSON_LIST (json, "levels", i, choice->level_count) {
    const scree_choice_level *level = &choice->levels[i];
    scree_json_row_object(json, NULL);
    SCREE_JSON_MEMBERS(json, OF(level, rp), OF(level, triangle_count), OF(level, area),
                       OF(level, volume), OF(level, eps_s), OF(level, ip), OF(level, worst_eps_s),
                       OF(level, robust_ip), OF(level, reached));
    json_errors(json, "errors", level->errors);
    scree_json_end(json);
  }
}

/* The level with the least error + w Nr/Nm for each error that was measured. */
static void json_best(scree_json *json, const scree_choice *choice, double weight) {
  scree_json_object(json, "best_by_error");
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++) {
    if (choice->best[e] >= choice->level_count) continue;
    const scree_choice_level *level = &choice->levels[choice->best[e]];
    scree_json_row_object(json, scree_shape_error_name((scree_shape_error)e));
    SCREE_JSON_MEMBERS(json, OF(level, rp), OF(level, triangle_count),
                       AS("error", level->errors[e]),
                       AS("sum", level->errors[e] + weight * level->rp_reached));
    scree_json_end(json);
  }
  scree_json_end(json);
}

static void json_noise(scree_json *json, const scree_choice *choice) {
  SCREE_JSON_ROW(json, "noise", OF(&choice->noise, found), OF(&choice->noise, fraction),
                 AS("smooth_area", choice->noise.area),
                 AS("plateau_triangle_count", choice->noise.triangle_count));
}

static void json_options(scree_json *json, const scree_choice_report *report) {
  const scree_choice_options *o = report->options;
  scree_json_row_object(json, "options");
  scree_json_text(json, "method", scree_method_name(report->method));
  scree_json_bool(json, "paper", report->rule == SCREE_RULE_PAPER);
  SCREE_JSON_MEMBERS(json, AS("rule", scree_choice_rule_name(report->rule)), OF(o, weight),
                     OF(o, rp_min), OF(o, rp_max), AS("per_decade", (uint64_t)o->per_decade),
                     AS("reference", reference_name(o->reference)));
  json_errors(json, "tolerances", o->tolerances);
  json_errors(json, "tolerance_lengths", o->tolerance_lengths);
  scree_json_end(json);
}

static void json_source(scree_json *json, const scree_choice_entry *entry) {
  scree_json_text(json, "name", entry->name);
  scree_json_source(json, entry->format, entry->checksum, entry->unit_m);
  if (entry->is_sample) {
    SCREE_JSON_ROW(json, "sample", AS("resolution_m", entry->sample_resolution),
                   AS("noise_m", entry->sample_noise), AS("seed", entry->sample_seed));
  }
  scree_json_text(json, "mesh_file", entry->mesh_file);
}

static void json_entry(scree_json *json, const scree_choice_report *report, size_t index) {
  const scree_choice_entry *entry = &report->entries[index];
  const scree_choice *choice = entry->choice;
  scree_json_object(json, NULL);
  SCREE_JSON_MEMBERS(json, OF(entry, file), OF(choice, triangle_count), OF(choice, area),
                     OF(choice, volume));
  json_levels(json, choice);
  json_recommended(json, report, index);
  json_sentences(json, "answer", report, index, scree_choice_answer);
  json_sentences(json, "warnings", report, index, scree_choice_warnings);
  json_pick(json, "paper", &choice->paper);
  json_pick(json, "robust", &choice->robust);
  SCREE_JSON_MEMBERS(json, OF(choice, paper_is_accident),
                     AS("default", scree_choice_rule_name(report->rule)));
  json_noise(json, choice);
  json_best(json, choice, report->options->weight);
  SCREE_JSON_MEMBERS(json, OF(choice, reference_area),
                     AS("floor_triangle_count", choice->floor_count),
                     AS("triangle_count_if_scanned_twice_as_fine", choice->paper_finer_count));
  json_source(json, entry);
  scree_json_maker(json, report->command_line);
  json_options(json, report);
  scree_json_end(json);
}

static void json_set_pick(scree_json *json, const char *key, const scree_set_pick *pick) {
  SCREE_JSON_ROW(json, key, OF(pick, rp), OF(pick, ip), AS("similar_rp_low", pick->rp_low),
                 AS("similar_rp_high", pick->rp_high));
}

static void json_set(scree_json *json, const scree_choice_report *report) {
  const scree_set_choice *set = report->set;
  scree_json_object(json, NULL);
  scree_json_bool(json, "set", true);
  scree_json_count(json, "object_count", set->object_count);
  SCREE_JSON_LIST (json, "levels", i, set->level_count) {
    SCREE_JSON_ROW(json, NULL, AS("rp", scree_choice_grid_rp(report->options, i)),
                   AS("ip", set->ip[i]), AS("ip_low", set->low[i]), AS("ip_high", set->high[i]));
  }
  json_sentences(json, "answer", report, report->entry_count, scree_choice_answer);
  json_sentences(json, "warnings", report, report->entry_count, scree_choice_warnings);
  SCREE_JSON_ROW_LIST (json, "recommended_triangle_counts", i, report->entry_count)
    if (report->entries[i].choice->fidelity)
      scree_json_count(json, NULL, report->entries[i].choice->recommended.triangle_count);
  json_set_pick(json, "paper", &set->paper);
  SCREE_JSON_MEMBERS(json, OF(set, paper_spread),
                     AS("triangle_ratio_if_scanned_twice_as_fine", set->paper_growth));
  scree_json_maker(json, report->command_line);
  json_options(json, report);
  scree_json_end(json);
}

scree_status scree_choice_json_write(const void *what, const char *path, bool overwrite,
                                     scree_error *error) {
  const scree_choice_report *report = what;
  scree_json file, *json = &file;
  SCREE_TRY(scree_json_open(json, path, overwrite, error));
  scree_json_array(json, NULL);
  for (size_t e = 0; e < report->entry_count; e++) json_entry(json, report, e);
  if (report->set) json_set(json, report);
  scree_json_end(json);
  return scree_json_commit(json, error);
}

/* ---- CSV ---- */

static void csv_level(FILE *stream, const scree_choice_level *level) {
  const double values[] = {level->area, level->volume,      level->eps_s,
                           level->ip,   level->worst_eps_s, level->robust_ip};
  scree_csv_number(stream, level->rp);
  putc(',', stream);
  if (level->triangle_count) fprintf(stream, "%zu", level->triangle_count);
  scree_csv_numbers(stream, values, sizeof values / sizeof *values);
}

static const char LEVEL_HEADER[] =
    "rp,triangle_count,area_m2,volume_m3,eps_s,ip,worst_eps_s,robust_ip";

static void csv_start(FILE *stream, const char *file, size_t triangle_count) {
  scree_quote(stream, SCREE_QUOTE_CSV, file);
  putc(',', stream);
  if (triangle_count) fprintf(stream, "%zu", triangle_count);
  putc(',', stream);
}

/* What was chosen here, and the errors beside area. */
static void csv_finish(FILE *stream, const char *choice,
                       const double errors[SCREE_SHAPE_ERROR_COUNT]) {
  fprintf(stream, ",%s", choice);
  scree_csv_numbers(stream, errors + SCREE_ERROR_VOLUME,
                    SCREE_SHAPE_ERROR_COUNT - SCREE_ERROR_VOLUME);
  putc('\n', stream);
}

/* What a choice off the grid has of a level's row; the rest is not known. */
static scree_choice_level csv_pick(const scree_pick *pick) {
  return (scree_choice_level){.rp = pick->rp,
                              .triangle_count = pick->triangle_count,
                              .area = pick->area,
                              .volume = pick->volume,
                              .eps_s = pick->eps_s,
                              .ip = pick->ip,
                              .worst_eps_s = pick->worst_eps_s,
                              .robust_ip = pick->robust_ip};
}

static void no_errors(double errors[SCREE_SHAPE_ERROR_COUNT]) {
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++) errors[e] = NAN;
}

static void csv_robust(FILE *stream, const scree_choice_entry *entry) {
  const scree_choice *choice = entry->choice;
  const scree_pick *pick = &choice->robust;
  scree_choice_level level = csv_pick(pick);
  double errors[SCREE_SHAPE_ERROR_COUNT];
  no_errors(errors);
  errors[SCREE_ERROR_VOLUME] = fabs(pick->volume - choice->volume) / fabs(choice->volume);
  csv_start(stream, entry->file, choice->triangle_count);
  csv_level(stream, &level);
  csv_finish(stream, "robust", errors);
}

static void csv_recommended(FILE *stream, const scree_choice_entry *entry) {
  const scree_choice *choice = entry->choice;
  const scree_choice_level level = csv_pick(&choice->recommended);
  double errors[SCREE_SHAPE_ERROR_COUNT];
  if (!choice->fidelity) return;
  recommended_errors(choice, errors);
  csv_start(stream, entry->file, choice->triangle_count);
  csv_level(stream, &level);
  csv_finish(stream, "recommended", errors);
}

/* The set's choice is an Rp and a mean: of no file, of no one count. */
static void csv_set(FILE *stream, const scree_set_pick *pick) {
  scree_choice_level level =
      csv_pick(&(scree_pick){pick->rp, 0, 0, NAN, NAN, NAN, pick->ip, NAN, NAN, 0, 0});
  double errors[SCREE_SHAPE_ERROR_COUNT];
  no_errors(errors);
  csv_start(stream, "", 0);
  csv_level(stream, &level);
  csv_finish(stream, "set paper", errors);
}

static void csv_entry(FILE *stream, const scree_choice_entry *entry) {
  const scree_choice *choice = entry->choice;
  for (size_t i = 0; i < choice->level_count; i++) {
    const scree_choice_level *level = &choice->levels[i];
    csv_start(stream, entry->file, choice->triangle_count);
    csv_level(stream, level);
    csv_finish(stream, i == choice->best[SCREE_ERROR_AREA] ? "paper" : "", level->errors);
  }
  csv_robust(stream, entry);
  csv_recommended(stream, entry);
}

scree_status scree_choice_csv_write(const void *what, const char *path, bool overwrite,
                                    scree_error *error) {
  const scree_choice_report *report = what;
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  fprintf(output.stream, "file,scan_triangle_count,%s,choice", LEVEL_HEADER);
  for (int e = SCREE_ERROR_VOLUME; e < SCREE_SHAPE_ERROR_COUNT; e++)
    fprintf(output.stream, ",error_%s", scree_shape_error_name((scree_shape_error)e));
  putc('\n', output.stream);
  for (size_t k = 0; k < report->entry_count; k++) csv_entry(output.stream, &report->entries[k]);
  if (report->set && report->entry_count > 1) csv_set(output.stream, &report->set->paper);
  return scree_output_commit(&output, error);
}

scree_status scree_choice_curve_csv_write(const scree_choice_entry *entry, const char *path,
                                          bool overwrite, scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  fprintf(output.stream, "%s\n", LEVEL_HEADER);
  const scree_choice *choice = entry->choice;
  for (size_t i = 0; i < choice->trace_count; i++) {
    if (i + 1 < choice->trace_count &&
        choice->trace[i].level_index == choice->trace[i + 1].level_index)
      continue;
    scree_choice_level level = choice->trace[i];
    level.rp = level.rp_reached; /* here Rp is what the level has, not what was asked for */
    csv_level(output.stream, &level);
    putc('\n', output.stream);
  }
  return scree_output_commit(&output, error);
}
