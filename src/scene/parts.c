/* Walls that forces move: one coordinate q, a way along a direction or an angle about an axis, with
 * a mass or a moment of inertia M.
 *
 * Between two steps, with Q the force along q of bodies, gravity, spring and drive and c the
 * damper,
 *
 *     u = (u (1 - c dt/2M) + Q dt/M)/(1 + c dt/2M),   q = q + u dt
 *
 * The bodies' part of Q is known of the last step; it is led on to the coming one by its slope, so
 * that the part and what touches it exchange no energy that neither has. The wall gets the
 * velocity that takes it to its place in the coming step, on the circle for a hinge. At an end it
 * stops, and what it moved with is lost. A servo has no mass: u is its speed times the share of the
 * force that is missing, at most that speed. */
#include "scene/plan_fields.h"
#include "scene/scene.h"

#include "world/state/walls.h"

#include "base/math.h"

/* ---- the plan ---- */

static scree_status check_servo(const scree_reader *r, const void *record) {
  const scree_plan_servo *s = record;
  if (!given(&s->force) || !given(&s->speed) || s->force == 0)
    return scree_fail_place(r, &s->place, "needs what it keeps, not 0, and a speed");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_servo, SCREE_PLAN_SERVO, "servo", NULL, check_servo)
SCREE_RECORD_TABLE(scree_plan_turning_servo, SCREE_PLAN_TURNING_SERVO, "servo", NULL, check_servo)

static scree_status check_part(const scree_reader *r, const scree_plan_part *p, double inertia,
                               const char *what) {
  if (!p->servo && isnan(inertia)) return scree_fail_place(r, &p->place, "needs %s", what);
  if (p->servo && (p->spring != 0 || p->damper != 0 || p->force != 0 || p->amplitude != 0))
    return scree_fail_place(r, &p->place, "a servo stands instead of spring, damper and drive");
  if (given(&p->least) && given(&p->most) && !(p->least < p->most))
    return scree_fail_place(r, &p->place, "least %g must be below most %g", p->least, p->most);
  if ((given(&p->least) && p->least > 0) || (given(&p->most) && p->most < 0))
    return scree_fail_place(r, &p->place, "it begins at 0, which must lie between its ends");
  return SCREE_OK;
}

static scree_status check_slide(const scree_reader *r, const void *record) {
  const scree_plan_part *p = record;
  return check_part(r, p, p->mass, "a mass or a servo");
}
static scree_status check_hinge(const scree_reader *r, const void *record) {
  const scree_plan_part *p = record;
  return check_part(r, p, p->inertia, "an inertia or a servo");
}

SCREE_RECORD_TABLE(scree_plan_slide, SCREE_PLAN_SLIDE, "a slide", NULL, check_slide)
SCREE_RECORD_TABLE(scree_plan_hinge, SCREE_PLAN_HINGE, "a hinge", NULL, check_hinge)

static const scree_plan_part *plan_of(const scree_scene *scene, size_t geometry) {
  const scree_plan_geometry *g = &scene->plan.geometry.items[geometry];
  return g->slide ? g->slide : g->hinge;
}

static bool turns(const scree_scene *scene, size_t geometry) {
  return scene->plan.geometry.items[geometry].hinge != NULL;
}

static vec3 axis_of(const scree_plan_part *plan) {
  return vec3_unit(vec3_load(plan->axis));
}

scree_status scree_scene_plan_parts(scree_scene *scene, scree_error *error) {
  size_t count = scene->plan.geometry.count;
  for (size_t i = 0; i < count; i++) {
    if (!plan_of(scene, i)) continue;
    scree_scene_part *part = scree_arena_take(&scene->arena, 1, sizeof *part);
    if (!part) return scree_fail_memory(error, sizeof *part, "a machine's part");
    *part = (scree_scene_part){0};
    scene->geometry[i].part = part;
    scene->has_parts = true;
  }
  return SCREE_OK;
}

/* ---- forces ---- */

double scree_scene_push(const scree_scene *scene, size_t geometry) {
  const scree_plan_part *plan = plan_of(scene, geometry);
  const scree_scene_geometry *g = &scene->geometry[geometry];
  vec3 axis = axis_of(plan);
  double sum = 0;
  for (size_t w = g->first_wall; w < g->first_wall + g->wall_count; w++) {
    double force[3], torque[3];
    scree_wall wall;
    scree_world_wall_force(scene->world, w, force, torque);
    scree_world_get_wall(scene->world, w, &wall);
    vec3 f = vec3_load(force), arm = vec3_sub(vec3_load(wall.position), vec3_load(plan->through));
    sum += turns(scene, geometry) ? vec3_dot(axis, vec3_add(vec3_load(torque), vec3_cross(arm, f)))
                                  : vec3_dot(axis, f);
  }
  return sum;
}

/* Where the centre of mass is of a hinge at q, from its axis. */
static vec3 arm_of_centre(const scree_plan_part *plan, double q) {
  mat3 turn = quat_to_mat3(quat_from_rotation_vector(vec3_scale(axis_of(plan), q)));
  return mat3_mul_vec(&turn, vec3_sub(vec3_load(plan->centre), vec3_load(plan->through)));
}

static double weight_of(const scree_scene *scene, size_t geometry, double q) {
  const scree_plan_part *plan = plan_of(scene, geometry);
  vec3 g = vec3_scale(vec3_load(scene->plan.gravity), plan->mass);
  if (!turns(scene, geometry)) return vec3_dot(axis_of(plan), g);
  if (isnan(plan->centre[0])) return 0;
  return vec3_dot(axis_of(plan), vec3_cross(arm_of_centre(plan, q), g));
}

/* J, of gravity and the spring; the change since q = 0. */
static double potential_of(const scree_scene *scene, size_t geometry, double q) {
  const scree_plan_part *plan = plan_of(scene, geometry);
  vec3 g = vec3_scale(vec3_load(scene->plan.gravity), plan->mass), moved = {0, 0, 0};
  if (!turns(scene, geometry))
    moved = vec3_scale(axis_of(plan), q);
  else if (!isnan(plan->centre[0]))
    moved = vec3_sub(arm_of_centre(plan, q), arm_of_centre(plan, 0));
  double stretch = q - plan->rest, first = plan->rest;
  return 0.5 * plan->spring * (stretch * stretch - first * first) - vec3_dot(g, moved);
}

static double drive_of(const scree_plan_part *plan, double time) {
  const double turn = 6.283185307179586;
  double t = time - plan->from;
  return plan->force + plan->amplitude * scree_sin(turn * plan->frequency * t);
}

/* ---- a step ---- */

/* Stops at its ends. */
static void stop_at_ends(const scree_plan_part *plan, double inertia, double dt,
                         scree_scene_part *part) {
  double to = part->way + part->speed * dt, end = to;
  if (!isnan(plan->least)) end = fmax(end, plan->least);
  if (!isnan(plan->most)) end = fmin(end, plan->most);
  if (end == to) return;
  double speed = (end - part->way) / dt;
  part->lost += 0.5 * inertia * (part->speed * part->speed - speed * speed);
  part->speed = speed;
}

static double step_free(const scree_scene *scene, size_t geometry, double push, double time) {
  const scree_plan_part *plan = plan_of(scene, geometry);
  const scree_scene_part *part = scene->geometry[geometry].part;
  double dt = scene->time_step, m = turns(scene, geometry) ? plan->inertia : plan->mass,
         damp = 0.5 * plan->damper * dt / m;
  double all = push + weight_of(scene, geometry, part->way) -
               plan->spring * (part->way - plan->rest) + drive_of(plan, time);
  return (part->speed * (1 - damp) + all * dt / m) / (1 + damp);
}

static double step_servo(const scree_plan_servo *servo, double push) {
  double missing = (servo->force + push) / fabs(servo->force);
  return servo->speed * fmax(-1, fmin(1, missing));
}

/* The velocity that takes a wall from where it stands to where the part is after the step. */
static scree_status lead_wall(const scree_scene *scene, size_t geometry, size_t index,
                              scree_error *error) {
  const scree_plan_part *plan = plan_of(scene, geometry);
  double speed = scene->geometry[geometry].part->speed, dt = scene->time_step, v[3], w[3] = {0};
  vec3 axis = axis_of(plan);
  scree_wall wall;
  scree_world_get_wall(scene->world, index, &wall);
  vec3_store(v, vec3_scale(axis, speed));
  if (turns(scene, geometry)) {
    vec3 arm = vec3_sub(vec3_load(wall.position), vec3_load(plan->through));
    mat3 turn = quat_to_mat3(quat_from_rotation_vector(vec3_scale(axis, speed * dt)));
    vec3_store(w, vec3_scale(axis, speed));
    vec3_store(v, vec3_scale(vec3_sub(mat3_mul_vec(&turn, arm), arm), 1 / dt));
  }
  return scree_world_set_wall_velocity(scene->world, index, v, w, error);
}

static void move(scree_scene *scene, size_t geometry) {
  const scree_plan_part *plan = plan_of(scene, geometry);
  scree_scene_part *part = scene->geometry[geometry].part;
  double time = scree_world_time(scene->world), dt = scene->time_step, before = part->speed,
         m = turns(scene, geometry) ? plan->inertia : plan->mass;
  double now = scree_scene_push(scene, geometry), push = now != 0 ? 2 * now - part->push : 0;
  part->push = now;
  part->given -= 0.5 * now * (part->earlier + before) * dt;
  part->earlier = before;
  if (time < plan->from) return;
  part->speed = plan->servo ? step_servo(plan->servo, now) : step_free(scene, geometry, push, time);
  if (!plan->servo) {
    double mean = 0.5 * (before + part->speed);
    part->work += drive_of(plan, time) * mean * dt;
    part->lost += plan->damper * mean * mean * dt;
  }
  stop_at_ends(plan, plan->servo ? 0 : m, dt, part);
  part->way += part->speed * dt;
}

scree_status scree_scene_move_parts(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    const scree_scene_geometry *g = &scene->geometry[i];
    if (!g->part) continue;
    move(scene, i);
    for (size_t w = 0; w < g->wall_count; w++)
      SCREE_TRY(lead_wall(scene, i, g->first_wall + w, error));
  }
  return SCREE_OK;
}

/* ---- energies ---- */

double scree_scene_part_energy(const scree_scene *scene, size_t geometry) {
  const scree_plan_part *plan = plan_of(scene, geometry);
  const scree_scene_part *part = scene->geometry[geometry].part;
  if (plan->servo) return 0;
  double m = turns(scene, geometry) ? plan->inertia : plan->mass;
  return 0.5 * m * part->speed * part->speed + potential_of(scene, geometry, part->way);
}

/* J, that it has done on bodies by its motion: its walls' work, but for a belt's, of which the
 * drive does a part. Of the last step's forces the first half counts, as in the ledger. */
static double work_on_bodies(const scree_scene *scene, size_t geometry) {
  const scree_scene_geometry *g = &scene->geometry[geometry];
  double sum = 0;
  if (scree_wall_is_belt(scree_world_wall_at(scene->world, g->first_wall)))
    return g->part->given -
           0.5 * scree_scene_push(scene, geometry) * g->part->earlier * scene->time_step;
  for (size_t w = g->first_wall; w < g->first_wall + g->wall_count; w++) {
    double power, energy;
    scree_world_wall_power(scene->world, w, &power, &energy);
    sum += energy;
  }
  return sum;
}

double scree_scene_part_balance(const scree_scene *scene, size_t geometry) {
  const scree_scene_part *part = scene->geometry[geometry].part;
  if (!part || plan_of(scene, geometry)->servo) return 0;
  return scree_scene_part_energy(scene, geometry) + part->lost - part->work +
         work_on_bodies(scene, geometry);
}

double scree_scene_parts_balance(const scree_scene *scene) {
  double sum = 0;
  for (size_t i = 0; i < scene->plan.geometry.count; i++) sum += scree_scene_part_balance(scene, i);
  return sum;
}

double scree_scene_parts_turned(const scree_scene *scene) {
  double sum = 0;
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    const scree_scene_part *part = scene->geometry[i].part;
    if (!part || plan_of(scene, i)->servo) continue;
    const scree_plan_part *plan = plan_of(scene, i);
    double m = turns(scene, i) ? plan->inertia : plan->mass;
    sum += 0.5 * m * part->speed * part->speed + fabs(potential_of(scene, i, part->way)) +
           fabs(part->lost) + fabs(part->work);
  }
  return sum;
}
