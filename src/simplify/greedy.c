/* One by one: the coarse levels, always the cheapest collapse next. A binary
 * heap holds every edge by its owner half-edge; after a collapse the edges
 * whose cost it changed are moved in place, so that no entry is ever stale or
 * missing. Equal costs are ordered by the vertices' numbers in the mesh given.
 * Where the best place is refused, the cheapest allowed of a few others takes
 * its turn at its own cost; an edge without any leaves the heap until something
 * around it changes.
 *
 * Costs that count the stray (cost.h) come in two steps, for it is dear to find: the edge waits at
 * its cost without, which is not above the whole one, and when its turn comes, it waits again at
 * the whole cost.
 *
 * The stray costs a toll, C (D / F)^6, beside what cost.h has, which counts it against the size of
 * the triangles and so lets the rounded edges of a large body pass. C is the cost that a tenth of
 * the edges do not exceed, and F is scree_memory_usual, or the largest distance of a witness, if
 * that is more. Since both grow as triangles go, they are
 * found anew whenever the triangles have come down to 0.7 of what they were; all edges are
 * looked at once more then. While no witness is off there is no toll.
 *
 * The whole cost of another place, where the best strays, may be less: the cheapest of the best and
 * the few others is the edge's first choice.
 *
 * First choices are most of the work. With several threads, when one is asked for, those of the
 * next edges in the heap are found beside it, each by itself. It is forgotten where something
 * changes around the edge before its turn comes; so the outcome is that of one thread.
 *
 * Below SCREE_RELAXED_COUNT triangles the vertices about a collapse move after it, to where the
 * witnesses around them are nearer (step.c), and below SCREE_PATH_COUNT, at every tenth that goes,
 * all of them together (settle.h), until the look ahead begins. Below SCREE_AHEAD_COUNT not the
 * cheapest collapse is done, but of the cheapest that are allowed the one after which the level is
 * best (ahead.h). What comes in which order, and that the end is come to by several ways, is
 * ending.c's.
 *
 * Few triangles and a volume that is to be kept can throw a vertex far out: where the normals
 * around nearly cancel (a thin part, a handle) the plane of equal volume is far away, and small
 * triangles make it cheap to go there. So a vertex must stay near the surface that this stage
 * began with: within half of sqrt(area / triangles), the size of the level's triangles. */
#include "simplify/greedy.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "simplify/settle.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* How far an edge's whole cost is looked at, in units of that at which it waits. */
#define LOOKED_UP_TO 8.0

/* The toll (see above): the rank of C among all edges; the share of triangles left at which it is
 * found anew. */
#define TOLL_RANK   0.1
#define RENEW_BELOW 0.7
/* ... and where the surface settles then: at Rp = 10^(-n / 18), which are the levels of the usual
 * grid, nine a decade, and one between each two. */
#define SETTLE_EACH 0.8799225435691069
/* ... of the scan's triangles, and so much more of them: 1e-3 of 762,000 is 762, however it rounds.
 */
#define ROUNDING 1e-9

/* Of the toll of close scans: while they are held close, and below so many triangles. */
#define CLOSE_TOLL 8.0
#define EASY_TOLL  0.05
enum { EASY_BELOW = 900 };

/* Edges evaluated in one call. */
enum { SIDE_BY_SIDE = 32 };

/* An edge waits at part of its best place's cost, where the first choice may be known already (to
 * entry k of those known); then at the whole cost of its first choice: the best place, or other
 * place k; where that is refused, at that of fallback k. */
enum {
  IN_PART,
  WHOLE,
  OTHER,
  FALLBACK = OTHER + SCREE_FALLBACK_COUNT,
  KNOWN = FALLBACK + SCREE_FALLBACK_COUNT
};

/* First choices found at once by each worker: of more, many would be forgotten before their turn,
 * and of one, the workers would wait for each other; at once, at most; kept; edges of the heap
 * looked at for them. */
enum { FOR_EACH = 2, AT_ONCE = 8, KEPT = 64, LOOKED_AT = 24 };

typedef struct choice {
  uint32_t half_edge;
  uint8_t stage;
  bool possible; /* else the edge leaves the heap */
  scree_candidate candidate;
} choice;

struct scree_greedy {
  scree_decimator *d;
  double *cost;    /* per half-edge */
  uint32_t *place; /* per half-edge: its place in the heap, or NONE */
  uint32_t *heap;  /* half-edges */
  size_t heap_count;
  uint8_t *stage; /* per half-edge: how far it has come */
  scree_step step;
  size_t since_tick;
  size_t begun_at;                /* collapses */
  size_t entered_at;              /* collapses when all edges were entered last */
  double toll;                    /* weight of the stray's sixth power in the cost */
  uint32_t places;                /* looked at on every new edge; found anew with the toll */
  size_t renew_at;                /* triangles */
  bool settles;                   /* the surface does, where its vertices move */
  scree_settled settled;          /* room for that, from then on */
  double *sorted;                 /* scratch: costs */
  uint32_t waiting[SIDE_BY_SIDE]; /* half-edges to be evaluated */
  size_t waiting_count;
  choice known[KEPT];
  size_t known_next;
  scree_offer *offers; /* SCREE_OFFER_COUNT */
};

static bool before(const scree_greedy *q, uint32_t g, uint32_t h) {
  if (q->cost[g] != q->cost[h]) return q->cost[g] < q->cost[h];
  const scree_halfmesh *s = &q->d->s;
  uint32_t ga = s->vertex[s->half[g].from].origin, ha = s->vertex[s->half[h].from].origin;
  if (ga != ha) return ga < ha;
  return s->vertex[scree_to(s, g)].origin < s->vertex[scree_to(s, h)].origin;
}

static void put(scree_greedy *q, size_t place, uint32_t h) {
  q->heap[place] = h;
  q->place[h] = (uint32_t)place;
}

static void sift_up(scree_greedy *q, size_t place) {
  uint32_t h = q->heap[place];
  while (place > 0 && before(q, h, q->heap[(place - 1) / 2])) {
    put(q, place, q->heap[(place - 1) / 2]);
    place = (place - 1) / 2;
  }
  put(q, place, h);
}

static void sift_down(scree_greedy *q, size_t place) {
  uint32_t h = q->heap[place];
  for (;;) {
    size_t child = 2 * place + 1;
    if (child >= q->heap_count) break;
    if (child + 1 < q->heap_count && before(q, q->heap[child + 1], q->heap[child])) child++;
    if (!before(q, q->heap[child], h)) break;
    put(q, place, q->heap[child]);
    place = child;
  }
  put(q, place, h);
}

static void leave(scree_greedy *q, uint32_t h) {
  uint32_t place = q->place[h];
  if (place == SCREE_NONE) return;
  q->place[h] = SCREE_NONE;
  uint32_t last = q->heap[--q->heap_count];
  if (last == h) return;
  put(q, place, last);
  sift_up(q, place);
  sift_down(q, q->place[last]);
}

/* An edge is known by the half-edge of its lower end, or its only one. */
static uint32_t owner(const scree_halfmesh *s, uint32_t h) {
  uint32_t twin = s->half[h].twin;
  return twin != SCREE_NONE && scree_to(s, h) < s->half[h].from ? twin : h;
}

/* Gives edge h its place in the heap by this candidate, or takes it out. */
static void enqueue(scree_greedy *q, uint32_t h, const scree_candidate *candidate) {
  if (!(candidate->cost < INFINITY) || candidate->error > q->d->error_limit) {
    leave(q, h);
    return;
  }
  q->cost[h] = candidate->cost;
  if (q->place[h] == SCREE_NONE) put(q, q->heap_count++, h);
  sift_up(q, q->place[h]);
  sift_down(q, q->place[h]);
}

/* Gives edge h, which left, its place at the cost that it has. */
static void enter(scree_greedy *q, uint32_t h) {
  put(q, q->heap_count++, h);
  sift_up(q, q->place[h]);
}

/* Gives those waiting their places. */
static void evaluate_waiting(scree_greedy *q) {
  scree_halfmesh *s = &q->d->s;
  scree_candidate candidates[SIDE_BY_SIDE];
  q->d->coster->evaluate(s, q->waiting, q->waiting_count, candidates);
  for (size_t i = 0; i < q->waiting_count; i++) {
    uint32_t h = q->waiting[i];
    if ((s->flags[s->half[h].from] | s->flags[scree_to(s, h)]) & SCREE_VERTEX_LOCKED)
      candidates[i].cost = INFINITY;
    else if (q->d->coster->shape)
      q->d->coster->shape(s, h, INFINITY, &candidates[i]);
    q->stage[h] = candidates[i].stray > 0 ? IN_PART : WHOLE;
    enqueue(q, h, &candidates[i]);
  }
  q->waiting_count = 0;
}

static void evaluate(scree_greedy *q, uint32_t h) {
  q->waiting[q->waiting_count++] = h;
  if (q->waiting_count == SIDE_BY_SIDE) evaluate_waiting(q);
}

void scree_greedy_free(scree_greedy *q) {
  if (!q) return;
  scree_free(q->cost);
  scree_free(q->place);
  scree_free(q->heap);
  scree_free(q->stage);
  scree_free(q->step.stamp);
  scree_free(q->step.touched);
  scree_free(q->sorted);
  scree_free(q->offers);
  scree_settled_free(&q->settled);
  scree_free(q);
}

static void enter_all(scree_greedy *q) {
  const scree_halfmesh *s = &q->d->s;
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++)
    if (s->half[h].from != SCREE_NONE && owner(s, h) == h) evaluate(q, h);
  evaluate_waiting(q);
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static bool looks_ahead(const scree_decimator *d) {
  return d->s.live_triangle_count <= scree_ahead_from(d);
}

/* Times the toll. Scans held close in their fine levels have room in the greatest distance of
 * coarser ones, until those look ahead. */
static double toll_factor(const scree_decimator *d) {
  if (scree_is_held_close(d)) return CLOSE_TOLL;
  bool easy = scree_is_close_scan(d) && d->s.live_triangle_count < EASY_BELOW && !looks_ahead(d);
  return (easy ? EASY_TOLL : 1) * scree_rule_of(d).toll;
}

static void sum_all(const scree_greedy *q) {
  scree_halfmesh *s = &q->d->s;
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE) q->d->coster->sum(s, v);
}

static size_t settles_below(const scree_decimator *d) {
  return scree_is_large(d) ? SCREE_PATH_LATE : SCREE_PATH_COUNT;
}

static bool may_settle(const scree_greedy *q) {
  const scree_decimator *d = q->d;
  return q->settles && d->record.count > q->begun_at && d->s.live_triangle_count < settles_below(d);
}

/* Closes the gaps that collapses left, before edges are entered anew: to settle looks at all
 * triangles many times. */
static scree_status compact(scree_greedy *q) {
  scree_decimator *d = q->d;
  scree_halfmesh *s = &d->s;
  size_t half_edges = 3 * s->triangle_count;
  q->heap_count = q->known_next = 0;
  scree_memory_compact(&d->memory, s);
  scree_joint_compact(&q->settled.joint, s);
  scree_halfmesh_compact(s, q->place, q->heap);
  memset(q->place, 0xff, half_edges * sizeof *q->place);
  memset(q->stage, IN_PART, half_edges);
  memset(q->step.stamp, 0, s->vertex_count * sizeof *q->step.stamp);
  d->grid.built_for = 0; /* it has the old numbers */
  return scree_anchors_find(s, &d->anchors, d->error);
}

static scree_status settle(scree_greedy *q) {
  scree_status status = compact(q);
  if (status == SCREE_OK && !q->settled.places)
    status = scree_settled_allocate(&q->settled, q->d, q->d->error);
  if (status == SCREE_OK) status = scree_settle_path(&q->settled, &q->step);
  sum_all(q);
  return status;
}

/* At how many triangles edges are entered anew. */
static size_t next_renewal(const scree_greedy *q) {
  const scree_decimator *d = q->d;
  size_t count = d->s.live_triangle_count, from = settles_below(d);
  size_t at = (size_t)(RENEW_BELOW * (double)count);
  double level = (1 + ROUNDING) * (double)d->first_triangle_count;
  if (!q->settles || at >= from) return at;
  while (level >= 1 && ((size_t)level >= count || level >= (double)from)) level *= SETTLE_EACH;
  return (size_t)fmax((double)at, level);
}

/* Witnesses for a triangle above which they are thinned. */
static size_t crowd(const scree_decimator *d) {
  if (!scree_is_large(d)) return SCREE_CROWD;
  if (looks_ahead(d)) return SCREE_CROWD_SPREAD;
  return d->s.live_triangle_count < SCREE_PATH_LATE ? SCREE_CROWD : SCREE_CROWD_OF_LARGE;
}

static size_t least_witnesses(const scree_decimator *d) {
  return scree_is_close_scan(d) ? SCREE_LEAST_OF_CLOSE : SCREE_LEAST_WITNESSES;
}

/* Settles, enters all edges and finds the toll. */
static scree_status renew(scree_greedy *q) {
  scree_decimator *d = q->d;
  if (may_settle(q)) {
    scree_status status = settle(q);
    if (status != SCREE_OK) return status;
  }
  q->places = scree_is_held_close(d) ? SCREE_MOST_EDGE_PLACES : SCREE_EDGE_PLACES;
  enter_all(q);
  if (d->coster->merge || q->heap_count == 0) return SCREE_OK;
  for (size_t i = 0; i < q->heap_count; i++) q->sorted[i] = q->cost[q->heap[i]];
  qsort(q->sorted, q->heap_count, sizeof *q->sorted, by_value);
  double cost = q->sorted[(size_t)(TOLL_RANK * (double)q->heap_count)];
  scree_memory_thin(&d->memory, &d->s, crowd(d), least_witnesses(d));
  double far = scree_memory_usual(&d->memory, scree_is_held_close(d));
  if (far > 0) far = fmax(far, scree_memory_worst(&d->memory));
  q->toll = far > 0 ? toll_factor(d) * cost / pow(far, 6) : 0;
  q->renew_at = next_renewal(q);
  return scree_memory_squeeze(&d->memory, &d->s, d->error);
}

static scree_status queue_fill(scree_greedy *q) {
  scree_decimator *d = q->d;
  scree_halfmesh *s = &d->s;
  size_t half_edges = 3 * s->triangle_count;
  SCREE_ALLOC_OR(q->cost, half_edges, d->error, out_of_memory);
  SCREE_ALLOC_OR(q->place, half_edges, d->error, out_of_memory);
  SCREE_ALLOC_OR(q->heap, half_edges, d->error, out_of_memory);
  SCREE_ALLOC_OR(q->stage, half_edges, d->error, out_of_memory);
  SCREE_ALLOC_OR(q->step.stamp, s->vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(q->step.touched, s->vertex_count, d->error, out_of_memory);
  SCREE_ALLOC_OR(q->sorted, half_edges, d->error, out_of_memory);
  SCREE_ALLOC_OR(q->offers, SCREE_OFFER_COUNT, d->error, out_of_memory);
  memset(q->place, 0xff, half_edges * sizeof *q->place);
  memset(q->stage, IN_PART, half_edges);
  memset(q->step.stamp, 0, s->vertex_count * sizeof *q->step.stamp);
  if (!d->coster->merge) sum_all(q);
  scree_status status = SCREE_OK;
  if (!scree_memory_is_kept(&d->memory)) status = scree_decimate_keep(d);
  if (status == SCREE_OK) status = renew(q);
  return status;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

/* Takes the ring's edges that vanish or change owner out of the heap. */
static void forget(scree_greedy *q, const scree_ring *r) {
  const scree_halfmesh *s = &q->d->s;
  uint32_t ends[2] = {r->a, r->b};
  for (int i = 0; i < 2; i++) {
    uint32_t first = s->vertex[ends[i]].outgoing, h = first, last;
    do {
      leave(q, owner(s, h));
      last = h;
      h = scree_turn(s, h);
    } while (h != SCREE_NONE && h != first);
    if (h == SCREE_NONE) leave(q, scree_previous(last));
  }
}

/* Re-evaluates all edges at the vertices stamped now, once each. */
static void update_vertex(scree_greedy *q, uint32_t v) {
  scree_halfmesh *s = &q->d->s;
  uint32_t first = s->vertex[v].outgoing, h = first, last;
  do {
    uint32_t other = scree_to(s, h);
    if (q->step.stamp[other] != q->step.now || other > v) evaluate(q, owner(s, h));
    last = h;
    h = scree_turn(s, h);
  } while (h != SCREE_NONE && h != first);
  if (h == SCREE_NONE) {
    uint32_t incoming = scree_previous(last), other = s->half[incoming].from;
    if (q->step.stamp[other] != q->step.now || other > v) evaluate(q, incoming);
  }
}

/* After a collapse: all edges that it may concern get their places anew. */
static void update(scree_greedy *q) {
  const scree_step *step = &q->step;
  if (!q->d->coster->merge)
    for (size_t i = 0; i < step->touched_count; i++) q->d->coster->sum(&q->d->s, step->touched[i]);
  for (size_t i = 0; i < step->touched_count; i++) update_vertex(q, step->touched[i]);
  evaluate_waiting(q);
}

/* Makes the cost whole, or at least `most` and not above the whole one if it is not. */
static void add_stray(const scree_greedy *q, const scree_ring *ring, scree_candidate *c,
                      double most, scree_hints *hints) {
  if (!(c->stray > 0) || !(c->cost < most)) return;
  double least = scree_stray_at(c, 0), enough = sqrt((most - c->cost) / c->stray);
  if (q->toll > 0) {
    least = fmin(least, cbrt(SCREE_STRAY_SHARE * c->cost / q->toll));
    enough = fmin(enough, cbrt((most - c->cost) / q->toll));
  }
  double stray2 =
      scree_memory_stray(&q->d->memory, &q->d->s, ring, c->target, q->places, least, enough, hints);
  c->cost += (c->stray + q->toll * stray2) * stray2 * stray2;
}

/* The places that an edge's vertex may get: the best and the few others. */
enum { PLACES = 1 + SCREE_FALLBACK_COUNT };

/* Whether the new triangles may be sound at some of them. */
static bool may_collapse(const scree_greedy *q, scree_ring *ring, const scree_candidate *places) {
  for (int k = 0; k < PLACES; k++)
    if (places[k].cost < INFINITY && scree_step_may_be_sound(&q->step, ring, places[k].target))
      return true;
  return false;
}

/* Finds the first choice of an edge: its whole cost, or what is known to be no more than that,
 * where it is beyond LOOKED_UP_TO times the cost at which the edge waits: most edges are evaluated
 * anew before their turn comes at that. */
static void find_first_choice(const scree_greedy *q, choice *made) {
  const scree_halfmesh *s = &q->d->s;
  uint32_t h = made->half_edge, edges[SCREE_RING_MAX];
  scree_ring ring = {.edge = edges};
  scree_candidate *best = &made->candidate;
  made->possible = scree_ring_gather(s, h, &ring) && scree_collapse_keeps_topology(s, &ring);
  if (!made->possible) return;
  /* a share of nothing would be no more */
  double most = q->cost[h] > DBL_MIN ? LOOKED_UP_TO * q->cost[h] : INFINITY;
  scree_candidate places[PLACES];
  q->d->coster->evaluate(s, &h, 1, &places[0]);
  for (int k = 0; k < SCREE_FALLBACK_COUNT; k++) q->d->coster->fall_back(s, h, k, &places[1 + k]);
  made->possible = may_collapse(q, &ring, places);
  if (!made->possible) return;
  scree_hints hints;
  scree_no_hints(&hints);
  made->stage = WHOLE;
  *best = places[0];
  add_stray(q, &ring, best, most, &hints);
  for (int k = 0; k < SCREE_FALLBACK_COUNT; k++) {
    scree_candidate *c = &places[1 + k];
    add_stray(q, &ring, c, fmin(best->cost, most), &hints);
    if (!(c->cost < best->cost)) continue;
    *best = *c;
    made->stage = (uint8_t)(OTHER + k);
  }
  if (!(best->cost < most)) made->stage = IN_PART;
}

static void find_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_greedy *q = context;
  for (size_t i = begin; i < end; i++) find_first_choice(q, &q->known[q->known_next + i]);
}

/* Lists edges that wait for their first choice, in their order: the cheapest, and others that come
 * soon. */
static size_t list_next(const scree_greedy *q, size_t most, uint32_t *edges) {
  size_t places[2 * LOOKED_AT + 1] = {0}, place_count = q->heap_count > 0, count = 0;
  for (int looked = 0; looked < LOOKED_AT && place_count > 0 && count < most; looked++) {
    size_t least = 0;
    for (size_t i = 1; i < place_count; i++)
      if (before(q, q->heap[places[i]], q->heap[places[least]])) least = i;
    size_t place = places[least], child = 2 * place + 1;
    places[least] = places[--place_count];
    if (q->stage[q->heap[place]] == IN_PART) edges[count++] = q->heap[place];
    if (child < q->heap_count) places[place_count++] = child;
    if (child + 1 < q->heap_count) places[place_count++] = child + 1;
  }
  return count;
}

/* Finds the first choice of the cheapest edge, and of some that come soon. */
static void find_first_choices(scree_greedy *q) {
  uint32_t edges[AT_ONCE] = {q->heap[0]};
  size_t workers = (size_t)scree_worker_count(), most = FOR_EACH * workers;
  size_t count = workers > 1 ? list_next(q, most < AT_ONCE ? most : AT_ONCE, edges) : 1;
  if (q->known_next + count > KEPT) q->known_next = 0;
  for (size_t i = 0; i < count; i++) {
    choice *made = &q->known[q->known_next + i];
    uint8_t stage = (uint8_t)(KNOWN + q->known_next + i);
    if (made->half_edge != edges[i] && q->stage[made->half_edge] == stage)
      q->stage[made->half_edge] = IN_PART; /* its entry is needed */
    made->half_edge = edges[i];
    q->stage[edges[i]] = stage;
  }
  scree_parallel_for(count, 1, find_block, q);
  q->known_next += count;
}

/* Puts the edge back with the cheapest other place that is allowed, if there is
 * one. */
static scree_status try_fallbacks(scree_greedy *q, scree_ring *ring) {
  uint32_t h = ring->half_edge;
  scree_candidate best = {.cost = INFINITY};
  scree_hints hints;
  scree_status status = SCREE_OK;
  scree_no_hints(&hints);
  for (int k = 0; k < SCREE_FALLBACK_COUNT && status == SCREE_OK; k++) {
    scree_change change;
    scree_around around;
    scree_candidate c;
    q->d->coster->fall_back(&q->d->s, h, k, &c);
    change.target = c.target;
    if (!(c.cost < best.cost) || !scree_step_is_sound(&q->step, ring, &change, &around)) continue;
    add_stray(q, ring, &c, best.cost, &hints); /* the dearest part */
    if (!(c.cost < best.cost) || !scree_step_is_clear(&q->step, ring, &change, &around, &status))
      continue;
    best = c;
    q->stage[h] = (uint8_t)(FALLBACK + k);
  }
  if (best.cost < INFINITY) enqueue(q, h, &best);
  return status;
}

/* The cheapest edge has its turn: its collapse is offered where it is allowed, else the edge is put
 * back, or out. */
static scree_status try_cheapest(scree_greedy *q, scree_offer *offer, bool *offered) {
  scree_decimator *d = q->d;
  uint32_t h = q->heap[0];
  scree_ring *ring = &offer->ring;
  scree_candidate candidate;
  scree_status status = SCREE_OK;
  *offered = false;
  if (q->stage[h] == IN_PART) find_first_choices(q);
  int stage = q->stage[h];
  leave(q, h);
  if (stage >= KNOWN) {
    const choice *known = &q->known[stage - KNOWN];
    if (!known->possible) return SCREE_OK;
    q->stage[h] = known->stage;
    enqueue(q, h, &known->candidate);
    return SCREE_OK;
  }
  ring->edge = offer->edges;
  if (!scree_ring_gather(&d->s, h, ring) || !scree_collapse_keeps_topology(&d->s, ring))
    return SCREE_OK;
  if (stage >= OTHER)
    d->coster->fall_back(&d->s, h, (stage - OTHER) % SCREE_FALLBACK_COUNT, &candidate);
  else
    d->coster->evaluate(&d->s, &h, 1, &candidate);
  offer->change.target = candidate.target;
  offer->error = candidate.error;
  *offered = scree_step_allows(&q->step, ring, &offer->change, &offer->around, &status);
  if (*offered || status != SCREE_OK || stage >= FALLBACK) return status;
  return try_fallbacks(q, ring);
}

static scree_status collapse_cheapest(scree_greedy *q) {
  bool offered;
  scree_offer *offer = q->offers;
  scree_status status = try_cheapest(q, offer, &offered);
  if (!offered) return status;
  forget(q, &offer->ring);
  status =
      scree_step_collapse(&q->step, &offer->ring, &offer->change, &offer->around, offer->error);
  update(q);
  return status;
}

/* Of the cheapest collapses that are allowed, the one after which the level is best. */
static scree_status collapse_best(scree_greedy *q, scree_ahead *ahead) {
  size_t count = 0;
  bool offered;
  scree_status status = SCREE_OK;
  const size_t most = scree_is_large(q->d) ? SCREE_OFFERS_OF_LARGE : SCREE_OFFER_COUNT;
  while (status == SCREE_OK && count < most && q->heap_count > 0) {
    status = try_cheapest(q, &q->offers[count], &offered);
    count += offered;
  }
  if (status != SCREE_OK || count == 0) return status;
  for (size_t i = 0; i < count; i++) enter(q, q->offers[i].ring.half_edge);
  size_t best = scree_ahead_find(ahead, &q->step, q->offers, count);
  forget(q, &q->offers[best].ring);
  status = scree_ahead_take(ahead, &q->step);
  update(q);
  return status;
}

enum { TICK_EACH = 10000 };

scree_status scree_greedy_run(scree_greedy *q, size_t until, scree_ahead *ahead) {
  scree_decimator *d = q->d;
  scree_status status = SCREE_OK;
  while (status == SCREE_OK && d->s.live_triangle_count > until) {
    if (d->s.live_triangle_count <= q->renew_at) status = renew(q);
    if (status != SCREE_OK) break;
    if (q->heap_count == 0) { /* what was too far off before may be near enough now */
      if (d->record.count == q->entered_at) break;
      q->entered_at = d->record.count;
      enter_all(q);
      if (q->heap_count == 0) break;
    }
    bool coarse = d->s.live_triangle_count < TICK_EACH; /* each takes long there */
    if ((coarse || q->since_tick++ % 1024 == 0) && !scree_decimate_tick(d, &d->ticker))
      return SCREE_CANCELLED;
    status = ahead ? collapse_best(q, ahead) : collapse_cheapest(q);
  }
  return status;
}

scree_status scree_greedy_end(scree_greedy *q) {
  return q->d->s.live_triangle_count <= q->renew_at && may_settle(q) ? settle(q) : SCREE_OK;
}

scree_status scree_greedy_begin(scree_decimator *d, bool settles, scree_greedy **made) {
  scree_greedy *q = *made = scree_alloc_zero(1, sizeof *q);
  if (!q) return scree_fail_memory(d->error, sizeof *q, "the queue of edges");
  q->d = q->step.d = d;
  q->begun_at = q->entered_at = d->record.count;
  q->settles = settles;
  if (!d->coster->merge)
    q->step.relaxed_below = scree_is_large(d) ? SCREE_RELAXED_LATE : SCREE_RELAXED_COUNT;
  q->step.farthest_at = q->step.relaxed_below;
  scree_grid_free(&d->grid);
  scree_status status = scree_anchors_find(&d->s, &d->anchors, d->error);
  return status == SCREE_OK ? queue_fill(q) : status;
}

scree_step *scree_greedy_step(scree_greedy *q) {
  return &q->step;
}
