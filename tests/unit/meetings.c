/* The search for self-intersections against testing every pair, on soups, surfaces and layouts that
 * defeat grids and boxes. */
#include "base/alloc.h"
#include "base/rng.h"
#include "mesh/index/intersect.h"
#include "mesh/mesh.h"
#include "mesh/repair/searched.h"
#include "support/check.h"

typedef struct soup {
  scree_mesh mesh;
} soup;

static soup make_soup(size_t vertex_count, size_t triangle_count) {
  soup s = {{.vertex_count = vertex_count, .triangle_count = triangle_count}};
  s.mesh.positions = calloc(3 * vertex_count, sizeof(double));
  s.mesh.triangles = calloc(3 * triangle_count, sizeof(uint32_t));
  return s;
}

static void free_soup(soup *s) {
  free(s->mesh.positions);
  free(s->mesh.triangles);
}

static void compare_with_all_pairs(const scree_mesh *mesh, size_t *found_count) {
  scree_error error;
  scree_meetings found;
  size_t next = 0;
  CHECK_OK(scree_mesh_meetings(mesh, NULL, SIZE_MAX, NULL, &found, &error), error);
  for (uint32_t a = 0; a < mesh->triangle_count; a++)
    for (uint32_t b = a + 1; b < mesh->triangle_count; b++) {
      const uint32_t *t = mesh->triangles + 3 * a, *u = mesh->triangles + 3 * b;
      scree_box of_a = scree_facet_box(mesh, a), of_b = scree_facet_box(mesh, b);
      if (!scree_box_meets(&of_a, &of_b)) continue;
      scree_meet meet = scree_triangles_meet(mesh->positions, t, u);
      if (meet == SCREE_MEET_NOT) continue;
      assert_true(next < found.count);
      assert_int_equal(found.items[next].first, a);
      assert_int_equal(found.items[next].second, b);
      assert_int_equal(found.items[next].meet, meet);
      next++;
    }
  assert_int_equal(next, found.count);
  *found_count += next;
  scree_free(found.items);
}

/* Loose triangles: sizes from tiny to long slivers, on a coarse grid in every other soup. */
static void soups(void **state) {
  (void)state;
  scree_rng rng = {.seed = 31};
  size_t found_count = 0;
  for (int n = 0; n < 60; n++) {
    size_t triangle_count = 20 + scree_rng_below(&rng, 150);
    soup s = make_soup(3 * triangle_count, triangle_count);
    for (size_t t = 0; t < triangle_count; t++) {
      vec3 at = vec3_scale(scree_rng_direction(&rng), scree_rng_uniform(&rng));
      vec3 along = vec3_scale(scree_rng_direction(&rng), n % 3 ? 0.1 : 1.5);
      for (int k = 0; k < 3; k++) {
        vec3 p = vec3_mad(at, along, (double)k);
        p = vec3_mad(p, scree_rng_direction(&rng), n % 3 ? 0.2 : 0.01);
        if (n % 2) p = (vec3){rint(4 * p.x), rint(4 * p.y), rint(4 * p.z)};
        vec3_store(s.mesh.positions + 3 * (3 * t + (size_t)k), p);
        s.mesh.triangles[3 * t + (size_t)k] = (uint32_t)(3 * t + (size_t)k);
      }
    }
    compare_with_all_pairs(&s.mesh, &found_count);
    free_soup(&s);
  }
  assert_true(found_count > 1000);
}

/* Without pairs of settled facets: what is left of all pairs. */
static void unsettled(void **state) {
  (void)state;
  scree_rng rng = {.seed = 32};
  size_t left = 0, out = 0;
  for (int n = 0; n < 40; n++) {
    size_t triangle_count = 10 + scree_rng_below(&rng, 400), next = 0;
    soup s = make_soup(3 * triangle_count, triangle_count);
    scree_facet_tree tree;
    scree_meetings all, found, near;
    scree_error error;
    bool settled[410];
    for (size_t i = 0; i < 3 * triangle_count; i++) {
      vec3_store(s.mesh.positions + 3 * i, vec3_scale(scree_rng_direction(&rng), 2));
      s.mesh.triangles[i] = (uint32_t)i;
    }
    /* facets settled here and there, or all on one side */
    for (size_t t = 0; t < triangle_count; t++)
      settled[t] = n % 2 ? scree_rng_below(&rng, 10) > 0 : s.mesh.positions[9 * t] > 0.1 * n - 2;
    CHECK_OK(scree_facet_tree_build(&s.mesh, &tree, &error), error);
    CHECK_OK(scree_facet_meetings(&tree, SIZE_MAX, NULL, &all, &error), error);
    CHECK_OK(scree_facet_meetings_new(&tree, settled, SIZE_MAX, NULL, &found, &error), error);
    for (size_t i = 0; i < all.count; i++) {
      bool known = settled[all.items[i].first] && settled[all.items[i].second];
      out += known;
      if (known) continue;
      assert_true(next < found.count);
      assert_memory_equal(&found.items[next], &all.items[i], sizeof *all.items);
      next++;
    }
    assert_int_equal(next, found.count);
    left += next;
    CHECK_OK(scree_mesh_meetings(&s.mesh, settled, SIZE_MAX, NULL, &near, &error), error);
    assert_int_equal(next, near.count);
    if (next) assert_memory_equal(near.items, found.items, next * sizeof *near.items);
    scree_free(all.items);
    scree_free(found.items);
    scree_free(near.items);
    scree_facet_tree_free(&tree);
    free_soup(&s);
  }
  assert_true(left > 10000 && out > 10000);
}

/* Facets are dropped, moved and added from search to search: what is known of the others gives what
 * a search of all gives. */
static void searched_again(void **state) {
  (void)state;
  scree_rng rng = {.seed = 33};
  size_t settled_count = 0, found_count = 0;
  for (int n = 0; n < 20; n++) {
    size_t count = 400;
    double *corners = scree_alloc(9 * count, sizeof *corners);
    scree_searched searched = {.met = NULL};
    for (size_t t = 0; t < count; t++) {
      vec3 at = vec3_scale(scree_rng_direction(&rng), n % 2 ? 2 : 12);
      for (size_t k = 0; k < 3; k++)
        vec3_store(corners + 9 * t + 3 * k, vec3_add(at, scree_rng_direction(&rng)));
    }
    for (int round = 0; round < 6; round++) {
      scree_mesh mesh;
      scree_meetings all, found;
      scree_error error;
      bool settled[400], known;
      CHECK_OK(scree_mesh_weld(corners, count, 0, &mesh, NULL, &error), error);
      CHECK_OK(scree_searched_settled(&searched, &mesh, settled, &known, &error), error);
      assert_int_equal(known, round > 0);
      if (known)
        for (size_t t = 0; t < mesh.triangle_count; t++) settled_count += settled[t];
      CHECK_OK(scree_mesh_meetings(&mesh, NULL, SIZE_MAX, NULL, &all, &error), error);
      CHECK_OK(scree_searched_meetings(&searched, &mesh, NULL, SIZE_MAX, NULL, &found, &error),
               error);
      assert_int_equal(all.count, found.count);
      if (all.count) assert_memory_equal(all.items, found.items, all.count * sizeof *all.items);
      found_count += all.count;
      scree_free(all.items);
      scree_free(found.items);
      scree_mesh_free(&mesh);
      count -= 10;
      for (int i = 0; i < 5; i++)
        vec3_store(corners + 9 * scree_rng_below(&rng, count), scree_rng_direction(&rng));
    }
    scree_searched_free(&searched);
    scree_free(corners);
  }
  assert_true(settled_count > 10000 && found_count > 10000);
}

/* A slanted, twisted tube of long slivers with fans for caps, and one spike through it. */
static soup tube(uint32_t sides, double twist, double length) {
  soup s = make_soup(2 * (size_t)sides + 2, 4 * (size_t)sides);
  vec3 axis = vec3_unit((vec3){1, 0.7, 0.4}), u = vec3_unit(vec3_cross(axis, (vec3){0, 0, 1}));
  vec3 v = vec3_cross(axis, u);
  for (uint32_t i = 0; i < 2 * sides; i++) {
    double angle = 6.283185307179586 * (i % sides + (i < sides ? 0 : twist)) / sides;
    vec3 p = vec3_mad(vec3_scale(u, cos(angle)), v, sin(angle));
    vec3_store(s.mesh.positions + 3 * (size_t)i, vec3_mad(p, axis, i < sides ? 0 : length));
  }
  vec3_store(s.mesh.positions + 6 * (size_t)sides + 3, vec3_scale(axis, length));
  uint32_t *t = s.mesh.triangles;
  for (uint32_t i = 0; i < sides; i++) {
    uint32_t j = (i + 1) % sides;
    uint32_t faces[12] = {i, j, sides + i, j,         sides + j, sides + i,
                          j, i, 2 * sides, sides + i, sides + j, 2 * sides + 1};
    memcpy(t + 12 * (size_t)i, faces, sizeof faces);
  }
  return s;
}

static void slivers(void **state) {
  (void)state;
  size_t clean = 0, spiked = 0, through = 0;
  for (uint32_t sides = 3; sides < 100; sides = sides * 3 / 2 + 1) {
    soup s = tube(sides, 0.3, 50);
    compare_with_all_pairs(&s.mesh, &clean);
    /* the far cap's hub pulled beyond the near cap: its fan passes through the near one */
    s.mesh.positions[6 * (size_t)sides + 3] = -10;
    compare_with_all_pairs(&s.mesh, &spiked);
    free_soup(&s);
    s = tube(sides, 0.45 * sides, 5); /* sides that pass through the axis, nearly */
    compare_with_all_pairs(&s.mesh, &through);
    free_soup(&s);
  }
  assert_int_equal(clean, 0);
  assert_true(spiked > 100);
}

static void limit_and_threads(void **state) {
  (void)state;
  scree_error error;
  scree_meetings found, again;
  soup s = tube(300, 0.45 * 300, 5);
  s.mesh.positions[6 * 300 + 3] = -10;
  CHECK_OK(scree_mesh_meetings(&s.mesh, NULL, SIZE_MAX, NULL, &found, &error), error);
  assert_true(found.count > 10 && !found.truncated);
  scree_set_threads(1);
  CHECK_OK(scree_mesh_meetings(&s.mesh, NULL, SIZE_MAX, NULL, &again, &error), error);
  scree_set_threads(0);
  assert_int_equal(found.count, again.count);
  assert_memory_equal(found.items, again.items, found.count * sizeof *found.items);
  scree_free(again.items);
  CHECK_OK(scree_mesh_meetings(&s.mesh, NULL, found.count, NULL, &again, &error), error);
  assert_false(again.truncated);
  scree_free(again.items);
  CHECK_OK(scree_mesh_meetings(&s.mesh, NULL, found.count - 1, NULL, &again, &error), error);
  assert_true(again.truncated && again.count == found.count - 1 && !again.items);
  scree_free(found.items);
  free_soup(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(soups), cmocka_unit_test(unsettled),
                                     cmocka_unit_test(searched_again), cmocka_unit_test(slivers),
                                     cmocka_unit_test(limit_and_threads)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
