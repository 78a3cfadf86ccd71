/* A world as a folder that other programs read: pile.json, bodies.csv, a mesh per shape and per
 * mesh wall. */
#include "base/file.h"
#include "report/csv.h"
#include "report/particle_export.h"
#include "report/shapes.h"

#include <string.h>

enum { PATH_BYTES = 4096 };

typedef struct exporter {
  const scree_world *world;
  const scree_export_options *options;
  const char *folder;
  const scree_shapes *shapes;
} exporter;

static scree_status join(const exporter *e, const char *name, char path[PATH_BYTES],
                         scree_error *error) {
  int length = snprintf(path, PATH_BYTES, "%s/%s", e->folder, name);
  if (length < PATH_BYTES) return SCREE_OK;
  return scree_fail(error, SCREE_LIMIT, "%.200s...: the path is longer than %d bytes", e->folder,
                    PATH_BYTES - 1);
}

static bool has_mesh(const scree_particle *particle) {
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  return m.kind == SCREE_PARTICLE_MESH;
}

static void shape_name(size_t index, char name[64]) {
  snprintf(name, 64, "shape-%zu.stl", index);
}

static void wall_name(size_t index, char name[64]) {
  snprintf(name, 64, "wall-%zu.stl", index);
}

static void json_spheres(scree_json *json, const scree_particle *particle, size_t count) {
  SCREE_JSON_LIST (json, "spheres", k, count) {
    double centre[3], radius;
    scree_particle_point(particle, k, centre, &radius);
    scree_json_row_object(json, NULL);
    scree_json_numbers(json, "centre", centre, 3);
    scree_json_number(json, "radius", radius);
    scree_json_end(json);
  }
}

static void json_shape(scree_json *json, const exporter *e, size_t index) {
  static const char *const kinds[] = {"mesh", "sphere", "clump"};
  const scree_particle *particle = e->shapes->particles[index];
  scree_particle_measures m;
  char name[64];
  scree_particle_measure(particle, &m);
  bool mesh = m.kind == SCREE_PARTICLE_MESH;
  shape_name(index, name);
  scree_json_object(json, NULL);
  scree_json_count(json, "shape", index);
  scree_json_text(json, "kind", kinds[m.kind]);
  scree_json_text(json, "mesh_file", mesh ? name : NULL);
  SCREE_JSON_MEMBERS(json, &m, triangle_count, volume);
  scree_json_numbers(json, "inertia_per_density", m.inertia, 3);
  SCREE_JSON_MEMBERS(json, &m, size, bounding_radius);
  json_spheres(json, particle, mesh ? 0 : m.point_count);
  scree_json_end(json);
}

static void json_body(scree_json *json, const exporter *e, size_t index) {
  scree_body b;
  scree_world_get_body(e->world, index, &b);
  scree_json_row_object(json, NULL);
  scree_json_count(json, "body", index);
  scree_json_count(json, "shape", e->shapes->of_body[index]);
  scree_json_count(json, "material", scree_world_body_material(e->world, index));
  scree_json_number(json, "mass", scree_world_body_mass(e->world, index));
  scree_json_numbers(json, "position", b.position, 3);
  scree_json_numbers(json, "orientation", b.orientation, 4);
  scree_json_numbers(json, "velocity", b.velocity, 3);
  scree_json_numbers(json, "angular_velocity", b.angular_velocity, 3);
  scree_json_end(json);
}

static void json_wall(scree_json *json, const exporter *e, size_t index) {
  static const char *const kinds[] = {"plane", "disc", "cylinder", "mesh"};
  scree_wall wall;
  double orientation[4];
  char name[64];
  scree_world_get_wall(e->world, index, &wall);
  scree_world_wall_orientation(e->world, index, orientation);
  wall_name(index, name);
  scree_json_row_object(json, NULL);
  scree_json_count(json, "wall", index);
  scree_json_text(json, "kind", kinds[wall.kind]);
  scree_json_text(json, "mesh_file", wall.kind == SCREE_WALL_MESH ? name : NULL);
  scree_json_count(json, "material", wall.material);
  scree_json_numbers(json, "position", wall.position, 3);
  scree_json_numbers(json, "orientation", orientation, 4);
  scree_json_numbers(json, "axis", wall.axis, 3);
  SCREE_JSON_MEMBERS(json, &wall, radius, length);
  scree_json_numbers(json, "velocity", wall.velocity, 3);
  scree_json_numbers(json, "angular_velocity", wall.angular_velocity, 3);
  scree_json_end(json);
}

static void print_json(const exporter *e, FILE *stream) {
  scree_world_options world;
  scree_world_get_options(e->world, &world);
  scree_json json = scree_json_start(stream);
  scree_json_object(&json, NULL);
  scree_json_number(&json, "time", scree_world_time(e->world));
  scree_json_numbers(&json, "gravity", world.gravity, 3);
  scree_json_number(&json, "unit_m", e->options->unit_m);
  SCREE_JSON_LIST (&json, "shapes", i, e->shapes->count) json_shape(&json, e, i);
  SCREE_JSON_LIST (&json, "bodies", i, scree_world_body_count(e->world))
    if (!scree_world_body_removed(e->world, i)) json_body(&json, e, i);
  SCREE_JSON_LIST (&json, "walls", i, scree_world_wall_count(e->world)) json_wall(&json, e, i);
  scree_export_json_provenance(&json, e->options);
  scree_json_end(&json);
}

static void print_csv(const exporter *e, FILE *stream) {
  fputs("body,shape,material,mass,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n", stream);
  for (size_t i = 0; i < scree_world_body_count(e->world); i++) {
    scree_body b;
    if (scree_world_body_removed(e->world, i)) continue;
    scree_world_get_body(e->world, i, &b);
    double values[14] = {scree_world_body_mass(e->world, i)};
    memcpy(values + 1, b.position, sizeof b.position);
    memcpy(values + 4, b.orientation, sizeof b.orientation);
    memcpy(values + 8, b.velocity, sizeof b.velocity);
    memcpy(values + 11, b.angular_velocity, sizeof b.angular_velocity);
    fprintf(stream, "%zu,%zu,%zu", i, e->shapes->of_body[i],
            scree_world_body_material(e->world, i));
    scree_csv_numbers(stream, values, 14);
    putc('\n', stream);
  }
}

static scree_status write_text(const exporter *e, const char *name,
                               void (*print)(const exporter *, FILE *), scree_error *error) {
  char path[PATH_BYTES];
  scree_output output;
  SCREE_TRY(join(e, name, path, error));
  SCREE_TRY(scree_output_open(path, e->options->overwrite, &output, error));
  print(e, output.stream);
  return scree_output_commit(&output, error);
}

static scree_status write_mesh(const exporter *e, const scree_mesh *mesh, const char *name,
                               scree_error *error) {
  char path[PATH_BYTES];
  scree_write_options write = scree_default_write_options();
  write.unit_m = e->options->unit_m;
  write.overwrite = e->options->overwrite;
  write.comment = e->options->command_line;
  SCREE_TRY(join(e, name, path, error));
  return scree_mesh_write(mesh, path, &write, error);
}

static scree_status write_meshes(const exporter *e, scree_error *error) {
  char name[64];
  for (size_t i = 0; i < e->shapes->count; i++) {
    shape_name(i, name);
    if (has_mesh(e->shapes->particles[i]))
      SCREE_TRY(write_mesh(e, scree_particle_mesh(e->shapes->particles[i]), name, error));
  }
  for (size_t i = 0; i < scree_world_wall_count(e->world); i++) {
    scree_wall wall;
    scree_world_get_wall(e->world, i, &wall);
    wall_name(i, name);
    if (wall.kind == SCREE_WALL_MESH) SCREE_TRY(write_mesh(e, wall.mesh, name, error));
  }
  return SCREE_OK;
}

scree_status scree_world_export(const scree_world *world, const scree_export_options *options,
                                const char *folder, scree_error *error) {
  scree_export_options used = options ? *options : scree_default_export_options();
  exporter e = {.world = world, .options = &used, .folder = folder};
  SCREE_CLEANUP(scree_shapes_free) scree_shapes shapes = {0};
  char path[PATH_BYTES];
  SCREE_TRY(scree_export_check(&used, error));
  SCREE_TRY(join(&e, "pile.json", path, error));
  SCREE_TRY(scree_folder_create(folder, error));
  SCREE_TRY(scree_output_check(path, used.overwrite, error));
  SCREE_TRY(scree_shapes_find(world, &shapes, error));
  e.shapes = &shapes;
  SCREE_TRY(write_meshes(&e, error));
  SCREE_TRY(write_text(&e, "bodies.csv", print_csv, error));
  return write_text(&e, "pile.json", print_json, error);
}
