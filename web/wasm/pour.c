/* What the page's tab of pouring asks of scree: shapes, then time. One pour in a module. */
#include "scree.h"

#include <emscripten.h>
#include <stdlib.h>

enum { MOST_SHAPES = 16, POSE = 7 };

static scree_pour_shape shapes[MOST_SHAPES];
static size_t shape_count;
static scree_pour *pour;
static double *poses; /* of each body: place, quaternion w x y z */
static scree_error error;

EMSCRIPTEN_KEEPALIVE const char *web_pour_error(void) {
  return error.message;
}

/* A closed mesh in a file, and how many of it. */
EMSCRIPTEN_KEEPALIVE int web_pour_add(const char *path, double unit_m, int count) {
  scree_read_options read = scree_default_read_options();
  scree_scan scan;
  scree_particle *particle = NULL;
  read.unit_m = unit_m;
  scree_status status = scree_scan_read(path, &read, &scan, &error);
  if (status == SCREE_OK) {
    status = scree_particle_from_mesh(&scan.mesh, NULL, &particle, &error);
    scree_scan_free(&scan);
  }
  if (status == SCREE_OK && shape_count < MOST_SHAPES)
    shapes[shape_count++] = (scree_pour_shape){particle, (size_t)count, NULL, NULL};
  return status;
}

EMSCRIPTEN_KEEPALIVE int web_pour_start(double stiffness_factor, double friction, int in_box) {
  scree_pour_options options = scree_default_pour_options();
  options.world.stiffness_factor = stiffness_factor;
  options.particles.friction = friction;
  options.container = in_box ? SCREE_CONTAINER_BOX : SCREE_CONTAINER_CYLINDER;
  scree_status status = scree_pour_create(shapes, shape_count, &options, &pour, &error);
  if (status != SCREE_OK) return status;
  poses = malloc((scree_pour_particle_count(pour) + 1) * POSE * sizeof *poses);
  return poses ? SCREE_OK : SCREE_OUT_OF_MEMORY;
}

EMSCRIPTEN_KEEPALIVE int web_pour_advance(int steps) {
  return scree_pour_advance(pour, (size_t)steps, &error);
}
EMSCRIPTEN_KEEPALIVE double web_pour_time(void) {
  return scree_world_time(scree_pour_view(pour));
}
EMSCRIPTEN_KEEPALIVE double web_pour_step(void) {
  return scree_world_time_step(scree_pour_view(pour), NULL);
}
/* Inside: the diameter of the cylinder, or the side of the box. */
EMSCRIPTEN_KEEPALIVE double web_pour_width(void) {
  scree_pour_options options;
  scree_pour_get_options(pour, &options);
  return options.width;
}
/* J of motion, a particle. */
EMSCRIPTEN_KEEPALIVE double web_pour_energy(void) {
  scree_observation seen;
  scree_world_observe(scree_pour_world(pour), &seen);
  size_t count = scree_pour_entered_count(pour);
  return count ? (seen.kinetic + seen.rotational) / (double)count : 0;
}

/* The bodies in their order of entering, and which of the shapes each is. */
EMSCRIPTEN_KEEPALIVE int web_pour_count(void) {
  return (int)scree_pour_particle_count(pour);
}
EMSCRIPTEN_KEEPALIVE int web_pour_shape_of(int body) {
  return (int)scree_pour_shape_of(pour, (size_t)body);
}
/* A shape as it is drawn, in the frame of its body. */
EMSCRIPTEN_KEEPALIVE const scree_mesh *web_pour_mesh(int shape) {
  return scree_particle_mesh(shapes[shape].particle);
}

/* How many bodies have entered; where they are is behind web_pour_poses then. */
EMSCRIPTEN_KEEPALIVE int web_pour_look(void) {
  const scree_world *world = scree_pour_view(pour);
  size_t count = scree_pour_entered_count(pour);
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
