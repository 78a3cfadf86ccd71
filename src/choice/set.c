/* One Rp for several objects, as the paper's 1e-3 for its nine: the least mean of Ip over the
 * objects at each Rp, each object weighing the same. The scatter between the objects stays visible:
 * least and largest Ip at each Rp, and how far the objects' own choices lie apart. */
#include "base/alloc.h"
#include "base/sum.h"
#include "choice/criterion.h"

/* The best Rp so far. Where meshes cannot be reduced further several Rp give the same levels; then
 * the one nearest to what was reached stands for them. Other ties go to the smaller Rp. */
typedef struct best_rp {
  double rp, ip, misfit;
  size_t triangle_count; /* of all objects together */
} best_rp;

/* The points of a criterion, Rp rising: the paper's grid, or the trace. */
typedef struct points {
  const scree_choice *choices;
  size_t object_count, count;
  scree_criterion criterion;
  double relief; /* the part of the penalty that does not count */
} points;

static points points_of(const scree_choice *choices, size_t count, scree_criterion criterion) {
  bool grid = criterion == SCREE_PLAIN_IP;
  return (points){choices, count, grid ? choices->level_count : choices->trace_count, criterion, 0};
}

static const scree_choice_level *level_at(const points *p, size_t object, size_t index) {
  const scree_choice *choice = &p->choices[object];
  return p->criterion == SCREE_PLAIN_IP ? &choice->levels[index] : &choice->trace[index];
}

static double mean_ip(const points *p, size_t index) {
  scree_sum sum = {0, 0};
  for (size_t k = 0; k < p->object_count; k++) {
    const scree_choice_level *level = level_at(p, k, index);
    double penalty = level->ip - level->eps_s;
    scree_sum_add(&sum, scree_level_ip(level, p->criterion) - p->relief * penalty);
  }
  return scree_sum_value(sum) / (double)p->object_count;
}

static void consider(const points *p, size_t index, best_rp *best) {
  scree_sum misfit = {0, 0};
  best_rp here = {.rp = level_at(p, 0, index)->rp, .ip = mean_ip(p, index)};
  for (size_t k = 0; k < p->object_count; k++) {
    const scree_choice_level *level = level_at(p, k, index);
    scree_sum_add(&misfit, fabs(log(level->rp / level->rp_reached)));
    here.triangle_count += level->triangle_count;
  }
  here.misfit = scree_sum_value(misfit);
  bool same = here.ip == best->ip && here.triangle_count == best->triangle_count;
  if (here.ip < best->ip || (same && here.misfit < best->misfit)) *best = here;
}

static best_rp find_best(const points *p) {
  best_rp best = {.ip = INFINITY};
  for (size_t i = 0; i < p->count; i++) consider(p, i, &best);
  return best;
}

static scree_set_pick pick_for_set(const scree_choice *choices, size_t count,
                                   scree_criterion criterion) {
  const points p = points_of(choices, count, criterion);
  best_rp best = find_best(&p);
  scree_set_pick pick = {best.rp, best.ip, best.rp, best.rp};
  for (size_t i = 0; i < p.count; i++) {
    if (mean_ip(&p, i) > SCREE_SIMILAR_IP * best.ip) continue;
    pick.rp_low = fmin(pick.rp_low, level_at(&p, 0, i)->rp);
    pick.rp_high = fmax(pick.rp_high, level_at(&p, 0, i)->rp);
  }
  return pick;
}

/* How many times the triangles of the pick a set of scans of half the spacing would take. */
static double growth_of(const scree_choice *choices, size_t count, scree_criterion criterion,
                        const scree_set_pick *pick) {
  points p = points_of(choices, count, criterion);
  p.relief = 1 - SCREE_FINER_PENALTY;
  return find_best(&p).rp / pick->rp;
}

static void fill_grid(const scree_choice *choices, size_t count, scree_set_choice *set) {
  const points p = points_of(choices, count, SCREE_PLAIN_IP);
  for (size_t i = 0; i < set->level_count; i++) {
    set->ip[i] = mean_ip(&p, i);
    set->low[i] = INFINITY;
    set->high[i] = -INFINITY;
    for (size_t k = 0; k < count; k++) {
      set->low[i] = fmin(set->low[i], choices[k].levels[i].ip);
      set->high[i] = fmax(set->high[i], choices[k].levels[i].ip);
    }
  }
}

static void fill_spread(const scree_choice *choices, size_t count, scree_set_choice *set) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {0, 0};
  for (size_t k = 0; k < count; k++) {
    double rp[2] = {choices[k].paper.rp, choices[k].robust.rp};
    for (int i = 0; i < 2; i++) {
      low[i] = fmin(low[i], rp[i]);
      high[i] = fmax(high[i], rp[i]);
    }
  }
  set->paper_spread = high[0] / low[0];
  set->robust_spread = high[1] / low[1];
}

static scree_status check_choices(const scree_choice *choices, size_t count, scree_error *error) {
  if (count == 0) return scree_fail(error, SCREE_BAD_ARGUMENT, "no object to choose for");
  for (size_t k = 1; k < count; k++)
    if (choices[k].level_count != choices[0].level_count ||
        choices[k].trace_count != choices[0].trace_count ||
        choices[k].levels[0].rp != choices[0].levels[0].rp)
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "object %zu was chosen on another grid than object 0", k);
  return SCREE_OK;
}

scree_status scree_choose_set(const scree_choice *choices, size_t count, scree_set_choice *set,
                              scree_error *error) {
  SCREE_TRY(check_choices(choices, count, error));
  SCREE_CLEANUP(scree_set_choice_free)
  scree_set_choice filled = {.object_count = count, .level_count = choices[0].level_count};
  SCREE_TRY_ALLOC(filled.ip, filled.level_count, error);
  SCREE_TRY_ALLOC(filled.low, filled.level_count, error);
  SCREE_TRY_ALLOC(filled.high, filled.level_count, error);
  fill_grid(choices, count, &filled);
  fill_spread(choices, count, &filled);
  filled.paper = pick_for_set(choices, count, SCREE_PLAIN_IP);
  filled.robust = pick_for_set(choices, count, SCREE_ROBUST_IP);
  filled.smooth = pick_for_set(choices, count, SCREE_SMOOTH_IP);
  filled.paper_growth = growth_of(choices, count, SCREE_PLAIN_IP, &filled.paper);
  filled.robust_growth = growth_of(choices, count, SCREE_ROBUST_IP, &filled.robust);
  *set = filled;
  filled = (scree_set_choice){0};
  return SCREE_OK;
}

void scree_set_choice_free(scree_set_choice *set) {
  if (!set) return;
  scree_free(set->ip);
  scree_free(set->low);
  scree_free(set->high);
  *set = (scree_set_choice){0};
}
