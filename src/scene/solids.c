/* Arcs are polygons whose corners lie on them, of ARC edges in a half circle: to 3e-4 of the
 * radius.
 */
#include "scene/solids.h"

#include "base/alloc.h"
#include "world/loop.h"

#include <string.h>

enum { ARC = 60 };

/* Room for a mesh whose counts grow as it is filled. */
static scree_status reserve(scree_mesh *mesh, size_t vertices, size_t triangles,
                            scree_error *error) {
  mesh->positions = scree_alloc(vertices, 3 * sizeof *mesh->positions);
  mesh->triangles = scree_alloc(triangles, 3 * sizeof *mesh->triangles);
  if (mesh->positions && mesh->triangles) return SCREE_OK;
  scree_mesh_free(mesh);
  return scree_fail_memory(error, 24 * vertices + 12 * triangles, "a mesh");
}

static uint32_t add_vertex(scree_mesh *mesh, vec3 at) {
  vec3_store(mesh->positions + 3 * mesh->vertex_count, at);
  return (uint32_t)mesh->vertex_count++;
}

static void add_triangle(scree_mesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t corners[3] = {a, b, c};
  memcpy(mesh->triangles + 3 * mesh->triangle_count++, corners, sizeof corners);
}

/* a, b, c, d around it, seen from outside against the clock. */
static void add_quad(scree_mesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

scree_status scree_loop_mesh(const scree_plan_loop *plan, scree_mesh *mesh, scree_error *error) {
  const scree_loop loop = {
      vec3_unit(vec3_load(plan->axis)), {0, 0, 0}, vec3_load(plan->span), plan->radius};
  const double strand = vec3_norm(loop.span), half = scree_loop_length(&loop) / 2;
  const vec3 w = vec3_cross(loop.axis, vec3_unit(loop.span)), begin = vec3_scale(w, -loop.radius),
             aside = vec3_scale(loop.axis, 0.5 * plan->width);
  const uint32_t ring = 2 * (ARC + 1);
  scree_mesh made = {0};
  scree_status status = reserve(&made, 2 * ring, 2 * ring, error);
  if (status != SCREE_OK) return status;
  for (uint32_t k = 0; k < ring; k++) {
    const double s = k / (ARC + 1) * half + strand + k % (ARC + 1) * (half - strand) / ARC;
    const scree_loop_place place = scree_loop_at(&loop, s);
    const vec3 at = scree_loop_carry(&loop, &place, begin);
    add_vertex(&made, vec3_sub(at, aside));
    add_vertex(&made, vec3_add(at, aside));
  }
  for (uint32_t k = 0; k < ring; k++) {
    const uint32_t a = 2 * k, b = 2 * ((k + 1) % ring);
    add_quad(&made, a, b, b + 1, a + 1);
  }
  *mesh = made;
  return SCREE_OK;
}
