/* Shells that lie in or beside each other stay so.
 *
 * That no facets come to cross is not enough: a collapse may lift the surface over another shell as
 * a whole, and a cavity would lie outside the body. A shell is all on one side of every other, so
 * one vertex of it, its marker, tells on which. */
#pragma once

#include "simplify/fan.h"

typedef struct scree_markers {
  uint32_t *vertex;
  size_t count; /* 0 where there is only one shell */
} scree_markers;

/* Lists the markers by their flag, which scree_collapse_apply hands on. */
scree_status scree_markers_find(const scree_halfmesh *s, scree_markers *markers,
                                scree_error *error);
void scree_markers_free(scree_markers *markers);

/* After a collapse. */
void scree_markers_follow(scree_markers *markers, const scree_fan *fan);

/* Whether no marker lies in what the fan sweeps over, where it is and where it is planned to be;
 * the bounds are the fan's, before and after. Markers of the fan itself do not count. */
bool scree_markers_stay(const scree_markers *markers, const scree_halfmesh *s, const scree_fan *fan,
                        const scree_bounds *bounds, const scree_planned *planned);
