/* Other orders of the last part of a curve: as sound as the first, the same for any number of
 * threads, and left by a choice in the one with the coarsest level that keeps the tolerances. */
#include "support/check.h"
#include "support/shapes.h"

static scree_curve *curve_of(scree_mesh *scan, double scale) {
  scree_curve *curve;
  scree_error error;
  CHECK_OK(scree_curve_build_scaled(scan, scale, NULL, NULL, &curve, &error), error);
  return curve;
}

static scree_mesh sample(double spacing) {
  scree_sample_options options = scree_default_sample_options();
  scree_mesh mesh;
  scree_error error;
  options.resolution = spacing;
  CHECK_OK(scree_sample_make("fp-1", &options, NULL, &mesh, &error), error);
  return mesh;
}

static void take_order(scree_curve *curve, int order) {
  scree_error error;
  CHECK_OK(scree_curve_reorder(curve, order, &error), error);
  assert_int_equal(scree_curve_order(curve), order);
}

/* What the record tells of a level is what its mesh has. */
static void check_level(const scree_curve *curve, size_t target) {
  scree_level level;
  scree_mesh mesh;
  scree_check check;
  scree_error error;
  double area, volume;
  size_t index = scree_curve_find(curve, target);
  scree_curve_level(curve, index, &level);
  CHECK_OK(scree_curve_mesh(curve, index, &mesh, &error), error);
  CHECK_OK(scree_mesh_check(&mesh, NULL, NULL, &check, &error), error);
  CHECK_OK(scree_mesh_area_volume(&mesh, &area, &volume, &error), error);
  assert_int_equal(mesh.triangle_count, level.triangle_count);
  assert_true(check.usable || check.defects[SCREE_DEFECT_SHARP_EDGE]);
  CHECK_NEAR(area / level.area, 1, 1e-9);
  CHECK_NEAR(volume / level.volume, 1, 1e-9);
  scree_mesh_free(&mesh);
}

static bool same_level(const scree_curve *a, const scree_curve *b, size_t target) {
  scree_mesh x, y;
  scree_error error;
  CHECK_OK(scree_curve_mesh(a, scree_curve_find(a, target), &x, &error), error);
  CHECK_OK(scree_curve_mesh(b, scree_curve_find(b, target), &y, &error), error);
  bool same = x.vertex_count == y.vertex_count && x.triangle_count == y.triangle_count &&
              !memcmp(x.positions, y.positions, 3 * x.vertex_count * sizeof *x.positions) &&
              !memcmp(x.triangles, y.triangles, 3 * x.triangle_count * sizeof *x.triangles);
  scree_mesh_free(&x);
  scree_mesh_free(&y);
  return same;
}

static void orders_are_sound(void **state) {
  (void)state;
  scree_mesh scan = sample(2e-3), again = sample(2e-3);
  scree_curve *curve = curve_of(&scan, 0.5), *first = curve_of(&again, 0.5);
  scree_error error;
  assert_int_equal(scree_curve_order_count(curve), SCREE_ORDER_COUNT);
  for (int order = 0; order < SCREE_ORDER_COUNT; order++) {
    take_order(curve, order);
    for (size_t target = 10000; target > 20; target /= 3) check_level(curve, target);
    assert_true(same_level(curve, first, 8000));
    assert_int_equal(same_level(curve, first, 300), order == 0);
    assert_int_equal(scree_curve_get_facts(curve).floor_count % 2, 0);
  }
  assert_int_equal(scree_curve_reorder(curve, SCREE_ORDER_COUNT, &error), SCREE_BAD_ARGUMENT);
  take_order(curve, 0);
  for (size_t target = 8000; target > 20; target /= 2)
    assert_true(same_level(curve, first, target));
  scree_curve_free(curve);
  scree_curve_free(first);
  scree_mesh_free(&scan);
  scree_mesh_free(&again);
}

static void threads_change_nothing(void **state) {
  (void)state;
  scree_mesh a = sample(2e-3), b = sample(2e-3);
  scree_curve *one, *two;
  scree_choice x, y;
  scree_error error;
  scree_set_threads(1);
  one = curve_of(&a, 1);
  CHECK_OK(scree_choose(one, &a, NULL, NULL, &x, &error), error);
  scree_set_threads(3);
  two = curve_of(&b, 1);
  CHECK_OK(scree_choose(two, &b, NULL, NULL, &y, &error), error);
  assert_int_equal(x.order, y.order);
  assert_int_equal(x.recommended.level_index, y.recommended.level_index);
  for (size_t target = 4000; target > 20; target /= 3) assert_true(same_level(one, two, target));
  scree_choice_free(&x);
  scree_choice_free(&y);
  scree_curve_free(one);
  scree_curve_free(two);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
}

/* No order has a coarser one, and what the next level is refused for is above its tolerance. */
static void the_coarsest_is_chosen(void **state) {
  (void)state;
  scree_mesh scan = sample(2e-3);
  scree_curve *curve = curve_of(&scan, 1);
  scree_choice choice;
  scree_error error;
  scree_choice_options options = scree_default_choice_options();
  CHECK_OK(scree_choose(curve, &scan, &options, NULL, &choice, &error), error);
  assert_int_equal(scree_curve_order(curve), choice.order);
  double tolerance = scree_choice_tolerance(&choice, &options, choice.limited_by);
  assert_true(choice.limit_beyond > 0.98 * tolerance);
  assert_true(choice.largest_over_tolerance <= 0.98);
  scree_choice_free(&choice);
  scree_curve_free(curve);
  scree_mesh_free(&scan);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(orders_are_sound),
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(the_coarsest_is_chosen),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
