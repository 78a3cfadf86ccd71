/* Pieces of a body that was cut: what hangs together of each cell, and what joins a neighbour. */
#pragma once

#include "mesh/fracture/polygon.h"

#define SCREE_NO_CELL UINT32_MAX

/* All polygons: of the surface with one cell, of faces between cells with two. A polygon's first
 * side is that of cell `of[0]`, from which its triangles point outward. */
typedef struct scree_cut_body {
  const scree_mesh *mesh;     /* as it was given */
  const scree_cutter *cutter; /* in the space of the cutting */
  const vec3 *places;         /* of all vertices, in that of the mesh */
  const scree_polygons *polygons;
  size_t cell_count;
} scree_cut_body;

/* Fills pieces, faces and counts of the result, whose volume is known. *doubtful where a piece is
 * not closed. sites: of the cells, in the space of the mesh. */
scree_status scree_fracture_pieces(const scree_cut_body *body,
                                   const scree_fracture_options *options, const vec3 *sites,
                                   scree_fracture *out, bool *doubtful, scree_error *error);
