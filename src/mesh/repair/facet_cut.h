/* One facet cut along segments, into triangles with given vertices on its rim and within. */
#pragma once

#include "mesh/io/polygon.h"

/* Vertices are indices of positions. */
typedef struct scree_facet_job {
  const double *positions;
  uint32_t corner[3];
  const uint32_t *rim[3]; /* vertices on the edge from corner k to k + 1, in that order */
  size_t rim_count[3];
  const uint32_t *inner; /* vertices within */
  size_t inner_count;
  const uint32_t *segments; /* two of the vertices above or corners each */
  size_t segment_count;
  double tolerance; /* segments pass through vertices that are nearer */
  bool flat;        /* hardly any area: only the rim counts */
} scree_facet_job;

/* What the work needs; zero it to begin. */
typedef struct scree_facet_cutter scree_facet_cutter;
scree_facet_cutter *scree_facet_cutter_create(void); /* NULL: memory is out */
void scree_facet_cutter_free(scree_facet_cutter *cutter);

/* Appends the triangles, wound as the facet, to out. Their rim is the facet's with all vertices on
 * it, whatever happens, so that neighbours fit. Inner vertices and segments are left out where they
 * do not fit: a vertex that lies outside as the facet is seen along an axis, a segment that crosses
 * an earlier one. False when memory is out. About a microsecond per vertex and segment, more where
 * segments pass many vertices. */
bool scree_facet_cut(scree_facet_cutter *cutter, const scree_facet_job *job, scree_index_list *out);
