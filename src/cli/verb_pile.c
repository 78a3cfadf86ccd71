/* scree pile: a frame or a checkpoint, measured again. */
#include "base/platform.h"
#include "cli/heap.h"
#include "cli/output.h"

#include <string.h>

typedef struct pile_arguments {
  const char *cell, *sectors, *band_low, *band_high; /* in the order of `settings` */
  const char *picture, *size;
  double azimuth_deg, elevation_deg, picture_width;
  size_t rays;
  int vtp_view;
  const char *vtp;
  bool json, csv, force;
} pile_arguments;

static const pile_arguments defaults = {.size = "1200x900",
                                        .azimuth_deg = 35,
                                        .elevation_deg = 18,
                                        .rays = 24,
                                        .vtp_view = SCREE_VIEW_SURFACES};

static const struct {
  const char *option, *field;
  cli_kind kind;
  size_t offset;
} settings[] = {
    {"cell", "measure.cell", CLI_LENGTH_TEXT, offsetof(pile_arguments, cell)},
    {"sectors", "measure.sectors", CLI_TEXT, offsetof(pile_arguments, sectors)},
    {"band-low", "measure.band_low", CLI_SHARE_TEXT, offsetof(pile_arguments, band_low)},
    {"band-high", "measure.band_high", CLI_SHARE_TEXT, offsetof(pile_arguments, band_high)},
};
enum { SETTING_COUNT = sizeof settings / sizeof *settings };

#define AT(field) offsetof(pile_arguments, field)
static const cli_option options[] = {
    {"cell", CLI_LENGTH_TEXT, AT(cell), "LENGTH",
     "Side of the height field's cells; 0: a tenth of the particle size. Default: the run's.", 0, 0,
     NULL},
    {"sectors", CLI_TEXT, AT(sectors), "N", "Azimuth sectors. Default: the run's.", 0, 0, NULL},
    {"band-low", CLI_SHARE_TEXT, AT(band_low), "SHARE",
     "The flank begins at this share of the heap's height. Default: the run's.", 0, 0, NULL},
    {"band-high", CLI_SHARE_TEXT, AT(band_high), "SHARE",
     "And ends at this one. Default: the run's.", 0, 0, NULL},
    {"json", CLI_FLAG, AT(json), NULL, "Print JSON instead of text: as result.json of repose.", 0,
     0, NULL},
    {"csv", CLI_FLAG, AT(csv), NULL, "Print the series up to the frame as CSV instead of text.", 0,
     0, NULL},
    {"output", CLI_TEXT, AT(picture), "FILE", "Write a picture of the heap, a PNG.", 0, 0, NULL},
    {"size", CLI_TEXT, AT(size), "WxH", "Of the picture, in pixels. Default: 1200x900.", 0, 0,
     NULL},
    {"azimuth", CLI_REAL, AT(azimuth_deg), "DEG",
     "The camera's angle about the vertical. Default: 35.", -360, 360, NULL},
    {"elevation", CLI_REAL, AT(elevation_deg), "DEG",
     "The camera's angle above the horizontal. Default: 18.", -90, 90, NULL},
    {"picture-width", CLI_LENGTH, AT(picture_width), "LENGTH",
     "What the picture shows across, about the middle of the heap. Default: the heap.", 0, 1e4,
     NULL},
    {"rays", CLI_COUNT, AT(rays), "N", "Rays a pixel. Default: 24.", 1, 65536, NULL},
    {"vtp", CLI_TEXT, AT(vtp), "FILE", "Write the particles for ParaView, a .vtp.", 0, 0, NULL},
    {"view", CLI_CHOICE, AT(vtp_view), "VIEW",
     "What goes into it (a frame has no contacts, a checkpoint has). Default: surfaces.", 0, 0,
     "surfaces|points|contacts|walls"},
    {"force", CLI_FLAG, AT(force), NULL, "Overwrite existing files.", 0, 0, NULL},
};
#undef AT

/* The run's settings with those that were given; 0, or the exit code. */
static int read_settings(const cli_call *call, const scree_run *run, scree_experiment *measure,
                         scree_error *error) {
  if (scree_experiment_copy(scree_run_experiment(run), measure, error) != SCREE_OK)
    return cli_fail(error);
  for (int i = 0; i < SETTING_COUNT; i++) {
    const char *text;
    char number[CLI_NUMBER_BYTES];
    memcpy(&text, (const char *)call->options + settings[i].offset, sizeof text);
    if (text) text = cli_si_text(settings[i].kind, text, number);
    if (text && scree_experiment_set(measure, settings[i].field, text, error) != SCREE_OK)
      return cli_misuse(call->verb, "--%s: %s", settings[i].option, error->message);
  }
  return scree_experiment_check(measure, error) == SCREE_OK ? 0 : cli_fail(error);
}

static int write_picture(const cli_call *call, const scree_run *run, const scree_run_result *result,
                         scree_render_options render, scree_error *error) {
  const pile_arguments *a = call->options;
  render.azimuth_deg = a->azimuth_deg;
  render.elevation_deg = a->elevation_deg;
  render.samples = a->rays;
  if (a->picture_width > 0) {
    render.focus_radius = 0.5 * a->picture_width;
    render.focus[0] = result->repose.axis[0];
    render.focus[1] = result->repose.axis[1];
    render.focus[2] = 0.35 * result->repose.peak;
  }
  return cli_write_picture(run, &render, a->picture, a->force, call->progress, error) == SCREE_OK
             ? 0
             : cli_fail(error);
}

/* Also by another name, as /dev/stdout, or a file that the shell has it write to. */
static bool is_stdout(const char *path) {
  scree_path_info named, out;
  if (!path || !strcmp(path, "-")) return path;
  return scree_path_look(path, &named) && scree_descriptor_look(fileno(stdout), &out) &&
         named.kind != SCREE_PATH_DEVICE && named.device == out.device &&
         named.number == out.number;
}

/* 0, or 2 after telling which two of the options write to stdout, or to one file. */
static int check_apart(const cli_call *call) {
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
  return 0;
}

/* The text; on stderr where something else is on stdout. */
static void print_text(const cli_call *call, const scree_run *run, const scree_run_result *result) {
  const pile_arguments *a = call->options;
  bool beside = is_stdout(a->vtp) || is_stdout(a->picture);
  if (a->json || a->csv || (beside && call->quiet)) return;
  cli_print_heap(beside ? stderr : stdout, run, result);
}

static int measure(const cli_call *call, scree_run *run, const scree_render_options *render,
                   scree_error *error) {
  const pile_arguments *a = call->options;
  scree_experiment settings_used = {0};
  scree_run_result result;
  int code = read_settings(call, run, &settings_used, error);
  if (code == 0 && scree_run_measure_with(run, &settings_used, &result, error) != SCREE_OK)
    code = cli_fail(error);
  scree_heap_entry entry = {run, &result, call->inputs[0], &settings_used, call->command_line};
  if (code == 0 && a->json && scree_heap_json_write(&entry, "-", true, error) != SCREE_OK)
    code = cli_fail(error);
  if (code == 0) print_text(call, run, &result);
  if (code == 0 && a->csv && scree_series_csv_write(run, "-", true, error) != SCREE_OK)
    code = cli_fail(error);
  if (code == 0 && a->vtp &&
      scree_world_vtp_write(scree_run_view(run), (scree_world_view)a->vtp_view, a->vtp, a->force,
                            error) != SCREE_OK)
    code = cli_fail(error);
  if (code == 0 && a->picture) code = write_picture(call, run, &result, *render, error);
  scree_experiment_free(&settings_used);
  return code;
}

static scree_status check_outputs(const cli_call *call, scree_error *error) {
  const pile_arguments *a = call->options;
  const char *const outputs[] = {a->vtp, a->picture};
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < 2 && status == SCREE_OK; i++)
    if (outputs[i]) status = cli_check_output(call, outputs[i], a->force, error);
  return status;
}

static int run(const cli_call *call) {
  const pile_arguments *a = call->options;
  scree_render_options render = scree_default_render_options();
  scree_run *loaded;
  scree_error error;
  int code = check_apart(call);
  if (code == 0) code = cli_parse_size(call->verb, a->size, &render.width, &render.height);
  if (code == 0 && a->vtp) code = cli_check_ending(call->verb, a->vtp, CLI_VTP);
  if (code == 0 && a->picture) code = cli_check_ending(call->verb, a->picture, CLI_PICTURE);
  if (code) return code;
  if (check_outputs(call, &error) != SCREE_OK) return cli_fail(&error);
  if (scree_run_load(call->inputs[0], &loaded, &error) != SCREE_OK) return cli_fail(&error);
  if (a->vtp && a->vtp_view == SCREE_VIEW_CONTACTS && scree_run_is_frame(loaded)) {
    cli_refuse(&error, SCREE_UNSUPPORTED, call->inputs[0],
               "a frame holds no contacts; a checkpoint does");
    code = cli_fail(&error);
  } else {
    code = measure(call, loaded, &render, &error);
  }
  scree_run_free(loaded);
  return code;
}

const cli_verb cli_verb_pile = {
    .name = "pile",
    .summary = "measure a heap of `scree repose` again, draw it",
    .inputs = "FRAME",
    .description =
        "Measures a frame or a checkpoint that `scree repose` wrote, with the run's settings or "
        "with others: angle of repose three ways with its spread, height, base radius, run-out, "
        "packing fraction and coordination number. - is stdin.",
    .examples = "scree pile heap/last.scree\n"
                "scree pile heap/last.scree --band-low 0.1 --band-high 0.9 --json\n"
                "scree pile heap/frame-0012.scree -o frame.png --elevation 5\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .defaults = &defaults,
    .options_size = sizeof defaults,
    .input_minimum = 1,
    .input_maximum = 1,
    .partners =
        "size:output azimuth:output elevation:output picture-width:output rays:output view:vtp",
    .run = run,
};
