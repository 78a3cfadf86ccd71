/* Shells that lie in or beside each other stay so.
 *
 * That no facets come to cross is not enough: a collapse may lift the surface over another shell as
 * a whole, and a cavity would lie outside the body. A shell is all on one side of every other, so
 * one vertex of it, its anchor, tells on which. */
#ifndef SCREE_SIMPLIFY_ANCHOR_H
#define SCREE_SIMPLIFY_ANCHOR_H

#include "simplify/collapse.h"

typedef struct scree_anchors {
  uint32_t *vertex;
  size_t count; /* 0 where there is only one shell */
} scree_anchors;

/* Lists the anchors by their flag, which scree_collapse_apply hands on. */
scree_status scree_anchors_find(const scree_halfmesh *s, scree_anchors *anchors,
                                scree_error *error);
void scree_anchors_free(scree_anchors *anchors);

/* After a collapse. */
void scree_anchors_follow(scree_anchors *anchors, const scree_ring *ring);

/* Whether no anchor lies in what the ring sweeps over; the ring's box must be set. Anchors of the
 * ring itself do not count. */
bool scree_anchors_stay(const scree_anchors *anchors, const scree_halfmesh *s,
                        const scree_ring *ring, vec3 target);

#endif
