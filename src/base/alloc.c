/* Each block carries its raw pointer and size in the 64 bytes before it, so that use can be counted
 * with any allocator behind the hook. Large blocks ask for huge pages: touching 100 MB for the
 * first time costs 25,000 page faults otherwise, more than welding a scan. */
#include "base/alloc.h"

#include "base/parallel.h"
#include "base/platform.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64, HUGE_PAGE = 1 << 21 };

typedef struct header {
  void *raw;
  size_t size;
} header;

static void *default_reallocate(void *context, void *block, size_t size) {
  (void)context;
  if (size == 0) {
    free(block);
    return NULL;
  }
  return realloc(block, size);
}

static scree_reallocate *hook = default_reallocate;
static void *hook_context = NULL;
static atomic_size_t limit_bytes, used_bytes, peak_bytes, allocation_count;
static atomic_bool failed_at_limit; /* the last allocation that failed */

void scree_set_allocator(scree_reallocate *reallocate, void *context) {
  hook = reallocate ? reallocate : default_reallocate;
  hook_context = reallocate ? context : NULL;
}

void scree_set_memory_limit(size_t byte_count) {
  atomic_store(&limit_bytes, byte_count);
}
size_t scree_memory_limit(void) {
  return atomic_load(&limit_bytes);
}
size_t scree_memory_used(void) {
  return atomic_load(&used_bytes);
}
size_t scree_memory_peak(void) {
  return atomic_load(&peak_bytes);
}
void scree_reset_memory_peak(void) {
  atomic_store(&peak_bytes, atomic_load(&used_bytes));
}
size_t scree_allocation_count(void) {
  return atomic_load(&allocation_count);
}

static bool reserve(size_t size) {
  size_t used = atomic_fetch_add(&used_bytes, size) + size;
  size_t limit = atomic_load(&limit_bytes);
  if (limit && used > limit) {
    atomic_fetch_sub(&used_bytes, size);
    return false;
  }
  size_t peak = atomic_load(&peak_bytes);
  while (used > peak && !atomic_compare_exchange_weak(&peak_bytes, &peak, used)) {
  }
  return true;
}

static header *header_of(void *block) {
  return (header *)((char *)block - ALIGNMENT);
}

/* What is counted for a block of count * size bytes. */
static bool counted_size(size_t count, size_t size, size_t *counted) {
  size_t bytes;
  return !__builtin_mul_overflow(count, size, &bytes) &&
         !__builtin_add_overflow(bytes, 2 * (size_t)ALIGNMENT, counted) &&
         *counted <= (size_t)PTRDIFF_MAX - HUGE_PAGE;
}

void *scree_alloc(size_t count, size_t size) {
  size_t counted;
  bool countable = counted_size(count, size, &counted);
  if (!countable || !reserve(counted)) {
    atomic_store(&failed_at_limit, countable);
    return NULL;
  }
  /* a large block begins on a huge page; what that leaves before it is never touched */
  size_t alignment = counted >= HUGE_PAGE ? HUGE_PAGE : ALIGNMENT;
  void *raw = hook(hook_context, NULL, counted - ALIGNMENT + alignment);
  if (!raw) {
    atomic_fetch_sub(&used_bytes, counted);
    atomic_store(&failed_at_limit, false);
    return NULL;
  }
  atomic_fetch_add(&allocation_count, 1);
  uintptr_t address = (uintptr_t)raw + ALIGNMENT;
  size_t shift = (size_t)(-address & (alignment - 1));
  char *block = (char *)raw + ALIGNMENT + shift;
  *header_of(block) = (header){raw, counted};
  if (alignment == HUGE_PAGE) scree_pages_large(block, counted - 2 * (size_t)ALIGNMENT);
  return block;
}

static void touch_pages(void *context, scree_block block) {
  scree_pages_touch((char *)context + block.begin, block.end - block.begin);
}

void scree_populate(void *block, size_t size) {
  uintptr_t mask = HUGE_PAGE - 1, address = (uintptr_t)block;
  uintptr_t first = (address + mask) & ~mask, last = (address + size) & ~mask;
  if (scree_worker_count() > 1 && last > first + HUGE_PAGE)
    scree_parallel_for(last - first, HUGE_PAGE, touch_pages, (char *)block + (first - address));
}

void *scree_alloc_zero(size_t count, size_t size) {
  void *block = scree_alloc(count, size);
  if (!block) return NULL;
  scree_populate(block, count * size);
  return memset(block, 0, count * size);
}

/* Moves rather than resizes in place: the aligned position inside the raw block may differ. */
void *scree_resize(void *block, size_t count, size_t size) {
  if (!block) return scree_alloc(count, size);
  void *moved = scree_alloc(count, size);
  if (!moved) return NULL;
  size_t old_bytes = header_of(block)->size - 2 * (size_t)ALIGNMENT, new_bytes = count * size;
  memcpy(moved, block, old_bytes < new_bytes ? old_bytes : new_bytes);
  scree_free(block);
  return moved;
}

void scree_free(void *block) {
  if (!block) return;
  header found = *header_of(block);
  atomic_fetch_sub(&used_bytes, found.size);
  hook(hook_context, found.raw, 0);
}

void scree_discard_tail(void *block, size_t size) {
  size_t end = header_of(block)->size - 2 * (size_t)ALIGNMENT;
  uintptr_t mask = HUGE_PAGE - 1, address = (uintptr_t)block;
  uintptr_t first = (address + size + mask) & ~mask, last = (address + end) & ~mask;
  if (hook == default_reallocate && size < end && first < last)
    scree_pages_drop((char *)block + (first - address), last - first);
}

bool scree_memory_failed_at_limit(void) {
  return atomic_load(&failed_at_limit);
}

/* 307200 as "300 KiB" */
static void format_size(size_t size, char text[32]) {
  static const char *const units[] = {"bytes", "KiB", "MiB", "GiB"};
  size_t unit = 0;
  for (; unit < 3 && size && size % 1024 == 0; unit++) size /= 1024;
  snprintf(text, 32, "%zu %s", size, units[unit]);
}

void scree_tell_memory(scree_error *error, size_t byte_count, const char *what,
                       const char *expression) {
  char size[32];
  if (atomic_load(&failed_at_limit)) {
    format_size(scree_memory_limit(), size);
    scree_fail(error, SCREE_OUT_OF_MEMORY, "out of memory: more than the limit of %s is needed%s%s",
               size, what ? " for " : "", what ? what : "");
    return;
  }
  snprintf(size, sizeof size, ": %zu bytes", byte_count);
  scree_fail(error, SCREE_OUT_OF_MEMORY, "out of memory%s for %s", byte_count ? size : "",
             what ? what : expression);
}

char *scree_strdup(const char *text) {
  size_t size = strlen(text) + 1;
  char *copy = scree_alloc(size, 1);
  if (copy) memcpy(copy, text, size);
  return copy;
}
