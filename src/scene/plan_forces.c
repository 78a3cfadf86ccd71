/* The fields of forces on bodies. */
#include "scene/plan_fields.h"

SCREE_RECORD_TABLE(scree_plan_drag, SCREE_PLAN_DRAG, "drag",
                   "the density and the viscosity of the fluid", NULL)

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
SCREE_RECORD_TABLE(scree_plan_force, SCREE_PLAN_FORCE, "a force", NULL, check_force)
