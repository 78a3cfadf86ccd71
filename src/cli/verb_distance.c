/* scree distance: how far two surfaces are apart. */
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

static const cli_option options[] = {
    {"points", CLI_COUNT, offsetof(distance_arguments, points), "N",
     "Parts that each surface is cut in, every facet at least one. Default: the greater vertex "
     "count, at least 10,000, and more until the means are exact to 1 %.",
     1, 268435456, NULL},
    {"gap", CLI_SHARE, offsetof(distance_arguments, gap), "SHARE",
     "Go on until the Hausdorff distance is known to this share of itself; 0: only sample, and say "
     "the bound that follows. Default: 0.01.",
     0, 1e6, NULL},
    {"one-way", CLI_FLAG, offsetof(distance_arguments, one_way), NULL,
     "Only from A to B, not back.", 0, 0, NULL},
    CLI_SOURCE_OPTIONS(distance_arguments),
    {"json", CLI_FLAG, offsetof(distance_arguments, json), NULL, "JSON: one object, in metres.", 0,
     0, NULL},
};

static scree_status read_two(const cli_call *call, scree_scan scans[2], scree_error *error) {
  const distance_arguments *arguments = call->options;
  cli_input_options input = cli_source_options(&arguments->source);
  SCREE_TRY(cli_load(call->inputs[0], &input, call->progress, &scans[0], error));
  scree_status status = cli_load(call->inputs[1], &input, call->progress, &scans[1], error);
  if (status != SCREE_OK) scree_scan_free(&scans[0]);
  return status;
}

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

static int run(const cli_call *call) {
  const distance_arguments *arguments = call->options;
  scree_scan scans[2];
  scree_error error;
  if (read_two(call, scans, &error) != SCREE_OK) return cli_fail(&error);
  scree_distance_entry entry = {.file = {call->inputs[0], call->inputs[1]},
                                .checksum = {scans[0].checksum, scans[1].checksum},
                                .unit_m = {scans[0].unit_m, scans[1].unit_m},
                                .options = scree_default_distance_options()};
  entry.options.sample_count = arguments->points;
  entry.options.hausdorff_gap = arguments->gap;
  entry.options.one_way = arguments->one_way;
  scree_status status = scree_mesh_distance(&scans[0].mesh, &scans[1].mesh, &entry.options,
                                            call->progress, &entry.distance, &error);
  scree_scan_free(&scans[0]);
  scree_scan_free(&scans[1]);
  cli_terminal_end();
  if (status == SCREE_OK && arguments->json)
    status = scree_distance_json_write(&entry, call->command_line, "-", false, &error);
  else if (status == SCREE_OK)
    print_text(&entry, arguments->source.unit);
  return status == SCREE_OK ? 0 : cli_fail(&error);
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
