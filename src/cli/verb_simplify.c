/* scree simplify: one level of the decimation as a file. */
#include "base/number.h"
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

static const cli_option options[] = {
    {"output", CLI_TEXT, offsetof(simplify_arguments, output), "FILE",
     "The file to write: .stl, .ply, .obj, .off or .3mf by its extension; - writes a binary STL to "
     "stdout.",
     0, 0, NULL},
    {"rp", CLI_SHARE, offsetof(simplify_arguments, rp), "RP",
     "Keep this share of the triangles, as in 1e-3: the first level with at most RP times the "
     "scan's count, rounded down. A closed surface has an even count.",
     1e-12, 1, NULL},
    {"count", CLI_COUNT, offsetof(simplify_arguments, count), "COUNT",
     "Keep at most this many triangles; recommended: as many as choose recommends.", 1,
     4294967295.0, "recommended"},
    {"error", CLI_LENGTH, offsetof(simplify_arguments, error), "LENGTH",
     "Go as far as no collapse moves the surface by more than this, as in 0.05mm: by the quadric "
     "error, an estimate, not a bound. Costlier collapses are left out and others go on, so that "
     "the mesh is none of the levels that curve shows. May be given with -r or -n.",
     1e-12, 1e12, NULL},
    {"method", CLI_CHOICE, offsetof(simplify_arguments, method), "METHOD",
     "volume keeps the volume at every level; qecd is MeshLab's quadric edge collapse decimation. "
     "Default: volume.",
     0, 0, "volume|qecd"},
    {"fit", CLI_FLAG, offsetof(simplify_arguments, fit), NULL,
     "Move the level's vertices to where its surface is nearer to the scan: the mean distance "
     "falls by some per cent, the volume stays, the area may be further off.",
     0, 0, NULL},
    {"density", CLI_REAL, offsetof(simplify_arguments, density), "KG/M3",
     "Also write mass, centre of mass and inertia of the result at this density in kg/m3 into a "
     ".json of the same name, as export does. The surface must be closed.",
     1e-6, 1e6, NULL},
    CLI_SOUNDNESS_OPTIONS(simplify_arguments),
    CLI_SOURCE_OPTIONS(simplify_arguments),
    {"force", CLI_FLAG, offsetof(simplify_arguments, force), NULL, "Overwrite an existing file.", 0,
     0, NULL},
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
  scree_write_options write = scree_default_write_options();
  write.overwrite = arguments->force;
  write.unit_m = arguments->source.unit;
  write.comment = call->command_line;
  if (!strcmp(arguments->output, "-")) write.format = SCREE_FORMAT_STL;
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
  scree_mesh mesh = {0};
  scree_status status = arguments->fit ? scree_curve_fit(curve, index, &mesh, error)
                                       : scree_curve_mesh(curve, index, &mesh, error);
  if (status == SCREE_OK) status = scree_mesh_area_volume(&mesh, &is->area, &is->volume, error);
  if (status == SCREE_OK && !arguments->soundness.unchecked)
    status = cli_check_rounded(&mesh, arguments->output, arguments->source.unit, NULL,
                               call->progress, error);
  if (status == SCREE_OK)
    status = arguments->density > 0 ? write_with_mass(call, scan, &mesh, error)
                                    : write_plain(call, &mesh, error);
  double lost = cli_volume_lost(&mesh, arguments->output, arguments->source.unit);
  if (status == SCREE_OK && lost >= CLI_NOTABLE_LOSS && !call->quiet)
    fprintf(stderr,
            "%s: an STL holds single precision, which changes the volume by %.2g of it here; .ply, "
            ".obj and .off hold it\n",
            cli_printable(arguments->output, shown), lost);
  scree_mesh_free(&mesh);
  return status;
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

static scree_status simplify(const cli_call *call, scree_error *error) {
  const simplify_arguments *arguments = call->options;
  scree_simplify_options simplify_options = scree_default_simplify_options();
  scree_scan scan = {0};
  scree_curve *curve = NULL;
  char shown[CLI_PRINTABLE_BYTES];
  double scale;
  scree_status status = check_output(call, error);
  if (status == SCREE_OK)
    status =
        cli_load_for_levels(call, &arguments->source, &arguments->soundness, &scan, &scale, error);
  if (status != SCREE_OK) return status;
  size_t target = arguments->count;
  if (arguments->rp > 0) target = scree_choice_target(arguments->rp, scan.mesh.triangle_count);
  simplify_options.method = (scree_method)arguments->method;
  bool recommended = target == SIZE_MAX;
  if (recommended) target = 0;
  simplify_options.stop_count = target;
  simplify_options.error_limit = arguments->error;
  status =
      scree_curve_build_scaled(&scan.mesh, scale, &simplify_options, call->progress, &curve, error);
  size_t index = 0;
  if (status == SCREE_OK && recommended)
    status = cli_recommended_level(curve, &scan.mesh, call->progress, &index, error);
  else if (status == SCREE_OK)
    index = scree_curve_find(curve, target);
  if (status == SCREE_OK) {
    scree_level level;
    scree_curve_level(curve, index, &level);
    written is = {0};
    status = write_level(call, &scan, curve, index, &is, error);
    if (status == SCREE_OK) say(call, curve, index, is);
    bool above = status == SCREE_OK && target > 0 && level.triangle_count > target;
    if (above && arguments->error > 0)
      fprintf(stderr,
              "%s: %zu triangles, not the %zu asked for: no collapse is left within the error of "
              "%g mm\n",
              cli_printable(call->inputs[0], shown), level.triangle_count, target,
              arguments->error * 1e3);
    else if (above)
      fprintf(stderr, "%s: %zu triangles is the lowest count that could be reached\n",
              cli_printable(call->inputs[0], shown), level.triangle_count);
  }
  scree_curve_free(curve);
  scree_scan_free(&scan);
  return status;
}

static int run(const cli_call *call) {
  const simplify_arguments *arguments = call->options;
  scree_error error;
  if (!arguments->output) return cli_misuse(call->verb, "-o FILE is missing");
  if (arguments->rp > 0 && arguments->count > 0)
    return cli_misuse(call->verb, "-r and -n exclude each other");
  if (arguments->count == SIZE_MAX && arguments->error > 0)
    return cli_misuse(call->verb, "--count recommended and --error exclude each other");
  if (!(arguments->rp > 0) && arguments->count == 0 && !(arguments->error > 0))
    return cli_misuse(call->verb, "one of -r RP, -n COUNT or -e LENGTH is needed");
  if (arguments->soundness.no_repair && arguments->soundness.unchecked)
    return cli_misuse(call->verb, "--no-repair and --unchecked exclude each other");
  bool to_stdout = !strcmp(arguments->output, "-");
  if (arguments->density > 0 && to_stdout)
    return cli_misuse(call->verb, "--density writes beside a file: -o - has none");
  int code = to_stdout ? 0 : cli_check_ending(call->verb, arguments->output, CLI_MESH);
  if (code) return code;
  return simplify(call, &error) == SCREE_OK ? 0 : cli_fail(&error);
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
    .run = run,
};
