/* Intersection over union of a mesh and spheres, independent of the library's: points on random
 * lines, each within the mesh by counting crossings of all triangles. */
#pragma once

#include "scree.h"

typedef struct overlap_counts {
  size_t points; /* in the box around both */
  size_t mesh, spheres, common;
  double box_volume;
} overlap_counts;

/* line_count * 100 points. */
overlap_counts overlap_count(const scree_mesh *mesh, const scree_sphere *spheres, size_t count,
                             size_t line_count);
double overlap_iou(const overlap_counts *counts);
