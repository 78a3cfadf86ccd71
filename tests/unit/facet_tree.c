/* The tree of facets, also where it is built in parts: what every node must hold, and that the
 * number of threads leaves no trace. That it finds what meets is tested with meetings.c. */
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

static scree_facet_tree build(const scree_mesh *mesh, int threads) {
  scree_facet_tree tree;
  scree_error error;
  scree_set_threads(threads);
  CHECK_OK(scree_facet_tree_build(mesh, &tree, &error), error);
  scree_set_threads(0);
  return tree;
}

/* The box of facets [begin, begin + count) of the order. */
static scree_box box_of(const scree_facet_tree *t, uint32_t begin, uint32_t count) {
  scree_box b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (uint32_t i = 3 * begin; i < 3 * (begin + count); i++) {
    uint32_t v = t->mesh->triangles[3 * (size_t)t->order[i / 3] + i % 3];
    vec3 p = vec3_load(t->mesh->positions + 3 * (size_t)v);
    b = scree_box_join(b, (scree_box){p, p});
  }
  return b;
}

/* Checks node `index` and all below it; the next index in depth-first order. */
static size_t check_node(const scree_facet_tree *t, size_t index, uint32_t begin, uint32_t count,
                         int depth) {
  const scree_facet_node *n = &t->nodes.items[index];
  assert_true(index < t->nodes.count);
  assert_true(depth <= 160);
  assert_int_equal(n->begin, begin);
  assert_int_equal(n->count, count);
  scree_box b = box_of(t, begin, count);
  assert_memory_equal(&n->bounds, &b, sizeof b);
  assert_true(n->frame == UINT32_MAX || n->frame < t->frames.count);
  if (scree_facet_node_is_leaf(n)) {
    assert_in_range(count, 1, SCREE_LEAF_FACETS);
    return index + 1;
  }
  assert_true(count > SCREE_LEAF_FACETS);
  uint32_t left = t->nodes.items[index + 1].count;
  assert_in_range(left, 1, count - 1);
  assert_int_equal(check_node(t, index + 1, begin, left, depth + 1), n->right);
  return check_node(t, n->right, begin + left, count - left, depth + 1);
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

static void check_tree(const scree_facet_tree *t) {
  size_t facets = t->mesh->triangle_count;
  bool *seen = scree_alloc_zero(facets, sizeof *seen);
  for (size_t i = 0; i < facets; i++) {
    assert_true(t->order[i] < facets && !seen[t->order[i]]);
    seen[t->order[i]] = true;
  }
  scree_free(seen);
  assert_int_equal(check_node(t, 0, 0, (uint32_t)facets, 0), t->nodes.count);
}

static void check_same(const scree_facet_tree *a, const scree_facet_tree *b) {
  scree_rng rng = {.seed = 3};
  assert_int_equal(a->nodes.count, b->nodes.count);
  assert_int_equal(a->frames.count, b->frames.count);
  assert_int_equal(a->cones.count, b->cones.count);
  assert_memory_equal(a->nodes.items, b->nodes.items, a->nodes.count * sizeof *a->nodes.items);
  assert_memory_equal(a->order, b->order, a->mesh->triangle_count * sizeof *a->order);
  for (int i = 0; i < 20000; i++) { /* second boxes and cones */
    size_t j = scree_rng_below(&rng, (uint32_t)a->nodes.count),
           k = scree_rng_below(&rng, (uint32_t)a->nodes.count);
    assert_int_equal(scree_facet_nodes_apart(a, &a->nodes.items[j], &a->nodes.items[k]),
                     scree_facet_nodes_apart(b, &b->nodes.items[j], &b->nodes.items[k]));
  }
}

/* Sizes about those of a part, and with many parts. */
static void test_structure(void **state) {
  (void)state;
  scree_mesh meshes[] = {shape_icosphere(1, 0), shape_icosphere(1, 4), shape_icosphere(2, 6),
                         make_disc(4095),       make_disc(4096),       make_disc(4097),
                         make_disc(30000),      make_crowd(5000),      make_crowd(60000)};
  for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
    scree_facet_tree alone = build(&meshes[i], 1);
    check_tree(&alone);
    for (int threads = 2; threads < 9; threads += 3) {
      scree_facet_tree tree = build(&meshes[i], threads);
      check_same(&alone, &tree);
      scree_facet_tree_free(&tree);
    }
    scree_facet_tree_free(&alone);
    scree_mesh_free(&meshes[i]);
  }
}

/* The disc's nodes lie side by side at a slant, round one vertex: few leaves are held to be near.
 */
static void test_second_boxes(void **state) {
  (void)state;
  scree_mesh disc = make_disc(30000);
  scree_facet_tree tree = build(&disc, 2);
  scree_rng rng = {.seed = 5};
  size_t apart = 0, tried = 0;
  assert_true(tree.frames.count > 0 && tree.cones.count > 0);
  while (tried < 5000) {
    const scree_facet_node *a =
                               &tree.nodes.items[scree_rng_below(&rng, (uint32_t)tree.nodes.count)],
                           *b =
                               &tree.nodes.items[scree_rng_below(&rng, (uint32_t)tree.nodes.count)];
    if (!scree_facet_node_is_leaf(a) || !scree_facet_node_is_leaf(b) || a == b) continue;
    apart += scree_facet_nodes_apart(&tree, a, b);
    tried++;
  }
  assert_true(apart > tried * 9 / 10);
  scree_facet_tree_free(&tree);
  scree_mesh_free(&disc);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_boxes),
      cmocka_unit_test(test_structure),
      cmocka_unit_test(test_second_boxes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
