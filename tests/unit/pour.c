/* Pouring: every particle enters once, inside the container, clear of the others; any cut into
 * calls and any number of threads give the same bits. */
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

static scree_particle *box_particle(double x, double y, double z) {
  scree_error error;
  scree_particle *particle = NULL;
  scree_mesh mesh = shape_box(x, y, z);
  CHECK_OK(scree_particle_from_mesh(&mesh, NULL, &particle, &error), error);
  scree_mesh_free(&mesh);
  return particle;
}

static scree_pour *make_pour(const scree_pour_options *options, size_t boxes, size_t balls) {
  scree_error error;
  scree_particle *box = box_particle(0.05, 0.03, 0.02), *ball = NULL;
  scree_pour *pour = NULL;
  CHECK_OK(scree_particle_sphere(0.012, &ball, &error), error);
  const scree_pour_shape shapes[] = {{box, boxes}, {ball, balls}};
  CHECK_OK(scree_pour_create(shapes, 2, options, &pour, &error), error);
  scree_particle_free(box);
  scree_particle_free(ball);
  return pour;
}

static scree_pour_options soft_options(scree_container container, double width) {
  scree_pour_options o = scree_default_pour_options();
  o.world.stiffness_factor = 0.2;
  o.container = container;
  o.width = width;
  return o;
}

/* Bodies that entered since `before` are inside and apart from all that is there. */
static void check_entered(scree_pour *pour, size_t before) {
  scree_pour_options o;
  scree_pour_get_options(pour, &o);
  scree_world *world = scree_pour_world(pour);
  for (size_t i = before; i < scree_pour_entered_count(pour); i++) {
    scree_body a, b;
    scree_particle_measures ma, mb;
    scree_world_get_body(world, i, &a);
    scree_particle_measure(scree_world_body_particle(world, i), &ma);
    double x = fabs(a.position[0]), y = fabs(a.position[1]), r = ma.bounding_radius;
    if (o.container == SCREE_CONTAINER_BOX)
      assert_true(x + r <= 0.5 * o.width && y + r <= 0.5 * o.depth);
    else
      assert_true(sqrt(x * x + y * y) + r <= 0.5 * o.width);
    for (size_t j = 0; j < i; j++) {
      scree_world_get_body(world, j, &b);
      scree_particle_measure(scree_world_body_particle(world, j), &mb);
      double d2 = 0;
      for (int k = 0; k < 3; k++) d2 += pow(a.position[k] - b.position[k], 2);
      assert_true(sqrt(d2) > r + mb.bounding_radius);
    }
  }
}

static void all_enter_apart_from_each_other(void **state) {
  (void)state;
  const double widths[] = {0, 0.0645, 0.1, 0.21};
  for (int c = 0; c < 2; c++)
    for (int w = 0; w < 4; w++) {
      scree_pour_options o =
          soft_options(c ? SCREE_CONTAINER_BOX : SCREE_CONTAINER_CYLINDER, widths[w]);
      if (c && w == 2) o.depth = 0.3;
      scree_pour *pour = make_pour(&o, 7, 6);
      scree_error error;
      size_t shapes[2] = {0, 0}, entered = 0;
      for (int i = 0; i < 400000 && entered < 13; i++) {
        CHECK_OK(scree_pour_advance(pour, 1, &error), error);
        if (scree_pour_entered_count(pour) == entered) continue;
        check_entered(pour, entered);
        entered = scree_pour_entered_count(pour);
      }
      assert_int_equal(entered, 13);
      CHECK_NEAR(scree_world_time(scree_pour_world(pour)), scree_pour_filling_time(pour), 1e-4);
      for (size_t i = 0; i < 13; i++) shapes[scree_pour_shape_of(pour, i)]++;
      assert_int_equal(shapes[0], 7);
      assert_int_equal(shapes[1], 6);
      scree_pour_free(pour);
    }
}

static void cuts_and_threads_change_nothing(void **state) {
  (void)state;
  scree_checksum first = {0};
  const size_t cuts[] = {3000, 1, 77};
  for (int c = 0; c < 3; c++) {
    scree_error error;
    scree_pour_options o = soft_options(SCREE_CONTAINER_CYLINDER, 0.1);
    scree_set_threads(c + 1);
    scree_pour *pour = make_pour(&o, 9, 9);
    for (size_t done = 0; done < 3000;) {
      size_t steps = 3000 - done < cuts[c] ? 3000 - done : cuts[c];
      CHECK_OK(scree_pour_advance(pour, steps, &error), error);
      done += steps;
    }
    scree_checksum hash = scree_world_hash(scree_pour_world(pour));
    if (c == 0) first = hash;
    assert_true(hash.high == first.high && hash.low == first.low);
    scree_pour_free(pour);
  }
  scree_set_threads(0);
}

static void what_cannot_be_poured_is_refused(void **state) {
  (void)state;
  scree_error error;
  scree_pour *pour = NULL;
  scree_particle *box = box_particle(0.05, 0.03, 0.02);
  scree_pour_shape shape = {box, 5};
  scree_pour_options o = scree_default_pour_options();
  o.width = 0.06;
  assert_int_equal(scree_pour_create(&shape, 1, &o, &pour, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "too narrow"));
  o = scree_default_pour_options();
  o.world.gravity[2] = 0;
  assert_int_equal(scree_pour_create(&shape, 1, &o, &pour, &error), SCREE_BAD_ARGUMENT);
  shape.count = 0;
  assert_int_equal(scree_pour_create(&shape, 1, NULL, &pour, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "no particles"));
  assert_null(pour);
  scree_particle_free(box);
}

static scree_status pour_all(void *context, scree_error *error) {
  const scree_pour_shape shape = {context, 3};
  scree_pour_options o = soft_options(SCREE_CONTAINER_CYLINDER, 0);
  scree_pour *pour = NULL;
  scree_status status = scree_pour_create(&shape, 1, &o, &pour, error);
  if (status == SCREE_OK) status = scree_pour_advance(pour, 10, error);
  scree_pour_free(pour);
  return status;
}

static void memory_running_out_is_told(void **state) {
  (void)state;
  scree_particle *box = box_particle(0.05, 0.03, 0.02);
  check_allocation_failures(pour_all, box);
  scree_particle_free(box);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(all_enter_apart_from_each_other),
      cmocka_unit_test(cuts_and_threads_change_nothing),
      cmocka_unit_test(what_cannot_be_poured_is_refused),
      cmocka_unit_test(memory_running_out_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
