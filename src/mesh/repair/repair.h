/* The stages of a repair, in the order of scree_repair_action; each works on one mesh in place,
 * counts what it does, and leaves a mesh of valid indices and finite coordinates. The public
 * interface is in scree/check.h; repair.c tells the whole. */
#pragma once

#include "base/error.h"
#include "base/vec.h"
#include "mesh/adjacency.h"
#include "mesh/index/intersect.h"
#include "mesh/mesh.h"
#include "mesh/repair/searched.h"
#include "mesh/repair/shells.h"

typedef struct scree_repair {
  scree_mesh mesh; /* owned */
  size_t vertex_capacity, triangle_capacity;
  scree_searched searched;
  size_t came_in; /* triangles, when the rounds began */
  const scree_repair_options *options;
  const scree_progress *progress;
  double diagonal;      /* of the bounding box, m */
  double largest;       /* coordinate, m */
  bool untangled;       /* the surface is known to meet itself nowhere */
  bool apart;           /* shells that meet will not be merged any more: each is judged alone */
  double volume;        /* of the first closed surface, before it was cut or merged, m^3; or NaN */
  const char *unmerged; /* why shells were not merged, as the end of a sentence; NULL: no reason */
  scree_repair_report report;
} scree_repair;

/* ---- repair_edit.c: changes to the mesh ---- */

/* The mesh takes the place of the one under repair, which is freed. */
void scree_repair_take(scree_repair *r, scree_mesh *mesh);
/* Room for more; false when memory is out. */
bool scree_repair_add_vertex(scree_repair *r, const double *position, uint32_t *index);
bool scree_repair_add_facet(scree_repair *r, uint32_t a, uint32_t b, uint32_t c);
bool scree_repair_reserve(scree_repair *r, size_t more_facets);
/* Removes the facets marked; returns how many. */
size_t scree_facets_drop(scree_mesh *mesh, const bool *marked);
/* Those on the same three vertices as one before them. */
scree_status scree_facets_drop_doubles(scree_mesh *mesh, size_t *dropped, scree_error *error);
/* Refuses a mesh of so many triangles where that is far more than came in: facets at angles beyond
 * rounding can be split at each other for ever, 42 became 84,057 in three rounds. */
scree_status scree_repair_growth(const scree_repair *r, size_t triangle_count, scree_error *error);
/* The sentence for a stage that ran out of memory. */
scree_status scree_repair_no_memory(scree_error *error);

/* ---- repair_manifold.c: facets round an edge ---- */

enum { SCREE_EDGE_FACETS = 64 }; /* more at one edge are not sorted out */

typedef struct scree_spoke {
  uint32_t half_edge;
  double angle; /* counter-clockwise about the edge from its lower to its higher vertex */
  bool along;   /* runs that way */
} scree_spoke;

/* The `count` facets round the edge of half-edge first, by angle; false where they do not run half
 * and half either way. A facet running along has its outer side towards larger angles. */
bool scree_repair_spokes(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t first,
                         scree_spoke *spokes, int count);

/* ---- The stages ---- */

/* repair_plane.c: what lies above the plane given, or above the one found (NULL), which goes to
 * *plane. SCREE_BAD_MESH where none is found, or where all lies on one side. */
scree_status scree_repair_cut_off(const scree_mesh *mesh, const scree_cut_plane *given,
                                  scree_cut_plane *plane, size_t *dropped, scree_mesh *above,
                                  scree_error *error);

/* repair.c: facets on the same three vertices as another. */
scree_status scree_repair_duplicates(scree_repair *r, scree_error *error);
/* repair_seams.c: facets without area; boundary vertices close to each other; boundary vertices on
 * boundary edges. */
scree_status scree_repair_flat(scree_repair *r, scree_error *error);
scree_status scree_repair_seams(scree_repair *r, scree_error *error);
scree_status scree_repair_t_junctions(scree_repair *r, scree_error *error);
/* repair_manifold.c: open sheets hanging on edges of three or more facets; such edges; winding;
 * vertices with several fans. */
scree_status scree_repair_fins(scree_repair *r, scree_error *error);
/* repair_membrane.c: sheets within the outside surface, where edges have 3, 5, ... facets. */
scree_status scree_repair_membranes(scree_repair *r, scree_error *error);
scree_status scree_repair_edges(scree_repair *r, scree_error *error);
scree_status scree_repair_winding(scree_repair *r, scree_error *error);
scree_status scree_repair_vertices(scree_repair *r, scree_error *error);
/* repair_holes.c; own: those that the repair has cut itself */
scree_status scree_repair_holes(scree_repair *r, bool own, scree_error *error);

/* A hole and its filling, the mesh's facets from first_facet on, of the hole's vertices alone. */
typedef struct scree_filling {
  const scree_adjacency *adjacency; /* of the mesh before any hole was filled */
  const uint32_t *vertex;           /* along the hole as the filling runs */
  const uint32_t *half_edge;        /* i: the mesh's, from vertex[i + 1] to vertex[i] */
  size_t count, first_facet;
} scree_filling;

/* Whether the mesh of the adjacency has an edge between two vertices. */
bool scree_repair_edge_exists(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t a,
                              uint32_t b);
/* repair_fair.c: gives a filling vertices as dense as round it, and lets the surface go on
 * smoothly; false where the filling needs no vertices, or the surface does not come out. */
scree_status scree_repair_fair(scree_repair *r, const scree_filling *filling, bool *faired,
                               scree_error *error);

/* repair_shells.c: open debris; then closed debris, nesting and outside. */
scree_status scree_repair_scraps(scree_repair *r, scree_error *error);
scree_status scree_repair_shells(scree_repair *r, scree_error *error);
/* The part of it that turns closed shells outside out. */
scree_status scree_repair_outward(scree_repair *r, scree_error *error);
/* Cuts out facets that meet others of their shell or have a sharp edge, with `rings` rings of
 * neighbours; *cut_count 0 where nothing could be cut, *clear where there are none of any shell. */
scree_status scree_repair_cut(scree_repair *r, int rings, size_t *cut_count, bool *clear,
                              scree_error *error);
/* blunt.c: parts the sides of sharp edges, where these form rims; *blunted: how many. */
scree_status scree_repair_blunt(scree_repair *r, size_t *blunted, scree_error *error);
/* repair_merge.c: shells that meet become one surface, where every edge is used equally often both
 * ways; *merged is false, and r->unmerged may tell why, where they do not. `early`, before other
 * stages: not where a shell only meets itself, unless the options say so. */
scree_status scree_repair_merge(scree_repair *r, bool early, bool *merged, scree_error *error);

/* Handles that are no wider than what a scan can tell: slots that its net has bridged, and holes
 * that it has made. They cannot be decimated away. */
typedef struct scree_handles {
  size_t count;
  double length, place[3]; /* of the longest loop that was cut, m */
} scree_handles;

/* Cuts loops of a closed manifold surface along which it does not fall apart, of at most so many
 * mean edges and a tenth of the body's size, and caps both rims. What touches no other is cut at
 * once: call again until nothing is. *cut is to be put in canonical order; *told adds up. O(N) and
 * the searches round the handles. */
scree_status scree_handles_cut(const scree_mesh *mesh, double edges, scree_mesh *cut,
                               scree_handles *told, scree_error *error);

/* ---- sharp.c: edges too sharp for contact, for check, repair and particles ---- */

/* Whether neighbours with these normals, of any lengths, make an angle of less than
 * SCREE_LEAST_EDGE_DEG, in material or outside; false where one has no area. */
bool scree_normals_are_sharp(vec3 a, vec3 b);
/* Whether the facets of half-edges h and its only twin do; false where they are wound unlike. */
bool scree_edge_is_sharp(const scree_mesh *mesh, const scree_adjacency *adjacency, uint32_t h);
/* The number of such edges; marked (may be NULL) gets true for their facets. */
size_t scree_sharp_edges(const scree_mesh *mesh, const scree_adjacency *adjacency, bool *marked);

/* ---- check.c: shared by check and repair; the interface is in scree/check.h ---- */

/* A coordinate is not finite, or beyond what exact predicates bear. */
bool scree_vertex_is_bad(const double *position);

bool scree_defect_is_grave(scree_defect defect);

/* scree_mesh_check of a mesh that is being mended: facets that meet are sought by what is known,
 * which learns of it. */
scree_status scree_check_searched(const scree_mesh *mesh, const scree_check_options *options,
                                  scree_searched *searched, const scree_progress *progress,
                                  scree_check *check, scree_error *error);
