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

#endif
