/* scree clump: spheres for a scan, and how many. */
#include "base/number.h"
#include "cli/clump_files.h"
#include "cli/terminal.h"
#include "report/program.h"
#include "report/provenance.h"

#include <math.h>
#include <stdlib.h>

#define AT(field) offsetof(clump_arguments, field)
static const cli_option options[] = {
    {"count", CLI_COUNT, AT(count), "COUNT",
     "Write the clump of so many spheres. Default: the recommended number.", 1, 300, NULL},
    {"tolerance", CLI_SHARE, AT(tolerance), "SHARE",
     "Write the smallest clump whose surface is on average within this share of the body's size.",
     1e-6, 1, NULL},
    {"max", CLI_COUNT, AT(most), "N",
     "Largest number of spheres tried. Default: 100, or COUNT where that is given.", 1, 300, NULL},
    {"output", CLI_TEXT, AT(output), "DIR",
     "Write the clumps, the tables, the figure and report.html into DIR.", 0, 0, NULL},
    {"method", CLI_CHOICE, AT(method), "METHOD",
     "fitted: all spheres moved together until their union fits best. The others are greedy, by "
     "the papers: favier (1999), bubble (Taghavi 2011), ferellec (Ferellec and McDowell 2010), "
     "peeling. Default: fitted.",
     0, 0, "fitted|favier|bubble|ferellec|peeling"},
    {"inside", CLI_FLAG, AT(inside), NULL, "No sphere stands out of the surface.", 0, 0, NULL},
    {"outside", CLI_LENGTH, AT(outside), "LENGTH",
     "No sphere stands out by more than this. Default: as far as it fits best.", 0, 1e3, NULL},
    {"ratio", CLI_REAL, AT(ratio), "R",
     "bubble: radius of the least sphere in radii of the largest. Default: 0.05.", 1e-3, 1, NULL},
    {"angle", CLI_REAL, AT(angle), "DEG",
     "bubble: greatest angle at which spheres may meet, PFC's `distance`; more is smoother. "
     "Default: 150.",
     0, 180, NULL},
    {"triangles", CLI_COUNT, AT(triangles), "N",
     "Fit to the surface decimated to so many triangles: spheres show no finer detail. Default: "
     "2000; all with --inside and --outside.",
     100, 1000000, NULL},
    {"no-repair", CLI_FLAG, AT(no_repair), NULL,
     "Refuse scans that are no closed surface instead of repairing them.", 0, 0, NULL},
    CLI_SOURCE_OPTIONS(clump_arguments),
    {"json", CLI_FLAG, AT(json), NULL, "Print JSON instead of text, with every clump.", 0, 0, NULL},
    {"csv", CLI_FLAG, AT(csv), NULL, "Print CSV instead of text: a row per number of spheres.", 0,
     0, NULL},
    {"force", CLI_FLAG, AT(overwrite), NULL, "Overwrite existing files.", 0, 0, NULL},
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
  const scree_clump none = {0};
  const scree_clump *last = c->clumps ? &c->clumps[c->clump_count - 1] : &none;
  error->status = SCREE_LIMIT;
  snprintf(error->message, sizeof error->message,
           "%.300s: %zu spheres are on average within %.4f of the body's size, more than the %g "
           "asked; raise --tolerance or --max",
           object->word, last->sphere_count,
           (last->to_mesh.mean + last->from_mesh.mean) / 2 / c->size, a->tolerance);
  return SCREE_LIMIT;
}

/* Where the grid does not see the walls, or the spheres hardly cover the body: how many triangles
 * its mesh needs. */
static scree_status look_at_shape(const clump_arguments *a, clump_object *object,
                                  scree_error *error) {
  const scree_clumps *c = &object->clumps;
  bool best = a->method == SCREE_CLUMP_FITTED && !a->inside && !(a->outside < INFINITY);
  scree_mesh level = {0};
  scree_choice choice = {0};
  bool more = c->recommended + 1 < c->clump_count; /* were tried, and are not worth it */
  bool poor = best && more && c->clumps[c->recommended].iou < LEAST_IOU;
  if (c->wall_cells >= LEAST_CELLS && !poor) return SCREE_OK;
  scree_status status = scree_choose_mesh(&object->surface.mesh, 1, NULL, &level, &choice, error);
  object->mesh_count = level.triangle_count;
  scree_mesh_free(&level);
  scree_choice_free(&choice);
  return status;
}

static scree_status make(const cli_call *call, clump_object *object, cli_share *share, double from,
                         double part, scree_error *error) {
  const clump_arguments *a = call->options;
  scree_clump_options o = clump_options(a);
  scree_status status = load(call, cli_share_enter(share, from, 0.2 * part), object, error);
  if (status == SCREE_OK) {
    status = scree_clumps_make(&object->surface.mesh, &o,
                               cli_share_enter(share, from + 0.2 * part, 0.8 * part),
                               &object->clumps, error);
    if (status != SCREE_OK) return cli_name_in_error(object->word, error);
    object->made = true;
  }
  if (status == SCREE_OK) status = choose(a, object, error);
  return status == SCREE_OK ? look_at_shape(a, object, error) : status;
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

/* Of the last of so many as were to be tried it is not known whether more were better. */
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
  char shown[CLI_PRINTABLE_BYTES], count[32];
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
          scree_count_text(object->mesh_count, count), cli_printable(object->word, shown), unit);
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

void clump_print(FILE *out, const clump_run *run) {
  size_t most = clump_options(run->call->options).most;
  for (size_t i = 0; i < run->count; i++) {
    if (i) putc('\n', out);
    print_object(out, &run->objects[i], most);
    print_advice(out, &run->objects[i]);
  }
}

static scree_status tell(const clump_run *run, const scree_clump_report *report,
                         scree_error *error) {
  const clump_arguments *a = run->call->options;
  for (size_t i = 0; i < run->count && !run->call->quiet; i++) warn(run->call, &run->objects[i]);
  if (a->json) return scree_clump_json_write(report, "-", false, error);
  if (a->csv) return scree_clump_csv_write(report, "-", false, error);
  if (!run->call->quiet || !a->output) clump_print(stdout, run);
  return SCREE_OK;
}

static scree_status make_all(clump_run *run, scree_error *error) {
  const clump_arguments *a = run->call->options;
  scree_status status = a->output ? clump_check_files(run, error) : SCREE_OK;
  cli_share share = cli_share_of(run->call->progress, "fitting spheres");
  double part = 1 / (double)run->count;
  for (size_t i = 0; i < run->count && status == SCREE_OK; i++)
    status = make(run->call, &run->objects[i], &share, (double)i * part, part, error);
  if (status != SCREE_OK) return status;
  scree_clump_report report;
  status = clump_report_make(run, &report, error);
  if (status == SCREE_OK && a->output) status = clump_write_files(run, &report, error);
  if (status == SCREE_OK) status = tell(run, &report, error);
  clump_report_free(&report);
  return status;
}

/* 0, or 2 after telling what does not go together. */
static int check_call(const cli_call *call) {
  const clump_arguments *a = call->options;
  if (a->json && a->csv) return cli_misuse(call->verb, "--json and --csv exclude each other");
  if (a->count && a->tolerance > 0)
    return cli_misuse(call->verb, "-n and --tolerance exclude each other");
  if (a->most && a->count > a->most)
    return cli_misuse(call->verb, "-n %zu is above --max %zu", a->count, a->most);
  if (a->inside && a->outside < INFINITY)
    return cli_misuse(call->verb, "--inside and --outside exclude each other");
  if ((a->inside || a->outside < INFINITY) && a->method != SCREE_CLUMP_FITTED)
    return cli_misuse(call->verb, "--inside and --outside are for the method fitted");
  return 0;
}

static int run(const cli_call *call) {
  clump_run r = {.call = call, .start = scree_work_started(), .count = call->input_count};
  scree_error error;
  int code = check_call(call);
  if (code) return code;
  r.objects = calloc(r.count, sizeof *r.objects);
  if (!r.objects) {
    error = (scree_error){SCREE_OUT_OF_MEMORY, "out of memory for the list of bodies"};
    return cli_fail(&error);
  }
  clump_name_objects(&r);
  scree_status status = make_all(&r, &error);
  for (size_t i = 0; i < r.count; i++) {
    if (r.objects[i].made) scree_clumps_free(&r.objects[i].clumps);
    scree_mesh_free(&r.objects[i].surface.mesh);
  }
  free(r.objects);
  return status == SCREE_OK ? 0 : cli_fail(&error);
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
    .run = run,
};
