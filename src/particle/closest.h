/* Closest points: point to face, segment to segment, point to surface. */
#ifndef SCREE_PARTICLE_CLOSEST_H
#define SCREE_PARTICLE_CLOSEST_H

#include "particle/particle.h"

/* Where on a face the closest point lies. */
typedef enum scree_region {
  SCREE_REGION_INSIDE,
  SCREE_REGION_EDGE, /* + 0, 1, 2 for the edges 01, 12, 20 */
  SCREE_REGION_CORNER = SCREE_REGION_EDGE + 3,
} scree_region;

/* Closest point of the face to p, with its region. */
vec3 scree_closest_on_face(const scree_face *face, vec3 p, int *region);

/* Closest points at start + s (end - start) on both segments, s and t in [0, 1]. */
void scree_closest_on_segments(vec3 p0, vec3 p1, vec3 q0, vec3 q1, double *s, double *t);

enum { SCREE_NEAR_FACES = 6 };

/* The faces nearest to a point. */
typedef struct scree_near {
  uint32_t face[SCREE_NEAR_FACES];
  double distance[SCREE_NEAR_FACES]; /* ascending */
  int count;
  double next; /* every other face is at least this far */
} scree_near;

/* All faces that are within `slack` of the closest one, as far as there is room, and not farther
 * than `reach`; count 0 when none is within reach. */
void scree_closest_faces(const scree_particle *particle, vec3 p, double reach, double slack,
                         scree_near *near);

/* Whether p is inside a closed surface, by its winding number (van Oosterom and Strackee 1983). */
bool scree_is_inside(const scree_particle *particle, vec3 p);

/* Least distance from p against direction to a face met from behind; INFINITY for none. */
double scree_ray_depth(const scree_particle *particle, vec3 p, vec3 direction, size_t skip_face);

#endif
