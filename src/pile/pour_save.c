/* Checkpoints of a pour: a seal (base/seal.h), the plan, the shapes' counts, names and sources, the
 * gallery (a packed world with the
 * pour's world options and materials, and one body of each shape), the packed world, how far the
 * pour is, and the caller's notes. Order, cells and radii follow from the plan and are made again.
 */
#include "pile/pour.h"

#include "base/alloc.h"
#include "base/seal.h"

#include <string.h>

static const scree_seal seal = {"screePOU", "checkpoint of a scree pour", "pour", 2};
enum { MOST_SHAPES = 1 << 20, SHAPE_BYTES = 24 /* at least */ };

static void code_plan(scree_codec *c, scree_pour_options *o) {
  uint32_t container = (uint32_t)o->container;
  scree_code_u32(c, &container);
  o->container = (scree_container)container;
  double *reals[] = {&o->width, &o->depth, &o->drop_height, &o->entry_speed};
  for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) scree_code_real(c, reals[i]);
  scree_code_u64(c, &o->seed);
}

static void code_progress(scree_codec *c, scree_pour *pour) {
  uint64_t counts[2] = {pour->entered_count, pour->layer_count};
  for (int i = 0; i < 2; i++) scree_code_u64(c, &counts[i]);
  pour->entered_count = (size_t)counts[0];
  pour->layer_count = (size_t)counts[1];
  scree_code_real(c, &pour->entered_energy);
}

/* ---- saving ---- */

static void save_text(scree_codec *c, char *text) {
  size_t length = text ? strlen(text) : 0;
  scree_code_count(c, &length, 1);
  scree_code_bytes(c, text, length);
}

static void save_shapes(scree_codec *c, const scree_pour *pour) {
  size_t shapes = pour->shape_count;
  scree_code_count(c, &shapes, SHAPE_BYTES);
  for (size_t s = 0; s < shapes; s++) {
    uint64_t count = pour->counts[s];
    scree_code_u64(c, &count);
    for (size_t i = 2 * s; i < 2 * s + 2; i++) save_text(c, pour->texts[i]);
  }
}

static scree_status save_gallery(scree_codec *c, const scree_pour *pour, scree_error *error) {
  scree_world *gallery;
  scree_status status = scree_pour_make_gallery(pour, &gallery, error);
  if (status != SCREE_OK) return status;
  status = scree_world_save_block(c, gallery, error);
  scree_world_free(gallery);
  return status;
}

scree_status scree_pour_save(const scree_pour *pour, const char *path, bool overwrite,
                             scree_error *error) {
  scree_codec c = {0};
  scree_pour state = *pour; /* a shallow copy: only its plain fields are written */
  scree_seal_begin(&c);
  code_plan(&c, &state.options);
  save_shapes(&c, pour);
  scree_status status = save_gallery(&c, pour, error);
  if (status == SCREE_OK) status = scree_world_save_block(&c, pour->world, error);
  code_progress(&c, &state);
  scree_code_count(&c, &state.note_count, sizeof(double));
  scree_code_reals(&c, state.notes, state.note_count);
  if (status == SCREE_OK) status = scree_seal_end(&c, &seal, error);
  if (status == SCREE_OK) status = scree_seal_write(c.bytes, c.count, path, overwrite, error);
  scree_free(c.bytes);
  return status;
}

/* ---- loading ---- */

typedef struct loader {
  scree_codec codec;
  const char *name;
  scree_error *error;
  scree_pour_options options;
  scree_pour_shape *shapes;
  char **texts; /* two of each shape */
  size_t shape_count;
  scree_world *gallery, *world;
  scree_pour *pour;
} loader;

static scree_status fail_here(const loader *l) {
  return scree_seal_refuse(&l->codec, &seal, l->name, l->error);
}

/* NULL where it is empty, or cannot be had. */
static char *load_text(scree_codec *c) {
  size_t length = 0;
  scree_code_count(c, &length, 1);
  if (!scree_codec_good(c) || length == 0) return NULL;
  char *text = scree_alloc_zero(length + 1, 1);
  if (!text) c->out_of_memory = true;
  if (text) scree_code_bytes(c, text, length);
  return text;
}

static scree_status load_shapes(loader *l) {
  scree_codec *c = &l->codec;
  size_t count = 0;
  code_plan(c, &l->options);
  scree_code_count(c, &count, SHAPE_BYTES);
  if (count > MOST_SHAPES) c->failed = true;
  if (!scree_codec_good(c)) return fail_here(l);
  l->shapes = scree_alloc_zero(count, sizeof *l->shapes);
  l->texts = scree_alloc_zero(2 * count, sizeof *l->texts);
  if (!l->shapes || !l->texts)
    return scree_fail_memory(l->error, count * sizeof *l->shapes, "shapes");
  l->shape_count = count;
  for (size_t s = 0; s < count; s++) {
    uint64_t many = 0;
    scree_code_u64(c, &many);
    if (many > UINT32_MAX) c->failed = true;
    l->shapes[s].count = (size_t)many;
    l->shapes[s].name = l->texts[2 * s] = load_text(c);
    l->shapes[s].source = l->texts[2 * s + 1] = load_text(c);
  }
  if (!scree_codec_good(c)) return fail_here(l);
  scree_status status = scree_world_load_block(c, l->name, &l->gallery, l->error);
  if (status != SCREE_OK) return status;
  if (scree_world_body_count(l->gallery) != count || l->gallery->material_count != 2)
    return fail_here(l);
  scree_world_get_options(l->gallery, &l->options.world);
  l->options.particles = l->gallery->materials[0];
  l->options.walls = l->gallery->materials[1];
  for (size_t s = 0; s < count; s++)
    l->shapes[s].particle = scree_world_body_particle(l->gallery, s);
  return SCREE_OK;
}

/* The world of the file instead of the empty one. Its particles serve for those to come, so that a
 * shape stays one particle however often a pour is loaded. */
static scree_status adopt_world(loader *l) {
  scree_pour *pour = l->pour;
  code_progress(&l->codec, pour);
  size_t bodies = scree_world_body_count(l->world);
  if (!scree_codec_good(&l->codec) || pour->entered_count != bodies || bodies > pour->count ||
      pour->layer_count > pour->layers ||
      scree_world_wall_count(l->world) != scree_world_wall_count(pour->world))
    return fail_here(l);
  for (size_t i = 0; i < bodies; i++) {
    scree_particle **held = &pour->particles[pour->shape_of[i]];
    scree_particle *particle = scree_world_body_particle(l->world, i);
    if (*held == particle) continue;
    scree_particle_retain(particle);
    scree_particle_free(*held);
    *held = particle;
  }
  scree_world_free(pour->world);
  pour->world = l->world;
  l->world = NULL;
  return SCREE_OK;
}

static scree_status load_notes(loader *l) {
  size_t count = 0;
  scree_code_count(&l->codec, &count, sizeof(double));
  if (!scree_codec_good(&l->codec)) return fail_here(l);
  l->pour->notes = scree_alloc_zero(count, sizeof *l->pour->notes);
  if (!l->pour->notes) return scree_fail_memory(l->error, count * sizeof(double), "notes");
  l->pour->note_count = count;
  scree_code_reals(&l->codec, l->pour->notes, count);
  if (l->codec.position != l->codec.count) l->codec.failed = true;
  return scree_codec_good(&l->codec) ? SCREE_OK : fail_here(l);
}

static scree_status load(loader *l) {
  scree_status status = load_shapes(l);
  if (status == SCREE_OK) status = scree_world_load_block(&l->codec, l->name, &l->world, l->error);
  if (status == SCREE_OK)
    status = scree_pour_create(l->shapes, l->shape_count, &l->options, &l->pour, l->error);
  if (status == SCREE_OK) status = adopt_world(l);
  return status == SCREE_OK ? load_notes(l) : status;
}

scree_status scree_pour_load(const char *path, scree_pour **pour, scree_error *error) {
  char *bytes;
  loader l = {.error = error};
  scree_status status = scree_seal_read(path, &seal, &bytes, &l.codec, &l.name, error);
  if (status != SCREE_OK) return status;
  status = load(&l);
  for (size_t i = 0; l.texts && i < 2 * l.shape_count; i++) scree_free(l.texts[i]);
  scree_free(l.texts);
  scree_free(l.shapes);
  scree_world_free(l.world);
  scree_world_free(l.gallery);
  scree_free(bytes);
  if (status == SCREE_OK)
    *pour = l.pour;
  else
    scree_pour_free(l.pour);
  return status;
}
