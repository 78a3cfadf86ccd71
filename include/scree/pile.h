/* Pile: filling, lifting, pouring. */
#ifndef SCREE_PILE_H
#define SCREE_PILE_H

#include "scree/scene.h"
#include "scree/simplify.h"

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Describing an experiment ---- */

typedef enum scree_mass_rule {
  SCREE_MASS_FROM_MESH, /* density times the volume of each decimated mesh */
  SCREE_MASS_FROM_SCAN, /* density times the volume of the scan, at every level */
} scree_mass_rule;

/* From where particles come in. */
typedef enum scree_inlet {
  SCREE_INLET_TOP, /* above where the packed heap will end */
  SCREE_INLET_HEAP /* as near to the heap as drop_height */
} scree_inlet;

/* The angle-of-repose experiment of Katagiri and Koyanaka (2020), section 2.3, with everything
 * settable. One table (src/pile/experiment.c) holds each field's key in YAML, unit, range and
 * source; the comments here repeat the unit. Strings are owned; free with scree_experiment_free. */
typedef struct scree_experiment {
  char *preset; /* the name it started from */
  size_t particle_count;
  uint64_t seed;
  double density; /* kg/m3 */
  scree_mass_rule mass_rule;
  double cylinder_diameter, disc_diameter; /* m */
  double pack_time, settle_time;           /* s */
  double lift_speed;                       /* m/s */
  double lift_time;                        /* s */
  double hold_time;                        /* s: at most, until still */
  double still_energy;                     /* J of kinetic energy a particle: less is still */
  bool stop_when_still;                    /* end a phase early when still */
  scree_inlet inlet;
  double drop_height;                /* m between the heap and the layer being filled in */
  double gravity;                    /* m/s2 */
  double young_particle, young_wall; /* Pa */
  double restitution, friction_particle, friction_wall;
  scree_law contact_law;
  double steps_per_contact;   /* N of the time step */
  double stiffness_factor;    /* multiplies all stiffnesses */
  double frame_interval;      /* s between frames written; 0: none but the last */
  double checkpoint_interval; /* s of wall-clock time between checkpoints */
  double series_interval;     /* s between the points of the series (scree_run_point) */
  double angle_interval;      /* s between those that have angles; 0: only the last */
  double height_cell;         /* m: cells of the height field; 0: a tenth of the particle size */
  size_t sector_count;
  double band_low, band_high;
} scree_experiment;

/* The names of the presets: "paper", "small", "demo"; NULL past the last. */
SCREE_API const char *scree_preset_name(size_t index);
SCREE_API scree_status scree_experiment_preset(const char *name, scree_experiment *experiment,
                                               scree_error *error);
SCREE_API void scree_experiment_free(scree_experiment *experiment);
/* Reads YAML (or JSON) over the values that *experiment has; `preset: NAME` first takes that
 * preset. Errors name file, line, column, key, value and limit; *experiment is untouched on
 * failure. */
SCREE_API scree_status scree_experiment_read(const char *path, scree_experiment *experiment,
                                             scree_error *error);
/* The same from bytes in memory; name stands for the file in errors. */
SCREE_API scree_status scree_experiment_parse(const char *text, size_t byte_count, const char *name,
                                              scree_experiment *experiment, scree_error *error);
/* An own copy. */
SCREE_API scree_status scree_experiment_copy(const scree_experiment *experiment,
                                             scree_experiment *copy, scree_error *error);
/* Sets one field from text, as `cylinder.diameter` to "0.3". */
SCREE_API scree_status scree_experiment_set(scree_experiment *experiment, const char *key,
                                            const char *value, scree_error *error);
/* What single ranges cannot say, such as a disc smaller than the cylinder; reading checks it too.
 */
SCREE_API scree_status scree_experiment_check(const scree_experiment *experiment,
                                              scree_error *error);
/* The keys of all fields in the order of the file, NULL past the last; unit and meaning of a key
 * ("" for a pure number; the words "one|two" of a choice), NULL for an unknown one. */
SCREE_API const char *scree_experiment_key(size_t index);
SCREE_API const char *scree_experiment_unit(const char *key);
SCREE_API const char *scree_experiment_comment(const char *key);
/* A field as text that scree_experiment_set reads back, into buffer; false for an unknown key. */
SCREE_API bool scree_experiment_get(const scree_experiment *experiment, const char *key,
                                    char *buffer, size_t size);
/* Writes the whole experiment as YAML with units and comments; reading it back gives the same
 * values. */
SCREE_API void scree_experiment_print(const scree_experiment *experiment, FILE *stream);

/* ---- One run of the experiment ---- */

typedef enum scree_phase {
  SCREE_PHASE_PACK,   /* layers of particles are filled in at the top of the cylinder */
  SCREE_PHASE_SETTLE, /* they come to rest */
  SCREE_PHASE_LIFT,   /* the cylinder rises */
  SCREE_PHASE_HOLD,   /* until still */
  SCREE_PHASE_DONE,
} scree_phase;

SCREE_API const char *scree_phase_name(scree_phase phase);

/* Shapes that a run or a study mixes, at most. */
enum { SCREE_MOST_SHAPES = 1000 };

/* A run: its world, walls and the schedule of filling and phases. */
typedef struct scree_run scree_run;

/* One of the shapes that a run mixes. */
typedef struct scree_run_shape {
  scree_particle *particle; /* borrowed until the run is created; the run keeps its own reference */
  double density_factor; /* 1, or volume of the scan over that of the particle (mass_from: scan) */
  const char *name;      /* for reports, copied; NULL: none */
  const char *source;    /* where it came from: file, checksum, Rp; copied; NULL: unknown */
} scree_run_shape;

/* The particles take the shapes in equal shares, shuffled by the seed; positions and orientations
 * are random, and their bounding boxes never overlap (src/scene/fill.c). Layers follow each other
 * so that all are in after pack_time; a cylinder too narrow for the largest particle, or a layer
 * that would have to enter faster than the contact law allows, is refused here with the pack_time
 * that would do. At most SCREE_MOST_SHAPES shapes. */
SCREE_API scree_status scree_run_create(const scree_experiment *experiment,
                                        const scree_run_shape *shapes, size_t shape_count,
                                        scree_run **run, scree_error *error);
SCREE_API void scree_run_free(scree_run *run);

/* Advances by at most step_count time steps; stops earlier where the run ends, which
 * the call after its last step finds. SCREE_DIVERGED as
 * scree_world_step. The result does not depend on how a run is cut into calls. */
SCREE_API scree_status scree_run_advance(scree_run *run, size_t step_count, scree_error *error);
SCREE_API scree_phase scree_run_phase(const scree_run *run);
/* The fraction of the simulated time done, by the longest schedule: phases may end early. */
SCREE_API double scree_run_fraction(const scree_run *run);
/* The world, for observing and frames; not to be changed. */
SCREE_API scree_world *scree_run_world(scree_run *run);
SCREE_API const scree_world *scree_run_view(const scree_run *run);
SCREE_API const scree_experiment *scree_run_experiment(const scree_run *run);
SCREE_API size_t scree_run_shape_count(const scree_run *run);
/* Particle and name belong to the run. */
SCREE_API void scree_run_get_shape(const scree_run *run, size_t index, scree_run_shape *shape);
/* The shape of body `index` of the world. */
SCREE_API size_t scree_run_body_shape(const scree_run *run, size_t index);
/* m: the height of the cylinder's lower end above the disc. */
SCREE_API double scree_run_cylinder_height(const scree_run *run);

/* The state at one moment: a point is recorded at every output.series_interval of simulated time,
 * and one where the run ends. */
typedef struct scree_run_point {
  double time; /* s */
  scree_phase phase;
  size_t body_count;      /* in the world: entered, and not fallen off */
  double kinetic;         /* J, of translation and rotation */
  double mean_rotation;   /* rad/s: mean of |omega| over the bodies, the paper's Fig. 7 */
  double highest_speed;   /* m/s */
  double largest_overlap; /* m, in that step */
  double coordination;    /* mean number of touching bodies and walls */
  double cylinder_height; /* m */
  double sector_deg, cone_deg, silhouette_deg, height; /* of the heap, m; at every
                                                          output.angle_interval while lifting and
                                                          holding, and at the end; else NaN */
} scree_run_point;

/* The series so far, the run's own; valid until the next call that advances it. */
SCREE_API const scree_run_point *scree_run_series(const scree_run *run, size_t *count);

/* What the run cost so far, all its pieces between interruptions together. */
typedef struct scree_run_costs {
  double time_step; /* s */
  uint64_t step_count;
  uint64_t particle_steps;  /* sum over the steps of the bodies in the world */
  double wall_seconds;      /* in scree_run_advance, on the clock */
  double processor_seconds; /* and of all threads of the process meanwhile */
  size_t piece_count;       /* 1, and one more for every resume */
  double largest_overlap;   /* m, of all points of the series */
} scree_run_costs;
SCREE_API void scree_run_get_costs(const scree_run *run, scree_run_costs *costs);

/* What a run gives beyond the heap's shape. */
typedef struct scree_run_result {
  scree_repose repose;
  size_t body_count;       /* particles on the disc: their centres are above it */
  size_t left_count;       /* particles that fell off it */
  double packing_fraction; /* solid volume on the disc over the volume under the height field */
  double coordination;     /* mean number of touching neighbours, walls included */
  double particle_size;    /* m: mean equal-volume sphere diameter */
  double kinetic;          /* J: what is left of motion */
  double time;             /* s, simulated */
  bool still;              /* less than phases.still_energy a particle */
} scree_run_result;

/* Measures the heap as it stands now (scree_height_field, scree_repose_measure). */
SCREE_API scree_status scree_run_measure(const scree_run *run, scree_run_result *result,
                                         scree_error *error);
/* The same with other settings: of `measure`, only the fields of its group "measure" are used. */
SCREE_API scree_status scree_run_measure_with(const scree_run *run, const scree_experiment *measure,
                                              scree_run_result *result, scree_error *error);

/* ---- Runs on disk ---- */

/* Writes a checkpoint: experiment, shapes, world, series; it stands alone
 * (docs/reference/formats.md). Complete under its name or not there. */
SCREE_API scree_status scree_run_save(const scree_run *run, const char *path, bool overwrite,
                                      scree_error *error);
/* Writes a frame: the same without the contacts, a fraction of the size; it can be measured and
 * drawn, not continued. */
SCREE_API scree_status scree_run_save_frame(const scree_run *run, const char *path, bool overwrite,
                                            scree_error *error);
/* Reads either. From a checkpoint every later step has the same bits as in the run saved; a frame
 * is refused by scree_run_advance with SCREE_UNSUPPORTED. SCREE_BAD_FILE, with file and reason, for
 * anything else. */
SCREE_API scree_status scree_run_load(const char *path, scree_run **run, scree_error *error);
SCREE_API bool scree_run_is_frame(const scree_run *run);

/* How a whole run goes on, for a watcher. */
typedef struct scree_run_state {
  const scree_run *run;
  scree_run_point now;     /* without angles */
  double fraction;         /* of the simulated time, by the longest schedule */
  double steps_per_second; /* over the last seconds on the clock; NaN at first */
  double seconds_left;     /* on the clock, at that speed; NaN at first */
} scree_run_state;

typedef struct scree_run_job {
  const scree_experiment *experiment; /* NULL: that of the checkpoint, which must be there */
  const scree_run_shape *shapes;      /* NULL: likewise */
  size_t shape_count;
  /* Gets checkpoint.scree every output.checkpoint_interval, when the run is cancelled and when it
   * is done; frame-NNNN.scree at every output.frame_interval, NNNN counting from 0000; and
   * last.scree, a frame, at the end. Made if need be. NULL: nothing is written. */
  const char *folder;
  /* Also motion.scree: where every body was, at some 240 moments of the longest schedule
   * (scree_motion_read). What an interrupted run wrote of it stays. */
  bool motion;
  /* Go on from the folder's checkpoint.scree where there is one; one of another experiment or of
   * other shapes is refused with SCREE_BAD_ARGUMENT, one that cannot be read with SCREE_BAD_FILE.
   * Without resume a folder that has one is refused with SCREE_EXISTS, unless overwrite. */
  bool resume, overwrite;
  /* Called a few times a second; false cancels: the checkpoint is written, and the answer is
   * SCREE_CANCELLED. NULL: none. */
  bool (*watch)(void *context, const scree_run_state *state);
  /* Called after a frame was due, also without folder; time is run's. NULL: none. */
  scree_status (*frame)(void *context, scree_run *run, size_t frame_index, scree_error *error);
  void *context;
} scree_run_job;

/* One run from its beginning, or its checkpoint, to its end; *run is then in SCREE_PHASE_DONE: ask
 * it for result, series and costs, and free it. A failed run (SCREE_DIVERGED) leaves its last
 * checkpoint. The same experiment and shapes give the same bits, however often it was interrupted
 * and on any number of threads; the costs alone differ. */
SCREE_API scree_status scree_run_complete(const scree_run_job *job, scree_run **run,
                                          scree_error *error);

/* ---- Shapes for a run ---- */

typedef struct scree_grain_options {
  double rp;    /* percentage reduction in (0, 1]; default 1: the scan as it is */
  bool sphere;  /* the sphere of the scan's volume instead, whatever the Rp; default false */
  size_t clump; /* a clump of so many spheres that stands for the level; default 0: none */
  scree_mass_rule mass_rule; /* default SCREE_MASS_FROM_MESH */
  double rounding;           /* m, see scree_particle_options; default 0 */
} scree_grain_options;
SCREE_API scree_grain_options scree_default_grain_options(void);

/* A shape and what was made of it. */
typedef struct scree_grain {
  scree_run_shape run; /* its particle belongs to this struct; name is NULL */
  size_t scan_triangle_count, triangle_count; /* of a sphere: 0 */
  double rp_reached;                          /* triangle_count / scan_triangle_count */
  double scan_volume, volume;                 /* m3; of the particle before the density factor */
} scree_grain;
SCREE_API void scree_grain_free(scree_grain *grain);

/* A particle of a scan at one Rp. scan must be closed (scree_mesh_prepare); curve is that of the
 * scan, used where rp < 1 and not a sphere, so that many levels cost one decimation; NULL builds
 * one for the call. The level is the first with at most rp Nm triangles, truncated
 * (scree_choice_target), or the last where the scan cannot be reduced so far. */
SCREE_API scree_status scree_grain_make(const scree_mesh *scan, const scree_curve *curve,
                                        const scree_grain_options *options,
                                        const scree_progress *progress, scree_grain *grain,
                                        scree_error *error);

/* ---- Pouring shapes into a container ---- */

/* Any shapes, poured layer by layer from above into a box or a cylinder: the plain way to see and
 * test the physics. */
typedef struct scree_pour scree_pour;

typedef enum scree_container {
  SCREE_CONTAINER_CYLINDER, /* a floor and an endless cylinder about the z axis */
  SCREE_CONTAINER_BOX,      /* a floor and four endless walls, the z axis in the middle */
} scree_container;

/* One of the shapes, and how many of it. The particle is borrowed until the pour is created. */
typedef struct scree_pour_shape {
  scree_particle *particle;
  size_t count;
  const char *name;   /* for reports, copied; NULL: none */
  const char *source; /* where it came from: file, checksum, triangles; copied; NULL: unknown */
} scree_pour_shape;

typedef struct scree_pour_options {
  scree_world_options world; /* default as scree_default_world_options; gravity must point down */
  scree_material particles;  /* default scree_default_material: the paper's */
  scree_material walls;      /* default scree_default_wall_material; its friction holds against the
                                particles, whatever theirs is */
  scree_container container; /* default cylinder */
  double width;              /* m, inside: diameter, or side along x; 0 (default): so that the heap
                                will be about as high as wide, and three particles fit abreast where
                                there are enough */
  double depth;              /* m, side of a box along y; 0 (default): the width */
  double drop_height;        /* m from the floor to the first layer; default 0.05 */
  double entry_speed;        /* m/s, downwards; default 1 */
  uint64_t seed;             /* of order, places and orientations; default 1 */
} scree_pour_options;
SCREE_API scree_pour_options scree_default_pour_options(void);

/* The shapes enter well mixed, turned at random, in layers of a square grid whose cells hold the
 * largest particle however it is turned; each layer enters above all that is there, as soon as the
 * one before has fallen out of the way. SCREE_BAD_ARGUMENT for no particles, options out of range,
 * or a container narrower than the largest particle. */
SCREE_API scree_status scree_pour_create(const scree_pour_shape *shapes, size_t shape_count,
                                         const scree_pour_options *options, scree_pour **pour,
                                         scree_error *error);
SCREE_API void scree_pour_free(scree_pour *pour);
/* As scree_world_step, letting in layers when they are due: the same bits however a pour is cut
 * into calls. */
SCREE_API scree_status scree_pour_advance(scree_pour *pour, size_t step_count, scree_error *error);
/* From now on where every body is goes to path (as motion.scree of a run; scree_motion_read), now
 * and at every interval of simulated time (s, > 0). What is at path is replaced; of a pour that
 * goes on, what comes after its time. */
SCREE_API scree_status scree_pour_record(scree_pour *pour, const char *path, double interval,
                                         scree_error *error);
/* Records the present moment too: the end. */
SCREE_API scree_status scree_pour_record_end(scree_pour *pour, scree_error *error);
/* For observing, frames and checkpoints; body i is the i-th to have entered. */
SCREE_API scree_world *scree_pour_world(scree_pour *pour);
SCREE_API const scree_world *scree_pour_view(const scree_pour *pour);
/* The options with every default filled in. */
SCREE_API void scree_pour_get_options(const scree_pour *pour, scree_pour_options *options);
/* All particles, and those that have entered. */
SCREE_API size_t scree_pour_particle_count(const scree_pour *pour);
SCREE_API size_t scree_pour_entered_count(const scree_pour *pour);
/* The shapes; particles and texts are the pour's. */
SCREE_API size_t scree_pour_shape_count(const scree_pour *pour);
SCREE_API scree_pour_shape scree_pour_get_shape(const scree_pour *pour, size_t index);
/* Which of the shapes body `index` is. */
SCREE_API size_t scree_pour_shape_of(const scree_pour *pour, size_t index);
/* s: when the last layer enters. */
SCREE_API double scree_pour_filling_time(const scree_pour *pour);
/* J: kinetic and potential energy that the particles brought with them, zero on the floor; what the
 * ledger of the world must come to. */
SCREE_API double scree_pour_entered_energy(const scree_pour *pour);
/* The scene that the pour is: its series, its end. */
SCREE_API const scree_scene *scree_pour_scene(const scree_pour *pour);

/* Writes a checkpoint: the options, all shapes, those that have not entered too, and the world.
 * Complete under its name or not there; without overwrite an existing file is refused with
 * SCREE_EXISTS. */
SCREE_API scree_status scree_pour_save(const scree_pour *pour, const char *path, bool overwrite,
                                       scree_error *error);
/* Reads one ("-" is stdin); free *pour with scree_pour_free. It goes on with the same bits as the
 * pour that was saved. SCREE_BAD_FILE, with file and reason, for what is no such file, is cut short
 * or has a bit changed anywhere. */
SCREE_API scree_status scree_pour_load(const char *path, scree_pour **pour, scree_error *error);

/* What ends a whole pour, and what is written meanwhile. */
typedef struct scree_pour_schedule {
  double time;        /* s after the last particle entered, at most */
  double still, rest; /* J, s: all moved with less energy a particle for so long; 0 J: never */
  double frames;      /* s; 0: none */
  double series;      /* s, between rows */
  double checkpoint;  /* s of the clock */
} scree_pour_schedule;

/* As scree_scene_job, of a pour. */
typedef struct scree_pour_job {
  const scree_pour_shape *shapes; /* none: those of the checkpoint, which must be there */
  size_t shape_count;
  const scree_pour_options *options; /* with shapes; NULL: the defaults */
  scree_pour_schedule schedule;
  const char *folder;
  bool resume, overwrite; /* on going on the schedule may differ, but for frames and series */
  bool (*watch)(void *context, const scree_pour *pour, double fraction);
  scree_status (*begun)(void *context, scree_pour *pour, bool resumed, scree_error *error);
  scree_status (*frame)(void *context, scree_pour *pour, scree_error *error);
  void *context;
} scree_pour_job;

/* As scree_scene_complete. */
SCREE_API scree_status scree_pour_complete(const scree_pour_job *job, scree_pour **pour,
                                           scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
