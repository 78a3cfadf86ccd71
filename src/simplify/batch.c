/* Batches: the many collapses of the fine levels, in parallel and yet in one order.
 *
 * A pass evaluates every edge, keeps the cheapest of each vertex, and sets a threshold of cost.
 * Then follow rounds: of the candidates below the threshold, in the order of cost, all are taken
 * that are independent of those taken before; what is left over is evaluated again for the next
 * round. Independent means: no end of the one edge is a neighbour of an end of the other, and no
 * vertex is apex of both. Then no triangle is in both rings, neither changes what the other was
 * checked against but for folds over a common edge of the two rings, which are looked at for both
 * as they will be. So they can be done in any order, and every prefix of the round, which the
 * record holds in the order of cost, is a valid surface: a level.
 *
 * Where the stray (stray.h) would take the whole cost above the threshold, the edge waits for the
 * next pass, whose threshold is higher.
 *
 * Everything parallel handles its items by themselves; the only shared writes are the grid's sets
 * of directions and the vertices' flags, which grow by OR. So the result does not depend on the
 * number of threads. */
#include "simplify/decimate.h"
#include "simplify/stray.h"

#include "base/parallel.h"
#include "simplify/cheapest.h"
#include "simplify/independent.h"
#include "simplify/limit.h"

#include <assert.h>
#include <string.h>

enum { ROUNDS = 4 };
/* Compact when less than this is left of the arrays. */
#define COMPACT_BELOW 0.8

/* Collapses by blocks: small ones, for late passes take few. */
enum { TAKEN_BLOCK = SCREE_SIDE_BY_SIDE, SEARCH_BLOCK = 16 };
static_assert((int)SCREE_PASS_BLOCK == (int)SCREE_CHOICE_BLOCK, "one list a block");
/* How far ahead memory is asked for in a walk over all. */
enum { AHEAD = 16 };

enum { REFUSED, POSTPONED, CERTAIN, UNCERTAIN };

/* A collapse that was taken; its ring is in pass.edges from first_edge on. */
typedef struct taken {
  uint32_t half_edge, first_edge;
  uint32_t key; /* of its cost; then its place among those that are done, in the order of cost */
  uint16_t a_count, count;
  uint8_t verdict;
  bool open;  /* a boundary edge: one triangle goes */
  bool steep; /* as scree_around has it */
  bool folds; /* over an edge that it has in common with another one taken */
  float error;
  scree_grid_box box;
} taken;

typedef struct pass {
  scree_decimator *d;
  scree_cheapest e;
  uint8_t *marks;        /* per vertex: see independent.h */
  uint32_t *chosen;      /* per vertex: the index of the collapse it is an end of, or NONE; before
                            collapses are taken, see leader in independent.h */
  uint32_t *apex_leader; /* this and the next two: see independent.h */
  scree_contender *contenders;
  struct scree_choice_count *counts;
  scree_choosing choosing; /* of the above */
  double usual2;           /* squared stray that no collapse of this pass may exceed */
  double moves;            /* sum over the collapses of this pass: how far they moved the surface */
  taken *taken;            /* in the order of their vertices */
  scree_change *changes;
  size_t taken_count, room;
  uint32_t *edges;           /* the rings */
  scree_keyed *order, *swap; /* of those that are done: in the order of cost, by its leading bits */
  uint32_t *uncertain;
  size_t uncertain_count;
  size_t *first; /* per block: where its collapses taken begin */
} pass;

static void pass_free(pass *p) {
  scree_cheapest_free(&p->e);
  scree_free(p->marks);
  scree_free(p->chosen);
  scree_free(p->apex_leader);
  scree_free(p->contenders);
  scree_free(p->counts);
  scree_free(p->taken);
  scree_free(p->changes);
  scree_free(p->edges);
  scree_free(p->order);
  scree_free(p->swap);
  scree_free(p->uncertain);
  scree_free(p->first);
}

static scree_status pass_allocate(pass *p) {
  scree_error *error = p->d->error;
  size_t n = p->d->s.vertex_count, triangles = p->d->s.triangle_count;
  size_t blocks = scree_block_count(n, SCREE_PASS_BLOCK);
  p->room = n / 6 + 1; /* more wait for the next round */
  if (scree_decimate_sum(p->d) != SCREE_OK) goto out_of_memory;
  if (scree_cheapest_allocate(&p->e, p->d) != SCREE_OK) goto out_of_memory;
  SCREE_ALLOC_OR(p->marks, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->chosen, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->apex_leader, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->contenders, blocks * SCREE_PASS_BLOCK, error, out_of_memory);
  SCREE_ALLOC_OR(p->counts, blocks, error, out_of_memory);
  SCREE_ALLOC_OR(p->taken, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->changes, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->order, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->swap, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->uncertain, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->edges, triangles + SCREE_RING_MAX, error, out_of_memory);
  SCREE_ALLOC_OR(p->first, blocks, error, out_of_memory);
  memset(p->chosen, 0xff, n * sizeof *p->chosen);
  memset(p->apex_leader, 0xff, n * sizeof *p->apex_leader);
  p->choosing = (scree_choosing){.s = &p->d->s,
                                 .best = p->e.best,
                                 .cost = p->e.cost,
                                 .contenders = p->contenders,
                                 .counts = p->counts,
                                 .leader = p->chosen,
                                 .apex_leader = p->apex_leader,
                                 .marks = p->marks,
                                 .edges = p->edges};
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static bool is_candidate(const pass *p, size_t v) {
  return p->e.cost[v] <= p->e.limit;
}

/* Of a block of vertices: lists its candidates, and enters them for the choice. Who is one, and who
 * a cheap one, is as good as random: hence without branches. */
static void list_candidates(pass *p, size_t begin, size_t end) {
  size_t block = begin / SCREE_PASS_BLOCK;
  scree_contender *contenders = p->contenders + begin, cheap[SCREE_PASS_BLOCK + 1];
  uint32_t candidates[SCREE_PASS_BLOCK + 1], candidate_count = 0, count = 0, cheap_count = 0;
  for (size_t v = begin; v < end; v++) {
    p->marks[v] = 0;
    candidates[candidate_count] = (uint32_t)v;
    candidate_count += is_candidate(p, v);
  }
  for (uint32_t i = 0; i < candidate_count; i++) {
    /* the loop before has set it: NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign) */
    uint32_t v = candidates[i];
    bool is_cheap = p->e.cost[v] <= p->e.low;
    scree_ring r;
    scree_ring_name(&p->d->s, p->e.best[v], &r);
    contenders[count] = cheap[cheap_count] =
        (scree_contender){.a = r.a, .b = r.b, .c = r.c, .d = r.d};
    count += !is_cheap;
    cheap_count += is_cheap;
  }
  memcpy(contenders + count, cheap, cheap_count * sizeof *cheap);
  p->counts[block] = (struct scree_choice_count){.waiting = count, .left = cheap_count};
  scree_choose_enter(&p->choosing, block);
}

static void list_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_ask_for_block(&p->d->s, begin, end);
  for (size_t v = begin; v < end; v++) p->d->s.flags[v] &= (uint8_t)~SCREE_VERTEX_CHANGED;
  list_candidates(p, begin, end);
}

/* Finds what the candidates of the last round cost now, if they are still there; lists them. */
static void reconsider_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_halfmesh *s = &p->d->s;
  uint32_t waiting[SCREE_SIDE_BY_SIDE], waiting_count = 0, candidates[SCREE_PASS_BLOCK], count = 0;
  scree_ask_for_block(s, begin, end);
  scree_prefetch(s->sums[begin], (end - begin) * sizeof *s->sums);
  for (size_t v = begin; v < end; v++) {
    candidates[count] = (uint32_t)v;
    count += is_candidate(p, v);
  }
  for (uint32_t i = 0; i < count; i++) {
    /* the loop before has set it: NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign) */
    uint32_t v = candidates[i], h = p->e.best[v];
    bool gone =
        (s->vertex[v].outgoing == SCREE_NONE) | (s->half[h].from != v) | (s->refused[h] != 0);
    uint32_t other = gone ? v : scree_to(s, h);
    bool changed = ((s->flags[v] | s->flags[other]) & SCREE_VERTEX_CHANGED) != 0;
    p->e.cost[v] = gone ? INFINITY : p->e.cost[v];
    waiting[waiting_count] = h;
    waiting_count += !gone & changed;
    if (waiting_count < SCREE_SIDE_BY_SIDE) continue;
    scree_cheapest_renew(&p->e, waiting, waiting_count);
    waiting_count = 0;
  }
  scree_cheapest_renew(&p->e, waiting, waiting_count);
  list_candidates(p, begin, end);
}

static scree_ring ring_of(const pass *p, const taken *t) {
  scree_ring ring = {.edge = p->edges + t->first_edge, .a_count = t->a_count, .count = t->count};
  scree_ring_name(&p->d->s, t->half_edge, &ring);
  return ring;
}

static void set_box(const scree_halfmesh *s, vec3 target, scree_ring *r) {
  r->low = vec3_min(target, vec3_min(s->vertex[r->a].at, s->vertex[r->b].at));
  r->high = vec3_max(target, vec3_max(s->vertex[r->a].at, s->vertex[r->b].at));
  for (uint32_t i = 0; i < r->count; i++) {
    vec3 p = s->vertex[s->half[r->edge[i]].from].at, q = s->vertex[scree_to(s, r->edge[i])].at;
    r->low = vec3_min(r->low, vec3_min(p, q));
    r->high = vec3_max(r->high, vec3_max(p, q));
  }
}

static void check_one(pass *p, uint32_t index, const scree_candidate *candidate) {
  scree_decimator *d = p->d;
  taken *t = &p->taken[index];
  scree_change *change = &p->changes[index];
  scree_ring ring = ring_of(p, t);
  scree_around around;
  change->target = candidate->target;
  t->error = (float)candidate->error;
  bool sound = scree_collapse_keeps_topology(&d->s, &ring) &&
               scree_collapse_check(&d->s, &ring, SCREE_LEAST_TURN, change, &around);
  t->verdict = sound ? UNCERTAIN : REFUSED;
  if (!sound) return;
  t->steep = around.steep;
  if (scree_strays(d, &ring, candidate, p->e.limit, p->usual2)) {
    t->verdict = POSTPONED;
    return;
  }
  t->box = scree_grid_enter_ring(&d->grid, &ring, &around);
  scree_grid_widen_groups(&d->grid, &ring, &t->box);
}

/* Asks for all that the checks of these collapses will touch, step by step: of many at once. */
SCREE_PREFETCHES void ask_for_rings(const pass *p, const taken *t, size_t count) {
  const scree_halfmesh *s = &p->d->s;
  for (size_t k = 0; k < count; k++) {
    uint32_t a = s->half[t[k].half_edge].from, b = scree_to(s, t[k].half_edge);
    __builtin_prefetch(s->sums[a]);
    __builtin_prefetch(&s->sums[a][8]);
    __builtin_prefetch(s->sums[b]);
    __builtin_prefetch(&s->sums[b][8]);
    for (uint32_t i = 0; i < t[k].count; i++) {
      scree_half_edge half = s->half[p->edges[t[k].first_edge + i]];
      __builtin_prefetch(&s->vertex[half.from]);
      if (half.twin != SCREE_NONE) __builtin_prefetch(&s->half[scree_previous(half.twin)]);
    }
  }
  for (size_t k = 0; k < count; k++)
    for (uint32_t i = 0; i < t[k].count; i++) {
      uint32_t twin = s->half[p->edges[t[k].first_edge + i]].twin;
      if (twin != SCREE_NONE) __builtin_prefetch(&s->vertex[s->half[scree_previous(twin)].from]);
    }
}

static void check_some(pass *p, size_t begin, size_t end) {
  uint32_t edges[SCREE_SIDE_BY_SIDE];
  scree_candidate candidates[SCREE_SIDE_BY_SIDE];
  while (begin < end) {
    size_t count = end - begin < SCREE_SIDE_BY_SIDE ? end - begin : SCREE_SIDE_BY_SIDE;
    ask_for_rings(p, p->taken + begin, count);
    for (size_t k = 0; k < count; k++) edges[k] = p->taken[begin + k].half_edge;
    p->d->coster->evaluate(&p->d->s, edges, count, candidates);
    for (size_t k = 0; k < count; k++) check_one(p, (uint32_t)(begin + k), &candidates[k]);
    begin += count;
  }
}

static void take(pass *p, const scree_contender *c, size_t index) {
  const scree_half_edge *half = p->d->s.half;
  uint32_t h = p->e.best[c->taken];
  p->taken[index] = (taken){.half_edge = h,
                            .first_edge = c->first_edge,
                            .key = scree_key_of(p->e.cost[c->taken]),
                            .a_count = (uint16_t)c->a_count,
                            .count = (uint16_t)c->count,
                            .open = half[h].twin == SCREE_NONE};
  p->chosen[c->taken] = p->chosen[scree_to(&p->d->s, h)] = (uint32_t)index;
}

static void take_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)end, (void)worker;
  pass *p = context;
  size_t first = p->first[block], next = first, count = p->counts[block].taken;
  const scree_contender *first_taken = p->contenders + begin + SCREE_PASS_BLOCK - count;
  for (size_t i = 0; i < count && next < p->room; i++) take(p, &first_taken[i], next++);
  check_some(p, first, next);
}

/* What will not be done is no danger to others: if it were taken for one, answers would depend on
 * which of them the grid's directions settle. */
static void give_up(pass *p, const taken *t) {
  const scree_halfmesh *s = &p->d->s;
  p->chosen[s->half[t->half_edge].from] = p->chosen[scree_to(s, t->half_edge)] = SCREE_NONE;
}

static void choose_and_check(pass *p) {
  size_t vertices = p->d->s.vertex_count;
  scree_choose_independent(&p->choosing);
  p->taken_count = 0;
  for (size_t i = 0; i < scree_block_count(vertices, SCREE_PASS_BLOCK); i++) {
    p->first[i] = p->taken_count;
    p->taken_count += p->counts[i].taken;
    if (p->taken_count > p->room) p->taken_count = p->room;
  }
  scree_parallel_for(vertices, SCREE_PASS_BLOCK, take_block, p);
  for (size_t i = 0; i < p->taken_count; i++)
    if (p->taken[i].verdict < CERTAIN) give_up(p, &p->taken[i]);
}

/* Whether a fold comes to be over an edge between this ring and that of another collapse, both
 * done. With one done, scree_collapse_check of either has looked. */
static bool folds_with_others(const pass *p, const scree_ring *r, vec3 target) {
  const scree_halfmesh *s = &p->d->s;
  for (uint32_t i = 0; i < r->count; i++) {
    uint32_t beyond = s->half[r->edge[i]].twin;
    if (beyond == SCREE_NONE) continue;
    uint32_t other = p->chosen[s->half[scree_previous(beyond)].from];
    if (other == SCREE_NONE) continue;
    vec3 p1 = s->vertex[s->half[r->edge[i]].from].at, p2 = s->vertex[scree_to(s, r->edge[i])].at;
    if (scree_folded(vec3_triangle_normal(target, p1, p2),
                     vec3_triangle_normal(p->changes[other].target, p2, p1)))
      return true;
  }
  return false;
}

static void certify_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_decimator *d = p->d;
  for (size_t i = begin; i < end; i++) {
    taken *t = &p->taken[i];
    if (t->verdict == REFUSED || t->verdict == POSTPONED) continue;
    if (t->steep) { /* else not even the other's turn of at most 84 degrees makes a fold */
      scree_ring ring = ring_of(p, t);
      t->folds = folds_with_others(p, &ring, p->changes[i].target);
    }
    if (d->s.closed && scree_grid_certifies_entered(&d->grid, &t->box)) t->verdict = CERTAIN;
  }
}

static void search_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_decimator *d = p->d;
  scree_planned planned = {p->chosen, p->changes};
  for (size_t k = begin; k < end; k++) {
    taken *t = &p->taken[p->uncertain[k]];
    vec3 target = p->changes[p->uncertain[k]].target;
    scree_ring ring = ring_of(p, t);
    set_box(&d->s, target, &ring);
    bool clear = scree_grid_clear(&d->grid, &d->s, &ring, target, &planned) &&
                 scree_anchors_stay(&d->anchors, &d->s, &ring, target);
    t->verdict = clear ? CERTAIN : REFUSED;
  }
}

/* Exact tests for those that the directions did not settle. */
static void search_uncertain(pass *p) {
  scree_decimator *d = p->d;
  p->uncertain_count = 0;
  for (uint32_t i = 0; i < p->taken_count; i++) {
    taken *t = &p->taken[i];
    if (t->folds) {
      t->verdict = REFUSED;
      give_up(p, t);
    }
    if (t->verdict == UNCERTAIN) p->uncertain[p->uncertain_count++] = i;
  }
  if (p->uncertain_count == 0) return;
  scree_grid_join_groups(&d->grid);
  scree_parallel_for(p->uncertain_count, SEARCH_BLOCK, search_block, p);
}

static void set_flag(scree_halfmesh *s, uint32_t v) {
  const uint8_t flag = SCREE_VERTEX_STALE | SCREE_VERTEX_CHANGED;
  if ((__atomic_load_n(&s->flags[v], __ATOMIC_RELAXED) & flag) != flag)
    __atomic_fetch_or(&s->flags[v], flag, __ATOMIC_RELAXED);
}

static double cost_of_taken(const void *context, uint32_t index) {
  const pass *p = context;
  return p->e.cost[p->d->s.half[p->taken[index].half_edge].from];
}

/* Puts what will be done in the order of cost; answers how many. */
static size_t sort_certain(pass *p) {
  size_t count = 0;
  for (size_t i = 0; i < p->taken_count; i++)
    if (p->taken[i].verdict == CERTAIN)
      p->order[count++] = (scree_keyed){p->taken[i].key, (uint32_t)i};
  scree_keyed *sorted = scree_radix_sort(p->order, p->swap, count, 32);
  if (sorted != p->order) {
    p->swap = p->order;
    p->order = sorted;
  }
  scree_refine_order(p->order, count, cost_of_taken, p);
  return count;
}

/* Asks for what applying these collapses will touch. */
SCREE_PREFETCHES void ask_for_changes(const pass *p, const taken *t, size_t count) {
  const scree_halfmesh *s = &p->d->s;
  for (size_t k = 0; k < count; k++) {
    __builtin_prefetch(&s->half[t[k].half_edge], 1);
    for (uint32_t i = 0; i < t[k].count; i++)
      __builtin_prefetch(&s->half[p->edges[t[k].first_edge + i]], 1);
  }
  for (size_t k = 0; k < count; k++) {
    uint32_t h = t[k].half_edge, twin = s->half[h].twin;
    uint32_t x = s->half[scree_next(h)].twin, y = s->half[scree_previous(h)].twin;
    __builtin_prefetch(&s->vertex[s->half[h].from], 1);
    __builtin_prefetch(&s->vertex[scree_to(s, h)], 1);
    __builtin_prefetch(&s->vertex[s->half[scree_previous(h)].from], 1);
    if (x != SCREE_NONE) __builtin_prefetch(&s->half[x], 1);
    if (y != SCREE_NONE) __builtin_prefetch(&s->half[y], 1);
    if (twin != SCREE_NONE) __builtin_prefetch(&s->half[twin], 1);
  }
}

static void apply_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_decimator *d = p->d;
  ask_for_changes(p, p->taken + begin, end - begin);
  for (size_t i = begin; i < end; i++) {
    give_up(p, &p->taken[i]);
    if (p->taken[i].verdict != CERTAIN) {
      d->s.refused[p->taken[i].half_edge] =
          p->taken[i].verdict == POSTPONED ? SCREE_EDGE_POSTPONED : SCREE_EDGE_REFUSED;
      continue;
    }
    scree_ring ring = ring_of(p, &p->taken[i]);
    scree_record_write(d, d->record.count + p->taken[i].key, &ring, &p->changes[i],
                       (double)p->taken[i].error);
    if (scree_memory_is_kept(&d->memory))
      scree_memory_move(&d->memory, &d->s, &ring, p->changes[i].target);
    scree_collapse_apply(&d->s, &ring, p->changes[i].target);
    if (d->coster->merge) d->coster->merge(&d->s, ring.a, ring.b);
    set_flag(&d->s, ring.a);
    for (uint32_t e = 0; e < ring.count; e++) {
      set_flag(&d->s, d->s.half[ring.edge[e]].from);
      set_flag(&d->s, scree_to(&d->s, ring.edge[e]));
    }
  }
}

/* Does it all; the record has it in the order of cost. Returns how many. */
static size_t apply(pass *p) {
  scree_decimator *d = p->d;
  size_t count = sort_certain(p), open = 0;
  for (size_t k = 0; k < count; k++) {
    if (k + AHEAD < count) __builtin_prefetch(&p->taken[p->order[k + AHEAD].index], 1);
    taken *t = &p->taken[p->order[k].index];
    t->key = (uint32_t)k;
    p->moves += sqrt((double)t->error);
  }
  if (!d->s.closed)
    for (size_t k = 0; k < count; k++) open += p->taken[p->order[k].index].open;
  scree_parallel_for(p->taken_count, TAKEN_BLOCK, apply_block, p);
  d->record.count += count;
  d->s.live_vertex_count -= count;
  d->s.live_triangle_count -= 2 * count - open;
  return count;
}

static scree_status prepare_grid(scree_decimator *d) {
  scree_status status = SCREE_OK;
  if (!d->grid.built_for ||
      (double)d->s.live_triangle_count <= SCREE_REGRID_BELOW * (double)d->grid.built_for)
    status = scree_grid_shape(&d->grid, &d->s, SCREE_EDGES_PER_CELL, d->error);
  if (status == SCREE_OK) scree_grid_enter_directions(&d->grid, &d->s);
  return status;
}

static size_t run_round(pass *p) {
  choose_and_check(p);
  scree_parallel_for(p->taken_count, TAKEN_BLOCK, certify_block, p);
  search_uncertain(p);
  return apply(p);
}

/* Keeps the surface when it has become small enough; finds how far collapses may take it off. */
static scree_status set_usual(pass *p) {
  scree_decimator *d = p->d;
  size_t count = d->s.live_triangle_count;
  size_t kept = scree_is_large(d) ? SCREE_KEPT_LATE : SCREE_KEPT_COUNT;
  scree_status status = SCREE_OK;
  if (!d->coster->merge && d->first_triangle_count > SCREE_CLOSE_SCAN &&
      count <= SCREE_SURFACE_COUNT && !scree_memory_has_surface(&d->memory))
    status = scree_memory_keep_surface(&d->s, &d->memory, d->error);
  if (status == SCREE_OK && !d->coster->merge && count <= kept && !scree_memory_is_kept(&d->memory))
    status = scree_decimate_keep(d);
  p->usual2 = scree_usual_stray2(d);
  p->moves = 0;
  return status;
}

/* After compacting: memory that is not needed any more. The record needs it. */
static void discard_tails(const pass *p) {
  const scree_halfmesh *s = &p->d->s;
  size_t n = s->vertex_count, triangles = s->triangle_count, room = n / 6 + 1;
  struct {
    void *block;
    size_t size;
  } used[] = {{p->e.best, n * sizeof *p->e.best},
              {p->e.cost, n * sizeof *p->e.cost},
              {p->chosen, n * sizeof *p->chosen},
              {p->contenders, (n + SCREE_PASS_BLOCK) * sizeof *p->contenders},
              {p->taken, room * sizeof *p->taken},
              {p->changes, room * sizeof *p->changes},
              {p->order, room * sizeof *p->order},
              {p->swap, room * sizeof *p->swap},
              {p->edges, triangles * sizeof *p->edges}};
  for (size_t i = 0; i < sizeof used / sizeof *used; i++)
    scree_discard_tail(used[i].block, used[i].size);
  scree_halfmesh_give_back(s);
}

static scree_status run_pass(pass *p, size_t *done) {
  scree_decimator *d = p->d;
  scree_status status = prepare_grid(d);
  if (status == SCREE_OK) status = set_usual(p);
  if (status != SCREE_OK) return status;
  scree_cheapest_refresh_sums(&p->e);
  scree_cheapest_find(&p->e);
  *done = 0;
  if (!scree_cheapest_set_limit(&p->e)) return SCREE_OK;
  for (int round = 0; round < ROUNDS; round++) {
    if (round == 0) {
      scree_parallel_for(d->s.vertex_count, SCREE_PASS_BLOCK, list_block, p);
    } else {
      scree_cheapest_refresh_sums(&p->e);
      scree_parallel_for(d->s.vertex_count, SCREE_PASS_BLOCK, reconsider_block, p);
    }
    status = scree_anchors_find(&d->s, &d->anchors, d->error);
    if (status != SCREE_OK) return status;
    *done += run_round(p);
  }
  if (*done > 0) d->mean_move = p->moves / (double)*done;
  scree_limits_follow(d, 2 * (double)*done / (double)d->s.live_triangle_count);
  if ((double)d->s.live_triangle_count < COMPACT_BELOW * (double)d->s.triangle_count) {
    if (scree_memory_has_surface(&d->memory)) scree_memory_compact(&d->memory, &d->s);
    scree_halfmesh_compact(&d->s, (uint32_t *)p->contenders, p->edges);
    discard_tails(p);
  }
  return SCREE_OK;
}

scree_status scree_decimate_in_batches(scree_decimator *d) {
  pass p = {.d = d};
  size_t done = 1;
  scree_status status = SCREE_OK;
  d->lenient = 0; /* patches end early for other reasons as well */
  if (d->s.live_triangle_count > d->single_from) status = pass_allocate(&p);
  while (status == SCREE_OK && done > 0 && d->s.live_triangle_count > d->single_from &&
         d->s.live_triangle_count > d->options.stop_count)
    status = scree_decimate_tick(d, &d->ticker) ? run_pass(&p, &done) : SCREE_CANCELLED;
  pass_free(&p);
  return status;
}
