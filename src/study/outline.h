/* The outline of what lies in a world, seen along y. */
#pragma once

#include "base/error.h"

/* The greatest z of all bodies' surfaces where x is this, m; 0 where there are none: the floor. */
double scree_outline_height(const scree_world *world, double x);
