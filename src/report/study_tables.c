/* What a study says as JSON and CSV. */
#include "base/file.h"
#include "base/number.h"
#include "base/quote.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/program.h"
#include "report/provenance.h"

#include <math.h>
#include <string.h>

static void put_summary(scree_json *json, const char *key, const scree_summary *s) {
  SCREE_JSON_ROW(json, key, OF(s, count), OF(s, mean), OF(s, mean_low), OF(s, mean_high), OF(s, sd),
                 OF(s, sd_low), OF(s, sd_high), OF(s, cv));
}

static void put_counts(scree_json *json, const scree_study_counts *c) {
  SCREE_JSON_ROW(json, "runs", OF(c, done), OF(c, failed), OF(c, running), OF(c, leased),
                 OF(c, waiting));
}

/* What is summarised of a point's runs: the angle, the time, and the numbers of heaps. */
static size_t summary_count(const scree_study_result *r) {
  return 2 + r->number_count;
}
static const char *summary_name(const scree_study_result *r, size_t which) {
  return which == 0 ? "angle_deg" : which == 1 ? "seconds" : r->numbers[which - 2];
}
static const scree_summary *summary_of(const scree_point_result *p, size_t which) {
  return which == 0 ? &p->angle_deg : which == 1 ? &p->seconds : &p->numbers[which - 2];
}

/* The answer in words, and of each answer what the factors do. */
static void put_words(scree_json *json, const scree_study_result *r) {
  scree_words words;
  scree_study_words(r, 0, &words);
  scree_json_words(json, &words);
  SCREE_JSON_LIST (json, "told", k, r->answer_count ? r->answer_count : 1) {
    scree_effect effects[SCREE_MOST_EFFECTS];
    char finding[300];
    double sd, half;
    size_t count = scree_study_effects(r, k, effects);
    scree_study_words(r, k, &words);
    scree_study_finding(r, k, finding, sizeof finding);
    scree_study_scatter(r, k, &sd, &half);
    scree_json_object(json, NULL);
    SCREE_JSON_MEMBERS(json, AS("name", r->answer_count ? r->answers[k] : "angle_deg"),
                       AS("unit", r->answer_count ? r->units[k] : "deg"),
                       AS("sentence", words.answer), AS("finding", finding), AS("scatter", sd),
                       AS("half", half));
    SCREE_JSON_LIST (json, "effects", i, count)
      SCREE_JSON_ROW(json, NULL, OF(&effects[i], factor), OF(&effects[i], other),
                     OF(&effects[i], from), OF(&effects[i], to), OF(&effects[i], size),
                     OF(&effects[i], half));
    scree_json_end(json);
  }
}

static void put_point(scree_json *json, const scree_study_result *r, const scree_point_result *p) {
  scree_json_object(json, NULL);
  SCREE_JSON_MEMBERS(json, OF(p, label), OF(p, rp), OF(p, shapes), OF(p, pile));
  scree_json_row_object(json, "factors");
  for (size_t k = 0; k < r->factor_count; k++) {
    double number;
    if (scree_number_read(p->values[k], &number))
      scree_json_number(json, r->factors[k], number);
    else
      scree_json_text(json, r->factors[k], p->values[k]);
  }
  scree_json_end(json);
  put_counts(json, &p->counts);
  SCREE_JSON_MEMBERS(json, OF(p, heap_count), OF(p, triangle_count));
  for (size_t k = 0; k < summary_count(r); k++)
    put_summary(json, summary_name(r, k), summary_of(p, k));
  scree_json_object(json, "answers");
  for (size_t k = 0; k < r->answer_count; k++) put_summary(json, r->answers[k], &p->answers[k]);
  scree_json_end(json);
  scree_json_object(json, "rotation");
  scree_json_numbers(json, "time", p->time, p->series_count);
  scree_json_numbers(json, "mean", p->rotation, p->series_count);
  scree_json_numbers(json, "low", p->rotation_low, p->series_count);
  scree_json_numbers(json, "high", p->rotation_high, p->series_count);
  scree_json_end(json);
  scree_json_end(json);
}

static void put_comparison(scree_json *json, const scree_study_result *r, size_t point,
                           const scree_comparison *c) {
  SCREE_JSON_ROW(json, NULL, AS("rp", r->points[point].rp), OF(c, difference), OF(c, low),
                 OF(c, high), OF(c, degrees), OF(c, p_equivalence), OF(c, p_difference),
                 OF(c, equivalent), OF(c, different), OF(c, count_needed));
}

static void put_pick(scree_json *json, const char *key, const scree_rp_pick *pick) {
  SCREE_JSON_ROW(json, key, OF(pick, low), OF(pick, mean), OF(pick, high),
                 AS("in_converged_range", pick->in_range == SCREE_IN_RANGE_YES  ? "yes"
                                          : pick->in_range == SCREE_IN_RANGE_NO ? "no"
                                                                                : "unknown"));
}

static void put_family(scree_json *json, const scree_study_result *r,
                       const scree_family_result *f) {
  scree_json_object(json, NULL);
  SCREE_JSON_MEMBERS(
      json, OF(f, label), AS("finest", r->points[f->levels[f->level_count - 1]].rp),
      OF(f, converged),
      AS("converged_from", f->converged ? r->points[f->levels[f->converged_from]].rp : NULL));
  put_pick(json, "chosen_by_ip", &f->by_ip);
  put_pick(json, "chosen_by_robust", &f->by_robust);
  put_pick(json, "recommended", &f->recommended);
  scree_json_array(json, "against_finest");
  for (size_t k = 0; k + 1 < f->level_count; k++)
    put_comparison(json, r, f->levels[k], &f->comparisons[k]);
  scree_json_end(json);
  const scree_power_law none = {0, NAN, NAN, NAN, NAN, NAN},
                        *law = f->time_law.count ? &f->time_law : &none;
  SCREE_JSON_ROW(json, "time_law", OF(law, count), OF(law, factor), OF(law, exponent),
                 OF(law, exponent_low), OF(law, exponent_high), OF(law, r2));
  scree_json_object(json, "time_polynomial");
  scree_json_count(json, "count", f->time_curve.count);
  scree_json_numbers(json, "coefficients", f->time_curve.coefficient,
                     f->time_curve.count ? (size_t)f->time_curve.degree + 1 : 0);
  SCREE_JSON_MEMBERS(json, AS("rms", f->time_curve.count ? f->time_curve.rms : NAN),
                     AS("r2", f->time_curve.count ? f->time_curve.r2 : NAN));
  scree_json_end(json);
  scree_json_end(json);
}

scree_status scree_study_json_write(const void *result, const char *path, bool overwrite,
                                    scree_error *error) {
  const scree_study_result *r = result;
  scree_json file, *json = &file;
  SCREE_TRY(scree_json_open(json, path, overwrite, error));
  scree_json_object(json, NULL);
  SCREE_JSON_MEMBERS(json, OF(r, version), OF(r, name), OF(r, design), OF(r, method), OF(r, angle),
                     OF(r, seed));
  scree_json_origin(json, &r->origin);
  SCREE_JSON_MEMBERS(json, AS("replicates", r->replicate_count), OF(r, margin_deg),
                     OF(r, confidence));
  put_words(json, r);
  put_counts(json, &r->counts);
  SCREE_JSON_MEMBERS(json, AS("workers", r->worker_count), OF(r, seconds_spent),
                     OF(r, seconds_left), OF(r, mixed_versions));
  scree_json_object(json, "units");
  for (size_t k = 0; k < r->answer_count; k++) scree_json_text(json, r->answers[k], r->units[k]);
  scree_json_end(json);
  SCREE_JSON_LIST (json, "points", i, r->point_count) put_point(json, r, &r->points[i]);
  SCREE_JSON_LIST (json, "families", i, r->family_count) put_family(json, r, &r->families[i]);
  SCREE_JSON_LIST (json, "failures", i, r->failure_count) {
    SCREE_JSON_ROW(json, NULL, OF(&r->failures[i], label), OF(&r->failures[i], replicate),
                   OF(&r->failures[i], reason));
  }
  scree_json_end(json);
  return scree_json_commit(json, error);
}

/* ---- CSV ---- */

/* What no point has gets no columns. */
static bool any_has(const scree_study_result *r, size_t which) {
  for (size_t i = 0; i < r->point_count; i++)
    if (summary_of(&r->points[i], which)->count) return true;
  return false;
}

static void csv_summary(FILE *stream, const scree_summary *s) {
  const double values[] = {s->mean, s->mean_low, s->mean_high, s->sd, s->sd_low, s->sd_high, s->cv};
  scree_csv_numbers(stream, values, sizeof values / sizeof *values);
}

/* Factors that have no column of their own. */
static bool has_column(const char *factor) {
  return !strcmp(factor, "rp") || !strcmp(factor, "shapes");
}

scree_status scree_study_csv_write(const void *what, const char *path, bool overwrite,
                                   scree_error *error) {
  const scree_study_result *result = what;
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  FILE *stream = output.stream;
  fputs("label,rp,shapes", stream);
  for (size_t k = 0; k < result->factor_count; k++) {
    if (has_column(result->factors[k])) continue;
    putc(',', stream);
    scree_quote(stream, SCREE_QUOTE_CSV, result->factors[k]);
  }
  fputs(",done,failed,waiting,heap_count,triangle_count", stream);
  for (size_t i = 0; i < summary_count(result); i++) {
    const char *name = summary_name(result, i);
    if (any_has(result, i))
      fprintf(stream, ",%s,%s_low,%s_high,%s_sd,%s_sd_low,%s_sd_high,%s_cv", name, name, name, name,
              name, name, name);
  }
  for (size_t k = 0; k < result->answer_count; k++) {
    static const char *const parts[] = {"", " low", " high", " sd", " sd low", " sd high", " cv"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
      char name[256];
      snprintf(name, sizeof name, "%.200s%s", result->answers[k], parts[i]);
      putc(',', stream);
      scree_quote(stream, SCREE_QUOTE_CSV, name);
    }
  }
  putc('\n', stream);
  for (size_t i = 0; i < result->point_count; i++) {
    const scree_point_result *p = &result->points[i];
    scree_quote(stream, SCREE_QUOTE_CSV, p->label);
    putc(',', stream);
    scree_quote(stream, SCREE_QUOTE_CSV, p->rp);
    putc(',', stream);
    scree_quote(stream, SCREE_QUOTE_CSV, p->shapes);
    for (size_t k = 0; k < result->factor_count; k++) {
      if (has_column(result->factors[k])) continue;
      putc(',', stream);
      scree_quote(stream, SCREE_QUOTE_CSV, p->values[k]);
    }
    fprintf(stream, ",%zu,%zu,%zu,%zu,", p->counts.done, p->counts.failed,
            p->counts.waiting + p->counts.leased + p->counts.running, p->heap_count);
    scree_csv_number(stream, p->triangle_count);
    for (size_t k = 0; k < summary_count(result); k++)
      if (any_has(result, k)) csv_summary(stream, summary_of(p, k));
    for (size_t k = 0; k < result->answer_count; k++) csv_summary(stream, &p->answers[k]);
    putc('\n', stream);
  }
  return scree_output_commit(&output, error);
}
