/* Measures of a surface, its topology, and the distance between surfaces. */
#ifndef SCREE_MEASURE_H
#define SCREE_MEASURE_H

#include "scree/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Measures ---- */

/* Sizes and mass properties of a surface, as exact integrals over its polyhedron
 * (docs/background/method.md, "Measures"). Unit density: an inertia in m^5 times a density in
 * kg/m^3 is one in kg m^2.
 *
 * Where `closed` is false the surface bounds no volume: volume, centroid, inertia and what follows
 * from them are those of the surface with every hole closed by a cone to the centre of the bounding
 * box, a stand-in to be shown with a warning. Where `inward` is true the facets are wound clockwise
 * from outside: the volume is negative, everything else as if they were turned round. Where
 * `has_volume` is false the volume is 0 but for rounding, as of a flat sheet or one folded on
 * itself: centroid, inertia and what follows from them do not exist; the moments and shares are 0,
 * the centroid is the middle of the bounding box. */
typedef struct scree_measures {
  bool closed;                   /* every edge is used equally often in both directions */
  bool inward;                   /* volume < 0, beyond rounding */
  bool has_volume;               /* it is more than rounding */
  double area;                   /* S, m^2 */
  double volume;                 /* V, m^3, signed */
  double centroid[3];            /* of the volume, m */
  double inertia[3][3];          /* about the centroid, in the file's axes, m^5 */
  double principal_moments[3];   /* ascending, m^5 */
  double principal_axes[3][3];   /* row i belongs to moment i; orthonormal, right-handed */
  double equivalent_diameter;    /* of the sphere of the same volume, (6 |V| / pi)^(1/3), m */
  double sphericity;             /* Wadell: area of that sphere / S, in (0, 1] */
  double box_min[3], box_max[3]; /* axis-aligned bounding box, m */
  double dimensions[3];          /* its sides along x, y, z, m */
  double oriented_dimensions[3]; /* sides of the least-volume box found, descending, m */
  double oriented_axes[3][3];    /* row i is the direction of side i; orthonormal, right-handed */
  double oriented_center[3];     /* m */
  double hull_area, hull_volume; /* of the convex hull, m^2, m^3 */
  double convexity;              /* |V| / hull volume, in (0, 1] for a simple closed surface */
} scree_measures;

/* Measures a mesh of any quality. Fails with SCREE_BAD_MESH where it has no triangle, an index is
 * out of range or a coordinate is not finite. Cost: O(N) and the convex hull (about 0.5 s for a
 * million facets of a scan; longest where most vertices lie on the hull, and quadratic in the
 * vertices of the hull that lie in one plane: a cylinder of 64,000 facets takes half a minute);
 * qhull's own memory does not come from scree_set_allocator. Relative error about 1e-14 wherever
 * the mesh lies, beyond what the rounding of its coordinates costs. */
SCREE_API scree_status scree_mesh_measure(const scree_mesh *mesh, scree_measures *measures,
                                          scree_error *error);

/* Area and volume alone, in one pass (about 10 ms for 762,008 triangles). The volume is about the
 * centre of the bounding box, see scree_measures. Either pointer may be NULL. */
SCREE_API scree_status scree_mesh_area_volume(const scree_mesh *mesh, double *area, double *volume,
                                              scree_error *error);

/* Zingg's classes (1935): which of elongation and flatness are above 2/3. */
typedef enum scree_zingg { SCREE_EQUANT, SCREE_OBLATE, SCREE_PROLATE, SCREE_BLADED } scree_zingg;
/* equant, oblate, prolate or bladed. */
SCREE_API const char *scree_zingg_name(scree_zingg zingg);

/* What people report of the shape of grains. L >= I >= S are the sides of the least-volume box
 * found. Curvatures are those of the polyhedron, so roundness and angularity follow its resolution
 * and a scan's noise: compare bodies at like triangle counts, fine
 * beside the radii of their edges (of a box of 12 triangles they say nothing). */
typedef struct scree_descriptors {
  double elongation;          /* I / L */
  double flatness;            /* S / I */
  scree_zingg zingg;          /* */
  double krumbein_sphericity; /* (S I / L^2)^(1/3), Krumbein 1941 */
  double roundness;           /* Wadell 1932 in 3D: over all surface that is more curved than the
                                 inscribed sphere, mean of radius of curvature / its radius; 1: a
                                 sphere, 0: sharp edges only */
  double angularity; /* Willmore energy, integral of the squared mean curvature, / 4 pi; 1: a
                        sphere, larger: angular */
  double inscribed_radius, inscribed_centre[3]; /* m, the largest sphere inside */
  double bounding_radius, bounding_centre[3];   /* m, the smallest sphere around */
} scree_descriptors;

/* Describes a closed, outward mesh with what scree_mesh_measure says of it. Fails with
 * SCREE_BAD_MESH for any other. Cost: a search tree, and for the inscribed sphere some hundred
 * searches and sums over all triangles (about 2 s for 762,008). */
SCREE_API scree_status scree_mesh_describe(const scree_mesh *mesh, const scree_measures *measures,
                                           scree_descriptors *descriptors, scree_error *error);

/* How the facets hang together. A facet that names a vertex twice has no place in the surface: it
 * counts as degenerate and nowhere else. */
typedef struct scree_topology {
  size_t vertex_count;              /* used by a facet */
  size_t unused_vertex_count;       /* not used by any */
  size_t edge_count;                /* undirected */
  size_t facet_count;               /* those that take part: all but those naming a vertex twice */
  size_t shell_count;               /* sets of facets connected through shared edges */
  size_t inward_shell_count;        /* wound alike, with volume below 0: cavities or inside out */
  size_t boundary_edge_count;       /* edges of one facet */
  size_t boundary_count;            /* connected sets of boundary edges: holes and rims */
  size_t non_manifold_edge_count;   /* edges of three or more facets */
  size_t non_manifold_vertex_count; /* vertices whose facets form more than one fan */
  size_t inconsistent_edge_count;   /* edges of two facets that run along them the same way */
  size_t degenerate_facet_count;    /* a vertex twice, or flatter than its coordinates' rounding */
  size_t duplicate_facet_count;     /* facets with the same three vertices as another, less one */
  long long euler_characteristic;   /* vertices - edges + facets */
  long long genus;                  /* handles of all shells together; -1 unless a closed,
                                       manifold, oriented surface has one */
  bool closed;                      /* no boundary edge */
  bool manifold;                    /* no non-manifold edge or vertex */
  bool oriented;                    /* no inconsistent edge, and at every edge of an even number of
                                       facets half run either way */
} scree_topology;

/* Counts all that in O(N) (about 100 ms for 762,008 triangles on one core). Vertices are told apart
 * by index: weld first. Fails as scree_mesh_measure does, but accepts a mesh without facets; and
 * with SCREE_LIMIT above 1,431,655,764 triangles. */
SCREE_API scree_status scree_mesh_topology(const scree_mesh *mesh, scree_topology *topology,
                                           scree_error *error);

/* ---- Distance between surfaces ---- */

/* How far the points of one surface lie from another. */
typedef struct scree_deviation {
  double mean, rms;     /* over the area of the surface, m */
  double maximum;       /* the largest distance found at a sample or vertex, m: a lower bound */
  double maximum_bound; /* no point of the surface is farther than this, m */
  double at[3];         /* the point where `maximum` was found, m */
  size_t sample_count;  /* points at which the distance was taken */
} scree_deviation;

typedef struct scree_distance {
  scree_deviation forward;  /* from every point of a to the nearest of b */
  scree_deviation backward; /* from b to a; zero where one way was asked */
  double hausdorff;         /* the larger maximum of the ways asked, m */
  double hausdorff_bound;   /* the true Hausdorff distance is not above this, m */
} scree_distance;

typedef struct scree_distance_options {
  size_t sample_count;  /* parts that each surface is cut in, in proportion to area; every facet is
                           at least one, and middles, corners and edges of the parts are sampled. 0,
                           the default: the greater vertex count of the two, at least 10,000, then
                           four times as many as often as mean or rms change by more than 0.5 per
                           cent, so that they are exact to 1 per cent. */
  double hausdorff_gap; /* facets are subdivided until maximum_bound is within this fraction of
                           maximum, at least 1e-6, or effort is spent (four million samples and
                           32 per facet); default 0.01. 0 takes the bound without subdividing, at no
                           cost. */
  bool one_way;         /* only forward; default false */
} scree_distance_options;
SCREE_API scree_distance_options scree_default_distance_options(void);

/* Mean, root-mean-square and Hausdorff distance between two surfaces, both ways: what Metro
 * measures (Cignoni, Rocchini, Scopigno 1998), with a certified bound. Deterministic: samples lie
 * on regular subdivisions of the facets, nothing is drawn at random. Fails with SCREE_BAD_MESH as
 * scree_mesh_measure does, SCREE_BAD_ARGUMENT, SCREE_LIMIT (more than 2^28 samples of a surface),
 * SCREE_CANCELLED. Cost: a search tree of each (about 0.1 kB and 0.5 us of one core per facet) and
 * about 1 us per sample. */
SCREE_API scree_status scree_mesh_distance(const scree_mesh *a, const scree_mesh *b,
                                           const scree_distance_options *options,
                                           const scree_progress *progress, scree_distance *distance,
                                           scree_error *error);

/* A surface made ready for many distance queries: a copy of the mesh in a search tree. Constant
 * once made; any number of threads may use it. */
typedef struct scree_surface scree_surface;
SCREE_API scree_status scree_surface_create(const scree_mesh *mesh, scree_surface **surface,
                                            scree_error *error);
SCREE_API void scree_surface_free(scree_surface *surface);

/* scree_mesh_distance between surfaces made ready. */
SCREE_API scree_status scree_surface_distance(const scree_surface *a, const scree_surface *b,
                                              const scree_distance_options *options,
                                              const scree_progress *progress,
                                              scree_distance *distance, scree_error *error);

/* The distance of each of point_count points (3 doubles each, m) from the surface. */
SCREE_API void scree_surface_distances(const scree_surface *surface, const double *points,
                                       size_t point_count, double *distances);

/* The same, negative inside, of a closed, outward surface. Cost: with three rays a point. */
SCREE_API void scree_surface_signed_distances(const scree_surface *surface, const double *points,
                                              size_t point_count, double *distances);

/* The distance of every vertex of the mesh from the surface of the reference; distances holds
 * vertex_count values, m. What a colour map shows. */
SCREE_API scree_status scree_mesh_distance_field(const scree_mesh *mesh,
                                                 const scree_mesh *reference, double *distances,
                                                 scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
