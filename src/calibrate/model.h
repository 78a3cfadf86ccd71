/* All answers of a calibration as Gaussian processes, what was measured of them, and what follows:
 * the density of the parameters, where the next runs tell most, what another measurement would
 * tell. Parameters are coordinates in [-1, 1], each as likely as any other before. */
#pragma once

#include "calibrate/gp.h"

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
