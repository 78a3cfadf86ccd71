/* Shaking along a line by a sine. */
#include "scene/motions/kind.h"

#include <string.h>

#define SCREE_PLAN_VIBRATE(ROW, T)                                                                 \
  ROW(T, DIRECTION, along, (0, 0, 1), "")                                                          \
  ROW(T, REAL, amplitude, NAN, 0, 1e3, "m", "")                                                    \
  ROW(T, REAL, frequency, NAN, 0, 1e5, "Hz", "")                                                   \
  ROW(T, REAL, phase, 0, -7, 7, "rad", "of the sine")
SCREE_RECORD_TYPE(scree_plan_vibrate, SCREE_PLAN_VIBRATE)
SCREE_RECORD_TABLE(scree_plan_vibrate, SCREE_PLAN_VIBRATE, "vibrate", "amplitude and frequency",
                   NULL)

static size_t put(const scree_plan_geometry *g, const scree_plan_motion *plan, size_t copy,
                  scree_wall_motion *m) {
  const scree_plan_vibrate *v = plan->vibrate;
  (void)g, (void)copy;
  memcpy(m->axis, v->along, sizeof m->axis);
  scree_motion_take_sine(m, v->amplitude, v->frequency, v->phase);
  return 1;
}

static double fastest(const scree_scene *scene, size_t geometry, const scree_plan_motion *plan) {
  (void)scene, (void)geometry;
  return scree_full_turn * plan->vibrate->frequency * fabs(plan->vibrate->amplitude);
}

const scree_motion_kind scree_motion_vibrate = {.put = put, .fastest = fastest};
