/* What the bench of the world is made of. Everything goes through the public interface. */
#pragma once

#include "scree.h"

enum { MOST_SHAPES = SCREE_SAMPLE_DEVICES };

/* The shapes of a scene. */
typedef struct shape_set {
  scree_particle *items[MOST_SHAPES];
  size_t count;
} shape_set;

/* Ends the program with the error's sentence where status is one. */
void need(scree_status status, const scree_error *error);

/* shapes.c: "devices" (the nine samples at `triangles`), "boxes" (100 x 50 x 15 mm) or "tray" (the
 * box with a recess, 28 triangles, each cut in four until there are `triangles`). */
void make_shapes(const char *kind, size_t triangles, shape_set *set);
void free_shapes(shape_set *set);

/* scene.c */

/* Fills `count` bodies into a cylinder of 0.4 m on a disc of 3 m and lets them come to rest. */
scree_world *fill_scene(const shape_set *shapes, size_t count, uint64_t seed);
/* `copies` of the scene above each other in the same cylinder, sunk into each other and at rest. */
scree_world *stack_scene(const scree_world *from, size_t copies);
/* `copies` of the scene above each other, each on a floor of its own, after `time` s: many bodies
 * at rest without the hours that a column of them takes to settle. */
scree_world *shelve_scene(const scree_world *from, size_t copies, double time);
/* The scene after its cylinder has risen by `height`, at full stiffness. */
void lift_scene(scree_world *world, double height);
/* The scene with the time step given, or 0: automatic. */
scree_world *retime_scene(const scree_world *from, double time_step);
