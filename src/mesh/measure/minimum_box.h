/* A box of least volume around points. */
#pragma once

#include "mesh/measure/hull.h"

typedef struct scree_minimum_box {
  mat3 axes; /* rows: unit directions of the sides, right-handed */
  vec3 size; /* along the rows, descending */
  vec3 center;
} scree_minimum_box;

/* Fits a box around a hull (see the top of minimum_box.c for how near to the least it comes); axes
 * are three more directions to try, such as the principal ones. Never larger than the axis-aligned
 * box, or the box along axes. */
scree_status scree_minimum_box_fit(const scree_hull *hull, const mat3 *axes, scree_minimum_box *box,
                                   scree_error *error);
