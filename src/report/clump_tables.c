/* Clumps as JSON and CSV. */
#include "base/file.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/program.h"

#include <math.h>

/* A number of each clump, in the order of the tables. */
typedef struct column {
  const char *name;
  double (*value)(const scree_clump *clump);
} column;

#define COLUMN(member)                                                                             \
  static double get_##member(const scree_clump *c) {                                               \
    return c->member;                                                                              \
  }
COLUMN(iou)
COLUMN(union_volume)
COLUMN(volume_error)
COLUMN(centroid_error)
COLUMN(inertia_error)
COLUMN(roughness)
COLUMN(slope_deg)
COLUMN(outside)
COLUMN(volume_criterion)
COLUMN(distance_criterion)
#undef COLUMN
static double get_to_mean(const scree_clump *c) {
  return c->to_mesh.mean;
}
static double get_to_maximum(const scree_clump *c) {
  return c->to_mesh.maximum;
}
static double get_from_mean(const scree_clump *c) {
  return c->from_mesh.mean;
}
static double get_from_maximum(const scree_clump *c) {
  return c->from_mesh.maximum;
}

static const column columns[] = {
    {"iou", get_iou},
    {"union_volume", get_union_volume},
    {"volume_error", get_volume_error},
    {"centroid_error", get_centroid_error},
    {"inertia_error", get_inertia_error},
    {"to_mesh_mean", get_to_mean},
    {"to_mesh_max", get_to_maximum},
    {"from_mesh_mean", get_from_mean},
    {"from_mesh_max", get_from_maximum},
    {"roughness", get_roughness},
    {"slope_deg", get_slope_deg},
    {"outside", get_outside},
    {"volume_criterion", get_volume_criterion},
    {"distance_criterion", get_distance_criterion},
};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

/* To a millionth of the size: shorter, and finer than any scan. */
static double shortened(double value, double size) {
  double exponent = floor(log10(size)) - 6, unit = pow(10, -exponent);
  return round(value * unit) / unit + 0.0;
}

static void json_spheres(scree_json *json, const scree_clump *c, double size) {
  scree_json_row_array(json, "spheres");
  for (size_t i = 0; i < c->sphere_count; i++) {
    const scree_sphere *s = &c->spheres[i];
    scree_json_row_array(json, NULL);
    for (int k = 0; k < 3; k++) scree_json_number(json, NULL, shortened(s->centre[k], size));
    scree_json_number(json, NULL, shortened(s->radius, size));
    scree_json_end(json);
  }
  scree_json_end(json);
}

static void json_clumps(scree_json *json, const scree_clumps *clumps) {
  scree_json_array(json, "clumps");
  for (size_t i = 0; i < clumps->clump_count; i++) {
    const scree_clump *c = &clumps->clumps[i];
    scree_json_row_object(json, NULL);
    scree_json_count(json, "sphere_count", c->sphere_count);
    for (int k = 0; k < COLUMN_COUNT; k++)
      scree_json_number(json, columns[k].name, columns[k].value(c));
    scree_json_count(json, "useless_count", c->useless_count);
    json_spheres(json, c, clumps->size);
    scree_json_end(json);
  }
  scree_json_end(json);
}

/* The mass properties that go with every clump. */
static void json_body(scree_json *json, const scree_clumps *clumps) {
  const scree_measures *m = &clumps->measures;
  scree_json_number(json, "volume", m->volume);
  scree_json_number(json, "size", clumps->size);
  scree_json_numbers(json, "centroid", m->centroid, 3);
  scree_json_numbers(json, "principal_moments", m->principal_moments, 3);
  scree_json_matrix(json, "principal_axes", m->principal_axes);
  scree_json_number(json, "thickness", clumps->thickness);
  scree_json_number(json, "wall_cells", clumps->wall_cells);
}

/* The surface that the spheres stand for. */
static void json_surface(scree_json *json, const scree_mesh *mesh, double size) {
  scree_json_object(json, "surface");
  scree_json_row_array(json, "points");
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    scree_json_number(json, NULL, shortened(mesh->positions[i], size));
  scree_json_end(json);
  scree_json_row_array(json, "triangles");
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
    scree_json_count(json, NULL, mesh->triangles[i]);
  scree_json_end(json);
  scree_json_end(json);
}

static void json_entry(scree_json *json, const scree_clump_report *report,
                       const scree_clump_entry *e) {
  const scree_clumps *c = e->clumps;
  scree_json_object(json, NULL);
  scree_json_text(json, "file", e->file);
  scree_json_text(json, "name", e->name);
  scree_json_source(json, e->format, e->checksum, e->unit_m);
  scree_json_text(json, "note", e->note);
  scree_json_count(json, "scan_triangle_count", e->scan_triangle_count);
  scree_json_count(json, "triangle_count", e->mesh->triangle_count);
  scree_json_text(json, "method", scree_clump_method_name(c->method));
  json_body(json, c);
  scree_json_count(json, "recommended", c->clumps[c->recommended].sphere_count);
  scree_json_count(json, "recommended_by_distance", c->clumps[c->by_distance].sphere_count);
  scree_json_count(json, "chosen", e->chosen->sphere_count);
  scree_json_text(json, "clump_file", e->clump_file);
  json_clumps(json, c);
  json_surface(json, e->mesh, c->size);
  scree_json_maker(json, report->command_line);
  scree_json_end(json);
}

scree_status scree_clump_json_write(const scree_clump_report *report, const char *path,
                                    bool overwrite, scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status != SCREE_OK) return status;
  scree_json json = scree_json_start(output.stream);
  scree_json_array(&json, NULL);
  for (size_t i = 0; i < report->entry_count; i++) json_entry(&json, report, &report->entries[i]);
  scree_json_end(&json);
  return scree_output_commit(&output, error);
}

scree_status scree_clump_csv_write(const scree_clump_report *report, const char *path,
                                   bool overwrite, scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status != SCREE_OK) return status;
  FILE *f = output.stream;
  fputs("name,sphere_count", f);
  for (int k = 0; k < COLUMN_COUNT; k++) fprintf(f, ",%s", columns[k].name);
  fputs(",useless_count,recommended,chosen\n", f);
  for (size_t e = 0; e < report->entry_count; e++) {
    const scree_clump_entry *entry = &report->entries[e];
    const scree_clumps *clumps = entry->clumps;
    for (size_t i = 0; i < clumps->clump_count; i++) {
      const scree_clump *c = &clumps->clumps[i];
      scree_csv_text(f, entry->name);
      fprintf(f, ",%zu", c->sphere_count);
      for (int k = 0; k < COLUMN_COUNT; k++) {
        putc(',', f);
        scree_csv_number(f, columns[k].value(c));
      }
      fprintf(f, ",%zu,%d,%d\n", c->useless_count, i == clumps->recommended, c == entry->chosen);
    }
  }
  return scree_output_commit(&output, error);
}
