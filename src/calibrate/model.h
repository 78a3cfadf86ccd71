
#include "base/alloc.h"
#include "base/owned.h"

/* A Gaussian process for one answer of a noisy simulation: what the answer is on the mean at every
 * setting of the parameters, how sure that is, and how much single runs scatter there. */
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
/* Only what single runs scatter, and only the mean: O(n). */
double scree_gp_noise(const scree_gp *gp, const double *x);
double scree_gp_mean(const scree_gp *gp, const double *x);
/* Covariances of the means at `count` places, count x count. */
scree_status scree_gp_covariance(const scree_gp *gp, const double *x, size_t count,
                                 double *covariance, scree_error *error);
/* The runs that it was fitted to. */
size_t scree_gp_run_count(const scree_gp *gp);
/* The factor of the noise at a place of active coordinates, beside what is linear in them. */
double scree_gp_factor(const scree_gp *gp, const double *place);

/* ---- for tests ---- */

enum { SCREE_GP_MOST_SETTINGS = 2 * SCREE_MOST_PARAMETERS + 2 };

/* One of the choices of settings that are averaged, the most probable first: logarithms of the
 * lengths, of the variance of the departures from the plane, of the noise in the middle, and the
 * noise's slopes. Answers its share; -1: there are no more. */
double scree_gp_member(const scree_gp *gp, size_t index, double settings[SCREE_GP_MOST_SETTINGS]);
/* Log posterior density of settings, but for a constant, and its gradient. -INFINITY: the matrix is
 * not positive definite. */
double scree_gp_log_density(const scree_gp *gp, const double *settings, double *gradient);
/* All answers of a calibration as Gaussian processes, what was measured of them, and what follows:
 * the density of the parameters, where the next runs tell most, what another measurement would
 * tell. Parameters are coordinates in [-1, 1], each as likely as any other before. */
#pragma once

/* One answer. The real thing is taken to scatter as the simulation does, or as its repeats did,
 * whichever is more. */
typedef struct scree_response {
  size_t experiment;
  scree_gp *gp;
  bool measured; /* `value` counts; else it is a test on offer, or only to be predicted */
  bool predicted;
  double value;        /* mean of the repeats */
  double uncertainty;  /* of measuring, one standard deviation, the same for all repeats */
  double scatter;      /* standard deviation of the repeats; 0: not known */
  double repeat_count; /* measurements that the mean is of */
} scree_response;

typedef struct scree_model {
  size_t dimension_count, count;
  scree_response *items;
  double *correlation; /* count x count: of single runs' scatter; 0 between experiments */
} scree_model;

void scree_model_free(scree_model *model);

/* Variance of the difference between the measured mean and the emulator's. */
double scree_response_variance(const scree_response *response, const scree_gp_value *value,
                               double repeat_count);
/* Log likelihood of all that was measured at x, but for a constant. At most SCREE_MOST_RESPONSES
 * were. */
enum { SCREE_MOST_RESPONSES = 64 };
double scree_model_log_likelihood(const scree_model *model, const double *x);
/* Its square: the distance (Mahalanobis 1936) of what was measured from what each response is said
 * to be, and the logarithm of the determinant of their covariance. At x by the processes. */
double scree_model_distance(const scree_model *model, const scree_gp_value *values,
                            double *log_determinant);
double scree_model_distance_at(const scree_model *model, const double *x, double *log_determinant);

/* Correlations of the answers' scatter within each experiment, from what runs depart from the
 * emulators. y: for each response run_counts[experiment] answers; x likewise per experiment. They
 * are drawn towards 0 where there are few runs. */
scree_status scree_model_correlate(scree_model *model, const double *const *x,
                                   const size_t *run_counts, const double *const *y,
                                   scree_error *error);

/* ---- the next runs ---- */

typedef struct scree_place_pick {
  size_t experiment;
  double x[SCREE_MOST_PARAMETERS];
} scree_place_pick;

typedef struct scree_next_question {
  const double *samples; /* of the posterior, sample_count x d: where it matters, and candidates */
  size_t sample_count, experiment_count;
  const double *const *places; /* of each experiment, where there are runs already: candidates */
  const size_t *place_counts;
  const double *costs; /* of a run of each experiment, in any unit */
} scree_next_question;

/* The `count` runs that together, one after the other, take most of the emulators' variance out of
 * the comparison with what was measured, on the mean over the posterior, for their cost. *left: the
 * share of variance that is the emulators' before these, on the mean over answers. */
scree_status scree_model_next(const scree_model *model, const scree_next_question *question,
                              size_t count, scree_place_pick *picks, double *left,
                              scree_error *error);

/* ---- another measurement ---- */

/* Standard deviations that the parameters (d) are expected to have after `repeat_count` more
 * measurements of each response in `chosen`, on the mean over what these may give. samples as
 * above. */
scree_status scree_model_expect(const scree_model *model, const double *samples,
                                size_t sample_count, const size_t *chosen, size_t chosen_count,
                                double repeat_count, double *sd, scree_error *error);

/* ---- samples of a density known but for its constant, in the box [-1, 1]^d ---- */

/* The logarithm of the density at x; -INFINITY where there is none. Called by several threads. */
typedef double scree_log_density(const void *context, const double *x);

typedef struct scree_ensemble {
  scree_log_density *density;
  const void *context;
  size_t dimension_count;
  size_t walker_count;             /* even, at least 2 (d + 1) */
  size_t first_steps, steps, thin; /* left out at first; of which every `thin`th is kept */
  uint64_t seed;
} scree_ensemble;

static inline size_t scree_ensemble_count(const scree_ensemble *e) {
  return e->walker_count * (e->steps / e->thin);
}

/* scree_ensemble_count x d samples; the same bits for any number of threads. */
scree_status scree_ensemble_sample(const scree_ensemble *ensemble, double *samples,
                                   scree_error *error);
