/* A clump as a table that scree_particle_clump_read reads. */
#include "base/error.h"
#include "base/file.h"
#include "base/number.h"
#include "mesh/io/write.h"
#include "scree.h"

#include <stdio.h>

static void put_number(FILE *f, double value) {
  char text[SCREE_NUMBER_SIZE];
  scree_number_format(value, text);
  fputs(text, f);
}

/* The body's mass properties, which go with the clump. */
static void put_body(FILE *f, const scree_measures *m, double unit_m) {
  static const int index[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  double area = unit_m * unit_m, volume = area * unit_m;
  fputs("# volume ", f);
  put_number(f, m->volume / volume);
  fputs("\n# centroid", f);
  for (int k = 0; k < 3; k++) {
    putc(' ', f);
    put_number(f, m->centroid[k] / unit_m);
  }
  fputs("\n# inertia", f);
  for (int k = 0; k < 6; k++) {
    putc(' ', f);
    put_number(f, m->inertia[index[k][0]][index[k][1]] / (volume * area));
  }
  putc('\n', f);
}

scree_status scree_spheres_write(const scree_clumps *clumps, const scree_clump *clump,
                                 double unit_m, const char *path, bool overwrite,
                                 scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  char provenance[SCREE_PROVENANCE_SIZE];
  scree_provenance_text(unit_m, NULL, provenance);
  fprintf(output.stream, "x,y,z,radius\n# %s\n", provenance);
  put_body(output.stream, &clumps->measures, unit_m);
  for (size_t i = 0; i < clump->sphere_count; i++) {
    const scree_sphere *s = &clump->spheres[i];
    for (int k = 0; k < 3; k++) {
      put_number(output.stream, s->centre[k] / unit_m);
      putc(',', output.stream);
    }
    put_number(output.stream, s->radius / unit_m);
    putc('\n', output.stream);
  }
  return scree_output_commit(&output, error);
}
