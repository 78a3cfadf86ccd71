/* The boundary of a mesh, and the vertices of it that lie on one of its edges without being an end:
 * T-junctions, where the other side of the edge has been split and this one has not. */
#pragma once

#include "mesh/adjacency.h"
#include "mesh/mesh.h"

typedef struct scree_rim_vertex {
  double at; /* along the axis */
  uint32_t vertex;
} scree_rim_vertex;

typedef struct scree_rim {
  scree_adjacency adjacency;
  scree_rim_vertex *vertices; /* ascending along the axis, the longest of the boundary */
  size_t vertex_count;
  double *reach; /* by vertex: the shortest boundary edge there, or 0 off the boundary */
  size_t edge_count, crowded_count; /* boundary edges, edges of three or more facets */
  int axis;
} scree_rim;

scree_status scree_rim_find(const scree_mesh *mesh, scree_rim *rim, scree_error *error);
void scree_rim_free(scree_rim *rim);
/* Edges of one facet, and of three or more. */
void scree_rim_count(const scree_adjacency *adjacency, size_t *open, size_t *crowded);

/* A vertex on half-edge h, at a share of its length. */
typedef struct scree_junction {
  uint32_t half_edge, vertex;
  double share;
} scree_junction;

typedef struct scree_junctions {
  scree_junction *items;
  size_t count, capacity;
} scree_junctions;

/* How near to an edge a vertex counts as on it: in m, and as a share of the edge's length. */
typedef struct scree_junction_rule {
  double distance, share;
  size_t most; /* comparisons; beyond them none is found */
} scree_junction_rule;

/* In the order of the half-edges, and along each. *found is empty before; free its items. */
scree_status scree_junctions_find(const scree_mesh *mesh, const scree_junction_rule *rule,
                                  scree_junctions *found, scree_error *error);
/* Splits the facets there, at one edge of each in a pass, into fans from the corner across; the
 * mesh has room for so many facets more. Answers how many came new, at the end. */
size_t scree_junctions_split(scree_mesh *mesh, const scree_junctions *found);
