/* Triangles (c, u, v) and (c, v, w) that lie next to each other about c become (c, u, w) and
 * (u, v, w): the edge from c to v is flipped. Round by round every second edge goes, so that what
 * is cut off has few triangles at each corner. An edge is flipped where the four points lie in a
 * plane to the rounding of single precision, in which CAD programs write, where both new triangles
 * face as the old ones do, and where u and w have no edge yet. */
#include "simplify/flat_fan.h"

#include "base/alloc.h"
#include "base/radix.h"
#include "mesh/adjacency.h"
#include "mesh/measure/bounds.h"
#include "mesh/mesh.h"
#include "simplify/fan.h"

#include <string.h>

/* Share of the box's diagonal by which four points may lie out of a plane. */
static const double ROUNDING = 1e-7;

typedef struct corner {
  uint32_t vertex, triangle; /* of the ring; of the apex, it and the next of the ring */
} corner;

typedef struct cutting {
  const scree_mesh *mesh;
  scree_adjacency adjacency;
  uint32_t *triangles;
  bool *touched;  /* per triangle: cut anew */
  uint64_t *made; /* set of the edges that flips made, by open addressing; 0: free */
  size_t made_mask;
  corner *ring;
  double thickness;
} cutting;

static void free_cutting(cutting *c) {
  scree_adjacency_free(&c->adjacency);
  scree_free(c->triangles);
  scree_free(c->touched);
  scree_free(c->made);
  scree_free(c->ring);
}

static uint64_t name_of(uint32_t u, uint32_t v) {
  return u < v ? (uint64_t)v << 32 | u : (uint64_t)u << 32 | v; /* never 0: they differ */
}

/* Where the edge is in the set, or would be. */
static uint64_t *made_at(const cutting *c, uint64_t name) {
  size_t i = (size_t)(name * UINT64_C(0x9e3779b97f4a7c15) >> 32) & c->made_mask;
  while (c->made[i] && c->made[i] != name) i = (i + 1) & c->made_mask;
  return &c->made[i];
}

/* By what the edges of the mesh ascend: the lower end, then the other. */
static uint64_t key_of(const cutting *c, size_t edge) {
  uint32_t h = c->adjacency.edges[edge];
  uint64_t name = name_of(scree_half_edge_from(c->mesh, h), scree_half_edge_to(c->mesh, h));
  return name << 32 | name >> 32;
}

static bool is_edge(const cutting *c, uint32_t u, uint32_t v) {
  uint64_t name = name_of(u, v);
  SCREE_FIND_FIRST(i, 0, c->adjacency.edge_count, key_of(c, i) < (name << 32 | name >> 32))
  return (i < c->adjacency.edge_count && key_of(c, i) == (name << 32 | name >> 32)) ||
         *made_at(c, name) == name;
}

static vec3 at(const cutting *c, uint32_t v) {
  return vec3_load(c->mesh->positions + 3 * (size_t)v);
}

static bool may_flip(const cutting *c, uint32_t apex, uint32_t u, uint32_t v, uint32_t w) {
  vec3 a = at(c, apex), p = at(c, u), q = at(c, v), r = at(c, w);
  vec3 left = vec3_triangle_normal(a, p, q), right = vec3_triangle_normal(a, q, r),
       inner = vec3_triangle_normal(a, p, r), outer = vec3_triangle_normal(p, q, r);
  double out = fabs(vec3_dot(inner, vec3_sub(q, a)));
  return out <= c->thickness * vec3_norm(inner) && vec3_dot(inner, left) > 0 &&
         vec3_dot(inner, right) > 0 && vec3_dot(outer, left) > 0 && vec3_dot(outer, right) > 0 &&
         u != w && !is_edge(c, u, w);
}

static void put(cutting *c, uint32_t triangle, uint32_t u, uint32_t v, uint32_t w) {
  const uint32_t corners[3] = {u, v, w};
  memcpy(c->triangles + 3 * (size_t)triangle, corners, sizeof corners);
  c->touched[triangle] = true;
}

/* The ring about half-edge h's start, closed and untouched; its length, or 0. */
static size_t find_ring(cutting *c, uint32_t h) {
  const uint32_t *twin = c->adjacency.ring;
  size_t count = 0;
  for (uint32_t g = h; count == 0 || g != h; count++) {
    uint32_t back = scree_half_edge_previous(g);
    bool manifold = twin[back] != SCREE_NO_HALF_EDGE && twin[back] != back &&
                    twin[twin[back]] == back && !c->touched[g / 3] &&
                    scree_half_edge_from(c->mesh, twin[back]) == scree_half_edge_from(c->mesh, g);
    if (!manifold) return 0;
    c->ring[count] = (corner){scree_half_edge_to(c->mesh, g), g / 3};
    g = twin[back];
  }
  return count;
}

/* One round over the ring, of which the corners left are kept. */
static size_t flip_round(cutting *c, uint32_t apex, size_t count) {
  size_t left = 0;
  for (size_t i = 0; i < count; i++) {
    corner u = c->ring[i];
    c->ring[left++] = u;
    if (i + 2 >= count) continue;
    corner v = c->ring[i + 1], w = c->ring[i + 2];
    if (!may_flip(c, apex, u.vertex, v.vertex, w.vertex)) continue;
    uint64_t name = name_of(u.vertex, w.vertex);
    *made_at(c, name) = name;
    put(c, u.triangle, apex, u.vertex, w.vertex);
    put(c, v.triangle, u.vertex, v.vertex, w.vertex);
    i++;
  }
  return left;
}

static void cut_fan(cutting *c, uint32_t h) {
  uint32_t apex = scree_half_edge_from(c->mesh, h);
  size_t count = find_ring(c, h), before = count + 1;
  while (count > SCREE_FAN_MAX && count < before) {
    before = count;
    count = flip_round(c, apex, count);
  }
}

static scree_status cut_all(cutting *c, uint32_t *fan_sizes, size_t largest, size_t all,
                            scree_error *error) {
  const scree_mesh *mesh = c->mesh;
  size_t room = 16;
  vec3 low, high;
  while (room < 2 * all) room *= 2;
  scree_mesh_bounds(mesh, &low, &high);
  c->thickness = ROUNDING * vec3_distance(low, high);
  c->made_mask = room - 1;
  SCREE_TRY_ALLOC(c->triangles, 3 * mesh->triangle_count, error);
  SCREE_TRY_ALLOC(c->ring, largest, error);
  SCREE_TRY_ALLOC_ZERO(c->made, room, error);
  SCREE_TRY_ALLOC_ZERO(c->touched, mesh->triangle_count, error);
  memcpy(c->triangles, mesh->triangles, 3 * mesh->triangle_count * sizeof *c->triangles);
  for (uint32_t h = 0; h < 3 * mesh->triangle_count; h++) {
    uint32_t v = mesh->triangles[h];
    if (fan_sizes[v] <= SCREE_FAN_MAX) continue;
    fan_sizes[v] = 0;
    cut_fan(c, h);
  }
  return SCREE_OK;
}

scree_status scree_flat_fans_cut(const scree_mesh *mesh, uint32_t **triangles, scree_error *error) {
  SCREE_CLEANUP(free_cutting) cutting c = {.mesh = mesh};
  size_t largest = 0, all = 0;
  *triangles = NULL;
  SCREE_SCRATCH_ZERO(uint32_t, fan_sizes, mesh->vertex_count, error);
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++) fan_sizes[mesh->triangles[i]]++;
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    if (fan_sizes[v] <= SCREE_FAN_MAX) continue;
    all += fan_sizes[v];
    largest = fan_sizes[v] > largest ? fan_sizes[v] : largest;
  }
  if (largest == 0) return SCREE_OK;
  SCREE_TRY(scree_adjacency_build(mesh, &c.adjacency, error));
  SCREE_TRY(cut_all(&c, fan_sizes, largest, all, error));
  *triangles = c.triangles;
  c.triangles = NULL;
  return SCREE_OK;
}
