/* L3, H3: Chung and Ooi 2011 (Granular Matter 13, 643), tests 5 to 8. A sphere that spins hits a
 * plane, another as large or another of a different size, at one normal speed V. Where all of the
 * hit slips, with J = m* (1 + e) V, a sphere of mass m and radius r wins mu J/m along the surface
 * and loses 5/2 mu J/(m r) of its spin; and it does where the surfaces begin faster than
 * 7/2 mu J/m*. */
#include "support/law.h"

static const double restitution = 0.98, friction = 0.092, speed = 0.2;
enum { LOWER = 1, UPPER = 0 };

static scree_world *world_of(scree_law law) {
  scree_error error;
  scree_world *world = NULL;
  scree_world_options o = scree_default_world_options();
  const scree_material m = {.young = 1e9,
                            .poisson = 0.33,
                            .density = 2700,
                            .restitution = restitution,
                            .friction = friction};
  o.law = law;
  o.steps_per_contact = 100;
  o.gravity[2] = 0;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  for (int i = 0; i < 2; i++) CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  return world;
}

static scree_body spinning(double z, double vz, double spin) {
  scree_body body = scree_default_body();
  body.position[2] = z;
  body.velocity[2] = vz;
  body.angular_velocity[1] = spin;
  return body;
}

static void until_apart(scree_world *world) {
  scree_observation o = {.pair_count = 0};
  for (bool touched = false; !touched || o.pair_count > 0; touched |= o.pair_count > 0) {
    law_step(world, 1);
    scree_world_observe(world, &o);
  }
}

/* lower: radius, 0: a plane. As many times the slip that gross slip needs. */
static void hit(scree_law law, double lower, double times) {
  const double upper = 0.005, radii[2] = {upper, lower};
  scree_world *world = world_of(law);
  scree_particle *spheres[2] = {law_sphere(upper), lower > 0 ? law_sphere(lower) : NULL};
  if (!(lower > 0)) law_floor(world);
  law_body(world, spheres[UPPER], spinning(upper + 1e-8, -speed, 0));
  if (lower > 0) law_body(world, spheres[LOWER], spinning(-lower, 0, 0));
  double mass[2] = {scree_world_body_mass(world, 0)}, ease = 1 / mass[0];
  if (lower > 0) mass[1] = scree_world_body_mass(world, 1), ease += 1 / mass[1];
  const double impulse = friction * (1 + restitution) * speed / ease,
               spin = times * 3.5 * impulse * ease / (upper + lower);
  const double places[2] = {upper + 1e-8, -lower};
  for (size_t i = 0; i < (lower > 0 ? 2 : 1); i++) {
    const scree_body body = spinning(places[i], i == UPPER ? -speed : 0, spin);
    law_place(world, i, &body);
  }
  until_apart(world);
  print_message("%s, %s, %g times the slip\n", law == SCREE_LAW_HERTZ ? "Hertz" : "linear",
                !(lower > 0)     ? "plane"
                : lower == upper ? "as large"
                                 : "smaller",
                times);
  for (size_t i = 0; i < (lower > 0 ? 2 : 1); i++) {
    scree_body after;
    scree_world_get_body(world, i, &after);
    LAW_RELATIVE("L3", "tangential velocity (m/s)", after.velocity[0],
                 (i == UPPER ? 1 : -1) * impulse / mass[i], 0.005);
    LAW_RELATIVE("L3", "spin lost (rad/s)", spin - after.angular_velocity[1],
                 2.5 * impulse / (mass[i] * radii[i]), 0.005);
    scree_particle_free(spheres[i]);
  }
  scree_world_free(world);
}

static void spheres_that_spin(void **state) {
  (void)state;
  static const scree_law laws[] = {SCREE_LAW_LINEAR, SCREE_LAW_HERTZ};
  static const double lower[] = {0, 0.005, 0.002}, times[] = {1.2, 3, 10};
  for (int law = 0; law < 2; law++)
    for (int other = 0; other < 3; other++)
      for (int k = 0; k < 3; k++) hit(laws[law], lower[other], times[k]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(spheres_that_spin)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
