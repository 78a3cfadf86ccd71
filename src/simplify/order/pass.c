/* Passes of many collapses, side by side, with the same bits for any number of threads.
 *
 * A pass finds the cheapest edge of every vertex, and the cost that a share of them do not exceed:
 * what costs no more is a candidate. In each of a few rounds those are taken that are independent:
 * no end of one is an end of another or next to one, and no vertex is apex of both. They are found
 * after Luby ("A simple parallel algorithm for the maximal independent set problem", SIAM J.
 * Comput. 15, 1986): a candidate cheaper than all that it is not independent of is taken. What is
 * taken is judged by the surface as it is and by what cheaper ones of the round will make of it. So
 * whichever of them are done, in any order, the surface is valid, and the record keeps them in the
 * order of cost. What changed is ranked anew for the next round. */
#include "base/parallel.h"
#include "base/radix.h"
#include "simplify/decimate.h"
#include "simplify/tuning.h"

#include <string.h>

enum { ROUNDS = 2, CLAIMS = 8 }; /* rounds of a pass; choices of a round */
enum { BLOCK = 1024, TAKEN_BLOCK = 64, SIDE_BY_SIDE = 256 }; /* of vertices, of collapses; edges */
/* At most a collapse for so many vertices: each keeps its two ends and those about them. */
enum { VERTICES_EACH = 8 };
/* A pass that takes less of the triangles is the last. */
#define LEAST_SHARE 0.02

enum { TAKEN = 1, TOUCHED = 2, APEX = 4, REFUSED = 8 }; /* marks of vertices */

typedef struct taken {
  uint32_t half_edge;
  float error;
  double cost; /* whole */
  bool allowed;
} taken;

typedef struct pass {
  scree_decimator *d;
  uint32_t *best; /* the surface's */
  double *cost;
  uint32_t *leader; /* per vertex: the cheapest candidate that claims it as an end; NONE between
                       choices */
  uint32_t *apex;   /* the same as an apex */
  uint32_t *chosen; /* per vertex: see scree_planned */
  uint8_t *marks;   /* per vertex */
  double limit;     /* the most for this pass */
  bool drawn;       /* candidates go in an order drawn by lot, not by their costs */
  taken *taken, *sorted;        /* the latter: to sort */
  vec3 *target, *sorted_target; /* of those taken */
  size_t taken_count, room;
  uint32_t *candidates;
  size_t candidate_count;
  scree_keyed *order, *swap;
} pass;

static void pass_free(pass *p) {
  SCREE_FREE_ALL(p->apex, p->leader, p->chosen, p->marks, p->taken, p->sorted, p->target,
                 p->sorted_target, p->order, p->candidates, p->swap);
}

static scree_status pass_allocate(pass *p, scree_decimator *d) {
  size_t n = d->s.vertex_count;
  *p = (pass){.d = d, .best = d->s.best, .cost = d->s.cost, .room = n / VERTICES_EACH + 1};
  SCREE_TRY_ALLOC(p->leader, n, d->error);
  SCREE_TRY_ALLOC(p->apex, n, d->error);
  SCREE_TRY_ALLOC(p->chosen, n, d->error);
  SCREE_TRY_ALLOC(p->marks, n, d->error);
  SCREE_TRY_ALLOC(p->candidates, n, d->error);
  SCREE_TRY_ALLOC(p->taken, p->room, d->error);
  SCREE_TRY_ALLOC(p->target, p->room, d->error);
  SCREE_TRY_ALLOC(p->sorted, p->room, d->error);
  SCREE_TRY_ALLOC(p->sorted_target, p->room, d->error);
  SCREE_TRY_ALLOC(p->order, p->room, d->error);
  SCREE_TRY_ALLOC(p->swap, p->room, d->error);
  memset(p->leader, 0xff, n * sizeof *p->leader);
  memset(p->apex, 0xff, n * sizeof *p->apex);
  memset(p->chosen, 0xff, n * sizeof *p->chosen);
  memset(p->marks, 0, n * sizeof *p->marks);
  return SCREE_OK;
}

/* ---- Ranking ---- */

static void renew_sums(void *context, scree_block block) {
  scree_decimator *d = context;
  scree_halfmesh *s = &d->s;
  for (size_t v = block.begin; v < block.end; v++) {
    if (s->vertex[v].outgoing == SCREE_NONE || !(s->flags[v] & SCREE_VERTEX_STALE)) continue;
    if (!d->coster->merge) d->coster->sum(s, (uint32_t)v);
  }
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

/* Whether something about the vertex's edges has changed. */
static bool is_stale(const scree_halfmesh *s, uint32_t v) {
  uint32_t first = s->vertex[v].outgoing, h = first;
  bool stale = s->flags[v] & SCREE_VERTEX_STALE;
  do {
    stale |= s->flags[scree_to(s, h)] & SCREE_VERTEX_STALE;
    h = scree_turn(s, h);
  } while (!stale && h != first && h != SCREE_NONE);
  return stale;
}

static void rank_block(void *context, scree_block block) {
  pass *p = context;
  const scree_halfmesh *s = &p->d->s;
  uint32_t edges[SIDE_BY_SIDE];
  size_t count = 0;
  for (uint32_t v = (uint32_t)block.begin; v < block.end; v++) {
    uint32_t first = s->vertex[v].outgoing, h = first;
    if (h == SCREE_NONE || !is_stale(s, v)) continue;
    p->cost[v] = INFINITY;
    p->best[v] = SCREE_NONE;
    p->marks[v] = 0;
    do {
      if (count == SIDE_BY_SIDE) take_best(p, edges, count), count = 0;
      if (is_ranked_here(s, h)) edges[count++] = h;
      h = scree_turn(s, h);
    } while (h != first && h != SCREE_NONE);
  }
  take_best(p, edges, count);
}

/* Costs of all edges about stale vertices, which are fresh then. */
static void rank_stale(pass *p) {
  scree_halfmesh *s = &p->d->s;
  scree_parallel_for(s->vertex_count, BLOCK, renew_sums, p->d);
  scree_parallel_for(s->vertex_count, BLOCK, rank_block, p);
  for (size_t v = 0; v < s->vertex_count; v++) s->flags[v] &= (uint8_t)~SCREE_VERTEX_STALE;
}

/* The limit, and what is usual, from an even sample of the vertices. False: no edge is left. */
static bool set_limit(pass *p) {
  enum { SAMPLE = 4096 };
  double costs[SAMPLE];
  size_t count = 0, n = p->d->s.vertex_count;
  for (size_t v = 0, step = n / SAMPLE + 1; v < n; v += step)
    if (p->d->s.vertex[v].outgoing != SCREE_NONE && p->best[v] != SCREE_NONE)
      costs[count++] = p->cost[v];
  if (count == 0) return false;
  p->limit = scree_decimate_set_usual(p->d, costs, count, scree_tune.batch);
  return true;
}

/* ---- Choosing ---- */

static bool goes_before(const pass *p, uint32_t u, uint32_t v) {
  const uint32_t scatter = 0x9e3779b1u; /* odd: a bijection; else rows of a grid would wait */
  if (p->cost[u] != p->cost[v] && !p->drawn) return p->cost[u] < p->cost[v];
  return u * scatter < v * scatter;
}

static void claim(const pass *p, uint32_t v, uint32_t *leader) {
  uint32_t found = __atomic_load_n(leader, __ATOMIC_RELAXED);
  while (found == SCREE_NONE || goes_before(p, v, found))
    if (__atomic_compare_exchange_n(leader, &found, v, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
      return;
}

static void set_mark(pass *p, uint32_t v, uint8_t mark) {
  if (!(__atomic_load_n(&p->marks[v], __ATOMIC_RELAXED) & mark))
    __atomic_fetch_or(&p->marks[v], mark, __ATOMIC_RELAXED);
}

/* Ends and apexes of the edge, d NONE on a boundary. */
typedef struct four {
  uint32_t v[4];
} four;

static four four_of(const scree_halfmesh *s, uint32_t h) {
  uint32_t twin = s->half[h].twin;
  return (four){{s->half[h].from, scree_to(s, h), s->half[scree_previous(h)].from,
                 twin == SCREE_NONE ? SCREE_NONE : s->half[scree_previous(twin)].from}};
}

/* Where the k-th of them is claimed. */
static uint32_t *place_of(const pass *p, const four *f, int k) {
  return k < 2 ? &p->leader[f->v[k]] : &p->apex[f->v[k]];
}

static void claim_block(void *context, scree_block block) {
  pass *p = context;
  for (size_t i = block.begin; i < block.end; i++) {
    four f = four_of(&p->d->s, p->best[p->candidates[i]]);
    for (int k = 0; k < 4; k++)
      if (f.v[k] != SCREE_NONE) claim(p, p->candidates[i], place_of(p, &f, k));
  }
}

static void resign_block(void *context, scree_block block) {
  pass *p = context;
  for (size_t i = block.begin; i < block.end; i++) {
    four f = four_of(&p->d->s, p->best[p->candidates[i]]);
    for (int k = 0; k < 4; k++)
      if (f.v[k] != SCREE_NONE) __atomic_store_n(place_of(p, &f, k), SCREE_NONE, __ATOMIC_RELAXED);
  }
}

/* Calls for every vertex about v, itself first; stops where false is answered. */
typedef bool visitor(pass *p, uint32_t candidate, uint32_t at);

static bool visit_about(pass *p, uint32_t v, uint32_t candidate, visitor *visit) {
  const scree_halfmesh *s = &p->d->s;
  uint32_t first = s->vertex[v].outgoing, h = first, last;
  if (!visit(p, candidate, v)) return false;
  do {
    if (!visit(p, candidate, scree_to(s, h))) return false;
    last = h;
    h = scree_turn(s, h);
  } while (h != first && h != SCREE_NONE);
  return h != SCREE_NONE || visit(p, candidate, s->half[scree_previous(last)].from);
}

static bool leads_at(pass *p, uint32_t candidate, uint32_t at) {
  uint32_t leader = p->leader[at];
  return leader == SCREE_NONE || leader == candidate || goes_before(p, candidate, leader);
}

static bool touch(pass *p, uint32_t candidate, uint32_t at) {
  (void)candidate;
  set_mark(p, at, TOUCHED);
  return true;
}

/* A candidate takes part while no end of it is near one taken, and no apex one of its apexes. */
static bool is_open(const pass *p, uint32_t v) {
  four f = four_of(&p->d->s, p->best[v]);
  for (int k = 0; k < 4; k++)
    if (f.v[k] != SCREE_NONE && p->marks[f.v[k]] & (k < 2 ? TOUCHED : APEX)) return false;
  return true;
}

static bool leads(pass *p, uint32_t v) {
  four f = four_of(&p->d->s, p->best[v]);
  for (int k = 0; k < 4; k++)
    if (f.v[k] != SCREE_NONE && *place_of(p, &f, k) != v) return false;
  return visit_about(p, f.v[0], v, leads_at) && visit_about(p, f.v[1], v, leads_at);
}

static void choose_block(void *context, scree_block block) {
  pass *p = context;
  for (size_t i = block.begin; i < block.end; i++)
    if (leads(p, p->candidates[i])) set_mark(p, p->candidates[i], TAKEN);
}

static void touch_block(void *context, scree_block block) {
  pass *p = context;
  for (size_t i = block.begin; i < block.end; i++) {
    uint32_t v = p->candidates[i];
    if (!(p->marks[v] & TAKEN)) continue;
    four f = four_of(&p->d->s, p->best[v]);
    visit_about(p, f.v[0], v, touch);
    visit_about(p, f.v[1], v, touch);
    for (int k = 2; k < 4; k++)
      if (f.v[k] != SCREE_NONE) set_mark(p, f.v[k], APEX);
  }
}

static void list_candidates(pass *p) {
  const scree_halfmesh *s = &p->d->s;
  p->candidate_count = 0;
  for (uint32_t v = 0; v < s->vertex_count; v++) {
    p->marks[v] &= REFUSED;
    if (s->vertex[v].outgoing != SCREE_NONE && p->best[v] != SCREE_NONE && p->cost[v] <= p->limit &&
        !p->marks[v])
      p->candidates[p->candidate_count++] = v;
  }
}

/* What is taken becomes planned; the rest goes on if it still may. */
static void sort_out(pass *p) {
  size_t left = 0;
  for (size_t i = 0; i < p->candidate_count; i++) {
    uint32_t v = p->candidates[i];
    if (!(p->marks[v] & TAKEN)) {
      if (is_open(p, v)) p->candidates[left++] = v;
    } else if (p->taken_count < p->room) {
      p->taken[p->taken_count++] = (taken){.half_edge = p->best[v], .cost = p->cost[v]};
    }
  }
  p->candidate_count = left;
}

static void choose(pass *p) {
  list_candidates(p);
  p->taken_count = 0;
  for (int k = 0; k < CLAIMS && p->candidate_count > 0; k++) {
    scree_parallel_for(p->candidate_count, BLOCK, claim_block, p);
    scree_parallel_for(p->candidate_count, BLOCK, choose_block, p);
    scree_parallel_for(p->candidate_count, BLOCK, resign_block, p);
    scree_parallel_for(p->candidate_count, BLOCK, touch_block, p);
    sort_out(p);
  }
}

/* ---- Judging and doing ---- */

static void judge_block(void *context, scree_block block) {
  pass *p = context;
  scree_fan f;
  for (size_t i = block.begin; i < block.end; i++) {
    taken *t = &p->taken[i];
    scree_verdict v = scree_decimate_judge(p->d, t->half_edge, p->limit, &f);
    t->cost = v.cost;
    t->error = (float)v.error;
    t->allowed = v.cost < p->limit;
    p->target[i] = v.target;
  }
}

/* The leading 32 bits below the sign: monotone in the cost. */
static uint32_t key_of(double cost) {
  uint64_t bits;
  memcpy(&bits, &cost, sizeof bits);
  return (uint32_t)(bits >> 31);
}

/* What was judged well in the order of cost; that order is the record's. */
static void plan(pass *p) {
  const scree_halfmesh *s = &p->d->s;
  size_t count = 0;
  for (uint32_t i = 0; i < p->taken_count; i++) {
    if (p->taken[i].allowed)
      p->order[count++] = (scree_keyed){key_of(p->taken[i].cost), i};
    else
      p->marks[s->half[p->taken[i].half_edge].from] |= REFUSED;
  }
  scree_keyed *by_cost = scree_radix_sort(p->order, p->swap, count, 32);
  if (by_cost != p->order) p->swap = p->order, p->order = by_cost;
  for (size_t i = 0; i < count; i++) {
    const taken *t = &p->taken[p->order[i].index];
    p->sorted[i] = *t;
    p->sorted_target[i] = p->target[p->order[i].index];
    p->chosen[s->half[t->half_edge].from] = (uint32_t)i;
    p->chosen[scree_to(s, t->half_edge)] = (uint32_t)i;
  }
  taken *was = p->taken;
  vec3 *target = p->target;
  p->taken = p->sorted, p->target = p->sorted_target;
  p->sorted = was, p->sorted_target = target;
  p->taken_count = count;
}

static void guard_block(void *context, scree_block block) {
  pass *p = context;
  const scree_decimator *d = p->d;
  const scree_planned planned = {p->chosen, p->target};
  const scree_surroundings around = {&d->s, &d->tree, &d->markers, &planned};
  scree_fan f;
  for (size_t i = block.begin; i < block.end; i++) {
    taken *t = &p->taken[i];
    scree_fan_of_edge(&d->s, t->half_edge, &f);
    scree_fan_set(&f, p->target[i]);
    t->allowed =
        !scree_shape_folds_with(&d->s, &f, &planned, d->leniency) && scree_apart(&around, &f);
  }
}

static void set_stale(scree_halfmesh *s, uint32_t v) {
  if (!(__atomic_load_n(&s->flags[v], __ATOMIC_RELAXED) & SCREE_VERTEX_STALE))
    __atomic_fetch_or(&s->flags[v], SCREE_VERTEX_STALE, __ATOMIC_RELAXED);
}

static void collapse_block(void *context, scree_block block) {
  pass *p = context;
  scree_decimator *d = p->d;
  scree_fan f;
  for (size_t i = block.begin; i < block.end; i++) {
    const taken *t = &p->taken[i];
    if (!t->allowed) continue;
    scree_fan_of_edge(&d->s, t->half_edge, &f);
    scree_fan_set(&f, p->target[i]);
    scree_decimate_collapse(d, d->record.count + p->order[i].index, &f, (double)t->error);
    set_stale(&d->s, f.a);
    for (uint32_t k = 0; k < f.count; k++) {
      set_stale(&d->s, d->s.half[f.edge[k]].from);
      set_stale(&d->s, scree_to(&d->s, f.edge[k]));
    }
  }
}

/* Does what is allowed; answers how many. order[i].index becomes the place of taken[i]. */
static size_t collapse_all(pass *p) {
  scree_decimator *d = p->d;
  scree_halfmesh *s = &d->s;
  size_t count = 0, triangles = 0;
  for (size_t i = 0; i < p->taken_count; i++) {
    uint32_t h = p->taken[i].half_edge, a = s->half[h].from, b = scree_to(s, h);
    p->chosen[a] = p->chosen[b] = SCREE_NONE;
    p->order[i].index = (uint32_t)count;
    count += p->taken[i].allowed;
    if (p->taken[i].allowed)
      triangles += s->half[h].twin == SCREE_NONE ? 1 : 2;
    else
      p->marks[a] |= REFUSED;
  }
  scree_parallel_for(p->taken_count, TAKEN_BLOCK, collapse_block, p);
  d->record.count += count;
  s->live_vertex_count -= count;
  s->live_triangle_count -= triangles;
  return count;
}

static scree_status run_round(pass *p, size_t *done) {
  scree_decimator *d = p->d;
  choose(p);
  scree_parallel_for(p->taken_count, TAKEN_BLOCK, judge_block, p);
  plan(p);
  const scree_planned planned = {p->chosen, p->target};
  scree_surface_tree_fit(&d->tree, &d->s, &planned);
  scree_parallel_for(p->taken_count, TAKEN_BLOCK, guard_block, p);
  *done += collapse_all(p);
  return scree_markers_find(&d->s, &d->markers, d->error);
}

/* No vertex is ranked yet. */
static scree_status start_ranks(scree_decimator *d) {
  scree_halfmesh *s = &d->s;
  SCREE_TRY_ALLOC(s->best, s->vertex_count, d->error);
  SCREE_TRY_ALLOC(s->cost, s->vertex_count, d->error);
  for (size_t v = 0; v < s->vertex_count; v++) s->flags[v] |= SCREE_VERTEX_STALE;
  return SCREE_OK;
}

static scree_status run_pass(scree_decimator *d, size_t least, bool drawn, size_t *done) {
  SCREE_CLEANUP(pass_free) pass p = {0};
  *done = 0;
  SCREE_TRY(scree_decimate_squeeze(d));
  if (!d->s.best) SCREE_TRY(start_ranks(d));
  SCREE_TRY(pass_allocate(&p, d));
  p.drawn = drawn;
  rank_stale(&p);
  bool more = set_limit(&p);
  for (int round = 0; more && round < ROUNDS; round++) {
    if (round > 0) rank_stale(&p);
    SCREE_TRY(run_round(&p, done));
    more = d->s.live_triangle_count > least;
  }
  return SCREE_OK;
}

/* Where costs rise steadily along the surface, as from a pole of a sphere's net, each edge waits
 * for its cheaper neighbour, and a pass takes one row: from then on they are drawn by lot. */
scree_status scree_decimate_in_passes(scree_decimator *d, size_t least) {
  bool drawn = false;
  if (least < d->options.stop_count) least = d->options.stop_count;
  while (d->s.live_triangle_count > least) {
    const size_t live = d->s.live_triangle_count;
    size_t done;
    if (!scree_decimate_tick(d)) return SCREE_CANCELLED;
    SCREE_TRY(run_pass(d, least, drawn, &done));
    if ((double)done > LEAST_SHARE * (double)live) continue;
    if (drawn) break;
    drawn = true;
  }
  scree_parallel_for(d->s.vertex_count, BLOCK, renew_sums, d);
  return SCREE_OK;
}
