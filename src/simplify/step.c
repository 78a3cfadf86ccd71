/* What a single collapse does to the surface, what may not be done, and how the vertices about it
 * move: the survivor first, then its neighbours, each by itself; then the two of them that gain
 * most by it take over volume from each other. A place may get farther off by it, but no farther
 * than the farthest of the whole level was when it was last looked for, which is whenever a tenth
 * of the triangles has gone. */
#include "simplify/step.h"

#include "base/parallel.h"

#include <string.h>

/* Vertices about a collapse that one thread asks about. */
enum { ASKED_AT_ONCE = 2 };

/* Cells per mean edge of the grid for exact tests, and when it is built anew:
 * half the triangles gone, or so many entries stale. */
#define EDGES_PER_CELL 1.5
#define REGRID_BELOW   0.5
#define STALE_FACTOR   12

/* The share of triangles left at which the farthest place of the level is found anew. */
#define FARTHEST_BELOW 0.9

/* The shortest way that a vertex is moved, of the whole step: else it stays. */
#define LEAST_SHARE 0.25

static scree_status prepare_grid(scree_decimator *d) {
  scree_grid *g = &d->grid;
  if (g->few) return SCREE_OK;
  if (g->built_for && (double)d->s.live_triangle_count > REGRID_BELOW * (double)g->built_for &&
      g->count < STALE_FACTOR * g->built_for + 1000)
    return SCREE_OK;
  scree_status status = scree_grid_shape(g, &d->s, EDGES_PER_CELL, d->error);
  if (status != SCREE_OK) return status;
  if (!scree_grid_list_all(g, &d->s))
    return scree_fail_memory(d->error, g->capacity * sizeof *g->items, "grid lists");
  scree_grid_enter_directions(g, &d->s);
  return SCREE_OK;
}

bool scree_step_is_sound(const scree_step *q, scree_ring *ring, scree_change *change,
                         scree_around *around) {
  const scree_decimator *d = q->d;
  size_t after = d->s.live_triangle_count - (ring->c != SCREE_NONE) - (ring->d != SCREE_NONE);
  bool coarse = !d->coster->merge && d->s.live_triangle_count < SCREE_TURNED_COUNT;
  return scree_collapse_check(&d->s, ring, coarse ? scree_rule_of(d).least_turn : SCREE_LEAST_TURN,
                              change, around) &&
         scree_memory_allows(&d->memory, after, change->target);
}

bool scree_step_suits(const scree_step *q, scree_ring *fan, scree_change *change,
                      scree_around *around) {
  return scree_step_is_sound(q, fan, change, around) &&
         scree_anchors_stay(&q->d->anchors, &q->d->s, fan, change->target);
}

bool scree_step_may_be_sound(const scree_step *q, scree_ring *ring, vec3 target) {
  double least_turn = fmin(SCREE_LEAST_TURN, scree_rule_of(q->d).least_turn);
  return scree_collapse_suits_ring(&q->d->s, ring, least_turn, target);
}

bool scree_step_is_clear(scree_step *q, const scree_ring *ring, const scree_change *change,
                         const scree_around *around, scree_status *status) {
  scree_decimator *d = q->d;
  *status = prepare_grid(d);
  if (*status != SCREE_OK) return false;
  return (d->s.closed && !d->grid.few && scree_grid_certifies(&d->grid, ring, around)) ||
         (scree_grid_clear(&d->grid, &d->s, ring, change->target, NULL) &&
          scree_anchors_stay(&d->anchors, &d->s, ring, change->target));
}

bool scree_step_allows(scree_step *q, scree_ring *ring, scree_change *change, scree_around *around,
                       scree_status *status) {
  return scree_step_is_sound(q, ring, change, around) &&
         scree_step_is_clear(q, ring, change, around, status);
}

static void touch(scree_step *q, uint32_t v) {
  if (q->stamp[v] == q->now) return;
  q->stamp[v] = q->now;
  q->touched[q->touched_count++] = v;
}

scree_status scree_step_list(scree_step *q, const scree_ring *r, const scree_around *geometry) {
  scree_decimator *d = q->d;
  if (d->grid.few) return SCREE_OK;
  scree_grid_enter_ring(&d->grid, r, geometry);
  for (uint32_t i = 0; i < r->count; i++)
    if (!scree_grid_list_triangle(&d->grid, &d->s, r->edge[i] / 3))
      return scree_fail_memory(d->error, d->grid.capacity * sizeof *d->grid.items, "grid lists");
  return SCREE_OK;
}

/* The vertices of the ring are touched, and the grid knows its new triangles. */
static scree_status settle(scree_step *q, const scree_ring *r, const scree_around *geometry) {
  const scree_halfmesh *s = &q->d->s;
  touch(q, r->a);
  for (uint32_t i = 0; i < r->count; i++) {
    touch(q, s->half[r->edge[i]].from);
    touch(q, scree_to(s, r->edge[i]));
  }
  return scree_step_list(q, r, geometry);
}

/* One or two vertices on their way to where the witnesses are nearer. */
typedef struct moving {
  int count;
  uint32_t edges[2][SCREE_RING_MAX];
  scree_ring fans[2];
  scree_relaxation relaxations[2];
  scree_change changes[2];
  scree_around around[2];
} moving;

bool scree_step_gather(const scree_halfmesh *s, uint32_t v, scree_ring *fan) {
  return !(s->flags[v] & SCREE_VERTEX_LOCKED) && scree_ring_gather_fan(s, v, fan);
}

static bool gather_moving(const scree_halfmesh *s, uint32_t v, moving *m, int which) {
  m->fans[which].edge = m->edges[which];
  return scree_step_gather(s, v, &m->fans[which]);
}

/* Whether the first may move, and the second once the first has. */
static bool all_allowed(scree_step *q, moving *m, scree_status *status) {
  scree_decimator *d = q->d;
  if (!scree_step_allows(q, &m->fans[0], &m->changes[0], &m->around[0], status)) return false;
  if (m->count == 1) return true;
  vec3 *at = &d->s.vertex[m->fans[0].a].at, from = *at;
  *at = m->changes[0].target;
  *status = scree_step_list(q, &m->fans[0], &m->around[0]);
  bool answer = *status == SCREE_OK &&
                scree_step_allows(q, &m->fans[1], &m->changes[1], &m->around[1], status);
  *at = from;
  return answer;
}

/* Moves the fan's vertex to change->target. */
static scree_status move(scree_step *q, const scree_ring *fan, const scree_change *change,
                         const scree_around *geometry) {
  scree_decimator *d = q->d;
  scree_status status = scree_record_move(d, fan, change);
  if (status != SCREE_OK) return status;
  scree_memory_move(&d->memory, &d->s, fan, change->target);
  d->s.vertex[fan->a].at = change->target;
  return settle(q, fan, geometry);
}

/* Moves them by as large a share of their steps as gains and is allowed, if any. */
static scree_status try_moving(scree_step *q, moving *m, bool *moved) {
  scree_decimator *d = q->d;
  scree_status status = SCREE_OK;
  vec3 places[2];
  *moved = false;
  for (int i = 0; i < m->count; i++) /* relax.c has set it */
    /* NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage) */
    m->relaxations[i].worst = fmax(m->relaxations[i].worst, q->farthest2);
  for (double share = 1; share >= LEAST_SHARE && status == SCREE_OK; share *= 0.5) {
    scree_relax_places(m->relaxations, m->count, share, places);
    for (int i = 0; i < m->count; i++) m->changes[i].target = places[i];
    if (!scree_relax_gains(&d->memory, &d->s, m->relaxations, m->count, places) ||
        !all_allowed(q, m, &status))
      continue;
    *moved = true;
    for (int i = 0; i < m->count && status == SCREE_OK; i++)
      status = move(q, &m->fans[i], &m->changes[i], &m->around[i]);
    return status;
  }
  return status;
}

/* The vertices about a collapse, and what the witnesses say of each, while that is known. */
typedef struct asking {
  const scree_step *step;
  size_t count;
  uint32_t vertices[SCREE_MOST_ABOUT];
  scree_pull pulls[SCREE_MOST_ABOUT]; /* n_per_n 0: nothing */
  bool known[SCREE_MOST_ABOUT];
} asking;

static void ask_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  asking *a = context;
  const scree_halfmesh *s = &a->step->d->s;
  uint32_t edges[SCREE_RING_MAX];
  scree_ring fan = {.edge = edges};
  for (size_t i = begin; i < end; i++) {
    if (a->known[i]) continue;
    if (!scree_step_gather(s, a->vertices[i], &fan) ||
        !scree_pull_find(&a->step->d->memory, s, &fan, &a->pulls[i]))
      a->pulls[i].n_per_n = 0;
    a->known[i] = true;
  }
}

/* Afterwards all are known. */
static void ask_all(asking *a) {
  scree_parallel_for(a->count, ASKED_AT_ONCE, ask_block, a);
}

static bool has_corner(const scree_halfmesh *s, const scree_ring *fan, uint32_t v) {
  for (uint32_t i = 0; i < fan->count; i++)
    if (s->half[fan->edge[i]].from == v || scree_to(s, fan->edge[i]) == v) return true;
  return false;
}

/* The fan's vertex has moved: those that share a triangle with it have other witnesses. */
static void forget_around(asking *a, const scree_ring *fan) {
  for (size_t i = 0; i < a->count; i++)
    if (a->vertices[i] == fan->a || has_corner(&a->step->d->s, fan, a->vertices[i]))
      a->known[i] = false;
}

/* Moves one of them, where it gains. */
static scree_status relax(scree_step *q, asking *a, size_t which) {
  moving m;
  bool moved;
  m.count = 1;
  ask_block(a, which, which + 1, 0, 0);
  if (!(a->pulls[which].n_per_n > 0) || !gather_moving(&q->d->s, a->vertices[which], &m, 0) ||
      !scree_relax_alone(&a->pulls[which], &m.fans[0], &m.relaxations[0]))
    return SCREE_OK;
  scree_status status = try_moving(q, &m, &moved);
  if (moved) forget_around(a, &m.fans[0]);
  return status;
}

/* The two, no neighbours, that gain most by it take over volume from each other. */
static scree_status exchange(scree_step *q, asking *a) {
  const scree_halfmesh *s = &q->d->s;
  const scree_pull *pulls = a->pulls;
  double most = 0;
  size_t first = 0, second = 0;
  bool moved;
  moving m;
  m.count = 2;
  ask_all(a);
  for (size_t i = 0; i < a->count; i++) {
    if (!(pulls[i].n_per_n > 0) || !gather_moving(s, a->vertices[i], &m, 0)) continue;
    for (size_t j = i + 1; j < a->count; j++) {
      if (!(pulls[j].n_per_n > 0) || has_corner(s, &m.fans[0], a->vertices[j])) continue;
      double gain = scree_exchange_gain(&pulls[i], &pulls[j]);
      if (!(gain > most)) continue;
      most = gain;
      first = i;
      second = j;
    }
  }
  if (!(most > 0)) return SCREE_OK;
  gather_moving(s, a->vertices[first], &m, 0);
  gather_moving(s, a->vertices[second], &m, 1);
  scree_exchange_begin((scree_pull[2]){pulls[first], pulls[second]}, m.fans, m.relaxations);
  return try_moving(q, &m, &moved);
}

void scree_step_find_farthest(scree_step *q) {
  const scree_decimator *d = q->d;
  if (d->s.live_triangle_count > q->farthest_at) return;
  q->farthest2 = scree_past_rounding(scree_memory_farthest(&d->memory, &d->s));
  q->farthest_at = (size_t)(FARTHEST_BELOW * (double)d->s.live_triangle_count);
}

/* The vertices about the collapse, of which the first survived, have their turns: it, then the
 * others counter-clockwise from the farthest, so that numbers decide nothing; at last two of them
 * together. */
static scree_status relax_around(scree_step *q) {
  const scree_vertex *vertex = q->d->s.vertex;
  size_t count = q->touched_count, farthest = 1;
  double most = 0;
  asking a = {.step = q, .count = count};
  memcpy(a.vertices, q->touched, count * sizeof *a.vertices);
  scree_step_find_farthest(q);
  scree_status status = relax(q, &a, 0);
  for (size_t i = 1; i < count; i++) {
    double distance2 = vec3_norm2(vec3_sub(vertex[a.vertices[i]].at, vertex[a.vertices[0]].at));
    if (distance2 > most) farthest = i;
    most = fmax(most, distance2);
  }
  for (size_t i = 0; i + 1 < count; i++)
    a.vertices[1 + i] = q->touched[1 + (farthest - 1 + i) % (count - 1)];
  if (scree_worker_count() > 1) ask_all(&a); /* some in vain: what is forgotten is asked again */
  for (size_t i = 1; i < count && status == SCREE_OK; i++) status = relax(q, &a, i);
  return status == SCREE_OK ? exchange(q, &a) : status;
}

scree_status scree_step_collapse(scree_step *q, const scree_ring *r, const scree_change *change,
                                 const scree_around *geometry, double error) {
  scree_decimator *d = q->d;
  scree_halfmesh *s = &d->s;
  scree_record_write(d, d->record.count++, r, change, error);
  s->live_vertex_count--;
  s->live_triangle_count -= s->half[r->half_edge].twin == SCREE_NONE ? 1 : 2;
  if (!d->coster->merge) scree_memory_move(&d->memory, s, r, change->target);
  scree_collapse_apply(s, r, change->target);
  scree_anchors_follow(&d->anchors, r);
  if (d->coster->merge) d->coster->merge(s, r->a, r->b);
  q->now++;
  q->touched_count = 0;
  scree_status status = settle(q, r, geometry);
  if (status == SCREE_OK && s->live_triangle_count < q->relaxed_below) status = relax_around(q);
  return status;
}
