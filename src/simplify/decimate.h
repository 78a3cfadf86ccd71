/* The engine: from a surface to the record of its collapses. */
#ifndef SCREE_SIMPLIFY_DECIMATE_H
#define SCREE_SIMPLIFY_DECIMATE_H

#include "base/progress.h"
#include "simplify/anchor.h"
#include "simplify/cost.h"
#include "simplify/grid.h"
#include "simplify/relax.h"

/* A vertex that moved after a collapse, which is still of the same step from level to level. */
typedef struct scree_move {
  uint32_t index, vertex; /* of the collapse; of the mesh given */
  vec3 position;          /* metres */
} scree_move;

typedef struct scree_moves {
  scree_move *items;
  size_t count, capacity;
} scree_moves;

/* One of the coarsest levels of method `volume` as a whole, in metres (ending.h). */
typedef struct scree_whole_level {
  size_t vertex_count, triangle_count;
  uint32_t *origin;        /* per vertex: in the mesh given, ascending */
  vec3 *position;          /* per vertex */
  uint32_t (*triangle)[3]; /* corners: of these vertices */
  double area, volume;
  float error; /* of the record that led to it, with this level's end */
} scree_whole_level;

/* From fine to coarse, each with fewer triangles. */
typedef struct scree_whole_levels {
  scree_whole_level *items;
  size_t count, capacity;
} scree_whole_levels;

/* The collapses in their order, one array per field. Positions and measures are in metres. */
typedef struct scree_record {
  size_t count, capacity;
  uint32_t *kept,
      *gone;      /* vertices of the mesh given; bit 31 of kept: one triangle goes, not two */
  vec3 *position; /* where kept lies afterwards */
  double *area, *volume;    /* while decimating: change of the collapse; then: the level's value */
  float *error;             /* mean square move, unit box; then: running maximum, metres */
  scree_moves moves;        /* in their order; what they change counts with their collapse */
  scree_whole_levels whole; /* after all of these */
} scree_record;

#define SCREE_ONE_TRIANGLE UINT32_C(0x80000000)

/* What single collapses go by, which differs between the ways to the coarsest levels. */
typedef struct scree_rule {
  double toll;       /* times that of greedy.c */
  double least_turn; /* of normals below SCREE_TURNED_COUNT triangles (collapse.h) */
} scree_rule;

/* What of method `volume` is left as its collapses and their moves make it (ending.h, settle.h): a
 * slow oracle can follow that. */
typedef enum scree_unsettled {
  SCREE_UNSETTLED_NONE,
  SCREE_UNSETTLED_LEVELS, /* the coarsest, each by itself: there is one way to them */
  SCREE_UNSETTLED_ALL     /* and the surface on its way */
} scree_unsettled;

typedef struct scree_decimator {
  const scree_mesh *mesh; /* the mesh given */
  scree_halfmesh s;
  const scree_coster *coster;
  scree_simplify_options options;
  double error_limit; /* mean square, unit box; INFINITY: none */
  scree_record record;
  size_t first_triangle_count;
  size_t single_from; /* triangles: where the batches end and single collapses begin */
  scree_unsettled unsettled;
  const scree_rule *rule; /* NULL: the usual one */
  scree_grid grid;
  scree_memory memory; /* of surfaces that the batches came to; nothing before */
  scree_anchors anchors;
  double mean_move; /* of the collapses of the last pass: the root of the mean square move; or 0 */
  int lenient;      /* where passes stall: how often their limits were doubled (limit.h) */
  scree_ticker ticker;
  scree_error *error;
} scree_decimator;

static inline scree_rule scree_rule_of(const scree_decimator *d) {
  const scree_rule usual = {.toll = 1, .least_turn = SCREE_LEAST_COARSE_TURN};
  return d->rule ? *d->rule : usual;
}

/* The record has room for so many collapses. */
scree_status scree_record_allocate(scree_record *record, size_t capacity, scree_error *error);

void scree_record_free(scree_record *record);

/* How many of its collapses leave more than so many triangles. */
size_t scree_record_above(const scree_decimator *d, size_t triangle_count);

/* What the items hold. */
void scree_whole_level_free(scree_whole_level *level);

/* All that it holds. */
void scree_decimator_free(scree_decimator *d);

/* Writes one collapse to its place in the record (room was reserved for as many as there are
 * vertices), before it is done. The count is the caller's. */
void scree_record_write(scree_decimator *d, size_t place, const scree_ring *ring,
                        const scree_change *change, double error);

/* The same of a move of the fan's vertex, after the last collapse written; and of the place alone,
 * where what the move changes is told otherwise. */
scree_status scree_record_move(scree_decimator *d, const scree_ring *fan,
                               const scree_change *change);
scree_status scree_record_place(scree_decimator *d, uint32_t vertex, vec3 at);

/* Of large scans method `volume` looks at less, or later, for it takes time: see the counts below.
 */
enum { SCREE_LARGE_COUNT = 600000 };
static inline bool scree_is_large(const scree_decimator *d) {
  return d->first_triangle_count > SCREE_LARGE_COUNT;
}

/* Where the batches end and single collapses begin, in triangles; method `volume` on large scans
 * goes on in batches to the second, for it is most of what does not run in parallel. */
enum { SCREE_GREEDY_COUNT = 10000, SCREE_GREEDY_LATE = 5000 };

/* From how many triangles on there are witnesses (memory.h), and the surface is kept if it is not
 * yet; method `volume`. To look at every stray from there on takes time, so that with large scans
 * it is later. */
enum { SCREE_KEPT_COUNT = 100000, SCREE_KEPT_LATE = 30000 };

/* Scans of more triangles, unless they are large, have room in the mean distance: their levels are
 * held closer to them, down to so many triangles. Of these and of large scans the surface is kept,
 * still without witnesses, from so many on already. */
enum { SCREE_CLOSE_SCAN = 200000, SCREE_CLOSE_COUNT = 3000, SCREE_SURFACE_COUNT = 180000 };
static inline bool scree_is_close_scan(const scree_decimator *d) {
  return !scree_is_large(d) && d->first_triangle_count > SCREE_CLOSE_SCAN;
}
static inline bool scree_is_held_close(const scree_decimator *d) {
  return scree_is_close_scan(d) && d->s.live_triangle_count > SCREE_CLOSE_COUNT;
}

/* Below how many triangles vertices move after a collapse (relax.h), and all of them together now
 * and then (settle.h); method `volume`. With large scans later, the former not before the last
 * levels: the latter alone makes as good ones in less time. */
enum { SCREE_RELAXED_COUNT = 3000, SCREE_RELAXED_LATE = 130 };
enum { SCREE_PATH_COUNT = 3000, SCREE_PATH_LATE = 1700 };

/* Below how many triangles their normals may turn farther (collapse.h); method `volume`. */
enum { SCREE_TURNED_COUNT = 1000 };

/* Witnesses for a triangle above which they are thinned, and how many are kept however few
 * triangles there are: places found by few fit these rather than the scan. Of close scans more of
 * the latter; of large scans fewer for a triangle, until the surface settles, for it takes time. */
enum { SCREE_CROWD = 48, SCREE_CROWD_OF_LARGE = 24 };
enum { SCREE_LEAST_WITNESSES = 4000, SCREE_LEAST_OF_CLOSE = 10000 };

/* Of large scans, how many are spread for the levels that look ahead (keep.c), and for a triangle:
 * fewer from about half of these levels on. */
enum { SCREE_SPREAD_COUNT = 8000, SCREE_CROWD_SPREAD = 90 };

/* The sums of all vertices, if there are none yet: they are needed but in patches. */
scree_status scree_decimate_sum(scree_decimator *d);

/* Keeps the surface as it is (memory.h). */
scree_status scree_decimate_keep(scree_decimator *d);

/* Of few triangles: witnesses spread evenly over the scan, of the first collapses of a
 * record, take the place of the others. */
scree_status scree_decimate_spread(scree_decimator *d, const scree_record *record,
                                   size_t gone_count);

/* Passes of many independent collapses, while there are more than single_from triangles. */
scree_status scree_decimate_in_batches(scree_decimator *d);
/* One collapse after the other, always the cheapest, to the end. */
scree_status scree_decimate_one_by_one(scree_decimator *d);

/* Tells the ticker how far it has come; false: cancelled. */
bool scree_decimate_tick(const scree_decimator *d, scree_ticker *ticker);
/* The same where so many triangles are left. */
bool scree_decimate_tick_at(const scree_decimator *d, size_t triangle_count, scree_ticker *ticker);

#endif
