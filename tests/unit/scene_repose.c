/* The templates `repose` and `drop`: presets and settings files, what cannot be filled, all phases
 * in any cut and from any checkpoint, whole ones in folders, and those that fail. */
#include "base/alloc.h"
#include "base/file.h"
#include "base/rng.h"
#include "base/yaml.h"
#include "scene/scene.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/pot.h"
#include "support/shapes.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

static const scree_poured ball = {"ball", "sphere", "0.02", 1};

static void check_refused(const scree_scene_file *file, const char *message) {
  scree_scene *scene = NULL;
  scree_error error;
  assert_int_not_equal(scree_scene_create(file, NULL, &scene, &error), SCREE_OK);
  assert_null(scene);
  if (!strstr(error.message, message)) fail_msg("got '%s', expected '%s'", error.message, message);
}

static scree_scene_file *template_of(const char *name) {
  scree_scene_file *file;
  scree_error error;
  CHECK_OK(scree_scene_file_template(name, &file, &error), error);
  return file;
}

/* ---- settings ---- */

/* Closed phones, and clamshells of 188 mm. */
static void every_preset_takes_phones_and_long_ones(void **state) {
  (void)state;
  static const char *const presets[] = {"heap", "paper", "small", "demo"},
                           *const shares[] = {"{phone: 1, long: 1}", "{long: 1}"};
  for (size_t i = 0; i < 8; i++) {
    scree_scene_file *file = template_of("repose");
    set_field(file, "preset", presets[i / 2]);
    set_field(file, "shapes",
              "{phone: {box: [0.1, 0.05, 0.015], material: grain}, "
              "long: {box: [0.188, 0.05, 0.02], material: grain}}");
    set_field(file, "inlets.fill.shapes", shares[i % 2]);
    scree_scene *scene = pot_scene(file);
    assert_string_equal(scree_scene_phase(scene), "pack");
    scree_scene_free(scene);
    scree_scene_file_free(file);
  }
}

static double number_at(const scree_scene *scene, const char *field) {
  scree_yaml root = {0};
  scree_error error;
  const char *text = scree_scene_text(scene);
  CHECK_OK(scree_yaml_parse(text, strlen(text), "made", &root, &error), error);
  const scree_yaml *node = scree_yaml_at(&root, field);
  assert_non_null(node);
  double value = atof(node->text);
  scree_yaml_free(&root);
  return value;
}

/* The same heap in gravity at every size: lengths, times, speeds and stiffness follow the
 * particles, so that steps are as many; what is set by hand stays. */
static void the_heap_scales_with_the_particles(void **state) {
  (void)state;
  double steps = NAN;
  static const double sizes[] = {0.05, 0.001, 1};
  for (size_t i = 0; i < 3; i++) {
    scree_scene_file *file = template_of("repose");
    char shape[64];
    double share = sizes[i] / 0.05;
    snprintf(shape, sizeof shape, "{ball: {sphere: %g, material: grain}}", sizes[i]);
    set_field(file, "preset", "heap");
    set_field(file, "phases.hold_time", "3");
    set_field(file, "shapes", shape);
    scree_scene *scene = pot_scene(file);
    CHECK_NEAR(number_at(scene, "geometry.cylinder.cylinder.radius"), 5 * sizes[i], 1e-9);
    CHECK_NEAR(number_at(scene, "phases.lift.time"), 4.8 * sqrt(share), 1e-6);
    CHECK_NEAR(number_at(scene, "phases.hold.time"), 3, 0);
    double made =
        number_at(scene, "phases.lift.time") / scree_world_time_step(scree_scene_view(scene), NULL);
    if (i > 0) CHECK_NEAR(made / steps, 1, 1e-3);
    steps = made;
    scree_scene_free(scene);
    scree_scene_file_free(file);
  }
}

static const char *file_with(const char *text) {
  const char *path = in_folder("settings.yaml");
  FILE *file = fopen(path, "w");
  fputs(text, file);
  fclose(file);
  return path;
}

static void settings_errors_say_line_column_value_and_limit(void **state) {
  (void)state;
  static const struct {
    const char *text, *message;
  } cases[] = {
      {"seed: 1\ndensity: heavy\n", "line 2, column 10: density: 'heavy': must be a number"},
      {"contact:\n  restitution: 1.5\n", "line 2, column 16: "},
      {"colour: red\n", "line 1, column 1: no field 'colour'"},
      {"phases: {lift_sped: 1}\n", "column 10: no field 'phases.lift_sped'; did you mean "
                                   "'phases.lift_speed'?"},
      {"contact:\n  law: cubic\n", "line 2, column 8: contact.law: "},
      {"seed: 1\nseed: 2\n", "line 2, column 1: this key stands here twice"},
      {"preset: huge\n", "line 1, column 9: no preset 'huge'; there are heap, paper, small, demo"},
      {"measure: {band_low: 0.9}\n", "band_low 0.9 must be below band_high 0.8"},
      {"materials: {gran: {friction: 0.4}}\n", "column 30: "},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    scree_scene_file *file = NULL;
    scree_error error;
    scree_status status =
        scree_scene_file_read_over(file_with(cases[i].text), "repose", NULL, &file, &error);
    assert_int_not_equal(status, SCREE_OK);
    assert_null(file);
    if (!strstr(error.message, cases[i].message))
      fail_msg("got '%s', expected '%s'", error.message, cases[i].message);
  }
}

/* One value may be wrong alone and right with another one that follows. */
static void settings_are_judged_together(void **state) {
  (void)state;
  scree_scene_file *file;
  scree_error error;
  const char *path = file_with("measure: {band_low: 0.9, band_high: 0.95}\n");
  CHECK_OK(scree_scene_file_read_over(path, "repose", "small", &file, &error), error);
  CHECK_OK(scree_scene_file_check(file, &error), error);
  scree_scene_file_free(file);
}

static void what_cannot_be_filled_is_refused_before_the_run(void **state) {
  (void)state;
  scree_scene_file *file = template_of("repose");
  set_field(file, "shapes", "{phone: {box: [0.1, 0.05, 0.015], material: grain}}");
  set_field(file, "inlets.fill.shapes", "phone");
  set_field(file, "cylinder.diameter", "0.05");
  check_refused(file, "does not fit into the cylinder of 50 mm");
  set_field(file, "cylinder.diameter", "0.4");
  set_field(file, "phases.pack_time", "0.2");
  check_refused(file, "set pack_time to");
  scree_scene_file_free(file);
  file = template_of("drop");
  set_field(file, "shapes", "{box: {box: [0.05, 0.03, 0.02], material: particles}}");
  set_field(file, "inlets.fill.shapes", "box");
  set_field(file, "width", "0.06");
  check_refused(file, "too narrow");
  scree_scene_file_free(file);
}

static const scree_yaml *value_at(const scree_yaml *root, const char *field) {
  const scree_yaml *node = scree_yaml_at(root, field);
  assert_non_null(node);
  return node;
}

/* Of a drop as made: what is not set is as much less as the largest particle is below 10 mm. */
static void small_particles_fall_less_far(void **state) {
  (void)state;
  static const struct {
    const char *parameter, *field;
    double value, power;
  } usual[] = {{"drop_height", "inlets.fill.layers.bottom", 0.05, 1},
               {"speed", "inlets.fill.velocity.2", -1, 0.5},
               {"time", "stop.filled", 2, 0.5},
               {"still", "stop.still", 1e-8, 4},
               {"rest", "stop.rest", 0.05, 0.5},
               {"frames", "output.frames", 0.02, 0.5},
               {"series", "output.series", 0.01, 0.5}};
  enum { COUNT = sizeof usual / sizeof *usual };
  scree_rng rng = {.seed = 7};
  for (int i = 0; i < 24; i++) {
    double size = 0.001 * exp(3 * scree_rng_uniform(&rng)), share = fmin(1, size / 0.01);
    size_t set = (size_t)(COUNT * scree_rng_uniform(&rng)), direct = (set + 1) % COUNT;
    scree_scene_file *file = template_of(i % 2 ? "drop" : "drop-box");
    char text[128];
    scree_yaml root;
    scree_error error;
    snprintf(text, sizeof text,
             "{small: {sphere: 5e-4, material: particles}, "
             "large: {sphere: %.17g, material: particles}}",
             size);
    set_field(file, "shapes", text);
    set_field(file, "inlets.fill.shapes", "{small: 1, large: 1}");
    set_field(file, usual[set].parameter, "0.03");
    set_field(file, usual[direct].field, usual[direct].value < 0 ? "-0.04" : "0.04");
    scree_scene *scene = pot_scene(file);
    const char *made = scree_scene_text(scene);
    CHECK_OK(scree_yaml_parse(made, strlen(made), "made", &root, &error), error);
    for (size_t k = 0; k < COUNT; k++) {
      double expected = k == set      ? copysign(0.03, usual[k].value)
                        : k == direct ? copysign(0.04, usual[k].value)
                                      : usual[k].value * pow(share, usual[k].power);
      double value = atof(value_at(&root, usual[k].field)->text);
      if (fabs(value - expected) > 1e-12 * fabs(expected))
        fail_msg("%s of %g m: %g, expected %g", usual[k].field, size, value, expected);
    }
    /* made again of its own text it is the same: nothing shrinks twice */
    scree_scene_file *again;
    CHECK_OK(scree_scene_file_parse(made, strlen(made), "again", &again, &error), error);
    scree_scene *other = pot_scene(again);
    assert_string_equal(scree_scene_text(other), made);
    scree_yaml_free(&root);
    scree_scene_free(other);
    scree_scene_free(scene);
    scree_scene_file_free(again);
    scree_scene_file_free(file);
  }
}

/* By `mass_from: scan` every level weighs as the scan does, also of a method that does not keep the
 * volume. */
static void a_scan_gives_its_levels_their_mass(void **state) {
  (void)state;
  const scree_poured device = {"device", "sample", "dc-1", 1};
  double masses[2];
  for (int scan = 0; scan < 2; scan++) {
    scree_scene_file *file = template_of("repose");
    scree_error error;
    CHECK_OK(scree_scene_file_pour(file, &device, 1, &error), error);
    set_field(file, "shapes.device.resolution", "2.5e-3");
    set_field(file, "shapes.device.method", "qecd");
    set_field(file, "mass_from", scan ? "scan" : "mesh");
    set_field(file, "rp", "0.02");
    scree_scene *scene = pot_scene(file);
    scree_particle_measures m;
    while (scree_world_body_count(scree_scene_view(scene)) == 0)
      CHECK_OK(scree_scene_advance(scene, 1, &error), error);
    scree_particle_measure(scree_scene_shape_particle(scene, 0), &m);
    masses[scan] = scree_world_body_mass(scree_scene_view(scene), 0);
    if (!scan) CHECK_NEAR(masses[0], 2000 * m.volume, 1e-12);
    scree_scene_free(scene);
    scree_scene_file_free(file);
  }
  scree_sample_options o = scree_default_sample_options();
  scree_mesh whole;
  scree_error error;
  double volume;
  o.resolution = 2.5e-3;
  CHECK_OK(scree_sample_make("dc-1", &o, NULL, &whole, &error), error);
  CHECK_OK(scree_mesh_area_volume(&whole, NULL, &volume, &error), error);
  CHECK_NEAR(masses[1], 2000 * volume, 1e-9 * masses[1]);
  assert_true(fabs(masses[0] - masses[1]) > 1e-4 * masses[1]);
  scree_mesh_free(&whole);
}

/* ---- six spheres and six chips through all phases ---- */

static scree_scene_file *make_pot(void) {
  scree_scene_file *file = pot_file("12", &ball, 1);
  set_field(file, "shapes.chip", "{box: [0.02, 0.012, 0.006], material: grain}");
  set_field(file, "inlets.fill.shapes", "{ball: 1, chip: 1}");
  set_field(file, "output.series_interval", "0.01");
  set_field(file, "output.angle_interval", "0.02");
  return file;
}

static void check_same(scree_scene *a, scree_scene *b) {
  scree_checksum ha = scree_world_hash(scree_scene_view(a)),
                 hb = scree_world_hash(scree_scene_view(b));
  size_t na, nb, columns = scree_scene_column_count(a);
  const double *ra = scree_scene_series(a, &na), *rb = scree_scene_series(b, &nb);
  assert_memory_equal(&ha, &hb, sizeof ha);
  assert_int_equal(na, nb);
  for (size_t i = 0; i < na * columns; i++)
    assert_true(ra[i] == rb[i] || (isnan(ra[i]) && isnan(rb[i])));
}

static scree_scene *run_through(const scree_scene_file *file, size_t steps_a_call) {
  scree_scene *scene = pot_scene(file);
  scree_error error;
  while (!scree_scene_end(scene)) CHECK_OK(scree_scene_advance(scene, steps_a_call, &error), error);
  return scene;
}

static void it_does_not_depend_on_how_it_is_cut(void **state) {
  (void)state;
  scree_scene_file *file = make_pot();
  scree_scene *a = run_through(file, 1000000), *b = run_through(file, 137);
  scree_pile pile;
  scree_error error;
  check_same(a, b);
  CHECK_OK(scree_scene_measure_pile(a, 0, NULL, &pile, &error), error);
  assert_true(pile.repose.peak > 0.005 && pile.repose.peak < 0.2);
  assert_true(pile.packing_fraction > 0.05 && pile.packing_fraction < 1);
  assert_true(pile.body_count <= 12);
  scree_scene_free(a);
  scree_scene_free(b);
  scree_scene_file_free(file);
}

static size_t column(const scree_scene *scene, const char *name) {
  size_t k = 0;
  while (strcmp(scree_scene_column_name(scene, k), name) != 0) k++;
  return k;
}

static void the_series_has_a_row_at_every_interval(void **state) {
  (void)state;
  scree_scene_file *file = make_pot();
  scree_scene *scene = run_through(file, 1000000);
  size_t count, angles = 0, columns = scree_scene_column_count(scene),
                height = column(scene, "heap.height"), phase = column(scene, "phase"),
                z = column(scene, "cylinder.z");
  const double *rows = scree_scene_series(scene, &count);
  double step = scree_world_time_step(scree_scene_view(scene), NULL);
  assert_true(count == 26 || count == 27); /* 0.25 s by 0.01 s, and the end */
  for (size_t i = 0; i + 1 < count; i++) {
    const double *row = rows + i * columns;
    CHECK_NEAR(row[0], 0.01 * (double)i, step);
    assert_true(row[0] >= 0.01 * (double)i - 1e-12);
    angles += !isnan(row[height]);
    if (!isnan(row[height])) assert_true(row[phase] >= 2);
  }
  assert_true(angles >= 4 && angles <= 6);
  assert_false(isnan(rows[(count - 1) * columns + height]));
  CHECK_NEAR(rows[(count - 1) * columns + z], 0.08, 1e-3);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

/* ---- on disk ---- */

/* Saved, freed and loaded again every 500 steps: in every phase, and while layers enter. */
static void it_goes_on_with_the_same_bits_from_every_phase(void **state) {
  (void)state;
  static const char *const phases[] = {"pack", "settle", "lift", "hold"};
  scree_scene_file *file = make_pot();
  scree_scene *whole = run_through(file, 1000000), *cut = pot_scene(file);
  size_t cuts[4] = {0}, partly_filled = 0;
  scree_error error;
  while (!scree_scene_end(cut)) {
    CHECK_OK(scree_scene_advance(cut, 500, &error), error);
    for (int i = 0; i < 4 && scree_scene_phase(cut); i++)
      cuts[i] += !strcmp(scree_scene_phase(cut), phases[i]);
    partly_filled += scree_world_body_count(scree_scene_view(cut)) < 12;
    CHECK_OK(scree_scene_save(cut, in_folder("cut"), true, &error), error);
    scree_scene_free(cut);
    CHECK_OK(scree_scene_load(in_folder("cut"), &cut, &error), error);
  }
  for (int i = 0; i < 4; i++) assert_true(cuts[i] > 0);
  assert_true(partly_filled > 0);
  check_same(whole, cut);
  assert_string_equal(scree_scene_shape_name(cut, 1), "chip");
  scree_scene_free(whole);
  scree_scene_free(cut);
  scree_scene_file_free(file);
}

static void a_frame_measures_as_the_scene_and_does_not_go_on(void **state) {
  (void)state;
  scree_scene_file *file = make_pot();
  scree_scene *scene = run_through(file, 1000000), *frame;
  scree_pile a, b;
  scree_error error;
  CHECK_OK(scree_scene_save_frame(scene, in_folder("frame"), true, &error), error);
  CHECK_OK(scree_scene_load(in_folder("frame"), &frame, &error), error);
  CHECK_OK(scree_scene_measure_pile(scene, 0, NULL, &a, &error), error);
  CHECK_OK(scree_scene_measure_pile(frame, 0, NULL, &b, &error), error);
  /* a frame's orientations are made unit again: the last bit may differ */
  CHECK_NEAR(a.repose.height, b.repose.height, 1e-12);
  CHECK_NEAR(a.repose.run_out, b.repose.run_out, 1e-12);
  CHECK_NEAR(a.packing_fraction, b.packing_fraction, 1e-12);
  assert_true(a.body_count == b.body_count && a.size == b.size);
  assert_true(scree_scene_is_frame(frame) && !scree_scene_is_frame(scene));
  assert_int_equal(scree_scene_advance(frame, 1, &error), SCREE_UNSUPPORTED);
  assert_int_equal(scree_scene_save(frame, in_folder("no"), true, &error), SCREE_UNSUPPORTED);
  scree_scene_free(scene);
  scree_scene_free(frame);
  scree_scene_file_free(file);
}

/* ---- whole ones in a folder ---- */

typedef struct pieces {
  size_t cancel_count, frame_count;
} pieces;

static bool watch(void *context, const scree_scene_state *state) {
  pieces *p = context;
  assert_true(state->fraction >= 0 && state->fraction <= 1);
  if (p->cancel_count == 0) return true;
  p->cancel_count--;
  return false;
}

static scree_status on_frame(void *context, scree_scene *scene, size_t index, scree_error *error) {
  (void)error;
  pieces *p = context;
  assert_int_equal(index, p->frame_count);
  assert_true(scree_world_time(scree_scene_view(scene)) >= 0.05 * (double)index ||
              scree_scene_end(scene)); /* one more at the end */
  p->frame_count++;
  return SCREE_OK;
}

static scree_scene_job job_of(const scree_scene_file *file, const char *into, pieces *context) {
  return (scree_scene_job){
      .file = file, .folder = into, .states = true, .watch = watch, .context = context};
}

static scree_status complete(const scree_scene_job *job, scree_error *error) {
  scree_scene *scene = NULL;
  scree_status status = scree_scene_complete(job, &scene, error);
  scree_scene_free(scene);
  return status;
}

static void an_interrupted_one_ends_as_an_uninterrupted_one(void **state) {
  (void)state;
  scree_scene_file *file = make_pot();
  set_field(file, "output.frame_interval", "0.05");
  scree_scene *whole = run_through(file, 1000000), *scene = NULL, *last;
  scree_error error;
  pieces context = {.cancel_count = 40};
  scree_scene_job job = job_of(file, in_folder("whole run"), &context);
  job.frame = on_frame;
  job.resume = true;
  size_t cancelled = 0;
  scree_status status;
  while ((status = scree_scene_complete(&job, &scene, &error)) == SCREE_CANCELLED) {
    cancelled++;
    scree_scene_free(scene);
    scene = NULL;
  }
  CHECK_OK(status, error);
  assert_int_equal(cancelled, 40);
  assert_int_equal(context.frame_count, 7); /* 0 to 0.25 s, and the end */
  check_same(whole, scene);
  assert_int_equal(scree_scene_get_costs(scene).piece_count, 41);
  scree_scene_free(scene);
  job.frame = NULL;
  /* one that is done is done at once */
  CHECK_OK(scree_scene_complete(&job, &scene, &error), error);
  check_same(whole, scene);
  CHECK_OK(scree_scene_load(in_folder("whole run/last.scree"), &last, &error), error);
  assert_true(scree_scene_is_frame(last));
  scree_scene_free(last);
  CHECK_OK(scree_scene_load(in_folder("whole run/frame-000003.scree"), &last, &error), error);
  scree_scene_free(last);
  scree_scene_free(scene);
  scree_scene_free(whole);
  scree_scene_file_free(file);
}

static void a_checkpoint_of_something_else_is_refused(void **state) {
  (void)state;
  scree_scene_file *file = make_pot();
  scree_error error;
  pieces context = {.cancel_count = 1};
  scree_scene_job job = job_of(file, in_folder("other"), &context);
  assert_int_equal(complete(&job, &error), SCREE_CANCELLED);
  assert_int_equal(complete(&job, &error), SCREE_EXISTS);
  job.resume = true;
  set_field(file, "friction_wall", "0.4");
  assert_int_equal(complete(&job, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "friction"));
  set_field(file, "friction_wall", "0.5");
  set_field(file, "shapes.ball.sphere", "0.021");
  assert_int_equal(complete(&job, &error), SCREE_BAD_ARGUMENT);
  set_field(file, "shapes.ball.sphere", "0.02");
  FILE *stream = fopen(in_folder("other/checkpoint.scree"), "wb");
  fputs("broken", stream);
  fclose(stream);
  job.folder = in_folder("other");
  assert_int_equal(complete(&job, &error), SCREE_BAD_FILE);
  job.folder = in_folder("nothing here");
  job.file = NULL;
  assert_int_equal(complete(&job, &error), SCREE_BAD_ARGUMENT);
  scree_scene_file_free(file);
}

/* Files may not grow past 2 KB, as on a full disk: it says so, and what was there stays. */
static void a_full_disk_ends_it_and_keeps_its_checkpoint(void **state) {
  (void)state;
  scree_scene_file *file = make_pot();
  scree_error error;
  pieces context = {.cancel_count = 1};
  scree_scene_job job = job_of(file, in_folder("full"), &context);
  job.resume = true;
  job.no_motion = true;
  assert_int_equal(complete(&job, &error), SCREE_CANCELLED);
  struct rlimit before, little;
  struct stat one, other;
  assert_int_equal(stat(in_folder("full/checkpoint.scree"), &one), 0);
  getrlimit(RLIMIT_FSIZE, &before);
  little = before;
  little.rlim_cur = 2048;
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &little);
  context.cancel_count = 1;
  scree_status status = complete(&job, &error);
  setrlimit(RLIMIT_FSIZE, &before);
  assert_int_equal(status, SCREE_IO);
  assert_non_null(strstr(error.message, "full/"));
  assert_non_null(strstr(error.message, "cannot write"));
  assert_int_equal(stat(in_folder("full/checkpoint.scree"), &other), 0);
  assert_int_equal(one.st_ino, other.st_ino);
  CHECK_OK(complete(&job, &error), error);
  scree_scene_file_free(file);
}

/* One that is to fail: what falls becomes too fast for its steps. */
static scree_scene_file *make_fast_pot(void) {
  scree_scene_file *file = make_pot();
  set_field(file, "gravity", "900");
  set_field(file, "contact.young_particle", "1e5");
  return file;
}

/* What one that fails leaves is a checkpoint like any other: it can be looked at, and leads to the
 * same failure. */
static void one_that_fails_leaves_a_state_that_goes_on(void **state) {
  (void)state;
  scree_scene_file *file = make_fast_pot();
  scree_scene *loaded;
  scree_error error, again;
  pieces context = {0};
  scree_scene_job job = job_of(file, in_folder("soft"), &context);
  assert_int_equal(complete(&job, &error), SCREE_DIVERGED);
  const char *known = strstr(error.message, "; the state of step ");
  assert_non_null(known);
  assert_non_null(strstr(known, "soft/stopped.scree"));
  CHECK_OK(scree_scene_load(in_folder("soft/stopped.scree"), &loaded, &error), error);
  uint64_t kept = scree_world_step_count(scree_scene_view(loaded));
  assert_true(scree_world_body_count(scree_scene_view(loaded)) > 0);
  assert_int_equal(scree_scene_advance(loaded, 1000000, &again), SCREE_DIVERGED);
  assert_true(scree_world_step_count(scree_scene_view(loaded)) > kept);
  /* saved after the failure it is refused */
  CHECK_OK(scree_scene_save(loaded, in_folder("soft/checkpoint.scree"), true, &error), error);
  scree_scene_free(loaded);
  job.resume = true;
  job.folder = in_folder("soft");
  assert_int_equal(complete(&job, &error), SCREE_BAD_FILE);
  assert_non_null(strstr(error.message, "had failed, and cannot go on: "));
  assert_non_null(strstr(error.message, "body"));
  char stopped[400];
  snprintf(stopped, sizeof stopped, "%s", in_folder("soft/stopped.scree"));
  assert_int_equal(rename(stopped, in_folder("soft/checkpoint.scree")), 0);
  job.folder = in_folder("soft");
  assert_int_equal(complete(&job, &error), SCREE_DIVERGED);
  assert_non_null(strstr(error.message, "soft/stopped.scree"));
  scree_scene_file_free(file);
}

static void one_that_fails_says_where_its_state_could_not_be_written(void **state) {
  (void)state;
  scree_scene_file *file = make_fast_pot();
  scree_error error;
  pieces context = {0};
  assert_int_equal(mkdir(in_folder("blocked"), 0777), 0);
  assert_int_equal(mkdir(in_folder("blocked/stopped.scree"), 0777), 0);
  scree_scene_job job = job_of(file, in_folder("blocked"), &context);
  assert_int_equal(complete(&job, &error), SCREE_DIVERGED);
  assert_non_null(strstr(error.message, "body"));
  assert_non_null(strstr(error.message, "its checkpoint could not be written: "));
  assert_non_null(strstr(error.message, "blocked/stopped.scree"));
  scree_scene_file_free(file);
}

/* ---- drops ---- */

/* Bodies that entered since `before` are inside and apart from all that is there; half: of the
 * container, its radius or the halves of its sides. */
static void check_entered(const scree_world *world, size_t before, bool box, const double half[2]) {
  for (size_t i = before; i < scree_world_body_count(world); i++) {
    scree_body a, b;
    scree_particle_measures ma, mb;
    scree_world_get_body(world, i, &a);
    scree_particle_measure(scree_world_body_particle(world, i), &ma);
    double x = fabs(a.position[0]), y = fabs(a.position[1]), r = ma.bounding_radius;
    assert_true(box ? x + r <= half[0] && y + r <= half[1] : sqrt(x * x + y * y) + r <= half[0]);
    for (size_t j = 0; j < i; j++) {
      scree_world_get_body(world, j, &b);
      scree_particle_measure(scree_world_body_particle(world, j), &mb);
      double d2 = 0;
      for (int k = 0; k < 3; k++) d2 += pow(a.position[k] - b.position[k], 2);
      assert_true(sqrt(d2) > r + mb.bounding_radius);
    }
  }
}

static scree_scene_file *drop_file(bool box) {
  scree_scene_file *file = template_of(box ? "drop-box" : "drop");
  set_field(file, "shapes",
            "{box: {box: [0.05, 0.03, 0.02], material: particles}, "
            "ball: {sphere: 0.024, material: particles}}");
  set_field(file, "inlets.fill.shapes", "{box: 7, ball: 6}");
  set_field(file, "inlets.fill.count", "13");
  set_field(file, "contact.stiffness_factor", "0.2");
  return file;
}

static void all_enter_apart_from_each_other(void **state) {
  (void)state;
  const char *const widths[] = {NULL, "0.0645", "0.1", "0.21"};
  for (int c = 0; c < 8; c++) {
    bool box = c / 4, deep = box && c % 4 == 2;
    scree_scene_file *file = drop_file(box);
    scree_error error;
    if (widths[c % 4]) set_field(file, "width", widths[c % 4]);
    if (deep) set_field(file, "depth", "0.3");
    scree_scene *scene = pot_scene(file);
    const scree_world *world = scree_scene_view(scene);
    double half[2] = {INFINITY, INFINITY};
    if (widths[c % 4]) half[0] = half[1] = 0.5 * atof(widths[c % 4]);
    if (deep) half[1] = 0.15;
    size_t shapes[2] = {0, 0}, entered = 0;
    for (int i = 0; i < 400000 && entered < 13; i++) {
      CHECK_OK(scree_scene_advance(scene, 1, &error), error);
      if (scree_world_body_count(world) == entered) continue;
      check_entered(world, entered, box, half);
      entered = scree_world_body_count(world);
    }
    assert_int_equal(entered, 13);
    for (size_t i = 0; i < 13; i++) shapes[scree_scene_body_shape(scene, i)]++;
    assert_int_equal(shapes[0], 7);
    assert_int_equal(shapes[1], 6);
    scree_scene_free(scene);
    scree_scene_file_free(file);
  }
}

/* Ends so long after the last has entered, or when all have been still for a while. */
static void a_drop_ends_as_asked(void **state) {
  (void)state;
  for (int still = 0; still < 2; still++) {
    scree_scene_file *file = drop_file(false);
    set_field(file, "time", still ? "5" : "0.02");
    set_field(file, "still", still ? "1e-3" : "0");
    scree_scene *scene = run_through(file, 1000000);
    size_t rows, columns = scree_scene_column_count(scene), row = 0;
    const double *series = scree_scene_series(scene, &rows);
    while (series[row * columns + column(scene, "entered")] < 13) row++;
    double since = scree_world_time(scree_scene_view(scene)) - series[row * columns];
    assert_string_equal(scree_scene_end(scene), still ? "still" : "the time after filling is over");
    assert_true(still ? since > 0.05 - 0.01 && since < 5 : since <= 0.025);
    scree_scene_free(scene);
    scree_scene_file_free(file);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_preset_takes_phones_and_long_ones),
      cmocka_unit_test(the_heap_scales_with_the_particles),
      cmocka_unit_test(settings_errors_say_line_column_value_and_limit),
      cmocka_unit_test(settings_are_judged_together),
      cmocka_unit_test(what_cannot_be_filled_is_refused_before_the_run),
      cmocka_unit_test(small_particles_fall_less_far),
      cmocka_unit_test(a_scan_gives_its_levels_their_mass),
      cmocka_unit_test(it_does_not_depend_on_how_it_is_cut),
      cmocka_unit_test(the_series_has_a_row_at_every_interval),
      cmocka_unit_test(it_goes_on_with_the_same_bits_from_every_phase),
      cmocka_unit_test(a_frame_measures_as_the_scene_and_does_not_go_on),
      cmocka_unit_test(an_interrupted_one_ends_as_an_uninterrupted_one),
      cmocka_unit_test(a_checkpoint_of_something_else_is_refused),
      cmocka_unit_test(a_full_disk_ends_it_and_keeps_its_checkpoint),
      cmocka_unit_test(one_that_fails_leaves_a_state_that_goes_on),
      cmocka_unit_test(one_that_fails_says_where_its_state_could_not_be_written),
      cmocka_unit_test(all_enter_apart_from_each_other),
      cmocka_unit_test(a_drop_ends_as_asked),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
