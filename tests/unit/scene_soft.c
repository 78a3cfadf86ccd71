/* Whether contacts are stiff enough is told before the first step: what is foretold is what a hit
 * comes to, the stiffness that is named holds, the motion of walls counts, and an inlet whose
 * bodies would pass what they hit is refused. Templates keep to it. */
#include "scene/scene.h"
#include "scree.h"
#include "support/check.h"

static const char text[] =
    "time: 0.3\n"
    "gravity: [0, 0, -10]\n"
    "materials: {grain: {young: 1e6, density: 2500, restitution: 1, friction: 0}, steel: {young: "
    "1e9, restitution: 1, friction: 0}}\n"
    "shapes: {ball: {sphere: 0.01, material: grain}}\n"
    "geometry: {deck: {box: [0.2, 0.2, 0.02], at: [0, 0, -0.01], material: steel}}\n"
    "inlets: {feed: {box: {min: [-0.05, -0.05, 0.02], max: [0.05, 0.05, 0.0302]}, shapes: ball, "
    "count: 1, velocity: [0, 0, -2]}}\n"
    "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\n"
    "output: {series: 1e-4}\n";

static scree_scene_file *parse(void) {
  scree_error error;
  scree_scene_file *file = NULL;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), "test.yaml", &file, &error), error);
  return file;
}

static void set(scree_scene_file *file, const char *field, const char *value) {
  scree_error error;
  CHECK_OK(scree_scene_file_set(file, field, value, &error), error);
}

static scree_scene *create(const scree_scene_file *file) {
  scree_error error;
  scree_scene *scene = NULL;
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  return scene;
}

static scree_scene_softness soft(const scree_scene_file *file, bool *is_soft) {
  scree_scene_softness s;
  scree_scene *scene = create(file);
  *is_soft = scree_scene_soft(scene, &s);
  scree_scene_free(scene);
  return s;
}

/* Without gravity, so that the speed is known. */
static void foretold_is_what_comes(void **state) {
  (void)state;
  scree_scene_file *file = parse();
  bool is_soft;
  set(file, "gravity", "[0, 0, 0]");
  scree_scene_softness s = soft(file, &is_soft);
  assert_false(is_soft);
  CHECK_NEAR(s.speed, 2, 1e-12);
  CHECK_NEAR(s.limit, 1e-3, 1e-12);
  scree_scene *scene = create(file);
  scree_error error;
  double deepest = 0;
  while (!scree_scene_end(scene) && scree_world_time(scree_scene_view(scene)) < 0.03) {
    scree_observation o;
    CHECK_OK(scree_scene_advance(scene, 1, &error), error);
    scree_world_observe(scree_scene_view(scene), &o);
    deepest = fmax(deepest, o.largest_overlap);
  }
  CHECK_NEAR(deepest, s.overlap, 0.01 * s.overlap);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

static void what_is_named_holds(void **state) {
  (void)state;
  scree_scene_file *file = parse();
  bool is_soft;
  char sentence[600], young[32];
  set(file, "inlets.feed.velocity", "[0, 0, -5]");
  scree_scene_softness s = soft(file, &is_soft);
  assert_true(is_soft && s.overlap > s.limit && s.stiffer > 1);
  CHECK_NEAR(s.speed, sqrt(25 + 2 * 10 * 0.0502), 1e-3); /* to the deck's underside */
  scree_scene *scene = create(file);
  scree_scene_describe_softness(scene, &s, sentence, sizeof sentence);
  scree_scene_free(scene);
  const char *named = strstr(sentence, "materials.grain.young ");
  if (!named) fail_msg("%s", sentence);
  snprintf(young, sizeof young, "%g", strtod(named + 22, NULL));
  set(file, "materials.grain.young", young);
  soft(file, &is_soft);
  assert_false(is_soft);
  snprintf(young, sizeof young, "%g", 0.8 * strtod(named + 22, NULL));
  set(file, "materials.grain.young", young);
  soft(file, &is_soft);
  assert_true(is_soft);
  /* a wall as soft as that no grain holds on: the factor does */
  set(file, "materials.steel.young", "3e5");
  scene = create(file);
  assert_true(scree_scene_soft(scene, &s));
  scree_scene_describe_softness(scene, &s, sentence, sizeof sentence);
  assert_non_null(strstr(sentence, "contact.stiffness_factor "));
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

static void walls_move(void **state) {
  (void)state;
  static const struct {
    const char *motion;
    double speed;
  } rows[] = {
      {"[{translate: {velocity: [0, 3, 4]}}]", 5},
      {"[{translate: {along: [0, 0, 1], table: [[0, 1], [1, -6]]}}]", 6},
      {"[{translate: {along: [0, 0, 1], positions: [[0, 0], [1, 2], [1.5, 5]]}}]", 6},
      {"[{rotate: {axis: [0, 0, 1], through: [0.1, 0.1, 0], speed: -10}}]", 10 * 0.2 * 1.41421356},
      {"[{vibrate: {along: [0, 0, 1], amplitude: 0.01, frequency: 50}}]", 3.14159265},
      {"[{translate: {velocity: [1, 0, 0]}}, {vibrate: {along: [1, 0, 0], amplitude: 0.01, "
       "frequency: "
       "50}}]",
       4.14159265},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_scene_file *file = parse();
    bool is_soft;
    set(file, "gravity", "[0, 0, 0]");
    set(file, "geometry.deck.motion", rows[i].motion);
    scree_scene_softness s = soft(file, &is_soft);
    assert_true(s.is_wall);
    CHECK_NEAR(s.speed, 2 + rows[i].speed, 1e-6);
    scree_scene_file_free(file);
  }
}

static void what_would_pass_is_refused(void **state) {
  (void)state;
  scree_scene_file *file = parse();
  scree_scene *scene = NULL;
  scree_error error;
  set(file, "inlets.feed.velocity", "[0, 0, -30]");
  assert_int_not_equal(scree_scene_create(file, NULL, &scene, &error), SCREE_OK);
  if (!strstr(error.message, "inlets.feed: enters so fast that bodies would pass what they hit"))
    fail_msg("%s", error.message);
  set(file, "materials.grain.young", "1e9");
  scree_scene_free(create(file));
  scree_scene_file_free(file);
}

static void templates_keep_to_it(void **state) {
  (void)state;
  for (size_t i = 0; scree_scene_template_name(i); i++) {
    scree_error error;
    scree_scene_file *file;
    scree_scene_softness s;
    const char *yaml = scree_scene_template(scree_scene_template_name(i));
    CHECK_OK(scree_scene_file_parse(yaml, strlen(yaml), "template", &file, &error), error);
    scree_scene *scene = create(file);
    if (scree_scene_soft(scene, &s)) {
      char sentence[600];
      scree_scene_describe_softness(scene, &s, sentence, sizeof sentence);
      fail_msg("%s: %s", scree_scene_template_name(i), sentence);
    }
    scree_scene_free(scene);
    scree_scene_file_free(file);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(foretold_is_what_comes), cmocka_unit_test(what_is_named_holds),
      cmocka_unit_test(walls_move), cmocka_unit_test(what_would_pass_is_refused),
      cmocka_unit_test(templates_keep_to_it)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
