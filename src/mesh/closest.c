/* After Ericson, "Real-Time Collision Detection", 5.1.5, with a special case for needles. Side by
 * side the inside and all three edges are looked at, and the same is chosen by the same
 * comparisons; needles are done one by one. */
#include "mesh/closest.h"

#include "base/lanes.h"

#include <string.h>

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

/* Where this is so, `squared` from the corners. */
static bool is_needle(double squared, vec3 ab, vec3 ac) {
  double bb = vec3_norm2(ab), cc = vec3_norm2(ac);
  return squared <= NEEDLE * (bb > cc ? bb * bb : cc * cc);
}

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
  if (is_needle(squared, ab, ac))
    *point = closest_on_needle(corner, p, inside);
  else
    *point = above ? inside : closest_on_outline(corner, weight, p);
  return vec3_norm2(vec3_sub(p, *point));
}

/* ---- Side by side ---- */

/* By bits: else the compiler would come to branches. */
SCREE_LANES_INLINE double choose(bool first, double a, double b) {
  uint64_t x, y, mask = -(uint64_t)first;
  memcpy(&x, &a, sizeof x);
  memcpy(&y, &b, sizeof y);
  x = (x & mask) | (y & ~mask);
  memcpy(&a, &x, sizeof a);
  return a;
}

SCREE_LANES_INLINE vec3 choose_point(bool first, vec3 a, vec3 b) {
  return (vec3){choose(first, a.x, b.x), choose(first, a.y, b.y), choose(first, a.z, b.z)};
}

/* As closest_on_segment: of no length, either end. */
SCREE_LANES_INLINE vec3 on_segment(vec3 a, vec3 b, vec3 p) {
  vec3 ab = vec3_sub(b, a);
  double length2 = vec3_norm2(ab), along = vec3_dot(vec3_sub(p, a), ab);
  vec3 found = vec3_mad(a, ab, choose(along > 0, along / length2, 0));
  return choose_point(along >= length2, b, found);
}

/* The point of a triangle that is no needle. */
SCREE_LANES_INLINE vec3 nearest_lane(vec3 a, vec3 b, vec3 c, vec3 n, double n2, vec3 p,
                                     double *distance2) {
  vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a), ap = vec3_sub(p, a);
  double v = vec3_dot(vec3_cross(ap, ac), n), w = vec3_dot(vec3_cross(ab, ap), n), u = n2 - v - w;
  vec3 inside = vec3_mad(vec3_mad(a, ab, v / n2), ac, w / n2);
  vec3 bc = on_segment(b, c, p), ca = on_segment(c, a, p), found = on_segment(a, b, p);
  /* of the edges only those that p is beyond count, and the first of equals */
  double of_bc = choose(u < 0, vec3_norm2(vec3_sub(bc, p)), INFINITY);
  double of_ca = choose(v < 0, vec3_norm2(vec3_sub(ca, p)), INFINITY);
  double least = choose(w < 0, vec3_norm2(vec3_sub(found, p)), INFINITY);
  bool nearer = of_ca <= least;
  found = choose_point(nearer, ca, found);
  least = choose(nearer, of_ca, least);
  nearer = of_bc <= least;
  found = choose_point(nearer, bc, found);
  found = choose_point((u < 0) | (v < 0) | (w < 0), found, inside);
  *distance2 = vec3_norm2(vec3_sub(p, found));
  return found;
}

void scree_fours_fill(const double (*corners)[9], size_t count, scree_four *fours) {
  for (size_t i = 0; i < SCREE_FOUR * scree_four_count(count); i++) {
    const double *from = corners[i < count ? i : count - 1];
    scree_four *four = &fours[i / SCREE_FOUR];
    size_t lane = i % SCREE_FOUR;
    vec3 a = vec3_load(from), ab = vec3_sub(vec3_load(from + 3), a),
         ac = vec3_sub(vec3_load(from + 6), a), n = vec3_cross(ab, ac);
    for (size_t k = 0; k < 9; k++) four->at[k / 3][k % 3][lane] = from[k];
    four->n[0][lane] = n.x;
    four->n[1][lane] = n.y;
    four->n[2][lane] = n.z;
    four->n2[lane] = vec3_norm2(n);
    four->needle[lane] = is_needle(four->n2[lane], ab, ac);
    four->has_needle = (lane > 0 && four->has_needle) || four->needle[lane];
  }
}

SCREE_LANES static void fours_lanes(const scree_four *fours, size_t count, vec3 p,
                                    double *restrict out) {
  for (const scree_four *f = fours; f < fours + count; f++, out += SCREE_FOUR)
    for (int i = 0; i < SCREE_FOUR; i++) {
      vec3 a = {f->at[0][0][i], f->at[0][1][i], f->at[0][2][i]};
      vec3 b = {f->at[1][0][i], f->at[1][1][i], f->at[1][2][i]};
      vec3 c = {f->at[2][0][i], f->at[2][1][i], f->at[2][2][i]};
      vec3 n = {f->n[0][i], f->n[1][i], f->n[2][i]};
      nearest_lane(a, b, c, n, f->n2[i], p, &out[i]);
    }
}

void scree_fours_closest(const scree_four *fours, size_t four_count, vec3 p, double *distance2) {
  fours_lanes(fours, four_count, p, distance2);
  for (const scree_four *f = fours; f < fours + four_count; f++) {
    if (!f->has_needle) continue;
    for (size_t i = 0; i < SCREE_FOUR; i++) {
      double corners[9];
      vec3 point;
      if (!f->needle[i]) continue;
      for (size_t k = 0; k < 9; k++) corners[k] = f->at[k / 3][k % 3][i];
      distance2[SCREE_FOUR * (size_t)(f - fours) + i] = scree_triangle_closest(corners, p, &point);
    }
  }
}

SCREE_LANES static void points_lanes(vec3 a, vec3 b, vec3 c, scree_points *q, int count) {
  vec3 n = vec3_triangle_normal(a, b, c);
  double n2 = vec3_norm2(n);
  for (int begin = 0; begin < count; begin += SCREE_FOUR)
    for (int i = begin; i < begin + SCREE_FOUR; i++) {
      vec3 p = {q->at[0][i], q->at[1][i], q->at[2][i]};
      vec3 found = nearest_lane(a, b, c, n, n2, p, &q->distance2[i]);
      q->nearest[0][i] = found.x;
      q->nearest[1][i] = found.y;
      q->nearest[2][i] = found.z;
    }
}

void scree_points_closest(const double corners[9], scree_points *q) {
  vec3 a = vec3_load(corners), b = vec3_load(corners + 3), c = vec3_load(corners + 6);
  vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a);
  if (is_needle(vec3_norm2(vec3_cross(ab, ac)), ab, ac)) {
    for (int i = 0; i < q->count; i++) {
      vec3 found;
      q->distance2[i] =
          scree_triangle_closest(corners, (vec3){q->at[0][i], q->at[1][i], q->at[2][i]}, &found);
      q->nearest[0][i] = found.x;
      q->nearest[1][i] = found.y;
      q->nearest[2][i] = found.z;
    }
    return;
  }
  int width = (q->count + SCREE_FOUR - 1) / SCREE_FOUR * SCREE_FOUR;
  for (int k = 0; k < 3; k++)
    for (int i = q->count; i < width; i++) q->at[k][i] = q->at[k][0];
  points_lanes(a, b, c, q, width);
}
