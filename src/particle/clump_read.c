/* Clumps from tables: x, y, z and radius of a sphere a line, between blanks, commas or semicolons;
 * a first line of words, empty lines and lines that begin with # are passed over, but for that of
 * the unit, which stands before all numbers, and those of the body that the clump stands for:
 *
 *   # scree VERSION, unit NUMBER m
 *   # volume V
 *   # centroid X Y Z
 *   # inertia XX YY ZZ XY XZ YZ
 *
 * in the file's unit, the inertia about the centroid for density 1. With all three its mass, centre
 * and inertia are the clump's, else those of the spheres' union. */
#include "base/array.h"
#include "base/file.h"
#include "base/number.h"
#include "mesh/text.h"
#include "mesh/weld.h"
#include "mesh/write.h"
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
} spheres;

static bool push_sphere(spheres *s, const double row[4]) {
  if (!scree_array_reserve((void **)&s->centres, &s->centre_capacity, 3 * (s->count + 1),
                           sizeof *s->centres) ||
      !scree_array_reserve((void **)&s->radii, &s->radius_capacity, s->count + 1, sizeof *s->radii))
    return false;
  memcpy(s->centres + 3 * s->count, row, 3 * sizeof *row);
  s->radii[s->count++] = row[3];
  return true;
}

/* The numbers of the line, m; how many there are, 5 where more or something else stands there. */
static int read_row(scree_text *t, double row[4]) {
  for (int count = 0;; count++) {
    while (t->p < t->end && (*t->p == ',' || *t->p == ';' || *t->p == ' ' || *t->p == '\t')) t->p++;
    if (scree_text_at_line_end(t)) return count;
    double value;
    const char *behind = scree_number_parse(t->p, t->end, &value);
    if (!behind || count == 4) return count ? 5 : 0;
    row[count] = value * t->unit_m;
    t->p = behind;
    if (!scree_text_at_line_end(t) && !strchr(",; \t", *t->p)) return 5;
  }
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

static scree_status read_spheres(scree_text *t, spheres *s) {
  while (t->p < t->end) {
    const char *line = t->p;
    double row[4];
    scree_text_skip_blanks(t);
    if (!scree_text_at_line_end(t) && *t->p == '#') {
      if (!read_body(t, s))
        return scree_text_fail(t, line, "must be the volume, centroid or inertia of a body");
      t->p = line;
    } else if (!scree_text_at_line_end(t)) {
      int count = read_row(t, row);
      if (count != 4 && !(count == 0 && line == t->begin))
        return scree_text_fail(t, line, "must be x, y, z, radius of a sphere");
      for (int k = 0; k < count; k++)
        if (!(fabs(row[k]) <= SCREE_COORDINATE_LIMIT))
          return scree_text_fail(t, line, "numbers must be finite and at most %g m in size",
                                 SCREE_COORDINATE_LIMIT);
      if (count == 4 && !(row[3] > 0))
        return scree_text_fail(t, line, "the radius is %g m; it must be above 0", row[3]);
      if (count == 4 && s->count == MOST_SPHERES)
        return scree_text_fail(t, line, "more than %d spheres", MOST_SPHERES);
      if (count == 4 && !push_sphere(s, row))
        return scree_fail_memory(t->error, s->count * sizeof row, "the spheres of a clump");
    }
    scree_text_skip_line(t);
  }
  if (s->count == 0) return scree_fail(t->error, SCREE_BAD_FILE, "%s: no spheres", t->name);
  return SCREE_OK;
}

scree_status scree_particle_clump_read(const char *path, const scree_read_options *options,
                                       scree_particle **particle, scree_error *error) {
  const scree_read_options o = options ? *options : scree_default_read_options();
  char *bytes;
  size_t count;
  spheres s = {.keep_unit = o.ignore_comment_unit};
  scree_status status = scree_file_read(path, o.max_bytes, &bytes, &count, error);
  if (status != SCREE_OK) return status;
  scree_text text = {bytes, bytes, bytes + count, path, o.unit_m, error};
  status = read_spheres(&text, &s);
  if (status == SCREE_OK)
    status = scree_particle_clump_of(s.centres, s.radii, s.count,
                                     s.known == (VOLUME | CENTROID | INERTIA) ? &s.body : NULL,
                                     particle, error);
  scree_free(s.centres);
  scree_free(s.radii);
  scree_free(bytes);
  return status;
}
