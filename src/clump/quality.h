/* How well spheres stand for a body. */
#pragma once

#include "clump/exposed.h"
#include "clump/field.h"
#include "clump/overlap.h"

/* A body, what measures spheres against it, and scratch. */
typedef struct scree_judge {
  const scree_target *body;
  const scree_distance_field *field;
  scree_ruler *ruler;
  scree_directions directions;
  vec3 *points; /* on the exposed surface of the clump at hand */
  size_t point_count;
} scree_judge;

scree_status scree_judge_make(const scree_target *body, const scree_distance_field *field,
                              scree_ruler *ruler, scree_judge *judge, scree_error *error);
void scree_judge_free(scree_judge *judge);

/* All of the clump but its spheres; these are in the body's frame, what is answered is in metres.
 * Distances are taken at some thousand points of either surface: means to a hundredth, maxima are
 * lower bounds. */
scree_clump scree_judge_clump(scree_judge *judge, const scree_sphere *spheres, size_t count);
