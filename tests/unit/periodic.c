/* Periodic worlds: what happens across a boundary is what happens in the middle, to rounding; far
 * from a boundary the bits are those of a world without; a body that goes round and round on a
 * plane moves as on an endless one; what cannot be repeated is refused. */
#include "base/rng.h"
#include "support/check.h"
#include "support/shapes.h"

#include <string.h>

enum { BODIES = 24 };

static scree_world *make_world(double period, bool two_axes) {
  scree_error error;
  scree_world *world;
  scree_world_options o = scree_default_world_options();
  scree_wall floor = {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}};
  scree_material grain = {.young = 1e6, .density = 2000, .restitution = 0.5, .friction = 0.4};
  o.period[0] = period;
  if (two_axes) o.period[1] = period;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, &grain, NULL, &error), error);
  CHECK_OK(scree_world_add_wall(world, &floor, NULL, &error), error);
  return world;
}

/* Boxes and balls that fall onto each other about (x, y). */
static void fill(scree_world *world, double x, double y) {
  scree_error error;
  scree_particle *box = shape_particle(shape_box(0.02, 0.014, 0.01)), *ball;
  scree_rng rng = {.seed = 5};
  CHECK_OK(scree_particle_sphere(0.008, &ball, &error), error);
  for (int i = 0; i < BODIES; i++) {
    scree_body body = scree_default_body();
    quat q = scree_rng_rotation(&rng);
    const double at[3] = {x + 0.028 * (i % 3 - 1), y + 0.028 * (i / 3 % 2 - 0.5),
                          0.016 + 0.026 * (i / 6)};
    memcpy(body.position, at, sizeof at);
    memcpy(body.orientation, (double[4]){q.w, q.x, q.y, q.z}, sizeof body.orientation);
    body.velocity[0] = 0.3 * (scree_rng_uniform(&rng) - 0.5);
    body.velocity[2] = -0.2;
    CHECK_OK(scree_world_add_body(world, i % 2 ? ball : box, 0, &body, NULL, &error), error);
  }
  scree_particle_free(box);
  scree_particle_free(ball);
}

/* The distance of two places, or of their nearest images. */
static double apart(double a, double b, double period) {
  double d = a - b;
  return period > 0 ? fabs(d - period * floor(d / period + 0.5)) : fabs(d);
}

/* The steps end before chaos has made much of the rounding, of which a further 300 make ten times
 * as much. */
static void check_shifted(double period, bool two_axes, double x, double y) {
  scree_error error;
  scree_world *free_world = make_world(0, false), *world = make_world(period, two_axes);
  size_t touching = 0;
  fill(free_world, 0.2, 0.2);
  fill(world, x, y);
  for (int k = 0; k < 20; k++) {
    scree_observation a, b;
    CHECK_OK(scree_world_step(free_world, 100, &error), error);
    CHECK_OK(scree_world_step(world, 100, &error), error);
    scree_world_observe(free_world, &a);
    scree_world_observe(world, &b);
    assert_int_equal(a.pair_count, b.pair_count);
    CHECK_NEAR(a.kinetic, b.kinetic, 1e-6 * a.kinetic);
    touching += a.pair_count;
  }
  assert_true(touching > 50);
  for (size_t i = 0; i < BODIES; i++) {
    scree_body a, b;
    scree_world_get_body(free_world, i, &a);
    scree_world_get_body(world, i, &b);
    assert_true(b.position[0] >= 0 && b.position[0] < period);
    CHECK_NEAR(apart(a.position[0] - 0.2, b.position[0] - x, period), 0, 1e-7);
    CHECK_NEAR(apart(a.position[1] - 0.2, b.position[1] - y, two_axes ? period : 0), 0, 1e-7);
    CHECK_NEAR(a.position[2], b.position[2], 1e-7);
  }
  scree_world_free(free_world);
  scree_world_free(world);
}

static void across_a_boundary_as_in_the_middle(void **state) {
  (void)state;
  check_shifted(0.4, false, 0, 0.2); /* half on either side */
  check_shifted(0.4, false, 0.395, 0.2);
  check_shifted(0.4, true, 0.4, 0);     /* over a corner */
  check_shifted(0.13, true, 0.1, 0.06); /* hardly wider than the heap */
}

static void in_the_middle_the_bits_are_those_of_an_endless_world(void **state) {
  (void)state;
  scree_error error;
  scree_world *free_world = make_world(0, false), *world = make_world(0.4, true);
  fill(free_world, 0.2, 0.2);
  fill(world, 0.2, 0.2);
  CHECK_OK(scree_world_step(free_world, 800, &error), error);
  CHECK_OK(scree_world_step(world, 800, &error), error);
  for (size_t i = 0; i < BODIES; i++) {
    scree_body a, b;
    scree_world_get_body(free_world, i, &a);
    scree_world_get_body(world, i, &b);
    assert_memory_equal(&a, &b, sizeof a);
  }
  scree_world_free(free_world);
  scree_world_free(world);
}

/* A box that slides round: v t - mu g t^2 / 2, many periods on, and saved and loaded on its way. */
static void round_and_round(void **state) {
  (void)state;
  scree_error error;
  scree_world *world = make_world(0.1, false);
  scree_particle *box = shape_particle(shape_box(0.02, 0.014, 0.01));
  scree_body body = scree_default_body();
  body.position[2] = 0.005;
  body.velocity[0] = 2;
  CHECK_OK(scree_world_add_body(world, box, 0, &body, NULL, &error), error);
  scree_particle_free(box);
  double x = 0, last = 0;
  while (scree_world_time(world) < 0.3) {
    CHECK_OK(scree_world_step(world, 20, &error), error);
    scree_world_get_body(world, 0, &body);
    double way = body.position[0] - last;
    x += way - 0.1 * floor(way / 0.1 + 0.5);
    last = body.position[0];
  }
  double t = scree_world_time(world);
  CHECK_NEAR(x, 2 * t - 0.5 * 0.4 * 9.81 * t * t, 2e-3);
  assert_true(x > 0.35);
  scree_world_free(world);
}

static void what_cannot_be_repeated_is_refused(void **state) {
  (void)state;
  scree_error error;
  scree_world *world = make_world(0.1, true);
  scree_wall wall = {.kind = SCREE_WALL_PLANE, .axis = {1, 0, 0}};
  assert_int_equal(scree_world_add_wall(world, &wall, NULL, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "does not go on beyond the period along x"));
  wall = (scree_wall){.kind = SCREE_WALL_DISC, .axis = {0, 0, 1}, .radius = 1};
  assert_int_equal(scree_world_add_wall(world, &wall, NULL, &error), SCREE_BAD_ARGUMENT);
  scree_particle *ball;
  CHECK_OK(scree_particle_sphere(0.02, &ball, &error), error);
  assert_int_equal(scree_world_add_body(world, ball, 0, NULL, NULL, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "too short for a body 0.04 m across: at least 0.12 m"));
  scree_particle_free(ball);
  scree_world_free(world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(across_a_boundary_as_in_the_middle),
      cmocka_unit_test(in_the_middle_the_bits_are_those_of_an_endless_world),
      cmocka_unit_test(round_and_round),
      cmocka_unit_test(what_cannot_be_repeated_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
