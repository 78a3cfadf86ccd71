/* Residence: how long bodies stay, from their inlet or the table to an outlet or the domain's rim.
 * A quantile between two bodies lies on the straight line between them (Hyndman and Fan's type 7).
 * A histogram has equally wide bins from the shortest stay of all to the longest. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "base/radix.h"

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

/* Of all classes, then of each where there are several: how many there are to read. */
static size_t readings_of(const scree_scene *scene, const scree_scene_sensor *sensor) {
  size_t classes = scree_scene_class_count(scene, plan_of(sensor)->by);
  return classes > 1 ? classes + 1 : 1;
}

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

scree_status scree_scene_read_residence(const scree_scene *scene, const scree_scene_sensor *sensor,
                                        double *at, scree_error *error) {
  size_t width = readings_of(scene, sensor);
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

/* ---- distributions ---- */

/* The residence sensor of that index; NULL past the last. */
static const scree_scene_sensor *sensor_at(const scree_scene *scene, size_t index) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++)
    if (scene->sensors[i].plan->residence && index-- == 0) return &scene->sensors[i];
  return NULL;
}

const char *scree_scene_residence_name(const scree_scene *scene, size_t index) {
  const scree_scene_sensor *sensor = sensor_at(scene, index);
  return sensor ? sensor->plan->place.name : NULL;
}

const char *scree_scene_residence_class(const scree_scene *scene, size_t index,
                                        size_t class_index) {
  int by = plan_of(sensor_at(scene, index))->by;
  return class_index < scree_scene_class_count(scene, by)
             ? scree_scene_class_name(scene, by, class_index)
             : NULL;
}

scree_status scree_scene_measure_residence(const scree_scene *scene, size_t index,
                                           scree_residence *residence, scree_error *error) {
  const scree_scene_sensor *sensor = sensor_at(scene, index);
  scree_residence r = {.class_count = scree_scene_class_count(scene, plan_of(sensor)->by),
                       .bin_count = plan_of(sensor)->bins,
                       .from = INFINITY,
                       .until = -INFINITY};
  double stay;
  r.counts = scree_alloc_zero(r.class_count * r.bin_count, sizeof *r.counts);
  if (!r.counts) return scree_fail_memory(error, r.class_count * r.bin_count, "residence");
  for (size_t b = 0; b < scene->shape_of.count; b++)
    if (stay_of(scene, sensor, b, &stay))
      r.from = fmin(r.from, stay), r.until = fmax(r.until, stay);
  if (!(r.from <= r.until)) r.from = r.until = NAN;
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    if (!stay_of(scene, sensor, b, &stay)) continue;
    double at = r.until > r.from ? (stay - r.from) / (r.until - r.from) * (double)r.bin_count : 0;
    size_t bin = at < (double)r.bin_count ? (size_t)at : r.bin_count - 1,
           class_index = scree_scene_class_of(scene, plan_of(sensor)->by, scene->shape_of.items[b]);
    r.counts[class_index * r.bin_count + bin]++;
  }
  *residence = r;
  return SCREE_OK;
}

void scree_residence_free(scree_residence *residence) {
  scree_free(residence->counts);
  *residence = (scree_residence){0};
}

/* ---- tables ---- */

void scree_scene_put_stays(const scree_scene *scene, const scree_scene_sensor *sensor,
                           FILE *stream) {
  double stay;
  fputs("body,shape,inlet,outlet,entered [s],left [s],residence [s]\n", stream);
  for (size_t b = 0; b < scene->shape_of.count; b++) {
    if (!stay_of(scene, sensor, b, &stay)) continue;
    const scree_scene_stay *s = &scene->stays.items[b];
    const char *inlet = scree_scene_inlet_name(scene, s->inlet),
               *outlet = scree_scene_outlet_name(scene, s->outlet);
    fprintf(stream, "%zu,%s,%s,%s,%.9g,%.9g,%.9g\n", b,
            scree_scene_shape_name(scene, scene->shape_of.items[b]), inlet ? inlet : "",
            outlet ? outlet : "", scene->entered_at.items[b], s->left, stay);
  }
}

static void put_bins(FILE *stream, const scree_residence *r, const char *name, size_t first,
                     size_t count) {
  double all = 0, finer = 0;
  for (size_t c = first; c < first + count; c++)
    for (size_t b = 0; b < r->bin_count; b++) all += r->counts[c * r->bin_count + b];
  for (size_t b = 0; all > 0 && b < r->bin_count; b++) {
    double here = 0, width = (r->until - r->from) / (double)r->bin_count;
    for (size_t c = first; c < first + count; c++) here += r->counts[c * r->bin_count + b];
    finer += here;
    fprintf(stream, "%s,%.9g,%.9g,%.0f,%.9g,%.9g\n", name, r->from + width * (double)b,
            r->from + width * (double)(b + 1), here, here / all, finer / all);
  }
}

scree_status scree_scene_put_histogram(const scree_scene *scene, const scree_scene_sensor *sensor,
                                       FILE *stream, scree_error *error) {
  size_t index = 0;
  scree_residence r;
  while (sensor_at(scene, index) != sensor) index++;
  SCREE_TRY(scree_scene_measure_residence(scene, index, &r, error));
  fputs("class,from [s],until [s],count,share,share until\n", stream);
  put_bins(stream, &r, "", 0, r.class_count);
  for (size_t c = 0; r.class_count > 1 && c < r.class_count; c++)
    put_bins(stream, &r, scree_scene_residence_class(scene, index, c), c, 1);
  scree_residence_free(&r);
  return SCREE_OK;
}
