/* Between two steps of a pair that moves its bodies alone, in sub-steps. */
#pragma once

#include "world/state/scratch.h"

/* A body, or a wall, of which `free` is false. */
typedef struct scree_substep_body {
  scree_frame frame;
  quat orientation;
  vec3 momentum, inertia;
  scree_wrench others; /* force and moment of all but the pair */
  double mass;
  bool free;
} scree_substep_body;

scree_substep_body scree_substep_body_of(const scree_world *world, uint32_t index, bool is_wall);
/* Its angular velocity in space with this momentum. */
vec3 scree_substep_spin(const scree_substep_body *m, vec3 momentum);
/* An impulse and its moment; `ahead`: what of it the velocities half a step on have more. */
void scree_kick(scree_substep_body *m, vec3 impulse, vec3 moment, double ahead);
void scree_kick_by_others(scree_substep_body *m, double time, double half);
/* How long each part of the pair's last step was, s. */
double scree_part_of_step(const scree_world *world, const scree_pair *pair);
/* J, of the spring on the way of a step by what the others do; the last part's way has been counted
 * with its velocity. */
double scree_work_by_others(const scree_world *world, const scree_pair *pair,
                            const scree_substep_body m[2]);
/* Into how many parts the coming step is cut for this pair. */
uint32_t scree_substep_count(const scree_world *world, const scree_pair *pair,
                             const scree_frame *relative, const scree_scratch *scratch);
/* Pose and motion of a, or b, as this pair sees it, which moved it in sub-steps. */
scree_frame scree_owed_frame(const scree_world *world, const scree_pair *pair,
                             const scree_scratch *scratch, bool of_b);
/* J, of the pair's spring since the last look, as the others did other than was foreseen. */
double scree_unforeseen_work(const scree_world *world, const scree_pair *pair,
                             const scree_scratch *scratch);
/* Force and moment of all but the pair on a, or b, in the last step; of a wall none. */
scree_wrench scree_wrench_of_others(const scree_world *world, const scree_pair *pair,
                                    const scree_scratch *scratch, bool of_b);
