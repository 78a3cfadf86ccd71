/* Shape descriptors against closed forms: spheres, boxes, ellipsoids. */
#include "base/vec.h"
#include "report/program.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/shapes.h"

static const double pi = 3.14159265358979323846;

static scree_descriptors describe(const scree_mesh *mesh) {
  scree_measures measures;
  scree_descriptors d;
  scree_error error;
  CHECK_OK(scree_mesh_measure(mesh, &measures, &error), error);
  CHECK_OK(scree_mesh_describe(mesh, &measures, &d, &error), error);
  return d;
}

static void turn_and_move(scree_mesh *mesh) {
  mat3 turn = quat_to_mat3(quat_unit((quat){0.3, -0.5, 0.7, 0.2}));
  shape_transform(mesh, &turn, (vec3){5, -3, 2});
}

static scree_mesh ellipsoid(double a, double b, double c, int level) {
  scree_mesh mesh = shape_icosphere(1, level);
  for (size_t v = 0; v < mesh.vertex_count; v++) {
    double *p = mesh.positions + 3 * v;
    p[0] *= a, p[1] *= b, p[2] *= c;
  }
  return mesh;
}

static void of_a_sphere(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(0.02, 4);
  turn_and_move(&mesh);
  scree_descriptors d = describe(&mesh);
  CHECK_NEAR(d.elongation, 1, 0.01);
  CHECK_NEAR(d.flatness, 1, 0.01);
  assert_int_equal(d.zingg, SCREE_EQUANT);
  CHECK_NEAR(d.krumbein_sphericity, 1, 0.01);
  CHECK_NEAR(d.roundness, 1, 0.03);
  CHECK_NEAR(d.angularity, 1, 0.01);
  CHECK_NEAR(d.bounding_radius, 0.02, 1e-9);
  CHECK_NEAR(d.inscribed_radius, 0.02, 1e-4);
  const double centre[3] = {5, -3, 2};
  for (int k = 0; k < 3; k++) {
    CHECK_NEAR(d.bounding_centre[k], centre[k], 1e-7);
    CHECK_NEAR(d.inscribed_centre[k], centre[k], 2e-4);
  }
  scree_mesh_free(&mesh);
}

static void of_boxes(void **state) {
  (void)state;
  static const struct {
    double size[3];
    scree_zingg zingg;
  } boxes[] = {{{3, 2.5, 2}, SCREE_EQUANT},
               {{3, 2.9, 1}, SCREE_OBLATE},
               {{3, 1, 0.9}, SCREE_PROLATE},
               {{4, 2, 1}, SCREE_BLADED}};
  for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++) {
    const double *s = boxes[i].size;
    scree_mesh mesh = shape_grid_box(s[0], s[1], s[2], 3);
    turn_and_move(&mesh);
    scree_descriptors d = describe(&mesh);
    assert_int_equal(d.zingg, boxes[i].zingg);
    CHECK_NEAR(d.elongation, s[1] / s[0], 1e-6);
    CHECK_NEAR(d.flatness, s[2] / s[1], 1e-6);
    CHECK_NEAR(d.krumbein_sphericity, cbrt(s[1] * s[2] / (s[0] * s[0])), 1e-6);
    CHECK_NEAR(d.inscribed_radius, s[2] / 2, 2e-4 * s[2]);
    CHECK_NEAR(d.bounding_radius, sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) / 2, 1e-9);
    assert_true(d.roundness < 1 && d.angularity > 1.1);
    scree_mesh_free(&mesh);
  }
}

/* Of an ellipsoid with half axes a, b, c: H = h^3 (a^2 + b^2 + c^2 - r^2) / (2 a^2 b^2 c^2), with h
 * the distance of the tangent plane, and dA = a b c / h times that of the unit sphere. */
static double willmore(const double axes[3]) {
  enum { STEPS = 400 };
  double sum = 0, product = axes[0] * axes[1] * axes[2];
  double squares = axes[0] * axes[0] + axes[1] * axes[1] + axes[2] * axes[2];
  for (int i = 0; i < STEPS; i++)
    for (int k = 0; k < 2 * STEPS; k++) {
      double theta = pi * (i + 0.5) / STEPS, phi = pi * (k + 0.5) / STEPS;
      double u[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)}, r2 = 0, q = 0;
      for (int a = 0; a < 3; a++) {
        r2 += axes[a] * u[a] * axes[a] * u[a];
        q += u[a] * u[a] / (axes[a] * axes[a]);
      }
      double h = 1 / sqrt(q), mean = h * h * h * (squares - r2) / (2 * product * product);
      sum += mean * mean * product / h * sin(theta) * (pi / STEPS) * (pi / STEPS);
    }
  return sum / (4 * pi);
}

static void of_ellipsoids(void **state) {
  (void)state;
  static const double all[2][3] = {{2, 1.5, 1}, {3, 1, 1}};
  for (int i = 0; i < 2; i++) {
    const double *axes = all[i];
    scree_mesh mesh = ellipsoid(axes[0], axes[1], axes[2], 5);
    turn_and_move(&mesh);
    scree_descriptors d = describe(&mesh);
    CHECK_NEAR(d.elongation, axes[1] / axes[0], 0.01);
    CHECK_NEAR(d.flatness, axes[2] / axes[1], 0.01);
    CHECK_NEAR(d.bounding_radius, axes[0], 1e-3 * axes[0]);
    CHECK_NEAR(d.inscribed_radius, axes[2], 2e-3 * axes[2]);
    CHECK_NEAR(d.angularity, willmore(axes), 0.02 * willmore(axes));
    assert_true(d.roundness > 0.2 && d.roundness < 1);
    scree_mesh_free(&mesh);
  }
}

static void what_is_no_body_is_refused(void **state) {
  (void)state;
  scree_mesh sheet = shape_sheet(0, 2), inward = shape_box(1, 1, 1);
  scree_measures measures;
  scree_descriptors d;
  scree_error error;
  CHECK_OK(scree_mesh_measure(&sheet, &measures, &error), error);
  assert_int_equal(scree_mesh_describe(&sheet, &measures, &d, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "not closed"));
  for (size_t t = 0; t < inward.triangle_count; t++) shape_flip(&inward, t);
  CHECK_OK(scree_mesh_measure(&inward, &measures, &error), error);
  assert_int_equal(scree_mesh_describe(&inward, &measures, &d, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "inside out"));
  scree_mesh_free(&sheet);
  scree_mesh_free(&inward);
}

typedef struct described {
  scree_mesh mesh;
  scree_measure_entry entry;
} described;

static scree_status describe_again(void *context, scree_error *error) {
  described *d = context;
  return scree_mesh_describe(&d->mesh, &d->entry.measures, &d->entry.descriptors, error);
}

static scree_status draw(void *context, scree_error *error) {
  described *d = context;
  return scree_zingg_figure_write(&d->entry, 1, in_folder("zingg.csv"), true, error);
}

static void memory_may_run_out(void **state) {
  (void)state;
  described d = {.mesh = shape_box(1, 2, 3), .entry = {.file = "box", .described = true}};
  scree_error error;
  CHECK_OK(scree_mesh_measure(&d.mesh, &d.entry.measures, &error), error);
  check_allocation_failures(describe_again, &d);
  check_allocation_failures(draw, &d);
  CHECK_OK(scree_zingg_figure_write(&d.entry, 1, in_folder("zingg.png"), false, &error), error);
  d.entry.described = false;
  assert_int_equal(scree_zingg_figure_write(&d.entry, 1, in_folder("none.png"), false, &error),
                   SCREE_BAD_ARGUMENT);
  scree_mesh_free(&d.mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(of_a_sphere),        cmocka_unit_test(of_boxes),
      cmocka_unit_test(of_ellipsoids),      cmocka_unit_test(what_is_no_body_is_refused),
      cmocka_unit_test(memory_may_run_out),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
