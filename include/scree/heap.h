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
  char reason[128];                         /* "" where there is one */
  double sector_deg, sector_sd_deg;         /* 1: mean and SD over the sectors' flank lines */
  size_t sector_count, sector_total;        /*    sectors that gave a line, of how many: fewer than
                                                  asked for where they would be narrower than two
                                                  particles */
  double cone_deg, cone_rms;                /* 2: least-squares cone; RMS misfit, m */
  double cone_apex[3];                      /*    its apex, m */
  double silhouette_deg, silhouette_sd_deg; /* 3: mean and SD over the silhouettes' flanks */
  size_t flank_count;                       /*    flanks that gave a line */
  double spread_deg;                        /* between the largest and the least of the three */
  double volume_deg, volume_se_deg; /* of the cone with the heap's volume and height of centroid:
                                       the number of one heap that scatters least; its standard
                                       error, by leaving out each sector in turn */
  double axis[2];         /* of the heap: mean position weighted by the square of the height, m */
  double height;          /* m: mean within a particle size of the axis */
  double peak;            /* m: greatest height of all */
  double base_radius;     /* m: where the flank line of the rings' mean heights, fitted
                             in the band, meets the floor */
  double run_out;         /* m: the farthest occupied cell from the axis */
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

/* ---- Heaps that were measured ---- */

/* The floor in a scan: the plane that carries the heap. */
typedef struct scree_ground {
  double up[3], offset; /* its unit normal, towards the heap; points p of it: up . p = offset, m */
  double share;         /* of the scan's surface that lies in it */
  double rms;           /* m: scatter of that */
  double filled;        /* share of the heap's cells that were holes */
} scree_ground;

/* The height field of a scanned heap: an open or closed surface in any orientation, with some of
 * the floor around the heap. Finds the floor (random sample consensus, then least squares), turns
 * it level and takes the surface above it; holes get the surface of a soap film, and what is no
 * higher than three standard deviations of the floor's scatter is floor. cell: m, 0 for a 600th of
 * the scan's width. SCREE_BAD_MESH where no plane has 5 % of the surface in it and all but 2 % of
 * the rest on one side. Free *field with scree_height_field_free. The same bits for the same mesh.
 * Cost: linear in triangles and cells. */
SCREE_API scree_status scree_height_field_scan(const scree_mesh *scan, double cell,
                                               scree_ground *ground, scree_height_field *field,
                                               scree_error *error);

/* A heap seen from the side: heights over the ground. */
typedef struct scree_outline {
  size_t count;
  double *x, *z; /* m; x rises */
  double ruler;  /* m: of a picture, the length of what lay beside the heap as a ruler does; or 0 */
} scree_outline;
SCREE_API void scree_outline_free(scree_outline *outline);
/* Of a CSV: x, z, a point a line, at least three; a head `x [mm], z [mm]` says the unit, else it is
 * unit_m metres. SCREE_BAD_FILE with the line. */
SCREE_API scree_status scree_outline_read(const char *path, double unit_m, scree_outline *outline,
                                          scree_error *error);
/* Of a picture (rows from the top, three bytes a pixel) whose pixels are `pixel` m wide: the
 * largest piece that is unlike most of the uppermost row, dark or bright by the threshold of Otsu
 * (1979). The ground is the silhouette's top at both edges of the picture, or its lower side where
 * it does not reach them; the picture may be tilted. A bar beside the heap or at its foot is a
 * ruler, and left out. x is from the heap's axis. SCREE_BAD_FILE where greys are no silhouette, the
 * heap is cut off, or something else lies beside it. */
SCREE_API scree_status scree_outline_trace(const uint8_t *rgb, size_t width, size_t height,
                                           double pixel, scree_outline *outline,
                                           scree_error *error);
/* The greatest heights of a field at x, less `axis`. */
SCREE_API scree_status scree_outline_of_field(const scree_height_field *field, double axis,
                                              scree_outline *outline, scree_error *error);
/* scree_repose_measure of the solid that each side of the outline makes when turned about the
 * heap's axis: four sectors, two of each side, and one silhouette, the outline itself. Heights
 * below 0 are 0. cell: m, 0 for a 400th of the width. Of the options the counts are not used.
 * SCREE_BAD_FILE where an end is so high that a flank is missing. */
SCREE_API scree_status scree_outline_measure(const scree_outline *outline, double cell,
                                             const scree_repose_options *options,
                                             scree_repose *repose, scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
