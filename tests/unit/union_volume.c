/* The volume of unions: boxes on an integer grid, whose faces lie on each other, touch and cross,
 * against counting the grid's cells; the same turned in space; the same cut finer; spheres against
 * the closed form. */
#include "base/vec.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

enum { SIDE = 6, MOST_BOXES = 6 };

typedef struct block {
  int low[3], high[3];
  bool inward;
} block;

static block random_block(scree_rng *rng) {
  block b = {.inward = scree_rng_below(rng, 6) == 0};
  for (int k = 0; k < 3; k++) {
    int a = (int)scree_rng_below(rng, SIDE), c = (int)scree_rng_below(rng, SIDE);
    b.low[k] = a < c ? a : c;
    b.high[k] = (a < c ? c : a) + 1;
  }
  return b;
}

static scree_mesh mesh_of(const block *b, size_t cuts) {
  double size[3];
  for (int k = 0; k < 3; k++) size[k] = b->high[k] - b->low[k];
  scree_mesh mesh = shape_grid_box(size[0], size[1], size[2], cuts);
  shape_move(&mesh, (vec3){b->low[0], b->low[1], b->low[2]});
  for (size_t t = 0; b->inward && t < mesh.triangle_count; t++) shape_flip(&mesh, t);
  return mesh;
}

static scree_mesh join(const block *blocks, size_t count, scree_rng *rng) {
  scree_mesh all = mesh_of(&blocks[0], 1);
  for (size_t i = 1; i < count; i++) {
    scree_mesh next = mesh_of(&blocks[i], 1 + scree_rng_below(rng, 2)),
               both = shape_join(&all, &next);
    scree_mesh_free(&all);
    scree_mesh_free(&next);
    all = both;
  }
  return all;
}

/* Cells where the winding number is positive; *least is the least winding number. */
static size_t count_cells(const block *blocks, size_t count, int *least) {
  size_t filled = 0;
  *least = 0;
  for (int x = 0; x < SIDE; x++)
    for (int y = 0; y < SIDE; y++)
      for (int z = 0; z < SIDE; z++) {
        int winding = 0;
        for (size_t i = 0; i < count; i++) {
          const block *b = &blocks[i];
          bool inside = x >= b->low[0] && x < b->high[0] && y >= b->low[1] && y < b->high[1] &&
                        z >= b->low[2] && z < b->high[2];
          winding += inside ? (b->inward ? -1 : 1) : 0;
        }
        filled += winding > 0;
        if (winding < *least) *least = winding;
      }
  return filled;
}

static void check_volume(const scree_mesh *mesh, double expected, int least) {
  scree_check check;
  scree_error error;
  CHECK_OK(scree_mesh_check(mesh, NULL, NULL, &check, &error), error);
  if (least < 0) assert_false(check.volume_known);
  if (!check.volume_known) return;
  CHECK_NEAR(check.volume, expected, 1e-11 * (expected + 1));
}

static void boxes_on_a_grid(void **state) {
  (void)state;
  scree_rng rng = {.seed = 21};
  size_t sound = 0;
  for (int round = 0; round < 1500; round++) {
    block blocks[MOST_BOXES];
    size_t count = 2 + scree_rng_below(&rng, MOST_BOXES - 1);
    int least;
    for (size_t i = 0; i < count; i++) blocks[i] = random_block(&rng);
    double expected = (double)count_cells(blocks, count, &least);
    scree_mesh mesh = join(blocks, count, &rng);
    check_volume(&mesh, expected, least);
    if (round % 3 == 0) {
      mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
      shape_transform(&mesh, &turn, (vec3){0.1, -20, 3});
      check_volume(&mesh, expected, least);
    }
    scree_mesh_free(&mesh);
    sound += least == 0;
  }
  assert_true(sound > 300);
}

/* None is inside out and none is a cavity, so the volume is always known. */
static void outward_boxes_have_a_volume(void **state) {
  (void)state;
  scree_rng rng = {.seed = 22};
  for (int round = 0; round < 300; round++) {
    block blocks[MOST_BOXES];
    scree_check check;
    scree_error error;
    int least;
    for (size_t i = 0; i < MOST_BOXES; i++) {
      blocks[i] = random_block(&rng);
      blocks[i].inward = false;
    }
    scree_mesh mesh = join(blocks, MOST_BOXES, &rng);
    CHECK_OK(scree_mesh_check(&mesh, NULL, NULL, &check, &error), error);
    assert_true(check.volume_known);
    CHECK_NEAR(check.volume, (double)count_cells(blocks, MOST_BOXES, &least), 1e-9);
    scree_mesh_free(&mesh);
  }
}

/* Two balls at a distance: the lens that they share is counted once. As polyhedra converge with the
 * square of their edges, so does the difference from the closed form. */
static void two_balls(void **state) {
  (void)state;
  const double r = 1, d = 1.1, lens = acos(-1) * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12;
  double before = 0;
  for (int level = 2; level < 6; level++) {
    scree_mesh a = shape_icosphere(r, level), b = shape_icosphere(r, level);
    shape_move(&b, (vec3){d * 0.6, d * 0.64, d * 0.48});
    scree_mesh both = shape_join(&a, &b);
    scree_check check;
    scree_error error;
    CHECK_OK(scree_mesh_check(&both, NULL, NULL, &check, &error), error);
    assert_true(check.volume_known && !check.usable);
    double wrong = fabs(check.volume - (8 * acos(-1) / 3 - lens));
    if (level > 2) assert_true(wrong < 0.3 * before);
    before = wrong;
    scree_mesh_free(&a);
    scree_mesh_free(&b);
    scree_mesh_free(&both);
  }
}

static scree_status check_mesh(void *context, scree_error *error) {
  scree_check check;
  return scree_mesh_check(context, NULL, NULL, &check, error);
}

/* The same bits for any number of threads and any order of facets; memory may run out. */
static void is_repeatable(void **state) {
  (void)state;
  scree_mesh a = shape_icosphere(1, 3), b = shape_icosphere(1, 3);
  shape_move(&b, (vec3){0.5, 0.25, 0.125});
  scree_mesh both = shape_join(&a, &b);
  scree_check one, two;
  scree_error error;
  scree_set_threads(1);
  CHECK_OK(scree_mesh_check(&both, NULL, NULL, &one, &error), error);
  check_allocation_failures(check_mesh, &both);
  scree_set_threads(4);
  CHECK_OK(scree_mesh_check(&both, NULL, NULL, &two, &error), error);
  scree_set_threads(0);
  assert_true(one.volume_known && one.volume == two.volume);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
  scree_mesh_free(&both);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_on_a_grid),
      cmocka_unit_test(outward_boxes_have_a_volume),
      cmocka_unit_test(two_balls),
      cmocka_unit_test(is_repeatable),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
