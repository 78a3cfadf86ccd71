/* One Rp for several objects, as the paper's 1e-3 for its nine: the least mean of Ip over the
 * objects at each Rp, each object weighing the same. The scatter between the objects stays visible:
 * least and largest Ip at each Rp, and how far the objects' own choices lie apart. */
#include "base/alloc.h"
#include "base/sum.h"
#include "choice/criterion.h"

typedef enum { PLAIN_IP, ROBUST_IP, SMOOTH_IP } criterion_kind;

static double criterion_of(const scree_choice_level *level, criterion_kind kind) {
  return kind == PLAIN_IP ? level->ip : kind == ROBUST_IP ? level->robust_ip : level->smooth_ip;
}

/* The best Rp so far. Where meshes cannot be reduced further several Rp give the same levels; then
 * the one nearest to what was reached stands for them. Other ties go to the smaller Rp. */
typedef struct best_rp {
  double rp, ip, misfit;
  size_t triangle_count; /* of all objects together */
} best_rp;

/* Takes point `index` into account; the points come with Rp rising. Returns the mean there. */
static double consider(const scree_choice *choices, size_t count, criterion_kind kind, size_t index,
                       best_rp *best) {
  scree_sum sum = {0, 0}, misfit = {0, 0};
  best_rp here = {0};
  for (size_t k = 0; k < count; k++) {
    const scree_choice_level *level =
        kind == PLAIN_IP ? &choices[k].levels[index] : &choices[k].trace[index];
    scree_sum_add(&sum, criterion_of(level, kind));
    scree_sum_add(&misfit, fabs(log(level->rp / level->rp_reached)));
    here.triangle_count += level->triangle_count;
    here.rp = level->rp;
  }
  here.ip = scree_sum_value(sum) / (double)count;
  here.misfit = scree_sum_value(misfit);
  bool same = here.ip == best->ip && here.triangle_count == best->triangle_count;
  if (here.ip < best->ip || (same && here.misfit < best->misfit)) *best = here;
  return here.ip;
}

static void best_on_trace(const scree_choice *choices, size_t count, criterion_kind kind,
                          double *rp, double *ip) {
  best_rp best = {.ip = INFINITY};
  for (size_t i = 0; i < choices[0].trace_count; i++) consider(choices, count, kind, i, &best);
  *rp = best.rp;
  *ip = best.ip;
}

static void fill_grid(const scree_choice *choices, size_t count, scree_set_choice *set) {
  best_rp best = {.ip = INFINITY};
  for (size_t i = 0; i < set->level_count; i++) {
    set->ip[i] = consider(choices, count, PLAIN_IP, i, &best);
    set->low[i] = INFINITY;
    set->high[i] = -INFINITY;
    for (size_t k = 0; k < count; k++) {
      set->low[i] = fmin(set->low[i], choices[k].levels[i].ip);
      set->high[i] = fmax(set->high[i], choices[k].levels[i].ip);
    }
  }
  set->paper_rp = best.rp;
  set->paper_ip = best.ip;
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
  scree_status status = check_choices(choices, count, error);
  if (status != SCREE_OK) return status;
  scree_set_choice filled = {.object_count = count, .level_count = choices[0].level_count};
  filled.ip = scree_alloc(filled.level_count, sizeof(double));
  filled.low = scree_alloc(filled.level_count, sizeof(double));
  filled.high = scree_alloc(filled.level_count, sizeof(double));
  if (!filled.ip || !filled.low || !filled.high) {
    scree_set_choice_free(&filled);
    return scree_fail_memory(error, 3 * filled.level_count * sizeof(double), "the set's choice");
  }
  fill_grid(choices, count, &filled);
  fill_spread(choices, count, &filled);
  best_on_trace(choices, count, ROBUST_IP, &filled.robust_rp, &filled.robust_ip);
  best_on_trace(choices, count, SMOOTH_IP, &filled.smooth_rp, &filled.smooth_ip);
  *set = filled;
  return SCREE_OK;
}

void scree_set_choice_free(scree_set_choice *set) {
  if (!set) return;
  scree_free(set->ip);
  scree_free(set->low);
  scree_free(set->high);
  *set = (scree_set_choice){0};
}
