/* Names of neighbours. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

static const uint32_t scree_wall_partner = 0x80000000u; /* of a wall's number */

/* First body, then bodies before walls, then the second: neighbours are sorted by it. */
static inline uint64_t scree_key_of(uint32_t a, uint32_t b, bool wall) {
  return (uint64_t)a << 32 | (wall ? scree_wall_partner : 0) | b;
}

static inline uint32_t scree_key_second(uint64_t key) {
  return (uint32_t)key & ~scree_wall_partner;
}
