/* The tree against all triangles one by one, on surfaces, tangles with flat facets, needles and
 * grids; the nearest point of a triangle against a search. */
#include "support/check.h"
#include "support/shapes.h"

#include "mesh/bvh.h"
#include "mesh/mesh.h"

static scree_bvh build(const scree_mesh *mesh) {
  scree_bvh bvh;
  scree_error error;
  CHECK_OK(scree_bvh_build(mesh, &bvh, &error), error);
  return bvh;
}

static vec3 random_point(scree_rng *rng, double size) {
  return (vec3){size * scree_rng_normal(rng), size * scree_rng_normal(rng),
                size * scree_rng_normal(rng)};
}

/* ---- One triangle ---- */

/* The distance is convex over the triangle: a nested search on barycentric coordinates finds it. */
static double distance_at(const double *c, vec3 p, double u, double v) {
  vec3 a = vec3_load(c), b = vec3_load(c + 3), d = vec3_load(c + 6);
  vec3 q = vec3_mad(vec3_mad(a, vec3_sub(b, a), u), vec3_sub(d, a), v);
  return vec3_distance(p, q);
}

static double least_over_v(const double *c, vec3 p, double u) {
  double low = 0, high = 1 - u;
  for (int i = 0; i < 60; i++) {
    double third = (high - low) / 3;
    if (distance_at(c, p, u, low + third) < distance_at(c, p, u, high - third))
      high -= third;
    else
      low += third;
  }
  return distance_at(c, p, u, (low + high) / 2);
}

static double searched_distance(const double *c, vec3 p) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; i++) {
    double third = (high - low) / 3;
    if (least_over_v(c, p, low + third) < least_over_v(c, p, high - third))
      high -= third;
    else
      low += third;
  }
  return least_over_v(c, p, (low + high) / 2);
}

static void random_triangle(scree_rng *rng, int kind, double c[9]) {
  for (int i = 0; i < 9; i++) c[i] = scree_rng_normal(rng);
  if (kind == 1) { /* a needle: the third corner almost on the line of the others */
    double height = exp(-25 * scree_rng_uniform(rng)), at = 3 * scree_rng_uniform(rng) - 1;
    for (int k = 0; k < 3; k++) c[6 + k] = c[k] + at * (c[3 + k] - c[k]) + height * c[6 + k];
  } else if (kind == 2) { /* two corners almost or quite the same */
    double apart = scree_rng_below(rng, 2) ? exp(-30 * scree_rng_uniform(rng)) : 0;
    for (int k = 0; k < 3; k++) c[3 + k] = c[k] + apart * c[3 + k];
  } else if (kind == 3) { /* on a grid */
    for (int i = 0; i < 9; i++) c[i] = (double)scree_rng_below(rng, 3);
  }
}

static void test_triangle(void **state) {
  (void)state;
  scree_rng rng = {.seed = 20};
  for (int i = 0; i < 3000; i++) {
    double c[9];
    vec3 found;
    random_triangle(&rng, i % 4, c);
    vec3 p = i % 8 < 4 ? random_point(&rng, 2)
                       : vec3_mad(vec3_load(c), vec3_sub(vec3_load(c + 3), vec3_load(c + 6)),
                                  scree_rng_uniform(&rng));
    double d = sqrt(scree_triangle_closest(c, p, &found)), expected = searched_distance(c, p);
    CHECK_NEAR(d, expected, 1e-7 + 1e-7 * expected);
    /* the search may stop early on a needle, never below the truth */
    assert_true(d <= expected + 1e-10);
    CHECK_NEAR(vec3_distance(p, found), d, 1e-15 + 1e-15 * d);
  }
}

/* ---- Nearest points ---- */

static double brute_distance2(const scree_mesh *mesh, vec3 p) {
  double least = INFINITY;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    double c[9];
    vec3 point;
    for (int k = 0; k < 3; k++) vec3_store(c + 3 * k, scree_mesh_corner(mesh, t, k));
    least = fmin(least, scree_triangle_closest(c, p, &point));
  }
  return least;
}

static scree_mesh random_surface(scree_rng *rng, int kind) {
  if (kind == 0) return shape_random_tangle(rng);
  if (kind == 1) return shape_grid_box(1, 2, 0.01, 6);
  if (kind == 2) return shape_sheet(0, 9);
  if (kind == 3) return shape_torus(1, 0.4, 30, 14);
  scree_mesh mesh = shape_make(300, 100);
  for (size_t i = 0; i < 900; i++)
    mesh.positions[i] = exp(6 * scree_rng_normal(rng)) * scree_rng_normal(rng);
  for (uint32_t i = 0; i < 300; i++) mesh.triangles[i] = i;
  return mesh;
}

static void test_closest(void **state) {
  (void)state;
  scree_rng rng = {.seed = 21};
  for (int i = 0; i < 200; i++) {
    scree_mesh mesh = random_surface(&rng, i % 5);
    scree_bvh bvh = build(&mesh);
    for (int k = 0; k < 60; k++) {
      vec3 p = random_point(&rng, exp(2 * scree_rng_normal(&rng)));
      double expected = brute_distance2(&mesh, p);
      scree_bvh_hit hit = {.distance2 = INFINITY};
      assert_int_equal(scree_bvh_closest(&bvh, p, &hit), mesh.triangle_count > 0);
      if (mesh.triangle_count == 0) continue;
      CHECK_NEAR(hit.distance2, expected, 4e-16 * expected);
      CHECK_NEAR(vec3_norm2(vec3_sub(p, hit.point)), expected, 4e-16 * expected);
      /* a bound above finds the same, a bound below finds nothing */
      scree_bvh_hit bounded = {.distance2 = expected * (1 + 1e-12) + 1e-300};
      assert_true(scree_bvh_closest(&bvh, p, &bounded));
      CHECK_NEAR(bounded.distance2, expected, 4e-16 * expected);
      bounded.distance2 = expected;
      bounded.index = 12345;
      assert_false(scree_bvh_closest(&bvh, p, &bounded));
      assert_int_equal(bounded.index, 12345);
    }
    scree_bvh_free(&bvh);
    scree_mesh_free(&mesh);
  }
}

/* ---- The tree itself ---- */

static void test_structure(void **state) {
  (void)state;
  scree_rng rng = {.seed = 22};
  for (int i = 0; i < 40; i++) {
    scree_mesh mesh = i < 35 ? random_surface(&rng, i % 5) : shape_icosphere(1, 5);
    scree_bvh bvh = build(&mesh);
    bool *seen = calloc(mesh.triangle_count + 1, sizeof *seen);
    size_t in_leaves = 0;
    for (size_t n = 0; n < bvh.node_count; n++) {
      const scree_bvh_node *node = &bvh.nodes[n];
      if (node->count) assert_in_range(node->count, 1, 4);
      in_leaves += node->count;
      for (uint32_t k = 0; k < node->count; k++) {
        uint32_t t = bvh.order[node->first + k];
        assert_false(seen[t]);
        seen[t] = true;
        for (int c = 0; c < 9; c++) {
          double x = bvh.corners[9 * (node->first + k) + (uint32_t)c];
          assert_true(
              x == mesh.positions[3 * mesh.triangles[3 * t + (uint32_t)c / 3] + (uint32_t)c % 3]);
          assert_true(x >= node->low[c % 3] && x <= node->high[c % 3]);
        }
      }
      for (uint32_t side = 0; side < 2 && !node->count; side++)
        for (int k = 0; k < 3; k++)
          assert_true(bvh.nodes[node->first + side].low[k] >= node->low[k] &&
                      bvh.nodes[node->first + side].high[k] <= node->high[k]);
    }
    assert_int_equal(in_leaves, mesh.triangle_count);
    free(seen);
    scree_bvh_free(&bvh);
    scree_mesh_free(&mesh);
  }
}

static void test_threads(void **state) {
  (void)state;
  scree_mesh mesh = shape_torus(2, 1, 300, 100);
  scree_set_threads(1);
  scree_bvh one = build(&mesh);
  for (int threads = 2; threads <= 4; threads++) {
    scree_set_threads(threads);
    scree_bvh more = build(&mesh);
    assert_int_equal(more.node_count, one.node_count);
    assert_memory_equal(more.nodes, one.nodes, one.node_count * sizeof *one.nodes);
    assert_memory_equal(more.order, one.order, mesh.triangle_count * sizeof *one.order);
    scree_bvh_free(&more);
  }
  scree_set_threads(1);
  scree_bvh_free(&one);
  scree_mesh_free(&mesh);
}

/* ---- Overlaps ---- */

static bool mark(void *context, uint32_t triangle) {
  ((unsigned char *)context)[triangle]++;
  return true;
}
static bool stop(void *context, uint32_t triangle) {
  *(uint32_t *)context = triangle;
  return false;
}

static void test_overlap(void **state) {
  (void)state;
  scree_rng rng = {.seed = 23};
  for (int i = 0; i < 1000; i++) {
    scree_mesh mesh = random_surface(&rng, i % 4);
    scree_bvh bvh = build(&mesh);
    unsigned char marks[2000] = {0};
    vec3 p = random_point(&rng, 1), q = random_point(&rng, 1), low = vec3_min(p, q),
         high = vec3_max(p, q);
    size_t expected = 0;
    assert_true(scree_bvh_overlap(&bvh, low, high, mark, marks));
    for (size_t t = 0; t < mesh.triangle_count; t++) {
      vec3 a = scree_mesh_corner(&mesh, t, 0), b = scree_mesh_corner(&mesh, t, 1),
           c = scree_mesh_corner(&mesh, t, 2);
      vec3 from = vec3_min(vec3_min(a, b), c), to = vec3_max(vec3_max(a, b), c);
      bool meets = from.x <= high.x && to.x >= low.x && from.y <= high.y && to.y >= low.y &&
                   from.z <= high.z && to.z >= low.z;
      assert_int_equal(marks[t], meets);
      expected += meets;
    }
    uint32_t last = 0;
    assert_int_equal(scree_bvh_overlap(&bvh, low, high, stop, &last), expected == 0);
    scree_bvh_free(&bvh);
    scree_mesh_free(&mesh);
  }
}

/* ---- Crossings ---- */

static void test_winding_known(void **state) {
  (void)state;
  scree_rng rng = {.seed = 24};
  scree_mesh torus = shape_torus(2, 1, 40, 30), box = shape_grid_box(1, 1, 1, 4);
  scree_bvh torus_bvh = build(&torus), box_bvh = build(&box);
  for (int i = 0; i < 5000; i++) {
    vec3 p = random_point(&rng, 1.5);
    int winding;
    double ring = hypot(p.x, p.y) - 2, r = hypot(ring, p.z);
    if (fabs(r - 1) > 0.05) {
      assert_true(scree_bvh_winding(&torus_bvh, p, &winding));
      assert_int_equal(winding, r < 1);
    }
    /* grid points of the box: rays meet edges and vertices all the time */
    vec3 g = {(double)scree_rng_below(&rng, 9) / 8, (double)scree_rng_below(&rng, 9) / 8,
              (double)scree_rng_below(&rng, 9) / 8};
    bool on = g.x == 0 || g.y == 0 || g.z == 0 || g.x == 1 || g.y == 1 || g.z == 1;
    assert_int_equal(scree_bvh_winding(&box_bvh, g, &winding), !on);
    if (!on) assert_int_equal(winding, 1);
  }
  scree_bvh_free(&torus_bvh);
  scree_bvh_free(&box_bvh);
  scree_mesh_free(&torus);
  scree_mesh_free(&box);
}

/* Moeller-Trumbore for segments in general position. */
static int brute_crossing(const scree_mesh *mesh, size_t t, vec3 p, vec3 q) {
  vec3 a = scree_mesh_corner(mesh, t, 0), e = vec3_sub(scree_mesh_corner(mesh, t, 1), a),
       f = vec3_sub(scree_mesh_corner(mesh, t, 2), a), d = vec3_sub(q, p), s = vec3_sub(p, a),
       h = vec3_cross(d, f), g = vec3_cross(s, e);
  double det = vec3_dot(e, h);
  if (det == 0) return 0;
  double u = vec3_dot(s, h) / det, v = vec3_dot(d, g) / det, along = vec3_dot(f, g) / det;
  if (u < 0 || v < 0 || u + v > 1 || along < 0 || along > 1) return 0;
  return vec3_dot(d, vec3_cross(e, f)) > 0 ? 1 : -1;
}

static void test_crossings(void **state) {
  (void)state;
  scree_rng rng = {.seed = 25};
  size_t total = 0;
  for (int i = 0; i < 4000; i++) {
    scree_mesh mesh = random_surface(&rng, i % 4);
    scree_bvh bvh = build(&mesh);
    vec3 p = random_point(&rng, 2), q = random_point(&rng, 2);
    size_t count, expected = 0;
    int balance, expected_balance = 0;
    assert_true(scree_bvh_crossings(&bvh, p, q, &count, &balance));
    for (size_t t = 0; t < mesh.triangle_count; t++) {
      int crossed = brute_crossing(&mesh, t, p, q);
      expected += crossed != 0;
      expected_balance += crossed;
    }
    assert_int_equal(count, expected);
    assert_int_equal(balance, expected_balance);
    total += count;
    scree_bvh_free(&bvh);
    scree_mesh_free(&mesh);
  }
  assert_true(total > 300);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_triangle),  cmocka_unit_test(test_closest),
      cmocka_unit_test(test_structure), cmocka_unit_test(test_threads),
      cmocka_unit_test(test_overlap),   cmocka_unit_test(test_winding_known),
      cmocka_unit_test(test_crossings),
  };
  scree_set_threads(
      1); /* thousands of tiny trees: waking threads would take longer than the work */
  return cmocka_run_group_tests(tests, NULL, NULL);
}
