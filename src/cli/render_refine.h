/* Large triangles cut into small ones in their planes, so that a colour that is known at corners
 * tells what lies between. */
#pragma once

#include "scree.h"

/* Replaces a mesh of fewer than 200,000 triangles by some 400,000; a finer
 * one stays as it is. Freed with scree_mesh_free as before. False: out of memory. */
bool render_refine(scree_mesh *mesh);
