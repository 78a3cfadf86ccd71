/* Belts round pulleys: what lies on them takes their speed and is thrown off on a parabola; they
 * run one way round whatever the winding of the mesh that was drawn. */
#include "base/rng.h"
#include "base/vec.h"
#include "support/folder.h"
#include "support/law.h"
#include "support/scene.h"

static const double g = 9.81, mu = 0.4, speed = 1.8, radius = 0.1, side = 0.01;

static const char *const head =
    "time: 4\n"
    "seed: 1\n"
    "materials: {m: {young: 1e6, density: 1000, restitution: 0.2, friction: 0.4}}\n"
    "shapes: {box: {box: [0.01, 0.01, 0.01]}}\n"
    "domain: {min: [-1, -1, -1], max: [5, 1, 1]}\n"
    "sensors: {drive: {wall: belt}}\n"
    "output: {series: 0.01}\n";

/* Where the folder has the files that it names. */
static scree_scene_file *file_of(const char *geometry, const char *bodies) {
  char text[3000];
  scree_error error;
  scree_scene_file *file = NULL;
  put_in_folder("belt.csv", bodies);
  snprintf(text, sizeof text, "%sbodies: {file: belt.csv}\n%s", head, geometry);
  CHECK_OK(scree_scene_file_parse(text, strlen(text), in_folder("belt.yaml"), &file, &error),
           error);
  return file;
}

static scree_scene *scene_of(const char *geometry, const char *bodies) {
  scree_error error;
  scree_scene *scene = NULL;
  scree_scene_file *file = file_of(geometry, bodies);
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  scree_scene_file_free(file);
  return scene;
}

/* Set down at x = 0.2: it slides by mu g for v/(mu g), then rides; it leaves at x = 3. */
static void carries_and_throws(void **state) {
  (void)state;
  char geometry[300], bodies[200];
  snprintf(
      geometry, sizeof geometry,
      "geometry: {belt: {loop: {span: [3, 0, 0], radius: %g, width: 0.2}, belt: {speed: %g}}}\n",
      radius, speed);
  snprintf(bodies, sizeof bodies, "x,y,z\n0.2,0,%.9g\n", radius + 0.5 * side + 1e-5);
  scree_scene *scene = scene_of(geometry, bodies);
  const double reaches = speed / (mu * g), way = 0.2 + 0.5 * speed * reaches,
               leaves = reaches + (3 - way) / speed;
  run_until(scene, 0.5 * reaches);
  LAW_RELATIVE("W5", "speed while it slides, m/s", body_of(scene, 0).velocity[0], 0.5 * speed,
               5e-3);
  run_until(scene, 1.1 * reaches);
  LAW_RELATIVE("W5", "speed on the belt, m/s", body_of(scene, 0).velocity[0], speed, 1e-3);
  const double mass = 1000 * side * side * side;
  LAW_RELATIVE("W5", "work of the belt, J", now_of(scene, "drive.energy"), mass * speed * speed,
               1e-2);
  LAW_BELOW("W5", "ledger", fabs(now_of(scene, "ledger")), 1e-3);
  run_until(scene, leaves + 0.3);
  const scree_body b = body_of(scene, 0);
  const double t = scree_world_time(scree_scene_view(scene)) - leaves;
  LAW_RELATIVE("W5", "how far it is thrown, m", b.position[0] - 3, speed * t, 0.01);
  LAW_RELATIVE("W5", "how far it falls, m", radius + 0.5 * side - b.position[2], 0.5 * g * t * t,
               0.03);
  scree_scene_free(scene);
}

/* ---- drawn loops ---- */

static size_t put_facet(char *text, const double *a, const double *b, const double *c) {
  const double *corners[3] = {a, b, c};
  size_t used = (size_t)sprintf(text, "facet normal 0 0 0\nouter loop\n");
  for (int k = 0; k < 3; k++)
    used += (size_t)sprintf(text + used, "vertex %.9g %.9g %.9g\n", corners[k][0], corners[k][1],
                            corners[k][2]);
  return used + (size_t)sprintf(text + used, "endloop\nendfacet\n");
}

/* A flat top from x = 0 to 1 at z = 0 and the rest at random below it, drawn as far as `edges`. */
static void draw_loop(scree_rng *rng, bool inwards, int edges) {
  enum { CORNERS = 9 };
  double at[CORNERS][2][3];
  char text[20000];
  size_t used = (size_t)sprintf(text, "solid belt\n");
  for (int i = 0; i < CORNERS; i++)
    for (int k = 0; k < 2; k++) {
      const double share = i < 2 ? i : 1 - (i - 1) / 8.0, down = i < 2 ? 0 : 0.2;
      if (k == 1) memcpy(at[i][1], at[i][0], sizeof at[i][1]);
      if (k == 0) at[i][0][0] = share, at[i][0][2] = -down - down * scree_rng_uniform(rng);
      at[i][k][1] = k ? 0.2 : -0.2;
    }
  for (int i = 0; i < edges; i++) {
    const double *a = at[i][inwards], *b = at[(i + 1) % CORNERS][inwards],
                 *c = at[(i + 1) % CORNERS][!inwards], *d = at[i][!inwards];
    used += put_facet(text + used, a, b, c);
    used += put_facet(text + used, a, c, d);
  }
  sprintf(text + used, "endsolid\n");
  put_in_folder("belt.stl", text);
}

static const char *const drawn =
    "geometry: {belt: {file: belt.stl, unit: m, belt: {axis: [0, 1, 0], speed: 0.5}}}\n";

/* On the top it runs along x, and so does the inner side of the top; below it runs back. */
static void runs_round(void **state) {
  (void)state;
  scree_rng rng = {.seed = 1};
  for (int i = 0; i < 20; i++) {
    draw_loop(&rng, i % 2, 9);
    scree_scene *scene = scene_of(drawn, "x,y,z\n0.3,0,0.00502\n");
    scree_wall wall;
    scree_world_get_wall(scree_scene_view(scene), 0, &wall);
    for (size_t t = 0; t < wall.mesh->triangle_count; t++) {
      const uint32_t *c = wall.mesh->triangles + 3 * t;
      const double *p[3] = {wall.mesh->positions + 3 * c[0], wall.mesh->positions + 3 * c[1],
                            wall.mesh->positions + 3 * c[2]};
      const vec3 n = vec3_triangle_normal(vec3_load(p[0]), vec3_load(p[1]), vec3_load(p[2]));
      if (fabs(n.x) < 1e-9 * vec3_norm(n)) assert_true(n.z > 0); /* the top */
    }
    run_until(scene, 0.05);
    LAW_RELATIVE("W5", "speed on a drawn belt, m/s", body_of(scene, 0).velocity[0], mu * g * 0.05,
                 0.05);
    scree_scene_free(scene);
  }
}

/* The inner side of the lower strand carries along -x. */
static void carries_within(void **state) {
  (void)state;
  scree_scene *scene = scene_of(
      "geometry: {belt: {loop: {span: [3, 0, 0], radius: 0.1, width: 0.2}, belt: {speed: 0.4}}}\n",
      "x,y,z\n2,0,-0.09499\n");
  run_until(scene, 0.3);
  LAW_RELATIVE("W5", "speed within the belt, m/s", body_of(scene, 0).velocity[0], -0.4, 1e-3);
  scree_scene_free(scene);
}

static void expect_refused(const char *geometry, const char *why) {
  scree_error error = {0};
  scree_scene *scene = NULL;
  scree_scene_file *file = file_of(geometry, "x,y,z\n0.3,0,0.02\n");
  assert_int_not_equal(scree_scene_create(file, NULL, &scene, &error), SCREE_OK);
  print_message("%s\n", error.message);
  assert_non_null(strstr(error.message, why));
  scree_scene_file_free(file);
}

static void bad_loops_are_refused(void **state) {
  (void)state;
  scree_rng rng = {.seed = 2};
  for (int edges = 1; edges < 9; edges++) {
    draw_loop(&rng, edges % 2, edges);
    expect_refused(drawn, "no closed loop about the axis");
  }
  draw_loop(&rng, false, 9);
  expect_refused("geometry: {belt: {file: belt.stl, unit: m, belt: {axis: [1, 0, 0], speed: 1}}}\n",
                 "no closed loop about the axis");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(carries_and_throws),
      cmocka_unit_test(runs_round),
      cmocka_unit_test(carries_within),
      cmocka_unit_test(bad_loops_are_refused),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
