/* Where all vertices of a coarse level together lie better: moved one at a time (relax.h), each
 * waits for its neighbours, and volume is passed on from two to two. */
#ifndef SCREE_SIMPLIFY_JOINT_H
#define SCREE_SIMPLIFY_JOINT_H

#include "base/sym3.h"
#include "simplify/stray.h"

typedef struct scree_joint {
  bool *free; /* per vertex: it may move; the caller's to set */
  /* Per vertex, set by scree_joint_find: its way, by which the volume is kept to first order, and
   * how pressure moves it. */
  vec3 *step, *per_n;
  double n_per_n; /* six times the volume that a unit of pressure takes */
  /* Of what lies far off: the places, how many they are, and the squared distance of the farthest
   * of all, a witness perhaps. */
  scree_far_place *far;
  size_t far_count;
  double far2;
  scree_place_hint (*hints)[SCREE_LEVEL_PLACES]; /* per half-edge */
  bool hinted;
  sym3 *own, *shared; /* the equations: blocks per vertex and per half-edge */
  vec3 *n, *pull;     /* per vertex: sum of the doubled area vectors of its fan; right side */
  double *shares;     /* per vertex: of the squares, weighted */
  vec3 *room[4];
} scree_joint;

/* Room for the surface's arrays as they are. Free it whatever the outcome. */
scree_status scree_joint_allocate(scree_joint *joint, const scree_halfmesh *s, scree_error *error);
void scree_joint_free(scree_joint *joint);

/* Looks for the farthest place of the level, and for those more than half as far off. about2: the
 * squared distance that is expected of it. */
void scree_joint_look(scree_joint *joint, const scree_memory *memory, const scree_halfmesh *s,
                      double about2);

/* Finds the steps, after a look. False: nothing is off, or the volume has no way to be kept. */
bool scree_joint_find(scree_joint *joint, const scree_memory *memory, const scree_halfmesh *s);

/* Where the vertices are at this share of their steps, with the volume kept: per vertex. */
void scree_joint_places(const scree_joint *joint, const scree_halfmesh *s, double share,
                        vec3 *places);

#endif
