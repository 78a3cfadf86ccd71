#include "mesh/mesh.h"

#include "base/alloc.h"
#include "base/parallel.h"

#include <float.h>
#include <string.h>

void scree_mesh_free(scree_mesh *mesh) {
  if (!mesh) return;
  scree_free(mesh->positions);
  scree_free(mesh->triangles);
  *mesh = (scree_mesh){0};
}

void scree_mesh_scale(scree_mesh *mesh, double factor) {
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++) mesh->positions[i] *= factor;
}

scree_status scree_mesh_make(size_t vertex_count, size_t triangle_count, scree_mesh *mesh,
                             scree_error *error) {
  SCREE_SCRATCH(double, positions, 3 * vertex_count, error);
  SCREE_SCRATCH(uint32_t, triangles, 3 * triangle_count, error);
  *mesh = (scree_mesh){positions, triangles, vertex_count, triangle_count};
  positions = NULL, triangles = NULL;
  return SCREE_OK;
}

scree_status scree_mesh_copy(const scree_mesh *mesh, scree_mesh *copy, scree_error *error) {
  scree_mesh made;
  SCREE_TRY(scree_mesh_make(mesh->vertex_count, mesh->triangle_count, &made, error));
  if (mesh->vertex_count) /* an empty mesh may have no arrays */
    memcpy(made.positions, mesh->positions, 3 * mesh->vertex_count * sizeof *made.positions);
  if (mesh->triangle_count)
    memcpy(made.triangles, mesh->triangles, 3 * mesh->triangle_count * sizeof *made.triangles);
  *copy = made;
  return SCREE_OK;
}

enum { VERIFY_BLOCK = 1 << 15 };

/* The first fault of each block; the lowest is reported, whatever the number of threads. */
typedef struct verification {
  const scree_mesh *mesh;
  size_t *fault; /* per block, SIZE_MAX where there is none */
} verification;

static void find_bad_index(void *context, scree_block block) {
  verification *v = context;
  size_t i = block.begin;
  while (i < block.end && v->mesh->triangles[i] < v->mesh->vertex_count) i++;
  v->fault[block.index] = i < block.end ? i : SIZE_MAX;
}

static void find_bad_coordinate(void *context, scree_block block) {
  verification *v = context;
  size_t i = block.begin;
  while (i < block.end && isfinite(v->mesh->positions[i])) i++;
  v->fault[block.index] = i < block.end ? i : SIZE_MAX;
}

static size_t first_fault(verification *v, size_t count, scree_block_function *find) {
  scree_parallel_for(count, VERIFY_BLOCK, find, v);
  for (size_t block = 0; block < scree_block_count(count, VERIFY_BLOCK); block++)
    if (v->fault[block] != SIZE_MAX) return v->fault[block];
  return SIZE_MAX;
}

scree_status scree_mesh_verify(const scree_mesh *mesh, scree_error *error) {
  if (mesh->triangle_count > (UINT32_MAX - 1) / 3 || mesh->vertex_count > UINT32_MAX)
    return scree_fail(
        error, SCREE_LIMIT,
        "the mesh has %zu triangles and %zu vertices, above the limit of %u triangles "
        "and %u vertices",
        mesh->triangle_count, mesh->vertex_count, (UINT32_MAX - 1) / 3, UINT32_MAX);
  size_t corner_count = 3 * mesh->triangle_count, value_count = 3 * mesh->vertex_count;
  size_t most = corner_count > value_count ? corner_count : value_count;
  verification v = {.mesh = mesh};
  SCREE_TRY_ALLOC(v.fault, scree_block_count(most, VERIFY_BLOCK), error);
  size_t bad_index = first_fault(&v, corner_count, find_bad_index);
  size_t bad_value = first_fault(&v, value_count, find_bad_coordinate);
  scree_free(v.fault);
  if (bad_index != SIZE_MAX)
    return scree_fail(error, SCREE_BAD_MESH, "triangle %zu names vertex %u, but there are only %zu",
                      bad_index / 3, mesh->triangles[bad_index], mesh->vertex_count);
  if (bad_value != SIZE_MAX)
    return scree_fail(error, SCREE_BAD_MESH, "vertex %zu has the coordinate %c = %g, not finite",
                      bad_value / 3, "xyz"[bad_value % 3], mesh -> positions[bad_value]);
  return SCREE_OK;
}

/* Roundings (units in the last place of the largest coordinate) below which a height is none: each
 * of the coordinates may be off by one from parsing and unit conversion, the cross product adds a
 * few. */
#define FLAT_ULPS 4.0

/* Above this, squares of areas have not lost bits to underflow. */
#define LEAST_SQUARE 1e-200

bool scree_facet_is_flat(const scree_mesh *mesh, size_t triangle) {
  vec3 corner[3];
  double largest = 0, longest2 = 0;
  for (int k = 0; k < 3; k++) {
    vec3 p = corner[k] = scree_mesh_corner(mesh, triangle, k);
    largest = scree_larger(scree_larger(largest, fabs(p.x)), scree_larger(fabs(p.y), fabs(p.z)));
  }
  for (int k = 0; k < 3; k++)
    longest2 = scree_larger(longest2, vec3_norm2(vec3_sub(corner[(k + 1) % 3], corner[k])));
  vec3 normal = vec3_triangle_normal(corner[0], corner[1], corner[2]);
  double rounding = FLAT_ULPS * DBL_EPSILON * largest;
  /* nearly all facets are far from flat, and need no root */
  double square = vec3_norm2(normal);
  if (square > LEAST_SQUARE && square > 2 * rounding * rounding * longest2) return false;
  return vec3_norm(normal) <= rounding * sqrt(longest2);
}
