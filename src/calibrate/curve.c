/* Curves by their principal components (Higdon and others 2008): the mean curve of the runs and the
 * few shapes in which they vary most, found by power iteration. Each shape has root mean square 1
 * over its points, so that a score is in the curve's own unit, and the uncertainty of measuring,
 * taken as one of the whole curve, is that of each score: points of one picture are not
 * independent. */
#include "calibrate/calibration.h"

#include <math.h>
#include <string.h>

enum { MOST_ITERATIONS = 500 };
static const double least_share = 0.02; /* of all variance: less is scatter */

double scree_curve_score(const scree_curve_basis *b, size_t component, const double *curve) {
  double sum = 0;
  const double *shape = b->basis + component * b->point_count;
  for (size_t i = 0; i < b->point_count; i++) sum += shape[i] * (curve[i] - b->centre[i]);
  return sum / (double)b->point_count;
}

double scree_curve_left(const scree_curve_basis *b, const double *curve) {
  double squares = 0;
  for (size_t i = 0; i < b->point_count; i++) {
    double known = b->centre[i];
    for (size_t k = 0; k < b->component_count; k++)
      known += scree_curve_score(b, k, curve) * b->basis[k * b->point_count + i];
    squares += (curve[i] - known) * (curve[i] - known);
  }
  return sqrt(squares / (double)b->point_count);
}

void scree_curve_basis_free(scree_curve_basis *b) {
  scree_free(b->centre);
  scree_free(b->basis);
  *b = (scree_curve_basis){0};
}

static double root_mean_square(const double *v, size_t n) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) sum += v[i] * v[i];
  return sqrt(sum / (double)n);
}

/* The leading eigenvector of the covariance, and its variance per point. */
static double lead(const double *covariance, size_t n, double *shape, double *next) {
  double variance = 0;
  for (size_t i = 0; i < n; i++) shape[i] = 1 + 0.1 * (double)(i % 7);
  for (int step = 0; step < MOST_ITERATIONS; step++) {
    for (size_t i = 0; i < n; i++) {
      next[i] = 0;
      for (size_t j = 0; j < n; j++) next[i] += covariance[i * n + j] * shape[j];
    }
    double length = root_mean_square(next, n), before = variance;
    if (!(length > 0)) return 0;
    variance = length / (root_mean_square(shape, n) * (double)n);
    for (size_t i = 0; i < n; i++) shape[i] = next[i] / length;
    if (fabs(variance - before) <= 1e-13 * variance) break;
  }
  return variance;
}

static void add_up(const double *curves, size_t count, size_t n, double *centre,
                   double *covariance) {
  size_t used = 0;
  memset(centre, 0, n * sizeof *centre);
  memset(covariance, 0, n * n * sizeof *covariance);
  for (size_t c = 0; c < count; c++) {
    if (isnan(curves[c * n])) continue;
    used++;
    for (size_t i = 0; i < n; i++) centre[i] += curves[c * n + i];
  }
  for (size_t i = 0; used && i < n; i++) centre[i] /= (double)used;
  for (size_t c = 0; c < count; c++) {
    if (isnan(curves[c * n])) continue;
    const double *y = curves + c * n;
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; j < n; j++)
        covariance[i * n + j] += (y[i] - centre[i]) * (y[j] - centre[j]) / (double)used;
  }
}

scree_status scree_curve_basis_make(const double *curves, size_t count, size_t point_count,
                                    scree_curve_basis *basis, scree_error *error) {
  size_t n = point_count;
  SCREE_CLEANUP(scree_curve_basis_free) scree_curve_basis b = {.point_count = n};
  SCREE_SCRATCH(double, covariance, n *n, error);
  SCREE_SCRATCH(double, next, n, error);
  SCREE_TRY_ALLOC(b.centre, n, error);
  SCREE_TRY_ALLOC(b.basis, SCREE_MOST_COMPONENTS * n, error);
  double whole = 0;
  add_up(curves, count, n, b.centre, covariance);
  for (size_t i = 0; i < n; i++) whole += covariance[i * n + i] / (double)n;
  for (; b.component_count < SCREE_MOST_COMPONENTS; b.component_count++) {
    double *shape = b.basis + b.component_count * n, variance = lead(covariance, n, shape, next);
    if (b.component_count > 0 && !(variance > least_share * whole)) break;
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; j < n; j++) covariance[i * n + j] -= variance * shape[i] * shape[j];
  }
  *basis = b;
  memset(&b, 0, sizeof b);
  return SCREE_OK;
}
