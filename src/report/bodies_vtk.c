/* Bodies of a scene as instances: a point with pose, motion, force and stress for each, 97 bytes,
 * and each shape once, for glyphs. */
#include "base/alloc.h"
#include "base/vec.h"
#include "report/program.h"
#include "report/shapes.h"

#include <math.h>
#include <string.h>

enum { ARRAYS = 8, SPHERE_LEVEL = 2 };

typedef struct instances {
  const scree_world *world;
  size_t count;
  size_t *place; /* of each body of the world among the points; SIZE_MAX: it was removed */
  float *points, *orientation, *velocity, *spin, *force, *stress, *size;
  int32_t *body;
  uint8_t *shape;
} instances;

static void free_instances(instances *s) {
  void *const arrays[] = {s->place, s->points, s->orientation, s->velocity, s->spin,
                          s->force, s->stress, s->size,        s->body,     s->shape};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) scree_free(arrays[i]);
}

static bool make_room(instances *s, size_t bodies) {
  const struct {
    float **items;
    size_t components;
  } floats[] = {{&s->points, 3}, {&s->orientation, 4}, {&s->velocity, 3}, {&s->spin, 3},
                {&s->force, 3},  {&s->stress, 6},      {&s->size, 1}};
  s->place = scree_alloc(bodies, sizeof *s->place);
  s->body = scree_alloc(s->count, sizeof *s->body);
  s->shape = scree_alloc(s->count, sizeof *s->shape);
  bool good = s->place && s->body && s->shape;
  for (size_t i = 0; i < sizeof floats / sizeof *floats; i++) {
    *floats[i].items = scree_alloc_zero(s->count, floats[i].components * sizeof(float));
    good = good && *floats[i].items;
  }
  return good;
}

static void put(float *to, const double *from, size_t count) {
  for (size_t k = 0; k < count; k++) to[k] = (float)from[k];
}

static void fill(instances *s, const scree_scene *scene) {
  size_t at = 0, bodies = scree_world_body_count(s->world);
  for (size_t b = 0; b < bodies; b++) {
    scree_body state;
    scree_particle_measures m;
    s->place[b] = SIZE_MAX;
    if (scree_world_body_removed(s->world, b)) continue;
    scree_world_get_body(s->world, b, &state);
    scree_particle_measure(scree_world_body_particle(s->world, b), &m);
    put(s->points + 3 * at, state.position, 3);
    put(s->orientation + 4 * at, state.orientation, 4);
    put(s->velocity + 3 * at, state.velocity, 3);
    put(s->spin + 3 * at, state.angular_velocity, 3);
    s->size[at] = (float)m.size;
    s->body[at] = (int32_t)b;
    s->shape[at] = (uint8_t)scree_scene_body_shape(scene, b);
    s->place[b] = at++;
  }
}

/* The force, and its part of the mean stress in the body, -r F/V, pressure positive; as VTK orders
 * a symmetric tensor: xx, yy, zz, xy, yz, xz. */
static void feel(instances *s, size_t body, const double at[3], const double force[3],
                 double sign) {
  static const int first[6] = {0, 1, 2, 0, 1, 0}, second[6] = {0, 1, 2, 1, 2, 2};
  size_t i = s->place[body];
  scree_body state;
  scree_particle_measures m;
  scree_world_get_body(s->world, body, &state);
  scree_particle_measure(scree_world_body_particle(s->world, body), &m);
  double arm[3];
  for (int k = 0; k < 3; k++) arm[k] = at[k] - state.position[k];
  for (int k = 0; k < 3; k++) s->force[3 * i + (size_t)k] += (float)(sign * force[k]);
  for (size_t k = 0; k < 6; k++) {
    int p = first[k], q = second[k];
    double part = 0.5 * (arm[p] * force[q] + arm[q] * force[p]);
    s->stress[6 * i + k] -= (float)(sign * part / m.volume);
  }
}

static bool feel_contact(void *context, const scree_contact *c) {
  instances *s = context;
  feel(s, c->body, c->position, c->force, 1);
  if (c->wall) return true;
  /* In a periodic domain the other body is told elsewhere than where they touch. */
  double at[3];
  scree_body other;
  scree_world_options o;
  scree_world_get_options(s->world, &o);
  scree_world_get_body(s->world, c->other, &other);
  for (int k = 0; k < 3; k++) {
    double away = c->position[k] - other.position[k], period = o.period[k];
    at[k] = c->position[k] - (period > 0 ? period * floor(away / period + 0.5) : 0);
  }
  feel(s, c->other, at, c->force, -1);
  return true;
}

static size_t live_count(const scree_world *world) {
  size_t count = 0;
  for (size_t i = 0; i < scree_world_body_count(world); i++)
    count += !scree_world_body_removed(world, i);
  return count;
}

static scree_status write(const instances *s, const char *path, bool overwrite,
                          scree_error *error) {
  const scree_vtk_array arrays[ARRAYS] = {
      {"orientation", SCREE_VTK_FLOAT32, 4, s->orientation},
      {"velocity [m/s]", SCREE_VTK_FLOAT32, 3, s->velocity},
      {"angular velocity [rad/s]", SCREE_VTK_FLOAT32, 3, s->spin},
      {"contact force [N]", SCREE_VTK_FLOAT32, 3, s->force},
      {"stress [Pa]", SCREE_VTK_FLOAT32, 6, s->stress},
      {"size [m]", SCREE_VTK_FLOAT32, 1, s->size},
      {"body", SCREE_VTK_INT32, 1, s->body},
      {"shape", SCREE_VTK_UINT8, 1, s->shape},
  };
  const scree_vtk_data data = {.points_single = s->points,
                               .point_count = s->count,
                               .bare = true,
                               .point_arrays = arrays,
                               .point_array_count = ARRAYS,
                               .time = scree_world_time(s->world)};
  return scree_vtp_write(&data, path, overwrite, error);
}

scree_status scree_scene_bodies_vtp_write(const scree_scene *scene, const char *path,
                                          bool overwrite, scree_error *error) {
  const scree_world *world = scree_scene_view(scene);
  instances s = {.world = world, .count = live_count(world)};
  size_t shapes = 0;
  while (scree_scene_shape_name(scene, shapes)) shapes++;
  if (shapes > 256)
    return scree_fail(error, SCREE_LIMIT, "%s: %zu shapes; a frame of instances has at most 256",
                      path, shapes);
  scree_status status = make_room(&s, scree_world_body_count(world))
                            ? SCREE_OK
                            : scree_fail_memory(error, 97 * s.count, "a frame's bodies");
  if (status == SCREE_OK) {
    fill(&s, scene);
    status = scree_world_visit_contacts(world, feel_contact, &s, error);
  }
  if (status == SCREE_OK) status = write(&s, path, overwrite, error);
  free_instances(&s);
  return status;
}

scree_status scree_scene_shape_vtp_write(const scree_scene *scene, size_t shape, const char *path,
                                         bool overwrite, scree_error *error) {
  const scree_particle *particle = scree_scene_shape_particle(scene, shape);
  const scree_mesh *mesh = scree_particle_mesh(particle);
  scree_mesh spheres = {0};
  scree_status status = SCREE_OK;
  if (mesh->triangle_count == 0) {
    status = scree_spheres_mesh(particle, SPHERE_LEVEL, &spheres, error);
    mesh = &spheres;
  }
  const scree_vtk_data data = {.points = mesh->positions,
                               .point_count = mesh->vertex_count,
                               .triangles = mesh->triangles,
                               .cell_count = mesh->triangle_count,
                               .time = (double)NAN};
  if (status == SCREE_OK) status = scree_vtp_write(&data, path, overwrite, error);
  scree_mesh_free(&spheres);
  return status;
}
