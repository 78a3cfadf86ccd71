/* A run that goes on with a changed file. Old and new are compared as printed, with every default:
 * each field that differs must be one that may. A scene of the new file then takes over shapes,
 * world and books of the old one, and by name what its inlets, outlets and sensors have counted;
 * what the world itself must know is set in it. */
#include "scene/scene.h"
#include "world/backend.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/codec.h"
#include "base/file.h"
#include "base/platform.h"

#include <stdlib.h>
#include <string.h>

enum { PATH_BYTES = 300 };

/* * is one name or number; all below is meant too. */
static const char *const changeable[] = {"title",
                                         "time",
                                         "seed",
                                         "gravity",
                                         "stop",
                                         "output",
                                         "parameters",
                                         "presets",
                                         "preset",
                                         "materials.*.restitution",
                                         "materials.*.friction",
                                         "materials.*.rolling_friction",
                                         "materials.*.surface_energy",
                                         "pairs",
                                         "geometry.*.motion",
                                         "geometry.*.surface_velocity",
                                         "geometry.*.belt.speed",
                                         "geometry.*.slide",
                                         "geometry.*.hinge",
                                         "inlets",
                                         "outlets",
                                         "domain.min",
                                         "domain.max",
                                         "sensors",
                                         "forces",
                                         "phases.*.*"};
/* What was written so far lies at these intervals. */
static const char *const fixed[] = {"output.frames", "output.series"};
static const char offer[] =
    "a run may go on with other motions and surface velocities of geometry, friction and "
    "restitution, gravity, forces, inlets, outlets, sensors, times, stop and output";

static bool matches(const char *path, const char *pattern) {
  for (; *pattern; path++, pattern++) {
    if (*pattern == '*') {
      path += strcspn(path, ".");
      pattern++;
    }
    if (!*pattern) return !*path || *path == '.';
    if (*path != *pattern) return false;
  }
  return !*path || *path == '.';
}

static bool is_among(const char *path, const char *const *patterns, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (matches(path, patterns[i])) return true;
  return false;
}

#define IS_AMONG(path, patterns) is_among(path, patterns, sizeof(patterns) / sizeof *(patterns))

/* ---- what differs ---- */

typedef struct comparison {
  scree_scene *scene; /* whose arena has the texts */
  const char *folder; /* where its files lie */
  scree_scene_change_list list;
  scree_status status;
  scree_error *error;
} comparison;

static void print_node(FILE *stream, const scree_yaml *node) {
  const char ends[2] = {node->kind == SCREE_YAML_SEQUENCE ? '[' : '{',
                        node->kind == SCREE_YAML_SEQUENCE ? ']' : '}'};
  if (node->kind == SCREE_YAML_SCALAR) {
    fputs(node->text, stream);
    return;
  }
  putc(ends[0], stream);
  for (size_t i = 0; i < node->item_count; i++) {
    if (i) fputs(", ", stream);
    if (node->items[i].key) fprintf(stream, "%s: ", node->items[i].key);
    print_node(stream, &node->items[i]);
  }
  putc(ends[1], stream);
}

static const char *keep_text(comparison *c, const char *text) {
  char *kept = scree_arena_take(&c->scene->arena, strlen(text) + 1, 1);
  if (kept)
    memcpy(kept, text, strlen(text) + 1);
  else
    c->status = scree_fail_memory(c->error, strlen(text), "a change");
  return kept;
}

/* NULL where it is not there. */
static const char *text_of(comparison *c, const scree_yaml *node) {
  char *text = NULL;
  size_t size;
  if (!node || c->status != SCREE_OK) return NULL;
  FILE *stream = scree_memory_open(&text, &size);
  if (stream) print_node(stream, node);
  const char *kept = NULL;
  if (stream && scree_memory_close(stream))
    kept = keep_text(c, text);
  else
    c->status = scree_fail_memory(c->error, 0, "a change");
  free(text);
  return kept;
}

static bool are_alike(const scree_yaml *a, const scree_yaml *b) {
  if (a->kind != b->kind || a->item_count != b->item_count) return false;
  if (a->kind == SCREE_YAML_SCALAR) return !strcmp(a->text, b->text);
  for (size_t i = 0; i < a->item_count; i++) {
    const char *k = a->items[i].key, *l = b->items[i].key;
    if ((k && strcmp(k, l) != 0) || !are_alike(&a->items[i], &b->items[i])) return false;
  }
  return true;
}

static void compare(comparison *c, const scree_yaml *was, const scree_yaml *is, const char *path);

static void compare_items(comparison *c, const scree_yaml *was, const scree_yaml *is,
                          const char *path) {
  char below[PATH_BYTES];
  const char *point = *path ? "." : "";
  bool list = was->kind == SCREE_YAML_SEQUENCE;
  for (size_t i = 0; i < was->item_count; i++) {
    const scree_yaml *item = &was->items[i];
    if (list)
      snprintf(below, sizeof below, "%.200s%s%zu", path, point, i);
    else
      snprintf(below, sizeof below, "%.200s%s%.90s", path, point, item->key);
    compare(c, item, list ? &is->items[i] : scree_yaml_find(is, item->key), below);
  }
  for (size_t i = 0; !list && i < is->item_count; i++) {
    if (scree_yaml_find(was, is->items[i].key)) continue;
    snprintf(below, sizeof below, "%.200s%s%.90s", path, point, is->items[i].key);
    compare(c, NULL, &is->items[i], below);
  }
}

/* Lists of groups are compared one by one, others as one value. */
static void compare(comparison *c, const scree_yaml *was, const scree_yaml *is, const char *path) {
  if (c->status != SCREE_OK || (was && is && are_alike(was, is))) return;
  bool both = was && is && was->kind == is->kind;
  bool groups = both && was->kind == SCREE_YAML_SEQUENCE && was->item_count == is->item_count &&
                was->items[0].kind == SCREE_YAML_MAPPING;
  if (groups || (both && was->kind == SCREE_YAML_MAPPING)) {
    compare_items(c, was, is, path);
    return;
  }
  scree_scene_change_entry change = {scree_world_time(c->scene->world), keep_text(c, path),
                                     text_of(c, was), text_of(c, is)};
  if (c->status == SCREE_OK && !SCREE_PUSH(&c->list, change))
    c->status = scree_fail_memory(c->error, sizeof change, "changes");
}

static scree_status compare_texts(comparison *c, const char *was, const char *is) {
  scree_yaml trees[2] = {{.kind = SCREE_YAML_MAPPING}, {.kind = SCREE_YAML_MAPPING}};
  c->status = scree_yaml_parse(was, strlen(was), c->scene->name, &trees[0], c->error);
  if (c->status == SCREE_OK)
    c->status = scree_yaml_parse(is, strlen(is), c->scene->name, &trees[1], c->error);
  if (c->status == SCREE_OK) compare(c, &trees[0], &trees[1], "");
  for (int i = 0; i < 2; i++) scree_yaml_free(&trees[i]);
  return c->status;
}

static bool has_changed(const comparison *c, const char *group, const char *name) {
  char path[PATH_BYTES];
  snprintf(path, sizeof path, "%s%s%s", group, name ? "." : "", name ? name : "");
  for (size_t i = 0; i < c->list.count; i++)
    if (matches(c->list.items[i].field, path)) return true;
  return false;
}

/* The first that may not change. */
static scree_status refuse_others(const comparison *c, scree_error *error) {
  for (size_t i = 0; i < c->list.count; i++) {
    const scree_scene_change_entry *d = &c->list.items[i];
    if (IS_AMONG(d->field, changeable) && !IS_AMONG(d->field, fixed)) continue;
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "%.150s: is %.80s in the run that goes on, and cannot become %.80s: %s",
                      d->field, d->was ? d->was : "not given", d->is ? d->is : "not given", offer);
  }
  for (size_t i = 0; i < c->scene->plan.inlets.count; i++) {
    const scree_plan_inlet *inlet = c->scene->inlets[i].plan;
    if (inlet->layers && has_changed(c, "inlets", inlet->place.name))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "inlets.%.100s: has layers, whose order is drawn at the start, and cannot "
                        "change in a run that goes on",
                        inlet->place.name);
  }
  return SCREE_OK;
}

/* ---- what is taken over ---- */

static scree_status take_shapes(const scree_scene *was, scree_scene *is, scree_error *error) {
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(is); i++) {
    scree_scene_shape *from = &was->shapes[i], *to = &is->shapes[i];
    *to = (scree_scene_shape){.particle = from->particle, .source = scree_strdup(from->source)};
    if (!to->source) return scree_fail_memory(error, strlen(from->source), "a shape");
    scree_particle_retain(to->particle);
    scree_scene_measure_shape(is, i);
    to->density = from->density;
    to->mass = from->mass;
    to->entered = from->entered;
    to->left = from->left;
  }
  return SCREE_OK;
}

static void take_books(const scree_scene *was, scree_scene *is) {
  is->world = was->world;
  is->gallery = was->gallery;
  is->time_step = was->time_step;
  is->tick_steps = was->tick_steps;
  is->next_tick = was->next_tick;
  is->next_map = was->next_map;
  is->next_hits = was->next_hits;
  is->still_ticks = was->still_ticks;
  is->entered_mass = was->entered_mass;
  is->left_mass = was->left_mass;
  is->entered_energy = was->entered_energy;
  memcpy(is->table_low, was->table_low, sizeof is->table_low);
  memcpy(is->table_high, was->table_high, sizeof is->table_high);
  is->left_energy = was->left_energy;
  is->left_count = was->left_count;
  is->end = was->end;
  is->phase = was->phase;
  is->phase_start = was->phase_start;
  is->still_since = was->still_since;
  is->costs = was->costs;
  for (size_t i = 0; i < is->plan.geometry.count; i++) {
    is->geometry[i].first_wall = was->geometry[i].first_wall;
    is->geometry[i].wall_count = was->geometry[i].wall_count;
    if (is->geometry[i].part && was->geometry[i].part)
      *is->geometry[i].part = *was->geometry[i].part;
  }
}

/* A rate that changes counts from now on, after what was due until then. */
static void take_inlet(const comparison *c, const scree_scene_inlet *from, scree_scene_inlet *to) {
  size_t *counts = to->counts;
  const char *name = to->plan->place.name;
  to->entered = from->entered;
  to->waiting = from->waiting;
  to->mass = from->mass;
  to->draws = from->draws;
  to->layers.count = from->layers.count;
  to->begin = from->begin;
  for (size_t i = 0; i < to->plan->shapes.count; i++)
    for (size_t k = 0; k < from->plan->shapes.count; k++)
      if (to->shapes[i] == from->shapes[k]) counts[i] = from->counts[k];
  if (!has_changed(c, "inlets", name)) return;
  to->begin = (scree_scene_begin){scree_world_time(c->scene->world), from->mass,
                                  from->entered + from->waiting};
}

static void take_inlets(const comparison *c, scree_scene *is) {
  const scree_scene *was = c->scene;
  for (size_t i = 0; i < is->plan.inlets.count; i++) {
    const char *name = is->inlets[i].plan->place.name;
    size_t k = SCREE_PLAN_FIND(was->plan.inlets, name);
    if (k < was->plan.inlets.count) take_inlet(c, &was->inlets[k], &is->inlets[i]);
  }
  size_t rim = is->plan.outlets.count;
  is->outlets[rim] = was->outlets[was->plan.outlets.count];
  for (size_t i = 0; i < rim; i++) {
    const char *name = is->plan.outlets.items[i].place.name;
    size_t k = SCREE_PLAN_FIND(was->plan.outlets, name);
    if (k < was->plan.outlets.count) is->outlets[i] = was->outlets[k];
  }
}

/* What a sensor that stays as it was has gathered, by way of a checkpoint's bytes. */
static scree_status take_sensor(scree_scene *was, size_t k, scree_scene *is, size_t i,
                                scree_error *error) {
  scree_codec out = {0};
  scree_scene_code_sensor(&out, was, &was->sensors[k]);
  scree_codec in = {.source = out.bytes, .count = out.count, .loading = true};
  if (scree_codec_good(&out)) scree_scene_code_sensor(&in, is, &is->sensors[i]);
  bool good = scree_codec_good(&out) && scree_codec_good(&in);
  scree_free(out.bytes);
  return good ? SCREE_OK : scree_fail_memory(error, out.count, "a sensor");
}

static scree_status take_sensors(const comparison *c, scree_scene *is, scree_error *error) {
  scree_scene *was = c->scene;
  for (size_t i = 0; i < is->plan.sensors.count; i++) {
    const char *name = is->sensors[i].plan->place.name;
    size_t k = SCREE_PLAN_FIND(was->plan.sensors, name);
    if (k < was->plan.sensors.count && !has_changed(c, "sensors", name))
      SCREE_TRY(take_sensor(was, k, is, i, error));
  }
  uint64_t now = scree_world_step_count(was->world);
  if (is->hit_steps && !was->hit_steps) is->next_hits = now;
  if (is->map_steps && !was->map_steps) is->next_map = now;
  return SCREE_OK;
}

/* Rows so far, with nothing in columns that there were none of. */
static scree_status take_series(const scree_scene *was, scree_scene *is, scree_error *error) {
  size_t columns = is->columns.count, old = was->columns.count;
  if (!SCREE_RESERVE(&is->series, was->row_count * columns))
    return scree_fail_memory(error, was->row_count * columns * sizeof(double), "a series");
  for (size_t i = 0; i < columns; i++) {
    size_t k = 0;
    while (k < old && strcmp(was->columns.items[k].name, is->columns.items[i].name) != 0) k++;
    for (size_t row = 0; row < was->row_count; row++)
      is->series.items[row * columns + i] =
          k < old ? was->series.items[row * old + k] : (double)NAN;
  }
  is->row_count = was->row_count;
  return SCREE_OK;
}

/* By which inlets and outlets bodies came and went: their places now, by their names; UINT32_MAX:
 * there is none any more. */
static void take_stays(const scree_scene *was, scree_scene *is) {
  const scree_plan *from = &was->plan, *to = &is->plan;
  is->stays = was->stays;
  for (size_t b = 0; b < is->stays.count; b++) {
    scree_scene_stay *s = &is->stays.items[b];
    if (s->inlet < from->inlets.count) {
      size_t now = SCREE_PLAN_FIND(to->inlets, from->inlets.items[s->inlet].place.name);
      s->inlet = now < to->inlets.count ? (uint32_t)now : UINT32_MAX;
    }
    if (s->outlet < from->outlets.count) {
      size_t now = SCREE_PLAN_FIND(to->outlets, from->outlets.items[s->outlet].place.name);
      s->outlet = now < to->outlets.count ? (uint32_t)now : UINT32_MAX;
    } else if (s->outlet == from->outlets.count) { /* the domain's rim */
      s->outlet = (uint32_t)to->outlets.count;
    }
  }
}

/* The lists of bodies and of contacts that impacts follow change hands. */
static void take_lists(scree_scene *was, scree_scene *is) {
  is->shape_of = was->shape_of;
  is->entered_at = was->entered_at;
  take_stays(was, is);
  was->stays.items = NULL;
  if (is->hit_steps) is->hits = was->hits;
  was->shape_of.items = NULL;
  was->entered_at.items = NULL;
  if (is->hit_steps) was->hits.items = NULL;
}

/* ---- what the world must know ---- */

static scree_status set_pairs(scree_scene *scene, scree_error *error) {
  scree_world *fresh; /* of the new materials */
  scree_status status = scree_scene_make_world(scene, scene->time_step, &fresh, error);
  if (status != SCREE_OK) return status;
  size_t count = scene->plan.materials.count;
  for (size_t a = 0; status == SCREE_OK && a < count; a++)
    for (size_t b = a; status == SCREE_OK && b < count; b++) {
      scree_material_contact contact;
      status = scree_world_get_pair(fresh, a, b, &contact, error);
      if (status == SCREE_OK) status = scree_world_set_pair(scene->world, a, b, &contact, error);
    }
  scree_world_free(fresh);
  return status;
}

static scree_status set_geometry(const comparison *c, scree_scene *scene, scree_error *error) {
  static const double still[3] = {0, 0, 0};
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < scene->plan.geometry.count; i++) {
    const scree_plan_geometry *g = &scene->plan.geometry.items[i];
    const scree_scene_geometry *made = &scene->geometry[i];
    if (!has_changed(c, "geometry", g->place.name)) continue;
    const double *surface = isnan(g->surface_velocity[0]) ? still : g->surface_velocity;
    double loop[3];
    scree_scene_belt_loop(g, loop);
    for (size_t w = made->first_wall; w < made->first_wall + made->wall_count; w++)
      if (status == SCREE_OK)
        status = scree_world_set_wall_surface(scene->world, w, surface, still, loop, error);
    if (status == SCREE_OK) status = scree_scene_read_paths(scene, i, c->folder, error);
    if (status == SCREE_OK) status = scree_scene_set_motions(scene, i, scene->world, error);
  }
  return status == SCREE_OK ? scree_scene_lead_by_phase(scene, error) : status;
}

static scree_status set_world(const comparison *c, scree_scene *scene, scree_error *error) {
  double missed = scree_scene_missing_energy(c->scene);
  if (has_changed(c, "materials", NULL) || has_changed(c, "pairs", NULL))
    SCREE_TRY(set_pairs(scene, error));
  SCREE_TRY(scree_world_change(scene->world, SCREE_ALL_PARTS, error));
  if (has_changed(c, "forces", NULL)) SCREE_TRY(scree_scene_apply_forces(scene, error));
  memcpy(scene->world->options.gravity, scene->plan.gravity, sizeof scene->plan.gravity);
  if (has_changed(c, "geometry", NULL)) SCREE_TRY(set_geometry(c, scene, error));
  /* other heights' worth, springs of another stiffness: whoever changes it brings that energy */
  scene->entered_energy += scree_scene_missing_energy(scene) - missed;
  return SCREE_OK;
}

/* ---- the change ---- */

static scree_status keep_history(comparison *c, scree_scene *is, scree_error *error) {
  const scree_scene_change_list *lists[] = {&c->scene->changes, &c->list};
  c->scene = is;
  for (int l = 0; l < 2; l++)
    for (size_t i = 0; i < lists[l]->count && c->status == SCREE_OK; i++) {
      scree_scene_change_entry change = lists[l]->items[i];
      change.field = keep_text(c, change.field);
      if (change.was) change.was = keep_text(c, change.was);
      if (change.is) change.is = keep_text(c, change.is);
      if (!SCREE_PUSH(&is->changes, change))
        c->status = scree_fail_memory(error, sizeof change, "changes");
    }
  return c->status;
}

static scree_status take_over(comparison *c, scree_scene *is, scree_error *error) {
  scree_scene *was = c->scene;
  SCREE_TRY(take_shapes(was, is, error));
  scree_scene_reopen(was, &is->plan);
  take_books(was, is);
  SCREE_TRY(scree_scene_complete_plan(is, error));
  SCREE_TRY(scree_scene_plan_maps(is, error));
  SCREE_TRY(take_sensors(c, is, error));
  SCREE_TRY(take_series(was, is, error));
  take_inlets(c, is);
  SCREE_TRY(scree_scene_plan_layers(is, error));
  if (has_changed(c, "inlets", NULL)) {
    SCREE_TRY(scree_scene_check_inlets(is, error));
    SCREE_TRY(scree_scene_check_softness(is, error));
  }
  return set_world(c, is, error);
}

static scree_status change_to(scree_scene **scene, const scree_scene_file *file,
                              scree_error *error) {
  scree_scene *was = *scene, *is = NULL;
  comparison c = {.scene = was, .folder = file->folder, .error = error};
  char *text;
  SCREE_TRY(scree_scene_file_text(file, &text, error));
  scree_status status = compare_texts(&c, was->text, text);
  scree_free(text);
  if (status == SCREE_OK) status = refuse_others(&c, error);
  if (status == SCREE_OK && c.list.count && !(is = scree_alloc_zero(1, sizeof *is)))
    status = scree_fail_memory(error, sizeof *is, "a scene");
  if (status != SCREE_OK || !is) {
    scree_free(c.list.items);
    return status;
  }
  status = scree_scene_take_file(is, file, error);
  if (status == SCREE_OK) status = take_over(&c, is, error);
  if (status == SCREE_OK) status = keep_history(&c, is, error);
  if (status == SCREE_OK) {
    take_lists(was, is);
    *scene = is;
    is = was;
  }
  is->world = is->gallery = NULL; /* of the other */
  scree_scene_free(is);
  scree_free(c.list.items);
  return status;
}

/* ---- from fields and files ---- */

static scree_status apply_field(scree_scene_file *file, const char *change, const char *equals,
                                scree_error *error) {
  size_t length = (size_t)(equals - change);
  char field[PATH_BYTES];
  if (length >= sizeof field)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%.60s: names no field", change);
  memcpy(field, change, length);
  field[length] = 0;
  return scree_scene_file_try(file, field, equals + 1, error);
}

/* What is wrong is of the changes, which have their own lines. */
static scree_status apply_file(scree_scene_file *file, const char *path, scree_error *error) {
  scree_yaml over;
  SCREE_TRY(scree_yaml_read(path, &over, error));
  char *name = scree_strdup(path);
  if (!name || over.kind != SCREE_YAML_MAPPING) {
    scree_yaml_free(&over);
    scree_free(name);
    return name ? scree_fail(error, SCREE_BAD_FILE, "%s: changes are `key: value` lines", path)
                : scree_fail_memory(error, strlen(path), path);
  }
  char *kept = file->name;
  file->name = name;
  scree_status status = scree_yaml_merge(&file->root, &over, error);
  if (status == SCREE_OK) status = scree_scene_file_check(file, error);
  file->name = kept;
  scree_free(name);
  return status;
}

scree_status scree_scene_change(scree_scene **scene, const char *const *changes, size_t count,
                                scree_error *error) {
  scree_scene_file *file;
  const char *text = (*scene)->text;
  if ((*scene)->is_frame)
    return scree_fail(error, SCREE_UNSUPPORTED, "a frame has no contacts: nothing goes on from it");
  scree_status status = scree_scene_file_parse(text, strlen(text), (*scene)->name, &file, error);
  if (status != SCREE_OK) return status;
  for (size_t i = 0; status == SCREE_OK && i < count; i++) {
    const char *equals = strchr(changes[i], '=');
    status =
        equals ? apply_field(file, changes[i], equals, error) : apply_file(file, changes[i], error);
    if (status == SCREE_BAD_FILE && equals && i + 1 < count) status = SCREE_OK; /* with others */
  }
  if (status == SCREE_OK) status = scree_scene_file_check(file, error);
  if (status == SCREE_OK) status = change_to(scene, file, error);
  scree_scene_file_free(file);
  return status;
}

size_t scree_scene_change_count(const scree_scene *scene) {
  return scene->changes.count;
}
scree_scene_change_entry scree_scene_change_at(const scree_scene *scene, size_t index) {
  return scene->changes.items[index];
}
