/* Motions of a scene's geometry: by crank and rod, by a table in a file, and of copies about an
 * axis and along a chain; they go on after a checkpoint with the same bits. */
#include "base/vec.h"
#include "support/folder.h"
#include "support/law.h"
#include "support/scene.h"

static const double pi = 3.14159265358979323846;

static scree_status try_scene(const char *geometry, scree_scene **scene, scree_error *error) {
  char text[3000];
  scree_scene_file *file = NULL;
  snprintf(text, sizeof text,
           "time: 4\n"
           "shapes: {ball: {sphere: 0.01}}\n"
           "geometry:\n  part: {box: [0.02, 0.02, 0.02], %s}\n"
           "inlets: {i: {box: {min: [9, 9, 9], max: [9.1, 9.1, 9.1]}, shapes: ball, count: 1}}\n"
           "domain: {min: [-20, -20, -90], max: [20, 20, 20]}\n",
           geometry);
  scree_status status =
      scree_scene_file_parse(text, strlen(text), in_folder("scene.yaml"), &file, error);
  if (status == SCREE_OK) status = scree_scene_create(file, NULL, scene, error);
  scree_scene_file_free(file);
  return status;
}

static scree_scene *scene_of(const char *geometry) {
  scree_error error;
  scree_scene *scene = NULL;
  CHECK_OK(try_scene(geometry, &scene, &error), error);
  return scene;
}

static double time_of(const scree_scene *scene) {
  return scree_world_time(scree_scene_view(scene));
}

static vec3 place_of(const scree_scene *scene, size_t wall) {
  scree_wall w;
  scree_world_get_wall(scree_scene_view(scene), wall, &w);
  return vec3_load(w.position);
}

static void slides_by_crank(void **state) {
  (void)state;
  scree_scene *scene = scene_of(
      "motion: [{crank: {along: [0, 0, 2], radius: 30 mm, rod: 0.1, speed: 120 rpm, phase: 0.5}}]");
  double off = 0;
  for (int k = 1; k < 20; k++) {
    run_until(scene, 0.1 * k);
    const double q = 4 * pi * time_of(scene) + 0.5,
                 at = 0.03 * cos(q) + sqrt(0.01 - 9e-4 * sin(q) * sin(q)),
                 from = 0.03 * cos(0.5) + sqrt(0.01 - 9e-4 * sin(0.5) * sin(0.5));
    off = fmax(off, vec3_distance(place_of(scene, 0), (vec3){0, 0, at - from}));
  }
  LAW_BELOW("W6", "off the crank's place, m", off, 1e-12);
  scree_scene_free(scene);
}

/* A quarter turn about z through (1, 0, 0) within a second while it rises; then it rests. */
static void follows_a_table(void **state) {
  (void)state;
  put_in_folder("path.csv", "# a comment\nt [ms], z [mm], angle_z [deg]\n0,0,0\n1000, 100, 90\n");
  scree_scene *scene = scene_of("motion: [{path: {file: path.csv, through: [1, 0, 0]}}]");
  double off = 0;
  for (int k = 1; k < 20; k++) {
    run_until(scene, 0.1 * k);
    const double share = fmin(1, time_of(scene)), q = 0.5 * pi * share;
    off = fmax(off, vec3_distance(place_of(scene, 0), (vec3){1 - cos(q), -sin(q), 0.1 * share}));
  }
  LAW_BELOW("W6", "off the table's place, m", off, 1e-12);
  double turn[4];
  scree_world_wall_orientation(scree_scene_view(scene), 0, turn);
  LAW_NEAR("W6", "angle at the end, rad", 2 * atan2(turn[3], turn[0]), 0.5 * pi, 1e-12);
  scree_scene_free(scene);
}

static void copies_stand_about_an_axis(void **state) {
  (void)state;
  scree_scene *scene = scene_of("at: [0, 0.5, 0], copies: {count: 5, axis: [1, 0, 0]}, "
                                "motion: [{rotate: {axis: [1, 0, 0], speed: 2}}]");
  assert_int_equal(scree_world_wall_count(scree_scene_view(scene)), 5);
  run_until(scene, 0.7);
  for (size_t k = 0; k < 5; k++) {
    const double q = 2 * pi * (double)k / 5 + 2 * time_of(scene);
    LAW_BELOW("W6", "off a copy's place, m",
              vec3_distance(place_of(scene, k), (vec3){0, 0.5 * cos(q), 0.5 * sin(q)}), 1e-12);
  }
  scree_scene_free(scene);
}

/* The way s of what stands 0.15 m from wheels of 0.1 m, 0.5 m apart along z, about y. */
static vec3 on_chain(double s) {
  s = fmod(s, 1 + 0.2 * pi);
  if (s < 0.5) return (vec3){-0.15, 0, s};
  s -= 0.5;
  if (s < 0.1 * pi) return (vec3){-0.15 * cos(s / 0.1), 0, 0.5 + 0.15 * sin(s / 0.1)};
  s -= 0.1 * pi;
  if (s < 0.5) return (vec3){0.15, 0, 0.5 - s};
  s -= 0.5;
  return (vec3){0.15 * cos(s / 0.1), 0, -0.15 * sin(s / 0.1)};
}

static const char *const chain =
    "at: [-0.15, 0, 0], copies: {count: 7, axis: [0, 1, 0], span: [0, 0, 0.5], radius: 0.1}, "
    "motion: [{round: {speed: 0.4}}]";

/* Also after a checkpoint, and with another speed from where they are. */
static void copies_go_with_a_chain(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene = scene_of(chain), *loaded = NULL;
  run_until(scene, 1);
  CHECK_OK(scree_scene_save(scene, in_folder("chain.scree"), true, &error), error);
  CHECK_OK(scree_scene_load(in_folder("chain.scree"), &loaded, &error), error);
  const double then = time_of(scene);
  for (int change = 0; change < 2; change++) {
    const char *const faster = "geometry.part.motion.0.round.speed=0.9";
    if (change) CHECK_OK(scree_scene_change(&loaded, &faster, 1, &error), error);
    run_until(scene, 2.5);
    run_until(loaded, 2.5);
    const double later = time_of(loaded);
    for (size_t k = 0; k < 7; k++) {
      const double s = (1 + 0.2 * pi) * (double)k / 7;
      LAW_BELOW("W6", "off a bucket's place, m",
                vec3_distance(place_of(scene, k), on_chain(s + 0.4 * time_of(scene))), 1e-12);
      const double way = change ? 0.9 * (later - then) : 0.4 * (later - then);
      LAW_BELOW("W6", "off it after a checkpoint, m",
                vec3_distance(place_of(loaded, k), on_chain(s + 0.4 * then + way)), 1e-12);
    }
    scree_scene_free(loaded);
    loaded = NULL;
    if (!change) CHECK_OK(scree_scene_load(in_folder("chain.scree"), &loaded, &error), error);
  }
  scree_scene_free(scene);
}

static void bad_motions_are_told(void **state) {
  (void)state;
  static const char *const tables[][2] = {
      {"t,u\n0,1\n", "line 1: no column 'u'; there are x, y, z, angle_x"},
      {"x,y\n0,1\n", "needs a column t"},
      {"t\n0\n", "needs a column t and one of"},
      {"t,x\n", "no row after the names"},
      {"", "no line of names"},
      {"t,x [s]\n0,0\n", "the column x is in m, not 's'"},
      {"t,x\n0,0\n0,1\n", "line 3: t 0 s: must come after the row before, 0 s"},
      {"t,x\n0,0,1\n", "line 2: more fields than names"},
      {"t,x\n0,0\n1,a\n", "line 3: x is 'a', which is no number"},
  };
  static const char *const scenes[][2] = {
      {"motion: [{path: {file: none.csv}}]", "none.csv"},
      {"motion: [{path: {through: [0, 0, 1]}}]", "needs a file"},
      {"motion: [{crank: {radius: 0.1, rod: 0.1, speed: 1}}]", "must be longer than the radius"},
      {"motion: [{round: {speed: 1}}]", "give copies"},
      {"copies: {axis: [0, 0, 1]}", "needs a count"},
      {"copies: {count: 3, span: [1, 0, 0]}", "span and radius go together"},
      {"copies: {count: 3, span: [0, 0, 1], radius: 0.1}", "span must be square to the axis"},
  };
  scree_error error;
  scree_scene *scene = NULL;
  for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
    put_in_folder("bad.csv", tables[i][0]);
    assert_int_not_equal(try_scene("motion: [{path: {file: bad.csv}}]", &scene, &error), SCREE_OK);
    if (!strstr(error.message, tables[i][1])) fail_msg("%s", error.message);
  }
  for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
    assert_int_not_equal(try_scene(scenes[i][0], &scene, &error), SCREE_OK);
    if (!strstr(error.message, scenes[i][1])) fail_msg("%s", error.message);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(slides_by_crank),
      cmocka_unit_test(follows_a_table),
      cmocka_unit_test(copies_stand_about_an_axis),
      cmocka_unit_test(copies_go_with_a_chain),
      cmocka_unit_test(bad_motions_are_told),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
