/* Thin and open things: stacks of plates stand right, sheets of triangles are met from both sides
 * and end in rims, blades are felt, and what lies in each other from the start is told. */
#include "support/law.h"

#include "base/vec.h"
#include "support/shapes.h"
#include "support/solids.h"
#include "world/state/scratch.h"

static const double degree = 3.14159265358979323846 / 180;

/* The mesh's own z axis upright. */
static scree_body lying(scree_particle *particle) {
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  scree_body body = scree_default_body();
  memcpy(body.orientation, m.orientation, sizeof body.orientation);
  return body;
}

static void stacks_stand_right(void **state) {
  (void)state;
  enum { PLATES = 8 };
  const double thick[] = {1e-3, 3e-4};
  for (size_t k = 0; k < sizeof thick / sizeof *thick; k++) {
    double t = thick[k];
    law_setup setup = law_default();
    setup.gravity = 9.81, setup.steps_per_contact = 20;
    scree_world *world = law_world(&setup);
    law_floor(world);
    scree_particle *plate = shape_particle(shape_box(0.03, 0.03, t));
    scree_particle_measures m;
    scree_particle_measure(plate, &m);
    LAW_BELOW("-", "rounding over thickness", m.rounding / t, 1.0 / 200);
    for (int i = 0; i < PLATES; i++) {
      scree_body body = lying(plate);
      body.position[2] = 0.5 * t + m.rounding + i * (t + 2 * m.rounding) * 1.0005;
      law_body(world, plate, body);
    }
    while (scree_world_time(world) < 0.02) law_step(world, 100);
    scree_body top;
    scree_world_get_body(world, PLATES - 1, &top);
    LAW_RELATIVE("-", "height of eight plates", top.position[2] + 0.5 * t, PLATES * t, 0.01);
    scree_world_free(world);
    scree_particle_free(plate);
  }
}

static scree_mesh sheet(double half) {
  const double corners[] = {-half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0};
  static const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
  scree_mesh mesh = shape_make(4, 2);
  memcpy(mesh.positions, corners, sizeof corners);
  memcpy(mesh.triangles, triangles, sizeof triangles);
  return mesh;
}

/* A plate slides over the rim of two triangles and falls, on either side of them. */
static void an_open_rim_is_passed(void **state) {
  (void)state;
  scree_mesh mesh = sheet(0.05);
  scree_particle *plate = shape_particle(shape_box(0.06, 0.04, 0.0015));
  for (int side = -1; side < 2; side += 2) {
    law_setup setup = law_default();
    setup.gravity = 9.81 * side, setup.steps_per_contact = 20, setup.friction = 0.2;
    scree_world *world = law_world(&setup);
    scree_error error;
    scree_wall wall = {.kind = SCREE_WALL_MESH, .material = 1, .axis = {0, 0, 1}, .mesh = &mesh};
    CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
    scree_body body = lying(plate);
    body.position[2] = side * 0.0008;
    body.velocity[0] = 0.8;
    law_body(world, plate, body);
    scree_observation o;
    law_step(world, 1);
    double before = law_ledger(world, &o), came_in = o.kinetic, worst = 0;
    while (scree_world_time(world) < 0.2) {
      law_step(world, 100);
      worst = fmax(worst, fabs(law_ledger(world, &o) - before) / came_in);
    }
    scree_world_get_body(world, 0, &body);
    assert_true(side * body.position[2] < -0.005); /* it fell */
    LAW_BELOW("L17", "over an open rim: ledger over what came in", worst, 1e-3);
    scree_world_free(world);
  }
  scree_mesh_free(&mesh);
  scree_particle_free(plate);
}

/* A closed wall that is wound inwards is a container: what is thrown about in it stays. */
static void turned_inside_out_holds(void **state) {
  (void)state;
  law_setup setup = law_default();
  setup.restitution = 1, setup.friction = 0;
  scree_world *world = law_world(&setup);
  scree_mesh box = shape_box(0.1, 0.1, 0.1);
  for (size_t t = 0; t < box.triangle_count; t++) shape_flip(&box, t);
  scree_wall wall = {.kind = SCREE_WALL_MESH, .material = 1, .axis = {0, 0, 1}, .mesh = &box};
  scree_error error;
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  scree_particle *cube = shape_particle(shape_box(0.02, 0.02, 0.02));
  scree_body body = lying(cube);
  const double middle[3] = {0.05, 0.05, 0.05}, velocity[3] = {3, 2, 1};
  memcpy(body.position, middle, sizeof middle);
  memcpy(body.velocity, velocity, sizeof velocity);
  law_body(world, cube, body);
  scree_observation o;
  for (int i = 0; i < 40; i++) {
    law_step(world, 200);
    scree_world_get_body(world, 0, &body);
    for (int k = 0; k < 3; k++) CHECK_NEAR(body.position[k], 0.05, 0.041);
  }
  scree_world_observe(world, &o);
  LAW_RELATIVE("L17", "thrown about in a container: energy", o.kinetic + o.rotational + o.elastic,
               0.5 * 2000 * 8e-6 * 14, 0.01);
  scree_mesh_free(&box);
  scree_particle_free(cube);
  scree_world_free(world);
}

static void what_lies_in_each_other_is_told(void **state) {
  (void)state;
  scree_particle *small = shape_particle(shape_box(0.02, 0.02, 0.02)),
                 *large = shape_particle(shape_box(0.2, 0.2, 0.2)),
                 *plate = shape_particle(shape_box(0.06, 0.04, 0.0015)), *ball = law_sphere(0.01);
  const quat across = quat_from_rotation_vector((vec3){0, 90 * degree, 0});
  const struct {
    scree_particle *one, *other;
    double at[3];
    quat turned;
    const char *what;
  } cases[] = {
      {small, small, {0, 0, 0}, {1, 0, 0, 0}, "body 0 (12 triangles, size 0.0248 m) and body 1"},
      {large, small, {0.01, 0, 0}, {1, 0, 0, 0}, "and body 1 (12 triangles, size 0.0248 m)"},
      {small, small, {0.014, 0.003, 0.002}, {1, 0, 0, 0}, "from the start"},
      {plate, plate, {0.001, 0.002, 0.003}, across, "from the start"},
      {large, ball, {0, 0, 0}, {1, 0, 0, 0}, "and body 1 (1 sphere, size 0.02 m)"},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    const law_setup setup = law_default();
    scree_world *world = law_world(&setup);
    scree_body body = scree_default_body();
    law_body(world, cases[k].one, body);
    memcpy(body.position, cases[k].at, sizeof body.position);
    quat q = cases[k].turned;
    const double orientation[4] = {q.w, q.x, q.y, q.z};
    memcpy(body.orientation, orientation, sizeof orientation);
    law_body(world, cases[k].other, body);
    scree_error error;
    assert_int_equal(scree_world_step(world, 1, &error), SCREE_DIVERGED);
    print_message("%s\n", error.message);
    assert_non_null(strstr(error.message, cases[k].what));
    scree_world_free(world);
  }
  scree_particle *all[] = {small, large, plate, ball};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) scree_particle_free(all[i]);
}

/* How much of the energy a hit of blade and cube, edge first at 15 m/s, wins at most, and what it
 * is off by when they have parted. */
static void blade_hit(scree_particle *cube, scree_particle *blade, int i, bool damped, double *won,
                      double *off) {
  law_setup setup = law_default();
  setup.steps_per_contact = 20;
  setup.restitution = damped ? 0.3 : 1;
  setup.friction = damped ? 0.5 : 0;
  scree_world *world = law_world(&setup);
  law_body(world, cube, scree_default_body());
  scree_particle_measures m;
  scree_particle_measure(blade, &m);
  quat own = {m.orientation[0], m.orientation[1], m.orientation[2], m.orientation[3]},
       q = quat_mul(quat_from_rotation_vector((vec3){0, 0.08 * (i - 6), 0.05 * i}), own);
  scree_body body = {.position = {0.075, 0.003 * (i - 6), 0.002 * i},
                     .orientation = {q.w, q.x, q.y, q.z},
                     .velocity = {-15, 0, 0}};
  law_body(world, blade, body);
  scree_observation o;
  law_step(world, 1);
  double before = law_ledger(world, &o), now = before;
  double towards = -15 * scree_world_body_mass(world, 1);
  while (scree_world_time(world) < 0.006) {
    law_step(world, 10);
    now = law_ledger(world, &o);
    *won = fmax(*won, now / before - 1);
  }
  *off = fmax(*off, fabs(now / before - 1));
  scree_world_get_body(world, 1, &body);
  assert_true(fabs(scree_world_body_mass(world, 1) * body.velocity[0] - towards) >
              0.01); /* they met */
  scree_world_free(world);
}

static void blades_win_nothing(void **state) {
  (void)state;
  enum { TRIES = 12 };
  const double angles[] = {5, 31, 90}, length = 0.06;
  scree_particle *cube = shape_particle(shape_box(0.05, 0.05, 0.05));
  for (int k = 0; k < 6; k++) {
    double angle = angles[k / 2], half = length * tan(0.5 * angle * degree), won = 0, off = 0;
    bool damped = k % 2;
    const double profile[] = {0, 0, length, -half, length, half};
    scree_particle *blade = shape_particle(solid_prism(profile, 3, 0.02));
    for (int i = 0; i < TRIES; i++) blade_hit(cube, blade, i, damped, &won, &off);
    char what[64];
    const char *how = damped ? "damped" : "undamped";
    snprintf(what, sizeof what, "blades of %g degrees, %s: energy won", angle, how);
    LAW_BELOW("L7", what, won, damped ? 0.005 : 0.01);
    snprintf(what, sizeof what, "the same, %s: ledger", how);
    LAW_BELOW("L17", what, off, 0.01);
    scree_particle_free(blade);
  }
  scree_particle_free(cube);
}

static uint64_t depth_queries(const scree_world *world) {
  uint64_t sum = 0;
  for (int i = 0; i < world->workspace.scratch_count; i++)
    sum += world->workspace.scratch[i].counters.depth_queries;
  return sum;
}

/* Cubes that hit each other face to edge so fast, and are so soft, that hardened springs do not
 * turn them back before four times a small overlap limit: they part, which is counted and booked.
 * How often depths are looked for in a step of that. */
static double press_too_deep(vec3 turn, vec3 aside) {
  scree_error error;
  scree_world *world = NULL;
  scree_world_options options = scree_default_world_options();
  scree_material soft = scree_default_material();
  options.gravity[2] = 0;
  options.overlap_limit = 0.02;
  options.steps_per_contact = 40;
  soft.young = 1e6;
  soft.restitution = 1;
  CHECK_OK(scree_world_create(&options, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, &soft, NULL, &error), error);
  scree_particle *cube = shape_particle(shape_box(0.05, 0.05, 0.05));
  scree_particle_measures m;
  scree_particle_measure(cube, &m);
  law_body(world, cube, lying(cube));
  const quat q = quat_from_rotation_vector(turn);
  const scree_body thrown = {.position = {0.08, aside.y, aside.z},
                             .orientation = {q.w, q.x, q.y, q.z},
                             .velocity = {-8.8, 0, 0}};
  law_body(world, cube, thrown);
  scree_observation o;
  law_step(world, 1);
  double before = law_ledger(world, &o), worst = 0, deepest = 0;
  size_t depenetrating = 0, looks = 0;
  while (scree_world_time(world) < 0.3) {
    uint64_t looked = depth_queries(world);
    law_step(world, 10);
    worst = fmax(worst, fabs(law_ledger(world, &o) / before - 1));
    deepest = fmax(deepest, o.largest_overlap);
    depenetrating += o.depenetrating_pairs;
    if (o.depenetrating_pairs) looks += depth_queries(world) - looked;
  }
  print_message("deepest %.3g m of %.3g m; %zu looks in %zu steps\n", deepest, m.size, looks,
                10 * depenetrating);
  assert_true(deepest > 4 * options.overlap_limit * m.size);
  assert_true(depenetrating > 0 && o.depenetrating_pairs == 0 && o.depenetration_count >= 1);
  assert_int_equal(o.pair_count, 0);
  LAW_BELOW("L17", "pressed beyond the limit: ledger", worst, 0.01);
  scree_world_free(world);
  scree_particle_free(cube);
  return 0.1 * (double)looks / (double)depenetrating;
}

static void what_is_pressed_too_deep_parts(void **state) {
  (void)state;
  press_too_deep((vec3){0.1, 0.2, 45 * degree}, (vec3){0, 0.005, 0.01});
  double looks = press_too_deep((vec3){0, 0, 45 * degree}, (vec3){0, 0, 0});
  assert_true(looks > 0 && looks < 0.9); /* asked in each it is above 1 */
}

/* What stands out of a large body's surface is a small one's affair. */
static void a_grain_rests_on_a_slab(void **state) {
  (void)state;
  const double half = 2.5e-4;
  law_setup setup = law_default();
  setup.gravity = 9.81;
  setup.stiffness = 1e7;
  setup.steps_per_contact = 20;
  scree_particle *slab = shape_particle(shape_box(0.2, 0.2, 0.05)),
                 *grains[2] = {law_sphere(half),
                               shape_particle(shape_box(2 * half, 2 * half, 2 * half))};
  for (int k = 0; k < 2; k++) {
    scree_world *world = law_world(&setup);
    law_floor(world);
    scree_particle_measures m;
    scree_particle_measure(slab, &m);
    scree_body body = lying(slab);
    body.position[2] = 0.025 + m.rounding;
    size_t lower = law_body(world, slab, body);
    body = scree_default_body();
    body.position[0] = 0.03;
    body.position[2] = 0.05 + 2 * m.rounding + half;
    size_t upper = law_body(world, grains[k], body);
    while (scree_world_time(world) < 0.03) law_step(world, 100);
    scree_world_get_body(world, lower, &body);
    double top = body.position[2] + 0.025;
    scree_world_get_body(world, upper, &body);
    LAW_NEAR("-", k ? "height of a cubic grain over a slab" : "height of a grain over a slab",
             body.position[2] - half - top, 0, 1e-5);
    scree_world_free(world);
    scree_particle_free(grains[k]);
  }
  scree_particle_free(slab);
}

/* A wedge pressed into a steep notch is held from both sides by what it rests on: nothing of it is
 * inside, and it stays where the flanks hold it, with the force and after it. */
static void a_wedge_rests_in_a_notch(void **state) {
  (void)state;
  const double half_angle = 8 * degree, apex = 0.018, low = 0.03, high = 0.055, play = 5e-5,
               a = (low - apex) * tan(half_angle) - play,
               b = (high - apex) * tan(half_angle) - play;
  const double xy[] = {-a, low, a, low, b, high, -b, high};
  scree_error error;
  law_setup setup = law_default();
  setup.stiffness = 1e7;
  scree_world *world = law_world(&setup);
  size_t index;
  scree_mesh notch = solid_notch(0.06, half_angle, 0.05);
  scree_wall wall = {.kind = SCREE_WALL_MESH, .material = 1, .axis = {0, 0, 1}, .mesh = &notch};
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  scree_particle *wedge = shape_particle(solid_prism(xy, 4, 0.03));
  scree_body body = lying(wedge);
  const double middle = low + (high - low) / 3 * (a + 2 * b) / (a + b);
  memcpy(body.position, (double[]){0.03, middle, 0.025}, sizeof body.position);
  index = law_body(world, wedge, body);
  const double force[3] = {0, -5, 0}, none[3] = {0, 0, 0};
  CHECK_OK(scree_world_set_body_force(world, index, force, none, &error), error);
  double jammed = 0, pressed[2];
  for (int released = 0; released < 2; released++) {
    for (int i = 0; i < 200; i++) {
      law_step(world, 20);
      scree_observation o;
      scree_world_observe(world, &o);
      jammed = fmax(jammed, o.largest_overlap);
      assert_int_equal(o.depenetrating_pairs, 0);
      assert_int_equal(o.depenetration_count, 0);
    }
    scree_world_get_body(world, index, &body);
    pressed[released] = body.position[1];
    CHECK_OK(scree_world_set_body_force(world, index, none, none, &error), error);
  }
  scree_particle_measures m;
  scree_particle_measure(wedge, &m);
  print_message("pressed %.3g of roundings, %.3g m in, %.3g m back\n", jammed / m.rounding,
                middle - pressed[0], pressed[1] - pressed[0]);
  LAW_BELOW("L17", "a wedge in a notch goes in, m", middle - pressed[0], 0.002);
  LAW_BELOW("L17", "moves when let go, m", fabs(pressed[1] - pressed[0]), 2e-4);
  scree_world_free(world);
  scree_mesh_free(&notch);
  scree_particle_free(wedge);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stacks_stand_right),       cmocka_unit_test(an_open_rim_is_passed),
      cmocka_unit_test(turned_inside_out_holds),  cmocka_unit_test(what_lies_in_each_other_is_told),
      cmocka_unit_test(a_grain_rests_on_a_slab),  cmocka_unit_test(blades_win_nothing),
      cmocka_unit_test(a_wedge_rests_in_a_notch), cmocka_unit_test(what_is_pressed_too_deep_parts)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
