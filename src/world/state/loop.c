#include "world/state/loop.h"

static const double pi = 3.14159265358979323846;

double scree_loop_length(const scree_loop *loop) {
  return 2 * vec3_norm(loop->span) + 2 * pi * loop->radius;
}

scree_loop_place scree_loop_at(const scree_loop *loop, double s) {
  const double strand = vec3_norm(loop->span), arc = pi * loop->radius,
               length = scree_loop_length(loop);
  const vec3 u = strand > 0 ? vec3_scale(loop->span, 1 / strand) : loop->span;
  double angle = 0, d = 0, along = 0; /* along: how d grows */
  s -= length * floor(s / length);
  if (s < strand) {
    d = s, along = 1;
  } else if (s < strand + arc) {
    angle = (s - strand) / loop->radius, d = strand;
  } else if (s < 2 * strand + arc) {
    angle = pi, d = 2 * strand + arc - s, along = -1;
  } else {
    angle = pi + (s - 2 * strand - arc) / loop->radius;
  }
  return (scree_loop_place){
      .turn = quat_from_rotation_vector(vec3_scale(loop->axis, angle)),
      .middle = vec3_mad(loop->centre, u, d),
      .along = vec3_scale(u, along),
      .spin = vec3_scale(loop->axis, along == 0 ? 1 / loop->radius : 0),
  };
}
