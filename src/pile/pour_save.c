/* Checkpoints of a pour: those of its scene, under a seal of their own. The scene's notes hold what
 * it does not say: container, sizes and speed as they were given, of each shape its count and name.
 */
#include "pile/pour.h"
#include "world/checkpoint.h"

#include "base/alloc.h"

#include <string.h>

const scree_seal scree_pour_seal = {"screePOU", "checkpoint of a scree pour", "pour", 4};

static void code_plan(scree_codec *c, scree_pour_options *o) {
  uint32_t container = (uint32_t)o->container;
  scree_code_u32(c, &container);
  o->container = (scree_container)container;
  double *reals[] = {&o->width, &o->depth, &o->drop_height, &o->entry_speed};
  for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) scree_code_real(c, reals[i]);
  scree_code_u64(c, &o->seed);
}

/* ---- saving ---- */

scree_status scree_pour_pack_notes(const scree_pour *pour, unsigned char **bytes,
                                   size_t *byte_count, scree_error *error) {
  scree_codec c = {0};
  scree_pour_options options = pour->options; /* written, never changed */
  code_plan(&c, &options);
  for (size_t s = 0; s < pour->shape_count; s++) {
    uint64_t count = pour->counts[s];
    scree_code_u64(&c, &count);
    scree_code_text(&c, pour->names[s], strlen(pour->names[s]));
  }
  if (c.out_of_memory) {
    scree_free(c.bytes);
    return scree_fail_memory(error, c.count, "a pour's notes");
  }
  *bytes = c.bytes;
  *byte_count = c.count;
  return SCREE_OK;
}

scree_status scree_pour_save(const scree_pour *pour, const char *path, bool overwrite,
                             scree_error *error) {
  return scree_scene_save(pour->scene, path, overwrite, error);
}

/* ---- loading ---- */

typedef struct loader {
  scree_codec codec;
  const char *name;
  scree_error *error;
  scree_scene *scene;
  scree_pour_options options;
  scree_pour_shape *shapes;
  char **names;
  scree_pour *pour;
} loader;

static scree_status refuse(loader *l) {
  l->codec.failed = !l->codec.out_of_memory;
  return scree_seal_refuse(&l->codec, &scree_pour_seal, l->name, l->error);
}

static scree_status load_shapes(loader *l) {
  size_t count = SCREE_SCENE_SHAPES(l->scene);
  const scree_world *gallery = l->scene->gallery;
  code_plan(&l->codec, &l->options);
  if (gallery->material_count != 2) return refuse(l);
  scree_world_get_options(gallery, &l->options.world);
  l->options.particles = gallery->materials[0];
  l->options.walls = gallery->materials[1];
  l->shapes = scree_alloc_zero(count, sizeof *l->shapes);
  l->names = scree_alloc_zero(count, sizeof *l->names);
  if (!l->shapes || !l->names) return scree_fail_memory(l->error, count, "a pour's shapes");
  for (size_t s = 0; s < count; s++) {
    uint64_t many = 0;
    scree_code_u64(&l->codec, &many);
    l->names[s] = scree_decode_text(&l->codec);
    if (!l->names[s] || many > UINT32_MAX) return refuse(l);
    l->shapes[s] =
        (scree_pour_shape){l->scene->shapes[s].particle, (size_t)many, l->names[s], NULL};
  }
  bool whole = scree_codec_good(&l->codec) && l->codec.position == l->codec.count;
  return whole ? SCREE_OK : refuse(l);
}

static scree_pour_schedule schedule_of(const scree_scene *scene) {
  const scree_plan_stop *stop = scene->plan.stop;
  const scree_plan_output *o = scene->plan.output;
  bool still = !isnan(stop->still);
  return (scree_pour_schedule){.time = stop->filled,
                               .still = still ? stop->still : 0,
                               .rest = still ? stop->rest : 0,
                               .frames = o->frames,
                               .series = o->series,
                               .checkpoint = o->checkpoint};
}

/* The scene must be the one that the options make. */
static scree_status compare(loader *l) {
  scree_scene_file *file;
  bool same;
  scree_status status = scree_pour_file(l->pour, &file, l->error);
  if (status != SCREE_OK) return status;
  status = scree_scene_matches(l->scene, file, &same, l->error);
  scree_scene_file_free(file);
  return status == SCREE_OK && !same ? refuse(l) : status;
}

static scree_status load(loader *l) {
  scree_status status = load_shapes(l);
  if (status == SCREE_OK)
    status = scree_pour_describe(l->shapes, SCREE_SCENE_SHAPES(l->scene), &l->options, &l->pour,
                                 l->error);
  if (status != SCREE_OK) return status;
  l->pour->schedule = schedule_of(l->scene);
  return compare(l);
}

scree_status scree_pour_of_scene(scree_scene *scene, const char *path, scree_pour **pour,
                                 scree_error *error) {
  loader l = {.codec = {.source = scene->notes.bytes, .count = scene->notes.count, .loading = true},
              .name = path,
              .error = error,
              .scene = scene};
  scree_status status = load(&l);
  for (size_t s = 0; l.names && s < SCREE_SCENE_SHAPES(scene); s++) scree_free(l.names[s]);
  scree_free(l.names);
  scree_free(l.shapes);
  if (status != SCREE_OK) {
    scree_pour_free(l.pour);
    return status;
  }
  l.pour->scene = scene;
  *pour = l.pour;
  return SCREE_OK;
}

scree_status scree_pour_load(const char *path, scree_pour **pour, scree_error *error) {
  scree_scene *scene;
  scree_status status = scree_scene_load_as(&scree_pour_seal, path, &scene, error);
  if (status != SCREE_OK) return status;
  status = scree_pour_of_scene(scene, path, pour, error);
  if (status != SCREE_OK) scree_scene_free(scene);
  return status;
}
