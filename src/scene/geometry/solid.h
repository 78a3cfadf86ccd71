/* Meshes that kinds of geometry make, vertex by vertex. Arcs are polygons whose corners lie on
 * them. */
#pragma once

#include "base/alloc.h"
#include "scene/geometry/kind.h"

#include <string.h>

/* Room for a mesh whose counts grow as it is filled. */
static inline scree_status scree_solid_reserve(scree_mesh *mesh, size_t vertices, size_t triangles,
                                               scree_error *error) {
  mesh->positions = scree_alloc(vertices, 3 * sizeof *mesh->positions);
  mesh->triangles = scree_alloc(triangles, 3 * sizeof *mesh->triangles);
  if (mesh->positions && mesh->triangles) return SCREE_OK;
  scree_mesh_free(mesh);
  return scree_fail_memory(error, 24 * vertices + 12 * triangles, "a mesh");
}

static inline uint32_t scree_solid_vertex(scree_mesh *mesh, vec3 at) {
  vec3_store(mesh->positions + 3 * mesh->vertex_count, at);
  return (uint32_t)mesh->vertex_count++;
}

static inline void scree_solid_triangle(scree_mesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t corners[3] = {a, b, c};
  memcpy(mesh->triangles + 3 * mesh->triangle_count++, corners, sizeof corners);
}

/* a, b, c, d around it, seen from outside against the clock. */
static inline void scree_solid_quad(scree_mesh *mesh, uint32_t a, uint32_t b, uint32_t c,
                                    uint32_t d) {
  scree_solid_triangle(mesh, a, b, c);
  scree_solid_triangle(mesh, a, c, d);
}
