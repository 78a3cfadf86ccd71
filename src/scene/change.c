/* A run that goes on with a changed file. Old and new are compared as printed, with every default:
 * each field that differs must be one that may. A scene of the new file then takes over shapes,
 * world and books of the old one, and by name what its inlets, outlets and sensors have counted;
 * what the world itself must know is set in it. */
#include "scene/geometry.h"
#include "scene/motions.h"
#include "scene/scene.h"
#include "world/state/remote.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/codec.h"
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
/* What may differ in the file of a run that goes on without changes. */
static const char *const not_compared[] = {"title", "time", "stop", "output"};
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

/* Keeps a text in the scene's arena. */
static scree_status keep_text(const comparison *c, const char *text, const char **kept) {
  char *copy;
  if (!text) return SCREE_OK;
  SCREE_TRY_TAKE(copy, &c->scene->arena, strlen(text) + 1, c->error);
  *kept = memcpy(copy, text, strlen(text) + 1);
  return SCREE_OK;
}

/* NULL where it is not there. */
static scree_status text_of(const comparison *c, const scree_yaml *node, const char **text) {
  char *printed = NULL;
  size_t size;
  if (!node) return SCREE_OK;
  FILE *stream = scree_memory_open(&printed, &size);
  if (stream) print_node(stream, node);
  bool good = stream && scree_memory_close(stream);
  scree_status status =
      good ? keep_text(c, printed, text) : scree_fail_memory(c->error, 0, "a change");
  free(printed);
  return status;
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

static scree_status compare(comparison *c, const scree_yaml *was, const scree_yaml *is,
                            const char *path);

static scree_status compare_items(comparison *c, const scree_yaml *was, const scree_yaml *is,
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
    SCREE_TRY(compare(c, item, list ? &is->items[i] : scree_yaml_find(is, item->key), below));
  }
  for (size_t i = 0; !list && i < is->item_count; i++) {
    if (scree_yaml_find(was, is->items[i].key)) continue;
    snprintf(below, sizeof below, "%.200s%s%.90s", path, point, is->items[i].key);
    SCREE_TRY(compare(c, NULL, &is->items[i], below));
  }
  return SCREE_OK;
}

/* Lists of groups are compared one by one, others as one value. */
static scree_status compare(comparison *c, const scree_yaml *was, const scree_yaml *is,
                            const char *path) {
  if (was && is && are_alike(was, is)) return SCREE_OK;
  bool both = was && is && was->kind == is->kind;
  bool groups = both && was->kind == SCREE_YAML_SEQUENCE && was->item_count == is->item_count &&
                was->items[0].kind == SCREE_YAML_MAPPING;
  if (groups || (both && was->kind == SCREE_YAML_MAPPING)) return compare_items(c, was, is, path);
  scree_scene_change_entry change = {.time = scree_world_time(c->scene->world)};
  SCREE_TRY(keep_text(c, path, &change.field));
  SCREE_TRY(text_of(c, was, &change.was));
  SCREE_TRY(text_of(c, is, &change.is));
  return SCREE_PUSH(&c->list, change) ? SCREE_OK
                                      : scree_fail_memory(c->error, sizeof change, "changes");
}

static scree_status compare_texts(comparison *c, const char *was, const char *is) {
  SCREE_CLEANUP(scree_yaml_free) scree_yaml old = {.kind = SCREE_YAML_MAPPING};
  SCREE_CLEANUP(scree_yaml_free) scree_yaml new = {.kind = SCREE_YAML_MAPPING};
  SCREE_TRY(scree_yaml_parse(was, strlen(was), c->scene->name, &old, c->error));
  SCREE_TRY(scree_yaml_parse(is, strlen(is), c->scene->name, &new, c->error));
  return compare(c, &old, &new, "");
}

static void free_comparison(comparison *c) {
  scree_free(c->list.items);
}

scree_status scree_scene_check_same(scree_scene *scene, const char *text, const char *path,
                                    scree_error *error) {
  SCREE_CLEANUP(free_comparison) comparison c = {.scene = scene, .error = error};
  SCREE_TRY(compare_texts(&c, scene->text, text));
  for (size_t i = 0; i < c.list.count; i++) {
    const scree_scene_change_entry *d = &c.list.items[i];
    if (IS_AMONG(d->field, not_compared) && !IS_AMONG(d->field, fixed)) continue;
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "%s: is of another scene: %.150s is %.80s there and %.80s here", path,
                      d->field, d->was ? d->was : "not given", d->is ? d->is : "not given");
  }
  return SCREE_OK;
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
  size_t pieces = SCREE_SCENE_SHAPES(was) - was->named_count;
  SCREE_SCRATCH(scree_scene_piece, of, pieces, error);
  for (size_t i = 0; i < pieces; i++) {
    const scree_scene_shape *s = &was->shapes[was->named_count + i];
    of[i] = (scree_scene_piece){(uint32_t)s->assembly, s->group, s->part};
  }
  SCREE_TRY(scree_scene_append_pieces(is, of, pieces, error));
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(is); i++) {
    scree_scene_shape *from = &was->shapes[i], *to = &is->shapes[i];
    const char *part = to->part;
    *to = *from;
    to->part = part;
    to->source = scree_strdup(from->source);
    scree_particle_retain(to->particle);
    if (!to->source) return scree_fail_memory(error, strlen(from->source), "a shape");
    scree_scene_measure_shape(is, i);
    to->density = from->density;
    to->mass = from->mass;
  }
  return SCREE_OK;
}

static void take_books(const scree_scene *was, scree_scene *is) {
  is->world = was->world;
  is->gallery = was->gallery;
  is->time_step = was->time_step;
  is->tick_steps = was->tick_steps;
  is->next_tick = was->next_tick;
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

/* What a sensor has gathered, by way of a checkpoint's bytes. */
static scree_status take_coded(void (*code)(scree_codec *, scree_scene *, scree_scene_sensor *),
                               scree_scene *was, scree_scene_sensor *from, scree_scene *is,
                               scree_scene_sensor *to, scree_error *error) {
  SCREE_CLEANUP(scree_codec_free) scree_codec out = {0};
  code(&out, was, from);
  scree_codec in = {.source = out.bytes, .count = out.count, .loading = true};
  if (scree_codec_good(&out)) code(&in, is, to);
  bool good = scree_codec_good(&out) && scree_codec_good(&in);
  return good ? SCREE_OK : scree_fail_memory(error, out.count, "a sensor");
}

/* What sensors that stay as they were have gathered, and those of a kind together. */
static scree_status take_sensors(const comparison *c, scree_scene *is, scree_error *error) {
  scree_scene *was = c->scene;
  for (size_t i = 0; i < is->plan.sensors.count; i++) {
    scree_scene_sensor *to = &is->sensors[i];
    const char *name = to->plan->place.name;
    size_t k = SCREE_PLAN_FIND(was->plan.sensors, name), first = 0;
    if (k < was->plan.sensors.count && !has_changed(c, "sensors", name))
      SCREE_TRY(take_coded(scree_sensor_code, was, &was->sensors[k], is, to, error));
    while (first < was->plan.sensors.count && was->sensors[first].kind != to->kind) first++;
    if (to->leads && first < was->plan.sensors.count)
      SCREE_TRY(take_coded(scree_sensor_code_shared, was, &was->sensors[first], is, to, error));
  }
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

/* The inlets and outlets by which bodies came and went: their places now, by their names;
 * UINT32_MAX: there is none any more. */
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

/* The lists of bodies change hands. */
static void take_lists(scree_scene *was, scree_scene *is) {
  is->shape_of = was->shape_of;
  is->entered_at = was->entered_at;
  take_stays(was, is);
  was->stays.items = NULL;
  was->shape_of.items = NULL;
  was->entered_at.items = NULL;
}

/* ---- what the world must know ---- */

static scree_status set_pairs(scree_scene *scene, scree_error *error) {
  SCREE_OWNED(scree_world, fresh); /* of the new materials */
  SCREE_TRY(scree_scene_make_world(scene, scene->time_step, &fresh, error));
  size_t count = scene->plan.materials.count;
  for (size_t a = 0; a < count; a++)
    for (size_t b = a; b < count; b++) {
      scree_material_contact contact;
      SCREE_TRY(scree_world_get_pair(fresh, a, b, &contact, error));
      SCREE_TRY(scree_world_set_pair(scene->world, a, b, &contact, error));
    }
  return SCREE_OK;
}

static scree_status set_geometry(const comparison *c, scree_scene *scene, scree_error *error) {
  static const double still[3] = {0, 0, 0};
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    const scree_plan_geometry *g = &scene->plan.geometry.items[i];
    const scree_scene_geometry *made = &scene->geometry[i];
    if (!has_changed(c, "geometry", g->place.name)) continue;
    const double *surface = isnan(g->surface_velocity[0]) ? still : g->surface_velocity;
    double loop[3];
    scree_geometry_belt_loop(g, loop);
    for (size_t w = made->first_wall; w < made->first_wall + made->wall_count; w++)
      SCREE_TRY(scree_world_set_wall_surface(scene->world, w, surface, still, loop, error));
    SCREE_TRY(scree_motions_read(scene, i, c->folder, error));
    SCREE_TRY(scree_motions_set(scene, i, scene->world, error));
  }
  return scree_scene_lead_by_phase(scene, error);
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

static scree_status keep_history(comparison *c, scree_scene *is) {
  const scree_scene_change_list *lists[] = {&c->scene->changes, &c->list};
  c->scene = is;
  for (int l = 0; l < 2; l++)
    for (size_t i = 0; i < lists[l]->count; i++) {
      scree_scene_change_entry change = lists[l]->items[i];
      SCREE_TRY(keep_text(c, change.field, &change.field));
      SCREE_TRY(keep_text(c, change.was, &change.was));
      SCREE_TRY(keep_text(c, change.is, &change.is));
      if (!SCREE_PUSH(&is->changes, change))
        return scree_fail_memory(c->error, sizeof change, "changes");
    }
  return SCREE_OK;
}

static scree_status take_over(comparison *c, scree_scene *is, scree_error *error) {
  scree_scene *was = c->scene;
  SCREE_TRY(take_shapes(was, is, error));
  scree_scene_reopen(was, &is->plan);
  take_books(was, is);
  SCREE_TRY(scree_scene_complete_plan(is, error));
  SCREE_TRY(scree_sensors_begin(is, error));
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

/* One whose world is another's. */
static void free_without_world(scree_scene **scene) {
  if (*scene) (*scene)->world = (*scene)->gallery = NULL;
  scree_scene_free(*scene);
}

static scree_status change_to(scree_scene **scene, const scree_scene_file *file,
                              scree_error *error) {
  scree_scene *was = *scene;
  SCREE_CLEANUP(free_comparison)
  comparison c = {.scene = was, .folder = file->folder, .error = error};
  SCREE_CLEANUP(scree_free_at) char *text = NULL;
  SCREE_TRY(scree_scene_file_text(file, &text, error));
  SCREE_TRY(compare_texts(&c, was->text, text));
  SCREE_TRY(refuse_others(&c, error));
  if (!c.list.count) return SCREE_OK;
  SCREE_CLEANUP(free_without_world) scree_scene *is = NULL;
  SCREE_TRY_ALLOC_ZERO(is, 1, error);
  SCREE_TRY(scree_scene_take_file(is, file, error));
  SCREE_TRY(take_over(&c, is, error));
  SCREE_TRY(keep_history(&c, is));
  take_lists(was, is);
  *scene = is;
  memcpy(&is, &was, sizeof is); /* the old one ends with the block */
  return SCREE_OK;
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
  SCREE_CLEANUP(scree_yaml_free) scree_yaml over = {0};
  SCREE_TRY(scree_yaml_read(path, &over, error));
  if (over.kind != SCREE_YAML_MAPPING)
    return scree_fail(error, SCREE_BAD_FILE, "%s: changes are `key: value` lines", path);
  SCREE_CLEANUP(scree_free_at) char *name = scree_strdup(path);
  if (!name) return scree_fail_memory(error, strlen(path), path);
  char *kept = file->name;
  file->name = name;
  scree_status status = scree_yaml_merge(&file->root, &over, error);
  if (status == SCREE_OK) status = scree_scene_file_check(file, error);
  file->name = kept;
  return status;
}

scree_status scree_scene_change(scree_scene **scene, const char *const *changes, size_t count,
                                scree_error *error) {
  SCREE_OWNED(scree_scene_file, file);
  const char *text = (*scene)->text;
  if ((*scene)->is_frame)
    return scree_fail(error, SCREE_UNSUPPORTED, "a frame has no contacts: nothing goes on from it");
  SCREE_TRY(scree_scene_file_parse(text, strlen(text), (*scene)->name, &file, error));
  for (size_t i = 0; i < count; i++) {
    const char *equals = strchr(changes[i], '=');
    scree_status status =
        equals ? apply_field(file, changes[i], equals, error) : apply_file(file, changes[i], error);
    bool others_may_mend = status == SCREE_BAD_FILE && equals && i + 1 < count;
    if (!others_may_mend) SCREE_TRY(status);
  }
  SCREE_TRY(scree_scene_file_check(file, error));
  return change_to(scene, file, error);
}

size_t scree_scene_change_count(const scree_scene *scene) {
  return scene->changes.count;
}
scree_scene_change_entry scree_scene_change_at(const scree_scene *scene, size_t index) {
  return scene->changes.items[index];
}
