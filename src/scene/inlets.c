/* Inlets: random sequential addition. A body that is due takes a random place and orientation in
 * its region; where it would touch another or a wall it takes the next, and after so many tries it
 * waits until the next tick. Shapes come in their shares: next is the one that is most behind. */
#include "scene/region.h"
#include "scene/starts.h"

#include "base/alloc.h"
#include "base/array.h"

#include <string.h>

enum { TRIES = 100, FIRST_TRIES = 4000, STREAM = 64 };

/* ---- what is due ---- */

/* Since the rate counts. */
static double active_time(const scree_scene_inlet *inlet, double time) {
  const scree_plan_inlet *plan = inlet->plan;
  double until = isnan(plan->until) ? INFINITY : plan->until;
  return fmax(0, fmin(time, until) - fmax(plan->from, inlet->begin.time));
}

/* kg that should be in by now. */
static double due_mass(const scree_scene_inlet *inlet, double time) {
  return inlet->begin.mass + inlet->plan->mass_rate * active_time(inlet, time);
}

/* How many bodies should be in by now. */
static size_t due_count(const scree_scene_inlet *inlet, double time) {
  const scree_plan_inlet *plan = inlet->plan;
  size_t most = plan->count ? plan->count : SIZE_MAX;
  if (time < plan->from) return 0;
  if (!isnan(plan->rate)) {
    double due =
        (double)inlet->begin.count + ceil(plan->rate * active_time(inlet, time) * (1 - 1e-12));
    return due < (double)most ? (size_t)due : most;
  }
  if (!isnan(plan->mass_rate)) return most; /* by mass, below */
  return isnan(plan->until) || time < plan->until ? most : inlet->entered;
}

static bool is_due(const scree_scene_inlet *inlet, double time) {
  const scree_plan_inlet *plan = inlet->plan;
  if (inlet->entered >= due_count(inlet, time)) return false;
  return isnan(plan->mass_rate) || inlet->mass < due_mass(inlet, time);
}

/* How many wait, now that no more fit: bodies of a mass rate are counted by the mean mass. */
static size_t count_waiting(const scree_scene *scene, const scree_scene_inlet *inlet, double time) {
  const scree_plan_inlet *plan = inlet->plan;
  if (isnan(plan->mass_rate)) {
    size_t due = due_count(inlet, time);
    return due > inlet->entered ? due - inlet->entered : 0;
  }
  double mean = 0, shares = 0;
  for (size_t k = 0; k < plan->shapes.count; k++) {
    mean += plan->shapes.values[k] * scene->shapes[inlet->shapes[k]].mass;
    shares += plan->shapes.values[k];
  }
  double behind = (due_mass(inlet, time) - inlet->mass) * shares / mean;
  return behind > 0 ? (size_t)ceil(behind) : 0;
}

static bool has_ended(const scree_scene_inlet *inlet, double time) {
  const scree_plan_inlet *plan = inlet->plan;
  if (plan->count && inlet->entered >= plan->count) return true;
  return !isnan(plan->until) && time >= plan->until && inlet->waiting == 0;
}

bool scree_scene_is_filled(const scree_scene *scene) {
  double time = scree_world_time(scene->world);
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    if (!has_ended(&scene->inlets[i], time)) return false;
  return true;
}

/* ---- a place ---- */

/* Whether the random place is within the region. */
static bool draw(const scree_scene *scene, const scree_scene_inlet *inlet, size_t shape,
                 scree_rng *rng, scree_placement *p) {
  *p = scene->shapes[shape].extent;
  p->orientation =
      inlet->plan->orientation ? scene->shapes[shape].as_given : scree_rng_rotation(rng);
  p->position = (vec3){0, 0, 0};
  scree_placement_settle(p);
  return scree_region_draw(&SCREE_REGION_OF(inlet->plan), p, rng);
}

bool scree_scene_draw_start(const scree_scene *scene, size_t index, size_t which, scree_rng *rng,
                            scree_placement *placement) {
  const scree_scene_inlet *inlet = &scene->inlets[index];
  return draw(scene, inlet, inlet->shapes[which], rng, placement);
}

static scree_rng rng_of(const scree_scene *scene, size_t index) {
  return (scree_rng){scene->plan.seed, STREAM + index, scene->inlets[index].draws};
}

/* ---- before it begins ---- */

static scree_status check_shape(scree_scene *scene, size_t index, size_t shape,
                                scree_error *error) {
  scree_scene_inlet *inlet = &scene->inlets[index];
  const scree_place *place = &inlet->plan->place;
  scree_rng rng = {scene->plan.seed, STREAM / 2, 0};
  scree_placement p;
  size_t wall = 0, within = 0;
  for (int try = 0; try < FIRST_TRIES; try++) {
    if (!draw(scene, inlet, shape, &rng, &p)) continue;
    within++;
    if (scree_scene_is_clear(scene, &p, &wall)) return SCREE_OK;
    if (within > FIRST_TRIES / 8) break;
  }
  const char *name = scene->plan.shapes.items[shape].place.name;
  if (!within)
    return scree_scene_fail(
        scene, place, error,
        "is too small for '%s', %.4g x %.4g x %.4g m with the room about it: enlarge it, "
        "and the walls around",
        name, 2 * p.half.x, 2 * p.half.y, 2 * p.half.z);
  size_t g = scree_scene_wall_geometry(scene, wall);
  return scree_scene_fail(scene, place, error,
                          "lies in '%s': nowhere in it is there room for '%s' clear of that wall",
                          scree_scene_geometry_name(scene, g), name);
}

scree_status scree_scene_check_inlets(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    for (size_t k = 0; !scene->inlets[i].plan->layers && k < scene->inlets[i].plan->shapes.count;
         k++)
      SCREE_TRY(check_shape(scene, i, scene->inlets[i].shapes[k], error));
  return SCREE_OK;
}

/* ---- filling ---- */

/* The body, and in a periodic domain its images that reach into the region. */
static bool push_present(scree_scene *scene, const scree_placement *p, const double low[3],
                         const double high[3]) {
  const double *period = scene->world->options.period;
  int most[3];
  for (int k = 0; k < 3; k++) most[k] = period[k] > 0;
  for (int x = -most[0]; x <= most[0]; x++)
    for (int y = -most[1]; y <= most[1]; y++)
      for (int z = -most[2]; z <= most[2]; z++) {
        scree_placement image = *p;
        image.position = vec3_add(p->position, (vec3){x * period[0], y * period[1], z * period[2]});
        const double at[3] = {image.position.x, image.position.y, image.position.z};
        bool inside = true;
        for (int k = 0; k < 3; k++)
          inside = inside && at[k] + p->radius >= low[k] && at[k] - p->radius <= high[k];
        if (!inside) continue;
        scree_placement_settle(&image);
        if (!SCREE_PUSH(&scene->present, image)) return false;
      }
  return true;
}

scree_status scree_scene_list_present(scree_scene *scene, const scree_placement *extents,
                                      const double low[3], const double high[3],
                                      scree_error *error) {
  scene->present.count = 0;
  scree_body body;
  for (size_t b = 0; scree_scene_next_body(scene, &b, &body); b++) {
    size_t shape = scene->shape_of.items[b];
    scree_placement p = extents ? extents[shape] : scene->shapes[shape].extent;
    p.position = vec3_load(body.position);
    p.orientation = scree_body_turn(&body);
    if (!push_present(scene, &p, low, high))
      return scree_fail_memory(error, scene->present.count * sizeof p, "an inlet's bodies");
  }
  return SCREE_OK;
}

double scree_scene_highest(const scree_scene *scene, const scree_placement *extents,
                           double slowest) {
  double top = -INFINITY;
  scree_body body;
  for (size_t b = 0; scree_scene_next_body(scene, &b, &body); b++) {
    size_t shape = scene->shape_of.items[b];
    double radius = extents ? extents[shape].radius : scene->shapes[shape].extent.radius;
    if (body.velocity[2] >= slowest) top = fmax(top, body.position[2] + radius);
  }
  return top;
}

static scree_status list_near(scree_scene *scene, const scree_plan_inlet *plan,
                              scree_error *error) {
  double low[3], high[3];
  scree_region_bounds(&SCREE_REGION_OF(plan), low, high);
  return scree_scene_list_present(scene, NULL, low, high, error);
}

static bool is_free(const scree_scene *scene, const scree_placement *p) {
  size_t wall;
  for (size_t i = scene->present.count; i-- > 0;)
    if (!scree_placements_apart(p, &scene->present.items[i])) return false;
  return scree_scene_is_clear(scene, p, &wall);
}

scree_status scree_scene_add_body(const scree_scene_shape *shape, scree_world *world,
                                  const scree_body *state, scree_error *error) {
  size_t index;
  SCREE_TRY(scree_world_add_body(world, shape->particle, shape->material, state, &index, error));
  return scree_world_set_body_density(world, index, shape->density, error);
}

scree_status scree_scene_admit(scree_scene *scene, size_t shape, const scree_body *body,
                               scree_error *error) {
  scree_scene_shape *s = &scene->shapes[shape];
  if (s->piece_count > 0) return scree_scene_admit_assembly(scene, shape, body, error);
  if (!SCREE_RESERVE(&scene->shape_of, scene->shape_of.count + 1) ||
      !SCREE_RESERVE(&scene->entered_at, scene->entered_at.count + 1) ||
      !SCREE_RESERVE(&scene->stays, scene->stays.count + 1))
    return scree_fail_memory(error, scene->shape_of.count * sizeof *body, "bodies");
  SCREE_TRY(scree_scene_add_body(s, scene->world, body, error));
  scene->shape_of.items[scene->shape_of.count++] = (uint32_t)shape;
  scene->entered_at.items[scene->entered_at.count++] = scree_world_time(scene->world);
  scene->stays.items[scene->stays.count++] = (scree_scene_stay){NAN, UINT32_MAX, UINT32_MAX};
  const double *moments = s->particle->measures.inertia;
  mat3 turn = quat_to_mat3(scree_body_turn(body));
  vec3 v = vec3_load(body->velocity), g = vec3_load(scene->plan.gravity),
       w = mat3_tmul_vec(&turn, vec3_load(body->angular_velocity));
  double spin = moments[0] * w.x * w.x + moments[1] * w.y * w.y + moments[2] * w.z * w.z;
  scene->entered_energy += s->mass * (0.5 * vec3_norm2(v) - vec3_dot(g, vec3_load(body->position)));
  scene->entered_energy += 0.5 * s->density * spin;
  scene->entered_mass += s->mass;
  s->entered++;
  return SCREE_OK;
}

scree_status scree_scene_enter(scree_scene *scene, scree_scene_inlet *inlet, size_t which,
                               const scree_placement *p, const double velocity[3],
                               scree_error *error) {
  size_t shape = inlet->shapes[which];
  scree_scene_shape *s = &scene->shapes[shape];
  scree_body body = scree_default_body();
  vec3_store(body.position, p->position);
  const double q[4] = {p->orientation.w, p->orientation.x, p->orientation.y, p->orientation.z};
  memcpy(body.orientation, q, sizeof q);
  memcpy(body.velocity, velocity, sizeof body.velocity);
  if (!SCREE_PUSH(&scene->present, *p))
    return scree_fail_memory(error, scene->present.count * sizeof *p, "bodies");
  size_t before = scene->stays.count;
  SCREE_TRY(scree_scene_admit(scene, shape, &body, error));
  for (size_t b = before; b < scene->stays.count; b++)
    scene->stays.items[b].inlet = (uint32_t)(inlet - scene->inlets);
  inlet->mass += s->mass;
  inlet->entered++;
  inlet->counts[which]++;
  return SCREE_OK;
}

static scree_status fill(scree_scene *scene, size_t index, scree_error *error) {
  scree_scene_inlet *inlet = &scene->inlets[index];
  double time = scree_world_time(scene->world);
  bool room = true, listed = false;
  while (room && is_due(inlet, time)) {
    const scree_weights *shares = &inlet->plan->shapes;
    size_t which = scree_fill_next_shape(shares->values, shares->count, inlet->counts);
    scree_placement p;
    scree_rng rng = rng_of(scene, index);
    scree_status status = listed ? SCREE_OK : list_near(scene, inlet->plan, error);
    if (status != SCREE_OK) return status;
    listed = true;
    room = false;
    for (int try = 0; try < TRIES && !room; try++)
      room = draw(scene, inlet, inlet->shapes[which], &rng, &p) && is_free(scene, &p);
    inlet->draws = rng.counter;
    if (room) status = scree_scene_enter(scene, inlet, which, &p, inlet->plan->velocity, error);
    if (status != SCREE_OK) return status;
  }
  inlet->waiting = room ? 0 : count_waiting(scene, inlet, time);
  return SCREE_OK;
}

scree_status scree_scene_fill(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    if (!scene->inlets[i].plan->layers) SCREE_TRY(fill(scene, i, error));
  return SCREE_OK;
}
