/* Pairs of spheres against the pairs of features: a clump of one sphere takes the general path, and
 * clumps are held against all pairs of their spheres.
 * Both are hit at random, on each other, planes, discs, cylinders and belts, by all laws; and both
 * fall asleep, wake, roll and stick alike. */
#include "support/law.h"

#include "base/rng.h"
#include "base/vec.h"

static const double radius = 0.01;

typedef struct place_and_motion {
  double position[3], velocity[3], spin[3];
} place_and_motion;

static double between(scree_rng *rng, double low, double high) {
  return low + (high - low) * scree_rng_uniform(rng);
}

static scree_body moved(const place_and_motion *m) {
  scree_body body = scree_default_body();
  for (int k = 0; k < 3; k++) {
    body.position[k] = m->position[k];
    body.velocity[k] = m->velocity[k];
    body.angular_velocity[k] = m->spin[k];
  }
  return body;
}

/* A kind of partner: a body, or a wall. */
enum { BODY, PLANE, DISC, DISC_FROM_BELOW, TUBE, TUBE_FROM_OUTSIDE, BELT, TURNTABLE, PARTNERS };

static void add_wall(scree_world *world, int partner) {
  scree_error error;
  scree_wall wall = {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}};
  if (partner == DISC || partner == DISC_FROM_BELOW || partner == TURNTABLE) {
    wall.kind = SCREE_WALL_DISC;
    wall.radius = 1;
  } else if (partner == TUBE || partner == TUBE_FROM_OUTSIDE) {
    wall.kind = SCREE_WALL_CYLINDER;
    wall.axis[0] = 1, wall.axis[2] = 0;
    wall.radius = 0.05;
    wall.position[0] = -1;
    wall.length = 2;
    wall.position[2] = partner == TUBE ? 0.05 : -0.05;
  }
  if (partner == BELT) wall.surface_velocity[0] = 0.3;
  if (partner == TURNTABLE) wall.angular_velocity[2] = 5;
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
}

/* What becomes of them after some contact times. */
static void run(const scree_world_options *options, const scree_material *material, int partner,
                const place_and_motion two[2], bool clump, size_t steps, place_and_motion after[2],
                scree_observation *o) {
  static const double origin[3] = {0, 0, 0};
  scree_error error;
  scree_world *world;
  scree_particle *sphere, *particle;
  CHECK_OK(scree_world_create(options, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, material, NULL, &error), error);
  CHECK_OK(scree_particle_sphere(radius, &sphere, &error), error);
  CHECK_OK(scree_particle_clump(origin, &radius, 1, sphere, &particle, &error), error);
  size_t count = partner == BODY ? 2 : 1;
  if (partner != BODY) add_wall(world, partner);
  for (size_t i = 0; i < count; i++) {
    scree_body body = moved(&two[i]);
    CHECK_OK(scree_world_add_body(world, clump ? particle : sphere, 0, &body, NULL, &error), error);
  }
  CHECK_OK(scree_world_step(world, steps, &error), error);
  for (size_t i = 0; i < count; i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    for (int k = 0; k < 3; k++) {
      after[i].position[k] = body.position[k];
      after[i].velocity[k] = body.velocity[k];
      after[i].spin[k] = body.angular_velocity[k];
    }
  }
  scree_world_observe(world, o);
  scree_world_free(world);
  scree_particle_free(particle);
  scree_particle_free(sphere);
}

/* One above the other, or above the wall, or below it, about to meet. */
static void start(scree_rng *rng, int partner, place_and_motion two[2]) {
  const bool below = partner == DISC_FROM_BELOW;
  for (int i = 0; i < 2; i++) {
    const double side = (i == 0) == below ? -1 : 1;
    for (int k = 0; k < 3; k++) {
      two[i].position[k] = k == 2 ? side * radius * between(rng, 1.0005, 1.01) : 0;
      two[i].velocity[k] = k == 2 ? -side * between(rng, 0.2, 1.5) : between(rng, -1, 1);
      two[i].spin[k] = between(rng, -60, 60);
    }
    if (partner == BODY) two[i].position[0] = side * radius * between(rng, 0, 0.3);
  }
}

static double compare(const place_and_motion *a, const place_and_motion *b) {
  double worst = 0;
  for (int k = 0; k < 3; k++) {
    worst = fmax(worst, fabs(a->velocity[k] - b->velocity[k]));
    worst = fmax(worst, radius * fabs(a->spin[k] - b->spin[k]));
  }
  return worst;
}

static void as_features(void **state) {
  (void)state;
  static const scree_law laws[] = {SCREE_LAW_LINEAR, SCREE_LAW_HYSTERETIC, SCREE_LAW_HERTZ};
  scree_rng rng = {17, 0, 0};
  size_t contacts = 0;
  double worst = 0, ledger = 0;
  for (int law = 0; law < 3; law++)
    for (int partner = 0; partner < PARTNERS; partner++)
      for (int try = 0; try < 20; try++) {
        scree_world_options options = scree_default_world_options();
        scree_material material = scree_default_material();
        place_and_motion two[2], after[2][2];
        scree_observation o[2];
        options.law = laws[law];
        options.steps_per_contact = 100;
        material.restitution = between(&rng, 0.2, 1);
        material.friction = between(&rng, 0, 0.8);
        material.surface_energy = try % 4 == 0 ? 0.5 : 0;
        start(&rng, partner, two);
        const size_t steps = (size_t)between(&rng, 20, 1500);
        for (int i = 0; i < 2; i++)
          run(&options, &material, partner, two, i, steps, after[i], &o[i]);
        for (int i = 0; i < (partner == BODY ? 2 : 1); i++)
          worst = fmax(worst, compare(&after[0][i], &after[1][i]));
        assert_int_equal(o[0].pair_count, o[1].pair_count);
        contacts += o[0].pair_count;
        ledger = fmax(ledger, fabs(o[0].dissipated_friction - o[1].dissipated_friction));
      }
  assert_true(contacts > 50);
  LAW_BELOW("spheres", "velocity, sphere against a clump of one, m/s", worst, 1e-5);
  LAW_BELOW("spheres", "dissipated by friction, likewise, J", ledger, 1e-7);
}

static double energy_of(const scree_observation *o) {
  return o->kinetic + o->rotational + o->potential + o->elastic + o->dissipated_dashpot +
         o->dissipated_friction;
}

/* A ball falls onto a bed of spheres, which are pressed on from many sides for many contact times:
 * what the ledger misses, of the energy that came in. */
static double bed_ledger(scree_law law) {
  enum { ALONG = 6, LAYERS = 4 };
  scree_error error;
  scree_world *world;
  scree_particle *grain, *ball;
  scree_rng rng = {18, 0, 0};
  scree_world_options options = scree_default_world_options();
  scree_material material = scree_default_material();
  scree_observation before, after;
  options.law = law;
  material.restitution = 0.5;
  material.friction = 0.3;
  CHECK_OK(scree_world_create(&options, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  CHECK_OK(scree_particle_sphere(radius, &grain, &error), error);
  CHECK_OK(scree_particle_sphere(5 * radius, &ball, &error), error);
  add_wall(world, PLANE);
  scree_body body = scree_default_body();
  for (int i = 0; i < ALONG * ALONG * LAYERS; i++) {
    body.position[0] = radius * (2.05 * (i % ALONG) + between(&rng, 0, 0.02));
    body.position[1] = radius * (2.05 * (i / ALONG % ALONG) + between(&rng, 0, 0.02));
    body.position[2] = radius * (1 + 2.05 * (i / (ALONG * ALONG)));
    CHECK_OK(scree_world_add_body(world, grain, 0, &body, NULL, &error), error);
  }
  for (int k = 0; k < 2; k++) body.position[k] = radius * 2.05 * 0.5 * (ALONG - 1);
  body.position[2] += 6.1 * radius;
  body.velocity[2] = -3;
  CHECK_OK(scree_world_add_body(world, ball, 0, &body, NULL, &error), error);
  scree_world_observe(world, &before);
  size_t steps = (size_t)(0.01 / scree_world_time_step(world, NULL));
  CHECK_OK(scree_world_step(world, steps, &error), error);
  scree_world_observe(world, &after);
  assert_true(after.pair_count > 10);
  scree_world_free(world);
  scree_particle_free(ball);
  scree_particle_free(grain);
  return fabs(energy_of(&after) - energy_of(&before)) / before.kinetic;
}

static void pressed_bed(void **state) {
  (void)state;
  LAW_BELOW("spheres", "ledger of a bed under a ball, linear", bed_ledger(SCREE_LAW_LINEAR), 1e-4);
  LAW_BELOW("spheres", "ledger of a bed under a ball, Hertz", bed_ledger(SCREE_LAW_HERTZ), 1e-4);
}

/* ---- clumps ---- */

enum { MOST_SPHERES = 24 };

/* Spheres of random sizes in a ball. */
static scree_particle *random_clump(scree_rng *rng) {
  scree_error error;
  scree_particle *clump;
  double centres[3 * MOST_SPHERES], radii[MOST_SPHERES];
  size_t count = 1 + (size_t)between(rng, 0, MOST_SPHERES - 1);
  for (size_t i = 0; i < count; i++) {
    for (int k = 0; k < 3; k++) centres[3 * i + k] = radius * between(rng, -0.5, 0.5);
    radii[i] = radius * between(rng, 0.15, 0.5);
  }
  CHECK_OK(scree_particle_clump(centres, radii, count, NULL, &clump, &error), error);
  return clump;
}

static vec3 sphere_of(const scree_particle *clump, const scree_body *body, size_t i, double *r) {
  double centre[3];
  const double *q = body->orientation;
  scree_particle_point(clump, i, centre, r);
  mat3 turned = quat_to_mat3((quat){q[0], q[1], q[2], q[3]});
  return vec3_add(vec3_load(body->position), mat3_mul_vec(&turned, vec3_load(centre)));
}

/* The largest overlap of all pairs of spheres; below 0 where the clumps are apart. */
static double deepest(const scree_world *world, scree_particle *const clumps[2]) {
  scree_particle_measures m[2];
  scree_body bodies[2];
  double most = -INFINITY, r, s;
  for (size_t i = 0; i < 2; i++) {
    scree_world_get_body(world, i, &bodies[i]);
    scree_particle_measure(clumps[i], &m[i]);
  }
  for (size_t i = 0; i < m[0].point_count; i++)
    for (size_t j = 0; j < m[1].point_count; j++) {
      vec3 p = sphere_of(clumps[0], &bodies[0], i, &r), q = sphere_of(clumps[1], &bodies[1], j, &s);
      most = fmax(most, r + s - vec3_distance(p, q));
    }
  return most;
}

/* Two clumps that spin hit each other; steps in which they touch. In every step their overlap is
 * that of the deepest pair of spheres, or a smooth maximum of several. */
static size_t hit_of_clumps(scree_rng *rng) {
  scree_error error;
  scree_world *world;
  scree_world_options options = scree_default_world_options();
  scree_material material = scree_default_material();
  scree_particle *clumps[2];
  scree_observation o;
  double size = INFINITY;
  size_t touched = 0;
  options.gravity[2] = 0;
  CHECK_OK(scree_world_create(&options, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  for (int i = 0; i < 2; i++) {
    scree_particle_measures m;
    scree_body body = scree_default_body();
    clumps[i] = random_clump(rng);
    scree_particle_measure(clumps[i], &m);
    size = fmin(size, m.size);
    body.position[2] = (i ? -1 : 1) * m.bounding_radius;
    body.velocity[2] = (i ? 1 : -1) * between(rng, 0.2, 1);
    for (int k = 0; k < 3; k++) body.angular_velocity[k] = between(rng, -60, 60);
    CHECK_OK(scree_world_add_body(world, clumps[i], 0, &body, NULL, &error), error);
  }
  for (double end = 2 * radius; scree_world_time(world) < end;) { /* at 1 m/s */
    double most = deepest(world, clumps);
    CHECK_OK(scree_world_step(world, 1, &error), error);
    scree_world_observe(world, &o);
    if (most > 0) {
      double flat = (most + options.smoothing * size) / (1 - options.sharing);
      assert_true(o.largest_overlap >= most * (1 - 1e-9) && o.largest_overlap <= flat);
      touched++;
    } else if (most < -options.smoothing * size) {
      assert_int_equal(o.pair_count, 0);
    }
  }
  scree_world_free(world);
  for (int i = 0; i < 2; i++) scree_particle_free(clumps[i]);
  return touched;
}

static void clumps_as_all_their_spheres(void **state) {
  (void)state;
  scree_rng rng = {19, 0, 0};
  size_t touched = 0;
  for (int try = 0; try < 40; try++) touched += hit_of_clumps(&rng) > 0;
  assert_true(touched > 20);
}

/* A ring of spheres holds a ball: no depth is known of spheres, and nothing has to part. */
static void a_grip_is_no_depth(void **state) {
  (void)state;
  for (size_t count = 2; count <= 6; count++) {
    scree_error error;
    scree_world *world;
    scree_world_options options = scree_default_world_options();
    scree_material material = scree_default_material();
    scree_particle *ring, *ball;
    scree_body body = scree_default_body();
    scree_observation o;
    double centres[18], radii[6];
    for (size_t i = 0; i < count; i++) {
      double angle = 6.28318530717958647693 * (double)i / (double)count;
      centres[3 * i] = 1.995 * radius * cos(angle);
      centres[3 * i + 1] = 1.995 * radius * sin(angle);
      centres[3 * i + 2] = 0;
      radii[i] = radius;
    }
    options.gravity[2] = 0;
    CHECK_OK(scree_world_create(&options, &world, &error), error);
    CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
    CHECK_OK(scree_particle_sphere(radius, &ball, &error), error);
    CHECK_OK(scree_particle_clump(centres, radii, count, ball, &ring, &error), error);
    CHECK_OK(scree_world_add_body(world, ring, 0, &body, NULL, &error), error);
    CHECK_OK(scree_world_add_body(world, ball, 0, &body, NULL, &error), error);
    CHECK_OK(scree_world_step(world, 500, &error), error);
    scree_world_observe(world, &o);
    assert_int_equal(o.contact_count, count);
    assert_int_equal(o.depenetration_count, 0);
    scree_world_free(world);
    scree_particle_free(ball);
    scree_particle_free(ring);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(as_features), cmocka_unit_test(pressed_bed),
                                     cmocka_unit_test(clumps_as_all_their_spheres),
                                     cmocka_unit_test(a_grip_is_no_depth)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
