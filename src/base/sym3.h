/* Symmetric 3x3 matrices. */
#ifndef SCREE_BASE_SYM3_H
#define SCREE_BASE_SYM3_H

#include "base/vec.h"

typedef struct sym3 {
  double xx, xy, xz, yy, yz, zz;
} sym3;

/* m + weight g g^T. */
static inline void sym3_add_square(sym3 *m, vec3 g, double weight) {
  m->xx += weight * g.x * g.x;
  m->xy += weight * g.x * g.y;
  m->xz += weight * g.x * g.z;
  m->yy += weight * g.y * g.y;
  m->yz += weight * g.y * g.z;
  m->zz += weight * g.z * g.z;
}

static inline void sym3_add(sym3 *m, const sym3 *other) {
  m->xx += other->xx;
  m->xy += other->xy;
  m->xz += other->xz;
  m->yy += other->yy;
  m->yz += other->yz;
  m->zz += other->zz;
}

static inline void sym3_add_diagonal(sym3 *m, double value) {
  m->xx += value;
  m->yy += value;
  m->zz += value;
}

static inline vec3 sym3_mul_vec(const sym3 *m, vec3 v) {
  return (vec3){m->xx * v.x + m->xy * v.y + m->xz * v.z, m->xy * v.x + m->yy * v.y + m->yz * v.z,
                m->xz * v.x + m->yz * v.y + m->zz * v.z};
}

/* m^-1 v, of a matrix that is not singular. */
static inline vec3 sym3_solve(const sym3 *m, vec3 v) {
  vec3 x = {m->xx, m->xy, m->xz}, y = {m->xy, m->yy, m->yz}, z = {m->xz, m->yz, m->zz};
  vec3 yz = vec3_cross(y, z), zx = vec3_cross(z, x), xy = vec3_cross(x, y);
  vec3 sum = vec3_mad(vec3_mad(vec3_scale(yz, v.x), zx, v.y), xy, v.z);
  return vec3_scale(sum, 1 / vec3_dot(x, yz));
}

static inline sym3 sym3_inverse(const sym3 *m) {
  vec3 x = {m->xx, m->xy, m->xz}, y = {m->xy, m->yy, m->yz}, z = {m->xz, m->yz, m->zz};
  vec3 yz = vec3_cross(y, z), zx = vec3_cross(z, x), xy = vec3_cross(x, y);
  double scale = 1 / vec3_dot(x, yz);
  return (sym3){scale * yz.x, scale * yz.y, scale * yz.z, scale * zx.y, scale * zx.z, scale * xy.z};
}

#endif
