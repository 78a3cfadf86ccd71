/* Studies: many runs, and what they say. */
#ifndef SCREE_STUDY_H
#define SCREE_STUDY_H

#include "scree/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Statistics ---- */

/* Mean and spread of a few values. NaN where there are too few: one value has a mean and nothing
 * else. */
typedef struct scree_summary {
  size_t count; /* values that are numbers; NaN are left out */
  double mean;
  double sd;                  /* with count - 1 */
  double cv;                  /* coefficient of variation: sd / |mean| */
  double mean_low, mean_high; /* confidence interval of the mean: Student's t */
  double sd_low, sd_high;     /* and of the standard deviation: chi-square */
} scree_summary;

/* Two means compared: are they the same but for `margin`, are they different, or cannot this be
 * told? Equivalence is shown by two one-sided tests (Schuirmann 1987) with Welch's degrees of
 * freedom: the 1 - 2 alpha interval of the difference lies within (-margin, margin). */
typedef struct scree_comparison {
  double difference;    /* mean of a less mean of b */
  double low, high;     /* its 1 - 2 alpha interval */
  double degrees;       /* Welch and Satterthwaite */
  double p_equivalence; /* the larger of the two one-sided p */
  double p_difference;  /* two-sided Welch test of equal means */
  bool equivalent;      /* p_equivalence < alpha */
  bool different;       /* p_difference < alpha, and not equivalent */
  size_t count_needed;  /* values a side at which equivalence would be shown, if means and spread
                           stayed as they are; 0: never (|difference| >= margin), or not known */
} scree_comparison;

/* Both need two values at least; with fewer all is NaN and false. */
SCREE_API scree_comparison scree_compare(const scree_summary *a, const scree_summary *b,
                                         double margin, double alpha);

/* y = factor x^exponent, by least squares on logarithms. */
typedef struct scree_power_law {
  size_t count;                       /* points with x and y above zero */
  double factor, exponent;            /* */
  double exponent_low, exponent_high; /* confidence interval, Student's t; NaN with two points */
  double r2;                          /* of the logarithms */
} scree_power_law;

enum { SCREE_POLYNOMIAL_DEGREE = 4 };

/* y = sum of coefficient[k] x^k, by least squares (Householder). */
typedef struct scree_polynomial {
  size_t count;
  int degree;
  double coefficient[SCREE_POLYNOMIAL_DEGREE + 1];
  double rms, r2; /* misfit in units of y, and 1 - residual / total sum of squares */
} scree_polynomial;

SCREE_API double scree_polynomial_value(const scree_polynomial *fit, double x);

/* ---- A study: points, replicates, runs ---- */

/* A study's file (docs/reference/study.md) and the runs that follow from it: at every point of
 * a design, as many replicates as wanted, each with its own seed. */
typedef struct scree_study scree_study;

/* Reads the file and makes the plan; touches no shape. Errors name file, line, column, key, value
 * and limit. Free with scree_study_free. */
SCREE_API scree_status scree_study_read(const char *path, scree_study **study, scree_error *error);
SCREE_API void scree_study_free(scree_study *study);

/* A run of the plan. Texts belong to the study. */
typedef struct scree_study_run {
  size_t point, replicate;
  uint64_t seed;
  const char *label;  /* the point's factors and values, "rp 0.001, friction 0.3" */
  const char *rp;     /* a number, "scan", "spheres" or "clump:20" */
  const char *shapes; /* names, joined by + */
  const char *key;    /* names the run by what its numbers follow from; NULL before
                         scree_study_prepare */
} scree_study_run;

/* Runs are numbered so that every point has its first replicate before any has its second. */
SCREE_API size_t scree_study_run_count(const scree_study *study);
SCREE_API scree_status scree_study_get_run(const scree_study *study, size_t index,
                                           scree_study_run *run, scree_error *error);

/* ---- Working on a study ---- */

/* How this process takes part. Any number of processes on any machines that share the folder may
 * work on it at the same time; none of them is special, and any may be killed. */
typedef struct scree_study_options {
  double lease_s;   /* a run whose worker has given no sign of life for so long is taken over;
                       default 300. On the same machine a dead process is seen at once. */
  double poll_s;    /* pause before looking again where others hold all that is left; default 1 */
  bool wait;        /* stay until every run has ended, to take over what others leave; default true:
                       else return when nothing is to be taken */
  size_t run_limit; /* at most so many runs by this process; 0 (default): no limit */
  const char *worker; /* a name for the table; NULL: made from machine and process */
} scree_study_options;
SCREE_API scree_study_options scree_default_study_options(void);

/* Opens the folder for the study, making it where need be, and puts a copy of the file there. A
 * folder that belongs to other shapes under the same names is refused. */
SCREE_API scree_status scree_study_open(scree_study *study, const char *folder, scree_error *error);
/* The study of a folder, from the copy of its file: for status and analysis. */
SCREE_API scree_status scree_study_open_folder(const char *folder, scree_study **study,
                                               scree_error *error);

/* Makes what the runs need and the folder does not have yet: each shape is read, checked, repaired
 * where need be, decimated once, and its levels written to FOLDER/shapes. options may be NULL: the
 * defaults. */
SCREE_API scree_status scree_study_prepare(scree_study *study, const scree_study_options *options,
                                           const scree_progress *progress, scree_error *error);

/* Lets the runs that failed wait again; their reasons are kept. Needs scree_study_prepare. */
SCREE_API scree_status scree_study_reopen(scree_study *study, scree_error *error);

/* Takes runs, one after the other, and works on each to its end. A run that fails is recorded with
 * its reason and the next is taken. SCREE_CANCELLED leaves a checkpoint and gives the run back.
 * Needs scree_study_prepare. options may be NULL: the defaults. *completed (may be NULL): runs
 * ended here. */
SCREE_API scree_status scree_study_work(scree_study *study, const scree_study_options *options,
                                        const scree_progress *progress, size_t *completed,
                                        scree_error *error);

/* Brings FOLDER/study.sqlite up to date: the plan, the state of every run, the results of those
 * that ended. One process writes at a time; with wait false, another one at work is not waited for.
 * All that is in the database comes from files in the folder: one that is damaged may be deleted,
 * and is made again. */
SCREE_API scree_status scree_study_collect(scree_study *study, bool wait, scree_error *error);

/* ---- What a study says ---- */

typedef struct scree_study_counts {
  size_t waiting, leased, running, done, failed; /* runs */
} scree_study_counts;

/* One point of the design. Texts belong to the result. */
typedef struct scree_point_result {
  const char *label, *rp, *shapes;
  const char *pile; /* key of its first run done: the heap to look at; NULL: none yet */
  double rp_value;  /* 1 for the scan, NaN for spheres and clumps */
  scree_study_counts counts;
  size_t heap_count;       /* runs done that have an angle */
  double triangle_count;   /* mean over the particles; 0 for spheres and clumps */
  scree_summary angle_deg; /* of repose, by the study's way, of the runs with a heap */
  scree_summary seconds;   /* processor time of a run */
  scree_summary *numbers;  /* of its heaps, as the result's `numbers` are called */
  scree_summary *answers;  /* of a scene, as many as the study has */
  const char **values;     /* of the factors, as many as the study has */
  /* Mean over the replicates of the particles' mean |omega|, against the time since the cylinder
   * began to rise, with one standard deviation either way. A run that ended still counts with its
   * last value, another one no longer. */
  size_t series_count;
  double *time, *rotation, *rotation_low, *rotation_high; /* s, rad/s */
} scree_point_result;

typedef enum scree_in_range {
  SCREE_IN_RANGE_UNKNOWN,
  SCREE_IN_RANGE_YES,
  SCREE_IN_RANGE_NO
} scree_in_range;

/* The Rp chosen for the shapes of a run; NaN where some are not made yet. */
typedef struct scree_rp_pick {
  double low, mean, high;  /* the mean is geometric */
  scree_in_range in_range; /* whether even the lowest lies at or above the Rp converged from */
} scree_rp_pick;

/* Points that differ in rp only. */
typedef struct scree_family_result {
  const char *label;             /* what they have in common; "" where rp is the only factor */
  size_t *levels;                /* indices of points, Rp rising; spheres, clumps left out */
  scree_comparison *comparisons; /* of each level with the finest; the last one is not used */
  size_t level_count;
  size_t spheres; /* index of the point with spheres; SIZE_MAX: none */
  /* The angle has converged from this level on: it and every finer one are equivalent to the finest
   * within the margin, tested from fine to coarse until one fails, so that the error rate of the
   * whole is that of one test. level_count - 1: only the finest itself, which says nothing. */
  size_t converged_from;
  bool converged;                              /* at least one other level is equivalent */
  scree_rp_pick by_ip, by_robust, recommended; /* by Ip on the grid, by the robust criterion, and
                                                  the recommended ones */
  scree_power_law time_law;    /* seconds against Rp, all runs; count 0: too few levels */
  scree_polynomial time_curve; /* the paper's fourth order; count 0: too few levels */
} scree_family_result;

typedef struct scree_failure {
  const char *label, *reason;
  size_t replicate;
} scree_failure;

/* A file that a result is of. */
typedef struct scree_input {
  const char *path;
  scree_checksum checksum; /* of its bytes; of a built-in sample, of its name and options */
} scree_input;

/* By which command a result was made, when, on what and of which files. */
typedef struct scree_origin {
  const char *command;   /* the caller may set it; NULL: not known */
  const char *machine;   /* of the last run; NULL: none has ended */
  double started, ended; /* of the runs that have ended, s since 1970; 0: none has */
  size_t input_count;
  scree_input *inputs;
} scree_origin;

typedef struct scree_study_result {
  const char *name, *design, *method, *angle, *version;
  scree_origin origin;
  size_t replicate_count, point_count, factor_count;
  /* What is told of the heaps of a scene with a pile besides the angle: columns of the runs' table,
   * "left", the share of the particles that fell off the disc, and "peak_rotation", rad/s: the
   * greatest mean rotation after the lift began. */
  const char **numbers;
  size_t number_count;
  const char **answers; /* of a scene: their names */
  const char **units;   /* of the answers; "" of pure numbers */
  const char **factors; /* their keys */
  size_t answer_count;  /* 0: an experiment's */
  uint64_t seed;
  double margin_deg, confidence;
  scree_study_counts counts;
  size_t worker_count;  /* at work now */
  double seconds_spent; /* processor time of the runs done */
  double
      seconds_left; /* on the clock with as many workers as now (none: with one); NaN: not known */
  bool mixed_versions; /* runs were made by different versions of scree */
  scree_point_result *points;
  scree_family_result *families; /* those with two Rp or more */
  size_t family_count;
  scree_failure *failures;
  size_t failure_count;
  void *memory; /* private */
} scree_study_result;

/* From the database (scree_study_collect). Free with scree_study_result_free. */
SCREE_API scree_status scree_study_analyse(const scree_study *study, scree_study_result *result,
                                           scree_error *error);
SCREE_API void scree_study_result_free(scree_study_result *result);

#ifdef __cplusplus
}
#endif
#endif
