/* The angle of repose of a pile, three ways. */
#include "scene/sensors/sensor.h"

#include "base/alloc.h"
#include "heap/repose.h"

#include <string.h>

#define SCREE_PLAN_PILE(ROW, T)                                                                    \
  ROW(T, REAL, floor, 0, -1e6, 1e6, "m", "height of what the pile stands on")                      \
  ROW(T, REAL, cell, 0, 0, 1e3, "m", "of the height field; 0: a tenth of the size")                \
  ROW(T, REAL, disc, NAN, 1e-9, 1e6, "m",                                                          \
      "radius about the origin; bodies beyond are not of the pile; not given: all are")            \
  ROW(T, REAL, reach, NAN, 1e-9, 1e6, "m",                                                         \
      "of the height field with a disc; not given: one and a half of the longest shape beyond it") \
  ROW(T, REAL, size, NAN, 1e-9, 1e3, "m",                                                          \
      "of a body; not given: the mean of what layers pour, else of those there")                   \
  ROW(T, COUNT, sectors, 36, 1, 3600, "in azimuth")                                                \
  ROW(T, REAL, band_low, 0.2, 0, 1, "", "of the height: the flank begins")                         \
  ROW(T, REAL, band_high, 0.8, 0, 1, "", "and ends")                                               \
  ROW(T, REAL, every, NAN, 0, 1e9, "s",                                                            \
      "between lines of the series that have it; 0: only the last; not given: all")                \
  ROW(T, TEXTS, during, "phases; not given: all")
SCREE_RECORD_TYPE(scree_plan_pile, SCREE_PLAN_PILE)
static scree_status check_band(const scree_reader *r, const void *record) {
  const scree_plan_pile *p = record;
  if (p->band_low < p->band_high) return SCREE_OK;
  return scree_fail_place(r, &p->place, "band_low %g must be below band_high %g", p->band_low,
                          p->band_high);
}
SCREE_RECORD_TABLE(scree_plan_pile, SCREE_PLAN_PILE, "a pile", NULL, check_band)

static const double rim = 1.5; /* of the longest body: measured beyond a disc */

/* The bodies of a pile, raised and measured. */
typedef struct heap_of_bodies {
  scree_repose repose;
  size_t body_count;
  double solid, size; /* m3, of the bodies; m, of one */
} heap_of_bodies;

/* Whether a body is above the floor and, where there is a disc, over it: not on its way down beside
 * it. */
static bool is_of_pile(const scree_scene *scene, const scree_plan_pile *plan, size_t b,
                       scree_body *body) {
  if (scree_world_body_removed(scene->world, b)) return false;
  scree_world_get_body(scene->world, b, body);
  return body->position[2] >= plan->floor &&
         (isnan(plan->disc) || hypot(body->position[0], body->position[1]) <= plan->disc);
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
    e.size += scree_body_size(scene, b);
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
  if (!(e.size > 0 && e.reach > 0)) { /* there are no bodies */
    *heap = made;
    return SCREE_OK;
  }
  SCREE_TRY(scree_height_field_create(e.centre[0], e.centre[1], e.reach,
                                      plan->cell > 0 ? plan->cell : 0.1 * e.size, &field, error));
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    scree_body body;
    if (!is_of_pile(scene, plan, b, &body)) continue;
    made.solid += scene->shapes[scene->shape_of.items[b]].volume;
    made.body_count += scree_scene_counts(scene, b);
    scree_raise_body(scene, b, &body, plan->floor, &field);
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

scree_pile scree_no_pile(void) {
  return (scree_pile){.repose = scree_no_repose(), .packing_fraction = NAN, .size = NAN};
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

/* ---- the fields that follow from the particles ---- */

static const double coarsest_cell = 0.5; /* sizes: a coarser height field shows no pile */

static scree_status check_cell(const scree_scene *scene, const scree_place *place, double cell,
                               double size, scree_error *error) {
  if (cell <= coarsest_cell * size) return SCREE_OK;
  return scree_scene_fail(scene, place, error,
                          "cell %g m: at most half the mean particle size, %.4g m", cell,
                          coarsest_cell * size);
}

/* The longest of all shapes, with what the layers keep free around them. */
static double longest_shape(const scree_scene *scene, double clearance) {
  double longest = 0;
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++) {
    scree_placement p = scree_placement_of(scene->shapes[i].particle, clearance);
    longest = fmax(longest, 2 * fmin(p.radius, vec3_norm(p.half)));
  }
  return longest;
}

static void take(double *value, double usual) {
  if (isnan(*value)) *value = usual;
}

/* Layers of the first inlet that has any. */
static const scree_scene_layers *layers_of(const scree_scene *scene) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    if (scene->inlets[i].plan->layers) return &scene->inlets[i].layers;
  return NULL;
}

static scree_status complete(const scree_scene *scene, const scree_plan_sensor *sensor,
                             scree_error *error) {
  const scree_scene_layers *layers = layers_of(scene);
  scree_plan_pile *pile = sensor->pile;
  if (layers) take(&pile->size, layers->size);
  if (!isnan(pile->disc))
    take(&pile->reach, pile->disc + rim * longest_shape(scene, layers ? layers->clearance : 0));
  if (isnan(pile->size)) return SCREE_OK;
  return check_cell(scene, &pile->place, pile->cell, pile->size, error);
}

static scree_status check(const scree_reader *r, const scree_plan *plan,
                          const scree_plan_sensor *s) {
  for (size_t k = 0; k < s->pile->during.count; k++)
    SCREE_TRY(SCREE_PLAN_NEED(r, plan, phases, "phase", s->pile->during.items[k], &s->pile->place));
  return SCREE_OK;
}

/* ---- the series ---- */

static const scree_sensor_column columns[] = {{"sector_deg", "deg", SCREE_OF_ALL},
                                              {"cone_deg", "deg", SCREE_OF_ALL},
                                              {"silhouette_deg", "deg", SCREE_OF_ALL},
                                              {"height", "m", SCREE_OF_ALL},
                                              {"base_radius", "m", SCREE_OF_ALL},
                                              {"sector_sd_deg", "deg", SCREE_OF_ALL},
                                              {"silhouette_sd_deg", "deg", SCREE_OF_ALL},
                                              {"volume_deg", "deg", SCREE_OF_ALL},
                                              {"run_out", "m", SCREE_OF_ALL},
                                              {"packing", "", SCREE_OF_ALL},
                                              {"count", "", SCREE_OF_ALL},
                                              {0}};
enum { COLUMNS = sizeof columns / sizeof *columns - 1 };

/* Whether the next row of the series has the pile: once in every interval of the clock. */
static bool is_due(const scree_scene *scene, const scree_plan_pile *plan,
                   const scree_sensor_moment *now) {
  double every = plan->every, before = now->last ? now->last_time : -every;
  if (scene->end) return true;
  if (!scree_scene_is_in_phase(scene, &plan->during) || every == 0) return false;
  if (isnan(every)) return true;
  return floor(now->time / every) > floor(before / every);
}

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  const scree_plan_pile *plan = sensor->plan->pile;
  heap_of_bodies heap;
  for (int k = 0; k < COLUMNS; k++) at[k] = NAN;
  if (!now->all && !is_due(scene, plan, now)) return SCREE_OK;
  SCREE_TRY(measure_heap(scene, plan, &heap, error));
  scree_pile p = pile_of(&heap, plan->size);
  const scree_repose *r = &p.repose;
  const double values[COLUMNS] = {
      r->sector_deg,  r->cone_deg,        r->silhouette_deg,    r->height,
      r->base_radius, r->sector_sd_deg,   r->silhouette_sd_deg, r->volume_deg,
      r->run_out,     p.packing_fraction, (double)p.body_count};
  memcpy(at, values, sizeof values);
  return SCREE_OK;
}

const scree_sensor_kind scree_sensor_pile = {
    .check = check, .complete = complete, .columns = columns, .read = read};

/* ---- for programs ---- */

static const scree_plan_sensor *pile_at(const scree_scene *scene, size_t index) {
  const scree_scene_sensor *sensor = scree_sensor_at(scene, &scree_sensor_pile, index);
  return sensor ? sensor->plan : NULL;
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
  if (!isnan(plan.size)) SCREE_TRY(check_cell(scene, &nowhere, plan.cell, plan.size, error));
  SCREE_TRY(measure_heap(scene, &plan, &heap, error));
  *pile = pile_of(&heap, heap.size);
  return SCREE_OK;
}
