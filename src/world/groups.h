/* Lists of lists: `count` says how many each owner has, adding up where those of each begin;
 * writers take places by counting down again. */
#pragma once

#include "base/atomic.h"

#include <stddef.h>

typedef struct scree_groups {
  uint32_t *count; /* of `length` owners */
  uint32_t *begin; /* of theirs, and in begin[length] the end of all */
  uint64_t *sums;  /* of chunks */
  size_t length, chunk;
  uint64_t total;
} scree_groups;

/* At least one, which says that there are none. */
static inline size_t scree_groups_chunks(const scree_groups *groups) {
  return groups->length > groups->chunk ? (groups->length - 1) / groups->chunk + 1 : 1;
}
/* Of one chunk; then, when all chunks have their sums, the places of its owners. */
static inline void scree_groups_sum(const scree_groups *groups, size_t chunk) {
  size_t begin = chunk * groups->chunk, end = begin + groups->chunk;
  uint64_t sum = 0;
  for (size_t i = begin; i < end && i < groups->length; i++) sum += groups->count[i];
  groups->sums[chunk] = sum;
}
static inline void scree_groups_place(scree_groups *groups, size_t chunk) {
  size_t begin = chunk * groups->chunk, end = begin + groups->chunk;
  uint64_t sum = 0;
  for (size_t c = 0; c < chunk; c++) sum += groups->sums[c];
  for (size_t i = begin; i < end && i < groups->length; i++) {
    groups->begin[i] = (uint32_t)sum;
    sum += groups->count[i];
  }
  if (end < groups->length) return;
  groups->begin[groups->length] = (uint32_t)sum;
  groups->total = sum;
}

/* A place among those of the owner that nobody else gets. */
static inline uint32_t scree_groups_take(const scree_groups *groups, size_t owner) {
  return groups->begin[owner] + scree_atomic_add(&groups->count[owner], UINT32_MAX) - 1;
}
