/* Where a sphere may be added: points inside a body, and how deep they lie. */
#pragma once

#include "clump/field.h"

typedef struct scree_sphere_sites {
  size_t count;
  float *x, *y, *z, *depth;
  float *volume;     /* that each stands for */
  float *left;       /* scratch: from the surface and from the spheres there are */
  uint32_t *cluster; /* scratch */
} scree_sphere_sites;

/* Nodes of the coarse grid, and where that has finer cells, half of theirs. */
scree_status scree_sphere_sites_make(const scree_distance_field *field, scree_sphere_sites *places,
                                     scree_error *error);
void scree_sphere_sites_free(scree_sphere_sites *places);

/* A sphere that may be added, and by how much the volume covered inside would grow, less the weight
 * `outside` of what it would cover outside. */
typedef struct scree_sphere_candidate {
  scree_sphere sphere;
  double gain;
} scree_sphere_candidate;

/* Up to `most` spheres at the deepest points that none of the spheres covers, each out of the
 * others' neighbourhood; most gain first. Their radius reaches a little over the distance free. */
size_t scree_sphere_sites_free_of(scree_sphere_sites *places, const scree_sphere *spheres,
                                  size_t count, double outside, scree_sphere_candidate *found,
                                  size_t most);

/* So many spheres spread evenly: the centroids and volumes of the clusters that Lloyd's iteration
 * makes of the points, from points each farthest from those before. False where there are fewer
 * points. */
bool scree_sphere_sites_spread(scree_sphere_sites *places, size_t count, scree_sphere *spheres);
