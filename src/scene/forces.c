/* Forces on bodies through their centres, from step to step, booked as work that is done on them.
 *
 * Drag is that of a sphere of equal volume, of diameter d, in a fluid that moves by v relative to
 * it, Re = density |v| d/viscosity:
 *
 *     F = 3 pi viscosity d f v,   f = 1 (Stokes 1851),
 *     f = 1 + 0.15 Re^0.687 up to Re = 1000, 0.44 Re/24 from there on (Schiller and Naumann 1933)
 *
 * as far as a body takes two steps at least to come to the fluid's speed. Buoyancy is the weight of
 * the fluid that it displaces. */
#include "scene/region.h"
#include "scene/scene.h"

#include "base/math.h"
#include "base/table.h"

#include <string.h>

static const double pi = 3.14159265358979323846, newton_from = 1000;

static const scree_plan_force *plan_of(const scree_scene *scene, size_t index) {
  return &scene->plan.forces.items[index];
}

/* ---- on whom ---- */

static const char *family_of(const scree_scene *scene, size_t shape) {
  size_t family = scene->plan.shapes.items[shape].family;
  return scene->plan.families.items[family].place.name;
}

static bool acts_on(const scree_scene *scene, const scree_plan_force *f, size_t shape) {
  const scree_plan_shape *plan = &scene->plan.shapes.items[shape];
  for (size_t i = 0; i < f->of.count; i++)
    if (!strcmp(f->of.items[i], family_of(scene, shape)) ||
        (plan->material && !strcmp(f->of.items[i], plan->material)))
      return true;
  return f->of.count == 0;
}

scree_status scree_scene_plan_forces(scree_scene *scene, scree_error *error) {
  const size_t forces = scene->plan.forces.count, shapes = SCREE_SCENE_SHAPES(scene);
  scene->acts_on = scree_arena_take(&scene->arena, forces * shapes + 1, 1);
  if (!scene->acts_on) return scree_fail_memory(error, forces * shapes, "forces");
  for (size_t i = 0; i < forces * shapes; i++)
    scene->acts_on[i] = acts_on(scene, plan_of(scene, i / shapes), i % shapes);
  return SCREE_OK;
}

static double factor_of(const scree_plan_force *f, vec3 p, double time) {
  const double at[] = {p.x, p.y, p.z, time};
  if (f->table.count == 0) return 1;
  const scree_rows lines = {f->table.items[0], 2, f->table.count};
  double slope;
  return scree_rows_at(&lines, at[f->by], &slope);
}

/* ---- how much ---- */

static vec3 drag_of(const scree_scene *scene, const scree_plan_drag *d, const scree_scene_shape *s,
                    vec3 flow) {
  double size = s->particle->measures.size, reynolds = 0, factor = 1;
  if (d->law == 0) reynolds = d->density * vec3_norm(flow) * size / d->viscosity;
  if (reynolds > newton_from)
    factor = 0.44 / 24 * reynolds;
  else if (reynolds > 0)
    factor = 1 + 0.15 * scree_exp(0.687 * scree_log(reynolds));
  double rate = fmin(3 * pi * d->viscosity * size * factor, 0.5 * s->mass / scene->time_step);
  vec3 lift = vec3_scale(vec3_load(scene->plan.gravity), d->buoyancy ? -d->density * s->volume : 0);
  return vec3_mad(lift, flow, rate);
}

static vec3 force_of(const scree_scene *scene, size_t index, size_t shape, const scree_body *body) {
  const scree_plan_force *f = plan_of(scene, index);
  const scree_scene_shape *s = &scene->shapes[shape];
  vec3 p = vec3_load(body->position), none = {0, 0, 0};
  double time = scree_world_time(scene->world);
  if (time < f->from || time > f->until ||
      !scene->acts_on[index * SCREE_SCENE_SHAPES(scene) + shape] ||
      !scree_region_has(&SCREE_REGION_OF(f), p))
    return none;
  double factor = factor_of(f, p, time);
  if (!f->drag) {
    const double *v = f->force;
    if (!isnan(f->acceleration[0])) v = f->acceleration, factor *= s->mass;
    if (!isnan(f->per_volume[0])) v = f->per_volume, factor *= s->volume;
    return vec3_scale(vec3_load(v), factor);
  }
  vec3 flow = vec3_sub(vec3_scale(vec3_load(f->drag->velocity), factor), vec3_load(body->velocity));
  return drag_of(scene, f->drag, s, flow);
}

scree_status scree_scene_apply_forces(scree_scene *scene, scree_error *error) {
  static const double none[3] = {0, 0, 0};
  scree_status status = SCREE_OK;
  scree_body body;
  for (size_t b = 0; status == SCREE_OK && scree_scene_next_body(scene, &b, &body); b++) {
    double sum[3];
    vec3 force = {0, 0, 0};
    for (size_t i = 0; i < scene->plan.forces.count; i++)
      force = vec3_add(force, force_of(scene, i, scene->shape_of.items[b], &body));
    vec3_store(sum, force);
    status = scree_world_set_body_force(scene->world, b, sum, none, error);
  }
  return status;
}
