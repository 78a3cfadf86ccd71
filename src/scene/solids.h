/* Meshes of geometry that a scene describes by numbers, about its origin. */
#pragma once

#include "scene/plan.h"
#include "scree.h"

/* A sheet whose facets face away from the wheels. */
scree_status scree_loop_mesh(const scree_plan_loop *loop, scree_mesh *mesh, scree_error *error);
/* Two solids: a flight, which begins and ends square to the axis, and a shaft. */
scree_status scree_screw_mesh(const scree_plan_screw *screw, scree_mesh *mesh, scree_error *error);
/* One solid, its upper face at z = 0; as many whole pitches as its size holds. */
scree_status scree_sieve_mesh(const scree_plan_sieve *sieve, scree_mesh *mesh, scree_error *error);
