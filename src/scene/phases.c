/* Phases of a scene: they follow each other, each ends after its time or, where all that is there
 * has been still for a while, before. Motions may act during one alone. */
#include "scene/motions.h"
#include "scene/scene.h"

#include <string.h>

static const scree_plan_phase *phase_of(const scree_scene *scene) {
  size_t count = scene->plan.phases.count;
  return scene->phase < count ? &scene->plan.phases.items[scene->phase] : NULL;
}

/* ---- motions ---- */

static scree_status move_wall(scree_scene *scene, size_t wall_index, const scree_plan_motion *m,
                              scree_error *error) {
  double velocity[3] = {0, 0, 0}, spin[3] = {0, 0, 0};
  const scree_plan_phase *phase = phase_of(scene);
  if (phase && !strcmp(m->during, phase->place.name)) {
    scree_wall wall;
    vec3 v, w;
    scree_world_get_wall(scene->world, wall_index, &wall);
    scree_motion_velocity(m, vec3_load(wall.position), &v, &w);
    vec3_store(velocity, v);
    vec3_store(spin, w);
  }
  return scree_world_set_wall_velocity(scene->world, wall_index, velocity, spin, error);
}

scree_status scree_scene_lead_by_phase(scree_scene *scene, scree_error *error) {
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    const scree_plan_geometry *g = &scene->plan.geometry.items[i];
    const scree_scene_geometry *made = &scene->geometry[i];
    const scree_plan_motion *m = g->motion.items;
    if (g->motion.count == 0 || !m->during) continue;
    for (size_t w = 0; status == SCREE_OK && w < made->wall_count; w++)
      status = move_wall(scene, made->first_wall + w, m, error);
  }
  return status;
}

scree_status scree_scene_begin_phases(scree_scene *scene, scree_error *error) {
  scene->phase_start = scree_world_time(scene->world);
  scene->still_since = NAN;
  return scree_scene_lead_by_phase(scene, error);
}

/* ---- their ends ---- */

static bool is_above_all(const scree_scene *scene, const char *name) {
  size_t g = SCREE_PLAN_FIND(scene->plan.geometry, name);
  scree_wall wall;
  scree_world_get_wall(scene->world, scene->geometry[g].first_wall, &wall);
  return wall.position[2] > scree_scene_highest(scene, NULL, -INFINITY);
}

/* Whether all has been still for a while. */
static bool is_over_early(scree_scene *scene, const scree_plan_phase *phase) {
  scree_observation o;
  if (isnan(phase->still) || !phase->early) return false;
  scree_world_observe(scene->world, &o);
  if (!scree_is_still(&o, phase->still)) {
    scene->still_since = NAN;
    return false;
  }
  if (isnan(scene->still_since)) scene->still_since = o.time;
  if (o.time - scene->still_since < phase->rest) return false;
  return !phase->clear || is_above_all(scene, phase->clear);
}

static bool waits(const scree_scene *scene, const scree_plan_phase *phase) {
  return phase->filled && !scree_scene_is_filled(scene);
}

scree_status scree_scene_turn_phase(scree_scene *scene, bool observed, scree_error *error) {
  const scree_plan_phase *phase = phase_of(scene);
  double elapsed = scree_world_time(scene->world) - scene->phase_start;
  if (!phase || waits(scene, phase)) return SCREE_OK;
  bool over = elapsed >= phase->time || (observed && is_over_early(scene, phase));
  if (!over) return SCREE_OK;
  scene->phase++;
  return scree_scene_begin_phases(scene, error);
}

const char *scree_scene_phase(const scree_scene *scene) {
  const scree_plan_phase *phase = phase_of(scene);
  return phase ? phase->place.name : NULL;
}

const char *scree_scene_phase_name(const scree_scene *scene, size_t index) {
  if (index >= scene->plan.phases.count) return NULL;
  return scene->plan.phases.items[index].place.name;
}

double scree_scene_phase_end(const scree_scene *scene) {
  const scree_plan_phase *phase = phase_of(scene);
  return phase && !waits(scene, phase) ? scene->phase_start + phase->time : (double)INFINITY;
}

double scree_scene_phase_times(const scree_scene *scene) {
  double sum = 0;
  for (size_t i = 0; i < scene->plan.phases.count; i++) sum += scene->plan.phases.items[i].time;
  return sum;
}

double scree_scene_duration(const scree_scene *scene) {
  const scree_plan_stop *stop = scene->plan.stop;
  double most = scene->plan.phases.count ? scree_scene_phase_times(scene) : (double)INFINITY;
  if (!isnan(stop->filled)) most = fmin(most, scree_scene_filling_time(scene) + stop->filled);
  return isnan(scene->plan.time) ? most : fmin(scene->plan.time, most);
}

double scree_scene_fraction(const scree_scene *scene) {
  double time = scree_world_time(scene->world), all = scree_scene_phase_times(scene), done = 0;
  if (scene->plan.phases.count == 0) return fmin(1, time / scree_scene_duration(scene));
  for (size_t i = 0; i < scene->phase && i < scene->plan.phases.count; i++)
    done += scene->plan.phases.items[i].time;
  if (phase_of(scene)) done += fmin(time - scene->phase_start, phase_of(scene)->time);
  return all > 0 ? done / all : 1;
}
