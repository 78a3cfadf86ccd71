/* What a scene leaves out and what then follows from its particles: how wide a container is that is
 * filled by layers, how high these begin, how far a pile is measured. All of it follows from the
 * file and the particles, so that it is the same after loading a checkpoint. */
#include "scene/geometry.h"
#include "scene/scene.h"

#include "base/math.h"

static const double pi = 3.14159265358979;
static const double loose_packing = 0.30;    /* solid fraction of what has been poured */
static const double cell_share = 1.02;       /* of the largest body's diameter: a grid's pitch */
static const double clearance_share = 0.005; /* of a body's size, kept free on each side */
static const double most_abreast = 3;        /* bodies, in a width that is not given */

static const scree_plan_geometry *geometry_named(const scree_scene *scene, const char *name) {
  size_t index = SCREE_PLAN_FIND(scene->plan.geometry, name);
  return &scene->plan.geometry.items[index];
}

static scree_particle_measures measures_of(const scree_scene *scene, const scree_scene_inlet *inlet,
                                           size_t which) {
  scree_particle_measures m;
  scree_particle_measure(scene->shapes[inlet->shapes[which]].particle, &m);
  return m;
}

/* ---- what an inlet pours ---- */

/* Order of entering; mean size and volume of all in that order. */
static scree_status measure_layers(scree_scene *scene, scree_scene_inlet *inlet,
                                   scree_error *error) {
  scree_scene_layers *l = &inlet->layers;
  size_t count = inlet->plan->count, shapes = inlet->plan->shapes.count;
  SCREE_TRY_TAKE(l->order, &scene->arena, count, error);
  SCREE_TRY(scree_fill_order(scene->plan.seed + (uint64_t)(inlet - scene->inlets),
                             inlet->plan->shapes.values, shapes, l->order, count, error));
  for (size_t i = 0; i < count; i++) {
    scree_particle_measures m = measures_of(scene, inlet, l->order[i]);
    l->solid += m.volume;
    l->size += m.size / (double)count;
  }
  double given = inlet->plan->layers->clearance, largest = 0;
  l->clearance = isnan(given) ? clearance_share * l->size : given;
  for (size_t k = 0; k < shapes; k++)
    largest = fmax(largest, measures_of(scene, inlet, k).bounding_radius);
  l->pitch = 2 * cell_share * largest;
  return SCREE_OK;
}

/* A container is about as wide as the heap will be high, and with room for some abreast. */
static double usual_width(const scree_scene *scene, const scree_scene_inlet *inlet, bool round) {
  double solid = 0, count = (double)inlet->plan->count;
  for (size_t k = 0; k < inlet->plan->shapes.count; k++) {
    double volume = measures_of(scene, inlet, k).volume;
    for (size_t i = 0; i < inlet->plan->count; i++)
      if (inlet->layers.order[i] == k) solid += volume;
  }
  double abreast = fmin(most_abreast, ceil(scree_cbrt(count)));
  return fmax(scree_cbrt(solid / loose_packing * (round ? 4 / 3.14159265358979323846 : 1)),
              (round ? abreast + 0.5 : abreast) * inlet->layers.pitch);
}

/* ---- where its layers begin ---- */

static void place_layers(const scree_scene *scene, scree_scene_inlet *inlet) {
  const scree_plan_layers *plan = inlet->plan->layers;
  scree_scene_layers *l = &inlet->layers;
  const scree_plan_cylinder *c = inlet->plan->cylinder;
  const scree_plan_box *b = inlet->plan->box;
  if (c) {
    l->middle = vec3_load(c->at);
    l->radius = c->radius;
    return;
  }
  if (b) {
    l->middle = (vec3){0.5 * (b->min[0] + b->max[0]), 0.5 * (b->min[1] + b->max[1]), b->min[2]};
    l->half[0] = 0.5 * (b->max[0] - b->min[0]);
    l->half[1] = 0.5 * (b->max[1] - b->min[1]);
    return;
  }
  const scree_plan_geometry *g = geometry_named(scene, plan->in);
  const scree_container in = scree_geometry_container(g);
  const bool round = !in.depth;
  if (isnan(*in.width)) *in.width = (round ? 0.5 : 1) * usual_width(scene, inlet, round);
  if (!round && isnan(*in.depth)) *in.depth = *in.width;
  l->radius = round ? *in.width : 0;
  l->half[0] = round ? 0 : 0.5 * *in.width;
  l->half[1] = round ? 0 : 0.5 * *in.depth;
  double loose = round ? loose_packing * pi * l->radius * l->radius
                       : loose_packing * 4 * l->half[0] * l->half[1];
  double bottom = isnan(plan->bottom) ? plan->above : plan->bottom;
  if (plan->begin) bottom = l->solid / loose + plan->above;
  if (plan->packed) bottom = fmax(bottom, (cell_share - 1) * l->pitch);
  l->middle = vec3_load(g->at);
  l->middle.z += bottom;
}

/* ---- all of it ---- */

scree_status scree_scene_complete_plan(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    scree_scene_inlet *inlet = &scene->inlets[i];
    if (!inlet->plan->layers) continue;
    SCREE_TRY(measure_layers(scene, inlet, error));
    place_layers(scene, inlet);
  }
  return scree_sensors_complete(scene, error);
}
