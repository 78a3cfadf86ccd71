/* Particles: rigid shapes with mass and contact features. */
#ifndef SCREE_PARTICLE_H
#define SCREE_PARTICLE_H

#include "scree/simplify.h"

#ifdef __cplusplus
extern "C" {
#endif

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
  /* m; by how much the surface stands out for contact: two meshes touch when their surfaces are
   * within the sum. Mass and centre come from the mesh itself. 0 (default): 0.002 of the size, and
   * at most a 250th of the thickness (docs/background/physics.md, "Rounding"). */
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
  double rounding;        /* m, see scree_particle_options */
  size_t triangle_count;  /* of the mesh; 0 for spheres and clumps */
  size_t point_count;     /* contact features: corners of the mesh, or spheres */
  size_t edge_count;      /* contact features: straight convex edges */
} scree_particle_measures;

/* A closed mesh, metres. Coplanar and collinear subdivisions do not change the features, so neither
 * the forces. Fails with SCREE_BAD_MESH, naming the first offending triangle or edge, for a mesh
 * that is open, non-manifold, inconsistently wound, sharper than SCREE_LEAST_EDGE_DEG at an edge
 * or without positive volume, and with the verdict of scree_mesh_check
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
/* The clump of a table: a sphere a line, between blanks, commas, semicolons or tabs. A first line
 * names the columns, in any order and among others that are passed over: x, y, z and radius (r) or
 * diameter (d), as "X (mm)" with their unit. Without it they are x, y, z, radius, as CLUMP, MClump
 * of MercuryDPM and Chrono's DEM-Engine write them, behind the line's number where there are five.
 * Empty lines and comments (#, %, //) are passed over, but for the unit that scree's own comment
 * names (else it is that of the names or the options, of which NULL are the defaults; unit_m,
 * max_bytes and ignore_comment_unit are used), and `# volume V`, `# centroid X Y Z` and `# inertia
 * XX YY ZZ XY XZ YZ` (about the centroid, for density 1) in that unit: with all three these are the
 * clump's, as of a particle that it is like. PFC's `clump template create` with `pebbles`, and with
 * `volume` and `inertia` as the body's, is read too. At most 10,000 spheres. Errors:
 * SCREE_BAD_FILE, naming file and line. */
SCREE_API scree_status scree_particle_clump_read(const char *path,
                                                 const scree_read_options *options,
                                                 scree_particle **particle, scree_error *error);
/* Whether a path ends as that of a table of spheres: .csv, .tsv, .txt, .dat, .p3dat. */
SCREE_API bool scree_is_clump_table(const char *path);
/* Into how many groups the spheres fall that reach each other: 1 where they hang together, and for
 * meshes. Cost: quadratic in the spheres. */
SCREE_API size_t scree_particle_piece_count(const scree_particle *particle);
/* Worlds hold their own reference: freeing before the world is legal. */
SCREE_API void scree_particle_free(scree_particle *particle);

SCREE_API void scree_particle_measure(const scree_particle *particle,
                                      scree_particle_measures *measures);
/* The mesh in the particle's frame, borrowed, for drawing; for spheres and clumps no triangles. */
SCREE_API const scree_mesh *scree_particle_mesh(const scree_particle *particle);
/* Sphere or contact point `index` in the particle's frame, with its radius. */
SCREE_API void scree_particle_point(const scree_particle *particle, size_t index, double centre[3],
                                    double *radius);

/* ---- From a scan to a particle ---- */

/* What a shape is made from: one of file, sample, table, sphere and box. Texts are borrowed. */
typedef struct scree_shape_spec {
  const char *file;         /* a scan: read, checked, repaired where need be */
  const char *sample;       /* a built-in device, as "sp-1" */
  const char *table;        /* of the spheres of a clump (scree_particle_clump_read) */
  double sphere;            /* m, its diameter; 0: none */
  double box[3];            /* m, its sides; the first 0: none */
  double unit_m;            /* m per unit of the files; 0: as they say, else mm */
  double resolution, noise; /* m, of a sample; 0, of noise NaN: as usual */
  uint64_t sample_seed;
  double thickness;    /* m; the file's surface is open, and of a sheet (scree_mesh_thicken) */
  size_t part;         /* of the file (scree_read_options), or of its bodies; 0: all */
  bool no_repair;      /* refuse a scan that is no closed surface */
  scree_method method; /* of decimation */
  /* Of scans, samples and boxes: "all" or "scan", "recommended" (as `scree choose` does), a
   * multiple as "0.5*recommended", a percentage reduction in (0, 1], "clump:20" (so many spheres
   * that stand for it), "spheres" (of a table too: the sphere of its volume). NULL: all, or where
   * those are more than SCREE_DENSE_SCAN triangles as recommended. */
  const char *level;
  size_t triangle_count; /* or at most so many triangles; 0: by level */
  size_t spheres;        /* a clump of so many spheres that stands for that level; 0: none */
} scree_shape_spec;
SCREE_API scree_shape_spec scree_default_shape_spec(void);

/* Why a text is no level; NULL: it is one. */
SCREE_API const char *scree_shape_level_error(const char *level);

typedef struct scree_shape_made {
  scree_particle *particle;                   /* to be freed */
  size_t scan_triangle_count, triangle_count; /* 0: of spheres */
  double scan_volume;                         /* m3, before decimation */
  double recommended; /* the Rp chosen, where it was asked for or taken; else NaN */
  bool repaired;      /* it was no closed surface */
  size_t part_count;  /* of the file, by parts that it names or else by separate bodies */
  char part_name[64];
  scree_checksum checksum; /* of the file; zero: of none */
} scree_shape_made;

/* Keeps what was made, so that it is made once; scans of one file are decimated once for all levels
 * that are asked for one after the other. */
typedef struct scree_shape_store scree_shape_store;
SCREE_API scree_status scree_shape_store_create(scree_shape_store **store, scree_error *error);
SCREE_API void scree_shape_store_free(scree_shape_store *store);

/* Has the store give this particle for a shape of that file, whatever is in it; it holds its own
 * reference. */
SCREE_API scree_status scree_shape_store_give(scree_shape_store *store, const char *file,
                                              scree_particle *particle, scree_error *error);

/* Makes the particle, or takes it from the store (NULL: none). Levels do not hang on the file's
 * unit; a level is the first with at most so many triangles, truncated, or the last where the scan
 * cannot be reduced so far, in canonical order. Errors as of reading, scree_mesh_prepare,
 * scree_curve_build and scree_particle_from_mesh; SCREE_LIMIT where more than
 * SCREE_MOST_TRIANGLES triangles are left. Cost: that of reading and of decimating. */
enum { SCREE_MOST_TRIANGLES = 100000 };
SCREE_API scree_status scree_shape_make(const scree_shape_spec *spec, scree_shape_store *store,
                                        const scree_progress *progress, scree_shape_made *made,
                                        scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
