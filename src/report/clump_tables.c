/* Clumps as JSON and CSV. */
#include "base/file.h"
#include "base/quote.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/program.h"

#include <math.h>

/* A number of each clump, in the order of the tables. */
static const scree_field columns[] = {
    SCREE_FIELD_OF(scree_clump, iou),
    SCREE_FIELD_OF(scree_clump, union_volume),
    SCREE_FIELD_OF(scree_clump, volume_error),
    SCREE_FIELD_OF(scree_clump, centroid_error),
    SCREE_FIELD_OF(scree_clump, inertia_error),
    SCREE_FIELD_AS(scree_clump, "to_mesh_mean", to_mesh.mean),
    SCREE_FIELD_AS(scree_clump, "to_mesh_max", to_mesh.maximum),
    SCREE_FIELD_AS(scree_clump, "from_mesh_mean", from_mesh.mean),
    SCREE_FIELD_AS(scree_clump, "from_mesh_max", from_mesh.maximum),
    SCREE_FIELD_OF(scree_clump, roughness),
    SCREE_FIELD_OF(scree_clump, slope_deg),
    SCREE_FIELD_OF(scree_clump, outside),
    SCREE_FIELD_OF(scree_clump, volume_criterion),
    SCREE_FIELD_OF(scree_clump, distance_criterion)};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

/* To a millionth of the size: shorter, and finer than any scan. */
static double shortened(double value, double size) {
  double exponent = floor(log10(size)) - 6, unit = pow(10, -exponent);
  return round(value * unit) / unit + 0.0;
}

static void json_spheres(scree_json *json, const scree_clump *c, double size) {
  SCREE_JSON_ROW_LIST (json, "spheres", i, c->sphere_count) {
    const scree_sphere *s = &c->spheres[i];
    scree_json_row_array(json, NULL);
    for (int k = 0; k < 3; k++) scree_json_number(json, NULL, shortened(s->centre[k], size));
    scree_json_number(json, NULL, shortened(s->radius, size));
    scree_json_end(json);
  }
}

static void json_clumps(scree_json *json, const scree_clumps *clumps) {
  SCREE_JSON_LIST (json, "clumps", i, clumps->clump_count) {
    const scree_clump *c = &clumps->clumps[i];
    scree_json_row_object(json, NULL);
    scree_json_count(json, "sphere_count", c->sphere_count);
    for (int k = 0; k < COLUMN_COUNT; k++) scree_json_field(json, &columns[k], c);
    scree_json_count(json, "useless_count", c->useless_count);
    json_spheres(json, c, clumps->size);
    scree_json_end(json);
  }
}

/* The mass properties that go with every clump. */
static void json_body(scree_json *json, const scree_clumps *clumps) {
  const scree_measures *m = &clumps->measures;
  SCREE_JSON_MEMBERS(json, OF(m, volume), OF(clumps, size));
  scree_json_numbers(json, "centroid", m->centroid, 3);
  scree_json_numbers(json, "principal_moments", m->principal_moments, 3);
  scree_json_matrix(json, "principal_axes", m->principal_axes);
  SCREE_JSON_MEMBERS(json, OF(clumps, thickness), OF(clumps, wall_cells));
}

/* The surface that the spheres stand for. */
static void json_surface(scree_json *json, const scree_mesh *mesh, double size) {
  scree_json_object(json, "surface");
  SCREE_JSON_ROW_LIST (json, "points", i, 3 * mesh->vertex_count)
    scree_json_number(json, NULL, shortened(mesh->positions[i], size));
  SCREE_JSON_ROW_LIST (json, "triangles", i, 3 * mesh->triangle_count)
    scree_json_count(json, NULL, mesh->triangles[i]);
  scree_json_end(json);
}

static void json_entry(scree_json *json, const scree_clump_report *report,
                       const scree_clump_entry *e) {
  const scree_clumps *c = e->clumps;
  scree_json_object(json, NULL);
  SCREE_JSON_MEMBERS(json, OF(e, file), OF(e, name));
  scree_json_source(json, e->format, e->checksum, e->unit_m);
  SCREE_JSON_MEMBERS(json, OF(e, note), OF(e, scan_triangle_count), OF(e->mesh, triangle_count),
                     AS("method", scree_clump_method_name(c->method)));
  json_body(json, c);
  SCREE_JSON_MEMBERS(json, AS("recommended", c->clumps[c->recommended].sphere_count),
                     AS("recommended_by_distance", c->clumps[c->by_distance].sphere_count),
                     AS("chosen", e->chosen->sphere_count), OF(e, clump_file));
  json_clumps(json, c);
  json_surface(json, e->mesh, c->size);
  scree_json_maker(json, report->command_line);
  scree_json_end(json);
}

scree_status scree_clump_json_write(const void *what, const char *path, bool overwrite,
                                    scree_error *error) {
  const scree_clump_report *report = what;
  scree_json file, *json = &file;
  SCREE_TRY(scree_json_open(json, path, overwrite, error));
  SCREE_JSON_LIST (json, NULL, i, report->entry_count)
    json_entry(json, report, &report->entries[i]);
  return scree_json_commit(json, error);
}

scree_status scree_clump_csv_write(const void *what, const char *path, bool overwrite,
                                   scree_error *error) {
  const scree_clump_report *report = what;
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  FILE *f = output.stream;
  fputs("name,sphere_count", f);
  for (int k = 0; k < COLUMN_COUNT; k++) fprintf(f, ",%s", columns[k].key);
  fputs(",useless_count,recommended,chosen\n", f);
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_clump_entry *entry = &report->entries[e];
    const scree_clumps *clumps = entry->clumps;
    for (size_t i = 0; i < clumps->clump_count; i++) {
      const scree_clump *c = &clumps->clumps[i];
      scree_quote(f, SCREE_QUOTE_CSV, entry->name);
      fprintf(f, ",%zu", c->sphere_count);
      for (int k = 0; k < COLUMN_COUNT; k++)
        scree_csv_numbers(f, scree_field_at(&columns[k], c), 1);
      fprintf(f, ",%zu,%d,%d\n", c->useless_count, i == clumps->recommended, c == entry->chosen);
    }
  }
  return scree_output_commit(&output, error);
}
