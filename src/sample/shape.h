/* Shapes as signed distance fields: few kinds of rounded pieces, joined, cut and blended in the
 * order of a drawing. Negative inside. Every function here is a lower bound of the distance
 * (1-Lipschitz), which is what block skipping and pruning stand on. */
#pragma once

#include "base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SCREE_SHAPE_PIECES = 320, SCREE_SHAPE_PARTS = 16, SCREE_SHAPE_BATCH = 512 };

typedef enum scree_piece_kind {
  SCREE_PIECE_PART,    /* not a solid: what follows belongs to a new part with its own frame */
  SCREE_PIECE_SLAB,    /* a rounded rectangle, extruded along z; its edges filleted */
  SCREE_PIECE_CAPSULE, /* half.z long along z, radius half.x; a ball where half.z is 0 */
  SCREE_PIECE_TORUS,   /* about z: ring radius half.x, wire radius half.y */
} scree_piece_kind;

typedef enum scree_piece_op {
  SCREE_PIECE_JOIN, /* add material */
  SCREE_PIECE_CUT,  /* take it away */
  SCREE_PIECE_KEEP, /* keep what lies inside this solid */
} scree_piece_op;

/* One line of a drawing: lengths in millimetres, angles in degrees. A slab with corner == half.x ==
 * half.y is a cylinder. */
typedef struct scree_piece_mm {
  scree_piece_kind kind;
  scree_piece_op op;
  vec3 at, half;           /* centre; half sizes */
  double corner;           /* radius of the slab's corners in the xy plane */
  double fillet;           /* radius of the edges at its ends */
  double taper;            /* how much the sides open per unit of z (the tangent of the draft) */
  double blend;            /* width over which the solid melts into what stands before it */
  vec3 turn_deg;           /* turned about x, then y, then z */
  int copies_x, copies_y;  /* a grid of copies centred on `at` (0: one) ... */
  double pitch_x, pitch_y; /* ... this far apart */
  int ring_copies;         /* or copies on a circle about `at`, each turned to face outward along
                              its own x ... */
  double ring_radius;      /* ... of this radius */
  double bend_length, bend_deg; /* PART: bent about x by bend_deg over this length in y */
} scree_piece_mm;

/* The same, in metres and ready to evaluate. */
typedef struct scree_shape_piece {
  scree_piece_kind kind;
  scree_piece_op op;
  bool turned;
  uint16_t part;
  vec3 at, half;
  double corner, fillet, taper, taper_cosine, scale, blend;
  mat3 turn; /* local = transpose(turn) (p - at) */
} scree_shape_piece;

typedef struct scree_part {
  scree_piece_op op;
  bool turned, bent;
  double blend, stretch; /* how much local lengths may exceed true ones: 1, or more where bent */
  vec3 at;
  mat3 turn;
  double bend_radius, bend_half_angle;
} scree_part;

typedef struct scree_shape {
  scree_shape_piece pieces[SCREE_SHAPE_PIECES];
  scree_part parts[SCREE_SHAPE_PARTS];
  size_t piece_count, part_count;
  double blend_max;
  vec3 low, high; /* a box that holds the shape */
} scree_shape;

/* The pieces of a shape that matter in some region, in order. */
typedef struct scree_shape_list {
  size_t count;
  uint16_t pieces[SCREE_SHAPE_PIECES];
} scree_shape_list;

/* Builds a shape from a drawing of line_count lines; false where it holds more pieces or parts than
 * a shape can (a mistake in the drawing, not in anybody's data). */
bool scree_shape_build(const scree_piece_mm *lines, size_t line_count, scree_shape *shape);

/* All pieces. */
void scree_shape_list_all(const scree_shape *shape, scree_shape_list *list);
/* The pieces that can touch the surface in the ball around centre. Within it the pruned field has
 * the sign of the whole one, and its value wherever that is below `band`. */
void scree_shape_prune(const scree_shape *shape, vec3 centre, double radius, double band,
                       scree_shape_list *list);

/* The field of the listed pieces at count points (at most SCREE_SHAPE_BATCH). */
typedef struct scree_points {
  double x[SCREE_SHAPE_BATCH], y[SCREE_SHAPE_BATCH], z[SCREE_SHAPE_BATCH];
} scree_points;
void scree_shape_distance(const scree_shape *shape, const scree_shape_list *list,
                          const scree_points *points, size_t count, double *distance);
