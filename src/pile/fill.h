/* Filling: where the next layer of particles enters. */
#ifndef SCREE_PILE_FILL_H
#define SCREE_PILE_FILL_H

#include "base/error.h"
#include "base/vec.h"

/* A particle to place: the radius of its bounding sphere about its centre. */
typedef struct scree_placement {
  vec3 position;
  quat orientation;
  double radius;
} scree_placement;

typedef struct scree_fill_layer {
  uint64_t seed, layer_index;     /* name the layer's random numbers */
  double cylinder_radius;         /* m, inside */
  double bottom;                  /* m: the lowest height of the layer */
  double clearance;               /* m kept between bounding spheres and to the wall */
  const scree_placement *present; /* bodies that must not be touched */
  size_t present_count;
} scree_fill_layer;

/* Places as many of the particles as fit into one layer of single particles, in their order, by
 * random sequential addition of bounding spheres: a particle that finds no place in so many tries
 * ends the layer. placements[i].radius is read, position and orientation are written; returns how
 * many were placed. */
size_t scree_fill_place(const scree_fill_layer *layer, scree_placement *placements, size_t count);

/* Item i of the order in which count particles take shape_count shapes in equal shares, shuffled:
 * order has room for count. */
void scree_fill_order(uint64_t seed, size_t shape_count, uint32_t *order, size_t count);

#endif
