/* The signed distance from a body's surface, negative inside, on a grid of two levels: coarse
 * cells, and within those that the surface passes a finer grid of a quarter of the spacing. */
#pragma once

#include "clump/target.h"

#include <stdint.h>

enum { SCREE_FINER = 4, SCREE_BRICK_SIDE = SCREE_FINER + 1 };
enum { SCREE_BRICK_NODES = SCREE_BRICK_SIDE * SCREE_BRICK_SIDE * SCREE_BRICK_SIDE };

typedef struct scree_distance_field {
  size_t n[3];     /* coarse nodes */
  double low[3];   /* the first node */
  double step;     /* between coarse nodes */
  double per_step; /* 1 / step */
  double thickness;
  float *values;  /* n[0] * n[1] * n[2], the last axis fastest */
  int32_t *brick; /* by the lowest node of a coarse cell: its finer grid, or -1 */
  float (*bricks)[SCREE_BRICK_NODES];
  size_t brick_count;
} scree_distance_field;

/* The spacing follows the size of `most` spheres, finer where walls are thin, up to a limit of
 * memory. */
scree_status scree_distance_field_make(const scree_target *body, size_t most,
                                       scree_distance_field *field, scree_error *error);
void scree_distance_field_free(scree_distance_field *field);

/* Finest spacing, and how many of it fit into the body's local thickness: with fewer than three a
 * wall is not seen. */
static inline double scree_distance_field_spacing(const scree_distance_field *f) {
  return f->step / SCREE_FINER;
}
static inline double scree_distance_field_cells(const scree_distance_field *f) {
  return f->thickness / scree_distance_field_spacing(f);
}

/* Trilinear between nodes; outside the grid, what it is at its rim and the way there. */
float scree_distance_field_at(const scree_distance_field *field, const double p[3]);
