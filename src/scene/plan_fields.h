/* What the tables of fields of a scene share. */
#pragma once

#include "scene/plan.h"

static inline bool given(const double *value) {
  return !isnan(*value);
}

/* Exactly one of those must be given. */
scree_status scree_plan_one_of(const scree_reader *r, const scree_place *place, const bool *there,
                               size_t count, const char *names);
/* Whether exactly one of the first `count` fields, the kinds of such a record, is given. */
scree_status scree_plan_one_kind(const scree_reader *r, const scree_record *kind,
                                 const void *record, size_t count);
size_t scree_plan_kind(const scree_record *kind, const void *record);
/* Checks a record's corners, and another's `from` and `until`. */
scree_status scree_plan_check_corners(const scree_reader *r, const scree_place *place,
                                      const double *min, const double *max);
scree_status scree_plan_check_window(const scree_reader *r, const scree_place *place, double from,
                                     double until);

/* Fails unless another record of the scene has that name. */
scree_status scree_plan_need_name(const scree_reader *reader, const scree_place *place,
                                  const void *items, size_t item_count, size_t size,
                                  const char *what, const char *name);
#define SCREE_PLAN_NEED(reader, plan, list, what, name, place)                                     \
  scree_plan_need_name(reader, place, (plan)->list.items, (plan)->list.count,                      \
                       sizeof *(plan)->list.items, what, name)
