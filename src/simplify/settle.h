/* The levels that look ahead are settled: from where the collapse and the moves after it have left
 * them, all vertices of a level move together (joint.h). The next level does not begin there, so
 * that what is good for one spoils no other, and levels are settled side by side. */
#ifndef SCREE_SIMPLIFY_SETTLE_H
#define SCREE_SIMPLIFY_SETTLE_H

#include "simplify/joint.h"
#include "simplify/trial.h"

/* Levels settled at once. */
enum { SCREE_SETTLED_AT_ONCE = 8 };

/* A level on its way. */
typedef struct scree_settled {
  scree_trial trial, before; /* before: as it was before the last step */
  scree_joint joint;
  vec3 *places;    /* per vertex */
  uint32_t *lists; /* per triangle: scratch */
  size_t index;    /* of the collapse that made the level */
  scree_status status;
} scree_settled;

typedef struct scree_settling {
  scree_settled levels[SCREE_SETTLED_AT_ONCE];
  size_t count;        /* levels waiting */
  size_t first;        /* collapse: the first whose level is settled */
  vec3 *shown;         /* per vertex: where it stands in the last level settled */
  double area, volume; /* of that level, less those that it had before */
  scree_moves moves;   /* from level to level */
} scree_settling;

/* From the surface as it is on. Free what it holds whatever the outcome. */
scree_status scree_settle_begin(scree_settling *settling, const scree_decimator *d);
void scree_settle_free(scree_settling *settling);

/* Takes the level that the last collapse has made; a few are settled at once. */
scree_status scree_settle_level(scree_settling *settling, const scree_step *step);
/* After the last level: settles those that wait, and the record tells of settled levels instead. */
scree_status scree_settle_end(scree_settling *settling, scree_decimator *d);

#endif
