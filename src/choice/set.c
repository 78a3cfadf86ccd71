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

/* The objects; relief: the part of the penalty that does not count. */
typedef struct objects {
  const scree_choice *choices;
  size_t count;
  double relief;
} objects;

static double mean_ip(const objects *o, size_t index) {
  scree_sum sum = {0, 0};
  for (size_t k = 0; k < o->count; k++) {
    const scree_choice_level *level = &o->choices[k].levels[index];
    double penalty = level->ip - level->eps_s;
    scree_sum_add(&sum, level->ip - o->relief * penalty);
  }
  return scree_sum_value(sum) / (double)o->count;
}

static void consider(const objects *o, size_t index, best_rp *best) {
  scree_sum misfit = {0, 0};
  best_rp here = {.rp = o->choices->levels[index].rp, .ip = mean_ip(o, index)};
  for (size_t k = 0; k < o->count; k++) {
    const scree_choice_level *level = &o->choices[k].levels[index];
    scree_sum_add(&misfit, fabs(log(level->rp / level->rp_reached)));
    here.triangle_count += level->triangle_count;
  }
  here.misfit = scree_sum_value(misfit);
  bool same = here.ip == best->ip && here.triangle_count == best->triangle_count;
  if (here.ip < best->ip || (same && here.misfit < best->misfit)) *best = here;
}

static best_rp find_best(const objects *o) {
  best_rp best = {.ip = INFINITY};
  for (size_t i = 0; i < o->choices->level_count; i++) consider(o, i, &best);
  return best;
}

static scree_set_pick pick_for_set(const objects *o) {
  best_rp best = find_best(o);
  const scree_choice *first = o->choices;
  scree_set_pick pick = {best.rp, best.ip, best.rp, best.rp};
  for (size_t i = 0; i < first->level_count; i++) {
    if (mean_ip(o, i) > SCREE_SIMILAR_IP * best.ip) continue;
    pick.rp_low = fmin(pick.rp_low, first->levels[i].rp);
    pick.rp_high = fmax(pick.rp_high, first->levels[i].rp);
  }
  return pick;
}

static void fill_grid(const objects *o, scree_set_choice *set) {
  for (size_t i = 0; i < set->level_count; i++) {
    set->ip[i] = mean_ip(o, i);
    set->low[i] = INFINITY;
    set->high[i] = -INFINITY;
    for (size_t k = 0; k < o->count; k++) {
      set->low[i] = fmin(set->low[i], o->choices[k].levels[i].ip);
      set->high[i] = fmax(set->high[i], o->choices[k].levels[i].ip);
    }
  }
}

static double spread_of(const objects *o) {
  double low = INFINITY, high = 0;
  for (size_t k = 0; k < o->count; k++) {
    low = fmin(low, o->choices[k].paper.rp);
    high = fmax(high, o->choices[k].paper.rp);
  }
  return high / low;
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
  const objects all = {choices, count, 0},
                twice_as_fine = {choices, count, 1 - SCREE_FINER_PENALTY};
  fill_grid(&all, &filled);
  filled.paper_spread = spread_of(&all);
  filled.paper = pick_for_set(&all);
  filled.paper_growth = find_best(&twice_as_fine).rp / filled.paper.rp;
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
