/* The engine: from a surface to the record of its collapses. */
#pragma once

#include "base/error.h"
#include "base/progress.h"
#include "base/vec.h"
#include "simplify/cost/cost.h"
#include "simplify/cost/deviation.h"
#include "simplify/guard/apart.h"

/* The collapses in their order: a progressive mesh (Hoppe 1996). Every prefix is a level. One array
 * per field. Positions and measures are in metres. */
typedef struct scree_collapse_record {
  size_t count, capacity;
  uint32_t *kept,
      *gone;      /* vertices of the mesh given; bit 31 of kept: one triangle goes, not two */
  vec3 *position; /* where kept lies afterwards */
  double *area, *volume; /* while decimating: change of the collapse; then: the level's value */
  float *error;          /* mean square move, unit box; then: running maximum, metres */
} scree_collapse_record;

#define SCREE_ONE_TRIANGLE UINT32_C(0x80000000)

/* Room for so many collapses. */
scree_status scree_collapse_record_allocate(scree_collapse_record *record, size_t capacity,
                                            scree_error *error);
void scree_collapse_record_free(scree_collapse_record *record);
/* Gives back what is worth copying the rest. */
scree_status scree_collapse_record_shrink(scree_collapse_record *record, scree_error *error);
/* to[at ...] becomes from[begin ...]. */
scree_status scree_collapse_record_put(scree_collapse_record *to, size_t at,
                                       const scree_collapse_record *from, size_t begin,
                                       scree_error *error);

static inline uint32_t scree_collapse_record_triangles(const scree_collapse_record *r,
                                                       size_t index) {
  return r->kept[index] & SCREE_ONE_TRIANGLE ? 1 : 2;
}
static inline uint32_t scree_collapse_record_kept(const scree_collapse_record *r, size_t index) {
  return r->kept[index] & ~SCREE_ONE_TRIANGLE;
}

/* The surface at SCREE_FORK_MOST triangles, and its samples: from here on the collapses may go in
 * several orders. Without vertices where there are none. */
typedef struct scree_fork {
  scree_halfmesh s;
  scree_samples samples;
  size_t collapse_count;
} scree_fork;
void scree_fork_free(scree_fork *fork);

typedef struct scree_decimator {
  scree_halfmesh s;
  const scree_coster *coster;
  scree_simplify_options options;
  scree_sum area, volume; /* of the mesh, in the box */
  double error_limit;     /* mean square, unit box; INFINITY: none */
  scree_collapse_record record;
  size_t first_triangle_count;
  scree_surface_tree tree; /* of the surface */
  scree_markers markers;   /* of its shells */
  scree_samples samples;   /* method `volume`, once the fine passes are over */
  double usual_cost;       /* a tenth of the edges cost no more, without deviations */
  double usual_far;        /* the deviation that adds as much; INFINITY: none is usual yet */
  double expect;           /* scree_tune.expect; 0: the cheapest edge always goes first */
  int leniency;            /* of the guards */
  int order;               /* 0: by the costs as they are */
  scree_fork fork;
  scree_ticker ticker;
  scree_error *error;
} scree_decimator;

/* Builds the surface of the mesh, within its box; the record has room. Free with
 * scree_decimator_free, also where it fails. */
scree_status scree_decimator_start(scree_decimator *d, const scree_mesh *mesh,
                                   const scree_simplify_options *options, scree_error *error);
void scree_decimator_free(scree_decimator *d);

/* The whole run: see decimate.c. */
scree_status scree_decimate(scree_decimator *d);

/* In place of both: from the fork to the end in another order. The record is of what is done from
 * there. Serial but for loops that are the same bits for any number of threads. */
scree_status scree_decimate_from(scree_decimator *d, const scree_fork *fork, int order,
                                 const scree_simplify_options *options, scree_error *error);

/* ---- For the driver's two parts, order/pass.c and order/queue.c ---- */

/* Passes over the whole surface, while there are more triangles than that. */
scree_status scree_decimate_in_passes(scree_decimator *d, size_t least);
/* One collapse after the other, always the cheapest, until none is allowed or it is time to find
 * costs anew (scree_tune.refresh). *done: how many. */
scree_status scree_decimate_in_order(scree_decimator *d, size_t *done);

/* Squeezes the surface, so that all numbers of vertices and half-edges change, and makes its tree
 * fit and what is known of the samples new. */
scree_status scree_decimate_refresh(scree_decimator *d);
/* Sets what is usual from costs of edges, at least one, which are reordered; answers the cost that
 * a share of them do not exceed. */
double scree_decimate_set_usual(scree_decimator *d, double *costs, size_t count, double share);

/* The best choice for one edge, of its places by their whole costs. */
typedef struct scree_verdict {
  double cost;  /* INFINITY: none is allowed. From `most` on a lower bound */
  double error; /* mean square move */
  double plain; /* the cost of the best place without deviations */
  vec3 target;
} scree_verdict;

/* Judges the edge by all but what lies beyond the triangles around it (scree_apart). *fan is
 * filled, and set to the target. Thread-safe. */
scree_verdict scree_decimate_judge(const scree_decimator *d, uint32_t half_edge, double most,
                                   scree_fan *fan);

/* Does the fan's collapse, and records it. The samples are the caller's, and which sums and costs
 * are not those of the surface any more. */
void scree_decimate_collapse(scree_decimator *d, const scree_fan *fan, double error);

/* No edge of such a vertex may collapse: what its edges cost is asked for when it has fewer
 * triangles. Else a fan would be summed and ranked anew as a whole for each that it loses. */
bool scree_decimate_is_crowded(const scree_halfmesh *s, uint32_t vertex);
/* Finds the sums of a vertex anew, unless it is crowded or the method merges them. */
void scree_decimate_renew(scree_decimator *d, uint32_t vertex);

/* Tells the ticker how far it has come; false: cancelled. */
bool scree_decimate_tick(scree_decimator *d);
