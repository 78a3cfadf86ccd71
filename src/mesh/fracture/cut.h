/* Voronoi cells cut exactly from a closed mesh: the cutting alone (fracture.c drives it). */
#pragma once

#include "base/array.h"
#include "mesh/mesh.h"

/* A face of a cell is a triangle of the mesh, by its index, or the bisector with another cell: that
 * cell's index behind all triangles. */
typedef struct scree_cut_edge {
  uint32_t from, to; /* vertices */
  uint32_t other;    /* the face on the other side */
} scree_cut_edge;

typedef struct scree_cut_face {
  uint32_t face;
  uint32_t first, count; /* of the edges */
} scree_cut_face;

/* A cell: its faces as sets of directed edges, in no order. */
typedef struct scree_cut_cell {
  SCREE_LIST(scree_cut_face) faces;
  SCREE_LIST(scree_cut_edge) edges;
} scree_cut_cell;
void scree_cut_cell_free(scree_cut_cell *cell);

/* What a vertex is: where three planes meet, by what these are. */
typedef struct scree_cut_key {
  uint32_t kind, of[4];
} scree_cut_key;

typedef struct scree_cut_vertex {
  vec3 at;
  scree_cut_key key;
  uint32_t stamp, value; /* of whatever is asked of the vertices next */
  bool out;
} scree_cut_vertex;

typedef struct scree_cutter {
  const scree_mesh *mesh; /* borrowed, as are the sites */
  const vec3 *sites;      /* of the cells */
  size_t site_count;
  double size, margin;                   /* m: of the body; what is nearer to a plane is in doubt */
  vec3 *normals;                         /* of the mesh's triangles, unit length */
  uint32_t *neighbours;                  /* of the mesh's half-edges: the triangle beyond */
  SCREE_LIST(scree_cut_vertex) vertices; /* the mesh's first */
  uint32_t *table;                       /* vertices by key, less the mesh's */
  size_t table_size, stamp;
  SCREE_LIST(struct scree_cut_crossing) crossings;
} scree_cutter;

/* The mesh must be closed, each edge of two triangles. To be freed, even where it fails. */
scree_status scree_cutter_make(const scree_mesh *mesh, const vec3 *sites, size_t site_count,
                               scree_cutter *cutter, scree_error *error);
void scree_cutter_free(scree_cutter *cutter);

/* The bisector of two cells, as seen from the first: its normal, of unit length, points away from
 * it; offset: normal . x of its points. The same bits, turned, from the second. */
vec3 scree_cut_bisector(const scree_cutter *cutter, size_t i, size_t j, double *offset);
/* The normal of a face of the cell, outward. */
vec3 scree_cut_normal(const scree_cutter *cutter, size_t cell, uint32_t face);
/* Begins a new question to the vertices: none has the stamp that it answers. */
uint32_t scree_cut_stamp(scree_cutter *cutter);

/* The cell of a site. *doubtful where a point is too near to a plane, or two to each other, to tell
 * which comes first: the sites are to be moved, and all begins anew. */
scree_status scree_cut_cell_of(scree_cutter *cutter, size_t site, scree_cut_cell *cell,
                               bool *doubtful, scree_error *error);
