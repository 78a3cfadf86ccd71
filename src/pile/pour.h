/* What the parts of a pour share. */
#ifndef SCREE_PILE_POUR_H
#define SCREE_PILE_POUR_H

#include "scene/motion.h"
#include "world/world.h"

struct scree_pour {
  scree_pour_options options;
  scree_world *world;
  size_t *shape_of;           /* by particle, in the order of entering */
  scree_particle **particles; /* by shape; held */
  size_t *counts;             /* by shape */
  char **texts;               /* name and source by shape; NULL: none */
  double *radii;              /* bounding, by particle */
  size_t shape_count, count, entered_count, layer_count;
  double pitch, time_step, entered_energy;
  uint64_t layer_steps; /* from one layer to the next */
  uint64_t layers;
  vec3 *cells; /* centres, z = 0 */
  uint32_t *cell_order;
  size_t cell_count;
  scree_motion_file motion; /* of no stream: nothing is recorded */
  double *notes;            /* the caller's, kept with a checkpoint */
  size_t note_count;
};

/* A world as the pour begins with, but for the options, with one body of each shape. */
scree_status scree_pour_make_gallery(const scree_pour *pour, scree_world **gallery,
                                     scree_error *error);

#endif
