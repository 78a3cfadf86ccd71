/* Fields by coarse graining against closed forms: the stress of a column at rest, a solid rotation
 * in a grid at rest and in one that turns with it, both kinds of grid; what VTK's file holds. */
#include "scene/sensors/grid.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/scene.h"

#include "scree.h"

static const double g = 9.81, pi = 3.14159265358979;

/* Balls in a smooth tube: over every cross-section the vertical stress adds up to the weight above,
 * smoothed as the field is. */
static void column(void **state) {
  (void)state;
  scree_scene *scene = create(
      "time: 2.5\n"
      "materials: {m: {young: 1e7, density: 2500, restitution: 0.1, friction: 0.5, "
      "rolling_friction: "
      "0.05}, smooth: {young: 1e7, restitution: 0.1, friction: 0}}\n"
      "shapes: {ball: {sphere: 0.02, material: m}}\n"
      "geometry: {floor: {plane: [0, 0, 1], material: m}, tube: {cylinder: {radius: 0.0105, "
      "length: "
      "1}, material: smooth}}\n"
      "inlets: {i: {cylinder: {at: [0, 0, 0.001], radius: 0.0103, length: 0.4}, shapes: ball, "
      "count: 10}}\n"
      "output: {series: 0.05}\n"
      "sensors: {f: {grid: {box: {min: [-0.04, -0.04, 0], max: [0.04, 0.04, 0.26]}, cells: [32, "
      "32, 26], width: 5 mm}, from: 2.3}}\n");
  run_to_end(scene);
  const scree_scene_sensor *sensor = &scene->sensors[0];
  const double w = 0.005, area = 0.0025 * 0.0025;
  assert_true(scree_grid_of(sensor)->sample_count >= 2);
  double weight = 10 * scree_world_body_mass(scree_scene_view(scene), 0) * g;
  for (size_t k = 3; k < 23; k++) {
    double force = 0, above = 0, z = 0.01 * ((double)k + 0.5);
    for (size_t c = 0; c < 32 * 32; c++)
      force += area * scree_grid_fields_at(scene, sensor, 1024 * k + c).stress[2];
    for (size_t b = 0; b < 10; b++) {
      scree_body body;
      scree_world_get_body(scree_scene_view(scene), b, &body);
      above += scree_world_body_mass(scree_scene_view(scene), b) * g * 0.5 *
               (1 + erf((body.position[2] - z) / (w * sqrt(2))));
    }
    CHECK_NEAR(force, above, 0.01 * weight);
  }
  scree_scene_free(scene);
}

static const char turning[] =
    "time: 0.004\ngravity: [0, 0, 0]\n"
    "shapes: {ball: {sphere: 0.01}}\n"
    "geometry: {table: {disc: {radius: 0.1}, at: [0, 0, -0.5], motion: [{rotate: {speed: 2}}]}}\n"
    "inlets: {i: {box: {min: [-0.2, -0.2, 0], max: [0.2, 0.2, 0.2]}, shapes: ball, count: 4000}}\n"
    "output: {series: 0.002}\n"
    "sensors:\n"
    "  still: {grid: {box: {min: [-0.1, -0.1, 0.04], max: [0.1, 0.1, 0.12]}, cells: [5, 5, 2], "
    "width: 12 mm}, from: 0.001}\n"
    "  round: {grid: {cylinder: {at: [0, 0, 0.04], radius: 0.1, length: 0.08}, cells: [3, 8, 2], "
    "width: 12 mm}, from: 0.001}\n"
    "  along: {grid: {box: {min: [-0.1, -0.1, 0.54], max: [0.1, 0.1, 0.62]}, cells: [5, 5, 2], "
    "with: table, width: 12 mm}, from: 0.001}\n";

/* 4000 balls on a lattice of 20 mm, turned about z at 2 rad/s. */
static void rotation(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene = create(turning);
  CHECK_OK(scree_scene_advance(scene, 1, &error), error);
  size_t at = 0, bodies = scree_world_body_count(scree_scene_view(scene));
  assert_int_equal(bodies, 4000);
  for (int i = 0; i < 20; i++)
    for (int j = 0; j < 20; j++)
      for (int k = 0; k < 10; k++) {
        scree_body body = scree_default_body();
        body.position[0] = 0.02 * (i - 9.5), body.position[1] = 0.02 * (j - 9.5);
        body.position[2] = 0.02 * (k + 0.5) - 0.02;
        body.velocity[0] = -2 * body.position[1], body.velocity[1] = 2 * body.position[0];
        CHECK_OK(scree_world_set_body(scree_scene_world(scene), at++, &body, &error), error);
      }
  run_to_end(scene);
  for (size_t s = 0; s < 3; s++) {
    const scree_scene_sensor *sensor = &scene->sensors[s];
    assert_true(scree_grid_of(sensor)->sample_count >= 1);
    for (size_t c = 0; c < scree_grid_of(sensor)->cell_count; c++) {
      scree_grid_fields f = scree_grid_fields_at(scene, sensor, c);
      vec3 r = scree_grid_of(sensor)->middles[c];
      double turned = s == 2 ? 0 : 2, size = 2 * hypot(r.x, r.y);
      CHECK_NEAR(f.velocity[0], -turned * r.y, 0.005 * size + 1e-3);
      CHECK_NEAR(f.velocity[1], turned * r.x, 0.005 * size + 1e-3);
      CHECK_NEAR(f.velocity[2], 0, 1e-12);
      /* what lies within the width has other speeds: 2/3 (2 w)^2 of it */
      CHECK_NEAR(f.temperature, s == 2 ? 0 : 2 * 4 * 0.012 * 0.012 / 3, 1e-5);
      CHECK_NEAR(f.solid, pi / 6 * 0.125, 0.01 * pi / 6 * 0.125);
    }
  }
  scree_scene_free(scene);
}

/* The file of a folder has as many numbers as its header says. */
static void file(void **state) {
  (void)state;
  scree_error error;
  scree_scene_file *scene_file = NULL;
  scree_scene *scene = NULL;
  CHECK_OK(scree_scene_file_parse(turning, strlen(turning), "test.yaml", &scene_file, &error),
           error);
  scree_scene_job job = {.file = scene_file, .folder = in_folder("turning"), .overwrite = true};
  CHECK_OK(scree_scene_complete(&job, &scene, &error), error);
  FILE *in = fopen(in_folder("turning/sensor-round-grid.vts"), "r");
  char line[300];
  size_t lines = 0, arrays = 0;
  assert_non_null(in);
  while (fgets(line, sizeof line, in)) {
    if (strstr(line, "<DataArray")) arrays++;
    double number;
    lines += sscanf(line, "%lf", &number) == 1;
  }
  fclose(in);
  assert_int_equal(arrays, 7); /* six fields and the points */
  assert_int_equal(lines, 6 * 48 + 4 * 9 * 3);
  scree_scene_free(scene);
  scree_scene_file_free(scene_file);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(column),
      cmocka_unit_test(rotation),
      cmocka_unit_test(file),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
