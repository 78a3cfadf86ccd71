/* Errors of levels against scree_mesh_distance with dense samples, and against closed forms; the
 * recommended level keeps every tolerance by a measurement that shares no code with the choice's
 * own. */
#include "choice/fidelity.h"
#include "choice/gauge.h"
#include "choice/recommend.h"
#include "mesh/index/bvh.h"
#include "support/check.h"
#include "support/shapes.h"

/* ---- Parts ---- */

/* As many points on either side of any plane as there is area, and every vertex in the reach of a
 * point. */
static void points_are_spread_evenly(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(1, 5);
  scree_spread s;
  scree_error error;
  CHECK_OK(scree_spread_make(&ball, 4000, &s, &error), error);
  assert_int_equal(s.count, 4000);
  for (double z = -0.9; z < 1; z += 0.1) {
    size_t above = 0;
    for (size_t i = 0; i < s.count; i++) above += s.points[i].z > z;
    CHECK_NEAR((double)above / 4000, (1 - z) / 2, 0.01);
  }
  assert_int_equal(s.starts[s.count], ball.vertex_count);
  for (size_t i = 0; i < s.count; i++) {
    double farthest = 0;
    for (uint32_t k = s.starts[i]; k < s.starts[i + 1]; k++)
      farthest =
          fmax(farthest,
               vec3_distance(s.points[i], vec3_load(ball.positions + 3 * (size_t)s.vertices[k])));
    CHECK_NEAR(s.reach[i], farthest, 1e-15);
  }
  scree_spread_free(&s);
  scree_mesh_free(&ball);
}

/* Rays from within a ball and a box: the way out is known. */
static void rays_meet_what_is_in_their_way(void **state) {
  (void)state;
  scree_rng rng = {.seed = 37};
  scree_mesh box = shape_grid_box(2, 4, 6, 3);
  scree_bvh bvh;
  scree_error error;
  CHECK_OK(scree_bvh_build(&box, &bvh, &error), error);
  vec3 low, high;
  for (int k = 0; k < 3; k++) (&low.x)[k] = INFINITY, (&high.x)[k] = -INFINITY;
  for (size_t v = 0; v < box.vertex_count; v++) {
    low = vec3_min(low, vec3_load(box.positions + 3 * v));
    high = vec3_max(high, vec3_load(box.positions + 3 * v));
  }
  for (int i = 0; i < 2000; i++) {
    vec3 from = {low.x + 2 * scree_rng_uniform(&rng), low.y + 4 * scree_rng_uniform(&rng),
                 low.z + 6 * scree_rng_uniform(&rng)},
         along = i % 7 ? scree_rng_direction(&rng) : (vec3){i % 2 ? 1 : -1, 0, 0};
    double out = INFINITY, facing = 0;
    const double *p = &from.x, *d = &along.x, *a = &low.x, *b = &high.x;
    for (int k = 0; k < 3; k++)
      if (d[k] != 0) out = fmin(out, fmax((a[k] - p[k]) / d[k], (b[k] - p[k]) / d[k]));
    CHECK_NEAR(scree_ray_meet(&bvh, from, along, 0, &facing), out, 1e-9);
    assert_true(facing > 0);
    assert_true(scree_ray_meet(&bvh, from, along, out + 1e-6, &facing) == INFINITY);
  }
  scree_bvh_free(&bvh);
  scree_mesh_free(&box);
}

/* ---- Levels ---- */

typedef struct body {
  scree_mesh scan;
  scree_curve *curve;
  scree_choice choice;
  double length; /* D */
} body;

/* In place: the curve borrows the scan. */
static void make_body(const char *sample, double resolution, body *b) {
  scree_error error;
  scree_sample_options options = scree_default_sample_options();
  options.resolution = resolution;
  CHECK_OK(scree_sample_make(sample, &options, NULL, &b->scan, &error), error);
  CHECK_OK(scree_curve_build(&b->scan, NULL, NULL, &b->curve, &error), error);
  CHECK_OK(scree_choose(b->curve, &b->scan, NULL, NULL, &b->choice, &error), error);
  b->length = scree_fidelity_scan(b->choice.fidelity, SCREE_SCAN_LENGTH);
}

static void free_body(body *b) {
  scree_choice_free(&b->choice);
  scree_curve_free(b->curve);
  scree_mesh_free(&b->scan);
}

typedef struct truth {
  double mean, hausdorff, hausdorff_bound, inertia;
} truth;

static truth truth_of(const body *b, size_t level_index) {
  scree_mesh level;
  scree_distance d;
  scree_measures a, m;
  scree_error error;
  const scree_distance_options dense = {.sample_count = 200000, .hausdorff_gap = 0.002};
  CHECK_OK(scree_curve_mesh(b->curve, level_index, &level, &error), error);
  CHECK_OK(scree_mesh_distance(&b->scan, &level, &dense, NULL, &d, &error), error);
  CHECK_OK(scree_mesh_measure(&b->scan, &a, &error), error);
  CHECK_OK(scree_mesh_measure(&level, &m, &error), error);
  double difference = 0, size = 0;
  for (int i = 0; i < 9; i++) {
    double x = a.inertia[i / 3][i % 3], y = m.inertia[i / 3][i % 3];
    difference += (x - y) * (x - y);
    size += x * x;
  }
  scree_mesh_free(&level);
  return (truth){fmax(d.forward.mean, d.backward.mean) / b->length, d.hausdorff / b->length,
                 d.hausdorff_bound / b->length, sqrt(difference / size)};
}

/* Up to the coarsest tenth of levels, where one facet spans the body. */
static void errors_are_those_of_dense_samples(void **state) {
  (void)state;
  body b;
  make_body("dc-1", 3e-3, &b);
  const scree_fidelity *f = b.choice.fidelity;
  for (size_t row = 0; row < scree_fidelity_count(f); row += 4) {
    truth t = truth_of(&b, scree_fidelity_level_index(f, row));
    CHECK_NEAR(scree_fidelity_error(f, row, SCREE_ERROR_MEAN) / t.mean, 1, 0.02);
    CHECK_NEAR(scree_fidelity_error(f, row, SCREE_ERROR_INERTIA), t.inertia, 1e-9);
    /* never more than there is; less where facets of the scan are coarse */
    double found = scree_fidelity_error(f, row, SCREE_ERROR_HAUSDORFF);
    assert_true(found <= t.hausdorff_bound * 1.0001);
    if (t.hausdorff > 0.02) CHECK_NEAR(found / t.hausdorff, 1, 0.12);
  }
  free_body(&b);
}

/* Two spheres: the distance, and over the wall, which is the diameter. */
static void a_smaller_ball_is_off_by_the_difference(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(1, 6), smaller = shape_icosphere(0.98, 6);
  scree_gauge gauge;
  scree_gauge_reading r;
  scree_error error;
  CHECK_OK(scree_gauge_make(&ball, 4000, &gauge, &error), error);
  CHECK_OK(scree_gauge_read(&gauge, &smaller, 0.01, NULL, &r, &error), error);
  CHECK_NEAR(gauge.length, 2, 1e-3);
  CHECK_NEAR(gauge.thickness, 2, 1e-3);
  CHECK_NEAR(r.errors[SCREE_ERROR_MEAN], 0.01, 1e-4);
  CHECK_NEAR(r.errors[SCREE_ERROR_HAUSDORFF], 0.01, 2e-4);
  CHECK_NEAR(r.errors[SCREE_ERROR_THICKNESS], 0.01, 1e-4);
  CHECK_NEAR(r.changes[SCREE_CHANGE_THINNEST], -0.02, 1e-3);
  CHECK_NEAR(r.changes[SCREE_CHANGE_VOLUME], pow(0.98, 3) - 1, 1e-3);
  CHECK_NEAR(r.changes[SCREE_CHANGE_INERTIA], pow(0.98, 5) - 1, 1e-3);
  CHECK_NEAR(r.changes[SCREE_CHANGE_LENGTH], -0.02, 1e-3);
  CHECK_NEAR(r.errors[SCREE_ERROR_WIDTHS], 0.02, 1e-3);
  CHECK_NEAR(r.errors[SCREE_ERROR_CONVEXITY], 0, 1e-3);
  assert_true(r.errors[SCREE_ERROR_NORMALS] < 0.01);
  scree_gauge_free(&gauge);
  scree_mesh_free(&ball);
  scree_mesh_free(&smaller);
}

/* Of a cloud of points in any frame: what the extent says against all points along each direction,
 * and the same widths with the frame's axes in another order and turned round. Where points move by
 * at most h, no width changes by more than 2 h. */
static void widths_are_those_of_all_points(void **state) {
  (void)state;
  scree_rng rng = {.seed = 5};
  for (int round = 0; round < 20; round++) {
    scree_mesh ball = shape_icosphere(1, 2);
    for (size_t i = 0; i < 3 * ball.vertex_count; i++)
      ball.positions[i] *= 1 + 0.5 * scree_rng_normal(&rng);
    vec3 x = vec3_unit((vec3){scree_rng_normal(&rng), scree_rng_normal(&rng), 1}),
         y = vec3_unit(vec3_cross(x, (vec3){0, 1, 0})), z = vec3_cross(x, y);
    const double frame[3][3] = {{x.x, x.y, x.z}, {y.x, y.y, y.z}, {z.x, z.y, z.z}},
                 other[3][3] = {{z.x, z.y, z.z}, {-x.x, -x.y, -x.z}, {y.x, y.y, y.z}};
    scree_extent a, b, moved;
    scree_extent_of_mesh(&a, frame, &ball);
    scree_extent_of_mesh(&b, other, &ball);
    for (int i = 0; i < SCREE_EXTENT_COUNT; i++) {
      double low = INFINITY, high = -INFINITY, most = 0;
      for (size_t v = 0; v < ball.vertex_count; v++) {
        double along = scree_extent_along(&a, i, vec3_load(ball.positions + 3 * v));
        low = fmin(low, along), high = fmax(high, along);
      }
      CHECK_NEAR(scree_extent_width(&a, i), high - low, 1e-12);
      int same = 0;
      for (int k = 0; k < SCREE_EXTENT_COUNT; k++) {
        double cosine = fabs(a.x[i] * b.x[k] + a.y[i] * b.y[k] + a.z[i] * b.z[k]);
        if (cosine > most) most = cosine, same = k;
      }
      CHECK_NEAR(most, 1, 1e-12);
      CHECK_NEAR(scree_extent_width(&b, same), scree_extent_width(&a, i), 1e-12);
    }
    const double h = 1e-3;
    for (size_t v = 0; v < ball.vertex_count; v++) {
      vec3 d = vec3_unit((vec3){scree_rng_normal(&rng), scree_rng_normal(&rng), 0.1});
      vec3_store(ball.positions + 3 * v, vec3_mad(vec3_load(ball.positions + 3 * v), d, h));
    }
    scree_extent_of_mesh(&moved, frame, &ball);
    for (int i = 0; i < SCREE_EXTENT_COUNT; i++)
      assert_true(fabs(scree_extent_width(&moved, i) - scree_extent_width(&a, i)) <= 2.001 * h);
    scree_mesh_free(&ball);
  }
}

/* Noise of a ball's vertices along their normals is told with its size, and its area is left out.
 */
static void noise_is_told_from_shape(void **state) {
  (void)state;
  const double sigma = 0.004;
  scree_rng rng = {.seed = 38};
  scree_mesh ball = shape_icosphere(1, 6);
  scree_gauge clean, noisy;
  scree_error error;
  CHECK_OK(scree_gauge_make(&ball, 8000, &clean, &error), error);
  double area = clean.measures.area;
  assert_true(clean.fit.sigma < 0.05 * sigma);
  CHECK_NEAR(clean.clean_area / area, 1, 1e-4);
  scree_gauge_free(&clean);
  for (size_t v = 0; v < ball.vertex_count; v++) {
    double far = 1 + sigma * scree_rng_normal(&rng);
    for (size_t k = 0; k < 3; k++) ball.positions[3 * v + k] *= far;
  }
  CHECK_OK(scree_gauge_make(&ball, 8000, &noisy, &error), error);
  CHECK_NEAR(noisy.fit.sigma / sigma, 1, 0.1);
  assert_true(noisy.measures.area / area > 1.01); /* the noise shows */
  CHECK_NEAR(noisy.clean_area / area, 1, 0.005);
  scree_gauge_free(&noisy);
  scree_mesh_free(&ball);
}

/* The largest error over its tolerance of a level, by a sweep over it alone. */
static double load_of(const body *b, size_t level_index) {
  const scree_choice_options o = scree_default_choice_options();
  double errors[SCREE_SHAPE_ERROR_COUNT];
  scree_fidelity *f;
  scree_error error;
  CHECK_OK(scree_fidelity_measure(b->curve, &b->scan, &level_index, 1, NULL, &f, &error), error);
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    errors[e] = scree_fidelity_error(f, 0, (scree_shape_error)e);
  scree_fidelity_free(f);
  return scree_normalised_error(errors, o.tolerances, NULL);
}

/* By a measurement of other samples, and without much to spare; the next level does not. */
static void the_recommended_level_keeps_every_tolerance(void **state) {
  (void)state;
  static const char *const samples[] = {"fp-2", "sp-1"};
  for (int i = 0; i < 2; i++) {
    body b;
    make_body(samples[i], 3e-3, &b);
    const scree_choice_options o = scree_default_choice_options();
    truth t = truth_of(&b, b.choice.recommended.level_index);
    double thickness =
        scree_fidelity_error(b.choice.fidelity, b.choice.recommended_row, SCREE_ERROR_THICKNESS);
    double most = fmax(fmax(t.mean / o.tolerances[SCREE_ERROR_MEAN],
                            t.hausdorff_bound / o.tolerances[SCREE_ERROR_HAUSDORFF]),
                       fmax(t.inertia / o.tolerances[SCREE_ERROR_INERTIA],
                            thickness / o.tolerances[SCREE_ERROR_THICKNESS]));
    assert_true(most <= 1);
    assert_true(most > 0.7); /* levels of so few triangles lie far apart */
    assert_true(load_of(&b, b.choice.recommended.level_index + 1) > 0.96);
    free_body(&b);
  }
}

/* Levels that only another grid has do not count. */
static void another_grid_gives_the_same_choice(void **state) {
  (void)state;
  body b;
  make_body("fp-2", 3e-3, &b);
  for (int per_decade = 2; per_decade <= 40; per_decade += 19) {
    scree_choice_options o = scree_default_choice_options();
    scree_choice other;
    scree_error error;
    o.rp_min = 1e-3;
    o.rp_max = 0.9;
    o.per_decade = per_decade;
    CHECK_OK(scree_choose(b.curve, &b.scan, &o, NULL, &other, &error), error);
    assert_int_equal(other.recommended.triangle_count, b.choice.recommended.triangle_count);
    scree_choice_free(&other);
  }
  free_body(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(points_are_spread_evenly),
      cmocka_unit_test(rays_meet_what_is_in_their_way),
      cmocka_unit_test(errors_are_those_of_dense_samples),
      cmocka_unit_test(a_smaller_ball_is_off_by_the_difference),
      cmocka_unit_test(widths_are_those_of_all_points),
      cmocka_unit_test(noise_is_told_from_shape),
      cmocka_unit_test(the_recommended_level_keeps_every_tolerance),
      cmocka_unit_test(another_grid_gives_the_same_choice),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
