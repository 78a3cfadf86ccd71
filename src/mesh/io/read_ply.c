/* PLY (Turk 1994): a header that names elements and their properties in any order and type, then
 * their rows, as text or binary in either byte order. Used are x, y, z of `vertex`, the corners of
 * `face` (polygons are cut into triangles) and of `tristrips` (-1 ends a strip, every second
 * triangle of a strip is turned); all else is skipped. A row count is believed only if the file has
 * room for so many of the shortest rows.
 *
 * White space of any kind separates values of a text. Where that does not come out and a row has
 * more values on its line than the header tells of, the text is read again by lines. */
#include "mesh/io/read_ply.h"

#include "base/array.h"
#include "mesh/io/polygon.h"
#include "mesh/weld.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* Where the data is being read, for the next value and for errors. */
typedef struct ply {
  scree_ply_header header;
  scree_text text; /* p is the place of the next value, of binary data too */
  const scree_ply_element *element;
  size_t row;
  size_t vertex_count;
  double *positions;
  scree_index_list corners; /* of the row */
  scree_face_list faces;
  bool by_lines;        /* what follows a row on its line is left out */
  const char *overlong; /* the first row that has more on its line */
  char warning[160];    /* about it */
} ply;

static bool is_ascii(const ply *p) {
  return p->header.encoding == SCREE_PLY_ASCII;
}

/* Fails with the file, the line or byte, and the row before the sentence. */
static scree_status fail_at(const ply *p, const char *format, ...) SCREE_PRINTF(2, 3);

static scree_status fail_at(const ply *p, const char *format, ...) {
  char what[160];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(what, sizeof what, format, arguments);
  va_end(arguments);
  if (is_ascii(p))
    return scree_text_fail(&p->text, p->text.p, "%s %zu of %zu: %s", p->element->name, p->row + 1,
                           p->element->count, what);
  return scree_fail(p->text.error, SCREE_BAD_FILE, "%s: byte %td: %s %zu of %zu: %s", p->text.name,
                    p->text.p - p->text.begin, p->element->name, p->row + 1, p->element->count,
                    what);
}

/* ---- single values ---- */

static uint64_t load_bytes(const char *p, size_t size, bool big_endian) {
  uint64_t bits = 0;
  for (size_t i = 0; i < size; i++) {
    size_t shift = big_endian ? size - 1 - i : i;
    bits |= (uint64_t)(unsigned char)p[i] << 8 * shift;
  }
  return bits;
}

static double decode(const char *p, scree_ply_type type, bool big_endian) {
  float narrow;
  double wide;
  uint32_t bits32;
  uint64_t bits = load_bytes(p, scree_ply_type_size(type), big_endian);
  switch (type) {
  case SCREE_PLY_INT8:
    return (int8_t)bits;
  case SCREE_PLY_INT16:
    return (int16_t)bits;
  case SCREE_PLY_INT32:
    return (int32_t)bits;
  case SCREE_PLY_FLOAT32:
    bits32 = (uint32_t)bits;
    memcpy(&narrow, &bits32, sizeof narrow);
    return (double)narrow;
  case SCREE_PLY_FLOAT64:
    memcpy(&wide, &bits, sizeof wide);
    return wide;
  default:
    return (double)bits;
  }
}

/* The next value as a double, which holds every type exactly. */
static scree_status next_value(ply *p, scree_ply_type type, double *value) {
  scree_text *t = &p->text;
  if (is_ascii(p)) return scree_text_number(t, "a value", value);
  size_t size = scree_ply_type_size(type);
  if ((size_t)(t->end - t->p) < size) return fail_at(p, "the file is cut off here");
  *value = decode(t->p, type, p->header.encoding == SCREE_PLY_BIG_ENDIAN);
  t->p += size;
  return SCREE_OK;
}

/* nan, -nan(ind), inf, -Infinity, 1.#QNAN and their like: the C libraries' words. */
static bool is_no_finite_number(scree_token word) {
  if (word.length && (*word.begin == '-' || *word.begin == '+')) word.begin++, word.length--;
  if (word.length < 3) return false;
  word.length = 3;
  return scree_token_is(word, "nan") || scree_token_is(word, "inf") || scree_token_is(word, "1.#");
}

/* What is ignored may be any value of its type, in text as in binary. */
static scree_status skip_value(ply *p, scree_ply_type type) {
  double ignored;
  scree_text probe = p->text;
  if (!is_ascii(p) || !is_no_finite_number(scree_text_next(&probe)))
    return next_value(p, type, &ignored);
  p->text.p = probe.p;
  return SCREE_OK;
}

/* Where the next value begins, for errors about it. */
static const char *value_start(ply *p) {
  if (is_ascii(p)) scree_text_skip_space(&p->text);
  return p->text.p;
}

/* ---- rows ---- */

static const scree_ply_property *properties_of(const ply *p) {
  const scree_ply_property *all = p->header.properties.items;
  return all ? all + p->element->first_property : NULL; /* no element has any */
}

static scree_status read_coordinate(ply *p, const scree_ply_property *property) {
  double value = 0;
  const char *at = value_start(p);
  SCREE_TRY(next_value(p, property->type, &value));
  if (!(fabs(value * p->text.unit_m) <= SCREE_COORDINATE_LIMIT)) {
    p->text.p = at;
    return fail_at(p, "a coordinate is %g; it must be finite and at most 1e30 m in size", value);
  }
  p->positions[3 * p->row + property->role] = value;
  return SCREE_OK;
}

/* Adds a corner, or -1 in a strip, to the row's. */
static scree_status add_corner(ply *p, double value, const char *at) {
  bool restart = value == -1 && p->element->kind == SCREE_PLY_STRIPS;
  if (!restart && !(value >= 0 && value < (double)p->vertex_count && value == floor(value))) {
    p->text.p = at;
    return fail_at(p, "%g is not the number of a vertex: there are %zu, from 0 on", value,
                   p->vertex_count);
  }
  if (!SCREE_PUSH(&p->corners, restart ? UINT32_MAX : (uint32_t)value))
    return scree_fail_memory(p->text.error, p->corners.capacity * sizeof(uint32_t),
                             "a row of a PLY");
  return SCREE_OK;
}

static scree_status read_list(ply *p, const scree_ply_property *property) {
  double count = 0, value = 0;
  const char *at = value_start(p);
  SCREE_TRY(next_value(p, property->count_type, &count));
  size_t least = is_ascii(p) ? 2 : scree_ply_type_size(property->type);
  size_t room = (size_t)(p->text.end - p->text.p) / least + is_ascii(p);
  if (!(count >= 0 && count <= (double)room && count == floor(count))) {
    p->text.p = at;
    return fail_at(p, "a list of %.0f values does not fit the rest of the file", count);
  }
  p->corners.count = property->role == SCREE_PLY_CORNERS ? 0 : p->corners.count;
  for (size_t i = 0; i < (size_t)count; i++) {
    if (property->role != SCREE_PLY_CORNERS) {
      SCREE_TRY(skip_value(p, property->type));
      continue;
    }
    at = value_start(p);
    SCREE_TRY(next_value(p, property->type, &value));
    SCREE_TRY(add_corner(p, value, at));
  }
  return SCREE_OK;
}

static scree_status read_property(ply *p, const scree_ply_property *property) {
  if (property->is_list) return read_list(p, property);
  if (property->role <= SCREE_PLY_Z) return read_coordinate(p, property);
  return skip_value(p, property->type);
}

/* The strip's triangles; those between -1s, every second one turned. */
static bool add_strips(ply *p) {
  const uint32_t *c = p->corners.items;
  size_t start = 0;
  for (size_t i = 0; i < p->corners.count; i++) {
    if (c[i] == UINT32_MAX) {
      start = i + 1;
      continue;
    }
    if (i < start + 2) continue;
    bool turned = (i - start) % 2 == 1;
    uint32_t triangle[3] = {c[i - 2 + turned], c[i - 1 - turned], c[i]};
    if (!scree_face_list_add(&p->faces, triangle, 3)) return false;
  }
  return true;
}

static scree_status finish_row(ply *p) {
  bool added = true;
  if (p->element->kind == SCREE_PLY_FACE)
    added = scree_face_list_add(&p->faces, p->corners.items, p->corners.count);
  else if (p->element->kind == SCREE_PLY_STRIPS)
    added = add_strips(p);
  if (added) return SCREE_OK;
  return scree_fail_memory(p->text.error, p->faces.triangles.capacity * sizeof(uint32_t),
                           "the faces of a PLY");
}

/* ---- elements ---- */

static bool has_role(const ply *p, scree_ply_role role) {
  for (size_t i = 0; i < p->element->property_count; i++)
    if (properties_of(p)[i].role == role) return true;
  return false;
}

/* Whether the element has what scree needs of it, and the file has room for its rows. */
static scree_status check_element(const ply *p) {
  const scree_ply_element *e = p->element;
  bool complete = true;
  if (e->kind == SCREE_PLY_VERTEX)
    complete = has_role(p, SCREE_PLY_X) && has_role(p, SCREE_PLY_Y) && has_role(p, SCREE_PLY_Z);
  else if (e->kind != SCREE_PLY_OTHER)
    complete = has_role(p, SCREE_PLY_CORNERS);
  if (!complete)
    return scree_fail(p->text.error, SCREE_BAD_FILE, "%s: PLY header: element '%s' has no %s",
                      p->text.name, e->name,
                      e->kind == SCREE_PLY_VERTEX ? "x, y and z" : "list of vertex_indices");
  size_t least = 0;
  for (size_t i = 0; i < e->property_count; i++) {
    const scree_ply_property *property = &properties_of(p)[i];
    least += is_ascii(p)
                 ? 2
                 : scree_ply_type_size(property->is_list ? property->count_type : property->type);
  }
  size_t room = (size_t)(p->text.end - p->text.p) + is_ascii(p);
  if (least > 0 && e->count > room / least)
    return scree_fail(p->text.error, SCREE_BAD_FILE,
                      "%s: byte %td: the header says %zu of element '%s', at least %zu bytes each, "
                      "but only %td bytes follow: the file is cut off",
                      p->text.name, p->text.p - p->text.begin, e->count, e->name, least,
                      p->text.end - p->text.p);
  return SCREE_OK;
}

/* Whether a line ends between two places of a row. */
static bool spans_lines(const char *begin, const char *end) {
  return memchr(begin, '\n', (size_t)(end - begin)) || memchr(begin, '\r', (size_t)(end - begin));
}

/* Passes over what stands in a text on the row's line behind its values. */
static scree_status finish_line(ply *p, const char *begin) {
  scree_text *t = &p->text;
  const char *values_end = t->p;
  scree_text_skip_blanks(t);
  bool more = !scree_text_at_line_end(t);
  if (more && !p->overlong) {
    p->overlong = begin;
    snprintf(p->warning, sizeof p->warning,
             "%s %zu of %zu has more values on its line than the header tells of; the rest of such "
             "lines was left out",
             p->element->name, p->row + 1, p->element->count);
  }
  if (p->by_lines && spans_lines(begin, values_end)) {
    t->p = begin;
    return fail_at(p, "fewer values on this line than the header tells of, and others have more");
  }
  if (p->by_lines) scree_text_skip_line(t);
  return SCREE_OK;
}

static scree_status read_element(ply *p) {
  SCREE_TRY(check_element(p));
  if (p->element->kind == SCREE_PLY_VERTEX) {
    p->positions = scree_alloc(p->vertex_count, 3 * sizeof(double));
    if (!p->positions)
      return scree_fail_memory(p->text.error, p->vertex_count * 3 * sizeof(double),
                               "the vertices of a PLY");
  }
  const scree_ply_property *properties = properties_of(p);
  size_t row_count = p->element->property_count ? p->element->count : 0;
  for (p->row = 0; p->row < row_count; p->row++) {
    const char *begin = value_start(p);
    for (size_t i = 0; i < p->element->property_count; i++)
      SCREE_TRY(read_property(p, &properties[i]));
    SCREE_TRY(finish_row(p));
    if (is_ascii(p)) SCREE_TRY(finish_line(p, begin));
  }
  return SCREE_OK;
}

/* The number of vertices must be known before faces, wherever they stand. */
static scree_status find_vertices(ply *p) {
  for (size_t i = 0; i < p->header.elements.count; i++) {
    const scree_ply_element *e = &p->header.elements.items[i];
    if (e->kind != SCREE_PLY_VERTEX) continue;
    if (e->count >= UINT32_MAX - 1)
      return scree_fail(p->text.error, SCREE_LIMIT,
                        "%s: PLY header: %zu vertices, more than the limit of %u", p->text.name,
                        e->count, UINT32_MAX - 2);
    p->vertex_count = e->count;
    return SCREE_OK;
  }
  return scree_fail(p->text.error, SCREE_BAD_FILE, "%s: PLY header: no element 'vertex'",
                    p->text.name);
}

/* Refuses rows behind the last that the header tells of. A binary file may end with what is too
 * short for a triangle, as some are filled up. */
static scree_status check_end(ply *p) {
  enum { TRIANGLE_BYTES = 13 }; /* a count and three indices, as they mostly are */
  scree_text *t = &p->text;
  if (is_ascii(p)) {
    scree_text_skip_space(t);
    if (t->p == t->end) return SCREE_OK;
    return scree_text_fail(t, t->p,
                           "more follows the rows that the header tells of: a count is wrong");
  }
  if (t->end - t->p < TRIANGLE_BYTES) return SCREE_OK;
  return scree_fail(
      t->error, SCREE_BAD_FILE,
      "%s: byte %td: %td bytes follow the rows that the header tells of: a count is wrong", t->name,
      t->p - t->begin, t->end - t->p);
}

static const char *const format_names[] = {"PLY ASCII", "PLY binary little endian",
                                           "PLY binary big endian"};

static scree_status read_data(ply *p) {
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < p->header.elements.count && status == SCREE_OK; i++) {
    p->element = &p->header.elements.items[i];
    status = read_element(p);
  }
  return status == SCREE_OK ? check_end(p) : status;
}

static void forget_data(ply *p) {
  scree_free(p->positions);
  p->positions = NULL;
  scree_face_list_free(&p->faces);
}

scree_status scree_read_ply(scree_reading *r) {
  ply p = {.text = scree_reading_text(r)};
  scree_status status = scree_ply_header_read(&p.text, &p.header);
  if (status == SCREE_OK) status = find_vertices(&p);
  const char *data = p.text.p;
  if (status == SCREE_OK) status = read_data(&p);
  if (status == SCREE_BAD_FILE && p.overlong) {
    p.by_lines = true;
    p.text.p = data;
    forget_data(&p);
    status = read_data(&p);
    if (status == SCREE_OK && r->error) *r->error = (scree_error){.status = SCREE_OK};
    snprintf(r->scan->warning, sizeof r->scan->warning, "%s", p.warning);
  }
  snprintf(r->scan->format, sizeof r->scan->format, "%s", format_names[p.header.encoding]);
  if (status == SCREE_OK)
    status = scree_reading_weld_faces(r, p.positions, p.vertex_count, &p.faces);
  scree_ply_header_free(&p.header);
  scree_free(p.corners.items);
  forget_data(&p);
  return status;
}
