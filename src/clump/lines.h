/* Parallel lines through a body: the intervals of each that lie inside. Integrals of what lies
 * between are exact along the lines and sums across them. */
#pragma once

#include "clump/target.h"

typedef struct scree_span {
  double low, high; /* z */
} scree_span;

/* Line (i, j), number i * ny + j, stands at u = x0 + i step, v = y0 + j step, where (u, v) is (x,
 * y) turned about z. Its intervals are spans[first[line]] to spans[first[line + 1] - 1], ascending.
 */
typedef struct scree_lines {
  size_t nx, ny;
  double x0, y0, step;
  double cosine, sine; /* of the turn */
  size_t *first;
  scree_span *spans;
} scree_lines;

/* Between the body's frame and that of the lines. */
static inline vec3 scree_lines_turn(const scree_lines *l, vec3 p) {
  return (vec3){l->cosine * p.x + l->sine * p.y, l->cosine * p.y - l->sine * p.x, p.z};
}
static inline vec3 scree_lines_turn_back(const scree_lines *l, vec3 p) {
  return (vec3){l->cosine * p.x - l->sine * p.y, l->cosine * p.y + l->sine * p.x, p.z};
}

/* Fills first and spans of lines whose other fields are set: where the winding number of the body
 * is positive. Edges are seen with the same bits from both their triangles, so that no line slips
 * between two. */
scree_status scree_lines_cast(const scree_target *body, scree_lines *lines, scree_error *error);
void scree_lines_free(scree_lines *lines);

/* Whether z lies inside on the line. */
bool scree_lines_inside(const scree_lines *lines, size_t line, double z);
