/* Whether an inlet's bodies begin where something holds them. */
#pragma once

#include "base/rng.h"
#include "scene/scene.h"

/* Shares of an inlet's bodies; 0 where they are too few to be told. */
typedef struct scree_scene_starts {
  double parted;    /* walls cut the region: not in its largest part */
  size_t parted_by; /* such a geometry */
  double taken;     /* begin in an outlet that is open then */
  size_t taken_by;  /* such an outlet */
  double past;      /* falling freely, meet neither geometry nor an outlet before the domain ends */
} scree_scene_starts;

/* Whether there is anything to tell of inlet `index`. Places are random, the same every time. */
bool scree_scene_look_at_starts(const scree_scene *scene, size_t index, scree_scene_starts *starts);

/* Whether bodies of inlet `index` can get to an outlet or out of the domain though a geometry that
 * begins to move only later, as a gate does, still stands; *gate: the first of those. */
bool scree_scene_passes_gate(const scree_scene *scene, size_t index, size_t *gate);

/* inlets.c: a random place of the inlet's shape `which` in its region; false: it stands out. */
bool scree_scene_draw_start(const scree_scene *scene, size_t index, size_t which, scree_rng *rng,
                            scree_placement *placement);
