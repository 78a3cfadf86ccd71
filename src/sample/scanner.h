/* The measuring noise of a structured-light scanner, put on a clean mesh. */
#pragma once

#include "base/error.h"
#include "base/vec.h"

typedef struct scree_scanner {
  double sigma;  /* metres: the standard deviation on smooth surfaces, as seen on the average */
  uint64_t seed; /* another seed, another scan of the same object */
} scree_scanner;

/* Moves every vertex along its normal by sigma * scree_scanner_coverage(normal) * (1 + edge) *
 * scree_scanner_field(position), edge in [0, 1] being 0 on smooth surfaces and 1 where the normal
 * turns by 50 degrees within a spacing. A displacement that would turn a triangle over is halved
 * until it does not. Depends on geometry and seed only, not on the order of vertices or on threads.
 */
scree_status scree_scanner_apply(const scree_scanner *scanner, scree_mesh *mesh,
                                 scree_error *error);

/* A random field of mean 0 and variance 1 at every point, correlated over the lattice below. */
double scree_scanner_field(uint64_t seed, vec3 position);

/* How much more than sigma the noise is on a surface of this normal: the 45 views' errors combined.
 * Its mean square over all directions is about 1. */
double scree_scanner_coverage(vec3 normal);

/* Field correlation between two points `distance` apart along an axis of the lattice, on average
 * over all places: what the tests compare the field with. */
double scree_scanner_correlation(double distance);
