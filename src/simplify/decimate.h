/* The engine: from a surface to the record of its collapses. */
#pragma once

#include "base/progress.h"
#include "simplify/cost/cost.h"
#include "simplify/cost/deviation.h"
#include "simplify/guard/apart.h"
#include "simplify/guard/shape.h"
#include "simplify/record.h"

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
  int leniency;            /* of the guards */
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

/* ---- For the driver's two parts, order/pass.c and order/queue.c ---- */

/* Passes of many independent collapses, side by side, while there are more triangles than that. */
scree_status scree_decimate_in_passes(scree_decimator *d, size_t least);
/* One collapse after the other, always the cheapest, until none is allowed or it is time to find
 * costs anew (scree_tune.refresh). *done: how many. */
scree_status scree_decimate_in_order(scree_decimator *d, size_t *done);

/* Squeezes the surface: all numbers of vertices and half-edges change. */
scree_status scree_decimate_squeeze(scree_decimator *d);
/* Squeezes it, and makes its tree fit and what is known of the samples new. */
scree_status scree_decimate_refresh(scree_decimator *d);
/* Sets what is usual from costs of edges, at least one, which are reordered; answers the cost that
 * a share of them do not exceed. */
double scree_decimate_set_usual(scree_decimator *d, double *costs, size_t count, double share);

/* The best choice for one edge, of its places by their whole costs. */
typedef struct scree_verdict {
  double cost;  /* INFINITY: none is allowed. From `most` on a lower bound */
  double error; /* mean square move */
  vec3 target;
} scree_verdict;

/* Judges the edge by all but what lies beyond the triangles around it (scree_apart). *fan is
 * filled, and set to the target. Thread-safe. */
scree_verdict scree_decimate_judge(const scree_decimator *d, uint32_t half_edge, double most,
                                   scree_fan *fan);

/* Writes the fan's collapse to its place in the record and does it. With fans of which no triangle
 * is common to two, thread-safe. The samples, and the counts of the record and of the surface are
 * the caller's. */
void scree_decimate_collapse(scree_decimator *d, size_t place, const scree_fan *fan, double error);

/* After collapses: counts, and markers. */
void scree_decimate_count(scree_decimator *d, const scree_fan *fan);

/* Tells the ticker how far it has come; false: cancelled. */
bool scree_decimate_tick(scree_decimator *d);
