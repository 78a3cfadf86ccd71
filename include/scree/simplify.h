/* Decimation: the curve. */
#ifndef SCREE_SIMPLIFY_H
#define SCREE_SIMPLIFY_H

#include "scree/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum scree_method {
  SCREE_METHOD_VOLUME, /* "volume", the default: keeps the volume at every level */
  SCREE_METHOD_QECD,   /* "qecd": quadric edge collapse decimation as MeshLab's, the paper's */
} scree_method;

/* "volume" or "qecd". */
SCREE_API const char *scree_method_name(scree_method method);

typedef struct scree_simplify_options {
  scree_method method; /* default SCREE_METHOD_VOLUME */
  /* Stop at the first level with at most this many triangles; 0 (the default): go on until no
   * edge can be collapsed any more, at the least to the tetrahedron of every closed shell. */
  size_t stop_count;
  /* Only collapses that move the surface by at most this many metres, as estimated by the quadric
   * error (scree_level.quadric_error); 0 (the default): no limit. */
  double error_limit;
} scree_simplify_options;

SCREE_API scree_simplify_options scree_default_simplify_options(void);

/* The record of one decimation: from it any level can be rebuilt. Level 0 is the mesh given, level
 * i is the mesh after i edge collapses.
 * It is a progressive mesh: each level is a prefix of the collapses. */
typedef struct scree_curve scree_curve;

/* Decimates from the mesh's own count down to the floor, by edge collapses in the order of their
 * cost (docs/background/decimation.md gives the formulas and rules).
 *
 * What holds at every level: where the mesh was closed, manifold and outward, so is the level. No
 * level has more non-manifold edges, degenerate facets or folds (neighbouring triangles whose
 * normals differ by more than 150 degrees) than the mesh given. Where that nowhere meets itself, no
 * level does; where it does, collapses beside such places are refused if they add to them, but two
 * sheets that cross and face the same way may be taken for one, so that the count may grow there. A
 * vertex on an edge of three or more triangles, or where the surface touches itself in a point,
 * stays where it is. With SCREE_METHOD_VOLUME the volume of a closed mesh is kept to rounding. No
 * level has spikes: its bounding box exceeds that of the mesh given by at most half of sqrt(S / N),
 * S the area of the mesh and N the level's triangles; what would need them is refused, so that the
 * floor may be higher.
 *
 * The result depends on the order of vertices and triangles in the mesh only where costs are equal;
 * the readers and scree_mesh_weld put them in a canonical order, so that the order of facets in a
 * file does not matter at all. It does not depend on the number of threads.
 *
 * The mesh is borrowed until scree_curve_free and must not change before.
 * Fails with SCREE_BAD_MESH on a mesh without triangles, with an index out of range, a triangle
 * that names a vertex twice, a coordinate that is not finite or an extent of zero;
 * SCREE_BAD_ARGUMENT; SCREE_OUT_OF_MEMORY; SCREE_CANCELLED. Cost: O(N log N) time, about 150 bytes
 * per triangle. */
SCREE_API scree_status scree_curve_build(const scree_mesh *mesh,
                                         const scree_simplify_options *options,
                                         const scree_progress *progress, scree_curve **curve,
                                         scree_error *error);
SCREE_API void scree_curve_free(scree_curve *curve);

/* Builds the curve of a mesh as it is, then multiplies the mesh's coordinates and all that the
 * curve tells by `scale`; options->error_limit is of what comes out. Decimated after it was scaled,
 * rounding would give other levels where costs are equal: scans read as if in millimetres and
 * scaled here, as the program does, have the same levels in every unit. Where it fails the mesh
 * stays as it is; fails as scree_curve_build, and with SCREE_BAD_ARGUMENT where the scale is not
 * above 0 and finite. */
SCREE_API scree_status scree_curve_build_scaled(scree_mesh *mesh, double scale,
                                                const scree_simplify_options *options,
                                                const scree_progress *progress, scree_curve **curve,
                                                scree_error *error);

/* What is known of the run as a whole. */
typedef struct scree_curve_facts {
  scree_method method;
  size_t triangle_count;      /* of the mesh given, Nm */
  size_t floor_count;         /* of the last level */
  size_t shell_count;         /* connected pieces of surface */
  size_t boundary_edge_count; /* edges of one triangle in the mesh given */
  size_t locked_vertex_count; /* vertices that had to stay, on non-manifold places */
  bool closed;                /* every edge has two triangles, wound consistently */
} scree_curve_facts;

SCREE_API scree_curve_facts scree_curve_get_facts(const scree_curve *curve);

typedef struct scree_level {
  size_t triangle_count;
  double rp;            /* triangle_count / Nm */
  double area;          /* m^2 */
  double volume;        /* m^3; signed tetrahedra about the mesh's centre; of use if closed */
  double quadric_error; /* m; the largest root mean square move of a collapse up to here */
} scree_level;

/* At least 1; counts fall from level to level. */
SCREE_API size_t scree_curve_level_count(const scree_curve *curve);
/* level_index must be below the level count. O(1). */
SCREE_API void scree_curve_level(const scree_curve *curve, size_t level_index, scree_level *level);
/* The first level with at most target_triangle_count triangles, or the last level where none is so
 * low. A closed surface has an even count, so that an odd target gives one triangle less. */
SCREE_API size_t scree_curve_find(const scree_curve *curve, size_t target_triangle_count);
/* Rebuilds a level: vertices, and triangles where collapses lead there, in the order of the mesh
 * given. Free with scree_mesh_free. O(Nm) time. */
SCREE_API scree_status scree_curve_mesh(const scree_curve *curve, size_t level_index,
                                        scree_mesh *mesh, scree_error *error);

/* Below some 7,000 triangles a curve may go on in several orders of collapse, all as good as each
 * other by their costs, which differ by 2 per cent at most: scanning again would change them by
 * more. Order 0 is the one it was built in; all levels below change with it. scree_choose
 * leaves the one in which the fewest triangles keep the tolerances. SCREE_BAD_ARGUMENT where order
 * is not below the count, which is 1 with SCREE_METHOD_QECD. The first other order costs what that
 * part of the decimation did. */
enum { SCREE_ORDER_COUNT = 3 };
SCREE_API int scree_curve_order_count(const scree_curve *curve);
SCREE_API int scree_curve_order(const scree_curve *curve);
SCREE_API scree_status scree_curve_reorder(scree_curve *curve, int order, scree_error *error);

/* The same level with its vertices moved to where its surface is nearer to the mesh given (the mean
 * distance, by area, falls by some per cent; docs/background/decimation.md). Triangles are those of
 * scree_curve_mesh, and so is the volume of a closed level, to rounding; area and distances are
 * other than the curve's: measure what you get. What holds at every level holds here too. Where
 * nothing is gained the level comes as it is. O(Nm log Nm) time, about 150 bytes per triangle of
 * the mesh given. */
SCREE_API scree_status scree_curve_fit(const scree_curve *curve, size_t level_index,
                                       scree_mesh *mesh, scree_error *error);

/* One edge collapse of the record: what makes level index + 1 of level index. Where `gone` stood,
 * `kept` stands afterwards; triangles that name one vertex twice are no more. */
typedef struct scree_collapse {
  uint32_t kept, gone;     /* vertices of the mesh given */
  uint32_t triangle_count; /* that go: 2, or 1 at a boundary */
  double position[3];      /* of kept afterwards, m */
} scree_collapse;

/* How many collapses there are: they make the levels up to this one. */
SCREE_API size_t scree_curve_collapse_count(const scree_curve *curve);
/* index must be below that. O(1). */
SCREE_API void scree_curve_collapse(const scree_curve *curve, size_t index,
                                    scree_collapse *collapse);

/* Goes through many levels, from fine to coarse, in one sweep: O(Nm) for all steps together and the
 * size of each level for its step. */
typedef struct scree_replay scree_replay;
SCREE_API scree_status scree_replay_start(const scree_curve *curve, scree_replay **replay,
                                          scree_error *error);
SCREE_API void scree_replay_free(scree_replay *replay);
/* Goes on to a level not before the present one and gives its mesh, which belongs to the replay and
 * changes with the next step. */
SCREE_API scree_status scree_replay_step(scree_replay *replay, size_t level_index,
                                         const scree_mesh **mesh, scree_error *error);
/* For every vertex of the mesh given its index in the level's mesh, UINT32_MAX where the level has
 * it no more. Belongs to the replay, of use after a step and changed by the next. */
SCREE_API const uint32_t *scree_replay_numbering(const scree_replay *replay);

#ifdef __cplusplus
}
#endif
#endif
