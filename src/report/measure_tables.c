/* Measures, topology and distances as JSON and CSV. One table of fields serves both; all values are
 * SI, and every object carries what is needed to run it again. */
#include "base/file.h"
#include "base/quote.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/program.h"

/* A member of scree_measure_entry, and what it needs to exist. */
typedef struct field {
  scree_field of;
  enum { NOTHING, VOLUME, BODY } needs;
} field;

#define MEASURE(part, name, needs)                                                                 \
  { SCREE_FIELD_AS(scree_measure_entry, #name, part.name), needs }
#define M(name) MEASURE(measures, name, NOTHING)
#define V(name) MEASURE(measures, name, VOLUME)
#define T(name) MEASURE(topology, name, NOTHING)
#define D(name) MEASURE(descriptors, name, BODY)

static const field measure_fields[] = {
    M(area),
    M(volume),
    M(closed),
    M(inward),
    V(centroid),
    V(inertia),
    V(principal_moments),
    V(principal_axes),
    V(equivalent_diameter),
    V(sphericity),
    V(convexity),
    M(dimensions),
    M(box_min),
    M(box_max),
    M(oriented_dimensions),
    M(oriented_axes),
    M(oriented_center),
    M(hull_area),
    M(hull_volume),
};

static const field topology_fields[] = {
    T(facet_count),
    T(vertex_count),
    T(unused_vertex_count),
    T(edge_count),
    T(shell_count),
    T(inward_shell_count),
    T(boundary_edge_count),
    T(boundary_count),
    T(non_manifold_edge_count),
    T(non_manifold_vertex_count),
    T(inconsistent_edge_count),
    T(degenerate_facet_count),
    T(duplicate_facet_count),
    T(euler_characteristic),
    T(genus),
    T(closed),
    T(manifold),
    T(oriented),
};

static const field shape_fields[] = {
    D(elongation),          D(flatness),         D(zingg),
    D(krumbein_sphericity), D(roundness),        D(angularity),
    D(inscribed_radius),    D(inscribed_centre), D(bounding_radius),
    D(bounding_centre),
};
#undef MEASURE
#undef M
#undef V
#undef T
#undef D

enum {
  MEASURE_FIELDS = sizeof measure_fields / sizeof *measure_fields,
  TOPOLOGY_FIELDS = sizeof topology_fields / sizeof *topology_fields,
  SHAPE_FIELDS = sizeof shape_fields / sizeof *shape_fields
};

static bool exists(const scree_measure_entry *entry, const field *f) {
  return f->needs == NOTHING ||
         (f->needs == VOLUME ? entry->measures.has_volume : entry->described);
}

/* ---- JSON ---- */

static void json_field(scree_json *json, const scree_measure_entry *entry, const field *f) {
  if (!exists(entry, f))
    scree_json_text(json, f->of.key, NULL);
  else if (f->of.kind == SCREE_FIELD_WORD)
    scree_json_text(json, f->of.key, scree_zingg_name(entry->descriptors.zingg));
  else
    scree_json_field(json, &f->of, entry);
}

static void json_entry(scree_json *json, const scree_measure_entry *entry,
                       const char *command_line) {
  scree_json_object(json, NULL);
  scree_json_text(json, "file", entry->file);
  scree_json_source(json, entry->format, entry->checksum, entry->unit_m);
  for (int i = 0; i < MEASURE_FIELDS; i++) json_field(json, entry, &measure_fields[i]);
  scree_json_object(json, "shape");
  for (int i = 0; i < SHAPE_FIELDS; i++) json_field(json, entry, &shape_fields[i]);
  scree_json_end(json);
  scree_json_object(json, "topology");
  for (int i = 0; i < TOPOLOGY_FIELDS; i++) json_field(json, entry, &topology_fields[i]);
  scree_json_end(json);
  scree_json_maker(json, command_line);
  scree_json_end(json);
}

scree_status scree_measure_json_write(const scree_measure_entry *entries, size_t entry_count,
                                      const char *command_line, const char *path, bool overwrite,
                                      scree_error *error) {
  scree_json json;
  SCREE_TRY(scree_json_open(&json, path, overwrite, error));
  SCREE_JSON_LIST (&json, NULL, i, entry_count) json_entry(&json, &entries[i], command_line);
  return scree_json_commit(&json, error);
}

static void json_deviation(scree_json *json, const char *key, const scree_deviation *d) {
  scree_json_object(json, key);
  SCREE_JSON_MEMBERS(json, OF(d, mean), OF(d, rms), OF(d, maximum), OF(d, maximum_bound));
  scree_json_numbers(json, "at", d->at, 3);
  scree_json_count(json, "sample_count", d->sample_count);
  scree_json_end(json);
}

scree_status scree_distance_json_write(const scree_distance_entry *entry, const char *command_line,
                                       const char *path, bool overwrite, scree_error *error) {
  scree_json json;
  SCREE_TRY(scree_json_open(&json, path, overwrite, error));
  scree_json_object(&json, NULL);
  SCREE_JSON_LIST (&json, "files", i, 2) {
    char checksum[SCREE_CHECKSUM_TEXT];
    SCREE_JSON_ROW(&json, NULL, AS("file", entry->file[i]),
                   AS("checksum", scree_checksum_text(entry->checksum[i], checksum)),
                   AS("unit_m", entry->unit_m[i]));
  }
  json_deviation(&json, "forward", &entry->distance.forward);
  if (!entry->options.one_way) json_deviation(&json, "backward", &entry->distance.backward);
  SCREE_JSON_MEMBERS(&json, OF(&entry->distance, hausdorff), OF(&entry->distance, hausdorff_bound));
  SCREE_JSON_ROW(&json, "options", OF(&entry->options, sample_count),
                 OF(&entry->options, hausdorff_gap), OF(&entry->options, one_way));
  scree_json_maker(&json, command_line);
  scree_json_end(&json);
  return scree_json_commit(&json, error);
}

#define OF_ROW(name, member) SCREE_FIELD_AS(scree_curve_row, name, member)
const scree_curve_column scree_curve_columns[SCREE_CURVE_COLUMNS] = {
    {OF_ROW("rp", level.rp), "rp", "Rp", 1, {{9, 3}, {8, 3}}},
    {OF_ROW("area", level.area), "area", "S (cm2)", 1e4, {{9, 4}}},
    {OF_ROW("volume", level.volume), "volume", "V (cm3)", 1e6, {{9, 4}}},
    {OF_ROW("eps_s", eps_s), "eps_s", "eps_s", 1, {{9, 3}, {8, 3}}},
    {OF_ROW("eps_v", eps_v), "eps_v", "eps_v", 1, {{9, 2}, {7, 2}}},
    {OF_ROW("ip", ip), "ip", "Ip", 1, {{9, 4}, {8, 4}}},
    {OF_ROW("quadric_error", level.quadric_error), "quadric_error", "Q (mm)", 1e3, {{8, 3}}},
    {OF_ROW("forward_mean", distance.forward.mean), "forward_mean", "mean", 1e3, {{0, 0}, {8, 3}}},
    {OF_ROW("forward_max", distance.forward.maximum),
     "forward_maximum",
     "max",
     1e3,
     {{0, 0}, {8, 3}}},
    {OF_ROW("backward_mean", distance.backward.mean),
     "backward_mean",
     "back",
     1e3,
     {{0, 0}, {8, 3}}},
    {OF_ROW("backward_max", distance.backward.maximum),
     "backward_maximum",
     "back max",
     1e3,
     {{0, 0}, {8, 3}}},
    {OF_ROW("hausdorff", distance.hausdorff), "hausdorff", "", 1e3, {{0, 0}}},
};
#undef OF_ROW

scree_status scree_curve_json_write(const scree_curve_entry *entry, const char *command_line,
                                    const char *path, bool overwrite, scree_error *error) {
  scree_json json;
  SCREE_TRY(scree_json_open(&json, path, overwrite, error));
  scree_json_object(&json, NULL);
  scree_json_text(&json, "file", entry->file);
  scree_json_source(&json, entry->format, entry->checksum, entry->unit_m);
  SCREE_JSON_MEMBERS(&json, AS("method", scree_method_name(entry->facts.method)),
                     OF(&entry->facts, triangle_count), OF(entry, area), OF(entry, volume),
                     OF(&entry->facts, closed), OF(&entry->facts, shell_count),
                     OF(&entry->facts, boundary_edge_count), OF(&entry->facts, locked_vertex_count),
                     AS("floor_triangle_count", entry->facts.floor_count));
  SCREE_JSON_LIST (&json, "levels", i, entry->row_count) {
    scree_json_row_object(&json, NULL);
    scree_json_count(&json, "triangle_count", entry->rows[i].level.triangle_count);
    for (int k = 0; k < (entry->distances ? SCREE_CURVE_COLUMNS : SCREE_CURVE_DISTANCES); k++)
      scree_json_number(&json, scree_curve_columns[k].json,
                        scree_field_real(&scree_curve_columns[k].of, &entry->rows[i]));
    scree_json_end(&json);
  }
  scree_json_maker(&json, command_line);
  scree_json_end(&json);
  return scree_json_commit(&json, error);
}

/* ---- CSV ---- */

/* How many numbers it is. */
static size_t count_of(const field *f) {
  return f->of.kind == SCREE_FIELD_REAL ? f->of.size / sizeof(double) : 1;
}

static void csv_header(FILE *stream, const field *fields, int field_count, const char *prefix) {
  for (const field *f = fields; f < fields + field_count; f++)
    for (size_t k = 0; k < count_of(f); k++)
      if (count_of(f) == 1)
        fprintf(stream, ",%s%s", prefix, f->of.key);
      else
        fprintf(stream, ",%s%s_%zu", prefix, f->of.key, k + 1);
}

static void csv_field(FILE *stream, const scree_measure_entry *entry, const scree_field *f) {
  const void *value = scree_field_at(f, entry);
  if (f->kind == SCREE_FIELD_COUNT)
    fprintf(stream, ",%zu", *(const size_t *)value);
  else if (f->kind == SCREE_FIELD_WHOLE)
    fprintf(stream, ",%lld", *(const long long *)value);
  else if (f->kind == SCREE_FIELD_WORD)
    fprintf(stream, ",%s", scree_zingg_name(*(const scree_zingg *)value));
  else if (f->kind == SCREE_FIELD_FLAG)
    fputs(*(const bool *)value ? ",true" : ",false", stream);
  else
    scree_csv_numbers(stream, value, f->size / sizeof(double));
}

static void csv_fields(FILE *stream, const scree_measure_entry *entry, const field *fields,
                       int field_count) {
  for (const field *f = fields; f < fields + field_count; f++)
    if (exists(entry, f))
      csv_field(stream, entry, &f->of);
    else
      for (size_t k = 0; k < count_of(f); k++) putc(',', stream);
}

scree_status scree_measure_csv_write(const scree_measure_entry *entries, size_t entry_count,
                                     const char *path, bool overwrite, scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  fputs("file,unit_m", output.stream);
  csv_header(output.stream, measure_fields, MEASURE_FIELDS, "");
  csv_header(output.stream, topology_fields, TOPOLOGY_FIELDS, "topology_");
  csv_header(output.stream, shape_fields, SHAPE_FIELDS, "shape_");
  putc('\n', output.stream);
  for (size_t i = 0; i < entry_count; i++) {
    scree_quote(output.stream, SCREE_QUOTE_CSV, entries[i].file);
    putc(',', output.stream);
    scree_csv_number(output.stream, entries[i].unit_m);
    csv_fields(output.stream, &entries[i], measure_fields, MEASURE_FIELDS);
    csv_fields(output.stream, &entries[i], topology_fields, TOPOLOGY_FIELDS);
    csv_fields(output.stream, &entries[i], shape_fields, SHAPE_FIELDS);
    putc('\n', output.stream);
  }
  return scree_output_commit(&output, error);
}
