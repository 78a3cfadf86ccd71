/* The last collapses look ahead: of the cheapest that are allowed, each is done with the moves
 * after it on a copy of the surface, and the one is taken after which the level is best. */
#ifndef SCREE_SIMPLIFY_AHEAD_H
#define SCREE_SIMPLIFY_AHEAD_H

#include "simplify/step.h"

/* From how many triangles on, later with large scans; how many collapses are tried. */
enum { SCREE_AHEAD_COUNT = 160, SCREE_AHEAD_LATE = 100, SCREE_OFFER_COUNT = 4 };

/* A collapse that is allowed now. It must stay where it is in memory. */
typedef struct scree_offer {
  uint32_t edges[SCREE_RING_MAX];
  scree_ring ring; /* its edges are those */
  scree_change change;
  scree_around around;
  double error;
} scree_offer;

/* The surface with one of the collapses done: a decimator of its own, which has of the other one
 * what does not change. */
typedef struct scree_trial {
  scree_decimator d;
  scree_step step;
  double mean, bound, score; /* of the witnesses; of the score from below; INFINITY: not needed */
  scree_status status;
} scree_trial;

typedef struct scree_ahead {
  scree_trial trials[SCREE_OFFER_COUNT];
  const scree_step *from;
  scree_offer *offers;
} scree_ahead;

/* Before: what is gone leaves the surface and the memory, if it is kept, so that copies are small.
 */
scree_status scree_ahead_prepare(scree_decimator *d);
/* The memory must be kept, and nothing of the grid be listed. Free what it holds whatever the
 * outcome. */
scree_status scree_ahead_begin(scree_ahead *ahead, const scree_decimator *d);
void scree_ahead_free(scree_ahead *ahead);

/* Does all offers, side by side; answers the best, or of equal ones the first. */
size_t scree_ahead_find(scree_ahead *ahead, const scree_step *step, scree_offer *offers,
                        size_t count);
/* The decimator becomes what offer `which` made of it, record and all; step->touched tells of it.
 */
scree_status scree_ahead_take(scree_ahead *ahead, size_t which, scree_step *step);

#endif
