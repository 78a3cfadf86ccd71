/* Clumps from tables: x, y, z and radius of a sphere a line, between blanks, commas or semicolons;
 * a first line of words, empty lines and lines that begin with # are passed over. */
#include "base/array.h"
#include "base/file.h"
#include "base/number.h"
#include "mesh/text.h"
#include "mesh/weld.h"
#include "particle/particle.h"

#include <math.h>
#include <string.h>

enum { MOST_SPHERES = 10000 }; /* their union is integrated in seconds */

typedef struct spheres {
  double *centres, *radii;
  size_t count, centre_capacity, radius_capacity;
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

static scree_status read_spheres(scree_text *t, spheres *s) {
  while (t->p < t->end) {
    const char *line = t->p;
    double row[4];
    scree_text_skip_blanks(t);
    if (!scree_text_at_line_end(t) && *t->p != '#') {
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

scree_status scree_particle_clump_read(const char *path, double unit_m, scree_particle **particle,
                                       scree_error *error) {
  char *bytes;
  size_t count;
  spheres s = {0};
  scree_status status = scree_file_read(path, 0, &bytes, &count, error);
  if (status != SCREE_OK) return status;
  scree_text text = {bytes, bytes, bytes + count, path, unit_m, error};
  status = read_spheres(&text, &s);
  if (status == SCREE_OK)
    status = scree_particle_clump(s.centres, s.radii, s.count, NULL, particle, error);
  scree_free(s.centres);
  scree_free(s.radii);
  scree_free(bytes);
  return status;
}
