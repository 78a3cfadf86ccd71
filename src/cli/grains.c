#include "cli/grains.h"

#include "cli/clump.h"
#include "cli/clump_surface.h"
#include "cli/surface.h"
#include "cli/terminal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SPHERES = 300 };

/* "1e-4", "recommended" or "clump:20" as one level more; false where it is neither, or there is
 * that already. */
static bool add_level(const char *word, cli_grain_options *o) {
  static const char prefix[] = "clump:";
  bool clump = !strncmp(word, prefix, sizeof prefix - 1);
  bool recommended = !strcmp(word, "recommended");
  double value = CLI_RECOMMENDED;
  if (!recommended && !cli_fraction_from_text(word + (clump ? sizeof prefix - 1 : 0), &value))
    return false;
  if (clump ? !(value >= 1 && value <= MOST_SPHERES && value == floor(value))
            : !recommended && !(value > 0 && value <= 1))
    return false;
  size_t spheres = clump ? (size_t)value : 0;
  for (size_t i = 0; i < o->rp_count; i++)
    if (o->clump[i] == spheres && (clump || o->rp[i] == value)) return false;
  o->rp[o->rp_count] = clump ? 1 : value;
  o->clump[o->rp_count++] = spheres;
  return true;
}

bool cli_parse_levels(const char *text, cli_grain_options *options) {
  options->rp_count = 0;
  while (*text) {
    char word[32];
    size_t length = strcspn(text, ",");
    if (length == 0 || length >= sizeof word || options->rp_count == CLI_MOST_LEVELS) return false;
    memcpy(word, text, length);
    word[length] = 0;
    if (!add_level(word, options)) return false;
    text += length;
    if (*text == ',' && !*++text) return false;
  }
  return options->rp_count > 0;
}

size_t cli_level_count(const cli_grain_options *o) {
  if (o->rp_count) return o->rp_count + o->spheres;
  return 1; /* spheres alone, or as given */
}

static bool is_sphere_level(const cli_grain_options *o, size_t level) {
  return o->spheres && level == o->rp_count;
}

void cli_level_name(const cli_grain_options *o, size_t level, char *buffer, size_t size) {
  if (is_sphere_level(o, level))
    snprintf(buffer, size, "spheres");
  else if (o->rp_count && o->clump[level])
    snprintf(buffer, size, "clump-%zu", o->clump[level]);
  else if (o->rp_count && o->rp[level] == CLI_RECOMMENDED)
    snprintf(buffer, size, "recommended");
  else if (o->rp_count)
    snprintf(buffer, size, "rp-%g", o->rp[level]);
  else
    snprintf(buffer, size, "as-given");
}

void cli_grains_free(cli_grains *g) {
  for (size_t i = 0; g->grains && i < g->shape_count * g->level_count; i++)
    scree_grain_free(&g->grains[i]);
  free(g->grains);
  free(g->shapes);
  free(g->texts);
  *g = (cli_grains){0};
}

typedef struct maker {
  const cli_grain_options *options;
  const scree_progress *progress;
  cli_grains *grains;
  scree_error *error;
} maker;

/* Name and source of a grain, and the grain among the run's shapes. */
static void describe(const maker *m, const char *word, const scree_scan *scan, size_t index) {
  cli_grains *g = m->grains;
  const scree_grain *grain = &g->grains[index];
  char *name = g->texts[2 * index], *source = g->texts[2 * index + 1], level[32];
  char checksum[SCREE_CHECKSUM_TEXT];
  cli_level_name(m->options, index / g->shape_count, level, sizeof level);
  cli_short_name(word, name, 64);
  int used = snprintf(source, sizeof *g->texts, "%.180s", word);
  if (scan && scree_checksum_text(scan->checksum, checksum))
    used += snprintf(source + used, sizeof *g->texts - (size_t)used, ", %s", checksum);
  if (scan)
    snprintf(source + used, sizeof *g->texts - (size_t)used, ", %zu triangles, %s, %s",
             grain->scan_triangle_count, level,
             scree_method_name((scree_method)m->options->method));
  g->shapes[index] = grain->run;
  g->shapes[index].name = name;
  g->shapes[index].source = source;
}

/* ---- scans ---- */

/* Of a scan of so many triangles, at that level: may be CLI_RECOMMENDED. */
static double level_rp(const cli_grain_options *o, size_t level, size_t triangle_count) {
  bool dense = triangle_count > SCREE_DENSE_SCAN;
  if (is_sphere_level(o, level)) return 1;
  if (!o->rp_count) return dense ? CLI_RECOMMENDED : 1;
  if (!o->clump[level]) return o->rp[level];
  return fmin(1, SCREE_CLUMP_TRIANGLES / (double)triangle_count);
}

static double smallest_rp(const cli_grain_options *o, size_t triangle_count) {
  double least = 1;
  for (size_t i = 0; i < cli_level_count(o); i++)
    least = fmin(least, level_rp(o, i, triangle_count));
  return least;
}

/* The Rp that is recommended; said where it was not asked for. */
static scree_status recommended_rp(const maker *m, const char *word, const scree_curve *curve,
                                   const scree_mesh *mesh, double *rp) {
  size_t index;
  scree_level level;
  char shown[CLI_PRINTABLE_BYTES];
  scree_status status = cli_recommended_level(curve, mesh, m->progress, &index, m->error);
  if (status != SCREE_OK) return status;
  scree_curve_level(curve, index, &level);
  *rp = level.rp;
  cli_terminal_end();
  if (!m->options->rp_count && !m->options->quiet)
    fprintf(stderr, "%s: %zu of %zu triangles, as choose recommends (--rp 1: all)\n",
            cli_printable(word, shown), level.triangle_count, mesh->triangle_count);
  return SCREE_OK;
}

/* The scan is in metres once it is multiplied by the scale: where it is decimated, after that. */
static scree_status make_levels(const maker *m, size_t shape, const char *word, scree_scan *scan,
                                double scale) {
  const cli_grain_options *o = m->options;
  scree_mesh *mesh = &scan->mesh;
  scree_curve *curve = NULL;
  scree_status status = SCREE_OK;
  double least = smallest_rp(o, mesh->triangle_count), recommended = 1;
  if (least < 1) {
    scree_simplify_options simplify = scree_default_simplify_options();
    simplify.method = (scree_method)o->method;
    if (least > CLI_RECOMMENDED)
      simplify.stop_count = scree_choice_target(least, mesh->triangle_count);
    status = scree_curve_build_scaled(mesh, scale, &simplify, m->progress, &curve, m->error);
  }
  if (status == SCREE_OK && least == CLI_RECOMMENDED)
    status = recommended_rp(m, word, curve, mesh, &recommended);
  for (size_t level = 0; status == SCREE_OK && level < m->grains->level_count; level++) {
    scree_grain_options grain = scree_default_grain_options();
    size_t index = level * m->grains->shape_count + shape;
    grain.sphere = is_sphere_level(o, level);
    grain.rp = level_rp(o, level, mesh->triangle_count);
    if (grain.rp == CLI_RECOMMENDED) grain.rp = recommended;
    if (o->rp_count && !grain.sphere) grain.clump = o->clump[level];
    grain.mass_rule = o->mass_rule;
    if (!grain.sphere && (double)mesh->triangle_count * grain.rp > CLI_LARGEST_GRAIN) {
      char what[160];
      snprintf(what, sizeof what,
               "%.0f triangles are too many for a particle (at most %d): give --rp, or decimate "
               "first (scree choose, scree simplify)",
               (double)mesh->triangle_count * grain.rp, CLI_LARGEST_GRAIN);
      status = cli_refuse(m->error, SCREE_LIMIT, word, what);
      break;
    }
    status =
        scree_grain_make(mesh, curve, &grain, m->progress, &m->grains->grains[index], m->error);
    if (status == SCREE_OK) describe(m, word, scan, index);
  }
  scree_curve_free(curve);
  return status;
}

static scree_status make_from_scan(const maker *m, size_t shape, const char *word) {
  cli_input_options input = cli_source_options(&m->options->source);
  scree_scan scan;
  double scale = 1;
  scree_status status = cli_load_closed(word, &input, m->options->no_repair, m->progress, &scan,
                                        &scale, NULL, m->error);
  if (status != SCREE_OK) return status;
  if (smallest_rp(m->options, scan.mesh.triangle_count) == 1)
    status = cli_into_metres(word, &input, m->options->no_repair, scale, m->progress, &scan.mesh,
                             m->error);
  if (status == SCREE_OK) status = make_levels(m, shape, word, &scan, scale);
  scree_scan_free(&scan);
  return status == SCREE_OK ? status : cli_name_in_error(word, m->error);
}

/* ---- clumps ---- */

static scree_status make_from_clump(const maker *m, size_t shape, const char *word) {
  cli_input_options input = cli_source_options(&m->options->source);
  scree_status status = SCREE_OK;
  for (size_t level = 0; status == SCREE_OK && level < m->grains->level_count; level++) {
    size_t index = level * m->grains->shape_count + shape;
    scree_grain *grain = &m->grains->grains[index];
    scree_particle_measures measures;
    status = scree_particle_clump_read(word, &input.read, &grain->run.particle, m->error);
    if (status != SCREE_OK) return status;
    scree_particle_measure(grain->run.particle, &measures);
    grain->run.density_factor = 1;
    grain->scan_volume = grain->volume = measures.volume;
    if (is_sphere_level(m->options, level)) {
      scree_particle_free(grain->run.particle);
      status = scree_particle_sphere(0.5 * measures.size, &grain->run.particle, m->error);
    }
    if (status == SCREE_OK) describe(m, word, NULL, index);
  }
  return status == SCREE_OK ? status : cli_name_in_error(word, m->error);
}

scree_status cli_make_grains(const char *const *words, size_t count,
                             const cli_grain_options *options, const scree_progress *progress,
                             cli_grains *grains, scree_error *error) {
  size_t levels = cli_level_count(options), all = levels * count;
  *grains =
      (cli_grains){count, levels, calloc(all, sizeof *grains->grains),
                   calloc(all, sizeof *grains->shapes), calloc(2 * all, sizeof *grains->texts)};
  maker m = {options, progress, grains, error};
  scree_status status = SCREE_OK;
  if (!grains->grains || !grains->shapes || !grains->texts) {
    cli_grains_free(grains);
    return cli_refuse(error, SCREE_OUT_OF_MEMORY, "shapes", "out of memory");
  }
  for (size_t i = 0; status == SCREE_OK && i < count; i++)
    status =
        cli_is_clump(words[i]) ? make_from_clump(&m, i, words[i]) : make_from_scan(&m, i, words[i]);
  if (status != SCREE_OK) cli_grains_free(grains);
  return status;
}
