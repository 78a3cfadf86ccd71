/* Handles that a repair cuts: those round which a short loop leads, and no other; and bodies of
 * which one is kept. */
#include "support/check.h"
#include "support/shapes.h"

static long long genus_of(const scree_mesh *mesh) {
  scree_topology topology;
  scree_error error;
  CHECK_OK(scree_mesh_topology(mesh, &topology, &error), error);
  assert_true(topology.closed && topology.manifold && topology.oriented);
  return topology.genus;
}

static scree_repair_report repair(const scree_mesh *mesh, const scree_repair_options *options,
                                  scree_mesh *repaired) {
  scree_repair_report report;
  scree_error error;
  CHECK_OK(scree_mesh_repair(mesh, options, NULL, repaired, &report, &error), error);
  return report;
}

/* A wire of 4 facets across has loops of 4 edges across it. */
static void a_thin_ring_is_cut(void **state) {
  (void)state;
  scree_mesh ring = shape_torus(1, 0.003, 1200, 4), cut;
  scree_repair_report report = repair(&ring, NULL, &cut);
  assert_int_equal(genus_of(&ring), 1);
  assert_int_equal(genus_of(&cut), 0);
  assert_int_equal(report.done[SCREE_REPAIR_CUT_HANDLE], 1);
  assert_true(report.after.usable);
  assert_int_equal(report.after.shell_count, 1);
  CHECK_NEAR(report.handle_length, 4 * sqrt(2) * 0.003, 1e-4);
  CHECK_NEAR(hypot(report.handle_place[0], hypot(report.handle_place[1], report.handle_place[2])),
             1, 0.01);
  CHECK_NEAR(report.volume_after / report.volume_before, 1, 5e-3);
  scree_mesh_free(&cut);
  scree_repair_options keep = scree_default_repair_options();
  keep.handle_edges = 0;
  report = repair(&ring, &keep, &cut);
  assert_int_equal(genus_of(&cut), 1);
  assert_int_equal(report.done[SCREE_REPAIR_CUT_HANDLE], 0);
  scree_mesh_free(&cut);
  scree_mesh_free(&ring);
}

/* A hole that a scan tells well stays, and one of a coarse mesh. */
static void a_wide_ring_stays(void **state) {
  (void)state;
  scree_mesh rings[] = {shape_torus(1, 0.3, 80, 24), shape_torus(1, 0.07, 60, 4)}, cut;
  for (int i = 0; i < 2; i++) {
    scree_repair_report report = repair(&rings[i], NULL, &cut);
    assert_int_equal(report.done[SCREE_REPAIR_CUT_HANDLE], 0);
    assert_int_equal(genus_of(&cut), 1);
    scree_mesh_free(&cut);
    scree_mesh_free(&rings[i]);
  }
}

/* The slots of the phone's hinge are bridged at this spacing. */
static void a_coarse_phone_loses_its_bridges(void **state) {
  (void)state;
  scree_sample_options options = scree_default_sample_options();
  scree_mesh phone, cut;
  scree_error error;
  options.resolution = 1e-3;
  options.seed = 11;
  CHECK_OK(scree_sample_make("fp-1", &options, NULL, &phone, &error), error);
  long long before = genus_of(&phone);
  scree_repair_report report = repair(&phone, NULL, &cut);
  assert_true(before >= 3);
  assert_true(genus_of(&cut) <= 1);
  assert_int_equal(genus_of(&cut), before - (long long)report.done[SCREE_REPAIR_CUT_HANDLE]);
  assert_true(report.handle_length < 8e-3);
  CHECK_NEAR(report.area_after / report.area_before, 1, 2e-3);
  scree_mesh_free(&cut);
  scree_mesh_free(&phone);
}

static void one_of_several_bodies_is_kept(void **state) {
  (void)state;
  scree_mesh balls[] = {shape_icosphere(1, 2), shape_icosphere(3, 2), shape_icosphere(2, 2)}, kept;
  shape_move(&balls[1], (vec3){10, 0, 0});
  shape_move(&balls[2], (vec3){20, 0, 0});
  scree_mesh two = shape_join(&balls[0], &balls[1]), all = shape_join(&two, &balls[2]);
  scree_repair_options options = scree_default_repair_options();
  scree_error error;
  for (size_t body = 1; body <= 3; body++) {
    options.keep_body = body;
    scree_repair_report report = repair(&all, &options, &kept);
    assert_int_equal(report.after.shell_count, 1);
    double radius = 4 - (double)body;
    CHECK_NEAR(report.volume_after, 4.19 * radius * radius * radius,
               0.15 * radius * radius * radius);
    scree_mesh_free(&kept);
  }
  options.keep_body = 4;
  assert_int_equal(scree_mesh_repair(&all, &options, NULL, &kept, NULL, &error),
                   SCREE_BAD_ARGUMENT);
  scree_mesh_free(&two);
  scree_mesh_free(&all);
  for (int i = 0; i < 3; i++) scree_mesh_free(&balls[i]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_thin_ring_is_cut),
      cmocka_unit_test(a_wide_ring_stays),
      cmocka_unit_test(a_coarse_phone_loses_its_bridges),
      cmocka_unit_test(one_of_several_bodies_is_kept),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
