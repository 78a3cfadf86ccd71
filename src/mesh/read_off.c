/* OFF as Geomview defines it: a word [ST][C][N]OFF, the numbers of vertices, faces and (ignored)
 * edges, then a line for each vertex, whose first three numbers are its position, and for each
 * face, its number of corners and these; what follows on a line (normals, colours) is skipped. `#`
 * begins a comment. */
#include "base/array.h"
#include "mesh/polygon.h"
#include "mesh/read.h"

#include <string.h>

enum { VERTEX_LEAST_BYTES = 6, FACE_LEAST_BYTES = 2 }; /* "0 0 0\n", "0\n" */

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
} off_word;

static off_word parse_word(scree_token word) {
  const char *p = word.begin, *end = p + word.length;
  off_word w = {false, false};
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
} off;

/* A count that the rest of the file has room for. */
static scree_status read_count(scree_text *t, const char *what, int64_t least_bytes,
                               int64_t *count) {
  skip_comments(t);
  int64_t room = (t->end - t->p) / least_bytes + 1;
  return scree_text_integer(t, what, 0, room < UINT32_MAX - 1 ? room : UINT32_MAX - 1, count);
}

static scree_status read_header(scree_text *t, off *o) {
  skip_comments(t);
  scree_token word = scree_text_next(t);
  if (parse_word(word).has_other_dimension)
    return scree_fail(t->error, SCREE_UNSUPPORTED,
                      "%s: the header %.*s says that vertices have more or fewer than three "
                      "coordinates; such an OFF is not read",
                      t->name, (int)word.length, word.begin);
  scree_text probe = *t;
  scree_text_skip_blanks(&probe);
  if (scree_token_is(scree_text_next(&probe), "binary"))
    return scree_fail(t->error, SCREE_UNSUPPORTED,
                      "%s: line 1: binary OFF is not read; save it as text", t->name);
  scree_status status =
      read_count(t, "the number of vertices", VERTEX_LEAST_BYTES, &o->vertex_count);
  if (status == SCREE_OK)
    status = read_count(t, "the number of faces", FACE_LEAST_BYTES, &o->face_count);
  scree_text_skip_line(t);
  return status;
}

static scree_status read_face(scree_text *t, off *o) {
  int64_t corner_count, corner;
  skip_comments(t);
  int64_t room = (t->end - t->p) / 2 + 1;
  scree_status status = scree_text_integer(t, "the number of corners", 0, room, &corner_count);
  o->face.count = 0;
  for (int64_t i = 0; i < corner_count && status == SCREE_OK; i++) {
    status = scree_text_integer(t, "a corner of a face", 0, o->vertex_count - 1, &corner);
    if (status == SCREE_OK && !SCREE_PUSH(&o->face, (uint32_t)corner))
      status = scree_fail_memory(t->error, o->face.capacity * sizeof(uint32_t), "a face of an OFF");
  }
  if (status == SCREE_OK && !scree_face_list_add(&o->faces, o->face.items, o->face.count))
    status = scree_fail_memory(t->error, o->faces.triangles.capacity * sizeof(uint32_t),
                               "the faces of an OFF");
  scree_text_skip_line(t);
  return status;
}

static scree_status read_body(scree_text *t, off *o) {
  scree_status status = SCREE_OK;
  for (int64_t v = 0; v < o->vertex_count && status == SCREE_OK; v++) {
    skip_comments(t);
    status = scree_text_position(t, o->positions + 3 * v);
    scree_text_skip_line(t);
  }
  for (int64_t f = 0; f < o->face_count && status == SCREE_OK; f++) status = read_face(t, o);
  if (status != SCREE_OK) return status;
  skip_comments(t);
  if (t->p == t->end) return SCREE_OK;
  return scree_text_fail(t, t->p,
                         "more follows the last of the header's %lld faces: a count is wrong",
                         (long long)o->face_count);
}

scree_status scree_read_off(scree_reading *r) {
  snprintf(r->scan->format, sizeof r->scan->format, "OFF");
  scree_text text = scree_reading_text(r);
  off o = {0};
  scree_status status = read_header(&text, &o);
  if (status == SCREE_OK) {
    status = SCREE_OUT_OF_MEMORY;
    SCREE_ALLOC_OR(o.positions, 3 * (size_t)o.vertex_count, r->error, done);
    status = read_body(&text, &o);
  }
  if (status == SCREE_OK)
    status = scree_reading_weld_faces(r, o.positions, (size_t)o.vertex_count, &o.faces);
done:
  scree_free(o.positions);
  scree_free(o.face.items);
  scree_face_list_free(&o.faces);
  return status;
}
