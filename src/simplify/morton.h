/* An order in which what is near in space is near in memory. */
#pragma once

#include "base/alloc.h"
#include "base/vec.h"

/* Places in an array, each `stride` doubles after the one before. */
typedef struct scree_positions {
  const double *at;
  size_t stride, count;
} scree_positions;

/* Their principal axes (by rows, right-handed) through their mean, the first two in the direction
 * of the longer tail (the third moment): the same however they lie, unless their own symmetry
 * leaves the axes open. */
typedef struct scree_principal_frame {
  vec3 centre, low, high; /* the latter two: of their box in the frame */
  double extent;          /* the longest side of that box */
  mat3 axes;
} scree_principal_frame;

/* The centre, of their box or so, is where sums begin. O(n), parallel. */
scree_status scree_principal_frame_find(const scree_positions *places, vec3 centre,
                                        scree_principal_frame *frame, scree_error *error);

static inline vec3 scree_principal_frame_into(const scree_principal_frame *frame, vec3 place) {
  return mat3_mul_vec(&frame->axes, vec3_sub(place, frame->centre));
}

/* The same from the low corner on, in units of which about `steps` are the extent. */
vec3 scree_principal_frame_steps(const scree_principal_frame *frame, double steps, vec3 place);

/* The bits of the three whole numbers of steps, of so many bits each, interleaved. */
enum { SCREE_MORTON_BITS = 10 };
uint32_t scree_morton_code(vec3 steps);

/* Fills order with the vertices along a Morton curve through their box in their frame; equal places
 * keep their order. Depends on positions alone, and not on how they are turned or moved. O(n),
 * parallel in part. */
scree_status scree_order_vertices(const scree_mesh *mesh, vec3 centre, uint32_t *order,
                                  scree_error *error);
