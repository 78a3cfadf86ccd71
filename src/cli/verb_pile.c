/* scree pile: a heap of a scene measured again, or a real one from its scan, outline or picture. */
#include "base/file.h"
#include "base/owned.h"
#include "base/platform.h"
#include "cli/output.h"
#include "cli/scene_run.h"
#include "report/program.h"

#include <math.h>
#include <string.h>

typedef struct pile_arguments {
  const char *cell, *sectors, *band_low, *band_high; /* in the order of `settings` */
  const char *picture, *size;
  double unit, particle_size;
  double azimuth_deg, elevation_deg, picture_width, ruler;
  size_t rays;
  int vtp_view;
  const char *vtp;
  bool json, csv, force;
} pile_arguments;

static const pile_arguments defaults = {.unit = 1e-3,
                                        .size = "1200x900",
                                        .azimuth_deg = 35,
                                        .elevation_deg = 18,
                                        .rays = 8,
                                        .vtp_view = SCREE_VIEW_SURFACES};

static const struct {
  const char *option;
  cli_kind kind;
  size_t offset, field; /* of the arguments, of scree_pile_settings */
  double least, most;
  bool whole;
} settings[] = {
    {"cell", CLI_LENGTH_TEXT, offsetof(pile_arguments, cell), offsetof(scree_pile_settings, cell),
     0, 1000, false},
    {"sectors", CLI_TEXT, offsetof(pile_arguments, sectors), 0, 1, 3600, true},
    {"band-low", CLI_SHARE_TEXT, offsetof(pile_arguments, band_low),
     offsetof(scree_pile_settings, band_low), 0, 1, false},
    {"band-high", CLI_SHARE_TEXT, offsetof(pile_arguments, band_high),
     offsetof(scree_pile_settings, band_high), 0, 1, false},
};
enum { SETTING_COUNT = sizeof settings / sizeof *settings };

#define ARGUMENTS pile_arguments
static const cli_option options[] = {
    CLI_WORDS_ROW(CLI_UNIT, "unit", unit, "UNIT", CLI_UNITS,
                  "Unit of length of a scan or an outline that says none. Default: mm."),
    CLI_RANGE_ROW(CLI_LENGTH, "particle-size", particle_size, "LENGTH", 0, 1e3,
                  "Diameter of the particles of a measured heap: widths of bins and sectors keep "
                  "to it. Default: not known."),
    CLI_ROW(
        CLI_LENGTH_TEXT, "cell", cell, "LENGTH",
        "Side of the height field's cells; 0: a tenth of the particle size. Default: the scene's."),
    CLI_ROW(CLI_TEXT, "sectors", sectors, "N", "Azimuth sectors. Default: the scene's."),
    CLI_ROW(CLI_SHARE_TEXT, "band-low", band_low, "SHARE",
            "The flank begins at this share of the heap's height. Default: the scene's."),
    CLI_ROW(CLI_SHARE_TEXT, "band-high", band_high, "SHARE",
            "And ends at this one. Default: the scene's."),
    CLI_FLAG_ROW("json", json, "Print JSON instead of text: of a scene as result.json of repose."),
    CLI_FLAG_ROW("csv", csv,
                 "Print CSV instead of text: a scene's series up to the frame, else the outline."),
    CLI_ROW(CLI_TEXT, "output", picture, "FILE", "Write a picture of the heap, a PNG."),
    CLI_ROW(CLI_TEXT, "size", size, "WxH", "Of the picture, in pixels. Default: 1200x900."),
    CLI_RANGE_ROW(CLI_REAL, "azimuth", azimuth_deg, "DEG", -360, 360,
                  "The camera's angle about the vertical. Default: 35."),
    CLI_RANGE_ROW(CLI_REAL, "elevation", elevation_deg, "DEG", -90, 90,
                  "The camera's angle above the horizontal. Default: 18."),
    CLI_RANGE_ROW(CLI_LENGTH, "picture-width", picture_width, "LENGTH", 0, 1e4,
                  "What a picture that is measured shows across. Of one that is written: what it "
                  "shows about the middle of the heap; default: the heap."),
    CLI_RANGE_ROW(CLI_LENGTH, "ruler", ruler, "LENGTH", 0, 1e4,
                  "Of a picture that is measured, in place of its width: how long the ruler beside "
                  "the heap is."),
    CLI_RANGE_ROW(CLI_COUNT, "rays", rays, "N", 1, 65536, "Rays a pixel. Default: 8."),
    CLI_ROW(CLI_TEXT, "vtp", vtp, "FILE", "Write the particles for ParaView, a .vtp."),
    CLI_CHOICE_ROW(
        "view", vtp_view, "VIEW", "surfaces|points|contacts|walls",
        "What goes into it (a frame has no contacts, a checkpoint has). Default: surfaces."),
    CLI_FLAG_ROW("force", force, "Overwrite existing files."),
};

/* Those that were given in place of what `measure` has. */
static scree_status read_settings(const cli_call *call, scree_pile_settings *measure) {
  for (int i = 0; i < SETTING_COUNT; i++) {
    const char *text;
    char number[CLI_NUMBER_BYTES];
    double value;
    memcpy(&text, (const char *)call->options + settings[i].offset, sizeof text);
    if (!text) continue;
    text = cli_si_text(settings[i].kind, text, number);
    bool good = cli_real_from_text(text, &value) && value >= settings[i].least &&
                value <= settings[i].most && (!settings[i].whole || value == floor(value));
    if (!good)
      return cli_misuse(call->verb, "--%s %s: must be a %snumber from %g to %g", settings[i].option,
                        text, settings[i].whole ? "whole " : "", settings[i].least,
                        settings[i].most);
    if (settings[i].whole)
      measure->sectors = (size_t)value;
    else
      memcpy((char *)measure + settings[i].field, &value, sizeof value);
  }
  return SCREE_OK;
}

static scree_status write_picture(const cli_call *call, const scree_scene *scene,
                                  const scree_pile *pile, scree_render_options render,
                                  scree_error *error) {
  const pile_arguments *a = call->options;
  SCREE_CLEANUP(scree_image_free) scree_image image = {0};
  render.azimuth_deg = a->azimuth_deg;
  render.elevation_deg = a->elevation_deg;
  render.samples = a->rays;
  if (a->picture_width > 0) {
    render.focus_radius = 0.5 * a->picture_width;
    render.focus[0] = pile->repose.axis[0];
    render.focus[1] = pile->repose.axis[1];
    render.focus[2] = 0.35 * pile->repose.peak;
  }
  SCREE_TRY(scree_scene_pile_picture(scene, &render, call->progress, &image, error));
  return scree_image_write_png(&image, a->picture, a->force, error);
}

/* Also by another name, as /dev/stdout, or a file that the shell has it write to. */
static bool is_stdout(const char *path) {
  scree_path_info named, out;
  if (!path || !strcmp(path, "-")) return path;
  return scree_path_look(path, &named) && scree_descriptor_look(fileno(stdout), &out) &&
         named.kind != SCREE_PATH_DEVICE && named.device == out.device &&
         named.number == out.number;
}

/* Which two of the options write to stdout, or to one file. */
static scree_status check_apart(const cli_call *call) {
  const pile_arguments *a = call->options;
  const char *there[] = {a->json ? "--json" : NULL, a->csv ? "--csv" : NULL,
                         is_stdout(a->vtp) ? "--vtp -" : NULL,
                         is_stdout(a->picture) ? "--output -" : NULL};
  const char *first = NULL;
  for (size_t i = 0; i < sizeof there / sizeof *there; i++) {
    if (there[i] && first)
      return cli_misuse(call->verb, "%s and %s exclude each other", first, there[i]);
    if (there[i]) first = there[i];
  }
  if (a->vtp && a->picture && strcmp(a->vtp, a->picture) == 0)
    return cli_misuse(call->verb, "two outputs have the name %s", a->vtp);
  return SCREE_OK;
}

/* The text; on stderr where something else is on stdout. */
static void print_text(const cli_call *call, const scree_scene *scene, const scree_pile *pile) {
  const pile_arguments *a = call->options;
  bool beside = is_stdout(a->vtp) || is_stdout(a->picture);
  if (a->json || a->csv || (beside && call->quiet)) return;
  FILE *stream = beside ? stderr : stdout;
  const char *phase = scree_scene_phase(scene);
  fprintf(stream, "%s after %.2f s of simulated time\n", phase ? phase : "done",
          scree_world_time(scree_scene_view(scene)));
  cli_print_pile(stream, pile);
}

static scree_status measure(const cli_call *call, scree_scene *scene,
                            const scree_render_options *render, scree_error *error) {
  const pile_arguments *a = call->options;
  scree_pile_settings used = scree_scene_pile_settings(scene, 0);
  scree_pile pile;
  SCREE_TRY(read_settings(call, &used));
  SCREE_TRY(scree_scene_measure_pile(scene, 0, &used, &pile, error));
  const scree_scene_entry entry = {.scene = scene,
                                   .file = call->inputs[0],
                                   .command_line = call->command_line,
                                   .measure = &used};
  if (a->json) SCREE_TRY(scree_scene_json_write(&entry, "-", true, error));
  print_text(call, scene, &pile);
  if (a->csv) SCREE_TRY(scree_scene_csv_write(scene, "-", true, error));
  if (a->vtp)
    SCREE_TRY(scree_world_vtp_write(scree_scene_view(scene), (scree_world_view)a->vtp_view, a->vtp,
                                    a->force, error));
  return a->picture ? write_picture(call, scene, &pile, *render, error) : SCREE_OK;
}

static scree_status check_outputs(const cli_call *call, scree_error *error) {
  const pile_arguments *a = call->options;
  const char *const outputs[] = {a->vtp, a->picture};
  for (size_t i = 0; i < 2; i++)
    if (outputs[i]) SCREE_TRY(cli_check_output(call, outputs[i], a->force, error));
  return SCREE_OK;
}

/* ---- what users have: a scan of a heap, its outline, a picture of it ---- */

typedef enum pile_kind {
  SCENE, /* a frame or a checkpoint */
  SCAN,
  OUTLINE,
  PICTURE,
} pile_kind;

/* By content and name: a PNG is a picture, .csv an outline, scree's own files and stdin a scene. */
static pile_kind kind_of(const char *path) {
  char head[8] = {0};
  scree_stream stream;
  if (!strcmp(path, "-")) return SCENE;
  if (cli_is_sample(path, NULL)) return SCAN;
  if (cli_has_ending(path, ".csv")) return OUTLINE;
  if (!scree_stream_open(path, &stream)) return SCENE; /* which says why */
  bool whole = scree_stream_read(&stream, head, sizeof head);
  scree_stream_close(&stream);
  if (whole && !memcmp(head, "\x89PNG\r\n\x1a\n", sizeof head)) return PICTURE;
  return whole && !memcmp(head, "scree", 5) ? SCENE : SCAN;
}

/* What was found, to be freed but for the numbers. */
typedef struct found {
  pile_kind kind;
  scree_repose_options how;
  scree_ground ground;
  scree_repose repose;
  scree_outline outline;
} found;

static void free_found(found *f) {
  scree_outline_free(&f->outline);
}

static scree_status measure_scan(const cli_call *call, double cell, found *f, scree_error *error) {
  const pile_arguments *a = call->options;
  const cli_source source = {.unit = a->unit, .resolution = 0.27e-3, .seed = 1};
  cli_input_options input = cli_source_options(&source);
  SCREE_CLEANUP(scree_height_field_free) scree_height_field field = {0};
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  input.remarked = true; /* a heap is larger than a particle */
  SCREE_TRY(cli_load(call->inputs[0], &input, call->progress, &scan, error));
  SCREE_TRY(scree_height_field_scan(&scan.mesh, cell, &f->ground, &field, error));
  SCREE_TRY(scree_repose_measure(&field, &f->how, &f->repose, error));
  return a->csv ? scree_outline_of_field(&field, f->repose.axis[0], &f->outline, error) : SCREE_OK;
}

static scree_status measure_picture(const cli_call *call, found *f, scree_error *error) {
  const pile_arguments *a = call->options;
  SCREE_CLEANUP(scree_image_free) scree_image image = {0};
  scree_outline *o = &f->outline;
  SCREE_TRY(scree_image_read_png(call->inputs[0], &image, error));
  double pixel = a->ruler > 0 ? 1 : a->picture_width / (double)image.width;
  SCREE_TRY(scree_outline_trace(image.pixels, image.width, image.height, pixel, o, error));
  if (a->ruler > 0 && o->ruler == 0)
    return scree_fail(error, SCREE_BAD_FILE,
                      "no ruler: a bar beside the heap that stands out of the ground, or apart");
  double scale = a->ruler > 0 ? a->ruler / o->ruler : 1;
  for (size_t i = 0; i < o->count; i++) {
    o->x[i] *= scale;
    o->z[i] *= scale;
  }
  if (o->ruler > 0 && a->ruler == 0 && !call->quiet)
    fprintf(stderr, "scree: %s: a bar of %.4g mm beside the heap is left out, as a ruler\n",
            call->inputs[0], 1e3 * o->ruler);
  return SCREE_OK;
}

static scree_status find(const cli_call *call, double cell, found *f, scree_error *error) {
  const pile_arguments *a = call->options;
  if (f->kind == SCAN) return measure_scan(call, cell, f, error);
  SCREE_TRY(f->kind == PICTURE ? measure_picture(call, f, error)
                               : scree_outline_read(call->inputs[0], a->unit, &f->outline, error));
  return scree_outline_measure(&f->outline, cell, &f->how, &f->repose, error);
}

static void print_outline(const scree_outline *o) {
  puts("x [m],z [m]");
  for (size_t i = 0; i < o->count; i++) printf("%.6g,%.6g\n", o->x[i], o->z[i]);
}

static void print_found(const found *f) {
  const scree_ground *g = &f->ground;
  if (f->kind == SCAN) {
    printf("floor in %.0f %% of the scan, to %.2g mm, turned by %.1f deg", 100 * g->share,
           1e3 * g->rms, 57.29577951308232 * acos(fmin(1, g->up[2])));
    if (g->filled > 0) printf("; holes filled: %.1f %% of the heap", 100 * g->filled);
    putchar('\n');
  } else {
    printf("%s, %zu points, %.4g mm across; sectors and silhouettes are its two sides\n",
           f->kind == PICTURE ? "silhouette" : "outline", f->outline.count,
           1e3 * (f->outline.x[f->outline.count - 1] - f->outline.x[0]));
  }
  cli_print_repose(stdout, &f->repose);
}

/* What belongs to scenes is refused. */
static scree_status check_measured(const cli_call *call, pile_kind kind) {
  const pile_arguments *a = call->options;
  const char *file = call->inputs[0];
  bool picture = kind == PICTURE;
  if (a->picture || a->vtp)
    return cli_misuse(call->verb, "--%s draws the heap of a scene; %s is none",
                      a->picture ? "output" : "vtp", file);
  if (picture != (a->picture_width > 0 || a->ruler > 0))
    return cli_misuse(call->verb,
                      picture ? "%s is a picture: --picture-width says what it shows across, or "
                                "--ruler how long the ruler in it is"
                              : "--picture-width is of pictures, which are PNG here; %s is none",
                      file);
  if (kind != SCAN && a->sectors)
    return cli_misuse(call->verb, "--sectors: %s is an outline, with two sides", file);
  return SCREE_OK;
}

/* A heap that no scene has. */
static scree_status run_measured(const cli_call *call, pile_kind kind, scree_error *error) {
  static const char *const kinds[] = {"scene", "scan", "outline", "picture"};
  const pile_arguments *a = call->options;
  SCREE_CLEANUP(free_found) found f = {.kind = kind, .how = scree_default_repose_options()};
  scree_pile_settings used = {0, f.how.sector_count, f.how.band_low, f.how.band_high};
  SCREE_TRY(read_settings(call, &used));
  SCREE_TRY(check_measured(call, kind));
  f.how.sector_count = used.sectors;
  f.how.band_low = used.band_low;
  f.how.band_high = used.band_high;
  f.how.particle_size = a->particle_size;
  if (find(call, used.cell, &f, error) != SCREE_OK)
    return cli_name_in_error(call->inputs[0], error);
  const scree_heap_entry entry = {call->inputs[0], kinds[kind], call->command_line,
                                  &f.repose,       &f.how,      kind == SCAN ? &f.ground : NULL};
  if (a->json) return scree_heap_json_write(&entry, "-", true, error);
  if (a->csv)
    print_outline(&f.outline);
  else
    print_found(&f);
  return SCREE_OK;
}

static scree_status run(const cli_call *call, scree_error *error) {
  const pile_arguments *a = call->options;
  scree_render_options render = scree_default_render_options();
  SCREE_OWNED(scree_scene, loaded);
  pile_kind kind = kind_of(call->inputs[0]);
  SCREE_TRY(check_apart(call));
  SCREE_TRY(cli_parse_size(call->verb, a->size, &render.width, &render.height));
  if (a->vtp) SCREE_TRY(cli_check_ending(call->verb, a->vtp, CLI_VTP));
  if (a->picture) SCREE_TRY(cli_check_ending(call->verb, a->picture, CLI_PICTURE));
  if (kind != SCENE) return run_measured(call, kind, error);
  bool there = !strcmp(call->inputs[0], "-") || scree_path_look(call->inputs[0], NULL);
  if (there && (a->particle_size > 0 || (a->picture_width > 0 && !a->picture)))
    return cli_misuse(call->verb, "--%s does nothing here: %s",
                      a->particle_size > 0 ? "particle-size" : "picture-width",
                      a->particle_size > 0 ? "a scene knows its particles" : "give --output");
  SCREE_TRY(check_outputs(call, error));
  SCREE_TRY(scree_scene_load(call->inputs[0], &loaded, error));
  if (a->vtp && a->vtp_view == SCREE_VIEW_CONTACTS && scree_scene_is_frame(loaded))
    return cli_refuse(error, SCREE_UNSUPPORTED, call->inputs[0],
                      "a frame holds no contacts; a checkpoint does");
  if (!scree_scene_pile_name(loaded, 0))
    return cli_refuse(error, SCREE_UNSUPPORTED, call->inputs[0],
                      "its scene has no sensor of a pile: sensors: {heap: {pile: {}}}");
  return measure(call, loaded, &render, error);
}

const cli_verb cli_verb_pile = {
    .name = "pile",
    .group = CLI_DECIDE,
    .summary = "measure a heap: of a scene, or a real one",
    .inputs = "FILE",
    .description =
        "Measures a frame or a checkpoint that `scree repose` or `scree run` wrote, with the "
        "settings of its pile sensor or with others: angle of repose three ways with its spread, "
        "height, base radius, run-out, packing fraction and coordination number. - is stdin.\n\n"
        "Any other FILE is a real heap. A scan of it, in any orientation, must have some of the "
        "floor around it. A CSV is its outline, with lines x,z and a head as x [mm],z [mm]. A PNG "
        "is a picture of its silhouette from the side. An outline's three ways share two flanks.",
    .examples = "scree pile heap/last.scree\n"
                "scree pile heap/last.scree --band-low 0.1 --band-high 0.9 --json\n"
                "scree pile heap/frame-000012.scree -o frame.png --elevation 5\n"
                "scree pile heap.ply --unit m --particle-size 8mm\n"
                "scree pile photograph.png --picture-width 0.5m --csv\n"
                "scree pile photograph.png --ruler 300mm\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = 1,
    .exclusive = "picture-width|ruler",
    .partners = "size:output azimuth:output elevation:output rays:output view:vtp",
    .run = run,
};
