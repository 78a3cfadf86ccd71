/* Rounds of finding where facets meet and cutting them there, until none do.
 *
 * A round finds all pairs of facets that meet, exactly (mesh/index/meetings.c), those near them
 * that come within the tolerance of each other, and where each pair comes together
 * (mesh/repair/arrange_sites.c). These places become vertices: on an edge, of all facets at that
 * edge; within a facet, of that facet. Vertices within the tolerance of each other become one. Then
 * each facet is triangulated anew with its vertices and the segments between them
 * (mesh/repair/facet_cut.c). What a round leaves out, such as segments that cross within a facet,
 * the next one finds as facets that still meet; three or four rounds are usual, of which later ones
 * look at facets only that the one before cut or that met others there. Rounding moves facets a
 * little and may make them meet anew, which is why the end is told by the exact search, and why
 * what lies within the tolerance is taken to touch. Nothing says that the rounds must end; where
 * they do not, that is answered.
 *
 * The surface is held as a chain: each triple of vertices once, with a whole number that says how
 * often it counts, so that facets that coincide add up or cancel. All that is done keeps the chain
 * closed: facets at an edge get the same vertices on it, and facets without area vanish only where
 * their rim does, too. Compare Cherchi et al., "Fast and robust mesh arrangements using
 * floating-point arithmetic", ACM Trans. Graph. 39 (2020), who hold the new vertices unrounded. */
#include "mesh/repair/arrange.h"

#include "base/array.h"
#include "base/radix.h"
#include "mesh/adjacency.h"
#include "mesh/index/intersect.h"
#include "mesh/repair/arrange_sites.h"
#include "mesh/repair/facet_cut.h"

#include <stdlib.h>
#include <string.h>

enum {
  ROUNDS = 16,
  GROWTH = 64,             /* times the facets that went in; more, and the rounds run away */
  LEAST_LIMIT = 20000,     /* of facets, however few went in */
  ROUNDING_MEETINGS = 200, /* more than twice the fewest and this many, and they run away, too */
};

static const char endless[] =
    "cutting the facets where they meet comes to no end, as where parts lie on each other within "
    "rounding; repair the parts one by one and unite them in a CAD program";
const char scree_arrange_too_many[] =
    "more pairs of facets meet than there are facets; repair the file's parts one by one";

/* What lies nearer than this share of the bounding box diagonal touches ... */
#define TOLERANCE 1e-12
/* ... but no nearer than this share of the largest coordinate. */
#define LEAST_TOLERANCE 1e-13
/* Vertices on edges bend them by up to the tolerance: what lay on each other lies within the wider
 * tolerance of the next round still. */
#define WIDENING 2.0

/* Vertices are near each other in space only where they are along this line, which surfaces made on
 * grids do not stand upright on. */
static const double sweep[3] = {0.5426374801, 0.3189731846, 0.7770443526};

typedef struct facet {
  uint32_t v[3]; /* ascending */
  int32_t weight;
  bool settled; /* it was there in the last round and met nothing */
  bool met;     /* it meets another */
} facet;

typedef struct edge_point {
  uint32_t low, high; /* of the edge */
  uint32_t vertex;
  double along;
} edge_point;

typedef struct facet_point {
  uint32_t facet, vertex;
} facet_point;

typedef struct facet_segment {
  uint32_t facet, a, b;
} facet_segment;

typedef struct join {
  uint32_t a, b;
} join;

typedef struct sweep_key {
  double at;
  uint32_t vertex;
} sweep_key;

#define LIST(type)                                                                                 \
  struct {                                                                                         \
    type *items;                                                                                   \
    size_t count, capacity;                                                                        \
  }

typedef struct arranger {
  LIST(double) positions;
  LIST(facet) facets;
  LIST(edge_point) edge_points;
  LIST(facet_point) facet_points;
  LIST(facet_segment) segments;
  LIST(join) joins; /* corners at one place */
  LIST(sweep_key) near;
  scree_index_list triangles;   /* of the facets, and those that a cut makes */
  scree_index_list rim, pieces; /* of the facet at hand */
  uint32_t *merged;             /* union-find over vertices */
  bool *touched;                /* by vertex: an end of an edge with points */
  LIST(bool) active;         /* by vertex: of a facet that met another, in this round or earlier */
  LIST(uint32_t) candidates; /* facets with such vertices */
  scree_facet_pairs pairs;
  double tolerance;
  size_t fewest_met; /* pairs of facets that met in a round */
  bool first;        /* round: no facet is settled yet */
  const char *reason;
} arranger;

static const double *position(const arranger *a, uint32_t v) {
  return a->positions.items + 3 * (size_t)v;
}

static vec3 place(const arranger *a, uint32_t v) {
  return vec3_load(position(a, v));
}

static scree_status no_memory(scree_error *error) {
  return scree_fail(error, SCREE_OUT_OF_MEMORY,
                    "out of memory while cutting facets where they meet");
}

/* ---- The chain ---- */

static bool add_facet(arranger *a, uint32_t x, uint32_t y, uint32_t z, int32_t weight,
                      bool settled) {
  facet f = {{x, y, z}, weight, settled, false};
  if (x == y || y == z || z == x) return true;
  for (int i = 0; i < 3; i++) { /* three exchanges sort three */
    int k = i % 2;
    if (f.v[k] < f.v[k + 1]) continue;
    uint32_t keep = f.v[k];
    f.v[k] = f.v[k + 1], f.v[k + 1] = keep;
    f.weight = -f.weight;
  }
  return SCREE_PUSH(&a->facets, f);
}

static int compare_facets(const void *p, const void *q) {
  const facet *x = p, *y = q;
  for (int k = 0; k < 3; k++)
    if (x->v[k] != y->v[k]) return x->v[k] < y->v[k] ? -1 : 1;
  return 0;
}

/* Facets on the same vertices become one. */
static void sum_facets(arranger *a) {
  facet *f = a->facets.items;
  size_t count = 0;
  if (a->facets.count) qsort(f, a->facets.count, sizeof *f, compare_facets);
  for (size_t i = 0; i < a->facets.count;) {
    facet sum = f[i];
    for (i++; i < a->facets.count && compare_facets(&sum, &f[i]) == 0; i++)
      sum.weight += f[i].weight, sum.settled &= f[i].settled;
    if (sum.weight) f[count++] = sum;
  }
  a->facets.count = count;
}

/* The facets as a mesh, whose triangles are a->triangles. */
static bool make_mesh(arranger *a, scree_mesh *mesh) {
  a->triangles.count = 0;
  if (!SCREE_RESERVE(&a->triangles, 3 * a->facets.count + 1)) return false;
  for (size_t t = 0; t < a->facets.count; t++)
    for (int k = 0; k < 3; k++) a->triangles.items[a->triangles.count++] = a->facets.items[t].v[k];
  *mesh =
      (scree_mesh){a->positions.items, a->triangles.items, a->positions.count / 3, a->facets.count};
  return true;
}

static bool start(arranger *a, const scree_mesh *mesh) {
  vec3 low = {INFINITY, INFINITY, INFINITY}, high = vec3_neg(low);
  double largest = 0;
  if (!SCREE_RESERVE(&a->positions, 3 * mesh->vertex_count)) return false;
  if (a->positions.items)
    memcpy(a->positions.items, mesh->positions, 3 * mesh->vertex_count * sizeof(double));
  a->positions.count = 3 * mesh->vertex_count;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const uint32_t *v = mesh->triangles + 3 * t;
    if (!add_facet(a, v[0], v[1], v[2], 1, true)) return false;
    for (int k = 0; k < 3; k++) {
      vec3 p = place(a, v[k]);
      low = vec3_min(low, p), high = vec3_max(high, p);
      largest = fmax(largest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
  }
  a->tolerance = fmax(TOLERANCE * vec3_distance(low, high), LEAST_TOLERANCE * largest);
  return true;
}

/* ---- Places ---- */

static bool add_edge_point(arranger *a, uint32_t x, uint32_t y, uint32_t vertex) {
  return SCREE_PUSH(&a->edge_points, (edge_point){x < y ? x : y, x < y ? y : x, vertex, 0});
}

static scree_site_facet site_facet(const arranger *a, uint32_t t) {
  scree_site_facet f;
  int longest;
  for (int k = 0; k < 3; k++) {
    f.v[k] = a->facets.items[t].v[k];
    f.p[k] = position(a, f.v[k]);
  }
  f.flat = scree_site_is_flat(f.p, a->tolerance, &longest);
  return f;
}

/* A vertex on a feature of facet t. */
static bool place_vertex(arranger *a, uint32_t t, int feature, uint32_t vertex) {
  const uint32_t *v = a->facets.items[t].v;
  if (feature < SCREE_SITE_EDGE) return SCREE_PUSH(&a->joins, (join){v[feature], vertex});
  if (feature == SCREE_SITE_WITHIN) return SCREE_PUSH(&a->facet_points, (facet_point){t, vertex});
  int k = feature - SCREE_SITE_EDGE;
  return add_edge_point(a, v[k], v[(k + 1) % 3], vertex);
}

static bool lies_on(int feature, int k) {
  return feature == SCREE_SITE_EDGE + k || feature == k || feature == (k + 1) % 3;
}

static bool share_edge(int feature, int other) {
  for (int k = 0; k < 3; k++)
    if (lies_on(feature, k) && lies_on(other, k)) return true;
  return false;
}

static bool add_segment(arranger *a, uint32_t t, uint32_t x, uint32_t y) {
  return SCREE_PUSH(&a->segments, (facet_segment){t, x < y ? x : y, x < y ? y : x});
}

/* A site as one of the two facets sees it. */
typedef struct half_site {
  uint32_t vertex;
  int here, there; /* its features */
  double along;
} half_site;

SCREE_ORDER_BY(compare_along, half_site, along)

/* Segments within facet t along the edges of the other facet; true in *any where there are some. */
static bool add_edge_segments(arranger *a, uint32_t t, const scree_site_facet *other,
                              half_site *sites, int count, bool *any) {
  for (int k = 0; k < 3; k++) {
    half_site on[SCREE_SITES];
    int on_count = 0;
    vec3 from = vec3_load(other->p[k]), d = vec3_sub(vec3_load(other->p[(k + 1) % 3]), from);
    for (int i = 0; i < count; i++) {
      if (!lies_on(sites[i].there, k)) continue;
      on[on_count] = sites[i];
      on[on_count++].along = vec3_dot(vec3_sub(place(a, sites[i].vertex), from), d);
    }
    qsort(on, (size_t)on_count, sizeof *on, compare_along);
    for (int i = 1; i < on_count; i++) {
      *any = true;
      if (!share_edge(on[i - 1].here, on[i].here) &&
          !add_segment(a, t, on[i - 1].vertex, on[i].vertex))
        return false;
    }
  }
  return true;
}

/* The two sites farthest from each other are joined in facet t. */
static bool add_longest_segment(arranger *a, uint32_t t, const half_site *sites, int count) {
  int first = 0, second = 0;
  double most = 0;
  if (count < 2) return true;
  for (int i = 0; i < count; i++)
    for (int j = 0; j < i; j++) {
      double length = vec3_distance(place(a, sites[i].vertex), place(a, sites[j].vertex));
      if (length > most) most = length, first = j, second = i;
    }
  if (most <= a->tolerance || share_edge(sites[first].here, sites[second].here)) return true;
  return add_segment(a, t, sites[first].vertex, sites[second].vertex);
}

/* *any: they have more in common than vertices. */
static bool place_pair(arranger *a, uint32_t t, uint32_t u, bool *any_new) {
  scree_site sites[SCREE_SITES];
  half_site of_t[SCREE_SITES], of_u[SCREE_SITES];
  scree_site_facet f = site_facet(a, t), g = site_facet(a, u);
  int count = scree_sites_find(&f, &g, a->tolerance, sites);
  for (int i = 0; i < count; i++) {
    scree_site *s = &sites[i];
    *any_new |= s->vertex == UINT32_MAX || s->t_feature >= SCREE_SITE_EDGE ||
                s->u_feature >= SCREE_SITE_EDGE ||
                a->facets.items[t].v[s->t_feature] != a->facets.items[u].v[s->u_feature];
    if (s->vertex == UINT32_MAX) {
      s->vertex = (uint32_t)(a->positions.count / 3);
      for (int k = 0; k < 3; k++)
        if (!SCREE_PUSH(&a->positions, s->at[k])) return false;
    }
    if (!place_vertex(a, t, s->t_feature, s->vertex) ||
        !place_vertex(a, u, s->u_feature, s->vertex))
      return false;
    of_t[i] = (half_site){s->vertex, s->t_feature, s->u_feature, 0};
    of_u[i] = (half_site){s->vertex, s->u_feature, s->t_feature, 0};
  }
  bool any = false;
  f = site_facet(a, t), g = site_facet(a, u); /* positions may have moved in memory */
  if (!add_edge_segments(a, t, &g, of_t, count, &any) ||
      !add_edge_segments(a, u, &f, of_u, count, &any))
    return false;
  return any || (add_longest_segment(a, t, of_t, count) && add_longest_segment(a, u, of_u, count));
}

/* The apex of a facet without area lies on its longest edge. */
static bool place_apex(arranger *a, uint32_t t) {
  const uint32_t *v = a->facets.items[t].v;
  const double *p[3] = {position(a, v[0]), position(a, v[1]), position(a, v[2])};
  int longest;
  scree_site_is_flat(p, a->tolerance, &longest);
  return add_edge_point(a, v[longest], v[(longest + 1) % 3], v[(longest + 2) % 3]);
}

/* Facets that are not settled, and all at their vertices: those are looked at again, for what comes
 * within the tolerance only. */
static bool list_candidates(arranger *a) {
  a->candidates.count = a->triangles.count = 0;
  if (!SCREE_RESERVE(&a->active, a->positions.count / 3)) return false;
  a->active.count = a->positions.count / 3;
  memset(a->active.items, 0, a->active.count);
  for (uint32_t t = 0; t < a->facets.count; t++)
    for (int k = 0; k < 3; k++)
      if (!a->facets.items[t].settled) a->active.items[a->facets.items[t].v[k]] = true;
  for (uint32_t t = 0; t < a->facets.count; t++) {
    const uint32_t *v = a->facets.items[t].v;
    if (!a->active.items[v[0]] && !a->active.items[v[1]] && !a->active.items[v[2]]) continue;
    if (!SCREE_PUSH(&a->candidates, t)) return false;
    for (int k = 0; k < 3; k++)
      if (!SCREE_PUSH(&a->triangles, v[k])) return false;
  }
  return true;
}

/* Pairs of candidates that may come within the tolerance, as facets. */
static scree_status list_pairs(arranger *a, scree_error *error) {
  SCREE_CLEANUP(scree_facet_tree_free) scree_facet_tree tree = {0};
  a->pairs.count = 0;
  if (!list_candidates(a)) return no_memory(error);
  if (a->candidates.count == 0) return SCREE_OK;
  scree_mesh part = {a->positions.items, a->triangles.items, a->positions.count / 3,
                     a->candidates.count};
  SCREE_TRY(scree_facet_tree_build(&part, &tree, error));
  if (!scree_near_pairs(&tree, a->tolerance, &a->pairs)) return no_memory(error);
  for (size_t i = 0; i < a->pairs.count; i++) {
    scree_facet_pair *pair = &a->pairs.items[i];
    pair->first = a->candidates.items[pair->first];
    pair->second = a->candidates.items[pair->second];
  }
  return SCREE_OK;
}

/* The vertices of candidates, to be compared with each other. */
static bool list_near(arranger *a) {
  for (size_t i = 0; i < a->candidates.count; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t v = a->facets.items[a->candidates.items[i]].v[k];
      if (!SCREE_PUSH(&a->near, (sweep_key){0, v})) return false;
    }
  return true;
}

/* All places where facets meet or nearly do, and the apices of those without area. *any: there are
 * facets to be cut. */
static bool place_all(arranger *a, bool *any) {
  a->edge_points.count = a->facet_points.count = a->segments.count = a->joins.count = 0;
  a->near.count = 0;
  for (uint32_t t = 0; t < a->facets.count; t++) {
    scree_mesh alone = {a->positions.items, a->facets.items[t].v, a->positions.count / 3, 1};
    if (!scree_facet_is_flat(&alone, 0)) continue;
    *any = true;
    if (!place_apex(a, t)) return false;
  }
  for (size_t i = 0; i < a->candidates.count; i++) {
    uint32_t t = a->candidates.items[i];
    if (site_facet(a, t).flat && !place_apex(a, t)) return false;
  }
  for (size_t i = 0; i < a->pairs.count; i++)
    if (!place_pair(a, a->pairs.items[i].first, a->pairs.items[i].second, any)) return false;
  return list_near(a);
}

/* ---- Vertices near each other ---- */

SCREE_ORDER_BY2(compare_sweep, sweep_key, at, vertex)

/* Vertices of facets that meet, and all new ones, become one, the lowest, within the tolerance of
 * each other. */
static scree_status merge_vertices(arranger *a, size_t old_count, scree_error *error) {
  size_t count = a->positions.count / 3;
  scree_free(a->merged);
  a->merged = NULL;
  SCREE_TRY_ALLOC(a->merged, count, error);
  for (uint32_t v = 0; v < count; v++) a->merged[v] = v;
  for (size_t i = 0; i < a->joins.count; i++)
    scree_join(a->merged, a->joins.items[i].a, a->joins.items[i].b);
  for (uint32_t v = (uint32_t)old_count; v < count; v++)
    if (!SCREE_PUSH(&a->near, (sweep_key){0, v})) return no_memory(error);
  for (size_t i = 0; i < a->near.count; i++) {
    const double *p = position(a, a->near.items[i].vertex);
    a->near.items[i].at = sweep[0] * p[0] + sweep[1] * p[1] + sweep[2] * p[2];
  }
  if (a->near.count) qsort(a->near.items, a->near.count, sizeof *a->near.items, compare_sweep);
  for (size_t i = 0; i < a->near.count; i++) {
    uint32_t v = a->near.items[i].vertex;
    for (size_t j = i + 1;
         j < a->near.count && a->near.items[j].at <= a->near.items[i].at + a->tolerance; j++) {
      uint32_t w = a->near.items[j].vertex;
      if (v != w && vec3_distance(place(a, v), place(a, w)) < a->tolerance)
        scree_join(a->merged, v, w);
    }
  }
  for (uint32_t v = 0; v < count; v++) a->merged[v] = scree_find_root(a->merged, v);
  return SCREE_OK;
}

/* ---- Lists in order ---- */

SCREE_ORDER_BY4(compare_edge_points, edge_point, low, high, along, vertex)

SCREE_ORDER_BY2(compare_facet_points, facet_point, facet, vertex)

SCREE_ORDER_BY3(compare_segments, facet_segment, facet, a, b)

/* Each edge's vertices in their order along it, each once. */
static void order_edge_points(arranger *a) {
  edge_point *p = a->edge_points.items;
  size_t count = 0;
  for (size_t i = 0; i < a->edge_points.count; i++) {
    edge_point q = p[i];
    uint32_t x = a->merged[q.low], y = a->merged[q.high];
    q.vertex = a->merged[q.vertex];
    if (x == y || q.vertex == x || q.vertex == y) continue;
    q.low = x < y ? x : y, q.high = x < y ? y : x;
    vec3 from = place(a, q.low);
    q.along = vec3_dot(vec3_sub(place(a, q.vertex), from), vec3_sub(place(a, q.high), from));
    p[count++] = q;
  }
  if (count) qsort(p, count, sizeof *p, compare_edge_points);
  size_t kept = 0;
  for (size_t i = 0; i < count; i++) /* the same vertex has the same place */
    if (i == 0 || compare_edge_points(&p[i - 1], &p[i]) != 0) p[kept++] = p[i];
  a->edge_points.count = kept;
}

static void order_facet_lists(arranger *a) {
  facet_point *p = a->facet_points.items;
  facet_segment *s = a->segments.items;
  size_t count = 0;
  for (size_t i = 0; i < a->facet_points.count; i++) p[i].vertex = a->merged[p[i].vertex];
  if (a->facet_points.count) qsort(p, a->facet_points.count, sizeof *p, compare_facet_points);
  for (size_t i = 0; i < a->facet_points.count; i++)
    if (i == 0 || compare_facet_points(&p[i - 1], &p[i]) != 0) p[count++] = p[i];
  a->facet_points.count = count;
  count = 0;
  for (size_t i = 0; i < a->segments.count; i++) {
    uint32_t x = a->merged[s[i].a], y = a->merged[s[i].b];
    if (x != y) s[count++] = (facet_segment){s[i].facet, x < y ? x : y, x < y ? y : x};
  }
  if (count) qsort(s, count, sizeof *s, compare_segments);
  a->segments.count = 0;
  for (size_t i = 0; i < count; i++)
    if (i == 0 || compare_segments(&s[i - 1], &s[i]) != 0) s[a->segments.count++] = s[i];
}

/* ---- Cutting ---- */

/* The edge's first point, or the list's end. */
static size_t find_edge(const arranger *a, uint32_t low, uint32_t high) {
  const edge_point *p = a->edge_points.items;
  SCREE_FIND_FIRST(i, 0, a->edge_points.count,
                   p[i].low < low || (p[i].low == low && p[i].high < high))
  return i;
}

/* Appends the vertices on the edge, in order from x to y. */
static bool list_rim(arranger *a, uint32_t x, uint32_t y) {
  uint32_t low = x < y ? x : y, high = x < y ? y : x;
  if (!a->touched[x] || !a->touched[y]) return true;
  size_t begin = find_edge(a, low, high), end = begin;
  const edge_point *p = a->edge_points.items;
  while (end < a->edge_points.count && p[end].low == low && p[end].high == high) end++;
  for (size_t i = begin; i < end; i++)
    if (!SCREE_PUSH(&a->rim, p[x < y ? i : end - 1 - (i - begin)].vertex)) return false;
  return true;
}

/* What a facet is cut by; the lists run along with the facets. */
typedef struct cursor {
  size_t point, segment;
} cursor;

static bool cut_facet(arranger *a, scree_facet_cutter *cutter, const facet *f, uint32_t index,
                      cursor *at) {
  scree_facet_job job = {.positions = a->positions.items};
  size_t rim_end[3], point = at->point, segment = at->segment;
  const double *p[3];
  int longest;
  while (at->point < a->facet_points.count && a->facet_points.items[at->point].facet == index)
    at->point++;
  while (at->segment < a->segments.count && a->segments.items[at->segment].facet == index)
    at->segment++;
  for (int k = 0; k < 3; k++) {
    job.corner[k] = a->merged[f->v[k]];
    p[k] = position(a, job.corner[k]);
  }
  const uint32_t *v = job.corner;
  if (scree_names_twice(v)) return true; /* its rim cancels */
  a->rim.count = 0;
  for (int k = 0; k < 3; k++) {
    if (!list_rim(a, v[k], v[(k + 1) % 3])) return false;
    rim_end[k] = a->rim.count;
  }
  job.inner_count = at->point - point;
  job.segment_count = at->segment - segment;
  if (a->rim.count + job.inner_count + job.segment_count == 0)
    return add_facet(a, v[0], v[1], v[2], f->weight,
                     !f->met && v[0] == f->v[0] && v[1] == f->v[1] && v[2] == f->v[2]);
  for (size_t i = point; i < at->point; i++)
    if (!SCREE_PUSH(&a->rim, a->facet_points.items[i].vertex)) return false;
  for (size_t i = segment; i < at->segment; i++)
    if (!SCREE_PUSH(&a->rim, a->segments.items[i].a) ||
        !SCREE_PUSH(&a->rim, a->segments.items[i].b))
      return false;
  for (int k = 0; k < 3; k++) {
    size_t begin = k ? rim_end[k - 1] : 0;
    job.rim[k] = a->rim.items + begin;
    job.rim_count[k] = rim_end[k] - begin;
  }
  job.inner = a->rim.items + rim_end[2];
  job.segments = job.inner + job.inner_count;
  job.tolerance = a->tolerance;
  job.flat = scree_site_is_flat(p, a->tolerance, &longest);
  a->pieces.count = 0;
  if (!scree_facet_cut(cutter, &job, &a->pieces)) return false;
  const uint32_t *c = a->pieces.items;
  for (size_t i = 0; i < a->pieces.count; i += 3)
    if (!add_facet(a, c[i], c[i + 1], c[i + 2], f->weight, false)) return false;
  return true;
}

static scree_status cut_all(arranger *a, scree_error *error) {
  facet *old = a->facets.items;
  size_t count = a->facets.count;
  cursor at = {0, 0};
  bool good = true;
  scree_facet_cutter *cutter = scree_facet_cutter_create();
  a->facets.items = NULL;
  a->facets.count = a->facets.capacity = 0;
  scree_free(a->touched);
  a->touched = scree_alloc(a->positions.count / 3, sizeof *a->touched);
  good = cutter && a->touched;
  if (good) memset(a->touched, 0, a->positions.count / 3);
  for (size_t i = 0; good && i < a->edge_points.count; i++)
    a->touched[a->edge_points.items[i].low] = a->touched[a->edge_points.items[i].high] = true;
  for (uint32_t t = 0; t < count && good; t++) good = cut_facet(a, cutter, &old[t], t, &at);
  scree_facet_cutter_free(cutter);
  scree_free(old);
  return good ? SCREE_OK : no_memory(error);
}

/* ---- Rounds ---- */

/* All pairs of facets that meet. In the first round all count as settled, though nothing is known
 * of them: only those that meet are cut. */
static scree_status find_meetings(arranger *a, const scree_mesh *mesh,
                                  const scree_progress *progress, scree_meetings *found,
                                  scree_error *error) {
  SCREE_SCRATCH(bool, settled, a->facets.count, error);
  for (size_t t = 0; t < a->facets.count; t++) settled[t] = a->facets.items[t].settled;
  SCREE_TRY(scree_mesh_meetings(mesh, a->first ? NULL : settled, scree_arrange_limit(mesh),
                                progress, found, error));
  /* of more than the limit there is the count alone */
  for (size_t i = 0; !found->truncated && i < found->count; i++) {
    facet *f = &a->facets.items[found->items[i].first],
          *g = &a->facets.items[found->items[i].second];
    f->met = g->met = true;
    f->settled = g->settled = false;
  }
  return SCREE_OK;
}

/* *done: nothing meets. */
static scree_status run_round(arranger *a, const scree_progress *progress, bool *done,
                              scree_error *error) {
  scree_mesh mesh;
  SCREE_CLEANUP(scree_free_at) scree_meetings found = {0};
  size_t old_count = a->positions.count / 3;
  sum_facets(a);
  *done = a->facets.count == 0; /* there are none, or all have cancelled */
  if (*done) return SCREE_OK;
  if (!make_mesh(a, &mesh)) return no_memory(error);
  SCREE_TRY(find_meetings(a, &mesh, progress, &found, error));
  if (found.truncated) a->reason = scree_arrange_too_many;
  if (a->first || found.count < a->fewest_met) a->fewest_met = found.count;
  if (found.count > 2 * a->fewest_met + ROUNDING_MEETINGS) a->reason = endless;
  a->first = false;
  if (a->reason) return SCREE_OK;
  SCREE_TRY(list_pairs(a, error));
  bool any = found.count > 0;
  if (!place_all(a, &any)) return no_memory(error);
  *done = !any;
  if (*done) return SCREE_OK;
  SCREE_TRY(merge_vertices(a, old_count, error));
  order_edge_points(a);
  order_facet_lists(a);
  return cut_all(a, error);
}

/* Hands the facets over. */
static scree_status finish(arranger *a, scree_arrangement *arrangement, scree_error *error) {
  scree_mesh mesh;
  int32_t *weights = NULL;
  if (!make_mesh(a, &mesh)) return no_memory(error);
  SCREE_TRY_ALLOC(weights, a->facets.count, error);
  for (size_t t = 0; t < a->facets.count; t++) weights[t] = a->facets.items[t].weight;
  *arrangement = (scree_arrangement){mesh, weights};
  a->positions.items = NULL;
  a->triangles.items = NULL;
  return SCREE_OK;
}

scree_status scree_arrange(const scree_mesh *mesh, const scree_progress *progress,
                           scree_arrangement *arrangement, const char **reason,
                           scree_error *error) {
  arranger a = {.first = true};
  bool done = false;
  size_t limit = GROWTH * mesh->triangle_count + LEAST_LIMIT;
  *arrangement = (scree_arrangement){0};
  scree_status status = start(&a, mesh) ? SCREE_OK : no_memory(error);
  for (int round = 0; status == SCREE_OK && !a.reason && !done; round++) {
    if (round == ROUNDS || a.facets.count > limit || a.positions.count / 3 >= UINT32_MAX / 4)
      a.reason = endless;
    else
      status = run_round(&a, progress, &done, error);
    a.tolerance *= WIDENING;
  }
  if (status == SCREE_OK && !a.reason) status = finish(&a, arrangement, error);
  *reason = a.reason;
  SCREE_FREE_ALL(a.positions.items, a.facets.items, a.edge_points.items, a.facet_points.items,
                 a.segments.items, a.joins.items, a.near.items, a.triangles.items, a.rim.items,
                 a.pieces.items, a.active.items, a.candidates.items, a.pairs.items, a.merged,
                 a.touched);
  return status;
}

void scree_arrangement_free(scree_arrangement *arrangement) {
  scree_mesh_free(&arrangement->mesh);
  scree_free(arrangement->weights);
  *arrangement = (scree_arrangement){0};
}
