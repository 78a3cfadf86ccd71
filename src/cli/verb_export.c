/* scree export: meshes and piles as other programs want them. */
#include "cli/input.h"

#include <math.h>
#include <string.h>

typedef struct export_arguments {
  const char *output, *reference;
  cli_source source;
  double to, density;
  int view;
  bool centre, principal, overwrite;
} export_arguments;

static const export_arguments defaults = {.source = CLI_SOURCE_DEFAULTS, .density = 2000};

#define AT(field) offsetof(export_arguments, field)
static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, AT(output), "OUT",
     "What to write (required). Of a surface: .stl, .ply, .obj or .off, with a .json of the same "
     "name beside it, or .vtp. Of a checkpoint: .vtp, or a folder.",
     0, 0, NULL},
    {"to", 't', CLI_UNIT, AT(to), "UNIT",
     "Unit of the meshes written. Default: the input's; mm for samples and checkpoints.", 0, 0,
     NULL},
    {"centre", 'c', CLI_FLAG, AT(centre), NULL, "Put the centre of mass at the origin.", 0, 0,
     NULL},
    {"principal", 'p', CLI_FLAG, AT(principal), NULL,
     "And turn the principal axes of inertia along x, y and z, the long one along x.", 0, 0, NULL},
    {"density", 'd', CLI_REAL, AT(density), "RHO",
     "Density in kg/m3, for mass and inertia. Default: 2000.", 1e-6, 1e6, NULL},
    {"reference", 'r', CLI_TEXT, AT(reference), "FILE",
     ".vtp of a surface: add the distance to the surface in FILE, or sample:NAME.", 0, 0, NULL},
    {"view", 'w', CLI_CHOICE, AT(view), "VIEW",
     ".vtp of a checkpoint: surfaces (every triangle in its place), points (one per body, with "
     "quaternion and velocities), contacts (lines with forces) or walls. Default: surfaces.",
     0, 0, "surfaces|points|contacts|walls"},
    {"unit", 'u', CLI_UNIT, AT(source.unit), "UNIT", "The input's unit of length. Default: mm.", 0,
     0, NULL},
    CLI_SAMPLE_OPTIONS(export_arguments, source),
    {"force", 'f', CLI_FLAG, AT(overwrite), NULL, "Overwrite existing files.", 0, 0, NULL},
};

static bool ends_with(const char *path, const char *ending) {
  const char *dot = strrchr(path, '.');
  return dot && !strcmp(dot, ending);
}

/* By content. */
static bool is_checkpoint(const char *word) {
  char magic[8] = "";
  if (!strcmp(word, "-") || cli_is_sample(word, NULL)) return false;
  FILE *file = fopen(word, "rb");
  if (!file) return false;
  size_t count = fread(magic, 1, sizeof magic, file);
  fclose(file);
  return count == sizeof magic && !memcmp(magic, "screeWLD", sizeof magic);
}

static scree_export_options export_options(const cli_call *call) {
  const export_arguments *a = call->options;
  scree_export_options o = scree_default_export_options();
  o.density = a->density;
  o.unit_m = a->to > 0 ? a->to : a->source.unit;
  o.centre = a->centre;
  o.principal = a->principal;
  o.overwrite = a->overwrite;
  o.source = call->inputs[0];
  o.command_line = call->command_line;
  return o;
}

/* ---- Surfaces ---- */

static scree_status write_vtp(const cli_call *call, const scree_mesh *mesh, scree_error *error) {
  const export_arguments *a = call->options;
  cli_input_options input = cli_source_options(&a->source);
  scree_scan reference = {0};
  scree_status status = SCREE_OK;
  if (a->reference) status = cli_load(a->reference, &input, call->progress, &reference, error);
  if (status == SCREE_OK)
    status = scree_mesh_vtp_write(mesh, a->reference ? &reference.mesh : NULL, a->output,
                                  a->overwrite, error);
  scree_scan_free(&reference);
  return status;
}

/* Without a minus sign before zeros. */
static double millimetres(double length) {
  return round(length * 1e7) / 1e4 + 0.0;
}

static void say(const cli_call *call, const scree_exported *p, const char *json_path) {
  const export_arguments *a = call->options;
  if (call->quiet) return;
  printf("%s: %.6g kg at %g kg/m3, centre of mass %.4f, %.4f, %.4f mm, principal moments %.4g, "
         "%.4g, %.4g kg m2, coordinates in %s\n",
         a->output, p->mass, a->density, millimetres(p->measures.centroid[0]),
         millimetres(p->measures.centroid[1]), millimetres(p->measures.centroid[2]),
         a->density * p->measures.principal_moments[0],
         a->density * p->measures.principal_moments[1],
         a->density * p->measures.principal_moments[2], cli_unit_name(export_options(call).unit_m));
  printf("%s: the same with all digits, and where the mesh was\n", json_path);
}

static scree_status write_mesh(const cli_call *call, const scree_scan *scan, scree_error *error) {
  const export_arguments *a = call->options;
  scree_export_options o = export_options(call);
  scree_exported exported;
  char json_path[4096];
  const char *dot = strrchr(a->output, '.');
  int stem = (int)(dot - a->output);
  if (snprintf(json_path, sizeof json_path, "%.*s.json", stem, a->output) >=
      (int)sizeof json_path) {
    *error = (scree_error){SCREE_LIMIT, "the output's name is too long"};
    return SCREE_LIMIT;
  }
  o.checksum = scan->checksum;
  scree_status status =
      scree_particle_export(&scan->mesh, &o, a->output, json_path, &exported, error);
  if (status == SCREE_OK) say(call, &exported, json_path);
  return status;
}

static scree_status export_surface(const cli_call *call, scree_error *error) {
  const export_arguments *a = call->options;
  cli_input_options input = cli_source_options(&a->source);
  scree_scan scan;
  scree_status status = cli_load(call->inputs[0], &input, call->progress, &scan, error);
  if (status != SCREE_OK) return status;
  status = ends_with(a->output, ".vtp") ? write_vtp(call, &scan.mesh, error)
                                        : write_mesh(call, &scan, error);
  scree_scan_free(&scan);
  if (status != SCREE_BAD_MESH) return status;
  char sentence[sizeof error->message]; /* about a mesh without a name */
  memcpy(sentence, error->message, sizeof sentence);
  snprintf(error->message, sizeof error->message, "%.300s: %.700s", call->inputs[0], sentence);
  return status;
}

/* ---- Checkpoints ---- */

static scree_status export_world(const cli_call *call, scree_error *error) {
  const export_arguments *a = call->options;
  scree_export_options o = export_options(call);
  scree_world *world;
  scree_status status = scree_world_load(call->inputs[0], &world, error);
  if (status != SCREE_OK) return status;
  if (ends_with(a->output, ".vtp"))
    status =
        scree_world_vtp_write(world, (scree_world_view)a->view, a->output, a->overwrite, error);
  else
    status = scree_world_export(world, &o, a->output, error);
  scree_world_free(world);
  return status;
}

/* 0, or 2 after telling what does not go together. */
static int check_call(const cli_call *call, bool world) {
  static const char *const endings[] = {".stl", ".ply", ".obj", ".off", ".vtp"};
  const export_arguments *a = call->options;
  bool vtp = ends_with(a->output, ".vtp"), known = false;
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
    known = known || ends_with(a->output, endings[i]);
  if (!world && !known)
    return cli_misuse(call->verb, "-o %s: of a surface, .stl, .ply, .obj, .off or .vtp is written",
                      a->output);
  if (world && known && !vtp)
    return cli_misuse(
        call->verb, "-o %s: of a checkpoint, a .vtp is written, or a folder with a mesh per shape",
        a->output);
  if (a->reference && (world || !vtp))
    return cli_misuse(call->verb, "--reference is for a surface written as .vtp");
  if (a->view && !(world && vtp))
    return cli_misuse(call->verb, "--view is for a checkpoint written as .vtp");
  if ((a->centre || a->principal) && (world || vtp))
    return cli_misuse(call->verb, "--centre and --principal are for a surface written as a mesh");
  return 0;
}

static int run(const cli_call *call) {
  const export_arguments *a = call->options;
  scree_error error;
  if (!a->output) return cli_misuse(call->verb, "say with -o what to write");
  bool world = is_checkpoint(call->inputs[0]);
  int code = check_call(call, world);
  if (code) return code;
  scree_status status = world ? export_world(call, &error) : export_surface(call, &error);
  return status == SCREE_OK ? 0 : cli_fail(&error);
}

const cli_verb cli_verb_export = {
    .name = "export",
    .summary = "write a mesh or a pile for other programs",
    .inputs = "FILE|sample:NAME|CHECKPOINT",
    .description =
        "For DEM codes: a particle's mesh in the unit asked, with its centre of mass at the origin "
        "and its principal axes along x, y and z when asked, and mass, centre and inertia in a "
        "JSON beside it. The surface must be closed.\n\n"
        "For ParaView: a surface as .vtp with the area of every triangle, and with --reference its "
        "distance to another surface; lengths in metres.\n\n"
        "A checkpoint of a simulation becomes .vtp, as the view asked; or a folder: pile.json and "
        "bodies.csv with every body's position, quaternion and velocities, and an STL per shape in "
        "the frame that the quaternions turn. docs/formats.md has every field.",
    .examples = "scree export result/phone.stl --principal --to m --density 1800 -o phone-dem.stl\n"
                "scree export result/phone.stl --reference phone.stl -o phone.vtp\n"
                "scree export drop/end.scree --view contacts -o contacts.vtp\n"
                "scree export drop/end.scree --to m -o pile\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .defaults = &defaults,
    .options_size = sizeof defaults,
    .input_minimum = 1,
    .input_maximum = 1,
    .run = run,
};
