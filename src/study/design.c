/* Latin hypercube (McKay, Beckman and Conover 1979) and Sobol's sequence in Gray code order with
 * the direction numbers of Joe and Kuo (2008, new-joe-kuo-6), shifted digit by digit (Owen 1995
 * calls it a digital shift): the shift keeps how evenly the points lie. */
#include "study/design.h"

#include "base/rng.h"

enum { LATIN_STREAM = 1 << 20, SOBOL_STREAM = 2 << 20, DIGITS = 32, MOST_DEGREE = 5 };

void scree_design_latin(uint64_t seed, size_t point_count, size_t dimension_count, size_t *order,
                        double *unit) {
  for (size_t d = 0; d < dimension_count; d++) {
    scree_rng rng = {seed, LATIN_STREAM + d, 0};
    for (size_t i = 0; i < point_count; i++) order[i] = i;
    scree_rng_shuffle(&rng, order, point_count, sizeof *order);
    for (size_t i = 0; i < point_count; i++)
      unit[i * dimension_count + d] =
          ((double)order[i] + scree_rng_uniform(&rng)) / (double)point_count;
  }
}

/* Primitive polynomial (degree, inner coefficients as bits) and initial numbers of dimensions 2 to
 * 10; the first is van der Corput's. */
static const struct {
  unsigned degree, inner, initial[MOST_DEGREE];
} directions[SCREE_SOBOL_DIMENSIONS - 1] = {
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
};

static void direction_numbers(size_t dimension, uint32_t v[DIGITS]) {
  for (unsigned k = 0; k < DIGITS; k++) {
    if (dimension == 0) {
      v[k] = 1U << (31 - k);
      continue;
    }
    unsigned s = directions[dimension - 1].degree, inner = directions[dimension - 1].inner;
    if (k < s) {
      v[k] = directions[dimension - 1].initial[k] << (31 - k);
      continue;
    }
    v[k] = v[k - s] ^ (v[k - s] >> s);
    for (unsigned j = 1; j < s; j++)
      if (inner >> (s - 1 - j) & 1) v[k] ^= v[k - j];
  }
}

uint32_t scree_sobol_digits(size_t index, size_t dimension) {
  uint32_t v[DIGITS], digits = 0;
  direction_numbers(dimension, v);
  size_t gray = index ^ (index >> 1);
  for (unsigned k = 0; k < DIGITS; k++)
    if (gray >> k & 1) digits ^= v[k];
  return digits;
}

void scree_design_sobol(uint64_t seed, size_t point_count, size_t dimension_count, double *unit) {
  for (size_t d = 0; d < dimension_count; d++) {
    uint32_t shift = (uint32_t)(scree_rng_bits(seed, SOBOL_STREAM + d, 0) >> 32);
    for (size_t i = 0; i < point_count; i++)
      unit[i * dimension_count + d] = (scree_sobol_digits(i, d) ^ shift) * 0x1p-32;
  }
}
