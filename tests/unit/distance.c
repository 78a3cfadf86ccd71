/* Distances between surfaces against closed forms, against brute force over dense samples, and the
 * bound against both. */
#include "support/check.h"
#include "support/shapes.h"

#include "mesh/index/bvh.h"
#include "mesh/mesh.h"

static scree_distance distance_of(const scree_mesh *a, const scree_mesh *b,
                                  const scree_distance_options *options) {
  scree_distance d;
  scree_error error;
  CHECK_OK(scree_mesh_distance(a, b, options, NULL, &d, &error), error);
  return d;
}

/* ---- Closed forms ---- */

static void test_plates(void **state) {
  (void)state;
  scree_rng rng = {.seed = 30};
  for (size_t n = 1; n < 30; n += 4) {
    scree_mesh a = shape_sheet(0, n), b = shape_sheet(0.125, 3);
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    vec3 offset = scree_rng_direction(&rng);
    shape_transform(&a, &turn, offset);
    shape_transform(&b, &turn, offset);
    scree_distance_options options = {.hausdorff_gap = 1e-3};
    scree_distance d = distance_of(&a, &b, &options);
    const scree_deviation *ways[2] = {&d.forward, &d.backward};
    for (int way = 0; way < 2; way++) {
      CHECK_NEAR(ways[way]->mean, 0.125, 1e-14);
      CHECK_NEAR(ways[way]->rms, 0.125, 1e-14);
      CHECK_NEAR(ways[way]->maximum, 0.125, 1e-14);
      assert_true(ways[way]->maximum_bound >= ways[way]->maximum);
      assert_true(ways[way]->maximum_bound <= 0.125 * 1.001);
    }
    scree_mesh_free(&a);
    scree_mesh_free(&b);
  }
}

/* A plate twice as long: the points beyond the shorter one's rim are farther. Distance from x
 * beyond the rim by u at height h: sqrt(h^2 + u^2); one half of the plate lies beyond. */
static void test_overhang(void **state) {
  (void)state;
  scree_mesh a = shape_sheet(0, 4), b = shape_sheet(0.25, 4);
  const mat3 longer = {{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  shape_transform(&a, &longer, (vec3){0, 0, 0});
  scree_distance_options options = scree_default_distance_options();
  options.sample_count = 400000;
  scree_distance d = distance_of(&a, &b, &options);
  double h = 0.25, end = sqrt(1 + h * h);
  double mean = 0.5 * h + 0.5 * (0.5 * end + 0.5 * h * h * asinh(1 / h));
  double square = 0.5 * h * h + 0.5 * (h * h + 1.0 / 3);
  CHECK_NEAR(d.forward.mean, mean, 1e-5);
  CHECK_NEAR(d.forward.rms, sqrt(square), 1e-5);
  CHECK_NEAR(d.hausdorff, end, 1e-14);
  assert_true(d.hausdorff_bound >= end && d.hausdorff_bound < end * 1.01);
  CHECK_NEAR(d.forward.at[0], 2, 1e-12);
  CHECK_NEAR(d.backward.mean, 0.25, 1e-14);
  assert_in_range(d.forward.sample_count, 200000, 800000);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
}

/* A square with a narrow pit along its diagonal, and two facets that bridge it: their common edge
 * runs over it, but no middle of a part of them. The middle of the edge is farthest off, from the
 * four walls alike: the planes x / a + y / b + z / c = 1. */
static void test_bridged_pit(void **state) {
  (void)state;
  const double half_length = 0.4 * sqrt(2), half_width = 1e-3, depth = 0.05,
               aside = half_width / sqrt(2);
  const double positions[] = {0,           0,           0,   1,   0,           0,           1,
                              1,           0,           0,   1,   0,           0.1,         0.1,
                              0,           0.9,         0.9, 0,   0.5 + aside, 0.5 - aside, 0,
                              0.5 - aside, 0.5 + aside, 0,   0.5, 0.5,         -depth};
  const uint32_t facets[] = {0, 1, 6, 1, 2, 6, 2, 5, 6, 0, 6, 4, 0, 7, 3, 3, 7, 2,
                             2, 7, 5, 0, 4, 7, 4, 6, 8, 6, 5, 8, 5, 7, 8, 7, 4, 8};
  const uint32_t halves[] = {0, 1, 2, 0, 2, 3};
  scree_mesh level = shape_make(4, 2), scan = shape_make(9, 12);
  memcpy(level.positions, positions, 12 * sizeof *positions);
  memcpy(level.triangles, halves, sizeof halves);
  memcpy(scan.positions, positions, sizeof positions);
  memcpy(scan.triangles, facets, sizeof facets);
  scree_distance_options options = {.sample_count = 20000}; /* 200 parts of the edge */
  scree_distance d = distance_of(&level, &scan, &options);
  double inverse2 = pow(half_length, -2) + pow(half_width, -2) + pow(depth, -2);
  CHECK_NEAR(d.forward.maximum, 1 / sqrt(inverse2), 1e-12);
  CHECK_NEAR(d.forward.at[0], 0.5, 1e-12);
  scree_mesh_free(&level);
  scree_mesh_free(&scan);
}

static void test_icosahedra(void **state) {
  (void)state;
  /* all faces have the same distance from the centre, 0.7947 of the radius */
  double inner = 1, outer = 1.25, face = sqrt((5 + 2 * sqrt(5)) / 15);
  scree_mesh a = shape_icosphere(inner, 0), b = shape_icosphere(outer, 0);
  scree_distance d = distance_of(&a, &b, NULL);
  CHECK_NEAR(d.forward.mean, (outer - inner) * face, 1e-14);
  CHECK_NEAR(d.forward.rms, (outer - inner) * face, 1e-14);
  CHECK_NEAR(d.forward.maximum_bound, (outer - inner) * face, 1e-14);
  CHECK_NEAR(d.backward.maximum, outer - inner, 1e-14);
  CHECK_NEAR(d.hausdorff_bound, outer - inner, 1e-14);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
}

/* Finer spheres: the Hausdorff distance of the polyhedra tends to the difference of the radii. */
static void test_spheres(void **state) {
  (void)state;
  scree_mesh a = shape_icosphere(1, 4), b = shape_icosphere(1.1, 5);
  scree_distance_options options = scree_default_distance_options();
  options.hausdorff_gap = 1e-4;
  scree_distance d = distance_of(&a, &b, &options);
  CHECK_NEAR(d.forward.mean, 0.1, 2e-3);
  CHECK_NEAR(d.backward.mean, 0.1, 2e-3);
  CHECK_NEAR(d.hausdorff, 0.1, 3e-3);
  assert_true(d.hausdorff_bound <= d.hausdorff * 1.0001 + 1e-11);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
}

/* By default mean and rms are within 1 per cent of dense samples, and so is the Hausdorff distance:
 * between coarse and fine surfaces too, where few samples fall on a facet. */
static void test_converged(void **state) {
  (void)state;
  scree_rng rng = {.seed = 33};
  for (size_t level = 0; level < 4; level++) {
    scree_mesh a = shape_icosphere(1, level), b = shape_icosphere(1, 5);
    shape_shake(&a, 0.05, &rng);
    scree_distance_options dense = {.sample_count = 400000, .hausdorff_gap = 1e-3};
    scree_distance d = distance_of(&a, &b, NULL), e = distance_of(&a, &b, &dense);
    CHECK_NEAR(d.forward.mean / e.forward.mean, 1, 0.005);
    CHECK_NEAR(d.forward.rms / e.forward.rms, 1, 0.005);
    CHECK_NEAR(d.backward.mean / e.backward.mean, 1, 0.005);
    CHECK_NEAR(d.hausdorff / e.hausdorff, 1, 0.01);
    assert_true(d.hausdorff_bound <= 1.0101 * d.hausdorff);
    scree_mesh_free(&a);
    scree_mesh_free(&b);
  }
}

/* A surface and the same surface cut finer, coincide. */
static void test_same_surface(void **state) {
  (void)state;
  scree_mesh a = shape_grid_box(1, 2, 3, 2), b = shape_grid_box(1, 2, 3, 3);
  scree_distance_options options = scree_default_distance_options();
  options.hausdorff_gap = 0.01;
  scree_distance d = distance_of(&a, &b, &options);
  assert_true(d.hausdorff < 1e-15 && d.forward.mean < 1e-15);
  assert_true(d.hausdorff_bound < 0.1); /* cut until the effort is spent */
  options.one_way = true;
  d = distance_of(&a, &b, &options);
  assert_int_equal(d.backward.sample_count, 0);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
}

/* ---- Brute force ---- */

static double brute_distance(const scree_mesh *mesh, vec3 p) {
  double least = INFINITY;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    double c[9];
    vec3 point;
    for (int k = 0; k < 3; k++) vec3_store(c + 3 * k, scree_mesh_corner(mesh, t, k));
    least = fmin(least, scree_triangle_closest(c, p, &point));
  }
  return sqrt(least);
}

typedef struct brute {
  double mean, rms, maximum;
} brute;

/* Midpoint rule on n x n parts of every facet, and the corners for the maximum. */
static brute brute_deviation(const scree_mesh *a, const scree_mesh *b, int n) {
  double area = 0, sum = 0, square = 0, maximum = 0;
  for (size_t t = 0; t < a->triangle_count; t++) {
    vec3 p = scree_mesh_corner(a, t, 0), q = scree_mesh_corner(a, t, 1),
         r = scree_mesh_corner(a, t, 2);
    double weight = vec3_norm(vec3_triangle_normal(p, q, r)) / (2.0 * n * n);
    const vec3 corners[3] = {p, q, r};
    for (int k = 0; k < 3; k++) maximum = fmax(maximum, brute_distance(b, corners[k]));
    for (int i = 0; i < n; i++)
      for (int j = 0; i + j < n; j++)
        for (int upper = 0; upper < 2; upper++) {
          if (upper && i + j + 1 == n) continue;
          double u = (i + (upper ? 2 : 1) / 3.0) / n, v = (j + (upper ? 2 : 1) / 3.0) / n;
          vec3 x = vec3_mad(vec3_mad(p, vec3_sub(q, p), u), vec3_sub(r, p), v);
          double d = brute_distance(b, x);
          area += weight, sum += weight * d, square += weight * d * d;
          maximum = fmax(maximum, d);
        }
  }
  return (brute){sum / area, sqrt(square / area), maximum};
}

static scree_mesh random_body(scree_rng *rng, int kind) {
  scree_mesh mesh = kind == 0   ? shape_icosphere(1, 1)
                    : kind == 1 ? shape_grid_box(1.5, 1, 2, 2)
                                : shape_torus(1, 0.4, 8, 6);
  mat3 turn = quat_to_mat3(scree_rng_rotation(rng));
  shape_transform(&mesh, &turn, vec3_scale(scree_rng_direction(rng), 0.2));
  shape_shake(&mesh, 0.05, rng);
  return mesh;
}

static void test_brute_force(void **state) {
  (void)state;
  scree_rng rng = {.seed = 31};
  for (int i = 0; i < 24; i++) {
    scree_mesh a = random_body(&rng, i % 3), b = random_body(&rng, i / 3 % 3);
    scree_distance_options options = scree_default_distance_options();
    options.sample_count = 20000;
    options.hausdorff_gap = 1e-3;
    scree_distance d = distance_of(&a, &b, &options);
    brute forward = brute_deviation(&a, &b, 8), backward = brute_deviation(&b, &a, 8);
    CHECK_NEAR(d.forward.mean, forward.mean, 5e-3 * forward.mean);
    CHECK_NEAR(d.backward.mean, backward.mean, 5e-3 * backward.mean);
    CHECK_NEAR(d.forward.rms, forward.rms, 5e-3 * forward.rms);
    CHECK_NEAR(d.backward.rms, backward.rms, 5e-3 * backward.rms);
    /* no sample of the brute force is beyond the bound, and the bound is as near as asked */
    assert_true(forward.maximum <= d.forward.maximum_bound * (1 + 1e-12));
    assert_true(backward.maximum <= d.backward.maximum_bound * (1 + 1e-12));
    assert_true(d.forward.maximum_bound <= d.forward.maximum * 1.001 + 1e-11);
    assert_true(d.backward.maximum_bound <= d.backward.maximum * 1.001 + 1e-11);
    /* `at` is where the maximum is */
    CHECK_NEAR(brute_distance(&b, vec3_load(d.forward.at)), d.forward.maximum, 1e-14);
    CHECK_NEAR(brute_distance(&a, vec3_load(d.backward.at)), d.backward.maximum, 1e-14);
    /* without cutting, the bound still holds, and few samples find nearly as much */
    scree_distance quick = distance_of(&a, &b, NULL);
    assert_true(quick.hausdorff <= d.hausdorff_bound * (1 + 1e-12));
    assert_true(quick.hausdorff_bound * (1 + 1e-12) >= d.hausdorff);
    scree_mesh_free(&a);
    scree_mesh_free(&b);
  }
}

/* On a noisy sheet one sample per facet and its corners give the mean that many samples give. */
static void test_noise_rule(void **state) {
  (void)state;
  scree_rng rng = {.seed = 32};
  scree_mesh scan = shape_sheet(0, 40), flat = shape_sheet(0, 1);
  for (size_t v = 0; v < scan.vertex_count; v++)
    scan.positions[3 * v + 2] += 0.001 * scree_rng_normal(&rng);
  scree_distance_options options = {.sample_count = 1};
  double coarse = distance_of(&scan, &flat, &options).forward.mean;
  options.sample_count = 3200 * 100;
  double fine = distance_of(&scan, &flat, &options).forward.mean;
  print_message("mean distance of noise, one sample per facet / 100: %.4f\n", coarse / fine);
  CHECK_NEAR(coarse / fine, 1, 0.04);
  scree_mesh_free(&scan);
  scree_mesh_free(&flat);
}

static void test_field(void **state) {
  (void)state;
  scree_rng rng = {.seed = 33};
  scree_mesh a = shape_torus(1, 0.4, 50, 20), b = random_body(&rng, 0);
  scree_error error;
  double *field = calloc(a.vertex_count, sizeof *field);
  CHECK_OK(scree_mesh_distance_field(&a, &b, field, &error), error);
  for (size_t v = 0; v < a.vertex_count; v++)
    CHECK_NEAR(field[v], brute_distance(&b, vec3_load(a.positions + 3 * v)), 1e-14);
  free(field);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
}

/* ---- Conduct ---- */

static void test_threads(void **state) {
  (void)state;
  scree_rng rng = {.seed = 34};
  scree_mesh a = shape_icosphere(1, 5), b = shape_icosphere(1, 2);
  shape_shake(&a, 0.01, &rng);
  scree_distance_options options = {.hausdorff_gap = 0.01};
  scree_set_threads(1);
  scree_distance one = distance_of(&a, &b, &options);
  for (int threads = 2; threads <= 4; threads++) {
    scree_set_threads(threads);
    scree_distance more = distance_of(&a, &b, &options);
    assert_memory_equal(&one, &more, sizeof one);
  }
  scree_set_threads(1);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
}

/* Flat facets and surfaces without area have distances too. */
static void test_flat_facets(void **state) {
  (void)state;
  scree_rng rng = {.seed = 35};
  scree_mesh box = shape_box(1, 1, 1), line = shape_box(2, 0, 0);
  scree_distance d = distance_of(&line, &box, NULL);
  CHECK_NEAR(d.forward.maximum, 1, 0);
  CHECK_NEAR(d.backward.maximum, sqrt(2), 1e-15);
  CHECK_NEAR(d.forward.mean, 0.5, 1e-15);
  for (int i = 0; i < 300; i++) {
    scree_mesh tangle = shape_random_tangle(&rng);
    scree_distance e;
    scree_error error;
    scree_status status = scree_mesh_distance(&tangle, &box, NULL, NULL, &e, &error);
    assert_int_equal(status, tangle.triangle_count ? SCREE_OK : SCREE_BAD_MESH);
    if (status == SCREE_OK) {
      assert_true(isfinite(e.forward.mean) && isfinite(e.backward.rms));
      assert_true(e.forward.mean <= e.forward.rms * (1 + 1e-12));
      assert_true(e.forward.rms <= e.forward.maximum_bound * (1 + 1e-12));
    }
    scree_mesh_free(&tangle);
  }
  scree_mesh_free(&box);
  scree_mesh_free(&line);
}

static bool cancel_at_half(void *context, const char *phase, double fraction) {
  (void)phase;
  *(double *)context = fraction;
  return fraction < 0.5;
}

static void test_refusals(void **state) {
  (void)state;
  scree_mesh box = shape_box(1, 1, 1);
  scree_distance d = {.hausdorff = 77};
  scree_error error;
  scree_distance_options options = {.hausdorff_gap = 1e-9};
  assert_int_equal(scree_mesh_distance(&box, &box, &options, NULL, &d, &error), SCREE_BAD_ARGUMENT);
  assert_string_equal(error.message, "hausdorff_gap is 1e-09, neither 0 nor at least 1e-6");
  options = (scree_distance_options){.sample_count = (size_t)1 << 40};
  assert_int_equal(scree_mesh_distance(&box, &box, &options, NULL, &d, &error), SCREE_LIMIT);
  double seen = -1;
  scree_progress always = {cancel_at_half, &seen, 0};
  scree_status status = scree_mesh_distance(&box, &box, NULL, &always, &d, &error);
  assert_int_equal(status, SCREE_CANCELLED);
  assert_true(seen >= 0.5);
  scree_mesh_free(&box);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_plates),       cmocka_unit_test(test_overhang),
      cmocka_unit_test(test_bridged_pit),  cmocka_unit_test(test_icosahedra),
      cmocka_unit_test(test_spheres),      cmocka_unit_test(test_converged),
      cmocka_unit_test(test_same_surface), cmocka_unit_test(test_brute_force),
      cmocka_unit_test(test_noise_rule),   cmocka_unit_test(test_field),
      cmocka_unit_test(test_threads),      cmocka_unit_test(test_flat_facets),
      cmocka_unit_test(test_refusals),
  };
  scree_set_threads(1); /* many tiny trees: waking threads would take longer than the work */
  return cmocka_run_group_tests(tests, NULL, NULL);
}
