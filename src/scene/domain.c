/* The domain of a scene that names none: the box of all that it has, geometry where it stands now,
 * inlets, bodies of its table, outlets and where sensors look, and as much again on every side.
 * What has left that has fallen past all of it and would fall for ever. Planes and endless
 * cylinders have no end along themselves, and layers none upwards. */
#include "scene/region.h"
#include "scene/scene.h"

#include "world/state/world.h"

static const double least_margin = 10; /* of the largest body's radius */

static void take_in(scree_scene_reach *reach, const double low[3], const double high[3]) {
  for (int k = 0; k < 3; k++) {
    reach->low[k] = fmin(reach->low[k], low[k]);
    reach->high[k] = fmax(reach->high[k], high[k]);
  }
}

/* A circle about the axis through p; along an axis of space it reaches out by so much. */
static void take_in_circle(scree_scene_reach *reach, vec3 p, vec3 axis, double radius) {
  const double n[3] = {axis.x, axis.y, axis.z}, at[3] = {p.x, p.y, p.z};
  double low[3], high[3];
  for (int k = 0; k < 3; k++) {
    double aside = radius > 0 ? radius * sqrt(fmax(0, 1 - n[k] * n[k])) : 0;
    low[k] = at[k] - aside;
    high[k] = at[k] + aside;
  }
  take_in(reach, low, high);
}

/* The reach is endless along the axes for which it is not at right angles to `axis` (planes: but
 * for that axis). */
static void take_in_endless(scree_scene_reach *reach, vec3 axis, bool plane) {
  const double n[3] = {axis.x, axis.y, axis.z};
  for (int k = 0; k < 3; k++) {
    bool goes_on = plane ? fabs(n[k]) < 1 - 1e-12 : fabs(n[k]) > 1e-12;
    if (!goes_on) continue;
    reach->low[k] = -INFINITY;
    reach->high[k] = INFINITY;
  }
}

void scree_scene_take_in_wall(const scree_scene *scene, size_t index, scree_scene_reach *reach) {
  scree_wall wall;
  scree_world_get_wall(scene->world, index, &wall);
  vec3 at = vec3_load(wall.position), axis = vec3_unit(vec3_load(wall.axis));
  if (wall.kind == SCREE_WALL_MESH) {
    const scree_world_wall *w = scree_world_wall_at(scene->world, index);
    scree_box box = scree_box_moved(&w->surface->box, &w->frame.rotation, w->frame.position);
    const double low[3] = {box.low.x, box.low.y, box.low.z},
                 high[3] = {box.high.x, box.high.y, box.high.z};
    take_in(reach, low, high);
    return;
  }
  take_in_circle(reach, at, axis, wall.kind == SCREE_WALL_PLANE ? 0 : wall.radius);
  if (wall.kind == SCREE_WALL_CYLINDER)
    take_in_circle(reach, vec3_mad(at, axis, wall.length), axis, wall.radius);
  if (wall.kind == SCREE_WALL_PLANE || (wall.kind == SCREE_WALL_CYLINDER && wall.length == 0))
    take_in_endless(reach, axis, wall.kind == SCREE_WALL_PLANE);
}

static scree_scene_reach reach_of(const scree_scene *scene) {
  scree_scene_reach reach = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  const scree_plan *plan = &scene->plan;
  double low[3], high[3];
  for (size_t w = 0; w < scree_world_wall_count(scene->world); w++)
    scree_scene_take_in_wall(scene, w, &reach);
  for (size_t i = 0; i < plan->inlets.count; i++) {
    const scree_plan_inlet *inlet = &plan->inlets.items[i];
    if (inlet->layers && inlet->layers->in) { /* that geometry is taken in already */
      reach.high[2] = INFINITY;
      continue;
    }
    scree_region_bounds(&SCREE_REGION_OF(inlet), low, high);
    if (inlet->layers) high[2] = INFINITY;
    take_in(&reach, low, high);
  }
  return reach;
}

scree_scene_reach scree_scene_domain(const scree_scene *scene) {
  const scree_plan *plan = &scene->plan;
  scree_scene_reach reach = reach_of(scene);
  double margin = 0, low[3], high[3];
  take_in(&reach, scene->table_low, scene->table_high);
  for (size_t i = 0; i < plan->outlets.count; i++) {
    const scree_plan_box *box = plan->outlets.items[i].box;
    take_in(&reach, box->min, box->max);
  }
  for (size_t i = 0; i < plan->sensors.count; i++)
    if (scree_sensor_reach(&plan->sensors.items[i], low, high)) take_in(&reach, low, high);
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++)
    margin = fmax(margin, least_margin * scene->shapes[i].extent.radius);
  for (int k = 0; k < 3; k++)
    if (isfinite(reach.high[k] - reach.low[k])) margin = fmax(margin, reach.high[k] - reach.low[k]);
  for (int k = 0; k < 3; k++) {
    reach.low[k] -= margin;
    reach.high[k] += margin;
  }
  return reach;
}
