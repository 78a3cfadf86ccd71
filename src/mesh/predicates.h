/* Signs of orientation determinants, exact. Where a sign decides (on which side of a plane, in
 * which order around a point), rounding must not: these answer with the sign that real arithmetic
 * on the given doubles would have.
 *
 * Cost: an inline filter settles nearly all calls with the cost of the plain determinant; the rest
 * (a point within rounding of the plane) takes a microsecond.
 * Range: exact while every coordinate is 0 or has a magnitude in [1e-70, 1e70]; SCREE_EXACT_MIN and
 * SCREE_EXACT_MAX. Outside, products may leave the range of double and only repeatability is kept.
 * Source: J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
 * predicates", Discrete & Computational Geometry 18 (1997), 305-363; error bounds of its figures
 * 20 and 21. */
#pragma once

#include <math.h>
#include <stdbool.h>

#define SCREE_EXACT_MIN 1e-70
#define SCREE_EXACT_MAX 1e70

/* Half a unit in the last place of 1: the relative error of one rounded operation. */
#define SCREE_HALF_ULP     1.1102230246251565e-16
#define SCREE_ORIENT2_SLOP ((3 + 16 * SCREE_HALF_ULP) * SCREE_HALF_ULP)
#define SCREE_ORIENT3_SLOP ((7 + 56 * SCREE_HALF_ULP) * SCREE_HALF_ULP)
/* Covers what underflow may take from a product, however small the coordinates. */
#define SCREE_ORIENT_UNDERFLOW 1e-270

/* The exact ones behind the filters; call the functions below. */
int scree_orient2_exact(const double a[2], const double b[2], const double c[2]);
int scree_orient3_exact(const double *a, const double *b, const double *c, const double *d);

/* The filters: the sign when it is certain, else 0. */
static inline int scree_orient2_sure(const double a[2], const double b[2], const double c[2]) {
  double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]);
  double det = left - right;
  double slop = SCREE_ORIENT2_SLOP * (fabs(left) + fabs(right)) + SCREE_ORIENT_UNDERFLOW;
  return (det > slop) - (det < -slop);
}

static inline int scree_orient3_sure(const double *a, const double *b, const double *c,
                                     const double *d) {
  double ax = a[0] - d[0], ay = a[1] - d[1], az = a[2] - d[2];
  double bx = b[0] - d[0], by = b[1] - d[1], bz = b[2] - d[2];
  double cx = c[0] - d[0], cy = c[1] - d[1], cz = c[2] - d[2];
  double bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy, axby = ax * by,
         bxay = bx * ay;
  double det = az * (bxcy - cxby) + bz * (cxay - axcy) + cz * (axby - bxay);
  double size = fabs(az) * (fabs(bxcy) + fabs(cxby)) + fabs(bz) * (fabs(cxay) + fabs(axcy)) +
                fabs(cz) * (fabs(axby) + fabs(bxay));
  double slop = SCREE_ORIENT3_SLOP * size + SCREE_ORIENT_UNDERFLOW;
  return (det < -slop) - (det > slop);
}

/* +1: a, b, c turn counter-clockwise; -1: clockwise; 0: they lie on one line. */
static inline int scree_orient2(const double a[2], const double b[2], const double c[2]) {
  int sign = scree_orient2_sure(a, b, c);
  return sign ? sign : scree_orient2_exact(a, b, c);
}

/* +1: d lies on the side of the plane a, b, c that the normal (b - a) x (c - a) points to (outside
 * of a counter-clockwise triangle); -1: on the other side; 0: in the plane. */
static inline int scree_orient3(const double *a, const double *b, const double *c,
                                const double *d) {
  int sign = scree_orient3_sure(a, b, c, d);
  return sign ? sign : scree_orient3_exact(a, b, c, d);
}
