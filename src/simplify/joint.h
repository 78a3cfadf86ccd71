/* Where all vertices of a coarse level together lie better: moved one at a time (relax.h), each
 * waits for its neighbours, and volume is passed on from two to two. */
#ifndef SCREE_SIMPLIFY_JOINT_H
#define SCREE_SIMPLIFY_JOINT_H

#include "base/sym3.h"
#include "simplify/stray.h"

/* What a triangle adds to the equations, by its corners; `shared` with the next one. */
typedef struct scree_joint_part {
  vec3 n; /* the doubled area vector */
  sym3 own[3], shared[3];
  vec3 pull[3];
  double shares[3];
} scree_joint_part;

/* What its two ends have in common in the equations. */
typedef struct scree_joint_edge {
  uint32_t ends[2];
  sym3 shared;
} scree_joint_edge;

typedef struct scree_joint {
  bool *free; /* per vertex: it may move; the caller's to set */
  /* Per vertex, set by scree_joint_solve: its way, by which the volume is kept to first order, and
   * how pressure moves it. */
  vec3 *step, *per_n;
  double n_per_n; /* six times the volume that a unit of pressure takes */
  /* As the steps began: the mean distance of the witnesses, the squared distance of the farthest of
   * all, a witness perhaps, and what one that lies so far off weighs. */
  double mean, far2, far_share;
  scree_far_place *far; /* vertices and places on edges that lie far off, as it is */
  size_t far_count;
  scree_place_hint (*hints)[SCREE_LEVEL_PLACES]; /* per half-edge */
  bool hinted; /* by a level before this, perhaps; false after a change of numbers */
  sym3 *own, *damped, *inverse; /* the equations: blocks per vertex, the same with damping, and
                                   turned around */
  sym3 *shared;                 /* per half-edge; and per edge of two triangles both */
  scree_joint_edge *edges;
  size_t edge_count;
  vec3 *n, *pull;          /* per vertex: sum of the doubled area vectors of its fan; right side */
  double *shares;          /* per vertex: of the squares, weighted */
  scree_joint_part *parts; /* per triangle */
  vec3 *room[2][4];        /* to solve for the ways, and for what pressure does */
} scree_joint;

/* Room for the surface's arrays as they are. Free it whatever the outcome. */
scree_status scree_joint_allocate(scree_joint *joint, const scree_halfmesh *s, scree_error *error);
void scree_joint_free(scree_joint *joint);

/* Before scree_halfmesh_compact: what it knows gets the triangles' new numbers. */
void scree_joint_compact(scree_joint *joint, const scree_halfmesh *s);

/* The level as it is: what the steps are measured against; answers its merit. about2: the squared
 * distance that is expected of its farthest place. */
double scree_joint_begin(scree_joint *joint, const scree_memory *memory, const scree_halfmesh *s,
                         double about2);

/* Looks for what lies far off now. */
void scree_joint_look(scree_joint *joint, const scree_memory *memory, const scree_halfmesh *s);

/* What the steps make less: twice the mean distance and a quarter of what lies far off, weighted.
 * After a look. */
double scree_joint_merit(const scree_joint *joint, const scree_memory *memory,
                         const scree_halfmesh *s);

/* Fills the equations, after a look. False: nothing was off. */
bool scree_joint_fill(scree_joint *joint, const scree_memory *memory, const scree_halfmesh *s);
/* Finds the steps; damping: against the sums of the squared shares. False: the volume has no way to
 * be kept. */
bool scree_joint_solve(scree_joint *joint, const scree_halfmesh *s, double damping);

/* Where the steps lead, with the volume kept: per vertex. */
void scree_joint_places(const scree_joint *joint, const scree_halfmesh *s, vec3 *places);

#endif
