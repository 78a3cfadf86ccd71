/* A scene's file: each mistake that a person makes is told in one sentence with its place and with
 * what is allowed; what is printed reads back to the same; single fields are set. */
#include "base/platform.h"
#include "support/check.h"
#include "support/folder.h"

#include "scree.h"

static const char good[] =
    "title: test\n"                                                    /* 1 */
    "time: 2\n"                                                        /* 2 */
    "seed: 3\n"                                                        /* 3 */
    "materials:\n"                                                     /* 4 */
    "  grain: {young: 1e6, density: 2500, friction: 0.5}\n"            /* 5 */
    "  steel: {young: 1e8}\n"                                          /* 6 */
    "pairs:\n"                                                         /* 7 */
    "  - {between: [grain, steel], restitution: 0.5, friction: 0.3}\n" /* 8 */
    "shapes:\n"                                                        /* 9 */
    "  ball: {sphere: 0.01, material: grain}\n"                        /* 10 */
    "  brick: {box: [0.02, 0.01, 0.01], material: grain}\n"            /* 11 */
    "geometry:\n"                                                      /* 12 */
    "  floor: {plane: [0, 0, 1], at: [0, 0, 0], material: steel}\n"    /* 13 */
    "  deck: {box: [0.1, 0.1, 0.01], at: [0, 0, 0.1], material: steel, "
    "motion: [{vibrate: {along: [0, 0, 1], amplitude: 1e-3, frequency: 20}}]}\n"
    "inlets:\n" /* 15 */
    "  feed: {box: {min: [-0.1, -0.1, 0.2], max: [0.1, 0.1, 0.3]}, "
    "shapes: {ball: 3, brick: 1}, rate: 20, until: 1}\n"          /* 16 */
    "outlets:\n"                                                  /* 17 */
    "  end: {box: {min: [0.5, -1, -1], max: [2, 1, 1]}}\n"        /* 18 */
    "domain: {min: [-1, -1, -1], max: [2, 1, 1]}\n"               /* 19 */
    "sensors:\n"                                                  /* 20 */
    "  flow: {flow: {through: [0.4, 0, 0], normal: [1, 0, 0]}}\n" /* 21 */
    "  load: {wall: deck}\n"                                      /* 22 */
    "stop: {still: 1e-6 J, empty: true}\n"                        /* 23 */
    "output: {frames: 0.1, series: 0.01}\n";                      /* 24 */

/* What is written for what, and what must be said. */
static const struct {
  const char *from, *to, *line, *says;
} mistakes[] = {
    {"time: 2\n", "tiem: 2\n", "line 2, column 1",
     "no field 'tiem' in a scene; did you mean 'time'"},
    {"time: 2\n", "", "line 1, column 1", "needs time"},
    {"time: 2\n", "time: 2 mins\n", "line 2, column 7", "must be a number in s; what is 'mins'?"},
    {"time: 2\n", "time: 2 kg\n", "line 2, column 7", "in s; 'kg' measures something else"},
    {"time: 2\n", "time: 2\nbodies: {}\n", "line 3", "bodies: needs a file"},
    {"time: 2\n", "time: -2\n", "line 2", "-2: must be 1e-09 to 1e+09 s"},
    {"time: 2\n", "time: soon\n", "line 2", "'soon': must be a number in s"},
    {"time: 2\n", "time: [2]\n", "line 2", "must be one number"},
    {"time: 2\n", "time: 2\ntime: 3\n", "line 3, column 1", "this key stands here twice"},
    {"seed: 3", "seed: 1.5", "line 3", "must be a whole number"},
    {"time: 2\n", "time: 0,2\n", "line 2, column 7", "'0,2': has a decimal comma; write a point"},
    {"time: 2\n", "time 2\n", "line 2, column 1", "must be `key: value`"},
    {"time: 2\n", "\ttime: 2\n", "line 2, column 1", "a tab: lines are indented"},
    {"young: 1e6", "young: 1e6 mN", "line 5", "a number in Pa; 'mN' measures something"},
    {"young: 1e6", "youngs: 1e6", "line 5, column 11", "did you mean 'young'"},
    {"density: 2500", "density: 0", "line 5", "materials.grain.density: 0: must be"},
    {"friction: 0.5", "friction: 0,5", "line 5", "friction: 0,5: has a decimal comma; write 0.5"},
    {"friction: 0.5", "friction: -0.5", "line 5", "-0.5: must be 0 to 100"},
    {"restitution: 0.5", "restitution: 1.5", "line 8", "1.5: must be 0.01 to 1"},
    {"between: [grain, steel]", "between: [grain, steal]", "line 8",
     "no material 'steal'; did you mean 'steel'"},
    {"between: [grain, steel]", "between: [grain]", "line 8", "between: [material, material]"},
    {"pairs:\n", "pairs:\n  - {between: [steel, grain]}\n", "line 9, column 5",
     "'grain' and 'steel' are a pair already"},
    {"pairs:\n  - ", "pairs:\n  a: ", "line 8", "must be a list of groups"},
    {"sphere: 0.01", "sphere: 10 km", "line 10", "shapes.ball.sphere: 10000: must be"},
    {"sphere: 0.01", "sphere: 0", "line 10", "shapes.ball.sphere: 0: must be"},
    {"sphere: 0.01, ", "", "line 10", "needs one of file, sample, sphere"},
    {"sphere: 0.01", "sphere: 0.01, file: a.stl", "line 10", "only one of file, sample, sphere"},
    {"sphere: 0.01", "clump: 12", "line 10", "so many spheres stand for a file, sample or box"},
    {"sphere: 0.01", "file: a.stl, clump: 301", "line 10", "must be 1 to 300 spheres"},
    {"sphere: 0.01", "sphere: 0.01, triangles: 100", "line 10", "are of scans"},
    {"sphere: 0.01", "file: a.stl, triangles: few", "line 10",
     "must be recommended, all, or a count of 4 or more"},
    {"sphere: 0.01", "file: a.stl, rp: 2", "line 10",
     "rp '2': must be a number above 0 and at most 1"},
    {"sphere: 0.01", "file: a.stl, rp: -1*recommended", "line 10", "a multiple as 0.5*"},
    {"sphere: 0.01", "file: a.stl, rp: recomended", "line 10", "must be a number above 0"},
    {"sphere: 0.01", "file: a.stl, unit: miles", "line 10", "must be one of m|cm|mm"},
    {"sphere: 0.01", "file: a.stl, triangles: 100, rp: 1e-3", "line 10", "give one"},
    {"ball: {sphere: 0.01, material: grain}", "ball: {sphere: 0.01}", "line 10",
     "needs a material"},
    {"ball: {sphere: 0.01, material: grain}", "ball: 0.01", "line 10", "must be a group"},
    {"at: [0, 0, 0]", "at: [0, 0,1, 0]", "line 13", "not a comma"},
    {"plane: [0, 0, 1]", "plane: [0, 0]", "line 13", "must be 3 numbers"},
    {"plane: [0, 0, 1]", "plane: [0, 0, 0]", "line 13", "points nowhere"},
    {"plane: [0, 0, 1]", "plane: [0, 0, 1], surface_velocity: [0, 0, 1]", "line 13",
     "must lie in the surface"},
    {"plane: [0, 0, 1]", "cylinder: {diameter: 1}", "line 13", "no field 'diameter'"},
    {"plane: [0, 0, 1]", "plan: [0, 0, 1]", "line 13", "did you mean 'plane'"},
    {"motion: [{vibrate: {along: [0, 0, 1], amplitude: 1e-3, frequency: 20}}]",
     "slide: {spring: 1}", "line 14", "needs a mass or a servo"},
    {"motion: [", "hinge: {inertia: 1}, motion: [", "line 14", "only one of motion, slide, hinge"},
    {"motion: [{vibrate: {along: [0, 0, 1], amplitude: 1e-3, frequency: 20}}]",
     "slide: {servo: {force: 5, speed: 1}, spring: 1}", "line 14", "a servo stands instead of"},
    {"load: {wall: deck}", "load: {part: deck}", "line 22", "'deck' has neither slide nor hinge"},
    {"amplitude: 1e-3, ", "", "line 14", "needs amplitude and frequency"},
    {"motion: [{vibrate: {along: [0, 0, 1], amplitude: 1e-3, frequency: 20}}]",
     "motion: {vibrate: {frequency: 20}}", "line 14", "must be a list of groups"},
    {"vibrate: {along: [0, 0, 1], amplitude: 1e-3, frequency: 20}",
     "rotate: {table: [[0, 1], [0, 2]]}", "line 14",
     "the first number of rows must rise: 0 after 0"},
    {"vibrate: {along: [0, 0, 1], amplitude: 1e-3, frequency: 20}", "rotate: {axis: [0, 0, 1]}",
     "line 14", "needs one of speed, table"},
    {"rate: 20", "rate: 20 rpm", "line 16", "in 1/s; 'rpm' measures something else"},
    {"rate: 20", "rate: -20", "line 16", "-20: must be 0 to 1e+09 1/s"},
    {"rate: 20", "rate: 0", "line 16", "nothing would ever enter"},
    {"rate: 20, until: 1", "until: 1", "line 16", "needs a rate, a mass_rate or a count"},
    {"rate: 20", "rate: 20, mass_rate: 1", "line 16", "only one of rate, mass_rate"},
    {"until: 1", "from: 3, until: 1", "line 16", "until 1 s must be after from 3 s"},
    {"ball: 3, brick: 1", "bal: 3", "line 16", "no shape 'bal'; did you mean 'ball'"},
    {"{ball: 3, brick: 1}", "[ball, ball]", "line 16", "'ball' stands here twice"},
    {"ball: 3, brick: 1", "ball: 0", "line 16", "shapes.ball: 0: a share must be above 0"},
    {"min: [-0.1, -0.1, 0.2]", "min: [-0.1, -0.1, 0.4]", "line 16",
     "min 0.4 must be below max 0.3 along z"},
    {"max: [0.1, 0.1, 0.3]", "max: [3, 0.1, 0.3]", "line 16", "outside the domain along x"},
    {"max: [2, 1, 1]}}", "max: [2, 1]}}", "line 18", "must be 3 numbers"},
    {"min: [0.5, -1, -1]", "min: [0.5, 1, -1]", "line 18", "min 1 must be below max 1 along y"},
    {"min: [0.5, -1, -1], max: [2, 1, 1]", "min: [2, -1, -1], max: [3, 1, 1]", "line 18",
     "outlets.end: lies outside the domain along x: nothing ever gets there"},
    {"domain: {min: [-1, -1, -1]", "domain: {periodic: [w], min: [-1, -1, -1]", "line 19",
     "must be x, y or z"},
    {"domain: {min: [-1, -1, -1]", "domain: {periodic: [x, y, z], min: [-1, -1, -1]", "line 19",
     "along two axes at most"},
    {"domain: {min: [-1, -1, -1]", "domain: {periodic: [x], min: [-1, -1, -1]", "line 14",
     "geometry.deck: in a periodic domain geometry must go on across its boundary"},
    {"rate: 20, until: 1", "rate: 20, layers: {}", "line 16", "layers need a count, and no rate"},
    {"rate: 20, until: 1", "count: 20, layers: {packed: gird}", "line 16",
     "must be one of random|grid"},
    {"rate: 20, until: 1", "count: 20, velocity: [0, 0, 1], layers: {}", "line 16",
     "layers enter downwards"},
    {"rate: 20, until: 1", "count: 20, layers: {packed: grid, clearance: 1e-3}", "line 16",
     "clearance is of random layers"},
    {"rate: 20, until: 1", "count: 20, layers: {packed: grid, pack_time: 2}", "line 16",
     "pack_time is of random layers"},
    {"stop:", "phases: {fill: {filled: true}}\nstop:", "line 23", "phases.fill: needs a time"},
    {"stop:", "phases: {fill: {time: 1, clear: deck}}\nstop:", "line 23", "give still too"},
    {"stop:", "phases: {fill: {time: 1, still: 1, clear: lid}}\nstop:", "line 23",
     "no geometry 'lid'"},
    {"motion: [{vibrate: {along: [0, 0, 1], amplitude: 1e-3, frequency: 20}}]",
     "motion: [{rotate: {speed: 1}, during: lift}]", "line 14", "no phase 'lift'; there are none"},
    {"frequency: 20}}]", "frequency: 20}, during: lift}]", "line 14",
     "only a translate with a velocity or a rotate with a speed"},
    {"load: {wall: deck}", "load: {position: dekc}", "line 22", "did you mean 'deck'"},
    {"load: {wall: deck}", "load: {pile: {band_low: 0.9}}", "line 22",
     "band_low 0.9 must be below band_high 0.8"},
    {"friction: 0.3}", "friction: 0.3, pull_off: -1}", "line 8", "-1: must be 0 to"},
    {"wall: deck", "wall: desk", "line 22", "no geometry 'desk'; did you mean 'deck'"},
    {"wall: deck", "slope: {axis: [0, 0, -1]}", "line 22", "axis along gravity"},
    {"vibrate: {along: [0, 0, 1], amplitude: 1e-3, frequency: 20}", "vibrate: {freq: 20}",
     "line 14", "no field 'freq' in vibrate; did you mean 'frequency'? There are along, amplitude"},
    {"wall: deck", "wall: deck, pile: {}", "line 22", "only one of flow, region"},
    {"empty: true", "empty: yes", "line 23", "must be true or false"},
    {"1e-6 J", "1e-6 kW", "line 23", "must be a number in J; 'kW' measures something else"},
    {"series: 0.01", "series: 0", "line 24", "output.series: 0: must be"},
    {"output: {frames", "output: {frames: 0.1\n", "line 25", ""},
};

/* The good file with one thing replaced. */
static void replace(const char *from, const char *to, char *text, size_t size) {
  const char *at = strstr(good, from);
  assert_non_null(at);
  snprintf(text, size, "%.*s%s%s", (int)(at - good), good, to, at + strlen(from));
}

static scree_status check_text(const char *text, scree_error *error) {
  scree_scene_file *file;
  scree_status status = scree_scene_file_parse(text, strlen(text), "my.yaml", &file, error);
  if (status != SCREE_OK) return status;
  status = scree_scene_file_check(file, error);
  scree_scene_file_free(file);
  return status;
}

static void wrong_files(void **state) {
  (void)state;
  size_t count = sizeof mistakes / sizeof *mistakes, bad = 0;
  assert_true(count >= 40);
  for (size_t i = 0; i < count; i++) {
    char text[4000];
    scree_error error = {SCREE_OK, ""};
    replace(mistakes[i].from, mistakes[i].to, text, sizeof text);
    scree_status status = check_text(text, &error);
    bool told = status == SCREE_BAD_FILE && !strncmp(error.message, "my.yaml, line ", 14) &&
                strstr(error.message, mistakes[i].line) && strstr(error.message, mistakes[i].says);
    if (!told) print_error("%s -> %s: %s\n", mistakes[i].from, mistakes[i].to, error.message);
    bad += !told;
  }
  assert_int_equal(bad, 0);
}

static char *print_file(const scree_scene_file *file) {
  char *text;
  size_t size;
  scree_error error;
  FILE *stream = scree_memory_open(&text, &size);
  CHECK_OK(scree_scene_file_print(file, stream, &error), error);
  assert_true(scree_memory_close(stream));
  return text;
}

static scree_scene_file *parse(const char *text) {
  scree_error error;
  scree_scene_file *file = NULL;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), "my.yaml", &file, &error), error);
  return file;
}

static void check_reads_back(const char *text) {
  scree_scene_file *file = parse(text), *again;
  char *first = print_file(file), *second;
  again = parse(first);
  second = print_file(again);
  assert_string_equal(first, second);
  scree_scene_file_free(file);
  scree_scene_file_free(again);
  free(first);
  free(second);
}

static void printed_reads_back(void **state) {
  (void)state;
  check_reads_back(good);
  for (size_t i = 0; scree_scene_template_name(i); i++)
    check_reads_back(scree_scene_template(scree_scene_template_name(i)));
  assert_null(scree_scene_template("silo"));
}

static void fields_are_set(void **state) {
  (void)state;
  scree_error error;
  scree_scene_file *file = parse(good);
  CHECK_OK(scree_scene_file_set(file, "inlets.feed.rate", "5", &error), error);
  CHECK_OK(scree_scene_file_set(file, "gravity", "[0, 0, -1.62]", &error), error);
  CHECK_OK(scree_scene_file_set(file, "geometry.deck.motion.0.vibrate.frequency", "25", &error),
           error);
  CHECK_OK(scree_scene_file_set(file, "sensors.more", "{pile: {}}", &error), error);
  CHECK_OK(scree_scene_file_check(file, &error), error);
  char *text = print_file(file);
  assert_non_null(strstr(text, "rate: 5 "));
  assert_non_null(strstr(text, "gravity: [0, 0, -1.62]"));
  assert_non_null(strstr(text, "frequency: 25 "));
  assert_non_null(strstr(text, "more:\n    pile:"));
  free(text);
  assert_int_equal(scree_scene_file_set(file, "geometry.deck.motion.1.from", "2", &error),
                   SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_scene_file_set(file, "time.x", "2", &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_scene_file_set(file, "time", "[", &error), SCREE_BAD_FILE);
  CHECK_OK(scree_scene_file_set(file, "time", "soon", &error), error);
  assert_int_equal(scree_scene_file_check(file, &error), SCREE_BAD_FILE);
  assert_non_null(strstr(error.message, "my.yaml as changed: time: 'soon'"));
  scree_scene_file_free(file);
  file = parse("hello");
  assert_int_equal(scree_scene_file_set(file, "time", "2", &error), SCREE_BAD_FILE);
  assert_non_null(strstr(error.message, "my.yaml, line 1, column 1: a scene is"));
  scree_scene_file_free(file);
}

/* Numbers in any unit are those in the field's own, to the last bit. */
static void units(void **state) {
  (void)state;
  static const struct {
    const char *field, *value, *printed;
  } rows[] = {
      {"shapes.ball.sphere", "10 mm", "sphere: 0.01 "},
      {"shapes.ball.sphere", "1cm", "sphere: 0.01 "},
      {"shapes.brick.box", "[20 mm, 1 cm, 1e4 um]", "box: [0.02, 0.01, 0.01]"},
      {"time", "2 min", "time: 120 "},
      {"materials.grain.young", "210 GPa", "young: 2.1e+11 "},
      {"materials.grain.density", "2.5 t/m3", "density: 2500 "},
      {"materials.grain.density", "2.5 g/cm^3", "density: 2500 "},
      {"materials.grain.friction", "50 %", "friction: 0.5 "},
      {"gravity", "[0, 0, -981 cm/s2]", "gravity: [0, 0, -9.81]"},
      {"inlets.feed.rate", "120 1/min", "rate: 2 "},
      {"inlets.feed",
       "{box: {min: [-0.1, -0.1, 0.2], max: [0.1, 0.1, 0.3]}, shapes: ball, "
       "mass_rate: 0.72 t/h}",
       "mass_rate: 0.2 "},
      {"geometry.deck.motion.0", "{rotate: {speed: 30 rpm}}", "speed: 3.14159265358979"},
      {"geometry.deck.motion.0", "{rotate: {positions: [[0, 0], [500 ms, 180 deg]]}}",
       "positions: [[0, 0], [0.5, 3.141592653589793]]"},
      {"geometry.floor.turn", "{angle_deg: 0.5 rev}", "angle_deg: 180 "},
      {"stop.still", "1 uJ", "still: 1e-06 "},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_error error;
    scree_scene_file *file = parse(good);
    CHECK_OK(scree_scene_file_set(file, rows[i].field, rows[i].value, &error), error);
    CHECK_OK(scree_scene_file_check(file, &error), error);
    char *text = print_file(file);
    if (!strstr(text, rows[i].printed))
      fail_msg("%s: %s, not %s", rows[i].field, rows[i].value, rows[i].printed);
    free(text);
    scree_scene_file_free(file);
  }
}

/* What only the files and the geometry can say. */
static void scenes_that_cannot_be(void **state) {
  (void)state;
  static const struct {
    const char *from, *to, *says;
  } rows[] = {
      {"sphere: 0.01", "file: nowhere.stl", "line 10, column 9: shapes.ball: nowhere.stl"},
      {"sphere: 0.01", "sample: fp-9", "line 10, column 9: shapes.ball: 'fp-9' is no sample"},
      {"at: [0, 0, 0.1]", "at: [0, 0, 0.25]", NULL},
      {"rate: 20, until: 1", "count: 3000, layers: {pack_time: 0.001}", "would have to enter at"},
      {"max: [0.1, 0.1, 0.3]", "max: [-0.095, 0.1, 0.3]", "inlets.feed: is too small for"},
      {"rate: 20, until: 1}", "count: 20, layers: {packed: grid}, velocity: [0, 0, -1]}", NULL},
      {"box: [0.1, 0.1, 0.01], at: [0, 0, 0.1]", "box: [1, 1, 1], side: outside, at: [0, 0, 0.25]",
       "inlets.feed: lies in 'deck': nowhere in it is there room for 'ball' clear of that wall"},
      {"plane: [0, 0, 1], at: [0, 0, 0]", "plane: [0, 0, 1], at: [0, 0, 0.5]",
       "inlets.feed: lies in 'floor'"},
      {"max: [0.1, 0.1, 0.3]", "max: [0.1, 0.1, 0.205]", "inlets.feed: is too small for 'ball'"},
      {"box: [0.1, 0.1, 0.01], at", "file: nowhere.stl, at",
       "line 14, column 9: geometry.deck: nowhere.stl: cannot open"},
      {"stop:", "contact: {time_step: 0.1}\nstop:",
       "line 23, column 10: contact: world: a time step of 0.1 s is too long"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    char text[4000];
    scree_error error = {SCREE_OK, ""};
    scree_scene *scene = NULL;
    replace(rows[i].from, rows[i].to, text, sizeof text);
    scree_scene_file *file = parse(text);
    scree_status status = scree_scene_create(file, NULL, &scene, &error);
    if (rows[i].says) {
      assert_int_not_equal(status, SCREE_OK);
      if (!strstr(error.message, rows[i].says)) fail_msg("%s", error.message);
    } else {
      CHECK_OK(status, error);
    }
    scree_scene_free(scene);
    scree_scene_file_free(file);
  }
}

/* A wall's file that is not there is told before shapes are made, which may take minutes. */
static void walls_are_looked_for_first(void **state) {
  (void)state;
  char text[4000];
  scree_error error;
  scree_scene *scene = NULL;
  replace("box: [0.1, 0.1, 0.01], at", "file: nowhere.stl, at", text, sizeof text);
  scree_scene_file *file = parse(text);
  CHECK_OK(scree_scene_file_set(file, "shapes.ball", "{file: none.stl, material: grain}", &error),
           error);
  assert_int_not_equal(scree_scene_create(file, NULL, &scene, &error), SCREE_OK);
  if (!strstr(error.message, "geometry.deck: nowhere.stl: cannot open"))
    fail_msg("%s", error.message);
  scree_scene_file_free(file);
}

/* What is probably a slip is told before the first step, and nothing else is. */
static void remarks(void **state) {
  (void)state;
  static const struct {
    const char *field, *value, *says;
  } rows[] = {
      {"seed", "4", NULL},
      {"materials.grain", "{young: 1e6}", "materials.grain: no density is given: 2000 kg/m3"},
      {"materials.steel", "{young: 1e7}", NULL}, /* no shape is of it */
      {"materials.grain.young", "210e9", "materials: the stiffest contact gives way by at most"},
      {"inlets.feed.rate", "20000", "inlets.feed: of 20000 bodies about"},
      {"inlets.feed.count", "10", NULL},
      {"geometry.drum",
       "{material: steel, cylinder: {radius: 0.1, axis: [0, 1, 0], length: 0.1}, at: [0, 0, 0.2], "
       "motion: "
       "[{rotate: {speed: 6}}]}",
       "geometry.drum: turns about [0, 0, 1] through the origin, which is not the cylinder's axis"},
      {"geometry.drum",
       "{material: steel, cylinder: {radius: 0.1, axis: [0, 1, 0], length: 0.1}, at: [0, 0, 0.2], "
       "motion: "
       "[{rotate: {speed: 6, axis: [0, 1, 0], through: [0, 0, 0.2]}}]}",
       NULL},
      {"geometry.drum",
       "{material: steel, cylinder: {radius: 0.1, axis: [0, 1, 0], length: 0.1}, motion: [{rotate: "
       "{speed: 6, axis: "
       "[0, 1, 0]}}]}",
       NULL},
      {"output.frames", "1e-6", "output.frames: 1e-06 s is shorter than a time step"},
      {"output.frames", "2e-4", NULL},
      {"output.frames", "5e-5", "output.frames: 40001 frames"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_error error;
    scree_scene *scene = NULL;
    char text[SCREE_REMARK] = "";
    scree_scene_file *file = parse(good);
    CHECK_OK(scree_scene_file_set(file, rows[i].field, rows[i].value, &error), error);
    CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
    bool soft =
        scree_scene_remark(scene, 0, text) && strstr(text, ": too soft, "); /* scene_soft.c */
    bool any = scree_scene_remark(scene, soft, text);
    if (any != (rows[i].says != NULL) || (any && !strstr(text, rows[i].says)))
      fail_msg("%s: %s: '%s'", rows[i].field, rows[i].value, text);
    scree_scene_forecast f;
    scree_scene_foretell(scene, &f);
    CHECK_NEAR(f.step_count, 2 / scree_world_time_step(scree_scene_view(scene), NULL), 1);
    if (i == 0) CHECK_NEAR(f.body_count, 20, 0); /* 20 a second, until 1 s */
    scree_scene_free(scene);
    scree_scene_file_free(file);
  }
}

/* Of a scene that goes on, what is left is foretold. */
static void the_rest_is_foretold(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene = NULL;
  scree_scene_forecast whole, rest;
  scree_scene_file *file = parse(good);
  CHECK_OK(scree_scene_file_set(file, "output.frames", "1e-4", &error), error);
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  scree_scene_foretell(scene, &whole);
  CHECK_OK(scree_scene_advance(scene, 100, &error), error);
  scree_scene_foretell(scene, &rest);
  CHECK_NEAR(rest.step_count, whole.step_count - 100, 1);
  CHECK_NEAR(rest.seconds, whole.seconds * rest.step_count / whole.step_count,
             0.02 * whole.seconds);
  double frames = floor(scree_world_time(scree_scene_view(scene)) / 1e-4) + 1;
  CHECK_NEAR(rest.frame_count, whole.frame_count - frames, 0);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wrong_files),
      cmocka_unit_test(printed_reads_back),
      cmocka_unit_test(fields_are_set),
      cmocka_unit_test(units),
      cmocka_unit_test(remarks),
      cmocka_unit_test(scenes_that_cannot_be),
      cmocka_unit_test(the_rest_is_foretold),
      cmocka_unit_test(walls_are_looked_for_first),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
