/* What a build may lack. */
#ifndef SCREE_BASE_PARTS_H
#define SCREE_BASE_PARTS_H

#include "scree.h"

/* What a build may lack. */
typedef enum scree_build_part {
  SCREE_BUILD_PICTURES, /* figures as PNG, SVG and PDF (cairo) */
  SCREE_BUILD_RAYS,     /* rendered pictures (Embree) */
  SCREE_BUILD_STUDY,    /* scree_study_... (SQLite) */
  SCREE_BUILD_IMPORT,   /* COLLADA, X3D, AMF, FBX and 3DS (assimp) */
  SCREE_BUILD_COUNT
} scree_build_part;
bool scree_build_has(scree_build_part part);
/* A line about it, for people; "" beyond the last. */
const char *scree_build_text(scree_build_part part);

#endif
