/* Errors of single levels hop: a bump of the scan is lost at one count and found again at the next.
 * So the load, the largest error over its tolerance, is not taken level by level. A straight line
 * is fitted to ln load against ln N round each level, and the trend is what these lines have in
 * their middle. Where it crosses 1, from the finest level down, lies the count sought.
 *
 * The level recommended is the one nearest to that count that keeps all tolerances, and does not
 * keep them by far. Levels round the crossing are tried, a small step at a time on both sides,
 * finer ones alone where those within reach do not do. What is tried is measured with many more
 * points than the sweep's, so that the answer holds for a measurement by others. */
#include "choice/recommend.h"

#include "base/alloc.h"

#include <math.h>

enum { DENSE_POINTS = 40000, MOST_TRIES = 60 };
static const double DENSE_GAP = 0.004;
/* Half the width of the window of a line, in ln N: a factor of 1.8 either way. */
static const double WINDOW = 0.6;
/* Levels whose load is in this range by the dense measurement will do: the upper end leaves room
 * for what that misses, the lower for no waste. */
static const double MOST_LOAD = 0.98, LEAST_LOAD = 0.88;
/* The sweep's points are fewer: levels beyond these are not measured densely. */
static const double MOST_QUICK_LOAD = 1.01, LEAST_QUICK_LOAD = 0.85;
/* A step between levels tried, and how far from the crossing both sides are tried; in ln N. */
static const double STEP = 0.015, NEAR = 0.16;
/* Errors below are none: their logarithm would rule the line. */
static const double LEAST_ERROR = 1e-9;

double scree_load(const double errors[SCREE_SHAPE_ERROR_COUNT],
                  const double tolerances[SCREE_SHAPE_ERROR_COUNT], scree_shape_error *which) {
  double load = 0;
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++) {
    if (!(errors[e] / tolerances[e] > load)) continue;
    load = errors[e] / tolerances[e];
    if (which) *which = (scree_shape_error)e;
  }
  return load;
}

/* ---- The trend ---- */

/* ln of the trend at level i. */
static double trend_at(const scree_kept *levels, size_t count, size_t i) {
  double middle = log((double)levels[i].triangle_count), n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (size_t k = 0; k < count; k++) {
    double x = log((double)levels[k].triangle_count) - middle;
    if (fabs(x) > WINDOW) continue;
    double y = log(fmax(levels[k].load, LEAST_ERROR));
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  double spread = sxx - sx * sx / n;
  double slope = spread > 1e-9 ? (sxy - sx * sy / n) / spread : 0;
  return (sy - slope * sx) / n;
}

double scree_trend_crossing(const scree_kept *levels, size_t count) {
  double finer = trend_at(levels, count, 0);
  if (finer > 0) return (double)levels[0].triangle_count;
  for (size_t i = 1; i < count; i++) {
    double here = trend_at(levels, count, i);
    if (here > 0) {
      double part = (0 - finer) / (here - finer);
      double a = log((double)levels[i - 1].triangle_count),
             b = log((double)levels[i].triangle_count);
      return exp(a + part * (b - a));
    }
    finer = here;
  }
  return (double)levels[count - 1].triangle_count;
}

scree_least scree_trend_least(const scree_kept *levels, size_t count, double scale) {
  enum { PARTS = 8 }; /* the trend is followed in so many steps between two levels */
  scree_least least = {.triangle_count = (double)levels[0].triangle_count, .sum = INFINITY};
  for (int widening = 0; widening <= 1; widening++)
    for (size_t i = 0; i + 1 < count; i++) {
      double a = log((double)levels[i].triangle_count),
             b = log((double)levels[i + 1].triangle_count), ya = trend_at(levels, count, i),
             yb = trend_at(levels, count, i + 1);
      for (int k = 0; k <= PARTS; k++) {
        double t = (double)k / PARTS, n = exp(a + t * (b - a));
        double sum = exp(ya + t * (yb - ya)) + n / scale;
        if (!widening && sum < least.sum) least = (scree_least){n, sum, n, n};
        if (!widening || sum > SCREE_SIMILAR_IP * least.sum) continue;
        least.fewest = fmin(least.fewest, n);
        least.most = fmax(least.most, n);
      }
    }
  return least;
}

/* ---- The level ---- */

/* Levels are tried by their count; each at most once. */
typedef struct search {
  const scree_curve *curve;
  const scree_gauge *quick;
  scree_gauge dense;
  const double *tolerances;
  scree_error *error;
} search;

/* What a level tried came to: its load, which is by the quick measurement where that is enough. */
typedef struct attempt {
  size_t level_index;
  double load;
  bool is_dense;
  scree_gauge_reading reading;
} attempt;

static scree_status try_level(search *s, size_t level_index, bool always_dense, attempt *a) {
  scree_mesh mesh = {0};
  a->level_index = level_index;
  scree_status status = scree_curve_mesh(s->curve, level_index, &mesh, s->error);
  if (status == SCREE_OK)
    status = scree_gauge_read(s->quick, &mesh, SCREE_GAUGE_GAP, &a->reading, s->error);
  a->is_dense = false;
  if (status == SCREE_OK) {
    a->load = scree_load(a->reading.errors, s->tolerances, NULL);
    a->is_dense = always_dense ? a->load <= MOST_QUICK_LOAD
                               : a->load <= MOST_QUICK_LOAD && a->load >= LEAST_QUICK_LOAD;
  }
  if (status == SCREE_OK && a->is_dense) {
    status = scree_gauge_read(&s->dense, &mesh, DENSE_GAP, &a->reading, s->error);
    a->load = scree_load(a->reading.errors, s->tolerances, NULL);
  }
  scree_mesh_free(&mesh);
  return status;
}

/* The levels of a curve within NEAR of the crossing, the nearest first, until one will do. */
static scree_status try_near(search *s, double crossing, attempt *best, bool *found) {
  attempt a;
  size_t tried[2] = {SIZE_MAX, SIZE_MAX};
  for (int i = 0; i * STEP / 2 <= NEAR; i++) {
    double away = (i % 2 ? 1 : -1) * ((i + 1) / 2) * STEP;
    size_t index = scree_curve_find(s->curve, (size_t)(crossing * exp(away)));
    if (index == tried[0] || index == tried[1]) continue;
    tried[i % 2] = index;
    scree_status status = try_level(s, index, false, &a);
    if (status != SCREE_OK) return status;
    if (!a.is_dense || a.load > MOST_LOAD || a.load < LEAST_LOAD) continue;
    *best = a;
    *found = true;
    return SCREE_OK;
  }
  return SCREE_OK;
}

/* From the crossing to finer levels, until one keeps all: the scan itself does. */
static scree_status try_finer(search *s, double crossing, attempt *best) {
  double count = crossing;
  for (int i = 0;; i++) {
    size_t index = scree_curve_find(s->curve, (size_t)count);
    scree_status status = try_level(s, index, true, best);
    if (status != SCREE_OK || index == 0 || (best->is_dense && best->load <= MOST_LOAD))
      return status;
    /* what is far from kept is farther on */
    count *= i < MOST_TRIES ? exp(STEP * fmax(1, fmin(4, log(best->load) / STEP / 2))) : 2;
    if ((size_t)count <= scree_curve_get_facts(s->curve).floor_count) count += 2;
  }
}

scree_status scree_recommend(const scree_curve *curve, const scree_gauge *gauge,
                             const scree_fidelity *fidelity,
                             const double tolerances[SCREE_SHAPE_ERROR_COUNT],
                             scree_recommended *found, scree_error *error) {
  size_t count = scree_fidelity_count(fidelity);
  scree_kept *levels = scree_alloc(count, sizeof *levels);
  if (!levels) return scree_fail_memory(error, count * sizeof *levels, "loads of levels");
  for (size_t i = 0; i < count; i++) {
    double errors[SCREE_SHAPE_ERROR_COUNT];
    for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
      errors[e] = scree_fidelity_error(fidelity, i, (scree_shape_error)e);
    levels[i] = (scree_kept){scree_fidelity_triangle_count(fidelity, i),
                             scree_load(errors, tolerances, NULL)};
  }
  double crossing = scree_trend_crossing(levels, count);
  scree_free(levels);
  search s = {.curve = curve, .quick = gauge, .tolerances = tolerances, .error = error};
  attempt best;
  bool near = false;
  scree_status status = scree_gauge_refine(gauge, DENSE_POINTS, &s.dense, error);
  if (status != SCREE_OK) return status;
  status = try_near(&s, crossing, &best, &near);
  if (status == SCREE_OK && !near) status = try_finer(&s, crossing, &best);
  scree_gauge_free(&s.dense);
  if (status != SCREE_OK) return status;
  *found = (scree_recommended){best.level_index, best.reading};
  return SCREE_OK;
}
