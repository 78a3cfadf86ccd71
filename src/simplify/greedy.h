/* One collapse after the other, always the cheapest, with a look ahead or without. */
#ifndef SCREE_SIMPLIFY_GREEDY_H
#define SCREE_SIMPLIFY_GREEDY_H

#include "simplify/ahead.h"

typedef struct scree_greedy scree_greedy;

/* Of the surface as it is; settles: where its vertices move, all of them do together now and then.
 * Free it whatever the outcome. */
scree_status scree_greedy_begin(scree_decimator *d, bool settles, scree_greedy **greedy);
void scree_greedy_free(scree_greedy *greedy);

/* Down to so many triangles, or the floor; ahead may be NULL. */
scree_status scree_greedy_run(scree_greedy *greedy, size_t until, scree_ahead *ahead);
/* At the last level of a run that has a stop: where a run that goes on would settle before it does,
 * the surface settles. */
scree_status scree_greedy_end(scree_greedy *greedy);

/* With which its collapses are done. */
scree_step *scree_greedy_step(scree_greedy *greedy);

#endif
