/* Hundreds of random worlds: options, materials, walls, bodies and joints of every
 * kind, some out of range, some bodies inside each other. Whatever is made, a
 * call answers with a status and a sentence, what runs stays finite, and a
 * checkpoint goes on with the same bits. */
#include "base/rng.h"
#include "support/check.h"
#include "support/shapes.h"
#include "support/solids.h"

#include <unistd.h>

enum { SEEDS = 300, SHAPES = 6 };

static char file[] = "/tmp/scree-random-XXXXXX";
static scree_particle *shapes[SHAPES];
static const char *backend = "cpu";

static double between(scree_rng *rng, double low, double high) {
  return low + (high - low) * scree_rng_uniform(rng);
}

/* Mostly within the range, now and then anything. */
static double value(scree_rng *rng, double low, double high) {
  static const double odd[] = {0, -1, 1e300, -1e300, NAN, INFINITY, 1e-300};
  if (scree_rng_below(rng, 200) == 0) return odd[scree_rng_below(rng, 7)];
  return between(rng, low, high);
}

static scree_world_options random_options(scree_rng *rng) {
  scree_world_options o = scree_default_world_options();
  for (int i = 0; i < 3; i++) o.gravity[i] = value(rng, -20, 20);
  o.law = (scree_law)scree_rng_below(rng, 2);
  o.steps_per_contact = value(rng, 15, 60);
  o.stiffness_factor = pow(10, between(rng, -3, 1));
  o.tangential_ratio = value(rng, 0.1, 1);
  o.smoothing = value(rng, 1e-6, 1e-3);
  o.sharing = value(rng, 0, 0.5);
  o.overlap_limit = value(rng, 0.01, 0.3);
  o.skin = value(rng, 0.001, 0.5);
  if (scree_rng_below(rng, 3) == 0) o.size = value(rng, 0.01, 0.1);
  if (scree_rng_below(rng, 3) == 0) o.floor_height = value(rng, -0.3, 0.05);
  if (scree_rng_below(rng, 8) == 0) o.time_step = value(rng, 1e-7, 1e-4);
  return o;
}

/* Refusals must say why. */
static bool accepted(scree_status status, const scree_error *error) {
  if (status == SCREE_OK) return true;
  assert_true(status == SCREE_BAD_ARGUMENT || status == SCREE_DIVERGED);
  assert_true(strlen(error->message) > 10);
  return false;
}

static void add_walls(scree_rng *rng, scree_world *world, const scree_mesh *sheet) {
  scree_error error;
  for (size_t count = scree_rng_below(rng, 4); count > 0; count--) {
    scree_wall wall = {.kind = (scree_wall_kind)scree_rng_below(rng, 4),
                       .material = scree_rng_below(rng, 3),
                       .radius = value(rng, 0.02, 0.3),
                       .length = value(rng, 0, 0.5),
                       .mesh = sheet};
    for (int i = 0; i < 3; i++) {
      wall.position[i] = value(rng, -0.1, 0.1);
      wall.axis[i] = value(rng, -1, 1);
      wall.velocity[i] = value(rng, -1, 1);
      if (scree_rng_below(rng, 2)) wall.angular_velocity[i] = value(rng, -10, 10);
    }
    accepted(scree_world_add_wall(world, &wall, NULL, &error), &error);
  }
}

static void add_bodies(scree_rng *rng, scree_world *world) {
  scree_error error;
  for (size_t count = 1 + scree_rng_below(rng, 12); count > 0; count--) {
    scree_body body = scree_default_body();
    for (int i = 0; i < 3; i++) {
      body.position[i] = value(rng, -0.12, 0.12);
      body.velocity[i] = value(rng, -4, 4);
      body.angular_velocity[i] = value(rng, -50, 50);
    }
    for (int i = 0; i < 4; i++) body.orientation[i] = value(rng, -1, 1);
    accepted(scree_world_add_body(world, shapes[scree_rng_below(rng, SHAPES)],
                                  scree_rng_below(rng, 3), &body, NULL, &error),
             &error);
  }
}

/* Some of them weak, between what is there, or with space; a body may be asked for twice. */
static void add_joints(scree_rng *rng, scree_world *world) {
  scree_error error;
  size_t bodies = scree_world_body_count(world);
  for (size_t count = bodies ? scree_rng_below(rng, 6) : 0; count > 0; count--) {
    scree_joint joint = scree_default_joint();
    scree_joint_of_rectangle((scree_section_kind)scree_rng_below(rng, 3),
                             pow(10, between(rng, 5, 8)), 0.3, value(rng, 0.005, 0.03),
                             value(rng, 0.002, 0.02), value(rng, 0.01, 0.1), &joint);
    joint.a = scree_rng_below(rng, bodies);
    joint.b = scree_rng_below(rng, 6) ? scree_rng_below(rng, bodies) : SCREE_SPACE;
    for (int i = 0; i < 3; i++) joint.centre[i] = value(rng, -0.1, 0.1);
    joint.tension = joint.cohesion = pow(10, between(rng, 3, 7));
    joint.friction = value(rng, 0, 1);
    accepted(scree_world_add_joint(world, &joint, NULL, &error), &error);
  }
}

static scree_observation check_finite(const scree_world *world) {
  scree_observation o;
  scree_world_observe(world, &o);
  double sum = o.kinetic + o.rotational + o.potential + o.elastic + o.dissipated_dashpot +
               o.dissipated_friction + o.fracture + o.wall_work + o.mean_rotation +
               o.largest_overlap;
  assert_true(isfinite(sum));
  assert_true(o.elastic >= 0 && o.kinetic >= 0 && o.rotational >= 0 && o.fracture >= 0);
  return o;
}

static bool count_contact(void *context, const scree_contact *contact) {
  assert_true(isfinite(contact->force[0] + contact->overlap + contact->position[2]));
  assert_true(contact->weight > 0);
  ++*(size_t *)context;
  return true;
}

/* The run goes on from a checkpoint with the same bits, or into the same
 * failure. */
static void check_checkpoint(scree_world *world) {
  scree_error error, other, unused;
  scree_world *loaded = NULL;
  CHECK_OK(scree_world_save(world, file, true, &error), error);
  CHECK_OK(scree_world_load(file, &loaded, &error), error);
  scree_status first = scree_world_step(world, 40, &error);
  CHECK_OK(scree_world_set_backend(loaded, "cpu", &unused), unused);
  scree_status second = scree_world_step(loaded, 40, &other);
  assert_int_equal(first, second);
  if (first != SCREE_OK) assert_string_equal(error.message, other.message);
  scree_checksum a = scree_world_hash(world), b = scree_world_hash(loaded);
  assert_true(a.high == b.high && a.low == b.low);
  scree_world_free(loaded);
}

static int run_seed(uint64_t seed, const scree_mesh *sheet, size_t *contacts, size_t *broken) {
  scree_rng rng = {.seed = seed, .stream = 7};
  scree_error error;
  scree_world *world = NULL;
  scree_world_options o = random_options(&rng);
  if (!accepted(scree_world_create(&o, &world, &error), &error)) return 0;
  for (int i = 0; i < 3; i++) {
    scree_material m = {.young = pow(10, between(&rng, 6, 11))};
    m.density = value(&rng, 100, 5000);
    m.restitution = value(&rng, 0.05, 1);
    m.friction = value(&rng, 0, 1);
    accepted(scree_world_add_material(world, &m, NULL, &error), &error);
  }
  if (scree_rng_below(&rng, 2))
    accepted(scree_world_set_contact(world, scree_rng_below(&rng, 4), scree_rng_below(&rng, 3),
                                     value(&rng, 0, 1), value(&rng, 0, 1), &error),
             &error);
  scree_material_contact contact = {.restitution = 0.5, .friction = 0.5};
  contact.rolling_friction = value(&rng, 0, 1);
  contact.surface_energy = value(&rng, 0, 1);
  if (scree_rng_below(&rng, 2))
    accepted(scree_world_set_pair(world, 0, scree_rng_below(&rng, 4), &contact, &error), &error);
  add_walls(&rng, world, sheet);
  add_bodies(&rng, world);
  add_joints(&rng, world);
  int good = 0;
  scree_observation last = {0};
  for (int round = 0; round < 4; round++) {
    if (!accepted(scree_world_step(world, 100, &error), &error)) break;
    last = check_finite(world);
    CHECK_OK(scree_world_visit_contacts(world, count_contact, contacts, &error), error);
    if (round == 1) add_bodies(&rng, world);
    if (round == 1 && scree_rng_below(&rng, 2)) add_joints(&rng, world);
    if (round == 2 && scree_world_body_count(world))
      scree_world_remove_body(world, scree_rng_below(&rng, scree_world_body_count(world)));
    check_checkpoint(world);
    good++;
  }
  *broken += last.broken_joints;
  scree_world_free(world);
  return good;
}

static void random_worlds(void **state) {
  (void)state;
  scree_error error;
  scree_mesh meshes[4] = {shape_box(0.05, 0.03, 0.015), solid_tray(0.05, 0.04, 0.02, 0.004),
                          solid_hook(0.05, 0.012, 0.015), shape_tetrahedron(0.04, 0.05, 0.03)};
  scree_mesh sheet = shape_sheet(0, 2);
  const double centres[6] = {0, 0, 0, 0.015, 0, 0.005}, radii[2] = {0.01, 0.014};
  for (int i = 0; i < 4; i++) {
    CHECK_OK(scree_particle_from_mesh(&meshes[i], NULL, &shapes[i], &error), error);
    scree_mesh_free(&meshes[i]);
  }
  CHECK_OK(scree_particle_sphere(0.02, &shapes[4], &error), error);
  CHECK_OK(scree_particle_clump(centres, radii, 2, NULL, &shapes[5], &error), error);
  close(mkstemp(file));
  int rounds = 0;
  size_t contacts = 0, broken = 0;
  for (uint64_t seed = 0; seed < SEEDS; seed++)
    rounds += run_seed(seed, &sheet, &contacts, &broken);
  print_message("%d of %d rounds ran, %zu contacts and %zu broken joints seen\n", rounds, 4 * SEEDS,
                contacts, broken);
  assert_true(rounds > SEEDS / 4 && contacts > 20 && broken > 20);
  unlink(file);
  scree_mesh_free(&sheet);
  for (int i = 0; i < SHAPES; i++) scree_particle_free(shapes[i]);
}

/* With a backend's name: there, where loaded worlds go on on the processor. */
int main(int argc, char **argv) {
  scree_error error;
  if (argc > 1) backend = argv[1];
  CHECK_OK(scree_set_backend(backend, &error), error);
  const struct CMUnitTest tests[] = {cmocka_unit_test(random_worlds)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
