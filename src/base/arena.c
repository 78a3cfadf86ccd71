#include "base/arena.h"

struct scree_arena_chunk {
  struct scree_arena_chunk *next;
  char *bytes;
  size_t size;
};

enum { CHUNK_BYTES = 1 << 18, ALIGNMENT = 64 };

static struct scree_arena_chunk *new_chunk(size_t size) {
  struct scree_arena_chunk *chunk = scree_alloc(1, sizeof *chunk);
  if (!chunk) return NULL;
  *chunk = (struct scree_arena_chunk){NULL, scree_alloc(size, 1), size};
  if (!chunk->bytes) {
    scree_free(chunk);
    return NULL;
  }
  return chunk;
}

/* Goes to the next kept chunk that is large enough, or appends one. */
static bool next_chunk(scree_arena *arena, size_t bytes) {
  struct scree_arena_chunk **link = arena->current ? &arena->current->next : &arena->first;
  while (*link && (*link)->size < bytes) link = &(*link)->next;
  if (!*link) *link = new_chunk(bytes > CHUNK_BYTES ? bytes : CHUNK_BYTES);
  if (!*link) return false;
  arena->current = *link;
  arena->used = 0;
  return true;
}

void *scree_arena_take(scree_arena *arena, size_t count, size_t size) {
  size_t bytes, rounded;
  if (__builtin_mul_overflow(count, size, &bytes) ||
      __builtin_add_overflow(bytes, (size_t)(ALIGNMENT - 1), &rounded))
    return NULL;
  rounded &= ~(size_t)(ALIGNMENT - 1);
  if (!arena->current || arena->current->size - arena->used < rounded)
    if (!next_chunk(arena, rounded)) return NULL;
  void *block = arena->current->bytes + arena->used;
  arena->used += rounded;
  return block;
}

void scree_arena_reset(scree_arena *arena) {
  arena->current = arena->first;
  arena->used = 0;
}

void scree_arena_free(scree_arena *arena) {
  for (struct scree_arena_chunk *chunk = arena->first; chunk;) {
    struct scree_arena_chunk *next = chunk->next;
    scree_free(chunk->bytes);
    scree_free(chunk);
    chunk = next;
  }
  *arena = (scree_arena){0};
}
