/* Volume, centre and inertia of solids, and the principal frame. */
#pragma once

#include "base/vec.h"
#include "scree.h"

typedef struct scree_solid {
  double volume;
  vec3 centre;
  mat3 second; /* integral of x x^T about the centre, for density 1 */
} scree_solid;

/* Exact for a closed mesh. */
scree_solid scree_solid_of_mesh(const scree_mesh *mesh);
/* The solid of a union of spheres, by exact chords on a square grid of lines. */
scree_solid scree_solid_of_spheres(const double *centres, const double *radii, size_t count);
/* A rotation as a quaternion (Shepperd 1978). */
quat quat_from_mat3(const mat3 *rotation);
/* Principal moments of inertia, ascending, and the rotation from the principal frame. */
void scree_solid_principal(const scree_solid *solid, vec3 *moments, quat *orientation);
