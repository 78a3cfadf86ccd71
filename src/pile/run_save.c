/* Checkpoints and frames of a run. One format: a seal (base/seal.h), the experiment as its own
 * YAML, the shapes (as a packed world with one body of each: the gallery), the world, where the run
 * stands, and the series. A frame's world is made anew with the bodies alone, without what contacts
 * remember; what follows from contacts is kept as numbers. The plan of filling follows from
 * experiment and shapes, and is made again. */
#include "pile/run.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/platform.h"
#include "base/seal.h"

#include <stdlib.h>
#include <string.h>

static const scree_seal seal = {"screeRUN", "checkpoint or frame of a scree run", "run", 1};
enum { POINT_BYTES = 92 };

/* ---- field lists ---- */

static void code_point(scree_codec *c, scree_run_point *p) {
  uint32_t phase = (uint32_t)p->phase;
  uint64_t bodies = p->body_count;
  scree_code_u32(c, &phase);
  if (phase > SCREE_PHASE_DONE) c->failed = true;
  p->phase = (scree_phase)phase;
  scree_code_u64(c, &bodies);
  p->body_count = (size_t)bodies;
  double *reals[] = {&p->time,
                     &p->kinetic,
                     &p->mean_rotation,
                     &p->highest_speed,
                     &p->largest_overlap,
                     &p->coordination,
                     &p->cylinder_height,
                     &p->sector_deg,
                     &p->cone_deg,
                     &p->silhouette_deg,
                     &p->height};
  for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) scree_code_real(c, reals[i]);
}

static void code_state(scree_codec *c, scree_run *run) {
  uint32_t phase = (uint32_t)run->phase;
  uint64_t counts[4] = {run->entered_count, run->layer_count, run->particle_steps,
                        run->piece_count};
  scree_code_u32(c, &phase);
  if (phase > SCREE_PHASE_DONE) c->failed = true;
  run->phase = (scree_phase)phase;
  for (int i = 0; i < 4; i++) scree_code_u64(c, &counts[i]);
  run->entered_count = (size_t)counts[0];
  run->layer_count = (size_t)counts[1];
  run->particle_steps = counts[2];
  run->piece_count = (size_t)counts[3];
  double *reals[] = {&run->phase_start,       &run->still_since, &run->wall_seconds,
                     &run->processor_seconds, &run->frame_time,  &run->frame_coordination,
                     &run->frame_kinetic};
  for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) scree_code_real(c, reals[i]);
  scree_code_bool(c, &run->is_frame);
}

/* ---- saving ---- */

static void save_block(scree_codec *c, void *bytes, size_t count) {
  size_t length = count;
  scree_code_count(c, &length, 1);
  scree_code_bytes(c, bytes, count);
}

static scree_status save_experiment(scree_codec *c, const scree_run *run, scree_error *error) {
  char *text = NULL;
  size_t length = 0;
  FILE *stream = scree_memory_open(&text, &length);
  if (!stream) return scree_fail_memory(error, 0, "an experiment's text");
  scree_experiment_print(&run->experiment, stream);
  bool good = scree_memory_close(stream);
  if (good) save_block(c, text, length);
  free(text);
  return good ? SCREE_OK : scree_fail_memory(error, 0, "an experiment's text");
}

/* A world with the same bodies and walls, and no contacts. */
static scree_status strip_world(const scree_run *run, scree_world **world, scree_error *error) {
  scree_status status = scree_run_make_world(run, scree_run_cylinder_height(run),
                                             scree_world_time_step(run->world, NULL), world, error);
  for (size_t i = 0; status == SCREE_OK && i < run->entered_count; i++) {
    scree_body body;
    size_t index;
    scree_world_get_body(run->world, i, &body);
    status = scree_world_add_body(*world, scree_world_body_particle(run->world, i),
                                  scree_world_body_material(run->world, i), &body, &index, error);
    if (status == SCREE_OK && scree_world_body_removed(run->world, i))
      scree_world_remove_body(*world, i);
    if (status != SCREE_OK) scree_world_free(*world);
  }
  if (status == SCREE_OK) (*world)->time = run->world->time; /* what is drawn of it says so */
  return status;
}

static scree_status save_shapes(scree_codec *c, const scree_run *run, scree_error *error) {
  size_t count = run->shape_count;
  scree_code_count(c, &count, 24);
  for (size_t i = 0; i < count; i++) {
    double factor = run->shapes[i].density_factor;
    scree_code_real(c, &factor);
    for (size_t k = 2 * i; k < 2 * i + 2; k++) save_block(c, run->names[k], strlen(run->names[k]));
  }
  return scree_world_save_block(c, run->gallery, error);
}

static scree_status save_rest(scree_codec *c, const scree_run *run, bool as_frame,
                              scree_error *error) {
  scree_world *world = run->world;
  scree_status status = as_frame ? strip_world(run, &world, error) : SCREE_OK;
  if (status != SCREE_OK) return status;
  status = scree_world_save_block(c, world, error);
  if (as_frame) scree_world_free(world);
  if (status != SCREE_OK) return status;
  scree_run_point now = scree_run_point_now(run);
  scree_run state = *run; /* a shallow copy: only its plain fields are written */
  state.is_frame = as_frame;
  state.frame_time = now.time;
  state.frame_coordination = now.coordination;
  state.frame_kinetic = now.kinetic;
  code_state(c, &state);
  size_t count = run->series.count;
  scree_code_count(c, &count, POINT_BYTES);
  for (size_t i = 0; i < count; i++) code_point(c, &run->series.items[i]);
  return SCREE_OK;
}

static scree_status pack(const scree_run *run, bool as_frame, scree_codec *c, scree_error *error) {
  scree_seal_begin(c);
  scree_status status = save_experiment(c, run, error);
  if (status == SCREE_OK) status = save_shapes(c, run, error);
  if (status == SCREE_OK) status = save_rest(c, run, as_frame, error);
  return status == SCREE_OK ? scree_seal_end(c, &seal, error) : status;
}

static scree_status save(const scree_run *run, bool as_frame, const char *path, bool overwrite,
                         scree_error *error) {
  scree_codec c = {0};
  scree_status status = pack(run, as_frame, &c, error);
  if (status == SCREE_OK) status = scree_seal_write(c.bytes, c.count, path, overwrite, error);
  scree_free(c.bytes);
  return status;
}

scree_status scree_run_pack(const void *run, unsigned char **bytes, size_t *byte_count,
                            scree_error *error) {
  scree_codec c = {0};
  scree_status status = pack(run, false, &c, error);
  if (status != SCREE_OK) {
    scree_free(c.bytes);
    return status;
  }
  *bytes = c.bytes;
  *byte_count = c.count;
  return SCREE_OK;
}

scree_status scree_run_save(const scree_run *run, const char *path, bool overwrite,
                            scree_error *error) {
  if (run->is_frame)
    return scree_fail(error, SCREE_UNSUPPORTED, "%s: a frame cannot become a checkpoint", path);
  return save(run, false, path, overwrite, error);
}

scree_status scree_run_save_frame(const scree_run *run, const char *path, bool overwrite,
                                  scree_error *error) {
  return save(run, true, path, overwrite, error);
}

/* ---- loading ---- */

enum { MOST_SHAPES = 60 };

typedef struct loader {
  scree_codec codec;
  const char *name;
  scree_error *error;
  scree_experiment experiment;
  scree_run_shape shapes[MOST_SHAPES];
  char *names[2 * MOST_SHAPES];
  size_t shape_count;
  scree_world *gallery, *world;
  scree_run *run;
} loader;

/* The bytes of a block, in place; NULL where they run out. */
static const unsigned char *load_block(loader *l, size_t *count) {
  scree_code_count(&l->codec, count, 1);
  if (!scree_codec_good(&l->codec)) return NULL;
  const unsigned char *bytes = l->codec.source + l->codec.position;
  l->codec.position += *count;
  return bytes;
}

static scree_status fail_here(const loader *l) {
  return scree_seal_refuse(&l->codec, &seal, l->name, l->error);
}

static scree_status load_experiment(loader *l) {
  size_t count;
  scree_status status = scree_experiment_preset("paper", &l->experiment, l->error);
  const unsigned char *text = load_block(l, &count);
  if (status != SCREE_OK) return status;
  if (!text) return fail_here(l);
  return scree_experiment_parse((const char *)text, count, l->name, &l->experiment, l->error);
}

/* A block as a string; NULL where it cannot be had. */
static char *load_text(loader *l) {
  size_t length;
  const unsigned char *text = load_block(l, &length);
  char *copy = text ? scree_alloc(length + 1, 1) : NULL;
  if (text && !copy) l->codec.out_of_memory = true;
  if (!copy) return NULL;
  memcpy(copy, text, length);
  copy[length] = 0;
  return copy;
}

static scree_status load_shapes(loader *l) {
  scree_code_count(&l->codec, &l->shape_count, 24);
  if (!scree_codec_good(&l->codec) || l->shape_count > MOST_SHAPES) {
    l->shape_count = 0;
    return fail_here(l);
  }
  for (size_t i = 0; i < l->shape_count; i++) {
    scree_code_real(&l->codec, &l->shapes[i].density_factor);
    l->shapes[i].name = l->names[2 * i] = load_text(l);
    l->shapes[i].source = l->names[2 * i + 1] = load_text(l);
    if (!l->names[2 * i] || !l->names[2 * i + 1]) return fail_here(l);
  }
  scree_status status = scree_world_load_block(&l->codec, l->name, &l->gallery, l->error);
  if (status != SCREE_OK) return status;
  if (scree_world_body_count(l->gallery) != l->shape_count) return fail_here(l);
  for (size_t i = 0; i < l->shape_count; i++)
    l->shapes[i].particle = scree_world_body_particle(l->gallery, i);
  return SCREE_OK;
}

/* Shapes that are in the world are taken from there, so that a shape stays one particle however
 * often a run is loaded. The order follows from the seed. */
static scree_status adopt_particles(loader *l) {
  size_t bodies = scree_world_body_count(l->world), count = l->experiment.particle_count;
  if (l->shape_count < 1 || bodies > count || scree_world_wall_count(l->world) != 2)
    return fail_here(l);
  uint32_t *order = scree_alloc(count, sizeof *order);
  if (!order) return scree_fail_memory(l->error, count * sizeof *order, "an order");
  scree_fill_order(l->experiment.seed, l->shape_count, order, count);
  for (size_t i = 0; i < bodies; i++)
    l->shapes[order[i]].particle = scree_world_body_particle(l->world, i);
  scree_free(order);
  return SCREE_OK;
}

static scree_status load_state(loader *l) {
  scree_run *run = l->run;
  size_t count = 0;
  code_state(&l->codec, run);
  scree_code_count(&l->codec, &count, POINT_BYTES);
  if (scree_codec_good(&l->codec) && !SCREE_RESERVE(&run->series, count))
    l->codec.out_of_memory = true;
  for (size_t i = 0; scree_codec_good(&l->codec) && i < count; i++) {
    scree_run_point *point = &run->series.items[run->series.count++];
    *point = (scree_run_point){0};
    code_point(&l->codec, point);
  }
  if (l->codec.position != l->codec.count ||
      run->entered_count != scree_world_body_count(run->world))
    l->codec.failed = true;
  return scree_codec_good(&l->codec) ? SCREE_OK : fail_here(l);
}

static scree_status load(loader *l) {
  scree_status status = load_experiment(l);
  if (status == SCREE_OK) status = load_shapes(l);
  if (status == SCREE_OK) status = scree_world_load_block(&l->codec, l->name, &l->world, l->error);
  if (status == SCREE_OK) status = adopt_particles(l);
  if (status == SCREE_OK)
    status = scree_run_plan(&l->experiment, l->shapes, l->shape_count, &l->run, l->error);
  if (status != SCREE_OK) return status;
  l->run->world = l->world;
  l->world = NULL;
  return load_state(l);
}

scree_status scree_run_load(const char *path, scree_run **run, scree_error *error) {
  char *bytes;
  loader l = {.error = error};
  scree_status status = scree_seal_read(path, &seal, &bytes, &l.codec, &l.name, error);
  if (status != SCREE_OK) return status;
  status = load(&l);
  for (size_t i = 0; i < 2 * l.shape_count; i++) scree_free(l.names[i]);
  scree_world_free(l.world);
  scree_world_free(l.gallery);
  scree_experiment_free(&l.experiment);
  scree_free(bytes);
  if (status == SCREE_OK)
    *run = l.run;
  else
    scree_run_free(l.run);
  return status;
}
