#include "support/solids.h"

#include "support/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double turn_of(const double *a, const double *b, const double *c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Whether the ear a b c (counter-clockwise) holds another corner. */
static int ear_is_full(const double *xy, const size_t *left, size_t count, const size_t ear[3]) {
  for (size_t k = 0; k < count; k++) {
    size_t p = left[k];
    if (p == ear[0] || p == ear[1] || p == ear[2]) continue;
    if (turn_of(&xy[2 * ear[0]], &xy[2 * ear[1]], &xy[2 * p]) >= 0 &&
        turn_of(&xy[2 * ear[1]], &xy[2 * ear[2]], &xy[2 * p]) >= 0 &&
        turn_of(&xy[2 * ear[2]], &xy[2 * ear[0]], &xy[2 * p]) >= 0)
      return 1;
  }
  return 0;
}

/* Ear clipping; n - 2 triangles. */
static void clip_ears(const double *xy, size_t n, size_t *triangles) {
  size_t left[64], count = n, made = 0;
  for (size_t i = 0; i < n; i++) left[i] = i;
  while (count > 3) {
    for (size_t i = 0; i < count; i++) {
      size_t ear[3] = {left[(i + count - 1) % count], left[i], left[(i + 1) % count]};
      if (turn_of(&xy[2 * ear[0]], &xy[2 * ear[1]], &xy[2 * ear[2]]) <= 0) continue;
      if (ear_is_full(xy, left, count, ear)) continue;
      memcpy(&triangles[3 * made++], ear, sizeof ear);
      memmove(&left[i], &left[i + 1], (count - i - 1) * sizeof *left);
      count--;
      break;
    }
  }
  memcpy(&triangles[3 * made], left, 3 * sizeof *left);
}

scree_mesh solid_prism(const double *xy, size_t n, double height) {
  scree_mesh mesh = shape_make(2 * n, 4 * n - 4);
  size_t caps[3 * 64];
  clip_ears(xy, n, caps);
  for (size_t i = 0; i < 2 * n; i++) {
    mesh.positions[3 * i] = xy[2 * (i % n)];
    mesh.positions[3 * i + 1] = xy[2 * (i % n) + 1];
    mesh.positions[3 * i + 2] = i < n ? 0 : height;
  }
  uint32_t *t = mesh.triangles;
  for (size_t k = 0; k < n - 2; k++) {
    const size_t *c = &caps[3 * k];
    const size_t both[6] = {c[0], c[2], c[1], c[0] + n, c[1] + n, c[2] + n};
    for (int i = 0; i < 6; i++) *t++ = (uint32_t)both[i];
  }
  for (size_t i = 0; i < n; i++) {
    size_t j = (i + 1) % n;
    const size_t both[6] = {i, j, j + n, i, j + n, i + n};
    for (int k = 0; k < 6; k++) *t++ = (uint32_t)both[k];
  }
  return mesh;
}

scree_mesh solid_tray(double x, double y, double z, double w) {
  scree_mesh mesh = shape_make(16, 28);
  const double rings[4][5] = {
      {0, 0, x, y, 0}, {0, 0, x, y, z}, {w, w, x - w, y - w, z}, {w, w, x - w, y - w, w}};
  for (size_t r = 0; r < 4; r++)
    for (size_t i = 0; i < 4; i++) {
      double *p = &mesh.positions[3 * (4 * r + i)];
      p[0] = i == 1 || i == 2 ? rings[r][2] : rings[r][0];
      p[1] = i >= 2 ? rings[r][3] : rings[r][1];
      p[2] = rings[r][4];
    }
  uint32_t *t = mesh.triangles;
  for (uint32_t r = 0; r < 3; r++)
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t j = (i + 1) % 4, a = 4 * r + i, b = 4 * r + j;
      const uint32_t quad[6] = {a, b, b + 4, a, b + 4, a + 4};
      memcpy(t, quad, sizeof quad);
      t += 6;
    }
  const uint32_t ends[12] = {0, 2, 1, 0, 3, 2, 12, 13, 14, 12, 14, 15};
  memcpy(t, ends, sizeof ends);
  return mesh;
}

scree_mesh solid_hook(double s, double w, double depth) {
  const double xy[] = {0, 0, s, 0, s, 0.6 * s, s - w, 0.6 * s, s - w, w, w, w, w, s, 0, s};
  return solid_prism(xy, 8, depth);
}

scree_mesh solid_notch(double s, double half_angle, double depth) {
  double deep = fmin(0.7 * s, 0.4 * s / tan(half_angle)), wide = deep * tan(half_angle);
  const double xy[] = {0, 0, s, 0, s, s, 0.5 * s + wide, s, 0.5 * s, s - deep, 0.5 * s - wide,
                       s, 0, s};
  return solid_prism(xy, 7, depth);
}

/* The index of the middle of edge (a, b), made when new; a plain search, for test meshes. */
static uint32_t middle_of(scree_mesh *mesh, uint32_t (*edges)[2], size_t base, uint32_t a,
                          uint32_t b) {
  uint32_t low = a < b ? a : b, high = a < b ? b : a;
  size_t made = mesh->vertex_count - base;
  for (size_t k = 0; k < made; k++)
    if (edges[k][0] == low && edges[k][1] == high) return (uint32_t)(base + k);
  edges[made][0] = low;
  edges[made][1] = high;
  double *p = &mesh->positions[3 * mesh->vertex_count];
  for (int i = 0; i < 3; i++)
    p[i] = 0.5 * (mesh->positions[3 * low + (uint32_t)i] + mesh->positions[3 * high + (uint32_t)i]);
  return (uint32_t)mesh->vertex_count++;
}

void solid_split(scree_mesh *mesh) {
  size_t v = mesh->vertex_count, f = mesh->triangle_count;
  scree_mesh split = shape_make(v + 3 * f, 4 * f);
  uint32_t(*edges)[2] = malloc(3 * f * sizeof *edges);
  if (!edges) abort();
  memcpy(split.positions, mesh->positions, 3 * v * sizeof *mesh->positions);
  split.vertex_count = v;
  for (size_t k = 0; k < f; k++) {
    const uint32_t *c = &mesh->triangles[3 * k];
    uint32_t m[3];
    for (int i = 0; i < 3; i++) m[i] = middle_of(&split, edges, v, c[i], c[(i + 1) % 3]);
    const uint32_t four[12] = {c[0], m[0], m[2], m[0], c[1], m[1],
                               m[2], m[1], c[2], m[0], m[1], m[2]};
    memcpy(&split.triangles[12 * k], four, sizeof four);
  }
  free(edges);
  scree_mesh_free(mesh);
  *mesh = split;
}
