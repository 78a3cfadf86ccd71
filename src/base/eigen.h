/* Eigenvalues and eigenvectors of symmetric 3x3 matrices. */
#pragma once

#include "base/vec.h"

/* values ascending; row i of axes is the unit eigenvector of value i, the rows right-handed, the
 * largest component of rows 0 and 1 positive. Relative error about 1e-15 of the largest value.
 * Reads the upper triangle of a. */
void scree_eigen_symmetric(const mat3 *a, double values[3], mat3 *axes);

/* Makes three orthonormal rows a right-handed frame whose rows 0 and 1 have their largest component
 * positive: one answer where signs are free. */
void scree_frame_canonical(mat3 *axes);
