#include "pile/fill.h"

#include "base/alloc.h"
#include "base/rng.h"
#include "support/check.h"

enum { MOST = 64 };

/* Whether everything placed is inside the cylinder and apart from all else. */
static void check_layer(const scree_fill_layer *layer, const scree_placement *placed,
                        size_t count) {
  for (size_t i = 0; i < count; i++) {
    const scree_placement *p = &placed[i];
    assert_true(hypot(p->position.x, p->position.y) + p->radius <= layer->cylinder_radius);
    assert_true(p->position.z - p->radius >= layer->bottom - 1e-12);
    CHECK_NEAR(p->orientation.w * p->orientation.w + p->orientation.x * p->orientation.x +
                   p->orientation.y * p->orientation.y + p->orientation.z * p->orientation.z,
               1, 1e-12);
    for (size_t j = 0; j < i; j++)
      assert_true(vec3_distance(p->position, placed[j].position) >= p->radius + placed[j].radius);
    for (size_t j = 0; j < layer->present_count; j++)
      assert_true(vec3_distance(p->position, layer->present[j].position) >=
                  p->radius + layer->present[j].radius);
  }
}

static void fillings_never_overlap(void **state) {
  (void)state;
  size_t placed_in_all = 0;
  for (uint64_t seed = 0; seed < 5000; seed++) {
    scree_rng rng = {.seed = seed, .stream = 99};
    scree_placement placements[MOST], present[MOST];
    size_t present_count = scree_rng_below(&rng, MOST);
    for (int i = 0; i < MOST; i++) {
      placements[i].radius = 0.01 + 0.07 * scree_rng_uniform(&rng);
      present[i] = (scree_placement){vec3_scale(scree_rng_direction(&rng), 0.25),
                                     {1, 0, 0, 0},
                                     0.01 + 0.05 * scree_rng_uniform(&rng)};
    }
    scree_fill_layer layer = {seed, seed % 7, 0.2,          0.1 * scree_rng_uniform(&rng),
                              1e-4, present,  present_count};
    size_t count = scree_fill_place(&layer, placements, MOST);
    check_layer(&layer, placements, count);
    placed_in_all += count;
    /* the same again, whatever was there before */
    scree_placement again[MOST];
    for (int i = 0; i < MOST; i++) again[i] = (scree_placement){.radius = placements[i].radius};
    assert_int_equal(scree_fill_place(&layer, again, MOST), count);
    for (size_t i = 0; i < count; i++)
      assert_memory_equal(&again[i].position, &placements[i].position, sizeof again[i].position);
  }
  assert_true(placed_in_all > 5000);
}

static void particles_wider_than_the_cylinder_are_not_placed(void **state) {
  (void)state;
  scree_placement p[2] = {{.radius = 0.05}, {.radius = 0.11}};
  scree_fill_layer layer = {1, 0, 0.1, 0, 0, NULL, 0};
  assert_int_equal(scree_fill_place(&layer, p, 2), 1);
}

static void shapes_come_in_equal_shares_and_shuffled(void **state) {
  (void)state;
  uint32_t order[1197], other[1197];
  size_t shares[9] = {0}, in_place = 0;
  scree_fill_order(3, 9, order, 1197);
  scree_fill_order(4, 9, other, 1197);
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
      cmocka_unit_test(fillings_never_overlap),
      cmocka_unit_test(particles_wider_than_the_cylinder_are_not_placed),
      cmocka_unit_test(shapes_come_in_equal_shares_and_shuffled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
