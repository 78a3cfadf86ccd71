/* A constrained Delaunay triangulation of the face's vertices and edges within three corners far
 * around them. What lies left of the edges, and hangs together across none of them, is a polygon:
 * holes, and faces of several parts, need no case. */
#include "mesh/fracture/polygon.h"
#include "base/array.h"
#include "mesh/adjacency.h"
#include "mesh/mesh.h"

/* Of the far corners, in sizes of the face. */
static const double far_away = 10;

/* Vertices are numbered by the edge that leaves them; behind them come the far corners. */
typedef struct face {
  size_t count;
  const scree_cut_edge *edges;
  vec3 normal;
  double *positions;
  uint32_t *segments; /* from and to of each edge */
  uint32_t *inner;
} face;

void scree_polygons_free(scree_polygons *polygons) {
  scree_free(polygons->corners.items);
  scree_free(polygons->list.items);
  scree_facet_cutter_free(polygons->cutter);
  *polygons = (scree_polygons){.list = {0}};
}

static bool is_edge(const face *f, uint32_t from, uint32_t to) {
  return from < f->count && f->segments[2 * (size_t)from + 1] == to;
}

/* False where an edge does not lead from one vertex to another, or two leave one. */
static bool number(scree_cutter *c, face *f) {
  scree_cut_vertex *vertices = c->vertices.items;
  uint32_t stamp = scree_cut_stamp(c);
  for (size_t e = 0; e < f->count; e++) {
    scree_cut_vertex *v = &vertices[f->edges[e].from];
    if (v->stamp == stamp) return false;
    v->stamp = stamp;
    v->value = f->segments[2 * e] = f->inner[e] = (uint32_t)e;
    vec3_store(f->positions + 3 * e, v->at);
  }
  for (size_t e = 0; e < f->count; e++) {
    const scree_cut_vertex *v = &vertices[f->edges[e].to];
    if (v->stamp != stamp) return false;
    f->segments[2 * e + 1] = v->value;
  }
  return true;
}

static void surround(face *f) {
  static const double at[3][2] = {{1, 0}, {-0.5, 0.87}, {-0.5, -0.87}};
  scree_box box = scree_box_of_points(f->positions, f->count);
  double reach = far_away * vec3_distance(box.low, box.high);
  vec3 middle = vec3_lerp(box.low, box.high, 0.5), u, w;
  vec3_frame(f->normal, &u, &w);
  for (size_t k = 0; k < 3; k++)
    vec3_store(f->positions + 3 * (f->count + k),
               vec3_mad(vec3_mad(middle, u, reach * at[k][0]), w, reach * at[k][1]));
}

/* Joins triangles across what is no edge of the face; inside: by root, left of an edge. False where
 * an edge is missing, or the inside is not all around closed by edges. */
static bool find_inside(const face *f, const scree_mesh *all, const scree_adjacency *adjacency,
                        uint32_t *parent, bool *inside) {
  size_t found = 0;
  bool closed = true;
  for (uint32_t t = 0; t < all->triangle_count; t++) parent[t] = t;
  for (int pass = 0; pass < 3; pass++)
    for (uint32_t h = 0; h < 3 * all->triangle_count; h++) {
      uint32_t from = scree_half_edge_from(all, h), to = scree_half_edge_to(all, h);
      bool left = is_edge(f, from, to), right = is_edge(f, to, from);
      if (pass == 0 && !left && !right) scree_join(parent, h / 3, adjacency->ring[h] / 3);
      if (pass == 1 && left) inside[scree_find_root(parent, h / 3)] = true, found++;
      if (pass == 2 && (right || from >= f->count))
        closed &= !inside[scree_find_root(parent, h / 3)];
    }
  return found == f->count && closed;
}

static scree_status add_polygons(const face *f, const scree_mesh *all, uint32_t *parent,
                                 const bool *inside, scree_polygons *polygons, scree_error *error) {
  for (uint32_t root = 0; root < all->triangle_count; root++) {
    scree_polygon made = {.first = (uint32_t)(polygons->corners.count / 3)};
    if (!inside[root]) continue;
    for (uint32_t t = root; t < all->triangle_count; t++) {
      if (scree_find_root(parent, t) != root) continue;
      made.count++;
      made.area += 0.5 * vec3_dot(f->normal, scree_facet_normal(all, t));
      for (size_t k = 0; k < 3; k++)
        SCREE_TRY_PUSH(&polygons->corners, error, f->edges[all->triangles[3 * (size_t)t + k]].from);
    }
    SCREE_TRY_PUSH(&polygons->list, error, made);
  }
  return SCREE_OK;
}

static scree_status triangulate(const face *f, scree_polygons *polygons, bool *doubtful,
                                scree_error *error) {
  SCREE_CLEANUP(scree_free_at) uint32_t *triangles = NULL;
  scree_index_list list = {0};
  uint32_t n = (uint32_t)f->count;
  const scree_facet_job job = {.positions = f->positions,
                               .corner = {n, n + 1, n + 2},
                               .inner = f->inner,
                               .inner_count = n,
                               .segments = f->segments,
                               .segment_count = n};
  if (!polygons->cutter) polygons->cutter = scree_facet_cutter_create();
  bool cut = polygons->cutter && scree_facet_cut(polygons->cutter, &job, &list);
  triangles = list.items;
  if (!cut) return scree_fail_memory(error, 0, "triangles");
  const scree_mesh all = {f->positions, triangles, n + 3, list.count / 3};
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_SCRATCH(uint32_t, parent, all.triangle_count, error);
  SCREE_SCRATCH_ZERO(bool, inside, all.triangle_count, error);
  SCREE_TRY(scree_adjacency_build(&all, &adjacency, error));
  *doubtful |= !find_inside(f, &all, &adjacency, parent, inside);
  return *doubtful ? SCREE_OK : add_polygons(f, &all, parent, inside, polygons, error);
}

scree_status scree_polygons_add(scree_cutter *c, const scree_cut_edge *edges, size_t count,
                                vec3 normal, scree_polygons *polygons, bool *doubtful,
                                scree_error *error) {
  SCREE_SCRATCH(double, positions, 3 * (count + 3), error);
  SCREE_SCRATCH(uint32_t, segments, 2 * count, error);
  SCREE_SCRATCH(uint32_t, inner, count, error);
  face f = {count, edges, normal, positions, segments, inner};
  *doubtful |= !number(c, &f);
  surround(&f);
  return *doubtful ? SCREE_OK : triangulate(&f, polygons, doubtful, error);
}
