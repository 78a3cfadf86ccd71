#include "scene/fill.h"

#include "base/alloc.h"
#include "base/rng.h"
#include "support/check.h"

enum { MOST = 48 };

static double between(scree_rng *rng, double low, double high) {
  return low + (high - low) * scree_rng_uniform(rng);
}

/* ---- boxes ---- */

static scree_oriented_box random_box(scree_rng *rng, double spread) {
  quat q = scree_rng_rotation(rng);
  if (scree_rng_below(rng, 4) == 0) q = (quat){1, 0, 0, 0}; /* parallel ones are common in heaps */
  return (scree_oriented_box){
      {between(rng, -spread, spread), between(rng, -spread, spread), between(rng, -spread, spread)},
      {between(rng, 0.01, 1), between(rng, 0.01, 1), between(rng, 0.01, 1)},
      quat_to_mat3(q)};
}

static double clamp(double x, double limit) {
  return x > limit ? limit : x < -limit ? -limit : x;
}

static vec3 nearest_in(const scree_oriented_box *box, vec3 p) {
  vec3 local = mat3_tmul_vec(&box->axes, vec3_sub(p, box->centre));
  vec3 inside = {clamp(local.x, box->half.x), clamp(local.y, box->half.y),
                 clamp(local.z, box->half.z)};
  return vec3_add(box->centre, mat3_mul_vec(&box->axes, inside));
}

/* Points of the boxes nearest to each other, by projecting to and fro until nothing moves; slow
 * where the boxes nearly touch. */
static void slow_nearest(const scree_oriented_box *a, const scree_oriented_box *b, vec3 *p,
                         vec3 *q) {
  *p = a->centre;
  *q = nearest_in(b, *p);
  for (int round = 0; round < 2000; round++) {
    vec3 next = nearest_in(a, *q);
    if (round > 10 && vec3_distance(next, *p) < 1e-13) break;
    *p = next;
    *q = nearest_in(b, *p);
  }
}

/* How far the box reaches along a direction. */
static double reach(const scree_oriented_box *box, vec3 d) {
  vec3 local = mat3_tmul_vec(&box->axes, d);
  return vec3_dot(box->centre, d) + fabs(local.x) * box->half.x + fabs(local.y) * box->half.y +
         fabs(local.z) * box->half.z;
}

/* Whether the plane across the nearest points lies between the boxes: a proof. */
static bool proven_apart(const scree_oriented_box *a, const scree_oriented_box *b) {
  vec3 p, q;
  slow_nearest(a, b, &p, &q);
  vec3 d = vec3_sub(q, p);
  return vec3_norm(d) > 1e-12 && reach(a, d) + reach(b, vec3_neg(d)) < 0;
}

static bool proven_meeting(const scree_oriented_box *a, const scree_oriented_box *b) {
  vec3 p, q;
  slow_nearest(a, b, &p, &q);
  return vec3_distance(p, q) < 1e-12;
}

static void boxes_are_apart_where_the_oracle_says_so(void **state) {
  (void)state;
  scree_rng rng = {.seed = 5, .stream = 1};
  size_t apart_count = 0, meeting_count = 0, unsaid = 0;
  for (int i = 0; i < 10000; i++) {
    scree_oriented_box a = random_box(&rng, 1), b = random_box(&rng, 1);
    bool apart = scree_oriented_boxes_apart(&a, &b), is_apart = proven_apart(&a, &b);
    bool meets = !is_apart && proven_meeting(&a, &b);
    assert_int_equal(apart, scree_oriented_boxes_apart(&b, &a));
    if (is_apart) assert_true(apart);
    if (meets) assert_false(apart);
    apart_count += is_apart;
    meeting_count += meets;
    unsaid += !is_apart && !meets;
  }
  assert_true(apart_count > 1500 && meeting_count > 1500 && unsaid < 500);
}

/* ---- layers ---- */

/* Long boxes, off their centre, and spheres. */
static scree_placement random_particle(scree_rng *rng) {
  if (scree_rng_below(rng, 4) == 0) {
    double r = between(rng, 0.005, 0.04);
    return (scree_placement){.radius = r, .half = {r, r, r}};
  }
  scree_placement p = {
      .half = {between(rng, 0.02, 0.09), between(rng, 0.01, 0.04), between(rng, 0.002, 0.02)}};
  p.box_centre = (vec3){between(rng, -0.01, 0.01), between(rng, -0.005, 0.005), 0};
  p.radius = vec3_norm(vec3_add(p.half, (vec3){fabs(p.box_centre.x), fabs(p.box_centre.y), 0}));
  return p;
}

static bool is_sphere(const scree_placement *p) {
  return p->half.x == p->radius;
}

static void check_inside(const scree_fill_layer *layer, const scree_placement *p) {
  if (is_sphere(p)) {
    assert_true(hypot(p->position.x, p->position.y) + p->radius <= layer->cylinder_radius + 1e-12);
    assert_true(p->position.z - p->radius >= layer->bottom - 1e-12);
    assert_true(p->position.z + p->radius <= layer->bottom + layer->height + 1e-12);
    return;
  }
  for (int c = 0; c < 8; c++) {
    vec3 local = {p->box_centre.x + (c & 1 ? 1 : -1) * p->half.x,
                  p->box_centre.y + (c & 2 ? 1 : -1) * p->half.y,
                  p->box_centre.z + (c & 4 ? 1 : -1) * p->half.z};
    mat3 r = quat_to_mat3(p->orientation);
    vec3 corner = vec3_add(p->position, mat3_mul_vec(&r, local));
    assert_true(hypot(corner.x, corner.y) <= layer->cylinder_radius + 1e-12);
    assert_true(corner.z >= layer->bottom - 1e-12);
    assert_true(corner.z <= layer->bottom + layer->height + 1e-12);
  }
}

static void check_apart(const scree_placement *a, const scree_placement *b) {
  double spheres = vec3_distance(a->position, b->position) - a->radius - b->radius;
  if (spheres > 0) return;
  assert_false(is_sphere(a) && is_sphere(b));
  assert_false(proven_meeting(&a->box, &b->box));
}

static void check_layer(const scree_fill_layer *layer, const scree_placement *placed,
                        size_t count) {
  for (size_t i = 0; i < count; i++) {
    quat q = placed[i].orientation;
    CHECK_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1, 1e-12);
    check_inside(layer, &placed[i]);
    for (size_t j = 0; j < i; j++) check_apart(&placed[i], &placed[j]);
    for (size_t j = 0; j < layer->present_count; j++) check_apart(&placed[i], &layer->present[j]);
  }
}

static void fillings_never_overlap(void **state) {
  (void)state;
  size_t placed_in_all = 0;
  for (uint64_t seed = 0; seed < 3000; seed++) {
    scree_rng rng = {.seed = seed, .stream = 99};
    scree_placement placements[MOST], present[MOST], again[MOST];
    size_t count = 1 + scree_rng_below(&rng, MOST), present_count = scree_rng_below(&rng, 6);
    for (size_t i = 0; i < count; i++) placements[i] = again[i] = random_particle(&rng);
    for (size_t i = 0; i < present_count; i++) {
      present[i] = random_particle(&rng);
      present[i].position = vec3_scale(scree_rng_direction(&rng), 0.2);
      present[i].orientation = scree_rng_rotation(&rng);
      scree_placement_settle(&present[i]);
    }
    scree_fill_layer layer = {.seed = seed,
                              .layer_index = seed % 7,
                              .cylinder_radius = 0.2,
                              .bottom = between(&rng, 0, 0.1),
                              .height = 0.3,
                              .present = present,
                              .present_count = present_count};
    size_t placed = scree_fill_place(&layer, placements, count);
    check_layer(&layer, placements, placed);
    placed_in_all += placed;
    assert_int_equal(scree_fill_place(&layer, again, count), placed);
    for (size_t i = 0; i < placed; i++)
      assert_memory_equal(&again[i].position, &placements[i].position, sizeof again[i].position);
  }
  assert_true(placed_in_all > 30000);
}

/* 188 x 50 x 20 mm: by bounding spheres two would fit beside each other in 0.4 m. */
static void long_particles_fill_a_layer(void **state) {
  (void)state;
  scree_placement p[100];
  for (int i = 0; i < 100; i++)
    p[i] = (scree_placement){.radius = 0.0978, .half = {0.094, 0.025, 0.01}};
  scree_fill_layer layer = {.seed = 1, .cylinder_radius = 0.2, .height = 0.3};
  assert_true(scree_fill_place(&layer, p, 100) >= 20);
}

static void particles_too_large_are_not_placed(void **state) {
  (void)state;
  scree_placement p[2] = {{.radius = 0.05, .half = {0.05, 0.05, 0.05}},
                          {.radius = 0.11, .half = {0.11, 0.11, 0.11}}};
  scree_fill_layer layer = {.seed = 1, .cylinder_radius = 0.1, .height = 1};
  assert_int_equal(scree_fill_place(&layer, p, 2), 1);
}

static void shapes_come_in_equal_shares_and_shuffled(void **state) {
  (void)state;
  uint32_t order[1197], other[1197];
  size_t shares[9] = {0}, in_place = 0;
  scree_error error;
  CHECK_OK(scree_fill_order(3, NULL, 9, order, 1197, &error), error);
  CHECK_OK(scree_fill_order(4, NULL, 9, other, 1197, &error), error);
  for (size_t i = 0; i < 1197; i++) {
    shares[order[i]]++;
    in_place += order[i] == i % 9;
  }
  for (int i = 0; i < 9; i++) assert_int_equal(shares[i], 133);
  assert_true(in_place < 250);
  assert_memory_not_equal(order, other, sizeof order);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_are_apart_where_the_oracle_says_so),
      cmocka_unit_test(fillings_never_overlap),
      cmocka_unit_test(long_particles_fill_a_layer),
      cmocka_unit_test(particles_too_large_are_not_placed),
      cmocka_unit_test(shapes_come_in_equal_shares_and_shuffled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
