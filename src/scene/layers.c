/* Inlets by layers. A layer of random places is a slab one and a half times as thick as the longest
 * body, filled by random sequential addition (fill.h); one of a grid has a body in every cell of a
 * square grid whose pitch is the largest bounding sphere. A layer enters above all that is there,
 * as soon as the one before has moved out of the way:
 *   spacing p = v t + g t^2 / 2,  p a layer's height, v the velocity of entering;
 * or, where all must be in after a given time, at equal intervals with the velocity that makes room
 * in each. When a layer enters follows from its number alone, so a scene can be cut anyhow. */
#include "scene/scene.h"

#include "base/alloc.h"
#include "base/rng.h"

static const double layer_thickness = 1.5; /* of the longest body */
static const double layer_spacing = 1.05;  /* of a layer's height, travelled before the next */
static const double fastest = 8;           /* m/s: faster hits leave the contact law's range */
static const double cell_share = 1.02;     /* of the largest body's diameter: a grid's pitch */
enum { GRID_STREAM = 16 };

static double box_length(const scree_placement *p) {
  return 2 * fmin(p->radius, vec3_norm(p->half));
}

static uint64_t seed_of(const scree_scene *scene, const scree_scene_inlet *inlet) {
  return scene->plan.seed + (uint64_t)(inlet - scene->inlets);
}

/* ---- planning ---- */

static scree_status allocate(scree_scene *scene, scree_scene_inlet *inlet, scree_error *error) {
  scree_scene_layers *l = &inlet->layers;
  size_t shapes = SCREE_SCENE_SHAPES(scene);
  SCREE_TRY_TAKE(l->extents, &scene->arena, shapes, error);
  for (size_t i = 0; i < shapes; i++)
    l->extents[i] = scree_placement_of(scene->shapes[i].particle,
                                       inlet->plan->layers->packed ? 0 : l->clearance);
  return SCREE_OK;
}

static scree_fill_layer layer_at(const scree_scene *scene, const scree_scene_inlet *inlet,
                                 double bottom) {
  const scree_scene_layers *l = &inlet->layers;
  return (scree_fill_layer){.seed = seed_of(scene, inlet),
                            .layer_index = l->count,
                            .cylinder_radius = l->radius,
                            .bottom = bottom,
                            .height = l->height,
                            .half = {l->half[0], l->half[1]},
                            .centre = {l->middle.x, l->middle.y}};
}

/* The extents of all bodies but those that have entered, in their order; to be freed. */
static scree_placement *list_waiting(const scree_scene_inlet *inlet, size_t entered, size_t *count,
                                     scree_error *error) {
  *count = inlet->plan->count - entered;
  scree_placement *waiting = scree_alloc(*count, sizeof *waiting);
  if (!waiting) {
    scree_fail_memory(error, *count * sizeof *waiting, "a layer");
    return NULL;
  }
  for (size_t i = 0; i < *count; i++)
    waiting[i] = inlet->layers.extents[inlet->shapes[inlet->layers.order[entered + i]]];
  return waiting;
}

static bool is_clear(const void *scene, const scree_placement *placement) {
  size_t wall;
  return scree_scene_is_clear(scene, placement, &wall);
}

/* Places all layer by layer without moving it: how many there will be, exactly as long as no body
 * stands in the way. The first is placed among the walls, too. */
static scree_status count_layers(const scree_scene *scene, scree_scene_inlet *inlet,
                                 scree_error *error) {
  const scree_scene_layers *l = &inlet->layers;
  size_t count, placed = 0, layers = 0;
  SCREE_CLEANUP(scree_free_at) scree_placement *waiting = list_waiting(inlet, 0, &count, error);
  if (!waiting) return SCREE_OUT_OF_MEMORY;
  for (; placed < count; layers++) {
    scree_fill_layer layer = layer_at(scene, inlet, 0);
    layer.layer_index = layers;
    size_t more = scree_fill_place(&layer, waiting + placed, count - placed);
    if (more == 0)
      return scree_scene_fail(scene, &inlet->plan->place, error,
                              "a particle %.4g mm across does not fit into the %s of %.4g mm",
                              1e3 * box_length(&waiting[placed]),
                              l->radius > 0 ? "cylinder" : "box",
                              2e3 * (l->radius > 0 ? l->radius : fmin(l->half[0], l->half[1])));
    placed += more;
  }
  if (inlet->layers.count == 0) {
    scree_fill_layer layer = layer_at(scene, inlet, l->middle.z);
    layer.is_clear = is_clear, layer.context = scene;
    if (scree_fill_place(&layer, waiting, 1) == 0)
      return scree_scene_fail(scene, &inlet->plan->place, error,
                              "nowhere at %.4g m, where its layers begin, is there room for a "
                              "particle %.4g mm across clear of the walls",
                              l->middle.z, 1e3 * box_length(&waiting[0]));
  }
  inlet->layers.planned = layers;
  return SCREE_OK;
}

/* s in which a body moves by the way. */
static double falling_time(const scree_scene *scene, double speed, double way) {
  double g = -scene->plan.gravity[2];
  return g > 0 ? (sqrt(speed * speed + 2 * g * way) - speed) / g : way / speed;
}

static scree_status plan_random(const scree_scene *scene, scree_scene_inlet *inlet,
                                scree_error *error) {
  scree_scene_layers *l = &inlet->layers;
  double pack_time = inlet->plan->layers->pack_time;
  l->height = 0;
  for (size_t k = 0; k < inlet->plan->shapes.count; k++)
    l->height = fmax(l->height, layer_thickness * box_length(&l->extents[inlet->shapes[k]]));
  SCREE_TRY(count_layers(scene, inlet, error));
  double travel = layer_spacing * l->height;
  l->speed = -inlet->plan->velocity[2];
  if (isnan(pack_time)) {
    l->interval = falling_time(scene, l->speed, travel);
  } else {
    l->interval = pack_time / (double)l->planned;
    l->speed = l->planned > 1 ? travel / l->interval : 0;
  }
  if (l->speed <= fastest) return SCREE_OK;
  return scree_scene_fail(
      scene, &inlet->plan->place, error,
      "%zu particles make %zu layers of %.4g mm, which would have to enter at %.3g m/s; at most %g "
      "m/s: set pack_time to %.3g s or more, or a wider cylinder",
      inlet->plan->count, l->planned, 1e3 * l->height, l->speed, fastest,
      travel * (double)l->planned / fastest);
}

/* ---- a grid ---- */

/* Cells along a side; in a circle the grid may have a cell or a corner in the middle. */
static size_t fill_grid(const scree_scene_layers *l, size_t nx, size_t ny, vec3 *cells) {
  bool round = l->radius > 0;
  double dx = round ? l->pitch : 2 * l->half[0] / (double)nx,
         dy = round ? l->pitch : 2 * l->half[1] / (double)ny,
         most = 0.5 * (2 * l->radius - l->pitch);
  size_t count = 0;
  for (size_t j = 0; j < ny; j++)
    for (size_t i = 0; i < nx; i++) {
      vec3 c = {((double)i + 0.5 - 0.5 * (double)nx) * dx,
                ((double)j + 0.5 - 0.5 * (double)ny) * dy, 0};
      if (round && vec3_norm(c) > most) continue;
      if (cells) cells[count] = c;
      count++;
    }
  return count;
}

static scree_status make_cells(scree_scene *scene, scree_scene_inlet *inlet, scree_error *error) {
  scree_scene_layers *l = &inlet->layers;
  bool round = l->radius > 0;
  double count = (double)inlet->plan->count, width = 2 * (round ? l->radius : l->half[0]),
         depth = 2 * (round ? l->radius : l->half[1]), narrow = fmin(width, depth);
  if (narrow < l->pitch)
    return scree_scene_fail(
        scene, &inlet->plan->place, error,
        "a container %.4g m wide is too narrow for a particle %.4g m across: at least %.4g m",
        narrow, l->pitch / cell_share, l->pitch);
  double most_x = floor(width / l->pitch), most_y = floor(depth / l->pitch);
  if (most_x * most_y > count) { /* no more than are used: nearly a square */
    double side = ceil(sqrt(count)) + 2;
    most_x = fmin(most_x, fmax(side, ceil(count / most_y)));
    most_y = fmin(most_y, fmax(side, ceil(count / most_x)));
  }
  size_t nx = (size_t)most_x, ny = (size_t)most_y;
  if (round && nx > 1 && fill_grid(l, nx - 1, ny - 1, NULL) > fill_grid(l, nx, ny, NULL))
    nx--, ny--;
  size_t cells = fill_grid(l, nx, ny, NULL);
  if (cells == 0) nx = ny = cells = 1; /* in the middle */
  l->cells = scree_arena_take(&scene->arena, cells, sizeof *l->cells);
  l->cell_order = scree_arena_take(&scene->arena, cells, sizeof *l->cell_order);
  if (!l->cells || !l->cell_order)
    return scree_fail_memory(error, cells * sizeof *l->cells, "the cells of a layer");
  l->cell_count = fill_grid(l, nx, ny, l->cells);
  return SCREE_OK;
}

static scree_status plan_grid(scree_scene *scene, scree_scene_inlet *inlet, scree_error *error) {
  scree_scene_layers *l = &inlet->layers;
  SCREE_TRY(make_cells(scene, inlet, error));
  l->speed = -inlet->plan->velocity[2];
  l->steps =
      (uint64_t)ceil(falling_time(scene, l->speed, layer_spacing * l->pitch) / scene->time_step);
  size_t cells = l->cell_count > 0 ? l->cell_count : 1;
  l->planned = (inlet->plan->count + cells - 1) / cells;
  return SCREE_OK;
}

scree_status scree_scene_plan_layers(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    scree_scene_inlet *inlet = &scene->inlets[i];
    if (!inlet->plan->layers) continue;
    bool moves = inlet->plan->velocity[2] < 0 || !isnan(inlet->plan->layers->pack_time);
    if (!moves && !(scene->plan.gravity[2] < 0))
      return scree_scene_fail(scene, &inlet->plan->place, error,
                              "its layers need a velocity or a pack_time: nothing falls");
    SCREE_TRY(allocate(scene, inlet, error));
    SCREE_TRY(inlet->plan->layers->packed ? plan_grid(scene, inlet, error)
                                          : plan_random(scene, inlet, error));
  }
  return SCREE_OK;
}

/* ---- entering ---- */

static scree_status enter_random(scree_scene *scene, scree_scene_inlet *inlet, double bottom,
                                 scree_error *error) {
  size_t left;
  double velocity[3] = {0, 0, -inlet->layers.speed};
  const double low[3] = {-INFINITY, -INFINITY, bottom}, high[3] = {INFINITY, INFINITY, INFINITY};
  SCREE_TRY(scree_scene_list_present(scene, inlet->layers.extents, low, high, error));
  SCREE_CLEANUP(scree_free_at)
  scree_placement *waiting = list_waiting(inlet, inlet->entered, &left, error);
  if (!waiting) return SCREE_OUT_OF_MEMORY;
  scree_fill_layer layer = layer_at(scene, inlet, bottom);
  layer.present = scene->present.items, layer.present_count = scene->present.count;
  layer.is_clear = is_clear, layer.context = scene;
  size_t placed = scree_fill_place(&layer, waiting, left);
  for (size_t i = 0; i < placed; i++)
    SCREE_TRY(scree_scene_enter(scene, inlet, inlet->layers.order[inlet->entered], &waiting[i],
                                velocity, error));
  return SCREE_OK;
}

/* The place of a body in its cell: the room that a smaller one has is used at random. */
static scree_placement place_in_cell(const scree_scene_inlet *inlet, size_t shape, vec3 cell,
                                     scree_rng *rng) {
  scree_placement p = inlet->layers.extents[shape];
  double room = 0.5 * inlet->layers.pitch - cell_share * p.radius;
  vec3 shift = vec3_scale(scree_rng_direction(rng), room > 0 ? room * scree_rng_uniform(rng) : 0);
  p.position = vec3_add(cell, shift);
  p.orientation = scree_rng_rotation(rng);
  return p;
}

static scree_status enter_grid(scree_scene *scene, scree_scene_inlet *inlet, double bottom,
                               scree_error *error) {
  scree_scene_layers *l = &inlet->layers;
  scree_rng rng = {.seed = seed_of(scene, inlet), .stream = GRID_STREAM + l->count};
  double velocity[3] = {0, 0, -l->speed};
  for (size_t i = 0; i < l->cell_count; i++) l->cell_order[i] = (uint32_t)i;
  scree_rng_shuffle(&rng, l->cell_order, l->cell_count, sizeof *l->cell_order);
  scene->present.count = 0;
  for (size_t k = 0; k < l->cell_count; k++) {
    if (inlet->entered == inlet->plan->count) break;
    size_t which = l->order[inlet->entered];
    vec3 cell = l->cells[l->cell_order[k]];
    scree_placement p = place_in_cell(inlet, inlet->shapes[which], cell, &rng);
    p.position.x += l->middle.x, p.position.y += l->middle.y;
    p.position.z += bottom + 0.5 * l->pitch;
    SCREE_TRY(scree_scene_enter(scene, inlet, which, &p, velocity, error));
  }
  return SCREE_OK;
}

/* 0: now. */
static size_t steps_to(const scree_scene *scene, const scree_scene_inlet *inlet) {
  const scree_scene_layers *l = &inlet->layers;
  if (!inlet->plan->layers || inlet->entered == inlet->plan->count) return SIZE_MAX;
  if (l->steps) {
    uint64_t now = scree_world_step_count(scene->world), due = l->count * l->steps;
    return due > now ? (size_t)(due - now) : 0;
  }
  double left = (double)l->count * l->interval - scree_world_time(scene->world);
  if (left <= 0) return 0;
  double steps = floor(left / scene->time_step) - 1;
  return steps < 1 ? 1 : steps < 1e9 ? (size_t)steps : 1000000000;
}

size_t scree_scene_steps_to_layer(const scree_scene *scene) {
  size_t least = SIZE_MAX;
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    size_t steps = steps_to(scene, &scene->inlets[i]);
    if (steps < least) least = steps;
  }
  return least;
}

double scree_scene_filling_time(const scree_scene *scene) {
  double latest = 0;
  if (scree_scene_is_filled(scene))
    return scene->entered_at.count ? scene->entered_at.items[scene->entered_at.count - 1] : 0;
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    const scree_scene_layers *l = &scene->inlets[i].layers;
    double interval = l->steps ? (double)l->steps * scene->time_step : l->interval;
    if (!scene->inlets[i].plan->layers) return INFINITY;
    latest = fmax(latest, (double)(l->planned - 1) * interval);
  }
  return latest;
}

static scree_status enter_layer(scree_scene *scene, scree_scene_inlet *inlet, scree_error *error) {
  const scree_plan_layers *plan = inlet->plan->layers;
  /* What is just entering in random layers does not count: it moves out of the way. */
  double slowest = plan->packed ? -INFINITY : -0.5 * inlet->layers.speed;
  double above = plan->above + (plan->packed ? (cell_share - 1) * inlet->layers.pitch : 0),
         bottom = fmax(inlet->layers.middle.z,
                       scree_scene_highest(scene, inlet->layers.extents, slowest) + above);
  scree_status status = plan->packed ? enter_grid(scene, inlet, bottom, error)
                                     : enter_random(scene, inlet, bottom, error);
  inlet->layers.count++;
  return status;
}

scree_status scree_scene_enter_layers(scree_scene *scene, scree_error *error) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    while (steps_to(scene, &scene->inlets[i]) == 0)
      SCREE_TRY(enter_layer(scene, &scene->inlets[i], error));
  return SCREE_OK;
}
