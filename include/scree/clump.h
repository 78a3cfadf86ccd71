/* Clumps: a body as a set of overlapping spheres. */
#ifndef SCREE_CLUMP_H
#define SCREE_CLUMP_H

#include "scree/measure.h"
#include "scree/particle.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct scree_sphere {
  double centre[3], radius; /* m */
} scree_sphere;

/* A surface of so many triangles has all the detail that spheres show. */
enum { SCREE_CLUMP_TRIANGLES = 2000 };

/* How spheres are placed. All but the first are greedy, by the paper named; they are there to
 * compare and to reproduce. */
typedef enum scree_clump_method {
  SCREE_CLUMP_FITTED,   /* all spheres moved together until the union fits best
                           (docs/background/clumps.md) */
  SCREE_CLUMP_FAVIER,   /* Favier et al. 1999: spheres along the longest principal axis */
  SCREE_CLUMP_BUBBLE,   /* Taghavi 2011: bubble pack; medial spheres by `ratio` and `angle_deg` */
  SCREE_CLUMP_FERELLEC, /* Ferellec and McDowell 2010: spheres grown from surface points inward */
  SCREE_CLUMP_PEELING,  /* inscribed spheres at the deepest points that none covers yet */
} scree_clump_method;

/* The method by its name: fitted, favier, bubble, ferellec, peeling. NULL for no method. */
SCREE_API const char *scree_clump_method_name(scree_clump_method method);

typedef struct scree_clump_options {
  scree_clump_method method;
  size_t most;      /* spheres, the largest count; 1 to 300, default 100 */
  double outside;   /* m, no sphere stands out of the surface by more; 0: inscribed; default
                       INFINITY: as far as it fits best. SCREE_CLUMP_FITTED only */
  double ratio;     /* bubble: least radius, in radii of the largest; (0, 1], default 0.05 */
  double angle_deg; /* bubble: largest angle of intersection of two spheres, as PFC's `distance`;
                       0 (none overlap) to 180, default 150 */
  uint64_t seed;    /* ferellec: of the surface points' order; default 1 */
} scree_clump_options;
SCREE_API scree_clump_options scree_default_clump_options(void);

/* How far points of one surface are from another, m. */
typedef struct scree_clump_gap {
  double mean, maximum;
} scree_clump_gap;

/* A clump, and how well it stands for the body. Shares are of the body's own: volume, size L (the
 * diameter of the sphere of equal volume), principal moment. */
typedef struct scree_clump {
  size_t sphere_count;       /* of `spheres` */
  scree_sphere *spheres;     /* in the mesh's coordinates, the largest first */
  double iou;                /* intersection over union of the volumes, 0 to 1 */
  double union_volume;       /* m3, of the spheres' union */
  double volume_error;       /* (union - body) / body */
  double centroid_error;     /* distance of the centroids / L */
  double inertia_error;      /* worst of the principal moments, union against body */
  scree_clump_gap to_mesh;   /* from the union's surface to the body's */
  scree_clump_gap from_mesh; /* from the body's surface to the union's */
  double roughness;          /* m, root mean square of the union's height over the body, about its
                                mean (Rq of ISO 21920-2) */
  double slope_deg;          /* mean angle between both surfaces' normals: what grains rub with */
  double outside;            /* m, the most that a sphere stands out */
  size_t useless_count;      /* spheres whose removal costs less than 1e-4 of IoU */
  double volume_criterion;   /* 1 - iou + n / 200 */
  double distance_criterion; /* mean distance / L + n / 5000 */
} scree_clump;

/* Clumps of one body by their count, which ascends and so does IoU. Counts that gain less than
 * 1e-4 of IoU over a smaller one are left out: of a ball there is one clump. */
typedef struct scree_clumps {
  scree_clump_method method;
  size_t clump_count;
  scree_clump *clumps;
  size_t recommended;      /* index: least volume_criterion */
  size_t by_distance;      /* index: least distance_criterion */
  double size;             /* m, L */
  scree_measures measures; /* of the body: these mass properties go with every clump */
  double thickness;        /* m, a quarter of the surface has less wall behind it */
  double wall_cells; /* in cells of the distance grid; below 3 walls are not seen, and spheres are
                        the wrong shape for the body */
  scree_sphere *storage;
} scree_clumps;

/* Every count from 1 to options->most in one run. The mesh is closed and outward; one of a few
 * thousand triangles will do, for spheres show no finer detail. Deterministic, the same bits for
 * any number of threads; a turned mesh gives the same IoU within about 0.01. Fails with
 * SCREE_BAD_MESH (open, inside out, no volume), SCREE_BAD_ARGUMENT, SCREE_LIMIT (walls that the
 * grid does not see at all), SCREE_CANCELLED. Cost: about 10 s of one core for 100 spheres. Free
 * with scree_clumps_free. */
SCREE_API scree_status scree_clumps_make(const scree_mesh *mesh, const scree_clump_options *options,
                                         const scree_progress *progress, scree_clumps *clumps,
                                         scree_error *error);
SCREE_API void scree_clumps_free(scree_clumps *clumps);

/* The clump of so many spheres, or of the next smaller count there is. */
SCREE_API const scree_clump *scree_clumps_of_count(const scree_clumps *clumps, size_t count);
/* The smallest whose mean distance, both ways, is at most this share of L; NULL where none is. */
SCREE_API const scree_clump *scree_clumps_within(const scree_clumps *clumps, double tolerance);

/* A particle of one of the clumps, with the body's volume, centre and inertia. */
SCREE_API scree_status scree_clump_particle(const scree_clumps *clumps, const scree_clump *clump,
                                            scree_particle **particle, scree_error *error);
/* The same in one call: so many spheres, 1 to 300, or as many as the mesh has use for. */
SCREE_API scree_status scree_clump_fit(const scree_mesh *mesh, size_t count,
                                       const scree_progress *progress, scree_particle **particle,
                                       scree_error *error);

/* A sphere a line, x,y,z,radius below a line of words and the body's mass properties, in units of
 * unit_m metres, which a comment names: what scree_particle_clump_read reads. */
SCREE_API scree_status scree_spheres_write(const scree_clumps *clumps, const scree_clump *clump,
                                           double unit_m, const char *path, bool overwrite,
                                           scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
