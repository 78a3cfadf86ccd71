/* A particle's mesh and mass properties for other DEM codes. The inertia is that of the mesh as it
 * lies in the file, times the density; docs/reference/formats.md lists the fields. */
#include "report/particle_export.h"
#include "base/file.h"
#include "base/vec.h"
#include "report/json.h"

#include <math.h>
#include <string.h>

scree_export_options scree_default_export_options(void) {
  return (scree_export_options){.density = 2000, .unit_m = 1e-3};
}

scree_status scree_export_check(const scree_export_options *options, scree_error *error) {
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

void scree_export_json_provenance(scree_json *json, const scree_export_options *options) {
  char checksum[SCREE_CHECKSUM_TEXT];
  scree_json_text(json, "file", options->source);
  scree_json_text(json, "checksum", scree_checksum_text(options->checksum, checksum));
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
  scree_json_text(&json, "mesh_file", slash ? slash + 1 : mesh_path);
  scree_json_number(&json, "unit_m", options->unit_m);
  SCREE_JSON_MEMBERS(&json, mesh, triangle_count, vertex_count);
  scree_json_number(&json, "density", options->density);
  scree_json_number(&json, "mass", p->mass);
  SCREE_JSON_MEMBERS(&json, m, volume, area);
  scree_json_numbers(&json, "centre_of_mass", m->centroid, 3);
  scree_json_matrix(&json, "inertia", p->inertia);
  scree_json_numbers(&json, "principal_moments", moments, 3);
  scree_json_matrix(&json, "principal_axes", m->principal_axes);
  scree_json_number(&json, "equivalent_diameter", m->equivalent_diameter);
  scree_json_number(&json, "bounding_radius", p->bounding_radius);
  scree_json_numbers(&json, "box_min", m->box_min, 3);
  scree_json_numbers(&json, "box_max", m->box_max, 3);
  scree_json_object(&json, "placement");
  scree_json_matrix(&json, "rotation", p->rotation);
  scree_json_numbers(&json, "translation", p->translation, 3);
  scree_json_end(&json);
  scree_export_json_provenance(&json, options);
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
  SCREE_TRY(scree_export_check(&used, error));
  SCREE_TRY(scree_output_check(mesh_path, used.overwrite, error));
  if (json_path) SCREE_TRY(scree_output_check(json_path, used.overwrite, error));
  SCREE_TRY(prepare(mesh, &used, &placed, &p, error));
  SCREE_TRY(write_mesh(&used, &placed, mesh_path, error));
  if (json_path) SCREE_TRY(write_json(&used, &placed, &p, mesh_path, json_path, error));
  if (exported) *exported = p;
  return SCREE_OK;
}
