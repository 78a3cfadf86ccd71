/* Bodies that begin outside of what holds them are told before the first step: shares that random
 * inlets give over a tube above a disc, beside those of a classification by hand and of the bodies
 * that a run loses. */
#include "base/rng.h"
#include "scene/starts.h"
#include "scree.h"
#include "support/check.h"

enum { ROUNDS = 40, FINE = 20000 };
static const double tube = 0.05, disc = 0.08, most_off = 0.2; /* m, m; 4.5 sd of 128 places */

static const char text[] =
    "time: 0.6\n"
    "materials: {grain: {young: 1e6, density: 2500, restitution: 0.1}, steel: {young: 1e7}}\n"
    "shapes: {ball: {sphere: 0.004, material: grain}}\n"
    "geometry:\n"
    "  tube: {cylinder: {radius: 0.05, length: 0.3}, at: [0, 0, 0.01], material: steel}\n"
    "  plate: {disc: {radius: 0.08, normal: [0, 0, 1]}, material: steel}\n"
    "inlets: {feed: {box: {min: [-0.04, -0.04, 0.05], max: [0.04, 0.04, 0.25]}, shapes: ball, "
    "count: 150}}\n"
    "output: {series: 0.02}\n";

static scree_scene *create(const double low[2], const double high[2]) {
  scree_error error;
  scree_scene *scene = NULL;
  scree_scene_file *file = NULL;
  char value[80];
  CHECK_OK(scree_scene_file_parse(text, strlen(text), "test.yaml", &file, &error), error);
  snprintf(value, sizeof value, "[%.6f, %.6f, 0.05]", low[0], low[1]);
  CHECK_OK(scree_scene_file_set(file, "inlets.feed.box.min", value, &error), error);
  snprintf(value, sizeof value, "[%.6f, %.6f, 0.25]", high[0], high[1]);
  CHECK_OK(scree_scene_file_set(file, "inlets.feed.box.max", value, &error), error);
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  scree_scene_file_free(file);
  return scene;
}

/* Of places clear of the tube: the shares outside of it, and beyond the disc. */
static void classify(const double low[2], const double high[2], scree_rng *rng, double *outside,
                     double *beyond) {
  size_t count = 0, out = 0, past = 0;
  for (int i = 0; i < FINE; i++) {
    double r2 = 0;
    for (int k = 0; k < 2; k++) {
      double x = low[k] + 0.002 + (high[k] - low[k] - 0.004) * scree_rng_uniform(rng);
      r2 += x * x;
    }
    if (fabs(sqrt(r2) - tube) < 0.0021) continue;
    count++;
    out += r2 > tube * tube;
    past += r2 > disc * disc;
  }
  *outside = (double)out / (double)count;
  *beyond = (double)past / (double)count;
}

static void shares_of_random_inlets(void **state) {
  (void)state;
  scree_rng rng = {5, 1, 0};
  int parted = 0, past = 0;
  for (int round = 0; round < ROUNDS; round++) {
    double low[2], high[2], outside, beyond;
    for (int k = 0; k < 2; k++) {
      double middle = 0.1 * scree_rng_uniform(&rng) - 0.05,
             half = 0.005 + 0.05 * scree_rng_uniform(&rng);
      low[k] = middle - half;
      high[k] = middle + half;
    }
    classify(low, high, &rng, &outside, &beyond);
    scree_scene *scene = create(low, high);
    scree_scene_starts s;
    bool any = scree_scene_look_at_starts(scene, 0, &s);
    assert_int_equal(any, s.parted > 0 || s.past > 0);
    double smaller = fmin(outside, 1 - outside);
    /* outside is one part but where the tube cuts corners off */
    if (outside > 0.5) CHECK_NEAR(s.parted, smaller, most_off);
    if (outside < 0.001) CHECK_NEAR(s.parted, 0, 0);
    if (outside < 0.5) CHECK_NEAR(s.parted, outside, most_off);
    CHECK_NEAR(s.past, beyond, most_off);
    if (beyond == 0) CHECK_NEAR(s.past, 0, 0);
    char remark[SCREE_REMARK] = "";
    for (size_t i = 0; scree_scene_remark(scene, i, remark); i++) {
      parted += strstr(remark, "inlets.feed: 'tube' cuts the region in parts: about") != NULL;
      past += strstr(remark, "fall past all geometry and outlets") != NULL;
    }
    scree_scene_free(scene);
  }
  assert_in_range(parted, 10, ROUNDS - 1);
  assert_in_range(past, 5, ROUNDS - 1);
}

/* What is foretold to fall past all is what a run loses. */
static void foretold_is_lost(void **state) {
  (void)state;
  const double low[2] = {-0.02, -0.09}, high[2] = {0.12, 0.09};
  scree_scene *scene = create(low, high);
  scree_scene_starts s;
  scree_scene_loss loss;
  scree_error error;
  assert_true(scree_scene_look_at_starts(scene, 0, &s));
  while (!scree_scene_end(scene)) CHECK_OK(scree_scene_advance(scene, 1000, &error), error);
  assert_true(scree_scene_loss_of(scene, &loss));
  /* some bounce off the disc's rim */
  CHECK_NEAR((double)loss.count / 150, s.past, most_off);
  assert_true(s.past > 0.3);
  scree_scene_free(scene);
}

/* An outlet that takes out what an inlet puts in: the share of the region that it covers. */
static void outlet_over_inlet(void **state) {
  (void)state;
  static const struct {
    const char *box;
    double share;
  } outlets[] = {{"{min: [-1, -1, -1], max: [1, 1, 1]}", 1},
                 {"{min: [-1, -1, -1], max: [0, 1, 1]}", 0.5},
                 {"{min: [-1, -1, -1], max: [1, 1, 0]}", 0}};
  for (int i = 0; i < 3; i++) {
    scree_error error;
    scree_scene *scene = NULL;
    scree_scene_file *file = NULL;
    scree_scene_starts s;
    char value[200], remark[SCREE_REMARK] = "";
    bool told = false;
    CHECK_OK(scree_scene_file_parse(text, strlen(text), "test.yaml", &file, &error), error);
    snprintf(value, sizeof value, "{drain: {box: %s}}", outlets[i].box);
    CHECK_OK(scree_scene_file_set(file, "outlets", value, &error), error);
    CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
    scree_scene_file_free(file);
    scree_scene_look_at_starts(scene, 0, &s);
    CHECK_NEAR(s.taken, outlets[i].share, most_off);
    for (size_t k = 0; scree_scene_remark(scene, k, remark); k++)
      told = told || strstr(remark, "start in the outlet 'drain', which takes them out at once");
    assert_int_equal(told, outlets[i].share > 0);
    scree_scene_free(scene);
  }
}

/* Whether a template with a field set so is told to have such a thing before its first step. */
static bool is_told(const char *name, const char *field, const char *value, const char *what) {
  scree_error error;
  scree_scene *scene = NULL;
  scree_scene_file *file = NULL;
  char remark[SCREE_REMARK];
  bool told = false;
  CHECK_OK(scree_scene_file_template(name, &file, &error), error);
  if (field) CHECK_OK(scree_scene_file_set(file, field, value, &error), error);
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  scree_scene_file_free(file);
  for (size_t i = 0; scree_scene_remark(scene, i, remark); i++) told = told || strstr(remark, what);
  scree_scene_free(scene);
  return told;
}

/* A slide under a hopper's hole that leaves it open, wider than a body or not. */
static void gates(void **state) {
  (void)state;
  static const char what[] = "get past 'slide' to where they leave";
  static const char *const others[] = {"drum", "drawdown", "hollow-cylinder", "tilting-box",
                                       "shear-box"};
  assert_false(is_told("hopper", NULL, NULL, what));
  assert_false(is_told("hopper", "geometry.slide.at", "[0.010, 0, 0.092]", what));
  assert_true(is_told("hopper", "geometry.slide.at", "[0.030, 0, 0.092]", what));
  assert_true(is_told("hopper", "geometry.slide.at", "[0, 0, 0.07]", what));
  assert_true(is_told("hopper", "geometry.slide.box", "[0.02, 0.02, 0.004]", what));
  /* one that has gone by the time the inlet begins closes nothing, nor is it meant to */
  assert_false(is_told("hopper", "inlets.feed.from", "2", what));
  for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    assert_false(is_told(others[i], NULL, NULL, "while it still stands"));
}

/* Along a floor without an end, where no wall stops what falls that way. */
static void sideways(void **state) {
  (void)state;
  static const char what[] = "fall past all geometry and outlets";
  assert_false(is_told("tilting-box", NULL, NULL, what));
  for (int i = 0; i < 2; i++) {
    scree_error error;
    scree_scene *scene = NULL;
    scree_scene_file *file = NULL;
    scree_scene_starts s;
    CHECK_OK(scree_scene_file_parse(text, strlen(text), "test.yaml", &file, &error), error);
    CHECK_OK(scree_scene_file_set(file, "geometry", "{floor: {plane: [0, 0, 1], material: steel}}",
                                  &error),
             error);
    CHECK_OK(scree_scene_file_set(file, "gravity", i ? "[9.81, 0, 0]" : "[0, 0, -9.81]", &error),
             error);
    CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
    scree_scene_file_free(file);
    scree_scene_look_at_starts(scene, 0, &s);
    CHECK_NEAR(s.past, i, 0);
    scree_scene_free(scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shares_of_random_inlets),
      cmocka_unit_test(outlet_over_inlet),
      cmocka_unit_test(foretold_is_lost),
      cmocka_unit_test(gates),
      cmocka_unit_test(sideways),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
