/* Clumps: what they must hold, by measures of their own; closed forms; a turned body; bad input. */
#include "base/vec.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/overlap.h"
#include "support/shapes.h"

static const double pi = 3.14159265358979323846;

static scree_clumps make(const scree_mesh *mesh, size_t most) {
  scree_clump_options options = scree_default_clump_options();
  scree_clumps clumps;
  scree_error error;
  options.most = most;
  CHECK_OK(scree_clumps_make(mesh, &options, NULL, &clumps, &error), error);
  return clumps;
}

/* A body with a neck and without symmetry, about 1 in size. */
static scree_mesh make_body(void) {
  scree_mesh mesh = shape_icosphere(1, 3);
  for (size_t v = 0; v < mesh.vertex_count; v++) {
    double *p = mesh.positions + 3 * v;
    double neck = 1 - 0.5 * exp(-8 * (p[2] - 0.2) * (p[2] - 0.2));
    p[0] *= 0.7 * neck;
    p[1] *= neck * (1 + 0.2 * p[0]);
    p[2] *= 1.6;
  }
  return mesh;
}

/* IoU grows with the count, no sphere is useless, and volume, centroid and inertia are those of the
 * body within what is promised. */
static void holds_its_promises(void **state) {
  (void)state;
  scree_mesh mesh = make_body();
  scree_clumps clumps = make(&mesh, 11);
  double before = 0;
  assert_true(clumps.clump_count > 9 && clumps.wall_cells > 3);
  for (size_t i = 0; i < clumps.clump_count; i++) {
    const scree_clump *c = &clumps.clumps[i];
    assert_true(c->iou > before);
    assert_true(c->useless_count == 0);
    before = c->iou;
    if (c->sphere_count < 10) continue;
    CHECK_NEAR(c->volume_error, 0, 0.01);
    CHECK_NEAR(c->centroid_error, 0, 0.002);
    CHECK_NEAR(c->inertia_error, 0, 0.03);
  }
  assert_true(before > 0.9);
  CHECK_NEAR(clumps.measures.volume, pi / 6 * clumps.size * clumps.size * clumps.size,
             1e-9 * clumps.measures.volume);
  scree_clumps_free(&clumps);
  scree_mesh_free(&mesh);
}

/* A root with a thin blade: the sphere at its tip covers more outside than inside, and holds the
 * centroid. */
static void a_thin_blade_keeps_its_spheres(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(1, 3);
  for (size_t v = 0; v < mesh.vertex_count; v++) {
    double *p = mesh.positions + 3 * v, tip = fmax(0, p[2]);
    p[0] *= 1 - 0.85 * fmin(1, 4 * tip);
    p[2] += 2 * tip;
  }
  scree_clumps clumps = make(&mesh, 12);
  assert_int_equal(scree_clumps_of_count(&clumps, 6)->sphere_count, 6);
  assert_int_equal(scree_clumps_of_count(&clumps, 9)->sphere_count, 9);
  for (size_t i = 0; i < clumps.clump_count; i++) {
    const scree_clump *c = &clumps.clumps[i];
    if (c->sphere_count >= 4) CHECK_NEAR(c->centroid_error, 0, 0.002);
    if (c->sphere_count >= 10) CHECK_NEAR(c->inertia_error, 0, 0.03);
    assert_true(c->useless_count == 0);
  }
  scree_clumps_free(&clumps);
  scree_mesh_free(&mesh);
}

/* Flat faces along the axes count in full. */
static void measures_a_plate(void **state) {
  (void)state;
  scree_mesh mesh = shape_grid_box(1, 0.4, 0.05, 4);
  scree_clumps clumps = make(&mesh, 5);
  const scree_clump *c = scree_clumps_of_count(&clumps, 5);
  overlap_counts counts = overlap_count(&mesh, c->spheres, c->sphere_count, 20000);
  CHECK_NEAR(overlap_iou(&counts), c->iou, 0.004);
  scree_clumps_free(&clumps);
  scree_mesh_free(&mesh);
}

static void measures_are_those_of_points(void **state) {
  (void)state;
  scree_mesh mesh = make_body();
  scree_clumps clumps = make(&mesh, 4);
  for (size_t i = 0; i < clumps.clump_count; i += 3) {
    const scree_clump *c = &clumps.clumps[i];
    overlap_counts counts = overlap_count(&mesh, c->spheres, c->sphere_count, 4000);
    double volume = counts.box_volume * (double)counts.spheres / (double)counts.points;
    CHECK_NEAR(overlap_iou(&counts), c->iou, 0.012);
    CHECK_NEAR(volume, c->union_volume, 0.02 * c->union_volume);
  }
  scree_clumps_free(&clumps);
  scree_mesh_free(&mesh);
}

/* A ball is one sphere, and more are not offered. */
static void a_ball_is_one_sphere(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(0.02, 4);
  shape_move(&mesh, (vec3){1, 2, 3});
  scree_clumps clumps = make(&mesh, 3);
  const scree_clump *c = &clumps.clumps[0];
  assert_true(c->sphere_count == 1 && c->iou > 0.99);
  CHECK_NEAR(c->spheres[0].radius, 0.02, 1e-4);
  for (int k = 0; k < 3; k++) CHECK_NEAR(c->spheres[0].centre[k], k + 1, 1e-4);
  assert_true(clumps.recommended == 0 && scree_clumps_of_count(&clumps, 3)->iou < c->iou + 0.01);
  scree_clumps_free(&clumps);
  scree_mesh_free(&mesh);
}

/* Two overlapping balls are two spheres: radii and centres come back. */
static void finds_the_spheres_of_a_body(void **state) {
  (void)state;
  const double radii[2] = {1, 0.7};
  const vec3 centres[2] = {{0, 0, 0}, {0.3, 0.4, 1.2}};
  scree_mesh ball = shape_icosphere(1, 4);
  for (size_t v = 0; v < ball.vertex_count; v++) { /* out along the ray to the farther sphere */
    double *p = ball.positions + 3 * v;
    vec3 d = vec3_load(p);
    double b = vec3_dot(d, centres[1]),
           q = b * b - vec3_dot(centres[1], centres[1]) + radii[1] * radii[1];
    double far = q > 0 ? b + sqrt(q) : 0;
    vec3_store(p, vec3_scale(d, fmax(1, far)));
  }
  scree_clumps clumps = make(&ball, 2);
  const scree_clump *c = scree_clumps_of_count(&clumps, 2);
  assert_true(c->sphere_count == 2 && c->iou > 0.97);
  for (int i = 0; i < 2; i++) {
    CHECK_NEAR(c->spheres[i].radius, radii[i], 0.03);
    CHECK_NEAR(vec3_distance(vec3_load(c->spheres[i].centre), centres[i]), 0, 0.06);
  }
  scree_clumps_free(&clumps);
  scree_mesh_free(&ball);
}

static void a_turned_body_is_the_same(void **state) {
  (void)state;
  scree_mesh mesh = make_body();
  scree_clumps clumps = make(&mesh, 4);
  mat3 turn = quat_to_mat3(quat_unit((quat){0.3, -0.5, 0.7, 0.2}));
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) turn.m[i][k] *= 0.01;
  shape_transform(&mesh, &turn, (vec3){5, -3, 2});
  scree_clumps turned = make(&mesh, 4);
  assert_true(turned.clump_count == clumps.clump_count);
  for (size_t i = 0; i < clumps.clump_count; i++)
    CHECK_NEAR(turned.clumps[i].iou, clumps.clumps[i].iou, 0.01);
  CHECK_NEAR(turned.size, 0.01 * clumps.size, 1e-9);
  scree_clumps_free(&turned);
  scree_clumps_free(&clumps);
  scree_mesh_free(&mesh);
}

/* No sphere stands out by more than asked: 0 is inscribed. */
static void spheres_stay_inside(void **state) {
  (void)state;
  scree_mesh mesh = make_body();
  scree_clump_options options = scree_default_clump_options();
  scree_clumps clumps;
  scree_error error;
  options.most = 4;
  for (int i = 0; i < 2; i++) {
    options.outside = 0.03 * i;
    CHECK_OK(scree_clumps_make(&mesh, &options, NULL, &clumps, &error), error);
    for (size_t k = 0; k < clumps.clump_count; k++)
      assert_true(clumps.clumps[k].outside <= options.outside + 1e-9);
    assert_true(clumps.clumps[clumps.clump_count - 1].iou > 0.5);
    scree_clumps_free(&clumps);
  }
  scree_mesh_free(&mesh);
}

static void same_bits_for_any_threads(void **state) {
  (void)state;
  scree_mesh mesh = make_body();
  scree_set_threads(1);
  scree_clumps one = make(&mesh, 2);
  scree_set_threads(3);
  scree_clumps two = make(&mesh, 2);
  scree_set_threads(0);
  assert_true(one.clump_count == two.clump_count);
  for (size_t i = 0; i < one.clump_count; i++)
    assert_memory_equal(one.clumps[i].spheres, two.clumps[i].spheres,
                        one.clumps[i].sphere_count * sizeof(scree_sphere));
  scree_clumps_free(&one);
  scree_clumps_free(&two);
  scree_mesh_free(&mesh);
}

static scree_status make_few(void *context, scree_error *error) {
  scree_clump_options options = scree_default_clump_options();
  scree_clumps clumps = {0};
  options.most = 1;
  scree_status status = scree_clumps_make(context, &options, NULL, &clumps, error);
  scree_clumps_free(&clumps);
  return status;
}

static void memory_may_run_out(void **state) {
  (void)state;
  scree_mesh mesh = shape_box(1, 2, 3);
  check_allocation_failures(make_few, &mesh);
  scree_mesh_free(&mesh);
}

static void expect_failure(const scree_mesh *mesh, const scree_clump_options *options,
                           scree_status expected, const char *words) {
  scree_clumps clumps;
  scree_error error;
  assert_int_equal(scree_clumps_make(mesh, options, NULL, &clumps, &error), expected);
  assert_non_null(strstr(error.message, words));
}

static void bad_input_is_refused(void **state) {
  (void)state;
  scree_mesh open = shape_sheet(0, 3), inward = shape_box(1, 1, 1);
  for (size_t t = 0; t < inward.triangle_count; t++) shape_flip(&inward, t);
  expect_failure(&open, NULL, SCREE_BAD_MESH, "not closed");
  expect_failure(&inward, NULL, SCREE_BAD_MESH, "inside out");
  scree_clump_options options = scree_default_clump_options();
  options.most = 0;
  expect_failure(&inward, &options, SCREE_BAD_ARGUMENT, "1 to 300");
  options = scree_default_clump_options();
  options.outside = -1;
  expect_failure(&inward, &options, SCREE_BAD_ARGUMENT, "stand out");
  scree_mesh_free(&open);
  scree_mesh_free(&inward);
}

/* A plate of a thousandth of its length: it says that spheres are the wrong shape, in finite time.
 */
static void a_thin_plate_warns(void **state) {
  (void)state;
  scree_mesh mesh = shape_grid_box(1, 0.2, 0.001, 8);
  scree_clumps clumps = make(&mesh, 3);
  assert_true(clumps.wall_cells < 3);
  CHECK_NEAR(clumps.thickness, 0.001, 1e-5);
  scree_clumps_free(&clumps);
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(holds_its_promises),        cmocka_unit_test(measures_are_those_of_points),
      cmocka_unit_test(measures_a_plate),          cmocka_unit_test(a_thin_blade_keeps_its_spheres),
      cmocka_unit_test(a_ball_is_one_sphere),      cmocka_unit_test(finds_the_spheres_of_a_body),
      cmocka_unit_test(a_turned_body_is_the_same), cmocka_unit_test(spheres_stay_inside),
      cmocka_unit_test(same_bits_for_any_threads), cmocka_unit_test(memory_may_run_out),
      cmocka_unit_test(bad_input_is_refused),      cmocka_unit_test(a_thin_plate_warns),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
