/* Single collapses, from where the batches end down to the floor. */
#ifndef SCREE_SIMPLIFY_ENDING_H
#define SCREE_SIMPLIFY_ENDING_H

#include "simplify/decimate.h"

/* Where the ways to the coarsest levels of method `volume` part, in triangles; with large scans
 * later, for it takes time. */
enum { SCREE_PARTING_COUNT = 1000, SCREE_PARTING_LATE = 330 };

enum { SCREE_MOST_ENDINGS = 3 };

/* From there on by each of these rules (SCREE_MOST_ENDINGS at the most), the first of which makes
 * the record; of the levels that look ahead (ahead.h) the record gets the best of all ways, settled
 * and whole, and no collapses. The surface becomes that of the first way. */
scree_status scree_decimate_endings(scree_decimator *d, const scree_rule *rules, size_t rule_count);

#endif
