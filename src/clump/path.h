/* The best clump found of each count of spheres. */
#pragma once

#include "base/progress.h"
#include "clump/sites.h"
#include "clump/step.h"

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
