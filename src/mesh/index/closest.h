/* The point of a triangle that is nearest to another point. Flat triangles and points are fine. Two
 * others have other bits: contacts (particle/closest.h) ask of the same faces in every step and
 * keep what they need; decimation (simplify/surface_tree.h) asks for the distance alone, an eighth
 * faster.
 */
#pragma once

#include "base/box.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The distance of p from one triangle, squared; *point is the nearest point. */
double scree_triangle_closest(const double corners[9], vec3 p, vec3 *point);
