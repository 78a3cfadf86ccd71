/* What curve.c and orders.c build, and replay.c reads. */
#pragma once

#include "base/owned.h"
#include "simplify/decimate.h"

struct scree_curve {
  const scree_mesh *mesh; /* the one given, or `cut` */
  scree_mesh coarse;      /* of a tail: its own */
  scree_mesh cut;         /* the one given with its flat fans cut anew, its positions borrowed */
  scree_collapse_record record;
  scree_curve_facts facts;
  scree_simplify_options options;
  double scale; /* of the mesh, since it was decimated */
  /* The orders of its last part: that of the record, and the other ones once they are asked for.
   * Without a fork there is one only. */
  scree_fork fork;
  int order;
  scree_collapse_record tails[SCREE_ORDER_COUNT];
  uint32_t *counts;    /* triangles per level, NULL where every collapse takes two */
  double area, volume; /* of level 0 */
};

/* Turns what a decimation recorded into the values of levels, in units of the mesh; area and volume
 * are those before the first, in the box, worst is the largest move. */
void scree_record_accumulate(scree_collapse_record *record, scree_sum area, scree_sum volume,
                             double worst, double scale);
/* Whether the level is another in other orders. */
bool scree_curve_is_below_fork(const scree_curve *curve, size_t level_index);
/* The curve from a level on, as if that were the mesh given: level i is the curve's from + i, and
 * its mesh costs what there is of it from there. It has one order, and its facts are the curve's.
 */
scree_status scree_curve_tail(const scree_curve *curve, size_t from, scree_curve **tail,
                              scree_error *error);
/* After the record has changed: triangles per level, and the floor. */
scree_status scree_curve_count_levels(scree_curve *curve, scree_error *error);
