/* Pouring as a scene: a floor and walls, and an inlet that fills in layers on a square grid. */
#include "pile/pour.h"

#include "base/alloc.h"
#include "base/math.h"

#include <string.h>

static const double cell_share = 1.02;     /* of the largest particle's diameter: the pitch */
static const double loose_packing = 0.3;   /* solid fraction behind the default width */
static const double particles_abreast = 3; /* in the default width */

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

/* The pitch of the grid and, where none is given, the width. */
static void measure(scree_pour *pour, const scree_pour_shape *shapes) {
  double largest = 0, solid = 0, count = 0;
  for (size_t s = 0; s < pour->shape_count; s++) {
    scree_particle_measures m;
    scree_particle_measure(shapes[s].particle, &m);
    if (shapes[s].count) largest = fmax(largest, m.bounding_radius);
    for (size_t i = 0; i < shapes[s].count; i++) solid += m.volume;
    count += (double)shapes[s].count;
  }
  pour->pitch = 2 * cell_share * largest;
  scree_pour_options *o = &pour->options;
  bool round = o->container == SCREE_CONTAINER_CYLINDER;
  if (!(o->width > 0)) {
    double abreast = fmin(particles_abreast, ceil(scree_cbrt(count)));
    o->width = fmax(scree_cbrt(solid / loose_packing * (round ? 4 / 3.14159265358979323846 : 1)),
                    (round ? abreast + 0.5 : abreast) * pour->pitch);
  }
  if (!(o->depth > 0) || round) o->depth = o->width;
}

/* ---- as a scene ---- */

static void put_world(const scree_pour *pour, FILE *out) {
  const scree_world_options *w = &pour->options.world;
  const scree_material *materials[] = {&pour->options.particles, &pour->options.walls};
  fprintf(out, "title: pour\ntime: 1e9\nseed: %llu\ngravity: [%.17g, %.17g, %.17g]\n",
          (unsigned long long)pour->options.seed, w->gravity[0], w->gravity[1], w->gravity[2]);
  fprintf(out,
          "contact: {law: %s, steps: %.17g, stiffness_factor: %.17g, tangential_ratio: %.17g, "
          "time_step: %.17g}\nmaterials:\n",
          w->law == SCREE_LAW_HYSTERETIC ? "hysteretic" : "linear", w->steps_per_contact,
          w->stiffness_factor, w->tangential_ratio, w->time_step);
  for (int i = 0; i < 2; i++) {
    const scree_material *m = materials[i];
    fprintf(out,
            "  %s: {young: %.17g, density: %.17g, restitution: %.17g, friction: %.17g, "
            "rolling_friction: %.17g, surface_energy: %.17g}\n",
            i ? "walls" : "particles", m->stiffness, m->density, m->restitution, m->friction,
            m->rolling_friction, m->surface_energy);
  }
  fprintf(out, "pairs: [{between: [particles, walls], friction: %.17g}]\n",
          pour->options.walls.friction);
}

static void put_container(const scree_pour *pour, FILE *out) {
  const scree_pour_options *o = &pour->options;
  double x = 0.5 * o->width, y = 0.5 * o->depth;
  fputs("geometry:\n  floor: {plane: [0, 0, 1], material: walls}\n", out);
  if (o->container == SCREE_CONTAINER_CYLINDER)
    fprintf(out, "  tube: {cylinder: {radius: %.17g}, material: walls}\n", x);
  else
    fprintf(out,
            "  left: {plane: [1, 0, 0], at: [%.17g, 0, 0], material: walls}\n"
            "  right: {plane: [-1, 0, 0], at: [%.17g, 0, 0], material: walls}\n"
            "  front: {plane: [0, 1, 0], at: [0, %.17g, 0], material: walls}\n"
            "  back: {plane: [0, -1, 0], at: [0, %.17g, 0], material: walls}\n",
            -x, x, -y, y);
}

static void put_inlet(const scree_pour *pour, FILE *out) {
  const scree_pour_options *o = &pour->options;
  double x = 0.5 * o->width, y = 0.5 * o->depth,
         bottom = fmax(o->drop_height, (cell_share - 1) * pour->pitch);
  size_t count = 0;
  fputs("inlets:\n  fill:\n", out);
  if (o->container == SCREE_CONTAINER_CYLINDER)
    fprintf(out, "    cylinder: {at: [0, 0, %.17g], radius: %.17g}\n", bottom, x);
  else
    fprintf(out, "    box: {min: [%.17g, %.17g, %.17g], max: [%.17g, %.17g, %.17g]}\n", -x, -y,
            bottom, x, y, bottom + pour->pitch);
  fputs("    shapes: {", out);
  for (size_t s = 0; s < pour->shape_count; s++) {
    if (pour->counts[s]) fprintf(out, "%sshape-%zu: %zu", count ? ", " : "", s, pour->counts[s]);
    count += pour->counts[s];
  }
  fprintf(out, "}\n    count: %zu\n    velocity: [0, 0, %.17g]\n    layers: {packed: grid}\n",
          count, -o->entry_speed);
}

static void put_schedule(const scree_pour_schedule *s, FILE *out) {
  fprintf(out, "stop: {filled: %.17g", s->time);
  if (s->still > 0) fprintf(out, ", still: %.17g, rest: %.17g", s->still, s->rest);
  fprintf(out, "}\noutput: {frames: %.17g, series: %.17g, checkpoint: %.17g}\n", s->frames,
          s->series, s->checkpoint);
}

static void put_scene(const void *context, FILE *out) {
  const scree_pour *pour = context;
  put_world(pour, out);
  fputs("shapes:\n", out);
  for (size_t s = 0; s < pour->shape_count; s++)
    fprintf(out, "  shape-%zu: {given: shape-%zu, material: particles}\n", s, s);
  put_container(pour, out);
  put_inlet(pour, out);
  put_schedule(&pour->schedule, out);
}

scree_status scree_pour_file(const scree_pour *pour, scree_scene_file **file, scree_error *error) {
  return scree_scene_file_make(put_scene, pour, file, error);
}

/* ---- creation ---- */

static scree_status copy_shapes(scree_pour *pour, const scree_pour_shape *shapes, size_t count,
                                scree_error *error) {
  pour->counts = scree_alloc_zero(count, sizeof *pour->counts);
  pour->names = scree_alloc_zero(count, sizeof *pour->names);
  if (!pour->counts || !pour->names) return scree_fail_memory(error, count, "a pour's shapes");
  pour->shape_count = count;
  for (size_t s = 0; s < count; s++) {
    pour->counts[s] = shapes[s].count;
    pour->names[s] = scree_strdup(shapes[s].name ? shapes[s].name : "");
    if (!pour->names[s]) return scree_fail_memory(error, 0, "a shape's name");
  }
  return SCREE_OK;
}

scree_status scree_pour_describe(const scree_pour_shape *shapes, size_t shape_count,
                                 const scree_pour_options *options, scree_pour **pour,
                                 scree_error *error) {
  scree_status status = check(shapes, shape_count, options, error);
  if (status != SCREE_OK) return status;
  scree_pour *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "a pour");
  made->options = *options;
  made->schedule = scree_endless_pour;
  status = copy_shapes(made, shapes, shape_count, error);
  if (status == SCREE_OK) {
    measure(made, shapes);
    *pour = made;
  } else {
    scree_pour_free(made);
  }
  return status;
}

scree_status scree_pour_make_scene(scree_pour *pour, const scree_pour_shape *shapes,
                                   scree_error *error) {
  scree_scene_file *file;
  unsigned char *notes = NULL;
  size_t note_bytes = 0;
  scree_status status = scree_pour_file(pour, &file, error);
  if (status != SCREE_OK) return status;
  status = scree_pour_pack_notes(pour, &notes, &note_bytes, error);
  scree_particle **particles = scree_alloc(pour->shape_count, sizeof *particles);
  const char **sources = scree_alloc(pour->shape_count, sizeof *sources);
  if (status == SCREE_OK && (!particles || !sources))
    status = scree_fail_memory(error, pour->shape_count, "a pour");
  for (size_t s = 0; status == SCREE_OK && s < pour->shape_count; s++) {
    particles[s] = shapes[s].particle;
    sources[s] = shapes[s].source;
  }
  const scree_scene_gift gift = {.seal = &scree_pour_seal,
                                 .particles = particles,
                                 .sources = sources,
                                 .options = &pour->options.world,
                                 .notes = notes,
                                 .note_bytes = note_bytes};
  if (status == SCREE_OK) status = scree_scene_make(file, &gift, NULL, &pour->scene, error);
  scree_free(particles);
  scree_free(sources);
  scree_free(notes);
  scree_scene_file_free(file);
  return status;
}

scree_status scree_pour_create(const scree_pour_shape *shapes, size_t shape_count,
                               const scree_pour_options *options, scree_pour **pour,
                               scree_error *error) {
  scree_pour_options o = options ? *options : scree_default_pour_options();
  scree_pour *made;
  scree_status status = scree_pour_describe(shapes, shape_count, &o, &made, error);
  if (status != SCREE_OK) return status;
  status = scree_pour_make_scene(made, shapes, error);
  if (status == SCREE_OK)
    *pour = made;
  else
    scree_pour_free(made);
  return status;
}

void scree_pour_free(scree_pour *pour) {
  if (!pour) return;
  scree_scene_free(pour->scene);
  scree_motion_close(&pour->motion);
  for (size_t s = 0; pour->names && s < pour->shape_count; s++) scree_free(pour->names[s]);
  scree_free(pour->names);
  scree_free(pour->counts);
  scree_free(pour);
}

/* ---- going on ---- */

/* Steps until a moment is recorded: it falls on the first step at or past its time, however a pour
 * is cut into calls. */
static size_t steps_to_moment(const scree_pour *pour) {
  double left = (scree_motion_next(&pour->motion) - scree_world_time(pour->scene->world)) /
                pour->scene->time_step;
  return left < 1e9 ? (size_t)fmax(1, floor(left) - 1) : SIZE_MAX;
}

scree_status scree_pour_advance(scree_pour *pour, size_t step_count, scree_error *error) {
  scree_status status = SCREE_OK;
  while (step_count > 0 && status == SCREE_OK) {
    status = scree_scene_decide(pour->scene, error); /* who enters now is in the moment */
    if (status == SCREE_OK &&
        scree_world_time(pour->scene->world) >= scree_motion_next(&pour->motion))
      status = scree_motion_put(&pour->motion, pour->scene->world, 0, error);
    if (status != SCREE_OK) return status;
    size_t moment = steps_to_moment(pour), steps = step_count < moment ? step_count : moment;
    status = scree_scene_advance(pour->scene, steps, error);
    step_count -= steps;
  }
  return status;
}

scree_status scree_pour_record(scree_pour *pour, const char *path, double interval,
                               scree_error *error) {
  if (!(interval > 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "pour: recording every %g s; must be above 0",
                      interval);
  scree_motion_close(&pour->motion);
  double time = scree_world_time(pour->scene->world);
  return scree_motion_open(&pour->motion, path, interval, time > 0, time, error);
}

scree_status scree_pour_record_end(scree_pour *pour, scree_error *error) {
  return scree_motion_put(&pour->motion, pour->scene->world, 0, error);
}

/* ---- looking ---- */

scree_world *scree_pour_world(scree_pour *pour) {
  return pour->scene->world;
}
const scree_world *scree_pour_view(const scree_pour *pour) {
  return pour->scene->world;
}
void scree_pour_get_options(const scree_pour *pour, scree_pour_options *options) {
  *options = pour->options;
}
size_t scree_pour_particle_count(const scree_pour *pour) {
  return pour->scene->inlets[0].plan->count;
}
size_t scree_pour_entered_count(const scree_pour *pour) {
  return pour->scene->inlets[0].entered;
}
size_t scree_pour_shape_count(const scree_pour *pour) {
  return pour->shape_count;
}
scree_pour_shape scree_pour_get_shape(const scree_pour *pour, size_t index) {
  const scree_scene_shape *s = &pour->scene->shapes[index];
  const char *name = pour->names[index];
  return (scree_pour_shape){s->particle, pour->counts[index], *name ? name : NULL,
                            *s->source ? s->source : NULL};
}
size_t scree_pour_shape_of(const scree_pour *pour, size_t index) {
  const scree_scene_inlet *inlet = &pour->scene->inlets[0];
  return inlet->shapes[inlet->layers.order[index]];
}
double scree_pour_filling_time(const scree_pour *pour) {
  return scree_scene_filling_time(pour->scene);
}
double scree_pour_entered_energy(const scree_pour *pour) {
  return pour->scene->entered_energy;
}
const scree_scene *scree_pour_scene(const scree_pour *pour) {
  return pour->scene;
}
