/* What is written and read again is the same mesh, in every format. */
#include "mesh/io/write.h"
#include "base/alloc.h"
#include "base/rng.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/shapes.h"

#include <sys/stat.h>
#include <unistd.h>

/* Loose triangles with every bit of a double in use, or of a float where `narrow`. */
static scree_mesh random_mesh(scree_rng *rng, size_t facets, double unit_m, bool narrow) {
  double *corners = malloc(9 * facets * sizeof *corners);
  for (size_t i = 0; i < 9 * facets; i++) {
    double x = ldexp(scree_rng_uniform(rng) - 0.5, (int)scree_rng_below(rng, 40) - 20);
    corners[i] = narrow ? (double)(float)x * unit_m : x;
  }
  scree_mesh mesh = {0};
  scree_error error;
  CHECK_OK(scree_mesh_weld(corners, facets, 0, &mesh, NULL, &error), error);
  free(corners);
  return mesh;
}

static void check_round_trip(const scree_mesh *mesh, const scree_write_options *options,
                             const char *name, double relative) {
  scree_error error;
  scree_scan scan = {0};
  scree_read_options read = scree_default_read_options();
  read.unit_m = options->unit_m;
  CHECK_OK(scree_mesh_write(mesh, in_folder(name), options, &error), error);
  CHECK_OK(scree_scan_read(in_folder(name), &read, &scan, &error), error);
  assert_int_equal(scan.mesh.vertex_count, mesh->vertex_count);
  assert_int_equal(scan.mesh.triangle_count, mesh->triangle_count);
  assert_memory_equal(scan.mesh.triangles, mesh->triangles, 12 * mesh->triangle_count);
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    CHECK_NEAR(scan.mesh.positions[i], mesh->positions[i], relative * fabs(mesh->positions[i]));
  scree_scan_free(&scan);
}

static void round_trips(void **state) {
  (void)state;
  static const char *const names[] = {NULL,         "mesh.stl", "ascii.stl", "mesh.PLY",
                                      "narrow.ply", "mesh.obj", "mesh.off",  "mesh.3mf"};
  scree_rng rng = {5, 1, 0};
  for (int f = SCREE_FORMAT_STL; f < SCREE_FORMAT_3MF; f++)
    for (int round = 0; round < 20; round++) {
      bool narrow = f == SCREE_FORMAT_STL || f == SCREE_FORMAT_PLY_FLOAT;
      double unit_m = round % 2 ? 1 : 1e-3;
      scree_mesh mesh =
          random_mesh(&rng, round ? 1 + scree_rng_below(&rng, 50) : 5000, unit_m, narrow);
      scree_write_options options = scree_default_write_options();
      options.unit_m = unit_m;
      options.overwrite = true;
      options.comment = round % 3 ? "seed 1\nsolid element vertex" : NULL;
      if (f != SCREE_FORMAT_STL && f != SCREE_FORMAT_PLY && f != SCREE_FORMAT_OBJ)
        options.format = (scree_file_format)f;
      /* p / unit * unit is off by an ulp where unit is no power of two; a float comes back exactly
       */
      check_round_trip(&mesh, &options, names[f], narrow || unit_m == 1 ? 0 : 2.3e-16);
      scree_mesh_free(&mesh);
    }
}

/* A unit that 3MF has no name for is written
 * as metres. */
static void round_trip_3mf(void **state) {
  (void)state;
  static const double units[] = {1e-3, 1, 0.0254, 0.5};
  for (int u = 0; u < 4; u++) {
    scree_mesh mesh = shape_icosphere(0.02, 3);
    scree_write_options options = scree_default_write_options();
    options.unit_m = units[u];
    options.overwrite = true;
    options.comment = "made of <spheres> & \"more\"";
    scree_error error;
    scree_scan scan = {0};
    scree_measures before, after;
    CHECK_OK(scree_mesh_write(&mesh, in_folder("ball.3MF"), &options, &error), error);
    CHECK_OK(scree_scan_read(in_folder("ball.3MF"), NULL, &scan, &error), error);
    assert_string_equal(scan.format, u == 0   ? "3MF, millimeter"
                                     : u == 2 ? "3MF, inch"
                                              : "3MF, meter");
    assert_int_equal(scan.mesh.vertex_count, mesh.vertex_count);
    assert_int_equal(scan.mesh.triangle_count, mesh.triangle_count);
    CHECK_OK(scree_mesh_measure(&mesh, &before, &error), error);
    CHECK_OK(scree_mesh_measure(&scan.mesh, &after, &error), error);
    CHECK_NEAR(after.volume, before.volume, 1e-14 * before.volume);
    for (int k = 0; k < 3; k++) CHECK_NEAR(after.box_min[k], before.box_min[k], 1e-16);
    scree_scan_free(&scan);
    scree_mesh_free(&mesh);
  }
}

/* What scree writes says its unit, and is read in it unless the caller knows better. */
static void says_its_unit(void **state) {
  (void)state;
  static const char *const names[] = {"mesh.stl", "mesh.ply", "mesh.obj", "mesh.off"};
  scree_rng rng = {6, 1, 0};
  scree_mesh mesh = random_mesh(&rng, 20, 1, true);
  for (int i = 0; i < 5; i++) {
    scree_write_options write = scree_default_write_options();
    scree_read_options read = scree_default_read_options();
    scree_error error;
    write.overwrite = true;
    write.format = i < 4 ? SCREE_FORMAT_AUTO : SCREE_FORMAT_STL_ASCII;
    write.comment = "seed 1";
    write.unit_m = i % 2 ? 0.0254 : 1;
    CHECK_OK(scree_mesh_write(&mesh, in_folder(names[i % 4]), &write, &error), error);
    for (int ignore = 0; ignore < 2; ignore++) {
      scree_scan scan;
      read.ignore_comment_unit = ignore;
      CHECK_OK(scree_scan_read(in_folder(names[i % 4]), &read, &scan, &error), error);
      double right = ignore ? 1e-3 : write.unit_m;
      assert_true(scan.unit_m == right && scan.states_unit == !ignore);
      assert_true(scan.comment_unit_m == write.unit_m);
      for (size_t v = 0; v < 3 * mesh.vertex_count; v++)
        CHECK_NEAR(scan.mesh.positions[v] / right, mesh.positions[v] / write.unit_m,
                   1e-6 * fabs(mesh.positions[v] / write.unit_m));
      scree_scan_free(&scan);
    }
  }
  scree_mesh_free(&mesh);
}

static void refusals(void **state) {
  (void)state;
  double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  uint32_t triangles[] = {0, 1, 2};
  scree_mesh mesh = {positions, triangles, 3, 1};
  scree_error error;
  CHECK_OK(scree_mesh_write(&mesh, in_folder("twice.off"), NULL, &error), error);
  assert_int_equal(scree_mesh_write(&mesh, in_folder("twice.off"), NULL, &error), SCREE_EXISTS);
  assert_int_equal(scree_mesh_write(&mesh, in_folder("a.step"), NULL, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_mesh_write(&mesh, "-", NULL, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_mesh_write(&mesh, in_folder("no/folder.ply"), NULL, &error), SCREE_IO);
  triangles[2] = 3;
  assert_int_equal(scree_mesh_write(&mesh, in_folder("b.ply"), NULL, &error), SCREE_BAD_ARGUMENT);
  triangles[2] = 2;
  positions[4] = INFINITY;
  assert_int_equal(scree_mesh_write(&mesh, in_folder("b.ply"), NULL, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "vertex 1"));
  assert_int_not_equal(access(in_folder("b.ply"), F_OK), 0);
  assert_string_equal(scree_file_format_name(SCREE_FORMAT_STL_ASCII), "stl-ascii");
}

static scree_status write_again(void *context, scree_error *error) {
  scree_write_options options = scree_default_write_options();
  options.overwrite = true;
  return scree_mesh_write(context, in_folder("again.stl"), &options, error);
}

static scree_status read_again(void *context, scree_error *error) {
  scree_scan scan = {0};
  scree_status status = scree_scan_read(in_folder("again.stl"), context, &scan, error);
  scree_scan_free(&scan);
  return status;
}

static void memory_runs_out(void **state) {
  (void)state;
  scree_rng rng = {6, 1, 0};
  scree_mesh mesh = random_mesh(&rng, 100, 1e-3, true);
  check_allocation_failures(write_again, &mesh);
  check_allocation_failures(read_again, NULL);
  scree_read_options options = scree_default_read_options();
  options.weld_tolerance = 0.01;
  check_allocation_failures(read_again, &options);
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(round_trips), cmocka_unit_test(round_trip_3mf), cmocka_unit_test(refusals),
      cmocka_unit_test(says_its_unit), cmocka_unit_test(memory_runs_out)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
