#include "simplify/record.h"

#include "base/alloc.h"

void scree_collapse_record_free(scree_collapse_record *r) {
  scree_free(r->kept);
  scree_free(r->gone);
  scree_free(r->position);
  scree_free(r->area);
  scree_free(r->volume);
  scree_free(r->error);
  *r = (scree_collapse_record){0};
}

scree_status scree_collapse_record_allocate(scree_collapse_record *r, size_t capacity,
                                            scree_error *error) {
  r->capacity = capacity;
  SCREE_ALLOC_OR(r->kept, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->gone, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->position, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->area, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->volume, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->error, capacity, error, out_of_memory);
  return SCREE_OK;
out_of_memory:
  scree_collapse_record_free(r);
  return SCREE_OUT_OF_MEMORY;
}

scree_status scree_collapse_record_shrink(scree_collapse_record *r, scree_error *error) {
  if (r->count > r->capacity / 16 * 15) return SCREE_OK;
  struct {
    void **block;
    size_t size;
  } fields[] = {
      {(void **)&r->kept, sizeof *r->kept},         {(void **)&r->gone, sizeof *r->gone},
      {(void **)&r->position, sizeof *r->position}, {(void **)&r->area, sizeof *r->area},
      {(void **)&r->volume, sizeof *r->volume},     {(void **)&r->error, sizeof *r->error}};
  for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
    void *moved = scree_resize(*fields[i].block, r->count, fields[i].size);
    if (!moved) return scree_fail_memory(error, r->count * fields[i].size, "the record");
    *fields[i].block = moved;
  }
  r->capacity = r->count;
  return SCREE_OK;
}
