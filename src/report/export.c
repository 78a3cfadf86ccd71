/* A world as a folder that other programs read: pile.json, bodies.csv, a mesh per shape and per
 * mesh wall, and of what joints hold together. */
#include "base/alloc.h"
#include "base/file.h"
#include "base/vec.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/shapes.h"

#include <math.h>
#include <string.h>

/* A particle's mesh and mass properties for other DEM codes. The inertia is that of the mesh as it
 * lies in the file, times the density; docs/reference/formats.md lists the fields. */

scree_export_options scree_default_export_options(void) {
  return (scree_export_options){.density = 2000, .unit_m = 1e-3};
}

/* Density and unit in their ranges. */
static scree_status export_check(const scree_export_options *options, scree_error *error) {
  if (!(options->density > 0 && isfinite(options->density)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "export: density %g kg/m3 is not above 0",
                      options->density);
  if (!(options->unit_m >= 1e-12 && options->unit_m <= 1e12))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "export: unit of %g m is outside 1e-12 to 1e12",
                      options->unit_m);
  return SCREE_OK;
}

/* Its rotation and translation, from the measures of the mesh as given. */
static void place(const scree_export_options *options, const scree_measures *m, scree_exported *p) {
  bool centre = options->centre || options->principal;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++)
      p->rotation[i][j] = options->principal ? m->principal_axes[i][j] : (double)(i == j);
    p->translation[i] = 0;
    for (int j = 0; j < 3 && centre; j++) p->translation[i] -= p->rotation[i][j] * m->centroid[j];
  }
}

static void move(scree_mesh *mesh, const scree_exported *p) {
  mat3 turn;
  memcpy(turn.m, p->rotation, sizeof turn.m);
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    vec3 at = mat3_mul_vec(&turn, vec3_load(mesh->positions + 3 * v));
    vec3_store(mesh->positions + 3 * v, vec3_add(at, vec3_load(p->translation)));
  }
}

static void weigh(const scree_mesh *mesh, double density, scree_exported *p) {
  double largest = 0;
  vec3 centre = vec3_load(p->measures.centroid);
  p->mass = density * p->measures.volume;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) p->inertia[i][j] = density * p->measures.inertia[i][j];
  for (size_t v = 0; v < mesh->vertex_count; v++)
    largest = fmax(largest, vec3_distance(centre, vec3_load(mesh->positions + 3 * v)));
  p->bounding_radius = largest;
}

/* file, checksum, version, command */
static void export_json_provenance(scree_json *json, const scree_export_options *options) {
  char checksum[SCREE_CHECKSUM_TEXT];
  SCREE_JSON_MEMBERS(json, AS("file", options->source),
                     AS("checksum", scree_checksum_text(options->checksum, checksum)));
  scree_json_maker(json, options->command_line);
}

static scree_status write_json(const scree_export_options *options, const scree_mesh *mesh,
                               const scree_exported *p, const char *mesh_path, const char *path,
                               scree_error *error) {
  const scree_measures *m = &p->measures;
  const char *slash = strrchr(mesh_path, '/');
  double moments[3];
  for (int k = 0; k < 3; k++) moments[k] = options->density * m->principal_moments[k];
  scree_json json;
  SCREE_TRY(scree_json_open(&json, path, options->overwrite, error));
  scree_json_object(&json, NULL);
  SCREE_JSON_MEMBERS(&json, AS("mesh_file", slash ? slash + 1 : mesh_path), OF(options, unit_m),
                     OF(mesh, triangle_count), OF(mesh, vertex_count), OF(options, density),
                     OF(p, mass), OF(m, volume), OF(m, area));
  scree_json_numbers(&json, "centre_of_mass", m->centroid, 3);
  scree_json_matrix(&json, "inertia", p->inertia);
  scree_json_numbers(&json, "principal_moments", moments, 3);
  scree_json_matrix(&json, "principal_axes", m->principal_axes);
  SCREE_JSON_MEMBERS(&json, OF(m, equivalent_diameter), OF(p, bounding_radius));
  scree_json_numbers(&json, "box_min", m->box_min, 3);
  scree_json_numbers(&json, "box_max", m->box_max, 3);
  scree_json_object(&json, "placement");
  scree_json_matrix(&json, "rotation", p->rotation);
  scree_json_numbers(&json, "translation", p->translation, 3);
  scree_json_end(&json);
  export_json_provenance(&json, options);
  scree_json_end(&json);
  return scree_json_commit(&json, error);
}

static scree_status write_mesh(const scree_export_options *options, const scree_mesh *mesh,
                               const char *path, scree_error *error) {
  scree_write_options write = scree_default_write_options();
  write.unit_m = options->unit_m;
  write.overwrite = options->overwrite;
  write.comment = options->command_line;
  if (!strcmp(path, "-")) write.format = SCREE_FORMAT_STL;
  return scree_mesh_write(mesh, path, &write, error);
}

/* The mesh placed, with what it weighs there. */
static scree_status prepare(const scree_mesh *mesh, const scree_export_options *options,
                            scree_mesh *placed, scree_exported *p, scree_error *error) {
  scree_measures given;
  SCREE_TRY(scree_mesh_measure(mesh, &given, error));
  if (!given.closed || given.inward)
    return scree_fail(error, SCREE_BAD_MESH,
                      "the surface is %s, so it has no mass; `scree repair` may help",
                      given.closed ? "inside out" : "not closed");
  SCREE_TRY(scree_mesh_copy(mesh, placed, error));
  place(options, &given, p);
  move(placed, p);
  SCREE_TRY(scree_mesh_measure(placed, &p->measures, error));
  weigh(placed, options->density, p);
  return SCREE_OK;
}

scree_status scree_particle_export(const scree_mesh *mesh, const scree_export_options *options,
                                   const char *mesh_path, const char *json_path,
                                   scree_exported *exported, scree_error *error) {
  scree_export_options used = options ? *options : scree_default_export_options();
  SCREE_CLEANUP(scree_mesh_free) scree_mesh placed = {0};
  scree_exported p;
  SCREE_TRY(export_check(&used, error));
  SCREE_TRY(scree_output_check(mesh_path, used.overwrite, error));
  if (json_path) SCREE_TRY(scree_output_check(json_path, used.overwrite, error));
  SCREE_TRY(prepare(mesh, &used, &placed, &p, error));
  SCREE_TRY(write_mesh(&used, &placed, mesh_path, error));
  if (json_path) SCREE_TRY(write_json(&used, &placed, &p, mesh_path, json_path, error));
  if (exported) *exported = p;
  return SCREE_OK;
}

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
  SCREE_JSON_MEMBERS(json, AS("shape", index), AS("kind", kinds[m.kind]),
                     AS("mesh_file", mesh ? name : NULL), OF(&m, triangle_count), OF(&m, volume));
  scree_json_numbers(json, "inertia_per_density", m.inertia, 3);
  SCREE_JSON_MEMBERS(json, OF(&m, size), OF(&m, bounding_radius));
  json_spheres(json, particle, mesh ? 0 : m.point_count);
  scree_json_end(json);
}

static void json_body(scree_json *json, const exporter *e, size_t index) {
  scree_body b;
  scree_world_get_body(e->world, index, &b);
  scree_json_row_object(json, NULL);
  SCREE_JSON_MEMBERS(json, AS("body", index), AS("shape", e->shapes->of_body[index]),
                     AS("material", scree_world_body_material(e->world, index)),
                     AS("mass", scree_world_body_mass(e->world, index)));
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
  SCREE_JSON_MEMBERS(json, AS("wall", index), AS("kind", kinds[wall.kind]),
                     AS("mesh_file", wall.kind == SCREE_WALL_MESH ? name : NULL),
                     OF(&wall, material));
  scree_json_numbers(json, "position", wall.position, 3);
  scree_json_numbers(json, "orientation", orientation, 4);
  scree_json_numbers(json, "axis", wall.axis, 3);
  SCREE_JSON_MEMBERS(json, OF(&wall, radius), OF(&wall, length));
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
  export_json_provenance(&json, e->options);
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

static scree_status put_mesh(const exporter *e, const scree_mesh *mesh, const char *name,
                             scree_error *error) {
  char path[PATH_BYTES];
  SCREE_TRY(join(e, name, path, error));
  return write_mesh(e->options, mesh, path, error);
}

static scree_status write_meshes(const exporter *e, scree_error *error) {
  char name[64];
  for (size_t i = 0; i < e->shapes->count; i++) {
    shape_name(i, name);
    if (has_mesh(e->shapes->particles[i]))
      SCREE_TRY(put_mesh(e, scree_particle_mesh(e->shapes->particles[i]), name, error));
  }
  for (size_t i = 0; i < scree_world_wall_count(e->world); i++) {
    scree_wall wall;
    scree_world_get_wall(e->world, i, &wall);
    wall_name(i, name);
    if (wall.kind == SCREE_WALL_MESH) SCREE_TRY(put_mesh(e, wall.mesh, name, error));
  }
  return SCREE_OK;
}

/* Adds a body's surface, where it lies. */
static void add_body(const exporter *e, size_t index, const scree_mesh *mesh, scree_mesh *to) {
  scree_body b;
  scree_world_get_body(e->world, index, &b);
  const double *q = b.orientation;
  const mat3 turn = quat_to_mat3(quat_load(q));
  for (size_t k = 0; k < 3 * mesh->triangle_count; k++)
    to->triangles[3 * to->triangle_count + k] = mesh->triangles[k] + (uint32_t)to->vertex_count;
  for (size_t v = 0; v < mesh->vertex_count; v++)
    vec3_store(
        to->positions + 3 * (to->vertex_count + v),
        vec3_add(mat3_mul_vec(&turn, vec3_load(mesh->positions + 3 * v)), vec3_load(b.position)));
  to->triangle_count += mesh->triangle_count;
  to->vertex_count += mesh->vertex_count;
}

/* The body's surface; NULL: it has none, or is not of the fragment. */
static const scree_mesh *surface_in(const exporter *e, const size_t *fragment_of, size_t body,
                                    size_t fragment) {
  const scree_particle *particle = e->shapes->particles[e->shapes->of_body[body]];
  return fragment_of[body] == fragment && has_mesh(particle) ? scree_particle_mesh(particle) : NULL;
}

/* Nothing where no body of the fragment has a surface. */
static scree_status write_fragment(const exporter *e, const size_t *of, size_t f,
                                   scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh all = {0};
  size_t vertices = 0, triangles = 0, bodies = scree_world_body_count(e->world);
  const scree_mesh *mesh;
  char name[64];
  for (size_t b = 0; b < bodies; b++) {
    if (!(mesh = surface_in(e, of, b, f))) continue;
    vertices += mesh->vertex_count;
    triangles += mesh->triangle_count;
  }
  if (triangles == 0) return SCREE_OK;
  SCREE_TRY_ALLOC(all.positions, 3 * vertices, error);
  SCREE_TRY_ALLOC(all.triangles, 3 * triangles, error);
  for (size_t b = 0; b < bodies; b++)
    if ((mesh = surface_in(e, of, b, f))) add_body(e, b, mesh, &all);
  snprintf(name, sizeof name, "fragment-%zu.stl", f);
  return put_mesh(e, &all, name, error);
}

/* Where there are joints: what hangs together, as it lies in space. */
static scree_status write_fragments(const exporter *e, scree_error *error) {
  if (scree_world_joint_count(e->world) == 0) return SCREE_OK;
  SCREE_SCRATCH(size_t, of, scree_world_body_count(e->world), error);
  size_t count = scree_world_fragments(e->world, of);
  for (size_t f = 0; f < count; f++) SCREE_TRY(write_fragment(e, of, f, error));
  return SCREE_OK;
}

scree_status scree_world_export(const scree_world *world, const scree_export_options *options,
                                const char *folder, scree_error *error) {
  scree_export_options used = options ? *options : scree_default_export_options();
  exporter e = {.world = world, .options = &used, .folder = folder};
  SCREE_CLEANUP(scree_shapes_free) scree_shapes shapes = {0};
  char path[PATH_BYTES];
  SCREE_TRY(export_check(&used, error));
  SCREE_TRY(join(&e, "pile.json", path, error));
  SCREE_TRY(scree_folder_create(folder, error));
  SCREE_TRY(scree_output_check(path, used.overwrite, error));
  SCREE_TRY(scree_shapes_find(world, &shapes, error));
  e.shapes = &shapes;
  SCREE_TRY(write_meshes(&e, error));
  SCREE_TRY(write_fragments(&e, error));
  SCREE_TRY(write_text(&e, "bodies.csv", print_csv, error));
  return write_text(&e, "pile.json", print_json, error);
}
