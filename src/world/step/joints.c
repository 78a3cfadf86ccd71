/* Joints in the step: each is evaluated by itself and keeps its wrench, and each body sums those of
 * its joints in their order, so that the result does not depend on the threads. */
#include "world/step/joint_law.h"
#include "world/step/stages.h"

#include "base/parallel.h"

enum { JOINT_BLOCK = 64 };

static void evaluate_block(void *context, scree_block block) {
  scree_world *world = context;
  const bool *removed = world->bodies.removed;
  for (size_t k = block.begin; k < block.end; k++) {
    scree_world_joint *j = &world->joints->all.items[k];
    if (j->silent) continue;
    if (!(j->area > 0) || j->state > SCREE_JOINT_CRACKED) {
      j->wrench = (scree_pair_wrench){{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
      j->silent = true;
      continue;
    }
    const scree_joint_side a = scree_joint_side_of(world, j->a),
                           b = scree_joint_side_of(world, j->b);
    bool gone = removed[j->a] || (j->b != scree_none && removed[j->b]);
    if (gone) {
      j->state = SCREE_JOINT_GONE;
      j->energy = 0;
      j->wrench = (scree_pair_wrench){{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    }
    if (gone || scree_joint_evaluate(j, &a, &b, world->time_step, world->time))
      atomic_store_explicit(&world->joints->changed, true, memory_order_relaxed);
  }
}

void scree_joints_evaluate(scree_world *world) {
  scree_joints *joints = world->joints;
  if (!joints) return;
  scree_parallel_for(joints->all.count, JOINT_BLOCK, evaluate_block, world);
  if (!atomic_load(&joints->changed)) return;
  atomic_store(&joints->changed, false);
  scree_joints_find_fragments(joints);
  world->pairs_stale = true; /* who was held may touch */
}

void scree_world_observe_joint(const scree_world *world, size_t index, scree_joint_observation *o) {
  const scree_world_joint *j = &world->joints->all.items[index];
  const scree_joint_side a = scree_joint_side_of(world, j->a), b = scree_joint_side_of(world, j->b);
  *o = (scree_joint_observation){.a = j->a,
                                 .b = j->b == scree_none ? SCREE_SPACE : j->b,
                                 .state = (scree_joint_state)j->state,
                                 .mode = (scree_joint_mode)j->mode,
                                 .area = j->area,
                                 .load = j->load,
                                 .energy = j->energy,
                                 .fracture = j->fracture,
                                 .broke_at = j->broke_at};
  vec3_store(o->position, scree_joint_strain_of(j, &a, &b).middle);
  vec3_store(o->force, j->force);
  vec3_store(o->moment, j->moment);
}
