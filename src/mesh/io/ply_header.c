/* The text lines from `ply` to `end_header`: format, elements in the order of the data, and the
 * properties of each. */
#include "base/array.h"
#include "mesh/io/read_ply.h"

static const struct {
  const char *name, *other_name;
  size_t size;
} types[] = {
    [SCREE_PLY_INT8] = {"char", "int8", 1},        [SCREE_PLY_UINT8] = {"uchar", "uint8", 1},
    [SCREE_PLY_INT16] = {"short", "int16", 2},     [SCREE_PLY_UINT16] = {"ushort", "uint16", 2},
    [SCREE_PLY_INT32] = {"int", "int32", 4},       [SCREE_PLY_UINT32] = {"uint", "uint32", 4},
    [SCREE_PLY_FLOAT32] = {"float", "float32", 4}, [SCREE_PLY_FLOAT64] = {"double", "float64", 8},
};

size_t scree_ply_type_size(scree_ply_type type) {
  return types[type].size;
}

void scree_ply_header_free(scree_ply_header *header) {
  scree_free(header->elements.items);
  scree_free(header->properties.items);
  *header = (scree_ply_header){0};
}

static scree_status fail_word(const scree_text *t, scree_token word, const char *what) {
  char quote[SCREE_QUOTE_SIZE];
  return scree_text_fail(t, word.begin, "%s, found %s", what,
                         scree_text_quote(t, word.begin, quote));
}

static scree_status read_type(scree_text *t, scree_ply_type *type) {
  scree_token word = scree_text_next(t);
  for (size_t i = 0; i < sizeof types / sizeof *types; i++)
    if (scree_token_is(word, types[i].name) || scree_token_is(word, types[i].other_name)) {
      *type = (scree_ply_type)i;
      return SCREE_OK;
    }
  return fail_word(t, word,
                   "a property's type should be one of char, uchar, short, ushort, int, "
                   "uint, float, double");
}

static scree_status read_format(scree_text *t, scree_ply_header *h) {
  scree_token word = scree_text_next(t);
  if (scree_token_is(word, "ascii"))
    h->encoding = SCREE_PLY_ASCII;
  else if (scree_token_is(word, "binary_little_endian"))
    h->encoding = SCREE_PLY_LITTLE_ENDIAN;
  else if (scree_token_is(word, "binary_big_endian"))
    h->encoding = SCREE_PLY_BIG_ENDIAN;
  else
    return fail_word(t, word,
                     "the format should be ascii, binary_little_endian or binary_big_endian");
  return SCREE_OK;
}

static scree_status read_element(scree_text *t, scree_ply_header *h) {
  scree_ply_element e = {.kind = SCREE_PLY_OTHER, .first_property = h->properties.count};
  scree_token word = scree_text_next(t);
  if (scree_token_is(word, "vertex"))
    e.kind = SCREE_PLY_VERTEX;
  else if (scree_token_is(word, "face"))
    e.kind = SCREE_PLY_FACE;
  else if (scree_token_is(word, "tristrips"))
    e.kind = SCREE_PLY_STRIPS;
  size_t length = word.length < sizeof e.name ? word.length : sizeof e.name - 1;
  for (size_t i = 0; i < length; i++)
    e.name[i] = word.begin[i] >= ' ' && word.begin[i] <= '~' ? word.begin[i] : '?';
  int64_t count;
  SCREE_TRY(scree_text_integer(t, "the number of an element", 0, (int64_t)1 << 52, &count));
  e.count = (size_t)count;
  for (size_t i = 0; i < h->elements.count; i++)
    if (e.kind != SCREE_PLY_OTHER && h->elements.items[i].kind == e.kind)
      return scree_text_fail(t, word.begin, "a second element '%s'", e.name);
  if (!SCREE_PUSH(&h->elements, e))
    return scree_fail_memory(t->error, sizeof e, "the header of a PLY");
  return SCREE_OK;
}

static scree_ply_role role_of(scree_ply_kind kind, scree_token name, bool is_list) {
  if (is_list && (kind == SCREE_PLY_FACE || kind == SCREE_PLY_STRIPS) &&
      (scree_token_is(name, "vertex_indices") || scree_token_is(name, "vertex_index")))
    return SCREE_PLY_CORNERS;
  if (is_list || kind != SCREE_PLY_VERTEX) return SCREE_PLY_NO_ROLE;
  if (scree_token_is(name, "x")) return SCREE_PLY_X;
  if (scree_token_is(name, "y")) return SCREE_PLY_Y;
  if (scree_token_is(name, "z")) return SCREE_PLY_Z;
  return SCREE_PLY_NO_ROLE;
}

static scree_status read_property(scree_text *t, scree_ply_header *h) {
  if (h->elements.count == 0) return scree_text_fail(t, t->p, "a property before any element");
  scree_ply_element *e = &h->elements.items[h->elements.count - 1];
  scree_ply_property p = {0};
  scree_text probe = *t;
  if (scree_token_is(scree_text_next(&probe), "list")) {
    p.is_list = true;
    t->p = probe.p;
    SCREE_TRY(read_type(t, &p.count_type));
  }
  SCREE_TRY(read_type(t, &p.type));
  scree_token name = scree_text_next(t);
  p.role = role_of(e->kind, name, p.is_list);
  for (size_t i = e->first_property; i < h->properties.count; i++)
    if (p.role != SCREE_PLY_NO_ROLE && h->properties.items[i].role == p.role)
      return fail_word(t, name, "a property named twice");
  if (!SCREE_PUSH(&h->properties, p))
    return scree_fail_memory(t->error, sizeof p, "the header of a PLY");
  e->property_count++;
  return SCREE_OK;
}

/* The data begins behind one line end. Where lines end in CR alone, an LF behind it is data. */
static void skip_to_data(scree_text *t, bool lone_cr) {
  scree_text_skip_blanks(t);
  if (t->p < t->end && *t->p == '\r') {
    t->p++;
    if (lone_cr) return;
  }
  if (t->p < t->end && *t->p == '\n') t->p++;
}

scree_status scree_ply_header_read(scree_text *t, scree_ply_header *h) {
  scree_text_next(t); /* `ply` */
  bool lone_cr = t->end - t->p >= 2 && t->p[0] == '\r' && t->p[1] != '\n', has_format = false;
  scree_token word;
  for (;;) {
    word = scree_text_next(t);
    if (scree_token_is(word, "end_header")) break;
    if (scree_token_is(word, "format")) {
      SCREE_TRY(read_format(t, h));
      has_format = true;
    } else if (scree_token_is(word, "element"))
      SCREE_TRY(read_element(t, h));
    else if (scree_token_is(word, "property"))
      SCREE_TRY(read_property(t, h));
    else if (word.length == 0 || t->p == t->end)
      return scree_text_fail(t, t->end, "the file is cut off before `end_header`");
    else if (!scree_token_is(word, "comment") && !scree_token_is(word, "obj_info"))
      return fail_word(t, word, "expected format, element, property, comment or end_header");
    scree_text_skip_line(t);
  }
  if (!has_format) return scree_text_fail(t, word.begin, "the header names no format");
  skip_to_data(t, lone_cr);
  return SCREE_OK;
}
