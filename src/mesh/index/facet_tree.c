/* A tree of boxes over facets, cut at the middle of the facets' middles, or near their median where
 * that is lopsided.
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
 * Bounds of the second kind are rounded generously outwards, so rounding costs time only. The tree
 * depends on the mesh alone: it is cut from the root on into parts, all of one depth at a time;
 * threads build these, and they are put in the order in which one thread would have built all. */
#include "mesh/index/facet_tree.h"

#include "base/array.h"
#include "base/parallel.h"

#include <float.h>
#include <string.h>

enum {
  PART_FACETS = 1 << 12, /* smaller nodes are built by one thread; not below the next */
  FRAME_FACETS = 2048,   /* larger nodes get no second box: there are too few of them to matter */
  LOPSIDED = 8,          /* a split leaving less than 1/8 on a side is replaced by the median */
  NO_VERTEX = UINT32_MAX,
  NO_FRAME = UINT32_MAX,
  NO_CONE = UINT32_MAX,
};

/* Room for nodes, per facet: scans have .62 to .66. */
#define NODE_SHARE 0.7
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
  uint32_t cone;  /* or NO_CONE */
} scree_facet_frame;

typedef struct scree_facet_cone {
  uint32_t hub;   /* the vertex that all facets have */
  vec3 low, high; /* unit directions from it to the opposite edges' ends */
} scree_facet_cone;

/* ---- Building ---- */

scree_box scree_facet_box(const scree_mesh *mesh, uint32_t t) {
  vec3 p = scree_mesh_corner(mesh, t, 0), q = scree_mesh_corner(mesh, t, 1),
       r = scree_mesh_corner(mesh, t, 2);
  return scree_box_join(scree_box_of(p, q), (scree_box){r, r});
}

static double along(const scree_facet_tree *t, uint32_t facet, int axis) {
  return vec3_along(t->middle[facet], axis);
}

/* Moves facets whose middle lies below `at` to the front; returns how many. */
static size_t partition(scree_facet_tree *t, size_t begin, size_t end, int axis, double at) {
  size_t write = begin;
  for (size_t i = begin; i < end; i++) {
    uint32_t facet = t->order[i];
    if (along(t, facet, axis) >= at) continue;
    t->order[i] = t->order[write];
    t->order[write++] = facet;
  }
  return write - begin;
}

/* A pivot near the median: the median of up to 1023 middles taken at even steps. */
static double middle_value(const scree_facet_tree *t, size_t begin, size_t end, int axis) {
  double sample[1023] = {0};
  size_t count = end - begin < 1023 ? end - begin : 1023;
  for (size_t i = 0; i < count; i++) {
    double value = along(t, t->order[begin + (end - begin) * i / count], axis);
    size_t j = i;
    if (count <= 64) {
      for (; j > 0 && sample[j - 1] > value; j--) sample[j] = sample[j - 1];
    }
    sample[j] = value;
  }
  if (count <= 64) return sample[count / 2];
  /* quickselect */
  size_t low = 0, high = count - 1, want = count / 2;
  while (low < high) {
    double pivot = sample[low + (high - low) / 2];
    size_t i = low, j = high;
    for (;; i++, j--) {
      while (sample[i] < pivot) i++;
      while (sample[j] > pivot) j--;
      if (i >= j) break;
      double keep = sample[i];
      sample[i] = sample[j];
      sample[j] = keep;
    }
    if (want <= j)
      high = j;
    else
      low = j + 1;
  }
  return sample[want];
}

/* Cuts [begin, end) in two; returns the size of the first part, neither part empty. */
static size_t cut(scree_facet_tree *t, size_t begin, size_t end) {
  vec3 low = t->middle[t->order[begin]], high = low;
  for (size_t i = begin + 1; i < end; i++) {
    low = vec3_min(low, t->middle[t->order[i]]);
    high = vec3_max(high, t->middle[t->order[i]]);
  }
  vec3 size = vec3_sub(high, low);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  double from = axis == 0 ? low.x : axis == 1 ? low.y : low.z;
  double length = axis == 0 ? size.x : axis == 1 ? size.y : size.z;
  size_t count = end - begin, first = partition(t, begin, end, axis, from + 0.5 * length);
  if (first >= count / LOPSIDED && count - first >= count / LOPSIDED && first && first < count)
    return first;
  first = partition(t, begin, end, axis, middle_value(t, begin, end, axis));
  if (first >= count / LOPSIDED && count - first >= count / LOPSIDED && first && first < count)
    return first;
  return count / 2; /* middles coincide: any halves will do */
}

/* ---- Second boxes ---- */

static vec3 load(const scree_facet_tree *t, uint32_t facet, int k) {
  return scree_mesh_corner(t->mesh, facet, k % 3);
}

/* The longest edge of some facets, and which of them has it: the first. */
typedef struct longest {
  double length2;
  uint32_t facet;
  vec3 edge;
} longest;

static longest longest_in_leaf(const scree_facet_tree *t, const scree_facet_node *n) {
  longest l = {.facet = t->order[n->begin]};
  for (uint32_t i = n->begin; i < n->begin + n->count; i++)
    for (int k = 0; k < 3; k++) {
      vec3 edge = vec3_sub(load(t, t->order[i], k + 1), load(t, t->order[i], k));
      double length2 = vec3_norm2(edge);
      if (length2 > l.length2) l = (longest){length2, t->order[i], edge};
    }
  return l;
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

static double frame_box(const scree_facet_tree *t, const scree_facet_node *n,
                        scree_facet_frame *f) {
  double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
  vec3 origin = load(t, t->order[n->begin], 0);
  for (uint32_t i = n->begin; i < n->begin + n->count; i++)
    for (int k = 0; k < 3; k++) {
      vec3 p = vec3_sub(load(t, t->order[i], k), origin);
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
static uint32_t common_vertex(const scree_facet_tree *t, const scree_facet_node *n) {
  const uint32_t *first = t->mesh->triangles + 3 * (size_t)t->order[n->begin];
  for (int k = 0; k < 3; k++) {
    uint32_t i = n->begin;
    for (; i < n->begin + n->count; i++) {
      const uint32_t *c = t->mesh->triangles + 3 * (size_t)t->order[i];
      if (c[0] != first[k] && c[1] != first[k] && c[2] != first[k]) break;
    }
    if (i == n->begin + n->count) return first[k];
  }
  return NO_VERTEX;
}

static scree_facet_cone cone_of(const scree_facet_tree *t, const scree_facet_node *n,
                                uint32_t hub) {
  vec3 at = vec3_load(t->mesh->positions + 3 * (size_t)hub);
  scree_facet_cone c = {hub, {2, 2, 2}, {-2, -2, -2}};
  for (uint32_t i = n->begin; i < n->begin + n->count; i++)
    for (int k = 0; k < 3; k++) {
      if (t->mesh->triangles[3 * (size_t)t->order[i] + (size_t)k] == hub) continue;
      vec3 d = vec3_unit(vec3_sub(load(t, t->order[i], k), at));
      c.low = vec3_min(c.low, d);
      c.high = vec3_max(c.high, d);
    }
  return c;
}

/* Gives the node a second box where that is much the smaller one, or a cone. */
static bool add_frame(scree_facet_tree *t, scree_facet_node *n, const longest *l) {
  vec3 sides = vec3_sub(n->bounds.high, n->bounds.low);
  double volume = sides.x * sides.y * sides.z;
  scree_facet_frame f = {.cone = NO_CONE};
  if (sqrt(l->length2) < FRAME_LENGTH * vec3_norm(sides)) return true;
  uint32_t hub = n->count > 1 ? common_vertex(t, n) : NO_VERTEX;
  bool useful = hub != NO_VERTEX && n->count > SCREE_LEAF_FACETS / 2;
  if (!frame_axes(t, l->facet, l->edge, &f)) return true;
  if (frame_box(t, n, &f) < FRAME_SHARE * volume) useful = true;
  if (!useful) return true;
  if (hub != NO_VERTEX) {
    f.cone = (uint32_t)t->cones.count;
    if (!SCREE_PUSH(&t->cones, cone_of(t, n, hub))) return false;
  }
  n->frame = (uint32_t)t->frames.count;
  return SCREE_PUSH(&t->frames, f);
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
static double cone_least(const scree_facet_cone *c, vec3 d) {
  return d.x * (d.x > 0 ? c->low.x : c->high.x) + d.y * (d.y > 0 ? c->low.y : c->high.y) +
         d.z * (d.z > 0 ? c->low.z : c->high.z);
}

/* A plane through a common hub with the cones strictly on either side. */
static bool cones_apart(const scree_facet_cone *a, const scree_facet_cone *b) {
  if (a->hub != b->hub) return false;
  vec3 middle_a = vec3_unit(vec3_add(a->low, a->high));
  vec3 middle_b = vec3_unit(vec3_add(b->low, b->high));
  vec3 d = vec3_sub(middle_a, middle_b);
  return cone_least(a, d) > 1e-9 && cone_least(b, vec3_neg(d)) > 1e-9;
}

bool scree_facet_nodes_apart(const scree_facet_tree *t, const scree_facet_node *a,
                             const scree_facet_node *b) {
  if (!scree_box_meets(&a->bounds, &b->bounds)) return true;
  if (a->frame == NO_FRAME || b->frame == NO_FRAME) return false;
  const scree_facet_frame *f = &t->frames.items[a->frame], *g = &t->frames.items[b->frame];
  if (frames_apart_along(f, g) || frames_apart_along(g, f)) return true;
  return f->cone != NO_CONE && g->cone != NO_CONE &&
         cones_apart(&t->cones.items[f->cone], &t->cones.items[g->cone]);
}

static void leaf_bounds(const scree_facet_tree *t, scree_facet_node *n) {
  n->bounds = scree_facet_box(t->mesh, t->order[n->begin]);
  for (uint32_t i = n->begin + 1; i < n->begin + n->count; i++)
    n->bounds = scree_box_join(n->bounds, scree_facet_box(t->mesh, t->order[i]));
}

/* Builds the node of [begin, end) and all below it; tells its longest edge. */
static bool build(scree_facet_tree *t, uint32_t begin, uint32_t end, longest *l) {
  scree_facet_node n = {.begin = begin, .count = end - begin, .frame = NO_FRAME};
  uint32_t index = (uint32_t)t->nodes.count;
  if (!SCREE_PUSH(&t->nodes, n)) return false;
  if (n.count <= SCREE_LEAF_FACETS) {
    leaf_bounds(t, &n);
    *l = longest_in_leaf(t, &n);
  } else {
    longest r;
    uint32_t split = begin + (uint32_t)cut(t, begin, end);
    if (!build(t, begin, split, l)) return false;
    n.right = (uint32_t)t->nodes.count;
    if (!build(t, split, end, &r)) return false;
    if (r.length2 > l->length2) *l = r;
    n.bounds = scree_box_join(t->nodes.items[index + 1].bounds, t->nodes.items[n.right].bounds);
  }
  if (n.count <= FRAME_FACETS && !add_frame(t, &n, l)) return false;
  t->nodes.items[index] = n;
  return true;
}

static void middle_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block;
  (void)worker;
  scree_facet_tree *t = context;
  for (size_t i = begin; i < end; i++) {
    scree_box b = scree_facet_box(t->mesh, (uint32_t)i);
    t->order[i] = (uint32_t)i;
    t->middle[i] = vec3_lerp(b.low, b.high, 0.5);
  }
}

/* ---- Building in parallel ---- */

/* A node near the root, or a part: what one thread builds with all below it. */
typedef struct top {
  uint32_t begin, end; /* of order[] */
  uint32_t left;       /* its children are tops[left] and tops[left + 1]; 0: it is a part */
  bool failed;
  scree_facet_tree part;    /* its nodes, frames and cones, numbered from 0 */
  size_t node, frame, cone; /* where they go in the whole tree */
} top;

typedef struct tops {
  scree_facet_tree *tree;
  struct {
    top *items;
    size_t count, capacity;
  } list;
  size_t level; /* the first of the tops that are being cut */
} tops;

static void cut_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  tops *p = context;
  for (size_t i = begin; i < end; i++) {
    top *t = &p->list.items[p->level + i];
    t->left = t->end - t->begin > PART_FACETS ? (uint32_t)cut(p->tree, t->begin, t->end) : 0;
  }
}

/* Cuts what is larger than a part, all of one depth at a time. */
static bool cut_tops(tops *p) {
  if (!SCREE_PUSH(&p->list, (top){.end = (uint32_t)p->tree->mesh->triangle_count})) return false;
  for (size_t end = p->list.count; p->level < end; end = p->list.count) {
    scree_parallel_for(end - p->level, 1, cut_block, p);
    for (; p->level < end; p->level++) {
      top *t = &p->list.items[p->level];
      uint32_t begin = t->begin, split = begin + t->left, stop = t->end;
      if (!t->left) continue;
      t->left = (uint32_t)p->list.count;
      if (!SCREE_PUSH(&p->list, (top){.begin = begin, .end = split}) ||
          !SCREE_PUSH(&p->list, (top){.begin = split, .end = stop}))
        return false;
    }
  }
  return true;
}

static void build_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  tops *p = context;
  for (size_t i = begin; i < end; i++) {
    top *t = &p->list.items[i];
    if (t->left) continue;
    t->part = (scree_facet_tree){
        .mesh = p->tree->mesh, .order = p->tree->order, .middle = p->tree->middle};
    size_t room = (size_t)(NODE_SHARE * (double)(t->end - t->begin)) + 1;
    longest l;
    t->failed = !SCREE_RESERVE(&t->part.nodes, room) || !build(&t->part, t->begin, t->end, &l);
  }
}

/* Numbers the nodes of tops[index] and all below it, depth first, from where the tree ends. */
static bool place_top(tops *p, size_t index) {
  scree_facet_tree *tree = p->tree;
  top *t = &p->list.items[index];
  t->node = tree->nodes.count;
  t->frame = tree->frames.count;
  t->cone = tree->cones.count;
  tree->nodes.count += t->left ? 1 : t->part.nodes.count;
  tree->frames.count += t->part.frames.count;
  tree->cones.count += t->part.cones.count;
  if (!t->left) return !t->failed;
  uint32_t left = t->left;
  return place_top(p, left) && place_top(p, left + 1);
}

/* Room for what was counted, and no more. */
static bool make_room(scree_facet_tree *t) {
  return SCREE_RESERVE(&t->nodes, t->nodes.count) && SCREE_RESERVE(&t->frames, t->frames.count) &&
         SCREE_RESERVE(&t->cones, t->cones.count);
}

static void free_part(scree_facet_tree *part) {
  scree_free(part->nodes.items);
  scree_free(part->frames.items);
  scree_free(part->cones.items);
  *part = (scree_facet_tree){0};
}

static void copy_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  tops *p = context;
  for (size_t i = begin; i < end; i++) {
    top *t = &p->list.items[i];
    const scree_facet_tree *part = &t->part;
    for (size_t k = 0; k < part->nodes.count; k++) {
      scree_facet_node n = part->nodes.items[k];
      if (n.right) n.right += (uint32_t)t->node;
      if (n.frame != NO_FRAME) n.frame += (uint32_t)t->frame;
      p->tree->nodes.items[t->node + k] = n;
    }
    for (size_t k = 0; k < part->frames.count; k++) {
      scree_facet_frame f = part->frames.items[k];
      if (f.cone != NO_CONE) f.cone += (uint32_t)t->cone;
      p->tree->frames.items[t->frame + k] = f;
    }
    if (part->cones.count > 0)
      memcpy(p->tree->cones.items + t->cone, part->cones.items,
             part->cones.count * sizeof *part->cones.items);
    free_part(&t->part); /* not all are held twice */
  }
}

/* The nodes above the parts; children come after them. */
static void join_tops(const tops *p) {
  scree_facet_node *nodes = p->tree->nodes.items;
  for (size_t i = p->list.count; i-- > 0;) {
    const top *t = &p->list.items[i];
    if (!t->left) continue;
    scree_facet_node n = {.begin = t->begin,
                          .count = t->end - t->begin,
                          .right = (uint32_t)p->list.items[t->left + 1].node,
                          .frame = NO_FRAME};
    n.bounds = scree_box_join(nodes[t->node + 1].bounds, nodes[n.right].bounds);
    nodes[t->node] = n;
  }
}

/* The whole of it, of facets whose middles are known. */
static bool build_all(scree_facet_tree *tree) {
  tops p = {.tree = tree};
  bool built = cut_tops(&p);
  if (built) {
    scree_parallel_for(p.list.count, 1, build_block, &p);
    built = place_top(&p, 0) && make_room(tree);
  }
  if (built) {
    scree_parallel_for(p.list.count, 1, copy_block, &p);
    join_tops(&p);
  }
  for (size_t i = 0; i < p.list.count; i++) free_part(&p.list.items[i].part);
  scree_free(p.list.items);
  return built;
}

scree_status scree_facet_tree_build(const scree_mesh *mesh, scree_facet_tree *out,
                                    scree_error *error) {
  scree_facet_tree t = {.mesh = mesh};
  SCREE_ALLOC_OR(t.order, mesh->triangle_count, error, out_of_memory);
  SCREE_ALLOC_OR(t.middle, mesh->triangle_count, error, out_of_memory);
  scree_parallel_for(mesh->triangle_count, 1 << 14, middle_block, &t);
  bool built = build_all(&t);
  scree_free(t.middle);
  t.middle = NULL;
  if (!built) {
    scree_fail_memory(error, t.nodes.count * sizeof(scree_facet_node), "the tree of facets");
    goto out_of_memory;
  }
  *out = t;
  return SCREE_OK;
out_of_memory:
  scree_facet_tree_free(&t);
  return SCREE_OUT_OF_MEMORY;
}

void scree_facet_tree_free(scree_facet_tree *tree) {
  scree_free(tree->order);
  scree_free(tree->middle);
  scree_free(tree->nodes.items);
  scree_free(tree->frames.items);
  scree_free(tree->cones.items);
  *tree = (scree_facet_tree){0};
}
