/* Convex pieces, and the signed distances of the same bodies, against closed forms. */
#include "base/vec.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

#include <string.h>

/* An L of three unit cubes, one high: 2 x 2 less its upper right quarter. */
static scree_mesh l_shape(void) {
  static const double outline[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  static const uint32_t floor[4][3] = {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}};
  scree_mesh m = shape_make(12, 20);
  for (uint32_t v = 0; v < 12; v++) {
    m.positions[3 * v] = outline[v % 6][0];
    m.positions[3 * v + 1] = outline[v % 6][1];
    m.positions[3 * v + 2] = v / 6;
  }
  size_t c = 0;
  for (int t = 0; t < 4; t++)
    for (int k = 0; k < 3; k++) m.triangles[c++] = floor[t][2 - k];
  for (int t = 0; t < 4; t++)
    for (int k = 0; k < 3; k++) m.triangles[c++] = floor[t][k] + 6;
  for (uint32_t v = 0; v < 6; v++) {
    uint32_t next = (v + 1) % 6, sides[] = {v, next, next + 6, v, next + 6, v + 6};
    memcpy(m.triangles + c, sides, sizeof sides);
    c += 6;
  }
  return m;
}

/* No corner of a piece lies before one of its facets, but by rounding, which turns the normals of
 * slivers; and all volumes are the sum's. */
static void check_pieces(const scree_convex *c, double volume) {
  double sum = 0;
  scree_error error;
  for (size_t p = 0; p < c->piece_count; p++) {
    const scree_mesh *m = &c->pieces[p];
    double one;
    CHECK_OK(scree_mesh_area_volume(m, NULL, &one, &error), error);
    sum += one;
    for (size_t t = 0; t < m->triangle_count; t++) {
      vec3 at[3];
      for (int k = 0; k < 3; k++) at[k] = vec3_load(m->positions + 3 * m->triangles[3 * t + k]);
      vec3 normal = vec3_triangle_normal(at[0], at[1], at[2]);
      for (size_t v = 0; v < m->vertex_count; v++)
        assert_true(vec3_dot(normal, vec3_sub(vec3_load(m->positions + 3 * v), at[0])) <=
                    1e-9 * vec3_norm(normal) + 1e-15);
    }
  }
  CHECK_NEAR(sum / volume - 1, c->volume_error, 1e-9);
  assert_true(c->volume_error > -1e-9);
}

static void an_l_is_two_boxes(void **state) {
  (void)state;
  scree_mesh l = l_shape();
  scree_convex_options o = scree_default_convex_options();
  scree_convex c;
  scree_error error;
  /* the plane is put beside the vertices in it, by less than a ten-thousandth of the size */
  o.tolerance = 1e-4;
  CHECK_OK(scree_mesh_convex(&l, &o, NULL, &c, &error), error);
  assert_int_equal(c.piece_count, 2);
  assert_true(c.within);
  check_pieces(&c, 3);
  scree_convex_free(&c);
  /* the hull has half a cube more */
  o.most = 1;
  CHECK_OK(scree_mesh_convex(&l, &o, NULL, &c, &error), error);
  assert_int_equal(c.piece_count, 1);
  assert_false(c.within);
  CHECK_NEAR(c.volume_error, 0.5 / 3, 1e-12);
  scree_convex_free(&c);
  scree_mesh_free(&l);
}

static void what_is_convex_stays_whole(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(1, 2);
  scree_convex c;
  scree_error error;
  CHECK_OK(scree_mesh_convex(&ball, NULL, NULL, &c, &error), error);
  assert_int_equal(c.piece_count, 1);
  CHECK_NEAR(c.volume_error, 0, 1e-9);
  CHECK_NEAR(c.inertia_error, 0, 1e-9);
  scree_convex_free(&c);
  scree_mesh_free(&ball);
}

static void a_ring_comes_within_its_tolerance(void **state) {
  (void)state;
  scree_mesh ring = shape_torus(3, 1, 24, 12);
  scree_convex_options o = scree_default_convex_options();
  scree_convex few, many;
  double volume;
  scree_error error;
  CHECK_OK(scree_mesh_area_volume(&ring, NULL, &volume, &error), error);
  o.tolerance = 0.1;
  CHECK_OK(scree_mesh_convex(&ring, &o, NULL, &few, &error), error);
  o.tolerance = 0.05;
  CHECK_OK(scree_mesh_convex(&ring, &o, NULL, &many, &error), error);
  assert_true(few.within && many.within);
  assert_true(fmax(few.volume_error, few.inertia_error) <= 0.1);
  assert_true(fmax(many.volume_error, many.inertia_error) <= 0.05);
  assert_true(few.piece_count > 3 && few.piece_count < many.piece_count);
  check_pieces(&few, volume);
  check_pieces(&many, volume);
  scree_convex_free(&few);
  scree_convex_free(&many);
  scree_mesh_free(&ring);
}

static scree_status convex_of(void *context, scree_error *error) {
  scree_convex c = {.pieces = NULL};
  scree_status status = scree_mesh_convex(context, NULL, NULL, &c, error);
  scree_convex_free(&c);
  return status;
}

static void what_is_wrong_is_told(void **state) {
  (void)state;
  scree_mesh l = l_shape();
  scree_convex_options o = scree_default_convex_options();
  scree_convex c;
  scree_error error;
  check_allocation_failures(convex_of, &l);
  o.most = 0;
  assert_int_equal(scree_mesh_convex(&l, &o, NULL, &c, &error), SCREE_BAD_ARGUMENT);
  l.triangle_count--;
  assert_int_equal(scree_mesh_convex(&l, NULL, NULL, &c, &error), SCREE_BAD_MESH);
  scree_mesh_free(&l);
}

/* Of the L by hand, and of a box all over: the larger of |x| - half, outside by its corner. */
static void distances_have_their_sign(void **state) {
  (void)state;
  static const double points[] = {0.5, 0.5, 0.5, 1.5, 1.5, 0.5, 0.9, 1.8, 0.5, 3, 0.5, 0.5};
  static const double wanted[] = {-0.5, 0.5, -0.1, 1};
  scree_mesh l = l_shape(), box = shape_box(2, 2, 2);
  scree_surface *surface;
  scree_error error;
  double found[4];
  CHECK_OK(scree_surface_create(&l, &surface, &error), error);
  scree_surface_signed_distances(surface, points, 4, found);
  for (int i = 0; i < 4; i++) CHECK_NEAR(found[i], wanted[i], 1e-12);
  scree_surface_free(surface);
  CHECK_OK(scree_surface_create(&box, &surface, &error), error);
  for (int i = 0; i < 9 * 9 * 9; i++) {
    double p[3] = {0.36 * (i % 9) - 0.45, 0.36 * (i / 9 % 9) - 0.45, 0.36 * (i / 81) - 0.45};
    vec3 q = {fabs(p[0] - 1) - 1, fabs(p[1] - 1) - 1, fabs(p[2] - 1) - 1};
    double most = fmax(q.x, fmax(q.y, q.z)), distance;
    vec3 out = {fmax(q.x, 0), fmax(q.y, 0), fmax(q.z, 0)};
    scree_surface_signed_distances(surface, p, 1, &distance);
    CHECK_NEAR(distance, most > 0 ? vec3_norm(out) : most, 1e-12);
  }
  scree_surface_free(surface);
  scree_mesh_free(&box);
  scree_mesh_free(&l);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_l_is_two_boxes),
      cmocka_unit_test(what_is_convex_stays_whole),
      cmocka_unit_test(a_ring_comes_within_its_tolerance),
      cmocka_unit_test(what_is_wrong_is_told),
      cmocka_unit_test(distances_have_their_sign),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
