/* Closest points.
 *
 * Point to triangle: barycentric coordinates of the projection, then the regions of Ericson (2005,
 * 5.1.5). Point to surface: depth-first through the box tree, nearer child first. */
#include "particle/closest.h"

#include "base/prefetch.h"

static vec3 on_edge(vec3 from, vec3 along, vec3 p, double *s) {
  double length2 = vec3_norm2(along);
  *s = length2 > 0 ? vec3_dot(vec3_sub(p, from), along) / length2 : 0;
  *s = *s < 0 ? 0 : *s > 1 ? 1 : *s;
  return vec3_mad(from, along, *s);
}

vec3 scree_closest_on_border(const scree_face *face, vec3 p, int *region) {
  vec3 from[3] = {face->corner, vec3_add(face->corner, face->along1),
                  vec3_add(face->corner, face->along2)};
  vec3 along[3] = {face->along1, vec3_sub(face->along2, face->along1), vec3_neg(face->along2)};
  double best = INFINITY;
  vec3 closest = from[0];
  for (int e = 0; e < 3; e++) {
    double s;
    vec3 c = on_edge(from[e], along[e], p, &s);
    double d2 = vec3_norm2(vec3_sub(p, c));
    if (d2 >= best) continue;
    best = d2;
    closest = c;
    *region = s <= 0   ? (int)SCREE_REGION_CORNER + e
              : s >= 1 ? (int)SCREE_REGION_CORNER + (e + 1) % 3
                       : (int)SCREE_REGION_EDGE + e;
  }
  return closest;
}

/* Keeps the nearest, ascending; what falls off the end bounds `next`. */
static void insert_near(scree_near *near, uint32_t face, double distance) {
  if (near->count == SCREE_NEAR_FACES && distance >= near->distance[near->count - 1]) {
    near->next = fmin(near->next, distance);
    return;
  }
  if (near->count == SCREE_NEAR_FACES) near->next = fmin(near->next, near->distance[--near->count]);
  int i = near->count++;
  for (; i > 0 && near->distance[i - 1] > distance; i--) {
    near->distance[i] = near->distance[i - 1];
    near->face[i] = near->face[i - 1];
  }
  near->distance[i] = distance;
  near->face[i] = face;
}

/* Not by fmin, which is a call. */
static double lesser(double a, double b) {
  return a < b ? a : b;
}

static double near_bound(const scree_near *near, double reach, double slack) {
  double bound = near->count ? lesser(reach, near->distance[0] + slack) : reach;
  return lesser(bound, near->next);
}

typedef struct tree_entry {
  uint32_t node;
  double distance2;
} tree_entry;

void scree_closest_faces(const scree_particle *particle, vec3 p, double reach, double slack,
                         scree_near *near) {
  near->count = 0;
  near->next = INFINITY;
  const scree_tree_node *nodes = particle->face_tree.nodes;
  tree_entry stack[SCREE_TREE_STACK];
  int depth = 0;
  stack[depth++] = (tree_entry){0, scree_box_distance2(&nodes[0].box, p)};
  double pruned2 = INFINITY;
  while (depth > 0) {
    tree_entry entry = stack[--depth];
    double bound = near_bound(near, reach, slack);
    if (entry.distance2 > bound * bound) {
      pruned2 = lesser(pruned2, entry.distance2);
      continue;
    }
    const scree_tree_node *node = &nodes[entry.node];
    if (node->count == 0) {
      uint32_t left = node->first, right = left + 1;
      double dl = scree_box_distance2(&nodes[left].box, p),
             dr = scree_box_distance2(&nodes[right].box, p);
      bool left_first = dl <= dr;
      stack[depth++] = left_first ? (tree_entry){right, dr} : (tree_entry){left, dl};
      stack[depth++] = left_first ? (tree_entry){left, dl} : (tree_entry){right, dr};
      continue;
    }
    const uint32_t *faces = &particle->face_tree.order[node->first];
    for (uint32_t k = 0; k < node->count; k++)
      scree_prefetch(&particle->faces[faces[k]], sizeof(scree_face));
    for (uint32_t k = 0; k < node->count; k++) {
      uint32_t face = faces[k];
      int region;
      vec3 c = scree_closest_on_face(&particle->faces[face], p, &region);
      insert_near(near, face, vec3_distance(p, c));
    }
  }
  double bound = near->count ? lesser(reach, near->distance[0] + slack) : reach;
  near->next = lesser(near->next, sqrt(pruned2));
  while (near->count > 0 && near->distance[near->count - 1] > bound)
    near->next = lesser(near->next, near->distance[--near->count]);
}

/* Below one node, nearer child first: distance and face of what is nearer than *best2. */
static void nearest_below(const scree_particle *particle, uint32_t start, vec3 p, double *best2,
                          uint32_t *face) {
  const scree_tree *tree = &particle->face_tree;
  const scree_tree_node *nodes = tree->nodes;
  tree_entry stack[SCREE_TREE_STACK];
  int depth = 0;
  tree_entry entry = {start, scree_box_distance2(&nodes[start].box, p)};
  for (;;) {
    if (entry.distance2 < *best2) {
      const scree_tree_node *node = &nodes[entry.node];
      if (node->count == 0) { /* on with the nearer child */
        uint32_t left = node->first;
        double dl = scree_box_distance2(&nodes[left].box, p),
               dr = scree_box_distance2(&nodes[left + 1].box, p);
        bool left_first = dl <= dr;
        double nearer = left_first ? dl : dr, farther = left_first ? dr : dl;
        if (farther < *best2) stack[depth++] = (tree_entry){left + left_first, farther};
        entry = (tree_entry){left + !left_first, nearer};
        continue;
      }
      for (uint32_t k = 0; k < node->count; k++) {
        uint32_t f = tree->order[node->first + k];
        int region;
        double d2 = vec3_norm2(vec3_sub(p, scree_closest_on_face(&particle->faces[f], p, &region)));
        if (d2 >= *best2) continue;
        *best2 = d2;
        *face = f;
      }
    }
    if (depth == 0) return;
    entry = stack[--depth];
  }
}

double scree_nearest_face(const scree_particle *particle, const uint32_t *nodes, int node_count,
                          vec3 p, double reach, uint32_t *face) {
  double best2 = reach * reach;
  for (int i = 0; i < node_count; i++) nearest_below(particle, nodes[i], p, &best2, face);
  return best2 < reach * reach ? sqrt(best2) : INFINITY;
}

bool scree_is_inside(const scree_particle *particle, vec3 p) {
  double turns = 0;
  for (size_t f = 0; f < particle->face_count; f++) {
    const scree_face *face = &particle->faces[f];
    vec3 a = vec3_sub(face->corner, p), b = vec3_add(a, face->along1),
         c = vec3_add(a, face->along2);
    double na = vec3_norm(a), nb = vec3_norm(b), nc = vec3_norm(c);
    double top = vec3_dot(a, vec3_cross(b, c));
    double bottom = na * nb * nc + vec3_dot(a, b) * nc + vec3_dot(b, c) * na + vec3_dot(c, a) * nb;
    turns += scree_atan2(top, bottom);
  }
  return turns > 3.14159265358979323846; /* the full turn is 2 pi in half angles */
}

double scree_ray_depth(const scree_particle *particle, vec3 p, vec3 direction, size_t skip_face) {
  double best = INFINITY;
  for (size_t f = 0; f < particle->face_count; f++) {
    const scree_face *face = &particle->faces[f];
    double slope = vec3_dot(face->normal, direction);
    if (f == skip_face || slope < 0.8) continue; /* only walls that stand across */
    double s = vec3_dot(vec3_sub(face->corner, p), face->normal) / slope;
    if (!(s > 0 && s < best)) continue;
    vec3 hit = vec3_mad(p, direction, s), w = vec3_sub(hit, face->corner);
    double d1 = vec3_dot(w, face->along1), d2 = vec3_dot(w, face->along2);
    double u = (face->d22 * d1 - face->d12 * d2) * face->inverse,
           v = (face->d11 * d2 - face->d12 * d1) * face->inverse;
    if (u >= 0 && v >= 0 && u + v <= 1) best = s;
  }
  return best;
}
