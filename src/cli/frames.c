#include "cli/frames.h"

#include <math.h>
#include <stdlib.h>

static scree_status no_memory(scree_error *error) {
  *error = (scree_error){SCREE_OUT_OF_MEMORY, "out of memory"};
  return error->status;
}

void cli_frame_name(size_t index, const char *kind, char name[CLI_FRAME_NAME]) {
  snprintf(name, CLI_FRAME_NAME, "frame-%06zu%.32s.vtp", index, kind);
}

scree_status cli_frames_note(cli_frames *frames, double time, scree_error *error) {
  if (frames->count == frames->capacity) {
    size_t capacity = 2 * frames->capacity + 64;
    double *times = realloc(frames->times, capacity * sizeof *times);
    if (!times) return no_memory(error);
    frames->times = times;
    frames->capacity = capacity;
  }
  frames->times[frames->count++] = time;
  return SCREE_OK;
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
  size_t count = frames->count;
  if (count == 0) return SCREE_OK;
  const char **files = malloc(count * sizeof *files);
  char(*names)[CLI_FRAME_NAME] = malloc(count * sizeof *names);
  bool room = files && names;
  for (size_t i = 0; room && i < count; i++) {
    cli_frame_name(i, kind, names[i]);
    files[i] = names[i];
  }
  scree_status status =
      room ? scree_pvd_write(files, frames->times, count, path, true, error) : no_memory(error);
  free(files);
  free(names);
  return status;
}
