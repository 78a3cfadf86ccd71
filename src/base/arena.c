#include "base/arena.h"

struct scree_arena_chunk {
  struct scree_arena_chunk *before;
  char *bytes;
  size_t size;
};

enum { CHUNK_BYTES = 1 << 18, ALIGNMENT = 64 };

static bool add_chunk(scree_arena *arena, size_t size) {
  struct scree_arena_chunk *chunk = scree_alloc(1, sizeof *chunk);
  if (!chunk) return false;
  *chunk = (struct scree_arena_chunk){arena->newest, scree_alloc(size, 1), size};
  if (!chunk->bytes) {
    scree_free(chunk);
    return false;
  }
  arena->newest = chunk;
  arena->used = 0;
  return true;
}

void *scree_arena_take(scree_arena *arena, size_t count, size_t size) {
  size_t bytes, rounded;
  if (__builtin_mul_overflow(count, size, &bytes) ||
      __builtin_add_overflow(bytes, (size_t)(ALIGNMENT - 1), &rounded))
    return NULL;
  rounded &= ~(size_t)(ALIGNMENT - 1);
  if (!arena->newest || arena->newest->size - arena->used < rounded)
    if (!add_chunk(arena, rounded > CHUNK_BYTES ? rounded : CHUNK_BYTES)) return NULL;
  void *block = arena->newest->bytes + arena->used;
  arena->used += rounded;
  return block;
}

const char *scree_arena_text(scree_arena *arena, const char *text) {
  size_t size = strlen(text) + 1;
  char *copy = scree_arena_take(arena, size, 1);
  if (copy) memcpy(copy, text, size);
  return copy;
}

void scree_arena_free(scree_arena *arena) {
  while (arena->newest) {
    struct scree_arena_chunk *before = arena->newest->before;
    scree_free(arena->newest->bytes);
    scree_free(arena->newest);
    arena->newest = before;
  }
  *arena = (scree_arena){0};
}
