#include "support/alloc_fail.h"
#include "base/error.h"

#include "support/check.h"

#include <stdatomic.h>

typedef struct countdown {
  atomic_long left; /* allocations until the one that fails; negative: none fails */
  atomic_long made;
} countdown;

static void *failing_reallocate(void *context, void *block, size_t size) {
  countdown *c = context;
  if (size == 0) {
    free(block);
    return NULL;
  }
  atomic_fetch_add(&c->made, 1);
  if (atomic_fetch_sub(&c->left, 1) == 0) return NULL;
  return realloc(block, size);
}

/* Calls with allocation number `failing` (from 0) refused. */
static scree_status call_failing(fallible_call *call, void *context, long failing, countdown *c,
                                 scree_error *error) {
  atomic_store(&c->left, failing);
  atomic_store(&c->made, 0);
  *error = (scree_error){0};
  scree_set_allocator(failing_reallocate, c);
  scree_status status = call(context, error);
  scree_set_allocator(NULL, NULL);
  return status;
}

static size_t check_all(fallible_call *call, void *context, bool survivable) {
  countdown c;
  scree_error error;
  CHECK_OK(call_failing(call, context, -1, &c, &error), error);
  long count = atomic_load(&c.made), step = count > 200 ? count / 100 : 1;
  size_t used = scree_memory_used();
  for (long failing = 0; failing < count; failing += step) {
    scree_status status = call_failing(call, context, failing, &c, &error);
    bool refused = status == SCREE_OUT_OF_MEMORY && error.status == status && error.message[0];
    if (!refused && !(survivable && status == SCREE_OK)) {
      print_error("allocation %ld of %ld refused: %s, '%s'\n", failing + 1, count,
                  scree_status_text(status), error.message);
      fail();
    }
    if (scree_memory_used() != used) {
      print_error("allocation %ld of %ld refused: %zu bytes leaked\n", failing + 1, count,
                  scree_memory_used() - used);
      fail();
    }
  }
  return (size_t)count;
}

size_t check_allocation_failures(fallible_call *call, void *context) {
  return check_all(call, context, false);
}

size_t check_allocation_failures_survivable(fallible_call *call, void *context) {
  return check_all(call, context, true);
}
