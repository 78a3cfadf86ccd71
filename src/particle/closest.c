/* Closest points.
 *
 * Point to triangle: barycentric coordinates of the projection, then the regions of Ericson (2005,
 * 5.1.5), from what a face keeps for all its queries: contacts ask of the same faces in every step,
 * meshes (mesh/index/closest.h) of each a few times. Point to surface: depth-first through the box
 * tree, nearer child first. */
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
    near->next = scree_min(near->next, distance);
    return;
  }
  if (near->count == SCREE_NEAR_FACES)
    near->next = scree_min(near->next, near->distance[--near->count]);
  int i = near->count++;
  for (; i > 0 && near->distance[i - 1] > distance; i--) {
    near->distance[i] = near->distance[i - 1];
    near->face[i] = near->face[i - 1];
  }
  near->distance[i] = distance;
  near->face[i] = face;
}

static double near_bound(const scree_near *near, double reach, double slack) {
  double bound = near->count ? scree_smaller(reach, near->distance[0] + slack) : reach;
  return scree_smaller(bound, near->next);
}

void scree_closest_faces(const scree_particle *particle, vec3 p, double reach, double slack,
                         scree_near *near) {
  near->count = 0;
  near->next = INFINITY;
  const scree_tree *tree = &particle->face_tree;
  scree_tree_search search;
  scree_tree_search_below(&search, tree, 0, p);
  for (;;) {
    double bound = near_bound(near, reach, slack);
    const scree_tree_node *leaf = scree_tree_nearer(&search, bound * bound);
    if (!leaf) break;
    const uint32_t *faces = &tree->order[leaf->first];
    for (uint32_t k = 0; k < leaf->count; k++)
      scree_prefetch(&particle->faces[faces[k]], sizeof(scree_face));
    for (uint32_t k = 0; k < leaf->count; k++) {
      int region;
      vec3 c = scree_closest_on_face(&particle->faces[faces[k]], p, &region);
      insert_near(near, faces[k], vec3_distance(p, c));
    }
  }
  double bound = near->count ? scree_smaller(reach, near->distance[0] + slack) : reach;
  near->next = scree_smaller(near->next, sqrt(search.passed2));
  while (near->count > 0 && near->distance[near->count - 1] > bound)
    near->next = scree_smaller(near->next, near->distance[--near->count]);
}

/* Below one node: distance and face of what is nearer than *best2; or of the first that is nearer
 * than `enough2`. */
static void nearest_below(const scree_particle *particle, uint32_t start, vec3 p, double enough2,
                          double *best2, uint32_t *face) {
  const scree_tree *tree = &particle->face_tree;
  scree_tree_search search;
  scree_tree_search_below(&search, tree, start, p);
  for (const scree_tree_node *leaf; (leaf = scree_tree_nearer(&search, *best2));)
    for (uint32_t k = 0; k < leaf->count; k++) {
      uint32_t f = tree->order[leaf->first + k];
      int region;
      double d2 = vec3_norm2(vec3_sub(p, scree_closest_on_face(&particle->faces[f], p, &region)));
      if (d2 >= *best2) continue;
      *best2 = d2;
      *face = f;
      if (d2 < enough2) return;
    }
}

double scree_nearest_face(const scree_particle *particle, const uint32_t *nodes, int node_count,
                          vec3 p, double reach, uint32_t *face) {
  double best2 = reach * reach;
  for (int i = 0; i < node_count; i++) nearest_below(particle, nodes[i], p, 0, &best2, face);
  return best2 < reach * reach ? sqrt(best2) : INFINITY;
}

bool scree_is_near(const scree_particle *particle, vec3 p, double reach) {
  const double reach2 = reach * reach;
  double best2 = reach2;
  uint32_t face;
  nearest_below(particle, 0, p, reach2, &best2, &face);
  return best2 < reach2;
}

/* ---- inside or outside ---- */

/* The ray's direction, along no side or diagonal of a box. */
static const vec3 ray = {0.35355339, 0.21650635, 1};

/* A point as seen against the ray: its place beside it. Of one vertex it is the same to the last
 * bit in all faces that share it. */
typedef struct sight {
  double u, v;
} sight;

static sight sight_of(const double *at, vec3 p) {
  double along = at[2] - p.z;
  return (sight){at[0] - p.x - ray.x * along, at[1] - p.y - ray.y * along};
}

/* How often the way from a to b crosses what lies beyond the ray along u, upwards; of the way back
 * the opposite, however it is rounded. So what neighbouring faces make of their common edge
 * cancels, and a closed surface is counted rightly wherever the ray meets its edges and vertices.
 */
static int crossing_of(sight a, sight b) {
  if ((a.v > 0) == (b.v > 0)) return 0;
  double side = a.u * b.v - a.v * b.u;
  return b.v > 0 ? side > 0 : -(side < 0);
}

/* 1 where the ray leaves by the face, -1 where it enters, else 0. */
static int passage(const scree_particle *particle, uint32_t f, vec3 p) {
  const double *positions = particle->core ? particle->core : particle->mesh.positions;
  const uint32_t *t = &particle->mesh.triangles[3 * (size_t)f];
  sight a = sight_of(&positions[3 * (size_t)t[0]], p),
        b = sight_of(&positions[3 * (size_t)t[1]], p),
        c = sight_of(&positions[3 * (size_t)t[2]], p);
  int turn = crossing_of(a, b) + crossing_of(b, c) + crossing_of(c, a);
  if (turn == 0) return 0;
  const scree_face *face = &particle->faces[f];
  return turn * vec3_dot(face->normal, vec3_sub(face->corner, p)) > 0 ? turn : 0;
}

/* Whether the ray from p may meet the box, which is wider by `slack` than what it holds. */
static bool meets_ray(const scree_box *box, vec3 p, double slack) {
  double from = 0, to = box->high.z - p.z + slack;
  from = scree_max(from, box->low.z - p.z - slack);
  from = scree_max(from, (box->low.x - p.x - slack) * (1 / ray.x));
  to = scree_min(to, (box->high.x - p.x + slack) * (1 / ray.x));
  from = scree_max(from, (box->low.y - p.y - slack) * (1 / ray.y));
  to = scree_min(to, (box->high.y - p.y + slack) * (1 / ray.y));
  return from <= to;
}

bool scree_is_inside(const scree_particle *particle, vec3 p) {
  const scree_tree *tree = &particle->face_tree;
  const scree_box *whole = &tree->nodes[0].box;
  if (scree_box_distance2(whole, p) > 0) return particle->hollow;
  vec3 extent = vec3_sub(whole->high, whole->low);
  double slack = 1e-12 * (extent.x + extent.y + extent.z + vec3_norm(whole->low));
  int turns = 0;
  scree_tree_walk walk;
  scree_tree_start(&walk, tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    if (!meets_ray(&node->box, p, slack) || scree_tree_enter(&walk, node)) continue;
    for (uint32_t k = 0; k < node->count; k++)
      turns += passage(particle, tree->order[node->first + k], p);
  }
  return turns + particle->hollow > 0;
}

/* Where the way passes through a face's plane within its borders; else INFINITY. */
static double passage_of(const scree_face *face, const scree_ray_interval *way, double slope) {
  const double slack = 1e-12; /* so that no way slips through between two faces */
  double s = vec3_dot(vec3_sub(face->corner, way->start), face->normal) / slope;
  if (!(s > way->after && s <= way->before)) return INFINITY;
  vec3 w = vec3_sub(vec3_mad(way->start, way->along, s), face->corner);
  double d1 = vec3_dot(w, face->along1), d2 = vec3_dot(w, face->along2);
  double u = (face->d22 * d1 - face->d12 * d2) * face->inverse,
         v = (face->d11 * d2 - face->d12 * d1) * face->inverse;
  return u >= -slack && v >= -slack && u + v <= 1 + slack ? s : INFINITY;
}

double scree_next_passage(const scree_particle *particle, const scree_ray_interval *way,
                          double least, size_t skip, uint32_t *face) {
  const scree_tree *tree = &particle->face_tree;
  double next = INFINITY, slack = 1e-12 * particle->measures.bounding_radius;
  scree_tree_walk walk;
  scree_tree_start(&walk, tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    const scree_box box = scree_box_grown(node->box, slack);
    double from = way->after, to = scree_smaller(way->before, next);
    if (!scree_box_cut(&box, way->start, way->along, &from, &to) || scree_tree_enter(&walk, node))
      continue;
    for (uint32_t k = 0; k < node->count; k++) {
      uint32_t f = tree->order[node->first + k];
      double slope = vec3_dot(particle->faces[f].normal, way->along);
      if (f == skip || slope == 0 || (least > 0 && slope < least)) continue;
      double s = passage_of(&particle->faces[f], way, slope);
      if (s >= next) continue;
      next = s;
      *face = f;
    }
  }
  return next;
}
