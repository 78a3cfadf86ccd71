/* Wear of geometry: the work of sliding by triangle, |F_t . v_t| over time, F_t the tangential
 * force of a contact and v_t how fast the body slides there. It is looked at every few steps,
 * several times in the shortest contact, and counted for all of them: over many looks the sum is
 * the integral. */
#include "particle/closest.h"
#include "scene/scene.h"

#include <string.h>

static scree_scene_sensor *sensor_of(const scree_scene *scene, size_t wall, size_t *first_cell) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    scree_scene_sensor *sensor = &scene->sensors[i];
    const scree_scene_geometry *g = &scene->geometry[sensor->geometry];
    if (!sensor->wear || wall < g->first_wall || wall >= g->first_wall + g->wall_count) continue;
    *first_cell = 0;
    for (size_t w = g->first_wall; w < wall; w++) *first_cell += scree_scene_wear_cells(scene, w);
    return sensor;
  }
  return NULL;
}

size_t scree_scene_wear_cells(const scree_scene *scene, size_t wall_index) {
  scree_wall wall;
  scree_world_get_wall(scene->world, wall_index, &wall);
  return wall.kind == SCREE_WALL_MESH ? wall.mesh->triangle_count : 1;
}

scree_status scree_scene_plan_wear(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    scree_scene_sensor *sensor = &scene->sensors[i];
    const scree_scene_geometry *g = &scene->geometry[sensor->geometry];
    if (!sensor->plan->wall) continue;
    scene->wear_steps = (uint64_t)fmax(1, floor(scene->plan.contact->steps));
    for (size_t w = 0; w < g->wall_count; w++)
      sensor->wear_count += scree_scene_wear_cells(scene, g->first_wall + w);
    sensor->wear = scree_arena_take(&scene->arena, sensor->wear_count, sizeof *sensor->wear);
    if (!sensor->wear)
      return scree_fail_memory(error, sensor->wear_count * sizeof *sensor->wear, "a wall's wear");
    memset(sensor->wear, 0, sensor->wear_count * sizeof *sensor->wear);
  }
  return SCREE_OK;
}

static vec3 velocity_at(vec3 velocity, vec3 spin, vec3 middle, vec3 p) {
  return vec3_add(velocity, vec3_cross(spin, vec3_sub(p, middle)));
}

/* W, of the body's sliding over the wall. */
static double sliding_power(const scree_scene *scene, const scree_wall *wall,
                            const scree_contact *c) {
  scree_body b;
  scree_world_get_body(scene->world, c->body, &b);
  vec3 p = vec3_load(c->position), n = vec3_load(c->normal), force = vec3_load(c->force),
       at = vec3_load(wall->position);
  vec3 v =
      velocity_at(vec3_load(b.velocity), vec3_load(b.angular_velocity), vec3_load(b.position), p);
  v = vec3_sub(v, velocity_at(vec3_load(wall->velocity), vec3_load(wall->angular_velocity), at, p));
  v = vec3_sub(v, velocity_at(vec3_load(wall->surface_velocity),
                              vec3_load(wall->surface_angular_velocity), at, p));
  vec3 across = vec3_mad(force, n, -vec3_dot(force, n));
  return fmax(0, -vec3_dot(across, v));
}

/* The triangle of the wall that the contact is on. */
static size_t cell_of(const scree_world_wall *wall, const double position[3]) {
  const uint32_t root = 0;
  uint32_t face = 0;
  if (scree_wall_is_analytic(wall)) return 0;
  const scree_frame *f = &wall->frame;
  vec3 local = mat3_tmul_vec(&f->rotation, vec3_sub(vec3_load(position), f->position));
  scree_nearest_face(wall->surface, &root, 1, local, INFINITY, &face);
  return face;
}

static bool feel(void *context, const scree_contact *c) {
  const scree_scene *scene = context;
  size_t first;
  scree_scene_sensor *sensor = c->wall ? sensor_of(scene, c->other, &first) : NULL;
  if (!sensor) return true;
  scree_wall wall;
  scree_world_get_wall(scene->world, c->other, &wall);
  double work = sliding_power(scene, &wall, c) * (double)scene->wear_steps * scene->time_step;
  if (work > 0)
    sensor->wear[first + cell_of(scree_world_wall_at(scene->world, c->other), c->position)] += work;
  return true;
}

scree_status scree_scene_watch_wear(scree_scene *scene, scree_error *error) {
  if (!scene->wear_steps || scree_world_step_count(scene->world) < scene->next_wear)
    return SCREE_OK;
  scree_status status = scree_world_visit_contacts(scene->world, feel, scene, error);
  scene->next_wear += scene->wear_steps;
  return status;
}

const double *scree_scene_wear(const scree_scene *scene, size_t wall, size_t *count) {
  size_t first;
  const scree_scene_sensor *sensor = sensor_of(scene, wall, &first);
  *count = sensor ? scree_scene_wear_cells(scene, wall) : 0;
  return sensor ? sensor->wear + first : NULL;
}
