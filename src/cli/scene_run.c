#include "cli/scene_run.h"
#include "cli/output.h"
#include "report/program.h"

#include "base/array.h"
#include "base/file.h"
#include "base/number.h"
#include "base/path.h"
#include "base/platform.h"
#include "cli/options.h"
#include "cli/terminal.h"

#include <math.h>
#include <string.h>

/* By the bits of `views`. */
static const char *const kinds[CLI_FRAME_KINDS] = {"-bodies", "-points", "-contacts", "-geometry"};
static const char *const collections[CLI_FRAME_KINDS] = {"bodies.pvd", "points.pvd", "contacts.pvd",
                                                         "geometry.pvd"};

static const char *const file_names[] = {"checkpoint.scree",     "series.csv",
                                         "motion.scree",         "scene.yaml",
                                         "frame-#-bodies.vtp",   "bodies.pvd",
                                         "geometry.pvd",         "scene.png",
                                         "joints.png",           "frame-#-geometry.vtp",
                                         "result.json",          "result.txt",
                                         "stopped.scree",        "frame-#-points.vtp",
                                         "points.pvd",           "contacts.pvd",
                                         "frame-#-contacts.vtp", "frame-#.scree",
                                         "last.scree",           "provenance.json",
                                         "report.html",          "sensor-*.csv",
                                         "sensor-*.vts",         "bodies.csv",
                                         "shape-#.vtp",          "walls.vtp"};
static const cli_run_files run_files = {file_names, sizeof file_names / sizeof *file_names};

/* A file of the folder, until the end of the block. */
#define IN_FOLDER(run, name) SCREE_PATH_IN((run)->output, name)

/* ---- frames for ParaView, and when each was ---- */

enum { FRAME_NAME = 64 };

/* "frame-000012-bodies.vtp", of kind "-bodies". */
static void frame_name(size_t index, const char *kind, char name[FRAME_NAME]) {
  snprintf(name, FRAME_NAME, "frame-%06zu%.32s.vtp", index, kind);
}

/* One more, of this moment. */
static scree_status note_frame(cli_frames *frames, double time, scree_error *error) {
  return SCREE_PUSH(frames, time) ? SCREE_OK : scree_fail_memory(error, 0, "the times of frames");
}

/* Those that an earlier piece wrote, one on the first step at or past every interval (s; 0: none),
 * before where the world is now. Times are summed up as a world does, for the same bits. */
static scree_status recall_frames(cli_frames *frames, double interval, const scree_world *world,
                                  scree_error *error) {
  double now = scree_world_time(world), step = scree_world_time_step(world, NULL), next = 0;
  for (double time = 0; interval > 0 && time < now - 0.5 * step; time += step) {
    if (time < next) continue;
    SCREE_TRY(note_frame(frames, time, error));
    next = (floor(time / interval) + 1) * interval;
  }
  return SCREE_OK;
}

/* The collection of those of a kind, where there are any; it may replace an earlier one. */
static scree_status list_frames(const cli_frames *frames, const char *kind, const char *path,
                                scree_error *error) {
  typedef char one_name[FRAME_NAME];
  size_t count = frames->count;
  if (count == 0) return SCREE_OK;
  SCREE_SCRATCH(const char *, files, count, error);
  SCREE_SCRATCH(one_name, names, count, error);
  for (size_t i = 0; i < count; i++) {
    frame_name(i, kind, names[i]);
    files[i] = names[i];
  }
  return scree_pvd_write(files, frames->items, count, path, true, error);
}

/* ---- while it runs ---- */

/* Once, where that is long: by what the first steps cost. */
static void tell_time(cli_scene_run *r, const char *left, double seconds) {
  enum { LONG = 60 };
  if (r->time_told || isnan(seconds)) return;
  r->time_told = true;
  if (seconds < LONG || r->call->quiet || r->options->json) return;
  cli_terminal_end();
  printf("  about %s, by what its first steps cost\n", left);
  cli_flush();
}

static bool watch(void *context, const scree_scene_state *state) {
  char left[32], line[200];
  scree_scene_book b;
  scree_scene_get_book(state->scene, &b);
  cli_terminal_seconds(left, sizeof left, state->seconds_left);
  snprintf(line, sizeof line, "%.2f of %g s  %.0f %%  %zu in, %zu out%s  %.0f steps/s  %s left",
           state->time, scree_scene_duration(state->scene), 100 * state->fraction, b.inside_count,
           b.left_count, b.waiting_count ? ", some wait" : "",
           isnan(state->steps_per_second) ? 0 : state->steps_per_second, left);
  tell_time(context, left, state->seconds_left);
  cli_terminal_line(line);
  return !cli_interrupted();
}

static scree_status write_view(const cli_scene_run *r, const scree_scene *scene, int kind,
                               scree_error *error) {
  static const scree_world_view views[] = {SCREE_VIEW_SURFACES, SCREE_VIEW_POINTS,
                                           SCREE_VIEW_CONTACTS};
  char name[FRAME_NAME];
  frame_name(r->frames.count, kinds[kind], name);
  const char *path = IN_FOLDER(r, name);
  if (1u << kind == CLI_GEOMETRY) return scree_scene_walls_vtp_write(scene, path, true, error);
  if (1u << kind == CLI_BODIES && r->forecast.frames_are_instances)
    return scree_scene_bodies_vtp_write(scene, path, true, error);
  return scree_world_vtp_write(scree_scene_view(scene), views[kind], path, true, error);
}

static scree_status write_collections(const cli_scene_run *r, scree_error *error) {
  for (int kind = 0; kind < CLI_FRAME_KINDS; kind++) {
    if (!(r->views & 1u << kind)) continue;
    const char *path = IN_FOLDER(r, collections[kind]);
    SCREE_TRY(list_frames(&r->frames, kinds[kind], path, error));
  }
  return SCREE_OK;
}

static scree_status on_frame(void *context, scree_scene *scene, size_t index, scree_error *error) {
  cli_scene_run *r = context;
  for (int kind = 0; kind < CLI_FRAME_KINDS; kind++)
    if (r->views & 1u << kind) SCREE_TRY(write_view(r, scene, kind, error));
  (void)index;
  SCREE_TRY(note_frame(&r->frames, scree_world_time(scree_scene_view(scene)), error));
  return write_collections(r, error);
}

/* Each shape once, for frames of instances. */
static scree_status write_shapes(const cli_scene_run *r, const scree_scene *scene,
                                 scree_error *error) {
  if (!r->output || !(r->forecast.frame_interval > 0) || !r->forecast.frames_are_instances)
    return SCREE_OK;
  for (size_t i = 0; scree_scene_shape_name(scene, i); i++) {
    char name[32];
    snprintf(name, sizeof name, "shape-%zu.vtp", i);
    SCREE_TRY(scree_scene_shape_vtp_write(scene, i, IN_FOLDER(r, name), true, error));
  }
  return SCREE_OK;
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
    cli_remark_size(scree_scene_shape_name(scene, i), m.size, "-u, or unit: in a scene, says it");
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

static void print_forecast(scree_scene_forecast f) {
  printf("  %.0f steps of up to %.0f bodies", f.step_count, f.body_count);
  if (f.frame_count > 0)
    printf("; %.0f frames, up to %.3g MB", f.frame_count, 1e-6 * f.frame_count * f.frame_bytes);
  putchar('\n');
}

static scree_status on_begin(void *context, scree_scene *scene, bool resumed, scree_error *error) {
  cli_scene_run *r = context;
  scree_scene_foretell(scene, &r->forecast);
  r->scene = scene;
  if (resumed)
    SCREE_TRY(
        recall_frames(&r->frames, r->forecast.frame_interval, scree_scene_view(scene), error));
  if (r->output && r->options->overwrite && !r->options->resume) /* not for a scene that is none */
    SCREE_TRY(cli_clear_scene_output(r->call, r->output, error));
  if (r->output)
    SCREE_TRY(scree_text_write(scree_scene_text(scene), IN_FOLDER(r, "scene.yaml"), true, error));
  SCREE_TRY(write_shapes(r, scene, error));
  if (r->call->quiet || r->options->json) return SCREE_OK;
  cli_terminal_end();
  if (!resumed && !r->states) remark_values(scree_scene_text(scene));
  if (!resumed) remark_sizes(scene);
  char remark[SCREE_REMARK];
  for (size_t i = 0; !resumed && scree_scene_remark(scene, i, remark); i++)
    fprintf(stderr, "scree: %s\n", remark);
  const char *title = scree_scene_title(scene);
  if (r->name || title)
    printf("%s%s%s\n", r->name ? r->name : "", r->name && title ? ": " : "", title ? title : "");
  for (size_t i = 0; scree_scene_shape_name(scene, i); i++) {
    const char *source = scree_scene_shape_source(scene, i);
    scree_particle_measures m;
    scree_particle_measure(scree_scene_shape_particle(scene, i), &m);
    char shown[CLI_PRINTABLE_BYTES];
    printf("  shape %-14s size %.4g mm%s%s\n", scree_scene_shape_name(scene, i), 1e3 * m.size,
           *source ? "  " : "", cli_printable(source, shown));
  }
  print_walls(scene);
  printf("  time step %s\n", r->forecast.time_step_reason);
  print_forecast(r->forecast);
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

/* " from 2 s on", " from 2 to 6 s"; "" of all times. */
static const char *window_text(const scree_scene_summary *s, char text[64]) {
  if (isfinite(s->until))
    snprintf(text, 64, " from %g to %g s", s->from, s->until);
  else
    snprintf(text, s->from > 0 ? 64 : 1, " from %g s on", s->from);
  return text;
}

/* Whether a column is of one shape, and the one before of all. */
static bool is_of_shape(const char *name, const char *whole) {
  return whole && !strncmp(name, whole, strlen(whole)) && name[strlen(whole)] == '.';
}

static void print_sensors(FILE *stream, const scree_scene *scene, bool by_shape) {
  size_t rows, columns = scree_scene_column_count(scene), first = 0, hidden = 0;
  const char *whole = NULL;
  (void)scree_scene_series(scene, &rows);
  while (first < columns && !strchr(scree_scene_column_name(scene, first), '.')) first++;
  if (!rows || first == columns) return;
  fprintf(stream, "  %-34s %12s %12s %12s\n", "sensor", "at the end", "mean", "sd");
  for (size_t k = first; k < columns; k++) {
    scree_scene_summary s = scree_scene_summarise(scene, k, NAN, NAN);
    char last[32], mean[32], sd[32], window[64];
    const char *name = scree_scene_column_name(scene, k);
    bool of_shape = is_of_shape(name, whole);
    if (!of_shape) whole = name;
    if (of_shape && !by_shape && ++hidden) continue;
    fprintf(stream, "  %-34s %12s %12s %12s %s%s\n", name, value_text(s.last, last),
            value_text(s.mean, mean), value_text(s.sd, sd), scree_scene_column_unit(scene, k),
            window_text(&s, window));
  }
  if (hidden) fprintf(stream, "  and %zu by shape, which -v tells\n", hidden);
}

void cli_print_repose(FILE *stream, const scree_repose *r) {
  if (!r->heap) {
    fprintf(stream, "  angle of repose   none: no heap, %s\n", r->reason);
  } else {
    fprintf(stream, "  angle of repose   %5.1f deg  se %4.1f   by volume and centroid\n",
            r->volume_deg, r->volume_se_deg);
    fprintf(stream, "                    %5.1f deg  sd %4.1f   sectors (%zu of %zu)\n",
            r->sector_deg, r->sector_sd_deg, r->sector_count, r->sector_total);
    fprintf(stream, "                    %5.1f deg  rms %4.1f mm  cone\n", r->cone_deg,
            1e3 * r->cone_rms);
    fprintf(stream,
            "                    %5.1f deg  sd %4.1f   silhouettes (%zu flank%s); the last three "
            "differ by %.1f\n",
            r->silhouette_deg, r->silhouette_sd_deg, r->flank_count, cli_plural(r->flank_count),
            r->spread_deg);
  }
  if (r->peak == 0) return;
  fprintf(stream, "  height            %5.4g mm, its highest point %.4g mm\n", 1e3 * r->height,
          1e3 * r->peak);
  if (isfinite(r->base_radius))
    fprintf(stream, "  base radius       %5.4g mm, the farthest particle reaches %.4g mm\n",
            1e3 * r->base_radius, 1e3 * r->run_out);
  else
    fprintf(stream, "  run-out           %5.4g mm\n", 1e3 * r->run_out);
}

/* Its pure numbers under their names: each on a line, or behind a comma. */
static void print_shares(FILE *stream, const scree_pile *pile, bool lines) {
  for (const scree_field *f = scree_pile_rows; f < scree_pile_rows + SCREE_PILE_ROWS; f++) {
    char name[40];
    if (*f->unit || f->kind != SCREE_FIELD_REAL) continue;
    snprintf(name, sizeof name, "%s", f->key);
    for (char *c = name; (c = strchr(c, '_'));) *c = ' ';
    fprintf(stream, lines ? "  %-16s  %5.2f\n" : ", %s %.2f", name, scree_field_real(f, pile));
  }
}

void cli_print_pile(FILE *stream, const scree_pile *pile) {
  cli_print_repose(stream, &pile->repose);
  if (pile->body_count == 0) return;
  fprintf(stream, "  particles         %5zu in it, of %.4g mm (sphere of equal volume)\n",
          pile->body_count, 1e3 * pile->size);
  print_shares(stream, pile, true);
}

static void print_piles(FILE *stream, const scree_scene *scene) {
  for (size_t i = 0; scree_scene_pile_name(scene, i); i++) {
    scree_pile pile;
    if (scree_scene_measure_pile(scene, i, NULL, &pile, NULL) == SCREE_OK)
      cli_print_pile(stream, &pile);
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

static void print_changes(FILE *stream, const scree_scene *scene) {
  for (size_t i = 0; i < scree_scene_change_count(scene); i++) {
    scree_scene_change_entry c = scree_scene_change_at(scene, i);
    fprintf(stream, "  changed at %.6g s: %s from %s to %s\n", c.time, c.field,
            c.was ? c.was : "not given", c.is ? c.is : "not given");
  }
}

static void print_end(FILE *stream, const scree_scene *scene, const char *stopped) {
  scree_scene_book b;
  scree_scene_get_book(scene, &b);
  fprintf(stream, "%s after %.6g s, %llu steps: %zu came in, %zu are inside, %zu went out\n",
          stopped ? "stopped" : scree_scene_end(scene), scree_world_time(scree_scene_view(scene)),
          (unsigned long long)scree_world_step_count(scree_scene_view(scene)), b.entered_count,
          b.inside_count, b.left_count);
}

/* The answer on a few lines; a heap's other numbers behind it. */
static void print_brief(FILE *stream, const scree_scene *scene, const char *stopped) {
  scree_words words;
  scree_pile pile;
  const scree_repose *r = &pile.repose;
  bool has = scree_scene_pile_name(scene, 0) &&
             scree_scene_measure_pile(scene, 0, NULL, &pile, NULL) == SCREE_OK;
  scree_scene_words(scene, has ? &pile : NULL, stopped, &words);
  if (has)
    fprintf(stream, "%s.\n%s\n", words.state, words.answer);
  else
    print_end(stream, scene, stopped);
  if (*words.but) fprintf(stream, "%s\n", words.but);
  if (has && words.verdict == SCREE_ANSWERED) {
    fprintf(stream, "sectors %.1f, cone %.1f, silhouettes %.1f deg; height %.4g mm, foot %.4g mm",
            r->sector_deg, r->cone_deg, r->silhouette_deg, 1e3 * r->height, 1e3 * r->base_radius);
    print_shares(stream, &pile, false);
    putc('\n', stream);
  }
  if (*words.next) fprintf(stream, "Next: %s\n", words.next);
  if (has) print_end(stream, scene, stopped);
}

/* Which stiffness would have kept contacts soft. */
static void print_hardening(FILE *stream, const scree_scene *scene) {
  scree_scene_hardening h;
  for (size_t i = 0; scree_scene_get_hardening(scene, i, &h); i++) {
    const char *both[2] = {h.material ? h.material : "bodies", h.other ? h.other : "bodies"};
    fprintf(
        stream,
        "  %s and %s were pressed beyond the overlap limit, where springs harden, %llu times, by "
        "up to %.2g limits: %.3g times as stiff they would have stayed within\n",
        both[0], both[1], (unsigned long long)h.count, h.deepest, h.stiffness_missing);
  }
}

static void print_summary(FILE *stream, const scree_scene *scene, const char *stopped,
                          bool by_shape) {
  scree_scene_book b;
  scree_scene_get_book(scene, &b);
  fprintf(stream, "%s after %.6g s, %llu steps\n", stopped ? "stopped" : scree_scene_end(scene),
          scree_world_time(scree_scene_view(scene)),
          (unsigned long long)scree_world_step_count(scree_scene_view(scene)));
  print_hardening(stream, scene);
  fprintf(stream,
          "  %zu came in, %zu are inside, %zu went out: %.5g kg in, %.5g kg inside, %.5g kg out\n",
          b.entered_count, b.inside_count, b.left_count, b.entered_mass, b.inside_mass,
          b.left_mass);
  if (scree_book_pieces(&b))
    fprintf(stream, "  some came apart: there are %zu more than came in\n", scree_book_pieces(&b));
  for (size_t i = 0; scree_scene_inlet_name(scene, i); i++) {
    size_t waiting;
    scree_scene_inlet_count(scene, i, NULL, &waiting);
    if (waiting)
      fprintf(stream, "  inlet %s: %zu wait, for there is no room\n",
              scree_scene_inlet_name(scene, i), waiting);
  }
  print_loss(stream, scene);
  scree_observation o;
  scree_world_observe(scree_scene_view(scene), &o);
  fprintf(stream, "  %.3g touching neighbours a particle, largest overlap %.4g um\n",
          o.coordination, 1e6 * o.largest_overlap);
  fprintf(stream, "  energy that the sums miss: %.2g of all that changed its form\n", b.ledger);
  print_changes(stream, scene);
  print_sensors(stream, scene, by_shape);
  char doubt[SCREE_REMARK];
  for (size_t i = 0; scree_scene_doubt(scene, i, doubt); i++) fprintf(stream, "  %s\n", doubt);
  print_piles(stream, scene);
}

/* Not of result.txt: it is another one every time. */
static void print_costs(const scree_scene *scene) {
  scree_scene_costs c = scree_scene_get_costs(scene);
  if (c.body_steps)
    printf("  cost: %.0f s on the clock, %.2f us a particle and step\n", c.wall_seconds,
           1e6 * c.wall_seconds / (double)c.body_steps);
}

static scree_status write_json(const cli_scene_run *r, const char *stopped, double seconds,
                               const char *path, scree_error *error) {
  const char *file = r->file_name; /* without it one goes on with what is kept */
  if (!file && r->output) file = IN_FOLDER(r, "scene.yaml");
  scree_scene_entry entry = {.scene = r->scene,
                             .file = file,
                             .stopped_because = stopped,
                             .command_line = r->call->command_line,
                             .seconds = seconds};
  return scree_scene_json_write(&entry, path, true, error);
}

static scree_status draw_as(const cli_scene_run *r, bool joints, const char *name,
                            scree_error *error) {
  SCREE_CLEANUP(scree_image_free) scree_image image = {0};
  scree_render_options o = scree_default_render_options();
  o.width = 800, o.height = 600; /* in a second or so, beside runs of a few */
  o.samples = r->options->rays;
  o.joints = joints;
  bool pile = scree_scene_pile_name(r->scene, 0);
  if (pile) o.elevation_deg = 18;
  SCREE_TRY((pile ? scree_scene_pile_picture : scree_scene_picture)(r->scene, &o, r->call->progress,
                                                                    &image, error));
  return scree_image_write_png(&image, IN_FOLDER(r, name), true, error);
}

static scree_status draw(const cli_scene_run *r, scree_error *error) {
  if (r->options->no_picture) return SCREE_OK;
  scree_status status = draw_as(r, false, "scene.png", error);
  if (status == SCREE_OK && scree_world_joint_count(scree_scene_view(r->scene)) > 0)
    status = draw_as(r, true, "joints.png", error);
  if (status != SCREE_UNSUPPORTED && status != SCREE_CANCELLED) return status;
  fprintf(stderr, "no picture: %s\n", error->message);
  return SCREE_OK;
}

static scree_status write_page(const cli_scene_run *r, scree_error *error) {
  SCREE_TRY(scree_provenance_write(&r->start, r->call->command_line,
                                   IN_FOLDER(r, "provenance.json"), true, error));
  if (r->common_page) return SCREE_OK;
  return scree_page_write(&r->output, 1, IN_FOLDER(r, "report.html"), true, error);
}

static scree_status write_all(const cli_scene_run *r, const char *stopped, double seconds,
                              scree_error *error) {
  scree_output text;
  SCREE_TRY(write_collections(r, error));
  SCREE_TRY(write_json(r, stopped, seconds, IN_FOLDER(r, "result.json"), error));
  SCREE_TRY(scree_scene_bodies_write(r->scene, IN_FOLDER(r, "bodies.csv"), true, error));
  if (scree_scene_has_maps(r->scene))
    SCREE_TRY(scree_scene_walls_vtp_write(r->scene, IN_FOLDER(r, "walls.vtp"), true, error));
  SCREE_TRY(scree_output_open(IN_FOLDER(r, "result.txt"), true, &text, error));
  print_summary(text.stream, r->scene, stopped, true);
  SCREE_TRY(scree_output_commit(&text, error));
  SCREE_TRY(draw(r, error));
  return write_page(r, error);
}

static scree_status tell(const cli_scene_run *r, const char *stopped, double seconds,
                         scree_error *error) {
  cli_terminal_end();
  if (r->options->json)
    SCREE_TRY(write_json(r, stopped, seconds, "-", error));
  else if (r->brief && !r->call->verbose)
    print_brief(stdout, r->scene, stopped);
  else
    print_summary(stdout, r->scene, stopped, r->call->verbose);
  if (!r->options->json && !r->call->quiet) print_costs(r->scene);
  cli_flush();
  return r->output ? write_all(r, stopped, seconds, error) : SCREE_OK;
}

scree_status cli_check_scene_output(const cli_scene_run *r, scree_error *error) {
  SCREE_TRY(cli_make_folder(r->output, error));
  SCREE_TRY(cli_lock_folder(r->output, error));
  if (!r->options->resume)
    SCREE_TRY(cli_check_run_output(r->call, r->output, &run_files, r->options->overwrite, error));
  return SCREE_OK;
}

scree_status cli_clear_scene_output(const cli_call *call, const char *folder, scree_error *error) {
  return cli_clear_run_output(call, folder, &run_files, error);
}

/* The state in which the scene failed: the report plays up to it, and nothing goes on from it. */
static void keep_end(const cli_scene_run *r) {
  if (r->output) (void)scree_scene_save(r->scene, IN_FOLDER(r, "checkpoint.scree"), true, NULL);
}

scree_status cli_run_scene(cli_scene_run *r, scree_error *error) {
  scree_scene_job job = {.file = r->file,
                         .folder = r->output,
                         .resume = r->options->resume,
                         .changes = r->options->change.items,
                         .change_count = r->options->change.count,
                         .overwrite = r->options->overwrite,
                         .states = r->states,
                         .store = r->store,
                         .progress = r->call->progress,
                         .watch = watch,
                         .begun = on_begin,
                         .frame = r->output && r->views ? on_frame : NULL,
                         .context = r};
  double seconds = scree_now();
  scree_status status = scree_scene_complete(&job, &r->scene, error);
  seconds = scree_now() - seconds;
  cli_terminal_end();
  bool told =
      r->scene && (status == SCREE_OK || status == SCREE_CANCELLED || status == SCREE_DIVERGED);
  if (!told) return status;
  if (status == SCREE_DIVERGED) keep_end(r);
  scree_error later; /* what happened first is what is told */
  scree_status telling = tell(r, status == SCREE_OK ? NULL : error->message, seconds,
                              status == SCREE_OK ? error : &later);
  char folder[CLI_PRINTABLE_BYTES];
  if (status == SCREE_CANCELLED && r->output && !r->common_page)
    scree_add_text(error->message, sizeof error->message, ": scree %s --resume -o %s",
                   r->call->verb->name, cli_printable(r->output, folder));
  return status == SCREE_OK ? telling : status;
}

void cli_scene_run_free(cli_scene_run *r) {
  scree_scene_free(r->scene);
  scree_free(r->frames.items);
  r->scene = NULL;
  r->frames = (cli_frames){0};
}

/* ---- fields that options set ---- */

/* "FIELD=VALUE" as field and value; NULL where it is none. */
static const char *split(const char *text, char field[200]) {
  size_t length = strcspn(text, "=");
  if (length == 0 || !text[length] || length >= 200) return NULL;
  snprintf(field, 200, "%.*s", (int)length, text);
  return text + length + 1;
}

scree_status cli_set_fields(const cli_call *call, scree_scene_file *file, const cli_fields *fields,
                            const cli_texts *set) {
  char first[1200] = "";
  size_t count = fields ? fields->count : 0;
  for (size_t i = 0; i < count + set->count; i++) {
    const cli_option *option = i < count ? fields->options[i] : NULL;
    char number[CLI_NUMBER_BYTES], other[200];
    const char *field = other, *value;
    if (option) {
      field = option->field;
      value = cli_si_text(option->kind, fields->values[i], number);
    } else if (!(value = split(set->items[i - count], other))) {
      return cli_misuse(call->verb, "--set %s: must be FIELD=VALUE, as in gravity.0=1",
                        set->items[i - count]);
    }
    scree_error error;
    scree_status status = scree_scene_file_try(file, field, value, &error);
    bool hard = status != SCREE_OK && status != SCREE_BAD_FILE;
    if (status != SCREE_OK && (!*first || hard))
      snprintf(first, sizeof first, "--%s: %.1000s", option ? option->name : "set", error.message);
    if (hard) return cli_misuse(call->verb, "%s", first);
  }
  if (!*first || scree_scene_file_check(file, NULL) == SCREE_OK) return SCREE_OK;
  return cli_misuse(call->verb, "%s", first);
}
