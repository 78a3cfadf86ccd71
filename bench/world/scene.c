/* Scenes. Bodies enter slowly under a tenth of gravity with a third of the stiffness, which takes
 * nearly two times longer steps; then they settle under full gravity, and last at full stiffness,
 * so that what is measured is the paper's contact. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double soft = 0.3;       /* stiffness while a scene is made */
static const double entry_speed = 3;  /* m/s, about */
static const double soft_time = 0.5;  /* s at rest, soft */
static const double hard_time = 0.15; /* s at rest, at full stiffness */
static const double gentle_time = 1;  /* s of copies sinking onto each other, g / 10 */
static const double stack_time = 1.2; /* s at rest after that */
static const double lift_speed = 0.1; /* m/s, the paper's */

/* How a world is to be made again. */
typedef struct remake {
  double stiffness_factor, time_step, gravity;
  size_t copies;
  double pitch; /* of the copies */
  bool shelves; /* each copy on a disc of its own, in an endless cylinder */
} remake;

static void advance(scree_world *world, double time) {
  scree_error error;
  double end = scree_world_time(world) + time;
  while (scree_world_time(world) < end) need(scree_world_step(world, 50, &error), &error);
}

static void turn(const double q[4], const double v[3], double result[3]) {
  double t[3] = {2 * (q[2] * v[2] - q[3] * v[1]), 2 * (q[3] * v[0] - q[1] * v[2]),
                 2 * (q[1] * v[1] - q[2] * v[0])};
  result[0] = v[0] + q[0] * t[0] + q[2] * t[2] - q[3] * t[1];
  result[1] = v[1] + q[0] * t[1] + q[3] * t[0] - q[1] * t[2];
  result[2] = v[2] + q[0] * t[2] + q[1] * t[1] - q[2] * t[0];
}

/* Materials: one of bodies, one of walls, as the paper has them. */
static scree_world *make_again(const scree_world *from, const remake *how) {
  scree_error error;
  scree_world_options options = scree_default_world_options();
  options.stiffness_factor = how->stiffness_factor;
  options.time_step = how->time_step;
  options.gravity[2] = -how->gravity;
  options.floor_height = -0.5;
  scree_world *world;
  need(scree_world_create(&options, &world, &error), &error);
  scree_material bodies = scree_default_material(), walls = scree_default_wall_material();
  need(scree_world_add_material(world, &bodies, NULL, &error), &error);
  need(scree_world_add_material(world, &walls, NULL, &error), &error);
  for (size_t w = 0; w < scree_world_wall_count(from); w++) {
    scree_wall wall;
    scree_world_get_wall(from, w, &wall);
    wall.material = 1;
    wall.velocity[2] = 0;
    if (how->shelves && wall.kind == SCREE_WALL_CYLINDER) wall.length = 0;
    size_t count = how->shelves && wall.kind == SCREE_WALL_DISC ? how->copies : 1;
    for (size_t c = 0; c < count; c++, wall.position[2] += how->pitch)
      need(scree_world_add_wall(world, &wall, NULL, &error), &error);
  }
  for (size_t c = 0; c < (how->copies ? how->copies : 1); c++)
    for (size_t i = 0; i < scree_world_body_count(from); i++) {
      scree_body state;
      if (scree_world_body_removed(from, i)) continue;
      scree_world_get_body(from, i, &state);
      scree_particle *particle = scree_world_body_particle(from, i);
      state.position[2] += (double)c * how->pitch;
      need(scree_world_add_body(world, particle, 0, &state, NULL, &error), &error);
    }
  return world;
}

/* Made again, run for some time, and once more into the next. */
static scree_world *stage(scree_world *from, remake how, double time) {
  scree_world *world = make_again(from, &how);
  scree_world_free(from);
  advance(world, time);
  return world;
}

/* To rest at full stiffness. */
static scree_world *settle(scree_world *world) {
  world = stage(world, (remake){.stiffness_factor = soft, .gravity = 9.81}, soft_time);
  return stage(world, (remake){.stiffness_factor = 1, .gravity = 9.81}, hard_time);
}

static void set(scree_scene_file *file, const char *field, double value) {
  scree_error error;
  char text[32];
  snprintf(text, sizeof text, "%.17g", value);
  need(scree_scene_file_set(file, field, text, &error), &error);
}

/* A scene refuses layers that would enter faster than 8 m/s: the shortest time it takes is
 * lengthened to our speed. */
static scree_scene *create_scene(scree_scene_file *file, scree_shape_store *store) {
  scree_error error;
  scree_scene *scene = NULL;
  double pack_time = 0.1;
  set(file, "phases.pack_time", pack_time);
  while (scree_scene_create_from(file, store, NULL, &scene, &error) == SCREE_BAD_ARGUMENT &&
         pack_time < 1e3)
    set(file, "phases.pack_time", pack_time *= 1.2);
  scree_scene_free(scene);
  set(file, "phases.pack_time", pack_time * 8 / entry_speed);
  need(scree_scene_create_from(file, store, NULL, &scene, &error), &error);
  return scene;
}

/* The template `repose`, filled with the shapes in equal shares. */
static scree_scene *fill(const shape_set *shapes, size_t count, uint64_t seed) {
  scree_error error;
  scree_scene_file *file;
  scree_shape_store *store;
  scree_poured poured[MOST_SHAPES];
  char names[MOST_SHAPES][16];
  need(scree_scene_file_template("repose", &file, &error), &error);
  need(scree_shape_store_create(&store, &error), &error);
  for (size_t i = 0; i < shapes->count; i++) {
    snprintf(names[i], sizeof names[i], "shape-%zu", i);
    poured[i] = (scree_poured){names[i], "file", names[i], 1};
    need(scree_shape_store_give(store, names[i], shapes->items[i], &error), &error);
  }
  need(scree_scene_file_pour(file, poured, shapes->count, &error), &error);
  set(file, "particles", (double)count);
  set(file, "seed", (double)seed);
  set(file, "contact.stiffness_factor", soft);
  set(file, "gravity", 0.981);
  set(file, "phases.settle_time", 0.2);
  scree_scene *scene = create_scene(file, store);
  scree_shape_store_free(store);
  scree_scene_file_free(file);
  return scene;
}

scree_world *fill_scene(const shape_set *shapes, size_t count, uint64_t seed) {
  scree_error error;
  scree_scene *scene = fill(shapes, count, seed);
  while (strcmp(scree_scene_phase(scene), "pack") == 0 ||
         strcmp(scree_scene_phase(scene), "settle") == 0)
    need(scree_scene_advance(scene, 1000, &error), &error);
  scree_world *world =
      make_again(scree_scene_view(scene), &(remake){.stiffness_factor = soft, .gravity = 9.81});
  scree_scene_free(scene);
  return settle(world);
}

static double height_of(const scree_world *world) {
  double top = 0;
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body state;
    scree_particle_measures m;
    scree_world_get_body(world, i, &state);
    scree_particle *particle = scree_world_body_particle(world, i);
    scree_particle_measure(particle, &m);
    for (size_t k = 0; k < m.point_count; k++) {
      double centre[3], radius, at[3];
      scree_particle_point(particle, k, centre, &radius);
      turn(state.orientation, centre, at);
      top = fmax(top, state.position[2] + at[2] + 2 * radius);
    }
  }
  return top;
}

/* Falls through the gaps between copies add up to the top: under full gravity they end at 2 m/s and
 * press thin walls too deep. */
scree_world *stack_scene(const scree_world *from, size_t copies) {
  remake how = {
      .stiffness_factor = 1, .gravity = 0.981, .copies = copies, .pitch = height_of(from)};
  scree_world *world = make_again(from, &how);
  advance(world, gentle_time);
  return stage(world, (remake){.stiffness_factor = 1, .gravity = 9.81}, stack_time);
}

scree_world *shelve_scene(const scree_world *from, size_t copies, double time) {
  remake how = {.stiffness_factor = 1,
                .gravity = 9.81,
                .copies = copies,
                .pitch = height_of(from),
                .shelves = true};
  scree_world *world = make_again(from, &how);
  advance(world, time);
  return world;
}

void lift_scene(scree_world *world, double height) {
  const double up[3] = {0, 0, lift_speed}, still[3] = {0, 0, 0};
  scree_error error;
  for (size_t w = 0; w < scree_world_wall_count(world); w++) {
    scree_wall wall;
    scree_world_get_wall(world, w, &wall);
    if (wall.kind == SCREE_WALL_CYLINDER)
      need(scree_world_set_wall_velocity(world, w, up, still, &error), &error);
  }
  advance(world, height / lift_speed);
}

scree_world *retime_scene(const scree_world *from, double time_step) {
  remake how = {.stiffness_factor = 1, .gravity = 9.81, .time_step = time_step};
  scree_world *world = make_again(from, &how);
  advance(world, hard_time);
  return world;
}
