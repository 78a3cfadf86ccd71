/* scree clump: spheres for a scan, and how many. */
#include "base/file.h"
#include "base/number.h"
#include "base/quote.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "cli/terminal.h"
#include "report/program.h"
#include "report/provenance.h"

#include <math.h>

typedef struct clump_arguments {
  cli_source source;
  const char *output;
  size_t count, most, triangles;
  double tolerance, outside, ratio, angle;
  int method;
  bool inside, no_repair, json, csv, overwrite;
} clump_arguments;

enum { NAME_BYTES = 256, PATH_BYTES = 4096 };

typedef struct clump_object {
  const char *word;
  char name[NAME_BYTES], file[PATH_BYTES];
  cli_clump_surface surface;
  size_t mesh_count; /* triangles of the mesh to take instead; 0: spheres will do */
  scree_clumps clumps;
  const scree_clump *chosen;
} clump_object;

typedef struct clump_run {
  const cli_call *call;
  const clump_arguments *arguments;
  scree_work_start start;
  clump_object *objects;
  size_t count;
  scree_clump_report report; /* in the end */
} clump_run;

static void free_run(clump_run *r) {
  for (size_t i = 0; r->objects && i < r->count; i++) {
    scree_clumps_free(&r->objects[i].clumps);
    cli_clump_surface_free(&r->objects[i].surface);
  }
  scree_free(r->objects);
}

#define ARGUMENTS clump_arguments
static const cli_option options[] = {
    CLI_RANGE_ROW(CLI_COUNT, "count", count, "COUNT", 1, 300,
                  "Write the clump of so many spheres. Default: the recommended number."),
    CLI_RANGE_ROW(CLI_SHARE, "tolerance", tolerance, "SHARE", 1e-6, 1,
                  "Write the smallest clump whose surface is on average within this share of the "
                  "body's size."),
    CLI_RANGE_ROW(CLI_COUNT, "max", most, "N", 1, 300,
                  "Largest number of spheres tried. Default: 100, or COUNT where that is given."),
    CLI_ROW(CLI_TEXT, "output", output, "DIR",
            "Write the clumps, the tables, the figure and report.html into DIR."),
    CLI_CHOICE_ROW("method", method, "METHOD", "fitted|favier|bubble|ferellec|peeling",
                   "fitted: all spheres moved together until their union fits best. The others are "
                   "greedy, by the papers: favier (1999), bubble (Taghavi 2011), ferellec "
                   "(Ferellec and McDowell 2010), peeling. Default: fitted."),
    CLI_FLAG_ROW("inside", inside, "No sphere stands out of the surface."),
    CLI_RANGE_ROW(CLI_LENGTH, "outside", outside, "LENGTH", 0, 1e3,
                  "No sphere stands out by more than this. Default: as far as it fits best."),
    CLI_RANGE_ROW(CLI_REAL, "ratio", ratio, "R", 1e-3, 1,
                  "bubble: radius of the least sphere in radii of the largest. Default: 0.05."),
    CLI_RANGE_ROW(CLI_REAL, "angle", angle, "DEG", 0, 180,
                  "bubble: greatest angle at which spheres may meet, PFC's `distance`; more is "
                  "smoother. Default: 150."),
    CLI_RANGE_ROW(CLI_COUNT, "triangles", triangles, "N", 100, 1000000,
                  "Fit to the surface decimated to so many triangles: spheres show no finer "
                  "detail. Default: 2000; all with --inside and --outside."),
    CLI_FLAG_ROW("no-repair", no_repair,
                 "Refuse scans that are no closed surface instead of repairing them."),
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("json", json, "Print JSON instead of text, with every clump."),
    CLI_FLAG_ROW("csv", csv, "Print CSV instead of text: a row per number of spheres."),
    CLI_FLAG_ROW("force", overwrite, "Overwrite existing files."),
};

static const clump_arguments defaults = {.source = CLI_SOURCE_DEFAULTS,
                                         .outside = INFINITY,
                                         .ratio = 0.05,
                                         .angle = 150,
                                         .triangles = SCREE_CLUMP_TRIANGLES};

/* Below this IoU spheres are told to be the wrong shape. */
static const double LEAST_IOU = 0.6;
/* Walls of fewer cells of the grid than this are not seen. */
static const double LEAST_CELLS = 3;

/* ---- Making ---- */

static scree_status load(const cli_call *call, const scree_progress *progress, clump_object *object,
                         scree_error *error) {
  const clump_arguments *a = call->options;
  cli_input_options input = cli_source_options(&a->source);
  /* what stands out of the surface is told of the file's own */
  object->surface.triangles = a->inside || a->outside < INFINITY ? SIZE_MAX : a->triangles;
  object->surface.no_repair = a->no_repair;
  return cli_load_for_clump(object->word, &input, progress, &object->surface, error);
}

static scree_clump_options clump_options(const clump_arguments *a) {
  scree_clump_options o = scree_default_clump_options();
  o.method = (scree_clump_method)a->method;
  o.most = a->most ? a->most : a->count ? a->count : o.most;
  o.outside = a->inside ? 0 : a->outside;
  o.ratio = a->ratio;
  o.angle_deg = a->angle;
  return o;
}

/* The clump asked for. */
static scree_status choose(const clump_arguments *a, clump_object *object, scree_error *error) {
  const scree_clumps *c = &object->clumps;
  if (a->count) {
    object->chosen = scree_clumps_of_count(c, a->count);
  } else if (a->tolerance > 0) {
    object->chosen = scree_clumps_within(c, a->tolerance);
  } else {
    object->chosen = &c->clumps[c->recommended];
  }
  if (object->chosen) return SCREE_OK;
  const scree_clump none = {0}, *last = c->clumps ? &c->clumps[c->clump_count - 1] : &none;
  return scree_fail(error, SCREE_LIMIT,
                    "%.300s: %zu spheres are on average within %.4f of the body's size, more than "
                    "the %g asked; raise --tolerance or --max",
                    object->word, last->sphere_count,
                    (last->to_mesh.mean + last->from_mesh.mean) / 2 / c->size, a->tolerance);
}

/* Where the grid does not see the walls, or the spheres hardly cover the body: how many triangles
 * its mesh needs. */
static scree_status look_at_shape(const clump_arguments *a, clump_object *object,
                                  scree_error *error) {
  const scree_clumps *c = &object->clumps;
  bool best = a->method == SCREE_CLUMP_FITTED && !a->inside && !(a->outside < INFINITY);
  SCREE_CLEANUP(scree_mesh_free) scree_mesh level = {0};
  SCREE_CLEANUP(scree_choice_free) scree_choice choice = {0};
  bool more = c->recommended + 1 < c->clump_count; /* were tried, and are not worth it */
  bool poor = best && more && c->clumps[c->recommended].iou < LEAST_IOU;
  if (c->wall_cells >= LEAST_CELLS && !poor) return SCREE_OK;
  SCREE_TRY(scree_choose_mesh(&object->surface.mesh, 1, NULL, &level, &choice, error));
  object->mesh_count = level.triangle_count;
  return SCREE_OK;
}

static scree_status make(const cli_call *call, clump_object *object, cli_share *share, double from,
                         double part, scree_error *error) {
  const clump_arguments *a = call->options;
  scree_clump_options o = clump_options(a);
  SCREE_TRY(load(call, cli_share_enter(share, from, 0.2 * part), object, error));
  if (scree_clumps_make(&object->surface.mesh, &o,
                        cli_share_enter(share, from + 0.2 * part, 0.8 * part), &object->clumps,
                        error) != SCREE_OK)
    return cli_name_in_error(object->word, error);
  SCREE_TRY(choose(a, object, error));
  return look_at_shape(a, object, error);
}

/* ---- Telling ---- */

static bool is_told(const clump_object *object, size_t index) {
  static const size_t counts[] = {1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100, 150, 200, 300};
  const scree_clumps *c = &object->clumps;
  if (index == c->recommended || &c->clumps[index] == object->chosen || index + 1 == c->clump_count)
    return true;
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    if (c->clumps[index].sphere_count == counts[i]) return true;
  return false;
}

static void print_row(FILE *out, const clump_object *object, const scree_clump *c,
                      const char *mark) {
  double worst = fmax(c->to_mesh.maximum, c->from_mesh.maximum);
  fprintf(out, "%7zu %7.4f %9.4g %9.4g %7.2f%% %7.2f%% %7.1f %9.4f %9.4f%s\n", c->sphere_count,
          c->iou, (c->to_mesh.mean + c->from_mesh.mean) / 2 / object->surface.unit_m,
          worst / object->surface.unit_m, 100 * c->volume_error, 100 * c->inertia_error,
          c->slope_deg, c->volume_criterion, c->distance_criterion, mark);
}

/* A mark behind the last of so many as were to be tried: it is not known whether more were better.
 */
static const char *mark_of(const clump_object *object, size_t index, size_t most) {
  const scree_clumps *c = &object->clumps;
  bool last = index + 1 == c->clump_count && c->clumps[index].sphere_count >= most;
  if (index == c->recommended)
    return last || object->mesh_count ? " least of those tried" : " recommended";
  return &c->clumps[index] == object->chosen ? " chosen" : "";
}

static void print_object(FILE *out, const clump_object *object, size_t most) {
  const scree_clumps *c = &object->clumps;
  char shown[CLI_PRINTABLE_BYTES], scan[32], used[32];
  const char *unit = cli_unit_name(object->surface.unit_m);
  fprintf(out, "%s: %s triangles, fitted to %s, method %s, size L = %.4g %s%s%s\n",
          cli_printable(object->word, shown),
          scree_count_text(object->surface.scan_triangle_count, scan),
          scree_count_text(object->surface.mesh.triangle_count, used),
          scree_clump_method_name(c->method), c->size / object->surface.unit_m, unit,
          object->surface.note[0] ? "; " : "", object->surface.note);
  fprintf(out,
          "IoU: common volume over that of both, 1 is perfect; mean, greatest: distance of the\n"
          "surfaces; slope: between their normals; last two: criteria, the least is best\n");
  fprintf(out, "%7s %7s %9s %9s %8s %8s %7s %9s %9s\n", "spheres", "IoU", "mean", "greatest",
          "volume", "inertia", "slope", "1-IoU", "mean/L");
  fprintf(out, "%7s %7s %9s %9s %8s %8s %7s %9s %9s\n", "", "", unit, unit, "", "", "deg", "+n/200",
          "+n/5000");
  for (size_t i = 0; i < c->clump_count; i++)
    if (is_told(object, i)) print_row(out, object, &c->clumps[i], mark_of(object, i, most));
}

/* Why spheres are the wrong shape, and what to take instead. */
static void print_wrong_shape(FILE *out, const clump_object *object) {
  const scree_clumps *c = &object->clumps;
  const char *unit = cli_unit_name(object->surface.unit_m);
  char shown[CLI_PRINTABLE_BYTES], quoted[CLI_PRINTABLE_BYTES], count[32];
  if (c->wall_cells < LEAST_CELLS)
    fprintf(out,
            "Its walls of %.3g %s are thinner than three cells of the grid: spheres are the wrong "
            "shape for it.",
            c->thickness / object->surface.unit_m, unit);
  else
    fprintf(out,
            "The spheres and the body have less than %g of the volume of both in common (IoU): "
            "spheres are the wrong shape for it.",
            LEAST_IOU);
  fprintf(out, " Take its mesh, of %s triangles: scree choose %s -u %s -o DIR\n",
          scree_count_text(object->mesh_count, count),
          cli_printable(scree_quote_text(SCREE_QUOTE_SHELL, object->word, quoted, sizeof quoted),
                        shown),
          unit);
}

static void print_advice(FILE *out, const clump_object *object) {
  const scree_clump *chosen = object->chosen;
  fprintf(out,
          "%zu sphere%s: the union's volume is %.4g of the body's; mass, centre and inertia that "
          "go with the clump are the body's own.\n",
          chosen->sphere_count, cli_plural(chosen->sphere_count), 1 + chosen->volume_error);
  if (object->mesh_count) print_wrong_shape(out, object);
}

/* What was asked for and is not there. */
static void warn(const cli_call *call, const clump_object *object) {
  const clump_arguments *a = call->options;
  char shown[CLI_PRINTABLE_BYTES];
  cli_terminal_end();
  if (a->count > object->chosen->sphere_count)
    fprintf(stderr,
            a->method == SCREE_CLUMP_FITTED
                ? "%s: %zu spheres, not %zu: of %zu and more none was found whose IoU is larger by "
                  "1e-4 while volume, centre and inertia are held\n"
                : "%s: %zu spheres, not %zu: the method places no more than %zu\n",
            cli_printable(object->word, shown), object->chosen->sphere_count, a->count,
            object->chosen->sphere_count + (a->method == SCREE_CLUMP_FITTED));
}

static void print_all(FILE *out, const clump_run *run) {
  size_t most = clump_options(run->arguments).most;
  for (size_t i = 0; i < run->count; i++) {
    if (i) putc('\n', out);
    print_object(out, &run->objects[i], most);
    print_advice(out, &run->objects[i]);
  }
}

/* ---- Files ---- */

static const clump_run *run_of(const void *report) {
  return (const clump_run *)((const char *)report - offsetof(clump_run, report));
}

static scree_status write_text(const void *report, const char *path, bool overwrite,
                               scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  print_all(output.stream, run_of(report));
  return scree_output_commit(&output, error);
}

static scree_status write_provenance(const void *report, const char *path, bool overwrite,
                                     scree_error *error) {
  const clump_run *r = run_of(report);
  return scree_provenance_write(&r->start, r->call->command_line, path, overwrite, error);
}

static scree_status write_page(const void *report, const char *path, bool overwrite,
                               scree_error *error) {
  return scree_page_write(&run_of(report)->arguments->output, 1, path, overwrite, error);
}

/* What is written of the report; the text and the page are of all this. */
static const scree_product products[] = {
    {"clump.png", scree_clump_figure_write}, {"clump.svg", scree_clump_figure_write},
    {"clump.pdf", scree_clump_figure_write}, {"clump.json", scree_clump_json_write},
    {"clump.csv", scree_clump_csv_write},    {"clump.txt", write_text},
    {"provenance.json", write_provenance},   {"report.html", write_page}};
enum { PRODUCT_COUNT = sizeof products / sizeof *products };

/* What will be written, before any work. */
static scree_status check_files(clump_run *run, scree_error *error) {
  const clump_arguments *a = run->arguments;
  char path[PATH_BYTES];
  SCREE_TRY(cli_make_folder(a->output, error));
  SCREE_TRY(cli_lock_folder(a->output, error));
  for (size_t i = 0; i < run->count; i++) {
    clump_object *o = &run->objects[i];
    snprintf(o->file, sizeof o->file, "%s.csv", o->name);
    SCREE_TRY(cli_join_path(a->output, "", o->file, "", path, sizeof path, error));
    SCREE_TRY(cli_check_output(run->call, path, a->overwrite, error));
  }
  for (size_t i = 0; i < PRODUCT_COUNT; i++) {
    if (!scree_product_is_made(&products[i])) continue;
    SCREE_TRY(cli_join_path(a->output, "", products[i].name, "", path, sizeof path, error));
    SCREE_TRY(cli_check_output(run->call, path, a->overwrite, error));
  }
  return SCREE_OK;
}

static scree_status write_files(const clump_run *run, scree_error *error) {
  const clump_arguments *a = run->arguments;
  char path[PATH_BYTES];
  for (size_t i = 0; i < run->count; i++) {
    const clump_object *o = &run->objects[i];
    SCREE_TRY(cli_join_path(a->output, "", o->file, "", path, sizeof path, error));
    SCREE_TRY(
        scree_spheres_write(&o->clumps, o->chosen, o->surface.unit_m, path, a->overwrite, error));
  }
  return scree_products_write(products, PRODUCT_COUNT, &run->report, a->output, a->overwrite,
                              error);
}

static scree_status tell(const clump_run *run, scree_error *error) {
  const clump_arguments *a = run->arguments;
  for (size_t i = 0; i < run->count && !run->call->quiet; i++) warn(run->call, &run->objects[i]);
  if (a->json) return scree_clump_json_write(&run->report, "-", false, error);
  if (a->csv) return scree_clump_csv_write(&run->report, "-", false, error);
  if (!run->call->quiet || !a->output) print_all(stdout, run);
  return SCREE_OK;
}

static scree_clump_entry entry_of(const clump_object *o) {
  return (scree_clump_entry){.name = o->name,
                             .file = o->word,
                             .format = o->surface.format,
                             .checksum = o->surface.checksum,
                             .unit_m = o->surface.unit_m,
                             .note = o->surface.note[0] ? o->surface.note : NULL,
                             .scan_triangle_count = o->surface.scan_triangle_count,
                             .mesh = &o->surface.mesh,
                             .clumps = &o->clumps,
                             .chosen = o->chosen,
                             .clump_file = o->file[0] ? o->file : NULL};
}

/* What does not go together. */
static scree_status check_call(const cli_call *call) {
  const clump_arguments *a = call->options;
  if (a->most && a->count > a->most)
    return cli_misuse(call->verb, "-n %zu is above --max %zu", a->count, a->most);
  if ((a->inside || a->outside < INFINITY) && a->method != SCREE_CLUMP_FITTED)
    return cli_misuse(call->verb, "--inside and --outside are for the method fitted");
  return SCREE_OK;
}

static scree_status run(const cli_call *call, scree_error *error) {
  SCREE_CLEANUP(free_run)
  clump_run r = {.call = call,
                 .arguments = call->options,
                 .start = scree_work_started(),
                 .count = call->input_count};
  cli_share share = cli_share_of(call->progress, "fitting spheres");
  double part = 1 / (double)r.count;
  SCREE_TRY(check_call(call));
  SCREE_TRY_ALLOC_ZERO(r.objects, r.count, error);
  SCREE_SCRATCH(scree_clump_entry, entries, r.count, error);
  for (size_t i = 0; i < r.count; i++) {
    r.objects[i].word = call->inputs[i];
    cli_distinct_name(r.objects[i].word, r.objects[0].name, sizeof *r.objects, i, NAME_BYTES);
  }
  if (r.arguments->output) SCREE_TRY(check_files(&r, error));
  for (size_t i = 0; i < r.count; i++) {
    SCREE_TRY(make(call, &r.objects[i], &share, (double)i * part, part, error));
    entries[i] = entry_of(&r.objects[i]);
  }
  r.report = (scree_clump_report){entries, r.count, call->command_line};
  if (r.arguments->output) SCREE_TRY(write_files(&r, error));
  return tell(&r, error);
}

const cli_verb cli_verb_clump = {
    .name = "clump",
    .summary = "fit overlapping spheres to scans, and say how many",
    .inputs = "FILE|sample:NAME...",
    .description =
        "Makes of each scan (repaired first where it is no closed surface) the clumps of 1 to "
        "--max spheres whose union covers the body best, and prints for each number: the "
        "intersection over union of the volumes (IoU), mean and greatest distance between both "
        "surfaces, how far volume and principal moments of the union are off, the mean angle "
        "between the surfaces' normals (roughness that acts as friction), and the criterion of "
        "Katagiri and Koyanaka (2020) with spheres in place of triangles. The number with the "
        "least 1 - IoU + n/200 is recommended.\n\n"
        "The mass, centre and inertia handed over are those of the surface, whatever the union's. "
        "The folder gets NAME.csv with x, y, z and radius of every sphere in the file's unit, "
        "which `scree drop`, `scree repose` and `scree export` take in place of a scan, and "
        "report.html with the clump over the scan in 3D.",
    .examples = "scree clump phone.stl\n"
                "scree clump phone.stl -n 20 -o clumps\n"
                "scree clump rock.ply -u m --tolerance 0.02 --json\n"
                "scree clump rock.ply -u m -m bubble --ratio 0.1 --angle 160 -o bubble\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = 1000,
    .partners = CLI_SAMPLE_PARTNERS,
    .exclusive = "json|csv count|tolerance inside|outside",
    .run = run,
};
