/* What the tables of fields of a scene share. */
#pragma once

#include "base/schema_rows.h"
#include "scene/plan.h"

#include <math.h>

#define NONE                                                                                       \
  { NAN, NAN, NAN }

/* A window of time, of a record with `from` and `until`. */
#define WINDOW(type)                                                                               \
  {"from", SCREE_FIELD_REAL, offsetof(type, from), 0, 1e9, "s", "", NULL}, {                       \
    "until", SCREE_FIELD_REAL, offsetof(type, until), 0, 1e9, "s", "not given: to the end", NULL   \
  }

static inline bool given(const double *value) {
  return !isnan(*value);
}

/* plan.c: exactly one of those must be given. */
scree_status scree_plan_one_of(const scree_reader *r, const scree_place *place, const bool *there,
                               size_t count, const char *names);
scree_status scree_plan_check_direction(const scree_reader *r, const scree_place *place,
                                        const char *what, const double *v);
/* Of a record with `from` and `until`. */
scree_status scree_plan_check_window(const scree_reader *r, const scree_place *place, double from,
                                     double until);
extern const scree_record scree_plan_box_record, scree_plan_cylinder_record;
/* plan_sensors.c */
extern const scree_record scree_plan_sensor_record;
