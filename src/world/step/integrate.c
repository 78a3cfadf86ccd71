/* Time integration: symplectic Euler (leapfrog with velocities half a step behind) for the centres;
 * for rotation the angular momentum L in space is the variable, so that it is conserved to
 * rounding: L += tau dt,   q_h = q exp(dt/2 I^-1 R(q)^T L),   q = q exp(dt I^-1 R(q_h)^T L), a
 * midpoint rule in the body's frame (compare Buss 2000, "Accurate and efficient simulation of
 * rigid-body rotations", and Dullweber et al. 1997 for the splitting it stands beside). */
#include "world/step/integrate.h"
#include "world/state/joints.h"
#include "world/state/materials.h"
#include "world/state/pairs.h"
#include "world/state/spin.h"
#include "world/state/walls.h"
#include "world/step/stages.h"

#include "base/parallel.h"

enum { BODY_BLOCK = 128 };

/* Lists the sides of bodies [begin, end) that touch, and where each body's end. Without
 * branches: which of them do is as good as random. */
static uint32_t *list_acting(scree_world *world, size_t begin, size_t end, size_t *ends) {
  uint32_t *acting = &world->list.acting.items[world->list.side_begin[begin]];
  size_t count = 0, k = world->list.side_begin[begin];
  for (size_t i = begin; i < end; i++) {
    for (const size_t last = world->list.side_begin[i + 1]; k < last; k++) {
      uint32_t side = acting[count] = world->list.sides.items[k];
      count += scree_pair_touches(world, side >> 1);
    }
    ends[i - begin] = count;
  }
  return acting;
}

enum { FORCES_AHEAD = 10 };

SCREE_PREFETCHES void fetch_load(const scree_world *world, size_t i) {
  const scree_spheres *s = &world->spheres;
  if (s->list.pairs.count && i < s->list.body_count && s->list.place_of[i] != scree_none)
    scree_prefetch(&s->load[s->list.place_of[i]], sizeof *s->load);
}

/* The load on a body of its contacts with spheres. */
static scree_sphere_load load_of(const scree_world *world, size_t i) {
  const scree_spheres *s = &world->spheres;
  const uint32_t place = s->list.pairs.count ? s->list.place_of[i] : scree_none;
  return place == scree_none ? (scree_sphere_load){{0, 0, 0}, {0, 0, 0}} : s->load[place];
}

/* Forces in the fixed order of the pairs: of the body's sides, acting[from] to acting[to]; of those
 * up to acting[count] the next are asked for. */
static void sum_forces(scree_world *world, size_t i, const uint32_t *acting, size_t from, size_t to,
                       size_t count) {
  const scree_sphere_load of_spheres = load_of(world, i);
  vec3 force = of_spheres.force, torque = of_spheres.torque;
  for (size_t k = from; k < to; k++) {
    if (k + FORCES_AHEAD < count)
      scree_prefetch(scree_pair_of(world, acting[k + FORCES_AHEAD] >> 1), 128);
    const scree_pair_wrench *w = &scree_pair_of(world, acting[k] >> 1)->contact.wrench;
    bool of_b = acting[k] & 1;
    force = vec3_mad(force, w->force, of_b ? -1 : 1);
    torque = vec3_add(torque, of_b ? w->torque_b : w->torque_a);
  }
  if (world->joints.all.count) scree_joints_add(world, i, &force, &torque);
  if (world->bodies.applied) {
    const scree_wrench *applied = &world->bodies.applied[i].now;
    force = vec3_add(force, applied->force);
    torque = vec3_add(torque, applied->moment);
  }
  world->bodies.force[i] = force;
  world->bodies.torque[i] = torque;
}

/* Most that a point of the box moves by the spin (both in the body's frame). */
static double fastest_point(vec3 spin, const scree_box *box) {
  double x = scree_max(-box->low.x, box->high.x), y = scree_max(-box->low.y, box->high.y),
         z = scree_max(-box->low.z, box->high.z), u = fabs(spin.x), v = fabs(spin.y),
         w = fabs(spin.z);
  return vec3_norm((vec3){v * z + w * y, w * x + u * z, u * y + v * x});
}

static bool is_sphere(const scree_bodies *b, size_t i) {
  return b->particle[i]->measures.kind == SCREE_PARTICLE_SPHERE;
}

/* How far the body's points, of a sphere its centre, may move in the coming step; the spin in it is
 * kept for the step. */
static double coming_travel(scree_world *world, size_t i) {
  scree_bodies *b = &world->bodies;
  const scree_frame *frame = &b->frame[i];
  double dt = world->time_step;
  vec3 g = vec3_load(world->options.gravity);
  vec3 v = vec3_mad(frame->velocity, vec3_mad(g, b->force[i], 1 / b->mass[i]), dt);
  if (is_sphere(b, i)) return vec3_norm(v) * dt;
  vec3 momentum = vec3_mad(b->momentum[i], b->torque[i], dt);
  b->turn[i] = scree_local_spin(b->inertia[i], &frame->rotation, momentum);
  return (vec3_norm(v) + fastest_point(b->turn[i], &b->particle[i]->box)) * dt;
}

/* Most a body may move in a step; pairs have a limit of their own (contact.c). */
static double travel_limit(const scree_world *world, size_t i) {
  return world->options.overlap_limit * scree_size_in(world, world->bodies.particle[i]);
}

typedef struct gathering {
  scree_world *world;
  size_t *offender; /* by block: first body beyond its limit; SIZE_MAX for none */
} gathering;

bool scree_gather_body(scree_world *world, size_t i) {
  size_t end = 0;
  const uint32_t *acting = list_acting(world, i, i + 1, &end);
  sum_forces(world, i, acting, 0, end, end);
  world->bodies.travel[i] = coming_travel(world, i);
  return world->bodies.travel[i] <= travel_limit(world, i);
}

static void gather_block(void *context, scree_block block) {
  gathering *g = context;
  g->offender[block.index] = SIZE_MAX;
  size_t ends[BODY_BLOCK], from = 0;
  const uint32_t *acting = list_acting(g->world, block.begin, block.end, ends);
  for (size_t i = block.begin; i < block.end; from = ends[i++ - block.begin]) {
    if (g->world->bodies.removed[i]) continue;
    fetch_load(g->world, i + FORCES_AHEAD);
    sum_forces(g->world, i, acting, from, ends[i - block.begin], ends[block.end - block.begin - 1]);
    double travel = coming_travel(g->world, i);
    g->world->bodies.travel[i] = travel;
    if (!(travel <= travel_limit(g->world, i)) && g->offender[block.index] == SIZE_MAX)
      g->offender[block.index] = i;
  }
}

scree_status scree_describe_offender(scree_world *world, size_t i) {
  double travel = world->bodies.travel[i];
  world->failed_wall = 0;
  if (!isfinite(travel))
    return scree_fail(&world->failure, SCREE_DIVERGED,
                      "world: step %llu, body %zu: the forces on it are not finite",
                      (unsigned long long)world->step_count, i);
  return scree_fail(&world->failure, SCREE_DIVERGED,
                    "world: step %llu, body %zu would move %.3g m in one step of %.3g s; at most "
                    "%.3g m (the overlap limit)",
                    (unsigned long long)world->step_count, i, travel, world->time_step,
                    travel_limit(world, i));
}

bool scree_world_gather(scree_world *world) {
  gathering g = {world, world->workspace.offenders};
  scree_parallel_for(world->bodies.count, BODY_BLOCK, gather_block, &g);
  size_t blocks = scree_block_count(world->bodies.count, BODY_BLOCK);
  for (size_t block = 0; block < blocks; block++) {
    size_t i = world->workspace.offenders[block];
    if (i == SIZE_MAX) continue;
    scree_describe_offender(world, i);
    return false;
  }
  return true;
}

/* The work of an applied force, by the velocities before and after each kick: the second half of
 * the last step and the first of this one. */
static void add_applied_work(scree_applied *applied, const scree_frame *frame, double dt) {
  vec3 force = vec3_add(applied->now.force, applied->last.force),
       torque = vec3_add(applied->now.moment, applied->last.moment);
  applied->work += 0.5 * dt * (vec3_dot(force, frame->velocity) + vec3_dot(torque, frame->spin));
  applied->last = applied->now;
}

/* About its momentum, which is no other axis in space than in the body. */
static void turn_sphere(scree_bodies *b, size_t i, double dt) {
  scree_frame *frame = &b->frame[i];
  const double ease = 1 / b->inertia[i].x;
  vec3 momentum = vec3_mad(b->momentum[i], b->torque[i], dt), spin = vec3_scale(momentum, ease);
  b->momentum[i] = momentum;
  if (vec3_norm2(spin) > 0) { /* else it stands */
    quat turn = quat_from_rotation_vector(vec3_scale(spin, dt));
    b->orientation[i] = quat_unit(quat_mul(turn, b->orientation[i]));
    frame->rotation = quat_to_mat3(b->orientation[i]);
  }
  frame->spin = spin;
  frame->spin_now = vec3_mad(spin, b->torque[i], 0.5 * dt * ease);
}

static void turn_body(scree_bodies *b, size_t i, double dt) {
  scree_frame *frame = &b->frame[i];
  vec3 momentum = vec3_mad(b->momentum[i], b->torque[i], dt);
  quat q = b->orientation[i];
  q = scree_turned(&q, b->turn[i], b->inertia[i], momentum, dt);
  mat3 rotation = quat_to_mat3(q);
  b->momentum[i] = momentum;
  b->orientation[i] = q;
  frame->rotation = rotation;
  frame->spin = scree_spin_of(b, i, &rotation, momentum);
  frame->spin_now = scree_spin_of(b, i, &rotation, vec3_mad(momentum, b->torque[i], 0.5 * dt));
}

void scree_advance_body(scree_world *world, size_t i) {
  scree_bodies *b = &world->bodies;
  scree_frame *frame = &b->frame[i];
  double dt = world->time_step;
  if (b->applied) add_applied_work(&b->applied[i], frame, dt);
  vec3 g = vec3_load(world->options.gravity);
  vec3 acceleration = vec3_mad(g, b->force[i], 1 / b->mass[i]);
  frame->velocity = vec3_mad(frame->velocity, acceleration, dt);
  frame->velocity_now = vec3_mad(frame->velocity, acceleration, 0.5 * dt);
  frame->position = vec3_mad(frame->position, frame->velocity, dt);
  if (is_sphere(b, i))
    turn_sphere(b, i, dt);
  else
    turn_body(b, i, dt);
  b->path[i] += b->travel[i];
  scree_set_body_wake_threshold(world, i);
}

static void advance_block(void *context, scree_block block) {
  scree_world *world = context;
  for (size_t i = block.begin; i < block.end; i++)
    if (!world->bodies.removed[i]) scree_advance_body(world, i);
}

void scree_world_advance(scree_world *world) {
  scree_parallel_for(world->bodies.count, BODY_BLOCK, advance_block, world);
  for (size_t w = 0; w < world->walls.count; w++) scree_wall_advance(world, w);
  if (world->options.floor_height == -INFINITY) return;
  for (size_t i = 0; i < world->bodies.count; i++)
    if (!world->bodies.removed[i] &&
        world->bodies.frame[i].position.z < world->options.floor_height)
      scree_body_remove(world, i);
}
