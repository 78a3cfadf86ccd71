#include "support/shapes.h"

#include "base/alloc.h"
#include "support/check.h"

#include <stdlib.h>
#include <string.h>

scree_mesh shape_make(size_t vertex_count, size_t triangle_count) {
  scree_mesh mesh = {.vertex_count = vertex_count, .triangle_count = triangle_count};
  mesh.positions = scree_alloc(3 * vertex_count, sizeof *mesh.positions);
  mesh.triangles = scree_alloc(3 * triangle_count, sizeof *mesh.triangles);
  if (!mesh.positions || !mesh.triangles) abort();
  return mesh;
}

static scree_mesh from_tables(const double (*positions)[3], size_t vertex_count,
                              const uint32_t (*triangles)[3], size_t triangle_count) {
  scree_mesh mesh = shape_make(vertex_count, triangle_count);
  memcpy(mesh.positions, positions, 3 * vertex_count * sizeof(double));
  memcpy(mesh.triangles, triangles, 3 * triangle_count * sizeof(uint32_t));
  return mesh;
}

scree_mesh shape_tetrahedron(double x, double y, double z) {
  const double positions[4][3] = {{0, 0, 0}, {x, 0, 0}, {0, y, 0}, {0, 0, z}};
  const uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return from_tables(positions, 4, triangles, 4);
}

scree_mesh shape_box(double x, double y, double z) {
  return shape_grid_box(x, y, z, 1);
}

/* The number of lattice point (i, j, k) of the surface: one shared table for all six faces. */
static uint32_t lattice_vertex(scree_mesh *mesh, uint32_t *numbers, size_t n, const size_t at[3],
                               const double size[3]) {
  uint32_t *number = &numbers[(at[0] * (n + 1) + at[1]) * (n + 1) + at[2]];
  if (*number == UINT32_MAX) {
    *number = (uint32_t)mesh->vertex_count++;
    for (int d = 0; d < 3; d++)
      mesh->positions[3 * *number + (uint32_t)d] = size[d] * (double)at[d] / (double)n;
  }
  return *number;
}

static void grid_square(scree_mesh *mesh, uint32_t *numbers, size_t n, const size_t at[3], int axis,
                        const double size[3]) {
  bool far = at[axis] == n;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  uint32_t corner[4];
  for (int i = 0; i < 4; i++) {
    size_t here[3] = {at[0], at[1], at[2]};
    here[u] += i == 1 || i == 2;
    here[v] += i >= 2;
    corner[far ? i : (4 - i) % 4] = lattice_vertex(mesh, numbers, n, here, size);
  }
  const uint32_t two[6] = {corner[0], corner[1], corner[2], corner[0], corner[2], corner[3]};
  memcpy(mesh->triangles + 3 * mesh->triangle_count, two, sizeof two);
  mesh->triangle_count += 2;
}

scree_mesh shape_grid_box(double x, double y, double z, size_t n) {
  const double size[3] = {x, y, z};
  size_t points = (n + 1) * (n + 1) * (n + 1);
  scree_mesh mesh = shape_make(6 * n * n + 2, 12 * n * n);
  uint32_t *numbers = malloc(points * sizeof *numbers);
  if (!numbers) abort();
  memset(numbers, 0xff, points * sizeof *numbers);
  mesh.vertex_count = mesh.triangle_count = 0;
  for (int axis = 0; axis < 3; axis++)
    for (size_t side = 0; side < 2; side++)
      for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
          size_t at[3];
          at[axis] = side * n;
          at[(axis + 1) % 3] = i;
          at[(axis + 2) % 3] = j;
          grid_square(&mesh, numbers, n, at, axis, size);
        }
  free(numbers);
  return mesh;
}

static scree_mesh icosahedron(void) {
  const double g = 1.6180339887498949;
  const double positions[12][3] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                   {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                   {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  const uint32_t triangles[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return from_tables(positions, 12, triangles, 20);
}

/* The midpoint of edge (a, b); each edge is asked for twice, so the second finds the first in the
 * list of its lower vertex (six slots: no vertex has more edges). */
static uint32_t midpoint(scree_mesh *mesh, uint32_t (*slots)[6][2], uint32_t a, uint32_t b) {
  uint32_t low = a < b ? a : b, high = a < b ? b : a;
  for (int s = 0; s < 6; s++) {
    uint32_t *slot = slots[low][s];
    if (slot[0] == high) return slot[1];
    if (slot[0] != UINT32_MAX) continue;
    slot[0] = high;
    slot[1] = (uint32_t)mesh->vertex_count++;
    for (uint32_t d = 0; d < 3; d++)
      mesh->positions[3 * slot[1] + d] =
          0.5 * (mesh->positions[3 * low + d] + mesh->positions[3 * high + d]);
    return slot[1];
  }
  abort();
}

static scree_mesh cut_in_four(const scree_mesh *coarse) {
  size_t edges = coarse->triangle_count / 2 * 3, old = coarse->vertex_count;
  scree_mesh fine = shape_make(old + edges, 4 * coarse->triangle_count);
  memcpy(fine.positions, coarse->positions, 3 * old * sizeof(double));
  uint32_t(*slots)[6][2] = malloc(old * sizeof *slots);
  if (!slots) abort();
  memset(slots, 0xff, old * sizeof *slots);
  fine.vertex_count = old;
  for (size_t t = 0; t < coarse->triangle_count; t++) {
    const uint32_t *c = coarse->triangles + 3 * t;
    uint32_t m[3];
    for (int k = 0; k < 3; k++) m[k] = midpoint(&fine, slots, c[k], c[(k + 1) % 3]);
    const uint32_t four[12] = {c[0], m[0], m[2], c[1], m[1], m[0],
                               c[2], m[2], m[1], m[0], m[1], m[2]};
    memcpy(fine.triangles + 12 * t, four, sizeof four);
  }
  free(slots);
  return fine;
}

scree_mesh shape_icosphere(double radius, int level) {
  scree_mesh mesh = icosahedron();
  for (int i = 0; i < level; i++) {
    scree_mesh fine = cut_in_four(&mesh);
    scree_mesh_free(&mesh);
    mesh = fine;
    for (size_t v = 0; v < mesh.vertex_count; v++)
      vec3_store(mesh.positions + 3 * v, vec3_unit(vec3_load(mesh.positions + 3 * v)));
  }
  for (size_t v = 0; v < mesh.vertex_count; v++)
    vec3_store(mesh.positions + 3 * v,
               vec3_scale(vec3_unit(vec3_load(mesh.positions + 3 * v)), radius));
  return mesh;
}

scree_mesh shape_torus(double big_radius, double small_radius, size_t around, size_t across) {
  const double turn = 6.283185307179586;
  scree_mesh mesh = shape_make(around * across, 2 * around * across);
  for (size_t i = 0; i < around; i++)
    for (size_t j = 0; j < across; j++) {
      double u = turn * (double)i / (double)around, v = turn * (double)j / (double)across,
             r = big_radius + small_radius * cos(v);
      vec3_store(mesh.positions + 3 * (i * across + j),
                 (vec3){r * cos(u), r * sin(u), small_radius * sin(v)});
      uint32_t a = (uint32_t)(i * across + j), b = (uint32_t)((i + 1) % around * across + j),
               c = (uint32_t)((i + 1) % around * across + (j + 1) % across),
               d = (uint32_t)(i * across + (j + 1) % across);
      const uint32_t two[6] = {a, b, c, a, c, d};
      memcpy(mesh.triangles + 6 * (size_t)a, two, sizeof two);
    }
  return mesh;
}

scree_mesh shape_sheet(double z, size_t n) {
  scree_mesh mesh = shape_make((n + 1) * (n + 1), 2 * n * n);
  for (size_t i = 0; i <= n; i++)
    for (size_t j = 0; j <= n; j++)
      vec3_store(mesh.positions + 3 * (i * (n + 1) + j),
                 (vec3){(double)i / (double)n, (double)j / (double)n, z});
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      uint32_t a = (uint32_t)(i * (n + 1) + j), b = a + (uint32_t)n + 1;
      const uint32_t two[6] = {a, b, b + 1, a, b + 1, a + 1};
      memcpy(mesh.triangles + 6 * (i * n + j), two, sizeof two);
    }
  return mesh;
}

scree_mesh shape_random_tangle(scree_rng *rng) {
  scree_mesh mesh = shape_make(3 + scree_rng_below(rng, 8), scree_rng_below(rng, 24));
  for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
    mesh.positions[i] = (double)scree_rng_below(rng, 4);
  for (size_t i = 0; i < 3 * mesh.triangle_count; i++)
    mesh.triangles[i] = (uint32_t)scree_rng_below(rng, mesh.vertex_count);
  return mesh;
}

scree_mesh shape_join(const scree_mesh *a, const scree_mesh *b) {
  scree_mesh mesh =
      shape_make(a->vertex_count + b->vertex_count, a->triangle_count + b->triangle_count);
  memcpy(mesh.positions, a->positions, 3 * a->vertex_count * sizeof(double));
  memcpy(mesh.positions + 3 * a->vertex_count, b->positions, 3 * b->vertex_count * sizeof(double));
  memcpy(mesh.triangles, a->triangles, 3 * a->triangle_count * sizeof(uint32_t));
  for (size_t i = 0; i < 3 * b->triangle_count; i++)
    mesh.triangles[3 * a->triangle_count + i] = b->triangles[i] + (uint32_t)a->vertex_count;
  return mesh;
}

void shape_transform(scree_mesh *mesh, const mat3 *matrix, vec3 offset) {
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    double *p = mesh->positions + 3 * v;
    vec3_store(p, vec3_add(mat3_mul_vec(matrix, vec3_load(p)), offset));
  }
}

void shape_move(scree_mesh *mesh, vec3 offset) {
  const mat3 one = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  shape_transform(mesh, &one, offset);
}

void shape_shake(scree_mesh *mesh, double size, scree_rng *rng) {
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    mesh->positions[i] += size * scree_rng_normal(rng);
}

void shape_roughen(scree_mesh *mesh, double share, scree_rng *rng) {
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    double k = 1 + share * (2 * scree_rng_uniform(rng) - 1);
    for (size_t i = 0; i < 3; i++) mesh->positions[3 * v + i] *= k;
  }
}

void shape_flip(scree_mesh *mesh, size_t triangle) {
  uint32_t *corner = mesh->triangles + 3 * triangle, second = corner[1];
  corner[1] = corner[2];
  corner[2] = second;
}

scree_mesh shape_weld(const scree_mesh *mesh, scree_rng *rng) {
  double *corners = malloc((9 * mesh->triangle_count + 1) * sizeof *corners);
  uint32_t *order = malloc((mesh->triangle_count + 1) * sizeof *order);
  scree_mesh welded;
  if (!corners || !order) abort();
  for (uint32_t t = 0; t < mesh->triangle_count; t++) {
    uint32_t other = rng ? scree_rng_below(rng, t + 1) : t;
    order[t] = order[other];
    order[other] = t;
  }
  for (size_t t = 0; t < mesh->triangle_count; t++)
    for (size_t k = 0, turn = rng ? scree_rng_below(rng, 3) : 0; k < 3; k++)
      memcpy(corners + 9 * t + 3 * k,
             mesh->positions + 3 * (size_t)mesh->triangles[3 * (size_t)order[t] + (k + turn) % 3],
             3 * sizeof *corners);
  if (scree_mesh_weld(corners, mesh->triangle_count, 0, &welded, NULL, NULL) != SCREE_OK) abort();
  free(corners);
  free(order);
  return welded;
}

scree_particle *shape_particle(scree_mesh mesh) {
  scree_error error;
  scree_particle *particle = NULL;
  CHECK_OK(scree_particle_from_mesh(&mesh, NULL, &particle, &error), error);
  scree_mesh_free(&mesh);
  return particle;
}
