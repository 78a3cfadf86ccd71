/* Pouring: layers on a square grid enter above all that is there, at a fixed number of steps after
 * each other, in which a falling layer moves out of the way of the next:
 *   layer_spacing p = v t + g t^2 / 2,  p the grid's pitch, v the entry speed.
 * Which step a layer enters at follows from its number alone, so a pour can be cut into calls
 * anyhow. A cell holds the largest bounding sphere; smaller ones get a random place in theirs. */
#include "pile/pour.h"

#include "base/alloc.h"
#include "base/rng.h"

#include <string.h>

static const double pi = 3.14159265358979323846;
static const double cell_share = 1.02;     /* of the largest particle's diameter: the pitch */
static const double layer_spacing = 1.05;  /* pitches fallen before the next layer */
static const double loose_packing = 0.3;   /* solid fraction behind the default width */
static const double particles_abreast = 3; /* in the default width */
enum { ORDER_STREAM = 1, LAYER_STREAM = 16 };

scree_pour_options scree_default_pour_options(void) {
  return (scree_pour_options){.world = scree_default_world_options(),
                              .particles = scree_default_material(),
                              .walls = scree_default_wall_material(),
                              .drop_height = 0.05,
                              .entry_speed = 1,
                              .seed = 1};
}

/* ---- what enters ---- */

static scree_status check(const scree_pour_shape *shapes, size_t shape_count,
                          const scree_pour_options *o, scree_error *error) {
  size_t count = 0;
  for (size_t i = 0; i < shape_count; i++) count += shapes[i].count;
  if (count == 0) return scree_fail(error, SCREE_BAD_ARGUMENT, "pour: there are no particles");
  if (count > UINT32_MAX / 8)
    return scree_fail(error, SCREE_LIMIT, "pour: %zu particles; at most %u", count, UINT32_MAX / 8);
  const double values[] = {o->width, o->depth, o->drop_height, o->entry_speed};
  static const char *const names[] = {"width", "depth", "drop height", "entry speed"};
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    if (!(values[i] >= 0 && values[i] <= 1e6))
      return scree_fail(error, SCREE_BAD_ARGUMENT, "pour: %s %g; from 0 to 1e6", names[i],
                        values[i]);
  if (!(o->world.gravity[2] < 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "pour: gravity along z is %g m/s2; it must point down", o->world.gravity[2]);
  if (o->container != SCREE_CONTAINER_CYLINDER && o->container != SCREE_CONTAINER_BOX)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "pour: container number %d is none",
                      (int)o->container);
  return SCREE_OK;
}

/* Shapes in proportion to their counts, shuffled. */
static void mix_shapes(scree_pour *pour, const scree_pour_shape *shapes) {
  scree_rng rng = {.seed = pour->options.seed, .stream = ORDER_STREAM};
  size_t k = 0;
  for (size_t s = 0; s < pour->shape_count; s++)
    for (size_t i = 0; i < shapes[s].count; i++) pour->shape_of[k++] = s;
  scree_rng_shuffle(&rng, pour->shape_of, pour->count, sizeof *pour->shape_of);
}

/* Radii, pitch and, where none is given, the width. */
static void measure(scree_pour *pour) {
  double largest = 0, solid = 0;
  for (size_t i = 0; i < pour->count; i++) {
    scree_particle_measures m;
    scree_particle_measure(pour->particles[pour->shape_of[i]], &m);
    pour->radii[i] = m.bounding_radius;
    largest = fmax(largest, m.bounding_radius);
    solid += m.volume;
  }
  pour->pitch = 2 * cell_share * largest;
  scree_pour_options *o = &pour->options;
  bool round = o->container == SCREE_CONTAINER_CYLINDER;
  if (!(o->width > 0)) {
    double abreast = fmin(particles_abreast, ceil(cbrt((double)pour->count)));
    o->width = fmax(cbrt(solid / loose_packing * (round ? 4 / pi : 1)),
                    (round ? abreast + 0.5 : abreast) * pour->pitch);
  }
  if (!(o->depth > 0) || round) o->depth = o->width;
}

/* ---- where it enters ---- */

/* Cells along a side; in a circle the grid may have a cell or a corner in the middle. */
static size_t fill_grid(scree_pour *pour, size_t nx, size_t ny, vec3 *cells) {
  const scree_pour_options *o = &pour->options;
  bool round = o->container == SCREE_CONTAINER_CYLINDER;
  double dx = round ? pour->pitch : o->width / (double)nx,
         dy = round ? pour->pitch : o->depth / (double)ny, most = 0.5 * (o->width - pour->pitch);
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

static scree_status make_cells(scree_pour *pour, scree_error *error) {
  const scree_pour_options *o = &pour->options;
  double narrow = fmin(o->width, o->depth);
  if (narrow < pour->pitch)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "pour: a container %.4g m wide is too narrow for a particle %.4g m across: "
                      "at least %.4g m",
                      narrow, pour->pitch / cell_share, pour->pitch);
  double most_x = floor(o->width / pour->pitch), most_y = floor(o->depth / pour->pitch);
  if (most_x * most_y > (double)pour->count) { /* no more than are used: nearly a square */
    double side = ceil(sqrt((double)pour->count)) + 2;
    most_x = fmin(most_x, fmax(side, ceil((double)pour->count / most_y)));
    most_y = fmin(most_y, fmax(side, ceil((double)pour->count / most_x)));
  }
  size_t nx = (size_t)most_x, ny = (size_t)most_y;
  if (o->container == SCREE_CONTAINER_CYLINDER && nx > 1 &&
      fill_grid(pour, nx - 1, ny - 1, NULL) > fill_grid(pour, nx, ny, NULL))
    nx--, ny--;
  size_t count = fill_grid(pour, nx, ny, NULL);
  if (count == 0) nx = ny = count = 1; /* in the middle */
  SCREE_ALLOC_OR(pour->cells, count, error, out_of_memory);
  SCREE_ALLOC_OR(pour->cell_order, count, error, out_of_memory);
  pour->cell_count = fill_grid(pour, nx, ny, pour->cells);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

/* The place of a particle in its cell: the room that a smaller one has is used at random. */
static scree_body place(const scree_pour *pour, size_t particle, vec3 cell, double bottom,
                        scree_rng *rng) {
  double room = 0.5 * pour->pitch - cell_share * pour->radii[particle];
  scree_body body = scree_default_body();
  vec3 shift = vec3_scale(scree_rng_direction(rng), room > 0 ? room * scree_rng_uniform(rng) : 0);
  vec3_store(body.position, vec3_add(cell, shift));
  body.position[2] += bottom + 0.5 * pour->pitch;
  body.velocity[2] = -pour->options.entry_speed;
  quat q = scree_rng_rotation(rng);
  body.orientation[0] = q.w, body.orientation[1] = q.x;
  body.orientation[2] = q.y, body.orientation[3] = q.z;
  return body;
}

static double top_of(const scree_pour *pour) {
  double top = 0;
  for (size_t i = 0; i < pour->entered_count; i++) {
    if (scree_world_body_removed(pour->world, i)) continue;
    scree_body body;
    scree_world_get_body(pour->world, i, &body);
    top = fmax(top, body.position[2] + pour->radii[i]);
  }
  return top;
}

static void shuffle_cells(scree_pour *pour, scree_rng *rng) {
  for (size_t i = 0; i < pour->cell_count; i++) pour->cell_order[i] = (uint32_t)i;
  scree_rng_shuffle(rng, pour->cell_order, pour->cell_count, sizeof *pour->cell_order);
}

static scree_status enter_layer(scree_pour *pour, scree_error *error) {
  scree_rng rng = {.seed = pour->options.seed, .stream = LAYER_STREAM + pour->layer_count};
  double above = (cell_share - 1) * pour->pitch,
         bottom = fmax(pour->options.drop_height, top_of(pour) + above);
  shuffle_cells(pour, &rng);
  for (size_t k = 0; k < pour->cell_count && pour->entered_count < pour->count; k++) {
    size_t i = pour->entered_count;
    scree_body body = place(pour, i, pour->cells[pour->cell_order[k]], bottom, &rng);
    scree_status status = scree_world_add_body(pour->world, pour->particles[pour->shape_of[i]], 0,
                                               &body, NULL, error);
    if (status != SCREE_OK) return status;
    double v = pour->options.entry_speed, g = -pour->options.world.gravity[2];
    pour->entered_energy +=
        scree_world_body_mass(pour->world, i) * (0.5 * v * v + g * body.position[2]);
    pour->entered_count++;
  }
  pour->layer_count++;
  return SCREE_OK;
}

/* ---- the world ---- */

static scree_status add_walls(const scree_pour *pour, scree_world *world, scree_error *error) {
  const scree_pour_options *o = &pour->options;
  scree_wall walls[5] = {{.kind = SCREE_WALL_PLANE, .material = 1, .axis = {0, 0, 1}}};
  size_t count = 1;
  if (o->container == SCREE_CONTAINER_CYLINDER)
    walls[count++] = (scree_wall){
        .kind = SCREE_WALL_CYLINDER, .material = 1, .axis = {0, 0, 1}, .radius = 0.5 * o->width};
  else
    for (int side = 0; side < 4; side++) {
      double sign = side & 1 ? 1 : -1, away = sign * 0.5 * (side < 2 ? o->width : o->depth);
      scree_wall wall = {.kind = SCREE_WALL_PLANE, .material = 1};
      wall.position[side / 2] = away;
      wall.axis[side / 2] = -sign;
      walls[count++] = wall;
    }
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < count && status == SCREE_OK; i++)
    status = scree_world_add_wall(world, &walls[i], NULL, error);
  return status;
}

static scree_status make_empty_world(const scree_pour *pour, const scree_world_options *options,
                                     scree_world **world, scree_error *error) {
  scree_world *made;
  scree_status status = scree_world_create(options, &made, error);
  if (status != SCREE_OK) return status;
  status = scree_world_add_material(made, &pour->options.particles, NULL, error);
  if (status == SCREE_OK)
    status = scree_world_add_material(made, &pour->options.walls, NULL, error);
  if (status == SCREE_OK)
    status = scree_world_set_contact(
        made, 0, 1, fmin(pour->options.particles.restitution, pour->options.walls.restitution),
        pour->options.walls.friction, error);
  if (status == SCREE_OK) status = add_walls(pour, made, error);
  if (status == SCREE_OK)
    *world = made;
  else
    scree_world_free(made);
  return status;
}

scree_status scree_pour_make_gallery(const scree_pour *pour, scree_world **gallery,
                                     scree_error *error) {
  scree_world *made;
  scree_status status = make_empty_world(pour, &pour->options.world, &made, error);
  if (status != SCREE_OK) return status;
  for (size_t s = 0; s < pour->shape_count && status == SCREE_OK; s++)
    status = scree_world_add_body(made, pour->particles[s], 0, NULL, NULL, error);
  if (status == SCREE_OK)
    *gallery = made;
  else
    scree_world_free(made);
  return status;
}

/* One time step for the whole pour, whatever order the shapes enter in: that of a world which has
 * one of each. */
static scree_status make_world(scree_pour *pour, scree_error *error) {
  scree_world_options o = pour->options.world;
  scree_world *gallery;
  scree_status status = scree_pour_make_gallery(pour, &gallery, error);
  if (status != SCREE_OK) return status;
  o.time_step = pour->time_step = scree_world_time_step(gallery, NULL);
  scree_world_free(gallery);
  return make_empty_world(pour, &o, &pour->world, error);
}

static void plan(scree_pour *pour) {
  double g = -pour->options.world.gravity[2], v = pour->options.entry_speed,
         fall = layer_spacing * pour->pitch, time = (sqrt(v * v + 2 * g * fall) - v) / g;
  pour->layer_steps = (uint64_t)ceil(time / pour->time_step);
  size_t cells = pour->cell_count > 0 ? pour->cell_count : 1;
  pour->layers = (pour->count + cells - 1) / cells;
}

static scree_status copy_texts(scree_pour *pour, const scree_pour_shape *shapes,
                               scree_error *error) {
  pour->texts = scree_alloc_zero(2 * pour->shape_count, sizeof *pour->texts);
  if (!pour->texts)
    return scree_fail_memory(error, 2 * pour->shape_count * sizeof *pour->texts,
                             "the shapes' names");
  for (size_t i = 0; i < 2 * pour->shape_count; i++) {
    const char *text = i % 2 ? shapes[i / 2].source : shapes[i / 2].name;
    if (!text) continue;
    pour->texts[i] = scree_strdup(text);
    if (!pour->texts[i]) return scree_fail_memory(error, 0, "a shape's name");
  }
  return SCREE_OK;
}

static scree_status allocate(scree_pour *pour, const scree_pour_shape *shapes, scree_error *error) {
  for (size_t s = 0; s < pour->shape_count; s++) pour->count += shapes[s].count;
  SCREE_ALLOC_OR(pour->shape_of, pour->count, error, out_of_memory);
  SCREE_ALLOC_OR(pour->radii, pour->count, error, out_of_memory);
  SCREE_ALLOC_OR(pour->counts, pour->shape_count, error, out_of_memory);
  SCREE_ALLOC_OR(pour->particles, pour->shape_count, error, out_of_memory);
  for (size_t s = 0; s < pour->shape_count; s++) {
    pour->counts[s] = shapes[s].count;
    pour->particles[s] = shapes[s].particle;
    scree_particle_retain(shapes[s].particle);
  }
  return copy_texts(pour, shapes, error);
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

scree_status scree_pour_create(const scree_pour_shape *shapes, size_t shape_count,
                               const scree_pour_options *options, scree_pour **pour,
                               scree_error *error) {
  scree_pour_options o = options ? *options : scree_default_pour_options();
  scree_status status = check(shapes, shape_count, &o, error);
  if (status != SCREE_OK) return status;
  scree_pour *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "a pour");
  made->options = o;
  made->shape_count = shape_count;
  status = allocate(made, shapes, error);
  if (status == SCREE_OK) {
    mix_shapes(made, shapes);
    measure(made);
    status = make_cells(made, error);
  }
  if (status == SCREE_OK) status = make_world(made, error);
  if (status != SCREE_OK) {
    scree_pour_free(made);
    return status;
  }
  plan(made);
  *pour = made;
  return SCREE_OK;
}

void scree_pour_free(scree_pour *pour) {
  if (!pour) return;
  scree_world_free(pour->world);
  scree_motion_close(&pour->motion);
  for (size_t s = 0; pour->particles && s < pour->shape_count; s++)
    scree_particle_free(pour->particles[s]);
  scree_free(pour->particles);
  for (size_t i = 0; pour->texts && i < 2 * pour->shape_count; i++) scree_free(pour->texts[i]);
  scree_free(pour->texts);
  scree_free(pour->counts);
  scree_free(pour->notes);
  scree_free(pour->shape_of);
  scree_free(pour->radii);
  scree_free(pour->cells);
  scree_free(pour->cell_order);
  scree_free(pour);
}

/* ---- going on ---- */

/* Steps until a moment is recorded: it falls on the first step at or past its time, however a pour
 * is cut into calls. */
static size_t steps_to_moment(const scree_pour *pour) {
  double left =
      (scree_motion_next(&pour->motion) - scree_world_time(pour->world)) / pour->time_step;
  return left < 1e9 ? (size_t)fmax(1, floor(left) - 1) : SIZE_MAX;
}

scree_status scree_pour_advance(scree_pour *pour, size_t step_count, scree_error *error) {
  while (step_count > 0) {
    scree_status status = SCREE_OK;
    uint64_t now = scree_world_step_count(pour->world), due = pour->layer_count * pour->layer_steps;
    bool filling = pour->entered_count < pour->count;
    if (filling && now >= due) {
      status = enter_layer(pour, error);
      if (status != SCREE_OK) return status;
      continue;
    }
    if (scree_world_time(pour->world) >= scree_motion_next(&pour->motion))
      status = scree_motion_put(&pour->motion, pour->world, 0, error);
    if (status != SCREE_OK) return status;
    size_t steps = filling && due - now < step_count ? (size_t)(due - now) : step_count,
           moment = steps_to_moment(pour);
    if (moment < steps) steps = moment;
    status = scree_world_step(pour->world, steps, error);
    if (status != SCREE_OK) return status;
    step_count -= steps;
  }
  return SCREE_OK;
}

scree_status scree_pour_record(scree_pour *pour, const char *path, double interval,
                               scree_error *error) {
  if (!(interval > 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "pour: recording every %g s; must be above 0",
                      interval);
  scree_motion_close(&pour->motion);
  double time = scree_world_time(pour->world);
  return scree_motion_open(&pour->motion, path, interval, time > 0, time, error);
}

scree_status scree_pour_record_end(scree_pour *pour, scree_error *error) {
  return scree_motion_put(&pour->motion, pour->world, 0, error);
}

scree_world *scree_pour_world(scree_pour *pour) {
  return pour->world;
}
const scree_world *scree_pour_view(const scree_pour *pour) {
  return pour->world;
}
void scree_pour_get_options(const scree_pour *pour, scree_pour_options *options) {
  *options = pour->options;
}
size_t scree_pour_particle_count(const scree_pour *pour) {
  return pour->count;
}
size_t scree_pour_entered_count(const scree_pour *pour) {
  return pour->entered_count;
}
size_t scree_pour_shape_count(const scree_pour *pour) {
  return pour->shape_count;
}
scree_pour_shape scree_pour_get_shape(const scree_pour *pour, size_t index) {
  return (scree_pour_shape){pour->particles[index], pour->counts[index], pour->texts[2 * index],
                            pour->texts[2 * index + 1]};
}
size_t scree_pour_shape_of(const scree_pour *pour, size_t index) {
  return pour->shape_of[index];
}
double scree_pour_filling_time(const scree_pour *pour) {
  return (double)((pour->layers - 1) * pour->layer_steps) * pour->time_step;
}
double scree_pour_entered_energy(const scree_pour *pour) {
  return pour->entered_energy;
}

/* ---- the caller's notes ---- */

scree_status scree_pour_set_notes(scree_pour *pour, const double *notes, size_t count,
                                  scree_error *error) {
  double *copy;
  SCREE_ALLOC_OR(copy, count, error, out_of_memory);
  if (count) memcpy(copy, notes, count * sizeof *copy);
  scree_free(pour->notes);
  pour->notes = copy;
  pour->note_count = count;
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

const double *scree_pour_notes(const scree_pour *pour, size_t *count) {
  *count = pour->note_count;
  return pour->notes;
}
