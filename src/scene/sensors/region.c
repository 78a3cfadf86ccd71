/* What is in a box: bodies whose centre is. */
#include "scene/sensors/sensor.h"

#include <string.h>

#define SCREE_PLAN_REGION(ROW, T) ROW(T, GROUP, box, scree_plan_box, "")
SCREE_RECORD_TYPE(scree_plan_region, SCREE_PLAN_REGION)
SCREE_RECORD_TABLE(scree_plan_region, SCREE_PLAN_REGION, "a region", "a box: {min: ..., max: ...}",
                   NULL)

static const scree_sensor_column columns[] = {{"count", "", SCREE_OF_ALL_AND_EACH},
                                              {"mass", "kg", SCREE_OF_ALL_AND_EACH},
                                              {"packing", "", SCREE_OF_ALL},
                                              {"mean_speed", "m/s", SCREE_OF_ALL},
                                              {"x", "m", SCREE_OF_ALL},
                                              {"y", "m", SCREE_OF_ALL},
                                              {"z", "m", SCREE_OF_ALL},
                                              {0}};

static scree_sensor_classes classes(const scree_scene *scene, const scree_scene_sensor *sensor) {
  (void)sensor;
  return scree_classes_by(scene, SCREE_BY_SIZE);
}

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  const scree_plan_box *box = sensor->plan->region->box;
  size_t width = scree_sensor_width(scene->named_count);
  double *count = at, *mass = at + width, speed = 0, solid = 0, volume = 1;
  vec3 middle = {0, 0, 0};
  (void)now, (void)error;
  memset(at, 0, 2 * width * sizeof *at);
  for (int k = 0; k < 3; k++) volume *= box->max[k] - box->min[k];
  scree_body body;
  for (size_t b = 0; scree_scene_next_body(scene, &b, &body); b++) {
    if (!scree_is_in(body.position, box->min, box->max)) continue;
    size_t shape = scene->shape_of.items[b];
    double m = scree_world_body_mass(scene->world, b);
    const bool counts = scree_scene_counts(scene, b);
    count[0] += counts, mass[0] += m;
    if (width > 1) count[1 + scree_scene_named(scene, shape)] += counts;
    if (width > 1) mass[1 + scree_scene_named(scene, shape)] += m;
    solid += scene->shapes[shape].volume;
    if (counts) speed += vec3_norm(vec3_load(body.velocity));
    middle = vec3_mad(middle, vec3_load(body.position), m);
  }
  at += 2 * width;
  *at++ = solid / volume;
  *at++ = count[0] > 0 ? speed / count[0] : NAN;
  vec3_store(at, vec3_scale(middle, 1 / mass[0])); /* of none NAN */
  return SCREE_OK;
}

static void reach(const scree_plan_sensor *plan, double low[3], double high[3]) {
  memcpy(low, plan->region->box->min, 3 * sizeof *low);
  memcpy(high, plan->region->box->max, 3 * sizeof *high);
}

const scree_sensor_kind scree_sensor_region = {
    .reach = reach, .columns = columns, .classes = classes, .read = read};
