/* A world whose state is on a device, looked at, changed and saved in any order: its twin on the
 * processor has the same bits in everything. What looking costs is counted in bytes. */
#include "base/rng.h"
#include "support/check.h"
#include "support/mixed.h"

#include <dlfcn.h>
#include <unistd.h>

static const char *backend = "cpu";
static char file[] = "/tmp/scree-away-XXXXXX";
typedef struct twins {
  scree_world *here, *there;
} twins;

static void choose(const char *name) {
  scree_error error;
  CHECK_OK(scree_set_backend(name, &error), error);
}

static void step(twins *t, size_t steps) {
  scree_error error;
  choose("cpu");
  CHECK_OK(scree_world_step(t->here, steps, &error), error);
  choose(backend);
  CHECK_OK(scree_world_step(t->there, steps, &error), error);
}

static void check_sums(const twins *t) {
  scree_observation a, b;
  memset(&a, 0, sizeof a), memset(&b, 0, sizeof b);
  scree_world_observe(t->here, &a), scree_world_observe(t->there, &b);
  assert_memory_equal(&a, &b, sizeof a);
}

static void check_bodies(const twins *t) {
  for (size_t i = 0; i < scree_world_body_count(t->here); i++) {
    scree_body a, b;
    scree_world_get_body(t->here, i, &a), scree_world_get_body(t->there, i, &b);
    assert_memory_equal(&a, &b, sizeof a);
    assert_int_equal(scree_world_body_removed(t->here, i), scree_world_body_removed(t->there, i));
  }
}

static void check_walls(const twins *t) {
  for (size_t i = 0; i < scree_world_wall_count(t->here); i++) {
    double a[8], b[8];
    scree_world_wall_force(t->here, i, a, a + 3), scree_world_wall_force(t->there, i, b, b + 3);
    scree_world_wall_power(t->here, i, a + 6, a + 7);
    scree_world_wall_power(t->there, i, b + 6, b + 7);
    assert_memory_equal(a, b, sizeof a);
    scree_world_wall_orientation(t->here, i, a), scree_world_wall_orientation(t->there, i, b);
    assert_memory_equal(a, b, 4 * sizeof *a);
  }
}

static void check_hash(const twins *t) {
  scree_checksum a = scree_world_hash(t->here), b = scree_world_hash(t->there);
  assert_true(a.high == b.high && a.low == b.low);
}

static void look(twins *t, scree_rng *rng) {
  switch (scree_rng_below(rng, 4)) {
  case 0:
    check_sums(t);
    break;
  case 1:
    check_bodies(t);
    break;
  case 2:
    check_walls(t);
    break;
  default:
    check_hash(t);
  }
}

/* Another body high above. */
static void add(scree_world *world, double height) {
  scree_error error;
  scree_body body = scree_default_body();
  body.position[2] = height;
  size_t shape = scree_world_body_count(world) % 5;
  CHECK_OK(
      scree_world_add_body(world, scree_world_body_particle(world, shape), 0, &body, NULL, &error),
      error);
}

static bool is_mesh(const scree_world *world, size_t wall) {
  scree_wall w;
  scree_world_get_wall(world, wall, &w);
  return w.kind == SCREE_WALL_MESH;
}

static void change_one(scree_world *world, uint64_t what, size_t which, double height) {
  scree_error error;
  const double slow[3] = {0.01, 0, 0.01}, force[3] = {0.001, 0, 0}, still[3] = {0};
  size_t body = which % scree_world_body_count(world), wall = which % scree_world_wall_count(world);
  scree_wall_motion motion = scree_default_wall_motion();
  motion.speed = 0.01;
  switch (what) {
  case 0:
    add(world, height);
    break;
  case 1:
    scree_world_remove_body(world, body);
    break;
  case 2:
    CHECK_OK(scree_world_set_body_force(world, body, force, force, &error), error);
    break;
  case 3:
    CHECK_OK(scree_world_set_wall_velocity(world, wall, slow, force, &error), error);
    break;
  case 4:
    CHECK_OK(scree_world_set_wall_motion(world, wall, &motion, 1, &error), error);
    break;
  case 5:
    CHECK_OK(scree_world_set_wall_surface(world, wall, slow, force,
                                          is_mesh(world, wall) ? slow : still, &error),
             error);
    break;
  case 6:
    CHECK_OK(scree_world_set_body_density(world, body, 1500, &error), error);
    break;
  default:
    CHECK_OK(scree_world_set_contact(world, 0, 0, 0.4, 0.3, &error), error);
  }
}

/* Saved and gone on with, as after a run was killed. */
static void reload(scree_world **world, const char *name) {
  scree_error error;
  choose(name);
  CHECK_OK(scree_world_save(*world, file, true, &error), error);
  scree_world_free(*world);
  CHECK_OK(scree_world_load(file, world, &error), error);
}

static void any_order(void **state) {
  (void)state;
  int added = 0;
  for (uint64_t seed = 0; seed < 6; seed++) {
    scree_rng rng = {.seed = seed, .stream = 3};
    twins t = {mixed_world(SCREE_LAW_LINEAR), mixed_world(SCREE_LAW_LINEAR)};
    for (int turn = 0; turn < 40; turn++) {
      uint64_t what = scree_rng_below(&rng, 16), which = scree_rng_below(&rng, 1000);
      if (what < 8) {
        double height = 0.5 + 0.1 * added++;
        change_one(t.here, what, (size_t)which, height);
        change_one(t.there, what, (size_t)which, height);
      } else if (what == 8) {
        reload(&t.here, "cpu"), reload(&t.there, backend);
      } else if (what < 12) {
        step(&t, 1 + (size_t)which % 30);
      } else {
        look(&t, &rng);
      }
    }
    step(&t, 50);
    check_sums(&t);
    check_bodies(&t), check_walls(&t), check_hash(&t);
    scree_world_free(t.here), scree_world_free(t.there);
  }
}

/* What a step and each question bring from the device. */
static void bytes(void **state) {
  (void)state;
  void *driver = dlopen("libcuda.so.1", RTLD_NOW);
  const unsigned long long *count = driver ? dlsym(driver, "stand_in_read") : NULL;
  if (!count || strcmp(backend, "cpu") == 0) skip();
  scree_error error;
  scree_observation o;
  scree_body body;
  choose(backend);
  scree_world *world = mixed_world(SCREE_LAW_LINEAR);
  CHECK_OK(scree_world_step(world, 1000, &error), error);
  scree_world_hash(world);
  unsigned long long before = *count, step, sums, poses;
  CHECK_OK(scree_world_step(world, 8, &error), error);
  step = *count - before, before = *count;
  scree_world_observe(world, &o);
  sums = *count - before, before = *count;
  scree_world_get_body(world, 0, &body);
  scree_world_get_body(world, 1, &body);
  poses = *count - before, before = *count;
  scree_world_hash(world);
  print_message("bytes: eight steps %llu, sums %llu, poses %llu, all else %llu\n", step, sums,
                poses, *count - before);
  assert_true(step < 4096 && sums < 4096 && poses <= 224 * scree_world_body_count(world));
  assert_true(*count - before > 10 * (sums + poses));
  scree_world_free(world);
}

int main(int argc, char **argv) {
  if (argc > 1) backend = argv[1];
  close(mkstemp(file));
  const struct CMUnitTest tests[] = {cmocka_unit_test(any_order), cmocka_unit_test(bytes)};
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  unlink(file);
  return failed;
}
