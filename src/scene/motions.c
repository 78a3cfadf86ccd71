/* Motions, of whatever kind (scene/motions/kind.h). */
#include "scene/motions.h"

#include "base/alloc.h"
#include "scene/motions/kind.h"
#include "scene/scene.h"

#include <string.h>

#define MOTION_KIND(T, row, key, ...) &scree_motion_##key,
static const scree_motion_kind *const kinds[] = {SCREE_MOTION_KINDS(MOTION_KIND, )};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const scree_motion_kind *kind_of(const scree_plan_motion *plan) {
  return kinds[scree_plan_kind(&scree_plan_motion_record, plan)];
}

/* ---- the plan ---- */

static scree_status check_motion(const scree_reader *r, const void *record) {
  const scree_plan_motion *m = record;
  vec3 velocity, spin;
  SCREE_TRY(scree_plan_one_kind(r, &scree_plan_motion_record, m, KINDS));
  if (m->during && !scree_motion_velocity(m, (vec3){0, 0, 0}, &velocity, &spin))
    return scree_fail_place(
        r, &m->place,
        "during a phase only a translate with a velocity or a rotate with a speed may act");
  if (m->during && (m->from > 0 || given(&m->until)))
    return scree_fail_place(r, &m->place, "during stands instead of from and until");
  return scree_plan_check_window(r, &m->place, m->from, m->until);
}
SCREE_RECORD_TABLE(scree_plan_motion, SCREE_PLAN_MOTION, "a motion", NULL, check_motion)

scree_status scree_motions_check(const scree_reader *r, const scree_plan_geometry *g) {
  for (size_t i = 0; i < g->motion.count; i++) {
    const scree_plan_motion *m = &g->motion.items[i];
    if (kind_of(m)->check) SCREE_TRY(kind_of(m)->check(r, g, m));
    if (m->during && g->motion.count > 1)
      return scree_fail_place(r, &m->place,
                              "a motion during a phase must be the geometry's only one");
  }
  return SCREE_OK;
}

bool scree_motion_turns(const scree_plan_motion *motion) {
  return kind_of(motion)->turns;
}

/* ---- in the world ---- */

scree_status scree_motions_read(scree_scene *scene, size_t index, const char *folder,
                                scree_error *error) {
  const scree_plan_motion_list *plans = &scene->plan.geometry.items[index].motion;
  for (size_t i = 0; i < plans->count; i++) {
    const scree_motion_kind *kind = kind_of(&plans->items[i]);
    if (kind->read) SCREE_TRY(kind->read(scene, &plans->items[i], folder, error));
  }
  return SCREE_OK;
}

/* The motions of a copy; answers how many there are. */
static size_t put_motions(const scree_plan_geometry *g, size_t copy, scree_wall_motion *motions) {
  size_t count = 0;
  for (size_t i = 0; i < g->motion.count; i++) {
    const scree_plan_motion *plan = &g->motion.items[i];
    scree_wall_motion *first = motions + count;
    for (size_t k = 0; k < SCREE_MOST_MOTIONS; k++) {
      first[k] = scree_default_wall_motion();
      first[k].from = plan->from;
      if (given(&plan->until)) first[k].until = plan->until;
    }
    count += kind_of(plan)->put(g, plan, copy, first);
  }
  return count;
}

scree_status scree_motions_set(const scree_scene *scene, size_t index, scree_world *world,
                               scree_error *error) {
  const scree_plan_geometry *g = &scene->plan.geometry.items[index];
  const scree_scene_geometry *made = &scene->geometry[index];
  const size_t copies = g->copies ? g->copies->count : 1, most = SCREE_MOST_MOTIONS;
  SCREE_SCRATCH(scree_wall_motion, motions, most * g->motion.count, error);
  for (size_t w = 0; w < made->wall_count; w++) {
    const size_t count = put_motions(g, w / (made->wall_count / copies), motions);
    SCREE_TRY(scree_world_set_wall_motion(world, made->first_wall + w, motions, count, error));
  }
  return SCREE_OK;
}

bool scree_motions_sweep(const scree_scene *scene, size_t index, double axis[3]) {
  static const double slight = 1e-6;
  const scree_plan_geometry *g = &scene->plan.geometry.items[index];
  const scree_scene_geometry *made = &scene->geometry[index];
  scree_wall_motion motions[SCREE_MOST_MOTIONS];
  if (g->motion.count != 1 || put_motions(g, 0, motions) != 1) return false;
  const vec3 about = vec3_unit(vec3_load(motions->axis));
  if (!motions->turns || vec3_norm(vec3_load(motions->through)) > 0) return false;
  memcpy(axis, motions->axis, sizeof motions->axis);
  for (size_t k = 0; k < made->wall_count; k++) {
    scree_wall wall;
    scree_world_get_wall(scene->world, made->first_wall + k, &wall);
    const double aslant = vec3_norm(vec3_cross(about, vec3_unit(vec3_load(wall.axis)))),
                 beside = vec3_norm(vec3_cross(about, vec3_load(wall.position)));
    if (wall.kind == SCREE_WALL_CYLINDER && (aslant > slight || beside > slight * wall.radius))
      return true;
  }
  return false;
}

/* ---- how fast ---- */

bool scree_motion_velocity(const scree_plan_motion *m, vec3 place, vec3 *velocity, vec3 *spin) {
  const scree_motion_kind *kind = kind_of(m);
  *velocity = *spin = (vec3){0, 0, 0};
  return kind->velocity && kind->velocity(m, place, velocity, spin);
}

double scree_motions_fastest(const scree_scene *scene, size_t index) {
  const scree_plan_motion_list *plans = &scene->plan.geometry.items[index].motion;
  double speed = 0;
  for (size_t i = 0; i < plans->count; i++)
    speed += kind_of(&plans->items[i])->fastest(scene, index, &plans->items[i]);
  return speed;
}

scree_status scree_motions_check_speeds(const scree_scene *scene, scree_error *error) {
  static const double most_share = 0.5; /* of the smallest body, in a step */
  double size = INFINITY;
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++)
    size = fmin(size, scene->shapes[i].particle->measures.size);
  double most = most_share * size / scene->time_step;
  for (size_t g = 0; g < scene->plan.geometry.count; g++) {
    double speed = scree_motions_fastest(scene, g);
    if (!(speed > most)) continue;
    return scree_scene_fail(scene, &scene->plan.geometry.items[g].motion.items[0].place, error,
                            "moves at up to %.4g m/s, %.3g m in a time step of %.3g s, past bodies "
                            "of %.3g m: %.4g m/s can be followed; a table that jumps needs rows in "
                            "between",
                            speed, speed * scene->time_step, scene->time_step, size, most);
  }
  return SCREE_OK;
}
