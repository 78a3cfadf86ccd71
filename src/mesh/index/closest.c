/* After Ericson, "Real-Time Collision Detection", 5.1.5, with a special case for needles. Side by
 * side the inside and all three edges are looked at, and the same is chosen by the same
 * comparisons; needles are done one by one. */
#include "mesh/index/closest.h"

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
SCREE_LANES_INLINE bool is_needle(double squared, double ab2, double ac2) {
  double longer2 = ab2 > ac2 ? ab2 : ac2;
  return squared <= NEEDLE * (longer2 * longer2);
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
  if (is_needle(squared, vec3_norm2(ab), vec3_norm2(ac)))
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

/* A triangle that is no needle, with its sides and their squared lengths. */
typedef struct lane_triangle {
  vec3 a, b, c, ab, bc, ca, n;
  double n2, ab2, bc2, ca2;
} lane_triangle;

SCREE_LANES_INLINE lane_triangle triangle_of(vec3 a, vec3 b, vec3 c) {
  lane_triangle t = {.a = a,
                     .b = b,
                     .c = c,
                     .ab = vec3_sub(b, a),
                     .bc = vec3_sub(c, b),
                     .ca = vec3_sub(a, c),
                     .n = vec3_triangle_normal(a, b, c)};
  t.n2 = vec3_norm2(t.n);
  t.ab2 = vec3_norm2(t.ab);
  t.bc2 = vec3_norm2(t.bc);
  t.ca2 = vec3_norm2(t.ca);
  return t;
}

/* The point of a segment, at the share given where that lies between its ends. */
SCREE_LANES_INLINE vec3 on_segment(vec3 from, vec3 side, vec3 to, double along, double length2,
                                   double share) {
  vec3 between = vec3_mad(from, side, choose(along > 0, share, 0));
  return choose_point(along >= length2, to, between);
}

/* The nearest point, and its squared distance. Of the edges only those that p is beyond count, and
 * the first of equals. That are two at the most, and none where p is above the inside: so two
 * divisions are enough, where each is of what its lane needs. */
SCREE_LANES_INLINE vec3 nearest_lane(const lane_triangle *t, vec3 p, double *distance2) {
  vec3 ap = vec3_sub(p, t->a), ac = vec3_scale(t->ca, -1);
  double v = vec3_dot(vec3_cross(ap, ac), t->n), w = vec3_dot(vec3_cross(t->ab, ap), t->n),
         u = t->n2 - v - w;
  bool beyond_bc = u < 0, beyond_ca = v < 0, beyond_ab = w < 0;
  double along_ab = vec3_dot(ap, t->ab), along_bc = vec3_dot(vec3_sub(p, t->b), t->bc),
         along_ca = vec3_dot(vec3_sub(p, t->c), t->ca);
  double one = choose(beyond_ca, along_ca, choose(beyond_bc, along_bc, v)),
         of_one = choose(beyond_ca, t->ca2, choose(beyond_bc, t->bc2, t->n2)),
         two = choose(beyond_ca, along_ca, choose(beyond_ab, along_ab, w)),
         of_two = choose(beyond_ca, t->ca2, choose(beyond_ab, t->ab2, t->n2));
  one = choose(beyond_ab, along_ab, one) / choose(beyond_ab, t->ab2, of_one);
  two = choose(beyond_bc, along_bc, two) / choose(beyond_bc, t->bc2, of_two);
  vec3 inside = vec3_mad(vec3_mad(t->a, t->ab, one), ac, two);
  vec3 ab = on_segment(t->a, t->ab, t->b, along_ab, t->ab2, one);
  vec3 bc = on_segment(t->b, t->bc, t->c, along_bc, t->bc2, two);
  vec3 ca = on_segment(t->c, t->ca, t->a, along_ca, t->ca2, choose(beyond_ab, two, one));
  double of_bc = choose(beyond_bc, vec3_norm2(vec3_sub(bc, p)), INFINITY);
  double of_ca = choose(beyond_ca, vec3_norm2(vec3_sub(ca, p)), INFINITY);
  double least = choose(beyond_ab, vec3_norm2(vec3_sub(ab, p)), INFINITY);
  bool nearer = of_ca <= least, outside = beyond_bc | beyond_ca | beyond_ab;
  vec3 found = choose_point(nearer, ca, ab);
  least = choose(nearer, of_ca, least);
  nearer = of_bc <= least;
  found = choose_point(nearer, bc, found);
  least = choose(nearer, of_bc, least);
  *distance2 = choose(outside, least, vec3_norm2(vec3_sub(p, inside)));
  return choose_point(outside, found, inside);
}

static int whole_eights(int count) {
  return (count + SCREE_EIGHT - 1) / SCREE_EIGHT * SCREE_EIGHT;
}

/* Up to a whole number of eights with the first point. */
void scree_point_block_set(scree_point_block *q, const vec3 *at, int count) {
  q->count = count;
  for (int i = 0; i < whole_eights(count); i++) {
    vec3 p = at[i < count ? i : 0];
    q->at[0][i] = p.x;
    q->at[1][i] = p.y;
    q->at[2][i] = p.z;
    q->distance2[i] = INFINITY;
    q->index[i] = 0;
  }
}

SCREE_LANES static void points_lanes(const lane_triangle *of, scree_point_block *q, int count,
                                     uint64_t index) {
  const lane_triangle t = *of; /* that q cannot be part of */
  for (int begin = 0; begin < count; begin += SCREE_EIGHT)
    for (int i = begin; i < begin + SCREE_EIGHT; i++) {
      vec3 p = {q->at[0][i], q->at[1][i], q->at[2][i]};
      double distance2;
      nearest_lane(&t, p, &distance2);
      uint64_t nearer = -(uint64_t)(distance2 < q->distance2[i]);
      q->distance2[i] = choose(distance2 < q->distance2[i], distance2, q->distance2[i]);
      q->index[i] = (index & nearer) | (q->index[i] & ~nearer);
    }
}

static void keep_needle(scree_point_block *q, const double corners[9], uint32_t index) {
  for (int i = 0; i < whole_eights(q->count); i++) {
    vec3 found;
    double distance2 =
        scree_triangle_closest(corners, (vec3){q->at[0][i], q->at[1][i], q->at[2][i]}, &found);
    if (distance2 < q->distance2[i]) q->distance2[i] = distance2, q->index[i] = index;
  }
}

void scree_point_block_closest(scree_point_block *q, const double corners[9], uint32_t index) {
  lane_triangle t = triangle_of(vec3_load(corners), vec3_load(corners + 3), vec3_load(corners + 6));
  if (is_needle(t.n2, t.ab2, t.ca2))
    keep_needle(q, corners, index);
  else
    points_lanes(&t, q, whole_eights(q->count), index);
}

double scree_point_block_farthest(const scree_point_block *q) {
  double most[SCREE_EIGHT] = {0}, farthest = 0;
  for (int begin = 0; begin < q->count; begin += SCREE_EIGHT)
    for (int i = 0; i < SCREE_EIGHT; i++)
      most[i] = most[i] > q->distance2[begin + i] ? most[i] : q->distance2[begin + i];
  for (int i = 0; i < SCREE_EIGHT; i++) farthest = farthest > most[i] ? farthest : most[i];
  return farthest;
}

SCREE_LANES static uint64_t near_lanes(const scree_point_block *q, int count, const scree_box *of) {
  const scree_box box = *of; /* that q cannot be part of */
  uint64_t near[SCREE_EIGHT] = {0}, any = 0;
  for (int begin = 0; begin < count; begin += SCREE_EIGHT)
    for (int i = 0; i < SCREE_EIGHT; i++) {
      vec3 p = {q->at[0][begin + i], q->at[1][begin + i], q->at[2][begin + i]};
      near[i] |= (uint64_t)(scree_box_distance2(&box, p) < q->distance2[begin + i]);
    }
  for (int i = 0; i < SCREE_EIGHT; i++) any |= near[i];
  return any;
}

bool scree_point_block_near(const scree_point_block *q, const scree_box *box) {
  return near_lanes(q, whole_eights(q->count), box) != 0;
}
