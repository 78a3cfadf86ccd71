/* The nine devices as drawings. Synthetic: in the manner of phones and cameras of their time, after
 * no make in particular. x is the width, y the length (cameras: the height), z points out of the
 * front. */
#pragma once

#include "sample/shape.h"

typedef struct scree_device {
  const char *name, *description;
  const scree_piece_mm *lines;
  size_t line_count;
} scree_device;

extern const scree_device scree_feature_phones[3];
extern const scree_device scree_cameras[3];
extern const scree_device scree_smartphones[3];

/* Words for the drawings' lines: {SLAB, JOIN, {at}, {half}, corner, fillet, .blend = ...}. */
#define PART                 .kind = SCREE_PIECE_PART
#define SLAB                 .kind = SCREE_PIECE_SLAB
#define CAPSULE              .kind = SCREE_PIECE_CAPSULE
#define TORUS                .kind = SCREE_PIECE_TORUS
#define JOIN                 SCREE_PIECE_JOIN
#define CUT                  SCREE_PIECE_CUT
#define KEEP                 SCREE_PIECE_KEEP
#define UPRIGHT              .turn_deg = {90, 0, 0}
#define ROW(count, pitch)    .copies_x = count, .pitch_x = pitch
#define COLUMN(count, pitch) .copies_y = count, .pitch_y = pitch
#define GRID(nx, ny, dx, dy) .copies_x = nx, .copies_y = ny, .pitch_x = dx, .pitch_y = dy
#define RING(count, radius)  .ring_copies = count, .ring_radius = radius

#define SCREE_DEVICE(name, description, lines)                                                     \
  { name, description, lines, sizeof(lines) / sizeof *(lines) }
