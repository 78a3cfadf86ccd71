/* A fitted level is nearer to the scan, by distances found slowly from all triangles, and as sound
 * as before: same triangles, volume, no crossing, fold or sliver that was not there. */
#include "base/vec.h"
#include "mesh/index/closest.h"
#include "support/alloc_fail.h"
#include "support/curve.h"
#include "support/shapes.h"

#include <stdlib.h>

static scree_mesh bumpy_sphere(int level, uint64_t seed) {
  scree_rng rng = {.seed = seed};
  scree_mesh mesh = shape_icosphere(0.03, level);
  shape_roughen(&mesh, 0.1, &rng);
  return mesh;
}

static vec3 corner(const scree_mesh *mesh, size_t t, int k) {
  return vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)k]);
}

static vec3 normal_of(const scree_mesh *mesh, size_t t) {
  return vec3_triangle_normal(corner(mesh, t, 0), corner(mesh, t, 1), corner(mesh, t, 2));
}

static double distance_from_all(const scree_mesh *mesh, vec3 p) {
  double best = INFINITY, corners[9];
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    vec3 point;
    for (int k = 0; k < 3; k++) vec3_store(corners + 3 * k, corner(mesh, t, k));
    best = fmin(best, scree_triangle_closest(corners, p, &point));
  }
  return sqrt(best);
}

/* The mean distance of the scan's vertices from the level, by the area around them. */
static double mean_distance(const scree_mesh *scan, const scree_mesh *level) {
  double *area = calloc(scan->vertex_count, sizeof *area), sum = 0, all = 0;
  assert_non_null(area);
  for (size_t i = 0; i < 3 * scan->triangle_count; i++)
    area[scan->triangles[i]] += vec3_norm(normal_of(scan, i / 3));
  for (size_t v = 0; v < scan->vertex_count; v++) {
    sum += area[v] * distance_from_all(level, vec3_load(scan->positions + 3 * v));
    all += area[v];
  }
  free(area);
  return sum / all;
}

/* The least cosine between neighbours. */
static double worst_fold(const scree_mesh *mesh) {
  double worst = 1;
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
    for (size_t j = 0; j < i; j++) {
      uint32_t a = mesh->triangles[i], b = mesh->triangles[i % 3 == 2 ? i - 2 : i + 1];
      uint32_t c = mesh->triangles[j], d = mesh->triangles[j % 3 == 2 ? j - 2 : j + 1];
      if (a != d || b != c) continue;
      vec3 n = vec3_unit(normal_of(mesh, i / 3)), m = vec3_unit(normal_of(mesh, j / 3));
      worst = fmin(worst, vec3_dot(n, m));
    }
  return worst;
}

static void check_fitted(const scree_curve *curve, size_t index, const scree_mesh *scan,
                         bool gains) {
  scree_mesh plain, fitted;
  scree_error error;
  scree_check check;
  double area[2], volume[2];
  CHECK_OK(scree_curve_mesh(curve, index, &plain, &error), error);
  CHECK_OK(scree_curve_fit(curve, index, &fitted, &error), error);
  assert_int_equal(plain.vertex_count, fitted.vertex_count);
  assert_int_equal(plain.triangle_count, fitted.triangle_count);
  assert_memory_equal(plain.triangles, fitted.triangles,
                      3 * plain.triangle_count * sizeof *plain.triangles);
  CHECK_OK(scree_mesh_area_volume(&plain, &area[0], &volume[0], &error), error);
  CHECK_OK(scree_mesh_area_volume(&fitted, &area[1], &volume[1], &error), error);
  CHECK_NEAR(volume[0], volume[1], 1e-12 * fabs(volume[0]));
  CHECK_OK(scree_mesh_check(&fitted, NULL, NULL, &check, &error), error);
  for (int k = 0; k < SCREE_DEFECT_COUNT; k++) assert_int_equal(check.defects[k], 0);
  assert_true(worst_fold(&fitted) >= fmin(-0.5, worst_fold(&plain)) - 1e-9);
  double was = mean_distance(scan, &plain), is = mean_distance(scan, &fitted);
  assert_true(is <= was);
  if (gains) assert_true(is < 0.95 * was);
  scree_mesh_free(&plain);
  scree_mesh_free(&fitted);
}

/* The ball is rough from vertex to vertex, which its levels need not follow; the torus is smooth.
 */
static void a_fitted_level_is_nearer_and_as_sound(void **state) {
  (void)state;
  static const size_t targets[] = {300, 60, 12};
  scree_mesh bodies[] = {bumpy_sphere(4, 1), shape_torus(0.03, 0.01, 96, 48)};
  for (int k = 0; k < 2; k++)
    for (int m = 0; m < 2; m++) {
      scree_curve *curve = curve_of(&bodies[k], m ? SCREE_METHOD_QECD : SCREE_METHOD_VOLUME);
      for (int i = 0; i < 3; i++)
        check_fitted(curve, scree_curve_find(curve, targets[i]), &bodies[k], k == 1 && i == 0);
      scree_curve_free(curve);
    }
  for (int k = 0; k < 2; k++) scree_mesh_free(&bodies[k]);
}

/* The same bits for any number of threads; times the factor, a power of two, for a scaled scan. */
static void threads_and_scale_change_nothing(void **state) {
  (void)state;
  static const double factor = 1024;
  scree_mesh mesh[] = {bumpy_sphere(4, 3), bumpy_sphere(4, 3)}, fitted[2];
  scree_error error;
  scree_mesh_scale(&mesh[1], factor);
  for (int k = 0; k < 2; k++) {
    scree_set_threads(1 + 2 * k);
    scree_curve *curve = curve_of(&mesh[k], SCREE_METHOD_VOLUME);
    CHECK_OK(scree_curve_fit(curve, scree_curve_find(curve, 200), &fitted[k], &error), error);
    scree_curve_free(curve);
  }
  scree_set_threads(0);
  assert_int_equal(fitted[0].vertex_count, fitted[1].vertex_count);
  for (size_t i = 0; i < 3 * fitted[0].vertex_count; i++)
    assert_true(fitted[1].positions[i] == factor * fitted[0].positions[i]);
  for (int k = 0; k < 2; k++) scree_mesh_free(&fitted[k]), scree_mesh_free(&mesh[k]);
}

/* A box's level is exact: nothing is nearer. A sheet's boundary stays where it is. */
static void what_cannot_gain_stays(void **state) {
  (void)state;
  scree_mesh bodies[] = {shape_grid_box(0.1, 0.05, 0.02, 8), shape_sheet(0, 12)};
  for (int k = 0; k < 2; k++) {
    scree_curve *curve = curve_of(&bodies[k], SCREE_METHOD_VOLUME);
    scree_mesh plain, fitted;
    scree_error error;
    size_t last = scree_curve_level_count(curve) - 1,
           level = k == 0 ? scree_curve_find(curve, 12) : last;
    CHECK_OK(scree_curve_mesh(curve, level, &plain, &error), error);
    CHECK_OK(scree_curve_fit(curve, level, &fitted, &error), error);
    assert_memory_equal(plain.positions, fitted.positions,
                        3 * plain.vertex_count * sizeof *plain.positions);
    assert_int_equal(scree_curve_fit(curve, last + 1, &fitted, &error), SCREE_BAD_ARGUMENT);
    scree_mesh_free(&plain);
    scree_mesh_free(&fitted);
    scree_curve_free(curve);
    scree_mesh_free(&bodies[k]);
  }
}

static scree_status fit(void *context, scree_error *error) {
  const scree_curve *curve = context;
  scree_mesh mesh = {0};
  scree_status status = scree_curve_fit(curve, scree_curve_find(curve, 40), &mesh, error);
  scree_mesh_free(&mesh);
  return status;
}

static void failing_memory_is_told(void **state) {
  (void)state;
  scree_mesh ball = bumpy_sphere(3, 2);
  scree_curve *curve = curve_of(&ball, SCREE_METHOD_VOLUME);
  check_allocation_failures(fit, curve);
  scree_curve_free(curve);
  scree_mesh_free(&ball);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_fitted_level_is_nearer_and_as_sound),
                                     cmocka_unit_test(threads_and_scale_change_nothing),
                                     cmocka_unit_test(what_cannot_gain_stays),
                                     cmocka_unit_test(failing_memory_is_told)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
