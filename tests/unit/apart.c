/* The quick proof that a surface nowhere meets itself, against the search for all meetings. */
#include "mesh/apart.h"

#include "base/alloc.h"

#include "mesh/intersect.h"
#include "support/check.h"
#include "support/shapes.h"

static size_t count_meetings(const scree_mesh *mesh) {
  scree_meetings found;
  scree_error error;
  CHECK_OK(scree_mesh_meetings(mesh, 1000000, NULL, &found, &error), error);
  scree_free(found.items);
  return found.count;
}

static bool proven(const scree_mesh *mesh) {
  bool apart;
  scree_error error;
  CHECK_OK(scree_facets_apart(mesh, &apart, &error), error);
  return apart;
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
                                     cmocka_unit_test(unfit_surfaces_are_not_proven)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
