/* Checkpoints of a scene: a seal (base/seal.h); the file, printed; the shapes' sources; the gallery
 * (a packed world with one body of each shape); the world; the books, inlets, outlets, sensors and
 * bodies; the series. What follows from the file is made
 * again. A frame's world has its bodies and walls without what contacts remember; what follows from
 * contacts is kept as a number. */
#include "world/state/save.h"
#include "scene/scene.h"
#include "world/step/checkpoint.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/seal.h"

#include <string.h>

static const scree_seal seal = {"screeSCN", "checkpoint of a scree scene", "scene", 10};

/* ---- the fields, in and out alike ---- */

static void code_size(scree_codec *c, size_t *value) {
  uint64_t wide = *value;
  scree_code_u64(c, &wide);
  *value = (size_t)wide;
}

static void code_books(scree_codec *c, scree_scene *scene) {
  double *reals[] = {&scene->time_step, &scene->entered_mass, &scene->left_mass,
                     &scene->entered_energy, &scene->left_energy};
  for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) scree_code_real(c, reals[i]);
  uint32_t end = (uint32_t)scene->end;
  scree_code_reals(c, scene->table_low, 3);
  scree_code_reals(c, scene->table_high, 3);
  scree_code_u64(c, &scene->tick_steps);
  scree_code_u64(c, &scene->next_tick);
  code_size(c, &scene->still_ticks);
  code_size(c, &scene->left_count);
  scree_code_u32(c, &end);
  if (end >= SCREE_SCENE_ENDS || scene->tick_steps == 0) c->failed = true;
  scene->end = (int)end;
}

static void code_progress(scree_codec *c, scree_scene *scene) {
  scree_scene_costs *costs = &scene->costs;
  double *reals[] = {&scene->phase_start, &scene->still_since, &costs->wall_seconds,
                     &costs->processor_seconds, &scene->frame_coordination};
  for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) scree_code_real(c, reals[i]);
  scree_code_u64(c, &costs->body_steps);
  scree_code_u64(c, &costs->piece_count);
  scree_code_bool(c, &scene->is_frame);
  code_size(c, &scene->phase);
  if (scene->phase > scene->plan.phases.count) c->failed = true;
}

static void code_inlets(scree_codec *c, scree_scene *scene) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    scree_scene_inlet *inlet = &scene->inlets[i];
    code_size(c, &inlet->entered);
    code_size(c, &inlet->waiting);
    scree_code_real(c, &inlet->mass);
    scree_code_u64(c, &inlet->draws);
    scree_code_real(c, &inlet->begin.time);
    scree_code_real(c, &inlet->begin.mass);
    code_size(c, &inlet->begin.count);
    code_size(c, &inlet->layers.count);
    if (inlet->plan->count && inlet->entered > inlet->plan->count) c->failed = true;
    for (size_t k = 0; k < inlet->plan->shapes.count; k++) code_size(c, &inlet->counts[k]);
  }
  for (size_t i = 0; i <= scene->plan.outlets.count; i++) {
    code_size(c, &scene->outlets[i].left);
    scree_code_real(c, &scene->outlets[i].mass);
    scree_code_real(c, &scene->outlets[i].first_time);
    scree_code_reals(c, scene->outlets[i].first_place, 3);
  }
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++) {
    scree_code_real(c, &scene->shapes[i].density); /* by the scan's volume, which is not kept */
    if (c->loading) scene->shapes[i].mass = scene->shapes[i].density * scene->shapes[i].volume;
    code_size(c, &scene->shapes[i].entered);
    code_size(c, &scene->shapes[i].left);
  }
}

/* Whether a list has place for what is read or written into it. */
#define HOLDS(codec, reserved)                                                                     \
  (scree_codec_good(codec) && ((reserved) || ((codec)->out_of_memory = true, false)))

static void code_bodies(scree_codec *c, scree_scene *scene) {
  size_t count = scene->shape_of.count;
  scree_code_count(c, &count, 28);
  if (!HOLDS(c, SCREE_RESERVE(&scene->shape_of, count) &&
                    SCREE_RESERVE(&scene->entered_at, count) &&
                    SCREE_RESERVE(&scene->stays, count)))
    return;
  scene->shape_of.count = scene->entered_at.count = scene->stays.count = count;
  for (size_t i = 0; i < count; i++) {
    scree_code_u32(c, &scene->shape_of.items[i]);
    if (c->loading && scene->shape_of.items[i] >= SCREE_SCENE_SHAPES(scene)) {
      c->failed = true;
      scene->shape_of.items[i] = 0;
    }
  }
  scree_code_reals(c, scene->entered_at.items, count);
  for (size_t i = 0; i < count; i++) {
    scree_scene_stay *stay = &scene->stays.items[i];
    scree_code_real(c, &stay->left);
    scree_code_u32(c, &stay->inlet);
    scree_code_u32(c, &stay->outlet);
  }
}

static void code_series(scree_codec *c, scree_scene *scene) {
  size_t rows = scene->row_count, columns = scene->columns.count;
  scree_code_count(c, &rows, columns * sizeof(double));
  if (!HOLDS(c, SCREE_RESERVE(&scene->series, rows * columns))) return;
  scene->row_count = rows;
  scree_code_reals(c, scene->series.items, rows * columns);
}

static void code_parts(scree_codec *c, scree_scene *scene) {
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    scree_scene_part *part = scene->geometry[i].part;
    if (!part) continue;
    double *reals[] = {&part->way,  &part->speed, &part->push,   &part->work,
                       &part->lost, &part->given, &part->earlier};
    for (size_t k = 0; k < sizeof reals / sizeof *reals; k++) scree_code_real(c, reals[k]);
  }
}

/* A text in the scene's arena; NULL is written as none. */
static void code_text(scree_codec *c, scree_scene *scene, const char **text) {
  bool there = *text != NULL;
  scree_code_bool(c, &there);
  if (!c->loading) {
    if (*text) scree_code_text(c, *text, strlen(*text));
    return;
  }
  if (!there || !scree_codec_good(c)) return;
  char *read = scree_decode_text(c), *kept = NULL;
  if (read) kept = scree_arena_take(&scene->arena, strlen(read) + 1, 1);
  if (kept)
    *text = memcpy(kept, read, strlen(read) + 1);
  else
    c->failed = true;
  scree_free(read);
}

static void code_changes(scree_codec *c, scree_scene *scene) {
  size_t count = scene->changes.count;
  scree_code_count(c, &count, 8);
  for (size_t i = 0; i < count && scree_codec_good(c); i++) {
    scree_scene_change_entry change = {0};
    if (!c->loading) change = scene->changes.items[i];
    scree_code_real(c, &change.time);
    code_text(c, scene, &change.field);
    code_text(c, scene, &change.was);
    code_text(c, scene, &change.is);
    if (!change.field) c->failed = true;
    if (c->loading && scree_codec_good(c) && !SCREE_PUSH(&scene->changes, change))
      c->out_of_memory = true;
  }
}

static void code_state(scree_codec *c, scree_scene *scene) {
  code_books(c, scene);
  code_progress(c, scene);
  code_inlets(c, scene);
  for (size_t i = 0; i < scene->plan.sensors.count; i++)
    scree_sensor_code(c, scene, &scene->sensors[i]);
  for (size_t i = 0; i < scene->plan.sensors.count; i++)
    scree_sensor_code_shared(c, scene, &scene->sensors[i]);
  code_parts(c, scene);
  code_bodies(c, scene);
  code_series(c, scene);
  code_changes(c, scene);
}

/* How many walls each piece of geometry is. */
static void code_geometry(scree_codec *c, scree_scene *scene) {
  size_t next = 0;
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    scree_scene_geometry *g = &scene->geometry[i];
    code_size(c, &g->wall_count);
    if (g->wall_count < 1 || g->wall_count > UINT32_MAX) c->failed = true;
    if (!scree_codec_good(c)) return;
    g->first_wall = next;
    next += g->wall_count;
  }
}

/* What each piece is of. */
static scree_status code_pieces(scree_codec *c, scree_scene *scene, scree_error *error) {
  size_t count = SCREE_SCENE_SHAPES(scene) - scene->named_count;
  scree_code_count(c, &count, 2 * sizeof(uint32_t));
  SCREE_SCRATCH_ZERO(scree_scene_piece, pieces, count, error);
  for (size_t i = 0; i < count; i++) {
    scree_scene_piece *p = &pieces[i];
    const scree_scene_shape *s = &scene->shapes[scene->named_count + i];
    if (!c->loading) *p = (scree_scene_piece){(uint32_t)s->assembly, s->group, s->part};
    scree_code_u32(c, &p->assembly);
    scree_code_u32(c, &p->group);
    code_text(c, scene, &p->part);
    if (p->assembly < scene->named_count) continue;
    c->failed = true;
    return SCREE_OK;
  }
  return c->loading && scree_codec_good(c) ? scree_scene_append_pieces(scene, pieces, count, error)
                                           : SCREE_OK;
}

/* ---- saving ---- */

static scree_status save(scree_codec *c, const scree_scene *scene, bool as_frame,
                         scree_error *error) {
  scree_scene state = *scene; /* its arrays are written, never changed */
  scree_observation o;
  scree_world_observe(scene->world, &o);
  state.is_frame = as_frame;
  if (!scene->is_frame) state.frame_coordination = o.coordination;
  scree_seal_begin(c);
  scree_code_text(c, scene->name, strlen(scene->name));
  scree_code_text(c, scene->text, strlen(scene->text));
  SCREE_TRY(code_pieces(c, &state, error));
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++)
    scree_code_text(c, scene->shapes[i].source, strlen(scene->shapes[i].source));
  SCREE_TRY(scree_world_save_block(c, scene->gallery, true, error));
  SCREE_TRY(scree_world_save_block(c, scene->world, !as_frame, error));
  code_geometry(c, &state);
  code_state(c, &state);
  return scree_seal_end(c, &seal, error);
}

scree_status scree_scene_pack(const void *scene, unsigned char **bytes, size_t *byte_count,
                              scree_error *error) {
  SCREE_CLEANUP(scree_codec_free) scree_codec c = {0};
  SCREE_TRY(save(&c, scene, false, error));
  *bytes = c.bytes;
  *byte_count = c.count;
  c.bytes = NULL;
  return SCREE_OK;
}

static scree_status save_as(const scree_scene *scene, bool as_frame, const char *path,
                            bool overwrite, scree_error *error) {
  SCREE_CLEANUP(scree_codec_free) scree_codec c = {0};
  if (scene->is_frame && !as_frame)
    return scree_fail(error, SCREE_UNSUPPORTED, "%s: a frame cannot become a checkpoint", path);
  SCREE_TRY(save(&c, scene, as_frame, error));
  return scree_seal_write(c.bytes, c.count, path, overwrite, error);
}

scree_status scree_scene_save(const scree_scene *scene, const char *path, bool overwrite,
                              scree_error *error) {
  return save_as(scene, false, path, overwrite, error);
}

scree_status scree_scene_save_frame(const scree_scene *scene, const char *path, bool overwrite,
                                    scree_error *error) {
  return save_as(scene, true, path, overwrite, error);
}

/* ---- loading ---- */

typedef struct loader {
  scree_codec codec;
  const char *name;
  scree_error *error;
  scree_scene *scene;
} loader;

static scree_status fail_here(const loader *l) {
  return scree_seal_refuse(&l->codec, &seal, l->name, l->error);
}

static scree_status load_plan(loader *l) {
  scree_scene *scene = l->scene;
  SCREE_OWNED(scree_scene_file, file);
  scene->name = scree_decode_text(&l->codec);
  scene->text = scree_decode_text(&l->codec);
  if (!scene->name || !scene->text) return fail_here(l);
  SCREE_TRY(scree_scene_file_parse(scene->text, strlen(scene->text), l->name, &file, l->error));
  SCREE_TRY(scree_scene_file_plan(file, &scene->arena, &scene->plan, l->error));
  return scree_scene_prepare(scene, l->error);
}

/* Particles of bodies in the world are taken from there, so that a shape stays one particle however
 * often a scene is loaded. */
static scree_status adopt_particles(loader *l) {
  scree_scene *scene = l->scene;
  size_t bodies = scree_world_body_count(scene->world);
  if (bodies != scene->shape_of.count ||
      scree_world_wall_count(scene->world) != scree_world_wall_count(scene->gallery))
    return fail_here(l);
  for (size_t b = 0; b < bodies; b++) {
    scree_particle **held = &scene->shapes[scene->shape_of.items[b]].particle;
    scree_particle *particle = scree_world_body_particle(scene->world, b);
    if (*held == particle) continue;
    scree_particle_retain(particle);
    scree_particle_free(*held);
    *held = particle;
  }
  scree_world_share_walls(scene->world, scene->gallery);
  return SCREE_OK;
}

/* The speed that steps of Hertz's law suit, from the step itself: the gallery's own is for 1 m/s,
 * and a step goes as v^-1/5. */
static void recall_hits(scree_scene *scene) {
  if (scene->plan.contact->time_step > 0) return;
  const double share = scree_world_time_step(scene->gallery, NULL) / scene->time_step;
  scene->gallery->hit_speed = scene->world->hit_speed = pow(share, 5);
}

/* The walls that the plan has. */
static size_t next_wall(const scree_scene *scene) {
  size_t count = scene->plan.geometry.count;
  if (count == 0) return 0;
  return scene->geometry[count - 1].first_wall + scene->geometry[count - 1].wall_count;
}

static scree_status load(loader *l) {
  scree_scene *scene = l->scene;
  SCREE_TRY(load_plan(l));
  SCREE_TRY(code_pieces(&l->codec, scene, l->error));
  if (!scree_codec_good(&l->codec)) return fail_here(l);
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++)
    if (!(scene->shapes[i].source = scree_decode_text(&l->codec))) return fail_here(l);
  SCREE_TRY(scree_world_load_block(&l->codec, l->name, &scene->gallery, l->error));
  SCREE_TRY(scree_world_load_block(&l->codec, l->name, &scene->world, l->error));
  if (scree_world_body_count(scene->gallery) != SCREE_SCENE_SHAPES(scene)) return fail_here(l);
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++) {
    scene->shapes[i].particle = scree_world_body_particle(scene->gallery, i);
    scree_particle_retain(scene->shapes[i].particle);
    scree_scene_measure_shape(scene, i);
  }
  scree_scene_place_pieces(scene);
  code_geometry(&l->codec, scene);
  if (!scree_codec_good(&l->codec) || next_wall(scene) != scree_world_wall_count(scene->world))
    return fail_here(l);
  SCREE_TRY(scree_sensors_begin(scene, l->error));
  code_state(&l->codec, scene);
  if (l->codec.position != l->codec.count) l->codec.failed = true;
  if (!scree_codec_good(&l->codec)) return fail_here(l);
  SCREE_TRY(adopt_particles(l));
  recall_hits(scene);
  SCREE_TRY(scree_scene_complete_plan(scene, l->error));
  return scree_scene_plan_layers(scene, l->error);
}

scree_status scree_scene_load(const char *path, scree_scene **scene, scree_error *error) {
  char *bytes;
  loader l = {.error = error};
  SCREE_TRY(scree_seal_read(path, &seal, &bytes, &l.codec, &l.name, error));
  l.scene = scree_alloc_zero(1, sizeof *l.scene);
  scree_status status = l.scene ? load(&l) : scree_fail_memory(error, sizeof *l.scene, "a scene");
  scree_free(bytes);
  if (status == SCREE_OK)
    *scene = l.scene;
  else
    scree_scene_free(l.scene);
  return status;
}
