/* What a build may lack. */
#pragma once

#include "scree.h"

/* A line about it, for people; "" beyond the last. */
const char *scree_build_text(scree_build_part part);
