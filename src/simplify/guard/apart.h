/* Does a collapse make the surface run into itself?
 *
 * Certificate. If in a box all triangles face one direction g (n.g > 0), then, the surface being
 * closed and free of self-intersections, every line along g crosses it at most once inside the box:
 * two crossings in a row would go in and out, one of them facing away. So the surface in the box is
 * a graph over the plane across g, and replacing a part of it, boundary kept, by triangles that lie
 * in the box and face g too gives a graph again: no self-intersection. The box is that of the fan
 * before and after.
 *
 * Search. Where that does not decide, pairs of triangles are tested exactly. */
#pragma once

#include "simplify/fan.h"

/* Shells that lie in or beside each other stay so.
 *
 * That no facets come to cross is not enough: a collapse may lift the surface over another shell as
 * a whole, and a cavity would lie outside the body. A shell is all on one side of every other, so
 * one vertex of it, its marker, tells on which. */
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

/* Whether no marker lies in what the fan sweeps over; the bounds are the fan's, before and after.
 * Markers of the fan itself do not count. */
bool scree_markers_stay(const scree_markers *markers, const scree_halfmesh *s, const scree_fan *fan,
                        const scree_bounds *bounds);

typedef struct scree_surroundings {
  const scree_halfmesh *s;
  const scree_surface_tree *tree;
  const scree_markers *markers; /* of its shells */
} scree_surroundings;

/* True if the fan's triangles as it is set meet no more others than they do now, and no shell is
 * leapt over. Thread-safe. */
bool scree_apart(const scree_surroundings *around, const scree_fan *fan);

/* ---- what new triangles must not be, each by itself and with its neighbours ---- */

/* Whether, with the vertex where the fan is set, no normal turns farther than leniency allows, no
 * triangle is a sliver and no edge a fold, unless what was there is as bad; at no leniency are
 * there more folds over 149 degrees (150, less what rounding to single precision takes) or more
 * triangles without area than before. */
bool scree_shape_allows(const scree_halfmesh *s, const scree_fan *fan, int leniency);

/* Whether a vertex there would lie outside the scan's box by more than a share of the size of the
 * level's triangles. */
bool scree_shape_is_spike(const scree_halfmesh *s, vec3 at);
