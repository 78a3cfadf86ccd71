/* What falls past all geometry does not fall for ever, though the scene names no domain: it is
 * taken out and counted, with time and place, and the books close. What lies on geometry stays,
 * however far that goes, and so does what rolls on a plane, which has no end. */
#include "scree.h"
#include "support/check.h"
#include "support/folder.h"

static const char text[] =
    "time: 1.2\n"
    "gravity: [0, 0, -9.81]\n"
    "materials: {grain: {young: 1e6, density: 1000, restitution: 0.2, friction: 0.5}}\n"
    "shapes: {cube: {box: [0.01, 0.01, 0.01]}}\n"
    "geometry: {tray: {box: [0.1, 0.3, 0.02], at: [0, 0, -0.01]}}\n"
    "inlets: {feed: {box: {min: [-0.15, -0.1, 0.01], max: [0.15, 0.1, 0.05]}, shapes: cube, count: "
    "60, velocity: [0, 0, -0.1]}}\n"
    "output: {series: 0.05}\n";

static scree_scene *create(const char *field, const char *value) {
  scree_error error;
  scree_scene_file *file = NULL;
  scree_scene *scene = NULL;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), "test.yaml", &file, &error), error);
  if (field) CHECK_OK(scree_scene_file_set(file, field, value, &error), error);
  CHECK_OK(scree_scene_create(file, NULL, &scene, &error), error);
  scree_scene_file_free(file);
  return scene;
}

static void finish(scree_scene *scene) {
  scree_error error;
  while (!scree_scene_end(scene)) CHECK_OK(scree_scene_advance(scene, 500, &error), error);
}

/* How many stand on the tray, and are in the world at all. */
static void count(const scree_scene *scene, size_t *on_tray, size_t *inside) {
  const scree_world *world = scree_scene_view(scene);
  *on_tray = *inside = 0;
  for (size_t b = 0; b < scree_world_body_count(world); b++) {
    scree_body body;
    if (scree_world_body_removed(world, b)) continue;
    scree_world_get_body(world, b, &body);
    *on_tray += body.position[2] > 0;
    ++*inside;
  }
}

static void past_all_geometry(void **state) {
  (void)state;
  scree_scene *scene = create(NULL, NULL);
  size_t on_tray, inside;
  scree_scene_loss loss;
  scree_scene_book book;
  assert_false(scree_scene_loss_of(scene, &loss));
  finish(scene);
  count(scene, &on_tray, &inside);
  scree_scene_get_book(scene, &book);
  assert_true(scree_scene_loss_of(scene, &loss));
  assert_true(on_tray > 5 && loss.count > 20);
  assert_int_equal(on_tray + loss.count, 60);
  assert_int_equal(inside, on_tray);
  assert_int_equal(book.left_count, loss.count);
  CHECK_NEAR(loss.mass, 1e-3 * (double)loss.count, 1e-9);
  CHECK_NEAR(book.ledger, 0, 1e-2);
  assert_false(loss.is_meant);
  assert_true(loss.first_time > 0.1 && loss.first_place[2] < loss.low[2]);
  /* tray and inlet are 0.3 m wide, and as much is added */
  CHECK_NEAR(loss.low[1], -0.45, 1e-9);
  CHECK_NEAR(loss.high[0], 0.45, 1e-9);
  scree_scene_free(scene);
}

static void a_domain_is_meant(void **state) {
  (void)state;
  scree_scene *scene = create("domain", "{min: [-1, -1, -0.1], max: [1, 1, 1]}");
  scree_scene_loss loss;
  finish(scene);
  assert_true(scree_scene_loss_of(scene, &loss) && loss.is_meant && loss.count > 20);
  scree_scene_free(scene);
}

static void geometry_takes_it_along(void **state) {
  (void)state;
  scree_scene *scene =
      create("geometry.tray", "{box: [0.4, 0.3, 0.2], at: [0, 0, 0.05], side: inside, motion: "
                              "[{translate: {velocity: [2, 0, 0.5]}}]}");
  scree_scene_loss loss;
  size_t on_tray, inside;
  finish(scene);
  count(scene, &on_tray, &inside);
  assert_false(scree_scene_loss_of(scene, &loss));
  assert_int_equal(inside, 60);
  assert_true(loss.high[0] > 2.5); /* where it has gone */
  scree_scene_free(scene);
}

static void planes_go_on(void **state) {
  (void)state;
  scree_scene *scene = create("geometry.tray", "{plane: [0, 0, 1]}");
  scree_error error;
  CHECK_OK(scree_scene_advance(scene, 1, &error), error);
  scree_body far = scree_default_body();
  far.position[0] = 500, far.position[2] = 0.0051;
  CHECK_OK(scree_world_set_body(scree_scene_world(scene), 0, &far, &error), error);
  scree_scene_loss loss;
  finish(scene);
  assert_false(scree_scene_loss_of(scene, &loss));
  assert_true(isinf(loss.low[0]) && isinf(loss.high[1]) && isfinite(loss.low[2]));
  scree_scene_free(scene);
}

/* What is lost is the same after a checkpoint. */
static void goes_on(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene = create(NULL, NULL), *loaded;
  CHECK_OK(scree_scene_advance(scene, 1500, &error), error);
  CHECK_OK(scree_scene_save(scene, in_folder("scene.scree"), true, &error), error);
  CHECK_OK(scree_scene_load(in_folder("scene.scree"), &loaded, &error), error);
  finish(scene);
  finish(loaded);
  scree_scene_loss one, other;
  assert_true(scree_scene_loss_of(scene, &one) && scree_scene_loss_of(loaded, &other));
  assert_int_equal(one.count, other.count);
  assert_memory_equal(one.first_place, other.first_place, sizeof one.first_place);
  scree_checksum h = scree_world_hash(scree_scene_view(scene)),
                 k = scree_world_hash(scree_scene_view(loaded));
  assert_true(h.high == k.high && h.low == k.low);
  scree_scene_free(scene);
  scree_scene_free(loaded);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(past_all_geometry),
                                     cmocka_unit_test(a_domain_is_meant),
                                     cmocka_unit_test(geometry_takes_it_along),
                                     cmocka_unit_test(planes_go_on), cmocka_unit_test(goes_on)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
