/* The motion of a scene on disk (docs/reference/formats.md): frames are appended while it
 * goes on, each with its own checksum, so that one that was killed leaves whole ones. */
#pragma once

#include "base/error.h"

typedef struct scree_motion_file {
  FILE *stream; /* NULL: nothing is recorded */
  char *path;
  double interval; /* s, of simulated time */
  size_t count;    /* frames due so far */
  double last;     /* s, time of the last frame written */
} scree_motion_file;

/* Opens path for a scene that stands at `time`. Frames that an earlier piece of it wrote up to
 * then stay; where go_on is false, or they cannot be read, the file begins anew. */
scree_status scree_motion_open(scree_motion_file *file, const char *path, double interval,
                               bool go_on, double time, scree_error *error);
/* s: when the next frame is due; infinity where nothing is recorded. */
double scree_motion_next(const scree_motion_file *file);
/* Appends the world as it stands, its walls first, unless that is written already. */
scree_status scree_motion_put(scree_motion_file *file, const scree_world *world,
                              scree_error *error);
/* Does nothing for one that was never opened. */
void scree_motion_close(scree_motion_file *file);
