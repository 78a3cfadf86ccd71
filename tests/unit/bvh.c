/* The tree against all triangles one by one, on surfaces, tangles with flat facets, needles and
 * grids; the nearest point of a triangle against a search. */
#include "support/check.h"
#include "support/shapes.h"

#include "mesh/index/bvh.h"
#include "mesh/mesh.h"

static scree_bvh build(const scree_mesh *mesh) {
  scree_bvh bvh;
  scree_error error;
  CHECK_OK(scree_bvh_build(mesh, &bvh, &error), error);
  return bvh;
}

static vec3 random_point(scree_rng *rng, double size) {
  return (vec3){size * scree_rng_normal(rng), size * scree_rng_normal(rng),
                size * scree_rng_normal(rng)};
}

/* ---- One triangle ---- */

/* The distance is convex over the triangle: a nested search on barycentric coordinates finds it. */
static double distance_at(const double *c, vec3 p, double u, double v) {
  vec3 a = vec3_load(c), b = vec3_load(c + 3), d = vec3_load(c + 6);
  vec3 q = vec3_mad(vec3_mad(a, vec3_sub(b, a), u), vec3_sub(d, a), v);
  return vec3_distance(p, q);
}

static double least_over_v(const double *c, vec3 p, double u) {
  double low = 0, high = 1 - u;
  for (int i = 0; i < 60; i++) {
    double third = (high - low) / 3;
    if (distance_at(c, p, u, low + third) < distance_at(c, p, u, high - third))
      high -= third;
    else
      low += third;
  }
  return distance_at(c, p, u, (low + high) / 2);
}

static double searched_distance(const double *c, vec3 p) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; i++) {
    double third = (high - low) / 3;
    if (least_over_v(c, p, low + third) < least_over_v(c, p, high - third))
      high -= third;
    else
      low += third;
  }
  return least_over_v(c, p, (low + high) / 2);
}

static void random_triangle(scree_rng *rng, int kind, double c[9]) {
  for (int i = 0; i < 9; i++) c[i] = scree_rng_normal(rng);
  if (kind == 1) { /* a needle: the third corner almost on the line of the others */
    double height = exp(-25 * scree_rng_uniform(rng)), at = 3 * scree_rng_uniform(rng) - 1;
    for (int k = 0; k < 3; k++) c[6 + k] = c[k] + at * (c[3 + k] - c[k]) + height * c[6 + k];
  } else if (kind == 2) { /* two corners almost or quite the same */
    double apart = scree_rng_below(rng, 2) ? exp(-30 * scree_rng_uniform(rng)) : 0;
    for (int k = 0; k < 3; k++) c[3 + k] = c[k] + apart * c[3 + k];
  } else if (kind == 3) { /* on a grid */
    for (int i = 0; i < 9; i++) c[i] = (double)scree_rng_below(rng, 3);
  }
}

static void test_triangle(void **state) {
  (void)state;
  scree_rng rng = {.seed = 20};
  for (int i = 0; i < 3000; i++) {
    double c[9];
    vec3 found;
    random_triangle(&rng, i % 4, c);
    vec3 p = i % 8 < 4 ? random_point(&rng, 2)
                       : vec3_mad(vec3_load(c), vec3_sub(vec3_load(c + 3), vec3_load(c + 6)),
                                  scree_rng_uniform(&rng));
    double d = sqrt(scree_triangle_closest(c, p, &found)), expected = searched_distance(c, p);
    CHECK_NEAR(d, expected, 1e-7 + 1e-7 * expected);
    /* the search may stop early on a needle, never below the truth */
    assert_true(d <= expected + 1e-10);
    CHECK_NEAR(vec3_distance(p, found), d, 1e-15 + 1e-15 * d);
  }
}

/* ---- Nearest points ---- */

static double brute_distance2(const scree_mesh *mesh, vec3 p) {
  double least = INFINITY;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    double c[9];
    vec3 point;
    for (int k = 0; k < 3; k++) vec3_store(c + 3 * k, scree_mesh_corner(mesh, t, k));
    least = fmin(least, scree_triangle_closest(c, p, &point));
  }
  return least;
}

static scree_mesh random_surface(scree_rng *rng, int kind) {
  if (kind == 0) return shape_random_tangle(rng);
  if (kind == 1) return shape_grid_box(1, 2, 0.01, 6);
  if (kind == 2) return shape_sheet(0, 9);
  if (kind == 3) return shape_torus(1, 0.4, 30, 14);
  scree_mesh mesh = shape_make(300, 100);
  for (size_t i = 0; i < 900; i++)
    mesh.positions[i] = exp(6 * scree_rng_normal(rng)) * scree_rng_normal(rng);
  for (uint32_t i = 0; i < 300; i++) mesh.triangles[i] = i;
  return mesh;
}

static void test_closest(void **state) {
  (void)state;
  scree_rng rng = {.seed = 21};
  for (int i = 0; i < 200; i++) {
    scree_mesh mesh = random_surface(&rng, i % 5);
    scree_bvh bvh = build(&mesh);
    for (int k = 0; k < 60; k++) {
      vec3 p = random_point(&rng, exp(2 * scree_rng_normal(&rng)));
      double expected = brute_distance2(&mesh, p);
      scree_bvh_hit hit = {.distance2 = INFINITY};
      assert_int_equal(scree_bvh_closest(&bvh, p, &hit), mesh.triangle_count > 0);
      if (mesh.triangle_count == 0) continue;
      CHECK_NEAR(hit.distance2, expected, 4e-16 * expected);
      CHECK_NEAR(vec3_norm2(vec3_sub(p, hit.point)), expected, 4e-16 * expected);
      /* a bound above finds the same, a bound below finds nothing */
      scree_bvh_hit bounded = {.distance2 = expected * (1 + 1e-12) + 1e-300};
      assert_true(scree_bvh_closest(&bvh, p, &bounded));
      CHECK_NEAR(bounded.distance2, expected, 4e-16 * expected);
      bounded.distance2 = expected;
      bounded.index = 12345;
      assert_false(scree_bvh_closest(&bvh, p, &bounded));
      assert_int_equal(bounded.index, 12345);
    }
    scree_bvh_free(&bvh);
    scree_mesh_free(&mesh);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_triangle),
      cmocka_unit_test(test_closest),
  };
  scree_set_threads(
      1); /* thousands of tiny trees: waking threads would take longer than the work */
  return cmocka_run_group_tests(tests, NULL, NULL);
}
