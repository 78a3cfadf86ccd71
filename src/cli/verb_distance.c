/* scree distance: how far two surfaces are apart. */
#include "base/alloc.h"
#include "cli/input.h"
#include "cli/terminal.h"
#include "report/program.h"

#include <stdio.h>

typedef struct distance_arguments {
  cli_source source;
  double gap;
  size_t points;
  bool json, one_way;
} distance_arguments;

static const distance_arguments defaults = {.source = CLI_SOURCE_DEFAULTS, .gap = 0.01};

#define ARGUMENTS distance_arguments
static const cli_option options[] = {
    CLI_RANGE_ROW(
        CLI_COUNT, "points", points, "N", 1, 268435456,
        "Parts that each surface is cut in, every facet at least one. Default: the greater vertex "
        "count, at least 10,000, and more until the means are exact to 1 %."),
    CLI_RANGE_ROW(CLI_SHARE, "gap", gap, "SHARE", 0, 1e6,
                  "Go on until the Hausdorff distance is known to this share of itself; 0: only "
                  "sample, and say the bound that follows. Default: 0.01."),
    CLI_FLAG_ROW("one-way", one_way, "Only from A to B, not back."),
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("json", json, "JSON: one object, in metres."),
};

static void print_way(const char *from, const char *to, const scree_deviation *d, double unit) {
  char shown[2][CLI_PRINTABLE_BYTES];
  printf("%s to %s (%zu point%s)\n", cli_printable(from, shown[0]), cli_printable(to, shown[1]),
         d->sample_count, cli_plural(d->sample_count));
  printf("  mean %.6g, rms %.6g, largest %.6g (no point beyond %.6g), at %.6g, %.6g, %.6g\n",
         d->mean / unit, d->rms / unit, d->maximum / unit, d->maximum_bound / unit, d->at[0] / unit,
         d->at[1] / unit, d->at[2] / unit);
}

static void print_text(const scree_distance_entry *entry, double unit) {
  const scree_distance *d = &entry->distance;
  print_way(entry->file[0], entry->file[1], &d->forward, unit);
  if (!entry->options.one_way) print_way(entry->file[1], entry->file[0], &d->backward, unit);
  printf("%s %.6g, at most %.6g; all lengths in %s\n",
         entry->options.one_way ? "one-way Hausdorff distance" : "Hausdorff distance",
         d->hausdorff / unit, d->hausdorff_bound / unit, cli_unit_name(unit));
}

static scree_status run(const cli_call *call, scree_error *error) {
  const distance_arguments *arguments = call->options;
  cli_input_options input = cli_source_options(&arguments->source);
  SCREE_CLEANUP(scree_scan_free) scree_scan a = {0};
  SCREE_CLEANUP(scree_scan_free) scree_scan b = {0};
  SCREE_TRY(cli_load(call->inputs[0], &input, call->progress, &a, error));
  SCREE_TRY(cli_load(call->inputs[1], &input, call->progress, &b, error));
  scree_distance_entry entry = {.file = {call->inputs[0], call->inputs[1]},
                                .checksum = {a.checksum, b.checksum},
                                .unit_m = {a.unit_m, b.unit_m},
                                .options = scree_default_distance_options()};
  entry.options.sample_count = arguments->points;
  entry.options.hausdorff_gap = arguments->gap;
  entry.options.one_way = arguments->one_way;
  SCREE_TRY(scree_mesh_distance(&a.mesh, &b.mesh, &entry.options, call->progress, &entry.distance,
                                error));
  cli_terminal_end();
  if (arguments->json)
    return scree_distance_json_write(&entry, call->command_line, "-", false, error);
  print_text(&entry, arguments->source.unit);
  return SCREE_OK;
}

const cli_verb cli_verb_distance = {
    .name = "distance",
    .summary = "mean, RMS and Hausdorff distance between two surfaces",
    .inputs = "A B",
    .description = "Measures how far the points of A lie from the surface of B, and back: mean and "
                   "root mean square over the area, the largest found, and a bound that no point "
                   "exceeds. As Metro does, but nothing is random: the same files give the same "
                   "digits. sample:NAME stands for a built-in sample. Text is in the files' unit.",
    .examples = "scree distance scan.stl simplified.stl\n"
                "scree distance --gap 0.001 --json scan.stl simplified.stl\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 2,
    .input_maximum = 2,
    .partners = CLI_SAMPLE_PARTNERS,
    .run = run,
};
