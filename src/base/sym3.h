/* Symmetric 3x3 matrices. */
#pragma once

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

/* The columns of the adjugate; answers the determinant. */
static inline double sym3_adjugate(const sym3 *m, vec3 columns[3]) {
  vec3 x = {m->xx, m->xy, m->xz}, y = {m->xy, m->yy, m->yz}, z = {m->xz, m->yz, m->zz};
  columns[0] = vec3_cross(y, z);
  columns[1] = vec3_cross(z, x);
  columns[2] = vec3_cross(x, y);
  return vec3_dot(x, columns[0]);
}

/* m^-1 v, and m^-1, of a matrix that is not singular. */
static inline vec3 sym3_solve(const sym3 *m, vec3 v) {
  vec3 c[3];
  double scale = 1 / sym3_adjugate(m, c);
  return vec3_scale(vec3_mad(vec3_mad(vec3_scale(c[0], v.x), c[1], v.y), c[2], v.z), scale);
}
static inline sym3 sym3_inverse(const sym3 *m) {
  vec3 c[3];
  double scale = 1 / sym3_adjugate(m, c);
  return (sym3){scale * c[0].x, scale * c[0].y, scale * c[0].z,
                scale * c[1].y, scale * c[1].z, scale * c[2].z};
}
