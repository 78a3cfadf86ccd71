/* A kind of geometry: one file of this folder, which holds the rows of its fields and what makes
 * walls of them, and the one object by which everything else knows it, scree_geometry_KEY. Its row
 * in kinds.h puts it into the table over which geometry.c loops; nothing else names a kind.
 *
 * It has a `mesh` or `walls`; whatever else is NULL or false it has not. */
#pragma once

#include "base/vec.h"
#include "scene/file.h"
#include "scene/plan_fields.h"

/* Geometry that layers may fill. NaN: a width that follows from what they pour. */
typedef struct scree_container {
  const scree_place *place;
  const char *key;       /* of the width */
  double *width, *depth; /* m, inside; of a round one its radius, and NULL */
  bool upright;          /* about z */
} scree_container;

/* One copy of a geometry on its way into a world. */
typedef struct scree_geometry_making {
  scree_scene *scene;
  size_t index; /* of the geometry */
  scree_plan_geometry copy;
  const char *folder;
  scree_world *world;
  bool tells; /* the first copy, for the gallery */
} scree_geometry_making;

typedef struct scree_geometry_kind {
  bool closes; /* it may be closed, and `side` says where bodies are */
  bool runs;   /* it may be a belt */
  /* What single fields and their record's own check cannot say. */
  scree_status (*check)(const scree_reader *reader, const scree_plan_geometry *geometry);
  /* Whether it goes on across the boundary of a periodic domain, as it turns. */
  bool (*goes_on)(const scree_plan_geometry *geometry, bool turning);
  scree_container (*container)(const scree_plan_geometry *geometry);
  /* The names of its files. */
  scree_texts (*files)(const scree_plan_geometry *geometry);
  /* Its surface about its origin, before it is turned; what is closed in it becomes solid. */
  scree_status (*mesh)(const scree_plan_geometry *geometry, scree_mesh *mesh, scree_error *error);
  /* Its walls, by the functions below. */
  scree_status (*walls)(const scree_geometry_making *making, scree_error *error);
} scree_geometry_kind;

#define SCREE_GEOMETRY_EXTERN(T, row, key, ...)                                                    \
  extern const scree_geometry_kind scree_geometry_##key;
SCREE_GEOMETRY_KINDS(SCREE_GEOMETRY_EXTERN, )

/* ---- what kinds ask for ---- */

#define SCREE_DEGREE 0.017453292519943295

/* How it is turned; how its surface runs round, as of scree_wall. */
quat scree_geometry_turn_of(const scree_plan_geometry *geometry);
void scree_geometry_belt_loop(const scree_plan_geometry *geometry, double loop[3]);
/* A direction of the geometry as it stands. */
void scree_geometry_turn(const scree_plan_geometry *geometry, const double from[3], double to[3]);
/* The wall, with the material, place and surface of the copy. */
scree_status scree_geometry_add_wall(const scree_geometry_making *making, scree_wall *wall,
                                     scree_error *error);
/* What is solid of a mesh, which it takes, and what is a sheet; of a file with what was done. */
scree_status scree_geometry_add_mesh(const scree_geometry_making *making, bool is_file,
                                     scree_mesh *mesh, scree_error *error);
/* Fails unless a surface velocity lies in a surface of that normal. */
scree_status scree_geometry_check_surface(const scree_reader *reader,
                                          const scree_plan_geometry *geometry,
                                          const double normal[3]);
/* Fails unless a span is square to an axis. */
scree_status scree_geometry_check_span(const scree_reader *reader, const scree_place *place,
                                       const double axis[3], const double span[3]);

/* ---- copies.c ---- */

/* m: from the first copy to another along their way; rad without a chain. */
double scree_copy_way(const scree_plan_round *round, size_t copy);
/* The geometry as a copy of it stands; its turn is put into `turn`. */
scree_plan_geometry scree_copy_of(const scree_plan_geometry *geometry, size_t copy,
                                  scree_plan_turn *turn);
