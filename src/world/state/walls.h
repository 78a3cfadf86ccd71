/* Walls: sides and distances, motions, forces and work. */
#pragma once

#include "world/state/world.h"

/* Which side of an analytic wall p (wall frame) is on: 1 in front of the plane or disc, inside the
 * cylinder; -1 for the other side of a disc or cylinder. */
double scree_wall_side(const scree_world_wall *wall, vec3 p);
/* Whether a disc or cylinder lies straight below, above or beside p, not past a rim. */
bool scree_wall_spans(const scree_world_wall *wall, vec3 p);
/* The side of a point that is seen for the first time: the centre's, where the sheet spans it and p
 * is less than `clearance` behind; else its own. */
double scree_wall_first_side(const scree_world_wall *wall, vec3 p, vec3 centre, double clearance);
/* The same of a point where it spans it; else 0, for none. */
static inline double scree_wall_side_at(const scree_world_wall *wall, vec3 p) {
  return scree_wall_spans(wall, p) ? scree_wall_side(wall, p) : 0;
}
/* Signed distance of p (wall frame) on that side, with the closest point and the normal. */
double scree_wall_distance(const scree_world_wall *wall, vec3 p, double side, vec3 *closest,
                           vec3 *normal);
/* The same of a point that came from this side, or 0: from where it is. The side becomes that from
 * which it is met, another one where it is past the rim. */
double scree_wall_distance_from(const scree_world_wall *wall, vec3 p, double *side, vec3 *closest,
                                vec3 *normal);

static inline bool scree_wall_is_belt(const scree_world_wall *wall) {
  return vec3_norm2(wall->surface_velocity) + vec3_norm2(wall->surface_spin) +
             vec3_norm2(wall->surface_loop) >
         0;
}
/* How a belt's surface moves along itself at a point of it that is met with normal n; all in the
 * wall's frame. */
vec3 scree_belt_velocity(const scree_world_wall *wall, vec3 at, vec3 n);
scree_status scree_check_wall_velocities(const scree_world *world, size_t index,
                                         const double *velocity, const double *angular_velocity,
                                         scree_error *error);
/* From now on. */
void scree_wall_set_velocity(scree_world *world, size_t index, vec3 velocity, vec3 spin);
/* Power on bodies of forces and torques on them, about the wall's position, with the velocities of
 * the last drift; and of a belt's friction, by its motion along itself. */
static inline double scree_wall_power(const scree_world_wall *wall, const scree_wrench *all,
                                      double belt_power) {
  const scree_frame *frame = &wall->frame;
  return vec3_dot(all->force, frame->velocity) + vec3_dot(all->moment, frame->spin) + belt_power;
}
/* Force and torque on wall w from the pairs of the last step, its power and its work so far: when
 * they are asked for, or what they follow from is about to change. */
void scree_wall_sum(const scree_world *world, size_t w);
void scree_walls_settle(const scree_world *world);
/* The work alone, from the ledger. */
double scree_wall_work(const scree_world *world, size_t w);
/* How far from its position a wall extends; INFINITY for planes and endless cylinders. */
double scree_wall_extent(const scree_world_wall *wall);
/* motion.c: the wall's drift. */
void scree_wall_advance(scree_world *world, size_t index);
/* Where its motions have it at a time; without any where it is. */
void scree_wall_place(const scree_world *world, size_t w, double time, vec3 *position,
                      mat3 *rotation);
