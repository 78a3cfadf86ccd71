/* scree repair: a surface that can serve as a particle of one that cannot, or a refusal. */
#include "base/alloc.h"
#include "cli/input.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "cli/terminal.h"
#include "report/program.h"

#include <stdio.h>
#include <string.h>

typedef struct repair_arguments {
  const char *output, *cut_plane;
  cli_source source;
  double seam_tolerance, debris_share, cavity_share, volume_change;
  double hole_share;
  size_t body; /* 0: all */
  bool flat_holes, drop_cavities, largest, no_cut, no_merge, folds, fast;
  bool keep_handles, json, force;
} repair_arguments;

#define ARGUMENTS repair_arguments

static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", output, "FILE",
            "Where the repaired surface goes: .stl, .ply, .obj, .off or .3mf."),
    CLI_RANGE_ROW(CLI_SHARE, "seam", seam_tolerance, "SHARE", 0, 0.01,
                  "Boundary vertices no farther apart than this share of the bounding box diagonal "
                  "may be united to close a seam. Default: 1e-4."),
    CLI_RANGE_ROW(CLI_SHARE, "holes", hole_share, "SHARE", 0, 1,
                  "Fill holes whose filling is at most this share of the area; 0 fills none. Where "
                  "the surface does not go on flat, the filling has its slope. Default: 0.45."),
    CLI_FLAG_ROW("flat", flat_holes,
                 "Fill with no new vertices, as where flat faces with rough rims are missing."),
    CLI_RANGE_ROW(CLI_SHARE, "debris", debris_share, "SHARE", 0, 0.999,
                  "Drop shells with less than this share of the largest shell's area; cavities are "
                  "kept. Default: 0.01."),
    CLI_FLAG_ROW("largest", largest,
                 "Keep only the largest shell, after merging, and its cavities."),
    CLI_RANGE_ROW(
        CLI_COUNT, "body", body, "NUMBER", 1, 1000000,
        "Keep only this one of several separate bodies, and its cavities: 1 is the one of "
        "the largest area, 2 the next."),
    CLI_RANGE_ROW(CLI_SHARE, "cavities", cavity_share, "SHARE", 0, 1,
                  "Fill cavities, the smallest first, up to this share of the volume in all: "
                  "nothing ever touches them. Default: 1e-3."),
    CLI_FLAG_ROW("drop-cavities", drop_cavities, "Fill all cavities: drop their shells."),
    CLI_ROW(CLI_TEXT, "cut-plane", cut_plane, "auto|z=LENGTH",
            "Cut off what lies below a plane, keep the largest shell that stands on it and close "
            "it flat: auto, the plane that carries most of the boundary, as a table's rim; or "
            "z=12mm (x=, y=), without a unit in the file's."),
    CLI_FLAG_ROW("no-cut", no_cut,
                 "Refuse a surface that meets itself instead of cutting the place out and filling "
                 "the hole."),
    CLI_FLAG_ROW(
        "no-merge", no_merge,
        "Refuse shells that cross, overlap or touch instead of merging them into one surface."),
    CLI_FLAG_ROW("merge-folds", folds,
                 "Where a shell meets itself, keep the outside of what it winds round instead of "
                 "cutting the place out."),
    CLI_RANGE_ROW(CLI_SHARE, "volume-change", volume_change, "SHARE", 0, 1,
                  "Refuse where cutting and merging change the volume by more than this share. "
                  "Default: 0.01."),
    CLI_KEEP_HANDLES_ROW(keep_handles),
    CLI_FLAG_ROW("fast", fast, "Do not look for self-intersections: the result may have some."),
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("json", json, "Print JSON instead of text."),
    CLI_FLAG_ROW("force", force, "Overwrite an existing file."),
};

static const repair_arguments defaults = {.source = CLI_SOURCE_DEFAULTS,
                                          .seam_tolerance = 1e-4,
                                          .debris_share = 0.01,
                                          .cavity_share = 1e-3,
                                          .volume_change = 0.01,
                                          .hole_share = 0.45};

static scree_repair_options options_of(const repair_arguments *a) {
  scree_repair_options o = scree_default_repair_options();
  o.seam_tolerance = a->seam_tolerance;
  o.debris_share = a->debris_share;
  o.cavity_share = a->cavity_share;
  o.volume_change = a->volume_change;
  o.hole_share = a->hole_share;
  o.flat_holes = a->flat_holes;
  o.drop_cavities = a->drop_cavities;
  o.keep_largest = a->largest;
  o.keep_body = a->body;
  o.cut_intersections = !a->no_cut;
  o.merge_shells = !a->no_merge;
  o.merge_folds = a->folds;
  o.intersections = !a->fast;
  if (a->keep_handles) o.handle_edges = 0;
  return o;
}

static scree_status take_plane(const cli_call *call, double unit, scree_repair_options *o) {
  const char *text = ((const repair_arguments *)call->options)->cut_plane;
  double plain;
  if (!text) return SCREE_OK;
  o->cut = SCREE_CUT_AUTO;
  if (!strcmp(text, "auto")) return SCREE_OK;
  o->cut = SCREE_CUT_GIVEN;
  if (*text < 'x' || *text > 'z' || text[1] != '=' ||
      !cli_length_from_text(text + 2, &o->plane.offset))
    return cli_misuse(call->verb, "--cut-plane %s: must be auto, or as z=12mm", text);
  if (cli_real_from_text(text + 2, &plain)) o->plane.offset = plain * unit;
  o->plane.normal[*text - 'x'] = 1;
  return SCREE_OK;
}

static scree_status write_result(const cli_call *call, const scree_mesh *mesh, scree_error *error) {
  const repair_arguments *a = call->options;
  const scree_write_options write = cli_write_options(call, a->output, a->source.unit, a->force);
  scree_check_options how = {.intersections = !a->fast};
  SCREE_TRY(cli_check_rounded(mesh, a->output, a->source.unit, &how, call->progress, error));
  return scree_mesh_write(mesh, a->output, &write, error);
}

static void print_text(const cli_call *call, const scree_scan *scan,
                       const scree_repair_report *report, bool written) {
  bool sound = report->after.usable;
  char shown[CLI_PRINTABLE_BYTES];
  printf("%s: %s\n", cli_printable(call->inputs[0], shown), report->before.verdict);
  cli_print_left_out(stdout, scan->degenerate_count);
  cli_print_repair(stdout, report);
  if (sound && !written) return; /* why not is the error's to say */
  printf("%s: %s\n", sound ? "repaired" : "left", report->after.verdict);
  if (call->quiet) return;
  cli_print_check(stdout, &report->after);
  printf("coordinates in %s\n",
         cli_unit_name(((const repair_arguments *)call->options)->source.unit));
}

static scree_status print_json(const cli_call *call, const scree_scan *scan,
                               const scree_repair_report *report, const scree_error *failure) {
  const repair_arguments *a = call->options;
  bool failed = failure->status != SCREE_OK;
  const scree_check_entry entry = {.file = call->inputs[0],
                                   .scan = scan,
                                   .unit_m = scan->unit_m,
                                   .check = &report->before,
                                   .repair = report,
                                   .output = failed ? NULL : a->output,
                                   .failure = failed ? failure->message : NULL};
  scree_error error;
  scree_status status = scree_check_json_write(&entry, 1, call->command_line, "-", false, &error);
  return status == SCREE_OK ? status : cli_fail(&error);
}

static scree_status run(const cli_call *call, scree_error *error) {
  const repair_arguments *a = call->options;
  scree_repair_options how = options_of(a);
  cli_input_options input = cli_source_options(&a->source);
  scree_repair_report report = {.seam_distance = 0};
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  SCREE_CLEANUP(scree_mesh_free) scree_mesh repaired = {0};
  if (!a->output) return cli_misuse(call->verb, "say with -o where the result is to go");
  SCREE_TRY(cli_check_ending(call->verb, a->output, CLI_MESH));
  SCREE_TRY(take_plane(call, a->source.unit, &how));
  SCREE_TRY(cli_check_output(call, a->output, a->force, error));
  SCREE_TRY(cli_load(call->inputs[0], &input, call->progress, &scan, error));
  (void)take_plane(call, scan.unit_m, &how); /* which the file may state */
  scree_status status =
      scree_mesh_repair(&scan.mesh, &how, call->progress, &repaired, &report, error);
  if (status == SCREE_BAD_MESH) cli_hint_at_option(call->inputs[0], &report, &how, error);
  if (status != SCREE_OK) cli_name_in_error(call->inputs[0], error);
  if (status != SCREE_OK && status != SCREE_BAD_MESH) return status;
  if (status == SCREE_OK) status = write_result(call, &repaired, error);
  error->status = status; /* which has no meaning where all went well */
  cli_terminal_end();
  scree_status told = SCREE_OK;
  if (a->json)
    told = print_json(call, &scan, &report, error);
  else
    print_text(call, &scan, &report, status == SCREE_OK);
  return status == SCREE_OK ? told : status;
}

const cli_verb cli_verb_repair = {
    .name = "repair",
    .summary = "make a scan a closed surface that can serve as a particle, or say why not",
    .inputs = "FILE|sample:NAME",
    .description =
        "Welds, drops duplicate and degenerate facets, closes seams, splits T-junctions and "
        "non-manifold edges and vertices, turns facets to agree and shells outward, fills "
        "holes, drops debris, fills small cavities and cuts short handles.\n\n"
        "Cuts out places where a shell meets itself, or merges its folds where that keeps more of "
        "the body. Merges shells that cross, overlap or touch into the surface of their union.\n\n"
        "Prints what was done with counts, and area and volume before and after. The result passes "
        "`scree check`, or nothing is written and what remains is said.\n\n"
        "Exit code 0 where the result was written, 2 for wrong usage, 1 otherwise.",
    .examples = "scree repair scan.stl -o closed.stl\n"
                "scree repair scan.ply -o closed.ply --holes 60% --largest\n"
                "scree repair rock-on-table.obj --cut-plane auto -o rock.ply\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = 1,
    .partners = CLI_SAMPLE_PARTNERS,
    .exclusive = "largest|body",
    .run = run,
};
