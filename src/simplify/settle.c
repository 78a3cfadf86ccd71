/* Vertices move one after the other, each if it suits; at the end the surface must not meet itself.
 * If it does, they move once more, each if it is allowed as any move is. What those that may not
 * leave of the volume, the others take up. Steps are taken where the merit (joint.h) falls; else
 * they are found once more with more damping (Levenberg, Marquardt). */
#include "simplify/settle.h"

#include "base/array.h"
#include "base/parallel.h"
#include "simplify/ahead.h"

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

scree_status scree_settled_allocate(scree_settled *l, const scree_decimator *d,
                                    scree_error *error) {
  const scree_halfmesh *s = &d->s;
  scree_status status = scree_joint_allocate(&l->joint, s, error);
  if (status != SCREE_OK) return status;
  SCREE_ALLOC_OR(l->before.places, s->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(l->before.witnesses, d->memory.count, error, out_of_memory);
  SCREE_ALLOC_OR(l->before.first, s->triangle_count, error, out_of_memory);
  SCREE_ALLOC_OR(l->places, s->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(l->errands, s->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(l->lists, s->triangle_count, error, out_of_memory);
  SCREE_ALLOC_OR(l->followed, d->memory.count, error, out_of_memory);
  SCREE_ALLOC_OR(l->graph, s->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(l->swept, s->triangle_count, error, out_of_memory);
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

void scree_settle_begin(scree_settling *q, scree_whole_levels *whole, bool compares,
                        scree_error *error) {
  *q = (scree_settling){
      .whole = whole, .compares = compares, .least_count = SIZE_MAX, .error = error};
}

void scree_settle_free(scree_settling *q) {
  for (int i = 0; i < SCREE_WAIT_TO_SETTLE; i++) {
    scree_trial_free(&q->levels[i].trial);
    scree_settled_free(&q->levels[i]);
  }
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
  double merit = scree_joint_begin(j, &d->memory, &d->s, l->step->farthest2), damping = DAMPING;
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

typedef struct origin {
  uint32_t of, vertex; /* in the mesh given; in the level */
} origin;

static int by_origin(const void *a, const void *b) {
  const origin *x = a, *y = b;
  return (x->of > y->of) - (x->of < y->of);
}

/* The vertices of a level in the order of the mesh given, and the places of all in that order. A
 * vertex of the mesh that is several here, each of a fan of its own, is one again. */
static size_t order_vertices(const scree_halfmesh *s, origin *origins, uint32_t *places) {
  size_t all = 0, count = 0;
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE) origins[all++] = (origin){s->vertex[v].origin, v};
  qsort(origins, all, sizeof *origins, by_origin);
  for (size_t i = 0; i < all; i++) {
    if (count == 0 || origins[i].of != origins[count - 1].of) origins[count++] = origins[i];
    places[origins[i].vertex] = (uint32_t)(count - 1);
  }
  return count;
}

static void fill_whole(const scree_halfmesh *s, const origin *origins, const uint32_t *places,
                       scree_whole_level *w) {
  scree_sum area = {0}, volume = {0};
  for (size_t i = 0; i < w->vertex_count; i++) {
    w->origin[i] = origins[i].of;
    w->position[i] = vec3_mad(s->centre, s->vertex[origins[i].vertex].at, s->scale);
  }
  for (size_t t = 0, n = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    scree_add_triangle(s, t, &area, &volume);
    for (size_t k = 0; k < 3; k++) w->triangle[n][k] = places[s->half[3 * t + k].from];
    n++;
  }
  w->area = scree_sum_value(area) * s->scale * s->scale;
  w->volume = scree_sum_value(volume) * s->scale * s->scale * s->scale;
}

static scree_status make_whole(const scree_settled *l, scree_whole_level *made,
                               scree_error *error) {
  const scree_halfmesh *s = &l->trial.d.s;
  scree_whole_level w = {.triangle_count = s->live_triangle_count, .error = l->error};
  origin *origins = NULL;
  uint32_t *places = NULL;
  scree_status status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(origins, s->vertex_count, error, done);
  SCREE_ALLOC_OR(places, s->vertex_count, error, done);
  w.vertex_count = order_vertices(s, origins, places);
  SCREE_ALLOC_OR(w.origin, w.vertex_count, error, done);
  SCREE_ALLOC_OR(w.position, w.vertex_count, error, done);
  SCREE_ALLOC_OR(w.triangle, w.triangle_count, error, done);
  fill_whole(s, origins, places, &w);
  status = SCREE_OK;
done:
  scree_free(origins);
  scree_free(places);
  if (status == SCREE_OK)
    *made = w;
  else
    scree_whole_level_free(&w);
  return status;
}

/* The level, unless one of as many triangles is there that is as good. */
static scree_status tell(scree_settling *q, const scree_settled *l) {
  scree_whole_levels *levels = q->whole;
  scree_whole_level made;
  size_t last = levels->count - 1;
  bool same =
      levels->count > 0 && levels->items[last].triangle_count == l->trial.d.s.live_triangle_count;
  if (same && !(l->score < (1 - SCREE_SAME_SCORE) * q->score)) return SCREE_OK;
  scree_status status = make_whole(l, &made, q->error);
  if (status != SCREE_OK) return status;
  if (same) {
    scree_whole_level_free(&levels->items[last]);
    levels->items[last] = made;
  } else if (!SCREE_PUSH(levels, made)) {
    scree_whole_level_free(&made);
    return scree_fail_memory(q->error, (levels->count + 1) * sizeof made, "the record");
  }
  q->score = l->score;
  return SCREE_OK;
}

bool scree_settle_next(scree_settling *q, size_t *place) {
  if (q->begun == q->count) return false;
  *place = (q->first + q->begun++) % SCREE_WAIT_TO_SETTLE;
  return true;
}

void scree_settle_level(scree_settling *q, size_t place) {
  scree_settled *l = &q->levels[place];
  const scree_decimator *d = &l->trial.d;
  l->status = settle(l, scree_is_large(d) ? MOST_OF_LARGE : MOST_STEPS);
  if (q->compares) l->score = scree_level_score_now(d);
}

scree_status scree_settle_tell(scree_settling *q, size_t place) {
  scree_status status = SCREE_OK;
  q->levels[place].over = true;
  while (q->begun > 0 && q->levels[q->first].over && status == SCREE_OK) {
    const scree_settled *l = &q->levels[q->first];
    status = l->status == SCREE_OK ? tell(q, l) : l->status;
    q->first = (q->first + 1) % SCREE_WAIT_TO_SETTLE;
    q->begun--;
    q->count--;
  }
  return status;
}

/* Room for a copy of the step's surface. */
static scree_status make_room(scree_settled *l, const scree_decimator *d, scree_error *error) {
  if (l->room.vertices >= d->s.vertex_count && l->room.triangles >= d->s.triangle_count &&
      l->room.witnesses >= d->memory.count)
    return SCREE_OK;
  scree_trial_free(&l->trial);
  scree_settled_free(l);
  *l = (scree_settled){.from = NULL};
  scree_status status = scree_trial_allocate(&l->trial, d, error);
  if (status == SCREE_OK) status = scree_settled_allocate(l, d, error);
  l->room.vertices = d->s.vertex_count;
  l->room.triangles = d->s.triangle_count;
  l->room.witnesses = d->memory.count;
  return status;
}

scree_status scree_settle_later(scree_settling *q, const scree_step *step, float error) {
  scree_settled *l = &q->levels[(q->first + q->count) % SCREE_WAIT_TO_SETTLE];
  scree_status status = make_room(l, step->d, q->error);
  if (status != SCREE_OK) return status;
  q->count++;
  scree_trial_start(&l->trial, step);
  if (l->from != step) l->joint.hinted = false;
  l->from = step;
  l->step = &l->trial.step;
  l->error = error;
  l->over = false;
  l->trial.d.record.count = 1;
  l->trial.d.record.area[0] = l->trial.d.record.volume[0] = 0;
  q->least_count = step->d->s.live_triangle_count;
  return SCREE_OK;
}
