/* VTK XML PolyData with raw appended data: each array is a 64-bit byte count followed by its bytes,
 * at the offset that its element names. The byte order is stated, so nothing is swapped. */
#include "base/file.h"
#include "base/number.h"
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

static void write_escaped(FILE *stream, const char *text) {
  for (; *text; text++) {
    switch (*text) {
    case '&':
      fputs("&amp;", stream);
      break;
    case '<':
      fputs("&lt;", stream);
      break;
    case '>':
      fputs("&gt;", stream);
      break;
    case '"':
      fputs("&quot;", stream);
      break;
    default:
      if ((unsigned char)*text >= 32) fputc(*text, stream);
    }
  }
}

static void declare(writer *w, const char *name, scree_vtk_type type, size_t components,
                    size_t count) {
  fprintf(w->stream, "        <DataArray type=\"%s\" Name=\"", types[type].name);
  write_escaped(w->stream, name);
  fprintf(w->stream, "\" NumberOfComponents=\"%zu\" format=\"appended\" offset=\"%llu\"/>\n",
          components, (unsigned long long)w->offset);
  w->offset += 8 + (uint64_t)types[type].size * components * count;
}

static void declare_all(writer *w, const char *element, const scree_vtk_array *arrays,
                        size_t array_count, size_t count) {
  fprintf(w->stream, "      <%s>\n", element);
  for (size_t i = 0; i < array_count; i++)
    declare(w, arrays[i].name, arrays[i].type, arrays[i].component_count, count);
  fprintf(w->stream, "      </%s>\n", element);
}

static void append(writer *w, const void *values, uint64_t byte_count) {
  fwrite(&byte_count, sizeof byte_count, 1, w->stream);
  fwrite(values, 1, byte_count, w->stream);
}

static void append_all(writer *w, const scree_vtk_array *arrays, size_t array_count, size_t count) {
  for (size_t i = 0; i < array_count; i++)
    append(w, arrays[i].values,
           (uint64_t)types[arrays[i].type].size * arrays[i].component_count * count);
}

/* The corners of the cells as 64-bit indices; NULL corners stand for 0, 1, 2, ... */
static void append_connectivity(writer *w, const uint32_t *corners, size_t count) {
  uint64_t byte_count = 8 * (uint64_t)count;
  int64_t chunk[CHUNK];
  fwrite(&byte_count, sizeof byte_count, 1, w->stream);
  for (size_t begin = 0; begin < count; begin += CHUNK) {
    size_t n = count - begin < CHUNK ? count - begin : CHUNK;
    for (size_t i = 0; i < n; i++) chunk[i] = corners ? corners[begin + i] : (int64_t)(begin + i);
    fwrite(chunk, sizeof *chunk, n, w->stream);
  }
}

/* Where each cell ends: step, 2 step, 3 step, ... */
static void append_offsets(writer *w, size_t count, size_t step) {
  uint64_t byte_count = 8 * (uint64_t)count;
  int64_t chunk[CHUNK];
  fwrite(&byte_count, sizeof byte_count, 1, w->stream);
  for (size_t begin = 0; begin < count; begin += CHUNK) {
    size_t n = count - begin < CHUNK ? count - begin : CHUNK;
    for (size_t i = 0; i < n; i++) chunk[i] = (int64_t)((begin + i + 1) * step);
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

static void write_header(writer *w, const scree_vtk_data *data, const cells *c) {
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
  declare_all(w, "PointData", data->point_arrays, data->point_array_count, data->point_count);
  declare_all(w, "CellData", data->cell_arrays, data->cell_array_count, c->count);
  fputs("      <Points>\n", w->stream);
  declare(w, "Points", data->points_single ? SCREE_VTK_FLOAT32 : SCREE_VTK_FLOAT64, 3,
          data->point_count);
  fprintf(w->stream, "      </Points>\n      <%s>\n", c->element);
  declare(w, "connectivity", SCREE_VTK_INT64, 1, c->size * c->count);
  declare(w, "offsets", SCREE_VTK_INT64, 1, c->count);
  fprintf(w->stream, "      </%s>\n    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">_",
          c->element);
}

scree_status scree_vtp_write(const scree_vtk_data *data, const char *path, bool overwrite,
                             scree_error *error) {
  scree_output output;
  if (isinf(data->time))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: the time is infinite", path);
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  writer w = {output.stream, 0};
  cells c = cells_of(data);
  write_header(&w, data, &c);
  append_all(&w, data->point_arrays, data->point_array_count, data->point_count);
  append_all(&w, data->cell_arrays, data->cell_array_count, c.count);
  if (data->points_single)
    append(&w, data->points_single, 12 * (uint64_t)data->point_count);
  else
    append(&w, data->points, 24 * (uint64_t)data->point_count);
  append_connectivity(&w, c.corners, c.size * c.count);
  append_offsets(&w, c.count, c.size);
  fputs("\n  </AppendedData>\n</VTKFile>\n", w.stream);
  return scree_output_commit(&output, error);
}

/* ParaView's file series 1.0: names and times as JSON. */
static void write_series(FILE *stream, const char *const *files, const double *times,
                         size_t file_count) {
  scree_json json = scree_json_start(stream);
  scree_json_object(&json, NULL);
  scree_json_text(&json, "file-series-version", "1.0");
  scree_json_array(&json, "files");
  for (size_t i = 0; i < file_count; i++) {
    scree_json_row_object(&json, NULL);
    scree_json_text(&json, "name", files[i]);
    scree_json_number(&json, "time", times[i]);
    scree_json_end(&json);
  }
  scree_json_end(&json);
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
    write_escaped(stream, files[i]);
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
