/* Where a file places a part: an affine map. */
#pragma once

#include <stdbool.h>

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
