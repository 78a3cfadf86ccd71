/* The witnesses of the stray, carried through batches, against the level as it is; what thinning
 * leaves. */
#include "simplify/decimate.h"
#include "support/check.h"
#include "support/shapes.h"

static double distance_from(const scree_halfmesh *s, uint32_t triangle, vec3 p) {
  vec3 at[3], point;
  double corners[9];
  scree_corners(s, triangle, at);
  for (int i = 0; i < 3; i++) vec3_store(corners + 3 * i, at[i]);
  return sqrt(scree_triangle_closest(corners, p, &point));
}

/* Every witness once, with a triangle that is there, at the distance it says, which is not less
 * than that from the whole level; returns their mean distance and the largest. */
static void check_witnesses(const scree_decimator *d, double *mean, double *worst) {
  const scree_halfmesh *s = &d->s;
  const scree_memory *m = &d->memory;
  scree_memory now;
  scree_error error;
  size_t seen = 0;
  bool *found = calloc(m->count, sizeof *found);
  CHECK_OK(scree_memory_keep(s, &now, &error), error); /* the level, as a tree */
  *mean = *worst = 0;
  for (uint32_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next, seen++) {
      const scree_witness *w = &m->witnesses[j];
      double distance = sqrt(w->distance2);
      scree_bvh_hit hit = {.distance2 = INFINITY};
      assert_false(found[j]);
      found[j] = true;
      CHECK_NEAR(distance_from(s, t, w->at), distance, 1e-15);
      assert_true(scree_bvh_closest(&now.surface, w->at, &hit));
      assert_true(sqrt(hit.distance2) <= distance + 1e-15);
      *mean += distance / (double)m->left;
      *worst = fmax(*worst, distance);
    }
  }
  assert_int_equal(seen, m->left);
  free(found);
  scree_memory_free(&now);
}

static void witnesses_go_with_the_batches(void **state) {
  (void)state;
  scree_rng rng = {.seed = 31};
  scree_error error;
  double mean, worst;
  scree_mesh mesh = shape_icosphere(0.03, 6); /* 81,920 triangles */
  shape_shake(&mesh, 1e-4, &rng);
  scree_decimator d = {.coster = &scree_volume_coster,
                       .options = scree_default_simplify_options(),
                       .error_limit = INFINITY,
                       .first_triangle_count = mesh.triangle_count,
                       .error = &error};
  CHECK_OK(scree_halfmesh_build(&mesh, &d.s, &error), error);
  CHECK_OK(scree_record_allocate(&d.record, mesh.vertex_count, &error), error);
  for (uint32_t v = 0; v < d.s.vertex_count; v++) d.coster->sum(&d.s, v);
  CHECK_OK(scree_decimate_in_batches(&d), error);
  assert_true(d.s.live_triangle_count <= SCREE_GREEDY_COUNT);
  assert_int_equal(d.memory.left, mesh.vertex_count);
  check_witnesses(&d, &mean, &worst);
  CHECK_NEAR(scree_memory_usual(&d.memory), fmax(10 * mean, worst), 1e-9 * worst);
  scree_decimator_free(&d);
  scree_mesh_free(&mesh);
}

/* All witnesses at one triangle: in the order of their distances, those of even rank stay. */
static void every_second_goes(void **state) {
  (void)state;
  scree_rng rng = {.seed = 32};
  scree_error error;
  scree_memory m;
  scree_halfmesh s;
  scree_mesh mesh = shape_icosphere(1, 3);
  CHECK_OK(scree_halfmesh_build(&mesh, &s, &error), error);
  CHECK_OK(scree_memory_keep(&s, &m, &error), error);
  double all[642], sum = 0;
  assert_int_equal(m.count, 642);
  memset(m.first, 0xff, s.triangle_count * sizeof *m.first);
  for (uint32_t j = 0; j < 642; j++) {
    all[j] = m.witnesses[j].distance2 = scree_rng_uniform(&rng) + 1e-3;
    m.witnesses[j].next = m.first[0];
    m.first[0] = j;
  }
  scree_memory_thin(&m, &s); /* 1,280 triangles: not crowded */
  assert_int_equal(m.left, 642);
  s.live_triangle_count = 20;
  scree_memory_thin(&m, &s); /* 642 above 480, 321 not */
  assert_int_equal(m.left, 321);
  double before = INFINITY;
  size_t count = 0;
  for (uint32_t j = m.first[0]; j != SCREE_NONE; j = m.witnesses[j].next, count++) {
    double distance2 = m.witnesses[j].distance2;
    size_t rank = 0;
    for (size_t k = 0; k < 642; k++) rank += all[k] > distance2;
    assert_int_equal(rank, 2 * count);
    assert_true(distance2 <= before);
    before = distance2;
    sum += sqrt(distance2);
  }
  assert_int_equal(count, 321);
  CHECK_NEAR(scree_memory_usual(&m), 10 * sum / 321, 1e-12);
  s.live_triangle_count = 1280;
  scree_memory_free(&m);
  scree_halfmesh_free(&s);
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(witnesses_go_with_the_batches),
                                     cmocka_unit_test(every_second_goes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
