#include "simplify/surface_tree.h"

#include "base/parallel.h"

#include <float.h>

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

uint32_t scree_averse(vec3 n) {
  const double along[13] = {n.x,
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
  double rounding = 1e-14 * (fabs(n.x) + fabs(n.y) + fabs(n.z));
  uint32_t averse = 0;
  for (int k = 0; k < 13; k++) {
    averse |= (uint32_t) !(along[k] > rounding) << (2 * k);
    averse |= (uint32_t) !(-along[k] > rounding) << (2 * k + 1);
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
  SCREE_ALLOC_OR(tree->node, 2 * tree->leaves, error, out_of_memory);
  scree_surface_tree_fit(tree, s, NULL);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_surface_tree_free(scree_surface_tree *tree) {
  scree_free(tree->node);
  *tree = (scree_surface_tree){0};
}

typedef struct fitting {
  scree_surface_tree *tree;
  const scree_halfmesh *s;
  const scree_planned *planned;
  size_t first; /* node of the level at hand */
} fitting;

/* Triangle t as it is, and as it is planned to be. */
static void add_triangle(scree_surface_node *node, const fitting *f, size_t t) {
  const scree_halfmesh *s = f->s;
  vec3 at[3];
  int moved = 0;
  scree_corners(s, t, at);
  node->averse |= scree_averse(vec3_triangle_normal(at[0], at[1], at[2]));
  for (size_t i = 0; i < 3; i++) {
    scree_bounds_add(&node->bounds, at[i]);
    uint32_t v = s->half[3 * t + i].from;
    if (!f->planned || f->planned->chosen[v] == SCREE_NONE) continue;
    at[i] = f->planned->target[f->planned->chosen[v]];
    scree_bounds_add(&node->bounds, at[i]);
    moved++;
  }
  if (moved == 1) node->averse |= scree_averse(vec3_triangle_normal(at[0], at[1], at[2]));
}

static void fit_leaves(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const fitting *f = context;
  for (size_t leaf = begin; leaf < end; leaf++) {
    scree_surface_node node = {.bounds = scree_bounds_empty()};
    for (size_t t = LEAF * leaf; t < LEAF * leaf + LEAF && t < f->s->triangle_count; t++)
      if (!scree_is_gone(f->s, t)) add_triangle(&node, f, t);
    f->tree->node[f->tree->leaves + leaf] = node;
  }
}

static void fit_level(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const fitting *f = context;
  scree_surface_node *node = f->tree->node;
  for (size_t i = f->first + begin; i < f->first + end; i++) {
    node[i] = node[2 * i];
    join(&node[i], &node[2 * i + 1]);
  }
}

void scree_surface_tree_fit(scree_surface_tree *tree, const scree_halfmesh *s,
                            const scree_planned *planned) {
  fitting f = {.tree = tree, .s = s, .planned = planned};
  tree->leaves = leaves_for(s->triangle_count);
  scree_discard_tail(tree->node, 2 * tree->leaves * sizeof *tree->node);
  scree_parallel_for(tree->leaves, BLOCK, fit_leaves, &f);
  for (f.first = tree->leaves / 2; f.first > 0; f.first /= 2)
    scree_parallel_for(f.first, BLOCK, fit_level, &f);
}

void scree_surface_tree_grow(scree_surface_tree *tree, uint32_t triangle,
                             const scree_bounds *bounds, vec3 normal) {
  scree_surface_node added = {*bounds, scree_averse(normal)};
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

/* After Ericson, "Real-time collision detection" (2005), 5.1.5. */
double scree_distance2(const vec3 corner[3], vec3 p) {
  vec3 ab = vec3_sub(corner[1], corner[0]), ac = vec3_sub(corner[2], corner[0]),
       ap = vec3_sub(p, corner[0]);
  double d1 = vec3_dot(ab, ap), d2 = vec3_dot(ac, ap), u = 0, v = 0;
  double bb = vec3_norm2(ab), cc = vec3_norm2(ac), bc = vec3_dot(ab, ac);
  double d3 = d1 - bb, d4 = d2 - bc, d5 = d1 - bc, d6 = d2 - cc;
  double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (d1 <= 0 && d2 <= 0) {
  } else if (d3 >= 0 && d4 <= d3) {
    u = 1;
  } else if (d6 >= 0 && d5 <= d6) {
    v = 1;
  } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    u = d1 / (d1 - d3);
  } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    v = d2 / (d2 - d6);
  } else if (va <= 0 && d4 >= d3 && d5 >= d6) {
    v = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    u = 1 - v;
  } else {
    double sum = va + vb + vc;
    u = vb / sum;
    v = vc / sum;
  }
  return vec3_norm2(vec3_mad(vec3_mad(ap, ab, -u), ac, -v));
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
