/* Residence: how long bodies stay, from their inlet or the table to an outlet or the domain's rim.
 * A quantile between two bodies lies on the straight line between them (Hyndman and Fan's type 7).
 * A histogram has equally wide bins from the shortest stay of all to the longest. */
#include "scene/sensors/sensor.h"

#include "base/alloc.h"
#include "base/radix.h"

#define SCREE_PLAN_RESIDENCE(ROW, T)                                                               \
  ROW(T, WORD, by, 0, "size|shape|material",                                                       \
      "classes: of a shape's sizes each, all of a shape, all of a material")                       \
  ROW(T, TEXT, inlet, "of those that came by it; not given: all")                                  \
  ROW(T, TEXT, outlet, "of those that left by it; not given: all")                                 \
  ROW(T, COUNT, bins, 20, 1, 10000, "of the histogram")
SCREE_RECORD_TYPE(scree_plan_residence, SCREE_PLAN_RESIDENCE)
SCREE_RECORD_TABLE(scree_plan_residence, SCREE_PLAN_RESIDENCE, "residence", NULL, NULL)

static const double quantiles[] = {0.1, 0.5, 0.9};
enum { QUANTILES = sizeof quantiles / sizeof *quantiles };

static const scree_plan_residence *plan_of(const scree_scene_sensor *sensor) {
  return sensor->plan->residence;
}

/* Whether the sensor counts the body; its stay, s. */
static bool stay_of(const scree_scene *scene, const scree_scene_sensor *sensor, size_t body,
                    double *stay) {
  const scree_plan_residence *plan = plan_of(sensor);
  const scree_scene_stay *s = &scene->stays.items[body];
  if (isnan(s->left) || s->left < sensor->plan->from || s->left > sensor->plan->until) return false;
  if (plan->inlet && s->inlet != SCREE_PLAN_FIND(scene->plan.inlets, plan->inlet)) return false;
  if (plan->outlet && s->outlet != SCREE_PLAN_FIND(scene->plan.outlets, plan->outlet)) return false;
  *stay = s->left - scene->entered_at.items[body];
  return true;
}

static scree_sensor_classes classes(const scree_scene *scene, const scree_scene_sensor *sensor) {
  return scree_classes_by(scene, plan_of(sensor)->by);
}

static scree_status check(const scree_reader *r, const scree_plan *plan,
                          const scree_plan_sensor *s) {
  const scree_plan_residence *p = s->residence;
  if (p->inlet) SCREE_TRY(SCREE_PLAN_NEED(r, plan, inlets, "inlet", p->inlet, &p->place));
  return p->outlet ? SCREE_PLAN_NEED(r, plan, outlets, "outlet", p->outlet, &p->place) : SCREE_OK;
}

/* ---- the series ---- */

static const scree_sensor_column columns[] = {{"count", "", SCREE_OF_ALL_AND_EACH},
                                              {"mean", "s", SCREE_OF_ALL_AND_EACH},
                                              {"sd", "s", SCREE_OF_ALL_AND_EACH},
                                              {"p10", "s", SCREE_OF_ALL_AND_EACH},
                                              {"median", "s", SCREE_OF_ALL_AND_EACH},
                                              {"p90", "s", SCREE_OF_ALL_AND_EACH},
                                              {0}};

static bool is_of(const scree_scene *scene, const scree_scene_sensor *sensor, size_t body,
                  size_t reading) {
  size_t shape = scene->shape_of.items[body];
  return reading == 0 || scree_scene_class_of(scene, plan_of(sensor)->by, shape) == reading - 1;
}

/* The stays of one reading, rising; their count. */
static size_t list_stays(const scree_scene *scene, const scree_scene_sensor *sensor, size_t reading,
                         double *stays) {
  size_t count = 0;
  for (size_t b = 0; b < scene->shape_of.count; b++)
    if (is_of(scene, sensor, b, reading) && stay_of(scene, sensor, b, &stays[count])) count++;
  scree_sort_numbers(stays, count);
  return count;
}

static scree_status read(const scree_scene *scene, const scree_scene_sensor *sensor,
                         const scree_sensor_moment *now, double *at, scree_error *error) {
  size_t width = scree_sensor_width(classes(scene, sensor).count);
  (void)now;
  double *stays = scree_alloc(scene->shape_of.count, sizeof *stays);
  if (!stays) return scree_fail_memory(error, scene->shape_of.count * sizeof *stays, "residence");
  for (size_t k = 0; k < width; k++) {
    size_t count = list_stays(scene, sensor, k, stays);
    double mean = 0, squares = 0, n = (double)count;
    for (size_t i = 0; i < count; i++) mean += stays[i] / n;
    for (size_t i = 0; i < count; i++) squares += (stays[i] - mean) * (stays[i] - mean);
    at[k] = n;
    at[width + k] = count > 0 ? mean : NAN;
    at[2 * width + k] = count > 1 ? sqrt(squares / (n - 1)) : NAN;
    for (size_t q = 0; q < QUANTILES; q++)
      at[(3 + q) * width + k] = scree_quantile(stays, count, quantiles[q]);
  }
  scree_free(stays);
  return SCREE_OK;
}

/* ---- tables ---- */

static scree_status fill_stays(const scree_scene *scene, const scree_scene_sensor *sensor,
                               scree_sensor_rows *rows, scree_error *error) {
  double stay;
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    if (!stay_of(scene, sensor, b, &stay)) continue;
    const scree_scene_stay *s = &scene->stays.items[b];
    const char *inlet = scree_scene_inlet_name(scene, s->inlet),
               *outlet = scree_scene_outlet_name(scene, s->outlet);
    const double row[] = {(double)b, NAN, NAN, NAN, scene->entered_at.items[b], s->left, stay};
    const char *const texts[sizeof row / sizeof *row] = {
        NULL, scree_scene_shape_name(scene, scene->shape_of.items[b]), inlet ? inlet : "",
        outlet ? outlet : ""};
    SCREE_TRY(scree_sensor_put_row(rows, row, texts, error));
  }
  return SCREE_OK;
}

static size_t bin_of(double stay, const double ends[2], size_t bins) {
  const double at = ends[1] > ends[0] ? (stay - ends[0]) / (ends[1] - ends[0]) * (double)bins : 0;
  return at < (double)bins ? (size_t)at : bins - 1;
}

/* How many of the rising stays are in each bin of one reading. */
static scree_status put_bins(const double *stays, size_t count, const double ends[2], size_t bins,
                             const char *name, scree_sensor_rows *rows, scree_error *error) {
  const double width = (ends[1] - ends[0]) / (double)bins, all = (double)count;
  size_t finer = 0;
  for (size_t b = 0; count > 0 && b < bins; b++) {
    const size_t before = finer;
    while (finer < count && bin_of(stays[finer], ends, bins) == b) finer++;
    const double here = (double)(finer - before);
    const double row[] = {
        NAN,        ends[0] + width * (double)b, ends[0] + width * (double)(b + 1), here,
        here / all, (double)finer / all};
    const char *const texts[sizeof row / sizeof *row] = {name};
    SCREE_TRY(scree_sensor_put_row(rows, row, texts, error));
  }
  return SCREE_OK;
}

static scree_status fill_histogram(const scree_scene *scene, const scree_scene_sensor *sensor,
                                   scree_sensor_rows *rows, scree_error *error) {
  const size_t width = scree_sensor_width(classes(scene, sensor).count);
  double ends[2] = {NAN, NAN};
  SCREE_SCRATCH(double, stays, scene->shape_of.count, error);
  for (size_t k = 0; k < width; k++) {
    const size_t count = list_stays(scene, sensor, k, stays);
    if (k == 0 && count > 0) ends[0] = stays[0], ends[1] = stays[count - 1];
    const char *name = k ? scree_scene_class_name(scene, plan_of(sensor)->by, k - 1) : "";
    SCREE_TRY(put_bins(stays, count, ends, plan_of(sensor)->bins, name, rows, error));
  }
  return SCREE_OK;
}

static const scree_sensor_table tables[] = {{"residence",
                                             true,
                                             {{"body", "", 0},
                                              {"shape", "", 0},
                                              {"inlet", "", 0},
                                              {"outlet", "", 0},
                                              {"entered", "s", 0},
                                              {"left", "s", 0},
                                              {"residence", "s", 0}},
                                             fill_stays},
                                            {"histogram",
                                             false,
                                             {{"class", "", 0},
                                              {"from", "s", 0},
                                              {"until", "s", 0},
                                              {"count", "", 0},
                                              {"share", "", 0},
                                              {"share until", "", 0}},
                                             fill_histogram},
                                            {0}};

const scree_sensor_kind scree_sensor_residence = {
    .check = check, .columns = columns, .classes = classes, .read = read, .tables = tables};
