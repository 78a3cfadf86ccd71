/* scree: triangle counts for DEM particles from 3D scans, chosen by a criterion, tested by
 * simulation.
 *
 * This is the whole public interface. What holds everywhere:
 *
 *   Units       SI inside: metres, kilograms, seconds, radians. A value in another unit says so in
 * its name (angle_deg). Errors      A fallible call returns a scree_status. Its last parameter is a
 * scree_error, which may be NULL, filled with one sentence on failure. Outputs are untouched on
 * failure. Ownership   Inputs are borrowed. Whoever gets a `T **` or a filled struct frees it with
 * T_free; freeing NULL or a zeroed struct is legal. Threads     No global state but the allocator,
 * the memory limit and the number of threads. Results are the same bits for every number of
 * threads. Output      The library never prints, exits, aborts or longjmps. */
#ifndef SCREE_H
#define SCREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SCREE_API __attribute__((visibility("default")))

/* ==== 1. Version, errors, memory, threads, progress ============================================
 */

/* The version as text, for example "0.1.0". */
SCREE_API const char *scree_version(void);

#define SCREE_STATUS_LIST(X)                                                                       \
  X(OK, "ok")                                                                                      \
  X(BAD_ARGUMENT, "bad argument")   /* the caller passed a value outside its range */              \
  X(BAD_FILE, "bad file")           /* a file's content is not what it claims to be */             \
  X(BAD_MESH, "bad mesh")           /* a surface that cannot serve the purpose */                  \
  X(IO, "input/output error")       /* the system refused to open, read or write */                \
  X(OUT_OF_MEMORY, "out of memory") /* or above the memory limit */                                \
  X(LIMIT, "limit exceeded")        /* a stated limit of scree, not of memory */                   \
  X(CANCELLED, "cancelled")         /* a progress callback answered false */                       \
  X(EXISTS, "file exists")          /* nothing is overwritten unless asked */                      \
  X(UNSUPPORTED, "unsupported")     /* known, but not in this build or not yet */                  \
  X(NO_BACKEND, "no such backend")  /* the compute backend is not in this build */                 \
  X(DIVERGED, "diverged")           /* a simulation left the range of its model */

typedef enum scree_status {
#define SCREE_STATUS_ENUM(name, text) SCREE_##name,
  SCREE_STATUS_LIST(SCREE_STATUS_ENUM)
#undef SCREE_STATUS_ENUM
      SCREE_STATUS_COUNT
} scree_status;

/* The status in words, for example "bad file". */
SCREE_API const char *scree_status_text(scree_status status);

/* What went wrong, in one sentence: file, position, value, limit as far as they apply. */
typedef struct scree_error {
  scree_status status;
  char message[1024];
} scree_error;

/* All memory comes from one function: block NULL allocates, size 0 frees, else resizes; NULL means
 * it failed. It must be thread-safe. NULL restores realloc and free. Set it before any other call.
 */
typedef void *scree_reallocate(void *context, void *block, size_t size);
SCREE_API void scree_set_allocator(scree_reallocate *reallocate, void *context);

/* The most bytes the library may hold at once; further allocations fail with SCREE_OUT_OF_MEMORY.
 * 0 (the default) means no limit. */
SCREE_API void scree_set_memory_limit(size_t byte_count);
/* Bytes held now, and the most held since the start or the last reset of the peak. */
SCREE_API size_t scree_memory_used(void);
SCREE_API size_t scree_memory_peak(void);
SCREE_API void scree_reset_memory_peak(void);

/* How many threads parallel work uses; 0 (the default) means one per processor. The result of no
 * function depends on it. */
SCREE_API void scree_set_threads(int thread_count);
SCREE_API int scree_threads(void);

/* Progress of long work. report is called from the calling thread, with the phase in a few words
 * and the fraction done in [0, 1]; answering false cancels the work, which then returns
 * SCREE_CANCELLED. interval is the least time between two reports, in seconds; the first and the
 * last come always, and with 0 each one does. */
typedef struct scree_progress {
  bool (*report)(void *context, const char *phase, double fraction);
  void *context;
  double interval;
} scree_progress;

/* Creates the folder and its parents; an existing folder is fine. */
SCREE_API scree_status scree_folder_create(const char *path, scree_error *error);

/* 128 bits that name a file's content: XXH3-128, as `xxhsum -H2` prints it. */
typedef struct scree_checksum {
  uint64_t high, low;
} scree_checksum;

enum { SCREE_CHECKSUM_TEXT = 33 }; /* characters with the final zero */

/* Puts the 32 hexadecimal digits into text. Returns text; NULL for a checksum of zero, which stands
 * for none (a sample has no bytes). */
SCREE_API const char *scree_checksum_text(scree_checksum checksum, char text[SCREE_CHECKSUM_TEXT]);

/* ==== 2. Meshes and scans ======================================================================
 */

/* An indexed triangle mesh. Triangle t has corners triangles[3t..3t+2]; vertex v lies at
 * positions[3v..3v+2], in metres. Counter-clockwise from outside. */
typedef struct scree_mesh {
  double *positions;   /* 3 * vertex_count */
  uint32_t *triangles; /* 3 * triangle_count */
  size_t vertex_count;
  size_t triangle_count;
} scree_mesh;

SCREE_API void scree_mesh_free(scree_mesh *mesh);
SCREE_API scree_status scree_mesh_copy(const scree_mesh *mesh, scree_mesh *copy,
                                       scree_error *error);

/* ---- 2.1 Reading and writing ---- */

/* How a scan is read. Most files carry no unit: it is stated here, never guessed. */
typedef struct scree_read_options {
  /* Metres per unit of the file, in [1e-12, 1e12]; default 1e-3 (millimetres, as scanners write).
   * 3MF and glTF state their own unit, and this one is not used. */
  double unit_m;
  /* Vertices closer than this share of the bounding box diagonal become one: 0 (the default: only
   * equal positions) or in [1e-12, 0.1]. See scree_mesh_weld. */
  double weld_tolerance;
  /* The most bytes read from a file or stream; default 0: only memory limits. */
  size_t max_bytes;
} scree_read_options;

SCREE_API scree_read_options scree_default_read_options(void);

/* A scan: its welded surface and what the file said. */
typedef struct scree_scan {
  scree_mesh mesh;         /* metres; vertices and triangles in canonical order (scree_mesh_weld) */
  scree_checksum checksum; /* of the file's bytes */
  size_t byte_count;
  char format[32];         /* for example "STL binary", "3MF, inch" (with the unit it states) */
  size_t facet_count;      /* triangles in the file; a polygon counts as its triangles */
  size_t degenerate_count; /* of these, dropped because two corners coincide */
  size_t solid_count;      /* `solid`s of an ASCII STL; else 1 */
  size_t
      ignored_byte_count; /* bytes after the last facet of a binary STL, fewer than a facet has */
} scree_scan;

SCREE_API void scree_scan_free(scree_scan *scan);

/* Reads and welds a scan. path "-" is standard input. The format is found by content, not by name:
 * STL (binary, also with colours or a header that begins with `solid`; ASCII), PLY (ASCII, both
 * byte orders, polygons, triangle strips), OBJ (polygons, v/vt/vn, negative indices), OFF (also
 * with colours, normals, texture coordinates); in a build with assimp also 3MF, glTF (binary; text
 * with embedded data), COLLADA, X3D, AMF, FBX and 3DS, imported in a child process with limits on
 * memory and time (docs/formats.md). options NULL means the defaults.
 *
 * Sizes in the file are believed only where its length allows them, so memory stays within a fixed
 * multiple of the file's length (of its triangles for 3MF and glTF). Errors: SCREE_IO, also where
 * no child process can be made; SCREE_LIMIT above max_bytes or 2^32 - 2 vertices, or above a limit
 * of the child; SCREE_UNSUPPORTED for a format known but not read; SCREE_BAD_FILE with the line or
 * byte, the value and the limit; SCREE_BAD_MESH where every facet is degenerate;
 * SCREE_OUT_OF_MEMORY. Free *scan with scree_scan_free. */
SCREE_API scree_status scree_scan_read(const char *path, const scree_read_options *options,
                                       scree_scan *scan, scree_error *error);
/* The same for byte_count bytes in memory; name stands for the file in errors. */
SCREE_API scree_status scree_scan_parse(const void *bytes, size_t byte_count, const char *name,
                                        const scree_read_options *options, scree_scan *scan,
                                        scree_error *error);

/* Makes an indexed mesh of loose triangles: triangle t has its corners at corner_positions[9t ..
 * 9t+8], finite and at most 1e30 in size, in metres.
 *
 * The order is canonical, so that every order of the same facets, and every start corner, gives the
 * same bits: vertices are sorted by x, then y, then z; each triangle starts at its smallest index,
 * winding kept; triangles are sorted by their three indices. -0 counts as 0. Triangles of which two
 * corners coincide are dropped and counted in *degenerate_count (may be NULL); vertices without a
 * triangle are dropped. Duplicate triangles stay.
 *
 * tolerance > 0 also unites all vertices that are linked by steps no longer than tolerance times
 * the bounding box diagonal; the first of each group, in canonical order, gives the position. The
 * result welded again with the same distance is itself.
 *
 * Errors: SCREE_BAD_ARGUMENT for a coordinate or tolerance out of range; SCREE_LIMIT above 2^32 - 2
 * vertices or 1.4e9 triangles, or where the tolerance joins so many pairs that the work would not
 * end; SCREE_OUT_OF_MEMORY. Cost: linear in practice, n log n at worst. A mesh without triangles is
 * a valid result. */
SCREE_API scree_status scree_mesh_weld(const double *corner_positions, size_t facet_count,
                                       double tolerance, scree_mesh *mesh, size_t *degenerate_count,
                                       scree_error *error);

/* Formats that are written. */
typedef enum scree_file_format {
  SCREE_FORMAT_AUTO,      /* by the path's extension: .stl .ply .obj .off .3mf */
  SCREE_FORMAT_STL,       /* "stl": binary; positions rounded to 24 bits */
  SCREE_FORMAT_STL_ASCII, /* "stl-ascii" */
  SCREE_FORMAT_PLY,       /* "ply": binary little endian, double */
  SCREE_FORMAT_PLY_FLOAT, /* "ply-float": binary little endian, positions rounded to 24 bits */
  SCREE_FORMAT_OBJ,       /* "obj" */
  SCREE_FORMAT_OFF,       /* "off" */
  SCREE_FORMAT_3MF,       /* "3mf": not compressed; says its unit, metre where 3MF has no such unit */
  SCREE_FILE_FORMAT_COUNT,
} scree_file_format;

/* The format's name as in the comments above ("auto" for SCREE_FORMAT_AUTO). */
SCREE_API const char *scree_file_format_name(scree_file_format format);
/* The format that a path's extension asks for, in any case of letters; SCREE_FORMAT_AUTO: none. */
SCREE_API scree_file_format scree_file_format_of(const char *path);

typedef struct scree_write_options {
  scree_file_format format; /* default SCREE_FORMAT_AUTO */
  double unit_m;            /* metres per unit of the file, in [1e-12, 1e12]; default 1e-3 */
  bool overwrite;           /* default false: an existing file is refused */
  /* One line of provenance, put after scree's version where the format has comments (PLY, OBJ, OFF,
   * 3MF; its first 40 bytes in the header of a binary STL); NULL for none. Borrowed. */
  const char *comment;
} scree_write_options;

SCREE_API scree_write_options scree_default_write_options(void);

/* Writes the mesh; path "-" is standard output (then format must not be AUTO). The file appears
 * whole or not at all. Formats with text or double carry every bit of position / unit_m. options
 * NULL means the defaults. Errors: SCREE_BAD_ARGUMENT for an unknown extension or an index or
 * coordinate out of range, SCREE_EXISTS, SCREE_IO, SCREE_LIMIT where the format cannot hold the
 * count. */
SCREE_API scree_status scree_mesh_write(const scree_mesh *mesh, const char *path,
                                        const scree_write_options *options, scree_error *error);

/* ---- 2.2 Measures ---- */

/* Sizes and mass properties of a surface, as exact integrals over its polyhedron (docs/method.md,
 * "Measures"). Unit density: an inertia in m^5 times a density in kg/m^3 is one in kg m^2.
 *
 * Where `closed` is false the surface bounds no volume: volume, centroid, inertia and what follows
 * from them are those of the surface with every hole closed by a cone to the centre of the bounding
 * box, a stand-in to be shown with a warning. Where `inward` is true the facets are wound clockwise
 * from outside: the volume is negative, everything else as if they were turned round. Values that
 * do not exist (the convexity of a flat sheet) are 0. */
typedef struct scree_measures {
  bool closed;                   /* every edge is used equally often in both directions */
  bool inward;                   /* volume < 0 */
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
 * million facets of a scan; longest where most vertices lie on the hull); qhull's own memory does
 * not come from scree_set_allocator. Relative error about 1e-14 wherever the mesh lies, beyond what
 * the rounding of its coordinates costs. */
SCREE_API scree_status scree_mesh_measure(const scree_mesh *mesh, scree_measures *measures,
                                          scree_error *error);

/* Area and volume alone, in one pass (about 10 ms for 762,008 triangles). The volume is about the
 * centre of the bounding box, see scree_measures. Either pointer may be NULL. */
SCREE_API scree_status scree_mesh_area_volume(const scree_mesh *mesh, double *area, double *volume,
                                              scree_error *error);

/* How the facets hang together. A facet that names a vertex twice has no place in the surface: it
 * counts as degenerate and nowhere else. */
typedef struct scree_topology {
  size_t vertex_count;              /* used by a facet */
  size_t unused_vertex_count;       /* not used by any */
  size_t edge_count;                /* undirected */
  size_t facet_count;               /* those that take part: all but those naming a vertex twice */
  size_t shell_count;               /* sets of facets connected through shared edges */
  size_t inward_shell_count;        /* closed shells of negative volume: cavities, or inside out */
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

/* ---- 2.3 Distance between surfaces ---- */

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
  size_t sample_count;  /* points to spread over each surface in proportion to area, as Metro does;
                           every facet gets one and every vertex is one besides. 0, the default:
                           the greater vertex count of the two, at
                            least 10,000. */
  double hausdorff_gap; /* facets are subdivided until maximum_bound is within this fraction of
                           maximum, at least 1e-6, or effort is spent (four million samples and
                           32 per facet); 0, the default, takes the bound without subdividing, at no
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

/* The distance of every vertex of the mesh from the surface of the reference; distances holds
 * vertex_count values, m. What a colour map shows. */
SCREE_API scree_status scree_mesh_distance_field(const scree_mesh *mesh,
                                                 const scree_mesh *reference, double *distances,
                                                 scree_error *error);

/* ---- 2.4 Check and repair ---- */

/* What can be wrong with a surface: X(NAME, "name in JSON", grave, "what it counts"). A surface
 * with a grave one cannot serve as a particle; the others are worth knowing. */
#define SCREE_DEFECT_LIST(X)                                                                       \
  X(BAD_COORDINATE, "bad_coordinates", true, "vertices that are not finite, or beyond 1e30 m")     \
  X(DEGENERATE_FACET, "degenerate_facets", true, "facets without area")                            \
  X(DUPLICATE_FACET, "duplicate_facets", true, "facets on the same three vertices as another")     \
  X(BOUNDARY_EDGE, "boundary_edges", true, "edges of one facet only: the surface is open")         \
  X(HOLE, "holes", true, "connected sets of boundary edges")                                       \
  X(NON_MANIFOLD_EDGE, "non_manifold_edges", true, "edges of three or more facets")                \
  X(NON_MANIFOLD_VERTEX, "non_manifold_vertices", true, "vertices where separate fans meet")       \
  X(INCONSISTENT_EDGE, "inconsistent_edges", true, "edges whose two facets are wound unlike")      \
  X(INSIDE_OUT_SHELL, "inside_out_shells", true, "closed shells wound clockwise from outside")     \
  X(CROSSING_PAIR, "crossing_pairs", true, "pairs of facets that pass through each other")         \
  X(TOUCHING_PAIR, "touching_pairs", true, "pairs of facets that touch beyond shared edges")       \
  X(OVERLAPPING_PAIR, "overlapping_pairs", true, "pairs of coplanar facets with a common area")    \
  X(OVERLAPPING_SHELLS, "overlapping_shell_pairs", true, "pairs of shells that cross or touch")    \
  X(NESTED_SHELL, "nested_shells", true, "outward shells inside the material of another")          \
  X(CAVITY, "cavities", false, "inward shells inside the material of another")                     \
  X(EXTRA_BODY, "extra_bodies", false, "closed outward shells in empty space, beyond the first")   \
  X(UNUSED_VERTEX, "unused_vertices", false, "vertices of no facet")

typedef enum scree_defect {
#define SCREE_DEFECT_ENUM(name, key, grave, text) SCREE_DEFECT_##name,
  SCREE_DEFECT_LIST(SCREE_DEFECT_ENUM)
#undef SCREE_DEFECT_ENUM
      SCREE_DEFECT_COUNT
} scree_defect;

/* The name in JSON, what is counted in words, and whether it is grave. */
SCREE_API const char *scree_defect_name(scree_defect defect);
SCREE_API const char *scree_defect_text(scree_defect defect);
SCREE_API bool scree_defect_is_grave(scree_defect defect);

typedef struct scree_check {
  size_t triangle_count, vertex_count;
  size_t shell_count; /* sets of facets connected through shared edges */
  size_t defects[SCREE_DEFECT_COUNT];
  bool intersections_known; /* the exact test was made; else the pairs above are 0 */
  bool volume_known;        /* false: open or inside-out shells leave it unsaid, and so does a
                               check without the exact test */
  double volume;     /* where the winding number is positive: of the union of the shells, less
                                   the cavities, m^3 */
  bool usable;       /* as a particle: no grave defect was found */
  char verdict[512]; /* the same in one sentence, with the reasons */
} scree_check;

typedef struct scree_check_options {
  /* Find all pairs of facets that cross, touch or overlap, exactly; default true. */
  bool intersections;
} scree_check_options;
SCREE_API scree_check_options scree_default_check_options(void);

/* Examines a mesh of any quality. Vertices are told apart by index: weld first. Shells are nested,
 * cavities or inside out by the winding number around them, which is counted exactly where shells
 * are closed. options and progress may be NULL. Fails with SCREE_BAD_MESH where an index is out of
 * range, SCREE_LIMIT above 1,431,655,764 triangles, SCREE_CANCELLED, SCREE_OUT_OF_MEMORY; a mesh
 * without facets is examined and found unusable. Cost: see docs/defects.md. */
SCREE_API scree_status scree_mesh_check(const scree_mesh *mesh, const scree_check_options *options,
                                        const scree_progress *progress, scree_check *check,
                                        scree_error *error);

/* What a repair does, in this order: X(NAME, "name in JSON", "what was counted"). */
#define SCREE_REPAIR_LIST(X)                                                                       \
  X(DROP_BAD, "dropped_bad_facets", "facets with coordinates that are no numbers dropped")         \
  X(WELD, "welded_vertices", "vertices at equal positions united")                                 \
  X(DROP_DEGENERATE, "dropped_degenerate_facets", "facets without area dropped")                   \
  X(DROP_DUPLICATE, "dropped_duplicate_facets", "duplicate facets dropped")                        \
  X(CLOSE_SEAM, "closed_seam_edges", "boundary edges closed by welding within the tolerance")      \
  X(SPLIT_T_JUNCTION, "split_t_junctions", "edges split where a vertex lay on them")               \
  X(DROP_FIN, "dropped_fin_facets", "facets of open sheets hanging on the surface dropped")        \
  X(DROP_MEMBRANE, "dropped_membrane_facets", "facets of sheets within the surface dropped")       \
  X(SPLIT_EDGE, "split_non_manifold_edges", "non-manifold edges split")                            \
  X(TURN, "turned_facets", "facets turned round to agree with their neighbours")                   \
  X(SPLIT_VERTEX, "split_non_manifold_vertices", "non-manifold vertices split")                    \
  X(CUT_INTERSECTION, "cut_intersecting_facets", "facets cut out where the surface met itself")    \
  X(FILL_HOLE, "filled_holes", "holes filled")                                                     \
  X(FILL_FACET, "filling_facets", "facets added to fill them")                                     \
  X(DROP_DEBRIS, "dropped_debris_shells", "debris shells dropped")                                 \
  X(DROP_CAVITY, "dropped_cavities", "cavities dropped")                                           \
  X(DROP_NESTED, "dropped_nested_shells", "shells inside the material of another dropped")         \
  X(INVERT_SHELL, "inverted_shells", "shells turned outside out")

typedef enum scree_repair_action {
#define SCREE_REPAIR_ENUM(name, key, text) SCREE_REPAIR_##name,
  SCREE_REPAIR_LIST(SCREE_REPAIR_ENUM)
#undef SCREE_REPAIR_ENUM
      SCREE_REPAIR_ACTION_COUNT
} scree_repair_action;

SCREE_API const char *scree_repair_action_name(scree_repair_action action);
SCREE_API const char *scree_repair_action_text(scree_repair_action action);

typedef struct scree_repair_options {
  /* Boundary vertices no farther apart than this share of the bounding box diagonal may become one
   * where that closes a seam, in [0, 0.01]; default 1e-4. The smallest distance that does is used,
   * never more than a quarter of a boundary edge there. */
  double seam_tolerance;
  /* Holes of at most this many edges are filled; default 128, 0 fills none. */
  size_t hole_edges;
  /* Fill larger holes as well, up to 4,096 edges; default false. */
  bool fill_large_holes;
  /* Shells with less than this share of the area of the largest are debris, in [0, 1); default
   * 0.01. Cavities are none. */
  double debris_share;
  /* Drop cavities too; default false. */
  bool drop_cavities;
  /* Keep only the shell of the largest area (and its cavities); default false. */
  bool keep_largest;
  /* Cut facets that meet others of the same shell out and fill the hole; default true. */
  bool cut_intersections;
  /* Test for self-intersections exactly, before and after; default true. Without, the result may
   * have some. */
  bool intersections;
} scree_repair_options;
SCREE_API scree_repair_options scree_default_repair_options(void);

typedef struct scree_repair_report {
  size_t done[SCREE_REPAIR_ACTION_COUNT];
  double seam_distance;      /* the distance within which seams were closed, m; 0: none were */
  scree_check before, after; /* after: of the result, or of what the failed attempt came to */
} scree_repair_report;

/* Makes a closed, manifold, consistently wound, outward surface without self-intersections of a
 * mesh of any quality, or fails with SCREE_BAD_MESH and says what remains. Nothing is done to a
 * mesh that needs nothing, but vertices and triangles are put in canonical order (scree_mesh_weld),
 * so the result does not depend on the order of the facets. Shells that overlap are not united:
 * that is refused. options and progress may be NULL; *report (may be NULL) is filled on success and
 * on SCREE_BAD_MESH. Other errors as scree_mesh_check. */
SCREE_API scree_status scree_mesh_repair(const scree_mesh *mesh,
                                         const scree_repair_options *options,
                                         const scree_progress *progress, scree_mesh *repaired,
                                         scree_repair_report *report, scree_error *error);

/* Check first, repair when asked: what every verb that needs a particle's surface calls. *ready is
 * a copy of a mesh that passes the check, or its repair. options NULL refuses instead of repairing:
 * SCREE_BAD_MESH with the verdict. *report (may be NULL) as for scree_mesh_repair;
 * report->before.usable tells that nothing had to be done. */
SCREE_API scree_status scree_mesh_prepare(const scree_mesh *mesh,
                                          const scree_repair_options *options,
                                          const scree_progress *progress, scree_mesh *ready,
                                          scree_repair_report *report, scree_error *error);

/* What became of one file, for scree_check_json_write. */
typedef struct scree_check_entry {
  const char *file;       /* as given */
  const scree_scan *scan; /* NULL where it could not be read: then only `failure` is told */
  double unit_m;          /* metres per unit of the file */
  const scree_check *check;
  const scree_repair_report *repair; /* NULL where none was tried */
  const char *output;                /* the file written; NULL: none */
  const char *failure;               /* why there is no result; NULL: there is one */
} scree_check_entry;

/* One array with an object per entry: file, checksum, counts of every defect, verdict, what was
 * done. docs/formats.md has every field. command_line may be NULL; path "-" is stdout. */
SCREE_API scree_status scree_check_json_write(const scree_check_entry *entries, size_t entry_count,
                                              const char *command_line, const char *path,
                                              bool overwrite, scree_error *error);

/* ==== 3. Decimation: the curve =================================================================
 */

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
 * i is the mesh after i edge collapses. Levels are nested: every vertex of level i+1 is a vertex of
 * level i, but for the one that the collapse placed. */
typedef struct scree_curve scree_curve;

/* Decimates from the mesh's own count down to the floor, by edge collapses in the order of their
 * cost (docs/decimation.md gives the formulas and rules).
 *
 * What holds at every level: where the mesh was closed, manifold and outward, so is the level. No
 * level has more non-manifold edges, degenerate facets, folds (neighbouring triangles whose normals
 * differ by more than 150 degrees) or self-intersections than the mesh given. A vertex on an edge
 * of three or more triangles, or where the surface touches itself in a point, stays where it is.
 * With SCREE_METHOD_VOLUME the volume of a closed mesh is kept to rounding. No level has spikes: its
 * bounding box exceeds that of the mesh given by at most half of sqrt(S / N), S the area of the mesh
 * and N the level's triangles; what would need them is refused, so that the floor may be higher.
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

/* 1 + the number of collapses; at least 1. */
SCREE_API size_t scree_curve_level_count(const scree_curve *curve);
/* level_index must be below the level count. O(1). */
SCREE_API void scree_curve_level(const scree_curve *curve, size_t level_index, scree_level *level);
/* The first level with at most target_triangle_count triangles, or the last level where none is so
 * low. A closed surface has an even count, so that an odd target gives one triangle less. */
SCREE_API size_t scree_curve_find(const scree_curve *curve, size_t target_triangle_count);
/* Rebuilds a level: triangles and vertices in the order of the mesh given. Free with
 * scree_mesh_free. O(Nm) time. */
SCREE_API scree_status scree_curve_mesh(const scree_curve *curve, size_t level_index,
                                        scree_mesh *mesh, scree_error *error);

/* One edge collapse of the record: what makes level index + 1 of level index. Where `gone` stood,
 * `kept` stands afterwards; triangles that name one vertex twice are no more. */
typedef struct scree_collapse {
  uint32_t kept, gone;     /* vertices of the mesh given */
  uint32_t triangle_count; /* that go: 2, or 1 at a boundary */
  double position[3];      /* of kept afterwards, m */
} scree_collapse;

/* index must be below the level count less one. O(1). */
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

/* ==== 4. The choice ============================================================================
 */

/* From a curve to a triangle count. The criterion (Katagiri and Koyanaka 2020, eq. 1 and 2):
 *
 *   eps_s(N) = |S(N) - S_ref| / S_ref        Ip(N) = eps_s(N) + w N / Nm
 *
 * with S the surface area at N triangles, Nm the scan's count, S_ref the scan's area Sm and w = 1
 * in the paper. Two choices are made from it:
 *
 *   paper   the least Ip on a logarithmic grid of Rp = N / Nm
 *   robust  the least of (worst eps_s at N or any finer level) + w N / Nm, over every level: eps_s
 *           falls to zero where S crosses S_ref by accident, the worst so far does not
 *
 * docs/method.md says why, with figures. */

typedef enum scree_reference {
  SCREE_REFERENCE_SCAN,   /* "scan", the default: Sm, the scan's own area, as in the paper */
  SCREE_REFERENCE_SMOOTH, /* "smooth": the area on the plateau past the scanner's noise, measured on
                             the curve; the scan's area where no noise is found */
} scree_reference;

/* The errors a level is reported with, each relative to the scan; area is the paper's eps_s.
 * Lengths are relative to the diameter of the sphere of the scan's area, sqrt(Sm / pi). */
#define SCREE_SHAPE_ERROR_LIST(X)                                                                  \
  X(AREA, "area")           /* |S - S_ref| / S_ref */                                              \
  X(VOLUME, "volume")       /* |V - Vm| / |Vm| */                                                  \
  X(HAUSDORFF, "hausdorff") /* the larger of both ways */                                          \
  X(MEAN, "mean_distance")  /* the larger of both ways */                                          \
  X(INERTIA, "inertia")     /* Frobenius norm of the tensors' difference over the scan's */        \
  X(SIZE, "size")           /* largest relative change of the three principal dimensions */

typedef enum scree_shape_error {
#define SCREE_SHAPE_ERROR_ENUM(name, text) SCREE_ERROR_##name,
  SCREE_SHAPE_ERROR_LIST(SCREE_SHAPE_ERROR_ENUM)
#undef SCREE_SHAPE_ERROR_ENUM
      SCREE_SHAPE_ERROR_COUNT
} scree_shape_error;

/* The name above, for example "mean_distance". */
SCREE_API const char *scree_shape_error_name(scree_shape_error which);

typedef struct scree_choice_options {
  double weight;         /* w, > 0; 1: the paper, eq. 2 */
  double rp_min, rp_max; /* ends of the grid, 0 < rp_min <= rp_max <= 1; 1e-5, 1e-1: the paper */
  int per_decade;        /* grid points per factor of ten, 1..1000; 9 */
  scree_reference reference; /* S_ref of paper, robust and plain; SCREE_REFERENCE_SCAN */
  bool shape_errors;         /* also inertia and size at every grid level, which are rebuilt */
  bool distances;            /* also the distances at every grid level: minutes on large scans */
} scree_choice_options;

SCREE_API scree_choice_options scree_default_choice_options(void);

/* Point `index` of the grid: rp_min 10^(index / per_decade); index 0 is rp_min. */
SCREE_API double scree_choice_grid_rp(const scree_choice_options *options, size_t index);
/* How many of them lie in [rp_min, rp_max], the ends included (to 1e-9 relative). */
SCREE_API size_t scree_choice_grid_count(const scree_choice_options *options);

/* rp Nm, truncated, the count that an Rp asks for; 1e-3 of 762,000 is 762, however 1e-3 rounds. */
SCREE_API size_t scree_choice_target(double rp, size_t triangle_count);

/* A level at a given Rp: the first level whose count is not above rp Nm, truncated; where the mesh
 * cannot be reduced so far, the last level, and `reached` is false. */
typedef struct scree_choice_level {
  double rp;             /* as asked: the grid's */
  size_t level_index;    /* in the curve */
  size_t triangle_count; /* Nr */
  double rp_reached;     /* Nr / Nm */
  bool reached;
  double area, volume;                    /* m2, m3 */
  double eps_s, ip;                       /* eq. 1 and 2 */
  double worst_eps_s, robust_ip;          /* the monotone envelope and its criterion */
  double smooth_ip;                       /* robust_ip against the area free of noise, where the
                                             levels finer than noise.level_index do not count */
  double errors[SCREE_SHAPE_ERROR_COUNT]; /* NaN where not measured */
} scree_choice_level;

/* A chosen level. */
typedef struct scree_pick {
  double rp;             /* of a choice on the grid: the grid's; else Nr / Nm */
  size_t level_index;    /* in the curve */
  size_t triangle_count; /* Nr */
  double area, volume;   /* m2, m3 */
  double eps_s, ip;      /* what the choice minimised: ip = eps_s + w Nr / Nm; for a robust choice
                            eps_s is the worst at this or any finer level */
  double level_eps_s;    /* eq. 1 at this level alone */
} scree_pick;

/* The scanner's noise as the curve shows it: area that goes away before the shape does. */
typedef struct scree_noise {
  bool found;
  double area;           /* free of noise, m2; the scan's where none was found */
  double fraction;       /* (Sm - area) / area */
  size_t level_index;    /* of the plateau's end nearest to the scan */
  size_t triangle_count; /* there */
} scree_noise;

/* What is known of one object. */
typedef struct scree_choice {
  size_t triangle_count, floor_count; /* Nm, and the fewest triangles reached */
  double area, volume;                /* Sm, Vm: m2, m3 */
  double reference_area;              /* S_ref, m2 */
  scree_noise noise;
  scree_choice_level *levels; /* the grid, Rp rising */
  size_t level_count;
  scree_choice_level
      *trace; /* the dense curve at SCREE_TRACE_PER_DECADE points per factor of ten of
                 Rp, from rp_min to 1, rising; equal neighbours occur at the floor */
  size_t trace_count;
  scree_pick paper; /* least ip on the grid; ties: fewest triangles, then the Rp nearest to Nr/Nm */
  scree_pick robust;      /* least robust_ip of all levels; ties: fewest triangles */
  scree_pick plain;       /* least ip of all levels, for diagnosis: often an accident */
  bool plain_is_accident; /* the error at `plain` is below a tenth of the worst at finer levels */
  scree_pick smooth;      /* robust with the area free of noise; robust where none was found */
  size_t finer_count;     /* what robust would choose were the scan's spacing half as large (Nm four
                             times as large) and the shape the same: the choice follows resolution */
  size_t best[SCREE_SHAPE_ERROR_COUNT]; /* grid index of the least error + w Nr/Nm; level_count
                                           where that error was not measured */
} scree_choice;

enum { SCREE_TRACE_PER_DECADE = 200 };

/* One choice for several objects, as the paper's 1e-3 for its nine: the Rp with the least mean of
 * Ip over the objects. */
typedef struct scree_set_choice {
  size_t object_count;
  double *ip;  /* mean over the objects at each grid Rp */
  double *low; /* least and largest over the objects there: the scatter */
  double *high;
  size_t level_count;
  double paper_rp, paper_ip;   /* least mean ip on the grid; ties: the smaller Rp, but of several
                                  that give the same levels the one nearest to Nr/Nm */
  double robust_rp, robust_ip; /* least mean robust_ip on the trace; ties likewise */
  double smooth_rp, smooth_ip; /* the same against the areas free of noise */
  double paper_spread, robust_spread; /* largest over smallest Rp chosen by the objects alone */
} scree_set_choice;

/* Chooses from the curve of one object. scan is the mesh that the curve was built from; it may be
 * NULL without shape_errors and distances. options NULL means the defaults, progress may be NULL.
 * Errors: SCREE_BAD_MESH where the scan has no area, SCREE_BAD_ARGUMENT, SCREE_OUT_OF_MEMORY,
 * SCREE_CANCELLED. Cost: one pass over the levels, some ms for 400,000 of them. */
SCREE_API scree_status scree_choose(const scree_curve *curve, const scree_mesh *scan,
                                    const scree_choice_options *options,
                                    const scree_progress *progress, scree_choice *choice,
                                    scree_error *error);

SCREE_API void scree_choice_free(scree_choice *choice);
SCREE_API void scree_set_choice_free(scree_set_choice *set);

/* The set's choice. All objects must have been chosen with the same options. */
SCREE_API scree_status scree_choose_set(const scree_choice *choices, size_t count,
                                        scree_set_choice *set, scree_error *error);

/* Many objects at once, as many as there are threads, each from its mesh to its choice. The two
 * functions are called from any thread, several at a time for different objects. */
typedef struct scree_choice_job {
  size_t count;
  scree_simplify_options simplify;
  scree_choice_options options;
  /* Gives the mesh of object `index`, which is freed for it; may be called twice for an object
   * where curves need more than 2 GiB together. */
  scree_status (*load)(void *context, size_t index, const scree_progress *progress,
                       scree_mesh *mesh, scree_error *error);
  /* Gets each object's curve once all choices are made, to rebuild levels from; NULL: not wanted.
   */
  scree_status (*done)(void *context, size_t index, const scree_curve *curve,
                       const scree_choice *choice, const scree_set_choice *set, scree_error *error);
  void *context;
} scree_choice_job;

/* Fills choices (job->count of them) and *set. Where objects fail the first one's error is
 * reported and all outputs are as freed. progress->report is called from any thread, by one at a
 * time. The result does not depend on the number of threads. */
SCREE_API scree_status scree_choose_each(const scree_choice_job *job,
                                         const scree_progress *progress, scree_choice *choices,
                                         scree_set_choice *set, scree_error *error);

/* ==== 5. Built-in samples ======================================================================
 */

/* Nine electronic devices in the manner of the paper's, and four test solids. All are synthetic:
 * drawn, meshed and given a scanner's noise here (docs/samples.md), after no make in particular.
 * Samples 0 to SCREE_SAMPLE_DEVICES - 1 are the devices: fp-1, fp-2, fp-3 (feature phones), dc-1,
 * dc-2, dc-3 (digital cameras), sp-1, sp-2, sp-3 (smartphones); then sphere, box, box-12 and
 * icosphere. */
enum { SCREE_SAMPLE_DEVICES = 9 };

SCREE_API size_t scree_sample_count(void);
/* Name and one-line description of a sample; NULL for an index that is not below the count. */
SCREE_API const char *scree_sample_name(size_t index);
SCREE_API const char *scree_sample_description(size_t index);

typedef struct scree_sample_options {
  double resolution; /* spacing of the mesh's vertices, m; in [0.02e-3, 5e-3], default 0.27e-3 (the
                        paper's). Details finer than it are lost, without harm to the mesh. */
  double noise;      /* standard deviation of the scanner's noise, m; from 0 (a clean mesh) to a
                        quarter of the resolution, default 0.02e-3. The test solids have none. */
  uint64_t seed;     /* of the noise; default 1 */
} scree_sample_options;

SCREE_API scree_sample_options scree_default_sample_options(void);

/* Makes the sample of this name; icosphere-0 to icosphere-11 name a level of the icosphere. The
 * mesh is closed, manifold and outward, without degenerate triangles; at the default resolution a
 * device has 400,000 to 1,500,000 triangles. The same bits for any number of threads. options NULL
 * means the defaults, progress may be NULL. Errors: SCREE_BAD_ARGUMENT for an unknown name or an
 * option out of range, SCREE_LIMIT where the resolution is too fine or too coarse for the sample,
 * SCREE_CANCELLED, SCREE_OUT_OF_MEMORY. Cost: about a second per million triangles and processor.
 * Free *mesh with scree_mesh_free. */
SCREE_API scree_status scree_sample_make(const char *name, const scree_sample_options *options,
                                         const scree_progress *progress, scree_mesh *mesh,
                                         scree_error *error);

/* ==== 6. Particles =============================================================================
 */

/* A particle is a rigid shape with its mass properties and what contact needs: immutable once made,
 * shared by any number of bodies and worlds. Its frame has its origin in the centre of mass and its
 * axes along the principal axes of inertia. */
typedef struct scree_particle scree_particle;

typedef enum scree_particle_kind {
  SCREE_PARTICLE_MESH,
  SCREE_PARTICLE_SPHERE,
  SCREE_PARTICLE_CLUMP,
} scree_particle_kind;

typedef struct scree_particle_options {
  /* m; radius by which the surface is rounded for contact: two meshes touch when their surfaces are
   * within the sum. Mass and centre come from the unrounded mesh. 0 (default): 0.002 of the size,
   * 0.1 mm for a phone (docs/physics.md, "Rounding"). */
  double rounding;
} scree_particle_options;
SCREE_API scree_particle_options scree_default_particle_options(void);

/* Everything per unit of density where density enters. */
typedef struct scree_particle_measures {
  scree_particle_kind kind;
  double volume;          /* m3, exact for the mesh */
  double size;            /* m, L: the diameter of the sphere of equal volume */
  double centre[3];       /* m, centre of mass in the coordinates the particle was made from */
  double orientation[4];  /* w x y z, turns the particle's axes into those coordinates */
  double inertia[3];      /* m5, principal moments for density 1, ascending for a mesh */
  double bounding_radius; /* m, about the centre of mass, rounding included */
  double thickness;       /* m, the thinnest wall: 1 % of the surface has less solid behind it */
  double rounding;        /* m */
  size_t triangle_count;  /* of the mesh; 0 for spheres and clumps */
  size_t point_count;     /* contact features: corners of the mesh, or spheres */
  size_t edge_count;      /* contact features: straight convex edges */
} scree_particle_measures;

/* A closed mesh, metres. Coplanar and collinear subdivisions do not change the features, so neither
 * the forces. Fails with SCREE_BAD_MESH, naming the first offending triangle or edge, for a mesh
 * that is open, non-manifold, inconsistently wound, folded (two faces closer than 30 degrees to
 * back to back over an edge) or without positive volume, and with the verdict of scree_mesh_check
 * for every other that it finds unusable: surfaces that cross or touch themselves, shells inside
 * out or inside others. options may be NULL. Cost n log n. */
SCREE_API scree_status scree_particle_from_mesh(const scree_mesh *mesh,
                                                const scree_particle_options *options,
                                                scree_particle **particle, scree_error *error);
/* A sphere, radius in m. */
SCREE_API scree_status scree_particle_sphere(double radius, scree_particle **particle,
                                             scree_error *error);
/* A rigid clump of `count` spheres, centres at 3 doubles each, metres. `like` (may be NULL) is a
 * particle whose volume, centre and inertia the clump takes over, the usual case of a clump that
 * stands for a mesh; without it they are those of the spheres' union, integrated to about 1e-4. */
SCREE_API scree_status scree_particle_clump(const double *centres, const double *radii,
                                            size_t count, const scree_particle *like,
                                            scree_particle **particle, scree_error *error);
/* Worlds hold their own reference: freeing before the world is legal. */
SCREE_API void scree_particle_free(scree_particle *particle);

SCREE_API void scree_particle_measure(const scree_particle *particle,
                                      scree_particle_measures *measures);
/* The mesh in the particle's frame, borrowed, for drawing; for spheres and clumps no triangles. */
SCREE_API const scree_mesh *scree_particle_mesh(const scree_particle *particle);
/* Sphere or contact point `index` in the particle's frame, with its radius. */
SCREE_API void scree_particle_point(const scree_particle *particle, size_t index, double centre[3],
                                    double *radius);

/* ==== 7. World: bodies, walls, contacts, time ==================================================
 */

/* Bodies under gravity, touching each other and walls by the law of docs/physics.md. */
typedef struct scree_world scree_world;

typedef enum scree_law {
  SCREE_LAW_LINEAR,     /* spring, dashpot, Coulomb slider: the paper's */
  SCREE_LAW_HYSTERETIC, /* Walton and Braun 1986: loading K, unloading K/e2, no dashpot */
} scree_law;

typedef struct scree_world_options {
  double gravity[3];        /* m/s2; default 0 0 -9.81 */
  scree_law law;            /* default linear (Katagiri and Koyanaka 2020) */
  double steps_per_contact; /* N, dt = (pi/2) sqrt(m/K)/N for the lightest and stiffest pair;
                               at least 15; default 20, 40 for energy to 2 % */
  double time_step;         /* s; 0 (default): by steps_per_contact; else at most that of N = 15 */
  double stiffness_factor; /* multiplies every stiffness, for speed; default 1. Overlaps grow by its
                              inverse, the time step by its inverse root */
  double tangential_ratio; /* tangential over normal stiffness, in (0, 1]; default 1 (Rocky) */
  double size;             /* m, the L of K = E L; 0 (default): each pair its smaller body's */
  double smoothing;        /* l0 over L; default 4e-5, 2 um at 50 mm: overlaps this close share */
  double sharing;          /* kappa, in [0, 0.5]; default 0.1: deeper contacts share more widely */
  double overlap_limit;    /* over L; default 0.04, 2 mm at 50 mm: beyond it the run stops with
                              SCREE_DIVERGED. Walls may be thinner: a point keeps to the side that
                              it came from */
  double skin;             /* over L; default 0.02: reach of the candidate lists. Speed only */
  double floor_height;     /* m; bodies whose centre falls below are removed; default -infinity */
} scree_world_options;
SCREE_API scree_world_options scree_default_world_options(void);

typedef struct scree_material {
  double stiffness;   /* N/m2, the E of K = E L; default 1e8; 1e11 for walls (the paper) */
  double density;     /* kg/m3; default 2000 (not in the paper) */
  double restitution; /* in (0, 1]; default 0.3 (the paper) */
  double friction;    /* at least 0; default 0.5 (the paper) */
} scree_material;
SCREE_API scree_material scree_default_material(void);
SCREE_API scree_material scree_default_wall_material(void);

/* options may be NULL; they are copied. */
SCREE_API scree_status scree_world_create(const scree_world_options *options, scree_world **world,
                                          scree_error *error);
SCREE_API void scree_world_free(scree_world *world);
SCREE_API void scree_world_get_options(const scree_world *world, scree_world_options *options);

/* Between two materials: the lower restitution and the lower friction, unless given by
 * scree_world_set_contact. At most 64 materials. */
SCREE_API scree_status scree_world_add_material(scree_world *world, const scree_material *material,
                                                size_t *index, scree_error *error);
SCREE_API scree_status scree_world_set_contact(scree_world *world, size_t material_a,
                                               size_t material_b, double restitution,
                                               double friction, scree_error *error);

typedef enum scree_wall_kind {
  SCREE_WALL_PLANE,    /* through position, solid behind, normal along axis */
  SCREE_WALL_DISC,     /* the plane cut off at radius, a sheet met from both sides */
  SCREE_WALL_CYLINDER, /* a sheet; from position along axis over length (0: endless). The rims of
                          discs and cylinders are met by points only */
  SCREE_WALL_MESH,     /* any consistently wound triangles, also open; outside is in front */
} scree_wall_kind;

typedef struct scree_wall {
  scree_wall_kind kind;
  size_t material;
  double position[3]; /* m; for a mesh: where its origin goes */
  double axis[3];     /* of any length; a mesh is turned so that its z axis points along it */
  double radius;      /* m, disc and cylinder */
  double length;      /* m, cylinder; 0: endless */
  const scree_mesh *mesh;
  double velocity[3];         /* m/s, prescribed; may be changed at any time */
  double angular_velocity[3]; /* rad/s about position */
} scree_wall;

SCREE_API scree_status scree_world_add_wall(scree_world *world, const scree_wall *wall,
                                            size_t *index, scree_error *error);
SCREE_API size_t scree_world_wall_count(const scree_world *world);
/* The wall as it stands now; its mesh, if any, is the world's. */
SCREE_API void scree_world_get_wall(const scree_world *world, size_t index, scree_wall *wall);
/* How its own frame is turned now (w x y z): the mesh's axes into space. */
SCREE_API void scree_world_wall_orientation(const scree_world *world, size_t index,
                                            double orientation[4]);
SCREE_API scree_status scree_world_set_wall_velocity(scree_world *world, size_t index,
                                                     const double velocity[3],
                                                     const double angular_velocity[3],
                                                     scree_error *error);
/* Force and torque about its position, N and N m, on the wall from all bodies in the last step. */
SCREE_API void scree_world_wall_force(const scree_world *world, size_t index, double force[3],
                                      double torque[3]);

typedef struct scree_body {
  double position[3];         /* m, centre of mass */
  double orientation[4];      /* w x y z, unit; particle's axes into space */
  double velocity[3];         /* m/s */
  double angular_velocity[3]; /* rad/s, in space */
} scree_body;

/* A body at rest at the origin with its axes along space's. */
SCREE_API scree_body scree_default_body(void);
/* Bodies may be added at any time, also between steps; index counts up and stays. One that already
 * overlaps another beyond the limit shows in the next step's status. state may be NULL. */
SCREE_API scree_status scree_world_add_body(scree_world *world, scree_particle *particle,
                                            size_t material, const scree_body *state, size_t *index,
                                            scree_error *error);
/* All ever added, removed ones included. */
SCREE_API size_t scree_world_body_count(const scree_world *world);
SCREE_API bool scree_world_body_removed(const scree_world *world, size_t index);
SCREE_API void scree_world_get_body(const scree_world *world, size_t index, scree_body *state);
SCREE_API void scree_world_set_body(scree_world *world, size_t index, const scree_body *state);
SCREE_API scree_particle *scree_world_body_particle(const scree_world *world, size_t index);
SCREE_API size_t scree_world_body_material(const scree_world *world, size_t index);
SCREE_API double scree_world_body_mass(const scree_world *world, size_t index);
/* Takes a body out; its index stays and is not used again. */
SCREE_API void scree_world_remove_body(scree_world *world, size_t index);

/* Advances by step_count steps. SCREE_DIVERGED, with step, body and cause in the message, when the
 * run leaves the model's range: an overlap beyond the limit, a body moving more than a quarter of
 * that limit in one step, a value that is not finite. The world then stands as after the last good
 * step, readable, and refuses to go on. Same bits for every number of threads. Once warm, a step
 * allocates nothing. About 1 to 2 us per body and step at rest on one core. */
SCREE_API scree_status scree_world_step(scree_world *world, size_t step_count, scree_error *error);
SCREE_API double scree_world_time(const scree_world *world);
SCREE_API uint64_t scree_world_step_count(const scree_world *world);
/* s; with what there is in the world now. The reason, when not NULL, becomes one sentence. */
SCREE_API double scree_world_time_step(const scree_world *world, char reason[256]);

/* The state of the whole, at the time of the last force evaluation; velocities are taken at the
 * same moment (the mean of before and after the kick), so that energies balance. */
typedef struct scree_observation {
  double time;                                    /* s */
  double kinetic, rotational, potential, elastic; /* J; potential of gravity, zero at the origin */
  double dissipated_dashpot,
      dissipated_friction;                 /* J since the start; hysteresis counts as dashpot */
  double wall_work;                        /* J done on bodies by moving walls since the start */
  double momentum[3], angular_momentum[3]; /* N s; N m s about the origin */
  double mean_rotation;                    /* rad/s, mean of |omega| (the paper's Fig. 7) */
  double largest_overlap;                  /* m, in the last step */
  double highest_speed;                    /* m/s */
  double coordination;                     /* mean number of touching bodies and walls */
  size_t body_count, removed_count;
  size_t pair_count;    /* touching pairs of bodies, and of body and wall */
  size_t contact_count; /* touching features */
} scree_observation;
/* Cost one pass over the bodies. */
SCREE_API void scree_world_observe(const scree_world *world, scree_observation *observation);

/* One touching feature of the last step. */
typedef struct scree_contact {
  size_t body, other; /* other: a body, or with `wall` a wall */
  bool wall;
  double position[3];    /* m */
  double normal[3];      /* towards `body` */
  double force[3];       /* N, on `body`, normal and tangential */
  double overlap, share; /* m; part of the pair's spring, at most 1/(1 - kappa) in all */
} scree_contact;
/* Calls for every touching feature in a fixed order, from a fresh evaluation of forces at the
 * present positions; changes nothing. False from the callback ends it. */
typedef bool scree_contact_visitor(void *context, const scree_contact *contact);
SCREE_API scree_status scree_world_visit_contacts(const scree_world *world,
                                                  scree_contact_visitor *visit, void *context,
                                                  scree_error *error);

/* Where the time went since creation: seconds of wall clock per stage, and counts. */
typedef struct scree_timings {
  double broad, candidates, contacts, bodies, total; /* s; candidates is part of contacts */
  uint64_t steps, broad_builds, list_builds, item_evaluations, closest_queries, pair_evaluations;
} scree_timings;
SCREE_API void scree_world_timings(const scree_world *world, scree_timings *timings);

/* Names the state: every bit of positions, velocities, contact memory and time. */
SCREE_API scree_checksum scree_world_hash(const scree_world *world);

/* Writes a checkpoint (docs/formats.md): everything in the world, its particles included, so that
 * the file stands alone; timings are not in it. It is complete under its name or not there ("-" is
 * stdout). Without overwrite an existing file is refused with SCREE_EXISTS. Needs memory for the
 * file's size: about 100 bytes a triangle of each particle, 500 a body, 1 to 3 KB a pair. */
SCREE_API scree_status scree_world_save(const scree_world *world, const char *path, bool overwrite,
                                        scree_error *error);
/* Reads a checkpoint ("-" is stdin); free *world with scree_world_free. Every later step has the
 * same bits as in the world that was saved, for any number of threads. Particles are the world's
 * own (scree_world_body_particle); a removed body keeps its. SCREE_BAD_FILE, with file and reason,
 * for what is no checkpoint, is of another version, is cut short or has a bit changed anywhere. */
SCREE_API scree_status scree_world_load(const char *path, scree_world **world, scree_error *error);

/* For runs that may leave the model's range: from now on a checkpoint of the state is kept in
 * memory every step_interval steps, and where scree_world_step comes to SCREE_DIVERGED the last one
 * is written to path, replacing what is there, and named in the message. Loaded, it runs into the
 * same failure with the same bits: a world to look closely at what happened. path NULL: no longer.
 * Not part of checkpoints. Cost: a checkpoint's memory, and the time of making one (about 10 ms for
 * a thousand bodies) every interval. */
SCREE_API scree_status scree_world_keep(scree_world *world, const char *path,
                                        uint64_t step_interval, scree_error *error);

/* ==== 8. Pile: filling, lifting, angle of repose, studies ======================================
 */

/* ---- 8.1 Measuring a heap ---- */

/* Heights above a floor on a square grid: cell (i, j) has its centre at
 * (x + (i + 0.5) cell, y + (j + 0.5) cell) and the height height[j * columns + i], 0 where nothing
 * lies. */
typedef struct scree_height_field {
  double x, y, cell;    /* m: corner and side of a cell */
  size_t columns, rows; /* along x and y */
  double *height;       /* m, rows * columns */
} scree_height_field;

/* An empty field that covers [-half_width, half_width] squared about (centre_x, centre_y). */
SCREE_API scree_status scree_height_field_create(double centre_x, double centre_y,
                                                 double half_width, double cell,
                                                 scree_height_field *field, scree_error *error);
SCREE_API void scree_height_field_free(scree_height_field *field);
/* Raises the field to the surface of a mesh turned by the unit quaternion (w, x, y, z) and moved to
 * position, exactly at the cells' centres; a triangle that covers no centre still counts with its
 * corners. The floor is z = floor_z. */
SCREE_API void scree_height_field_add_mesh(scree_height_field *field, const scree_mesh *mesh,
                                           const double position[3], const double quaternion[4],
                                           double floor_z);
SCREE_API void scree_height_field_add_sphere(scree_height_field *field, const double centre[3],
                                             double radius, double floor_z);

typedef struct scree_repose_options {
  size_t sector_count;        /* azimuth sectors of way 1; default 36 */
  size_t silhouette_count;    /* directions of way 3, over half a turn; default 18 */
  double band_low, band_high; /* the flank is where the height is in this share of the heap's
                                 height; default 0.2 and 0.8 */
  double
      particle_size; /* m: below two of it in height there is no heap; 0 (default): not checked */
} scree_repose_options;

SCREE_API scree_repose_options scree_default_repose_options(void);

/* Angle of repose of a heap, three ways, and its size. Angles in degrees, NaN where there is none.
 */
typedef struct scree_repose {
  bool heap; /* false: no heap to speak of, all angles NaN; `reason` says why */
  char reason[128];
  double sector_deg, sector_sd_deg;         /* 1: mean and SD over the sectors' flank lines */
  size_t sector_count;                      /*    sectors that gave a line */
  double cone_deg, cone_rms;                /* 2: least-squares cone; RMS misfit, m */
  double cone_apex[3];                      /*    its apex, m */
  double silhouette_deg, silhouette_sd_deg; /* 3: mean and SD over the silhouettes' flanks */
  size_t flank_count;                       /*    flanks that gave a line */
  double axis[2];                           /* of the heap: the height-weighted mean position, m */
  double height;                            /* m: greatest mean height over a ring about the axis */
  double peak;                              /* m: greatest height of all */
  double base_radius;     /* m: where the flank line of the rings' mean heights, fitted
                             in the band, meets the floor */
  double run_out;         /* m: the farthest occupied cell from the axis */
  double envelope_volume; /* m^3 under the field: packing fraction = solid over this */
} scree_repose;

/* Measures the field. The ways (docs/repose.md): 1, in each sector a straight line through the mean
 * heights of radial bins whose height is within the band; 2, a cone h = H - m |r - r0| fitted by
 * Gauss-Newton to the cells within the band, apex free; 3, the outline seen from the side, a line
 * on each flank within the band. Cost: linear in the cells times the silhouettes. */
SCREE_API scree_status scree_repose_measure(const scree_height_field *field,
                                            const scree_repose_options *options,
                                            scree_repose *repose, scree_error *error);

/* ---- 8.2 Describing an experiment ---- */

typedef enum scree_mass_rule {
  SCREE_MASS_FROM_MESH, /* density times the volume of each decimated mesh */
  SCREE_MASS_FROM_SCAN, /* density times the volume of the scan, at every level */
} scree_mass_rule;

/* The angle-of-repose experiment of Katagiri and Koyanaka (2020), section 2.3, with everything
 * settable. One table (src/pile/experiment.c) holds each field's key in YAML, unit, range and
 * source; the comments here repeat the unit. Strings are owned; free with scree_experiment_free. */
typedef struct scree_experiment {
  char *preset; /* the name it started from */
  size_t particle_count;
  uint64_t seed;
  double density;                          /* kg/m3 */
  int mass_rule;                           /* a scree_mass_rule */
  double cylinder_diameter, disc_diameter; /* m */
  double pack_time, settle_time;           /* s */
  double lift_speed;                       /* m/s */
  double lift_time;                        /* s */
  double hold_time;                        /* s: at most, until still */
  double still_energy;                     /* J of kinetic energy a particle: less is still */
  bool stop_when_still;                    /* end a phase early when still */
  int inlet; /* 0 "top": above where the packed heap will end; 1 "heap": as near as drop_height */
  double drop_height;                /* m between the heap and the layer being filled in */
  double gravity;                    /* m/s2 */
  double young_particle, young_wall; /* Pa */
  double poisson;
  double restitution, friction_particle, friction_wall;
  int contact_law;            /* 0 linear, 1 hysteretic */
  double steps_per_contact;   /* N of the time step */
  double stiffness_factor;    /* multiplies all stiffnesses */
  double frame_interval;      /* s between frames written; 0: none but the last */
  double checkpoint_interval; /* s of wall-clock time between checkpoints */
  double series_interval;     /* s between the points of the series (scree_run_point) */
  double angle_interval;      /* s between those that have angles; 0: only the last */
  double height_cell;         /* m: cells of the height field; 0: a tenth of the particle size */
  size_t sector_count;
  double band_low, band_high;
} scree_experiment;

/* The names of the presets: "paper", "small", "demo"; NULL past the last. */
SCREE_API const char *scree_preset_name(size_t index);
SCREE_API scree_status scree_experiment_preset(const char *name, scree_experiment *experiment,
                                               scree_error *error);
SCREE_API void scree_experiment_free(scree_experiment *experiment);
/* Reads YAML (or JSON) over the values that *experiment has; `preset: NAME` first takes that
 * preset. Errors name file, line, column, key, value and limit; *experiment is untouched on
 * failure. */
SCREE_API scree_status scree_experiment_read(const char *path, scree_experiment *experiment,
                                             scree_error *error);
/* The same from bytes in memory; name stands for the file in errors. */
SCREE_API scree_status scree_experiment_parse(const char *text, size_t byte_count, const char *name,
                                              scree_experiment *experiment, scree_error *error);
/* An own copy. */
SCREE_API scree_status scree_experiment_copy(const scree_experiment *experiment,
                                             scree_experiment *copy, scree_error *error);
/* Sets one field from text, as `cylinder.diameter` to "0.3". */
SCREE_API scree_status scree_experiment_set(scree_experiment *experiment, const char *key,
                                            const char *value, scree_error *error);
/* What single ranges cannot say, such as a disc smaller than the cylinder; reading checks it too.
 */
SCREE_API scree_status scree_experiment_check(const scree_experiment *experiment,
                                              scree_error *error);
/* The keys of all fields in the order of the file, NULL past the last; unit and meaning of a key
 * ("" for a pure number; the words "one|two" of a choice), NULL for an unknown one. */
SCREE_API const char *scree_experiment_key(size_t index);
SCREE_API const char *scree_experiment_unit(const char *key);
SCREE_API const char *scree_experiment_comment(const char *key);
/* A field as text that scree_experiment_set reads back, into buffer; false for an unknown key. */
SCREE_API bool scree_experiment_get(const scree_experiment *experiment, const char *key,
                                    char *buffer, size_t size);
/* Writes the whole experiment as YAML with units and comments; reading it back gives the same
 * values. */
SCREE_API void scree_experiment_print(const scree_experiment *experiment, FILE *stream);

/* ---- 8.3 One run of the experiment ---- */

typedef enum scree_phase {
  SCREE_PHASE_PACK,   /* layers of particles are filled in at the top of the cylinder */
  SCREE_PHASE_SETTLE, /* they come to rest */
  SCREE_PHASE_LIFT,   /* the cylinder rises */
  SCREE_PHASE_HOLD,   /* until still */
  SCREE_PHASE_DONE,
} scree_phase;

SCREE_API const char *scree_phase_name(scree_phase phase);

/* A run: its world, walls and the schedule of filling and phases. */
typedef struct scree_run scree_run;

/* One of the shapes that a run mixes. */
typedef struct scree_run_shape {
  scree_particle *particle; /* borrowed until the run is created; the run keeps its own reference */
  double density_factor; /* 1, or volume of the scan over that of the particle (mass_from: scan) */
  const char *name;      /* for reports, copied; NULL: none */
  const char *source;    /* where it came from: file, checksum, Rp; copied; NULL: unknown */
} scree_run_shape;

/* The particles take the shapes in equal shares, shuffled by the seed; positions and orientations
 * are random, and their bounding boxes never overlap (src/pile/fill.c). Layers follow each other so
 * that all are in after pack_time; a cylinder too narrow for the largest particle, or a layer that
 * would have to enter faster than the contact law allows, is refused here with the pack_time that
 * would do. At most 60 shapes. */
SCREE_API scree_status scree_run_create(const scree_experiment *experiment,
                                        const scree_run_shape *shapes, size_t shape_count,
                                        scree_run **run, scree_error *error);
SCREE_API void scree_run_free(scree_run *run);

/* Advances by at most step_count time steps; stops earlier where a phase ends. SCREE_DIVERGED as
 * scree_world_step. The result does not depend on how a run is cut into calls. */
SCREE_API scree_status scree_run_advance(scree_run *run, size_t step_count, scree_error *error);
SCREE_API scree_phase scree_run_phase(const scree_run *run);
/* The fraction of the simulated time done, by the longest schedule: phases may end early. */
SCREE_API double scree_run_fraction(const scree_run *run);
/* The world, for observing and frames; not to be changed. */
SCREE_API scree_world *scree_run_world(scree_run *run);
SCREE_API const scree_world *scree_run_view(const scree_run *run);
SCREE_API const scree_experiment *scree_run_experiment(const scree_run *run);
SCREE_API size_t scree_run_shape_count(const scree_run *run);
/* Particle and name belong to the run. */
SCREE_API void scree_run_get_shape(const scree_run *run, size_t index, scree_run_shape *shape);
/* The shape of body `index` of the world. */
SCREE_API size_t scree_run_body_shape(const scree_run *run, size_t index);
/* m: the height of the cylinder's lower end above the disc. */
SCREE_API double scree_run_cylinder_height(const scree_run *run);

/* The state at one moment: a point is recorded at every output.series_interval of simulated time,
 * and one where the run ends. */
typedef struct scree_run_point {
  double time; /* s */
  scree_phase phase;
  size_t body_count;      /* in the world: entered, and not fallen off */
  double kinetic;         /* J, of translation and rotation */
  double mean_rotation;   /* rad/s: mean of |omega| over the bodies, the paper's Fig. 7 */
  double highest_speed;   /* m/s */
  double largest_overlap; /* m, in that step */
  double coordination;    /* mean number of touching bodies and walls */
  double cylinder_height; /* m */
  double sector_deg, cone_deg, silhouette_deg, height; /* of the heap, m; at every
                                                          output.angle_interval while lifting and
                                                          holding, and at the end; else NaN */
} scree_run_point;

/* The series so far, the run's own; valid until the next call that advances it. */
SCREE_API const scree_run_point *scree_run_series(const scree_run *run, size_t *count);

/* What the run cost so far, all its pieces between interruptions together. */
typedef struct scree_run_costs {
  double time_step; /* s */
  uint64_t step_count;
  uint64_t particle_steps;  /* sum over the steps of the bodies in the world */
  double wall_seconds;      /* in scree_run_advance, on the clock */
  double processor_seconds; /* and of all threads of the process meanwhile */
  size_t piece_count;       /* 1, and one more for every resume */
  double largest_overlap;   /* m, of all points of the series */
} scree_run_costs;
SCREE_API void scree_run_get_costs(const scree_run *run, scree_run_costs *costs);

/* What a run gives beyond the heap's shape. */
typedef struct scree_run_result {
  scree_repose repose;
  size_t body_count;       /* particles on the disc */
  size_t left_count;       /* particles that fell off it */
  double packing_fraction; /* solid volume over the volume under the height field */
  double coordination;     /* mean number of touching neighbours, walls included */
  double particle_size;    /* m: mean equal-volume sphere diameter */
  double kinetic;          /* J: what is left of motion */
  double time;             /* s, simulated */
  bool still;              /* less than phases.still_energy a particle */
} scree_run_result;

/* Measures the heap as it stands now (scree_height_field, scree_repose_measure). */
SCREE_API scree_status scree_run_measure(const scree_run *run, scree_run_result *result,
                                         scree_error *error);
/* The same with other settings: of `measure`, only the fields of its group "measure" are used. */
SCREE_API scree_status scree_run_measure_with(const scree_run *run, const scree_experiment *measure,
                                              scree_run_result *result, scree_error *error);

/* ---- 8.4 Runs on disk ---- */

/* Writes a checkpoint: experiment, shapes, world, series; it stands alone (docs/formats.md).
 * Complete under its name or not there. */
SCREE_API scree_status scree_run_save(const scree_run *run, const char *path, bool overwrite,
                                      scree_error *error);
/* Writes a frame: the same without the contacts, a fraction of the size; it can be measured and
 * drawn, not continued. */
SCREE_API scree_status scree_run_save_frame(const scree_run *run, const char *path, bool overwrite,
                                            scree_error *error);
/* Reads either. From a checkpoint every later step has the same bits as in the run saved; a frame
 * is refused by scree_run_advance with SCREE_UNSUPPORTED. SCREE_BAD_FILE, with file and reason, for
 * anything else. */
SCREE_API scree_status scree_run_load(const char *path, scree_run **run, scree_error *error);
SCREE_API bool scree_run_is_frame(const scree_run *run);

/* How a whole run goes on, for a watcher. */
typedef struct scree_run_state {
  const scree_run *run;
  scree_run_point now;     /* without angles */
  double fraction;         /* of the simulated time, by the longest schedule */
  double steps_per_second; /* over the last seconds on the clock; NaN at first */
  double seconds_left;     /* on the clock, at that speed; NaN at first */
} scree_run_state;

typedef struct scree_run_job {
  const scree_experiment *experiment;
  const scree_run_shape *shapes; /* 1 to 60 */
  size_t shape_count;
  /* Gets checkpoint.scree every output.checkpoint_interval, when the run is cancelled and when it
   * is done; frame-NNNN.scree at every output.frame_interval, NNNN counting from 0000; and
   * last.scree, a frame, at the end. Made if need be. NULL: nothing is written. */
  const char *folder;
  /* Also motion.scree: where every body was, at some 240 moments of the longest schedule
   * (scree_motion_read). What an interrupted run wrote of it stays. */
  bool motion;
  /* Go on from the folder's checkpoint.scree where there is one; one of another experiment or of
   * other shapes is refused with SCREE_BAD_ARGUMENT, one that cannot be read with SCREE_BAD_FILE.
   * Without resume a folder that has one is refused with SCREE_EXISTS, unless overwrite. */
  bool resume, overwrite;
  /* Called a few times a second; false cancels: the checkpoint is written, and the answer is
   * SCREE_CANCELLED. NULL: none. */
  bool (*watch)(void *context, const scree_run_state *state);
  /* Called after a frame was due, also without folder; time is run's. NULL: none. */
  scree_status (*frame)(void *context, scree_run *run, size_t frame_index, scree_error *error);
  void *context;
} scree_run_job;

/* Where every body of a run was at moments of its time. */
typedef struct scree_motion {
  size_t frame_count, body_count;
  double *time;            /* s, of each frame, rising */
  double *cylinder_height; /* m, likewise */
  float *poses; /* of body b in frame f the 7 from 7 (f body_count + b): position, m, and quaternion
                   w x y z (within 2e-5 rad); NaN where the body is not in the world */
} scree_motion;

/* Reads motion.scree of a run's folder; a frame at its end that was not written whole is left out.
 * SCREE_BAD_FILE for anything else. */
SCREE_API scree_status scree_motion_read(const char *path, scree_motion *motion,
                                         scree_error *error);
SCREE_API void scree_motion_free(scree_motion *motion);

/* One run from its beginning, or its checkpoint, to its end; *run is then in SCREE_PHASE_DONE: ask
 * it for result, series and costs, and free it. A failed run (SCREE_DIVERGED) leaves its last
 * checkpoint. The same experiment and shapes give the same bits, however often it was interrupted
 * and on any number of threads; the costs alone differ. */
SCREE_API scree_status scree_run_complete(const scree_run_job *job, scree_run **run,
                                          scree_error *error);

/* ---- 8.5 Shapes for a run ---- */

typedef struct scree_grain_options {
  double rp;       /* percentage reduction in (0, 1]; default 1: the scan as it is */
  bool sphere;     /* the sphere of the scan's volume instead, whatever the Rp; default false */
  int mass_rule;   /* a scree_mass_rule; default SCREE_MASS_FROM_MESH */
  double rounding; /* m, see scree_particle_options; default 0 */
} scree_grain_options;
SCREE_API scree_grain_options scree_default_grain_options(void);

/* A shape and what was made of it. */
typedef struct scree_grain {
  scree_run_shape run; /* its particle belongs to this struct; name is NULL */
  size_t scan_triangle_count, triangle_count; /* of a sphere: 0 */
  double rp_reached;                          /* triangle_count / scan_triangle_count */
  double scan_volume, volume;                 /* m3; of the particle before the density factor */
} scree_grain;
SCREE_API void scree_grain_free(scree_grain *grain);

/* A particle of a scan at one Rp. scan must be closed (scree_mesh_prepare); curve is that of the
 * scan, used where rp < 1 and not a sphere, so that many levels cost one decimation; NULL builds
 * one for the call. The level is the first with at most rp Nm triangles, truncated
 * (scree_choice_target), or the last where the scan cannot be reduced so far. */
SCREE_API scree_status scree_grain_make(const scree_mesh *scan, const scree_curve *curve,
                                        const scree_grain_options *options,
                                        const scree_progress *progress, scree_grain *grain,
                                        scree_error *error);

/* ---- 8.6 Pouring shapes into a container ---- */

/* Any shapes, poured layer by layer from above into a box or a cylinder: the plain way to see and
 * test the physics. */
typedef struct scree_pour scree_pour;

typedef enum scree_container {
  SCREE_CONTAINER_CYLINDER, /* a floor and an endless cylinder about the z axis */
  SCREE_CONTAINER_BOX,      /* a floor and four endless walls, the z axis in the middle */
} scree_container;

/* One of the shapes, and how many of it. The particle is borrowed until the pour is created. */
typedef struct scree_pour_shape {
  scree_particle *particle;
  size_t count;
} scree_pour_shape;

typedef struct scree_pour_options {
  scree_world_options world; /* default as scree_default_world_options; gravity must point down */
  scree_material particles;  /* default scree_default_material: the paper's */
  scree_material walls;      /* default scree_default_wall_material; its friction holds against the
                                particles, whatever theirs is */
  scree_container container; /* default cylinder */
  double width;              /* m, inside: diameter, or side along x; 0 (default): so that the heap
                                will be about as high as wide, and three particles fit abreast where
                                there are enough */
  double depth;              /* m, side of a box along y; 0 (default): the width */
  double drop_height;        /* m from the floor to the first layer; default 0.05 */
  double entry_speed;        /* m/s, downwards; default 1 */
  uint64_t seed;             /* of order, places and orientations; default 1 */
} scree_pour_options;
SCREE_API scree_pour_options scree_default_pour_options(void);

/* The shapes enter well mixed, turned at random, in layers of a square grid whose cells hold the
 * largest particle however it is turned; each layer enters above all that is there, as soon as the
 * one before has fallen out of the way. SCREE_BAD_ARGUMENT for no particles, options out of range,
 * or a container narrower than the largest particle. */
SCREE_API scree_status scree_pour_create(const scree_pour_shape *shapes, size_t shape_count,
                                         const scree_pour_options *options, scree_pour **pour,
                                         scree_error *error);
SCREE_API void scree_pour_free(scree_pour *pour);
/* As scree_world_step, letting in layers when they are due: the same bits however a pour is cut
 * into calls. */
SCREE_API scree_status scree_pour_advance(scree_pour *pour, size_t step_count, scree_error *error);
/* For observing, frames and checkpoints; body i is the i-th to have entered. */
SCREE_API scree_world *scree_pour_world(scree_pour *pour);
/* The options with every default filled in. */
SCREE_API void scree_pour_get_options(const scree_pour *pour, scree_pour_options *options);
/* All particles, and those that have entered. */
SCREE_API size_t scree_pour_particle_count(const scree_pour *pour);
SCREE_API size_t scree_pour_entered_count(const scree_pour *pour);
/* Which of the shapes body `index` is. */
SCREE_API size_t scree_pour_shape_of(const scree_pour *pour, size_t index);
/* s: when the last layer enters. */
SCREE_API double scree_pour_filling_time(const scree_pour *pour);
/* J: kinetic and potential energy that the particles brought with them, zero on the floor; what the
 * ledger of the world must come to. */
SCREE_API double scree_pour_entered_energy(const scree_pour *pour);

/* ==== 9. Reports: figures, pictures, files for other programs ================================= */

/* ---- 9.1 Pictures ---- */

/* One body in a picture. */
typedef struct scree_render_item {
  const scree_mesh *mesh; /* borrowed */
  double position[3];     /* m: where the mesh's origin goes */
  double quaternion[4];   /* w, x, y, z: applied before; 0 0 0 0 stands for no rotation */
  const double
      *vertex_values; /* vertex_count values for the colour map, or NULL for plain colour */
  float color[3];     /* linear RGB in [0, 1] */
} scree_render_item;

/* One view of some bodies, framed on its own, with a caption below. */
typedef struct scree_render_cell {
  const scree_render_item *items;
  size_t item_count;
  const char *caption; /* UTF-8 text, never interpreted; NULL: none */
} scree_render_cell;

typedef struct scree_render_options {
  size_t width, height; /* pixels of the whole picture; default 1200 x 900 */
  size_t columns;       /* of cells; 0 (default): chosen from the shape of the picture */
  double azimuth_deg;   /* of the camera about the vertical z; default 35 */
  double elevation_deg; /* of the camera above the horizontal; default 25 */
  size_t samples;       /* per pixel; default 24 */
  bool edges;           /* draw the triangles' edges; default false */
  bool wire;            /* only the edges, seen through; default false */
  bool ground;          /* a white floor under the lowest point, with shadows; default true */
  double focus[3], focus_radius; /* m: this sphere fills the picture; radius 0 (default): all bodies
                                    do */
  double value_minimum, value_maximum; /* of the colour map; default 0 and 1 */
  double value_scale;      /* what the values are multiplied by in the bar's labels; default 1 */
  const char *value_label; /* beside the scale bar, for example "distance / mm"; NULL: no bar */
} scree_render_options;

SCREE_API scree_render_options scree_default_render_options(void);

/* An image of 8-bit sRGB, rows from the top. */
typedef struct scree_image {
  size_t width, height;
  uint8_t *pixels; /* 3 * width * height */
} scree_image;

SCREE_API void scree_image_free(scree_image *image);

/* Ray-traced, softly lit picture of the cells; the same bits for any number of threads. Needs a
 * build with Embree, else SCREE_UNSUPPORTED. Cost: about three rays a sample. */
SCREE_API scree_status scree_render(const scree_render_cell *cells, size_t cell_count,
                                    const scree_render_options *options,
                                    const scree_progress *progress, scree_image *image,
                                    scree_error *error);

/* Writes a PNG; "-" is stdout. */
SCREE_API scree_status scree_image_write_png(const scree_image *image, const char *path,
                                             bool overwrite, scree_error *error);

/* ---- 9.2 Files for ParaView ---- */

typedef enum scree_vtk_type {
  SCREE_VTK_FLOAT64,
  SCREE_VTK_FLOAT32,
  SCREE_VTK_INT64,
  SCREE_VTK_UINT8
} scree_vtk_type;

/* A named array over points or cells. */
typedef struct scree_vtk_array {
  const char *name;
  scree_vtk_type type;
  size_t component_count; /* 1 for scalars, 3 for vectors, 4 for quaternions */
  const void *values;     /* component_count values of the type per point or cell, borrowed */
} scree_vtk_array;

/* What goes into one .vtp file (VTK XML PolyData): points, and over them either triangles, line
 * segments, or, where both are NULL, one vertex cell a point. */
typedef struct scree_vtk_data {
  const double *points; /* 3 * point_count, m */
  size_t point_count;
  const uint32_t *triangles; /* 3 * cell_count indices, or NULL */
  const uint32_t *lines;     /* 2 * cell_count indices, or NULL */
  size_t cell_count;         /* of triangles or lines */
  const scree_vtk_array *point_arrays;
  size_t point_array_count;
  const scree_vtk_array *cell_arrays;
  size_t cell_array_count;
  double time; /* s, written as field data TimeValue; NaN: none */
} scree_vtk_data;

/* Writes version 1.0 XML with raw appended data, 64-bit headers: read by VTK 6 and later. */
SCREE_API scree_status scree_vtp_write(const scree_vtk_data *data, const char *path, bool overwrite,
                                       scree_error *error);

/* Writes the collection of a series: file i is valid at time times[i]. The names are written as
 * given, relative to the collection. A path that ends in .series becomes ParaView's own JSON (as in
 * pile.vtp.series beside pile_0.vtp, pile_1.vtp), every other one a .pvd. */
SCREE_API scree_status scree_pvd_write(const char *const *files, const double *times,
                                       size_t file_count, const char *path, bool overwrite,
                                       scree_error *error);

/* What of a world goes into one .vtp file; every file carries the world's time. Bodies removed are
 * left out. A shape is one scree_particle; shapes are numbered in the order of their first body,
 * removed ones included, so that a number keeps its meaning through a series. */
typedef enum scree_world_view {
  /* The triangles of every body in its place; spheres, also those of clumps, as 320 triangles each.
   * Per triangle: body, shape, material; speed (m/s), angular_speed (rad/s). */
  SCREE_VIEW_SURFACES,
  /* One point a body, at its centre of mass. Per point: body, shape, material; orientation (w x y
   * z, the particle's axes into space), velocity (m/s), angular_velocity (rad/s, in space), mass
   * (kg), size (m, diameter of the sphere of equal volume). */
  SCREE_VIEW_POINTS,
  /* The force network: one line per touching pair, from the body's centre of mass to the other's,
   * or for a wall to the place of contact. Per line, of all touching features together: body,
   * other, wall (0 or 1), feature_count; force on `body` (N), normal_force and tangential_force (N,
   * its parts along and across the features' normals, summed as vectors), place (m, mean of the
   * features, weighted by their force), overlap (m, the largest). */
  SCREE_VIEW_CONTACTS,
  /* The walls as triangles, planes and endless cylinders cut off where the bodies end. Per
   * triangle: wall, kind (a scree_wall_kind). */
  SCREE_VIEW_WALLS,
  SCREE_VIEW_COUNT,
} scree_world_view;

/* "surfaces", "points", "contacts" or "walls"; NULL beyond. */
SCREE_API const char *scree_world_view_name(scree_world_view view);

/* Writes one view of the world as it stands; "-" is stdout. Contacts are evaluated afresh
 * (scree_world_visit_contacts), so a loaded checkpoint shows them too. Fails with SCREE_IO,
 * SCREE_EXISTS, SCREE_OUT_OF_MEMORY, SCREE_LIMIT above 2^32 - 1 points, SCREE_BAD_ARGUMENT. Cost:
 * about 60 bytes a triangle in the file, the same again in memory. */
SCREE_API scree_status scree_world_vtp_write(const scree_world *world, scree_world_view view,
                                             const char *path, bool overwrite, scree_error *error);

/* The particle of `shape`, numbered as above, borrowed; NULL beyond the last. Cost: one pass over
 * the bodies. */
SCREE_API scree_particle *scree_world_shape(const scree_world *world, size_t shape);

/* Writes a mesh with fields: per triangle `area` (m2) and, where reference is not NULL, `distance`
 * (m, of its centroid from the reference's surface); per vertex `area` (a third of the triangles
 * around) and `distance`. The positions are in metres. "-" is stdout. Errors as scree_mesh_measure
 * and scree_vtp_write. */
SCREE_API scree_status scree_mesh_vtp_write(const scree_mesh *mesh, const scree_mesh *reference,
                                            const char *path, bool overwrite, scree_error *error);

/* ---- 9.3 The choice: figure, tables, JSON ---- */

/* One object of a choice, with all that is needed to run it again. Texts are borrowed. */
typedef struct scree_choice_entry {
  const char *name;        /* short, for tables and legends */
  const char *file;        /* as given: a path, or sample:NAME */
  const char *format;      /* as read, for example "binary STL"; "sample" for built-in ones */
  scree_checksum checksum; /* of the file's bytes; zero for samples */
  double unit_m;           /* metres per unit of the file */
  bool is_sample;          /* then resolution, noise and seed say how it was made */
  double sample_resolution, sample_noise; /* m */
  uint64_t sample_seed;
  const char *note;      /* what was repaired or is wrong, in one sentence; NULL: nothing */
  const char *mesh_file; /* where the chosen mesh was written; NULL: nowhere */
  const scree_choice *choice;
} scree_choice_entry;

typedef struct scree_choice_report {
  const scree_choice_entry *entries;
  size_t entry_count;
  const scree_set_choice *set;
  const scree_choice_options *options;
  scree_method method;
  bool paper;               /* the default choice is the paper's, not the robust one */
  const char *command_line; /* for provenance; NULL: unknown */
} scree_choice_report;

/* The paper's Fig. 4, by the path's ending (.png, .svg, .pdf; .csv and .gnuplot for its data and a
 * script): eps_s and Ip against Rp, all objects, the choices marked. */
SCREE_API scree_status scree_choice_figure_write(const scree_choice_report *report,
                                                 const char *path, bool overwrite,
                                                 scree_error *error);

/* One array: an object per entry, then the set's with "set": true. Lengths in metres, areas and
 * volumes in m2 and m3. docs/formats.md has every field. "-" is stdout. */
SCREE_API scree_status scree_choice_json_write(const scree_choice_report *report, const char *path,
                                               bool overwrite, scree_error *error);

/* One row per object and grid Rp. "-" is stdout. */
SCREE_API scree_status scree_choice_csv_write(const scree_choice_report *report, const char *path,
                                              bool overwrite, scree_error *error);

/* The dense curve of one object: one row per point of its trace that is another level. */
SCREE_API scree_status scree_choice_curve_csv_write(const scree_choice_entry *entry,
                                                    const char *path, bool overwrite,
                                                    scree_error *error);

/* One level of the table of a curve. */
typedef struct scree_curve_row {
  scree_level level;
  double eps_s, eps_v, ip; /* |S - Sm|/Sm, |V - Vm|/|Vm| (0 where Vm is), eps_s + Rp */
  scree_distance distance; /* forward: from the scan to the level; read where distances is true */
} scree_curve_row;

/* A table of levels of one curve. Texts are borrowed. */
typedef struct scree_curve_entry {
  const char *file, *format; /* as given; as read */
  scree_checksum checksum;   /* of the file's bytes; zero for samples */
  double unit_m;             /* metres per unit of the file */
  scree_curve_facts facts;
  double area, volume; /* of the scan, m2 and m3 */
  const scree_curve_row *rows;
  size_t row_count;
  bool distances;
} scree_curve_entry;

/* One object, the rows in `levels` (docs/formats.md); SI units. command_line NULL: unknown. "-" is
 * stdout. */
SCREE_API scree_status scree_curve_json_write(const scree_curve_entry *entry,
                                              const char *command_line, const char *path,
                                              bool overwrite, scree_error *error);

/* ---- 9.4 Measures and distances: tables, JSON ---- */

/* One measured scan. Texts are borrowed. */
typedef struct scree_measure_entry {
  const char *file, *format; /* as given; as read */
  scree_checksum checksum;
  double unit_m; /* metres per unit of the file */
  scree_measures measures;
  scree_topology topology;
} scree_measure_entry;

/* One array, an object per entry: every field of measures and topology by its name, in SI units
 * (docs/formats.md). command_line is provenance; NULL: unknown. "-" is stdout. */
SCREE_API scree_status scree_measure_json_write(const scree_measure_entry *entries,
                                                size_t entry_count, const char *command_line,
                                                const char *path, bool overwrite,
                                                scree_error *error);
/* The same as rows; arrays as columns NAME_1, NAME_2 and so on. */
SCREE_API scree_status scree_measure_csv_write(const scree_measure_entry *entries,
                                               size_t entry_count, const char *path, bool overwrite,
                                               scree_error *error);

/* The distance between two scans. */
typedef struct scree_distance_entry {
  const char *file[2];
  scree_checksum checksum[2];
  double unit_m[2];
  scree_distance_options options;
  scree_distance distance;
} scree_distance_entry;

/* One object with `forward` (from file 0 to file 1), `backward` and the Hausdorff distance, m. */
SCREE_API scree_status scree_distance_json_write(const scree_distance_entry *entry,
                                                 const char *command_line, const char *path,
                                                 bool overwrite, scree_error *error);

/* ---- 9.5 The report: one page for a browser ---- */

/* Of all objects of one page together, so that it stays below 6 MB. */
enum { SCREE_LEVELS_BYTES = 3750000 };

/* What the report shows of one object in 3D, in at most byte_limit bytes (but at least a level of
 * 2,000 triangles and what follows from it): the scan, or where that is too large the finest level
 * that fits; a fine level and the collapses that lead from it to the last; the dense curve;
 * measures of the scan and the choices. docs/formats.md has the fields. Cost: O(N log N), some
 * 0.5 s for 762,008 triangles, half of it for the convex hull. */
SCREE_API scree_status scree_levels_write(const scree_curve *curve, const scree_choice *choice,
                                          size_t byte_limit, const char *path, bool overwrite,
                                          scree_error *error);

/* A text, whole or not at all; "-" is stdout. */
SCREE_API scree_status scree_text_write(const char *text, const char *path, bool overwrite,
                                        scree_error *error);

/* When some work began, by three clocks, in seconds. */
typedef struct scree_work_start {
  double calendar, elapsed, processor; /* since 1970; of no meaning alone; of all threads */
} scree_work_start;

SCREE_API scree_work_start scree_work_started(void);

/* JSON: version, command, when the work began and how long it took until now, on what machine and
 * how many threads. Kept apart from results, which do not change from run to run. */
SCREE_API scree_status scree_provenance_write(const scree_work_start *start,
                                              const char *command_line, const char *path,
                                              bool overwrite, scree_error *error);

/* Makes one page of folders with results (docs/formats.md): of a choice, choice.json with
 * choice.txt, provenance.json and levels/NAME.levels. The page is complete in itself, asks nothing
 * of any network, and shows texts from files as text. Fails with SCREE_BAD_FILE where a folder
 * holds no results or a damaged file. Cost: that of reading and writing. */
SCREE_API scree_status scree_page_write(const char *const *folders, size_t folder_count,
                                        const char *path, bool overwrite, scree_error *error);

/* ---- 9.6 Files for DEM codes ---- */

/* How a particle's mesh is put before it is written. */
typedef struct scree_export_options {
  double density; /* kg/m3, > 0; default 2000 (not in the paper) */
  double unit_m;  /* metres per unit of the mesh file; default 1e-3 */
  bool centre;    /* origin to the centre of mass; default false */
  bool principal; /* axes also along the principal axes of inertia, moments ascending: the x axis
                     is the long one; implies centre; default false */
  bool overwrite; /* default false */
  const char *source; /* the input as given, for provenance; NULL: unknown. Borrowed, as are */
  const char *command_line;
  scree_checksum checksum; /* of the input; zero: none */
} scree_export_options;

SCREE_API scree_export_options scree_default_export_options(void);

/* Where the mesh went and what it weighs there, SI. */
typedef struct scree_exported {
  double rotation[3][3];   /* a point p of the mesh given is at rotation p + translation */
  double translation[3];   /* m */
  double mass;             /* kg */
  double inertia[3][3];    /* kg m2, about the centre of mass, along the axes of the file */
  double bounding_radius;  /* m, about the centre of mass */
  scree_measures measures; /* of the mesh as it lies in the file, before rounding */
} scree_exported;

/* Writes the mesh, put as asked, to mesh_path (format by its ending) and what a DEM code needs to
 * know of it as JSON to json_path (docs/formats.md; NULL: not wanted). *exported may be NULL.
 * Fails with SCREE_BAD_MESH where the mesh is not closed or inside out: it would have no mass; with
 * SCREE_EXISTS before anything is written; else as scree_mesh_write. */
SCREE_API scree_status scree_particle_export(const scree_mesh *mesh,
                                             const scree_export_options *options,
                                             const char *mesh_path, const char *json_path,
                                             scree_exported *exported, scree_error *error);

/* Writes a world for other programs into a folder, made if need be:
 *
 *   pile.json      time, gravity, shapes, bodies, walls (docs/formats.md), SI
 *   bodies.csv     the bodies as rows
 *   shape-K.stl    the mesh of shape K (scree_world_shape) in the particle's frame, in unit_m
 *   wall-K.stl     the mesh of wall K in its own frame, in unit_m
 *
 * A body of shape K lies where its quaternion turns shape-K.stl and its position moves it. Of the
 * options unit_m, overwrite and the provenance count. */
SCREE_API scree_status scree_world_export(const scree_world *world,
                                          const scree_export_options *options, const char *folder,
                                          scree_error *error);

/* ---- 9.6 Heaps: JSON, CSV, pictures ---- */

/* A run and what was measured of it. Texts are borrowed. */
typedef struct scree_heap_entry {
  const scree_run *run;
  const scree_run_result *result;
  const char *file;                /* the frame measured; NULL: the run itself, as it ended */
  const scree_experiment *measure; /* the settings of the measurement; NULL: the run's own */
  const char *command_line;        /* NULL: unknown */
} scree_heap_entry;

/* One object: version, command, experiment, shapes, the heap three ways, costs, and the series as
 * columns (docs/formats.md). "-" is stdout. */
SCREE_API scree_status scree_heap_json_write(const scree_heap_entry *entry, const char *path,
                                             bool overwrite, scree_error *error);
/* The series, one row a point. "-" is stdout. */
SCREE_API scree_status scree_series_csv_write(const scree_run *run, const char *path,
                                              bool overwrite, scree_error *error);

/* The bodies of a world as they stand, each shape in its colour; walls are not drawn. Errors as
 * scree_render. */
SCREE_API scree_status scree_world_picture(const scree_world *world,
                                           const scree_render_options *options,
                                           const scree_progress *progress, scree_image *image,
                                           scree_error *error);
/* The particles of a run as they stand, each shape in its colour, seen as options say; a focus of
 * radius 0 is put on the heap, strays may lie outside. Errors as scree_render. */
SCREE_API scree_status scree_run_picture(const scree_run *run, const scree_render_options *options,
                                         const scree_progress *progress, scree_image *image,
                                         scree_error *error);

/* ==== 10. Studies: many runs, and what they say ================================================
 */

/* ---- 10.1 Statistics ---- */

/* Mean and spread of a few values. NaN where there are too few: one value has a mean and nothing
 * else. */
typedef struct scree_summary {
  size_t count; /* values that are numbers; NaN are left out */
  double mean;
  double sd;                  /* with count - 1 */
  double cv;                  /* coefficient of variation: sd / |mean| */
  double mean_low, mean_high; /* confidence interval of the mean: Student's t */
  double sd_low, sd_high;     /* and of the standard deviation: chi-square */
} scree_summary;

/* confidence in (0, 1), for example 0.95: of normally distributed values. */
SCREE_API scree_summary scree_summarise(const double *values, size_t count, double confidence);

/* Two means compared: are they the same but for `margin`, are they different, or cannot this be
 * told? Equivalence is shown by two one-sided tests (Schuirmann 1987) with Welch's degrees of
 * freedom: the 1 - 2 alpha interval of the difference lies within (-margin, margin). */
typedef struct scree_comparison {
  double difference;    /* mean of a less mean of b */
  double low, high;     /* its 1 - 2 alpha interval */
  double degrees;       /* Welch and Satterthwaite */
  double p_equivalence; /* the larger of the two one-sided p */
  double p_difference;  /* two-sided Welch test of equal means */
  bool equivalent;      /* p_equivalence < alpha */
  bool different;       /* p_difference < alpha, and not equivalent */
  size_t count_needed;  /* values a side at which equivalence would be shown, if means and spread
                           stayed as they are; 0: never (|difference| >= margin), or not known */
} scree_comparison;

/* Both need two values at least; with fewer all is NaN and false. */
SCREE_API scree_comparison scree_compare(const scree_summary *a, const scree_summary *b,
                                         double margin, double alpha);

/* y = factor x^exponent, by least squares on logarithms. */
typedef struct scree_power_law {
  size_t count;                       /* points with x and y above zero */
  double factor, exponent;            /* */
  double exponent_low, exponent_high; /* confidence interval, Student's t; NaN with two points */
  double r2;                          /* of the logarithms */
} scree_power_law;

/* SCREE_BAD_ARGUMENT with fewer than two different x above zero. */
SCREE_API scree_status scree_fit_power(const double *x, const double *y, size_t count,
                                       double confidence, scree_power_law *fit, scree_error *error);

enum { SCREE_POLYNOMIAL_DEGREE = 4 };

/* y = sum of coefficient[k] x^k, by least squares (Householder). */
typedef struct scree_polynomial {
  size_t count;
  int degree;
  double coefficient[SCREE_POLYNOMIAL_DEGREE + 1];
  double rms, r2; /* misfit in units of y, and 1 - residual / total sum of squares */
} scree_polynomial;

/* degree 0 to SCREE_POLYNOMIAL_DEGREE; SCREE_BAD_ARGUMENT with fewer than degree + 1 different x.
 */
SCREE_API scree_status scree_fit_polynomial(const double *x, const double *y, size_t count,
                                            int degree, scree_polynomial *fit, scree_error *error);
SCREE_API double scree_polynomial_value(const scree_polynomial *fit, double x);

/* ---- 10.2 A study: points, replicates, runs ---- */

/* A study's file (docs/study.md) and the runs that follow from it: at every point of
 * a design, as many replicates as wanted, each with its own seed. */
typedef struct scree_study scree_study;

/* Reads the file and makes the plan; touches no shape. Errors name file, line, column, key, value
 * and limit. Free with scree_study_free. */
SCREE_API scree_status scree_study_read(const char *path, scree_study **study, scree_error *error);
SCREE_API void scree_study_free(scree_study *study);

/* A run of the plan. Texts belong to the study. */
typedef struct scree_study_run {
  size_t point, replicate;
  uint64_t seed;
  const char *label;  /* the point's factors and values, "rp 0.001, contact.friction 0.3" */
  const char *rp;     /* a number, "scan" or "spheres" */
  const char *shapes; /* names, joined by + */
  const char *key;    /* names the run by what its numbers follow from; NULL before
                         scree_study_prepare */
} scree_study_run;

/* Runs are numbered so that every point has its first replicate before any has its second. */
SCREE_API size_t scree_study_run_count(const scree_study *study);
SCREE_API scree_status scree_study_get_run(const scree_study *study, size_t index,
                                           scree_study_run *run, scree_error *error);

/* ---- 10.3 Working on a study ---- */

/* How this process takes part. Any number of processes on any machines that share the folder may
 * work on it at the same time; none of them is special, and any may be killed. */
typedef struct scree_study_options {
  double lease_s;   /* a run whose worker has given no sign of life for so long is taken over;
                       default 300. On the same machine a dead process is seen at once. */
  double poll_s;    /* pause before looking again where others hold all that is left; default 1 */
  bool wait;        /* stay until every run has ended, to take over what others leave; default true:
                       else return when nothing is to be taken */
  size_t run_limit; /* at most so many runs by this process; 0 (default): no limit */
  const char *worker; /* a name for the table; NULL: made from machine and process */
} scree_study_options;
SCREE_API scree_study_options scree_default_study_options(void);

/* Opens the folder for the study, making it where need be, and puts a copy of the file there. A
 * folder that belongs to other shapes under the same names is refused. */
SCREE_API scree_status scree_study_open(scree_study *study, const char *folder, scree_error *error);
/* The study of a folder, from the copy of its file: for status and analysis. */
SCREE_API scree_status scree_study_open_folder(const char *folder, scree_study **study,
                                               scree_error *error);

/* Makes what the runs need and the folder does not have yet: each shape is read, checked, repaired
 * where need be, decimated once, and its levels written to FOLDER/shapes. */
SCREE_API scree_status scree_study_prepare(scree_study *study, const scree_study_options *options,
                                           const scree_progress *progress, scree_error *error);

/* Lets the runs that failed wait again; their reasons are kept. Needs scree_study_prepare. */
SCREE_API scree_status scree_study_reopen(scree_study *study, scree_error *error);

/* Takes runs, one after the other, and works on each to its end. A run that fails is recorded with
 * its reason and the next is taken. SCREE_CANCELLED leaves a checkpoint and gives the run back.
 * Needs scree_study_prepare. *completed (may be NULL): runs ended here. */
SCREE_API scree_status scree_study_work(scree_study *study, const scree_study_options *options,
                                        const scree_progress *progress, size_t *completed,
                                        scree_error *error);

/* Brings FOLDER/study.sqlite up to date: the plan, the state of every run, the results of those
 * that ended. One process writes at a time; with wait false, another one at work is not waited for.
 * All that is in the database comes from files in the folder: one that is damaged may be deleted,
 * and is made again. */
SCREE_API scree_status scree_study_collect(scree_study *study, bool wait, scree_error *error);

/* ---- 10.4 What a study says ---- */

typedef struct scree_study_counts {
  size_t waiting, leased, running, done, failed; /* runs */
} scree_study_counts;

/* One point of the design. Texts belong to the result. */
typedef struct scree_point_result {
  const char *label, *rp, *shapes;
  const char *pile; /* key of its first run done: the heap to look at; NULL: none yet */
  double rp_value;  /* 1 for the scan, NaN for spheres */
  scree_study_counts counts;
  size_t heap_count;           /* runs done that have an angle */
  double triangle_count;       /* mean over the particles; 0 for spheres */
  scree_summary angle_deg;     /* of repose, by the study's way, of the runs with a heap */
  scree_summary seconds;       /* processor time of a run */
  scree_summary height;        /* m */
  scree_summary run_out;       /* m */
  scree_summary coordination;  /* */
  scree_summary packing;       /* fraction */
  scree_summary left;          /* share of the particles that fell off the disc */
  scree_summary peak_rotation; /* rad/s: the greatest mean rotation after the lift began */
  /* Mean over the replicates of the particles' mean |omega|, against the time since the cylinder
   * began to rise, with one standard deviation either way. A run that ended still counts with its
   * last value, another one no longer. */
  size_t series_count;
  double *time, *rotation, *rotation_low, *rotation_high; /* s, rad/s */
} scree_point_result;

typedef enum scree_in_range {
  SCREE_IN_RANGE_UNKNOWN,
  SCREE_IN_RANGE_YES,
  SCREE_IN_RANGE_NO
} scree_in_range;

/* Points that differ in rp only. */
typedef struct scree_family_result {
  const char *label;             /* what they have in common; "" where rp is the only factor */
  size_t *levels;                /* indices of points, Rp rising, spheres left out */
  scree_comparison *comparisons; /* of each level with the finest; the last one is not used */
  size_t level_count;
  size_t spheres; /* index of the point with spheres; SIZE_MAX: none */
  /* The angle has converged from this level on: it and every finer one are equivalent to the finest
   * within the margin, tested from fine to coarse until one fails, so that the error rate of the
   * whole is that of one test. level_count - 1: only the finest itself, which says nothing. */
  size_t converged_from;
  bool converged;                                 /* at least one other level is equivalent */
  double paper_low, paper_high, paper_mean;       /* Rp chosen by Ip on the grid, of the shapes */
  double robust_low, robust_high, robust_mean;    /* by the robust criterion; means are geometric */
  scree_in_range paper_in_range, robust_in_range; /* whether even the lowest of them lies at or
                                                     above the Rp converged from */
  scree_power_law time_law;    /* seconds against Rp, all runs; count 0: too few levels */
  scree_polynomial time_curve; /* the paper's fourth order; count 0: too few levels */
} scree_family_result;

typedef struct scree_failure {
  const char *label, *reason;
  size_t replicate;
} scree_failure;

typedef struct scree_study_result {
  const char *name, *design, *method, *angle, *version;
  size_t replicate_count, point_count, factor_count;
  uint64_t seed;
  double margin_deg, confidence;
  scree_study_counts counts;
  size_t worker_count;  /* at work now */
  double seconds_spent; /* processor time of the runs done */
  double
      seconds_left; /* on the clock with as many workers as now (none: with one); NaN: not known */
  bool mixed_versions; /* runs were made by different versions of scree */
  scree_point_result *points;
  scree_family_result *families; /* those with two Rp or more */
  size_t family_count;
  scree_failure *failures;
  size_t failure_count;
  void *memory; /* private */
} scree_study_result;

/* From the database (scree_study_collect). Free with scree_study_result_free. */
SCREE_API scree_status scree_study_analyse(const scree_study *study, scree_study_result *result,
                                           scree_error *error);
SCREE_API void scree_study_result_free(scree_study_result *result);

/* ---- 10.5 Reports of a study ---- */

/* docs/formats.md has every field. "-" is stdout. */
SCREE_API scree_status scree_study_json_write(const scree_study_result *result, const char *path,
                                              bool overwrite, scree_error *error);
/* One row per point. */
SCREE_API scree_status scree_study_csv_write(const scree_study_result *result, const char *path,
                                             bool overwrite, scree_error *error);
/* After the paper's Figs. 5, 7 and 8, by the path's ending as scree_choice_figure_write: angle with
 * standard deviation, and coefficient of variation, against Rp; mean rotation against time;
 * processor time of a run against Rp with both fits. SCREE_UNSUPPORTED where the study has nothing
 * to draw. */
SCREE_API scree_status scree_study_angle_figure(const scree_study_result *result, const char *path,
                                                bool overwrite, scree_error *error);
SCREE_API scree_status scree_study_rotation_figure(const scree_study_result *result,
                                                   const char *path, bool overwrite,
                                                   scree_error *error);
SCREE_API scree_status scree_study_time_figure(const scree_study_result *result, const char *path,
                                               bool overwrite, scree_error *error);
/* All of these into a folder: study.json, points.csv, and angle, rotation and time as .png, .svg,
 * .pdf, .csv and .gnuplot; what is there is overwritten. */
SCREE_API scree_status scree_study_report_write(const scree_study_result *result,
                                                const char *folder, scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
