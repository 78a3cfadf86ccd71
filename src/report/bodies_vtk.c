/* Bodies of a scene as instances: a point with pose, motion, force and stress for each, 104 bytes,
 * and each shape once, for glyphs. */
#include "base/alloc.h"
#include "report/program.h"
#include "report/shapes.h"
#include "report/vtk.h"

#include <math.h>

enum { SPHERE_LEVEL = 2 };

typedef struct instance {
  float orientation[4], velocity[3], spin[3], force[3], stress[6], size;
  int32_t body, shape, fragment;
} instance;

static const scree_field members[] = {
    SCREE_FIELD_OF(instance, orientation),
    SCREE_FIELD_AS(instance, "velocity [m/s]", velocity),
    SCREE_FIELD_AS(instance, "angular velocity [rad/s]", spin),
    SCREE_FIELD_AS(instance, "contact force [N]", force),
    SCREE_FIELD_AS(instance, "stress [Pa]", stress),
    SCREE_FIELD_AS(instance, "size [m]", size),
    SCREE_FIELD_OF(instance, body),
    SCREE_FIELD_OF(instance, shape),
    SCREE_FIELD_OF(instance, fragment),
};

typedef struct instances {
  const scree_world *world;
  const size_t *fragment; /* of each body */
  size_t *place;          /* of each body of the world among the rows; SIZE_MAX: it was removed */
  float *points;
  instance *rows;
} instances;

static void put(float *to, const double *from, size_t count) {
  for (size_t k = 0; k < count; k++) to[k] = (float)from[k];
}

static void fill(const instances *s, const scree_scene *scene) {
  size_t at = 0;
  for (size_t b = 0; b < scree_world_body_count(s->world); b++) {
    scree_body state;
    scree_particle_measures m;
    instance *row = &s->rows[at];
    s->place[b] = SIZE_MAX;
    if (scree_world_body_removed(s->world, b)) continue;
    scree_world_get_body(s->world, b, &state);
    scree_particle_measure(scree_world_body_particle(s->world, b), &m);
    put(s->points + 3 * at, state.position, 3);
    put(row->orientation, state.orientation, 4);
    put(row->velocity, state.velocity, 3);
    put(row->spin, state.angular_velocity, 3);
    row->size = (float)m.size;
    row->body = (int32_t)b;
    row->shape = (int32_t)scree_scene_body_shape(scene, b);
    row->fragment = (int32_t)s->fragment[b];
    s->place[b] = at++;
  }
}

/* The force, and its part of the mean stress in the body, -r F/V, pressure positive; as VTK orders
 * a symmetric tensor: xx, yy, zz, xy, yz, xz. */
static void feel(const instances *s, size_t body, const double at[3], const double force[3],
                 double sign) {
  static const int first[6] = {0, 1, 2, 0, 1, 0}, second[6] = {0, 1, 2, 1, 2, 2};
  instance *row = &s->rows[s->place[body]];
  scree_body state;
  scree_particle_measures m;
  scree_world_get_body(s->world, body, &state);
  scree_particle_measure(scree_world_body_particle(s->world, body), &m);
  double arm[3];
  for (int k = 0; k < 3; k++) arm[k] = at[k] - state.position[k];
  for (int k = 0; k < 3; k++) row->force[k] += (float)(sign * force[k]);
  for (size_t k = 0; k < 6; k++) {
    int p = first[k], q = second[k];
    double part = 0.5 * (arm[p] * force[q] + arm[q] * force[p]);
    row->stress[k] -= (float)(sign * part / m.volume);
  }
}

static bool feel_contact(void *context, const scree_contact *c) {
  const instances *s = context;
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

scree_status scree_scene_bodies_vtp_write(const scree_scene *scene, const char *path,
                                          bool overwrite, scree_error *error) {
  const scree_world *world = scree_scene_view(scene);
  size_t count = scree_world_live_count(world);
  SCREE_SCRATCH(size_t, fragment, scree_world_body_count(world), error);
  SCREE_SCRATCH(size_t, place, scree_world_body_count(world), error);
  SCREE_SCRATCH(float, points, 3 * count, error);
  SCREE_SCRATCH_ZERO(instance, rows, count + 1, error); /* the last is of bodies that are gone */
  instances s = {world, fragment, place, points, rows};
  (void)scree_world_fragments(world, fragment);
  fill(&s, scene);
  SCREE_TRY(scree_world_visit_contacts(world, feel_contact, &s, error));
  const scree_vtk_rows table = SCREE_VTK_ROWS(rows, true, members);
  const scree_vtk_data data = {
      .points_single = points, .point_count = count, .bare = true, .time = scree_world_time(world)};
  return scree_vtp_write_rows(&data, &table, path, overwrite, error);
}

scree_status scree_scene_shape_vtp_write(const scree_scene *scene, size_t shape, const char *path,
                                         bool overwrite, scree_error *error) {
  const scree_particle *particle = scree_scene_shape_particle(scene, shape);
  const scree_mesh *mesh = scree_particle_mesh(particle);
  SCREE_CLEANUP(scree_mesh_free) scree_mesh spheres = {0};
  if (mesh->triangle_count == 0) {
    SCREE_TRY(scree_spheres_mesh(particle, SPHERE_LEVEL, &spheres, error));
    mesh = &spheres;
  }
  const scree_vtk_data data = {.points = mesh->positions,
                               .point_count = mesh->vertex_count,
                               .triangles = mesh->triangles,
                               .cell_count = mesh->triangle_count,
                               .time = (double)NAN};
  return scree_vtp_write(&data, path, overwrite, error);
}
