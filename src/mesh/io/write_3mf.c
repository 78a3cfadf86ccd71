/* A 3MF (3MF Core Specification 1.3): a zip archive of three XML parts, the model among them.
 *
 * The parts are stored, not compressed. A zip says the length and the
 * CRC-32 of a member before its bytes, so each part is made twice: once to be counted, once to be
 * written; the stream need not be one that goes back. */
#include "mesh/io/write.h"

#include "base/number.h"
#include "base/quote.h"

#include <math.h>
#include <string.h>
#include <zlib.h>

enum {
  PART_COUNT = 3,
  VERSION_NEEDED = 20,
  FIRST_OF_1980 = 33,
  LOCAL_BYTES = 30,
  ENTRY_BYTES = 46
};

/* Where a part goes: to the stream, or nowhere but into the count. */
typedef struct sink {
  FILE *stream; /* NULL: count only */
  uint32_t crc;
  size_t count;
} sink;

typedef struct part {
  const char *name;
  void (*make)(sink *out, const scree_writing *w);
  uint32_t crc;
  size_t count, start;
} part;

static void put(sink *out, const char *text) {
  size_t length = strlen(text);
  if (out->stream) {
    fwrite(text, 1, length, out->stream);
    return;
  }
  out->crc = (uint32_t)crc32(out->crc, (const unsigned char *)text, (unsigned)length);
  out->count += length;
}

/* ---- The parts ---- */

static void put_types(sink *out, const scree_writing *w) {
  (void)w;
  put(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
           "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
           "<Default Extension=\"rels\" "
           "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
           "<Default Extension=\"model\" "
           "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n"
           "</Types>\n");
}

static void put_relations(sink *out, const scree_writing *w) {
  (void)w;
  put(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
           "<Relationships "
           "xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
           "<Relationship Target=\"/3D/3dmodel.model\" Id=\"model\" "
           "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n"
           "</Relationships>\n");
}

/* Units that a 3MF may name (3MF Core 1.3, 3.4). */
static const struct {
  const char *name;
  double unit_m;
} units[] = {{"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
             {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1}};
enum { UNIT_COUNT = sizeof units / sizeof *units };

double scree_3mf_unit_m(const char *name) {
  for (size_t i = 0; i < UNIT_COUNT; i++)
    if (!strcmp(units[i].name, name)) return units[i].unit_m;
  return 0;
}

const char *scree_3mf_unit(double *unit_m) {
  for (size_t i = 0; i < UNIT_COUNT; i++)
    if (fabs(*unit_m / units[i].unit_m - 1) < 1e-12) return units[i].name;
  *unit_m = 1;
  return "meter";
}

static void put_vertices(sink *out, const scree_writing *w) {
  for (size_t v = 0; v < w->mesh->vertex_count; v++) {
    vec3 p = scree_writing_position(w, (uint32_t)v);
    char x[SCREE_NUMBER_SIZE], y[SCREE_NUMBER_SIZE], z[SCREE_NUMBER_SIZE], line[128];
    scree_number_format(p.x, x);
    scree_number_format(p.y, y);
    scree_number_format(p.z, z);
    snprintf(line, sizeof line, "<vertex x=\"%s\" y=\"%s\" z=\"%s\"/>\n", x, y, z);
    put(out, line);
  }
}

static void put_model(sink *out, const scree_writing *w) {
  double unit_m = w->unit_m;
  char provenance[6 * SCREE_PROVENANCE_SIZE];
  put(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"");
  put(out, scree_3mf_unit(&unit_m));
  put(out, "\" xml:lang=\"en\" "
           "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
           "<metadata name=\"Application\">");
  put(out, scree_quote_text(SCREE_QUOTE_XML, w->provenance, provenance, sizeof provenance));
  put(out, "</metadata>\n<resources>\n<object id=\"1\" type=\"model\">\n<mesh>\n<vertices>\n");
  put_vertices(out, w);
  put(out, "</vertices>\n<triangles>\n");
  for (size_t t = 0; t < w->mesh->triangle_count; t++) {
    const uint32_t *v = w->mesh->triangles + 3 * t;
    char line[96];
    snprintf(line, sizeof line, "<triangle v1=\"%u\" v2=\"%u\" v3=\"%u\"/>\n", v[0], v[1], v[2]);
    put(out, line);
  }
  put(out, "</triangles>\n</mesh>\n</object>\n</resources>\n<build>\n<item objectid=\"1\"/>\n"
           "</build>\n</model>\n");
}

/* ---- The archive (PKWARE APPNOTE 4.3) ---- */

static void put_number(FILE *stream, size_t value, int byte_count) {
  for (int i = 0; i < byte_count; i++, value >>= 8) fputc((int)(value & 255), stream);
}

/* What local headers and entries of the directory share, from the version needed on. */
static void put_member(FILE *stream, const part *p) {
  put_number(stream, VERSION_NEEDED, 2);
  put_number(stream, 0, 2); /* flags */
  put_number(stream, 0, 2); /* stored */
  put_number(stream, 0, 2); /* time */
  put_number(stream, FIRST_OF_1980, 2);
  put_number(stream, p->crc, 4);
  put_number(stream, p->count, 4);
  put_number(stream, p->count, 4);
  put_number(stream, strlen(p->name), 2);
  put_number(stream, 0, 2); /* extra field */
}

static void put_entry(FILE *stream, const part *p) {
  fputs("PK\1\2", stream);
  put_number(stream, VERSION_NEEDED, 2);
  put_member(stream, p);
  put_number(stream, 0, 10); /* comment, disk, attributes */
  put_number(stream, p->start, 4);
  fputs(p->name, stream);
}

void scree_write_3mf(const scree_writing *w) {
  part parts[PART_COUNT] = {{.name = "[Content_Types].xml", .make = put_types},
                            {.name = "_rels/.rels", .make = put_relations},
                            {.name = "3D/3dmodel.model", .make = put_model}};
  size_t at = 0, directory = 0;
  for (int i = 0; i < PART_COUNT; i++) {
    part *p = &parts[i];
    sink counted = {0}, written = {.stream = w->stream};
    p->make(&counted, w);
    p->crc = counted.crc, p->count = counted.count, p->start = at;
    fputs("PK\3\4", w->stream);
    put_member(w->stream, p);
    fputs(p->name, w->stream);
    p->make(&written, w);
    at += LOCAL_BYTES + strlen(p->name) + p->count;
    directory += ENTRY_BYTES + strlen(p->name);
  }
  for (int i = 0; i < PART_COUNT; i++) put_entry(w->stream, &parts[i]);
  fputs("PK\5\6", w->stream);
  put_number(w->stream, 0, 4); /* disks */
  put_number(w->stream, PART_COUNT, 2);
  put_number(w->stream, PART_COUNT, 2);
  put_number(w->stream, directory, 4);
  put_number(w->stream, at, 4);
  put_number(w->stream, 0, 2); /* comment */
}
