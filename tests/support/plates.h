/* Walls for tests: profiles drawn out along x, with their facets split at random. All meshes are
 * freed with scree_mesh_free. */
#pragma once

#include "base/rng.h"
#include "base/vec.h"
#include "scree.h"

/* Quadrangles of which the corners 4 i .. 4 i + 3 lie one after another, welded. */
scree_mesh plates_of(const vec3 *corners, size_t count);
/* Edges are split at random places until there are at least `facets`; the shape stays. */
void plates_split(scree_mesh *mesh, size_t facets, scree_rng *rng);
/* All facets the other way round. */
void plates_turn(scree_mesh *mesh);

/* Two planes that meet along the x axis: the floor z = 0 for y < 0, and one that stands on it at an
 * angle (rad), which the bisector of both halves; each `length` wide, `width` along x. A sheet, or
 * closed and `thick` behind the corner, or where that is 0 the wedge itself. */
typedef struct plates_corner {
  double angle, length, width, thick;
  bool closed;
} plates_corner;
scree_mesh plates_make_corner(const plates_corner *corner);
/* How far p lies above the floor and before the other plane: both above 0 between them. */
void plates_heights(const plates_corner *corner, vec3 p, double heights[2]);
/* From the x axis between the two, unit. */
vec3 plates_bisector(const plates_corner *corner);

/* An octahedron-like stone: an icosphere of 80 facets, roughened. */
scree_mesh plates_stone(double radius, scree_rng *rng);

/* Of about this radius: a thin plate, a cube, a stone, a ball, a clump of three. */
typedef enum plates_body_kind {
  PLATES_PLATE,
  PLATES_CUBE,
  PLATES_STONE,
  PLATES_BALL,
  PLATES_CLUMP,
  PLATES_BODIES
} plates_body_kind;
scree_particle *plates_body(plates_body_kind kind, double radius, scree_rng *rng);
