/* Statistics of few runs: all under the assumption of normal scatter, which ten replicates cannot
 * refute. Sums are compensated; least squares by Householder reflections. */
#include "base/alloc.h"
#include "base/sum.h"
#include "study/special.h"
#include "study/study.h"

static const size_t most_replicates = 10000; /* beyond it count_needed is "never" */

scree_summary scree_summarise(const double *values, size_t count, double confidence) {
  scree_summary s = {0, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
  scree_sum sum = {0}, squares = {0};
  for (size_t i = 0; i < count; i++)
    if (!isnan(values[i])) {
      scree_sum_add(&sum, values[i]);
      s.count++;
    }
  if (s.count < 1) return s;
  double n = (double)s.count, tail = 0.5 * (1 - confidence);
  s.mean = scree_sum_value(sum) / n;
  if (s.count < 2) return s;
  for (size_t i = 0; i < count; i++)
    if (!isnan(values[i])) scree_sum_add(&squares, (values[i] - s.mean) * (values[i] - s.mean));
  s.sd = sqrt(scree_sum_value(squares) / (n - 1));
  s.cv = s.sd / fabs(s.mean);
  if (confidence == 0) return s;
  double half = -scree_student_quantile(tail, n - 1) * s.sd / sqrt(n);
  s.mean_low = s.mean - half;
  s.mean_high = s.mean + half;
  s.sd_low = s.sd * sqrt((n - 1) / scree_chi_square_quantile(1 - tail, n - 1));
  s.sd_high = s.sd * sqrt((n - 1) / scree_chi_square_quantile(tail, n - 1));
  return s;
}

/* The upper tail P(T > t); a standard error of zero makes t infinite. */
static double upper_tail(double t, double degrees) {
  if (isinf(t)) return t > 0 ? 0 : 1;
  return scree_student_cdf(-t, degrees);
}

/* Half the 1 - 2 alpha interval of the difference with n values a side. */
static double half_width(const scree_summary *a, const scree_summary *b, size_t n, double alpha) {
  double variance = a->sd * a->sd + b->sd * b->sd, fourth = pow(a->sd, 4) + pow(b->sd, 4);
  double degrees = (fourth > 0 ? variance * variance / fourth : 1) * ((double)n - 1);
  return -scree_student_quantile(alpha, degrees) * sqrt(variance / (double)n);
}

/* The least n whose interval fits into the room left; it shrinks with n. */
static size_t count_needed(const scree_summary *a, const scree_summary *b, double room,
                           double alpha) {
  size_t low = 1, high = 2; /* low does not do */
  if (!(room > 0)) return 0;
  while (half_width(a, b, high, alpha) >= room) {
    low = high;
    high *= 2;
    if (high > most_replicates) return 0;
  }
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (half_width(a, b, middle, alpha) < room)
      high = middle;
    else
      low = middle;
  }
  return high;
}

scree_comparison scree_compare(const scree_summary *a, const scree_summary *b, double margin,
                               double alpha) {
  scree_comparison c = {.difference = a->mean - b->mean,
                        .low = NAN,
                        .high = NAN,
                        .degrees = NAN,
                        .p_equivalence = NAN,
                        .p_difference = NAN};
  if (a->count < 2 || b->count < 2) return c;
  double va = a->sd * a->sd / (double)a->count, vb = b->sd * b->sd / (double)b->count;
  double error = sqrt(va + vb);
  c.degrees =
      (va + vb) * (va + vb) / (va * va / ((double)a->count - 1) + vb * vb / ((double)b->count - 1));
  if (error == 0) c.degrees = (double)(a->count + b->count - 2);
  double half = error > 0 ? -scree_student_quantile(alpha, c.degrees) * error : 0;
  c.low = c.difference - half;
  c.high = c.difference + half;
  double room = margin - fabs(c.difference);
  c.p_equivalence = error > 0 ? upper_tail(room / error, c.degrees) : room > 0 ? 0 : 1;
  c.p_difference = error > 0 ? fmin(1, 2 * upper_tail(fabs(c.difference) / error, c.degrees))
                             : c.difference == 0;
  c.equivalent = c.p_equivalence < alpha;
  c.different = !c.equivalent && c.p_difference < alpha;
  c.count_needed = count_needed(a, b, room, alpha);
  return c;
}

scree_status scree_fit_power(const double *x, const double *y, size_t count, double confidence,
                             scree_power_law *fit, scree_error *error) {
  scree_sum sx = {0}, sy = {0}, sxx = {0}, sxy = {0}, syy = {0};
  size_t n = 0;
  for (size_t i = 0; i < count; i++)
    if (x[i] > 0 && y[i] > 0) {
      scree_sum_add(&sx, log(x[i]));
      scree_sum_add(&sy, log(y[i]));
      n++;
    }
  double mx = scree_sum_value(sx) / (double)n, my = scree_sum_value(sy) / (double)n;
  for (size_t i = 0; i < count; i++)
    if (x[i] > 0 && y[i] > 0) {
      double dx = log(x[i]) - mx, dy = log(y[i]) - my;
      scree_sum_add(&sxx, dx * dx);
      scree_sum_add(&sxy, dx * dy);
      scree_sum_add(&syy, dy * dy);
    }
  double xx = scree_sum_value(sxx), xy = scree_sum_value(sxy), yy = scree_sum_value(syy);
  if (n < 2 || !(xx > 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "a power law needs two different positive abscissas; %zu points given",
                      count);
  scree_power_law f = {n, 0, xy / xx, NAN, NAN, 1};
  f.factor = exp(my - f.exponent * mx);
  double residual = fmax(0, yy - f.exponent * xy);
  if (yy > 0) f.r2 = 1 - residual / yy;
  if (n > 2) {
    double degrees = (double)n - 2;
    double half =
        -scree_student_quantile(0.5 * (1 - confidence), degrees) * sqrt(residual / degrees / xx);
    f.exponent_low = f.exponent - half;
    f.exponent_high = f.exponent + half;
  }
  *fit = f;
  return SCREE_OK;
}

/* ---- polynomials ---- */

enum { COLUMNS = SCREE_POLYNOMIAL_DEGREE + 2 }; /* powers, and y last */

static size_t different_count(const double *x, size_t count, size_t enough) {
  size_t found = 0;
  for (size_t i = 0; i < count && found < enough; i++) {
    bool again = false;
    for (size_t j = 0; j < i && !again; j++) again = x[j] == x[i];
    found += !again;
  }
  return found;
}

/* Reflects column k's part from row k on onto the diagonal, in all columns from k on. */
static void reflect(double (*rows)[COLUMNS], size_t count, int k) {
  double norm = 0;
  for (size_t i = (size_t)k; i < count; i++) norm = hypot(norm, rows[i][k]);
  if (norm == 0) return;
  double diagonal = rows[k][k] > 0 ? -norm : norm;
  double head = rows[k][k] - diagonal;
  for (int j = k + 1; j < COLUMNS; j++) {
    double dot = head * rows[k][j];
    for (size_t i = (size_t)k + 1; i < count; i++) dot += rows[i][k] * rows[i][j];
    double scale = dot / (head * diagonal);
    rows[k][j] += scale * head;
    for (size_t i = (size_t)k + 1; i < count; i++) rows[i][j] += scale * rows[i][k];
  }
  rows[k][k] = diagonal;
}

static void measure_fit(const double *x, const double *y, size_t count, scree_polynomial *fit) {
  scree_sum mean = {0}, total = {0}, residual = {0};
  for (size_t i = 0; i < count; i++) scree_sum_add(&mean, y[i] / (double)count);
  for (size_t i = 0; i < count; i++) {
    double t = y[i] - scree_sum_value(mean), r = y[i] - scree_polynomial_value(fit, x[i]);
    scree_sum_add(&total, t * t);
    scree_sum_add(&residual, r * r);
  }
  fit->rms = sqrt(scree_sum_value(residual) / (double)count);
  fit->r2 = scree_sum_value(total) > 0 ? 1 - scree_sum_value(residual) / scree_sum_value(total) : 1;
}

scree_status scree_fit_polynomial(const double *x, const double *y, size_t count, int degree,
                                  scree_polynomial *fit, scree_error *error) {
  if (degree < 0 || degree > SCREE_POLYNOMIAL_DEGREE)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "degree %d: must be 0 to %d", degree,
                      SCREE_POLYNOMIAL_DEGREE);
  if (different_count(x, count, (size_t)degree + 1) < (size_t)degree + 1)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "a polynomial of degree %d needs %d different abscissas", degree, degree + 1);
  double(*rows)[COLUMNS] = scree_alloc_zero(count, sizeof *rows), scale = 0;
  if (!rows) return scree_fail_memory(error, count * sizeof *rows, "a polynomial fit");
  for (size_t i = 0; i < count; i++) scale = fmax(scale, fabs(x[i]));
  if (scale == 0) scale = 1;
  for (size_t i = 0; i < count; i++) {
    double power = 1;
    for (int k = 0; k <= degree; k++, power *= x[i] / scale) rows[i][k] = power;
    rows[i][COLUMNS - 1] = y[i];
  }
  for (int k = 0; k <= degree; k++) reflect(rows, count, k);
  scree_polynomial made = {.count = count, .degree = degree};
  for (int k = degree; k >= 0; k--) {
    double value = rows[k][COLUMNS - 1];
    for (int j = k + 1; j <= degree; j++) value -= rows[k][j] * made.coefficient[j];
    made.coefficient[k] = value / rows[k][k];
  }
  double power = 1;
  for (int k = 0; k <= degree; k++, power *= scale) made.coefficient[k] /= power;
  scree_free(rows);
  measure_fit(x, y, count, &made);
  *fit = made;
  return SCREE_OK;
}

double scree_polynomial_value(const scree_polynomial *fit, double x) {
  double value = 0;
  for (int k = fit->degree; k >= 0; k--) value = value * x + fit->coefficient[k];
  return value;
}
