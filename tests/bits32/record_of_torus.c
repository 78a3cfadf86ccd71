/* Prints the record of a decimation: the levels' counts and, to the bit, every collapse. The mesh
 * is a bumpy torus, whose places are found by arithmetic that is the same on every machine. */
#include "base/math.h"
#include "base/parallel.h"
#include "base/rng.h"

#include <inttypes.h>
#include <scree.h>
#include <stdlib.h>
#include <string.h>

static void place(double *p, size_t i, size_t j, size_t around, size_t along, scree_rng *rng) {
  const double turn = 6.283185307179586;
  double u = turn * (double)i / (double)around, v = turn * (double)j / (double)along;
  double tube = 0.3 + 0.02 * scree_sin(7 * u) * scree_cos(5 * v) + 2e-4 * scree_rng_uniform(rng);
  p[0] = (1 + tube * scree_cos(v)) * scree_cos(u);
  p[1] = (1 + tube * scree_cos(v)) * scree_sin(u);
  p[2] = 0.5 * tube * scree_sin(v);
}

static scree_mesh torus(size_t around, size_t along) {
  scree_rng rng = {.seed = 1};
  scree_mesh mesh = {.vertex_count = around * along, .triangle_count = 2 * around * along};
  mesh.positions = calloc(3 * mesh.vertex_count, sizeof *mesh.positions);
  mesh.triangles = calloc(3 * mesh.triangle_count, sizeof *mesh.triangles);
  if (!mesh.positions || !mesh.triangles) exit(1);
  for (size_t i = 0, n = 0; i < around; i++)
    for (size_t j = 0; j < along; j++, n++) {
      size_t i1 = (i + 1) % around, j1 = (j + 1) % along;
      const uint32_t a = (uint32_t)n, b = (uint32_t)(i1 * along + j),
                     c = (uint32_t)(i1 * along + j1), d = (uint32_t)(i * along + j1);
      const uint32_t corners[6] = {a, b, c, a, c, d};
      place(mesh.positions + 3 * n, i, j, around, along, &rng);
      memcpy(mesh.triangles + 6 * n, corners, sizeof corners);
    }
  return mesh;
}

static void print_record(const scree_mesh *mesh, scree_method method) {
  scree_simplify_options options = scree_default_simplify_options();
  scree_curve *curve = NULL;
  scree_error error;
  options.method = method;
  if (scree_curve_build(mesh, &options, NULL, &curve, &error) != SCREE_OK) {
    printf("%s\n", error.message);
    exit(1);
  }
  printf("%s: %zu levels, floor %zu\n", scree_method_name(method), scree_curve_level_count(curve),
         scree_curve_get_facts(curve).floor_count);
  for (size_t i = 0; i < scree_curve_collapse_count(curve); i++) {
    scree_collapse c;
    uint64_t bits[3];
    scree_curve_collapse(curve, i, &c);
    memcpy(bits, c.position, sizeof bits);
    printf("%" PRIu32 " %" PRIu32 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n", c.kept, c.gone,
           bits[0], bits[1], bits[2]);
  }
  scree_curve_free(curve);
}

int main(void) {
  scree_mesh mesh = torus(160, 80);
  scree_set_threads(1);
  print_record(&mesh, SCREE_METHOD_VOLUME);
  print_record(&mesh, SCREE_METHOD_QECD);
  free(mesh.positions);
  free(mesh.triangles);
  return 0;
}
