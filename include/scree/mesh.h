/* Meshes and scans: reading, welding, writing. */
#ifndef SCREE_MESH_H
#define SCREE_MESH_H

#include "scree/base.h"

#ifdef __cplusplus
extern "C" {
#endif

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
/* Multiplies all coordinates. */
SCREE_API void scree_mesh_scale(scree_mesh *mesh, double factor);

/* ---- Reading and writing ---- */

/* How a scan is read. Most files carry no unit: it is stated here, never guessed. */
typedef struct scree_read_options {
  /* Metres per unit of the file, in [1e-12, 1e12]; default 1e-3 (millimetres, as scanners write).
   * 3MF, glTF and what scree wrote itself state their unit, and this one is not used. */
  double unit_m;
  /* Vertices closer than this share of the bounding box diagonal become one: 0 (the default: only
   * equal positions) or in [1e-12, 0.1]. See scree_mesh_weld. */
  double weld_tolerance;
  /* The most bytes read from a file or stream; default 0: only memory limits. */
  size_t max_bytes;
  /* Use unit_m also where scree's own comment in the file names another; default false. */
  bool ignore_comment_unit;
  /* Read one of the parts that the file names, counted from 1: nodes of a glTF with a mesh, items
   * of a 3MF's build, in their order. Default 0: all; files of other formats are read whole. */
  size_t part;
} scree_read_options;

SCREE_API scree_read_options scree_default_read_options(void);

/* A scan: its welded surface and what the file said. */
typedef struct scree_scan {
  scree_mesh mesh;         /* metres; vertices and triangles in canonical order (scree_mesh_weld) */
  scree_checksum checksum; /* of the file's bytes, and of those beside it that it names */
  size_t byte_count;
  double unit_m;             /* metres per unit of the file: of the options, or what it states */
  bool states_unit;          /* the file does */
  double comment_unit_m;     /* the unit that scree's own comment in the file names, m; 0: none */
  char format[32];           /* for example "STL binary", "3MF, inch" (with the unit it states) */
  size_t facet_count;        /* triangles in the file; a polygon counts as its triangles */
  size_t degenerate_count;   /* of these, dropped: fewer than three different corners */
  size_t solid_count;        /* `solid`s of an ASCII STL; else 1 */
  size_t part_count;         /* as of scree_read_options; 0: its format names none */
  char part_name[64];        /* of the one that was asked for */
  size_t ignored_byte_count; /* of an STL: bytes behind the last facet, and attributes */
  char warning[192];         /* in what it contradicts itself or what is left out; "": nothing */
} scree_scan;

SCREE_API void scree_scan_free(scree_scan *scan);

/* Reads and welds a scan. path "-" is standard input. The format is found by content, not by name:
 * STL (binary, also big-endian, with colours or a header that begins with `solid`; ASCII), PLY
 * (ASCII, both byte orders, polygons, triangle strips), OBJ (polygons, v/vt/vn, negative indices),
 * OFF (also with colours, normals, texture coordinates), 3MF, glTF (binary or text, with data
 * inside or in files beside it). options NULL means the defaults.
 *
 * Sizes in the file are believed only where its length allows them, so memory stays within a fixed
 * multiple of the file's length (of its triangles for 3MF and glTF). Errors: SCREE_IO;
 * SCREE_LIMIT above max_bytes or 2^32 - 2 vertices; SCREE_UNSUPPORTED for a format known but not
 * read, as COLLADA, X3D, AMF, FBX and 3DS; SCREE_BAD_FILE with the line or
 * byte, the value and the limit; SCREE_BAD_MESH where every facet is degenerate;
 * SCREE_OUT_OF_MEMORY. Free *scan with scree_scan_free. */
SCREE_API scree_status scree_scan_read(const char *path, const scree_read_options *options,
                                       scree_scan *scan, scree_error *error);

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
/* What was done to a wall. */
typedef struct scree_wall_mending {
  size_t welded;  /* vertices that became one with another nearby */
  size_t flat;    /* facets without area, dropped */
  size_t joined;  /* vertices set into edges that ran past them */
  size_t doubled; /* facets that lay on others, dropped */
  size_t parted;  /* edges where three or more facets met, or where a surface met its other side */
  size_t turned;  /* facets wound against most of their piece */
} scree_wall_mending;
/* Any triangle soup as a wall for scree_world_add_wall: vertices within 2e-6 of the diagonal are
 * one, edges that run past a vertex are split there, facets without area or on others are dropped,
 * pieces are parted where three facets or more meet, and wound one way. A closed piece keeps the
 * winding of most of its facets: one that is wound inwards holds bodies (SCREE_WALL_MESH). A clean
 * mesh comes out as it went in, to the last bit. mending may be NULL. SCREE_BAD_MESH where no facet
 * has an area, with a place. Cost n log n. Free *wall with scree_mesh_free. */
SCREE_API scree_status scree_wall_mend(const scree_mesh *soup, scree_mesh *wall,
                                       scree_wall_mending *mending, scree_error *error);
/* A sheet `thickness` m thick, half of it to each side of an open, consistently wound surface. What
 * bends more sharply than it is thick may meet itself, as a particle's check tells. SCREE_BAD_MESH
 * where more than two facets share an edge or neighbours are wound unlike. Free *solid. */
SCREE_API scree_status scree_mesh_thicken(const scree_mesh *sheet, double thickness,
                                          scree_mesh *solid, scree_error *error);
/* Brings a mesh into canonical order by welding equal positions: what reading gives back of a
 * lossless file of it. A mesh that was read stays as it is. A particle's forces add up in the order
 * of its mesh, so that runs of the same bits need the same order. On failure *mesh is untouched. */
SCREE_API scree_status scree_mesh_canonicalize(scree_mesh *mesh, scree_error *error);

/* Formats that are written. */
typedef enum scree_file_format {
  SCREE_FORMAT_AUTO,      /* by the path's extension: .stl .ply .obj .off .3mf */
  SCREE_FORMAT_STL,       /* "stl": binary; positions rounded to 24 bits */
  SCREE_FORMAT_STL_ASCII, /* "stl-ascii" */
  SCREE_FORMAT_PLY,       /* "ply": binary little endian, double */
  SCREE_FORMAT_PLY_FLOAT, /* "ply-float": binary little endian, positions rounded to 24 bits */
  SCREE_FORMAT_OBJ,       /* "obj" */
  SCREE_FORMAT_OFF,       /* "off" */
  SCREE_FORMAT_3MF, /* "3mf": not compressed; says its unit, metre where 3MF has no such unit */
  SCREE_FILE_FORMAT_COUNT,
} scree_file_format;

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

#ifdef __cplusplus
}
#endif
#endif
