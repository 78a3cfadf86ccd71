/* Clumps from tables: a sphere a line. The first line that is no comment may name the columns, in
 * any order and among others (particle/columns.h); without it they are x, y, z, radius, behind a
 * number that counts the lines where there are five. Comments begin with #, % or //. Of the
 * comments scree reads that of the unit, which stands before all numbers, and those of the body
 * that the clump stands for:
 *
 *   # scree VERSION, unit NUMBER m
 *   # volume V
 *   # centroid X Y Z
 *   # inertia XX YY ZZ XY XZ YZ
 *
 * in the file's unit, the inertia about the centroid for density 1. With all three its mass, centre
 * and inertia are the clump's, else those of the spheres' union.
 *
 * PFC's `clump template create` is read too: `pebbles N` and N times radius, x, y, z; with `volume`
 * and `inertia`, about the origin, as the body's. */
#include "base/array.h"
#include "base/file.h"
#include "base/number.h"
#include "mesh/io/text.h"
#include "mesh/io/write.h"
#include "mesh/weld.h"
#include "particle/columns.h"
#include "particle/particle.h"

#include <math.h>
#include <string.h>

enum { MOST_SPHERES = 10000 }; /* their union is integrated in seconds */

enum { VOLUME = 1, CENTROID = 2, INERTIA = 4 };

typedef struct spheres {
  double *centres, *radii;
  size_t count, centre_capacity, radius_capacity;
  scree_solid body; /* that it stands for */
  unsigned known;   /* what of it was read */
  bool keep_unit;   /* whatever the table says */
  bool is_begun;    /* a line was read that is no comment */
  double first_id;  /* of lines that begin with their number */
  scree_columns columns;
} spheres;

static void free_spheres(spheres *s) {
  scree_free(s->centres);
  scree_free(s->radii);
}

static bool push_sphere(spheres *s, const double row[4]) {
  if (!scree_array_reserve((void **)&s->centres, &s->centre_capacity, 3 * (s->count + 1),
                           sizeof *s->centres) ||
      !scree_array_reserve((void **)&s->radii, &s->radius_capacity, s->count + 1, sizeof *s->radii))
    return false;
  memcpy(s->centres + 3 * s->count, row, 3 * sizeof *row);
  s->radii[s->count++] = row[3];
  return true;
}

/* So many numbers up to the line's end, in units to that power. */
static bool read_values(scree_text *t, int count, int power, double *values) {
  for (int i = 0; i < count; i++) {
    scree_text_skip_blanks(t);
    const char *behind = scree_number_parse(t->p, t->end, &values[i]);
    if (!behind || !isfinite(values[i])) return false;
    for (int k = 0; k < power; k++) values[i] *= t->unit_m;
    t->p = behind;
  }
  scree_text_skip_blanks(t);
  return scree_text_at_line_end(t);
}

/* The second moments of an inertia: tr(I) / 2 - I. */
static mat3 second_of(const double inertia[6]) {
  static const int index[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  mat3 m;
  double half = 0.5 * (inertia[0] + inertia[1] + inertia[2]);
  for (int k = 0; k < 6; k++) {
    int i = index[k][0], j = index[k][1];
    m.m[i][j] = m.m[j][i] = (i == j ? half : 0) - inertia[k];
  }
  return m;
}

/* A line that begins with #: false where it begins as one of the body's does and does not go on so.
 */
static bool read_body(scree_text *t, spheres *s) {
  double values[6];
  t->p++;
  scree_text_skip_blanks(t);
  if (scree_text_at_line_end(t)) return true;
  double unit = s->count || s->known || s->keep_unit ? 0 : scree_provenance_unit(t->p, t->end);
  if (unit > 0) t->unit_m = unit;
  scree_token word = scree_text_next(t);
  if (scree_token_is(word, "volume")) {
    s->known |= VOLUME;
    return read_values(t, 1, 3, &s->body.volume) && s->body.volume > 0;
  }
  if (scree_token_is(word, "centroid")) {
    s->known |= CENTROID;
    if (!read_values(t, 3, 1, values)) return false;
    s->body.centre = vec3_load(values);
  }
  if (scree_token_is(word, "inertia")) {
    s->known |= INERTIA;
    if (!read_values(t, 6, 5, values)) return false;
    s->body.second = second_of(values);
    for (int k = 0; k < 3; k++)
      if (!(s->body.second.m[k][k] > 0)) return false;
  }
  return true;
}

static scree_status add_sphere(scree_text *t, const char *line, spheres *s, const double row[4]) {
  for (int k = 0; k < 4; k++)
    if (!(fabs(row[k]) <= SCREE_COORDINATE_LIMIT))
      return scree_text_fail(t, line, "numbers must be finite and at most %g m in size",
                             SCREE_COORDINATE_LIMIT);
  if (!(row[3] > 0))
    return scree_text_fail(t, line, "the radius is %g m; it must be above 0", row[3]);
  if (s->count == MOST_SPHERES)
    return scree_text_fail(t, line, "more than %d spheres", MOST_SPHERES);
  if (!push_sphere(s, row))
    return scree_fail_memory(t->error, s->count * sizeof *row, "the spheres of a clump");
  return SCREE_OK;
}

/* A row without names: x, y, z, radius, or the line's number before them. */
static scree_status read_bare_row(scree_text *t, spheres *s, const scree_token *cells, size_t count,
                                  double row[4]) {
  double id = 0;
  size_t first = count == 5 ? 1 : 0;
  bool is_row = count == 4 || count == 5;
  for (size_t i = 0; i < count && is_row; i++) {
    const char *end = cells[i].begin + cells[i].length;
    is_row = scree_number_parse(cells[i].begin, end, i < first ? &id : &row[i - first]) == end;
  }
  if (is_row && first && s->count == 0) s->first_id = id;
  if (is_row &&
      (!first || (id == s->first_id + (double)s->count && (s->first_id == 0 || s->first_id == 1))))
    return SCREE_OK;
  return scree_text_fail(t, cells->begin,
                         "must be x, y, z, radius of a sphere; other columns are named in a first "
                         "line, as `id,x,y,z,diameter`");
}

static scree_status read_named_row(scree_text *t, const spheres *s, const char *line,
                                   const scree_token *cells, size_t count, double row[4]) {
  static const char *const names[] = {"x", "y", "z", "the size"};
  if (count != s->columns.count)
    return scree_text_fail(t, line, "%zu columns, but the first line names %zu", count,
                           s->columns.count);
  for (int k = 0; k < 4; k++) {
    scree_token cell = cells[s->columns.at[k]];
    const char *end = cell.begin + cell.length;
    if (cell.length == 0 || scree_number_parse(cell.begin, end, &row[k]) != end)
      return scree_text_fail(t, line, "%s is '%.*s'; it must be a number with a decimal point",
                             names[k], cell.length < 40 ? (int)cell.length : 40, cell.begin);
  }
  row[3] *= s->columns.share;
  return SCREE_OK;
}

/* Whether the line names columns; it may be a comment. */
static scree_status read_names(scree_text *t, spheres *s, const char *line, const char *end,
                               bool is_comment) {
  char reason[160];
  scree_columns columns;
  if (scree_columns_name(line, end, &columns, reason)) {
    s->columns = columns;
    if (columns.unit_m > 0 && !s->keep_unit) t->unit_m = columns.unit_m;
  } else if (!is_comment) {
    return scree_text_fail(t, line, "%s",
                           *reason ? reason
                                   : "must be x, y, z, radius of a sphere, "
                                     "or name its columns so");
  }
  return SCREE_OK;
}

static const char *end_of_line(const scree_text *t) {
  const char *p = t->p;
  while (p < t->end && *p != '\n' && *p != '\r') p++;
  return p;
}

static const char *comment_in(const char *line, const char *end) {
  for (const char *p = line; p < end; p++)
    if (*p == '#' || *p == '%' || (*p == '/' && p + 1 < end && p[1] == '/')) return p;
  return end;
}

static scree_status read_line(scree_text *t, spheres *s, const char *line, const char *end) {
  scree_token cells[SCREE_MOST_COLUMNS];
  double row[4] = {0}, value;
  scree_status status;
  if (!s->is_begun && s->columns.count == 0 && !scree_number_parse(line, end, &value)) {
    s->is_begun = true;
    return read_names(t, s, line, end, false);
  }
  s->is_begun = true;
  size_t count = scree_columns_split(line, end, s->columns.count ? s->columns.separator : 0, cells);
  if (count > SCREE_MOST_COLUMNS)
    return scree_text_fail(t, line, "more than %d columns", SCREE_MOST_COLUMNS);
  status = s->columns.count ? read_named_row(t, s, line, cells, count, row)
                            : read_bare_row(t, s, cells, count, row);
  for (int k = 0; k < 4 && status == SCREE_OK; k++) row[k] *= t->unit_m;
  return status == SCREE_OK ? add_sphere(t, line, s, row) : status;
}

static scree_status read_spheres(scree_text *t, spheres *s) {
  while (t->p < t->end) {
    scree_text_skip_blanks(t);
    const char *line = t->p, *end = end_of_line(t), *comment = comment_in(line, end);
    if (comment == line && line < end) {
      if (*line == '#' && !read_body(t, s))
        return scree_text_fail(t, line, "must be the volume, centroid or inertia of a body");
      if (!s->is_begun) SCREE_TRY(read_names(t, s, line + strspn(line, "#%/ "), end, true));
      t->p = line;
    } else if (line < end) {
      SCREE_TRY(read_line(t, s, line, comment));
    }
    t->p = end;
    scree_text_skip_line(t);
  }
  if (s->count == 0) return scree_fail(t->error, SCREE_BAD_FILE, "%s: no spheres", t->name);
  return SCREE_OK;
}

/* ---- PFC ---- */

/* The next word, across lines, without comments and `...` for a line that goes on. */
static scree_token next_word(scree_text *t) {
  for (;;) {
    scree_token word = scree_text_next(t);
    if (word.length == 0) return word;
    const char *mark = memchr(word.begin, ';', word.length);
    if (mark) {
      word.length = (size_t)(mark - word.begin);
      t->p = mark;
      scree_text_skip_line(t);
    }
    if (word.length && strspn(word.begin, ".") < word.length) return word;
  }
}

static bool next_number(scree_text *t, double *value) {
  scree_token word = next_word(t);
  const char *end = word.begin + word.length;
  return word.length && scree_number_parse(word.begin, end, value) == end;
}

static bool is_pfc(scree_text text) {
  return scree_token_is(next_word(&text), "clump");
}

static scree_status read_pebbles(scree_text *t, spheres *s, const char *line) {
  double count, row[4];
  if (!next_number(t, &count) || !(count >= 1 && count <= MOST_SPHERES))
    return scree_text_fail(t, line, "pebbles must be followed by their number, 1 to %d",
                           MOST_SPHERES);
  for (size_t i = 0; i < (size_t)count; i++) {
    for (int k = 0; k < 4; k++) {
      if (!next_number(t, &row[(k + 3) % 4]))
        return scree_text_fail(t, line, "pebble %zu of %.0f must be radius, x, y, z", i + 1, count);
      row[(k + 3) % 4] *= t->unit_m;
    }
    SCREE_TRY(add_sphere(t, line, s, row));
  }
  return SCREE_OK;
}

static scree_status read_pfc(scree_text *t, spheres *s) {
  static const char bad[] = "volume must be a number above 0, and inertia six numbers";
  double v[6], length = t->unit_m, volume = length * length * length;
  for (;;) {
    scree_token word = next_word(t);
    scree_status status = SCREE_OK;
    if (word.length == 0) break;
    if (scree_token_is(word, "pebbles")) {
      if (s->count)
        return scree_text_fail(t, word.begin, "a second clump: one is read from a file");
      status = read_pebbles(t, s, word.begin);
    } else if (scree_token_is(word, "volume") && s->count) {
      if (!next_number(t, v) || !(*v > 0)) return scree_text_fail(t, word.begin, bad);
      s->body.volume = *v * volume;
      s->known |= VOLUME;
    } else if (scree_token_is(word, "inertia") && s->count) {
      for (int k = 0; k < 6; k++) {
        if (!next_number(t, &v[k])) return scree_text_fail(t, word.begin, bad);
        v[k] *= volume * length * length;
      }
      s->body.second = second_of(v);
      s->known |= INERTIA | CENTROID;
      for (int k = 0; k < 3; k++)
        if (!(s->body.second.m[k][k] > 0)) return scree_text_fail(t, word.begin, bad);
    }
    if (status != SCREE_OK) return status;
  }
  if (s->count == 0) return scree_fail(t->error, SCREE_BAD_FILE, "%s: no pebbles", t->name);
  return SCREE_OK;
}

scree_status scree_particle_clump_read(const char *path, const scree_read_options *options,
                                       scree_particle **particle, scree_error *error) {
  const scree_read_options o = options ? *options : scree_default_read_options();
  SCREE_CLEANUP(scree_free_at) char *bytes = NULL;
  SCREE_CLEANUP(free_spheres) spheres s = {.keep_unit = o.ignore_comment_unit};
  size_t count;
  SCREE_TRY(scree_file_read(path, o.max_bytes, &bytes, &count, error));
  scree_text text = {bytes, bytes, bytes + count, path, o.unit_m, error};
  SCREE_TRY(is_pfc(text) ? read_pfc(&text, &s) : read_spheres(&text, &s));
  bool whole = s.known == (VOLUME | CENTROID | INERTIA);
  return scree_particle_clump_of(s.centres, s.radii, s.count, whole ? &s.body : NULL, particle,
                                 error);
}

bool scree_is_clump_table(const char *path) {
  static const char *const endings[] = {"csv", "tsv", "txt", "dat", "p3dat"};
  const char *dot = strrchr(path, '.');
  for (size_t i = 0; dot && i < sizeof endings / sizeof *endings; i++)
    if (scree_token_is((scree_token){dot + 1, strlen(dot + 1)}, endings[i])) return true;
  return false;
}

/* Spheres that only touch, by numbers that were rounded, hang together. */
static bool reach_each_other(const scree_particle *p, size_t i, size_t k) {
  const double slack = 1e-6;
  double a[3], b[3], r, s;
  scree_particle_point(p, i, a, &r);
  scree_particle_point(p, k, b, &s);
  return vec3_distance(vec3_load(a), vec3_load(b)) <= (r + s) * (1 + slack);
}

size_t scree_particle_piece_count(const scree_particle *particle) {
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  size_t count = m.kind == SCREE_PARTICLE_CLUMP ? m.point_count : 1, pieces = 0, reached = 0,
         done = 0;
  uint16_t *order = count > 1 ? scree_alloc(count, sizeof *order) : NULL;
  if (!order) return 1;
  for (size_t i = 0; i < count; i++) order[i] = (uint16_t)i;
  while (done < count) {
    if (done == reached) pieces++, reached++;
    for (size_t k = reached; k < count; k++)
      if (reach_each_other(particle, order[done], order[k])) {
        uint16_t other = order[k];
        order[k] = order[reached];
        order[reached++] = other;
      }
    done++;
  }
  scree_free(order);
  return pieces;
}
