#include "simplify/record.h"

#include "base/alloc.h"

/* The arrays, each of the record's capacity. */
#define FIELDS(X) X(kept) X(gone) X(position) X(area) X(volume) X(error)

void scree_collapse_record_free(scree_collapse_record *r) {
#define FREE(field) scree_free(r->field);
  FIELDS(FREE)
  *r = (scree_collapse_record){0};
}

scree_status scree_collapse_record_allocate(scree_collapse_record *r, size_t capacity,
                                            scree_error *error) {
#define ALLOCATE(field) SCREE_TRY_ALLOC(r->field, capacity, error);
  r->capacity = capacity;
  FIELDS(ALLOCATE)
  return SCREE_OK;
}

static scree_status shrink(void **block, size_t count, size_t size, scree_error *error) {
  void *moved = scree_resize(*block, count, size);
  if (!moved) return scree_fail_memory(error, count * size, "the record");
  *block = moved;
  return SCREE_OK;
}

scree_status scree_collapse_record_shrink(scree_collapse_record *r, scree_error *error) {
#define SHRINK(field) SCREE_TRY(shrink((void **)&r->field, r->count, sizeof *r->field, error));
  if (r->count > r->capacity / 16 * 15) return SCREE_OK;
  FIELDS(SHRINK)
  r->capacity = r->count;
  return SCREE_OK;
}
