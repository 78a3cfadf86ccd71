/* All vertices of a level move together (joint.h) from where the collapses and the moves after them
 * have left them. Of the coarsest levels each is settled so: the next does not begin there, so that
 * what is good for one spoils no other, and levels are settled side by side. Before them the
 * decimation itself settles now and then on its way, and goes on from there. */
#ifndef SCREE_SIMPLIFY_SETTLE_H
#define SCREE_SIMPLIFY_SETTLE_H

#include "simplify/joint.h"
#include "simplify/trial.h"

/* From how many triangles on, later with large scans (SCREE_AHEAD_LATE): there it takes time. */
enum { SCREE_SETTLED_COUNT = 200 };

/* Levels settled at once. */
enum { SCREE_SETTLED_AT_ONCE = 8 };

/* How far a vertex is to go, squared. */
typedef struct scree_errand {
  double length2;
  uint32_t vertex;
} scree_errand;

/* What steps change of a level: as it was before the last one. */
typedef struct scree_stand {
  vec3 *places;             /* per vertex */
  scree_witness *witnesses; /* and per triangle the first, as the memory has them */
  uint32_t *first;
  double area, volume; /* changes of them so far */
} scree_stand;

/* A level on its way. */
typedef struct scree_settled {
  scree_step *step;  /* whose surface it is */
  scree_trial trial; /* of a level beside the path */
  scree_stand before;
  scree_joint joint;
  vec3 *places;          /* per vertex */
  scree_errand *errands; /* of those that may move */
  uint32_t *lists;       /* per triangle: scratch */
  uint32_t *followed;    /* and per witness */
  bool *graph;           /* and per vertex and triangle, to see whether the surface meets itself */
  scree_swept *swept;
  size_t index; /* of the collapse that made the level */
  scree_status status;
} scree_settled;

/* Room to settle the surface itself; free it whatever the outcome. */
scree_status scree_settled_allocate(scree_settled *level, const scree_decimator *d);
void scree_settled_free(scree_settled *level);

/* Settles the step's surface by a few steps, after its last collapse; its memory is kept, with no
 * more witnesses than when room was made. */
scree_status scree_settle_path(scree_settled *level, scree_step *step);

/* The surface without what is gone of it, while the decimation itself goes on with all. */
typedef struct scree_draft {
  scree_trial trial;
  double (*sums)[10]; /* room, as the rest */
  uint8_t *refused;
  uint32_t *vertices, *triangles;
} scree_draft;

/* Where a vertex stands in the last level settled. */
typedef struct scree_shown {
  uint32_t origin; /* of the mesh given */
  vec3 at;
} scree_shown;

typedef struct scree_settling {
  scree_draft draft; /* until the decimation forgets what is gone (ahead.h) */
  scree_settled levels[SCREE_SETTLED_AT_ONCE];
  size_t count;        /* levels waiting */
  size_t first;        /* collapse: the first whose level is settled */
  scree_shown *shown;  /* vertices that there were when it began, in their order */
  double area, volume; /* of that level, less those that it had before */
  scree_moves moves;   /* from level to level */
} scree_settling;

/* From the step's surface as it is on, of which the memory is kept. Free what it holds whatever the
 * outcome. */
scree_status scree_settle_begin(scree_settling *settling, const scree_step *step);
void scree_settle_free(scree_settling *settling);

/* Takes the level that the last collapse has made; a few are settled at once. */
scree_status scree_settle_level(scree_settling *settling, const scree_step *step);
/* After the last level: settles those that wait, and the record tells of settled levels instead. */
scree_status scree_settle_end(scree_settling *settling, scree_decimator *d);

#endif
