/* Wear of geometry by triangle. The work of sliding is |F_t . v_t| over time, F_t the tangential
 * force of a contact and v_t how fast the body slides there. The worn volume is k F_n |v_t| over
 * time, of contacts at the Coulomb limit (Archard 1953, "Contact and rubbing of flat surfaces"; k
 * is his coefficient over the hardness). Both are looked at every few steps, several times in the
 * shortest contact, and counted for all of them: over many looks the sum is the integral. */
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
    sensor->wear = scree_arena_take(&scene->arena, 2 * sensor->wear_count, sizeof *sensor->wear);
    if (!sensor->wear)
      return scree_fail_memory(error, 2 * sensor->wear_count * sizeof *sensor->wear,
                               "a wall's wear");
    memset(sensor->wear, 0, 2 * sensor->wear_count * sizeof *sensor->wear);
    sensor->worn = sensor->wear + sensor->wear_count;
  }
  return SCREE_OK;
}

static vec3 velocity_at(vec3 velocity, vec3 spin, vec3 middle, vec3 p) {
  return vec3_add(velocity, vec3_cross(spin, vec3_sub(p, middle)));
}

/* In the time between two looks, of a body over the wall: J; N m, load times way. */
typedef struct sliding {
  double work, load_way;
} sliding;

static const double at_limit =
    0.999; /* of the Coulomb limit: what is stuck creeps, and wears not */

static sliding slide(const scree_scene *scene, const scree_wall *wall, double friction,
                     const scree_contact *c) {
  scree_body b;
  scree_world_get_body(scene->world, c->body, &b);
  const double time = (double)scene->wear_steps * scene->time_step;
  vec3 p = vec3_load(c->position), n = vec3_load(c->normal), force = vec3_load(c->force),
       at = vec3_load(wall->position);
  vec3 v =
      velocity_at(vec3_load(b.velocity), vec3_load(b.angular_velocity), vec3_load(b.position), p);
  v = vec3_sub(v, velocity_at(vec3_load(wall->velocity), vec3_load(wall->angular_velocity), at, p));
  v = vec3_sub(v, velocity_at(vec3_load(wall->surface_velocity),
                              vec3_load(wall->surface_angular_velocity), at, p));
  const double load = fmax(0, vec3_dot(force, n));
  vec3 across = vec3_mad(force, n, -vec3_dot(force, n)), along = vec3_mad(v, n, -vec3_dot(v, n));
  const bool slips = vec3_norm(across) >= at_limit * friction * load;
  return (sliding){fmax(0, -vec3_dot(across, v)) * time,
                   slips ? load * vec3_norm(along) * time : 0};
}

/* 1/Pa, of what the body and the wall are made of. */
static double rate_of(const scree_scene *scene, const size_t made_of[2]) {
  const scree_plan *plan = &scene->plan;
  for (size_t i = plan->pairs.count; i-- > 0;) {
    const scree_plan_pair *p = SCREE_PLAN_AT(plan, pairs, scree_plan_pair, i);
    size_t k[2];
    for (int side = 0; side < 2; side++)
      k[side] =
          scree_plan_find(&plan->materials, sizeof(scree_plan_material), p->between.items[side]);
    if ((k[0] == made_of[0] && k[1] == made_of[1]) || (k[0] == made_of[1] && k[1] == made_of[0]))
      return p->wear;
  }
  return 0;
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
  const size_t made_of[2] = {scene->world->bodies.material[c->body], wall.material};
  scree_material_contact material;
  if (scree_world_get_pair(scene->world, made_of[0], made_of[1], &material, NULL)) return true;
  sliding s = slide(scene, &wall, material.friction, c);
  double worn = rate_of(scene, made_of) * s.load_way;
  if (!(s.work > 0 || worn > 0)) return true;
  size_t cell = first + cell_of(scree_world_wall_at(scene->world, c->other), c->position);
  sensor->wear[cell] += s.work;
  sensor->worn[cell] += worn;
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

const double *scree_scene_worn(const scree_scene *scene, size_t wall, size_t *count) {
  size_t first;
  const scree_scene_sensor *sensor = sensor_of(scene, wall, &first);
  *count = sensor ? scree_scene_wear_cells(scene, wall) : 0;
  return sensor ? sensor->worn + first : NULL;
}

static double triangle_area(const scree_mesh *mesh, size_t t) {
  vec3 corner[3];
  for (int k = 0; k < 3; k++)
    corner[k] = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)k]);
  return 0.5 * vec3_norm(vec3_triangle_normal(corner[0], corner[1], corner[2]));
}

/* Of a wall that is no mesh; an endless one, m2: 0. */
static double area_of(const scree_wall *wall) {
  const double pi = 3.14159265358979323846, r = wall->radius;
  if (wall->kind == SCREE_WALL_DISC) return pi * r * r;
  return wall->kind == SCREE_WALL_CYLINDER ? 2 * pi * r * wall->length : 0;
}

double scree_scene_worn_depth(const scree_scene *scene, size_t index) {
  size_t count;
  scree_wall wall;
  const double *worn = scree_scene_worn(scene, index, &count);
  double deepest = 0;
  scree_world_get_wall(scene->world, index, &wall);
  for (size_t t = 0; t < count; t++) {
    double area = wall.kind == SCREE_WALL_MESH ? triangle_area(wall.mesh, t) : area_of(&wall);
    if (area > 0) deepest = fmax(deepest, worn[t] / area);
  }
  return deepest;
}
