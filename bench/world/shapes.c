#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double sample_spacing = 0.8e-3; /* m: fine enough for 1,500 triangles */

void need(scree_status status, const scree_error *error) {
  if (status == SCREE_OK) return;
  fprintf(stderr, "bench_world: %s\n", error->message);
  exit(1);
}

static scree_particle *particle_of(const scree_mesh *mesh) {
  scree_error error;
  scree_particle *particle = NULL;
  need(scree_particle_from_mesh(mesh, NULL, &particle, &error), &error);
  return particle;
}

static scree_particle *make_device(const char *name, size_t triangles) {
  scree_error error;
  scree_sample_options options = scree_default_sample_options();
  options.resolution = sample_spacing;
  scree_mesh fine, coarse;
  need(scree_sample_make(name, &options, NULL, &fine, &error), &error);
  scree_simplify_options simplify = scree_default_simplify_options();
  scree_curve *curve;
  need(scree_curve_build(&fine, &simplify, NULL, &curve, &error), &error);
  need(scree_curve_mesh(curve, scree_curve_find(curve, triangles), &coarse, &error), &error);
  scree_particle *particle = particle_of(&coarse);
  scree_mesh_free(&fine);
  scree_mesh_free(&coarse);
  scree_curve_free(curve);
  return particle;
}

/* Corners 0 to 7: x, y, z by the bits of the index. */
static void put_corners(double *positions, const double low[3], const double high[3]) {
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 3; k++) positions[3 * i + k] = i >> k & 1 ? high[k] : low[k];
}

static scree_particle *make_box(void) {
  static uint32_t triangles[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                   2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  const double low[3] = {0, 0, 0}, high[3] = {0.1, 0.05, 0.015};
  double positions[24];
  put_corners(positions, low, high);
  return particle_of(&(scree_mesh){positions, triangles, 8, 12});
}

static bool is_same(const double *p, const double *q) {
  return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* Every triangle into four by its edges' middles; vertices that several triangles make are found
 * by their coordinates (the counts are small). */
static void cut_in_four(scree_mesh *mesh) {
  size_t n = mesh->triangle_count, vertices = mesh->vertex_count;
  double *positions = malloc((vertices + 3 * n) * 3 * sizeof *positions);
  uint32_t *triangles = malloc(12 * n * sizeof *triangles);
  if (!positions || !triangles) abort();
  memcpy(positions, mesh->positions, 3 * vertices * sizeof *positions);
  for (size_t t = 0; t < n; t++) {
    const uint32_t *v = mesh->triangles + 3 * t;
    uint32_t middle[3];
    for (int e = 0; e < 3; e++) {
      double p[3];
      for (int k = 0; k < 3; k++)
        p[k] =
            0.5 * (positions[3 * v[e] + (uint32_t)k] + positions[3 * v[(e + 1) % 3] + (uint32_t)k]);
      size_t found = mesh->vertex_count;
      while (found < vertices && !is_same(positions + 3 * found, p)) found++;
      if (found == vertices) memcpy(positions + 3 * vertices++, p, sizeof p);
      middle[e] = (uint32_t)found;
    }
    const uint32_t four[12] = {v[0],      middle[0], middle[2], middle[0], v[1],      middle[1],
                               middle[2], middle[1], v[2],      middle[0], middle[1], middle[2]};
    memcpy(triangles + 12 * t, four, sizeof four);
  }
  free(mesh->positions);
  free(mesh->triangles);
  *mesh = (scree_mesh){positions, triangles, vertices, 4 * n};
}

static scree_particle *make_tray(size_t triangles) {
  /* outer corners 0 to 7, of the recess 8 to 15: its floor 8 to 11, its rim 12 to 15 */
  static const uint32_t faces[28][3] = {
      {0, 2, 1},   {1, 2, 3},    {0, 1, 4},   {1, 5, 4},   {2, 6, 3},    {3, 6, 7},
      {0, 4, 2},   {2, 4, 6},    {1, 3, 5},   {3, 7, 5},   {4, 5, 12},   {5, 13, 12},
      {5, 7, 13},  {7, 15, 13},  {7, 6, 15},  {6, 14, 15}, {6, 4, 14},   {4, 12, 14},
      {8, 9, 10},  {9, 11, 10},  {8, 12, 9},  {9, 12, 13}, {10, 11, 14}, {11, 15, 14},
      {8, 10, 12}, {10, 14, 12}, {9, 13, 11}, {11, 13, 15}};
  scree_mesh mesh = {malloc(48 * sizeof(double)), malloc(sizeof faces), 16, 28};
  if (!mesh.positions || !mesh.triangles) abort();
  const double low[3] = {0, 0, 0}, high[3] = {0.1, 0.05, 0.015};
  const double floor_low[3] = {0.01, 0.01, 0.005}, floor_high[3] = {0.09, 0.04, 0.015};
  put_corners(mesh.positions, low, high);
  put_corners(mesh.positions + 24, floor_low, floor_high);
  memcpy(mesh.triangles, faces, sizeof faces);
  while (mesh.triangle_count < triangles) cut_in_four(&mesh);
  scree_particle *particle = particle_of(&mesh);
  free(mesh.positions);
  free(mesh.triangles);
  return particle;
}

void make_shapes(const char *kind, size_t triangles, shape_set *set) {
  set->count = 0;
  if (strcmp(kind, "boxes") == 0) {
    set->items[set->count++] = make_box();
  } else if (strcmp(kind, "tray") == 0) {
    set->items[set->count++] = make_tray(triangles);
  } else if (strcmp(kind, "devices") == 0) {
    for (size_t i = 0; i < SCREE_SAMPLE_DEVICES; i++)
      set->items[set->count++] = make_device(scree_sample_name(i), triangles);
  } else {
    fprintf(stderr, "bench_world: no shapes are called %s\n", kind);
    exit(2);
  }
}

void free_shapes(shape_set *set) {
  for (size_t i = 0; i < set->count; i++) scree_particle_free(set->items[i]);
}
