/* The triangles that are a patch's alone (patch.h), by place: for searches by its thread. */
#ifndef SCREE_SIMPLIFY_OWN_H
#define SCREE_SIMPLIFY_OWN_H

#include "simplify/grid.h"

/* A box in steps: low, then the complement of high, so that one comparison of all tells whether two
 * are apart; rounded to a whole vector. */
typedef struct scree_own_box {
  uint16_t bound[8];
} scree_own_box;

typedef struct scree_own {
  vec3 low;
  double steps_per_length;
  uint32_t *triangles;  /* in an order in which they lie near each other */
  scree_own_box *boxes; /* of each; then of groups of them, of groups of groups, and so on */
  uint64_t *averse;     /* directions that each does not face (grid.h) */
  uint32_t *found;      /* by the last search: places of triangles; then these */
  size_t count, room;
} scree_own;

/* Room for so many triangles, at most 2^16. Free it whatever the outcome. */
scree_status scree_own_allocate(scree_own *own, size_t room, scree_error *error);
void scree_own_free(scree_own *own);

/* The triangles are listed: finds their boxes and directions. place_of: per triangle, filled. */
void scree_own_enter(scree_own *own, const scree_grid *grid, const scree_halfmesh *s,
                     uint16_t *place_of);
/* After a collapse of the ring, by which these went: its triangles are where they are now. */
void scree_own_follow(scree_own *own, const scree_grid *grid, const scree_halfmesh *s,
                      const scree_ring *ring, const uint32_t gone[2], const uint16_t *place_of);

/* Whether the triangles around target meet no more of them than those around the edge do. The
 * ring's box is set, and `around`; the surface is closed, and no other triangle is near the ring.
 */
bool scree_own_clear(const scree_own *own, const scree_grid *grid, const scree_halfmesh *s,
                     const scree_ring *ring, vec3 target, const scree_around *around);

#endif
