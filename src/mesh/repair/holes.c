/* Filling holes: the boundary loops are found, and each is triangulated with the vertices it has.
 *
 * Loops follow boundary half-edges; where a loop comes back to a vertex it has been at, the part
 * between is a loop of its own. Up to EXACT_EDGES edges, the triangulation is the best of all by
 * dynamic programming over diagonals (Barequet and Sharir, CAGD 12 (1995)), by Liepa's measure
 * ("Filling holes in meshes", SGP 2003): the smallest worst angle between neighbouring facets,
 * those round the hole included, then the smallest area. Diagonals that are edges already are
 * forbidden: a third facet there would not be a surface. Larger loops are cut ear by ear, the
 * flattest and smallest first.
 *
 * A filling that neither is a missing flat face nor follows the surface over its rim within what a
 * choice tolerates is then refined and smoothed (repair_fair.c). One that then meets the surface,
 * or another, is taken back: a surface that is coarse there is better than one that crosses itself.
 * No rule asks for the number of edges, so that a body is filled alike at every resolution. */
#include "base/alloc.h"
#include "base/array.h"
#include "base/radix.h"
#include "mesh/repair/repair.h"

#include <float.h>
#include <string.h>

enum {
  EXACT_EDGES = 160,      /* n^3 / 6 steps: 0.1 s */
  MOST_EDGES = 16384,     /* n^2: a second */
  MEETING_LIMIT = 100000, /* pairs: with more, it is not told apart which smooth filling meets */
};

typedef struct loop {
  const scree_repair *r;
  const scree_adjacency *adjacency;
  uint32_t *vertex;    /* in the direction in which the filling runs along the hole */
  uint32_t *half_edge; /* i: the facet's half-edge from vertex[i + 1] to vertex[i] */
  size_t count;
} loop;

static vec3 at(const loop *l, size_t i) {
  return vec3_load(l->r->mesh.positions + 3 * (size_t)l->vertex[i]);
}

static vec3 normal_of(const loop *l, size_t i, size_t j, size_t k) {
  return vec3_unit(vec3_triangle_normal(at(l, i), at(l, j), at(l, k)));
}

/* The unit normal of the facet across the loop's edge i. */
static vec3 normal_across(const loop *l, size_t i) {
  size_t t = l->half_edge[i] / 3;
  const scree_mesh *m = &l->r->mesh;
  return vec3_unit(scree_facet_normal(m, t));
}

static uint64_t edge_key(uint32_t a, uint32_t b) {
  return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static uint64_t key_of(const scree_mesh *mesh, uint32_t h) {
  return edge_key(scree_half_edge_from(mesh, h), scree_half_edge_to(mesh, h));
}

/* Edges are sorted by lower, then higher vertex. */
bool scree_repair_edge_exists(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t a,
                              uint32_t b) {
  const uint64_t key = edge_key(a, b);
  SCREE_FIND_FIRST(i, 0, adjacency->edge_count, key_of(mesh, adjacency->edges[i]) < key)
  return i < adjacency->edge_count && key_of(mesh, adjacency->edges[i]) == key;
}

static bool edge_exists(const loop *l, size_t i, size_t j) {
  return scree_repair_edge_exists(&l->r->mesh, l->adjacency, l->vertex[i], l->vertex[j]);
}

/* ---- The best triangulation ---- */

/* The cost of a filling: 1 - cosine of its worst angle, then its area. */
typedef struct cost {
  double bend, area;
} cost;

static bool cheaper(cost a, cost b) {
  /* angles alike within rounding are alike */
  if (fabs(a.bend - b.bend) > 1e-9) return a.bend < b.bend;
  return a.area < b.area;
}

typedef struct cell {
  cost cost;
  uint32_t apex; /* of the triangle on diagonal (i, k); 0: none is possible */
} cell;

static double bend_between(vec3 a, vec3 b) {
  return 1 - vec3_dot(a, b);
}

/* The normal of what lies beyond side (i, j) of a new triangle: a chosen triangle, or the mesh. */
static vec3 beyond(const loop *l, const cell *table, size_t i, size_t j) {
  if (j == i + 1) return normal_across(l, i);
  return normal_of(l, i, table[i * l->count + j].apex, j);
}

static cost cost_of(const loop *l, const cell *table, size_t i, size_t j, size_t k) {
  size_t n = l->count;
  const cell *left = &table[i * n + j], *right = &table[j * n + k];
  vec3 doubled = vec3_triangle_normal(at(l, i), at(l, j), at(l, k));
  vec3 normal = vec3_unit(doubled);
  cost c = {fmax(left->cost.bend, right->cost.bend),
            left->cost.area + right->cost.area + 0.5 * vec3_norm(doubled)};
  c.bend = fmax(c.bend, bend_between(normal, beyond(l, table, i, j)));
  c.bend = fmax(c.bend, bend_between(normal, beyond(l, table, j, k)));
  if (i == 0 && k == n - 1) c.bend = fmax(c.bend, bend_between(normal, normal_across(l, n - 1)));
  return c;
}

static bool possible(const loop *l, const cell *table, size_t i, size_t j) {
  return j == i + 1 || table[i * l->count + j].apex != 0;
}

static void best_apex(const loop *l, cell *table, size_t i, size_t k) {
  cell *best = &table[i * l->count + k];
  *best = (cell){{DBL_MAX, DBL_MAX}, 0};
  bool closing = i == 0 && k == l->count - 1; /* that side is the loop's own edge */
  if (!closing && edge_exists(l, i, k)) return;
  for (size_t j = i + 1; j < k; j++) {
    if (!possible(l, table, i, j) || !possible(l, table, j, k)) continue;
    cost c = cost_of(l, table, i, j, k);
    if (best->apex == 0 || cheaper(c, best->cost)) *best = (cell){c, (uint32_t)j};
  }
}

static bool add_filling(scree_repair *r, const loop *l, const cell *table) {
  uint32_t stack[2 * EXACT_EDGES][2];
  size_t depth = 0;
  stack[depth][0] = 0, stack[depth++][1] = (uint32_t)l->count - 1;
  while (depth > 0) {
    uint32_t i = stack[--depth][0], k = stack[depth][1];
    if (k == i + 1) continue;
    uint32_t j = table[i * l->count + k].apex;
    if (!scree_repair_add_facet(r, l->vertex[i], l->vertex[j], l->vertex[k])) return false;
    stack[depth][0] = i, stack[depth++][1] = j;
    stack[depth][0] = j, stack[depth++][1] = k;
  }
  return true;
}

static scree_status fill_best(scree_repair *r, const loop *l, bool *filled, scree_error *error) {
  size_t n = l->count;
  SCREE_SCRATCH_ZERO(cell, table, n * n, error);
  for (size_t span = 2; span < n; span++)
    for (size_t i = 0; i + span < n; i++) best_apex(l, table, i, i + span);
  *filled = table[n - 1].apex != 0;
  return *filled && !add_filling(r, l, table) ? scree_repair_no_memory(error) : SCREE_OK;
}

/* ---- Ear by ear ---- */

/* How bad it is to cut the ear at b: its bend against the facets it meets, weighed by area. */
static double ear_cost(const loop *l, const uint32_t *next, const uint32_t *previous,
                       const vec3 *across, uint32_t b) {
  uint32_t a = previous[b], c = next[b];
  vec3 doubled = vec3_triangle_normal(at(l, a), at(l, b), at(l, c));
  vec3 normal = vec3_unit(doubled);
  double bend = fmax(bend_between(normal, across[a]), bend_between(normal, across[b]));
  return (bend + 0.01) * vec3_norm2(vec3_sub(at(l, c), at(l, a)));
}

typedef struct ears {
  uint32_t *next, *previous;
  vec3 *across; /* i: normal of what lies beyond the side from i to next[i] */
  double *cost;
} ears;

static uint32_t cheapest_ear(const loop *l, const ears *e, uint32_t start, size_t left) {
  uint32_t best = UINT32_MAX, b = start;
  for (size_t i = 0; i < left; i++, b = e->next[b]) {
    if (best != UINT32_MAX && e->cost[b] >= e->cost[best]) continue;
    if (left > 3 && edge_exists(l, e->previous[b], e->next[b])) continue;
    best = b;
  }
  return best;
}

/* O(n^2) and a search per ear considered; nothing is added where no ear can be cut. */
static scree_status fill_by_ears(scree_repair *r, const loop *l, bool *filled, scree_error *error) {
  size_t n = l->count, first_facet = r->mesh.triangle_count;
  SCREE_SCRATCH(uint32_t, next, n, error);
  SCREE_SCRATCH(uint32_t, previous, n, error);
  SCREE_SCRATCH(vec3, across, n, error);
  SCREE_SCRATCH(double, costs, n, error);
  ears e = {next, previous, across, costs};
  uint32_t b = 0;
  for (uint32_t i = 0; i < n; i++) {
    e.next[i] = i + 1 < n ? i + 1 : 0;
    e.previous[i] = i ? i - 1 : (uint32_t)n - 1;
    e.across[i] = normal_across(l, i);
  }
  for (uint32_t i = 0; i < n; i++) e.cost[i] = ear_cost(l, e.next, e.previous, e.across, i);
  for (size_t left = n; left >= 3; left--) {
    uint32_t ear = cheapest_ear(l, &e, b, left);
    if (ear == UINT32_MAX) {
      r->mesh.triangle_count = first_facet;
      return SCREE_OK;
    }
    uint32_t a = e.previous[ear], c = e.next[ear];
    if (!scree_repair_add_facet(r, l->vertex[a], l->vertex[ear], l->vertex[c]))
      return scree_repair_no_memory(error);
    e.across[a] = normal_of(l, a, ear, c);
    e.next[a] = c;
    e.previous[c] = b = a;
    e.cost[a] = ear_cost(l, e.next, e.previous, e.across, a);
    e.cost[c] = ear_cost(l, e.next, e.previous, e.across, c);
  }
  *filled = true;
  return SCREE_OK;
}

/* ---- Loops ---- */

/* All boundary half-edges as chains: follow[h] is the boundary half-edge that starts where h ends,
 * found by turning round that vertex through the facets of h's fan. */
static uint32_t follow(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t h) {
  uint32_t g = scree_half_edge_next(h);
  for (size_t turns = 0; turns < 3 * mesh->triangle_count; turns++) {
    uint32_t other = adjacency->ring[g];
    if (other == g) return g;
    /* only plain edges with agreeing winding can be turned through */
    if (adjacency->ring[other] != g || mesh->triangles[other] == mesh->triangles[g]) break;
    g = scree_half_edge_next(other);
  }
  return SCREE_NO_HALF_EDGE;
}

typedef struct chain {
  uint32_t *items;
  size_t count, capacity;
} chain;

/* A smooth filling: the mesh's facets from begin to end, and what it was made from. */
typedef struct smooth_filling {
  size_t begin, end, plain_count;
  uint32_t *plain; /* owned: three vertices a facet */
} smooth_filling;

/* The work on all holes. */
typedef struct hole_work {
  scree_repair *r;
  scree_adjacency adjacency;
  double area;     /* of the surface before, m^2 */
  bool own;        /* the holes were cut by the repair itself: they are filled plainly */
  bool *seen;      /* by half-edge */
  uint32_t *place; /* by vertex: 1 + its position in the chain, or 0 */
  chain chain;
  struct {
    smooth_filling *items;
    size_t count, capacity;
  } smooth;
} hole_work;

static scree_status make_smooth(hole_work *w, const loop *l, size_t first, scree_error *error) {
  scree_repair *r = w->r;
  smooth_filling s = {.begin = first, .plain_count = r->mesh.triangle_count - first};
  scree_filling filling = {l->adjacency, l->vertex, l->half_edge, l->count, first};
  bool faired = false;
  SCREE_TRY_ALLOC(s.plain, 3 * s.plain_count, error);
  memcpy(s.plain, r->mesh.triangles + 3 * first, 3 * s.plain_count * sizeof *s.plain);
  scree_status status = scree_repair_fair(r, &filling, &faired, error);
  s.end = r->mesh.triangle_count;
  if (status == SCREE_OK && faired && SCREE_PUSH(&w->smooth, s)) return SCREE_OK;
  scree_free(s.plain);
  return status == SCREE_OK && faired ? scree_repair_no_memory(error) : status;
}

/* The mean edge's share that vertices of a plane rim may lie off the plane. */
#define RIM_ROUGHNESS 0.25
/* The cosine of the angle beyond which the surface does not go on over the rim (45 degrees). */
#define RIM_BEND 0.7
/* What a choice keeps by default: the largest and the mean distance over the body's size. */
#define LARGEST_OFF 0.04
#define MEAN_OFF    0.003
/* A filling of a larger share of the area is a guess, whatever its rim. */
#define GUESSED_SHARE 0.01

static const double pi = 3.14159265358979323846;

/* How a filling goes on from its rim. */
typedef struct rim_fit {
  double area, share; /* of the filling, m^2; of the whole surface then */
  bool is_flat;       /* a missing face: the rim is plane, and the surface comes to it at an edge */
  bool follows; /* the surface, continued over the rim, is within a choice's tolerances of it */
} rim_fit;

/* The surface that goes on with the rim's slope is a cap over the hole: of height r tan(slope / 2),
 * r the radius of the filling's area. */
static rim_fit fit_rim(const hole_work *w, const loop *l, size_t first_facet) {
  vec3 normal = {0, 0, 0}, first = at(l, 0);
  double length = 0, along = 0, steep = 0, low = 0, high = 0;
  rim_fit fit = {0};
  for (size_t i = 0; i < l->count; i++) {
    vec3 p = at(l, i), q = at(l, (i + 1) % l->count);
    normal = vec3_add(normal, vec3_cross(vec3_sub(p, first), vec3_sub(q, first)));
    length += vec3_distance(p, q);
  }
  normal = vec3_unit(normal);
  for (size_t i = 0; i < l->count; i++) {
    vec3 p = at(l, i), q = at(l, (i + 1) % l->count);
    double cosine = vec3_dot(normal_across(l, i), normal);
    along += vec3_distance(p, q) * cosine;
    steep += vec3_distance(p, q) * fabs(cosine);
    low = fmin(low, vec3_dot(vec3_sub(p, first), normal));
    high = fmax(high, vec3_dot(vec3_sub(p, first), normal));
  }
  for (size_t t = first_facet; t < l->r->mesh.triangle_count; t++)
    fit.area += 0.5 * vec3_norm(scree_facet_normal(&l->r->mesh, t));
  double slope = fmax(along / length, -1), size = sqrt((w->area + fit.area) / pi),
         cap = sqrt(fit.area / pi) * sqrt((1 - slope) / (1 + slope + DBL_MIN)),
         off = fmax(0.5 * (high - low), cap);
  fit.share = fit.area / (w->area + fit.area);
  fit.is_flat =
      0.5 * (high - low) <= RIM_ROUGHNESS * length / (double)l->count && steep < RIM_BEND * length;
  fit.follows = off <= LARGEST_OFF * size && 0.5 * off * fit.share <= MEAN_OFF * size;
  return fit;
}

/* One loop of half-edges, in the order of the boundary (against the filling's). */
static scree_status fill_loop(hole_work *w, const uint32_t *half_edges, size_t count,
                              scree_error *error) {
  scree_repair *r = w->r;
  bool filled = false;
  size_t before = r->mesh.triangle_count;
  if (count < 3 || count > MOST_EDGES) return SCREE_OK;
  if (count == 3 && half_edges[0] / 3 == half_edges[1] / 3) return SCREE_OK; /* a lone facet */
  SCREE_SCRATCH(uint32_t, vertex, count, error);
  SCREE_SCRATCH(uint32_t, half_edge, count, error);
  loop l = {r, &w->adjacency, vertex, half_edge, count};
  for (size_t i = 0; i < count; i++) {
    /* the filling runs backwards: from the end of each half-edge to its start */
    uint32_t h = half_edges[count - 1 - i];
    vertex[i] = scree_half_edge_to(&r->mesh, h);
    half_edge[i] = h;
  }
  SCREE_TRY((count <= EXACT_EDGES ? fill_best : fill_by_ears)(r, &l, &filled, error));
  if (!filled) return SCREE_OK;
  rim_fit fit = fit_rim(w, &l, before);
  if (!w->own && fit.share > r->options->hole_share) {
    r->mesh.triangle_count = before;
    r->report.refused_share = fmax(r->report.refused_share, fit.share);
    return SCREE_OK;
  }
  if (!w->own && !r->options->flat_holes && !fit.is_flat && !fit.follows)
    SCREE_TRY(make_smooth(w, &l, before, error));
  if (!w->own && (fit.share >= GUESSED_SHARE || !(fit.is_flat || fit.follows)))
    r->report.guessed_area += fit.area;
  r->report.done[SCREE_REPAIR_FILL_HOLE]++;
  r->report.done[SCREE_REPAIR_FILL_FACET] += r->mesh.triangle_count - before;
  return SCREE_OK;
}

/* Walks the loop from `start`, filling each part that closes on itself. */
static scree_status walk(hole_work *w, uint32_t start, scree_error *error) {
  const scree_repair *r = w->r;
  chain *c = &w->chain;
  c->count = 0;
  for (uint32_t h = start; h != SCREE_NO_HALF_EDGE && !w->seen[h];
       h = follow(&r->mesh, &w->adjacency, h)) {
    w->seen[h] = true;
    if (c->count == 0) w->place[r->mesh.triangles[h]] = 1;
    if (!SCREE_PUSH(c, h)) return scree_repair_no_memory(error);
    uint32_t end = scree_half_edge_to(&r->mesh, h);
    if (!w->place[end]) {
      w->place[end] = (uint32_t)c->count + 1;
      continue;
    }
    size_t from = w->place[end] - 1;
    SCREE_TRY(fill_loop(w, c->items + from, c->count - from, error));
    for (size_t i = from + 1; i < c->count; i++) w->place[r->mesh.triangles[c->items[i]]] = 0;
    c->count = from;
  }
  for (size_t i = 0; i < c->count; i++) {
    w->place[r->mesh.triangles[c->items[i]]] = 0;
    w->place[scree_half_edge_to(&r->mesh, c->items[i])] = 0;
  }
  w->place[r->mesh.triangles[start]] = 0;
  return SCREE_OK;
}

/* ---- Smooth fillings that meet something ---- */

static bool meets(const smooth_filling *s, const scree_meetings *found) {
  for (size_t i = 0; i < found->count && !found->truncated; i++)
    if ((found->items[i].first >= s->begin && found->items[i].first < s->end) ||
        (found->items[i].second >= s->begin && found->items[i].second < s->end))
      return true;
  return found->truncated;
}

static scree_status take_back(hole_work *w, const scree_meetings *found, scree_error *error) {
  scree_repair *r = w->r;
  size_t *done = r->report.done;
  SCREE_SCRATCH_ZERO(bool, marked, r->mesh.triangle_count, error);
  for (size_t i = 0; i < w->smooth.count; i++) {
    smooth_filling *s = &w->smooth.items[i];
    if (!meets(s, found)) {
      s->plain_count = 0;
      done[SCREE_REPAIR_SMOOTH_HOLE]++;
      continue;
    }
    memset(marked + s->begin, true, s->end - s->begin);
    done[SCREE_REPAIR_COARSE_HOLE]++;
    done[SCREE_REPAIR_FILL_FACET] -= s->end - s->begin;
    done[SCREE_REPAIR_FILL_FACET] += s->plain_count;
  }
  scree_facets_drop(&r->mesh, marked);
  for (size_t i = 0; i < w->smooth.count; i++)
    for (const uint32_t *v = w->smooth.items[i].plain,
                        *end = v + 3 * w->smooth.items[i].plain_count;
         v < end; v += 3)
      if (!scree_repair_add_facet(r, v[0], v[1], v[2])) return scree_repair_no_memory(error);
  return SCREE_OK;
}

static scree_status judge_smooth(hole_work *w, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) scree_meetings found = {0};
  const scree_mesh *mesh = &w->r->mesh;
  if (w->smooth.count == 0) return SCREE_OK;
  SCREE_SCRATCH(bool, others, mesh->triangle_count, error);
  memset(others, true, mesh->triangle_count);
  for (size_t i = 0; i < w->smooth.count; i++)
    memset(others + w->smooth.items[i].begin, false,
           w->smooth.items[i].end - w->smooth.items[i].begin);
  if (w->r->options->intersections)
    SCREE_TRY(scree_mesh_meetings(mesh, others, MEETING_LIMIT, w->r->progress, &found, error));
  return take_back(w, &found, error);
}

static void free_work(hole_work *w) {
  for (size_t i = 0; i < w->smooth.count; i++) scree_free(w->smooth.items[i].plain);
  SCREE_FREE_ALL(w->smooth.items, w->seen, w->place, w->chain.items);
  scree_adjacency_free(&w->adjacency);
}

scree_status scree_repair_holes(scree_repair *r, bool own, scree_error *error) {
  SCREE_CLEANUP(free_work) hole_work w = {.r = r, .own = own};
  size_t half_edge_count = 3 * r->mesh.triangle_count;
  for (size_t t = 0; t < r->mesh.triangle_count; t++)
    w.area += 0.5 * vec3_norm(scree_facet_normal(&r->mesh, t));
  SCREE_TRY(scree_adjacency_build(&r->mesh, &w.adjacency, error));
  SCREE_TRY_ALLOC_ZERO(w.seen, half_edge_count, error);
  SCREE_TRY_ALLOC_ZERO(w.place, r->mesh.vertex_count, error);
  for (uint32_t h = 0; h < half_edge_count; h++)
    if (w.adjacency.ring[h] == h && !w.seen[h]) SCREE_TRY(walk(&w, h, error));
  return judge_smooth(&w, error);
}
