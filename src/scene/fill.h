/* Filling: where the next layer of particles enters. */
#pragma once

#include "base/error.h"
#include "base/vec.h"

#include <stdbool.h>
#include <stdint.h>

/* A box in space: half its sides along its own axes, the columns of `axes`. */
typedef struct scree_oriented_box {
  vec3 centre, half;
  mat3 axes;
} scree_oriented_box;

/* Whether a plane lies between the boxes: the fifteen candidates of the separating axis theorem
 * (Gottschalk, Lin, Manocha 1996). Boxes that touch, or nearly, are not apart. */
bool scree_oriented_boxes_apart(const scree_oriented_box *a, const scree_oriented_box *b);

/* A particle to place: its extents in its own frame (with whatever is to be kept free around it)
 * are read, its place is written. */
typedef struct scree_placement {
  double radius;         /* of the bounding sphere about the particle's centre */
  vec3 box_centre, half; /* bounding box along the particle's axes */
  vec3 position;
  quat orientation;
  scree_oriented_box box; /* of the box in that place: scree_placement_settle */
} scree_placement;

/* Fills `box` from position and orientation. */
void scree_placement_settle(scree_placement *placement);

/* Whether the two cannot touch: their spheres or their boxes are apart. */
bool scree_placements_apart(const scree_placement *a, const scree_placement *b);

/* How far the body reaches from its centre along a unit vector, and against it. */
void scree_placement_reach(const scree_placement *placement, vec3 n, double *up, double *down);
/* Whether the body lies within an endless cylinder. */
bool scree_placement_within(const scree_placement *placement, vec3 from, vec3 axis, double radius);

typedef struct scree_fill_layer {
  uint64_t seed, layer_index;     /* name the layer's random numbers */
  double cylinder_radius;         /* m, inside; 0: a box */
  double bottom, height;          /* m: all lie within */
  const scree_placement *present; /* settled bodies that must not be touched */
  size_t present_count;
  double half[2], centre[2]; /* m: half the sides of the box; its middle, or the axis */
  /* What else a place must be clear of; NULL: nothing. */
  bool (*is_clear)(const void *context, const scree_placement *placement);
  const void *context;
} scree_fill_layer;

/* Places as many of the particles as fit into the layer, in their order, by random sequential
 * addition: uniform positions and orientations until one is free; a particle that finds none in
 * so many tries ends the layer. Returns how many were placed. */
size_t scree_fill_place(const scree_fill_layer *layer, scree_placement *placements, size_t count);

/* The shape that is most behind, of those that have these shares (NULL: equal ones) and were dealt
 * so often. */
size_t scree_fill_next_shape(const double *shares, size_t shape_count, const size_t *dealt);
/* Item i of the order in which count particles take the shapes in these shares, shuffled: order has
 * room for count. */
scree_status scree_fill_order(uint64_t seed, const double *shares, size_t shape_count,
                              uint32_t *order, size_t count, scree_error *error);
