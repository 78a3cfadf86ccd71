/* The distinct particles of a world, numbered in the order of their first body. */
#ifndef SCREE_REPORT_SHAPES_H
#define SCREE_REPORT_SHAPES_H

#include "base/error.h"

typedef struct scree_shapes {
  scree_particle **particles; /* of each shape, borrowed */
  size_t count;
  size_t *of_body; /* the shape of every body ever added */
} scree_shapes;

scree_status scree_shapes_find(const scree_world *world, scree_shapes *shapes, scree_error *error);
void scree_shapes_free(scree_shapes *shapes);

/* The spheres of a sphere or clump, in its frame, each as an icosphere of 20 * 4^level triangles.
 */
scree_status scree_spheres_mesh(const scree_particle *particle, int level, scree_mesh *mesh,
                                scree_error *error);

#endif
