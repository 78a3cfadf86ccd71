/* A growing array in three fields, for plain types:
 *
 *   typedef struct { edge *items; size_t count, capacity; } edge_list;
 *   if (!SCREE_PUSH(&list, value)) return scree_fail_memory(...);
 *
 * One declared with SCREE_CLEANUP(scree_free_at) is freed with its block. */
#pragma once

#include "base/alloc.h"

/* Makes room for at least `needed` items, or for half as many again as there was; false when memory
 * is out (content stays). */
static inline bool scree_array_reserve(void **items, size_t *capacity, size_t needed, size_t size) {
  if (needed <= *capacity) return true;
  size_t grown = *capacity < 8 ? 8 : *capacity + *capacity / 2;
  if (grown < needed) grown = needed;
  void *moved = scree_resize(*items, grown, size);
  if (!moved) return false;
  *items = moved;
  *capacity = grown;
  return true;
}

#define SCREE_RESERVE(list, needed)                                                                \
  scree_array_reserve((void **)&(list)->items, &(list)->capacity, (needed), sizeof *(list)->items)

#define SCREE_PUSH(list, ...)                                                                      \
  (SCREE_RESERVE(list, (list)->count + 1) ? ((list)->items[(list)->count++] = (__VA_ARGS__), true) \
                                          : false)
