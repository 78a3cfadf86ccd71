/* Reading and welding against what other programs take to load the same file, in one run.
 *
 *   read [FILE.stl]   without a file, a torus of 762,008 triangles is made
 *
 * For each: the median of wall and processor time over some rounds, and the ratio to scree's on one
 * thread. A peer that was not installed when this was built is named as missing. */
#define _DEFAULT_SOURCE
#include "scree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#ifdef BENCH_ADMESH
#include <admesh/stl.h>
#endif
#ifdef BENCH_ASSIMP
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#endif

enum { ROUNDS = 7 };

typedef size_t load_function(const char *path); /* answers the triangle count */

static size_t load_scree(const char *path) {
  scree_scan scan = {0};
  scree_error error;
  if (scree_scan_read(path, NULL, &scan, &error) != SCREE_OK) {
    fprintf(stderr, "%s\n", error.message);
    exit(1);
  }
  size_t count = scan.mesh.triangle_count;
  scree_scan_free(&scan);
  return count;
}

static size_t load_scree_alone(const char *path) {
  scree_set_threads(1);
  size_t count = load_scree(path);
  scree_set_threads(0);
  return count;
}

#ifdef BENCH_ADMESH
static size_t admesh_work(const char *path, int weld) {
  stl_file stl;
  char *name = strdup(path);
  stl_open(&stl, name);
  if (weld) {
    stl_check_facets_exact(&stl);
    stl_generate_shared_vertices(&stl);
  }
  size_t count = (size_t)stl.stats.number_of_facets;
  stl_close(&stl);
  free(name);
  return count;
}
static size_t load_admesh(const char *path) {
  return admesh_work(path, 0);
}
static size_t load_admesh_welded(const char *path) {
  return admesh_work(path, 1);
}
#else
#define load_admesh        NULL
#define load_admesh_welded NULL
#endif

#ifdef BENCH_ASSIMP
static size_t assimp_work(const char *path, unsigned flags) {
  const struct aiScene *scene = aiImportFile(path, flags);
  if (!scene) return 0;
  size_t count = 0;
  for (unsigned i = 0; i < scene->mNumMeshes; i++) count += scene->mMeshes[i]->mNumFaces;
  aiReleaseImport(scene);
  return count;
}
static size_t load_assimp(const char *path) {
  return assimp_work(path, 0);
}
static size_t load_assimp_welded(const char *path) {
  return assimp_work(path, aiProcess_JoinIdenticalVertices);
}
#else
#define load_assimp        NULL
#define load_assimp_welded NULL
#endif

static const struct {
  const char *name;
  load_function *load;
  int rounds;
} peers[] = {
    {"scree, read + weld, 1 thread", load_scree_alone, ROUNDS},
    {"scree, read + weld", load_scree, ROUNDS},
    {"admesh library, stl_open only", load_admesh, ROUNDS},
    {"admesh library, + exact connection, shared vertices", load_admesh_welded, 3},
    {"assimp, raw import", load_assimp, 3},
    {"assimp, + JoinIdenticalVertices", load_assimp_welded, 1},
};

static double clock_seconds(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *values, int count) {
  qsort(values, (size_t)count, sizeof *values, compare_doubles);
  return values[count / 2];
}

/* A torus as scanners write one: rows of facets, binary STL. */
static void make_torus(const char *path) {
  enum { AROUND = 884, ACROSS = 431 };
  scree_mesh mesh = {.vertex_count = (size_t)AROUND * ACROSS,
                     .triangle_count = (size_t)2 * AROUND * ACROSS};
  mesh.positions = malloc(mesh.vertex_count * 3 * sizeof *mesh.positions);
  mesh.triangles = malloc(mesh.triangle_count * 3 * sizeof *mesh.triangles);
  if (!mesh.positions || !mesh.triangles) exit(1);
  const double turn = 6.283185307179586;
  for (size_t i = 0; i < AROUND; i++)
    for (size_t j = 0; j < ACROSS; j++) {
      double u = turn * (double)i / AROUND, v = turn * (double)j / ACROSS,
             rough = 10 + 0.01 * sin(97 * u + 61 * v), radius = 30 + rough * cos(v);
      double *p = mesh.positions + 3 * (i * ACROSS + j);
      p[0] = 1e-3 * radius * cos(u);
      p[1] = 1e-3 * radius * sin(u);
      p[2] = 1e-3 * rough * sin(v);
      size_t next_i = (i + 1) % AROUND, next_j = (j + 1) % ACROSS;
      uint32_t a = (uint32_t)(i * ACROSS + j), b = (uint32_t)(next_i * ACROSS + j),
               c = (uint32_t)(next_i * ACROSS + next_j), d = (uint32_t)(i * ACROSS + next_j);
      uint32_t corners[6] = {a, b, c, a, c, d};
      memcpy(mesh.triangles + 6 * (i * ACROSS + j), corners, sizeof corners);
    }
  scree_write_options options = scree_default_write_options();
  options.overwrite = true;
  options.format = SCREE_FORMAT_STL;
  scree_error error;
  if (scree_mesh_write(&mesh, path, &options, &error) != SCREE_OK) {
    fprintf(stderr, "%s\n", error.message);
    exit(1);
  }
  free(mesh.positions);
  free(mesh.triangles);
}

int main(int argument_count, char **arguments) {
  char made[] = "/tmp/scree-bench-XXXXXX.stl";
  const char *path = arguments[1];
  if (argument_count < 2) {
    int fd = mkstemps(made, 4);
    if (fd < 0) return 1;
    close(fd);
    make_torus(path = made);
  }
  printf("%-52s %10s %9s %9s %7s\n", argument_count < 2 ? "torus" : path, "triangles", "wall ms",
         "cpu ms", "ratio");
  double base = 0;
  for (size_t i = 0; i < sizeof peers / sizeof *peers; i++) {
    if (!peers[i].load) {
      printf("%-52s not in this build\n", peers[i].name);
      continue;
    }
    double wall[ROUNDS], cpu[ROUNDS];
    size_t count = 0;
    for (int r = 0; r < peers[i].rounds; r++) {
      double wall_start = clock_seconds(CLOCK_MONOTONIC),
             cpu_start = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
      count = peers[i].load(path);
      wall[r] = clock_seconds(CLOCK_MONOTONIC) - wall_start;
      cpu[r] = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_start;
    }
    double wall_ms = 1e3 * median(wall, peers[i].rounds),
           cpu_ms = 1e3 * median(cpu, peers[i].rounds);
    if (i == 0) base = cpu_ms;
    printf("%-52s %10zu %9.1f %9.1f %7.2f\n", peers[i].name, count, wall_ms, cpu_ms, cpu_ms / base);
  }
  if (path == made) unlink(made);
  return 0;
}
