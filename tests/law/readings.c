/* What sensors read against closed forms: means and spreads over a window, the slope of a part of a
 * surface, mixing, residence. Every series is the same for any number of threads, and when cut and
 * resumed. */
#include "scene/scene.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/scene.h"
#include "support/threads.h"

#include "scree.h"

#include <stdlib.h>

static const double pi = 3.14159265358979;

static scree_scene_summary summary_of(const scree_scene *scene, const char *name) {
  return scree_scene_summarise(scene, column_of(scene, name), NAN, NAN);
}

/* To its end at once; and by another number of threads, saved and loaded half way. */
static scree_scene *run_both(const char *text) {
  scree_error error;
  const char *path = in_folder("half.scree");
  scree_scene *whole = create_at(text, in_folder("test.yaml")),
              *cut = create_at(text, in_folder("test.yaml"));
  use_threads(1);
  run_to_end(whole);
  use_threads(3);
  size_t half = (size_t)scree_world_step_count(scree_scene_view(whole)) / 2, rows[2];
  CHECK_OK(scree_scene_advance(cut, half, &error), error);
  CHECK_OK(scree_scene_save(cut, path, true, &error), error);
  scree_scene_free(cut);
  CHECK_OK(scree_scene_load(path, &cut, &error), error);
  run_to_end(cut);
  use_threads(0);
  const double *a = scree_scene_series(whole, &rows[0]), *b = scree_scene_series(cut, &rows[1]);
  assert_int_equal(rows[0], rows[1]);
  assert_memory_equal(a, b, rows[0] * scree_scene_column_count(whole) * sizeof *a);
  scree_scene_free(cut);
  return whole;
}

/* A wall that rises by v t, one that swings by a sin(w t): over a window of whole periods. */
static void windows(void **state) {
  (void)state;
  scree_scene *scene = run_both(
      "time: 2\n"
      "geometry:\n"
      "  lift: {box: [0.1, 0.1, 0.01], motion: [{translate: {velocity: [0, 0, 0.3]}}]}\n"
      "  swing: {box: [0.1, 0.1, 0.01], at: [1, 0, 0], motion: [{vibrate: {along: [0, 1, 0], "
      "amplitude: 4 mm, frequency: 2}}]}\n"
      "shapes: {ball: {sphere: 0.01}}\n"
      "inlets: {i: {box: {min: [-0.1, -0.1, 1], max: [0.1, 0.1, 1.1]}, shapes: ball, count: 1}}\n"
      "sensors:\n"
      "  rising: {position: lift, from: 0.5, until: 1.5}\n"
      "  swinging: {position: swing, from: 0.495, until: 1.495}\n"
      "  all: {position: lift}\n"
      "output: {series: 0.01}\n");
  scree_scene_summary s = summary_of(scene, "rising.z");
  assert_int_equal(s.count, 101);
  CHECK_NEAR(s.mean, 0.3, 1e-3);
  CHECK_NEAR(s.sd, 0.003 * sqrt(101 * 102 / 12.0), 1e-5); /* of 101 equal steps */
  CHECK_NEAR(s.least, 0.15, 3e-3);
  CHECK_NEAR(s.greatest, 0.45, 3e-3);
  CHECK_NEAR(s.last, 0.6, 1e-6);
  s = summary_of(scene, "swinging.y");
  CHECK_NEAR(s.mean, 0, 1e-6);
  CHECK_NEAR(s.sd, 4e-3 / sqrt(2), 0.006 * 4e-3);
  CHECK_NEAR(summary_of(scene, "all.z").mean, 0.3, 1e-3);
  s = scree_scene_summarise(scene, column_of(scene, "all.z"), 1, NAN);
  CHECK_NEAR(s.mean, 0.45, 1e-3);
  assert_true(isinf(s.until));
  s = scree_scene_summarise(scene, column_of(scene, "all.z"), 3, 4);
  assert_true(isnan(s.mean) && isnan(s.sd) && isnan(s.least) && s.count == 0);
  scree_scene_free(scene);
}

/* A roof of balls, up by 20 degrees and down by 35: each half has its own slope. What will run is
 * told with the bodies of the table. */
static void slopes(void **state) {
  (void)state;
  FILE *table = fopen(in_folder("roof.csv"), "w");
  size_t count = 0;
  assert_non_null(table);
  fputs("x,y,z\n", table);
  for (int i = -60; i <= 60; i++)
    for (int j = -10; j <= 10; j++, count++) {
      double x = 0.005 * i, z = x < 0 ? x * tan(20 * pi / 180) : -x * tan(35 * pi / 180);
      fprintf(table, "%.17g,%.17g,%.17g\n", x, 0.012 * j, 1 + z);
    }
  fclose(table);
  scree_scene *scene =
      create_at("time: 0.001\nshapes: {ball: {sphere: 0.012}}\nbodies: {file: roof.csv}\n"
                "sensors:\n"
                "  left: {slope: {axis: [0, 1, 0], box: {min: [-1, -1, 0], max: [0, 1, 2]}}}\n"
                "  right: {slope: {axis: [0, 1, 0], box: {min: [0, -1, 0], max: [1, 1, 2]}}}\n"
                "  behind: {slope: {axis: [0, -1, 0], box: {min: [0, -1, 0], max: [1, 1, 2]}}}\n"
                "  nothing: {slope: {axis: [0, 1, 0], box: {min: [2, -1, 0], max: [3, 1, 2]}}}\n",
                in_folder("test.yaml"));
  double left = now_of(scene, "left.angle_deg"), right = now_of(scene, "right.angle_deg");
  CHECK_NEAR(fabs(left), 20, 0.5);
  CHECK_NEAR(fabs(right), 35, 0.7);
  assert_true(left * right < 0);
  CHECK_NEAR(now_of(scene, "behind.angle_deg"), -right, 1e-9);
  assert_true(isnan(now_of(scene, "nothing.angle_deg")));
  scree_scene_forecast f;
  scree_scene_foretell(scene, &f);
  CHECK_NEAR(f.body_count, count, 0);
  scree_scene_free(scene);
}

/* ---- mixing ---- */

enum { ALONG = 20, HIGH = 10 }; /* balls of a block: 20 x 20 x 10, 10 mm apart */

/* The block with each ball of one of two colours, as `is_red` deals them. */
static void write_block(const char *name, bool (*is_red)(int i, int j, int k)) {
  FILE *table = fopen(in_folder(name), "w");
  assert_non_null(table);
  fputs("shape,x [mm],y [mm],z [mm]\n", table);
  for (int i = 0; i < ALONG; i++)
    for (int j = 0; j < ALONG; j++)
      for (int k = 0; k < HIGH; k++)
        fprintf(table, "%s,%d,%d,%d\n", is_red(i, j, k) ? "red" : "blue", 10 * i - 95, 10 * j - 95,
                10 * k + 5);
  fclose(table);
}

static bool halves(int i, int j, int k) {
  (void)j, (void)k;
  return i < ALONG / 2;
}
static bool checkers(int i, int j, int k) {
  return (i + j + k) % 2;
}
static uint64_t state_of_dice;
static bool dice(int i, int j, int k) {
  (void)i, (void)j, (void)k;
  state_of_dice = state_of_dice * 6364136223846793005u + 1442695040888963407u;
  return (state_of_dice >> 33) % 4 == 0;
}

static scree_scene *mixture(const char *file) {
  char text[1500];
  snprintf(text, sizeof text,
           "time: 2e-4\ngravity: [0, 0, 0]\n"
           "materials: {m: {young: 1e6, density: 1000}, n: {young: 1e6, density: 1000}}\n"
           "shapes: {red: {sphere: 0.008, material: m}, blue: {sphere: 0.008, material: n}}\n"
           "geometry: {table: {disc: {radius: 0.1}, material: m, at: [0, 0, -0.5]}}\n"
           "bodies: {file: %s}\noutput: {series: 1e-4}\n"
           "sensors:\n"
           "  wide: {segregation: {cells: 5 cm}}\n"
           "  by_m: {segregation: {cells: 5 cm, by: material}}\n"
           "  fine: {segregation: {cells: 1 cm}}\n"
           "  four: {segregation: {cells: 10 m}}\n"
           "  box: {grid: {box: {min: [-0.1, -0.1, 0.5], max: [0.1, 0.1, 0.6]}, cells: [4, 4, 2], "
           "with: table}}\n"
           "  round: {grid: {cylinder: {at: [0, 0, 0], radius: 0.1, length: 0.1}, cells: [2, 8, "
           "1]}}\n",
           file);
  FILE *in = fopen(in_folder(file), "r");
  assert_non_null(in);
  fclose(in);
  scree_scene *scene = run_both(text);
  return scene;
}

static void mixing(void **state) {
  (void)state;
  write_block("halves.csv", halves);
  scree_scene *scene = mixture("halves.csv");
  /* cells of 5 x 5 x 5 each have one colour */
  CHECK_NEAR(now_of(scene, "wide.lacey.red"), 0, 1e-12);
  CHECK_NEAR(now_of(scene, "wide.lacey.blue"), 0, 1e-12);
  CHECK_NEAR(now_of(scene, "by_m.lacey.m"), 0, 1e-12);
  CHECK_NEAR(now_of(scene, "wide.per_cell"), 125, 0);
  CHECK_NEAR(now_of(scene, "box.lacey.red"), 0, 1e-12);
  /* the axes of a cylinder's eight sectors may not be x and y: those that are cut have both */
  assert_true(now_of(scene, "round.lacey.red") < 0.3);
  CHECK_NEAR(now_of(scene, "four.lacey.red"), 0, 1e-12);
  /* of single balls nothing can be told, and why is */
  assert_true(isnan(now_of(scene, "fine.lacey.red")));
  CHECK_NEAR(now_of(scene, "fine.per_cell"), 1, 0);
  char text[SCREE_REMARK];
  assert_true(scree_scene_doubt(scene, 0, text));
  assert_non_null(strstr(text, "sensors.fine: 4000 bodies in 4000 cells"));
  assert_false(scree_scene_doubt(scene, 1, text));
  scree_scene_free(scene);

  write_block("checkers.csv", checkers);
  scene = mixture("checkers.csv"); /* more even than by chance: mixed, not above */
  CHECK_NEAR(now_of(scene, "wide.lacey.red"), 1, 0);
  CHECK_NEAR(now_of(scene, "box.lacey.red"), 1, 0);
  scree_scene_free(scene);

  /* by chance: 32 cells of 125, whose own scatter is 0.06, and the mean of many is 1 */
  double sum = 0, least = 1;
  for (int run = 0; run < 12; run++) {
    write_block("dice.csv", dice);
    scene = mixture("dice.csv");
    double index = now_of(scene, "wide.lacey.red");
    CHECK_NEAR(now_of(scene, "by_m.lacey.m"), index, 0);
    CHECK_NEAR(now_of(scene, "box.lacey.red"), index, 1e-12);
    assert_true(index <= 1 && now_of(scene, "round.lacey.red") <= 1);
    sum += index / 12;
    least = fmin(least, index);
    scree_scene_free(scene);
  }
  assert_true(least > 0.98 && sum > 0.993);
}

/* ---- residence ---- */

/* Plug flow: balls laid on a belt of 0.5 m/s from two places go with it to its end, one kind 1 m
 * and one 0.5 m, from anywhere in 40 mm. */
static const char belt[] =
    "time: 6\n"
    "materials: {m: {young: 1e5, density: 1000, restitution: 0.1, friction: 0.5}}\n"
    "shapes: {far: {sphere: 9 mm}, near: {sphere: 8 mm}}\n"
    "geometry: {belt: {box: [2, 0.4, 0.02], at: [0.5, 0, -0.01], surface_velocity: [0.5, 0, 0]}}\n"
    "inlets:\n"
    "  start: {box: {min: [-0.02, -0.15, 0.003], max: [0.02, -0.01, 0.013]}, shapes: far, rate: "
    "20, "
    "velocity: [0.5, 0, 0]}\n"
    "  middle: {box: {min: [0.48, 0.01, 0.003], max: [0.52, 0.15, 0.013]}, shapes: near, rate: 10, "
    "velocity: [0.5, 0, 0]}\n"
    "outlets:\n"
    "  left: {box: {min: [1, 0, -1], max: [2, 1, 1]}}\n"
    "  right: {box: {min: [1, -1, -1], max: [2, 0, 1]}}\n"
    "sensors:\n"
    "  stay: {residence: {bins: 10}}\n"
    "  late: {residence: {inlet: start, outlet: right}, from: 5}\n"
    "  none: {residence: {inlet: start, outlet: left, by: material}}\n";

static void residence(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene = run_both(belt);
  double tick = (double)scene->tick_steps * scene->time_step, spread = 0.04 / 0.5;
  const struct {
    const char *of;
    double time; /* s */
  } kinds[] = {{"far", 2}, {"near", 1}};
  for (size_t i = 0; i < 2; i++) {
    static const char *const what[] = {"count", "mean", "sd", "p10", "median", "p90"};
    double v[6], time = kinds[i].time;
    for (int k = 0; k < 6; k++) {
      char column[64];
      snprintf(column, sizeof column, "stay.%s.%s", what[k], kinds[i].of);
      v[k] = now_of(scene, column);
    }
    assert_true(v[0] > 30);
    CHECK_NEAR(v[1], time + 0.5 * tick, 0.2 * spread);
    CHECK_NEAR(v[4], time + 0.5 * tick, 0.3 * spread);
    /* from an even spread of places */
    CHECK_NEAR(v[2], spread / sqrt(12), 0.35 * spread / sqrt(12));
    CHECK_NEAR(v[5] - v[3], 0.8 * spread, 0.4 * spread);
  }
  double count = now_of(scene, "stay.count");
  CHECK_NEAR(now_of(scene, "stay.count.far") + now_of(scene, "stay.count.near"), count, 0);
  double late = now_of(scene, "late.count");
  assert_true(late > 10 && late < 0.4 * now_of(scene, "stay.count.far"));
  assert_true(isnan(now_of(scene, "late.mean.near")));
  CHECK_NEAR(now_of(scene, "none.count"), 0, 0);
  scree_scene_table t;
  assert_string_equal(scree_scene_table_name(scene, 0), "stay.residence");
  assert_string_equal(scree_scene_table_name(scene, 1), "stay.histogram");
  assert_null(scree_scene_table_name(scene, 6));
  CHECK_OK(scree_scene_make_table(scene, 1, &t, &error), error);
  assert_true(t.row_count == 30 && t.column_count == 6 && !t.is_long); /* all, far, near */
  assert_string_equal(t.names[3], "count");
  assert_string_equal(t.units[1], "s");
  assert_string_equal(t.texts[10 * 6], "far");
  assert_null(t.texts[10 * 6 + 3]);
  double sums[2] = {0}, counts[20];
  for (size_t b = 0; b < 20; b++) sums[b / 10] += counts[b] = t.values[(10 + b) * 6 + 3];
  CHECK_NEAR(sums[0] + sums[1], count, 0);
  CHECK_NEAR(t.values[1], 1, 1.5 * spread);
  CHECK_NEAR(t.values[9 * 6 + 2], 2, 1.5 * spread);
  for (size_t b = 0; b < 5; b++) CHECK_NEAR(counts[b], 0, 0);
  for (size_t b = 15; b < 20; b++) CHECK_NEAR(counts[b], 0, 0);
  scree_scene_table_free(&t);
  CHECK_OK(scree_scene_write_tables(scene, in_folder("."), &error), error);
  CHECK_NEAR(sum_in_folder("sensor-stay-histogram.csv", ",", 3), count, 0);
  CHECK_NEAR(sum_in_folder("sensor-stay-histogram.csv", ",", 4), 1, 1e-6);
  CHECK_NEAR(sum_in_folder("sensor-stay-histogram.csv", "far,", 3), sums[0], 0);
  CHECK_NEAR(sum_in_folder("sensor-stay-residence.csv", "", 6) / count, now_of(scene, "stay.mean"),
             1e-6);
  scree_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(windows),
      cmocka_unit_test(slopes),
      cmocka_unit_test(mixing),
      cmocka_unit_test(residence),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
