/* What is changed between two steps holds from the next one on: nothing of before is left. And what
 * is called a and what b of a pair is no part of the law. */
#include "support/law.h"

#include "base/rng.h"
#include "base/vec.h"
#include "support/shapes.h"
#include "support/solids.h"

/* A cube at rest 0.5 mm from a paddle, that stands for so long and then turns. */
static double pushed_by_a_paddle(size_t steps_before) {
  const law_setup setup = law_default();
  const double still[3] = {0, 0, 0}, turning[3] = {0, 0, 5};
  scree_error error;
  scree_world *world = law_world(&setup);
  scree_particle *cube = shape_particle(shape_box(0.02, 0.02, 0.02));
  scree_mesh mesh = shape_box(0.1, 0.01, 0.04);
  scree_wall paddle = {.kind = SCREE_WALL_MESH, .material = 1, .axis = {0, 0, 1}, .mesh = &mesh};
  scree_body body = scree_default_body();
  size_t wall;
  CHECK_OK(scree_world_add_wall(world, &paddle, &wall, &error), error);
  body.position[0] = 0.08, body.position[1] = 0.0205, body.position[2] = 0.02;
  law_body(world, cube, body);
  law_step(world, steps_before);
  CHECK_OK(scree_world_set_wall_velocity(world, wall, still, turning, &error), error);
  for (double end = scree_world_time(world) + 0.02; scree_world_time(world) < end;)
    law_step(world, 1);
  scree_world_get_body(world, 0, &body);
  scree_world_free(world);
  scree_particle_free(cube);
  scree_mesh_free(&mesh);
  return body.velocity[1];
}

static void a_wall_that_begins_to_turn_wakes_what_sleeps(void **state) {
  (void)state;
  double at_once = pushed_by_a_paddle(0);
  assert_true(at_once > 0.3);
  LAW_RELATIVE("-", "pushed by a paddle that stood before (m/s)", pushed_by_a_paddle(100), at_once,
               1e-9);
}

static void friction_may_change(void **state) {
  (void)state;
  scree_error error;
  scree_world_options o = scree_default_world_options();
  const double slope = 0.3, g = 9.81, fall = g / sqrt(1 + slope * slope);
  o.gravity[0] = slope * fall;
  o.gravity[2] = -fall;
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  scree_material material = scree_default_material();
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  law_floor(world);
  scree_particle *plate = shape_particle(shape_box(0.04, 0.04, 0.01));
  scree_body body = scree_default_body();
  scree_particle_measures m;
  scree_particle_measure(plate, &m);
  memcpy(body.orientation, m.orientation, sizeof body.orientation);
  body.position[2] = 0.0051;
  law_body(world, plate, body);
  while (scree_world_time(world) < 0.1) law_step(world, 20);
  scree_world_get_body(world, 0, &body);
  LAW_BELOW("L9", "speed below the limit of friction (m/s)", fabs(body.velocity[0]), 1e-4);
  CHECK_OK(scree_world_set_contact(world, 0, 1, 0.3, 0.1, &error), error);
  double before = body.velocity[0], start = scree_world_time(world);
  while (scree_world_time(world) < start + 0.1) law_step(world, 20);
  scree_world_get_body(world, 0, &body);
  LAW_RELATIVE("L9", "acceleration once friction is 0.1 (m/s2)",
               (body.velocity[0] - before) / (scree_world_time(world) - start),
               fall * (slope - 0.1), 0.01);
  scree_world_free(world);
  scree_particle_free(plate);
}

static bool count_contact(void *context, const scree_contact *contact) {
  (void)contact;
  ++*(size_t *)context;
  return true;
}

static void what_is_removed_touches_nothing(void **state) {
  (void)state;
  law_setup setup = law_default();
  setup.gravity = 9.81;
  scree_error error;
  scree_world *world = law_world(&setup);
  scree_particle *ball = law_sphere(0.01);
  scree_body body = scree_default_body();
  law_floor(world);
  body.position[2] = 0.01;
  law_body(world, ball, body);
  law_step(world, 2000);
  scree_observation o;
  scree_world_observe(world, &o);
  assert_true(o.contact_count == 1 && o.elastic > 0);
  scree_world_remove_body(world, 0);
  scree_world_observe(world, &o);
  size_t contacts = 0;
  CHECK_OK(scree_world_visit_contacts(world, count_contact, &contacts, &error), error);
  LAW_NEAR("-", "contacts of a removed body", (double)(o.contact_count + o.pair_count + contacts),
           0, 0);
  LAW_NEAR("-", "their energy (J)", o.elastic, 0, 0);
  scree_world_free(world);
  scree_particle_free(ball);
}

static void a_body_put_elsewhere_is_at_rest(void **state) {
  (void)state;
  const law_setup setup = law_default();
  scree_world *world = law_world(&setup);
  scree_particle *ball = law_sphere(0.01);
  scree_body body = scree_default_body();
  law_floor(world);
  body.position[2] = 0.0101;
  body.velocity[2] = -5;
  law_body(world, ball, body);
  scree_observation o;
  do {
    law_step(world, 1);
    scree_world_observe(world, &o);
  } while (o.contact_count == 0);
  law_step(world, 10);
  body.position[2] = 0.1;
  body.velocity[2] = 0;
  law_place(world, 0, &body);
  scree_world_observe(world, &o);
  LAW_NEAR("-", "its kinetic energy (J)", o.kinetic + o.rotational, 0, 0);
  scree_world_free(world);
  scree_particle_free(ball);
}

/* Neither is a body added nor put into a state that is none; it stays as it is. */
static void no_body_has_a_state_that_is_not_finite(void **state) {
  (void)state;
  const law_setup setup = law_default();
  const double odd[] = {NAN, INFINITY, -INFINITY};
  enum { VALUES = sizeof(scree_body) / sizeof(double) };
  scree_error error;
  scree_world *world = law_world(&setup);
  scree_particle *ball = law_sphere(0.01);
  law_body(world, ball, scree_default_body());
  scree_checksum before = scree_world_hash(world);
  for (size_t i = 0; i < 3 * VALUES + 1; i++) {
    double values[VALUES];
    scree_body body = scree_default_body();
    memcpy(values, &body, sizeof body);
    if (i < 3 * VALUES) values[i / 3] = odd[i % 3];
    memcpy(&body, values, sizeof body);
    if (i == 3 * VALUES) body.orientation[0] = 0;
    assert_int_equal(scree_world_set_body(world, 0, &body, &error), SCREE_BAD_ARGUMENT);
    assert_string_equal(error.message, "world: body 0 is to be set to a state that is not finite");
    assert_int_equal(scree_world_add_body(world, ball, 0, &body, NULL, &error), SCREE_BAD_ARGUMENT);
    assert_string_equal(error.message,
                        "world: body 1 is to be added with a state that is not finite");
  }
  scree_checksum after = scree_world_hash(world);
  assert_true(before.high == after.high && before.low == after.low);
  scree_world_free(world);
  scree_particle_free(ball);
}

static void no_wall_is_without_end_but_of_length_0(void **state) {
  (void)state;
  const law_setup setup = law_default();
  scree_error error;
  scree_world *world = law_world(&setup);
  scree_wall wall = {.kind = SCREE_WALL_CYLINDER, .axis = {0, 0, 1}, .radius = 0.1};
  wall.length = INFINITY;
  assert_int_equal(scree_world_add_wall(world, &wall, NULL, &error), SCREE_BAD_ARGUMENT);
  wall.length = 0;
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  scree_world_free(world);
}

/* A hit, the bodies added in either order: velocity and spin of the first shape afterwards. */
static vec3 hit_in_order(scree_particle *const shapes[2], bool swapped, uint64_t number,
                         double friction, vec3 *spin) {
  law_setup setup = law_default();
  setup.friction = friction;
  scree_world *world = law_world(&setup);
  scree_rng rng = {.seed = 31, .stream = number};
  scree_body bodies[2];
  for (int i = 0; i < 2; i++) {
    bodies[i] = scree_default_body();
    quat q = scree_rng_rotation(&rng);
    const double orientation[4] = {q.w, q.x, q.y, q.z};
    memcpy(bodies[i].orientation, orientation, sizeof orientation);
    vec3_store(bodies[i].angular_velocity, vec3_scale(scree_rng_direction(&rng), 5));
    bodies[i].position[0] = i ? 0 : 0.01 * scree_rng_uniform(&rng);
    bodies[i].position[2] = i ? -0.05 : 0.05;
    bodies[i].velocity[2] = i ? 2 : -2;
  }
  for (int i = 0; i < 2; i++) law_body(world, shapes[i != swapped], bodies[i != swapped]);
  while (scree_world_time(world) < 0.04) law_step(world, 10);
  scree_body body;
  scree_world_get_body(world, swapped, &body);
  scree_world_free(world);
  *spin = vec3_load(body.angular_velocity);
  return vec3_load(body.velocity);
}

/* Rounding differs with the order, and some hits make much of it: nine of ten must not. */
static void the_order_of_bodies_is_no_part_of_the_law(void **state) {
  (void)state;
  enum { HITS = 100 };
  scree_particle *shapes[2] = {shape_particle(shape_box(0.05, 0.03, 0.02)),
                               shape_particle(solid_hook(0.06, 0.014, 0.02))};
  for (int rough = 0; rough < 2; rough++) {
    double friction = rough ? 0.5 : 0, slowed = 0, worst = 0, many = 0;
    const double little = rough ? 3e-5 : 1e-8, most = rough ? 1e-2 : 1e-5; /* m/s */
    for (uint64_t k = 0; k < HITS; k++) {
      vec3 spin, spin_swapped, v = hit_in_order(shapes, false, k, friction, &spin),
                               w = hit_in_order(shapes, true, k, friction, &spin_swapped);
      double differs = fmax(vec3_distance(v, w), 0.025 * vec3_distance(spin, spin_swapped));
      worst = fmax(worst, differs);
      many += differs > little ? 1. / HITS : 0;
      slowed = fmax(slowed, v.z + 2);
    }
    assert_true(slowed > 1); /* they hit */
    LAW_BELOW("-", rough ? "the same, with friction" : "swapped, velocities differ by (m/s)", worst,
              most);
    LAW_BELOW("-", "share of hits that differ by more than rounding does", many, 0.1);
  }
  for (int i = 0; i < 2; i++) scree_particle_free(shapes[i]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_wall_that_begins_to_turn_wakes_what_sleeps),
                                     cmocka_unit_test(friction_may_change),
                                     cmocka_unit_test(what_is_removed_touches_nothing),
                                     cmocka_unit_test(a_body_put_elsewhere_is_at_rest),
                                     cmocka_unit_test(no_body_has_a_state_that_is_not_finite),
                                     cmocka_unit_test(no_wall_is_without_end_but_of_length_0),
                                     cmocka_unit_test(the_order_of_bodies_is_no_part_of_the_law)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
