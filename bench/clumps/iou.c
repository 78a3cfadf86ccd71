/* Intersection over union of clumps and the body they stand for, by points of its own: along
 * parallel lines, one at random in each square of a grid, each within the body by the crossings of
 * all triangles below it.
 * usage: bench_clumps FILE UNIT_M MOST POINTS [METHOD]; a row on stdout for every count, of one
 * method or of all. */
#include "scree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ON_LINE = 100, MOST_CROSSINGS = 1000, METHODS = 5 };
static const size_t counts[] = {5, 10, 20, 50, 100};

static uint64_t state;

/* In [0, 1): a linear congruential generator with Knuth's constants. */
static double next_random(void) {
  state = 6364136223846793005u * state + 1442695040888963407u;
  return (double)(state >> 11) / 9007199254740992.0;
}

/* Heights at which the line (x, y) along z crosses the surface. */
static size_t cross(const scree_mesh *mesh, double x, double y, double heights[MOST_CROSSINGS]) {
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count && count < MOST_CROSSINGS; t++) {
    const double *p[3];
    double w[3];
    for (size_t k = 0; k < 3; k++) p[k] = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + k];
    for (int k = 0; k < 3; k++) {
      const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
      w[k] = (a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x);
    }
    if (!((w[0] > 0 && w[1] > 0 && w[2] > 0) || (w[0] < 0 && w[1] < 0 && w[2] < 0))) continue;
    heights[count++] = (w[0] * p[0][2] + w[1] * p[1][2] + w[2] * p[2][2]) / (w[0] + w[1] + w[2]);
  }
  return count;
}

static bool in_spheres(const scree_clump *clump, const double p[3]) {
  for (size_t i = 0; i < clump->sphere_count; i++) {
    const scree_sphere *s = &clump->spheres[i];
    double x = p[0] - s->centre[0], y = p[1] - s->centre[1], z = p[2] - s->centre[2];
    if (x * x + y * y + z * z < s->radius * s->radius) return true;
  }
  return false;
}

static void find_box(const scree_mesh *mesh, const scree_clump *clump, double low[3],
                     double high[3]) {
  for (int k = 0; k < 3; k++) {
    low[k] = INFINITY, high[k] = -INFINITY;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
      low[k] = fmin(low[k], mesh->positions[3 * v + (size_t)k]);
      high[k] = fmax(high[k], mesh->positions[3 * v + (size_t)k]);
    }
    for (size_t i = 0; i < clump->sphere_count; i++) {
      const scree_sphere *s = &clump->spheres[i];
      low[k] = fmin(low[k], s->centre[k] - s->radius);
      high[k] = fmax(high[k], s->centre[k] + s->radius);
    }
  }
}

static double measure_iou(const scree_mesh *mesh, const scree_clump *clump, size_t points) {
  double low[3], high[3], heights[MOST_CROSSINGS];
  size_t both = 0, either = 0;
  find_box(mesh, clump, low, high);
  state = 41;
  size_t side = (size_t)sqrt((double)points / ON_LINE);
  for (size_t line = 0; line < side * side; line++) {
    double p[3];
    const size_t square[2] = {line / side, line % side};
    for (int k = 0; k < 2; k++)
      p[k] = low[k] + (high[k] - low[k]) * ((double)square[k] + next_random()) / (double)side;
    size_t crossed = cross(mesh, p[0], p[1], heights);
    for (int i = 0; i < ON_LINE; i++) {
      size_t below = 0;
      p[2] = low[2] + (high[2] - low[2]) * (i + next_random()) / ON_LINE;
      for (size_t k = 0; k < crossed; k++) below += heights[k] < p[2];
      bool inside = below % 2, covered = in_spheres(clump, p);
      both += inside && covered;
      either += inside || covered;
    }
  }
  return (double)both / (double)either;
}

/* A method may give fewer spheres than asked for. */
static void compare(const scree_mesh *mesh, const char *name, size_t most, size_t points,
                    const char *only) {
  for (int method = 0; method < METHODS; method++) {
    if (only && strcmp(only, scree_clump_method_name((scree_clump_method)method)) != 0) continue;
    scree_clump_options o = scree_default_clump_options();
    scree_clumps clumps;
    scree_error error;
    clock_t begin = clock();
    o.method = (scree_clump_method)method;
    o.most = most;
    if (scree_clumps_make(mesh, &o, NULL, &clumps, &error) != SCREE_OK) {
      fprintf(stderr, "%s, %s: %s\n", name, scree_clump_method_name(o.method), error.message);
      continue;
    }
    double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
    for (size_t k = 0; k < sizeof counts / sizeof *counts && counts[k] <= most; k++) {
      const scree_clump *c = scree_clumps_of_count(&clumps, counts[k]);
      printf("%s,%s,%zu,%zu,%.5f,%.5f,%.5f,%.5f,%.5f,%.2f\n", name,
             scree_clump_method_name(o.method), counts[k], c->sphere_count,
             measure_iou(mesh, c, points), c->iou, c->volume_error, c->centroid_error,
             c->inertia_error, seconds);
    }
    fflush(stdout);
    scree_clumps_free(&clumps);
  }
}

int main(int argc, char **argv) {
  scree_read_options read = scree_default_read_options();
  scree_scan scan;
  scree_error error;
  if (argc != 5 && argc != 6) {
    fprintf(stderr, "usage: %s FILE UNIT_M MOST POINTS [METHOD]\n", argv[0]);
    return 2;
  }
  read.unit_m = atof(argv[2]);
  if (scree_scan_read(argv[1], &read, &scan, &error) != SCREE_OK) {
    fprintf(stderr, "%s\n", error.message);
    return 1;
  }
  const char *slash = strrchr(argv[1], '/');
  char name[200];
  snprintf(name, sizeof name, "%s", slash ? slash + 1 : argv[1]);
  if (strrchr(name, '.')) *strrchr(name, '.') = 0;
  compare(&scan.mesh, name, strtoul(argv[3], NULL, 10), strtoul(argv[4], NULL, 10),
          argc > 5 ? argv[5] : NULL);
  scree_scan_free(&scan);
  return 0;
}
