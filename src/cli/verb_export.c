/* scree export: meshes and piles as other programs want them. */
#include "base/file.h"
#include "base/owned.h"
#include "base/platform.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "cli/terminal.h"
#include "report/program.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct export_arguments {
  const char *output, *reference, *to;
  cli_source source;
  double density, young;
  size_t count, particles, pieces;
  int view, as;
  bool centre, principal, overwrite;
} export_arguments;

enum { NAME_BYTES = 4096 };

static const export_arguments defaults = {
    .source = CLI_SOURCE_DEFAULTS, .density = 2000, .particles = 50, .pieces = 64};

#define CODES     "|lammps|liggghts|yade|pfc|chrono|edem|mfix|deme|rockable|exadem|mujoco|blender"
#define ARGUMENTS export_arguments
static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", output, "OUT",
            "What to write (required). Of a surface: .stl, .ply, .obj, .off or .3mf, with a .json "
            "of the same name beside it, or .vtp. Of a checkpoint: .vtp, .csv, or a folder. Of "
            "several: .pvd or .vtp.series, with a .vtp each beside it."),
    CLI_WORDS_ROW(
        CLI_TEXT, "to", to, "UNIT|CODE", CLI_UNITS CODES,
        "Unit of the meshes written; default: the input's; mm for samples and checkpoints. Or "
        "the code that reads what is written: lammps, liggghts, yade, pfc, edem or mfix (clumps), "
        "deme, chrono, rockable, exadem, mujoco or blender (meshes)."),
    CLI_CHOICE_ROW(
        "as", as, "KIND", "best|clump|mesh",
        "For a code: what a surface becomes; default: what that code computes best with. "
        "lammps, yade, deme and chrono take both."),
    CLI_RANGE_ROW(CLI_COUNT, "count", count, "N", 1, 100000,
                  "For a code: triangles of the mesh, or spheres of the clump. Default: as "
                  "recommended; a mesh of at most 2,000 triangles stays as it is."),
    CLI_RANGE_ROW(CLI_COUNT, "particles", particles, "N", 1, 100000,
                  "For a code: bodies of its scripts' heap. Default: 50."),
    CLI_RANGE_ROW(CLI_COUNT, "pieces", pieces, "N", 1, 1024,
                  "For mujoco and yade's meshes: the most convex pieces. Default: 64, fewer where "
                  "volume and inertia come within 2 %."),
    CLI_RANGE_ROW(
        CLI_REAL, "young", young, "PA", 1e4, 1.3e12,
        "For a code: Young's modulus of its script. Default: so soft that a body that falls "
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
  char magic[9] = "";
  FILE *file =
      strcmp(word, "-") != 0 && !cli_is_sample(word, NULL) ? scree_open_stream(word, "rb") : NULL;
  if (!file) return SURFACE;
  (void)!fread(magic, 1, 8, file);
  fclose(file);
  return !strcmp(magic, "screeWLD") ? WORLD : !strcmp(magic, "screeSCN") ? SCENE : SURFACE;
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

static scree_status export_surface(const cli_call *call, scree_error *error) {
  const export_arguments *a = call->options;
  cli_input_options input = cli_source_options(&a->source);
  scree_export_options o = export_options(call);
  scree_exported exported;
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  char json_path[NAME_BYTES];
  bool vtp = cli_has_ending(a->output, ".vtp");
  SCREE_TRY(cli_check_output(call, a->output, a->overwrite, error));
  if (!vtp) {
    SCREE_TRY(cli_beside(a->output, ".json", json_path, sizeof json_path, error));
    SCREE_TRY(cli_check_output(call, json_path, a->overwrite, error));
  }
  SCREE_TRY(cli_load(call->inputs[0], &input, call->progress, &scan, error));
  o.checksum = scan.checksum;
  scree_status status =
      vtp ? write_vtp(call, &scan.mesh, error)
          : scree_particle_export(&scan.mesh, &o, a->output, json_path, &exported, error);
  if (status == SCREE_OK && !vtp) say(call, &exported, json_path);
  return status == SCREE_BAD_MESH ? cli_name_in_error(call->inputs[0], error) : status;
}

/* ---- Particles for other codes ---- */

/* Where the spheres fitted to a surface are kept, for an export to the next code; false: nowhere.
 */
static bool fit_path(const scree_mesh *mesh, size_t count, char path[NAME_BYTES]) {
  const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME"),
             *local = getenv("LOCALAPPDATA");
  const scree_checksum parts[] = {
      scree_checksum_of(mesh->positions, 3 * mesh->vertex_count * sizeof *mesh->positions),
      scree_checksum_of(mesh->triangles, 3 * mesh->triangle_count * sizeof *mesh->triangles)};
  char text[SCREE_CHECKSUM_TEXT];
  bool own = cache && *cache;
  const char *folder = own ? cache : home && *home ? home : local;
  if (!folder || !*folder) return false;
  return snprintf(path, NAME_BYTES, "%s%s/scree/%s-%s-%zu.csv", folder,
                  own || folder == local ? "" : "/.cache", scree_version(),
                  scree_checksum_text(scree_checksum_of(parts, sizeof parts), text),
                  count) < NAME_BYTES;
}

static void keep_fit(const scree_clumps *clumps, const scree_clump *clump, const char *path) {
  char folder[NAME_BYTES];
  snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
  if (scree_folder_create(folder, NULL) == SCREE_OK)
    (void)scree_spheres_write(clumps, clump, 1, path, true, NULL);
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
  if (scree_is_clump_table(word))
    return scree_particle_clump_read(word, &input.read, particle, error);
  SCREE_TRY(cli_load_for_clump(word, &input, call->progress, &surface, error));
  if (a->count) o.most = a->count;
  char kept[NAME_BYTES];
  scree_read_options metres = scree_default_read_options();
  metres.unit_m = 1;
  bool keeps = fit_path(&surface.mesh, a->count, kept);
  if (keeps && scree_path_exists(kept) &&
      scree_particle_clump_read(kept, &metres, particle, NULL) == SCREE_OK)
    return SCREE_OK;
  if (scree_clumps_make(&surface.mesh, &o, call->progress, &clumps, error) != SCREE_OK)
    return cli_name_in_error(word, error);
  const scree_clump *clump =
      a->count ? scree_clumps_of_count(&clumps, a->count) : &clumps.clumps[clumps.recommended];
  if (keeps) keep_fit(&clumps, clump, kept);
  return scree_clump_particle(&clumps, clump, particle, error);
}

static scree_status make_mesh(const cli_call *call, scree_particle **particle, scree_error *error) {
  const export_arguments *a = call->options;
  const char *word = call->inputs[0];
  scree_shape_spec spec = scree_default_shape_spec();
  scree_shape_made made;
  if (!cli_is_sample(word, &spec.sample)) spec.file = word;
  if (cli_source_options(&a->source).read.ignore_comment_unit) spec.unit_m = a->source.unit;
  spec.resolution = a->source.resolution;
  spec.noise = a->source.noise;
  spec.sample_seed = a->source.seed;
  spec.triangle_count = a->count;
  if (scree_shape_make(&spec, NULL, call->progress, &made, error) != SCREE_OK)
    return cli_name_in_error(word, error);
  if (made.repaired) cli_remark(word, "was no closed surface, and is repaired");
  *particle = made.particle;
  return SCREE_OK;
}

/* What becomes of the surface or table. */
static scree_particle_kind kind_for(const cli_call *call, size_t code) {
  const export_arguments *a = call->options;
  if (a->as) return a->as == 1 ? SCREE_PARTICLE_CLUMP : SCREE_PARTICLE_MESH;
  return scree_is_clump_table(call->inputs[0]) ? SCREE_PARTICLE_CLUMP : scree_code_kind(code);
}

static void say_code(const cli_call *call, const scree_particle *particle,
                     const scree_code_written *result) {
  const export_arguments *a = call->options;
  char shown[CLI_PRINTABLE_BYTES];
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  bool mesh = m.kind == SCREE_PARTICLE_MESH;
  size_t count = mesh ? m.triangle_count : m.point_count;
  printf("%s: a %s of %zu %s%s for %s, %.6g kg at %g kg/m3, principal moments %.4g, %.4g, %.4g kg "
         "m2\n",
         cli_printable(a->output, shown), mesh ? "mesh" : "clump", count,
         mesh ? "triangle" : "sphere", cli_plural(count), a->to, a->density * m.volume, a->density,
         a->density * m.inertia[0], a->density * m.inertia[1], a->density * m.inertia[2]);
  if (result->piece_count)
    printf("%s: %zu convex piece%s, volume %+.2g %%, inertia %.2g %% off the mesh's%s\n", shown,
           result->piece_count, cli_plural(result->piece_count), 100 * result->volume_error,
           100 * result->inertia_error,
           result->piece_count >= a->pieces ? "; more come nearer (--pieces)" : "");
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
  if (cli_has_ending(a->output, ".csv")) return write_table(call, &c, error);
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
  return scree_fail(error, SCREE_LIMIT, "the output's name is too long");
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

#define REFUSE_WHERE(wrong, ...)                                                                   \
  if (wrong) return cli_misuse(call->verb, __VA_ARGS__)

/* What does not go together. */
static scree_status check_call(const cli_call *call, bool world) {
  const export_arguments *a = call->options;
  bool series = is_series(a->output), vtp = cli_has_ending(a->output, ".vtp") || series;
  bool known = vtp || scree_file_format_of(a->output) != SCREE_FORMAT_AUTO;
  REFUSE_WHERE(call->input_count > 1 && !series,
               "-o %s: several inputs go into a .pvd or .vtp.series only", a->output);
  for (size_t i = 0; series && i < call->input_count; i++)
    REFUSE_WHERE(kind_of(call->inputs[i]) == SURFACE,
                 "-o %s: a series is of checkpoints; %s is none", a->output, call->inputs[i]);
  REFUSE_WHERE(!world && !known,
               "-o %s: of a surface, .stl, .ply, .obj, .off, .3mf or .vtp is written", a->output);
  REFUSE_WHERE(
      world && known && !vtp,
      "-o %s: of a checkpoint, a .vtp or .csv is written, or a folder with a mesh per shape",
      a->output);
  REFUSE_WHERE(a->reference && (world || !vtp), "--reference is for a surface written as .vtp");
  REFUSE_WHERE(a->view && !(world && vtp), "--view is for a checkpoint written as .vtp");
  REFUSE_WHERE((a->centre || a->principal) && (world || vtp),
               "--centre and --principal are for a surface written as a mesh");
  return SCREE_OK;
}

/* What does not go with a code. */
static scree_status check_code_call(const cli_call *call, size_t code) {
  const export_arguments *a = call->options;
  bool table = scree_is_clump_table(call->inputs[0]);
  bool mesh = kind_for(call, code) == SCREE_PARTICLE_MESH;
  REFUSE_WHERE(call->input_count > 1 || kind_of(call->inputs[0]) != SURFACE,
               "--to %s is for one surface or clump", a->to);
  REFUSE_WHERE(a->reference || a->view || a->centre || a->principal,
               "--to %s takes neither --reference, --view, --centre nor --principal: a particle "
               "stands about its centre of mass, along its principal axes",
               a->to);
  REFUSE_WHERE(a->count && table, "--count is for a surface; %s is a clump", call->inputs[0]);
  REFUSE_WHERE(mesh && table, "--as mesh: %s is a clump", call->inputs[0]);
  REFUSE_WHERE(!scree_code_takes(code, kind_for(call, code)), "--to %s takes %s", a->to,
               mesh ? "clumps alone, no meshes" : "meshes alone, no clumps");
  REFUSE_WHERE(!mesh && a->count > 300, "--count %zu: a clump has at most 300 spheres", a->count);
  return SCREE_OK;
}

static scree_status export_code(const cli_call *call, size_t code, scree_error *error) {
  const export_arguments *a = call->options;
  scree_code_write_options o = scree_default_code_write_options();
  scree_code_written result;
  scree_particle_measures m;
  SCREE_OWNED(scree_particle, particle);
  char name[128];
  cli_short_name(call->inputs[0], name, sizeof name);
  o.name = name;
  o.density = a->density;
  o.count = a->particles;
  o.young = a->young;
  o.overwrite = a->overwrite;
  o.convex.most = a->pieces;
  o.progress = call->progress;
  SCREE_TRY(check_code_call(call, code));
  SCREE_TRY(cli_make_folder(a->output, error));
  SCREE_TRY((kind_for(call, code) == SCREE_PARTICLE_MESH ? make_mesh : make_clump)(call, &particle,
                                                                                   error));
  scree_particle_measure(particle, &m);
  size_t pieces = scree_particle_piece_count(particle);
  if (scree_is_clump_table(call->inputs[0]) && pieces > 1)
    cli_remark(call->inputs[0],
               "the spheres lie in %zu pieces that do not touch: are the columns x, y, z, radius, "
               "and all in one unit?",
               pieces);
  if (m.kind == SCREE_PARTICLE_CLUMP && m.point_count < a->count)
    cli_remark(call->inputs[0], "%zu sphere%s, not %zu: more cover it no better", m.point_count,
               cli_plural(m.point_count), a->count);
  SCREE_TRY(scree_code_write(particle, code, &o, a->output, &result, error));
  cli_terminal_end();
  if (!call->quiet) say_code(call, particle, &result);
  return SCREE_OK;
}

static scree_status run(const cli_call *call, scree_error *error) {
  const export_arguments *a = call->options;
  double unit;
  REFUSE_WHERE(!a->output, "say with -o what to write");
  size_t code = a->to ? scree_code_find(a->to) : SIZE_MAX;
  if (a->to && scree_code_name(code)) return export_code(call, code, error);
  if (a->to && !cli_unit_from_text(a->to, &unit)) {
    char hint[64];
    cli_word_hint(CLI_UNITS CODES, a->to, hint, sizeof hint);
    return cli_misuse(call->verb, "--to %s: must be a unit (" CLI_UNITS ") or a code (%s)%s", a->to,
                      &CODES[1], hint);
  }
  REFUSE_WHERE(a->count || a->as || scree_is_clump_table(call->inputs[0]),
               "that is for another code: say which with --to");
  bool world = kind_of(call->inputs[0]) != SURFACE;
  SCREE_TRY(check_call(call, world));
  if (is_series(a->output)) return export_series(call, error);
  return world ? export_world(call, error) : export_surface(call, error);
}

const cli_verb cli_verb_export = {
    .name = "export",
    .group = CLI_SHOW,
    .summary = "write a mesh or a pile for other programs",
    .inputs = "FILE|sample:NAME|CHECKPOINT...",
    .description =
        "A particle's mesh in the unit asked, with its centre of mass at the origin and its "
        "principal axes along x, y and z when asked, and mass, centre and inertia in a JSON beside "
        "it. The surface must be closed.\n\n"
        "For other codes (--to CODE) a folder gets what that code reads: a mesh, convex pieces of "
        "it, or a clump (made of a surface, or from a table of `scree clump`), about the centre of "
        "mass along the principal axes, with mass and inertia by scree's own integrals (EDEM and "
        "MFiX work these out for themselves), and but for PFC, EDEM and MFiX scripts that let one "
        "body fall, and a heap. docs/howto/other-programs.md has a line for each.\n\n"
        "For ParaView: a surface as .vtp with the area of every triangle, and with --reference its "
        "distance to another surface; lengths in metres.\n\n"
        "A checkpoint or frame of a simulation becomes .vtp, as the view asked; of a scene .csv, a "
        "table that `bodies: {file: ...}` of another scene reads; or a folder: pile.json and "
        "bodies.csv with every body's position, quaternion and velocities, an STL per shape in "
        "the frame that the quaternions turn, and one per fragment of what breaks. "
        "docs/reference/formats.md has every field.",
    .examples = "scree export result/phone.stl --principal --to m --density 1800 -o phone-dem.stl\n"
                "scree export phone.stl --to lammps -n 20 -o phone-lammps\n"
                "scree export phone.stl --to mujoco -o phone-mujoco\n"
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
