/* Joints in the step: each is evaluated by itself and keeps its wrench, and each body sums those of
 * its joints in their order, so that the result does not depend on the threads. */
#include "world/state/remote.h"
#include "world/step/joint_law.h"
#include "world/step/stages.h"

#include "base/parallel.h"

enum { JOINT_BLOCK = 64 };

static const scree_pair_wrench no_wrench = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};

bool scree_joint_step(scree_world *world, size_t k) {
  scree_world_joint *j = &world->joints.all.items[k];
  const bool *removed = world->bodies.removed;
  if (j->silent) return false;
  if (!(j->area > 0) || j->state > SCREE_JOINT_CRACKED) {
    j->wrench = no_wrench;
    j->silent = true;
    return false;
  }
  if (removed[j->a] || (j->b != scree_none && removed[j->b])) {
    j->state = SCREE_JOINT_GONE;
    j->energy = 0;
    j->wrench = no_wrench;
    return true;
  }
  const scree_frame space = SCREE_SPACE_FRAME;
  const scree_joint_side a = scree_joint_side_of(world, j->a, &space),
                         b = scree_joint_side_of(world, j->b, &space);
  return scree_joint_evaluate(j, &a, &b, world->time_step, world->time);
}

static void evaluate_block(void *context, scree_block block) {
  scree_world *world = context;
  for (size_t k = block.begin; k < block.end; k++)
    if (scree_joint_step(world, k))
      atomic_store_explicit(&world->joints.changed, true, memory_order_relaxed);
}

void scree_joints_evaluate(scree_world *world) {
  scree_parallel_for(world->joints.all.count, JOINT_BLOCK, evaluate_block, world);
  if (atomic_exchange(&world->joints.changed, false)) scree_joints_regroup(world);
}

void scree_world_observe_joint(const scree_world *world, size_t index, scree_joint_observation *o) {
  (void)scree_world_bring(world, SCREE_PART_JOINTS | SCREE_PART_POSES, NULL);
  const scree_world_joint *j = &world->joints.all.items[index];
  const scree_frame space = SCREE_SPACE_FRAME;
  const scree_joint_side a = scree_joint_side_of(world, j->a, &space),
                         b = scree_joint_side_of(world, j->b, &space);
  *o = (scree_joint_observation){.a = j->a,
                                 .b = j->b == scree_none ? SCREE_SPACE : j->b,
                                 .state = (scree_joint_state)j->state,
                                 .mode = (scree_joint_mode)j->mode,
                                 .area = j->area,
                                 .load = j->load,
                                 .energy = j->energy,
                                 .fracture = j->spent.fracture,
                                 .broke_at = j->broke_at};
  vec3_store(o->position, scree_joint_strain_of(j, &a, &b).middle);
  vec3_store(o->force, j->force);
  vec3_store(o->moment, j->moment);
}
