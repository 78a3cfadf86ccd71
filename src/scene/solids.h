/* Meshes of geometry that a scene describes by numbers, about its origin. */
#ifndef SCREE_SCENE_SOLIDS_H
#define SCREE_SCENE_SOLIDS_H

#include "scene/plan.h"
#include "scree.h"

/* A sheet whose facets face away from the wheels. */
scree_status scree_loop_mesh(const scree_plan_loop *loop, scree_mesh *mesh, scree_error *error);

#endif
