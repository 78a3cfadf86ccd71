#include "sample/test_solid.h"

#include "base/alloc.h"
#include "base/vec.h"
#include "mesh/mesh.h"

#include <string.h>

/* ---- Box ---- */

/* Vertices layer by layer: the lowest and the highest hold the whole grid, those between only its
 * rim, counted around counter-clockwise. */
static size_t box_vertex(size_t n, size_t i, size_t j, size_t k) {
  size_t full = (n + 1) * (n + 1);
  if (k == 0) return i + (n + 1) * j;
  if (k == n) return full + 4 * n * (n - 1) + i + (n + 1) * j;
  size_t rim = j == 0 ? i : i == n ? n + j : j == n ? 3 * n - i : 4 * n - j;
  return full + 4 * n * (k - 1) + rim;
}

scree_status scree_sample_box(double edge, size_t cells, scree_mesh *mesh, scree_error *error) {
  size_t n = cells;
  SCREE_TRY(scree_mesh_make(2 * (n + 1) * (n + 1) + 4 * n * (n - 1), 12 * n * n, mesh, error));
  uint32_t *triangle = mesh->triangles;
  for (int face = 0; face < 6; face++) {
    int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (size_t q = 0; q < n * n; q++) {
      uint32_t corner[4];
      for (int c = 0; c < 4; c++) { /* (0,0) (1,0) (1,1) (0,1), counter-clockwise about +axis */
        size_t at[3];
        at[axis] = face & 1 ? n : 0;
        at[u] = q % n + (c == 1 || c == 2);
        at[v] = q / n + (c >= 2);
        size_t index = box_vertex(n, at[0], at[1], at[2]);
        corner[c] = (uint32_t)index;
        for (int a = 0; a < 3; a++)
          mesh->positions[3 * index + (size_t)a] = edge * ((double)at[a] / (double)n - 0.5);
      }
      int second = face & 1 ? 1 : 3; /* a low face is seen from the other side */
      const uint32_t two[6] = {corner[0], corner[second], corner[2],
                               corner[0], corner[2],      corner[4 - second]};
      memcpy(triangle, two, sizeof two);
      triangle += 6;
    }
  }
  return SCREE_OK;
}

/* ---- Icosphere ---- */

/* Midpoints by edge in an open-addressed table; key 0 is free (no edge joins vertex 0 to itself).
 */
typedef struct midpoints {
  uint64_t *keys;
  uint32_t *vertices;
  size_t mask;
} midpoints;

static uint32_t midpoint(midpoints *table, scree_mesh *mesh, double radius, uint32_t a,
                         uint32_t b) {
  uint64_t key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
  size_t slot = (size_t)(key * 0x9e3779b97f4a7c15u >> 20) & table->mask;
  for (; table->keys[slot] != 0; slot = (slot + 1) & table->mask)
    if (table->keys[slot] == key) return table->vertices[slot];
  uint32_t vertex = (uint32_t)mesh->vertex_count++;
  /* from the lower index to the higher, so that the sum has one order */
  vec3 sum = vec3_add(vec3_load(mesh->positions + 3 * (key >> 32)),
                      vec3_load(mesh->positions + 3 * (key & 0xffffffffu)));
  vec3_store(mesh->positions + 3 * (size_t)vertex, vec3_scale(vec3_unit(sum), radius));
  table->keys[slot] = key;
  table->vertices[slot] = vertex;
  return vertex;
}

/* Cuts every triangle into four, from the last to the first so that they may stay in place. */
static void subdivide(midpoints *table, double radius, scree_mesh *mesh) {
  memset(table->keys, 0, (table->mask + 1) * sizeof *table->keys);
  for (size_t t = mesh->triangle_count; t-- > 0;) {
    const uint32_t *corner = mesh->triangles + 3 * t;
    uint32_t a = corner[0], b = corner[1], c = corner[2];
    uint32_t ab = midpoint(table, mesh, radius, a, b), bc = midpoint(table, mesh, radius, b, c),
             ca = midpoint(table, mesh, radius, c, a);
    const uint32_t four[12] = {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca};
    memcpy(mesh->triangles + 12 * t, four, sizeof four);
  }
  mesh->triangle_count *= 4;
}

static void icosahedron(double radius, scree_mesh *mesh) {
  static const uint32_t triangles[20][3] = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  double golden = 0.5 * (1 + sqrt(5.0));
  for (int i = 0; i < 12; i++) { /* three golden rectangles */
    double u = i & 1 ? 1 : -1, v = i & 2 ? -golden : golden;
    vec3 p = i < 4 ? (vec3){u, v, 0} : i < 8 ? (vec3){0, u, v} : (vec3){v, 0, u};
    vec3_store(mesh->positions + 3 * i, vec3_scale(vec3_unit(p), radius));
  }
  memcpy(mesh->triangles, triangles, sizeof triangles);
  mesh->vertex_count = 12;
  mesh->triangle_count = 20;
}

scree_status scree_sample_icosphere(double radius, int level, scree_mesh *mesh,
                                    scree_error *error) {
  size_t triangle_count = (size_t)20 << (2 * level), slot_count = 64;
  SCREE_CLEANUP(scree_mesh_free) scree_mesh made = {0};
  while (slot_count < triangle_count) slot_count *= 2; /* at most 3/8 of them midpoints */
  SCREE_TRY(scree_mesh_make(triangle_count / 2 + 2, triangle_count, &made, error));
  SCREE_SCRATCH(uint64_t, keys, slot_count, error);
  SCREE_SCRATCH(uint32_t, vertices, slot_count, error);
  midpoints table = {keys, vertices, slot_count - 1};
  icosahedron(radius, &made);
  for (int i = 0; i < level; i++) subdivide(&table, radius, &made);
  *mesh = made;
  made = (scree_mesh){0};
  return SCREE_OK;
}
