/* Reports: figures, pictures, files for other programs. */
#ifndef SCREE_REPORT_H
#define SCREE_REPORT_H

#include "scree/choice.h"
#include "scree/clump.h"
#include "scree/fracture.h"
#include "scree/measure.h"
#include "scree/particle.h"
#include "scree/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Pictures ---- */

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
  size_t samples;       /* per pixel, fewer where the first agree; default 8 */
  bool edges;           /* draw the triangles' edges; default false */
  bool wire;            /* only the edges, seen through; default false */
  bool ground;          /* a white floor under the lowest point, with shadows; default true */
  double focus[3], focus_radius; /* m: this sphere fills the picture; radius 0 (default): all bodies
                                    do */
  double value_minimum, value_maximum; /* of the colour map; default 0 and 1 */
  double value_scale;      /* what the values are multiplied by in the bar's labels; default 1 */
  const char *value_label; /* beside the scale bar, for example "distance / mm"; NULL: no bar */
  bool joints; /* of a world: the map is of the stress of bodies' joints over their strength */
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

/* Reads a PNG, what is transparent over white; at most 16384 pixels across. Needs a build with
 * pictures, else SCREE_UNSUPPORTED. Free with scree_image_free. */
SCREE_API scree_status scree_image_read_png(const char *path, scree_image *image,
                                            scree_error *error);
/* Writes a PNG; "-" is stdout. */
SCREE_API scree_status scree_image_write_png(const scree_image *image, const char *path,
                                             bool overwrite, scree_error *error);

/* ---- Files for ParaView ---- */

typedef enum scree_vtk_type {
  SCREE_VTK_FLOAT64,
  SCREE_VTK_FLOAT32,
  SCREE_VTK_INT64,
  SCREE_VTK_UINT8,
  SCREE_VTK_INT32
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
  double time;                /* s, written as field data TimeValue; NaN: none; not infinite */
  const float *points_single; /* instead of points, where not NULL */
  bool bare;                  /* no vertex cells either: glyphs need none */
} scree_vtk_data;

/* Writes version 1.0 XML with raw appended data, 64-bit headers: read by VTK 6 and later. */
SCREE_API scree_status scree_vtp_write(const scree_vtk_data *data, const char *path, bool overwrite,
                                       scree_error *error);

/* Writes the collection of a series: file i is valid at time times[i]. The names are written as
 * given, relative to the collection. A path that ends in .series becomes ParaView's own JSON (as in
 * pile.vtp.series beside pile_0.vtp, pile_1.vtp), every other one a .pvd. SCREE_BAD_ARGUMENT where
 * a time is not finite. */
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

/* ---- The report: one page for a browser ---- */

/* Makes one page of folders with results (docs/reference/formats.md): of a choice, choice.json with
 * choice.txt, provenance.json and levels/NAME.levels. The page is complete in itself, asks nothing
 * of any network, and shows texts from files as text. Fails with SCREE_BAD_FILE where a folder
 * holds no results or a damaged file. Cost: that of reading and writing. */
SCREE_API scree_status scree_page_write(const char *const *folders, size_t folder_count,
                                        const char *path, bool overwrite, scree_error *error);

/* ---- Files for DEM codes ---- */

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
 * know of it as JSON to json_path (docs/reference/formats.md; NULL: not wanted). *exported may be
 * NULL. Fails with SCREE_BAD_MESH where the mesh is not closed or inside out: it would have no
 * mass; with SCREE_EXISTS before anything is written; else as scree_mesh_write. */
SCREE_API scree_status scree_particle_export(const scree_mesh *mesh,
                                             const scree_export_options *options,
                                             const char *mesh_path, const char *json_path,
                                             scree_exported *exported, scree_error *error);

/* Writes a world for other programs into a folder, made if need be:
 *
 *   pile.json      time, gravity, shapes, bodies, walls (docs/reference/formats.md), SI
 *   bodies.csv     the bodies as rows
 *   shape-K.stl    the mesh of shape K (scree_world_shape) in the particle's frame, in unit_m
 *   wall-K.stl     the mesh of wall K in its own frame, in unit_m
 *
 * A body of shape K lies where its quaternion turns shape-K.stl and its position moves it. Of the
 * options unit_m, overwrite and the provenance count. */
SCREE_API scree_status scree_world_export(const scree_world *world,
                                          const scree_export_options *options, const char *folder,
                                          scree_error *error);

/* ---- Scenes: JSON and pictures ---- */

/* A scene as it stands. Texts are borrowed. */
typedef struct scree_scene_entry {
  const scree_scene *scene;
  const char *file;            /* the scene's; NULL: unknown */
  const char *stopped_because; /* it was interrupted, or diverged; NULL: it came to its end */
  const char *command_line;    /* NULL: unknown */
  double seconds;              /* on the clock */
  const scree_pile_settings *measure; /* of piles; NULL: the scene's own */
} scree_scene_entry;

/* One object: version, command, why it ended, costs, the book, piles three ways, shapes, inlets,
 * outlets, and every column with its last value, mean, extremes and series
 * (docs/reference/formats.md). "-" is stdout. */
SCREE_API scree_status scree_scene_json_write(const scree_scene_entry *entry, const char *path,
                                              bool overwrite, scree_error *error);
/* The bodies, what joints hold together in one colour, and the geometry, which is cut open towards
 * the viewer. Errors as scree_render. */
SCREE_API scree_status scree_scene_picture(const scree_scene *scene,
                                           const scree_render_options *options,
                                           const scree_progress *progress, scree_image *image,
                                           scree_error *error);

/* The bodies of a world as they stand, each shape or, with joints, fragment in its colour; walls
 * are not drawn. Errors as scree_render. */
SCREE_API scree_status scree_world_picture(const scree_world *world,
                                           const scree_render_options *options,
                                           const scree_progress *progress, scree_image *image,
                                           scree_error *error);

/* The answer of a choice as `scree choose` begins with it: the first sentence, lengths in mm.
 * options as it was made with. */
enum { SCREE_CHOICE_SENTENCE_BYTES = 512 };
SCREE_API void scree_choice_sentence(const scree_choice *choice,
                                     const scree_choice_options *options,
                                     char text[SCREE_CHOICE_SENTENCE_BYTES]);

/* ---- Particles in other codes ---- */

/* The name of a code; NULL behind the last. */
SCREE_API const char *scree_code_name(size_t index);
/* Its index; that behind the last where there is none. */
SCREE_API size_t scree_code_find(const char *name);
/* Whether it takes such particles; spheres are clumps. */
SCREE_API bool scree_code_takes(size_t code, scree_particle_kind kind);
/* What a surface becomes for it: where it takes both, that with which it computes best. */
SCREE_API scree_particle_kind scree_code_kind(size_t code);

typedef struct scree_code_write_options {
  const char *name; /* of the files; default particle. Borrowed */
  double density;   /* kg/m3, default 2000 */
  size_t count;     /* of particles that the scripts let fall; default 50 */
  bool overwrite;
  /* Pa, of the scripts; default 0: so soft that a body that falls from the script's height presses
   * itself a tenth of its radius into the floor, at least 1e6. */
  double young;
  scree_convex_options convex; /* for codes that take convex pieces */
  const scree_progress *progress;
} scree_code_write_options;
SCREE_API scree_code_write_options scree_default_code_write_options(void);

/* Of codes that take convex pieces: how many, and what they cost, as in scree_convex; else 0. */
typedef struct scree_code_written {
  size_t piece_count;
  double volume_error, inertia_error;
} scree_code_written;

/* Writes a particle into an existing folder as the code reads it, in SI units: its shape about the
 * centre of mass along the principal axes, its mass and inertia (EDEM and MFiX work these out for
 * themselves), and scripts with made-up materials that let it fall, alone and in a heap. In file
 * names, characters other than letters, digits, points, - and _ become _. result may be NULL.
 * SCREE_BAD_ARGUMENT where the code does not take such a particle. */
SCREE_API scree_status scree_code_write(const scree_particle *particle, size_t code,
                                        const scree_code_write_options *options, const char *folder,
                                        scree_code_written *result, scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
