/* The objective is the integral over the union U of s(phi), with phi the signed distance from the
 * body's surface and s running from -1 inside to +w outside within `softness` of the surface. With
 * w the IoU itself its stationary points are those of the IoU, as of softness 0.
 *
 * Moving a sphere's surface outwards by v changes the integral by s v per exposed area, and with
 * centre c and radius r moving, v = (n, 1).(dc, dr), n the outward normal. So the gradient is
 * sum a s(phi) (n, 1) over exposed patches of area a. For the curvature s is taken as phi /
 * max(|phi|, softness), the weights of iteratively reweighted least squares: sum a (n, 1)(n, 1)^T /
 * max(|phi|, softness), 4 x 4 for each sphere, spheres apart.
 *
 * Moments of U (volume, first, second) are held as constraints: by the divergence theorem the
 * integral of a monomial p of degree k is sum a p x.n / (3 + k), and its slope sum a p (n, 1). One
 * multiplier per moment out of tolerance, from the Schur complement of the whole system. */
#include "clump/step.h"

#include "base/alloc.h"
#include "base/math.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* Tuning, each once; lengths where the body's volume is 1. */
static const double directions_in_all =
                        24576, /* over all spheres in a sharp step: noise of areas below 1e-3 */
    least_directions = 320,    /* of one sphere in a sharp step */
    least_soft = 64,           /* in a soft one */
    sharp = 0.05,              /* softness of a sharp step for one sphere, as n^(-1/3) */
    damping_share = 0.02,      /* of the mean curvature, added: keeps covered spheres still */
    least_curvature = 1e-6,    /* likewise where nothing is exposed */
    largest_move = 0.25,       /* of the radius, in one step */
    least_radius = 0.01,       /* no smaller spheres */
    slack_volume = 0.005,      /* tolerances: volume */
    slack_centroid = 0.001,    /* centroid */
    slack_inertia = 0.026,     /* moments of inertia about the axes, of each */
    slack_trace = 0.0046,      /* and of the trace of the inertia tensor */
    slack_tilt = 0.002,        /* what a product of inertia may add to a principal moment, of it */
    slack_kept = 0.6,          /* part of a tolerance that a step aims into */
    slack_restored = 0.9;      /* likewise when only moments are restored */

static const int degree[SCREE_MOMENTS] = {0, 1, 1, 1, 2, 2, 2, 2, 2, 2};

/* A product q of inertia moves the two principal moments, `gap` apart, by s = (sqrt(gap^2 + 4 q^2)
 * - gap) / 2. */
static double product_for(double shift, double gap) {
  return sqrt(shift * (shift + gap));
}

static void set_tolerances(scree_mover *m) {
  const double *inertia = m->body->moments + SCREE_FIRST_INERTIA,
               trace = inertia[0] + inertia[1] + inertia[2];
  m->tolerance[0] = slack_volume;
  for (int k = 1; k < SCREE_FIRST_INERTIA; k++) m->tolerance[k] = slack_centroid;
  for (int a = 0; a < 3; a++) {
    m->tolerance[SCREE_FIRST_INERTIA + a] = fmin(slack_inertia * inertia[a], slack_trace * trace);
    for (int b = 0; b < a; b++)
      m->tolerance[SCREE_FIRST_PRODUCT + a + b - 1] =
          product_for(slack_tilt * fmin(inertia[a], inertia[b]), fabs(inertia[a] - inertia[b]));
  }
}

scree_status scree_mover_make(const scree_target *body, const scree_distance_field *field,
                              scree_mover *mover, scree_error *error) {
  *mover = (scree_mover){.body = body, .field = field, .most_outside = INFINITY};
  SCREE_TRY_ALLOC(mover->equations, SCREE_MOST_SPHERES, error);
  set_tolerances(mover);
  return SCREE_OK;
}

void scree_mover_free(scree_mover *mover) {
  scree_free(mover->equations);
  mover->equations = NULL;
}

/* Adds a patch of area a at p with outward normal n; force: a s(phi); stiffness: a / |phi|. */
static void add_patch(scree_normal_equations *e, vec3 p, vec3 n, const double weights[3],
                      bool moments) {
  const double u[4] = {n.x, n.y, n.z, 1};
  double area = weights[0], force = weights[1], stiffness = weights[2];
  for (int i = 0; i < 4; i++) {
    e->gradient[i] += force * u[i];
    for (int j = 0; j <= i; j++) e->curvature[i][j] += stiffness * u[i] * u[j];
  }
  if (!moments) return;
  double monomials[SCREE_MOMENTS], flux = vec3_dot(p, n);
  scree_target_monomials(p, monomials);
  for (int m = 0; m < SCREE_MOMENTS; m++) {
    double value = area * monomials[m];
    e->moments[m] += value * flux / (3 + degree[m]);
    for (int i = 0; i < 4; i++) e->slopes[m][i] += value * u[i];
  }
}

static void add_sphere(const scree_mover *mover, const scree_sphere *spheres, size_t count,
                       size_t index, const scree_step *step) {
  float shares[SCREE_MOST_DIRECTIONS];
  const scree_directions *d = &mover->directions;
  const scree_sphere *s = &spheres[index];
  scree_normal_equations *e = &mover->equations[index];
  double patch = 4 * pi * s->radius * s->radius / (double)d->count;
  double per_softness = 1 / step->softness;
  scree_exposed_shares(d, spheres, count, index, shares);
  memset(e, 0, sizeof *e);
  for (size_t k = 0; k < d->count; k++) {
    if (!(shares[k] > 0)) continue;
    vec3 n = {d->x[k], d->y[k], d->z[k]}, p = vec3_mad(vec3_load(s->centre), n, s->radius);
    double area = patch * (double)shares[k], force = 0, stiffness = 1;
    if (!step->restore) {
      const double at[3] = {p.x, p.y, p.z};
      double phi = scree_distance_field_at(mover->field, at), weight = phi > 0 ? step->outside : 1;
      force = weight * scree_larger(-1, scree_smaller(1, phi * per_softness));
      stiffness = weight / scree_larger(fabs(phi), step->softness);
    }
    add_patch(e, p, n, (const double[3]){area, area * force, area * stiffness}, step->hold > 0);
  }
}

/* Cholesky factor of the lower triangle, in place. */
static void factor(double *a, size_t n) {
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) {
      double sum = a[i * n + j];
      for (size_t k = 0; k < j; k++) sum -= a[i * n + k] * a[j * n + k];
      a[i * n + j] = i == j ? sqrt(fmax(sum, 1e-30)) : sum / a[j * n + j];
    }
}

/* b = a^-1 b from the factor. */
static void solve(const double *a, size_t n, double *b) {
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 0; k < i; k++) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; k++) b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
}

/* The move without multipliers, and what each multiplier would add. */
static void solve_sphere(scree_normal_equations *e, bool moments) {
  double mean = (e->curvature[0][0] + e->curvature[1][1] + e->curvature[2][2]) / 3;
  for (int i = 0; i < 4; i++) e->curvature[i][i] += least_curvature + damping_share * mean;
  factor(e->curvature[0], 4);
  solve(e->curvature[0], 4, e->gradient);
  for (int m = 0; moments && m < SCREE_MOMENTS; m++) {
    memcpy(e->answers[m], e->slopes[m], sizeof e->answers[m]);
    solve(e->curvature[0], 4, e->answers[m]);
  }
}

/* Softer steps do with coarser patches. */
static size_t direction_count(size_t count, const scree_step *step) {
  double each = fmax(least_directions, directions_in_all / (double)count);
  double fineness = step->restore ? 1 : sharp / scree_cbrt((double)count) / step->softness;
  each = fmax(least_soft, each * fmin(1, fineness));
  return (size_t)fmin(SCREE_MOST_DIRECTIONS, each);
}

static double dot4(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

/* How much of each held moment's error beyond what is aimed at is to go; which are active. */
static void set_targets(const scree_mover *mover, size_t count, scree_step *step,
                        double targets[SCREE_MOMENTS]) {
  double aim = step->restore ? slack_restored : slack_kept;
  for (size_t m = 0; m < SCREE_MOMENTS; m++) {
    double value = 0, slack = aim * mover->tolerance[m];
    if (step->moments) value = step->moments[m];
    for (size_t i = 0; !step->moments && i < count; i++) value += mover->equations[i].moments[m];
    double error = value - mover->body->moments[m];
    if (m < step->held && fabs(error) > slack) step->active[m] = true;
    targets[m] = step->hold * (error - fmax(-slack, fmin(slack, error)));
  }
}

/* The multipliers: of moments that are not active, 0. */
static void find_multipliers(const scree_mover *mover, size_t count, scree_step *step,
                             double multipliers[SCREE_MOMENTS]) {
  double matrix[SCREE_MOMENTS][SCREE_MOMENTS] = {{0}};
  set_targets(mover, count, step, multipliers);
  for (size_t i = 0; i < count; i++) {
    const scree_normal_equations *e = &mover->equations[i];
    for (size_t p = 0; p < SCREE_MOMENTS; p++) {
      multipliers[p] -= dot4(e->slopes[p], e->gradient);
      for (size_t q = 0; q <= p; q++) matrix[p][q] += dot4(e->slopes[p], e->answers[q]);
    }
  }
  for (size_t p = 0; p < SCREE_MOMENTS; p++) {
    matrix[p][p] += 1e-4 * matrix[p][p] + 1e-9;
    for (size_t q = 0; q <= p; q++)
      if (!step->active[p] || !step->active[q]) matrix[p][q] = p == q;
    if (!step->active[p]) multipliers[p] = 0;
  }
  factor(matrix[0], SCREE_MOMENTS);
  solve(matrix[0], SCREE_MOMENTS, multipliers);
}

/* The sphere within the body's box, and of a size that is allowed. */
static void confine(const scree_mover *mover, scree_sphere *s) {
  const double low[3] = {mover->body->low.x, mover->body->low.y, mover->body->low.z},
               high[3] = {mover->body->high.x, mover->body->high.y, mover->body->high.z};
  for (int k = 0; k < 3; k++) s->centre[k] = fmax(low[k], fmin(high[k], s->centre[k]));
  s->radius = fmax(least_radius, fmin(SCREE_LARGEST_SPHERE, s->radius));
}

static void move_sphere(const scree_mover *mover, size_t index, const scree_step *step,
                        const double multipliers[SCREE_MOMENTS], scree_sphere *s) {
  const scree_normal_equations *e = &mover->equations[index];
  double d[4];
  for (int i = 0; i < 4; i++) {
    d[i] = e->gradient[i];
    for (int m = 0; step->hold > 0 && m < SCREE_MOMENTS; m++)
      d[i] += multipliers[m] * e->answers[m][i];
    d[i] *= -step->damping;
  }
  double way = fmax(sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), fabs(d[3]));
  double most = largest_move * s->radius, share = way > most ? most / way : 1;
  for (int k = 0; k < 3; k++) s->centre[k] += share * d[k];
  s->radius += share * d[3];
  confine(mover, s);
}

void scree_mover_step(scree_mover *mover, scree_sphere *spheres, size_t count, scree_step *step) {
  double multipliers[SCREE_MOMENTS] = {0};
  scree_directions_spread(&mover->directions, direction_count(count, step));
  for (size_t i = 0; i < count; i++) {
    add_sphere(mover, spheres, count, i, step);
    solve_sphere(&mover->equations[i], step->hold > 0);
  }
  if (step->hold > 0) find_multipliers(mover, count, step, multipliers);
  for (size_t i = 0; i < count; i++) move_sphere(mover, i, step, multipliers, &spheres[i]);
}
