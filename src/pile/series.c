/* What a run records and measures: points of the series, the heap's angle, packing and
 * coordination. */
#include "pile/run.h"

#include "base/array.h"

#include <string.h>

static const double coarsest_cell = 0.5; /* particle sizes: a coarser height field shows none */

/* ---- the heap as it stands ---- */

static void observe_motion(const scree_run *run, scree_run_result *result) {
  scree_run_point now = scree_run_point_now(run);
  result->coordination = now.coordination;
  result->kinetic = now.kinetic;
  result->time = now.time;
  result->still = now.kinetic < run->experiment.still_energy * (double)now.body_count;
}

scree_status scree_run_check_measure(const scree_run *run, const scree_experiment *measure,
                                     scree_error *error) {
  double coarsest = coarsest_cell * run->size;
  if (measure->height_cell <= coarsest) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "measure.cell %g m: at most half the mean particle size, %.4g m",
                    measure->height_cell, coarsest);
}

scree_status scree_run_measure_with(const scree_run *run, const scree_experiment *measure,
                                    scree_run_result *result, scree_error *error) {
  scree_plan_pile plan = scree_run_pile(run, measure);
  scree_scene_heap heap;
  scree_status status = scree_run_check_measure(run, measure, error);
  if (status == SCREE_OK) status = scree_scene_measure_heap(run->scene, &plan, &heap, error);
  if (status != SCREE_OK) return status;
  *result = (scree_run_result){.repose = heap.repose,
                               .body_count = heap.body_count,
                               .left_count = run->scene->shape_of.count - heap.body_count,
                               .particle_size = run->size};
  observe_motion(run, result);
  /* plates side by side fill what is under them: there the field's own error may pass 1 */
  result->packing_fraction =
      heap.repose.envelope_volume > 0 ? fmin(1, heap.solid / heap.repose.envelope_volume) : NAN;
  return SCREE_OK;
}

scree_status scree_run_measure(const scree_run *run, scree_run_result *result, scree_error *error) {
  return scree_run_measure_with(run, &run->experiment, result, error);
}

/* ---- the series ---- */

scree_run_point scree_run_point_now(const scree_run *run) {
  scree_observation o;
  scree_world_observe(run->scene->world, &o);
  return (scree_run_point){
      .time = o.time,
      .phase = scree_run_phase(run),
      .body_count = o.body_count,
      .kinetic = o.kinetic + o.rotational,
      .mean_rotation = o.mean_rotation,
      .highest_speed = o.highest_speed,
      .largest_overlap = o.largest_overlap,
      .coordination = run->scene->is_frame ? run->scene->frame_coordination : o.coordination,
      .cylinder_height = scree_run_cylinder_height(run),
      .sector_deg = NAN,
      .cone_deg = NAN,
      .silhouette_deg = NAN,
      .height = NAN,
  };
}

static double value_of(const scree_scene *scene, const double *row, const char *name) {
  size_t k = 0;
  while (strcmp(scene->columns.items[k].name, name) != 0) k++;
  return row[k];
}

static scree_run_point point_of(const scree_scene *s, const double *row) {
  return (scree_run_point){.time = value_of(s, row, "time"),
                           .phase = (scree_phase)value_of(s, row, "phase"),
                           .body_count = (size_t)value_of(s, row, "inside"),
                           .kinetic = value_of(s, row, "kinetic") + value_of(s, row, "rotational"),
                           .mean_rotation = value_of(s, row, "mean_rotation"),
                           .highest_speed = value_of(s, row, "highest_speed"),
                           .largest_overlap = value_of(s, row, "largest_overlap"),
                           .coordination = value_of(s, row, "coordination"),
                           .cylinder_height = value_of(s, row, "cylinder.z"),
                           .sector_deg = value_of(s, row, "heap.sector_deg"),
                           .cone_deg = value_of(s, row, "heap.cone_deg"),
                           .silhouette_deg = value_of(s, row, "heap.silhouette_deg"),
                           .height = value_of(s, row, "heap.height")};
}

scree_status scree_run_follow(scree_run *run, scree_error *error) {
  const scree_scene *scene = run->scene;
  for (size_t i = run->series.count; i < scene->row_count; i++) {
    scree_run_point point = point_of(scene, scene->series.items + i * scene->columns.count);
    if (!SCREE_PUSH(&run->series, point))
      return scree_fail_memory(error, run->series.count * sizeof point, "the series of a run");
  }
  return SCREE_OK;
}

const scree_run_point *scree_run_series(const scree_run *run, size_t *count) {
  *count = run->series.count;
  return run->series.items;
}

void scree_run_get_costs(const scree_run *run, scree_run_costs *costs) {
  const scree_scene_costs *spent = &run->scene->costs;
  *costs = (scree_run_costs){.time_step = scree_world_time_step(run->scene->world, NULL),
                             .step_count = scree_world_step_count(run->scene->world),
                             .particle_steps = spent->body_steps,
                             .wall_seconds = spent->wall_seconds,
                             .processor_seconds = spent->processor_seconds,
                             .piece_count = (size_t)spent->piece_count};
  for (size_t i = 0; i < run->series.count; i++)
    costs->largest_overlap = fmax(costs->largest_overlap, run->series.items[i].largest_overlap);
}
