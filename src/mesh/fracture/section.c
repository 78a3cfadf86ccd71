#include "mesh/fracture/section.h"

typedef struct section {
  double area, moments[3]; /* of second order: xx, xy, yy */
  vec3 centre;
} section;

static section section_of(const vec3 *corners, size_t count, vec3 u, vec3 v) {
  section s = {.area = 0};
  vec3 sum = {0, 0, 0}, o = corners[0];
  for (int pass = 0; pass < 2; pass++) {
    for (size_t t = 0; t < count; t++) {
      vec3 q[3];
      for (size_t k = 0; k < 3; k++) q[k] = vec3_sub(corners[3 * t + k], o);
      double area = vec3_norm(vec3_triangle_normal(q[0], q[1], q[2])) / 2;
      vec3 third = vec3_scale(vec3_add(vec3_add(q[0], q[1]), q[2]), 1. / 3);
      if (pass == 0) {
        s.area += area;
        sum = vec3_mad(sum, third, area);
        continue;
      }
      double x[4] = {0}, y[4] = {0}; /* corners and their sum, from the centre of the section */
      for (int k = 0; k < 3; k++) {
        vec3 off = vec3_sub(q[k], vec3_sub(s.centre, o));
        x[3] += x[k] = vec3_dot(off, u), y[3] += y[k] = vec3_dot(off, v);
      }
      for (int k = 0; k < 4; k++) {
        s.moments[0] += area / 12 * x[k] * x[k];
        s.moments[1] += area / 12 * x[k] * y[k];
        s.moments[2] += area / 12 * y[k] * y[k];
      }
    }
    s.centre = vec3_mad(o, sum, 1 / s.area);
  }
  return s;
}

/* The farthest corner from a point, along a direction. */
static double reach_of(const vec3 *corners, size_t count, vec3 from, vec3 along) {
  double most = 0;
  for (size_t k = 0; k < 3 * count; k++)
    most = scree_larger(most, fabs(vec3_dot(along, vec3_sub(corners[k], from))));
  return most;
}

/* The principal axes of the section: the angle of the greater moment (Culmann and Mohr). */
void scree_section_describe(const vec3 *corners, size_t count, scree_fracture_face *f) {
  vec3 n = {0, 0, 0}, u, v;
  for (size_t t = 0; t < count; t++)
    n = vec3_add(n, vec3_triangle_normal(corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]));
  n = vec3_unit(n);
  vec3_frame(n, &u, &v);
  section s = section_of(corners, count, u, v);
  double half = (s.moments[0] - s.moments[2]) / 2, mean = (s.moments[0] + s.moments[2]) / 2,
         radius = sqrt(half * half + s.moments[1] * s.moments[1]);
  double cosine = radius > 0 ? sqrt(scree_larger(0, (1 + half / radius) / 2)) : 1,
         sine = radius > 0 ? copysign(sqrt(scree_larger(0, (1 - half / radius) / 2)), s.moments[1])
                           : 0;
  vec3 axis = vec3_unit(vec3_mad(vec3_scale(u, cosine), v, sine));
  f->area = s.area;
  f->second_moments[0] = mean + radius;
  f->second_moments[1] = scree_larger(mean - radius, 0);
  vec3_store(f->centre, s.centre);
  vec3_store(f->normal, n);
  vec3_store(f->axis, axis);
  f->reach[0] = reach_of(corners, count, s.centre, axis);
  f->reach[1] = reach_of(corners, count, s.centre, vec3_cross(n, axis));
}
