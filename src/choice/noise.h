/* The scanner's noise in the area: where it ends on a curve, and the area without it. */
#pragma once

#include "choice/criterion.h"

/* Never fails; the answer is "none found" where the curve is too short to tell. O(log levels). */
scree_noise scree_noise_find(const scree_level_table *table);
