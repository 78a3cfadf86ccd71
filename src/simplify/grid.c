/* The grid itself and the directions in it; the lists and the exact search are in search.c. */
#include "simplify/grid_cells.h"

#include "base/lanes.h"
#include "base/parallel.h"

#include <string.h>

enum { BLOCK = 128 * SCREE_GROUP, CLEAR_BLOCK = 1 << 15 };
/* A normal must point this much towards a direction to face it (sine of the least angle, roughly):
 * past any rounding; and where directions are kept free for what comes, 27 degrees. */
#define FACING 1e-6
#define ROOMY  0.45
/* Of a cell: no triangle was entered there. */
#define NO_SURFACE (UINT64_C(1) << 63)

/* Half of the directions; the other half are their opposites. Not normalised. */
static const double directions[SCREE_DIRECTIONS][3] = {
    {1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 0},  {1, -1, 0}, {1, 0, 1},  {1, 0, -1},
    {0, 1, 1},  {0, 1, -1}, {1, 1, 1},  {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}, {2, 1, 1},
    {2, 1, -1}, {2, -1, 1}, {-2, 1, 1}, {1, 2, 1},  {1, 2, -1}, {1, -2, 1}, {-1, 2, 1},
    {1, 1, 2},  {1, 1, -2}, {1, -1, 2}, {-1, 1, 2}};

vec3 scree_faced_direction(uint64_t averse) {
  int k = 0;
  while (averse >> k & 1) k++;
  vec3 direction = vec3_load(directions[k % SCREE_DIRECTIONS]);
  return k < SCREE_DIRECTIONS ? direction : vec3_scale(direction, -1);
}

static uint64_t averse_exactly(vec3 n, double facing) {
  uint64_t bits = 0;
  for (int k = 0; k < SCREE_DIRECTIONS; k++) {
    vec3 direction = vec3_load(directions[k]);
    double dot = vec3_dot(n, direction), margin = facing * vec3_norm(n) * vec3_norm(direction);
    bits |= (uint64_t) !(dot > margin) << k | (uint64_t) !(-dot > margin) << (k + SCREE_DIRECTIONS);
  }
  return bits;
}

/* Normals fall into the squares of a cube's faces, SCREE_TILES by SCREE_TILES each. What a square
 * holds is averse to whatever one of its corners is: the normals that face a direction by a margin
 * are a convex cone. */
enum { TILE_COUNT = 6 * SCREE_TILES * SCREE_TILES };

static vec3 tile_corner(int face, int i, int j) {
  double u = (double)i / (SCREE_TILES / 2) - 1, v = (double)j / (SCREE_TILES / 2) - 1;
  double sign = face % 2 ? -1 : 1;
  return face / 2 == 0   ? (vec3){sign, u, v}
         : face / 2 == 1 ? (vec3){v, sign, u}
                         : (vec3){u, v, sign};
}

static void fill_face(uint64_t *averse_of, double facing, int face) {
  uint64_t corner[SCREE_TILES + 1][SCREE_TILES + 1];
  for (int i = 0; i <= SCREE_TILES; i++)
    for (int j = 0; j <= SCREE_TILES; j++)
      corner[i][j] = averse_exactly(tile_corner(face, i, j), facing);
  for (int i = 0; i < SCREE_TILES; i++)
    for (int j = 0; j < SCREE_TILES; j++)
      averse_of[(face * SCREE_TILES + i) * SCREE_TILES + j] =
          corner[i][j] | corner[i + 1][j] | corner[i][j + 1] | corner[i + 1][j + 1];
}

scree_status scree_grid_prepare(scree_grid *g, scree_error *error) {
  if (g->averse_of) return SCREE_OK;
  SCREE_ALLOC_OR(g->averse_of, 2 * TILE_COUNT, error, out_of_memory);
  for (int face = 0; face < 6; face++) {
    fill_face(g->averse_of, FACING, face);
    fill_face(g->averse_of + TILE_COUNT, ROOMY, face);
  }
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static void free_cells(scree_grid *g) {
  scree_free(g->averse);
  scree_free(g->head);
  scree_free(g->items);
  scree_free(g->large);
  scree_free(g->groups);
  *g = (scree_grid){.averse_of = g->averse_of};
}

void scree_grid_free(scree_grid *g) {
  free_cells(g);
  scree_free(g->averse_of);
  *g = (scree_grid){0};
}

/* The mean edge, had the surface the area with which it was built: a triangle of side e
 * has sqrt(3)/4 e^2. Cells need not fit closely. */
static double mean_edge(const scree_halfmesh *s) {
  return sqrt(2.3094 * s->area / (double)s->live_triangle_count);
}

static scree_status shape(scree_grid *g, const scree_halfmesh *s, vec3 low, vec3 high,
                          double edges_per_cell, scree_error *error) {
  double cell = mean_edge(s) * edges_per_cell;
  vec3 extent = vec3_sub(high, low);
  double longest = fmax(extent.x, fmax(extent.y, extent.z));
  if (!(cell > longest / 1024)) cell = longest / 1024;
  for (;; cell *= 1.25) { /* thin features in a large box: a few cells per triangle are enough */
    double n =
        (floor(extent.x / cell) + 1) * (floor(extent.y / cell) + 1) * (floor(extent.z / cell) + 1);
    if (n <= 4.0 * (double)s->live_triangle_count + 64) break;
  }
  free_cells(g);
  g->low = low;
  g->cells_per_length = 1 / cell;
  g->size[0] = (uint32_t)(extent.x / cell) + 1;
  g->size[1] = (uint32_t)(extent.y / cell) + 1;
  g->size[2] = (uint32_t)(extent.z / cell) + 1;
  g->cell_count = (size_t)g->size[0] * g->size[1] * g->size[2];
  g->built_for = s->live_triangle_count;
  if (scree_grid_prepare(g, error) != SCREE_OK) goto out_of_memory;
  SCREE_ALLOC_OR(g->averse, g->cell_count, error, out_of_memory);
  SCREE_ALLOC_OR(g->groups, 2 * scree_block_count(s->triangle_count, SCREE_GROUP), error,
                 out_of_memory);
  return SCREE_OK;
out_of_memory:
  scree_grid_free(g);
  return SCREE_OUT_OF_MEMORY;
}

scree_status scree_grid_shape(scree_grid *g, const scree_halfmesh *s, double edges_per_cell,
                              scree_error *error) {
  return shape(g, s, s->low, s->high, edges_per_cell, error);
}

scree_status scree_grid_shape_in(scree_grid *g, const scree_halfmesh *s,
                                 const scree_frame_of_places *frame, double edges_per_cell,
                                 scree_error *error) {
  scree_status status = shape(g, s, frame->low, frame->high, edges_per_cell, error);
  g->frame = frame;
  return status;
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

/* What of a triangle is entered: the directions that it does not face, by tile, or whose it is. */
typedef struct entering {
  scree_grid *grid;
  const scree_halfmesh *s;
  const uint64_t *averse_of;
  const uint32_t *place_of;
  size_t patch;
} entering;

/* An owner's number and, so that two of them joined are none, its complement. Bits 62 and 63 are
 * not used. */
#define OWNER_BITS 31
#define NOBODY     ((UINT64_C(1) << (2 * OWNER_BITS)) - 1)
static uint64_t owner_code(size_t owner) {
  uint64_t code = owner & (NOBODY >> OWNER_BITS);
  return code | (NOBODY >> OWNER_BITS & ~code) << OWNER_BITS;
}

/* The codes of its corners' owners, joined. */
static uint64_t owners_of(const entering *work, size_t t) {
  uint64_t code = 0;
  for (size_t i = 0; i < 3; i++)
    code |= owner_code(work->place_of[work->s->half[3 * t + i].from] / work->patch);
  return code;
}

/* Triangles of a group side by side, one per lane. */
typedef struct lanes {
  double at[3][3][SCREE_GROUP]; /* corner, axis */
  int32_t low[3][SCREE_GROUP], high[3][SCREE_GROUP];
  int32_t tile[SCREE_GROUP]; /* of the normal, or -1: it faces no direction */
  uint64_t entered[SCREE_GROUP];
} lanes;

/* The lanes' cells and tiles, as scree_cells_of and scree_averse_to find them. */
SCREE_LANES static void place_lanes(const scree_grid *g, lanes *l, int count) {
  const double low[3] = {g->low.x, g->low.y, g->low.z}, k = g->cells_per_length;
  for (int axis = 0; axis < 3; axis++) {
    const double from = low[axis], last = (double)(g->size[axis] - 1);
    for (int i = 0; i < count; i++) {
      double a = l->at[0][axis][i], b = l->at[1][axis][i], c = l->at[2][axis][i];
      double least = a < b ? a : b, most = a > b ? a : b;
      least = ((least < c ? least : c) - from) * k;
      most = ((most > c ? most : c) - from) * k;
      least = least > 0 ? least : 0;
      most = most > 0 ? most : 0;
      l->low[axis][i] = (int32_t)(least < last ? least : last);
      l->high[axis][i] = (int32_t)(most < last ? most : last);
    }
  }
  for (int i = 0; i < count; i++) {
    vec3 p = {l->at[0][0][i], l->at[0][1][i], l->at[0][2][i]};
    vec3 q = {l->at[1][0][i], l->at[1][1][i], l->at[1][2][i]};
    vec3 r = {l->at[2][0][i], l->at[2][1][i], l->at[2][2][i]};
    l->tile[i] = scree_tile_of(vec3_triangle_normal(p, q, r));
  }
}

static void enter_group(const entering *work, size_t begin, size_t end, scree_grid_box *all) {
  scree_grid *g = work->grid;
  const scree_halfmesh *s = work->s;
  lanes l;
  int count = 0;
  for (size_t t = begin; t < end; t++) {
    vec3 at[3];
    if (scree_is_gone(s, t)) continue;
    scree_corners(s, t, at);
    if (work->place_of) l.entered[count] = owners_of(work, t);
    for (int k = 0; k < 3; k++) {
      if (g->frame) at[k] = scree_into_frame(g->frame, at[k]);
      l.at[k][0][count] = at[k].x;
      l.at[k][1][count] = at[k].y;
      l.at[k][2][count] = at[k].z;
    }
    count++;
  }
  place_lanes(g, &l, count);
  for (int i = 0; i < count && !work->place_of; i++)
    l.entered[i] = l.tile[i] < 0 ? SCREE_ALL_AVERSE : work->averse_of[l.tile[i]];
  *all = SCREE_NO_CELLS;
  for (int i = 0; i < count; i++) {
    scree_grid_box c = {{(uint16_t)l.low[0][i], (uint16_t)l.low[1][i], (uint16_t)l.low[2][i]},
                        {(uint16_t)l.high[0][i], (uint16_t)l.high[1][i], (uint16_t)l.high[2][i]}};
    enter(g, c, l.entered[i]);
    scree_join_cells(all, &c);
  }
}

static void enter_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  entering *work = context;
  for (size_t first = begin; first < end; first += SCREE_GROUP) {
    size_t last = first + SCREE_GROUP < end ? first + SCREE_GROUP : end;
    enter_group(work, first, last, &work->grid->groups[first / SCREE_GROUP]);
  }
}

static void clear_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_grid *g = context;
  memset(g->averse + begin, 0, (end - begin) * sizeof *g->averse);
}

static void enter_all(entering work) {
  scree_grid *g = work.grid;
  const scree_halfmesh *s = work.s;
  scree_parallel_for(g->cell_count, CLEAR_BLOCK, clear_block, g);
  g->averse_all = 0;
  g->group_count = scree_block_count(s->triangle_count, SCREE_GROUP);
  scree_parallel_for(s->triangle_count, BLOCK, enter_block, &work);
}

void scree_grid_enter_directions(scree_grid *g, const scree_halfmesh *s) {
  enter_all((entering){g, s, .averse_of = g->averse_of});
}

/* What was entered in the cells around this one, where there is surface. */
static uint64_t entered_around(const scree_grid *g, size_t cell) {
  size_t at[3] = {cell % g->size[0], cell / g->size[0] % g->size[1],
                  cell / g->size[0] / g->size[1]};
  scree_grid_box c;
  uint64_t all = 0;
  for (int k = 0; k < 3; k++) {
    c.low[k] = (uint16_t)(at[k] > 0 ? at[k] - 1 : 0);
    c.high[k] = (uint16_t)(at[k] + 1 < g->size[k] ? at[k] + 1 : at[k]);
  }
  SCREE_FOR_CELLS(g, c, other) {
    uint64_t found = __atomic_load_n(&g->averse[other], __ATOMIC_RELAXED);
    if (!(found & NO_SURFACE)) all |= found;
  }
  return all ? all : SCREE_ALL_AVERSE; /* nobody's code either */
}

/* What was entered in the cell. One without surface, to which some may come, has what those around
 * have; whoever asks first notes it. */
static uint64_t entered_in(const scree_grid *g, size_t cell) {
  uint64_t found = __atomic_load_n(&g->averse[cell], __ATOMIC_RELAXED);
  if (found == 0) {
    found = NO_SURFACE | entered_around(g, cell);
    __atomic_store_n(&g->averse[cell], found, __ATOMIC_RELAXED);
  }
  return found & ~NO_SURFACE;
}

void scree_grid_enter_roomy(scree_grid *g, const scree_halfmesh *s) {
  enter_all((entering){g, s, .averse_of = g->averse_of + TILE_COUNT});
}

void scree_grid_enter_owners(scree_grid *g, const scree_halfmesh *s, const uint32_t *place_of,
                             size_t patch) {
  enter_all((entering){g, s, .place_of = place_of, .patch = patch});
}

scree_status scree_grid_look_at_all(scree_grid *g, scree_error *error) {
  free_cells(g);
  g->few = true;
  return scree_grid_prepare(g, error);
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

/* The ring's box in the grid's frame, and what its triangles as they will be are averse to there.
 */
static scree_grid_box turned_box(const scree_grid *g, const scree_halfmesh *s, const scree_ring *r,
                                 vec3 target) {
  vec3 low = scree_into_frame(g->frame, target), high = low;
  vec3 at[] = {scree_into_frame(g->frame, s->vertex[r->a].at),
               scree_into_frame(g->frame, s->vertex[r->b].at)};
  low = vec3_min(low, vec3_min(at[0], at[1]));
  high = vec3_max(high, vec3_max(at[0], at[1]));
  for (uint32_t i = 0; i < r->count; i++) { /* a loop: each corner is the first of an edge */
    vec3 p = scree_into_frame(g->frame, s->vertex[s->half[r->edge[i]].from].at);
    low = vec3_min(low, p);
    high = vec3_max(high, p);
  }
  return scree_cells_of(g, low, high);
}

bool scree_grid_keeps(const scree_grid *g, const scree_halfmesh *s, const scree_ring *r,
                      vec3 target, const scree_around *around) {
  scree_grid_box c = turned_box(g, s, r, target);
  uint64_t averse = 0, all = g->averse_all, lost = 0;
  for (uint32_t i = 0; i < r->count; i++)
    averse |= scree_averse_to(g, mat3_mul_vec(&g->frame->axes, around->after[i]));
  if (averse == SCREE_ALL_AVERSE || scree_count_cells(&c) > SCREE_CELLS_MAX) return false;
  SCREE_FOR_CELLS(g, c, cell) {
    uint64_t found = entered_in(g, cell);
    all |= found;
    lost |= averse & ~found;
  }
  return !lost && all != SCREE_ALL_AVERSE;
}

static bool owns(const scree_grid *g, const scree_grid_box *c, size_t patch) {
  uint64_t all = g->averse_all, own = owner_code(patch);
  if (scree_count_cells(c) > SCREE_CELLS_MAX) return false;
  SCREE_FOR_CELLS(g, *c, cell) {
    all |= entered_in(g, cell);
    if (all != own) return false;
  }
  return true;
}

bool scree_grid_owns(const scree_grid *g, const scree_halfmesh *s, const scree_ring *r, vec3 target,
                     size_t patch) {
  scree_grid_box c = turned_box(g, s, r, target);
  return owns(g, &c, patch);
}

bool scree_grid_owns_fan(const scree_grid *g, const scree_halfmesh *s, uint32_t v, size_t patch) {
  vec3 low = scree_into_frame(g->frame, s->vertex[v].at), high = low;
  uint32_t first = s->vertex[v].outgoing, h = first;
  do {
    vec3 p = scree_into_frame(g->frame, s->vertex[scree_to(s, h)].at);
    low = vec3_min(low, p);
    high = vec3_max(high, p);
    h = scree_turn(s, h);
  } while (h != first);
  scree_grid_box c = scree_cells_of(g, low, high);
  return owns(g, &c, patch);
}
