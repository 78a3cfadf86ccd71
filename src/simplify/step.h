/* One collapse of those done one by one, with the moves after it (relax.h). */
#ifndef SCREE_SIMPLIFY_STEP_H
#define SCREE_SIMPLIFY_STEP_H

#include "simplify/decimate.h"

/* The vertices about a collapse, at most: the survivor and the corners of its ring. */
enum { SCREE_MOST_ABOUT = 2 * SCREE_RING_MAX + 1 };

typedef struct scree_step {
  scree_decimator *d;
  uint32_t *stamp;   /* per vertex: the collapse that last touched it */
  uint32_t *touched; /* vertices stamped now */
  size_t touched_count;
  uint32_t now;
  size_t relaxed_below; /* triangles: from there on vertices move; 0: never */
  double farthest2;     /* the squared distance of the farthest place of the level */
  size_t farthest_at;   /* triangles: found anew */
} scree_step;

/* Whether the ring may be collapsed, or the fan's vertex moved, to change->target; *status tells of
 * failed memory. */
bool scree_step_allows(scree_step *step, scree_ring *ring, scree_change *change,
                       scree_around *around, scree_status *status);
/* The two parts of that, the first of which takes less time: what holds of the new triangles each
 * and of where the vertex lies, then whether the surface would meet itself. */
bool scree_step_is_sound(const scree_step *step, scree_ring *ring, scree_change *change,
                         scree_around *around);
bool scree_step_is_clear(scree_step *step, const scree_ring *ring, const scree_change *change,
                         const scree_around *around, scree_status *status);
/* False: it is not sound, nor will be, whatever else goes, while no vertex of the ring moves or
 * goes. */
bool scree_step_may_be_sound(const scree_step *step, scree_ring *ring, vec3 target);
/* The same as scree_step_allows, but for whether the surface would meet itself, of a fan. */
bool scree_step_suits(const scree_step *step, scree_ring *fan, scree_change *change,
                      scree_around *around);

/* The fan of a vertex that may move; false: it may not. */
bool scree_step_gather(const scree_halfmesh *s, uint32_t vertex, scree_ring *fan);

/* Once the fan's vertex has moved, the grid is told of its new triangles. */
scree_status scree_step_list(scree_step *step, const scree_ring *fan, const scree_around *around);

/* Finds the farthest place of the level anew, where it is time. */
void scree_step_find_farthest(scree_step *step);

/* Writes the collapse to the record and does it, with the moves after it; it was allowed. Every
 * vertex of which triangles changed is among those touched. */
scree_status scree_step_collapse(scree_step *step, const scree_ring *ring,
                                 const scree_change *change, const scree_around *around,
                                 double error);

#endif
