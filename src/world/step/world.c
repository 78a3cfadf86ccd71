/* Making worlds and what is in them. */
#include "world/broad/broad.h"
#include "world/broad/spheres.h"
#include "world/state/joints.h"
#include "world/state/pairs.h"
#include "world/state/remote.h"
#include "world/state/scratch.h"

#include "base/alloc.h"

#include <string.h>

scree_world_options scree_default_world_options(void) {
  return (scree_world_options){
      .gravity = {0, 0, -9.81},
      .law = SCREE_LAW_LINEAR,
      .steps_per_contact = 20,
      .stiffness_factor = 1,
      .tangential_ratio = 1,
      .smoothing = 4e-5,
      .sharing = 0.1,
      .overlap_limit = 0.1,
      .skin = 0.02,
      .floor_height = -INFINITY,
  };
}

static scree_status check_range(const char *name, double value, double low, double high,
                                scree_error *error) {
  if (value >= low && value <= high) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT, "world: %s is %g; from %g to %g", name, value, low,
                    high);
}

/* Periods need what is to be repeated. */
static scree_status check_periods(const scree_world_options *o, scree_error *error) {
  for (int k = 0; k < 3; k++)
    if (!(o->period[k] >= 0 && o->period[k] <= 1e9 && isfinite(o->period_from[k])))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "world: period %g m from %g m along %c; 0 (none) to 1e9 m", o->period[k],
                        o->period_from[k], "xyz"[k]);
  return SCREE_OK;
}

static scree_status check_options(const scree_world_options *o, scree_error *error) {
  const struct {
    const char *name;
    double value, low, high;
  } ranges[] = {
      {"gravity x", o->gravity[0], -1e6, 1e6},
      {"gravity y", o->gravity[1], -1e6, 1e6},
      {"gravity z", o->gravity[2], -1e6, 1e6},
      {"steps_per_contact", o->steps_per_contact, 15, 1e6},
      {"time_step", o->time_step, 0, 1},
      {"stiffness_factor", o->stiffness_factor, 1e-9, 1e9},
      {"tangential_ratio", o->tangential_ratio, 1e-6, 1},
      {"size", o->size, 0, 1e6},
      {"smoothing", o->smoothing, 1e-9, 1e-2},
      {"sharing", o->sharing, 0, 0.5},
      {"overlap_limit", o->overlap_limit, 1e-6, 0.5},
      {"skin", o->skin, 1e-4, 1},
      {"floor_height", o->floor_height, -INFINITY, INFINITY},
  };
  for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
    SCREE_TRY(check_range(ranges[i].name, ranges[i].value, ranges[i].low, ranges[i].high, error));
  if (!(o->law < SCREE_LAW_COUNT))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: law number %d is none", (int)o->law);
  if (!(o->rolling <= SCREE_ROLLING_EPSD))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: rolling number %d is none",
                      (int)o->rolling);
  return check_periods(o, error);
}

scree_status scree_world_create(const scree_world_options *options, scree_world **world,
                                scree_error *error) {
  scree_world_options o = options ? *options : scree_default_world_options();
  SCREE_TRY(check_options(&o, error));
  scree_world *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "a world");
  made->options = o;
  made->list.stale = true;
  made->time_step_stale = true;
  *world = made;
  return SCREE_OK;
}

void scree_world_free(scree_world *world) {
  if (!world) return;
  if (world->residence.on_device) world->residence.remote->release(world);
  scree_bodies_free(world);
  for (size_t i = 0; i < world->walls.count; i++)
    scree_particle_free(world->walls.items[i].surface);
  scree_free(world->walls.items);
  scree_joints_free(&world->joints);
  scree_free(world->list.wall_pairs.items);
  scree_free(world->motions.items);
  scree_free(world->motion_rows.items);
  scree_free(world->list.neighbours.items);
  scree_free(world->list.pair_of.items);
  scree_free(world->pairs.items);
  scree_free(world->spare_pairs.items);
  scree_pools_free(&world->pools);
  scree_free(world->list.slots.items);
  scree_free(world->list.wake_threshold.items);
  scree_free(world->list.touching.items);
  scree_free(world->list.keys.items);
  scree_free(world->list.sides.items);
  scree_free(world->list.acting.items);
  scree_free(world->list.ledger.items);
  scree_free(world->workspace.awake.items);
  scree_free(world->workspace.progress.items);
  for (int i = 0; i < world->workspace.scratch_count; i++)
    scree_free(world->workspace.scratch[i].contacts.items);
  scree_free(world->workspace.scratch);
  scree_spheres_free(world);
  scree_broad_free(world);
  scree_free(world->kept.path);
  scree_free(world->kept.bytes);
  scree_free(world);
}

void scree_world_get_options(const scree_world *world, scree_world_options *options) {
  *options = world->options;
}

double scree_world_time(const scree_world *world) {
  return world->time;
}

uint64_t scree_world_step_count(const scree_world *world) {
  return world->step_count;
}

void scree_world_timings(const scree_world *world, scree_timings *timings) {
  *timings = world->timings;
  for (int i = 0; i < world->workspace.scratch_count; i++) {
    const scree_scratch *s = &world->workspace.scratch[i];
    timings->feature_evaluations += s->counters.feature_evaluations;
    timings->closest_queries += s->counters.closest_queries;
    timings->list_builds += s->counters.list_builds;
    timings->candidates += s->counters.candidate_seconds;
  }
}
