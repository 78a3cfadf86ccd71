/* Scenes: the user's own equipment, from one YAML file. */
#ifndef SCREE_SCENE_H
#define SCREE_SCENE_H

#include "scree/heap.h"
#include "scree/world.h"

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- The file ---- */

/* A scene's file (docs/reference/scenes.md), as it was read and changed since. */
typedef struct scree_scene_file scree_scene_file;

/* Reads a file of at most 1 MB ("-" is stdin). Errors name file, line, column, field, value and
 * what is allowed. What the fields mean together is checked by scree_scene_file_check. */
SCREE_API scree_status scree_scene_file_read(const char *path, scree_scene_file **file,
                                             scree_error *error);
/* The same from bytes in memory; name stands for the file in errors, and in its folder lie the
 * files that the scene names. */
SCREE_API scree_status scree_scene_file_parse(const char *text, size_t byte_count, const char *name,
                                              scree_scene_file **file, scree_error *error);
SCREE_API void scree_scene_file_free(scree_scene_file *file);
/* A copy of a template (scree_scene_template_name), to be changed. */
SCREE_API scree_status scree_scene_file_template(const char *name, scree_scene_file **file,
                                                 scree_error *error);
/* Reads a scene; or of a file without inlets settings for a template: values of its parameters and
 * fields, over those of a preset: its own, else that one (NULL: none). */
SCREE_API scree_status scree_scene_file_read_over(const char *path, const char *template_name,
                                                  const char *preset, scree_scene_file **file,
                                                  scree_error *error);
/* Sets any field, as `inlets.feed.rate` to "5" or `gravity` to "[0, 0, -1.62]"; items of lists are
 * counted from 0, as in `geometry.drum.motion.0.rotate.speed`. A parameter of the file sets the
 * fields that it stands for, `preset` all values of that preset. */
SCREE_API scree_status scree_scene_file_set(scree_scene_file *file, const char *field,
                                            const char *value, scree_error *error);
/* Sets a field and checks all; the error begins with the field. SCREE_BAD_FILE: it stays set, and
 * may be good once others are. */
SCREE_API scree_status scree_scene_file_try(scree_scene_file *file, const char *field,
                                            const char *value, scree_error *error);

/* Shapes of a study, or of the command line, at most. */
enum { SCREE_MOST_SHAPES = 1000 };

/* One of the shapes that a scene's inlets pour; texts are borrowed. */
typedef struct scree_poured {
  const char *name;         /* of the shape, at most 64 characters and no point */
  const char *kind, *value; /* "file" and its path, "sample" and its name, "sphere" and m, ... */
  double share;             /* by number */
} scree_poured;
/* Puts these shapes in place of all others, of the first material that no geometry is of, and has
 * all inlets pour them. */
SCREE_API scree_status scree_scene_file_pour(scree_scene_file *file, const scree_poured *shapes,
                                             size_t count, scree_error *error);
/* Checks all but the files it names. */
SCREE_API scree_status scree_scene_file_check(const scree_scene_file *file, scree_error *error);
/* The columns that its sensors will have (scree_scene_column_name and _unit; unit may be NULL),
 * known before it is made; to be called with 0, 1, 2, ... until *name is "". SCREE_BAD_FILE as
 * scree_scene_file_check. */
SCREE_API scree_status scree_scene_file_column(const scree_scene_file *file, size_t index,
                                               char name[96], const char **unit,
                                               scree_error *error);
/* The path of file `index` of those that its shapes and geometry name; false: there are no more, or
 * no room. */
SCREE_API bool scree_scene_file_input(const scree_scene_file *file, size_t index, char *path,
                                      size_t size);
/* Prints the whole scene with every default, units and comments; reading it back gives the same. */
SCREE_API scree_status scree_scene_file_print(const scree_scene_file *file, FILE *stream,
                                              scree_error *error);

/* Templates: "hopper", "drum" and others; NULL past the last. */
SCREE_API const char *scree_scene_template_name(size_t index);
/* The commented file; NULL for an unknown name. */
SCREE_API const char *scree_scene_template(const char *name);

/* ---- A scene at work ---- */

typedef struct scree_scene scree_scene;

/* Reads, repairs and decimates what the file names, and makes the world with its geometry. Errors
 * name what does not fit together, as an inlet that lies in a wall. progress may be NULL. */
SCREE_API scree_status scree_scene_create(const scree_scene_file *file,
                                          const scree_progress *progress, scree_scene **scene,
                                          scree_error *error);
/* The same with shapes from a store, which may be NULL. */
SCREE_API scree_status scree_scene_create_from(const scree_scene_file *file,
                                               scree_shape_store *store,
                                               const scree_progress *progress, scree_scene **scene,
                                               scree_error *error);
SCREE_API void scree_scene_free(scree_scene *scene);

/* Advances by at most step_count time steps; stops earlier where the scene ends. SCREE_DIVERGED as
 * scree_world_step. The result does not depend on how a scene is cut into calls. */
SCREE_API scree_status scree_scene_advance(scree_scene *scene, size_t step_count,
                                           scree_error *error);
/* Why it has ended: "the time is over", "still", "empty"; NULL: it has not. */
SCREE_API const char *scree_scene_end(const scree_scene *scene);
/* The phase that it is in; NULL: none. */
SCREE_API const char *scree_scene_phase(const scree_scene *scene);
/* The phase of an index, in their order; NULL past the last. */
SCREE_API const char *scree_scene_phase_name(const scree_scene *scene, size_t index);
/* s: the scene's `time`. */
SCREE_API double scree_scene_duration(const scree_scene *scene);
SCREE_API const char *scree_scene_title(const scree_scene *scene);
/* Its file with every default, as scree_scene_file_print has it. */
SCREE_API const char *scree_scene_text(const scree_scene *scene);
/* For observing and frames, not to be changed. */
SCREE_API scree_world *scree_scene_world(scree_scene *scene);
SCREE_API const scree_world *scree_scene_view(const scree_scene *scene);

/* What is left of a scene will cost so much, as far as its file says; bodies are those that find
 * room and stay in. */
typedef struct scree_scene_forecast {
  double step_count, body_count, body_steps;
  double seconds; /* on one core, by what its steps so far cost, before them by the usual cost */
  double frame_count;         /* of output.frames */
  double frame_bytes;         /* of one, at most */
  double frame_interval;      /* s: output.frames */
  bool frames_are_instances;  /* output.bodies: scree_scene_bodies_vtp_write, not surfaces */
  char time_step_reason[256]; /* of its worst pair of shapes, as of scree_world_time_step */
} scree_scene_forecast;
SCREE_API void scree_scene_foretell(const scree_scene *scene, scree_scene_forecast *forecast);
/* What is probably a slip, as a sentence: contacts too soft for how fast bodies will hit, a density
 * that is not given, a mesh in another unit, an inlet without room, frames by the million. To be
 * called with 0, 1, 2,
 * ... until it is false. */
enum { SCREE_REMARK = 1000 };
SCREE_API bool scree_scene_remark(const scree_scene *scene, size_t index, char text[SCREE_REMARK]);

/* Whether its heap can have no angle, and why; s of a processor that one with an angle costs. */
SCREE_API bool scree_scene_no_angle(const scree_scene *scene, char why[SCREE_REMARK],
                                    double *seconds);

/* What cannot be read off it, and why, as a sentence: an index of mixing whose cells hold too few
 * bodies. To be called with 0, 1, 2, ... until it is false. */
SCREE_API bool scree_scene_doubt(const scree_scene *scene, size_t index, char text[SCREE_REMARK]);

/* Names belong to the scene; NULL past the last. */
SCREE_API const char *scree_scene_shape_name(const scree_scene *scene, size_t index);
/* What it is called in the file, of which there may be several sizes. */
SCREE_API const char *scree_scene_shape_family(const scree_scene *scene, size_t index);
SCREE_API const char *scree_scene_shape_source(const scree_scene *scene, size_t index);
SCREE_API scree_particle *scree_scene_shape_particle(const scree_scene *scene, size_t index);
SCREE_API const char *scree_scene_geometry_name(const scree_scene *scene, size_t index);
/* What its meshes are as walls, and what was mended of them, a line each: facets, solids,
 * containers (with bodies in them), sheets. NULL: it has no file and nothing to tell, or the scene
 * was loaded. */
SCREE_API const char *scree_scene_geometry_note(const scree_scene *scene, size_t index);
SCREE_API const char *scree_scene_inlet_name(const scree_scene *scene, size_t index);
SCREE_API const char *scree_scene_outlet_name(const scree_scene *scene, size_t index);
/* The shape of body `index` of the world, and the geometry that wall `index` is part of. */
SCREE_API size_t scree_scene_body_shape(const scree_scene *scene, size_t index);
SCREE_API size_t scree_scene_wall_geometry(const scree_scene *scene, size_t index);

/* What came in, is in, went out: at every moment in = inside + out. What hangs together by joints
 * is one body; as it comes apart, there are more inside. */
typedef struct scree_scene_book {
  size_t entered_count, inside_count, left_count; /* bodies, since the start */
  size_t waiting_count;                           /* due, but there was no room yet */
  double entered_mass, inside_mass, left_mass;    /* kg */
  double entered_energy, left_energy;             /* J: kinetic and potential, zero at the origin */
  double ledger; /* energy unaccounted for, as a share of all that was turned over */
} scree_scene_book;
SCREE_API void scree_scene_get_book(const scree_scene *scene, scree_scene_book *book);

/* Two materials of which bodies were pressed beyond their overlap limit, by scree_world_hardening.
 * To be called with 0, 1, 2, ... until it is false. Names: NULL where the scene names none. */
typedef struct scree_scene_hardening {
  const char *material, *other;
  uint64_t count;
  double deepest, stiffness_missing;
} scree_scene_hardening;
SCREE_API bool scree_scene_get_hardening(const scree_scene *scene, size_t index,
                                         scree_scene_hardening *hardening);

/* The same of one inlet, of one outlet; the outlet past the last is the domain's rim. */
SCREE_API size_t scree_scene_inlet_count(const scree_scene *scene, size_t index, double *mass,
                                         size_t *waiting);
SCREE_API size_t scree_scene_outlet_count(const scree_scene *scene, size_t index, double *mass);

/* What left the domain. Where the scene names none that is the box of its geometry as it stands,
 * inlets, outlets and sensors with as much again on every side, looked at with every row of the
 * series, and nothing was meant to leave it. */
typedef struct scree_scene_loss {
  size_t count;
  double mass;                       /* kg */
  double first_time, first_place[3]; /* s, m: of the first */
  double low[3], high[3];            /* m: the domain, infinite where it has no end */
  bool is_meant;                     /* the scene names its domain */
} scree_scene_loss;
/* False where nothing did. */
SCREE_API bool scree_scene_loss_of(const scree_scene *scene, scree_scene_loss *loss);

/* ---- Changes ---- */

/* What was changed between two steps: a field as of scree_scene_file_set and its values, NULL where
 * it was, or is, not given. Texts belong to the scene. */
typedef struct scree_scene_change_entry {
  double time; /* s */
  const char *field, *was, *is;
} scree_scene_change_entry;

/* The scene goes on with other motions and surface velocities of geometry, friction, restitution
 * and cohesion, gravity, inlets, outlets, sensors, times, stop or output. A change is
 * "FIELD=VALUE", or the path of a file with fields as a scene has them, which come over those that
 * are there. Motions go on from where the wall stands, a new rate counts from now on, sensors that
 * change begin anew, and the energy that the change itself brings, as of another gravity, is booked
 * as entered. All else is refused with SCREE_BAD_ARGUMENT, and *scene stays as it was; so does it
 * where nothing changes. */
SCREE_API scree_status scree_scene_change(scree_scene **scene, const char *const *changes,
                                          size_t count, scree_error *error);
/* All since it began. */
SCREE_API size_t scree_scene_change_count(const scree_scene *scene);
SCREE_API scree_scene_change_entry scree_scene_change_at(const scree_scene *scene, size_t index);

/* ---- Sensors ---- */

/* Every number that is followed is a column: "time", "inside", "throughput.mass_rate". Its name and
 * unit ("" for a pure number); NULL past the last. */
SCREE_API const char *scree_scene_column_name(const scree_scene *scene, size_t index);
SCREE_API const char *scree_scene_column_unit(const scree_scene *scene, size_t index);
SCREE_API size_t scree_scene_column_count(const scree_scene *scene);
/* All columns at this moment into values; NaN where there is no such number. */
SCREE_API scree_status scree_scene_measure(const scree_scene *scene, double *values,
                                           scree_error *error);
/* The series so far: row_count rows of all columns, a row at every output.series of simulated time
 * and one at the end. The scene's own; valid until it is advanced. */
SCREE_API const double *scree_scene_series(const scree_scene *scene, size_t *row_count);

/* A column over the rows of the series in a window of time that have a number. */
typedef struct scree_scene_summary {
  double last;                      /* of all rows; NaN where there is no such number, or no row */
  double mean, sd, least, greatest; /* of single rows; NaN of none, sd of one too */
  double from, until;               /* s: the window; until infinite: to the end */
  size_t count;                     /* of rows */
} scree_scene_summary;
/* from, until (s): NaN: as the column's sensor has it. */
SCREE_API scree_scene_summary scree_scene_summarise(const scree_scene *scene, size_t column,
                                                    double from, double until);

/* What a wall sensor gathers by triangle in its window (`from`, `until`). */
typedef enum scree_wall_map {
  SCREE_MAP_PRESSURE, /* Pa: normal force over area, mean over time; pressing is positive */
  SCREE_MAP_SHEAR,    /* Pa: size of the tangential force over area, mean over time */
  SCREE_MAP_WEAR,     /* J/m2: work of sliding */
  SCREE_MAP_WORN,     /* m: depth that is worn off, by the pairs' `wear` (Archard 1953) */
  SCREE_MAP_COUNT
} scree_wall_map;
/* "pressure", "Pa"; NULL past the last. */
SCREE_API const char *scree_wall_map_name(scree_wall_map map);
SCREE_API const char *scree_wall_map_unit(scree_wall_map map);
/* Whether any wall sensor is there. */
SCREE_API bool scree_scene_has_maps(const scree_scene *scene);
/* How many numbers a map of that wall has: its triangles, or 1 of a wall that is no mesh. */
SCREE_API size_t scree_scene_wall_cells(const scree_scene *scene, size_t wall);
/* The map of the first wall sensor that looks at that wall, into values; false, and nothing, where
 * none does. A contact counts for the triangle that it lies on. NaN of endless walls, and of
 * means before the window. Cost: one pass over the triangles. */
SCREE_API bool scree_scene_wall_map(const scree_scene *scene, size_t wall, scree_wall_map map,
                                    double *values);

/* What a sensor has besides columns: rows of numbers under names. */
typedef struct scree_scene_table {
  size_t row_count, column_count;
  const char **names, **units; /* of columns; "" for a pure number */
  double *values;              /* row by row */
  const char **texts;          /* likewise; NULL: it is a number. The scene's own. */
  bool is_long;                /* a row for each body or triangle */
} scree_scene_table;
/* "stay.histogram" of a sensor `stay`, in a run's folder sensor-stay-histogram.csv; NULL past the
 * last. */
SCREE_API const char *scree_scene_table_name(const scree_scene *scene, size_t index);
/* As it stands; to be freed, before the scene. Cost: one pass over what the sensor has. */
SCREE_API scree_status scree_scene_make_table(const scree_scene *scene, size_t index,
                                              scree_scene_table *table, scree_error *error);
SCREE_API void scree_scene_table_free(scree_scene_table *table);

/* ---- Piles ---- */

/* How a pile is measured: the fields of a `pile` sensor. */
typedef struct scree_pile_settings {
  double cell; /* m, of the height field; 0: a tenth of the size of a body */
  size_t sectors;
  double band_low, band_high;
} scree_pile_settings;

typedef struct scree_pile {
  scree_repose repose;     /* angles and lengths */
  size_t body_count;       /* bodies of it: above the floor, and over the disc where there is one */
  double packing_fraction; /* their solid volume over the volume under the height field */
  double size;             /* m, of a body */
} scree_pile;

/* The sensor of pile `index`; NULL past the last. */
SCREE_API const char *scree_scene_pile_name(const scree_scene *scene, size_t index);
SCREE_API scree_pile_settings scree_scene_pile_settings(const scree_scene *scene, size_t index);
/* Measures it as it stands; settings may be NULL: the scene's own. */
SCREE_API scree_status scree_scene_measure_pile(const scree_scene *scene, size_t index,
                                                const scree_pile_settings *settings,
                                                scree_pile *pile, scree_error *error);

/* ---- What it cost ---- */

/* All pieces between interruptions together. */
typedef struct scree_scene_costs {
  uint64_t body_steps;                    /* sum over the steps of the bodies in the world */
  double wall_seconds, processor_seconds; /* of advancing it; processor: of the process */
  uint64_t piece_count;                   /* 1, and one more for every resume */
} scree_scene_costs;
SCREE_API scree_scene_costs scree_scene_get_costs(const scree_scene *scene);

/* ---- Scenes on disk ---- */

/* Writes a checkpoint (docs/reference/formats.md), which stands alone. Complete under its name or
 * not there.
 */
SCREE_API scree_status scree_scene_save(const scree_scene *scene, const char *path, bool overwrite,
                                        scree_error *error);
SCREE_API bool scree_scene_is_frame(const scree_scene *scene);
/* Reads either; every later step has the same bits as in the scene that was saved, a frame is
 * refused by scree_scene_advance with SCREE_UNSUPPORTED. SCREE_BAD_FILE with file and reason. */
SCREE_API scree_status scree_scene_load(const char *path, scree_scene **scene, scree_error *error);

/* Its bodies as a table that `bodies: {file: ...}` of a scene reads: shape, position, orientation,
 * velocity, angular velocity and size, in SI units named by the header. */
SCREE_API scree_status scree_scene_bodies_write(const scree_scene *scene, const char *path,
                                                bool overwrite, scree_error *error);

/* How a whole scene goes on, for a watcher. */
typedef struct scree_scene_state {
  const scree_scene *scene;
  double time, fraction;   /* s; of the simulated time */
  double steps_per_second; /* over the last seconds on the clock; NaN at first */
  double seconds_left;     /* on the clock, by what the steps cost so far; NaN at first */
} scree_scene_state;

typedef struct scree_scene_job {
  const scree_scene_file *file; /* NULL: that of the checkpoint, which must be there */
  /* Gets checkpoint.scree every output.checkpoint seconds of the clock, when cancelled and at the
   * end; series.csv; motion.scree. Made if need be. NULL: nothing is written. */
  const char *folder;
  /* Go on from the folder's checkpoint.scree where there is one; one of another scene is refused.
   * Only title, time, stop and output may differ, but for output.frames and series. Without resume
   * a folder that has one is refused with SCREE_EXISTS, unless overwrite. */
  bool resume, overwrite;
  /* On resuming, as of scree_scene_change; the checkpoint is written with them at once. */
  const char *const *changes;
  size_t change_count;
  /* The folder also gets a frame at every output.frames, frame-NNNNNN.scree counted from 0, and
   * last.scree at the end. */
  bool states;
  bool no_motion;                 /* and no motion.scree */
  scree_shape_store *store;       /* where its shapes are made; NULL: none */
  const scree_progress *progress; /* of making the scene; may be NULL */
  /* Called a few times a second; false cancels: the checkpoint is written, and the answer is
   * SCREE_CANCELLED. NULL: none. */
  bool (*watch)(void *context, const scree_scene_state *state);
  /* Called once the scene stands, before its first step or where it goes on. NULL: none. */
  scree_status (*begun)(void *context, scree_scene *scene, bool resumed, scree_error *error);
  /* Called at every output.frames of simulated time, on the first step at or past it, and at the
   * end, counted from 0. NULL: none. */
  scree_status (*frame)(void *context, scree_scene *scene, size_t index, scree_error *error);
  void *context;
} scree_scene_job;

/* A scene from its beginning, or its checkpoint, to its end; free *scene. Where it is cancelled or
 * leaves the range of its model (SCREE_DIVERGED) *scene is how it stands then, to be looked at and
 * freed; NULL after any other failure. One that diverges leaves its last checkpoint, and
 * stopped.scree of shortly before. */
SCREE_API scree_status scree_scene_complete(const scree_scene_job *job, scree_scene **scene,
                                            scree_error *error);

/* ---- Motion ---- */

/* Where every wall and body of a scene was at moments of its time. */
typedef struct scree_motion {
  size_t frame_count, body_count; /* the walls first, which count as bodies here */
  double *time;                   /* s, of each frame, rising */
  float *poses; /* of body b in frame f the 7 from 7 (f body_count + b): position, m, and quaternion
                   w x y z (within 2e-5 rad); NaN where the body is not in the world */
} scree_motion;

/* Reads motion.scree of a scene's folder; a frame at its end that was not written whole is left
 * out. SCREE_BAD_FILE for anything else. */
SCREE_API scree_status scree_motion_read(const char *path, scree_motion *motion,
                                         scree_error *error);
SCREE_API void scree_motion_free(scree_motion *motion);

#ifdef __cplusplus
}
#endif
#endif
