/* Hits of two bodies, shared by the law tests. */
#pragma once

#include "base/vec.h"
#include "scree.h"

/* Two of the particle meet at 2 m/s, turned and spinning at random by `number`. Without damping and
 * friction: the energy after over that before. Damped: the highest energy at any time over that
 * before. */
double law_random_hit(scree_particle *particle, double steps, uint64_t number, bool damped);

/* How deep a point of space lies in a body, m; 0 outside. */
double law_depth_in(const scree_world *world, size_t body, vec3 at);

typedef struct law_meeting {
  const char *name;
  scree_particle *upper, *lower;
  quat upper_turn, lower_turn;
  double shift, tilt, offset; /* random shift (m) and tilt (rad) of the upper; its x offset */
} law_meeting;

typedef struct law_outcome {
  size_t stuck, through, stopped;
  bool follow;   /* given: edges too are looked at, and every twentieth step */
  double unfelt; /* m: the deepest that lay inside the other with less than half its overlap */
} law_outcome;

/* The two of the meeting hit each other head-on at this speed, try `number`. Counted in out: still
 * pressed together long after, a corner of one inside the other that is not felt or the two past
 * each other, and runs that stopped. */
void law_meet(const law_meeting *m, double speed, uint64_t number, law_outcome *out);
