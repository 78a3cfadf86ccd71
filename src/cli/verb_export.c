/* scree export: meshes and piles as other programs want them. */
#include "base/owned.h"
#include "base/platform.h"
#include "cli/clump_surface.h"
#include "cli/output.h"
#include "cli/terminal.h"
#include "report/program.h"

#include <math.h>
#include <string.h>
#include <strings.h>

typedef struct export_arguments {
  const char *output, *reference, *to;
  cli_source source;
  double density, young;
  size_t count, particles;
  int view;
  bool centre, principal, overwrite;
} export_arguments;

enum { NAME_BYTES = 4096 };

static const export_arguments defaults = {
    .source = CLI_SOURCE_DEFAULTS, .density = 2000, .particles = 27};

#define ARGUMENTS export_arguments
static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", output, "OUT",
            "What to write (required). Of a surface: .stl, .ply, .obj, .off or .3mf, with a .json "
            "of the same name beside it, or .vtp. Of a checkpoint: .vtp, .csv, or a folder. Of "
            "several: .pvd or .vtp.series, with a .vtp each beside it."),
    CLI_ROW(CLI_TEXT, "to", to, "UNIT|CODE",
            "Unit of the meshes written; default: the input's; mm for samples and checkpoints. Or "
            "the DEM code that reads what is written: lammps, liggghts, yade, pfc, chrono, edem or "
            "mfix. These take clumps: of a surface one is made."),
    CLI_RANGE_ROW(
        CLI_COUNT, "count", count, "N", 1, 300,
        "For a DEM code: spheres of the clump made of a surface. Default: the recommended number."),
    CLI_RANGE_ROW(CLI_COUNT, "particles", particles, "N", 1, 100000,
                  "For a DEM code: clumps that the script lets fall. Default: 27."),
    CLI_RANGE_ROW(
        CLI_REAL, "young", young, "PA", 1e4, 1.3e12,
        "For a DEM code: Young's modulus of its script. Default: so soft that a body that falls "
        "from the script's height presses itself a tenth of its radius into the floor."),
    CLI_FLAG_ROW("centre", centre, "Put the centre of mass at the origin."),
    CLI_FLAG_ROW("principal", principal,
                 "And turn the principal axes of inertia along x, y and z, the long one along x."),
    CLI_RANGE_ROW(CLI_REAL, "density", density, "KG/M3", 1e-6, 1e6,
                  "Density in kg/m3, for mass and inertia. Default: 2000."),
    CLI_ROW(CLI_FILE, "reference", reference, "FILE",
            "For .vtp of a surface: add the distance to the surface in FILE, or sample:NAME."),
    CLI_CHOICE_ROW("view", view, "VIEW", "surfaces|points|contacts|walls",
                   "For .vtp of a checkpoint: surfaces (every triangle in its place), points (one "
                   "per body, with quaternion and velocities), contacts (lines with forces) or "
                   "walls. Default: surfaces."),
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("force", overwrite, "Overwrite existing files."),
};

typedef enum input_kind { WORLD, SCENE, SURFACE } input_kind;

/* By content. */
static input_kind kind_of(const char *word) {
  static const char magics[][9] = {"screeWLD", "screeSCN"};
  char magic[8] = "";
  int kind = WORLD;
  if (!strcmp(word, "-") || cli_is_sample(word, NULL)) return SURFACE;
  FILE *file = scree_open_stream(word, "rb");
  if (!file) return SURFACE;
  size_t count = fread(magic, 1, sizeof magic, file);
  fclose(file);
  if (count < sizeof magic) return SURFACE;
  while (kind < SURFACE && memcmp(magic, magics[kind], sizeof magic) != 0) kind++;
  return (input_kind)kind;
}

static scree_export_options export_options(const cli_call *call) {
  const export_arguments *a = call->options;
  scree_export_options o = scree_default_export_options();
  o.density = a->density;
  double unit;
  o.unit_m = a->to && cli_unit_from_text(a->to, &unit) ? unit : a->source.unit;
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
  SCREE_CLEANUP(scree_scan_free) scree_scan reference = {0};
  if (a->reference) SCREE_TRY(cli_load(a->reference, &input, call->progress, &reference, error));
  return scree_mesh_vtp_write(mesh, a->reference ? &reference.mesh : NULL, a->output, a->overwrite,
                              error);
}

/* Without a minus sign before zeros. */
static double millimetres(double length) {
  return round(length * 1e7) / 1e4 + 0.0;
}

static void say(const cli_call *call, const scree_exported *p, const char *json_path) {
  const export_arguments *a = call->options;
  char shown[CLI_PRINTABLE_BYTES];
  cli_terminal_end();
  if (call->quiet) return;
  printf("%s: %.6g kg at %g kg/m3, centre of mass %.4f, %.4f, %.4f mm, principal moments %.4g, "
         "%.4g, %.4g kg m2, coordinates in %s\n",
         cli_printable(a->output, shown), p->mass, a->density, millimetres(p->measures.centroid[0]),
         millimetres(p->measures.centroid[1]), millimetres(p->measures.centroid[2]),
         a->density * p->measures.principal_moments[0],
         a->density * p->measures.principal_moments[1],
         a->density * p->measures.principal_moments[2], cli_unit_name(export_options(call).unit_m));
  printf("%s: the same with all digits, and where the mesh was\n", cli_printable(json_path, shown));
}

static scree_status write_mesh(const cli_call *call, const scree_scan *scan, const char *json_path,
                               scree_error *error) {
  const export_arguments *a = call->options;
  scree_export_options o = export_options(call);
  scree_exported exported;
  o.checksum = scan->checksum;
  SCREE_TRY(scree_particle_export(&scan->mesh, &o, a->output, json_path, &exported, error));
  say(call, &exported, json_path);
  return SCREE_OK;
}

static scree_status export_surface(const cli_call *call, scree_error *error) {
  const export_arguments *a = call->options;
  cli_input_options input = cli_source_options(&a->source);
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  char json_path[NAME_BYTES];
  bool vtp = cli_has_ending(a->output, ".vtp");
  SCREE_TRY(cli_check_output(call, a->output, a->overwrite, error));
  if (!vtp) {
    SCREE_TRY(cli_beside(a->output, ".json", json_path, sizeof json_path, error));
    SCREE_TRY(cli_check_output(call, json_path, a->overwrite, error));
  }
  SCREE_TRY(cli_load(call->inputs[0], &input, call->progress, &scan, error));
  scree_status status =
      vtp ? write_vtp(call, &scan.mesh, error) : write_mesh(call, &scan, json_path, error);
  return status == SCREE_BAD_MESH ? cli_name_in_error(call->inputs[0], error) : status;
}

/* ---- Clumps for other DEM codes ---- */

/* The code that --to names; SCREE_DEM_CODE_COUNT where it names none. */
static scree_dem_code code_of(const export_arguments *a) {
  int code = 0;
  while (code < SCREE_DEM_CODE_COUNT &&
         (!a->to || strcmp(a->to, scree_dem_code_name((scree_dem_code)code)) != 0))
    code++;
  return (scree_dem_code)code;
}

static scree_status read_clump(const char *word, const cli_input_options *input,
                               scree_particle **particle, scree_error *error) {
  SCREE_TRY(scree_particle_clump_read(word, &input->read, particle, error));
  size_t pieces = scree_particle_piece_count(*particle);
  if (pieces > 1)
    cli_remark(word,
               "the spheres lie in %zu pieces that do not touch: are the columns x, y, z, radius, "
               "and all in one unit?",
               pieces);
  return SCREE_OK;
}

static scree_status make_clump(const cli_call *call, scree_particle **particle,
                               scree_error *error) {
  const export_arguments *a = call->options;
  const char *word = call->inputs[0];
  cli_input_options input = cli_source_options(&a->source);
  SCREE_CLEANUP(cli_clump_surface_free)
  cli_clump_surface surface = {.triangles = SCREE_CLUMP_TRIANGLES};
  SCREE_CLEANUP(scree_clumps_free) scree_clumps clumps = {0};
  scree_clump_options o = scree_default_clump_options();
  if (scree_is_clump_table(word)) return read_clump(word, &input, particle, error);
  SCREE_TRY(cli_load_for_clump(word, &input, call->progress, &surface, error));
  if (a->count) o.most = a->count;
  if (scree_clumps_make(&surface.mesh, &o, call->progress, &clumps, error) != SCREE_OK)
    return cli_name_in_error(word, error);
  const scree_clump *clump =
      a->count ? scree_clumps_of_count(&clumps, a->count) : &clumps.clumps[clumps.recommended];
  if (clump->sphere_count < a->count)
    cli_remark(word, "%zu sphere%s, not %zu: more cover it no better", clump->sphere_count,
               cli_plural(clump->sphere_count), a->count);
  return scree_clump_particle(&clumps, clump, particle, error);
}

static scree_status export_clump(const cli_call *call, scree_error *error) {
  const export_arguments *a = call->options;
  scree_code_options o = scree_default_code_options();
  SCREE_OWNED(scree_particle, particle);
  scree_particle_measures m;
  char name[128], shown[CLI_PRINTABLE_BYTES];
  cli_short_name(call->inputs[0], name, sizeof name);
  o.name = name;
  o.density = a->density;
  o.count = a->particles;
  o.young = a->young;
  o.overwrite = a->overwrite;
  SCREE_TRY(cli_make_folder(a->output, error));
  SCREE_TRY(make_clump(call, &particle, error));
  SCREE_TRY(scree_clump_code_write(particle, code_of(a), &o, a->output, error));
  scree_particle_measure(particle, &m);
  cli_terminal_end();
  if (!call->quiet)
    printf("%s: a clump of %zu sphere%s for %s, %.6g kg at %g kg/m3, principal moments %.4g, %.4g, "
           "%.4g kg m2\n",
           cli_printable(a->output, shown), m.point_count, cli_plural(m.point_count), a->to,
           a->density * m.volume, a->density, a->density * m.inertia[0], a->density * m.inertia[1],
           a->density * m.inertia[2]);
  return SCREE_OK;
}

/* ---- Checkpoints ---- */

/* A world, and the scene that it belongs to; NULL: none. */
typedef struct checkpoint {
  scree_scene *scene;
  scree_world *world;
} checkpoint;

static scree_status load_checkpoint(const char *word, checkpoint *c, scree_error *error) {
  if (kind_of(word) == WORLD) return scree_world_load(word, &c->world, error);
  SCREE_TRY(scree_scene_load(word, &c->scene, error));
  c->world = scree_scene_world(c->scene);
  return SCREE_OK;
}

static void free_checkpoint(checkpoint *c) {
  if (!c->scene) scree_world_free(c->world);
  scree_scene_free(c->scene);
}

static scree_status write_view(const cli_call *call, const checkpoint *c, const char *word,
                               const char *path, scree_error *error) {
  const export_arguments *a = call->options;
  if (a->view != SCREE_VIEW_CONTACTS || !c->scene || !scree_scene_is_frame(c->scene))
    return scree_world_vtp_write(c->world, (scree_world_view)a->view, path, a->overwrite, error);
  return cli_refuse(error, SCREE_UNSUPPORTED, word, "a frame holds no contacts; a checkpoint does");
}

static bool is_table(const char *path) {
  return cli_has_ending(path, ".csv");
}

static scree_status write_table(const cli_call *call, const checkpoint *c, scree_error *error) {
  const export_arguments *a = call->options;
  if (c->scene) return scree_scene_bodies_write(c->scene, a->output, a->overwrite, error);
  return cli_refuse(error, SCREE_UNSUPPORTED, call->inputs[0],
                    "a table names shapes of a scene; this is a checkpoint of a world alone");
}

static scree_status export_world(const cli_call *call, scree_error *error) {
  const export_arguments *a = call->options;
  scree_export_options o = export_options(call);
  SCREE_CLEANUP(free_checkpoint) checkpoint c = {0};
  SCREE_TRY(load_checkpoint(call->inputs[0], &c, error));
  if (is_table(a->output)) return write_table(call, &c, error);
  if (cli_has_ending(a->output, ".vtp"))
    return write_view(call, &c, call->inputs[0], a->output, error);
  return scree_world_export(c.world, &o, a->output, error);
}

/* File `index` of a series: pile-0000.vtp beside pile.pvd or pile.vtp.series. */
static scree_status name_file(const char *output, size_t index, char name[NAME_BYTES],
                              scree_error *error) {
  const char *end = strrchr(output, '.');
  if (end - output > 4 && !strncasecmp(end - 4, ".vtp", 4)) end -= 4;
  int length = snprintf(name, NAME_BYTES, "%.*s-%04zu.vtp", (int)(end - output), output, index);
  if (length < NAME_BYTES) return SCREE_OK;
  *error = (scree_error){SCREE_LIMIT, "the output's name is too long"};
  return SCREE_LIMIT;
}

static scree_status write_frame(const cli_call *call, size_t index, const char *name, double *time,
                                scree_error *error) {
  SCREE_CLEANUP(free_checkpoint) checkpoint c = {0};
  SCREE_TRY(load_checkpoint(call->inputs[index], &c, error));
  *time = scree_world_time(c.world);
  return write_view(call, &c, call->inputs[index], name, error);
}

/* A .vtp per input, and the list of them with their times. */
static scree_status export_series(const cli_call *call, scree_error *error) {
  const export_arguments *a = call->options;
  size_t count = call->input_count;
  typedef char file_name[NAME_BYTES];
  SCREE_SCRATCH(file_name, paths, count, error);
  SCREE_SCRATCH(const char *, names, count, error);
  SCREE_SCRATCH(double, times, count, error);
  SCREE_TRY(cli_check_output(call, a->output, a->overwrite, error));
  for (size_t i = 0; i < count; i++) {
    SCREE_TRY(name_file(a->output, i, paths[i], error));
    SCREE_TRY(cli_check_output(call, paths[i], a->overwrite, error));
  }
  for (size_t i = 0; i < count; i++) {
    SCREE_TRY(write_frame(call, i, paths[i], &times[i], error));
    const char *slash = strrchr(paths[i], '/');
    names[i] = slash ? slash + 1 : paths[i];
  }
  return scree_pvd_write(names, times, count, a->output, a->overwrite, error);
}

static bool is_series(const char *path) {
  return cli_has_ending(path, ".pvd") || cli_has_ending(path, ".series");
}

/* Which inputs go with the output. */
static scree_status check_inputs(const cli_call *call, bool world) {
  const export_arguments *a = call->options;
  bool series = is_series(a->output);
  if (call->input_count > 1 && !series)
    return cli_misuse(call->verb, "-o %s: several inputs go into a .pvd or .vtp.series only",
                      a->output);
  for (size_t i = 0; series && i < call->input_count; i++)
    if (i ? kind_of(call->inputs[i]) == SURFACE : !world)
      return cli_misuse(call->verb, "-o %s: a series is of checkpoints; %s is none", a->output,
                        call->inputs[i]);
  return SCREE_OK;
}

/* What does not go together. */
static scree_status check_call(const cli_call *call, bool world) {
  const export_arguments *a = call->options;
  bool series = is_series(a->output), vtp = cli_has_ending(a->output, ".vtp") || series;
  bool known = vtp || scree_file_format_of(a->output) != SCREE_FORMAT_AUTO;
  SCREE_TRY(check_inputs(call, world));
  if (!world && !known)
    return cli_misuse(call->verb,
                      "-o %s: of a surface, .stl, .ply, .obj, .off, .3mf or .vtp is written",
                      a->output);
  if (world && known && !vtp)
    return cli_misuse(
        call->verb,
        "-o %s: of a checkpoint, a .vtp or .csv is written, or a folder with a mesh per shape",
        a->output);
  if (a->reference && (world || !vtp))
    return cli_misuse(call->verb, "--reference is for a surface written as .vtp");
  if (a->view && !(world && vtp))
    return cli_misuse(call->verb, "--view is for a checkpoint written as .vtp");
  if ((a->centre || a->principal) && (world || vtp))
    return cli_misuse(call->verb, "--centre and --principal are for a surface written as a mesh");
  return SCREE_OK;
}

/* What does not go with a DEM code. */
static scree_status check_clump_call(const cli_call *call) {
  const export_arguments *a = call->options;
  if (call->input_count > 1 || kind_of(call->inputs[0]) != SURFACE)
    return cli_misuse(call->verb, "--to %s is for one surface or clump", a->to);
  if (a->reference || a->view || a->centre || a->principal)
    return cli_misuse(call->verb,
                      "--to %s takes neither --reference, --view, --centre nor --principal: a "
                      "clump stands about its centre of mass, along its principal axes",
                      a->to);
  if (a->count && scree_is_clump_table(call->inputs[0]))
    return cli_misuse(call->verb, "--count is for a surface; %s is a clump", call->inputs[0]);
  return SCREE_OK;
}

static scree_status run(const cli_call *call, scree_error *error) {
  const export_arguments *a = call->options;
  double unit;
  if (!a->output) return cli_misuse(call->verb, "say with -o what to write");
  if (code_of(a) < SCREE_DEM_CODE_COUNT) {
    SCREE_TRY(check_clump_call(call));
    return export_clump(call, error);
  }
  if (a->to && !cli_unit_from_text(a->to, &unit))
    return cli_misuse(call->verb,
                      "--to %s: must be a unit (m, cm, mm, um, inch, ft, km) or a DEM code "
                      "(lammps, liggghts, yade, pfc, chrono, edem, mfix)",
                      a->to);
  if (a->count || scree_is_clump_table(call->inputs[0]))
    return cli_misuse(call->verb, "a clump is written for a DEM code: say which with --to");
  bool world = kind_of(call->inputs[0]) != SURFACE;
  SCREE_TRY(check_call(call, world));
  if (is_series(a->output)) return export_series(call, error);
  return world ? export_world(call, error) : export_surface(call, error);
}

const cli_verb cli_verb_export = {
    .name = "export",
    .summary = "write a mesh or a pile for other programs",
    .inputs = "FILE|sample:NAME|CHECKPOINT...",
    .description =
        "A particle's mesh in the unit asked, with its centre of mass at the origin and its "
        "principal axes along x, y and z when asked, and mass, centre and inertia in a JSON beside "
        "it. The surface must be closed.\n\n"
        "For other DEM codes (--to lammps, liggghts, yade, pfc, chrono, edem or mfix) a clump is "
        "written into a folder as that code reads it, from a table of `scree clump` or made of a "
        "surface: spheres about the centre of mass along the principal axes with the body's mass "
        "and inertia (EDEM and MFiX work these out for themselves), and for the first three a "
        "script that lets some fall into a box. Other codes read the mesh.\n\n"
        "For ParaView: a surface as .vtp with the area of every triangle, and with --reference its "
        "distance to another surface; lengths in metres.\n\n"
        "A checkpoint or frame of a simulation becomes .vtp, as the view asked; of a scene .csv, a "
        "table that `bodies: {file: ...}` of another scene reads; or a folder: pile.json and "
        "bodies.csv with every body's position, quaternion and velocities, and an STL per shape in "
        "the frame that the quaternions turn. docs/reference/formats.md has every field.",
    .examples = "scree export result/phone.stl --principal --to m --density 1800 -o phone-dem.stl\n"
                "scree export phone.stl --to lammps -n 20 -o phone-lammps\n"
                "scree export result/phone.stl --reference phone.stl -o phone.vtp\n"
                "scree export repose/checkpoint.scree --view contacts -o contacts.vtp\n"
                "scree export repose/last.scree --to m -o pile\n"
                "scree export repose/frame-*.scree -o heap.pvd\n"
                "scree export repose/last.scree -o packing.csv\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = SIZE_MAX,
    .partners = CLI_SAMPLE_PARTNERS,
    .run = run,
};
