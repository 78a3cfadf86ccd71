/* Axis-aligned boxes. */
#pragma once

#include "base/vec.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct scree_box {
  vec3 low, high;
} scree_box;

/* How far x is outside [low, high]; not by fmax, which is a call. */
static inline double scree_outside(double low, double high, double x) {
  return scree_larger(scree_larger(low - x, x - high), 0);
}
/* Squared distance from p to the box, 0 inside. */
static inline double scree_box_distance2(const scree_box *box, vec3 p) {
  double x = scree_outside(box->low.x, box->high.x, p.x),
         y = scree_outside(box->low.y, box->high.y, p.y),
         z = scree_outside(box->low.z, box->high.z, p.z);
  return x * x + y * y + z * z;
}
/* That holds nothing. */
static inline scree_box scree_box_empty(void) {
  return (scree_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}
static inline scree_box scree_box_of(vec3 a, vec3 b) {
  return (scree_box){vec3_min(a, b), vec3_max(a, b)};
}
static inline scree_box scree_box_join(scree_box a, scree_box b) {
  return (scree_box){vec3_min(a.low, b.low), vec3_max(a.high, b.high)};
}
static inline scree_box scree_box_grown(scree_box a, double r) {
  vec3 d = {r, r, r};
  return (scree_box){vec3_sub(a.low, d), vec3_add(a.high, d)};
}
static inline bool scree_box_meets(const scree_box *a, const scree_box *b) {
  return (a->low.x <= b->high.x) & (b->low.x <= a->high.x) & (a->low.y <= b->high.y) &
         (b->low.y <= a->high.y) & (a->low.z <= b->high.z) & (b->low.z <= a->high.z);
}

/* That of some points, 3 numbers each. */
static inline scree_box scree_box_of_points(const double *points, size_t count) {
  scree_box b = scree_box_empty();
  for (size_t i = 0; i < count; i++) {
    vec3 p = vec3_load(points + 3 * i);
    b = scree_box_join(b, (scree_box){p, p});
  }
  return b;
}
/* The box of `box` after x -> rotation x + shift. */
static inline scree_box scree_box_moved(const scree_box *box, const mat3 *rotation, vec3 shift) {
  vec3 centre = vec3_scale(vec3_add(box->low, box->high), 0.5);
  vec3 half = vec3_scale(vec3_sub(box->high, box->low), 0.5);
  vec3 c = vec3_add(mat3_mul_vec(rotation, centre), shift);
  vec3 h = {fabs(rotation->m[0][0]) * half.x + fabs(rotation->m[0][1]) * half.y +
                fabs(rotation->m[0][2]) * half.z,
            fabs(rotation->m[1][0]) * half.x + fabs(rotation->m[1][1]) * half.y +
                fabs(rotation->m[1][2]) * half.z,
            fabs(rotation->m[2][0]) * half.x + fabs(rotation->m[2][1]) * half.y +
                fabs(rotation->m[2][2]) * half.z};
  return (scree_box){vec3_sub(c, h), vec3_add(c, h)};
}
/* Cuts [from, to] to the part of the way start + s along that lies within the box; false for none.
 */
static inline bool scree_box_cut(const scree_box *box, vec3 start, vec3 along, double *from,
                                 double *to) {
  const double starts[3] = {start.x, start.y, start.z}, alongs[3] = {along.x, along.y, along.z},
               low[3] = {box->low.x, box->low.y, box->low.z},
               high[3] = {box->high.x, box->high.y, box->high.z};
  for (int k = 0; k < 3; k++) {
    if (alongs[k] == 0) {
      if (starts[k] < low[k] || starts[k] > high[k]) return false;
      continue;
    }
    double t0 = (low[k] - starts[k]) / alongs[k], t1 = (high[k] - starts[k]) / alongs[k];
    *from = scree_larger(*from, scree_smaller(t0, t1));
    *to = scree_smaller(*to, scree_larger(t0, t1));
  }
  return *from <= *to;
}
