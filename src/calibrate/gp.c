/* Heteroskedastic Gaussian process after Binois, Gramacy and Ludkovski (2018, "Practical
 * heteroskedastic Gaussian process modeling for large simulation experiments"). Replicates enter by
 * their means and sums of squares (their section 3.1, the Woodbury identity), so that all costs go
 * with different places, not with runs. Where they give each place a noise variance of its own,
 * smoothed by a second process, the logarithm of the noise is linear in the coordinates here, times
 * a factor of the place: what replicates and left-out places scatter by beside what was expected,
 * in the mean over the neighbourhood. Where nothing is near it is 1.
 *
 * Answers are brought to mean 0 and standard deviation 1. A plane with standard normal coefficients
 * carries the trend (integrated out exactly: it is part of the covariance); a Matern 5/2 process
 * with a length for each coordinate carries the departures. The settings are the most probable
 * ones under weak priors, found by BFGS with the exact gradient from three starts. */
#include "calibrate/model.h"

#include "base/math.h"
#include "base/rng.h"

#include <string.h>

/* Priors: mean and standard deviation of each kind of setting. Coordinates go from -1 to 1, answers
 * have variance 1. */
static const struct {
  double mean, sd;
} prior_length = {0.7, 0.8},   /* log: a length of the whole range */
    prior_departure = {-1, 2}, /* log of the variance of departures from the plane */
    prior_noise = {-2.3, 2},   /* log of the noise: a tenth of all variance */
    prior_slope = {0, 1};      /* the noise changes e times from the middle to the end */
static const double start_lengths[] = {1.5, 0.4, 0.12}; /* the last where there are many hollows */
/* The noise's factor: width of the neighbourhood in two coordinates, and for how many degrees of
 * freedom the expected noise counts. */
static const double near_width = 0.25, expected_degrees = 4;
static const double root5 = 2.23606797749978969641;
/* Added to every noise variance: a simulation without noise. */
static const double least_noise = 1e-7;
enum { MOST_ITERATIONS = 60 };
static const double settled = 1e-5;    /* change of the log density at which the search ends */
static const double difference = 1e-3; /* of a setting, for the curvature */
enum { MEMBERS = 12, MEMBER_STREAM = 7 << 20 };

/* ---- covariance ---- */

/* Settings without their logarithms. */
typedef struct kernel {
  double inverse_length[SCREE_MOST_PARAMETERS], variance;
  const double *noise; /* its logarithm in the middle, then its slopes */
} kernel;

/* One choice of the settings, with what share of all it counts. */
typedef struct member {
  double settings[SCREE_GP_MOST_SETTINGS], share;
  kernel kernel;
  double *inverse; /* of the covariance of the means, n x n */
  double *weights; /* inverse times mean */
} member;

struct scree_gp {
  size_t active[SCREE_MOST_PARAMETERS], d, n, run_count, dimension_count;
  double shift, scale;            /* y = shift + scale * ours */
  double *x;                      /* n x d */
  double *mean, *squares, *count; /* per place: of the replicates; squared deviations from mean */
  /* Per place: the noise's factor; squares in units of the expected noise, degrees of freedom. */
  double *factor, *excess, *degrees;
  member members[MEMBERS]; /* the first has the most probable settings */
};

static kernel kernel_of(const scree_gp *gp, const double *s) {
  kernel k = {.variance = scree_exp(s[gp->d]), .noise = s + gp->d + 1};
  for (size_t i = 0; i < gp->d; i++) k.inverse_length[i] = scree_exp(-s[i]);
  return k;
}

static double distance2(const scree_gp *gp, const kernel *k, const double *a, const double *b) {
  double sum = 0;
  for (size_t i = 0; i < gp->d; i++) {
    double step = (a[i] - b[i]) * k->inverse_length[i];
    sum += step * step;
  }
  return sum;
}

static double matern(double squared) {
  double r = root5 * sqrt(squared);
  return (1 + r + r * r / 3) * scree_exp(-r);
}

static double plane(const scree_gp *gp, const double *a, const double *b) {
  double sum = 1;
  for (size_t k = 0; k < gp->d; k++) sum += a[k] * b[k];
  return sum;
}

static double covariance(const scree_gp *gp, const kernel *k, const double *a, const double *b) {
  return plane(gp, a, b) + k->variance * matern(distance2(gp, k, a, b));
}

static double noise_at(const scree_gp *gp, const kernel *k, const double *x, double factor) {
  double sum = k->noise[0];
  for (size_t i = 0; i < gp->d; i++) sum += k->noise[1 + i] * x[i];
  return least_noise + factor * scree_exp(sum);
}

double scree_gp_factor(const scree_gp *gp, const double *x) {
  double over = expected_degrees, under = expected_degrees,
         width = near_width * near_width * (double)gp->d;
  for (size_t i = 0; i < gp->n; i++) {
    double squared = 0;
    for (size_t k = 0; k < gp->d; k++)
      squared += (x[k] - gp->x[i * gp->d + k]) * (x[k] - gp->x[i * gp->d + k]);
    double near = scree_exp(-squared / width);
    over += near * gp->excess[i];
    under += near * gp->degrees[i];
  }
  return over / under;
}

/* ---- linear algebra: symmetric positive definite, row by row ---- */

/* Four sums at a time, which do not wait for one another. */
static double dot(const double *a, const double *b, size_t n) {
  double sum[4] = {0};
  size_t i = 0;
  for (; i + 4 <= n; i += 4)
    for (size_t k = 0; k < 4; k++) sum[k] += a[i + k] * b[i + k];
  for (; i < n; i++) sum[0] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Lower triangle of a into its Cholesky factor; false: not positive definite. */
static bool factorise(double *a, size_t n) {
  for (size_t i = 0; i < n; i++) {
    double *row = a + i * n;
    for (size_t j = 0; j <= i; j++) {
      const double *other = a + j * n;
      double sum = row[j] - dot(row, other, j);
      if (i != j)
        row[j] = sum / other[j];
      else if (sum > 0)
        row[i] = sqrt(sum);
      else
        return false;
    }
  }
  return true;
}

static double log_determinant(const double *factor, size_t n) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) sum += scree_log(factor[i * n + i]);
  return 2 * sum;
}

/* The whole inverse from the factor, which is overwritten by its own inverse on the way. */
static void invert(double *factor, size_t n, double *inverse) {
  for (size_t i = 0; i < n; i++) { /* row i of L^-1, in place */
    double *row = factor + i * n;
    double diagonal = 1 / row[i];
    for (size_t j = 0; j < i; j++) {
      double sum = 0;
      for (size_t k = j; k < i; k++) sum += row[k] * factor[k * n + j];
      inverse[j] = -sum * diagonal; /* row 0 of the answer serves as scratch */
    }
    memcpy(row, inverse, i * sizeof *row);
    row[i] = diagonal;
  }
  for (size_t i = 0; i < n * n; i++) inverse[i] = 0;
  for (size_t k = 0; k < n; k++) /* sum of the outer products of its rows */
    for (size_t i = 0; i <= k; i++) {
      double f = factor[k * n + i];
      for (size_t j = 0; j <= i; j++) inverse[i * n + j] += f * factor[k * n + j];
    }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++) inverse[j * n + i] = inverse[i * n + j];
}

/* ---- the density of the settings ---- */

static size_t setting_count(const scree_gp *gp) {
  return 2 * gp->d + 2;
}

static void prior_of(const scree_gp *gp, size_t setting, double *mean, double *sd) {
  bool length = setting < gp->d, departure = setting == gp->d, noise = setting == gp->d + 1;
  *mean = length      ? prior_length.mean
          : departure ? prior_departure.mean
          : noise     ? prior_noise.mean
                      : prior_slope.mean;
  *sd = length      ? prior_length.sd
        : departure ? prior_departure.sd
        : noise     ? prior_noise.sd
                    : prior_slope.sd;
}

static double add_prior(const scree_gp *gp, const double *s, double *gradient) {
  double sum = 0;
  for (size_t i = 0; i < setting_count(gp); i++) {
    double mean, sd;
    prior_of(gp, i, &mean, &sd);
    double z = (s[i] - mean) / sd;
    sum -= 0.5 * z * z;
    gradient[i] -= z / sd;
  }
  return sum;
}

/* Adds the likelihood of the replicates about their means, and what the noise's own gradient gets
 * from them and from the covariance of the means. */
static double add_replicates(const scree_gp *gp, const kernel *k, const double *inverse,
                             const double *weights, double *gradient) {
  size_t d = gp->d;
  double sum = 0;
  for (size_t i = 0; i < gp->n; i++) {
    const double *x = gp->x + i * d;
    double noise = noise_at(gp, k, x, gp->factor[i]), more = gp->count[i] - 1;
    sum -= 0.5 * (more * scree_log(noise) + gp->squares[i] / noise);
    double slope = -0.5 * (more / noise - gp->squares[i] / (noise * noise));
    slope += 0.5 * (weights[i] * weights[i] - inverse[i * gp->n + i]) / gp->count[i];
    slope *= noise - least_noise;
    gradient[d + 1] += slope;
    for (size_t c = 0; c < d; c++) gradient[d + 2 + c] += slope * x[c];
  }
  return sum;
}

static void add_kernel_gradient(const scree_gp *gp, const kernel *k, const double *inverse,
                                const double *weights, double *gradient) {
  size_t d = gp->d, n = gp->n;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) {
      double twice = i == j ? 1 : 2;
      double slope = 0.5 * twice * (weights[i] * weights[j] - inverse[i * n + j]);
      double squared = distance2(gp, k, gp->x + i * d, gp->x + j * d), r = root5 * sqrt(squared);
      double fall = k->variance * scree_exp(-r);
      gradient[d] += slope * fall * (1 + r + r * r / 3);
      for (size_t c = 0; c < d; c++) {
        double step = (gp->x[i * d + c] - gp->x[j * d + c]) * k->inverse_length[c];
        gradient[c] += slope * fall * (5.0 / 3) * (1 + r) * step * step;
      }
    }
}

/* factor, inverse: n x n scratch; weights: n. */
static double density(const scree_gp *gp, const double *s, double *factor, double *inverse,
                      double *weights, double *gradient) {
  size_t n = gp->n, d = gp->d;
  kernel k = kernel_of(gp, s);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++)
      factor[i * n + j] =
          covariance(gp, &k, gp->x + i * d, gp->x + j * d) +
          (i == j ? noise_at(gp, &k, gp->x + i * d, gp->factor[i]) / gp->count[i] : 0);
  if (!factorise(factor, n)) return -INFINITY;
  double sum = -0.5 * log_determinant(factor, n);
  invert(factor, n, inverse);
  for (size_t i = 0; i < n; i++) {
    weights[i] = dot(inverse + i * n, gp->mean, n);
    sum -= 0.5 * weights[i] * gp->mean[i];
  }
  memset(gradient, 0, setting_count(gp) * sizeof *gradient);
  sum += add_replicates(gp, &k, inverse, weights, gradient);
  add_kernel_gradient(gp, &k, inverse, weights, gradient);
  return sum + add_prior(gp, s, gradient);
}

double scree_gp_log_density(const scree_gp *gp, const double *settings, double *gradient) {
  size_t square = gp->n * gp->n;
  SCREE_CLEANUP(scree_free_at) double *factor = scree_alloc(2 * square + gp->n, sizeof *factor);
  if (!factor) return -INFINITY;
  return density(gp, settings, factor, factor + square, factor + 2 * square, gradient);
}

/* ---- the search ---- */

typedef struct search {
  const scree_gp *gp;
  size_t m;
  double *factor, *inverse, *weights;
  double s[SCREE_GP_MOST_SETTINGS], gradient[SCREE_GP_MOST_SETTINGS], value;
  double curvature[SCREE_GP_MOST_SETTINGS * SCREE_GP_MOST_SETTINGS]; /* of BFGS: inverse Hessian */
} search;

/* Goes along the direction as far as the value rises enough; false: nowhere. */
static bool go_uphill(search *q, const double *direction, double slope) {
  double tried[SCREE_GP_MOST_SETTINGS], gradient[SCREE_GP_MOST_SETTINGS], longest = 0;
  for (size_t i = 0; i < q->m; i++) longest = fmax(longest, fabs(direction[i]));
  double step = longest > 2 ? 2 / longest : 1; /* settings are logarithms: no leap beyond e^2 */
  for (int halving = 0; halving < 30; halving++, step *= 0.5) {
    for (size_t i = 0; i < q->m; i++) tried[i] = q->s[i] + step * direction[i];
    double value = density(q->gp, tried, q->factor, q->inverse, q->weights, gradient);
    if (!(value >= q->value + 1e-4 * step * slope)) continue;
    double y[SCREE_GP_MOST_SETTINGS], hy[SCREE_GP_MOST_SETTINGS] = {0}, sy = 0, yhy = 0;
    for (size_t i = 0; i < q->m; i++) {
      y[i] = q->gradient[i] - gradient[i]; /* of the negative */
      sy += step * direction[i] * y[i];
    }
    for (size_t i = 0; i < q->m; i++) {
      for (size_t j = 0; j < q->m; j++) hy[i] += q->curvature[i * q->m + j] * y[j];
      yhy += y[i] * hy[i];
    }
    if (sy > 1e-12)
      for (size_t i = 0; i < q->m; i++)
        for (size_t j = 0; j < q->m; j++) {
          double si = step * direction[i], sj = step * direction[j];
          q->curvature[i * q->m + j] +=
              (1 + yhy / sy) * si * sj / sy - (hy[i] * sj + si * hy[j]) / sy;
        }
    memcpy(q->s, tried, sizeof tried);
    memcpy(q->gradient, gradient, sizeof gradient);
    q->value = value;
    return true;
  }
  return false;
}

static void climb(search *q, double log_length) {
  for (size_t i = 0; i < q->m; i++) {
    double sd;
    prior_of(q->gp, i, &q->s[i], &sd);
    if (i < q->gp->d) q->s[i] = log_length;
    for (size_t j = 0; j < q->m; j++) q->curvature[i * q->m + j] = i == j ? 0.1 : 0;
  }
  q->value = density(q->gp, q->s, q->factor, q->inverse, q->weights, q->gradient);
  if (!isfinite(q->value)) return;
  for (int i = 0; i < MOST_ITERATIONS; i++) {
    double direction[SCREE_GP_MOST_SETTINGS] = {0}, slope = 0, before = q->value;
    for (size_t a = 0; a < q->m; a++) {
      for (size_t b = 0; b < q->m; b++) direction[a] += q->curvature[a * q->m + b] * q->gradient[b];
      slope += direction[a] * q->gradient[a];
    }
    if (!(slope > 0) || !go_uphill(q, direction, slope) || q->value - before < settled) return;
  }
}

/* ---- data ---- */

static bool same_place(const double *a, const double *b, size_t d) {
  for (size_t k = 0; k < d; k++)
    if (a[k] != b[k]) return false;
  return true;
}

static void standardise(scree_gp *gp, const scree_gp_runs *runs) {
  double sum = 0, squares = 0;
  for (size_t r = 0; r < runs->run_count; r++)
    if (!isnan(runs->y[r])) {
      sum += runs->y[r];
      gp->run_count++;
    }
  gp->shift = gp->run_count ? sum / (double)gp->run_count : 0;
  for (size_t r = 0; r < runs->run_count; r++)
    if (!isnan(runs->y[r])) squares += (runs->y[r] - gp->shift) * (runs->y[r] - gp->shift);
  gp->scale = gp->run_count > 1 ? sqrt(squares / (double)(gp->run_count - 1)) : 0;
  if (!(gp->scale > 1e-12 * fabs(gp->shift))) gp->scale = gp->shift != 0 ? fabs(gp->shift) : 1;
}

/* Places with their replicates' means and sums of squares, by Welford's recurrence. */
static scree_status gather(scree_gp *gp, const scree_gp_runs *runs, scree_error *error) {
  for (size_t r = 0; r < runs->run_count; r++) {
    double place[SCREE_MOST_PARAMETERS];
    if (isnan(runs->y[r])) continue;
    for (size_t k = 0; k < gp->d; k++)
      place[k] = runs->x[r * runs->dimension_count + gp->active[k]];
    size_t i = 0;
    while (i < gp->n && !same_place(gp->x + i * gp->d, place, gp->d)) i++;
    if (i == SCREE_GP_MOST_PLACES)
      return scree_fail(error, SCREE_LIMIT, "runs at more than %d settings of the parameters",
                        SCREE_GP_MOST_PLACES);
    if (i == gp->n) {
      memcpy(gp->x + i * gp->d, place, gp->d * sizeof *place);
      gp->count[i] = gp->mean[i] = gp->squares[i] = 0;
      gp->n++;
    }
    double y = (runs->y[r] - gp->shift) / gp->scale, step = y - gp->mean[i];
    gp->count[i]++;
    gp->mean[i] += step / gp->count[i];
    gp->squares[i] += step * (y - gp->mean[i]);
  }
  return SCREE_OK;
}

static scree_status allocate(scree_gp *gp, size_t runs, scree_error *error) {
  SCREE_TRY_ALLOC(gp->x, runs * gp->d + 1, error);
  SCREE_TRY_ALLOC(gp->mean, runs, error);
  SCREE_TRY_ALLOC(gp->squares, runs, error);
  SCREE_TRY_ALLOC(gp->count, runs, error);
  SCREE_TRY_ALLOC_ZERO(gp->excess, runs, error);
  SCREE_TRY_ALLOC_ZERO(gp->degrees, runs, error);
  SCREE_TRY_ALLOC(gp->factor, runs, error);
  for (size_t i = 0; i < runs; i++) gp->factor[i] = 1;
  return SCREE_OK;
}

/* The Cholesky factor of the curvature of the log density at the most probable settings, from
 * differences of its gradient; false: it is no peak. */
static bool find_curvature(search *q, double *factor) {
  size_t m = q->m;
  double ahead[SCREE_GP_MOST_SETTINGS] = {0}, behind[SCREE_GP_MOST_SETTINGS] = {0},
         s[SCREE_GP_MOST_SETTINGS];
  for (size_t i = 0; i < m; i++) {
    memcpy(s, q->s, sizeof s);
    s[i] = q->s[i] + difference;
    double a = density(q->gp, s, q->factor, q->inverse, q->weights, ahead);
    s[i] = q->s[i] - difference;
    double b = density(q->gp, s, q->factor, q->inverse, q->weights, behind);
    if (!isfinite(a) || !isfinite(b)) return false;
    for (size_t j = 0; j < m; j++) factor[i * m + j] = (behind[j] - ahead[j]) / (2 * difference);
  }
  for (size_t i = 0; i < m; i++)
    for (size_t j = 0; j < i; j++)
      factor[i * m + j] = 0.5 * (factor[i * m + j] + factor[j * m + i]);
  return factorise(factor, m);
}

/* Settings drawn from the normal density of that curvature; the share of each is its density
 * beside that normal one. Without a peak the first stands alone. */
static void draw_members(scree_gp *gp, search *q) {
  size_t m = q->m;
  double factor[SCREE_GP_MOST_SETTINGS * SCREE_GP_MOST_SETTINGS], all = 0;
  bool curved = find_curvature(q, factor);
  scree_rng rng = {1, MEMBER_STREAM, 0};
  for (size_t k = 0; k < MEMBERS; k++) {
    member *one = &gp->members[k];
    double squares = 0;
    memcpy(one->settings, q->s, sizeof one->settings);
    for (size_t i = m; curved && k > 0 && i-- > 0;) { /* solves L^T step = z, from its last row */
      double z = scree_rng_normal(&rng), step = z;
      for (size_t j = i + 1; j < m; j++) step -= factor[j * m + i] * (one->settings[j] - q->s[j]);
      one->settings[i] += step / factor[i * m + i];
      squares += z * z;
    }
    double value = density(gp, one->settings, q->factor, one->inverse, one->weights, q->gradient);
    one->kernel = kernel_of(gp, one->settings);
    one->share = curved || k == 0 ? scree_exp(value - q->value + 0.5 * squares) : 0;
    all += one->share;
  }
  for (size_t k = 0; k < MEMBERS; k++) gp->members[k].share /= all;
}

/* What replicates scatter by, and what each place departs from what the others say of it (the
 * inverse has that), as far as it is noise that makes it. */
static void localise_noise(scree_gp *gp, search *q) {
  kernel k = kernel_of(gp, q->s);
  (void)density(gp, q->s, q->factor, q->inverse, q->weights, q->gradient);
  for (size_t i = 0; i < gp->n; i++) {
    double noise = noise_at(gp, &k, gp->x + i * gp->d, 1), own = q->inverse[i * gp->n + i],
           share = fmin(1, noise / gp->count[i] * own);
    gp->excess[i] = gp->squares[i] / noise + share * q->weights[i] * q->weights[i] / own;
    gp->degrees[i] = gp->count[i] - 1 + share;
  }
  for (size_t i = 0; i < gp->n; i++) gp->factor[i] = scree_gp_factor(gp, gp->x + i * gp->d);
  q->value = density(gp, q->s, q->factor, q->inverse, q->weights, q->gradient);
}

static scree_status find_settings(scree_gp *gp, scree_error *error) {
  search best = {0}, q = {.gp = gp, .m = setting_count(gp)};
  SCREE_SCRATCH(double, factor, gp->n * gp->n, error);
  for (size_t k = 0; k < MEMBERS; k++) {
    SCREE_TRY_ALLOC(gp->members[k].inverse, gp->n * gp->n, error);
    SCREE_TRY_ALLOC(gp->members[k].weights, gp->n, error);
  }
  q.factor = factor;
  q.inverse = gp->members[0].inverse;
  q.weights = gp->members[0].weights;
  best.value = -INFINITY;
  for (size_t i = 0; i < sizeof start_lengths / sizeof *start_lengths; i++) {
    climb(&q, scree_log(start_lengths[i]));
    if (q.value > best.value) best = q;
  }
  if (!isfinite(best.value))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the answers' covariance cannot be inverted");
  localise_noise(gp, &best);
  draw_members(gp, &best);
  return SCREE_OK;
}

scree_status scree_gp_fit(const scree_gp_runs *runs, scree_gp **gp, scree_error *error) {
  SCREE_OWNED(scree_gp, made);
  SCREE_TRY_ALLOC_ZERO(made, 1, error);
  SCREE_ASSERT(runs->active_count <= SCREE_MOST_PARAMETERS);
  made->d = runs->active_count;
  made->dimension_count = runs->dimension_count;
  for (size_t k = 0; k < made->d; k++) made->active[k] = runs->active[k];
  SCREE_TRY(allocate(made, runs->run_count, error));
  standardise(made, runs);
  SCREE_TRY(gather(made, runs, error));
  if (made->n < 2)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu of %zu runs gave this answer",
                      made->run_count, runs->run_count);
  SCREE_TRY(find_settings(made, error));
  *gp = made;
  made = NULL;
  return SCREE_OK;
}

void scree_gp_free(scree_gp *gp) {
  if (!gp) return;
  scree_free(gp->x);
  scree_free(gp->mean);
  scree_free(gp->squares);
  scree_free(gp->count);
  scree_free(gp->factor);
  scree_free(gp->excess);
  scree_free(gp->degrees);
  for (size_t k = 0; k < MEMBERS; k++) {
    scree_free(gp->members[k].weights);
    scree_free(gp->members[k].inverse);
  }
  scree_free(gp);
}
size_t scree_gp_run_count(const scree_gp *gp) {
  return gp->run_count;
}
double scree_gp_member(const scree_gp *gp, size_t index, double settings[SCREE_GP_MOST_SETTINGS]) {
  if (index >= MEMBERS) return -1;
  memcpy(settings, gp->members[index].settings, sizeof gp->members[index].settings);
  return gp->members[index].share;
}

/* ---- prediction ---- */

static void choose_active(const scree_gp *gp, const double *x, double *place) {
  for (size_t k = 0; k < gp->d; k++) place[k] = x[gp->active[k]];
}

double scree_gp_noise(const scree_gp *gp, const double *x) {
  double place[SCREE_MOST_PARAMETERS], noise = 0;
  choose_active(gp, x, place);
  double factor = scree_gp_factor(gp, place);
  for (size_t m = 0; m < MEMBERS; m++)
    noise += gp->members[m].share * noise_at(gp, &gp->members[m].kernel, place, factor);
  return gp->scale * gp->scale * noise;
}

/* Covariances of a place with all places of a member; answers its mean there. */
static double reach(const scree_gp *gp, const member *one, const double *place, double *k) {
  double mean = 0;
  for (size_t i = 0; i < gp->n; i++) {
    k[i] = covariance(gp, &one->kernel, place, gp->x + i * gp->d);
    mean += one->weights[i] * k[i];
  }
  return mean;
}

double scree_gp_mean(const scree_gp *gp, const double *x) {
  double place[SCREE_MOST_PARAMETERS], k[SCREE_GP_MOST_PLACES], mean = 0;
  choose_active(gp, x, place);
  for (size_t m = 0; m < MEMBERS; m++)
    mean += gp->members[m].share * reach(gp, &gp->members[m], place, k);
  return gp->shift + gp->scale * mean;
}

scree_gp_value scree_gp_at(const scree_gp *gp, const double *x) {
  double place[SCREE_MOST_PARAMETERS], k[SCREE_GP_MOST_PLACES];
  double mean = 0, squares = 0, variance = 0, noise = 0;
  choose_active(gp, x, place);
  double factor = scree_gp_factor(gp, place);
  for (size_t m = 0; m < MEMBERS; m++) {
    const member *one = &gp->members[m];
    double y = reach(gp, one, place, k), own = covariance(gp, &one->kernel, place, place);
    for (size_t i = 0; i < gp->n; i++) {
      const double *row = one->inverse + i * gp->n;
      own -= 2 * k[i] * (0.5 * row[i] * k[i] + dot(row, k, i));
    }
    mean += one->share * y;
    squares += one->share * y * y;
    variance += one->share * fmax(own, 0);
    noise += one->share * noise_at(gp, &one->kernel, place, factor);
  }
  double squared = gp->scale * gp->scale;
  return (scree_gp_value){gp->shift + gp->scale * mean,
                          squared * (variance + fmax(squares - mean * mean, 0)), squared * noise};
}

/* The mean over members of their covariances, and the covariance of their means. */
scree_status scree_gp_covariance(const scree_gp *gp, const double *x, size_t count, double *answer,
                                 scree_error *error) {
  size_t n = gp->n, d = gp->d;
  SCREE_SCRATCH(double, places, count *d + 1, error);
  SCREE_SCRATCH(double, k, count *n, error);
  SCREE_SCRATCH(double, ki, n, error);
  SCREE_SCRATCH(double, means, count *MEMBERS, error);
  memset(answer, 0, count * count * sizeof *answer);
  for (size_t a = 0; a < count; a++) choose_active(gp, x + a * gp->dimension_count, places + a * d);
  for (size_t m = 0; m < MEMBERS; m++) {
    const member *one = &gp->members[m];
    for (size_t a = 0; a < count; a++)
      means[a * MEMBERS + m] = reach(gp, one, places + a * d, k + a * n);
    for (size_t a = 0; a < count; a++) {
      for (size_t i = 0; i < n; i++) ki[i] = dot(one->inverse + i * n, k + a * n, n);
      for (size_t b = 0; b <= a; b++) {
        double sum = covariance(gp, &one->kernel, places + a * d, places + b * d);
        sum -= dot(ki, k + b * n, n);
        answer[a * count + b] += one->share * sum;
      }
    }
  }
  for (size_t a = 0; a < count; a++)
    for (size_t b = 0; b <= a; b++) {
      double both = 0, first = 0, second = 0;
      for (size_t m = 0; m < MEMBERS; m++) {
        double share = gp->members[m].share, y = means[a * MEMBERS + m], z = means[b * MEMBERS + m];
        both += share * y * z;
        first += share * y;
        second += share * z;
      }
      double sum = answer[a * count + b] + both - first * second;
      answer[a * count + b] = answer[b * count + a] = sum * gp->scale * gp->scale;
    }
  return SCREE_OK;
}
