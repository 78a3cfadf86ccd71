/* Regions of space that a plan describes: a box or a cylinder. */
#pragma once

#include "base/rng.h"
#include "scene/fill.h"
#include "scene/plan_fields.h"

typedef struct scree_region {
  const scree_plan_box *box;
  const scree_plan_cylinder *cylinder; /* both NULL: everywhere */
} scree_region;

/* The region of a record that has both fields. */
#define SCREE_REGION_OF(plan) ((scree_region){(plan)->box, (plan)->cylinder})

/* Fails unless the region has all that it needs; ends: a cylinder must have a length. */
scree_status scree_region_check(const scree_reader *reader, const scree_region *region, bool ends);
/* The box around it. */
void scree_region_bounds(const scree_region *region, double low[3], double high[3]);
bool scree_region_has(const scree_region *region, vec3 place);
/* m3; m: how far it reaches along a unit vector. */
double scree_region_volume(const scree_region *region, vec3 along, double *height);
/* The place that has such shares of its volume before it: along x, y, z; outwards, around, along.
 * A layer so thick (m; 0: none) begins where the region does, along z. */
vec3 scree_region_place(const scree_region *region, const double share[3], double thick);
/* A random place of a settled body, by its shape alone; false: it would not lie wholly inside. */
bool scree_region_draw(const scree_region *region, scree_placement *placement, scree_rng *rng);
