/* The quick proof that a surface nowhere meets itself, against the search for all meetings. */
#include "mesh/index/apart.h"

#include "base/alloc.h"

#include "mesh/index/intersect.h"
#include "support/check.h"
#include "support/shapes.h"

static size_t count_meetings(const scree_mesh *mesh) {
  scree_meetings found;
  scree_error error;
  CHECK_OK(scree_mesh_meetings(mesh, NULL, 1000000, NULL, &found, &error), error);
  scree_free(found.items);
  return found.count;
}

static bool proven_with(const scree_mesh *mesh, const scree_adjacency *adjacency) {
  bool apart;
  scree_error error;
  CHECK_OK(scree_facets_apart(mesh, adjacency, &apart, &error), error);
  return apart;
}

/* With the fans, where they are whole, and without: the same. */
static bool proven(const scree_mesh *mesh) {
  scree_adjacency adjacency;
  scree_topology topology;
  scree_error error;
  bool without = proven_with(mesh, NULL);
  CHECK_OK(scree_adjacency_build(mesh, &adjacency, &error), error);
  CHECK_OK(scree_mesh_topology(mesh, &topology, &error), error);
  if (!topology.non_manifold_vertex_count && !topology.degenerate_facet_count)
    assert_int_equal(proven_with(mesh, &adjacency), without);
  scree_adjacency_free(&adjacency);
  return without;
}

/* What is proven is so, and what a scan looks like is proven. */
static void clean_surfaces_are_proven(void **state) {
  (void)state;
  scree_rng rng = {.seed = 4};
  scree_mesh sphere = shape_icosphere(0.02, 4), box = shape_grid_box(0.1, 0.05, 0.02, 20),
             torus = shape_torus(0.03, 0.01, 80, 40);
  assert_true(proven(&sphere));
  assert_true(proven(&box)); /* coplanar neighbours: rounding could deceive, exact tests decide */
  assert_true(proven(&torus));
  for (int i = 0; i < 8; i++) {
    mat3 turned = quat_to_mat3(scree_rng_rotation(&rng));
    shape_transform(&box, &turned, (vec3){0.01, 0.02, 0.03});
    assert_true(proven(&box));
  }
  shape_shake(&sphere, 1e-4, &rng);
  assert_int_equal(count_meetings(&sphere), 0);
  assert_true(proven(&sphere));
  scree_mesh_free(&sphere);
  scree_mesh_free(&box);
  scree_mesh_free(&torus);
}

static void proof_and_search_agree(void **state) {
  (void)state;
  scree_rng rng = {.seed = 5};
  size_t clean = 0, meeting = 0;
  for (int round = 0; round < 120; round++) {
    scree_mesh mesh = shape_icosphere(0.02, 3);
    shape_shake(&mesh, 4e-5 * (round + 1), &rng); /* from smooth to crumpled */
    if (round % 3 == 0) { /* a second shell that touches, crosses or stays apart */
      scree_mesh other = shape_icosphere(0.02, 3);
      shape_move(&other, (vec3){0.04 + 1e-4 * (round % 7 - 3), 0, 0});
      scree_mesh both = shape_join(&mesh, &other);
      scree_mesh_free(&mesh);
      scree_mesh_free(&other);
      mesh = both;
    }
    bool meets = count_meetings(&mesh) > 0;
    assert_int_equal(proven(&mesh), !meets);
    clean += !meets;
    meeting += meets;
    scree_mesh_free(&mesh);
  }
  assert_true(clean >= 10 && meeting >= 10);
}

/* An open fan that goes round its vertex twice, all facets facing up: seen along the axis each
 * turns one way, but the sectors lie on each other, and two of them cross. */
static void a_fan_that_winds_twice_is_not_proven(void **state) {
  (void)state;
  enum { SPOKES = 11 };
  scree_mesh mesh = shape_make(SPOKES + 1, SPOKES);
  vec3_store(mesh.positions, (vec3){0, 0, 1});
  for (uint32_t i = 0; i < SPOKES; i++) {
    double angle = 4 * acos(-1) * i / SPOKES;
    uint32_t corner[3] = {0, 1 + i, 1 + (i + 1) % SPOKES};
    vec3_store(mesh.positions + 3 * (size_t)corner[1],
               (vec3){cos(angle), sin(angle), 0.3 * sin(angle / 2)});
    memcpy(mesh.triangles + 3 * (size_t)i, corner, sizeof corner);
  }
  assert_true(count_meetings(&mesh) > 0);
  assert_false(proven(&mesh));
  scree_mesh_free(&mesh);
}

/* Where a grid is no good nothing is claimed; nothing crashes. */
static void unfit_surfaces_are_not_proven(void **state) {
  (void)state;
  scree_mesh fine = shape_icosphere(1e-6, 3), coarse = shape_icosphere(1, 0);
  shape_move(&fine, (vec3){5, 0, 0});
  scree_mesh both = shape_join(&fine, &coarse), empty = {0};
  assert_false(proven(&both));
  assert_false(proven(&empty));
  scree_mesh_free(&fine);
  scree_mesh_free(&coarse);
  scree_mesh_free(&both);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(clean_surfaces_are_proven),
                                     cmocka_unit_test(proof_and_search_agree),
                                     cmocka_unit_test(a_fan_that_winds_twice_is_not_proven),
                                     cmocka_unit_test(unfit_surfaces_are_not_proven)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
