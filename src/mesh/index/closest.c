/* After Ericson, "Real-Time Collision Detection", 5.1.5, with a special case for needles. */
#include "mesh/index/closest.h"

static vec3 closest_on_segment(vec3 a, vec3 b, vec3 p) {
  vec3 ab = vec3_sub(b, a);
  double length2 = vec3_norm2(ab), along = vec3_dot(vec3_sub(p, a), ab);
  if (along <= 0 || length2 == 0) return a;
  return along >= length2 ? b : vec3_mad(a, ab, along / length2);
}

/* Where a triangle is a needle its normal is mostly rounding: the edges decide, and the inside only
 * where it is nearer still. */
static vec3 closest_on_needle(const vec3 corner[3], vec3 p, vec3 inside) {
  const vec3 candidate[4] = {closest_on_segment(corner[0], corner[1], p),
                             closest_on_segment(corner[1], corner[2], p),
                             closest_on_segment(corner[2], corner[0], p), inside};
  int best = 0;
  for (int i = 1; i < 4; i++)
    if (vec3_norm2(vec3_sub(candidate[i], p)) < vec3_norm2(vec3_sub(candidate[best], p))) best = i;
  return candidate[best];
}

/* The nearest point lies on an edge that p is beyond: one whose opposite corner has a negative
 * barycentric coordinate. */
static vec3 closest_on_outline(const vec3 corner[3], const double weight[3], vec3 p) {
  vec3 nearest = corner[0];
  double least = INFINITY;
  for (int k = 0; k < 3; k++) {
    if (weight[k] >= 0) continue;
    vec3 tried = closest_on_segment(corner[(k + 1) % 3], corner[(k + 2) % 3], p);
    double distance2 = vec3_norm2(vec3_sub(tried, p));
    if (distance2 < least) least = distance2, nearest = tried;
  }
  return nearest;
}

#define NEEDLE 1e-10 /* squared height over squared length, below which an own way is taken */

double scree_triangle_closest(const double corners[9], vec3 p, vec3 *point) {
  const vec3 corner[3] = {vec3_load(corners), vec3_load(corners + 3), vec3_load(corners + 6)};
  vec3 ab = vec3_sub(corner[1], corner[0]), ac = vec3_sub(corner[2], corner[0]),
       ap = vec3_sub(p, corner[0]), normal = vec3_cross(ab, ac);
  double squared = vec3_norm2(normal);
  /* barycentric coordinates of the foot of p, times squared */
  double v = vec3_dot(vec3_cross(ap, ac), normal), w = vec3_dot(vec3_cross(ab, ap), normal);
  const double weight[3] = {squared - v - w, v, w};
  bool above = squared > 0 && weight[0] >= 0 && v >= 0 && w >= 0;
  vec3 inside = above ? vec3_mad(vec3_mad(corner[0], ab, v / squared), ac, w / squared) : corner[0];
  double longer2 = scree_larger(vec3_norm2(ab), vec3_norm2(ac));
  if (squared <= NEEDLE * (longer2 * longer2))
    *point = closest_on_needle(corner, p, inside);
  else
    *point = above ? inside : closest_on_outline(corner, weight, p);
  return vec3_norm2(vec3_sub(p, *point));
}
