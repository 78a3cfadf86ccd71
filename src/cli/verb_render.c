#include "base/number.h"
#include "base/owned.h"
#include "base/radix.h"
#include "cli/input.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "scree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Large triangles cut into small ones in their planes, so that a colour that is known at corners
 * tells what lies between. */

static const double wanted_triangles = 400000;

static double doubled_area(const scree_mesh *mesh, size_t t) {
  const double *p[3];
  double u[3], v[3];
  for (int i = 0; i < 3; i++)
    p[i] = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)i];
  for (int k = 0; k < 3; k++) {
    u[k] = p[1][k] - p[0][k];
    v[k] = p[2][k] - p[0][k];
  }
  double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Into how many parts the sides of triangle t are cut. */
static size_t cuts(const scree_mesh *mesh, size_t t, double total) {
  double share = total > 0 ? doubled_area(mesh, t) / total : 0;
  return 1 + (size_t)sqrt(share * wanted_triangles);
}

/* The corners of small triangle (i, j) of n x n, the upper or the lower one of its cell. */
static double *put_small(double *out, const double *p[3], size_t n, size_t i, size_t j,
                         bool upper) {
  size_t at[3][2] = {{i, j}, {i + 1, j}, {i, j + 1}};
  if (upper) {
    at[0][0]++;
    at[1][1]++;
  }
  for (int c = 0; c < 3; c++) {
    double b = (double)at[c][0] / (double)n, d = (double)at[c][1] / (double)n;
    for (int k = 0; k < 3; k++)
      *out++ = p[0][k] + b * (p[1][k] - p[0][k]) + d * (p[2][k] - p[0][k]);
  }
  return out;
}

/* Replaces a mesh of fewer than 200,000 triangles by some 400,000; a finer
 * one stays as it is. Freed with scree_mesh_free as before. False: out of memory. */
static bool refine_mesh(scree_mesh *mesh) {
  if ((double)mesh->triangle_count > 0.5 * wanted_triangles) return true;
  double total = 0;
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) total += doubled_area(mesh, t);
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    size_t n = cuts(mesh, t, total);
    count += n * n;
  }
  double *corners = malloc((count + 1) * 9 * sizeof *corners), *out = corners;
  if (!corners) return false;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    size_t n = cuts(mesh, t, total);
    const double *p[3];
    for (int c = 0; c < 3; c++)
      p[c] = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)c];
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; i + j < n; j++) {
        out = put_small(out, p, n, i, j, false);
        if (i + j + 1 < n) out = put_small(out, p, n, i, j, true);
      }
  }
  scree_mesh made;
  scree_error error;
  bool done = scree_mesh_weld(corners, count, 0, &made, NULL, &error) == SCREE_OK;
  free(corners);
  if (!done) return false;
  scree_mesh_free(mesh);
  *mesh = made;
  return true;
}

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
                                          .rays = 8};

#define ARGUMENTS render_arguments
static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", output, "FILE", "The PNG to write (required); - is stdout."),
    CLI_ROW(CLI_TEXT, "size", size, "WxH", "Size in pixels. Default: 1200x900."),
    CLI_CHOICE_ROW("from", view, "SIDE", "oblique|front|back|left|right|top|bottom",
                   "Seen from: oblique, front (against -y), back, left, right, top or bottom. "
                   "Default: oblique."),
    CLI_RANGE_ROW(CLI_REAL, "azimuth", azimuth_deg, "DEG", -360, 360,
                  "The camera's angle about the vertical. Default: the view's; 35 of oblique."),
    CLI_RANGE_ROW(CLI_REAL, "elevation", elevation_deg, "DEG", -90, 90,
                  "The camera's angle above the horizontal. Default: the view's; 25 of oblique."),
    CLI_RANGE_ROW(CLI_COUNT, "rays", rays, "N", 1, 65536,
                  "Rays a pixel: more is smoother and slower. Default: 8."),
    CLI_RANGE_ROW(CLI_COUNT, "columns", columns, "N", 1, 1000,
                  "Columns of views. Default: what makes them largest."),
    CLI_FLAG_ROW("edges", edges, "Draw the edges of the triangles."),
    CLI_FLAG_ROW("wire", wire, "Draw only the edges."),
    CLI_ROW(CLI_TEXT, "rp", levels, "LIST",
            "Of one surface: also its levels at these Rp (0 < RP <= 1, or recommended) by the "
            "decimation of choose."),
    CLI_CHOICE_ROW("color-by", color_by, "WHAT", "plain|distance",
                   "plain, or distance: to the first surface, or to the one of --reference, with a "
                   "scale bar; all over the triangles, or with --edges and --wire between their "
                   "corners. Default: plain."),
    CLI_ROW(CLI_FILE, "reference", reference, "FILE",
            "Colour by the distance to the surface in FILE."),
    CLI_FLAG_ROW("no-ground", no_ground, "No floor and no shadow on it."),
    CLI_FLAG_ROW("no-captions", no_captions, "No file name and triangle count below each view."),
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("force", overwrite, "Overwrite an existing file."),
};

/* One of the pictures' views. */
typedef struct view {
  scree_scan scan;
  double *distances; /* of its vertices; NULL: plain */
  scree_render_item item;
  char caption[160];
} view;

typedef struct picture {
  size_t count;
  view *views;
  scree_render_cell *cells;
} picture;

static void free_picture(picture *p) {
  for (size_t i = 0; p->views && i < p->count; i++) {
    scree_scan_free(&p->views[i].scan);
    scree_free(p->views[i].distances);
  }
  scree_free(p->views);
  scree_free(p->cells);
}

static void put_cell(picture *p, size_t i, const char *name) {
  view *v = &p->views[i];
  char count[32];
  snprintf(v->caption, sizeof v->caption, "%s: %s triangles", name,
           scree_count_text(v->scan.mesh.triangle_count, count));
  v->item = (scree_render_item){.mesh = &v->scan.mesh, .color = {0.34f, 0.46f, 0.60f}};
  p->cells[i] = (scree_render_cell){&v->item, 1, v->caption};
}

static void put_input(picture *p, size_t i, const char *word) {
  char name[96];
  cli_short_name(word, name, sizeof name);
  put_cell(p, i, name);
}

static scree_status read_one(picture *p, size_t i, const char *word, const cli_source *source,
                             const scree_progress *progress, scree_error *error) {
  cli_input_options input = cli_source_options(source);
  SCREE_TRY(cli_load(word, &input, progress, &p->views[i].scan, error));
  put_input(p, i, word);
  return SCREE_OK;
}

static scree_status make_level(picture *p, size_t i, double rp, scree_curve *curve,
                               const scree_progress *progress, scree_error *error) {
  scree_mesh *scan = &p->views[0].scan.mesh, *mesh = &p->views[i].scan.mesh;
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
  if (!recommended && mesh->triangle_count > target)
    SCREE_ADD_TEXT(p->views[i].caption, ", not fewer");
  return SCREE_OK;
}

/* Levels of the first surface become the surfaces behind it. */
static scree_status make_levels(picture *p, const double *rp, double scale,
                                const scree_progress *progress, scree_error *error) {
  SCREE_OWNED(scree_curve, curve);
  scree_simplify_options simplify = scree_default_simplify_options();
  SCREE_TRY(
      scree_curve_build_scaled(&p->views[0].scan.mesh, scale, &simplify, progress, &curve, error));
  for (size_t i = 1; i < p->count; i++)
    SCREE_TRY(make_level(p, i, rp[i - 1], curve, progress, error));
  return SCREE_OK;
}

/* The end of the colour map: a few far points must not take the colours from all others, so the
 * distance that 98 of 100 vertices stay below, rounded up to 1, 2 or 5 times a power of ten. */
static double colour_range(const picture *p, const scree_mesh *reference, double *values) {
  size_t count = 0;
  for (size_t i = 0; i < p->count; i++) {
    const view *v = &p->views[i];
    for (size_t j = 0; v->item.mesh != reference && j < v->scan.mesh.vertex_count; j += 7)
      values[count++] = v->distances[j];
  }
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
    view *v = &p->views[i];
    scree_mesh *mesh = &v->scan.mesh;
    if (refine && mesh != reference && !refine_mesh(mesh))
      return scree_fail_memory(error, 0, "the picture");
    SCREE_TRY_ALLOC(v->distances, mesh->vertex_count, error);
    SCREE_TRY(scree_mesh_distance_field(mesh, reference, v->distances, error));
    v->item.vertex_values = v->distances;
    vertex_count += mesh->vertex_count;
  }
  SCREE_SCRATCH(double, values, vertex_count, error);
  *range = colour_range(p, reference, values);
  return SCREE_OK;
}

static scree_status color_by_distance(picture *p, const cli_call *call,
                                      scree_render_options *render, scree_error *error) {
  const render_arguments *a = call->options;
  const scree_mesh *to = &p->views[0].scan.mesh;
  cli_input_options input = cli_source_options(&a->source);
  SCREE_CLEANUP(scree_scan_free) scree_scan reference = {0};
  render->value_label = "distance / mm";
  render->value_scale = 1e3;
  if (a->reference) {
    SCREE_TRY(cli_load(a->reference, &input, call->progress, &reference, error));
    to = &reference.mesh;
  }
  return measure_distances(p, to, !a->edges && !a->wire, &render->value_maximum, error);
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
  p->count = call->input_count + level_count;
  SCREE_TRY_ALLOC_ZERO(p->views, p->count, error);
  SCREE_TRY_ALLOC_ZERO(p->cells, p->count, error);
  if (level_count) { /* then the input is one */
    const cli_soundness soundness = {0};
    double scale;
    SCREE_TRY(cli_load_for_levels(call, &a->source, &soundness, &p->views[0].scan, &scale, error));
    put_input(p, 0, call->inputs[0]);
    SCREE_TRY(make_levels(p, rp, scale, call->progress, error));
  }
  for (size_t i = 0; !level_count && i < call->input_count; i++)
    SCREE_TRY(read_one(p, i, call->inputs[i], &a->source, call->progress, error));
  for (size_t i = 0; a->no_captions && i < p->count; i++) p->cells[i].caption = NULL;
  return SCREE_OK;
}

static scree_status run(const cli_call *call, scree_error *error) {
  const render_arguments *a = call->options;
  scree_render_options render = scree_default_render_options();
  double rp[MOST_LEVELS];
  size_t level_count = a->levels ? parse_levels(a->levels, rp) : 0;
  if (!a->output) return cli_misuse(call->verb, "needs an output file: -o FILE.png");
  SCREE_TRY(cli_check_ending(call->verb, a->output, CLI_PICTURE));
  SCREE_TRY(cli_parse_size(call->verb, a->size, &render.width, &render.height));
  if (a->levels && !level_count)
    return cli_misuse(call->verb,
                      "--rp %s: must be at most %d numbers above 0 and up to 1, or recommended, "
                      "with commas between",
                      a->levels, MOST_LEVELS);
  if (a->levels && call->input_count != 1)
    return cli_misuse(call->verb, "--rp takes one surface, not %zu", call->input_count);
  set_options(a, &render);
  SCREE_CLEANUP(free_picture) picture p = {0};
  SCREE_CLEANUP(scree_image_free) scree_image image = {0};
  SCREE_TRY(cli_check_output(call, a->output, a->overwrite, error));
  SCREE_TRY(make_picture(call, rp, level_count, &p, error));
  if (a->reference || a->color_by) SCREE_TRY(color_by_distance(&p, call, &render, error));
  SCREE_TRY(scree_render(p.cells, p.count, &render, call->progress, &image, error));
  return scree_image_write_png(&image, a->output, a->overwrite, error);
}

const cli_verb cli_verb_render = {
    .name = "render",
    .group = CLI_SHOW,
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
