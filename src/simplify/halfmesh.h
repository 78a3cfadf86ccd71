/* The surface while it is decimated: half-edges in flat arrays, in a box of about unit size.
 *
 * Half-edge h = 3 t + i of triangle t goes from vertex half[h].from to half[next(h)].from; its twin
 * is the half-edge the other way in the neighbouring triangle, or NONE on a boundary. Every vertex
 * keeps one outgoing half-edge: on a boundary the one without twin, so that turning
 * counter-clockwise from it visits the whole fan. A vertex of the mesh where several fans meet, or
 * with an edge of three or more triangles, becomes one locked vertex per fan: such a vertex never
 * moves, and the copies come together again when a level is rebuilt. Hence everything here is
 * manifold, whatever the scan. */
#pragma once

#include "base/alloc.h"
#include "base/sum.h"
#include "base/vec.h"

#define SCREE_NONE UINT32_MAX

/* LOCKED: never moves. STALE: its triangles changed since its sums were found. MARKER: it stands
 * for its shell (guard/marker.h). */
enum { SCREE_VERTEX_LOCKED = 1, SCREE_VERTEX_STALE = 2, SCREE_VERTEX_MARKER = 8 };

/* What is asked for together lies together: the cost of decimation is that of waiting for memory.
 */
typedef struct scree_half_edge {
  uint32_t from; /* NONE: the triangle is gone */
  uint32_t twin;
} scree_half_edge;

typedef struct scree_vertex {
  vec3 at;           /* in the unit box */
  uint32_t outgoing; /* NONE: the vertex is gone */
  uint32_t origin;   /* the vertex of the mesh given */
} scree_vertex;

typedef struct scree_halfmesh {
  scree_vertex *vertex;
  scree_half_edge *half;
  uint8_t *flags;     /* of vertices: SCREE_VERTEX_... */
  double (*sums)[10]; /* of vertices: the method's quadric, see cost/cost.h; NULL: none yet */
  size_t vertex_count, triangle_count;           /* extents of the arrays */
  size_t live_vertex_count, live_triangle_count; /* still there */
  vec3 centre;    /* position in metres = centre + scale * position in the box */
  double scale;   /* a power of two */
  vec3 low, high; /* of the surface as it was built, in the box */
  double area;    /* the same */
  size_t boundary_edge_count, locked_vertex_count, shell_count;
  bool closed; /* no half-edge without twin at the start */
} scree_halfmesh;

static inline uint32_t scree_next(uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
static inline uint32_t scree_previous(uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}
static inline uint32_t scree_to(const scree_halfmesh *s, uint32_t h) {
  return s->half[scree_next(h)].from;
}
/* The next outgoing half-edge of the same vertex, counter-clockwise; NONE past a boundary. */
static inline uint32_t scree_turn(const scree_halfmesh *s, uint32_t h) {
  return s->half[scree_previous(h)].twin;
}
static inline bool scree_on_boundary(const scree_halfmesh *s, uint32_t v) {
  return s->half[s->vertex[v].outgoing].twin == SCREE_NONE;
}

/* A position in metres, in the box. */
static inline vec3 scree_into_box(const scree_halfmesh *s, vec3 p) {
  return vec3_scale(vec3_sub(p, s->centre), 1 / s->scale);
}

static inline bool scree_is_gone(const scree_halfmesh *s, size_t triangle) {
  return s->half[3 * triangle].from == SCREE_NONE;
}
static inline void scree_corners(const scree_halfmesh *s, size_t triangle, vec3 at[3]) {
  for (size_t i = 0; i < 3; i++) at[i] = s->vertex[s->half[3 * triangle + i].from].at;
}

/* Adds the triangle's area, and its part of the volume about the box's middle. */
static inline void scree_add_triangle(const scree_halfmesh *s, size_t triangle, scree_sum *area,
                                      scree_sum *volume) {
  vec3 at[3];
  scree_corners(s, triangle, at);
  vec3 n = vec3_triangle_normal(at[0], at[1], at[2]);
  scree_sum_add(area, 0.5 * vec3_norm(n));
  scree_sum_add(volume, vec3_dot(at[0], n) / 6);
}

/* Builds the surface of a mesh, in the box of another (NULL: in its own); what scree_curve_build
 * says about bad meshes is checked here. */
scree_status scree_halfmesh_build(const scree_mesh *mesh, const scree_halfmesh *other,
                                  scree_halfmesh *surface, scree_error *error);
void scree_halfmesh_free(scree_halfmesh *surface);

/* A copy of a squeezed surface, without sums; to be freed also where it fails. */
scree_status scree_halfmesh_copy(const scree_halfmesh *surface, scree_halfmesh *copy,
                                 scree_error *error);

/* Squeezes out what is gone, keeping the order. Needs scratch for 4 bytes per vertex and per
 * triangle. */
void scree_halfmesh_compact(scree_halfmesh *surface, uint32_t *vertex_scratch,
                            uint32_t *triangle_scratch);
/* After that: memory that is not needed any more goes back to the system. */
void scree_halfmesh_give_back(const scree_halfmesh *surface);
