/* Axis-aligned boxes. */
#ifndef SCREE_BASE_BOX_H
#define SCREE_BASE_BOX_H

#include "base/vec.h"

#include <stdbool.h>

typedef struct scree_box {
  vec3 low, high;
} scree_box;

/* Squared distance from p to the box, 0 inside. */
static inline double scree_box_distance2(const scree_box *box, vec3 p) {
  double x = p.x < box->low.x ? box->low.x - p.x : p.x > box->high.x ? p.x - box->high.x : 0;
  double y = p.y < box->low.y ? box->low.y - p.y : p.y > box->high.y ? p.y - box->high.y : 0;
  double z = p.z < box->low.z ? box->low.z - p.z : p.z > box->high.z ? p.z - box->high.z : 0;
  return x * x + y * y + z * z;
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

#endif
