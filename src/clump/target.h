/* The body that a clump stands for, in its own frame: centroid at 0, volume 1, principal axes, the
 * longest along z, each turned to where the third moment along it is positive. So a turned scan is
 * the same body but for rounding. */
#pragma once

#include "mesh/index/bvh.h"
#include "mesh/mesh.h"

/* Moments of a solid, in this order: volume; x y z; moments of inertia about the axes, yy + zz,
 * xx + zz, xx + yy; xy xz yz. */
enum { SCREE_MOMENTS = 10, SCREE_FIRST_INERTIA = 4, SCREE_FIRST_PRODUCT = 7 };
enum { SCREE_MOST_SPHERES = 400 };
/* The diameter of the sphere of volume 1. */
#define SCREE_UNIT_SIZE 1.2407009817988

typedef struct scree_target {
  scree_mesh mesh;
  scree_bvh tree;
  double *area_below; /* area of the triangles up to and with each */
  double moments[SCREE_MOMENTS];
  vec3 low, high; /* bounding box */
  double area;
  /* A point p of the frame is centre + scale * (axes transposed) p of the mesh given. */
  mat3 axes;
  vec3 centre;
  double scale; /* m */
} scree_target;

/* SCREE_BAD_MESH where the mesh is open, inside out or without volume. */
scree_status scree_target_make(const scree_mesh *mesh, scree_target *body, scree_error *error);
void scree_target_free(scree_target *body);

void scree_target_monomials(vec3 p, double monomials[SCREE_MOMENTS]);

/* A point of the surface: where it is, and the unit normal there. */
typedef struct scree_target_point {
  vec3 at, normal;
} scree_target_point;

/* Point `index` of `count` that are spread evenly over the area (a low-discrepancy sequence). */
scree_target_point scree_target_sample(const scree_target *body, size_t index, size_t count);

/* The point nearest to p, the distance, and the normal there. */
scree_target_point scree_target_nearest(const scree_target *body, vec3 p, double *distance);

/* The radius of the largest ball inside that touches the surface at this point: from a large one it
 * shrinks to pass through what it still holds (Ma, Bae, Choi 2012, "3D medial axis point
 * approximation using nearest neighbors and the normal field"). */
double scree_target_tangent_radius(const scree_target *body, scree_target_point point);

/* The local thickness, twice that radius, of which a quarter of the surface has less. */
scree_status scree_target_thickness(const scree_target *body, double *thickness,
                                    scree_error *error);
