#include "cli/clump.h"

#include <stdlib.h>
#include <string.h>

bool cli_is_clump(const char *word) {
  const char *dot = strrchr(word, '.');
  return dot && !strcmp(dot, ".csv");
}

static scree_status fail(scree_error *error, scree_status status, const char *path,
                         const char *what) {
  error->status = status;
  snprintf(error->message, sizeof error->message, "%.300s: %.700s", path, what);
  return status;
}

typedef struct spheres {
  double *centres, *radii;
  size_t count, capacity;
} spheres;

static bool push_sphere(spheres *s, const double row[4]) {
  if (s->count == s->capacity) {
    size_t capacity = s->capacity ? 2 * s->capacity : 64;
    double *centres = realloc(s->centres, 3 * capacity * sizeof *centres);
    if (centres) s->centres = centres;
    double *radii = realloc(s->radii, capacity * sizeof *radii);
    if (radii) s->radii = radii;
    if (!centres || !radii) return false;
    s->capacity = capacity;
  }
  memcpy(s->centres + 3 * s->count, row, 3 * sizeof *row);
  s->radii[s->count++] = row[3];
  return true;
}

/* A first line of words and lines that begin with # are passed over. */
static scree_status read_spheres(const char *path, double unit, spheres *s, scree_error *error) {
  FILE *stream = fopen(path, "r");
  if (!stream) return fail(error, SCREE_IO, path, "cannot open");
  char line[512], what[160];
  size_t number = 0;
  scree_status status = SCREE_OK;
  while (status == SCREE_OK && fgets(line, sizeof line, stream)) {
    double row[4];
    char rest[2];
    number++;
    if (line[0] == '#' || line[strspn(line, " \t\r\n")] == 0) continue;
    for (char *c = line; *c; c++)
      if (*c == ',' || *c == ';') *c = ' ';
    int found = sscanf(line, "%lf %lf %lf %lf %1s", &row[0], &row[1], &row[2], &row[3], rest);
    if (found <= 0 && number == 1) continue;
    if (found != 4) {
      snprintf(what, sizeof what, "line %zu: must be x, y, z, radius of a sphere", number);
      status = fail(error, SCREE_BAD_FILE, path, what);
      break;
    }
    for (int k = 0; k < 4; k++) row[k] *= unit;
    if (!push_sphere(s, row)) status = fail(error, SCREE_OUT_OF_MEMORY, path, "out of memory");
  }
  fclose(stream);
  if (status == SCREE_OK && s->count == 0) status = fail(error, SCREE_BAD_FILE, path, "no spheres");
  return status;
}

scree_status cli_read_clump(const char *path, double unit, scree_particle **particle,
                            scree_error *error) {
  spheres s = {0};
  scree_status status = read_spheres(path, unit, &s, error);
  if (status == SCREE_OK) {
    status = scree_particle_clump(s.centres, s.radii, s.count, NULL, particle, error);
    if (status != SCREE_OK) {
      char message[sizeof error->message];
      memcpy(message, error->message, sizeof message);
      fail(error, status, path, message);
    }
  }
  free(s.centres);
  free(s.radii);
  return status;
}
