/* Where a vertex of a coarse level lies better: the placement of a collapse looks at the surface as
 * it was just before, and over thousands of collapses the level drifts from the scan. */
#ifndef SCREE_SIMPLIFY_RELAX_H
#define SCREE_SIMPLIFY_RELAX_H

#include "simplify/stray.h"

/* What the witnesses around a vertex ask of it. Of equal volume is the plane n.y = 0. */
typedef struct scree_pull {
  vec3 from, n;     /* the vertex; sum of the doubled area vectors of its fan */
  vec3 free, per_n; /* the step they ask for, were the volume free; how pressure along n moves it */
  double gain;      /* of the sum, by the free step */
  double n_free, n_per_n; /* n times these */
  double sum, worst;      /* of the squared distances of the witnesses of the fan */
} scree_pull;

/* Of the fan's vertex (scree_ring_gather_fan); false: nothing around is off, or the fan has no
 * plane of equal volume. */
bool scree_pull_find(const scree_memory *memory, const scree_halfmesh *s, const scree_ring *fan,
                     scree_pull *pull);

/* A vertex that is to move alone or with another. */
typedef struct scree_relaxation {
  const scree_ring *fan;
  vec3 from, n, step; /* as in the pull; the whole way */
  double sum;         /* as in the pull */
  double worst; /* as in the pull, or of the places on the edges where these were looked at; the
                   caller may allow more */
  bool has_edges;
  scree_hints hints;
} scree_relaxation;

/* Alone, in the plane of equal volume. False: it is not worth it. */
bool scree_relax_alone(const scree_pull *pull, const scree_ring *fan, scree_relaxation *relaxation);

/* Two vertices that are no neighbours take over volume from each other: what the sum of both falls
 * by beyond what they can do alone; 0: not enough to be worth it. */
double scree_exchange_gain(const scree_pull *a, const scree_pull *b);
void scree_exchange_begin(const scree_pull *pulls, const scree_ring *fans,
                          scree_relaxation *relaxations);

/* Where the one or two are at this share of their steps. */
void scree_relax_places(const scree_relaxation *relaxations, int count, double share, vec3 *places);

/* Whether with the vertices there the sum of the squared distances is smaller and no place is
 * farther off than the worst was, or is allowed to be. */
bool scree_relax_gains(const scree_memory *memory, const scree_halfmesh *s,
                       scree_relaxation *relaxations, int count, const vec3 *places);

#endif
