#include "base/vec.h"
#include "support/check.h"
#include "support/shapes.h"

static const scree_method methods[] = {SCREE_METHOD_VOLUME, SCREE_METHOD_QECD};

static scree_curve *build(const scree_mesh *mesh, scree_method method) {
  scree_simplify_options options = scree_default_simplify_options();
  scree_curve *curve = NULL;
  scree_error error;
  options.method = method;
  CHECK_OK(scree_curve_build(mesh, &options, NULL, &curve, &error), error);
  return curve;
}

/* Closed, manifold, oriented, without degenerate facets; measures as the record says. */
static void check_level(const scree_curve *curve, size_t index, const scree_mesh *mesh) {
  scree_error error;
  scree_level level;
  scree_topology topology;
  double area, volume;
  scree_curve_level(curve, index, &level);
  assert_int_equal(mesh->triangle_count, level.triangle_count);
  CHECK_OK(scree_mesh_topology(mesh, &topology, &error), error);
  assert_true(topology.closed && topology.manifold && topology.oriented);
  assert_int_equal(topology.degenerate_facet_count, 0);
  assert_int_equal(topology.unused_vertex_count, 0);
  CHECK_OK(scree_mesh_area_volume(mesh, &area, &volume, &error), error);
  CHECK_NEAR(level.area, area, 1e-12 * area);
  CHECK_NEAR(level.volume, volume, 1e-12 * fabs(volume));
}

static void every_level_is_sound_and_as_recorded(void **state) {
  (void)state;
  scree_rng rng = {.seed = 3};
  for (int m = 0; m < 2; m++)
    for (int shape = 0; shape < 3; shape++) {
      scree_mesh mesh = shape == 0   ? shape_icosphere(0.02, 3)
                        : shape == 1 ? shape_torus(0.03, 0.01, 24, 12)
                                     : shape_grid_box(0.1, 0.05, 0.02, 8);
      if (shape == 1) shape_shake(&mesh, 2e-4, &rng);
      scree_curve *curve = build(&mesh, methods[m]);
      scree_curve_facts facts = scree_curve_get_facts(curve);
      assert_true(facts.closed);
      assert_int_equal(facts.shell_count, 1);
      assert_int_equal(facts.boundary_edge_count, 0);
      if (shape != 1) assert_true(facts.floor_count <= 8);
      scree_replay *replay = NULL;
      scree_error error;
      CHECK_OK(scree_replay_start(curve, &replay, &error), error);
      scree_level first, level;
      scree_curve_level(curve, 0, &first);
      for (size_t i = 0; i < scree_curve_level_count(curve); i++) {
        const scree_mesh *now;
        CHECK_OK(scree_replay_step(replay, i, &now, &error), error);
        check_level(curve, i, now);
        scree_curve_level(curve, i, &level);
        if (methods[m] == SCREE_METHOD_VOLUME)
          CHECK_NEAR(level.volume, first.volume, 1e-12 * first.volume);
        assert_int_equal(scree_curve_find(curve, level.triangle_count), i);
      }
      scree_replay_free(replay);
      scree_curve_free(curve);
      scree_mesh_free(&mesh);
    }
}

static void a_box_goes_to_its_twelve_triangles(void **state) {
  (void)state;
  for (int m = 0; m < 2; m++) {
    scree_mesh mesh = shape_grid_box(0.1, 0.05, 0.02, 16), twelve;
    scree_curve *curve = build(&mesh, methods[m]);
    size_t level = scree_curve_find(curve, 12);
    scree_level at;
    scree_error error;
    scree_curve_level(curve, level, &at);
    assert_int_equal(at.triangle_count, 12);
    CHECK_NEAR(at.area, 2 * (0.1 * 0.05 + 0.05 * 0.02 + 0.02 * 0.1), 1e-15);
    CHECK_OK(scree_curve_mesh(curve, level, &twelve, &error), error);
    check_level(curve, level, &twelve);
    scree_mesh_free(&twelve);
    scree_curve_free(curve);
    scree_mesh_free(&mesh);
  }
}

static void bad_input_is_refused_with_a_sentence(void **state) {
  (void)state;
  scree_mesh mesh = shape_box(1, 1, 1);
  scree_simplify_options options = scree_default_simplify_options();
  scree_curve *curve = NULL;
  scree_error error;
  mesh.positions[4] = NAN;
  assert_int_equal(scree_curve_build(&mesh, &options, NULL, &curve, &error), SCREE_BAD_MESH);
  mesh.positions[4] = 0;
  mesh.triangles[5] = 99;
  assert_int_equal(scree_curve_build(&mesh, &options, NULL, &curve, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "99"));
  mesh.triangle_count = 0;
  assert_int_equal(scree_curve_build(&mesh, &options, NULL, &curve, &error), SCREE_BAD_MESH);
  options.error_limit = -1;
  assert_int_equal(scree_curve_build(&mesh, &options, NULL, &curve, &error), SCREE_BAD_ARGUMENT);
  assert_null(curve);
  mesh.triangle_count = 12;
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_level_is_sound_and_as_recorded),
      cmocka_unit_test(a_box_goes_to_its_twelve_triangles),
      cmocka_unit_test(bad_input_is_refused_with_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
