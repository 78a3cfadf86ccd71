/* A kind of motion: one file of this folder, which holds the rows of its fields and how a wall
 * moves by them, and the one object by which everything else knows it, scree_motion_KEY. Its row in
 * kinds.h puts it into the table over which motions.c loops; nothing else names a kind.
 *
 * Every member but `put` and `fastest` may be NULL or false. */
#pragma once

#include "base/vec.h"
#include "scene/file.h"
#include "scene/plan_fields.h"

enum { SCREE_MOST_MOTIONS = 6 }; /* of a wall, by one of the plan */

typedef struct scree_motion_kind {
  bool turns;
  /* What single fields and their record's own check cannot say. */
  scree_status (*check)(const scree_reader *reader, const scree_plan_geometry *geometry,
                        const scree_plan_motion *motion);
  /* What stands in files beside the scene's, once. */
  scree_status (*read)(scree_scene *scene, const scree_plan_motion *motion, const char *folder,
                       scree_error *error);
  /* How the walls of a copy move; the count, at most SCREE_MOST_MOTIONS. Those there are as
   * scree_default_wall_motion; the window of time is set for all kinds. */
  size_t (*put)(const scree_plan_geometry *geometry, const scree_plan_motion *motion, size_t copy,
                scree_wall_motion *motions);
  /* m/s, rad/s: of a wall that stands at a place; false: they change, and it can act during no
   * phase. */
  bool (*velocity)(const scree_plan_motion *motion, vec3 place, vec3 *velocity, vec3 *spin);
  /* m/s: the most, of the geometry's farthest point. */
  double (*fastest)(const scree_scene *scene, size_t geometry, const scree_plan_motion *motion);
} scree_motion_kind;

#define SCREE_MOTION_EXTERN(T, row, key, ...) extern const scree_motion_kind scree_motion_##key;
SCREE_MOTION_KINDS(SCREE_MOTION_EXTERN, )

/* ---- what kinds ask for ---- */

/* Makes it go by a table, where that has rows. */
void scree_motion_take_table(scree_wall_motion *motion, const scree_table *table,
                             scree_motion_law law);
void scree_motion_take_sine(scree_wall_motion *motion, double amplitude, double frequency,
                            double phase);
/* The largest number of a table, without its sign; the largest slope. */
double scree_motion_largest(const scree_table *table);
double scree_motion_steepest(const scree_table *table);
/* m: the farthest point of a geometry from an axis; 0 where it has no end. */
double scree_motion_arm(const scree_scene *scene, size_t geometry, const double axis[3],
                        const double through[3]);

static const double scree_full_turn = 6.283185307179586;
