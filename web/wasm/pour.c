/* What the page's tab of pouring asks of scree: a scene of a template, shapes, fields, then time.
 * One pour in a module. */
#include "scree.h"

#include "report/shapes.h"
#include "scene/file.h"

#include <emscripten.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_SHAPES = 16, POSE = 7 };

static scree_poured poured[MOST_SHAPES];
static char names[MOST_SHAPES][16], paths[MOST_SHAPES][256];
static double units[MOST_SHAPES];
static size_t shape_count, wall_count, pose_room;
static scree_scene_file *file;
static scree_scene *scene;
static scree_mesh drawn; /* the wall asked for last */
static double *poses;    /* of each wall, then of each body: place, quaternion w x y z */
static scree_error error;

EMSCRIPTEN_KEEPALIVE const char *web_pour_error(void) {
  return error.message;
}

/* A closed mesh in a file, and its share of the particles. */
EMSCRIPTEN_KEEPALIVE int web_pour_add(const char *path, double unit_m, int share) {
  size_t k = shape_count;
  if (k == MOST_SHAPES) return SCREE_LIMIT;
  snprintf(names[k], sizeof names[k], "shape-%zu", k);
  snprintf(paths[k], sizeof paths[k], "%s", path);
  poured[k] = (scree_poured){names[k], "file", paths[k], share};
  units[k] = unit_m;
  shape_count++;
  return SCREE_OK;
}

/* The scene of a template that pours these shapes. */
EMSCRIPTEN_KEEPALIVE int web_pour_begin(const char *template_name) {
  scree_status status = scree_scene_file_template(template_name, &file, &error);
  if (status == SCREE_OK) status = scree_scene_file_pour(file, poured, shape_count, &error);
  for (size_t i = 0; status == SCREE_OK && i < shape_count; i++) {
    char field[64];
    snprintf(field, sizeof field, "shapes.%s.triangles", names[i]);
    status = scree_scene_file_set(file, field, "all", &error);
    snprintf(field, sizeof field, "shapes.%s.unit", names[i]);
    if (status == SCREE_OK)
      status = scree_scene_file_set(file, field, units[i] == 1 ? "m" : "mm", &error);
  }
  return status;
}
/* m: the diameter of the largest shape; NaN: it cannot be made. */
EMSCRIPTEN_KEEPALIVE double web_pour_size(void) {
  scree_scene_extent extent;
  return scree_scene_file_extent(file, NULL, NULL, &extent, &error) == SCREE_OK ? extent.largest
                                                                                : (double)NAN;
}
EMSCRIPTEN_KEEPALIVE int web_pour_set(const char *field, const char *value) {
  return scree_scene_file_set(file, field, value, &error);
}

EMSCRIPTEN_KEEPALIVE int web_pour_start(void) {
  scree_status status = scree_scene_create(file, NULL, &scene, &error);
  if (status == SCREE_OK) wall_count = scree_world_wall_count(scree_scene_view(scene));
  return status;
}

EMSCRIPTEN_KEEPALIVE int web_pour_advance(int steps) {
  return scree_scene_advance(scene, (size_t)steps, &error);
}
/* Why it has ended; "": it has not. */
EMSCRIPTEN_KEEPALIVE const char *web_pour_end(void) {
  const char *end = scree_scene_end(scene);
  return end ? end : "";
}
EMSCRIPTEN_KEEPALIVE double web_pour_time(void) {
  return scree_world_time(scree_scene_view(scene));
}
EMSCRIPTEN_KEEPALIVE double web_pour_step(void) {
  return scree_world_time_step(scree_scene_view(scene), NULL);
}
/* J of motion, a particle. */
EMSCRIPTEN_KEEPALIVE double web_pour_energy(void) {
  scree_observation seen;
  scree_world_observe(scree_scene_view(scene), &seen);
  return seen.body_count ? (seen.kinetic + seen.rotational) / (double)seen.body_count : 0;
}
EMSCRIPTEN_KEEPALIVE int web_pour_left(void) {
  scree_scene_book book;
  scree_scene_get_book(scene, &book);
  return (int)book.left_count;
}

/* Of a container without an end: the diameter of the cylinder, or twice the distance of the box's
 * sides from the middle. */
EMSCRIPTEN_KEEPALIVE double web_pour_width(void) {
  double width = 0;
  for (size_t w = 0; w < wall_count; w++) {
    scree_wall wall;
    scree_world_get_wall(scree_scene_view(scene), w, &wall);
    if (wall.kind == SCREE_WALL_CYLINDER) width = 2 * wall.radius;
    if (wall.kind == SCREE_WALL_PLANE) width = fmax(width, 2 * fabs(wall.position[0]));
  }
  return width;
}
EMSCRIPTEN_KEEPALIVE int web_pour_walls(void) {
  return (int)wall_count;
}
/* A wall as it is drawn, in its own frame, until the next is asked for; NULL: no room. */
EMSCRIPTEN_KEEPALIVE const scree_mesh *web_pour_wall(int wall) {
  scree_mesh_free(&drawn);
  drawn = (scree_mesh){0};
  return scree_wall_mesh(scree_scene_view(scene), (size_t)wall, &drawn, &error) == SCREE_OK ? &drawn
                                                                                            : NULL;
}
/* Whether it has an end, so that all of it can be seen. */
EMSCRIPTEN_KEEPALIVE int web_pour_wall_is_endless(int index) {
  scree_wall wall;
  scree_world_get_wall(scree_scene_view(scene), (size_t)index, &wall);
  return wall.kind == SCREE_WALL_PLANE;
}
/* A shape as it is drawn, in the frame of its body. */
EMSCRIPTEN_KEEPALIVE const scree_mesh *web_pour_mesh(int shape) {
  return scree_particle_mesh(scree_scene_shape_particle(scene, (size_t)shape));
}

static void put_pose(double *pose, const double place[3], const double turn[4]) {
  for (size_t k = 0; k < 3; k++) pose[k] = place[k];
  for (size_t k = 0; k < 4; k++) pose[3 + k] = turn[k];
}

/* How many bodies have entered; where walls and bodies are is behind web_pour_poses then, NaN where
 * a body has gone. -1: no room. */
EMSCRIPTEN_KEEPALIVE int web_pour_look(void) {
  static const double gone[4] = {NAN, NAN, NAN, NAN};
  const scree_world *world = scree_scene_view(scene);
  size_t count = scree_world_body_count(world);
  if (pose_room < wall_count + count) {
    pose_room = 2 * (wall_count + count);
    free(poses);
    poses = malloc(pose_room * POSE * sizeof *poses);
    if (!poses) return pose_room = 0, -1;
  }
  for (size_t w = 0; w < wall_count; w++) {
    scree_wall wall;
    double turn[4];
    scree_world_get_wall(world, w, &wall);
    scree_world_wall_orientation(world, w, turn);
    put_pose(poses + POSE * w, wall.position, turn);
  }
  for (size_t i = 0; i < count; i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    bool there = !scree_world_body_removed(world, i);
    put_pose(poses + POSE * (wall_count + i), there ? body.position : gone,
             there ? body.orientation : gone);
  }
  return (int)count;
}
EMSCRIPTEN_KEEPALIVE const double *web_pour_poses(void) {
  return poses;
}
/* Which of the shapes a body is that has entered. */
EMSCRIPTEN_KEEPALIVE int web_pour_shape_of(int body) {
  return (int)scree_scene_body_shape(scene, (size_t)body);
}
