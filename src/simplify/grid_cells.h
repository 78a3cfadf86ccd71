/* Cells of the grid and directions of normals, for grid.c and search.c. */
#ifndef SCREE_SIMPLIFY_GRID_CELLS_H
#define SCREE_SIMPLIFY_GRID_CELLS_H

#include "simplify/grid.h"

/* A box over more cells than this is not looked at cell by cell. */
enum { SCREE_CELLS_MAX = 4096 };
enum { SCREE_DIRECTIONS = 25, SCREE_TILES = 32 };
#define SCREE_ALL_AVERSE ((UINT64_C(1) << (2 * SCREE_DIRECTIONS)) - 1)

/* A direction that has no bit in averse, which is not SCREE_ALL_AVERSE. */
vec3 scree_faced_direction(uint64_t averse);

static inline uint32_t scree_cell_along(double x, double low, double per_length, uint32_t size) {
  double c = (x - low) * per_length;
  if (!(c > 0)) return 0;
  return c >= (double)size ? size - 1 : (uint32_t)c;
}

static inline scree_grid_box scree_cells_of(const scree_grid *g, vec3 low, vec3 high) {
  double k = g->cells_per_length;
  return (scree_grid_box){{(uint16_t)scree_cell_along(low.x, g->low.x, k, g->size[0]),
                           (uint16_t)scree_cell_along(low.y, g->low.y, k, g->size[1]),
                           (uint16_t)scree_cell_along(low.z, g->low.z, k, g->size[2])},
                          {(uint16_t)scree_cell_along(high.x, g->low.x, k, g->size[0]),
                           (uint16_t)scree_cell_along(high.y, g->low.y, k, g->size[1]),
                           (uint16_t)scree_cell_along(high.z, g->low.z, k, g->size[2])}};
}

static inline size_t scree_cell_of(const scree_grid *g, vec3 at) {
  double k = g->cells_per_length;
  uint32_t x = scree_cell_along(at.x, g->low.x, k, g->size[0]);
  uint32_t y = scree_cell_along(at.y, g->low.y, k, g->size[1]);
  uint32_t z = scree_cell_along(at.z, g->low.z, k, g->size[2]);
  return ((size_t)z * g->size[1] + y) * g->size[0] + x;
}

static inline size_t scree_count_cells(const scree_grid_box *c) {
  size_t count = 1;
  for (int i = 0; i < 3; i++) count *= (size_t)(c->high[i] - c->low[i]) + 1;
  return count;
}

#define SCREE_NO_CELLS ((scree_grid_box){{UINT16_MAX, UINT16_MAX, UINT16_MAX}, {0, 0, 0}})

static inline void scree_join_cells(scree_grid_box *all, const scree_grid_box *c) {
  for (int i = 0; i < 3; i++) {
    if (c->low[i] < all->low[i]) all->low[i] = c->low[i];
    if (c->high[i] > all->high[i]) all->high[i] = c->high[i];
  }
}

#define SCREE_FOR_CELLS(grid, c, cell)                                                             \
  for (uint32_t z_ = (c).low[2]; z_ <= (c).high[2]; z_++)                                          \
    for (uint32_t y_ = (c).low[1]; y_ <= (c).high[1]; y_++)                                        \
      for (size_t cell = ((size_t)z_ * (grid)->size[1] + y_) * (grid)->size[0] + (c).low[0],       \
                  end_ = cell + (c).high[0] - (c).low[0];                                          \
           cell <= end_; cell++)

/* The tile (grid.c) of normal n; -1: there is none. Without branches, for loops over lanes. */
static inline int32_t scree_tile_of(vec3 n) {
  double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
  bool along_x = (x >= y) & (x >= z), along_y = !along_x & (y >= z);
  double w = along_x ? n.x : along_y ? n.y : n.z;
  double u = along_x ? n.y : along_y ? n.z : n.x, v = along_x ? n.z : along_y ? n.x : n.y;
  double scale = SCREE_TILES / 2 / fabs(w);
  u = (u * scale) + SCREE_TILES / 2;
  v = (v * scale) + SCREE_TILES / 2;
  bool found = (u >= 0) & (u <= SCREE_TILES) & (v >= 0) & (v <= SCREE_TILES);
  double last = SCREE_TILES - 1, i = found ? u : 0, j = found ? v : 0;
  i = i < last ? i : last;
  j = j < last ? j : last;
  int32_t face = (along_x ? 0 : along_y ? 2 : 4) + (w < 0);
  int32_t tile = (face * SCREE_TILES + (int32_t)i) * SCREE_TILES + (int32_t)j;
  return found ? tile : -1;
}

static inline uint64_t scree_averse_in(const scree_grid *g, int32_t tile) {
  return tile < 0 ? SCREE_ALL_AVERSE : g->averse_of[tile];
}

/* Directions that the normal n does not face, or faces by too little. */
static inline uint64_t scree_averse_to(const scree_grid *g, vec3 n) {
  return scree_averse_in(g, scree_tile_of(n));
}

#endif
