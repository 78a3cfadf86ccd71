/* A growing array in three fields, for plain types:
 *
 *   SCREE_LIST(edge) list = {0};
 *   SCREE_TRY_PUSH(&list, error, value);
 *
 * One declared with SCREE_CLEANUP(scree_free_at) is freed with its block. */
#pragma once

#include "base/alloc.h"

#define SCREE_LIST(type)                                                                           \
  struct {                                                                                         \
    type *items;                                                                                   \
    size_t count, capacity;                                                                        \
  }

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

/* Adds an item; where memory is out the function ends with `error` filled. */
#define SCREE_TRY_PUSH(list, error, ...)                                                           \
  do {                                                                                             \
    if (SCREE_PUSH(list, __VA_ARGS__)) break;                                                      \
    scree_tell_memory((error), sizeof *(list)->items, NULL, #list);                                \
    return SCREE_OUT_OF_MEMORY;                                                                    \
  } while (0)
