/* Frames of instances: what a reader finds at the offsets that the file names, against the world;
 * the force and the stress of a ball at rest; the size of a file. */
#include "report/program.h"
#include "support/folder.h"
#include "support/scene.h"

#include "scree.h"

typedef struct content {
  char *bytes;
  size_t size;
} content;

static content read_all(const char *path) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  content c = {NULL, (size_t)ftell(file)};
  c.bytes = malloc(c.size + 1);
  rewind(file);
  assert_int_equal(fread(c.bytes, 1, c.size, file), c.size);
  c.bytes[c.size] = 0;
  fclose(file);
  return c;
}

/* The values of an array, as the file's header names its place. */
static const void *array_of(const content *c, const char *name, size_t bytes) {
  char key[80];
  uint64_t count;
  snprintf(key, sizeof key, "Name=\"%s\"", name);
  const char *at = strstr(c->bytes, key);
  assert_non_null(at);
  unsigned long offset = strtoul(strstr(at, "offset=\"") + 8, NULL, 10);
  const char *data = strstr(c->bytes, "encoding=\"raw\">_") + 16 + offset;
  memcpy(&count, data, 8);
  assert_int_equal(count, bytes);
  return data + 8;
}

static float real_at(const void *array, size_t index) {
  float value;
  memcpy(&value, (const char *)array + 4 * index, 4);
  return value;
}

/* A ball that lies on a plane: the plane's force, and the pressure m g R/V along the vertical. */
static void resting_ball(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene =
      create("time: 1\n"
             "materials: {m: {young: 1e7, density: 2500, restitution: 0.1}}\n"
             "shapes: {ball: {sphere: 0.02}}\n"
             "geometry: {floor: {plane: [0, 0, 1]}}\n"
             "inlets: {i: {box: {min: [0.3, 0.3, 0.0001], max: [0.4, 0.4, 0.0305]}, shapes: ball, "
             "count: 1}}\n");
  while (!scree_scene_end(scene)) CHECK_OK(scree_scene_advance(scene, 10000, &error), error);
  CHECK_OK(scree_scene_bodies_vtp_write(scene, in_folder("ball.vtp"), true, &error), error);
  content c = read_all(in_folder("ball.vtp"));
  const double r = 0.01, volume = 4.18879020478639 * r * r * r, weight = 2500 * volume * 9.81;
  const void *force = array_of(&c, "contact force [N]", 12),
             *stress = array_of(&c, "stress [Pa]", 24);
  CHECK_NEAR(real_at(force, 2), weight, 1e-3 * weight);
  CHECK_NEAR(real_at(force, 0), 0, 1e-3 * weight);
  CHECK_NEAR(real_at(stress, 2), weight * r / volume, 1e-3 * weight * r / volume);
  for (size_t k = 0; k < 6; k++)
    if (k != 2) CHECK_NEAR(real_at(stress, k), 0, 1e-3 * weight * r / volume);
  free(c.bytes);
  scree_scene_free(scene);
}

/* 10,000 balls of two kinds: at most 1.05 MB, all of them where they are. */
static void many(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene = create(
      "time: 1\n"
      "shapes: {ball: {sphere: 0.02}, brick: {box: [0.01, 0.01, 0.02]}}\n"
      "inlets: {i: {box: {min: [0, 0, 0], max: [1, 1, 1]}, shapes: {ball: 1, brick: 1}, count: "
      "10000, velocity: [1, 2, 3]}}\n");
  CHECK_OK(scree_scene_advance(scene, 5, &error), error);
  const scree_world *world = scree_scene_view(scene);
  assert_int_equal(scree_world_body_count(world), 10000);
  CHECK_OK(scree_scene_bodies_vtp_write(scene, in_folder("many.vtp"), true, &error), error);
  content c = read_all(in_folder("many.vtp"));
  assert_true(c.size <= 1050000);
  const void *points = array_of(&c, "Points", 120000), *turn = array_of(&c, "orientation", 160000),
             *velocity = array_of(&c, "velocity [m/s]", 120000),
             *size = array_of(&c, "size [m]", 40000);
  const void *shape = array_of(&c, "shape", 40000);
  for (size_t b = 0; b < 10000; b++) {
    scree_body body;
    scree_particle_measures m;
    scree_world_get_body(world, b, &body);
    scree_particle_measure(scree_world_body_particle(world, b), &m);
    for (size_t k = 0; k < 3; k++) CHECK_NEAR(real_at(points, 3 * b + k), body.position[k], 1e-7);
    for (size_t k = 0; k < 4; k++) CHECK_NEAR(real_at(turn, 4 * b + k), body.orientation[k], 1e-7);
    for (size_t k = 0; k < 3; k++) CHECK_NEAR(real_at(velocity, 3 * b + k), body.velocity[k], 1e-6);
    CHECK_NEAR(real_at(size, b), m.size, 1e-8);
    int32_t kind;
    memcpy(&kind, (const char *)shape + 4 * b, 4);
    assert_int_equal(kind, scree_scene_body_shape(scene, b));
  }
  free(c.bytes);
  for (size_t s = 0; s < 2; s++)
    CHECK_OK(scree_scene_shape_vtp_write(scene, s, in_folder("shape.vtp"), true, &error), error);
  c = read_all(in_folder("shape.vtp"));
  array_of(&c, "connectivity", (size_t)12 * 3 * 8); /* the brick's */
  free(c.bytes);
  scree_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(resting_ball),
      cmocka_unit_test(many),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
