#pragma once

#include "mesh/mesh.h"

/* Half the solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983),
 * positive where it is seen from behind. The sum over a closed surface over 2 pi is how often that
 * winds around the origin. */
static inline double scree_half_solid_angle(vec3 a, vec3 b, vec3 c) {
  double x = vec3_norm(a), y = vec3_norm(b), z = vec3_norm(c);
  return atan2(vec3_dot(a, vec3_cross(b, c)),
               x * y * z + vec3_dot(a, b) * z + vec3_dot(b, c) * x + vec3_dot(c, a) * y);
}

/* How often `count` triangles from `first` on, a closed surface, wind around p. */
static inline double scree_winding_about(const scree_mesh *mesh, size_t first, size_t count,
                                         vec3 p) {
  double sum = 0;
  for (size_t t = first; t < first + count; t++)
    sum += scree_half_solid_angle(vec3_sub(scree_mesh_corner(mesh, t, 0), p),
                                  vec3_sub(scree_mesh_corner(mesh, t, 1), p),
                                  vec3_sub(scree_mesh_corner(mesh, t, 2), p));
  return sum / (2 * 3.14159265358979323846);
}
