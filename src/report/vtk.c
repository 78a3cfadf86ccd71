/* VTK XML PolyData with raw appended data: each array is a 64-bit byte count followed by its bytes,
 * at the offset that its element names. The byte order is stated, so nothing is swapped. */
#include "report/vtk.h"
#include "base/file.h"
#include "base/number.h"
#include "base/quote.h"
#include "report/json.h"

#include <math.h>
#include <string.h>
#include <strings.h>

static const struct {
  const char *name;
  size_t size;
} types[] = {{"Float64", 8}, {"Float32", 4}, {"Int64", 8}, {"UInt8", 1}, {"Int32", 4}};

enum { CHUNK = 4096 };

typedef struct writer {
  FILE *stream;
  uint64_t offset; /* of the next array in the appended data */
} writer;

/* Of a row's member; arrays and vec3 have several components. */
static scree_vtk_type type_of(const scree_field *f) {
  static const scree_vtk_type by_kind[] = {[SCREE_FIELD_REAL] = SCREE_VTK_FLOAT64,
                                           [SCREE_FIELD_SINGLE] = SCREE_VTK_FLOAT32,
                                           [SCREE_FIELD_WHOLE] = SCREE_VTK_INT64,
                                           [SCREE_FIELD_WORD] = SCREE_VTK_INT32,
                                           [SCREE_FIELD_BYTE] = SCREE_VTK_UINT8};
  return by_kind[f->kind];
}

static void declare(writer *w, const char *name, scree_vtk_type type, size_t components,
                    size_t count) {
  fprintf(w->stream, "        <DataArray type=\"%s\" Name=\"", types[type].name);
  scree_quote(w->stream, SCREE_QUOTE_XML, name);
  fprintf(w->stream, "\" NumberOfComponents=\"%zu\" format=\"appended\" offset=\"%llu\"/>\n",
          components, (unsigned long long)w->offset);
  w->offset += 8 + (uint64_t)types[type].size * components * count;
}

/* What stands over the points, or over the cells: arrays, and columns of rows where they do. */
typedef struct fields {
  const char *element;
  const scree_vtk_array *arrays;
  size_t array_count, count;
  const scree_vtk_rows *rows; /* NULL: none */
} fields;

static void declare_all(writer *w, const fields *f) {
  fprintf(w->stream, "      <%s>\n", f->element);
  for (size_t i = 0; i < f->array_count; i++)
    declare(w, f->arrays[i].name, f->arrays[i].type, f->arrays[i].component_count, f->count);
  for (size_t i = 0; f->rows && i < f->rows->member_count; i++) {
    const scree_field *m = &f->rows->members[i];
    declare(w, m->key, type_of(m), m->size / types[type_of(m)].size, f->count);
  }
  fprintf(w->stream, "      </%s>\n", f->element);
}

static void append(writer *w, const void *values, uint64_t byte_count) {
  fwrite(&byte_count, sizeof byte_count, 1, w->stream);
  fwrite(values, 1, byte_count, w->stream);
}

static void append_all(writer *w, const fields *f) {
  for (size_t i = 0; i < f->array_count; i++)
    append(w, f->arrays[i].values,
           (uint64_t)types[f->arrays[i].type].size * f->arrays[i].component_count * f->count);
  for (size_t i = 0; f->rows && i < f->rows->member_count; i++) {
    const scree_field *m = &f->rows->members[i];
    const char *at = scree_field_at(m, f->rows->rows);
    uint64_t byte_count = (uint64_t)m->size * f->count;
    fwrite(&byte_count, sizeof byte_count, 1, w->stream);
    for (size_t k = 0; k < f->count; k++, at += f->rows->row_bytes)
      fwrite(at, m->size, 1, w->stream);
  }
}

/* 64-bit indices of points: the corners of cells, or 1, 2, 3, ... times a step, less what is to be
 * taken off: where each cell ends; or, of step 1 less 1, the points themselves. */
static void append_indices(writer *w, const uint32_t *corners, size_t count, int64_t step,
                           int64_t less) {
  uint64_t byte_count = 8 * (uint64_t)count;
  int64_t chunk[CHUNK];
  fwrite(&byte_count, sizeof byte_count, 1, w->stream);
  for (size_t begin = 0; begin < count; begin += CHUNK) {
    size_t n = count - begin < CHUNK ? count - begin : CHUNK;
    for (size_t i = 0; i < n; i++)
      chunk[i] = corners ? (int64_t)corners[begin + i] : (int64_t)(begin + i + 1) * step - less;
    fwrite(chunk, sizeof *chunk, n, w->stream);
  }
}

typedef struct cells {
  const char *element; /* Verts, Lines or Polys */
  const uint32_t *corners;
  size_t count, size;
} cells;

static cells cells_of(const scree_vtk_data *data) {
  if (data->triangles) return (cells){"Polys", data->triangles, data->cell_count, 3};
  if (data->lines) return (cells){"Lines", data->lines, data->cell_count, 2};
  return (cells){"Verts", NULL, data->bare ? 0 : data->point_count, 1};
}

static void write_header(writer *w, const scree_vtk_data *data, const cells *c,
                         const fields both[2]) {
  const uint16_t one = 1;
  bool little = *(const uint8_t *)&one == 1;
  fprintf(w->stream,
          "<?xml version=\"1.0\"?>\n<!-- scree %s; lengths in metres -->\n"
          "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"%s\" header_type=\"UInt64\">\n"
          "  <PolyData>\n",
          scree_version(), little ? "LittleEndian" : "BigEndian");
  char time[SCREE_NUMBER_SIZE];
  scree_number_format(data->time, time);
  if (!isnan(data->time))
    fprintf(w->stream,
            "    <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" "
            "NumberOfTuples=\"1\" format=\"ascii\">%s</DataArray>\n    </FieldData>\n",
            time);
  const char *kinds[] = {"Verts", "Lines", "Strips", "Polys"};
  fprintf(w->stream, "    <Piece NumberOfPoints=\"%zu\"", data->point_count);
  for (int i = 0; i < 4; i++)
    fprintf(w->stream, " NumberOf%s=\"%zu\"", kinds[i],
            strcmp(kinds[i], c->element) ? 0 : c->count);
  fputs(">\n", w->stream);
  for (int i = 0; i < 2; i++) declare_all(w, &both[i]);
  fputs("      <Points>\n", w->stream);
  declare(w, "Points", data->points_single ? SCREE_VTK_FLOAT32 : SCREE_VTK_FLOAT64, 3,
          data->point_count);
  fprintf(w->stream, "      </Points>\n      <%s>\n", c->element);
  declare(w, "connectivity", SCREE_VTK_INT64, 1, c->size * c->count);
  declare(w, "offsets", SCREE_VTK_INT64, 1, c->count);
  fprintf(w->stream, "      </%s>\n    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">_",
          c->element);
}

scree_status scree_vtp_write_rows(const scree_vtk_data *data, const scree_vtk_rows *rows,
                                  const char *path, bool overwrite, scree_error *error) {
  scree_output output;
  if (isinf(data->time))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: the time is infinite", path);
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  writer w = {output.stream, 0};
  cells c = cells_of(data);
  bool of_points = rows && rows->of_points;
  const fields both[2] = {
      {"PointData", data->point_arrays, data->point_array_count, data->point_count,
       of_points ? rows : NULL},
      {"CellData", data->cell_arrays, data->cell_array_count, c.count, of_points ? NULL : rows}};
  write_header(&w, data, &c, both);
  for (int i = 0; i < 2; i++) append_all(&w, &both[i]);
  if (data->points_single)
    append(&w, data->points_single, 12 * (uint64_t)data->point_count);
  else
    append(&w, data->points, 24 * (uint64_t)data->point_count);
  append_indices(&w, c.corners, c.size * c.count, 1, 1);
  append_indices(&w, NULL, c.count, (int64_t)c.size, 0);
  fputs("\n  </AppendedData>\n</VTKFile>\n", w.stream);
  return scree_output_commit(&output, error);
}

scree_status scree_vtp_write(const scree_vtk_data *data, const char *path, bool overwrite,
                             scree_error *error) {
  return scree_vtp_write_rows(data, NULL, path, overwrite, error);
}

/* ParaView's file series 1.0: names and times as JSON. */
static void write_series(FILE *stream, const char *const *files, const double *times,
                         size_t file_count) {
  scree_json json = scree_json_start(stream);
  scree_json_object(&json, NULL);
  scree_json_text(&json, "file-series-version", "1.0");
  SCREE_JSON_LIST (&json, "files", i, file_count) {
    SCREE_JSON_ROW(&json, NULL, AS("name", files[i]), AS("time", times[i]));
  }
  scree_json_end(&json);
}

static void write_collection(FILE *stream, const char *const *files, const double *times,
                             size_t file_count) {
  fprintf(stream,
          "<?xml version=\"1.0\"?>\n<!-- scree %s -->\n"
          "<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n",
          scree_version());
  for (size_t i = 0; i < file_count; i++) {
    char time[SCREE_NUMBER_SIZE];
    scree_number_format(times[i], time);
    fprintf(stream, "    <DataSet timestep=\"%s\" file=\"", time);
    scree_quote(stream, SCREE_QUOTE_XML, files[i]);
    fputs("\"/>\n", stream);
  }
  fputs("  </Collection>\n</VTKFile>\n", stream);
}

scree_status scree_pvd_write(const char *const *files, const double *times, size_t file_count,
                             const char *path, bool overwrite, scree_error *error) {
  scree_output output;
  for (size_t i = 0; i < file_count; i++)
    if (!isfinite(times[i]))
      return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: time %zu of %zu is no finite number", path,
                        i + 1, file_count);
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  const char *ending = strrchr(path, '.');
  if (ending && !strcasecmp(ending, ".series"))
    write_series(output.stream, files, times, file_count);
  else
    write_collection(output.stream, files, times, file_count);
  return scree_output_commit(&output, error);
}
