/* scree repose: the angle-of-repose experiment. */
#include "base/file.h"
#include "base/platform.h"
#include "cli/grains.h"
#include "cli/heap.h"
#include "cli/output.h"
#include "cli/terminal.h"
#include "report/provenance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Every field of the experiment as an option: X(option, field, kind, VALUE, help). */
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

enum { VTP_UNSET = -1, VTP_NONE, VTP_ALL = SCREE_VIEW_COUNT + 1 };

typedef struct repose_arguments {
  const char *config, *preset, *output, *rp;
  const char *settings[SETTING_COUNT];
  cli_source source;
  int method, view;
  bool samples, spheres, no_repair, resume, force, print, json, no_picture;
} repose_arguments;

static const repose_arguments defaults = {
    .preset = "demo", .source = CLI_SOURCE_DEFAULTS, .view = VTP_UNSET};

#define AT(field) offsetof(repose_arguments, field)
static const cli_option options[] = {
    {"config", CLI_FILE, AT(config), "FILE",
     "An experiment in YAML, as --print writes it; - is stdin.", 0, 0, NULL},
    {"preset", CLI_TEXT, AT(preset), "NAME",
     "What the file and the options change: paper, small or demo (the default).", 0, 0, NULL},
    {"output", CLI_TEXT, AT(output), "DIR",
     "A folder, made if need be, for checkpoints, frames, result.json, series.csv, "
     "experiment.yaml, heap.png and report.html; with several runs, a folder in it for each, and "
     "one report.html.",
     0, 0, NULL},
    {"print", CLI_FLAG, AT(print), NULL,
     "Print the experiment as it would be run, with units and comments, and stop.", 0, 0, NULL},
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
    {"no-picture", CLI_FLAG, AT(no_picture), NULL, "Do not write heap.png.", 0, 0, NULL},
    {"unit", CLI_UNIT, AT(source.unit), "UNIT", "The files' unit of length. Default: mm.", 0, 0,
     NULL},
    CLI_SAMPLE_OPTIONS(repose_arguments, source),
#define OPTION(id, option, field, kind, value, help)                                               \
  {option, kind, AT(settings) + SETTING_##id * sizeof(const char *), value, help, 0, 0, NULL},
    SETTINGS(OPTION)
#undef OPTION
};
#undef AT

/* One call: its experiment and its runs. */
typedef struct repose {
  const cli_call *call;
  const repose_arguments *arguments;
  scree_work_start start;
  scree_experiment experiment;
  cli_grain_options grain_options;
  cli_grains grains;
  scree_run **runs; /* of each level, once done */
  scree_run_result *results;
  scree_error error;
} repose;

/* ---- the experiment ---- */

/* What the file and the options change: a preset; where a call without shapes names none, what is
 * in the checkpoint. 0, or the exit code after saying why. */
static int read_base(repose *r, bool alone) {
  const repose_arguments *a = r->arguments;
  char path[4200];
  scree_run *run;
  snprintf(path, sizeof path, "%.4100s/checkpoint.scree", alone ? a->output : "");
  if (!alone || a->preset != defaults.preset || !scree_path_exists(path)) {
    if (scree_experiment_preset(a->preset, &r->experiment, &r->error) == SCREE_OK) return 0;
    return cli_misuse(r->call->verb, "--preset %s: must be paper, small or demo", a->preset);
  }
  if (scree_run_load(path, &run, &r->error) != SCREE_OK) return cli_fail(&r->error);
  scree_status status = scree_experiment_copy(scree_run_experiment(run), &r->experiment, &r->error);
  scree_run_free(run);
  return status == SCREE_OK ? 0 : cli_fail(&r->error);
}

static int read_experiment(repose *r, bool alone) {
  const repose_arguments *a = r->arguments;
  int code = read_base(r, alone);
  if (code) return code;
  if (a->config && scree_experiment_read(a->config, &r->experiment, &r->error) != SCREE_OK)
    return cli_fail(&r->error);
  for (int i = 0; i < SETTING_COUNT; i++) {
    char number[CLI_NUMBER_BYTES];
    if (!a->settings[i]) continue;
    const char *text = cli_si_text(settings[i].kind, a->settings[i], number);
    if (scree_experiment_set(&r->experiment, settings[i].field, text, &r->error) != SCREE_OK)
      return cli_misuse(r->call->verb, "--%s: %s", settings[i].option, r->error.message);
  }
  return scree_experiment_check(&r->experiment, &r->error) == SCREE_OK ? 0 : cli_fail(&r->error);
}

/* ---- one run ---- */

typedef struct one_run {
  repose *all;
  bool alone; /* no shapes were given: the checkpoint has them */
  char name[32], folder[4096];
} one_run;

static bool watch(void *context, const scree_run_state *state) {
  (void)context;
  char left[32], line[160];
  cli_terminal_seconds(left, sizeof left, state->seconds_left);
  snprintf(line, sizeof line, "%s %.2f s  %.0f %%  %zu in  %.0f steps/s  %.2g J  %s left",
           scree_phase_name(state->now.phase), state->now.time, 100 * state->fraction,
           state->now.body_count, isnan(state->steps_per_second) ? 0 : state->steps_per_second,
           state->now.kinetic, left);
  cli_terminal_line(line);
  return !cli_interrupted();
}

static scree_status write_views(const one_run *o, scree_run *run, const char *stem,
                                scree_error *error) {
  int vtp =
      o->all->arguments->view == VTP_UNSET ? 1 + SCREE_VIEW_SURFACES : o->all->arguments->view;
  for (int view = 0; view < SCREE_VIEW_COUNT; view++) {
    char path[4200];
    if (vtp != VTP_ALL && vtp != view + 1) continue;
    snprintf(path, sizeof path, "%s/%s-%s.vtp", o->folder, stem,
             scree_world_view_name((scree_world_view)view));
    scree_status status =
        scree_world_vtp_write(scree_run_world(run), (scree_world_view)view, path, true, error);
    if (status != SCREE_OK) return status;
  }
  return SCREE_OK;
}

static scree_status on_frame(void *context, scree_run *run, size_t index, scree_error *error) {
  one_run *o = context;
  char stem[32];
  if (!o->folder[0]) return SCREE_OK;
  snprintf(stem, sizeof stem, "frame-%04zu", index);
  return write_views(o, run, stem, error);
}

/* experiment.yaml: what is run. */
static scree_status write_experiment(const one_run *o, scree_error *error) {
  const repose_arguments *a = o->all->arguments;
  char path[4200], checkpoint[4200];
  scree_output output;
  snprintf(path, sizeof path, "%s/experiment.yaml", o->folder);
  snprintf(checkpoint, sizeof checkpoint, "%s/checkpoint.scree", o->folder);
  /* a run that goes on, or is refused as another one's, keeps the text it began with */
  if (a->resume && scree_path_exists(path) && scree_path_exists(checkpoint)) return SCREE_OK;
  scree_status status = scree_output_open(path, a->force || a->resume, &output, error);
  if (status != SCREE_OK) return status;
  scree_experiment_print(&o->all->experiment, output.stream);
  return scree_output_commit(&output, error);
}

/* The collection of the frames, for each view that was written. */
static scree_status write_collections(const one_run *o, const scree_run *run, scree_error *error) {
  double interval = scree_run_experiment(run)->frame_interval;
  scree_run_costs costs;
  scree_run_get_costs(run, &costs);
  size_t count = 0;
  scree_status status = SCREE_OK;
  int vtp =
      o->all->arguments->view == VTP_UNSET ? 1 + SCREE_VIEW_SURFACES : o->all->arguments->view;
  if (!(interval > 0) || vtp == VTP_NONE) return SCREE_OK;
  while ((double)count * interval <= scree_world_time(scree_run_view(run))) count++;
  if (count == 0) return SCREE_OK;
  double *times = malloc(count * sizeof *times);
  const char **files = malloc(count * sizeof *files);
  char(*names)[48] = malloc(count * sizeof *names);
  if (!times || !files || !names) {
    *error = (scree_error){SCREE_OUT_OF_MEMORY, "out of memory for the list of frames"};
    status = error->status;
  }
  for (int view = 0; status == SCREE_OK && view < SCREE_VIEW_COUNT; view++) {
    char path[4200];
    if (vtp != VTP_ALL && vtp != view + 1) continue;
    const char *kind = scree_world_view_name((scree_world_view)view);
    for (size_t i = 0; i < count; i++) {
      times[i] = (double)i * interval;
      snprintf(names[i], sizeof *names, "frame-%04zu-%s.vtp", i, kind);
      files[i] = names[i];
    }
    snprintf(path, sizeof path, "%s/%s.vtp.series", o->folder, kind);
    status = scree_pvd_write(files, times, count, path, true, error);
  }
  free(times);
  free(files);
  free(names);
  return status;
}

static scree_status write_picture(const one_run *o, const scree_run *run, scree_error *error) {
  scree_render_options render = scree_default_render_options();
  char path[4200];
  if (o->all->arguments->no_picture) return SCREE_OK;
  render.elevation_deg = 18;
  snprintf(path, sizeof path, "%s/heap.png", o->folder);
  scree_status status = cli_write_picture(run, &render, path, true, o->all->call->progress, error);
  return status == SCREE_UNSUPPORTED ? SCREE_OK : status; /* a build without a ray tracer */
}

static void print_result(FILE *stream, const one_run *o, const scree_run *run,
                         const scree_run_result *result) {
  const scree_experiment *e = scree_run_experiment(run);
  size_t shapes = scree_run_shape_count(run);
  fprintf(stream, "%s%s%zu particle%s of %zu shape%s, seed %llu, preset %s\n",
          o->all->grains.level_count > 1 ? o->name : "", o->all->grains.level_count > 1 ? ": " : "",
          e->particle_count, cli_plural(e->particle_count), shapes, cli_plural(shapes),
          (unsigned long long)e->seed, e->preset);
  cli_print_heap(stream, run, result);
  cli_print_costs(stream, run);
}

/* result.txt: what is printed. */
static scree_status write_text_result(const one_run *o, const scree_run *run,
                                      const scree_run_result *result, scree_error *error) {
  char path[4200];
  scree_output output;
  snprintf(path, sizeof path, "%s/result.txt", o->folder);
  scree_status status = scree_output_open(path, true, &output, error);
  if (status != SCREE_OK) return status;
  print_result(output.stream, o, run, result);
  return scree_output_commit(&output, error);
}

/* What is made of the other files, so the last. */
static scree_status write_page(const one_run *o, scree_error *error) {
  char path[4200];
  const char *folder = o->folder;
  snprintf(path, sizeof path, "%s/provenance.json", folder);
  scree_status status =
      scree_provenance_write(&o->all->start, o->all->call->command_line, path, true, error);
  snprintf(path, sizeof path, "%s/report.html", folder);
  bool common = o->all->grains.level_count > 1; /* one page of all levels, at the end */
  return status == SCREE_OK && !common ? scree_page_write(&folder, 1, path, true, error) : status;
}

static scree_status write_results(const one_run *o, scree_run *run, const scree_run_result *result,
                                  scree_error *error) {
  scree_heap_entry entry = {
      .run = run, .result = result, .command_line = o->all->call->command_line};
  char path[4200];
  if (o->all->arguments->json) {
    scree_status status = scree_heap_json_write(&entry, "-", true, error);
    if (status != SCREE_OK) return status;
  }
  if (!o->folder[0]) return SCREE_OK;
  snprintf(path, sizeof path, "%s/result.json", o->folder);
  scree_status status = scree_heap_json_write(&entry, path, true, error);
  snprintf(path, sizeof path, "%s/series.csv", o->folder);
  if (status == SCREE_OK) status = scree_series_csv_write(run, path, true, error);
  if (status == SCREE_OK) status = write_collections(o, run, error);
  if (status == SCREE_OK && o->all->arguments->view > VTP_NONE)
    status = write_views(o, run, "last", error);
  if (status == SCREE_OK) status = write_picture(o, run, error);
  if (status == SCREE_OK) status = write_text_result(o, run, result, error);
  return status == SCREE_OK ? write_page(o, error) : status;
}

/* The run of a level: its name and folder. */
static one_run level_run(repose *r, size_t level) {
  one_run o = {.all = r};
  const char *output = r->arguments->output;
  cli_level_name(&r->grain_options, level, o.name, sizeof o.name);
  if (output && cli_level_count(&r->grain_options) > 1)
    snprintf(o.folder, sizeof o.folder, "%s/%s", output, o.name);
  else if (output)
    snprintf(o.folder, sizeof o.folder, "%s", output);
  return o;
}

static const char *const file_names[] = {
    "experiment.yaml",      "checkpoint.scree",   "last.scree",
    "stopped.scree",        "motion.scree",       "result.json",
    "result.txt",           "series.csv",         "heap.png",
    "provenance.json",      "report.html",        "frame-#.scree",
#define VIEW_NAMES(view) "frame-#-" view ".vtp", "last-" view ".vtp", view ".vtp.series"
    VIEW_NAMES("surfaces"), VIEW_NAMES("points"), VIEW_NAMES("contacts"),
    VIEW_NAMES("walls")
#undef VIEW_NAMES
};
static const cli_run_files run_files = {file_names, sizeof file_names / sizeof *file_names};

static scree_status check_folder(repose *r, const char *folder) {
  const repose_arguments *a = r->arguments;
  scree_status status = cli_make_folder(folder, &r->error);
  if (status == SCREE_OK && !a->resume)
    status = cli_check_run_output(r->call, folder, &run_files, a->force, &r->error);
  return status;
}

/* Whether the folders can be written to, before scans are read and decimated. */
static scree_status check_folders(repose *r) {
  const repose_arguments *a = r->arguments;
  size_t levels = cli_level_count(&r->grain_options);
  char path[4200];
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < levels; i++) {
    one_run o = level_run(r, i);
    status = check_folder(r, o.folder);
  }
  if (status != SCREE_OK || levels < 2 || a->resume) return status;
  snprintf(path, sizeof path, "%.4100s/report.html", a->output);
  return cli_check_output(r->call, path, a->force, &r->error);
}

/* Refuses what a run that begins would refuse, before anything is written. */
static scree_status check_runs(repose *r) {
  char checkpoint[4200];
  scree_status status = SCREE_OK;
  for (size_t level = 0; level < r->grains.level_count && status == SCREE_OK; level++) {
    one_run o = level_run(r, level);
    scree_run *run;
    snprintf(checkpoint, sizeof checkpoint, "%s/checkpoint.scree", o.folder);
    if (r->arguments->resume && scree_path_exists(checkpoint)) continue;
    status = scree_run_create(&r->experiment, r->grains.shapes + level * r->grains.shape_count,
                              r->grains.shape_count, &run, &r->error);
    if (status == SCREE_OK) scree_run_free(run);
  }
  return status;
}

/* Whether runs of several levels have folders called so. */
static bool is_level_name(const char *name) {
  double rp;
  return !strcmp(name, "spheres") || !strcmp(name, "recommended") ||
         (!strncmp(name, "rp-", 3) && cli_real_from_text(name + 3, &rp)) ||
         (!strncmp(name, "clump-", 6) && cli_real_from_text(name + 6, &rp));
}

/* What an earlier run left, of one level or of several: a page of the folder would show it. */
static scree_status clear_folders(repose *r) {
  const char *output = r->arguments->output;
  char path[4200];
  scree_status status = cli_clear_run_output(r->call, output, &run_files, &r->error);
  scree_folder *entries = status == SCREE_OK ? scree_folder_open(output) : NULL;
  for (const char *name; status == SCREE_OK && entries && (name = scree_folder_next(entries));) {
    scree_path_info info;
    snprintf(path, sizeof path, "%.3900s/%.255s", output, name);
    if (is_level_name(name) && scree_path_look(path, &info) && info.kind == SCREE_PATH_FOLDER)
      status = cli_clear_run_output(r->call, path, &run_files, &r->error);
  }
  if (entries) scree_folder_close(entries);
  return status;
}

static scree_status run_level(repose *r, size_t level, bool alone) {
  one_run o = level_run(r, level);
  const repose_arguments *a = r->arguments;
  o.alone = alone;
  scree_run_job job = {.experiment = &r->experiment,
                       .shapes = alone ? NULL : r->grains.shapes + level * r->grains.shape_count,
                       .shape_count = r->grains.shape_count,
                       .folder = a->output ? o.folder : NULL,
                       .motion = true,
                       .resume = a->resume,
                       .overwrite = a->force,
                       .watch = watch,
                       .frame = on_frame,
                       .context = &o};
  scree_status status = SCREE_OK;
  if (a->output && !alone) status = write_experiment(&o, &r->error);
  if (status == SCREE_OK) status = scree_run_complete(&job, &r->runs[level], &r->error);
  cli_terminal_end();
  if (status != SCREE_OK) return status;
  status = scree_run_measure(r->runs[level], &r->results[level], &r->error);
  if (status == SCREE_OK) status = write_results(&o, r->runs[level], &r->results[level], &r->error);
  cli_terminal_end();
  if (status == SCREE_OK && !a->json) {
    char shown[2][CLI_PRINTABLE_BYTES];
    print_result(stdout, &o, r->runs[level], &r->results[level]);
    if (o.folder[0])
      printf("  look at           %s/report.html; result.json and series.csv lie in %s\n",
             cli_printable(a->output, shown[0]), cli_printable(o.folder, shown[1]));
    cli_flush();
  }
  return status;
}

/* ---- all runs ---- */

static void print_table(const repose *r) {
  printf("\n%-12s %10s %8s %8s %8s %8s %8s %8s\n", "run", "triangles", "sectors", "cone", "outline",
         "height", "neighb.", "time");
  for (size_t level = 0; level < r->grains.level_count; level++) {
    const scree_repose *h = &r->results[level].repose;
    char name[32];
    double triangles = 0;
    scree_run_costs costs;
    cli_level_name(&r->grain_options, level, name, sizeof name);
    for (size_t i = 0; i < r->grains.shape_count; i++)
      triangles += (double)r->grains.grains[level * r->grains.shape_count + i].triangle_count;
    scree_run_get_costs(r->runs[level], &costs);
    printf("%-12s %10.0f", name, triangles / (double)r->grains.shape_count);
    if (h->heap)
      printf(" %4.1f deg %4.1f deg %4.1f deg", h->sector_deg, h->cone_deg, h->silhouette_deg);
    else
      printf(" %26s", "no heap");
    printf(" %5.0f mm %8.2f %6.0f s\n", 1e3 * h->height, r->results[level].coordination,
           costs.wall_seconds);
  }
}

/* Of all levels, the one report. */
static scree_status write_common_page(repose *r) {
  const char *folder = r->arguments->output;
  char path[4200];
  snprintf(path, sizeof path, "%.4100s/report.html", folder);
  return scree_page_write(&folder, 1, path, true, &r->error);
}

/* All that can be refused, before anything is written; then the folders are as a run begins. */
static scree_status prepare(repose *r, const char *const *words, size_t word_count) {
  const repose_arguments *a = r->arguments;
  scree_status status = a->output ? check_folders(r) : SCREE_OK;
  if (status == SCREE_OK)
    status = cli_make_grains(words, word_count, &r->grain_options, r->call->progress, &r->grains,
                             &r->error);
  cli_terminal_end();
  if (status == SCREE_OK && a->output) status = check_runs(r);
  if (status == SCREE_OK && a->output && a->force && !a->resume) status = clear_folders(r);
  return status;
}

static scree_status run_all(repose *r, const char *const *words, size_t word_count) {
  bool alone = word_count == 0;
  scree_status status = SCREE_OK;
  if (alone)
    r->grains.level_count = 1;
  else
    status = prepare(r, words, word_count);
  size_t levels = r->grains.level_count;
  if (status != SCREE_OK) return status;
  r->runs = calloc(levels, sizeof *r->runs);
  r->results = calloc(levels, sizeof *r->results);
  if (!r->runs || !r->results) {
    r->error = (scree_error){SCREE_OUT_OF_MEMORY, "out of memory"};
    return SCREE_OUT_OF_MEMORY;
  }
  for (size_t level = 0; status == SCREE_OK && level < levels; level++)
    status = run_level(r, level, alone);
  if (status == SCREE_OK && levels > 1 && !r->arguments->json) print_table(r);
  return status == SCREE_OK && levels > 1 && r->arguments->output ? write_common_page(r) : status;
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
  if (word_count == 0 && !(a->resume && a->output))
    return cli_misuse(r->call->verb, "needs a SHAPE, or --samples, or --resume with -o DIR");
  if (word_count == 0 && shape_option(a))
    return cli_misuse(r->call->verb, "--%s does nothing without a SHAPE", shape_option(a));
  if (a->resume && !a->output) return cli_misuse(r->call->verb, "--resume needs -o DIR");
  if (a->rp && !cli_parse_levels(a->rp, &r->grain_options))
    return cli_misuse(
        r->call->verb,
        "--rp %s: must be up to %d different numbers in (0, 1], recommended, or clumps of 1 to "
        "300 spheres, as 1e-4,recommended,clump:20",
        a->rp, CLI_MOST_LEVELS);
  return 0;
}

static int run(const cli_call *call) {
  const repose_arguments *a = call->options;
  static char sample_words[SCREE_SAMPLE_DEVICES][32];
  repose r = {.call = call,
              .arguments = a,
              .start = scree_work_started(),
              .grain_options = {.source = a->source,
                                .method = a->method,
                                .no_repair = a->no_repair,
                                .quiet = call->quiet,
                                .spheres = a->spheres}};
  size_t samples = a->samples ? SCREE_SAMPLE_DEVICES : 0, count = samples + call->input_count;
  const char **words = malloc((count + 1) * sizeof *words);
  int code = words ? read_experiment(&r, count == 0 && a->resume && a->output) : 1;
  if (code == 0 && a->print) {
    scree_experiment_print(&r.experiment, stdout);
    goto done;
  }
  if (code == 0) code = check_words(&r, count);
  if (code) goto done;
  for (size_t i = 0; i < samples; i++) {
    snprintf(sample_words[i], sizeof sample_words[i], "sample:%s", scree_sample_name(i));
    words[i] = sample_words[i];
  }
  for (size_t i = 0; i < call->input_count; i++) words[samples + i] = call->inputs[i];
  r.grain_options.mass_rule = r.experiment.mass_rule;
  if (run_all(&r, words, count) != SCREE_OK) {
    code = cli_fail(&r.error);
    if (r.error.status == SCREE_CANCELLED && a->output)
      fputs("scree: the same call with --resume goes on from there\n", stderr);
  }
done:
  for (size_t i = 0; r.runs && i < r.grains.level_count; i++) scree_run_free(r.runs[i]);
  free(r.runs);
  free(r.results);
  cli_grains_free(&r.grains);
  scree_experiment_free(&r.experiment);
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
        "in about a minute and no number should be taken from it. Everything can be changed by a "
        "YAML file and by options, which have the last word. With -o the run writes checkpoints: "
        "after Ctrl-C, or a crash, --resume goes on with the same bits. The same seed gives the "
        "same heap on any number of threads. \"No heap\" is a result: spheres give it.",
    .examples = "scree repose phone_762.stl -o heap\n"
                "scree repose --samples --rp 1e-4,1e-3 --spheres -p small -o levels\n"
                "scree repose --resume -o heap\n"
                "scree repose -p paper --friction 0.4 --print > experiment.yaml\n"
                "scree repose -c experiment.yaml --samples --rp 1e-3 -o night\n",
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
