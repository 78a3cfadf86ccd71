/* Bodies on a table, one surface with it or another, in any attitude: the table is found, cut off,
 * and the body closed flat, against the volume by the closed form. */
#include "base/rng.h"
#include "base/vec.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

static const double pi = 3.14159265358979324;

enum { SIDE = 81 };

/* A table of 4 x 4 with a dome of radius 1 in its middle as one sheet, uneven by `noise`, turned
 * and moved. */
static scree_mesh domed_table(scree_rng *rng, double noise, vec3 *up) {
  enum { FACETS = 2 * (SIDE - 1) * (SIDE - 1) };
  static double grid[SIDE][SIDE][3], corners[9 * FACETS];
  static const int at[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  quat attitude = scree_rng_rotation(rng);
  mat3 turn = quat_to_mat3(attitude);
  vec3 shift = {scree_rng_normal(rng), scree_rng_normal(rng), scree_rng_normal(rng)};
  scree_mesh mesh;
  scree_error error;
  for (int i = 0; i < SIDE; i++)
    for (int j = 0; j < SIDE; j++) {
      double x = 4. * i / (SIDE - 1) - 2, y = 4. * j / (SIDE - 1) - 2;
      double left = 1 - x * x - y * y;
      vec3 p = {x, y, (left > 0 ? sqrt(left) : 0) + noise * scree_rng_normal(rng)};
      vec3_store(grid[i][j], vec3_add(mat3_mul_vec(&turn, p), shift));
    }
  double *out = corners;
  for (int i = 0; i + 1 < SIDE; i++)
    for (int j = 0; j + 1 < SIDE; j++)
      for (int k = 0; k < 6; k++, out += 3)
        memcpy(out, grid[i + at[k][0]][j + at[k][1]], 3 * sizeof *out);
  CHECK_OK(scree_mesh_weld(corners, FACETS, 0, &mesh, NULL, &error), error);
  *up = mat3_mul_vec(&turn, (vec3){0, 0, 1});
  return mesh;
}

/* Nothing lies below the plane. */
static void check_flat(const scree_mesh *mesh, const scree_cut_plane *plane) {
  vec3 normal = vec3_load(plane->normal);
  for (size_t v = 0; v < mesh->vertex_count; v++)
    assert_true(vec3_dot(normal, vec3_load(mesh->positions + 3 * v)) - plane->offset > -1e-8);
}

static void the_table_is_found(void **state) {
  (void)state;
  scree_rng rng = {9, 0, 0};
  for (int round = 0; round < 10; round++) {
    scree_repair_options o = scree_default_repair_options();
    scree_repair_report report;
    scree_mesh made;
    scree_error error;
    scree_measures m;
    vec3 up;
    scree_mesh mesh = domed_table(&rng, round % 2 ? 1e-3 : 0, &up);
    o.cut = SCREE_CUT_AUTO;
    CHECK_OK(scree_mesh_repair(&mesh, &o, NULL, &made, &report, &error), error);
    assert_true(report.after.usable && report.after.shell_count == 1);
    assert_true(report.done[SCREE_REPAIR_CUT_OFF] > 1000);
    assert_true(vec3_dot(vec3_load(report.plane.normal), up) > cos(0.5 * pi / 180));
    check_flat(&made, &report.plane);
    CHECK_OK(scree_mesh_measure(&made, &m, &error), error);
    CHECK_NEAR(m.volume, 2 * pi / 3, 0.03 * 2 * pi / 3);
    scree_mesh_free(&made);
    scree_mesh_free(&mesh);
  }
}

/* A ball that is given, cut at any height: what is left is a cap. */
static void a_given_plane_cuts_there(void **state) {
  (void)state;
  for (int axis = 0; axis < 3; axis++)
    for (double at = -0.7; at < 0.8; at += 0.35) {
      scree_repair_options o = scree_default_repair_options();
      scree_repair_report report;
      scree_mesh ball = shape_icosphere(1, 4), made;
      scree_error error;
      scree_measures m;
      double h = 1 - at, cap = pi * h * h * (3 - h) / 3;
      o.cut = SCREE_CUT_GIVEN;
      o.plane.normal[axis] = 1;
      o.plane.offset = at;
      CHECK_OK(scree_mesh_repair(&ball, &o, NULL, &made, &report, &error), error);
      CHECK_OK(scree_mesh_measure(&made, &m, &error), error);
      CHECK_NEAR(m.volume, cap, 0.01 * cap);
      CHECK_NEAR(m.box_min[axis], at, 1e-9);
      check_flat(&made, &report.plane);
      scree_mesh_free(&made);
      scree_mesh_free(&ball);
    }
}

static void expect(const scree_mesh *mesh, scree_cut_kind cut, double at, const char *said) {
  scree_repair_options o = scree_default_repair_options();
  scree_mesh made = {0};
  scree_error error;
  o.cut = cut;
  o.plane = (scree_cut_plane){{0, 0, 1}, at};
  assert_int_equal(scree_mesh_repair(mesh, &o, NULL, &made, NULL, &error), SCREE_BAD_MESH);
  if (!strstr(error.message, said)) fail_msg("'%s'", error.message);
  assert_null(made.positions);
}

static void what_stands_on_nothing_is_told(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(1, 3);
  expect(&ball, SCREE_CUT_AUTO, 0, "no boundary");
  expect(&ball, SCREE_CUT_GIVEN, 2, "nothing of the surface stands on the plane");
  expect(&ball, SCREE_CUT_GIVEN, -2, "nothing of the surface lies below the plane");
  scree_mesh_free(&ball);
}

static scree_status cut_once(void *context, scree_error *error) {
  scree_repair_options o = scree_default_repair_options();
  scree_mesh made = {0};
  o.cut = SCREE_CUT_AUTO;
  scree_status status = scree_mesh_repair(context, &o, NULL, &made, NULL, error);
  scree_mesh_free(&made);
  return status;
}
static void memory_may_run_out(void **state) {
  (void)state;
  scree_rng rng = {2, 0, 0};
  vec3 up;
  scree_mesh mesh = domed_table(&rng, 0, &up);
  assert_true(check_allocation_failures(cut_once, &mesh) > 10);
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_table_is_found), cmocka_unit_test(a_given_plane_cuts_there),
      cmocka_unit_test(what_stands_on_nothing_is_told), cmocka_unit_test(memory_may_run_out)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
