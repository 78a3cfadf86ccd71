#include "cli/render_refine.h"

#include <math.h>
#include <stdlib.h>

static const double wanted_triangles = 400000;

static double doubled_area(const scree_mesh *mesh, size_t t) {
  const double *p[3];
  double u[3], v[3];
  for (int i = 0; i < 3; i++)
    p[i] = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)i];
  for (int k = 0; k < 3; k++) {
    u[k] = p[1][k] - p[0][k];
    v[k] = p[2][k] - p[0][k];
  }
  double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Into how many parts the sides of triangle t are cut. */
static size_t cuts(const scree_mesh *mesh, size_t t, double total) {
  double share = total > 0 ? doubled_area(mesh, t) / total : 0;
  return 1 + (size_t)sqrt(share * wanted_triangles);
}

/* The corners of small triangle (i, j) of n x n, the upper or the lower one of its cell. */
static double *put_small(double *out, const double *p[3], size_t n, size_t i, size_t j,
                         bool upper) {
  size_t at[3][2] = {{i, j}, {i + 1, j}, {i, j + 1}};
  if (upper) {
    at[0][0]++;
    at[1][1]++;
  }
  for (int c = 0; c < 3; c++) {
    double b = (double)at[c][0] / (double)n, d = (double)at[c][1] / (double)n;
    for (int k = 0; k < 3; k++)
      *out++ = p[0][k] + b * (p[1][k] - p[0][k]) + d * (p[2][k] - p[0][k]);
  }
  return out;
}

bool render_refine(scree_mesh *mesh) {
  if ((double)mesh->triangle_count > 0.5 * wanted_triangles) return true;
  double total = 0;
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) total += doubled_area(mesh, t);
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    size_t n = cuts(mesh, t, total);
    count += n * n;
  }
  double *corners = malloc((count + 1) * 9 * sizeof *corners), *out = corners;
  if (!corners) return false;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    size_t n = cuts(mesh, t, total);
    const double *p[3];
    for (int c = 0; c < 3; c++)
      p[c] = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)c];
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; i + j < n; j++) {
        out = put_small(out, p, n, i, j, false);
        if (i + j + 1 < n) out = put_small(out, p, n, i, j, true);
      }
  }
  scree_mesh made;
  scree_error error;
  bool done = scree_mesh_weld(corners, count, 0, &made, NULL, &error) == SCREE_OK;
  free(corners);
  if (!done) return false;
  scree_mesh_free(mesh);
  *mesh = made;
  return true;
}
