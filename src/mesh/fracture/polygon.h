/* Triangles of a plane face with holes, or of several pieces, given as a set of directed edges. */
#pragma once

#include "mesh/fracture/cut.h"
#include "mesh/repair/facet_cut.h"

/* A connected part of a face: triangles [first, first + count) of the list. */
typedef struct scree_polygon {
  uint32_t first, count;
  double area;    /* m^2 */
  uint32_t of[2]; /* the caller's: cells on both sides */
} scree_polygon;

typedef struct scree_polygons {
  SCREE_LIST(uint32_t) corners;
  SCREE_LIST(scree_polygon) list;
  scree_facet_cutter *cutter;
} scree_polygons;
void scree_polygons_free(scree_polygons *polygons);

/* Adds those of a face with this normal, whose edges run counter-clockwise. *doubtful where the
 * edges are no polygons. The edges' vertices get another stamp. */
scree_status scree_polygons_add(scree_cutter *cutter, const scree_cut_edge *edges, size_t count,
                                vec3 normal, scree_polygons *polygons, bool *doubtful,
                                scree_error *error);
