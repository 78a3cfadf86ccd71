/* Lengths and checksums made to fit, as who forges a file would: behind them lies what is worth
 * testing. */
#pragma once

#include "base/file.h"
#include "base/seal.h"
#include "fuzz/fuzz.h"

/* In the seal of checkpoints (base/seal.h). */
enum { FORGE_LENGTH_AT = 16, FORGE_SUM_AT = 24, FORGE_HEADER = SCREE_SEAL_BYTES };

static inline uint64_t forge_get(const uint8_t *in) {
  uint64_t value = 0;
  for (int i = 0; i < 8; i++) value |= (uint64_t)in[i] << 8 * i;
  return value;
}

static inline void forge_put(uint8_t *out, uint64_t value) {
  for (int i = 0; i < 8; i++) out[i] = (uint8_t)(value >> 8 * i);
}

static inline void forge_sum(uint8_t *out, const uint8_t *bytes, size_t size) {
  scree_checksum sum = scree_checksum_of(bytes, size);
  forge_put(out, sum.high);
  forge_put(out + 8, sum.low);
}

static inline void forge_header(uint8_t *bytes, size_t size) {
  forge_put(bytes + FORGE_LENGTH_AT, size - FORGE_HEADER);
  forge_sum(bytes + FORGE_SUM_AT, bytes + FORGE_HEADER, size - FORGE_HEADER);
}
