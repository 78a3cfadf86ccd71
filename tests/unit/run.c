#include "base/alloc.h"
#include "support/check.h"

/* A box of 100 x 50 x 15 mm, a closed phone, by its corners. */
static scree_particle *phone(void) {
  double corners[24];
  static const uint32_t faces[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                   2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  uint32_t triangles[36];
  for (int i = 0; i < 8; i++) {
    corners[3 * i] = i & 1 ? 0.1 : 0;
    corners[3 * i + 1] = i & 2 ? 0.05 : 0;
    corners[3 * i + 2] = i & 4 ? 0.015 : 0;
  }
  memcpy(triangles, faces, sizeof faces);
  scree_mesh mesh = {corners, triangles, 8, 12};
  scree_particle *particle;
  scree_error error;
  CHECK_OK(scree_particle_from_mesh(&mesh, NULL, &particle, &error), error);
  return particle;
}

static scree_experiment preset(const char *name) {
  scree_experiment e;
  scree_error error;
  CHECK_OK(scree_experiment_preset(name, &e, &error), error);
  return e;
}

static void every_preset_takes_closed_phones(void **state) {
  (void)state;
  scree_run_shape shape = {phone(), 1};
  for (size_t i = 0; scree_preset_name(i); i++) {
    scree_experiment e = preset(scree_preset_name(i));
    scree_run *run;
    scree_error error;
    CHECK_OK(scree_run_create(&e, &shape, 1, &run, &error), error);
    assert_int_equal(scree_run_phase(run), SCREE_PHASE_PACK);
    assert_true(scree_run_fraction(run) == 0);
    scree_run_free(run);
    scree_experiment_free(&e);
  }
  scree_particle_free(shape.particle);
}

static void what_cannot_be_filled_is_refused_before_the_run(void **state) {
  (void)state;
  scree_run_shape shape = {phone(), 1};
  scree_experiment e = preset("paper");
  scree_run *run;
  scree_error error;
  e.cylinder_diameter = 0.1;
  assert_int_equal(scree_run_create(&e, &shape, 1, &run, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "does not fit into the cylinder of 100 mm"));
  e.cylinder_diameter = 0.4;
  e.pack_time = 0.5;
  assert_int_equal(scree_run_create(&e, &shape, 1, &run, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "set phases.pack_time to"));
  e.pack_time = 6;
  shape.density_factor = 0;
  assert_int_equal(scree_run_create(&e, &shape, 1, &run, &error), SCREE_BAD_ARGUMENT);
  scree_experiment_free(&e);
  scree_particle_free(shape.particle);
}

/* Eight spheres through all phases. */
static scree_checksum pour(size_t steps_a_call, scree_run_result *result) {
  scree_experiment e = preset("paper");
  e.particle_count = 8;
  e.cylinder_diameter = 0.08;
  e.disc_diameter = 0.3;
  e.pack_time = 0.1;
  e.settle_time = 0.05;
  e.lift_speed = 1;
  e.lift_time = 0.08;
  e.hold_time = 0.02;
  e.drop_height = 0.01;
  scree_particle *sphere;
  scree_run *run;
  scree_error error;
  CHECK_OK(scree_particle_sphere(0.01, &sphere, &error), error);
  scree_run_shape shape = {sphere, 1};
  CHECK_OK(scree_run_create(&e, &shape, 1, &run, &error), error);
  double fraction = 0;
  scree_phase phase = SCREE_PHASE_PACK;
  while (scree_run_phase(run) != SCREE_PHASE_DONE) {
    CHECK_OK(scree_run_advance(run, steps_a_call, &error), error);
    assert_true(scree_run_fraction(run) >= fraction);
    assert_true(scree_run_phase(run) >= phase);
    fraction = scree_run_fraction(run);
    phase = scree_run_phase(run);
  }
  CHECK_NEAR(scree_run_cylinder_height(run), 0.08, 1e-3);
  CHECK_OK(scree_run_measure(run, result, &error), error);
  scree_checksum hash = scree_world_hash(scree_run_world(run));
  scree_run_free(run);
  scree_particle_free(sphere);
  scree_experiment_free(&e);
  return hash;
}

static void a_run_does_not_depend_on_how_it_is_cut(void **state) {
  (void)state;
  scree_run_result one, other;
  scree_checksum a = pour(1000000, &one), b = pour(137, &other);
  assert_memory_equal(&a, &b, sizeof a);
  CHECK_NEAR(one.particle_size, 0.02, 1e-12);
  assert_true(one.repose.peak > 0.015 && one.repose.peak < 0.2);
  assert_true(one.packing_fraction > 0.1 && one.packing_fraction < 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_preset_takes_closed_phones),
      cmocka_unit_test(what_cannot_be_filled_is_refused_before_the_run),
      cmocka_unit_test(a_run_does_not_depend_on_how_it_is_cut),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
