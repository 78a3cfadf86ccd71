/* The point of a triangle that is nearest to another point: one by one, and side by side for one
 * triangle and many points or the other way round, with the same bits. Flat triangles and points
 * are fine. */
#ifndef SCREE_MESH_CLOSEST_H
#define SCREE_MESH_CLOSEST_H

#include "base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The distance of p from one triangle, squared; *point is the nearest point. */
double scree_triangle_closest(const double corners[9], vec3 p, vec3 *point);

/* Eight triangles side by side: of fewer, each operation would wait for the one before. */
enum { SCREE_EIGHT = 8 };
typedef struct scree_eight {
  double at[3][3][SCREE_EIGHT];   /* corner, axis */
  double side[3][3][SCREE_EIGHT]; /* from each corner to the next, axis */
  double length2[3][SCREE_EIGHT]; /* of these, squared */
  double n[3][SCREE_EIGHT], n2[SCREE_EIGHT];
  uint8_t needle[SCREE_EIGHT]; /* flat, or nearly: an own way is taken */
  bool has_needle;
} scree_eight;

/* How many eights hold so many triangles. */
static inline size_t scree_eight_count(size_t count) {
  return (count + SCREE_EIGHT - 1) / SCREE_EIGHT;
}

/* Makes these triangles, at least one, ready: their eights, of which the last one repeats the last
 * triangle. */
void scree_eights_fill(const double (*corners)[9], size_t count, scree_eight *eights);

/* The squared distances of p from all triangles of the eights, in their order. */
void scree_eights_closest(const scree_eight *eights, size_t eight_count, vec3 p, double *distance2);

/* Points side by side; the first `count` of `at` are the caller's to set. */
enum { SCREE_POINTS = 32 };
typedef struct scree_points {
  int count;
  double at[3][SCREE_POINTS];
  double nearest[3][SCREE_POINTS]; /* on the triangle */
  double distance2[SCREE_POINTS];  /* from there */
} scree_points;

/* Finds what of one triangle is nearest to each of them. */
void scree_points_closest(const double corners[9], scree_points *points);

static inline void scree_points_add(scree_points *points, vec3 p) {
  int i = points->count++;
  points->at[0][i] = p.x;
  points->at[1][i] = p.y;
  points->at[2][i] = p.z;
}

#endif
