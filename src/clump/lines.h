/* Parallel lines through a body: the intervals of each that lie inside. Integrals of what lies
 * between are exact along the lines and sums across them. */
#ifndef SCREE_CLUMP_LINES_H
#define SCREE_CLUMP_LINES_H

#include "clump/target.h"

typedef struct scree_span {
  double low, high; /* z */
} scree_span;

/* Line (i, j), number i * ny + j, stands at x = x0 + i step, y = y0 + j step. Its intervals are
 * spans[first[line]] to spans[first[line + 1] - 1], ascending. */
typedef struct scree_lines {
  size_t nx, ny;
  double x0, y0, step;
  size_t *first;
  scree_span *spans;
} scree_lines;

/* Fills first and spans of lines whose other fields are set: where the winding number of the body
 * is positive. Edges are seen with the same bits from both their triangles, so that no line slips
 * between two. */
scree_status scree_lines_cast(const scree_target *body, scree_lines *lines, scree_error *error);
void scree_lines_free(scree_lines *lines);

/* Whether z lies inside on the line. */
bool scree_lines_inside(const scree_lines *lines, size_t line, double z);

#endif
