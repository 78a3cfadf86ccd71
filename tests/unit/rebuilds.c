/* Worlds whose neighbours are made anew again and again: across periodic boundaries, of sizes over
 * two decades between moving mesh walls, with bodies that come and fall out. On several threads, or
 * on the backend that is named, the bits and the rebuilds are those of one thread. */
#include "base/rng.h"
#include "support/check.h"
#include "support/shapes.h"
#include "support/threads.h"

enum { PIECES = 4, STEPS = 1000, SHAPES = 4 };
static const char *backend = NULL;

static scree_particle *shapes[SHAPES];

static void make_shapes(double smallest) {
  scree_error error;
  scree_mesh box = shape_box(6 * smallest, 4 * smallest, 2 * smallest);
  shape_move(&box, (vec3){-3 * smallest, -2 * smallest, -smallest});
  CHECK_OK(scree_particle_sphere(smallest, &shapes[0], &error), error);
  CHECK_OK(scree_particle_sphere(3 * smallest, &shapes[1], &error), error);
  shapes[2] = shape_particle(box);
  shapes[3] = shape_particle(shape_tetrahedron(6 * smallest, 5 * smallest, 4 * smallest));
}

static void free_shapes(void) {
  for (int i = 0; i < SHAPES; i++) scree_particle_free(shapes[i]);
}

static void add_material(scree_world *world) {
  scree_error error;
  scree_material material = scree_default_material();
  material.young = 1e6;
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
}

/* One on each place of a cubic lattice, at random speeds. */
static void add_layer(scree_world *world, scree_rng *rng, const size_t counts[3], double spacing,
                      const double corner[3]) {
  scree_error error;
  for (size_t i = 0; i < counts[0] * counts[1] * counts[2]; i++) {
    const size_t at[3] = {i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]};
    scree_body body = scree_default_body();
    for (int k = 0; k < 3; k++) {
      body.position[k] = corner[k] + spacing * (double)at[k];
      body.velocity[k] = scree_rng_uniform(rng) - 0.5;
      body.angular_velocity[k] = 40 * (scree_rng_uniform(rng) - 0.5);
    }
    scree_particle *shape = shapes[scree_rng_below(rng, SHAPES)];
    CHECK_OK(scree_world_add_body(world, shape, 0, &body, NULL, &error), error);
  }
}

static scree_world *make_periodic(scree_rng *rng) {
  scree_error error;
  scree_world *world = NULL;
  scree_world_options o = scree_default_world_options();
  o.period[0] = 0.05;
  o.period[1] = 0.04;
  o.period_from[0] = -0.01;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  add_material(world);
  scree_wall floor = {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}, .position = {0, 0, -0.01}};
  CHECK_OK(scree_world_add_wall(world, &floor, NULL, &error), error);
  make_shapes(0.001);
  add_layer(world, rng, (size_t[3]){5, 4, 3}, 0.01, (double[3]){-0.005, 0.005, 0});
  return world;
}

static void go_on_periodic(scree_world *world, scree_rng *rng, int piece) {
  add_layer(world, rng, (size_t[3]){5, 4, 1}, 0.01, (double[3]){0, 0, 0.03 + 0.012 * piece});
}

/* A tray that shakes and one that turns; below both it is too deep. */
static scree_world *make_sizes(scree_rng *rng) {
  scree_error error;
  scree_world *world = NULL;
  scree_world_options o = scree_default_world_options();
  o.floor_height = -0.02;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  add_material(world);
  scree_mesh sheet = shape_sheet(0, 3);
  const mat3 small = {{{0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}}};
  shape_transform(&sheet, &small, (vec3){-0.05, -0.05, 0});
  scree_wall wall = {.kind = SCREE_WALL_MESH, .axis = {0, 0, 1}, .mesh = &sheet};
  scree_wall_motion motion = scree_default_wall_motion();
  motion.law = SCREE_MOTION_SINE;
  motion.amplitude = 0.003;
  motion.frequency = 40;
  size_t first, second;
  CHECK_OK(scree_world_add_wall(world, &wall, &first, &error), error);
  CHECK_OK(scree_world_set_wall_motion(world, first, &motion, 1, &error), error);
  wall.position[0] = 0.11;
  wall.angular_velocity[1] = 3;
  CHECK_OK(scree_world_add_wall(world, &wall, &second, &error), error);
  scree_mesh_free(&sheet);
  make_shapes(0.0004);
  add_layer(world, rng, (size_t[3]){8, 5, 1}, 0.004, (double[3]){-0.01, -0.008, 0.006});
  add_layer(world, rng, (size_t[3]){3, 3, 1}, 0.004, (double[3]){0.06, -0.008, 0.006});
  free_shapes();
  make_shapes(0.004);
  add_layer(world, rng, (size_t[3]){4, 2, 1}, 0.036, (double[3]){-0.03, -0.02, 0.03});
  return world;
}

static void go_on_sizes(scree_world *world, scree_rng *rng, int piece) {
  (void)rng;
  scree_world_remove_body(world, 7 * (size_t)piece);
}

typedef struct scene_kind {
  scree_world *(*make)(scree_rng *rng);
  void (*go_on)(scree_world *world, scree_rng *rng, int piece);
} scene_kind;

/* The state after a piece, and how often the neighbours were made until then. */
typedef struct result {
  scree_checksum hash;
  scree_observation seen;
  uint64_t builds;
} result;

static void run(const scene_kind *scene, const char *where, int threads, result results[PIECES]) {
  scree_error error;
  scree_rng rng = {.seed = 5};
  CHECK_OK(scree_set_backend(where, &error), error);
  use_threads(threads);
  scree_world *world = scene->make(&rng);
  for (int piece = 0; piece < PIECES; piece++) {
    result *r = &results[piece];
    CHECK_OK(scree_world_step(world, STEPS, &error), error);
    scree_timings timings;
    scree_world_timings(world, &timings);
    scree_world_observe(world, &r->seen);
    r->hash = scree_world_hash(world);
    r->builds = timings.broad_builds;
    scene->go_on(world, &rng, piece);
  }
  scree_world_free(world);
  free_shapes();
  use_threads(0);
}

static void check(const scene_kind *scene) {
  result want[PIECES], got[PIECES];
  run(scene, "cpu", 1, want);
  run(scene, backend ? backend : "cpu", backend ? 1 : 8, got);
  for (int piece = 0; piece < PIECES; piece++) {
    const result *a = &want[piece], *b = &got[piece];
    assert_true(a->hash.high == b->hash.high && a->hash.low == b->hash.low);
    assert_true(a->seen.dissipated_dashpot == b->seen.dissipated_dashpot &&
                a->seen.dissipated_friction == b->seen.dissipated_friction &&
                a->seen.wall_work == b->seen.wall_work);
    assert_int_equal(a->builds, b->builds);
  }
  const result *last = &want[PIECES - 1];
  print_message("%d rebuilds\n", (int)last->builds);
  assert_true(last->builds >= 5 * PIECES && last->seen.dissipated_dashpot > 0);
}

static void periodic(void **state) {
  (void)state;
  check(&(scene_kind){make_periodic, go_on_periodic});
}

static void sizes(void **state) {
  (void)state;
  check(&(scene_kind){make_sizes, go_on_sizes});
}

/* A device that is lost on the way: a sentence, again and again; what is here can be looked at. */
static void lost(void **state) {
  (void)state;
  scree_error error, again;
  scree_observation o;
  scree_rng rng = {.seed = 5};
  CHECK_OK(scree_set_backend(backend, &error), error);
  scree_world *world = make_periodic(&rng);
  scree_status status = SCREE_OK;
  for (int piece = 0; piece < PIECES && !status; piece++) {
    status = scree_world_step(world, STEPS, &error);
    scree_world_observe(world, &o);
    scree_world_hash(world);
  }
  assert_int_equal(status, SCREE_NO_BACKEND);
  assert_string_equal(error.message, "cuda: a kernel: unspecified launch failure (error 719)");
  assert_int_equal(scree_world_step(world, 1, &again), status);
  assert_string_equal(again.message, error.message);
  scree_world_free(world);
  free_shapes();
}

/* With a backend's name: there; with a word more: that is lost. */
int main(int argc, char **argv) {
  if (argc > 1) backend = argv[1];
  const struct CMUnitTest losing[] = {cmocka_unit_test(lost)};
  if (argc > 2) return cmocka_run_group_tests(losing, NULL, NULL);
  const struct CMUnitTest tests[] = {cmocka_unit_test(periodic), cmocka_unit_test(sizes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
