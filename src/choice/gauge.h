/* A scan made ready to have levels held against it. */
#pragma once

#include "base/error.h"
#include "base/vec.h"
#include "mesh/measure/extent.h"
#include "mesh/measure/surface.h"

/* Points spread evenly over a surface, each standing for the same share of its area. */
typedef struct scree_spread {
  size_t count;
  vec3 *points;
  vec3 *normals; /* unit, of the facet that the point lies on */
  /* The surface's vertices, those near point i from starts[i] to starts[i + 1], and how far the
   * farthest of them lies from it. */
  uint32_t *vertices, *starts;
  double *reach;
} scree_spread;

/* Spreads about `count` points over a verified mesh with area. The same points for any number of
 * threads. O(N). */
scree_status scree_spread_make(const scree_mesh *mesh, size_t count, scree_spread *spread,
                               scree_error *error);
void scree_spread_free(scree_spread *spread);

/* What quadrics fitted to the vertices round points say of the scan as a whole, without its
 * scanner's noise. */
typedef struct scree_fit {
  double sigma;      /* of the noise, m: 0 where what is rough is shape, NaN where the mesh is too
                        coarse or too rough to tell */
  double area_share; /* clean area / area, at most 1; 1 where the noise cannot be told */
} scree_fit;

/* Fits round each of the points (on the mesh, of the outward unit normals given) and replaces its
 * normal by the fitted surface's, where that fits. O(vertices + points). */
scree_status scree_fit_points(const scree_mesh *mesh, const vec3 *points, vec3 *normals,
                              size_t count, scree_fit *fit, scree_error *error);

/* A place where the body has two sides. */
typedef struct scree_body_wall {
  uint32_t point; /* of the spread */
  vec3 middle;    /* between the sides */
  vec3 inward;    /* unit, from the point to the other side */
  double thickness;
} scree_body_wall;

typedef struct scree_gauge {
  const scree_mesh *scan;
  scree_surface *surface;
  bool refined; /* by scree_gauge_refine: the surface is another gauge's */
  scree_measures measures;
  double length, clean_area;
  scree_extent extent; /* in the frame of its least box */
  scree_fit fit;
  scree_spread spread;
  size_t probe_step, probe_count; /* every so many points are probes: */
  vec3 *probe_normals;            /* free of noise */
  scree_body_wall *walls;
  size_t wall_count;
  double thickness, thinnest; /* median and first percentile; NaN without walls */
} scree_gauge;

/* What is found of one level. */
typedef struct scree_gauge_reading {
  double errors[SCREE_SHAPE_ERROR_COUNT], changes[SCREE_CHANGE_COUNT];
  double farthest[3];
} scree_gauge_reading;

/* What the errors of levels are measured with: points over the scan, and the gap of the Hausdorff
 * distance. */
enum { SCREE_GAUGE_POINTS = 10000 };
#define SCREE_GAUGE_GAP 0.01

/* The mesh is borrowed. point_count points are spread over it. Free with scree_gauge_free. */
scree_status scree_gauge_make(const scree_mesh *scan, size_t point_count, scree_gauge *gauge,
                              scree_error *error);
/* The same of more points, which borrows from the first. What it reads is for telling: within
 * facets of a coarse scan the farthest point is looked for too. */
scree_status scree_gauge_refine(const scree_gauge *gauge, size_t point_count, scree_gauge *refined,
                                scree_error *error);
void scree_gauge_free(scree_gauge *gauge);

/* The Hausdorff distance is known to `gap` of itself. Where tolerances are given, and an error
 * found is above its own, those that take longer to find may stay 0. */
scree_status scree_gauge_read(const scree_gauge *gauge, const scree_mesh *level, double gap,
                              const double *tolerances, scree_gauge_reading *reading,
                              scree_error *error);

/* The largest error over its tolerance; *which is that error (may be NULL). Errors that are NaN do
 * not count. */
double scree_normalised_error(const double errors[SCREE_SHAPE_ERROR_COUNT],
                              const double tolerances[SCREE_SHAPE_ERROR_COUNT],
                              scree_shape_error *which);

/* scree_fidelity_measure with a gauge at hand. */
scree_status scree_fidelity_sweep(const scree_gauge *gauge, const scree_curve *curve,
                                  const size_t *level_indices, size_t level_count,
                                  const scree_progress *progress, scree_fidelity **fidelity,
                                  scree_error *error);

/* Whether the row's level is one of scree_fidelity_levels. Choices are made from these alone, so
 * that they do not depend on the other levels asked for. */
bool scree_fidelity_is_usual(const scree_fidelity *fidelity, size_t row);

/* Adds a row at its place, or replaces the one of that level. */
scree_status scree_fidelity_insert(scree_fidelity *fidelity, size_t level_index,
                                   size_t triangle_count, const scree_gauge_reading *reading,
                                   size_t *row, scree_error *error);
