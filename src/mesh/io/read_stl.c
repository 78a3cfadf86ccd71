/* STL, both kinds.
 *
 * Binary: 80 bytes of header, which may say anything (also `solid`), a 32-bit count, then 50 bytes
 * per facet: normal and three corners as 12 little-endian floats, and an attribute word (colours;
 * ignored). Normals are ignored: the order of the corners says what is outside. The count must fit
 * the file; fewer than 50 bytes may follow the last facet, as some writers pad. Where each
 * attribute word says how many bytes of attributes follow it, and the file has them all, they are
 * passed over.
 *
 * ASCII: words in any case, any white space between them; `end solid` is `endsolid`. A solid's name
 * goes to the end of its line, unless a facet begins on that line. Every solid must be ended: a
 * file that stops before was cut. NUL bytes behind the last are passed over. */
#include "base/array.h"
#include "mesh/io/read.h"
#include "mesh/weld.h"

#include <string.h>

enum {
  HEADER_BYTES = SCREE_STL_HEADER,
  FACET_BYTES = SCREE_STL_FACET,
  NORMAL_BYTES = 12,
  PIECE_FACETS = 4096 /* of a stream */
};

static uint32_t load_u32(const unsigned char *p) {
  return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static float load_float(const unsigned char *p) {
  uint32_t bits = load_u32(p);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* ---- binary ---- */

size_t scree_stl_count(const unsigned char *bytes) {
  return load_u32(bytes + 80);
}

/* A count made of text is a text file of that very length by chance, and far longer than any. What
 * is shorter than its count is cut off, unless the count is all ones, as writers leave it that did
 * not know it yet. */
scree_stl_length scree_stl_length_of(const unsigned char *bytes, size_t byte_count) {
  if (byte_count < SCREE_STL_HEADER) return SCREE_STL_OTHER_LENGTH;
  unsigned char swapped[SCREE_STL_HEADER] = {0};
  for (int i = 0; i < 4; i++) swapped[80 + i] = bytes[83 - i];
  size_t body = byte_count - SCREE_STL_HEADER, room = body / SCREE_STL_FACET;
  size_t count = scree_stl_count(bytes);
  if (body != room * SCREE_STL_FACET) return SCREE_STL_OTHER_LENGTH;
  if (count == room) return SCREE_STL_WHOLE;
  if (scree_stl_count(swapped) == room) return SCREE_STL_SWAPPED;
  return room && (count < room || count == UINT32_MAX) ? SCREE_STL_MISCOUNTED
                                                       : SCREE_STL_OTHER_LENGTH;
}

typedef struct binary_facets {
  const unsigned char *first;
  double unit_m;
  bool swapped; /* the most significant byte comes first */
} binary_facets;

static float load_swapped(const unsigned char *p) {
  const unsigned char turned[4] = {p[3], p[2], p[1], p[0]};
  return load_float(turned);
}

static void unpack(const unsigned char *facet, size_t count, double unit_m, double *out) {
  const unsigned char *p = facet + NORMAL_BYTES;
  for (size_t f = 0; f < count; f++, p += FACET_BYTES)
    for (size_t i = 0; i < 9; i++) *out++ = (double)load_float(p + 4 * i) * unit_m;
}

static void unpack_swapped(const unsigned char *facet, size_t count, double unit_m, double *out) {
  const unsigned char *p = facet + NORMAL_BYTES;
  for (size_t f = 0; f < count; f++, p += FACET_BYTES)
    for (size_t i = 0; i < 9; i++) *out++ = (double)load_swapped(p + 4 * i) * unit_m;
}

/* Corners come in whole facets. */
static void fetch_binary(const void *context, size_t first, size_t count, double *out) {
  const binary_facets *facets = context;
  const unsigned char *begin = facets->first + first / 3 * FACET_BYTES;
  (facets->swapped ? unpack_swapped : unpack)(begin, count / 3, facets->unit_m, out);
}

static scree_status fail_bad_corner(const scree_reading *r, size_t corner, bool swapped) {
  float (*load)(const unsigned char *) = swapped ? load_swapped : load_float;
  size_t byte = HEADER_BYTES + corner / 3 * FACET_BYTES + NORMAL_BYTES + corner % 3 * 12;
  const unsigned char *p = r->bytes + byte;
  return scree_reading_fail(r, SCREE_BAD_FILE,
                            "facet %zu of %zu, corner %zu (byte %zu) lies at (%g, %g, %g); "
                            "coordinates must be finite and "
                            "at most %g m in size",
                            corner / 3 + 1, r->scan->facet_count, corner % 3 + 1, byte,
                            (double)load(p), (double)load(p + 4), (double)load(p + 8),
                            SCREE_COORDINATE_LIMIT);
}

static void describe_binary(scree_scan *scan, size_t facet_count) {
  snprintf(scan->format, sizeof scan->format, "STL binary");
  scan->facet_count = facet_count;
  scan->solid_count = 1;
}

/* How the file is read although its count is wrong. */
static void describe_length(scree_scan *scan, scree_stl_length length, size_t count, size_t room) {
  if (length == SCREE_STL_SWAPPED) {
    snprintf(scan->format, sizeof scan->format, "STL binary big endian");
    snprintf(scan->warning, sizeof scan->warning,
             "a big-endian binary STL, which is against the format; read as such");
  } else if (length == SCREE_STL_MISCOUNTED) {
    snprintf(scan->warning, sizeof scan->warning,
             "bytes 80 to 83 say %zu facets, but %zu fill the file exactly; all of them were read",
             count, room);
  }
}

/* The bytes of attributes behind all facets, where each facet's word says how many are its own and
 * together they end the file; 0: it is no such file. */
static size_t attribute_bytes(const scree_reading *r, size_t count) {
  size_t at = HEADER_BYTES, sum = 0;
  for (size_t f = 0; f < count; f++) {
    if (r->byte_count - at < FACET_BYTES) return 0;
    const unsigned char *word = r->bytes + at + FACET_BYTES - 2;
    size_t own = (size_t)word[0] | (size_t)word[1] << 8;
    at += FACET_BYTES;
    if (own > r->byte_count - at) return 0;
    at += own;
    sum += own;
  }
  return at == r->whole_count ? sum : 0;
}

/* Reads the file without them. */
static scree_status read_without_attributes(scree_reading *r, size_t count, size_t sum) {
  const size_t size = HEADER_BYTES + count * FACET_BYTES;
  SCREE_SCRATCH(unsigned char, plain, size, r->error);
  const unsigned char *from = r->bytes + HEADER_BYTES;
  memcpy(plain, r->bytes, HEADER_BYTES);
  for (size_t f = 0; f < count; f++) {
    memcpy(plain + HEADER_BYTES + f * FACET_BYTES, from, FACET_BYTES);
    from += FACET_BYTES + (from[FACET_BYTES - 2] | (size_t)from[FACET_BYTES - 1] << 8);
  }
  scree_reading inner = *r;
  inner.bytes = plain;
  inner.byte_count = inner.whole_count = size;
  SCREE_TRY(scree_read_stl_binary(&inner, SCREE_STL_WHOLE));
  r->scan->ignored_byte_count = sum;
  SCREE_ADD_TEXT(r->scan->warning, "%zu bytes of attributes behind the facets are passed over",
                 sum);
  return SCREE_OK;
}

scree_status scree_read_stl_binary(scree_reading *r, scree_stl_length length) {
  scree_scan *scan = r->scan;
  size_t count = load_u32(r->bytes + 80), room = (r->whole_count - HEADER_BYTES) / FACET_BYTES;
  bool swapped = length == SCREE_STL_SWAPPED;
  size_t sum = length == SCREE_STL_WHOLE ? 0 : attribute_bytes(r, count);
  if (sum) return read_without_attributes(r, count, sum);
  if (r->whole_count == SCREE_NO_END)
    return scree_reading_fail(
        r, SCREE_BAD_FILE,
        "binary STL with a wrong count: bytes 80 to 83 say %zu facets, which take %zu bytes, but "
        "more than %zu came",
        count, HEADER_BYTES + count * FACET_BYTES, r->byte_count - 1);
  if (count != room && !swapped && length != SCREE_STL_MISCOUNTED)
    return scree_reading_fail(
        r, SCREE_BAD_FILE,
        "binary STL %s: bytes 80 to 83 say %zu facets, which take %zu bytes, but the file has %zu "
        "bytes, room for %zu facets",
        count > room ? "cut off" : "with a wrong count", count, HEADER_BYTES + count * FACET_BYTES,
        r->whole_count, room);
  if (room == 0)
    return scree_reading_fail(r, SCREE_BAD_FILE, "binary STL with no facets: bytes 80 to 83 say 0");
  describe_binary(scan, room);
  describe_length(scan, length, count, room);
  scan->ignored_byte_count = r->byte_count - HEADER_BYTES - room * FACET_BYTES;
  binary_facets facets = {r->bytes + HEADER_BYTES, r->unit_m, swapped};
  scree_corner_source source = {fetch_binary, &facets, 3 * room, NULL, room};
  size_t bad_corner = SIZE_MAX;
  scree_status status = scree_weld_corners(&source, r->options->weld_tolerance, &scan->mesh,
                                           &scan->degenerate_count, &bad_corner, r->error);
  return bad_corner != SIZE_MAX ? fail_bad_corner(r, bad_corner, swapped) : status;
}

/* ---- binary, in pieces ---- */

typedef struct piece {
  scree_stream *stream;
  unsigned char *bytes; /* of PIECE_FACETS, from facet `begin` to `end` */
  size_t begin, end, facet_count;
  double unit_m;
  bool failed;
} piece;

/* The piece that begins with the facet after the last. */
static bool next_piece(piece *p) {
  size_t left = p->facet_count - p->end, count = left < PIECE_FACETS ? left : PIECE_FACETS;
  p->failed = p->failed || !scree_stream_read(p->stream, p->bytes, count * FACET_BYTES);
  p->begin = p->end;
  p->end += count;
  return !p->failed;
}

/* Welding asks for corners once, from the first to the last. */
static void fetch_piece(const void *context, size_t first, size_t count, double *out) {
  piece *p = *(piece *const *)context;
  for (size_t facet = first / 3, end = facet + count / 3; facet < end;) {
    if (facet == p->end && !next_piece(p)) memset(p->bytes, 0, PIECE_FACETS * FACET_BYTES);
    size_t some = (end < p->end ? end : p->end) - facet;
    unpack(p->bytes + (facet - p->begin) * FACET_BYTES, some, p->unit_m, out);
    out += 9 * some;
    facet += some;
  }
}

/* What a file is by its first word goes before what it may be by its length. Also where the word is
 * not whole. */
static bool may_begin_as_ply(const scree_reading *r, const unsigned char *header) {
  scree_reading head = *r;
  head.bytes = header;
  head.byte_count = HEADER_BYTES;
  scree_text text = scree_reading_text(&head);
  scree_token word = scree_text_next(&text);
  return scree_token_is(word, "ply") || (word.length > 0 && text.p == text.end);
}

scree_status scree_read_stl_stream(scree_reading *r, scree_stream *stream, bool *done) {
  unsigned char header[HEADER_BYTES];
  scree_scan *scan = r->scan;
  *done = false;
  if (r->byte_count <= HEADER_BYTES || !scree_stream_read(stream, header, sizeof header) ||
      may_begin_as_ply(r, header) || scree_stl_length_of(header, r->byte_count) != SCREE_STL_WHOLE)
    return SCREE_OK;
  scree_reading_take_unit(r, header, sizeof header);
  size_t count = load_u32(header + 80), bad_corner = SIZE_MAX;
  piece p = {.stream = stream, .facet_count = count, .unit_m = r->unit_m}, *context = &p;
  SCREE_TRY_ALLOC(p.bytes, (size_t)PIECE_FACETS * FACET_BYTES, r->error);
  scree_corner_source source = {fetch_piece, &context, 3 * count, NULL, count};
  scree_status status = scree_weld_corners(&source, r->options->weld_tolerance, &scan->mesh,
                                           &scan->degenerate_count, &bad_corner, r->error);
  scree_free(p.bytes);
  if (p.failed || bad_corner != SIZE_MAX) return SCREE_OK;
  *done = status == SCREE_OK && scan->mesh.triangle_count > 0;
  describe_binary(scan, count);
  return status;
}

/* ---- ASCII ---- */

typedef struct corner_list {
  double *items; /* three per corner */
  size_t count, capacity;
} corner_list;

/* Whether `facet normal` and three numbers begin at t: only then a facet shares the line with the
 * solid's name. Moves t. */
static bool facet_begins(scree_text *t) {
  double number;
  scree_text probe = *t;
  probe.error = NULL;
  if (!scree_token_is(scree_text_next(&probe), "facet")) return false;
  if (!scree_token_is(scree_text_next(&probe), "normal")) return false;
  for (int i = 0; i < 3; i++)
    if (scree_text_number(&probe, "", &number) != SCREE_OK) return false;
  return true;
}

static void skip_name(scree_text *t) {
  for (;;) {
    scree_text_skip_blanks(t);
    if (scree_text_at_line_end(t)) return;
    if ((*t->p | 0x20) == 'f' && facet_begins(t)) return;
    scree_text_next(t);
  }
}

static scree_status fail_expected(const scree_text *t, const char *at, const char *expected) {
  char quote[SCREE_QUOTE_SIZE];
  scree_text_quote(t, at, quote);
  /* every caller has just read the word at `at` */
  if (t->p == t->end)
    return scree_text_fail(t, at, "the file is cut off: it ends in %s where `%s` should stand",
                           at < t->end ? quote : "nothing", expected);
  return scree_text_fail(t, at, "expected `%s`, found %s", expected, quote);
}

/* "endsolid" and its like, which some write as two words; moves t behind the second. */
static bool is_ending(scree_text *t, scree_token token, const char *word) {
  scree_text probe = *t;
  if (scree_token_is(token, word)) return true;
  if (strncmp(word, "end", 3) != 0 || !scree_token_is(token, "end")) return false;
  bool is_two = scree_token_is(scree_text_next(&probe), word + 3);
  if (is_two) *t = probe;
  return is_two;
}

static scree_status expect_word(scree_text *t, const char *word) {
  scree_token token = scree_text_next(t);
  return is_ending(t, token, word) ? SCREE_OK : fail_expected(t, token.begin, word);
}

static scree_status skip_normal(scree_text *t) {
  SCREE_TRY(expect_word(t, "normal"));
  for (int i = 0; i < 3; i++) {
    scree_token token = scree_text_next(t); /* any word: exporters write NaN in many ways */
    if (token.length == 0 || scree_token_is(token, "outer"))
      return fail_expected(t, token.begin, "three numbers of the normal");
  }
  return SCREE_OK;
}

static scree_status read_facet(scree_text *t, corner_list *corners) {
  SCREE_TRY(skip_normal(t));
  SCREE_TRY(expect_word(t, "outer"));
  SCREE_TRY(expect_word(t, "loop"));
  if (!SCREE_RESERVE(corners, corners->count + 9))
    return scree_fail_memory(t->error, corners->capacity * sizeof(double), "the facets of an STL");
  for (int i = 0; i < 3; i++) {
    SCREE_TRY(expect_word(t, "vertex"));
    SCREE_TRY(scree_text_position(t, corners->items + corners->count));
    corners->count += 3;
  }
  SCREE_TRY(expect_word(t, "endloop"));
  return expect_word(t, "endfacet");
}

static scree_status fail_behind(const scree_text *t, const char *at) {
  char quote[SCREE_QUOTE_SIZE];
  return scree_text_fail(t, at,
                         "behind `endsolid` there is %s (first byte 0x%02x), which is no `solid`",
                         scree_text_quote(t, at, quote), (unsigned)(unsigned char)*at);
}

static scree_status read_solids(scree_reading *r, scree_text *t, corner_list *corners) {
  bool inside = false;
  for (;;) {
    scree_token token = scree_text_next(t);
    scree_status status = SCREE_OK;
    if (token.length == 0) {
      if (!inside) return SCREE_OK;
      return scree_text_fail(t, t->end,
                             "the file ends after %zu facets without `endsolid`: it is cut off",
                             corners->count / 9);
    }
    if (inside && scree_token_is(token, "facet"))
      status = read_facet(t, corners);
    else if (inside && is_ending(t, token, "endsolid")) {
      inside = false;
      scree_text_skip_line(t);
    } else if (!inside && scree_token_is(token, "solid")) {
      inside = true;
      r->scan->solid_count++;
      skip_name(t);
    } else if (inside)
      status = fail_expected(t, token.begin, "facet` or `endsolid");
    else
      status = fail_behind(t, token.begin);
    if (status != SCREE_OK) return status;
  }
}

scree_status scree_read_stl_ascii(scree_reading *r) {
  snprintf(r->scan->format, sizeof r->scan->format, "STL ASCII");
  scree_text text = scree_reading_text(r);
  SCREE_CLEANUP(scree_free_at) corner_list corners = {0};
  while (text.end > text.p && !text.end[-1]) text.end--;
  r->scan->ignored_byte_count = r->byte_count - (size_t)(text.end - text.begin);
  if (r->scan->ignored_byte_count)
    SCREE_ADD_TEXT(r->scan->warning, "ASCII STL, followed by %zu NUL bytes",
                   r->scan->ignored_byte_count);
  SCREE_TRY(read_solids(r, &text, &corners));
  return scree_reading_weld(r, corners.items, corners.count / 9);
}
