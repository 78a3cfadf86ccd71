/* The boundary of a union by cutting facets where others meet them.
 *
 * A facet that meets others is cut in its plane: by the segments in which the others pass through
 * it, and by the edges of those that lie in its plane. What is left of it are convex cells that
 * nothing passes through, so the winding number is the same all over either side of a cell. It is
 * counted at a point drawn in the cell (mesh/index/winding.c). Facets that lie in the cell's plane
 * are known from the search for meetings and count together. A cell bounds the union where the
 * winding number is positive on one side only; of cells on top of each other the one of the lowest
 * facet counts. Facets that meet nothing are asked one for all that hang together.
 *
 * The volume is the sum of the cones over these cells (measure.c). Cuts are moved by the rounding
 * of coordinates over the sine of the angle at which facets cross; where that is no longer small,
 * it is said that the volume is not known. */
#include "mesh/measure/bounds.h"

#include "base/array.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "base/sum.h"
#include "mesh/index/winding.h"

#include <stdatomic.h>

enum {
  FACET_BLOCK = 64,
  MOST_CELLS = 20000,     /* of one facet */
  MOST_PARTNERS = 100000, /* of one facet */
  ATTEMPTS = 16,          /* sample points in a cell; one in general position is all but sure */
};

/* Below this share of its facet's area a cell is rounding. */
#define LEAST_CELL 1e-14
/* A cell below this share that cannot be asked is left out. */
#define DOUBTFUL_CELL 1e-12
/* A segment that a cell has less of than this share of its facet's size does not cut it. */
#define LEAST_CUT 1e-12
/* Facets that meet at a smaller angle than this (its sine) are not cut. */
#define LEAST_SINE 1e-6
typedef scree_seen point;
typedef scree_view view;

typedef struct cell {
  uint32_t begin, count; /* of points */
} cell;

/* What one worker needs for one facet at a time. */
typedef struct slicer {
  struct {
    point *items;
    size_t count, capacity;
  } points;
  struct {
    cell *items;
    size_t count, capacity;
  } cells;
} slicer;

typedef struct work {
  const scree_facet_tree *tree;
  const scree_mesh *mesh;
  uint32_t *first;    /* by facet, and one more: its partners' begin */
  uint32_t *partners; /* facet << 1 | it lies in the same plane */
  uint32_t *asked;    /* facets to cut, then those that speak for a piece of surface */
  size_t cut_count, asked_count;
  double *pieces; /* six times the volume of the cones over the piece that asked[] speaks for */
  vec3 origin;
  scree_winding winding;
  scree_sum *sums; /* per block */
  atomic_bool unknown, failed;
} work;

/* ---- Cutting ---- */

static bool start_cells(slicer *s, const view *f) {
  s->points.count = s->cells.count = 0;
  for (int k = 0; k < 3; k++)
    if (!SCREE_PUSH(&s->points, (point){f->corner[k][f->u], f->corner[k][f->v]})) return false;
  return SCREE_PUSH(&s->cells, (cell){0, 3});
}

static double turn(point a, point b, point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static double area_of(const slicer *s, cell c) {
  const point *p = s->points.items + c.begin;
  double twice = 0;
  for (uint32_t i = 2; i < c.count; i++) twice += turn(p[0], p[i - 1], p[i]);
  return 0.5 * fabs(twice);
}

/* Whether the segment has more than `least` of its length within the cell. */
static bool passes_through(const slicer *s, cell c, point a, point b, double side, double least) {
  const point *p = s->points.items + c.begin;
  double from = 0, to = 1, length = hypot(b.x - a.x, b.y - a.y);
  for (uint32_t i = 0; i < c.count; i++) {
    point q = p[i], r = p[(i + 1) % c.count];
    double edge = hypot(r.x - q.x, r.y - q.y);
    double da = side * turn(q, r, a), db = side * turn(q, r, b), near = least * edge;
    if (da <= near && db <= near) return false;
    if (da < 0) from = fmax(from, da / (da - db));
    if (db < 0) to = fmin(to, da / (da - db));
  }
  return (to - from) * length > least;
}

/* Cuts the cell along the line of a and b in two new ones, the first in its place. */
static bool split_cell(slicer *s, size_t index, point a, point b) {
  const cell old = s->cells.items[index];
  cell parts[2];
  for (int half = 0; half < 2; half++) {
    double sign = half ? -1 : 1;
    parts[half].begin = (uint32_t)s->points.count;
    for (uint32_t i = 0; i < old.count; i++) {
      point q = s->points.items[old.begin + i],
            r = s->points.items[old.begin + (i + 1) % old.count];
      double dq = sign * turn(a, b, q), dr = sign * turn(a, b, r);
      if (dq >= 0 && !SCREE_PUSH(&s->points, q)) return false;
      if ((dq > 0 && dr < 0) || (dq < 0 && dr > 0)) {
        double t = dq / (dq - dr);
        point cut = {q.x + t * (r.x - q.x), q.y + t * (r.y - q.y)};
        if (!SCREE_PUSH(&s->points, cut)) return false;
      }
    }
    parts[half].count = (uint32_t)s->points.count - parts[half].begin;
  }
  if (parts[0].count < 3 || parts[1].count < 3) return true;
  s->cells.items[index] = parts[0];
  return SCREE_PUSH(&s->cells, parts[1]);
}

static bool cut_by_segment(slicer *s, const view *f, point a, point b, double least) {
  for (size_t i = 0, count = s->cells.count; i < count; i++)
    if (passes_through(s, s->cells.items[i], a, b, f->side, least) && !split_cell(s, i, a, b))
      return false;
  return true;
}

/* Where the edge from p to q, on different sides of f's plane, goes through it. */
static point pierce(const view *f, const double *p, const double *q) {
  vec3 a = vec3_load(f->corner[0]);
  vec3 n = vec3_triangle_normal(a, vec3_load(f->corner[1]), vec3_load(f->corner[2]));
  double dp = vec3_dot(n, vec3_sub(vec3_load(p), a)), dq = vec3_dot(n, vec3_sub(vec3_load(q), a));
  double t = dp != dq ? dp / (dp - dq) : 0.5;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return (point){p[f->u] + t * (q[f->u] - p[f->u]), p[f->v] + t * (q[f->v] - p[f->v])};
}

/* Whether the two are so nearly in one plane that rounding says where they meet, and which is the
 * upper one. */
static bool grazes(const view *f, const view *g) {
  vec3 n = vec3_triangle_normal(vec3_load(f->corner[0]), vec3_load(f->corner[1]),
                                vec3_load(f->corner[2]));
  vec3 m = vec3_triangle_normal(vec3_load(g->corner[0]), vec3_load(g->corner[1]),
                                vec3_load(g->corner[2]));
  return vec3_norm(vec3_cross(n, m)) < LEAST_SINE * vec3_norm(n) * vec3_norm(m);
}

/* Cuts by the part that facet `other` has in f's plane. */
static bool cut_by_facet(work *w, slicer *s, const view *f, uint32_t other, double least) {
  view g = *f;
  const double **c = g.corner;
  int side[3];
  point ends[6];
  int count = 0;
  for (int k = 0; k < 3; k++) {
    c[k] = w->mesh->positions + 3 * (size_t)w->mesh->triangles[3 * (size_t)other + (size_t)k];
    side[k] = scree_orient3(f->corner[0], f->corner[1], f->corner[2], c[k]);
  }
  if (!side[0] && !side[1] && !side[2]) {
    for (int k = 0; k < 3; k++)
      if (!cut_by_segment(s, f, scree_view_point(f, c[k]), scree_view_point(f, c[(k + 1) % 3]),
                          least))
        return false;
    return true;
  }
  if (grazes(f, &g)) atomic_store(&w->unknown, true);
  for (int k = 0; k < 3; k++) {
    int next = (k + 1) % 3;
    if (!side[k]) ends[count++] = scree_view_point(f, c[k]);
    if (side[k] * side[next] < 0) ends[count++] = pierce(f, c[k], c[next]);
  }
  return count < 2 || cut_by_segment(s, f, ends[0], ends[1], least);
}

static bool cut_facet(work *w, slicer *s, uint32_t facet, const view *f) {
  double size = 0;
  for (int k = 0; k < 3; k++) {
    point p = scree_view_point(f, f->corner[k]), q = scree_view_point(f, f->corner[(k + 1) % 3]);
    size = fmax(size, hypot(q.x - p.x, q.y - p.y));
  }
  if (!start_cells(s, f)) return false;
  for (uint32_t i = w->first[facet]; i < w->first[facet + 1]; i++) {
    if (!cut_by_facet(w, s, f, w->partners[i] >> 1, LEAST_CUT * size)) return false;
    if (s->cells.count > MOST_CELLS) {
      atomic_store(&w->unknown, true);
      return true;
    }
  }
  return true;
}

/* ---- Adding up ---- */

/* A point in the cell, another for each attempt. */
static point draw(const slicer *s, cell c, scree_rng *rng) {
  const point *p = s->points.items + c.begin;
  double sum = 0, x = 0, y = 0;
  for (uint32_t i = 0; i < c.count; i++) {
    double weight = 0.5 + scree_rng_uniform(rng);
    sum += weight;
    x += weight * p[i].x;
    y += weight * p[i].y;
  }
  return (point){x / sum, y / sum};
}

/* +1: as it is wound, the cell bounds the union; -1: turned round; 0: it does not, or another facet
 * speaks for the place. */
static int role_of(work *w, const slicer *s, uint32_t facet, const view *f, cell c) {
  scree_rng rng = {.seed = facet, .stream = c.begin};
  for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
    scree_sides found;
    if (!scree_winding_look(&w->winding, facet, f, draw(s, c, &rng), &found)) continue;
    if (found.above < 0 || found.below < 0) break;
    return found.owner ? f->side * ((found.below > 0) - (found.above > 0)) : 0;
  }
  if (area_of(s, c) > DOUBTFUL_CELL * area_of(s, (cell){0, 3})) atomic_store(&w->unknown, true);
  return 0;
}

static vec3 lift(const view *f, point p) {
  double q[3];
  q[f->u] = p.x, q[f->v] = p.y, q[f->axis] = scree_view_height(f, p);
  return vec3_load(q);
}

/* Six times the volume of the cone from the origin over the cell. */
static double cone_over(const work *w, const slicer *s, const view *f, cell c) {
  vec3 a = lift(f, s->points.items[c.begin]), b = lift(f, s->points.items[c.begin + 1]);
  double sum = 0;
  for (uint32_t i = 2; i < c.count; i++) {
    vec3 next = lift(f, s->points.items[c.begin + i]);
    sum += vec3_dot(vec3_sub(a, w->origin), vec3_triangle_normal(a, b, next));
    b = next;
  }
  return sum;
}

static bool add_cut(work *w, slicer *s, uint32_t facet, scree_sum *sum) {
  view f = scree_view_of(w->mesh, facet);
  if (!f.side) return true; /* no area */
  if (!cut_facet(w, s, facet, &f)) return false;
  double least = LEAST_CELL * area_of(s, (cell){0, 3});
  for (size_t i = 0; i < s->cells.count && !atomic_load(&w->unknown); i++) {
    cell c = s->cells.items[i];
    if (area_of(s, c) <= least) continue;
    int role = role_of(w, s, facet, &f, c);
    if (role) scree_sum_add(sum, role * cone_over(w, s, &f, c));
  }
  return true;
}

static bool add_piece(work *w, slicer *s, size_t asked, scree_sum *sum) {
  uint32_t facet = w->asked[asked];
  view f = scree_view_of(w->mesh, facet);
  if (!f.side || w->pieces[asked] == 0) return true;
  if (!start_cells(s, &f)) return false;
  scree_sum_add(sum, role_of(w, s, facet, &f, s->cells.items[0]) * w->pieces[asked]);
  return true;
}

static void add_block(void *context, scree_block block) {
  work *w = context;
  slicer s = {0};
  scree_sum sum = {0};
  bool good = true;
  for (size_t i = block.begin; i < block.end && good && !atomic_load(&w->unknown); i++)
    good = i < w->cut_count ? add_cut(w, &s, w->asked[i], &sum) : add_piece(w, &s, i, &sum);
  if (!good) atomic_store(&w->failed, true);
  w->sums[block.index] = sum;
  scree_free(s.points.items);
  scree_free(s.cells.items);
}

/* ---- Who is asked ---- */

static scree_status list_partners(work *w, const scree_meetings *found, scree_error *error) {
  size_t facets = w->mesh->triangle_count;
  SCREE_TRY_ALLOC_ZERO(w->first, facets + 1, error);
  SCREE_TRY_ALLOC(w->partners, 2 * found->count, error);
  for (size_t i = 0; i < found->count; i++)
    w->first[found->items[i].first]++, w->first[found->items[i].second]++;
  uint32_t sum = 0;
  for (size_t t = 0; t <= facets; t++) {
    if (w->first[t] > MOST_PARTNERS) atomic_store(&w->unknown, true);
    w->first[t] = sum += w->first[t];
  }
  for (size_t i = found->count; i-- > 0;) {
    const scree_meeting *m = &found->items[i];
    uint32_t flat = m->meet == SCREE_MEET_OVERLAP;
    w->partners[--w->first[m->first]] = m->second << 1 | flat;
    w->partners[--w->first[m->second]] = m->first << 1 | flat;
  }
  return SCREE_OK;
}

static bool meets(const work *w, uint32_t facet) {
  return w->first[facet] != w->first[facet + 1];
}

/* Facets that meet nothing, joined over edges of two such; parent is the set's lowest facet. */
static void join_pieces(const work *w, const scree_adjacency *adjacency, uint32_t *parent) {
  for (uint32_t t = 0; t < w->mesh->triangle_count; t++) parent[t] = t;
  for (size_t e = 0; e < adjacency->edge_count; e++) {
    uint32_t h = adjacency->edges[e], g = adjacency->ring[h];
    if (adjacency->ring[g] == h && !meets(w, h / 3) && !meets(w, g / 3))
      scree_join(parent, h / 3, g / 3);
  }
}

/* The largest facet speaks for each piece. number has room for one of each facet. */
static void ask_pieces(work *w, uint32_t *parent, uint32_t *number) {
  const scree_mesh *mesh = w->mesh;
  size_t asked = w->cut_count;
  for (uint32_t t = 0; t < mesh->triangle_count; t++) {
    if (meets(w, t)) continue;
    uint32_t root = scree_find_root(parent, t); /* the lowest: it comes first */
    if (root == t) {
      number[t] = (uint32_t)asked;
      w->asked[asked] = t;
      w->pieces[asked++] = 0;
    }
    uint32_t *speaker = &w->asked[number[root]];
    vec3 n = scree_facet_normal(mesh, t);
    if (vec3_norm2(n) > vec3_norm2(scree_facet_normal(mesh, *speaker))) *speaker = t;
    w->pieces[number[root]] += vec3_dot(vec3_sub(scree_mesh_corner(mesh, t, 0), w->origin), n);
  }
  w->asked_count = asked;
}

static scree_status list_asked(work *w, const scree_adjacency *adjacency, scree_error *error) {
  size_t count = w->mesh->triangle_count;
  SCREE_SCRATCH(uint32_t, parent, count, error);
  SCREE_SCRATCH(uint32_t, number, count, error);
  SCREE_TRY_ALLOC(w->asked, count, error);
  SCREE_TRY_ALLOC(w->pieces, count, error);
  for (uint32_t t = 0; t < count; t++)
    if (meets(w, t)) w->asked[w->cut_count++] = t;
  join_pieces(w, adjacency, parent);
  ask_pieces(w, parent, number);
  return SCREE_OK;
}

static void free_work(work *w) {
  SCREE_FREE_ALL(w->first, w->partners, w->asked, w->pieces, w->sums);
}

scree_status scree_union_volume(const scree_facet_tree *tree, const scree_adjacency *adjacency,
                                const scree_meetings *found, double *volume, bool *known,
                                scree_error *error) {
  const scree_box *box = &tree->tree.nodes[0].box;
  SCREE_CLEANUP(free_work)
  work w = {.tree = tree, .mesh = tree->mesh, .origin = vec3_lerp(box->low, box->high, 0.5)};
  scree_sum sum = {0};
  SCREE_TRY(list_partners(&w, found, error));
  SCREE_TRY(list_asked(&w, adjacency, error));
  w.winding = (scree_winding){tree, NULL, w.first, w.partners, scree_winding_rounding(tree)};
  size_t blocks = scree_block_count(w.asked_count, FACET_BLOCK);
  SCREE_TRY_ALLOC(w.sums, blocks, error);
  scree_parallel_for(w.asked_count, FACET_BLOCK, add_block, &w);
  if (atomic_load(&w.failed))
    return scree_fail_memory(error, sizeof(point), "the volume of a union");
  *known = !atomic_load(&w.unknown);
  for (size_t i = 0; i < blocks; i++) scree_sum_merge(&sum, w.sums[i]);
  if (*known) *volume = scree_sum_value(sum) / 6;
  return SCREE_OK;
}
