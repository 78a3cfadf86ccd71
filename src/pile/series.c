/* What a run records and measures: points of the series, the heap's angle, packing and
 * coordination. */
#include "pile/run.h"

#include "base/array.h"

static const double coarsest_cell = 0.5; /* particle sizes: a coarser height field shows none */

/* ---- the heap as it stands ---- */

static void raise_body(const scree_run *run, size_t index, scree_height_field *field) {
  scree_particle *particle = scree_world_body_particle(run->world, index);
  scree_particle_measures m;
  scree_body body;
  scree_particle_measure(particle, &m);
  scree_world_get_body(run->world, index, &body);
  if (m.kind == SCREE_PARTICLE_MESH) {
    scree_height_field_add_mesh(field, scree_particle_mesh(particle), body.position,
                                body.orientation, 0);
    return;
  }
  mat3 rotation = quat_to_mat3(
      (quat){body.orientation[0], body.orientation[1], body.orientation[2], body.orientation[3]});
  for (size_t i = 0; i < m.point_count; i++) {
    double local[3], centre[3], radius;
    scree_particle_point(particle, i, local, &radius);
    vec3_store(centre,
               vec3_add(mat3_mul_vec(&rotation, vec3_load(local)), vec3_load(body.position)));
    scree_height_field_add_sphere(field, centre, radius, 0);
  }
}

/* In the world, and not on its way down beside the disc. */
static bool is_on_disc(const scree_run *run, size_t index) {
  scree_body body;
  if (scree_world_body_removed(run->world, index)) return false;
  scree_world_get_body(run->world, index, &body);
  return body.position[2] >= 0 &&
         hypot(body.position[0], body.position[1]) <= 0.5 * run->experiment.disc_diameter;
}

/* All that lies on the disc, with its number and solid volume. */
static scree_status raise_bodies(const scree_run *run, double cell, scree_height_field *field,
                                 size_t *count, double *solid, scree_error *error) {
  scree_status status = scree_height_field_create(
      0, 0, 0.5 * run->experiment.disc_diameter + run->layer_height, cell, field, error);
  if (status != SCREE_OK) return status;
  for (size_t i = 0; i < run->entered_count; i++) {
    if (!is_on_disc(run, i)) continue;
    scree_particle_measures m;
    scree_particle_measure(scree_world_body_particle(run->world, i), &m);
    *solid += m.volume;
    ++*count;
    raise_body(run, i, field);
  }
  return SCREE_OK;
}

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
  double cell = measure->height_cell > 0 ? measure->height_cell : 0.1 * run->size, solid = 0;
  scree_run_result made = {.particle_size = run->size};
  scree_height_field field;
  scree_status status = scree_run_check_measure(run, measure, error);
  if (status == SCREE_OK) status = raise_bodies(run, cell, &field, &made.body_count, &solid, error);
  if (status != SCREE_OK) return status;
  scree_repose_options o = scree_default_repose_options();
  o.sector_count = measure->sector_count;
  o.band_low = measure->band_low;
  o.band_high = measure->band_high;
  o.particle_size = run->size;
  status = scree_repose_measure(&field, &o, &made.repose, error);
  scree_height_field_free(&field);
  if (status != SCREE_OK) return status;
  observe_motion(run, &made);
  made.left_count = run->entered_count - made.body_count;
  /* plates side by side fill what is under them: there the field's own error may pass 1 */
  made.packing_fraction =
      made.repose.envelope_volume > 0 ? fmin(1, solid / made.repose.envelope_volume) : NAN;
  *result = made;
  return SCREE_OK;
}

scree_status scree_run_measure(const scree_run *run, scree_run_result *result, scree_error *error) {
  return scree_run_measure_with(run, &run->experiment, result, error);
}

/* ---- the series ---- */

scree_run_point scree_run_point_now(const scree_run *run) {
  scree_observation o;
  scree_world_observe(run->world, &o);
  return (scree_run_point){
      .time = run->is_frame ? run->frame_time : o.time,
      .phase = run->phase,
      .body_count = o.body_count,
      .kinetic = run->is_frame ? run->frame_kinetic : o.kinetic + o.rotational,
      .mean_rotation = o.mean_rotation,
      .highest_speed = o.highest_speed,
      .largest_overlap = o.largest_overlap,
      .coordination = run->is_frame ? run->frame_coordination : o.coordination,
      .cylinder_height = scree_run_cylinder_height(run),
      .sector_deg = NAN,
      .cone_deg = NAN,
      .silhouette_deg = NAN,
      .height = NAN,
  };
}

/* Once in every interval of the clock, while the cylinder rises and after. */
static bool angle_is_due(const scree_run *run, double time) {
  double interval = run->experiment.angle_interval;
  if (!(interval > 0) || (run->phase != SCREE_PHASE_LIFT && run->phase != SCREE_PHASE_HOLD))
    return false;
  double before = run->series.count ? run->series.items[run->series.count - 1].time : -interval;
  return floor(time / interval) > floor(before / interval);
}

scree_status scree_run_record(scree_run *run, bool last, scree_error *error) {
  scree_run_point point = scree_run_point_now(run);
  if (last || angle_is_due(run, point.time)) {
    scree_run_result result;
    scree_status status = scree_run_measure(run, &result, error);
    if (status != SCREE_OK) return status;
    point.sector_deg = result.repose.sector_deg;
    point.cone_deg = result.repose.cone_deg;
    point.silhouette_deg = result.repose.silhouette_deg;
    point.height = result.repose.height;
  }
  if (SCREE_PUSH(&run->series, point)) return SCREE_OK;
  return scree_fail_memory(error, run->series.count * sizeof point, "the series of a run");
}

const scree_run_point *scree_run_series(const scree_run *run, size_t *count) {
  *count = run->series.count;
  return run->series.items;
}

void scree_run_get_costs(const scree_run *run, scree_run_costs *costs) {
  *costs = (scree_run_costs){.time_step = scree_world_time_step(run->world, NULL),
                             .step_count = scree_world_step_count(run->world),
                             .particle_steps = run->particle_steps,
                             .wall_seconds = run->wall_seconds,
                             .processor_seconds = run->processor_seconds,
                             .piece_count = run->piece_count};
  for (size_t i = 0; i < run->series.count; i++)
    costs->largest_overlap = fmax(costs->largest_overlap, run->series.items[i].largest_overlap);
}
