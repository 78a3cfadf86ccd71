/* A scan without its scanner's noise, point by point: quadrics fitted to the vertices round each.
 */
#pragma once

#include "base/error.h"
#include "base/vec.h"

/* What the fits say of the scan as a whole. */
typedef struct scree_fit {
  double sigma;      /* of the noise, m: 0 where what is rough is shape, NaN where the mesh is too
                        coarse or too rough to tell */
  double area_share; /* clean area / area, at most 1; 1 where the noise cannot be told */
} scree_fit;

/* Fits round each of the points (on the mesh, of the outward unit normals given) and replaces its
 * normal by the fitted surface's, where that fits. O(vertices + points). */
scree_status scree_fit_points(const scree_mesh *mesh, const vec3 *points, vec3 *normals,
                              size_t count, scree_fit *fit, scree_error *error);
