/* Measuring the levels of a curve: what a choice is made from. */
#pragma once

#include "scree.h"

/* Measures the levels of a curve whose indices are given, ascending, in one sweep; level_indices
 * NULL: scree_fidelity_levels of them. scan is the mesh that the curve was built from.
 *
 * Some 10,000 points are spread over the scan, and half as many over each level; means are exact
 * to 3 per cent. The Hausdorff distance is bounded by how far points lie apart, and what could be
 * farther than the largest found is looked at closer, to 1 per cent. Walls are where a ray inward
 * from one of the points meets the surface again, facing back. Noise is what a quadric through the
 * points round each leaves over, as far as that does not depend on how many.
 *
 * The same for any number of threads. Fails with SCREE_BAD_MESH where the scan has no area,
 * SCREE_BAD_ARGUMENT where the indices do not ascend, SCREE_OUT_OF_MEMORY, SCREE_CANCELLED. Cost:
 * 0.2 to 2 times the curve's, the more the smaller the scan. */
scree_status scree_fidelity_measure(const scree_curve *curve, const scree_mesh *scan,
                                    const size_t *level_indices, size_t level_count,
                                    const scree_progress *progress, scree_fidelity **fidelity,
                                    scree_error *error);
void scree_fidelity_free(scree_fidelity *fidelity);
enum { SCREE_FIDELITY_PER_DECADE = 9, SCREE_FIDELITY_FINEST = 2500, SCREE_FIDELITY_MOST = 48 };
/* The levels that a choice is made from: at Rp = 10^(-k / SCREE_FIDELITY_PER_DECADE), as the
 * paper's grid has them, of at most SCREE_FIDELITY_FINEST triangles; from fine to coarse. Fills
 * level_indices, at most SCREE_FIDELITY_MOST of them, and answers how many. */
size_t scree_fidelity_levels(const scree_curve *curve, size_t level_indices[SCREE_FIDELITY_MOST]);
size_t scree_fidelity_count(const scree_fidelity *fidelity);
/* Rows are the levels in the order asked for; row must be below the count. */
size_t scree_fidelity_level_index(const scree_fidelity *fidelity, size_t row);
size_t scree_fidelity_triangle_count(const scree_fidelity *fidelity, size_t row);
