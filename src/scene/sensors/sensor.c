/* What kinds of sensors ask for. */
#include "scene/sensors/sensor.h"

#include "base/array.h"

#include <string.h>

const scree_scene_sensor *scree_sensor_at(const scree_scene *scene, const scree_sensor_kind *kind,
                                          size_t index) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++)
    if (scene->sensors[i].kind == kind && index-- == 0) return &scene->sensors[i];
  return NULL;
}

void *scree_sensor_shared(const scree_scene *scene, const scree_sensor_kind *kind) {
  const scree_scene_sensor *first = scree_sensor_at(scene, kind, 0);
  return first ? first->shared : NULL;
}

scree_status scree_sensor_put_row(scree_sensor_rows *rows, const double *values,
                                  const char *const *texts, scree_error *error) {
  size_t needed = rows->values.count + rows->width;
  if (!SCREE_RESERVE(&rows->values, needed) || !SCREE_RESERVE(&rows->texts, needed))
    return scree_fail_memory(error, needed * sizeof *values, "a sensor's table");
  for (size_t k = 0; k < rows->width; k++) {
    rows->values.items[rows->values.count++] = values[k];
    rows->texts.items[rows->texts.count++] = texts ? texts[k] : NULL;
  }
  return SCREE_OK;
}

bool scree_sensor_is_on(const scree_scene *scene, const scree_scene_sensor *sensor) {
  double time = scree_world_time(scene->world);
  return time >= sensor->plan->from && !(time > sensor->plan->until);
}

/* What may stand in the name of a file as it is; all else becomes %XX. */
static void put_name(char *to, const char *name) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  for (; *name; name++) {
    bool good = strchr(plain, *name) != NULL;
    to += good ? (*to = *name, 1) : sprintf(to, "%%%02X", (unsigned)(unsigned char)*name);
  }
  *to = 0;
}

scree_status scree_sensor_open(const scree_sensor_folder *folder, const char *what,
                               scree_output *output, scree_error *error) {
  size_t size = strlen(folder->path) + 3 * strlen(folder->sensor) + strlen(what) + 16;
  SCREE_CLEANUP(scree_free_at) char *path = scree_alloc(size, 1);
  if (!path) return scree_fail_memory(error, size, "a path");
  char *at = path + snprintf(path, size, "%s/sensor-", folder->path);
  put_name(at, folder->sensor);
  snprintf(path + strlen(path), size - strlen(path), "-%s", what);
  return scree_output_open(path, true, output, error);
}

void scree_raise_body(const scree_scene *scene, size_t b, const scree_body *body, double floor_z,
                      scree_height_field *field) {
  scree_particle *particle = scree_world_body_particle(scene->world, b);
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  if (m.kind == SCREE_PARTICLE_MESH) {
    scree_height_field_add_mesh(field, scree_particle_mesh(particle), body->position,
                                body->orientation, floor_z);
    return;
  }
  mat3 turn = quat_to_mat3(scree_body_turn(body));
  for (size_t i = 0; i < m.point_count; i++) {
    double local[3], centre[3], radius;
    scree_particle_point(particle, i, local, &radius);
    vec3_store(centre, vec3_add(mat3_mul_vec(&turn, vec3_load(local)), vec3_load(body->position)));
    scree_height_field_add_sphere(field, centre, radius, floor_z);
  }
}

double scree_body_size(const scree_scene *scene, size_t b) {
  return 2 * cbrt(scene->shapes[scene->shape_of.items[b]].volume / 4.18879020478639);
}
