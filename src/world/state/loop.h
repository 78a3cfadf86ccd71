/* The way round two wheels of the same radius, as of a belt or a chain, and round one where they
 * are the same.
 *
 * With A and B = A + span the wheels' centres, u the direction from A to B and w = axis x u, the
 * way begins beside A at A - r w, leads along u to B, right-handed half around it, back along -u
 * and half around A. What is carried along it for a way s is turned by an angle q about the axis
 * and shifted: x' = A + R(q) (x - A) + u d with q = 0, d = s on the first strand; d = span and q
 * growing by s/r about B; q = pi, d falling on the second strand; d = 0 about A. */
#pragma once

#include "base/vec.h"

typedef struct scree_loop {
  vec3 axis, centre, span; /* axis: unit, across the span; of A; from A to B */
  double radius;           /* m, above 0 */
} scree_loop;

typedef struct scree_loop_place {
  quat turn;
  vec3 middle; /* A + u d, about which it turns */
  vec3 along,
      spin; /* how it moves by a unit of way: with `along`, and by `spin` about the middle */
} scree_loop_place;

double scree_loop_length(const scree_loop *loop);
/* After a way of s, which may be any number. */
scree_loop_place scree_loop_at(const scree_loop *loop, double s);
/* Where that brings what was at x at the way's beginning; and back. */
static inline vec3 scree_loop_carry(const scree_loop *loop, const scree_loop_place *place, vec3 x) {
  mat3 turn = quat_to_mat3(place->turn);
  return vec3_add(place->middle, mat3_mul_vec(&turn, vec3_sub(x, loop->centre)));
}
static inline vec3 scree_loop_bring_back(const scree_loop *loop, const scree_loop_place *place,
                                         vec3 x) {
  mat3 turn = quat_to_mat3(place->turn);
  return vec3_add(loop->centre, mat3_tmul_vec(&turn, vec3_sub(x, place->middle)));
}
