/* The exposed surface of a clump: directions on each sphere, and how much of each is covered by no
 * other. */
#pragma once

#include "base/vec.h"
#include "scree.h"

enum { SCREE_MOST_DIRECTIONS = 2048 };

/* Directions spread evenly over the unit sphere on a Fibonacci spiral. */
typedef struct scree_directions {
  size_t count;
  float x[SCREE_MOST_DIRECTIONS], y[SCREE_MOST_DIRECTIONS], z[SCREE_MOST_DIRECTIONS];
} scree_directions;

/* So many, at most SCREE_MOST_DIRECTIONS. */
void scree_directions_spread(scree_directions *directions, size_t count);

/* The share, 0 to 1, of each direction's patch on sphere `index` that no other sphere covers: a
 * patch that a rim crosses counts in part, so that areas change smoothly as spheres move. */
void scree_exposed_shares(const scree_directions *directions, const scree_sphere *spheres,
                          size_t count, size_t index, float shares[SCREE_MOST_DIRECTIONS]);
