/* How far a collapse of patches and batches may take the surface astray. */
#ifndef SCREE_SIMPLIFY_LIMIT_H
#define SCREE_SIMPLIFY_LIMIT_H

#include "simplify/decimate.h"

/* The squared stray that no collapse of the next pass may exceed; INFINITY: there is none. */
double scree_usual_stray2(const scree_decimator *d);

/* Whether the collapse takes the surface too far off: farther than that, or so far that its whole
 * cost is above the pass's limit, or where passes stall a multiple of it. */
bool scree_strays(const scree_decimator *d, const scree_ring *ring,
                  const scree_candidate *candidate, double cost_limit, double usual2);

/* After a pass that took this share of the triangles: the next one's limits follow. */
void scree_limits_follow(scree_decimator *d, double share);

#endif
