/* Distributions of sizes: classes against closed forms, what enters against the classes, and a
 * scaled particle against one that was made as large. */
#include "particle/particle.h"
#include "scene/plan.h"
#include "support/check.h"

#include "scree.h"

static scree_scene_file *parse(const char *text) {
  scree_error error;
  scree_scene_file *file = NULL;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), "my.yaml", &file, &error), error);
  return file;
}

/* Share by mass (or number) of classes up to each. */
static void check_cumulative(const scree_plan_size *size, double (*finer)(double), double slack) {
  scree_arena arena = {0};
  size_t count;
  scree_size_class *classes = scree_plan_size_classes(size, &arena, &count);
  assert_non_null(classes);
  assert_int_equal(count, size->classes);
  double whole = finer(size->most) - finer(size->least), all = 0, sum = 0;
  for (size_t i = 0; i < count; i++)
    all += classes[i].share * (size->by ? 1 : pow(classes[i].size, 3));
  for (size_t i = 0; i < count; i++) {
    double n = (double)(i + 1) / (double)count,
           edge = size->least * pow(size->most / size->least, n),
           begin = size->least * pow(size->most / size->least, n - 1 / (double)count);
    sum += classes[i].share * (size->by ? 1 : pow(classes[i].size, 3)) / all;
    CHECK_NEAR(sum, (finer(edge) - finer(size->least)) / whole, slack);
    assert_true(classes[i].size > begin && classes[i].size < edge);
  }
  scree_arena_free(&arena);
}

static double finer_rosin_rammler(double d) {
  return 1 - exp(-pow(d / 0.01, 3));
}
static double finer_lognormal(double d) {
  return 0.5 * (1 + erf(log(d / 0.01) / (0.4 * sqrt(2))));
}
static double finer_uniform(double d) {
  return d;
}

static void closed_forms(void **state) {
  (void)state;
  scree_plan_rosin_rammler rr = {.size = 0.01, .spread = 3};
  scree_plan_lognormal log_normal = {.median = 0.01, .deviation = 0.4};
  for (int by = 0; by < 2; by++) {
    scree_plan_size size = {.by = by, .least = 0.003, .most = 0.02, .classes = 12};
    size.rosin_rammler = &rr;
    check_cumulative(&size, finer_rosin_rammler, 1e-5);
    size.rosin_rammler = NULL;
    size.lognormal = &log_normal;
    check_cumulative(&size, finer_lognormal, 1e-5);
    size.lognormal = NULL;
    size.uniform = true;
    check_cumulative(&size, finer_uniform, 1e-9);
  }
}

static const char scene_text[] =
    "time: 0.001\n"
    "shapes:\n"
    "  ball: {size: {distribution: [[10 mm, 0.2], [15 mm, 0.5], [20 mm, 0.3]]}}\n"
    "  brick: {box: [0.02, 0.01, 0.01], size: {by: number, cumulative: true, distribution: "
    "[[5 mm, 0], [10 mm, 0.25], [20 mm, 1]]}}\n"
    "  plain: {sphere: 0.01}\n"
    "inlets: {feed: {box: {min: [0, 0, 0], max: [0.5, 0.5, 0.5]}, shapes: {ball: 2, brick: 1, "
    "plain: 0.2}, count: 400}}\n";

/* What enters has every class to one particle, and the masses follow. */
static void entered(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene = NULL;
  scree_scene_file *file = parse(scene_text);
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  CHECK_OK(scree_scene_advance(scene, 1, &error), error);
  const double sizes[] = {0.01, 0.015, 0.02}, shares[] = {0.2, 0.5, 0.3};
  double counts[6] = {0}, numbers[3], sum = 0, mass[3] = {0}, all = 0;
  size_t bodies = scree_world_body_count(scree_scene_view(scene));
  assert_int_equal(bodies, 400);
  assert_string_equal(scree_scene_shape_name(scene, 0), "ball-10mm");
  assert_string_equal(scree_scene_shape_name(scene, 5), "plain");
  for (size_t b = 0; b < bodies; b++) {
    size_t shape = scree_scene_body_shape(scene, b);
    scree_particle_measures m;
    scree_particle_measure(scree_world_body_particle(scree_scene_view(scene), b), &m);
    counts[shape]++;
    if (shape >= 3) continue;
    CHECK_NEAR(m.size, sizes[shape], 1e-12);
    mass[shape] += scree_world_body_mass(scree_scene_view(scene), b);
  }
  for (int k = 0; k < 3; k++) sum += numbers[k] = shares[k] / pow(sizes[k], 3);
  for (int k = 0; k < 3; k++) {
    CHECK_NEAR(counts[k], 400 * 2 / 3.2 * numbers[k] / sum, 1);
    all += mass[k];
  }
  for (int k = 0; k < 3; k++) CHECK_NEAR(mass[k] / all, shares[k], 0.02);
  CHECK_NEAR(counts[3], 400 * 1 / 3.2 * 0.25, 1);
  CHECK_NEAR(counts[4], 400 * 1 / 3.2 * 0.75, 1);
  CHECK_NEAR(counts[5], 400 * 0.2 / 3.2, 1);
  scree_scene_free(scene);
  scree_scene_file_free(file);
}

static void check_alike(scree_particle *made, scree_particle *scaled) {
  scree_particle_measures a, b;
  scree_particle_measure(made, &a);
  scree_particle_measure(scaled, &b);
  CHECK_NEAR(a.volume, b.volume, 1e-12 * a.volume);
  CHECK_NEAR(a.size, b.size, 1e-12 * a.size);
  CHECK_NEAR(a.rounding, b.rounding, 1e-9 * a.rounding);
  CHECK_NEAR(a.bounding_radius, b.bounding_radius, 1e-12 * a.bounding_radius);
  for (int k = 0; k < 3; k++) CHECK_NEAR(a.inertia[k], b.inertia[k], 1e-9 * a.inertia[k]);
  assert_int_equal(a.edge_count, b.edge_count);
  assert_int_equal(a.point_count, b.point_count);
  assert_int_equal(made->face_count, scaled->face_count);
}

static void scaled_particles(void **state) {
  (void)state;
  scree_error error;
  scree_mesh mesh;
  scree_particle *one, *made, *scaled;
  for (int i = 0; i < 20; i++) {
    const double factor = 0.1 + 0.37 * i;
    CHECK_OK(scree_sample_make("icosphere-1", NULL, NULL, &mesh, &error), error);
    CHECK_OK(scree_particle_from_mesh(&mesh, NULL, &one, &error), error);
    scree_mesh_scale(&mesh, factor);
    CHECK_OK(scree_particle_from_mesh(&mesh, NULL, &made, &error), error);
    CHECK_OK(scree_particle_scaled(one, factor, &scaled, &error), error);
    check_alike(made, scaled);
    scree_particle_free(one);
    scree_particle_free(made);
    scree_particle_free(scaled);
    scree_mesh_free(&mesh);
    double centres[6] = {0, 0, 0, 0.01, 0, 0}, radii[2] = {0.01, 0.008};
    CHECK_OK(scree_particle_clump(centres, radii, 2, NULL, &one, &error), error);
    CHECK_OK(scree_particle_scaled(one, factor, &scaled, &error), error);
    for (int k = 0; k < 6; k++) centres[k] *= factor;
    for (int k = 0; k < 2; k++) radii[k] *= factor;
    CHECK_OK(scree_particle_clump(centres, radii, 2, NULL, &made, &error), error);
    check_alike(made, scaled);
    scree_particle_free(one);
    scree_particle_free(made);
    scree_particle_free(scaled);
  }
}

static void wrong(void **state) {
  (void)state;
  static const struct {
    const char *size, *says;
  } rows[] = {
      {"{}", "needs one of distribution, rosin_rammler"},
      {"{uniform: true}", "needs least and most"},
      {"{uniform: true, least: 2 mm, most: 1 mm}", "needs least and most"},
      {"{distribution: [[2 mm, 1], [1 mm, 1]]}", "the first number of rows must rise"},
      {"{distribution: [[1 mm, 0]]}", "all shares are 0"},
      {"{distribution: [[1 mm, 0.5], [2 mm, 0.3]], cumulative: true}", "cannot become less"},
      {"{distribution: [[1 mm, 0], [2 mm, 0.3]], cumulative: true}", "go from 0 to 1"},
      {"{distribution: [[1 mm, 1], [1.00001 mm, 1]]}", "are the same size"},
      {"{rosin_rammler: {size: 1 mm}, least: 1 mm, most: 2 mm}", "needs size and spread"},
      {"{uniform: true, least: 1 mm, most: 2 mm, cumulative: true}", "is of a distribution"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_error error = {SCREE_OK, ""};
    scree_scene_file *file = parse(scene_text);
    CHECK_OK(scree_scene_file_set(file, "shapes.ball.size", rows[i].size, &error), error);
    assert_int_equal(scree_scene_file_check(file, &error), SCREE_BAD_FILE);
    if (!strstr(error.message, rows[i].says)) fail_msg("%s: %s", rows[i].size, error.message);
    scree_scene_file_free(file);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(closed_forms),
      cmocka_unit_test(entered),
      cmocka_unit_test(scaled_particles),
      cmocka_unit_test(wrong),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
