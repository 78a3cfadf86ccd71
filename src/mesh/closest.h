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

/* Four triangles side by side. */
enum { SCREE_FOUR = 4 };
typedef struct scree_four {
  double at[3][3][SCREE_FOUR]; /* corner, axis */
  double n[3][SCREE_FOUR], n2[SCREE_FOUR];
  bool needle[SCREE_FOUR], has_needle; /* flat, or nearly: an own way is taken */
} scree_four;

/* How many fours hold so many triangles. */
static inline size_t scree_four_count(size_t count) {
  return (count + SCREE_FOUR - 1) / SCREE_FOUR;
}

/* Makes these triangles, at least one, ready: their fours, of which the last one repeats the last
 * triangle. */
void scree_fours_fill(const double (*corners)[9], size_t count, scree_four *fours);

/* The squared distances of p from all triangles of the fours, in their order. */
void scree_fours_closest(const scree_four *fours, size_t four_count, vec3 p, double *distance2);

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
