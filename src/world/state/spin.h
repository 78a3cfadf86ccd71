/* How bodies turn. */
#pragma once

#include "world/state/world.h"

/* I^-1 R^T momentum: angular velocity in the body's own frame. */
static inline vec3 scree_local_spin(vec3 inertia, const mat3 *rotation, vec3 momentum) {
  vec3 local = mat3_tmul_vec(rotation, momentum);
  return (vec3){local.x / inertia.x, local.y / inertia.y, local.z / inertia.z};
}
/* The same of body i, in space. */
static inline vec3 scree_spin_of(const scree_bodies *bodies, size_t i, const mat3 *rotation,
                                 vec3 momentum) {
  return mat3_mul_vec(rotation, scree_local_spin(bodies->inertia[i], rotation, momentum));
}
/* An orientation after half a drift and after a whole one, where it turns by `turn` in its own
 * frame before, and has this momentum. */
static inline quat scree_half_turned(const quat *q, vec3 turn, double dt) {
  return quat_mul(*q, quat_from_rotation_vector(vec3_scale(turn, 0.5 * dt)));
}
static inline quat scree_turned(const quat *q, vec3 turn, vec3 inertia, vec3 momentum, double dt) {
  mat3 half = quat_to_mat3(scree_half_turned(q, turn, dt));
  turn = scree_local_spin(inertia, &half, momentum);
  return quat_unit(quat_mul(*q, quat_from_rotation_vector(vec3_scale(turn, dt))));
}
