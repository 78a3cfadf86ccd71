/* Forces are gathered from pairs that are awake: every pair that touched in a step is, also one
 * that ended its sub-steps in it and of which no feature is awake any more. */
#include "support/law.h"

#include "base/vec.h"
#include "support/shapes.h"
#include "world/state/world.h"

/* Cubes hit each other; while their pair is in sub-steps they are taken apart by more than any
 * feature stays awake for. What is owed to them from the last sub-steps still acts. */
static void what_touched_is_awake(void **state) {
  (void)state;
  scree_particle *cube = shape_particle(shape_box(0.05, 0.05, 0.05));
  law_setup setup = law_default();
  setup.steps_per_contact = 20;
  scree_world *world = law_world(&setup);
  law_body(world, cube, scree_default_body());
  const quat q = quat_from_rotation_vector((vec3){0.1, 0.5, 0.7});
  const scree_body thrown = {.position = {0.085, 0.005, 0.01},
                             .orientation = {q.w, q.x, q.y, q.z},
                             .velocity = {-15, 0, 0}};
  law_body(world, cube, thrown);
  const scree_pair *pair = NULL;
  while (!pair || pair->substeps.count < 2) {
    law_step(world, 1);
    pair = world->list.neighbours.count ? scree_pair_of(world, 0) : NULL;
    assert_true(scree_world_time(world) < 0.01);
  }
  world->bodies.frame[1].position.x += 0.004;
  law_step(world, 1);
  pair = scree_pair_of(world, 0);
  assert_true(scree_pair_touches(world, 0));
  assert_non_null(pair);
  assert_int_equal(pair->active.count, 0);
  assert_true(pair->touching && pair->substeps.count == 1 && !(pair->depth > 0) &&
              !pair->depenetrating);
  law_step(world, 100);
  assert_false(scree_pair_touches(world, 0));
  scree_world_free(world);
  scree_particle_free(cube);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_touched_is_awake)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
