/* Vertices move one after the other, each if it suits; at the end the surface must not meet itself.
 * If it does, they move once more, each if it is allowed as any move is. What those that may not
 * leave of the volume, the others take up. Steps are taken where the merit (joint.h) falls; else
 * they are found once more with more damping (Levenberg, Marquardt). */
#include "simplify/settle.h"

#include "base/array.h"
#include "base/parallel.h"

#include <stdlib.h>
#include <string.h>

/* Steps tried for a level, and on the path; of large scans fewer, for it takes time. Levels of more
 * than so many triangles, whose steps take long, have no more after one that gains little. */
enum { MOST_STEPS = 20, MOST_OF_LARGE = 10, QUICK_STEPS = 64 };
enum { MOST_ON_PATH = 4, MOST_ON_LARGE_PATH = 3 };
/* ... and the first time there: vertices of large scans have not moved yet. */
enum { MOST_AT_FIRST = 8 };
#define LITTLE_GAIN 1e-3
/* A smaller gain of the merit is none. */
#define LEAST_GAIN 1e-4
/* Damping to begin with; by how much it falls after steps that were taken and grows after others;
 * its limits. */
#define DAMPING       0.02
#define LESS_DAMPING  3.0
#define MORE_DAMPING  6.0
#define LEAST_DAMPING 1e-4
#define MOST_DAMPING  10.0

scree_status scree_settled_allocate(scree_settled *l, const scree_decimator *d) {
  const scree_halfmesh *s = &d->s;
  scree_status status = scree_joint_allocate(&l->joint, s, d->error);
  if (status != SCREE_OK) return status;
  SCREE_ALLOC_OR(l->before.places, s->vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(l->before.witnesses, d->memory.count, d->error, out_of_memory);
  SCREE_ALLOC_OR(l->before.first, s->triangle_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(l->places, s->vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(l->errands, s->vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(l->lists, s->triangle_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(l->followed, d->memory.count, d->error, out_of_memory);
  SCREE_ALLOC_OR(l->graph, s->vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(l->swept, s->triangle_count, d->error, out_of_memory);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_settled_free(scree_settled *l) {
  scree_joint_free(&l->joint);
  scree_free(l->before.places);
  scree_free(l->before.witnesses);
  scree_free(l->before.first);
  scree_free(l->places);
  scree_free(l->errands);
  scree_free(l->lists);
  scree_free(l->followed);
  scree_free(l->graph);
  scree_free(l->swept);
}

static scree_status allocate_draft(scree_draft *f, const scree_decimator *d) {
  scree_status status = scree_trial_allocate(&f->trial, d);
  if (status != SCREE_OK) return status;
  SCREE_ALLOC_OR(f->sums, d->s.vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(f->refused, 3 * d->s.triangle_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(f->vertices, d->s.vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(f->triangles, d->s.triangle_count, d->error, out_of_memory);
  return scree_grid_look_at_all(&f->trial.d.grid, d->error);
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static void free_draft(scree_draft *f) {
  scree_grid_free(&f->trial.d.grid);
  scree_trial_free(&f->trial);
  scree_free(f->sums);
  scree_free(f->refused);
  scree_free(f->vertices);
  scree_free(f->triangles);
}

/* Makes it a copy of the step's surface, without what is gone. */
static scree_status draw(scree_draft *f, const scree_step *from) {
  scree_decimator *d = &f->trial.d;
  scree_grid grid = d->grid;
  scree_trial_start(&f->trial, from);
  d->grid = grid;
  d->error = from->d->error;
  d->s.sums = f->sums;
  d->s.refused = f->refused;
  memcpy(f->sums, from->d->s.sums, d->s.vertex_count * sizeof *f->sums);
  memcpy(f->refused, from->d->s.refused, 3 * d->s.triangle_count);
  scree_memory_compact(&d->memory, &d->s);
  scree_halfmesh_compact(&d->s, f->vertices, f->triangles);
  return scree_anchors_find(&d->s, &d->anchors, from->d->error);
}

/* What a level is copied from. */
static scree_status draw_from(scree_settling *q, const scree_step *step, const scree_step **from) {
  *from = step;
  if (step->d->grid.few) return SCREE_OK; /* nothing is left of what is gone */
  *from = &q->draft.trial.step;
  return draw(&q->draft, step);
}

scree_status scree_settle_begin(scree_settling *q, const scree_step *step) {
  const scree_decimator *d = step->d;
  const scree_step *from = step;
  scree_status status = SCREE_OK;
  *q = (scree_settling){.first = d->record.count};
  if (!d->grid.few) status = allocate_draft(&q->draft, d);
  if (status == SCREE_OK) status = draw_from(q, step, &from);
  for (int i = 0; i < SCREE_SETTLED_AT_ONCE && status == SCREE_OK; i++) {
    status = scree_trial_allocate(&q->levels[i].trial, from->d);
    if (status == SCREE_OK) status = scree_settled_allocate(&q->levels[i], from->d);
  }
  if (status != SCREE_OK) return status;
  const scree_halfmesh *s = &from->d->s;
  SCREE_ALLOC_OR(q->shown, s->vertex_count, d->error, out_of_memory);
  for (size_t v = 0; v < s->vertex_count; v++)
    q->shown[v] = (scree_shown){s->vertex[v].origin, s->vertex[v].at};
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_settle_free(scree_settling *q) {
  free_draft(&q->draft);
  for (int i = 0; i < SCREE_SETTLED_AT_ONCE; i++) {
    scree_trial_free(&q->levels[i].trial);
    scree_settled_free(&q->levels[i]);
  }
  scree_free(q->shown);
  scree_free(q->moves.items);
}

/* Where the level's changes of area and volume are told. */
static size_t told_at(const scree_settled *l) {
  return l->step->d->record.count - 1;
}

/* Moves v to x, if that suits, or is allowed; the witnesses are to follow. */
static scree_status move_to(const scree_settled *l, bool each, uint32_t v, vec3 x, bool *moved) {
  scree_step *q = l->step;
  uint32_t edges[SCREE_RING_MAX];
  scree_ring fan = {.edge = edges};
  scree_change change = {.target = x};
  scree_around around;
  scree_status status = SCREE_OK;
  *moved = scree_step_gather(&q->d->s, v, &fan) &&
           (each ? scree_step_allows(q, &fan, &change, &around, &status)
                 : scree_step_suits(q, &fan, &change, &around));
  if (!*moved) return status;
  q->d->s.vertex[v].at = x;
  q->d->record.area[told_at(l)] += change.area;
  q->d->record.volume[told_at(l)] += change.volume;
  return each ? scree_step_list(q, &fan, &around) : SCREE_OK;
}

/* The sum of the doubled area vectors around v, which may move. */
static vec3 area_around(const scree_halfmesh *s, uint32_t v) {
  uint32_t edges[SCREE_RING_MAX];
  scree_ring fan = {.edge = edges};
  vec3 n = {0, 0, 0};
  scree_step_gather(s, v, &fan);
  for (uint32_t i = 0; i < fan.count; i++) {
    vec3 at[3];
    scree_corners(s, fan.edge[i] / 3, at);
    n = vec3_add(n, vec3_triangle_normal(at[0], at[1], at[2]));
  }
  return n;
}

static int by_length(const void *a, const void *b) {
  const scree_errand *x = a, *y = b;
  if (x->length2 != y->length2) return x->length2 < y->length2 ? -1 : 1;
  return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

/* Lists those that may move, the shortest way first: an order of their numbers would be another one
 * when the scan is turned. */
static size_t list_errands(const scree_settled *l) {
  const scree_halfmesh *s = &l->step->d->s;
  size_t count = 0;
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (l->joint.free[v])
      l->errands[count++] = (scree_errand){vec3_norm2(vec3_sub(l->places[v], s->vertex[v].at)), v};
  qsort(l->errands, count, sizeof *l->errands, by_length);
  return count;
}

/* All to their places. What is left of the volume then, the vertex takes up that yields most to
 * pressure. *kept: it may. */
static scree_status move_all(scree_settled *l, bool each, bool *kept) {
  scree_decimator *d = l->step->d;
  const scree_halfmesh *s = &d->s;
  const scree_joint *j = &l->joint;
  scree_status status = SCREE_OK;
  const double *volume = &d->record.volume[told_at(l)];
  double before = *volume, most = 0;
  bool moved, all = true;
  uint32_t softest = SCREE_NONE;
  *kept = false;
  size_t count = list_errands(l);
  for (size_t i = 0; i < count && status == SCREE_OK; i++) {
    uint32_t v = l->errands[i].vertex;
    status = move_to(l, each, v, l->places[v], &moved);
    all &= moved;
    double soft = vec3_dot(j->n[v], j->per_n[v]);
    if (soft > most) softest = v;
    most = fmax(most, soft);
  }
  double pressure = 6 * (before - *volume) / j->n_per_n;
  for (size_t i = 0; i < count && !all && status == SCREE_OK; i++) {
    uint32_t v = l->errands[i].vertex;
    status = move_to(l, each, v, vec3_mad(s->vertex[v].at, j->per_n[v], pressure), &moved);
  }
  if (softest == SCREE_NONE || status != SCREE_OK) return status;
  vec3 n = area_around(s, softest);
  double along = 6 * (before - *volume) / vec3_norm2(n);
  return move_to(l, each, softest, vec3_mad(s->vertex[softest].at, n, along), kept);
}

static void remember(scree_settled *l) {
  const scree_decimator *d = l->step->d;
  for (size_t v = 0; v < d->s.vertex_count; v++) l->before.places[v] = d->s.vertex[v].at;
  memcpy(l->before.witnesses, d->memory.witnesses, d->memory.count * sizeof *d->memory.witnesses);
  memcpy(l->before.first, d->memory.first, d->s.triangle_count * sizeof *d->memory.first);
  l->before.area = d->record.area[told_at(l)];
  l->before.volume = d->record.volume[told_at(l)];
}

/* The level is as it was then. */
static void go_back(scree_settled *l) {
  scree_decimator *d = l->step->d;
  for (size_t v = 0; v < d->s.vertex_count; v++) d->s.vertex[v].at = l->before.places[v];
  memcpy(d->memory.witnesses, l->before.witnesses, d->memory.count * sizeof *d->memory.witnesses);
  memcpy(d->memory.first, l->before.first, d->s.triangle_count * sizeof *d->memory.first);
  d->record.area[told_at(l)] = l->before.area;
  d->record.volume[told_at(l)] = l->before.volume;
  d->grid.built_for = 0;
}

/* Takes the joint's steps, if the merit falls by them. */
static scree_status try_steps(scree_settled *l, double *merit, bool *taken) {
  scree_decimator *d = l->step->d;
  remember(l);
  scree_joint_places(&l->joint, &d->s, l->places);
  scree_status status = move_all(l, false, taken);
  d->grid.built_for = 0; /* it knows nothing of that */
  if (status == SCREE_OK && *taken && !scree_grid_clear_all(&d->grid, &d->s, l->graph, l->swept)) {
    go_back(l);
    status = move_all(l, true, taken);
  }
  if (status != SCREE_OK) return status;
  if (*taken) {
    scree_memory_follow(&d->memory, &d->s, l->lists, l->followed);
    scree_joint_look(&l->joint, &d->memory, &d->s);
    double now = scree_joint_merit(&l->joint, &d->memory, &d->s);
    *taken = now < (1 - LEAST_GAIN) * *merit;
    if (*taken) *merit = now;
  }
  if (!*taken) go_back(l);
  return SCREE_OK;
}

static bool fill(scree_joint *j, const scree_decimator *d) {
  uint32_t edges[SCREE_RING_MAX];
  scree_ring fan = {.edge = edges};
  for (uint32_t v = 0; v < d->s.vertex_count; v++)
    j->free[v] = d->s.vertex[v].outgoing != SCREE_NONE && scree_step_gather(&d->s, v, &fan);
  return scree_joint_fill(j, &d->memory, &d->s);
}

static scree_status settle(scree_settled *l, int most) {
  const scree_decimator *d = l->step->d;
  scree_joint *j = &l->joint;
  scree_status status = SCREE_OK;
  scree_joint_begin(j, &d->memory, &d->s, l->step->farthest2);
  double merit = scree_joint_merit(j, &d->memory, &d->s), damping = DAMPING;
  bool taken = true, quick = d->s.live_triangle_count <= QUICK_STEPS;
  for (int i = 0; i < most && damping <= MOST_DAMPING && status == SCREE_OK; i++) {
    if ((taken && !fill(j, d)) || !scree_joint_solve(j, &d->s, damping)) break;
    double before = merit;
    status = try_steps(l, &merit, &taken);
    if (taken && !quick && merit > (1 - LITTLE_GAIN) * before) break;
    damping = taken ? fmax(LEAST_DAMPING, damping / LESS_DAMPING) : MORE_DAMPING * damping;
  }
  return status;
}

static int most_on_path(const scree_settled *l) {
  if (!scree_is_large(l->step->d)) return MOST_ON_PATH;
  return l->joint.hinted ? MOST_ON_LARGE_PATH : MOST_AT_FIRST;
}

scree_status scree_settle_path(scree_settled *l, scree_step *step) {
  scree_decimator *d = step->d;
  const scree_halfmesh *s = &d->s;
  vec3 *stood;
  l->step = step;
  SCREE_ALLOC_OR(stood, s->vertex_count, d->error, out_of_memory);
  for (size_t v = 0; v < s->vertex_count; v++) stood[v] = s->vertex[v].at;
  scree_status status = scree_grid_prepare(&d->grid, d->error);
  scree_step_find_farthest(step);
  if (status == SCREE_OK) status = settle(l, most_on_path(l));
  for (uint32_t v = 0; v < s->vertex_count && status == SCREE_OK; v++) {
    const scree_vertex *vertex = &s->vertex[v];
    if (vertex->outgoing == SCREE_NONE || !(vec3_norm2(vec3_sub(vertex->at, stood[v])) > 0))
      continue;
    status = scree_record_place(d, v, vertex->at);
  }
  scree_free(stood);
  return status;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static void settle_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_settling *q = context;
  for (size_t i = begin; i < end; i++) {
    scree_settled *l = &q->levels[i];
    l->status = settle(l, scree_is_large(l->step->d) ? MOST_OF_LARGE : MOST_STEPS);
  }
}

/* From the last level shown to this one: what stands elsewhere moves. */
static scree_status show(scree_settling *q, const scree_settled *l, scree_decimator *d) {
  const scree_halfmesh *s = &l->trial.d.s;
  scree_record *r = &d->record;
  uint32_t kept = r->kept[l->index] & ~SCREE_ONE_TRIANGLE;
  scree_shown *shown = q->shown;
  for (uint32_t v = 0; v < s->vertex_count; v++) {
    const scree_vertex *vertex = &s->vertex[v];
    if (vertex->outgoing == SCREE_NONE) continue;
    while (shown->origin != vertex->origin) shown++; /* those went since */
    vec3 at = vec3_mad(s->centre, vertex->at, s->scale);
    vec3 stands =
        vertex->origin == kept ? r->position[l->index] : vec3_mad(s->centre, shown->at, s->scale);
    shown->at = vertex->at;
    if (!(vec3_norm2(vec3_sub(at, stands)) > 0)) continue;
    scree_move move = {(uint32_t)l->index, vertex->origin, at};
    if (!SCREE_PUSH(&q->moves, move))
      return scree_fail_memory(d->error, q->moves.count * sizeof move, "the record");
  }
  double area = l->trial.d.record.area[0], volume = l->trial.d.record.volume[0];
  r->area[l->index] += area - q->area;
  r->volume[l->index] += volume - q->volume;
  q->area = area;
  q->volume = volume;
  return SCREE_OK;
}

static scree_status settle_waiting(scree_settling *q, scree_decimator *d) {
  scree_status status = SCREE_OK;
  scree_parallel_for(q->count, 1, settle_block, q);
  for (size_t i = 0; i < q->count && status == SCREE_OK; i++) {
    status = q->levels[i].status;
    if (status == SCREE_OK) status = show(q, &q->levels[i], d);
  }
  q->count = 0;
  return status;
}

scree_status scree_settle_level(scree_settling *q, const scree_step *step) {
  const scree_step *from;
  scree_status status = draw_from(q, step, &from);
  if (status != SCREE_OK) return status;
  scree_settled *l = &q->levels[q->count++];
  scree_trial_start(&l->trial, from);
  if (from != step) l->joint.hinted = false;
  l->step = &l->trial.step;
  l->index = step->d->record.count - 1;
  l->trial.d.record.count = 1;
  l->trial.d.record.area[0] = l->trial.d.record.volume[0] = 0;
  return q->count < SCREE_SETTLED_AT_ONCE ? SCREE_OK : settle_waiting(q, step->d);
}

scree_status scree_settle_end(scree_settling *q, scree_decimator *d) {
  scree_moves *moves = &d->record.moves;
  scree_status status = settle_waiting(q, d);
  while (moves->count > 0 && moves->items[moves->count - 1].index >= q->first) moves->count--;
  for (size_t i = 0; i < q->moves.count && status == SCREE_OK; i++)
    if (!SCREE_PUSH(moves, q->moves.items[i]))
      status = scree_fail_memory(d->error, moves->count * sizeof *moves->items, "the record");
  return status;
}
