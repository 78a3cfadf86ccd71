/* A pour is a scene that is made from its options: what its parts share. */
#ifndef SCREE_PILE_POUR_H
#define SCREE_PILE_POUR_H

#include "scene/scene.h"

struct scree_pour {
  scree_pour_options options;
  char **names;   /* by shape; "": none */
  size_t *counts; /* by shape */
  size_t shape_count;
  double pitch; /* m, of the grid */
  scree_scene *scene;
  scree_motion_file motion; /* of no stream: nothing is recorded */
  double *notes;            /* the caller's, kept with a checkpoint */
  size_t note_count;
};

extern const scree_seal scree_pour_seal;

/* pour.c: a pour without a scene, its pitch and width measured; and its scene's file. */
scree_status scree_pour_describe(const scree_pour_shape *shapes, size_t shape_count,
                                 const scree_pour_options *options, scree_pour **pour,
                                 scree_error *error);
scree_status scree_pour_file(const scree_pour *pour, scree_scene_file **file, scree_error *error);

#endif
