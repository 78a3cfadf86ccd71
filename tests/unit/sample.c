/* The built-in samples: what every one of them promises, at reduced resolution. */
#include "scree.h"

#include "support/check.h"

static scree_sample_options coarse(double resolution_mm, double noise_mm) {
  scree_sample_options options = scree_default_sample_options();
  options.resolution = resolution_mm * 1e-3;
  options.noise = noise_mm * 1e-3;
  return options;
}

static void check_invariants(const char *name, const scree_mesh *mesh) {
  scree_error error;
  scree_topology topology;
  double area, volume;
  CHECK_OK(scree_mesh_topology(mesh, &topology, &error), error);
  if (topology.boundary_edge_count + topology.non_manifold_edge_count +
          topology.non_manifold_vertex_count + topology.inconsistent_edge_count +
          topology.degenerate_facet_count + topology.unused_vertex_count !=
      0) {
    print_error("%s: %zu boundary, %zu non-manifold edges, %zu non-manifold vertices, %zu "
                "inconsistent edges, %zu degenerate facets, %zu unused vertices\n",
                name, topology.boundary_edge_count, topology.non_manifold_edge_count,
                topology.non_manifold_vertex_count, topology.inconsistent_edge_count,
                topology.degenerate_facet_count, topology.unused_vertex_count);
    fail();
  }
  CHECK_OK(scree_mesh_area_volume(mesh, &area, &volume, &error), error);
  assert_true(area > 0 && volume > 0);
}

static void devices_are_closed_manifold_and_outward(void **state) {
  (void)state;
  for (size_t i = 0; i < SCREE_SAMPLE_DEVICES; i++) {
    for (int noisy = 0; noisy < 2; noisy++) {
      scree_sample_options options = coarse(0.6, noisy ? 0.02 : 0);
      scree_error error;
      scree_mesh mesh;
      scree_topology topology;
      const char *name = scree_sample_name(i);
      CHECK_OK(scree_sample_make(name, &options, NULL, &mesh, &error), error);
      check_invariants(name, &mesh);
      CHECK_OK(scree_mesh_topology(&mesh, &topology, &error), error);
      assert_int_equal(topology.shell_count, 1);
      scree_mesh_free(&mesh);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(devices_are_closed_manifold_and_outward),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
