/* Forces on bodies against closed forms: a field that grows with the distance, a projectile and
 * spheres that sink in a fluid, a region, a window and a name that a force acts on; their work on
 * the ledger; rocking; the same bits after a checkpoint and on threads. */
#include "scree.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/scene.h"
#include "support/threads.h"

static const double g = 9.81, pi = 3.14159265358979;

/* Balls of 10 mm and of 1 mm, 2,500 kg/m3, that nothing touches. */
static scree_scene *fly(const char *bodies, const char *rest) {
  char text[2000];
  put_in_folder("bodies.csv", bodies);
  snprintf(text, sizeof text,
           "materials: {m: {young: 1e7, density: 2500}, light: {young: 1e7, density: 2500}}\n"
           "shapes: {ball: {sphere: 0.01, material: m}, grit: {sphere: 0.001, material: light}}\n"
           "bodies: {file: bodies.csv}\n"
           "domain: {min: [-99, -99, -99], max: [99, 99, 99]}\n"
           "output: {series: 0.01}\n%s",
           rest);
  return create_at(text, in_folder("test.yaml"));
}

/* a = -k x, k = 400/s2: x = A cos(20 t). */
static void harmonic_field(void **state) {
  (void)state;
  scree_scene *scene =
      fly("shape,x,y,z\nball,0.05,0,0\n", "time: 3\ngravity: [0, 0, 0]\n"
                                          "forces: {well: {acceleration: [400, 0, 0], by: x, "
                                          "table: [[-1, 1], [1, -1]]}}\n");
  run_to_end(scene);
  double t = scree_world_time(scree_scene_view(scene));
  CHECK_NEAR(body_of(scene, 0).position[0], 0.05 * cos(20 * t), 1e-5);
  CHECK_NEAR(now_of(scene, "ledger"), 0, 1e-4);
  scree_scene_free(scene);
}

/* By Stokes, tau = rho d^2/18 mu: x = v tau (1 - e), z = -(g tau) (t - tau (1 - e)), e =
 * exp(-t/tau). */
static void projectile(void **state) {
  (void)state;
  scree_scene *scene = fly("shape,x,y,z,vx\ngrit,0,0,0,3\n",
                           "time: 1\nforces: {oil: {drag: {density: 0, viscosity: 0.001, law: "
                           "stokes}}}\n");
  run_to_end(scene);
  double t = scree_world_time(scree_scene_view(scene)), tau = 2500 * 1e-6 / (18 * 0.001),
         gone = 1 - exp(-t / tau);
  scree_body b = body_of(scene, 0);
  CHECK_NEAR(b.position[0], 3 * tau * gone, 3 * tau * 1e-3);
  CHECK_NEAR(b.position[2], -g * tau * (t - tau * gone), 1e-3 * g * tau * t);
  CHECK_NEAR(now_of(scene, "ledger"), 0, 1e-3);
  scree_scene_free(scene);
}

/* What Schiller and Naumann's factor gives where drag bears the weight in the fluid. */
static double terminal_speed(double size, double density, double viscosity) {
  double v = 1e-3;
  for (int i = 0; i < 400; i++) {
    double re = density * v * size / viscosity,
           c = re > 1000 ? 0.44 : 24 / re * (1 + 0.15 * pow(re, 0.687));
    v = 0.5 * (v + sqrt(4 * (2500 - density) * g * size / (3 * c * density)));
  }
  return v;
}

static void terminal_speeds(void **state) {
  (void)state;
  scree_scene *scene = fly("shape,x,y,z\nball,0,0,40\ngrit,1,0,40\n",
                           "time: 2\nforces: {water: {drag: {density: 1000, viscosity: 0.001, "
                           "velocity: [0.2, 0, 0]}}}\n");
  run_to_end(scene);
  const double sizes[] = {0.01, 0.001};
  for (size_t i = 0; i < 2; i++) {
    scree_body b = body_of(scene, i);
    double v = terminal_speed(sizes[i], 1000, 0.001);
    CHECK_NEAR(-b.velocity[2], v, 1e-3 * v);
    CHECK_NEAR(b.velocity[0], 0.2, 1e-3);
  }
  CHECK_NEAR(now_of(scene, "ledger"), 0, 1e-3);
  scree_scene_free(scene);
}

/* A region, names, times, mass and volume: what a body was pushed by is seen in its speed. */
static void whom_where_when(void **state) {
  (void)state;
  scree_scene *scene = fly(
      "shape,x,y,z\nball,0,0,0\ngrit,0,1,0\nball,5,0,0\n",
      "time: 1\ngravity: [0, 0, 0]\n"
      "forces:\n"
      "  late: {of: ball, acceleration: [0, 2, 0], from: 0.25, until: 0.75}\n"
      "  metal: {of: light, per_volume: [0, 0, 5000], cylinder: {radius: 3, length: 0, at: [0, 0, "
      "0]}}\n"
      "  push: {force: [0.001, 0, 0], box: {min: [4, -1, -1], max: [99, 1, 1]}}\n"
      "  swell: {of: grit, acceleration: [0, 3, 0], by: t, table: [[0, 0], [1, 1]]}\n");
  run_to_end(scene);
  double t = scree_world_time(scree_scene_view(scene)), mass = 2500 * pi / 6 * 1e-6;
  const double speeds[3][3] = {{0, 1, 0}, {0, 1.5 * t * t, 2 * t}, {0.001 / mass * t, 1, 0}};
  for (size_t i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) CHECK_NEAR(body_of(scene, i).velocity[k], speeds[i][k], 2e-3);
  CHECK_NEAR(now_of(scene, "ledger"), 0, 1e-3);
  scree_scene_free(scene);
}

/* A box that rocks about y swings its place by sin. */
static void rocking(void **state) {
  (void)state;
  scree_scene *scene =
      fly("shape,x,y,z\nball,50,0,0\n",
          "time: 0.7\ngeometry: {pan: {material: m, box: [0.1, 0.1, 0.01], at: [2, 0, 0], motion: "
          "[{rotate: {axis: [0, 1, 0], amplitude: 20 deg, frequency: 1.5}}]}}\n"
          "sensors: {pan: {position: pan}}\n");
  run_to_end(scene);
  double t = scree_world_time(scree_scene_view(scene)), angle = pi / 9 * sin(2 * pi * 1.5 * t);
  CHECK_NEAR(now_of(scene, "pan.x"), 2 * cos(angle), 1e-9);
  CHECK_NEAR(now_of(scene, "pan.z"), -2 * sin(angle), 1e-9);
  scree_scene_free(scene);
}

static scree_scene *stream(int threads, bool by_checkpoint) {
  scree_error error;
  use_threads(threads);
  scree_scene *scene =
      fly("shape,x,y,z\nball,0,0,0.1\ngrit,0.004,0,0.2\nball,0.003,0,0.14\n",
          "time: 0.4\ngeometry: {floor: {plane: [0, 0, 1], material: m}}\n"
          "forces: {air: {drag: {density: 1.2, viscosity: 1.8e-5, velocity: [3, 0, 0]}}, "
          "pull: {of: grit, acceleration: [0, 0, -9], by: z, table: [[0, 1], [0.2, 0]]}}\n");
  if (by_checkpoint) {
    run_until(scene, 0.2);
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
  scree_scene *one = stream(1, false);
  size_t rows, columns = scree_scene_column_count(one);
  const double *series = scree_scene_series(one, &rows);
  CHECK_NEAR(now_of(one, "ledger"), 0, 1e-2);
  for (int k = 0; k < 2; k++) {
    scree_scene *other = stream(k ? 1 : 3, k);
    size_t count;
    const double *same = scree_scene_series(other, &count);
    assert_int_equal(count, rows);
    assert_memory_equal(same, series, rows * columns * sizeof *series);
    scree_scene_free(other);
  }
  scree_scene_free(one);
}

static void wrong_forces(void **state) {
  (void)state;
  static const struct {
    const char *force, *told;
  } cases[] = {{"{}", "needs one of force"},
               {"{force: [1, 0, 0], acceleration: [1, 0, 0]}", "only one of"},
               {"{of: bal, force: [1, 0, 0]}", "did you mean 'ball'"},
               {"{drag: {density: 1}}", "the viscosity"},
               {"{force: [1, 0, 0], table: [[1, 1], [0, 1]]}", "must rise"},
               {"{force: [1, 0, 0], from: 2, until: 1}", "must be after"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char text[400];
    scree_error error = {0};
    scree_scene_file *file = NULL;
    snprintf(text, sizeof text,
             "time: 1\nshapes: {ball: {sphere: 0.01}}\nbodies: {file: a.csv}\nforces: {f: %s}\n",
             cases[i].force);
    CHECK_OK(scree_scene_file_parse(text, strlen(text), "test.yaml", &file, &error), error);
    assert_int_equal(scree_scene_file_check(file, &error), SCREE_BAD_FILE);
    if (!strstr(error.message, cases[i].told)) fail_msg("%s: %s", cases[i].force, error.message);
    scree_scene_file_free(file);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(harmonic_field),  cmocka_unit_test(projectile),
      cmocka_unit_test(terminal_speeds), cmocka_unit_test(whom_where_when),
      cmocka_unit_test(rocking),         cmocka_unit_test(same_bits),
      cmocka_unit_test(wrong_forces),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
