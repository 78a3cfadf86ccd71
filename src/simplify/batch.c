/* Batches: the many collapses of the fine levels, in parallel and yet in one order.
 *
 * A pass evaluates every edge, keeps the cheapest of each vertex, and takes of these, in the order
 * of cost, all below a threshold that are independent of those taken before. Independent means: the
 * closed stars share no vertex that either collapse moves or removes, no triangle beyond the one's
 * ring belongs to the other's, and no vertex is apex of both. Then no collapse changes what another
 * one was checked against, they can be done in any order, and every prefix of the pass, which the
 * record holds in the order of cost, is a valid surface: a level.
 *
 * Everything parallel handles its items by themselves; the only shared writes are the grid's sets
 * of directions, which grow by OR. So the result does not depend on the number of threads. */
#include "simplify/decimate.h"

#include "base/parallel.h"

#include <string.h>

/* What a pass takes: candidates up to this share of all, if below SPREAD times the cost at the
 * share LOW_SHARE. The threshold rises from pass to pass as in a greedy order, and features wait
 * until what is flat is gone. */
#define HIGH_SHARE 0.5
#define LOW_SHARE  0.25
#define SPREAD     8.0
/* Compact when less than this is left of the arrays. */
#define COMPACT_BELOW 0.8
/* Grid cells per mean edge, and the share of triangles left at which the grid is built anew. */
#define EDGES_PER_CELL 3.0
#define REGRID_BELOW   0.6

enum { VERTEX_BLOCK = 1024, CHOSEN_BLOCK = 256, BINS = 1 << 16 };

enum { TOUCHED = 1, ENDPOINT = 2, APEX = 4 };
enum { REFUSED, CERTAIN, UNCERTAIN };

typedef struct item {
  uint32_t key, vertex; /* key: the leading bits of the cost */
} item;

typedef struct pass {
  scree_decimator *d;
  uint32_t *best;     /* per vertex: half-edge of its cheapest edge, or NONE */
  double *cost;       /* per vertex: of that */
  uint8_t *marks;     /* per vertex */
  item *items, *swap; /* candidates in order */
  uint32_t *chosen;   /* per vertex; the collapse that takes it, for exact tests */
  size_t item_count;
  uint32_t *taken; /* half-edges chosen, in order of cost */
  size_t taken_count;
  scree_change *changes;
  float *errors;
  uint8_t *verdicts;
  uint32_t *uncertain;
  size_t uncertain_count;
} pass;

static void pass_free(pass *p) {
  scree_free(p->best);
  scree_free(p->cost);
  scree_free(p->marks);
  scree_free(p->items);
  scree_free(p->swap);
  scree_free(p->chosen);
  scree_free(p->taken);
  scree_free(p->changes);
  scree_free(p->errors);
  scree_free(p->verdicts);
  scree_free(p->uncertain);
}

/* Independent collapses take at least four vertices each (two ends, and apexes or links shared by
 * few): a third of the vertices is room enough. */
static size_t taken_room(size_t vertex_count) {
  return vertex_count / 3 + 1;
}

static scree_status pass_allocate(pass *p) {
  scree_error *error = p->d->error;
  size_t n = p->d->s.vertex_count, room = taken_room(n);
  size_t triangles = p->d->s.triangle_count, scratch = n > triangles ? n : (triangles + 1) / 2;
  SCREE_ALLOC_OR(p->best, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->cost, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->marks, n, error, out_of_memory);
  SCREE_ALLOC_OR(p->items, scratch, error, out_of_memory);
  SCREE_ALLOC_OR(p->swap, scratch, error, out_of_memory);
  SCREE_ALLOC_OR(p->taken, room, error, out_of_memory);
  SCREE_ALLOC_OR(p->changes, room, error, out_of_memory);
  SCREE_ALLOC_OR(p->errors, room, error, out_of_memory);
  SCREE_ALLOC_OR(p->verdicts, room, error, out_of_memory);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static void sum_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_decimator *d = ((pass *)context)->d;
  for (size_t v = begin; v < end; v++)
    if (d->s.outgoing[v] != SCREE_NONE && d->s.flags[v] & SCREE_VERTEX_DIRTY)
      d->coster->sum(&d->s, (uint32_t)v);
}

/* Whether edge h is to be looked at from vertex v, and may be. */
static bool open_to_collapse(scree_halfmesh *s, uint32_t v, uint32_t h) {
  uint32_t other = scree_to(s, h), twin = s->twin[h];
  if (twin != SCREE_NONE && other < v) return false; /* looked at from there */
  if (s->flags[other] & SCREE_VERTEX_LOCKED) return false;
  if (!s->refused[h]) return true;
  if (!((s->flags[v] | s->flags[other]) & SCREE_VERTEX_DIRTY)) return false;
  s->refused[h] = 0;
  return true;
}

static void evaluate_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_halfmesh *s = &p->d->s;
  for (size_t v = begin; v < end; v++) {
    p->best[v] = SCREE_NONE;
    p->cost[v] = INFINITY;
    if (s->outgoing[v] == SCREE_NONE || s->flags[v] & SCREE_VERTEX_LOCKED) continue;
    uint32_t first = s->outgoing[v], h = first;
    do {
      if (open_to_collapse(s, (uint32_t)v, h)) {
        scree_candidate candidate;
        p->d->coster->evaluate(s, h, &candidate);
        if (candidate.cost < p->cost[v] && candidate.error <= p->d->error_limit) {
          p->cost[v] = candidate.cost;
          p->best[v] = h;
        }
      }
      h = scree_turn(s, h);
    } while (h != SCREE_NONE && h != first);
  }
}

/* The leading 32 bits below the sign: monotone in the cost. */
static uint32_t key_of(double cost) {
  uint64_t bits;
  memcpy(&bits, &cost, sizeof bits);
  return (uint32_t)(bits >> 31);
}

/* The cost below which `share` of all candidates lie, to a bin of 1/32 of itself. */
static uint32_t key_at(const uint32_t *bins, size_t count, double share) {
  size_t wanted = (size_t)(share * (double)count), sum = 0;
  for (uint32_t bin = 0; bin < BINS; bin++) {
    sum += bins[bin];
    if (sum > wanted) return bin << 16 | 0xffff;
  }
  return UINT32_MAX;
}

static double cost_of_key(uint32_t key) {
  uint64_t bits = (uint64_t)key << 31;
  double cost;
  memcpy(&cost, &bits, sizeof cost);
  return cost;
}

static void sort_items(pass *p) {
  enum { DIGIT = 11, RADIX = 1 << DIGIT };
  for (int shift = 0; shift < 32; shift += DIGIT) {
    size_t start[RADIX + 1] = {0};
    for (size_t i = 0; i < p->item_count; i++)
      start[(p->items[i].key >> shift & (RADIX - 1)) + 1]++;
    for (int r = 0; r < RADIX; r++) start[r + 1] += start[r];
    for (size_t i = 0; i < p->item_count; i++)
      p->swap[start[p->items[i].key >> shift & (RADIX - 1)]++] = p->items[i];
    item *other = p->items;
    p->items = p->swap;
    p->swap = other;
  }
  for (size_t i = 1; i < p->item_count; i++) { /* equal keys, by the rest of the cost */
    item moved = p->items[i];
    size_t j = i;
    for (; j > 0 && p->items[j - 1].key == moved.key &&
           p->cost[p->items[j - 1].vertex] > p->cost[moved.vertex];
         j--)
      p->items[j] = p->items[j - 1];
    p->items[j] = moved;
  }
}

/* Lists the candidates below the threshold, in the order of cost. */
static scree_status order_candidates(pass *p) {
  scree_halfmesh *s = &p->d->s;
  uint32_t *bins = scree_alloc_zero(BINS, sizeof *bins);
  if (!bins) return scree_fail_memory(p->d->error, BINS * sizeof *bins, "bins");
  size_t count = 0;
  for (size_t v = 0; v < s->vertex_count; v++) {
    if (p->best[v] == SCREE_NONE) continue;
    bins[key_of(p->cost[v]) >> 16]++;
    count++;
  }
  uint32_t high = key_at(bins, count, HIGH_SHARE), low = key_at(bins, count, LOW_SHARE);
  scree_free(bins);
  uint32_t spread = key_of(fmin(SPREAD * cost_of_key(low), 1e300));
  uint32_t limit = high < spread ? high : spread;
  p->item_count = 0;
  for (size_t v = 0; v < s->vertex_count; v++) {
    if (p->best[v] == SCREE_NONE) continue;
    uint32_t key = key_of(p->cost[v]);
    if (key <= limit) p->items[p->item_count++] = (item){key, (uint32_t)v};
  }
  sort_items(p);
  return SCREE_OK;
}

/* Whether ring r is independent of those taken; if so marks it. */
static bool take(pass *p, const scree_ring *r) {
  const scree_halfmesh *s = &p->d->s;
  uint8_t *marks = p->marks;
  if (marks[r->c] & APEX || (r->d != SCREE_NONE && marks[r->d] & APEX)) return false;
  for (uint32_t i = 0; i < r->count; i++) {
    uint32_t beyond = s->twin[r->edge[i]];
    if (beyond != SCREE_NONE && marks[s->from[scree_previous(beyond)]] & ENDPOINT) return false;
  }
  for (uint32_t i = 0; i < r->count; i++) {
    marks[s->from[r->edge[i]]] |= TOUCHED;
    marks[scree_to(s, r->edge[i])] |= TOUCHED;
  }
  marks[r->a] |= TOUCHED | ENDPOINT;
  marks[r->b] |= TOUCHED | ENDPOINT;
  marks[r->c] |= TOUCHED | APEX;
  if (r->d != SCREE_NONE) marks[r->d] |= TOUCHED | APEX;
  return true;
}

static void choose_independent(pass *p) {
  scree_halfmesh *s = &p->d->s;
  size_t room = taken_room(s->vertex_count);
  memset(p->marks, 0, s->vertex_count);
  p->taken_count = 0;
  for (size_t i = 0; i < p->item_count && p->taken_count < room; i++) {
    uint32_t v = p->items[i].vertex, h = p->best[v];
    if ((p->marks[v] | p->marks[scree_to(s, h)]) & TOUCHED) continue;
    scree_ring ring;
    if (!scree_ring_gather(s, h, &ring) || !scree_collapse_keeps_topology(s, &ring)) {
      s->refused[h] = 1;
      continue;
    }
    if (take(p, &ring)) p->taken[p->taken_count++] = h;
  }
}

static void check_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_decimator *d = p->d;
  for (size_t i = begin; i < end; i++) {
    scree_ring ring;
    scree_candidate candidate;
    scree_ring_gather(&d->s, p->taken[i], &ring);
    d->coster->evaluate(&d->s, p->taken[i], &candidate);
    p->changes[i].target = candidate.target;
    p->errors[i] = (float)candidate.error;
    bool sound = scree_collapse_check(&d->s, &ring, &p->changes[i]);
    p->verdicts[i] = sound ? UNCERTAIN : REFUSED;
    if (sound) scree_grid_enter_ring(&d->grid, &d->s, &ring, candidate.target);
  }
}

/* The ring again, with its box. */
static void gather_with_box(const scree_halfmesh *s, uint32_t h, vec3 target, scree_ring *r) {
  scree_ring_gather(s, h, r);
  r->low = vec3_min(target, vec3_min(s->position[r->a], s->position[r->b]));
  r->high = vec3_max(target, vec3_max(s->position[r->a], s->position[r->b]));
  for (uint32_t i = 0; i < r->count; i++) {
    vec3 p = s->position[s->from[r->edge[i]]], q = s->position[scree_to(s, r->edge[i])];
    r->low = vec3_min(r->low, vec3_min(p, q));
    r->high = vec3_max(r->high, vec3_max(p, q));
  }
}

static void certify_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_decimator *d = p->d;
  for (size_t i = begin; i < end; i++) {
    if (p->verdicts[i] == REFUSED) continue;
    scree_ring ring;
    gather_with_box(&d->s, p->taken[i], p->changes[i].target, &ring);
    if (scree_grid_certifies(&d->grid, &ring)) p->verdicts[i] = CERTAIN;
  }
}

static void search_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_decimator *d = p->d;
  scree_planned planned = {p->chosen, p->changes};
  for (size_t k = begin; k < end; k++) {
    uint32_t i = p->uncertain[k];
    scree_ring ring;
    gather_with_box(&d->s, p->taken[i], p->changes[i].target, &ring);
    p->verdicts[i] = scree_grid_clear(&d->grid, &d->s, &ring, p->changes[i].target, &planned)
                         ? CERTAIN
                         : REFUSED;
  }
}

/* Exact tests for those that the directions did not settle. */
static scree_status search_uncertain(pass *p) {
  scree_decimator *d = p->d;
  size_t n = d->s.vertex_count;
  p->uncertain_count = 0;
  for (size_t i = 0; i < p->taken_count; i++)
    p->uncertain_count += d->s.closed ? p->verdicts[i] == UNCERTAIN : p->verdicts[i] != REFUSED;
  if (p->uncertain_count == 0) return SCREE_OK;
  SCREE_ALLOC_OR(p->uncertain, p->uncertain_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(p->chosen, n, d->error, out_of_memory);
  memset(p->chosen, 0xff, n * sizeof *p->chosen);
  p->uncertain_count = 0;
  for (uint32_t i = 0; i < p->taken_count; i++) {
    if (p->verdicts[i] == REFUSED) continue;
    p->chosen[d->s.from[p->taken[i]]] = p->chosen[scree_to(&d->s, p->taken[i])] = i;
    if (d->s.closed && p->verdicts[i] == CERTAIN) continue;
    scree_ring ring;
    gather_with_box(&d->s, p->taken[i], p->changes[i].target, &ring);
    scree_grid_mark(&d->grid, ring.low, ring.high);
    p->uncertain[p->uncertain_count++] = i;
  }
  scree_planned planned = {p->chosen, p->changes};
  if (!scree_grid_list_all(&d->grid, &d->s, &planned, true)) {
    scree_fail_memory(d->error, d->grid.capacity * sizeof *d->grid.items, "grid lists");
    goto out_of_memory;
  }
  scree_parallel_for(p->uncertain_count, CHOSEN_BLOCK, search_block, p);
  memset(d->grid.head, 0xff, d->grid.cell_count * sizeof *d->grid.head);
  d->grid.count = d->grid.large_count = 0;
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static void apply_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  pass *p = context;
  scree_decimator *d = p->d;
  for (size_t i = begin; i < end; i++) {
    scree_ring ring;
    if (p->verdicts[i] != CERTAIN) continue;
    scree_ring_gather(&d->s, p->taken[i], &ring);
    scree_collapse_apply(&d->s, &ring, p->changes[i].target);
    if (d->coster->merge) d->coster->merge(&d->s, ring.a, ring.b);
    __atomic_fetch_or(&d->s.flags[ring.a], SCREE_VERTEX_DIRTY, __ATOMIC_RELAXED);
    for (uint32_t k = 0; k < ring.count; k++) {
      __atomic_fetch_or(&d->s.flags[d->s.from[ring.edge[k]]], SCREE_VERTEX_DIRTY, __ATOMIC_RELAXED);
      __atomic_fetch_or(&d->s.flags[scree_to(&d->s, ring.edge[k])], SCREE_VERTEX_DIRTY,
                        __ATOMIC_RELAXED);
    }
  }
}

/* Writes the record in the order of cost, then does it all. Returns how many. */
static size_t apply(pass *p) {
  scree_decimator *d = p->d;
  size_t before = d->record.count;
  for (size_t i = 0; i < p->taken_count; i++) {
    uint32_t h = p->taken[i], twin = d->s.twin[h];
    if (p->verdicts[i] != CERTAIN) {
      d->s.refused[h] = 1;
      continue;
    }
    scree_ring ends = {.half_edge = h, .a = d->s.from[h], .b = scree_to(&d->s, h)};
    scree_record_add(d, &ends, &p->changes[i], p->errors[i]);
    d->s.live_vertex_count--;
    d->s.live_triangle_count -= twin == SCREE_NONE ? 1 : 2;
  }
  for (size_t v = 0; v < d->s.vertex_count; v++) d->s.flags[v] &= (uint8_t)~SCREE_VERTEX_DIRTY;
  scree_parallel_for(p->taken_count, CHOSEN_BLOCK, apply_block, p);
  return d->record.count - before;
}

static scree_status prepare_grid(scree_decimator *d) {
  if (d->grid.built_for &&
      (double)d->s.live_triangle_count > REGRID_BELOW * (double)d->grid.built_for)
    return SCREE_OK;
  scree_status status = scree_grid_shape(&d->grid, &d->s, EDGES_PER_CELL, d->error);
  if (status == SCREE_OK) scree_grid_enter_directions(&d->grid, &d->s);
  return status;
}

static scree_status run_pass(scree_decimator *d, size_t *done) {
  pass p = {.d = d};
  scree_status status = pass_allocate(&p);
  if (status == SCREE_OK) status = prepare_grid(d);
  if (status != SCREE_OK) goto finished;
  if (!d->coster->merge) scree_parallel_for(d->s.vertex_count, VERTEX_BLOCK, sum_block, &p);
  scree_parallel_for(d->s.vertex_count, VERTEX_BLOCK, evaluate_block, &p);
  status = order_candidates(&p);
  if (status != SCREE_OK) goto finished;
  choose_independent(&p);
  scree_parallel_for(p.taken_count, CHOSEN_BLOCK, check_block, &p);
  if (d->s.closed) scree_parallel_for(p.taken_count, CHOSEN_BLOCK, certify_block, &p);
  status = search_uncertain(&p);
  if (status != SCREE_OK) goto finished;
  *done = apply(&p);
  if ((double)d->s.live_triangle_count < COMPACT_BELOW * (double)d->s.triangle_count)
    scree_halfmesh_compact(&d->s, (uint32_t *)p.items, (uint32_t *)p.swap);
finished:
  pass_free(&p);
  return status;
}

scree_status scree_decimate_in_batches(scree_decimator *d) {
  size_t done = 1;
  while (done > 0 && d->s.live_triangle_count > SCREE_GREEDY_COUNT &&
         d->s.live_triangle_count > d->options.stop_count) {
    if (!scree_decimate_tick(d)) return SCREE_CANCELLED;
    scree_status status = run_pass(d, &done);
    if (status != SCREE_OK) return status;
  }
  return SCREE_OK;
}
