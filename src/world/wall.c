/* Walls: where they are, how they move, how far a point is from them.
 *
 * A wall's frame has its origin in `position` and its z axis along `axis`. Distances are signed,
 * positive on the side of the bodies. A plane is solid behind; discs and cylinders are sheets, met
 * from either side: a point belongs to the side where it was last seen clear of the sheet. */
#include "world/world.h"

#include "base/array.h"

/* The rotation that takes the z axis to `axis`, the shortest way. */
static quat turn_to(vec3 axis) {
  vec3 u = vec3_unit(axis);
  if (u.z > -0.9999999) return quat_unit((quat){1 + u.z, -u.y, u.x, 0});
  return (quat){0, 1, 0, 0};
}

static scree_status check_wall(const scree_world *world, const scree_wall *wall,
                               scree_error *error) {
  size_t number = world->walls.count;
  if (wall->material >= world->material_count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: wall %zu has material %zu of %zu", number,
                      wall->material, world->material_count);
  double sum = 0, axis2 = 0;
  for (int i = 0; i < 3; i++) {
    sum += wall->position[i] + wall->axis[i] + wall->velocity[i] + wall->angular_velocity[i];
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
  return SCREE_OK;
}

static void set_motion(scree_world_wall *wall, const double *velocity, const double *spin) {
  for (int i = 0; i < 3; i++) {
    wall->given.velocity[i] = velocity[i];
    wall->given.angular_velocity[i] = spin[i];
  }
  wall->frame.velocity = wall->frame.velocity_now = vec3_load(velocity);
  wall->frame.spin = wall->frame.spin_now = vec3_load(spin);
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
  scree_status status = check_wall(world, wall, error);
  if (status) return status;
  scree_world_wall made = {.given = *wall, .orientation = turn_to(vec3_load(wall->axis))};
  made.frame.position = vec3_load(wall->position);
  made.frame.rotation = quat_to_mat3(made.orientation);
  set_motion(&made, wall->velocity, wall->angular_velocity);
  if (wall->kind == SCREE_WALL_MESH) {
    status = scree_particle_surface(wall->mesh, 0, &made.surface, error);
    if (!status) made.given.mesh = &made.surface->mesh;
  } else {
    status = make_rims(&made, error);
  }
  if (status) return status;
  if (!SCREE_PUSH(&world->walls, made)) {
    scree_particle_free(made.surface);
    return scree_fail_memory(error, sizeof made, "a wall");
  }
  world->pairs_stale = world->time_step_stale = true;
  if (index) *index = world->walls.count - 1;
  return SCREE_OK;
}

size_t scree_world_wall_count(const scree_world *world) {
  return world->walls.count;
}

void scree_world_get_wall(const scree_world *world, size_t index, scree_wall *wall) {
  const scree_world_wall *w = &world->walls.items[index];
  *wall = w->given;
  vec3_store(wall->position, w->frame.position);
  const mat3 *r = &w->frame.rotation;
  vec3_store(wall->axis, (vec3){r->m[0][2], r->m[1][2], r->m[2][2]});
}

void scree_world_wall_orientation(const scree_world *world, size_t index, double orientation[4]) {
  quat q = world->walls.items[index].orientation;
  orientation[0] = q.w, orientation[1] = q.x, orientation[2] = q.y, orientation[3] = q.z;
}

scree_status scree_world_set_wall_velocity(scree_world *world, size_t index,
                                           const double velocity[3],
                                           const double angular_velocity[3], scree_error *error) {
  if (index >= world->walls.count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: wall %zu of %zu", index,
                      world->walls.count);
  for (int i = 0; i < 3; i++)
    if (!isfinite(velocity[i] + angular_velocity[i]))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "world: wall %zu is to move with a velocity that is not finite", index);
  scree_world_wall *w = &world->walls.items[index];
  bool turned = vec3_norm2(w->frame.spin) > 0;
  set_motion(w, velocity, angular_velocity);
  if (!turned && vec3_norm2(w->frame.spin) > 0) scree_neighbours_wake(world, index);
  return SCREE_OK;
}

void scree_world_wall_force(const scree_world *world, size_t index, double force[3],
                            double torque[3]) {
  vec3_store(force, world->walls.items[index].force);
  vec3_store(torque, world->walls.items[index].torque);
}

double scree_wall_side(const scree_world_wall *wall, vec3 p) {
  const scree_wall *given = &wall->given;
  if (given->kind == SCREE_WALL_DISC) return p.z >= 0 ? 1 : -1;
  if (given->kind == SCREE_WALL_CYLINDER)
    return p.x * p.x + p.y * p.y <= given->radius * given->radius ? 1 : -1;
  return 1;
}

bool scree_wall_spans(const scree_world_wall *wall, vec3 p) {
  const scree_wall *given = &wall->given;
  if (given->kind == SCREE_WALL_DISC) return p.x * p.x + p.y * p.y <= given->radius * given->radius;
  if (given->kind == SCREE_WALL_CYLINDER)
    return given->length == 0 || (p.z >= 0 && p.z <= given->length);
  return true;
}

static double cylinder_distance(const scree_wall *wall, vec3 p, double side, vec3 *closest,
                                vec3 *normal) {
  double rho = sqrt(p.x * p.x + p.y * p.y);
  vec3 outward = rho > 0 ? (vec3){p.x / rho, p.y / rho, 0} : (vec3){1, 0, 0};
  double z = p.z;
  if (wall->length > 0) z = z < 0 ? 0 : z > wall->length ? wall->length : z;
  *closest = (vec3){outward.x * wall->radius, outward.y * wall->radius, z};
  *normal = vec3_scale(outward, -side);
  if (z == p.z) return side * (wall->radius - rho);
  vec3 away = vec3_sub(p, *closest); /* past the rim */
  double d = vec3_norm(away);
  *normal = vec3_scale(away, 1 / d);
  return d;
}

double scree_wall_distance(const scree_world_wall *wall, vec3 p, double side, vec3 *closest,
                           vec3 *normal) {
  const scree_wall *given = &wall->given;
  if (given->kind == SCREE_WALL_CYLINDER) return cylinder_distance(given, p, side, closest, normal);
  *closest = (vec3){p.x, p.y, 0};
  *normal = (vec3){0, 0, side};
  if (given->kind == SCREE_WALL_PLANE) return p.z;
  double rho = sqrt(p.x * p.x + p.y * p.y);
  if (rho <= given->radius) return side * p.z;
  *closest = (vec3){p.x / rho * given->radius, p.y / rho * given->radius, 0};
  vec3 away = vec3_sub(p, *closest);
  double d = vec3_norm(away);
  *normal = vec3_scale(away, 1 / d);
  return d;
}

double scree_wall_first_side(const scree_world_wall *wall, vec3 p, vec3 centre, double clearance) {
  double side = scree_wall_side(wall, p), own = scree_wall_side(wall, centre);
  if (own == side || !scree_wall_spans(wall, centre)) return side;
  vec3 closest, normal;
  double d = scree_wall_distance(wall, p, own, &closest, &normal);
  return d < 0 && d > -clearance ? own : side;
}
