/* Mixing by Lacey's index (Journal of Applied Chemistry 4, 257, 1954) of one class of bodies
 * against all others: (s0^2 - s^2)/(s0^2 - sr^2). With a share p of the N bodies of all C cells
 * that hold any, s^2 is the variance of the share between cells, by their bodies, s0^2 = p(1 - p)
 * what it is when the classes are apart, and sr^2 = s0^2 (C - 1)/(N - 1) its expectation where
 * bodies are dealt to the cells at random, without replacement. Of such a mixture s^2 N/s0^2 has
 * the variance 2(C - 1) about C - 1, of which the index' own scatter about 1 follows; where that is
 * large the cells hold too few bodies, and there is no index. What is by chance more even than a
 * random mixture counts as mixed. */
#include "scene/sensors/mixing.h"

#include "base/alloc.h"

#include <stdlib.h>
#include <string.h>

static const double most_scatter = 0.1; /* standard deviation of a random mixture's index */

typedef struct cell_body {
  int64_t cell[3];
  uint32_t class;
} cell_body;

typedef struct mixture {
  cell_body *bodies; /* by cell */
  size_t count;
  double cells; /* that hold any */
} mixture;

static int by_cell(const void *a, const void *b) {
  const cell_body *p = a, *q = b;
  for (int k = 0; k < 3; k++)
    if (p->cell[k] != q->cell[k]) return p->cell[k] < q->cell[k] ? -1 : 1;
  return (p->class > q->class) - (p->class < q->class);
}

static double scatter_of(const mixture *m) {
  double n = (double)m->count;
  return sqrt(2 * (m->cells - 1)) / (n - n * (m->cells - 1) / (n - 1));
}

static bool is_fine_enough(const mixture *m) {
  return m->cells > 1 && m->count > m->cells && scatter_of(m) <= most_scatter;
}

static double lacey(const mixture *m, uint32_t class) {
  double of_class = 0, sum = 0, n = (double)m->count;
  for (size_t i = 0; i < m->count; i++) of_class += m->bodies[i].class == class;
  double p = of_class / n, apart = p * (1 - p);
  if (!is_fine_enough(m) || !(apart > 0)) return NAN;
  for (size_t i = 0, j; i < m->count; i = j) {
    const cell_body *first = &m->bodies[i];
    double in = 0;
    for (j = i; j < m->count && !memcmp(first->cell, m->bodies[j].cell, sizeof first->cell); j++)
      in += m->bodies[j].class == class;
    double here = (double)(j - i), off = in / here - p;
    sum += here * off * off;
  }
  double mixed = apart * (m->cells - 1) / (n - 1);
  return fmin(1, (apart - sum / n) / (apart - mixed));
}

static bool take_mixture(const scree_scene *scene, const scree_scene_sensor *sensor,
                         scree_find_cell *find, int by, mixture *mixed) {
  mixture m = {.bodies = scree_alloc(scene->shape_of.count, sizeof *m.bodies)};
  if (!m.bodies) return false;
  scree_body body;
  for (size_t b = 0; scree_scene_next_body(scene, &b, &body); b++) {
    cell_body *to = &m.bodies[m.count];
    if (!find(scene, sensor, body.position, to->cell)) continue;
    to->class = (uint32_t)scree_scene_class_of(scene, by, scene->shape_of.items[b]);
    m.count++;
  }
  if (m.count) qsort(m.bodies, m.count, sizeof *m.bodies, by_cell);
  for (size_t i = 0; i < m.count; i++)
    m.cells +=
        i == 0 || memcmp(m.bodies[i].cell, m.bodies[i - 1].cell, sizeof m.bodies[i].cell) != 0;
  *mixed = m;
  return true;
}

scree_status scree_mixing_measure(const scree_scene *scene, const scree_scene_sensor *sensor,
                                  scree_find_cell *find, int by, double *per_cell, double *indices,
                                  scree_error *error) {
  size_t classes = scree_scene_class_count(scene, by);
  mixture m;
  if (!take_mixture(scene, sensor, find, by, &m))
    return scree_fail_memory(error, scene->shape_of.count * sizeof *m.bodies, "a mixture");
  if (per_cell) *per_cell = m.cells > 0 ? (double)m.count / m.cells : NAN;
  for (size_t c = 0; classes > 1 && c < classes; c++) indices[c] = lacey(&m, (uint32_t)c);
  scree_free(m.bodies);
  return SCREE_OK;
}

bool scree_mixing_doubt(const scree_scene *scene, const scree_scene_sensor *sensor,
                        scree_find_cell *find, int by, char text[SCREE_REMARK]) {
  mixture m;
  if (scree_scene_class_count(scene, by) < 2) return false;
  if (!take_mixture(scene, sensor, find, by, &m)) return false;
  bool told = m.count > 0 && !is_fine_enough(&m);
  scree_free(m.bodies);
  if (told)
    snprintf(text, SCREE_REMARK,
             "%s: %zu bodies in %.0f cells: too few in a cell, or too few cells, for Lacey's "
             "index, which would scatter by more than %g; %s cells",
             sensor->plan->place.path, m.count, m.cells, most_scatter,
             m.cells > 1 ? "larger" : "smaller");
  return told;
}
