/* Mesh walls of scenes: closed ones hold the bodies where the inlets are, however they are wound;
 * what lies in them is asked for itself; `side` says it too; what has no side is told with a place;
 * a geometry of several walls goes on from its checkpoint. */
#include "base/vec.h"
#include "scree.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/shapes.h"

static scree_scene_file *parse(const char *text) {
  scree_error error;
  scree_scene_file *file = NULL;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), in_folder("test.yaml"), &file, &error),
           error);
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

static void refused(const scree_scene_file *file, const char *why) {
  scree_error error = {0};
  scree_scene *scene = NULL;
  scree_status status = scree_scene_file_check(file, &error);
  if (status == SCREE_OK) status = scree_scene_create(file, NULL, &scene, &error);
  assert_int_not_equal(status, SCREE_OK);
  if (!strstr(error.message, why)) fail_msg("'%s' does not say '%s'", error.message, why);
}

static const char text[] =
    "time: 0.15\n"
    "materials: {grain: {young: 1e7, density: 2500, restitution: 0.8, friction: 0.4}}\n"
    "shapes: {ball: {sphere: 0.02}, cube: {box: [0.015, 0.015, 0.015]}}\n"
    "geometry: {wall: {file: wall.stl, unit: m, at: [0.1, 0, 0]}}\n"
    "inlets: {feed: {box: {min: [0.03, -0.07, -0.07], max: [0.17, 0.07, 0.07]}, shapes: {ball: 1, "
    "cube: 1}, count: 20, velocity: [1, 0.7, 0.5]}}\n"
    "domain: {min: [-2, -2, -2], max: [2, 2, 2]}\n";

static void write_stl(const scree_mesh *mesh) {
  scree_error error;
  scree_write_options o = scree_default_write_options();
  o.unit_m = 1;
  o.overwrite = true;
  CHECK_OK(scree_mesh_write(mesh, in_folder("wall.stl"), &o, &error), error);
}

/* Cubes of these sides about the origin; those with a side below 0 are wound inwards. */
static void write_boxes(const double *sides, size_t count) {
  scree_mesh all = {0};
  for (size_t i = 0; i < count; i++) {
    double a = fabs(sides[i]);
    scree_mesh one = shape_grid_box(a, a, a, 2);
    shape_move(&one, (vec3){-0.5 * a, -0.5 * a, -0.5 * a});
    for (size_t t = 0; sides[i] < 0 && t < one.triangle_count; t++) shape_flip(&one, t);
    scree_mesh more = i ? shape_join(&all, &one) : one;
    if (i) scree_mesh_free(&one);
    if (i) scree_mesh_free(&all);
    all = more;
  }
  write_stl(&all);
  scree_mesh_free(&all);
}

/* Runs it, and answers the farthest and the nearest along any axis from the wall's middle. */
static void run(const scree_scene_file *file, const char *note, double reach[2],
                scree_checksum *hash) {
  scree_error error;
  scree_scene *scene = create(file);
  const char *told = scree_scene_geometry_note(scene, 0);
  if (!strstr(told ? told : "", note)) fail_msg("'%s' does not say '%s'", told, note);
  while (!scree_scene_end(scene)) CHECK_OK(scree_scene_advance(scene, 1000, &error), error);
  const scree_world *world = scree_scene_view(scene);
  reach[0] = INFINITY, reach[1] = 0;
  size_t bodies = scree_world_body_count(world);
  assert_int_equal(bodies, 20);
  for (size_t b = 0; b < bodies; b++) {
    scree_body body;
    scree_world_get_body(world, b, &body);
    double far =
        fmax(fabs(body.position[0] - 0.1), fmax(fabs(body.position[1]), fabs(body.position[2])));
    reach[0] = fmin(reach[0], far), reach[1] = fmax(reach[1], far);
  }
  if (hash) *hash = scree_world_hash(world);
  scree_scene_free(scene);
}

static void containers_hold(void **state) {
  (void)state;
  double reach[2];
  scree_checksum hashes[2];
  scree_scene_file *file = parse(text);
  for (int inwards = 0; inwards < 2; inwards++) {
    write_boxes((double[]){inwards ? -0.2 : 0.2}, 1);
    run(file, "1 container", reach, &hashes[inwards]);
    assert_true(reach[1] < 0.1);
  }
  set(file, "geometry.wall.side", "inside");
  run(file, "1 container", reach, NULL);
  assert_true(reach[1] < 0.1);
  set(file, "geometry.wall.side", "outside");
  refused(file, "lies in 'wall'");
  /* outside, flying at it */
  set(file, "inlets.feed.box", "{min: [-0.2, -0.07, -0.07], max: [-0.06, 0.07, 0.07]}");
  for (int side = 0; side < 2; side++) {
    set(file, "geometry.wall.side", side ? "outside" : "auto");
    run(file, "1 solid", reach, NULL);
    assert_true(reach[0] > 0.1);
  }
  scree_scene_file_free(file);
}

static void boxes_too(void **state) {
  (void)state;
  double reach[2];
  scree_scene_file *file = parse(text);
  set(file, "geometry.wall", "{box: [0.2, 0.2, 0.2], at: [0.1, 0, 0]}");
  run(file, "1 container", reach, NULL);
  assert_true(reach[1] < 0.1);
  scree_scene_file_free(file);
}

/* In the hollow of a thick vessel; between a container and a block in it; on both sides. */
static void one_in_another(void **state) {
  (void)state;
  double reach[2];
  scree_scene_file *file = parse(text);
  write_boxes((double[]){0.3, 0.2}, 2);
  run(file, "1 solid, 1 container", reach, NULL);
  assert_true(reach[1] < 0.1);
  write_boxes((double[]){0.06, -0.24}, 2);
  run(file, "1 solid, 1 container", reach, NULL);
  assert_true(reach[0] > 0.03 && reach[1] < 0.12);
  write_boxes((double[]){0.2}, 1);
  set(file, "inlets.more",
      "{box: {min: [0.25, -0.07, -0.07], max: [0.4, 0.07, 0.07]}, shapes: ball, count: 10, "
      "velocity: [-1, 0, 0]}");
  set(file, "inlets.feed.count", "10");
  run(file, "1 closed sheet with bodies on both sides", reach, NULL);
  assert_true(reach[0] < 0.1 && reach[1] > 0.1);
  scree_scene_file_free(file);
}

/* Solids that cross or touch each other, as paddles on a shaft, stay solids. */
static void solids_that_meet(void **state) {
  (void)state;
  static const double boxes[][2][3] = {{{0.03, -0.1, -0.1}, {0.06, 0.1, 0.1}},
                                       {{-0.04, -0.01, -0.01}, {0.05, 0.01, 0.01}},
                                       {{-0.06, -0.02, -0.02}, {0.04, 0.02, 0.02}},
                                       {{0.06, -0.1, -0.1}, {0.09, 0.1, 0.05}},
                                       {{0.06, -0.05, 0.05}, {0.09, 0.1, 0.1}}};
  scree_mesh all = {0};
  size_t count = sizeof boxes / sizeof *boxes;
  for (size_t i = 0; i < count; i++) {
    vec3 low = vec3_load(boxes[i][0]), sides = vec3_sub(vec3_load(boxes[i][1]), low);
    scree_mesh one = shape_grid_box(sides.x, sides.y, sides.z, 2), before = all;
    shape_move(&one, low);
    all = i ? shape_join(&before, &one) : one;
    if (i) scree_mesh_free(&one);
    if (i) scree_mesh_free(&before);
  }
  write_stl(&all);
  scree_mesh_free(&all);
  scree_scene_file *file = parse(text);
  scree_scene *scene;
  const char *inlets[] = {"{min: [-0.2, -0.1, 0.12], max: [0.3, 0.1, 0.3]}",
                          "{min: [-0.2, -0.1, -0.1], max: [0.3, 0.1, 0.1]}"};
  for (int i = 0; i < 2; i++) {
    set(file, "inlets.feed.box", inlets[i]);
    scene = create(file);
    const char *note = scree_scene_geometry_note(scene, 0);
    if (!strstr(note, "5 solids") || strstr(note, "container")) fail_msg("%s", note);
    scree_scene_free(scene);
  }
  scree_scene_file_free(file);
}

static void what_has_no_side(void **state) {
  (void)state;
  scree_scene_file *file = parse(text);
  scree_mesh sheet = shape_sheet(-0.1, 3);
  write_stl(&sheet);
  scree_mesh_free(&sheet);
  set(file, "geometry.wall.side", "inside");
  refused(file, "side: inside is of closed surfaces; the wall is open, as at the edge from (");
  set(file, "geometry.wall", "{plane: [0, 0, 1], at: [0, 0, -1], side: outside}");
  refused(file, "side is of a file or a box");
  scree_scene_file_free(file);
}

/* A container with a wall across it is two walls of the world. */
static void goes_on(void **state) {
  (void)state;
  scree_error error;
  write_boxes((double[]){0.2}, 1);
  scree_scan scan;
  scree_read_options o = scree_default_read_options();
  o.unit_m = 1;
  CHECK_OK(scree_scan_read(in_folder("wall.stl"), &o, &scan, &error), error);
  scree_mesh sheet = shape_sheet(0, 1);
  const mat3 shrink = {{{0, 0, 0.2}, {0.2, 0, 0}, {0, 0.2, 0}}};
  shape_transform(&sheet, &shrink, (vec3){0.01, -0.1, -0.1});
  scree_mesh both = shape_join(&scan.mesh, &sheet);
  write_stl(&both);
  scree_scene_file *file = parse(text);
  set(file, "sensors.load", "{wall: wall}");
  scree_scene *scene = create(file), *loaded;
  assert_non_null(
      strstr(scree_scene_geometry_note(scene, 0), "1 container: bodies are in it, 1 open"));
  assert_int_equal(scree_world_wall_count(scree_scene_view(scene)), 2);
  CHECK_OK(scree_scene_advance(scene, 500, &error), error);
  CHECK_OK(scree_scene_save(scene, in_folder("scene.scree"), true, &error), error);
  CHECK_OK(scree_scene_load(in_folder("scene.scree"), &loaded, &error), error);
  assert_int_equal(scree_scene_wall_geometry(loaded, 1), 0);
  CHECK_OK(scree_scene_advance(scene, 1000, &error), error);
  CHECK_OK(scree_scene_advance(loaded, 1000, &error), error);
  scree_checksum h = scree_world_hash(scree_scene_view(scene)),
                 k = scree_world_hash(scree_scene_view(loaded));
  assert_true(h.high == k.high && h.low == k.low);
  scree_scene_free(scene);
  scree_scene_free(loaded);
  scree_scene_file_free(file);
  scree_mesh_free(&both);
  scree_mesh_free(&sheet);
  scree_scan_free(&scan);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(containers_hold),  cmocka_unit_test(boxes_too),
      cmocka_unit_test(one_in_another),   cmocka_unit_test(solids_that_meet),
      cmocka_unit_test(what_has_no_side), cmocka_unit_test(goes_on)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
