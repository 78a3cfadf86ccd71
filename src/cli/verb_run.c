/* scree run: a scene of the user's own. */
#include "cli/scene_run.h"

#include <string.h>

typedef struct run_arguments {
  const char *output, *template_name;
  cli_texts set, change;
  size_t rays;
  bool print, resume, overwrite, json, no_picture;
} run_arguments;

static const run_arguments defaults = {.rays = 24};

#define AT(field) offsetof(run_arguments, field)
static const cli_option options[] = {
    {"output", CLI_TEXT, AT(output), "DIR",
     "A folder, made if need be, for result.json, series.csv, scene.yaml, checkpoint.scree, "
     "bodies.pvd and geometry.pvd with their frames, scene.png and report.html.",
     0, 0, NULL},
    {"set", CLI_TEXTS, AT(set), "FIELD=VALUE",
     "Change any field of the file, as inlets.feed.rate=5; may be given several times.", 0, 0,
     NULL},
    {"print", CLI_FLAG, AT(print), NULL,
     "Print the scene as it would be run, with units and comments, and stop.", 0, 0, NULL},
    {"template", CLI_TEXT, AT(template_name), "NAME",
     "A built-in scene in place of a file: hopper, drum, tilting-box, drawdown, hollow-cylinder, "
     "conveyor, vibrating-screen, shear-box, drum-lifters, paddle-mixer, tumbler, hammer-mill, "
     "transfer-chute, belt, auger or hole-screen. Without -o, --set, --print and --json it is "
     "printed with its comments, to start from.",
     0, 0, NULL},
    {"resume", CLI_FLAG, AT(resume), NULL,
     "Go on from the checkpoint in DIR where there is one; without a file, with what is in it.", 0,
     0, NULL},
    {"change", CLI_TEXTS, AT(change), "FIELD=VALUE|FILE",
     "With --resume: go on with another value, as geometry.drum.motion.0.rotate.speed=3, or with "
     "all of a file that has such fields; may be given several times. What may change: motions, "
     "friction, gravity, inlets, outlets, sensors, times.",
     0, 0, NULL},
    {"force", CLI_FLAG, AT(overwrite), NULL,
     "Begin anew in a folder with an earlier scene, whose files go.", 0, 0, NULL},
    {"json", CLI_FLAG, AT(json), NULL, "Print result.json instead of text.", 0, 0, NULL},
    {"no-picture", CLI_FLAG, AT(no_picture), NULL, "Do not render scene.png.", 0, 0, NULL},
    {"rays", CLI_COUNT, AT(rays), "N", "Rays a pixel of scene.png. Default: 24.", 1, 65536, NULL},
};
#undef AT

static scree_status simulate(cli_scene_run *r, scree_error *error) {
  SCREE_TRY(r->output ? cli_check_scene_output(r, error) : SCREE_OK);
  if (r->output && r->overwrite && !r->resume)
    SCREE_TRY(cli_clear_scene_output(r->call, r->output, error));
  SCREE_TRY(cli_run_scene(r, error));
  char shown[CLI_PRINTABLE_BYTES];
  if (r->output && !r->json)
    printf("  look at           %s/report.html\n", cli_printable(r->output, shown));
  else if (!r->json)
    puts("  Nothing was kept: -o DIR writes states, tables and a report.");
  return SCREE_OK;
}

/* ---- the call ---- */

/* A template by itself is text to start from; with where to write or what to change it is run. */
static bool prints_template(const run_arguments *a) {
  return a->template_name && !a->output && !a->set.count && !a->print && !a->json;
}

static int check_call(const cli_call *call) {
  const run_arguments *a = call->options;
  bool scene = call->input_count || a->template_name;
  if (call->input_count && a->template_name)
    return cli_misuse(call->verb, "--template takes no file");
  if (!scene && !(a->resume && a->output))
    return cli_misuse(call->verb, "needs a SCENE.yaml, or --resume with -o DIR; --template NAME "
                                  "prints one to start from");
  if (!scene && (a->set.count || a->print))
    return cli_misuse(call->verb,
                      "--set and --print need a SCENE.yaml; --change changes the scene that the "
                      "folder has");
  if (a->change.count && (!a->resume || scene))
    return cli_misuse(call->verb, "--change needs --resume, and no SCENE.yaml: it changes the "
                                  "scene that the folder has");
  if (a->resume && !a->output) return cli_misuse(call->verb, "--resume needs -o DIR");
  return 0;
}

static int run(const cli_call *call) {
  const run_arguments *a = call->options;
  cli_scene_run r = {.call = call,
                     .start = scree_work_started(),
                     .file_name = call->input_count ? call->inputs[0] : NULL,
                     .output = a->output,
                     .rays = a->rays,
                     .views = CLI_BODIES | CLI_GEOMETRY,
                     .resume = a->resume,
                     .changes = a->change.items,
                     .change_count = a->change.count,
                     .overwrite = a->overwrite,
                     .json = a->json,
                     .no_picture = a->no_picture};
  scree_error error;
  int code = check_call(call);
  if (code) return code;
  scree_status status = SCREE_OK;
  if (a->template_name)
    status = scree_scene_file_template(a->template_name, &r.file, &error);
  else if (call->input_count)
    status = scree_scene_file_read(call->inputs[0], &r.file, &error);
  if (status != SCREE_OK && a->template_name)
    return cli_misuse(call->verb, "--template: %s", error.message);
  if (status == SCREE_OK && prints_template(a)) {
    scree_scene_file_free(r.file);
    return fputs(scree_scene_template(a->template_name), stdout) < 0;
  }
  if (status == SCREE_OK && r.file) code = cli_set_fields(call, r.file, NULL, NULL, 0, &a->set);
  if (status == SCREE_OK && r.file && code == 0) status = scree_scene_file_check(r.file, &error);
  if (code) {
    scree_scene_file_free(r.file);
    return code;
  }
  if (status == SCREE_OK && a->print)
    status = scree_scene_file_print(r.file, stdout, &error);
  else if (status == SCREE_OK)
    status = simulate(&r, &error);
  cli_scene_run_free(&r);
  scree_scene_file_free(r.file);
  return status == SCREE_OK ? 0 : cli_fail(&error);
}

const cli_verb cli_verb_run = {
    .name = "run",
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
    .partners = "rays:output no-picture:output force:output",
    .run = run,
};
