/* The watch: how deep edges of one body lie inside the other, whatever the contact law says.
 *
 * Where two closed surfaces pass through each other, an edge of one passes through a face of the
 * other; where none does, nothing is inside. Else all edges are followed that reach far enough into
 * the other's box. How far a point is from a surface changes by no more than its own way, so that
 * every point tells how far to go on. */
#include "world/world.h"

#include "particle/closest.h"

static const double least_stride = 0.125; /* of the depth that is asked for */

/* The edges of one body against the surface of the other. */
typedef struct side {
  const scree_particle *from, *to;
  mat3 rotation; /* from's frame into to's */
  vec3 shift;
  scree_box within; /* in which lies what is deep enough inside; empty for an open surface */
} side;

/* An edge in the frame of `to`. */
typedef struct line {
  vec3 start, along, inverse; /* 1/along */
  double length;
} line;

static line line_of(const side *s, const scree_edge *edge) {
  vec3 start = vec3_add(mat3_mul_vec(&s->rotation, edge->start), s->shift),
       along = mat3_mul_vec(&s->rotation, edge->along);
  return (line){start, along, {1 / along.x, 1 / along.y, 1 / along.z}, edge->length};
}

/* By the box's slabs. */
static bool line_meets(const line *l, const scree_box *box) {
  vec3 low = vec3_sub(box->low, l->start), high = vec3_sub(box->high, l->start);
  double x0 = low.x * l->inverse.x, x1 = high.x * l->inverse.x, y0 = low.y * l->inverse.y,
         y1 = high.y * l->inverse.y, z0 = low.z * l->inverse.z, z1 = high.z * l->inverse.z;
  double in = scree_larger(scree_larger(scree_smaller(x0, x1), scree_smaller(y0, y1)),
                           scree_smaller(z0, z1)),
         out = scree_smaller(scree_smaller(scree_larger(x0, x1), scree_larger(y0, y1)),
                             scree_larger(z0, z1));
  return in <= out && out >= 0 && in <= l->length;
}

static bool passes_face(const line *l, const scree_face *face) {
  vec3 w = vec3_sub(l->start, face->corner);
  double t = -vec3_dot(w, face->normal) / vec3_dot(l->along, face->normal);
  if (!(t >= 0 && t <= l->length)) return false;
  vec3 x = vec3_mad(w, l->along, t);
  double d1 = vec3_dot(x, face->along1), d2 = vec3_dot(x, face->along2),
         u = (face->d22 * d1 - face->d12 * d2) * face->inverse,
         v = (face->d11 * d2 - face->d12 * d1) * face->inverse;
  return u >= 0 && v >= 0 && u + v <= 1;
}

/* Any face below the node. */
static bool passes_faces(const side *s, const line *l, uint32_t below) {
  const scree_tree *tree = &s->to->face_tree;
  uint32_t stack[SCREE_TREE_STACK];
  int depth = 0;
  stack[depth++] = below;
  while (depth > 0) {
    const scree_tree_node *node = &tree->nodes[stack[--depth]];
    if (!line_meets(l, &node->box)) continue;
    for (uint32_t k = 0; k < node->count; k++)
      if (passes_face(l, &s->to->faces[tree->order[node->first + k]])) return true;
    if (node->count) continue;
    stack[depth++] = node->first + 1;
    stack[depth++] = node->first;
  }
  return false;
}

/* Whether an edge below one node passes through a face below the other. */
static bool surfaces_cross(const side *s, uint32_t e, uint32_t f) {
  const scree_tree_node *edges = &s->from->edge_tree.nodes[e], *faces = s->to->face_tree.nodes;
  scree_box box = scree_box_moved(&edges->box, &s->rotation, s->shift);
  if (!scree_box_meets(&box, &faces[f].box)) return false;
  while (!faces[f].count) { /* while all lies below one child */
    uint32_t first = faces[f].first;
    bool left = scree_box_meets(&box, &faces[first].box),
         right = scree_box_meets(&box, &faces[first + 1].box);
    if (!left && !right) return false;
    if (left && right) break;
    f = left ? first : first + 1;
  }
  for (uint32_t k = 0; k < edges->count; k++) {
    line l = line_of(s, &s->from->edges[s->from->edge_tree.order[edges->first + k]]);
    if (passes_faces(s, &l, f)) return true;
  }
  return !edges->count &&
         (surfaces_cross(s, edges->first, f) || surfaces_cross(s, edges->first + 1, f));
}

/* The deepest point of an edge inside the surface, where it is more than `depth`; else that. */
static double follow(const side *s, const line *l, double depth) {
  const uint32_t root = 0;
  for (double gone = 0; gone <= l->length;) {
    vec3 p = vec3_mad(l->start, l->along, gone);
    uint32_t face;
    double distance = scree_nearest_face(s->to, &root, 1, p, INFINITY, &face);
    if (!(distance < INFINITY)) return depth; /* too far off for its square, or no number */
    int region;
    vec3 offset = vec3_sub(p, scree_closest_on_face(&s->to->faces[face], p, &region));
    if (vec3_dot(offset, scree_outward(s->to, face, region)) >= 0) {
      gone += distance + depth;
      continue;
    }
    if (distance > depth && scree_is_inside(s->to, p)) depth = distance;
    gone += fmax(depth - distance, least_stride * depth);
  }
  return depth;
}

/* The same for all edges below the node. */
static double follow_below(const side *s, uint32_t index, double depth) {
  const scree_tree_node *node = &s->from->edge_tree.nodes[index];
  scree_box box = scree_box_moved(&node->box, &s->rotation, s->shift);
  if (!scree_box_meets(&box, &s->within)) return depth;
  for (uint32_t k = 0; k < node->count; k++) {
    line l = line_of(s, &s->from->edges[s->from->edge_tree.order[node->first + k]]);
    if (line_meets(&l, &s->within)) depth = follow(s, &l, depth);
  }
  if (node->count) return depth;
  return follow_below(s, node->first + 1, follow_below(s, node->first, depth));
}

/* Whether any does reach into the box. */
static bool reaches_within(const side *s, uint32_t index) {
  const scree_tree_node *node = &s->from->edge_tree.nodes[index];
  scree_box box = scree_box_moved(&node->box, &s->rotation, s->shift);
  if (!scree_box_meets(&box, &s->within)) return false;
  for (uint32_t k = 0; k < node->count; k++) {
    line l = line_of(s, &s->from->edges[s->from->edge_tree.order[node->first + k]]);
    if (line_meets(&l, &s->within)) return true;
  }
  return !node->count && (reaches_within(s, node->first) || reaches_within(s, node->first + 1));
}

static side make_side(const scree_particle *from, const scree_particle *to, mat3 rotation,
                      vec3 shift, double least) {
  const vec3 none = {INFINITY, INFINITY, INFINITY};
  bool closed = to->measures.volume > 0;
  return (side){from, to, rotation, shift,
                closed ? scree_box_grown(to->face_tree.nodes[0].box, -least)
                       : (scree_box){none, vec3_neg(none)}};
}

double scree_pair_depth(const scree_world *world, const scree_pair *pair,
                        const scree_frame *relative, double least) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  if (!b || !a->face_count || !a->edge_count || !b->face_count || !b->edge_count) return 0;
  mat3 back = mat3_transpose(&relative->rotation);
  const side sides[2] = {
      make_side(a, b, relative->rotation, relative->position, least),
      make_side(b, a, back, vec3_neg(mat3_mul_vec(&back, relative->position)), least)};
  bool reach[2] = {reaches_within(&sides[0], 0), reaches_within(&sides[1], 0)};
  if (!reach[0] && !reach[1]) return 0;
  if (!surfaces_cross(&sides[0], 0, 0) && !surfaces_cross(&sides[1], 0, 0)) return 0;
  double depth = least;
  for (int k = 0; k < 2; k++)
    if (reach[k]) depth = follow_below(&sides[k], 0, depth);
  return depth > least ? depth : 0;
}
