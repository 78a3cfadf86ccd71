#include "simplify/surface_tree.h"

#include "base/parallel.h"

enum { LEAF = 8, BLOCK = 1024, DEPTH_MOST = 64 };
/* Above half a unit in the last place of a float of size 1, within which positions are. */
#define OUTWARD 1e-7f

void scree_bounds_add(scree_bounds *b, vec3 p) {
  const double c[3] = {p.x, p.y, p.z};
  for (int k = 0; k < 3; k++) {
    float low = (float)c[k] - OUTWARD, high = (float)c[k] + OUTWARD;
    b->low[k] = low < b->low[k] ? low : b->low[k];
    b->high[k] = high > b->high[k] ? high : b->high[k];
  }
}

/* Whether it grew. */
static bool join(scree_surface_node *a, const scree_surface_node *b) {
  bool grew = (b->averse & ~a->averse) != 0;
  a->averse |= b->averse;
  for (int k = 0; k < 3; k++) {
    float low = b->bounds.low[k], high = b->bounds.high[k];
    grew |= (low < a->bounds.low[k]) | (high > a->bounds.high[k]);
    a->bounds.low[k] = low < a->bounds.low[k] ? low : a->bounds.low[k];
    a->bounds.high[k] = high > a->bounds.high[k] ? high : a->bounds.high[k];
  }
  return grew;
}

void scree_facing_add(scree_facing *f, vec3 n) {
  double rounding = 1e-14 * (fabs(n.x) + fabs(n.y) + fabs(n.z));
  const double along[SCREE_FACING_LINES] = {n.x,
                                            n.y,
                                            n.z,
                                            n.x + n.y,
                                            n.x - n.y,
                                            n.x + n.z,
                                            n.x - n.z,
                                            n.y + n.z,
                                            n.y - n.z,
                                            n.x + n.y + n.z,
                                            n.x + n.y - n.z,
                                            n.x - n.y + n.z,
                                            n.y + n.z - n.x};
  for (int k = 0; k < SCREE_FACING_LINES; k++) {
    double least = along[k] - rounding, most = along[k] + rounding;
    f->least[k] = least < f->least[k] ? least : f->least[k];
    f->most[k] = most > f->most[k] ? most : f->most[k];
  }
}

uint32_t scree_facing_averse(const scree_facing *f) {
  uint32_t averse = 0;
  for (int k = 0; k < SCREE_FACING_LINES; k++) {
    averse |= (uint32_t) !(f->least[k] > 0) << (2 * k);
    averse |= (uint32_t) !(f->most[k] < 0) << (2 * k + 1);
  }
  return averse;
}

static size_t leaves_for(size_t triangle_count) {
  size_t leaves = 1;
  while (leaves * LEAF < triangle_count) leaves *= 2;
  return leaves;
}

scree_status scree_surface_tree_make(const scree_halfmesh *s, scree_surface_tree *tree,
                                     scree_error *error) {
  tree->leaves = leaves_for(s->triangle_count);
  SCREE_TRY_ALLOC(tree->node, 2 * tree->leaves, error);
  scree_surface_tree_fit(tree, s);
  return SCREE_OK;
}

void scree_surface_tree_free(scree_surface_tree *tree) {
  scree_free(tree->node);
  *tree = (scree_surface_tree){0};
}

typedef struct fitting {
  scree_surface_tree *tree;
  const scree_halfmesh *s;
  size_t first; /* node of the level at hand */
} fitting;

static void add_triangle(scree_bounds *bounds, scree_facing *facing, const scree_halfmesh *s,
                         size_t t) {
  vec3 at[3];
  scree_corners(s, t, at);
  scree_facing_add(facing, vec3_triangle_normal(at[0], at[1], at[2]));
  for (int i = 0; i < 3; i++) scree_bounds_add(bounds, at[i]);
}

static void fit_leaves(void *context, scree_block block) {
  const fitting *f = context;
  for (size_t leaf = block.begin; leaf < block.end; leaf++) {
    scree_bounds bounds = scree_bounds_empty();
    scree_facing facing = scree_facing_all();
    for (size_t t = LEAF * leaf; t < LEAF * leaf + LEAF && t < f->s->triangle_count; t++)
      if (!scree_is_gone(f->s, t)) add_triangle(&bounds, &facing, f->s, t);
    f->tree->node[f->tree->leaves + leaf] =
        (scree_surface_node){bounds, scree_facing_averse(&facing)};
  }
}

static void fit_level(void *context, scree_block block) {
  const fitting *f = context;
  scree_surface_node *node = f->tree->node;
  for (size_t i = f->first + block.begin; i < f->first + block.end; i++) {
    node[i] = node[2 * i];
    join(&node[i], &node[2 * i + 1]);
  }
}

void scree_surface_tree_fit(scree_surface_tree *tree, const scree_halfmesh *s) {
  fitting f = {.tree = tree, .s = s};
  tree->leaves = leaves_for(s->triangle_count);
  scree_discard_tail(tree->node, 2 * tree->leaves * sizeof *tree->node);
  scree_parallel_for(tree->leaves, BLOCK, fit_leaves, &f);
  for (f.first = tree->leaves / 2; f.first > 0; f.first /= 2)
    scree_parallel_for(f.first, BLOCK, fit_level, &f);
}

void scree_surface_tree_grow(scree_surface_tree *tree, uint32_t triangle,
                             const scree_bounds *bounds, vec3 normal) {
  scree_facing facing = scree_facing_all();
  scree_facing_add(&facing, normal);
  scree_surface_node added = {*bounds, scree_facing_averse(&facing)};
  for (size_t i = tree->leaves + triangle / LEAF; i > 0 && join(&tree->node[i], &added);) i /= 2;
}

bool scree_surface_tree_faces(const scree_surface_tree *tree, const scree_bounds *b,
                              uint32_t averse) {
  size_t stack[DEPTH_MOST], top = 0;
  stack[top++] = 1;
  while (top > 0) {
    size_t i = stack[--top];
    const scree_surface_node *node = &tree->node[i];
    if (!scree_bounds_meet(&node->bounds, b)) continue;
    if (i >= tree->leaves || (averse | node->averse) != SCREE_ALL_AVERSE) {
      averse |= node->averse;
      if (averse == SCREE_ALL_AVERSE) return false;
    } else {
      stack[top++] = 2 * i;
      stack[top++] = 2 * i + 1;
    }
  }
  return true;
}

size_t scree_surface_tree_overlap(const scree_surface_tree *tree, const scree_halfmesh *s,
                                  const scree_bounds *b, uint32_t *found, size_t room) {
  size_t stack[DEPTH_MOST], top = 0, count = 0;
  stack[top++] = 1;
  while (top > 0) {
    size_t i = stack[--top];
    if (!scree_bounds_meet(&tree->node[i].bounds, b)) continue;
    if (i < tree->leaves) {
      stack[top++] = 2 * i;
      stack[top++] = 2 * i + 1;
      continue;
    }
    size_t first = (i - tree->leaves) * LEAF;
    for (size_t t = first; t < first + LEAF && t < s->triangle_count; t++, count++)
      if (count < room) found[count] = (uint32_t)t;
  }
  return count;
}

static double distance_to_box(const scree_bounds *b, vec3 p) {
  const double c[3] = {p.x, p.y, p.z};
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    double below = (double)b->low[k] - c[k], above = c[k] - (double)b->high[k];
    double off = below > above ? below : above;
    sum += off > 0 ? off * off : 0;
  }
  return sum;
}

double scree_surface_tree_distance(const scree_surface_tree *tree, const scree_halfmesh *s, vec3 p,
                                   double enough, uint32_t *hint) {
  struct {
    size_t node;
    double distance2;
  } stack[DEPTH_MOST];
  size_t top = 0;
  double best = INFINITY;
  vec3 corner[3];
  if (*hint != SCREE_NONE) {
    scree_corners(s, *hint, corner);
    best = scree_distance2(corner, p);
  }
  stack[top].node = 1;
  stack[top++].distance2 = distance_to_box(&tree->node[1].bounds, p);
  while (top > 0 && best > enough) {
    size_t i = stack[--top].node;
    if (stack[top].distance2 >= best) continue;
    if (i < tree->leaves) {
      double left = distance_to_box(&tree->node[2 * i].bounds, p),
             right = distance_to_box(&tree->node[2 * i + 1].bounds, p);
      size_t far = left < right ? 2 * i + 1 : 2 * i;
      stack[top].node = far;
      stack[top++].distance2 = left < right ? right : left;
      stack[top].node = far ^ 1;
      stack[top++].distance2 = left < right ? left : right;
      continue;
    }
    size_t first = (i - tree->leaves) * LEAF;
    for (size_t t = first; t < first + LEAF && t < s->triangle_count; t++) {
      if (scree_is_gone(s, t)) continue;
      scree_corners(s, t, corner);
      double d = scree_distance2(corner, p);
      if (d < best) best = d, *hint = (uint32_t)t;
    }
  }
  return best;
}
