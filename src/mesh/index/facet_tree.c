/* A tree of boxes over facets (base/tree.h), with a second kind of bounds.
 *
 * A tree follows the facets wherever they crowd; a grid's one cell size fails where sizes differ by
 * orders of magnitude. Axis-aligned boxes alone fail too where many long thin facets lie side by
 * side at a slant (the sides of a twig): every box overlaps every other. So nodes whose facets are
 * about as long as the node carry a second box along the longest edge and the facet's normal
 * (Gottschalk, Lin and Manocha, "OBBTree", SIGGRAPH 1996, of which only the six face directions are
 * tested). Facets round one vertex, a fan of slivers as on a drawn disc, overlap near it in any
 * box; nodes whose facets all have one vertex are told apart by the directions in which they leave
 * it: where a plane through the vertex keeps two such cones strictly apart, no two of their facets
 * meet elsewhere.
 *
 * Bounds of the second kind are rounded generously outwards, so rounding costs time only. */
#include "mesh/index/facet_tree.h"

#include "base/alloc.h"
#include "base/parallel.h"

#include <float.h>

enum {
  FRAME_FACETS = 2048, /* larger nodes get no second box: there are too few of them to matter */
  NODE_BLOCK = 256,
  NO_VERTEX = UINT32_MAX,
  NO_FRAME = UINT32_MAX,
};

/* A second box is worth its test where it holds less than this share of the first. */
#define FRAME_SHARE 0.3
/* A node's longest edge against its diagonal from which a second box is tried. */
#define FRAME_LENGTH 0.25
/* Relative outward rounding of the second boxes and the cones. */
#define MARGIN 1e-12

typedef struct scree_facet_frame {
  vec3 axis[3];   /* orthonormal */
  vec3 center;    /* of the slanted box */
  double half[3]; /* its half sides */
  uint32_t hub;   /* the vertex that all facets have, or NO_VERTEX */
  vec3 low, high; /* unit directions from it to the opposite edges' ends */
} scree_facet_frame;

/* The facets of a node, order[begin ...], and the longest of their edges, the first in that order.
 */
typedef struct run {
  uint32_t begin, count;
  uint32_t facet; /* that has the edge */
  vec3 edge;
  double length2;
} run;

static vec3 load(const scree_facet_tree *t, uint32_t facet, int k) {
  return scree_mesh_corner(t->mesh, facet, k % 3);
}

static run run_of_leaf(const scree_facet_tree *t, const scree_tree_node *leaf) {
  const uint32_t *order = t->tree.order;
  run r = {.begin = leaf->first, .count = leaf->count, .facet = order[leaf->first]};
  for (uint32_t i = leaf->first; i < leaf->first + leaf->count; i++)
    for (int k = 0; k < 3; k++) {
      vec3 edge = vec3_sub(load(t, order[i], k + 1), load(t, order[i], k));
      double length2 = vec3_norm2(edge);
      if (length2 > r.length2) r.length2 = length2, r.facet = order[i], r.edge = edge;
    }
  return r;
}

static run run_of_both(const run *left, const run *right) {
  run r = right->length2 > left->length2 ? *right : *left;
  r.begin = left->begin;
  r.count = left->count + right->count;
  return r;
}

/* Axes along the edge, along the facet's normal, and across both; false where the facet has no
 * usable normal. */
static bool frame_axes(const scree_facet_tree *t, uint32_t facet, vec3 edge, scree_facet_frame *f) {
  vec3 normal = vec3_triangle_normal(load(t, facet, 0), load(t, facet, 1), load(t, facet, 2));
  f->axis[0] = vec3_unit(edge);
  normal = vec3_mad(normal, f->axis[0], -vec3_dot(normal, f->axis[0]));
  f->axis[1] = vec3_unit(vec3_unit(normal));
  f->axis[2] = vec3_cross(f->axis[0], f->axis[1]);
  return fabs(vec3_norm2(f->axis[2]) - 1) < 1e-9;
}

static double frame_box(const scree_facet_tree *t, const run *n, scree_facet_frame *f) {
  double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
  vec3 origin = load(t, t->tree.order[n->begin], 0);
  for (uint32_t i = n->begin; i < n->begin + n->count; i++)
    for (int k = 0; k < 3; k++) {
      vec3 p = vec3_sub(load(t, t->tree.order[i], k), origin);
      for (int a = 0; a < 3; a++) {
        double d = vec3_dot(p, f->axis[a]);
        low[a] = d < low[a] ? d : low[a];
        high[a] = d > high[a] ? d : high[a];
      }
    }
  double volume = 1, reach = fabs(origin.x) + fabs(origin.y) + fabs(origin.z) + high[0] - low[0];
  f->center = origin;
  for (int a = 0; a < 3; a++) {
    f->half[a] = 0.5 * (high[a] - low[a]) + MARGIN * reach;
    f->center = vec3_mad(f->center, f->axis[a], 0.5 * (low[a] + high[a]));
    volume *= 2 * f->half[a];
  }
  return volume;
}

/* The vertex that all facets of the node have, if any. */
static uint32_t common_vertex(const scree_facet_tree *t, const run *n) {
  const uint32_t *first = t->mesh->triangles + 3 * (size_t)t->tree.order[n->begin];
  for (int k = 0; k < 3; k++) {
    uint32_t i = n->begin;
    for (; i < n->begin + n->count; i++) {
      const uint32_t *c = t->mesh->triangles + 3 * (size_t)t->tree.order[i];
      if (c[0] != first[k] && c[1] != first[k] && c[2] != first[k]) break;
    }
    if (i == n->begin + n->count) return first[k];
  }
  return NO_VERTEX;
}

static void add_cone(const scree_facet_tree *t, const run *n, uint32_t hub, scree_facet_frame *f) {
  vec3 at = vec3_load(t->mesh->positions + 3 * (size_t)hub);
  f->hub = hub;
  f->low = (vec3){2, 2, 2};
  f->high = (vec3){-2, -2, -2};
  for (uint32_t i = n->begin; i < n->begin + n->count; i++)
    for (int k = 0; k < 3; k++) {
      if (t->mesh->triangles[3 * (size_t)t->tree.order[i] + (size_t)k] == hub) continue;
      vec3 d = vec3_unit(vec3_sub(load(t, t->tree.order[i], k), at));
      f->low = vec3_min(f->low, d);
      f->high = vec3_max(f->high, d);
    }
}

/* A second box for the node where that is much the smaller one, or a cone; false: neither helps. */
static bool make_frame(const scree_facet_tree *t, const run *n, const scree_box *bounds,
                       scree_facet_frame *f) {
  vec3 sides = vec3_sub(bounds->high, bounds->low);
  double volume = sides.x * sides.y * sides.z;
  if (n->count > FRAME_FACETS || n->length2 < FRAME_LENGTH * FRAME_LENGTH * vec3_norm2(sides))
    return false;
  *f = (scree_facet_frame){.hub = NO_VERTEX};
  uint32_t hub = n->count > 1 ? common_vertex(t, n) : NO_VERTEX;
  if (!frame_axes(t, n->facet, n->edge, f)) return false;
  bool smaller = frame_box(t, n, f) < FRAME_SHARE * volume;
  if (!smaller && (hub == NO_VERTEX || n->count <= SCREE_LEAF_FACETS / 2)) return false;
  if (hub != NO_VERTEX) add_cone(t, n, hub, f);
  return true;
}

/* Whether one of the three face directions of `a` keeps the slanted boxes apart. */
static bool frames_apart_along(const scree_facet_frame *a, const scree_facet_frame *b) {
  vec3 between = vec3_sub(b->center, a->center);
  for (int i = 0; i < 3; i++) {
    double reach = a->half[i];
    for (int j = 0; j < 3; j++) reach += b->half[j] * fabs(vec3_dot(a->axis[i], b->axis[j]));
    if (fabs(vec3_dot(between, a->axis[i])) > reach * (1 + MARGIN)) return true;
  }
  return false;
}

/* The least value of d . x for x in the cone's box of directions. */
static double cone_least(const scree_facet_frame *c, vec3 d) {
  return d.x * (d.x > 0 ? c->low.x : c->high.x) + d.y * (d.y > 0 ? c->low.y : c->high.y) +
         d.z * (d.z > 0 ? c->low.z : c->high.z);
}

/* A plane through a common hub with the cones strictly on either side. */
static bool cones_apart(const scree_facet_frame *a, const scree_facet_frame *b) {
  if (a->hub == NO_VERTEX || a->hub != b->hub) return false;
  vec3 middle_a = vec3_unit(vec3_add(a->low, a->high));
  vec3 middle_b = vec3_unit(vec3_add(b->low, b->high));
  vec3 d = vec3_sub(middle_a, middle_b);
  return cone_least(a, d) > 1e-9 && cone_least(b, vec3_neg(d)) > 1e-9;
}

bool scree_facet_nodes_apart(const scree_facet_tree *t, uint32_t a, uint32_t b) {
  if (!scree_box_meets(&t->tree.nodes[a].box, &t->tree.nodes[b].box)) return true;
  if (t->frame_of[a] == NO_FRAME || t->frame_of[b] == NO_FRAME) return false;
  const scree_facet_frame *f = &t->frames[t->frame_of[a]], *g = &t->frames[t->frame_of[b]];
  return frames_apart_along(f, g) || frames_apart_along(g, f) || cones_apart(f, g);
}

/* ---- Building ---- */

typedef struct framing {
  scree_facet_tree *tree;
  run *runs; /* by node */
} framing;

static void list_runs(const framing *f) {
  const scree_tree *tree = &f->tree->tree;
  for (size_t i = tree->node_count; i-- > 0;) { /* children come after their parent */
    const scree_tree_node *n = &tree->nodes[i];
    f->runs[i] = n->count ? run_of_leaf(f->tree, n)
                          : run_of_both(&f->runs[n->first], &f->runs[n->first + 1]);
  }
}

/* Which nodes get a frame. */
static void try_block(void *context, scree_block block) {
  const framing *f = context;
  scree_facet_tree *t = f->tree;
  scree_facet_frame made;
  for (size_t i = block.begin; i < block.end; i++)
    t->frame_of[i] = make_frame(t, &f->runs[i], &t->tree.nodes[i].box, &made) ? 0 : NO_FRAME;
}

static void make_block(void *context, scree_block block) {
  const framing *f = context;
  scree_facet_tree *t = f->tree;
  for (size_t i = block.begin; i < block.end; i++)
    if (t->frame_of[i] != NO_FRAME)
      make_frame(t, &f->runs[i], &t->tree.nodes[i].box, &t->frames[t->frame_of[i]]);
}

static scree_status add_frames(scree_facet_tree *t, scree_error *error) {
  size_t nodes = t->tree.node_count;
  SCREE_SCRATCH(run, runs, nodes, error);
  framing f = {.tree = t, .runs = runs};
  SCREE_TRY_ALLOC(t->frame_of, nodes, error);
  list_runs(&f);
  scree_parallel_for(nodes, NODE_BLOCK, try_block, &f);
  for (size_t i = 0; i < nodes; i++)
    if (t->frame_of[i] != NO_FRAME) t->frame_of[i] = (uint32_t)t->frame_count++;
  SCREE_TRY_ALLOC(t->frames, t->frame_count, error);
  scree_parallel_for(nodes, NODE_BLOCK, make_block, &f);
  return SCREE_OK;
}

scree_status scree_facet_tree_build(const scree_mesh *mesh, scree_facet_tree *out,
                                    scree_error *error) {
  const scree_boxed facets = {mesh->triangle_count, scree_box_of_facet, mesh, SCREE_LEAF_FACETS,
                              SCREE_SPLIT_HALVES};
  SCREE_CLEANUP(scree_facet_tree_free) scree_facet_tree t = {.mesh = mesh};
  SCREE_TRY(scree_tree_build(&facets, &t.tree, error));
  SCREE_TRY(add_frames(&t, error));
  *out = t;
  t = (scree_facet_tree){0};
  return SCREE_OK;
}

void scree_facet_tree_free(scree_facet_tree *tree) {
  scree_tree_free(&tree->tree);
  scree_free(tree->frame_of);
  scree_free(tree->frames);
  *tree = (scree_facet_tree){0};
}
