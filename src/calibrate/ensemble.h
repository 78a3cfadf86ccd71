/* Samples of a density known but for its constant, in the box [-1, 1]^d. */
#pragma once

#include "base/alloc.h"

/* The logarithm of the density at x; -INFINITY where there is none. Called by several threads. */
typedef double scree_log_density(const void *context, const double *x);

typedef struct scree_ensemble {
  scree_log_density *density;
  const void *context;
  size_t dimension_count;
  size_t walker_count;             /* even, at least 2 (d + 1) */
  size_t first_steps, steps, thin; /* left out at first; of which every `thin`th is kept */
  uint64_t seed;
} scree_ensemble;

static inline size_t scree_ensemble_count(const scree_ensemble *e) {
  return e->walker_count * (e->steps / e->thin);
}

/* scree_ensemble_count x d samples; the same bits for any number of threads. */
scree_status scree_ensemble_sample(const scree_ensemble *ensemble, double *samples,
                                   scree_error *error);
