/* The checks: every defect planted in a clean surface is counted, and nothing else is. */
#include "support/check.h"
#include "base/rng.h"
#include "base/vec.h"
#include "support/shapes.h"

static scree_check check_of(const scree_mesh *mesh) {
  scree_check check;
  scree_error error;
  CHECK_OK(scree_mesh_check(mesh, NULL, NULL, &check, &error), error);
  return check;
}

/* Asserts the defects given as (defect, count) pairs ended by -1, and no others. */
static void expect(const scree_check *check, const int *pairs) {
  size_t expected[SCREE_DEFECT_COUNT] = {0};
  for (; *pairs >= 0; pairs += 2) expected[pairs[0]] = (size_t)pairs[1];
  for (int i = 0; i < SCREE_DEFECT_COUNT; i++)
    if (check->defects[i] != expected[i]) {
      print_error("%s: %zu, expected %zu\n", scree_defect_name((scree_defect)i), check->defects[i],
                  expected[i]);
      fail();
    }
}

static void turn_inside_out(scree_mesh *mesh) {
  for (size_t t = 0; t < mesh->triangle_count; t++) shape_flip(mesh, t);
}

static void clean(void **state) {
  (void)state;
  scree_mesh sphere = shape_icosphere(1, 4);
  scree_check check = check_of(&sphere);
  expect(&check, (const int[]){-1});
  assert_true(check.usable && check.volume_known && check.intersections_known);
  assert_int_equal(check.shell_count, 1);
  CHECK_NEAR(check.volume, 4.18, 0.02);
  assert_string_equal(check.verdict,
                      "usable as a particle: closed, manifold, outward, nowhere meeting itself");
  turn_inside_out(&sphere);
  check = check_of(&sphere);
  expect(&check, (const int[]){SCREE_DEFECT_INSIDE_OUT_SHELL, 1, -1});
  assert_false(check.usable || check.volume_known);
  scree_mesh_free(&sphere);
}

static void planted(void **state) {
  (void)state;
  scree_mesh box = shape_grid_box(1, 1, 1, 4);
  box.triangle_count--;
  scree_check check = check_of(&box);
  expect(&check, (const int[]){SCREE_DEFECT_BOUNDARY_EDGE, 3, SCREE_DEFECT_HOLE, 1, -1});
  assert_string_equal(check.verdict, "not usable as a particle: 3 boundary edges, 1 hole");
  box.triangle_count++;
  shape_flip(&box, 7);
  check = check_of(&box);
  expect(&check, (const int[]){SCREE_DEFECT_INCONSISTENT_EDGE, 3, -1});
  shape_flip(&box, 7);
  double keep = box.positions[0];
  box.positions[0] = NAN;
  check = check_of(&box);
  expect(&check, (const int[]){SCREE_DEFECT_BAD_COORDINATE, 1, -1});
  box.positions[0] = keep;
  scree_mesh twice = shape_join(&box, &box);
  for (size_t c = 0; c < 3 * twice.triangle_count; c++)
    twice.triangles[c] %= (uint32_t)box.vertex_count;
  twice.triangle_count = box.triangle_count + 1;
  check = check_of(&twice);
  expect(&check, (const int[]){SCREE_DEFECT_DUPLICATE_FACET, 1, SCREE_DEFECT_NON_MANIFOLD_EDGE, 3,
                               SCREE_DEFECT_OVERLAPPING_PAIR, 1, SCREE_DEFECT_UNUSED_VERTEX,
                               (int)box.vertex_count, -1});
  scree_mesh_free(&twice);
  scree_mesh_free(&box);
}

/* One inside the other at the scale, the inner one inward or not; moved so that rays run through
 * vertices and edges of the outer one. */
static scree_check nest(double scale, bool inward, vec3 offset) {
  scree_mesh outer = shape_grid_box(4, 4, 4, 4), inner = shape_grid_box(scale, scale, scale, 2);
  shape_move(&inner, offset);
  if (inward) turn_inside_out(&inner);
  scree_mesh both = shape_join(&outer, &inner);
  scree_check check = check_of(&both);
  scree_mesh_free(&outer);
  scree_mesh_free(&inner);
  scree_mesh_free(&both);
  return check;
}

static void nesting(void **state) {
  (void)state;
  for (int i = 0; i < 3; i++) {
    vec3 at = {1, 0.5 + 0.5 * i, 1};
    scree_check check = nest(1, true, at);
    expect(&check, (const int[]){SCREE_DEFECT_CAVITY, 1, -1});
    assert_true(check.usable && check.volume_known);
    CHECK_NEAR(check.volume, 63, 1e-12);
    check = nest(1, false, at);
    expect(&check, (const int[]){SCREE_DEFECT_NESTED_SHELL, 1, -1});
    assert_true(!check.usable && check.volume_known);
    CHECK_NEAR(check.volume, 64, 1e-12);
    check = nest(1, false, (vec3){-3, 0.5 + 0.5 * i, 1});
    expect(&check, (const int[]){SCREE_DEFECT_EXTRA_BODY, 1, -1});
    CHECK_NEAR(check.volume, 65, 1e-12);
    check = nest(1, true, (vec3){-3, 0.5 + 0.5 * i, 1});
    expect(&check, (const int[]){SCREE_DEFECT_INSIDE_OUT_SHELL, 1, -1});
    assert_false(check.volume_known);
  }
  scree_check check = nest(1, false, (vec3){3.4, 1.3, 1.3});
  assert_int_equal(check.defects[SCREE_DEFECT_OVERLAPPING_SHELLS], 1);
  assert_true(check.defects[SCREE_DEFECT_CROSSING_PAIR] > 0 && check.volume_known);
  CHECK_NEAR(check.volume, 64.4, 1e-12);
  check = nest(1, false, (vec3){4, 1, 1}); /* face on face */
  assert_int_equal(check.defects[SCREE_DEFECT_OVERLAPPING_SHELLS], 1);
  assert_int_equal(check.defects[SCREE_DEFECT_CROSSING_PAIR], 0);
  assert_true(check.defects[SCREE_DEFECT_OVERLAPPING_PAIR] > 0 && check.volume_known);
  CHECK_NEAR(check.volume, 65, 1e-12);
}

/* Boxes in boxes, alternately wound: material, cavity, material... */
static void onion(void **state) {
  (void)state;
  scree_mesh all = shape_box(20, 20, 20);
  for (int i = 1; i < 9; i++) {
    scree_mesh layer = shape_box(20 - 2 * i, 20 - 2 * i, 20 - 2 * i), joined;
    shape_move(&layer, (vec3){i, i, i});
    if (i % 2) turn_inside_out(&layer);
    joined = shape_join(&all, &layer);
    scree_mesh_free(&all);
    scree_mesh_free(&layer);
    all = joined;
  }
  scree_check check = check_of(&all);
  expect(&check, (const int[]){SCREE_DEFECT_CAVITY, 4, SCREE_DEFECT_EXTRA_BODY, 4, -1});
  double volume = 0;
  for (int i = 0; i < 9; i++) volume += (i % 2 ? -1 : 1) * pow(20 - 2 * i, 3);
  CHECK_NEAR(check.volume, volume, 1e-9);
  turn_inside_out(&all);
  check = check_of(&all);
  assert_int_equal(check.defects[SCREE_DEFECT_INSIDE_OUT_SHELL], 5);
  scree_mesh_free(&all);
}

/* Adds a box, outward or inward. */
static void add_box(scree_mesh *all, vec3 size, vec3 at, bool inward) {
  scree_mesh box = shape_box(size.x, size.y, size.z), joined;
  shape_move(&box, at);
  if (inward) turn_inside_out(&box);
  joined = shape_join(all, &box);
  scree_mesh_free(all);
  scree_mesh_free(&box);
  *all = joined;
}

/* Shells that meet count as beside each other, from whatever side they are looked at: the longer
 * ends of the bars stick out of the block to different sides. */
static void nesting_of_shells_that_meet(void **state) {
  (void)state;
  scree_rng rng = {.seed = 42};
  scree_mesh all = shape_box(10, 10, 10);
  add_box(&all, (vec3){9, 1, 1}, (vec3){2, 4, 4}, false);              /* out of the block at +x */
  add_box(&all, (vec3){9, 1, 1}, (vec3){-1, 7, 7}, false);             /* and at -x */
  add_box(&all, (vec3){0.5, 0.5, 0.5}, (vec3){5, 4.2, 4.2}, false);    /* in bar and block */
  add_box(&all, (vec3){0.5, 0.5, 0.5}, (vec3){10.2, 4.2, 4.2}, false); /* in the bar alone */
  add_box(&all, (vec3){1, 1, 1}, (vec3){1, 1, 1}, true);               /* a cavity */
  add_box(&all, (vec3){0.5, 0.5, 0.5}, (vec3){1.25, 1.25, 1.25}, false); /* free in it */
  for (int i = 0; i < 24; i++) {
    scree_check check = check_of(&all);
    assert_int_equal(check.defects[SCREE_DEFECT_OVERLAPPING_SHELLS], 2);
    assert_int_equal(check.defects[SCREE_DEFECT_NESTED_SHELL], 2);
    assert_int_equal(check.defects[SCREE_DEFECT_CAVITY], 1);
    assert_int_equal(check.defects[SCREE_DEFECT_INSIDE_OUT_SHELL], 0);
    assert_int_equal(check.defects[SCREE_DEFECT_EXTRA_BODY], 3);
    assert_true(check.volume_known);
    CHECK_NEAR(check.volume, 1000 + 1 + 1 - 1 + 0.125, 1e-9);
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    shape_transform(&all, &turn, scree_rng_direction(&rng));
  }
  scree_mesh_free(&all);
}

/* An inward shell that meets another: a pocket in its wall, or in part inside out. */
static void pockets(void **state) {
  (void)state;
  for (int i = 0; i < 6; i++) { /* each wall */
    vec3 at = {1, 1, 1};
    double *coordinate[3] = {&at.x, &at.y, &at.z};
    for (int deep = 0; deep < 2; deep++) {
      scree_mesh all = shape_box(4, 4, 4);
      *coordinate[i / 2] = (i % 2 ? 3.0 : 0.0) + (deep ? (i % 2 ? 0.5 : -0.5) : 0);
      add_box(&all, (vec3){1, 1, 1}, at, true);
      scree_check check = check_of(&all);
      assert_int_equal(check.defects[SCREE_DEFECT_OVERLAPPING_SHELLS], 1);
      assert_int_equal(check.defects[SCREE_DEFECT_CAVITY], !deep);
      assert_int_equal(check.defects[SCREE_DEFECT_INSIDE_OUT_SHELL], deep);
      assert_int_equal(check.volume_known, !deep);
      if (!deep) CHECK_NEAR(check.volume, 63, 1e-12);
      scree_mesh_free(&all);
    }
  }
}

/* A tetrahedron in a corner of a box, or outside that corner, with one vertex in common. */
static void nested_at_a_vertex(void **state) {
  (void)state;
  for (int i = 0; i < 16; i++) { /* each corner */
    bool inside = i < 8;
    scree_mesh box = shape_box(4, 4, 4), tetrahedron = shape_tetrahedron(1, 1, 1);
    /* a corner's edges lean inwards, so that it meets no face */
    for (size_t v = 0; v < 4; v++) {
      double *p = tetrahedron.positions + 3 * v, sum = p[0] + p[1] + p[2];
      for (int k = 0; k < 3; k++) p[k] = (p[k] + 0.5 * sum) * (inside ? 1 : -1);
    }
    scree_mesh all = shape_join(&box, &tetrahedron);
    if (!inside)
      for (size_t t = box.triangle_count; t < all.triangle_count; t++) shape_flip(&all, t);
    for (int k = 0; k < 3; k++)
      if (i >> k & 1) {
        for (size_t v = 0; v < all.vertex_count; v++)
          all.positions[3 * v + (size_t)k] = -all.positions[3 * v + (size_t)k];
        turn_inside_out(&all);
      }
    scree_mesh welded = shape_weld(&all, NULL);
    scree_check check = check_of(&welded);
    expect(&check, inside ? (const int[]){SCREE_DEFECT_NON_MANIFOLD_VERTEX, 1,
                                          SCREE_DEFECT_NESTED_SHELL, 1, -1}
                          : (const int[]){SCREE_DEFECT_NON_MANIFOLD_VERTEX, 1,
                                          SCREE_DEFECT_EXTRA_BODY, 1, -1});
    scree_mesh_free(&box);
    scree_mesh_free(&tetrahedron);
    scree_mesh_free(&all);
    scree_mesh_free(&welded);
  }
}

static void refused(void **state) {
  (void)state;
  scree_error error;
  scree_check check;
  scree_mesh box = shape_box(1, 1, 1), empty = {0};
  box.triangles[5] = 8;
  assert_int_equal(scree_mesh_check(&box, NULL, NULL, &check, &error), SCREE_BAD_MESH);
  assert_string_equal(error.message, "triangle 1 names vertex 8, but there are only 8 vertices");
  scree_mesh_free(&box);
  check = check_of(&empty);
  assert_false(check.usable);
}

/* The counts do not depend on where the surface lies or how it is turned and stretched; of angles
 * the stretch makes others. */
static void transforms(void **state) {
  (void)state;
  scree_rng rng = {.seed = 41};
  for (int n = 0; n < 100; n++) {
    scree_mesh tangle = shape_random_tangle(&rng);
    scree_check before = check_of(&tangle), after;
    mat3 scale = {{{0, 0, 4}, {-0.25, 0, 0}, {0, -2, 0}}}; /* exact in floating point */
    shape_transform(&tangle, &scale, (vec3){16, -32, 1});
    after = check_of(&tangle);
    for (int i = 0; i < SCREE_DEFECT_COUNT; i++)
      if (i != SCREE_DEFECT_SHARP_EDGE) assert_int_equal(before.defects[i], after.defects[i]);
    scree_mesh_free(&tangle);
  }
}

/* 7,000 copies of a triangle: what was not counted is not told as a number. */
static void too_many_pairs(void **state) {
  (void)state;
  enum { COPIES = 7000 };
  static uint32_t triangles[3 * COPIES];
  static double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  for (int i = 0; i < 3 * COPIES; i++) triangles[i] = (uint32_t)(i % 3);
  scree_mesh mesh = {positions, triangles, 3, COPIES};
  scree_check check = check_of(&mesh);
  assert_true(check.too_many_pairs && check.intersections_known && !check.volume_known);
  assert_false(check.usable);
  assert_int_equal(check.defects[SCREE_DEFECT_CROSSING_PAIR], 0);
  assert_false(scree_defect_is_counted(&check, SCREE_DEFECT_CROSSING_PAIR));
  assert_false(scree_defect_is_counted(&check, SCREE_DEFECT_EXTRA_BODY));
  assert_true(scree_defect_is_counted(&check, SCREE_DEFECT_NON_MANIFOLD_EDGE));
  assert_non_null(strstr(check.verdict, "particle: more than 20000000 meeting pairs, 6999 dup"));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(clean),
                                     cmocka_unit_test(planted),
                                     cmocka_unit_test(nesting),
                                     cmocka_unit_test(onion),
                                     cmocka_unit_test(nesting_of_shells_that_meet),
                                     cmocka_unit_test(pockets),
                                     cmocka_unit_test(nested_at_a_vertex),
                                     cmocka_unit_test(refused),
                                     cmocka_unit_test(too_many_pairs),
                                     cmocka_unit_test(transforms)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
