/* Bodies: an array for each of their fields. */
#include "world/state/pairs.h"
#include "world/state/remote.h"

#include "base/alloc.h"

#include <stddef.h>
#include <string.h>

/* An array with an element for each body, and one more. */
static const struct body_array {
  size_t field, size; /* where in scree_world its pointer is; bytes of an element */
} body_arrays[] = {
#define OF(member)                                                                                 \
  { offsetof(scree_world, member), sizeof *((scree_world *)0)->member }
    OF(bodies.frame),        OF(bodies.orientation),     OF(bodies.momentum),
    OF(bodies.inertia),      OF(bodies.force),           OF(bodies.torque),
    OF(bodies.mass),         OF(bodies.travel),          OF(bodies.path),
    OF(bodies.turn),         OF(bodies.particle),        OF(bodies.material),
    OF(bodies.removed),      OF(bodies.balance),         OF(list.side_begin),
    OF(workspace.offenders), OF(list.body_path_at_build)};
#undef OF
enum { BODY_ARRAYS = sizeof body_arrays / sizeof *body_arrays };

static void *body_array(const scree_world *world, size_t i) {
  void *pointer;
  memcpy(&pointer, (const char *)world + body_arrays[i].field, sizeof pointer);
  return pointer;
}

void scree_bodies_free(scree_world *world) {
  for (size_t i = 0; i < world->bodies.count; i++) scree_particle_free(world->bodies.particle[i]);
  for (size_t i = 0; i < BODY_ARRAYS; i++) scree_free(body_array(world, i));
  scree_free(world->bodies.applied);
}

static scree_status grow_applied(scree_bodies *b, size_t capacity, scree_error *error) {
  scree_applied *moved = scree_resize(b->applied, capacity + 1, sizeof *moved);
  if (!moved) return scree_fail_memory(error, capacity * sizeof *moved, "forces on bodies");
  b->applied = moved;
  return SCREE_OK;
}

/* Every array of bodies to the new capacity; on failure all keep their content and the capacity
 * stays, so that nothing is lost. */
static scree_status grow_bodies(scree_world *world, scree_error *error) {
  scree_bodies *b = &world->bodies;
  size_t capacity = b->capacity < 64 ? 64 : 2 * b->capacity;
  for (size_t i = 0; i < BODY_ARRAYS; i++) {
    void *moved = scree_resize(body_array(world, i), capacity + 1, body_arrays[i].size);
    if (!moved) return scree_fail_memory(error, capacity * body_arrays[i].size, "bodies");
    memcpy((char *)world + body_arrays[i].field, &moved, sizeof moved);
  }
  SCREE_TRY(b->applied ? grow_applied(b, capacity, error) : SCREE_OK);
  b->capacity = capacity;
  return SCREE_OK;
}

scree_body scree_default_body(void) {
  return (scree_body){.orientation = {1, 0, 0, 0}};
}

static bool is_finite_body(const scree_body *s) {
  double sum = 0, length = 0;
  for (int i = 0; i < 3; i++) sum += s->position[i] + s->velocity[i] + s->angular_velocity[i];
  for (int i = 0; i < 4; i++) length += s->orientation[i] * s->orientation[i];
  return isfinite(sum) && length > 0 && isfinite(length);
}

static scree_status check_state(size_t index, const char *what, const scree_body *state,
                                scree_error *error) {
  if (is_finite_body(state)) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "world: body %zu is to be %s a state that is not finite", index, what);
}

static void place_body(scree_world *world, size_t i, const scree_body *state) {
  scree_bodies *b = &world->bodies;
  const double *o = state->orientation;
  b->orientation[i] = quat_unit((quat){o[0], o[1], o[2], o[3]});
  scree_frame *frame = &b->frame[i];
  frame->position = vec3_load(state->position);
  frame->velocity = vec3_load(state->velocity);
  frame->rotation = quat_to_mat3(b->orientation[i]);
  vec3 local = mat3_tmul_vec(&frame->rotation, vec3_load(state->angular_velocity)),
       in = b->inertia[i];
  b->momentum[i] =
      mat3_mul_vec(&frame->rotation, (vec3){in.x * local.x, in.y * local.y, in.z * local.z});
  frame->spin = vec3_load(state->angular_velocity);
  frame->velocity_now = frame->velocity;
  frame->spin_now = frame->spin;
  b->force[i] = b->torque[i] = (vec3){0, 0, 0};
  world->list.body_path_at_build[i] = -1;
  scree_body_forget(world, i);
}

/* With matter. */
static void fill_body(scree_bodies *b, size_t i, double density) {
  const scree_particle_measures *m = &b->particle[i]->measures;
  b->mass[i] = density * m->volume;
  b->inertia[i] = vec3_scale(vec3_load(m->inertia), density);
}

/* A body must not meet itself, nor another twice. */
static scree_status check_period(const scree_world *world, const scree_particle *particle,
                                 scree_error *error) {
  const double radius = particle->measures.bounding_radius, least = SCREE_LEAST_PERIOD * radius;
  for (int k = 0; k < 3; k++)
    if (world->options.period[k] > 0 && world->options.period[k] < least)
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "world: a period of %.4g m along %c is too short for a body %.4g m across: "
                        "at least %.4g m",
                        world->options.period[k], "xyz"[k], 2 * radius, least);
  return SCREE_OK;
}

/* What a body has before it has neighbours. */
static const unsigned of_bodies = SCREE_PART_REMOVED | SCREE_PART_POSES | SCREE_PART_BODIES;

/* All that changes when its contacts start anew. */
static unsigned parts_around(const scree_world *world, size_t body) {
  return scree_body_has_neighbours(world, body) ? SCREE_ALL_PARTS : of_bodies;
}

scree_status scree_world_add_body(scree_world *world, scree_particle *particle, size_t material,
                                  const scree_body *state, size_t *index, scree_error *error) {
  if (material >= world->materials.count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: material %zu of %zu", material,
                      world->materials.count);
  scree_body start = state ? *state : scree_default_body();
  scree_bodies *b = &world->bodies;
  SCREE_TRY(check_state(b->count, "added with", &start, error));
  SCREE_TRY(check_period(world, particle, error));
  SCREE_TRY(scree_world_change(world, of_bodies, error));
  if (b->count == b->capacity) {
    if (b->count > UINT32_MAX / 8)
      return scree_fail(error, SCREE_LIMIT, "world: at most %u bodies", UINT32_MAX / 8);
    SCREE_TRY(grow_bodies(world, error));
  }
  size_t i = b->count++;
  b->travel[i] = b->path[i] = world->list.body_path_at_build[i] = 0;
  b->material[i] = (uint8_t)material;
  b->removed[i] = false;
  b->particle[i] = particle;
  fill_body(b, i, world->materials.items[material].density);
  if (b->applied) b->applied[i] = (scree_applied){0};
  b->balance[i] = (scree_balance){0, 0, 0};
  scree_particle_retain(particle);
  place_body(world, i, &start);
  world->time_step_stale = true;
  if (index) *index = i;
  return SCREE_OK;
}

scree_status scree_world_set_body_density(scree_world *world, size_t index, double density,
                                          scree_error *error) {
  if (!(density > 0 && isfinite(density)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: body %zu: density %g kg/m3; above 0",
                      index, density);
  SCREE_TRY(scree_world_change(world, parts_around(world, index), error));
  scree_bodies *b = &world->bodies;
  double before = b->mass[index];
  fill_body(b, index, density);
  b->momentum[index] = vec3_scale(b->momentum[index], b->mass[index] / before);
  world->list.body_path_at_build[index] = -1;
  scree_body_forget(world, index);
  world->time_step_stale = true;
  return SCREE_OK;
}

size_t scree_world_body_count(const scree_world *world) {
  return world->bodies.count;
}

bool scree_world_body_removed(const scree_world *world, size_t index) {
  return world->bodies.removed[index];
}

void scree_world_get_body(const scree_world *world, size_t i, scree_body *state) {
  scree_world_bring(world, SCREE_PART_POSES, NULL);
  const scree_frame *frame = &world->bodies.frame[i];
  quat q = world->bodies.orientation[i];
  vec3_store(state->position, scree_world_fold(world, frame->position));
  vec3_store(state->velocity, frame->velocity);
  vec3_store(state->angular_velocity, frame->spin);
  const double orientation[4] = {q.w, q.x, q.y, q.z};
  memcpy(state->orientation, orientation, sizeof orientation);
}

void scree_world_get_bodies(const scree_world *world, size_t first, size_t count, double *positions,
                            double *orientations, double *velocities, double *angular_velocities) {
  scree_world_bring(world, SCREE_PART_POSES, NULL);
  for (size_t i = 0; i < count; i++) {
    const scree_frame *frame = &world->bodies.frame[first + i];
    quat q = world->bodies.orientation[first + i];
    if (positions) vec3_store(&positions[3 * i], scree_world_fold(world, frame->position));
    if (orientations)
      memcpy(&orientations[4 * i], (double[4]){q.w, q.x, q.y, q.z}, 4 * sizeof(double));
    if (velocities) vec3_store(&velocities[3 * i], frame->velocity);
    if (angular_velocities) vec3_store(&angular_velocities[3 * i], frame->spin);
  }
}

scree_status scree_bodies_make_applied(scree_bodies *b, scree_error *error) {
  if (b->applied) return SCREE_OK;
  SCREE_TRY(grow_applied(b, b->capacity, error));
  memset(b->applied, 0, b->count * sizeof *b->applied);
  return SCREE_OK;
}

scree_status scree_world_set_body_force(scree_world *world, size_t index, const double force[3],
                                        const double torque[3], scree_error *error) {
  scree_bodies *b = &world->bodies;
  if (index >= b->count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "world: body %zu of %zu", index, b->count);
  for (int i = 0; i < 3; i++)
    if (!isfinite(force[i] + torque[i]))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "world: body %zu is given a force or torque that is not finite", index);
  SCREE_TRY(scree_world_change(world, SCREE_PART_BODIES, error));
  SCREE_TRY(scree_bodies_make_applied(b, error));
  b->applied[index].now = (scree_wrench){vec3_load(force), vec3_load(torque)};
  return SCREE_OK;
}

scree_status scree_world_set_body(scree_world *world, size_t index, const scree_body *state,
                                  scree_error *error) {
  SCREE_TRY(check_state(index, "set to", state, error));
  SCREE_TRY(scree_world_change(world, parts_around(world, index), error));
  place_body(world, index, state);
  return SCREE_OK;
}

void scree_body_keep_orientation(scree_world *world, size_t index, const double told[4]) {
  world->bodies.orientation[index] = (quat){told[0], told[1], told[2], told[3]};
  world->bodies.frame[index].rotation = quat_to_mat3(world->bodies.orientation[index]);
}

scree_particle *scree_world_body_particle(const scree_world *world, size_t index) {
  return world->bodies.particle[index];
}

size_t scree_world_body_material(const scree_world *world, size_t index) {
  return world->bodies.material[index];
}

double scree_world_body_mass(const scree_world *world, size_t index) {
  return world->bodies.mass[index];
}

void scree_body_remove(scree_world *world, size_t index) {
  world->bodies.removed[index] = true;
  world->bodies.removed_count++;
  world->list.stale = true;
}

void scree_world_remove_body(scree_world *world, size_t index) {
  if (world->bodies.removed[index]) return;
  scree_world_change(world, SCREE_PART_REMOVED, NULL);
  scree_body_remove(world, index);
}
