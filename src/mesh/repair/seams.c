/* Closing what is open only by rounding or by careless drawing: boundary vertices a little apart,
 * vertices lying on boundary edges, facets without area.
 *
 * Seams. Boundary vertices are united in groups linked by steps within a distance that grows from
 * rounding size to the tolerance, tenfold each time. A distance is taken only if it leaves fewer
 * boundary edges, makes no edge of three or more facets and collapses no facet; and no vertex goes
 * farther than a quarter of the shortest boundary edge at it.
 *
 * T-junctions. A boundary edge that other boundary vertices lie on is split there, its facet with
 * it. Both kinds of neighbours are found by sorting along the longest axis of the boundary and
 * looking at what lies within the distance along it.
 *
 * A facet without area either has its neighbours apart by nothing (a vertex twice: a seam), or has
 * a vertex on its longest edge (a T-junction): dropped, it leaves just that behind. */
#include "base/alloc.h"
#include "base/array.h"
#include "mesh/repair/repair.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum {
  SEAM_STEPS = 6,                /* distances tried, the last the tolerance */
  NEAR_LIMIT = 64 * 1024 * 1024, /* comparisons in a sweep, then the stage gives up */
  PASSES = 32,                   /* of T-junctions: a facet has at most one edge split in each */
};

/* A vertex counts as on an edge within this share of the diagonal, and of the edge's length. */
#define ON_EDGE_DIAGONAL 1e-6
#define ON_EDGE_LENGTH   1e-3

scree_status scree_repair_flat(scree_repair *r, scree_error *error) {
  bool *marked = scree_alloc(r->mesh.triangle_count, sizeof *marked);
  if (!marked) return scree_repair_no_memory(error);
  for (size_t t = 0; t < r->mesh.triangle_count; t++) marked[t] = scree_facet_is_flat(&r->mesh, t);
  r->report.done[SCREE_REPAIR_DROP_DEGENERATE] += scree_repair_remove(r, marked);
  scree_free(marked);
  return SCREE_OK;
}

/* ---- The boundary ---- */

typedef struct rim_vertex {
  double at; /* along the sweep's axis */
  uint32_t vertex;
} rim_vertex;

typedef struct rim {
  scree_adjacency adjacency;
  rim_vertex *vertices; /* ascending along the axis */
  size_t vertex_count;
  double *reach; /* by vertex: the shortest boundary edge there, or 0 off the boundary */
  size_t edge_count, crowded_count; /* boundary edges, edges of three or more facets */
  int axis;
} rim;

static void free_rim(rim *b) {
  scree_adjacency_free(&b->adjacency);
  scree_free(b->vertices);
  scree_free(b->reach);
  *b = (rim){0};
}

static int compare_rim(const void *a, const void *b) {
  const rim_vertex *x = a, *y = b;
  if (x->at != y->at) return x->at < y->at ? -1 : 1;
  return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static vec3 place(const scree_repair *r, uint32_t v) {
  return vec3_load(r->mesh.positions + 3 * (size_t)v);
}

static void count_rim(const scree_mesh *mesh, const scree_adjacency *a, size_t *open,
                      size_t *crowded) {
  (void)mesh;
  *open = *crowded = 0;
  for (size_t e = 0; e < a->edge_count; e++) {
    uint32_t h = a->edges[e], g = a->ring[h];
    *open += g == h;
    *crowded += g != h && a->ring[g] != h;
  }
}

static void measure_rim(const scree_repair *r, rim *b) {
  const scree_mesh *m = &r->mesh;
  memset(b->reach, 0, m->vertex_count * sizeof *b->reach);
  for (size_t e = 0; e < b->adjacency.edge_count; e++) {
    uint32_t h = b->adjacency.edges[e];
    if (b->adjacency.ring[h] != h) continue;
    uint32_t ends[2] = {scree_half_edge_from(m, h), scree_half_edge_to(m, h)};
    double length = vec3_distance(place(r, ends[0]), place(r, ends[1]));
    for (int i = 0; i < 2; i++)
      if (b->reach[ends[i]] == 0 || length < b->reach[ends[i]]) b->reach[ends[i]] = length;
  }
}

static void sort_rim(const scree_repair *r, rim *b) {
  vec3 low = {DBL_MAX, DBL_MAX, DBL_MAX}, high = vec3_neg(low);
  for (uint32_t v = 0; v < r->mesh.vertex_count; v++) {
    if (b->reach[v] == 0) continue;
    b->vertices[b->vertex_count++].vertex = v;
    low = vec3_min(low, place(r, v));
    high = vec3_max(high, place(r, v));
  }
  vec3 size = vec3_sub(high, low);
  b->axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  for (size_t i = 0; i < b->vertex_count; i++)
    b->vertices[i].at = r->mesh.positions[3 * (size_t)b->vertices[i].vertex + (size_t)b->axis];
  qsort(b->vertices, b->vertex_count, sizeof *b->vertices, compare_rim);
}

static scree_status find_rim(const scree_repair *r, rim *b, scree_error *error) {
  *b = (rim){0};
  scree_status status = scree_adjacency_build(&r->mesh, &b->adjacency, error);
  if (status != SCREE_OK) return status;
  count_rim(&r->mesh, &b->adjacency, &b->edge_count, &b->crowded_count);
  if (b->edge_count == 0) return SCREE_OK;
  SCREE_ALLOC_OR(b->vertices, r->mesh.vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(b->reach, r->mesh.vertex_count, error, out_of_memory);
  measure_rim(r, b);
  sort_rim(r, b);
  return SCREE_OK;
out_of_memory:
  free_rim(b);
  return SCREE_OUT_OF_MEMORY;
}

/* ---- Seams ---- */

/* Joins boundary vertices within the distance; false where the sweep is too long. */
static bool join_near(const scree_repair *r, const rim *b, double distance, uint32_t *parent) {
  size_t work = 0;
  for (size_t i = 0; i < b->vertex_count; i++)
    for (size_t j = i + 1; j < b->vertex_count; j++) {
      if (b->vertices[j].at - b->vertices[i].at > distance) break;
      if (++work > NEAR_LIMIT) return false;
      uint32_t v = b->vertices[i].vertex, w = b->vertices[j].vertex;
      double most = fmin(distance, 0.25 * fmin(b->reach[v], b->reach[w]));
      if (vec3_distance(place(r, v), place(r, w)) <= most) scree_join(parent, v, w);
    }
  return true;
}

/* The corners as they would be; false where a facet would collapse. */
static bool remap(const scree_repair *r, uint32_t *parent, uint32_t *corners) {
  for (size_t c = 0; c < 3 * r->mesh.triangle_count; c++)
    corners[c] = scree_find_root(parent, r->mesh.triangles[c]);
  for (size_t t = 0; t < r->mesh.triangle_count; t++)
    if (scree_names_twice(corners + 3 * t)) return false;
  return true;
}

static scree_status try_distance(scree_repair *r, const rim *b, double distance, uint32_t *corners,
                                 scree_error *error) {
  scree_mesh *m = &r->mesh;
  uint32_t *parent = NULL;
  scree_status status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(parent, m->vertex_count, error, done);
  for (size_t v = 0; v < m->vertex_count; v++) parent[v] = (uint32_t)v;
  status = SCREE_OK;
  if (!join_near(r, b, distance, parent) || !remap(r, parent, corners)) goto done;
  scree_mesh joined = {m->positions, corners, m->vertex_count, m->triangle_count};
  scree_adjacency adjacency;
  status = scree_adjacency_build(&joined, &adjacency, error);
  if (status != SCREE_OK) goto done;
  size_t open, crowded;
  count_rim(&joined, &adjacency, &open, &crowded);
  scree_adjacency_free(&adjacency);
  if (open < b->edge_count && crowded <= b->crowded_count) {
    memcpy(m->triangles, corners, 3 * m->triangle_count * sizeof *corners);
    r->report.done[SCREE_REPAIR_CLOSE_SEAM] += b->edge_count - open;
    r->report.seam_distance = distance;
  }
done:
  scree_free(parent);
  return status;
}

scree_status scree_repair_seams(scree_repair *r, scree_error *error) {
  double tolerance = r->options->seam_tolerance;
  uint32_t *corners = NULL;
  scree_status status = SCREE_OK;
  if (tolerance <= 0) return SCREE_OK;
  SCREE_ALLOC_OR(corners, 3 * r->mesh.triangle_count, error, out_of_memory);
  for (int step = 0; step < SEAM_STEPS && status == SCREE_OK; step++) {
    rim b;
    status = find_rim(r, &b, error);
    if (status != SCREE_OK) break;
    bool closed = b.edge_count == 0;
    double distance = tolerance * r->diagonal * pow(10, step + 1 - SEAM_STEPS);
    if (!closed) status = try_distance(r, &b, distance, corners, error);
    free_rim(&b);
    if (closed) break;
  }
  scree_free(corners);
  return status;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

/* ---- T-junctions ---- */

/* A vertex on half-edge h, at share s of its length. */
typedef struct junction {
  uint32_t half_edge, vertex;
  double share;
} junction;

typedef struct junctions {
  junction *items;
  size_t count, capacity;
} junctions;

static int compare_junctions(const void *a, const void *b) {
  const junction *x = a, *y = b;
  if (x->half_edge != y->half_edge) return x->half_edge < y->half_edge ? -1 : 1;
  if (x->share != y->share) return x->share < y->share ? -1 : 1;
  return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static size_t first_from(const rim *b, double at) {
  size_t low = 0, high = b->vertex_count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (b->vertices[middle].at < at)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static bool find_on_edge(const scree_repair *r, const rim *b, uint32_t h, size_t *work,
                         junctions *found) {
  uint32_t from = scree_half_edge_from(&r->mesh, h), to = scree_half_edge_to(&r->mesh, h);
  uint32_t apex = r->mesh.triangles[scree_half_edge_previous(h)];
  vec3 a = place(r, from), edge = vec3_sub(place(r, to), a);
  double length = vec3_norm(edge);
  double near = fmin(ON_EDGE_DIAGONAL * r->diagonal, ON_EDGE_LENGTH * length);
  double at_a = r->mesh.positions[3 * (size_t)from + (size_t)b->axis],
         at_b = r->mesh.positions[3 * (size_t)to + (size_t)b->axis];
  double end = fmax(at_a, at_b) + near;
  for (size_t i = first_from(b, fmin(at_a, at_b) - near); i < b->vertex_count; i++) {
    uint32_t v = b->vertices[i].vertex;
    if (b->vertices[i].at > end || ++*work > NEAR_LIMIT) break;
    if (v == from || v == to || v == apex) continue;
    vec3 d = vec3_sub(place(r, v), a);
    double share = vec3_dot(d, edge) / (length * length);
    if (share * length <= near || (1 - share) * length <= near) continue;
    if (vec3_norm(vec3_mad(d, edge, -share)) > near) continue;
    if (!SCREE_PUSH(found, (junction){h, v, share})) return false;
  }
  return true;
}

/* Splits the facet of the junctions' common half-edge into a fan from its apex. */
static bool split_facet(scree_repair *r, const junction *on, size_t count) {
  uint32_t h = on[0].half_edge, from = r->mesh.triangles[h];
  uint32_t to = scree_half_edge_to(&r->mesh, h);
  uint32_t apex = r->mesh.triangles[scree_half_edge_previous(h)];
  uint32_t *corner = r->mesh.triangles + h / 3 * 3;
  corner[0] = from, corner[1] = on[0].vertex, corner[2] = apex;
  for (size_t i = 0; i < count; i++) {
    uint32_t next = i + 1 < count ? on[i + 1].vertex : to;
    if (!scree_repair_add_facet(r, on[i].vertex, next, apex)) return false;
  }
  return true;
}

static bool split_all(scree_repair *r, const junctions *found, size_t *split_count) {
  uint32_t last_facet = UINT32_MAX;
  for (size_t i = 0; i < found->count;) {
    size_t end = i + 1;
    while (end < found->count && found->items[end].half_edge == found->items[i].half_edge) end++;
    uint32_t facet = found->items[i].half_edge / 3;
    if (facet != last_facet) {
      if (!split_facet(r, found->items + i, end - i)) return false;
      *split_count += end - i;
    }
    last_facet = facet;
    i = end;
  }
  return true;
}

static scree_status pass(scree_repair *r, size_t *split_count, scree_error *error) {
  rim b;
  junctions found = {0};
  size_t work = 0;
  bool room = true;
  scree_status status = find_rim(r, &b, error);
  *split_count = 0;
  if (status != SCREE_OK || b.edge_count == 0) {
    free_rim(&b);
    return status;
  }
  for (size_t e = 0; e < b.adjacency.edge_count && work <= NEAR_LIMIT; e++) {
    uint32_t h = b.adjacency.edges[e];
    if (b.adjacency.ring[h] == h) room = find_on_edge(r, &b, h, &work, &found);
    if (room) status = scree_repair_growth(r, r->mesh.triangle_count + found.count, error);
    if (!room || status != SCREE_OK) break;
  }
  if (room && status == SCREE_OK && work <= NEAR_LIMIT && found.count) {
    qsort(found.items, found.count, sizeof *found.items, compare_junctions);
    room = split_all(r, &found, split_count);
  }
  if (!room) status = scree_repair_no_memory(error);
  scree_free(found.items);
  free_rim(&b);
  return status;
}

scree_status scree_repair_t_junctions(scree_repair *r, scree_error *error) {
  scree_status status = SCREE_OK;
  size_t split_count = 1;
  for (int i = 0; i < PASSES && split_count && status == SCREE_OK; i++) {
    status = pass(r, &split_count, error);
    r->report.done[SCREE_REPAIR_SPLIT_T_JUNCTION] += split_count;
  }
  return status;
}
