/* The one way to memory. Every block is 64-byte aligned, counted against the limit, and may fail.
 */
#pragma once

#include "base/error.h"

#include <string.h>

/* count * size bytes, not cleared; NULL on overflow, above the limit, or when memory is out.
 * A count or size of 0 gives a valid block. */
void *scree_alloc(size_t count, size_t size) __attribute__((malloc, alloc_size(1, 2)));
/* The same, cleared. */
void *scree_alloc_zero(size_t count, size_t size) __attribute__((malloc, alloc_size(1, 2)));
/* A block of scree_alloc, or NULL, resized keeping its content; the old block stays on failure. */
void *scree_resize(void *block, size_t count, size_t size);
void scree_free(void *block);
/* Several at once. */
#define SCREE_FREE_ALL(...)                                                                        \
  do {                                                                                             \
    void *const blocks_[] = {__VA_ARGS__};                                                         \
    for (size_t i_ = 0; i_ < sizeof blocks_ / sizeof *blocks_; i_++) scree_free(blocks_[i_]);      \
  } while (0)
/* All threads together make the pages of a new block the program's own, as the system does where a
 * page is first written to: a loop on one thread that fills the block would wait for each, and the
 * others idle. For blocks that will be filled to their end; scree_alloc_zero does it. It changes no
 * byte; small blocks, and systems without the call, are left alone. */
void scree_populate(void *block, size_t size);
/* Gives the system back what lies behind the first `size` bytes, where that is some megabytes: what
 * it held is lost, but the block stays as large as it was, and counts as such. */
void scree_discard_tail(void *block, size_t size);

/* For strings and paths. */
char *scree_strdup(const char *text);

/* How many allocations were made so far: a step that claims to allocate nothing is checked with it.
 */
size_t scree_allocation_count(void);

/* What scree_set_memory_limit set. */
size_t scree_memory_limit(void);
/* Whether it was the limit, and not the system, that refused memory last. */
bool scree_memory_failed_at_limit(void);

/* A variable whose end is its block's: the function is called with its address then. */
#define SCREE_CLEANUP(function) __attribute__((cleanup(function)))
static inline void scree_free_at(void *variable) {
  void *block;
  memcpy(&block, variable, sizeof block);
  scree_free(block);
}

/* Allocates a typed array; where memory is out the function ends with `error` filled. */
#define SCREE_TRY_ALLOC(pointer, count, error)                                                     \
  SCREE_TRY_BLOCK(pointer, scree_alloc((count), sizeof *(pointer)), count, error)
#define SCREE_TRY_ALLOC_ZERO(pointer, count, error)                                                \
  SCREE_TRY_BLOCK(pointer, scree_alloc_zero((count), sizeof *(pointer)), count, error)
#define SCREE_TRY_BLOCK(pointer, block, count, error)                                              \
  do {                                                                                             \
    (pointer) = (block);                                                                           \
    if ((pointer)) break;                                                                          \
    scree_tell_memory((error), (size_t)(count) * sizeof *(pointer), NULL, #pointer);               \
    return SCREE_OUT_OF_MEMORY;                                                                    \
  } while (0)
/* An array for the block where it is declared, which frees it. */
#define SCREE_SCRATCH(type, name, count, error)                                                    \
  SCREE_CLEANUP(scree_free_at) type *name = NULL;                                                  \
  SCREE_TRY_ALLOC(name, count, error)
#define SCREE_SCRATCH_ZERO(type, name, count, error)                                               \
  SCREE_CLEANUP(scree_free_at) type *name = NULL;                                                  \
  SCREE_TRY_ALLOC_ZERO(name, count, error)

/* Allocates a typed array and jumps to `label` on failure after filling `error`: the pattern of
 * every function with several arrays. */
#define SCREE_ALLOC_OR(pointer, count, error, label)                                               \
  do {                                                                                             \
    (pointer) = scree_alloc((count), sizeof *(pointer));                                           \
    if (!(pointer)) {                                                                              \
      scree_tell_memory((error), (size_t)(count) * sizeof *(pointer), NULL, #pointer);             \
      goto label;                                                                                  \
    }                                                                                              \
  } while (0)

/* The most bytes the library may hold at once; further allocations fail with SCREE_OUT_OF_MEMORY.
 * 0 (the default) means no limit. */
void scree_set_memory_limit(size_t byte_count);
