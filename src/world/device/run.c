/* Steps, on the backend that was chosen. */
#include "world/device/backend.h"
#include "world/state/joints.h"
#include "world/state/remote.h"
#include "world/step/checkpoint.h"
#include "world/step/stages.h"

#include "base/error.h"

static scree_status check_time_step(scree_world *world, scree_error *error) {
  if (!world->time_step_stale) return SCREE_OK;
  SCREE_TRY(scree_joints_prepare(world, error));
  SCREE_TRY(scree_world_bring(world, SCREE_PART_WALLS, error));
  world->time_step = scree_world_choose_time_step(world, NULL);
  world->time_step_stale = false;
  if (!(world->options.time_step > 0)) return SCREE_OK;
  scree_world_options automatic = world->options;
  world->options.time_step = 0;
  double coarsest =
      scree_world_choose_time_step(world, NULL) * world->options.steps_per_contact / 15;
  world->options = automatic;
  if (world->bodies.count == world->bodies.removed_count ||
      world->time_step <= coarsest * (1 + 1e-12))
    return SCREE_OK;
  world->time_step_stale = true;
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "world: a time step of %.4g s is too long for these bodies: at most %.4g s "
                    "(15 per contact)",
                    world->time_step, coarsest);
}

scree_status scree_world_step(scree_world *world, size_t step_count, scree_error *error) {
  if (world->diverged) {
    if (error) *error = world->failure;
    return world->failure.status;
  }
  const scree_backend *backend = scree_backend_of(world);
  scree_status status = check_time_step(world, error);
  if (!status) status = backend->begin(world, scree_backend_device_of(world), error);
  if (status) return status;
  for (size_t k = 0, done = 0; k < step_count; k += done) {
    size_t to_keep = scree_world_steps_to_keep(world);
    if (to_keep == 0) {
      status = scree_world_keep_state(world, error);
      if (status) return status;
      to_keep = scree_world_steps_to_keep(world);
    }
    status = backend->step(world, to_keep < step_count - k ? to_keep : step_count - k, &done);
    if (status == SCREE_OK) continue;
    world->diverged = true;
    scree_world_write_kept(world);
    if (error) *error = world->failure;
    return status;
  }
  return SCREE_OK;
}
