/* One run of the experiment of Katagiri and Koyanaka (2020), section 2.3: particles enter in layers
 * at the top of a cylinder, settle, the cylinder is raised, the heap comes to rest.
 *
 * Filling: a layer holds what random sequential addition of bounding spheres puts beside each
 * other; layers follow at equal intervals so that all are in after pack_time, and enter with the
 * speed that takes a layer out of the way before the next: the paper's inlet at the top of the
 * cylinder. The inlet lies above where the packed heap will end, and rises with the heap if that
 * comes too near. */
#include "base/alloc.h"
#include "pile/fill.h"

#include <math.h>
#include <string.h>

static const double loose_packing = 0.30;   /* solid fraction that sets the height of the inlet */
static const double clearance_share = 0.01; /* of the particle size, between bounding spheres */
static const double layer_spacing = 1.05;   /* of a layer's height, travelled before the next */
static const double entry_speed_limit = 8;  /* m/s: faster hits leave the contact law's range */
static const double still_time = 0.1;       /* s below the still energy before it counts */
static const double cylinder_length = 100;  /* m: its upper end is never met */
static const double fall_below = 0.5;       /* m under the disc where bodies are taken out */
enum { OBSERVE_STEPS = 200, MOST_SHAPES = 60 };

struct scree_run {
  scree_experiment experiment; /* preset owned */
  scree_world *world;
  scree_run_shape *shapes;
  double *radii; /* bounding, per shape */
  size_t *materials;
  size_t shape_count;
  uint32_t *order;      /* shape of each particle */
  size_t entered_count; /* particles in the world */
  size_t layer_count;   /* layers that have entered */
  double layer_interval, entry_speed, inlet_height, layer_height, clearance;
  double size;         /* m, mean over the particles */
  double solid_volume; /* m3 of all particles */
  size_t cylinder;     /* wall index */
  scree_phase phase;
  double phase_start; /* s */
  double still_since; /* s; NaN while moving */
  scree_placement *placements, *present;
};

const char *scree_phase_name(scree_phase phase) {
  static const char *const names[] = {"packing", "settling", "lifting", "holding", "done"};
  return (unsigned)phase <= SCREE_PHASE_DONE ? names[phase] : "?";
}

/* ---- creation ---- */

static scree_world_options world_options(const scree_experiment *e) {
  scree_world_options o = scree_default_world_options();
  o.gravity[0] = o.gravity[1] = 0;
  o.gravity[2] = -e->gravity;
  o.law = e->contact_law ? SCREE_LAW_HYSTERETIC : SCREE_LAW_LINEAR;
  o.steps_per_contact = e->steps_per_contact;
  o.stiffness_factor = e->stiffness_factor;
  o.floor_height = -fall_below;
  return o;
}

static scree_status add_materials(scree_run *run, scree_world *world, scree_error *error) {
  const scree_experiment *e = &run->experiment;
  scree_material wall = scree_default_wall_material();
  wall.stiffness = e->young_wall;
  wall.restitution = e->restitution;
  wall.friction = e->friction_wall;
  size_t wall_index;
  scree_status status = scree_world_add_material(world, &wall, &wall_index, error);
  for (size_t i = 0; status == SCREE_OK && i < run->shape_count; i++) {
    scree_material m = {e->young_particle, e->density * run->shapes[i].density_factor,
                        e->restitution, e->friction_particle};
    status = scree_world_add_material(world, &m, &run->materials[i], error);
    for (size_t j = 0; status == SCREE_OK && j <= i; j++)
      status = scree_world_set_contact(world, run->materials[i], run->materials[j], e->restitution,
                                       e->friction_particle, error);
    if (status == SCREE_OK)
      status = scree_world_set_contact(world, run->materials[i], wall_index, e->restitution,
                                       e->friction_wall, error);
  }
  if (status != SCREE_OK) return status;
  scree_wall disc = {.kind = SCREE_WALL_DISC,
                     .material = wall_index,
                     .axis = {0, 0, 1},
                     .radius = 0.5 * e->disc_diameter};
  scree_wall cylinder = {.kind = SCREE_WALL_CYLINDER,
                         .material = wall_index,
                         .axis = {0, 0, 1},
                         .radius = 0.5 * e->cylinder_diameter,
                         .length = cylinder_length};
  size_t disc_index;
  status = scree_world_add_wall(world, &disc, &disc_index, error);
  if (status == SCREE_OK) status = scree_world_add_wall(world, &cylinder, &run->cylinder, error);
  return status;
}

/* The time step for the worst pair of all shapes, whatever order they enter in: asked of a world
 * that has one of each, far apart. */
static scree_status find_time_step(scree_run *run, double *time_step, scree_error *error) {
  scree_world_options o = world_options(&run->experiment);
  scree_world *world;
  scree_status status = scree_world_create(&o, &world, error);
  if (status != SCREE_OK) return status;
  status = add_materials(run, world, error);
  for (size_t i = 0; status == SCREE_OK && i < run->shape_count; i++) {
    scree_body body = scree_default_body();
    size_t index;
    body.position[2] = 10 + 10 * (double)i;
    status = scree_world_add_body(world, run->shapes[i].particle, run->materials[i], &body, &index,
                                  error);
  }
  if (status == SCREE_OK) *time_step = scree_world_time_step(world, NULL);
  scree_world_free(world);
  return status;
}

static scree_status make_world(scree_run *run, scree_error *error) {
  scree_world_options o = world_options(&run->experiment);
  scree_status status = find_time_step(run, &o.time_step, error);
  if (status == SCREE_OK) status = scree_world_create(&o, &run->world, error);
  if (status == SCREE_OK) status = add_materials(run, run->world, error);
  return status;
}

static void measure_shapes(scree_run *run) {
  double largest = 0;
  for (size_t i = 0; i < run->experiment.particle_count; i++) {
    scree_particle_measures m;
    scree_particle_measure(run->shapes[run->order[i]].particle, &m);
    run->solid_volume += m.volume;
    run->size += m.size / (double)run->experiment.particle_count;
    run->radii[run->order[i]] = m.bounding_radius;
    largest = fmax(largest, m.bounding_radius);
  }
  run->layer_height = 2 * largest;
  run->clearance = clearance_share * run->size;
}

static scree_fill_layer layer_at(const scree_run *run, double bottom, size_t present_count) {
  return (scree_fill_layer){run->experiment.seed,
                            run->layer_count,
                            0.5 * run->experiment.cylinder_diameter,
                            bottom,
                            run->clearance,
                            run->present,
                            present_count};
}

/* Places everything layer by layer without moving it: how many layers there will be, exactly as
 * long as no body stands in the inlet. */
static scree_status count_layers(scree_run *run, size_t *layers, scree_error *error) {
  size_t count = run->experiment.particle_count, placed = 0;
  for (size_t i = 0; i < count; i++) run->placements[i].radius = run->radii[run->order[i]];
  for (*layers = 0; placed < count; ++*layers) {
    scree_fill_layer layer = layer_at(run, 0, 0);
    layer.layer_index = *layers;
    size_t more = scree_fill_place(&layer, run->placements + placed, count - placed);
    if (more == 0)
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "a particle %.4g mm across does not fit into the cylinder of %.4g mm",
                        2e3 * run->placements[placed].radius,
                        1e3 * run->experiment.cylinder_diameter);
    placed += more;
  }
  return SCREE_OK;
}

/* Interval, speed and height of the inlet. */
static scree_status plan_filling(scree_run *run, scree_error *error) {
  const scree_experiment *e = &run->experiment;
  size_t layers;
  scree_status status = count_layers(run, &layers, error);
  if (status != SCREE_OK) return status;
  double travel = layer_spacing * run->layer_height;
  run->layer_interval = e->pack_time / (double)layers;
  run->entry_speed = layers > 1 ? travel / run->layer_interval : 0;
  if (!(run->entry_speed <= entry_speed_limit))
    return scree_fail(
        error, SCREE_BAD_ARGUMENT,
        "%zu particles make %zu layers of %.4g mm, which would have to enter at %.3g m/s; at "
        "most %g m/s: set phases.pack_time to %.3g s or more, or a wider cylinder",
        e->particle_count, layers, 1e3 * run->layer_height, run->entry_speed, entry_speed_limit,
        travel * (double)layers / entry_speed_limit);
  double radius = 0.5 * e->cylinder_diameter;
  run->inlet_height =
      run->solid_volume / (loose_packing * 3.14159265358979 * radius * radius) + e->drop_height;
  return SCREE_OK;
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

scree_status scree_run_create(const scree_experiment *experiment, const scree_run_shape *shapes,
                              size_t shape_count, scree_run **run, scree_error *error) {
  scree_status status = check_shapes(experiment, shapes, shape_count, error);
  if (status != SCREE_OK) return status;
  size_t count = experiment->particle_count;
  scree_run *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "a run");
  made->experiment = *experiment;
  made->experiment.preset = scree_strdup(experiment->preset);
  made->shape_count = shape_count;
  made->still_since = NAN;
  status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(made->shapes, shape_count, error, done);
  SCREE_ALLOC_OR(made->radii, shape_count, error, done);
  SCREE_ALLOC_OR(made->materials, shape_count, error, done);
  SCREE_ALLOC_OR(made->order, count, error, done);
  SCREE_ALLOC_OR(made->placements, count, error, done);
  SCREE_ALLOC_OR(made->present, count, error, done);
  if (!made->experiment.preset) {
    scree_fail_memory(error, 0, "a preset's name");
    goto done;
  }
  memcpy(made->shapes, shapes, shape_count * sizeof *shapes);
  scree_fill_order(experiment->seed, shape_count, made->order, count);
  measure_shapes(made);
  status = plan_filling(made, error);
  if (status == SCREE_OK) status = make_world(made, error);
done:
  if (status == SCREE_OK)
    *run = made;
  else
    scree_run_free(made);
  return status;
}

void scree_run_free(scree_run *run) {
  if (!run) return;
  scree_world_free(run->world);
  scree_experiment_free(&run->experiment);
  scree_free(run->shapes);
  scree_free(run->radii);
  scree_free(run->materials);
  scree_free(run->order);
  scree_free(run->placements);
  scree_free(run->present);
  scree_free(run);
}

/* ---- filling ---- */

/* The bodies in the world as bounding spheres; returns the height of the highest. */
static double list_present(scree_run *run) {
  double top = 0;
  for (size_t i = 0; i < run->entered_count; i++) {
    scree_body body;
    scree_world_get_body(run->world, i, &body);
    run->present[i] =
        (scree_placement){vec3_load(body.position), {1, 0, 0, 0}, run->radii[run->order[i]]};
    bool entering = body.velocity[2] < -0.5 * run->entry_speed;
    if (!entering) top = fmax(top, body.position[2] + run->radii[run->order[i]]);
  }
  return top;
}

static scree_status add_placed(scree_run *run, const scree_placement *p, scree_error *error) {
  size_t shape = run->order[run->entered_count], index;
  scree_body body = scree_default_body();
  vec3_store(body.position, p->position);
  body.orientation[0] = p->orientation.w;
  body.orientation[1] = p->orientation.x;
  body.orientation[2] = p->orientation.y;
  body.orientation[3] = p->orientation.z;
  body.velocity[2] = -run->entry_speed;
  scree_status status = scree_world_add_body(run->world, run->shapes[shape].particle,
                                             run->materials[shape], &body, &index, error);
  if (status == SCREE_OK) run->entered_count++;
  return status;
}

static scree_status enter_layer(scree_run *run, scree_error *error) {
  double top = list_present(run);
  double bottom = fmax(run->inlet_height, top + run->experiment.drop_height);
  size_t left = run->experiment.particle_count - run->entered_count;
  for (size_t i = 0; i < left; i++)
    run->placements[i].radius = run->radii[run->order[run->entered_count + i]];
  scree_fill_layer layer = layer_at(run, bottom, run->entered_count);
  size_t placed = scree_fill_place(&layer, run->placements, left);
  run->layer_count++;
  scree_status status = SCREE_OK;
  for (size_t i = 0; status == SCREE_OK && i < placed; i++)
    status = add_placed(run, &run->placements[i], error);
  return status;
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

static double heap_top(scree_run *run) {
  double top = 0;
  for (size_t i = 0; i < run->entered_count; i++) {
    scree_body body;
    if (scree_world_body_removed(run->world, i)) continue;
    scree_world_get_body(run->world, i, &body);
    top = fmax(top, body.position[2] + run->radii[run->order[i]]);
  }
  return top;
}

/* Whether the phase may end before its time: all is still, has been for a while, and stays so. */
static bool ends_early(scree_run *run) {
  const scree_experiment *e = &run->experiment;
  if (run->phase == SCREE_PHASE_PACK) return false;
  if (run->phase != SCREE_PHASE_HOLD && !e->stop_when_still) return false;
  scree_observation o;
  scree_world_observe(run->world, &o);
  double count = (double)(o.body_count > 0 ? o.body_count : 1);
  if ((o.kinetic + o.rotational) / count >= e->still_energy) {
    run->still_since = NAN;
    return false;
  }
  if (isnan(run->still_since)) run->still_since = o.time;
  if (o.time - run->still_since < still_time) return false;
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
  return begin_phase(run, run->phase + 1, error);
}

static bool layer_is_due(const scree_run *run) {
  return run->phase == SCREE_PHASE_PACK && run->entered_count < run->experiment.particle_count &&
         scree_world_time(run->world) >= (double)run->layer_count * run->layer_interval;
}

/* Steps to take before something may have to be decided: up to the next multiple of OBSERVE_STEPS,
 * so that decisions fall on the same steps however a run is cut into calls; single steps while
 * filling, since layers and the end of packing fall on their own times. */
static size_t steps_to_decision(const scree_run *run, size_t wanted) {
  size_t next = OBSERVE_STEPS - scree_world_step_count(run->world) % OBSERVE_STEPS;
  double dt = scree_world_time_step(run->world, NULL);
  double due = run->phase == SCREE_PHASE_PACK && run->entered_count < run->experiment.particle_count
                   ? (double)run->layer_count * run->layer_interval
                   : run->phase_start + phase_length(&run->experiment, run->phase);
  double until = floor((due - scree_world_time(run->world)) / dt) - 1;
  size_t safe = until > 1 ? (size_t)until : 1;
  size_t steps = next < safe ? next : safe;
  return steps < wanted ? steps : wanted;
}

scree_status scree_run_advance(scree_run *run, size_t step_count, scree_error *error) {
  while (step_count > 0 && run->phase != SCREE_PHASE_DONE) {
    scree_status status = layer_is_due(run) ? enter_layer(run, error) : SCREE_OK;
    if (status != SCREE_OK) return status;
    size_t steps = steps_to_decision(run, step_count);
    status = scree_world_step(run->world, steps, error);
    if (status != SCREE_OK) return status;
    step_count -= steps;
    bool turned;
    status = turn_phase(run, &turned, error);
    if (status != SCREE_OK || turned) return status;
  }
  return SCREE_OK;
}

scree_phase scree_run_phase(const scree_run *run) {
  return run->phase;
}
scree_world *scree_run_world(scree_run *run) {
  return run->world;
}
const scree_experiment *scree_run_experiment(const scree_run *run) {
  return &run->experiment;
}

double scree_run_fraction(const scree_run *run) {
  double all = 0, done = 0, elapsed = scree_world_time(run->world) - run->phase_start;
  for (int phase = 0; phase < SCREE_PHASE_DONE; phase++) {
    double length = phase_length(&run->experiment, (scree_phase)phase);
    all += length;
    if (phase < (int)run->phase) done += length;
    if (phase == (int)run->phase) done += fmin(elapsed, length);
  }
  return all > 0 ? done / all : 1;
}

/* ---- measuring ---- */

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

static scree_status raise_bodies(const scree_run *run, double cell, scree_height_field *field,
                                 double *solid, scree_error *error) {
  scree_status status = scree_height_field_create(
      0, 0, 0.5 * run->experiment.disc_diameter + run->layer_height, cell, field, error);
  if (status != SCREE_OK) return status;
  *solid = 0;
  for (size_t i = 0; i < run->entered_count; i++) {
    if (scree_world_body_removed(run->world, i)) continue;
    scree_particle_measures m;
    scree_particle_measure(scree_world_body_particle(run->world, i), &m);
    *solid += m.volume;
    raise_body(run, i, field);
  }
  return SCREE_OK;
}

scree_status scree_run_measure(const scree_run *run, scree_run_result *result, scree_error *error) {
  const scree_experiment *e = &run->experiment;
  double cell = e->height_cell > 0 ? e->height_cell : 0.1 * run->size, solid;
  scree_height_field field;
  scree_status status = raise_bodies(run, cell, &field, &solid, error);
  if (status != SCREE_OK) return status;
  scree_repose_options o = scree_default_repose_options();
  o.sector_count = e->sector_count;
  o.band_low = e->band_low;
  o.band_high = e->band_high;
  o.particle_size = run->size;
  scree_run_result made = {.particle_size = run->size};
  status = scree_repose_measure(&field, &o, &made.repose, error);
  scree_height_field_free(&field);
  if (status != SCREE_OK) return status;
  scree_observation seen;
  scree_world_observe(run->world, &seen);
  made.left_count = seen.removed_count;
  made.coordination = seen.coordination;
  made.packing_fraction =
      made.repose.envelope_volume > 0 ? solid / made.repose.envelope_volume : NAN;
  *result = made;
  return SCREE_OK;
}
