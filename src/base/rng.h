/* Counter-based random numbers: value number `counter` of stream `stream` of `seed`, with no state
 * to carry, the same on every machine and in every order of evaluation. The mixing is Philox2x64-10
 * (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3"). */
#pragma once

#include "base/vec.h"

#include <stddef.h>
#include <stdint.h>

/* A cursor for sequential use; copy it to replay. */
typedef struct scree_rng {
  uint64_t seed, stream, counter;
} scree_rng;

/* 64 random bits for (seed, stream, counter). */
uint64_t scree_rng_bits(uint64_t seed, uint64_t stream, uint64_t counter);
uint64_t scree_rng_next(scree_rng *rng);
/* Uniform in [0, 1), 53 bits. */
double scree_rng_uniform(scree_rng *rng);
/* Uniform integer in [0, bound), bound > 0, without bias. */
uint64_t scree_rng_below(scree_rng *rng, uint64_t bound);
/* Puts count items of size bytes, at most 16, into an order of which all are equally likely
 * (Durstenfeld 1964, algorithm 235). */
void scree_rng_shuffle(scree_rng *rng, void *items, size_t count, size_t size);
/* Standard normal. */
double scree_rng_normal(scree_rng *rng);
/* Uniform on the rotation group (Shoemake 1992). */
quat scree_rng_rotation(scree_rng *rng);
/* Uniform on the unit sphere. */
vec3 scree_rng_direction(scree_rng *rng);
