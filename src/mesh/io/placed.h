/* The triangles of a file's placed parts, in its unit: what readers of files with instances end in.
 */
#pragma once

#include "mesh/io/read.h"

#include <stdbool.h>

/* Where a file places a part: an affine map. */
typedef struct scree_affine {
  double m[3][4]; /* rows: p becomes m[.][0..2] p + m[.][3] */
} scree_affine;

static const scree_affine scree_affine_none = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

static inline scree_affine scree_affine_in(const scree_affine *outer, const scree_affine *inner) {
  scree_affine p;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 4; j++) {
      p.m[i][j] = j == 3 ? outer->m[i][3] : 0;
      for (int k = 0; k < 3; k++) p.m[i][j] += outer->m[i][k] * inner->m[k][j];
    }
  return p;
}

/* It turns what looks outward inward. */
static inline bool scree_affine_mirrors(const scree_affine *p) {
  const double(*m)[4] = p->m;
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
         0;
}

static inline void scree_affine_apply(const scree_affine *p, const double v[3], double out[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = p->m[i][0] * v[0] + p->m[i][1] * v[1] + p->m[i][2] * v[2] + p->m[i][3];
}

enum { SCREE_PLACED_MOST = 1 << 26 }; /* triangles, and vertices */

typedef struct scree_placed {
  struct {
    double *items;
    size_t count, capacity;
  } positions; /* three each */
  scree_face_list faces;
} scree_placed;

/* Adds vertex_count vertices, placed, and the triangles between them, which stay outward where the
 * placement mirrors. SCREE_LIMIT above SCREE_PLACED_MOST of either. */
scree_status scree_placed_add(scree_reading *r, scree_placed *placed, const scree_affine *where,
                              const double *vertices, size_t vertex_count);
scree_status scree_placed_add_triangle(scree_reading *r, scree_placed *placed, size_t first_vertex,
                                       const uint32_t corners[3], bool is_mirrored);
/* Whether the part of the file that comes next, of this name (NULL: none), is to be read. */
bool scree_placed_wants(scree_reading *r, const char *name);
/* Welds them into r->scan->mesh. */
scree_status scree_placed_weld(scree_reading *r, scree_placed *placed);
void scree_placed_free(scree_placed *placed);
