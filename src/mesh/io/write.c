/* Writers. Each puts the version and one line of provenance where its format has room, and goes
 * through scree_output, so that a file appears whole or not at all. Text numbers are the shortest
 * that read back to the same bits. */
#include "mesh/io/write.h"

#include "base/file.h"
#include "base/number.h"
#include "base/quote.h"
#include "mesh/weld.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <strings.h>

enum { STL_HEADER_BYTES = 80, STL_FACET_BYTES = 50, PLY_FACE_BYTES = 13 };

scree_write_options scree_default_write_options(void) {
  return (scree_write_options){.format = SCREE_FORMAT_AUTO, .unit_m = 1e-3};
}

static const struct {
  const char *name, *extension; /* AUTO picks the first with the path's extension */
} formats[SCREE_FILE_FORMAT_COUNT] = {
    [SCREE_FORMAT_AUTO] = {"auto", NULL},           [SCREE_FORMAT_STL] = {"stl", ".stl"},
    [SCREE_FORMAT_STL_ASCII] = {"stl-ascii", NULL}, [SCREE_FORMAT_PLY] = {"ply", ".ply"},
    [SCREE_FORMAT_PLY_FLOAT] = {"ply-float", NULL}, [SCREE_FORMAT_OBJ] = {"obj", ".obj"},
    [SCREE_FORMAT_OFF] = {"off", ".off"},           [SCREE_FORMAT_3MF] = {"3mf", ".3mf"},
};

const char *scree_file_format_name(scree_file_format format) {
  return (unsigned)format < SCREE_FILE_FORMAT_COUNT ? formats[format].name : "unknown";
}

scree_file_format scree_file_format_of(const char *path) {
  size_t length = strlen(path);
  for (int f = 1; f < SCREE_FILE_FORMAT_COUNT; f++) {
    size_t tail = formats[f].extension ? strlen(formats[f].extension) : SIZE_MAX;
    if (tail < length && !strcasecmp(path + length - tail, formats[f].extension))
      return (scree_file_format)f;
  }
  return SCREE_FORMAT_AUTO;
}

/* Bytes on their way to the stream: a call of fwrite for each facet would cost more than the facet.
 */
typedef struct batch {
  FILE *stream;
  size_t count;
  unsigned char bytes[1 << 14];
} batch;

static void batch_flush(batch *b) {
  fwrite(b->bytes, 1, b->count, b->stream);
  b->count = 0;
}

/* Where the next `count` bytes go. */
static unsigned char *batch_take(batch *b, size_t count) {
  if (b->count + count > sizeof b->bytes) batch_flush(b);
  unsigned char *out = b->bytes + b->count;
  b->count += count;
  return out;
}

static unsigned char *put_u32(unsigned char *out, uint32_t value) {
  for (int i = 0; i < 4; i++) *out++ = (unsigned char)(value >> 8 * i);
  return out;
}

static unsigned char *put_float(unsigned char *out, double value) {
  float narrow = (float)value;
  uint32_t bits;
  memcpy(&bits, &narrow, sizeof bits);
  return put_u32(out, bits);
}

static unsigned char *put_double(unsigned char *out, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return put_u32(put_u32(out, (uint32_t)bits), (uint32_t)(bits >> 32));
}

static unsigned char *put_float_vec3(unsigned char *out, vec3 v) {
  return put_float(put_float(put_float(out, v.x), v.y), v.z);
}

/* " x y z\n", as floats or doubles. */
static void print_vec3(FILE *stream, vec3 v, bool narrow) {
  double x[3] = {v.x, v.y, v.z};
  for (int i = 0; i < 3; i++) {
    char text[SCREE_NUMBER_SIZE];
    if (narrow)
      scree_number_format_float((float)x[i], text);
    else
      scree_number_format(x[i], text);
    fputc(' ', stream);
    fputs(text, stream);
  }
  fputc('\n', stream);
}

/* Corner positions of triangle t in file units, and its unit normal; zero where it has none. */
static vec3 facet_of(const scree_writing *w, size_t t, vec3 corners[3]) {
  for (size_t k = 0; k < 3; k++)
    corners[k] = scree_writing_position(w, w->mesh->triangles[3 * t + k]);
  vec3 u = vec3_sub(corners[1], corners[0]), v = vec3_sub(corners[2], corners[0]);
  /* unit edges first: the product of tiny ones would underflow */
  return vec3_unit(vec3_cross(vec3_unit(u), vec3_unit(v)));
}

static void write_stl(const scree_writing *w) {
  unsigned char header[STL_HEADER_BYTES + 4] = {0};
  batch b = {.stream = w->stream};
  size_t length = strlen(w->provenance);
  memcpy(header, w->provenance, length < STL_HEADER_BYTES ? length : STL_HEADER_BYTES);
  put_u32(header + STL_HEADER_BYTES, (uint32_t)w->mesh->triangle_count);
  fwrite(header, 1, sizeof header, w->stream);
  for (size_t t = 0; t < w->mesh->triangle_count; t++) {
    vec3 corners[3], normal = facet_of(w, t, corners);
    unsigned char *out = put_float_vec3(batch_take(&b, STL_FACET_BYTES), normal);
    for (int k = 0; k < 3; k++) out = put_float_vec3(out, corners[k]);
    out[0] = out[1] = 0; /* attribute bytes */
  }
  batch_flush(&b);
}

static void write_stl_ascii(const scree_writing *w) {
  fprintf(w->stream, "solid %s\n", w->provenance);
  for (size_t t = 0; t < w->mesh->triangle_count; t++) {
    vec3 corners[3], normal = facet_of(w, t, corners);
    fputs("facet normal", w->stream);
    print_vec3(w->stream, normal, true);
    fputs("outer loop\n", w->stream);
    for (int k = 0; k < 3; k++) {
      fputs("vertex", w->stream);
      print_vec3(w->stream, corners[k], false);
    }
    fputs("endloop\nendfacet\n", w->stream);
  }
  fputs("endsolid\n", w->stream);
}

static void write_ply(const scree_writing *w, bool narrow) {
  const char *type = narrow ? "float" : "double";
  fprintf(w->stream,
          "ply\nformat binary_little_endian 1.0\ncomment %s\nelement vertex %zu\n"
          "property %s x\nproperty %s y\nproperty %s z\nelement face %zu\n"
          "property list uchar int vertex_indices\nend_header\n",
          w->provenance, w->mesh->vertex_count, type, type, type, w->mesh->triangle_count);
  batch b = {.stream = w->stream};
  for (size_t v = 0; v < w->mesh->vertex_count; v++) {
    vec3 p = scree_writing_position(w, (uint32_t)v);
    if (narrow)
      put_float_vec3(batch_take(&b, 12), p);
    else
      put_double(put_double(put_double(batch_take(&b, 24), p.x), p.y), p.z);
  }
  for (size_t t = 0; t < w->mesh->triangle_count; t++) {
    unsigned char *out = batch_take(&b, PLY_FACE_BYTES);
    *out++ = 3;
    for (size_t k = 0; k < 3; k++) out = put_u32(out, w->mesh->triangles[3 * t + k]);
  }
  batch_flush(&b);
}

static void write_obj(const scree_writing *w) {
  fprintf(w->stream, "# %s\n", w->provenance);
  for (size_t v = 0; v < w->mesh->vertex_count; v++) {
    fputc('v', w->stream);
    print_vec3(w->stream, scree_writing_position(w, (uint32_t)v), false);
  }
  for (size_t t = 0; t < w->mesh->triangle_count; t++) {
    const uint32_t *v = w->mesh->triangles + 3 * t;
    fprintf(w->stream, "f %llu %llu %llu\n", v[0] + 1ULL, v[1] + 1ULL, v[2] + 1ULL);
  }
}

static void write_off(const scree_writing *w) {
  fprintf(w->stream, "OFF\n# %s\n%zu %zu 0\n", w->provenance, w->mesh->vertex_count,
          w->mesh->triangle_count);
  for (size_t v = 0; v < w->mesh->vertex_count; v++)
    print_vec3(w->stream, scree_writing_position(w, (uint32_t)v), false);
  for (size_t t = 0; t < w->mesh->triangle_count; t++) {
    const uint32_t *v = w->mesh->triangles + 3 * t;
    fprintf(w->stream, "3 %u %u %u\n", v[0], v[1], v[2]);
  }
}

static scree_status find_format(const char *path, scree_file_format *format, scree_error *error) {
  if ((unsigned)*format >= SCREE_FILE_FORMAT_COUNT)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: format number %d is unknown", path,
                      (int)*format);
  if (*format == SCREE_FORMAT_AUTO) *format = scree_file_format_of(path);
  if (*format != SCREE_FORMAT_AUTO) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "%s: no format given, and the name does not end in .stl, .ply, .obj, .off or "
                    ".3mf",
                    strcmp(path, "-") != 0 ? path : "standard output");
}

static size_t count_limit_of(scree_file_format format) {
  switch (format) {
  case SCREE_FORMAT_OFF:
  case SCREE_FORMAT_OBJ:
    return SIZE_MAX;
  case SCREE_FORMAT_STL:
    return UINT32_MAX;
  case SCREE_FORMAT_3MF:
    return SCREE_3MF_LIMIT;
  default:
    return INT32_MAX;
  }
}

/* Whether the mesh and the options can be written in this format at all. */
static scree_status check_mesh(const scree_mesh *mesh, const char *path,
                               const scree_write_options *o, scree_error *error) {
  if (!(o->unit_m >= 1e-12 && o->unit_m <= 1e12))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the unit is %g m; it must lie in [1e-12, 1e12] m",
                      o->unit_m);
  bool narrow = o->format == SCREE_FORMAT_STL || o->format == SCREE_FORMAT_PLY_FLOAT;
  double limit = narrow ? (double)FLT_MAX * o->unit_m : SCREE_COORDINATE_LIMIT;
  if (limit > SCREE_COORDINATE_LIMIT) limit = SCREE_COORDINATE_LIMIT;
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    if (!(fabs(mesh->positions[i]) <= limit))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "%s: vertex %zu has a coordinate of %g m; at most %g m can be written",
                        path, i / 3, mesh->positions[i], limit);
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
    if (mesh->triangles[i] >= mesh->vertex_count)
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "%s: triangle %zu has vertex %u, but there are %zu vertices", path, i / 3,
                        mesh->triangles[i], mesh->vertex_count);
  size_t count_limit = count_limit_of(o->format);
  if (mesh->triangle_count > count_limit || mesh->vertex_count > count_limit)
    return scree_fail(error, SCREE_LIMIT, "%s: %zu triangles, more than the format's limit of %zu",
                      path, mesh->triangle_count, count_limit);
  return SCREE_OK;
}

void scree_provenance_text(double unit_m, const char *comment, char text[SCREE_PROVENANCE_SIZE]) {
  char unit[SCREE_NUMBER_SIZE], made[SCREE_PROVENANCE_SIZE];
  scree_number_format(unit_m, unit);
  snprintf(made, sizeof made, "scree %s, unit %s m%s%s", scree_version(), unit, comment ? "; " : "",
           comment ? comment : "");
  scree_quote_text(SCREE_QUOTE_COMMENT, made, text, SCREE_PROVENANCE_SIZE);
}

double scree_provenance_unit(const char *begin, const char *end) {
  static const char name[] = "scree ", unit[] = " unit ";
  const size_t name_length = sizeof name - 1, unit_length = sizeof unit - 1;
  double value = 0;
  if ((size_t)(end - begin) < name_length || memcmp(begin, name, name_length) != 0) return 0;
  const char *comma = memchr(begin, ',', (size_t)(end - begin));
  if (!comma || (size_t)(end - comma) <= unit_length || memcmp(comma + 1, unit, unit_length) != 0)
    return 0;
  const char *behind = scree_number_parse(comma + 1 + unit_length, end, &value);
  bool whole = behind && end - behind >= 2 && behind[0] == ' ' && behind[1] == 'm';
  return whole && value >= 1e-12 && value <= 1e12 ? value : 0;
}

static void write_body(const scree_writing *w, scree_file_format format) {
  switch (format) {
  case SCREE_FORMAT_STL:
    write_stl(w);
    break;
  case SCREE_FORMAT_STL_ASCII:
    write_stl_ascii(w);
    break;
  case SCREE_FORMAT_PLY:
  case SCREE_FORMAT_PLY_FLOAT:
    write_ply(w, format == SCREE_FORMAT_PLY_FLOAT);
    break;
  case SCREE_FORMAT_OBJ:
    write_obj(w);
    break;
  case SCREE_FORMAT_3MF:
    scree_write_3mf(w);
    break;
  default:
    write_off(w);
    break;
  }
}

scree_status scree_mesh_write(const scree_mesh *mesh, const char *path,
                              const scree_write_options *options, scree_error *error) {
  scree_write_options used = options ? *options : scree_default_write_options();
  scree_status status = find_format(path, &used.format, error);
  if (status == SCREE_OK) status = check_mesh(mesh, path, &used, error);
  scree_output output;
  if (status == SCREE_OK) status = scree_output_open(path, used.overwrite, &output, error);
  if (status != SCREE_OK) return status;
  if (used.format == SCREE_FORMAT_3MF) scree_3mf_unit(&used.unit_m);
  scree_writing w = {.mesh = mesh, .stream = output.stream, .unit_m = used.unit_m};
  scree_provenance_text(w.unit_m, used.comment, w.provenance);
  write_body(&w, used.format);
  return scree_output_commit(&output, error);
}
