/* Boxes by slabs (Kay and Kajiya 1986), triangles by Moller and Trumbore (1997). */
#include "mesh/index/ray.h"

/* How far, in barycentric coordinates, a ray may pass beside a triangle and still meet it: so that
 * rounding leaves no gap between neighbours. */
static const double RIM = 1e-9;

typedef struct ray {
  vec3 from, along;
  double inverse[3];
} ray;

/* Whether the ray is in the box somewhere between `least` and `most`. */
static bool meets_box(const ray *r, const scree_box *box, double least, double most) {
  const double from[3] = {r->from.x, r->from.y, r->from.z}, *low = &box->low.x,
               *high = &box->high.x;
  for (int k = 0; k < 3; k++) {
    double a = (low[k] - from[k]) * r->inverse[k], b = (high[k] - from[k]) * r->inverse[k];
    if (isnan(a) || isnan(b)) continue; /* along a side of the box, within it */
    least = scree_larger(least, scree_smaller(a, b));
    most = scree_smaller(most, scree_larger(a, b));
  }
  return least <= most;
}

/* The distance to one triangle, INFINITY beside it; *normal is along its outward one. */
static double meet_triangle(const ray *r, const double *corners, vec3 *normal) {
  vec3 origin = vec3_load(corners), e = vec3_sub(vec3_load(corners + 3), origin),
       f = vec3_sub(vec3_load(corners + 6), origin), h = vec3_cross(r->along, f);
  double det = vec3_dot(e, h);
  if (det == 0) return INFINITY;
  vec3 g = vec3_sub(r->from, origin), q = vec3_cross(g, e);
  double u = vec3_dot(g, h) / det, v = vec3_dot(r->along, q) / det;
  if (!(u >= -RIM && v >= -RIM && u + v <= 1 + RIM)) return INFINITY;
  *normal = vec3_cross(e, f);
  return vec3_dot(f, q) / det;
}

double scree_ray_meet(const scree_bvh *bvh, vec3 from, vec3 along, double least, double *facing) {
  const ray r = {from, along, {1 / along.x, 1 / along.y, 1 / along.z}};
  double nearest = INFINITY;
  scree_tree_walk walk;
  scree_tree_start(&walk, &bvh->tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    if (!meets_box(&r, &node->box, least, nearest) || scree_tree_enter(&walk, node)) continue;
    for (uint32_t i = node->first; i < node->first + node->count; i++) {
      vec3 normal = {0, 0, 0};
      double t = meet_triangle(&r, bvh->corners + 9 * (size_t)i, &normal);
      if (!(t > least && t < nearest)) continue;
      nearest = t;
      *facing = vec3_dot(vec3_unit(normal), along);
    }
  }
  return nearest;
}
