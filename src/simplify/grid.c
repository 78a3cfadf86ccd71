#include "simplify/grid.h"

#include "base/array.h"
#include "base/parallel.h"
#include "mesh/intersect.h"

#include <string.h>

/* A triangle over more cells than this is entered for all of them at once, or kept aside. */
enum { CELLS_MAX = 4096, BLOCK = 2048, DIRECTIONS = 25 };
/* A normal must point this much towards a direction to face it (cosine): past any rounding. */
#define FACING 1e-6
/* A head that is marked: its list is wanted. */
#define MARKED (SCREE_NONE - 1)

/* Half of the directions; the other half are their opposites. Not normalised: the margin FACING is
 * loose enough. */
static const double directions[DIRECTIONS][3] = {
    {1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 0},  {1, -1, 0}, {1, 0, 1},  {1, 0, -1},
    {0, 1, 1},  {0, 1, -1}, {1, 1, 1},  {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}, {2, 1, 1},
    {2, 1, -1}, {2, -1, 1}, {-2, 1, 1}, {1, 2, 1},  {1, 2, -1}, {1, -2, 1}, {-1, 2, 1},
    {1, 1, 2},  {1, 1, -2}, {1, -1, 2}, {-1, 1, 2}};

static uint64_t averse_to(vec3 n) {
  double margin = FACING * (fabs(n.x) + fabs(n.y) + fabs(n.z));
  uint64_t bits = 0;
  for (int k = 0; k < DIRECTIONS; k++) {
    double dot = n.x * directions[k][0] + n.y * directions[k][1] + n.z * directions[k][2];
    bits |= (uint64_t) !(dot > margin) << k | (uint64_t) !(-dot > margin) << (k + DIRECTIONS);
  }
  return bits;
}

#define ALL_AVERSE ((UINT64_C(1) << (2 * DIRECTIONS)) - 1)

typedef struct cells {
  uint32_t low[3], high[3]; /* inclusive */
} cells;

static uint32_t cell_along(double x, double low, double per_length, uint32_t size) {
  double c = (x - low) * per_length;
  if (!(c > 0)) return 0;
  return c >= (double)size ? size - 1 : (uint32_t)c;
}

static cells cells_of(const scree_grid *g, vec3 low, vec3 high) {
  double k = g->cells_per_length;
  return (cells){
      {cell_along(low.x, g->low.x, k, g->size[0]), cell_along(low.y, g->low.y, k, g->size[1]),
       cell_along(low.z, g->low.z, k, g->size[2])},
      {cell_along(high.x, g->low.x, k, g->size[0]), cell_along(high.y, g->low.y, k, g->size[1]),
       cell_along(high.z, g->low.z, k, g->size[2])}};
}

static size_t cell_of(const scree_grid *g, vec3 at) {
  double k = g->cells_per_length;
  uint32_t x = cell_along(at.x, g->low.x, k, g->size[0]);
  uint32_t y = cell_along(at.y, g->low.y, k, g->size[1]);
  uint32_t z = cell_along(at.z, g->low.z, k, g->size[2]);
  return ((size_t)z * g->size[1] + y) * g->size[0] + x;
}

static size_t count_cells(const cells *c) {
  size_t count = 1;
  for (int i = 0; i < 3; i++) count *= (size_t)(c->high[i] - c->low[i]) + 1;
  return count;
}

#define FOR_CELLS(grid, c, cell)                                                                   \
  for (uint32_t z_ = (c).low[2]; z_ <= (c).high[2]; z_++)                                          \
    for (uint32_t y_ = (c).low[1]; y_ <= (c).high[1]; y_++)                                        \
      for (size_t cell = ((size_t)z_ * (grid)->size[1] + y_) * (grid)->size[0] + (c).low[0],       \
                  end_ = cell + (c).high[0] - (c).low[0];                                          \
           cell <= end_; cell++)

void scree_grid_free(scree_grid *g) {
  scree_free(g->averse);
  scree_free(g->head);
  scree_free(g->items);
  scree_free(g->large);
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
  SCREE_ALLOC_OR(g->averse, g->cell_count, error, out_of_memory);
  SCREE_ALLOC_OR(g->head, g->cell_count, error, out_of_memory);
  memset(g->averse, 0, g->cell_count * sizeof *g->averse);
  memset(g->head, 0xff, g->cell_count * sizeof *g->head);
  return SCREE_OK;
out_of_memory:
  scree_grid_free(g);
  return SCREE_OUT_OF_MEMORY;
}

static void enter(scree_grid *g, vec3 low, vec3 high, uint64_t averse) {
  cells c = cells_of(g, low, high);
  if (count_cells(&c) > CELLS_MAX) {
    __atomic_fetch_or(&g->averse_all, averse, __ATOMIC_RELAXED);
    return;
  }
  FOR_CELLS(g, c, cell)
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
    enter(work->grid, vec3_min(p0, vec3_min(p1, p2)), vec3_max(p0, vec3_max(p1, p2)),
          averse_to(vec3_triangle_normal(p0, p1, p2)));
  }
}

void scree_grid_enter_directions(scree_grid *g, const scree_halfmesh *s) {
  entering work = {g, s};
  scree_parallel_for(s->triangle_count, BLOCK, enter_block, &work);
}

static uint64_t ring_averse_to(const scree_halfmesh *s, const scree_ring *r, vec3 target) {
  uint64_t averse = 0;
  for (uint32_t i = 0; i < r->count; i++)
    averse |= averse_to(vec3_triangle_normal(target, s->position[s->from[r->edge[i]]],
                                             s->position[scree_to(s, r->edge[i])]));
  return averse;
}

void scree_grid_enter_ring(scree_grid *g, const scree_halfmesh *s, const scree_ring *r,
                           vec3 target) {
  enter(g, r->low, r->high, ring_averse_to(s, r, target));
}

/* Directions that not all triangles in the cells of a box face. */
static uint64_t averse_in(const scree_grid *g, vec3 low, vec3 high) {
  cells c = cells_of(g, low, high);
  uint64_t averse = g->averse_all;
  if (averse == ALL_AVERSE || count_cells(&c) > CELLS_MAX) return ALL_AVERSE;
  FOR_CELLS(g, c, cell) averse |= __atomic_load_n(&g->averse[cell], __ATOMIC_RELAXED);
  return averse;
}

bool scree_grid_certifies(const scree_grid *g, const scree_halfmesh *s, const scree_ring *r,
                          vec3 target) {
  uint64_t averse = averse_in(g, r->low, r->high);
  return averse != ALL_AVERSE && (averse | ring_averse_to(s, r, target)) != ALL_AVERSE;
}

bool scree_grid_certifies_entered(const scree_grid *g, const scree_ring *r) {
  return averse_in(g, r->low, r->high) != ALL_AVERSE;
}

void scree_grid_mark(scree_grid *g, vec3 low, vec3 high) {
  cells c = cells_of(g, low, high);
  FOR_CELLS(g, c, cell) g->head[cell] = MARKED;
}

/* A box in steps of a fraction of a cell: boxes that are apart in steps are apart. */
static scree_grid_box coarse_box(const scree_grid *g, vec3 low, vec3 high) {
  enum { STEPS_PER_CELL = 32 }; /* at most 1025 cells along an axis */
  double k = g->cells_per_length * STEPS_PER_CELL;
  const double from[3] = {g->low.x, g->low.y, g->low.z};
  const double l[3] = {low.x, low.y, low.z}, h[3] = {high.x, high.y, high.z};
  scree_grid_box box;
  for (int i = 0; i < 3; i++) {
    box.low[i] = (uint16_t)cell_along(l[i], from[i], k, g->size[i] * STEPS_PER_CELL);
    box.high[i] = (uint16_t)cell_along(h[i], from[i], k, g->size[i] * STEPS_PER_CELL);
  }
  return box;
}

static bool apart(const scree_grid_box *a, const scree_grid_box *b) {
  return a->low[0] > b->high[0] || a->low[1] > b->high[1] || a->low[2] > b->high[2] ||
         a->high[0] < b->low[0] || a->high[1] < b->low[1] || a->high[2] < b->low[2];
}

static bool list(scree_grid *g, vec3 low, vec3 high, uint32_t triangle, bool marked_only) {
  cells c = cells_of(g, low, high);
  if (count_cells(&c) > CELLS_MAX) {
    if (!scree_array_reserve((void **)&g->large, &g->large_capacity, g->large_count + 1,
                             sizeof *g->large))
      return false;
    g->large[g->large_count++] = triangle;
    return true;
  }
  scree_grid_box box = coarse_box(g, low, high);
  FOR_CELLS(g, c, cell) {
    uint32_t head = g->head[cell];
    if (marked_only && head == SCREE_NONE) continue;
    scree_grid_node node = {triangle, head == MARKED ? SCREE_NONE : head, box};
    if (!SCREE_PUSH(g, node)) return false;
    g->head[cell] = (uint32_t)(g->count - 1);
  }
  return true;
}

void scree_grid_clear_lists(scree_grid *g) {
  memset(g->head, 0xff, g->cell_count * sizeof *g->head);
  g->count = g->large_count = 0;
}

static void triangle_box(const scree_halfmesh *s, uint32_t t, vec3 *low, vec3 *high) {
  const uint32_t *from = s->from + 3 * (size_t)t;
  vec3 p0 = s->position[from[0]], p1 = s->position[from[1]], p2 = s->position[from[2]];
  *low = vec3_min(p0, vec3_min(p1, p2));
  *high = vec3_max(p0, vec3_max(p1, p2));
}

bool scree_grid_list_triangle(scree_grid *g, const scree_halfmesh *s, uint32_t t) {
  vec3 low, high;
  triangle_box(s, t, &low, &high);
  return list(g, low, high, t, false);
}

/* The planned collapse that changes triangle t, or NONE. */
static uint32_t planned_for(const scree_halfmesh *s, uint32_t t, const scree_planned *planned) {
  if (!planned) return SCREE_NONE;
  for (size_t i = 0; i < 3; i++) {
    uint32_t chosen = planned->chosen[s->from[3 * (size_t)t + i]];
    if (chosen != SCREE_NONE) return chosen;
  }
  return SCREE_NONE;
}

/* The box of triangle t and what it will become; false: the triangle is gone. */
static bool box_with_plan(const scree_halfmesh *s, uint32_t t, const scree_planned *planned,
                          vec3 *low, vec3 *high) {
  if (s->from[3 * (size_t)t] == SCREE_NONE) return false;
  triangle_box(s, t, low, high);
  uint32_t chosen = planned_for(s, t, planned);
  if (chosen != SCREE_NONE) {
    *low = vec3_min(*low, planned->changes[chosen].target);
    *high = vec3_max(*high, planned->changes[chosen].target);
  }
  return true;
}

typedef struct wanting {
  const scree_grid *grid;
  const scree_halfmesh *s;
  const scree_planned *planned;
  uint8_t *wanted; /* per triangle: it touches a marked cell */
} wanting;

static bool touches_marked(const scree_grid *g, vec3 low, vec3 high) {
  cells c = cells_of(g, low, high);
  if (count_cells(&c) > CELLS_MAX) return true;
  FOR_CELLS(g, c, cell) if (g->head[cell] == MARKED) return true;
  return false;
}

static void want_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const wanting *w = context;
  vec3 low, high;
  for (size_t t = begin; t < end; t++)
    w->wanted[t] = box_with_plan(w->s, (uint32_t)t, w->planned, &low, &high) &&
                   touches_marked(w->grid, low, high);
}

bool scree_grid_list_all(scree_grid *g, const scree_halfmesh *s, const scree_planned *planned,
                         bool marked_only) {
  wanting w = {g, s, planned, NULL};
  bool listed = true;
  if (marked_only) { /* few are: find them in parallel */
    w.wanted = scree_alloc(s->triangle_count, 1);
    if (!w.wanted) return false;
    scree_parallel_for(s->triangle_count, BLOCK, want_block, &w);
  }
  for (uint32_t t = 0; t < s->triangle_count && listed; t++) {
    vec3 low, high;
    if (w.wanted && !w.wanted[t]) continue;
    if (box_with_plan(s, t, planned, &low, &high)) listed = list(g, low, high, t, marked_only);
  }
  scree_free(w.wanted);
  return listed;
}

/* A triangle with corners named by mesh vertex; the moved vertex has the name MOVED. */
typedef struct corners {
  uint32_t name[3];
  vec3 at[3];
} corners;

#define MOVED       (SCREE_NONE - 2)
#define MOVED_OTHER (SCREE_NONE - 3)

static corners corners_of(const scree_halfmesh *s, uint32_t t) {
  corners c;
  for (size_t i = 0; i < 3; i++) {
    uint32_t v = s->from[3 * (size_t)t + i];
    c.name[i] = s->origin[v];
    c.at[i] = s->position[v];
  }
  return c;
}

static bool meet(const corners *x, const corners *y) {
  for (int axis = 0; axis < 3; axis++) {
    const double *a = &x->at[0].x + axis, *b = &y->at[0].x + axis;
    if (fmax(a[0], fmax(a[3], a[6])) < fmin(b[0], fmin(b[3], b[6])) ||
        fmax(b[0], fmax(b[3], b[6])) < fmin(a[0], fmin(a[3], a[6])))
      return false;
  }
  vec3 at[6];
  uint32_t t[3] = {0, 1, 2}, u[3] = {3, 4, 5};
  memcpy(at, x->at, sizeof x->at);
  memcpy(at + 3, y->at, sizeof y->at);
  for (uint32_t i = 0; i < 3; i++)
    for (uint32_t j = 0; j < 3; j++)
      if (x->name[i] == y->name[j]) u[j] = t[i];
  return scree_triangles_meet(&at[0].x, t, u) != SCREE_MEET_NOT;
}

typedef struct search {
  const scree_halfmesh *s;
  const scree_ring *ring;
  const scree_planned *planned;
  uint32_t self;                 /* index of this collapse among the planned, or NONE */
  int before, after;             /* triangles met by the ring as it is, and as it will be */
  corners moved[SCREE_RING_MAX]; /* the ring as it will be, and its triangles' boxes */
  vec3 low[SCREE_RING_MAX], high[SCREE_RING_MAX];
} search;

static corners ring_triangle(const search *q, uint32_t i) {
  const scree_halfmesh *s = q->s;
  uint32_t e = q->ring->edge[i], v1 = s->from[e], v2 = scree_to(s, e);
  uint32_t v0 = s->from[scree_previous(e)];
  return (corners){{s->origin[v0], s->origin[v1], s->origin[v2]},
                   {s->position[v0], s->position[v1], s->position[v2]}};
}

static int count_met_before(const search *q, const corners *c) {
  int met = 0;
  for (uint32_t i = 0; i < q->ring->count; i++) {
    corners own = ring_triangle(q, i);
    met += meet(&own, c);
  }
  return met;
}

static int count_met_after(const search *q, const corners *c) {
  vec3 low = vec3_min(c->at[0], vec3_min(c->at[1], c->at[2]));
  vec3 high = vec3_max(c->at[0], vec3_max(c->at[1], c->at[2]));
  int met = 0;
  for (uint32_t i = 0; i < q->ring->count; i++)
    if (low.x <= q->high[i].x && low.y <= q->high[i].y && low.z <= q->high[i].z &&
        high.x >= q->low[i].x && high.y >= q->low[i].y && high.z >= q->low[i].z)
      met += meet(&q->moved[i], c);
  return met;
}

static void search_triangle(search *q, uint32_t t) {
  const scree_halfmesh *s = q->s;
  const uint32_t *from = s->from + 3 * (size_t)t;
  for (int i = 0; i < 3; i++)
    if (from[i] == q->ring->a || from[i] == q->ring->b) return;
  corners c = corners_of(s, t);
  int after = count_met_after(q, &c);
  if (after > 0) {
    q->before += count_met_before(q, &c);
    q->after += after;
  }
  uint32_t chosen = planned_for(s, t, q->planned);
  if (chosen == SCREE_NONE || chosen == q->self) return;
  int moved = 0;
  for (size_t i = 0; i < 3; i++)
    if (q->planned->chosen[from[i]] == chosen) {
      c.at[i] = q->planned->changes[chosen].target;
      c.name[i] = MOVED_OTHER;
      moved++;
    }
  if (moved == 1) q->after += count_met_after(q, &c);
}

/* Triangles of the ring that will meet each other beside their common corner and edges. */
static int count_own(const search *q) {
  int met = 0;
  for (uint32_t i = 0; i < q->ring->count; i++)
    for (uint32_t j = i + 1; j < q->ring->count; j++) met += meet(&q->moved[i], &q->moved[j]);
  return met;
}

static void search_begin(search *q, vec3 target) {
  const scree_ring *r = q->ring;
  for (uint32_t i = 0; i < r->count; i++) {
    q->moved[i] = ring_triangle(q, i);
    q->moved[i].name[0] = MOVED;
    q->moved[i].at[0] = target;
    const vec3 *at = q->moved[i].at;
    q->low[i] = vec3_min(at[0], vec3_min(at[1], at[2]));
    q->high[i] = vec3_max(at[0], vec3_max(at[1], at[2]));
  }
  /* a fan that faces one direction is a graph over it */
  if (ring_averse_to(q->s, r, target) != ALL_AVERSE) return;
  q->after = count_own(q);
  if (q->after == 0) return;
  for (uint32_t i = 0; i < r->count; i++)
    for (uint32_t j = i + 1; j < r->count; j++) {
      corners x = ring_triangle(q, i), y = ring_triangle(q, j);
      q->before += meet(&x, &y);
    }
}

bool scree_grid_clear(const scree_grid *g, const scree_halfmesh *s, const scree_ring *r,
                      vec3 target, const scree_planned *planned) {
  search q;
  q.s = s;
  q.ring = r;
  q.planned = planned;
  q.self = planned ? planned->chosen[r->a] : SCREE_NONE;
  q.before = q.after = 0;
  search_begin(&q, target);
  cells c = cells_of(g, r->low, r->high);
  scree_grid_box box = coarse_box(g, r->low, r->high);
  for (size_t i = 0; i < g->large_count; i++)
    if (s->from[3 * (size_t)g->large[i]] != SCREE_NONE) search_triangle(&q, g->large[i]);
  FOR_CELLS(g, c, cell) {
    if (q.after > q.before) return false;
    for (uint32_t i = g->head[cell]; i < MARKED; i = g->items[i].next) {
      uint32_t t = g->items[i].triangle;
      vec3 low, high;
      /* in a batch the boxes listed hold until its collapses are done */
      if (planned && apart(&g->items[i].box, &box)) continue;
      if (!box_with_plan(s, t, planned, &low, &high) || low.x > r->high.x || low.y > r->high.y ||
          low.z > r->high.z || high.x < r->low.x || high.y < r->low.y || high.z < r->low.z)
        continue;
      /* it is listed in several cells: the first that both boxes have decides */
      size_t first = cell_of(g, vec3_max(low, r->low));
      if (first == cell) search_triangle(&q, t);
    }
  }
  return q.after <= q.before;
}
