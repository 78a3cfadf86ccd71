/* A surface made ready for distance queries, for what asks more of it than the public calls give:
 * which triangle is nearest, and one way of the distance with a head start. */
#pragma once

#include "mesh/index/bvh.h"

struct scree_surface {
  scree_bvh bvh;
  double area, largest_facet, size; /* size: bounding box diagonal */
};

/* The distance of p from the surface; *near is a triangle of its tree to start from, then the
 * nearest. */
double scree_surface_nearest(const scree_surface *surface, vec3 p, uint32_t *near);

/* The same for points of which neighbours in the list are near each other. */
void scree_surface_nearest_points(const scree_surface *surface, const vec3 *points, size_t count,
                                  double *distances, uint32_t *nearest);

/* The facets of one surface that may reach farther than that from the other, as a mesh in which no
 * two share a corner; empty where none may. */
scree_status scree_surface_farther_part(const scree_surface *from, const scree_surface *to,
                                        double than, scree_mesh *part, scree_error *error);

/* How one way is measured. */
typedef struct scree_deviation_rule {
  size_t sample_count; /* spread over the surface */
  bool converge;       /* and four times as many, until the mean is known to 1 per cent */
  double gap;          /* as scree_distance_options.hausdorff_gap */
  double slope;        /* how steep distances are taken to change over a part; 1 is certain */
  double known;        /* m; what is nearer need not be bounded: 0, or a distance known elsewhere */
  /* Samples for bounding, all facets together, but at least cut_least for each: surfaces that all
   * but coincide would be cut without end. */
  size_t cut_budget, cut_least;
} scree_deviation_rule;

enum { SCREE_CUT_BUDGET = 1 << 22, SCREE_CUT_LEAST = 32 };

/* From every point of one surface to the other. */
scree_status scree_surface_deviation(const scree_surface *from, const scree_surface *to,
                                     const scree_deviation_rule *way,
                                     const scree_progress *progress, scree_deviation *deviation,
                                     scree_error *error);
