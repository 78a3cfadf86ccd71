/* The recommended level: the coarsest that keeps every tolerance. */
#pragma once

#include "choice/gauge.h"

/* One level of the sweep as far as the rule sees it: its count, and the largest error over its
 * tolerance. */
typedef struct scree_kept {
  size_t triangle_count;
  double load;
} scree_kept;

/* The least of the trend of load + count / scale, and from which to which count it is at most
 * SCREE_SIMILAR_IP times that. */
typedef struct scree_least {
  double triangle_count, sum; /* counts are not whole */
  double fewest, most;
} scree_least;

scree_least scree_trend_least(const scree_kept *levels, size_t count, double scale);

typedef struct scree_recommended {
  size_t level_index;
  scree_gauge_reading reading; /* by the dense measurement */
} scree_recommended;

/* Finds the recommended level of a curve, of which the sweep is given and the gauge it was made
 * with. */
scree_status scree_recommend(const scree_curve *curve, const scree_gauge *gauge,
                             const scree_fidelity *fidelity,
                             const double tolerances[SCREE_SHAPE_ERROR_COUNT],
                             scree_recommended *found, scree_error *error);
