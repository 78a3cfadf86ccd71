/* The names and lists of the public interface: each value has one, no two have the same, and what
 * lies beyond the last has none. */
#include "base/error.h"
#include "mesh/repair/repair.h"
#include "support/check.h"
#include "support/shapes.h"

static void defects(void **state) {
  (void)state;
  static const bool grave[] = {
#define GRAVE(name, key, is_grave, one, several) is_grave,
      SCREE_DEFECT_LIST(GRAVE)
#undef GRAVE
  };
  for (int i = 0; i < SCREE_DEFECT_COUNT; i++) {
    assert_int_equal(scree_defect_is_grave((scree_defect)i), grave[i]);
    assert_string_not_equal(scree_defect_text((scree_defect)i, 1),
                            scree_defect_text((scree_defect)i, 2));
    assert_string_equal(scree_defect_text((scree_defect)i, 0),
                        scree_defect_text((scree_defect)i, 2));
    for (int j = 0; j < i; j++)
      assert_string_not_equal(scree_defect_name((scree_defect)i),
                              scree_defect_name((scree_defect)j));
  }
}

static void repairs(void **state) {
  (void)state;
  for (int i = 0; i < SCREE_REPAIR_ACTION_COUNT; i++) {
    assert_string_not_equal(scree_repair_action_text((scree_repair_action)i, 1),
                            scree_repair_action_text((scree_repair_action)i, 2));
    for (int j = 0; j < i; j++)
      assert_string_not_equal(scree_repair_action_name((scree_repair_action)i),
                              scree_repair_action_name((scree_repair_action)j));
  }
  assert_string_equal(scree_repair_action_text(SCREE_REPAIR_ACTION_COUNT, 1), "unknown");
}

static void statuses(void **state) {
  (void)state;
  for (int i = 0; i < SCREE_STATUS_COUNT; i++)
    for (int j = 0; j < i; j++)
      assert_string_not_equal(scree_status_text((scree_status)i),
                              scree_status_text((scree_status)j));
  assert_string_equal(scree_status_text(SCREE_STATUS_COUNT), "unknown status");
}

/* Two kinds in a world, in the order of their first bodies. */
static void shapes(void **state) {
  (void)state;
  enum { BODIES = 5 };
  const scree_material material = scree_default_material();
  scree_particle *small, *large;
  scree_world *world = NULL;
  scree_error error;
  CHECK_OK(scree_particle_sphere(0.01, &small, &error), error);
  CHECK_OK(scree_particle_sphere(0.02, &large, &error), error);
  CHECK_OK(scree_world_create(NULL, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  for (int i = 0; i < BODIES; i++)
    CHECK_OK(scree_world_add_body(world, i % 2 ? small : large, 0, NULL, NULL, &error), error);
  scree_world_remove_body(world, 0);
  assert_ptr_equal(scree_world_shape(world, 0), large);
  assert_ptr_equal(scree_world_shape(world, 1), small);
  assert_null(scree_world_shape(world, 2));
  scree_world_free(world);
  scree_particle_free(small);
  scree_particle_free(large);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(defects), cmocka_unit_test(repairs),
                                     cmocka_unit_test(statuses), cmocka_unit_test(shapes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
