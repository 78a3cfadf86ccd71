/* What the page's tab of pouring asks of scree: shapes, then time. One pour in a module. */
#include "scree.h"

#include <emscripten.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_SHAPES = 16, POSE = 7 };

static scree_poured poured[MOST_SHAPES];
static char names[MOST_SHAPES][16], paths[MOST_SHAPES][256];
static double units[MOST_SHAPES];
static size_t shape_count, body_count;
static scree_scene *scene;
static double *poses; /* of each body: place, quaternion w x y z */
static scree_error error;

EMSCRIPTEN_KEEPALIVE const char *web_pour_error(void) {
  return error.message;
}

/* A closed mesh in a file, and how many of it. */
EMSCRIPTEN_KEEPALIVE int web_pour_add(const char *path, double unit_m, int count) {
  size_t k = shape_count;
  if (k == MOST_SHAPES) return SCREE_LIMIT;
  snprintf(names[k], sizeof names[k], "shape-%zu", k);
  snprintf(paths[k], sizeof paths[k], "%s", path);
  poured[k] = (scree_poured){names[k], "file", paths[k], count};
  units[k] = unit_m;
  body_count += (size_t)count;
  shape_count++;
  return SCREE_OK;
}

static scree_status set(scree_scene_file *file, const char *field, const char *format,
                        double value) {
  char text[40];
  snprintf(text, sizeof text, format, value);
  return scree_scene_file_set(file, field, text, &error);
}

static scree_status describe(scree_scene_file *file, double stiffness_factor, double friction) {
  scree_status status = scree_scene_file_pour(file, poured, shape_count, &error);
  for (size_t i = 0; status == SCREE_OK && i < shape_count; i++) {
    char field[64];
    snprintf(field, sizeof field, "shapes.%s.triangles", names[i]);
    status = scree_scene_file_set(file, field, "all", &error);
    snprintf(field, sizeof field, "shapes.%s.unit", names[i]);
    if (status == SCREE_OK)
      status = scree_scene_file_set(file, field, units[i] == 1 ? "m" : "mm", &error);
  }
  if (status == SCREE_OK) status = set(file, "particles", "%.0f", (double)body_count);
  if (status == SCREE_OK) status = set(file, "friction", "%.17g", friction);
  if (status == SCREE_OK) status = set(file, "contact.stiffness_factor", "%.17g", stiffness_factor);
  if (status == SCREE_OK) status = set(file, "time", "%.0f", 1e6); /* the page ends it */
  return status;
}

EMSCRIPTEN_KEEPALIVE int web_pour_start(double stiffness_factor, double friction, int in_box) {
  scree_scene_file *file;
  scree_status status = scree_scene_file_template(in_box ? "drop-box" : "drop", &file, &error);
  if (status != SCREE_OK) return status;
  status = describe(file, stiffness_factor, friction);
  if (status == SCREE_OK) status = scree_scene_create(file, NULL, &scene, &error);
  scree_scene_file_free(file);
  if (status != SCREE_OK) return status;
  poses = malloc((body_count + 1) * POSE * sizeof *poses);
  return poses ? SCREE_OK : SCREE_OUT_OF_MEMORY;
}

EMSCRIPTEN_KEEPALIVE int web_pour_advance(int steps) {
  return scree_scene_advance(scene, (size_t)steps, &error);
}
EMSCRIPTEN_KEEPALIVE double web_pour_time(void) {
  return scree_world_time(scree_scene_view(scene));
}
EMSCRIPTEN_KEEPALIVE double web_pour_step(void) {
  return scree_world_time_step(scree_scene_view(scene), NULL);
}
/* Inside: the diameter of the cylinder, or the distance of the box's sides from the middle, twice.
 */
EMSCRIPTEN_KEEPALIVE double web_pour_width(void) {
  const scree_world *world = scree_scene_view(scene);
  double width = 0;
  for (size_t w = 0; w < scree_world_wall_count(world); w++) {
    scree_wall wall;
    scree_world_get_wall(world, w, &wall);
    if (wall.kind == SCREE_WALL_CYLINDER) width = 2 * wall.radius;
    if (wall.kind == SCREE_WALL_PLANE) width = fmax(width, 2 * fabs(wall.position[0]));
  }
  return width;
}
/* J of motion, a particle. */
EMSCRIPTEN_KEEPALIVE double web_pour_energy(void) {
  scree_observation seen;
  scree_world_observe(scree_scene_view(scene), &seen);
  return seen.body_count ? (seen.kinetic + seen.rotational) / (double)seen.body_count : 0;
}

EMSCRIPTEN_KEEPALIVE int web_pour_count(void) {
  return (int)body_count;
}
/* A shape as it is drawn, in the frame of its body. */
EMSCRIPTEN_KEEPALIVE const scree_mesh *web_pour_mesh(int shape) {
  return scree_particle_mesh(scree_scene_shape_particle(scene, (size_t)shape));
}

/* How many bodies have entered; where they are is behind web_pour_poses then. */
EMSCRIPTEN_KEEPALIVE int web_pour_look(void) {
  const scree_world *world = scree_scene_view(scene);
  size_t count = scree_world_body_count(world);
  for (size_t i = 0; i < count; i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    for (size_t k = 0; k < 3; k++) poses[POSE * i + k] = body.position[k];
    for (size_t k = 0; k < 4; k++) poses[POSE * i + 3 + k] = body.orientation[k];
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
