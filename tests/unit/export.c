/* Meshes for DEM codes: where they are put, what they weigh, what is refused. */
#include "base/file.h"
#include "base/vec.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/shapes.h"

#include <unistd.h>

/* A box of 3 x 2 x 1 cm, turned and moved away. */
static scree_mesh turned_box(mat3 *turn, vec3 *away) {
  scree_mesh box = shape_box(0.03, 0.02, 0.01);
  *turn = quat_to_mat3(quat_from_rotation_vector((vec3){0.4, -1.1, 0.7}));
  *away = (vec3){0.5, -0.2, 3};
  shape_move(&box, (vec3){-0.015, -0.01, -0.005});
  shape_transform(&box, turn, *away);
  return box;
}

static scree_mesh read_back(const char *path, double unit) {
  scree_error error;
  scree_scan scan;
  scree_read_options read = scree_default_read_options();
  read.unit_m = unit;
  CHECK_OK(scree_scan_read(path, &read, &scan, &error), error);
  return scan.mesh;
}

/* Inertia by the closed form, the file where the result says it is. */
static void principal_box(void **state) {
  (void)state;
  scree_error error;
  mat3 turn;
  vec3 away;
  scree_mesh box = turned_box(&turn, &away);
  scree_export_options o = scree_default_export_options();
  scree_exported e;
  o.principal = true;
  o.density = 1500;
  o.unit_m = 1;
  CHECK_OK(scree_particle_export(&box, &o, in_folder("box.ply"), in_folder("box.json"), &e, &error),
           error);
  double mass = 1500 * 6e-6, sides[3] = {0.03, 0.02, 0.01};
  CHECK_NEAR(e.mass, mass, 1e-12 * mass);
  CHECK_NEAR(e.bounding_radius, 0.5 * sqrt(14e-4), 1e-12);
  for (int i = 0; i < 3; i++) {
    double a = sides[(i + 1) % 3], b = sides[(i + 2) % 3];
    CHECK_NEAR(e.measures.centroid[i], 0, 1e-14);
    CHECK_NEAR(e.measures.dimensions[i], sides[i], 1e-12);
    for (int j = 0; j < 3; j++)
      CHECK_NEAR(e.inertia[i][j], i == j ? mass / 12 * (a * a + b * b) : 0, 1e-12 * mass * 1e-3);
  }
  scree_mesh file = read_back(in_folder("box.ply"), 1);
  assert_int_equal(file.triangle_count, 12);
  for (size_t v = 0; v < box.vertex_count; v++) {
    vec3 p = vec3_load(box.positions + 3 * v), best = {0, 0, 0};
    mat3 rotation;
    memcpy(rotation.m, e.rotation, sizeof rotation.m);
    p = vec3_add(mat3_mul_vec(&rotation, p), vec3_load(e.translation));
    for (size_t k = 0; k < file.vertex_count; k++) {
      vec3 q = vec3_load(file.positions + 3 * k);
      if (k == 0 || vec3_distance(p, q) < vec3_distance(p, best)) best = q;
    }
    CHECK_NEAR(vec3_distance(p, best), 0, 1e-14);
  }
  scree_mesh_free(&file);
  scree_mesh_free(&box);
}

/* Without being asked nothing moves; with `centre` nothing turns. */
static void centre_only(void **state) {
  (void)state;
  scree_error error;
  mat3 turn;
  vec3 away;
  scree_mesh box = turned_box(&turn, &away);
  scree_export_options o = scree_default_export_options();
  scree_exported e;
  for (int centre = 0; centre < 2; centre++) {
    o.centre = centre;
    o.overwrite = true;
    CHECK_OK(scree_particle_export(&box, &o, in_folder("c.ply"), NULL, &e, &error), error);
    for (int i = 0; i < 3; i++) {
      double c = ((double *)&away)[i];
      CHECK_NEAR(e.measures.centroid[i], centre ? 0 : c, 1e-13);
      CHECK_NEAR(e.translation[i], centre ? -c : 0, 1e-13);
      for (int j = 0; j < 3; j++) assert_true(e.rotation[i][j] == (i == j));
    }
    scree_mesh file = read_back(in_folder("c.ply"), 1e-3);
    double low = file.positions[0];
    for (size_t v = 0; v < file.vertex_count; v++) low = fmin(low, file.positions[3 * v]);
    CHECK_NEAR(low, e.measures.box_min[0], 1e-12);
    scree_mesh_free(&file);
  }
  scree_mesh_free(&box);
}

static void refusals(void **state) {
  (void)state;
  scree_error error;
  scree_mesh box = shape_box(1, 1, 1);
  scree_export_options o = scree_default_export_options();
  CHECK_OK(scree_particle_export(&box, &o, in_folder("r.stl"), in_folder("r.json"), NULL, &error),
           error);
  assert_int_equal(scree_particle_export(&box, &o, in_folder("r.stl"), NULL, NULL, &error),
                   SCREE_EXISTS);
  /* neither file is written where one is in the way */
  assert_int_equal(
      scree_particle_export(&box, &o, in_folder("s.stl"), in_folder("r.json"), NULL, &error),
      SCREE_EXISTS);
  assert_int_equal(access(in_folder("s.stl"), F_OK), -1);
  o.overwrite = true;
  CHECK_OK(scree_particle_export(&box, &o, in_folder("r.stl"), in_folder("r.json"), NULL, &error),
           error);
  o.density = -1;
  assert_int_equal(scree_particle_export(&box, &o, in_folder("r.stl"), NULL, NULL, &error),
                   SCREE_BAD_ARGUMENT);
  o.density = 1;
  box.triangle_count--;
  assert_int_equal(scree_particle_export(&box, &o, in_folder("r.stl"), NULL, NULL, &error),
                   SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "not closed"));
  box.triangle_count++;
  for (size_t t = 0; t < box.triangle_count; t++) {
    uint32_t *c = box.triangles + 3 * t, kept = c[0];
    c[0] = c[1], c[1] = kept;
  }
  assert_int_equal(scree_particle_export(&box, &o, in_folder("r.stl"), NULL, NULL, &error),
                   SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "inside out"));
  scree_mesh_free(&box);
}

/* Times that no reader would take are refused, and nothing is written. */
static void times(void **state) {
  (void)state;
  scree_error error;
  const char *const files[] = {"a.vtp", "b.vtp"}, *const names[] = {"t.pvd", "t.vtp.series"};
  const double bad[] = {NAN, INFINITY, -INFINITY}, point[3] = {0};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    const double both[] = {0, bad[i]};
    for (size_t k = 0; k < 2; k++) {
      const char *path = in_folder(names[k]);
      assert_int_equal(scree_pvd_write(files, both, 2, path, true, &error), SCREE_BAD_ARGUMENT);
      assert_non_null(strstr(error.message, "time 2 of 2"));
      assert_int_equal(access(path, F_OK), -1);
      CHECK_OK(scree_pvd_write(files, both, 1, path, true, &error), error);
      assert_int_equal(unlink(path), 0);
    }
    scree_vtk_data data = {.points = point, .point_count = 1, .time = bad[i]};
    assert_int_equal(scree_vtp_write(&data, in_folder("t.vtp"), true, &error),
                     isnan(bad[i]) ? SCREE_OK : SCREE_BAD_ARGUMENT);
  }
}

static scree_status write_all(void *context, scree_error *error) {
  const scree_mesh *box = context;
  scree_export_options o = scree_default_export_options();
  o.overwrite = true;
  scree_status status = scree_mesh_vtp_write(box, box, in_folder("a.vtp"), true, error);
  if (status != SCREE_OK) return status;
  return scree_particle_export(box, &o, in_folder("a.stl"), in_folder("a.json"), NULL, error);
}

static void allocations(void **state) {
  (void)state;
  scree_mesh box = shape_box(1, 1, 1);
  check_allocation_failures(write_all, &box);
  scree_mesh_free(&box);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(principal_box), cmocka_unit_test(centre_only), cmocka_unit_test(refusals),
      cmocka_unit_test(times),         cmocka_unit_test(allocations),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
