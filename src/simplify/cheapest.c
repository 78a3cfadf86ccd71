#include "simplify/cheapest.h"

#include "base/parallel.h"

/* What a pass takes: candidates up to this share of all, if below SPREAD times the cost at the
 * share LOW_SHARE. The threshold rises from pass to pass as in a greedy order, and features wait
 * until what is flat is gone. */
#define HIGH_SHARE 0.6
#define LOW_SHARE  0.3
#define SPREAD     8.0
/* While more than this share of the triangles is left, candidates up to this share. */
#define FINE       0.2
#define FINE_SHARE 0.9

enum { BINS = 1 << 16 };

scree_status scree_cheapest_allocate(scree_cheapest *e, scree_decimator *d) {
  size_t n = d->s.vertex_count;
  *e = (scree_cheapest){.d = d, .s = &d->s};
  SCREE_ALLOC_OR(e->best, n, d->error, out_of_memory);
  SCREE_ALLOC_OR(e->cost, n, d->error, out_of_memory);
  SCREE_ALLOC_OR(e->bins, 4 * BINS, d->error, out_of_memory);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_cheapest_free(scree_cheapest *e) {
  scree_free(e->best);
  scree_free(e->cost);
  scree_free(e->bins);
}

static void sum_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_decimator *d = ((scree_cheapest *)context)->d;
  uint32_t stale[SCREE_PASS_BLOCK], count = 0;
  scree_ask_for_block(&d->s, begin, end);
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

void scree_cheapest_refresh_sums(scree_cheapest *e) {
  if (!e->d->coster->merge)
    scree_parallel_for(e->d->s.vertex_count, SCREE_PASS_BLOCK, sum_block, e);
}

/* Whether the edge between them is looked at from u rather than v: from the larger fan, so that
 * turning the scan, which changes numbers, changes nothing. (From the smaller fan the fine levels'
 * mean distance is 1 to 3 % larger.) */
static bool looks(const scree_halfmesh *s, uint32_t u, uint32_t v) {
  const double *a = scree_sums_of(s, u), *b = scree_sums_of(s, v);
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
  open &= !(s->flags[other] & SCREE_VERTEX_STAYS);
  return s->refused[h] ? open && reopens(s, v, other, h) : open;
}

/* Edges that wait for their evaluation. */
typedef struct waiting {
  uint32_t edge[SCREE_SIDE_BY_SIDE];
  uint32_t count;
} waiting;

/* Takes edge i for its vertex if it is the cheapest so far; of equally cheap ones the first. Of
 * those waiting the one with number *has is what the vertex has, if not lower than `begin`. */
static void take_cheaper(scree_cheapest *e, const waiting *w, uint32_t v, uint32_t i,
                         scree_candidate *c, uint32_t *has) {
  double most = e->cost[v];
  if (!(c->cost < most || (c->cost == most && i < *has)) || !(c->error <= e->d->error_limit))
    return;
  if (e->d->coster->shape) {
    e->d->coster->shape(e->s, w->edge[i], most, c);
    if (!(c->cost < most || (c->cost == most && i < *has))) return;
  }
  e->cost[v] = c->cost;
  e->best[v] = w->edge[i];
  *has = i;
}

static void evaluate_waiting(scree_cheapest *e, waiting *w) {
  const scree_halfmesh *s = e->s;
  scree_candidate candidates[SCREE_SIDE_BY_SIDE];
  e->d->coster->evaluate(s, w->edge, w->count, candidates);
  for (uint32_t begin = 0, end; begin < w->count; begin = end) {
    uint32_t v = s->half[w->edge[begin]].from, likely = begin, has = begin;
    for (end = begin + 1; end < w->count && s->half[w->edge[end]].from == v; end++)
      if (candidates[end].cost < candidates[likely].cost) likely = end;
    take_cheaper(e, w, v, likely, &candidates[likely], &has);
    if (!e->d->coster->shape && candidates[likely].error <= e->d->error_limit) continue;
    for (uint32_t i = begin; i < end; i++) /* few of their shapes matter now */
      if (i != likely) take_cheaper(e, w, v, i, &candidates[i], &has);
  }
  w->count = 0;
}

/* Evaluates the edges that are looked at from v, or has them wait. */
static void look_from(scree_cheapest *e, uint32_t v, waiting *w) {
  scree_halfmesh *s = e->s;
  e->best[v] = SCREE_NONE;
  e->cost[v] = INFINITY;
  if (s->vertex[v].outgoing == SCREE_NONE || s->flags[v] & SCREE_VERTEX_STAYS) return;
  uint32_t first = s->vertex[v].outgoing, h = first;
  do {
    w->edge[w->count] = h;
    w->count += open_to_collapse(s, v, h);
    if (w->count == SCREE_SIDE_BY_SIDE) evaluate_waiting(e, w);
    h = scree_turn(s, h);
  } while (h != SCREE_NONE && h != first);
}

void scree_cheapest_find_of(scree_cheapest *e, const uint32_t *vertices, size_t count) {
  waiting w = {.count = 0};
  for (size_t i = 0; i < count; i++) look_from(e, vertices[i], &w);
  evaluate_waiting(e, &w);
}

static void evaluate_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_cheapest *e = context;
  waiting w = {.count = 0};
  scree_ask_for_block(e->s, begin, end);
  scree_prefetch(e->s->sums[begin], (end - begin) * sizeof *e->s->sums);
  for (size_t v = begin; v < end; v++) look_from(e, (uint32_t)v, &w);
  evaluate_waiting(e, &w);
}

void scree_cheapest_find(scree_cheapest *e) {
  scree_parallel_for(e->d->s.vertex_count, SCREE_PASS_BLOCK, evaluate_block, e);
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
  scree_cheapest *e;
  bool upper;
  uint32_t high[2];
} counting;

static void count_keys(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  const counting *c = context;
  uint32_t *bins = c->e->bins + block * 2 * BINS;
  for (size_t v = begin; v < end; v++) {
    if (!(c->e->cost[v] < INFINITY)) continue;
    uint32_t key = scree_key_of(c->e->cost[v]);
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
  scree_cheapest *e = c->e;
  size_t vertices = e->d->s.vertex_count, used = c->upper ? BINS : 2 * BINS;
  for (size_t half = 0; half < 2; half++)
    memset(e->bins + half * 2 * BINS, 0, used * sizeof *e->bins);
  scree_parallel_for(vertices, vertices / 2 + 1, count_keys, c);
  for (size_t bin = 0; bin < used; bin++) e->bins[bin] += e->bins[2 * BINS + bin];
}

/* The keys of the items at these shares of all that have a cost, and their ranks among those with
 * the same key: the upper halves by one count, the lower ones by another. A coarser answer would
 * depend on the scale of the scan. False: there are none. */
static bool keys_at(scree_cheapest *e, const double share[2], uint32_t key[2], size_t rank[2]) {
  counting c = {.e = e, .upper = true};
  size_t count = 0;
  count_all_keys(&c);
  for (size_t bin = 0; bin < BINS; bin++) count += e->bins[bin];
  for (int i = 0; i < 2; i++) {
    rank[i] = (size_t)(share[i] * (double)count);
    c.high[i] = bin_at(e->bins, &rank[i]);
  }
  c.upper = false;
  count_all_keys(&c);
  for (int i = 0; i < 2; i++)
    key[i] = c.high[i] << 16 | bin_at(e->bins + (size_t)i * BINS, &rank[i]);
  return count > 0;
}

bool scree_is_fine(const scree_decimator *d) {
  return (double)d->s.live_triangle_count > FINE * (double)d->first_triangle_count;
}

/* Of the costs that have this key, the one of this rank; where they are many, the greatest. A limit
 * rounded to a key would depend on the scale of the scan. */
static double cost_at(const scree_cheapest *e, uint32_t key, size_t rank) {
  enum { FEW = 64 };
  double found[FEW], greatest = 0;
  size_t count = 0;
  for (size_t v = 0; v < e->d->s.vertex_count; v++) {
    double cost = e->cost[v];
    if (scree_key_of(cost) != key) continue;
    greatest = fmax(greatest, cost);
    size_t i = count < FEW ? count : FEW - 1;
    for (; i > 0 && found[i - 1] > cost; i--) found[i] = found[i - 1];
    if (i < FEW) found[i] = cost;
    count++;
  }
  return rank < count && count <= FEW ? found[rank] : greatest;
}

bool scree_cheapest_set_limit(scree_cheapest *e) {
  bool fine = scree_is_fine(e->d);
  double share[] = {fine ? FINE_SHARE : HIGH_SHARE, LOW_SHARE};
  uint32_t key[2];
  size_t rank[2];
  if (!keys_at(e, share, key, rank)) return false;
  e->limit = cost_at(e, key[0], rank[0]);
  e->low = cost_at(e, key[1], rank[1]);
  if (!fine) e->limit = fmin(e->limit, SPREAD * e->low);
  return true;
}

void scree_cheapest_renew(scree_cheapest *e, const uint32_t *half_edges, uint32_t count) {
  const scree_halfmesh *s = e->s;
  scree_candidate candidates[SCREE_SIDE_BY_SIDE];
  e->d->coster->evaluate(s, half_edges, count, candidates);
  for (uint32_t i = 0; i < count; i++) {
    if (e->d->coster->shape && candidates[i].cost <= e->limit)
      e->d->coster->shape(s, half_edges[i], e->limit, &candidates[i]);
    e->cost[s->half[half_edges[i]].from] =
        candidates[i].error <= e->d->error_limit ? candidates[i].cost : INFINITY;
  }
}

void scree_refine_order(scree_keyed *items, size_t count,
                        double (*cost)(const void *context, uint32_t index), const void *context) {
  enum { FEW = 16 };
  for (size_t begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count && items[end].key == items[begin].key;) end++;
    if (end - begin > FEW) continue;
    for (size_t i = begin + 1; i < end; i++) {
      scree_keyed moved = items[i];
      double of_moved = cost(context, moved.index);
      size_t j = i;
      for (; j > begin && cost(context, items[j - 1].index) > of_moved; j--)
        items[j] = items[j - 1];
      items[j] = moved;
    }
  }
}
