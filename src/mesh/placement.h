/* Where a file places a part: an affine map. */
#ifndef SCREE_MESH_PLACEMENT_H
#define SCREE_MESH_PLACEMENT_H

#include <stdbool.h>

typedef struct scree_placement {
  double m[3][4]; /* rows: p becomes m[.][0..2] p + m[.][3] */
} scree_placement;

static const scree_placement scree_placement_none = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

static inline scree_placement scree_placement_in(const scree_placement *outer,
                                                 const scree_placement *inner) {
  scree_placement p;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 4; j++) {
      p.m[i][j] = j == 3 ? outer->m[i][3] : 0;
      for (int k = 0; k < 3; k++) p.m[i][j] += outer->m[i][k] * inner->m[k][j];
    }
  return p;
}

/* It turns what looks outward inward. */
static inline bool scree_placement_mirrors(const scree_placement *p) {
  const double(*m)[4] = p->m;
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
         0;
}

static inline void scree_placement_apply(const scree_placement *p, const double v[3],
                                         double out[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = p->m[i][0] * v[0] + p->m[i][1] * v[1] + p->m[i][2] * v[2] + p->m[i][3];
}

#endif
