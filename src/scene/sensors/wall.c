/* What a geometry feels: force, torque, power; and maps of it by triangle, in the window of a wall
 * sensor: pressure and shear, the means over time of a triangle's normal forces and of the sizes of
 * its tangential ones, over its area; the work of sliding, |F_t . v_t| over time, F_t the
 * tangential force of a contact and v_t how fast the body slides there; the worn volume, k F_n
 * |v_t| over time, of contacts at the Coulomb limit (Archard 1953, "Contact and rubbing of flat
 * surfaces"; k is his coefficient over the hardness). Contacts are looked at every few steps,
 * several times in the shortest, and counted for all of them: over many looks the sum is the
 * integral. */
#include "mesh/mesh.h"
#include "particle/closest.h"
#include "scene/sensors/sensor.h"
#include "world/state/walls.h"

#include "base/alloc.h"

typedef struct maps {
  double *sums;   /* each scree_wall_map by triangle of its meshes, one number of each other wall: N
                     s,   N s, J, m3 */
  double watched; /* s in which they were gathered */
  size_t cell_count;
} maps;

/* Looks of all wall sensors. */
typedef struct looks {
  uint64_t steps, next; /* from one to the next; the step of that */
} looks;

static maps *maps_of(const scree_scene_sensor *sensor) {
  return scree_sensor_state(sensor, &scree_sensor_wall);
}

/* Whether the sensor maps that wall; *first is then the place of the wall's first number. */
static bool maps_wall(const scree_scene *scene, const scree_scene_sensor *sensor, size_t wall,
                      size_t *first) {
  const scree_scene_geometry *g = &scene->geometry[sensor->geometry];
  if (!maps_of(sensor) || wall < g->first_wall || wall >= g->first_wall + g->wall_count)
    return false;
  *first = 0;
  for (size_t w = g->first_wall; w < wall; w++) *first += scree_scene_wall_cells(scene, w);
  return true;
}

size_t scree_scene_wall_cells(const scree_scene *scene, size_t wall_index) {
  scree_wall wall;
  scree_world_get_wall(scene->world, wall_index, &wall);
  return wall.kind == SCREE_WALL_MESH ? wall.mesh->triangle_count : 1;
}

static scree_status begin(scree_scene *scene, scree_scene_sensor *sensor, scree_error *error) {
  const scree_scene_geometry *g = &scene->geometry[sensor->geometry];
  maps *m = sensor->state;
  looks *all = sensor->shared;
  if (!all->steps) all->next = scree_world_step_count(scene->world);
  all->steps = (uint64_t)fmax(1, floor(scene->plan.contact->steps));
  for (size_t k = 0; k < g->wall_count; k++)
    m->cell_count += scree_scene_wall_cells(scene, g->first_wall + k);
  SCREE_TRY_TAKE(m->sums, &scene->arena, SCREE_MAP_COUNT * m->cell_count, error);
  return SCREE_OK;
}

static vec3 velocity_at(vec3 velocity, vec3 spin, vec3 middle, vec3 p) {
  return vec3_add(velocity, vec3_cross(spin, vec3_sub(p, middle)));
}

static vec3 belt_velocity(const scree_world_wall *wall, vec3 p, vec3 n) {
  const mat3 *turned = &wall->frame.rotation;
  if (!scree_wall_is_belt(wall)) return (vec3){0, 0, 0};
  return mat3_mul_vec(
      turned, scree_belt_velocity(wall, mat3_tmul_vec(turned, vec3_sub(p, wall->frame.position)),
                                  mat3_tmul_vec(turned, n)));
}

/* s */
static double between_looks(const scree_scene *scene) {
  const looks *all = scree_sensor_shared(scene, &scree_sensor_wall);
  return (double)all->steps * scene->time_step;
}

static const double at_limit =
    0.999; /* of the Coulomb limit: what is stuck creeps, and wears not */

/* What the contact adds in the time between two looks: N s, N s, J, and m3 at a wear of `rate`. */
static void measure_contact(const scree_scene *scene, const scree_wall *wall, double friction,
                            double rate, const scree_contact *c, double amounts[SCREE_MAP_COUNT]) {
  scree_body b;
  scree_world_get_body(scene->world, c->body, &b);
  const double time = between_looks(scene);
  vec3 p = vec3_load(c->position), n = vec3_load(c->normal), force = vec3_load(c->force),
       at = vec3_load(wall->position);
  vec3 v =
      velocity_at(vec3_load(b.velocity), vec3_load(b.angular_velocity), vec3_load(b.position), p);
  v = vec3_sub(v, velocity_at(vec3_load(wall->velocity), vec3_load(wall->angular_velocity), at, p));
  v = vec3_sub(v, belt_velocity(scree_world_wall_at(scene->world, c->other), p, n));
  const double press = vec3_dot(force, n), load = fmax(0, press);
  vec3 across = vec3_mad(force, n, -press), along = vec3_mad(v, n, -vec3_dot(v, n));
  const bool slips = vec3_norm(across) >= at_limit * friction * load;
  amounts[SCREE_MAP_PRESSURE] = press * time;
  amounts[SCREE_MAP_SHEAR] = vec3_norm(across) * time;
  amounts[SCREE_MAP_WEAR] = fmax(0, -vec3_dot(across, v)) * time;
  amounts[SCREE_MAP_WORN] = slips ? rate * load * vec3_norm(along) * time : 0;
}

/* 1/Pa, of what the body and the wall are made of. */
static double rate_of(const scree_scene *scene, const size_t made_of[2]) {
  const scree_plan *plan = &scene->plan;
  for (size_t i = plan->pairs.count; i-- > 0;) {
    const scree_plan_pair *p = &plan->pairs.items[i];
    size_t k[2];
    for (int side = 0; side < 2; side++)
      k[side] = SCREE_PLAN_FIND(plan->materials, p->between.items[side]);
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
  size_t first, cell = SIZE_MAX;
  double amounts[SCREE_MAP_COUNT] = {0};
  for (size_t i = 0; c->wall && i < scene->plan.sensors.count; i++) {
    scree_scene_sensor *sensor = &scene->sensors[i];
    if (!maps_wall(scene, sensor, c->other, &first) || !scree_sensor_is_on(scene, sensor)) continue;
    if (cell == SIZE_MAX) {
      scree_wall wall;
      scree_material_contact material;
      scree_world_get_wall(scene->world, c->other, &wall);
      const size_t made_of[2] = {scene->world->bodies.material[c->body], wall.material};
      if (scree_world_get_pair(scene->world, made_of[0], made_of[1], &material, NULL)) return true;
      measure_contact(scene, &wall, material.friction, rate_of(scene, made_of), c, amounts);
      cell = cell_of(scree_world_wall_at(scene->world, c->other), c->position);
    }
    maps *made = maps_of(sensor);
    for (size_t m = 0; m < SCREE_MAP_COUNT; m++)
      made->sums[m * made->cell_count + first + cell] += amounts[m];
  }
  return true;
}

static uint64_t next_shared(const void *shared) {
  return ((const looks *)shared)->next;
}

static scree_status watch_shared(scree_scene *scene, void *shared, scree_error *error) {
  looks *all = shared;
  bool any = false;
  all->next += all->steps;
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    scree_scene_sensor *sensor = &scene->sensors[i];
    if (!maps_of(sensor) || !scree_sensor_is_on(scene, sensor)) continue;
    maps_of(sensor)->watched += between_looks(scene);
    any = true;
  }
  return any ? scree_world_visit_contacts(scene->world, feel, scene, error) : SCREE_OK;
}

/* m2: a wall that is no mesh has; an endless one 0. */
static double area_of(const scree_wall *wall) {
  const double pi = 3.14159265358979323846, r = wall->radius;
  if (wall->kind == SCREE_WALL_DISC) return pi * r * r;
  return wall->kind == SCREE_WALL_CYLINDER ? 2 * pi * r * wall->length : 0;
}

static void read_map(const scree_scene *scene, const scree_scene_sensor *sensor, size_t index,
                     size_t first, scree_wall_map map, double *values) {
  scree_wall wall;
  const maps *m = maps_of(sensor);
  const double *amounts = m->sums + map * m->cell_count + first;
  const double over = map == SCREE_MAP_PRESSURE || map == SCREE_MAP_SHEAR ? m->watched : 1;
  scree_world_get_wall(scene->world, index, &wall);
  for (size_t t = 0; t < scree_scene_wall_cells(scene, index); t++) {
    double area = wall.kind == SCREE_WALL_MESH ? 0.5 * vec3_norm(scree_facet_normal(wall.mesh, t))
                                               : area_of(&wall);
    values[t] = area > 0 && over > 0 ? amounts[t] / (over * area) : NAN;
  }
}

bool scree_scene_wall_map(const scree_scene *scene, size_t wall, scree_wall_map map,
                          double *values) {
  size_t first;
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    const scree_scene_sensor *sensor = &scene->sensors[i];
    if (!maps_wall(scene, sensor, wall, &first)) continue;
    read_map(scene, sensor, wall, first, map, values);
    return true;
  }
  return false;
}

static scree_status read_maps(const scree_scene *scene, const scree_scene_sensor *sensor,
                              double sums[SCREE_MAP_COUNT], double highest[SCREE_MAP_COUNT],
                              scree_error *error) {
  const maps *made = maps_of(sensor);
  const scree_scene_geometry *g = &scene->geometry[sensor->geometry];
  double *values = scree_alloc(made->cell_count, sizeof *values);
  if (!values) return scree_fail_memory(error, made->cell_count * sizeof *values, "a wall's maps");
  for (size_t m = 0; m < SCREE_MAP_COUNT; m++) {
    size_t first = 0;
    sums[m] = 0;
    highest[m] = NAN;
    for (size_t w = 0; w < g->wall_count; w++) {
      read_map(scene, sensor, g->first_wall + w, first, (scree_wall_map)m, values + first);
      first += scree_scene_wall_cells(scene, g->first_wall + w);
    }
    for (size_t t = 0; t < made->cell_count; t++) {
      sums[m] += made->sums[m * made->cell_count + t];
      highest[m] = fmax(highest[m], values[t]);
    }
  }
  scree_free(values);
  return SCREE_OK;
}

bool scree_scene_has_maps(const scree_scene *scene) {
  return scree_sensor_at(scene, &scree_sensor_wall, 0) != NULL;
}

const char *scree_wall_map_name(scree_wall_map map) {
  static const char *const names[] = {"pressure", "shear", "wear", "worn depth"};
  return (int)map >= 0 && map < SCREE_MAP_COUNT ? names[map] : NULL;
}

const char *scree_wall_map_unit(scree_wall_map map) {
  static const char *const units[] = {"Pa", "Pa", "J/m2", "m"};
  return (int)map >= 0 && map < SCREE_MAP_COUNT ? units[map] : NULL;
}

/* ---- the series ---- */

static const scree_sensor_column columns[] = {
    {"force_x", "N", SCREE_OF_ALL},        {"force_y", "N", SCREE_OF_ALL},
    {"force_z", "N", SCREE_OF_ALL},        {"torque_x", "N m", SCREE_OF_ALL},
    {"torque_y", "N m", SCREE_OF_ALL},     {"torque_z", "N m", SCREE_OF_ALL},
    {"power", "W", SCREE_OF_ALL},          {"energy", "J", SCREE_OF_ALL},
    {"wear", "J", SCREE_OF_ALL},           {"worn_volume", "m3", SCREE_OF_ALL},
    {"worn_depth", "m", SCREE_OF_ALL},     {"highest_pressure", "Pa", SCREE_OF_ALL},
    {"highest_shear", "Pa", SCREE_OF_ALL}, {0}};

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  const scree_scene_geometry *g = &scene->geometry[sensor->geometry];
  (void)now;
  for (int k = 0; k < 8; k++) at[k] = 0;
  for (size_t w = g->first_wall; w < g->first_wall + g->wall_count; w++) {
    double force[3], torque[3];
    scree_world_wall_force(scene->world, w, force, torque);
    double power, energy;
    scree_world_wall_power(scene->world, w, &power, &energy);
    const vec3 arm = vec3_sub(scree_world_wall_at(scene->world, w)->frame.position,
                              scree_world_wall_at(scene->world, g->first_wall)->frame.position);
    double more[3]; /* about the first of copies */
    vec3_store(more, vec3_cross(arm, vec3_load(force)));
    for (int k = 0; k < 3; k++) at[k] += force[k], at[3 + k] += torque[k] + more[k];
    at[6] += power, at[7] += energy;
  }
  double sums[SCREE_MAP_COUNT], highest[SCREE_MAP_COUNT];
  SCREE_TRY(read_maps(scene, sensor, sums, highest, error));
  at[8] = sums[SCREE_MAP_WEAR];
  at[9] = sums[SCREE_MAP_WORN];
  at[10] = highest[SCREE_MAP_WORN];
  at[11] = highest[SCREE_MAP_PRESSURE];
  at[12] = highest[SCREE_MAP_SHEAR];
  return SCREE_OK;
}

static void code(scree_codec *c, scree_scene *scene, scree_scene_sensor *sensor) {
  maps *m = sensor->state;
  (void)scene;
  scree_code_reals(c, m->sums, SCREE_MAP_COUNT * m->cell_count);
  scree_code_real(c, &m->watched);
}

static void code_shared(scree_codec *c, void *shared) {
  scree_code_u64(c, &((looks *)shared)->next);
}

/* The maps, a row for each triangle of its meshes and each other wall. */
static scree_status fill(const scree_scene *scene, const scree_scene_sensor *sensor,
                         scree_sensor_rows *rows, scree_error *error) {
  const scree_scene_geometry *g = &scene->geometry[sensor->geometry];
  const size_t cells = maps_of(sensor)->cell_count;
  SCREE_SCRATCH(double, values, SCREE_MAP_COUNT *cells, error);
  for (size_t w = 0, first = 0; w < g->wall_count; w++) {
    const size_t own = scree_scene_wall_cells(scene, g->first_wall + w);
    for (size_t m = 0; m < SCREE_MAP_COUNT; m++)
      read_map(scene, sensor, g->first_wall + w, first, (scree_wall_map)m, values + m * cells);
    for (size_t t = 0; t < own; t++) {
      double row[2 + SCREE_MAP_COUNT] = {(double)w, (double)t};
      for (size_t m = 0; m < SCREE_MAP_COUNT; m++) row[2 + m] = values[m * cells + t];
      SCREE_TRY(scree_sensor_put_row(rows, row, NULL, error));
    }
    first += own;
  }
  return SCREE_OK;
}

static const scree_sensor_table tables[] = {{"map",
                                             true,
                                             {{"wall", "", 0},
                                              {"triangle", "", 0},
                                              {"pressure", "Pa", 0},
                                              {"shear", "Pa", 0},
                                              {"wear", "J/m2", 0},
                                              {"worn_depth", "m", 0}},
                                             fill},
                                            {0}};

static const char *geometry(const scree_plan_sensor *plan) {
  return plan->wall;
}

const scree_sensor_kind scree_sensor_wall = {.state_size = sizeof(maps),
                                             .geometry = geometry,
                                             .columns = columns,
                                             .read = read,
                                             .begin = begin,
                                             .code = code,
                                             .shared_size = sizeof(looks),
                                             .next_shared = next_shared,
                                             .watch_shared = watch_shared,
                                             .code_shared = code_shared,
                                             .tables = tables};
