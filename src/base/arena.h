/* Scratch memory that is taken in pieces and given back at once; kept between uses, so that warm
 * work allocates nothing. One arena per worker: not thread-safe. */
#ifndef SCREE_BASE_ARENA_H
#define SCREE_BASE_ARENA_H

#include "base/alloc.h"

typedef struct scree_arena {
  struct scree_arena_chunk *first, *current;
  size_t used; /* in the current chunk */
} scree_arena;

/* count * size bytes, 64-byte aligned, not cleared; NULL when memory is out. */
void *scree_arena_take(scree_arena *arena, size_t count, size_t size);
/* Makes everything taken free again; keeps the chunks. */
void scree_arena_reset(scree_arena *arena);
void scree_arena_free(scree_arena *arena);

#endif
