/* The tree of boxes over facets, by either split: what every node must hold, that the number of
 * threads leaves no trace, and that walks and searches miss nothing. The facet tree's second boxes;
 * that it finds what meets is tested with meetings.c. */
#include "support/check.h"
#include "support/shapes.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "mesh/index/facet_tree.h"

/* A disc of slivers round one vertex: second boxes and cones. */
static scree_mesh make_disc(uint32_t count) {
  scree_mesh m = shape_make(count + 1, count);
  vec3_store(m.positions, (vec3){0, 0, 0});
  for (uint32_t i = 0; i < count; i++) {
    double angle = 6.283185307179586 * i / count;
    vec3_store(m.positions + 3 * ((size_t)i + 1), (vec3){cos(angle), sin(angle), 0.3 * cos(angle)});
    m.triangles[3 * i] = 0;
    m.triangles[3 * i + 1] = i + 1;
    m.triangles[3 * i + 2] = (i + 1) % count + 1;
  }
  return m;
}

/* Most facets crowd in a corner, some at one place: cuts are lopsided, or there is no way to cut.
 */
static scree_mesh make_crowd(uint32_t count) {
  scree_rng rng = {.seed = 12};
  scree_mesh m = shape_make((size_t)3 * count, count);
  for (uint32_t i = 0; i < 3 * count; i++) {
    double size = i / 3 % 100 == 0 ? 1 : i % 2 ? 1e-6 : 1e-3;
    vec3 at = vec3_scale(scree_rng_direction(&rng), size);
    if (i / 3 % 7 == 0) at = (vec3){i % 3 == 0, i % 3 == 1, 0};
    vec3_store(m.positions + 3 * (size_t)i, at);
    m.triangles[i] = i;
  }
  return m;
}

static scree_tree build(const scree_mesh *mesh, uint32_t leaf, scree_tree_split split,
                        int threads) {
  const scree_boxed facets = {mesh->triangle_count, scree_box_of_facet, mesh, leaf, split};
  scree_tree tree;
  scree_error error;
  scree_set_threads(threads);
  CHECK_OK(scree_tree_build(&facets, &tree, &error), error);
  scree_set_threads(0);
  return tree;
}

/* Checks node `index` and all below it; its box, and how many items it has. */
static scree_box check_node(const scree_mesh *mesh, const scree_tree *t, uint32_t index, int depth,
                            uint32_t leaf, size_t *items) {
  const scree_tree_node *n = &t->nodes[index];
  scree_box b = scree_box_empty();
  assert_true(index < t->node_count && depth < SCREE_TREE_STACK);
  assert_true(n->count <= leaf);
  for (uint32_t i = 0; i < n->count; i++)
    b = scree_box_join(b, scree_facet_box(mesh, t->order[n->first + i]));
  *items = n->count;
  for (uint32_t side = 0; side < 2 && !n->count; side++) {
    size_t below;
    assert_true(n->first > index);
    b = scree_box_join(b, check_node(mesh, t, n->first + side, depth + 1, leaf, &below));
    *items += below;
  }
  assert_true(n->count > 0 || *items > leaf);
  assert_memory_equal(&n->box, &b, sizeof b);
  return b;
}

static void check_tree(const scree_mesh *mesh, const scree_tree *t, uint32_t leaf) {
  size_t facets = mesh->triangle_count, items;
  bool *seen = scree_alloc_zero(facets, sizeof *seen);
  for (size_t i = 0; i < facets; i++) {
    assert_true(t->order[i] < facets && !seen[t->order[i]]);
    seen[t->order[i]] = true;
  }
  scree_free(seen);
  check_node(mesh, t, 0, 0, leaf, &items);
  assert_int_equal(items, facets);
}

/* What boxes and points here and there find, against all facets one by one. */
static void check_walks(const scree_mesh *mesh, const scree_tree *t) {
  scree_rng rng = {.seed = 7};
  for (int k = 0; k < 20; k++) {
    vec3 p = vec3_scale(scree_rng_direction(&rng), 1.2 * scree_rng_uniform(&rng));
    scree_box around = scree_box_grown((scree_box){p, p}, 0.3 * scree_rng_uniform(&rng));
    double nearest = INFINITY, expected = INFINITY, reach2 = k % 2 ? 0.01 : INFINITY, passed2;
    size_t met = 0, expected_met = 0;
    for (size_t f = 0; f < mesh->triangle_count; f++) {
      scree_box box = scree_facet_box(mesh, f);
      expected_met += scree_box_meets(&box, &around);
      expected = fmin(expected, scree_box_distance2(&box, p));
    }
    scree_tree_walk walk;
    scree_tree_start(&walk, t);
    for (const scree_tree_node *n; (n = scree_tree_next(&walk));) {
      if (!scree_box_meets(&n->box, &around) || scree_tree_enter(&walk, n)) continue;
      for (uint32_t i = 0; i < n->count; i++) {
        scree_box box = scree_facet_box(mesh, t->order[n->first + i]);
        met += scree_box_meets(&box, &around);
      }
    }
    assert_int_equal(met, expected_met);
    scree_tree_search search;
    scree_tree_search_below(&search, t, 0, p);
    for (const scree_tree_node *n; (n = scree_tree_nearer(&search, fmin(nearest, reach2)));)
      for (uint32_t i = 0; i < n->count; i++) {
        scree_box box = scree_facet_box(mesh, t->order[n->first + i]);
        nearest = fmin(nearest, scree_box_distance2(&box, p));
      }
    passed2 = search.passed2;
    assert_true(expected <= reach2 ? nearest == expected : nearest > reach2);
    assert_true(passed2 >= fmin(nearest, reach2) && fmin(passed2, nearest) <= expected);
  }
}

static void check_same(const scree_tree *a, const scree_tree *b) {
  assert_int_equal(a->node_count, b->node_count);
  assert_memory_equal(a->nodes, b->nodes, a->node_count * sizeof *a->nodes);
  assert_memory_equal(a->order, b->order, a->item_count * sizeof *a->order);
}

/* Sizes about those of a part, and with many parts. */
static void test_structure(void **state) {
  (void)state;
  scree_mesh meshes[] = {shape_icosphere(1, 0), shape_icosphere(1, 4), shape_icosphere(2, 6),
                         make_disc(63),         make_disc(64),         make_disc(65),
                         make_disc(30000),      make_crowd(5000),      make_crowd(60000)};
  for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++)
    for (uint32_t leaf = 2; leaf < 6; leaf++) {
      scree_tree_split split = leaf % 2 ? SCREE_SPLIT_AREA : SCREE_SPLIT_HALVES;
      scree_tree alone = build(&meshes[i], leaf, split, 1);
      check_tree(&meshes[i], &alone, leaf);
      check_walks(&meshes[i], &alone);
      for (int threads = 2; threads < 9; threads += 3) {
        scree_tree tree = build(&meshes[i], leaf, split, threads);
        check_same(&alone, &tree);
        scree_tree_free(&tree);
      }
      scree_tree_free(&alone);
    }
  for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) scree_mesh_free(&meshes[i]);
}

/* Of no items at all. */
static void test_nothing(void **state) {
  (void)state;
  const scree_mesh none = {0};
  scree_tree tree = build(&none, 4, SCREE_SPLIT_AREA, 1);
  scree_tree_walk walk;
  scree_tree_start(&walk, &tree);
  assert_null(scree_tree_next(&walk));
  scree_tree_free(&tree);
}

/* Boxes that touch meet. */
static void test_boxes(void **state) {
  (void)state;
  double p[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, -1, 1, 1, 1, 5, 5, 0};
  uint32_t corners[] = {0, 1, 2, 3, 4, 5};
  scree_mesh m = {.positions = p, .vertex_count = 6, .triangles = corners, .triangle_count = 2};
  for (int i = 0; i < 3; i++) {
    scree_box a = scree_facet_box(&m, 0), b = scree_facet_box(&m, 1);
    assert_int_equal(scree_box_meets(&a, &b), i != 2);
    assert_int_equal(scree_box_meets(&b, &a), i != 2);
    p[11] = i == 0 ? 0 : nextafter(0, 1); /* the lowest corner: on the other's plane, above it */
    p[17] = 0.5;
  }
}

/* The disc's nodes lie side by side at a slant, round one vertex: few leaves are held to be near;
 * and whatever the number of threads, the same. */
static void test_second_boxes(void **state) {
  (void)state;
  scree_mesh disc = make_disc(30000);
  scree_facet_tree trees[2];
  scree_rng rng = {.seed = 5};
  scree_error error;
  size_t apart = 0, tried = 0;
  for (int i = 0; i < 2; i++) {
    scree_set_threads(1 + 3 * i);
    CHECK_OK(scree_facet_tree_build(&disc, &trees[i], &error), error);
  }
  scree_set_threads(0);
  assert_true(trees[0].frame_count > 0 && trees[0].frame_count == trees[1].frame_count);
  while (tried < 5000) {
    const scree_tree *t = &trees[0].tree;
    uint32_t a = scree_rng_below(&rng, (uint32_t)t->node_count),
             b = scree_rng_below(&rng, (uint32_t)t->node_count);
    bool are = scree_facet_nodes_apart(&trees[0], a, b);
    assert_int_equal(scree_facet_nodes_apart(&trees[1], a, b), are);
    if (!t->nodes[a].count || !t->nodes[b].count || a == b) continue;
    apart += are;
    tried++;
  }
  assert_true(apart > tried * 9 / 10);
  for (int i = 0; i < 2; i++) scree_facet_tree_free(&trees[i]);
  scree_mesh_free(&disc);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_boxes),
      cmocka_unit_test(test_structure),
      cmocka_unit_test(test_nothing),
      cmocka_unit_test(test_second_boxes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
