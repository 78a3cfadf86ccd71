/* The last collapses look ahead: of the cheapest that are allowed, those after which the level is
 * best as it is are each done with the moves after it on a copy of the surface, and the one is
 * taken after which the level is best then. */
#ifndef SCREE_SIMPLIFY_AHEAD_H
#define SCREE_SIMPLIFY_AHEAD_H

#include "simplify/trial.h"

/* From how many triangles on, later with large scans; how many collapses are looked at, and how
 * many of them are tried; of large scans two are, for it takes time. */
enum {
  SCREE_AHEAD_COUNT = 200,
  SCREE_AHEAD_LATE = 130,
  SCREE_OFFER_COUNT = 16,
  SCREE_OFFERS_OF_LARGE = 2,
  SCREE_TRIAL_COUNT = 4
};

static inline size_t scree_ahead_from(const scree_decimator *d) {
  return scree_is_large(d) ? SCREE_AHEAD_LATE : SCREE_AHEAD_COUNT;
}

/* How good a level is by the mean distance of its witnesses and the distance of its farthest place:
 * the less, the better. What the latter counts hangs on the scan (ahead.c). */
double scree_level_score(const scree_decimator *d, double mean, double farthest);
/* ... of its level as it is. */
double scree_level_score_now(const scree_decimator *d);
/* Scores that differ by no more of themselves are the same. */
#define SCREE_SAME_SCORE 1e-9

/* A collapse that is allowed now. It must stay where it is in memory. */
typedef struct scree_offer {
  uint32_t edges[SCREE_RING_MAX];
  scree_ring ring; /* its edges are those */
  scree_change change;
  scree_around around;
  double error;
} scree_offer;

/* One of the collapses done on a copy. */
typedef struct scree_outcome {
  scree_trial trial;
  bool *moved; /* per vertex: it lies elsewhere than before, or is the survivor */
  double farthest2, score;
  scree_status status;
  size_t offer; /* which */
} scree_outcome;

typedef struct scree_ahead {
  scree_outcome outcomes[SCREE_TRIAL_COUNT];
  const scree_outcome *best;
  const scree_step *from;
  const scree_offer *offers;
  double mean, scores[SCREE_OFFER_COUNT]; /* of the witnesses now; of the offers without moves */
  /* Of the surface as it is: the squared distances of its vertices, and by half-edges the largest
   * of the places on its edges, each or `least2`, where it is smaller. */
  double *of_vertex2, *of_edge2, least2;
} scree_ahead;

/* Before: what is gone leaves the surface and the memory, if it is kept, so that copies are small.
 */
scree_status scree_ahead_prepare(scree_decimator *d);
/* The memory must be kept, and nothing of the grid be listed. Free what it holds whatever the
 * outcome. */
scree_status scree_ahead_begin(scree_ahead *ahead, const scree_decimator *d);
void scree_ahead_free(scree_ahead *ahead);

/* Finds the best of the offers, cheapest first; of equal ones the first. Side by side. */
size_t scree_ahead_find(scree_ahead *ahead, scree_step *step, const scree_offer *offers,
                        size_t count);
/* The decimator becomes what the offer found made of it, record and all; step->touched tells of it.
 */
scree_status scree_ahead_take(scree_ahead *ahead, scree_step *step);

#endif
