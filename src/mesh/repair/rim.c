/* Vertices near an edge are found by sorting along the longest axis of the boundary and looking at
 * what lies within the distance along it. */
#include "mesh/repair/rim.h"

#include "base/array.h"
#include "base/radix.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

void scree_rim_free(scree_rim *rim) {
  scree_adjacency_free(&rim->adjacency);
  scree_free(rim->vertices);
  scree_free(rim->reach);
  *rim = (scree_rim){0};
}

SCREE_ORDER_BY2(compare_rim, scree_rim_vertex, at, vertex)

void scree_rim_count(const scree_adjacency *a, size_t *open, size_t *crowded) {
  *open = *crowded = 0;
  for (size_t e = 0; e < a->edge_count; e++) {
    uint32_t h = a->edges[e], g = a->ring[h];
    *open += g == h;
    *crowded += g != h && a->ring[g] != h;
  }
}

static void measure_rim(const scree_mesh *m, scree_rim *b) {
  memset(b->reach, 0, m->vertex_count * sizeof *b->reach);
  for (size_t e = 0; e < b->adjacency.edge_count; e++) {
    uint32_t h = b->adjacency.edges[e];
    if (b->adjacency.ring[h] != h) continue;
    uint32_t ends[2] = {scree_half_edge_from(m, h), scree_half_edge_to(m, h)};
    double length = vec3_distance(scree_mesh_vertex(m, ends[0]), scree_mesh_vertex(m, ends[1]));
    for (int i = 0; i < 2; i++)
      if (b->reach[ends[i]] == 0 || length < b->reach[ends[i]]) b->reach[ends[i]] = length;
  }
}

static void sort_rim(const scree_mesh *m, scree_rim *b) {
  vec3 low = {DBL_MAX, DBL_MAX, DBL_MAX}, high = vec3_neg(low);
  for (uint32_t v = 0; v < m->vertex_count; v++) {
    if (b->reach[v] == 0) continue;
    b->vertices[b->vertex_count++].vertex = v;
    low = vec3_min(low, scree_mesh_vertex(m, v));
    high = vec3_max(high, scree_mesh_vertex(m, v));
  }
  vec3 size = vec3_sub(high, low);
  b->axis = vec3_greatest(size);
  for (size_t i = 0; i < b->vertex_count; i++)
    b->vertices[i].at = m->positions[3 * (size_t)b->vertices[i].vertex + (size_t)b->axis];
  qsort(b->vertices, b->vertex_count, sizeof *b->vertices, compare_rim);
}

scree_status scree_rim_find(const scree_mesh *mesh, scree_rim *b, scree_error *error) {
  *b = (scree_rim){0};
  SCREE_TRY(scree_adjacency_build(mesh, &b->adjacency, error));
  scree_rim_count(&b->adjacency, &b->edge_count, &b->crowded_count);
  if (b->edge_count == 0) return SCREE_OK;
  SCREE_TRY_ALLOC(b->vertices, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(b->reach, mesh->vertex_count, error);
  measure_rim(mesh, b);
  sort_rim(mesh, b);
  return SCREE_OK;
}

/* ---- T-junctions ---- */

SCREE_ORDER_BY3(compare_junctions, scree_junction, half_edge, share, vertex)

static bool find_on_edge(const scree_mesh *m, const scree_rim *b, const scree_junction_rule *rule,
                         uint32_t h, size_t *work, scree_junctions *found) {
  uint32_t from = scree_half_edge_from(m, h), to = scree_half_edge_to(m, h);
  uint32_t apex = m->triangles[scree_half_edge_previous(h)];
  vec3 a = scree_mesh_vertex(m, from), edge = vec3_sub(scree_mesh_vertex(m, to), a);
  double length = vec3_norm(edge);
  double near = fmin(rule->distance, rule->share * length);
  double at_a = m->positions[3 * (size_t)from + (size_t)b->axis],
         at_b = m->positions[3 * (size_t)to + (size_t)b->axis];
  double begin = fmin(at_a, at_b) - near, end = fmax(at_a, at_b) + near;
  SCREE_FIND_FIRST(i, 0, b->vertex_count, b->vertices[i].at < begin)
  for (; i < b->vertex_count; i++) {
    uint32_t v = b->vertices[i].vertex;
    if (b->vertices[i].at > end || ++*work > rule->most) break;
    if (v == from || v == to || v == apex) continue;
    vec3 d = vec3_sub(scree_mesh_vertex(m, v), a);
    double share = vec3_dot(d, edge) / (length * length);
    if (share * length <= near || (1 - share) * length <= near) continue;
    if (vec3_norm(vec3_mad(d, edge, -share)) > near) continue;
    if (!SCREE_PUSH(found, (scree_junction){h, v, share})) return false;
  }
  return true;
}

scree_status scree_junctions_find(const scree_mesh *mesh, const scree_junction_rule *rule,
                                  scree_junctions *found, scree_error *error) {
  SCREE_CLEANUP(scree_rim_free) scree_rim rim = {0};
  size_t work = 0;
  SCREE_TRY(scree_rim_find(mesh, &rim, error));
  for (size_t e = 0; e < rim.adjacency.edge_count && work <= rule->most; e++) {
    uint32_t h = rim.adjacency.edges[e];
    if (rim.adjacency.ring[h] == h && !find_on_edge(mesh, &rim, rule, h, &work, found))
      return scree_fail_memory(error, found->capacity * sizeof *found->items, "T-junctions");
  }
  if (work > rule->most) found->count = 0;
  if (found->count) qsort(found->items, found->count, sizeof *found->items, compare_junctions);
  return SCREE_OK;
}

size_t scree_junctions_split(scree_mesh *mesh, const scree_junctions *found) {
  size_t before = mesh->triangle_count;
  uint32_t *corners = mesh->triangles, last = UINT32_MAX; /* facet */
  for (size_t i = 0; i < found->count;) {
    uint32_t half = found->items[i].half_edge, next = scree_half_edge_next(half);
    uint32_t end = corners[next], top = corners[scree_half_edge_previous(half)];
    uint32_t *shortened = &corners[next]; /* the corner that the next vertex along cuts off */
    for (; i < found->count && found->items[i].half_edge == half; i++) {
      if (half / 3 == last) continue; /* in the next pass */
      uint32_t at = found->items[i].vertex, *fan = corners + 3 * mesh->triangle_count++;
      *shortened = at;
      fan[0] = at, fan[1] = end, fan[2] = top;
      shortened = &fan[1];
    }
    last = half / 3;
  }
  return mesh->triangle_count - before;
}
