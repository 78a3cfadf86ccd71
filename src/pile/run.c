/* One run of the experiment of Katagiri and Koyanaka (2020), section 2.3: particles enter in layers
 * at the top of a cylinder (fill_run.c), settle, the cylinder is raised, the heap comes to rest. */
#include "pile/run.h"

#include "base/alloc.h"
#include "base/platform.h"
#include "base/progress.h"

#include <string.h>

static const double clearance_share = 0.01; /* of the particle size, between bounding boxes */
static const double still_time = 0.1;       /* s below the still energy before it counts */
static const double cylinder_length = 100;  /* m: its upper end is never met */
static const double fall_below = 0.5;       /* m under the disc where bodies are taken out */
enum { OBSERVE_STEPS = 200, MOST_SHAPES = 60 };

const char *scree_phase_name(scree_phase phase) {
  static const char *const names[] = {"packing", "settling", "lifting", "holding", "done"};
  return (unsigned)phase <= SCREE_PHASE_DONE ? names[phase] : "?";
}

/* ---- creation ---- */

static scree_world_options world_options(const scree_experiment *e, double time_step) {
  scree_world_options o = scree_default_world_options();
  o.gravity[0] = o.gravity[1] = 0;
  o.gravity[2] = -e->gravity;
  o.law = e->contact_law ? SCREE_LAW_HYSTERETIC : SCREE_LAW_LINEAR;
  o.steps_per_contact = e->steps_per_contact;
  o.stiffness_factor = e->stiffness_factor;
  o.time_step = time_step;
  o.floor_height = -fall_below;
  return o;
}

static scree_status add_materials(const scree_run *run, scree_world *world, scree_error *error) {
  const scree_experiment *e = &run->experiment;
  scree_material wall = scree_default_wall_material();
  wall.stiffness = e->young_wall;
  wall.restitution = e->restitution;
  wall.friction = e->friction_wall;
  size_t wall_index;
  scree_status status = scree_world_add_material(world, &wall, &wall_index, error);
  for (size_t i = 0; status == SCREE_OK && i < run->shape_count; i++) {
    scree_material m = {.stiffness = e->young_particle,
                        .density = e->density * run->shapes[i].density_factor,
                        .restitution = e->restitution,
                        .friction = e->friction_particle};
    status = scree_world_add_material(world, &m, &run->materials[i], error);
    for (size_t j = 0; status == SCREE_OK && j <= i; j++)
      status = scree_world_set_contact(world, run->materials[i], run->materials[j], e->restitution,
                                       e->friction_particle, error);
    if (status == SCREE_OK)
      status = scree_world_set_contact(world, run->materials[i], wall_index, e->restitution,
                                       e->friction_wall, error);
  }
  return status;
}

/* The disc, then the cylinder. */
static scree_status add_walls(const scree_run *run, scree_world *world, double cylinder_height,
                              scree_error *error) {
  const scree_experiment *e = &run->experiment;
  scree_wall disc = {.kind = SCREE_WALL_DISC, .axis = {0, 0, 1}, .radius = 0.5 * e->disc_diameter};
  scree_wall cylinder = {.kind = SCREE_WALL_CYLINDER,
                         .position = {0, 0, cylinder_height},
                         .axis = {0, 0, 1},
                         .radius = 0.5 * e->cylinder_diameter,
                         .length = fmax(cylinder_length, 10 * run->inlet_height)};
  size_t index;
  scree_status status = scree_world_add_wall(world, &disc, &index, error);
  return status == SCREE_OK ? scree_world_add_wall(world, &cylinder, &index, error) : status;
}

scree_status scree_run_make_world(const scree_run *run, double cylinder_height, double time_step,
                                  scree_world **world, scree_error *error) {
  scree_world_options o = world_options(&run->experiment, time_step);
  scree_world *made;
  scree_status status = scree_world_create(&o, &made, error);
  if (status != SCREE_OK) return status;
  status = add_materials(run, made, error);
  if (status == SCREE_OK) status = add_walls(run, made, cylinder_height, error);
  if (status == SCREE_OK)
    *world = made;
  else
    scree_world_free(made);
  return status;
}

/* A world with one of each shape, far apart, in their order: it keeps the particles, and knows the
 * time step for the worst pair of all shapes, whatever order they enter in. */
static scree_status make_gallery(scree_run *run, scree_error *error) {
  scree_status status = scree_run_make_world(run, 0, 0, &run->gallery, error);
  for (size_t i = 0; status == SCREE_OK && i < run->shape_count; i++) {
    scree_body body = scree_default_body();
    size_t index;
    body.position[2] = 10 + 10 * (double)i;
    status = scree_world_add_body(run->gallery, run->shapes[i].particle, run->materials[i], &body,
                                  &index, error);
  }
  return status;
}

static vec3 half_extents(const scree_particle *p) {
  return vec3_scale(vec3_sub(p->box.high, p->box.low), 0.5);
}

static void measure_shapes(scree_run *run) {
  size_t count = run->experiment.particle_count;
  for (size_t i = 0; i < count; i++) {
    const scree_particle_measures *m = &run->shapes[run->order[i]].particle->measures;
    run->solid_volume += m->volume;
    run->size += m->size / (double)count;
  }
  double more = 0.5 * clearance_share * run->size;
  for (size_t i = 0; i < run->shape_count; i++) {
    const scree_particle *p = run->shapes[i].particle;
    run->extents[i] = (scree_placement){
        .radius = p->measures.bounding_radius + more,
        .box_centre = vec3_lerp(p->box.low, p->box.high, 0.5),
        .half = vec3_add(half_extents(p), (vec3){more, more, more}),
    };
  }
}

static scree_status check_shapes(const scree_experiment *e, const scree_run_shape *shapes,
                                 size_t count, scree_error *error) {
  if (count < 1 || count > MOST_SHAPES)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu shapes: must be 1 to %d", count, MOST_SHAPES);
  if (count > e->particle_count)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu shapes for %zu particles", count,
                      e->particle_count);
  for (size_t i = 0; i < count; i++)
    if (!(shapes[i].density_factor > 0))
      return scree_fail(error, SCREE_BAD_ARGUMENT, "shape %zu: density factor %g must be positive",
                        i, shapes[i].density_factor);
  return SCREE_OK;
}

/* Everything that is copied: names and arrays. */
static scree_status allocate(scree_run *run, const scree_experiment *experiment,
                             const scree_run_shape *shapes, size_t shape_count,
                             scree_error *error) {
  size_t count = experiment->particle_count;
  scree_status status = scree_experiment_copy(experiment, &run->experiment, error);
  if (status != SCREE_OK) return status;
  status = SCREE_OUT_OF_MEMORY;
  run->shape_count = shape_count;
  run->names = scree_alloc_zero(2 * shape_count, sizeof *run->names);
  if (!run->names) return scree_fail_memory(error, shape_count, "the shapes' names");
  SCREE_ALLOC_OR(run->shapes, shape_count, error, done);
  for (size_t i = 0; i < shape_count; i++) {
    run->shapes[i] = shapes[i];
    run->shapes[i].name = run->names[2 * i] = scree_strdup(shapes[i].name ? shapes[i].name : "");
    run->shapes[i].source = run->names[2 * i + 1] =
        scree_strdup(shapes[i].source ? shapes[i].source : "");
    if (!run->names[2 * i] || !run->names[2 * i + 1])
      return scree_fail_memory(error, 0, "a shape's name");
  }
  SCREE_ALLOC_OR(run->extents, shape_count, error, done);
  SCREE_ALLOC_OR(run->materials, shape_count, error, done);
  SCREE_ALLOC_OR(run->order, count, error, done);
  SCREE_ALLOC_OR(run->placements, count, error, done);
  SCREE_ALLOC_OR(run->present, count, error, done);
  for (size_t i = 0; i < shape_count; i++) run->materials[i] = i + 1; /* 0: the walls' */
  status = SCREE_OK;
done:
  return status;
}

scree_status scree_run_plan(const scree_experiment *experiment, const scree_run_shape *shapes,
                            size_t shape_count, scree_run **run, scree_error *error) {
  scree_status status = scree_experiment_check(experiment, error);
  if (status == SCREE_OK) status = check_shapes(experiment, shapes, shape_count, error);
  if (status != SCREE_OK) return status;
  scree_run *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "a run");
  made->still_since = NAN;
  made->cylinder = 1;
  made->piece_count = 1;
  status = allocate(made, experiment, shapes, shape_count, error);
  if (status == SCREE_OK) {
    scree_fill_order(experiment->seed, shape_count, made->order, experiment->particle_count);
    measure_shapes(made);
    status = scree_run_check_measure(made, experiment, error);
  }
  if (status == SCREE_OK) status = scree_run_plan_filling(made, error);
  if (status == SCREE_OK) status = make_gallery(made, error);
  if (status == SCREE_OK)
    *run = made;
  else
    scree_run_free(made);
  return status;
}

scree_status scree_run_create(const scree_experiment *experiment, const scree_run_shape *shapes,
                              size_t shape_count, scree_run **run, scree_error *error) {
  scree_run *made;
  scree_status status = scree_run_plan(experiment, shapes, shape_count, &made, error);
  if (status != SCREE_OK) return status;
  status = scree_run_make_world(made, 0, scree_world_time_step(made->gallery, NULL), &made->world,
                                error);
  if (status == SCREE_OK)
    *run = made;
  else
    scree_run_free(made);
  return status;
}

void scree_run_free(scree_run *run) {
  if (!run) return;
  scree_world_free(run->world);
  scree_world_free(run->gallery);
  scree_experiment_free(&run->experiment);
  for (size_t i = 0; run->names && i < 2 * run->shape_count; i++) scree_free(run->names[i]);
  scree_free(run->names);
  scree_free(run->shapes);
  scree_free(run->extents);
  scree_free(run->materials);
  scree_free(run->order);
  scree_free(run->placements);
  scree_free(run->present);
  scree_free(run->series.items);
  scree_free(run);
}

/* ---- phases ---- */

static double phase_length(const scree_experiment *e, scree_phase phase) {
  const double lengths[] = {e->pack_time, e->settle_time, e->lift_time, e->hold_time, 0};
  return lengths[phase];
}

double scree_run_cylinder_height(const scree_run *run) {
  scree_wall wall;
  scree_world_get_wall(run->world, run->cylinder, &wall);
  return wall.position[2];
}

static scree_status begin_phase(scree_run *run, scree_phase phase, scree_error *error) {
  const double still[3] = {0, 0, 0}, up[3] = {0, 0, run->experiment.lift_speed};
  run->phase = phase;
  run->phase_start = scree_world_time(run->world);
  run->still_since = NAN;
  return scree_world_set_wall_velocity(run->world, run->cylinder,
                                       phase == SCREE_PHASE_LIFT ? up : still, still, error);
}

static double heap_top(const scree_run *run) {
  double top = 0;
  for (size_t i = 0; i < run->entered_count; i++) {
    scree_body body;
    if (scree_world_body_removed(run->world, i)) continue;
    scree_world_get_body(run->world, i, &body);
    top = fmax(top, body.position[2] + run->extents[run->order[i]].radius);
  }
  return top;
}

/* Whether the phase may end before its time: all is still, has been for a while, and stays so. */
static bool ends_early(scree_run *run) {
  const scree_experiment *e = &run->experiment;
  if (run->phase == SCREE_PHASE_PACK) return false;
  if (run->phase != SCREE_PHASE_HOLD && !e->stop_when_still) return false;
  scree_run_point now = scree_run_point_now(run);
  double count = (double)(now.body_count > 0 ? now.body_count : 1);
  if (now.kinetic / count >= e->still_energy) {
    run->still_since = NAN;
    return false;
  }
  if (isnan(run->still_since)) run->still_since = now.time;
  if (now.time - run->still_since < still_time) return false;
  return run->phase != SCREE_PHASE_LIFT || scree_run_cylinder_height(run) > heap_top(run);
}

/* Ends the phase where it is time; true where it ended. */
static scree_status turn_phase(scree_run *run, bool *turned, scree_error *error) {
  double elapsed = scree_world_time(run->world) - run->phase_start;
  bool filled = run->entered_count == run->experiment.particle_count;
  *turned = elapsed >= phase_length(&run->experiment, run->phase);
  if (run->phase == SCREE_PHASE_PACK) *turned = *turned && filled;
  if (!*turned && scree_world_step_count(run->world) % OBSERVE_STEPS == 0)
    *turned = ends_early(run);
  if (!*turned) return SCREE_OK;
  scree_status status = begin_phase(run, run->phase + 1, error);
  return status == SCREE_OK && run->phase == SCREE_PHASE_DONE ? scree_run_record(run, true, error)
                                                              : status;
}

static bool layer_is_due(const scree_run *run) {
  return run->phase == SCREE_PHASE_PACK && run->entered_count < run->experiment.particle_count &&
         scree_world_time(run->world) >= (double)run->layer_count * run->layer_interval;
}

/* When the next point of the series is due. */
static double next_point(const scree_run *run) {
  return (double)run->series.count * run->experiment.series_interval;
}

/* Steps to take before something may have to be decided: up to the next multiple of OBSERVE_STEPS,
 * so that decisions fall on the same steps however a run is cut into calls; single steps where a
 * layer, a point of the series or the end of a phase is near, since these fall on their own times.
 */
static size_t steps_to_decision(const scree_run *run, size_t wanted) {
  size_t next = OBSERVE_STEPS - scree_world_step_count(run->world) % OBSERVE_STEPS;
  double dt = scree_world_time_step(run->world, NULL);
  double due = run->phase == SCREE_PHASE_PACK && run->entered_count < run->experiment.particle_count
                   ? (double)run->layer_count * run->layer_interval
                   : run->phase_start + phase_length(&run->experiment, run->phase);
  due = fmin(due, next_point(run));
  double until = floor((due - scree_world_time(run->world)) / dt) - 1;
  size_t steps = wanted < next ? wanted : next;
  if (until < (double)steps) steps = until > 1 ? (size_t)until : 1;
  return steps;
}

static scree_status advance(scree_run *run, size_t step_count, scree_error *error) {
  while (step_count > 0 && run->phase != SCREE_PHASE_DONE) {
    scree_status status = layer_is_due(run) ? scree_run_enter_layer(run, error) : SCREE_OK;
    if (status == SCREE_OK && scree_world_time(run->world) >= next_point(run))
      status = scree_run_record(run, false, error);
    if (status != SCREE_OK) return status;
    size_t steps = steps_to_decision(run, step_count);
    status = scree_world_step(run->world, steps, error);
    if (status != SCREE_OK) return status;
    run->particle_steps += steps * (run->world->bodies.count - run->world->bodies.removed_count);
    step_count -= steps;
    bool turned;
    status = turn_phase(run, &turned, error);
    if (status != SCREE_OK || turned) return status;
  }
  return SCREE_OK;
}

scree_status scree_run_advance(scree_run *run, size_t step_count, scree_error *error) {
  if (run->is_frame)
    return scree_fail(error, SCREE_UNSUPPORTED,
                      "a frame has no contacts: a run goes on from a checkpoint only");
  double wall = scree_now(), processor = scree_processor_time();
  scree_status status = advance(run, step_count, error);
  run->wall_seconds += scree_now() - wall;
  run->processor_seconds += scree_processor_time() - processor;
  return status;
}

scree_phase scree_run_phase(const scree_run *run) {
  return run->phase;
}
scree_world *scree_run_world(scree_run *run) {
  return run->world;
}
const scree_world *scree_run_view(const scree_run *run) {
  return run->world;
}
const scree_experiment *scree_run_experiment(const scree_run *run) {
  return &run->experiment;
}

size_t scree_run_shape_count(const scree_run *run) {
  return run->shape_count;
}
void scree_run_get_shape(const scree_run *run, size_t index, scree_run_shape *shape) {
  *shape = run->shapes[index];
}
size_t scree_run_body_shape(const scree_run *run, size_t index) {
  return run->order[index];
}
bool scree_run_is_frame(const scree_run *run) {
  return run->is_frame;
}

double scree_run_fraction(const scree_run *run) {
  double time = run->is_frame ? run->frame_time : scree_world_time(run->world);
  double all = 0, done = 0, elapsed = time - run->phase_start;
  for (int phase = 0; phase < SCREE_PHASE_DONE; phase++) {
    double length = phase_length(&run->experiment, (scree_phase)phase);
    all += length;
    if (phase < (int)run->phase) done += length;
    if (phase == (int)run->phase) done += fmin(elapsed, length);
  }
  return all > 0 ? done / all : 1;
}
