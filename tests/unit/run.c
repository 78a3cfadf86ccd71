#include "base/alloc.h"
#include "base/file.h"
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
#include <unistd.h>

/* A box by its sides, m. */
static scree_particle *box(double x, double y, double z) {
  return shape_particle(shape_box(x, y, z));
}

static scree_experiment preset(const char *name) {
  scree_experiment e;
  scree_error error;
  CHECK_OK(scree_experiment_preset(name, &e, &error), error);
  return e;
}

/* Closed phones, and clamshells of 188 mm. */
static void every_preset_takes_phones_and_long_ones(void **state) {
  (void)state;
  scree_run_shape shapes[2] = {{.particle = box(0.1, 0.05, 0.015), .density_factor = 1},
                               {.particle = box(0.188, 0.05, 0.02), .density_factor = 1}};
  for (size_t i = 0; scree_preset_name(i); i++)
    for (size_t first = 0; first < 2; first++) {
      scree_experiment e = preset(scree_preset_name(i));
      scree_run *run;
      scree_error error;
      CHECK_OK(scree_run_create(&e, shapes + first, 2 - first, &run, &error), error);
      assert_int_equal(scree_run_phase(run), SCREE_PHASE_PACK);
      assert_true(scree_run_fraction(run) == 0);
      scree_run_free(run);
      scree_experiment_free(&e);
    }
  for (int i = 0; i < 2; i++) scree_particle_free(shapes[i].particle);
}

static void what_cannot_be_filled_is_refused_before_the_run(void **state) {
  (void)state;
  scree_run_shape shape = {.particle = box(0.1, 0.05, 0.015), .density_factor = 1};
  scree_experiment e = preset("paper");
  scree_run *run;
  scree_error error;
  e.cylinder_diameter = 0.05;
  assert_int_equal(scree_run_create(&e, &shape, 1, &run, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "does not fit into the cylinder of 50 mm"));
  e.cylinder_diameter = 0.4;
  e.pack_time = 0.2;
  assert_int_equal(scree_run_create(&e, &shape, 1, &run, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "set phases.pack_time to"));
  e.pack_time = 6;
  shape.density_factor = 0;
  assert_int_equal(scree_run_create(&e, &shape, 1, &run, &error), SCREE_BAD_ARGUMENT);
  scree_experiment_free(&e);
  scree_particle_free(shape.particle);
}

/* A hundred shapes of one material, each of its own density: a scan's mass on its levels. */
static void each_shape_has_its_density(void **state) {
  (void)state;
  enum { COUNT = 100 };
  scree_run_shape shapes[COUNT];
  scree_particle *ball;
  scree_run *run;
  scree_error error;
  CHECK_OK(scree_particle_sphere(0.01, &ball, &error), error);
  for (int i = 0; i < COUNT; i++)
    shapes[i] = (scree_run_shape){.particle = ball, .density_factor = 1 + 0.01 * i};
  scree_experiment e = preset("paper");
  use_pot(&e, COUNT);
  CHECK_OK(scree_run_create(&e, shapes, COUNT, &run, &error), error);
  while (scree_run_phase(run) == SCREE_PHASE_PACK)
    CHECK_OK(scree_run_advance(run, 200, &error), error);
  const scree_world *world = scree_run_world(run);
  double volume = 4 / 3.0 * 3.14159265358979 * 1e-6, heavy = 0, light = INFINITY, sum = 0;
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    double mass = scree_world_body_mass(world, i);
    heavy = fmax(heavy, mass), light = fmin(light, mass), sum += mass;
    assert_int_equal(scree_world_body_material(world, i), scree_world_body_material(world, 0));
  }
  assert_int_equal(scree_world_body_count(world), COUNT);
  assert_true(fabs(light / (e.density * volume) - 1) < 1e-9);
  assert_true(fabs(heavy / (e.density * volume) - 1.99) < 1e-9);
  assert_true(fabs(sum / (e.density * volume) - 149.5) < 1e-7);
  scree_run_free(run);
  scree_experiment_free(&e);
  scree_particle_free(ball);
}

/* ---- a run of six spheres and six chips through all phases ---- */

typedef struct pot {
  scree_experiment experiment;
  scree_run_shape shapes[2];
} pot;

static pot make_pot(void) {
  pot p = {.experiment = preset("paper")};
  scree_experiment *e = &p.experiment;
  use_pot(e, 12);
  e->series_interval = 0.01;
  e->angle_interval = 0.02;
  scree_error error;
  CHECK_OK(scree_particle_sphere(0.01, &p.shapes[0].particle, &error), error);
  p.shapes[1].particle = box(0.02, 0.012, 0.006);
  p.shapes[0].density_factor = p.shapes[1].density_factor = 1;
  p.shapes[1].name = "chip";
  return p;
}

static void free_pot(pot *p) {
  for (int i = 0; i < 2; i++) scree_particle_free(p->shapes[i].particle);
  scree_experiment_free(&p->experiment);
}

static scree_run *start(const pot *p) {
  scree_run *run;
  scree_error error;
  CHECK_OK(scree_run_create(&p->experiment, p->shapes, 2, &run, &error), error);
  return run;
}

static void check_same_runs(scree_run *a, scree_run *b) {
  scree_checksum ha = scree_world_hash(scree_run_world(a)),
                 hb = scree_world_hash(scree_run_world(b));
  size_t na, nb;
  const scree_run_point *pa = scree_run_series(a, &na), *pb = scree_run_series(b, &nb);
  assert_memory_equal(&ha, &hb, sizeof ha);
  assert_int_equal(na, nb);
  for (size_t i = 0; i < na; i++) {
    assert_true(pa[i].time == pb[i].time && pa[i].kinetic == pb[i].kinetic);
    assert_true(pa[i].mean_rotation == pb[i].mean_rotation);
    assert_true(pa[i].coordination == pb[i].coordination);
    assert_true(pa[i].phase == pb[i].phase && pa[i].body_count == pb[i].body_count);
    assert_true(pa[i].height == pb[i].height || (isnan(pa[i].height) && isnan(pb[i].height)));
  }
}

static scree_run *run_through(const pot *p, size_t steps_a_call) {
  scree_run *run = start(p);
  scree_error error;
  double fraction = 0;
  scree_phase phase = SCREE_PHASE_PACK;
  while (scree_run_phase(run) != SCREE_PHASE_DONE) {
    CHECK_OK(scree_run_advance(run, steps_a_call, &error), error);
    assert_true(scree_run_fraction(run) >= fraction);
    assert_true(scree_run_phase(run) >= phase);
    fraction = scree_run_fraction(run);
    phase = scree_run_phase(run);
  }
  return run;
}

static void a_run_does_not_depend_on_how_it_is_cut(void **state) {
  (void)state;
  pot p = make_pot();
  scree_run *a = run_through(&p, 1000000), *b = run_through(&p, 137);
  check_same_runs(a, b);
  CHECK_NEAR(scree_run_cylinder_height(a), 0.08, 1e-3);
  scree_run_result result;
  scree_error error;
  CHECK_OK(scree_run_measure(a, &result, &error), error);
  assert_true(result.repose.peak > 0.005 && result.repose.peak < 0.2);
  assert_true(result.packing_fraction > 0.05 && result.packing_fraction < 1);
  assert_int_equal(result.body_count + result.left_count, 12);
  scree_run_free(a);
  scree_run_free(b);
  free_pot(&p);
}

static void the_series_has_a_point_at_every_interval(void **state) {
  (void)state;
  pot p = make_pot();
  scree_run *run = run_through(&p, 1000000);
  size_t count, angles = 0;
  const scree_run_point *points = scree_run_series(run, &count);
  scree_run_costs costs;
  scree_run_get_costs(run, &costs);
  assert_true(count == 26 || count == 27); /* 0.25 s by 0.01 s, and the end */
  for (size_t i = 0; i + 1 < count; i++) {
    CHECK_NEAR(points[i].time, 0.01 * (double)i, costs.time_step);
    assert_true(points[i].time >= 0.01 * (double)i - 1e-12);
    angles += !isnan(points[i].height);
    if (!isnan(points[i].height)) assert_true(points[i].phase >= SCREE_PHASE_LIFT);
  }
  assert_true(angles >= 4 && angles <= 6);
  assert_false(isnan(points[count - 1].height));
  assert_int_equal(points[count - 1].phase, SCREE_PHASE_DONE);
  assert_true(costs.particle_steps > 0 && costs.particle_steps <= 12 * costs.step_count);
  scree_run_free(run);
  free_pot(&p);
}

/* ---- on disk ---- */

/* Saved, freed and loaded again every 500 steps: in every phase, and while layers enter. */
static void a_run_goes_on_with_the_same_bits_from_every_phase(void **state) {
  (void)state;
  pot p = make_pot();
  scree_run *whole = run_through(&p, 1000000), *cut = start(&p);
  size_t cuts[SCREE_PHASE_DONE] = {0}, partly_filled = 0;
  scree_error error;
  while (scree_run_phase(cut) != SCREE_PHASE_DONE) {
    CHECK_OK(scree_run_advance(cut, 500, &error), error);
    if (scree_run_phase(cut) != SCREE_PHASE_DONE) cuts[scree_run_phase(cut)]++;
    partly_filled += scree_world_body_count(scree_run_world(cut)) < 12;
    CHECK_OK(scree_run_save(cut, in_folder("cut"), true, &error), error);
    scree_run_free(cut);
    CHECK_OK(scree_run_load(in_folder("cut"), &cut, &error), error);
  }
  for (int i = 0; i < SCREE_PHASE_DONE; i++) assert_true(cuts[i] > 0);
  assert_true(partly_filled > 0);
  check_same_runs(whole, cut);
  scree_run_shape shape;
  scree_run_get_shape(cut, 1, &shape);
  assert_string_equal(shape.name, "chip");
  scree_run_free(whole);
  scree_run_free(cut);
  free_pot(&p);
}

static void a_frame_measures_as_the_run_and_does_not_go_on(void **state) {
  (void)state;
  pot p = make_pot();
  scree_run *run = run_through(&p, 1000000), *frame;
  scree_run_result a, b;
  scree_error error;
  CHECK_OK(scree_run_save_frame(run, in_folder("frame"), true, &error), error);
  CHECK_OK(scree_run_load(in_folder("frame"), &frame, &error), error);
  CHECK_OK(scree_run_measure(run, &a, &error), error);
  CHECK_OK(scree_run_measure(frame, &b, &error), error);
  /* a frame's orientations are made unit again: the last bit may differ */
  CHECK_NEAR(a.repose.height, b.repose.height, 1e-12);
  CHECK_NEAR(a.repose.run_out, b.repose.run_out, 1e-12);
  CHECK_NEAR(a.packing_fraction, b.packing_fraction, 1e-12);
  CHECK_NEAR(a.coordination, b.coordination, 0);
  assert_true(a.time == b.time && a.body_count == b.body_count && a.left_count == b.left_count);
  assert_true(scree_run_is_frame(frame) && !scree_run_is_frame(run));
  assert_int_equal(scree_run_advance(frame, 1, &error), SCREE_UNSUPPORTED);
  assert_int_equal(scree_run_save(frame, in_folder("no"), true, &error), SCREE_UNSUPPORTED);
  scree_run_free(run);
  scree_run_free(frame);
  free_pot(&p);
}

/* Every byte of a checkpoint counts, and so does its end. */
static void damaged_checkpoints_are_refused(void **state) {
  (void)state;
  pot p = make_pot();
  scree_run *run = start(&p), *loaded;
  scree_error error;
  char *bytes;
  size_t count;
  CHECK_OK(scree_run_advance(run, 3000, &error), error);
  CHECK_OK(scree_run_save(run, in_folder("whole"), true, &error), error);
  CHECK_OK(scree_file_read(in_folder("whole"), 0, &bytes, &count, &error), error);
  for (size_t i = 0; i < count + 40; i += i < 60 ? 1 : count / 50) {
    size_t length = i < count ? count : i - count;
    FILE *stream = fopen(in_folder("bad"), "wb");
    if (i < count) bytes[i] ^= 0x10;
    assert_int_equal(fwrite(bytes, 1, length, stream), length);
    if (i < count) bytes[i] ^= 0x10;
    fclose(stream);
    assert_int_equal(scree_run_load(in_folder("bad"), &loaded, &error), SCREE_BAD_FILE);
    assert_non_null(strstr(error.message, "bad: "));
  }
  scree_free(bytes);
  scree_run_free(run);
  free_pot(&p);
}

/* ---- whole runs in a folder ---- */

typedef struct pieces {
  size_t cancel_count, frame_count;
} pieces;

static bool watch(void *context, const scree_run_state *state) {
  pieces *p = context;
  assert_true(state->fraction >= 0 && state->fraction <= 1);
  if (p->cancel_count == 0) return true;
  p->cancel_count--;
  return false;
}

static scree_status on_frame(void *context, scree_run *run, size_t index, scree_error *error) {
  (void)error;
  pieces *p = context;
  assert_int_equal(index, p->frame_count);
  assert_true(scree_world_time(scree_run_world(run)) >= 0.05 * (double)index);
  p->frame_count++;
  return SCREE_OK;
}

static scree_run_job job_of(const pot *p, const char *into, pieces *context) {
  return (scree_run_job){.experiment = &p->experiment,
                         .shapes = p->shapes,
                         .shape_count = 2,
                         .folder = into,
                         .watch = watch,
                         .context = context};
}

static void an_interrupted_run_ends_as_an_uninterrupted_one(void **state) {
  (void)state;
  pot p = make_pot();
  p.experiment.frame_interval = 0.05;
  scree_run *whole = run_through(&p, 1000000), *run, *last;
  scree_error error;
  pieces context = {.cancel_count = 40};
  scree_run_job job = job_of(&p, in_folder("whole run"), &context);
  job.frame = on_frame;
  job.resume = true;
  size_t cancelled = 0;
  scree_status status;
  while ((status = scree_run_complete(&job, &run, &error)) == SCREE_CANCELLED) cancelled++;
  CHECK_OK(status, error);
  assert_int_equal(cancelled, 40);
  assert_int_equal(context.frame_count, 6); /* 0 to 0.25 s */
  check_same_runs(whole, run);
  scree_run_costs costs;
  scree_run_get_costs(run, &costs);
  assert_int_equal(costs.piece_count, 41);
  scree_run_free(run);
  /* a run that is done is done at once */
  CHECK_OK(scree_run_complete(&job, &run, &error), error);
  check_same_runs(whole, run);
  CHECK_OK(scree_run_load(in_folder("whole run/last.scree"), &last, &error), error);
  assert_true(scree_run_is_frame(last));
  scree_run_free(last);
  CHECK_OK(scree_run_load(in_folder("whole run/frame-0003.scree"), &last, &error), error);
  scree_run_free(last);
  scree_run_free(run);
  scree_run_free(whole);
  free_pot(&p);
}

static void a_checkpoint_of_something_else_is_refused(void **state) {
  (void)state;
  pot p = make_pot();
  scree_run *run;
  scree_error error;
  pieces context = {.cancel_count = 1};
  scree_run_job job = job_of(&p, in_folder("other"), &context);
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_CANCELLED);
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_EXISTS);
  job.resume = true;
  p.experiment.friction_wall = 0.4;
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "contact.friction_wall is 0.5 there and 0.4 here"));
  const scree_run_shape *shapes = job.shapes;
  job.shapes = NULL;
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "contact.friction_wall is 0.5 there and 0.4 here"));
  job.shapes = shapes;
  p.experiment.friction_wall = 0.5;
  p.shapes[0].density_factor = 1.1;
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "other shapes"));
  p.shapes[0].density_factor = 1;
  FILE *stream = fopen(in_folder("other/checkpoint.scree"), "wb");
  fputs("broken", stream);
  fclose(stream);
  job.folder = in_folder("other");
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_BAD_FILE);
  job.folder = in_folder("nothing here");
  job.experiment = NULL;
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_BAD_ARGUMENT);
  free_pot(&p);
}

/* Files may not grow past 2 KB, as on a full disk: the run says so, and what was there stays. */
static void a_full_disk_ends_a_run_and_keeps_its_checkpoint(void **state) {
  (void)state;
  pot p = make_pot();
  scree_run *run;
  scree_error error;
  pieces context = {.cancel_count = 1};
  scree_run_job job = job_of(&p, in_folder("full"), &context);
  job.resume = true;
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_CANCELLED);
  struct rlimit before, little;
  struct stat one, other;
  assert_int_equal(stat(in_folder("full/checkpoint.scree"), &one), 0);
  getrlimit(RLIMIT_FSIZE, &before);
  little = before;
  little.rlim_cur = 2048;
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &little);
  context.cancel_count = 1;
  scree_status status = scree_run_complete(&job, &run, &error);
  setrlimit(RLIMIT_FSIZE, &before);
  assert_int_equal(status, SCREE_IO);
  assert_non_null(strstr(error.message, "full/checkpoint.scree: cannot write"));
  assert_int_equal(stat(in_folder("full/checkpoint.scree"), &other), 0);
  assert_int_equal(one.st_ino, other.st_ino);
  CHECK_OK(scree_run_complete(&job, &run, &error), error);
  scree_run_free(run);
  free_pot(&p);
}

/* A run that is to fail: its particles are far too soft. */
static pot make_soft_pot(void) {
  pot p = make_pot();
  p.experiment.young_particle = 6e3;
  return p;
}

/* What a run that fails leaves is a checkpoint like any other: it can be looked at, and leads to
 * the same failure; without the cause it goes on. */
static void a_run_that_fails_leaves_a_state_that_goes_on(void **state) {
  (void)state;
  pot p = make_soft_pot();
  scree_run *run, *loaded;
  scree_error error, again;
  pieces context = {0};
  scree_run_job job = job_of(&p, in_folder("soft"), &context);
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_DIVERGED);
  const char *known = strstr(error.message, "; the state of step ");
  assert_non_null(known);
  assert_non_null(strstr(known, "soft/stopped.scree"));
  CHECK_OK(scree_run_load(in_folder("soft/stopped.scree"), &loaded, &error), error);
  uint64_t kept = scree_world_step_count(scree_run_world(loaded));
  assert_int_equal(kept, strtoull(known + strlen("; the state of step "), NULL, 10));
  assert_true(scree_world_body_count(scree_run_world(loaded)) > 0);
  assert_int_equal(scree_run_advance(loaded, 1000000, &again), SCREE_DIVERGED);
  assert_true(scree_world_step_count(scree_run_world(loaded)) > kept);
  assert_int_equal(strncmp(again.message, error.message, (size_t)(known - error.message)), 0);
  /* as a checkpoint it goes on as far as that; saved after the failure it is refused */
  CHECK_OK(scree_run_save(loaded, in_folder("soft/checkpoint.scree"), true, &error), error);
  scree_run_free(loaded);
  job.resume = true;
  job.folder = in_folder("soft");
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_BAD_FILE);
  assert_non_null(strstr(error.message, "was saved after its run had failed, and cannot go on: "));
  assert_non_null(strstr(error.message, "overlaps"));
  char stopped[4096];
  snprintf(stopped, sizeof stopped, "%s", in_folder("soft/stopped.scree"));
  assert_int_equal(rename(stopped, in_folder("soft/checkpoint.scree")), 0);
  job.folder = in_folder("soft");
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_DIVERGED);
  assert_non_null(strstr(error.message, "soft/stopped.scree"));
  free_pot(&p);
}

static void a_failed_run_says_where_its_state_could_not_be_written(void **state) {
  (void)state;
  pot p = make_soft_pot();
  scree_run *run;
  scree_error error;
  pieces context = {0};
  scree_run_job job = job_of(&p, in_folder("blocked"), &context);
  assert_int_equal(mkdir(in_folder("blocked"), 0777), 0);
  assert_int_equal(mkdir(in_folder("blocked/stopped.scree"), 0777), 0);
  job.folder = in_folder("blocked");
  assert_int_equal(scree_run_complete(&job, &run, &error), SCREE_DIVERGED);
  assert_non_null(strstr(error.message, "overlaps"));
  assert_non_null(strstr(error.message, "its checkpoint could not be written: "));
  assert_non_null(strstr(error.message, "blocked/stopped.scree"));
  free_pot(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_preset_takes_phones_and_long_ones),
      cmocka_unit_test(what_cannot_be_filled_is_refused_before_the_run),
      cmocka_unit_test(each_shape_has_its_density),
      cmocka_unit_test(a_run_does_not_depend_on_how_it_is_cut),
      cmocka_unit_test(the_series_has_a_point_at_every_interval),
      cmocka_unit_test(a_run_goes_on_with_the_same_bits_from_every_phase),
      cmocka_unit_test(a_frame_measures_as_the_run_and_does_not_go_on),
      cmocka_unit_test(damaged_checkpoints_are_refused),
      cmocka_unit_test(an_interrupted_run_ends_as_an_uninterrupted_one),
      cmocka_unit_test(a_checkpoint_of_something_else_is_refused),
      cmocka_unit_test(a_full_disk_ends_a_run_and_keeps_its_checkpoint),
      cmocka_unit_test(a_run_that_fails_leaves_a_state_that_goes_on),
      cmocka_unit_test(a_failed_run_says_where_its_state_could_not_be_written),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
