/* Workers as threads of this process: on a device their worlds share launches, which those of
 * several processes cannot. */
#include "base/alloc.h"
#include "base/parallel.h"
#include "cli/study.h"
#include "cli/terminal.h"

typedef struct lane {
  const study_crew *crew;
  scree_status status;
  scree_error error;
} lane;

/* Shows how far one of all lanes' runs is. */
static bool look(void *context, const char *phase, double fraction) {
  const lane *l = context;
  scree_enter_alone();
  const scree_progress *p = l->crew->call->progress;
  bool going = p->report(p->context, phase, fraction);
  scree_leave_alone();
  return going;
}

static bool look_away(void *context, const char *phase, double fraction) {
  (void)context, (void)phase, (void)fraction;
  return !cli_interrupted();
}

static void work_in_lane(void *context, scree_block block) {
  lane *l = (lane *)context + block.begin;
  const cli_call *call = l->crew->call;
  const scree_progress progress = {block.begin == 0 ? look : look_away, l,
                                   call->progress->interval};
  scree_study_options options = study_work_options(call->options);
  l->status = l->crew->work(call, l->crew->folder, &options, &progress, &l->error);
}

/* A lane whose run finds no room on the device leaves it to the others: whether there were any. */
static bool all_crowded(const lane *lanes, size_t count) {
  size_t crowded = 0;
  for (size_t i = 0; i < count; i++) crowded += lanes[i].status == SCREE_OUT_OF_MEMORY;
  return crowded == count;
}

static scree_status conclude(const lane *lanes, size_t count) {
  const bool alone = all_crowded(lanes, count);
  for (size_t i = 0; i < count; i++)
    if (lanes[i].status && (alone || lanes[i].status != SCREE_OUT_OF_MEMORY))
      return cli_fail(&lanes[i].error);
  return SCREE_OK;
}

/* Lanes that leave no room to each other are too many. */
scree_status study_run_lanes(const study_crew *crew) {
  size_t count = crew->jobs;
  scree_error error;
  SCREE_CLEANUP(scree_free_at) lane *lanes = scree_alloc_zero(count, sizeof *lanes);
  if (!lanes) {
    scree_tell_memory(&error, count * sizeof *lanes, "workers", NULL);
    return cli_fail(&error);
  }
  for (bool again = true; again; count = again ? count / 2 : count) {
    for (size_t i = 0; i < count; i++) lanes[i] = (lane){.crew = crew};
    scree_set_threads((int)count);
    scree_parallel_for(count, 1, work_in_lane, lanes);
    again = count > 1 && all_crowded(lanes, count);
  }
  return conclude(lanes, count);
}
