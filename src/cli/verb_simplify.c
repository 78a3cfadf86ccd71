/* scree simplify: one level of the decimation as a file. */
#include "base/number.h"
#include "base/owned.h"
#include "cli/input.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "cli/terminal.h"

#include <math.h>
#include <string.h>

enum { PATH_BYTES = 4096 };

typedef struct simplify_arguments {
  const char *output;
  cli_source source;
  double rp, error, density;
  size_t count;
  int method;
  cli_soundness soundness;
  bool force, fit;
} simplify_arguments;

#define ARGUMENTS simplify_arguments
static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", output, "FILE",
            "The file to write: .stl, .ply, .obj, .off or .3mf by its extension; - writes a binary "
            "STL to stdout."),
    CLI_RANGE_ROW(CLI_SHARE, "rp", rp, "RP", 1e-12, 1,
                  "Keep this share of the triangles, as in 1e-3: the first level with at most RP "
                  "times the scan's count, rounded down. A closed surface has an even count."),
    {"count", CLI_COUNT, offsetof(simplify_arguments, count), "COUNT",
     "Keep at most this many triangles; recommended: as many as choose recommends.", 1,
     4294967295.0, "recommended", NULL, NULL},
    CLI_RANGE_ROW(
        CLI_LENGTH, "error", error, "LENGTH", 1e-12, 1e12,
        "Go as far as no collapse moves the surface by more than this, as in 0.05mm: by the "
        "quadric error, an estimate, not a bound. Costlier collapses are left out and others go "
        "on, so that the mesh is none of the levels that curve shows. May be given with -r or -n."),
    CLI_CHOICE_ROW("method", method, "METHOD", "volume|qecd",
                   "volume keeps the volume at every level; qecd is MeshLab's quadric edge "
                   "collapse decimation. Default: volume."),
    CLI_FLAG_ROW("fit", fit,
                 "Move the level's vertices to where its surface is nearer to the scan: the mean "
                 "distance falls by some per cent, the volume stays, the area may be further off."),
    CLI_RANGE_ROW(
        CLI_REAL, "density", density, "KG/M3", 1e-6, 1e6,
        "Also write mass, centre of mass and inertia of the result at this density in kg/m3 into a "
        ".json of the same name, as export does. The surface must be closed."),
    CLI_SOUNDNESS_OPTIONS,
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("force", force, "Overwrite an existing file."),
};

static const simplify_arguments defaults = {.source = CLI_SOURCE_DEFAULTS};

/* What was written: of a fitted level the errors are its own, and the quadric error is none. */
typedef struct written {
  double area, volume;
} written;

static void say(const cli_call *call, const scree_curve *curve, size_t index, written is) {
  const simplify_arguments *arguments = call->options;
  scree_level first, level;
  char shown[CLI_PRINTABLE_BYTES], quadric[64] = "", area[SCREE_NUMBER_SIZE],
                                   volume[SCREE_NUMBER_SIZE];
  const char *word = cli_printable(call->inputs[0], shown);
  scree_curve_facts facts = scree_curve_get_facts(curve);
  scree_curve_level(curve, 0, &first);
  scree_curve_level(curve, index, &level);
  cli_terminal_end();
  if (call->quiet) return;
  if (!arguments->fit)
    snprintf(quadric, sizeof quadric, ", quadric error %.3g mm", level.quadric_error * 1e3);
  fprintf(stderr,
          "%s: %zu -> %zu triangles (%.3g %%) by %s%s; area off by %s, volume by %s%s; coordinates "
          "in %s\n",
          word, first.triangle_count, level.triangle_count, 100 * level.rp,
          scree_method_name(facts.method), arguments->fit ? ", fitted" : "",
          scree_percent_text(fabs(is.area - first.area) / first.area, area),
          scree_percent_text(
              first.volume != 0 ? fabs(is.volume - first.volume) / fabs(first.volume) : 0, volume),
          quadric, cli_unit_name(arguments->source.unit));
  if (!facts.closed)
    fprintf(stderr, "%s: not closed: %zu boundary edge%s; the volume means nothing\n", word,
            facts.boundary_edge_count, cli_plural(facts.boundary_edge_count));
  if (facts.locked_vertex_count > 0)
    fprintf(stderr, "%s: non-manifold places: %zu of the vertices stay where they are\n", word,
            facts.locked_vertex_count);
}

static scree_status write_plain(const cli_call *call, const scree_mesh *mesh, scree_error *error) {
  const simplify_arguments *arguments = call->options;
  const scree_write_options write =
      cli_write_options(call, arguments->output, arguments->source.unit, arguments->force);
  return scree_mesh_write(mesh, arguments->output, &write, error);
}

/* The mesh, and beside it what it weighs. */
static scree_status write_with_mass(const cli_call *call, const scree_scan *scan,
                                    const scree_mesh *mesh, scree_error *error) {
  const simplify_arguments *arguments = call->options;
  scree_export_options o = scree_default_export_options();
  char path[PATH_BYTES];
  o.density = arguments->density;
  o.unit_m = arguments->source.unit;
  o.overwrite = arguments->force;
  o.source = call->inputs[0];
  o.command_line = call->command_line;
  o.checksum = scan->checksum;
  SCREE_TRY(cli_beside(arguments->output, ".json", path, sizeof path, error));
  return scree_particle_export(mesh, &o, arguments->output, path, NULL, error);
}

static scree_status write_level(const cli_call *call, const scree_scan *scan,
                                const scree_curve *curve, size_t index, written *is,
                                scree_error *error) {
  const simplify_arguments *arguments = call->options;
  char shown[CLI_PRINTABLE_BYTES];
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  SCREE_TRY(arguments->fit ? scree_curve_fit(curve, index, &mesh, error)
                           : scree_curve_mesh(curve, index, &mesh, error));
  SCREE_TRY(scree_mesh_area_volume(&mesh, &is->area, &is->volume, error));
  if (!arguments->soundness.unchecked)
    SCREE_TRY(cli_check_rounded(&mesh, arguments->output, arguments->source.unit, NULL,
                                call->progress, error));
  SCREE_TRY(arguments->density > 0 ? write_with_mass(call, scan, &mesh, error)
                                   : write_plain(call, &mesh, error));
  double lost = cli_volume_lost(&mesh, arguments->output, arguments->source.unit);
  if (lost >= CLI_NOTABLE_LOSS && !call->quiet)
    fprintf(stderr,
            "%s: an STL holds single precision, which changes the volume by %.2g of it here; .ply, "
            ".obj and .off hold it\n",
            cli_printable(arguments->output, shown), lost);
  return SCREE_OK;
}

/* What is to be written, before long work. */
static scree_status check_output(const cli_call *call, scree_error *error) {
  const simplify_arguments *arguments = call->options;
  char path[PATH_BYTES];
  if (!strcmp(arguments->output, "-")) return SCREE_OK;
  scree_status status = cli_check_output(call, arguments->output, arguments->force, error);
  if (status != SCREE_OK || !(arguments->density > 0)) return status;
  SCREE_TRY(cli_beside(arguments->output, ".json", path, sizeof path, error));
  return cli_check_output(call, path, arguments->force, error);
}

/* A count that was asked for and not reached. */
static void say_above(const cli_call *call, size_t count, size_t target) {
  const simplify_arguments *arguments = call->options;
  char shown[CLI_PRINTABLE_BYTES];
  const char *word = cli_printable(call->inputs[0], shown);
  if (arguments->error > 0)
    fprintf(stderr,
            "%s: %zu triangles, not the %zu asked for: no collapse is left within the error of %g "
            "mm\n",
            word, count, target, arguments->error * 1e3);
  else
    fprintf(stderr, "%s: %zu triangles is the lowest count that could be reached\n", word, count);
}

static scree_status simplify(const cli_call *call, scree_error *error) {
  const simplify_arguments *arguments = call->options;
  scree_simplify_options simplify_options = scree_default_simplify_options();
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  SCREE_OWNED(scree_curve, curve);
  bool recommended = arguments->count == SIZE_MAX;
  size_t target = recommended ? 0 : arguments->count, index;
  double scale;
  scree_level level;
  written is = {0};
  SCREE_TRY(check_output(call, error));
  SCREE_TRY(
      cli_load_for_levels(call, &arguments->source, &arguments->soundness, &scan, &scale, error));
  if (arguments->rp > 0) target = scree_choice_target(arguments->rp, scan.mesh.triangle_count);
  simplify_options.method = (scree_method)arguments->method;
  simplify_options.stop_count = target;
  simplify_options.error_limit = arguments->error;
  SCREE_TRY(scree_curve_build_scaled(&scan.mesh, scale, &simplify_options, call->progress, &curve,
                                     error));
  if (recommended)
    SCREE_TRY(cli_recommended_level(curve, &scan.mesh, call->progress, &index, error));
  else
    index = scree_curve_find(curve, target);
  scree_curve_level(curve, index, &level);
  SCREE_TRY(write_level(call, &scan, curve, index, &is, error));
  say(call, curve, index, is);
  if (target > 0 && level.triangle_count > target) say_above(call, level.triangle_count, target);
  return SCREE_OK;
}

static scree_status run(const cli_call *call, scree_error *error) {
  const simplify_arguments *arguments = call->options;
  if (!arguments->output) return cli_misuse(call->verb, "-o FILE is missing");
  if (arguments->count == SIZE_MAX && arguments->error > 0)
    return cli_misuse(call->verb, "--count recommended and --error exclude each other");
  if (!(arguments->rp > 0) && arguments->count == 0 && !(arguments->error > 0))
    return cli_misuse(call->verb, "one of -r RP, -n COUNT or -e LENGTH is needed");
  bool to_stdout = !strcmp(arguments->output, "-");
  if (arguments->density > 0 && to_stdout)
    return cli_misuse(call->verb, "--density writes beside a file: -o - has none");
  if (!to_stdout) SCREE_TRY(cli_check_ending(call->verb, arguments->output, CLI_MESH));
  return simplify(call, error);
}

const cli_verb cli_verb_simplify = {
    .name = "simplify",
    .summary = "write a scan with fewer triangles",
    .inputs = "FILE|sample:NAME",
    .description =
        "Decimates a scan by edge collapses and writes the level asked for. A scan that is no "
        "closed surface is repaired first, which is said. What was closed, manifold and outward "
        "stays so; no facet is flipped, folded over or driven through another. The same file gives "
        "the same bits, whatever the order of its facets and the number of threads.",
    .examples = "scree simplify phone.stl -n recommended -o phone_dem.stl\n"
                "scree simplify phone.stl -r 1e-3 -o phone_762.stl\n"
                "scree simplify phone.stl -n 500 --fit -o phone_near.stl\n"
                "scree simplify phone.stl -n 500 -m qecd -o phone_500.ply\n"
                "scree simplify phone.stl -r 1e-3 --density 1800 -o phone_dem.stl\n"
                "scree simplify phone.stl -e 0.1mm -o phone_fine.stl\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = 1,
    .partners = CLI_SAMPLE_PARTNERS,
    .exclusive = "rp|count " CLI_SOUNDNESS_EXCLUSIVE,
    .run = run,
};
