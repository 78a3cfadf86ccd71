/* What takes more than a sum to measure: the angle of repose, the slope of a surface. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "heap/repose.h"

#include <string.h>

static const double degree = 57.29577951308232;

/* ---- the angle of repose ---- */

/* The bodies of a pile, raised and measured. */
typedef struct heap_of_bodies {
  scree_repose repose;
  size_t body_count;
  double solid, size; /* m3, of the bodies; m, of one */
} heap_of_bodies;

static void raise_body(const scree_scene *scene, size_t b, const scree_body *body, double floor_z,
                       scree_height_field *field) {
  scree_particle *particle = scree_world_body_particle(scene->world, b);
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  if (m.kind == SCREE_PARTICLE_MESH) {
    scree_height_field_add_mesh(field, scree_particle_mesh(particle), body->position,
                                body->orientation, floor_z);
    return;
  }
  mat3 turn = quat_to_mat3(scree_body_turn(body));
  for (size_t i = 0; i < m.point_count; i++) {
    double local[3], centre[3], radius;
    scree_particle_point(particle, i, local, &radius);
    vec3_store(centre, vec3_add(mat3_mul_vec(&turn, vec3_load(local)), vec3_load(body->position)));
    scree_height_field_add_sphere(field, centre, radius, floor_z);
  }
}

/* Above the floor and, where there is a disc, over it: not on its way down beside it. */
static bool is_of_pile(const scree_scene *scene, const scree_plan_pile *plan, size_t b,
                       scree_body *body) {
  if (scree_world_body_removed(scene->world, b)) return false;
  scree_world_get_body(scene->world, b, body);
  return body->position[2] >= plan->floor &&
         (isnan(plan->disc) || hypot(body->position[0], body->position[1]) <= plan->disc);
}

/* Diameter of the sphere of the body's volume. */
static double size_of(const scree_scene *scene, size_t b) {
  return 2 * cbrt(scene->shapes[scene->shape_of.items[b]].volume / 4.18879020478639);
}

typedef struct extent {
  double centre[2], reach, size; /* mean position; of the farthest; mean size */
} extent;

static extent find_extent(const scree_scene *scene, const scree_plan_pile *plan) {
  extent e = {0};
  size_t count = 0;
  scree_body body;
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    if (!is_of_pile(scene, plan, b, &body)) continue;
    for (int k = 0; k < 2; k++) e.centre[k] += body.position[k];
    e.size += size_of(scene, b);
    count++;
  }
  if (count == 0) return e;
  e.size /= (double)count;
  for (int k = 0; k < 2; k++) e.centre[k] /= (double)count;
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    if (!is_of_pile(scene, plan, b, &body)) continue;
    double away = hypot(body.position[0] - e.centre[0], body.position[1] - e.centre[1]);
    e.reach = fmax(e.reach, away + scene->shapes[scene->shape_of.items[b]].extent.radius);
  }
  e.reach += e.size;
  return e;
}

/* Where the plan says how large it may be, it is the disc that the field covers. */
static extent take_extent(const scree_scene *scene, const scree_plan_pile *plan) {
  bool known = !isnan(plan->disc) && !isnan(plan->size);
  extent e = known ? (extent){0} : find_extent(scene, plan);
  if (!isnan(plan->size)) e.size = plan->size;
  if (isnan(plan->disc)) return e;
  e.centre[0] = e.centre[1] = 0;
  e.reach = isnan(plan->reach) ? plan->disc + 2 * e.size : plan->reach;
  return e;
}

static scree_status measure_heap(const scree_scene *scene, const scree_plan_pile *plan,
                                 heap_of_bodies *heap, scree_error *error) {
  extent e = take_extent(scene, plan);
  heap_of_bodies made = {.size = e.size};
  scree_height_field field;
  if (!(e.size > 0)) {
    *heap = made;
    return SCREE_OK;
  }
  SCREE_TRY(scree_height_field_create(e.centre[0], e.centre[1], e.reach,
                                      plan->cell > 0 ? plan->cell : 0.1 * e.size, &field, error));
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    scree_body body;
    if (!is_of_pile(scene, plan, b, &body)) continue;
    made.solid += scene->shapes[scene->shape_of.items[b]].volume;
    made.body_count++;
    raise_body(scene, b, &body, plan->floor, &field);
  }
  scree_repose_options o = scree_default_repose_options();
  o.sector_count = plan->sectors;
  o.band_low = plan->band_low;
  o.band_high = plan->band_high;
  o.particle_size = e.size;
  scree_status status = scree_repose_measure(&field, &o, &made.repose, error);
  scree_height_field_free(&field);
  if (status == SCREE_OK) *heap = made;
  return status;
}

static scree_pile pile_of(const heap_of_bodies *heap, double size) {
  const scree_repose *r = &heap->repose;
  scree_pile p = {.repose = *r, .body_count = heap->body_count, .size = size};
  /* plates side by side fill what is under them: there the field's own error may pass 1 */
  p.packing_fraction = r->envelope_volume > 0 ? fmin(1, heap->solid / r->envelope_volume) : NAN;
  if (heap->body_count) return p;
  p.repose = scree_no_repose();
  snprintf(p.repose.reason, sizeof p.repose.reason, "there are no bodies");
  return p;
}

scree_status scree_scene_put_pile(const scree_scene *scene, const scree_plan_pile *plan, double *at,
                                  scree_error *error) {
  heap_of_bodies heap;
  SCREE_TRY(measure_heap(scene, plan, &heap, error));
  scree_pile p = pile_of(&heap, plan->size);
  const scree_repose *r = &p.repose;
  const double values[SCREE_PILE_COLUMNS] = {
      r->sector_deg,  r->cone_deg,        r->silhouette_deg,    r->height,
      r->base_radius, r->sector_sd_deg,   r->silhouette_sd_deg, r->volume_deg,
      r->run_out,     p.packing_fraction, (double)p.body_count};
  memcpy(at, values, sizeof values);
  return SCREE_OK;
}

/* The sensor of pile `index`; NULL past the last. */
static const scree_plan_sensor *pile_at(const scree_scene *scene, size_t index) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++)
    if (scene->sensors[i].plan->pile && index-- == 0) return scene->sensors[i].plan;
  return NULL;
}

const char *scree_scene_pile_name(const scree_scene *scene, size_t index) {
  const scree_plan_sensor *sensor = pile_at(scene, index);
  return sensor ? sensor->place.name : NULL;
}

scree_pile_settings scree_scene_pile_settings(const scree_scene *scene, size_t index) {
  const scree_plan_pile *p = pile_at(scene, index)->pile;
  return (scree_pile_settings){p->cell, p->sectors, p->band_low, p->band_high};
}

scree_status scree_scene_measure_pile(const scree_scene *scene, size_t index,
                                      const scree_pile_settings *settings, scree_pile *pile,
                                      scree_error *error) {
  scree_plan_pile plan = *pile_at(scene, index)->pile;
  if (settings) {
    plan.cell = settings->cell;
    plan.sectors = settings->sectors;
    plan.band_low = settings->band_low;
    plan.band_high = settings->band_high;
  }
  if (!(plan.band_low >= 0 && plan.band_low < plan.band_high && plan.band_high <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "a pile: the band from %g to %g: must rise within 0 to 1", plan.band_low,
                      plan.band_high);
  if (plan.sectors < 1 || !(plan.cell >= 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "a pile: %zu sectors, cells of %g m", plan.sectors,
                      plan.cell);
  heap_of_bodies heap;
  const scree_place nowhere = {.path = ""};
  if (!isnan(plan.size))
    SCREE_TRY(scree_scene_check_cell(scene, &nowhere, plan.cell, plan.size, error));
  SCREE_TRY(measure_heap(scene, &plan, &heap, error));
  *pile = pile_of(&heap, heap.size);
  return SCREE_OK;
}

/* ---- the slope of a surface ---- */

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
    seen->size += (size_of(scene, b) - seen->size) / count;
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
scree_status scree_scene_measure_slope(const scree_scene *scene, const scree_plan_slope *plan,
                                       double *at, scree_error *error) {
  bed seen;
  scree_height_field field;
  *at = NAN;
  if (!find_bed(scene, plan, &seen)) return SCREE_OK;
  double half = surface_reach * seen.width;
  double cell = fmax(surface_cell * seen.size, 2 * half / MOST_ACROSS);
  SCREE_TRY(scree_height_field_create(seen.x, seen.y, half, cell, &field, error));
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    scree_body body;
    if (!see_body(scene, plan->box, &seen, b, &body)) continue;
    raise_body(scene, b, &body, seen.floor, &field);
  }
  *at = slope_of(&field);
  scree_height_field_free(&field);
  return SCREE_OK;
}
