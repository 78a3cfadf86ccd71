/* Small vectors, 3x3 matrices and quaternions, in double. Everything inline; nothing contracts. */
#pragma once

#include "base/math.h"

typedef struct vec3 {
  double x, y, z;
} vec3;

/* Row-major: m[row][column]. */
typedef struct mat3 {
  double m[3][3];
} mat3;

/* Unit quaternion w + xi + yj + zk, rotating body coordinates into space. */
typedef struct quat {
  double w, x, y, z;
} quat;

/* As scree_min and scree_max, but of numbers only, and the second of two equal ones. */
static inline double scree_smaller(double a, double b) {
  return a < b ? a : b;
}
static inline double scree_larger(double a, double b) {
  return a > b ? a : b;
}

static inline vec3 vec3_load(const double *p) {
  return (vec3){p[0], p[1], p[2]};
}
static inline void vec3_store(double *p, vec3 v) {
  p[0] = v.x;
  p[1] = v.y;
  p[2] = v.z;
}
static inline vec3 vec3_add(vec3 a, vec3 b) {
  return (vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline vec3 vec3_sub(vec3 a, vec3 b) {
  return (vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline vec3 vec3_scale(vec3 a, double s) {
  return (vec3){a.x * s, a.y * s, a.z * s};
}
static inline vec3 vec3_neg(vec3 a) {
  return (vec3){-a.x, -a.y, -a.z};
}
/* a + s b */
static inline vec3 vec3_mad(vec3 a, vec3 b, double s) {
  return (vec3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}
static inline vec3 vec3_lerp(vec3 a, vec3 b, double t) {
  return vec3_mad(a, vec3_sub(b, a), t);
}
static inline double vec3_along(vec3 a, int axis) {
  return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}
/* The axis of the greatest component, the first of equals. */
static inline int vec3_greatest(vec3 a) {
  return a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
}
static inline vec3 vec3_abs(vec3 a) {
  return (vec3){fabs(a.x), fabs(a.y), fabs(a.z)};
}
static inline double vec3_dot(vec3 a, vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline vec3 vec3_cross(vec3 a, vec3 b) {
  return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline double vec3_norm2(vec3 a) {
  return vec3_dot(a, a);
}
static inline double vec3_norm(vec3 a) {
  return sqrt(vec3_dot(a, a));
}
static inline double vec3_distance(vec3 a, vec3 b) {
  return vec3_norm(vec3_sub(a, b));
}
/* a / |a|, or zero for a zero vector. */
static inline vec3 vec3_unit(vec3 a) {
  double n = vec3_norm(a);
  return n > 0 ? vec3_scale(a, 1 / n) : (vec3){0, 0, 0};
}
static inline vec3 vec3_min(vec3 a, vec3 b) {
  return (vec3){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
static inline vec3 vec3_max(vec3 a, vec3 b) {
  return (vec3){a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}
/* Two unit vectors that with the unit vector n make a right-handed frame (u, w, n): Duff and others
 * (2017). */
static inline void vec3_frame(vec3 n, vec3 *u, vec3 *w) {
  double sign = copysign(1, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  *u = (vec3){1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  *w = (vec3){b, sign + n.y * n.y * a, -n.y};
}
/* Twice the area vector of the triangle a, b, c. */
static inline vec3 vec3_triangle_normal(vec3 a, vec3 b, vec3 c) {
  return vec3_cross(vec3_sub(b, a), vec3_sub(c, a));
}

static inline vec3 mat3_mul_vec(const mat3 *a, vec3 v) {
  return (vec3){a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
                a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
                a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z};
}
/* transpose(a) v */
static inline vec3 mat3_tmul_vec(const mat3 *a, vec3 v) {
  return (vec3){a->m[0][0] * v.x + a->m[1][0] * v.y + a->m[2][0] * v.z,
                a->m[0][1] * v.x + a->m[1][1] * v.y + a->m[2][1] * v.z,
                a->m[0][2] * v.x + a->m[1][2] * v.y + a->m[2][2] * v.z};
}
static inline mat3 mat3_mul(const mat3 *a, const mat3 *b) {
  mat3 c;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      c.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] + a->m[i][2] * b->m[2][j];
  return c;
}
/* transpose(a) b */
static inline mat3 mat3_tmul(const mat3 *a, const mat3 *b) {
  mat3 c;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      c.m[i][j] = a->m[0][i] * b->m[0][j] + a->m[1][i] * b->m[1][j] + a->m[2][i] * b->m[2][j];
  return c;
}
static inline mat3 mat3_transpose(const mat3 *a) {
  mat3 c;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) c.m[i][j] = a->m[j][i];
  return c;
}

static inline quat quat_mul(quat a, quat b) {
  return (quat){
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
static inline quat quat_unit(quat q) {
  double n = sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return n > 0 ? (quat){q.w / n, q.x / n, q.y / n, q.z / n} : (quat){1, 0, 0, 0};
}
static inline quat quat_conjugate(quat q) {
  return (quat){q.w, -q.x, -q.y, -q.z};
}
/* At least how far the rotation from p to q moves a point at distance 1, 2 sin(angle/2): a
 * little more for large angles, exact for small ones. */
static inline double quat_chord(quat p, quat q) {
  double sign = p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z < 0 ? -1 : 1;
  double w = q.w - sign * p.w, x = q.x - sign * p.x, y = q.y - sign * p.y, z = q.z - sign * p.z;
  return 2 * sqrt(w * w + x * x + y * y + z * z);
}
/* The rotation by the angle |r| about r. */
static inline quat quat_from_rotation_vector(vec3 r) {
  double angle2 = vec3_norm2(r);
  if (angle2 < 1e-3) { /* both series are exact to rounding */
    double a = angle2, s = 0.5 - a * (1.0 / 48 - a * (1.0 / 3840 - a * (1.0 / 645120))),
           w = 1 - a * (1.0 / 8 - a * (1.0 / 384 - a * (1.0 / 46080)));
    return (quat){w, r.x * s, r.y * s, r.z * s};
  }
  double angle = sqrt(angle2), half = 0.5 * angle, s = scree_sin(half) / angle;
  return (quat){scree_cos(half), r.x * s, r.y * s, r.z * s};
}
/* w, x, y, z, as in records. */
static inline quat quat_load(const double q[4]) {
  return (quat){q[0], q[1], q[2], q[3]};
}
static inline mat3 quat_to_mat3(quat q) {
  double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z,
         yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return (mat3){{{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)},
                 {2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)},
                 {2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)}}};
}
