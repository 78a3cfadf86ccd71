/* How good decimated levels are, whoever made them:
 *
 *   bench_quality SCAN LEVEL...
 *
 * One CSV line per level, lengths in the file's unit:
 *   file,triangles,eps_s,eps_v,mean,mean_back,hausdorff,folds,worst_fold_deg,crossings,
 *   nonmanifold_edges,nonmanifold_vertices,boundary_edges,degenerate
 * mean goes from the scan to the level, mean_back from the level to the scan, the Hausdorff
 * distance is the larger maximum of both ways; eps_v is signed. A fold is an edge of two facets
 * whose normals differ by more than 150 degrees; crossings are pairs of facets that cross or
 * overlap, by exact arithmetic. "-" stands in place of the level's file for the scan's own line. */
#include <math.h>
#include <scree.h>
#include <stdlib.h>
#include <string.h>

#define FOLD_DEG 150.0
/* Points on each surface besides its vertices: small bodies would get few by default. */
enum { SAMPLES = 400000 };

typedef struct {
  uint32_t low, high, facet;
} edge;

static int by_vertices(const void *a, const void *b) {
  const edge *x = a, *y = b;
  if (x->low != y->low) return x->low < y->low ? -1 : 1;
  if (x->high != y->high) return x->high < y->high ? -1 : 1;
  return (x->facet > y->facet) - (x->facet < y->facet);
}

static void normal_of(const scree_mesh *mesh, size_t facet, double *n) {
  const uint32_t *t = mesh->triangles + 3 * facet;
  const double *a = mesh->positions + 3 * (size_t)t[0];
  const double *b = mesh->positions + 3 * (size_t)t[1];
  const double *c = mesh->positions + 3 * (size_t)t[2];
  double u[3], v[3];
  for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
  for (int k = 0; k < 3; k++)
    n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

/* The angle between two normals, well conditioned near 0 and 180 degrees. */
static double angle_deg(const double *p, const double *q) {
  double dot = 0, cross = 0;
  for (int k = 0; k < 3; k++) {
    const double c = p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
    cross += c * c;
    dot += p[k] * q[k];
  }
  return atan2(sqrt(cross), dot) * 180 / 3.14159265358979323846;
}

static size_t count_folds(const scree_mesh *mesh, double *worst_deg) {
  const size_t edge_count = 3 * mesh->triangle_count;
  edge *edges = malloc(edge_count * sizeof *edges);
  size_t folds = 0;
  if (!edges) return SIZE_MAX;
  for (size_t i = 0; i < edge_count; i++) {
    const uint32_t v = mesh->triangles[i], w = mesh->triangles[i % 3 == 2 ? i - 2 : i + 1];
    edges[i] = (edge){v < w ? v : w, v < w ? w : v, (uint32_t)(i / 3)};
  }
  qsort(edges, edge_count, sizeof *edges, by_vertices);
  *worst_deg = 0;
  for (size_t i = 0, next; i < edge_count; i = next) {
    for (next = i + 1;
         next < edge_count && edges[next].low == edges[i].low && edges[next].high == edges[i].high;)
      next++;
    if (next - i != 2) continue;
    double p[3], q[3];
    normal_of(mesh, edges[i].facet, p);
    normal_of(mesh, edges[i + 1].facet, q);
    const double angle = angle_deg(p, q);
    *worst_deg = fmax(*worst_deg, angle);
    folds += angle > FOLD_DEG;
  }
  free(edges);
  return folds;
}

static scree_status read_file(const char *path, scree_scan *scan, scree_error *error) {
  scree_read_options options = scree_default_read_options();
  options.unit_m = 1;
  return scree_scan_read(path, &options, scan, error);
}

static scree_status area_volume(const scree_mesh *mesh, double *area, double *volume,
                                scree_error *error) {
  scree_measures measures;
  const scree_status status = scree_mesh_measure(mesh, &measures, error);
  if (status != SCREE_OK) return status;
  *area = measures.area;
  *volume = measures.volume;
  return SCREE_OK;
}

static scree_status judge(const scree_mesh *scan, const scree_surface *surface, const char *path,
                          scree_error *error) {
  scree_scan level = {0};
  const scree_mesh *mesh = scan;
  scree_surface *level_surface = NULL;
  scree_distance_options options = scree_default_distance_options();
  scree_distance d;
  scree_check check;
  double area[2], volume[2], worst_deg = 0;
  scree_status status = SCREE_OK;
  if (strcmp(path, "-") != 0) {
    status = read_file(path, &level, error);
    mesh = &level.mesh;
  }
  if (status == SCREE_OK) status = area_volume(scan, &area[0], &volume[0], error);
  if (status == SCREE_OK) status = area_volume(mesh, &area[1], &volume[1], error);
  if (status == SCREE_OK) status = scree_surface_create(mesh, &level_surface, error);
  options.sample_count = SAMPLES;
  if (status == SCREE_OK)
    status = scree_surface_distance(surface, level_surface, &options, NULL, &d, error);
  if (status == SCREE_OK) status = scree_mesh_check(mesh, NULL, NULL, &check, error);
  if (status == SCREE_OK) {
    const size_t folds = count_folds(mesh, &worst_deg);
    const size_t *defects = check.defects;
    printf("%s,%zu,%.6g,%.3g,%.5g,%.5g,%.5g,%zu,%.2f,%zu,%zu,%zu,%zu,%zu\n", path,
           mesh->triangle_count, fabs(area[1] - area[0]) / area[0],
           (volume[1] - volume[0]) / volume[0], d.forward.mean, d.backward.mean, d.hausdorff, folds,
           worst_deg, defects[SCREE_DEFECT_CROSSING_PAIR] + defects[SCREE_DEFECT_OVERLAPPING_PAIR],
           defects[SCREE_DEFECT_NON_MANIFOLD_EDGE], defects[SCREE_DEFECT_NON_MANIFOLD_VERTEX],
           defects[SCREE_DEFECT_BOUNDARY_EDGE],
           defects[SCREE_DEFECT_DEGENERATE_FACET] + level.degenerate_count);
    fflush(stdout);
  }
  scree_surface_free(level_surface);
  scree_scan_free(&level);
  return status;
}

int main(int argc, char **argv) {
  scree_scan scan = {0};
  scree_surface *surface = NULL;
  scree_error error;
  if (argc < 3) {
    fprintf(stderr, "usage: %s SCAN LEVEL...\n", argv[0]);
    return 2;
  }
  scree_status status = read_file(argv[1], &scan, &error);
  if (status == SCREE_OK) status = scree_surface_create(&scan.mesh, &surface, &error);
  for (int i = 2; status == SCREE_OK && i < argc; i++) {
    status = judge(&scan.mesh, surface, argv[i], &error);
    if (status == SCREE_OK) continue;
    fprintf(stderr, "%s\n", error.message); /* one bad level is no reason to stop */
    status = SCREE_OK;
  }
  if (status != SCREE_OK) fprintf(stderr, "%s\n", error.message);
  scree_surface_free(surface);
  scree_scan_free(&scan);
  return status == SCREE_OK ? 0 : 1;
}
