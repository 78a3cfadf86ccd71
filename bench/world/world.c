/* The speed of scree's world:
 *
 *   bench_world fill KIND TRIANGLES COUNT OUT      a scene at rest in a cylinder of 0.4 m
 *   bench_world stack COPIES IN OUT                copies sunk onto each other, at rest
 *   bench_world shelve COPIES SECONDS IN OUT       copies above each other, each on its own floor
 *   bench_world lift HEIGHT IN OUT                 after the cylinder has risen by HEIGHT m
 *   bench_world retime DT IN OUT                   with time step DT s
 *   bench_world dump IN OUT                        the scene as text, for the peers (print_scene)
 *   bench_world time THREADS SECONDS IN            measures, after a tenth of the time to warm up
 *   bench_world batch WORLDS SECONDS IN            measures as many worlds at once, a thread each
 *   bench_world hash THREADS STEPS IN              prints the hash of the state after these steps
 *
 * IN and OUT are checkpoints. `time` prints one CSV line: bodies, triangles of the first body, time
 * step, steps, wall s, CPU s, particle-steps per second of wall clock, the same per second of CPU
 * time, shares of broad, lists, contacts (without lists) and bodies in %, touching pairs a body,
 * contacts a body, evaluated items a body and step, lists built per 1000 bodies and steps, kinetic
 * energy J, largest overlap m, peak memory bytes. */
#include "bench.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static double seconds(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static scree_world *load(const char *path) {
  scree_error error;
  scree_world *world;
  need(scree_world_load(path, &world, &error), &error);
  return world;
}

static int save(scree_world *world, const char *path) {
  scree_error error;
  need(scree_world_save(world, path, true, &error), &error);
  scree_world_free(world);
  return 0;
}

static int fill(char **a) {
  shape_set shapes;
  make_shapes(a[0], strtoul(a[1], NULL, 10), &shapes);
  int status = save(fill_scene(&shapes, strtoul(a[2], NULL, 10), 1), a[3]);
  free_shapes(&shapes);
  return status;
}

static int stack(char **a) {
  scree_world *from = load(a[1]);
  int status = save(stack_scene(from, strtoul(a[0], NULL, 10)), a[2]);
  scree_world_free(from);
  return status;
}

static int shelve(char **a) {
  scree_world *from = load(a[2]);
  int status = save(shelve_scene(from, strtoul(a[0], NULL, 10), strtod(a[1], NULL)), a[3]);
  scree_world_free(from);
  return status;
}

static int lift(char **a) {
  scree_world *world = load(a[1]);
  lift_scene(world, strtod(a[0], NULL));
  return save(world, a[2]);
}

static int retime(char **a) {
  scree_world *from = load(a[1]);
  int status = save(retime_scene(from, strtod(a[0], NULL)), a[2]);
  scree_world_free(from);
  return status;
}

/* First line: radius of the cylinder, friction, restitution, number of shapes, number of bodies.
 * Shapes: mass, three moments of inertia, vertices, triangles; then these. Bodies: shape, position,
 * orientation w x y z. */
static void print_scene(const scree_world *world, FILE *out) {
  scree_particle *shapes[MOST_SHAPES];
  size_t bodies = scree_world_body_count(world), count = 0, index[MOST_SHAPES];
  for (size_t i = 0; i < bodies; i++) {
    size_t k = 0;
    while (k < count && shapes[k] != scree_world_body_particle(world, i)) k++;
    if (k < count || count == MOST_SHAPES) continue;
    index[count] = i;
    shapes[count++] = scree_world_body_particle(world, i);
  }
  scree_material material = scree_default_material();
  fprintf(out, "0.2 %g %g %zu %zu\n", material.friction, material.restitution, count, bodies);
  for (size_t k = 0; k < count; k++) {
    const scree_mesh *mesh = scree_particle_mesh(shapes[k]);
    scree_particle_measures m;
    scree_particle_measure(shapes[k], &m);
    double mass = scree_world_body_mass(world, index[k]), density = mass / m.volume;
    fprintf(out, "%.17g %.17g %.17g %.17g %zu %zu\n", mass, density * m.inertia[0],
            density * m.inertia[1], density * m.inertia[2], mesh->vertex_count,
            mesh->triangle_count);
    for (size_t v = 0; v < mesh->vertex_count; v++)
      fprintf(out, "%.9g %.9g %.9g\n", mesh->positions[3 * v], mesh->positions[3 * v + 1],
              mesh->positions[3 * v + 2]);
    for (size_t t = 0; t < mesh->triangle_count; t++)
      fprintf(out, "%u %u %u\n", mesh->triangles[3 * t], mesh->triangles[3 * t + 1],
              mesh->triangles[3 * t + 2]);
  }
  for (size_t i = 0; i < bodies; i++) {
    scree_body b;
    size_t k = 0;
    scree_world_get_body(world, i, &b);
    while (k + 1 < count && shapes[k] != scree_world_body_particle(world, i)) k++;
    fprintf(out, "%zu %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", k, b.position[0], b.position[1],
            b.position[2], b.orientation[0], b.orientation[1], b.orientation[2], b.orientation[3]);
  }
}

static int dump(char **a) {
  scree_world *world = load(a[0]);
  FILE *out = fopen(a[1], "w");
  if (!out) {
    perror(a[1]);
    return 1;
  }
  print_scene(world, out);
  scree_world_free(world);
  return fclose(out) ? 1 : 0;
}

static void print_line(const scree_world *world, const scree_timings *before, double wall,
                       double cpu) {
  scree_timings t;
  scree_observation o;
  scree_particle_measures m;
  struct rusage usage;
  scree_world_timings(world, &t);
  scree_world_observe(world, &o);
  scree_particle_measure(scree_world_body_particle(world, 0), &m);
  getrusage(RUSAGE_SELF, &usage);
  double steps = (double)(t.steps - before->steps), n = (double)o.body_count,
         total = t.total - before->total, lists = t.candidates - before->candidates;
  printf("%zu,%zu,%.4g,%.0f,%.3f,%.3f,%.0f,%.0f,", o.body_count, m.triangle_count,
         scree_world_time_step(world, NULL), steps, wall, cpu, n * steps / wall, n * steps / cpu);
  printf("%.1f,%.1f,%.1f,%.1f,", 100 * (t.broad - before->broad) / total, 100 * lists / total,
         100 * (t.contacts - before->contacts - lists) / total,
         100 * (t.bodies - before->bodies) / total);
  printf("%.2f,%.2f,%.2f,%.3f,%.3g,%.3g,%ld\n", (double)o.pair_count / n,
         (double)o.contact_count / n,
         (double)(t.feature_evaluations - before->feature_evaluations) / (n * steps),
         1000 * (double)(t.list_builds - before->list_builds) / (n * steps),
         o.kinetic + o.rotational, o.largest_overlap, usage.ru_maxrss * 1024);
}

static size_t at_once = 10; /* steps a call */

static int measure(char **a) {
  scree_error error;
  scree_set_threads(atoi(a[0]));
  double wanted = strtod(a[1], NULL), warm = 0.1 * wanted;
  scree_world *world = load(a[2]);
  scree_timings before;
  for (double start = seconds(CLOCK_MONOTONIC); seconds(CLOCK_MONOTONIC) - start < warm;)
    need(scree_world_step(world, at_once, &error), &error);
  scree_world_timings(world, &before);
  double wall = seconds(CLOCK_MONOTONIC), cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
  while (seconds(CLOCK_MONOTONIC) - wall < wanted)
    need(scree_world_step(world, at_once, &error), &error);
  print_line(world, &before, seconds(CLOCK_MONOTONIC) - wall,
             seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu);
  scree_world_free(world);
  return 0;
}

/* One of several worlds that are stepped at once. */
typedef struct lane {
  scree_world *world;
  double until; /* of the clock */
  size_t steps;
  pthread_t thread;
} lane;

static void *run_lane(void *context) {
  lane *l = context;
  scree_error error;
  for (; seconds(CLOCK_MONOTONIC) < l->until; l->steps += at_once)
    need(scree_world_step(l->world, at_once, &error), &error);
  return NULL;
}

/* Prints worlds, bodies of one, wall s and particle-steps per second of all. */
static int batch(char **a) {
  size_t count = strtoul(a[0], NULL, 10);
  double wanted = strtod(a[1], NULL), sum = 0, start = 0;
  lane *lanes = calloc(count, sizeof *lanes);
  scree_set_threads(1);
  for (size_t i = 0; i < count; i++) lanes[i].world = load(a[2]);
  for (int warm = 1; warm >= 0; warm--) {
    start = seconds(CLOCK_MONOTONIC);
    for (size_t i = 0; i < count; i++) {
      lanes[i].steps = 0;
      lanes[i].until = start + (warm ? 0.1 : 1) * wanted;
      pthread_create(&lanes[i].thread, NULL, run_lane, &lanes[i]);
    }
    for (size_t i = 0; i < count; i++) pthread_join(lanes[i].thread, NULL);
  }
  double wall = seconds(CLOCK_MONOTONIC) - start;
  size_t bodies = scree_world_body_count(lanes[0].world);
  for (size_t i = 0; i < count; i++) {
    sum += (double)(bodies * lanes[i].steps);
    scree_world_free(lanes[i].world);
  }
  printf("%zu,%zu,%.3f,%.0f\n", count, bodies, wall, sum / wall);
  free(lanes);
  return 0;
}

static int hash(char **a) {
  scree_error error;
  scree_set_threads(atoi(a[0]));
  scree_world *world = load(a[2]);
  need(scree_world_step(world, strtoul(a[1], NULL, 10), &error), &error);
  char text[SCREE_CHECKSUM_TEXT];
  scree_checksum_text(scree_world_hash(world), text);
  puts(text);
  scree_world_free(world);
  return 0;
}

int main(int argc, char **argv) {
  scree_error error;
  if (argc > 2 && strcmp(argv[1], "--backend") == 0) {
    need(scree_set_backend(argv[2], &error), &error);
    at_once = strcmp(argv[2], "cpu") ? 200 : at_once; /* between calls the state comes back */
    argv[2] = argv[0];
    argv += 2;
    argc -= 2;
  }
  static const struct {
    const char *name;
    int argument_count;
    int (*run)(char **arguments);
  } commands[] = {{"fill", 4, fill},   {"stack", 3, stack},   {"shelve", 4, shelve},
                  {"lift", 3, lift},   {"retime", 3, retime}, {"time", 3, measure},
                  {"batch", 3, batch}, {"hash", 3, hash},     {"dump", 2, dump}};
  for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
    if (argc == commands[i].argument_count + 2 && strcmp(argv[1], commands[i].name) == 0)
      return commands[i].run(argv + 2);
  fprintf(
      stderr,
      "usage: %s [--backend NAME] fill KIND TRIANGLES COUNT OUT | "
      "stack COPIES IN OUT | shelve COPIES SECONDS IN OUT | lift HEIGHT IN OUT | retime DT IN "
      "OUT | "
      "time THREADS SECONDS IN | batch WORLDS SECONDS IN | hash THREADS STEPS IN | dump IN OUT\n",
      argv[0]);
  return 2;
}
