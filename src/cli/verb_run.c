/* scree run: a scene of the user's own. */
#include "base/owned.h"
#include "cli/scene_run.h"

typedef struct run_arguments {
  cli_scene_options scene;
  const char *template_name;
} run_arguments;

static const run_arguments defaults = {.scene.rays = 8};

#define ARGUMENTS run_arguments
static const cli_option options[] = {
    CLI_ROW(CLI_TEXT, "output", scene.output, "DIR",
            "A folder, made if need be, for result.json, series.csv, scene.yaml, checkpoint.scree, "
            "bodies.pvd and geometry.pvd with their frames, scene.png and report.html."),
    CLI_ROW(CLI_TEXTS, "set", scene.set, "FIELD=VALUE",
            "Change any field of the file, as inlets.feed.rate=5; may be given several times."),
    CLI_FLAG_ROW("print", scene.print,
                 "Print the scene as it would be run, with units and comments, and stop."),
    CLI_EACH_ROW(
        "template", template_name, "NAME", scree_scene_template_name,
        "A built-in scene in place of a file: hopper, drum, tilting-box, drawdown, "
        "hollow-cylinder, conveyor, vibrating-screen, shear-box, drum-lifters, "
        "paddle-mixer, tumbler, hammer-mill, shredder, transfer-chute, belt, auger or hole-screen. "
        "Without -o, --set, --print and --json it is printed with its comments, to start "
        "from."),
    CLI_FLAG_ROW(
        "resume", scene.resume,
        "Go on from the checkpoint in DIR where there is one; without a file, with what is in it."),
    CLI_ROW(CLI_TEXTS, "change", scene.change, "FIELD=VALUE|FILE",
            "With --resume: go on with another value, as geometry.drum.motion.0.rotate.speed=3, or "
            "with all of a file that has such fields; may be given several times. What may change: "
            "motions, friction, gravity, inlets, outlets, sensors, times."),
    CLI_FLAG_ROW("force", scene.overwrite,
                 "Begin anew in a folder with an earlier scene, whose files go."),
    CLI_FLAG_ROW("json", scene.json, "Print result.json instead of text."),
    CLI_FLAG_ROW("no-picture", scene.no_picture, "Do not render scene.png."),
    CLI_RANGE_ROW(CLI_COUNT, "rays", scene.rays, "N", 1, 65536,
                  "Rays a pixel of scene.png. Default: 8."),
};

static scree_status simulate(cli_scene_run *r, scree_error *error) {
  const cli_scene_options *o = r->options;
  char shown[CLI_PRINTABLE_BYTES];
  if (o->output) SCREE_TRY(cli_check_scene_output(r, error));
  SCREE_TRY(cli_run_scene(r, error));
  if (o->json) return SCREE_OK;
  if (o->output)
    printf("  look at           %s/report.html\n", cli_printable(o->output, shown));
  else
    puts("  Nothing was kept: -o DIR writes states, tables and a report.");
  return SCREE_OK;
}

/* ---- the call ---- */

/* A template by itself is text to start from; with where to write or what to change it is run. */
static bool prints_template(const run_arguments *a) {
  const cli_scene_options *o = &a->scene;
  return a->template_name && !o->output && !o->set.count && !o->print && !o->json;
}

static scree_status check_call(const cli_call *call) {
  const run_arguments *a = call->options;
  const cli_scene_options *o = &a->scene;
  bool scene = call->input_count || a->template_name;
  if (call->input_count && a->template_name)
    return cli_misuse(call->verb, "--template takes no file");
  if (!scene && !(o->resume && o->output))
    return cli_misuse(call->verb, "needs a SCENE.yaml, or --resume with -o DIR; --template NAME "
                                  "prints one to start from");
  if (!scene && (o->set.count || o->print))
    return cli_misuse(call->verb,
                      "--set and --print need a SCENE.yaml; --change changes the scene that the "
                      "folder has");
  if (o->change.count && (!o->resume || scene))
    return cli_misuse(call->verb, "--change needs --resume, and no SCENE.yaml: it changes the "
                                  "scene that the folder has");
  if (o->resume && !o->output) return cli_misuse(call->verb, "--resume needs -o DIR");
  return SCREE_OK;
}

static scree_status run(const cli_call *call, scree_error *error) {
  const run_arguments *a = call->options;
  SCREE_OWNED(scree_scene_file, file);
  SCREE_TRY(check_call(call));
  if (a->template_name && scree_scene_file_template(a->template_name, &file, error) != SCREE_OK)
    return cli_misuse(call->verb, "--template: %s", error->message);
  if (prints_template(a)) {
    fputs(scree_scene_template(a->template_name), stdout); /* its end tells where that failed */
    return SCREE_OK;
  }
  if (call->input_count) SCREE_TRY(scree_scene_file_read(call->inputs[0], &file, error));
  if (file) {
    SCREE_TRY(cli_set_fields(call, file, NULL, &a->scene.set));
    SCREE_TRY(scree_scene_file_check(file, error));
  }
  if (a->scene.print) return scree_scene_file_print(file, stdout, error);
  SCREE_CLEANUP(cli_scene_run_free)
  cli_scene_run r = {.call = call,
                     .options = &a->scene,
                     .start = scree_work_started(),
                     .file = file,
                     .file_name = call->input_count ? call->inputs[0] : NULL,
                     .output = a->scene.output,
                     .views = CLI_BODIES | CLI_GEOMETRY};
  return simulate(&r, error);
}

const cli_verb cli_verb_run = {
    .name = "run",
    .group = CLI_SIMULATE,
    .summary = "run a scene of your own: shapes, moving geometry, inlets, sensors",
    .inputs = "SCENE.yaml",
    .description =
        "Simulates what a YAML file describes (docs/reference/scenes.md): shapes from scans, "
        "spheres and clumps; geometry from mesh files and solids, at rest or moving; inlets, "
        "outlets, sensors. `scree run --template NAME > my.yaml` writes a commented file to start "
        "from. Every error in a file is told with line and column, and with what is allowed.\n\n"
        "Prints what came in, is inside and went out, and what the sensors read. With -o DIR "
        "writes result.json, series.csv (all numbers over time), scene.yaml (the scene with every "
        "default), sensor-*.csv (what sensors have besides columns), bodies.pvd and geometry.pvd "
        "with their frames for ParaView, scene.png, and report.html, which plays it. Ctrl-C leaves "
        "a checkpoint, as a crash does: --resume goes on with the same bits. The same file gives "
        "the same bits for any number of threads. A scene that leaves the range of the contact law "
        "stops with step, body and cause, and leaves the state shortly before in stopped.scree.",
    .examples = "scree run --template hopper > hopper.yaml\n"
                "scree run hopper.yaml -o hopper\n"
                "scree run hopper.yaml --set inlets.feed.count=800 --set time=6 -o more\n"
                "scree run -o hopper --resume\n"
                "scree run -o hopper --resume --change gravity='[0, 0, -1.62]' --change time=8\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 0,
    .input_maximum = 1,
    .partners = "rays:output force:output",
    .run = run,
};
