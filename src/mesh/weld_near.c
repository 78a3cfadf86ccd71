/* Single linkage: two vertices belong together when a chain of steps no longer than the distance d
 * joins them. That relation does not depend on any order, and because each group keeps the position
 * of one of its members, different groups stay further apart than d: welding again changes nothing.
 *
 * Vertices are entered one by one into a hash table of cells of side d; each is compared with the
 * earlier ones in its cell and the 26 around it. Groups are kept by union-find whose root is the
 * smallest index. Crowded cells cost the product of their counts: the work is counted and refused
 * above a limit, rather than left to run for hours. */
#include "mesh/weld.h"

#include "base/vec.h"
#include "mesh/adjacency.h"
#include "mesh/mesh.h"

#include <math.h>
#include <string.h>

enum { NO_VERTEX = UINT32_MAX, WORK_PER_VERTEX = 4000 };

typedef struct cells {
  const double *positions;
  size_t vertex_count;
  double scale; /* 1 / d */
  vec3 low;
  uint32_t *heads; /* the last vertex entered of a chain of cells; NO_VERTEX where none */
  uint32_t *next;  /* the one entered before it */
  size_t head_count;
  uint32_t *parent; /* union-find */
} cells;

static vec3 scaled_position(const cells *c, uint32_t v) {
  return vec3_scale(vec3_sub(vec3_load(c->positions + 3 * (size_t)v), c->low), c->scale);
}

static size_t head_of(const cells *c, int64_t x, int64_t y, int64_t z) {
  uint64_t h = (uint64_t)x * 0x9e3779b97f4a7c15u;
  h = (h ^ h >> 29 ^ (uint64_t)y) * 0xbf58476d1ce4e5b9u;
  h = (h ^ h >> 32 ^ (uint64_t)z) * 0x94d049bb133111ebu;
  return (size_t)(h >> 32) & (c->head_count - 1);
}

/* Unites v with the earlier vertices of one chain; answers how many were compared. Vertices of
 * other cells in the chain do no harm: only the distance decides. */
static size_t join_chain(cells *c, uint32_t v, vec3 p, size_t head) {
  size_t compared = 0;
  for (uint32_t other = c->heads[head]; other != NO_VERTEX; other = c->next[other], compared++) {
    if (vec3_norm2(vec3_sub(p, scaled_position(c, other))) <= 1) scree_join(c->parent, v, other);
  }
  return compared;
}

static size_t enter_vertex(cells *c, uint32_t v) {
  vec3 p = scaled_position(c, v);
  int64_t x = (int64_t)p.x, y = (int64_t)p.y, z = (int64_t)p.z;
  size_t compared = 0;
  for (int64_t i = x - 1; i <= x + 1; i++)
    for (int64_t j = y - 1; j <= y + 1; j++)
      for (int64_t k = z - 1; k <= z + 1; k++) compared += join_chain(c, v, p, head_of(c, i, j, k));
  size_t own = head_of(c, x, y, z);
  c->next[v] = c->heads[own];
  c->heads[own] = v;
  return compared;
}

static scree_status group_vertices(cells *c, double tolerance, scree_error *error) {
  uint64_t limit = (uint64_t)c->vertex_count * WORK_PER_VERTEX, work = 0;
  for (size_t i = 0; i < c->head_count; i++) c->heads[i] = NO_VERTEX;
  for (size_t v = 0; v < c->vertex_count; v++) c->parent[v] = (uint32_t)v;
  for (size_t v = 0; v < c->vertex_count; v++) {
    work += enter_vertex(c, (uint32_t)v);
    if (work > limit)
      return scree_fail(error, SCREE_LIMIT,
                        "the welding tolerance %g brings vertices too close: after %zu of %zu "
                        "vertices more than %d pairs each; use a smaller one",
                        tolerance, v + 1, c->vertex_count, WORK_PER_VERTEX);
  }
  return SCREE_OK;
}

/* Renames the vertices to their group's first one, and brings what is left into order. */
static scree_status rebuild(scree_mesh *mesh, uint32_t *parent, scree_error *error) {
  scree_mesh made;
  SCREE_SCRATCH_ZERO(uint8_t, used, mesh->vertex_count, error);
  SCREE_SCRATCH(uint32_t, triangles, 3 * mesh->triangle_count, error);
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    uint32_t v[3];
    for (int k = 0; k < 3; k++) v[k] = scree_find_root(parent, mesh->triangles[3 * t + (size_t)k]);
    if (scree_names_twice(v)) continue;
    used[v[0]] = used[v[1]] = used[v[2]] = 1;
    memcpy(triangles + 3 * count++, v, sizeof v);
  }
  scree_loose_mesh loose = {mesh->positions, used, mesh->vertex_count, triangles, count};
  SCREE_TRY(scree_weld_sort(&loose, &made, error));
  scree_mesh_free(mesh);
  *mesh = made;
  return SCREE_OK;
}

scree_status scree_weld_near(scree_mesh *mesh, double tolerance, scree_error *error) {
  if (mesh->vertex_count == 0) return SCREE_OK;
  cells c = {.positions = mesh->positions, .vertex_count = mesh->vertex_count};
  const scree_box box = scree_box_of_points(mesh->positions, mesh->vertex_count);
  vec3 size = vec3_sub(box.high, box.low);
  c.low = box.low;
  c.scale = 1 / (tolerance * hypot(hypot(size.x, size.y), size.z)); /* without overflow */
  if (!isfinite(c.scale)) return SCREE_OK; /* no two doubles are that close */
  c.head_count = 64;
  while (c.head_count < mesh->vertex_count) c.head_count *= 2;
  SCREE_SCRATCH(uint32_t, heads, c.head_count, error);
  SCREE_SCRATCH(uint32_t, next, mesh->vertex_count, error);
  SCREE_SCRATCH(uint32_t, parent, mesh->vertex_count, error);
  c.heads = heads, c.next = next, c.parent = parent;
  SCREE_TRY(group_vertices(&c, tolerance, error));
  return rebuild(mesh, parent, error);
}
