/* Observables, from sums that a device makes where the state is there (sums.h). */
#include "world/observe/sums.h"
#include "world/state/joints.h"
#include "world/state/remote.h"

#include "base/file.h"

static scree_sums sums_of(const scree_world *world) {
  scree_sums all = {0};
  if (world->residence.on_device && world->residence.remote->sum(world->residence.on_device, &all))
    return all;
  all = (scree_sums){0};
  for (size_t part = 0; part < scree_sum_part_count(world); part++) {
    scree_sums sums = scree_sum_part(world, part);
    scree_sums_merge(&all, &sums);
  }
  return all;
}

scree_world_hardening scree_world_get_hardening(const scree_world *world, size_t material_a,
                                                size_t material_b) {
  const scree_hardening *h = &world->materials.hardened[scree_hardened_at(material_a, material_b)];
  scree_world_hardening hardening = {.count = h->count};
  memcpy(&hardening.deepest, &h->deepest, sizeof h->deepest);
  memcpy(&hardening.stiffness_missing, &h->missing, sizeof h->missing);
  return hardening;
}

static void sum_hardened(const scree_world *world, scree_observation *o) {
  for (size_t a = 0; a < world->materials.count; a++)
    for (size_t b = a; b < world->materials.count; b++) {
      const scree_world_hardening h = scree_world_get_hardening(world, a, b);
      o->hardened_count += h.count;
      o->stiffness_missing = scree_max(o->stiffness_missing, h.stiffness_missing);
    }
}

void scree_world_observe(const scree_world *world, scree_observation *observation) {
  scree_sums s = sums_of(world);
  const scree_joint_sums joints = scree_joints_sum(world);
  scree_observation o = {.time = world->time,
                         .body_count = (size_t)s.bodies,
                         .removed_count = (size_t)s.removed,
                         .pair_count = (size_t)s.pairs,
                         .depenetrating_pairs = (size_t)s.depenetrating,
                         .contact_count = (size_t)s.contacts,
                         .kinetic = scree_sum_value(s.kinetic),
                         .rotational = scree_sum_value(s.rotational),
                         .potential = scree_sum_value(s.potential),
                         .elastic = scree_sum_value(s.elastic) + joints.elastic,
                         .highest_speed = s.speed,
                         .largest_overlap = world->largest_overlap,
                         .coordination = s.bodies ? (double)s.body_sides / (double)s.bodies : 0,
                         .mean_rotation =
                             s.bodies ? scree_sum_value(s.rotation) / (double)s.bodies : 0,
                         .dissipated_dashpot = joints.damped - scree_sum_value(s.dashpot),
                         .dissipated_friction = joints.rubbed - scree_sum_value(s.tangential) -
                                                scree_sum_value(s.tangential_elastic),
                         .fracture = joints.fracture,
                         .broken_joints = joints.broken_count,
                         .wall_work = scree_sum_value(s.wall),
                         .applied_work = scree_sum_value(s.applied),
                         .depenetration_count = world->depenetration_count};
  sum_hardened(world, &o);
  for (int k = 0; k < 3; k++) {
    o.momentum[k] = scree_sum_value(s.momentum[k]);
    o.angular_momentum[k] = scree_sum_value(s.angular[k]);
  }
  *observation = o;
}

/* ---- hash ---- */

static void mix(scree_checksum *hash, const void *bytes, size_t count) {
  struct {
    scree_checksum before, now;
  } both = {*hash, scree_checksum_of(bytes, count)};
  *hash = scree_checksum_of(&both, sizeof both);
}

scree_checksum scree_world_hash(const scree_world *world) {
  scree_checksum hash = {0};
  scree_world_bring(world, SCREE_ALL_PARTS, NULL);
  const scree_bodies *b = &world->bodies;
  mix(&hash, &world->time, sizeof world->time);
  mix(&hash, &world->step_count, sizeof world->step_count);
  for (size_t i = 0; i < b->count; i++) {
    if (b->removed[i]) continue;
    const vec3 vectors[3] = {b->frame[i].position, b->frame[i].velocity, b->momentum[i]};
    mix(&hash, vectors, sizeof vectors);
    mix(&hash, &b->orientation[i], sizeof b->orientation[i]);
  }
  for (size_t k = 0; k < world->list.neighbours.count; k++) {
    const scree_pair *pair = scree_pair_of(world, k);
    if (pair && pair->spheres) {
      const uint32_t names[2] = {pair->a, pair->b};
      mix(&hash, names, sizeof names);
      mix(&hash, &pair->sphere.slid, sizeof pair->sphere.slid);
    }
    for (uint32_t i = 0; pair && i < pair->active.count; i++) {
      const scree_feature_pair *feature = &world->pools.features[pair->active.first + i];
      const scree_further *further = &world->pools.further[pair->active.first + i];
      const uint32_t names[5] = {pair->a, pair->b, feature->kind, feature->a, feature->b};
      mix(&hash, names, sizeof names);
      for (int j = 0; j < (feature->notched ? SCREE_ANCHORS : 1); j++) {
        const scree_anchor *anchor = j ? &further->anchor[j - 1] : &feature->anchor;
        if (anchor->weight <= 0) continue;
        mix(&hash, &anchor->stretch, sizeof anchor->stretch);
        mix(&hash, &anchor->weight, sizeof anchor->weight);
      }
    }
  }
  for (size_t k = 0; k < world->spheres.list.pairs.count; k++) {
    const scree_sphere_pair *two = &world->spheres.list.pairs.items[k];
    if (!scree_spheres_touch(two)) continue;
    const scree_sphere_contact *c =
        &world->spheres.list.contacts.items[two->contact & ~scree_sphere_touches];
    const uint32_t names[2] = {world->spheres.list.body[two->a], world->spheres.list.body[two->b]};
    mix(&hash, names, sizeof names);
    mix(&hash, &c->slid, sizeof c->slid);
  }
  return hash;
}
