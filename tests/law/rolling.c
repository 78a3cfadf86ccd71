/* Rolling resistance (Ai and others 2011, type C) of spheres, clumps and meshes beside its closed
 * forms, and bodies that stick. */
#include "support/law.h"

#include "support/shapes.h"
#include "support/solids.h"

static const double pi = 3.14159265358979323846, gravity = 9.81;
static scree_rolling limited = SCREE_ROLLING_COUPLE; /* of what is made next */

static void set_pair(scree_world *world, size_t a, size_t b, double rolling, double pull_off,
                     double surface_energy) {
  scree_error error;
  scree_material_contact contact;
  CHECK_OK(scree_world_get_pair(world, a, b, &contact, &error), error);
  contact.rolling_friction = rolling;
  contact.pull_off = pull_off;
  contact.surface_energy = surface_energy;
  CHECK_OK(scree_world_set_pair(world, a, b, &contact, &error), error);
}

static void push(scree_world *world, size_t body, vec3 by) {
  scree_error error;
  double force[3];
  vec3_store(force, by);
  CHECK_OK(scree_world_set_body_force(world, body, force, (double[3]){0}, &error), error);
}

/* A ball of 1 cm on a plane under a gravity that leans by the angle of this tangent. */
static scree_world *incline(double tangent, double rolling) {
  law_setup setup = law_default();
  setup.rolling = limited;
  setup.gravity = gravity / sqrt(1 + tangent * tangent);
  scree_world *world = law_world(&setup);
  law_floor(world);
  set_pair(world, 0, 1, rolling, 0, 0);
  scree_particle *ball = law_sphere(0.01);
  scree_body body = scree_default_body();
  body.position[2] = 0.01;
  law_body(world, ball, body);
  scree_particle_free(ball);
  push(world, 0, (vec3){scree_world_body_mass(world, 0) * setup.gravity * tangent, 0, 0});
  return world;
}

/* The speed after 0.5 s, and how far it still goes in the next 0.5 s. */
static double speed_on(double tangent, double rolling, double *creep) {
  scree_world *world = incline(tangent, rolling);
  scree_body body;
  while (scree_world_time(world) < 0.5) law_step(world, 10);
  scree_world_get_body(world, 0, &body);
  double at = body.position[0], speed = body.velocity[0] / scree_world_time(world);
  while (scree_world_time(world) < 1) law_step(world, 10);
  scree_world_get_body(world, 0, &body);
  *creep = body.position[0] - at;
  scree_world_free(world);
  return speed;
}

static void balls_on_inclines(void **state) {
  (void)state;
  const double rolling = 0.1;
  double creep, slope = 1 / sqrt(1 + 0.11 * 0.11);
  speed_on(0.98 * rolling, rolling, &creep);
  LAW_NEAR("R1", "creep at tan = 0.98 mu_r, m", creep, 0, 1e-9);
  LAW_RELATIVE("R1", "acceleration at tan = 1.1 mu_r, m/s2", speed_on(0.11, rolling, &creep),
               5.0 / 7 * gravity * slope * (0.11 - rolling), 0.01);
  LAW_RELATIVE("R1", "acceleration without resistance, m/s2", speed_on(0.11, 0, &creep),
               5.0 / 7 * gravity * slope * 0.11, 0.005);
}

/* At rest on a level plane, then thrown along x; how it begins. */
static scree_world *thrown_ball(double rolling, double speed, double spin, scree_body *body) {
  scree_world *world = incline(0, rolling);
  law_step(world, 1000);
  scree_world_get_body(world, 0, body);
  body->velocity[0] = speed;
  body->angular_velocity[1] = spin;
  law_place(world, 0, body);
  return world;
}

static void a_rolling_ball_stops(void **state) {
  (void)state;
  const double rolling = 0.05, speed = 0.2;
  scree_body body;
  scree_world *world = thrown_ball(rolling, speed, speed / 0.01, &body);
  double from = body.position[0];
  scree_observation o;
  double first = law_ledger(world, &o);
  while (scree_world_time(world) < 1.2) law_step(world, 10);
  scree_world_get_body(world, 0, &body);
  LAW_RELATIVE("R2", "way of a rolling ball, m", body.position[0] - from,
               0.5 * speed * speed / (5.0 / 7 * rolling * gravity), 0.01);
  LAW_BELOW("R2", "its speed then, m/s", fabs(body.velocity[0]), 1e-9);
  double lost = law_ledger(world, &o) - first;
  LAW_BELOW("L17", "ledger of it, of its energy", fabs(lost) / (o.dissipated_friction), 1e-3);
  scree_world_free(world);
}

/* Where the spring alone is limited what rolls on rolls as far, and what rocks to and fro below the
 * limit comes to rest sooner. */
static void a_spring_alone_is_limited(void **state) {
  limited = SCREE_ROLLING_EPSD;
  a_rolling_ball_stops(state);
  scree_body body;
  scree_world *world = thrown_ball(0.3, 0, 0.5, &body);
  for (int i = 0; i < 40; i++) law_step(world, 1);
  scree_world_get_body(world, 0, &body);
  const double alone = fabs(body.angular_velocity[1]);
  scree_world_free(world);
  limited = SCREE_ROLLING_COUPLE;
  world = thrown_ball(0.3, 0, 0.5, &body);
  for (int i = 0; i < 40; i++) law_step(world, 1);
  scree_world_get_body(world, 0, &body);
  print_message("spin left: %g, of the whole couple's limit %g\n", alone,
                fabs(body.angular_velocity[1]));
  assert_true(alone < fabs(body.angular_velocity[1]));
  scree_world_free(world);
}

/* Thrown without spin it slides until it rolls, the couple against its spin all the while. */
static void a_thrown_ball_slides_rolls_and_stops(void **state) {
  (void)state;
  const double rolling = 0.2, friction = law_default().friction, speed = 0.5;
  scree_body body;
  scree_world *world = thrown_ball(rolling, speed, 0, &body);
  double from = body.position[0];
  while (scree_world_time(world) < 0.6) law_step(world, 10);
  scree_world_get_body(world, 0, &body);
  const double sliding = speed / ((friction + 2.5 * (friction - rolling)) * gravity),
               rolls = speed - friction * gravity * sliding,
               way = 0.5 * (speed + rolls) * sliding +
                     0.5 * rolls * rolls / (5.0 / 7 * rolling * gravity);
  LAW_RELATIVE("R2", "way of a thrown ball, m", body.position[0] - from, way, 2e-3);
  LAW_BELOW("R2", "its speed then, m/s", fabs(body.velocity[0]), 1e-9);
  scree_world_free(world);
}

/* ---- bodies that are no spheres ---- */

/* On a plane, or a sheet of 32 facets; the body's own axes as in its file. */
static scree_world *on_floor(scree_particle *particle, double height, bool sheet, double friction,
                             double rolling) {
  scree_error error;
  law_setup setup = law_default();
  setup.gravity = gravity;
  setup.friction = friction;
  setup.restitution = 0.1;
  setup.stiffness = 1e7;
  setup.steps_per_contact = 20;
  scree_world *world = law_world(&setup);
  if (sheet) {
    scree_mesh mesh = shape_sheet(0, 4);
    shape_move(&mesh, (vec3){-0.2, -0.5, 0});
    scree_wall wall = {.kind = SCREE_WALL_MESH, .material = 1, .axis = {0, 0, 1}, .mesh = &mesh};
    CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
    scree_mesh_free(&mesh);
  } else {
    law_floor(world);
  }
  set_pair(world, 0, 1, rolling, 0, 0);
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  scree_body body = scree_default_body();
  body.position[2] = height + m.rounding;
  memcpy(body.orientation, m.orientation, sizeof body.orientation);
  law_body(world, particle, body);
  return world;
}

/* From rolling at v0 it goes 7 v0^2/(10 mu_r g). */
static void all_kinds_stop_as_spheres_do(void **state) {
  (void)state;
  const double r = 0.01, rolling = 0.05, speed = 0.2, centres[6] = {0}, radii[2] = {r, 0.99 * r};
  for (int kind = 0; kind < 4; kind++) {
    scree_error error;
    const bool clump = kind % 2, sheet = kind >= 2;
    scree_particle *particle = NULL;
    if (clump)
      CHECK_OK(scree_particle_clump(centres, radii, 2, NULL, &particle, &error), error);
    else
      particle = law_sphere(r);
    scree_world *world = on_floor(particle, r, sheet, 0.5, rolling);
    law_step(world, 1000);
    scree_body body;
    scree_world_get_body(world, 0, &body);
    body.velocity[0] = speed;
    body.angular_velocity[1] = speed / r;
    law_place(world, 0, &body);
    const double from = body.position[0];
    while (scree_world_time(world) < 1) law_step(world, 100);
    scree_world_get_body(world, 0, &body);
    print_message("a %s on a %s\n", clump ? "clump" : "sphere", sheet ? "sheet" : "plane");
    LAW_RELATIVE("R2", "way until it stops, m", body.position[0] - from,
                 0.7 * speed * speed / (rolling * gravity), 0.01);
    LAW_BELOW("R2", "its speed then, m/s", fabs(body.velocity[0]), 1e-9);
    scree_world_free(world);
    scree_particle_free(particle);
  }
}

/* m/s2, of a sphere of so many facets that rolls at 1 m/s, in the mean of a fifth of a second and
 * of how it is turned. */
static double deceleration(int level, double rolling) {
  enum { TURNS = 8 };
  const double r = 0.01, end = 0.2;
  scree_particle *particle = shape_particle(shape_icosphere(r, level));
  scree_rng rng = {.seed = 80};
  double sum = 0;
  for (int k = 0; k < TURNS; k++) {
    scree_world *world = on_floor(particle, r, false, 1, rolling);
    const quat q = scree_rng_rotation(&rng);
    scree_body body;
    scree_world_get_body(world, 0, &body);
    memcpy(body.orientation, (double[4]){q.w, q.x, q.y, q.z}, sizeof body.orientation);
    body.velocity[0] = 1;
    body.angular_velocity[1] = 1 / r;
    law_place(world, 0, &body);
    while (scree_world_time(world) < end) law_step(world, 10);
    scree_world_get_body(world, 0, &body);
    sum += (1 - body.velocity[0]) / scree_world_time(world) / TURNS;
    scree_world_free(world);
  }
  scree_particle_free(particle);
  return sum;
}

/* Facets cost some of it by themselves. */
static void facets_add_to_it(void **state) {
  (void)state;
  for (int level = 2; level < 4; level++)
    LAW_RELATIVE("R2", "320, 1280 facets: slowed by mu_r alone, m/s2",
                 deceleration(level, 0.3) - deceleration(level, 0), 5.0 / 7 * 0.3 * gravity, 0.05);
}

/* How far the centre of what lies on the plane has gone half a second after it is pushed there by
 * this share of its weight. */
static double way_of_pushed(scree_particle *particle, double height, double share, double rolling) {
  scree_world *world = on_floor(particle, height, false, 2, rolling);
  const double weight = scree_world_body_mass(world, 0) * gravity;
  for (int k = 0; k <= 100; k++) {
    push(world, 0, (vec3){weight * share * k / 100, 0, 0});
    law_step(world, 30);
  }
  for (double from = scree_world_time(world); scree_world_time(world) < from + 0.5;)
    law_step(world, 10);
  scree_body body;
  scree_world_get_body(world, 0, &body);
  scree_world_free(world);
  return body.position[0];
}

/* A box tips, and a prism of six sides rolls, where the force's moment is beyond that of its weight
 * about the edge by mu_r times the height of its centre. */
static void boxes_tip_and_prisms_roll_later(void **state) {
  (void)state;
  const double side = 0.01, root = 0.5 * sqrt(3), rollings[] = {0, 0.2, 0.3};
  double hexagon[12];
  for (int k = 0; k < 6; k++) {
    hexagon[2 * k] = side * cos(pi / 3 * k);
    hexagon[2 * k + 1] = side * sin(pi / 3 * k);
  }
  const mat3 lying = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}}; /* its axis along y */
  scree_mesh prism = solid_prism(hexagon, 6, 0.03);
  shape_transform(&prism, &lying, (vec3){0, 0, 0});
  const struct {
    const char *name;
    scree_particle *particle;
    double height, tangent;
  } bodies[] = {{"box", shape_particle(shape_box(0.01, 0.02, 0.04)), 0.02, 0.25},
                {"prism", shape_particle(prism), root * side, 0.5 / root}};
  for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++) {
    for (size_t k = 0; k < sizeof rollings / sizeof *rollings; k++) {
      const double onset = bodies[i].tangent + rollings[k];
      print_message("%s, mu_r %g\n", bodies[i].name, rollings[k]);
      LAW_NEAR("R3", "pushed by 0.99 of its onset it stays, m",
               way_of_pushed(bodies[i].particle, bodies[i].height, 0.99 * onset, rollings[k]), 0,
               3e-4);
      LAW_NEAR("R3", "by 1.01 it goes",
               way_of_pushed(bodies[i].particle, bodies[i].height, 1.01 * onset, rollings[k]) >
                   2e-3,
               1, 0);
    }
    scree_particle_free(bodies[i].particle);
  }
}

/* Needles and plates, thrown and spinning, lie still in the end. */
static void needles_and_plates_come_to_rest(void **state) {
  (void)state;
  const double sizes[2][3] = {{0.03, 0.0025, 0.0025}, {0.02, 0.02, 0.02 / 12}},
               rollings[] = {0.3, 1};
  scree_rng rng = {.seed = 79};
  for (int k = 0; k < 8; k++) {
    const double *size = sizes[k % 2];
    scree_particle *particle = shape_particle(shape_box(size[0], size[1], size[2]));
    scree_world *world = on_floor(particle, 0.02, k >= 4, 0.5, rollings[k / 2 % 2]);
    scree_body body;
    scree_world_get_body(world, 0, &body);
    const quat q = scree_rng_rotation(&rng);
    memcpy(body.orientation, (double[4]){q.w, q.x, q.y, q.z}, sizeof body.orientation);
    body.velocity[0] = 0.3;
    vec3_store(body.angular_velocity, vec3_scale(scree_rng_direction(&rng), 50));
    law_place(world, 0, &body);
    scree_observation o;
    const double first = law_ledger(world, &o);
    while (scree_world_time(world) < 2) law_step(world, 1000);
    const double missed = fabs(law_ledger(world, &o) - first) / first;
    LAW_BELOW("R3", "kinetic energy of a needle or plate at the end, J", o.kinetic + o.rotational,
              1e-20);
    LAW_BELOW("L17", "ledger of it", missed, 1e-3);
    scree_world_free(world);
    scree_particle_free(particle);
  }
}

/* Whether a body that lies on the plane has left it after pulling at it with `force` for 20 ms. */
static bool leaves(scree_particle *particle, double height, double pull_off, double surface_energy,
                   double force) {
  law_setup setup = law_default();
  scree_world *world = law_world(&setup);
  law_floor(world);
  set_pair(world, 0, 1, 0, pull_off, surface_energy);
  scree_body body = scree_default_body();
  body.position[2] = height;
  law_body(world, particle, body);
  push(world, 0, (vec3){0, 0, -0.02});
  law_step(world, 3000);
  for (int k = 0; k <= 100; k++) {
    push(world, 0, (vec3){0, 0, force * k / 100});
    law_step(world, 30);
  }
  law_step(world, 3000);
  scree_observation o;
  scree_world_observe(world, &o);
  scree_world_free(world);
  return o.contact_count == 0;
}

static void pull_off_forces(void **state) {
  (void)state;
  const double w = 5, r = 0.01, jkr = 1.5 * pi * w * r;
  scree_particle *ball = law_sphere(r);
  LAW_NEAR("C1", "ball held at 0.99 of 3/2 pi w R", leaves(ball, r, 0, w, 0.99 * jkr), 0, 0);
  LAW_NEAR("C1", "ball let go at 1.01 of it", leaves(ball, r, 0, w, 1.01 * jkr), 1, 0);
  LAW_NEAR("C1", "ball held at 0.99 of a pull-off force", leaves(ball, r, 0.2, 0, 0.198), 0, 0);
  LAW_NEAR("C1", "ball let go at 1.01 of it", leaves(ball, r, 0.2, 0, 0.202), 1, 0);
  LAW_NEAR("C1", "and without any", leaves(ball, r, 0, 0, 1e-3), 1, 0);
  scree_particle *box = shape_particle(shape_box(0.02, 0.02, 0.01));
  scree_particle_measures m;
  scree_particle_measure(box, &m);
  double height = 0.005 + m.rounding;
  LAW_NEAR("C1", "box held at 0.99 of a pull-off force", leaves(box, height, 0.2, 0, 0.198), 0, 0);
  LAW_NEAR("C1", "box let go at 1.12 of it, 1/(1 - kappa)", leaves(box, height, 0.2, 0, 0.224), 1,
           0);
  scree_particle_free(ball);
  scree_particle_free(box);
}

/* A ball hits a plane that holds it: undamped it leaves as it came, slow and damped it stays. */
static void hits_stick(void **state) {
  (void)state;
  const struct {
    double restitution, speed, rebound;
  } hits[] = {{1, 0.5, 0.5}, {1, 0.01, 0.01}, {0.3, 0.01, 0}};
  scree_particle *ball = law_sphere(0.01);
  for (size_t i = 0; i < sizeof hits / sizeof *hits; i++) {
    law_setup setup = law_default();
    setup.restitution = hits[i].restitution;
    scree_world *world = law_world(&setup);
    law_floor(world);
    set_pair(world, 0, 1, 0, 0, 20);
    scree_body body = scree_default_body();
    body.position[2] = 0.01 + 1e-5;
    body.velocity[2] = -hits[i].speed;
    law_body(world, ball, body);
    scree_observation o;
    double first = law_ledger(world, &o), worst = 0;
    for (int k = 0; k < 5000; k++) {
      law_step(world, 1);
      worst = fmax(worst, fabs(law_ledger(world, &o) - first) / first);
    }
    scree_world_get_body(world, 0, &body);
    LAW_NEAR("C2", "speed after a hit, m/s", body.velocity[2], hits[i].rebound,
             2e-3 * hits[i].speed);
    LAW_BELOW("L17", "ledger of it", worst, 5e-3);
    scree_world_free(world);
  }
  scree_particle_free(ball);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(balls_on_inclines),
      cmocka_unit_test(a_rolling_ball_stops),
      cmocka_unit_test(a_spring_alone_is_limited),
      cmocka_unit_test(a_thrown_ball_slides_rolls_and_stops),
      cmocka_unit_test(all_kinds_stop_as_spheres_do),
      cmocka_unit_test(facets_add_to_it),
      cmocka_unit_test(boxes_tip_and_prisms_roll_later),
      cmocka_unit_test(needles_and_plates_come_to_rest),
      cmocka_unit_test(pull_off_forces),
      cmocka_unit_test(hits_stick),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
