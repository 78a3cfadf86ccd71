/* Memory that is taken in pieces and given back at once. Not thread-safe. */
#pragma once

#include "base/alloc.h"

typedef struct scree_arena {
  struct scree_arena_chunk *newest; /* each knows the one before it */
  size_t used;                      /* in the newest */
} scree_arena;

/* count * size bytes, 64-byte aligned, not cleared; NULL when memory is out. */
void *scree_arena_take(scree_arena *arena, size_t count, size_t size);
/* Takes a typed array, cleared; where memory is out the function ends with `error` filled. */
#define SCREE_TRY_TAKE(pointer, arena, count, error)                                               \
  do {                                                                                             \
    SCREE_TRY_BLOCK(pointer, scree_arena_take((arena), (count), sizeof *(pointer)), count, error); \
    memset((pointer), 0, (size_t)(count) * sizeof *(pointer));                                     \
  } while (0)
/* A copy of a text; NULL when memory is out. */
const char *scree_arena_text(scree_arena *arena, const char *text);
/* Gives everything back; the arena is as new. */
void scree_arena_free(scree_arena *arena);
