/* The grid itself and the directions in it; the lists and the exact search are in search.c. */
#include "simplify/grid_cells.h"

#include "base/parallel.h"

#include <string.h>

enum { BLOCK = 2048 };
/* A normal must point this much towards a direction to face it (cosine): past any rounding. */
#define FACING 1e-6

/* Half of the directions; the other half are their opposites. Not normalised: the margin FACING is
 * loose enough. */
static const double directions[SCREE_DIRECTIONS][3] = {
    {1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 0},  {1, -1, 0}, {1, 0, 1},  {1, 0, -1},
    {0, 1, 1},  {0, 1, -1}, {1, 1, 1},  {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}, {2, 1, 1},
    {2, 1, -1}, {2, -1, 1}, {-2, 1, 1}, {1, 2, 1},  {1, 2, -1}, {1, -2, 1}, {-1, 2, 1},
    {1, 1, 2},  {1, 1, -2}, {1, -1, 2}, {-1, 1, 2}};

static uint64_t averse_exactly(vec3 n) {
  double margin = FACING * (fabs(n.x) + fabs(n.y) + fabs(n.z));
  uint64_t bits = 0;
  for (int k = 0; k < SCREE_DIRECTIONS; k++) {
    double dot = n.x * directions[k][0] + n.y * directions[k][1] + n.z * directions[k][2];
    bits |= (uint64_t) !(dot > margin) << k | (uint64_t) !(-dot > margin) << (k + SCREE_DIRECTIONS);
  }
  return bits;
}

/* Normals fall into the squares of a cube's faces, SCREE_TILES by SCREE_TILES each. What a square
 * holds is averse to whatever one of its corners is: facing is linear on the square. */
enum { TILE_COUNT = 6 * SCREE_TILES * SCREE_TILES };

static vec3 tile_corner(int face, int i, int j) {
  double u = (double)i / (SCREE_TILES / 2) - 1, v = (double)j / (SCREE_TILES / 2) - 1;
  double sign = face % 2 ? -1 : 1;
  return face / 2 == 0   ? (vec3){sign, u, v}
         : face / 2 == 1 ? (vec3){v, sign, u}
                         : (vec3){u, v, sign};
}

static void fill_tiles(uint64_t *averse_of) {
  for (int face = 0; face < 6; face++)
    for (int i = 0; i < SCREE_TILES; i++)
      for (int j = 0; j < SCREE_TILES; j++)
        averse_of[(face * SCREE_TILES + i) * SCREE_TILES + j] =
            averse_exactly(tile_corner(face, i, j)) | averse_exactly(tile_corner(face, i + 1, j)) |
            averse_exactly(tile_corner(face, i, j + 1)) |
            averse_exactly(tile_corner(face, i + 1, j + 1));
}

void scree_grid_free(scree_grid *g) {
  scree_free(g->averse_of);
  scree_free(g->averse);
  scree_free(g->head);
  scree_free(g->items);
  scree_free(g->large);
  scree_free(g->marked);
  scree_free(g->start);
  scree_free(g->near);
  *g = (scree_grid){0};
}

/* The mean edge from the area: a triangle of side e has sqrt(3)/4 e^2. */
static double mean_edge(const scree_halfmesh *s, vec3 *low, vec3 *high) {
  double doubled = 0;
  bool first = true;
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (s->from[3 * t] == SCREE_NONE) continue;
    vec3 p[3];
    for (int i = 0; i < 3; i++) {
      p[i] = s->position[s->from[3 * t + (size_t)i]];
      *low = first ? p[i] : vec3_min(*low, p[i]);
      *high = first ? p[i] : vec3_max(*high, p[i]);
      first = false;
    }
    doubled += vec3_norm(vec3_triangle_normal(p[0], p[1], p[2]));
  }
  return sqrt(1.1547 * doubled / (double)s->live_triangle_count);
}

scree_status scree_grid_shape(scree_grid *g, const scree_halfmesh *s, double edges_per_cell,
                              scree_error *error) {
  vec3 low = {0, 0, 0}, high = low;
  double cell = mean_edge(s, &low, &high) * edges_per_cell;
  vec3 extent = vec3_sub(high, low);
  double longest = fmax(extent.x, fmax(extent.y, extent.z));
  if (!(cell > longest / 1024)) cell = longest / 1024;
  for (;; cell *= 1.25) { /* thin features in a large box: a few cells per triangle are enough */
    double n =
        (floor(extent.x / cell) + 1) * (floor(extent.y / cell) + 1) * (floor(extent.z / cell) + 1);
    if (n <= 4.0 * (double)s->live_triangle_count + 64) break;
  }
  scree_grid_free(g);
  g->low = low;
  g->cells_per_length = 1 / cell;
  g->size[0] = (uint32_t)(extent.x / cell) + 1;
  g->size[1] = (uint32_t)(extent.y / cell) + 1;
  g->size[2] = (uint32_t)(extent.z / cell) + 1;
  g->cell_count = (size_t)g->size[0] * g->size[1] * g->size[2];
  g->built_for = s->live_triangle_count;
  SCREE_ALLOC_OR(g->averse_of, TILE_COUNT, error, out_of_memory);
  SCREE_ALLOC_OR(g->averse, g->cell_count, error, out_of_memory);
  fill_tiles(g->averse_of);
  SCREE_ALLOC_OR(g->head, g->cell_count, error, out_of_memory);
  memset(g->averse, 0, g->cell_count * sizeof *g->averse);
  memset(g->head, 0xff, g->cell_count * sizeof *g->head);
  return SCREE_OK;
out_of_memory:
  scree_grid_free(g);
  return SCREE_OUT_OF_MEMORY;
}

static void enter(scree_grid *g, scree_grid_box c, uint64_t averse) {
  if (scree_count_cells(&c) > SCREE_CELLS_MAX) {
    __atomic_fetch_or(&g->averse_all, averse, __ATOMIC_RELAXED);
    return;
  }
  SCREE_FOR_CELLS(g, c, cell)
  if ((__atomic_load_n(&g->averse[cell], __ATOMIC_RELAXED) & averse) != averse)
    __atomic_fetch_or(&g->averse[cell], averse, __ATOMIC_RELAXED);
}

typedef struct entering {
  scree_grid *grid;
  const scree_halfmesh *s;
} entering;

static void enter_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  entering *work = context;
  const scree_halfmesh *s = work->s;
  for (size_t t = begin; t < end; t++) {
    if (s->from[3 * t] == SCREE_NONE) continue;
    vec3 p0 = s->position[s->from[3 * t]], p1 = s->position[s->from[3 * t + 1]],
         p2 = s->position[s->from[3 * t + 2]];
    enter(
        work->grid,
        scree_cells_of(work->grid, vec3_min(p0, vec3_min(p1, p2)), vec3_max(p0, vec3_max(p1, p2))),
        scree_averse_to(work->grid, vec3_triangle_normal(p0, p1, p2)));
  }
}

void scree_grid_enter_directions(scree_grid *g, const scree_halfmesh *s) {
  entering work = {g, s};
  scree_parallel_for(s->triangle_count, BLOCK, enter_block, &work);
}

static uint64_t ring_averse_to(const scree_grid *g, const scree_ring *r, const vec3 *normals) {
  uint64_t averse = 0;
  for (uint32_t i = 0; i < r->count; i++) averse |= scree_averse_to(g, normals[i]);
  return averse;
}

scree_grid_box scree_grid_enter_ring(scree_grid *g, const scree_ring *r,
                                     const scree_around *around) {
  scree_grid_box c = scree_cells_of(g, r->low, r->high);
  enter(g, c, ring_averse_to(g, r, around->after));
  return c;
}

bool scree_grid_certifies_entered(const scree_grid *g, const scree_grid_box *c) {
  uint64_t averse = g->averse_all;
  if (averse == SCREE_ALL_AVERSE || scree_count_cells(c) > SCREE_CELLS_MAX) return false;
  SCREE_FOR_CELLS(g, *c, cell) averse |= __atomic_load_n(&g->averse[cell], __ATOMIC_RELAXED);
  return averse != SCREE_ALL_AVERSE;
}

bool scree_grid_certifies(const scree_grid *g, const scree_ring *r, const scree_around *around) {
  scree_grid_box c = scree_cells_of(g, r->low, r->high);
  uint64_t averse = g->averse_all | ring_averse_to(g, r, around->after);
  if (averse == SCREE_ALL_AVERSE || scree_count_cells(&c) > SCREE_CELLS_MAX) return false;
  SCREE_FOR_CELLS(g, c, cell) averse |= g->averse[cell];
  return averse != SCREE_ALL_AVERSE;
}
