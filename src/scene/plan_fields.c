/* What the tables of fields of a scene share. */
#include "scene/plan_fields.h"

#include <string.h>

size_t scree_plan_find(const void *items, size_t count, size_t size, const char *name) {
  for (size_t i = 0; i < count; i++) {
    const scree_place *place = (const void *)((const char *)items + i * size);
    if (!strcmp(place->name, name)) return i;
  }
  return count;
}

double scree_plan_unit(int unit) {
  static const double metres[] = {1, 1e-2, 1e-3, 1e-6, 0.0254, 0.3048, 1e3};
  return metres[unit];
}

scree_status scree_plan_one_of(const scree_reader *r, const scree_place *place, const bool *there,
                               size_t count, const char *names) {
  size_t found = 0;
  for (size_t i = 0; i < count; i++) found += there[i];
  if (found == 1) return SCREE_OK;
  return scree_fail_place(r, place, found ? "only one of %s may be given" : "needs one of %s",
                          names);
}

scree_status scree_plan_check_window(const scree_reader *r, const scree_place *place, double from,
                                     double until) {
  if (!given(&until) || from < until) return SCREE_OK;
  return scree_fail_place(r, place, "until %g s must be after from %g s", until, from);
}

scree_status scree_plan_check_corners(const scree_reader *r, const scree_place *place,
                                      const double *min, const double *max) {
  if (!given(min) || !given(max))
    return scree_fail_place(r, place, "needs min: [x, y, z] and max: [x, y, z]");
  for (int k = 0; k < 3; k++)
    if (!(min[k] < max[k]))
      return scree_fail_place(r, place, "min %g must be below max %g along %c", min[k], max[k],
                              "xyz"[k]);
  return SCREE_OK;
}

static scree_status check_box(const scree_reader *r, const void *record) {
  const scree_plan_box *b = record;
  return scree_plan_check_corners(r, &b->place, b->min, b->max);
}

SCREE_RECORD_TABLE(scree_plan_box, SCREE_PLAN_BOX, "a box", NULL, check_box)

SCREE_RECORD_TABLE(scree_plan_cylinder, SCREE_PLAN_CYLINDER, "a cylinder", NULL, NULL)

scree_status scree_plan_need_name(const scree_reader *r, const scree_place *place,
                                  const void *items, size_t item_count, size_t size,
                                  const char *what, const char *name) {
  const char *names[64] = {NULL};
  size_t count = 0;
  if (scree_plan_find(items, item_count, size, name) < item_count) return SCREE_OK;
  for (; count < item_count && count < 64; count++)
    names[count] = ((const scree_place *)(const void *)((const char *)items + count * size))->name;
  return scree_fail_name(r, place, what, name, names, count);
}

size_t scree_plan_kind(const scree_record *kind, const void *record) {
  size_t k = 0;
  while (!scree_field_is_given(&kind->fields[k], record)) k++;
  return k;
}

scree_status scree_plan_one_kind(const scree_reader *r, const scree_record *kind,
                                 const void *record, size_t count) {
  bool there[32];
  char names[256] = "";
  for (size_t k = 0; k < count; k++) {
    there[k] = scree_field_is_given(&kind->fields[k], record);
    SCREE_ADD_TEXT(names, "%s%s", k ? ", " : "", kind->fields[k].key);
  }
  return scree_plan_one_of(r, record, there, count, names);
}
