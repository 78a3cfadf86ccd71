/* Sums and products of doubles without error, as a rounded result and what it lacks (Dekker 1971,
 * Shewchuk 1997). */
#pragma once

/* x + y = a + b exactly, x the rounded sum. */
static inline void scree_two_sum(double a, double b, double *x, double *y) {
  double sum = a + b, b_part = sum - a, a_part = sum - b_part;
  *y = (a - a_part) + (b - b_part);
  *x = sum;
}

/* The same where |a| >= |b|. */
static inline void scree_quick_two_sum(double a, double b, double *x, double *y) {
  double sum = a + b;
  *y = b - (sum - a);
  *x = sum;
}

/* Splits a into two halves of at most 26 bits (Dekker 1971). */
static inline void scree_split(double a, double *high, double *low) {
  double c = 134217729.0 * a; /* 2^27 + 1 */
  *high = c - (c - a);
  *low = a - *high;
}

static inline void scree_two_product(double a, double b, double *x, double *y) {
  double a_high, a_low, b_high, b_low, product = a * b;
  scree_split(a, &a_high, &a_low);
  scree_split(b, &b_high, &b_low);
  *y = a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low);
  *x = product;
}
