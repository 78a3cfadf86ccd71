/* The criterion on a plain table of levels: no engine needed, so that it can be tested by hand. */
#pragma once

#include "base/error.h"

/* One level of a curve as far as the criterion sees it. */
typedef struct scree_level_row {
  size_t triangle_count;
  double area, volume;
} scree_level_row;

/* Levels from the scan (index 0) to the floor, triangle counts never rising. Rows are fetched one
 * by one, so that a curve of millions of levels needs no second copy. */
typedef struct scree_level_table {
  size_t count;
  scree_level_row (*row)(const void *context, size_t index);
  const void *context;
} scree_level_table;

/* The first level whose count is not above target, or the last. O(log count). */
size_t scree_level_find(const scree_level_table *table, size_t target);

/* Fills *choice (grid, trace, picks, noise) from the table; errors other than area and volume are
 * NaN. O(levels). SCREE_BAD_MESH where the scan has no area, SCREE_BAD_ARGUMENT for bad options. */
scree_status scree_choice_from_table(const scree_level_table *table,
                                     const scree_choice_options *options, scree_choice *choice,
                                     scree_error *error);

scree_status scree_choice_check_options(const scree_choice_options *options, scree_error *error);
/* What is asked of an error on a body of that size, as a share. */
double scree_tolerance_share(const scree_choice_options *options, scree_shape_error which,
                             double length);

/* What is left of Nr/Nm at half the scan's spacing: Nm is four times as large. */
#define SCREE_FINER_PENALTY 0.25

/* The grid index with the least errors[which] + w Nr/Nm (ties as for `paper`), or level_count where
 * a level that was not measured could have less. */
size_t scree_choice_best_level(const scree_choice *choice, scree_shape_error which, double weight);

/* Whether a text means the recommended Rp, as "recommended", or a multiple of it, as
 * "0.5*recommended"; the factor. */
bool scree_choice_is_recommended(const char *rp, double *factor);

/* How many of them lie in [rp_min, rp_max], the ends included (to 1e-9 relative). */
size_t scree_choice_grid_count(const scree_choice_options *options);

/* The scanner's noise in the area: where it ends on a curve, and the area without it. Never fails;
 * the answer is "none found" where the curve is too short to tell. O(log levels). */
scree_noise scree_noise_find(const scree_level_table *table);
