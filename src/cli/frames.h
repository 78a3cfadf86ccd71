/* The frames that a verb writes for ParaView into its folder, and when each was. */
#pragma once

#include "base/error.h"

typedef struct cli_frames {
  double *items; /* the times, s; free them with scree_free */
  size_t count, capacity;
} cli_frames;

enum { CLI_FRAME_NAME = 64 };

/* "frame-000012-bodies.vtp", of kind "-bodies". */
void cli_frame_name(size_t index, const char *kind, char name[CLI_FRAME_NAME]);
/* One more, of this moment. */
scree_status cli_frames_note(cli_frames *frames, double time, scree_error *error);
/* Those that an earlier piece wrote, one on the first step at or past every interval (s; 0: none),
 * before where the world is now. */
scree_status cli_frames_recall(cli_frames *frames, double interval, const scree_world *world,
                               scree_error *error);
/* The collection of those of a kind, where there are any; it may replace an earlier one. */
scree_status cli_frames_list(const cli_frames *frames, const char *kind, const char *path,
                             scree_error *error);
