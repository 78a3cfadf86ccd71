/* One collapse after the other, from a heap of all edges by their costs. An edge waits at its cost
 * without the deviation's part, which is no more than the whole. When its turn comes it is judged;
 * where the whole cost is above the next in the queue, it waits at that. After a collapse the edges
 * about the new vertex get new costs, and edges beside it that could not be done before are looked
 * at again; others are found out when their turn comes. What deviations added to an edge when it
 * was judged changes little by what is done beside it: its new cost has a share of that, so that
 * most are not judged again before their turn is near. */
#include "base/rng.h"
#include "simplify/decimate.h"
#include "simplify/tuning.h"

/* An edge is judged no farther than to so many times the next cost: beyond it waits again. */
#define JUDGED_TO 8
/* Progress is told, and cancelling asked for, after so many collapses. */
enum { TICK_EVERY = 64, SIDE_BY_SIDE = 2 * SCREE_FAN_MAX };

/* Edges are named by their lower half-edge. */
typedef struct queue {
  scree_decimator *d;
  uint32_t *edge;  /* the heap */
  uint32_t *place; /* per half-edge: in the heap, or NONE */
  double *cost;    /* per half-edge */
  double *added;   /* per half-edge: by deviations, when it was last judged */
  bool *known;     /* per half-edge: its cost is the whole, as far as it was judged */
  size_t count;
  scree_gathered scratch;
  scree_fan fan;
} queue;

static uint32_t edge_of(const scree_halfmesh *s, uint32_t h) {
  uint32_t twin = s->half[h].twin;
  return twin < h ? twin : h;
}

/* ---- The heap ---- */

static bool goes_before(const queue *q, uint32_t e, uint32_t f) {
  return q->cost[e] < q->cost[f] || (q->cost[e] == q->cost[f] && e < f);
}

static void put(queue *q, size_t i, uint32_t e) {
  q->edge[i] = e;
  q->place[e] = (uint32_t)i;
}

static void sift(queue *q, size_t i) {
  uint32_t e = q->edge[i];
  for (; i > 0 && goes_before(q, e, q->edge[(i - 1) / 2]); i = (i - 1) / 2)
    put(q, i, q->edge[(i - 1) / 2]);
  for (size_t k; (k = 2 * i + 1) < q->count; i = k) {
    if (k + 1 < q->count && goes_before(q, q->edge[k + 1], q->edge[k])) k++;
    if (!goes_before(q, q->edge[k], e)) break;
    put(q, i, q->edge[k]);
  }
  put(q, i, e);
}

static void drop(queue *q, uint32_t e) {
  size_t i = q->place[e];
  if (i == SCREE_NONE) return;
  q->place[e] = SCREE_NONE;
  uint32_t last = q->edge[--q->count];
  if (last == e) return;
  put(q, i, last);
  sift(q, i);
}

static void set(queue *q, uint32_t e, double cost, bool known) {
  q->cost[e] = cost;
  q->known[e] = known;
  if (cost == INFINITY) {
    drop(q, e);
    return;
  }
  if (q->place[e] == SCREE_NONE) put(q, q->count++, e);
  sift(q, q->place[e]);
}

/* ---- Costs ---- */

/* What the edge waits at: the cost, in all orders but the first shifted. */
static double shifted(const queue *q, uint32_t edge, double cost) {
  if (q->d->order == 0) return cost;
  scree_rng rng = {(uint64_t)q->d->order, edge, q->d->record.count};
  return cost * (1 + scree_tune.shift * scree_rng_uniform(&rng));
}

/* Where a collapse made one edge of two, each half-edge has its own. */
static double added_to(const queue *q, uint32_t edge) {
  uint32_t twin = q->d->s.half[edge].twin;
  return twin == SCREE_NONE ? q->added[edge] : scree_larger(q->added[edge], q->added[twin]);
}

static void set_added(queue *q, uint32_t edge, double added) {
  uint32_t twin = q->d->s.half[edge].twin;
  q->added[edge] = added;
  if (twin != SCREE_NONE) q->added[twin] = added;
}

static void rank(queue *q, const uint32_t *edges, size_t count) {
  scree_candidate c[SIDE_BY_SIDE];
  q->d->coster->evaluate(&q->d->s, edges, count, c);
  for (size_t i = 0; i < count; i++) {
    double added = q->d->expect * added_to(q, edges[i]);
    set(q, edges[i], shifted(q, edges[i], c[i].cost) + added, false);
  }
}

/* Every edge; what is usual is set from their costs. */
static void rank_all(queue *q) {
  const scree_halfmesh *s = &q->d->s;
  uint32_t edges[SIDE_BY_SIDE];
  size_t count = 0;
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
    q->place[h] = SCREE_NONE;
    if (edge_of(s, h) == h) edges[count++] = h;
    if (count == SIDE_BY_SIDE) rank(q, edges, count), count = 0;
  }
  rank(q, edges, count);
}

static scree_status set_usual(queue *q) {
  double *costs;
  SCREE_TRY_ALLOC(costs, q->count, q->d->error);
  for (size_t i = 0; i < q->count; i++) costs[i] = q->cost[q->edge[i]];
  scree_decimate_set_usual(q->d, costs, q->count, 0);
  scree_free(costs);
  return SCREE_OK;
}

static scree_status start(queue *q, scree_decimator *d) {
  size_t half_edges = 3 * d->s.triangle_count;
  *q = (queue){.d = d};
  SCREE_TRY_ALLOC(q->edge, half_edges, d->error);
  SCREE_TRY_ALLOC(q->place, half_edges, d->error);
  SCREE_TRY_ALLOC(q->cost, half_edges, d->error);
  SCREE_TRY_ALLOC_ZERO(q->added, half_edges, d->error);
  SCREE_TRY_ALLOC(q->known, half_edges, d->error);
  rank_all(q);
  return q->count > 0 ? set_usual(q) : SCREE_OK;
}

static void end(queue *q) {
  scree_free(q->edge);
  scree_free(q->place);
  scree_free(q->cost);
  scree_free(q->added);
  scree_free(q->known);
  scree_free(q->scratch.items);
}

/* ---- Collapses ---- */

/* The edges of triangle t leave the queue before it goes. */
static void drop_triangle(queue *q, uint32_t t) {
  for (uint32_t h = 3 * t; h < 3 * t + 3; h++) drop(q, edge_of(&q->d->s, h));
}

/* Every edge of vertex u. */
static void renew_about(queue *q, uint32_t u) {
  const scree_halfmesh *s = &q->d->s;
  uint32_t edges[SIDE_BY_SIDE], first = s->vertex[u].outgoing, h = first, last;
  size_t count = 0;
  if (scree_decimate_is_crowded(s, u)) return;
  do {
    if (count == SIDE_BY_SIDE - 1) rank(q, edges, count), count = 0;
    edges[count++] = edge_of(s, h);
    last = h;
    h = scree_turn(s, h);
  } while (h != first && h != SCREE_NONE);
  if (h == SCREE_NONE) edges[count++] = scree_previous(last);
  rank(q, edges, count);
}

static void renew(queue *q, const scree_fan *f) {
  scree_decimator *d = q->d;
  const scree_halfmesh *s = &d->s;
  scree_decimate_renew(d, f->a);
  for (uint32_t i = 0; i < f->count; i++) {
    scree_decimate_renew(d, s->half[f->edge[i]].from);
    uint32_t j = i + 1 < f->count ? i + 1 : 0;
    if (s->half[f->edge[j]].from != scree_to(s, f->edge[i]))
      scree_decimate_renew(d, scree_to(s, f->edge[i]));
  }
  for (uint32_t i = 0; i < f->count; i++) {
    renew_about(q, s->half[f->edge[i]].from);
    uint32_t j = i + 1 < f->count ? i + 1 : 0;
    if (s->half[f->edge[j]].from != scree_to(s, f->edge[i]))
      renew_about(q, scree_to(s, f->edge[i]));
  }
}

static scree_status collapse(queue *q, double error) {
  scree_decimator *d = q->d;
  const scree_fan *f = &q->fan;
  drop_triangle(q, f->half_edge / 3);
  if (f->d != SCREE_NONE) drop_triangle(q, d->s.half[f->half_edge].twin / 3);
  if (scree_has_samples(&d->samples) && !scree_samples_move(&d->samples, &d->s, f, &q->scratch))
    return scree_fail_memory(d->error, q->scratch.count * sizeof *q->scratch.items, "samples");
  scree_decimate_collapse(d, f, error);
  renew(q, f);
  return SCREE_OK;
}

static double next_cost(const queue *q) {
  double next = INFINITY;
  for (size_t k = 1; k < 3 && k < q->count; k++) next = fmin(next, q->cost[q->edge[k]]);
  return next;
}

/* Collapses the cheapest edge that may be; *found: there was one. */
static scree_status step(queue *q, bool *found) {
  scree_decimator *d = q->d;
  const scree_surroundings around = {&d->s, &d->tree, &d->markers};
  for (*found = false; q->count > 0;) {
    uint32_t e = q->edge[0];
    double next = next_cost(q), was = q->cost[e];
    double most = q->known[e] ? INFINITY : JUDGED_TO * fmax(next, was);
    scree_verdict v = scree_decimate_judge(d, e, most, &q->fan);
    if (v.cost > next && v.cost < INFINITY && !(q->known[e] && v.cost <= was)) {
      set(q, e, v.cost, true);
      set_added(q, e, scree_larger(0, v.cost - v.plain));
    } else if (v.cost < INFINITY && scree_apart(&around, &q->fan)) {
      *found = true;
      return collapse(q, v.error);
    } else {
      drop(q, e);
    }
  }
  return SCREE_OK;
}

scree_status scree_decimate_in_order(scree_decimator *d, size_t *done) {
  SCREE_CLEANUP(end) queue q = {0};
  size_t least = (size_t)(scree_tune.refresh * (double)d->s.live_triangle_count);
  SCREE_TRY(start(&q, d));
  for (*done = 0; d->s.live_triangle_count > d->options.stop_count;) {
    bool found;
    if (*done % TICK_EVERY == 0 && !scree_decimate_tick(d)) return SCREE_CANCELLED;
    SCREE_TRY(step(&q, &found));
    if (!found) break;
    ++*done;
    if (d->s.live_triangle_count <= least) break;
  }
  return SCREE_OK;
}
