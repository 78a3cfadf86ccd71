/* What records of a scene must be to each other: names that others refer to, regions within the
 * domain, what a periodic domain allows. */
#include "scene/plan.h"

#include "base/vec.h"

#include <string.h>

/* A name that another record must have. */
static scree_status need_name(const scree_reader *r, const scree_place *place, const void *items,
                              size_t item_count, size_t size, const char *what, const char *name) {
  const char *names[64] = {NULL};
  size_t count = 0;
  if (scree_plan_find(items, item_count, size, name) < item_count) return SCREE_OK;
  for (; count < item_count && count < 64; count++)
    names[count] = ((const scree_place *)(const void *)((const char *)items + count * size))->name;
  return scree_fail_name(r, place, what, name, names, count);
}

#define NEED(list, what, name, place)                                                              \
  need_name(r, place, plan->list.items, plan->list.count, sizeof *plan->list.items, what, name)

static bool are_same(const scree_texts *a, const scree_texts *b) {
  bool crossed = strcmp(a->items[0], b->items[0]) != 0;
  return !strcmp(a->items[0], b->items[crossed]) && !strcmp(a->items[1], b->items[!crossed]);
}

static scree_status check_material(const scree_reader *r, const scree_plan *plan,
                                   const scree_place *place, const char *material) {
  if (material) return NEED(materials, "material", material, place);
  if (plan->materials.count < 2) return SCREE_OK;
  return scree_fail_place(r, place, "needs a material: there are several");
}

static scree_status check_materials(const scree_reader *r, const scree_plan *plan) {
  for (size_t i = 0; i < plan->pairs.count; i++) {
    const scree_plan_pair *p = &plan->pairs.items[i];
    for (size_t k = 0; k < 2; k++)
      SCREE_TRY(NEED(materials, "material", p->between.items[k], &p->place));
    for (size_t k = 0; k < i; k++)
      if (are_same(&p->between, &plan->pairs.items[k].between))
        return scree_fail_place(r, &p->place, "'%.60s' and '%.60s' are a pair already",
                                p->between.items[0], p->between.items[1]);
  }
  for (size_t i = 0; i < plan->shapes.count; i++)
    SCREE_TRY(
        check_material(r, plan, &plan->shapes.items[i].place, plan->shapes.items[i].material));
  for (size_t i = 0; i < plan->geometry.count; i++)
    SCREE_TRY(
        check_material(r, plan, &plan->geometry.items[i].place, plan->geometry.items[i].material));
  return SCREE_OK;
}

static scree_status check_inside(const scree_reader *r, const scree_plan *plan,
                                 const scree_plan_inlet *inlet) {
  const scree_plan_domain *d = plan->domain;
  if (!d || (inlet->layers && inlet->layers->in)) return SCREE_OK;
  double low[3], high[3];
  for (int k = 0; k < 3; k++) {
    const scree_plan_cylinder *c = inlet->cylinder;
    low[k] = c ? c->at[k] : inlet->box->min[k];
    high[k] = c ? c->at[k] : inlet->box->max[k];
    if (inlet->layers && k == 2) high[k] = low[k];
    if (low[k] < d->min[k] || high[k] > d->max[k])
      return scree_fail_place(r, &inlet->place,
                              "lies outside the domain along %c: what enters would leave at once",
                              "xyz"[k]);
  }
  return SCREE_OK;
}

/* Layers in a geometry; what has no width of its own needs such. */
static scree_status check_containers(const scree_reader *r, const scree_plan *plan) {
  for (size_t i = 0; i < plan->inlets.count; i++) {
    const scree_plan_layers *l = plan->inlets.items[i].layers;
    if (!l || !l->in) continue;
    SCREE_TRY(NEED(geometry, "geometry", l->in, &l->place));
    size_t index = SCREE_PLAN_FIND(plan->geometry, l->in);
    const scree_plan_geometry *g = &plan->geometry.items[index];
    bool upright = g->cylinder && g->cylinder->axis[0] == 0 && g->cylinder->axis[1] == 0;
    if ((!upright && !g->shaft) || g->turn)
      return scree_fail_place(r, &l->place, "in '%.60s': must be a cylinder along z or a shaft",
                              l->in);
  }
  for (size_t i = 0; i < plan->geometry.count; i++) {
    const scree_plan_geometry *g = &plan->geometry.items[i];
    bool open = (g->cylinder && isnan(g->cylinder->radius)) || (g->shaft && isnan(g->shaft->width));
    for (size_t k = 0; open && k < plan->inlets.count; k++) {
      const scree_plan_layers *l = plan->inlets.items[k].layers;
      if (l && l->in && !strcmp(l->in, g->place.name)) open = false;
    }
    if (open)
      return scree_fail_place(r, g->cylinder ? &g->cylinder->place : &g->shaft->place,
                              "needs a %s: no inlet fills it by layers",
                              g->cylinder ? "radius" : "width");
  }
  return SCREE_OK;
}

static scree_status check_inlets(const scree_reader *r, const scree_plan *plan) {
  for (size_t i = 0; i < plan->inlets.count; i++) {
    const scree_plan_inlet *inlet = &plan->inlets.items[i];
    for (size_t k = 0; k < inlet->shapes.count; k++)
      SCREE_TRY(NEED(shapes, "shape", inlet->shapes.names[k], &inlet->place));
    SCREE_TRY(check_inside(r, plan, inlet));
    if (inlet->layers && plan->gravity[2] > 0)
      return scree_fail_place(r, &inlet->layers->place, "layers need a gravity that points down");
  }
  return SCREE_OK;
}

static scree_status check_outlets(const scree_reader *r, const scree_plan *plan) {
  const scree_plan_domain *d = plan->domain;
  for (size_t i = 0; d && i < plan->outlets.count; i++) {
    const scree_plan_outlet *o = &plan->outlets.items[i];
    for (int k = 0; k < 3; k++)
      if (o->box->min[k] >= d->max[k] || o->box->max[k] <= d->min[k])
        return scree_fail_place(
            r, &o->place, "lies outside the domain along %c: nothing ever gets there", "xyz"[k]);
  }
  return SCREE_OK;
}

static bool is_along(const double *v, const double *g) {
  vec3 a = vec3_load(v), b = vec3_load(g);
  return vec3_norm(vec3_cross(a, b)) <= 1e-6 * vec3_norm(a) * vec3_norm(b);
}

static scree_status check_sensors(const scree_reader *r, const scree_plan *plan) {
  for (size_t i = 0; i < plan->sensors.count; i++) {
    const scree_plan_sensor *s = &plan->sensors.items[i];
    if (s->grid && s->grid->with)
      SCREE_TRY(NEED(geometry, "geometry", s->grid->with, &s->grid->place));
    const char *of = s->wall ? s->wall : s->part ? s->part : s->position;
    if (of) SCREE_TRY(NEED(geometry, "geometry", of, &s->place));
    if (s->part) {
      const scree_plan_geometry *g =
          &plan->geometry.items[SCREE_PLAN_FIND(plan->geometry, s->part)];
      if (!g->slide && !g->hinge)
        return scree_fail_place(r, &s->place, "'%.60s' has neither slide nor hinge", s->part);
    }
    for (size_t k = 0; s->pile && k < s->pile->during.count; k++)
      SCREE_TRY(NEED(phases, "phase", s->pile->during.items[k], &s->pile->place));
    if (s->residence && s->residence->inlet)
      SCREE_TRY(NEED(inlets, "inlet", s->residence->inlet, &s->residence->place));
    if (s->residence && s->residence->outlet)
      SCREE_TRY(NEED(outlets, "outlet", s->residence->outlet, &s->residence->place));
    if (s->slope && is_along(s->slope->axis, plan->gravity))
      return scree_fail_place(r, &s->place,
                              "axis along gravity: from above a surface has no slope");
    if (s->segregation && plan->shapes.count < 2 && !plan->shapes.items[0].size)
      return scree_fail_place(r, &s->place, "segregation needs two shapes at least");
  }
  return SCREE_OK;
}

/* Each acts on shapes or materials that there are. */
static scree_status check_forces(const scree_reader *r, const scree_plan *plan) {
  for (size_t i = 0; i < plan->forces.count; i++) {
    const scree_plan_force *f = &plan->forces.items[i];
    for (size_t k = 0; k < f->of.count; k++) {
      const char *name = f->of.items[k];
      if (SCREE_PLAN_FIND(plan->materials, name) == plan->materials.count)
        SCREE_TRY(NEED(shapes, "shape or material", name, &f->place));
    }
  }
  return SCREE_OK;
}

static scree_status check_phases(const scree_reader *r, const scree_plan *plan) {
  for (size_t i = 0; i < plan->phases.count; i++) {
    const scree_plan_phase *p = &plan->phases.items[i];
    if (p->clear) SCREE_TRY(NEED(geometry, "geometry", p->clear, &p->place));
  }
  for (size_t i = 0; i < plan->geometry.count; i++) {
    const scree_plan_geometry *g = &plan->geometry.items[i];
    const scree_plan_motion *m = g->motion.items;
    if (g->motion.count && m->during) SCREE_TRY(NEED(phases, "phase", m->during, &m->place));
  }
  return SCREE_OK;
}

/* What turns does not look the same one period on. */
static scree_status check_periodic(const scree_reader *r, const scree_plan *plan) {
  if (!plan->domain || plan->domain->periodic.count == 0) return SCREE_OK;
  for (size_t i = 0; i < plan->geometry.count; i++) {
    const scree_plan_geometry *g = &plan->geometry.items[i];
    const scree_plan_motion *m = g->motion.items;
    if (g->slide || g->hinge)
      return scree_fail_place(r, &g->place, "in a periodic domain nothing moves by forces");
    bool fits = (!isnan(g->plane[0]) || (g->cylinder && g->cylinder->length == 0)) && !g->turn;
    if (!fits)
      return scree_fail_place(r, &g->place,
                              "in a periodic domain geometry must go on across its boundary: a "
                              "plane along the axis, or an endless cylinder about it");
    for (size_t k = 0; k < g->motion.count; k++)
      if (m[k].rotate && !g->cylinder)
        return scree_fail_place(r, &m[k].place, "in a periodic domain planes do not rotate");
  }
  return SCREE_OK;
}

scree_status scree_plan_check(const scree_reader *r, const void *record) {
  const scree_plan *plan = record;
  bool ends = plan->phases.count || (plan->stop && !isnan(plan->stop->filled));
  if (isnan(plan->time) && !ends)
    return scree_fail_place(r, &plan->place, "needs time: how many seconds to simulate");
  if (plan->materials.count > 64)
    return scree_fail_place(r, &plan->place, "%zu materials: at most 64", plan->materials.count);
  if (plan->shapes.count == 0)
    return scree_fail_place(r, &plan->place, "needs shapes: {name: {file: ...}}");
  if (plan->inlets.count == 0 && !plan->bodies)
    return scree_fail_place(r, &plan->place, "needs inlets or bodies: nothing would ever be in it");
  SCREE_TRY(check_materials(r, plan));
  SCREE_TRY(check_inlets(r, plan));
  SCREE_TRY(check_containers(r, plan));
  SCREE_TRY(check_outlets(r, plan));
  SCREE_TRY(check_phases(r, plan));
  SCREE_TRY(check_forces(r, plan));
  SCREE_TRY(check_periodic(r, plan));
  return check_sensors(r, plan);
}
