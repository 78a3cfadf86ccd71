/* A Gaussian process for one answer of a noisy simulation: what the answer is on the mean at every
 * setting of the parameters, how sure that is, and how much single runs scatter there. */
#pragma once

#include "base/owned.h"

enum { SCREE_MOST_PARAMETERS = 10, SCREE_GP_MOST_PLACES = 1000 };

/* Runs of a simulation: coordinates in [-1, 1], one answer each. Runs at the very same place are
 * replicates. */
typedef struct scree_gp_runs {
  size_t run_count, dimension_count;
  const double *x;      /* run_count x dimension_count */
  const double *y;      /* NaN: the run gave no such answer, and is left out */
  const size_t *active; /* coordinates that the answer may depend on, rising */
  size_t active_count;
} scree_gp_runs;

typedef struct scree_gp scree_gp;

/* What is known of an answer at a place, in its own unit. */
typedef struct scree_gp_value {
  double mean;
  double variance; /* of that mean: how little is known */
  double noise;    /* variance of single runs about it */
} scree_gp_value;

/* Fits to the runs; the same bits for the same runs. SCREE_BAD_ARGUMENT with fewer than two
 * different places, SCREE_LIMIT with more than SCREE_GP_MOST_PLACES. O(n^3) in different places,
 * some hundred times. */
scree_status scree_gp_fit(const scree_gp_runs *runs, scree_gp **gp, scree_error *error);
void scree_gp_free(scree_gp *gp);
SCREE_OWNABLE(scree_gp)

/* x: dimension_count coordinates. O(n^2). Threads may ask at the same time. */
scree_gp_value scree_gp_at(const scree_gp *gp, const double *x);
/* Only what single runs scatter, and only the mean: O(1) and O(n). */
double scree_gp_noise(const scree_gp *gp, const double *x);
double scree_gp_mean(const scree_gp *gp, const double *x);
/* Covariances of the means at `count` places, count x count. */
scree_status scree_gp_covariance(const scree_gp *gp, const double *x, size_t count,
                                 double *covariance, scree_error *error);
/* The runs that it was fitted to. */
size_t scree_gp_run_count(const scree_gp *gp);

/* ---- for tests ---- */

enum { SCREE_GP_MOST_SETTINGS = 2 * SCREE_MOST_PARAMETERS + 2 };

/* One of the choices of settings that are averaged, the most probable first: logarithms of the
 * lengths, of the variance of the departures from the plane, of the noise in the middle, and the
 * noise's slopes. Answers its share; -1: there are no more. */
double scree_gp_member(const scree_gp *gp, size_t index, double settings[SCREE_GP_MOST_SETTINGS]);
/* Log posterior density of settings, but for a constant, and its gradient. -INFINITY: the matrix is
 * not positive definite. */
double scree_gp_log_density(const scree_gp *gp, const double *settings, double *gradient);
