/* What the page in the browser asks of scree: scans that stay in memory between questions, so that
 * another tolerance costs a choice and not a decimation. A thin layer over the public interface and
 * over what the program says about surfaces: its sentences are the program's own. Files are those
 * of the worker's memory. What a verb of the program does at once (check, clump) the worker leaves
 * to the program, which is in the same module. */
#include "cli/surface.h"
#include "report/page_parts.h"
#include "report/program.h"
#include "report/provenance.h"

#include <emscripten.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The page has the report's script once, for itself and for reports, and puts it in this place. */
const char *const scree_page_script[] = {"@SCRIPT@", NULL};

typedef struct web_scan {
  char file[256], name[128]; /* as given; short and unlike those of the others */
  scree_scan scan;
  double scale;    /* into metres, once it is decimated */
  char note[1536]; /* what to say of it beside the answer, a line each */
  scree_curve *curve;
  scree_choice choice;
} web_scan;

/* One module serves one page: what a program has in main's variables stands here. */
enum { MOST_SCANS = 64 };
static web_scan *scans[MOST_SCANS]; /* each stays where it is: its curve borrows its mesh */
static size_t scan_count;
static scree_set_choice set;
static scree_choice_options options;
static scree_simplify_options simplify;
static scree_choice_rule rule;
static scree_work_start start;
static scree_error error;

/* Never false: who cancels ends the worker. */
EM_JS(void, web_report, (const char *phase, double fraction),
      { Module.report(UTF8ToString(phase), fraction); });
static bool report(void *context, const char *phase, double fraction) {
  (void)context;
  web_report(phase, fraction);
  return true;
}
static const scree_progress progress = {report, NULL, 0.1};

EMSCRIPTEN_KEEPALIVE const char *web_error(void) {
  return error.message;
}
EMSCRIPTEN_KEEPALIVE const char *web_version(void) {
  return scree_version();
}
EMSCRIPTEN_KEEPALIVE double web_memory_peak(void) {
  return (double)scree_memory_peak();
}

static void forget_choices(void) {
  for (size_t i = 0; i < scan_count; i++) {
    scree_choice_free(&scans[i]->choice);
    scans[i]->choice = (scree_choice){0};
  }
  scree_set_choice_free(&set);
  set = (scree_set_choice){0};
}

EMSCRIPTEN_KEEPALIVE void web_close(size_t index) {
  web_scan *s = scans[index];
  forget_choices();
  scree_curve_free(s->curve);
  scree_scan_free(&s->scan);
  free(s);
  memmove(scans + index, scans + index + 1, (scan_count - index - 1) * sizeof *scans);
  scan_count--;
}

static bool name_taken(const char *name) {
  for (size_t i = 0; i < scan_count; i++)
    if (!strcmp(scans[i]->name, name)) return true;
  return false;
}

/* Reads a file, repairs it where need be, and says on stdout what `scree check` and `scree repair`
 * say of it. It becomes the last of the scans. */
EMSCRIPTEN_KEEPALIVE int web_open(const char *file, double unit_m) {
  static const cli_common common = {.unit_given = true};
  cli_source source = CLI_SOURCE_DEFAULTS;
  scree_repair_report repair;
  if (scan_count == 0) start = scree_work_started();
  if (scan_count == MOST_SCANS)
    return cli_refuse(&error, SCREE_LIMIT, file, "64 scans are open already");
  web_scan *s = calloc(1, sizeof *s);
  if (!s) return cli_refuse(&error, SCREE_OUT_OF_MEMORY, file, "out of memory");
  s->scale = 1;
  source.unit = unit_m;
  cli_input_obeys(&common);
  cli_input_options input = cli_source_options(&source);
  input.remarked = true; /* with the note */
  scree_status status =
      cli_load_closed(file, &input, false, &progress, &s->scan, &s->scale, &repair, &error);
  if (status != SCREE_OK) {
    free(s);
    return status;
  }
  char plain[sizeof s->name - 24];
  snprintf(s->file, sizeof s->file, "%s", file);
  cli_short_name(file, plain, sizeof plain);
  snprintf(s->name, sizeof s->name, "%s", plain);
  for (size_t n = 2; name_taken(s->name); n++)
    snprintf(s->name, sizeof s->name, "%s-%zu", plain, n);
  char repaired[sizeof s->note];
  cli_repair_text(&repair, repaired, sizeof repaired);
  if (!cli_is_sample(file, NULL))
    cli_scan_remarks(&input, &s->scan, s->scale, s->note, sizeof s->note);
  if (repaired[0]) cli_add_line(s->note, sizeof s->note, "%s", repaired);
  scans[scan_count++] = s;
  if (cli_is_sample(file, NULL)) return SCREE_OK;
  printf("%s: %s\n%10s", file, repair.before.verdict, s->scan.format);
  cli_print_unit(stdout, file, &s->scan);
  putchar('\n');
  cli_print_left_out(stdout, s->scan.degenerate_count);
  cli_print_check(stdout, &repair.before);
  if (repaired[0]) {
    puts("repaired:");
    cli_print_repair(stdout, &repair);
  }
  fflush(stdout);
  return SCREE_OK;
}

EMSCRIPTEN_KEEPALIVE const char *web_name(size_t index) {
  return scans[index]->name;
}

/* Once after web_open: the scan is in metres afterwards. */
EMSCRIPTEN_KEEPALIVE int web_decimate(size_t index) {
  web_scan *s = scans[index];
  simplify = scree_default_simplify_options();
  return scree_curve_build_scaled(&s->scan.mesh, s->scale, &simplify, &progress, &s->curve, &error);
}

/* What `recommended` keeps: an error by its name, a share; not above 0: any. Without a name all are
 * as by default. */
EMSCRIPTEN_KEEPALIVE void web_tolerance(const char *name, double share) {
  if (!name) {
    options = scree_default_choice_options();
    return;
  }
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    if (!strcmp(name, scree_shape_error_name((scree_shape_error)e)))
      options.tolerances[e] = share > 0 ? share : INFINITY;
}
EMSCRIPTEN_KEEPALIVE double web_default_tolerance(const char *name) {
  scree_choice_options usual = scree_default_choice_options();
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    if (!strcmp(name, scree_shape_error_name((scree_shape_error)e))) return usual.tolerances[e];
  return INFINITY;
}

/* Of all scans. */
EMSCRIPTEN_KEEPALIVE int web_choose(int by_rule, double weight) {
  forget_choices();
  rule = (scree_choice_rule)by_rule;
  options.weight = weight;
  scree_choice *choices = calloc(scan_count, sizeof *choices);
  if (!choices) return cli_refuse(&error, SCREE_OUT_OF_MEMORY, "choices", "out of memory");
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < scan_count && status == SCREE_OK; i++) {
    web_scan *s = scans[i];
    status = scree_choose(s->curve, &s->scan.mesh, &options, &progress, &s->choice, &error);
    choices[i] = s->choice;
  }
  if (status == SCREE_OK) status = scree_choose_set(choices, scan_count, &set, &error);
  free(choices);
  return status;
}

EMSCRIPTEN_KEEPALIVE double web_chosen(size_t index) {
  return (double)scree_choice_pick(&scans[index]->choice, rule)->triangle_count;
}

/* choice.json and provenance.json in a folder that is there, and beside them, with `whole`, what
 * else a report is made of and the report. Bytes as `scree choose` writes them under the command
 * line given. */
EMSCRIPTEN_KEEPALIVE int web_write_choice(const char *folder, const char *command, int whole) {
  char path[512];
  scree_choice_entry *entries = calloc(scan_count, sizeof *entries);
  if (!entries) return cli_refuse(&error, SCREE_OUT_OF_MEMORY, folder, "out of memory");
  for (size_t i = 0; i < scan_count; i++) {
    const web_scan *s = scans[i];
    entries[i] = (scree_choice_entry){.name = s->name,
                                      .file = s->file,
                                      .format = s->scan.format,
                                      .checksum = s->scan.checksum,
                                      .unit_m = s->scan.unit_m,
                                      .note = s->note[0] ? s->note : NULL,
                                      .choice = &s->choice};
  }
  const scree_choice_report made = {.entries = entries,
                                    .entry_count = scan_count,
                                    .set = &set,
                                    .options = &options,
                                    .method = simplify.method,
                                    .rule = rule,
                                    .command_line = command};
  snprintf(path, sizeof path, "%s/choice.json", folder);
  scree_status status = scree_choice_json_write(&made, path, true, &error);
  snprintf(path, sizeof path, "%s/choice.csv", folder);
  if (status == SCREE_OK && whole) status = scree_choice_csv_write(&made, path, true, &error);
  snprintf(path, sizeof path, "%s/provenance.json", folder);
  if (status == SCREE_OK) status = scree_provenance_write(&start, command, path, true, &error);
  snprintf(path, sizeof path, "%s/report.html", folder);
  if (status == SCREE_OK && whole)
    status = scree_page_write_named(folder, "scree in the browser", path, true, &error);
  free(entries);
  return status;
}

/* What the page shows of a scan in 3D. */
EMSCRIPTEN_KEEPALIVE int web_write_levels(size_t index, const char *path) {
  return scree_levels_write(scans[index]->curve, &scans[index]->choice,
                            SCREE_LEVELS_BYTES / scan_count, path, true, &error);
}

/* The level of `count` triangles or the next fewer; json_path NULL: without its mass. */
EMSCRIPTEN_KEEPALIVE int web_write_level(size_t index, double count, const char *mesh_path,
                                         const char *json_path, double density) {
  const web_scan *s = scans[index];
  scree_export_options o = scree_default_export_options();
  scree_mesh mesh = {0};
  o.density = density;
  o.unit_m = s->scan.unit_m;
  o.overwrite = true;
  o.source = s->file;
  o.checksum = s->scan.checksum;
  scree_status status =
      scree_curve_mesh(s->curve, scree_curve_find(s->curve, (size_t)count), &mesh, &error);
  if (status == SCREE_OK)
    status = cli_check_rounded(&mesh, mesh_path, o.unit_m, NULL, NULL, &error);
  if (status == SCREE_OK)
    status = scree_particle_export(&mesh, &o, mesh_path, json_path, NULL, &error);
  scree_mesh_free(&mesh);
  return status;
}
