/* A mesh for ParaView with the fields that people look at: area and distance to the scan. */
#include "base/owned.h"
#include "base/vec.h"

#include <math.h>

static void measure_areas(const scree_mesh *mesh, double *area, double *centroids,
                          double *vertex_area) {
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const uint32_t *corner = mesh->triangles + 3 * t;
    vec3 a = vec3_load(mesh->positions + 3 * (size_t)corner[0]);
    vec3 b = vec3_load(mesh->positions + 3 * (size_t)corner[1]);
    vec3 c = vec3_load(mesh->positions + 3 * (size_t)corner[2]);
    area[t] = 0.5 * vec3_norm(vec3_triangle_normal(a, b, c));
    vec3_store(centroids + 3 * t, vec3_scale(vec3_add(vec3_add(a, b), c), 1.0 / 3));
    for (int k = 0; k < 3; k++) vertex_area[corner[k]] += area[t] / 3;
  }
}

scree_status scree_mesh_vtp_write(const scree_mesh *mesh, const scree_mesh *reference,
                                  const char *path, bool overwrite, scree_error *error) {
  SCREE_TRY(scree_mesh_area_volume(mesh, NULL, NULL, error)); /* refuses bad indices */
  SCREE_SCRATCH(double, area, mesh->triangle_count, error);
  SCREE_SCRATCH(double, distance, mesh->triangle_count, error);
  SCREE_SCRATCH(double, centroids, 3 * mesh->triangle_count, error);
  SCREE_SCRATCH_ZERO(double, vertex_area, mesh->vertex_count, error);
  SCREE_SCRATCH(double, vertex_distance, mesh->vertex_count, error);
  measure_areas(mesh, area, centroids, vertex_area);
  if (reference) {
    SCREE_OWNED(scree_surface, surface);
    SCREE_TRY(scree_surface_create(reference, &surface, error));
    scree_surface_distances(surface, centroids, mesh->triangle_count, distance);
    scree_surface_distances(surface, mesh->positions, mesh->vertex_count, vertex_distance);
  }
  const scree_vtk_array cells[] = {{"area", SCREE_VTK_FLOAT64, 1, area},
                                   {"distance", SCREE_VTK_FLOAT64, 1, distance}};
  const scree_vtk_array points[] = {{"area", SCREE_VTK_FLOAT64, 1, vertex_area},
                                    {"distance", SCREE_VTK_FLOAT64, 1, vertex_distance}};
  const scree_vtk_data data = {.points = mesh->positions,
                               .point_count = mesh->vertex_count,
                               .triangles = mesh->triangles,
                               .cell_count = mesh->triangle_count,
                               .point_arrays = points,
                               .point_array_count = reference ? 2 : 1,
                               .cell_arrays = cells,
                               .cell_array_count = reference ? 2 : 1,
                               .time = NAN};
  return scree_vtp_write(&data, path, overwrite, error);
}
