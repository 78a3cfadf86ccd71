/* Shared by check and repair; the interface is in scree/check.h. */
#pragma once

#include "base/error.h"

/* A coordinate is not finite, or beyond what exact predicates bear. */
bool scree_vertex_is_bad(const double *position);

bool scree_defect_is_grave(scree_defect defect);
