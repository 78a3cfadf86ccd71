#include "clump/lines.h"

#include "base/array.h"

#include <stdlib.h>

typedef struct hit {
  size_t line;
  int turn; /* +1 where the line enters, -1 where it leaves */
  double z;
} hit;

typedef struct hits {
  hit *items;
  size_t count, capacity;
} hits;

static int by_place(const void *a, const void *b) {
  const hit *p = a, *q = b;
  if (p->line != q->line) return p->line < q->line ? -1 : 1;
  if (p->z != q->z) return p->z < q->z ? -1 : 1;
  return q->turn - p->turn;
}

/* Twice the area of the triangle (a, b, (x, y)) as seen along z; from b to a the same, negative. */
static double area_beside(vec3 a, vec3 b, double x, double y) {
  bool swapped = a.x > b.x || (a.x == b.x && a.y > b.y);
  vec3 p = swapped ? b : a, q = swapped ? a : b;
  double area = (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
  return swapped ? -area : area;
}

/* Indices of lines in [low, high]. */
static void index_range(double low, double high, double origin, double step, size_t count,
                        size_t range[2]) {
  double first = fmax(0, ceil((low - origin) / step)), end = floor((high - origin) / step) + 1;
  range[0] = (size_t)first;
  range[1] = end > first ? (size_t)fmin(end, (double)count) : range[0];
}

static bool cast_triangle(const scree_lines *l, const vec3 p[3], hits *found) {
  size_t across[2], along[2];
  index_range(fmin(p[0].x, fmin(p[1].x, p[2].x)), fmax(p[0].x, fmax(p[1].x, p[2].x)), l->x0,
              l->step, l->nx, across);
  index_range(fmin(p[0].y, fmin(p[1].y, p[2].y)), fmax(p[0].y, fmax(p[1].y, p[2].y)), l->y0,
              l->step, l->ny, along);
  for (size_t i = across[0]; i < across[1]; i++)
    for (size_t j = along[0]; j < along[1]; j++) {
      double x = l->x0 + (double)i * l->step, y = l->y0 + (double)j * l->step;
      double u = area_beside(p[1], p[2], x, y), v = area_beside(p[2], p[0], x, y),
             w = area_beside(p[0], p[1], x, y), sum = u + v + w;
      bool up = u > 0 && v > 0 && w > 0, down = u < 0 && v < 0 && w < 0;
      if (!up && !down) continue;
      double z = (u * p[0].z + v * p[1].z + w * p[2].z) / sum;
      if (!SCREE_PUSH(found, (hit){i * l->ny + j, down ? 1 : -1, z})) return false;
    }
  return true;
}

/* The stretches of each line where the winding number is above 0. */
static void gather(const hits *found, scree_lines *l) {
  size_t span = 0, k = 0;
  for (size_t line = 0; line < l->nx * l->ny; line++) {
    int winding = 0;
    l->first[line] = span;
    for (; k < found->count && found->items[k].line == line; k++) {
      int before = winding;
      winding += found->items[k].turn;
      if (before <= 0 && winding > 0) l->spans[span].low = found->items[k].z;
      if (before > 0 && winding <= 0) l->spans[span++].high = found->items[k].z;
    }
  }
  l->first[l->nx * l->ny] = span;
}

scree_status scree_lines_cast(const scree_target *body, scree_lines *lines, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) hits found = {0};
  for (size_t t = 0; t < body->mesh.triangle_count; t++) {
    vec3 p[3];
    for (int k = 0; k < 3; k++)
      p[k] = scree_lines_turn(lines, scree_mesh_corner(&body->mesh, t, k));
    if (!cast_triangle(lines, p, &found))
      return scree_fail_memory(error, 0, "lines through a body");
  }
  if (found.count > 0) qsort(found.items, found.count, sizeof *found.items, by_place);
  SCREE_TRY_ALLOC(lines->first, lines->nx * lines->ny + 1, error);
  SCREE_TRY_ALLOC(lines->spans, found.count + 1, error);
  gather(&found, lines);
  return SCREE_OK;
}

void scree_lines_free(scree_lines *lines) {
  scree_free(lines->first);
  scree_free(lines->spans);
  lines->first = NULL;
  lines->spans = NULL;
}

bool scree_lines_inside(const scree_lines *l, size_t line, double z) {
  for (size_t k = l->first[line]; k < l->first[line + 1]; k++)
    if (z > l->spans[k].low && z < l->spans[k].high) return true;
  return false;
}
