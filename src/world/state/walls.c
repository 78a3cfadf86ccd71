/* Walls: what they are, and what is told of them. */
#include "world/state/walls.h"
#include "world/state/remote.h"

#include "base/array.h"

/* The rotation that takes the z axis to `axis`, the shortest way. */
static quat turn_to(vec3 axis) {
  vec3 u = vec3_unit(axis);
  if (u.z > -0.9999999) return quat_unit((quat){1 + u.z, -u.y, u.x, 0});
  return (quat){0, 1, 0, 0};
}

/* Only a mesh runs round. */
static scree_status check_loop(const scree_wall *wall, size_t number, const double *loop,
                               scree_error *error) {
  if (wall->kind == SCREE_WALL_MESH || !(vec3_norm2(vec3_load(loop)) > 0)) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "world: wall %zu is to have a surface loop, but is no mesh", number);
}

static scree_status check_wall(const scree_world *world, const scree_wall *wall,
                               scree_error *error) {
  size_t number = world->walls.count;
  if (wall->material >= world->materials.count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: wall %zu has material %zu of %zu", number,
                      wall->material, world->materials.count);
  double sum = 0, axis2 = 0;
  for (int i = 0; i < 3; i++) {
    sum += wall->position[i] + wall->axis[i] + wall->velocity[i] + wall->angular_velocity[i] +
           wall->surface_velocity[i] + wall->surface_angular_velocity[i] + wall->surface_loop[i];
    axis2 += wall->axis[i] * wall->axis[i];
  }
  if (!isfinite(sum) || !(axis2 > 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "world: wall %zu has an axis of length %g, or a value that is not finite",
                      number, sqrt(axis2));
  bool round = wall->kind == SCREE_WALL_DISC || wall->kind == SCREE_WALL_CYLINDER;
  if (round && !(wall->radius > 0 && wall->length >= 0 && isfinite(wall->radius + wall->length)))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "world: wall %zu has radius %g m and length %g m; finite, above 0 and at "
                      "least 0",
                      number, wall->radius, wall->length);
  if (wall->kind == SCREE_WALL_MESH && !wall->mesh)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: wall %zu is a mesh without one", number);
  if (wall->kind > SCREE_WALL_MESH)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: wall %zu is of kind %d, which is none",
                      number, (int)wall->kind);
  return check_loop(wall, number, wall->surface_loop, error);
}

/* Whether a period along axis k leaves the wall as it is. */
static bool repeats(const scree_wall *wall, int k) {
  double along = wall->axis[k] * wall->axis[k], across = 0;
  for (int i = 0; i < 3; i++) across += i == k ? 0 : wall->axis[i] * wall->axis[i];
  if (wall->kind == SCREE_WALL_PLANE) return along <= 1e-20 * across;
  return wall->kind == SCREE_WALL_CYLINDER && wall->length == 0 && across <= 1e-20 * along;
}

static scree_status check_period(const scree_world *world, const scree_wall *wall,
                                 scree_error *error) {
  for (int k = 0; k < 3; k++)
    if (world->options.period[k] > 0 && !repeats(wall, k))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "world: wall %zu does not go on beyond the period along %c: it must be a "
                        "plane along that axis, or an endless cylinder about it",
                        world->walls.count, "xyz"[k]);
  return SCREE_OK;
}

static void set_velocity(scree_world_wall *wall, vec3 velocity, vec3 spin) {
  vec3_store(wall->given.velocity, velocity);
  vec3_store(wall->given.angular_velocity, spin);
  wall->frame.velocity = wall->frame.velocity_now = velocity;
  wall->frame.spin = wall->frame.spin_now = spin;
}

/* In space, as the wall stands now. */
static void set_surface(scree_world_wall *wall, const double *velocity, const double *spin,
                        const double *loop) {
  const mat3 *rotation = &wall->frame.rotation;
  wall->surface_velocity = mat3_tmul_vec(rotation, vec3_load(velocity));
  wall->surface_spin = mat3_tmul_vec(rotation, vec3_load(spin));
  wall->surface_loop = mat3_tmul_vec(rotation, vec3_load(loop));
}

/* Where the sheet of a disc or cylinder ends. */
static scree_status make_rims(scree_world_wall *wall, scree_error *error) {
  const scree_wall *given = &wall->given;
  const scree_circle edge = {given->radius, 0, 1, 0},
                     ends[2] = {{given->radius, 0, 0, -1}, {given->radius, given->length, 0, 1}};
  if (given->kind == SCREE_WALL_DISC)
    return scree_particle_circles(&edge, 1, &wall->surface, error);
  if (given->kind == SCREE_WALL_CYLINDER && given->length > 0)
    return scree_particle_circles(ends, 2, &wall->surface, error);
  return SCREE_OK;
}

scree_status scree_world_add_wall(scree_world *world, const scree_wall *wall, size_t *index,
                                  scree_error *error) {
  SCREE_TRY(check_wall(world, wall, error));
  SCREE_TRY(check_period(world, wall, error));
  SCREE_TRY(scree_world_change(world, SCREE_ALL_PARTS, error));
  scree_world_wall made = {.given = *wall,
                           .orientation = turn_to(vec3_load(wall->axis)),
                           .path_at_build = -1,
                           .summed = world->step_count};
  made.frame.position = vec3_load(wall->position);
  made.frame.rotation = quat_to_mat3(made.orientation);
  set_velocity(&made, vec3_load(wall->velocity), vec3_load(wall->angular_velocity));
  set_surface(&made, wall->surface_velocity, wall->surface_angular_velocity, wall->surface_loop);
  if (wall->kind == SCREE_WALL_MESH) {
    SCREE_TRY(scree_particle_surface(wall->mesh, 0, wall->two_sided, &made.surface, error));
    made.given.mesh = &made.surface->mesh;
  } else {
    SCREE_TRY(make_rims(&made, error));
  }
  if (!SCREE_PUSH(&world->walls, made)) {
    scree_particle_free(made.surface);
    return scree_fail_memory(error, sizeof made, "a wall");
  }
  world->list.stale = world->time_step_stale = true;
  if (index) *index = world->walls.count - 1;
  return SCREE_OK;
}

const scree_world_wall *scree_world_wall_at(const scree_world *world, size_t index) {
  scree_world_bring(world, SCREE_PART_WALLS, NULL);
  return &world->walls.items[index];
}

static bool may_stand_for(const scree_particle *a, const scree_particle *b) {
  return a && b && a->face_count == b->face_count && a->edge_count == b->edge_count &&
         a->point_count == b->point_count;
}

void scree_world_share_walls(scree_world *world, const scree_world *like) {
  for (size_t i = 0; i < world->walls.count; i++) {
    scree_world_wall *wall = &world->walls.items[i];
    scree_particle *surface = like->walls.items[i].surface;
    if (!may_stand_for(surface, wall->surface)) continue;
    scree_particle_retain(surface);
    scree_particle_free(wall->surface);
    wall->surface = surface;
    if (!scree_wall_is_analytic(wall)) wall->given.mesh = &surface->mesh;
  }
}

size_t scree_world_wall_count(const scree_world *world) {
  return world->walls.count;
}

void scree_world_get_wall(const scree_world *world, size_t index, scree_wall *wall) {
  scree_world_bring(world, SCREE_PART_WALLS, NULL);
  const scree_world_wall *w = &world->walls.items[index];
  *wall = w->given;
  vec3_store(wall->position, w->frame.position);
  const mat3 *r = &w->frame.rotation;
  vec3_store(wall->axis, (vec3){r->m[0][2], r->m[1][2], r->m[2][2]});
  vec3_store(wall->velocity, w->frame.velocity_now);
  vec3_store(wall->angular_velocity, w->frame.spin_now);
  vec3_store(wall->surface_velocity, mat3_mul_vec(r, w->surface_velocity));
  vec3_store(wall->surface_angular_velocity, mat3_mul_vec(r, w->surface_spin));
  vec3_store(wall->surface_loop, mat3_mul_vec(r, w->surface_loop));
}

void scree_world_wall_orientation(const scree_world *world, size_t index, double orientation[4]) {
  scree_world_bring(world, SCREE_PART_WALLS, NULL);
  quat q = world->walls.items[index].orientation;
  orientation[0] = q.w, orientation[1] = q.x, orientation[2] = q.y, orientation[3] = q.z;
}

scree_status scree_check_wall_velocities(const scree_world *world, size_t index,
                                         const double *velocity, const double *angular_velocity,
                                         scree_error *error) {
  if (index >= world->walls.count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: wall %zu of %zu", index,
                      world->walls.count);
  for (int i = 0; i < 3; i++)
    if (!isfinite(velocity[i] + angular_velocity[i]))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "world: wall %zu is to move with a velocity that is not finite", index);
  return SCREE_OK;
}

void scree_wall_set_velocity(scree_world *world, size_t index, vec3 velocity, vec3 spin) {
  scree_world_wall *wall = &world->walls.items[index];
  set_velocity(wall, velocity, spin);
  double travel = (vec3_norm(velocity) + wall->reach * vec3_norm(spin)) * world->time_step;
  wall->travel = scree_max(wall->travel, travel);
  if (!world->list.stale && world->list.wake_threshold.items)
    scree_set_wall_wake_threshold(world, index); /* else later */
}

scree_status scree_world_set_wall_surface(scree_world *world, size_t index,
                                          const double velocity[3],
                                          const double angular_velocity[3], const double loop[3],
                                          scree_error *error) {
  SCREE_TRY(scree_check_wall_velocities(world, index, velocity, angular_velocity, error));
  SCREE_TRY(scree_check_wall_velocities(world, index, velocity, loop, error));
  SCREE_TRY(check_loop(&world->walls.items[index].given, index, loop, error));
  SCREE_TRY(scree_world_change(world, SCREE_PART_WALLS, error));
  set_surface(&world->walls.items[index], velocity, angular_velocity, loop);
  return SCREE_OK;
}

void scree_world_wall_force(const scree_world *world, size_t index, double force[3],
                            double torque[3]) {
  scree_world_bring(world, SCREE_PART_WALLS, NULL);
  scree_walls_settle(world);
  vec3_store(force, world->walls.items[index].force);
  vec3_store(torque, world->walls.items[index].torque);
}

void scree_world_wall_power(const scree_world *world, size_t index, double *power, double *energy) {
  scree_world_bring(world, SCREE_PART_WALLS, NULL);
  scree_walls_settle(world);
  *power = world->walls.items[index].power;
  *energy = world->walls.items[index].work;
}
