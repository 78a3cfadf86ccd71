/* What a particle knows: its contact features in its own frame. The world reads these directly. */
#pragma once

#include "base/tree.h"
#include "particle/mass.h"

#include <stdatomic.h>

/* A face for closest-point queries. The outward side at its own inside, edges and corners is given
 * by `normal` and by the angle-weighted pseudonormals (Baerentzen and Aanaes 2005). */
typedef struct scree_face {
  vec3 corner, along1, along2;   /* corner 0; corners 1 and 2 relative to it */
  vec3 normal;                   /* unit */
  double d11, d12, d22, inverse; /* dot products of along1, along2; 1/(d11 d22 - d12^2) */
} scree_face;
typedef struct scree_face_signs {
  vec3 edge[3];   /* over the edges 01, 12, 20 */
  vec3 corner[3]; /* at the corners */
  uint32_t sheet; /* which of the connected parts of the surface, over edges of two faces */
} scree_face_signs;

/* rad; by this the cones of edges are widened: bodies may turn by it while a list of contacts
 * holds. */
static const double scree_cone_slack = 0.06;

/* A straight convex edge. */
typedef struct scree_edge {
  vec3 start, end;
  vec3 along; /* unit, from start to end */
  double length;
  scree_cone normals; /* from one face's to the other's, widened (features.c) */
  double facing;      /* least cosine of a contact's normal with their axis */
} scree_edge;

enum { SCREE_INNER_PLACES = 8 };

struct scree_particle {
  atomic_int reference_count;
  scree_particle_measures measures;
  scree_mesh mesh; /* in the particle's frame */
  double radius;   /* of the rounding, m: at least that by which the surface stands out */
  double *core;    /* the mesh's vertices moved in by the difference, or NULL; features are its */
  scree_face *faces;
  scree_face_signs *face_signs;
  size_t face_count;
  vec3 *points;
  double *point_radii;
  size_t point_count;
  scree_edge *edges;
  size_t edge_count;
  scree_tree face_tree, edge_tree, point_tree;
  vec3 inner[SCREE_INNER_PLACES]; /* places within (inner.c), none in walls */
  uint32_t inner_count;
  double inner_depth; /* of the first, which is the deepest, m */
  scree_box box;      /* of everything, rounding included */
  bool sheet;  /* met from both sides, and where it ends by rims: an open surface, or one that is to
                  be */
  bool hollow; /* wound inwards: what lies outside it is solid */
};

/* Cosine of contacts with a rim from the sheet's own side. */
static const double scree_rim_slack = 0.3;
/* Where a sheet ends: met from below and from both of its faces, a little more than half around:
 * what lies flat on the sheet and reaches beyond it presses on the rim squarely to either. */
scree_edge scree_rim_edge(vec3 start, vec3 end, vec3 outward);
static inline bool scree_is_rim(const scree_edge *edge) {
  return edge->facing < 0;
}
/* Whether it is more than spheres: a mesh, or rims alone. */
static inline bool scree_has_features(const scree_particle *particle) {
  return particle->face_count > 0 || particle->edge_count > 0;
}

/* The contact radius of a mesh's features against another body: the surface stands out by no more
 * than a share of the other's size. A grain on a slab would float. */
static inline double scree_contact_radius(const scree_particle *mesh, const scree_particle *other) {
  const double share = 0.005; /* bodies of about a size stand out by less, each by its own */
  double excess = mesh->measures.rounding - share * other->measures.size;
  return excess > 0 ? mesh->radius - excess : mesh->radius;
}

void scree_particle_retain(scree_particle *particle);

/* The surface alone, in the mesh's own coordinates, without mass: for walls. May be open; one that
 * is closed and wound inwards holds what is in it; `two_sided`: as if it were open. Its measured
 * volume is what it encloses, 0 where nothing is solid. */
scree_status scree_particle_surface(const scree_mesh *mesh, double rounding, bool two_sided,
                                    scree_particle **particle, scree_error *error);

/* scree_particle_clump with the mass properties of a solid, or of the union where that is NULL. */
scree_status scree_particle_clump_of(const double *centres, const double *radii, size_t count,
                                     const scree_solid *solid, scree_particle **particle,
                                     scree_error *error);

/* A circle about the z axis, where a round sheet ends. */
typedef struct scree_circle {
  double radius, height;
  double radial, axial; /* unit: away from the sheet */
} scree_circle;

/* Circles as points and edges without faces, for the rims of walls: polygons of half a degree,
 * which are within 1e-5 of the radius. */
scree_status scree_particle_circles(const scree_circle *circles, size_t count,
                                    scree_particle **particle, scree_error *error);

/* The same particle again, to the last bit, from its measures and its mesh, or its `count` spheres,
 * all in its own frame: features and trees follow from these. */
scree_status scree_particle_restore(const scree_particle_measures *measures, const scree_mesh *mesh,
                                    const double *centres, const double *radii, size_t count,
                                    scree_particle **particle, scree_error *error);

/* The same shape, `factor` times as large. */
scree_status scree_particle_scaled(const scree_particle *from, double factor,
                                   scree_particle **particle, scree_error *error);

/* features.c: fills faces, signs, points and edges from particle->mesh. A wall may be open, and its
 * edges as sharp as they come. */
scree_status scree_particle_extract_features(scree_particle *particle, bool is_wall,
                                             scree_error *error);
/* inset.c: the core that lies `by` inside the faces, or nearer where the shape has no room. */
scree_status scree_particle_make_core(scree_particle *particle, double by, scree_error *error);
/* inner.c: needs the trees. */
void scree_particle_find_inner(scree_particle *particle);
/* Trees and the box over what was extracted. */
scree_status scree_particle_build_trees(scree_particle *particle, scree_error *error);
