/* Frames of a scene's motion. A body takes 20 bytes: its position as three floats, and its
 * quaternion as four integers, 1 being 32767, which is within 2e-5 rad. */
#include "scene/motion.h"

#include "base/alloc.h"
#include "base/codec.h"
#include "base/file.h"
#include "base/platform.h"

#include <errno.h>
#include <math.h>
#include <string.h>

static const char magic[] = "screeMOV";
static const double one = 32767; /* of a quaternion's component */
enum { VERSION = 1, BYTE_ORDER_MARK = 0x01020304, HEADER = 16, FRAME_HEADER = 40, BODY_BYTES = 20 };
enum { LARGEST_GROWTH = 64 }; /* of the bytes of a file when read: no damaged one asks for more */

typedef struct frame_header {
  double time, reserved; /* 0 */
  uint64_t body_count;
  scree_checksum sum; /* of the bodies */
} frame_header;

static void code_frame(scree_codec *c, frame_header *f) {
  scree_code_real(c, &f->time);
  scree_code_real(c, &f->reserved);
  scree_code_u64(c, &f->body_count);
  scree_code_u64(c, &f->sum.high);
  scree_code_u64(c, &f->sum.low);
}

static void code_header(scree_codec *c, char name[8], uint32_t version_order[2]) {
  scree_code_bytes(c, name, 8);
  for (int i = 0; i < 2; i++) scree_code_u32(c, &version_order[i]);
}

/* position, quaternion; NaN first where the body is not there */
static void code_pose(scree_codec *c, float pose[7]) {
  for (int k = 0; k < 3; k++) {
    uint32_t bits;
    memcpy(&bits, &pose[k], sizeof bits);
    scree_code_u32(c, &bits);
    memcpy(&pose[k], &bits, sizeof bits);
  }
  for (int k = 3; k < 7; k += 2) {
    uint32_t low = (uint16_t)(int16_t)lrint(one * pose[k]),
             high = (uint16_t)(int16_t)lrint(one * pose[k + 1]), pair = low | high << 16;
    scree_code_u32(c, &pair);
    pose[k] = (float)((int16_t)(pair & 0xffff) / one);
    pose[k + 1] = (float)((int16_t)(pair >> 16) / one);
  }
}

/* ---- walking over the frames of a file ---- */

typedef struct walk {
  scree_codec codec;
  frame_header frame;
  const unsigned char *bodies;
} walk;

/* Whether the bytes begin as such a file, of this version. */
static bool walk_start(walk *w, const char *bytes, size_t count) {
  char name[8] = "";
  uint32_t version_order[2] = {0};
  *w = (walk){.codec = {.source = (const unsigned char *)bytes, .count = count, .loading = true}};
  code_header(&w->codec, name, version_order);
  return !w->codec.failed && !memcmp(name, magic, sizeof name) && version_order[0] == VERSION &&
         version_order[1] == BYTE_ORDER_MARK;
}

/* The next whole frame; false at the end, or where the rest was not written to its end. */
static bool walk_next(walk *w) {
  scree_codec *c = &w->codec;
  if (c->count - c->position < FRAME_HEADER) return false;
  code_frame(c, &w->frame);
  size_t left = c->count - c->position;
  if (!isfinite(w->frame.time) || w->frame.body_count > left / BODY_BYTES) return false;
  size_t size = (size_t)w->frame.body_count * BODY_BYTES;
  w->bodies = c->source + c->position;
  scree_checksum sum = scree_checksum_of(w->bodies, size);
  if (sum.high != w->frame.sum.high || sum.low != w->frame.sum.low) return false;
  c->position += size;
  return true;
}

/* ---- writing ---- */

static scree_status fail_write(const scree_motion_file *file, scree_error *error) {
  return scree_fail(error, SCREE_IO, "%s: cannot write: %s", file->path, strerror(errno));
}

static scree_status write_bytes(const scree_motion_file *file, const scree_codec *c,
                                scree_error *error) {
  if (!scree_codec_good(c)) return scree_fail_memory(error, c->count, "a motion");
  if (fwrite(c->bytes, 1, c->count, file->stream) != c->count || fflush(file->stream) != 0)
    return fail_write(file, error);
  return SCREE_OK;
}

/* Cuts off what comes after `time`, and a last moment that was none of the interval's: where it
 * was stopped. Without a stream where nothing can be kept. */
static scree_status keep_frames(scree_motion_file *file, double time, scree_error *error) {
  char *bytes;
  size_t count, end = 0, due = 0;
  walk w;
  scree_error unread;
  scree_status status = scree_file_read(file->path, 0, &bytes, &count, &unread);
  if (status == SCREE_OUT_OF_MEMORY) *error = unread;
  if (status != SCREE_OK) return status == SCREE_OUT_OF_MEMORY ? status : SCREE_OK;
  if (walk_start(&w, bytes, count)) {
    end = HEADER;
    while (walk_next(&w) && w.frame.time <= time) {
      if (w.frame.time < (double)due * file->interval) continue;
      while (w.frame.time >= (double)due * file->interval) due++;
      end = w.codec.position;
      file->last = w.frame.time;
    }
  }
  scree_free(bytes);
  if (!end || !(file->stream = scree_open_stream(file->path, "r+b"))) return SCREE_OK;
  if (scree_cut(file->stream, end)) return SCREE_OK;
  fclose(file->stream);
  file->stream = NULL;
  return SCREE_OK;
}

static scree_status begin(scree_motion_file *file, scree_error *error) {
  SCREE_CLEANUP(scree_codec_free) scree_codec c = {0};
  char name[8];
  uint32_t version_order[2] = {VERSION, BYTE_ORDER_MARK};
  file->last = -INFINITY;
  file->stream = scree_open_stream(file->path, "wb");
  if (!file->stream) return fail_write(file, error);
  memcpy(name, magic, sizeof name);
  code_header(&c, name, version_order);
  return write_bytes(file, &c, error);
}

scree_status scree_motion_open(scree_motion_file *file, const char *path, double interval,
                               bool go_on, double time, scree_error *error) {
  *file = (scree_motion_file){.interval = interval, .last = -INFINITY, .path = scree_strdup(path)};
  if (!file->path) return scree_fail_memory(error, strlen(path), "a path");
  scree_status status = go_on ? keep_frames(file, time, error) : SCREE_OK;
  if (status == SCREE_OK && file->stream) {
    while (file->last >= scree_motion_next(file)) file->count++; /* one due now is not there yet */
    return SCREE_OK;
  }
  if (status == SCREE_OK) status = begin(file, error);
  if (status != SCREE_OK) scree_motion_close(file);
  return status;
}

double scree_motion_next(const scree_motion_file *file) {
  return file->stream ? (double)file->count * file->interval : INFINITY;
}

static void code_walls(scree_codec *c, const scree_world *world) {
  for (size_t w = 0; w < scree_world_wall_count(world); w++) {
    scree_wall wall;
    double turn[4];
    float pose[7];
    scree_world_get_wall(world, w, &wall);
    scree_world_wall_orientation(world, w, turn);
    for (int k = 0; k < 7; k++) pose[k] = (float)(k < 3 ? wall.position[k] : turn[k - 3]);
    code_pose(c, pose);
  }
}

static void code_bodies(scree_codec *c, const scree_world *world, size_t count) {
  for (size_t i = 0; i < count; i++) {
    scree_body body;
    float pose[7] = {NAN, NAN, NAN, 0, 0, 0, 0};
    scree_world_get_body(world, i, &body);
    for (int k = 0; k < 7 && !scree_world_body_removed(world, i); k++)
      pose[k] = (float)(k < 3 ? body.position[k] : body.orientation[k - 3]);
    code_pose(c, pose);
  }
}

scree_status scree_motion_put(scree_motion_file *file, const scree_world *world,
                              scree_error *error) {
  frame_header f = {.time = scree_world_time(world), .body_count = scree_world_body_count(world)};
  while (f.time >= scree_motion_next(file)) file->count++;
  if (!file->stream || f.time <= file->last) return SCREE_OK;
  SCREE_CLEANUP(scree_codec_free) scree_codec bodies = {0};
  SCREE_CLEANUP(scree_codec_free) scree_codec frame = {0};
  code_walls(&bodies, world);
  code_bodies(&bodies, world, (size_t)f.body_count);
  f.body_count += scree_world_wall_count(world);
  f.sum = scree_checksum_of(bodies.bytes, bodies.count);
  code_frame(&frame, &f);
  scree_code_bytes(&frame, bodies.bytes, bodies.count);
  frame.out_of_memory = frame.out_of_memory || bodies.out_of_memory;
  file->last = f.time;
  return write_bytes(file, &frame, error);
}

void scree_motion_close(scree_motion_file *file) {
  if (file->stream) fclose(file->stream); /* every frame was flushed */
  scree_free(file->path);
  *file = (scree_motion_file){0};
}

/* ---- reading ---- */

void scree_motion_free(scree_motion *motion) {
  scree_free(motion->time);
  scree_free(motion->poses);
  *motion = (scree_motion){0};
}

/* Bodies only ever come in: those of the last frame are all. */
static scree_status fill(const char *name, const char *bytes, size_t count, scree_motion *m,
                         scree_error *error) {
  walk w;
  walk_start(&w, bytes, count);
  while (walk_next(&w)) {
    m->frame_count++;
    if (w.frame.body_count > m->body_count) m->body_count = (size_t)w.frame.body_count;
  }
  size_t frames = m->frame_count, bodies = m->body_count;
  if (frames > LARGEST_GROWTH * count / (bodies * 7 * sizeof *m->poses + 1))
    return scree_fail(error, SCREE_BAD_FILE, "%s: frames of very different numbers of bodies",
                      name);
  SCREE_TRY_ALLOC(m->time, frames, error);
  SCREE_TRY_ALLOC(m->poses, frames * bodies * 7, error);
  walk_start(&w, bytes, count);
  for (size_t f = 0; f < frames && walk_next(&w); f++) {
    scree_codec c = {
        .source = w.bodies, .count = (size_t)w.frame.body_count * BODY_BYTES, .loading = true};
    m->time[f] = w.frame.time;
    for (size_t b = 0; b < bodies; b++) {
      float *pose = m->poses + 7 * (f * bodies + b);
      for (int k = 0; k < 7; k++) pose[k] = b < w.frame.body_count ? 0 : NAN;
      if (b < w.frame.body_count) code_pose(&c, pose);
    }
  }
  return SCREE_OK;
}

scree_status scree_motion_read(const char *path, scree_motion *motion, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  SCREE_CLEANUP(scree_motion_free) scree_motion made = {0};
  size_t count;
  walk w;
  SCREE_TRY(scree_file_read(path, 0, &bytes, &count, error));
  if (!walk_start(&w, bytes, count) || !walk_next(&w))
    return scree_fail(error, SCREE_BAD_FILE, "%s: is no motion of a run that this scree reads",
                      path);
  SCREE_TRY(fill(path, bytes, count, &made, error));
  *motion = made;
  made = (scree_motion){0};
  return SCREE_OK;
}
