/* Walls from triangles as CAD leaves them: any triangle soup as pieces of which every edge belongs
 * to one facet or to two. soup.c says how. */
#pragma once

#include "mesh/mesh.h"

/* Facets that are joined by edges, wound alike. */
typedef struct scree_piece {
  size_t first, count; /* facets of the mesh */
  bool closed;
  double volume;  /* m3, below 0: wound inwards; 0 of an open one */
  vec3 low, high; /* around it */
} scree_piece;

typedef struct scree_pieces {
  scree_mesh mesh; /* pieces share no vertices */
  scree_piece *items;
  size_t count;
  scree_wall_mending mending;
} scree_pieces;

/* A clean mesh of one piece comes out as it went in, to the last bit. SCREE_BAD_MESH where no facet
 * has an area, with the place of the largest. Cost n log n. */
scree_status scree_pieces_make(const scree_mesh *soup, scree_pieces *pieces, scree_error *error);
void scree_pieces_free(scree_pieces *pieces);

/* How often a closed piece winds around p: 1 inside, 0 outside; -1 inside one wound inwards. */
int scree_piece_winding(const scree_pieces *pieces, size_t piece, vec3 p);
/* Winds its facets the other way. */
void scree_piece_turn(scree_pieces *pieces, size_t piece);
