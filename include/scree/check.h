/* Check and repair. */
#ifndef SCREE_CHECK_H
#define SCREE_CHECK_H

#include "scree/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The sharpest edge that contact mechanics bears, degrees between two neighbouring facets, in the
 * material or outside it: what check, repair and particles refuse. */
#define SCREE_LEAST_EDGE_DEG 4.5

/* What can be wrong with a surface: X(NAME, "name in JSON", grave, "what one is", "what several
 * are"). A surface with a grave one cannot serve as a particle; the others are worth knowing. */
#define SCREE_DEFECT_LIST(X)                                                                       \
  X(BAD_COORDINATE, "bad_coordinates", true, "vertex that is not finite, or beyond 1e30 m",        \
    "vertices that are not finite, or beyond 1e30 m")                                              \
  X(DEGENERATE_FACET, "degenerate_facets", true, "facet without area", "facets without area")      \
  X(DUPLICATE_FACET, "duplicate_facets", true, "facet on the same three vertices as another",      \
    "facets on the same three vertices as another")                                                \
  X(BOUNDARY_EDGE, "boundary_edges", true, "edge of one facet only: the surface is open",          \
    "edges of one facet only: the surface is open")                                                \
  X(HOLE, "holes", true, "connected set of boundary edges", "connected sets of boundary edges")    \
  X(NON_MANIFOLD_EDGE, "non_manifold_edges", true, "edge of three or more facets",                 \
    "edges of three or more facets")                                                               \
  X(NON_MANIFOLD_VERTEX, "non_manifold_vertices", true, "vertex where separate fans meet",         \
    "vertices where separate fans meet")                                                           \
  X(INCONSISTENT_EDGE, "inconsistent_edges", true, "edge whose two facets are wound unlike",       \
    "edges whose two facets are wound unlike")                                                     \
  X(INSIDE_OUT_SHELL, "inside_out_shells", true, "closed shell wound clockwise from outside",      \
    "closed shells wound clockwise from outside")                                                  \
  X(CROSSING_PAIR, "crossing_pairs", true, "pair of facets that pass through each other",          \
    "pairs of facets that pass through each other")                                                \
  X(TOUCHING_PAIR, "touching_pairs", true, "pair of facets that touch beyond shared edges",        \
    "pairs of facets that touch beyond shared edges")                                              \
  X(OVERLAPPING_PAIR, "overlapping_pairs", true, "pair of coplanar facets with a common area",     \
    "pairs of coplanar facets with a common area")                                                 \
  X(OVERLAPPING_SHELLS, "overlapping_shell_pairs", true, "pair of shells that cross or touch",     \
    "pairs of shells that cross or touch")                                                         \
  X(NESTED_SHELL, "nested_shells", true, "outward shell inside the material of another",           \
    "outward shells inside the material of another")                                               \
  X(CAVITY, "cavities", false, "inward shell inside the material of another",                      \
    "inward shells inside the material of another")                                                \
  X(EXTRA_BODY, "extra_bodies", false, "closed outward shell in empty space, beyond the first",    \
    "closed outward shells in empty space, beyond the first")                                      \
  X(UNUSED_VERTEX, "unused_vertices", false, "vertex of no facet", "vertices of no facet")         \
  X(SHARP_EDGE, "sharp_edges", true, "edge of less than 4.5 degrees: blunt it or decimate",        \
    "edges of less than 4.5 degrees: blunt them or decimate")

typedef enum scree_defect {
#define SCREE_DEFECT_ENUM(name, key, grave, one, several) SCREE_DEFECT_##name,
  SCREE_DEFECT_LIST(SCREE_DEFECT_ENUM)
#undef SCREE_DEFECT_ENUM
      SCREE_DEFECT_COUNT
} scree_defect;

/* The name in JSON, what so many of it are in words, and whether it is grave. */
SCREE_API const char *scree_defect_name(scree_defect defect);
SCREE_API const char *scree_defect_text(scree_defect defect, size_t count);

/* A surface of which more pairs of facets meet is no surface. */
enum { SCREE_PAIR_LIMIT = 20000000 };

typedef struct scree_check {
  size_t triangle_count, vertex_count;
  size_t shell_count; /* sets of facets connected through shared edges */
  double size[3];     /* along x, y, z, m; 0 where coordinates are bad or there are no facets */
  size_t defects[SCREE_DEFECT_COUNT];
  bool intersections_known; /* the exact test was made; else the pairs above are 0 */
  bool too_many_pairs;      /* it found more than SCREE_PAIR_LIMIT and left off: of what kind they
                               are is not known, nor how shells lie; see scree_defect_is_counted */
  bool volume_known;        /* false: open or inside-out shells leave it unsaid, and so does a
                               check without the exact test */
  double volume;     /* where the winding number is positive: of the union of the shells, less
                                   the cavities, m^3 */
  bool usable;       /* as a particle: no grave defect was found */
  char verdict[512]; /* the same in one sentence, with the reasons */
} scree_check;

/* False where too many pairs leave the number of such a defect, which is then 0, unknown. */
SCREE_API bool scree_defect_is_counted(const scree_check *check, scree_defect defect);

typedef struct scree_check_options {
  /* Find all pairs of facets that cross, touch or overlap, exactly; default true. */
  bool intersections;
} scree_check_options;
SCREE_API scree_check_options scree_default_check_options(void);

/* Examines a mesh of any quality. Vertices are told apart by index: weld first. Shells are nested,
 * cavities or inside out by the winding number around them of the closed shells that they do not
 * meet, which is counted exactly; those that cross or touch count as beside each other. options and
 * progress may be NULL. Fails with SCREE_BAD_MESH where an index is out of range, SCREE_LIMIT above
 * 1,431,655,764 triangles, SCREE_CANCELLED, SCREE_OUT_OF_MEMORY; a mesh without facets is examined
 * and found unusable. Cost: see docs/reference/defects.md. */
SCREE_API scree_status scree_mesh_check(const scree_mesh *mesh, const scree_check_options *options,
                                        const scree_progress *progress, scree_check *check,
                                        scree_error *error);

/* What a repair does, in this order: X(NAME, "name in JSON", "what one is", "what several
 * are"). */
#define SCREE_REPAIR_LIST(X)                                                                       \
  X(CUT_OFF, "cut_off_facets", "facet below the plane cut off", "facets below the plane cut off")  \
  X(DROP_BAD, "dropped_bad_facets", "facet with coordinates that are no numbers dropped",          \
    "facets with coordinates that are no numbers dropped")                                         \
  X(WELD, "welded_vertices", "vertex united with another at its position",                         \
    "vertices at equal positions united")                                                          \
  X(DROP_DEGENERATE, "dropped_degenerate_facets", "facet without area dropped",                    \
    "facets without area dropped")                                                                 \
  X(DROP_DUPLICATE, "dropped_duplicate_facets", "duplicate facet dropped",                         \
    "duplicate facets dropped")                                                                    \
  X(CLOSE_SEAM, "closed_seam_edges", "boundary edge closed by welding within the tolerance",       \
    "boundary edges closed by welding within the tolerance")                                       \
  X(SPLIT_T_JUNCTION, "split_t_junctions", "edge split where a vertex lay on it",                  \
    "edges split where a vertex lay on them")                                                      \
  X(DROP_FIN, "dropped_fin_facets", "facet of an open sheet hanging on the surface dropped",       \
    "facets of open sheets hanging on the surface dropped")                                        \
  X(DROP_MEMBRANE, "dropped_membrane_facets", "facet of a sheet within the surface dropped",       \
    "facets of sheets within the surface dropped")                                                 \
  X(SPLIT_EDGE, "split_non_manifold_edges", "non-manifold edge split", "non-manifold edges split") \
  X(TURN, "turned_facets", "facet turned round to agree with its neighbours",                      \
    "facets turned round to agree with their neighbours")                                          \
  X(SPLIT_VERTEX, "split_non_manifold_vertices", "non-manifold vertex split",                      \
    "non-manifold vertices split")                                                                 \
  X(CUT_INTERSECTION, "cut_intersecting_facets",                                                   \
    "facet cut out where the surface met itself or had too sharp an edge",                         \
    "facets cut out where the surface met itself or had too sharp an edge")                        \
  X(BLUNT, "blunted_edges", "sharp edge made blunt by a strip of facets",                          \
    "sharp edges made blunt by strips of facets")                                                  \
  X(MERGE_SHELL, "merged_shells", "shell that met others united with them",                        \
    "shells that met others united with them")                                                     \
  X(FILL_HOLE, "filled_holes", "hole filled", "holes filled")                                      \
  X(FILL_FACET, "filling_facets", "facet added to fill a hole", "facets added to fill holes")      \
  X(SMOOTH_HOLE, "smooth_fillings", "large hole filled smoothly, with new vertices",               \
    "large holes filled smoothly, with new vertices")                                              \
  X(COARSE_HOLE, "coarse_fillings",                                                                \
    "large hole filled coarsely: smooth, it would meet the surface",                               \
    "large holes filled coarsely: smooth, they would meet the surface")                            \
  X(DROP_DEBRIS, "dropped_debris_shells", "debris shell dropped", "debris shells dropped")         \
  X(DROP_CAVITY, "dropped_cavities", "cavity dropped", "cavities dropped")                         \
  X(FILL_CAVITY, "filled_cavities", "small cavity filled", "small cavities filled")                \
  X(DROP_NESTED, "dropped_nested_shells", "shell inside the material of another dropped",          \
    "shells inside the material of another dropped")                                               \
  X(INVERT_SHELL, "inverted_shells", "shell turned outside out", "shells turned outside out")      \
  X(CUT_HANDLE, "cut_handles", "handle cut", "handles cut")

typedef enum scree_repair_action {
#define SCREE_REPAIR_ENUM(name, key, one, several) SCREE_REPAIR_##name,
  SCREE_REPAIR_LIST(SCREE_REPAIR_ENUM)
#undef SCREE_REPAIR_ENUM
      SCREE_REPAIR_ACTION_COUNT
} scree_repair_action;

SCREE_API const char *scree_repair_action_name(scree_repair_action action);
SCREE_API const char *scree_repair_action_text(scree_repair_action action, size_t count);

/* Whether what lies below a plane is cut off before all else, as a table that was scanned with the
 * body on it. */
typedef enum scree_cut_kind {
  SCREE_CUT_NONE,
  SCREE_CUT_AUTO, /* the plane that carries most of the boundary, and what reaches farther from it
                   */
  SCREE_CUT_GIVEN /* plane */
} scree_cut_kind;

/* normal . p = offset, m; kept is what lies in the direction of the normal, of unit length. */
typedef struct scree_cut_plane {
  double normal[3], offset;
} scree_cut_plane;

typedef struct scree_repair_options {
  /* Boundary vertices no farther apart than this share of the bounding box diagonal may become one
   * where that closes a seam, in [0, 0.01]; default 1e-4. The smallest distance that does is used,
   * never more than a quarter of a boundary edge there. */
  double seam_tolerance;
  /* Holes are filled whose filling is at most this share of the area then, in [0, 1], of up to
   * 16,384 edges; default 0.45, what is more is a sheet and no body; 0 fills none. A filling that
   * neither is a missing flat face nor follows the rim within 4 % of the body's size gets vertices
   * as dense as those round the hole, and goes on with its slope (Liepa, SGP 2003), unless the
   * surface would then meet itself. */
  double hole_share;
  /* Give no filling vertices of its own, as where flat faces with rough rims are missing; default
   * false. */
  bool flat_holes;
  /* Shells with less than this share of the area of the largest are debris, in [0, 1); default
   * 0.01. Cavities are none, nor are shells that are merged with what they meet. */
  double debris_share;
  /* Drop cavities too; default false. */
  bool drop_cavities;
  /* Keep only the shell of the largest area (and its cavities), after merging; default false. */
  bool keep_largest;
  /* Keep only this one of the bodies, by their areas, 1 the largest; default 0: all. */
  size_t keep_body;
  /* Cut facets that meet others of the same shell out and fill the hole; default true. */
  bool cut_intersections;
  /* Unite shells that cross, overlap or touch: what is kept is the surface of the space where the
   * winding number is positive, cut along the lines where they met; default true. Refused where
   * that number is negative somewhere. */
  bool merge_shells;
  /* Treat a shell that meets itself in the same way, instead of cutting the place out; space that
   * it winds round backwards is outside; default false. */
  bool merge_folds;
  /* Test for self-intersections exactly, before and after; default true. Without, the result may
   * have some. */
  bool intersections;
  /* Cavities are filled, the smallest first, as long as all of them together take no more than this
   * share of the volume, in [0, 1]: nothing ever touches them; default 1e-3. */
  double cavity_share;
  /* Refuse where cutting and merging change the volume by more than this share of it, in [0, 1];
   * default 0.01. Dropping debris and cavities is no such change. */
  double volume_change;
  /* Handles round which a loop of at most so many mean edges leads are cut there, and both ends
   * capped: slots that the scan's net has bridged, which cannot be decimated away. Default 6; 0
   * keeps all. */
  double handle_edges;
  /* Default none. Of what is left the largest shell is kept, and all holes are closed without new
   * vertices, so that the body is flat where it stood. */
  scree_cut_kind cut;
  scree_cut_plane plane;
} scree_repair_options;
SCREE_API scree_repair_options scree_default_repair_options(void);

typedef struct scree_repair_report {
  size_t done[SCREE_REPAIR_ACTION_COUNT];
  double seam_distance;           /* the distance within which seams were closed, m; 0: none were */
  double area_before, area_after; /* m^2 */
  /* m^3. Before: of the mesh given where its check knows it, else of the first closed surface that
   * came of it; NaN where none did. */
  double volume_before, volume_after;
  /* m^2, of fillings that are a hundredth of the area or more, or neither flat nor as the rim goes
   * on; the largest share of the area of a hole that was left open for that. */
  double guessed_area, refused_share;
  double filled_volume;                  /* of the small cavities, m^3 */
  double handle_length, handle_place[3]; /* of the longest loop along which a handle was cut, m */
  /* How far the surface given and the result lie from each other, the larger of both ways, m, and
   * where; measured where the area has changed by a thousandth, else 0. */
  double moved_mean, moved_most, moved_place[3];
  scree_cut_plane plane;     /* at which facets were cut off, with done[SCREE_REPAIR_CUT_OFF] */
  scree_check before, after; /* after: of the result, or of what the failed attempt came to */
} scree_repair_report;

/* Makes a closed, manifold, consistently wound, outward surface without self-intersections of a
 * mesh of any quality, or fails with SCREE_BAD_MESH and says what remains. Nothing is done to a
 * mesh that needs nothing, but vertices and triangles are put in canonical order (scree_mesh_weld),
 * so the result does not depend on the order of the facets. Where cutting a surface that meets
 * itself would change the volume or leave several bodies, merge_folds is tried too, and what keeps
 * the volume better is taken. repaired may be mesh itself: then one that needs nothing is not
 * copied, and what it held is freed where it is replaced; on failure it is as it was. options and
 * progress may be NULL; *report (may be NULL) is filled on success and on SCREE_BAD_MESH. Other
 * errors as scree_mesh_check. With a cut, before and volume_before are of the mesh as it came. */
SCREE_API scree_status scree_mesh_repair(const scree_mesh *mesh,
                                         const scree_repair_options *options,
                                         const scree_progress *progress, scree_mesh *repaired,
                                         scree_repair_report *report, scree_error *error);

/* Check first, repair when asked: what every verb that needs a particle's surface calls. *ready is
 * a copy of a mesh that passes the check, or its repair; it may be mesh itself, as there. options
 * NULL refuses instead of repairing: SCREE_BAD_MESH with the verdict. *report (may be NULL) as for
 * scree_mesh_repair; report->before.usable tells that nothing had to be done. */
SCREE_API scree_status scree_mesh_prepare(const scree_mesh *mesh,
                                          const scree_repair_options *options,
                                          const scree_progress *progress, scree_mesh *ready,
                                          scree_repair_report *report, scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
