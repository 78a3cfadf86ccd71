/* The state that a failing run leaves: it goes on from there on the processor with the same bits,
 * wherever it was stepped. Runs fail because a body is pressed through a wall, there is no memory,
 * or the device is lost. */
#include "support/check.h"
#include "support/mixed.h"
#include "world/state/world.h"

#include <dlfcn.h>
#include <unistd.h>

static const char *backend = "cpu";
static char path[] = "/tmp/scree-kept-XXXXXX";
enum { INTERVAL = 50, GOOD_STEPS = 420, KEPT = GOOD_STEPS / INTERVAL * INTERVAL };

static void choose(const char *name) {
  scree_error error;
  CHECK_OK(scree_set_backend(name, &error), error);
}

/* A variable of the stand-in for a driver. */
static int *in_driver(const char *name) {
  void *driver = strcmp(backend, "cpu") != 0 ? dlopen("libcuda.so.1", RTLD_NOW) : NULL;
  return driver ? dlsym(driver, name) : NULL;
}

/* A ball on a floor, and a lid that comes down on it and does not stop. */
static scree_world *pressed_world(void) {
  scree_error error;
  scree_world *world = NULL;
  scree_particle *ball = NULL;
  scree_material material = scree_default_material();
  scree_wall floor = {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}};
  scree_wall lid = {.kind = SCREE_WALL_PLANE,
                    .position = {0, 0, 0.045},
                    .axis = {0, 0, -1},
                    .velocity = {0, 0, -1}};
  scree_body body = scree_default_body();
  body.position[2] = 0.02;
  CHECK_OK(scree_world_create(NULL, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  CHECK_OK(scree_world_add_wall(world, &floor, NULL, &error), error);
  CHECK_OK(scree_world_add_wall(world, &lid, NULL, &error), error);
  CHECK_OK(scree_particle_sphere(0.02, &ball, &error), error);
  CHECK_OK(scree_world_add_body(world, ball, 0, &body, NULL, &error), error);
  scree_particle_free(ball);
  return world;
}

/* It stops again in the same way. */
static void pressed_through(void **state) {
  (void)state;
  scree_error error, again;
  choose(backend);
  scree_world *world = pressed_world(), *loaded = NULL;
  assert_int_equal(scree_world_keep(world, path, 0, &error), SCREE_BAD_ARGUMENT);
  CHECK_OK(scree_world_keep(world, path, INTERVAL, &error), error);
  assert_int_equal(scree_world_step(world, 100000, &error), SCREE_DIVERGED);
  assert_non_null(strstr(error.message, "body 0 is pressed through wall"));
  assert_non_null(strstr(error.message, path));
  choose("cpu");
  CHECK_OK(scree_world_load(path, &loaded, &error), error);
  uint64_t steps = scree_world_step_count(world), kept = scree_world_step_count(loaded);
  assert_true(kept % INTERVAL == 0 && kept <= steps && kept + INTERVAL > steps);
  CHECK_OK(scree_world_step(loaded, (size_t)(steps - kept), &error), error); /* good to here */
  assert_int_equal(scree_world_step(loaded, 1, &again), SCREE_DIVERGED);
  scree_world_step(world, 1, &error);
  *strchr(error.message, ';') = 0;
  if (strchr(again.message, ';')) *strchr(again.message, ';') = 0;
  assert_string_equal(error.message, again.message);
  scree_world_free(world);
  scree_world_free(loaded);
}

/* A world that has come so far, and keeps states. */
static scree_world *good_world(void) {
  scree_error error;
  choose(backend);
  scree_world *world = mixed_world(SCREE_LAW_LINEAR);
  CHECK_OK(scree_world_keep(world, path, INTERVAL, &error), error);
  CHECK_OK(scree_world_step(world, GOOD_STEPS, &error), error);
  return world;
}

/* It says where its state is, as often as it is asked; that goes on as if nothing had happened. */
static void check_left(scree_world *world, scree_status status, const scree_error *error) {
  scree_error again;
  scree_world *loaded = NULL;
  assert_int_equal(error->status, status);
  char where[100];
  snprintf(where, sizeof where, "; the state of step %d is in %s", KEPT, path);
  const char *found = strstr(error->message, where);
  assert_non_null(found);
  assert_string_equal(found, where); /* once */
  assert_int_equal(scree_world_step(world, 1, &again), status);
  assert_string_equal(again.message, error->message);
  scree_world_free(world);
  choose("cpu");
  world = mixed_world(SCREE_LAW_LINEAR);
  CHECK_OK(scree_world_step(world, 2 * GOOD_STEPS, &again), again);
  CHECK_OK(scree_world_load(path, &loaded, &again), again);
  assert_int_equal(scree_world_step_count(loaded), KEPT);
  CHECK_OK(scree_world_step(loaded, 2 * GOOD_STEPS - KEPT, &again), again);
  scree_checksum a = scree_world_hash(world), b = scree_world_hash(loaded);
  assert_true(a.high == b.high && a.low == b.low);
  scree_world_free(world);
  scree_world_free(loaded);
}

static bool refuses;
static void *refuse_once(void *context, void *block, size_t size) {
  (void)context;
  if (size == 0) free(block);
  if (size == 0) return NULL;
  void *given = refuses ? NULL : realloc(block, size);
  refuses = false;
  return given;
}

/* More bodies than there is room for. */
static void add_bodies(scree_world *world) {
  scree_error error;
  scree_body body = scree_default_body();
  for (int i = 0; i < 100; i++) {
    body.position[2] = 1 + 0.1 * i;
    CHECK_OK(
        scree_world_add_body(world, scree_world_body_particle(world, 0), 0, &body, NULL, &error),
        error);
  }
}

static void no_memory(void **state) {
  (void)state;
  int *full = in_driver("stand_in_full");
  if (!full && strcmp(backend, "cpu") != 0) skip();
  scree_error error = {0};
  scree_world *world = good_world();
  add_bodies(world);
  if (full)
    *full = 1;
  else
    refuses = true;
  scree_set_allocator(refuse_once, NULL);
  scree_world_step(world, 1, &error);
  scree_set_allocator(NULL, NULL);
  if (full) *full = 0;
  check_left(world, SCREE_OUT_OF_MEMORY, &error);
}

static void lost_in_a_step(void **state) {
  (void)state;
  int *lost = in_driver("stand_in_lost");
  if (!lost) skip();
  scree_error error = {0};
  scree_world *world = good_world();
  *lost = 1;
  scree_world_step(world, 1, &error);
  check_left(world, SCREE_NO_BACKEND, &error);
  *lost = 0;
}

static void lost_in_a_look(void **state) {
  (void)state;
  int *lost = in_driver("stand_in_lost");
  if (!lost) skip();
  scree_error error = {0};
  scree_body body;
  scree_world *world = good_world();
  *lost = 1;
  scree_world_get_body(world, 0, &body);
  scree_world_step(world, 1, &error);
  check_left(world, SCREE_NO_BACKEND, &error);
  *lost = 0;
}

/* With a backend's name: there. */
int main(int argc, char **argv) {
  if (argc > 1) backend = argv[1];
  close(mkstemp(path));
  const struct CMUnitTest tests[] = {cmocka_unit_test(pressed_through), cmocka_unit_test(no_memory),
                                     cmocka_unit_test(lost_in_a_step),
                                     cmocka_unit_test(lost_in_a_look)};
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  unlink(path);
  return failed;
}
