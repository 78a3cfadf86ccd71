/* Whether contacts are stiff enough is told before the first step: what is foretold is what a hit
 * comes to, the stiffness that is named holds, the motion of walls counts, and an inlet whose
 * bodies would pass what they hit is refused. Templates keep to it. */
#include "scene/scene.h"
#include "scree.h"
#include "support/check.h"

#include <unistd.h>

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
  char sentence[SCREE_REMARK], young[32];
  set(file, "inlets.feed.velocity", "[0, 0, -5]");
  scree_scene_softness s = soft(file, &is_soft);
  assert_true(is_soft && s.overlap > s.limit && s.stiffer > 1);
  CHECK_NEAR(s.speed, sqrt(25 + 2 * 10 * 0.0502), 1e-3); /* to the deck's underside */
  scree_scene *scene = create(file);
  scree_scene_describe_softness(scene, sentence);
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
  scree_scene_describe_softness(scene, sentence);
  assert_non_null(strstr(sentence, "contact.stiffness_factor "));
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

/* From the highest place of the inlet, 30.2 mm up: to the underside of a deck, whatever else is
 * endless, to a plane, of one aslant from its highest corner; a lid or a side stops nothing. */
static void falls_end_where_geometry_does(void **state) {
  (void)state;
  static const struct {
    const char *geometry;
    double falls;
  } rows[] = {
      {"{deck: {box: [0.2, 0.2, 0.02], at: [0, 0, -0.01]}}", 0.0502},
      {"{deck: {box: [0.2, 0.2, 0.02], at: [0, 0, -0.01]}, sides: {shaft: {width: 0.2, depth: "
       "0.2}}}",
       0.0502},
      {"{deck: {box: [0.2, 0.2, 0.02], at: [0, 0, -0.01]}, tube: {cylinder: {radius: 0.1, axis: "
       "[0, 0, 1], length: 0}}}",
       0.0502},
      {"{floor: {plane: [0, 0, 1], at: [0, 0, -0.1]}}", 0.1302},
      {"{floor: {plane: [0, 0, 1], at: [0, 0, -0.1]}, lid: {plane: [0, 0, -1], at: [0, 0, 1]}}",
       0.1302},
      {"{floor: {plane: [0, 0, 1], at: [0, 0, -0.1]}, deck: {box: [0.01, 0.01, 0.01]}}", 0.1302},
      {"{slope: {plane: [1, 0, 1], at: [0, 0, -0.1]}}", 0.1302 + 0.05},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_scene_file *file = parse();
    bool is_soft;
    set(file, "materials", "{grain: {young: 1e6, density: 2500, restitution: 1, friction: 0}}");
    set(file, "geometry", rows[i].geometry);
    CHECK_NEAR(soft(file, &is_soft).speed, sqrt(4 + 2 * 10 * rows[i].falls), 1e-6);
    scree_scene_file_free(file);
  }
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

/* A ball of 30 mm at 1.2 m/s on a grain of 6 mm: bisected, 5.9 times the stiffness holds it. */
static void heavy_bodies_squeeze_light_ones(void **state) {
  (void)state;
  static const char squeezing[] =
      "time: 0.3\n"
      "gravity: [0, 0, 0]\n"
      "materials: {ore: {young: 5e6, density: 2600}, steel: {young: 5e7}}\n"
      "shapes: {fine: {sphere: 6 mm, material: ore}, big: {sphere: 30 mm, material: ore}}\n"
      "geometry: {floor: {box: [0.2, 0.2, 0.02], at: [0, 0, -0.01], material: steel}}\n"
      "inlets: {a: {box: {min: [-0.01, -0.01, 0], max: [0.01, 0.01, 0.02]}, shapes: fine, count: "
      "1},"
      " b: {box: {min: [-0.02, -0.02, 0.03], max: [0.02, 0.02, 0.07]}, shapes: big, count: 1, "
      "velocity: [0, 0, -1.2]}}\n"
      "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\n";
  scree_error error;
  scree_scene_file *file = NULL;
  CHECK_OK(scree_scene_file_parse(squeezing, strlen(squeezing), "test.yaml", &file, &error), error);
  scree_scene *scene = create(file);
  scree_scene_softness s;
  char sentence[SCREE_REMARK];
  assert_true(scree_scene_squeezes(scene, &s));
  CHECK_NEAR(s.stiffer, 6.32, 0.02);
  scree_scene_describe_softness(scene, sentence);
  double row[4];
  const char *names = strstr(sentence, "fine, pressed on floor by big");
  if (strncmp(sentence, "inlets.b: too soft", 18) != 0 || !names) fail_msg("%s", sentence);
  assert_int_equal(sscanf(names + strlen("fine, pressed on floor by big"), "%lf %lf %lf %lf",
                          &row[0], &row[1], &row[2], &row[3]),
                   4);
  CHECK_NEAR(row[0], 1.2, 1e-9);
  CHECK_NEAR(row[1], 0.0265, 1e-4);
  CHECK_NEAR(row[2] / row[3], sqrt(s.stiffer), 0.01);
  if (!strstr(sentence, "contact.stiffness_factor 6.4 or more, 2.51 times the steps"))
    fail_msg("%s", sentence);
  assert_false(scree_scene_soft(scene, &s));
  scree_scene_free(scene);
  set(file, "contact.stiffness_factor", "6.4");
  scene = create(file);
  assert_false(scree_scene_squeezes(scene, &s));
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

/* Bodies of a table are told as those of inlets are. */
static void tables_are_looked_at(void **state) {
  (void)state;
  static const char table[] = "shape,x,y,z,vz\nball,0,0,0.05,-5\nball,0.05,0,0.05,-1\n",
                    path[] = "scene_soft.csv";
  FILE *stream = fopen(path, "w");
  assert_non_null(stream);
  fputs(table, stream);
  fclose(stream);
  scree_scene_file *file = parse();
  set(file, "gravity", "[0, 0, 0]");
  set(file, "bodies.file", path);
  scree_scene *scene = create(file);
  scree_scene_softness s;
  char sentence[SCREE_REMARK];
  assert_true(scree_scene_soft(scene, &s));
  CHECK_NEAR(s.speed, 5, 1e-12);
  scree_scene_describe_softness(scene, sentence);
  if (strncmp(sentence, "bodies: too soft", 16) != 0) fail_msg("%s", sentence);
  scree_scene_free(scene);
  /* nor is their speed foreseen for the steps of Hertz's law */
  set(file, "contact.law", "hertz");
  set(file, "materials.grain.young", "1e8");
  scree_error error;
  scene = create(file);
  CHECK_OK(scree_scene_advance(scene, 100, &error), error);
  assert_true(scree_scene_doubt(scene, 0, sentence));
  if (!strstr(sentence, "at up to 5 m/s, and the steps suit hits at 2,") ||
      !strstr(sentence, "contact.steps 25 would"))
    fail_msg("%s", sentence);
  assert_false(scree_scene_doubt(scene, 1, sentence));
  scree_scene_free(scene);
  scree_scene_file_free(file);
  remove(path);
}

/* It steps, and goes on from a checkpoint, that knows for which speed its steps are. */
static void goes_on(scree_scene *scene) {
  char path[64], sentence[SCREE_REMARK];
  scree_error error;
  scree_scene *loaded;
  snprintf(path, sizeof path, "/tmp/scree_soft_%ld.scree", (long)getpid());
  CHECK_OK(scree_scene_advance(scene, 10, &error), error);
  CHECK_OK(scree_scene_save(scene, path, true, &error), error);
  CHECK_OK(scree_scene_load(path, &loaded, &error), error);
  remove(path);
  CHECK_OK(scree_scene_advance(loaded, 100, &error), error);
  if (scree_scene_doubt(loaded, 0, sentence)) fail_msg("%s", sentence);
  scree_scene_free(loaded);
}

/* Hertz's contacts last as v^-1/5: so does the step, by the speed foreseen; others' does not. Also
 * the fewest steps a contact are enough. */
static void steps_follow_the_speed(void **state) {
  (void)state;
  static const char *const speeds[] = {"[0, 0, -0.2]", "[0, 0, -6.4]"};
  double steps[2][2];
  for (int hertz = 0; hertz < 2; hertz++)
    for (int k = 0; k < 2; k++) {
      scree_scene_file *file = parse();
      set(file, "gravity", "[0, 0, 0]");
      set(file, "contact.law", hertz ? "hertz" : "linear");
      set(file, "materials.grain.young", "1e8");
      set(file, "inlets.feed.velocity", speeds[k]);
      set(file, "contact.steps", "15");
      scree_scene *scene = create(file);
      steps[hertz][k] = scree_world_time_step(scree_scene_view(scene), NULL);
      goes_on(scene);
      scree_scene_free(scene);
      scree_scene_file_free(file);
    }
  /* one that is given is held against hits at 1 m/s */
  scree_scene_file *file = parse();
  char given[32];
  set(file, "contact.law", "hertz");
  set(file, "materials.grain.young", "1e8");
  set(file, "inlets.feed.velocity", speeds[1]);
  snprintf(given, sizeof given, "%.17g", steps[1][1] * pow(6.4, 0.2));
  set(file, "contact.time_step", given);
  scree_scene *scene = create(file);
  goes_on(scene);
  scree_scene_free(scene);
  scree_scene_file_free(file);
  CHECK_NEAR(steps[0][0] / steps[0][1], 1, 1e-12);
  CHECK_NEAR(steps[1][0] / steps[1][1], 2, 1e-9); /* 32 times as fast */
}

/* A lid comes down on the deck from 12 mm to this gap, and rises again: a ball of 10 mm is pressed
 * from both sides. One that slides by as low, or goes with the deck, closes on nothing. */
static void closing_geometry_is_told(void **state) {
  (void)state;
  static const struct {
    const char *at, *along, *ways, *deck;
    double narrow; /* mm; 0: nothing */
  } rows[] = {
      {"[0, 0, 0.022]", "[0, 0, 1]", "[[0, 0], [0.15, -6e-3], [0.3, 0]]", "[]", 6},
      {"[0, 0, 0.022]", "[0, 0, 1]", "[[0, 0], [0.15, -3e-3], [0.3, 0]]", "[]", 0},
      {"[-0.3, 0, 0.016]", "[1, 0, 0]", "[[0, 0], [0.15, 0.6], [0.3, 0]]", "[]", 0},
      {"[0, 0, 0.016]", "[0, 0, 1]", "[[0, 0], [0.15, -0.1], [0.3, 0]]",
       "[{translate: {along: [0, 0, 1], positions: [[0, 0], [0.15, -0.1], [0.3, 0]]}}]", 0},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_error error;
    scree_scene_file *file = NULL;
    char with[1200];
    snprintf(
        with, sizeof with,
        "%sgeometry:\n  deck: {box: [0.2, 0.2, 0.02], at: [0, 0, -0.01], material: steel, "
        "motion: %s}\n  lid: {box: [0.1, 0.1, 0.02], at: %s, material: steel, motion: "
        "[{translate: {along: %s, positions: %s}}]}\n%s",
        "time: 0.3\ngravity: [0, 0, 0]\nmaterials: {grain: {young: 1e6, density: 2500}, "
        "steel: {young: 1e9}}\nshapes: {ball: {sphere: 0.01, material: grain}}\n",
        rows[i].deck, rows[i].at, rows[i].along, rows[i].ways,
        "inlets: {feed: {box: {min: [-0.05, 0.06, 0], max: [0.05, 0.09, 0.011]}, shapes: ball, "
        "count: 1}}\ndomain: {min: [-1, -1, -1], max: [1, 1, 1]}\n");
    CHECK_OK(scree_scene_file_parse(with, strlen(with), "test.yaml", &file, &error), error);
    scree_scene *scene = create(file);
    scree_scene_pinch p;
    const bool closes = scree_scene_pinches(scene, 0.3, &p);
    assert_int_equal(closes, rows[i].narrow > 0);
    if (closes) {
      CHECK_NEAR(1e3 * p.narrow, rows[i].narrow, 0.3); /* moments are few */
      CHECK_NEAR(p.overlap, 0.5 * (0.01 - p.narrow), 1e-9);
      CHECK_NEAR(p.room, 0.008, 1e-9);
    }
    scree_scene_free(scene);
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
      char sentence[SCREE_REMARK];
      scree_scene_describe_softness(scene, sentence);
      fail_msg("%s: %s", scree_scene_template_name(i), sentence);
    }
    scree_scene_free(scene);
    scree_scene_file_free(file);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(foretold_is_what_comes),          cmocka_unit_test(what_is_named_holds),
      cmocka_unit_test(falls_end_where_geometry_does),   cmocka_unit_test(walls_move),
      cmocka_unit_test(heavy_bodies_squeeze_light_ones), cmocka_unit_test(tables_are_looked_at),
      cmocka_unit_test(steps_follow_the_speed),          cmocka_unit_test(closing_geometry_is_told),
      cmocka_unit_test(what_would_pass_is_refused),      cmocka_unit_test(templates_keep_to_it)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
