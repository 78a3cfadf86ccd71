/* The point of a triangle that is nearest to another point: one by one, and side by side for
 * many points, with the same bits. Flat triangles and points are fine. */
#pragma once

#include "base/box.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The distance of p from one triangle, squared; *point is the nearest point. */
double scree_triangle_closest(const double corners[9], vec3 p, vec3 *point);

/* Points side by side, near each other, and what of a surface is nearest to each so far. */
enum { SCREE_EIGHT = 8, SCREE_POINTS = 32 };
typedef struct scree_point_block {
  int count;
  double at[3][SCREE_POINTS];
  double distance2[SCREE_POINTS];
  uint64_t index[SCREE_POINTS]; /* of the triangle */
} scree_point_block;

/* Starts with no triangle; at least one point. */
void scree_point_block_set(scree_point_block *points, const vec3 *at, int count);

/* Keeps the triangle, of that index, for the points that it is nearer to than what was found. */
void scree_point_block_closest(scree_point_block *points, const double corners[9], uint32_t index);

/* The largest of the distances, squared; whether a point is nearer to the box than to what was
 * found. */
double scree_point_block_farthest(const scree_point_block *points);
bool scree_point_block_near(const scree_point_block *points, const scree_box *box);
