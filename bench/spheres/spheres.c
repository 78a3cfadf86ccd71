/* Spheres of 6 mm beside LIGGGHTS (bench/liggghts.sh), one core, the same constants on both sides:
 *
 *   bench_spheres tube POSITIONS            a lifted tube; prints the heap's rms radius, mm
 *   bench_spheres orifice-MM POSITIONS      a bin with such a hole; spheres through it in half a s
 *   bench_spheres roll POSITIONS            the first sphere rolls at 0.5 m/s; where it stops, mm
 *
 * POSITIONS has a centre a line. Printed are the value, and CPU seconds. */
#include "scree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double time_step = 2.5e-5;
static const double diameter = 0.006;
static const double stiffness = 1000; /* N/m, of a contact */
enum { SETTLE = 14000, LIFT = 24000, HALF_SECOND = 20000 };

static void need(scree_status status, const scree_error *error) {
  if (status == SCREE_OK) return;
  fprintf(stderr, "bench_spheres: %s\n", error->message);
  exit(1);
}

static scree_world *make_world(void) {
  scree_error error;
  scree_world *world;
  scree_world_options options = scree_default_world_options();
  options.time_step = time_step;
  scree_material material = scree_default_material();
  material.young = 2 * stiffness / diameter;
  material.density = 2500;
  material.rolling_friction = 0.2;
  need(scree_world_create(&options, &world, &error), &error);
  need(scree_world_add_material(world, &material, NULL, &error), &error);
  return world;
}

static void add_spheres(scree_world *world, const char *path, size_t most) {
  scree_error error;
  scree_particle *sphere;
  FILE *file = fopen(path, "r");
  if (!file) {
    perror(path);
    exit(1);
  }
  need(scree_particle_sphere(0.5 * diameter, &sphere, &error), &error);
  scree_body body = scree_default_body();
  double *at = body.position;
  for (size_t n = 0; n < most && fscanf(file, "%lf %lf %lf", &at[0], &at[1], &at[2]) == 3; n++)
    need(scree_world_add_body(world, sphere, 0, &body, NULL, &error), &error);
  scree_particle_free(sphere);
  fclose(file);
}

static size_t add_wall(scree_world *world, const scree_wall *wall) {
  scree_error error;
  size_t index;
  need(scree_world_add_wall(world, wall, &index, &error), &error);
  return index;
}

static void add_floor(scree_world *world) {
  const scree_wall floor = {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}};
  add_wall(world, &floor);
}

static void step(scree_world *world, size_t count) {
  scree_error error;
  need(scree_world_step(world, count, &error), &error);
}

static double tube(scree_world *world) {
  scree_error error;
  const double up[3] = {0, 0, 0.1}, none[3] = {0, 0, 0};
  const scree_wall wall = {
      .kind = SCREE_WALL_CYLINDER, .axis = {0, 0, 1}, .radius = 0.036, .length = 0.14};
  add_floor(world);
  size_t index = add_wall(world, &wall), count = scree_world_body_count(world);
  step(world, SETTLE);
  need(scree_world_set_wall_velocity(world, index, up, none, &error), &error);
  step(world, LIFT + SETTLE);
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    sum += body.position[0] * body.position[0] + body.position[1] * body.position[1];
  }
  return 1000 * sqrt(sum / (double)count);
}

static double count_below(const scree_world *world) {
  size_t below = 0;
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    below += body.position[2] < -0.01;
  }
  return (double)below;
}

/* A ring between two circles of a bin's floor, from below 0; the STL that LIGGGHTS reads is the
 * same. */
static void add_ring(scree_world *world, double inner, double outer) {
  enum { PARTS = 90 };
  double positions[6 * PARTS];
  uint32_t triangles[6 * PARTS];
  for (uint32_t k = 0; k < PARTS; k++) {
    const double angle = 2 * 3.14159265358979323846 * k / PARTS, c = cos(angle), s = sin(angle);
    const double pair[6] = {inner * c, inner * s, 0, outer * c, outer * s, 0};
    const uint32_t next = (k + 1) % PARTS;
    const uint32_t two[6] = {2 * k, 2 * k + 1, 2 * next + 1, 2 * k, 2 * next + 1, 2 * next};
    memcpy(&positions[6 * k], pair, sizeof pair);
    memcpy(&triangles[6 * k], two, sizeof two);
  }
  const scree_mesh mesh = {.positions = positions,
                           .vertex_count = 2 * PARTS,
                           .triangles = triangles,
                           .triangle_count = 2 * PARTS};
  const scree_wall wall = {.kind = SCREE_WALL_MESH, .axis = {0, 0, 1}, .mesh = &mesh};
  add_wall(world, &wall);
}

static double orifice(scree_world *world, double radius) {
  const scree_wall bin = {
      .kind = SCREE_WALL_CYLINDER, .axis = {0, 0, 1}, .radius = 0.036, .length = 0.14};
  add_wall(world, &bin);
  add_ring(world, radius, 0.036);
  step(world, HALF_SECOND / 2);
  double before = count_below(world);
  step(world, HALF_SECOND);
  return count_below(world) - before;
}

static double roll(scree_world *world) {
  scree_error error;
  scree_body body;
  add_floor(world);
  scree_world_get_body(world, 0, &body);
  body.position[0] = body.position[1] = 0;
  body.position[2] = 0.5 * diameter;
  body.velocity[0] = 0.5;
  need(scree_world_set_body(world, 0, &body, &error), &error);
  step(world, 2 * HALF_SECOND);
  scree_world_get_body(world, 0, &body);
  return 1000 * body.position[0];
}

int main(int argc, char **argv) {
  if (argc < 3) return 2;
  scree_set_threads(1);
  const bool rolls = !strcmp(argv[1], "roll"), flows = !strncmp(argv[1], "orifice-", 8);
  scree_world *world = make_world();
  add_spheres(world, argv[2], rolls ? 1 : SIZE_MAX);
  double value = rolls   ? roll(world)
                 : flows ? orifice(world, 0.5e-3 * atof(argv[1] + 8))
                         : tube(world);
  printf("%.4f %.2f\n", value, (double)clock() / CLOCKS_PER_SEC);
  scree_world_free(world);
  return 0;
}
