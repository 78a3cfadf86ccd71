/* Sheets: the surface moved to both sides along the mean normals of its vertices, and closed along
 * its boundary. */
#include "base/alloc.h"
#include "mesh/adjacency.h"
#include "mesh/mesh.h"

static scree_status check_edges(const scree_mesh *sheet, const scree_adjacency *adjacency,
                                scree_error *error) {
  for (uint32_t h = 0; h < 3 * sheet->triangle_count; h++) {
    uint32_t g = adjacency->ring[h];
    if (g != SCREE_NO_HALF_EDGE &&
        (g == h || (adjacency->ring[g] == h &&
                    scree_half_edge_from(sheet, g) == scree_half_edge_to(sheet, h))))
      continue;
    vec3 at = scree_mesh_vertex(sheet, scree_half_edge_from(sheet, h));
    return scree_fail(
        error, SCREE_BAD_MESH,
        "no sheet: at (%.4g, %.4g, %.4g) mm more than two facets share an edge, or two "
        "are wound unlike",
        at.x * 1e3, at.y * 1e3, at.z * 1e3);
  }
  return SCREE_OK;
}

static void find_normals(const scree_mesh *sheet, vec3 *normals) {
  for (size_t t = 0; t < sheet->triangle_count; t++)
    for (int k = 0; k < 3; k++) {
      vec3 *n = &normals[sheet->triangles[3 * t + (size_t)k]];
      *n = vec3_add(*n, scree_facet_normal(sheet, t));
    }
  for (size_t v = 0; v < sheet->vertex_count; v++) normals[v] = vec3_unit(normals[v]);
}

static void fill(const scree_mesh *sheet, const scree_adjacency *adjacency, const vec3 *normals,
                 double half, scree_mesh *solid) {
  size_t vertices = sheet->vertex_count, n = 0;
  uint32_t *to = solid->triangles, below = (uint32_t)vertices;
  for (size_t v = 0; v < vertices; v++)
    for (int side = 0; side < 2; side++)
      vec3_store(solid->positions + 3 * (v + (side ? vertices : 0)),
                 vec3_mad(scree_mesh_vertex(sheet, v), normals[v], side ? -half : half));
  for (size_t t = 0; t < sheet->triangle_count; t++)
    for (int side = 0; side < 2; side++, n += 3) {
      for (size_t k = 0; k < 3; k++) to[n + k] = sheet->triangles[3 * t + k] + (side ? below : 0);
      if (side) scree_corners_turn(to + n);
    }
  for (uint32_t h = 0; h < 3 * sheet->triangle_count; h++) {
    if (adjacency->ring[h] != h) continue;
    uint32_t a = scree_half_edge_from(sheet, h), b = scree_half_edge_to(sheet, h);
    const uint32_t rim[6] = {a, a + below, b, b, a + below, b + below};
    memcpy(to + n, rim, sizeof rim);
    n += 6;
  }
  solid->triangle_count = n / 3;
}

scree_status scree_mesh_thicken(const scree_mesh *sheet, double thickness, scree_mesh *solid,
                                scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_CLEANUP(scree_mesh_free) scree_mesh made = {0};
  SCREE_TRY(scree_mesh_verify(sheet, error));
  if (!(thickness > 0 && isfinite(thickness)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "a thickness of %g m: must be above 0", thickness);
  SCREE_SCRATCH_ZERO(vec3, normals, sheet->vertex_count, error);
  SCREE_TRY(scree_adjacency_build(sheet, &adjacency, error));
  SCREE_TRY(check_edges(sheet, &adjacency, error));
  SCREE_TRY(scree_mesh_make(2 * sheet->vertex_count, 8 * sheet->triangle_count, &made, error));
  find_normals(sheet, normals);
  fill(sheet, &adjacency, normals, 0.5 * thickness, &made);
  SCREE_TRY(scree_mesh_canonicalize(&made, error));
  *solid = made;
  made = (scree_mesh){0};
  return SCREE_OK;
}
