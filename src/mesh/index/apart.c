/* A grid beside the tree (base/tree.h), for on a sound scan it answers in a third of the time.
 *
 * Facets of a scan are of one size, so that a grid of cells sees each a few times: all pairs in a
 * cell whose boxes touch are tested, each pair in the first cell that both have. Nearly always one
 * facet's plane has the other, but for what they share, surely on one side; the rest is tested
 * exactly. Where the surface is flat the rest would be most: there facets that share a vertex are
 * settled by its fan. If all facets of a closed fan surely face one way along an axis, then, seen
 * along it, each keeps to a sector of its own about the vertex, and the sectors follow each other;
 * if they go round once, no two facets have more in common than the vertex or an edge. */
#include "mesh/index/apart.h"

#include "base/alloc.h"
#include "base/lanes.h"
#include "base/parallel.h"
#include "mesh/index/intersect.h"

#include <stdatomic.h>
#include <string.h>

/* Cell size in mean facet sizes; cells per facet at most; entries per facet, cells of one facet and
 * facets in one cell beyond which the grid is no good. */
#define SIZES_PER_CELL 3.0
enum { CELLS_PER_FACET = 2, ENTRIES_PER_FACET = 8, CELLS_MAX = 64, CROWD = 432 };
enum { FACET_BLOCK = 4096, CELL_BLOCK = 2048, SAMPLE_STEP = 16 };

typedef struct prover {
  const scree_mesh *mesh;
  vec3 low;
  double per_length;
  uint32_t size[3];
  struct facet_cells *cells; /* of the facets */
  uint32_t *start, *items;   /* of cells: facets items[start[c]] up to items[start[c + 1]] */
  uint8_t *begins;           /* of items: bit k: the facet's first cell along axis k is this one */
  const uint32_t *ring;      /* of the adjacency, or NULL */
  uint8_t *fans;             /* per vertex: what is known of its fan */
  atomic_bool failed;
} prover;

enum { FAN_UNKNOWN, FAN_GRAPH, FAN_UNSURE, FAN_MOST = 32 };
enum { NO_VERTEX = UINT32_MAX };

/* A facet of a cell. */
typedef struct facet {
  vec3 at[3], n;
  double error; /* |n.(x - at[0])| above error |x - at[0]| is past rounding */
  const uint32_t *corner;
} facet;

/* A cell's facets side by side, one per lane, for a first look at all pairs. */
enum { LANES = 8, MOST_LANES = CROWD + LANES };
typedef struct lanes {
  float low[3][MOST_LANES], high[3][MOST_LANES]; /* boxes, in cells */
  uint32_t corner[3][MOST_LANES];
  uint32_t graph[3][MOST_LANES]; /* the corner where its fan is a graph, else NO_VERTEX */
  uint32_t begins[MOST_LANES];
  uint32_t near[MOST_LANES]; /* not settled by the first look */
} lanes;

typedef struct cell_facets {
  facet facets[CROWD];
  lanes lanes;
} cell_facets;

typedef struct span {
  uint32_t low[3], high[3]; /* inclusive */
} span;

static double size_of(vec3 v) {
  return fabs(v.x) + fabs(v.y) + fabs(v.z);
}

static uint32_t along(double x, double low, double per_length, uint32_t size) {
  double c = (x - low) * per_length;
  return !(c > 0) ? 0 : c >= (double)size ? size - 1 : (uint32_t)c;
}

static span span_of(const prover *p, const scree_box *box) {
  const double *l = &box->low.x, *h = &box->high.x;
  const double from[3] = {p->low.x, p->low.y, p->low.z};
  span s;
  for (int k = 0; k < 3; k++) {
    s.low[k] = along(l[k], from[k], p->per_length, p->size[k]);
    s.high[k] = along(h[k], from[k], p->per_length, p->size[k]);
  }
  return s;
}

/* The cells of a facet: the first, and how many more along each axis. */
typedef struct facet_cells {
  uint32_t first;
  uint8_t more[3];
} facet_cells;

/* Facets come in the order of x (mesh/weld.h): so do cells, and what is asked for together lies
 * together. */
static facet_cells cells_of(const prover *p, const span *s) {
  size_t first = ((size_t)s->low[0] * p->size[1] + s->low[1]) * p->size[2] + s->low[2];
  facet_cells c = {.first = (uint32_t)first};
  for (int k = 0; k < 3; k++) c.more[k] = (uint8_t)(s->high[k] - s->low[k]);
  return c;
}

#define FOR_CELLS(p, c, cell)                                                                      \
  for (uint32_t x_ = 0; x_ <= (c).more[0]; x_++)                                                   \
    for (uint32_t y_ = 0; y_ <= (c).more[1]; y_++)                                                 \
      for (size_t first_ = (c).first + ((size_t)x_ * (p)->size[1] + y_) * (p)->size[2],            \
                  end_ = first_ + (c).more[2], cell = first_;                                      \
           cell <= end_; cell++)

/* In FOR_CELLS: bit k is set in the first cell along axis k. */
#define BEGINS(cell) (x_ == 0) | (y_ == 0) << 1 | ((cell) == first_) << 2

/* False: a surface without extent. */
static bool shape(prover *p, size_t *cell_count) {
  const scree_mesh *mesh = p->mesh;
  const scree_box whole = scree_box_of_points(mesh->positions, mesh->vertex_count);
  double sum = 0;
  size_t samples = 0;
  for (size_t t = 0; t < mesh->triangle_count; t += SAMPLE_STEP, samples++) {
    const scree_box box = scree_facet_box(mesh, t);
    vec3 size = vec3_sub(box.high, box.low);
    sum += fmax(size.x, fmax(size.y, size.z));
  }
  vec3 extent = vec3_sub(whole.high, whole.low);
  p->low = whole.low;
  double cell = SIZES_PER_CELL * sum / (double)samples, n;
  if (!(cell > 0 && cell < INFINITY)) return false;
  for (;; cell *= 1.25) {
    n = (floor(extent.x / cell) + 1) * (floor(extent.y / cell) + 1) * (floor(extent.z / cell) + 1);
    if (n <= CELLS_PER_FACET * (double)mesh->triangle_count) break;
  }
  p->per_length = 1 / cell;
  p->size[0] = (uint32_t)(extent.x / cell) + 1;
  p->size[1] = (uint32_t)(extent.y / cell) + 1;
  p->size[2] = (uint32_t)(extent.z / cell) + 1;
  *cell_count = (size_t)p->size[0] * p->size[1] * p->size[2];
  return true;
}

/* Counts, for cell c in start[c]. */
static void count_block(void *context, scree_block block) {
  prover *p = context;
  for (size_t t = block.begin; t < block.end; t++) {
    const scree_box box = scree_facet_box(p->mesh, t);
    span s = span_of(p, &box);
    size_t cells = 1;
    for (int k = 0; k < 3; k++) cells *= (size_t)(s.high[k] - s.low[k]) + 1;
    if (cells > CELLS_MAX) {
      atomic_store(&p->failed, true);
      return;
    }
    p->cells[t] = cells_of(p, &s);
    FOR_CELLS(p, p->cells[t], cell) __atomic_fetch_add(&p->start[cell], 1, __ATOMIC_RELAXED);
  }
}

/* From the end of each cell's part to its beginning; the order within a cell does not matter. */
static void fill_block(void *context, scree_block block) {
  prover *p = context;
  for (size_t t = block.begin; t < block.end; t++) {
    FOR_CELLS(p, p->cells[t], cell) {
      uint32_t at = __atomic_sub_fetch(&p->start[cell], 1, __ATOMIC_RELAXED);
      p->items[at] = (uint32_t)t;
      p->begins[at] = (uint8_t)(BEGINS(cell));
    }
  }
}

/* All corners of g but those that f has too are surely on one side of f's plane. */
static bool beside(const facet *f, const facet *g) {
  int side = 0;
  for (int k = 0; k < 3; k++) {
    uint32_t c = g->corner[k];
    if (c == f->corner[0] || c == f->corner[1] || c == f->corner[2]) continue;
    vec3 d = vec3_sub(g->at[k], f->at[0]);
    double dot = vec3_dot(f->n, d), error = f->error * size_of(d);
    int at = dot > error ? 1 : dot < -error ? -1 : 0;
    if (at == 0 || at == -side) return false;
    side = at;
  }
  return side != 0;
}

/* The edges from the vertex that half-edge h leaves, in the order of its fan; 0: it is not closed,
 * or long. */
static size_t list_spokes(const prover *p, uint32_t h, vec3 *spoke) {
  const scree_mesh *mesh = p->mesh;
  uint32_t first = h, v = mesh->triangles[h];
  vec3 at = vec3_load(mesh->positions + 3 * (size_t)v);
  size_t count = 0;
  do {
    uint32_t incoming = scree_half_edge_previous(h), twin = p->ring[incoming];
    if (count == FAN_MOST || twin == incoming || p->ring[twin] != incoming ||
        mesh->triangles[twin] != v)
      return 0;
    spoke[count++] =
        vec3_sub(vec3_load(mesh->positions + 3 * (size_t)scree_half_edge_to(mesh, h)), at);
    h = twin;
  } while (h != first);
  return count;
}

/* Whether the fan of the vertex that h leaves is a graph along an axis. */
static bool fan_is_graph(const prover *p, uint32_t h) {
  vec3 spoke[FAN_MOST + 1], n = {0, 0, 0};
  size_t count = list_spokes(p, h, spoke), turns = 0;
  if (count == 0) return false;
  spoke[count] = spoke[0];
  for (size_t i = 0; i < count; i++) n = vec3_add(n, vec3_cross(spoke[i], spoke[i + 1]));
  int axis = vec3_greatest(vec3_abs(n));
  double sign = vec3_along(n, axis);
  double a[2] = {0, 0}, b[2];
  for (size_t i = 0; i <= count; i++) {
    const double e[3] = {spoke[i].x, spoke[i].y, spoke[i].z};
    b[0] = e[(axis + 1) % 3];
    b[1] = sign > 0 ? e[(axis + 2) % 3] : -e[(axis + 2) % 3];
    double past_rounding = 1e-14 * (fabs(a[0]) + fabs(a[1])) * (fabs(b[0]) + fabs(b[1]));
    if (i > 0 && !(a[0] * b[1] - a[1] * b[0] > past_rounding)) return false;
    turns += i > 0 && a[1] < 0 && b[1] >= 0;
    a[0] = b[0];
    a[1] = b[1];
  }
  return turns == 1;
}

/* The vertex that half-edge h leaves, if its fan shows that no two of its facets share more than
 * they must. Several threads may come to the same answer for a vertex. */
static uint32_t graph_vertex(const prover *p, uint32_t h) {
  uint32_t v = p->mesh->triangles[h];
  uint8_t known = __atomic_load_n(&p->fans[v], __ATOMIC_RELAXED);
  if (known == FAN_UNKNOWN) {
    known = p->ring && fan_is_graph(p, h) ? FAN_GRAPH : FAN_UNSURE;
    __atomic_store_n(&p->fans[v], known, __ATOMIC_RELAXED);
  }
  return known == FAN_GRAPH ? v : NO_VERTEX;
}

static void load(const prover *p, size_t item, facet *f, lanes *l, size_t i) {
  size_t h = 3 * (size_t)p->items[item];
  f->corner = p->mesh->triangles + h;
  for (size_t k = 0; k < 3; k++) {
    f->at[k] = vec3_load(p->mesh->positions + 3 * (size_t)f->corner[k]);
    l->corner[k][i] = f->corner[k];
    l->graph[k][i] = graph_vertex(p, (uint32_t)(h + k));
  }
  /* shifting, scaling and rounding keep the order: boxes that are apart in cells are apart */
  vec3 low = vec3_min(f->at[0], vec3_min(f->at[1], f->at[2]));
  vec3 high = vec3_max(f->at[0], vec3_max(f->at[1], f->at[2]));
  low = vec3_scale(vec3_sub(low, p->low), p->per_length);
  high = vec3_scale(vec3_sub(high, p->low), p->per_length);
  l->low[0][i] = (float)low.x;
  l->low[1][i] = (float)low.y;
  l->low[2][i] = (float)low.z;
  l->high[0][i] = (float)high.x;
  l->high[1][i] = (float)high.y;
  l->high[2][i] = (float)high.z;
  l->begins[i] = p->begins[item];
  vec3 e1 = vec3_sub(f->at[1], f->at[0]), e2 = vec3_sub(f->at[2], f->at[0]);
  f->n = vec3_cross(e1, e2);
  f->error = 1e-14 * size_of(e1) * size_of(e2);
}

/* Which of the first `count` facets (a multiple of LANES) facet i may meet here: this is the first
 * cell of both, their boxes touch, and no graph has both. */
SCREE_LANES static void look_at_pairs(lanes *l, size_t i, size_t count) {
  const float x0 = l->low[0][i], y0 = l->low[1][i], z0 = l->low[2][i];
  const float x1 = l->high[0][i], y1 = l->high[1][i], z1 = l->high[2][i];
  const uint32_t a = l->graph[0][i], b = l->graph[1][i], c = l->graph[2][i], begins = l->begins[i];
  for (size_t j = 0; j < count; j++) {
    uint32_t u = l->corner[0][j], v = l->corner[1][j], w = l->corner[2][j];
    uint32_t near = (l->begins[j] | begins) == 7;
    near &= (l->low[0][j] <= x1) & (l->high[0][j] >= x0);
    near &= (l->low[1][j] <= y1) & (l->high[1][j] >= y0);
    near &= (l->low[2][j] <= z1) & (l->high[2][j] >= z0);
    near &= (u != a) & (u != b) & (u != c) & (v != a) & (v != b) & (v != c);
    near &= (w != a) & (w != b) & (w != c);
    l->near[j] = near;
  }
}

static bool cell_is_clear(const prover *p, size_t cell, cell_facets *c) {
  size_t begin = p->start[cell], count = p->start[cell + 1] - begin;
  if (count > CROWD) return false;
  for (size_t i = 0; i < count; i++) load(p, begin + i, &c->facets[i], &c->lanes, i);
  for (size_t i = 1; i < count; i++) {
    const facet *f = &c->facets[i], *g = c->facets;
    look_at_pairs(&c->lanes, i, (i + LANES - 1) / LANES * LANES);
    for (size_t j = 0; j < i; j++, g++) {
      if (!c->lanes.near[j] || beside(f, g) || beside(g, f)) continue;
      if (scree_triangles_meet(p->mesh->positions, f->corner, g->corner) != SCREE_MEET_NOT)
        return false;
    }
  }
  return true;
}

static void cell_block(void *context, scree_block block) {
  prover *p = context;
  cell_facets facets;
  memset(&facets.lanes, 0, sizeof facets.lanes);
  for (size_t cell = block.begin; cell < block.end; cell++) {
    if (p->start[cell + 1] - p->start[cell] < 2) continue;
    if (atomic_load_explicit(&p->failed, memory_order_relaxed)) return;
    if (!cell_is_clear(p, cell, &facets)) atomic_store(&p->failed, true);
  }
}

static void free_prover(prover *p) {
  SCREE_FREE_ALL(p->cells, p->items, p->begins, p->fans, p->start);
}

scree_status scree_facets_apart(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                bool *apart, scree_error *error) {
  SCREE_CLEANUP(free_prover)
  prover p = {.mesh = mesh, .ring = adjacency ? adjacency->ring : NULL};
  size_t cell_count, sum = 0, facets = mesh->triangle_count;
  *apart = false;
  if (facets == 0 || !shape(&p, &cell_count)) return SCREE_OK;
  SCREE_TRY_ALLOC(p.cells, facets, error);
  SCREE_TRY_ALLOC_ZERO(p.start, cell_count + 1, error);
  scree_parallel_for(facets, FACET_BLOCK, count_block, &p);
  for (size_t c = 0; c <= cell_count; c++) p.start[c] = (uint32_t)(sum += p.start[c]);
  if (p.failed || sum > ENTRIES_PER_FACET * facets || sum > UINT32_MAX) return SCREE_OK;
  SCREE_TRY_ALLOC(p.items, sum, error);
  SCREE_TRY_ALLOC(p.begins, sum, error);
  SCREE_TRY_ALLOC_ZERO(p.fans, mesh->vertex_count, error);
  scree_parallel_for(facets, FACET_BLOCK, fill_block, &p);
  scree_free(p.cells);
  p.cells = NULL;
  scree_parallel_for(cell_count, CELL_BLOCK, cell_block, &p);
  *apart = !p.failed;
  return SCREE_OK;
}
