/* Built top-down: at each node the surface area heuristic (Goldsmith and Salmon 1987) is evaluated
 * at bins of the triangles' box centres (Wald 2007, "On fast construction of SAH-based bounding
 * volume hierarchies"). Nearest-point queries go down the nearer child first and skip boxes farther
 * than the best found. */
#include "mesh/index/bvh.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "mesh/mesh.h"

#include <stdlib.h>
#include <string.h>

enum {
  LEAF = 4,            /* triangles at most */
  LEAST = 2,           /* triangles on either side of a split, so nodes are fewer than triangles */
  BINS = 16,           /* per axis; more gains nothing measurable */
  SUBTREES = 64,       /* parts built in parallel, or up to twice as many */
  BALANCED_DEPTH = 48, /* below this, halves: bounds the depth and so the stack */
  STACK = 96,          /* > BALANCED_DEPTH + log2(2^32) */
  PRIMITIVE_BLOCK = 1 << 14
};

/* A triangle while building. Twice the centre is low + high. */
typedef struct primitive {
  double low[3], high[3];
  uint32_t triangle;
} primitive;

typedef struct box {
  double low[3], high[3];
} box;

typedef struct task {
  uint32_t node; /* in the scratch nodes */
  uint32_t first, count;
  int depth;
} task;

typedef struct halves {
  uint32_t slot; /* of the left part's node; the right one's is the next */
  task left, right;
} halves;

typedef struct builder {
  const scree_mesh *mesh;
  primitive *primitives;
  scree_bvh_node *scratch; /* the subtree over [first, first + count) uses slots of that range */
  uint32_t root_slot;
  task subtrees[2 * SUBTREES];
  halves splits[SUBTREES]; /* of these, as they are split */
  size_t subtree_count;
  scree_bvh *out;
} builder;

static const box nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void grow(box *b, const double *low, const double *high) {
  for (int k = 0; k < 3; k++) {
    b->low[k] = low[k] < b->low[k] ? low[k] : b->low[k];
    b->high[k] = high[k] > b->high[k] ? high[k] : b->high[k];
  }
}

static double half_area(const box *b) {
  double d[3];
  for (int k = 0; k < 3; k++) d[k] = b->high[k] > b->low[k] ? b->high[k] - b->low[k] : 0;
  return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

/* ---- Building ---- */

static void make_primitives(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  builder *b = context;
  for (size_t t = begin; t < end; t++) {
    primitive *made = &b->primitives[t];
    box bounds = nothing;
    for (int k = 0; k < 3; k++) {
      const double *p = b->mesh->positions + 3 * (size_t)b->mesh->triangles[3 * t + (size_t)k];
      grow(&bounds, p, p);
    }
    memcpy(made->low, bounds.low, sizeof made->low);
    memcpy(made->high, bounds.high, sizeof made->high);
    made->triangle = (uint32_t)t;
  }
}

static double twice_centre(const primitive *p, int axis) {
  return p->low[axis] + p->high[axis];
}

static int compare_centres(const void *a, const void *b, int axis) {
  const primitive *p = a, *q = b;
  double x = twice_centre(p, axis), y = twice_centre(q, axis);
  return x != y ? (x > y) - (x < y) : (p->triangle > q->triangle) - (p->triangle < q->triangle);
}
static int compare_x(const void *a, const void *b) {
  return compare_centres(a, b, 0);
}
static int compare_y(const void *a, const void *b) {
  return compare_centres(a, b, 1);
}
static int compare_z(const void *a, const void *b) {
  return compare_centres(a, b, 2);
}

/* How a node's triangles are told apart: bin i of an axis. */
typedef struct binning {
  int axis;
  double low, scale;
} binning;

static int bin_of(const binning *bins, const primitive *p) {
  int bin = (int)((twice_centre(p, bins->axis) - bins->low) * bins->scale);
  return bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin;
}

/* The bin before which to split, or 0 where no split leaves LEAST on either side. */
static int best_split(const binning *bins, const primitive *primitives, size_t count) {
  box bounds[BINS], right = nothing, left = nothing;
  size_t counts[BINS] = {0}, right_count = 0, left_count = 0;
  double right_cost[BINS], least = INFINITY;
  int best = 0;
  for (int i = 0; i < BINS; i++) bounds[i] = nothing;
  for (size_t i = 0; i < count; i++) {
    int bin = bin_of(bins, &primitives[i]);
    grow(&bounds[bin], primitives[i].low, primitives[i].high);
    counts[bin]++;
  }
  for (int i = BINS - 1; i > 0; i--) {
    grow(&right, bounds[i].low, bounds[i].high);
    right_count += counts[i];
    right_cost[i] = right_count < LEAST ? INFINITY : half_area(&right) * (double)right_count;
  }
  for (int i = 1; i < BINS; i++) {
    grow(&left, bounds[i - 1].low, bounds[i - 1].high);
    left_count += counts[i - 1];
    double cost = half_area(&left) * (double)left_count + right_cost[i];
    if (left_count >= LEAST && cost < least) least = cost, best = i;
  }
  return best;
}

static size_t partition(const binning *bins, int split, primitive *primitives, size_t count) {
  size_t i = 0, j = count;
  for (;;) {
    while (i < j && bin_of(bins, &primitives[i]) < split) i++;
    while (i < j && bin_of(bins, &primitives[j - 1]) >= split) j--;
    if (i >= j) return i;
    primitive swap = primitives[i];
    primitives[i++] = primitives[--j];
    primitives[j] = swap;
  }
}

/* Orders the triangles so that the first part, whose size is returned, goes left. */
static size_t split_primitives(primitive *primitives, size_t count, const box *centres, int depth) {
  binning bins = {0};
  double longest = -1;
  for (int k = 0; k < 3; k++)
    if (centres->high[k] - centres->low[k] > longest) {
      longest = centres->high[k] - centres->low[k];
      bins.axis = k;
    }
  bins.low = centres->low[bins.axis];
  bins.scale = BINS / longest;
  if (longest > 0 && isfinite(bins.scale) && depth < BALANCED_DEPTH) {
    int split = best_split(&bins, primitives, count);
    if (split) return partition(&bins, split, primitives, count);
  }
  static int (*const compare[3])(const void *, const void *) = {compare_x, compare_y, compare_z};
  qsort(primitives, count, sizeof *primitives, compare[bins.axis]);
  return count / 2;
}

/* Bounds the task's node; makes it a leaf (false), or splits it in two further tasks whose nodes
 * are *slot and *slot + 1. */
static bool build_node(builder *b, const task *t, uint32_t *slot, task *left, task *right) {
  scree_bvh_node *node = &b->scratch[t->node];
  primitive *primitives = b->primitives + t->first;
  box bounds = nothing, centres = nothing;
  for (size_t i = 0; i < t->count; i++) {
    double centre[3];
    for (int k = 0; k < 3; k++) centre[k] = twice_centre(&primitives[i], k);
    grow(&bounds, primitives[i].low, primitives[i].high);
    grow(&centres, centre, centre);
  }
  memcpy(node->low, bounds.low, sizeof node->low);
  memcpy(node->high, bounds.high, sizeof node->high);
  node->first = t->first;
  node->count = t->count;
  if (t->count <= LEAF) return false;
  uint32_t middle = (uint32_t)split_primitives(primitives, t->count, &centres, t->depth);
  node->first = *slot;
  node->count = 0;
  *left = (task){*slot, t->first, middle, t->depth + 1};
  *right = (task){*slot + 1, t->first + middle, t->count - middle, t->depth + 1};
  *slot += 2;
  return true;
}

static void build_subtree(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  builder *b = context;
  for (size_t i = begin; i < end; i++) {
    task stack[STACK];
    int depth = 0;
    uint32_t slot = b->subtrees[i].first;
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

static void split_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  builder *b = context;
  for (size_t i = begin; i < end; i++) {
    halves *made = &b->splits[i];
    if (!is_small(&b->subtrees[i]))
      build_node(b, &b->subtrees[i], &made->slot, &made->left, &made->right);
  }
}

/* Splits all parts that are not small, and again, until there are SUBTREES of them. */
static void build_top(builder *b) {
  uint32_t count = (uint32_t)b->mesh->triangle_count, slot = count + 1;
  b->root_slot = count;
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
    const scree_bvh_node *node = &b->scratch[stack[--depth]];
    count++;
    if (node->count) continue;
    stack[depth++] = node->first + 1;
    stack[depth++] = node->first;
  }
  return count;
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
    uint32_t to = stack[depth].to;
    scree_bvh_node node = b->scratch[stack[depth].from];
    uint32_t children = node.first;
    if (!node.count) node.first = used;
    b->out->nodes[to] = node;
    if (node.count) continue;
    for (uint32_t side = 2; side-- > 0;) {
      stack[depth].from = children + side;
      stack[depth++].to = used + side;
    }
    used += 2;
  }
}

static void copy_corners(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  builder *b = context;
  for (size_t i = begin; i < end; i++) {
    uint32_t t = b->primitives[i].triangle;
    b->out->order[i] = t;
    for (int k = 0; k < 3; k++)
      vec3_store(b->out->corners + 9 * i + 3 * k, scree_mesh_corner(b->mesh, t, k));
  }
}

scree_status scree_bvh_build(const scree_mesh *mesh, scree_bvh *bvh, scree_error *error) {
  scree_bvh made = {.triangle_count = mesh->triangle_count};
  builder b = {.mesh = mesh, .out = &made};
  size_t count = mesh->triangle_count;
  scree_status status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(b.primitives, count, error, done);
  SCREE_ALLOC_OR(b.scratch, count + (size_t)4 * SUBTREES + 1, error, done);
  if (count > 0) {
    scree_parallel_for(count, PRIMITIVE_BLOCK, make_primitives, &b);
    build_top(&b);
    scree_parallel_for(b.subtree_count, 1, build_subtree, &b);
    made.node_count = count_nodes(&b);
  }
  SCREE_ALLOC_OR(made.nodes, made.node_count, error, done);
  if (count > 0) lay_out(&b);
  scree_free(b.scratch);
  b.scratch = NULL;
  SCREE_ALLOC_OR(made.corners, 9 * count, error, done);
  SCREE_ALLOC_OR(made.order, count, error, done);
  scree_parallel_for(count, PRIMITIVE_BLOCK, copy_corners, &b);
  status = SCREE_OK;
done:
  scree_free(b.primitives);
  scree_free(b.scratch);
  if (status == SCREE_OK)
    *bvh = made;
  else
    scree_bvh_free(&made);
  return status;
}

void scree_bvh_free(scree_bvh *bvh) {
  if (!bvh) return;
  scree_free(bvh->nodes);
  scree_free(bvh->corners);
  scree_free(bvh->order);
  *bvh = (scree_bvh){0};
}

/* ---- Nearest points ---- */

/* How far x is outside [low, high]; not by fmax, which is a call. */
static inline double outside(double low, double high, double x) {
  double below = low - x, above = x - high, more = below > above ? below : above;
  return more > 0 ? more : 0;
}

static double box_distance2(const scree_bvh_node *node, vec3 p) {
  double x = outside(node->low[0], node->high[0], p.x),
         y = outside(node->low[1], node->high[1], p.y),
         z = outside(node->low[2], node->high[2], p.z);
  return x * x + y * y + z * z;
}

static bool closest_in_leaf(const scree_bvh *bvh, const scree_bvh_node *leaf, vec3 p,
                            scree_bvh_hit *hit) {
  bool found = false;
  for (uint32_t i = leaf->first; i < leaf->first + leaf->count; i++) {
    vec3 point;
    double distance2 = scree_triangle_closest(bvh->corners + 9 * (size_t)i, p, &point);
    if (distance2 >= hit->distance2) continue;
    *hit = (scree_bvh_hit){distance2, point, i};
    found = true;
  }
  return found;
}

bool scree_bvh_closest(const scree_bvh *bvh, vec3 p, scree_bvh_hit *hit) {
  struct {
    uint32_t node;
    double distance2;
  } stack[STACK];
  int depth = 0;
  bool found = false;
  if (bvh->node_count == 0) return false;
  stack[depth].node = 0;
  stack[depth++].distance2 = box_distance2(bvh->nodes, p);
  while (depth > 0) {
    depth--;
    if (stack[depth].distance2 >= hit->distance2) continue;
    const scree_bvh_node *node = &bvh->nodes[stack[depth].node];
    if (node->count) {
      found |= closest_in_leaf(bvh, node, p, hit);
      continue;
    }
    uint32_t near = node->first, far = near + 1;
    double near2 = box_distance2(&bvh->nodes[near], p), far2 = box_distance2(&bvh->nodes[far], p);
    if (far2 < near2) {
      double swap = near2;
      near2 = far2, far2 = swap;
      near++, far--;
    }
    if (far2 < hit->distance2) stack[depth].node = far, stack[depth++].distance2 = far2;
    if (near2 < hit->distance2) stack[depth].node = near, stack[depth++].distance2 = near2;
  }
  return found;
}

/* ---- Of many points ---- */

static box box_of_points(const scree_point_block *points) {
  box b = nothing;
  for (int i = 0; i < points->count; i++) {
    const double p[3] = {points->at[0][i], points->at[1][i], points->at[2][i]};
    grow(&b, p, p);
  }
  return b;
}

/* How far apart two boxes are, squared. */
static double boxes_apart2(const scree_bvh_node *node, const box *b) {
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    double below = node->low[k] - b->high[k], above = b->low[k] - node->high[k];
    double gap = below > above ? below : above;
    sum += gap > 0 ? gap * gap : 0;
  }
  return sum;
}

void scree_bvh_closest_block(const scree_bvh *bvh, scree_point_block *points) {
  struct {
    uint32_t node;
    double apart2;
  } stack[STACK];
  int depth = 0;
  box bounds = box_of_points(points);
  double farthest2 = scree_point_block_farthest(points);
  vec3 middle = vec3_scale(vec3_add(vec3_load(bounds.low), vec3_load(bounds.high)), 0.5);
  if (bvh->node_count == 0) return;
  stack[depth].node = 0;
  stack[depth++].apart2 = boxes_apart2(bvh->nodes, &bounds);
  while (depth > 0) {
    depth--;
    if (stack[depth].apart2 >= farthest2) continue;
    const scree_bvh_node *node = &bvh->nodes[stack[depth].node];
    if (node->count) {
      if (!scree_point_block_near(points, node->low, node->high)) continue;
      for (uint32_t i = node->first; i < node->first + node->count; i++)
        scree_point_block_closest(points, bvh->corners + 9 * (size_t)i, i);
      farthest2 = scree_point_block_farthest(points);
      continue;
    }
    uint32_t near = node->first, far = near + 1;
    if (box_distance2(&bvh->nodes[far], middle) < box_distance2(&bvh->nodes[near], middle))
      near++, far--;
    double near2 = boxes_apart2(&bvh->nodes[near], &bounds),
           far2 = boxes_apart2(&bvh->nodes[far], &bounds);
    if (far2 < farthest2) stack[depth].node = far, stack[depth++].apart2 = far2;
    if (near2 < farthest2) stack[depth].node = near, stack[depth++].apart2 = near2;
  }
}
