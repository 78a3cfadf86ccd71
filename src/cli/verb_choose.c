#include "base/alloc.h"
#include "cli/choose.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "cli/terminal.h"
#include "report/program.h"
#include "report/provenance.h"

#include <math.h>
#include <string.h>

enum { METHOD_UNSET = -1, RULE_UNSET = -1 };

static const choose_arguments defaults = {.grid = CLI_GRID_DEFAULT,
                                          .source = CLI_SOURCE_DEFAULTS,
                                          .weight = 1,
                                          .density = 2000,
                                          .method = METHOD_UNSET,
                                          .rule = RULE_UNSET};

#define ARGUMENTS choose_arguments
static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", output, "DIR",
            "Write the chosen meshes with mass and inertia, the curves, the figure, the tables and "
            "report.html into DIR."),
    CLI_FLAG_ROW("samples", samples, "Choose for the nine built-in devices."),
    CLI_FLAG_ROW(
        "paper", paper,
        "Do exactly what the paper did: method qecd, its grid, plain Ip; meshes by its choice."),
    CLI_CHOICE_ROW(
        "rule", rule, "RULE", "recommended|paper",
        "Whose choice is told first and written: recommended (keeps tolerances) or paper "
        "(least Ip). Default: recommended."),
    CLI_ROW(CLI_TEXT, "tolerance", tolerance, "LIST",
            "What the recommended level keeps, instead of the defaults, as shares or, of "
            "distances, lengths: mean=0.3%,hausdorff=4%,inertia=2%,widths=3%,thickness=3% are the "
            "defaults; also area, volume, thinnest, convexity, normals; none: does not count."),
    CLI_CHOICE_ROW(
        "method", method, "NAME", "volume|qecd",
        "How to decimate: volume (keeps the volume) or qecd (as the paper). Default: volume."),
    CLI_RANGE_ROW(CLI_REAL, "weight", weight, "W", 1e-9, 1e9,
                  "Weight of the penalty: Ip = eps_s + W Nr/Nm. Default: 1, as the paper."),
    CLI_GRID_OPTION,
    CLI_CHOICE_ROW("area", reference, "AREA", "scan|smooth",
                   "Area that eps_s is measured against: scan (the paper's) or smooth (past the "
                   "scanner's noise, measured on the curve). Default: scan."),
    CLI_FLAG_ROW("errors", errors,
                 "Also the count that each other error alone would choose on the grid, of which "
                 "levels above 2,500 triangles are measured then too."),
    CLI_RANGE_ROW(CLI_REAL, "density", density, "KG/M3", 1e-6, 1e6,
                  "Density in kg/m3, for the mass and inertia written. Default: 2000."),
    CLI_FLAG_ROW("no-repair", no_repair,
                 "Refuse scans that are no closed surface instead of repairing them."),
    CLI_KEEP_HANDLES_ROW(keep_handles),
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("json", json, "Print JSON instead of text."),
    CLI_FLAG_ROW("csv", csv, "Print CSV instead of text: a row per grid level and choice."),
    CLI_FLAG_ROW(
        "force", overwrite,
        "Overwrite existing files; what else an earlier choice left in the folder is removed."),
};

/* "0.3%", "0.003", "0.5mm" or "none" */
static bool parse_bound(const char *word, scree_shape_error error, scree_choice_options *o) {
  double value;
  o->tolerances[error] = o->tolerance_lengths[error] = INFINITY;
  if (!strcmp(word, "none")) return true;
  if (cli_fraction_from_text(word, &value)) {
    o->tolerances[error] = value;
    return value > 0 && value <= 1;
  }
  bool is_distance = error == SCREE_ERROR_MEAN || error == SCREE_ERROR_HAUSDORFF;
  if (!is_distance || !cli_length_from_text(word, &value)) return false;
  o->tolerance_lengths[error] = value;
  return value > 0;
}

static bool find_error(const char *word, scree_shape_error *error) {
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++) {
    *error = (scree_shape_error)e;
    if (!strcmp(word, scree_shape_error_name(*error))) return true;
  }
  *error = SCREE_ERROR_MEAN;
  return !strcmp(word, "mean");
}

/* "mean=0.3%,widths=2%" */
static bool parse_tolerances(const char *text, scree_choice_options *o, char hint[64]) {
  static const char names[] =
      "mean|hausdorff|inertia|widths|thickness|area|volume|thinnest|convexity|normals";
  while (*text) {
    char word[64];
    size_t length = strcspn(text, ",");
    if (length == 0 || length >= sizeof word) return false;
    memcpy(word, text, length);
    word[length] = 0;
    char *bound = strchr(word, '=');
    if (!bound) return false;
    *bound++ = 0;
    scree_shape_error error;
    if (!find_error(word, &error)) return cli_word_hint(names, word, hint, 64), false;
    if (!parse_bound(bound, error, o)) return false;
    text += length;
    if (*text == ',' && !*++text) return false;
  }
  return true;
}

static scree_status list_objects(choose_run *run, scree_error *error) {
  static char sample_words[SCREE_SAMPLE_DEVICES][32];
  size_t samples = run->arguments->samples ? SCREE_SAMPLE_DEVICES : 0;
  run->count = run->left = samples + run->call->input_count;
  SCREE_TRY_ALLOC_ZERO(run->objects, run->count, error);
  SCREE_TRY_ALLOC_ZERO(run->choices, run->count, error);
  for (size_t i = 0; i < run->count; i++) {
    choose_object *o = &run->objects[i];
    if (i < samples)
      snprintf(sample_words[i], sizeof sample_words[i], "sample:%s", scree_sample_name(i));
    o->word = i < samples ? sample_words[i] : run->call->inputs[i - samples];
    cli_distinct_name(o->word, run->objects[0].name, sizeof *o, i, CHOOSE_NAME_BYTES);
  }
  return SCREE_OK;
}

static scree_status load(void *context, size_t index, const scree_progress *progress,
                         scree_mesh *mesh, double *scale, scree_error *error) {
  const choose_run *run = context;
  choose_object *object = &run->objects[index];
  cli_input_options input = cli_source_options(&run->arguments->source);
  scree_repair_report report;
  scree_scan scan;
  char repaired[CHOOSE_NOTE_BYTES];
  input.keep_handles = run->arguments->keep_handles;
  input.remarked = true; /* with the other warnings */
  SCREE_TRY(cli_load_closed(object->word, &input, run->arguments->no_repair, progress, &scan, scale,
                            &report, error));
  memcpy(object->format, scan.format, sizeof object->format);
  object->unit_m = scan.unit_m;
  object->checksum = scan.checksum;
  *mesh = scan.mesh;
  if (!cli_is_sample(object->word, NULL))
    cli_scan_remarks(&input, &scan, *scale, object->note, sizeof object->note);
  cli_repair_text(&report, repaired, sizeof repaired);
  if (repaired[0]) cli_add_line(object->note, sizeof object->note, "%s", repaired);
  if (cli_body_count(&report) > 1)
    cli_add_line(object->note, sizeof object->note,
                 "%zu separate bodies, taken as one rigid particle; `scree repair --body 1`, 2 and "
                 "so on makes a file of each, --largest keeps the largest",
                 cli_body_count(&report));
  return SCREE_OK;
}

static scree_status done(void *context, size_t index, const scree_curve *curve,
                         const scree_choice *choice, const scree_set_choice *set,
                         scree_error *error) {
  return choose_write_meshes(context, index, curve, choice, set, error);
}

static void failed(void *context, size_t index, const scree_error *error) {
  choose_run *run = context;
  cli_fail(error);
  run->objects[index].failed = true;
  run->left--;
}

/* Puts what failed behind the others, both in their order. */
static void part_failed(choose_run *run) {
  size_t kept = 0;
  for (size_t i = 0; i < run->count; i++) {
    choose_object object = run->objects[i];
    scree_choice choice = run->choices[i];
    if (object.failed) continue;
    memmove(&run->objects[kept + 1], &run->objects[kept], (i - kept) * sizeof object);
    memmove(&run->choices[kept + 1], &run->choices[kept], (i - kept) * sizeof choice);
    run->objects[kept] = object;
    run->choices[kept++] = choice;
  }
  run->failed_count = run->count - kept;
  run->count = kept;
}

/* What is to be said of all objects, or of those that are left. */
static void note_all(choose_run *run) {
  char names[CHOOSE_NOTE_BYTES / 2] = "", shown[CLI_PRINTABLE_BYTES];
  size_t used = 0;
  for (size_t i = 0; i < run->failed_count && used < sizeof names; i++)
    used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "",
                             cli_printable(run->objects[run->count + i].word, shown));
  if (run->failed_count && run->count > 1)
    cli_add_line(run->note, sizeof run->note,
                 "Without %s, which could not be used: the set's choice is of the other %zu.",
                 names, run->count);
  else if (run->failed_count)
    cli_add_line(run->note, sizeof run->note,
                 "Without %s, which could not be used: there is no set to choose for.", names);
  run->report.note = run->note;
}

static scree_choice_entry entry_of(const choose_run *run, size_t index) {
  const choose_object *o = &run->objects[index];
  const cli_source *source = &run->arguments->source;
  return (scree_choice_entry){.name = o->name,
                              .file = o->word,
                              .format = o->format,
                              .checksum = o->checksum,
                              .unit_m = o->unit_m,
                              .is_sample = cli_is_sample(o->word, NULL),
                              .sample_resolution = source->resolution,
                              .sample_noise = source->noise,
                              .sample_seed = source->seed,
                              .note = o->note[0] ? o->note : NULL,
                              .mesh_file = o->mesh_path[0] ? o->mesh_path : NULL,
                              .choice = &run->choices[index]};
}

static scree_status write_output(choose_run *run, scree_error *error) {
  const choose_arguments *a = run->arguments;
  SCREE_SCRATCH(scree_choice_entry, entries, run->count, error);
  for (size_t i = 0; i < run->count; i++) entries[i] = entry_of(run, i);
  run->report.entries = entries;
  run->report.entry_count = run->count;
  run->report.set = &run->set;
  run->report.options = &run->options;
  run->report.method = run->simplify.method;
  run->report.command_line = run->call->command_line;
  note_all(run);
  if (a->output) SCREE_TRY(choose_write_reports(run, error));
  cli_terminal_end();
  if (a->json) return scree_choice_json_write(&run->report, "-", false, error);
  if (a->csv) SCREE_TRY(scree_choice_csv_write(&run->report, "-", false, error));
  if (!a->csv && (!run->call->quiet || !a->output)) choose_print(stdout, run, run->call->verbose);
  cli_flush(); /* the answer first */
  if (!run->call->quiet && (a->csv || !run->call->verbose)) choose_print_warnings(stderr, run);
  return SCREE_OK;
}

/* Checks the call, and takes from it what levels are made and chosen by. */
static scree_status take_options(choose_run *run) {
  const choose_arguments *a = run->arguments;
  const cli_verb *verb = run->call->verb;
  cli_grid grid;
  if (run->call->input_count == 0 && !a->samples)
    return cli_misuse(verb, "no scan given: name files, or sample:fp-1 and the like for built-in "
                            "samples, or --samples for all nine");
  if (a->paper && (a->method == SCREE_METHOD_VOLUME || a->weight != 1 ||
                   strcmp(a->grid, defaults.grid) != 0 || a->reference != SCREE_REFERENCE_SCAN))
    return cli_misuse(verb, "--paper is method qecd, weight 1, the scan's area and the grid %s",
                      defaults.grid);
  SCREE_TRY(cli_parse_grid(verb, a->grid, &grid));
  run->options = scree_default_choice_options();
  run->options.rp_min = grid.least;
  run->options.rp_max = grid.most;
  run->options.per_decade = grid.per_decade;
  run->options.weight = a->weight;
  run->options.fine_errors = a->errors;
  run->options.reference = (scree_reference)a->reference;
  char hint[64] = "";
  if (a->tolerance && !parse_tolerances(a->tolerance, &run->options, hint))
    return cli_misuse(
        verb,
        "--tolerance '%s': must be a list of NAME=BOUND as in mean=0.3%%,hausdorff=2mm, bounds "
        "above 0 and up to 100%%, lengths with a unit and of mean and hausdorff alone%s",
        a->tolerance, *hint ? hint : cli_comma_hint(a->tolerance));
  if (a->paper && a->rule != RULE_UNSET && a->rule != SCREE_RULE_PAPER)
    return cli_misuse(verb, "--paper is --rule paper");
  run->report.rule = a->paper                ? SCREE_RULE_PAPER
                     : a->rule != RULE_UNSET ? (scree_choice_rule)a->rule
                                             : SCREE_RULE_RECOMMENDED;
  run->simplify = scree_default_simplify_options();
  if (a->method != METHOD_UNSET) run->simplify.method = (scree_method)a->method;
  if (a->paper) run->simplify.method = SCREE_METHOD_QECD;
  return SCREE_OK;
}

static void free_run(choose_run *run) {
  cli_stage_discard(&run->stage);
  for (size_t i = 0; run->choices && i < run->count; i++) scree_choice_free(&run->choices[i]);
  scree_set_choice_free(&run->set);
  scree_free(run->choices);
  scree_free(run->objects);
}

static scree_status choose(choose_run *run, scree_error *error) {
  const bool files = run->arguments->output;
  const scree_choice_job job = {run->count,          run->simplify, run->options, load,
                                files ? done : NULL, run,           failed};
  if (files) SCREE_TRY(choose_prepare_folder(run, error));
  SCREE_TRY(scree_choose_each(&job, run->call->progress, run->choices, &run->set, error));
  part_failed(run);
  return write_output(run, error);
}

static scree_status run_choose(const cli_call *call, scree_error *error) {
  SCREE_CLEANUP(free_run)
  choose_run run = {.call = call, .arguments = call->options, .start = scree_work_started()};
  SCREE_TRY(take_options(&run));
  SCREE_TRY(list_objects(&run, error));
  scree_status status = choose(&run, error);
  if (status != SCREE_OK) cli_stage_hide(&run.stage, error);
  if (status != SCREE_OK) return run.left ? status : CLI_TOLD; /* else each was told */
  return run.failed_count ? CLI_TOLD : SCREE_OK;
}

const cli_verb cli_verb_choose = {
    .name = "choose",
    .summary = "find the triangle count to use, and write that mesh",
    .inputs = "[FILE...] [--samples]",
    .description =
        "Decimates each scan once, through every triangle count, and recommends the coarsest level "
        "that keeps a tolerance on each of several errors against the scan: mean distance 0.3 %, "
        "Hausdorff distance 4 % (of the body's size, the diameter of the sphere of its area), "
        "inertia 2 %, every width 3 %, and 3 % for the mean of distance over local wall "
        "thickness.\n\n"
        "Beside it stand the paper's criterion (Katagiri and Koyanaka 2020), Ip = eps_s + W Nr/Nm "
        "with eps_s = |S - Sm|/Sm and Rp = Nr/Nm: the least on a logarithmic grid of Rp. "
        "Several scans also get the paper's one Rp for all.\n\n"
        "Scans that are no closed surface are repaired first. One that cannot be used is told on "
        "stderr and left out; the exit code is then 1. sample:NAME stands for a built-in sample. "
        "Nothing is written without -o.",
    .examples = "scree choose phone.stl -o phone\n"
                "scree choose *.stl -o devices --tolerance mean=0.2%,hausdorff=1mm\n"
                "scree choose --samples --paper\n"
                "scree choose sample:fp-1 sample:dc-1 --noise 0mm --json",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 0,
    .input_maximum = SIZE_MAX,
    .partners = "density:output resolution:sample:|samples noise:sample:|samples "
                "sample-seed:sample:|samples",
    .exclusive = "json|csv",
    .run = run_choose,
};
