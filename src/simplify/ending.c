/* Below some hundred triangles one collapse taken before another makes a level better or worse by a
 * tenth, and nothing tells beforehand. So method `volume` comes to its coarsest levels by several
 * ways, each as good as the others on average, side by side, and every level is that of the way
 * that is best there. The next level may be another way's: these levels are no steps of one path,
 * and stand in the record as a whole.
 *
 * How good a level is, its witnesses tell (scree_level_score): as the way left it, to choose those
 * that are settled, for that takes time; then as it is settled. */
#include "simplify/ending.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "simplify/greedy.h"
#include "simplify/settle.h"

#include <string.h>

/* The usual way; one on which nothing but the cost itself keeps the farthest place near; one that
 * lets steeper things go. Large scans take one that does both. */
static const scree_rule rules[] = {
    {1, SCREE_LEAST_COARSE_TURN}, {0, SCREE_LEAST_COARSE_TURN}, {1, -0.6}};
static const scree_rule rules_of_large[] = {{1, SCREE_LEAST_COARSE_TURN}, {0, -0.6}};

/* How many ways there are, and how many levels of a count are settled: both take time, which with
 * close scans is little beside the rest. */
enum { ENDINGS = 2, ENDINGS_OF_CLOSE = 3, SETTLED = 1, SETTLED_OF_CLOSE = 2 };

/* The share of triangles left after which progress is told. */
#define TOLD_AT 0.9

/* A way. */
typedef struct ending {
  scree_decimator *d;
  scree_trial trial; /* whose decimator it is, but of the first way */
  scree_greedy *greedy;
  scree_ahead ahead;
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
  size_t count, until;
  size_t record_count; /* collapses where they part */
  scree_settling settling;
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

static scree_status advance(const endings *w, ending *e) {
  scree_decimator *d = e->d;
  size_t ahead = scree_ahead_from(d);
  scree_status status = SCREE_OK;
  while (!e->over && d->s.live_triangle_count > w->until && status == SCREE_OK) {
    bool careful = d->s.live_triangle_count <= ahead;
    size_t until = careful || w->until > ahead ? w->until : ahead;
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

static void advance_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  endings *w = context;
  for (size_t i = begin; i < end; i++) {
    ending *e = &w->each[i];
    const scree_record *r = &e->d->record;
    e->status = advance(w, e);
    for (; e->told < r->count; e->told++) e->worst = fmaxf(e->worst, r->error[e->told]);
  }
}

static double score_of(const ending *e) {
  return e->ahead.best ? e->ahead.best->score : scree_level_score_now(e->d);
}

/* How many levels of a count are settled. */
static size_t settled_of(const scree_decimator *d) {
  return scree_is_close_scan(d) ? SETTLED_OF_CLOSE : SETTLED;
}

/* Settles the best of the levels that have so many triangles; of equal ones the first. */
static scree_status take_levels(endings *w) {
  size_t most = settled_of(w->d);
  double least = 0; /* the last score taken */
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < w->count; i++)
    if (w->each[i].d->s.live_triangle_count == w->until) w->each[i].score = score_of(&w->each[i]);
  for (size_t n = 0; n < most && status == SCREE_OK; n++) {
    ending *best = NULL;
    for (size_t i = 0; i < w->count; i++) {
      ending *e = &w->each[i];
      if (e->d->s.live_triangle_count != w->until) continue;
      if (n > 0 && !(e->score > (1 + SCREE_SAME_SCORE) * least)) continue;
      if (!best || e->score < (1 - SCREE_SAME_SCORE) * best->score) best = e;
    }
    if (!best) break;
    least = best->score;
    status = scree_settle_level(&w->settling, scree_greedy_step(best->greedy), best->worst);
  }
  return status;
}

/* Down to w->until triangles, side by side. */
static scree_status advance_all(endings *w) {
  scree_status status = SCREE_OK;
  scree_parallel_for(w->count, 1, advance_block, w);
  for (size_t i = 0; i < w->count && status == SCREE_OK; i++) {
    status = w->each[i].status;
    if (status != SCREE_OK && i > 0 && w->d->error) *w->d->error = w->each[i].error;
  }
  return status;
}

static bool all_over(const endings *w) {
  for (size_t i = 0; i < w->count; i++)
    if (!w->each[i].over) return false;
  return true;
}

/* The record goes down to the levels that are told as a whole. */
static void cut_record(scree_decimator *d, size_t whole_from) {
  scree_record *r = &d->record;
  scree_moves *moves = &r->moves;
  r->count = scree_record_above(d, whole_from);
  while (moves->count > 0 && moves->items[moves->count - 1].index >= r->count) moves->count--;
}

/* Whether the record has a level of no more than stop_count triangles. */
static bool is_low_enough(const endings *w, bool whole) {
  size_t left = SIZE_MAX, stop = w->d->options.stop_count;
  for (size_t i = 0; i < w->count; i++)
    if (w->each[i].d->s.live_triangle_count < left) left = w->each[i].d->s.live_triangle_count;
  if (whole && left <= scree_ahead_from(w->d)) left = w->settling.least_count;
  return left <= stop;
}

static scree_status run(endings *w, bool whole) {
  scree_decimator *d = w->d;
  size_t stop = d->options.stop_count, from = scree_ahead_from(d);
  scree_ticker ticker = d->ticker;
  scree_status status = SCREE_OK;
  d->ticker.progress = NULL; /* a way may be another thread's: it is told here */
  w->until = d->s.live_triangle_count;
  do {
    size_t next = (size_t)(TOLD_AT * (double)w->until);
    if (next < from) next = w->until > from ? from : w->until - 1;
    w->until = w->until > stop && stop > from && next < stop ? stop : next;
    status = advance_all(w);
    if (status == SCREE_OK && whole && w->until <= from) status = take_levels(w);
    if (status == SCREE_OK && !scree_decimate_tick(d, &ticker)) status = SCREE_CANCELLED;
  } while (status == SCREE_OK && !is_low_enough(w, whole) && !all_over(w));
  d->ticker = ticker;
  ending *usual = &w->each[0];
  if (status == SCREE_OK && !usual->careful && !usual->over)
    status = scree_greedy_end(usual->greedy);
  if (status == SCREE_OK && whole) status = scree_settle_end(&w->settling);
  if (status == SCREE_OK && whole) cut_record(d, from);
  return status;
}

scree_status scree_decimate_endings(scree_decimator *d, const scree_rule *by, size_t count) {
  endings *w = scree_alloc_zero(1, sizeof *w);
  if (!w) return scree_fail_memory(d->error, sizeof *w, "the last levels");
  w->d = d;
  w->record_count = d->record.count;
  scree_settle_begin(&w->settling, &d->record.whole, settled_of(d) > 1, d->error);
  const scree_rule *usual = d->rule;
  scree_status status = begin(w, by, count);
  if (status == SCREE_OK) status = run(w, d->unsettled == SCREE_UNSETTLED_NONE);
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
