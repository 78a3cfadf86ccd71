/* A scene as it stands: names, books, classes of bodies, and what is wrong with what its file has.
 * It calls nothing that makes a scene or goes on with it. */
#include "scene/scene.h"

#include "base/alloc.h"

#include <stdarg.h>
#include <string.h>

scree_status scree_scene_fail(const scree_scene *scene, const scree_place *place,
                              scree_error *error, const char *format, ...) {
  scree_reader r = {scene->name, NULL, error, ""};
  char text[sizeof error->message];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return scree_fail_place(&r, place, "%s", text);
}

scree_status scree_scene_blame(const scree_scene *scene, const scree_place *place,
                               scree_status status, const scree_error *why, scree_error *error) {
  if (status == SCREE_OK) return status;
  if (status != SCREE_OUT_OF_MEMORY && status != SCREE_CANCELLED)
    scree_scene_fail(scene, place, error, "%s", why->message);
  else if (error)
    *error = *why;
  return status;
}

/* What a file's name means: beside the scene's file, unless it begins at the root. */
char *scree_scene_path(const char *folder, const char *name) {
  size_t size = strlen(folder) + strlen(name) + 1;
  char *path = scree_alloc(size, 1);
  if (path) snprintf(path, size, "%s%s", *name == '/' ? "" : folder, name);
  return path;
}

scree_placement scree_placement_of(const scree_particle *p, double more) {
  return (scree_placement){.radius = p->measures.bounding_radius + more,
                           .box_centre = vec3_lerp(p->box.low, p->box.high, 0.5),
                           .half = vec3_add(vec3_scale(vec3_sub(p->box.high, p->box.low), 0.5),
                                            (vec3){more, more, more})};
}

const char *scree_scene_shape_name(const scree_scene *scene, size_t index) {
  return SCREE_PLAN_NAME(scene->plan.shapes, index);
}

const char *scree_scene_geometry_name(const scree_scene *scene, size_t index) {
  return SCREE_PLAN_NAME(scene->plan.geometry, index);
}

const char *scree_scene_inlet_name(const scree_scene *scene, size_t index) {
  return SCREE_PLAN_NAME(scene->plan.inlets, index);
}

const char *scree_scene_outlet_name(const scree_scene *scene, size_t index) {
  return SCREE_PLAN_NAME(scene->plan.outlets, index);
}

size_t scree_scene_body_shape(const scree_scene *scene, size_t index) {
  return scene->shape_of.items[index];
}

size_t scree_scene_wall_geometry(const scree_scene *scene, size_t index) {
  size_t g = 0;
  while (index >= scene->geometry[g].first_wall + scene->geometry[g].wall_count) g++;
  return g;
}

/* What is there and was dissipated, less what came in and was done; of parts that forces move
 * likewise. */
static double missing_energy(const scree_scene *scene, const scree_observation *o) {
  double is = o->kinetic + o->rotational + o->potential + o->elastic + o->dissipated_dashpot +
              o->dissipated_friction + o->fracture;
  double should = scene->entered_energy - scene->left_energy + o->wall_work + o->applied_work;
  return is + scree_scene_parts_balance(scene) - should;
}

double scree_scene_missing_energy(const scree_scene *scene) {
  scree_observation o;
  scree_world_observe(scene->world, &o);
  return missing_energy(scene, &o);
}

void scree_scene_get_book(const scree_scene *scene, scree_scene_book *book) {
  scree_observation o;
  scree_world_observe(scene->world, &o);
  scree_scene_book b = {.left_count = scene->left_count,
                        .entered_mass = scene->entered_mass,
                        .left_mass = scene->left_mass,
                        .entered_energy = scene->entered_energy,
                        .left_energy = scene->left_energy};
  for (size_t i = 0; i < scene->plan.inlets.count; i++) b.waiting_count += scene->inlets[i].waiting;
  for (size_t i = 0; i < scene->named_count; i++) b.entered_count += scene->shapes[i].entered;
  for (size_t i = 0; i < scene->shape_of.count; i++)
    if (!scree_world_body_removed(scene->world, i)) {
      b.inside_count += scree_scene_counts(scene, i);
      b.inside_mass += scree_world_body_mass(scene->world, i);
    }
  double missing = missing_energy(scene, &o);
  double turned = o.dissipated_dashpot + o.dissipated_friction + o.fracture + o.kinetic +
                  o.rotational + o.elastic + fabs(o.wall_work) + fabs(o.applied_work) +
                  scree_scene_parts_turned(scene);
  b.ledger = turned > 0 ? missing / turned : 0;
  *book = b;
}

static const char *material_name(const scree_scene *scene, size_t index) {
  const bool named = index < scene->plan.materials.count;
  return named ? scene->plan.materials.items[index].place.name : NULL;
}

bool scree_scene_get_hardening(const scree_scene *scene, size_t index,
                               scree_scene_hardening *hardening) {
  const size_t count = scene->plan.materials.count ? scene->plan.materials.count : 1;
  for (size_t a = 0; a < count; a++)
    for (size_t b = a; b < count; b++) {
      const scree_world_hardening h = scree_world_get_hardening(scene->world, a, b);
      if (h.count == 0 || index-- > 0) continue;
      *hardening = (scree_scene_hardening){material_name(scene, a), material_name(scene, b),
                                           h.count, h.deepest, h.stiffness_missing};
      return true;
    }
  return false;
}

size_t scree_scene_class_count(const scree_scene *scene, int by) {
  size_t materials = scene->plan.materials.count;
  return by == SCREE_BY_SIZE    ? scene->named_count
         : by == SCREE_BY_SHAPE ? scene->plan.families.count
         : materials            ? materials
                                : 1;
}

size_t scree_scene_class_of(const scree_scene *scene, int by, size_t shape) {
  const scree_scene_shape *s = &scene->shapes[shape];
  return by == SCREE_BY_SIZE    ? scree_scene_named(scene, shape)
         : by == SCREE_BY_SHAPE ? s->family
                                : s->material;
}

const char *scree_scene_class_name(const scree_scene *scene, int by, size_t index) {
  const scree_plan *plan = &scene->plan;
  if (by == SCREE_BY_SIZE) return scree_scene_shape_name(scene, index);
  if (by == SCREE_BY_SHAPE) return plan->families.items[index].place.name;
  if (plan->materials.count == 0) return "bodies";
  return plan->materials.items[index].place.name;
}

bool scree_scene_is_in_phase(const scree_scene *scene, const scree_texts *names) {
  const scree_plan_phase *phase = NULL;
  if (scene->phase < scene->plan.phases.count) phase = &scene->plan.phases.items[scene->phase];
  if (names->count == 0) return true;
  for (size_t i = 0; phase && i < names->count; i++)
    if (!strcmp(names->items[i], phase->place.name)) return true;
  return false;
}
