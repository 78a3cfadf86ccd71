/* What the tables of fields of a scene share. */
#pragma once

#include "scene/plan.h"

static inline bool given(const double *value) {
  return !isnan(*value);
}

/* plan.c: exactly one of those must be given. */
scree_status scree_plan_one_of(const scree_reader *r, const scree_place *place, const bool *there,
                               size_t count, const char *names);
/* Of a record with `from` and `until`. */
scree_status scree_plan_check_window(const scree_reader *r, const scree_place *place, double from,
                                     double until);
