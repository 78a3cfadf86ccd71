/* The fields of forces on bodies. */
#include "scene/plan_fields.h"

#define RECORD scree_plan_drag
static const scree_field drag_fields[] = {
    REAL(density, 0, 1e6, "kg/m3", "of the fluid"),
    REAL(viscosity, 1e-12, 1e9, "Pa s", "dynamic"),
    VECTOR(velocity, -1e3, 1e3, "m/s", "of the fluid"),
    WORD(law, "schiller-naumann|stokes", "of a sphere of equal volume"),
    FLAG(buoyancy, "the weight of the fluid lifts"),
};
#undef RECORD
static scree_status check_drag(const scree_reader *r, const void *record) {
  const scree_plan_drag *d = record;
  if (given(&d->density) && given(&d->viscosity)) return SCREE_OK;
  return scree_fail_place(r, &d->place, "needs the density and the viscosity of the fluid");
}
static const scree_plan_drag drag_defaults = {
    .density = NAN, .viscosity = NAN, .velocity = {0, 0, 0}, .buoyancy = true};
static const scree_record drag_record =
    SCREE_RECORD("drag", drag_fields, drag_defaults, check_drag);

#define RECORD scree_plan_force
static const scree_field force_fields[] = {
    TEXTS(of, "shapes or materials; not given: all"),
    GROUP(box, "where; not given: everywhere", &scree_plan_box_record),
    GROUP(cylinder, "likewise", &scree_plan_cylinder_record),
    WINDOW(scree_plan_force),
    VECTOR(force, -1e12, 1e12, "N", "on each body"),
    VECTOR(acceleration, -1e9, 1e9, "m/s2", "times its mass"),
    VECTOR(per_volume, -1e15, 1e15, "N/m3", "times its volume"),
    GROUP(drag, "of a fluid", &drag_record),
    WORD(by, "x|y|z|t", "of the table (m or s)"),
    TABLE(table, "|",
          "[where or when, factor] of the force or of the fluid's velocity, linear between"),
};
#undef RECORD

static scree_status check_force(const scree_reader *r, const void *record) {
  const scree_plan_force *f = record;
  const bool there[] = {given(f->force), given(f->acceleration), given(f->per_volume),
                        f->drag != NULL};
  scree_status status =
      scree_plan_one_of(r, &f->place, there, 4, "force, acceleration, per_volume, drag");
  if (status == SCREE_OK && f->box && f->cylinder)
    status = scree_fail_place(r, &f->place, "only one of box, cylinder may be given");
  if (status == SCREE_OK && f->cylinder &&
      (!given(&f->cylinder->radius) || !given(f->cylinder->at)))
    status = scree_fail_place(r, &f->cylinder->place, "needs a radius and at: [x, y, z]");
  return status == SCREE_OK ? scree_plan_check_window(r, &f->place, f->from, f->until) : status;
}
static const scree_plan_force force_defaults = {
    .until = NAN, .force = NONE, .acceleration = NONE, .per_volume = NONE};
const scree_record scree_plan_force_record =
    SCREE_RECORD("a force", force_fields, force_defaults, check_force);
