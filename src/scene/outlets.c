/* Outlets: bodies whose centre is in one, or beyond the domain, are taken out and booked, with all
 * that hangs together with them. A domain that the scene does not name is looked at with every row
 * of the series only. */
#include "scene/scene.h"
#include "world/state/remote.h"

#include <string.h>

/* Kinetic and potential energy of a body as it stands. */
static double energy_of(const scree_scene *scene, size_t b, const scree_body *body) {
  scree_particle_measures m;
  scree_particle_measure(scree_world_body_particle(scene->world, b), &m);
  double mass = scree_world_body_mass(scene->world, b), density = mass / m.volume;
  mat3 turn = quat_to_mat3(scree_body_turn(body));
  vec3 spin = mat3_tmul_vec(&turn, vec3_load(body->angular_velocity));
  double rotation = density * (m.inertia[0] * spin.x * spin.x + m.inertia[1] * spin.y * spin.y +
                               m.inertia[2] * spin.z * spin.z);
  vec3 g = vec3_load(scene->plan.gravity);
  scree_world_bring(scene->world, SCREE_PART_POSES, NULL);
  return 0.5 * (mass * vec3_norm2(vec3_load(body->velocity)) + rotation) -
         mass * vec3_dot(g, scene->world->bodies.frame[b].position); /* not folded, as the ledger */
}

/* The outlet that a centre is in; their count: none. */
static size_t outlet_at(const scree_scene *scene, const double p[3], double time) {
  size_t count = scene->plan.outlets.count;
  for (size_t i = 0; i < count; i++) {
    const scree_plan_outlet *o = &scene->plan.outlets.items[i];
    if (time >= o->from && (isnan(o->until) || time < o->until) &&
        scree_is_in(p, o->box->min, o->box->max))
      return i;
  }
  return count;
}

static void take_body(scree_scene *scene, size_t b, scree_scene_outlet *outlet) {
  double mass = scree_world_body_mass(scene->world, b);
  scree_body body;
  scree_world_get_body(scene->world, b, &body);
  outlet->mass += mass;
  scene->left_mass += mass;
  scene->left_energy += energy_of(scene, b, &body);
  scene->shapes[scene->shape_of.items[b]].left++;
  scree_world_remove_body(scene->world, b);
}

/* What the joints between those that go keep, J. */
static double energy_of_joints(const scree_scene *scene, size_t leader) {
  const scree_joints *joints = &scene->world->joints;
  double sum = 0;
  scree_world_bring(scene->world, SCREE_PART_JOINTS, NULL);
  for (size_t k = 0; k < joints->all.count; k++)
    if (scree_world_leader(scene->world, joints->all.items[k].a) == leader)
      sum += joints->all.items[k].energy;
  return sum;
}

/* A body that counts, and those for which it does. */
static void take_out(scree_scene *scene, size_t b, const scree_body *body, size_t index) {
  scree_scene_outlet *outlet = &scene->outlets[index];
  size_t end = scree_world_joint_count(scene->world) ? scene->shape_of.count : b + 1;
  scene->stays.items[b].left = scree_world_time(scene->world);
  scene->stays.items[b].outlet = (uint32_t)index;
  if (outlet->left == 0) {
    outlet->first_time = scree_world_time(scene->world);
    memcpy(outlet->first_place, body->position, sizeof outlet->first_place);
  }
  outlet->left++;
  scene->left_count++;
  scene->left_energy += energy_of_joints(scene, b);
  for (size_t k = b; k < end; k++)
    if (scree_world_leader(scene->world, k) == b && !scree_world_body_removed(scene->world, k))
      take_body(scene, k, outlet);
}

void scree_scene_empty(scree_scene *scene) {
  const scree_plan_domain *d = scene->plan.domain;
  size_t rim = scene->plan.outlets.count;
  double time = scree_world_time(scene->world);
  if (!d && rim == 0) return;
  scree_body body;
  for (size_t b = 0; scree_scene_next_body(scene, &b, &body); b++) {
    size_t outlet = outlet_at(scene, body.position, time);
    if (!scree_scene_counts(scene, b)) continue;
    if (outlet < rim || (d && !scree_is_in(body.position, d->min, d->max)))
      take_out(scene, b, &body, outlet);
  }
}

void scree_scene_take_lost(scree_scene *scene) {
  if (scene->plan.domain) return;
  scree_scene_reach reach = scree_scene_domain(scene);
  scree_body body;
  for (size_t b = 0; scree_scene_next_body(scene, &b, &body); b++) {
    if (scree_scene_counts(scene, b) && !scree_is_in(body.position, reach.low, reach.high))
      take_out(scene, b, &body, scene->plan.outlets.count);
  }
}

bool scree_scene_loss_of(const scree_scene *scene, scree_scene_loss *loss) {
  const scree_scene_outlet *rim = &scene->outlets[scene->plan.outlets.count];
  scree_scene_reach reach = scree_scene_domain(scene);
  *loss = (scree_scene_loss){.count = rim->left,
                             .mass = rim->mass,
                             .first_time = rim->first_time,
                             .is_meant = scene->plan.domain != NULL};
  memcpy(loss->first_place, rim->first_place, sizeof loss->first_place);
  const scree_plan_domain *d = scene->plan.domain;
  memcpy(loss->low, d ? d->min : reach.low, sizeof loss->low);
  memcpy(loss->high, d ? d->max : reach.high, sizeof loss->high);
  return rim->left > 0;
}
