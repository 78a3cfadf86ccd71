/* scree sample: the built-in devices and test solids as files. */
#include "base/file.h"
#include "cli/output.h"
#include "cli/terminal.h"

#include <string.h>

typedef struct sample_arguments {
  const char *output;
  double resolution, noise;
  size_t seed;
  bool list, force;
} sample_arguments;

#define ARGUMENTS sample_arguments
static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", output, "PATH",
            "A folder, made if need be, that gets NAME.stl for every sample; or, for one sample, a "
            "file (.stl, .ply, .obj, .off, .3mf), or - for a binary STL on stdout. Default: the "
            "current folder."),
    CLI_RANGE_ROW(CLI_LENGTH, "resolution", resolution, "LENGTH", 0.02e-3, 5e-3,
                  "Spacing of the mesh's vertices, with its unit, from 0.02mm to 5mm. Default: "
                  "0.27mm, the paper's."),
    CLI_RANGE_ROW(CLI_LENGTH, "noise", noise, "LENGTH", 0, 1,
                  "Standard deviation of the scanner's noise; 0 gives a clean mesh. At most a "
                  "quarter of the resolution. The test solids have none. Default: 0.02mm."),
    CLI_RANGE_ROW(CLI_COUNT, "sample-seed", seed, "N", 0, 9007199254740992.0,
                  "Another seed, another scan of the same device. Default: 1."),
    CLI_FLAG_ROW("list", list, "List the samples and write nothing, as without NAME and --output."),
    CLI_FLAG_ROW("force", force, "Overwrite existing files."),
};

static const sample_arguments defaults = {NULL, 0.27e-3, 0.02e-3, 1, false, false};

static void list_samples(void) {
  for (size_t i = 0; i < scree_sample_count(); i++)
    printf("%-10s %s\n", scree_sample_name(i), scree_sample_description(i));
}

enum { PATH_BYTES = 4200 };

/* A folder, or a file whose name says its format. */
static bool names_file(const char *path) {
  return !strcmp(path, "-") || scree_file_format_of(path) != SCREE_FORMAT_AUTO;
}

static void print_row(FILE *stream, const char *name, const char *path, const scree_mesh *mesh) {
  double area, volume, low[3], high[3];
  char shown[CLI_PRINTABLE_BYTES];
  if (scree_mesh_area_volume(mesh, &area, &volume, NULL) != SCREE_OK) return;
  for (int a = 0; a < 3; a++) low[a] = high[a] = mesh->positions[a];
  for (size_t i = 3; i < 3 * mesh->vertex_count; i++) {
    double x = mesh->positions[i];
    if (x < low[i % 3]) low[i % 3] = x;
    if (x > high[i % 3]) high[i % 3] = x;
  }
  fprintf(stream, "%-10s %9zu  %6.1f x %6.1f x %6.1f  %7.1f  %7.2f  %s\n", name,
          mesh->triangle_count, (high[0] - low[0]) * 1e3, (high[1] - low[1]) * 1e3,
          (high[2] - low[2]) * 1e3, area * 1e4, volume * 1e6, cli_printable(path, shown));
}

static scree_status make_one(const cli_call *call, const char *name, const char *path, bool first,
                             scree_error *error) {
  const sample_arguments *arguments = call->options;
  scree_sample_options sample = scree_default_sample_options();
  const scree_write_options write =
      cli_write_options(call, path, scree_default_write_options().unit_m, arguments->force);
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  bool to_stdout = !strcmp(path, "-");
  FILE *stream = to_stdout ? stderr : stdout;
  sample.resolution = arguments->resolution;
  sample.noise = arguments->noise;
  sample.seed = arguments->seed;
  SCREE_TRY(scree_sample_make(name, &sample, call->progress, &mesh, error));
  SCREE_TRY(scree_mesh_write(&mesh, path, &write, error));
  cli_terminal_end();
  if (first)
    fprintf(stream, "%-10s %9s  %-24s  %7s  %7s  %s\n", "sample", "triangles", "size (mm)",
            "S (cm2)", "V (cm3)", "file");
  print_row(stream, name, path, &mesh);
  return SCREE_OK;
}

/* The file of a sample: the output itself, or one in the folder that it is. */
static void name_output(const char *output, const char *name, char path[PATH_BYTES]) {
  if (names_file(output))
    snprintf(path, PATH_BYTES, "%s", output);
  else
    snprintf(path, PATH_BYTES, "%s/%.64s.stl", output, name);
}

static scree_status run(const cli_call *call, scree_error *error) {
  const sample_arguments *arguments = call->options;
  bool all = call->input_count == 0 || (call->input_count == 1 && !strcmp(call->inputs[0], "all"));
  if (arguments->list || (call->input_count == 0 && !arguments->output)) {
    list_samples();
    return SCREE_OK;
  }
  size_t count = all ? SCREE_SAMPLE_DEVICES : call->input_count;
  const char *output = arguments->output ? arguments->output : ".";
  bool to_file = names_file(output);
  char path[PATH_BYTES];
  if (to_file && count != 1)
    return cli_misuse(call->verb, "%zu samples do not fit into one file: -o takes a folder", count);
  for (size_t i = 0; i < call->input_count; i++)
    for (size_t k = 0; k < i; k++)
      if (!strcmp(call->inputs[i], call->inputs[k]))
        return cli_misuse(call->verb, "'%s' is given twice", call->inputs[i]);
  if (!to_file) SCREE_TRY(cli_make_folder(output, error));
  for (size_t i = 0; i < 2 * count; i++) { /* first whether all can be written */
    const char *name = all ? scree_sample_name(i % count) : call->inputs[i % count];
    name_output(output, name, path);
    SCREE_TRY(i < count ? scree_output_check(path, arguments->force, error)
                        : make_one(call, name, path, i == count, error));
  }
  return SCREE_OK;
}

const cli_verb cli_verb_sample = {
    .name = "sample",
    .summary = "write the built-in sample scans",
    .inputs = "[NAME...|all]",
    .description = "Writes the built-in samples as they would come from a structured-light "
                   "scanner: nine devices (feature phones fp-1 to fp-3, digital cameras dc-1 to "
                   "dc-3, smartphones sp-1 to sp-3; all of them by `all`, or by --output alone) "
                   "and four test solids (see --list). They are synthetic: drawn as distance "
                   "fields, meshed closed and manifold, and given the scanner's noise. Files are "
                   "in millimetres, as scanners write. The same options give the same bits.",
    .examples = "scree sample -o samples\n"
                "scree sample fp-1 --noise 0 -o clean.stl\n"
                "scree sample dc-3 sp-2 --resolution 0.5mm -o coarse\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 0,
    .input_maximum = 1000,
    .run = run,
};
