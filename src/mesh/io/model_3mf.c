#include "mesh/io/model_3mf.h"

#include "base/number.h"
#include "mesh/io/write.h"
#include "mesh/io/zip.h"

#include <expat.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <strings.h>

#define CORE       "http://schemas.microsoft.com/3dmanufacturing/core/"
#define PRODUCTION "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"

/* By the beginning of their namespaces. */
static const struct {
  const char *uri, *name;
  bool changes_shape;
} extensions[] = {
    {CORE, "core", false},
    {"http://schemas.microsoft.com/3dmanufacturing/production/", "production", false},
    {"http://schemas.microsoft.com/3dmanufacturing/material/", "materials", false},
    {"http://schemas.microsoft.com/3dmanufacturing/trianglesets/", "triangle sets", false},
    {"http://schemas.microsoft.com/3dmanufacturing/slice/", "slices", true},
    {"http://schemas.microsoft.com/3dmanufacturing/beamlattice/", "beam lattice", true},
    {"http://schemas.microsoft.com/3dmanufacturing/displacement/", "displacement", true},
    {"http://schemas.3mf.io/3dmanufacturing/displacement/", "displacement", true},
    {"http://schemas.microsoft.com/3dmanufacturing/securecontent/", "secure content", true},
    {"http://schemas.3mf.io/3dmanufacturing/booleanoperations/", "boolean operations", true},
    {"http://schemas.3mf.io/3dmanufacturing/volumetric/", "volumetric", true},
    {"http://schemas.3mf.io/3dmanufacturing/implicit/", "implicit", true}};
enum {
  EXTENSION_COUNT = sizeof extensions / sizeof *extensions,
  MOST_PARTS = 4096,
  MOST_OBJECTS = 1 << 16
};

/* EXTENSION_COUNT: unknown. */
static size_t extension_of(const char *uri) {
  size_t i = 0;
  while (i < EXTENSION_COUNT && strncmp(uri, extensions[i].uri, strlen(extensions[i].uri)) != 0)
    i++;
  return i;
}

static void stop(scree_3mf_parse *p, scree_status status, const char *format, ...)
    SCREE_PRINTF(3, 4);
static void stop(scree_3mf_parse *p, scree_status status, const char *format, ...) {
  char sentence[360];
  va_list arguments;
  if (p->status != SCREE_OK) return;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  p->status = scree_reading_fail(p->r, status, "as 3MF: %.100s: line %lu: %s", p->part_name,
                                 (unsigned long)XML_GetCurrentLineNumber(p->parser), sentence);
  XML_StopParser(p->parser, XML_FALSE);
}

void scree_3mf_stop_memory(scree_3mf_parse *p) {
  if (p->status == SCREE_OK) p->status = scree_fail_memory(p->r->error, 0, "the objects of a 3MF");
  XML_StopParser(p->parser, XML_FALSE);
}

const char *scree_3mf_attribute(const char **attributes, const char *name) {
  for (; *attributes; attributes += 2)
    if (!strcmp(attributes[0], name)) return attributes[1];
  return NULL;
}

uint32_t scree_3mf_id(const char *text) {
  uint64_t value = 0;
  for (; *text >= '0' && *text <= '9' && value <= UINT32_MAX; text++)
    value = 10 * value + (uint64_t)(*text - '0');
  return *text || value > UINT32_MAX ? 0 : (uint32_t)value;
}

scree_3mf_object *scree_3mf_find(scree_3mf *m, size_t part, uint32_t id) {
  for (size_t i = 0; i < m->objects.count; i++)
    if (m->objects.items[i].id == id && m->objects.items[i].part == part)
      return &m->objects.items[i];
  return NULL;
}

size_t scree_3mf_part_index(scree_3mf_parse *p, const char *path) {
  scree_3mf *m = p->model;
  scree_3mf_part part;
  path += *path == '/';
  for (size_t i = 0; i < m->parts.count; i++)
    if (!strcasecmp(m->parts.items[i].name, path)) return i;
  if (strlen(path) >= sizeof part.name || m->parts.count == MOST_PARTS) {
    stop(p, SCREE_LIMIT, "more than %d parts, or one with a path of %zu bytes", MOST_PARTS,
         strlen(path));
    return 0;
  }
  snprintf(part.name, sizeof part.name, "%s", path);
  if (!SCREE_PUSH(&m->parts, part)) {
    scree_3mf_stop_memory(p);
    return 0;
  }
  return m->parts.count - 1;
}

/* ---- A model's elements ---- */

/* The name of an element of the core, also where it has no namespace; NULL: of another. */
static const char *core_name(scree_3mf_parse *p, const char *name) {
  const char *local = strrchr(name, '|');
  if (!local) return name;
  size_t i = extension_of(name);
  if (i < EXTENSION_COUNT && extensions[i].changes_shape) p->model->unread = extensions[i].name;
  return i == 0 ? local + 1 : NULL;
}

static bool read_number(const char *text, double *value) {
  return text && scree_number_read(text, value);
}

/* Twelve numbers, by columns of ours. */
static bool read_placement(const char *text, scree_affine *where) {
  *where = scree_affine_none;
  if (!text) return true;
  const char *end = text + strlen(text);
  for (int i = 0; i < 12; i++) {
    while (*text == ' ' || *text == '\t' || *text == '\n' || *text == '\r') text++;
    text = scree_number_parse(text, end, &where->m[i % 3][i / 3]);
    if (!text || !isfinite(where->m[i % 3][i / 3])) return false;
  }
  while (*text == ' ' || *text == '\t' || *text == '\n' || *text == '\r') text++;
  return *text == 0;
}

static const char *uri_of_prefix(const scree_3mf_parse *p, const char *prefix, size_t length) {
  for (size_t i = p->prefixes.count; i-- > 0;)
    if (strlen(p->prefixes.items[i].name) == length &&
        !strncmp(p->prefixes.items[i].name, prefix, length))
      return p->prefixes.items[i].uri;
  return NULL;
}

static void check_required(scree_3mf_parse *p, const char *list) {
  static const char blanks[] = " \t\r\n";
  for (list += strspn(list, blanks); *list; list += strspn(list, blanks)) {
    size_t length = strcspn(list, blanks);
    const char *uri = uri_of_prefix(p, list, length);
    size_t i = uri ? extension_of(uri) : EXTENSION_COUNT;
    if (i == EXTENSION_COUNT)
      stop(p, SCREE_UNSUPPORTED, "the model requires the extension %.*s%s%s, which is not read",
           length < 60 ? (int)length : 60, list, uri ? ", " : "", uri ? uri : "");
    else if (extensions[i].changes_shape)
      stop(p, SCREE_UNSUPPORTED,
           "the model requires the extension '%s', which changes shapes and is not read",
           extensions[i].name);
    list += length;
  }
}

static void start_model(scree_3mf_parse *p, const char **attributes) {
  const char *unit = scree_3mf_attribute(attributes, "unit"),
             *required = scree_3mf_attribute(attributes, "requiredextensions");
  if (required) check_required(p, required);
  if (p->part != 0 || !unit) return;
  if (scree_3mf_unit_m(unit) > 0)
    snprintf(p->model->unit_name, sizeof p->model->unit_name, "%s", unit);
  else
    stop(p, SCREE_BAD_FILE,
         "the unit is '%.40s'; it should be micron, millimeter, centimeter, inch, foot or meter",
         unit);
}

static void start_object(scree_3mf_parse *p, const char **attributes) {
  scree_3mf *m = p->model;
  const char *id = scree_3mf_attribute(attributes, "id"),
             *type = scree_3mf_attribute(attributes, "type");
  scree_3mf_object o = {.id = id ? scree_3mf_id(id) : 0,
                        .part = p->part,
                        .first_vertex = m->vertices.count,
                        .first_triangle = m->triangles.count,
                        .first_component = m->components.count,
                        .is_support =
                            type && (!strcmp(type, "support") || !strcmp(type, "solidsupport"))};
  if (!SCREE_PUSH(&m->objects, o))
    scree_3mf_stop_memory(p);
  else if (m->objects.count > MOST_OBJECTS)
    stop(p, SCREE_LIMIT, "more than %d objects", MOST_OBJECTS);
}

static void start_vertex(scree_3mf_parse *p, scree_3mf_object *o, const char **attributes) {
  static const char *const axes[] = {"x", "y", "z"};
  for (int k = 0; k < 3; k++) {
    const char *text = scree_3mf_attribute(attributes, axes[k]);
    double value;
    if (!read_number(text, &value)) {
      stop(p, SCREE_BAD_FILE, "%s of a vertex is '%.40s'; it must be a number", axes[k],
           text ? text : "");
      return;
    }
    if (!SCREE_PUSH(&p->model->vertices, value)) {
      scree_3mf_stop_memory(p);
      return;
    }
  }
  o->vertex_count += 3;
}

static void start_triangle(scree_3mf_parse *p, scree_3mf_object *o, const char **attributes) {
  static const char *const corners[] = {"v1", "v2", "v3"};
  scree_3mf_triangle t = {.role = SCREE_3MF_SOLID};
  for (int c = 0; c < 3; c++) {
    double value;
    const char *text = scree_3mf_attribute(attributes, corners[c]);
    if (!read_number(text, &value) || !(value >= 0 && 3 * value < (double)o->vertex_count)) {
      stop(p, SCREE_BAD_FILE, "%s of a triangle is '%.40s'; the mesh has %zu vertices", corners[c],
           text ? text : "", o->vertex_count / 3);
      return;
    }
    t.corner[c] = (uint32_t)value;
  }
  if (!SCREE_PUSH(&p->model->triangles, t))
    scree_3mf_stop_memory(p);
  else
    o->triangle_count++;
}

/* A component of an object, or an item of the build. */
static void start_placed(scree_3mf_parse *p, scree_3mf_object *o, const char **attributes) {
  const char *id = scree_3mf_attribute(attributes, "objectid"),
             *path = scree_3mf_attribute(attributes, PRODUCTION "|path"),
             *transform = scree_3mf_attribute(attributes, "transform"),
             *printable = scree_3mf_attribute(attributes, "printable");
  scree_3mf_component c = {
      .object_id = id ? scree_3mf_id(id) : 0,
      .part = p->part,
      .is_unprinted = printable && (!strcmp(printable, "0") || !strcmp(printable, "false"))};
  if (!read_placement(transform, &c.where))
    stop(p, SCREE_BAD_FILE, "a transform is '%.60s'; it must be twelve numbers", transform);
  if (path) c.part = scree_3mf_part_index(p, path);
  if (p->status != SCREE_OK) return;
  bool is_kept = o ? SCREE_PUSH(&p->model->components, c) : SCREE_PUSH(&p->model->items, c);
  if (!is_kept)
    scree_3mf_stop_memory(p);
  else if (o)
    o->component_count++;
}

/* The object whose elements are read, or NULL. */
static scree_3mf_object *open_object(scree_3mf_parse *p) {
  scree_3mf *m = p->model;
  if (!m->objects.count || m->objects.items[m->objects.count - 1].part != p->part) return NULL;
  return &m->objects.items[m->objects.count - 1];
}

static void start_element(void *context, const char *name, const char **attributes) {
  scree_3mf_parse *p = context;
  const char *core = p->status == SCREE_OK ? core_name(p, name) : NULL;
  if (!core) return;
  scree_3mf_object *o = open_object(p);
  if (!strcmp(core, "model")) start_model(p, attributes);
  if (!strcmp(core, "object")) start_object(p, attributes);
  if (!strcmp(core, "vertex") && o) start_vertex(p, o, attributes);
  if (!strcmp(core, "triangle") && o) start_triangle(p, o, attributes);
  if (!strcmp(core, "component") && o) start_placed(p, o, attributes);
  if (!strcmp(core, "item") && p->part == 0) start_placed(p, NULL, attributes);
}

/* ---- Parsing ---- */

static void *expat_alloc(size_t size) {
  return scree_alloc(size, 1);
}
static void *expat_resize(void *block, size_t size) {
  return scree_resize(block, size, 1);
}

static void start_any(void *context, const char *name, const char **attributes) {
  scree_3mf_parse *p = context;
  p->start(p, name, attributes);
}

static void start_prefix(void *context, const char *prefix, const char *uri) {
  scree_3mf_parse *p = context;
  struct scree_3mf_prefix known = {0};
  enum { MOST_PREFIXES = 256 };
  if (!prefix || !uri || p->prefixes.count == MOST_PREFIXES) return;
  snprintf(known.name, sizeof known.name, "%s", prefix);
  snprintf(known.uri, sizeof known.uri, "%s", uri);
  if (!SCREE_PUSH(&p->prefixes, known)) scree_3mf_stop_memory(p);
}

static void start_doctype(void *context, const char *name, const char *system, const char *public,
                          int has_subset) {
  (void)name, (void)system, (void)public, (void)has_subset;
  stop(context, SCREE_BAD_FILE, "a DOCTYPE, which a 3MF must not have");
}

/* What a tag may hold: expat reads one that is not whole again with each piece. */
enum { MOST_TAG_BYTES = 1 << 20 };

static bool take_piece(void *context, const unsigned char *bytes, size_t count, bool is_last) {
  scree_3mf_parse *p = context;
  p->given += count;
  if (XML_Parse(p->parser, (const char *)bytes, (int)count, is_last) != XML_STATUS_ERROR) {
    uint64_t begun = (uint64_t)XML_GetCurrentByteIndex(p->parser);
    if (is_last || p->given - begun <= MOST_TAG_BYTES) return true;
    stop(p, SCREE_LIMIT, "a tag of more than %d bytes", MOST_TAG_BYTES);
    return false;
  }
  enum XML_Error code = XML_GetErrorCode(p->parser);
  if (p->status == SCREE_OK && code == XML_ERROR_NO_MEMORY) scree_3mf_stop_memory(p);
  stop(p, SCREE_BAD_FILE, "%s", XML_ErrorString(code));
  return false;
}

static scree_status parse_member(scree_reading *r, scree_3mf_parse *p,
                                 const scree_zip_member *member, bool has_namespaces) {
  static const XML_Memory_Handling_Suite memory = {expat_alloc, expat_resize, scree_free};
  p->r = r;
  p->given = 0;
  p->status = SCREE_OK;
  p->parser = XML_ParserCreate_MM(NULL, &memory, has_namespaces ? "|" : NULL);
  if (!p->parser) return scree_fail_memory(r->error, 0, "an XML parser");
  XML_SetUserData(p->parser, p);
  XML_SetElementHandler(p->parser, start_any, NULL);
  XML_SetStartDoctypeDeclHandler(p->parser, start_doctype);
  if (has_namespaces) XML_SetStartNamespaceDeclHandler(p->parser, start_prefix);
  scree_status status = scree_zip_stream(member, take_piece, p);
  if (status == SCREE_OUT_OF_MEMORY) scree_3mf_stop_memory(p);
  if (status != SCREE_OK && p->status == SCREE_OK)
    p->status = scree_reading_fail(r, SCREE_BAD_FILE, "as 3MF: %.200s: is damaged in the archive",
                                   p->part_name);
  XML_ParserFree(p->parser);
  scree_free(p->prefixes.items);
  return p->status;
}

static scree_status fail_part(scree_reading *r, const char *part, scree_zip_answer answer) {
  char first[SCREE_ZIP_NAME];
  scree_zip_first_name(r->bytes, r->byte_count, first);
  if (answer == SCREE_ZIP_METHOD)
    return scree_reading_fail(r, SCREE_UNSUPPORTED,
                              "as 3MF: %.200s is compressed by a method that is not read, or "
                              "encrypted; save it with deflate, as 3MF asks for",
                              part);
  if (answer == SCREE_ZIP_ABSENT && *first)
    return scree_reading_fail(
        r, SCREE_BAD_FILE,
        "is a zip archive with %.100s, and no 3MF: %.200s is not found; unpack it", first, part);
  return scree_reading_fail(r, SCREE_BAD_FILE,
                            "is a zip archive in which %.200s is not found: cut off, damaged, or "
                            "no 3MF",
                            part);
}

scree_status scree_3mf_parse_part(scree_reading *r, scree_3mf_parse *p, bool is_needed) {
  scree_zip_member member;
  scree_zip_answer answer = scree_zip_find(r->bytes, r->byte_count, p->part_name, &member);
  if (answer == SCREE_ZIP_FOUND) return parse_member(r, p, &member, is_needed);
  return is_needed ? fail_part(r, p->part_name, answer) : SCREE_OK;
}

scree_status scree_3mf_read_part(scree_reading *r, scree_3mf *m, size_t index) {
  char name[sizeof m->parts.items->name]; /* the list may move */
  memcpy(name, m->parts.items[index].name, sizeof name);
  scree_3mf_parse p = {.model = m, .start = start_element, .part_name = name, .part = index};
  return scree_3mf_parse_part(r, &p, true);
}

void scree_3mf_free(scree_3mf *m) {
  SCREE_FREE_ALL(m->parts.items, m->objects.items, m->components.items, m->items.items,
                 m->vertices.items, m->triangles.items, m->volumes.items);
  *m = (scree_3mf){0};
}
