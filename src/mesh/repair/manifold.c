/* Making a manifold of what the facets form: fins, non-manifold edges, winding, vertices.
 *
 * Fins. Cut at all edges of three or more facets, the mesh falls into patches. A patch that has
 * both such an edge and a boundary is a sheet hanging on the surface and is dropped, but for the
 * largest patch of all, which is the surface.
 *
 * Edges of four or more facets, half of them running either way: facets are sorted by angle round
 * the edge, and each is joined to the neighbour across the material between them, so that bodies
 * that only touch come apart (after Gueziec, Taubin, Lazarus and Horn, "Cutting and stitching",
 * IEEE TVCG 7 (2001), with the pairing by material instead of by order). Where that is impossible
 * nothing is joined and the edge opens.
 *
 * Vertices. Corners joined through joined edges form fans; every fan at a vertex beyond the first
 * gets a copy of the vertex, and all of these fans draw back a little from each other, so that
 * the parts do not touch, also not after rounding to the 24 bits of an STL file.
 *
 * Winding. Neighbours across edges of two facets are turned to agree, piece by piece; of each piece
 * the smaller area is turned. */
#include "base/alloc.h"
#include "base/radix.h"
#include "mesh/repair/repair.h"

#include <stdlib.h>
#include <string.h>

/* How far a fan draws back: this share of the mean length of its edges, and at least this share of
 * the largest coordinate (16 roundings of single precision), but never more than this share of the
 * edges, so that the shape stays; far from the origin single precision then may not hold it. */
#define DRAW_BACK_EDGE       1e-4
#define DRAW_BACK_COORDINATE 1e-6
#define DRAW_BACK_MOST       0.01

#define NO_HALF_EDGE SCREE_NO_HALF_EDGE

static size_t ring_size(const scree_adjacency *adjacency, uint32_t h) {
  return adjacency->ring[h] == NO_HALF_EDGE ? 0 : scree_edge_facet_count(adjacency, h);
}

/* ---- Fins ---- */

static void mark_fins(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t *patch,
                      uint8_t *traits) {
  const uint32_t *ring = adjacency->ring;
  memset(traits, 0, mesh->triangle_count);
  scree_join_over_edges(mesh, adjacency, true, patch);
  for (size_t e = 0; e < adjacency->edge_count; e++) {
    uint32_t first = adjacency->edges[e], h = first;
    size_t count = ring_size(adjacency, first);
    if (count == 2) continue;
    do {
      traits[scree_find_root(patch, h / 3)] |= count == 1 ? 1 : 2;
      h = ring[h];
    } while (h != first);
  }
}

/* The root of the patch of the largest area. */
static scree_status largest_patch(const scree_mesh *mesh, uint32_t *patch, uint32_t *largest,
                                  scree_error *error) {
  SCREE_SCRATCH_ZERO(double, area, mesh->triangle_count, error);
  *largest = 0;
  for (uint32_t t = 0; t < mesh->triangle_count; t++)
    area[scree_find_root(patch, t)] += vec3_norm(scree_facet_normal(mesh, t));
  for (uint32_t t = 0; t < mesh->triangle_count; t++)
    if (area[t] > area[*largest]) *largest = t;
  return SCREE_OK;
}

scree_status scree_repair_fins(scree_repair *r, scree_error *error) {
  size_t removed = 1;
  SCREE_SCRATCH(uint32_t, patch, r->mesh.triangle_count, error);
  SCREE_SCRATCH(uint8_t, traits, r->mesh.triangle_count, error);
  SCREE_SCRATCH(bool, marked, r->mesh.triangle_count, error);
  /* dropping a fin may make another's edge a boundary */
  for (int round = 0; round < 16 && removed; round++) {
    SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
    SCREE_TRY(scree_adjacency_build(&r->mesh, &adjacency, error));
    uint32_t largest = 0;
    mark_fins(&r->mesh, &adjacency, patch, traits);
    SCREE_TRY(largest_patch(&r->mesh, patch, &largest, error));
    traits[largest] = 0;
    for (size_t t = 0; t < r->mesh.triangle_count; t++)
      marked[t] = traits[scree_find_root(patch, (uint32_t)t)] == 3;
    removed = scree_facets_drop(&r->mesh, marked);
    r->report.done[SCREE_REPAIR_DROP_FIN] += removed;
  }
  return SCREE_OK;
}

/* ---- Pairing the facets at edges ---- */

SCREE_ORDER_BY2(compare_spokes, scree_spoke, angle, half_edge)

bool scree_repair_spokes(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t first,
                         scree_spoke *spokes, int count) {
  uint32_t low = scree_half_edge_from(mesh, first), high = scree_half_edge_to(mesh, first);
  vec3 origin = vec3_load(mesh->positions + 3 * (size_t)low);
  vec3 axis = vec3_unit(vec3_sub(vec3_load(mesh->positions + 3 * (size_t)high), origin));
  vec3 u = {0, 0, 0}, v = {0, 0, 0};
  uint32_t h = first;
  int along = 0;
  for (int i = 0; i < count; i++, h = adjacency->ring[h]) {
    uint32_t apex = mesh->triangles[scree_half_edge_previous(h)];
    vec3 arm = vec3_sub(vec3_load(mesh->positions + 3 * (size_t)apex), origin);
    arm = vec3_mad(arm, axis, -vec3_dot(arm, axis));
    if (i == 0) u = vec3_unit(arm), v = vec3_cross(axis, u);
    spokes[i] = (scree_spoke){h, i == 0 ? 0 : atan2(vec3_dot(arm, v), vec3_dot(arm, u)),
                              scree_half_edge_from(mesh, h) == low};
    along += spokes[i].along;
  }
  qsort(spokes, (size_t)count, sizeof *spokes, compare_spokes);
  return 2 * along == count;
}

/* Angles grow counter-clockwise about the axis. A facet running against the axis has its outer side
 * towards smaller angles, so material follows it, up to a facet that runs along the axis. */
static bool pair_spokes(const scree_spoke *spokes, int count, uint32_t *twin) {
  for (int i = 0; i < count; i++)
    if (spokes[i].along == spokes[(i + 1) % count].along) return false;
  for (int i = 0; i < count; i++) {
    if (spokes[i].along) continue;
    uint32_t a = spokes[i].half_edge, b = spokes[(i + 1) % count].half_edge;
    twin[a] = b;
    twin[b] = a;
  }
  return true;
}

/* twin[h]: the half-edge that h is joined to, or none; marks the vertices of edges that come apart
 * in `loose`. Returns how many edges of three or more facets there were. */
static size_t pair_edges(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t *twin,
                         bool *loose) {
  size_t split = 0;
  for (size_t h = 0; h < 3 * mesh->triangle_count; h++) twin[h] = NO_HALF_EDGE;
  for (size_t e = 0; e < adjacency->edge_count; e++) {
    uint32_t h = adjacency->edges[e], g = adjacency->ring[h];
    scree_spoke spokes[SCREE_EDGE_FACETS];
    if (g == h) continue;
    if (adjacency->ring[g] == h) {
      twin[h] = g, twin[g] = h;
      continue;
    }
    split++;
    loose[scree_half_edge_from(mesh, h)] = loose[scree_half_edge_to(mesh, h)] = true;
    size_t count = scree_edge_facet_count(adjacency, h);
    if (count <= SCREE_EDGE_FACETS && scree_repair_spokes(mesh, adjacency, h, spokes, (int)count))
      pair_spokes(spokes, (int)count, twin);
  }
  return split;
}

/* ---- Fans ---- */

/* Corners joined through twins, as sets; fan[c] is the lowest corner of c's fan. Corner h is where
 * half-edge h starts. */
static void find_fans(const scree_mesh *mesh, const uint32_t *twin, uint32_t *fan) {
  size_t corner_count = 3 * mesh->triangle_count;
  for (size_t c = 0; c < corner_count; c++) fan[c] = (uint32_t)c;
  for (uint32_t h = 0; h < corner_count; h++) {
    uint32_t g = twin[h];
    if (g == NO_HALF_EDGE || g < h) continue;
    bool opposite = mesh->triangles[h] != mesh->triangles[g];
    scree_join(fan, h, opposite ? scree_half_edge_next(g) : g);
    scree_join(fan, scree_half_edge_next(h), opposite ? g : scree_half_edge_next(g));
  }
  for (uint32_t c = 0; c < corner_count; c++) fan[c] = scree_find_root(fan, c);
}

/* Where the fan's vertex goes to draw back towards its own neighbours. */
typedef struct retreat {
  vec3 sum; /* of the neighbours' offsets from the vertex */
  double length;
  size_t count;
} retreat;

static vec3 retreat_from(const scree_repair *r, vec3 at, const retreat *back) {
  if (back->count == 0) return at;
  double mean = back->length / (double)back->count;
  double step =
      fmax(DRAW_BACK_EDGE * mean, fmin(DRAW_BACK_COORDINATE * r->largest, DRAW_BACK_MOST * mean));
  return vec3_mad(at, vec3_unit(back->sum), step);
}

typedef struct splitter {
  uint32_t *fan;      /* by corner */
  uint32_t *vertex;   /* by corner that is its fan's lowest: the fan's vertex */
  uint8_t *fan_count; /* by vertex, at most 2 */
} splitter;

/* Gives each fan beyond the first a vertex of its own, at vertices with `only` (NULL: at all). */
static bool separate_fans(scree_repair *r, splitter *s, const bool *only, size_t *split_count) {
  uint32_t *triangles = r->mesh.triangles;
  size_t corner_count = 3 * r->mesh.triangle_count;
  for (size_t c = 0; c < corner_count; c++) {
    uint32_t v = triangles[c], root = s->fan[c];
    if (root == c) {
      s->vertex[c] = v;
      bool apart = !only || only[v];
      if (apart && s->fan_count[v] > 0) {
        *split_count += s->fan_count[v] == 1;
        if (!scree_repair_add_vertex(r, r->mesh.positions + 3 * (size_t)v, &s->vertex[c]))
          return false;
      }
      if (apart && s->fan_count[v] < 2) s->fan_count[v]++;
    }
  }
  return true;
}

/* Moves the vertices of all fans at split vertices. */
static scree_status draw_back(scree_repair *r, const splitter *s, size_t old_vertex_count,
                              scree_error *error) {
  scree_mesh *m = &r->mesh;
  SCREE_SCRATCH_ZERO(retreat, back, m->vertex_count, error);
  for (size_t c = 0; c < 3 * m->triangle_count; c++) {
    uint32_t v = m->triangles[c];
    if (v < old_vertex_count && s->fan_count[v] < 2) continue;
    size_t t = c / 3 * 3;
    for (size_t k = 0; k < 3; k++) {
      if (t + k == c) continue;
      vec3 d = vec3_sub(vec3_load(m->positions + 3 * (size_t)m->triangles[t + k]),
                        vec3_load(m->positions + 3 * (size_t)v));
      back[v].sum = vec3_add(back[v].sum, d);
      back[v].length += vec3_norm(d);
      back[v].count++;
    }
  }
  for (size_t v = 0; v < m->vertex_count; v++)
    if (back[v].count) {
      double *at = m->positions + 3 * v;
      vec3_store(at, retreat_from(r, vec3_load(at), &back[v]));
    }
  return SCREE_OK;
}

static scree_status split_fans(scree_repair *r, const uint32_t *twin, const bool *only,
                               size_t *split_count, scree_error *error) {
  size_t corner_count = 3 * r->mesh.triangle_count, old_vertex_count = r->mesh.vertex_count;
  SCREE_SCRATCH(uint32_t, fan, corner_count, error);
  SCREE_SCRATCH(uint32_t, vertex, corner_count, error);
  SCREE_SCRATCH_ZERO(uint8_t, fan_count, old_vertex_count, error);
  splitter s = {fan, vertex, fan_count};
  find_fans(&r->mesh, twin, fan);
  if (!separate_fans(r, &s, only, split_count)) return scree_repair_no_memory(error);
  for (size_t c = 0; c < corner_count; c++) r->mesh.triangles[c] = vertex[fan[c]];
  return *split_count ? draw_back(r, &s, old_vertex_count, error) : SCREE_OK;
}

static scree_status split(scree_repair *r, bool at_edges_only, scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  size_t vertex_count = 0;
  SCREE_TRY(scree_adjacency_build(&r->mesh, &adjacency, error));
  SCREE_SCRATCH(uint32_t, twin, 3 * r->mesh.triangle_count, error);
  SCREE_SCRATCH_ZERO(bool, loose, r->mesh.vertex_count, error);
  size_t edge_count = pair_edges(&r->mesh, &adjacency, twin, loose);
  if (edge_count || !at_edges_only)
    SCREE_TRY(split_fans(r, twin, at_edges_only ? loose : NULL, &vertex_count, error));
  r->report.done[SCREE_REPAIR_SPLIT_EDGE] += edge_count;
  if (!at_edges_only) r->report.done[SCREE_REPAIR_SPLIT_VERTEX] += vertex_count;
  return SCREE_OK;
}

scree_status scree_repair_edges(scree_repair *r, scree_error *error) {
  return split(r, true, error);
}

scree_status scree_repair_vertices(scree_repair *r, scree_error *error) {
  return split(r, false, error);
}

/* ---- Winding ---- */

typedef struct wind {
  const scree_mesh *mesh;
  const uint32_t *ring;
  uint8_t *turned; /* 0 not reached, 1 as is, 2 turned */
  uint32_t *queue;
} wind;

/* Floods the piece of facet `start`; the facets reached lie in queue[0 .. count). */
static size_t flood(wind *w, uint32_t start, double area[3]) {
  size_t count = 1;
  w->queue[0] = start;
  w->turned[start] = 1;
  for (size_t i = 0; i < count; i++) {
    uint32_t t = w->queue[i];
    area[w->turned[t]] += 0.5 * vec3_norm(scree_facet_normal(w->mesh, t));
    for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
      uint32_t g = w->ring[h];
      if (g == NO_HALF_EDGE || g == h || w->ring[g] != h || w->turned[g / 3]) continue;
      bool agree = w->mesh->triangles[h] != w->mesh->triangles[g];
      w->turned[g / 3] = agree ? w->turned[t] : (uint8_t)(3 - w->turned[t]);
      w->queue[count++] = g / 3;
    }
  }
  return count;
}

scree_status scree_repair_winding(scree_repair *r, scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_TRY(scree_adjacency_build(&r->mesh, &adjacency, error));
  SCREE_SCRATCH_ZERO(uint8_t, turned, r->mesh.triangle_count, error);
  SCREE_SCRATCH(uint32_t, queue, r->mesh.triangle_count, error);
  wind w = {&r->mesh, adjacency.ring, turned, queue};
  for (uint32_t t = 0; t < r->mesh.triangle_count; t++) {
    double area[3] = {0, 0, 0};
    if (turned[t]) continue;
    size_t count = flood(&w, t, area);
    uint8_t wrong = area[2] > area[1] ? 1 : 2;
    for (size_t i = 0; i < count; i++) {
      if (turned[queue[i]] != wrong) continue;
      scree_corners_turn(r->mesh.triangles + 3 * (size_t)queue[i]);
      r->report.done[SCREE_REPAIR_TURN]++;
    }
  }
  return SCREE_OK;
}
