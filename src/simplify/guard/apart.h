/* Does a collapse make the surface run into itself?
 *
 * Certificate. If in a box all triangles face one direction g (n.g > 0), then, the surface being
 * closed and free of self-intersections, every line along g crosses it at most once inside the box:
 * two crossings in a row would go in and out, one of them facing away. So the surface in the box is
 * a graph over the plane across g, and replacing a part of it, boundary kept, by triangles that lie
 * in the box and face g too gives a graph again: no self-intersection. The box is that of the fan
 * before and after; what other collapses of the pass make of triangles in it counts as well.
 *
 * Search. Where that does not decide, pairs of triangles are tested exactly. */
#pragma once

#include "simplify/fan.h"
#include "simplify/guard/marker.h"

typedef struct scree_surroundings {
  const scree_halfmesh *s;
  const scree_surface_tree *tree; /* of the surface and of what is planned */
  const scree_markers *markers;   /* of its shells */
  const scree_planned *planned;   /* NULL: nothing; else the fan's own collapse is among it */
} scree_surroundings;

/* True if the fan's triangles as it is set meet no more others, as these are and as planned
 * collapses before it in order (a lower index) make them, than they do now, and no shell is leapt
 * over. Thread-safe. */
bool scree_apart(const scree_surroundings *around, const scree_fan *fan);
