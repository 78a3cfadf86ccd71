/* Published ways of placing spheres one by one, to compare with and to reproduce. */
#pragma once

#include "clump/path.h"

/* Largest first, equal ones by their centres. */
void scree_spheres_sort(scree_sphere *spheres, size_t count);

/* Fills path->best by the method, which is not SCREE_CLUMP_FITTED; where it gives fewer spheres
 * than path->most, larger counts have count 0. */
scree_status scree_greedy_fill(scree_path *path, const scree_clump_options *options,
                               scree_error *error);
