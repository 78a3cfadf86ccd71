/* Studies: the plan, the designs, leases, records, work by several and the death of workers. */
#include "base/alloc.h"
#include "base/file.h"
#include "base/rng.h"
#include "base/yaml.h"
#include "report/program.h"
#include "scene/motions.h"
#include "scene/scene.h"
#include "study/design.h"
#include "study/lease.h"
#include "study/record.h"
#include "support/check.h"
#include "support/folder.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char *file_with(const char *name, const char *text) {
  const char *path = in_folder(name);
  FILE *file = fopen(path, "w");
  fputs(text, file);
  fclose(file);
  return path;
}

/* ---- designs ---- */

/* scipy 1.10: qmc.Sobol(10, scramble=False).random(8)[[1, 2, 3, 5, 7]]. */
static void sobol_as_by_scipy(void **state) {
  (void)state;
  static const size_t index[] = {1, 2, 3, 5, 7};
  static const double expected[5][10] = {
      {.5, .5, .5, .5, .5, .5, .5, .5, .5, .5},
      {.75, .25, .25, .25, .75, .75, .25, .75, .75, .75},
      {.25, .75, .75, .75, .25, .25, .75, .25, .25, .25},
      {.875, .875, .125, .375, .875, .625, .875, .375, .375, .125},
      {.125, .625, .375, .125, .125, .375, .625, .625, .625, .875}};
  for (int i = 0; i < 5; i++)
    for (size_t d = 0; d < 10; d++)
      assert_true(scree_sobol_digits(index[i], d) * 0x1p-32 == expected[i][d]);
}

/* Every interval of 1/n holds one point, in each dimension. */
static bool is_stratified(const double *unit, size_t n, size_t dimensions) {
  for (size_t d = 0; d < dimensions; d++) {
    bool seen[64] = {false};
    for (size_t i = 0; i < n; i++) {
      double u = unit[i * dimensions + d];
      if (!(u >= 0 && u < 1) || seen[(size_t)(u * (double)n)]) return false;
      seen[(size_t)(u * (double)n)] = true;
    }
  }
  return true;
}

static void designs_fill_space(void **state) {
  (void)state;
  double unit[64 * 10], longer[64 * 10];
  size_t order[64];
  for (uint64_t seed = 0; seed < 300; seed++) {
    size_t n = 1 + seed % 64;
    scree_design_latin(seed, n, 7, order, unit);
    assert_true(is_stratified(unit, n, 7));
    scree_design_sobol(seed, 32, 10, unit);
    assert_true(is_stratified(unit, 32, 10));
    scree_design_sobol(seed, 64, 10, longer);
    assert_memory_equal(unit, longer, 32 * 10 * sizeof *unit);
  }
}

/* ---- the plan ---- */

static scree_plan run_plan(const scree_study *study, size_t run, scree_arena *arena) {
  scree_scene_file *file;
  scree_plan plan;
  scree_error error;
  CHECK_OK(scree_study_run_scene(study, run, &file, &error), error);
  CHECK_OK(scree_scene_file_plan(file, arena, &plan, &error), error);
  scree_scene_file_free(file);
  return plan;
}

static void a_plan_follows_from_its_file(void **state) {
  (void)state;
  const char *text = "name: plan\nseed: 7\nreplicates: 3\nbase: {preset: demo}\n"
                     "factors:\n  shapes: [sample:box, [sample:sphere, a.stl]]\n"
                     "  rp: [1e-3, spheres]\n  friction_all: {from: 0.1, to: 0.5, "
                     "levels: 3}\n";
  scree_study *study;
  scree_study_run run;
  scree_error error;
  CHECK_OK(scree_study_read(file_with("plan.yaml", text), &study, &error), error);
  assert_int_equal(scree_study_run_count(study), 2 * 2 * 3 * 3);
  CHECK_OK(scree_study_get_run(study, 12 + 10, &run, &error), error);
  assert_int_equal(run.point, 10);
  assert_int_equal(run.replicate, 1);
  assert_int_equal(run.seed, 8);
  assert_string_equal(run.label, "shapes sphere+a, rp spheres, friction_all 0.3");
  assert_string_equal(run.shapes, "sphere+a");
  scree_arena arena = {0};
  scree_plan plan = run_plan(study, 12 + 10, &arena);
  const scree_plan_material *materials = plan.materials.items; /* wall, grain */
  assert_true(materials[0].friction == 0.3 && materials[1].friction == 0.3 && plan.seed == 8);
  scree_arena_free(&arena);
  char beside[160];
  snprintf(beside, sizeof beside, "%s", in_folder("a.stl"));
  assert_string_equal(study->shapes[2].path, beside); /* relative to the study's file */
  assert_int_equal(scree_study_get_run(study, 36, &run, &error), SCREE_BAD_ARGUMENT);
  scree_study_free(study);
}

static void a_filling_design_stays_in_its_ranges(void **state) {
  (void)state;
  for (int sobol = 0; sobol < 2; sobol++) {
    char changed[400];
    snprintf(changed, sizeof changed,
             "replicates: 2\nshapes: [sample:box]\ndesign: %s\npoints: 20\nfactors:\n"
             "  particles: {from: 10, to: 30}\n"
             "  phases.lift_speed: {from: 0.01, to: 1, scale: log}\n  rp: [1e-2, spheres]\n",
             sobol ? "sobol" : "latin");
    scree_study *study;
    scree_error error;
    CHECK_OK(scree_study_read(file_with("fill.yaml", changed), &study, &error), error);
    assert_int_equal(scree_study_run_count(study), 40);
    size_t slow = 0, spheres = 0;
    for (size_t i = 0; i < 20; i++) {
      scree_arena arena = {0};
      scree_plan plan = run_plan(study, i, &arena);
      size_t count = ((const scree_plan_inlet *)plan.inlets.items)->count;
      const scree_plan_geometry *cylinder = &((const scree_plan_geometry *)plan.geometry.items)[1];
      vec3 velocity, spin;
      assert_true(
          scree_motion_velocity(&cylinder->motion.items[0], (vec3){0, 0, 0}, &velocity, &spin));
      double speed = velocity.z;
      assert_true(count >= 10 && count <= 30);
      assert_true(speed >= 0.01 && speed <= 1);
      slow += speed < 0.1;
      scree_arena_free(&arena);
      spheres += !strcmp(study->points[i].rp, "spheres");
    }
    assert_in_range(slow, 8, 12);
    assert_in_range(spheres, 8, 12);
    scree_study_free(study);
  }
}

static void errors_say_line_column_and_limit(void **state) {
  (void)state;
  static const struct {
    const char *text, *message;
  } cases[] = {
      {"replicates: 0\nshapes: [sample:box]\n", "line 1, column 13: replicates: 0: must be 1 to"},
      {"shapes: [sample:bax]\n", "line 1, column 10: no built-in sample 'sample:bax'"},
      {"shapes: [a.stl, a.stl]\n", "line 1, column 17: the shape 'a.stl' stands here twice"},
      {"name: x\n", "needs shapes:"},
      {"shapes: [sample:box]\ncolour: red\n", "line 2, column 1: no field 'colour' in a study"},
      {"shapes: [sample:box]\nfactors: {rp: [2]}\n",
       "line 2, column 16: rp: '2': must be a number"},
      {"shapes: [sample:box]\nfactors: {rp: [0*recommended]}\n",
       "must be a number above 0 and at most 1, recommended, a multiple"},
      {"shapes: [sample:box]\nfactors: {rp: [1e-3, 1e-3]}\n", "the level '1e-3' stands here twice"},
      {"shapes: [sample:box]\nfactors: {contact: {restitution: [0.3, 3]}}\n",
       "line 2, column 40: contact.restitution: 3: must be 0.01 to 1"},
      {"shapes: [sample:box]\nfactors: {wetness: [1]}\n", "line 2, column 21: no field 'wetness'"},
      {"shapes: [sample:box]\nfactors: {seed: [1, 2]}\n", "seed is no factor"},
      {"shapes: [sample:box]\nfactors: {rp: 1e-3}\n", "must be a list of levels"},
      {"shapes: [sample:box]\nfactors: {gravity: {from: 1, to: 9}}\n", "needs levels: N"},
      {"shapes: [sample:box]\nfactors: {gravity: {from: 9, to: 1, levels: 3}}\n",
       "from must be below to"},
      {"shapes: [sample:box]\nfactors: {gravity: {from: 0, to: 1, scale: log, levels: 3}}\n",
       "must be above 0 on a log scale"},
      {"shapes: [sample:box]\nfactors: {gravity: {from: 1, to: 2, steps: 3}}\n",
       "no field 'steps' in a range"},
      {"shapes: [sample:box]\ndesign: sobol\n", "this design needs points: N"},
      {"shapes: [sample:box]\npoints: 3\n", "points belongs to design latin or sobol"},
      {"shapes: [sample:box]\nbase: {preset: huge}\n", "line 2, column 16: no preset 'huge'"},
      {"shapes: [sample:box]\nbase:\n  contact:\n    law: cubic\n",
       "line 4, column 10: contact.law"},
      {"shapes: [sample:box]\nbase: {measure: {band_low: 0.9}}\n", "must be below"},
      {"shapes: [sample:box]\nfactors: {shapes: [sample:box]}\n", "both by itself and as a factor"},
      {"shapes: [sample:box]\nanalysis: {angle: steep}\n", "must be one of sector|cone|silhouette"},
      {"shapes: [sample:box]\nshapes: [sample:box]\n", "stands here twice"},
      {"- 1\n", "a study is `key: value` lines"},
      {"shapes: {a: 1}\n", "must be files or sample:NAME"},
      {"shapes: [sample:box\n", "line 2, column 1"},
      {"shapes: []\n", "must be files or sample:NAME"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    scree_study *study = NULL;
    scree_error error;
    assert_int_not_equal(scree_study_read(file_with("bad.yaml", cases[i].text), &study, &error),
                         SCREE_OK);
    assert_null(study);
    if (!strstr(error.message, cases[i].message))
      fail_msg("got '%s', expected '%s'", error.message, cases[i].message);
  }
}

/* ---- leases ---- */

static void a_lease_has_one_holder(void **state) {
  (void)state;
  scree_lease lease, second;
  scree_error error;
  bool taken, kept;
  CHECK_OK(scree_lease_take(in_folder("."), "one", 100, "me", &taken, &lease, &error), error);
  assert_true(taken);
  CHECK_OK(scree_lease_take(in_folder("."), "one", 100, "you", &taken, &second, &error), error);
  assert_false(taken);
  CHECK_OK(scree_lease_renew(&lease, "running 0.5 lifting", &kept, &error), error);
  assert_true(kept);
  scree_lease_view view = scree_lease_look(in_folder("."), "one", 100);
  assert_true(view.held && view.alive);
  assert_string_equal(view.worker, "me");
  assert_string_equal(view.note, "running 0.5 lifting");
  scree_lease_release(&lease);
  CHECK_OK(scree_lease_take(in_folder("."), "one", 100, "you", &taken, &second, &error), error);
  assert_true(taken);
  scree_lease_release(&second);
  assert_int_equal(scree_lease_deaths(in_folder("."), "one", NULL), 0);
}

/* Takes the lease in a child that dies with it. */
static void die_with(const char *name) {
  pid_t child = fork();
  if (child == 0) {
    scree_lease lease;
    bool taken = false;
    scree_lease_take(in_folder("."), name, 100, "victim", &taken, &lease, NULL);
    raise(SIGKILL);
  }
  int status;
  waitpid(child, &status, 0);
}

static void the_dead_on_this_machine_are_known_at_once(void **state) {
  (void)state;
  scree_lease lease;
  scree_error error;
  char last[SCREE_LEASE_NAME];
  bool taken;
  for (int deaths = 1; deaths <= 3; deaths++) {
    die_with("dead");
    CHECK_OK(scree_lease_take(in_folder("."), "dead", 1000, "heir", &taken, &lease, &error), error);
    assert_true(taken);
    scree_lease_release(&lease);
    assert_int_equal(scree_lease_deaths(in_folder("."), "dead", last), deaths);
    assert_string_equal(last, "victim");
  }
  scree_lease_forget_deaths(in_folder("."), "dead");
  assert_int_equal(scree_lease_deaths(in_folder("."), "dead", NULL), 0);
}

/* As if written elsewhere, so many seconds ago. */
static void write_foreign(const char *name, double age) {
  const char *path = file_with(name, "token\nelsewhere boot ns\n1\n1\nfar\nrunning 0.5 lifting\n");
  struct timespec times[2];
  clock_gettime(CLOCK_REALTIME, &times[0]);
  times[0].tv_sec -= (time_t)age;
  times[1] = times[0];
  utimensat(AT_FDCWD, path, times, 0);
}

static void leases_of_other_machines_expire(void **state) {
  (void)state;
  scree_lease lease;
  scree_error error;
  bool taken, kept;
  write_foreign("far", 50);
  CHECK_OK(scree_lease_take(in_folder("."), "far", 100, "me", &taken, &lease, &error), error);
  assert_false(taken);
  CHECK_OK(scree_lease_take(in_folder("."), "far", 20, "me", &taken, &lease, &error), error);
  assert_true(taken);
  assert_int_equal(scree_lease_deaths(in_folder("."), "far", NULL), 1);
  write_foreign("far", 0); /* somebody took it from us */
  CHECK_OK(scree_lease_renew(&lease, "running", &kept, &error), error);
  assert_false(kept);
  scree_lease_release(&lease); /* must not take theirs away */
  assert_int_equal(access(in_folder("far"), F_OK), 0);
}

/* Many processes that want the same lease again and again: never two at once. */
static void of_many_one_wins(void **state) {
  (void)state;
  enum { PROCESSES = 6, TURNS = 40 };
  for (int p = 0; p < PROCESSES; p++)
    if (fork() == 0) {
      int held = 0;
      for (int i = 0; i < 100000 && held < TURNS; i++) {
        scree_lease lease;
        bool taken;
        if (scree_lease_take(in_folder("."), "many", 100, "w", &taken, &lease, NULL) != SCREE_OK)
          _exit(2);
        if (!taken) continue;
        int alone = open(in_folder("alone"), O_CREAT | O_EXCL | O_WRONLY, 0666);
        if (alone < 0) _exit(3);
        close(alone);
        unlink(in_folder("alone"));
        scree_lease_release(&lease);
        held++;
      }
      _exit(held == TURNS ? 0 : 4);
    }
  for (int p = 0; p < PROCESSES; p++) {
    int status;
    wait(&status);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
  }
  assert_int_equal(scree_lease_deaths(in_folder("."), "many", NULL), 0);
}

/* ---- records ---- */

static void records_read_back_the_same_or_not_at_all(void **state) {
  (void)state;
  scree_record_point series[3] = {
      {.time = 0.1, .phase = 2, .body_count = 3, .mean_rotation = 1.0 / 3, .sector_deg = NAN}};
  scree_study_record record = {.reason = "a \"quoted\"\\ reason\n",
                               .worker = "w",
                               .started = 1.5e9,
                               .series = series,
                               .series_count = 3,
                               .failed = true},
                     back;
  record.result.pile.repose.cone_deg = 23.456789012345678;
  record.result.pile.repose.sector_deg = NAN;
  scree_error error;
  const char *path = in_folder("record.yaml");
  CHECK_OK(scree_study_record_write(&record, path, &error), error);
  CHECK_OK(scree_study_record_read(path, &back, &error), error);
  assert_string_equal(back.reason, record.reason);
  assert_true(back.failed && back.started == 1.5e9);
  assert_true(back.result.pile.repose.cone_deg == record.result.pile.repose.cone_deg);
  assert_true(isnan(back.result.pile.repose.sector_deg));
  assert_int_equal(back.series_count, 3);
  assert_true(back.series[0].mean_rotation == 1.0 / 3 && isnan(back.series[0].sector_deg));
  assert_int_equal(back.series[0].phase, 2);
  scree_study_record_free(&back);
  struct stat info;
  stat(path, &info);
  for (off_t cut = 0; cut + 2 < info.st_size; cut += 1 + info.st_size / 97) {
    CHECK_OK(scree_study_record_write(&record, path, &error), error);
    assert_int_equal(truncate(path, cut), 0);
    assert_int_equal(scree_study_record_read(path, &back, &error), SCREE_BAD_FILE);
  }
}

/* Takes the line of a key out of a record's file. */
static void drop_row(const char *path, const char *key) {
  scree_error error;
  char *text, mark[64];
  size_t size;
  CHECK_OK(scree_file_read(path, 0, &text, &size, &error), error);
  snprintf(mark, sizeof mark, "\"%s\": ", key);
  char *begin = strstr(text, mark);
  assert_non_null(begin);
  char *end = strchr(begin, '\n') + 1;
  memmove(begin, end, strlen(end) + 1);
  CHECK_OK(scree_text_write(text, path, true, &error), error);
  scree_free(text);
}

/* A record of a version that had fewer rows is one all the same: what it lacks is not known, and
 * stays so when it is written again. */
static void rows_that_a_record_lacks_are_unknown(void **state) {
  (void)state;
  scree_record_point series[2] = {{.time = 0.1, .height = 0.2}, {.time = 0.2, .height = 0.3}};
  scree_study_record record = {.version = "0.1", .series = series, .series_count = 2}, back;
  scree_error error;
  const char *path = in_folder("old.yaml");
  record.result.pile.packing_fraction = 0.5;
  record.result.coordination = 4;
  record.costs.step_count = 7;
  CHECK_OK(scree_study_record_write(&record, path, &error), error);
  drop_row(path, "packing_fraction");
  drop_row(path, "step_count");
  drop_row(path, "heap_reason");
  drop_row(path, "series_silhouette_deg");
  for (int round = 0; round < 2; round++) {
    CHECK_OK(scree_study_record_read(path, &back, &error), error);
    assert_true(isnan(back.result.pile.packing_fraction) && back.result.coordination == 4);
    assert_true(back.costs.step_count == SCREE_UNKNOWN_COUNT);
    assert_string_equal(back.result.pile.repose.reason, "");
    assert_true(isnan(back.series[1].silhouette_deg) && back.series[1].height == 0.3);
    CHECK_OK(scree_study_record_write(&back, path, &error), error);
    scree_study_record_free(&back);
  }
  drop_row(path, "failed");
  assert_int_equal(scree_study_record_read(path, &back, &error), SCREE_BAD_FILE);
}

/* ---- work ---- */

static const char tiny[] =
    "name: tiny\nreplicates: 2\nattempts: 2\nshapes: [sample:icosphere-1]\n"
    "base:\n  preset: demo\n  particles: 8\n"
    "  cylinder: {diameter: 0.4}\n"
    "  phases: {pack_time: 0.3, settle_time: 0.05, lift_speed: 1, lift_time: "
    "0.3, hold_time: 0.05}\n"
    "factors:\n  friction_all: [0.2, 0.5]\n  rp: [spheres]\n";

static scree_study *open_tiny(const char *name, const char *text) {
  scree_study *study;
  scree_error error;
  scree_study_options o = scree_default_study_options();
  CHECK_OK(scree_study_read(file_with("tiny.yaml", text), &study, &error), error);
  CHECK_OK(scree_study_open(study, in_folder(name), &error), error);
  CHECK_OK(scree_study_prepare(study, &o, NULL, &error), error);
  return study;
}

static scree_study_options quick(void) {
  scree_study_options o = scree_default_study_options();
  o.poll_s = 0.01;
  return o;
}

/* The final states of all runs as one text. */
static void hashes_of(const scree_study *study, char *text, size_t size) {
  size_t used = 0;
  scree_error error;
  for (size_t i = 0; i < scree_study_run_count(study); i++) {
    const char *path = SCREE_STUDY_PATH(study, "results", study->keys[i], ".yaml");
    scree_study_record record;
    CHECK_OK(scree_study_record_read(path, &record, &error), error);
    assert_false(record.failed);
    used += (size_t)snprintf(text + used, size - used, "%s\n", record.hash);
    scree_study_record_free(&record);
  }
}

static char uninterrupted[512];

static void a_study_is_worked_off_and_told(void **state) {
  (void)state;
  scree_study *study = open_tiny("whole", tiny), *again;
  scree_study_options o = quick();
  scree_study_result result;
  scree_error error;
  size_t done = 0;
  CHECK_OK(scree_study_work(study, &o, NULL, &done, &error), error);
  assert_int_equal(done, 4);
  CHECK_OK(scree_study_collect(study, true, &error), error);
  hashes_of(study, uninterrupted, sizeof uninterrupted);
  CHECK_OK(scree_study_work(study, NULL, NULL, &done, &error), error);
  assert_int_equal(done, 0); /* nothing is left */
  CHECK_OK(scree_study_open_folder(in_folder("whole"), &again, &error), error);
  CHECK_OK(scree_study_analyse(again, &result, &error), error);
  assert_int_equal(result.counts.done, 4);
  assert_int_equal(result.points[1].counts.done, 2);
  assert_int_equal(result.points[1].seconds.count, 2);
  assert_true(result.seconds_left == 0 && result.seconds_spent > 0);
  assert_true(result.points[0].series_count > 2);
  CHECK_OK(scree_study_report_write(&result, in_folder("whole"), &error), error);
  scree_study_result_free(&result);
  scree_study_free(again);
  scree_study_free(study);
}

static void expect_same_shape(const scree_shape_made *a, const scree_shape_made *b) {
  const scree_mesh *first = scree_particle_mesh(a->particle),
                   *second = scree_particle_mesh(b->particle);
  assert_int_equal(first->vertex_count, second->vertex_count);
  assert_int_equal(first->triangle_count, second->triangle_count);
  assert_memory_equal(first->positions, second->positions,
                      3 * first->vertex_count * sizeof *first->positions);
  assert_memory_equal(first->triangles, second->triangles,
                      3 * first->triangle_count * sizeof *first->triangles);
  assert_true(a->scan_volume == b->scan_volume);
}

/* Shapes from files in the folder and those of a single run, from memory, have the same bits. */
static void a_single_run_has_the_shapes_of_a_study(void **state) {
  (void)state;
  const size_t points = 5;
  scree_error error;
  scree_study *study = open_tiny(
      "shapes", "name: shapes\nshapes: [sample:fp-1]\nsample: {resolution: 4e-3, noise: 0.2e-3}\n"
                "base: {preset: demo}\nfactors:\n"
                "  rp: [0.02, 0.1, scan, recommended, 0.5*recommended]\n");
  for (size_t point = 0; point < points; point++) {
    scree_shape_made from_folder, made;
    scree_shape_spec spec = scree_default_shape_spec();
    spec.sample = "fp-1";
    spec.resolution = 4e-3;
    spec.noise = 0.2e-3;
    spec.level = study->points[point].rp;
    CHECK_OK(scree_study_make_shape(study, 0, study->points[point].rp, &from_folder, &error),
             error);
    CHECK_OK(scree_shape_make(&spec, NULL, NULL, &made, &error), error);
    expect_same_shape(&from_folder, &made);
    scree_particle_free(from_folder.particle);
    scree_particle_free(made.particle);
  }
  scree_study_free(study);
}

/* One more replicate and one more level leave the runs that are done as they are. */
static void a_study_can_grow(void **state) {
  (void)state;
  char more[sizeof tiny + 8];
  snprintf(more, sizeof more, "%s", tiny);
  strstr(more, "replicates: 2")[strlen("replicates: ")] = '3';
  scree_study *study = open_tiny("whole", more);
  scree_study_options o = quick();
  scree_error error;
  size_t done;
  CHECK_OK(scree_study_work(study, &o, NULL, &done, &error), error);
  assert_int_equal(done, 2);
  scree_study_free(study);
}

typedef struct killer {
  int calls, when;
} killer;

static bool kill_in_the_middle(void *context, const char *phase, double fraction) {
  killer *k = context;
  (void)phase;
  (void)fraction;
  if (++k->calls == k->when) raise(SIGKILL);
  return true;
}

static bool cancel(void *context, const char *phase, double fraction) {
  (void)context;
  (void)phase;
  (void)fraction;
  return false;
}

/* Works in a child that kills itself in its when-th report. */
static void work_and_die(scree_study *study, int when) {
  pid_t child = fork();
  if (child == 0) {
    killer k = {0, when};
    scree_progress progress = {kill_in_the_middle, &k, 0};
    scree_study_options o = quick();
    scree_study_work(study, &o, &progress, NULL, NULL);
    _exit(0);
  }
  int status;
  waitpid(child, &status, 0);
  assert_true(WIFSIGNALED(status));
}

static void the_death_of_a_worker_loses_nothing(void **state) {
  (void)state;
  scree_study *study = open_tiny("death", tiny);
  scree_study_options o = quick();
  scree_progress progress = {cancel, NULL, 0};
  scree_error error;
  char hashes[512];
  size_t done;
  assert_int_equal(scree_study_work(study, &o, &progress, &done, &error), SCREE_CANCELLED);
  work_and_die(study, 2); /* goes on from the checkpoint, and dies */
  CHECK_OK(scree_study_work(study, &o, NULL, &done, &error), error);
  hashes_of(study, hashes, sizeof hashes);
  assert_string_equal(hashes, uninterrupted);
  scree_study_free(study);
}

static void a_run_that_kills_its_workers_fails(void **state) {
  (void)state;
  scree_study *study = open_tiny("killer", tiny);
  scree_study_options o = quick();
  scree_study_result result;
  scree_error error;
  size_t done;
  work_and_die(study, 1);
  work_and_die(study, 1);
  CHECK_OK(scree_study_work(study, &o, NULL, &done, &error), error);
  CHECK_OK(scree_study_collect(study, true, &error), error);
  CHECK_OK(scree_study_analyse(study, &result, &error), error);
  assert_int_equal(result.counts.failed, 1);
  assert_int_equal(result.counts.done, 3);
  assert_non_null(strstr(result.failures[0].reason, "2 workers died in it"));
  scree_study_result_free(&result);
  CHECK_OK(scree_study_reopen(study, &error), error); /* the same command tries again */
  CHECK_OK(scree_study_work(study, &o, NULL, &done, &error), error);
  assert_int_equal(done, 1);
  char hashes[512];
  hashes_of(study, hashes, sizeof hashes);
  assert_string_equal(hashes, uninterrupted);
  scree_study_free(study);
}

static void several_workers_give_the_same_numbers(void **state) {
  (void)state;
  scree_study *study = open_tiny("several", tiny);
  scree_error error;
  char hashes[512];
  for (int i = 0; i < 3; i++)
    if (fork() == 0) {
      scree_study_options o = quick();
      _exit(scree_study_work(study, &o, NULL, NULL, NULL) == SCREE_OK ? 0 : 1);
    }
  for (int i = 0; i < 3; i++) {
    int status;
    wait(&status);
    assert_int_equal(status, 0);
  }
  hashes_of(study, hashes, sizeof hashes);
  assert_string_equal(hashes, uninterrupted);
  CHECK_OK(scree_study_collect(study, true, &error), error);
  scree_study_free(study);
}

/* A run that diverges is kept with its reason; the others go on. */
static void a_failed_run_stops_no_other(void **state) {
  (void)state;
  char text[sizeof tiny + 80];
  snprintf(text, sizeof text, "%s", tiny);
  char *at = strstr(text, "  friction_all: [0.2, 0.5]");
  memcpy(at, "  particles: [8, 20000]   ", 26);
  scree_study *study = open_tiny("failed", text);
  scree_study_options o = quick();
  scree_study_result result;
  scree_error error;
  size_t done;
  CHECK_OK(scree_study_work(study, &o, NULL, &done, &error), error);
  assert_int_equal(done, 4);
  CHECK_OK(scree_study_collect(study, true, &error), error);
  CHECK_OK(scree_study_analyse(study, &result, &error), error);
  assert_int_equal(result.counts.done, 2);
  assert_int_equal(result.counts.failed, 2);
  assert_non_null(strstr(result.failures[0].reason, "pack_time"));
  scree_study_result_free(&result);
  scree_study_free(study);
}

/* No space for the records: an error that names the file, and the run waits again. */
static void a_full_disk_ends_the_work_and_loses_nothing(void **state) {
  (void)state;
  scree_study *study = open_tiny("full", tiny);
  scree_study_options o = quick();
  scree_error error;
  size_t done;
  pid_t child = fork();
  if (child == 0) {
    struct rlimit limit = {2000, 2000}; /* enough for a lease, too little for a checkpoint */
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    scree_status status = scree_study_work(study, &o, NULL, NULL, &error);
    _exit(status == SCREE_IO && strstr(error.message, "cannot write") ? 0 : 1);
  }
  int status;
  waitpid(child, &status, 0);
  assert_int_equal(status, 0);
  CHECK_OK(scree_study_work(study, &o, NULL, &done, &error), error);
  assert_int_equal(done, 4);
  char hashes[512];
  hashes_of(study, hashes, sizeof hashes);
  assert_string_equal(hashes, uninterrupted);
  scree_study_free(study);
}

/* No space for the database: an error that names it, no journal of a half-written one that keeps
 * others out, and the same call makes it once there is room. */
static void a_full_disk_harms_no_database(void **state) {
  (void)state;
  scree_study *study = open_tiny("whole", tiny);
  scree_study_result result;
  scree_error error;
  unlink(in_folder("whole/study.sqlite"));
  for (rlim_t room = 512; room <= 32768; room *= 4) {
    pid_t child = fork();
    if (child == 0) {
      struct rlimit limit = {room, room};
      signal(SIGXFSZ, SIG_IGN);
      setrlimit(RLIMIT_FSIZE, &limit);
      scree_status status = scree_study_collect(study, true, &error);
      _exit(status == SCREE_IO && strstr(error.message, "study.sqlite") ? 0 : 1);
    }
    int status;
    waitpid(child, &status, 0);
    assert_int_equal(status, 0);
  }
  CHECK_OK(scree_study_collect(study, true, &error), error);
  CHECK_OK(scree_study_analyse(study, &result, &error), error);
  assert_int_equal(result.counts.done, 4);
  scree_study_result_free(&result);
  scree_study_free(study);
}

/* What a person or a disk may have done to the folder's own YAML and leases. */
static void broken_files_of_a_folder_are_told(void **state) {
  (void)state;
  static const char *const shapes[] = {"", "- 1\n", "source: [1\n", "source: 'sample:box'\n",
                                       "source: 'sample:icosphere-1'\nchecksum: '12'\n"};
  scree_study *study = open_tiny("whole", tiny), *again = NULL;
  scree_error error;
  char *saved;
  size_t size;
  const char *facts = in_folder("whole/shapes/icosphere-1.yaml");
  CHECK_OK(scree_file_read(facts, 0, &saved, &size, &error), error);
  for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
    file_with("whole/shapes/icosphere-1.yaml", shapes[i]);
    assert_int_equal(scree_study_open_folder(in_folder("whole"), &again, &error), SCREE_BAD_FILE);
    assert_non_null(strstr(error.message, "icosphere-1.yaml"));
  }
  FILE *file = fopen(in_folder("whole/shapes/icosphere-1.yaml"), "w");
  assert_int_equal(fwrite(saved, 1, size, file), size);
  fclose(file);
  scree_free(saved);
  const char *copy = in_folder("whole/study.yaml");
  CHECK_OK(scree_file_read(copy, 0, &saved, &size, &error), error);
  assert_int_equal(truncate(copy, 75), 0); /* in the middle of a line */
  assert_int_equal(scree_study_open_folder(in_folder("whole"), &again, &error), SCREE_BAD_FILE);
  assert_non_null(strstr(error.message, "study.yaml, line"));
  file = fopen(in_folder("whole/study.yaml"), "w");
  assert_int_equal(fwrite(saved, 1, size, file), size);
  fclose(file);
  scree_free(saved);
  /* a lease of garbage is nobody's, and expires as one of another machine does */
  char lease[64];
  snprintf(lease, sizeof lease, "whole/leases/run-%s", study->keys[0]);
  file_with(lease, "\x01\x02garbage");
  CHECK_OK(scree_study_collect(study, true, &error), error);
  unlink(in_folder(lease));
  scree_study_free(study);
}

static void damaged_files_are_told_and_made_again(void **state) {
  (void)state;
  scree_study *study = open_tiny("full", tiny), *again;
  scree_study_result result;
  scree_study_options o = quick();
  scree_error error;
  size_t done;
  CHECK_OK(scree_study_collect(study, true, &error), error);
  const char *database = in_folder("full/study.sqlite");
  FILE *file = fopen(database, "r+");
  for (int i = 0; i < 5000; i++) putc(i * 37 & 0xff, file);
  fclose(file);
  assert_int_equal(scree_study_collect(study, true, &error), SCREE_BAD_FILE);
  assert_non_null(strstr(error.message, "delete it"));
  file_with("full/study.sqlite", "this is a text\n");
  assert_int_equal(scree_study_analyse(study, &result, &error), SCREE_BAD_FILE);
  unlink(in_folder("full/study.sqlite"));
  CHECK_OK(scree_study_collect(study, true, &error), error);
  /* a record cut short is no result */
  const char *record = SCREE_STUDY_PATH(study, "results", study->keys[1], ".yaml");
  assert_int_equal(truncate(record, 100), 0);
  CHECK_OK(scree_study_work(study, &o, NULL, &done, &error), error);
  assert_int_equal(done, 1);
  CHECK_OK(scree_study_collect(study, true, &error), error);
  CHECK_OK(scree_study_analyse(study, &result, &error), error);
  assert_int_equal(result.counts.done, 4);
  scree_study_result_free(&result);
  scree_study_free(study);
  assert_int_equal(scree_study_open_folder(in_folder("nowhere"), &again, &error), SCREE_IO);
  assert_non_null(strstr(error.message, "is no folder of a study"));
}

static int begin(void **state) {
  scree_set_threads(1); /* children are forked */
  return make_folder(state);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sobol_as_by_scipy),
      cmocka_unit_test(designs_fill_space),
      cmocka_unit_test(a_plan_follows_from_its_file),
      cmocka_unit_test(a_filling_design_stays_in_its_ranges),
      cmocka_unit_test(errors_say_line_column_and_limit),
      cmocka_unit_test(a_lease_has_one_holder),
      cmocka_unit_test(the_dead_on_this_machine_are_known_at_once),
      cmocka_unit_test(leases_of_other_machines_expire),
      cmocka_unit_test(of_many_one_wins),
      cmocka_unit_test(records_read_back_the_same_or_not_at_all),
      cmocka_unit_test(rows_that_a_record_lacks_are_unknown),
      cmocka_unit_test(a_study_is_worked_off_and_told),
      cmocka_unit_test(a_single_run_has_the_shapes_of_a_study),
      cmocka_unit_test(a_study_can_grow),
      cmocka_unit_test(the_death_of_a_worker_loses_nothing),
      cmocka_unit_test(a_run_that_kills_its_workers_fails),
      cmocka_unit_test(several_workers_give_the_same_numbers),
      cmocka_unit_test(a_failed_run_stops_no_other),
      cmocka_unit_test(a_full_disk_ends_the_work_and_loses_nothing),
      cmocka_unit_test(a_full_disk_harms_no_database),
      cmocka_unit_test(broken_files_of_a_folder_are_told),
      cmocka_unit_test(damaged_files_are_told_and_made_again),
  };
  return cmocka_run_group_tests(tests, begin, remove_folder);
}
