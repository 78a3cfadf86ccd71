/* The loop. Every few steps, a tick, outlets are emptied, inlets filled, flows counted and the end
 * looked for; between ticks the world goes its steps. Which steps are ticks follows from the scene
 * alone, so that it can be cut into calls anyhow. */
#include "scene/scene.h"
#include "scene/geometry.h"
#include "scene/motions.h"

#include "base/alloc.h"
#include "base/platform.h"

#include <errno.h>
#include <string.h>

static const double tick_share = 0.25; /* of the way a body falls in, or flies, by its radius */
static const double clearance_share = 0.01; /* of a body's size, kept free around it on entering */
enum { STILL_TICKS = 10 };                  /* about the time of falling by a radius */

static const char *const ends[SCREE_SCENE_ENDS] = {
    NULL,    "the time is over",    "still",
    "empty", "the phases are over", "the time after filling is over"};
enum { GOES_ON, END_TIME, END_STILL, END_EMPTY, END_PHASES, END_FILLED };

/* ---- making ---- */

static scree_world_options world_options(const scree_scene *scene, double time_step) {
  const scree_plan *plan = &scene->plan;
  scree_world_options o = scree_default_world_options();
  memcpy(o.gravity, plan->gravity, sizeof o.gravity);
  o.law = (scree_law)plan->contact->law;
  o.rolling = (scree_rolling)plan->contact->rolling;
  o.steps_per_contact = plan->contact->steps;
  o.stiffness_factor = plan->contact->stiffness_factor;
  o.tangential_ratio = plan->contact->tangential_ratio;
  o.time_step = plan->contact->time_step > 0 ? plan->contact->time_step : time_step;
  for (size_t i = 0; plan->domain && i < plan->domain->periodic.count; i++) {
    int k = *plan->domain->periodic.items[i] - 'x';
    o.period[k] = plan->domain->max[k] - plan->domain->min[k];
    o.period_from[k] = plan->domain->min[k];
  }
  return o;
}

static const scree_plan_material *material_at(const scree_scene *scene, size_t index) {
  return &scene->plan.materials.items[index];
}

static void take_given(double *value, double given) {
  if (!isnan(given)) *value = given;
}

static scree_status set_pair(scree_world *world, const size_t k[2], const scree_plan_pair *p,
                             scree_error *error) {
  scree_material_contact c;
  SCREE_TRY(scree_world_get_pair(world, k[0], k[1], &c, error));
  take_given(&c.restitution, p->restitution);
  take_given(&c.friction, p->friction);
  take_given(&c.rolling_friction, p->rolling_friction);
  take_given(&c.surface_energy, p->surface_energy);
  take_given(&c.pull_off, p->pull_off);
  return scree_world_set_pair(world, k[0], k[1], &c, error);
}

static scree_status add_materials(const scree_scene *scene, scree_world *world,
                                  scree_error *error) {
  const scree_plan *plan = &scene->plan;
  scree_material usual = scree_default_material();
  if (plan->materials.count == 0) return scree_world_add_material(world, &usual, NULL, error);
  for (size_t i = 0; i < plan->materials.count; i++) {
    const scree_plan_material *m = material_at(scene, i);
    scree_material made = usual;
    made.young = m->young;
    made.density = m->density;
    made.restitution = m->restitution;
    made.friction = m->friction;
    made.rolling_friction = m->rolling_friction;
    made.surface_energy = m->surface_energy;
    made.poisson = m->poisson;
    SCREE_TRY(scree_world_add_material(world, &made, NULL, error));
  }
  for (size_t i = 0; i < plan->pairs.count; i++) {
    const scree_plan_pair *p = &plan->pairs.items[i];
    size_t k[2];
    for (int side = 0; side < 2; side++)
      k[side] = SCREE_PLAN_FIND(plan->materials, p->between.items[side]);
    SCREE_TRY(set_pair(world, k, p, error));
  }
  return SCREE_OK;
}

scree_status scree_scene_make_world(const scree_scene *scene, double time_step, scree_world **world,
                                    scree_error *error) {
  scree_world_options o = world_options(scene, time_step);
  SCREE_OWNED(scree_world, made);
  SCREE_TRY(scree_world_create(&o, &made, error));
  SCREE_TRY(add_materials(scene, made, error));
  *world = made;
  made = NULL;
  return SCREE_OK;
}

static scree_status check_period(const scree_scene *scene, size_t index, scree_error *error) {
  const scree_plan_domain *d = scene->plan.domain;
  scree_particle_measures m;
  scree_particle_measure(scene->shapes[index].particle, &m);
  double least = SCREE_LEAST_PERIOD * m.bounding_radius;
  for (size_t i = 0; d && i < d->periodic.count; i++) {
    int k = *d->periodic.items[i] - 'x';
    if (d->max[k] - d->min[k] >= least) continue;
    return scree_scene_fail(
        scene, &d->place, error,
        "a period of %.4g m along %c is too short for '%s', %.4g m across: at least %.4g m",
        d->max[k] - d->min[k], "xyz"[k], scree_scene_shape_name(scene, index),
        2 * m.bounding_radius, least);
  }
  return SCREE_OK;
}

/* One of each shape, far apart: it keeps the particles, and knows the time step for the worst pair
 * of all, whatever order they enter in. */
static scree_status make_gallery(scree_scene *scene, const char *folder, scree_error *error) {
  SCREE_TRY(scree_scene_make_world(scene, 0, &scene->gallery, error));
  SCREE_TRY(scree_geometry_add(scene, folder, scene->gallery, error));
  double far = 0;
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++) {
    scree_particle_measures m;
    scree_particle_measure(scene->shapes[i].particle, &m);
    far = fmax(far, 4 * m.bounding_radius);
  }
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++) {
    scree_body body = scree_default_body();
    SCREE_TRY(check_period(scene, i, error));
    const scree_scene_shape *s = &scene->shapes[i];
    body.position[2] = 1e5 * far + (double)scree_scene_named(scene, i) * far;
    if (i >= scene->named_count) {
      vec3_store(body.position, vec3_add(vec3_load(body.position), s->at));
      memcpy(body.orientation, (double[4]){s->turned.w, s->turned.x, s->turned.y, s->turned.z},
             sizeof body.orientation);
    }
    SCREE_TRY(scree_scene_add_body(s, scene->gallery, &body, error));
  }
  return scree_scene_join_gallery(scene, error);
}

void scree_scene_measure_shape(scree_scene *scene, size_t index) {
  scree_scene_shape *s = &scene->shapes[index];
  const scree_plan_shape *plan = &scene->plan.shapes.items[index];
  scree_particle_measures m;
  scree_particle_measure(s->particle, &m);
  s->extent = scree_placement_of(s->particle, 0.5 * clearance_share * m.size);
  s->as_given = quat_load(m.orientation);
  s->material = plan->material ? SCREE_PLAN_FIND(scene->plan.materials, plan->material) : 0;
  s->density = plan->density > 0             ? plan->density
               : scene->plan.materials.count ? material_at(scene, s->material)->density
                                             : scree_default_material().density;
  s->family = plan->family;
  if (index >= scene->named_count && !s->part)
    s->density = scene->shapes[s->assembly].density;
  else if (plan->mass_from && s->scan_volume > 0)
    s->density *= s->scan_volume / m.volume;
  s->volume = m.volume;
  s->mass = s->density * m.volume;
  if (s->part) { /* the whole is what its parts are together, of their mean density */
    scree_scene_shape *whole = &scene->shapes[s->assembly];
    bool first = index == whole->first_piece;
    double mass = s->mass + (first ? 0 : whole->density * whole->volume);
    whole->volume = s->volume + (first ? 0 : whole->volume);
    whole->density = mass / whole->volume;
    whole->mass = whole->density * whole->volume;
  }
  scene->size = index ? fmin(scene->size, m.size) : m.size;
}

static void plan_ticks(scree_scene *scene) {
  double speed = 0, radius = 0.5 * scene->size, g = vec3_norm(vec3_load(scene->plan.gravity));
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    speed = fmax(speed, vec3_norm(vec3_load(scene->inlets[i].plan->velocity)));
  speed = fmax(speed, sqrt(2 * g * radius));
  double interval = speed > 0 ? tick_share * radius / speed : scene->plan.output->series;
  interval = fmin(interval, scene->plan.output->series);
  scene->tick_steps =
      scene->plan.tick ? scene->plan.tick : (uint64_t)fmax(1, floor(interval / scene->time_step));
}

static scree_status allocate_inlets(scree_scene *scene, scree_error *error) {
  const scree_plan *plan = &scene->plan;
  for (size_t i = 0; i < plan->inlets.count; i++) {
    scree_scene_inlet *inlet = &scene->inlets[i];
    inlet->plan = &plan->inlets.items[i];
    size_t count = inlet->plan->shapes.count;
    SCREE_TRY_TAKE(inlet->shapes, &scene->arena, count, error);
    SCREE_TRY_TAKE(inlet->counts, &scene->arena, count, error);
    for (size_t k = 0; k < count; k++)
      inlet->shapes[k] = SCREE_PLAN_FIND(plan->shapes, inlet->plan->shapes.names[k]);
  }
  return SCREE_OK;
}

scree_status scree_scene_prepare(scree_scene *scene, scree_error *error) {
  const scree_plan *plan = &scene->plan;
  SCREE_TRY(scree_plan_expand(&scene->plan, &scene->arena, error));
  scene->named_count = plan->shapes.count;
  SCREE_TRY_TAKE(scene->shapes, &scene->arena, plan->shapes.count, error);
  SCREE_TRY_TAKE(scene->geometry, &scene->arena, plan->geometry.count, error);
  SCREE_TRY_TAKE(scene->inlets, &scene->arena, plan->inlets.count, error);
  SCREE_TRY_TAKE(scene->outlets, &scene->arena, plan->outlets.count + 1, error);
  SCREE_TRY_TAKE(scene->sensors, &scene->arena, plan->sensors.count, error);
  scene->still_since = NAN;
  for (int k = 0; k < 3; k++) scene->table_low[k] = INFINITY, scene->table_high[k] = -INFINITY;
  scene->costs.piece_count = 1;
  SCREE_TRY(scree_scene_plan_forces(scene, error));
  SCREE_TRY(scree_scene_plan_parts(scene, error));
  SCREE_TRY(allocate_inlets(scene, error));
  return scree_sensors_plan(scene, error);
}

static scree_status set_up(scree_scene *scene, const char *folder, scree_error *error) {
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++) scree_scene_measure_shape(scene, i);
  SCREE_TRY(scree_scene_complete_plan(scene, error));
  SCREE_TRY(scree_scene_read_places(scene, folder, error));
  SCREE_TRY(make_gallery(scene, folder, error));
  scree_error why; /* a time step that is too long */
  scree_status status = scree_world_step(scene->gallery, 0, &why);
  SCREE_TRY(scree_scene_blame(scene, &scene->plan.contact->place, status, &why, error));
  scene->time_step = scree_world_time_step(scene->gallery, NULL);
  SCREE_TRY(scree_scene_make_world(scene, scene->time_step, &scene->world, error));
  SCREE_TRY(scree_geometry_add(scene, folder, scene->world, error));
  scree_world_share_walls(scene->world, scene->gallery);
  scene->gallery->hit_speed = scree_scene_hit_speed(scene);
  if (!(scene->plan.contact->time_step > 0)) scene->world->hit_speed = scene->gallery->hit_speed;
  scene->time_step = scree_world_time_step(scene->gallery, NULL);
  scene->world->options.time_step = scene->time_step;
  plan_ticks(scene);
  return SCREE_OK;
}

/* The walls' files are there: to be known before shapes are made, which may take minutes. */
static scree_status look_for_walls(const scree_scene *scene, const char *folder,
                                   scree_error *error) {
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    const scree_plan_geometry *g = &scene->plan.geometry.items[i];
    const char *name;
    for (size_t k = 0; (name = scree_geometry_file_name(g, k)); k++) {
      char *path = scree_scene_path(folder, name);
      if (!path) return scree_fail_memory(error, 0, "a path");
      scree_path_info info;
      scree_error why;
      scree_status status = SCREE_OK;
      if (!scree_path_look(path, &info))
        status = scree_fail(&why, SCREE_IO, "%s: cannot open: %s", path, strerror(errno));
      scree_free(path);
      SCREE_TRY(scree_scene_blame(scene, &g->place, status, &why, error));
    }
  }
  return SCREE_OK;
}

static scree_status make_particles(scree_scene *scene, const char *folder, scree_shape_store *store,
                                   const scree_progress *progress, scree_error *error) {
  scree_status status = look_for_walls(scene, folder, error);
  scree_shape_made made = {0};
  const scree_scene_making making = {store, progress, &made};
  for (size_t i = 0; status == SCREE_OK && i < SCREE_SCENE_SHAPES(scene); i++) {
    const scree_plan_shape *plan = &scene->plan.shapes.items[i];
    scree_error why;
    if (plan->joints) status = scree_scene_make_parts(scene, i, folder, &making, &why);
    if (status == SCREE_OK) status = scree_scene_make_shape(scene, i, folder, &making, &why);
    status = scree_scene_blame(scene, &plan->place, status, &why, error);
  }
  scree_particle_free(made.particle);
  return status;
}

/* Which materials have no density of their own. */
static scree_status note_densities(scree_scene *scene, const scree_scene_file *file,
                                   scree_error *error) {
  const scree_yaml *materials = scree_yaml_find(&file->root, "materials");
  size_t count = scene->plan.materials.count;
  SCREE_TRY_TAKE(scene->usual_density, &scene->arena, count, error);
  for (size_t i = 0; i < count; i++)
    scene->usual_density[i] = !scree_yaml_find(&materials->items[i], "density");
  return SCREE_OK;
}

scree_status scree_scene_take_file(scree_scene *scene, const scree_scene_file *file,
                                   scree_error *error) {
  SCREE_TRY(scree_scene_file_plan(file, &scene->arena, &scene->plan, error));
  SCREE_TRY(note_densities(scene, file, error));
  scene->name = scree_strdup(file->name);
  if (!scene->name) return scree_fail_memory(error, 0, "a scene's name");
  SCREE_TRY(scree_scene_file_text(file, &scene->text, error));
  return scree_scene_prepare(scene, error);
}

static scree_status create(const scree_scene_file *file, scree_shape_store *store,
                           const scree_progress *progress, scree_scene **scene,
                           scree_error *error) {
  SCREE_OWNED(scree_scene, made);
  SCREE_TRY_ALLOC_ZERO(made, 1, error);
  SCREE_TRY(scree_scene_take_file(made, file, error));
  SCREE_TRY(make_particles(made, file->folder, store, progress, error));
  SCREE_TRY(scree_scene_break_shapes(made, progress, error));
  SCREE_TRY(set_up(made, file->folder, error));
  SCREE_TRY(scree_sensors_begin(made, error));
  SCREE_TRY(scree_scene_check_inlets(made, error));
  SCREE_TRY(scree_scene_plan_layers(made, error));
  SCREE_TRY(scree_scene_check_softness(made, error));
  SCREE_TRY(scree_motions_check_speeds(made, error));
  SCREE_TRY(scree_scene_read_bodies(made, file->folder, error));
  SCREE_TRY(scree_scene_begin_phases(made, error));
  *scene = made;
  made = NULL;
  return SCREE_OK;
}

scree_scene_extent scree_scene_get_extent(const scree_scene *scene) {
  scree_scene_extent e = {0};
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++) {
    scree_particle_measures m;
    scree_particle_measure(scene->shapes[i].particle, &m);
    e.largest = fmax(e.largest, 2 * m.bounding_radius);
    e.mean += m.size / (double)SCREE_SCENE_SHAPES(scene);
  }
  return e;
}

scree_status scree_scene_file_extent(const scree_scene_file *file, scree_shape_store *store,
                                     const scree_progress *progress, scree_scene_extent *extent,
                                     scree_error *error) {
  SCREE_OWNED(scree_scene, made);
  SCREE_TRY_ALLOC_ZERO(made, 1, error);
  SCREE_TRY(scree_scene_take_file(made, file, error));
  SCREE_TRY(make_particles(made, file->folder, store, progress, error));
  *extent = scree_scene_get_extent(made);
  return SCREE_OK;
}

/* How large its shapes are is only known once they are made: they wait in a store. */
scree_status scree_scene_create_from(const scree_scene_file *file, scree_shape_store *store,
                                     const scree_progress *progress, scree_scene **scene,
                                     scree_error *error) {
  if (!scree_scene_file_scales(file)) return create(file, store, progress, scene, error);
  SCREE_OWNED(scree_shape_store, own);
  SCREE_OWNED(scree_scene_file, scaled);
  scree_scene_extent extent;
  if (!store) SCREE_TRY(scree_shape_store_create(&own, error));
  if (own) store = own;
  SCREE_TRY(scree_scene_file_extent(file, store, progress, &extent, error));
  SCREE_TRY(scree_scene_file_scale(file, &extent, &scaled, error));
  return create(scaled, store, progress, scene, error);
}

scree_status scree_scene_create(const scree_scene_file *file, const scree_progress *progress,
                                scree_scene **scene, scree_error *error) {
  return scree_scene_create_from(file, NULL, progress, scene, error);
}

scree_status scree_scene_file_column(const scree_scene_file *file, size_t index, char name[96],
                                     const char **unit, scree_error *error) {
  SCREE_OWNED(scree_scene, made);
  SCREE_TRY_ALLOC_ZERO(made, 1, error);
  SCREE_TRY(scree_scene_file_plan(file, &made->arena, &made->plan, error));
  SCREE_TRY(scree_scene_prepare(made, error));
  bool there = index < made->columns.count;
  snprintf(name, 96, "%s", there ? made->columns.items[index].name : "");
  if (unit) *unit = there ? made->columns.items[index].unit : NULL; /* static */
  return SCREE_OK;
}

void scree_scene_free(scree_scene *scene) {
  if (!scene) return;
  scree_world_free(scene->world);
  scree_world_free(scene->gallery);
  scree_scene_forget_assemblies(scene);
  for (size_t i = 0; scene->shapes && i < SCREE_SCENE_SHAPES(scene); i++) {
    scree_particle_free(scene->shapes[i].particle);
    scree_free(scene->shapes[i].source);
  }
  scree_sensors_end(scene);
  scree_free(scene->tables.items);
  scree_free(scene->columns.items);
  scree_free(scene->series.items);
  scree_free(scene->shape_of.items);
  scree_free(scene->entered_at.items);
  scree_free(scene->stays.items);
  scree_free(scene->present.items);
  scree_free(scene->changes.items);
  scree_free(scene->text);
  scree_free(scene->name);
  scree_arena_free(&scene->arena);
  scree_free(scene);
}

/* ---- going on ---- */

static bool is_still(scree_scene *scene) {
  const scree_plan_stop *stop = scene->plan.stop;
  scree_observation o;
  if (isnan(stop->still) || !scree_scene_is_filled(scene)) return false;
  scree_world_observe(scene->world, &o);
  bool still = scree_is_still(&o, stop->still) && o.pair_count > 0;
  scene->still_ticks = still ? scene->still_ticks + 1 : 0;
  double rest = stop->rest / ((double)scene->tick_steps * scene->time_step);
  return (double)scene->still_ticks >= (isnan(rest) ? STILL_TICKS : ceil(rest));
}

static bool is_over_after_filling(const scree_scene *scene) {
  double end = scree_scene_filling_time(scene) + scene->plan.stop->filled;
  return scree_scene_is_filled(scene) && scree_world_time(scene->world) >= end;
}

static double time_limit(const scree_scene *scene) {
  return isnan(scene->plan.time) ? INFINITY : scene->plan.time;
}

/* What ends it at any moment. */
static int find_over(const scree_scene *scene) {
  if (scree_world_time(scene->world) >= time_limit(scene)) return END_TIME;
  size_t phases = scene->plan.phases.count;
  return phases && scene->phase == phases ? END_PHASES : GOES_ON;
}

/* Why the scene ends; looked at with every tick. */
static int find_end(scree_scene *scene) {
  const scree_plan_stop *stop = scene->plan.stop;
  if (scree_world_time(scene->world) < stop->after) return GOES_ON;
  if (stop->empty && scene->world->bodies.removed_count == scene->shape_of.count &&
      scree_scene_is_filled(scene))
    return END_EMPTY;
  if (is_over_after_filling(scene)) return END_FILLED;
  return is_still(scene) ? END_STILL : GOES_ON;
}

static scree_status tick(scree_scene *scene, scree_error *error) {
  scene->next_tick += scene->tick_steps;
  scree_scene_empty(scene);
  return scree_scene_fill(scene, error);
}

static double next_row(const scree_scene *scene) {
  return (double)scene->row_count * scene->plan.output->series;
}

/* Steps up to the next tick or layer, or to just before the next row of the series, the end of a
 * phase or the end. */
static size_t steps_to_decision(const scree_scene *scene, size_t wanted) {
  uint64_t left = scene->next_tick - scree_world_step_count(scene->world);
  size_t steps = wanted < left ? wanted : (size_t)left, layer = scree_scene_steps_to_layer(scene);
  if (layer < steps) steps = layer;
  uint64_t done = scree_world_step_count(scene->world);
  uint64_t look = scree_sensors_next(scene);
  if (look < done + steps) steps = look > done ? (size_t)(look - done) : 1;
  double due = fmin(next_row(scene), fmin(time_limit(scene), scree_scene_phase_end(scene)));
  double until = floor((due - scree_world_time(scene->world)) / scene->time_step) - 1;
  if (until < (double)steps) steps = until > 1 ? (size_t)until : 1;
  return steps;
}

static scree_status decide(scree_scene *scene, scree_error *error) {
  bool ticks = scree_world_step_count(scene->world) >= scene->next_tick;
  if (scree_world_time(scene->world) >= next_row(scene)) scree_scene_take_lost(scene);
  SCREE_TRY(scree_sensors_watch(scene, ticks, error));
  if (ticks) SCREE_TRY(tick(scene, error));
  SCREE_TRY(scree_scene_turn_phase(scene, ticks, error));
  scene->end = find_over(scene);
  if (!scene->end && ticks) scene->end = find_end(scene);
  if (!scene->end) SCREE_TRY(scree_scene_enter_layers(scene, error));
  bool row = scree_world_time(scene->world) >= next_row(scene) || scene->end;
  return row ? scree_scene_record(scene, error) : SCREE_OK;
}

static scree_status advance(scree_scene *scene, size_t step_count, scree_error *error) {
  while (step_count > 0 && !scene->end) {
    SCREE_TRY(decide(scene, error));
    if (scene->end) break;
    bool anew = scene->has_parts || scene->plan.forces.count; /* what acts in each step */
    size_t steps = anew ? 1 : steps_to_decision(scene, step_count);
    if (scene->has_parts) SCREE_TRY(scree_scene_move_parts(scene, error));
    if (scene->plan.forces.count) SCREE_TRY(scree_scene_apply_forces(scene, error));
    SCREE_TRY(scree_world_step(scene->world, steps, error));
    scene->costs.body_steps +=
        steps * (scene->world->bodies.count - scene->world->bodies.removed_count);
    step_count -= steps;
  }
  return SCREE_OK;
}

/* A world counts its walls; a scene's have names. */
static void name_wall(const scree_scene *scene, scree_error *error) {
  size_t used = error ? strlen(error->message) : 0, index = scene->world->failed_wall - 1;
  if (!error || scene->world->failed_wall == 0) return;
  snprintf(error->message + used, sizeof error->message - used, "; wall %zu is '%s'", index,
           scree_scene_geometry_name(scene, scree_scene_wall_geometry(scene, index)));
}

scree_status scree_scene_advance(scree_scene *scene, size_t step_count, scree_error *error) {
  if (scene->is_frame)
    return scree_fail(error, SCREE_UNSUPPORTED,
                      "a frame has no contacts: a scene goes on from a checkpoint only");
  double wall = scree_now(), processor = scree_processor_time();
  scree_status status = advance(scene, step_count, error);
  if (status == SCREE_DIVERGED) name_wall(scene, error);
  scene->costs.wall_seconds += scree_now() - wall;
  scene->costs.processor_seconds += scree_processor_time() - processor;
  return status;
}

static bool same_number(double a, double b) {
  return a == b || (isnan(a) && isnan(b));
}

static bool same_stop(const scree_plan_stop *a, const scree_plan_stop *b) {
  return same_number(a->still, b->still) && same_number(a->rest, b->rest) &&
         same_number(a->filled, b->filled) && a->empty == b->empty && a->after == b->after;
}

void scree_scene_reopen(scree_scene *scene, const scree_plan *plan) {
  bool stops = scene->end == END_STILL || scene->end == END_EMPTY || scene->end == END_FILLED;
  if (!stops && scene->end != END_TIME) return;
  if (stops && same_stop(scene->plan.stop, plan->stop)) return;
  if (plan->time <= scree_world_time(scene->world)) return;
  scene->end = GOES_ON;
  const scree_plan_stop *was = scene->plan.stop;
  if (was->still != plan->stop->still || was->after != plan->stop->after) scene->still_ticks = 0;
  if (scree_world_time(scene->world) < next_row(scene) - scene->plan.output->series)
    scene->row_count--;
}

/* ---- looking ---- */

const char *scree_scene_end(const scree_scene *scene) {
  return ends[scene->end];
}
scree_scene_costs scree_scene_get_costs(const scree_scene *scene) {
  return scene->costs;
}
bool scree_scene_is_frame(const scree_scene *scene) {
  return scene->is_frame;
}
const char *scree_scene_title(const scree_scene *scene) {
  return scene->plan.title;
}
const char *scree_scene_text(const scree_scene *scene) {
  return scene->text;
}
scree_world *scree_scene_world(scree_scene *scene) {
  return scene->world;
}
const scree_world *scree_scene_view(const scree_scene *scene) {
  return scene->world;
}

const char *scree_scene_shape_family(const scree_scene *scene, size_t index) {
  return index < SCREE_SCENE_SHAPES(scene)
             ? scree_scene_class_name(scene, SCREE_BY_SHAPE, scene->shapes[index].family)
             : NULL;
}
const char *scree_scene_shape_source(const scree_scene *scene, size_t index) {
  return index < SCREE_SCENE_SHAPES(scene) ? scene->shapes[index].source : NULL;
}
scree_particle *scree_scene_shape_particle(const scree_scene *scene, size_t index) {
  return scene->shapes[index].particle;
}
const char *scree_scene_geometry_note(const scree_scene *scene, size_t index) {
  return scene->geometry[index].note;
}
size_t scree_scene_inlet_count(const scree_scene *scene, size_t index, double *mass,
                               size_t *waiting) {
  if (mass) *mass = scene->inlets[index].mass;
  if (waiting) *waiting = scene->inlets[index].waiting;
  return scene->inlets[index].entered;
}

size_t scree_scene_outlet_count(const scree_scene *scene, size_t index, double *mass) {
  if (mass) *mass = scene->outlets[index].mass;
  return scene->outlets[index].left;
}
