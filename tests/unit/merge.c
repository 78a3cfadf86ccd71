/* Shells that overlap become one surface: it passes the check, and its volume is that of the union,
 * which check counts in another way (mesh/measure/union_volume.c). */
#include "base/rng.h"
#include "base/vec.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

static scree_repair_options keep_all(void) {
  scree_repair_options o = scree_default_repair_options();
  o.debris_share = 0;
  o.handle_edges = 0;
  return o;
}

static double union_of(const scree_mesh *mesh) {
  scree_check check;
  scree_error error;
  CHECK_OK(scree_mesh_check(mesh, NULL, NULL, &check, &error), error);
  assert_true(check.volume_known);
  return check.volume;
}

/* Where the union touches itself the parts are drawn back by a hair, and its volume says less. */
static bool was_split(const scree_repair_report *report) {
  return report->done[SCREE_REPAIR_SPLIT_EDGE] || report->done[SCREE_REPAIR_SPLIT_VERTEX];
}

typedef struct tally {
  size_t merged, refused;
} tally;

static void merge_and_compare(const scree_mesh *mesh, double volume, tally *t) {
  scree_repair_options o = keep_all();
  scree_repair_report report;
  scree_check after;
  scree_error error;
  scree_mesh one;
  if (scree_mesh_repair(mesh, &o, NULL, &one, &report, &error) != SCREE_OK) {
    assert_int_equal(error.status, SCREE_BAD_MESH);
    print_message("%s\n", error.message);
    t->refused++;
    return;
  }
  CHECK_OK(scree_mesh_check(&one, NULL, NULL, &after, &error), error);
  assert_true(after.usable && after.volume_known);
  t->merged += report.done[SCREE_REPAIR_MERGE_SHELL] > 0;
  bool was_cut = report.done[SCREE_REPAIR_CUT_INTERSECTION]; /* where edges were too sharp */
  CHECK_NEAR(after.volume, volume, (was_cut ? 0.01 : was_split(&report) ? 1e-3 : 1e-9) * volume);
  scree_mesh_free(&one);
}

static scree_mesh join_and_free(scree_mesh a, scree_mesh b) {
  scree_mesh both = shape_join(&a, &b);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
  return both;
}

static scree_mesh flipped(scree_mesh mesh) {
  for (size_t t = 0; t < mesh.triangle_count; t++) shape_flip(&mesh, t);
  return mesh;
}

static scree_mesh moved(scree_mesh mesh, double x, double y, double z) {
  shape_move(&mesh, (vec3){x, y, z});
  return mesh;
}

static scree_mesh grid_boxes(scree_rng *rng) {
  scree_mesh all = {0};
  size_t count = 2 + scree_rng_below(rng, 3);
  for (size_t i = 0; i < count; i++) {
    double low[3], size[3];
    for (int k = 0; k < 3; k++) {
      low[k] = (double)scree_rng_below(rng, 5);
      size[k] = 1 + (double)scree_rng_below(rng, 3);
    }
    scree_mesh box = moved(shape_grid_box(size[0], size[1], size[2], 1 + scree_rng_below(rng, 2)),
                           low[0], low[1], low[2]);
    all = i ? join_and_free(all, box) : box;
  }
  return all;
}

/* Faces lie on each other, touch, and cross at right angles; turned in space, they do so within
 * rounding only, and a few may be refused. */
static void boxes_on_a_grid(void **state) {
  (void)state;
  scree_rng rng = {.seed = 61};
  tally straight = {0, 0}, turned = {0, 0};
  for (int round = 0; round < 500; round++) {
    scree_mesh all = grid_boxes(&rng);
    double volume = union_of(&all);
    merge_and_compare(&all, volume, &straight);
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    shape_transform(&all, &turn, (vec3){0.1, -20, 3});
    merge_and_compare(&all, volume, &turned);
    scree_mesh_free(&all);
  }
  assert_true(straight.merged > 300 && straight.refused == 0);
  assert_true(turned.merged > 300 && turned.refused < 5);
}

static scree_mesh random_body(scree_rng *rng) {
  int level = 1 + (int)scree_rng_below(rng, 3);
  scree_mesh mesh = scree_rng_below(rng, 3)
                        ? shape_icosphere(1, level)
                        : shape_grid_box(1.2, 1.5, 1.1, 1 + scree_rng_below(rng, 4));
  if (scree_rng_below(rng, 2)) shape_shake(&mesh, 0.02, rng);
  mat3 turn = quat_to_mat3(scree_rng_rotation(rng));
  double scale = 0.3 + scree_rng_uniform(rng);
  for (int i = 0; i < 9; i++) turn.m[i / 3][i % 3] *= scale;
  shape_transform(&mesh, &turn, vec3_scale(scree_rng_direction(rng), scree_rng_uniform(rng) * 1.5));
  return mesh;
}

static void bodies_anywhere(void **state) {
  (void)state;
  scree_rng rng = {.seed = 62};
  tally t = {0, 0};
  for (int round = 0; round < 500; round++) {
    scree_mesh all = random_body(&rng);
    for (size_t more = 1 + scree_rng_below(&rng, 3); more > 0; more--)
      all = join_and_free(all, random_body(&rng));
    merge_and_compare(&all, union_of(&all), &t);
    scree_mesh_free(&all);
  }
  assert_true(t.merged > 300 && t.refused == 0);
}

/* A cavity stays one; what breaks through a cavity's wall closes a part of it. */
static void cavities_stay(void **state) {
  (void)state;
  scree_mesh hollow = join_and_free(shape_grid_box(4, 4, 4, 3),
                                    flipped(moved(shape_grid_box(2, 2, 2, 2), 1.1, 1.2, 1.3)));
  scree_mesh all = join_and_free(hollow, moved(shape_grid_box(3, 0.5, 0.5, 1), 2.5, 1.5, 1.7));
  scree_repair_options o = keep_all();
  scree_repair_report report;
  scree_error error;
  scree_mesh one;
  CHECK_OK(scree_mesh_repair(&all, &o, NULL, &one, &report, &error), error);
  assert_int_equal(report.after.defects[SCREE_DEFECT_CAVITY], 1);
  /* 0.6 of the bar stands in the cavity, 1.5 outside */
  CHECK_NEAR(report.after.volume, 64 - 8 + 2.1 * 0.25, 1e-9);
  scree_mesh_free(&one);
  scree_mesh_free(&all);
}

static void refused_with_a_reason(void **state) {
  (void)state;
  scree_mesh all =
      join_and_free(shape_grid_box(2, 2, 2, 2), flipped(moved(shape_icosphere(1, 2), 2, 1, 1)));
  scree_repair_options o = keep_all();
  scree_error error;
  scree_mesh none;
  assert_int_equal(scree_mesh_repair(&all, &o, NULL, &none, NULL, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "shells were not merged: where they cross, one is wound "
                                        "inward"));
  scree_mesh_free(&all);
  all = join_and_free(shape_grid_box(2, 2, 2, 2), moved(shape_icosphere(1, 2), 2, 1, 1));
  o.merge_shells = false;
  assert_int_equal(scree_mesh_repair(&all, &o, NULL, &none, NULL, &error), SCREE_BAD_MESH);
  assert_null(strstr(error.message, "not merged"));
  scree_mesh_free(&all);
}

/* A shell and the same inside out, which cuts it into facets of its own: all cancel. */
static void nothing_left(void **state) {
  (void)state;
  scree_mesh all = join_and_free(shape_grid_box(2, 2, 2, 2), flipped(shape_grid_box(2, 2, 2, 3)));
  scree_error error;
  scree_mesh none;
  assert_int_equal(scree_mesh_repair(&all, NULL, NULL, &none, NULL, &error), SCREE_BAD_MESH);
  scree_mesh_free(&all);
}

/* A vertex pulled through the far side: what sticks out there is wound backwards, and goes. */
static void folds(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(1, 4);
  double clean = union_of(&mesh);
  vec3_store(mesh.positions + 3 * 40, vec3_scale(vec3_load(mesh.positions + 3 * 40), -1.3));
  scree_repair_options o = keep_all();
  scree_repair_report report;
  scree_error error;
  scree_mesh one;
  o.merge_folds = true;
  CHECK_OK(scree_mesh_repair(&mesh, &o, NULL, &one, &report, &error), error);
  assert_int_equal(report.done[SCREE_REPAIR_MERGE_SHELL], 1);
  assert_int_equal(report.done[SCREE_REPAIR_CUT_INTERSECTION], 0);
  /* the dent is there, a cone of a fan's area */
  CHECK_NEAR(report.after.volume, clean, 0.02 * clean);
  assert_true(report.after.volume < clean);
  scree_mesh_free(&one);
  scree_mesh_free(&mesh);
}

/* The same bits for any order of facets and any number of threads; memory may run out. */
static scree_status call_repair(void *context, scree_error *error) {
  scree_mesh one = {0};
  scree_status status = scree_mesh_repair(context, NULL, NULL, &one, NULL, error);
  scree_mesh_free(&one);
  return status;
}

static void is_repeatable(void **state) {
  (void)state;
  scree_rng rng = {.seed = 63};
  scree_mesh all = join_and_free(moved(shape_icosphere(1, 3), 0.5, 0.25, 0.125),
                                 join_and_free(shape_icosphere(1, 3), shape_grid_box(1, 1, 1, 3)));
  scree_mesh first = {0}, again;
  scree_error error;
  for (int threads = 1; threads <= 8; threads = threads < 3 ? threads + 1 : threads + 5) {
    scree_set_threads(threads);
    CHECK_OK(scree_mesh_repair(&all, NULL, NULL, &again, NULL, &error), error);
    if (threads == 1) {
      first = again;
    } else {
      assert_int_equal(first.vertex_count, again.vertex_count);
      assert_int_equal(first.triangle_count, again.triangle_count);
      assert_memory_equal(first.positions, again.positions, 24 * first.vertex_count);
      assert_memory_equal(first.triangles, again.triangles, 12 * first.triangle_count);
      scree_mesh_free(&again);
    }
    for (size_t t = all.triangle_count; t > 1; t--) {
      uint32_t *a = all.triangles + 3 * (t - 1), *b = all.triangles + 3 * scree_rng_below(&rng, t);
      uint32_t keep[3] = {a[0], a[1], a[2]};
      memmove(a, b, sizeof keep);
      memcpy(b, keep, sizeof keep);
    }
  }
  scree_set_threads(0);
  scree_mesh_free(&first);
  scree_mesh_free(&all);
  all = join_and_free(moved(shape_icosphere(1, 1), 0.5, 0.25, 0.125), shape_icosphere(1, 1));
  assert_true(check_allocation_failures(call_repair, &all) > 100);
  scree_mesh_free(&all);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_on_a_grid), cmocka_unit_test(bodies_anywhere),
      cmocka_unit_test(cavities_stay),   cmocka_unit_test(refused_with_a_reason),
      cmocka_unit_test(nothing_left),    cmocka_unit_test(folds),
      cmocka_unit_test(is_repeatable)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
