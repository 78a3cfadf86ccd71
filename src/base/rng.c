#include "base/rng.h"

#include "base/error.h"

#include <string.h>

static const double two_pi = 6.283185307179586476925286766559;

uint64_t scree_rng_bits(uint64_t seed, uint64_t stream, uint64_t counter) {
  uint64_t high = stream, low = counter, key = seed;
  for (int round = 0; round < 10; round++) {
    /* 64 x 64 -> 128 in halves: C17 has no 128-bit integer. */
    const uint64_t m = 0xD2B74407B1CE6E93u;
    uint64_t a = low >> 32, b = low & 0xFFFFFFFFu, c = m >> 32, d = m & 0xFFFFFFFFu;
    uint64_t bd = b * d, ad = a * d, bc = b * c;
    uint64_t middle = (bd >> 32) + (ad & 0xFFFFFFFFu) + (bc & 0xFFFFFFFFu);
    uint64_t product_high = a * c + (ad >> 32) + (bc >> 32) + (middle >> 32);
    uint64_t product_low = low * m;
    low = product_high ^ key ^ high;
    high = product_low;
    key += 0x9E3779B97F4A7C15u;
  }
  return low;
}

uint64_t scree_rng_next(scree_rng *rng) {
  return scree_rng_bits(rng->seed, rng->stream, rng->counter++);
}

double scree_rng_uniform(scree_rng *rng) {
  return (double)(scree_rng_next(rng) >> 11) * 0x1p-53;
}

uint64_t scree_rng_below(scree_rng *rng, uint64_t bound) {
  uint64_t threshold = -bound % bound; /* 2^64 mod bound: below it a value would be counted twice */
  for (;;) {
    uint64_t bits = scree_rng_next(rng);
    if (bits >= threshold) return bits % bound;
  }
}

void scree_rng_shuffle(scree_rng *rng, void *items, size_t count, size_t size) {
  unsigned char kept[16], *bytes = items;
  SCREE_ASSERT(size <= sizeof kept);
  for (size_t i = count; i > 1; i--) {
    unsigned char *last = bytes + (i - 1) * size;
    unsigned char *chosen = bytes + (size_t)scree_rng_below(rng, i) * size;
    memcpy(kept, last, size);
    memcpy(last, chosen, size);
    memcpy(chosen, kept, size);
  }
}

double scree_rng_normal(scree_rng *rng) {
  double u = 1 - scree_rng_uniform(rng), v = scree_rng_uniform(rng);
  return sqrt(-2 * scree_log(u)) * scree_cos(two_pi * v);
}

quat scree_rng_rotation(scree_rng *rng) {
  double u = scree_rng_uniform(rng), a = two_pi * scree_rng_uniform(rng),
         b = two_pi * scree_rng_uniform(rng), p = sqrt(1 - u), q = sqrt(u);
  return (quat){q * scree_cos(b), p * scree_sin(a), p * scree_cos(a), q * scree_sin(b)};
}

vec3 scree_rng_direction(scree_rng *rng) {
  double z = 2 * scree_rng_uniform(rng) - 1, a = two_pi * scree_rng_uniform(rng),
         r = sqrt(1 - z * z);
  return (vec3){r * scree_cos(a), r * scree_sin(a), z};
}
