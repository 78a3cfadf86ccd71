/* The collapses in their order: a progressive mesh (Hoppe 1996). Every prefix is a level. */
#pragma once

#include "base/error.h"
#include "base/vec.h"

/* One array per field. Positions and measures are in metres. */
typedef struct scree_collapse_record {
  size_t count, capacity;
  uint32_t *kept,
      *gone;      /* vertices of the mesh given; bit 31 of kept: one triangle goes, not two */
  vec3 *position; /* where kept lies afterwards */
  double *area, *volume; /* while decimating: change of the collapse; then: the level's value */
  float *error;          /* mean square move, unit box; then: running maximum, metres */
} scree_collapse_record;

#define SCREE_ONE_TRIANGLE UINT32_C(0x80000000)

/* Room for so many collapses. */
scree_status scree_collapse_record_allocate(scree_collapse_record *record, size_t capacity,
                                            scree_error *error);
void scree_collapse_record_free(scree_collapse_record *record);
/* Gives back what is worth copying the rest. */
scree_status scree_collapse_record_shrink(scree_collapse_record *record, scree_error *error);

static inline uint32_t scree_collapse_record_triangles(const scree_collapse_record *r,
                                                       size_t index) {
  return r->kept[index] & SCREE_ONE_TRIANGLE ? 1 : 2;
}
static inline uint32_t scree_collapse_record_kept(const scree_collapse_record *r, size_t index) {
  return r->kept[index] & ~SCREE_ONE_TRIANGLE;
}
