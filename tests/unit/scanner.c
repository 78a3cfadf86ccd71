/* The scanner's noise against what scanner.h says of it. */
#include "sample/scanner.h"
#include "sample/test_solid.h"

#include "base/rng.h"
#include "support/check.h"

/* Mean 0, variance 1, and the correlation that the lattices imply, over many places. */
static void field_has_its_statistics(void **state) {
  (void)state;
  enum { PLACES = 40000, LAGS = 4 };
  const double lags[LAGS] = {0, 0.135e-3, 0.27e-3, 1.08e-3};
  double mean = 0, product[LAGS] = {0};
  scree_rng rng = {5, 0, 0};
  for (int i = 0; i < PLACES; i++) { /* over 2 m, so that places are independent */
    vec3 p = {scree_rng_uniform(&rng) * 2 - 1, scree_rng_uniform(&rng) * 2 - 1,
              scree_rng_uniform(&rng) * 2 - 1};
    double here = scree_scanner_field(9, p);
    mean += here / PLACES;
    for (int l = 0; l < LAGS; l++) {
      vec3 q = p;
      if (i % 3 == 0) q.x += lags[l];
      if (i % 3 == 1) q.y -= lags[l];
      if (i % 3 == 2) q.z += lags[l];
      product[l] += here * scree_scanner_field(9, q) / PLACES;
    }
  }
  CHECK_NEAR(mean, 0, 0.02); /* four standard errors */
  CHECK_NEAR(scree_scanner_correlation(0), 1, 1e-12);
  for (int l = 0; l < LAGS; l++) CHECK_NEAR(product[l], scree_scanner_correlation(lags[l]), 0.03);
  assert_true(product[2] > 0.4 && product[2] < 0.65);
}

static void field_depends_on_place_and_seed_only(void **state) {
  (void)state;
  vec3 p = {0.0123, -0.0456, 0.0078};
  double here = scree_scanner_field(1, p);
  assert_true(here == scree_scanner_field(1, p));
  assert_true(here != scree_scanner_field(2, p));
  p.x += 1e-9;
  CHECK_NEAR(scree_scanner_field(1, p), here, 1e-4); /* smooth */
}

static void coverage_is_one_on_the_average(void **state) {
  (void)state;
  enum { DIRECTIONS = 20000 };
  double inverse = 0, least = 10, most = 0;
  scree_rng rng = {6, 0, 0};
  for (int i = 0; i < DIRECTIONS; i++) {
    double c = scree_scanner_coverage(scree_rng_direction(&rng));
    inverse += 1 / (c * c) / DIRECTIONS;
    least = c < least ? c : least;
    most = c > most ? c : most;
  }
  CHECK_NEAR(inverse, 1, 0.01);
  assert_true(least > 0.6 && most < 2 && most > 1.15 * least);
}

/* Noise on a gridded cube: how far its vertices moved. */
static void edges_are_noisier_than_faces(void **state) {
  (void)state;
  enum { CELLS = 120 };
  const double cell = 0.27e-3, half = 0.5 * CELLS * cell, sigma = 0.02e-3;
  scree_mesh clean, noisy;
  scree_error error;
  scree_scanner scanner = {sigma, 4};
  CHECK_OK(scree_sample_box(2 * half, CELLS, &clean, &error), error);
  CHECK_OK(scree_sample_box(2 * half, CELLS, &noisy, &error), error);
  CHECK_OK(scree_scanner_apply(&scanner, &noisy, &error), error);
  double sum[2] = {0, 0};
  size_t count[2] = {0, 0};
  for (size_t v = 0; v < clean.vertex_count; v++) {
    vec3 a = vec3_load(clean.positions + 3 * v), b = vec3_load(noisy.positions + 3 * v);
    int on = (fabs(a.x) > half - 1e-9) + (fabs(a.y) > half - 1e-9) + (fabs(a.z) > half - 1e-9);
    vec3 normal = {(fabs(a.x) > half - 1e-9) * a.x, (fabs(a.y) > half - 1e-9) * a.y,
                   (fabs(a.z) > half - 1e-9) * a.z};
    double d2 = vec3_norm2(vec3_sub(b, a));
    double c = on == 1 ? scree_scanner_coverage(vec3_unit(normal)) : 1;
    if (on == 1) assert_true(vec3_norm(vec3_cross(vec3_sub(b, a), normal)) < 1e-9 * sigma);
    sum[on > 1] += d2 / (c * c);
    count[on > 1]++;
  }
  double face = sqrt(sum[0] / (double)count[0]) / sigma,
         edge = sqrt(sum[1] / (double)count[1]) / sigma;
  CHECK_NEAR(face, 1, 0.05);
  assert_true(edge > 1.3 * face && edge < 3 * face);
  scree_mesh_free(&clean);
  scree_mesh_free(&noisy);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(field_has_its_statistics),
      cmocka_unit_test(field_depends_on_place_and_seed_only),
      cmocka_unit_test(coverage_is_one_on_the_average),
      cmocka_unit_test(edges_are_noisier_than_faces),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
