/* Walls that move by a law of time, belts, and forces given to bodies. */
#include "support/law.h"

#include "support/mixed.h"
#include "support/shapes.h"

static const double pi = 3.14159265358979323846, gravity = 9.81;

static void set_motion(scree_world *world, size_t wall, const scree_wall_motion *motions,
                       size_t count) {
  scree_error error;
  CHECK_OK(scree_world_set_wall_motion(world, wall, motions, count, &error), error);
}

static scree_particle *box_particle(double x, double y, double z) {
  scree_error error;
  scree_mesh mesh = shape_box(x, y, z);
  scree_particle *box = NULL;
  CHECK_OK(scree_particle_from_mesh(&mesh, NULL, &box, &error), error);
  scree_mesh_free(&mesh);
  return box;
}

/* A world of walls alone, with this time step. */
static scree_world *empty_world(double time_step) {
  scree_error error;
  scree_world_options o = scree_default_world_options();
  o.time_step = time_step;
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  const scree_material material = scree_default_wall_material();
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  return world;
}

static size_t add_plane(scree_world *world, vec3 at) {
  scree_error error;
  size_t index;
  scree_wall wall = {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}};
  vec3_store(wall.position, at);
  CHECK_OK(scree_world_add_wall(world, &wall, &index, &error), error);
  return index;
}

/* Of 200,000 steps, how far the wall ever is from where `expected` says, and its velocity from the
 * slope of that. */
static void follows(const char *what, const scree_wall_motion *motions, size_t count,
                    vec3 (*expected)(double)) {
  const double h = 1e-6;
  scree_world *world = empty_world(1e-4);
  size_t wall = add_plane(world, expected(0));
  set_motion(world, wall, motions, count);
  double off = 0, off_speed = 0;
  for (int k = 0; k < 2000; k++) {
    law_step(world, 97);
    double t = scree_world_time(world);
    scree_wall now;
    scree_world_get_wall(world, wall, &now);
    off = fmax(off, vec3_distance(vec3_load(now.position), expected(t)));
    vec3 slope = vec3_scale(vec3_sub(expected(t + h), expected(t - h)), 0.5 / h);
    off_speed = fmax(off_speed, vec3_distance(vec3_load(now.velocity), slope));
  }
  char name[100];
  snprintf(name, sizeof name, "%s: off its place, m", what);
  LAW_BELOW("W1", name, off, 1e-12);
  snprintf(name, sizeof name, "%s: off its speed, m/s", what);
  LAW_BELOW("W1", name, off_speed, 1e-6);
  scree_world_free(world);
}

static vec3 on_a_circle(double t) {
  return (vec3){0.1 + 0.3 * cos(2 * t), 0.3 * sin(2 * t), 0};
}

static vec3 shaken(double t) {
  return (vec3){0, 0.002 * sin(2 * pi * 25 * t), 0.001 * (cos(2 * pi * 25 * t) - 1)};
}

/* On a circle about a point that is itself carried up and down. */
static vec3 on_a_moving_circle(double t) {
  return vec3_add(on_a_circle(t), (vec3){0, 0, 0.05 * sin(2 * pi * 1.5 * t)});
}

/* Speeds 0, 1, 1, 0 m/s at 1, 2, 5 and 6 s. */
static vec3 there_and_held(double t) {
  double x = t < 1   ? 0
             : t < 2 ? 0.5 * (t - 1) * (t - 1)
             : t < 5 ? 0.5 + (t - 2)
             : t < 6 ? 4 - 0.5 * (6 - t) * (6 - t)
                     : 4;
  return (vec3){x, 0, 0};
}

/* Of a sliding crank of 0.1 m with a rod of 0.25 m, from its outer dead centre. */
static vec3 cranked(double t) {
  double q = 2 * pi * 1.25 * t;
  return (vec3){0, 0.1 * cos(q) + sqrt(0.0625 - 0.01 * sin(q) * sin(q)) - 0.35, 0};
}

/* A bucket 0.05 m outside of a chain round wheels of 0.1 m about -y, 0.5 m apart along x: it goes
 * along x below them, and half a turn in pi 0.1 m. */
static vec3 on_a_chain(double t) {
  double s = fmod(0.3 * t + 0.2, 1 + 0.2 * pi);
  if (s < 0.5) return (vec3){s, 0, -0.15};
  s -= 0.5;
  if (s < 0.1 * pi) return (vec3){0.5 + 0.15 * sin(s / 0.1), 0, -0.15 * cos(s / 0.1)};
  s -= 0.1 * pi;
  if (s < 0.5) return (vec3){0.5 - s, 0, 0.15};
  s -= 0.5;
  return (vec3){-0.15 * sin(s / 0.1), 0, 0.15 * cos(s / 0.1)};
}

static void places_are_functions_of_time(void **state) {
  (void)state;
  scree_wall_motion turn = scree_default_wall_motion(), up = turn, across = turn, speeds = turn;
  turn.turns = true;
  turn.speed = 2;
  turn.through[0] = 0.1;
  follows("circle", &turn, 1, on_a_circle);
  across.law = up.law = SCREE_MOTION_SINE;
  across.axis[1] = 3, across.axis[2] = 0;
  across.amplitude = 0.002, across.frequency = up.frequency = 25;
  up.amplitude = 0.001, up.phase = pi / 2;
  const scree_wall_motion both[2] = {across, up};
  follows("ellipse", both, 2, shaken);
  up.amplitude = 0.05, up.frequency = 1.5, up.phase = 0;
  const scree_wall_motion carried[2] = {turn, up};
  follows("circle, carried", carried, 2, on_a_moving_circle);
  static const double table[8] = {1, 0, 2, 1, 5, 1, 6, 0};
  speeds.law = SCREE_MOTION_SPEEDS;
  speeds.table = table, speeds.row_count = 4;
  speeds.axis[0] = 1, speeds.axis[2] = 0;
  follows("table of speeds", &speeds, 1, there_and_held);
  scree_wall_motion crank = scree_default_wall_motion(), chain = crank;
  crank.law = SCREE_MOTION_CRANK;
  crank.axis[1] = 1, crank.axis[2] = 0;
  crank.amplitude = 0.1, crank.rod = 0.25, crank.frequency = 1.25;
  follows("crank", &crank, 1, cranked);
  chain.axis[1] = -1, chain.axis[2] = 0;
  chain.span[0] = 0.5;
  chain.radius = 0.1, chain.speed = 0.3, chain.start = 0.2;
  follows("chain", &chain, 1, on_a_chain);
}

/* The angle about z of a wall that turns by `motion` from the time at which it is set, 1 s. */
static double angle_at(scree_wall_motion motion, double time) {
  scree_world *world = empty_world(1e-3);
  size_t wall = add_plane(world, (vec3){0, 0, 0});
  law_step(world, 1000);
  set_motion(world, wall, &motion, 1);
  while (scree_world_time(world) < time - 0.5e-3) law_step(world, 1);
  double q[4];
  scree_world_wall_orientation(world, wall, q);
  scree_world_free(world);
  return 2 * atan2(q[3], q[0]);
}

static void motions_begin_and_end(void **state) {
  (void)state;
  scree_wall_motion turn = scree_default_wall_motion();
  turn.turns = true;
  turn.speed = 0.5;
  LAW_NEAR("W1", "angle since it was set", angle_at(turn, 2), 0.5, 1e-9);
  turn.from = 1.5, turn.until = 2.5;
  LAW_NEAR("W1", "angle before its window", angle_at(turn, 1.4), 0, 1e-15);
  LAW_NEAR("W1", "angle within", angle_at(turn, 2), 0.25, 1e-9);
  LAW_NEAR("W1", "angle after", angle_at(turn, 4), 0.5, 1e-9);
  static const double table[6] = {0, 5, 2, 7, 3, 7.5};
  turn.law = SCREE_MOTION_POSITIONS;
  turn.table = table, turn.row_count = 3;
  turn.from = 0, turn.until = INFINITY;
  LAW_NEAR("W1", "table of angles, from 1 s to 2.5 s", angle_at(turn, 2.5), 1.25, 1e-9);
  LAW_NEAR("W1", "and after its end", angle_at(turn, 4), 1.5, 1e-9);
}

/* A ball on a plate that swings, from its lowest point on, leaves it where A w^2 sin = g and flies
 * v^2/2g higher. */
static void a_shaken_plate_throws(void **state) {
  (void)state;
  law_setup setup = law_default();
  setup.gravity = gravity;
  setup.restitution = 0.1;
  scree_world *world = law_world(&setup);
  size_t plate = law_floor(world);
  scree_particle *ball = law_sphere(0.005);
  scree_body body = scree_default_body();
  body.position[2] = 0.005;
  law_body(world, ball, body);
  law_step(world, 2000);
  scree_world_get_body(world, 0, &body);
  double rest = body.position[2];
  scree_wall_motion shake = scree_default_wall_motion();
  shake.law = SCREE_MOTION_SINE;
  shake.amplitude = 2e-3, shake.frequency = 25, shake.phase = -pi / 2;
  shake.from = scree_world_time(world);
  set_motion(world, plate, &shake, 1);
  double w = 2 * pi * 25, leaves = asin(gravity / (2e-3 * w * w)), v = 2e-3 * w * cos(leaves),
         expected = 2e-3 * (1 + sin(leaves)) + v * v / (2 * gravity), highest = 0;
  double first = 0, worst = 0;
  scree_observation o;
  first = law_ledger(world, &o);
  for (double end = shake.from + (leaves + pi / 2) / w + 2 * v / gravity;
       scree_world_time(world) < end;) {
    law_step(world, 1);
    scree_world_get_body(world, 0, &body);
    highest = fmax(highest, body.position[2] - rest);
    worst = fmax(worst, fabs(law_ledger(world, &o) - first));
  }
  LAW_RELATIVE("W2", "height of a throw, m", highest, expected, 0.01);
  LAW_BELOW("L17", "ledger of the throw, of its energy", worst / o.wall_work, 1e-3);
  scree_world_free(world);
  scree_particle_free(ball);
}

/* A box set down on a belt reaches its speed after v/(mu g), and the belt has given it m v^2: half
 * is its motion, half was lost in sliding. */
static void a_belt_carries(void **state) {
  (void)state;
  law_setup setup = law_default();
  setup.gravity = gravity;
  setup.friction = 0.4;
  scree_world *world = law_world(&setup);
  scree_error error;
  scree_wall belt = {
      .kind = SCREE_WALL_PLANE, .material = 1, .axis = {0, 0, 1}, .surface_velocity = {0.5, 0, 0}};
  CHECK_OK(scree_world_add_wall(world, &belt, NULL, &error), error);
  scree_particle *box = box_particle(0.04, 0.03, 0.01);
  scree_particle_measures m;
  scree_particle_measure(box, &m);
  scree_body body = scree_default_body();
  body.position[2] = 0.005 + m.rounding;
  law_body(world, box, body);
  scree_observation o;
  double first = law_ledger(world, &o), expected = 0.5 / (0.4 * gravity), reached = 0;
  while (scree_world_time(world) < 2 * expected) {
    law_step(world, 1);
    scree_world_get_body(world, 0, &body);
    if (body.velocity[0] < 0.995 * 0.5) reached = scree_world_time(world);
  }
  double power, energy, mass = scree_world_body_mass(world, 0);
  scree_world_wall_power(world, 0, &power, &energy);
  LAW_RELATIVE("W3", "time to the belt's speed, s", reached / 0.995, expected, 0.01);
  LAW_RELATIVE("W3", "speed on the belt, m/s", body.velocity[0], 0.5, 1e-3);
  LAW_RELATIVE("W3", "work of the belt, J", energy, mass * 0.25, 0.01);
  LAW_BELOW("W3", "power when it is carried, W", fabs(power), 1e-3);
  LAW_BELOW("L17", "ledger of the belt, of its work", fabs(law_ledger(world, &o) - first) / energy,
            1e-3);
  scree_wall now;
  scree_world_get_wall(world, 0, &now);
  LAW_NEAR("W3", "the belt itself moved by", now.position[0], 0, 0);
  scree_world_free(world);
  scree_particle_free(box);
}

/* A box in the middle of a turntable, of which the surface alone turns. */
static void a_turntable_spins(void **state) {
  (void)state;
  law_setup setup = law_default();
  setup.gravity = gravity;
  scree_world *world = law_world(&setup);
  size_t table = law_floor(world);
  scree_particle *box = box_particle(0.04, 0.04, 0.01);
  scree_particle_measures m;
  scree_particle_measure(box, &m);
  scree_body body = scree_default_body();
  body.position[2] = 0.005 + m.rounding;
  law_body(world, box, body);
  law_step(world, 2000);
  scree_error error;
  CHECK_OK(scree_world_set_wall_surface(world, table, (double[3]){0}, (double[3]){0, 0, 3},
                                        (double[3]){0}, &error),
           error);
  scree_observation o;
  double first = law_ledger(world, &o);
  while (scree_world_time(world) < 0.3) law_step(world, 100);
  scree_world_get_body(world, 0, &body);
  double power, energy;
  scree_world_wall_power(world, table, &power, &energy);
  LAW_RELATIVE("W3", "spin on a turntable, rad/s", body.angular_velocity[2], 3, 1e-3);
  LAW_BELOW("L17", "ledger of the turntable, of its work",
            fabs(law_ledger(world, &o) - first) / energy, 2e-3);
  scree_world_free(world);
  scree_particle_free(box);
}

/* A soft mixed heap in walls that turn, swing and run. */
static void moving_walls_keep_the_ledger(void **state) {
  (void)state;
  scree_world *world = mixed_world(SCREE_LAW_LINEAR);
  scree_wall_motion swing = scree_default_wall_motion();
  swing.turns = true;
  swing.law = SCREE_MOTION_SINE;
  swing.axis[0] = 1, swing.axis[2] = 0;
  swing.amplitude = 0.1, swing.frequency = 3;
  set_motion(world, 1, &swing, 1);
  scree_error error;
  CHECK_OK(scree_world_set_wall_surface(world, 2, (double[3]){0.2, 0, 0}, (double[3]){0},
                                        (double[3]){0}, &error),
           error);
  scree_observation o;
  double first = law_ledger(world, &o), worst = 0;
  for (int i = 0; i < 200; i++) {
    law_step(world, 20);
    worst = fmax(worst, fabs(law_ledger(world, &o) / first - 1));
  }
  assert_true(o.contact_count > 5);
  LAW_BELOW("L17", "ledger of a heap on a belt in a swinging tube", worst, 2e-3);
  scree_world_free(world);
}

/* A force and a torque that are given do the work of F s and T phi. */
static void given_forces_work(void **state) {
  (void)state;
  const law_setup setup = law_default();
  scree_world *world = law_world(&setup);
  law_floor(world);
  scree_particle *ball = law_sphere(0.01);
  scree_body body = scree_default_body();
  body.position[2] = 1;
  size_t index = law_body(world, ball, body);
  double mass = scree_world_body_mass(world, index), inertia = 0.4 * mass * 1e-4;
  scree_error error;
  CHECK_OK(scree_world_set_body_force(world, index, (double[3]){2 * mass, 0, 0},
                                      (double[3]){0, 3 * inertia, 0}, &error),
           error);
  law_step(world, 5000);
  double t = scree_world_time(world);
  scree_world_get_body(world, index, &body);
  LAW_RELATIVE("W4", "speed by a given force, m/s", body.velocity[0], 2 * t, 1e-12);
  LAW_RELATIVE("W4", "spin by a given torque, rad/s", body.angular_velocity[1], 3 * t, 1e-9);
  scree_observation o;
  LAW_NEAR("W4", "ledger, J", law_ledger(world, &o), 0, 1e-7 * o.applied_work);
  CHECK_OK(scree_world_set_body_force(world, index, (double[3]){0}, (double[3]){0}, &error), error);
  law_step(world, 2);
  scree_world_observe(world, &o);
  double before = o.applied_work;
  law_step(world, 100);
  scree_world_observe(world, &o);
  LAW_NEAR("W4", "work after it ended, J", o.applied_work - before, 0, 0);
  scree_world_free(world);
  scree_particle_free(ball);
}

static void bad_motions_are_refused(void **state) {
  (void)state;
  scree_world *world = empty_world(1e-3);
  size_t wall = add_plane(world, (vec3){0, 0, 0});
  const double backwards[4] = {1, 0, 1, 2}, infinite[2] = {0, INFINITY};
  scree_wall_motion bad[11];
  for (int i = 0; i < 11; i++) bad[i] = scree_default_wall_motion();
  bad[0].axis[2] = 0;
  bad[1].speed = NAN;
  bad[2].from = 2, bad[2].until = 1;
  bad[3].law = SCREE_MOTION_SINE, bad[3].frequency = 0;
  bad[4].law = SCREE_MOTION_SPEEDS;
  bad[5].law = SCREE_MOTION_SPEEDS, bad[5].table = backwards, bad[5].row_count = 2;
  bad[6].law = SCREE_MOTION_POSITIONS, bad[6].table = infinite, bad[6].row_count = 1;
  bad[7].law = (scree_motion_law)9;
  bad[8].law = SCREE_MOTION_CRANK, bad[8].amplitude = bad[8].rod = 0.1;
  bad[9].radius = 0.1, bad[9].span[2] = 1; /* along the axis */
  bad[10].radius = -0.1;
  scree_error error;
  for (int i = 0; i < 11; i++) {
    assert_int_equal(scree_world_set_wall_motion(world, wall, &bad[i], 1, &error),
                     SCREE_BAD_ARGUMENT);
    print_message("%s\n", error.message);
  }
  assert_int_equal(scree_world_set_wall_motion(world, 1, NULL, 0, &error), SCREE_BAD_ARGUMENT);
  scree_world_free(world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(places_are_functions_of_time),
      cmocka_unit_test(motions_begin_and_end),
      cmocka_unit_test(a_shaken_plate_throws),
      cmocka_unit_test(a_belt_carries),
      cmocka_unit_test(a_turntable_spins),
      cmocka_unit_test(moving_walls_keep_the_ledger),
      cmocka_unit_test(given_forces_work),
      cmocka_unit_test(bad_motions_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
