/* The distinct particles of a world, numbered in the order of their first body. */
#pragma once

#include "report/json.h"

typedef struct scree_shapes {
  scree_particle **particles; /* of each shape, borrowed */
  size_t count;
  size_t *of_body;     /* the shape of every body ever added */
  scree_mesh *spheres; /* scree_shapes_draw: of each shape that is made of spheres; else empty */
} scree_shapes;

scree_status scree_shapes_find(const scree_world *world, scree_shapes *shapes, scree_error *error);
void scree_shapes_free(scree_shapes *shapes);
/* Makes a surface of each shape, in its frame; spheres as scree_spheres_mesh. */
scree_status scree_shapes_draw(scree_shapes *shapes, int level, scree_error *error);
const scree_mesh *scree_shape_surface(const scree_shapes *shapes, size_t shape);

/* Of each body the greatest share of its strength that a whole joint of it uses, as the world
 * stands; without any, 0. */
void scree_joint_loads(const scree_world *world, float *loads);

/* Bodies that are in the world. */
size_t scree_world_live_count(const scree_world *world);

/* Shapes told apart by colour, in pictures and on the page: shape k has colour k modulo their
 * number. */
enum { SCREE_SHAPE_COLORS = 9 };
/* As sRGB 0xrrggbb, and as linear RGB in [0, 1]. */
uint32_t scree_shape_color(size_t shape);
void scree_shape_color_linear(size_t shape, float linear[3]);

/* kind, counts and sizes of a particle, as members of the open object (docs/reference/formats.md).
 */
void scree_shape_json(scree_json *json, const scree_particle *particle);

/* The spheres of a sphere or clump, in its frame, each as an icosphere of 20 * 4^level triangles.
 */
scree_status scree_spheres_mesh(const scree_particle *particle, int level, scree_mesh *mesh,
                                scree_error *error);

/* What is drawn of a wall, in its own frame: its triangles; planes and endless cylinders are cut
 * off where the bodies end. Free with scree_mesh_free. */
scree_status scree_wall_mesh(const scree_world *world, size_t index, scree_mesh *mesh,
                             scree_error *error);
