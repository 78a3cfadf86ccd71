/* Does a collapse make the surface run into itself? A grid of cubic cells answers at two prices.
 *
 * Certificate. Each cell knows for which of 50 directions g all triangles that touch it face g
 * (n.g > 0). If over the cells of a box all triangles face one g, then, the surface being closed
 * and free of self-intersections, every line along g crosses it at most once inside the box: two
 * crossings in a row would go in and out, one of them facing away. So the surface in the box is a
 * graph over the plane across g, and replacing a part of it, boundary kept, by triangles that lie
 * in the box and face g too gives a graph again: no self-intersection. The cells' directions only
 * shrink until the grid is built anew, whatever is replaced meanwhile, in any order.
 *
 * Search. Where that does not decide, exact tests against the triangles listed in those cells. */
#ifndef SCREE_SIMPLIFY_GRID_H
#define SCREE_SIMPLIFY_GRID_H

#include "simplify/collapse.h"
#include "simplify/order.h"

/* In cells or fractions of cells, inclusive. */
typedef struct scree_grid_box {
  uint16_t low[3], high[3];
} scree_grid_box;

typedef struct scree_grid_node {
  uint32_t triangle, next;
  scree_grid_box box; /* of the triangle as it was listed, in fractions of cells */
} scree_grid_node;

typedef struct scree_grid {
  uint64_t *averse_of; /* by direction of a normal: what it does not face, twice; see grid.c */
  const scree_frame_of_places *frame; /* in whose axes the cells are; NULL: as the surface lies */
  vec3 low;
  double cells_per_length;
  uint32_t size[3];
  size_t cell_count;
  uint64_t *averse;       /* per cell: bit k set if some triangle does not face direction k; or
                             whose it is, see scree_grid_enter_owners */
  uint64_t averse_all;    /* the same for triangles too large to be entered cell by cell */
  scree_grid_box *groups; /* cells of SCREE_GROUP triangles each; then of groups joined */
  size_t group_count;
  uint32_t *head;         /* per cell: its list, where triangles are listed */
  scree_grid_node *items; /* the lists' nodes (an array as base/array.h has it) */
  size_t count, capacity;
  uint32_t *large; /* triangles too large for lists */
  size_t large_count, large_capacity;
  size_t built_for; /* live triangles when it was built */
  bool few;         /* nothing is entered or listed: searches look at all triangles */
} scree_grid;

/* What other collapses of the same pass will do: chosen[v] is NONE or the index of the collapse
 * that takes vertex v to targets[chosen[v]]. NULL where there are none. */
typedef struct scree_planned {
  const uint32_t *chosen;
  const scree_change *changes;
} scree_planned;

/* Mean edges per cell, and the share of triangles left at which a pass sets new cells. */
#define SCREE_EDGES_PER_CELL 2.0
#define SCREE_REGRID_BELOW   0.6
/* Triangles of a group: so many one after the other. */
enum { SCREE_GROUP = 16 };

/* Makes the tables of directions, the same for every shape; what is below does where it needs them.
 */
scree_status scree_grid_prepare(scree_grid *grid, scree_error *error);

/* Sets the cells for the surface as it is: about cells_per_edge cells per mean edge, at most a few
 * per triangle. Cells are empty: fill directions or lists as needed. */
scree_status scree_grid_shape(scree_grid *grid, const scree_halfmesh *s, double edges_per_cell,
                              scree_error *error);
/* The same with cells in this frame, which must stay: for answers that do not hang on how the
 * surface lies. */
scree_status scree_grid_shape_in(scree_grid *grid, const scree_halfmesh *s,
                                 const scree_frame_of_places *frame, double edges_per_cell,
                                 scree_error *error);
void scree_grid_free(scree_grid *grid);
/* For so few triangles that searches may look at them all, in place of the cells. */
scree_status scree_grid_look_at_all(scree_grid *grid, scree_error *error);

/* Enters the directions of all triangles in place of what was there, and sets the groups; in
 * parallel. */
void scree_grid_enter_directions(scree_grid *grid, const scree_halfmesh *s);
/* Enters those of the ring's triangles as they will be (ring->low, high and around are set), over
 * the ring's box, which is returned. Thread-safe. */
scree_grid_box scree_grid_enter_ring(scree_grid *grid, const scree_ring *ring,
                                     const scree_around *around);
/* True: the collapse cannot make the surface, which is closed, meet itself. */
bool scree_grid_certifies(const scree_grid *grid, const scree_ring *ring,
                          const scree_around *around);
/* The same for a ring that was entered: its new triangles are among those in the cells. */
bool scree_grid_certifies_entered(const scree_grid *grid, const scree_grid_box *box);

/* For collapses that are certified without being entered (patch.c): enters all triangles as above,
 * but a cell counts as faced only what they face by 27 degrees and more. */
void scree_grid_enter_roomy(scree_grid *grid, const scree_halfmesh *s);
/* True: the closed ring's triangles, as they will be, face all that cells about them count as
 * faced, and some direction is faced in all of these. Then the surface, which is closed, meets
 * itself no more than before, whatever other such collapses are done first. The grid has a frame.
 */
bool scree_grid_keeps(const scree_grid *grid, const scree_halfmesh *s, const scree_ring *ring,
                      vec3 target, const scree_around *around);

/* For patches, stretches of `patch` places of vertices, in place of directions: enters whose the
 * cells are. The grid has a frame. */
void scree_grid_enter_owners(scree_grid *grid, const scree_halfmesh *s, const uint32_t *place_of,
                             size_t patch);
/* True: nothing that lies in the cells about the closed ring belongs to another patch or to
 * several, now or later, as long as all that is changed or asked for is owned in this sense. */
bool scree_grid_owns(const scree_grid *grid, const scree_halfmesh *s, const scree_ring *ring,
                     vec3 target, size_t patch);
/* The same of the cells about a vertex, on no boundary, and its neighbours. */
bool scree_grid_owns_fan(const scree_grid *grid, const scree_halfmesh *s, uint32_t vertex,
                         size_t patch);

/* One by one: lists all triangles, or one that has changed. False: out of memory. */
bool scree_grid_list_all(scree_grid *grid, const scree_halfmesh *s);
bool scree_grid_list_triangle(scree_grid *grid, const scree_halfmesh *s, uint32_t triangle);

/* In a batch: the groups of the ring's triangles get these cells as well. Thread-safe. */
void scree_grid_widen_groups(scree_grid *grid, const scree_ring *ring, const scree_grid_box *cells);
/* Before searches: joins groups to larger ones. */
void scree_grid_join_groups(scree_grid *grid);

/* Exact: true if the triangles around target meet no more others than those around the edge do.
 * With `planned` among the groups, else among the lists. ring->low and high are set. */
bool scree_grid_clear(const scree_grid *grid, const scree_halfmesh *s, const scree_ring *ring,
                      vec3 target, const scree_planned *planned);

/* The same among these triangles alone: no others come near the ring. */
bool scree_grid_clear_among(const scree_grid *grid, const scree_halfmesh *s, const scree_ring *ring,
                            vec3 target, const uint32_t *triangles, size_t count);

/* A triangle and its box. */
typedef struct scree_swept {
  vec3 low, high;
  uint32_t triangle;
} scree_swept;

/* Exact: true if no two triangles meet beyond what they share; of a few thousand at the most. The
 * grid's cells are not asked. Room for a flag per vertex and a box per triangle. */
bool scree_grid_clear_all(const scree_grid *grid, const scree_halfmesh *s, bool *graph,
                          scree_swept *swept);

#endif
