/* What a study says in one sentence: from where to where an answer goes over the design, and which
 * factor does it. An effect is the difference of the means at a factor's last and first level,
 * averaged over all else; its interval is that of the points' own, which is never too narrow. */
#include "base/error.h"
#include "base/number.h"
#include "report/program.h"

#include <math.h>
#include <string.h>

static const scree_summary *summary_of(const scree_study_result *r, size_t point, size_t answer) {
  const scree_point_result *p = &r->points[point];
  return r->answer_count ? &p->answers[answer] : &p->angle_deg;
}

/* Numbers in their order; words as they come. */
static bool is_after(const char *a, const char *b) {
  double x, y;
  return scree_number_read(a, &x) && scree_number_read(b, &y) && x > y;
}

/* The mean of the points at a level, and at one of another factor (NULL: at any), and the square of
 * half its interval. */
static double mean_at(const scree_study_result *r, size_t answer, const size_t factors[2],
                      const char *const levels[2], double *squares) {
  double sum = 0, count = 0;
  *squares = 0;
  for (size_t i = 0; i < r->point_count; i++) {
    const scree_summary *s = summary_of(r, i, answer);
    bool there = s->count > 0;
    for (int k = 0; k < 2; k++)
      there = there && (!levels[k] || !strcmp(r->points[i].values[factors[k]], levels[k]));
    if (!there) continue;
    double half = s->count < 2 ? (double)INFINITY : 0.5 * (s->mean_high - s->mean_low);
    sum += s->mean;
    *squares += half * half;
    count++;
  }
  *squares /= count * count;
  return sum / count;
}

/* Its first level and its last. */
static void ends_of(const scree_study_result *r, size_t factor, const char **first,
                    const char **last) {
  *first = *last = r->points[0].values[factor];
  for (size_t i = 1; i < r->point_count; i++) {
    const char *value = r->points[i].values[factor];
    if (is_after(*first, value)) *first = value;
    if (is_after(value, *last) || (strcmp(value, *last) != 0 && !is_after(*last, value)))
      *last = value;
  }
}

static scree_effect effect_of(const scree_study_result *r, size_t answer, size_t factor) {
  double before, after;
  scree_effect e = {.factor = r->factors[factor]};
  ends_of(r, factor, &e.from, &e.to);
  const size_t factors[2] = {factor, factor};
  double low = mean_at(r, answer, factors, (const char *[]){e.from, NULL}, &before),
         high = mean_at(r, answer, factors, (const char *[]){e.to, NULL}, &after);
  e.size = strcmp(e.from, e.to) ? high - low : NAN;
  e.half = sqrt(before + after);
  return e;
}

/* How much more the one does at the last level of the other than at its first. */
static scree_effect both_of(const scree_study_result *r, size_t answer, const size_t factors[2]) {
  scree_effect e = {.factor = r->factors[factors[0]], .other = r->factors[factors[1]]};
  const char *ends[2][2];
  double squares, sum = 0;
  for (int k = 0; k < 2; k++) ends_of(r, factors[k], &ends[k][0], &ends[k][1]);
  for (int i = 0; i < 4; i++) {
    const char *levels[2] = {ends[0][i & 1], ends[1][i >> 1]};
    double mean = mean_at(r, answer, factors, levels, &squares);
    e.size += (i == 0 || i == 3 ? 1 : -1) * mean;
    sum += squares;
  }
  e.half = sqrt(sum);
  return e;
}

static size_t put_effect(scree_effect *list, size_t first, size_t count, scree_effect e) {
  size_t at = count;
  if (isnan(e.size) || count == SCREE_MOST_EFFECTS) return count;
  for (; at > first && fabs(e.size) > fabs(list[at - 1].size); at--) list[at] = list[at - 1];
  list[at] = e;
  return count + 1;
}

size_t scree_study_effects(const scree_study_result *r, size_t answer,
                           scree_effect effects[SCREE_MOST_EFFECTS]) {
  size_t count = 0;
  if (strcmp(r->design, "grid") != 0) return 0;
  for (size_t f = 0; f < r->factor_count; f++)
    count = put_effect(effects, 0, count, effect_of(r, answer, f));
  size_t single = count;
  for (size_t f = 0; f < r->factor_count && single > 1; f++)
    for (size_t g = 0; g < f; g++)
      count = put_effect(effects, single, count, both_of(r, answer, (const size_t[]){g, f}));
  return count;
}

static size_t single_effects(const scree_study_result *r, size_t answer, scree_effect *effects) {
  size_t count = scree_study_effects(r, answer, effects), single = 0;
  while (single < count && !effects[single].other) single++;
  return single;
}

void scree_study_scatter(const scree_study_result *r, size_t answer, double *sd, double *half) {
  double squares = 0, widths = 0, count = 0;
  for (size_t i = 0; i < r->point_count; i++) {
    const scree_summary *s = summary_of(r, i, answer);
    if (s->count < 2) continue;
    squares += s->sd * s->sd;
    widths += pow(0.5 * (s->mean_high - s->mean_low), 2);
    count++;
  }
  *sd = sqrt(squares / count);
  *half = sqrt(widths / count);
}

static void factor_name(const char *factor, char *to, size_t size) {
  const char *last = strrchr(factor, '.');
  scree_words_name(last ? last + 1 : factor, to, size);
}

static void say_effect(scree_words *w, const scree_effect *e, const char *unit) {
  char name[100];
  int digits = scree_words_decimals(isfinite(e->half) && e->half > 0 ? e->half : fabs(e->size));
  factor_name(e->factor, name, sizeof name);
  SCREE_ADD_TEXT(w->answer, "%s (%+.*f", name, digits, e->size);
  if (isfinite(e->half)) SCREE_ADD_TEXT(w->answer, " +- %.*f", digits, e->half);
  SCREE_ADD_TEXT(w->answer, "%s%s)", *unit ? " " : "", unit);
}

static void say_answer(const scree_study_result *r, size_t answer, scree_words *w) {
  const char *unit = r->answer_count ? r->units[answer] : "deg";
  double low = INFINITY, high = -INFINITY, half = 0;
  char name[100];
  scree_effect effects[SCREE_MOST_EFFECTS];
  size_t count = single_effects(r, answer, effects);
  for (size_t i = 0; i < r->point_count; i++) {
    const scree_summary *s = summary_of(r, i, answer);
    if (s->count == 0) continue;
    low = fmin(low, s->mean);
    high = fmax(high, s->mean);
    if (s->count > 1) half = fmax(half, 0.5 * (s->mean_high - s->mean_low));
  }
  int digits = scree_words_decimals(half > 0 ? half : 0.05 * fabs(high));
  scree_words_name(r->answer_count ? r->answers[answer] : "angle of repose", name, sizeof name);
  if (!isfinite(low)) {
    w->verdict = SCREE_NOT_REACHED;
    w->state = "Not answered: no run gave it";
    SCREE_ADD_TEXT(w->answer, "No run gave %s %s.", r->answer_count ? "the answer" : "an", name);
    return;
  }
  if (r->point_count == 1) {
    SCREE_ADD_TEXT(w->answer, "%s is %.*f", name, digits, low);
    if (half > 0) SCREE_ADD_TEXT(w->answer, " +- %.*f", digits, half);
    SCREE_ADD_TEXT(w->answer, "%s%s.", *unit ? " " : "", unit);
    return;
  }
  if (count && isfinite(effects[0].half) && fabs(effects[0].size) < effects[0].half) {
    w->verdict = SCREE_NOT_ENOUGH;
    w->state = "Not enough: repeats differ by more than points";
    SCREE_ADD_TEXT(w->answer, "%zu repeats do not tell what %s depends on: ", r->replicate_count,
                   name);
    say_effect(w, &effects[0], unit);
    SCREE_ADD_TEXT(w->answer, ".");
    return;
  }
  SCREE_ADD_TEXT(w->answer, "%s goes from %.*f to %.*f%s%s", name, digits, low, digits, high,
                 *unit ? " " : "", unit);
  while (count > 1 && fabs(effects[count - 1].size) <= effects[count - 1].half) count--;
  for (size_t i = 0; i < count && i < 3; i++) {
    SCREE_ADD_TEXT(w->answer, i == 0 ? ": by " : i + 1 == count ? " and " : ", ");
    say_effect(w, &effects[i], unit);
  }
  SCREE_ADD_TEXT(w->answer, ".");
}

/* From which Rp on the angle is that of the finest. */
static void say_converged(const scree_study_result *r, scree_words *w) {
  enum { MOST_FAMILIES = 3 };
  for (size_t i = 0; i < r->family_count && i < MOST_FAMILIES; i++) {
    const scree_family_result *f = &r->families[i];
    SCREE_ADD_TEXT(w->but, " %s%s", f->label, *f->label ? ": " : "");
    if (f->converged)
      SCREE_ADD_TEXT(w->but, "From Rp %s on the angle is that of %s, within %g deg.",
                     r->points[f->levels[f->converged_from]].rp,
                     r->points[f->levels[f->level_count - 1]].rp, r->margin_deg);
    else
      SCREE_ADD_TEXT(w->but, "Convergence of the angle within %g deg is not shown.", r->margin_deg);
  }
}

/* Four times the repeats halve an interval. */
static void say_next(const scree_study_result *r, size_t answer, scree_words *w) {
  double sd, half, repeats = (double)r->replicate_count;
  char cost[SCREE_NUMBER_SIZE];
  size_t waiting = r->counts.waiting + r->counts.leased + r->counts.running;
  if (waiting) {
    scree_seconds_text(r->seconds_left, cost);
    SCREE_ADD_TEXT(w->next, "go on with the same command: %zu runs are to be made", waiting);
    SCREE_ADD_TEXT(w->next, isnan(r->seconds_left) ? "." : ", in about %s.", cost);
    return;
  }
  scree_study_scatter(r, answer, &sd, &half);
  if (!(repeats > 1) || !(half > 0)) {
    if (repeats <= 1)
      SCREE_ADD_TEXT(w->next, "set replicates: 4, to tell what differs from what scatters.");
    return;
  }
  double more = 3 * repeats * (double)r->point_count;
  scree_seconds_text(more * r->seconds_spent / fmax(1, (double)r->counts.done), cost);
  if (w->verdict == SCREE_NOT_ENOUGH) SCREE_ADD_TEXT(w->next, "levels farther apart, or ");
  SCREE_ADD_TEXT(w->next,
                 "replicates: %zu in place of %zu, which halves the intervals: %.0f more runs, %s "
                 "of a processor.",
                 4 * r->replicate_count, r->replicate_count, more, cost);
}

void scree_study_words(const scree_study_result *r, size_t answer, scree_words *w) {
  const scree_study_counts *c = &r->counts;
  bool whole = c->waiting + c->leased + c->running == 0;
  *w = (scree_words){.verdict = whole ? SCREE_ANSWERED : SCREE_NOT_ENOUGH,
                     .state = whole ? "Answered" : "Not ended yet"};
  if (c->done == 0) {
    w->verdict = c->failed ? SCREE_NOT_REACHED : SCREE_NOT_ENOUGH;
    w->state = c->failed ? "Not answered: all runs failed" : "Not ended yet";
    if (c->failed)
      SCREE_ADD_TEXT(w->answer, "All %zu runs failed: %.300s", c->failed,
                     r->failure_count ? r->failures[0].reason : "");
    else
      SCREE_ADD_TEXT(w->answer, "No run has ended yet.");
    return;
  }
  say_answer(r, answer, w);
  if (w->answer[0] >= 'a' && w->answer[0] <= 'z') w->answer[0] = (char)(w->answer[0] - 'a' + 'A');
  if (r->replicate_count > 1)
    SCREE_ADD_TEXT(w->but, "Intervals hold %g %%, from %zu repeats.", 100 * r->confidence,
                   r->replicate_count);
  else
    SCREE_ADD_TEXT(w->but, "One run a point gives no intervals.");
  say_converged(r, w);
  if (c->failed)
    SCREE_ADD_TEXT(w->but, " %zu run%s failed: %.300s.", c->failed, c->failed == 1 ? "" : "s",
                   r->failure_count ? r->failures[0].reason : "");
  say_next(r, answer, w);
}

void scree_study_finding(const scree_study_result *r, size_t answer, char *to, size_t size) {
  scree_effect e[SCREE_MOST_EFFECTS];
  char name[100];
  size_t count = scree_study_effects(r, answer, e), single = single_effects(r, answer, e);
  scree_words_name(r->answer_count ? r->answers[answer] : "angle of repose", name, sizeof name);
  if (*name >= 'a' && *name <= 'z') *name = (char)(*name - 'a' + 'A');
  snprintf(to, size, "%s", name);
  if (single == 0) return;
  factor_name(e->factor, name, sizeof name);
  bool told = fabs(e->size) > e->half,
       both = count > single && fabs(e[single].size) > e[single].half;
  if (!told)
    scree_add_text(to, size, ": no factor is told");
  else
    scree_add_text(to, size, single > 1 ? ": %s does most" : ": %s counts", name);
  if (told && both && single == 2 && e[0].size * e[1].size > 0)
    scree_add_text(to, size, ", and the two %s each other",
                   e[single].size * e[0].size > 0 ? "help" : "hinder");
}
