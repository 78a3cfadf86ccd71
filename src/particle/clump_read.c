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
#include "base/rows.h"
#include "base/unit.h"
#include "mesh/io/text.h"
#include "mesh/io/write.h"
#include "mesh/weld.h"
#include "particle/particle.h"

#include <math.h>
#include <string.h>

/* The columns of a table of spheres, as its first line names them. */

typedef struct scree_columns {
  size_t count;    /* of columns; 0: no line names them, and they are x, y, z, radius */
  size_t at[4];    /* which of them is x, y, z and the size */
  double units[4]; /* that the names say, as "x (mm)", in metres; 0: none */
  double share;    /* of the size that is the radius: 1, or 0.5 of a diameter */
  char separator;
} scree_columns;

typedef enum role { ROLE_X, ROLE_Y, ROLE_Z, ROLE_RADIUS, ROLE_DIAMETER, ROLE_NONE } role;

/* Letters of the name in lower case and its digits. */
static void simplify(const char *cell, char name[24]) {
  size_t n = 0;
  for (; *cell && n < 23; cell++) {
    char c = *cell;
    if (c >= 'A' && c <= 'Z') c = (char)(c - 'A' + 'a');
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) name[n++] = c;
  }
  name[n] = 0;
}

static role role_of(const char *name) {
  static const struct {
    const char *name;
    role role;
  } names[] = {{"r", ROLE_RADIUS},      {"rad", ROLE_RADIUS},       {"radius", ROLE_RADIUS},
               {"radii", ROLE_RADIUS},  {"d", ROLE_DIAMETER},       {"dia", ROLE_DIAMETER},
               {"diam", ROLE_DIAMETER}, {"diameter", ROLE_DIAMETER}};
  static const char *const before[] = {"",       "c",      "p",     "pos",    "position",
                                       "centre", "center", "coord", "sphere", "pebble"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    size_t length = strlen(name), tail = strlen(names[i].name);
    if (!strcmp(name, names[i].name) ||
        (tail > 2 && length > tail && !strcmp(name + length - tail, names[i].name)))
      return names[i].role;
  }
  for (size_t i = 0; i < sizeof before / sizeof *before; i++) {
    size_t length = strlen(before[i]);
    if (strlen(name) >= length + 1 && !strncmp(name, before[i], length) && name[length] >= 'x' &&
        name[length] <= 'z' && (!name[length + 1] || !strcmp(name + length + 1, "coordinate")))
      return (role)(name[length] - 'x');
    if (strlen(name) == length + 1 && name[0] >= 'x' && name[0] <= 'z' &&
        !strcmp(name + 1, before[i]))
      return (role)(name[0] - 'x');
  }
  return ROLE_NONE;
}

/* Whether the row names x, y, z and radius or diameter. Names that mean nothing here are passed
 * over. False with the reason where one is missing or stands twice, "" where there is none of
 * them. */
static bool columns_name(const scree_text_rows *rows, scree_columns *columns, char reason[160]) {
  static const char *const words[] = {"x", "y", "z", "radius", "diameter"};
  size_t found[5], known = 0;
  double units[5] = {0};
  for (int i = 0; i < 5; i++) found[i] = SIZE_MAX;
  *columns = (scree_columns){.count = rows->count, .separator = rows->separator};
  reason[0] = 0;
  for (size_t i = 0; i < rows->count; i++) {
    char name[24];
    double unit_m = 1;
    const char *unit = scree_cell_unit(rows->cells[i]);
    simplify(rows->cells[i], name);
    role r = role_of(name);
    if (r == ROLE_NONE) continue;
    if (found[r] != SIZE_MAX) {
      snprintf(reason, 160, "columns %zu and %zu both say %s", found[r] + 1, i + 1, words[r]);
      return false;
    }
    found[r] = i;
    known++;
    if (*unit && scree_unit_convert(unit, "m", &unit_m) == SCREE_UNIT_FITS) units[r] = unit_m;
  }
  if (known == 0) return false;
  role size = found[ROLE_RADIUS] != SIZE_MAX ? ROLE_RADIUS : ROLE_DIAMETER;
  columns->share = size == ROLE_RADIUS ? 1 : 0.5;
  for (int i = 0; i < 4; i++) {
    role r = i == 3 ? size : (role)i;
    columns->at[i] = found[r];
    columns->units[i] = units[r];
    if (columns->at[i] != SIZE_MAX) continue;
    snprintf(reason, 160,
             "no column is named %s; a table of spheres needs x, y, z and radius or "
             "diameter",
             i == 3 ? "radius or diameter" : words[i]);
    return false;
  }
  return true;
}

enum { MOST_SPHERES = 10000 }; /* their union is integrated in seconds */

enum { VOLUME = 1, CENTROID = 2, INERTIA = 4 };

typedef struct spheres {
  double *centres, *radii;
  size_t count, centre_capacity, radius_capacity;
  scree_solid body; /* that it stands for */
  unsigned known;   /* what of it was read */
  double unit_m;    /* metres per unit, so far */
  bool keep_unit;   /* whatever the table says */
  bool is_own;      /* scree wrote it */
  bool is_begun;    /* a line was read that is no comment */
  double first_id;  /* of lines that begin with their number */
  scree_columns columns;
} spheres;

static const char *const sphere_columns[] = {"x", "y", "z", "the size"};

static scree_status fail_spheres(const spheres *s, scree_error *error) {
  return scree_fail_memory(error, s->count * 4 * sizeof(double), "the spheres of a clump");
}

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

/* A comment; false where it begins as one of the body's does and does not go on so, in a table that
 * scree wrote: others' comments may say anything. */
static bool read_body(scree_text *t, spheres *s) {
  double values[6];
  scree_text_skip_blanks(t);
  double unit = scree_provenance_unit(t->p, t->end);
  s->is_own = s->is_own || unit > 0;
  if (unit > 0 && !s->count && !s->known && !s->keep_unit) s->unit_m = t->unit_m = unit;
  scree_token word = scree_text_next(t);
  if (scree_token_is(word, "volume")) {
    if (!read_values(t, 1, 3, values) || !(*values > 0)) return !s->is_own;
    s->body.volume = *values;
    s->known |= VOLUME;
  } else if (scree_token_is(word, "centroid")) {
    if (!read_values(t, 3, 1, values)) return !s->is_own;
    s->body.centre = vec3_load(values);
    s->known |= CENTROID;
  } else if (scree_token_is(word, "inertia")) {
    if (!read_values(t, 6, 5, values)) return !s->is_own;
    mat3 second = second_of(values);
    for (int k = 0; k < 3; k++)
      if (!(second.m[k][k] > 0)) return !s->is_own;
    s->body.second = second;
    s->known |= INERTIA;
  }
  return true;
}

static const char *explain_sphere(const spheres *s, const double row[4], char reason[160]) {
  for (int k = 0; k < 4; k++)
    if (!(fabs(row[k]) <= SCREE_COORDINATE_LIMIT)) {
      snprintf(reason, 160, "numbers must be finite and at most %g m in size",
               SCREE_COORDINATE_LIMIT);
      return reason;
    }
  if (!(row[3] > 0)) snprintf(reason, 160, "the radius is %g m; it must be above 0", row[3]);
  if (s->count == MOST_SPHERES) snprintf(reason, 160, "more than %d spheres", MOST_SPHERES);
  return row[3] > 0 && s->count < MOST_SPHERES ? NULL : reason;
}

/* A row without names: x, y, z, radius, or the line's number before them. */
static scree_status read_bare_row(const scree_text_rows *rows, spheres *s, double row[4]) {
  size_t first = rows->count == 5 ? 1 : 0;
  double id = 0;
  if (rows->count != 4 + first)
    return scree_rows_fail(rows, "must be x, y, z, radius of a sphere; other columns are named in "
                                 "a first line, as `id,x,y,z,diameter`");
  if (first) SCREE_TRY(scree_rows_number(rows, 0, "the first of five numbers", &id));
  for (size_t k = 0; k < 4; k++)
    SCREE_TRY(scree_rows_number(rows, first + k, sphere_columns[k], &row[k]));
  if (first && s->count == 0) s->first_id = id;
  if (!first || (id == s->first_id + (double)s->count && (s->first_id == 0 || s->first_id == 1)))
    return SCREE_OK;
  return scree_rows_fail(rows, "must be x, y, z, radius of a sphere; other columns are named in a "
                               "first line, as `id,x,y,z,diameter`");
}

static scree_status read_named_row(const scree_text_rows *rows, const spheres *s, double row[4]) {
  if (rows->count != s->columns.count)
    return scree_rows_fail(rows, "%zu columns, but the first line names %zu", rows->count,
                           s->columns.count);
  for (size_t k = 0; k < 4; k++)
    SCREE_TRY(scree_rows_number(rows, s->columns.at[k], sphere_columns[k], &row[k]));
  row[3] *= s->columns.share;
  return SCREE_OK;
}

/* Takes the columns that the row names; false, with the reason, where it names none. */
static bool take_names(const scree_text_rows *rows, spheres *s, char reason[160]) {
  scree_columns columns;
  if (!columns_name(rows, &columns, reason)) return false;
  s->columns = columns;
  for (int k = 3; k >= 0 && !s->keep_unit; k--)
    if (columns.units[k] > 0) s->unit_m = columns.units[k];
  return true;
}

static scree_status read_row(scree_text_rows *rows, spheres *s) {
  char reason[160];
  double row[4] = {0};
  bool is_first = !s->is_begun;
  s->is_begun = true;
  if (is_first && s->columns.count == 0 && !scree_rows_has_number(rows, 0)) {
    if (take_names(rows, s, reason)) return SCREE_OK;
    return scree_rows_fail(rows, "%s",
                           *reason ? reason
                                   : "must be x, y, z, radius of a sphere, "
                                     "or name its columns so");
  }
  SCREE_TRY(s->columns.count ? read_named_row(rows, s, row) : read_bare_row(rows, s, row));
  for (int k = 0; k < 4; k++)
    row[k] *= s->columns.units[k] > 0 && !s->keep_unit ? s->columns.units[k] : s->unit_m;
  if (explain_sphere(s, row, reason)) return scree_rows_fail(rows, "%s", reason);
  return push_sphere(s, row) ? SCREE_OK : fail_spheres(s, rows->error);
}

/* Before all rows a comment may name the columns. */
static scree_status read_comment(scree_text_rows *rows, spheres *s) {
  char reason[160];
  scree_text t = {rows->comment, rows->comment, rows->comment + strlen(rows->comment),
                  rows->name,    s->unit_m,     rows->error};
  if (!read_body(&t, s))
    return scree_rows_fail(rows, "must be the volume, centroid or inertia of a body");
  if (s->is_begun || s->columns.count) return SCREE_OK;
  scree_text_rows names = {.name = rows->name, .line = rows->line};
  rows->comment += strspn(rows->comment, "#%/ ");
  if (scree_rows_split(&names, rows->comment) == SCREE_OK && take_names(&names, s, reason))
    rows->separator = names.separator;
  return SCREE_OK;
}

static scree_status read_spheres(const char *name, char *bytes, size_t count, spheres *s,
                                 scree_error *error) {
  scree_text_rows rows;
  SCREE_TRY(scree_rows_open(&rows, name, bytes, count, error));
  for (bool there;;) {
    SCREE_TRY(scree_rows_next(&rows, &there));
    if (!there) break;
    SCREE_TRY(rows.comment ? read_comment(&rows, s) : read_row(&rows, s));
  }
  return s->count ? SCREE_OK : scree_fail(error, SCREE_BAD_FILE, "%s: no spheres", name);
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
  char reason[160];
  if (!next_number(t, &count) || !(count >= 1 && count <= MOST_SPHERES))
    return scree_text_fail(t, line, "pebbles must be followed by their number, 1 to %d",
                           MOST_SPHERES);
  for (size_t i = 0; i < (size_t)count; i++) {
    for (int k = 0; k < 4; k++) {
      if (!next_number(t, &row[(k + 3) % 4]))
        return scree_text_fail(t, line, "pebble %zu of %.0f must be radius, x, y, z", i + 1, count);
      row[(k + 3) % 4] *= t->unit_m;
    }
    if (explain_sphere(s, row, reason)) return scree_text_fail(t, line, "%s", reason);
    if (!push_sphere(s, row)) return fail_spheres(s, t->error);
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
  SCREE_CLEANUP(free_spheres) spheres s = {.unit_m = o.unit_m, .keep_unit = o.ignore_comment_unit};
  size_t count;
  SCREE_TRY(scree_file_read(path, o.max_bytes, &bytes, &count, error));
  scree_text text = {bytes, bytes, bytes + count, path, o.unit_m, error};
  SCREE_TRY(is_pfc(text) ? read_pfc(&text, &s) : read_spheres(path, bytes, count, &s, error));
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
