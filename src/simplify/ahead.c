/* A level is the better the smaller its witnesses' mean distance times the cube root of the
 * distance of its farthest place is. A trial with moves is dear, so that most offers are judged
 * without. */
#include "simplify/ahead.h"

#include "base/array.h"
#include "base/parallel.h"

#include <string.h>

/* The power of the farthest place's distance in a level's score. More brings that place nearer and
 * leaves the mean distance larger, for which the levels of close scans have room. */
#define POWER          (1.0 / 3)
#define POWER_OF_CLOSE 0.5
#define POWER_OF_LARGE 0.28

/* Squared distances are known above this share of the level's farthest; when the farthest has come
 * nearer than the second, or farther than the third times what is known, all are found anew. */
#define KNOWN_ABOVE 0.25
#define TOO_NEAR    2.0
#define TOO_FAR     16.0

scree_status scree_ahead_prepare(scree_decimator *d) {
  uint32_t *vertices = NULL, *triangles = NULL;
  scree_status status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(vertices, d->s.vertex_count, d->error, done);
  SCREE_ALLOC_OR(triangles, d->s.triangle_count, d->error, done);
  status = SCREE_OK;
  if (scree_memory_has_surface(&d->memory)) scree_memory_compact(&d->memory, &d->s);
  scree_halfmesh_compact(&d->s, vertices, triangles);
done:
  scree_free(vertices);
  scree_free(triangles);
  return status;
}

/* Finds the distances of what has an end at these vertices, or of all. */
static void find_distances(scree_ahead *a, const scree_decimator *d, const bool *moved) {
  const scree_halfmesh *s = &d->s;
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE && (!moved || moved[v]))
      a->of_vertex2[v] = scree_memory_vertex_stray(&d->memory, s, v, a->least2);
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++)
    if (s->half[h].from != SCREE_NONE && h < s->half[h].twin &&
        (!moved || moved[s->half[h].from] || moved[scree_to(s, h)]))
      a->of_edge2[h] = scree_memory_edge_stray(&d->memory, s, h, a->least2);
}

static void find_all_distances(scree_ahead *a, const scree_decimator *d) {
  a->least2 = KNOWN_ABOVE * scree_memory_farthest(&d->memory, &d->s);
  find_distances(a, d, NULL);
}

scree_status scree_ahead_begin(scree_ahead *a, const scree_decimator *d) {
  scree_status status = SCREE_OK;
  *a = (scree_ahead){.from = NULL};
  for (int i = 0; i < SCREE_TRIAL_COUNT && status == SCREE_OK; i++)
    status = scree_trial_allocate(&a->outcomes[i].trial, d, d->error);
  if (status != SCREE_OK) return status;
  for (int i = 0; i < SCREE_TRIAL_COUNT; i++)
    SCREE_ALLOC_OR(a->outcomes[i].moved, d->s.vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(a->of_vertex2, d->s.vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(a->of_edge2, 3 * d->s.triangle_count, d->error, out_of_memory);
  find_all_distances(a, d);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_ahead_free(scree_ahead *a) {
  for (int i = 0; i < SCREE_TRIAL_COUNT; i++) {
    scree_trial_free(&a->outcomes[i].trial);
    scree_free(a->outcomes[i].moved);
  }
  scree_free(a->of_vertex2);
  scree_free(a->of_edge2);
}

double scree_level_score(const scree_decimator *d, double mean, double farthest) {
  double power = scree_is_large(d)        ? POWER_OF_LARGE
                 : scree_is_close_scan(d) ? POWER_OF_CLOSE
                                          : POWER;
  return fmax(mean, SCREE_SAME_DISTANCE) * pow(fmax(farthest, SCREE_SAME_DISTANCE), power);
}

double scree_level_score_now(const scree_decimator *d) {
  return scree_level_score(d, scree_memory_mean(&d->memory),
                           sqrt(scree_memory_farthest(&d->memory, &d->s)));
}

/* The largest squared distance of a place of the trial's level. */
static double farthest2_of(const scree_ahead *a, const scree_outcome *o) {
  const scree_halfmesh *s = &o->trial.d.s;
  const scree_memory *m = &o->trial.d.memory;
  double worst2 = scree_memory_witness_stray(m, s);
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE)
      worst2 =
          o->moved[v] ? scree_memory_vertex_stray(m, s, v, worst2) : fmax(worst2, a->of_vertex2[v]);
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
    if (s->half[h].from == SCREE_NONE || h > s->half[h].twin) continue;
    worst2 = o->moved[s->half[h].from] || o->moved[scree_to(s, h)]
                 ? scree_memory_edge_stray(m, s, h, worst2)
                 : fmax(worst2, a->of_edge2[h]);
  }
  return worst2 > a->least2 ? worst2 : scree_memory_farthest(m, s);
}

static void try_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_ahead *a = context;
  for (size_t i = begin; i < end; i++) {
    scree_outcome *o = &a->outcomes[i];
    scree_trial *t = &o->trial;
    const scree_offer *offer = &a->offers[o->offer];
    const scree_vertex *before = a->from->d->s.vertex, *after = t->d.s.vertex;
    scree_trial_start(t, a->from);
    o->status =
        scree_step_collapse(&t->step, &offer->ring, &offer->change, &offer->around, offer->error);
    for (size_t v = 0; v < t->d.s.vertex_count; v++)
      o->moved[v] = vec3_norm2(vec3_sub(after[v].at, before[v].at)) > 0;
    o->moved[offer->ring.a] = true;
    o->farthest2 = farthest2_of(a, o);
    o->score = scree_level_score(&t->d, scree_memory_mean(&t->d.memory), sqrt(o->farthest2));
  }
}

static void judge_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_ahead *a = context;
  const scree_decimator *d = a->from->d;
  for (size_t i = begin; i < end; i++) {
    const scree_offer *offer = &a->offers[i];
    double worst2, growth = scree_memory_growth(&d->memory, &d->s, &offer->ring,
                                                offer->change.target, a->from->farthest2, &worst2);
    a->scores[i] = scree_level_score(d, a->mean + growth / d->memory.weight, sqrt(worst2));
  }
}

/* The offers that are tried: the best of them as they are, in their order. */
static size_t choose(scree_ahead *a, size_t count) {
  size_t tried = 0;
  bool chosen[SCREE_OFFER_COUNT] = {false};
  if (count > SCREE_TRIAL_COUNT) {
    a->mean = scree_memory_mean(&a->from->d->memory);
    scree_parallel_for(count, 1, judge_block, a);
  } else
    memset(a->scores, 0, sizeof a->scores); /* all */
  for (size_t n = 0; n < SCREE_TRIAL_COUNT && n < count; n++) {
    size_t best = count;
    for (size_t i = 0; i < count; i++)
      if (!chosen[i] && (best == count || a->scores[i] < (1 - SCREE_SAME_SCORE) * a->scores[best]))
        best = i;
    chosen[best] = true;
  }
  for (size_t i = 0; i < count; i++)
    if (chosen[i]) a->outcomes[tried++].offer = i;
  return tried;
}

size_t scree_ahead_find(scree_ahead *a, scree_step *step, const scree_offer *offers, size_t count) {
  a->from = step;
  a->offers = offers;
  scree_step_find_farthest(step);
  size_t tried = choose(a, count);
  scree_parallel_for(tried, 1, try_block, a);
  a->best = &a->outcomes[0];
  for (size_t i = 1; i < tried; i++)
    if (a->outcomes[i].score < (1 - SCREE_SAME_SCORE) * a->best->score) a->best = &a->outcomes[i];
  return a->best->offer;
}

/* The trial's one collapse and its moves. */
static scree_status take_record(scree_decimator *d, const scree_record *from) {
  scree_record *r = &d->record;
  size_t last = r->count++;
  r->kept[last] = from->kept[0];
  r->gone[last] = from->gone[0];
  r->position[last] = from->position[0];
  r->area[last] = from->area[0];
  r->volume[last] = from->volume[0];
  r->error[last] = from->error[0];
  for (size_t i = 0; i < from->moves.count; i++) {
    scree_move move = from->moves.items[i];
    move.index = (uint32_t)last;
    if (!SCREE_PUSH(&r->moves, move))
      return scree_fail_memory(d->error, r->moves.count * sizeof move, "the record");
  }
  return SCREE_OK;
}

scree_status scree_ahead_take(scree_ahead *a, scree_step *step) {
  const scree_outcome *o = a->best;
  const scree_trial *t = &o->trial;
  if (o->status != SCREE_OK) return o->status;
  scree_trial_take(t, step);
  step->farthest2 = t->step.farthest2;
  step->farthest_at = t->step.farthest_at;
  step->now++;
  step->touched_count = t->step.touched_count;
  for (size_t i = 0; i < t->step.touched_count; i++) {
    step->touched[i] = t->step.touched[i];
    step->stamp[step->touched[i]] = step->now;
  }
  if (o->farthest2 > TOO_NEAR * a->least2 && o->farthest2 < TOO_FAR * a->least2)
    find_distances(a, step->d, o->moved);
  else
    find_all_distances(a, step->d);
  return take_record(step->d, &t->d.record);
}
