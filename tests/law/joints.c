/* Bars, plates and wires of bodies that joints hold, against Euler, Bernoulli, Timoshenko,
 * Saint-Venant and the catenary; strengths; momentum, energy and checkpoints through breaks. */
#include "base/rng.h"
#include "base/vec.h"
#include "support/alloc_fail.h"
#include "support/law.h"
#include "support/shapes.h"
#include "support/threads.h"

static const double pi = 3.14159265358979323846, young = 1e8, poisson = 0.3, density = 2000,
                    side = 0.01;
enum { PIECES = 20 };

static scree_world *empty_world(double gravity) {
  law_setup s = law_default();
  s.gravity = gravity;
  s.density = density;
  return law_world(&s);
}

static scree_particle *brick(double x, double y, double z) {
  scree_mesh mesh = shape_box(x, y, z);
  shape_move(&mesh, (vec3){-x / 2, -y / 2, -z / 2});
  return shape_particle(mesh);
}

/* A particle's axes are those of its inertia: the body is turned so that its mesh lies as drawn. */
static size_t put(scree_world *world, scree_particle *particle, vec3 at) {
  scree_body body = scree_default_body();
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  vec3_store(body.position, at);
  memcpy(body.orientation, m.orientation, sizeof body.orientation);
  return law_body(world, particle, body);
}

static size_t join(scree_world *world, scree_joint *joint, size_t a, size_t b, vec3 at,
                   vec3 normal) {
  scree_error error;
  size_t index;
  joint->a = a;
  joint->b = b;
  vec3_store(joint->centre, at);
  vec3_store(joint->normal, normal);
  CHECK_OK(scree_world_add_joint(world, joint, &index, &error), error);
  return index;
}

/* Cubes in a row along x from 0, held in space at 0 if clamped. */
static scree_world *bar(size_t count, bool clamped, double damping) {
  scree_world *world = empty_world(0);
  scree_particle *cube = brick(side, side, side);
  scree_joint joint = scree_default_joint();
  joint.damping = damping;
  for (size_t i = 0; i < count; i++) {
    size_t body = put(world, cube, (vec3){((double)i + 0.5) * side, 0, 0});
    scree_joint_of_rectangle(SCREE_SECTION_BAR, young, poisson, side, side, i ? side : side / 2,
                             &joint);
    if (i || clamped)
      join(world, &joint, body, i ? body - 1 : SCREE_SPACE, (vec3){(double)i * side, 0, 0},
           (vec3){-1, 0, 0});
  }
  scree_particle_free(cube);
  return world;
}

static void load_tip(scree_world *world, vec3 force, vec3 torque) {
  scree_error error;
  double f[3], t[3];
  vec3_store(f, force);
  vec3_store(t, torque);
  CHECK_OK(scree_world_set_body_force(world, scree_world_body_count(world) - 1, f, t, &error),
           error);
}

/* To rest: all velocities fall as those of the slowest mode, rad/s, would if it were damped
 * critically; for so many of its periods. */
static void settle(scree_world *world, double slowest, double periods) {
  const double dt = scree_world_time_step(world, NULL);
  const size_t every = (size_t)(1 + 0.05 / (slowest * dt));
  const double kept = exp(-2 * slowest * (double)every * dt);
  for (double t = 0; t < periods * 2 * pi / slowest; t += (double)every * dt) {
    law_step(world, every);
    for (size_t i = 0; i < scree_world_body_count(world); i++) {
      scree_body body;
      scree_world_get_body(world, i, &body);
      for (int k = 0; k < 3; k++) body.velocity[k] *= kept, body.angular_velocity[k] *= kept;
      law_place(world, i, &body);
    }
  }
}

static scree_body tip_of(const scree_world *world) {
  scree_body body;
  scree_world_get_body(world, scree_world_body_count(world) - 1, &body);
  return body;
}

static void a_bar_is_pulled(void **state) {
  (void)state;
  const double length = PIECES * side, strain = 1e-4;
  scree_world *world = bar(PIECES, true, 0);
  load_tip(world, (vec3){young * side * side * strain, 0, 0}, (vec3){0, 0, 0});
  settle(world, pi / 2 / length * sqrt(young / density), 4);
  LAW_RELATIVE("J1", "extension of a bar, m", tip_of(world).position[0] - (length - side / 2),
               strain * (length - side / 2), 1e-3);
  scree_world_free(world);
}

static void a_bar_is_bent(void **state) {
  (void)state;
  const double length = PIECES * side, second = pow(side, 4) / 12, shear = young / 2.6,
               force = young * second / (length * length) * 0.01;
  scree_world *world = bar(PIECES, true, 0);
  load_tip(world, (vec3){0, 0, force}, (vec3){0, -force * side / 2, 0}); /* at the end face */
  settle(world, 3.516 / (length * length) * sqrt(young * second / (density * side * side)), 3);
  scree_body tip = tip_of(world);
  double slope = force * length * length / (2 * young * second), /* of the end */
      end = tip.position[2] + slope * side / 2,
         beam = force * pow(length, 3) / (3 * young * second);
  LAW_RELATIVE("J2", "deflection of a cantilever, m", end, beam, 0.01);
  LAW_RELATIVE("J2", "the same, with shear, m", end,
               beam + force * length / (5. / 6 * shear * side * side), 0.003);
  scree_world_free(world);
}

static void a_bar_is_twisted(void **state) {
  (void)state;
  const double length = PIECES * side, g = young / 2.6, torque = 1e-4 * g * pow(side, 3);
  scree_world *world = bar(PIECES, true, 0);
  scree_body before = tip_of(world);
  load_tip(world, (vec3){0, 0, 0}, (vec3){torque, 0, 0});
  settle(world, pi / 2 / length * sqrt(0.84 * g / density), 4);
  scree_body after = tip_of(world);
  quat p = {before.orientation[0], before.orientation[1], before.orientation[2],
            before.orientation[3]},
       q = {after.orientation[0], after.orientation[1], after.orientation[2], after.orientation[3]};
  LAW_RELATIVE("J3", "twist of a square bar, rad", quat_chord(p, q),
               torque * (length - side / 2) / (g * 0.140577 * pow(side, 4)), 0.005);
  scree_world_free(world);
}

static void a_bar_swings(void **state) {
  (void)state;
  const double length = PIECES * side, mass = density * side * side,
               first = 1.8751041 * 1.8751041 / (2 * pi) *
                       sqrt(young * pow(side, 4) / 12 / (mass * pow(length, 4)));
  scree_world *world = bar(PIECES, true, 0);
  for (size_t i = 0; i < PIECES; i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    double x = body.position[0] / length;
    body.velocity[2] = 0.01 * x * x * (1.5 - 0.5 * x);
    law_place(world, i, &body);
  }
  double last = 0, crossings[3], dt = scree_world_time_step(world, NULL);
  for (int n = 0; n < 3;) {
    law_step(world, 1);
    double z = tip_of(world).position[2];
    if (last < 0 && z >= 0) crossings[n++] = scree_world_time(world) - dt * z / (z - last);
    last = z;
  }
  LAW_RELATIVE("J4", "first frequency of a cantilever, Hz", 2 / (crossings[2] - crossings[0]),
               first, 0.01);
  scree_observation o;
  double ledger = law_ledger(world, &o);
  LAW_NEAR("J4", "energy kept, share", ledger / (o.kinetic + o.rotational + o.elastic), 1, 1e-4);
  scree_world_free(world);
}

/* Of n by n tiles, those that meet at a corner alone. */
static void keep_diagonals_apart(scree_world *world, size_t n) {
  scree_joint corner = scree_default_joint();
  scree_error error;
  for (size_t i = 0; i + n < n * n; i++)
    for (size_t to = 0; to < 2; to++) {
      if (i % n == (to ? n - 1 : 0)) continue;
      corner.a = i;
      corner.b = to ? i + n + 1 : i + n - 1;
      CHECK_OK(scree_world_add_joint(world, &corner, NULL, &error), error);
    }
}

/* A clamped plate under its weight, deflected by a hundredth of its thickness, a twentieth of its
 * width: by Mindlin's theory 4.9 % more than a thin one (Timoshenko and Woinowsky-Krieger 1959,
 * art. 44). */
static void a_plate_sags(void **state) {
  (void)state;
  enum { N = 20 };
  const double width = N * side, thickness = side,
               bending = young * pow(thickness, 3) / 12 / (1 - poisson * poisson),
               load = bending * thickness / 100 / (0.001327 * pow(width, 4));
  scree_world *world = empty_world(load / (density * thickness));
  scree_particle *tile = brick(side, side, thickness);
  for (int i = 0; i < N * N; i++)
    put(world, tile, (vec3){(i % N + 0.5) * side, (i / N + 0.5) * side, 0});
  scree_joint joint = scree_default_joint();
  joint.damping = 0;
  for (int i = 0; i < N * N; i++)
    for (int across = 0; across < 2; across++)
      for (int s = -1; s <= 1; s += 2) {
        int x = i % N, y = i / N, place = across ? y : x;
        bool rim = s < 0 ? place == 0 : place == N - 1;
        if (!rim && s < 0) continue;
        vec3 n = across ? (vec3){0, s, 0} : (vec3){s, 0, 0},
             at = vec3_mad((vec3){(x + 0.5) * side, (y + 0.5) * side, 0}, n, side / 2);
        vec3_store(joint.axis, across ? (vec3){1, 0, 0} : (vec3){0, 1, 0});
        scree_joint_of_rectangle(SCREE_SECTION_SHEET, young, poisson, side, thickness,
                                 rim ? side / 2 : side, &joint);
        join(world, &joint, (size_t)i, rim ? SCREE_SPACE : (size_t)(across ? i + N : i + 1), at, n);
      }
  keep_diagonals_apart(world, N);
  settle(world, 35.99 / (width * width) * sqrt(bending / (density * thickness)), 2.5);
  double sag = 0;
  for (int k = 0; k < 4; k++) {
    scree_body body;
    scree_world_get_body(
        world, (size_t)N / 2 - 1 + (size_t)k % 2 + ((size_t)N / 2 - 1 + (size_t)k / 2) * N, &body);
    sag -= body.position[2] / 4;
  }
  LAW_RELATIVE("J5", "sag of a clamped plate, m", sag, thickness / 100, 0.03);
  scree_particle_free(tile);
  scree_world_free(world);
}

/* Between two points of equal height, 0.8 of its length apart; bending a hundredth of the wire's.
 */
static void a_wire_hangs(void **state) {
  (void)state;
  enum { N = 20 };
  const double length = 0.5, span = 0.4, radius = 5e-4, step = length / N;
  double low = 0.01, high = 10;
  for (int i = 0; i < 200; i++) {
    double a = (low + high) / 2;
    *(2 * a * sinh(span / 2 / a) > length ? &low : &high) = a;
  }
  const double a = low, sag = a * (cosh(span / 2 / a) - 1);
  law_setup soft = law_default(); /* nothing touches; contacts would ask for the shortest steps */
  soft.gravity = 9.81;
  soft.density = density;
  soft.stiffness = 1e4;
  scree_world *world = law_world(&soft);
  scree_particle *piece = brick(step, 2 * radius * sqrt(pi / 4), 2 * radius * sqrt(pi / 4));
  scree_particle_measures m;
  scree_particle_measure(piece, &m);
  scree_joint joint = scree_default_joint();
  vec3 from = {-span / 2, 0, 0};
  for (int i = 0; i <= N; i++) {
    double s = -length / 2 + (i + 1) * step, x = a * asinh(s / a);
    vec3 to = {x, 0, a * (cosh(x / a) - cosh(span / 2 / a))}, along = vec3_unit(vec3_sub(to, from));
    size_t body = SCREE_SPACE;
    if (i < N) {
      scree_body b = scree_default_body();
      quat own = {m.orientation[0], m.orientation[1], m.orientation[2], m.orientation[3]},
           turn = quat_mul(quat_from_rotation_vector((vec3){0, -atan2(along.z, along.x), 0}), own);
      vec3_store(b.position, vec3_lerp(from, to, 0.5));
      memcpy(b.orientation, (double[4]){turn.w, turn.x, turn.y, turn.z}, sizeof b.orientation);
      body = law_body(world, piece, b);
    }
    scree_joint_of_wire(young / 5, poisson, radius, step, &joint); /* its weight stretches it by
                                                                       0.05 % */
    for (int k = 0; k < 3; k++) joint.turning[k] *= 0.01;
    joint.axis[0] = 0, joint.axis[1] = 1;
    if (i == 0)
      join(world, &joint, body, SCREE_SPACE, from, (vec3){-1, 0, 0});
    else if (i == N)
      join(world, &joint, (size_t)N - 1, SCREE_SPACE, from, along);
    else
      join(world, &joint, body - 1, body, from, along);
    from = to;
  }
  settle(world, sqrt(9.81 / sag), 2.5);
  double lowest = 0;
  for (size_t i = 0; i < scree_world_joint_count(world); i++) {
    scree_joint_observation o;
    scree_world_observe_joint(world, i, &o);
    lowest = fmin(lowest, o.position[2]);
  }
  LAW_RELATIVE("J6", "sag of a catenary, m", -lowest, sag, 0.01);
  scree_particle_free(piece);
  scree_world_free(world);
}

/* ---- strength ---- */

/* One cube in space, loaded slowly until its joint breaks: the load then. */
static double break_one(vec3 force, vec3 torque, vec3 steady, scree_joint_mode *mode,
                        const scree_joint *strengths) {
  scree_world *world = empty_world(0);
  scree_particle *cube = brick(side, side, side);
  scree_joint joint = *strengths;
  scree_error error;
  size_t body = put(world, cube, (vec3){side / 2, 0, 0});
  scree_joint_of_rectangle(SCREE_SECTION_BAR, young, poisson, side, side, side / 2, &joint);
  size_t index = join(world, &joint, body, SCREE_SPACE, (vec3){0, 0, 0}, (vec3){-1, 0, 0});
  scree_joint_observation o = {.state = SCREE_JOINT_WHOLE};
  double load = 0;
  for (int s = 0; s < 20000 && o.state == SCREE_JOINT_WHOLE; s++) {
    load = 1.2 * s / 20000;
    double f[3], t[3];
    vec3_store(f, vec3_mad(vec3_scale(steady, fmin(1, s / 2000.0)), force, load));
    vec3_store(t, vec3_scale(torque, load));
    CHECK_OK(scree_world_set_body_force(world, body, f, t, &error), error);
    law_step(world, 1);
    scree_world_observe_joint(world, index, &o);
  }
  *mode = o.mode;
  scree_particle_free(cube);
  scree_world_free(world);
  return load;
}

static void joints_break_at_their_strength(void **state) {
  (void)state;
  const double area = side * side, modulus = pow(side, 3) / 6, strength = 1e5,
               twist = 0.140577 * pow(side, 4) / (side / 2);
  scree_joint_mode mode;
  scree_joint j = scree_default_joint();
  j.damping = 0.2;
  const vec3 none = {0, 0, 0};
  j.tension = strength;
  LAW_NEAR("J7", "pulled, share of its strength",
           break_one((vec3){strength * area, 0, 0}, none, none, &mode, &j), 1, 0.01);
  assert_int_equal(mode, SCREE_JOINT_BY_TENSION);
  LAW_NEAR("J7", "bent", break_one(none, (vec3){0, strength * modulus, 0}, none, &mode, &j), 1,
           0.01);
  j.tension = 0;
  j.cohesion = strength;
  j.friction = 0.5;
  double shear = strength * area; /* at the face there is no moment */
  LAW_NEAR("J7", "sheared",
           break_one((vec3){0, 0, shear}, (vec3){0, shear * side / 2, 0}, none, &mode, &j), 1,
           0.01);
  assert_int_equal(mode, SCREE_JOINT_BY_SHEAR);
  LAW_NEAR("J7", "twisted", break_one(none, (vec3){strength * twist, 0, 0}, none, &mode, &j), 1,
           0.01);
  shear *= 1.5;
  LAW_NEAR("J7", "sheared under a pressure of the cohesion",
           break_one((vec3){0, 0, shear}, (vec3){0, shear * side / 2, 0},
                     (vec3){-strength * area, 0, 0}, &mode, &j),
           1, 0.01);
  j.cohesion = 0;
  j.toughness = 0.01;
  double pull = sqrt(2 * young / (side / 2) * j.toughness) * area;
  LAW_NEAR("J7", "pulled to its energy", break_one((vec3){pull, 0, 0}, none, none, &mode, &j), 1,
           0.01);
  assert_int_equal(mode, SCREE_JOINT_BY_ENERGY);
}

/* ---- momentum, energy, checkpoints ---- */

enum { SHEET = 6 };

/* A sheet of cubes that flies and spins so fast that most of its joints break, each at a strength
 * of its own. */
static scree_world *spinning_sheet(double damping) {
  scree_world *world = empty_world(0);
  scree_particle *cube = brick(side, side, side);
  scree_rng rng = {3, 0, 0};
  const vec3 spin = {5, 8, 110}, middle = {2.5 * side, 2.5 * side, 0};
  for (int i = 0; i < SHEET * SHEET; i++) {
    vec3 at = {i % SHEET * side, i / SHEET * side, 0};
    size_t body = put(world, cube, at);
    scree_body b;
    scree_world_get_body(world, body, &b);
    vec3_store(b.velocity, vec3_add((vec3){1, 0, 0}, vec3_cross(spin, vec3_sub(at, middle))));
    vec3_store(b.angular_velocity, spin);
    law_place(world, body, &b);
  }
  for (int i = 0; i < SHEET * SHEET; i++)
    for (int across = 0; across < 2; across++) {
      if ((across ? i / SHEET : i % SHEET) == SHEET - 1) continue;
      scree_joint j = scree_default_joint();
      vec3 at = {i % SHEET * side, i / SHEET * side, 0},
           n = across ? (vec3){0, 1, 0} : (vec3){1, 0, 0};
      vec3_store(j.axis, (vec3){0, 0, 1});
      scree_joint_of_rectangle(SCREE_SECTION_BAR, young, poisson, side, side, side, &j);
      j.damping = damping;
      j.tension = 3e4 * pow(-log(1 - scree_rng_uniform(&rng)), 0.2);
      j.cohesion = 2 * j.tension;
      j.friction = 0.5;
      join(world, &j, (size_t)i, (size_t)(across ? i + SHEET : i + 1), vec3_mad(at, n, side / 2),
           n);
    }
  keep_diagonals_apart(world, SHEET);
  scree_particle_free(cube);
  return world;
}

static void breaks_keep_momentum_and_energy(void **state) {
  (void)state;
  scree_world *world = spinning_sheet(0);
  scree_observation o;
  law_step(world, 1);
  double start = law_ledger(world, &o) + o.fracture, worst = 0;
  vec3 p = vec3_load(o.momentum), l = vec3_load(o.angular_momentum);
  for (int k = 0; k < 200; k++) {
    law_step(world, 50);
    double now = law_ledger(world, &o) + o.fracture;
    worst = fmax(worst, fabs(now - start));
  }
  size_t fragments[SHEET * SHEET];
  print_message("%zu of 60 joints broke, %zu fragments, %zu pairs\n", o.broken_joints,
                scree_world_fragments(world, fragments), o.pair_count);
  assert_true(o.broken_joints > 20);
  LAW_BELOW("J8", "momentum through breaks, share",
            vec3_norm(vec3_sub(vec3_load(o.momentum), p)) / vec3_norm(p), 1e-12);
  LAW_BELOW("J8", "angular momentum, share",
            vec3_norm(vec3_sub(vec3_load(o.angular_momentum), l)) / vec3_norm(l), 1e-9);
  LAW_BELOW("J8", "ledger with fracture, share of the energy", worst / start, 1e-3);
  scree_world_free(world);
}

/* A turn of a free bar: the pull in its middle, and nothing else. */
static void a_spun_bar_stays_straight(void **state) {
  (void)state;
  const double length = PIECES * side, spin = 80;
  scree_world *world = bar(PIECES, false, 0.5);
  for (size_t i = 0; i < PIECES; i++) {
    scree_body b;
    scree_world_get_body(world, i, &b);
    vec3_store(b.velocity, (vec3){0, spin * (b.position[0] - length / 2), 0});
    vec3_store(b.angular_velocity, (vec3){0, 0, spin});
    law_place(world, i, &b);
  }
  scree_observation o;
  law_step(world, 1);
  scree_world_observe(world, &o);
  double before = o.angular_momentum[2];
  law_step(world, (size_t)(2 * pi / spin / scree_world_time_step(world, NULL)));
  scree_world_observe(world, &o);
  scree_joint_observation j;
  scree_world_observe_joint(world, PIECES / 2 - 1, &j);
  LAW_RELATIVE("J9", "pull in the middle of a spinning bar, N", -j.force[0],
               density * side * side * spin * spin * length * length / 8, 0.005);
  LAW_NEAR("J9", "shear there, share of the pull", hypot(j.force[1], j.force[2]) / -j.force[0], 0,
           1e-3);
  LAW_NEAR("J9", "angular momentum, share", o.angular_momentum[2] / before, 1, 1e-11);
  scree_world_free(world);
}

/* Two cubes pressed together, sheared until the joint breaks: the pressing force goes on, and the
 * energy is booked. */
static void a_pressed_joint_breaks_without_a_kick(void **state) {
  (void)state;
  const double area = side * side, pressing = 1e5 * area;
  scree_world *world = empty_world(0);
  scree_particle *cube = brick(side, side, side);
  scree_error error;
  scree_joint j = scree_default_joint();
  j.damping = 0.5;
  j.cohesion = 2e5;
  j.friction = 0.5;
  size_t body = put(world, cube, (vec3){side / 2, 0, 0});
  scree_joint_of_rectangle(SCREE_SECTION_BAR, young, poisson, side, side, side / 2, &j);
  size_t index = join(world, &j, body, SCREE_SPACE, (vec3){0, 0, 0}, (vec3){-1, 0, 0});
  scree_joint_observation o = {.state = SCREE_JOINT_WHOLE};
  double low = INFINITY, high = 0, load = 0;
  int after = 0;
  for (int s = 0; s < 40000 && after < 200; s++) {
    load = o.state == SCREE_JOINT_WHOLE ? 3e5 * area * s / 40000 : 0.3e5 * area;
    double f[3] = {-pressing * fmin(1, s / 4000.0), 0, load}, t[3] = {0, load * side / 2, 0};
    CHECK_OK(scree_world_set_body_force(world, body, f, t, &error), error);
    law_step(world, 1);
    scree_world_observe_joint(world, index, &o);
    if (o.state == SCREE_JOINT_WHOLE) continue;
    low = fmin(low, fabs(o.force[0]));
    high = fmax(high, fabs(o.force[0]));
    after++;
  }
  assert_int_equal(after, 200);
  LAW_NEAR("J10", "least pressing after the break, share", low / pressing, 1, 0.05);
  LAW_NEAR("J10", "most", high / pressing, 1, 0.05);
  scree_observation all;
  double ledger = law_ledger(world, &all) + all.fracture;
  LAW_BELOW("J10", "ledger, share of the fracture", fabs(ledger) / all.fracture, 0.02);
  scree_particle_free(cube);
  scree_world_free(world);
}

/* Spheres that overlap, as those of a cable do: nothing presses them apart where their joint
 * breaks, and they touch again once they come back to where they were then. */
static void joined_spheres_do_not_touch(void **state) {
  (void)state;
  const double r = side / 2, apart = 1.6 * r, speed = 0.1;
  scree_world *world = empty_world(0);
  scree_particle *sphere;
  scree_error error;
  scree_joint j = scree_default_joint();
  scree_observation start, o;
  CHECK_OK(scree_particle_sphere(r, &sphere, &error), error);
  for (int i = 0; i < 3; i++) put(world, sphere, (vec3){i < 2 ? i * apart : 20 * r, 0, 0});
  scree_joint_of_wire(young, poisson, r / 2, apart, &j);
  j.damping = 0;
  j.tension = 1e5;
  size_t index = join(world, &j, 0, 1, (vec3){apart / 2, 0, 0}, (vec3){1, 0, 0});
  for (size_t i = 0; i < 2; i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    body.velocity[0] = i ? speed : -speed;
    law_place(world, i, &body);
  }
  law_step(world, 1);
  scree_world_observe(world, &start);
  scree_joint_observation joint = {.state = SCREE_JOINT_WHOLE};
  for (int n = 0; n < 100000 && joint.state != SCREE_JOINT_OPEN; n++) {
    law_step(world, 1);
    scree_world_observe_joint(world, index, &joint);
  }
  law_step(world, 20);
  scree_world_observe(world, &o);
  assert_int_equal(joint.state, SCREE_JOINT_OPEN);
  LAW_NEAR("J13", "energy of motion and of the break of joined spheres, share",
           (o.kinetic + o.fracture) / (start.kinetic + start.elastic), 1, 1e-3);
  LAW_BELOW("J13", "elastic after it, share", o.elastic / start.kinetic, 1e-6);
  for (size_t i = 0; i < 2; i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    body.velocity[0] *= -1;
    law_place(world, i, &body);
  }
  double nearest = INFINITY;
  for (int n = 0; n < 4000; n++) {
    scree_body a, b;
    law_step(world, 1);
    scree_world_get_body(world, 0, &a);
    scree_world_get_body(world, 1, &b);
    nearest = fmin(nearest, b.position[0] - a.position[0]);
  }
  LAW_NEAR("J13", "how near they come again, share of the distance", nearest / apart, 1, 0.05);
  scree_particle_free(sphere);
  scree_world_free(world);
}

static void threads_and_checkpoints_change_no_bit(void **state) {
  (void)state;
  scree_error error;
  scree_world *one = spinning_sheet(0.05), *two = spinning_sheet(0.05), *loaded;
  use_threads(1);
  law_step(one, 2000);
  use_threads(2);
  law_step(two, 1000);
  CHECK_OK(scree_world_save(two, "joints.tmp", true, &error), error);
  CHECK_OK(scree_world_load("joints.tmp", &loaded, &error), error);
  remove("joints.tmp");
  law_step(two, 1000);
  law_step(loaded, 1000);
  scree_share_all_steps = false;
  scree_set_threads(0);
  scree_checksum a = scree_world_hash(one), b = scree_world_hash(two), c = scree_world_hash(loaded);
  assert_memory_equal(&a, &b, sizeof a);
  assert_memory_equal(&a, &c, sizeof a);
  scree_observation o, p;
  scree_world_observe(one, &o);
  scree_world_observe(loaded, &p);
  assert_true(o.broken_joints > 5 && o.broken_joints == p.broken_joints &&
              o.fracture == p.fracture && o.dissipated_dashpot == p.dissipated_dashpot);
  scree_world_free(one);
  scree_world_free(two);
  scree_world_free(loaded);
}

/* ---- wrong calls ---- */

static void refuse(scree_world *world, const scree_joint *joint, const char *words) {
  scree_error error;
  assert_int_equal(scree_world_add_joint(world, joint, NULL, &error), SCREE_BAD_ARGUMENT);
  if (!strstr(error.message, words)) fail_msg("'%s' lacks '%s'", error.message, words);
}

static void wrong_joints_are_refused(void **state) {
  (void)state;
  scree_world *world = bar(2, false, 0);
  scree_joint good = scree_default_joint(), j;
  good.b = 1;
  scree_joint_of_rectangle(SCREE_SECTION_BAR, young, poisson, side, side, side, &good);
  j = good, j.a = 2;
  refuse(world, &j, "bodies 2 and 1 of 2");
  j = good, j.b = 0;
  refuse(world, &j, "bodies 0 and 0 of 2");
  j = good, j.tension = -1;
  refuse(world, &j, "number -1");
  j = good, j.stiffness[0] = 0;
  refuse(world, &j, "no stiffness");
  j = good, j.damping = 2;
  refuse(world, &j, "damping of 2");
  j = good, memcpy(j.axis, j.normal, sizeof j.axis);
  refuse(world, &j, "axis lies along its normal");
  scree_world_free(world);
}

static scree_status add_and_step(void *context, scree_error *error) {
  scree_world *world = NULL;
  scree_particle *cube = context;
  scree_material m = scree_default_material();
  scree_joint j = scree_default_joint();
  scree_body at = scree_default_body();
  scree_joint_of_rectangle(SCREE_SECTION_BAR, young, poisson, side, side, side, &j);
  j.b = 1;
  j.centre[0] = side / 2;
  scree_status status = scree_world_create(NULL, &world, error);
  if (!status) status = scree_world_add_material(world, &m, NULL, error);
  for (int i = 0; i < 2 && !status; i++) {
    at.position[0] = i * side;
    status = scree_world_add_body(world, cube, 0, &at, NULL, error);
  }
  if (!status) status = scree_world_add_joint(world, &j, NULL, error);
  if (!status) status = scree_world_step(world, 2, error);
  scree_world_free(world);
  return status;
}

static void no_memory_is_told(void **state) {
  (void)state;
  scree_particle *cube = brick(side, side, side);
  check_allocation_failures(add_and_step, cube);
  scree_particle_free(cube);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bar_is_pulled),
      cmocka_unit_test(a_bar_is_bent),
      cmocka_unit_test(a_bar_is_twisted),
      cmocka_unit_test(a_bar_swings),
      cmocka_unit_test(a_plate_sags),
      cmocka_unit_test(a_wire_hangs),
      cmocka_unit_test(joints_break_at_their_strength),
      cmocka_unit_test(breaks_keep_momentum_and_energy),
      cmocka_unit_test(a_spun_bar_stays_straight),
      cmocka_unit_test(a_pressed_joint_breaks_without_a_kick),
      cmocka_unit_test(joined_spheres_do_not_touch),
      cmocka_unit_test(threads_and_checkpoints_change_no_bit),
      cmocka_unit_test(wrong_joints_are_refused),
      cmocka_unit_test(no_memory_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
