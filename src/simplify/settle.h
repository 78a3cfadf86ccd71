/* All vertices of a level move together (joint.h) from where the collapses and the moves after them
 * have left them. Of the coarsest levels each is settled so: the next does not begin there, so that
 * what is good for one spoils no other, and levels are settled side by side. Before them the
 * decimation itself settles now and then on its way, and goes on from there. */
#ifndef SCREE_SIMPLIFY_SETTLE_H
#define SCREE_SIMPLIFY_SETTLE_H

#include "simplify/joint.h"
#include "simplify/trial.h"

/* Levels that may wait to be settled. */
enum { SCREE_WAIT_TO_SETTLE = 8 };

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
  struct {
    size_t vertices, triangles, witnesses;
  } room;
  const scree_step *from; /* what it is a copy of */
  float error;            /* of the record up to it */
  double score;           /* settled (scree_level_score); of use where levels are compared */
  scree_status status;
  bool over; /* it is settled, or failed */
} scree_settled;

/* Room to settle the surface itself; free it whatever the outcome. */
scree_status scree_settled_allocate(scree_settled *level, const scree_decimator *d,
                                    scree_error *error);
void scree_settled_free(scree_settled *level);

/* Settles the step's surface by a few steps, after its last collapse; its memory is kept, with no
 * more witnesses than when room was made. */
scree_status scree_settle_path(scree_settled *level, scree_step *step);

typedef struct scree_settling {
  scree_settled levels[SCREE_WAIT_TO_SETTLE]; /* a ring */
  size_t first, count; /* of those that are not told yet: the first; how many */
  size_t begun;        /* of these, the first so many are being settled, or are */
  scree_whole_levels *whole;
  bool compares;      /* levels may have the same count: the better one is told */
  double score;       /* of the last one told */
  size_t least_count; /* triangles of the last one taken */
  scree_error *error;
} scree_settling;

/* Settled levels are told to `whole`. Free what it holds whatever the outcome. */
void scree_settle_begin(scree_settling *settling, scree_whole_levels *whole, bool compares,
                        scree_error *error);
void scree_settle_free(scree_settling *settling);

/* Whether so many more may wait. */
static inline bool scree_settle_has_room(const scree_settling *settling, size_t count) {
  return settling->count + count <= SCREE_WAIT_TO_SETTLE;
}
/* A copy of the step's level as it is waits, if there is room; it has no more triangles than the
 * last one and nothing that is gone, and its grid looks at all. error: of the record up to it. */
scree_status scree_settle_later(scree_settling *settling, const scree_step *step, float error);
/* The next one to be settled, by its place. False: none waits. */
bool scree_settle_next(scree_settling *settling, size_t *place);
/* Settles it; several side by side, and beside steps of what they are copies of. */
void scree_settle_level(scree_settling *settling, size_t place);
/* Tells of it, once those that waited before it are told. */
scree_status scree_settle_tell(scree_settling *settling, size_t place);

#endif
