/* scree run: a scene of the user's own. */
#include "base/file.h"
#include "base/number.h"
#include "base/platform.h"
#include "cli/frames.h"
#include "cli/input.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/terminal.h"
#include "report/provenance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct run_arguments {
  const char *output, *template_name;
  cli_texts set;
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
     "Print a commented scene to start from: hopper, drum, tilting-box, drawdown, "
     "hollow-cylinder, conveyor, vibrating-screen or shear-box.",
     0, 0, NULL},
    {"resume", CLI_FLAG, AT(resume), NULL,
     "Go on from the checkpoint in DIR where there is one; without a file, with what is in it.", 0,
     0, NULL},
    {"force", CLI_FLAG, AT(overwrite), NULL,
     "Begin anew in a folder with an earlier scene, whose files go.", 0, 0, NULL},
    {"json", CLI_FLAG, AT(json), NULL, "Print result.json instead of text.", 0, 0, NULL},
    {"no-picture", CLI_FLAG, AT(no_picture), NULL, "Do not render scene.png.", 0, 0, NULL},
    {"rays", CLI_COUNT, AT(rays), "N", "Rays a pixel of scene.png. Default: 24.", 1, 65536, NULL},
};
#undef AT

static const char *const file_names[] = {
    "checkpoint.scree",     "series.csv",  "motion.scree", "scene.yaml",
    "frame-#-bodies.vtp",   "bodies.pvd",  "geometry.pvd", "scene.png",
    "frame-#-geometry.vtp", "result.json", "result.txt",   "stopped.scree",
    "provenance.json",      "report.html", "sensor-*.csv", "sensor-*.vts",
    "bodies.csv",           "shape-#.vtp"};
static const cli_run_files run_files = {file_names, sizeof file_names / sizeof *file_names};

enum { PATH_BYTES = 4200 };
static const char *const kinds[] = {"-bodies", "-geometry"}; /* of frames */

typedef struct scene_run {
  const cli_call *call;
  const run_arguments *arguments;
  scree_work_start start;
  scree_scene_file *file;
  scree_scene *scene; /* while it goes on: that of the job */
  cli_frames frames;
} scene_run;

/* ---- the file ---- */

static scree_status no_memory(scree_error *error) {
  *error = (scree_error){SCREE_OUT_OF_MEMORY, "out of memory"};
  return error->status;
}

static scree_status set_fields(scene_run *r, scree_error *error) {
  const cli_texts *set = &r->arguments->set;
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < set->count; i++) {
    const char *equals = strchr(set->items[i], '=');
    size_t length = (size_t)(equals - set->items[i]);
    char *field = malloc(length + 1);
    if (!field) return no_memory(error);
    memcpy(field, set->items[i], length);
    field[length] = 0;
    status = scree_scene_file_set(r->file, field, equals + 1, error);
    free(field);
  }
  return status;
}

static scree_status read_file(scene_run *r, scree_error *error) {
  if (r->call->input_count == 0) return SCREE_OK;
  scree_status status = scree_scene_file_read(r->call->inputs[0], &r->file, error);
  if (status == SCREE_OK) status = set_fields(r, error);
  return status == SCREE_OK ? scree_scene_file_check(r->file, error) : status;
}

/* ---- while it runs ---- */

static scree_status path_of(const scene_run *r, const char *name, char path[PATH_BYTES],
                            scree_error *error) {
  if (snprintf(path, PATH_BYTES, "%s/%s", r->arguments->output, name) < PATH_BYTES) return SCREE_OK;
  return cli_refuse(error, SCREE_LIMIT, r->arguments->output, "the folder's name is too long");
}

static bool watch(void *context, const scree_scene_state *state) {
  (void)context;
  char left[32], line[200];
  scree_scene_book b;
  scree_scene_get_book(state->scene, &b);
  cli_terminal_seconds(left, sizeof left, state->seconds_left);
  snprintf(line, sizeof line, "%.2f of %g s  %.0f %%  %zu in, %zu out%s  %.0f steps/s  %s left",
           state->time, scree_scene_duration(state->scene), 100 * state->fraction, b.inside_count,
           b.left_count, b.waiting_count ? ", some wait" : "",
           isnan(state->steps_per_second) ? 0 : state->steps_per_second, left);
  cli_terminal_line(line);
  return !cli_interrupted();
}

static scree_status write_collections(const scene_run *r, scree_error *error) {
  scree_status status = SCREE_OK;
  for (int walls = 0; status == SCREE_OK && walls < 2; walls++) {
    char path[PATH_BYTES];
    status = path_of(r, walls ? "geometry.pvd" : "bodies.pvd", path, error);
    if (status == SCREE_OK) status = cli_frames_list(&r->frames, kinds[walls], path, error);
  }
  return status;
}

static scree_status on_frame(void *context, scree_scene *scene, size_t index, scree_error *error) {
  scene_run *r = context;
  scree_status status = SCREE_OK;
  for (int walls = 0; status == SCREE_OK && walls < 2; walls++) {
    char name[CLI_FRAME_NAME], path[PATH_BYTES];
    cli_frame_name(r->frames.count, kinds[walls], name);
    status = path_of(r, name, path, error);
    if (status == SCREE_OK && walls)
      status = scree_scene_walls_vtp_write(scene, path, true, error);
    else if (status == SCREE_OK && scree_scene_frames_are_instances(scene))
      status = scree_scene_bodies_vtp_write(scene, path, true, error);
    else if (status == SCREE_OK)
      status =
          scree_world_vtp_write(scree_scene_view(scene), SCREE_VIEW_SURFACES, path, true, error);
  }
  (void)index;
  if (status == SCREE_OK)
    status = cli_frames_note(&r->frames, scree_world_time(scree_scene_view(scene)), error);
  return status == SCREE_OK ? write_collections(r, error) : status;
}

/* Each shape once, for frames of instances. */
static scree_status write_shapes(const scene_run *r, const scree_scene *scene, scree_error *error) {
  scree_status status = SCREE_OK;
  if (!r->arguments->output || !(scree_scene_frame_interval(scene) > 0) ||
      !scree_scene_frames_are_instances(scene))
    return SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && scree_scene_shape_name(scene, i); i++) {
    char name[32], path[PATH_BYTES];
    snprintf(name, sizeof name, "shape-%zu.vtp", i);
    status = path_of(r, name, path, error);
    if (status == SCREE_OK) status = scree_scene_shape_vtp_write(scene, i, path, true, error);
  }
  return status;
}

/* Names values of the scene that no material has, as those of options are. */
static void remark_values(const char *text) {
  char key[64];
  double value;
  for (const char *line = text; line; line = strchr(line, '\n')) {
    line += *line == '\n';
    size_t indent = strspn(line, " "), length = strcspn(line + indent, ":\n");
    const char *behind = line + indent + length, *end = behind + strcspn(behind, "\n");
    if (length >= sizeof key || end - behind < 3) continue;
    if (!scree_number_parse(behind + 2, end, &value)) continue;
    snprintf(key, sizeof key, "%.*s", (int)length, line + indent);
    const cli_meaning *m = cli_find_meaning(key);
    if (m && m->expected && (value < m->least || value > m->most))
      fprintf(stderr, "scree: %s %g: %s\n", key, value, m->expected);
  }
}

/* As of files that other verbs read: a scene's shapes are in mm where their unit is not said. */
static void remark_sizes(const scree_scene *scene) {
  for (size_t i = 0; scree_scene_shape_name(scene, i); i++) {
    scree_particle_measures m;
    const char *source = scree_scene_shape_source(scene, i);
    if (!source || !*source) continue; /* the scene says its size itself */
    scree_particle_measure(scree_scene_shape_particle(scene, i), &m);
    cli_remark_size(scree_scene_shape_name(scene, i), m.size, "unit: says which it is");
  }
}

static void print_walls(const scree_scene *scene) {
  for (size_t i = 0; scree_scene_geometry_name(scene, i); i++)
    for (const char *line = scree_scene_geometry_note(scene, i); line && *line;) {
      size_t length = strcspn(line, "\n");
      printf("  wall %-15s %.*s\n", scree_scene_geometry_name(scene, i), (int)length, line);
      line += length + (line[length] == '\n');
    }
}

static void print_forecast(const scree_scene *scene) {
  scree_scene_forecast f;
  scree_scene_foretell(scene, &f);
  printf("  %.0f steps of up to %.0f bodies: ", f.step_count, f.body_count);
  if (f.seconds < 60)
    printf("seconds");
  else if (f.seconds < 5400)
    printf("about %.0f minutes", f.seconds / 60);
  else
    printf("about %.3g hours", f.seconds / 3600);
  printf(" on one core");
  if (f.frame_count > 0)
    printf("; %.0f frames, up to %.3g MB", f.frame_count, 1e-6 * f.frame_count * f.frame_bytes);
  putchar('\n');
}

static scree_status on_begin(void *context, scree_scene *scene, bool resumed, scree_error *error) {
  scene_run *r = context;
  char reason[256], path[PATH_BYTES];
  scree_status status = SCREE_OK;
  if (resumed)
    status = cli_frames_recall(&r->frames, scree_scene_frame_interval(scene),
                               scree_scene_view(scene), error);
  r->scene = scene;
  if (status == SCREE_OK && r->arguments->output) {
    status = path_of(r, "scene.yaml", path, error);
    if (status == SCREE_OK) status = scree_text_write(scree_scene_text(scene), path, true, error);
  }
  if (status == SCREE_OK) status = write_shapes(r, scene, error);
  if (status != SCREE_OK || r->call->quiet || r->arguments->json) return status;
  cli_terminal_end();
  if (!resumed) remark_values(scree_scene_text(scene));
  if (!resumed) remark_sizes(scene);
  scree_scene_softness soft;
  char sentence[600];
  if (!resumed && scree_scene_soft(scene, &soft)) {
    scree_scene_describe_softness(scene, &soft, sentence, sizeof sentence);
    fprintf(stderr, "scree: %s\n", sentence);
  }
  char remark[SCREE_REMARK];
  for (size_t i = 0; !resumed && scree_scene_remark(scene, i, remark); i++)
    fprintf(stderr, "scree: %s\n", remark);
  if (scree_scene_title(scene)) printf("%s\n", scree_scene_title(scene));
  for (size_t i = 0; scree_scene_shape_name(scene, i); i++) {
    const char *source = scree_scene_shape_source(scene, i);
    scree_particle_measures m;
    scree_particle_measure(scree_scene_shape_particle(scene, i), &m);
    printf("  shape %-14s size %.4g mm%s%s\n", scree_scene_shape_name(scene, i), 1e3 * m.size,
           *source ? "  " : "", source);
  }
  print_walls(scene);
  printf("  time step %s\n", (scree_scene_time_step_reason(scene, reason), reason));
  print_forecast(scene);
  if (resumed) printf("  goes on at %.6g s\n", scree_world_time(scree_scene_view(scene)));
  cli_flush();
  return SCREE_OK;
}

/* ---- at its end ---- */

/* "-" where there is nothing to measure yet. */
static const char *value_text(double value, char text[32]) {
  if (isnan(value)) return "-";
  snprintf(text, 32, "%.5g", value);
  return text;
}

static void print_sensors(FILE *stream, const scree_scene *scene) {
  size_t rows, columns = scree_scene_column_count(scene), first = 0;
  const double *series = scree_scene_series(scene, &rows);
  while (first < columns && !strchr(scree_scene_column_name(scene, first), '.')) first++;
  if (!rows || first == columns) return;
  fprintf(stream, "  %-34s %14s %14s\n", "sensor", "at the end", "mean");
  for (size_t k = first; k < columns; k++) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < rows; i++)
      if (!isnan(series[i * columns + k])) sum += series[i * columns + k], count++;
    char last[32], mean[32];
    fprintf(stream, "  %-34s %14s %14s %s\n", scree_scene_column_name(scene, k),
            value_text(series[(rows - 1) * columns + k], last),
            value_text(count ? sum / (double)count : (double)NAN, mean),
            scree_scene_column_unit(scene, k));
  }
}

static void print_loss(FILE *stream, const scree_scene *scene) {
  scree_scene_loss loss;
  if (!scree_scene_loss_of(scene, &loss)) return;
  fprintf(stream, "  %zu left the domain, the first at %.4g s at (%.4g, %.4g, %.4g) m", loss.count,
          loss.first_time, loss.first_place[0], loss.first_place[1], loss.first_place[2]);
  if (!loss.is_meant)
    fprintf(stream, ": past all geometry, where no outlet was meant; give outlets or a domain if "
                    "one was, and look for a gap in the walls if not");
  putc('\n', stream);
}

static void print_summary(FILE *stream, const scree_scene *scene, const char *stopped) {
  scree_scene_book b;
  scree_scene_get_book(scene, &b);
  fprintf(stream, "%s after %.6g s, %llu steps\n", stopped ? "stopped" : scree_scene_end(scene),
          scree_world_time(scree_scene_view(scene)),
          (unsigned long long)scree_world_step_count(scree_scene_view(scene)));
  fprintf(stream,
          "  %zu came in, %zu are inside, %zu went out: %.5g kg in, %.5g kg inside, %.5g kg out\n",
          b.entered_count, b.inside_count, b.left_count, b.entered_mass, b.inside_mass,
          b.left_mass);
  for (size_t i = 0; scree_scene_inlet_name(scene, i); i++) {
    size_t waiting;
    scree_scene_inlet_count(scene, i, NULL, &waiting);
    if (waiting)
      fprintf(stream, "  inlet %s: %zu wait, for there is no room\n",
              scree_scene_inlet_name(scene, i), waiting);
  }
  print_loss(stream, scene);
  fprintf(stream, "  energy that the sums miss: %.2g of all that changed its form\n", b.ledger);
  print_sensors(stream, scene);
}

static scree_status write_json(const scene_run *r, const char *stopped, double seconds,
                               const char *path, scree_error *error) {
  char kept[PATH_BYTES]; /* what one goes on with that no file was given for */
  const bool given = r->call->input_count > 0;
  scree_status status = given ? SCREE_OK : path_of(r, "scene.yaml", kept, error);
  if (status != SCREE_OK) return status;
  scree_scene_entry entry = {.scene = r->scene,
                             .file = given ? r->call->inputs[0] : kept,
                             .stopped_because = stopped,
                             .command_line = r->call->command_line,
                             .seconds = seconds};
  return scree_scene_json_write(&entry, path, true, error);
}

static scree_status draw(const scene_run *r, scree_error *error) {
  char path[PATH_BYTES];
  scree_image image = {0};
  scree_render_options o = scree_default_render_options();
  if (r->arguments->no_picture) return SCREE_OK;
  o.samples = r->arguments->rays;
  scree_status status = path_of(r, "scene.png", path, error);
  if (status == SCREE_OK)
    status = scree_scene_picture(r->scene, &o, r->call->progress, &image, error);
  if (status == SCREE_OK) status = scree_image_write_png(&image, path, true, error);
  scree_image_free(&image);
  if (status != SCREE_UNSUPPORTED && status != SCREE_CANCELLED) return status;
  fprintf(stderr, "no picture: %s\n", error->message);
  return SCREE_OK;
}

static scree_status write_all(const scene_run *r, const char *stopped, double seconds,
                              const char *text, scree_error *error) {
  char path[PATH_BYTES];
  scree_status status = write_collections(r, error);
  if (status == SCREE_OK) status = path_of(r, "result.json", path, error);
  if (status == SCREE_OK) status = write_json(r, stopped, seconds, path, error);
  if (status == SCREE_OK) status = path_of(r, "bodies.csv", path, error);
  if (status == SCREE_OK) status = scree_scene_bodies_write(r->scene, path, true, error);
  if (status == SCREE_OK) status = path_of(r, "result.txt", path, error);
  if (status == SCREE_OK) status = scree_text_write(text, path, true, error);
  if (status == SCREE_OK) status = path_of(r, "provenance.json", path, error);
  if (status == SCREE_OK)
    status = scree_provenance_write(&r->start, r->call->command_line, path, true, error);
  if (status == SCREE_OK) status = draw(r, error);
  if (status == SCREE_OK) status = path_of(r, "report.html", path, error);
  if (status == SCREE_OK) status = scree_page_write(&r->arguments->output, 1, path, true, error);
  return status;
}

static scree_status tell(scene_run *r, const char *stopped, double seconds, scree_error *error) {
  char *text = NULL;
  size_t size;
  FILE *stream = scree_memory_open(&text, &size);
  if (stream) print_summary(stream, r->scene, stopped);
  if (!stream || !scree_memory_close(stream)) {
    free(text);
    return no_memory(error);
  }
  cli_terminal_end();
  scree_status status = SCREE_OK;
  if (r->arguments->json)
    status = write_json(r, stopped, seconds, "-", error);
  else
    fputs(text, stdout);
  cli_flush();
  if (status == SCREE_OK && r->arguments->output)
    status = write_all(r, stopped, seconds, text, error);
  free(text);
  return status;
}

static scree_status check_output(const scene_run *r, scree_error *error) {
  const run_arguments *a = r->arguments;
  if (!a->output) return SCREE_OK;
  scree_status status = cli_make_folder(a->output, error);
  if (status == SCREE_OK && !a->resume)
    status = cli_check_run_output(r->call, a->output, &run_files, a->overwrite, error);
  if (status == SCREE_OK && a->overwrite && !a->resume)
    status = cli_clear_run_output(r->call, a->output, &run_files, error);
  return status;
}

/* The state in which the scene failed: the report plays up to it, and nothing goes on from it. */
static void keep_end(const scene_run *r) {
  char path[PATH_BYTES];
  if (r->arguments->output && path_of(r, "checkpoint.scree", path, NULL) == SCREE_OK)
    (void)scree_scene_save(r->scene, path, true, NULL);
}

static scree_status simulate(scene_run *r, scree_error *error) {
  scree_status status = check_output(r, error);
  if (status != SCREE_OK) return status;
  scree_scene_job job = {.file = r->file,
                         .folder = r->arguments->output,
                         .resume = r->arguments->resume,
                         .overwrite = r->arguments->overwrite,
                         .progress = r->call->progress,
                         .watch = watch,
                         .begun = on_begin,
                         .frame = r->arguments->output ? on_frame : NULL,
                         .context = r};
  double seconds = scree_now();
  status = scree_scene_complete(&job, &r->scene, error);
  seconds = scree_now() - seconds;
  bool told =
      r->scene && (status == SCREE_OK || status == SCREE_CANCELLED || status == SCREE_DIVERGED);
  if (!told) return status;
  if (status == SCREE_DIVERGED) keep_end(r);
  scree_error later; /* what happened first is what is told */
  scree_status telling = tell(r, status == SCREE_OK ? NULL : error->message, seconds,
                              status == SCREE_OK ? error : &later);
  return status == SCREE_OK ? telling : status;
}

/* ---- the call ---- */

static int print_template(const cli_call *call, const char *name) {
  const char *text = scree_scene_template(name);
  if (call->input_count) return cli_misuse(call->verb, "--template takes no file");
  if (text) return fputs(text, stdout) < 0;
  char list[300] = "";
  for (size_t i = 0; scree_scene_template_name(i); i++) {
    size_t used = strlen(list);
    snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "",
             scree_scene_template_name(i));
  }
  return cli_misuse(call->verb, "--template %s: there are %s", name, list);
}

static int check_call(const cli_call *call) {
  const run_arguments *a = call->options;
  for (size_t i = 0; i < a->set.count; i++)
    if (!strchr(a->set.items[i], '=') || a->set.items[i][0] == '=')
      return cli_misuse(call->verb, "--set %s: must be FIELD=VALUE, as in inlets.feed.rate=5",
                        a->set.items[i]);
  if (call->input_count == 0 && !(a->resume && a->output))
    return cli_misuse(call->verb, "needs a SCENE.yaml, or --resume with -o DIR; --template NAME "
                                  "prints one to start from");
  if (call->input_count == 0 && (a->set.count || a->print))
    return cli_misuse(call->verb, "--set and --print need a SCENE.yaml");
  if (a->resume && !a->output) return cli_misuse(call->verb, "--resume needs -o DIR");
  return 0;
}

static int run(const cli_call *call) {
  const run_arguments *a = call->options;
  scene_run r = {.call = call, .arguments = a, .start = scree_work_started()};
  scree_error error;
  if (a->template_name) return print_template(call, a->template_name);
  int code = check_call(call);
  if (code) return code;
  scree_status status = read_file(&r, &error);
  if (status == SCREE_OK && a->print)
    status = scree_scene_file_print(r.file, stdout, &error);
  else if (status == SCREE_OK)
    status = simulate(&r, &error);
  scree_scene_free(r.scene);
  scree_scene_file_free(r.file);
  free(r.frames.times);
  return status == SCREE_OK ? 0 : cli_fail(&error);
}

const cli_verb cli_verb_run = {
    .name = "run",
    .summary = "run a scene of your own: shapes, moving geometry, inlets, sensors",
    .inputs = "SCENE.yaml",
    .description =
        "Simulates what a YAML file describes (docs/reference/scenes.md): shapes from scans, "
        "spheres and "
        "clumps; geometry from mesh files and solids, at rest or moving; inlets, outlets, sensors. "
        "`scree run --template NAME > my.yaml` writes a commented file to start from. Every error "
        "in a file is told with line and column, and with what is allowed.\n\n"
        "Prints what came in, is inside and went out, and what the sensors read. With -o DIR "
        "writes result.json, series.csv (all numbers over time), scene.yaml (the scene with every "
        "default), sensor-*.csv (what sensors have besides columns), bodies.pvd and geometry.pvd "
        "with their frames for ParaView, scene.png, and "
        "report.html, which plays it. Ctrl-C leaves a checkpoint, as a crash does: --resume goes "
        "on with the same bits. The same file gives the same bits for any number of threads. A "
        "scene that leaves the range of the contact law stops with step, body and cause, and "
        "leaves the state shortly before in stopped.scree.",
    .examples = "scree run --template hopper > hopper.yaml\n"
                "scree run hopper.yaml -o hopper\n"
                "scree run hopper.yaml --set inlets.feed.count=800 --set time=6 -o more\n"
                "scree run -o hopper --resume\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .defaults = &defaults,
    .options_size = sizeof defaults,
    .input_minimum = 0,
    .input_maximum = 1,
    .partners = "rays:output no-picture:output force:output",
    .run = run,
};
