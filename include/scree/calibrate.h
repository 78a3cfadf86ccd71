/* Calibration: the parameters that measurements can tell, and those that they cannot; and the best
 * settings of a design. */
#ifndef SCREE_CALIBRATE_H
#define SCREE_CALIBRATE_H

#include "scree/study.h"

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A file of docs/reference/calibrate.md: experiments, parameters, what was measured, or what is to
 * be the best. Its runs are those of studies, one for each experiment. */
typedef struct scree_calibration scree_calibration;

/* Reads the file and the scenes that it names. Errors name file, line, column, field and limit.
 * Free with scree_calibration_free. */
SCREE_API scree_status scree_calibration_read(const char *path, scree_calibration **calibration,
                                              scree_error *error);
SCREE_API void scree_calibration_free(scree_calibration *calibration);
/* Whether the file asks for the best settings, and not for what measurements tell. */
SCREE_API bool scree_calibration_is_search(const scree_calibration *calibration);

/* Opens the folder, making it where need be, and puts a copy of the file there. What was done
 * there before counts, also where the file has other targets or another budget by now; other
 * parameters are refused. */
SCREE_API scree_status scree_calibration_open(scree_calibration *calibration, const char *folder,
                                              scree_error *error);
/* From the copy in a folder. */
SCREE_API scree_status scree_calibration_open_folder(const char *folder,
                                                     scree_calibration **calibration,
                                                     scree_error *error);

/* Works as one of any number of workers, in any processes and on any machines that share the
 * folder: takes runs, and plans the next ones when all have ended, until the budget is spent or
 * more runs would tell no more. `batch`: runs planned at a time, at least those of the file.
 * Which runs follow, and so the answer, depends on the results so far and on the batch alone:
 * not on who worked, or was killed. options may be NULL. SCREE_CANCELLED leaves all as it is. */
SCREE_API scree_status scree_calibration_work(scree_calibration *calibration, size_t batch,
                                              const scree_study_options *options,
                                              const scree_progress *progress, scree_error *error);

/* How far it is. */
typedef struct scree_calibration_progress {
  size_t rounds, run_count, done, failed; /* planned so far, and ended of these */
  size_t budget;                          /* runs */
  double seconds;                         /* processor time of the runs that ended */
  double planning_seconds;                /* of planning */
} scree_calibration_progress;
SCREE_API scree_status scree_calibration_look(scree_calibration *calibration,
                                              scree_calibration_progress *progress,
                                              scree_error *error);

/* ---- What it says ---- */

/* Whether the model gives what was measured, by runs at the setting nearest to it. Where it does
 * not, the settings are no answer: there are no intervals, pairs, predictions, samples or advice.
 */
typedef enum scree_agreement {
  SCREE_AGREEMENT_OPEN,
  SCREE_AGREEMENT_YES,
  SCREE_AGREEMENT_NO
} scree_agreement;

/* Texts belong to the result. Intervals are of `confidence`. */
typedef struct scree_parameter_result {
  const char *name, *unit; /* unit: "" where none was given */
  bool logarithmic;
  double from, to;                    /* the range given */
  double nearest;                     /* of the setting nearest to what was measured */
  double mean, sd, median, low, high; /* NaN where the model does not give it */
  double narrowed; /* width of the interval beside that of the range (of logarithms on a log scale):
                      1 says nothing was learnt */
  bool identified; /* narrowed to a half at most, between both ends of the range,
                       where runs gave the answers that were measured */
  /* Where it is narrowed so far by an end of the range: what it is at least, or at most, with
     `confidence`. Else NaN. */
  double at_least, at_most;
} scree_parameter_result;

/* Two parameters that trade against each other. */
typedef struct scree_trade {
  size_t a, b;
  double correlation; /* of their coordinates, linear or logarithmic */
  double share;       /* of the variance of the one that the other tells, 0 to 1 */
  double ends[2][2];  /* two pairs (a, b) along their line that give the same answers */
} scree_trade;

/* An answer: one that was measured, one on offer, one to be predicted. */
typedef struct scree_answer_result {
  const char *name, *experiment, *answer, *unit; /* unit: "" where it is not known */
  bool measured, predicted;
  double value, uncertainty, scatter; /* NaN: not measured */
  double repeat_count;
  double mean, low, high;         /* of the mean answer, over the posterior */
  double single_low, single_high; /* of a single measurement */
  double noise;                   /* standard deviation of single runs */
  size_t run_count, missing;      /* runs that gave it; that gave none */
  /* Of all runs. */
  double lowest, highest;
  /* At the nearest setting, by the runs there: how far that is from what was measured, and the
     standard deviation of such a difference if the model is right; whether it is within it. */
  double gap, gap_sd;
  bool met;
  /* Runs at the nearest setting, which nothing else is told from; the interval that their mean
     was expected in, such that those of all answers hold together with `confidence`. Of a curve
     none. */
  size_t check_count;
  double check_mean, check_low, check_high;
  double counted_low, counted_high; /* of a prediction: low and high with what the check missed */
  bool inside; /* what was measured lies in the interval of such measurements */
  /* Of a curve, else 0 points. */
  size_t point_count;
  double *x, *y, *curve_mean, *curve_low, *curve_high;
  double unexplained; /* root mean square of what no curve of the simulation has */
} scree_answer_result;

/* What `repeat_count` more measurements of an answer are expected to give. */
typedef struct scree_advice {
  const char *name;
  size_t repeat_count;
  double *narrowed;  /* of every parameter, expected */
  size_t identified; /* of how many parameters it would be a half at most */
} scree_advice;

/* Another fit, without one of the measurements: whether the others agree. */
typedef struct scree_refit {
  const char *without;          /* the answer's name */
  bool fits;                    /* the others agree, as the processes have it */
  double *nearest, *low, *high; /* of every parameter: the setting, its interval where they do */
  double *answers;              /* of every answer at that setting; NaN of a curve */
  double value_low, value_high; /* of the one left out, where they do; else NaN */
} scree_refit;

/* A run that was made. */
typedef struct scree_calibration_run {
  const char *experiment;
  uint64_t seed;
  bool check;
  double *values, *answers; /* of every parameter; of every answer, NaN: none, or a curve */
} scree_calibration_run;

/* The best settings of a search, and others that were tried and may be as good. */
typedef struct scree_setting {
  double *values;         /* of every parameter */
  double mean, low, high; /* of the answer sought, on the mean */
  double allowed;         /* probability that all limits hold */
  size_t run_count;
} scree_setting;

typedef struct scree_calibration_result {
  const char *title, *version, *stopped; /* why it stopped; NULL: it has not */
  scree_origin origin;
  bool is_search, maximise;
  scree_agreement agreement;
  /* Squared distance of what was measured from the nearest setting, in the scatter and uncertainty
     of both; beyond the limit the model does not give it. */
  double misfit, misfit_limit;
  double confidence;
  uint64_t seed;
  scree_calibration_progress progress;
  size_t parameter_count, trade_count, answer_count, advice_count, sample_count, history_count;
  scree_parameter_result *parameters;
  scree_trade *trades;
  scree_answer_result *answers;
  scree_advice *advice; /* the best first */
  double *samples;      /* of the posterior, sample_count x parameter_count */
  /* After each round: runs, and narrowed of every parameter; of a search the best mean so far. */
  double *history;    /* history_count x (1 + parameter_count) or x 2 */
  const char *sought; /* of a search: the answer */
  size_t setting_count;
  scree_setting *settings; /* the best first */
  size_t failure_count;
  const char **failures; /* why runs failed, each reason once */
  size_t refit_count;    /* of a model that does not give what was measured */
  scree_refit *refits;
  size_t run_count;
  scree_calibration_run *runs; /* those that gave answers */
  void *memory;                /* private */
} scree_calibration_result;

/* From the results so far; the same bits for the same results. Free with
 * scree_calibration_result_free. SCREE_BAD_ARGUMENT where there are too few to say anything. */
SCREE_API scree_status scree_calibration_analyse(scree_calibration *calibration,
                                                 scree_calibration_result *result,
                                                 scree_error *error);
SCREE_API void scree_calibration_result_free(scree_calibration_result *result);

/* ---- Reports ---- */

/* calibration.json, samples.csv and the figures (corner, answers, history) into a folder; what is
 * there is overwritten. */
SCREE_API scree_status scree_calibration_report_write(const scree_calibration_result *result,
                                                      const char *folder, scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
