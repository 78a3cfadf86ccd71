/* Normals of neighbours that point against each other: cos(180 - angle) is compared without roots.
 */
#include "mesh/repair/repair.h"

/* The square of the cosine of SCREE_LEAST_EDGE_DEG. */
static double least_cosine_squared(void) {
  double cosine = cos(SCREE_LEAST_EDGE_DEG * 3.14159265358979323846 / 180);
  return cosine * cosine;
}

bool scree_normals_are_sharp(vec3 a, vec3 b) {
  double dot = vec3_dot(a, b);
  return dot < 0 && dot * dot > least_cosine_squared() * vec3_dot(a, a) * vec3_dot(b, b);
}

bool scree_edge_is_sharp(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t h) {
  uint32_t g = adjacency->ring[h];
  if (g == SCREE_NO_HALF_EDGE || g == h || adjacency->ring[g] != h) return false;
  if (scree_half_edge_from(mesh, h) == scree_half_edge_from(mesh, g)) return false;
  return scree_normals_are_sharp(scree_facet_normal(mesh, h / 3), scree_facet_normal(mesh, g / 3));
}

size_t scree_sharp_edges(const scree_mesh *mesh, const scree_adjacency *adjacency, bool *marked) {
  size_t count = 0;
  for (size_t e = 0; e < adjacency->edge_count; e++) {
    uint32_t h = adjacency->edges[e];
    if (!scree_edge_is_sharp(mesh, adjacency, h)) continue;
    count++;
    if (marked) marked[h / 3] = marked[adjacency->ring[h] / 3] = true;
  }
  return count;
}
