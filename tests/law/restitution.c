/* L2: restitution at the contact point, whatever lever it has to the bodies' centres. L17: elastic
 * bodies of triangles keep their energy over many hits. */
#include "support/law.h"

#include "base/rng.h"
#include "base/vec.h"
#include "support/shapes.h"

/* Two bodies meet at `at` along z at 1 m/s, or one a plane. arms: from their centres. */
typedef struct meeting {
  scree_particle *upper, *lower; /* NULL: the plane z = 0 */
  quat upper_turn, lower_turn;
  vec3 upper_arm, lower_arm; /* in the bodies' frames, to the surface */
} meeting;

static vec3 turned(quat q, vec3 v) {
  mat3 rotation = quat_to_mat3(q);
  return mat3_mul_vec(&rotation, v);
}

static scree_body body_at(vec3 contact, vec3 arm, quat turn, double speed) {
  scree_body body = scree_default_body();
  vec3_store(body.position, vec3_sub(contact, turned(turn, arm)));
  body.velocity[2] = speed;
  body.orientation[0] = turn.w, body.orientation[1] = turn.x;
  body.orientation[2] = turn.y, body.orientation[3] = turn.z;
  return body;
}

/* Along z, of the body's point at the arm. */
static double speed_at(const scree_world *world, size_t index, vec3 arm) {
  scree_body b;
  scree_world_get_body(world, index, &b);
  quat turn = {b.orientation[0], b.orientation[1], b.orientation[2], b.orientation[3]};
  vec3 moving = vec3_cross(vec3_load(b.angular_velocity), turned(turn, arm));
  return b.velocity[2] + moving.z;
}

/* The relative speed of the two points after the hit over that before. */
static double restitution_of(const meeting *m, double e, double steps) {
  law_setup setup = law_default();
  setup.restitution = e, setup.friction = 0, setup.steps_per_contact = steps;
  scree_world *world = law_world(&setup);
  const vec3 above = {0, 0, 2e-5}, origin = {0, 0, 0};
  size_t other = SIZE_MAX, index;
  if (m->lower)
    other = law_body(world, m->lower, body_at(origin, m->lower_arm, m->lower_turn, 0));
  else
    law_floor(world);
  index = law_body(world, m->upper, body_at(above, m->upper_arm, m->upper_turn, -1));
  scree_observation o;
  bool touched = false;
  for (int i = 0; i < 20000 && !(touched && o.pair_count == 0); i++) {
    law_step(world, 1);
    scree_world_observe(world, &o);
    touched |= o.pair_count > 0;
  }
  if (!touched) fail_msg("no hit");
  double got = speed_at(world, index, m->upper_arm);
  if (m->lower) got -= speed_at(world, other, m->lower_arm);
  scree_world_free(world);
  return got;
}

static double rounding_of(const scree_particle *particle) {
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  return m.rounding;
}

/* A corner of a box turned at random falls on a plane, no other nearly as low. */
static meeting corner_on_plane(scree_particle *box, vec3 half, scree_rng *rng) {
  for (;;) {
    meeting m = {.upper = box, .upper_turn = scree_rng_rotation(rng)};
    double lowest = INFINITY, next = INFINITY;
    for (int i = 0; i < 8; i++) {
      vec3 corner = {i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
      double height = turned(m.upper_turn, corner).z;
      next = fmin(next, fmax(height, lowest));
      if (height < lowest) lowest = height, m.upper_arm = corner;
    }
    mat3 rotation = quat_to_mat3(m.upper_turn);
    vec3 down = mat3_tmul_vec(&rotation, (vec3){0, 0, -rounding_of(box)});
    m.upper_arm = vec3_add(m.upper_arm, down);
    if (next - lowest > 0.2 * half.z) return m;
  }
}

/* An edge along x, tilted about it. */
static meeting edge_on_plane(scree_particle *box, vec3 half, scree_rng *rng) {
  double angle = 0.3 + 0.9 * scree_rng_uniform(rng);
  meeting m = {.upper = box, .upper_turn = quat_from_rotation_vector((vec3){angle, 0, 0})};
  mat3 rotation = quat_to_mat3(m.upper_turn);
  vec3 edge = {0, -half.y, -half.z},
       down = mat3_tmul_vec(&rotation, (vec3){0, 0, -rounding_of(box)});
  m.upper_arm = vec3_add(edge, down);
  return m;
}

/* A ball, or a box's corner, on the wide face of a box, from its middle to its rim. */
static meeting on_face(scree_particle *upper, vec3 arm, quat turn, scree_particle *box, vec3 half,
                       scree_rng *rng) {
  double x = 0.95 * half.x * (2 * scree_rng_uniform(rng) - 1),
         y = 0.95 * half.y * (2 * scree_rng_uniform(rng) - 1);
  return (meeting){.upper = upper,
                   .lower = box,
                   .upper_turn = turn,
                   .upper_arm = arm,
                   .lower_turn = {1, 0, 0, 0},
                   .lower_arm = {x, y, half.z + rounding_of(box)}};
}

/* Edges of two bars across each other, each met somewhere along its length. */
static meeting crossed_edges(scree_particle *bar, vec3 half, scree_rng *rng) {
  const double eighth = 0.25 * 3.14159265358979323846;
  quat up = quat_from_rotation_vector((vec3){eighth, 0, 0}),
       across = quat_from_rotation_vector((vec3){0, 0, 2 * eighth});
  double x = 0.9 * half.x * (2 * scree_rng_uniform(rng) - 1),
         y = 0.9 * half.x * (2 * scree_rng_uniform(rng) - 1), r = rounding_of(bar) / sqrt(2);
  return (meeting){.upper = bar,
                   .lower = bar,
                   .upper_turn = quat_mul(across, up),
                   .lower_turn = up,
                   .upper_arm = {x, -half.y - r, -half.z - r},
                   .lower_arm = {y, half.y + r, half.z + r}};
}

static void corners_edges_and_faces_rebound_by_e(void **state) {
  (void)state;
  enum { KINDS = 5, TRIES = 12 };
  static const char *const names[KINDS] = {"corner", "edge", "ball on face", "corner on face",
                                           "crossed edges"};
  const vec3 half = {0.03, 0.02, 0.012}, bar_half = {0.05, 0.01, 0.01};
  scree_particle *box = shape_particle(shape_box(2 * half.x, 2 * half.y, 2 * half.z)),
                 *bar = shape_particle(shape_box(2 * bar_half.x, 2 * bar_half.y, 2 * bar_half.z)),
                 *ball = law_sphere(0.012);
  scree_rng rng = {.seed = 7};
  for (int kind = 0; kind < KINDS; kind++)
    for (int i = 0; i < TRIES; i++) {
      double e = 0.1 + 0.2 * (i % 5);
      meeting m;
      if (kind == 0) m = corner_on_plane(box, half, &rng);
      if (kind == 1) m = edge_on_plane(box, half, &rng);
      if (kind == 2) m = on_face(ball, (vec3){0, 0, -0.012}, (quat){1, 0, 0, 0}, box, half, &rng);
      if (kind == 3) {
        m = corner_on_plane(box, half, &rng);
        m = on_face(box, m.upper_arm, m.upper_turn, box, half, &rng);
      }
      if (kind == 4) m = crossed_edges(bar, bar_half, &rng);
      char what[80];
      snprintf(what, sizeof what, "e of the contact point: %s, %.1f", names[kind], e);
      LAW_NEAR("L2", what, restitution_of(&m, e, 20), e, 0.02);
    }
  scree_particle_free(box);
  scree_particle_free(bar);
  scree_particle_free(ball);
}

/* 27 smooth elastic boxes in a periodic room, 10,000 hits or so. What is not told from a hit's
 * energy is at most as many as those. */
static double change_of_gas(uint64_t seed) {
  enum { SIDE = 3 };
  const double room = 0.062;
  scree_error error;
  scree_world_options o = scree_default_world_options();
  o.gravity[2] = 0, o.stiffness_factor = 0.3;
  for (int k = 0; k < 3; k++) o.period[k] = room;
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  scree_material material = scree_default_material();
  material.restitution = 1, material.friction = 0;
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  scree_particle *box = shape_particle(shape_box(0.014, 0.010, 0.007));
  scree_rng rng = {.seed = seed};
  for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
    scree_body body = scree_default_body();
    const int at[3] = {i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)};
    for (int k = 0; k < 3; k++) {
      body.position[k] = (at[k] + 0.5) / SIDE * room;
      body.velocity[k] = scree_rng_normal(&rng);
    }
    law_body(world, box, body);
  }
  scree_observation seen;
  law_step(world, 1);
  double start = law_ledger(world, &seen);
  while (scree_world_time(world) < 3) law_step(world, 100);
  double change = law_ledger(world, &seen) / start - 1;
  scree_world_free(world);
  scree_particle_free(box);
  return change;
}

static void elastic_boxes_keep_their_energy(void **state) {
  (void)state;
  enum { ROOMS = 3 };
  double changes[ROOMS];
  for (int i = 0; i < ROOMS; i++) {
    double change = fabs(change_of_gas((uint64_t)i + 1));
    int k = i;
    for (; k > 0 && changes[k - 1] > change; k--) changes[k] = changes[k - 1];
    changes[k] = change;
  }
  LAW_BELOW("L17", "27 elastic boxes, 10,000 hits: ledger, median of rooms", changes[ROOMS / 2],
            1e-3);
}

/* Boxes turned at random fall on a plane at 1 m/s by the hysteretic law: the ledger's error, rms.
 */
static double hysteretic_error(double e) {
  enum { TRIES = 40 };
  const vec3 half = {0.03, 0.02, 0.012};
  scree_particle *box = shape_particle(shape_box(2 * half.x, 2 * half.y, 2 * half.z));
  scree_rng rng = {.seed = 3};
  double square = 0;
  for (int i = 0; i < TRIES; i++) {
    quat turn = scree_rng_rotation(&rng);
    mat3 rotation = quat_to_mat3(turn);
    const double *z = rotation.m[2];
    double low = fabs(z[0]) * half.x + fabs(z[1]) * half.y + fabs(z[2]) * half.z;
    scree_error error;
    scree_world_options o = scree_default_world_options();
    o.gravity[2] = 0, o.law = SCREE_LAW_HYSTERETIC;
    scree_world *world = NULL;
    CHECK_OK(scree_world_create(&o, &world, &error), error);
    const scree_material materials[2] = {scree_default_material(), scree_default_wall_material()};
    for (int k = 0; k < 2; k++)
      CHECK_OK(scree_world_add_material(world, &materials[k], NULL, &error), error);
    law_floor(world);
    law_body(world, box, body_at((vec3){0, 0, low + 3e-4}, (vec3){0, 0, 0}, turn, -1));
    law_step(world, 1);
    CHECK_OK(scree_world_set_contact(world, 0, 1, e, 0, &error), error); /* the step follows */
    scree_observation seen;
    double start = law_ledger(world, &seen);
    while (scree_world_time(world) < 3e-3) law_step(world, 10);
    double change = law_ledger(world, &seen) / start - 1;
    square += change * change / TRIES;
    scree_world_free(world);
  }
  scree_particle_free(box);
  return sqrt(square);
}

static void hysteretic_unloading_is_resolved(void **state) {
  (void)state;
  static const double given[] = {0.1, 0.2, 0.3, 0.5, 0.9};
  for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
    char what[60];
    snprintf(what, sizeof what, "ledger of hysteretic boxes, e = %.1f", given[i]);
    LAW_BELOW("L17", what, hysteretic_error(given[i]), 2e-3);
  }
}

/* Where an elastic box is 2 ms after a corner met a plane at 1 m/s. */
static vec3 after_hit(const meeting *m, double steps, double *energy) {
  law_setup setup = law_default();
  setup.restitution = 1, setup.friction = 0, setup.steps_per_contact = steps;
  scree_world *world = law_world(&setup);
  law_floor(world);
  size_t index =
      law_body(world, m->upper, body_at((vec3){0, 0, 2e-5}, m->upper_arm, m->upper_turn, -1));
  scree_observation o;
  double first = law_ledger(world, &o), time = 2e-3;
  size_t count = (size_t)(time / scree_world_time_step(world, NULL));
  law_step(world, count);
  *energy = law_ledger(world, &o) / first - 1;
  scree_body b;
  scree_world_get_body(world, index, &b);
  vec3 rest = vec3_scale(vec3_load(b.velocity), time - scree_world_time(world));
  vec3 place = vec3_add(vec3_load(b.position), rest);
  scree_world_free(world);
  return place;
}

/* Half the step, a quarter of the error. */
static void hits_converge_with_the_step(void **state) {
  (void)state;
  enum { TRIES = 40, STEPS = 3 };
  const vec3 half = {0.03, 0.02, 0.012};
  scree_particle *box = shape_particle(shape_box(2 * half.x, 2 * half.y, 2 * half.z));
  scree_rng rng = {.seed = 5};
  double places[STEPS] = {0}, energies[STEPS] = {0};
  for (int i = 0; i < TRIES; i++) {
    meeting m = corner_on_plane(box, half, &rng);
    double energy;
    vec3 fine = after_hit(&m, 640, &energy);
    for (int k = 0; k < STEPS; k++) {
      vec3 place = after_hit(&m, 20 << k, &energy);
      places[k] += vec3_norm2(vec3_sub(place, fine)) / TRIES;
      energies[k] += energy * energy / TRIES;
    }
  }
  for (int k = 0; k < STEPS; k++)
    print_message("N %d: place off by %.3g m, energy by %.3g (rms)\n", 20 << k, sqrt(places[k]),
                  sqrt(energies[k]));
  LAW_BELOW("L17", "place: error at N 80 over that at 20", sqrt(places[2] / places[0]), 0.0884);
  LAW_BELOW("L17", "energy: the same", sqrt(energies[2] / energies[0]), 0.0884);
  scree_particle_free(box);
}

/* The speed along z of a sphere, or of a box of which a corner hits off its centre, after a hit on
 * a plane at 1 m/s that begins at this part of a step. */
static double rebound(const meeting *m, scree_law law, double e, double steps, double phase) {
  scree_error error;
  scree_world_options options = scree_default_world_options();
  options.gravity[2] = 0;
  options.law = law;
  options.steps_per_contact = steps;
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&options, &world, &error), error);
  scree_material material = {.young = 1e8, .density = 2000, .restitution = e, .friction = 0};
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  material.young = 1e11;
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  law_floor(world);
  const vec3 far = {0, 0, 1};
  const size_t index = law_body(world, m->upper, body_at(far, m->upper_arm, m->upper_turn, -1));
  const double step = scree_world_time_step(world, NULL);
  const vec3 above = {0, 0, (3 + phase) * step};
  scree_body body = body_at(above, m->upper_arm, m->upper_turn, -1);
  law_place(world, index, &body);
  scree_observation o;
  for (bool touched = false; !touched || o.contact_count > 0;) {
    law_step(world, 1);
    scree_world_observe(world, &o);
    touched |= o.contact_count > 0;
  }
  scree_world_get_body(world, index, &body);
  scree_world_free(world);
  return body.velocity[2];
}

enum { PHASES = 12, ORDER_STEPS = 3 };

/* The rms of the error over phases, at N = 20, 40 and 80; by how much the step's halves lower it.
 */
static double order_of(const meeting *m, scree_law law, double e, double expected,
                       double errors[ORDER_STEPS]) {
  for (int k = 0; k < ORDER_STEPS; k++) {
    errors[k] = 0;
    for (int i = 0; i < PHASES; i++) {
      const double off = rebound(m, law, e, 20 << k, (i + 0.5) / PHASES) - expected;
      errors[k] += off * off / PHASES;
    }
    errors[k] = sqrt(errors[k]);
  }
  return 0.5 * log2(errors[0] / errors[2]);
}

/* docs/background/physics.md has the table. */
static void rebounds_are_of_second_order(void **state) {
  (void)state;
  static const double given[] = {0.1, 0.5, 0.9};
  static const char *const laws[] = {"linear", "hysteretic", "Hertz"};
  static const double least[] = {1.8, 1.8, 1.7};
  const vec3 half = {0.01, 0.01, 0.01};
  scree_rng rng = {.seed = 8};
  scree_particle *ball = law_sphere(0.01),
                 *cube = shape_particle(shape_box(2 * half.x, 2 * half.y, 2 * half.z));
  for (int corner = 0; corner < 2; corner++) {
    meeting m = {.upper = ball, .upper_turn = {1, 0, 0, 0}, .upper_arm = {0, 0, -0.01}};
    if (corner) m = corner_on_plane(cube, half, &rng);
    for (int law = 0; law < 3 - corner; law++) /* Hertz's is linear for meshes */
      for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
        double errors[ORDER_STEPS],
            expected = corner ? rebound(&m, (scree_law)law, given[i], 640, 0.5) : given[i],
            order = order_of(&m, (scree_law)law, given[i], expected, errors);
        print_message("%s, %s, e = %g: %.2g %.2g %.2g, order %.2f\n", corner ? "corner" : "sphere",
                      laws[law], given[i], errors[0], errors[1], errors[2], order);
        assert_true(order > least[law]);
      }
  }
  scree_particle_free(ball);
  scree_particle_free(cube);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(corners_edges_and_faces_rebound_by_e),
      cmocka_unit_test(elastic_boxes_keep_their_energy),
      cmocka_unit_test(hysteretic_unloading_is_resolved),
      cmocka_unit_test(hits_converge_with_the_step),
      cmocka_unit_test(rebounds_are_of_second_order),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
