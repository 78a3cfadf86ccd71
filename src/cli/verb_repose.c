/* scree repose: the scene of the template of that name, with shapes of the call. */
#include "base/platform.h"
#include "cli/output.h"
#include "cli/scene_run.h"
#include "cli/terminal.h"

#include <stdlib.h>
#include <string.h>

/* Options and the template's parameters that they set: X(option, parameter, kind, VALUE, help).
 * What has no option is set by its field, with --set. */
#define SETTINGS(X)                                                                                \
  X(PARTICLES, "particles", "particles", CLI_TEXT, "N",                                            \
    "How many particles, in equal shares of the shapes.")                                          \
  X(SEED, "seed", "seed", CLI_TEXT, "N", "Of positions, orientations and order.")                  \
  X(DENSITY, "density", "density", CLI_TEXT, "KG/M3", "Of the particles.")                         \
  X(MASS_FROM, "mass-from", "mass_from", CLI_TEXT, "WHAT",                                         \
    "mesh: mass by each decimated mesh's own volume, as a simulator that reads the mesh has it; "  \
    "scan: by the scan's at every level.")                                                         \
  X(CYLINDER, "cylinder", "cylinder.diameter", CLI_LENGTH_TEXT, "LENGTH",                          \
    "Inner diameter of the cylinder.")                                                             \
  X(DISC, "disc", "disc.diameter", CLI_LENGTH_TEXT, "LENGTH", "Diameter of the bottom disc.")      \
  X(PACK_TIME, "pack-time", "phases.pack_time", CLI_TEXT, "S",                                     \
    "While the particles are filled in.")                                                          \
  X(SETTLE_TIME, "settle-time", "phases.settle_time", CLI_TEXT, "S", "While they come to rest.")   \
  X(LIFT_SPEED, "lift-speed", "phases.lift_speed", CLI_TEXT, "M/S", "Of the cylinder.")            \
  X(LIFT_TIME, "lift-time", "phases.lift_time", CLI_TEXT, "S", "How long it rises.")               \
  X(HOLD_TIME, "hold-time", "phases.hold_time", CLI_TEXT, "S",                                     \
    "After the lift, at most, until still.")                                                       \
  X(STOP_WHEN_STILL, "stop-when-still", "phases.stop_when_still", CLI_TEXT, "BOOL",                \
    "true: phases end early when still.")                                                          \
  X(STILL_ENERGY, "still", "phases.still_energy", CLI_TEXT, "J",                                   \
    "Kinetic energy a particle: less is still.")                                                   \
  X(INLET, "inlet", "phases.inlet", CLI_TEXT, "WHERE",                                             \
    "top: particles fall from above where the packed heap will end; heap: from near the heap.")    \
  X(DROP_HEIGHT, "drop-height", "phases.drop_height", CLI_LENGTH_TEXT, "LENGTH",                   \
    "From the heap's top to the inlet, at least.")                                                 \
  X(YOUNG, "young", "contact.young_particle", CLI_TEXT, "PA", "Young's modulus of the particles.") \
  X(YOUNG_WALL, "young-wall", "contact.young_wall", CLI_TEXT, "PA",                                \
    "Young's modulus of the walls.")                                                               \
  X(RESTITUTION, "restitution", "contact.restitution", CLI_TEXT, "E", "Of every contact.")         \
  X(FRICTION, "friction", "contact.friction_particle", CLI_TEXT, "MU", "Particle on particle.")    \
  X(FRICTION_WALL, "friction-wall", "contact.friction_wall", CLI_TEXT, "MU", "Particle on wall.")  \
  X(LAW, "law", "contact.law", CLI_TEXT, "NAME", "linear or hysteretic.")                          \
  X(STEPS, "steps", "contact.steps", CLI_TEXT, "N",                                                \
    "Time steps in a quarter of a contact's period, at least 15.")                                 \
  X(STIFFNESS, "stiffness", "contact.stiffness_factor", CLI_TEXT, "F",                             \
    "Multiplies every stiffness; 0.2 is 2.2 times faster, with overlaps 5 times deeper.")          \
  X(GRAVITY, "gravity", "gravity", CLI_TEXT, "M/S2", "Downwards.")                                 \
  X(FRAMES, "frames", "output.frame_interval", CLI_TEXT, "S",                                      \
    "Simulated time between frames; 0: only the last.")                                            \
  X(CHECKPOINT, "checkpoint", "output.checkpoint_interval", CLI_TEXT, "S",                         \
    "Clock time between checkpoints.")                                                             \
  X(SERIES, "series", "output.series_interval", CLI_TEXT, "S",                                     \
    "Simulated time between points of the series.")                                                \
  X(ANGLES, "angles", "output.angle_interval", CLI_TEXT, "S", "And between those with angles.")    \
  X(CELL, "cell", "measure.cell", CLI_LENGTH_TEXT, "LENGTH",                                       \
    "Of the height field; 0: a tenth of the particle size.")                                       \
  X(SECTORS, "sectors", "measure.sectors", CLI_TEXT, "N", "Azimuth sectors.")                      \
  X(BAND_LOW, "band-low", "measure.band_low", CLI_SHARE_TEXT, "SHARE",                             \
    "The flank begins at this share of the height.")                                               \
  X(BAND_HIGH, "band-high", "measure.band_high", CLI_SHARE_TEXT, "SHARE", "And ends at this one.")

enum {
#define PLACE(id, option, field, kind, value, help) SETTING_##id,
  SETTINGS(PLACE)
#undef PLACE
      SETTING_COUNT
};

static const struct {
  const char *option, *field;
  cli_kind kind;
} settings[] = {
#define NAMES(id, option, field, kind, value, help) {option, field, kind},
    SETTINGS(NAMES)
#undef NAMES
};

enum { VIEW_UNSET = -1, VIEW_NONE, VIEW_ALL = CLI_FRAME_KINDS + 1 };

typedef struct repose_arguments {
  const char *config, *preset, *output, *rp;
  const char *settings[SETTING_COUNT];
  cli_source source;
  cli_texts set;
  int method, view;
  bool samples, spheres, no_repair, resume, force, print, json, no_picture;
} repose_arguments;

static const repose_arguments defaults = {
    .preset = "demo", .source = CLI_SOURCE_DEFAULTS, .view = VIEW_UNSET};

#define AT(field) offsetof(repose_arguments, field)
static const cli_option options[] = {
    {"config", CLI_FILE, AT(config), "FILE",
     "A scene in YAML, as --print writes it, or values of its parameters; - is stdin.", 0, 0, NULL},
    {"set", CLI_TEXTS, AT(set), "FIELD=VALUE",
     "Change any field of the scene, as gravity.0=1; may be given several times.", 0, 0, NULL},
    {"preset", CLI_TEXT, AT(preset), "NAME",
     "What the file and the options change: paper, small or demo (the default).", 0, 0, NULL},
    {"output", CLI_TEXT, AT(output), "DIR",
     "A folder, made if need be, for checkpoints, frames, result.json, series.csv, scene.yaml, "
     "scene.png and report.html; with several runs, a folder in it for each, and one report.html.",
     0, 0, NULL},
    {"print", CLI_FLAG, AT(print), NULL,
     "Print the scene as it would be run, with units and comments, and stop.", 0, 0, NULL},
    {"samples", CLI_FLAG, AT(samples), NULL, "The nine built-in devices as shapes.", 0, 0, NULL},
    {"rp", CLI_TEXT, AT(rp), "LIST",
     "Decimate the scans first, as 1e-3, or 1e-5,recommended,1e-3 for a run at each; clump:20 is a "
     "run with clumps of 20 spheres that stand for the scans.",
     0, 0, NULL},
    {"spheres", CLI_FLAG, AT(spheres), NULL,
     "A run with spheres of the shapes' volumes: alone, or after those of --rp.", 0, 0, NULL},
    {"method", CLI_CHOICE, AT(method), "NAME",
     "How to decimate: volume (keeps the volume) or qecd (as the paper). Default: volume.", 0, 0,
     "volume|qecd"},
    {"no-repair", CLI_FLAG, AT(no_repair), NULL,
     "Refuse scans that are no closed surface instead of repairing them.", 0, 0, NULL},
    {"resume", CLI_FLAG, AT(resume), NULL,
     "Go on from the checkpoint in DIR where there is one; without SHAPE, with what is in it.", 0,
     0, NULL},
    {"force", CLI_FLAG, AT(force), NULL,
     "Begin anew in a folder with an earlier run, whose files go.", 0, 0, NULL},
    {"view", CLI_CHOICE, AT(view), "VIEW",
     "What of each frame becomes a .vtp file for ParaView. Default: surfaces.", 0, 0,
     "none|surfaces|points|contacts|walls|all"},
    {"json", CLI_FLAG, AT(json), NULL, "Print result.json instead of text.", 0, 0, NULL},
    {"no-picture", CLI_FLAG, AT(no_picture), NULL, "Do not write scene.png.", 0, 0, NULL},
    {"unit", CLI_UNIT, AT(source.unit), "UNIT", "The files' unit of length. Default: mm.", 0, 0,
     NULL},
    CLI_SAMPLE_OPTIONS(repose_arguments, source),
#define OPTION(id, option, field, kind, value, help)                                               \
  {option, kind, AT(settings) + SETTING_##id * sizeof(const char *), value, help, 0, 0, NULL},
    SETTINGS(OPTION)
#undef OPTION
};
#undef AT

/* What came of one level. */
typedef struct level_result {
  scree_pile pile;
  double triangles, coordination, seconds;
} level_result;

enum { MOST_LEVELS = 40, LEVEL_BYTES = 40 };

/* One call: its scene and its levels. */
typedef struct repose {
  const cli_call *call;
  const repose_arguments *arguments;
  scree_work_start start;
  scree_scene_file *file;
  scree_shape_store *store;
  cli_poured poured;
  char levels[MOST_LEVELS + 1][LEVEL_BYTES]; /* "": as given */
  size_t level_count;
  level_result results[MOST_LEVELS + 1];
  scree_error error;
} repose;

/* ---- levels ---- */

/* A word of --rp as a level of shapes; false where it is none, or there already. */
static bool add_level(repose *r, const char *word) {
  double value;
  char *level = r->levels[r->level_count];
  snprintf(level, LEVEL_BYTES, "%s", word);
  if (cli_fraction_from_text(word, &value)) snprintf(level, LEVEL_BYTES, "%.17g", value);
  bool good = !strcmp(level, "recommended") || !strncmp(level, "clump:", 6) ||
              cli_real_from_text(level, &value);
  for (size_t i = 0; i < r->level_count; i++) good = good && strcmp(r->levels[i], level) != 0;
  if (!good || scree_shape_level_error(level)) return false;
  r->level_count++;
  return true;
}

static bool parse_levels(repose *r, const char *text) {
  while (*text) {
    char word[LEVEL_BYTES];
    size_t length = strcspn(text, ",");
    if (length == 0 || length >= sizeof word || r->level_count == MOST_LEVELS) return false;
    snprintf(word, sizeof word, "%.*s", (int)length, text);
    if (!add_level(r, word)) return false;
    text += length;
    if (*text == ',' && !*++text) return false;
  }
  return r->level_count > 0;
}

/* For folders and tables. */
static void name_level(const repose *r, size_t index, char *name, size_t size) {
  const char *level = r->levels[index];
  double value;
  if (!*level)
    snprintf(name, size, "as-given");
  else if (cli_real_from_text(level, &value))
    snprintf(name, size, "rp-%g", value);
  else
    snprintf(name, size, "%s", level);
  for (char *c = name; *c; c++)
    if (*c == ':') *c = '-';
}

/* Whether runs of several levels have folders called so. */
static bool is_level_name(const char *name) {
  double rp;
  return !strcmp(name, "spheres") || !strcmp(name, "recommended") ||
         (!strncmp(name, "rp-", 3) && cli_real_from_text(name + 3, &rp)) ||
         (!strncmp(name, "clump-", 6) && cli_real_from_text(name + 6, &rp));
}

/* ---- the scene ---- */

/* That of the checkpoint which a call without shapes goes on from. */
static scree_status read_checkpoint(repose *r) {
  char path[4200];
  scree_scene *scene;
  snprintf(path, sizeof path, "%.4100s/checkpoint.scree", r->arguments->output);
  scree_status status = scree_scene_load(path, &scene, &r->error);
  if (status != SCREE_OK) return status;
  const char *text = scree_scene_text(scene);
  status = scree_scene_file_parse(text, strlen(text), path, &r->file, &r->error);
  scree_scene_free(scene);
  return status;
}

static int read_base(repose *r, bool alone) {
  const repose_arguments *a = r->arguments;
  char path[4200];
  snprintf(path, sizeof path, "%.4100s/checkpoint.scree", alone ? a->output : "");
  bool found = alone && !a->config && a->preset == defaults.preset && scree_path_exists(path);
  scree_status status = SCREE_OK;
  if (found)
    status = read_checkpoint(r);
  else if (a->config)
    status = scree_scene_file_read_over(a->config, "repose", a->preset, &r->file, &r->error);
  else
    status = scree_scene_file_template("repose", &r->file, &r->error);
  if (status == SCREE_OK && !found && !a->config &&
      scree_scene_file_set(r->file, "preset", a->preset, &r->error) != SCREE_OK)
    return cli_misuse(r->call->verb, "--preset %s: must be paper, small or demo", a->preset);
  return status == SCREE_OK ? 0 : cli_fail(&r->error);
}

/* The options, of which the first that cannot be is told where all together cannot. */
static int set_options(repose *r) {
  const repose_arguments *a = r->arguments;
  char first[1200] = "";
  for (size_t i = 0; i < SETTING_COUNT + a->set.count; i++) {
    char number[CLI_NUMBER_BYTES], field[200];
    bool other = i >= SETTING_COUNT;
    const char *value = other ? a->set.items[i - SETTING_COUNT] : a->settings[i];
    if (!value) continue;
    if (other) {
      size_t length = strcspn(value, "=");
      if (length == 0 || !value[length] || length >= sizeof field)
        return cli_misuse(r->call->verb, "--set %s: must be FIELD=VALUE, as in gravity.0=1", value);
      snprintf(field, sizeof field, "%.*s", (int)length, value);
      value += length + 1;
    } else {
      snprintf(field, sizeof field, "%s", settings[i].field);
      value = cli_si_text(settings[i].kind, value, number);
    }
    scree_status status = scree_scene_file_try(r->file, field, value, &r->error);
    bool hard = status != SCREE_OK && status != SCREE_BAD_FILE;
    if (status != SCREE_OK && (!*first || hard))
      snprintf(first, sizeof first, "--%s: %.1000s", other ? "set" : settings[i].option,
               r->error.message);
    if (hard) return cli_misuse(r->call->verb, "%s", first);
  }
  if (!*first || scree_scene_file_check(r->file, NULL) == SCREE_OK) return 0;
  return cli_misuse(r->call->verb, "%s", first);
}

static int make_file(repose *r, bool alone) {
  const repose_arguments *a = r->arguments;
  int code = read_base(r, alone);
  if (code) return code;
  if (r->poured.count) {
    scree_status status = cli_pour(r->file, &r->poured, &a->source, a->no_repair, &r->error);
    if (status == SCREE_OK && a->method == SCREE_METHOD_QECD)
      status = cli_set_scans(r->file, &r->poured, "method", "qecd", &r->error);
    if (status != SCREE_OK) return cli_fail(&r->error);
  }
  return set_options(r);
}

/* The scene of a level; of clumps in tables only spheres are another. */
static scree_status set_level(repose *r, size_t index) {
  const char *level = r->levels[index];
  scree_status status = SCREE_OK;
  if (!*level || !r->poured.count) return SCREE_OK;
  status = cli_set_scans(r->file, &r->poured, "rp", level, &r->error);
  for (size_t i = 0; status == SCREE_OK && i < r->poured.count; i++) {
    char field[200];
    if (strcmp(r->poured.shapes[i].kind, "clump") != 0) continue;
    snprintf(field, sizeof field, "shapes.%s.rp", r->poured.shapes[i].name);
    status =
        scree_scene_file_set(r->file, field, strcmp(level, "spheres") ? "scan" : level, &r->error);
  }
  return status;
}

/* ---- one level ---- */

static unsigned views_of(int view) {
  switch (view) {
  case VIEW_UNSET:
    return CLI_BODIES;
  case VIEW_NONE:
    return 0;
  case VIEW_ALL:
    return CLI_BODIES | CLI_POINTS | CLI_CONTACTS | CLI_GEOMETRY;
  default:
    return 1u << (view - 1);
  }
}

static cli_scene_run run_of(repose *r, size_t level, char folder[4096]) {
  const repose_arguments *a = r->arguments;
  bool several = r->level_count > 1;
  static char names[MOST_LEVELS + 1][LEVEL_BYTES];
  name_level(r, level, names[level], LEVEL_BYTES);
  snprintf(folder, 4096, "%.4000s%s%s", a->output ? a->output : "", several ? "/" : "",
           several ? names[level] : "");
  return (cli_scene_run){.call = r->call,
                         .start = r->start,
                         .file = r->file,
                         .output = a->output ? folder : NULL,
                         .store = r->store,
                         .rays = 24,
                         .views = views_of(a->view),
                         .resume = a->resume,
                         .overwrite = a->force,
                         .json = a->json,
                         .no_picture = a->no_picture,
                         .states = true,
                         .common_page = several,
                         .name = several ? names[level] : NULL};
}

/* Refuses what a run that begins would refuse, before anything is written. */
static scree_status check_level(repose *r, size_t level) {
  char folder[4096], checkpoint[4200];
  const cli_scene_run run = run_of(r, level, folder);
  scree_scene *scene;
  snprintf(checkpoint, sizeof checkpoint, "%s/checkpoint.scree", folder);
  if (run.resume && run.output && scree_path_exists(checkpoint)) return SCREE_OK;
  scree_status status = set_level(r, level);
  if (status == SCREE_OK)
    status = scree_scene_create_from(r->file, r->store, r->call->progress, &scene, &r->error);
  if (status == SCREE_OK) scree_scene_free(scene);
  return status;
}

static double mean_triangles(const scree_scene *scene) {
  double sum = 0;
  size_t count = 0;
  for (; scree_scene_shape_name(scene, count); count++) {
    scree_particle_measures m;
    scree_particle_measure(scree_scene_shape_particle(scene, count), &m);
    sum += (double)m.triangle_count;
  }
  return sum / (double)count;
}

static scree_status run_level(repose *r, size_t level) {
  char folder[4096], shown[2][CLI_PRINTABLE_BYTES];
  cli_scene_run run = run_of(r, level, folder);
  level_result *result = &r->results[level];
  scree_observation o;
  scree_status status = set_level(r, level);
  if (status == SCREE_OK) status = cli_run_scene(&run, &r->error);
  if (status == SCREE_OK && r->level_count > 1) {
    scree_world_observe(scree_scene_view(run.scene), &o);
    result->coordination = o.coordination;
    result->seconds = scree_scene_get_costs(run.scene).wall_seconds;
    result->triangles = mean_triangles(run.scene);
    status = scree_scene_measure_pile(run.scene, 0, NULL, &result->pile, &r->error);
  }
  if (status == SCREE_OK && !run.json && run.output)
    printf("  look at           %s/report.html; result.json and series.csv lie in %s\n",
           cli_printable(r->arguments->output, shown[0]), cli_printable(folder, shown[1]));
  cli_flush();
  cli_scene_run_free(&run);
  return status;
}

/* ---- all levels ---- */

static void print_table(const repose *r) {
  printf("\n%-12s %10s %8s %8s %8s %8s %8s %8s\n", "run", "triangles", "sectors", "cone", "outline",
         "height", "neighb.", "time");
  for (size_t level = 0; level < r->level_count; level++) {
    const level_result *result = &r->results[level];
    const scree_repose *h = &result->pile.repose;
    char name[LEVEL_BYTES];
    name_level(r, level, name, sizeof name);
    printf("%-12s %10.0f", name, result->triangles);
    if (h->heap)
      printf(" %4.1f deg %4.1f deg %4.1f deg", h->sector_deg, h->cone_deg, h->silhouette_deg);
    else
      printf(" %26s", "no heap");
    printf(" %5.0f mm %8.2f %6.0f s\n", 1e3 * h->height, result->coordination, result->seconds);
  }
}

/* What an earlier call left, of one level or of several: a page of the folder would show it. */
static scree_status clear_folders(repose *r) {
  const char *output = r->arguments->output;
  char path[4200];
  scree_status status = cli_clear_scene_output(r->call, output, &r->error);
  scree_folder *entries = status == SCREE_OK ? scree_folder_open(output) : NULL;
  for (const char *name; status == SCREE_OK && entries && (name = scree_folder_next(entries));) {
    scree_path_info info;
    snprintf(path, sizeof path, "%.3900s/%.255s", output, name);
    if (is_level_name(name) && scree_path_look(path, &info) && info.kind == SCREE_PATH_FOLDER)
      status = cli_clear_scene_output(r->call, path, &r->error);
  }
  if (entries) scree_folder_close(entries);
  return status;
}

/* Whether the folders can be written to, before scans are read and decimated. */
static scree_status check_folders(repose *r) {
  const repose_arguments *a = r->arguments;
  char path[4200], folder[4096];
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < r->level_count; i++) {
    const cli_scene_run run = run_of(r, i, folder);
    status = cli_check_scene_output(&run, &r->error);
  }
  if (status != SCREE_OK || r->level_count < 2 || a->resume) return status;
  snprintf(path, sizeof path, "%.4100s/report.html", a->output);
  return cli_check_output(r->call, path, a->force, &r->error);
}

static scree_status run_all(repose *r) {
  const repose_arguments *a = r->arguments;
  scree_status status = scree_shape_store_create(&r->store, &r->error);
  if (status == SCREE_OK && a->output) status = check_folders(r);
  for (size_t i = 0; status == SCREE_OK && i < r->level_count; i++) status = check_level(r, i);
  cli_terminal_end();
  if (status == SCREE_OK && a->output && a->force && !a->resume) status = clear_folders(r);
  for (size_t i = 0; status == SCREE_OK && i < r->level_count; i++) status = run_level(r, i);
  if (status != SCREE_OK || r->level_count < 2) return status;
  if (!a->json) print_table(r);
  char path[4200];
  snprintf(path, sizeof path, "%.4100s/report.html", a->output ? a->output : "");
  return a->output ? scree_page_write(&a->output, 1, path, true, &r->error) : SCREE_OK;
}

/* An option that says how shapes are made, with another value than its default; NULL if none. */
static const char *shape_option(const repose_arguments *a) {
  return a->rp                                    ? "rp"
         : a->spheres                             ? "spheres"
         : a->no_repair                           ? "no-repair"
         : a->source.unit != defaults.source.unit ? "unit"
                                                  : NULL;
}

static int check_words(repose *r, size_t word_count) {
  const repose_arguments *a = r->arguments;
  if (word_count == 0 && !(a->resume && a->output) && !a->print)
    return cli_misuse(r->call->verb, "needs a SHAPE, or --samples, or --resume with -o DIR");
  if (word_count == 0 && shape_option(a))
    return cli_misuse(r->call->verb, "--%s does nothing without a SHAPE", shape_option(a));
  if (a->resume && !a->output) return cli_misuse(r->call->verb, "--resume needs -o DIR");
  if (a->rp && !parse_levels(r, a->rp))
    return cli_misuse(
        r->call->verb,
        "--rp %s: must be up to %d different numbers in (0, 1], recommended, or clumps of 1 to "
        "300 spheres, as 1e-4,recommended,clump:20",
        a->rp, MOST_LEVELS);
  if (a->spheres) snprintf(r->levels[r->level_count++], LEVEL_BYTES, "spheres");
  if (r->level_count == 0) r->level_count = 1;
  return 0;
}

static int run_words(repose *r, const char *const *words, size_t count) {
  const repose_arguments *a = r->arguments;
  int code = check_words(r, count);
  if (code) return code;
  if (count && cli_make_poured(words, NULL, count, &r->poured, &r->error) != SCREE_OK)
    return cli_fail(&r->error);
  code = make_file(r, count == 0 && a->resume && a->output);
  if (code) return code;
  scree_status status = a->print ? set_level(r, 0) : run_all(r);
  if (status == SCREE_OK && a->print) status = scree_scene_file_print(r->file, stdout, &r->error);
  if (status == SCREE_OK) return 0;
  code = cli_fail(&r->error);
  if (r->error.status == SCREE_CANCELLED && a->output)
    fputs("scree: the same call with --resume goes on from there\n", stderr);
  return code;
}

static int run(const cli_call *call) {
  const repose_arguments *a = call->options;
  static char sample_words[SCREE_SAMPLE_DEVICES][32];
  static repose r;
  r = (repose){.call = call, .arguments = a, .start = scree_work_started()};
  size_t samples = a->samples ? SCREE_SAMPLE_DEVICES : 0, count = samples + call->input_count;
  const char **words = malloc((count + 1) * sizeof *words);
  for (size_t i = 0; words && i < samples; i++) {
    snprintf(sample_words[i], sizeof sample_words[i], "sample:%s", scree_sample_name(i));
    words[i] = sample_words[i];
  }
  for (size_t i = 0; words && i < call->input_count; i++) words[samples + i] = call->inputs[i];
  int code = words ? run_words(&r, words, count) : 1;
  scree_shape_store_free(r.store);
  cli_poured_free(&r.poured);
  scree_scene_file_free(r.file);
  free(words);
  return code;
}

const cli_verb cli_verb_repose = {
    .name = "repose",
    .summary = "pour a heap and measure its angle of repose",
    .inputs = "SHAPE...",
    .description =
        "Runs the experiment of Katagiri and Koyanaka (2020): particles of the shapes fall into a "
        "cylinder, come to rest, the cylinder is raised, and the heap is measured three ways. A "
        "SHAPE is a scan, sample:NAME, or NAME.csv with the spheres of a clump (x, y, z, radius a "
        "line). Without --rp a scan of more than 2,000 triangles is taken at the level that choose "
        "recommends, which is said. The preset paper is the paper's protocol (1197 particles: "
        "hours); small has 360 "
        "particles and softer contacts (its heap scatters more); demo, the default, shows a heap "
        "in about a minute and no number should be taken from it. It is a scene, the template "
        "repose "
        "of `scree run`: everything can be changed by a YAML file and by options, which have the "
        "last word. With -o the run writes checkpoints: "
        "after Ctrl-C, or a crash, --resume goes on with the same bits. The same seed gives the "
        "same heap on any number of threads. \"No heap\" is a result: spheres give it.",
    .examples = "scree repose phone_762.stl -o heap\n"
                "scree repose --samples --rp 1e-4,1e-3 --spheres -p small -o levels\n"
                "scree repose --resume -o heap\n"
                "scree repose -p paper --friction 0.4 --print > mine.yaml\n"
                "scree repose -c mine.yaml --samples --rp 1e-3 -o night\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .defaults = &defaults,
    .options_size = sizeof defaults,
    .input_minimum = 0,
    .input_maximum = 60,
    .partners = "method:rp view:output resolution:sample:|samples noise:sample:|samples "
                "sample-seed:sample:|samples",
    .run = run,
};
