#include "base/alloc.h"

#include <string.h>

void scree_mesh_free(scree_mesh *mesh) {
  if (!mesh) return;
  scree_free(mesh->positions);
  scree_free(mesh->triangles);
  *mesh = (scree_mesh){0};
}

scree_status scree_mesh_copy(const scree_mesh *mesh, scree_mesh *copy, scree_error *error) {
  scree_mesh made = {.vertex_count = mesh->vertex_count, .triangle_count = mesh->triangle_count};
  SCREE_ALLOC_OR(made.positions, 3 * mesh->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(made.triangles, 3 * mesh->triangle_count, error, out_of_memory);
  memcpy(made.positions, mesh->positions, 3 * mesh->vertex_count * sizeof *made.positions);
  memcpy(made.triangles, mesh->triangles, 3 * mesh->triangle_count * sizeof *made.triangles);
  *copy = made;
  return SCREE_OK;
out_of_memory:
  scree_mesh_free(&made);
  return SCREE_OUT_OF_MEMORY;
}
