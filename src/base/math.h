/* Elementary functions of our own, within an ulp or two of the true value: the C library's differ
 * in their last bit from one platform to the next, and a device has none. Only sqrt, floor, ceil
 * and fabs, which IEEE 754 defines to the bit, come from there. */
#pragma once

#include <math.h>

/* Angles in rad. Up to 1e6 within an ulp; larger ones modulo the double next to 2 pi. NaN for
 * infinities. */
double scree_sin(double x);
double scree_cos(double x);
/* The angle of (x, y), -pi to pi, within 1.5 ulps; signs of zeros and infinities as in C. */
double scree_atan2(double y, double x);
/* 0 to pi, within two ulps; NaN outside [-1, 1]. */
double scree_acos(double x);
double scree_exp(double x);
/* Natural; NaN below 0, -infinity at 0. */
double scree_log(double x);
double scree_cbrt(double x);
/* 10^x for |x| up to 22: the double nearest to the true value, but for one x in some 1e12. */
double scree_power_of_ten(double x);
/* The decimal logarithm of 1e-22 to 1e22, within two ulps; exact for powers of ten. */
double scree_log10(double x);

/* The smaller; of two equal ones, which zeros of either sign are, the first; a number rather than
 * NaN. */
static inline double scree_min(double a, double b) {
  return b < a || a != a ? b : a;
}
static inline double scree_max(double a, double b) {
  return b > a || a != a ? b : a;
}
