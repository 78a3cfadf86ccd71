/* Runs that go on with a changed scene, against closed forms: a wall's way, what a rate lets in, a
 * fall under another gravity, sliding under another friction; what may not change; the same bits
 * after a checkpoint and on threads. */
#include "scree.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/scene.h"
#include "support/threads.h"

static void change(scree_scene **scene, const char *what) {
  scree_error error;
  CHECK_OK(scree_scene_change(scene, &what, 1, &error), error);
}

static const char equipment[] =
    "time: 4\n"
    "materials: {m: {young: 1e7, density: 2500, restitution: 0.5, friction: 0.4}}\n"
    "shapes: {ball: {sphere: 0.02}, brick: {box: [0.06, 0.06, 0.02]}}\n"
    "geometry:\n"
    "  floor: {plane: [0, 0, 1]}\n"
    "  gate: {box: [0.1, 0.1, 0.1], at: [9, 0, 1], motion: [{translate: {velocity: [0.1, 0, "
    "0]}}]}\n"
    "  vane: {box: [0.1, 0.1, 0.1], at: [12, 0, 1], motion: [{rotate: {axis: [0, 0, 1], through: "
    "[11, 0, 0], speed: 1}}]}\n"
    "bodies: {file: bodies.csv}\n"
    "inlets: {feed: {box: {min: [4, 0, 0.2], max: [6, 2, 0.6]}, shapes: {ball: 1}, rate: 10}}\n"
    "sensors: {gate: {position: gate}, vane: {position: vane}, "
    "ball: {region: {box: {min: [-1, -1, 1], max: [1, 1, 9]}}}}\n"
    "output: {series: 0.1}\n";

static scree_scene *make(void) {
  put_in_folder("bodies.csv", "shape,x,y,z,vx,vz\nball,0,0,5,0.3,0\nbrick,2,0,0.01,1,0\n");
  return create_at(equipment, in_folder("test.yaml"));
}

static void walls_rates_and_gravity(void **state) {
  (void)state;
  scree_scene *scene = make();
  run_until(scene, 0.5);
  double t = scree_world_time(scree_scene_view(scene)), before = now_of(scene, "entered");
  scree_body ball = body_of(scene, 0);
  change(&scene, "geometry.gate.motion.0.translate.velocity=[0.3, 0, 0]");
  change(&scene, "geometry.vane.motion.0.rotate.speed=-2");
  change(&scene, "inlets.feed.rate=40");
  change(&scene, "gravity=[0, 0, -1.62]");
  change(&scene, "sensors.late={region: {box: {min: [-1, -1, 0], max: [1, 1, 9]}}}");
  change(&scene, "gravity=[0, 0, -1.62]"); /* nothing more */
  assert_int_equal(scree_scene_change_count(scene), 5);
  assert_string_equal(scree_scene_change_at(scene, 2).was, "10");
  assert_null(scree_scene_change_at(scene, 4).was);
  run_until(scene, 1);
  double now = scree_world_time(scree_scene_view(scene)), dt = now - t;
  CHECK_NEAR(now_of(scene, "gate.x"), 9 + 0.1 * t + 0.3 * dt, 1e-9);
  CHECK_NEAR(now_of(scene, "vane.y"), sin(t - 2 * dt), 1e-9);
  CHECK_NEAR(now_of(scene, "entered") - before, 40 * dt, 1.1);
  scree_body fallen = body_of(scene, 0);
  CHECK_NEAR(fallen.position[2], ball.position[2] + ball.velocity[2] * dt - 0.81 * dt * dt,
             1e-3 * dt);
  CHECK_NEAR(now_of(scene, "late.count"), 1, 0);
  assert_true(isnan(at_row(scene, "late.count", 2)));
  CHECK_NEAR(at_row(scene, "gate.x", 2), 9.02, 1e-3);
  CHECK_NEAR(now_of(scene, "ledger"), 0, 1e-2);
  scree_scene_free(scene);
}

/* A brick that slides at 1 m/s slows down by mu g. */
static void friction(void **state) {
  (void)state;
  scree_scene *scene = make();
  run_until(scene, 0.1);
  scree_body was = body_of(scene, 1);
  CHECK_NEAR(was.velocity[0], 1 - 0.4 * 9.81 * 0.1, 0.02);
  change(&scene, "materials.m.friction=0.1");
  run_until(scene, 0.3);
  CHECK_NEAR(was.velocity[0] - body_of(scene, 1).velocity[0], 0.1 * 9.81 * 0.2, 0.01);
  scree_scene_free(scene);
}

static void refusals(void **state) {
  (void)state;
  static const struct {
    const char *what, *told;
  } cases[] = {{"shapes.ball.sphere=0.03", "shapes.ball.sphere: is 0.02"},
               {"materials.m.young=2e7", "cannot become 2e+07"},
               {"geometry.gate.box=[1, 1, 1]", "cannot become [1, 1, 1]"},
               {"geometry.lid={plane: [0, 0, -1]}", "geometry.lid: is not given"},
               {"output.series=0.2", "output.series: is 0.1"},
               {"inlets.feed.rate=fast", "inlets.feed.rate"},
               {"inlets.fed.rate=5", "no inlet 'fed'"},
               {"nothing.yaml", "nothing.yaml"},
               {"inlets.feed.box.max=[6, 2, 0.21]", "too small for 'ball'"}};
  scree_scene *scene = make();
  run_until(scene, 0.05);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const scree_scene *before = scene;
    scree_error error = {0};
    assert_int_not_equal(scree_scene_change(&scene, &cases[i].what, 1, &error), SCREE_OK);
    if (!strstr(error.message, cases[i].told)) fail_msg("%s: %s", cases[i].what, error.message);
    assert_ptr_equal(scene, before);
  }
  CHECK_NEAR(now_of(scene, "time"), 0.05, 1e-3);
  assert_int_equal(scree_scene_change_count(scene), 0);
  scree_scene_free(scene);
}

/* All rows of the series after a change of nearly everything, from a file. */
static scree_scene *go_on(int threads, bool by_checkpoint) {
  scree_error error;
  use_threads(threads);
  scree_scene *scene = make();
  run_until(scene, 0.4);
  put_in_folder(
      "change.yaml",
      "time: 1\nmaterials: {m: {friction: 0.2, restitution: 0.3}}\n"
      "geometry: {gate: {slide: {along: [1, 0, 0], mass: 3}, motion: []}, vane: {motion: "
      "[{vibrate: {along: [0, 0, 1], amplitude: 0.01, frequency: 5}}]}}\n"
      "inlets: {more: {box: {min: [7, 0, 0.2], max: [8, 2, 0.6]}, shapes: {brick: 1}, count: "
      "9}}\n"
      "sensors: {hits: {impacts: {}}, floor: {wall: floor}, door: {part: gate}}\n");
  const char *what = in_folder("change.yaml");
  CHECK_OK(scree_scene_change(&scene, &what, 1, &error), error);
  if (by_checkpoint) {
    run_until(scene, 0.6);
    CHECK_OK(scree_scene_save(scene, in_folder("kept.scree"), true, &error), error);
    scree_scene_free(scene);
    CHECK_OK(scree_scene_load(in_folder("kept.scree"), &scene, &error), error);
  }
  run_to_end(scene);
  use_threads(0);
  return scene;
}

static void same_bits(void **state) {
  (void)state;
  scree_scene *one = go_on(1, false);
  size_t rows, columns = scree_scene_column_count(one), changes = scree_scene_change_count(one);
  const double *series = scree_scene_series(one, &rows);
  assert_true(now_of(one, "hits.count") > 0 && now_of(one, "door.way") == 0);
  for (int k = 0; k < 2; k++) {
    scree_scene *other = go_on(k ? 1 : 3, k);
    size_t count;
    const double *same = scree_scene_series(other, &count);
    assert_int_equal(count, rows);
    assert_memory_equal(same, series, rows * columns * sizeof *series);
    assert_int_equal(scree_scene_change_count(other), changes);
    assert_string_equal(scree_scene_change_at(other, changes - 1).field,
                        scree_scene_change_at(one, changes - 1).field);
    scree_scene_free(other);
  }
  scree_scene_free(one);
}

static scree_status load_and_change(void *unused, scree_error *error) {
  const char *what[] = {"materials.m.friction=0.2", "sensors.hits={impacts: {}}",
                        "geometry.vane.motion=[]", "inlets.feed.rate=20"};
  scree_scene *scene;
  (void)unused;
  scree_status status = scree_scene_load(in_folder("early.scree"), &scene, error);
  if (status != SCREE_OK) return status;
  status = scree_scene_change(&scene, what, 4, error);
  scree_scene_free(scene);
  return status;
}

static void out_of_memory(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene = make();
  run_until(scene, 0.12);
  CHECK_OK(scree_scene_save(scene, in_folder("early.scree"), true, &error), error);
  scree_scene_free(scene);
  check_allocation_failures(load_and_change, NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(walls_rates_and_gravity),
      cmocka_unit_test(friction),
      cmocka_unit_test(refusals),
      cmocka_unit_test(same_bits),
      cmocka_unit_test(out_of_memory),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
