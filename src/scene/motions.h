/* Motions of geometry, of whatever kind (scene/motions/kind.h). */
#pragma once

#include "base/vec.h"
#include "scene/file.h"

/* What is wrong with the motions of one, together. */
scree_status scree_motions_check(const scree_reader *reader, const scree_plan_geometry *geometry);
/* Whether one turns. */
bool scree_motion_turns(const scree_plan_motion *motion);
/* Sets those of the walls of a geometry in the world, from where they stand. */
scree_status scree_motions_set(const scree_scene *scene, size_t geometry, scree_world *world,
                               scree_error *error);
/* What they have in files, once. */
scree_status scree_motions_read(scree_scene *scene, size_t geometry, const char *folder,
                                scree_error *error);
/* m/s, rad/s: of a wall that stands at a place; false: they change. */
bool scree_motion_velocity(const scree_plan_motion *motion, vec3 place, vec3 *velocity, vec3 *spin);
/* Whether a cylinder of the geometry turns about an axis through the origin that is not its own. */
bool scree_motions_sweep(const scree_scene *scene, size_t geometry, double axis[3]);
/* m/s: the most, of the geometry's farthest point; motions act together. */
double scree_motions_fastest(const scree_scene *scene, size_t geometry);
/* Refuses motions that pass bodies within a step: jumps of tables. */
scree_status scree_motions_check_speeds(const scree_scene *scene, scree_error *error);
