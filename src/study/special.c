/* Student's t and chi-square by the incomplete beta and gamma functions: continued fractions
 * evaluated by Lentz's method (DLMF 8.17.22 and 8.9.2), the power series of gamma where it is the
 * faster one (DLMF 8.11.4). Quantiles by Newton's method, with bisection where it leaves the
 * bracket. */
#include "study/special.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

static const double smallest = 1e-300; /* stands for a zero in a denominator */
enum { MOST_TERMS = 100000, MOST_STEPS = 2000 };

/* One step of Lentz's method: the fraction b0 + a1/(b1 + a2/(b2 + ...)). */
typedef struct lentz {
  double value, c, d;
} lentz;

static bool lentz_step(lentz *l, double a, double b) {
  l->d = b + a * l->d;
  if (l->d == 0) l->d = smallest;
  l->c = b + a / l->c;
  if (l->c == 0) l->c = smallest;
  l->d = 1 / l->d;
  double change = l->c * l->d;
  l->value *= change;
  return fabs(change - 1) < DBL_EPSILON;
}

/* The fraction of I_x(a, b), for x below (a + 1) / (a + b + 2). */
static double beta_fraction(double x, double a, double b) {
  lentz l = {1, 1, 0};
  for (int m = 0; m < MOST_TERMS; m++) {
    double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)), n = m + 1;
    double even = n * (b - n) * x / ((a + 2 * n - 1) * (a + 2 * n));
    bool settled = lentz_step(&l, odd, 1);
    if (lentz_step(&l, even, 1) && settled) break;
  }
  return 1 / l.value;
}

/* Regularised incomplete beta function I_x(a, b). */
static double incomplete_beta(double x, double a, double b) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  double front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log1p(-x));
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(x, a, b) / a;
  return 1 - front * beta_fraction(1 - x, b, a) / b;
}

static double gamma_series(double a, double x) {
  double term = 1 / a, sum = term;
  for (int n = 1; n < MOST_TERMS && term > sum * DBL_EPSILON; n++) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * exp(-x + a * log(x) - lgamma(a));
}

static double gamma_fraction(double a, double x) {
  lentz l = {x + 1 - a, x + 1 - a, 0};
  for (int n = 1; n < MOST_TERMS; n++)
    if (lentz_step(&l, -n * (n - a), x + 1 - a + 2 * n)) break;
  return exp(-x + a * log(x) - lgamma(a)) / l.value;
}

double scree_student_cdf(double t, double degrees) {
  double x = degrees / (degrees + t * t), tail;
  /* near t = 0 the complement keeps the digits */
  if (t * t < degrees)
    tail = 0.5 * (1 - incomplete_beta(t * t / (degrees + t * t), 0.5, 0.5 * degrees));
  else
    tail = 0.5 * incomplete_beta(x, 0.5 * degrees, 0.5);
  return t > 0 ? 1 - tail : tail;
}

double scree_chi_square_cdf(double x, double degrees) {
  double a = 0.5 * degrees, h = 0.5 * x;
  if (x <= 0) return 0;
  return h < a + 1 ? gamma_series(a, h) : 1 - gamma_fraction(a, h);
}

static double student_density(double t, double degrees) {
  double front = exp(lgamma(0.5 * (degrees + 1)) - lgamma(0.5 * degrees));
  return front / sqrt(degrees * acos(-1)) * exp(-0.5 * (degrees + 1) * log1p(t * t / degrees));
}

static double chi_square_density(double x, double degrees) {
  double a = 0.5 * degrees;
  return 0.5 * exp((a - 1) * log(0.5 * x) - 0.5 * x - lgamma(a));
}

typedef double distribution(double x, double degrees);

/* The x with cdf(x) = p between the bounds, which must bracket it. */
static double invert(distribution *cdf, distribution *density, double p, double degrees, double low,
                     double high) {
  double x = low + 0.5 * (high - low);
  for (int i = 0; i < MOST_STEPS; i++) {
    double excess = cdf(x, degrees) - p;
    if (excess < 0)
      low = x;
    else
      high = x;
    double next = x - excess / density(x, degrees);
    if (!(next > low && next < high)) next = low + 0.5 * (high - low);
    if (fabs(next - x) <= 2 * DBL_EPSILON * fabs(next) || high - low <= 0) return next;
    x = next;
  }
  return x;
}

double scree_student_quantile(double p, double degrees) {
  if (p == 0.5) return 0;
  if (p > 0.5) return -scree_student_quantile(1 - p, degrees); /* the lower tail is exact */
  double low = -1;
  while (scree_student_cdf(low, degrees) > p && low > -DBL_MAX / 4) low *= 2;
  return invert(scree_student_cdf, student_density, p, degrees, low, 0);
}

double scree_chi_square_quantile(double p, double degrees) {
  double high = 1;
  while (scree_chi_square_cdf(high, degrees) < p && high < DBL_MAX / 4) high *= 2;
  return invert(scree_chi_square_cdf, chi_square_density, p, degrees, 0, high);
}
