/* The angle of a surface, seen along an axis. */
#include "scene/sensors/sensor.h"

#include <string.h>

#define SCREE_PLAN_SLOPE(ROW, T)                                                                   \
  ROW(T, DIRECTION, axis, (1, 0, 0), "the surface is seen along it")                               \
  ROW(T, GROUP, box, scree_plan_box, "of the bodies in it; not given: about the middle of all")
SCREE_RECORD_TYPE(scree_plan_slope, SCREE_PLAN_SLOPE)
SCREE_RECORD_TABLE(scree_plan_slope, SCREE_PLAN_SLOPE, "a slope", NULL, NULL)

static const double degree = 57.29577951308232;
static const double surface_reach = 1.5; /* standard deviations of the bed's width about its
                                            middle: near the walls the surface bends */
static const double surface_cell = 0.25; /* of a body's size */
enum { MOST_ACROSS = 500 };              /* cells */

/* The turn from one unit vector to another; half a turn is about `axis`, across both. */
static quat turn_between(vec3 from, vec3 to, vec3 axis) {
  vec3 c = vec3_cross(from, to);
  quat q = {1 + vec3_dot(from, to), c.x, c.y, c.z};
  return q.w > 1e-9 ? quat_unit(q) : (quat){0, axis.x, axis.y, axis.z};
}

/* The bed as seen along the axis: that is the plane of x and z, with z up. */
typedef struct bed {
  quat turn;
  double x, y, floor, width, size; /* its middle; its lowest, standard deviation, mean size */
} bed;

/* Whether the body is of the bed, and how it is seen. */
static bool see_body(const scree_scene *scene, const scree_plan_box *box, const bed *seen, size_t b,
                     scree_body *as_seen) {
  scree_body body;
  if (scree_world_body_removed(scene->world, b)) return false;
  scree_world_get_body(scene->world, b, &body);
  if (box && !scree_is_in(body.position, box->min, box->max)) return false;
  mat3 turn = quat_to_mat3(seen->turn);
  quat q = quat_mul(seen->turn, scree_body_turn(&body));
  vec3_store(body.position, mat3_mul_vec(&turn, vec3_load(body.position)));
  memcpy(body.orientation, (double[4]){q.w, q.x, q.y, q.z}, sizeof body.orientation);
  *as_seen = body;
  return true;
}

/* false: there is none. */
static bool find_bed(const scree_scene *scene, const scree_plan_slope *plan, bed *seen) {
  vec3 axis = vec3_unit(vec3_load(plan->axis)), g = vec3_load(scene->plan.gravity);
  vec3 up = vec3_unit(vec3_mad(vec3_neg(g), axis, vec3_dot(g, axis))), z = {0, 0, 1};
  quat first = turn_between(up, z, axis);
  mat3 upright = quat_to_mat3(first);
  quat second = turn_between(mat3_mul_vec(&upright, axis), (vec3){0, -1, 0}, z);
  *seen = (bed){.turn = quat_mul(second, first), .floor = INFINITY};
  double count = 0, squares = 0;
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    scree_body body;
    if (!see_body(scene, plan->box, seen, b, &body)) continue;
    const scree_scene_shape *shape = &scene->shapes[scene->shape_of.items[b]];
    double away = body.position[0] - seen->x;
    count++;
    seen->x += away / count;
    squares += away * (body.position[0] - seen->x);
    seen->y += (body.position[1] - seen->y) / count;
    seen->size += (scree_body_size(scene, b) - seen->size) / count;
    seen->floor = fmin(seen->floor, body.position[2] - shape->extent.radius);
  }
  seen->width = count > 0 ? sqrt(squares / count) : 0;
  return seen->width > seen->size;
}

/* A line by least squares through the heights of all cells where something lies. */
static double slope_of(const scree_height_field *field) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (size_t j = 0; j < field->rows; j++)
    for (size_t i = 0; i < field->columns; i++) {
      double x = ((double)i + 0.5) * field->cell, h = field->height[j * field->columns + i];
      if (h > 0) n++, sx += x, sy += h, sxx += x * x, sxy += x * h;
    }
  double spread = n * sxx - sx * sx;
  return spread > 0 ? degree * atan((n * sxy - sx * sy) / spread) : NAN;
}

/* The field is square about the bed's middle, so it is cut off along the axis where that is long.
 */
static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  const scree_plan_slope *plan = sensor->plan->slope;
  bed seen;
  scree_height_field field;
  (void)now;
  *at = NAN;
  if (!find_bed(scene, plan, &seen)) return SCREE_OK;
  double half = surface_reach * seen.width;
  double cell = fmax(surface_cell * seen.size, 2 * half / MOST_ACROSS);
  SCREE_TRY(scree_height_field_create(seen.x, seen.y, half, cell, &field, error));
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    scree_body body;
    if (!see_body(scene, plan->box, &seen, b, &body)) continue;
    scree_raise_body(scene, b, &body, seen.floor, &field);
  }
  *at = slope_of(&field);
  scree_height_field_free(&field);
  return SCREE_OK;
}

static const scree_sensor_column columns[] = {{"angle_deg", "deg", SCREE_OF_ALL}, {0}};

static scree_status check(const scree_reader *r, const scree_plan *plan,
                          const scree_plan_sensor *s) {
  vec3 a = vec3_load(s->slope->axis), g = vec3_load(plan->gravity);
  if (vec3_norm(vec3_cross(a, g)) > 1e-6 * vec3_norm(a) * vec3_norm(g)) return SCREE_OK;
  return scree_fail_place(r, &s->place, "axis along gravity: from above a surface has no slope");
}

const scree_sensor_kind scree_sensor_slope = {.check = check, .columns = columns, .read = read};
