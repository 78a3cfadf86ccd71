/* From a curve to a choice, and the errors beside area. Area and volume come with the curve and
 * cost nothing; inertia, size and distances need the meshes, so they are measured at the grid's
 * levels only, in one sweep from fine to coarse. */
#include "base/alloc.h"
#include "base/progress.h"
#include "base/vec.h"
#include "choice/criterion.h"

static scree_level_row curve_row(const void *context, size_t index) {
  scree_level level;
  scree_curve_level(context, index, &level);
  return (scree_level_row){level.triangle_count, level.area, level.volume};
}

/* What the levels are compared with. */
typedef struct comparison {
  const scree_choice_options *options;
  scree_measures measures;
  scree_surface *surface; /* of the scan; NULL without distances */
  double length;          /* diameter of the sphere of the scan's area */
} comparison;

static double inertia_error(const scree_measures *a, const scree_measures *b) {
  double difference = 0, size = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double d = a->inertia[i][j] - b->inertia[i][j];
      difference += d * d;
      size += b->inertia[i][j] * b->inertia[i][j];
    }
  return sqrt(difference / size);
}

static double size_error(const scree_measures *a, const scree_measures *b) {
  double worst = 0;
  for (int i = 0; i < 3; i++)
    worst = fmax(worst, fabs(a->oriented_dimensions[i] / b->oriented_dimensions[i] - 1));
  return worst;
}

static scree_status measure_level(const comparison *c, const scree_mesh *mesh, double *errors,
                                  scree_error *error) {
  scree_status status = SCREE_OK;
  if (c->options->shape_errors) {
    scree_measures measures;
    status = scree_mesh_measure(mesh, &measures, error);
    if (status != SCREE_OK) return status;
    errors[SCREE_ERROR_INERTIA] = inertia_error(&measures, &c->measures);
    errors[SCREE_ERROR_SIZE] = size_error(&measures, &c->measures);
  }
  if (c->options->distances) {
    scree_surface *surface;
    scree_distance distance;
    status = scree_surface_create(mesh, &surface, error);
    if (status != SCREE_OK) return status;
    status = scree_surface_distance(c->surface, surface, NULL, NULL, &distance, error);
    scree_surface_free(surface);
    if (status != SCREE_OK) return status;
    errors[SCREE_ERROR_HAUSDORFF] = distance.hausdorff / c->length;
    errors[SCREE_ERROR_MEAN] = fmax(distance.forward.mean, distance.backward.mean) / c->length;
  }
  return status;
}

/* All grid levels, from fine to coarse; a level that stands for several Rp is measured once. */
static scree_status measure_levels(const comparison *c, scree_replay *replay,
                                   const scree_progress *progress, scree_choice *choice,
                                   scree_error *error) {
  scree_ticker ticker = {progress, 0};
  for (size_t i = choice->level_count; i-- > 0;) {
    scree_choice_level *level = &choice->levels[i];
    if (!scree_tick(&ticker, "measuring levels", 1 - (double)(i + 1) / (double)choice->level_count))
      return scree_fail(error, SCREE_CANCELLED, "cancelled while measuring levels");
    const scree_choice_level *finer = level + 1;
    if (i + 1 < choice->level_count && finer->level_index == level->level_index) {
      for (int e = SCREE_ERROR_HAUSDORFF; e < SCREE_SHAPE_ERROR_COUNT; e++)
        level->errors[e] = finer->errors[e];
      continue;
    }
    const scree_mesh *mesh;
    scree_status status = scree_replay_step(replay, level->level_index, &mesh, error);
    if (status == SCREE_OK) status = measure_level(c, mesh, level->errors, error);
    if (status != SCREE_OK) return status;
  }
  return SCREE_OK;
}

static scree_status measure_shapes(const scree_curve *curve, const scree_mesh *scan,
                                   const scree_choice_options *options,
                                   const scree_progress *progress, scree_choice *choice,
                                   scree_error *error) {
  comparison c = {.options = options, .length = sqrt(choice->area / acos(-1))};
  scree_replay *replay = NULL;
  scree_status status = SCREE_OK;
  if (options->shape_errors) status = scree_mesh_measure(scan, &c.measures, error);
  if (status == SCREE_OK && options->distances)
    status = scree_surface_create(scan, &c.surface, error);
  if (status == SCREE_OK) status = scree_replay_start(curve, &replay, error);
  if (status == SCREE_OK) status = measure_levels(&c, replay, progress, choice, error);
  scree_replay_free(replay);
  scree_surface_free(c.surface);
  if (status != SCREE_OK) return status;
  for (int e = SCREE_ERROR_HAUSDORFF; e < SCREE_SHAPE_ERROR_COUNT; e++)
    choice->best[e] = scree_choice_best_level(choice, (scree_shape_error)e, options->weight);
  return SCREE_OK;
}

scree_status scree_choose(const scree_curve *curve, const scree_mesh *scan,
                          const scree_choice_options *options, const scree_progress *progress,
                          scree_choice *choice, scree_error *error) {
  scree_choice_options defaults = scree_default_choice_options();
  if (!options) options = &defaults;
  bool shapes = options->shape_errors || options->distances;
  if (shapes && !scan)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "other errors than area need the scan's mesh");
  scree_level_table table = {scree_curve_level_count(curve), curve_row, curve};
  scree_choice chosen;
  scree_status status = scree_choice_from_table(&table, options, &chosen, error);
  if (status != SCREE_OK) return status;
  if (shapes) status = measure_shapes(curve, scan, options, progress, &chosen, error);
  if (status == SCREE_OK)
    *choice = chosen;
  else
    scree_choice_free(&chosen);
  return status;
}
