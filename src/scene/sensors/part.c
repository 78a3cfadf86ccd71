/* A geometry that forces move: where it is on its way, and the energies of its drive. */
#include "scene/sensors/sensor.h"

static const char *geometry(const scree_plan_sensor *plan) {
  return plan->part;
}

static const scree_plan_geometry *geometry_of(const scree_plan *plan, const char *name) {
  return &plan->geometry.items[SCREE_PLAN_FIND(plan->geometry, name)];
}

static scree_status check(const scree_reader *r, const scree_plan *plan,
                          const scree_plan_sensor *s) {
  const scree_plan_geometry *g = geometry_of(plan, s->part);
  if (g->slide || g->hinge) return SCREE_OK;
  return scree_fail_place(r, &s->place, "'%.60s' has neither slide nor hinge", s->part);
}

static const scree_sensor_column *columns_of(const scree_scene *scene,
                                             const scree_scene_sensor *sensor) {
  static const scree_sensor_column slide[] = {{"way", "m", SCREE_OF_ALL},
                                              {"speed", "m/s", SCREE_OF_ALL},
                                              {"force", "N", SCREE_OF_ALL},
                                              {"energy", "J", SCREE_OF_ALL},
                                              {"work", "J", SCREE_OF_ALL},
                                              {"lost", "J", SCREE_OF_ALL},
                                              {0}};
  static const scree_sensor_column hinge[] = {{"way", "rad", SCREE_OF_ALL},
                                              {"speed", "rad/s", SCREE_OF_ALL},
                                              {"force", "N m", SCREE_OF_ALL},
                                              {"energy", "J", SCREE_OF_ALL},
                                              {"work", "J", SCREE_OF_ALL},
                                              {"lost", "J", SCREE_OF_ALL},
                                              {0}};
  return scene->plan.geometry.items[sensor->geometry].hinge ? hinge : slide;
}

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  const scree_scene_part *part = scene->geometry[sensor->geometry].part;
  (void)now, (void)error;
  at[0] = part->way;
  at[1] = part->speed;
  at[2] = scree_scene_push(scene, sensor->geometry);
  at[3] = scree_scene_part_energy(scene, sensor->geometry);
  at[4] = part->work;
  at[5] = part->lost;
  return SCREE_OK;
}

const scree_sensor_kind scree_sensor_part = {
    .geometry = geometry, .check = check, .columns_of = columns_of, .read = read};
