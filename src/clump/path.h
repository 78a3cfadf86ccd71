/* The best clump found of each count of spheres. */
#pragma once

#include "base/progress.h"
#include "clump/field.h"
#include "clump/step.h"

/* Where a sphere may be added: points inside a body, and how deep they lie. */
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

typedef struct scree_trial {
  size_t count; /* 0: none yet */
  scree_sphere spheres[SCREE_MOST_SPHERES];
  scree_overlap overlap;
} scree_trial;

/* Everything that the search works with. */
typedef struct scree_path {
  const scree_target *body;
  scree_distance_field field;
  scree_ruler ruler;
  scree_mover mover;
  scree_sphere_sites places;
  size_t most;              /* counts to answer for */
  size_t room;              /* counts that are searched: some more, as a start for the way down */
  scree_trial *best, *work; /* room + 1, by count; 4 to work with */
  scree_ticker ticker;
  bool cancelled;
} scree_path;

/* most: at most SCREE_MOST_SPHERES - 8. most_outside: see scree_mover. */
scree_status scree_path_make(const scree_target *body, size_t most, double most_outside,
                             const scree_progress *progress, scree_path *path, scree_error *error);
void scree_path_free(scree_path *path);

/* Fills best. Counts that are no better than a smaller one by 1e-4 of IoU have count 0. */
scree_status scree_path_search(scree_path *path, scree_error *error);

/* Measures, and takes it as the best of its count where it is better: false where it is not. */
bool scree_path_keep(scree_path *path, scree_trial *trial);
