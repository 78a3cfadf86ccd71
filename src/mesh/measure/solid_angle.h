#pragma once

#include "base/vec.h"

/* Half the solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983),
 * positive where it is seen from behind. The sum over a closed surface over 2 pi is how often that
 * winds around the origin. */
static inline double scree_half_solid_angle(vec3 a, vec3 b, vec3 c) {
  double x = vec3_norm(a), y = vec3_norm(b), z = vec3_norm(c);
  return atan2(vec3_dot(a, vec3_cross(b, c)),
               x * y * z + vec3_dot(a, b) * z + vec3_dot(b, c) * x + vec3_dot(c, a) * y);
}
