/* Median-split box tree. Ties are broken by index, so the tree depends on the input alone. */
#include "particle/tree.h"

#include "base/alloc.h"

static const double pi = 3.14159265358979323846;
static const double opposite = 1e-6; /* rad */

typedef struct tree_builder {
  const scree_box *boxes;
  scree_tree *tree;
  uint32_t node_count;
} tree_builder;

static double centre_along(const scree_box *box, int axis) {
  const double *low = &box->low.x, *high = &box->high.x;
  return low[axis] + high[axis];
}

static bool comes_before(const tree_builder *b, int axis, uint32_t i, uint32_t j) {
  double ci = centre_along(&b->boxes[i], axis), cj = centre_along(&b->boxes[j], axis);
  return ci < cj || (ci == cj && i < j);
}

/* Quickselect: the items before `middle` come before those after it. */
static void split_at(const tree_builder *b, int axis, uint32_t *items, size_t count,
                     size_t middle) {
  size_t low = 0, high = count - 1;
  while (low < high) {
    uint32_t pivot = items[low + (high - low) / 2];
    size_t i = low, j = high;
    for (;;) {
      while (comes_before(b, axis, items[i], pivot)) i++;
      while (comes_before(b, axis, pivot, items[j])) j--;
      if (i >= j) break;
      uint32_t swapped = items[i];
      items[i++] = items[j];
      items[j--] = swapped;
    }
    if (middle <= j)
      high = j;
    else
      low = j + 1;
  }
}

static void build_node(tree_builder *b, uint32_t node_index, size_t first, size_t count) {
  scree_tree *tree = b->tree;
  uint32_t *items = tree->order + first;
  scree_box box = b->boxes[items[0]],
            centres = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (size_t i = 0; i < count; i++) {
    const scree_box *item = &b->boxes[items[i]];
    vec3 centre = vec3_add(item->low, item->high);
    box = scree_box_join(box, *item);
    centres = scree_box_join(centres, (scree_box){centre, centre});
  }
  scree_tree_node *node = &tree->nodes[node_index];
  node->box = box;
  if (count <= SCREE_TREE_LEAF) {
    node->first = (uint32_t)first;
    node->count = (uint32_t)count;
    return;
  }
  vec3 size = vec3_sub(centres.high, centres.low);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  size_t half = count / 2;
  split_at(b, axis, items, count, half);
  uint32_t children = b->node_count;
  b->node_count += 2;
  node->first = children;
  node->count = 0;
  build_node(b, children, first, half);
  build_node(b, children + 1, first + half, count - half);
}

scree_status scree_tree_build(const scree_box *boxes, size_t item_count, scree_tree *tree,
                              scree_error *error) {
  scree_tree made = {.item_count = item_count};
  if (item_count == 0) {
    *tree = made;
    return SCREE_OK;
  }
  SCREE_ALLOC_OR(made.nodes, 2 * item_count, error, out_of_memory);
  SCREE_ALLOC_OR(made.order, item_count, error, out_of_memory);
  for (size_t i = 0; i < item_count; i++) made.order[i] = (uint32_t)i;
  tree_builder builder = {boxes, &made, 1};
  build_node(&builder, 0, 0, item_count);
  *tree = made;
  return SCREE_OK;
out_of_memory:
  scree_tree_free(&made);
  return SCREE_OUT_OF_MEMORY;
}

/* The least cone about both (up to rounding, for which it is widened). */
static scree_cone join_cones(const scree_cone *a, const scree_cone *b) {
  double wide_a = scree_acos(a->cosine), wide_b = scree_acos(b->cosine),
         between = scree_acos(scree_max(-1, scree_min(1, vec3_dot(a->axis, b->axis))));
  if (between + wide_b <= wide_a) return *a;
  if (between + wide_a <= wide_b) return *b;
  double wide = scree_min(0.5 * (between + wide_a + wide_b) + 1e-7, pi), turn = wide - wide_a;
  vec3 aside = vec3_unit(vec3_mad(b->axis, a->axis, -vec3_dot(a->axis, b->axis)));
  if (between > pi - opposite) wide = pi; /* aside is rounding */
  return (scree_cone){
      vec3_unit(vec3_mad(vec3_scale(a->axis, scree_cos(turn)), aside, scree_sin(turn))),
      scree_cos(wide), scree_max(scree_sin(wide), 0)};
}

scree_status scree_tree_add_cones(scree_tree *tree, const scree_cone *items, scree_error *error) {
  size_t count = tree->item_count;
  if (count == 0) return SCREE_OK;
  size_t node_count = 1; /* children come in twos, after their parent */
  for (size_t i = 0; i < node_count; i++) node_count += tree->nodes[i].count ? 0 : 2;
  SCREE_ALLOC_OR(tree->cones, node_count, error, out_of_memory);
  for (size_t i = node_count; i-- > 0;) {
    const scree_tree_node *node = &tree->nodes[i];
    if (node->count == 0) {
      tree->cones[i] = join_cones(&tree->cones[node->first], &tree->cones[node->first + 1]);
      continue;
    }
    tree->cones[i] = items[tree->order[node->first]];
    for (uint32_t k = 1; k < node->count; k++)
      tree->cones[i] = join_cones(&tree->cones[i], &items[tree->order[node->first + k]]);
  }
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_tree_free(scree_tree *tree) {
  scree_free(tree->cones);
  scree_free(tree->nodes);
  scree_free(tree->order);
  *tree = (scree_tree){0};
}

scree_box scree_box_moved(const scree_box *box, const mat3 *rotation, vec3 shift) {
  vec3 centre = vec3_scale(vec3_add(box->low, box->high), 0.5);
  vec3 half = vec3_scale(vec3_sub(box->high, box->low), 0.5);
  vec3 c = vec3_add(mat3_mul_vec(rotation, centre), shift);
  vec3 h = {fabs(rotation->m[0][0]) * half.x + fabs(rotation->m[0][1]) * half.y +
                fabs(rotation->m[0][2]) * half.z,
            fabs(rotation->m[1][0]) * half.x + fabs(rotation->m[1][1]) * half.y +
                fabs(rotation->m[1][2]) * half.z,
            fabs(rotation->m[2][0]) * half.x + fabs(rotation->m[2][1]) * half.y +
                fabs(rotation->m[2][2]) * half.z};
  return (scree_box){vec3_sub(c, h), vec3_add(c, h)};
}

bool scree_box_cut(const scree_box *box, vec3 start, vec3 along, double *from, double *to) {
  const double starts[3] = {start.x, start.y, start.z}, alongs[3] = {along.x, along.y, along.z},
               low[3] = {box->low.x, box->low.y, box->low.z},
               high[3] = {box->high.x, box->high.y, box->high.z};
  for (int k = 0; k < 3; k++) {
    if (alongs[k] == 0) {
      if (starts[k] < low[k] || starts[k] > high[k]) return false;
      continue;
    }
    double t0 = (low[k] - starts[k]) / alongs[k], t1 = (high[k] - starts[k]) / alongs[k];
    *from = scree_larger(*from, scree_smaller(t0, t1));
    *to = scree_smaller(*to, scree_larger(t0, t1));
  }
  return *from <= *to;
}
