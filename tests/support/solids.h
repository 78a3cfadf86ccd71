/* Solids with corners and hollows for the physics tests. All are freed with scree_mesh_free. */
#pragma once

#include "scree.h"

/* A simple polygon (x, y pairs, counter-clockwise) extruded along z from 0 to height. */
scree_mesh solid_prism(const double *xy, size_t corner_count, double height);
/* An open box of the given outer size and wall thickness, 28 triangles. */
scree_mesh solid_tray(double x, double y, double z, double wall);
/* A hook: the letter J of bar width w in a square of side s, extruded by depth. */
scree_mesh solid_hook(double s, double w, double depth);
/* A square block of side s with a V notch of the given half angle in its top, extruded by depth. */
scree_mesh solid_notch(double s, double half_angle, double depth);
/* Every triangle into four, in its plane. Replaces the mesh. */
void solid_split(scree_mesh *mesh);
