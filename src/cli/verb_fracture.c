/* scree fracture: a scan as pieces that fill it, and a table of where they meet. */
#include "base/file.h"
#include "cli/input.h"
#include "cli/output.h"
#include "cli/surface.h"
#include "cli/terminal.h"

#include <math.h>
#include <string.h>

enum { PATH_BYTES = 4096 };

typedef struct fracture_arguments {
  const char *output, *near, *grain;
  cli_source source;
  double least;
  size_t count, seed, rounds;
  int format;
  bool force, no_repair, slivers;
} fracture_arguments;

#define ARGUMENTS fracture_arguments
static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", output, "DIR",
            "The folder for the pieces (piece-001.ply and on), pieces.csv and joints.csv."),
    CLI_RANGE_ROW(CLI_COUNT, "count", count, "COUNT", 1, SCREE_MOST_CELLS,
                  "How many cells. Default: 60."),
    CLI_RANGE_ROW(CLI_COUNT, "seed", seed, "N", 0, 9007199254740992.0,
                  "Seed of the cells' places. Default: 1."),
    CLI_RANGE_ROW(
        CLI_COUNT, "rounds", rounds, "N", 0, 1000,
        "Rounds of Lloyd's relaxation, which makes cells alike; 0: as drawn. Default: 8."),
    CLI_ROW(CLI_TEXT, "near", near, "X,Y,Z:LENGTH",
            "Denser cells near a place of the scan: half as many in a volume at this distance from "
            "it. As 10mm,0mm,5mm:20mm."),
    CLI_ROW(CLI_TEXT, "grain", grain, "X,Y,Z:FACTOR",
            "Cells that are so many times as long along a direction, 1 to 100. As 0,0,1:4."),
    CLI_RANGE_ROW(CLI_SHARE, "least", least, "SHARE", 0, 0.5,
                  "Pieces with less than this share of the mean volume join a neighbour. Default: "
                  "0.01."),
    CLI_FLAG_ROW("slivers", slivers,
                 "Keep pieces that `scree check` would refuse for sharp edges or facets without "
                 "area, which else join the neighbour there."),
    CLI_CHOICE_ROW("format", format, "FORMAT", "ply|off|obj|stl|3mf",
                   "What the pieces are written as; stl rounds them to 24 bits, which leaves gaps. "
                   "Default: ply."),
    CLI_FLAG_ROW("no-repair", no_repair,
                 "Refuse a scan that is no closed surface instead of repairing it."),
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("force", force, "Write over the files of an earlier call."),
};
static const char *const endings[] = {".ply", ".off", ".obj", ".stl", ".3mf"};

static const fracture_arguments defaults = {
    .source = CLI_SOURCE_DEFAULTS, .least = 0.01, .count = 60, .seed = 1, .rounds = 8};

/* "X,Y,Z:VALUE": three numbers or lengths, and a fourth. */
static bool split(const char *text, bool lengths, double three[3], double *fourth) {
  char part[4][64];
  static const char marks[] = ",,:";
  for (int k = 0; k < 4; k++) {
    const char *end = k < 3 ? strchr(text, marks[k]) : text + strlen(text);
    double *to = k < 3 ? &three[k] : fourth;
    if (!end || (size_t)(end - text) >= sizeof part[k]) return false;
    snprintf(part[k], sizeof part[k], "%.*s", (int)(end - text), text);
    bool minus = lengths && part[k][0] == '-';
    if (!(lengths ? cli_length_from_text(part[k] + minus, to) : cli_real_from_text(part[k], to)))
      return false;
    if (minus) *to = -*to;
    text = end + (k < 3);
  }
  return true;
}

static scree_status take_options(const cli_call *call, scree_fracture_options *o) {
  const fracture_arguments *a = call->options;
  o->cell_count = a->count;
  o->seed = a->seed;
  o->rounds = a->rounds;
  o->least_volume = a->least;
  o->usable = !a->slivers;
  if (a->near && (!split(a->near, true, o->near, &o->near_distance) || !(o->near_distance > 0)))
    return cli_misuse(call->verb, "--near %s: must be as 10mm,0mm,5mm:20mm", a->near);
  if (a->grain && !split(a->grain, false, o->grain, &o->grain_stretch))
    return cli_misuse(call->verb, "--grain %s: must be as 0,0,1:4", a->grain);
  return SCREE_OK;
}

/* ---- files ---- */

static scree_status write_joints(const scree_fracture *f, const char *path, bool force,
                                 scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, force, &output, error));
  fputs("a,b,area [m2],x [m],y [m],z [m],normal x,normal y,normal z,axis x,axis y,axis z,"
        "second moment along axis [m4],second moment across [m4],reach along axis [m],"
        "reach across [m],distance [m]\n",
        output.stream);
  for (size_t i = 0; i < f->face_count; i++) {
    const scree_fracture_face *j = &f->faces[i];
    fprintf(output.stream,
            "%u,%u,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,"
            "%.17g,%.17g\n",
            j->a + 1, j->b + 1, j->area, j->centre[0], j->centre[1], j->centre[2], j->normal[0],
            j->normal[1], j->normal[2], j->axis[0], j->axis[1], j->axis[2], j->second_moments[0],
            j->second_moments[1], j->reach[0], j->reach[1], j->distance);
  }
  return scree_output_commit(&output, error);
}

static void piece_name(const cli_call *call, size_t piece, char name[64]) {
  const fracture_arguments *a = call->options;
  snprintf(name, 64, "piece-%03zu%s", piece + 1, endings[a->format]);
}

static scree_status write_table(const cli_call *call, const scree_fracture *f, const char *path,
                                scree_error *error) {
  const fracture_arguments *a = call->options;
  scree_output output;
  SCREE_TRY(scree_output_open(path, a->force, &output, error));
  fputs("piece,file,triangles,volume [m3],x [m],y [m],z [m]\n", output.stream);
  for (size_t p = 0; p < f->piece_count; p++) {
    char name[64];
    scree_measures m;
    scree_status status = scree_mesh_measure(&f->pieces[p], &m, error);
    if (status != SCREE_OK) {
      scree_output_discard(&output);
      return status;
    }
    piece_name(call, p, name);
    fprintf(output.stream, "%zu,%s,%zu,%.17g,%.17g,%.17g,%.17g\n", p + 1, name,
            f->pieces[p].triangle_count, m.volume, m.centroid[0], m.centroid[1], m.centroid[2]);
  }
  return scree_output_commit(&output, error);
}

static scree_status write_pieces(const cli_call *call, const scree_fracture *f,
                                 scree_error *error) {
  const fracture_arguments *a = call->options;
  char path[PATH_BYTES], name[64];
  for (size_t p = 0; p < f->piece_count; p++) {
    piece_name(call, p, name);
    SCREE_TRY(cli_join_path(a->output, "", name, "", path, sizeof path, error));
    const scree_write_options write = cli_write_options(call, path, a->source.unit, a->force);
    SCREE_TRY(scree_mesh_write(&f->pieces[p], path, &write, error));
  }
  SCREE_TRY(cli_join_path(a->output, "", "pieces.csv", "", path, sizeof path, error));
  SCREE_TRY(write_table(call, f, path, error));
  SCREE_TRY(cli_join_path(a->output, "", "joints.csv", "", path, sizeof path, error));
  return write_joints(f, path, a->force, error);
}

/* ---- what is told ---- */

static void tell(const cli_call *call, const scree_fracture *f) {
  char shown[CLI_PRINTABLE_BYTES];
  const fracture_arguments *a = call->options;
  double sum = 0, volume, least = INFINITY, most = 0;
  for (size_t p = 0; p < f->piece_count; p++) {
    if (scree_mesh_area_volume(&f->pieces[p], NULL, &volume, NULL) != SCREE_OK) continue;
    sum += volume;
    least = volume < least ? volume : least;
    most = volume > most ? volume : most;
  }
  cli_terminal_end();
  printf("%s: %zu pieces of %.3g to %.3g cm3 from %zu cell%s, %zu joints; together %.6g cm3, off "
         "by %.1g of the scan's\n",
         cli_printable(call->inputs[0], shown), f->piece_count, least * 1e6, most * 1e6, a->count,
         cli_plural(a->count), f->face_count, sum * 1e6, fabs(sum / f->volume - 1));
  if (call->quiet) return;
  if (f->apart_count > 0)
    printf("%10zu cell%s fell into several pieces: the body is not convex\n", f->apart_count,
           cli_plural(f->apart_count));
  if (f->joined_count > 0)
    printf("%10zu sliver%s joined to a neighbour\n", f->joined_count, cli_plural(f->joined_count));
  if (f->small_face_count > 0)
    printf("%10zu face%s without a joint: below a ten-thousandth of the mean area\n",
           f->small_face_count, cli_plural(f->small_face_count));
  printf("coordinates in %s\n", cli_unit_name(a->source.unit));
}

static scree_status run(const cli_call *call, scree_error *error) {
  static const char *const names[] = {"joints.csv", "pieces.csv", "piece-#.*"};
  const cli_run_files files = {names, sizeof names / sizeof *names};
  const fracture_arguments *a = call->options;
  scree_fracture_options how = scree_default_fracture_options();
  cli_input_options input = cli_source_options(&a->source);
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  SCREE_CLEANUP(scree_fracture_free) scree_fracture made = {0};
  char path[PATH_BYTES];
  if (!a->output) return cli_misuse(call->verb, "say with -o which folder the pieces are to go to");
  SCREE_TRY(take_options(call, &how));
  SCREE_TRY(cli_join_path(a->output, "", "joints.csv", "", path, sizeof path, error));
  SCREE_TRY(cli_make_folder(a->output, error));
  SCREE_TRY(cli_check_output(call, path, a->force, error));
  SCREE_TRY(cli_load_closed(call->inputs[0], &input, a->no_repair, call->progress, &scan, NULL,
                            NULL, error));
  scree_status status = scree_mesh_fracture(&scan.mesh, &how, call->progress, &made, error);
  if (status != SCREE_OK) return cli_name_in_error(call->inputs[0], error);
  if (a->force) SCREE_TRY(cli_clear_run_output(call, a->output, &files, error));
  SCREE_TRY(write_pieces(call, &made, error));
  tell(call, &made);
  return SCREE_OK;
}

const cli_verb cli_verb_fracture = {
    .name = "fracture",
    .summary = "cut a scan into pieces that fill it, with a table of where they meet",
    .inputs = "FILE|sample:NAME",
    .description =
        "Cuts a closed scan, convex or not, into the Voronoi cells of points in it. Pieces are "
        "closed and fill the scan; where two meet, both have the same triangles. A cell of a body "
        "that is not convex may fall into several pieces, which is said. A scan that is no closed "
        "surface is repaired first.\n\n"
        "Slivers, and pieces that no contact could be computed for, join a neighbour. joints.csv "
        "has a row for each plane face between two pieces: area, centre, normal, principal axis, "
        "second moments and the distance of the cells' centres, as beams or bonds in other codes "
        "ask for them. Numbers of pieces begin at 1, as in their files' names.\n\n"
        "A scan of many triangles makes pieces of many: `scree simplify` it first.",
    .examples = "scree fracture phone.stl -n 60 --seed 1 -o pieces\n"
                "scree fracture stone.ply -n 200 --near 0mm,0mm,12mm:5mm -o struck\n"
                "scree fracture board.stl -n 80 --grain 1,0,0:4 --format stl -o splinters\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = 1,
    .partners = CLI_SAMPLE_PARTNERS,
    .run = run,
};
