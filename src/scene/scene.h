/* A scene at work: what its parts share. */
#pragma once

#include "base/owned.h"
#include "scene/file.h"
#include "scene/fill.h"
#include "scene/motion.h"
#include "world/state/joints.h"
#include "world/state/world.h"

/* One of the shapes. */
typedef struct scree_scene_shape {
  scree_particle *particle; /* held */
  char *source;             /* where it came from */
  size_t material;          /* of the world */
  size_t family;            /* of the plan */
  scree_placement extent;   /* clearance included */
  quat as_given;            /* its orientation as in its file */
  double density, mass, volume;
  double scan_volume; /* m3, before decimation; 0: not known */
  size_t entered, left;
  size_t first_piece, piece_count; /* of one that breaks: shapes behind those of the file */
  size_t assembly;                 /* of a piece: the shape that it is of, */
  const char *part;                /* which of its parts; NULL: it has none */
  uint32_t group;                  /* as a number: parts may share a name */
  vec3 at;                         /* and where it lies in its frame */
  quat turned;
} scree_scene_shape;

/* Where a part that forces move is (parts.c). */
typedef struct scree_scene_part {
  double way, speed; /* m, m/s or rad, rad/s */
  double push;       /* N or N m, of bodies in the step before the last */
  double work, lost; /* J, by the drive; by the damper and the ends */
  double given;      /* J, to bodies by its motion, until the step before the last */
  double earlier;    /* its speed in the step before */
} scree_scene_part;

/* A piece of geometry is one wall of the world or several; of a mesh one of what is solid and one
 * of sheets. */
typedef struct scree_scene_geometry {
  size_t first_wall, wall_count;
  struct scree_scene_part *part; /* NULL: no forces move it */
  const char *note;              /* lines about its meshes; NULL: none, or from a checkpoint */
} scree_scene_geometry;

/* What an inlet by layers keeps; all but the count of layers follows from the plan. */
typedef struct scree_scene_layers {
  uint32_t *order;          /* by body, in the order of entering: which of the inlet's shapes */
  scree_placement *extents; /* of each of the inlet's shapes, clearance included */
  size_t count;             /* that have begun */
  size_t planned;           /* that there will be, as long as no body stands in the way */
  double height, speed;     /* m; m/s, downwards */
  double interval;          /* s, from one to the next; or, where not 0: */
  uint64_t steps;
  double solid, size, clearance; /* m3 of all; m, their mean; m, kept free around each */
  vec3 middle;                   /* of the bottom of what they cover, and: */
  double radius, half[2];        /* m: of a circle; 0: half the sides of a rectangle */
  vec3 *cells;                   /* of a grid: centres, z = 0 */
  uint32_t *cell_order;
  size_t cell_count;
  double pitch;
} scree_scene_layers;

/* Since when the rate of an inlet counts, after what was due until then. */
typedef struct scree_scene_begin {
  double time, mass; /* s, kg */
  size_t count;
} scree_scene_begin;

typedef struct scree_scene_inlet {
  const scree_plan_inlet *plan;
  scree_scene_begin begin;
  size_t *shapes, *counts; /* index of each of its shapes; how many of it entered */
  size_t entered, waiting;
  double mass;
  uint64_t draws; /* random numbers used */
  scree_scene_layers layers;
} scree_scene_inlet;

typedef struct scree_scene_outlet {
  size_t left;
  double mass;
  double first_time, first_place[3]; /* s, m: of the first that left */
} scree_scene_outlet;

typedef struct scree_sensor_kind scree_sensor_kind; /* sensors/sensor.h */

typedef struct scree_scene_sensor {
  const scree_plan_sensor *plan;
  const scree_sensor_kind *kind; /* NULL: it is not planned yet */
  void *state;                   /* of the kind, in the arena */
  void *shared;                  /* by all sensors of the kind, likewise */
  bool leads;                    /* the first of them */
  size_t first_column;
  size_t geometry; /* that it is of; where it is of none, 0 */
} scree_scene_sensor;

/* How a body came and went: s, NaN while it is in, and of what left with the first of its fragment;
 * UINT32_MAX: from a table, and while it is in. */
typedef struct scree_scene_stay {
  double left;
  uint32_t inlet, outlet;
} scree_scene_stay;

typedef struct scree_scene_column {
  char name[96];
  const char *unit;
} scree_scene_column;

/* Where a table of a sensor is. */
typedef struct scree_scene_table_place {
  char name[96]; /* SENSOR.WHAT */
  size_t sensor, table;
} scree_scene_table_place;

typedef struct scree_scene_change_list {
  scree_scene_change_entry *items; /* texts in the scene's arena */
  size_t count, capacity;
} scree_scene_change_list;

struct scree_scene {
  scree_arena arena;
  scree_plan plan;
  char *text; /* the file, printed */
  char *name;
  scree_world *world, *gallery; /* the gallery has one body of each shape, never moved */
  scree_scene_shape *shapes;
  size_t named_count;                      /* of shapes, without pieces of those that break */
  struct scree_scene_assembly *assemblies; /* of these, until the gallery has them; else NULL */
  scree_scene_geometry *geometry;
  scree_scene_inlet *inlets;
  scree_scene_outlet *outlets; /* and the domain's rim */
  scree_scene_sensor *sensors;
  struct {
    scree_scene_column *items;
    size_t count, capacity;
  } columns;
  struct {
    double *items;
    size_t count, capacity;
  } series; /* rows of columns.count */
  size_t row_count;
  struct {
    scree_scene_table_place *items;
    size_t count, capacity;
  } tables;
  struct {
    uint32_t *items; /* shape of each body */
    size_t count, capacity;
  } shape_of;
  struct {
    double *items; /* s: when each body entered */
    size_t count, capacity;
  } entered_at;
  struct {
    scree_scene_stay *items; /* of each body */
    size_t count, capacity;
  } stays;
  struct {
    scree_placement *items; /* scratch of inlets */
    size_t count, capacity;
  } present;
  bool *usual_density;    /* of materials: none is given; NULL where the file is not known */
  double time_step, size; /* s; m: the smallest shape's */
  uint64_t tick_steps;    /* between looks at inlets, outlets, flows and the end */
  uint64_t next_tick;     /* step */
  bool has_parts;
  bool *acts_on; /* of forces, each by shape */
  size_t still_ticks;
  double entered_mass, left_mass, entered_energy, left_energy;
  size_t left_count;
  double (*table_places)[3]; /* of a table of bodies, in the arena */
  size_t table_place_count;
  double table_low[3],
      table_high[3];  /* m: the box of the bodies from a table; low above high: none */
  int end;            /* index into the reasons; 0: it goes on */
  size_t phase;       /* index; their count: all are over */
  double phase_start; /* s */
  double still_since; /* s; NaN while moving */
  scree_scene_costs costs;
  scree_scene_change_list changes;
  bool is_frame;             /* loaded from a frame: no contacts, cannot go on */
  double frame_coordination; /* of a frame, as its contacts were */
};

enum { SCREE_SCENE_ENDS = 6 }; /* that a scene may have, 0: none yet */

/* scene.c: of its time or its phases, by the longest schedule. */
double scree_scene_fraction(const scree_scene *scene);

/* The extent of its shapes. */
scree_scene_extent scree_scene_get_extent(const scree_scene *scene);
/* The particle of one, in its order: *made holds the last one before its sizes, of which more may
 * be made; its particle is to be freed. */
typedef struct scree_scene_making {
  scree_shape_store *store; /* NULL: none */
  const scree_progress *progress;
  scree_shape_made *made;
} scree_scene_making;
scree_status scree_scene_make_shape(scree_scene *scene, size_t index, const char *folder,
                                    const scree_scene_making *making, scree_error *error);
/* A world of its materials, without walls and bodies; s, 0: by what there will be. */
scree_status scree_scene_make_world(const scree_scene *scene, double time_step, scree_world **world,
                                    scree_error *error);
/* Name, text and plan of the file. */
scree_status scree_scene_take_file(scree_scene *scene, const scree_scene_file *file,
                                   scree_error *error);
/* J that is there and that the books do not explain. */
double scree_scene_missing_energy(const scree_scene *scene);

/* What is wrong with what the scene's file has at that place. */
scree_status scree_scene_fail(const scree_scene *scene, const scree_place *place,
                              scree_error *error, const char *format, ...) SCREE_PRINTF(4, 5);
/* The status; a failure that is told by `why` is told with its place. */
scree_status scree_scene_blame(const scree_scene *scene, const scree_place *place,
                               scree_status status, const scree_error *why, scree_error *error);
/* clear.c: whether a body in that place is clear of all walls; else *wall is one that it is not
 * clear of. */
bool scree_scene_is_clear(const scree_scene *scene, const scree_placement *placement, size_t *wall);

/* inlets.c: checks and filling. */
scree_status scree_scene_check_inlets(scree_scene *scene, scree_error *error);
scree_status scree_scene_fill(scree_scene *scene, scree_error *error);
/* Whether nothing more will come, ever. */
bool scree_scene_is_filled(const scree_scene *scene);

/* scene.c: a particle's extents with `more` m kept free all around. */
scree_placement scree_placement_of(const scree_particle *particle, double more);

/* Whether bodies move by less than `still` J each, and none is being moved out of another. */
static inline bool scree_is_still(const scree_observation *o, double still) {
  double count = (double)(o->body_count > 0 ? o->body_count : 1);
  return o->kinetic + o->rotational < still * count && o->depenetrating_pairs == 0;
}

/* defaults.c: what the plan leaves out and follows from the particles; of layers order, region and
 * measures. */
scree_status scree_scene_complete_plan(scree_scene *scene, scree_error *error);
/* layers.c: plans those of an inlet, refusing what cannot be; lets in those that are due. */
scree_status scree_scene_plan_layers(scree_scene *scene, scree_error *error);
scree_status scree_scene_enter_layers(scree_scene *scene, scree_error *error);
/* Steps until the next layer: 0, it is due; SIZE_MAX: there is none. Near its time it is 1, since
 * it falls on the first step at or past it. */
size_t scree_scene_steps_to_layer(const scree_scene *scene);
/* s: when the last body entered, or will as planned; infinity where there is no plan. */
double scree_scene_filling_time(const scree_scene *scene);
/* inlets.c: one body more in the world, and in the books. */
scree_status scree_scene_admit(scree_scene *scene, size_t shape, const scree_body *body,
                               scree_error *error);
/* view.c: whether the sums of energy miss so much that results are in doubt, and what has it. */
bool scree_scene_doubt_energy(const scree_scene *scene, char *text);
/* bodies.c: where the bodies of a table are, before walls are made: they tell its sides. */
scree_status scree_scene_read_places(scree_scene *scene, const char *folder, scree_error *error);
/* starts.c: refuses bodies of a table that an open sheet passes through. */
scree_status scree_scene_check_pierced(const scree_scene *scene, scree_error *error);
/* bodies.c: those that are there from the start. */
scree_status scree_scene_read_bodies(scree_scene *scene, const char *folder, scree_error *error);
/* Whether some of those begin pressed beyond the overlap limit, with the worst of them. */
bool scree_scene_bodies_overlap(const scree_scene *scene, char text[SCREE_REMARK]);
/* `which` of the inlet's shapes. */
scree_status scree_scene_enter(scree_scene *scene, scree_scene_inlet *inlet, size_t which,
                               const scree_placement *placement, const double velocity[3],
                               scree_error *error);

/* phases.c: their motions begin with the first. Ends the one that is over; `observed`: whether now
 * is a tick, on which it may end early. */
scree_status scree_scene_begin_phases(scree_scene *scene, scree_error *error);
/* What moves during a phase, by the one that it is in. */
scree_status scree_scene_lead_by_phase(scree_scene *scene, scree_error *error);
scree_status scree_scene_turn_phase(scree_scene *scene, bool observed, scree_error *error);
/* s: when it ends at the latest; infinity where there is none, or it waits for the inlets. */
double scree_scene_phase_end(const scree_scene *scene);
/* s, of all. */
double scree_scene_phase_times(const scree_scene *scene);
bool scree_scene_is_in_phase(const scree_scene *scene, const scree_texts *names);

/* softness.c: the contact that may be pressed beyond its limit the most, by the speed of an inlet,
 * or of the table's bodies, the fall from there to the lowest geometry and the motion of walls. */
typedef struct scree_scene_softness {
  size_t inlet, shape, other; /* whose bodies, SIZE_MAX: the table's; against a shape, a geometry */
  size_t squeezed;            /* a lighter shape between both; SIZE_MAX: none */
  bool is_wall;               /* other: a geometry */
  double speed, energy;       /* m/s, J */
  double overlap, limit;      /* m: v sqrt(m/K), and where contacts harden */
  double size;                /* m, of the smaller */
  double stiffer;             /* so many times as stiff it would hold, in the root as many steps */
  double least;               /* of its size, by how much the stiffest contact gives way */
} scree_scene_softness;
/* False where none may: by hits; by a body that squeezes a lighter one against a wall. */
bool scree_scene_soft(const scree_scene *scene, scree_scene_softness *softness);
bool scree_scene_squeezes(const scree_scene *scene, scree_scene_softness *softness);
/* A table of both, what keeps them soft and what that costs; false where there is none. */
bool scree_scene_describe_softness(const scree_scene *scene, char text[SCREE_REMARK]);
/* m/s, of the fastest hit of an inlet's bodies, by which the step of Hertz's law goes; at least 1
 * where bodies come from elsewhere. */
double scree_scene_hit_speed(const scree_scene *scene);
/* pinch.c: of the bodies that two pieces of geometry close on, that which is pressed in the most.
 * m: the gap where it is narrow and wide, the overlap on the softer side, its limit, and the gap
 * that keeps within it. */
typedef struct scree_scene_pinch {
  size_t shape, geometry[2];
  double narrow, wide, overlap, limit, room;
} scree_scene_pinch;
bool scree_scene_pinches(const scree_scene *scene, double duration, scree_scene_pinch *pinch);
/* softness.c: of how far such a body is pressed together, what the softer side gives way by. */
double scree_scene_pinch_share(const scree_scene *scene, size_t shape, const size_t geometry[2]);
/* softness.c: refuses inlets so fast that bodies would pass what they hit. */
scree_status scree_scene_check_softness(const scree_scene *scene, scree_error *error);
/* outlets.c: takes out what is in an outlet or left the domain. */
void scree_scene_empty(scree_scene *scene);
/* What left the domain that the scene has where it names none. */
void scree_scene_take_lost(scree_scene *scene);
/* domain.c: makes it larger by a wall as it stands; that domain. */
typedef struct scree_scene_reach {
  double low[3], high[3]; /* m; infinite where there is no end */
} scree_scene_reach;
void scree_scene_take_in_wall(const scree_scene *scene, size_t index, scree_scene_reach *reach);
scree_scene_reach scree_scene_domain(const scree_scene *scene);

/* sensors.c: classes of bodies, by which the numbers of some sensors come: of a shape's sizes each,
 * all of a shape of the file, all of a material. */
enum { SCREE_BY_SIZE, SCREE_BY_SHAPE, SCREE_BY_MATERIAL };
size_t scree_scene_class_count(const scree_scene *scene, int by);
size_t scree_scene_class_of(const scree_scene *scene, int by, size_t shape);
const char *scree_scene_class_name(const scree_scene *scene, int by, size_t index);
/* sensors.c: all of them. Their missing fields; their columns, by the plan alone; their room; looks
 * that are due, of which some are at ticks; the step of the next other one; what one has gathered,
 * in or out; whether one is of a region. */
struct scree_codec;
scree_status scree_sensors_complete(const scree_scene *scene, scree_error *error);
scree_status scree_sensors_plan(scree_scene *scene, scree_error *error);
scree_status scree_sensors_begin(scree_scene *scene, scree_error *error);
scree_status scree_sensors_watch(scree_scene *scene, bool ticks, scree_error *error);
uint64_t scree_sensors_next(const scree_scene *scene);
void scree_sensor_code(struct scree_codec *codec, scree_scene *scene, scree_scene_sensor *sensor);
void scree_sensor_code_shared(struct scree_codec *codec, scree_scene *scene,
                              scree_scene_sensor *sensor);
bool scree_sensor_reach(const scree_plan_sensor *plan, double low[3], double high[3]);
void scree_sensors_end(scree_scene *scene);
scree_status scree_scene_record(scree_scene *scene, scree_error *error);
/* What they have besides columns, as files in the folder. */
scree_status scree_scene_write_tables(const scree_scene *scene, const char *folder,
                                      scree_error *error);

/* parts.c: room for those that forces move; their coming step; J, kinetic and potential, and what
 * one's walls have done on bodies; what the books of all miss. */
scree_status scree_scene_plan_parts(scree_scene *scene, scree_error *error);
scree_status scree_scene_move_parts(scree_scene *scene, scree_error *error);
double scree_scene_part_energy(const scree_scene *scene, size_t geometry);
/* N along the slide or N m about the hinge, of all bodies in the last step. */
double scree_scene_push(const scree_scene *scene, size_t geometry);
double scree_scene_parts_balance(const scree_scene *scene);
/* J, the energy book of one geometry that forces move; 0 where it is none. */
double scree_scene_part_balance(const scree_scene *scene, size_t geometry);
/* J, of what changed its form in them. */
double scree_scene_parts_turned(const scree_scene *scene);

/* forces.c: on whom; of the coming step. */
scree_status scree_scene_plan_forces(scree_scene *scene, scree_error *error);
scree_status scree_scene_apply_forces(scree_scene *scene, scree_error *error);

/* scene.c: the arrays of a scene that has a plan. */
scree_status scree_scene_prepare(scree_scene *scene, scree_error *error);
/* One that ended by what is otherwise in this plan goes on, without the row of its end. */
void scree_scene_reopen(scree_scene *scene, const scree_plan *plan);
/* inlets.c: into scene->present, the bodies and in a periodic domain their images that reach into
 * the box, by an extent for each shape; NULL: the shapes' own. */
scree_status scree_scene_list_present(scree_scene *scene, const scree_placement *extents,
                                      const double low[3], const double high[3],
                                      scree_error *error);
/* m: of the highest body, but those that move slower up than `slowest` (or faster down). */
double scree_scene_highest(const scree_scene *scene, const scree_placement *extents,
                           double slowest);
/* inlets.c: a body of the shape, at rest or as `state` says, of its density. */
scree_status scree_scene_add_body(const scree_scene_shape *shape, scree_world *world,
                                  const scree_body *state, scree_error *error);
/* What the engine must know of a shape that has its particle. */
void scree_scene_measure_shape(scree_scene *scene, size_t index);
/* save.c: a checkpoint, for scree_world_keep_all. */
scree_status scree_scene_pack(const void *scene, unsigned char **bytes, size_t *byte_count,
                              scree_error *error);
/* change.c: that this printed file says the same as the scene's, but for title, time, stop and
 * output, of which frames and series must be the same. `path`: of the scene's checkpoint. */
scree_status scree_scene_check_same(scree_scene *scene, const char *text, const char *path,
                                    scree_error *error);

#define SCREE_SCENE_SHAPES(scene) ((scene)->plan.shapes.count)
/* The shape of the file that it is, or that it is a piece of. */
static inline size_t scree_scene_named(const scree_scene *scene, size_t shape) {
  return shape < scene->named_count ? shape : scene->shapes[shape].assembly;
}

/* particles.c: one, before its sizes; of a file's parts or all (0). */
scree_status scree_scene_make_unscaled(const scree_plan_shape *plan, const char *folder,
                                       size_t part, scree_shape_store *store,
                                       const scree_progress *progress, scree_shape_made *made,
                                       scree_error *error);
/* assemblies.c: the parts of a shape with joints, and in making->made the particle that stands for
 * them, which scree_scene_make_shape takes. */
scree_status scree_scene_make_parts(scree_scene *scene, size_t index, const char *folder,
                                    const scree_scene_making *making, scree_error *error);
/* What a piece is of. */
typedef struct scree_scene_piece {
  uint32_t assembly, group; /* the shape; which of its parts, */
  const char *part;         /* and its name; NULL: none */
} scree_scene_piece;
/* Cuts shapes that break, whose particles are there, and makes their pieces shapes; the same by a
 * list of what each is of, without particles. */
scree_status scree_scene_break_shapes(scree_scene *scene, const scree_progress *progress,
                                      scree_error *error);
scree_status scree_scene_append_pieces(scree_scene *scene, const scree_scene_piece *pieces,
                                       size_t count, scree_error *error);
/* Joints between the pieces in the gallery; where the pieces of a loaded gallery lie; all pieces of
 * a shape, and their joints, into the world. */
scree_status scree_scene_join_gallery(scree_scene *scene, scree_error *error);
void scree_scene_forget_assemblies(scree_scene *scene);
void scree_scene_place_pieces(scree_scene *scene);
scree_status scree_scene_admit_assembly(scree_scene *scene, size_t shape, const scree_body *body,
                                        scree_error *error);

static inline bool scree_is_in(const double p[3], const double low[3], const double high[3]) {
  for (int k = 0; k < 3; k++)
    if (!(p[k] >= low[k] && p[k] <= high[k])) return false;
  return true;
}

/* Whether a body is counted: what hangs together by joints is one, and the first stands for it. */
static inline bool scree_scene_counts(const scree_scene *scene, size_t body) {
  return scree_world_leader(scene->world, body) == body;
}

/* The first body from *index on that is there; false: there is none. */
static inline bool scree_scene_next_body(const scree_scene *scene, size_t *index,
                                         scree_body *body) {
  while (*index < scene->shape_of.count && scree_world_body_removed(scene->world, *index)) ++*index;
  if (*index >= scene->shape_of.count) return false;
  scree_world_get_body(scene->world, *index, body);
  return true;
}

static inline quat scree_body_turn(const scree_body *body) {
  return quat_load(body->orientation);
}

/* Writes a frame: the same without the contacts, a fraction of the size; it can be measured and
 * drawn, not continued. */
scree_status scree_scene_save_frame(const scree_scene *scene, const char *path, bool overwrite,
                                    scree_error *error);

/* sensors/pile.c: where there is none. */
scree_pile scree_no_pile(void);
