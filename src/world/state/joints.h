/* Joints of a world: what is kept of each, and what the step asks of them. law.h has the law. */
#pragma once

#include "base/array.h"
#include "world/state/world.h"

/* A body, or space. */
typedef struct scree_joint_side {
  const scree_frame *frame;
  quat orientation;
} scree_joint_side;

#define SCREE_SPACE_FRAME ((scree_frame){.rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}})

/* space: a frame of the caller's, SCREE_SPACE_FRAME. */
static inline scree_joint_side scree_joint_side_of(const scree_world *world, uint32_t body,
                                                   const scree_frame *space) {
  if (body == scree_none) return (scree_joint_side){space, {1, 0, 0, 0}};
  return (scree_joint_side){&world->bodies.frame[body], world->bodies.orientation[body]};
}

void scree_joints_free(scree_joints *joints);
/* A copy of a joint of another world between bodies whose numbers are higher by `shift`, whole,
 * with this share of its strengths. */
scree_status scree_world_copy_joint(scree_world *to, const scree_world_joint *joint, uint32_t shift,
                                    double strength, scree_error *error);
/* Before a step: groups and fragments are those of what there is. */
scree_status scree_joints_prepare(scree_world *world, scree_error *error);
/* After a joint's state changed: finds the fragments of all bodies by the joints that are whole. */
void scree_joints_regroup(scree_world *world);
/* The first body of those that it hangs together with: where bodies are counted, it stands for
 * them. */
size_t scree_world_leader(const scree_world *world, size_t body);
/* The longest step that the joints bear, s; INFINITY without any. *body: which asks for it. */
double scree_joints_time_step(const scree_world *world, size_t *body);
/* What all hold, and what they have cost, J. */
typedef struct scree_joint_sums {
  double elastic, fracture, rubbed, damped;
  size_t broken_count;
} scree_joint_sums;
scree_joint_sums scree_joints_sum(const scree_world *world);
/* In or out of a checkpoint, where all bodies are there. */
void scree_joints_code(scree_codec *codec, scree_world *world);

/* A joint of body a with b, from *place on; NULL: no further. */
static inline const scree_world_joint *scree_joint_between(const scree_world *world, uint32_t a,
                                                           uint32_t b, uint32_t *place) {
  const scree_joints *joints = &world->joints;
  for (; *place < joints->begin.items[a + 1]; ++*place) {
    const scree_world_joint *j = &joints->all.items[joints->sides.items[*place] >> 1];
    if ((j->a == a ? j->b : j->a) == b) {
      ++*place;
      return j;
    }
  }
  return NULL;
}

/* Whether two bodies may not touch: they are joined, or hang together by others. */
static inline bool scree_joints_hold(const scree_world *world, uint32_t a, uint32_t b) {
  const scree_joints *joints = &world->joints;
  if (a >= joints->begin.count || b >= joints->begin.count) return false;
  bool together = joints->fragment.items[a] == joints->fragment.items[b];
  uint32_t place = joints->begin.items[a];
  for (const scree_world_joint *j; (j = scree_joint_between(world, a, b, &place));)
    if (j->area > 0 ? j->state <= SCREE_JOINT_CRACKED : together) return true;
  return false;
}

/* Whether they were held at any time: a contact of such begins from the overlap that there is. */
static inline bool scree_joints_held(const scree_world *world, uint32_t a, uint32_t b) {
  const scree_joints *joints = &world->joints;
  if (a >= joints->begin.count) return false;
  uint32_t place = joints->begin.items[a];
  return scree_joint_between(world, a, b, &place) != NULL;
}

/* Adds the forces on a body, in the order of its joints. */
static inline void scree_joints_add(const scree_world *world, size_t body, vec3 *force,
                                    vec3 *torque) {
  const scree_joints *joints = &world->joints;
  for (uint32_t k = joints->begin.items[body]; k < joints->begin.items[body + 1]; k++) {
    uint32_t side = joints->sides.items[k];
    const scree_world_joint *j = &joints->all.items[side >> 1];
    const scree_pair_wrench *w = &j->wrench;
    if (j->silent) continue;
    *force = vec3_mad(*force, w->force, side & 1 ? -1 : 1);
    *torque = vec3_add(*torque, side & 1 ? w->torque_b : w->torque_a);
  }
}
