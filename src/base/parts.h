/* What a build may lack. */
#ifndef SCREE_BASE_PARTS_H
#define SCREE_BASE_PARTS_H

#include "scree.h"

/* A line about it, for people; "" beyond the last. */
const char *scree_build_text(scree_build_part part);

#endif
