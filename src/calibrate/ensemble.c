/* The affine-invariant ensemble sampler of Goodman and Weare (2010), with its stretch move: walkers
 * step along lines through one another, so that long thin ridges, as of two parameters that trade
 * against each other, are walked as easily as round ones. One half moves while the other stands
 * (Foreman-Mackey and others 2013), so that a half may be looked at by many threads. Walkers begin
 * at points of Sobol's sequence drawn by their density, so that no mode is left out. */
#include "calibrate/model.h"

#include "base/math.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "study/design.h"

#include <string.h>

enum { START_POINTS = 1024, START_STREAM = 3 << 20, WALK_STREAM = 4 << 20 };
static const double stretch = 2; /* a of the paper */

typedef struct walk {
  const scree_ensemble *e;
  double *place, *density; /* of each walker */
  size_t step, half;
} walk;

static void look_at_start(void *context, scree_block block) {
  walk *w = context;
  size_t d = w->e->dimension_count;
  for (size_t i = block.begin; i < block.end; i++)
    w->density[i] = w->e->density(w->e->context, w->place + i * d);
}

/* Draws walkers among many points, with probability as their density; each is used once, as long as
 * there are others. */
static void draw_start(const scree_ensemble *e, const double *points, double *densities,
                       double *place, double *density) {
  size_t d = e->dimension_count;
  scree_rng rng = {e->seed, START_STREAM, 0};
  for (size_t w = 0; w < e->walker_count; w++) {
    /* Gumbel's trick: the largest of log density + Gumbel noise is such a draw */
    double best = -INFINITY;
    size_t chosen = w;
    for (size_t i = 0; i < START_POINTS; i++) {
      double u = scree_rng_uniform(&rng);
      double value = densities[i] - scree_log(-scree_log(u > 0 ? u : 0x1p-54));
      if (value > best) {
        best = value;
        chosen = i;
      }
    }
    memcpy(place + w * d, points + chosen * d, d * sizeof *place);
    density[w] = densities[chosen];
    densities[chosen] = -INFINITY;
  }
}

static scree_status start(const scree_ensemble *e, double *place, double *density,
                          scree_error *error) {
  size_t d = e->dimension_count;
  SCREE_SCRATCH(double, points, START_POINTS *d, error);
  SCREE_SCRATCH(double, densities, START_POINTS, error);
  scree_design_sobol(e->seed, START_POINTS, d, points);
  for (size_t i = 0; i < START_POINTS * d; i++) points[i] = 2 * points[i] - 1;
  walk w = {.e = e, .place = points, .density = densities};
  scree_parallel_for(START_POINTS, 16, look_at_start, &w);
  draw_start(e, points, densities, place, density);
  return SCREE_OK;
}

/* One stretch move of each walker of a half. */
static void move(void *context, scree_block block) {
  walk *w = context;
  size_t d = w->e->dimension_count, half = w->e->walker_count / 2;
  for (size_t i = block.begin; i < block.end; i++) {
    size_t mine = w->half * half + i;
    scree_rng rng = {w->e->seed, WALK_STREAM + mine, 4 * w->step};
    const double *other = w->place + ((1 - w->half) * half + scree_rng_below(&rng, half)) * d;
    double root = (sqrt(stretch) - 1 / sqrt(stretch)) * scree_rng_uniform(&rng) + 1 / sqrt(stretch);
    double z = root * root, *place = w->place + mine * d, tried[16];
    bool inside = true;
    for (size_t k = 0; k < d; k++) {
      tried[k] = other[k] + z * (place[k] - other[k]);
      inside = inside && fabs(tried[k]) <= 1;
    }
    if (!inside) continue;
    double density = w->e->density(w->e->context, tried), u = scree_rng_uniform(&rng);
    if ((double)(d - 1) * scree_log(z) + density - w->density[mine] < scree_log(u > 0 ? u : 1))
      continue;
    memcpy(place, tried, d * sizeof *place);
    w->density[mine] = density;
  }
}

scree_status scree_ensemble_sample(const scree_ensemble *e, double *samples, scree_error *error) {
  size_t d = e->dimension_count, kept = 0;
  SCREE_ASSERT(d > 0 && d <= 16 && e->walker_count % 2 == 0 && e->walker_count >= 2 * d + 2);
  SCREE_SCRATCH(double, place, e->walker_count *d, error);
  SCREE_SCRATCH(double, density, e->walker_count, error);
  walk w = {.e = e, .place = place, .density = density};
  SCREE_TRY(start(e, place, density, error));
  for (; w.step < e->first_steps + e->steps; w.step++) {
    for (w.half = 0; w.half < 2; w.half++) scree_parallel_for(e->walker_count / 2, 4, move, &w);
    if (w.step < e->first_steps || (w.step - e->first_steps + 1) % e->thin != 0) continue;
    memcpy(samples + kept * d, w.place, e->walker_count * d * sizeof *samples);
    kept += e->walker_count;
  }
  return SCREE_OK;
}
