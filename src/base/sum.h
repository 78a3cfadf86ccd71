/* Compensated summation (Neumaier 1974): the error does not grow with the number of terms. */
#pragma once

#include <math.h>

typedef struct scree_sum {
  double sum, carry;
} scree_sum;

static inline void scree_sum_add(scree_sum *s, double x) {
  double t = s->sum + x;
  s->carry += fabs(s->sum) >= fabs(x) ? (s->sum - t) + x : (x - t) + s->sum;
  s->sum = t;
}
static inline void scree_sum_merge(scree_sum *s, scree_sum other) {
  scree_sum_add(s, other.sum);
  s->carry += other.carry;
}
static inline double scree_sum_value(scree_sum s) {
  return s.sum + s.carry;
}
