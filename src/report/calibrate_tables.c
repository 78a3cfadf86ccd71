/* A calibration's results as text, JSON and CSV. */
#include "base/file.h"
#include "base/platform.h"
#include "base/quote.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/program.h"
#include "report/provenance.h"

#include <math.h>
#include <string.h>

/* ---- text ---- */

static const double usual_half = 1.645; /* of a normal value, 90 % */

static const char *plural(size_t count) {
  return count == 1 ? "" : "s";
}

static void print_counts(const scree_calibration_result *r, FILE *s) {
  const scree_calibration_progress *p = &r->progress;
  char title[300];
  snprintf(title, sizeof title, "%.290s", r->title);
  scree_make_printable(title, '?');
  fprintf(s, "%s: %zu run%s in %zu round%s", title, p->done, plural(p->done), p->rounds,
          plural(p->rounds));
  if (p->failed) fprintf(s, ", %zu failed", p->failed);
  fprintf(s, "; %s\n",
          r->stopped                           ? r->stopped
          : p->done + p->failed < p->run_count ? "not ended yet"
                                               : "the next are to be planned");
}

static void print_head(const scree_calibration_result *r, FILE *s) {
  print_counts(r, s);
  for (size_t i = 0; i < r->failure_count && i < 5; i++) fprintf(s, "failed: %s\n", r->failures[i]);
}

static bool is_bounded(const scree_parameter_result *p) {
  return !isnan(p->at_least) || !isnan(p->at_most);
}

static void print_parameters(const scree_calibration_result *r, FILE *s) {
  fprintf(s, "\n%-24s %10s %10s  %-25s %9s\n", "parameter", "mean", "SD", "interval", "of range");
  for (size_t k = 0; k < r->parameter_count; k++) {
    const scree_parameter_result *p = &r->parameters[k];
    char bound[64];
    snprintf(bound, sizeof bound, "at %s %.3g", isnan(p->at_least) ? "most" : "least",
             isnan(p->at_least) ? p->at_most : p->at_least);
    fprintf(s, "%-24s %10.4g %10.3g  [%10.4g, %10.4g] %8.0f %%  %s\n", p->name, p->mean, p->sd,
            p->low, p->high, 100 * p->narrowed,
            p->identified   ? "identified"
            : is_bounded(p) ? bound
                            : "not identifiable");
  }
  fprintf(s, "intervals of %g %%; `of range`: their width beside that of the range\n",
          100 * r->confidence);
}

static void print_trades(const scree_calibration_result *r, FILE *s) {
  for (size_t i = 0; i < r->trade_count; i++) {
    const scree_trade *t = &r->trades[i];
    const char *a = r->parameters[t->a].name, *b = r->parameters[t->b].name;
    fprintf(s,
            "\n%s and %s trade against each other: %s %.3g with %s %.3g gives the same answers as "
            "%s %.3g with %s %.3g\n",
            a, b, a, t->ends[0][0], b, t->ends[0][1], a, t->ends[1][0], b, t->ends[1][1]);
  }
  for (size_t k = 0; k < r->parameter_count; k++)
    if (is_bounded(&r->parameters[k]))
      fprintf(s,
              "\n%s: its range ends before what agrees with the measurements does; only the other "
              "end is told by them\n",
              r->parameters[k].name);
  for (size_t k = 0; k < r->parameter_count; k++) {
    bool traded = r->parameters[k].identified || is_bounded(&r->parameters[k]);
    for (size_t i = 0; i < r->trade_count; i++)
      traded = traded || r->trades[i].a == k || r->trades[i].b == k;
    if (!traded)
      fprintf(s, "\n%s is not told by these measurements: values of %.3g to %.3g agree with them\n",
              r->parameters[k].name, r->parameters[k].low, r->parameters[k].high);
  }
}

static void print_answers(const scree_calibration_result *r, FILE *s) {
  fprintf(s, "\n%-24s %12s %12s  %-27s %-27s\n", "answer", "measured", "simulated",
          "interval of the mean", "of a single one");
  for (size_t i = 0; i < r->answer_count; i++) {
    const scree_answer_result *a = &r->answers[i];
    if (a->point_count) {
      fprintf(s, "%-24s a curve of %zu points, %s the interval; %.3g of it no setting has\n",
              a->name, a->point_count, a->inside ? "within" : "outside", a->unexplained);
    } else {
      char value[32] = "";
      if (a->measured) snprintf(value, sizeof value, "%.5g", a->value);
      fprintf(s, "%-24s %12s %12.5g  [%12.5g, %12.5g] [%12.5g, %12.5g]%s%s\n", a->name, value,
              a->mean, a->low, a->high, a->single_low, a->single_high,
              a->predicted ? "  predicted" : "",
              !a->measured ? ""
              : a->inside  ? ""
                           : "  OUTSIDE");
    }
    if (a->missing)
      fprintf(s, "  %zu run%s of %s gave no %s and %s left out\n", a->missing, plural(a->missing),
              a->experiment, a->answer, a->missing == 1 ? "was" : "were");
  }
}

/* Whether runs at the answer give what is expected of them. */
static void print_check(const scree_calibration_result *r, FILE *s) {
  bool begun = false;
  for (size_t i = 0; i < r->answer_count; i++) {
    const scree_answer_result *a = &r->answers[i];
    if (a->check_count == 0) continue;
    if (!begun) {
      fputs("\nchecked by runs at", s);
      for (size_t k = 0; k < r->parameter_count; k++)
        fprintf(s, "%s %s %.4g", k ? "," : "", r->parameters[k].name, r->parameters[k].nearest);
      fprintf(s, "; all together expected with %g %%\n", 100 * r->confidence);
      begun = true;
    }
    bool good = a->check_mean >= a->check_low && a->check_mean <= a->check_high;
    fprintf(s, "%-24s %12.5g, the mean of %zu; expected [%12.5g, %12.5g]%s\n", a->name,
            a->check_mean, a->check_count, a->check_low, a->check_high, good ? "" : "  OUTSIDE");
  }
}

/* Each measurement left out in turn. */
static void print_refits(const scree_calibration_result *r, FILE *s) {
  char hint[200];
  for (size_t i = 0; i < r->refit_count; i++) {
    const scree_refit *f = &r->refits[i];
    fprintf(s, "\nwithout %s the others %s:", f->without, f->fits ? "agree" : "do not agree");
    for (size_t k = 0; f->fits && k < r->parameter_count; k++)
      fprintf(s, "%s %s %.4g (%.4g to %.4g)", k ? "," : "", r->parameters[k].name, f->nearest[k],
              f->low[k], f->high[k]);
    if (!isnan(f->value_low)) fprintf(s, "; it would be %.5g to %.5g", f->value_low, f->value_high);
    for (size_t q = 0; !f->fits && q < r->answer_count; q++)
      if (r->answers[q].measured && !isnan(f->answers[q]) &&
          strcmp(r->answers[q].name, f->without) != 0)
        fprintf(s, " %s %.5g for %.5g", r->answers[q].name, f->answers[q], r->answers[q].value);
    putc('\n', s);
  }
  fputs("\nusually missing:\n", s);
  for (size_t i = 0; i < scree_calibration_hints(r, i, hint, sizeof hint); i++)
    fprintf(s, "  %s\n", hint);
}

static void print_search(const scree_calibration_result *r, FILE *s) {
  fprintf(s, "\n%s %s\n", r->maximise ? "the most of" : "the least of", r->sought);
  for (size_t k = 0; k < r->parameter_count; k++) fprintf(s, "%14.14s ", r->parameters[k].name);
  fprintf(s, "%12s  %-27s %8s %5s\n", "mean", "interval", "allowed", "runs");
  for (size_t i = 0; i < r->setting_count; i++) {
    const scree_setting *c = &r->settings[i];
    for (size_t k = 0; k < r->parameter_count; k++) fprintf(s, "%14.6g ", c->values[k]);
    fprintf(s, "%12.5g  [%12.5g, %12.5g] %6.0f %% %5zu%s\n", c->mean, c->low, c->high,
            100 * c->allowed, c->run_count, i == 0 ? "  best" : "");
  }
  fprintf(
      s,
      "intervals of %g %% of the mean, by runs at the best; allowed: probability that all limits "
      "hold\n",
      100 * r->confidence);
  if (r->setting_count && r->settings[0].allowed < r->confidence)
    fputs("no setting that was tried likely keeps the limits; the first comes nearest\n", s);
}

/* ---- the answer ---- */

enum { MOST_TARGETS = 3, LINE = 110 };

/* Broken at blanks. */
static void print_wrapped(const char *text, FILE *s) {
  while (*text) {
    size_t length = strlen(text), end = length;
    if (length > LINE)
      for (end = LINE; end > 0 && text[end] != ' ';) end--;
    if (end == 0) end = length;
    fprintf(s, "%.*s\n", (int)end, text);
    text += end + strspn(text + end, " ");
  }
}

/* What was measured beside what runs at the nearest setting gave. */
static void print_targets(const scree_calibration_result *r, FILE *s) {
  size_t shown = 0, left = 0;
  for (size_t i = 0; i < r->answer_count; i++) {
    const scree_answer_result *a = &r->answers[i];
    char name[40];
    int digits = scree_words_decimals(a->gap_sd);
    if (!a->measured || isnan(a->gap)) continue;
    if (shown == MOST_TARGETS) {
      left++;
      continue;
    }
    if (shown++ == 0) fprintf(s, "%-24s %12s %12s  off by (90 %%)\n", "", "measured", "simulated");
    scree_words_name(a->name, name, sizeof name);
    fprintf(s, "%-24s %12.*f %12.*f  %+.*f +- %.*f%s%s%s\n", name, digits, a->value, digits,
            a->value + a->gap, digits, a->gap, digits, usual_half * a->gap_sd, *a->unit ? " " : "",
            a->unit, a->met ? "" : "  missed");
  }
  if (left) fprintf(s, "and %zu more\n", left);
}

static void print_nearest(const scree_calibration_result *r, FILE *s) {
  char hint[200];
  fputs("nearest, not fitted:", s);
  for (size_t k = 0; k < r->parameter_count; k++)
    fprintf(s, "%s %s %.4g", k ? "," : "", r->parameters[k].name, r->parameters[k].nearest);
  scree_calibration_hints(r, 0, hint, sizeof hint);
  fprintf(s, "\nusually missing: %s\n", hint);
}

static void print_answer(const scree_calibration_result *r, FILE *s) {
  scree_words words;
  scree_calibration_words(r, &words);
  fprintf(s, "%s.\n", words.state);
  print_wrapped(words.answer, s);
  print_wrapped(words.but, s);
  if (!r->is_search) print_targets(r, s);
  if (r->agreement == SCREE_AGREEMENT_NO) print_nearest(r, s);
  if (*words.next) {
    char next[600];
    snprintf(next, sizeof next, "Next: %s", words.next);
    print_wrapped(next, s);
  }
}

void scree_calibration_print(const scree_calibration_result *result, bool all, FILE *stream) {
  if (all) print_head(result, stream);
  print_answer(result, stream);
  if (!all) {
    print_counts(result, stream);
    return;
  }
  if (result->is_search) {
    print_search(result, stream);
    return;
  }
  if (result->agreement == SCREE_AGREEMENT_NO) {
    print_refits(result, stream);
    return;
  }
  print_parameters(result, stream);
  print_trades(result, stream);
  print_answers(result, stream);
  print_check(result, stream);
}

/* ---- JSON ---- */

static void put_parameters(scree_json *json, const scree_calibration_result *r) {
  char finding[200];
  SCREE_JSON_LIST (json, "parameters", k, r->parameter_count) {
    const scree_parameter_result *p = &r->parameters[k];
    scree_json_object(json, NULL);
    SCREE_JSON_MEMBERS(json, OF(p, name), OF(p, unit),
                       AS("scale", p->logarithmic ? "log" : "linear"), OF(p, from), OF(p, to));
    if (!r->is_search) scree_json_number(json, "nearest", p->nearest);
    if (!r->is_search && r->agreement != SCREE_AGREEMENT_NO) {
      SCREE_JSON_MEMBERS(json, OF(p, mean), OF(p, sd), OF(p, median), OF(p, low), OF(p, high),
                         OF(p, narrowed), OF(p, identified), OF(p, at_least), OF(p, at_most));
      scree_calibration_parameter_finding(p, finding, sizeof finding);
      scree_json_text(json, "finding", finding);
    }
    scree_json_end(json);
  }
}

static void put_trades(scree_json *json, const scree_calibration_result *r) {
  SCREE_JSON_LIST (json, "trades", i, r->trade_count) {
    const scree_trade *t = &r->trades[i];
    scree_json_object(json, NULL);
    SCREE_JSON_MEMBERS(json, AS("a", r->parameters[t->a].name), AS("b", r->parameters[t->b].name),
                       OF(t, correlation), OF(t, share));
    scree_json_numbers(json, "one_end", t->ends[0], 2);
    scree_json_numbers(json, "other_end", t->ends[1], 2);
    scree_json_end(json);
  }
}

static void put_answer(scree_json *json, const scree_calibration_result *r,
                       const scree_answer_result *a) {
  bool fits = r->agreement != SCREE_AGREEMENT_NO;
  char finding[200];
  scree_calibration_answer_finding(r, a, finding, sizeof finding);
  scree_json_object(json, NULL);
  SCREE_JSON_MEMBERS(json, AS("finding", finding), OF(a, name), OF(a, experiment), OF(a, answer),
                     OF(a, unit), OF(a, measured), OF(a, predicted), OF(a, value),
                     OF(a, uncertainty), OF(a, scatter), AS("repeats", a->repeat_count));
  if (fits)
    SCREE_JSON_MEMBERS(json, OF(a, mean), OF(a, low), OF(a, high), OF(a, single_low),
                       OF(a, single_high), OF(a, inside));
  SCREE_JSON_MEMBERS(json, OF(a, noise), OF(a, lowest), OF(a, highest), OF(a, gap), OF(a, gap_sd),
                     OF(a, met));
  if (!isnan(a->counted_low)) SCREE_JSON_MEMBERS(json, OF(a, counted_low), OF(a, counted_high));
  SCREE_JSON_MEMBERS(json, AS("runs", a->run_count), OF(a, missing));
  SCREE_JSON_ROW(json, "check", AS("runs", a->check_count), AS("mean", a->check_mean),
                 AS("low", a->check_low), AS("high", a->check_high));
  if (a->point_count && fits) {
    scree_json_numbers(json, "x", a->x, a->point_count);
    scree_json_numbers(json, "y", a->y, a->point_count);
    scree_json_numbers(json, "curve_mean", a->curve_mean, a->point_count);
    scree_json_numbers(json, "curve_low", a->curve_low, a->point_count);
    scree_json_numbers(json, "curve_high", a->curve_high, a->point_count);
    scree_json_number(json, "unexplained", a->unexplained);
  }
  scree_json_end(json);
}

static void put_advice(scree_json *json, const scree_calibration_result *r) {
  SCREE_JSON_LIST (json, "advice", i, r->advice_count) {
    scree_json_object(json, NULL);
    SCREE_JSON_MEMBERS(json, AS("name", r->advice[i].name),
                       AS("repeats", r->advice[i].repeat_count));
    scree_json_numbers(json, "narrowed", r->advice[i].narrowed, r->parameter_count);
    scree_json_count(json, "identified", r->advice[i].identified);
    scree_json_end(json);
  }
}

/* Some of them, evenly: all are in samples.csv. */
static void put_samples(scree_json *json, const scree_calibration_result *r) {
  enum { MOST_ROWS = 300 };
  size_t count = r->sample_count < MOST_ROWS ? r->sample_count : MOST_ROWS;
  SCREE_JSON_LIST (json, "samples", i, count)
    scree_json_numbers(json, NULL, r->samples + i * r->sample_count / count * r->parameter_count,
                       r->parameter_count);
}

static void put_settings(scree_json *json, const scree_calibration_result *r) {
  SCREE_JSON_MEMBERS(json, OF(r, sought), OF(r, maximise));
  SCREE_JSON_LIST (json, "settings", i, r->setting_count) {
    const scree_setting *c = &r->settings[i];
    scree_json_object(json, NULL);
    scree_json_numbers(json, "values", c->values, r->parameter_count);
    SCREE_JSON_MEMBERS(json, OF(c, mean), OF(c, low), OF(c, high), OF(c, allowed),
                       AS("runs", c->run_count));
    scree_json_end(json);
  }
}

/* Whether a setting gives what was measured; null: not checked yet. */
static void put_fit(scree_json *json, const scree_calibration_result *r) {
  scree_words words;
  char hint[200];
  scree_calibration_words(r, &words);
  scree_json_words(json, &words);
  if (r->is_search) return;
  if (r->agreement == SCREE_AGREEMENT_OPEN)
    scree_json_text(json, "fits", NULL);
  else
    scree_json_bool(json, "fits", r->agreement == SCREE_AGREEMENT_YES);
  SCREE_JSON_MEMBERS(json, OF(r, misfit), OF(r, misfit_limit));
  if (r->agreement != SCREE_AGREEMENT_NO) return;
  SCREE_JSON_LIST (json, "hints", i, scree_calibration_hints(r, SIZE_MAX, hint, sizeof hint)) {
    scree_calibration_hints(r, i, hint, sizeof hint);
    scree_json_text(json, NULL, hint);
  }
  SCREE_JSON_LIST (json, "refits", i, r->refit_count) {
    const scree_refit *f = &r->refits[i];
    scree_json_object(json, NULL);
    SCREE_JSON_MEMBERS(json, OF(f, without), OF(f, fits));
    scree_json_numbers(json, "nearest", f->nearest, r->parameter_count);
    scree_json_numbers(json, "low", f->low, r->parameter_count);
    scree_json_numbers(json, "high", f->high, r->parameter_count);
    scree_json_numbers(json, "answers", f->answers, r->answer_count);
    SCREE_JSON_MEMBERS(json, OF(f, value_low), OF(f, value_high));
    scree_json_end(json);
  }
}

static void put_runs(scree_json *json, const scree_calibration_result *r) {
  SCREE_JSON_LIST (json, "all_runs", i, r->run_count) {
    const scree_calibration_run *run = &r->runs[i];
    scree_json_row_object(json, NULL);
    SCREE_JSON_MEMBERS(json, OF(run, experiment), OF(run, seed), OF(run, check));
    scree_json_numbers(json, "values", run->values, r->parameter_count);
    scree_json_numbers(json, "answers", run->answers, r->answer_count);
    scree_json_end(json);
  }
}

scree_status scree_calibration_json_write(const void *result, const char *path, bool overwrite,
                                          scree_error *error) {
  const scree_calibration_result *r = result;
  scree_json file, *json = &file;
  SCREE_TRY(scree_json_open(json, path, overwrite, error));
  size_t width = r->is_search ? 2 : 1 + r->parameter_count;
  char finding[200];
  scree_json_object(json, NULL);
  SCREE_JSON_MEMBERS(json, OF(r, title), OF(r, version), OF(r, seed), OF(r, confidence),
                     OF(r, stopped));
  put_fit(json, r);
  scree_json_origin(json, &r->origin);
  SCREE_JSON_MEMBERS(json, OF(&r->progress, rounds), AS("runs", r->progress.run_count),
                     OF(&r->progress, done), OF(&r->progress, failed), OF(&r->progress, budget),
                     OF(&r->progress, seconds), OF(&r->progress, planning_seconds));
  put_parameters(json, r);
  if (!r->is_search) put_trades(json, r);
  SCREE_JSON_LIST (json, "answers", i, r->answer_count) put_answer(json, r, &r->answers[i]);
  if (r->is_search) {
    put_settings(json, r);
  } else {
    put_advice(json, r);
    put_samples(json, r);
  }
  if (r->history_count) scree_calibration_history_finding(r, finding, sizeof finding);
  scree_json_text(json, "history_finding", r->history_count ? finding : NULL);
  SCREE_JSON_LIST (json, "history", i, r->history_count)
    scree_json_numbers(json, NULL, r->history + i * width, width);
  put_runs(json, r);
  SCREE_JSON_LIST (json, "failures", i, r->failure_count)
    scree_json_text(json, NULL, r->failures[i]);
  scree_json_end(json);
  return scree_json_commit(json, error);
}

/* ---- CSV ---- */

static void put_row(FILE *s, const double *values, size_t count) {
  scree_csv_number(s, values[0]);
  scree_csv_numbers(s, values + 1, count - 1);
}

scree_status scree_calibration_csv_write(const void *what, const char *path, bool overwrite,
                                         scree_error *error) {
  const scree_calibration_result *r = what;
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  FILE *s = output.stream;
  for (size_t k = 0; k < r->parameter_count; k++) {
    if (k) putc(',', s);
    scree_quote(s, SCREE_QUOTE_CSV, r->parameters[k].name);
  }
  fputs(r->is_search ? ",mean,low,high,allowed,runs\n" : "\n", s);
  for (size_t i = 0; !r->is_search && i < r->sample_count; i++) {
    put_row(s, r->samples + i * r->parameter_count, r->parameter_count);
    putc('\n', s);
  }
  for (size_t i = 0; r->is_search && i < r->setting_count; i++) {
    const scree_setting *c = &r->settings[i];
    const double rest[] = {c->mean, c->low, c->high, c->allowed, (double)c->run_count};
    put_row(s, c->values, r->parameter_count);
    scree_csv_numbers(s, rest, sizeof rest / sizeof *rest);
    putc('\n', s);
  }
  return scree_output_commit(&output, error);
}
