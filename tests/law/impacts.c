/* Impacts against closed forms: balls dropped from known heights, sums against the ledger, and the
 * same after a checkpoint. */
#include "scree.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/scene.h"

static const double g = 9.81;

/* A ball that falls by h comes with m g h and loses 1 - e^2 of it; the first of all its hits, as
 * the time ends before the second. */
static void dropped_balls(void **state) {
  (void)state;
  static const double heights[] = {0.01, 0.1, 1};
  for (int law = 0; law < 2; law++)
    for (int i = 0; i < 3; i++) {
      char text[1500];
      const double h = heights[i], fall = sqrt(2 * h / g), r = 0.01;
      snprintf(text, sizeof text,
               "time: %.9g\n"
               "contact: {law: %s}\n"
               "materials: {m: {young: 1e7, density: 2500, restitution: 0.5, friction: 0.3}}\n"
               "shapes: {ball: {sphere: 0.02}}\n"
               "geometry: {floor: {plane: [0, 0, 1]}, aside: {plane: [1, 0, 0], at: [-9, 0, 0]}}\n"
               "inlets: {i: {box: {min: [-0.0102, -0.0102, %.9g], max: [0.0102, 0.0102, %.9g]}, "
               "shapes: ball, count: 1}}\n"
               "sensors: {hits: {impacts: {threshold: %.9g}}}\n",
               1.5 * fall, law ? "hysteretic" : "linear", h, h + 2.04 * r, 1e-3 * g * h);
      scree_scene *scene = create(text);
      run_to_end(scene);
      double m = scree_world_body_mass(scree_scene_view(scene), 0),
             fell = now_of(scene, "entered_energy") - m * g * r;
      assert_int_equal((int)now_of(scene, "hits.count"), 1);
      assert_int_equal((int)now_of(scene, "hits.count.ball-floor"), 1);
      assert_int_equal((int)now_of(scene, "hits.count.ball-ball"), 0);
      CHECK_NEAR(now_of(scene, "hits.approach.ball-floor"), fell, 0.01 * fell);
      CHECK_NEAR(now_of(scene, "hits.normal.ball-floor"), 0.75 * fell, 0.015 * fell);
      CHECK_NEAR(now_of(scene, "hits.tangential"), 0, 1e-9 * fell);
      CHECK_NEAR(now_of(scene, "hits.damage"), fell - 1e-3 * g * h, 0.01 * fell);
      scree_scene_free(scene);
    }
}

/* Spinning boxes and balls in a shaken box: all that is dissipated is some class's. */
static const char mixed[] =
    "time: 0.6\n"
    "materials: {m: {young: 1e6, density: 2500, restitution: 0.4, friction: 0.4}}\n"
    "shapes: {ball: {sphere: 0.02}, brick: {box: [0.03, 0.02, 0.02]}}\n"
    "geometry:\n"
    "  floor: {box: [0.3, 0.3, 0.05], at: [0, 0, -0.025], motion: [{vibrate: {along: [0, 0, 1], "
    "amplitude: 2e-3, frequency: 20}}]}\n"
    "  shell: {cylinder: {radius: 0.07, length: 1}, at: [0, 0, 0]}\n"
    "inlets: {i: {cylinder: {at: [0, 0, 0.03], radius: 0.06, length: 0.3}, shapes: {ball: 1, "
    "brick: 1}, count: 30}}\n"
    "sensors: {hits: {impacts: {window: 0.1}}, late: {impacts: {by: material}, from: 0.3}}\n";

static void sums_are_the_ledgers(void **state) {
  (void)state;
  scree_scene *scene = create(mixed);
  scree_observation o;
  run_to_end(scene);
  scree_world_observe(scree_scene_view(scene), &o);
  double lost = o.dissipated_dashpot + o.dissipated_friction,
         told = now_of(scene, "hits.normal") + now_of(scene, "hits.tangential");
  assert_true(now_of(scene, "hits.count") > 100);
  assert_true(lost > 1e-3);
  CHECK_NEAR(told, lost, 0.005 * lost);
  CHECK_NEAR(now_of(scene, "hits.normal"), o.dissipated_dashpot, 0.005 * lost);
  double classes = 0;
  static const char *const names[] = {"ball-ball",  "ball-brick",  "brick-brick", "ball-floor",
                                      "ball-shell", "brick-floor", "brick-shell"};
  for (size_t i = 0; i < 7; i++) {
    char column[64];
    snprintf(column, sizeof column, "hits.normal.%s", names[i]);
    classes += now_of(scene, column);
  }
  CHECK_NEAR(classes, now_of(scene, "hits.normal"), 1e-12 * lost);
  double late = now_of(scene, "late.normal");
  assert_true(late > 0 && late < now_of(scene, "hits.normal"));
  assert_true(now_of(scene, "late.count.m-m") < now_of(scene, "hits.count"));
  scree_scene_free(scene);
}

static scree_scene *complete(const char *folder, const char *text, bool resume) {
  scree_error error;
  scree_scene_file *file = NULL;
  scree_scene *scene = NULL;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), "test.yaml", &file, &error), error);
  scree_scene_job job = {.file = file, .folder = folder, .resume = resume, .overwrite = true};
  CHECK_OK(scree_scene_complete(&job, &scene, &error), error);
  scree_scene_file_free(file);
  return scene;
}

/* The tables have what the columns have; a scene that was cut and goes on has the same. */
static void tables(void **state) {
  (void)state;
  char half[sizeof mixed + 10];
  const char *folder = in_folder("cut");
  scree_scene *scene = complete(folder, mixed, false);
  double count = now_of(scene, "hits.count"), normal = now_of(scene, "hits.normal"),
         tangential = now_of(scene, "hits.tangential");
  scree_checksum hash = scree_world_hash(scree_scene_view(scene));
  scree_scene_free(scene);
  for (int k = 6; k < 9; k++)
    CHECK_NEAR(sum_in_folder("cut/sensor-hits-spectra.csv", "", k), count, 0);
  CHECK_NEAR(sum_in_folder("cut/sensor-hits-bodies.csv", "", 4), normal, 1e-6 * normal);
  CHECK_NEAR(sum_in_folder("cut/sensor-hits-bodies.csv", "", 5), tangential, 1e-6 * tangential);
  snprintf(half, sizeof half, "time: 0.237%s", mixed + 9);
  scree_scene_free(complete(folder, half, false));
  scene = complete(folder, mixed, true);
  scree_checksum again = scree_world_hash(scree_scene_view(scene));
  assert_memory_equal(&hash, &again, sizeof hash);
  CHECK_NEAR(now_of(scene, "hits.count"), count, 0);
  CHECK_NEAR(now_of(scene, "hits.normal"), normal, 0);
  CHECK_NEAR(sum_in_folder("cut/sensor-hits-spectra.csv", "", 6), count, 0);
  scree_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(dropped_balls),
      cmocka_unit_test(sums_are_the_ledgers),
      cmocka_unit_test(tables),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
