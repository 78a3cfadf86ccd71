/* The first facet of a surface along a ray. */
#ifndef SCREE_MESH_INDEX_RAY_H
#define SCREE_MESH_INDEX_RAY_H

#include "mesh/index/bvh.h"

/* The distance from `from` along the unit vector `along` to the first facet beyond `least`,
 * INFINITY where there is none. *facing is the cosine of that facet's outward normal with the ray:
 * positive where the ray leaves the body. A ray through an edge meets at least one of its facets.
 * Flat facets are not met. */
double scree_ray_meet(const scree_bvh *bvh, vec3 from, vec3 along, double least, double *facing);

#endif
