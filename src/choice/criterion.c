/* The criterion: eq. 1 and 2 of Katagiri and Koyanaka (2020),
 *
 *   eps_s = |S - S_ref| / S_ref,      Ip = eps_s + w Nr / Nm,
 *
 * on the paper's logarithmic grid and on every level, and the robust form with the monotone
 * envelope
 *
 *   worst(i) = max over j <= i of eps_s(j)      (level 0 is the scan, i grows as triangles go)
 *
 * The paper leaves open what a grid Rp means where Rp Nm is no triangle count of a level; here it
 * is the first level not above the truncated product, as MeshLab stops there. Everything comes from
 * one pass over the levels from fine to coarse; grid and trace are cursors that the pass fills as
 * it passes their counts. */
#include "choice/criterion.h"
#include "base/math.h"
#include "choice/fidelity.h"

#include "base/alloc.h"
#include "base/number.h"
#include "base/radix.h"

#include <math.h>
#include <string.h>

/* What the recommended level keeps by default. */
static const struct {
  scree_shape_error error;
  double share;
} usual_tolerances[] = {
    /* the surface as a whole: a third of a millimetre on a body of 100 mm */
    {SCREE_ERROR_MEAN, 0.003},
    /* no part of the body is lost that reaches farther out than this; above the two to three per
     * cent that come with that mean, so that what hops from level to level seldom decides */
    {SCREE_ERROR_HAUSDORFF, 0.04},
    /* how it turns */
    {SCREE_ERROR_INERTIA, 0.02},
    /* how it packs: a flat body by its thickness */
    {SCREE_ERROR_WIDTHS, 0.03},
    /* thin walls stay walls: what is 1 mm thick is 0.03 mm off in the mean */
    {SCREE_ERROR_THICKNESS, 0.03},
};

/* Relative slack that keeps 1e-3 * 762000 at 762, whichever way 1e-3 was rounded. */
static const double TARGET_SLACK = 1e-12;
/* Slack at the ends of the grid: 1e-5 10^(36/9) may come out just above 1e-1. */
static const double GRID_SLACK = 1e-9;
/* A minimum counts as an accident where its error is below this part of the worst so far,
 * unless that is no more than rounding. */
static const double ACCIDENT_RATIO = 0.1, LEAST_ERROR = 1e-9;

static bool is_accident(double error, double worst) {
  return worst > LEAST_ERROR && error < ACCIDENT_RATIO * worst;
}

scree_choice_options scree_default_choice_options(void) {
  scree_choice_options o = {1, 1e-5, 1e-1, 9, SCREE_REFERENCE_SCAN, {0}, {0}, false, false};
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    o.tolerances[e] = o.tolerance_lengths[e] = INFINITY;
  for (size_t i = 0; i < sizeof usual_tolerances / sizeof *usual_tolerances; i++)
    o.tolerances[usual_tolerances[i].error] = usual_tolerances[i].share;
  return o;
}

const char *scree_choice_rule_name(scree_choice_rule rule) {
#define SCREE_CHOICE_RULE_NAME(name, text) text,
  static const char *const names[] = {SCREE_CHOICE_RULE_LIST(SCREE_CHOICE_RULE_NAME)};
#undef SCREE_CHOICE_RULE_NAME
  return (unsigned)rule < SCREE_RULE_COUNT ? names[rule] : "?";
}

double scree_choice_tolerance(const scree_choice *choice, const scree_choice_options *options,
                              scree_shape_error which) {
  double length =
      choice->fidelity ? scree_fidelity_scan(choice->fidelity, SCREE_SCAN_LENGTH) : INFINITY;
  return scree_tolerance_share(options, which, length);
}

double scree_tolerance_share(const scree_choice_options *options, scree_shape_error which,
                             double length) {
  double limit = options->tolerance_lengths[which];
  return fmin(options->tolerances[which], limit < INFINITY ? limit / length : INFINITY);
}

const scree_pick *scree_choice_pick(const scree_choice *choice, scree_choice_rule rule) {
  return rule == SCREE_RULE_PAPER ? &choice->paper : &choice->recommended;
}

static double log_grid(double rp_min, int per_decade, size_t index) {
  return scree_power_of_ten(scree_log10(rp_min) + (double)index / per_decade);
}

static size_t log_grid_count(double rp_min, double rp_max, int per_decade) {
  size_t count = 0;
  while (log_grid(rp_min, per_decade, count) <= rp_max * (1 + GRID_SLACK)) count++;
  return count;
}

double scree_choice_grid_rp(const scree_choice_options *options, size_t index) {
  const scree_choice_options defaults = scree_default_choice_options();
  if (!options) options = &defaults;
  return log_grid(options->rp_min, options->per_decade, index);
}

size_t scree_choice_grid_count(const scree_choice_options *options) {
  const scree_choice_options defaults = scree_default_choice_options();
  if (!options) options = &defaults;
  return log_grid_count(options->rp_min, options->rp_max, options->per_decade);
}

bool scree_choice_is_recommended(const char *rp, double *factor) {
  static const char word[] = "recommended";
  char number[SCREE_NUMBER_SIZE];
  size_t length = strcspn(rp, "*");
  *factor = 1;
  if (!rp[length]) return !strcmp(rp, word);
  if (length >= sizeof number || strcmp(rp + length + 1, word) != 0) return false;
  memcpy(number, rp, length);
  number[length] = 0;
  return scree_number_read(number, factor) && *factor > 0 && *factor < INFINITY;
}

size_t scree_choice_target(double rp, size_t triangle_count) {
  return (size_t)(rp * (double)triangle_count * (1 + TARGET_SLACK));
}

size_t scree_level_find(const scree_level_table *table, size_t target) {
  SCREE_FIND_FIRST(i, 0, table->count - 1, table->row(table->context, i).triangle_count > target)
  return i;
}

/* The best level so far by the worst error. */
typedef struct leader {
  size_t index;
  double worst, eps, ip;
} leader;

/* The state of the pass over the levels. */
typedef struct pass {
  const scree_choice_options *options;
  const scree_noise *noise;
  double triangle_count, reference, scan_volume;
  scree_level_row row; /* at the level under the pass */
  size_t index;
  double penalty, eps, worst;
  leader robust;
} pass;

/* Moves the pass to the next level: the errors there and the envelopes so far. */
static void pass_enter(pass *p, size_t index, scree_level_row row) {
  p->index = index;
  p->row = row;
  p->penalty = p->options->weight * (double)row.triangle_count / p->triangle_count;
  p->eps = fabs(row.area - p->reference) / p->reference;
  /* finer than the plateau the error is the noise itself: it must not hide the shape's behind it */
  bool forget = p->options->reference == SCREE_REFERENCE_SMOOTH && index <= p->noise->level_index;
  if (forget || p->eps > p->worst) p->worst = p->eps;
}

static void record_level(const pass *p, scree_choice_level *level, size_t target) {
  level->level_index = p->index;
  level->triangle_count = p->row.triangle_count;
  level->rp_reached = (double)p->row.triangle_count / p->triangle_count;
  level->reached = p->row.triangle_count <= target;
  level->area = p->row.area;
  level->volume = p->row.volume;
  level->eps_s = p->eps;
  level->ip = p->eps + p->penalty;
  level->worst_eps_s = p->worst;
  level->robust_ip = p->worst + p->penalty;
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++) level->errors[e] = NAN;
  level->errors[SCREE_ERROR_AREA] = p->eps;
  level->errors[SCREE_ERROR_VOLUME] = fabs(p->row.volume - p->scan_volume) / fabs(p->scan_volume);
}

/* Keeps the level under the pass where its criterion is not above the best: with counts falling,
 * ties go to the fewest triangles. */
static void keep_best(pass *p) {
  double ip = p->worst + p->penalty;
  if (p->index > 0 && ip > p->robust.ip) return;
  p->robust = (leader){p->index, p->worst, p->eps, ip};
}

static scree_pick pick_of(const pass *p, const scree_level_table *table, const leader *best) {
  scree_level_row row = table->row(table->context, best->index);
  double rp = (double)row.triangle_count / p->triangle_count;
  return (scree_pick){.rp = rp,
                      .level_index = best->index,
                      .triangle_count = row.triangle_count,
                      .area = row.area,
                      .volume = row.volume,
                      .eps_s = best->eps,
                      .ip = best->eps + p->options->weight * rp,
                      .worst_eps_s = best->worst,
                      .robust_ip = best->ip};
}

/* How sharp a choice is, from the levels it is to be seen among. */
static void find_similar(const scree_choice_level *levels, size_t count, bool robust,
                         scree_pick *pick) {
  pick->fewest = pick->most = pick->triangle_count;
  for (size_t i = 0; i < count; i++) {
    size_t here = levels[i].triangle_count;
    double ip = robust ? levels[i].robust_ip : levels[i].ip;
    if (ip > SCREE_SIMILAR_IP * (robust ? pick->robust_ip : pick->ip)) continue;
    if (here < pick->fewest) pick->fewest = here;
    if (here > pick->most) pick->most = here;
  }
}

/* Levels yet to be filled, from the finest down. */
typedef struct filling {
  scree_choice_level *levels;
  size_t left, target; /* target: triangles of the next one */
} filling;

static void aim(filling *f, double triangle_count) {
  if (f->left) f->target = scree_choice_target(f->levels[f->left - 1].rp, (size_t)triangle_count);
}

static void fill_reached(const pass *p, filling *f, bool last) {
  while (f->left && (p->row.triangle_count <= f->target || last)) {
    record_level(p, &f->levels[--f->left], f->target);
    aim(f, p->triangle_count);
  }
}

/* Fills the levels whose target the pass has reached: mostly none. */
static inline void fill_levels(const pass *p, filling *f, bool last) {
  if (p->row.triangle_count <= f->target || last) fill_reached(p, f, last);
}

static scree_status check_row(scree_level_row row, size_t index, scree_error *error) {
  if (row.triangle_count && row.area >= 0 && row.area < INFINITY) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_MESH, "level %zu: %zu triangles of area %g m2", index,
                    row.triangle_count, row.area);
}

static scree_status run_pass(const scree_level_table *table, const scree_choice_options *options,
                             scree_choice *choice, scree_error *error) {
  pass p = {.options = options,
            .noise = &choice->noise,
            .triangle_count = (double)choice->triangle_count,
            .reference = choice->reference_area,
            .scan_volume = choice->volume};
  filling grid = {choice->levels, choice->level_count, 0};
  filling trace = {choice->trace, choice->trace_count, 0};
  aim(&grid, p.triangle_count);
  aim(&trace, p.triangle_count);
  for (size_t i = 0; i < table->count; i++) {
    scree_level_row row = table->row(table->context, i);
    SCREE_TRY(check_row(row, i, error));
    pass_enter(&p, i, row);
    keep_best(&p);
    fill_levels(&p, &grid, i + 1 == table->count);
    fill_levels(&p, &trace, i + 1 == table->count);
  }
  choice->floor_count = p.row.triangle_count;
  choice->robust = pick_of(&p, table, &p.robust);
  return SCREE_OK;
}

/* How far the grid's Rp is from the one reached, in decades. */
static double misfit(const scree_choice_level *level) {
  return fabs(log10(level->rp / level->rp_reached));
}

/* The grid index with the least value of error + w Nr/Nm, unless one that was not measured (NaN)
 * has less by its triangles alone. */
size_t scree_choice_best_level(const scree_choice *choice, scree_shape_error which, double weight) {
  size_t best = choice->level_count;
  double best_ip = INFINITY, unknown = INFINITY;
  for (size_t i = 0; i < choice->level_count; i++) {
    const scree_choice_level *level = &choice->levels[i];
    double penalty = weight * level->rp_reached, ip = level->errors[which] + penalty;
    if (isnan(ip)) unknown = fmin(unknown, penalty);
    bool nearer = best < choice->level_count && ip == best_ip &&
                  level->triangle_count == choice->levels[best].triangle_count &&
                  misfit(level) < misfit(&choice->levels[best]);
    if (ip < best_ip || nearer) {
      best = i;
      best_ip = ip;
    }
  }
  return unknown < best_ip ? choice->level_count : best;
}

scree_status scree_choice_check_options(const scree_choice_options *o, scree_error *error) {
  if (!(o->weight > 0 && o->weight < INFINITY))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "weight %g: must be above 0 and finite",
                      o->weight);
  if (!(o->rp_min > 0 && o->rp_min <= o->rp_max && o->rp_max <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "grid from %g to %g: must be 0 < smallest Rp <= largest Rp <= 1", o->rp_min,
                      o->rp_max);
  if (o->per_decade < 1 || o->per_decade > 1000)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "%d grid points per decade: must be from 1 to 1000", o->per_decade);
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    if (!(o->tolerances[e] > 0 && o->tolerance_lengths[e] > 0))
      return scree_fail(error, SCREE_BAD_ARGUMENT, "tolerance %g of %s: must be above 0",
                        fmin(o->tolerances[e], o->tolerance_lengths[e]),
                        scree_shape_error_name((scree_shape_error)e));
  if (o->rp_min < 1e-12)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "grid from %g: smaller than the limit 1e-12",
                      o->rp_min);
  return SCREE_OK;
}

static scree_status check_scan(scree_level_row scan, scree_error *error) {
  if (scan.triangle_count && scan.area > 0 && scan.area < INFINITY) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_MESH, "%zu triangles of area %g m2: no surface to judge",
                    scan.triangle_count, scan.area);
}

scree_status scree_choice_from_table(const scree_level_table *table,
                                     const scree_choice_options *options, scree_choice *choice,
                                     scree_error *error) {
  scree_level_row scan = table->row(table->context, 0);
  SCREE_TRY(scree_choice_check_options(options, error));
  SCREE_TRY(check_scan(scan, error));
  SCREE_CLEANUP(scree_choice_free)
  scree_choice filled = {.triangle_count = scan.triangle_count,
                         .area = scan.area,
                         .volume = scan.volume,
                         .noise = scree_noise_find(table),
                         .level_count = scree_choice_grid_count(options),
                         .trace_count = log_grid_count(options->rp_min, 1, SCREE_TRACE_PER_DECADE)};
  bool smooth = options->reference == SCREE_REFERENCE_SMOOTH;
  filled.reference_area = smooth ? filled.noise.area : filled.area;
  SCREE_TRY_ALLOC_ZERO(filled.levels, filled.level_count, error);
  SCREE_TRY_ALLOC_ZERO(filled.trace, filled.trace_count, error);
  for (size_t i = 0; i < filled.level_count; i++)
    filled.levels[i].rp = scree_choice_grid_rp(options, i);
  for (size_t i = 0; i < filled.trace_count; i++)
    filled.trace[i].rp = log_grid(options->rp_min, SCREE_TRACE_PER_DECADE, i);
  SCREE_TRY(run_pass(table, options, &filled, error));
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    filled.best[e] = scree_choice_best_level(&filled, (scree_shape_error)e, options->weight);
  size_t finer =
      scree_choice_best_level(&filled, SCREE_ERROR_AREA, SCREE_FINER_PENALTY * options->weight);
  filled.paper_finer_count = filled.levels[finer].triangle_count;
  const scree_choice_level *paper = &filled.levels[filled.best[SCREE_ERROR_AREA]];
  filled.paper = (scree_pick){.rp = paper->rp,
                              .level_index = paper->level_index,
                              .triangle_count = paper->triangle_count,
                              .area = paper->area,
                              .volume = paper->volume,
                              .eps_s = paper->eps_s,
                              .ip = paper->ip,
                              .worst_eps_s = paper->worst_eps_s,
                              .robust_ip = paper->robust_ip};
  filled.paper_is_accident = is_accident(paper->eps_s, paper->worst_eps_s);
  find_similar(filled.levels, filled.level_count, false, &filled.paper);
  find_similar(filled.trace, filled.trace_count, true, &filled.robust);
  filled.recommended = filled.robust;
  *choice = filled;
  filled = (scree_choice){0};
  return SCREE_OK;
}

void scree_choice_free(scree_choice *choice) {
  if (!choice) return;
  scree_fidelity_free(choice->fidelity);
  scree_free(choice->levels);
  scree_free(choice->trace);
  *choice = (scree_choice){0};
}
