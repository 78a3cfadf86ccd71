/* What a calibration says in one sentence, and what would mislead. Every number in it is one of the
 * result's. */
#include "base/error.h"
#include "base/number.h"
#include "report/program.h"

#include <math.h>
#include <string.h>

typedef struct text {
  char *to;
  size_t size;
} text;

#define say(t, ...) scree_add_text((t)->to, (t)->size, __VA_ARGS__)

static const char *article(const char *name) {
  return strchr("aeiouAEIOU", *name) ? "an" : "a";
}

static void say_name(text *t, const char *name) {
  char words[100];
  scree_words_name(name, words, sizeof words);
  say(t, "%s", words);
}

static void say_value(text *t, double value, double spread, const char *unit) {
  say(t, "%.*f%s%s", scree_words_decimals(spread), value, *unit ? " " : "", unit);
}

/* Few in words. */
static void say_count(text *t, size_t count) {
  static const char *const words[] = {"no",   "one", "two",   "three", "four",
                                      "five", "six", "seven", "eight", "nine"};
  if (count < sizeof words / sizeof *words)
    say(t, "%s", words[count]);
  else
    say(t, "%zu", count);
}

/* Between the items of a list. */
static void say_comma(text *t, size_t index, size_t count, const char *last) {
  if (index > 0) say(t, "%s", index + 1 < count ? ", " : last);
}

static void capitalise(text *t, size_t at) {
  if (t->to[at] >= 'a' && t->to[at] <= 'z') t->to[at] = (char)(t->to[at] - 'a' + 'A');
}

/* ---- where it misses ---- */

static bool is_scalar_target(const scree_answer_result *a) {
  return a->measured && !a->predicted && a->point_count == 0;
}

static const scree_answer_result *worst_of(const scree_calibration_result *r) {
  const scree_answer_result *worst = NULL;
  for (size_t i = 0; i < r->answer_count; i++) {
    const scree_answer_result *a = &r->answers[i];
    if (!is_scalar_target(a) || isnan(a->gap)) continue;
    if (!worst || fabs(a->gap) / a->gap_sd > fabs(worst->gap) / worst->gap_sd) worst = a;
  }
  return worst;
}

/* How far what was measured lies beyond all runs, in standard deviations. */
static double beyond(const scree_answer_result *a) {
  if (!is_scalar_target(a) || isnan(a->gap_sd)) return 0;
  return fmax(a->value - a->highest, a->lowest - a->value) / a->gap_sd;
}

static void say_out_of_reach(text *t, const scree_calibration_result *r,
                             const scree_answer_result *a) {
  bool high = a->value > a->highest;
  size_t missed = 0, measured = 0;
  for (size_t i = 0; i < r->answer_count; i++) {
    missed += is_scalar_target(&r->answers[i]) && !r->answers[i].met;
    measured += is_scalar_target(&r->answers[i]);
  }
  say(t, "No setting reaches %s ", article(a->name));
  say_name(t, a->name);
  say(t, " of ");
  say_value(t, a->value, a->gap_sd, a->unit);
  say(t, ": the %s of %zu runs is ", high ? "highest" : "lowest", r->run_count);
  say_value(t, high ? a->highest : a->lowest, a->gap_sd, a->unit);
  if (measured == 2 && missed == 2)
    say(t, ", and the nearest setting misses both measurements");
  else if (measured > 1 && missed == measured)
    say(t, ", and the nearest setting misses all "), say_count(t, measured),
        say(t, " measurements");
  else if (missed > 1)
    say(t, ", and the nearest setting misses %zu of %zu measurements", missed, measured);
  say(t, ".");
}

static void say_not_at_once(text *t, const scree_calibration_result *r) {
  size_t missed = 0, told = 0;
  for (size_t i = 0; i < r->answer_count; i++)
    missed += is_scalar_target(&r->answers[i]) && !r->answers[i].met;
  say(t, "Each measurement can be met, not all at once");
  for (size_t i = 0; i < r->answer_count; i++) {
    const scree_answer_result *a = &r->answers[i];
    if (!is_scalar_target(a) || a->met || isnan(a->gap) || told == 3) continue;
    say(t,
        told == 0                       ? ": the nearest setting gives %s "
        : told + 1 < missed && told < 2 ? ", %s "
                                        : " and %s ",
        article(a->name));
    told++;
    say_name(t, a->name);
    say(t, " of ");
    say_value(t, a->value + a->gap, a->gap_sd, a->unit);
    say(t, " for ");
    say_value(t, a->value, a->gap_sd, a->unit);
  }
  say(t, ".");
}

static void say_misfit(const scree_calibration_result *r, text *t, text *but) {
  const scree_answer_result *out = NULL;
  size_t agree = 0, told = 0;
  for (size_t i = 0; i < r->answer_count; i++)
    if (beyond(&r->answers[i]) > 1 && (!out || beyond(&r->answers[i]) > beyond(out)))
      out = &r->answers[i];
  if (out)
    say_out_of_reach(t, r, out);
  else if (worst_of(r))
    say_not_at_once(t, r);
  else
    say(t, "No setting gives what was measured: runs at the nearest one gave no such answer.");
  say(but, "Nothing is fitted, nothing is predicted.");
  for (size_t i = 0; i < r->refit_count; i++) agree += r->refits[i].fits;
  for (size_t i = 0; i < r->refit_count; i++) {
    if (!r->refits[i].fits) continue;
    say(but, told == 0          ? " Without the "
             : told + 1 < agree ? ", without the "
                                : " or without the ");
    told++;
    say_name(but, r->refits[i].without);
  }
  if (agree)
    say(but, " the %s: look there first.",
        r->refit_count > 2 ? "others agree" : "other can be met");
  else if (r->refit_count > 2)
    say(but, " Without any one of them the others do not agree either.");
}

size_t scree_calibration_hints(const scree_calibration_result *r, size_t index, char *to,
                               size_t size) {
  text t = {to, size};
  size_t count = 0;
  *to = 0;
  for (size_t k = 0; k < r->parameter_count; k++) {
    const scree_parameter_result *p = &r->parameters[k];
    double low = p->logarithmic ? log(p->nearest / p->from) / log(p->to / p->from)
                                : (p->nearest - p->from) / (p->to - p->from);
    if (low > 0.02 && low < 0.98) continue;
    if (count++ != index) continue;
    say(&t, "The range of ");
    say_name(&t, p->name);
    say(&t, " ends at %.4g, where the nearest setting is: a wider one?",
        low < 0.5 ? p->from : p->to);
  }
  static const char *const usual[] = {
      "A parameter or a law that was not varied: cohesion, rolling friction, the shape.",
      "The measurement: another state of the material, another way of measuring, its uncertainty."};
  for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
    if (count++ == index) say(&t, "%s", usual[i]);
  return count;
}

/* ---- where it fits ---- */

static bool is_bound(const scree_parameter_result *p) {
  return !isnan(p->at_least) || !isnan(p->at_most);
}

static void say_parameter(text *t, const scree_parameter_result *p) {
  double width = p->high - p->low;
  say_name(t, p->name);
  if (p->identified) {
    say(t, " ");
    say_value(t, p->mean, width, p->unit);
    say(t, " (%.*f to %.*f)", scree_words_decimals(width), p->low, scree_words_decimals(width),
        p->high);
  } else if (is_bound(p)) {
    bool least = !isnan(p->at_least);
    say(t, " is at %s ", least ? "least" : "most");
    say_value(t, least ? p->at_least : p->at_most, width, p->unit);
  } else {
    say(t, " is not told");
  }
}

static void say_fit(const scree_calibration_result *r, text *t, text *but) {
  size_t measured = 0, identified = 0, other = 0, told = 0;
  for (size_t i = 0; i < r->answer_count; i++) measured += r->answers[i].measured;
  for (size_t k = 0; k < r->parameter_count; k++) identified += r->parameters[k].identified;
  for (size_t k = 0; k < r->parameter_count; k++) {
    if (!r->parameters[k].identified) continue;
    say_comma(t, told++, identified, " and ");
    say_parameter(t, &r->parameters[k]);
  }
  if (identified) say(t, " give%s ", identified == 1 ? "s" : "");
  if (identified && measured <= 2)
    say(t, "%s that %s measured", measured == 1 ? "the answer" : "both answers",
        measured == 1 ? "was" : "were");
  else if (identified)
    say(t, "all "), say_count(t, measured), say(t, " answers that were measured");
  else if (measured == 1)
    say(t, "the measurement is met");
  else
    say(t, "the "), say_count(t, measured), say(t, " measurements are met");
  for (size_t k = 0; k < r->parameter_count; k++) {
    if (r->parameters[k].identified) continue;
    say(t, other++ == 0 ? "; " : ", ");
    say_parameter(t, &r->parameters[k]);
  }
  say(t, ".");
  capitalise(t, 0);
  say(but, "Intervals hold %g %%.", 100 * r->confidence);
  if (r->trade_count) {
    const scree_trade *p = &r->trades[0];
    size_t begin = strlen(but->to) + 1;
    say(but, " ");
    say_name(but, r->parameters[p->a].name);
    say(but, " %.2g with ", p->ends[0][0]);
    say_name(but, r->parameters[p->b].name);
    say(but, " %.2g does as well as %.2g with %.2g.", p->ends[0][1], p->ends[1][0], p->ends[1][1]);
    capitalise(but, begin);
  }
  for (size_t i = 0; i < r->answer_count; i++) {
    const scree_answer_result *a = &r->answers[i];
    if (isnan(a->counted_low)) continue;
    size_t begin = strlen(but->to) + 1;
    double width = a->counted_high - a->counted_low;
    int digits = scree_words_decimals(width);
    say(but, " ");
    say_name(but, a->name);
    say(but, ", predicted, came out ");
    say_value(but, a->check_mean, width, a->unit);
    say(but, ", outside %.*f to %.*f; with that miss counted it is %.*f to %.*f.", digits,
        a->check_low, digits, a->check_high, digits, a->counted_low, digits, a->counted_high);
    capitalise(but, begin);
  }
}

/* ---- a search ---- */

/* Cost of so many runs as those that ended. */
static void say_runs(const scree_calibration_result *r, size_t count, text *next) {
  char cost[SCREE_NUMBER_SIZE];
  double ended = (double)(r->progress.done + r->progress.failed);
  scree_seconds_text(r->progress.seconds / fmax(1, ended) * (double)count, cost);
  say(next, "%zu run%s, %s of a processor", count, count == 1 ? "" : "s", cost);
}

/* What to measure once more, or how to go on. */
static void say_next(const scree_calibration_result *r, text *next) {
  const scree_advice *a = r->advice_count ? r->advice : NULL;
  if (r->agreement == SCREE_AGREEMENT_NO) {
    say(next, "give the model what is missing, or measure again, and calibrate anew: ");
    say_runs(r, r->progress.run_count, next);
    say(next, ".");
    return;
  }
  if (r->agreement == SCREE_AGREEMENT_OPEN) {
    say(next, "go on with the same command: settings are not checked by runs yet.");
    return;
  }
  for (size_t k = 0; k < r->parameter_count; k++) {
    const scree_parameter_result *p = &r->parameters[k];
    say(next, k == 0                       ? "simulate with the setting that was checked, "
              : k + 1 < r->parameter_count ? ", "
                                           : " and ");
    say_name(next, p->name);
    say(next, " ");
    say_value(next, p->nearest, p->high - p->low, p->unit);
  }
  say(next, ".");
  if (!a) return;
  say(next, " Of the tests in the file the ");
  say_name(next, a->name);
  say(next, ", measured %zu time%s more, would tell most:", a->repeat_count,
      a->repeat_count == 1 ? "" : "s");
  for (size_t k = 0; k < r->parameter_count; k++) {
    say(next, k ? ", " : " ");
    say_name(next, r->parameters[k].name);
    say(next, " to %.0f %% of its range from %.0f %%", 100 * a->narrowed[k],
        100 * r->parameters[k].narrowed);
  }
  say(next, ".");
}

static void say_search(const scree_calibration_result *r, text *t, text *but) {
  const scree_setting *best = r->settings;
  double width = best->high - best->low;
  say_name(t, r->sought);
  say(t, " is %s, ", r->maximise ? "greatest" : "least");
  say_value(t, best->mean, width, "");
  say(t, " (%.*f to %.*f), at ", scree_words_decimals(width), best->low,
      scree_words_decimals(width), best->high);
  for (size_t k = 0; k < r->parameter_count; k++) {
    say_comma(t, k, r->parameter_count, " and ");
    say_name(t, r->parameters[k].name);
    say(t, " %.4g", best->values[k]);
  }
  say(t, ".");
  capitalise(t, 0);
  say(but, "The interval holds %g %%.", 100 * r->confidence);
  if (r->answer_count > 1)
    say(but, " The limits hold there with a probability of %.2f%s.", best->allowed,
        best->allowed < r->confidence
            ? ", less than was asked: no setting that was tried keeps them"
            : "");
}

/* Where runs failed the answer is of the others. */
static void say_failed(const scree_calibration_result *r, text *but) {
  if (r->progress.failed == 0) return;
  say(but, "%s%zu of %zu runs failed", *but->to ? " " : "", r->progress.failed,
      r->progress.run_count);
  if (r->failure_count) say(but, ": %.200s", r->failures[0]);
  say(but, ".");
}

/* Four times the runs at the best halve its interval. */
static void say_next_of_search(const scree_calibration_result *r, text *next) {
  say(next, "to halve the interval, add to the budget ");
  say_runs(r, 3 * r->settings->run_count, next);
  say(next, ".");
}

static void say_words(const scree_calibration_result *r, scree_words *w, text *answer, text *but,
                      text *next) {
  if (r->agreement == SCREE_AGREEMENT_NO) {
    w->verdict = SCREE_NOT_REACHED;
    w->state = "Not reached: no setting gives what was measured";
    say_misfit(r, answer, but);
  } else {
    bool fits = r->agreement == SCREE_AGREEMENT_YES;
    w->verdict = fits ? SCREE_ANSWERED : SCREE_NOT_ENOUGH;
    w->state = fits ? "Fitted: a setting gives what was measured" : "Not checked by runs yet";
    say_fit(r, answer, but);
  }
  say_next(r, next);
}

static void say_words_of_search(const scree_calibration_result *r, scree_words *w, text *answer,
                                text *but, text *next) {
  bool kept = r->setting_count && (r->answer_count < 2 || r->settings->allowed >= r->confidence);
  w->verdict = kept ? SCREE_ANSWERED : SCREE_NOT_REACHED;
  w->state = kept ? "Answered" : "Not reached: no setting that was tried keeps the limits";
  if (!r->setting_count) {
    w->verdict = SCREE_NOT_ENOUGH;
    w->state = "Not ended yet";
    return;
  }
  say_search(r, answer, but);
  say_next_of_search(r, next);
}

void scree_calibration_words(const scree_calibration_result *r, scree_words *w) {
  text answer = {w->answer, sizeof w->answer}, but = {w->but, sizeof w->but},
       next = {w->next, sizeof w->next};
  *w = (scree_words){.state = ""};
  (r->is_search ? say_words_of_search : say_words)(r, w, &answer, &but, &next);
  say_failed(r, &but);
}

/* ---- titles ---- */

void scree_calibration_answer_finding(const scree_calibration_result *r,
                                      const scree_answer_result *a, char *to, size_t size) {
  text t = {to, size};
  bool misfit = r->agreement == SCREE_AGREEMENT_NO;
  *to = 0;
  say_name(&t, a->name);
  capitalise(&t, 0);
  if (a->point_count) {
    say(&t, misfit      ? " beside what was measured"
            : a->inside ? ": the curve lies within"
                        : ": the curve lies outside");
  } else if (a->measured && !isnan(a->gap)) {
    say(&t, ": ");
    say_value(&t, a->value + a->gap, a->gap_sd, a->unit);
    say(&t, " for ");
    say_value(&t, a->value, a->gap_sd, a->unit);
    say(&t, " measured");
    if (misfit && !a->met) say(&t, ", too %s", a->gap < 0 ? "low" : "high");
  } else if (!misfit && !isnan(a->mean)) {
    int digits = scree_words_decimals(a->high - a->low);
    say(&t, a->predicted ? ", predicted: " : ": ");
    say_value(&t, a->mean, a->high - a->low, a->unit);
    say(&t, " (%.*f to %.*f)", digits, a->low, digits, a->high);
  }
}

void scree_calibration_parameter_finding(const scree_parameter_result *p, char *to, size_t size) {
  text t = {to, size};
  int digits = scree_words_decimals(p->high - p->low);
  *to = 0;
  say_name(&t, p->name);
  capitalise(&t, 0);
  say(&t, ": %.*f to %.*f, %.0f %% of its range", digits, p->low, digits, p->high,
      100 * p->narrowed);
}

/* From when on all that a round tells is within a tenth of what the last did. */
void scree_calibration_history_finding(const scree_calibration_result *r, char *to, size_t size) {
  size_t width = r->is_search ? 2 : 1 + r->parameter_count, settled = r->history_count;
  const double *last = r->history + (r->history_count - 1) * width;
  text t = {to, size};
  *to = 0;
  while (settled > 0) {
    const double *row = r->history + (settled - 1) * width;
    bool same = true;
    for (size_t k = 1; k < width; k++) same = same && fabs(row[k] - last[k]) <= 0.1 * fabs(last[k]);
    if (!same) break;
    settled--;
  }
  if (settled + 1 < r->history_count)
    say(&t, "After %.0f runs, more of them told little more", r->history[settled * width]);
  else
    say(&t, "The last runs still told more");
}
