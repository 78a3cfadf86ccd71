/* Mesh walls of a scene from any triangle soup. */
#pragma once

#include "mesh/repair/soup.h"
#include "scene/scene.h"

typedef struct scree_scene_walls {
  scree_mesh solid, sheet; /* without triangles where there is none */
  bool is_plain;           /* no side of it had to be told */
  char note[512];          /* one line: what there is, and what was mended */
} scree_scene_walls;

/* Walls of a mesh that is turned already, and goes to where the plan says. Closed pieces are solid
 * where the scene's inlets are not, or as the plan says. SCREE_BAD_MESH, with coordinates, where it
 * is no wall. */
scree_status scree_scene_make_walls(const scree_scene *scene, const scree_plan_geometry *plan,
                                    const scree_mesh *mesh, scree_scene_walls *walls,
                                    scree_error *error);
void scree_scene_walls_free(scree_scene_walls *walls);

/* belts.c: winds the loops of a belt outwards; solid: by piece. SCREE_BAD_MESH, with coordinates,
 * where one is not closed about the axis, or solid with an inner face. */
scree_status scree_scene_wind_belts(const scree_plan_belt *belt, scree_pieces *pieces,
                                    const bool *solid, scree_error *error);
