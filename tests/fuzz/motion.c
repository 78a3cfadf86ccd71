/* Motions of runs, every frame's checksum made to fit: refused, or poses of which each is a number
 * or not there. */
#define _GNU_SOURCE /* memfd_create */
#include "scene/motion.h"
#include "fuzz/files.h"
#include "fuzz/forge.h"

#include <math.h>
#include <string.h>

enum {
  HEADER = 16,
  FRAME_HEADER = 40,
  COUNT_AT = 16,
  SUM_AT = 24,
  BODY = 20,
  MOST_BYTES = 1 << 16
};

static void forge(uint8_t *bytes, size_t size) {
  for (size_t at = HEADER; size - at >= FRAME_HEADER;) {
    uint8_t *frame = bytes + at;
    uint64_t count = forge_get(frame + COUNT_AT);
    at += FRAME_HEADER;
    if (count > (size - at) / BODY) return;
    forge_sum(frame + SUM_AT, bytes + at, (size_t)count * BODY);
    at += (size_t)count * BODY;
  }
}

static void check_motion(const scree_motion *m) {
  double sum = 0;
  FUZZ_CHECK(m->frame_count > 0);
  for (size_t f = 0; f < m->frame_count; f++) {
    FUZZ_CHECK(isfinite(m->time[f]));
    for (size_t i = 0; i < 7 * m->body_count; i++)
      sum += (double)m->poses[7 * f * m->body_count + i];
  }
  volatile double read_all = sum;
  (void)read_all;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static uint8_t forged[MOST_BYTES];
  scree_motion motion = {0};
  scree_motion_file file;
  scree_error error = {0};
  size_t used = scree_memory_used();
  char path[64];
  if (size < HEADER || size > MOST_BYTES) return 0;
  memcpy(forged, data, size);
  forge(forged, size);
  int fd = fuzz_file(forged, size, path);
  scree_status status = scree_motion_read(path, &motion, &error);
  FUZZ_CHECK(status == SCREE_OK || (status == SCREE_BAD_FILE && error.message[0]));
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK) check_motion(&motion);
  scree_motion_free(&motion);
  /* a run that goes on keeps the frames up to where it stands, at 1 s */
  FUZZ_CHECK(scree_motion_open(&file, path, 0.5, true, 1, &error) == SCREE_OK);
  FUZZ_CHECK(file.last <= 1);
  scree_motion_close(&file);
  close(fd);
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
