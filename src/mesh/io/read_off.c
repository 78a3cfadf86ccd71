/* OFF as Geomview defines it: a word [ST][C][N]OFF, the numbers of vertices, faces and (ignored,
 * also where it is missing) edges, then a line for each vertex, whose first three numbers are its
 * position, and for each face, its number of corners and these; what follows on a line (normals,
 * colours) is skipped. `#` begins a comment. */
#include "base/array.h"
#include "mesh/io/polygon.h"
#include "mesh/io/read.h"

/* "0 0 0\n", "0\n", "0 " */
enum { VERTEX_LEAST_BYTES = 6, FACE_LEAST_BYTES = 2, CORNER_LEAST_BYTES = 2 };

static void skip_comments(scree_text *t) {
  for (;;) {
    scree_text_skip_space(t);
    if (t->p == t->end || *t->p != '#') return;
    scree_text_skip_line(t);
  }
}

/* [ST][C][N][4][n]OFF: texture coordinates, colours, normals; a fourth coordinate; any number of
 * them, which only its small letter tells from N. Otherwise letters of either case will do. */
typedef struct off_word {
  bool known, has_other_dimension;
  const char *end; /* some writers put the first number right behind the word */
} off_word;

static off_word parse_word(scree_token word) {
  off_word w = {.known = false};
  while (word.length > 3 && word.begin[word.length - 1] >= '0' &&
         word.begin[word.length - 1] <= '9')
    word.length--;
  const char *p = word.begin, *end = w.end = p + word.length;
  if (word.length < 3 || !scree_token_is((scree_token){end - 3, 3}, "off")) return w;
  end -= 3;
  bool small = *end == 'o';
  if (end - p >= 2 && scree_token_is((scree_token){p, 2}, "st")) p += 2;
  if (p < end && (*p == 'C' || *p == 'c')) p++;
  if (p < end && (*p == 'N' || (small && *p == 'n'))) p++;
  if (p < end && *p == '4') w.has_other_dimension = true, p++;
  if (p < end && *p == 'n') w.has_other_dimension = true, p++;
  w.known = p == end;
  return w;
}

bool scree_is_off_word(scree_token word) {
  return parse_word(word).known;
}

typedef struct off {
  int64_t vertex_count, face_count;
  double *positions;
  scree_index_list face;
  scree_face_list faces;
  const char *spilled; /* the first vertex or face whose numbers took a second line: it may lack
                          some, and have taken them from the next */
} off;

/* A count that the rest of the file has room for. */
static scree_status read_count(scree_text *t, const char *what, int64_t least_bytes,
                               int64_t *count) {
  skip_comments(t);
  const char *at = t->p;
  int64_t room = (t->end - at) / least_bytes + 1;
  scree_status status = scree_text_integer(t, what, 0, UINT32_MAX - 1, count);
  if (status != SCREE_OK || *count <= room) return status;
  return scree_text_fail(t, at, "%s is %lld, more than the rest of the file has room for", what,
                         (long long)*count);
}

/* The number of edges ends the line of the number of faces or has one of its own; where neither
 * is so, it is missing, and vertices begin. */
static void skip_edge_count(scree_text *t) {
  double number;
  scree_text_skip_blanks(t);
  bool follows = !scree_text_at_line_end(t) && *t->p != '#';
  scree_text_skip_line(t);
  if (follows) return;
  scree_text probe = *t;
  probe.error = NULL;
  skip_comments(&probe);
  if (scree_text_number(&probe, "", &number) != SCREE_OK) return;
  scree_text_skip_blanks(&probe);
  if (!scree_text_at_line_end(&probe) && *probe.p != '#') return;
  scree_text_skip_line(&probe);
  t->p = probe.p;
}

static scree_status read_header(scree_text *t, off *o) {
  skip_comments(t);
  scree_token word = scree_text_next(t);
  off_word parsed = parse_word(word);
  t->p = parsed.end;
  if (parsed.has_other_dimension)
    return scree_fail(t->error, SCREE_UNSUPPORTED,
                      "%s: the header %.*s says that vertices have more or fewer than three "
                      "coordinates; such an OFF is not read",
                      t->name, (int)word.length, word.begin);
  scree_text probe = *t;
  scree_text_skip_blanks(&probe);
  if (scree_token_is(scree_text_next(&probe), "binary"))
    return scree_fail(t->error, SCREE_UNSUPPORTED,
                      "%s: line 1: binary OFF is not read; save it as text", t->name);
  SCREE_TRY(read_count(t, "the number of vertices", VERTEX_LEAST_BYTES, &o->vertex_count));
  SCREE_TRY(read_count(t, "the number of faces", FACE_LEAST_BYTES, &o->face_count));
  skip_edge_count(t);
  return SCREE_OK;
}

static scree_status read_vertex(scree_text *t, off *o, int64_t vertex) {
  return scree_text_position(t, o->positions + 3 * vertex);
}

static scree_status read_face(scree_text *t, off *o, int64_t face) {
  int64_t corner_count, corner;
  (void)face;
  SCREE_TRY(read_count(t, "the number of corners", CORNER_LEAST_BYTES, &corner_count));
  o->face.count = 0;
  for (int64_t i = 0; i < corner_count; i++) {
    SCREE_TRY(scree_text_integer(t, "a corner of a face", 0, o->vertex_count - 1, &corner));
    if (!SCREE_PUSH(&o->face, (uint32_t)corner))
      return scree_fail_memory(t->error, o->face.capacity * sizeof(uint32_t), "a face of an OFF");
  }
  if (!scree_face_list_add(&o->faces, o->face.items, o->face.count))
    return scree_fail_memory(t->error, o->faces.triangles.capacity * sizeof(uint32_t),
                             "the faces of an OFF");
  return SCREE_OK;
}

static bool has_line_end(const char *begin, const char *end) {
  for (const char *p = begin; p < end; p++)
    if (*p == '\n' || *p == '\r') return true;
  return false;
}

static scree_status fail_early_end(const scree_text *t, const off *o, const char *what,
                                   int64_t done, int64_t count) {
  if (o->spilled)
    return scree_text_fail(t, o->spilled,
                           "the file ends after %lld of %lld %s; one that begins here took "
                           "numbers of the next line, so some may be missing",
                           (long long)done, (long long)count, what);
  return scree_text_fail(t, t->end, "the file ends after %lld of %lld %s", (long long)done,
                         (long long)count, what);
}

/* One line each. */
static scree_status read_rows(scree_text *t, off *o, const char *what, int64_t count,
                              scree_status (*read_row)(scree_text *, off *, int64_t)) {
  for (int64_t i = 0; i < count; i++) {
    skip_comments(t);
    const char *at = t->p;
    if (at == t->end) return fail_early_end(t, o, what, i, count);
    scree_status status = read_row(t, o, i);
    if (status == SCREE_BAD_FILE && t->p == t->end) return fail_early_end(t, o, what, i, count);
    bool spills = has_line_end(at, t->p);
    if (status == SCREE_BAD_FILE && spills)
      return scree_text_fail(t, at,
                             "too few numbers here, and the next line does not go on with them");
    if (status != SCREE_OK) return status;
    if (!o->spilled && spills) o->spilled = at;
    scree_text_skip_line(t);
  }
  return SCREE_OK;
}

static scree_status read_body(scree_text *t, off *o) {
  scree_status status = read_rows(t, o, "vertices", o->vertex_count, read_vertex);
  if (status == SCREE_OK) status = read_rows(t, o, "faces", o->face_count, read_face);
  if (status != SCREE_OK) return status;
  skip_comments(t);
  if (t->p == t->end) return SCREE_OK;
  return scree_text_fail(t, t->p,
                         "more follows the last of the header's %lld faces: a count is wrong",
                         (long long)o->face_count);
}

static void free_off(off *o) {
  scree_free(o->positions);
  scree_free(o->face.items);
  scree_face_list_free(&o->faces);
}

scree_status scree_read_off(scree_reading *r) {
  snprintf(r->scan->format, sizeof r->scan->format, "OFF");
  scree_text text = scree_reading_text(r);
  SCREE_CLEANUP(free_off) off o = {0};
  SCREE_TRY(read_header(&text, &o));
  SCREE_TRY_ALLOC(o.positions, 3 * (size_t)o.vertex_count, r->error);
  SCREE_TRY(read_body(&text, &o));
  return scree_reading_weld_faces(r, o.positions, (size_t)o.vertex_count, &o.faces);
}
