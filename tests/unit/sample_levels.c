/* What must hold at every level of a decimation, on the built-in devices: closed, manifold, wound
 * outward, of the scan's genus, without degenerate facets, of its volume, and nowhere meeting
 * itself. At a coarse resolution by default; with the argument `full` at the paper's 0.27 mm, which
 * takes half a minute. */
#include "support/check.h"

#include "scree.h"

static scree_sample_options sampling;

enum { STEPS = 9 }; /* two levels per factor of ten of Rp, and the floor */

static void check_level(const scree_mesh *mesh, const scree_topology *scan, double volume) {
  scree_error error;
  scree_topology topology;
  double area, now;
  CHECK_OK(scree_mesh_topology(mesh, &topology, &error), error);
  assert_true(topology.closed && topology.manifold && topology.oriented);
  assert_int_equal(topology.inward_shell_count, 0);
  assert_int_equal(topology.shell_count, scan->shell_count);
  assert_true(topology.genus == scan->genus);
  assert_int_equal(topology.degenerate_facet_count, 0);
  assert_int_equal(topology.duplicate_facet_count, 0);
  CHECK_OK(scree_mesh_area_volume(mesh, &area, &now, &error), error);
  CHECK_NEAR(now / volume, 1, 1e-10);
}

/* By exact arithmetic. */
static void check_intersections(const scree_mesh *mesh) {
  scree_error error;
  scree_check check;
  CHECK_OK(scree_mesh_check(mesh, NULL, NULL, &check, &error), error);
  if (!check.usable) print_error("%zu triangles: %s\n", mesh->triangle_count, check.verdict);
  assert_true(check.usable && check.intersections_known);
}

static void check_sample(const char *name, scree_method method, double volume_slack) {
  scree_error error;
  scree_mesh scan;
  scree_curve *curve;
  scree_replay *replay;
  scree_topology topology;
  scree_simplify_options options = scree_default_simplify_options();
  options.method = method;
  CHECK_OK(scree_sample_make(name, &sampling, NULL, &scan, &error), error);
  CHECK_OK(scree_mesh_topology(&scan, &topology, &error), error);
  assert_true(topology.closed && topology.manifold && topology.oriented);
  CHECK_OK(scree_curve_build(&scan, &options, NULL, &curve, &error), error);
  CHECK_OK(scree_replay_start(curve, &replay, &error), error);
  size_t levels = scree_curve_level_count(curve), last = 0;
  for (int step = 0; step <= STEPS; step++) {
    double rp = pow(10, -0.5 * step - 0.5);
    size_t target = (size_t)(rp * (double)scan.triangle_count);
    size_t index = step == STEPS ? levels - 1 : scree_curve_find(curve, target);
    scree_level level;
    const scree_mesh *mesh;
    if (index == last) continue;
    last = index;
    scree_curve_level(curve, index, &level);
    CHECK_OK(scree_replay_step(replay, index, &mesh, &error), error);
    assert_int_equal(mesh->triangle_count, level.triangle_count);
    double volume;
    CHECK_OK(scree_mesh_area_volume(&scan, NULL, &volume, &error), error);
    CHECK_NEAR(level.volume / volume, 1, volume_slack);
    check_level(mesh, &topology, volume_slack > 1e-10 ? level.volume : volume);
    if (rp < 0.2) check_intersections(mesh);
  }
  scree_replay_free(replay);
  scree_curve_free(curve);
  scree_mesh_free(&scan);
}

static void feature_phone(void **state) {
  (void)state;
  check_sample("fp-3", SCREE_METHOD_VOLUME, 1e-10);
}

/* With a strap eye: a handle stays at every level. */
static void camera(void **state) {
  (void)state;
  check_sample("dc-1", SCREE_METHOD_VOLUME, 1e-10);
}

/* The paper's method does not keep the volume; all else holds. */
static void smartphone_qecd(void **state) {
  (void)state;
  check_sample("sp-3", SCREE_METHOD_QECD, 1);
}

static void box_of(const scree_mesh *mesh, double low[3], double high[3]) {
  for (size_t k = 0; k < 3; k++) {
    low[k] = INFINITY, high[k] = -INFINITY;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
      low[k] = fmin(low[k], mesh->positions[3 * v + k]);
      high[k] = fmax(high[k], mesh->positions[3 * v + k]);
    }
  }
}

/* Devices with handles at a resolution where volume alone would throw vertices 17 and 71 mm out. */
static void no_level_grows_spikes(void **state) {
  (void)state;
  scree_sample_options options = scree_default_sample_options();
  options.resolution = 0.7e-3;
  for (int i = 0; i < 2; i++) {
    scree_error error;
    scree_mesh scan;
    scree_curve *curve;
    scree_replay *replay;
    double low[3], high[3], now_low[3], now_high[3];
    scree_level first;
    CHECK_OK(scree_sample_make(i ? "dc-2" : "fp-1", &options, NULL, &scan, &error), error);
    CHECK_OK(scree_curve_build(&scan, &(scree_simplify_options){0}, NULL, &curve, &error), error);
    CHECK_OK(scree_replay_start(curve, &replay, &error), error);
    box_of(&scan, low, high);
    scree_curve_level(curve, 0, &first);
    for (size_t index = 0; index < scree_curve_level_count(curve); index++) {
      scree_level level;
      const scree_mesh *mesh;
      scree_curve_level(curve, index, &level);
      if (level.triangle_count > 300 && index % 512 != 0) continue;
      CHECK_OK(scree_replay_step(replay, index, &mesh, &error), error);
      box_of(mesh, now_low, now_high);
      double room = 0.5 * sqrt(first.area / (double)level.triangle_count);
      for (int k = 0; k < 3; k++) {
        assert_true(now_low[k] >= low[k] - room);
        assert_true(now_high[k] <= high[k] + room);
      }
    }
    scree_replay_free(replay);
    scree_curve_free(curve);
    scree_mesh_free(&scan);
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(feature_phone),
      cmocka_unit_test(camera),
      cmocka_unit_test(smartphone_qecd),
      cmocka_unit_test(no_level_grows_spikes),
  };
  sampling = scree_default_sample_options();
  if (argc < 2 || strcmp(argv[1], "full") != 0) sampling.resolution = 2e-3;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
