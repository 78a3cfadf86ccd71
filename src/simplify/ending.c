/* Below some hundred triangles one collapse taken before another makes a level better or worse by a
 * tenth, and nothing tells beforehand. So method `volume` comes to its coarsest levels by several
 * ways, each as good as the others on average, side by side, and every level is that of the way
 * that is best there. The next level may be another way's: these levels are no steps of one path,
 * and stand in the record as a whole.
 *
 * How good a level is, its witnesses tell (scree_level_score): as the way left it, to choose those
 * that are settled, for that takes time; then as it is settled.
 *
 * Ways go on by steps, beside each other: each for itself to where levels are compared, then from
 * one level to the next, where all wait for the last. What was chosen is settled when no way can go
 * on, so that no thread is idle while another has a longer way; it is told in the order in which it
 * was chosen. */
#include "simplify/ending.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "simplify/greedy.h"
#include "simplify/settle.h"

#include <limits.h>
#include <string.h>

/* The usual way; one on which nothing but the cost itself keeps the farthest place near; one that
 * lets steeper things go. Large scans take one that does both. */
static const scree_rule rules[] = {
    {1, SCREE_LEAST_COARSE_TURN}, {0, SCREE_LEAST_COARSE_TURN}, {1, -0.6}};
static const scree_rule rules_of_large[] = {{1, SCREE_LEAST_COARSE_TURN}, {0, -0.6}};

/* How many ways there are, and how many levels of a count are settled: both take time, which with
 * close scans is little beside the rest. */
enum { ENDINGS = 2, ENDINGS_OF_CLOSE = 3, SETTLED = 1, SETTLED_OF_CLOSE = 2 };

/* The share of triangles that a step leaves, where levels are not compared. */
#define STEP 0.9

/* A way. */
typedef struct ending {
  scree_decimator *d;
  scree_trial trial; /* whose decimator it is, but of the first way */
  scree_greedy *greedy;
  scree_ahead ahead;
  bool busy;    /* with a step */
  size_t left;  /* triangles, when it is not */
  bool careful; /* it looks ahead */
  bool over;    /* no edge can be collapsed any more */
  size_t told;  /* collapses of its record that `worst` counts */
  float worst;  /* error of a collapse */
  double score; /* of its level, before it is settled */
  scree_status status;
  scree_error error;
} ending;

typedef struct endings {
  scree_decimator *d;
  ending each[SCREE_MOST_ENDINGS];
  size_t count;
  size_t until;        /* triangles to which all are to come now */
  size_t record_count; /* collapses where they part */
  bool whole;          /* levels that look ahead are compared, settled and told */
  bool over;           /* there is no further level */
  scree_settling settling;
  scree_ticker ticker;
  scree_status status;
} endings;

/* A copy of the surface with a record of its own. */
static scree_status copy(ending *e, scree_decimator *d) {
  scree_trial *t = &e->trial;
  const scree_step step = {.d = d};
  scree_status status = scree_trial_allocate(t, d, d->error);
  if (status != SCREE_OK) return status;
  scree_trial_start(t, &step);
  t->d.s.sums = NULL;
  t->d.s.refused = NULL;
  t->d.error = &e->error;
  scree_record_free(&t->d.record);
  status = scree_record_allocate(&t->d.record, d->s.live_vertex_count, d->error);
  if (status != SCREE_OK) return status;
  SCREE_ALLOC_OR(t->d.s.sums, d->s.vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(t->d.s.refused, 3 * d->s.triangle_count, d->error, out_of_memory);
  memcpy(t->d.s.sums, d->s.sums, d->s.vertex_count * sizeof *t->d.s.sums);
  memcpy(t->d.s.refused, d->s.refused, 3 * d->s.triangle_count);
  e->d = &t->d;
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static void free_endings(endings *w) {
  for (size_t i = 0; i < w->count; i++) {
    ending *e = &w->each[i];
    scree_ahead_free(&e->ahead);
    scree_greedy_free(e->greedy);
    if (i == 0) continue;
    scree_grid_free(&e->trial.d.grid);
    scree_free(e->trial.d.s.sums);
    scree_free(e->trial.d.s.refused);
    scree_trial_free(&e->trial);
  }
  scree_settle_free(&w->settling);
}

static scree_status begin(endings *w, const scree_rule *by, size_t count) {
  scree_decimator *d = w->d;
  float worst = 0;
  scree_grid_free(&d->grid);
  for (size_t i = 0; i < d->record.count; i++) worst = fmaxf(worst, d->record.error[i]);
  scree_status status = scree_memory_is_kept(&d->memory) ? SCREE_OK : scree_decimate_keep(d);
  if (status == SCREE_OK) status = scree_anchors_find(&d->s, &d->anchors, d->error);
  for (size_t i = 0; i < count && status == SCREE_OK; i++) {
    ending *e = &w->each[w->count++];
    e->worst = worst;
    e->left = d->s.live_triangle_count;
    e->d = d;
    if (i > 0) status = copy(e, d);
    e->told = e->d->record.count;
    e->d->rule = &by[i];
  }
  return status;
}

/* From now on with a look ahead; what is gone leaves the surface. */
static scree_status take_care(const endings *w, ending *e) {
  scree_decimator *d = e->d;
  e->careful = true;
  scree_greedy_free(e->greedy);
  e->greedy = NULL;
  scree_status status = scree_ahead_prepare(d);
  if (status == SCREE_OK && scree_is_large(d))
    status = scree_decimate_spread(d, &w->d->record, w->record_count);
  if (status == SCREE_OK) status = scree_greedy_begin(d, false, &e->greedy);
  if (status == SCREE_OK) status = scree_grid_look_at_all(&d->grid, d->error);
  if (status == SCREE_OK) status = scree_ahead_begin(&e->ahead, d);
  return status;
}

static scree_status advance(const endings *w, ending *e, size_t to) {
  scree_decimator *d = e->d;
  size_t ahead = scree_ahead_from(d);
  scree_status status = SCREE_OK;
  while (!e->over && d->s.live_triangle_count > to && status == SCREE_OK) {
    bool careful = d->s.live_triangle_count <= ahead;
    size_t until = careful || to > ahead ? to : ahead;
    if (careful && !e->careful) status = take_care(w, e);
    if (!careful && !e->greedy)
      status = scree_greedy_begin(d, d->unsettled != SCREE_UNSETTLED_ALL, &e->greedy);
    if (status == SCREE_OK) status = scree_greedy_run(e->greedy, until, careful ? &e->ahead : NULL);
    e->over = d->s.live_triangle_count > until;
  }
  if (status == SCREE_OK && d->s.live_triangle_count <= ahead && !e->careful)
    status = take_care(w, e); /* this level may be settled */
  return status;
}

static double score_of(const ending *e) {
  return e->ahead.best ? e->ahead.best->score : scree_level_score_now(e->d);
}

/* How many levels of a count are settled. */
static size_t settled_of(const scree_decimator *d) {
  return scree_is_close_scan(d) ? SETTLED_OF_CLOSE : SETTLED;
}

/* Whether levels of so many triangles are compared. */
static bool compares(const endings *w, size_t triangle_count) {
  return w->whole && triangle_count <= scree_ahead_from(w->d);
}

/* The best of the levels that have so many triangles are to be settled; of equal ones the first. */
static scree_status take_levels(endings *w) {
  size_t most = settled_of(w->d);
  double least = 0; /* the last score taken */
  scree_status status = SCREE_OK;
  for (size_t n = 0; n < most && status == SCREE_OK; n++) {
    ending *best = NULL;
    for (size_t i = 0; i < w->count; i++) {
      ending *e = &w->each[i];
      if (e->left != w->until) continue;
      if (n > 0 && !(e->score > (1 + SCREE_SAME_SCORE) * least)) continue;
      if (!best || e->score < (1 - SCREE_SAME_SCORE) * best->score) best = e;
    }
    if (!best) break;
    least = best->score;
    status = scree_settle_later(&w->settling, scree_greedy_step(best->greedy), best->worst);
  }
  return status;
}

/* The record goes down to the levels that are told as a whole. */
static void cut_record(scree_decimator *d, size_t whole_from) {
  scree_record *r = &d->record;
  scree_moves *moves = &r->moves;
  r->count = scree_record_above(d, whole_from);
  while (moves->count > 0 && moves->items[moves->count - 1].index >= r->count) moves->count--;
}

/* Whether the record has a level of no more than stop_count triangles, or no way goes on. */
static bool is_over(const endings *w) {
  size_t left = SIZE_MAX;
  bool over = true;
  for (size_t i = 0; i < w->count; i++) {
    if (w->each[i].left < left) left = w->each[i].left;
    over &= w->each[i].over;
  }
  if (compares(w, left)) left = w->settling.least_count;
  return over || left <= w->d->options.stop_count;
}

/* The next count to which all are to come: where levels begin to be compared, or every one from
 * there on. */
static void set_next(endings *w) {
  size_t from = scree_ahead_from(w->d), stop = w->d->options.stop_count;
  w->until = w->until <= from ? w->until - 1 : w->until > stop && stop > from ? stop : from;
}

static bool has_come(const endings *w, const ending *e) {
  return !e->busy && (e->over || e->left <= w->until);
}

/* All have come. */
static void end_level(endings *w) {
  if (compares(w, w->until)) w->status = take_levels(w);
  w->over = is_over(w);
  if (!w->over) set_next(w);
}

/* The way that has the most triangles left, of those that can take a step; or NULL. *all: all have
 * come. */
static ending *next_way(endings *w, bool *all) {
  ending *next = NULL;
  *all = true;
  for (size_t i = 0; i < w->count; i++) {
    ending *e = &w->each[i];
    if (has_come(w, e)) continue;
    *all = false;
    if (!e->busy && (!next || e->left > next->left)) next = e;
  }
  return next;
}

/* Tasks are steps of the ways by their numbers, then the levels that wait by their places. */
static bool take_task(void *context, int worker, size_t *task) {
  endings *w = context;
  bool all;
  if (worker == 0 && w->status == SCREE_OK) { /* that is the caller's thread */
    size_t left = 0;
    for (size_t i = 0; i < w->count; i++)
      if (w->each[i].left > left) left = w->each[i].left;
    if (!scree_decimate_tick_at(w->d, left, &w->ticker)) w->status = SCREE_CANCELLED;
  }
  while (w->status == SCREE_OK && !w->over) {
    ending *e = next_way(w, &all);
    if (e) {
      e->busy = true;
      *task = (size_t)(e - w->each);
      return true;
    }
    if (!all || !scree_settle_has_room(&w->settling, settled_of(w->d))) break;
    end_level(w);
  }
  size_t place;
  if (w->status != SCREE_OK || !scree_settle_next(&w->settling, &place)) return false;
  *task = w->count + place;
  return true;
}

static void step(const endings *w, ending *e) {
  const scree_record *r = &e->d->record;
  size_t to = (size_t)(STEP * (double)e->left);
  if (to < w->until) to = w->until;
  e->status = advance(w, e, to);
  for (; e->told < r->count; e->told++) e->worst = fmaxf(e->worst, r->error[e->told]);
  size_t left = e->d->s.live_triangle_count;
  if (e->status == SCREE_OK && compares(w, left)) e->score = score_of(e);
}

static void do_task(void *context, size_t task) {
  endings *w = context;
  if (task < w->count)
    step(w, &w->each[task]);
  else
    scree_settle_level(&w->settling, task - w->count);
}

static void end_task(void *context, size_t task) {
  endings *w = context;
  scree_status status;
  if (task < w->count) {
    ending *e = &w->each[task];
    e->busy = false;
    e->left = e->d->s.live_triangle_count;
    status = e->status;
    if (status != SCREE_OK && w->status == SCREE_OK && task > 0 && w->d->error)
      *w->d->error = e->error;
  } else {
    status = scree_settle_tell(&w->settling, task - w->count);
  }
  if (w->status == SCREE_OK) w->status = status;
}

static scree_status run(endings *w) {
  scree_decimator *d = w->d;
  const scree_tasks tasks = {take_task, do_task, end_task};
  w->ticker = d->ticker;
  d->ticker.progress = NULL; /* a way may be another thread's: it is told here */
  w->until = d->s.live_triangle_count;
  set_next(w);
  /* one way alone has all threads for itself */
  scree_parallel_tasks(w->count > 1 ? INT_MAX : 1, &tasks, w);
  d->ticker = w->ticker;
  ending *usual = &w->each[0];
  if (w->status == SCREE_OK && !usual->careful && !usual->over)
    w->status = scree_greedy_end(usual->greedy);
  if (w->status == SCREE_OK && w->whole) cut_record(d, scree_ahead_from(d));
  return w->status;
}

scree_status scree_decimate_endings(scree_decimator *d, const scree_rule *by, size_t count) {
  endings *w = scree_alloc_zero(1, sizeof *w);
  if (!w) return scree_fail_memory(d->error, sizeof *w, "the last levels");
  w->d = d;
  w->record_count = d->record.count;
  w->whole = d->unsettled == SCREE_UNSETTLED_NONE;
  scree_settle_begin(&w->settling, &d->record.whole, settled_of(d) > 1, d->error);
  const scree_rule *usual = d->rule;
  scree_status status = begin(w, by, count);
  if (status == SCREE_OK) status = run(w);
  free_endings(w);
  scree_free(w);
  d->rule = usual;
  return status;
}

/* Without a look ahead, by the usual rule; to the last level, or to where ways part. */
static scree_status go_down(scree_decimator *d, size_t until, bool last) {
  scree_greedy *greedy = NULL;
  bool settles = !d->coster->merge && d->unsettled != SCREE_UNSETTLED_ALL;
  scree_status status = scree_greedy_begin(d, settles, &greedy);
  if (status == SCREE_OK) status = scree_greedy_run(greedy, until, NULL);
  if (status == SCREE_OK && last) status = scree_greedy_end(greedy);
  scree_greedy_free(greedy);
  return status;
}

scree_status scree_decimate_one_by_one(scree_decimator *d) {
  size_t stop = d->options.stop_count, parting = 0;
  scree_status status = scree_decimate_sum(d);
  if (status != SCREE_OK) return status;
  if (!d->coster->merge) parting = scree_is_large(d) ? SCREE_PARTING_LATE : SCREE_PARTING_COUNT;
  bool last = parting < stop;
  if (last) parting = stop;
  if (d->s.live_triangle_count > parting) status = go_down(d, parting, last);
  if (status != SCREE_OK || d->coster->merge || d->s.live_triangle_count <= stop ||
      d->s.live_triangle_count > parting)
    return status;
  size_t count = scree_is_close_scan(d) ? ENDINGS_OF_CLOSE : ENDINGS;
  if (d->unsettled != SCREE_UNSETTLED_NONE) count = 1;
  return scree_decimate_endings(d, scree_is_large(d) ? rules_of_large : rules, count);
}
