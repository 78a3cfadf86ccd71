/* A constrained Delaunay triangulation of a facet as it is seen along the axis nearest to its
 * normal. Vertices on the rim split triangles there, inner ones the triangle they lie in, edges are
 * flipped until they are Delaunay (Lawson 1977); a segment is recovered by flipping the edges that
 * it crosses (Sloan, "A fast algorithm for generating constrained Delaunay triangulations",
 * Computers & Structures 47 (1993)). Which side a vertex lies on is told by exact predicates, so
 * every triangle keeps its orientation; whether an edge is Delaunay only makes triangles rounder
 * and is not. Of four vertices on a circle the lowest index gets the diagonal, so that coplanar
 * facets with the same vertices are cut alike.
 *
 * Where vertices on the rim, which lie there within rounding only, do not allow triangles of the
 * right orientation, the rim is triangulated ear by ear, the shortest diagonal first. */
#include "mesh/repair/facet_cut.h"

#include "base/array.h"
#include "base/radix.h"
#include "mesh/index/winding.h"
#include "mesh/predicates.h"

#include <stdlib.h>
#include <string.h>

/* Four vertices are on a circle where the determinant is below this share of its terms. */
#define CIRCLE_ROUNDING 1e-12

enum { FLIPS_PER_TRIANGLE = 64, NONE = -1 };

typedef struct corner {
  double at[2];
  uint32_t id;
  int hint; /* a triangle that has it */
} corner;

typedef struct triangle {
  int v[3], n[3]; /* n[k]: beyond the edge from v[k] to v[k + 1], or NONE */
  bool fixed[3];  /* that edge */
} triangle;

typedef struct edge {
  int from, to;
} edge;

typedef struct name {
  uint32_t id;
  int corner;
} name;

/* A corner on a segment. */
typedef struct stop {
  double along;
  int corner;
} stop;

struct scree_facet_cutter {
  struct {
    corner *items;
    size_t count, capacity;
  } corners;
  struct {
    triangle *items;
    size_t count, capacity;
  } triangles;
  struct {
    int *items;
    size_t count, capacity;
  } stack;
  struct {
    edge *items;
    size_t count, capacity;
  } crossed;
  struct {
    name *items;
    size_t count, capacity;
  } names;
  struct {
    stop *items;
    size_t count, capacity;
  } stops;
  const scree_facet_job *job;
  scree_view view;
  size_t flips;
  bool failed; /* memory is out */
};

scree_facet_cutter *scree_facet_cutter_create(void) {
  scree_facet_cutter *c = scree_alloc(1, sizeof *c);
  if (c) *c = (scree_facet_cutter){.failed = false};
  return c;
}

void scree_facet_cutter_free(scree_facet_cutter *c) {
  if (!c) return;
  SCREE_FREE_ALL(c->corners.items, c->triangles.items, c->stack.items, c->crossed.items,
                 c->names.items, c->stops.items, c);
}

static int next_of(int k) {
  return k == 2 ? 0 : k + 1;
}
static int before(int k) {
  return k == 0 ? 2 : k - 1;
}

static int turn(const scree_facet_cutter *c, int i, int j, int k) {
  const corner *p = c->corners.items;
  return scree_orient2(p[i].at, p[j].at, p[k].at);
}

/* ---- Triangles ---- */

static int add_corner(scree_facet_cutter *c, uint32_t id) {
  const double *p = c->job->positions + 3 * (size_t)id;
  scree_seen at = scree_view_point(&c->view, p);
  /* mirrored where the facet faces backwards, so that triangles turn counter-clockwise */
  corner made = {{c->view.side < 0 ? -at.x : at.x, at.y}, id, NONE};
  if (!SCREE_PUSH(&c->corners, made)) c->failed = true;
  return c->failed ? 0 : (int)c->corners.count - 1;
}

static void set(scree_facet_cutter *c, int t, triangle value) {
  c->triangles.items[t] = value;
  for (int k = 0; k < 3; k++) c->corners.items[value.v[k]].hint = t;
}

static int add(scree_facet_cutter *c, triangle value) {
  if (!SCREE_PUSH(&c->triangles, value)) {
    c->failed = true;
    return 0;
  }
  int t = (int)c->triangles.count - 1;
  set(c, t, value);
  return t;
}

/* Triangle t, once beside `old`, is beside `now`. */
static void rejoin(scree_facet_cutter *c, int t, int old, int now) {
  for (int k = 0; t != NONE && k < 3; k++)
    if (c->triangles.items[t].n[k] == old) {
      c->triangles.items[t].n[k] = now;
      return;
    }
}

static int edge_towards(const scree_facet_cutter *c, int t, int other) {
  const triangle *f = &c->triangles.items[t];
  return f->n[0] == other ? 0 : f->n[1] == other ? 1 : 2;
}

static bool positive(const scree_facet_cutter *c, int t) {
  const int *v = c->triangles.items[t].v;
  return turn(c, v[0], v[1], v[2]) > 0;
}

/* The rim's edge k of t gets vertex p; answers the triangle behind p. */
static int split_rim(scree_facet_cutter *c, int t, int k, int p) {
  triangle f = c->triangles.items[t];
  int x = f.v[k], y = f.v[next_of(k)], z = f.v[before(k)];
  int beyond = f.n[next_of(k)], behind = f.n[before(k)];
  int u = add(c, (triangle){.v = {p, y, z}, .n = {NONE, beyond, t}});
  if (c->failed) return 0;
  set(c, t, (triangle){.v = {x, p, z}, .n = {NONE, u, behind}});
  rejoin(c, beyond, t, u);
  return u;
}

static void split_face(scree_facet_cutter *c, int t, int p) {
  triangle f = c->triangles.items[t];
  int u = add(c, (triangle){.v = {f.v[1], f.v[2], p}, .n = {f.n[1], NONE, t}});
  int w = add(c, (triangle){.v = {f.v[2], f.v[0], p}, .n = {f.n[2], t, u}});
  if (c->failed) return;
  c->triangles.items[u].n[1] = w;
  set(c, t, (triangle){.v = {f.v[0], f.v[1], p}, .n = {f.n[0], u, w}});
  rejoin(c, f.n[1], t, u);
  rejoin(c, f.n[2], t, w);
}

/* The two triangles at edge k of t get the other diagonal. */
static void flip(scree_facet_cutter *c, int t, int k) {
  triangle f = c->triangles.items[t];
  int o = f.n[k], j = edge_towards(c, o, t);
  triangle g = c->triangles.items[o];
  int a = f.v[k], b = f.v[next_of(k)], p = f.v[before(k)], q = g.v[before(j)];
  int after_b = f.n[next_of(k)], after_q = g.n[next_of(j)];
  set(c, t,
      (triangle){.v = {a, q, p},
                 .n = {after_q, o, f.n[before(k)]},
                 .fixed = {g.fixed[next_of(j)], false, f.fixed[before(k)]}});
  set(c, o,
      (triangle){.v = {q, b, p},
                 .n = {g.n[before(j)], after_b, t},
                 .fixed = {g.fixed[before(j)], f.fixed[next_of(k)], false}});
  rejoin(c, after_q, o, t);
  rejoin(c, after_b, t, o);
}

/* Whether the quadrilateral at edge k of t is strictly convex. */
static bool can_flip(const scree_facet_cutter *c, int t, int k) {
  const triangle *f = &c->triangles.items[t];
  int o = f->n[k];
  if (o == NONE || f->fixed[k]) return false;
  int a = f->v[k], b = f->v[next_of(k)], p = f->v[before(k)],
      q = c->triangles.items[o].v[before(edge_towards(c, o, t))];
  return turn(c, a, q, p) > 0 && turn(c, q, b, p) > 0;
}

/* Whether the other diagonal is the better one. */
static bool should_flip(const scree_facet_cutter *c, int t, int k) {
  const triangle *f = &c->triangles.items[t];
  const corner *p = c->corners.items;
  if (!can_flip(c, t, k)) return false;
  int q = c->triangles.items[f->n[k]].v[before(edge_towards(c, f->n[k], t))];
  const corner *a = &p[f->v[k]], *b = &p[f->v[next_of(k)]], *e = &p[f->v[before(k)]], *d = &p[q];
  double ax = a->at[0] - d->at[0], ay = a->at[1] - d->at[1], bx = b->at[0] - d->at[0],
         by = b->at[1] - d->at[1], ex = e->at[0] - d->at[0], ey = e->at[1] - d->at[1];
  double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, e2 = ex * ex + ey * ey;
  double terms[3] = {a2 * (bx * ey - ex * by), b2 * (ex * ay - ax * ey), e2 * (ax * by - bx * ay)};
  double det = terms[0] + terms[1] + terms[2];
  double rounding = CIRCLE_ROUNDING *
                    (a2 * (fabs(bx * ey) + fabs(ex * by)) + b2 * (fabs(ex * ay) + fabs(ax * ey)) +
                     e2 * (fabs(ax * by) + fabs(bx * ay)));
  if (fabs(det) > rounding) return det > 0;
  uint32_t now = a->id < b->id ? a->id : b->id, then = e->id < d->id ? e->id : d->id;
  return then < now;
}

static void push(scree_facet_cutter *c, int t) {
  if (!SCREE_PUSH(&c->stack, t)) c->failed = true;
}

/* Flips edges of the triangles on the stack, and of those that this changes, until all are
 * Delaunay.
 */
static void relax(scree_facet_cutter *c) {
  while (!c->failed && c->stack.count > 0) {
    int t = c->stack.items[--c->stack.count];
    for (int k = 0; k < 3; k++) {
      if (c->flips >= FLIPS_PER_TRIANGLE * c->triangles.count || !should_flip(c, t, k)) continue;
      int o = c->triangles.items[t].n[k];
      c->flips++;
      flip(c, t, k);
      push(c, t);
      push(c, o);
      break;
    }
  }
}

/* ---- Vertices ---- */

/* Where a vertex lies. */
typedef struct place {
  int t, edge; /* edge NONE: strictly within t; t NONE: nowhere */
} place;

static place place_in(const scree_facet_cutter *c, int t, int p) {
  const int *v = c->triangles.items[t].v;
  place found = {t, NONE};
  int on = 0;
  for (int k = 0; k < 3; k++) {
    int side = turn(c, v[k], v[next_of(k)], p);
    if (side < 0) return (place){NONE, k};
    if (side == 0) found.edge = k, on++;
  }
  if (on > 1) found.t = NONE; /* at a corner, as it is seen */
  return found;
}

static place find_place(const scree_facet_cutter *c, int p) {
  int t = (int)c->triangles.count - 1;
  for (size_t steps = 0; steps <= c->triangles.count; steps++) {
    place found = place_in(c, t, p);
    if (found.t != NONE) return found;
    int on = found.edge == NONE ? NONE : c->triangles.items[t].n[found.edge];
    if (on == NONE) break;
    t = on;
  }
  for (t = 0; t < (int)c->triangles.count; t++) {
    place found = place_in(c, t, p);
    if (found.t != NONE) return found;
  }
  return (place){NONE, NONE};
}

static void insert(scree_facet_cutter *c, int p) {
  place at = find_place(c, p);
  if (at.t == NONE) return;
  int o = at.edge == NONE ? NONE : c->triangles.items[at.t].n[at.edge];
  if (at.edge != NONE && o == NONE) return; /* on the rim: not a vertex of it, so not here */
  int first = (int)c->triangles.count;
  split_face(c, at.t, p);
  if (c->failed) return;
  push(c, at.t), push(c, first), push(c, first + 1);
  if (at.edge != NONE) {
    /* the triangle between p and its edge is flat: the other diagonal leaves none */
    int flat = at.edge == 0 ? at.t : first + at.edge - 1;
    flip(c, flat, 0);
    push(c, o);
  }
  relax(c);
}

/* ---- Segments ---- */

/* The triangle that has the edge from a to b, and which edge it is; NONE: there is none. */
static place find_edge(const scree_facet_cutter *c, int a, int b) {
  int start = c->corners.items[a].hint;
  for (int direction = 0; direction < 2 && start != NONE; direction++) {
    int t = start;
    for (size_t steps = 0; steps <= c->triangles.count && t != NONE; steps++) {
      const triangle *f = &c->triangles.items[t];
      int k = f->v[0] == a ? 0 : f->v[1] == a ? 1 : 2;
      if (f->v[next_of(k)] == b) return (place){t, k};
      if (f->v[before(k)] == b) return (place){t, before(k)};
      t = direction ? f->n[k] : f->n[before(k)];
      if (t == start) return (place){NONE, NONE};
    }
  }
  return (place){NONE, NONE};
}

static void fix(scree_facet_cutter *c, place at) {
  triangle *f = &c->triangles.items[at.t];
  int o = f->n[at.edge];
  f->fixed[at.edge] = true;
  if (o != NONE) c->triangles.items[o].fixed[edge_towards(c, o, at.t)] = true;
}

/* Whether x lies on the segment from a to b, which are on one line with it. */
static bool is_ahead(const scree_facet_cutter *c, int a, int b, int x) {
  const double *p = c->corners.items[a].at, *q = c->corners.items[b].at,
               *r = c->corners.items[x].at;
  return (q[0] - p[0]) * (r[0] - p[0]) + (q[1] - p[1]) * (r[1] - p[1]) > 0;
}

/* The triangle at a that the segment to b leaves through its far edge: {t, that edge}; *through is
 * a vertex that the segment meets first, or NONE. */
static place find_start(const scree_facet_cutter *c, int a, int b, int *through) {
  int start = c->corners.items[a].hint;
  *through = NONE;
  for (int direction = 0; direction < 2; direction++) {
    int t = start;
    for (size_t steps = 0; steps <= c->triangles.count && t != NONE; steps++) {
      const triangle *f = &c->triangles.items[t];
      int k = f->v[0] == a ? 0 : f->v[1] == a ? 1 : 2, x = f->v[next_of(k)], y = f->v[before(k)];
      int sx = turn(c, a, b, x), sy = turn(c, a, b, y);
      if (sx == 0 && is_ahead(c, a, b, x)) *through = x;
      if (sy == 0 && is_ahead(c, a, b, y)) *through = y;
      if (*through != NONE) return (place){t, k};
      if (sx < 0 && sy > 0) return (place){t, next_of(k)};
      t = direction ? f->n[k] : f->n[before(k)];
      if (t == start) return (place){NONE, NONE};
    }
  }
  return (place){NONE, NONE};
}

/* Lists the edges that the segment from a crosses until it meets a vertex, which is answered; NONE
 * where one of them is fixed. */
static int list_crossed(scree_facet_cutter *c, int a, int b, place at) {
  c->crossed.count = 0;
  for (size_t steps = 0; steps <= c->triangles.count; steps++) {
    const triangle *f = &c->triangles.items[at.t];
    int o = f->n[at.edge], x = f->v[at.edge], y = f->v[next_of(at.edge)];
    if (o == NONE || f->fixed[at.edge]) return NONE;
    if (!SCREE_PUSH(&c->crossed, (edge){x, y})) {
      c->failed = true;
      return NONE;
    }
    int j = edge_towards(c, o, at.t), d = c->triangles.items[o].v[before(j)];
    int side = d == b ? 0 : turn(c, a, b, d);
    if (side == 0) return d;
    /* o has the edges y-x (j), x-d (j + 1), d-y (j + 2) */
    at = (place){o, side > 0 ? next_of(j) : before(j)};
  }
  return NONE;
}

/* Flips the edges listed until none crosses the segment from a to b. */
static void flip_crossed(scree_facet_cutter *c, int a, int b) {
  size_t budget = 64 + 16 * c->crossed.count * c->crossed.count;
  for (size_t i = 0; i < c->crossed.count && i < budget && !c->failed; i++) {
    edge e = c->crossed.items[i];
    place at = find_edge(c, e.from, e.to);
    if (at.t == NONE) continue;
    const triangle *f = &c->triangles.items[at.t];
    edge other = e;
    if (can_flip(c, at.t, at.edge)) {
      int o = f->n[at.edge];
      other.from = f->v[before(at.edge)];
      other.to = c->triangles.items[o].v[before(edge_towards(c, o, at.t))];
      flip(c, at.t, at.edge);
      push(c, at.t), push(c, o);
      if (other.from == a || other.from == b || other.to == a || other.to == b ||
          turn(c, a, b, other.from) * turn(c, a, b, other.to) >= 0)
        continue;
    }
    if (!SCREE_PUSH(&c->crossed, other)) c->failed = true;
  }
}

/* Makes the segment an edge, or several where it passes through vertices. */
static void insert_segment(scree_facet_cutter *c, int a, int b) {
  while (a != b && !c->failed) {
    int through;
    place at = find_start(c, a, b, &through);
    if (at.t == NONE) return;
    if (through == NONE) {
      through = list_crossed(c, a, b, at);
      if (through == NONE) return;
      flip_crossed(c, a, through);
    }
    at = find_edge(c, a, through);
    if (at.t == NONE) break;
    fix(c, at);
    a = through;
  }
  relax(c);
}

SCREE_ORDER_BY2(compare_stops, stop, along, corner)

/* Makes the segment edges from each corner that it passes within the tolerance to the next: a
 * sliver beside it would stand in the way later. */
static void insert_stops(scree_facet_cutter *c, int a, int b) {
  const corner *p = c->corners.items;
  double dx = p[b].at[0] - p[a].at[0], dy = p[b].at[1] - p[a].at[1], length2 = dx * dx + dy * dy;
  double margin = c->job->tolerance * sqrt(length2);
  c->stops.count = 0;
  for (int i = 0; i < (int)c->corners.count; i++) {
    double x = p[i].at[0] - p[a].at[0], y = p[i].at[1] - p[a].at[1];
    double along = x * dx + y * dy, beside = fabs(x * dy - y * dx);
    if (i == a || i == b || p[i].hint == NONE || along <= 0 || along >= length2 || beside >= margin)
      continue;
    if (!SCREE_PUSH(&c->stops, (stop){along, i})) c->failed = true;
  }
  if (c->stops.count > 1)
    qsort(c->stops.items, c->stops.count, sizeof *c->stops.items, compare_stops);
  for (size_t i = 0; i < c->stops.count && !c->failed; i++) {
    insert_segment(c, a, c->stops.items[i].corner);
    a = c->stops.items[i].corner;
  }
  if (!c->failed) insert_segment(c, a, b);
}

/* ---- The facet ---- */

static bool start(scree_facet_cutter *c) {
  const scree_facet_job *job = c->job;
  c->corners.count = c->triangles.count = c->stack.count = 0;
  c->flips = 0;
  for (int k = 0; k < 3; k++) add_corner(c, job->corner[k]);
  if (c->failed) return false;
  add(c, (triangle){.v = {0, 1, 2}, .n = {NONE, NONE, NONE}});
  if (c->failed) return false;
  for (int k = 0; k < 3; k++) {
    int from = k, to = next_of(k);
    for (size_t i = 0; i < job->rim_count[k]; i++) {
      place at = find_edge(c, from, to);
      int p = add_corner(c, job->rim[k][i]);
      if (c->failed || at.t == NONE) return false;
      int u = split_rim(c, at.t, at.edge, p);
      if (c->failed || !positive(c, at.t) || !positive(c, u)) return false;
      from = p;
    }
  }
  return true;
}

SCREE_ORDER_BY2(compare_names, name, id, corner)

static bool list_names(scree_facet_cutter *c) {
  c->names.count = 0;
  for (size_t i = 0; i < c->corners.count; i++)
    if (!SCREE_PUSH(&c->names, (name){c->corners.items[i].id, (int)i})) return false;
  qsort(c->names.items, c->names.count, sizeof *c->names.items, compare_names);
  return true;
}

static int corner_named(const scree_facet_cutter *c, uint32_t id) {
  const name *n = c->names.items;
  SCREE_FIND_FIRST(i, 0, c->names.count, n[i].id < id)
  /* a vertex that was left out has no triangle */
  bool found = i < c->names.count && n[i].id == id;
  return found && c->corners.items[n[i].corner].hint != NONE ? n[i].corner : NONE;
}

static void insert_all(scree_facet_cutter *c) {
  const scree_facet_job *job = c->job;
  for (int t = 0; t < (int)c->triangles.count; t++) push(c, t);
  relax(c);
  for (size_t i = 0; i < job->inner_count && !c->failed; i++) {
    int p = add_corner(c, job->inner[i]);
    if (!c->failed) insert(c, p);
  }
  if (!c->failed && !list_names(c)) c->failed = true;
  for (size_t i = 0; i < job->segment_count && !c->failed; i++) {
    int a = corner_named(c, job->segments[2 * i]), b = corner_named(c, job->segments[2 * i + 1]);
    if (a != NONE && b != NONE && a != b) insert_stops(c, a, b);
  }
}

/* ---- Ear by ear ---- */

static double distance2(const double *positions, uint32_t a, uint32_t b) {
  return vec3_norm2(
      vec3_sub(vec3_load(positions + 3 * (size_t)a), vec3_load(positions + 3 * (size_t)b)));
}

/* The stack holds the rim; its ears are cut, the shortest diagonal first. */
static bool cut_ears(scree_facet_cutter *c, scree_index_list *out) {
  const scree_facet_job *job = c->job;
  c->stack.count = 0;
  for (int k = 0; k < 3; k++) {
    push(c, (int)job->corner[k]);
    for (size_t i = 0; i < job->rim_count[k]; i++) push(c, (int)job->rim[k][i]);
  }
  while (!c->failed && c->stack.count >= 3) {
    size_t n = c->stack.count, best = 0;
    const int *v = c->stack.items;
    double shortest = INFINITY;
    for (size_t i = 0; i < n; i++) {
      double length =
          distance2(job->positions, (uint32_t)v[(i + n - 1) % n], (uint32_t)v[(i + 1) % n]);
      if (length < shortest) shortest = length, best = i;
    }
    const uint32_t ear[3] = {(uint32_t)v[(best + n - 1) % n], (uint32_t)v[best],
                             (uint32_t)v[(best + 1) % n]};
    for (int k = 0; k < 3; k++)
      if (!SCREE_PUSH(out, ear[k])) return false;
    memmove(c->stack.items + best, c->stack.items + best + 1,
            (n - best - 1) * sizeof *c->stack.items);
    c->stack.count--;
  }
  return !c->failed;
}

bool scree_facet_cut(scree_facet_cutter *c, const scree_facet_job *job, scree_index_list *out) {
  const double *p = job->positions;
  c->job = job;
  c->failed = false;
  c->view = scree_view_of_corners(p + 3 * (size_t)job->corner[0], p + 3 * (size_t)job->corner[1],
                                  p + 3 * (size_t)job->corner[2]);
  bool fits = !job->flat && c->view.side != 0 && start(c);
  if (c->failed) return false;
  if (!fits) return cut_ears(c, out);
  insert_all(c);
  for (size_t t = 0; t < c->triangles.count && !c->failed; t++)
    for (int k = 0; k < 3; k++)
      if (!SCREE_PUSH(out, c->corners.items[c->triangles.items[t].v[k]].id)) c->failed = true;
  return !c->failed;
}
