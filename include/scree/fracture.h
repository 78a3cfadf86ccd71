/* Fracture: a closed surface cut into cells that fill it. */
#ifndef SCREE_FRACTURE_H
#define SCREE_FRACTURE_H

#include "scree/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The most cells of a fracture. */
enum { SCREE_MOST_CELLS = 100000 };

typedef struct scree_fracture_options {
  size_t cell_count; /* in [1, SCREE_MOST_CELLS]; default 60 */
  uint64_t seed;     /* of the places of the cells; default 1 */
  /* Rounds of Lloyd's relaxation, which makes cells alike; at most 1000, default 8. 0: as drawn. */
  size_t rounds;
  /* Cells per volume fall from `near` on: at this distance from it, m, to a half; beyond, with the
   * distance squared. 0, the default: they are the same everywhere. */
  double near_distance, near[3];
  /* Cells are so many times as long along this direction, in [1, 100]; default 1: as long as wide.
   */
  double grain_stretch, grain[3];
  /* A piece with less than this share of the mean volume joins the neighbour with which it has most
   * area in common, in [0, 0.5]; default 0.01. */
  double least_volume;
  /* So does a piece that contact mechanics would refuse for an edge (SCREE_LEAST_EDGE_DEG) or a
   * facet without area, with the neighbour there; default true. */
  bool usable;
} scree_fracture_options;
SCREE_API scree_fracture_options scree_default_fracture_options(void);

/* Where two pieces meet: a plane polygon, the same triangles on both sides. */
typedef struct scree_fracture_face {
  uint32_t a, b;            /* the pieces */
  double centre[3];         /* m */
  double normal[3];         /* from a to b, unit length */
  double axis[3];           /* in the plane, the principal axis of the greater second moment */
  double area;              /* m^2 */
  double second_moments[2]; /* m^4, of the distance along `axis`, the greater, and across it */
  double reach[2];          /* the farthest corner along `axis`, and along normal x axis, m */
  double distance;          /* between the centres of the two cells along the normal, m */
} scree_fracture_face;

typedef struct scree_fracture {
  scree_mesh *pieces;
  size_t piece_count;
  scree_fracture_face *faces; /* those of more than a ten-thousandth of the mean area */
  size_t face_count;
  size_t small_face_count; /* which were left out */
  size_t apart_count;      /* cells of which several pieces were made: the body is not convex */
  size_t joined_count;     /* pieces that joined a neighbour */
  size_t restart_count;    /* of the cutting, with all places moved by a millionth of the size */
  double volume;           /* of the body, m^3; the pieces' sum to it within 1e-9 */
} scree_fracture;

SCREE_API void scree_fracture_free(scree_fracture *fracture);

/* Cuts a closed, outward surface, convex or not, into the Voronoi cells of points in it. Pieces are
 * closed; what lies between two has the same triangles, and the same vertices to the last bit, on
 * both. A cell that falls apart gives several pieces. The same mesh and options give the same bits.
 * Options NULL: the defaults. SCREE_BAD_MESH where the surface is open, inside out or so coarse in
 * its numbers that no place of the cells can be cut; SCREE_BAD_ARGUMENT, SCREE_OUT_OF_MEMORY,
 * SCREE_CANCELLED. Cost: about 20 ns for each cell and triangle, and 50 us a cell. Free *fracture
 * with scree_fracture_free. */
SCREE_API scree_status scree_mesh_fracture(const scree_mesh *mesh,
                                           const scree_fracture_options *options,
                                           const scree_progress *progress, scree_fracture *fracture,
                                           scree_error *error);

/* ---- Convex pieces ---- */

typedef struct scree_convex_options {
  /* A share: both the volume and the inertia tensor (the Frobenius norm of the difference) of the
   * pieces together may differ by so much from the mesh's; default 0.02, as a choice allows. */
  double tolerance;
  size_t most; /* pieces, in [1, 1024]; default 64 */
} scree_convex_options;
SCREE_API scree_convex_options scree_default_convex_options(void);

typedef struct scree_convex {
  scree_mesh *pieces; /* convex, closed, outward; their insides do not meet */
  size_t piece_count;
  double volume_error;  /* volume of all / the mesh's - 1: at least 0 but for rounding */
  double inertia_error; /* as in the options */
  bool within;          /* the tolerance is kept */
} scree_convex;

SCREE_API void scree_convex_free(scree_convex *convex);

/* Convex pieces that stand for a closed, outward mesh: the hulls of parts into which planes cut it.
 * The part whose hull is most too large is cut next, across one of the three axes, where the hulls
 * of both sides are least, until the tolerance is kept, `most` are made or no part can be cut.
 * Options NULL: the defaults. SCREE_BAD_MESH for any other mesh, SCREE_BAD_ARGUMENT,
 * SCREE_OUT_OF_MEMORY, SCREE_CANCELLED. Cost: some 100 hulls a cut. Free *convex with
 * scree_convex_free. */
SCREE_API scree_status scree_mesh_convex(const scree_mesh *mesh,
                                         const scree_convex_options *options,
                                         const scree_progress *progress, scree_convex *convex,
                                         scree_error *error);

/* ---- parts that are there already ---- */

/* One of an assembly. */
typedef struct scree_facing_part {
  const scree_mesh *mesh; /* closed, outward, in the space of all; borrowed */
  const char *name;       /* in sentences; borrowed */
  uint32_t group; /* parts of the same group, as the pieces of one fracture, are not compared */
} scree_facing_part;

/* Adds to the faces of *fracture (which may be empty) those where two parts lie within `gap` (m) of
 * each other: plane or nearly so, on the area where they look at each other. `distance` is from the
 * middle of what stands behind the face in one part to that in the other. Of faces of two parts
 * those below a ten-thousandth of the largest facet's are left out. SCREE_BAD_MESH where parts lie
 * deeper in each other than the gap, by names, depth and place, as their corners, edges and facets'
 * middles tell. SCREE_BAD_ARGUMENT, SCREE_OUT_OF_MEMORY. Cost: some 20 ns for two facets near each
 * other. Free *fracture with scree_fracture_free. */
SCREE_API scree_status scree_parts_face(const scree_facing_part *parts, size_t count, double gap,
                                        scree_fracture *fracture, scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
