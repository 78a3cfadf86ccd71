/* H1 to H5: the law of Hertz and Mindlin against closed forms. */
#include "support/law.h"

#include "base/vec.h"
#include "support/shapes.h"

static const double pi = 3.14159265358979323846;

typedef struct hertz_setup {
  double young, poisson, wall_young, wall_poisson, density, restitution, friction, steps, gravity;
} hertz_setup;

static const hertz_setup usual = {1e8, 0.3, 2e9, 0.2, 2500, 1, 0, 100, 0};

static scree_world *hertz_world(const hertz_setup *s) {
  scree_error error;
  scree_world_options o = scree_default_world_options();
  o.law = SCREE_LAW_HERTZ;
  o.steps_per_contact = s->steps;
  o.gravity[2] = -s->gravity;
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  scree_material m = {.young = s->young,
                      .poisson = s->poisson,
                      .density = s->density,
                      .restitution = s->restitution,
                      .friction = s->friction};
  CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  m.young = s->wall_young;
  m.poisson = s->wall_poisson;
  CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  return world;
}

/* h of F = h m^3/2. */
static double hertz_of(const hertz_setup *s, bool with_wall, double radius) {
  double own = (1 - s->poisson * s->poisson) / s->young,
         other = with_wall ? (1 - s->wall_poisson * s->wall_poisson) / s->wall_young : own;
  return 4.0 / 3 * sqrt(with_wall ? radius : 0.5 * radius) / (own + other);
}

static scree_body moving(double z, double vx, double vz) {
  scree_body body = scree_default_body();
  body.position[2] = z;
  body.velocity[0] = vx;
  body.velocity[2] = vz;
  return body;
}

/* Until they have touched and parted: the deepest overlap and how long they touched. */
static void let_hit(scree_world *world, double *deepest, double *duration) {
  scree_observation o;
  double dt = scree_world_time_step(world, NULL);
  *deepest = *duration = 0;
  for (int i = 0; i < 400000; i++) {
    law_step(world, 1);
    scree_world_observe(world, &o);
    if (*duration > 0 && o.pair_count == 0) return;
    *deepest = fmax(*deepest, o.largest_overlap);
    *duration += o.pair_count > 0 ? dt : 0;
  }
  fail_msg("no hit");
}

static void force_and_time_of_a_hit(void **state) {
  (void)state;
  const double radius = 0.01, speeds[] = {0.1, 1, 5};
  scree_particle *sphere = law_sphere(radius);
  for (int with_wall = 0; with_wall < 2; with_wall++)
    for (int i = 0; i < 3; i++) {
      scree_world *world = hertz_world(&usual);
      size_t a = law_body(world, sphere, moving(radius + 1e-6, 0, -speeds[i]));
      if (with_wall)
        law_floor(world);
      else
        law_body(world, sphere, moving(-radius, 0, 0));
      double h = hertz_of(&usual, with_wall, radius), m = scree_world_body_mass(world, a), deepest,
             duration;
      if (!with_wall) m *= 0.5;
      double expected = pow(1.25 * m * speeds[i] * speeds[i] / h, 0.4);
      let_hit(world, &deepest, &duration);
      char what[80];
      snprintf(what, sizeof what, "%s, %g m/s: force (N)", with_wall ? "plane" : "spheres",
               speeds[i]);
      LAW_RELATIVE("H1", what, h * pow(deepest, 1.5), h * pow(expected, 1.5), 0.005);
      LAW_RELATIVE("H1", "contact time (s)", duration, 2.9432 * expected / speeds[i], 0.02);
      scree_world_free(world);
    }
  scree_particle_free(sphere);
}

/* A particle that falls on a plane, or on the middle of a box's face. */
static double rebound(scree_particle *particle, double height, bool on_box, double e,
                      double speed) {
  hertz_setup s = usual;
  s.restitution = e;
  scree_world *world = hertz_world(&s);
  scree_particle *box = shape_particle(shape_box(0.06, 0.05, 0.03));
  scree_particle_measures m;
  scree_particle_measure(box, &m);
  size_t a = law_body(world, particle, moving(height + 1e-6, 0, -speed)), b = 0;
  if (on_box)
    b = law_body(world, box, moving(-0.015 - m.rounding, 0, 0));
  else
    law_floor(world);
  double deepest, duration;
  let_hit(world, &deepest, &duration);
  scree_body up, down = scree_default_body();
  scree_world_get_body(world, a, &up);
  if (on_box) scree_world_get_body(world, b, &down);
  scree_world_free(world);
  scree_particle_free(box);
  return (up.velocity[2] - down.velocity[2]) / speed;
}

static void restitution_at_every_speed(void **state) {
  (void)state;
  scree_error error;
  const double r = 0.01, given[] = {0.1, 0.3, 0.5, 0.7, 0.9}, speeds[] = {0.05, 1, 5},
               centres[] = {-0.008, 0, 0, 0.008, 0, 0, 0, 0.01, 0, 0, -0.01, 0},
               radii[] = {0.01, 0.01, 0.01, 0.01};
  scree_particle *sphere = law_sphere(r), *clump = NULL;
  CHECK_OK(scree_particle_clump(centres, radii, 4, NULL, &clump, &error), error);
  for (int i = 0; i < 5; i++)
    for (int k = 0; k < 3; k++) {
      LAW_NEAR("H2", "restitution of a sphere", rebound(sphere, r, false, given[i], speeds[k]),
               given[i], 0.01);
      LAW_NEAR("H2", "of a sphere on a box", rebound(sphere, r, true, given[i], speeds[k]),
               given[i], 0.01);
      LAW_NEAR("H2", "of a clump, flat", rebound(clump, r, false, given[i], speeds[k]), given[i],
               0.02);
    }
  scree_particle_free(sphere);
  scree_particle_free(clump);
}

/* Chung and Ooi 2011, test 4: aluminium oxide on a plane as stiff, 3.9 m/s; gross slip. */
static void oblique_hits(void **state) {
  (void)state;
  const hertz_setup oxide = {3.8e11, 0.23, 3.8e11, 0.23, 4000, 0.98, 0.092, 40, 0};
  const double r = 0.0025, angles[] = {45, 60, 80}, spins[] = {502, 355, 123};
  scree_particle *sphere = law_sphere(r);
  for (int i = 0; i < 3; i++) {
    double angle = angles[i] * pi / 180, deepest, duration;
    scree_world *world = hertz_world(&oxide);
    law_floor(world);
    size_t a = law_body(world, sphere, moving(r + 1e-7, 3.9 * sin(angle), -3.9 * cos(angle)));
    let_hit(world, &deepest, &duration);
    scree_body after;
    scree_world_get_body(world, a, &after);
    LAW_RELATIVE("H3", "tangential restitution, gross slip", after.velocity[0] / (3.9 * sin(angle)),
                 1 - 0.092 * 1.98 / tan(angle), 0.01);
    LAW_RELATIVE("H3", "spin after (rad/s)", after.angular_velocity[1], spins[i], 0.01);
    scree_world_free(world);
  }
  scree_particle_free(sphere);
}

/* A ball that lies on a plane is pushed: it trembles with w2 = 7/2 K_t/m about rolling. */
static void tangential_stiffness(void **state) {
  (void)state;
  hertz_setup s = usual;
  s.gravity = 9.81, s.friction = 10, s.poisson = 0.25;
  const double r = 0.01, push = 1e-5;
  scree_particle *sphere = law_sphere(r);
  scree_world *world = hertz_world(&s);
  law_floor(world);
  size_t a = law_body(world, sphere, moving(0, 0, 0));
  double m = scree_world_body_mass(world, a), h = hertz_of(&s, true, r),
         depth = pow(m * s.gravity / h, 2.0 / 3),
         ease = 2 * (2 - s.poisson) * (1 + s.poisson) / s.young +
                2 * (2 - s.wall_poisson) * (1 + s.wall_poisson) / s.wall_young,
         stiffness = 8 / ease * sqrt(r * depth), period = 2 * pi / sqrt(3.5 * stiffness / m);
  scree_body body = moving(r - depth, push, 0);
  law_place(world, a, &body);
  double dt = scree_world_time_step(world, NULL), first = 0, last = 0, before = push;
  int crossings = 0;
  for (int i = 1; crossings < 21; i++) {
    law_step(world, 1);
    scree_world_get_body(world, a, &body);
    double now = body.velocity[0] - 5.0 / 7 * push, was = before - 5.0 / 7 * push;
    before = body.velocity[0];
    if (was * now >= 0) continue;
    last = (i - now / (now - was)) * dt;
    if (crossings++ == 0) first = last;
  }
  LAW_RELATIVE("H4", "period of a ball's trembling (s)", (last - first) / 10, period, 0.01);
  scree_world_free(world);
  scree_particle_free(sphere);
}

static void ledger_of_spheres(void **state) {
  (void)state;
  hertz_setup s = usual;
  s.restitution = 0.5, s.friction = 0.4, s.steps = 20;
  scree_world *world = hertz_world(&s);
  scree_particle *sphere = law_sphere(0.01);
  for (int i = 0; i < 27; i++) {
    scree_body body = scree_default_body();
    const int p[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    for (int k = 0; k < 3; k++) {
      body.position[k] = 0.024 * p[k] + 0.0005 * ((i * 7 + k * 3) % 5);
      body.velocity[k] = -p[k] + 0.1 * ((i * 5 + k) % 3);
      body.angular_velocity[k] = 10 * ((i * 3 + k) % 4);
    }
    law_body(world, sphere, body);
  }
  scree_observation o;
  law_step(world, 1);
  double first = law_ledger(world, &o), worst = 0;
  size_t contacts = 0;
  for (int i = 0; i < 200; i++) {
    law_step(world, 20);
    worst = fmax(worst, fabs(law_ledger(world, &o) / first - 1));
    contacts += o.pair_count;
  }
  assert_true(contacts > 10);
  LAW_BELOW("L17", "energy ledger of 27 spheres by Hertz", worst, 1e-3);
  scree_world_free(world);
  scree_particle_free(sphere);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(force_and_time_of_a_hit),
      cmocka_unit_test(restitution_at_every_speed),
      cmocka_unit_test(oblique_hits),
      cmocka_unit_test(tangential_stiffness),
      cmocka_unit_test(ledger_of_spheres),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
