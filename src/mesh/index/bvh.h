/* A tree of boxes over the triangles of a mesh, in double precision: nearest points, overlaps of
 * boxes, crossings of rays. Constant once built, so any number of threads may query it. The tree
 * and all answers are the same bits for every number of threads. */
#pragma once

#include "base/tree.h"
#include "mesh/index/closest.h"

#include <string.h>

typedef struct scree_bvh {
  scree_tree tree; /* of the triangles */
  scree_mesh
      mesh; /* its triangles in tree order, its vertices in the order in which these name them */
} scree_bvh;

/* Copies the mesh, so that it may go. Needs a verified mesh. O(N log N), parallel; about 65 bytes
 * per triangle stay, as many more are used while building. */
scree_status scree_bvh_build(const scree_mesh *mesh, scree_bvh *bvh, scree_error *error);
void scree_bvh_free(scree_bvh *bvh);

typedef struct scree_bvh_hit {
  double distance2;
  vec3 point;
  uint32_t index; /* in tree order; tree.order[index] is the triangle of the mesh */
} scree_bvh_hit;

/* Corners of triangle `index`, in tree order. */
static inline void scree_bvh_corners(const scree_bvh *bvh, size_t index, double corners[9]) {
  for (size_t k = 0; k < 3; k++)
    memcpy(corners + 3 * k, bvh->mesh.positions + 3 * (size_t)bvh->mesh.triangles[3 * index + k],
           3 * sizeof *corners);
}

/* The point of the surface nearest to p, if nearer than hit->distance2, which the caller sets
 * (INFINITY, or from a point known to be near, which saves time); else hit is left alone. Equally
 * near triangles: one of them, depending on the bound. */
bool scree_bvh_closest(const scree_bvh *bvh, vec3 p, scree_bvh_hit *hit);

/* The distance from `from` along the unit vector `along` to the first facet beyond `least`,
 * INFINITY where there is none. *facing is the cosine of that facet's outward normal with the ray:
 * positive where the ray leaves the body. A ray through an edge meets at least one of its facets.
 * Flat facets are not met. */
double scree_ray_meet(const scree_bvh *bvh, vec3 from, vec3 along, double least, double *facing);
/* Whether a closed, outward surface has the point within, by the first facet on a ray. */
static inline bool scree_bvh_holds(const scree_bvh *bvh, vec3 p) {
  double facing = 0;
  vec3 along = {0.3085, 0.5747, 0.7580}; /* as good as any */
  return isfinite(scree_ray_meet(bvh, p, vec3_unit(along), 0, &facing)) && facing > 0;
}
