/* A shape's distance field sampled on a lattice, in blocks of 8^3 corners, kept only near the
 * surface. */
#pragma once

#include "base/error.h"
#include "base/progress.h"
#include "sample/shape.h"

enum {
  SCREE_BLOCK = 8,
  SCREE_BLOCK_CELLS = SCREE_BLOCK * SCREE_BLOCK * SCREE_BLOCK,
  SCREE_PAD = SCREE_BLOCK + 1,
  SCREE_PAD_CORNERS = SCREE_PAD * SCREE_PAD * SCREE_PAD,
};

/* Corner (i, j, k) of the block is value[i + 8 (j + 8 k)]; cell (i, j, k) has it as its lowest
 * corner. */
typedef struct scree_lattice_block {
  int32_t at[3];         /* of its first corner, in lattice steps */
  uint32_t first_vertex; /* filled by the extraction: its vertices come one after another */
  uint32_t vertex_count; /* ... in the order of cells */
  float value[SCREE_BLOCK_CELLS];    /* distance in steps; negative inside */
  int16_t vertex[SCREE_BLOCK_CELLS]; /* of a cell, counted from first_vertex; -1: none */
} scree_lattice_block;

typedef struct scree_lattice {
  const scree_shape *shape;
  double step;     /* metres */
  vec3 origin;     /* of lattice corner (0, 0, 0) */
  int32_t size[3]; /* in blocks */
  int32_t *slots;  /* per block of the lattice: its index, or one of the two below */
  scree_lattice_block *blocks;
  size_t block_count;
} scree_lattice;

enum { SCREE_SLOT_OUTSIDE = -1, SCREE_SLOT_INSIDE = -2 };

/* Samples the shape; then no face and no cell of the lattice is ambiguous, so that the surface
 * between inside and outside corners is a manifold with one sheet per cell. SCREE_LIMIT where the
 * lattice would be too large. Free with scree_lattice_free. */
scree_status scree_lattice_build(const scree_shape *shape, double step, scree_ticker *ticker,
                                 scree_lattice *lattice, scree_error *error);
void scree_lattice_free(scree_lattice *lattice);

/* The block that owns a lattice corner, or NULL; *corner is the corner's index in it. */
scree_lattice_block *scree_lattice_find(const scree_lattice *lattice, int32_t i, int32_t j,
                                        int32_t k, int *corner);
/* The 9^3 corners of the block's cells. */
void scree_lattice_gather(const scree_lattice *lattice, const scree_lattice_block *block,
                          float *pad);
/* The solids that matter to the block's cells. */
void scree_lattice_list(const scree_lattice *lattice, const scree_lattice_block *block,
                        scree_shape_list *list);

/* Corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2). Its offset in a pad: */
static inline int scree_pad_offset(int c) {
  return (c & 1) + SCREE_PAD * ((c >> 1 & 1) + SCREE_PAD * (c >> 2));
}
static inline int scree_pad_index(int cell) {
  return cell % 8 + SCREE_PAD * (cell / 8 % 8 + SCREE_PAD * (cell / 64));
}
/* Which of a cell's eight corners are inside, as bits. */
static inline unsigned scree_pad_mask(const float *pad, int cell) {
  const float *v = pad + scree_pad_index(cell);
  unsigned mask = 0;
  for (int c = 0; c < 8; c++) mask |= (unsigned)(v[scree_pad_offset(c)] < 0) << c;
  return mask;
}
