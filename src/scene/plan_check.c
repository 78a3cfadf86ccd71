/* What records of a scene must be to each other: names that others refer to, regions within the
 * domain, what a periodic domain allows. */
#include "scene/geometry.h"

#include <string.h>

#define NEED(list, what, name, place) SCREE_PLAN_NEED(r, plan, list, what, name, place)

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
  for (size_t i = 0; i < plan->shapes.count; i++) {
    const scree_plan_shape *s = &plan->shapes.items[i];
    SCREE_TRY(check_material(r, plan, &s->place, s->material));
    for (size_t k = 0; k < s->parts.count; k++)
      if (s->parts.items[k].material)
        SCREE_TRY(check_material(r, plan, &s->parts.items[k].place, s->parts.items[k].material));
  }
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
    if (!scree_geometry_container(g).upright || g->turn)
      return scree_fail_place(r, &l->place, "in '%.60s': must be a cylinder along z or a shaft",
                              l->in);
  }
  for (size_t i = 0; i < plan->geometry.count; i++) {
    const scree_plan_geometry *g = &plan->geometry.items[i];
    const scree_container c = scree_geometry_container(g);
    bool open = c.width && isnan(*c.width);
    for (size_t k = 0; open && k < plan->inlets.count; k++) {
      const scree_plan_layers *l = plan->inlets.items[k].layers;
      if (l && l->in && !strcmp(l->in, g->place.name)) open = false;
    }
    if (open) return scree_fail_place(r, c.place, "needs a %s: no inlet fills it by layers", c.key);
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

/* Fails unless each force acts on shapes or materials that there are. */
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
  if (plan->domain && plan->domain->periodic.count)
    SCREE_TRY(scree_geometry_check_periodic(r, plan));
  return scree_plan_check_sensors(r, plan);
}
