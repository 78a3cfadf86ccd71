/* scree's own levels, as a peer writes them:
 *
 *   bench_levels METHOD INPUT PREFIX COUNT...      METHOD: volume, qecd, or fit: volume's, fitted
 *
 * One run gives all levels: PREFIX_COUNT.ply in the file's unit, and per level one line
 *   METHOD,count asked,count got,CPU seconds,peak bytes,file
 * where the seconds (user and system, all threads) are those of the whole curve with the first
 * level and of rebuilding, fitting and writing one with each, and the bytes are the library's peak
 * less the mesh's. */
#include <scree.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double cpu_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int descending(const void *a, const void *b) {
  const size_t x = *(const size_t *)a, y = *(const size_t *)b;
  return (x < y) - (x > y);
}

/* The level goes to the path; its triangles are counted. */
static scree_status write_level(const scree_curve *curve, bool fit, size_t index, const char *path,
                                size_t *triangle_count, scree_error *error) {
  scree_write_options options = scree_default_write_options();
  scree_mesh mesh;
  options.overwrite = true;
  options.unit_m = 1;
  scree_status status = fit ? scree_curve_fit(curve, index, &mesh, error)
                            : scree_curve_mesh(curve, index, &mesh, error);
  if (status != SCREE_OK) return status;
  *triangle_count = mesh.triangle_count;
  status = scree_mesh_write(&mesh, path, &options, error);
  scree_mesh_free(&mesh);
  return status;
}

static scree_status write_levels(const scree_curve *curve, const char *method, const char *prefix,
                                 const size_t *counts, size_t count_count, double seconds,
                                 size_t peak, scree_error *error) {
  const bool fit = !strcmp(method, "fit");
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < count_count; i++) {
    char path[4096];
    size_t got;
    snprintf(path, sizeof path, "%s_%zu.ply", prefix, counts[i]);
    const double started = cpu_seconds();
    status = write_level(curve, fit, scree_curve_find(curve, counts[i]), path, &got, error);
    if (status != SCREE_OK) break;
    seconds = (i > 0 ? 0 : seconds) + cpu_seconds() - started;
    printf("%s,%zu,%zu,%.4f,%zu,%s\n", method, counts[i], got, seconds, peak, path);
  }
  return status;
}

static scree_status run(char **argv, const size_t *counts, size_t count_count, scree_error *error) {
  scree_read_options read = scree_default_read_options();
  scree_simplify_options options = scree_default_simplify_options();
  scree_scan scan;
  scree_curve *curve = NULL;
  options.method = strcmp(argv[1], "qecd") ? SCREE_METHOD_VOLUME : SCREE_METHOD_QECD;
  read.unit_m = 1;
  scree_status status = scree_scan_read(argv[2], &read, &scan, error);
  if (status != SCREE_OK) return status;
  scree_reset_memory_peak();
  const size_t held = scree_memory_used();
  const double started = cpu_seconds();
  status = scree_curve_build(&scan.mesh, &options, NULL, &curve, error);
  if (status == SCREE_OK)
    status = write_levels(curve, argv[1], argv[3], counts, count_count, cpu_seconds() - started,
                          scree_memory_peak() - held, error);
  scree_curve_free(curve);
  scree_scan_free(&scan);
  return status;
}

int main(int argc, char **argv) {
  size_t counts[64];
  if (argc < 5 || argc > 4 + 64) {
    fprintf(stderr, "usage: %s volume|qecd|fit INPUT PREFIX COUNT...\n", argv[0]);
    return 2;
  }
  for (int i = 4; i < argc; i++) counts[i - 4] = strtoull(argv[i], NULL, 10);
  qsort(counts, (size_t)argc - 4, sizeof *counts, descending);
  scree_error error;
  if (run(argv, counts, (size_t)argc - 4, &error) == SCREE_OK) return 0;
  fprintf(stderr, "%s\n", error.message);
  return 1;
}
