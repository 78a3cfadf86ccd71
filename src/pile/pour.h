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
  scree_pour_schedule schedule;
};

extern const scree_seal scree_pour_seal;

/* Of a pour that is not completed. */
static const scree_pour_schedule scree_endless_pour = {1e9, 0, 0, 0, 1e9, 60};

/* pour.c: a pour without a scene, its pitch and width measured, endless; and its scene's file. */
scree_status scree_pour_describe(const scree_pour_shape *shapes, size_t shape_count,
                                 const scree_pour_options *options, scree_pour **pour,
                                 scree_error *error);
scree_status scree_pour_file(const scree_pour *pour, scree_scene_file **file, scree_error *error);
/* Makes its scene. */
scree_status scree_pour_make_scene(scree_pour *pour, const scree_pour_shape *shapes,
                                   scree_error *error);

/* pour_save.c: what a scene does not say of its pour, as its notes; and the pour of a scene that
 * was loaded from path, which it then owns. */
scree_status scree_pour_pack_notes(const scree_pour *pour, unsigned char **bytes,
                                   size_t *byte_count, scree_error *error);
scree_status scree_pour_of_scene(scree_scene *scene, const char *path, scree_pour **pour,
                                 scree_error *error);

#endif
