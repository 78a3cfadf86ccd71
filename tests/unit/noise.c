/* A scanner's noise is told with its size, or is said to be untold: of spheres, boxes and cylinders
 * of few facets and many, of levels of clean devices, with noise of known size along the normals
 * and without. */
#include "choice/gauge.h"
#include "mesh/mesh.h"
#include "support/curve.h"
#include "support/shapes.h"

#include <stdlib.h>

/* Around the z axis, ends as fans. */
static scree_mesh cylinder(size_t around, size_t along, double length) {
  scree_mesh mesh = shape_make(2 + around * (along + 1), 2 * around * (along + 1));
  uint32_t *t = mesh.triangles;
  for (size_t end = 0; end < 2; end++)
    vec3_store(mesh.positions + 3 * end, (vec3){0, 0, end ? length : 0});
  for (size_t i = 0; i <= along; i++)
    for (size_t j = 0; j < around; j++) {
      double angle = 2 * acos(-1) * (double)j / (double)around;
      vec3_store(mesh.positions + 3 * (2 + i * around + j),
                 (vec3){cos(angle), sin(angle), length * (double)i / (double)along});
    }
  for (size_t j = 0; j < around; j++) {
    uint32_t a = (uint32_t)(2 + j), b = (uint32_t)(2 + (j + 1) % around),
             top = (uint32_t)(along * around);
    const uint32_t ends[] = {0, b, a, 1, a + top, b + top};
    for (int k = 0; k < 6; k++) *t++ = ends[k];
    for (uint32_t i = 0; i < along; i++) {
      uint32_t below = i * (uint32_t)around, above = below + (uint32_t)around;
      const uint32_t square[] = {a + below, b + below, b + above, a + below, b + above, a + above};
      for (int k = 0; k < 6; k++) *t++ = square[k];
    }
  }
  return mesh;
}

static double spacing_of(const scree_mesh *mesh) {
  scree_error error;
  double area;
  CHECK_OK(scree_mesh_area_volume(mesh, &area, NULL, &error), error);
  return sqrt(area / (double)mesh->vertex_count);
}

static void add_noise(scree_mesh *mesh, double sigma, scree_rng *rng) {
  vec3 *normals = calloc(mesh->vertex_count, sizeof *normals);
  assert_non_null(normals);
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
    vec3 *n = &normals[mesh->triangles[i]];
    *n = vec3_add(*n, scree_facet_normal(mesh, i / 3));
  }
  for (size_t v = 0; v < mesh->vertex_count; v++)
    vec3_store(mesh->positions + 3 * v,
               vec3_mad(vec3_load(mesh->positions + 3 * v), vec3_unit(normals[v]),
                        sigma * scree_rng_normal(rng)));
  free(normals);
}

/* At the middles of the facets, each as often as its area asks for. */
static scree_fit fit_of(const scree_mesh *mesh, scree_rng *rng) {
  enum { POINTS = 2000 };
  static vec3 points[POINTS], normals[POINTS];
  double area = 0, share, done = 0;
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) area += vec3_norm(scree_facet_normal(mesh, t));
  share = area / POINTS;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    vec3 n = scree_facet_normal(mesh, t), corner = scree_mesh_corner(mesh, t, 0),
         e = vec3_sub(scree_mesh_corner(mesh, t, 1), corner),
         f = vec3_sub(scree_mesh_corner(mesh, t, 2), corner);
    done += vec3_norm(n);
    for (; count < POINTS && ((double)count + 0.5) * share <= done; count++) {
      double u = scree_rng_uniform(rng), v = scree_rng_uniform(rng);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      points[count] = vec3_mad(vec3_mad(corner, e, u), f, v);
      normals[count] = vec3_unit(n);
    }
  }
  scree_fit fit;
  scree_error error;
  CHECK_OK(scree_fit_points(mesh, points, normals, count, &fit, &error), error);
  return fit;
}

/* Whether the noise was told. */
static bool check_noise(scree_mesh mesh, scree_rng *rng) {
  double spacing = spacing_of(&mesh), sigma = 0, area[2];
  scree_error error;
  CHECK_OK(scree_mesh_area_volume(&mesh, &area[0], NULL, &error), error);
  if (scree_rng_below(rng, 3) > 0) sigma = spacing * pow(10, -2 + 1.3 * scree_rng_uniform(rng));
  if (sigma > 0) add_noise(&mesh, sigma, rng);
  CHECK_OK(scree_mesh_area_volume(&mesh, &area[1], NULL, &error), error);
  scree_fit fit = fit_of(&mesh, rng);
  scree_mesh_free(&mesh);
  assert_true(fit.area_share > 0 && fit.area_share <= 1);
  if (isnan(fit.sigma)) {
    assert_true(fit.area_share == 1);
    return false;
  }
  CHECK_NEAR(fit.sigma, sigma, 0.3 * sigma + 0.012 * spacing);
  CHECK_NEAR(fit.area_share * area[1] / area[0], 1, 0.04);
  return true;
}

static void noise_of_any_body_is_told_or_said_to_be_untold(void **state) {
  (void)state;
  scree_rng rng = {.seed = 71};
  size_t told = 0;
  for (int i = 0; i < 150; i++) {
    double a = 0.2 + scree_rng_uniform(&rng), b = 0.2 + scree_rng_uniform(&rng);
    size_t n = 1 + scree_rng_below(&rng, 24), m = 8 + scree_rng_below(&rng, 100);
    switch (i % 3) {
    case 0:
      told += check_noise(shape_icosphere(a, 1 + (int)(n % 4)), &rng);
      break;
    case 1:
      told += check_noise(shape_grid_box(1, a, b, n), &rng);
      break;
    default:
      told += check_noise(cylinder(m, n, 4 * a), &rng);
    }
  }
  assert_true(told > 50);
  /* of spheres of 1,280 facets and more, and fine boxes, in any case */
  for (int i = 0; i < 20; i++)
    assert_true(
        check_noise(i % 2 ? shape_icosphere(1, 3 + i / 10) : shape_grid_box(1, 1, 1, 20), &rng));
}

/* The facets of a device without noise are none. */
static void levels_of_devices_have_no_noise(void **state) {
  (void)state;
  static const char *const names[] = {"dc-1", "fp-1", "sp-1"};
  scree_rng rng = {.seed = 72};
  for (int k = 0; k < 3; k++) {
    scree_sample_options o = scree_default_sample_options();
    scree_mesh device;
    scree_error error;
    o.resolution = 1.5e-3;
    o.noise = 0;
    CHECK_OK(scree_sample_make(names[k], &o, NULL, &device, &error), error);
    scree_curve *curve = curve_of(&device, SCREE_METHOD_VOLUME);
    for (int i = 0; i < 12; i++) {
      size_t count = (size_t)(100 * pow(100, scree_rng_uniform(&rng)));
      scree_mesh level;
      CHECK_OK(scree_curve_mesh(curve, scree_curve_find(curve, count), &level, &error), error);
      check_noise(level, &rng);
    }
    scree_curve_free(curve);
    scree_mesh_free(&device);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(noise_of_any_body_is_told_or_said_to_be_untold),
      cmocka_unit_test(levels_of_devices_have_no_noise)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
