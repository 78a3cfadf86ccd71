/* Patches: the same bits for any number of threads, the same collapses however the scan lies. (Its
 * numbers are put in order before, of scans of that size.) That each collapse is allowed and at the
 * place of least cost the slow decimator asks (simplify_oracle.c). */
#include "simplify/order.h"
#include "simplify/patch.h"
#include "support/decimator.h"
#include "support/shapes.h"

#include <string.h>

enum { PATCH = 500 };

/* A box with a slant, so that no symmetry leaves its axes open, of some noise. */
static scree_mesh slanted_box(void) {
  scree_rng rng = {.seed = 11};
  scree_mesh mesh = shape_grid_box(0.1, 0.07, 0.05, 24);
  for (size_t v = 0; v < mesh.vertex_count; v++) {
    double *p = mesh.positions + 3 * v;
    p[1] *= 1 + 2 * p[0];
    p[2] *= 1 + p[0] + 2 * p[1];
  }
  shape_shake(&mesh, 2e-5, &rng);
  return mesh;
}

/* An ellipsoid so rough that whole cells face no direction: most that is done in it is done where
 * cells have owners. It cannot meet itself. */
static scree_mesh rough_ball(void) {
  scree_rng rng = {.seed = 12};
  scree_mesh mesh = shape_icosphere(0.05, 5);
  shape_roughen(&mesh, 0.04, &rng);
  for (size_t v = 0; v < mesh.vertex_count; v++) {
    double *p = mesh.positions + 3 * v;
    for (size_t i = 0; i < 3; i++) p[i] *= 1 + 0.2 * (double)i;
    p[0] *= 1 + 2 * p[0] + p[1];
    p[1] *= 1 + p[1];
  }
  return mesh;
}

static scree_decimator in_patches(const scree_mesh *mesh, const scree_coster *coster) {
  static scree_error error;
  scree_decimator d = begin_decimation(mesh, coster, &error);
  CHECK_OK(scree_decimate_in_patches(&d, PATCH), error);
  assert_int_equal(d.s.sums != NULL, coster->merge != NULL); /* no room for those of all */
  return d;
}

static void check_threads(scree_mesh mesh) {
  const scree_coster *costers[] = {&scree_volume_coster, &scree_qecd_coster};
  for (int k = 0; k < 2; k++) {
    scree_set_threads(1);
    scree_decimator one = in_patches(&mesh, costers[k]);
    size_t count = one.record.count;
    print_message("%zu collapses of %zu vertices\n", count, mesh.vertex_count);
    assert_true(count > mesh.vertex_count / 2);
    assert_int_equal(one.s.live_triangle_count, mesh.triangle_count - 2 * count);
    for (int threads = 2; threads < 6; threads++) {
      scree_set_threads(threads);
      scree_decimator other = in_patches(&mesh, costers[k]);
      const scree_record *a = &one.record, *b = &other.record;
      assert_int_equal(b->count, count);
      assert_memory_equal(a->kept, b->kept, count * sizeof *a->kept);
      assert_memory_equal(a->gone, b->gone, count * sizeof *a->gone);
      assert_memory_equal(a->position, b->position, count * sizeof *a->position);
      assert_memory_equal(a->area, b->area, count * sizeof *a->area);
      scree_decimator_free(&other);
    }
    scree_decimator_free(&one);
  }
  scree_set_threads(0);
  scree_mesh_free(&mesh);
}

static void threads_change_nothing(void **state) {
  (void)state;
  check_threads(slanted_box());
  check_threads(rough_ball());
}

/* The area that is left after each collapse, over that of the scan. */
static double *areas_of(const scree_decimator *d) {
  double *areas = scree_alloc(d->record.count, sizeof *areas), area = d->s.area;
  for (size_t i = 0; i < d->record.count; i++) {
    area += d->record.area[i];
    areas[i] = area / d->s.area;
  }
  return areas;
}

static void check_lies(scree_mesh mesh) {
  scree_error error;
  scree_rng rng = {.seed = 5};
  const scree_coster *costers[] = {&scree_volume_coster, &scree_qecd_coster};
  for (int k = 0; k < 2; k++) {
    scree_decimator d = in_patches(&mesh, costers[k]);
    double *areas = areas_of(&d), worst = 0;
    for (int i = 0; i < 6; i++) {
      scree_mesh other;
      CHECK_OK(scree_mesh_copy(&mesh, &other, &error), error);
      mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
      for (int j = 0; j < 9; j++) turn.m[j / 3][j % 3] *= 1 + 0.3 * i;
      shape_transform(&other, &turn, (vec3){0.3 * i, -0.1, 0.2});
      scree_decimator turned = in_patches(&other, costers[k]);
      double *of_turned = areas_of(&turned);
      assert_int_equal(turned.record.count, d.record.count);
      for (size_t c = 0; c < d.record.count; c++)
        worst = fmax(worst, fabs(of_turned[c] - areas[c]));
      scree_free(of_turned);
      scree_decimator_free(&turned);
      scree_mesh_free(&other);
    }
    print_message("areas of %zu levels, turned six ways, differ by %g at the most\n",
                  d.record.count, worst);
    assert_true(worst < 1e-6);
    scree_free(areas);
    scree_decimator_free(&d);
  }
  scree_mesh_free(&mesh);
}

static void lie_changes_rounding_only(void **state) {
  (void)state;
  check_lies(slanted_box());
  check_lies(rough_ball());
}

/* Right-handed, at rest with what lies in it, and turned with it. */
static void frames_follow(void **state) {
  (void)state;
  scree_error error;
  scree_rng rng = {.seed = 8};
  scree_mesh mesh = slanted_box();
  scree_frame_of_places frame, other;
  scree_places places = {mesh.positions, 3, mesh.vertex_count};
  CHECK_OK(scree_frame_find(&places, (vec3){0, 0, 0}, &frame, &error), error);
  vec3 before = scree_frame_steps(&frame, 100, vec3_load(mesh.positions + 30));
  for (int i = 0; i < 20; i++) {
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    shape_transform(&mesh, &turn, (vec3){0.1, 0.2, -0.3});
    CHECK_OK(scree_frame_find(&places, (vec3){0, 0, 0}, &other, &error), error);
    const mat3 *a = &other.axes;
    vec3 x = vec3_load(a->m[0]), y = vec3_load(a->m[1]), z = vec3_load(a->m[2]);
    CHECK_NEAR(vec3_dot(vec3_cross(x, y), z), 1, 1e-12);
    vec3 after = scree_frame_steps(&other, 100, vec3_load(mesh.positions + 30));
    assert_true(vec3_distance(before, after) < 1e-9);
    for (size_t v = 0; v < mesh.vertex_count; v++) {
      vec3 steps = scree_frame_steps(&other, 100, vec3_load(mesh.positions + 3 * v));
      assert_true(fmin(steps.x, fmin(steps.y, steps.z)) > -1e-9);
      assert_true(fmax(steps.x, fmax(steps.y, steps.z)) < 100);
    }
  }
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(threads_change_nothing),
                                     cmocka_unit_test(lie_changes_rounding_only),
                                     cmocka_unit_test(frames_follow)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
