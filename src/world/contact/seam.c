/* Where the surfaces of two bodies cross, and the way apart of those that are in each other: along
 * the area vector of their seam.
 *
 * The part of b's surface that lies inside a is bounded by the seam, the closed line along which
 * the surfaces cross. Its area as a vector is sum of p x q/2 over the seam's segments from p to q,
 * whatever surface the seam bounds, and it is the gradient of the common volume by a's place:
 * moved along it, a leaves b the fastest. */
#include "world/contact/contact.h"

typedef struct triangle {
  vec3 corner[3], normal;
} triangle;

static triangle triangle_of(const scree_face *face) {
  return (triangle){
      {face->corner, vec3_add(face->corner, face->along1), vec3_add(face->corner, face->along2)},
      face->normal};
}

/* Where the segment from p to q passes through the triangle. */
static bool pierces(vec3 p, vec3 q, const triangle *t, vec3 *at) {
  double dp = vec3_dot(vec3_sub(p, t->corner[0]), t->normal),
         dq = vec3_dot(vec3_sub(q, t->corner[0]), t->normal);
  if ((dp < 0) == (dq < 0)) return false;
  vec3 x = vec3_mad(p, vec3_sub(q, p), dp / (dp - dq));
  for (int k = 0; k < 3; k++) {
    vec3 border = vec3_sub(t->corner[(k + 1) % 3], t->corner[k]),
         inward = vec3_cross(t->normal, border);
    if (vec3_dot(inward, vec3_sub(x, t->corner[k])) < 0) return false;
  }
  *at = x;
  return true;
}

/* The seam's segment in two faces, if any. */
static vec3 area_of_segment(const triangle *a, const triangle *b, vec3 about) {
  vec3 at[6];
  int count = 0;
  for (int k = 0; k < 3; k++) {
    count += pierces(a->corner[k], a->corner[(k + 1) % 3], b, &at[count]);
    count += pierces(b->corner[k], b->corner[(k + 1) % 3], a, &at[count]);
  }
  if (count != 2) return (vec3){0, 0, 0};
  vec3 p = vec3_sub(at[0], about), q = vec3_sub(at[1], about),
       forward = vec3_cross(b->normal, a->normal), area = vec3_scale(vec3_cross(p, q), 0.5);
  return vec3_dot(vec3_sub(q, p), forward) < 0 ? vec3_neg(area) : area;
}

/* Whether all of a lies on one side of b's plane. */
static bool is_beside(const triangle *a, const triangle *b) {
  bool below[3];
  for (int k = 0; k < 3; k++)
    below[k] = vec3_dot(vec3_sub(a->corner[k], b->corner[0]), b->normal) < 0;
  return below[0] == below[1] && below[1] == below[2];
}

static bool triangles_cross(const triangle *a, const triangle *b) {
  vec3 at;
  if (is_beside(a, b) || is_beside(b, a)) return false;
  for (int k = 0; k < 3; k++)
    if (pierces(a->corner[k], a->corner[(k + 1) % 3], b, &at) ||
        pierces(b->corner[k], b->corner[(k + 1) % 3], a, &at))
      return true;
  return false;
}

/* ---- the faces that are near each other ---- */

/* Nodes of the face trees of a and of b of which the boxes meet. */
typedef struct meeting {
  uint32_t a, b;
  scree_box box; /* of a's, in the frame of b */
} meeting;

/* Down both trees, and over the faces of the leaves that meet. */
typedef struct descent {
  const scree_particle *a, *b;
  const scree_frame *relative;
  mat3 back; /* the frame of b into a's */
  vec3 shift;
  meeting stack[SCREE_TREE_STACK]; /* one a level of either tree */
  int depth;
  const scree_tree_node *leaf_of_a, *leaf_of_b; /* in hand */
  uint32_t next_of_a, next_of_b;
  triangle of_a, of_b; /* the faces in hand, in the frame of b */
} descent;

/* In either frame the other's box is loose; where they are apart in one they are. */
static void visit(descent *d, uint32_t a, uint32_t b, const scree_box *box) {
  const scree_box *of_a = &d->a->face_tree.nodes[a].box, *of_b = &d->b->face_tree.nodes[b].box;
  if (!scree_box_meets(box, of_b)) return;
  scree_box moved = scree_box_moved(of_b, &d->back, d->shift);
  if (!scree_box_meets(&moved, of_a)) return;
  d->stack[d->depth++] = (meeting){a, b, *box};
}

static scree_box moved_box(const descent *d, uint32_t a) {
  const scree_frame *r = d->relative;
  return scree_box_moved(&d->a->face_tree.nodes[a].box, &r->rotation, r->position);
}

static void begin_descent(descent *d, const scree_particle *a, const scree_particle *b,
                          const scree_frame *relative) {
  d->a = a;
  d->b = b;
  d->relative = relative;
  d->back = mat3_transpose(&relative->rotation);
  d->shift = vec3_neg(mat3_mul_vec(&d->back, relative->position));
  d->depth = 0;
  d->leaf_of_a = NULL;
  d->of_a = d->of_b = (triangle){0};
  scree_box box = moved_box(d, 0);
  visit(d, 0, 0, &box);
}

static double size_of(const scree_box *box) {
  vec3 size = vec3_sub(box->high, box->low);
  return size.x + size.y + size.z;
}

/* Takes the next two leaves of which the boxes meet in hand; false for no more. */
static bool take_leaves(descent *d) {
  while (d->depth > 0) {
    const meeting m = d->stack[--d->depth];
    const scree_tree_node *a = &d->a->face_tree.nodes[m.a], *b = &d->b->face_tree.nodes[m.b];
    if (a->count && b->count) {
      d->leaf_of_a = a;
      d->leaf_of_b = b;
      d->next_of_a = 0;
      d->next_of_b = b->count;
      return true;
    }
    if (b->count || (!a->count && size_of(&m.box) > size_of(&b->box))) {
      scree_box first = moved_box(d, a->first), second = moved_box(d, a->first + 1);
      visit(d, a->first, m.b, &first);
      visit(d, a->first + 1, m.b, &second);
    } else {
      visit(d, m.a, b->first, &m.box);
      visit(d, m.a, b->first + 1, &m.box);
    }
  }
  return false;
}

/* A triangle of a, in the frame of b. */
static triangle moved_triangle(const descent *d, uint32_t place) {
  const scree_frame *r = d->relative;
  triangle t = triangle_of(&d->a->faces[d->a->face_tree.order[place]]);
  t.normal = mat3_mul_vec(&r->rotation, t.normal);
  for (int k = 0; k < 3; k++)
    t.corner[k] = vec3_add(mat3_mul_vec(&r->rotation, t.corner[k]), r->position);
  return t;
}

/* Takes the next two faces in hand of which leaves meet. */
static bool take_faces(descent *d) {
  if (!d->leaf_of_a && !take_leaves(d)) return false;
  while (d->next_of_b == d->leaf_of_b->count) {
    if (d->next_of_a == d->leaf_of_a->count && !take_leaves(d)) return false;
    d->of_a = moved_triangle(d, d->leaf_of_a->first + d->next_of_a++);
    d->next_of_b = 0;
  }
  const scree_tree *tree = &d->b->face_tree;
  d->of_b = triangle_of(&d->b->faces[tree->order[d->leaf_of_b->first + d->next_of_b++]]);
  return true;
}

bool scree_surfaces_cross(const scree_particle *a, const scree_particle *b,
                          const scree_frame *relative) {
  descent d;
  begin_descent(&d, a, b, relative);
  while (take_faces(&d))
    if (triangles_cross(&d.of_a, &d.of_b)) return true;
  return false;
}

vec3 scree_separation_direction(const scree_particle *a, const scree_particle *b,
                                const scree_frame *relative) {
  vec3 area = {0, 0, 0};
  descent d;
  begin_descent(&d, a, b, relative);
  while (take_faces(&d))
    area = vec3_add(area, area_of_segment(&d.of_a, &d.of_b, relative->position));
  return area;
}
