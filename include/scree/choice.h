/* The choice. */
#ifndef SCREE_CHOICE_H
#define SCREE_CHOICE_H

#include "scree/fidelity.h"

#ifdef __cplusplus
extern "C" {
#endif

/* From a curve to a triangle count, by one of two rules.
 *
 * recommended, the default: the coarsest level that keeps a tolerance on each of several errors
 * against the scan (scree/fidelity.h). It is the same for scans of any resolution and noise, and
 * gives every body the same fidelity.
 *
 * paper: the least Ip on a logarithmic grid of Rp = N / Nm (Katagiri and Koyanaka 2020, eq. 1 and
 * 2), to repeat what they did:
 *
 *     eps_s(N) = |S(N) - S_ref| / S_ref        Ip(N) = eps_s(N) + w N / Nm
 *
 * with S the surface area at N triangles, Nm the scan's count, S_ref the scan's area and w = 1.
 *
 * Beside them reports show the robust level: the least of (worst eps_s at N or any finer level) +
 * w N / Nm, over every level. eps_s falls to zero where S crosses S_ref by accident, the worst so
 * far does not. docs/background/method.md says why, with figures. */

#define SCREE_CHOICE_RULE_LIST(X)                                                                  \
  X(RECOMMENDED, "recommended")                                                                    \
  X(PAPER, "paper")

typedef enum scree_choice_rule {
#define SCREE_CHOICE_RULE_ENUM(name, text) SCREE_RULE_##name,
  SCREE_CHOICE_RULE_LIST(SCREE_CHOICE_RULE_ENUM)
#undef SCREE_CHOICE_RULE_ENUM
      SCREE_RULE_COUNT
} scree_choice_rule;

SCREE_API const char *scree_choice_rule_name(scree_choice_rule rule);

typedef enum scree_reference {
  SCREE_REFERENCE_SCAN,   /* "scan", the default: Sm, the scan's own area, as in the paper */
  SCREE_REFERENCE_SMOOTH, /* "smooth": the area on the plateau past the scanner's noise, measured on
                             the curve; the scan's area where no noise is found */
} scree_reference;

typedef struct scree_choice_options {
  double weight;         /* w, > 0; 1: the paper, eq. 2 */
  double rp_min, rp_max; /* ends of the grid, 0 < rp_min <= rp_max <= 1; 1e-5, 1e-1: the paper */
  int per_decade;        /* grid points per factor of ten, 1..1000; 9 */
  scree_reference reference; /* S_ref of paper and robust; SCREE_REFERENCE_SCAN */
  /* Of the recommended choice, by error: the most it may be, a share; INFINITY: any. Of those that
   * a scan has none of (NaN) nothing is asked. */
  double tolerances[SCREE_SHAPE_ERROR_COUNT];
  /* The same for distances, in metres: with the share, whichever is less; INFINITY: any. */
  double tolerance_lengths[SCREE_SHAPE_ERROR_COUNT];
  bool area_only; /* no errors but area's and volume's, and no recommended choice; false */
  /* All errors of the grid's levels above 2,500 triangles too: such levels are dear to measure, and
   * the recommended choice does not need them; false */
  bool fine_errors;
} scree_choice_options;

/* The tolerances: mean distance 0.3 %, Hausdorff distance 4 %, inertia 2 %, widths 3 %, thickness 3
 * %. */
SCREE_API scree_choice_options scree_default_choice_options(void);

/* Point `index` of the grid: rp_min 10^(index / per_decade); index 0 is rp_min. */
SCREE_API double scree_choice_grid_rp(const scree_choice_options *options, size_t index);

/* rp Nm, truncated, the count that an Rp asks for; 1e-3 of 762,000 is 762, however 1e-3 rounds. */
SCREE_API size_t scree_choice_target(double rp, size_t triangle_count);

/* A level at a given Rp: the first level whose count is not above rp Nm, truncated; where the mesh
 * cannot be reduced so far, the last level, and `reached` is false. */
typedef struct scree_choice_level {
  double rp;             /* as asked: the grid's */
  size_t level_index;    /* in the curve */
  size_t triangle_count; /* Nr */
  double rp_reached;     /* Nr / Nm */
  bool reached;
  double area, volume;                    /* m2, m3 */
  double eps_s, ip;                       /* eq. 1 and 2 */
  double worst_eps_s, robust_ip;          /* the monotone envelope and its criterion; with
                                             SCREE_REFERENCE_SMOOTH the levels finer than
                                             noise.level_index do not count */
  double errors[SCREE_SHAPE_ERROR_COUNT]; /* NaN where not measured */
} scree_choice_level;

/* A chosen level. */
typedef struct scree_pick {
  double rp;                     /* of a choice on the grid: the grid's; else Nr / Nm */
  size_t level_index;            /* in the curve */
  size_t triangle_count;         /* Nr */
  double area, volume;           /* m2, m3 */
  double eps_s, ip;              /* eq. 1 and 2 */
  double worst_eps_s, robust_ip; /* as of a level; NaN where not minimised over finer levels */
  /* How sharp the choice is: the coarsest and the finest level whose ip (of the robust choice:
   * robust_ip) is at most SCREE_SIMILAR_IP times this one's, of the trace (of the paper's choice:
   * of the grid) and this level itself. Not every level between need be as good. */
  size_t fewest, most;
} scree_pick;

/* Levels up to this many times the least Ip count as about as good. */
#define SCREE_SIMILAR_IP 1.1

/* The scanner's noise as the curve shows it: area that goes away before the shape does. */
typedef struct scree_noise {
  bool found;
  double area;           /* free of noise, m2; the scan's where none was found */
  double fraction;       /* (Sm - area) / area */
  size_t level_index;    /* of the plateau's end nearest to the scan */
  size_t triangle_count; /* there */
} scree_noise;

/* What is known of one object. */
typedef struct scree_choice {
  size_t triangle_count, floor_count; /* Nm, and the fewest triangles reached */
  int order;             /* of the curve, which level indices are of (scree_curve_reorder) */
  double area, volume;   /* Sm, Vm: m2, m3 */
  double reference_area; /* S_ref, m2 */
  scree_noise noise;
  scree_choice_level *levels; /* the grid, Rp rising */
  size_t level_count;
  scree_choice_level
      *trace; /* the dense curve at SCREE_TRACE_PER_DECADE points per factor of ten of
                 Rp, from rp_min to 1, rising; equal neighbours occur at the floor */
  size_t trace_count;
  scree_pick paper; /* least ip on the grid; ties: fewest triangles, then the Rp nearest to Nr/Nm */
  bool paper_is_accident; /* the error there is below a tenth of the worst at finer levels */
  scree_pick robust;      /* least robust_ip of all levels; ties: fewest triangles */
  /* What paper would choose were the scan's spacing half as large (Nm four times as large) and the
   * curve the same, which it will not be: an estimate. */
  size_t paper_finer_count;
  size_t best[SCREE_SHAPE_ERROR_COUNT]; /* grid index of the least error + w Nr/Nm; level_count
                                           where a level not measured could have less */
  /* Errors of levels, those of the grid among them; NULL with area_only or without the scan. Then
   * what follows is 0, and `recommended` is `robust`. */
  scree_fidelity *fidelity;
  scree_pick recommended;
  double largest_over_tolerance; /* of the recommended level's errors, below 1 */
  size_t recommended_row;        /* in fidelity */
  /* What the next coarser level is refused for, and how much of it that has; NaN: there is none,
   * and limited_by is what is nearest to its tolerance. */
  scree_shape_error limited_by;
  double limit_beyond;
} scree_choice;

/* What was asked of one error of this object, a share: a length is over its size D. */
SCREE_API double scree_choice_tolerance(const scree_choice *choice,
                                        const scree_choice_options *options,
                                        scree_shape_error which);

SCREE_API const scree_pick *scree_choice_pick(const scree_choice *choice, scree_choice_rule rule);

enum { SCREE_TRACE_PER_DECADE = 200 };

/* The Rp with the least mean of a criterion over several objects. */
typedef struct scree_set_pick {
  double rp, ip;
  double rp_low, rp_high; /* the least and the largest Rp whose mean is at most SCREE_SIMILAR_IP
                             times ip; not every Rp between need be as good */
} scree_set_pick;

/* One choice for several objects, as the paper's 1e-3 for its nine: the Rp with the least mean of
 * Ip over the objects. */
typedef struct scree_set_choice {
  size_t object_count;
  double *ip;  /* mean over the objects at each grid Rp */
  double *low; /* least and largest over the objects there: the scatter */
  double *high;
  size_t level_count;
  scree_set_pick paper; /* least mean ip on the grid; ties: the smaller Rp, but of several that give
                           the same levels the one nearest to Nr/Nm */
  double paper_spread;  /* largest over smallest Rp chosen by the objects alone */
  double paper_growth;  /* how many times the triangles at half the spacing, the curves the same */
} scree_set_choice;

/* Chooses from the curve of one object: the recommended level is the coarsest that any of the
 * curve's orders has, and the curve is left in that order, which all level indices are of. scan is
 * the mesh that the curve was built from; it may be NULL, which is as area_only. options NULL means
 * the defaults, progress may be NULL. Errors: SCREE_BAD_MESH where the scan has no area,
 * SCREE_BAD_ARGUMENT, SCREE_OUT_OF_MEMORY, SCREE_CANCELLED. Cost: with area_only one pass over the
 * levels, some ms for 400,000 of them; else 0.2 to 2 times that of the curve, the more the smaller
 * the scan. */
SCREE_API scree_status scree_choose(scree_curve *curve, const scree_mesh *scan,
                                    const scree_choice_options *options,
                                    const scree_progress *progress, scree_choice *choice,
                                    scree_error *error);

SCREE_API void scree_choice_free(scree_choice *choice);

/* A scan of more triangles is simulated at its recommended level where nothing else is asked for:
 * as many are dear. */
enum { SCREE_DENSE_SCAN = 2000 };

/* From a scan to the mesh to simulate it by, in one call: decimates it, method volume, chooses with
 * the defaults, and gives the recommended level. The scan is multiplied by `scale` once it is
 * decimated (scree_curve_build_scaled), 1 for one in metres. It should be closed: see
 * scree_mesh_repair. choice tells what was chosen and why, or is NULL; free both. Fails as
 * scree_curve_build_scaled and scree_choose do. */
SCREE_API scree_status scree_choose_mesh(scree_mesh *scan, double scale,
                                         const scree_progress *progress, scree_mesh *mesh,
                                         scree_choice *choice, scree_error *error);
SCREE_API void scree_set_choice_free(scree_set_choice *set);

/* The set's choice. All objects must have been chosen with the same options. */
SCREE_API scree_status scree_choose_set(const scree_choice *choices, size_t count,
                                        scree_set_choice *set, scree_error *error);

/* Many objects at once, as many as there are threads, each from its mesh to its choice. The two
 * functions are called from any thread, several at a time for different objects. */
typedef struct scree_choice_job {
  size_t count;
  scree_simplify_options simplify;
  scree_choice_options options;
  /* Gives the mesh of object `index`, which is freed for it, and in *scale, which is 1 before, what
   * it is multiplied by once it is decimated (scree_curve_build_scaled); may be called twice for an
   * object where curves need more than 2 GiB together. */
  scree_status (*load)(void *context, size_t index, const scree_progress *progress,
                       scree_mesh *mesh, double *scale, scree_error *error);
  /* Gets each object's curve once all choices are made, to rebuild levels from; NULL: not wanted.
   */
  scree_status (*done)(void *context, size_t index, const scree_curve *curve,
                       const scree_choice *choice, const scree_set_choice *set, scree_error *error);
  void *context;
  /* Gets the error of each object that has no choice, by index, from the calling thread, before
   * `done` is called for the others; NULL: one that fails ends it all. */
  void (*failed)(void *context, size_t index, const scree_error *error);
} scree_choice_job;

/* Fills choices (job->count of them) and *set. Where objects fail the first one's error is
 * reported and all outputs are as freed; with job->failed their choices are as freed, and the set
 * is of the others. Even so the first error is reported where none is left, after `failed` was told
 * of each, and where memory ran out or it was cancelled, which has no object's mesh for a reason:
 * then `failed` is not called. progress->report is called from
 * any thread, by one at a time. The result does not depend on the number of threads. */
SCREE_API scree_status scree_choose_each(const scree_choice_job *job,
                                         const scree_progress *progress, scree_choice *choices,
                                         scree_set_choice *set, scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
