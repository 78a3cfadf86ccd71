/* A run of the experiment is a scene that is made from it: what its parts share. */
#ifndef SCREE_PILE_RUN_H
#define SCREE_PILE_RUN_H

#include "scene/scene.h"

struct scree_run {
  scree_experiment experiment; /* preset owned */
  scree_run_shape *shapes;     /* particles held */
  char **names;                /* name and source of each shape: what shapes[i] points to */
  size_t shape_count;
  double size;         /* m, mean over the particles */
  double solid_volume; /* m3, of all particles */
  scree_scene *scene;
  struct {
    scree_run_point *items; /* the rows of the scene's series */
    size_t count, capacity;
  } series;
};

extern const scree_seal scree_run_seal;

/* run.c: a run of its own without a scene, its size measured; the shapes' particles are held. */
scree_status scree_run_describe(const scree_experiment *experiment, const scree_run_shape *shapes,
                                size_t shape_count, scree_run **run, scree_error *error);

/* run_scene.c: the run as a scene's file. */
scree_status scree_run_file(const scree_run *run, scree_scene_file **file, scree_error *error);

/* run_save.c: what a scene does not say of its run, as its notes; and the run of a scene that was
 * loaded from path, which it then owns. */
scree_status scree_run_pack_notes(const scree_run *run, unsigned char **bytes, size_t *byte_count,
                                  scree_error *error);
scree_status scree_run_of_scene(scree_scene *scene, const char *path, scree_run **run,
                                scree_error *error);

/* series.c: the settings of measuring; whether they suit the particles; the moment as it is,
 * without angles; and the points of rows that are new. */
scree_plan_pile scree_run_pile(const scree_run *run, const scree_experiment *measure);
scree_status scree_run_check_measure(const scree_run *run, const scree_experiment *measure,
                                     scree_error *error);
scree_run_point scree_run_point_now(const scree_run *run);
scree_status scree_run_follow(scree_run *run, scree_error *error);

#endif
