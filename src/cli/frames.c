#include "cli/frames.h"

#include "base/array.h"

#include <math.h>

void cli_frame_name(size_t index, const char *kind, char name[CLI_FRAME_NAME]) {
  snprintf(name, CLI_FRAME_NAME, "frame-%06zu%.32s.vtp", index, kind);
}

scree_status cli_frames_note(cli_frames *frames, double time, scree_error *error) {
  return SCREE_PUSH(frames, time) ? SCREE_OK : scree_fail_memory(error, 0, "the times of frames");
}

/* Times are summed up as a world does, for the same bits. */
scree_status cli_frames_recall(cli_frames *frames, double interval, const scree_world *world,
                               scree_error *error) {
  double now = scree_world_time(world), step = scree_world_time_step(world, NULL), next = 0;
  for (double time = 0; interval > 0 && time < now - 0.5 * step; time += step) {
    if (time < next) continue;
    SCREE_TRY(cli_frames_note(frames, time, error));
    next = (floor(time / interval) + 1) * interval;
  }
  return SCREE_OK;
}

scree_status cli_frames_list(const cli_frames *frames, const char *kind, const char *path,
                             scree_error *error) {
  typedef char frame_name[CLI_FRAME_NAME];
  size_t count = frames->count;
  if (count == 0) return SCREE_OK;
  SCREE_SCRATCH(const char *, files, count, error);
  SCREE_SCRATCH(frame_name, names, count, error);
  for (size_t i = 0; i < count; i++) {
    cli_frame_name(i, kind, names[i]);
    files[i] = names[i];
  }
  return scree_pvd_write(files, frames->items, count, path, true, error);
}
