#include "simplify/decimate.h"

#include "base/alloc.h"

#include <string.h>

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

static scree_status resize(void **block, size_t count, size_t size, scree_error *error) {
  void *moved = scree_resize(*block, count, size);
  if (!moved) return scree_fail_memory(error, count * size, "the record");
  *block = moved;
  return SCREE_OK;
}

static scree_status set_capacity(scree_collapse_record *r, size_t capacity, scree_error *error) {
#define RESIZE(field) SCREE_TRY(resize((void **)&r->field, capacity, sizeof *r->field, error));
  FIELDS(RESIZE)
  r->capacity = capacity;
  return SCREE_OK;
}

scree_status scree_collapse_record_shrink(scree_collapse_record *r, scree_error *error) {
  return r->count > r->capacity / 16 * 15 ? SCREE_OK : set_capacity(r, r->count, error);
}

scree_status scree_collapse_record_put(scree_collapse_record *to, size_t at,
                                       const scree_collapse_record *from, size_t begin,
                                       scree_error *error) {
  size_t count = from->count - begin;
  if (count == 0) {
    to->count = at;
    return SCREE_OK;
  }
  if (at + count > to->capacity) SCREE_TRY(set_capacity(to, at + count, error));
#define COPY(field) memcpy(to->field + at, from->field + begin, count * sizeof *to->field);
  FIELDS(COPY)
  to->count = at + count;
  return SCREE_OK;
}
