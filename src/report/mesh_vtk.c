/* A mesh for ParaView with the fields that people look at: area and distance to the scan. */
#include "base/alloc.h"
#include "base/vec.h"

#include <math.h>

/* Over triangles and over vertices. */
typedef struct fields {
  double *area, *distance, *centroids; /* per triangle; 3 values the centroids */
  double *vertex_area, *vertex_distance;
} fields;

static void free_fields(fields *f) {
  scree_free(f->area);
  scree_free(f->distance);
  scree_free(f->centroids);
  scree_free(f->vertex_area);
  scree_free(f->vertex_distance);
}

static bool make_fields(const scree_mesh *mesh, fields *f) {
  f->area = scree_alloc(mesh->triangle_count, sizeof(double));
  f->distance = scree_alloc(mesh->triangle_count, sizeof(double));
  f->centroids = scree_alloc(mesh->triangle_count, 3 * sizeof(double));
  f->vertex_area = scree_alloc_zero(mesh->vertex_count, sizeof(double));
  f->vertex_distance = scree_alloc(mesh->vertex_count, sizeof(double));
  return f->area && f->distance && f->centroids && f->vertex_area && f->vertex_distance;
}

static void measure_areas(const scree_mesh *mesh, fields *f) {
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const uint32_t *corner = mesh->triangles + 3 * t;
    vec3 a = vec3_load(mesh->positions + 3 * (size_t)corner[0]);
    vec3 b = vec3_load(mesh->positions + 3 * (size_t)corner[1]);
    vec3 c = vec3_load(mesh->positions + 3 * (size_t)corner[2]);
    f->area[t] = 0.5 * vec3_norm(vec3_triangle_normal(a, b, c));
    vec3_store(f->centroids + 3 * t, vec3_scale(vec3_add(vec3_add(a, b), c), 1.0 / 3));
    for (int k = 0; k < 3; k++) f->vertex_area[corner[k]] += f->area[t] / 3;
  }
}

static scree_status measure_distances(const scree_mesh *mesh, const scree_mesh *reference,
                                      fields *f, scree_error *error) {
  scree_surface *surface = NULL;
  SCREE_TRY(scree_surface_create(reference, &surface, error));
  scree_surface_distances(surface, f->centroids, mesh->triangle_count, f->distance);
  scree_surface_distances(surface, mesh->positions, mesh->vertex_count, f->vertex_distance);
  scree_surface_free(surface);
  return SCREE_OK;
}

scree_status scree_mesh_vtp_write(const scree_mesh *mesh, const scree_mesh *reference,
                                  const char *path, bool overwrite, scree_error *error) {
  fields f = {0};
  scree_status status = scree_mesh_area_volume(mesh, NULL, NULL, error); /* refuses bad indices */
  if (status == SCREE_OK && !make_fields(mesh, &f))
    status = scree_fail_memory(error, 40 * mesh->triangle_count, "the fields of a mesh");
  if (status == SCREE_OK) measure_areas(mesh, &f);
  if (status == SCREE_OK && reference) status = measure_distances(mesh, reference, &f, error);
  if (status == SCREE_OK) {
    const scree_vtk_array cells[] = {{"area", SCREE_VTK_FLOAT64, 1, f.area},
                                     {"distance", SCREE_VTK_FLOAT64, 1, f.distance}};
    const scree_vtk_array points[] = {{"area", SCREE_VTK_FLOAT64, 1, f.vertex_area},
                                      {"distance", SCREE_VTK_FLOAT64, 1, f.vertex_distance}};
    size_t count = reference ? 2 : 1;
    scree_vtk_data data = {.points = mesh->positions,
                           .point_count = mesh->vertex_count,
                           .triangles = mesh->triangles,
                           .cell_count = mesh->triangle_count,
                           .point_arrays = points,
                           .point_array_count = count,
                           .cell_arrays = cells,
                           .cell_array_count = count,
                           .time = NAN};
    status = scree_vtp_write(&data, path, overwrite, error);
  }
  free_fields(&f);
  return status;
}
