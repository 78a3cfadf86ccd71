/* Welding against a slow oracle that compares every pair, and its promise of one order. */
#include "base/alloc.h"
#include "base/rng.h"
#include "support/check.h"
#include "support/shapes.h"

static scree_rng rng;

/* Corners on a coarse lattice, so that many coincide; `flat` puts all on one plane. */
static double *random_corners(size_t facets, uint64_t steps, bool flat) {
  double *corners = malloc((9 * facets + 1) * sizeof *corners);
  for (size_t i = 0; i < 9 * facets; i++) {
    corners[i] = (double)scree_rng_below(&rng, steps) * 0.1 - 0.3;
    if (flat && i % 3 == 0) corners[i] = scree_rng_below(&rng, 2) ? 0.0 : -0.0;
  }
  return corners;
}

static int compare_positions(const void *a, const void *b) {
  const double *p = a, *q = b;
  for (int i = 0; i < 3; i++)
    if (p[i] != q[i]) return p[i] < q[i] ? -1 : 1;
  return 0;
}

static int compare_triangles(const void *a, const void *b) {
  const uint32_t *s = a, *t = b;
  for (int i = 0; i < 3; i++)
    if (s[i] != t[i]) return s[i] < t[i] ? -1 : 1;
  return 0;
}

/* The contract, word by word, by sorting everything with qsort. */
static scree_mesh slow_weld(const double *corners, size_t facets, size_t *degenerate) {
  double *all = malloc((9 * facets + 1) * sizeof *all);
  size_t kept = 0;
  for (size_t f = 0; f < facets; f++) {
    const double *c = corners + 9 * f;
    if (!compare_positions(c, c + 3) || !compare_positions(c + 3, c + 6) ||
        !compare_positions(c + 6, c))
      continue;
    for (int i = 0; i < 9; i++) all[9 * kept + (size_t)i] = c[i] + 0.0;
    kept++;
  }
  *degenerate = facets - kept;
  scree_mesh mesh = {scree_alloc(9 * kept, sizeof(double)), scree_alloc(3 * kept, 4), 0, kept};
  memcpy(mesh.positions, all, 9 * kept * sizeof *all);
  qsort(mesh.positions, 3 * kept, 3 * sizeof(double), compare_positions);
  for (size_t i = 0; i < 3 * kept; i++)
    if (i == 0 || compare_positions(mesh.positions + 3 * i,
                                    mesh.positions + 3 * (mesh.vertex_count - 1)) != 0)
      memmove(mesh.positions + 3 * mesh.vertex_count++, mesh.positions + 3 * i, 24);
  for (size_t f = 0; f < kept; f++) {
    uint32_t v[3];
    for (int k = 0; k < 3; k++) {
      const double *found =
          bsearch(all + 9 * f + 3 * k, mesh.positions, mesh.vertex_count, 24, compare_positions);
      v[k] = (uint32_t)((size_t)(found - mesh.positions) / 3);
    }
    int least = v[0] < v[1] ? (v[0] < v[2] ? 0 : 2) : (v[1] < v[2] ? 1 : 2);
    for (int k = 0; k < 3; k++) mesh.triangles[3 * f + (size_t)k] = v[(least + k) % 3];
  }
  qsort(mesh.triangles, kept, 12, compare_triangles);
  free(all);
  return mesh;
}

static void assert_same_mesh(const scree_mesh *a, const scree_mesh *b) {
  assert_int_equal(a->vertex_count, b->vertex_count);
  assert_int_equal(a->triangle_count, b->triangle_count);
  assert_memory_equal(a->positions, b->positions, 24 * a->vertex_count);
  assert_memory_equal(a->triangles, b->triangles, 12 * a->triangle_count);
}

static scree_mesh weld(const double *corners, size_t facets, double tolerance, size_t *degenerate) {
  scree_mesh mesh = {0};
  scree_error error;
  CHECK_OK(scree_mesh_weld(corners, facets, tolerance, &mesh, degenerate, &error), error);
  return mesh;
}

static void same_as_slow(void **state) {
  (void)state;
  for (int round = 0; round < 3000; round++) {
    size_t facets = scree_rng_below(&rng, round % 100 ? 60 : 6000);
    double *corners =
        random_corners(facets, 1 + scree_rng_below(&rng, round % 3 ? 12 : 5000), round % 5 == 0);
    if (round % 7 == 0 && facets) /* far ends of the range, and steps no bucket can part */
      for (int i = 0; i < 30; i++)
        corners[scree_rng_below(&rng, 9 * facets)] =
            ldexp(scree_rng_uniform(&rng) - 0.5, (int)scree_rng_below(&rng, 1070) - 1000);
    size_t degenerate, expected_degenerate;
    scree_mesh mesh = weld(corners, facets, 0, &degenerate);
    scree_mesh expected = slow_weld(corners, facets, &expected_degenerate);
    assert_int_equal(degenerate, expected_degenerate);
    assert_same_mesh(&mesh, &expected);
    scree_mesh_free(&mesh);
    scree_mesh_free(&expected);
    free(corners);
  }
}

/* Facets shuffled, each started at another corner. */
static void shuffle(double *corners, size_t facets) {
  for (size_t f = facets; f-- > 0;) {
    size_t other = scree_rng_below(&rng, f + 1), turn = scree_rng_below(&rng, 3);
    double kept[9], turned[9];
    memcpy(kept, corners + 9 * f, sizeof kept);
    memcpy(corners + 9 * f, corners + 9 * other, sizeof kept);
    for (size_t i = 0; i < 9; i++) turned[i] = kept[(i + 3 * turn) % 9];
    memcpy(corners + 9 * other, turned, sizeof turned);
  }
}

static void any_order_any_threads(void **state) {
  (void)state;
  for (int round = 0; round < 30; round++) {
    size_t facets = round ? 2000 : 200000, degenerate[2];
    double tolerance = round % 2 ? 0.02 : 0;
    double *corners = random_corners(facets, round ? 100 : 60, false);
    for (size_t i = 0; round % 3 == 0 && i < 9 * facets; i++)
      corners[i] += 1e-3 * scree_rng_uniform(&rng);
    scree_mesh first = weld(corners, facets, tolerance, &degenerate[0]);
    shuffle(corners, facets);
    scree_set_threads(1 + round % 5);
    scree_mesh second = weld(corners, facets, tolerance, &degenerate[1]);
    scree_set_threads(0);
    assert_int_equal(degenerate[0], degenerate[1]);
    assert_same_mesh(&first, &second);
    scree_mesh_free(&first);
    scree_mesh_free(&second);
    free(corners);
  }
}

/* A fan: one vertex with many triangles, which a count per vertex does not spread. */
static void fan(void **state) {
  (void)state;
  enum { FACETS = 30000 };
  double *corners = calloc(9 * FACETS, sizeof *corners);
  for (size_t f = 0; f < FACETS; f++) {
    corners[9 * f] = corners[9 * f + 1] = -1;
    for (size_t k = 1; k < 3; k++) {
      corners[9 * f + 3 * k] = cos(2e-4 * (double)(f + k));
      corners[9 * f + 3 * k + 1] = sin(2e-4 * (double)(f + k));
    }
  }
  shuffle(corners, FACETS);
  size_t degenerate, expected_degenerate;
  scree_mesh mesh = weld(corners, FACETS, 0, &degenerate);
  scree_mesh expected = slow_weld(corners, FACETS, &expected_degenerate);
  assert_same_mesh(&mesh, &expected);
  scree_mesh_free(&mesh);
  scree_mesh_free(&expected);
  free(corners);
}

/* With a tolerance: groups by comparing all pairs until nothing changes. */
static void near_against_all_pairs(void **state) {
  (void)state;
  for (int round = 0; round < 300; round++) {
    size_t facets = 1 + scree_rng_below(&rng, 40), degenerate;
    double *corners = random_corners(facets, 4, false);
    for (size_t i = 0; i < 9 * facets; i++) corners[i] += 0.04 * scree_rng_uniform(&rng);
    scree_mesh exact = weld(corners, facets, 0, NULL);
    if (exact.triangle_count == 0) goto next;
    double low[3], high[3], tolerance = 0.001 + 0.09 * scree_rng_uniform(&rng);
    for (int i = 0; i < 3; i++) low[i] = high[i] = exact.positions[i];
    for (size_t i = 0; i < 3 * exact.vertex_count; i++) {
      low[i % 3] = fmin(low[i % 3], exact.positions[i]);
      high[i % 3] = fmax(high[i % 3], exact.positions[i]);
    }
    double distance = tolerance * sqrt(pow(high[0] - low[0], 2) + pow(high[1] - low[1], 2) +
                                       pow(high[2] - low[2], 2));
    uint32_t group[120];
    for (uint32_t v = 0; v < exact.vertex_count; v++) group[v] = v;
    for (bool changed = true; changed;) {
      changed = false;
      for (size_t a = 0; a < exact.vertex_count; a++)
        for (size_t b = 0; b < a; b++) {
          const double *p = exact.positions + 3 * a, *q = exact.positions + 3 * b;
          double apart = sqrt(pow(p[0] - q[0], 2) + pow(p[1] - q[1], 2) + pow(p[2] - q[2], 2));
          if (apart <= distance && group[a] != group[b]) {
            group[a] = group[b] = group[a] < group[b] ? group[a] : group[b];
            changed = true;
          }
        }
    }
    double *moved = malloc(9 * exact.triangle_count * sizeof *moved);
    for (size_t i = 0; i < 3 * exact.triangle_count; i++)
      memcpy(moved + 3 * i, exact.positions + 3 * (size_t)group[exact.triangles[i]], 24);
    scree_mesh got = weld(corners, facets, tolerance, &degenerate);
    scree_mesh expected = weld(moved, exact.triangle_count, 0, NULL);
    assert_int_equal(degenerate, facets - expected.triangle_count);
    assert_same_mesh(&got, &expected);
    scree_mesh_free(&got);
    scree_mesh_free(&expected);
    free(moved);
  next:
    scree_mesh_free(&exact);
    free(corners);
  }
}

/* Whatever the order, what comes is the order of reading; a mesh that has it stays as it is. */
static void canonicalized(void **state) {
  (void)state;
  for (int round = 0; round < 100; round++) {
    scree_error error;
    scree_mesh mesh = shape_icosphere(0.02, 1 + round % 3), read = shape_weld(&mesh, NULL);
    scree_mesh_free(&mesh);
    mesh = shape_weld(&read, NULL);
    for (size_t t = mesh.triangle_count; t-- > 1;) { /* another order, other corners first */
      uint32_t *a = mesh.triangles + 3 * t, *b = mesh.triangles + 3 * scree_rng_below(&rng, t);
      const uint32_t was[3] = {a[0], a[1], a[2]}, turned[3] = {b[1], b[2], b[0]};
      memcpy(a, turned, sizeof turned);
      memcpy(b, was, sizeof was);
    }
    CHECK_OK(scree_mesh_canonicalize(&mesh, &error), error);
    assert_same_mesh(&mesh, &read);
    CHECK_OK(scree_mesh_canonicalize(&mesh, &error), error);
    assert_same_mesh(&mesh, &read);
    mesh.positions[3] = NAN;
    assert_int_equal(scree_mesh_canonicalize(&mesh, &error), SCREE_BAD_ARGUMENT);
    assert_int_equal(mesh.triangle_count, read.triangle_count);
    scree_mesh_free(&mesh);
    scree_mesh_free(&read);
  }
}

static void refusals(void **state) {
  (void)state;
  scree_error error;
  scree_mesh mesh = {0};
  double corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  assert_int_equal(scree_mesh_weld(corners, 1, -1, &mesh, NULL, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(scree_mesh_weld(corners, 1, NAN, &mesh, NULL, &error), SCREE_BAD_ARGUMENT);
  corners[5] = NAN;
  assert_int_equal(scree_mesh_weld(corners, 1, 0, &mesh, NULL, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "corner 1"));
  corners[5] = 1e31;
  assert_int_equal(scree_mesh_weld(corners, 1, 0, &mesh, NULL, NULL), SCREE_BAD_ARGUMENT);
  assert_null(mesh.positions);
  assert_int_equal(scree_mesh_weld(corners, 0, 0, &mesh, NULL, NULL), SCREE_OK);
  assert_int_equal(mesh.triangle_count, 0);
  scree_mesh_free(&mesh);
}

int main(void) {
  rng = (scree_rng){11, 2, 0};
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_as_slow),  cmocka_unit_test(any_order_any_threads),
      cmocka_unit_test(fan),           cmocka_unit_test(near_against_all_pairs),
      cmocka_unit_test(canonicalized), cmocka_unit_test(refusals),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
