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
#include "base/prefetch.h"
#include "base/radix.h"
#include "simplify/independent.h"

#include <string.h>

/* What a pass takes: candidates up to this share of all, if below SPREAD times the cost at the
 * share LOW_SHARE. The threshold rises from pass to pass as in a greedy order, and features wait
 * until what is flat is gone. */
#define HIGH_SHARE 0.6
#define LOW_SHARE  0.3
#define SPREAD     8.0
/* While more than this share of the triangles is left, candidates up to this share. */
#define FINE       0.2
#define FINE_SHARE 0.9
enum { ROUNDS = 4 };
/* Where there are no more than SCREE_GREEDY_COUNT triangles, what is usual for the squared stray
 * counts for so much: single collapses would look at more places, and pay a toll. */
#define COARSE_USUAL2 0.5
/* Below that share, as long as no surface is kept: how far one collapse may stray, in mean moves of
 * those of the pass before. */
#define MOST_MOVES 4.0
/* Compact when less than this is left of the arrays. */
#define COMPACT_BELOW 0.8
/* Mean edges per grid cell, and the share of triangles left at which it gets new cells. */
#define EDGES_PER_CELL 2.0
#define REGRID_BELOW   0.6

enum { VERTEX_BLOCK = SCREE_CHOICE_BLOCK, TAKEN_BLOCK = 256, BINS = 1 << 16 };
/* Edges evaluated in one call; how far ahead memory is asked for in a walk over all. */
enum { SIDE_BY_SIDE = 64, AHEAD = 16 };

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

/* Of a block of vertices: those with an edge that may be collapsed; where its collapses taken
 * begin; the greatest cost of its candidates. */
typedef struct part {
  size_t possible, first;
  double dearest;
} part;

typedef struct pass {
  scree_decimator *d;
  uint32_t *best;        /* per vertex: half-edge of its cheapest edge, or NONE */
  double *cost;          /* per vertex: of that */
  uint8_t *marks;        /* per vertex: see independent.h */
  uint32_t *chosen;      /* per vertex: the index of the collapse it is an end of, or NONE; before
                            collapses are taken, see leader in independent.h */
  uint32_t *apex_leader; /* this and the next two: see independent.h */
  scree_contender *contenders;
  struct scree_choice_count *counts;
  scree_choosing choosing; /* of the above */
  uint32_t limit;          /* the threshold, as a key */
  uint32_t cheap;          /* the cost that LOW_SHARE of the edges do not exceed, as a key */
  double dearest; /* the greatest cost below it: the threshold without the key's rounding */
  double usual2;  /* squared stray that no collapse of this pass may exceed */
  double moves;   /* sum over the collapses of this pass: how far they moved the surface */
  taken *taken;   /* in the order of their vertices */
  scree_change *changes;
  size_t taken_count, room;
  uint32_t *edges;           /* the rings */
  scree_keyed *order, *swap; /* of those that are done: in the order of cost, by its leading bits */
  uint32_t *uncertain;
  size_t uncertain_count;
  uint32_t *bins; /* twice two sets */
  part *parts;
} pass;

static void pass_free(pass *p) {
  scree_free(p->best);
  scree_free(p->cost);
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
  scree_free(p->bins);
  scree_free(p->parts);
}

static scree_status pass_allocate(pass *p) {
  scree_error *error = p->d->error;
  size_t n = p->d->s.vertex_count, triangles = p->d->s.triangle_count;
  size_t blocks = scree_block_count(n, VERTEX_BLOCK);
  p->room = n / 6 + 1; /* more wait for the next round */
  SCREE_ALLOC_OR(p->best, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->cost, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->marks, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->chosen, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->apex_leader, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->contenders, blocks * VERTEX_BLOCK, error, out_of_memory);
  SCREE_ALLOC_OR(p->counts, blocks, error, out_of_memory);
  SCREE_ALLOC_OR(p->taken, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->changes, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->order, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->swap, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->uncertain, p->room, error, out_of_memory);
  SCREE_ALLOC_OR(p->edges, triangles + SCREE_RING_MAX, error, out_of_memory);
  SCREE_ALLOC_OR(p->bins, 4 * BINS, error, out_of_memory);
  SCREE_ALLOC_OR(p->parts, blocks, error, out_of_memory);
  memset(p->chosen, 0xff, n * sizeof *p->chosen);
  memset(p->apex_leader, 0xff, n * sizeof *p->apex_leader);
  p->choosing = (scree_choosing){.s = &p->d->s,
                                 .best = p->best,
                                 .cost = p->cost,
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

/* Asks for these vertices and most of their triangles, which lie in the same order: before a loop
 * over them that would wait for one after the other. */
SCREE_PREFETCHES void ask_for_block(const scree_halfmesh *s, size_t begin, size_t end) {
  enum { MOST = 16384 }; /* half-edges; more are no block */
  scree_prefetch(s->vertex + begin, (end - begin) * sizeof *s->vertex);
  while (begin < end && s->vertex[begin].outgoing == SCREE_NONE) begin++;
  while (begin < end && s->vertex[end - 1].outgoing == SCREE_NONE) end--;
  if (begin == end) return;
  uint32_t first = s->vertex[begin].outgoing, last = s->vertex[end - 1].outgoing;
  if (first < last && last - first <= MOST)
    scree_prefetch(s->half + first, (last - first) * sizeof *s->half);
}

static void sum_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_decimator *d = ((pass *)context)->d;
  uint32_t stale[VERTEX_BLOCK], count = 0;
  ask_for_block(&d->s, begin, end);
  for (size_t v = begin; v < end; v++) {
    stale[count] = (uint32_t)v;
    count += (d->s.vertex[v].outgoing != SCREE_NONE) & ((d->s.flags[v] & SCREE_VERTEX_STALE) != 0);
  }
  for (uint32_t i = 0; i < count; i++) {
    /* the loop before has set it: NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage) */
    d->coster->sum(&d->s, stale[i]);
    d->s.flags[stale[i]] &= (uint8_t)~SCREE_VERTEX_STALE;
  }
}

static void refresh_sums(pass *p) {
  if (!p->d->coster->merge) scree_parallel_for(p->d->s.vertex_count, VERTEX_BLOCK, sum_block, p);
}

/* Whether the edge between them is looked at from u rather than v: from the larger fan, so that
 * turning the scan, which changes numbers, changes nothing. (From the smaller fan the fine levels'
 * mean distance is 1 to 3 % larger.) */
static bool looks(const scree_halfmesh *s, uint32_t u, uint32_t v) {
  const double *a = s->sums[u], *b = s->sums[v];
  double size_u = a[0] + a[3] + a[5], size_v = b[0] + b[3] + b[5]; /* the quadrics' traces */
  return (size_u > size_v) | ((size_u == size_v) & (u < v));
}

/* Whether edge h, which was refused or had to wait, may be collapsed after all. */
static bool reopens(scree_halfmesh *s, uint32_t v, uint32_t other, uint32_t h) {
  if (s->refused[h] == SCREE_EDGE_REFUSED &&
      !((s->flags[v] | s->flags[other]) & SCREE_VERTEX_CHANGED))
    return false;
  s->refused[h] = 0;
  return true;
}

/* Whether edge h is to be looked at from vertex v, and may be. Half of them are not, at random:
 * hence without a branch. */
static bool open_to_collapse(scree_halfmesh *s, uint32_t v, uint32_t h) {
  uint32_t other = scree_to(s, h);
  bool open = (s->half[h].twin == SCREE_NONE) | looks(s, v, other);
  open &= !(s->flags[other] & SCREE_VERTEX_LOCKED);
  return s->refused[h] ? open && reopens(s, v, other, h) : open;
}

/* Edges that wait for their evaluation. */
typedef struct waiting {
  uint32_t edge[SIDE_BY_SIDE];
  uint32_t count;
} waiting;

/* Takes edge i for its vertex if it is the cheapest so far; of equally cheap ones the first. Of
 * those waiting the one with number *has is what the vertex has, if not lower than `begin`. */
static void take_cheaper(pass *p, const waiting *w, uint32_t v, uint32_t i, scree_candidate *c,
                         uint32_t *has) {
  double most = p->cost[v];
  if (!(c->cost < most || (c->cost == most && i < *has)) || !(c->error <= p->d->error_limit))
    return;
  if (p->d->coster->shape) {
    p->d->coster->shape(&p->d->s, w->edge[i], most, c);
    if (!(c->cost < most || (c->cost == most && i < *has))) return;
  }
  p->cost[v] = c->cost;
  p->best[v] = w->edge[i];
  *has = i;
}

static void evaluate_waiting(pass *p, waiting *w) {
  const scree_halfmesh *s = &p->d->s;
  scree_candidate candidates[SIDE_BY_SIDE];
  p->d->coster->evaluate(s, w->edge, w->count, candidates);
  for (uint32_t begin = 0, end; begin < w->count; begin = end) {
    uint32_t v = s->half[w->edge[begin]].from, likely = begin, has = begin;
    for (end = begin + 1; end < w->count && s->half[w->edge[end]].from == v; end++)
      if (candidates[end].cost < candidates[likely].cost) likely = end;
    take_cheaper(p, w, v, likely, &candidates[likely], &has);
    if (!p->d->coster->shape && candidates[likely].error <= p->d->error_limit) continue;
    for (uint32_t i = begin; i < end; i++) /* few of their shapes matter now */
      if (i != likely) take_cheaper(p, w, v, i, &candidates[i], &has);
  }
  w->count = 0;
}

static void evaluate_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  pass *p = context;
  scree_halfmesh *s = &p->d->s;
  waiting w = {.count = 0};
  ask_for_block(s, begin, end);
  scree_prefetch(s->sums[begin], (end - begin) * sizeof *s->sums);
  for (size_t v = begin; v < end; v++) {
    p->best[v] = SCREE_NONE;
    p->cost[v] = INFINITY;
    if (s->vertex[v].outgoing == SCREE_NONE || s->flags[v] & SCREE_VERTEX_LOCKED) continue;
    uint32_t first = s->vertex[v].outgoing, h = first;
    do {
      w.edge[w.count] = h;
      w.count += open_to_collapse(s, (uint32_t)v, h);
      if (w.count == SIDE_BY_SIDE) evaluate_waiting(p, &w);
      h = scree_turn(s, h);
    } while (h != SCREE_NONE && h != first);
  }
  evaluate_waiting(p, &w);
  p->parts[block].possible = 0;
  for (size_t v = begin; v < end; v++) p->parts[block].possible += p->cost[v] < INFINITY;
}

/* The leading 32 bits below the sign: monotone in the cost. */
static uint32_t key_of(double cost) {
  uint64_t bits;
  memcpy(&bits, &cost, sizeof bits);
  return (uint32_t)(bits >> 31);
}

static double cost_of_key(uint32_t key) {
  uint64_t bits = (uint64_t)key << 31;
  double cost;
  memcpy(&cost, &bits, sizeof cost);
  return cost;
}

/* The bin that holds the item of this rank, which becomes its rank among those of the bin. */
static uint32_t bin_at(const uint32_t *bins, size_t *rank) {
  for (uint32_t bin = 0; bin < BINS - 1; bin++) {
    if (bins[bin] > *rank) return bin;
    *rank -= bins[bin];
  }
  return BINS - 1;
}

/* Counting keys: first their upper halves, then the lower halves below two upper ones. */
typedef struct counting {
  pass *p;
  bool upper;
  uint32_t high[2];
} counting;

static void count_keys(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  const counting *c = context;
  uint32_t *bins = c->p->bins + block * 2 * BINS;
  for (size_t v = begin; v < end; v++) {
    if (!(c->p->cost[v] < INFINITY)) continue;
    uint32_t key = key_of(c->p->cost[v]);
    if (c->upper) {
      bins[key >> 16]++;
      continue;
    }
    for (size_t i = 0; i < 2; i++)
      if (key >> 16 == c->high[i]) bins[i * BINS + (key & 0xffff)]++;
  }
}

/* Both halves of the vertices are counted in bins of their own. */
static void count_all_keys(counting *c) {
  pass *p = c->p;
  size_t vertices = p->d->s.vertex_count, used = c->upper ? BINS : 2 * BINS;
  for (size_t half = 0; half < 2; half++)
    memset(p->bins + half * 2 * BINS, 0, used * sizeof *p->bins);
  scree_parallel_for(vertices, vertices / 2 + 1, count_keys, c);
  for (size_t bin = 0; bin < used; bin++) p->bins[bin] += p->bins[2 * BINS + bin];
}

/* The keys of the items of these two ranks: the upper halves by one count, the lower ones by
 * another. A coarser answer would depend on the scale of the scan. */
static void keys_at(pass *p, size_t rank[2], uint32_t key[2]) {
  counting c = {.p = p, .upper = true};
  count_all_keys(&c);
  for (int i = 0; i < 2; i++) c.high[i] = bin_at(p->bins, &rank[i]);
  c.upper = false;
  count_all_keys(&c);
  for (int i = 0; i < 2; i++)
    key[i] = c.high[i] << 16 | bin_at(p->bins + (size_t)i * BINS, &rank[i]);
}

static bool is_candidate(const pass *p, size_t v) {
  return key_of(p->cost[v]) <= p->limit;
}

/* Of a block of vertices: lists its candidates, and enters them for the choice. Who is one, and who
 * a cheap one, is as good as random: hence without branches. */
static void list_candidates(pass *p, size_t begin, size_t end) {
  size_t block = begin / VERTEX_BLOCK;
  scree_contender *contenders = p->contenders + begin, cheap[VERTEX_BLOCK + 1];
  uint32_t candidates[VERTEX_BLOCK + 1], candidate_count = 0, count = 0, cheap_count = 0;
  double dearest = 0;
  for (size_t v = begin; v < end; v++) {
    p->marks[v] = 0;
    candidates[candidate_count] = (uint32_t)v;
    candidate_count += is_candidate(p, v);
  }
  for (uint32_t i = 0; i < candidate_count; i++) {
    uint32_t v = candidates[i];
    bool is_cheap = key_of(p->cost[v]) <= p->cheap;
    scree_ring r;
    scree_ring_name(&p->d->s, p->best[v], &r);
    contenders[count] = cheap[cheap_count] =
        (scree_contender){.a = r.a, .b = r.b, .c = r.c, .d = r.d};
    count += !is_cheap;
    cheap_count += is_cheap;
    dearest = p->cost[v] > dearest ? p->cost[v] : dearest;
  }
  memcpy(contenders + count, cheap, cheap_count * sizeof *cheap);
  p->counts[block] = (struct scree_choice_count){.waiting = count, .left = cheap_count};
  p->parts[block].dearest = dearest;
  scree_choose_enter(&p->choosing, block);
}

static void list_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  ask_for_block(&p->d->s, begin, end);
  for (size_t v = begin; v < end; v++) p->d->s.flags[v] &= (uint8_t)~SCREE_VERTEX_CHANGED;
  list_candidates(p, begin, end);
}

/* The candidates of the first round; the greatest cost among them. */
static void list_first(pass *p) {
  size_t count = p->d->s.vertex_count;
  scree_parallel_for(count, VERTEX_BLOCK, list_block, p);
  p->dearest = 0;
  for (size_t i = 0; i < scree_block_count(count, VERTEX_BLOCK); i++)
    p->dearest = fmax(p->dearest, p->parts[i].dearest);
}

static bool is_fine(const scree_decimator *d) {
  return (double)d->s.live_triangle_count > FINE * (double)d->first_triangle_count;
}

/* Sets the threshold. False: there is nothing to collapse. */
static bool set_limit(pass *p) {
  size_t count = 0, vertices = p->d->s.vertex_count;
  uint32_t key[2];
  for (size_t i = 0; i < scree_block_count(vertices, VERTEX_BLOCK); i++)
    count += p->parts[i].possible;
  if (count == 0) return false;
  bool fine = is_fine(p->d);
  double high = fine ? FINE_SHARE : HIGH_SHARE;
  keys_at(p, (size_t[2]){(size_t)(high * (double)count), (size_t)(LOW_SHARE * (double)count)}, key);
  uint32_t spread = key_of(fmin(SPREAD * cost_of_key(key[1]), 1e300));
  p->limit = fine || key[0] < spread ? key[0] : spread;
  p->cheap = key[1];
  return true;
}

static void reconsider_waiting(pass *p, waiting *w) {
  const scree_halfmesh *s = &p->d->s;
  scree_candidate candidates[SIDE_BY_SIDE];
  p->d->coster->evaluate(s, w->edge, w->count, candidates);
  for (uint32_t i = 0; i < w->count; i++) {
    if (p->d->coster->shape && key_of(candidates[i].cost) <= p->limit)
      p->d->coster->shape(s, w->edge[i], cost_of_key(p->limit + 1), &candidates[i]);
    p->cost[s->half[w->edge[i]].from] =
        candidates[i].error <= p->d->error_limit ? candidates[i].cost : INFINITY;
  }
  w->count = 0;
}

/* Finds what the candidates of the last round cost now, if they are still there; lists them. */
static void reconsider_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_halfmesh *s = &p->d->s;
  waiting w = {.count = 0};
  uint32_t candidates[VERTEX_BLOCK], count = 0;
  ask_for_block(s, begin, end);
  scree_prefetch(s->sums[begin], (end - begin) * sizeof *s->sums);
  for (size_t v = begin; v < end; v++) {
    candidates[count] = (uint32_t)v;
    count += is_candidate(p, v);
  }
  for (uint32_t i = 0; i < count; i++) {
    uint32_t v = candidates[i], h = p->best[v];
    bool gone =
        (s->vertex[v].outgoing == SCREE_NONE) | (s->half[h].from != v) | (s->refused[h] != 0);
    uint32_t other = gone ? v : scree_to(s, h);
    bool changed = ((s->flags[v] | s->flags[other]) & SCREE_VERTEX_CHANGED) != 0;
    p->cost[v] = gone ? INFINITY : p->cost[v];
    w.edge[w.count] = h;
    w.count += !gone & changed;
    if (w.count == SIDE_BY_SIDE) reconsider_waiting(p, &w);
  }
  reconsider_waiting(p, &w);
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

/* Whether the collapse takes the surface too far off for this pass. */
static bool strays(const pass *p, const scree_ring *ring, const scree_candidate *c) {
  const scree_decimator *d = p->d;
  double most = fmin(scree_stray_at(c, p->dearest), p->usual2);
  if (!scree_memory_is_kept(&d->memory))
    return !scree_stays_within(&d->s, ring, c->target, most) ||
           (p->usual2 < INFINITY && !scree_ends_stay_within(&d->s, ring, c->target, most));
  return !scree_memory_stays_within(&d->memory, &d->s, ring, c->target,
                                    scree_is_close_scan(d) ? SCREE_EDGE_PLACES : 1, most);
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
               scree_collapse_check(&d->s, &ring, change, &around);
  t->verdict = sound ? UNCERTAIN : REFUSED;
  if (!sound) return;
  t->steep = around.steep;
  if (candidate->stray > 0 && strays(p, &ring, candidate)) {
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
  uint32_t edges[SIDE_BY_SIDE];
  scree_candidate candidates[SIDE_BY_SIDE];
  while (begin < end) {
    size_t count = end - begin < SIDE_BY_SIDE ? end - begin : SIDE_BY_SIDE;
    ask_for_rings(p, p->taken + begin, count);
    for (size_t k = 0; k < count; k++) edges[k] = p->taken[begin + k].half_edge;
    p->d->coster->evaluate(&p->d->s, edges, count, candidates);
    for (size_t k = 0; k < count; k++) check_one(p, (uint32_t)(begin + k), &candidates[k]);
    begin += count;
  }
}

static void take(pass *p, const scree_contender *c, size_t index) {
  const scree_half_edge *half = p->d->s.half;
  uint32_t h = p->best[c->taken];
  p->taken[index] = (taken){.half_edge = h,
                            .first_edge = c->first_edge,
                            .key = key_of(p->cost[c->taken]),
                            .a_count = (uint16_t)c->a_count,
                            .count = (uint16_t)c->count,
                            .open = half[h].twin == SCREE_NONE};
  p->chosen[c->taken] = p->chosen[scree_to(&p->d->s, h)] = (uint32_t)index;
}

static void take_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)end, (void)worker;
  pass *p = context;
  size_t first = p->parts[block].first, next = first, count = p->counts[block].taken;
  const scree_contender *first_taken = p->contenders + begin + VERTEX_BLOCK - count;
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
  for (size_t i = 0; i < scree_block_count(vertices, VERTEX_BLOCK); i++) {
    p->parts[i].first = p->taken_count;
    p->taken_count += p->counts[i].taken;
    if (p->taken_count > p->room) p->taken_count = p->room;
  }
  scree_parallel_for(vertices, VERTEX_BLOCK, take_block, p);
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
  scree_parallel_for(p->uncertain_count, TAKEN_BLOCK / 16, search_block, p);
}

static void set_flag(scree_halfmesh *s, uint32_t v) {
  const uint8_t flag = SCREE_VERTEX_STALE | SCREE_VERTEX_CHANGED;
  if ((__atomic_load_n(&s->flags[v], __ATOMIC_RELAXED) & flag) != flag)
    __atomic_fetch_or(&s->flags[v], flag, __ATOMIC_RELAXED);
}

/* Items of equal key by the rest of their cost, where few are equal. Where many are (a regular grid
 * on a flat) the rest is rounding, and the order of the vertices serves as well. */
static void refine_order(const pass *p, scree_keyed *items, size_t count) {
  enum { FEW = 16 };
  const scree_half_edge *half = p->d->s.half;
  for (size_t begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count && items[end].key == items[begin].key;) end++;
    if (end - begin > FEW) continue;
    for (size_t i = begin + 1; i < end; i++) {
      scree_keyed moved = items[i];
      double cost = p->cost[half[p->taken[moved.index].half_edge].from];
      size_t j = i;
      for (; j > begin && p->cost[half[p->taken[items[j - 1].index].half_edge].from] > cost; j--)
        items[j] = items[j - 1];
      items[j] = moved;
    }
  }
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
  refine_order(p, p->order, count);
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
  for (size_t i = begin; i < end; i++) {
    if ((i - begin) % SIDE_BY_SIDE == 0)
      ask_for_changes(p, p->taken + i, end - i < SIDE_BY_SIDE ? end - i : SIDE_BY_SIDE);
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
      (double)d->s.live_triangle_count <= REGRID_BELOW * (double)d->grid.built_for)
    status = scree_grid_shape(&d->grid, &d->s, EDGES_PER_CELL, d->error);
  if (status == SCREE_OK) scree_grid_enter_directions(&d->grid, &d->s);
  return status;
}

static size_t run_round(pass *p) {
  choose_and_check(p);
  scree_parallel_for(p->taken_count, TAKEN_BLOCK, certify_block, p);
  search_uncertain(p);
  return apply(p);
}

/* Finds how far collapses may take the surface off; keeps it when it has become small enough. */
static scree_status set_usual(pass *p, size_t last_count) {
  scree_decimator *d = p->d;
  size_t count = d->s.live_triangle_count;
  size_t kept = scree_is_large(d) ? SCREE_KEPT_LATE : SCREE_KEPT_COUNT;
  double usual = 0;
  scree_status status = SCREE_OK;
  if (!d->coster->merge && scree_is_close_scan(d) && count <= SCREE_SURFACE_COUNT &&
      !scree_memory_has_surface(&d->memory))
    status = scree_memory_keep_surface(&d->s, &d->memory, d->error);
  if (status == SCREE_OK && !d->coster->merge && count <= kept && !scree_memory_is_kept(&d->memory))
    status = scree_decimate_keep(d);
  if (status != SCREE_OK) return status;
  if (scree_memory_is_kept(&d->memory)) {
    usual = scree_memory_usual(&d->memory, scree_is_held_close(d));
    if (usual > 0 && !scree_is_close_scan(d)) usual = fmax(usual, scree_memory_worst(&d->memory));
  } else if (!is_fine(d)) {
    usual = MOST_MOVES * p->moves / (double)last_count;
  }
  p->usual2 = usual > 0 ? usual * usual : INFINITY;
  if (count <= SCREE_GREEDY_COUNT) p->usual2 *= COARSE_USUAL2;
  p->moves = 0;
  return SCREE_OK;
}

/* After compacting: memory that is not needed any more. The record needs it. */
static void discard_tails(const pass *p) {
  const scree_halfmesh *s = &p->d->s;
  size_t n = s->vertex_count, triangles = s->triangle_count, room = n / 6 + 1;
  struct {
    void *block;
    size_t size;
  } used[] = {{s->vertex, n * sizeof *s->vertex},
              {s->half, 3 * triangles * sizeof *s->half},
              {s->sums, n * sizeof *s->sums},
              {s->refused, 3 * triangles},
              {p->best, n * sizeof *p->best},
              {p->cost, n * sizeof *p->cost},
              {p->chosen, n * sizeof *p->chosen},
              {p->contenders, (n + VERTEX_BLOCK) * sizeof *p->contenders},
              {p->taken, room * sizeof *p->taken},
              {p->changes, room * sizeof *p->changes},
              {p->order, room * sizeof *p->order},
              {p->swap, room * sizeof *p->swap},
              {p->edges, triangles * sizeof *p->edges}};
  for (size_t i = 0; i < sizeof used / sizeof *used; i++)
    scree_discard_tail(used[i].block, used[i].size);
}

static scree_status run_pass(pass *p, size_t *done) {
  scree_decimator *d = p->d;
  scree_status status = prepare_grid(d);
  if (status == SCREE_OK) status = set_usual(p, *done);
  if (status != SCREE_OK) return status;
  refresh_sums(p);
  scree_parallel_for(d->s.vertex_count, VERTEX_BLOCK, evaluate_block, p);
  *done = 0;
  if (!set_limit(p)) return SCREE_OK;
  for (int round = 0; round < ROUNDS; round++) {
    if (round == 0) {
      list_first(p);
    } else {
      refresh_sums(p);
      scree_parallel_for(d->s.vertex_count, VERTEX_BLOCK, reconsider_block, p);
    }
    status = scree_anchors_find(&d->s, &d->anchors, d->error);
    if (status != SCREE_OK) return status;
    *done += run_round(p);
  }
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
  if (d->s.live_triangle_count > d->single_from) status = pass_allocate(&p);
  while (status == SCREE_OK && done > 0 && d->s.live_triangle_count > d->single_from &&
         d->s.live_triangle_count > d->options.stop_count)
    status = scree_decimate_tick(d) ? run_pass(&p, &done) : SCREE_CANCELLED;
  pass_free(&p);
  return status;
}
