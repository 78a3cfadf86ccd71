/* What a scene costs beside another one:
 *
 *   bench_scene settle SECONDS FILE A    runs FILE up to that time; from A, where that is there
 *   bench_scene turns ROUNDS STEPS A B   advances A and B by STEPS in turns, on one thread
 *   bench_scene memory STEPS A           loads A and advances it
 *
 * A and B are checkpoints of scenes. `turns` prints, a line for each round, the processor time of A
 * and of B in s per step; `memory` prints the bodies inside, the bytes that the library holds,
 * the most that it held and the most that the process did. */
#include "scree.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

enum { SETTLE_STEPS = 500 }; /* between checkpoints */

static void need(scree_status status, const scree_error *error) {
  if (status == SCREE_OK) return;
  fprintf(stderr, "bench_scene: %s\n", error->message);
  exit(1);
}

static double processor_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static scree_scene *load(const char *path) {
  scree_error error;
  scree_scene *scene;
  need(scree_scene_load(path, &scene, &error), &error);
  return scene;
}

/* s of the processor per step. */
static double advance(scree_scene *scene, size_t steps) {
  scree_error error;
  double start = processor_seconds();
  need(scree_scene_advance(scene, steps, &error), &error);
  if (scree_scene_end(scene)) {
    fprintf(stderr, "bench_scene: a scene ended: %s\n", scree_scene_end(scene));
    exit(1);
  }
  return (processor_seconds() - start) / (double)steps;
}

static scree_scene *begin(const char *file, const char *path) {
  scree_error error;
  scree_scene_file *read;
  scree_scene *scene;
  if (scree_scene_load(path, &scene, &error) == SCREE_OK) return scene;
  need(scree_scene_file_read(file, &read, &error), &error);
  need(scree_scene_create(read, NULL, &scene, &error), &error);
  scree_scene_file_free(read);
  return scene;
}

static int settle(double seconds, const char *file, const char *path) {
  scree_error error;
  scree_scene *scene = begin(file, path);
  while (scree_world_time(scree_scene_view(scene)) < seconds) {
    advance(scene, SETTLE_STEPS);
    need(scree_scene_save(scene, path, true, &error), &error);
  }
  scree_scene_free(scene);
  return 0;
}

static int turns(size_t rounds, size_t steps, const char *a, const char *b) {
  scree_scene *first = load(a), *second = load(b);
  advance(first, steps), advance(second, steps); /* to warm up */
  for (size_t i = 0; i < rounds; i++) {
    double of_first = advance(first, steps);
    printf("%.6g %.6g\n", of_first, advance(second, steps));
  }
  scree_scene_free(first);
  scree_scene_free(second);
  return 0;
}

static int memory(size_t steps, const char *path) {
  scree_scene *scene = load(path);
  scree_scene_book book;
  struct rusage usage;
  advance(scene, steps);
  scree_scene_get_book(scene, &book);
  getrusage(RUSAGE_SELF, &usage);
  printf("%zu %zu %zu %ld\n", book.inside_count, scree_memory_used(), scree_memory_peak(),
         usage.ru_maxrss * 1024);
  scree_scene_free(scene);
  return 0;
}

int main(int argc, char **argv) {
  scree_set_threads(1);
  if (argc == 5 && !strcmp(argv[1], "settle"))
    return settle(strtod(argv[2], NULL), argv[3], argv[4]);
  if (argc == 6 && !strcmp(argv[1], "turns"))
    return turns(strtoul(argv[2], NULL, 10), strtoul(argv[3], NULL, 10), argv[4], argv[5]);
  if (argc == 4 && !strcmp(argv[1], "memory")) return memory(strtoul(argv[2], NULL, 10), argv[3]);
  fprintf(stderr,
          "usage: bench_scene settle SECONDS FILE A | turns ROUNDS STEPS A B | memory STEPS A\n");
  return 2;
}
