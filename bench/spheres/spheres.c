/* Spheres of 6 mm beside LIGGGHTS (bench/liggghts.sh), one core, the same constants on both sides:
 *
 *   bench_spheres tube POSITIONS            a lifted tube; prints the heap's rms radius, mm
 *   bench_spheres roll POSITIONS            the first sphere rolls at 0.5 m/s; where it stops, mm
 *   bench_spheres rest POSITIONS SIDE       at rest in a box open above; prints the centres
 *   bench_spheres rate POSITIONS SIDE STEPS particle-steps a second of these, after a tenth as many
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
enum { SETTLE = 14000, LIFT = 24000, ROLL = 40000, REST = 4000 };

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

static double roll(scree_world *world) {
  scree_error error;
  scree_body body;
  add_floor(world);
  scree_world_get_body(world, 0, &body);
  body.position[0] = body.position[1] = 0;
  body.position[2] = 0.5 * diameter;
  body.velocity[0] = 0.5;
  need(scree_world_set_body(world, 0, &body, &error), &error);
  step(world, ROLL);
  scree_world_get_body(world, 0, &body);
  return 1000 * body.position[0];
}

static void add_box(scree_world *world, double side) {
  add_floor(world);
  for (int k = 0; k < 2; k++) {
    scree_wall low = {.kind = SCREE_WALL_PLANE}, high = low;
    low.axis[k] = 1;
    high.axis[k] = -1;
    high.position[k] = side;
    add_wall(world, &low);
    add_wall(world, &high);
  }
}

static void print_centres(const scree_world *world) {
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    printf("%.9g %.9g %.9g\n", body.position[0], body.position[1], body.position[2]);
  }
}

static double rate(scree_world *world, size_t steps) {
  step(world, steps / 10);
  double before = (double)clock();
  step(world, steps);
  double spent = ((double)clock() - before) / CLOCKS_PER_SEC;
  return (double)steps * (double)scree_world_body_count(world) / spent;
}

static int in_box(char **argv, int argc) {
  scree_world *world = make_world();
  add_spheres(world, argv[2], SIZE_MAX);
  add_box(world, strtod(argv[3], NULL));
  if (argc > 4) {
    double found = rate(world, strtoul(argv[4], NULL, 10));
    printf("%.0f %.2f\n", found, (double)clock() / CLOCKS_PER_SEC);
  } else {
    step(world, REST);
    print_centres(world);
  }
  scree_world_free(world);
  return 0;
}

int main(int argc, char **argv) {
  if (argc < 3) return 2;
  scree_set_threads(1);
  if (argc > 3) return in_box(argv, argc);
  const bool rolls = !strcmp(argv[1], "roll");
  scree_world *world = make_world();
  add_spheres(world, argv[2], rolls ? 1 : SIZE_MAX);
  double value = rolls ? roll(world) : tube(world);
  printf("%.4f %.2f\n", value, (double)clock() / CLOCKS_PER_SEC);
  scree_world_free(world);
  return 0;
}
