/* Meshes and tables for the report's page, small: positions on a grid of 16 bits, and what
 * meshoptimizer's codecs make of them, which web/src/packed.js reads with the same library's
 * JavaScript. docs/reference/formats.md has the layout. */
#pragma once

#include "base/codec.h"
#include "base/error.h"

typedef struct scree_packing {
  scree_codec out;     /* grown; the caller frees its bytes */
  double low[3], step; /* m: position = low + step * (integers up to 65535) */
  bool keeps_order;    /* of triangles, at the price of some bytes */
  scree_error *error;
} scree_packing;

typedef struct scree_grid_point {
  uint16_t x[3], extra;
} scree_grid_point;

/* Makes the box from low to high (start with infinity, -infinity) hold p. */
void scree_pack_stretch(const double *p, double low[3], double high[3]);
/* The box of a mesh. */
void scree_pack_box(const scree_mesh *mesh, double low[3], double high[3]);
/* The grid over a box. */
void scree_pack_grid(scree_packing *p, const double low[3], const double high[3]);
scree_grid_point scree_pack_point(const scree_packing *p, const double *position);

void scree_pack_u32(scree_packing *p, size_t value);
/* `count` records of `size` bytes, a multiple of 4 up to 256, of which neighbours are alike; their
 * bytes before them. */
scree_status scree_pack_vertices(scree_packing *p, const void *vertices, size_t count, size_t size);
/* A mesh in an order that packs well, or its own (keeps_order); place (vertex_count, may be NULL)
 * gets each vertex's index in it. The counts, then vertices, then triangles. */
scree_status scree_pack_mesh(scree_packing *p, const scree_mesh *mesh, uint32_t *place);
