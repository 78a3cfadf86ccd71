/* Which reader a file needs is decided by its content alone.
 *
 * Marks that cannot be mistaken come first. Then binary STL, which has no mark: a file whose length
 * is what bytes 80 to 83 say is one, whatever its header says; text that begins with `solid` is
 * ASCII STL if its start is free of control characters, which a binary count and floats are not. */
#include "mesh/io/read.h"

#include <string.h>

enum {
  MOST_DAMAGE = 20 /* bytes of text for each that is none, in a damaged one */
};
#define FBX_MARK "Kaydara FBX Binary"

scree_read_options scree_default_read_options(void) {
  return (scree_read_options){.unit_m = 1e-3};
}

void scree_scan_free(scree_scan *scan) {
  if (!scan) return;
  scree_mesh_free(&scan->mesh);
  *scan = (scree_scan){0};
}

/* ---- sniffing ---- */

typedef struct mark {
  const char *bytes;
  size_t length;
  const char *advice;
} mark;

/* Files that are certainly no mesh scree reads, by how they begin. */
static const mark foreign_marks[] = {
    {"\x1f\x8b", 2, "is compressed with gzip; decompress it first"},
    {"BZh", 3, "is compressed with bzip2; decompress it first"},
    {"\xfd"
     "7zXZ",
     5, "is compressed with xz; decompress it first"},
    {"\x28\xb5\x2f\xfd", 4, "is compressed with zstd; decompress it first"},
    {"7z\xbc\xaf", 4, "is a 7z archive; unpack it first"},
    {"Rar!", 4, "is a RAR archive; unpack it first"},
    {"\x89PNG", 4, "is a PNG picture, not a mesh"},
    {"\xff\xd8\xff", 3, "is a JPEG picture, not a mesh"},
    {"%PDF", 4, "is a PDF document, not a mesh"},
    {"\x7f"
     "ELF",
     4, "is a program, not a mesh"},
    {"\xff\xfe", 2, "is text in UTF-16; save it as UTF-8"},
    {"\xfe\xff", 2, "is text in UTF-16; save it as UTF-8"},
    {"ISO-10303-21", 12, "is a STEP file, a model of curved faces; export it as STL"},
    {"LASF", 4, "is a LAS file, a cloud of points; mesh it first"},
    {"ASTM-E57", 8, "is an E57 file, a cloud of points; mesh it first"},
    {"# .PCD", 6, "is a PCD file, a cloud of points; mesh it first"},
    {"BLENDER", 7, "is a Blender file; export it as STL or PLY"},
    {"#VRML", 5, "is a VRML file; export it as STL or PLY"},
    {"# vtk DataFile", 14, "is a VTK file; save it as STL or PLY"},
};

/* Free of control characters other than white space, as far as one looks. */
static bool looks_like_text(const unsigned char *bytes, size_t count) {
  if (count > SCREE_SNIFF_BYTES) count = SCREE_SNIFF_BYTES;
  for (size_t i = 0; i < count; i++)
    if ((bytes[i] < 32 && !(bytes[i] >= 9 && bytes[i] <= 13)) || bytes[i] == 127) return false;
  return true;
}

/* The first word behind lines of comment. */
static scree_token first_word(scree_text text) {
  for (;;) {
    scree_text_skip_space(&text);
    if (text.p == text.end || *text.p != '#') return scree_text_next(&text);
    scree_text_skip_line(&text);
  }
}

static bool looks_like_off(scree_text text) {
  return scree_is_off_word(first_word(text));
}

/* OBJ has no mark: its first statement tells. */
static bool looks_like_obj(scree_text text) {
  static const char *const words[] = {"v", "vt",     "vn",     "vp", "f", "o",
                                      "g", "mtllib", "usemtl", "s",  "l", "p"};
  scree_token word = first_word(text);
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (scree_token_is(word, words[i])) return true;
  return false;
}

/* JSON with the one member that glTF demands. */
static bool looks_like_gltf(scree_text text) {
  static const char word[] = "\"asset\"";
  scree_text_skip_space(&text);
  if (text.p == text.end || *text.p != '{') return false;
  const size_t length = sizeof word - 1;
  for (const char *p = text.p; (size_t)(text.end - p) >= length; p++) {
    p = memchr(p, '"', (size_t)(text.end - p) - length + 1);
    if (!p) return false;
    if (!memcmp(p, word, length)) return true;
  }
  return false;
}

/* The name of the root element of an XML file; empty where there is none. */
static scree_token xml_root(scree_text text) {
  scree_text_skip_space(&text);
  while (text.p < text.end && *text.p == '<') {
    const char *close = memchr(text.p, '>', (size_t)(text.end - text.p));
    if (!close) break;
    bool is_comment = close - text.p >= 3 && !memcmp(text.p, "<!--", 4);
    while (is_comment && close && memcmp(close - 2, "--", 2) != 0)
      close = memchr(close + 1, '>', (size_t)(text.end - close - 1));
    if (!close) break;
    if (text.p[1] != '?' && text.p[1] != '!') {
      const char *begin = text.p + 1, *end = begin;
      while (end < close && *end != ' ' && *end != '\t' && *end != '\r' && *end != '\n') end++;
      return (scree_token){begin, (size_t)(end - begin)};
    }
    text.p = close + 1;
    scree_text_skip_space(&text);
  }
  return (scree_token){text.end, 0};
}

static bool begins_with(const scree_text *t, const char *word) {
  size_t length = strlen(word);
  return (size_t)(t->end - t->p) >= length && scree_token_is((scree_token){t->p, length}, word);
}

static scree_status fail_model(const scree_reading *r, const char *what, const char *suffix) {
  return scree_reading_fail(r, SCREE_UNSUPPORTED,
                            "is %s, which scree does not read; convert it, for example by "
                            "`assimp export in.%s out.ply`",
                            what, suffix);
}

static bool starts_with(const scree_reading *r, const char *bytes, size_t count) {
  return r->byte_count >= count && !memcmp(r->bytes, bytes, count);
}

static const mark *foreign_mark_of(const scree_reading *r) {
  for (size_t i = 0; i < sizeof foreign_marks / sizeof *foreign_marks; i++)
    if (starts_with(r, foreign_marks[i].bytes, foreign_marks[i].length)) return &foreign_marks[i];
  return NULL;
}

static scree_status fail_text(const scree_reading *r, scree_text text) {
  static const char *const models[][3] = {{"collada", "a COLLADA model", "dae"},
                                          {"x3d", "an X3D model", "x3d"},
                                          {"amf", "an AMF model", "amf"}};
  char quote[SCREE_QUOTE_SIZE];
  scree_token root = xml_root(text);
  for (size_t i = 0; i < sizeof models / sizeof *models; i++)
    if (scree_token_is(root, models[i][0])) return fail_model(r, models[i][1], models[i][2]);
  scree_text_skip_space(&text);
  if (begins_with(&text, "; fbx")) return fail_model(r, "an FBX model", "fbx");
  if (begins_with(&text, "<!doctype html") || begins_with(&text, "<html"))
    return scree_reading_fail(
        r, SCREE_BAD_FILE,
        "is an HTML page, not a mesh (line 1 begins %s); was a link saved instead of the file?",
        scree_text_quote(&text, text.p, quote));
  if (text.p == text.end)
    return scree_reading_fail(r, SCREE_BAD_FILE, "holds only white space (%zu bytes)",
                              r->byte_count);
  const mark *foreign = foreign_mark_of(r);
  if (foreign) return scree_reading_fail(r, SCREE_BAD_FILE, "%s", foreign->advice);
  return scree_reading_fail(r, SCREE_BAD_FILE,
                            "is text, but neither STL, PLY, OBJ nor OFF: it begins with %s",
                            scree_text_quote(&text, text.p, quote));
}

static uint32_t load_u32(const unsigned char *b) {
  return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/* A main chunk, whose length stands in it, and in it a version, an editor's chunk or materials. */
static bool looks_like_3ds(const scree_reading *r) {
  const unsigned char *b = r->bytes;
  if (r->byte_count <= 16 || b[0] != 0x4d || b[1] != 0x4d) return false;
  unsigned first = b[6] | (unsigned)b[7] << 8;
  return load_u32(b + 2) == r->whole_count || first == 0x0002 || first == 0x3d3d || first == 0x3d3e;
}

/* The version that stands behind the mark of a binary glTF, or in the member `asset` of a text. */
static bool is_gltf_1(const scree_reading *r, bool is_binary) {
  if (is_binary) return r->byte_count >= 8 && load_u32(r->bytes + 4) == 1;
  static const char *const way[] = {"\"asset\"", "\"version\"", "\""};
  const char *p = (const char *)r->bytes, *end = p + r->byte_count;
  for (size_t i = 0; i < sizeof way / sizeof *way; i++) {
    size_t length = strlen(way[i]);
    while ((size_t)(end - p) > length && memcmp(p, way[i], length) != 0) p++;
    if ((size_t)(end - p) <= length) return false;
    p += length;
  }
  return *p == '1';
}

static scree_status read_gltf(scree_reading *r, bool is_binary) {
  if (!is_gltf_1(r, is_binary)) return scree_read_gltf(r, is_binary);
  return scree_reading_fail(r, SCREE_UNSUPPORTED,
                            "is glTF 1.0, and 2.0 is what scree reads; convert it first");
}

static scree_status read_glb(scree_reading *r) {
  return read_gltf(r, true);
}

/* Text but for a few bytes, and where the first of these is: no float and no count looks so. */
static bool is_damaged_text(const scree_reading *r, size_t *first) {
  size_t count = r->byte_count < SCREE_SNIFF_BYTES ? r->byte_count : SCREE_SNIFF_BYTES, bad = 0;
  for (size_t i = count; i-- > 0;)
    if (!looks_like_text(r->bytes + i, 1)) {
      *first = i;
      bad++;
    }
  return bad * MOST_DAMAGE < count;
}

static const char *text_kind(scree_text text) {
  scree_text start = text;
  if (scree_token_is(scree_text_next(&start), "solid")) return "an ASCII STL";
  return looks_like_off(text) ? "an OFF file" : looks_like_obj(text) ? "an OBJ file" : "text";
}

/* "OFF BINARY", and numbers behind it. */
static bool is_binary_off(scree_text text) {
  scree_token word = first_word(text);
  text.p = word.begin + word.length;
  return scree_is_off_word(word) && scree_token_is(scree_text_next(&text), "binary");
}

/* How binary files begin that are read; STL has no such mark. */
static const struct {
  const char *bytes;
  scree_status (*read)(scree_reading *r);
} binary_marks[] = {{"PK\x03\x04", scree_read_3mf}, {"glTF", read_glb}};
enum { BINARY_MARK_COUNT = sizeof binary_marks / sizeof *binary_marks };

/* BINARY_MARK_COUNT: none. */
static size_t binary_mark_of(const scree_reading *r) {
  size_t i = 0;
  while (i < BINARY_MARK_COUNT &&
         !starts_with(r, binary_marks[i].bytes, strlen(binary_marks[i].bytes)))
    i++;
  return i;
}

static scree_status read_binary_or_fail(scree_reading *r) {
  size_t marked = binary_mark_of(r);
  if (marked < BINARY_MARK_COUNT) return binary_marks[marked].read(r);
  if (looks_like_3ds(r)) return fail_model(r, "a 3DS model", "3ds");
  if (starts_with(r, FBX_MARK, sizeof FBX_MARK - 1)) return fail_model(r, "an FBX model", "fbx");
  const mark *foreign = foreign_mark_of(r);
  if (foreign) return scree_reading_fail(r, SCREE_BAD_FILE, "%s", foreign->advice);
  scree_text text = scree_reading_text(r);
  size_t damaged = 0;
  if (is_binary_off(text)) return scree_read_off(r);
  if (is_damaged_text(r, &damaged))
    return scree_reading_fail(r, SCREE_BAD_FILE,
                              "is %s, but byte %zu is 0x%02x, which no text has: it is damaged",
                              text_kind(text), damaged, r->bytes[damaged]);
  if (r->byte_count < SCREE_STL_HEADER)
    return scree_reading_fail(r, SCREE_BAD_FILE,
                              "too short: %zu bytes; a binary STL has at least %d", r->byte_count,
                              SCREE_STL_HEADER);
  return scree_read_stl_binary(r, scree_stl_length_of(r->bytes, r->whole_count));
}

/* A full block of a disk, or a tape's, ends in them. */
static size_t length_without_nuls(const scree_reading *r) {
  size_t length = r->byte_count;
  while (length && !r->bytes[length - 1]) length--;
  return length;
}

static scree_status read_any(scree_reading *r) {
  if (r->byte_count == 0) return scree_reading_fail(r, SCREE_BAD_FILE, "the file is empty");
  scree_reading_take_unit(r, r->bytes, r->byte_count);
  scree_text text = scree_reading_text(r), start = text;
  if (scree_token_is(scree_text_next(&start), "ply")) return scree_read_ply(r);
  if (scree_stl_length_of(r->bytes, r->whole_count) == SCREE_STL_WHOLE)
    return scree_read_stl_binary(r, SCREE_STL_WHOLE);
  start = text;
  bool is_solid = scree_token_is(scree_text_next(&start), "solid");
  if (is_solid && looks_like_text(r->bytes, length_without_nuls(r))) return scree_read_stl_ascii(r);
  if (!looks_like_text(r->bytes, r->byte_count)) return read_binary_or_fail(r);
  if (looks_like_off(text)) return scree_read_off(r);
  if (looks_like_obj(text)) return scree_read_obj(r);
  if (looks_like_gltf(text)) return read_gltf(r, false);
  return fail_text(r, text);
}

/* ---- the public calls ---- */

static scree_status check_options(const scree_read_options *o, scree_error *error) {
  if (!(o->unit_m >= 1e-12 && o->unit_m <= 1e12))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the unit is %g m; it must lie in [1e-12, 1e12] m",
                      o->unit_m);
  return SCREE_OK;
}

/* Reads what r names; its unit and scan are set here. */
static scree_status parse(scree_reading *r, scree_scan *scan) {
  SCREE_TRY(check_options(r->options, r->error));
  SCREE_CLEANUP(scree_scan_free) scree_scan made = {.byte_count = r->byte_count};
  r->scan = &made;
  r->unit_m = r->options->unit_m;
  SCREE_TRY(read_any(r));
  made.unit_m = r->unit_m;
  if (made.mesh.triangle_count == 0)
    return scree_reading_fail(r, SCREE_BAD_MESH,
                              "all %zu facets are degenerate: two corners of each coincide",
                              made.facet_count);
  made.checksum = scree_checksum_of(r->bytes, r->byte_count);
  if (r->beside.high | r->beside.low) {
    scree_checksum sums[2] = {made.checksum, r->beside};
    made.checksum = scree_checksum_of(sums, sizeof sums);
  }
  *scan = made;
  made = (scree_scan){0};
  return SCREE_OK;
}

scree_status scree_scan_parse(const void *bytes, size_t byte_count, const char *name,
                              const scree_read_options *options, scree_scan *scan,
                              scree_error *error) {
  scree_read_options used = options ? *options : scree_default_read_options();
  scree_reading r = {.name = name,
                     .bytes = bytes,
                     .byte_count = byte_count,
                     .whole_count = byte_count,
                     .options = &used,
                     .error = error};
  return parse(&r, scan);
}

/* What a stream is may show at its end only where it begins with white space or comments, or where
 * glTF may follow. */
static bool may_be_text_format(scree_text text) {
  scree_text start = text;
  scree_token word = first_word(text);
  if (word.begin + word.length == text.end) return true;
  scree_text_skip_space(&start);
  return *start.p == '{' || scree_token_is(scree_text_next(&text), "solid") ||
         scree_is_off_word(word) || looks_like_obj(start);
}

/* No more of it than says what it is, where it is none of ours; of a binary STL that is a stream so
 * much that it shows to be too long. */
static size_t judge(const char *beginning, size_t byte_count, size_t whole_count) {
  const scree_read_options options = scree_default_read_options();
  const unsigned char *bytes = (const unsigned char *)beginning;
  scree_reading r = {.name = "",
                     .bytes = bytes,
                     .byte_count = byte_count,
                     .whole_count = whole_count,
                     .options = &options,
                     .unit_m = 1};
  scree_text text = scree_reading_text(&r), start = text;
  size_t damaged = 0;
  if (byte_count < SCREE_JUDGED_BYTES) return SIZE_MAX; /* it has ended */
  if (scree_token_is(scree_text_next(&start), "ply")) return SIZE_MAX;
  if (scree_stl_length_of(bytes, whole_count) == SCREE_STL_WHOLE) return SIZE_MAX;
  if (looks_like_text(bytes, byte_count)) return may_be_text_format(text) ? SIZE_MAX : byte_count;
  if (binary_mark_of(&r) < BINARY_MARK_COUNT) return SIZE_MAX;
  if (looks_like_3ds(&r) || starts_with(&r, FBX_MARK, sizeof FBX_MARK - 1)) return byte_count;
  if (foreign_mark_of(&r)) return byte_count;
  if (is_binary_off(text) || is_damaged_text(&r, &damaged)) return byte_count;
  if (scree_stl_length_of(bytes, whole_count) != SCREE_STL_OTHER_LENGTH) return SIZE_MAX;
  size_t enough = SCREE_STL_HEADER + (scree_stl_count(bytes) + 1) * SCREE_STL_FACET;
  bool cut_off = whole_count < enough - SCREE_STL_FACET;
  return cut_off ? byte_count : enough;
}

/* The common kind of scan. */
static scree_status read_stream(const char *path, const scree_read_options *options,
                                scree_scan *scan, bool *done, scree_error *error) {
  scree_stream stream;
  scree_status status = SCREE_OK;
  *done = false;
  if (!scree_stream_open(path, &stream)) return SCREE_OK;
  if (!options->max_bytes || stream.byte_count <= options->max_bytes) {
    scree_scan made = {.byte_count = stream.byte_count, .unit_m = options->unit_m};
    scree_reading r = {.name = path,
                       .byte_count = stream.byte_count,
                       .whole_count = stream.byte_count,
                       .options = options,
                       .unit_m = options->unit_m,
                       .scan = &made,
                       .error = error};
    status = scree_read_stl_stream(&r, &stream, done);
    made.checksum = scree_stream_checksum(&stream);
    made.unit_m = r.unit_m;
    if (*done)
      *scan = made;
    else
      scree_scan_free(&made);
  }
  scree_stream_close(&stream);
  return status;
}

scree_status scree_scan_read(const char *path, const scree_read_options *options, scree_scan *scan,
                             scree_error *error) {
  scree_read_options used = options ? *options : scree_default_read_options();
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  size_t byte_count, whole_count;
  bool done = false, is_file = strcmp(path, "-") != 0;
  SCREE_TRY(check_options(&used, error));
  if (is_file) SCREE_TRY(read_stream(path, &used, scan, &done, error));
  if (done) return SCREE_OK;
  SCREE_TRY(scree_file_read_judged(path, used.max_bytes, judge, &bytes, &byte_count, &whole_count,
                                   error));
  scree_reading r = {.name = is_file ? path : "standard input",
                     .bytes = (const unsigned char *)bytes,
                     .byte_count = byte_count,
                     .whole_count = whole_count,
                     .options = &used,
                     .error = error,
                     .path = is_file ? path : NULL};
  return parse(&r, scan);
}
