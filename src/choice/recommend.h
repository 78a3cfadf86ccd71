/* The recommended level: the coarsest that keeps every tolerance. */
#pragma once

#include "choice/gauge.h"

typedef struct scree_recommended {
  size_t level_index, triangle_count;
  scree_gauge_reading reading; /* by the dense measurement */
  /* What the next coarser level is refused for, and how much of it that has; of the last level the
   * error nearest to its tolerance. */
  scree_shape_error limited_by;
  double beyond;
  bool is_last;
} scree_recommended;

/* The gauge that answers are measured with, from the quick one, which it borrows from. */
scree_status scree_recommend_gauge(const scree_gauge *quick, scree_gauge *dense,
                                   scree_error *error);

/* Finds the recommended level of a curve, of fewer than `below` triangles; SIZE_MAX: any, and one
 * is always found, if only the scan. */
scree_status scree_recommend(const scree_curve *curve, const scree_gauge *quick,
                             const scree_gauge *dense,
                             const double tolerances[SCREE_SHAPE_ERROR_COUNT], size_t below,
                             bool *is_found, scree_recommended *found, scree_error *error);
