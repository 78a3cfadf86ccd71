/* Measures, topology and distances as JSON and CSV. One table of fields serves both; all values are
 * SI, and every object carries what is needed to run it again. */
#include "base/file.h"
#include "base/quote.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/program.h"

typedef enum kind { REAL, COUNT, SIGNED, FLAG, CLASS } kind;
/* What a field needs to exist. */
typedef enum need { NOTHING, VOLUME, BODY } need;

/* A field of scree_measure_entry: count values (1, 3, or 9 as three rows of three). */
typedef struct field {
  const char *name;
  kind kind;
  size_t offset;
  int count;
  need needs;
} field;

#define MEASURE(name, kind, count, needs)                                                          \
  {                                                                                                \
#name, kind, offsetof(scree_measure_entry, measures) + offsetof(scree_measures, name), count,  \
        needs                                                                                      \
  }
#define M(name, kind, count) MEASURE(name, kind, count, NOTHING)
#define V(name, count)       MEASURE(name, REAL, count, VOLUME)
#define T(name, kind)                                                                              \
  {                                                                                                \
#name, kind, offsetof(scree_measure_entry, topology) + offsetof(scree_topology, name), 1,      \
        NOTHING                                                                                    \
  }

static const field measure_fields[] = {
    M(area, REAL, 1),
    M(volume, REAL, 1),
    M(closed, FLAG, 1),
    M(inward, FLAG, 1),
    V(centroid, 3),
    V(inertia, 9),
    V(principal_moments, 3),
    V(principal_axes, 9),
    V(equivalent_diameter, 1),
    V(sphericity, 1),
    V(convexity, 1),
    M(dimensions, REAL, 3),
    M(box_min, REAL, 3),
    M(box_max, REAL, 3),
    M(oriented_dimensions, REAL, 3),
    M(oriented_axes, REAL, 9),
    M(oriented_center, REAL, 3),
    M(hull_area, REAL, 1),
    M(hull_volume, REAL, 1),
};

static const field topology_fields[] = {
    T(facet_count, COUNT),
    T(vertex_count, COUNT),
    T(unused_vertex_count, COUNT),
    T(edge_count, COUNT),
    T(shell_count, COUNT),
    T(inward_shell_count, COUNT),
    T(boundary_edge_count, COUNT),
    T(boundary_count, COUNT),
    T(non_manifold_edge_count, COUNT),
    T(non_manifold_vertex_count, COUNT),
    T(inconsistent_edge_count, COUNT),
    T(degenerate_facet_count, COUNT),
    T(duplicate_facet_count, COUNT),
    T(euler_characteristic, SIGNED),
    T(genus, SIGNED),
    T(closed, FLAG),
    T(manifold, FLAG),
    T(oriented, FLAG),
};

#define D(name, kind, count)                                                                       \
  {                                                                                                \
#name, kind, offsetof(scree_measure_entry, descriptors) + offsetof(scree_descriptors, name),   \
        count, BODY                                                                                \
  }
static const field shape_fields[] = {
    D(elongation, REAL, 1),          D(flatness, REAL, 1),         D(zingg, CLASS, 1),
    D(krumbein_sphericity, REAL, 1), D(roundness, REAL, 1),        D(angularity, REAL, 1),
    D(inscribed_radius, REAL, 1),    D(inscribed_centre, REAL, 3), D(bounding_radius, REAL, 1),
    D(bounding_centre, REAL, 3),
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

static const void *value_of(const scree_measure_entry *entry, const field *f) {
  return (const char *)entry + f->offset;
}

/* ---- JSON ---- */

static void json_field(scree_json *json, const scree_measure_entry *entry, const field *f) {
  const void *value = value_of(entry, f);
  if (!exists(entry, f)) {
    scree_json_text(json, f->name, NULL);
  } else if (f->kind == COUNT) {
    scree_json_count(json, f->name, *(const size_t *)value);
  } else if (f->kind == SIGNED) {
    scree_json_number(json, f->name, (double)*(const long long *)value);
  } else if (f->kind == FLAG) {
    scree_json_bool(json, f->name, *(const bool *)value);
  } else if (f->kind == CLASS) {
    scree_json_text(json, f->name, scree_zingg_name(*(const scree_zingg *)value));
  } else if (f->count == 1) {
    scree_json_number(json, f->name, *(const double *)value);
  } else if (f->count == 3) {
    scree_json_numbers(json, f->name, value, 3);
  } else {
    scree_json_matrix(json, f->name, value);
  }
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
  SCREE_JSON_MEMBERS(json, d, mean, rms, maximum, maximum_bound);
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
    scree_json_row_object(&json, NULL);
    scree_json_text(&json, "file", entry->file[i]);
    scree_json_text(&json, "checksum", scree_checksum_text(entry->checksum[i], checksum));
    scree_json_number(&json, "unit_m", entry->unit_m[i]);
    scree_json_end(&json);
  }
  json_deviation(&json, "forward", &entry->distance.forward);
  if (!entry->options.one_way) json_deviation(&json, "backward", &entry->distance.backward);
  SCREE_JSON_MEMBERS(&json, &entry->distance, hausdorff, hausdorff_bound);
  SCREE_JSON_ROW(&json, "options", &entry->options, sample_count, hausdorff_gap, one_way);
  scree_json_maker(&json, command_line);
  scree_json_end(&json);
  return scree_json_commit(&json, error);
}

#define AT(member) offsetof(scree_curve_row, member)
const scree_curve_column scree_curve_columns[SCREE_CURVE_COLUMNS] = {
    {"rp", "rp", "Rp", 1, {{9, 3}, {8, 3}}, AT(level.rp)},
    {"area", "area", "S (cm2)", 1e4, {{9, 4}}, AT(level.area)},
    {"volume", "volume", "V (cm3)", 1e6, {{9, 4}}, AT(level.volume)},
    {"eps_s", "eps_s", "eps_s", 1, {{9, 3}, {8, 3}}, AT(eps_s)},
    {"eps_v", "eps_v", "eps_v", 1, {{9, 2}, {7, 2}}, AT(eps_v)},
    {"ip", "ip", "Ip", 1, {{9, 4}, {8, 4}}, AT(ip)},
    {"quadric_error", "quadric_error", "Q (mm)", 1e3, {{8, 3}}, AT(level.quadric_error)},
    {"forward_mean", "forward_mean", "mean", 1e3, {{0, 0}, {8, 3}}, AT(distance.forward.mean)},
    {"forward_max", "forward_maximum", "max", 1e3, {{0, 0}, {8, 3}}, AT(distance.forward.maximum)},
    {"backward_mean", "backward_mean", "back", 1e3, {{0, 0}, {8, 3}}, AT(distance.backward.mean)},
    {"backward_max",
     "backward_maximum",
     "back max",
     1e3,
     {{0, 0}, {8, 3}},
     AT(distance.backward.maximum)},
    {"hausdorff", "hausdorff", "", 1e3, {{0, 0}}, AT(distance.hausdorff)},
};
#undef AT

scree_status scree_curve_json_write(const scree_curve_entry *entry, const char *command_line,
                                    const char *path, bool overwrite, scree_error *error) {
  scree_json json;
  SCREE_TRY(scree_json_open(&json, path, overwrite, error));
  scree_json_object(&json, NULL);
  scree_json_text(&json, "file", entry->file);
  scree_json_source(&json, entry->format, entry->checksum, entry->unit_m);
  scree_json_text(&json, "method", scree_method_name(entry->facts.method));
  scree_json_count(&json, "triangle_count", entry->facts.triangle_count);
  SCREE_JSON_MEMBERS(&json, entry, area, volume);
  SCREE_JSON_MEMBERS(&json, &entry->facts, closed, shell_count, boundary_edge_count,
                     locked_vertex_count);
  scree_json_count(&json, "floor_triangle_count", entry->facts.floor_count);
  SCREE_JSON_LIST (&json, "levels", i, entry->row_count) {
    scree_json_row_object(&json, NULL);
    scree_json_count(&json, "triangle_count", entry->rows[i].level.triangle_count);
    for (int k = 0; k < (entry->distances ? SCREE_CURVE_COLUMNS : SCREE_CURVE_DISTANCES); k++)
      scree_json_number(&json, scree_curve_columns[k].json, scree_curve_value(&entry->rows[i], k));
    scree_json_end(&json);
  }
  scree_json_maker(&json, command_line);
  scree_json_end(&json);
  return scree_json_commit(&json, error);
}

/* ---- CSV ---- */

static void csv_header(FILE *stream, const field *fields, int field_count, const char *prefix) {
  for (int i = 0; i < field_count; i++)
    for (int k = 0; k < fields[i].count; k++)
      if (fields[i].count == 1)
        fprintf(stream, ",%s%s", prefix, fields[i].name);
      else
        fprintf(stream, ",%s%s_%d", prefix, fields[i].name, k + 1);
}

static void csv_fields(FILE *stream, const scree_measure_entry *entry, const field *fields,
                       int field_count) {
  for (int i = 0; i < field_count; i++)
    for (int k = 0; k < fields[i].count; k++) {
      const void *value = value_of(entry, &fields[i]);
      putc(',', stream);
      if (!exists(entry, &fields[i])) continue;
      if (fields[i].kind == REAL)
        scree_csv_number(stream, ((const double *)value)[k]);
      else if (fields[i].kind == COUNT)
        fprintf(stream, "%zu", *(const size_t *)value);
      else if (fields[i].kind == SIGNED)
        fprintf(stream, "%lld", *(const long long *)value);
      else if (fields[i].kind == CLASS)
        fputs(scree_zingg_name(*(const scree_zingg *)value), stream);
      else
        fputs(*(const bool *)value ? "true" : "false", stream);
    }
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
