/* The fields of forces on bodies. */
#include "scene/plan_fields.h"

#define AT(member) offsetof(scree_plan_drag, member)
static const scree_field drag_fields[] = {
    {"density", SCREE_FIELD_REAL, AT(density), 0, 1e6, "kg/m3", "of the fluid", NULL},
    {"viscosity", SCREE_FIELD_REAL, AT(viscosity), 1e-12, 1e9, "Pa s", "dynamic", NULL},
    {"velocity", SCREE_FIELD_VECTOR, AT(velocity), -1e3, 1e3, "m/s", "of the fluid", NULL},
    {"law", SCREE_FIELD_WORD, AT(law), 0, 0, "schiller-naumann|stokes",
     "of a sphere of equal volume", NULL},
    {"buoyancy", SCREE_FIELD_FLAG, AT(buoyancy), 0, 0, "", "the weight of the fluid lifts", NULL},
};
#undef AT
static scree_status check_drag(const scree_reader *r, const void *record) {
  const scree_plan_drag *d = record;
  if (given(&d->density) && given(&d->viscosity)) return SCREE_OK;
  return scree_fail_place(r, &d->place, "needs the density and the viscosity of the fluid");
}
static const scree_plan_drag drag_defaults = {
    .density = NAN, .viscosity = NAN, .velocity = {0, 0, 0}, .buoyancy = true};
static const scree_record drag_record = {"drag", FIELDS(drag_fields), sizeof(scree_plan_drag),
                                         &drag_defaults, check_drag};

#define AT(member) offsetof(scree_plan_force, member)
static const scree_field force_fields[] = {
    {"of", SCREE_FIELD_TEXTS, AT(of), 0, 0, "", "shapes or materials; not given: all", NULL},
    {"box", SCREE_FIELD_RECORD, AT(box), 0, 0, "", "where; not given: everywhere",
     &scree_plan_box_record},
    {"cylinder", SCREE_FIELD_RECORD, AT(cylinder), 0, 0, "", "likewise",
     &scree_plan_cylinder_record},
    WINDOW(scree_plan_force),
    {"force", SCREE_FIELD_VECTOR, AT(force), -1e12, 1e12, "N", "on each body", NULL},
    {"acceleration", SCREE_FIELD_VECTOR, AT(acceleration), -1e9, 1e9, "m/s2", "times its mass",
     NULL},
    {"per_volume", SCREE_FIELD_VECTOR, AT(per_volume), -1e15, 1e15, "N/m3", "times its volume",
     NULL},
    {"drag", SCREE_FIELD_RECORD, AT(drag), 0, 0, "", "of a fluid", &drag_record},
    {"by", SCREE_FIELD_WORD, AT(by), 0, 0, "x|y|z|t", "of the table (m or s)", NULL},
    {"table", SCREE_FIELD_TABLE, AT(table), 0, 0, "|",
     "[where or when, factor] of the force or of the fluid's velocity, linear between", NULL},
};
#undef AT

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
const scree_record scree_plan_force_record = {
    "a force", FIELDS(force_fields), sizeof(scree_plan_force), &force_defaults, check_force};
