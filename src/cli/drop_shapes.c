/* The shapes of `scree drop`: words to particles. */
#include "base/platform.h"
#include "cli/clump.h"
#include "cli/drop.h"
#include "cli/surface.h"

#include <stdlib.h>
#include <string.h>

static const char sphere_prefix[] = "sphere:";

scree_status drop_no_memory(scree_error *error) {
  *error = (scree_error){SCREE_OUT_OF_MEMORY, "out of memory"};
  return SCREE_OUT_OF_MEMORY;
}

static bool is_sphere(const char *name) {
  return !strncmp(name, sphere_prefix, sizeof sphere_prefix - 1);
}

/* A shape by its name alone. */
static bool is_known(const char *name) {
  return cli_is_sample(name, NULL) || is_sphere(name) || scree_path_exists(name);
}

/* "phone.stl=30": the name, and the count behind the last '='. A file may have a name like that. */
static int read_count(const drop_run *run, drop_shape *shape) {
  const char *equals = strrchr(shape->word, '='), *digits = equals ? equals + 1 : "";
  bool counted = *digits && digits[strspn(digits, "0123456789")] == 0;
  size_t length = equals ? (size_t)(equals - shape->word) : strlen(shape->word);
  shape->count = run->arguments->particles;
  if (length == 0 || strlen(shape->word) >= sizeof shape->name)
    return cli_misuse(run->call->verb, "'%.40s': not a name", shape->word);
  memcpy(shape->name, shape->word, length);
  shape->name[length] = 0;
  if (equals && !counted && (scree_path_exists(shape->word) || !is_known(shape->name))) {
    memcpy(shape->name, shape->word, strlen(shape->word) + 1);
    return 0;
  }
  if (!equals) return 0;
  double count = counted ? strtod(digits, NULL) : 0;
  if (!(count >= 1 && count <= 1e7))
    return cli_misuse(run->call->verb,
                      "%s: the count behind '=' must be a whole number from 1 to 10000000",
                      shape->word);
  shape->count = (size_t)count;
  return 0;
}

static int read_sphere(const drop_run *run, drop_shape *shape) {
  if (!is_sphere(shape->name)) return 0;
  const char *text = shape->name + sizeof sphere_prefix - 1;
  char number[32];
  size_t length = strspn(text, "0123456789.eE+-");
  double value = 0, unit = 0;
  if (length < sizeof number) {
    memcpy(number, text, length);
    number[length] = 0;
    if (!cli_real_from_text(number, &value)) value = 0;
  }
  if (!(value > 0) || !cli_unit_from_text(text + length, &unit))
    return cli_misuse(run->call->verb, "%s: not a sphere such as sphere:40mm", shape->word);
  shape->diameter = value * unit;
  return 0;
}

int drop_read_words(drop_run *run) {
  for (size_t i = 0; i < run->shape_count; i++) {
    drop_shape *shape = &run->shapes[i];
    shape->word = run->call->inputs[i];
    int code = read_count(run, shape);
    if (code == 0) code = read_sphere(run, shape);
    if (code) return code;
  }
  return 0;
}

/* Where the shape came from: file, checksum, triangles before. */
static void describe(drop_shape *shape, const scree_scan *scan) {
  char checksum[SCREE_CHECKSUM_TEXT];
  size_t size = sizeof shape->source;
  cli_short_name(shape->name, shape->title, sizeof shape->title);
  size_t used = (size_t)snprintf(shape->source, size, "%.300s", shape->name);
  if (scan && scree_checksum_text(scan->checksum, checksum))
    used += (size_t)snprintf(shape->source + used, size - used, ", %s", checksum);
  if (scan)
    snprintf(shape->source + used, size - used, ", %zu triangles", scan->mesh.triangle_count);
}

static scree_status load(const drop_run *run, drop_shape *shape, scree_mesh *mesh, double *scale,
                         scree_error *error) {
  cli_input_options input = cli_source_options(&run->arguments->source);
  scree_repair_report report;
  scree_scan scan;
  char shown[CLI_PRINTABLE_BYTES];
  scree_status status = cli_load_closed(shape->name, &input, run->arguments->no_repair,
                                        run->call->progress, &scan, scale, &report, error);
  if (status != SCREE_OK) return status;
  describe(shape, &scan);
  *mesh = scan.mesh;
  if (!report.before.usable && !run->call->quiet)
    fprintf(stderr, "%s: repaired: it was %s\n", cli_printable(shape->name, shown),
            report.before.verdict);
  return SCREE_OK;
}

/* The level asked for; of a large scan, where none is asked for, the one that `choose` recommends,
 * or what a clump is fitted to. */
static scree_status pick_level(const drop_run *run, const scree_curve *curve,
                               const scree_mesh *mesh, size_t *level, scree_error *error) {
  const drop_arguments *a = run->arguments;
  if (a->rp > 0 || a->triangles) {
    size_t target = a->rp > 0 ? scree_choice_target(a->rp, mesh->triangle_count) : a->triangles;
    *level = scree_curve_find(curve, target);
    return SCREE_OK;
  }
  if (a->clump) {
    *level = scree_curve_find(curve, SCREE_CLUMP_TRIANGLES);
    return SCREE_OK;
  }
  return cli_recommended_level(curve, mesh, run->call->progress, level, error);
}

static bool is_small(const drop_arguments *a, const scree_mesh *mesh) {
  bool asked = a->rp > 0 || a->triangles;
  if (!asked && mesh->triangle_count <= SCREE_DENSE_SCAN) return true;
  return a->triangles && mesh->triangle_count <= a->triangles;
}

/* Into metres as well. */
static scree_status decimate(const drop_run *run, const drop_shape *shape, scree_mesh *mesh,
                             double scale, scree_error *error) {
  if (is_small(run->arguments, mesh)) {
    cli_input_options input = cli_source_options(&run->arguments->source);
    return cli_into_metres(shape->name, &input, run->arguments->no_repair, scale,
                           run->call->progress, mesh, error);
  }
  scree_simplify_options options = scree_default_simplify_options();
  scree_curve *curve = NULL;
  scree_mesh level_mesh;
  size_t level;
  scree_status status =
      scree_curve_build_scaled(mesh, scale, &options, run->call->progress, &curve, error);
  if (status == SCREE_OK) status = pick_level(run, curve, mesh, &level, error);
  if (status == SCREE_OK) status = scree_curve_mesh(curve, level, &level_mesh, error);
  scree_curve_free(curve);
  if (status != SCREE_OK) return status;
  scree_mesh_free(mesh);
  *mesh = level_mesh;
  return SCREE_OK;
}

static void say_shape(const drop_run *run, const drop_shape *shape) {
  scree_particle_measures m;
  char shown[CLI_PRINTABLE_BYTES];
  scree_particle_measure(shape->particle, &m);
  if (run->call->quiet) return;
  cli_print_cell(stdout, cli_printable(shape->name, shown), 24, SIZE_MAX);
  if (shape->diameter > 0) {
    printf(" %6zu  sphere of %.4g mm\n", shape->count, 1e3 * shape->diameter);
    return;
  }
  if (m.kind == SCREE_PARTICLE_CLUMP) {
    printf(" %6zu  clump of %zu sphere%s, size %.3g mm, %.4g g\n", shape->count, m.point_count,
           cli_plural(m.point_count), 1e3 * m.size, 1e3 * m.volume * run->arguments->density);
    return;
  }
  printf(" %6zu  %zu triangles", shape->count, m.triangle_count);
  if (m.triangle_count < shape->source_triangles) printf(" of %zu", shape->source_triangles);
  printf(", size %.3g mm, %.4g g, thinnest wall %.2g mm\n", 1e3 * m.size,
         1e3 * m.volume * run->arguments->density, 1e3 * m.thickness);
}

static scree_status make_particle(const drop_run *run, drop_shape *shape, scree_error *error) {
  describe(shape, NULL);
  if (shape->diameter > 0)
    return scree_particle_sphere(0.5 * shape->diameter, &shape->particle, error);
  if (cli_is_clump(shape->name)) {
    cli_input_options input = cli_source_options(&run->arguments->source);
    return scree_particle_clump_read(shape->name, &input.read, &shape->particle, error);
  }
  scree_mesh mesh;
  double scale;
  scree_status status = load(run, shape, &mesh, &scale, error);
  if (status != SCREE_OK) return status;
  shape->source_triangles = mesh.triangle_count;
  status = decimate(run, shape, &mesh, scale, error);
  if (status == SCREE_OK) status = scree_mesh_canonicalize(&mesh, error);
  size_t spheres = run->arguments->clump;
  if (status == SCREE_OK)
    status = spheres ? scree_clump_fit(&mesh, spheres, run->call->progress, &shape->particle, error)
                     : scree_particle_from_mesh(&mesh, NULL, &shape->particle, error);
  scree_mesh_free(&mesh);
  return status == SCREE_OK ? SCREE_OK : cli_name_in_error(shape->name, error);
}

scree_status drop_make_particles(drop_run *run, scree_error *error) {
  for (size_t i = 0; i < run->shape_count; i++) {
    scree_status status = make_particle(run, &run->shapes[i], error);
    if (status != SCREE_OK) return status;
    say_shape(run, &run->shapes[i]);
  }
  return SCREE_OK;
}
