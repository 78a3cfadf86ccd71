/* Particles: rigid shapes with mass and contact features. */
#ifndef SCREE_PARTICLE_H
#define SCREE_PARTICLE_H

#include "scree/mesh.h"

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

#ifdef __cplusplus
}
#endif
#endif
