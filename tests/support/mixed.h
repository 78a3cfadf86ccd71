/* A small world with some of everything: meshes convex and not, clumps, spheres; planes, a
 * cylinder, a mesh wall and a disc, fixed, moving and turning. */
#pragma once

#include "scree.h"

/* 27 bodies in a heap, falling at 0.3 m/s; many touch within a thousand steps. */
scree_world *mixed_world(scree_law law);
