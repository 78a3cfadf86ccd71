/* The processor's backend. */
#include "world/device/backend.h"
#include "world/state/remote.h"
#include "world/step/stages.h"

#include "base/parallel.h"

/* What a step takes less than this to do is done by one thread: to share out its loops, and to wait
 * for the last in each, costs about as much. */
static const double shared_from = 1e-4; /* s */
bool scree_share_all_steps;
enum { ASK_EVERY = 1024 }; /* steps, of which one is done alone to see what it takes */

/* The same bits for any number of threads: the clock may decide. A step that the system interrupted
 * must not, so that the estimate grows slowly. */
static scree_status one_step(scree_world *world, size_t most, size_t *done) {
  (void)most;
  *done = 1;
  double *took = &world->residence.alone_seconds, before = world->timings.total;
  const bool many = scree_worker_count() > 1,
             alone = many && !scree_share_all_steps &&
                     (world->step_count % ASK_EVERY == 0 || *took < shared_from);
  if (alone) scree_work_alone(true);
  scree_status status = scree_take_step(world);
  if (!alone) return status;
  scree_work_alone(false);
  const double now = world->timings.total - before;
  *took = world->step_count % ASK_EVERY == 1 ? now : scree_min(now, 1.1 * *took);
  return status;
}

/* The state is stepped where it is, but for one that was on a device. */
static scree_status begin(scree_world *world, int device, scree_error *error) {
  (void)device;
  return world->residence.on_device ? scree_world_change(world, SCREE_ALL_PARTS, error) : SCREE_OK;
}

const scree_backend scree_backend_cpu = {"cpu", begin, one_step};
