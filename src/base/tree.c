/* Built top-down. By area: at each node the surface area heuristic (Goldsmith and Salmon 1987) is
 * evaluated at bins of the items' box centres (Wald 2007, "On fast construction of SAH-based
 * bounding volume hierarchies"). By halves: at the median of the centres, ties by index. */
#include "base/tree.h"

#include "base/alloc.h"
#include "base/parallel.h"

enum {
  LEAST = 2,           /* items on either side of a split by area */
  BINS = 16,           /* per axis; more gains nothing measurable */
  SUBTREES = 64,       /* parts built in parallel, or up to twice as many */
  BALANCED_DEPTH = 48, /* below this, halves: bounds the depth and so the stack */
  STACK = SCREE_TREE_STACK,
  ITEM_BLOCK = 1 << 14
};

/* An item while building. */
typedef struct boxed {
  scree_box box;
  uint32_t index;
} boxed;

typedef struct task {
  uint32_t node; /* in the scratch nodes */
  uint32_t first, count;
  int depth;
} task;

/* A node without its box. */
typedef struct branch {
  uint32_t first, count;
} branch;

typedef struct halves {
  uint32_t slot; /* of the left part's node; the right one's is the next */
  task left, right;
} halves;

typedef struct builder {
  const scree_boxed *items;
  boxed *boxes;
  /* Nodes but the root's are fewer than twice the items, and fewer than the items where no leaf has
   * a single one: so many slots an item, those of a subtree from its first item's on. */
  uint32_t slots;
  branch *scratch;
  uint32_t root_slot;
  task subtrees[2 * SUBTREES];
  halves splits[SUBTREES]; /* of these, as they are split */
  size_t subtree_count;
  scree_tree *out;
} builder;

static double half_area(const scree_box *b) {
  double x = b->high.x > b->low.x ? b->high.x - b->low.x : 0,
         y = b->high.y > b->low.y ? b->high.y - b->low.y : 0,
         z = b->high.z > b->low.z ? b->high.z - b->low.z : 0;
  return x * y + y * z + z * x;
}

/* ---- Building ---- */

static void make_boxes(void *context, scree_block block) {
  builder *b = context;
  for (size_t i = block.begin; i < block.end; i++)
    b->boxes[i] = (boxed){b->items->box(b->items->context, i), (uint32_t)i};
}

static double twice_centre(const boxed *p, int axis) {
  const double *low = &p->box.low.x, *high = &p->box.high.x;
  return low[axis] + high[axis];
}

static bool comes_before(const boxed *p, const boxed *q, int axis) {
  double x = twice_centre(p, axis), y = twice_centre(q, axis);
  return x < y || (x == y && p->index < q->index);
}

static void swap(boxed *p, boxed *q) {
  boxed kept = *p;
  *p = *q;
  *q = kept;
}

/* Quickselect: the items before the middle come before those after it. */
static size_t halve(boxed *boxes, size_t count, int axis) {
  size_t low = 0, high = count - 1, middle = count / 2;
  while (low < high) {
    boxed pivot = boxes[low + (high - low) / 2];
    size_t i = low, j = high;
    for (;;) {
      while (comes_before(&boxes[i], &pivot, axis)) i++;
      while (comes_before(&pivot, &boxes[j], axis)) j--;
      if (i >= j) break;
      swap(&boxes[i++], &boxes[j--]);
    }
    if (middle <= j)
      high = j;
    else
      low = j + 1;
  }
  return middle;
}

/* How a node's items are told apart: bin i of an axis. */
typedef struct binning {
  int axis;
  double low, scale;
} binning;

static int bin_of(const binning *bins, const boxed *p) {
  int bin = (int)((twice_centre(p, bins->axis) - bins->low) * bins->scale);
  return bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin;
}

/* The bin before which to split, or 0 where no split leaves LEAST on either side. */
static int best_split(const binning *bins, const boxed *boxes, size_t count) {
  scree_box bounds[BINS], right = scree_box_empty(), left = scree_box_empty();
  size_t counts[BINS] = {0}, right_count = 0, left_count = 0;
  double right_cost[BINS], least = INFINITY;
  int best = 0;
  for (int i = 0; i < BINS; i++) bounds[i] = scree_box_empty();
  for (size_t i = 0; i < count; i++) {
    int bin = bin_of(bins, &boxes[i]);
    bounds[bin] = scree_box_join(bounds[bin], boxes[i].box);
    counts[bin]++;
  }
  for (int i = BINS - 1; i > 0; i--) {
    right = scree_box_join(right, bounds[i]);
    right_count += counts[i];
    right_cost[i] = right_count < LEAST ? INFINITY : half_area(&right) * (double)right_count;
  }
  for (int i = 1; i < BINS; i++) {
    left = scree_box_join(left, bounds[i - 1]);
    left_count += counts[i - 1];
    double cost = half_area(&left) * (double)left_count + right_cost[i];
    if (left_count >= LEAST && cost < least) least = cost, best = i;
  }
  return best;
}

static size_t partition(const binning *bins, int split, boxed *boxes, size_t count) {
  size_t i = 0, j = count;
  for (;;) {
    while (i < j && bin_of(bins, &boxes[i]) < split) i++;
    while (i < j && bin_of(bins, &boxes[j - 1]) >= split) j--;
    if (i >= j) return i;
    swap(&boxes[i++], &boxes[--j]);
  }
}

/* Orders the items so that the first part, whose size is returned, goes left. */
static size_t split_boxes(const builder *b, const task *t, const scree_box *centres) {
  boxed *boxes = b->boxes + t->first;
  vec3 size = vec3_sub(centres->high, centres->low);
  binning bins = {.axis = vec3_greatest(size)};
  double longest = vec3_along(size, bins.axis);
  bins.low = vec3_along(centres->low, bins.axis);
  bins.scale = BINS / longest;
  if (b->items->split == SCREE_SPLIT_AREA && longest > 0 && isfinite(bins.scale) &&
      t->depth < BALANCED_DEPTH) {
    int split = best_split(&bins, boxes, t->count);
    if (split) return partition(&bins, split, boxes, t->count);
  }
  return halve(boxes, t->count, bins.axis);
}

/* Makes the task's node a leaf (false), or splits it in two further tasks whose nodes are *slot and
 * *slot + 1. */
static bool build_node(builder *b, const task *t, uint32_t *slot, task *left, task *right) {
  if (t->count <= b->items->leaf) {
    b->scratch[t->node] = (branch){t->first, t->count};
    return false;
  }
  scree_box centres = scree_box_empty();
  for (size_t i = t->first; i < t->first + t->count; i++) {
    vec3 centre = vec3_add(b->boxes[i].box.low, b->boxes[i].box.high);
    centres = scree_box_join(centres, (scree_box){centre, centre});
  }
  uint32_t middle = (uint32_t)split_boxes(b, t, &centres);
  b->scratch[t->node] = (branch){*slot, 0};
  *left = (task){*slot, t->first, middle, t->depth + 1};
  *right = (task){*slot + 1, t->first + middle, t->count - middle, t->depth + 1};
  *slot += 2;
  return true;
}

static void build_subtree(void *context, scree_block block) {
  builder *b = context;
  for (size_t i = block.begin; i < block.end; i++) {
    task stack[STACK];
    int depth = 0;
    uint32_t slot = b->slots * b->subtrees[i].first;
    stack[depth++] = b->subtrees[i];
    while (depth > 0) {
      task now = stack[--depth], left, right;
      if (!build_node(b, &now, &slot, &left, &right)) continue;
      stack[depth++] = right;
      stack[depth++] = left;
    }
  }
}

static bool is_small(const task *t) {
  return t->count <= SUBTREES;
}

static void split_block(void *context, scree_block block) {
  builder *b = context;
  for (size_t i = block.begin; i < block.end; i++) {
    halves *made = &b->splits[i];
    if (!is_small(&b->subtrees[i]))
      build_node(b, &b->subtrees[i], &made->slot, &made->left, &made->right);
  }
}

/* Splits all parts that are not small, and again, until there are SUBTREES of them. */
static void build_top(builder *b) {
  uint32_t count = (uint32_t)b->items->count, slot = b->slots * count + 1;
  b->root_slot = b->slots * count;
  b->subtrees[0] = (task){b->root_slot, 0, count, 0};
  b->subtree_count = 1;
  for (size_t before = 0; before < b->subtree_count && b->subtree_count < SUBTREES;) {
    before = b->subtree_count;
    for (size_t i = 0; i < before; i++) {
      b->splits[i].slot = slot;
      if (!is_small(&b->subtrees[i])) slot += 2;
    }
    scree_parallel_for(before, 1, split_block, b);
    for (size_t i = 0; i < before; i++) {
      if (is_small(&b->subtrees[i])) continue;
      b->subtrees[i] = b->splits[i].left;
      b->subtrees[b->subtree_count++] = b->splits[i].right;
    }
  }
}

static size_t count_nodes(const builder *b) {
  uint32_t stack[STACK];
  size_t count = 0;
  int depth = 0;
  stack[depth++] = b->root_slot;
  while (depth > 0) {
    const branch *node = &b->scratch[stack[--depth]];
    count++;
    if (node->count) continue;
    stack[depth++] = node->first + 1;
    stack[depth++] = node->first;
  }
  return count;
}

static void make_leaf_boxes(void *context, scree_block block) {
  const builder *b = context;
  for (size_t i = block.begin; i < block.end; i++) {
    scree_tree_node *node = &b->out->nodes[i];
    const uint32_t *item = b->out->order + node->first;
    node->box = scree_box_empty();
    for (uint32_t k = 0; k < node->count; k++)
      node->box = scree_box_join(node->box, b->items->box(b->items->context, item[k]));
  }
}

/* Copies the scratch nodes depth first, without holes. */
static void lay_out(const builder *b) {
  struct {
    uint32_t from, to;
  } stack[STACK];
  int depth = 0;
  uint32_t used = 1;
  stack[depth].from = b->root_slot;
  stack[depth++].to = 0;
  while (depth > 0) {
    depth--;
    branch node = b->scratch[stack[depth].from];
    b->out->nodes[stack[depth].to] =
        (scree_tree_node){.first = node.count ? node.first : used, .count = node.count};
    if (node.count) continue;
    for (uint32_t side = 2; side-- > 0;) {
      stack[depth].from = node.first + side;
      stack[depth++].to = used + side;
    }
    used += 2;
  }
}

static void make_node_boxes(builder *b) {
  scree_parallel_for(b->out->node_count, ITEM_BLOCK, make_leaf_boxes, b);
  for (size_t i = b->out->node_count; i-- > 0;) {
    scree_tree_node *node = &b->out->nodes[i], *child = b->out->nodes + node->first;
    if (!node->count) node->box = scree_box_join(child[0].box, child[1].box);
  }
}

static void free_builder(builder *b) {
  scree_free(b->boxes);
  scree_free(b->scratch);
}

scree_status scree_tree_build(const scree_boxed *items, scree_tree *tree, scree_error *error) {
  size_t count = items->count;
  SCREE_CLEANUP(scree_tree_free) scree_tree made = {.item_count = count};
  SCREE_CLEANUP(free_builder)
  builder b = {.items = items, .out = &made, .slots = items->leaf > LEAST ? 1 : 2};
  if (count == 0) {
    *tree = made;
    return SCREE_OK;
  }
  SCREE_TRY_ALLOC(b.boxes, count, error);
  SCREE_TRY_ALLOC(b.scratch, b.slots * count + (size_t)4 * SUBTREES + 1, error);
  scree_parallel_for(count, ITEM_BLOCK, make_boxes, &b);
  build_top(&b);
  scree_parallel_for(b.subtree_count, 1, build_subtree, &b);
  SCREE_TRY_ALLOC(made.order, count, error);
  for (size_t i = 0; i < count; i++) made.order[i] = b.boxes[i].index;
  scree_free(b.boxes);
  b.boxes = NULL;
  made.node_count = count_nodes(&b);
  SCREE_TRY_ALLOC(made.nodes, made.node_count, error);
  lay_out(&b);
  make_node_boxes(&b);
  *tree = made;
  made = (scree_tree){0};
  return SCREE_OK;
}

/* ---- Cones ---- */

static const double pi = 3.14159265358979323846;
static const double opposite = 1e-6; /* rad */

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
  if (tree->item_count == 0) return SCREE_OK;
  SCREE_TRY_ALLOC(tree->cones, tree->node_count, error);
  for (size_t i = tree->node_count; i-- > 0;) { /* children come after their parent */
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
}

void scree_tree_free(scree_tree *tree) {
  scree_free(tree->cones);
  scree_free(tree->nodes);
  scree_free(tree->order);
  *tree = (scree_tree){0};
}
