/* scree check: what is wrong with a scan, and whether it can serve as a particle. */
#include "base/alloc.h"
#include "cli/input.h"
#include "cli/surface.h"
#include "cli/terminal.h"
#include "report/program.h"

typedef struct check_arguments {
  cli_source source;
  bool fast, json;
} check_arguments;

#define ARGUMENTS check_arguments
static const cli_option options[] = {
    CLI_FLAG_ROW("fast", fast, "Do not look for self-intersections."),
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("json", json, "Print JSON instead of text."),
};

static const check_arguments defaults = {.source = CLI_SOURCE_DEFAULTS};

/* One file and all that is known of it. */
typedef struct checked {
  scree_scan scan;
  scree_check check;
  scree_error error;
  bool read;
} checked;

static scree_status check_one(const cli_call *call, const char *path, checked *c) {
  const check_arguments *arguments = call->options;
  cli_input_options input = cli_source_options(&arguments->source);
  scree_check_options how = scree_default_check_options();
  how.intersections = !arguments->fast;
  SCREE_TRY(cli_load(path, &input, call->progress, &c->scan, &c->error));
  c->read = true;
  scree_status status = scree_mesh_check(&c->scan.mesh, &how, call->progress, &c->check, &c->error);
  scree_mesh_free(&c->scan.mesh); /* the counts are enough, and the rest of a scan holds nothing */
  return status == SCREE_OK ? status : cli_name_in_error(path, &c->error);
}

static void print_one(const cli_call *call, const char *path, const checked *c) {
  char shown[CLI_PRINTABLE_BYTES];
  printf("%s: %s\n", cli_printable(path, shown), c->check.verdict);
  if (call->quiet) return;
  printf("%10s", c->scan.format);
  cli_print_unit(stdout, path, &c->scan);
  putchar('\n');
  cli_print_left_out(stdout, c->scan.degenerate_count);
  cli_print_check(stdout, &c->check);
}

static scree_status print_json(const cli_call *call, const checked *all, scree_error *error) {
  SCREE_SCRATCH_ZERO(scree_check_entry, entries, call->input_count, error);
  for (size_t i = 0; i < call->input_count; i++) {
    const checked *c = &all[i];
    bool failed = c->error.status != SCREE_OK;
    entries[i] = (scree_check_entry){.file = call->inputs[i],
                                     .scan = c->read ? &c->scan : NULL,
                                     .unit_m = c->scan.unit_m,
                                     .check = failed ? NULL : &c->check,
                                     .failure = failed ? c->error.message : NULL};
  }
  return scree_check_json_write(entries, call->input_count, call->command_line, "-", false, error);
}

static scree_status run(const cli_call *call, scree_error *error) {
  const check_arguments *arguments = call->options;
  SCREE_SCRATCH_ZERO(checked, all, call->input_count, error);
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < call->input_count; i++) {
    checked *c = &all[i];
    if (check_one(call, call->inputs[i], c) != SCREE_OK) {
      status = cli_fail(&c->error);
      if (c->error.status == SCREE_CANCELLED) break;
      continue;
    }
    if (!c->check.usable) status = CLI_TOLD;
    cli_terminal_end();
    if (!arguments->json) print_one(call, call->inputs[i], c);
  }
  if (arguments->json) SCREE_TRY(print_json(call, all, error));
  return status;
}

const cli_verb cli_verb_check = {
    .name = "check",
    .summary = "say what is wrong with a scan, and whether it can serve as a particle",
    .inputs = "FILE...|sample:NAME...",
    .description =
        "Counts what is wrong with each surface (holes, non-manifold edges and vertices, facets "
        "wound unlike, inside-out shells, duplicate and degenerate facets, facets that cross, "
        "touch or overlap, shells in shells) and says whether it can serve as a particle: closed, "
        "manifold, outward, nowhere meeting itself. Cavities and separate bodies are counted, but "
        "are no defects. Facets that meet are found exactly, without tolerances.\n\n"
        "Exit code 0 where every file can serve, 1 where one cannot or could not be read.",
    .examples = "scree check scan.stl\n"
                "scree check --json -u m *.ply\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = SIZE_MAX,
    .partners = CLI_SAMPLE_PARTNERS,
    .run = run,
};
