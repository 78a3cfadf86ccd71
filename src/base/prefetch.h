/* Asking for memory ahead of its use. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Before a function that does nothing but ask: gcc sees no effect in it, and drops its calls unless
 * it is inlined. */
#define SCREE_PREFETCHES __attribute__((always_inline)) static inline

/* The cache lines of `size` bytes from `start`, which may be nowhere. */
SCREE_PREFETCHES void scree_prefetch(const void *start, size_t size) {
  for (size_t at = 0; at < size; at += 64)
    __builtin_prefetch(
        (const void *)((uintptr_t)start + at)); /* NOLINT(performance-no-int-to-ptr) */
}
