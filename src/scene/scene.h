/* A scene at work: what its parts share. */
#pragma once

#include "base/owned.h"
#include "scene/fill.h"
#include "scene/motion.h"
#include "scene/plan.h"
#include "world/world.h"

struct scree_scene_file {
  scree_yaml root;
  char *name;   /* for messages */
  char *folder; /* where the files that it names lie, with a slash at its end, or "" */
};

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
} scree_scene_shape;

/* Where a part that forces move is (parts.c). */
typedef struct scree_scene_part {
  double way, speed; /* m, m/s or rad, rad/s */
  double push;       /* N or N m, of bodies in the step before the last */
  double work, lost; /* J, by the drive; by the damper and the ends */
} scree_scene_part;

/* A piece of geometry is one wall of the world or several; of a mesh one of what is solid and one
 * of sheets. */
typedef struct scree_scene_geometry {
  size_t first_wall, wall_count;
  struct scree_scene_part *part; /* NULL: no forces move it */
  const char *note;              /* lines about its meshes; NULL: none, or from a checkpoint */
} scree_scene_geometry;

/* Of an inlet by layers; all but the count of layers follows from the plan. */
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

/* A contact that is followed (impacts.c), or the last one of these neighbours. */
typedef struct scree_scene_hit {
  uint32_t a, b;
  bool wall, touching;
  double seen_normal, seen_tangential; /* J, the pair's losses at the last look */
  double approach, normal, tangential; /* J, of the contact */
} scree_scene_hit;

typedef struct scree_scene_hits {
  scree_scene_hit *items; /* in the order of the world's neighbours */
  size_t count, capacity;
} scree_scene_hits;

typedef struct scree_scene_impacts scree_scene_impacts; /* impacts.h */
typedef struct scree_scene_grid scree_scene_grid;       /* grid.h */

typedef struct scree_scene_sensor {
  const scree_plan_sensor *plan;
  size_t first_column;
  size_t geometry;      /* of a wall or a position */
  double *count, *mass; /* of a flow, by shape, all shapes last */
  double *maps;   /* of a wall: each scree_wall_map by triangle of its meshes, one number of each
                     other wall: N s, N s, J, m3 */
  double watched; /* s in which they were gathered */
  size_t cell_count;
  scree_scene_impacts *impacts;
  struct scree_scene_grid *grid;
  struct {
    int8_t *items; /* of a flow: the side each body was on */
    size_t count, capacity;
  } side;
} scree_scene_sensor;

/* How a body came and went: s, NaN while it is in; UINT32_MAX: from a table, and while it is in. */
typedef struct scree_scene_stay {
  double left;
  uint32_t inlet, outlet;
} scree_scene_stay;

typedef struct scree_scene_column {
  char name[96];
  const char *unit;
} scree_scene_column;

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
  bool *usual_density;           /* of materials: none is given; NULL where the file is not known */
  double time_step, size;        /* s; m: the smallest shape's */
  uint64_t tick_steps;           /* between looks at inlets, outlets, flows and the end */
  uint64_t next_tick;            /* step */
  uint64_t map_steps, next_map;  /* likewise of looks at walls; 0: no sensor needs any */
  uint64_t hit_steps, next_hits; /* and of looks at impacts */
  scree_scene_hits hits, hits_now; /* hits_now: scratch */
  bool has_parts;
  bool *acts_on; /* of forces, each by shape */
  size_t still_ticks;
  double entered_mass, left_mass, entered_energy, left_energy;
  size_t left_count;
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

/* plan.c of a file: into the arena of whoever asks. */
scree_status scree_scene_file_plan(const scree_scene_file *file, scree_arena *arena,
                                   scree_plan *plan, scree_error *error);
/* As scree_scene_file_input, but that it fails where the file or memory does; "": no more. */
scree_status scree_scene_file_find_input(const scree_scene_file *file, size_t index, char *path,
                                         size_t size, scree_error *error);
/* A file of a tree, which it takes, of that name. */
scree_status scree_scene_file_keep(scree_yaml *root, const char *name, scree_scene_file **file,
                                   scree_error *error);
/* Whether it has parameters whose fields shrink with the largest shape (m); a copy in which they
 * have, to be freed. */
bool scree_scene_file_shrinks(const scree_scene_file *file);
scree_status scree_scene_file_shrink(const scree_scene_file *file, double largest,
                                     scree_scene_file **shrunk, scree_error *error);
/* m: the diameter of its largest shape, which is made for it; and of those of a scene. */
scree_status scree_scene_file_largest(const scree_scene_file *file, scree_shape_store *store,
                                      const scree_progress *progress, double *diameter,
                                      scree_error *error);
double scree_scene_largest(const scree_scene *scene);
/* As printed, to be freed. */
scree_status scree_scene_file_text(const scree_scene_file *file, char **text, scree_error *error);

/* particles.c: what a shape is made from, whose file lies at path. */
scree_shape_spec scree_scene_shape_spec(const scree_plan_shape *shape, const char *path);
/* The particle of one, in its order: *made holds the last one before its sizes, of which more may
 * be made; its particle is to be freed. */
typedef struct scree_scene_making {
  scree_shape_store *store; /* NULL: none */
  const scree_progress *progress;
  scree_shape_made *made;
} scree_scene_making;
scree_status scree_scene_make_shape(scree_scene *scene, size_t index, const char *folder,
                                    const scree_scene_making *making, scree_error *error);
/* Where a file named in a scene lies; NULL when memory is out. */
char *scree_scene_path(const char *folder, const char *name);

/* A world of its materials, without walls and bodies; s, 0: by what there will be. */
scree_status scree_scene_make_world(const scree_scene *scene, double time_step, scree_world **world,
                                    scree_error *error);
/* Name, text and plan of the file. */
scree_status scree_scene_take_file(scree_scene *scene, const scree_scene_file *file,
                                   scree_error *error);
/* J that is there and that the books do not explain. */
double scree_scene_missing_energy(const scree_scene *scene);
/* save.c: what a sensor has gathered, in or out. */
struct scree_codec;
void scree_scene_code_sensor(struct scree_codec *c, scree_scene *scene, scree_scene_sensor *sensor);

/* geometry.c: motions of one, from where it stands. */
scree_status scree_scene_set_motions(const scree_scene *scene, size_t index, scree_world *world,
                                     scree_error *error);
/* paths.c: the tables of a geometry's motions, once. */
scree_status scree_scene_read_paths(scree_scene *scene, size_t geometry, const char *folder,
                                    scree_error *error);
/* geometry.c: how the surface of one runs round, as of scree_wall. */
void scree_scene_belt_loop(const scree_plan_geometry *geometry, double loop[3]);
/* geometry.c: walls into a world. */
scree_status scree_scene_add_geometry(scree_scene *scene, const char *folder, scree_world *world,
                                      scree_error *error);
/* What is wrong with what the scene's file has at that place. */
scree_status scree_scene_fail(const scree_scene *scene, const scree_place *place,
                              scree_error *error, const char *format, ...) SCREE_PRINTF(4, 5);
/* The status; a failure that is told by `why` is told with its place. */
scree_status scree_scene_blame(const scree_scene *scene, const scree_place *place,
                               scree_status status, const scree_error *why, scree_error *error);
/* Whether a body in that place is clear of all walls; else *wall is one that it is not clear of. */
bool scree_scene_is_clear(const scree_scene *scene, const scree_placement *placement, size_t *wall);

/* inlets.c: the box around an inlet's region; then checks and filling. */
void scree_scene_region_of(const scree_plan_inlet *plan, double low[3], double high[3]);
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
 * measures. Then whether cells of a height field suit bodies of that size. */
scree_status scree_scene_complete_plan(scree_scene *scene, scree_error *error);
scree_status scree_scene_check_cell(const scree_scene *scene, const scree_place *place, double cell,
                                    double size, scree_error *error);
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
/* bodies.c: those that are there from the start. */
scree_status scree_scene_read_bodies(scree_scene *scene, const char *folder, scree_error *error);
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
 * the fall from it to the lowest geometry and the motion of walls. */
typedef struct scree_scene_softness {
  size_t inlet, shape, other;   /* whose bodies; against a shape, or a geometry */
  bool is_wall;                 /* other: a geometry */
  double speed, overlap, limit; /* m/s; m: v sqrt(m/K), and what the law reads */
  double size;                  /* m, of the smaller */
  double stiffer; /* so many times as stiff it would hold, in the root as many steps */
  double least;   /* of its size, by how much the stiffest contact gives way */
} scree_scene_softness;
/* False where none may. The sentence that says so is put into text. */
bool scree_scene_soft(const scree_scene *scene, scree_scene_softness *softness);
void scree_scene_describe_softness(const scree_scene *scene, const scree_scene_softness *softness,
                                   char *text, size_t size);
/* softness.c: refuses inlets so fast that bodies would pass what they hit. */
scree_status scree_scene_check_softness(const scree_scene *scene, scree_error *error);
/* outlets.c: takes out what is in an outlet or left the domain. */
void scree_scene_empty(scree_scene *scene);
/* What left the domain that the scene has where it names none. */
void scree_scene_take_lost(scree_scene *scene);
/* domain.c: the box of geometry as it stands and of the inlets; that domain. */
typedef struct scree_scene_reach {
  double low[3], high[3]; /* m; infinite where there is no end */
} scree_scene_reach;
scree_scene_reach scree_scene_reach_of(const scree_scene *scene);
scree_scene_reach scree_scene_domain(const scree_scene *scene);

/* sensors.c: classes of bodies, by which the numbers of some sensors come: of a shape's sizes each,
 * all of a shape of the file, all of a material. */
enum { SCREE_BY_SIZE, SCREE_BY_SHAPE, SCREE_BY_MATERIAL };
size_t scree_scene_class_count(const scree_scene *scene, int by);
size_t scree_scene_class_of(const scree_scene *scene, int by, size_t shape);
const char *scree_scene_class_name(const scree_scene *scene, int by, size_t index);
/* Whether now is between a sensor's `from` and `until`. */
bool scree_scene_is_watching(const scree_scene *scene, const scree_scene_sensor *sensor);
scree_status scree_scene_plan_columns(scree_scene *scene, scree_error *error);
/* Of flows: who crossed since the last tick. */
scree_status scree_scene_watch_flows(scree_scene *scene, scree_error *error);
scree_status scree_scene_record(scree_scene *scene, scree_error *error);
/* maps.c: room for all; what a look adds; the sums over a wall sensor's geometry (N s, N s, J, m3),
 * and the highest of its triangles as scree_scene_wall_map. */
scree_status scree_scene_plan_maps(scree_scene *scene, scree_error *error);
scree_status scree_scene_watch_maps(scree_scene *scene, scree_error *error);
scree_status scree_scene_read_maps(const scree_scene *scene, const scree_scene_sensor *sensor,
                                   double sums[SCREE_MAP_COUNT], double highest[SCREE_MAP_COUNT],
                                   scree_error *error);

/* parts.c: room for those that forces move; their coming step; J, kinetic and potential, and what
 * one's walls have done on bodies; what the books of all miss. */
scree_status scree_scene_plan_parts(scree_scene *scene, scree_error *error);
scree_status scree_scene_move_parts(scree_scene *scene, scree_error *error);
double scree_scene_part_energy(const scree_scene *scene, size_t geometry);
/* N along the slide or N m about the hinge, of all bodies in the last step. */
double scree_scene_push(const scree_scene *scene, size_t geometry);
double scree_scene_parts_balance(const scree_scene *scene);

/* forces.c: on whom; of the coming step. */
scree_status scree_scene_plan_forces(scree_scene *scene, scree_error *error);
scree_status scree_scene_apply_forces(scree_scene *scene, scree_error *error);

/* residence.c: its columns; its tables. */
scree_status scree_scene_read_residence(const scree_scene *scene, const scree_scene_sensor *sensor,
                                        double *at, scree_error *error);
void scree_scene_put_stays(const scree_scene *scene, const scree_scene_sensor *sensor,
                           FILE *stream);
scree_status scree_scene_put_histogram(const scree_scene *scene, const scree_scene_sensor *sensor,
                                       FILE *stream, scree_error *error);

/* impacts.c: likewise. */
scree_status scree_scene_plan_impacts(scree_scene *scene, scree_scene_sensor *sensor,
                                      scree_error *error);
scree_status scree_scene_watch_impacts(scree_scene *scene, scree_error *error);
void scree_scene_free_impacts(scree_scene_sensor *sensor);

/* grid.c: likewise; the step of the next sample. */
scree_status scree_scene_plan_grid(scree_scene *scene, scree_scene_sensor *sensor,
                                   scree_error *error);
scree_status scree_scene_watch_grids(scree_scene *scene, scree_error *error);
uint64_t scree_scene_next_sample(const scree_scene *scene);

/* tables.c: what sensors have besides columns, as CSV files in the folder. */
scree_status scree_scene_write_tables(const scree_scene *scene, const char *folder,
                                      scree_error *error);

/* measures.c: into columns from `at` on. */
scree_status scree_scene_put_pile(const scree_scene *scene, const scree_plan_pile *plan, double *at,
                                  scree_error *error);
enum { SCREE_PILE_COLUMNS = 11 };
scree_status scree_scene_measure_slope(const scree_scene *scene, const scree_plan_slope *plan,
                                       double *at, scree_error *error);
/* mixing.c: bodies in a cell, then the index of each class. */
scree_status scree_scene_measure_mixing(const scree_scene *scene, const scree_scene_sensor *sensor,
                                        double *at, scree_error *error);

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
/* At rest or as `state` says, of the shape's density. */
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

static inline bool scree_is_in(const double p[3], const double low[3], const double high[3]) {
  for (int k = 0; k < 3; k++)
    if (!(p[k] >= low[k] && p[k] <= high[k])) return false;
  return true;
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
  return (quat){body->orientation[0], body->orientation[1], body->orientation[2],
                body->orientation[3]};
}

/* Writes a frame: the same without the contacts, a fraction of the size; it can be measured and
 * drawn, not continued. */
scree_status scree_scene_save_frame(const scree_scene *scene, const char *path, bool overwrite,
                                    scree_error *error);
