/* A face between two pieces as the section of a beam. */
#pragma once

#include "base/error.h"
#include "base/vec.h"

/* Faces below this share of their mean area hold nothing, and are stiff in no way that matters. */
static const double scree_least_face = 1e-4;

/* Fills centre, normal, axis, area, second moments and reach of a face that these triangles make
 * up, three corners each, counter-clockwise as seen from its piece b. */
void scree_section_describe(const vec3 *corners, size_t triangle_count, scree_fracture_face *face);
