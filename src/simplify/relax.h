/* Where a vertex of a coarse level lies better: the placement of a collapse looks at the surface as
 * it was just before, and over thousands of collapses the level drifts from the scan. */
#ifndef SCREE_SIMPLIFY_RELAX_H
#define SCREE_SIMPLIFY_RELAX_H

#include "simplify/stray.h"

/* What is known of a vertex before it moves, and where it wants to go. */
typedef struct scree_relaxation {
  vec3 from, n; /* the vertex; unit normal of the plane of equal volume through it */
  vec3 step;    /* the whole way, in that plane */
  double sum;   /* of the squared distances of the witnesses of the fan */
  double worst; /* the largest of these, or of the places on the edges where these were looked at */
  bool has_edges;
  scree_hints hints;
} scree_relaxation;

/* The fan's (scree_ring_gather_fan) relaxation; false: nothing around is off, or the fan has no
 * plane of equal volume. */
bool scree_relax_begin(const scree_memory *memory, const scree_halfmesh *s, const scree_ring *fan,
                       scree_relaxation *relaxation);

/* The place at this share of the step. */
vec3 scree_relax_place(const scree_relaxation *relaxation, double share);

/* Whether with the vertex at x the sum of the squared distances is smaller and no place is farther
 * off than the worst was. */
bool scree_relax_gains(const scree_memory *memory, const scree_halfmesh *s, const scree_ring *fan,
                       vec3 x, scree_relaxation *relaxation);

#endif
