/* What the header promises of every call: NULL for its options is the defaults, nobody need watch
 * or be told. */
#include "choice/criterion.h"
#include "mesh/io/read.h"
#include "scree.h"
#include "support/check.h"
#include "support/folder.h"

static scree_mesh sphere(void) {
  scree_mesh mesh;
  scree_error error;
  CHECK_OK(scree_sample_make("icosphere-2", NULL, NULL, &mesh, &error), error);
  return mesh;
}

static void surfaces(void **state) {
  (void)state;
  scree_error error;
  scree_mesh mesh = sphere(), repaired, ready;
  scree_check check;
  scree_distance distance;
  scree_scan scan;
  CHECK_OK(scree_mesh_check(&mesh, NULL, NULL, &check, &error), error);
  assert_true(check.usable);
  CHECK_OK(scree_mesh_repair(&mesh, NULL, NULL, &repaired, NULL, &error), error);
  CHECK_OK(scree_mesh_prepare(&mesh, NULL, NULL, &ready, NULL, &error), error);
  CHECK_OK(scree_mesh_distance(&mesh, &repaired, NULL, NULL, &distance, &error), error);
  CHECK_NEAR(distance.hausdorff, 0, 1e-15);
  CHECK_OK(scree_mesh_write(&mesh, in_folder("ball.stl"), NULL, &error), error);
  CHECK_OK(scree_scan_read(in_folder("ball.stl"), NULL, &scan, &error), error);
  assert_int_equal(scan.mesh.triangle_count, mesh.triangle_count);
  scree_scan_free(&scan);
  scree_mesh_free(&ready);
  scree_mesh_free(&repaired);
  scree_mesh_free(&mesh);
}

static void a_choice(void **state) {
  (void)state;
  scree_error error;
  scree_mesh mesh = sphere();
  scree_simplify_options method = scree_default_simplify_options();
  scree_choice_options grid = scree_default_choice_options();
  scree_curve *curve, *same;
  scree_choice choice;
  CHECK_OK(scree_curve_build(&mesh, NULL, NULL, &curve, &error), error);
  CHECK_OK(scree_curve_build(&mesh, &method, NULL, &same, &error), error);
  assert_int_equal(scree_curve_level_count(curve), scree_curve_level_count(same));
  assert_int_equal(scree_curve_get_facts(curve).method, method.method);
  CHECK_OK(scree_choose(curve, &mesh, NULL, NULL, &choice, &error), error);
  assert_int_equal(choice.level_count, scree_choice_grid_count(NULL));
  assert_int_equal(scree_choice_grid_count(NULL), scree_choice_grid_count(&grid));
  assert_true(scree_choice_grid_rp(NULL, 3) == scree_choice_grid_rp(&grid, 3));
  scree_choice_free(&choice);
  scree_curve_free(curve);
  scree_curve_free(same);
  scree_mesh_free(&mesh);
}

static void a_pile(void **state) {
  (void)state;
  scree_error error;
  scree_mesh mesh = sphere();
  scree_particle *particle;
  scree_world *world;
  scree_height_field field;
  scree_repose repose;
  CHECK_OK(scree_particle_from_mesh(&mesh, NULL, &particle, &error), error);
  CHECK_OK(scree_world_create(NULL, &world, &error), error);
  CHECK_OK(scree_height_field_create(0, 0, 0.1, 0.01, &field, &error), error);
  CHECK_OK(scree_repose_measure(&field, NULL, &repose, &error), error);
  assert_false(repose.heap);
  scree_height_field_free(&field);
  scree_world_free(world);
  scree_particle_free(particle);
  scree_mesh_free(&mesh);
}

static void what_is_written(void **state) {
  (void)state;
  scree_error error;
  scree_mesh mesh = sphere();
  scree_world *world;
  scree_image image = {0};
  CHECK_OK(
      scree_particle_export(&mesh, NULL, in_folder("e.stl"), in_folder("e.json"), NULL, &error),
      error);
  CHECK_OK(scree_world_create(NULL, &world, &error), error);
  CHECK_OK(scree_world_export(world, NULL, in_folder("pile"), &error), error);
  assert_int_equal(scree_render(NULL, 0, NULL, NULL, &image, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "views")); /* the size and all else are the defaults */
  scree_world_free(world);
  scree_mesh_free(&mesh);
}

/* Nobody need be told why. */
static void failures(void **state) {
  (void)state;
  scree_scan scan;
  scree_mesh none = {0}, made;
  scree_check check;
  scree_curve *curve;
  scree_particle *particle;
  scree_world *world;
  assert_int_equal(scree_scan_read(in_folder("missing"), NULL, &scan, NULL), SCREE_IO);
  assert_int_equal(scree_scan_parse("solid", 5, "x", NULL, &scan, NULL), SCREE_BAD_FILE);
  assert_int_equal(scree_mesh_repair(&none, NULL, NULL, &made, NULL, NULL), SCREE_BAD_MESH);
  assert_int_equal(scree_curve_build(&none, NULL, NULL, &curve, NULL), SCREE_BAD_MESH);
  assert_int_equal(scree_particle_from_mesh(&none, NULL, &particle, NULL), SCREE_BAD_MESH);
  assert_int_equal(scree_world_load(in_folder("missing"), &world, NULL), SCREE_IO);
  assert_int_equal(scree_sample_make("nonsense", NULL, NULL, &made, NULL), SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_mesh_check(&none, NULL, NULL, &check, NULL), SCREE_OK);
  assert_false(check.usable);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(surfaces),        cmocka_unit_test(a_choice), cmocka_unit_test(a_pile),
      cmocka_unit_test(what_is_written), cmocka_unit_test(failures),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
