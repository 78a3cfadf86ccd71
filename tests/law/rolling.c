/* Rolling resistance of spheres (Ai and others 2011, type C), and bodies that stick. */
#include "support/law.h"

#include "support/shapes.h"

static const double pi = 3.14159265358979323846, gravity = 9.81;

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
      cmocka_unit_test(a_thrown_ball_slides_rolls_and_stops),
      cmocka_unit_test(pull_off_forces),
      cmocka_unit_test(hits_stick),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
