/* An experiment that a few small particles go through in a moment. */
#ifndef SCREE_TEST_POT_H
#define SCREE_TEST_POT_H

#include "scree.h"

/* Of the preset `paper`: a pot of 80 mm, lifted at 1 m/s after a tenth of a second. */
static inline void use_pot(scree_experiment *e, size_t particle_count) {
  e->particle_count = particle_count;
  e->cylinder_diameter = 0.08;
  e->disc_diameter = 0.3;
  e->pack_time = 0.1;
  e->settle_time = 0.05;
  e->lift_speed = 1;
  e->lift_time = 0.08;
  e->hold_time = 0.02;
  e->drop_height = 0.01;
  e->young_particle = 1e7; /* fewer steps */
}

#endif
