/* A run of the experiment: what its parts share. */
#ifndef SCREE_PILE_RUN_H
#define SCREE_PILE_RUN_H

#include "scene/fill.h"
#include "world/world.h"

struct scree_run {
  scree_experiment experiment; /* preset owned */
  scree_world *world;
  scree_world *gallery; /* one body of each shape, never moved: keeps the particles, and is packed
                           with a checkpoint for those that have not entered yet */
  scree_run_shape *shapes;
  char **names;             /* of the shapes: the strings that shapes[i].name points to */
  scree_placement *extents; /* of each shape, clearance included */
  size_t *materials;
  size_t shape_count;
  uint32_t *order;      /* shape of each particle */
  size_t entered_count; /* particles in the world */
  size_t layer_count;   /* layers that have entered */
  double layer_interval, entry_speed, inlet_height, layer_height, clearance;
  double size;         /* m, mean over the particles */
  double solid_volume; /* m3 of all particles */
  size_t cylinder;     /* wall index */
  scree_phase phase;
  double phase_start; /* s */
  double still_since; /* s; NaN while moving */
  scree_placement *placements, *present;
  struct {
    scree_run_point *items;
    size_t count, capacity;
  } series;
  uint64_t particle_steps;
  double wall_seconds, processor_seconds;
  size_t piece_count;
  bool is_frame; /* loaded from a frame: no contacts, cannot go on */
  double frame_time, frame_coordination, frame_kinetic;
};

/* run_save.c: a checkpoint of a run, for scree_world_keep_all. */
scree_status scree_run_pack(const void *run, unsigned char **bytes, size_t *byte_count,
                            scree_error *error);

/* run.c: a run without a world; its plan follows from experiment and shapes. */
scree_status scree_run_plan(const scree_experiment *experiment, const scree_run_shape *shapes,
                            size_t shape_count, scree_run **run, scree_error *error);
/* A world with the materials and walls of the run, the cylinder's lower end at a height. */
scree_status scree_run_make_world(const scree_run *run, double cylinder_height, double time_step,
                                  scree_world **world, scree_error *error);

/* fill_run.c: layers, speed and height of the inlet; and the next layer into the world. */
scree_status scree_run_plan_filling(scree_run *run, scree_error *error);
scree_status scree_run_enter_layer(scree_run *run, scree_error *error);

/* series.c: whether the settings suit the particles; the moment as it is, without angles; and the
 * next point of the series, with angles where they are due or asked for. */
scree_status scree_run_check_measure(const scree_run *run, const scree_experiment *measure,
                                     scree_error *error);
scree_run_point scree_run_point_now(const scree_run *run);
scree_status scree_run_record(scree_run *run, bool last, scree_error *error);

#endif
