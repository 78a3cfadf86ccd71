/* A scene at work: what its parts share. */
#ifndef SCREE_SCENE_SCENE_H
#define SCREE_SCENE_SCENE_H

#include "mesh/bvh.h"
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
  scree_placement extent;   /* clearance included */
  quat as_given;            /* its orientation as in its file */
  double mass, volume;
  size_t entered, left;
} scree_scene_shape;

/* A piece of geometry is one wall of the world or several. */
typedef struct scree_scene_geometry {
  size_t first_wall, wall_count;
} scree_scene_geometry;

/* What placing a body must know of a wall made of triangles. */
typedef struct scree_scene_surface {
  scree_bvh bvh; /* of a mesh; else empty */
  bool closed;
} scree_scene_surface;

typedef struct scree_scene_inlet {
  const scree_plan_inlet *plan;
  size_t *shapes, *counts; /* index of each of its shapes; how many of it entered */
  size_t entered, waiting;
  double mass;
  uint64_t draws; /* random numbers used */
} scree_scene_inlet;

typedef struct scree_scene_outlet {
  size_t left;
  double mass;
} scree_scene_outlet;

typedef struct scree_scene_sensor {
  const scree_plan_sensor *plan;
  size_t first_column;
  size_t geometry;      /* of a wall */
  double *count, *mass; /* of a flow and of residence, by shape, all shapes last */
  double *sum, *sum2;   /* of residence, s and s2, likewise */
  struct {
    int8_t *items; /* of a flow: the side each body was on */
    size_t count, capacity;
  } side;
} scree_scene_sensor;

typedef struct scree_scene_column {
  char name[96];
  const char *unit;
} scree_scene_column;

struct scree_scene {
  scree_arena arena;
  scree_plan plan;
  char *text; /* the file, printed */
  char *name;
  scree_world *world, *gallery; /* the gallery has one body of each shape, never moved */
  scree_scene_shape *shapes;
  scree_scene_geometry *geometry;
  scree_scene_surface *surfaces; /* by wall */
  size_t wall_count;
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
    scree_placement *items; /* scratch of inlets */
    size_t count, capacity;
  } present;
  double time_step, size; /* s; m: the smallest shape's */
  uint64_t tick_steps;    /* between looks at inlets, outlets, flows and the end */
  uint64_t next_tick;     /* step */
  size_t still_ticks;
  double entered_mass, left_mass, entered_energy, left_energy;
  size_t left_count;
  int end; /* index into the reasons; 0: it goes on */
};

/* plan.c of a file: into the arena of whoever asks. */
scree_status scree_scene_file_plan(const scree_scene_file *file, scree_arena *arena,
                                   scree_plan *plan, scree_error *error);
/* As printed, to be freed. */
scree_status scree_scene_file_text(const scree_scene_file *file, char **text, scree_error *error);

/* particles.c: what a shape is made from. *source is to be freed. */
scree_status scree_scene_make_particle(const scree_plan_shape *shape, const char *folder,
                                       const scree_progress *progress, scree_particle **particle,
                                       char **source, scree_error *error);

/* A box about the origin; free with scree_mesh_free. */
scree_status scree_scene_box_mesh(const double sides[3], scree_mesh *mesh, scree_error *error);
/* Where a file named in a scene lies; NULL when memory is out. */
char *scree_scene_path(const char *folder, const char *name);

/* geometry.c: walls into a world, and what placing must know of them. */
scree_status scree_scene_add_geometry(scree_scene *scene, const char *folder, scree_world *world,
                                      scree_error *error);
scree_status scree_scene_find_surfaces(scree_scene *scene, scree_error *error);
/* Whether a body in that place is clear of all walls; else *wall is one that it is not clear of. */
bool scree_scene_is_clear(const scree_scene *scene, const scree_placement *placement, size_t *wall);

/* inlets.c */
scree_status scree_scene_check_inlets(scree_scene *scene, scree_error *error);
scree_status scree_scene_fill(scree_scene *scene, scree_error *error);
/* Whether nothing more will come, ever. */
bool scree_scene_is_filled(const scree_scene *scene);

/* outlets.c: takes out what is in an outlet or left the domain. */
void scree_scene_empty(scree_scene *scene);

/* sensors.c */
scree_status scree_scene_plan_columns(scree_scene *scene, scree_error *error);
/* Of flows: who crossed since the last tick. */
scree_status scree_scene_watch_flows(scree_scene *scene, scree_error *error);
void scree_scene_note_leaving(scree_scene *scene, size_t body);
scree_status scree_scene_record(scree_scene *scene, scree_error *error);
/* measures.c: into columns from `at` on. */
scree_status scree_scene_measure_pile(const scree_scene *scene, const scree_plan_pile *plan,
                                      double *at, scree_error *error);
double scree_scene_measure_slope(const scree_scene *scene, const scree_plan_slope *plan);
scree_status scree_scene_measure_mixing(const scree_scene *scene,
                                        const scree_plan_segregation *plan, double *at,
                                        scree_error *error);

/* scene.c: the arrays of a scene that has a plan; then, with its particles, gallery and world. */
scree_status scree_scene_prepare(scree_scene *scene, scree_error *error);
scree_status scree_scene_set_up(scree_scene *scene, const char *folder, scree_error *error);
/* One that ended goes on where its file gives it more time, without the row of its end; whether it
 * had ended. */
bool scree_scene_reopen(scree_scene *scene);
/* What the engine must know of a shape that has its particle. */
void scree_scene_measure_shape(scree_scene *scene, size_t index);
/* save.c: a checkpoint, for scree_world_keep_all. */
scree_status scree_scene_pack(const void *scene, unsigned char **bytes, size_t *byte_count,
                              scree_error *error);

#define SCREE_SCENE_SHAPES(scene) ((scene)->plan.shapes.count)

static inline quat scree_body_turn(const scree_body *body) {
  return (quat){body->orientation[0], body->orientation[1], body->orientation[2],
                body->orientation[3]};
}

#endif
