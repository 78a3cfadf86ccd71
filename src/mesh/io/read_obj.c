/* OBJ: lines whose first word says what they hold. Read are `v` (position; a weight or colour
 * behind it is ignored) and `f` (corners as v, v/vt, v//vn or v/vt/vn, counted from 1, or from the
 * end when negative); all else is skipped. A backslash at a line's end continues it. */
#include "base/array.h"
#include "mesh/io/polygon.h"
#include "mesh/io/read.h"

#include <string.h>

typedef struct position_list {
  double *items; /* three per vertex */
  size_t count, capacity;
} position_list;

typedef struct obj {
  position_list positions;
  scree_face_list faces;
  scree_index_list face;  /* the one being read */
  uint64_t highest;       /* index from 1 that no vertex had yet when it was read, */
  const char *highest_at; /* and where it stands: vertices may follow their faces */
} obj;

/* Skips blanks and continued line ends; false at the end of the statement. */
static bool statement_goes_on(scree_text *t) {
  for (;;) {
    scree_text_skip_blanks(t);
    if (scree_text_at_line_end(t) || *t->p == '#') return false;
    if (*t->p != '\\' || t->p + 1 == t->end || (t->p[1] != '\n' && t->p[1] != '\r')) return true;
    t->p++;
    scree_text_skip_line(t);
  }
}

/* All on one line: a short one is told where it stands. */
static scree_status read_vertex(scree_text *t, obj *o) {
  const char *at = t->p;
  if (!SCREE_RESERVE(&o->positions, o->positions.count + 3))
    return scree_fail_memory(t->error, o->positions.capacity * sizeof(double),
                             "the vertices of an OBJ");
  for (int i = 0; i < 3; i++) {
    if (!statement_goes_on(t))
      return scree_text_fail(t, at, "a vertex with %d coordinate%s; it needs 3", i,
                             i == 1 ? "" : "s");
    SCREE_TRY(scree_text_coordinate(t, i, o->positions.items + o->positions.count));
    o->positions.count++;
  }
  return SCREE_OK;
}

/* Reads the vertex index of a corner and skips its texture and normal indices. */
static scree_status read_corner(scree_text *t, obj *o, uint32_t *corner) {
  char quote[SCREE_QUOTE_SIZE];
  const char *at = t->p;
  int64_t vertex_count = (int64_t)(o->positions.count / 3), index = 0;
  bool negative = *t->p == '-';
  t->p += negative;
  for (; t->p < t->end && *t->p >= '0' && *t->p <= '9'; t->p++)
    if (index <= UINT32_MAX) index = index * 10 + (*t->p - '0');
  bool ended = t->p == t->end || strchr(" \t\v\f\r\n/", *t->p);
  if (!ended || index == 0 || index >= UINT32_MAX || (negative && index > vertex_count))
    return scree_text_fail(t, at, "corner %s of a face is no vertex; there are %lld so far",
                           scree_text_quote(t, at, quote), (long long)vertex_count);
  while (t->p < t->end && !strchr(" \t\v\f\r\n", *t->p)) t->p++;
  if (index > vertex_count && (uint64_t)index > o->highest) {
    o->highest = (uint64_t)index;
    o->highest_at = at;
  }
  *corner = (uint32_t)(negative ? vertex_count - index : index - 1);
  return SCREE_OK;
}

static scree_status read_face(scree_text *t, obj *o) {
  o->face.count = 0;
  while (statement_goes_on(t)) {
    uint32_t corner = 0;
    SCREE_TRY(read_corner(t, o, &corner));
    if (!SCREE_PUSH(&o->face, corner))
      return scree_fail_memory(t->error, o->face.capacity * sizeof corner, "a face of an OBJ");
  }
  if (!scree_face_list_add(&o->faces, o->face.items, o->face.count))
    return scree_fail_memory(t->error, o->faces.triangles.capacity * sizeof(uint32_t),
                             "the faces of an OBJ");
  return SCREE_OK;
}

/* A word of one letter, also alone on its line. */
static bool at_short_word(const scree_text *t) {
  scree_text behind = *t;
  if (behind.p++ == t->end) return false;
  return scree_text_at_line_end(&behind) || *behind.p == ' ' || *behind.p == '\t';
}

static scree_status read_lines(scree_text *t, obj *o) {
  while (t->p < t->end) {
    scree_text_skip_space(t);
    const char *p = t->p;
    bool short_word = at_short_word(t);
    scree_status status = SCREE_OK;
    t->p += short_word;
    if (short_word && (*p == 'v' || *p == 'V'))
      status = read_vertex(t, o);
    else if (short_word && (*p == 'f' || *p == 'F'))
      status = read_face(t, o);
    if (status != SCREE_OK) return status;
    scree_text_skip_line(t);
  }
  if (o->highest > o->positions.count / 3)
    return scree_text_fail(t, o->highest_at, "a face has vertex %llu, but the file has %zu",
                           (unsigned long long)o->highest, o->positions.count / 3);
  return SCREE_OK;
}

scree_status scree_read_obj(scree_reading *r) {
  snprintf(r->scan->format, sizeof r->scan->format, "OBJ");
  scree_text text = scree_reading_text(r);
  obj o = {0};
  scree_status status = read_lines(&text, &o);
  if (status == SCREE_OK)
    status = scree_reading_weld_faces(r, o.positions.items, o.positions.count / 3, &o.faces);
  scree_free(o.positions.items);
  scree_free(o.face.items);
  scree_face_list_free(&o.faces);
  return status;
}
