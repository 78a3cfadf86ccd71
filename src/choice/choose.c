/* From a curve to a choice. Area and volume come with the curve and cost nothing; the other errors
 * need the levels' meshes. They are measured in one sweep over the levels that the recommended
 * choice is made from and those of the grid. */
#include "base/alloc.h"
#include "choice/criterion.h"
#include "choice/fidelity.h"
#include "choice/recommend.h"

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

/* A pick off the grid, with what it is judged by. */
static scree_pick pick_at(const scree_curve *curve, const scree_choice *choice, size_t level_index,
                          double ip) {
  scree_level level;
  scree_curve_level(curve, level_index, &level);
  double eps = fabs(level.area - choice->reference_area) / choice->reference_area;
  return (scree_pick){.rp = (double)level.triangle_count / (double)choice->triangle_count,
                      .level_index = level_index,
                      .triangle_count = level.triangle_count,
                      .area = level.area,
                      .volume = level.volume,
                      .eps_s = eps,
                      .ip = ip,
                      .level_eps_s = eps,
                      .fewest = level.triangle_count,
                      .most = level.triangle_count};
}

static scree_status choose_by_cost(const scree_curve *curve, scree_choice *choice,
                                   scree_error *error) {
  const scree_fidelity *f = choice->fidelity;
  size_t count = 0, rows = scree_fidelity_count(f);
  SCREE_SCRATCH(scree_kept, levels, rows, error);
  for (size_t i = 0; i < rows; i++)
    if (scree_fidelity_is_usual(f, i))
      levels[count++] = (scree_kept){scree_fidelity_triangle_count(f, i),
                                     scree_fidelity_error(f, i, SCREE_ERROR_MEAN)};
  scree_least least = scree_trend_least(levels, count, SCREE_COST_COUNT);
  choice->cost =
      pick_at(curve, choice, scree_curve_find(curve, (size_t)least.triangle_count), least.sum);
  choice->cost.fewest = (size_t)least.fewest;
  choice->cost.most = (size_t)least.most;
  return SCREE_OK;
}

static scree_status measure(const scree_curve *curve, const scree_mesh *scan,
                            const scree_choice_options *options, const scree_progress *progress,
                            scree_choice *choice, scree_error *error) {
  SCREE_CLEANUP(scree_gauge_free) scree_gauge gauge = {0};
  scree_recommended found;
  SCREE_SCRATCH(size_t, indices, SCREE_FIDELITY_MOST + choice->level_count, error);
  size_t count =
      list_levels(curve, choice, options->fine_errors ? SIZE_MAX : SCREE_FIDELITY_FINEST, indices);
  SCREE_TRY(scree_gauge_make(scan, SCREE_GAUGE_POINTS, &gauge, error));
  SCREE_TRY(
      scree_fidelity_sweep(&gauge, curve, indices, count, progress, &choice->fidelity, error));
  fill_errors(choice, options->weight);
  SCREE_TRY(choose_by_cost(curve, choice, error));
  double tolerances[SCREE_SHAPE_ERROR_COUNT];
  for (int e = 0; e < SCREE_SHAPE_ERROR_COUNT; e++)
    tolerances[e] = scree_choice_tolerance(choice, options, (scree_shape_error)e);
  SCREE_TRY(scree_recommend(curve, &gauge, choice->fidelity, tolerances, &found, error));
  double load = scree_normalised_error(found.reading.errors, tolerances, &choice->limited_by);
  choice->recommended = pick_at(curve, choice, found.level_index, load);
  return scree_fidelity_insert(choice->fidelity, found.level_index,
                               choice->recommended.triangle_count, &found.reading,
                               &choice->recommended_row, error);
}

scree_status scree_choose(const scree_curve *curve, const scree_mesh *scan,
                          const scree_choice_options *options, const scree_progress *progress,
                          scree_choice *choice, scree_error *error) {
  scree_choice_options defaults = scree_default_choice_options();
  if (!options) options = &defaults;
  scree_level_table table = {scree_curve_level_count(curve), curve_row, curve};
  SCREE_CLEANUP(scree_choice_free) scree_choice chosen = {0};
  SCREE_TRY(scree_choice_from_table(&table, options, &chosen, error));
  if (scan && !options->area_only)
    SCREE_TRY(measure(curve, scan, options, progress, &chosen, error));
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
