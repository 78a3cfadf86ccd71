/* Designs: points of the unit cube that fill it evenly. */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { SCREE_SOBOL_DIMENSIONS = 10 };

/* Latin hypercube: in every dimension each of the point_count equal intervals holds one point, at a
 * random place in it. unit: point_count rows of dimension_count values in [0, 1); order: scratch
 * for point_count. */
void scree_design_latin(uint64_t seed, size_t point_count, size_t dimension_count, size_t *order,
                        double *unit);

/* The first point_count points of Sobol's sequence in at most SCREE_SOBOL_DIMENSIONS dimensions,
 * with a random digital shift: a longer design begins with the points of a shorter one. */
void scree_design_sobol(uint64_t seed, size_t point_count, size_t dimension_count, double *unit);

/* Point `index` of the sequence without the shift, as 32 binary digits. */
uint32_t scree_sobol_digits(size_t index, size_t dimension);
