/* The way apart of bodies that are in each other: along the area vector of their seam.
 *
 * The part of b's surface that lies inside a is bounded by the seam, the closed line along which
 * the surfaces cross. Its area as a vector is sum of p x q/2 over the seam's segments from p to q,
 * whatever surface the seam bounds, and it is the gradient of the common volume by a's place:
 * moved along it, a leaves b the fastest. */
#include "world/contact.h"

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

static vec3 area_in_face(const triangle *a, const scree_particle *b, vec3 about) {
  vec3 area = {0, 0, 0};
  const scree_tree *tree = &b->face_tree;
  scree_box box = scree_box_of(a->corner[0], a->corner[1]);
  box = scree_box_join(box, (scree_box){a->corner[2], a->corner[2]});
  uint32_t stack[SCREE_TREE_STACK];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const scree_tree_node *node = &tree->nodes[stack[--depth]];
    if (!scree_box_meets(&box, &node->box)) continue;
    for (uint32_t k = 0; k < node->count; k++) {
      triangle other = triangle_of(&b->faces[tree->order[node->first + k]]);
      area = vec3_add(area, area_of_segment(a, &other, about));
    }
    if (node->count) continue;
    stack[depth++] = node->first + 1;
    stack[depth++] = node->first;
  }
  return area;
}

vec3 scree_way_apart(const scree_world *world, const scree_pair *pair,
                     const scree_frame *relative) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  vec3 area = {0, 0, 0};
  for (size_t f = 0; f < a->face_count; f++) {
    triangle face = triangle_of(&a->faces[f]);
    face.normal = mat3_mul_vec(&relative->rotation, face.normal);
    for (int k = 0; k < 3; k++)
      face.corner[k] =
          vec3_add(mat3_mul_vec(&relative->rotation, face.corner[k]), relative->position);
    area = vec3_add(area, area_in_face(&face, b, relative->position));
  }
  return area;
}
