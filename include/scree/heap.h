/* Heap: height fields and the angle of repose. */
#ifndef SCREE_HEAP_H
#define SCREE_HEAP_H

#include "scree/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

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
  double particle_size; /* m: widths of bins and sectors keep to it, and a heap below 1.5 of it in
                           height, or sixteen round, gives no angle; 0 (default): not known */
} scree_repose_options;

SCREE_API scree_repose_options scree_default_repose_options(void);

/* Angle of repose of a heap, three ways, and its size. Angles in degrees, NaN where there is none.
 */
typedef struct scree_repose {
  bool heap; /* false: no heap to speak of, or too small a one, all angles NaN; `reason` says why */
  char reason[128];
  double sector_deg, sector_sd_deg;         /* 1: mean and SD over the sectors' flank lines */
  size_t sector_count, sector_total;        /*    sectors that gave a line, of how many: fewer than
                                                  asked for where they would be narrower than two
                                                  particles */
  double cone_deg, cone_rms;                /* 2: least-squares cone; RMS misfit, m */
  double cone_apex[3];                      /*    its apex, m */
  double silhouette_deg, silhouette_sd_deg; /* 3: mean and SD over the silhouettes' flanks */
  size_t flank_count;                       /*    flanks that gave a line */
  double spread_deg;                        /* between the largest and the least of the three */
  double volume_deg;  /* cross-check: of the cone with the heap's volume and height of centroid */
  double axis[2];     /* of the heap: mean position weighted by the square of the height, m */
  double height;      /* m: mean within a particle size of the axis */
  double peak;        /* m: greatest height of all */
  double base_radius; /* m: where the flank line of the rings' mean heights, fitted
                         in the band, meets the floor */
  double run_out;     /* m: the farthest occupied cell from the axis */
  double envelope_volume; /* m^3 under the field: packing fraction = solid over this */
} scree_repose;

/* Measures the field. The ways (docs/background/repose.md): 1, in each sector a straight line
 * through the mean heights of radial bins where the falling profile is within the band; 2, a cone h
 * = H - m |r - r0| fitted by Gauss-Newton to the cells where it is itself within the band, apex
 * free; 3, the outline seen from the side, a line on each flank within the band. SCREE_BAD_ARGUMENT
 * for lengths that are not finite or beyond 1e30 m. Cost: linear in the cells times the
 * silhouettes. */
SCREE_API scree_status scree_repose_measure(const scree_height_field *field,
                                            const scree_repose_options *options,
                                            scree_repose *repose, scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
