/* Closest points: point to face, segment to segment, point to surface. */
#pragma once

#include "particle/particle.h"

/* Where on a face the closest point lies. */
typedef enum scree_closest_region {
  SCREE_REGION_INSIDE,
  SCREE_REGION_EDGE, /* + 0, 1, 2 for the edges 01, 12, 20 */
  SCREE_REGION_CORNER = SCREE_REGION_EDGE + 3,
} scree_closest_region;

/* The closest point when the projection is outside: the nearest of the three edges. */
vec3 scree_closest_on_border(const scree_face *face, vec3 p, int *region);

/* Closest point of the face to p, with its region. */
static inline vec3 scree_closest_on_face(const scree_face *face, vec3 p, int *region) {
  vec3 w = vec3_sub(p, face->corner);
  double d1 = vec3_dot(w, face->along1), d2 = vec3_dot(w, face->along2);
  double u = (face->d22 * d1 - face->d12 * d2) * face->inverse,
         v = (face->d11 * d2 - face->d12 * d1) * face->inverse;
  if (u >= 0 && v >= 0 && u + v <= 1) {
    *region = SCREE_REGION_INSIDE;
    return vec3_mad(p, face->normal, -vec3_dot(w, face->normal));
  }
  return scree_closest_on_border(face, p, region);
}

/* Whose dot product with the way from the closest point tells the side: above 0 outside. */
static inline vec3 scree_outward(const scree_particle *surface, uint32_t face, int region) {
  if (region == SCREE_REGION_INSIDE) return surface->faces[face].normal;
  const scree_face_signs *signs = &surface->face_signs[face];
  return region >= SCREE_REGION_CORNER ? signs->corner[region - SCREE_REGION_CORNER]
                                       : signs->edge[region - SCREE_REGION_EDGE];
}

static inline double scree_clamped(double x, double high) {
  return x < 0 ? 0 : x > high ? high : x;
}

/* Closest points p + s u and q + t v of two segments along unit vectors, s in [0, length_p] and t
 * in [0, length_q]: Ericson (2005, 5.1.9) with clamping. */
static inline void scree_closest_on_segments(vec3 p, vec3 u, double length_p, vec3 q, vec3 v,
                                             double length_q, double *s, double *t) {
  vec3 w = vec3_sub(p, q);
  double f = vec3_dot(v, w), c = vec3_dot(u, w), b = vec3_dot(u, v), sine2 = 1 - b * b;
  double ss = sine2 > 1e-14 ? scree_clamped((b * f - c) / sine2, length_p) : 0, tt = b * ss + f;
  if (tt < 0) {
    tt = 0;
    ss = scree_clamped(-c, length_p);
  } else if (tt > length_q) {
    tt = length_q;
    ss = scree_clamped(b * length_q - c, length_p);
  }
  *s = ss;
  *t = tt;
}

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

/* The nearest face below these nodes of the face tree that is closer than `reach`, and its
 * distance; INFINITY for none. */
double scree_nearest_face(const scree_particle *particle, const uint32_t *nodes, int node_count,
                          vec3 p, double reach, uint32_t *face);

/* Whether some face is closer than `reach`. */
bool scree_is_near(const scree_particle *particle, vec3 p, double reach);

/* Whether p is in the solid of a closed surface: whether a ray from p leaves it more often than it
 * enters; of a hollow one, not less often.
 * Exact but for points within rounding of the surface, which may be either. */
bool scree_is_inside(const scree_particle *particle, vec3 p);

/* A straight way start + s along, `along` a unit vector, for s in (after, before]. */
typedef struct scree_ray_interval {
  vec3 start, along;
  double after, before;
} scree_ray_interval;

/* Where the way next passes through a face whose normal has a dot product of at least `least` with
 * `along`, or with its opposite where `least` is 0, other than `skip`; INFINITY for none. */
double scree_next_passage(const scree_particle *particle, const scree_ray_interval *way,
                          double least, size_t skip, uint32_t *face);
