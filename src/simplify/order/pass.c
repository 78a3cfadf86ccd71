/* Passes over the whole surface, while it is large. A pass finds the cheapest edge of every vertex,
 * side by side, and the cost that a share of them do not exceed. What costs no more is collapsed,
 * about in the order of those costs, if it is allowed and costs no more by then: what was done
 * before it in the pass is seen by all guards, and only the order is that of the surface at the
 * start. A pass takes a fifth of the triangles. */
#include "base/parallel.h"
#include "base/radix.h"
#include "simplify/decimate.h"
#include "simplify/tuning.h"

#include <string.h>

enum { BLOCK = 1024, SIDE_BY_SIDE = 256 }; /* of vertices; edges */
/* Progress is told, and cancelling asked for, after so many edges. */
enum { TICK_EVERY = 4096 };
/* A pass that takes less of the triangles is the last. */
#define LEAST_SHARE 0.02

typedef struct pass {
  scree_decimator *d;
  uint32_t *best; /* per vertex: half-edge of the cheapest of the edges ranked there, or NONE */
  double *cost;   /* of that, or INFINITY */
  double limit;   /* the most for this pass */
  scree_keyed *order, *swap; /* vertices by their costs */
  scree_fan fan;
} pass;

static void pass_free(pass *p) {
  SCREE_FREE_ALL(p->best, p->cost, p->order, p->swap);
}

/* ---- Ranking ---- */

static void renew_block(void *context, scree_block block) {
  scree_decimator *d = context;
  scree_halfmesh *s = &d->s;
  for (size_t v = block.begin; v < block.end; v++) {
    bool is_stale = s->vertex[v].outgoing != SCREE_NONE && s->flags[v] & SCREE_VERTEX_STALE;
    if (is_stale && !d->coster->merge) d->coster->sum(s, (uint32_t)v);
    s->flags[v] &= (uint8_t)~SCREE_VERTEX_STALE;
  }
}

static void renew_all(scree_decimator *d) {
  scree_parallel_for(d->s.vertex_count, BLOCK, renew_block, d);
}

/* Each edge is ranked for one of its ends: where more of the quadric lies, which does not hang on
 * how vertices are numbered. */
static bool is_ranked_here(const scree_halfmesh *s, uint32_t h) {
  uint32_t v = s->half[h].from, w = scree_to(s, h);
  const double *a = s->sums[v], *b = s->sums[w];
  double trace_a = a[0] + a[3] + a[5], trace_b = b[0] + b[3] + b[5];
  return s->half[h].twin == SCREE_NONE || trace_a > trace_b || (trace_a == trace_b && v < w);
}

static void take_best(pass *p, const uint32_t *edges, size_t count) {
  scree_candidate c[SIDE_BY_SIDE];
  const scree_halfmesh *s = &p->d->s;
  p->d->coster->evaluate(s, edges, count, c);
  for (size_t i = 0; i < count; i++) {
    uint32_t v = s->half[edges[i]].from;
    if (c[i].cost < p->cost[v]) p->cost[v] = c[i].cost, p->best[v] = edges[i];
  }
}

static void rank_block(void *context, scree_block block) {
  pass *p = context;
  const scree_halfmesh *s = &p->d->s;
  uint32_t edges[SIDE_BY_SIDE];
  size_t count = 0;
  for (uint32_t v = (uint32_t)block.begin; v < block.end; v++) {
    uint32_t first = s->vertex[v].outgoing, h = first;
    p->cost[v] = INFINITY;
    p->best[v] = SCREE_NONE;
    while (h != SCREE_NONE) {
      if (count == SIDE_BY_SIDE) take_best(p, edges, count), count = 0;
      if (is_ranked_here(s, h)) edges[count++] = h;
      h = scree_turn(s, h);
      if (h == first) break;
    }
  }
  take_best(p, edges, count);
}

/* The limit, and what is usual, from an even sample of the vertices. False: no edge is left. */
static bool set_limit(pass *p) {
  enum { SAMPLE = 4096 };
  double costs[SAMPLE];
  size_t count = 0, n = p->d->s.vertex_count;
  for (size_t v = 0, step = n / SAMPLE + 1; v < n; v += step)
    if (p->best[v] != SCREE_NONE) costs[count++] = p->cost[v];
  if (count == 0) return false;
  p->limit = scree_decimate_set_usual(p->d, costs, count, scree_tune.batch);
  return true;
}

/* The power of two below the cost, as a share of the limit. */
static uint32_t octave_of(const pass *p, double cost) {
  double share = p->limit > 0 ? cost / p->limit : 1;
  uint64_t bits;
  memcpy(&bits, &share, sizeof bits);
  return (uint32_t)(bits >> 52);
}

/* The vertices whose cheapest edge costs no more than the limit, by the octaves of that cost. In an
 * octave they stay in the order of the surface, where neighbours are near in memory. */
static scree_status sort_out(pass *p, size_t *count) {
  size_t n = p->d->s.vertex_count, room = 0;
  for (size_t v = 0; v < n; v++) room += p->cost[v] <= p->limit;
  SCREE_TRY_ALLOC(p->order, room, p->d->error);
  SCREE_TRY_ALLOC(p->swap, room, p->d->error);
  *count = 0;
  for (uint32_t v = 0; v < n; v++)
    if (p->cost[v] <= p->limit) p->order[(*count)++] = (scree_keyed){octave_of(p, p->cost[v]), v};
  scree_keyed *sorted = scree_radix_sort(p->order, p->swap, *count, 11);
  if (sorted != p->order) p->swap = p->order, p->order = sorted;
  return SCREE_OK;
}

/* ---- Collapsing ---- */

static void renew_stale(scree_decimator *d, uint32_t v) {
  if (!(d->s.flags[v] & SCREE_VERTEX_STALE)) return;
  scree_decimate_renew(d, v);
  d->s.flags[v] &= (uint8_t)~SCREE_VERTEX_STALE;
}

static void set_stale(scree_halfmesh *s, const scree_fan *f) {
  s->flags[f->a] |= SCREE_VERTEX_STALE;
  for (uint32_t k = 0; k < f->count; k++) {
    s->flags[s->half[f->edge[k]].from] |= SCREE_VERTEX_STALE;
    s->flags[scree_to(s, f->edge[k])] |= SCREE_VERTEX_STALE;
  }
}

/* Whether half-edge h still goes out from v. */
static bool is_there(const scree_halfmesh *s, uint32_t v, uint32_t h) {
  return s->vertex[v].outgoing != SCREE_NONE && s->half[h].from == v;
}

/* Collapses the vertex's edge if it may be. */
static void try_edge(pass *p, uint32_t v) {
  scree_decimator *d = p->d;
  const scree_surroundings around = {&d->s, &d->tree, &d->markers};
  const uint32_t h = p->best[v];
  if (!is_there(&d->s, v, h)) return;
  renew_stale(d, v);
  renew_stale(d, scree_to(&d->s, h));
  scree_verdict verdict = scree_decimate_judge(d, h, p->limit, &p->fan);
  if (!(verdict.cost <= p->limit) || !scree_apart(&around, &p->fan)) return;
  scree_decimate_collapse(d, &p->fan, verdict.error);
  set_stale(&d->s, &p->fan);
}

static scree_status run_pass(scree_decimator *d, size_t least) {
  SCREE_CLEANUP(pass_free) pass p = {.d = d};
  size_t count;
  SCREE_TRY(scree_decimate_refresh(d));
  SCREE_TRY_ALLOC(p.best, d->s.vertex_count, d->error);
  SCREE_TRY_ALLOC(p.cost, d->s.vertex_count, d->error);
  renew_all(d);
  scree_parallel_for(d->s.vertex_count, BLOCK, rank_block, &p);
  if (!set_limit(&p)) return SCREE_OK;
  SCREE_TRY(sort_out(&p, &count));
  for (size_t i = 0; i < count && d->s.live_triangle_count > least; i++) {
    if (i % TICK_EVERY == 0 && !scree_decimate_tick(d)) return SCREE_CANCELLED;
    try_edge(&p, p.order[i].index);
  }
  return SCREE_OK;
}

scree_status scree_decimate_in_passes(scree_decimator *d, size_t least) {
  if (least < d->options.stop_count) least = d->options.stop_count;
  for (bool more = true; more && d->s.live_triangle_count > least;) {
    const size_t live = d->s.live_triangle_count;
    SCREE_TRY(run_pass(d, least));
    more = (double)(live - d->s.live_triangle_count) > LEAST_SHARE * (double)live;
  }
  renew_all(d);
  return SCREE_OK;
}
