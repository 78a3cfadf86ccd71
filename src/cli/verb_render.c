#include "base/number.h"
#include "base/radix.h"
#include "cli/input.h"
#include "cli/output.h"
#include "cli/render_refine.h"
#include "cli/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LEVELS = 32 };
static const double RECOMMENDED = 0; /* in place of an Rp */

typedef struct render_arguments {
  const char *output, *size, *reference, *levels;
  cli_source source;
  double azimuth_deg, elevation_deg;
  size_t rays, columns;
  int view, color_by;
  bool edges, wire, no_ground, no_captions, overwrite;
} render_arguments;

static const render_arguments defaults = {.size = "1200x900",
                                          .source = CLI_SOURCE_DEFAULTS,
                                          .azimuth_deg = NAN, /* the view's */
                                          .elevation_deg = NAN,
                                          .rays = 24};

#define AT(field) offsetof(render_arguments, field)
static const cli_option options[] = {
    {"output", CLI_TEXT, AT(output), "FILE", "The PNG to write (required); - is stdout.", 0, 0,
     NULL},
    {"size", CLI_TEXT, AT(size), "WxH", "Size in pixels. Default: 1200x900.", 0, 0, NULL},
    {"from", CLI_CHOICE, AT(view), "SIDE",
     "Seen from: oblique, front (against -y), back, left, right, top or bottom. Default: oblique.",
     0, 0, "oblique|front|back|left|right|top|bottom"},
    {"azimuth", CLI_REAL, AT(azimuth_deg), "DEG",
     "The camera's angle about the vertical. Default: the view's; 35 of oblique.", -360, 360, NULL},
    {"elevation", CLI_REAL, AT(elevation_deg), "DEG",
     "The camera's angle above the horizontal. Default: the view's; 25 of oblique.", -90, 90, NULL},
    {"rays", CLI_COUNT, AT(rays), "N", "Rays a pixel: more is smoother and slower. Default: 24.", 1,
     65536, NULL},
    {"columns", CLI_COUNT, AT(columns), "N", "Columns of views. Default: what makes them largest.",
     1, 1000, NULL},
    {"edges", CLI_FLAG, AT(edges), NULL, "Draw the edges of the triangles.", 0, 0, NULL},
    {"wire", CLI_FLAG, AT(wire), NULL, "Draw only the edges.", 0, 0, NULL},
    {"rp", CLI_TEXT, AT(levels), "LIST",
     "Of one surface: also its levels at these Rp (0 < RP <= 1, or recommended) by the decimation "
     "of choose.",
     0, 0, NULL},
    {"color-by", CLI_CHOICE, AT(color_by), "WHAT",
     "plain, or distance: to the first surface, or to the one of --reference, with a scale bar; "
     "all over the triangles, or with --edges and --wire between their corners. Default: plain.",
     0, 0, "plain|distance"},
    {"reference", CLI_FILE, AT(reference), "FILE", "Colour by the distance to the surface in FILE.",
     0, 0, NULL},
    {"no-ground", CLI_FLAG, AT(no_ground), NULL, "No floor and no shadow on it.", 0, 0, NULL},
    {"no-captions", CLI_FLAG, AT(no_captions), NULL,
     "No file name and triangle count below each view.", 0, 0, NULL},
    CLI_SOURCE_OPTIONS(render_arguments),
    {"force", CLI_FLAG, AT(overwrite), NULL, "Overwrite an existing file.", 0, 0, NULL},
};

typedef struct picture {
  size_t count;
  scree_scan *scans;
  double **distances; /* per scan, or NULL */
  scree_render_item *items;
  scree_render_cell *cells;
  char (*captions)[160];
} picture;

static void free_picture(picture *p) {
  for (size_t i = 0; i < p->count; i++) {
    if (p->scans) scree_scan_free(&p->scans[i]);
    if (p->distances) free(p->distances[i]);
  }
  free(p->scans);
  free(p->distances);
  free(p->items);
  free(p->cells);
  free(p->captions);
}

static bool allocate_picture(picture *p, size_t count) {
  *p = (picture){count,
                 calloc(count, sizeof *p->scans),
                 calloc(count, sizeof *p->distances),
                 calloc(count, sizeof *p->items),
                 calloc(count, sizeof *p->cells),
                 calloc(count, sizeof *p->captions)};
  return p->scans && p->distances && p->items && p->cells && p->captions;
}

static scree_status fail_memory(scree_error *error) {
  return scree_fail_memory(error, 0, "the picture");
}

static void put_cell(picture *p, size_t i, const char *name) {
  char count[32];
  snprintf(p->captions[i], sizeof p->captions[i], "%s: %s triangles", name,
           scree_count_text(p->scans[i].mesh.triangle_count, count));
  p->items[i] = (scree_render_item){.mesh = &p->scans[i].mesh, .color = {0.34f, 0.46f, 0.60f}};
  p->cells[i] = (scree_render_cell){&p->items[i], 1, p->captions[i]};
}

static void put_input(picture *p, size_t i, const char *word) {
  char name[96];
  cli_short_name(word, name, sizeof name);
  put_cell(p, i, name);
}

static scree_status read_one(picture *p, size_t i, const char *word, const cli_source *source,
                             const scree_progress *progress, scree_error *error) {
  cli_input_options input = cli_source_options(source);
  SCREE_TRY(cli_load(word, &input, progress, &p->scans[i], error));
  put_input(p, i, word);
  return SCREE_OK;
}

static scree_status make_level(picture *p, size_t i, double rp, const scree_curve *curve,
                               const scree_progress *progress, scree_error *error) {
  scree_mesh *scan = &p->scans[0].mesh, *mesh = &p->scans[i].mesh;
  bool recommended = rp == RECOMMENDED;
  size_t target = recommended ? 0 : scree_choice_target(rp, scan->triangle_count), level;
  if (recommended)
    SCREE_TRY(cli_recommended_level(curve, scan, progress, &level, error));
  else
    level = scree_curve_find(curve, target);
  SCREE_TRY(scree_curve_mesh(curve, level, mesh, error));
  char name[96] = "recommended";
  if (!recommended) snprintf(name, sizeof name, "Rp = %g", rp);
  put_cell(p, i, name);
  size_t used = strlen(p->captions[i]);
  if (!recommended && mesh->triangle_count > target)
    snprintf(p->captions[i] + used, sizeof p->captions[i] - used, ", not fewer");
  return SCREE_OK;
}

/* Levels of the first surface become the surfaces behind it. */
static scree_status make_levels(picture *p, const double *rp, double scale,
                                const scree_progress *progress, scree_error *error) {
  scree_curve *curve = NULL;
  scree_simplify_options simplify = scree_default_simplify_options();
  scree_mesh *scan = &p->scans[0].mesh;
  scree_status status = scree_curve_build_scaled(scan, scale, &simplify, progress, &curve, error);
  for (size_t i = 1; i < p->count && status == SCREE_OK; i++)
    status = make_level(p, i, rp[i - 1], curve, progress, error);
  scree_curve_free(curve);
  return status;
}

/* The end of the colour map: a few far points must not take the colours from all others, so the
 * distance that 98 of 100 vertices stay below, rounded up to 1, 2 or 5 times a power of ten. */
static double colour_range(const picture *p, const scree_mesh *reference, double *values) {
  size_t count = 0;
  for (size_t i = 0; i < p->count; i++)
    for (size_t j = 0; p->items[i].mesh != reference && j < p->scans[i].mesh.vertex_count; j += 7)
      values[count++] = p->distances[i][j];
  if (!count) return 1e-3;
  scree_sort_numbers(values, count);
  double at = values[(size_t)(0.98 * (double)count)];
  if (!(at > 0)) return 1e-3;
  double power = pow(10, floor(log10(at))), digits = at / power;
  return power * (digits <= 1 ? 1 : digits <= 2 ? 2 : digits <= 5 ? 5 : 10);
}

/* Distances of every vertex of every mesh to the reference, and the end of their colours. */
static scree_status measure_distances(picture *p, const scree_mesh *reference, bool refine,
                                      double *range, scree_error *error) {
  size_t vertex_count = 0;
  for (size_t i = 0; i < p->count; i++) {
    scree_mesh *mesh = &p->scans[i].mesh;
    if (refine && mesh != reference && !render_refine(mesh)) return fail_memory(error);
    p->distances[i] = malloc(mesh->vertex_count * sizeof(double) + 1);
    if (!p->distances[i]) return fail_memory(error);
    SCREE_TRY(scree_mesh_distance_field(mesh, reference, p->distances[i], error));
    p->items[i].vertex_values = p->distances[i];
    vertex_count += mesh->vertex_count;
  }
  double *values = malloc((vertex_count + 1) * sizeof *values);
  if (!values) return fail_memory(error);
  *range = colour_range(p, reference, values);
  free(values);
  return SCREE_OK;
}

static scree_status color_by_distance(picture *p, const cli_call *call,
                                      scree_render_options *render, scree_error *error) {
  const render_arguments *a = call->options;
  bool refine = !a->edges && !a->wire;
  render->value_label = "distance / mm";
  render->value_scale = 1e3;
  if (!a->reference)
    return measure_distances(p, &p->scans[0].mesh, refine, &render->value_maximum, error);
  cli_input_options input = cli_source_options(&a->source);
  scree_scan reference;
  SCREE_TRY(cli_load(a->reference, &input, call->progress, &reference, error));
  scree_status status =
      measure_distances(p, &reference.mesh, refine, &render->value_maximum, error);
  scree_scan_free(&reference);
  return status;
}

/* "1e-1,recommended" to numbers; their count, or 0 where one is none in (0, 1]. */
static size_t parse_levels(const char *text, double rp[MOST_LEVELS]) {
  size_t count = 0;
  for (;;) {
    char word[32];
    size_t length = strcspn(text, ",");
    if (length >= sizeof word || count == MOST_LEVELS) return 0;
    memcpy(word, text, length);
    word[length] = 0;
    if (!strcmp(word, "recommended"))
      rp[count] = RECOMMENDED;
    else if (!cli_fraction_from_text(word, &rp[count]) || !(rp[count] > 0 && rp[count] <= 1))
      return 0;
    count++;
    if (!text[length]) return count;
    text += length + 1;
  }
}

static void set_options(const render_arguments *a, scree_render_options *render) {
  static const double views[][2] = {{35, 25}, {0, 0},  {180, 0}, {270, 0},
                                    {90, 0},  {0, 90}, {0, -90}};
  render->azimuth_deg = isnan(a->azimuth_deg) ? views[a->view][0] : a->azimuth_deg;
  render->elevation_deg = isnan(a->elevation_deg) ? views[a->view][1] : a->elevation_deg;
  render->samples = a->rays;
  render->columns = a->columns;
  render->edges = a->edges;
  render->wire = a->wire;
  render->ground = !a->no_ground;
}

static scree_status make_picture(const cli_call *call, const double *rp, size_t level_count,
                                 picture *p, scree_error *error) {
  const render_arguments *a = call->options;
  if (!allocate_picture(p, call->input_count + level_count)) return fail_memory(error);
  if (level_count) { /* then the input is one */
    const cli_soundness soundness = {0};
    double scale;
    SCREE_TRY(cli_load_for_levels(call, &a->source, &soundness, &p->scans[0], &scale, error));
    put_input(p, 0, call->inputs[0]);
    SCREE_TRY(make_levels(p, rp, scale, call->progress, error));
  }
  for (size_t i = 0; !level_count && i < call->input_count; i++)
    SCREE_TRY(read_one(p, i, call->inputs[i], &a->source, call->progress, error));
  for (size_t i = 0; a->no_captions && i < p->count; i++) p->cells[i].caption = NULL;
  return SCREE_OK;
}

static int run(const cli_call *call) {
  const render_arguments *a = call->options;
  scree_render_options render = scree_default_render_options();
  double rp[MOST_LEVELS];
  size_t level_count = a->levels ? parse_levels(a->levels, rp) : 0;
  if (!a->output) return cli_misuse(call->verb, "needs an output file: -o FILE.png");
  int code = cli_check_ending(call->verb, a->output, CLI_PICTURE);
  if (code == 0) code = cli_parse_size(call->verb, a->size, &render.width, &render.height);
  if (code) return code;
  if (a->levels && !level_count)
    return cli_misuse(call->verb,
                      "--rp %s: must be at most %d numbers above 0 and up to 1, or recommended, "
                      "with commas between",
                      a->levels, MOST_LEVELS);
  if (a->levels && call->input_count != 1)
    return cli_misuse(call->verb, "--rp takes one surface, not %zu", call->input_count);
  set_options(a, &render);
  picture p;
  scree_error error;
  scree_image image = {0};
  if (cli_check_output(call, a->output, a->overwrite, &error) != SCREE_OK) return cli_fail(&error);
  scree_status status = make_picture(call, rp, level_count, &p, &error);
  if (status == SCREE_OK && (a->reference || a->color_by))
    status = color_by_distance(&p, call, &render, &error);
  if (status == SCREE_OK)
    status = scree_render(p.cells, p.count, &render, call->progress, &image, &error);
  if (status == SCREE_OK) status = scree_image_write_png(&image, a->output, a->overwrite, &error);
  scree_image_free(&image);
  free_picture(&p);
  return status == SCREE_OK ? 0 : cli_fail(&error);
}

const cli_verb cli_verb_render = {
    .name = "render",
    .summary = "picture of meshes, ray-traced",
    .inputs = "FILE...|sample:NAME...",
    .description = "Writes one PNG with a view of each mesh, framed alike, captioned with its name "
                   "and triangle count: for example a scan and its levels side by side.",
    .examples =
        "scree render scan.stl -o scan.png\n"
        "scree render scan.stl level-*.stl -o levels.png --size 1800x500 --edges\n"
        "scree render scan.stl --rp 1e-1,1e-2,1e-3,1e-4,1e-5 --edges -o row.png --size 2400x400\n"
        "scree render scan.stl --rp 1e-3 --color-by distance -o error.png\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = 1000,
    .partners = CLI_SAMPLE_PARTNERS,
    .run = run,
};
