/* How true the levels of a curve are to the scan. */
#ifndef SCREE_FIDELITY_H
#define SCREE_FIDELITY_H

#include "scree/simplify.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The errors of a level, each a share. Lengths are shares of D = sqrt(S / pi), S the scan's area:
 * the diameter of the sphere of that area. */
#define SCREE_SHAPE_ERROR_LIST(X)                                                                  \
  X(AREA, "area")           /* |S - S_clean| / S_clean, S_clean the scan's area without noise */   \
  X(VOLUME, "volume")       /* |V - Vm| / |Vm| */                                                  \
  X(HAUSDORFF, "hausdorff") /* the larger of both ways, over D */                                  \
  X(MEAN, "mean_distance")  /* the larger of both ways, over D */                                  \
  X(INERTIA, "inertia")     /* Frobenius norm of the tensors' difference over the scan's */        \
  X(WIDTHS, "widths")       /* largest relative change of the width along 99 fixed directions, the \
                               scan's box axes and between them */                                 \
  X(THICKNESS, "thickness") /* mean over the scan's walls of the distance to the level over the    \
                               wall's thickness there */                                           \
  X(THINNEST, "thinnest")   /* relative change of the first percentile of the walls' thickness */  \
  X(CONVEXITY, "convexity") /* relative change of volume / hull volume */                          \
  X(NORMALS, "normals")     /* mean angle between the normals of scan and level, over pi */

typedef enum scree_shape_error {
#define SCREE_SHAPE_ERROR_ENUM(name, text) SCREE_ERROR_##name,
  SCREE_SHAPE_ERROR_LIST(SCREE_SHAPE_ERROR_ENUM)
#undef SCREE_SHAPE_ERROR_ENUM
      SCREE_SHAPE_ERROR_COUNT
} scree_shape_error;

/* The name above, for example "mean_distance". */
SCREE_API const char *scree_shape_error_name(scree_shape_error which);

/* The errors of several levels, and what the scan itself is like. */
typedef struct scree_fidelity scree_fidelity;

/* NaN where the scan has none of it, as the thickness of a body without walls. */
SCREE_API double scree_fidelity_error(const scree_fidelity *fidelity, size_t row,
                                      scree_shape_error which);
/* The point of scan or level that is farthest from the other surface, m. */
SCREE_API void scree_fidelity_farthest(const scree_fidelity *fidelity, size_t row, double at[3]);

/* Changes with their sign, relative to the scan: below 0 where the level has less. */
#define SCREE_CHANGE_LIST(X)                                                                       \
  X(AREA, "area")         /* against the area without noise */                                     \
  X(VOLUME, "volume")     /* */                                                                    \
  X(INERTIA, "inertia")   /* of the tensor's trace */                                              \
  X(LENGTH, "length")     /* widths along the axes of the scan's least box: */                     \
  X(WIDTH, "width")       /* */                                                                    \
  X(HEIGHT, "height")     /* */                                                                    \
  X(THINNEST, "thinnest") /* first percentile of the thickness */                                  \
  X(CONVEXITY, "convexity")

typedef enum scree_shape_change {
#define SCREE_CHANGE_ENUM(name, text) SCREE_CHANGE_##name,
  SCREE_CHANGE_LIST(SCREE_CHANGE_ENUM)
#undef SCREE_CHANGE_ENUM
      SCREE_CHANGE_COUNT
} scree_shape_change;

SCREE_API double scree_fidelity_change(const scree_fidelity *fidelity, size_t row,
                                       scree_shape_change which);

/* What is known of the scan. */
typedef enum scree_scan_fact {
  SCREE_SCAN_LENGTH,     /* D, m */
  SCREE_SCAN_NOISE,      /* standard deviation of the scanner's noise, m; 0 where none is seen, NaN
                            where the mesh is too coarse, or too rough, to tell it from shape */
  SCREE_SCAN_CLEAN_AREA, /* without what noise adds, m2 */
  SCREE_SCAN_THICKNESS,  /* median thickness of the walls, m; NaN without walls */
  SCREE_SCAN_THINNEST,   /* first percentile of it, m */
  SCREE_SCAN_BOX_LENGTH, /* the three principal dimensions, m */
  SCREE_SCAN_BOX_WIDTH,
  SCREE_SCAN_BOX_HEIGHT,
} scree_scan_fact;
SCREE_API double scree_fidelity_scan(const scree_fidelity *fidelity, scree_scan_fact which);

#ifdef __cplusplus
}
#endif
#endif
