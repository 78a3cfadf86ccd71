/* The load of a level is its largest error over its tolerance. From the finest level measured down,
 * the first whose load is too much and the one before enclose the level sought. They are narrowed
 * by halves until a level that keeps all tolerances is next to one that does not. That is the
 * coarsest level which keeps them as all finer ones measured do.
 *
 * What is found is measured once more with many more points than the sweep's, so that the answer
 * holds for a measurement by others. Where it does not keep all by that, levels finer by 1, 2, 4
 * collapses and so on are measured with as many points until one does, and halves narrow what lies
 * between. */
#include "choice/recommend.h"
#include "choice/fidelity.h"

#include "base/alloc.h"

#include <math.h>

enum { DENSE_POINTS = 40000 };
static const double DENSE_GAP = 0.004;
/* The most load of a level that will do: leaves room for what the measurement misses. */
static const double MOST_LOAD = 0.98;
/* Half the width of the window of a line, in ln N: a factor of 1.8 either way. */
static const double WINDOW = 0.6;
/* Errors below are none: their logarithm would rule the line. */
static const double LEAST_ERROR = 1e-9;

/* ---- The trend ---- */

/* ln of the trend at level i: what the straight line through ln load against ln N round it has in
 * its middle. Errors of single levels hop. */
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

typedef struct search {
  const scree_curve *curve;
  const double *tolerances;
  scree_gauge_reading reading; /* of the last level that was found to keep all */
  scree_error *error;
} search;

/* Level `fine` keeps all, or is taken to; `coarse` does not, or is none of the curve's. */
typedef struct bracket {
  size_t fine, coarse;
} bracket;

static scree_status keeps_all(search *s, const scree_gauge *gauge, double gap, size_t level_index,
                              bool *keeps) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh mesh = {0};
  scree_gauge_reading reading;
  SCREE_TRY(scree_curve_mesh(s->curve, level_index, &mesh, s->error));
  SCREE_TRY(
      scree_gauge_read(gauge, &mesh, gap, level_index ? s->tolerances : NULL, &reading, s->error));
  *keeps = scree_normalised_error(reading.errors, s->tolerances, NULL) <= MOST_LOAD;
  if (*keeps || level_index == 0) s->reading = reading;
  return SCREE_OK;
}

static scree_status narrow(search *s, const scree_gauge *gauge, double gap, bracket *b) {
  while (b->coarse - b->fine > 1) {
    size_t middle = b->fine + (b->coarse - b->fine) / 2;
    bool keeps;
    SCREE_TRY(keeps_all(s, gauge, gap, middle, &keeps));
    if (keeps)
      b->fine = middle;
    else
      b->coarse = middle;
  }
  return SCREE_OK;
}

/* Between the coarsest usual level that keeps all, or the scan, and the next coarser usual one. */
static bracket first_bracket(const search *s, const scree_fidelity *f) {
  size_t coarse = scree_curve_level_count(s->curve);
  for (size_t row = scree_fidelity_count(f); row-- > 0;) {
    double errors[SCREE_SHAPE_ERROR_COUNT];
    if (!scree_fidelity_is_usual(f, row)) continue;
    for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
      errors[e] = scree_fidelity_error(f, row, (scree_shape_error)e);
    size_t level_index = scree_fidelity_level_index(f, row);
    if (scree_normalised_error(errors, s->tolerances, NULL) <= MOST_LOAD)
      return (bracket){level_index, coarse};
    coarse = level_index;
  }
  return (bracket){0, coarse};
}

static scree_status find_level(search *s, const scree_gauge *quick, const scree_gauge *dense,
                               const scree_fidelity *f, size_t *level_index) {
  bracket b = first_bracket(s, f);
  SCREE_TRY(narrow(s, quick, SCREE_GAUGE_GAP, &b));
  for (size_t step = 1;; step *= 2) {
    bool keeps;
    SCREE_TRY(keeps_all(s, dense, DENSE_GAP, b.fine, &keeps));
    if (keeps || b.fine == 0) break;
    b.coarse = b.fine;
    b.fine -= step < b.fine ? step : b.fine;
  }
  SCREE_TRY(narrow(s, dense, DENSE_GAP, &b));
  *level_index = b.fine;
  return SCREE_OK;
}

scree_status scree_recommend(const scree_curve *curve, const scree_gauge *gauge,
                             const scree_fidelity *fidelity,
                             const double tolerances[SCREE_SHAPE_ERROR_COUNT],
                             scree_recommended *found, scree_error *error) {
  search s = {.curve = curve, .tolerances = tolerances, .error = error};
  SCREE_CLEANUP(scree_gauge_free) scree_gauge dense = {0};
  SCREE_TRY(scree_gauge_refine(gauge, DENSE_POINTS, &dense, error));
  size_t level_index;
  SCREE_TRY(find_level(&s, gauge, &dense, fidelity, &level_index));
  *found = (scree_recommended){.level_index = level_index, .reading = s.reading};
  return SCREE_OK;
}
