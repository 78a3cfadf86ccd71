#include "support/overlap.h"

#include "base/rng.h"

#include <math.h>

enum { ON_LINE = 100, MOST_CROSSINGS = 1000 };

/* Where the line x = x0, y = y0 crosses the triangle, if it does. */
static bool crosses(const scree_mesh *mesh, size_t t, double x, double y, double *z) {
  const double *p[3];
  for (size_t k = 0; k < 3; k++) p[k] = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + k];
  double w[3], sum = 0;
  for (int k = 0; k < 3; k++) {
    const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
    w[k] = (a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x);
    sum += w[k];
  }
  bool inside = (w[0] > 0 && w[1] > 0 && w[2] > 0) || (w[0] < 0 && w[1] < 0 && w[2] < 0);
  if (inside) *z = (w[0] * p[0][2] + w[1] * p[1][2] + w[2] * p[2][2]) / sum;
  return inside;
}

static bool in_spheres(const scree_sphere *spheres, size_t count, const double p[3]) {
  for (size_t i = 0; i < count; i++) {
    double d2 = 0;
    for (int k = 0; k < 3; k++) {
      double d = p[k] - spheres[i].centre[k];
      d2 += d * d;
    }
    if (d2 < spheres[i].radius * spheres[i].radius) return true;
  }
  return false;
}

static void widen(double low[3], double high[3], const double *p, double reach) {
  for (int k = 0; k < 3; k++) {
    low[k] = fmin(low[k], p[k] - reach);
    high[k] = fmax(high[k], p[k] + reach);
  }
}

overlap_counts overlap_count(const scree_mesh *mesh, const scree_sphere *spheres, size_t count,
                             size_t line_count) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  overlap_counts o = {.points = line_count * ON_LINE};
  scree_rng rng = {.seed = 41};
  for (size_t v = 0; v < mesh->vertex_count; v++) widen(low, high, mesh->positions + 3 * v, 0);
  for (size_t i = 0; i < count; i++) widen(low, high, spheres[i].centre, spheres[i].radius);
  o.box_volume = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
  for (size_t line = 0; line < line_count; line++) {
    double p[3], crossings[MOST_CROSSINGS];
    size_t crossed = 0;
    for (int k = 0; k < 2; k++) p[k] = low[k] + (high[k] - low[k]) * scree_rng_uniform(&rng);
    for (size_t t = 0; t < mesh->triangle_count && crossed < MOST_CROSSINGS; t++)
      crossed += crosses(mesh, t, p[0], p[1], &crossings[crossed]);
    for (int i = 0; i < ON_LINE; i++) {
      p[2] = low[2] + (high[2] - low[2]) * (i + scree_rng_uniform(&rng)) / ON_LINE;
      size_t below = 0;
      for (size_t k = 0; k < crossed; k++) below += crossings[k] < p[2];
      bool in_mesh = below % 2 == 1, in_union = in_spheres(spheres, count, p);
      o.mesh += in_mesh;
      o.spheres += in_union;
      o.common += in_mesh && in_union;
    }
  }
  return o;
}

double overlap_iou(const overlap_counts *o) {
  return (double)o->common / (double)(o->mesh + o->spheres - o->common);
}
