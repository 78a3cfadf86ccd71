/* Every allocation of the measures and distances may fail. */
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

static scree_status measure(void *context, scree_error *error) {
  scree_measures measures;
  return scree_mesh_measure(context, &measures, error);
}

static scree_status topology(void *context, scree_error *error) {
  scree_topology counts;
  return scree_mesh_topology(context, &counts, error);
}

static scree_status area_volume(void *context, scree_error *error) {
  double area, volume;
  return scree_mesh_area_volume(context, &area, &volume, error);
}

static scree_status distance(void *context, scree_error *error) {
  const scree_mesh *meshes = context;
  scree_distance_options options = {.hausdorff_gap = 0.1};
  scree_distance found;
  return scree_mesh_distance(&meshes[0], &meshes[1], &options, NULL, &found, error);
}

static scree_status field(void *context, scree_error *error) {
  const scree_mesh *meshes = context;
  double *distances = malloc(meshes[0].vertex_count * sizeof *distances);
  scree_status status = scree_mesh_distance_field(&meshes[0], &meshes[1], distances, error);
  free(distances);
  return status;
}

static void test_failures(void **state) {
  (void)state;
  scree_mesh meshes[2] = {shape_torus(2, 1, 12, 8), shape_sheet(0, 6)};
  for (int i = 0; i < 2; i++) {
    assert_true(check_allocation_failures(measure, &meshes[i]) > 5);
    assert_true(check_allocation_failures(topology, &meshes[i]) > 5);
    assert_true(check_allocation_failures(area_volume, &meshes[i]) > 1);
  }
  assert_true(check_allocation_failures(distance, meshes) > 15);
  assert_true(check_allocation_failures(field, meshes) > 5);
  for (int i = 0; i < 2; i++) scree_mesh_free(&meshes[i]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_failures)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
