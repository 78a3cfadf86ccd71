/* From a curve to a choice. The recommended level is looked for in each of the curve's orders, and
 * the coarsest kept: what one order comes to scatters, by a third on a phone's hinge, and the least
 * of three half as much. Area and volume come with the curve and cost nothing; the other errors
 * need the levels' meshes. For telling, they are measured in one sweep over the usual levels and
 * those of the grid. */
#include "base/alloc.h"
#include "choice/criterion.h"
#include "choice/fidelity.h"
#include "choice/recommend.h"
#include "simplify/curve.h"

#include <stdlib.h>

static scree_level_row curve_row(const void *context, size_t index) {
  scree_level level;
  scree_curve_level(context, index, &level);
  return (scree_level_row){level.triangle_count, level.area, level.volume};
}

static int ascending(const void *a, const void *b) {
  size_t x = *(const size_t *)a, y = *(const size_t *)b;
  return (x > y) - (x < y);
}

/* The levels to measure, ascending, each once, of the grid those of at most so many triangles;
 * indices has room for SCREE_FIDELITY_MOST and the grid. */
static size_t list_levels(const scree_curve *curve, const scree_choice *choice, size_t most,
                          size_t *indices) {
  size_t count = scree_fidelity_levels(curve, indices), kept = 0;
  for (size_t i = 0; i < choice->level_count; i++)
    if (choice->levels[i].triangle_count <= most) indices[count++] = choice->levels[i].level_index;
  qsort(indices, count, sizeof *indices, ascending);
  for (size_t i = 0; i < count; i++)
    if (kept == 0 || indices[i] != indices[kept - 1]) indices[kept++] = indices[i];
  return kept;
}

/* Gives the grid's levels that were measured their errors. */
static void fill_errors(scree_choice *choice, double weight) {
  const scree_fidelity *f = choice->fidelity;
  size_t rows = scree_fidelity_count(f);
  for (size_t i = 0; i < choice->level_count; i++) {
    size_t row = 0;
    while (row < rows && scree_fidelity_level_index(f, row) != choice->levels[i].level_index) row++;
    for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT && row < rows; e++)
      choice->levels[i].errors[e] = scree_fidelity_error(f, row, (scree_shape_error)e);
  }
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    if (e != SCREE_ERROR_AREA)
      choice->best[e] = scree_choice_best_level(choice, (scree_shape_error)e, weight);
}

/* A pick off the grid. */
static scree_pick pick_at(const scree_curve *curve, const scree_choice *choice, size_t level_index,
                          double weight) {
  scree_level level;
  scree_curve_level(curve, level_index, &level);
  double eps = fabs(level.area - choice->reference_area) / choice->reference_area;
  double rp = (double)level.triangle_count / (double)choice->triangle_count;
  return (scree_pick){.rp = rp,
                      .level_index = level_index,
                      .triangle_count = level.triangle_count,
                      .area = level.area,
                      .volume = level.volume,
                      .eps_s = eps,
                      .ip = eps + weight * rp,
                      .worst_eps_s = NAN,
                      .robust_ip = NAN,
                      .fewest = level.triangle_count,
                      .most = level.triangle_count};
}

/* What a choice is measured with. */
typedef struct gauges {
  scree_gauge quick, dense;
  double tolerances[SCREE_SHAPE_ERROR_COUNT];
} gauges;

static void gauges_free(gauges *g) {
  scree_gauge_free(&g->dense);
  scree_gauge_free(&g->quick);
}

static scree_status gauges_make(const scree_mesh *scan, const scree_choice_options *options,
                                gauges *g, scree_error *error) {
  SCREE_TRY(scree_gauge_make(scan, SCREE_GAUGE_POINTS, &g->quick, error));
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    g->tolerances[e] = scree_tolerance_share(options, (scree_shape_error)e, g->quick.length);
  return scree_recommend_gauge(&g->quick, &g->dense, error);
}

/* The coarsest of the recommended levels of all orders; the curve is left in that one. */
static scree_status recommend(scree_curve *curve, const gauges *g, scree_recommended *found,
                              scree_error *error) {
  int best = 0;
  for (int order = 0; order < scree_curve_order_count(curve); order++) {
    bool is_found;
    SCREE_TRY(scree_curve_reorder(curve, order, error));
    size_t below = order ? found->triangle_count : SIZE_MAX;
    SCREE_TRY(scree_recommend(curve, &g->quick, &g->dense, g->tolerances, below, &is_found, found,
                              error));
    if (is_found) best = order;
    if (!scree_curve_is_below_fork(curve, found->level_index)) break;
  }
  return scree_curve_reorder(curve, best, error);
}

static scree_status measure(const scree_curve *curve, const gauges *g,
                            const scree_recommended *found, const scree_choice_options *options,
                            const scree_progress *progress, scree_choice *choice,
                            scree_error *error) {
  SCREE_SCRATCH(size_t, indices, SCREE_FIDELITY_MOST + choice->level_count, error);
  size_t count =
      list_levels(curve, choice, options->fine_errors ? SIZE_MAX : SCREE_FIDELITY_FINEST, indices);
  SCREE_TRY(
      scree_fidelity_sweep(&g->quick, curve, indices, count, progress, &choice->fidelity, error));
  fill_errors(choice, options->weight);
  choice->recommended = pick_at(curve, choice, found->level_index, options->weight);
  choice->largest_over_tolerance =
      scree_normalised_error(found->reading.errors, g->tolerances, NULL);
  choice->limited_by = found->limited_by;
  choice->limit_beyond = found->is_last ? NAN : found->beyond;
  return scree_fidelity_insert(choice->fidelity, found->level_index,
                               choice->recommended.triangle_count, &found->reading,
                               &choice->recommended_row, error);
}

scree_status scree_choose(scree_curve *curve, const scree_mesh *scan,
                          const scree_choice_options *options, const scree_progress *progress,
                          scree_choice *choice, scree_error *error) {
  scree_choice_options defaults = scree_default_choice_options();
  if (!options) options = &defaults;
  const bool by_errors = scan && !options->area_only;
  SCREE_CLEANUP(gauges_free) gauges g = {0};
  SCREE_CLEANUP(scree_choice_free) scree_choice chosen = {0};
  scree_recommended found = {.is_last = false};
  SCREE_TRY(scree_choice_check_options(options, error));
  if (by_errors) {
    SCREE_TRY(gauges_make(scan, options, &g, error));
    SCREE_TRY(recommend(curve, &g, &found, error));
  }
  scree_level_table table = {scree_curve_level_count(curve), curve_row, curve};
  SCREE_TRY(scree_choice_from_table(&table, options, &chosen, error));
  chosen.order = scree_curve_order(curve);
  if (by_errors) SCREE_TRY(measure(curve, &g, &found, options, progress, &chosen, error));
  *choice = chosen;
  chosen = (scree_choice){0};
  return SCREE_OK;
}

scree_status scree_choose_mesh(scree_mesh *scan, double scale, const scree_progress *progress,
                               scree_mesh *mesh, scree_choice *choice, scree_error *error) {
  scree_curve *curve = NULL;
  scree_choice chosen = {0};
  SCREE_TRY(scree_curve_build_scaled(scan, scale, NULL, progress, &curve, error));
  scree_status status = scree_choose(curve, scan, NULL, progress, &chosen, error);
  if (status == SCREE_OK)
    status = scree_curve_mesh(curve, chosen.recommended.level_index, mesh, error);
  scree_curve_free(curve);
  if (status == SCREE_OK && choice)
    *choice = chosen;
  else
    scree_choice_free(&chosen);
  return status;
}
