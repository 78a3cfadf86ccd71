/* Edge collapse on half-edges, and its conditions.
 *
 * Topology: the link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999): a and b have exactly the
 * apexes c and d as common neighbours, compared as vertices of the mesh given; an edge between two
 * boundary vertices is itself boundary; at least three triangles stay.
 *
 * Geometry, of the new triangle i with doubled area vector m_i against the old n_i:
 *   flip      m_i.n_i > least_turn |m_i||n_i|
 *   shape     area over longest edge squared not below SLIVER, or not below the worst before; of
 *             those below FLAT no more than before
 *   fold      over all edges around, the number with normals more than 150 degrees apart does not
 *             grow: spokes and the edges to the triangles beyond. */
#include "simplify/collapse.h"

#include "base/lanes.h"

/* Smallest 2 area / longest edge^2 of a new triangle, unless one was as bad before. */
#define SLIVER 2e-3
/* Below it a triangle has no area but that of rounding. */
#define FLAT 1e-10

static bool push(scree_ring *r, uint32_t h) {
  if (r->count == SCREE_RING_MAX) return false;
  r->edge[r->count++] = h;
  return true;
}

/* Triangles counter-clockwise after outgoing half-edge g up to the one with `stop`; *open: met a
 * boundary. */
static bool push_turning_left(const scree_halfmesh *s, scree_ring *r, uint32_t g, uint32_t stop,
                              bool *open) {
  for (;;) {
    g = scree_turn(s, g);
    *open = g == SCREE_NONE;
    if (*open || g == stop) return true;
    if (!push(r, scree_next(g))) return false;
  }
}

/* Triangles clockwise before g up to a boundary, listed counter-clockwise. */
static bool push_turning_right(const scree_halfmesh *s, scree_ring *r, uint32_t g) {
  uint32_t begin = r->count;
  while (s->half[g].twin != SCREE_NONE) {
    g = scree_next(s->half[g].twin);
    if (!push(r, scree_next(g))) return false;
  }
  for (uint32_t i = begin, j = r->count; i + 1 < j; i++) {
    uint32_t swapped = r->edge[i];
    r->edge[i] = r->edge[--j];
    r->edge[j] = swapped;
  }
  return true;
}

void scree_ring_name(const scree_halfmesh *s, uint32_t h, scree_ring *r) {
  uint32_t twin = s->half[h].twin;
  r->half_edge = h;
  r->a = s->half[h].from;
  r->b = scree_to(s, h);
  r->c = s->half[scree_previous(h)].from;
  r->d = twin == SCREE_NONE ? SCREE_NONE : s->half[scree_previous(twin)].from;
}

void scree_ring_corners_at(const scree_halfmesh *s, const scree_ring *r, uint32_t i, vec3 x,
                           double *corners) {
  vec3_store(corners, x);
  vec3_store(corners + 3, s->vertex[s->half[r->edge[i]].from].at);
  vec3_store(corners + 6, s->vertex[scree_to(s, r->edge[i])].at);
}

void scree_ring_corners(const scree_halfmesh *s, const scree_ring *r, vec3 target,
                        double (*corners)[9]) {
  for (uint32_t i = 0; i < r->count; i++) scree_ring_corners_at(s, r, i, target, corners[i]);
}

bool scree_ring_gather(const scree_halfmesh *s, uint32_t h, scree_ring *r) {
  uint32_t twin = s->half[h].twin;
  bool open;
  scree_ring_name(s, h, r);
  r->count = 0;
  uint32_t at_d = twin == SCREE_NONE ? SCREE_NONE : scree_next(twin); /* a -> d */
  if (!push_turning_left(s, r, h, at_d, &open)) return false;
  if (open && twin != SCREE_NONE && !push_turning_right(s, r, at_d)) return false;
  r->a_count = r->count;
  open = true;
  if (twin != SCREE_NONE && !push_turning_left(s, r, twin, scree_next(h), &open)) return false;
  return !open || push_turning_right(s, r, scree_next(h));
}

bool scree_ring_gather_fan(const scree_halfmesh *s, uint32_t v, scree_ring *r) {
  uint32_t h = s->vertex[v].outgoing;
  bool open;
  *r = (scree_ring){
      .half_edge = h, .a = v, .b = v, .c = SCREE_NONE, .d = SCREE_NONE, .edge = r->edge};
  bool room = push(r, scree_next(h)) && push_turning_left(s, r, h, h, &open);
  r->a_count = r->count;
  return room && !open;
}

/* The corners of these edges of the ring beside c and d, as vertices of the mesh given. */
static uint32_t list_neighbours(const scree_halfmesh *s, const scree_ring *r, uint32_t begin,
                                uint32_t end, uint32_t *origins) {
  uint32_t count = 0, last = SCREE_NONE;
  for (uint32_t i = 2 * begin; i < 2 * end; i++) {
    uint32_t e = r->edge[i / 2], v = i % 2 ? scree_to(s, e) : s->half[e].from;
    if (v != last && v != r->c && v != r->d) origins[count++] = s->vertex[v].origin;
    last = v;
  }
  return count;
}

bool scree_collapse_keeps_topology(const scree_halfmesh *s, const scree_ring *r) {
  if ((s->flags[r->a] | s->flags[r->b]) & SCREE_VERTEX_LOCKED) return false;
  if (r->count < 3 && s->half[r->half_edge].twin != SCREE_NONE && !scree_on_boundary(s, r->a) &&
      !scree_on_boundary(s, r->b))
    return false;
  if (r->count == 0) return false;
  uint32_t h = r->half_edge, twin = s->half[h].twin;
  if (twin != SCREE_NONE && scree_on_boundary(s, r->a) && scree_on_boundary(s, r->b)) return false;
  /* a triangle that hangs on by the edge alone would leave its apex without triangles */
  if (s->half[scree_next(h)].twin == SCREE_NONE && s->half[scree_previous(h)].twin == SCREE_NONE)
    return false;
  if (twin != SCREE_NONE && s->half[scree_next(twin)].twin == SCREE_NONE &&
      s->half[scree_previous(twin)].twin == SCREE_NONE)
    return false;
  uint32_t origin_c = s->vertex[r->c].origin,
           origin_d = r->d == SCREE_NONE ? SCREE_NONE : s->vertex[r->d].origin;
  if (origin_c == origin_d) return false;
  uint32_t of_a[SCREE_RING_MAX + 1], of_b[SCREE_RING_MAX + 1];
  uint32_t a_count = list_neighbours(s, r, 0, r->a_count, of_a);
  uint32_t b_count = list_neighbours(s, r, r->a_count, r->count, of_b);
  for (uint32_t i = 0; i < a_count; i++) {
    if (of_a[i] == origin_c || of_a[i] == origin_d) return false;
    for (uint32_t j = 0; j < b_count; j++)
      if (of_a[i] == of_b[j]) return false;
  }
  for (uint32_t j = 0; j < b_count; j++)
    if (of_b[j] == origin_c || of_b[j] == origin_d) return false;
  return true;
}

static vec3 normal_of(const scree_halfmesh *s, uint32_t h) {
  return vec3_triangle_normal(s->vertex[s->half[h].from].at, s->vertex[scree_to(s, h)].at,
                              s->vertex[s->half[scree_previous(h)].from].at);
}

/* The square of 2 area / longest edge^2, of a triangle with doubled area vector n. */
static double squared_shape(vec3 n, vec3 e1, vec3 e2, vec3 e3) {
  double l1 = vec3_norm2(e1), l2 = vec3_norm2(e2), l3 = vec3_norm2(e3);
  double l = l1 > l2 ? l1 : l2;
  l = l3 > l ? l3 : l;
  return l > 0 ? vec3_norm2(n) / (l * l) : 0;
}

static double shape_of(vec3 a, vec3 b, vec3 c) {
  return squared_shape(vec3_triangle_normal(a, b, c), vec3_sub(b, a), vec3_sub(c, b),
                       vec3_sub(a, c));
}

/* The ring's triangles side by side, one per lane. */
enum { LANES = 16 };

typedef struct lanes {
  double p[3][LANES];                             /* the end they have now */
  double p1[3][LANES], p2[3][LANES], q[3][LANES]; /* the edge across; the corner beyond it */
  double n[3][LANES], m[3][LANES];                /* doubled area vectors before and after */
  double n2[LANES], m2[LANES], turn[LANES];       /* their squares and product */
  double shape_before[LANES], shape_after[LANES]; /* squared_shape */
  double area[LANES], volume[LANES];              /* doubled, times six: change of them */
  double b2[LANES], n_b[LANES], m_b[LANES];       /* with the triangle beyond: square, products */
} lanes;

static inline vec3 lane(double v[3][LANES], int i) {
  return (vec3){v[0][i], v[1][i], v[2][i]};
}

static inline void set_lane(double v[3][LANES], int i, vec3 p) {
  v[0][i] = p.x;
  v[1][i] = p.y;
  v[2][i] = p.z;
}

static void gather(const scree_halfmesh *s, const scree_ring *r, uint32_t index, lanes *l, int i) {
  uint32_t h = r->edge[index], beyond = s->half[h].twin;
  vec3 p1 = s->vertex[s->half[h].from].at;
  set_lane(l->p, i, s->vertex[index < r->a_count ? r->a : r->b].at);
  set_lane(l->p1, i, p1);
  set_lane(l->p2, i, s->vertex[scree_to(s, h)].at);
  set_lane(l->q, i, beyond == SCREE_NONE ? p1 : s->vertex[s->half[scree_previous(beyond)].from].at);
}

SCREE_LANES static void compare_lanes(lanes *l, vec3 x, int count) {
  for (int i = 0; i < count; i++) {
    vec3 p = lane(l->p, i), p1 = lane(l->p1, i), p2 = lane(l->p2, i);
    vec3 e = vec3_sub(p2, p1), d1 = vec3_sub(p1, p), d2 = vec3_sub(p2, p);
    vec3 f1 = vec3_sub(p1, x), f2 = vec3_sub(p2, x);
    vec3 n = vec3_cross(d1, d2), m = vec3_cross(f1, f2);
    vec3 b = vec3_triangle_normal(p2, p1, lane(l->q, i));
    double n2 = vec3_norm2(n), m2 = vec3_norm2(m), e2 = vec3_norm2(e);
    double d12 = vec3_norm2(d1), d22 = vec3_norm2(d2), f12 = vec3_norm2(f1), f22 = vec3_norm2(f2);
    double before = e2 > d12 ? e2 : d12, after = e2 > f12 ? e2 : f12;
    before = before > d22 ? before : d22;
    after = after > f22 ? after : f22;
    l->shape_before[i] = n2 / (before * before);
    l->shape_after[i] = m2 / (after * after);
    l->area[i] = sqrt(m2) - sqrt(n2);
    l->volume[i] = vec3_dot(n, vec3_sub(x, p));
    l->turn[i] = vec3_dot(n, m);
    l->n2[i] = n2;
    l->m2[i] = m2;
    l->b2[i] = vec3_norm2(b);
    l->n_b[i] = vec3_dot(n, b);
    l->m_b[i] = vec3_dot(m, b);
    set_lane(l->n, i, n);
    set_lane(l->m, i, m);
  }
}

static inline bool folded(double dot, double n2, double m2) {
  return dot < 0 && dot * dot > SCREE_FOLD * SCREE_FOLD * n2 * m2;
}

/* What is summed up over the ring. */
typedef struct tally {
  double area, volume, shape_before, shape_after;
  int folds_before, folds_after; /* over the edges across */
} tally;

/* Where nothing can be said (no area, no longest edge) the shape is the worst. */
static inline double worse_shape(double worst, double shape) {
  return shape >= worst ? worst : shape > 0 ? shape : 0;
}

static bool take_lane(const lanes *l, int i, double least_turn, tally *sum, bool *steep) {
  /* compare_lanes has set it: NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign) */
  double n2 = l->n2[i], m2 = l->m2[i], turn = l->turn[i], m_b = l->m_b[i];
  /* squares with their signs have the order of what is squared */
  double least = least_turn * fabs(least_turn) * n2 * m2;
  if (n2 > 0 && !(turn * fabs(turn) > least)) return false;
  if (!(m2 > 0)) return false;
  sum->shape_before = worse_shape(sum->shape_before, l->shape_before[i]);
  sum->shape_after = worse_shape(sum->shape_after, l->shape_after[i]);
  sum->area += l->area[i];
  sum->volume += l->volume[i];
  sum->folds_before += folded(l->n_b[i], n2, l->b2[i]);
  sum->folds_after += folded(m_b, m2, l->b2[i]);
  *steep |= !(m_b > 0 && m_b * m_b > 0.25 * m2 * l->b2[i]);
  return true;
}

static bool check_triangles(const scree_halfmesh *s, scree_ring *r, vec3 x, double least_turn,
                            tally *sum, scree_around *around) {
  lanes l;
  r->low = vec3_min(vec3_min(s->vertex[r->a].at, s->vertex[r->b].at), x);
  r->high = vec3_max(vec3_max(s->vertex[r->a].at, s->vertex[r->b].at), x);
  for (uint32_t begin = 0; begin < r->count; begin += LANES) {
    uint32_t filled = r->count - begin < LANES ? r->count - begin : LANES;
    uint32_t width = (filled + 3) & ~UINT32_C(3); /* whole vectors */
    for (uint32_t i = 0; i < width; i++) gather(s, r, begin + (i < filled ? i : 0), &l, (int)i);
    compare_lanes(&l, x, (int)width);
    for (int i = 0; i < (int)filled; i++) {
      if (!take_lane(&l, i, least_turn, sum, &around->steep)) return false;
      vec3 p1 = lane(l.p1, i), p2 = lane(l.p2, i);
      r->low = vec3_min(r->low, vec3_min(p1, p2));
      r->high = vec3_max(r->high, vec3_max(p1, p2));
      around->before[begin + (uint32_t)i] = lane(l.n, i);
      around->after[begin + (uint32_t)i] = lane(l.m, i);
    }
  }
  return true;
}

/* The triangles that go: the edge's own. */
static void take_gone(const scree_halfmesh *s, const scree_ring *r, vec3 x, tally *sum) {
  vec3 pa = s->vertex[r->a].at, pb = s->vertex[r->b].at, e = vec3_sub(pb, pa);
  uint32_t apex[2] = {r->c, r->d};
  for (int k = 0; k < 2 && apex[k] != SCREE_NONE; k++) {
    vec3 p = s->vertex[apex[k]].at;
    vec3 n = normal_of(s, k == 0 ? r->half_edge : s->half[r->half_edge].twin);
    sum->shape_before =
        worse_shape(sum->shape_before, squared_shape(n, e, vec3_sub(p, pa), vec3_sub(p, pb)));
    sum->area -= vec3_norm(n);
    sum->volume += vec3_dot(n, vec3_sub(x, pa));
  }
}

/* Folds around before and after the collapse. An edge between two triangles of the ring is there
 * before and after; the edges to c and d change partners. */
static bool folds_do_not_grow(const scree_halfmesh *s, const scree_ring *r,
                              const scree_around *around, const tally *sum) {
  int before = sum->folds_before, after = sum->folds_after;
  for (uint32_t i = 0; i < r->count; i++) {
    uint32_t j = i + 1 == r->count ? 0 : i + 1;
    if (scree_to(s, r->edge[i]) == s->half[r->edge[j]].from && i != j)
      after += scree_folded(around->after[i], around->after[j]);
  }
  if (after <= before) return true;
  for (uint32_t i = 0; i < r->count; i++) { /* rare: the spokes as they are now */
    uint32_t spoke = s->half[scree_previous(r->edge[i])].twin;
    if (spoke == SCREE_NONE) continue;
    before += scree_folded(around->before[i], normal_of(s, spoke));
  }
  if (r->d != SCREE_NONE)
    before += scree_folded(normal_of(s, r->half_edge), normal_of(s, s->half[r->half_edge].twin));
  return after <= before;
}

/* Triangles without area, of the ring and the edge, before and after. */
static bool flats_do_not_grow(const scree_halfmesh *s, const scree_ring *r, vec3 x) {
  vec3 pa = s->vertex[r->a].at, pb = s->vertex[r->b].at;
  uint32_t apex[2] = {r->c, r->d};
  int before = 0, after = 0;
  for (uint32_t i = 0; i < r->count; i++) {
    vec3 p = i < r->a_count ? pa : pb, p1 = s->vertex[s->half[r->edge[i]].from].at,
         p2 = s->vertex[scree_to(s, r->edge[i])].at;
    before += shape_of(p, p1, p2) < FLAT * FLAT;
    after += shape_of(x, p1, p2) < FLAT * FLAT;
  }
  for (int k = 0; k < 2 && apex[k] != SCREE_NONE; k++)
    before += shape_of(pa, pb, s->vertex[apex[k]].at) < FLAT * FLAT;
  return after <= before;
}

/* All but the folds. */
static bool check_ring(const scree_halfmesh *s, scree_ring *ring, vec3 x, double least_turn,
                       tally *sum, scree_around *around) {
  *sum = (tally){.shape_before = 1, .shape_after = 1};
  around->steep = false;
  if (!check_triangles(s, ring, x, least_turn, sum, around)) return false;
  take_gone(s, ring, x, sum);
  if (!(sum->shape_after >= SLIVER * SLIVER || sum->shape_after >= sum->shape_before)) return false;
  return !(sum->shape_after < FLAT * FLAT) || flats_do_not_grow(s, ring, x);
}

bool scree_collapse_check(const scree_halfmesh *s, scree_ring *ring, double least_turn,
                          scree_change *change, scree_around *around) {
  tally sum;
  if (!check_ring(s, ring, change->target, least_turn, &sum, around)) return false;
  change->area = 0.5 * sum.area;
  change->volume = sum.volume / 6;
  return folds_do_not_grow(s, ring, around, &sum);
}

bool scree_collapse_suits_ring(const scree_halfmesh *s, scree_ring *ring, double least_turn,
                               vec3 target) {
  tally sum;
  scree_around around;
  return check_ring(s, ring, target, least_turn, &sum, &around);
}

/* Joins the neighbours across the two other sides of the triangle of h, which goes. The apex may
 * need another outgoing half-edge. */
static void close_gap(scree_halfmesh *s, uint32_t h) {
  uint32_t next = scree_next(h), previous = scree_previous(h);
  uint32_t x = s->half[next].twin, y = s->half[previous].twin, apex = s->half[previous].from;
  if (x != SCREE_NONE) s->half[x].twin = y;
  if (y != SCREE_NONE) s->half[y].twin = x;
  if (s->vertex[apex].outgoing == previous)
    s->vertex[apex].outgoing = x != SCREE_NONE ? x : scree_next(y);
  for (uint32_t i = 0; i < 3; i++) s->half[h - h % 3 + i].from = SCREE_NONE;
}

void scree_collapse_apply(scree_halfmesh *s, const scree_ring *r, vec3 target) {
  uint32_t twin = s->half[r->half_edge].twin;
  for (uint32_t i = r->a_count; i < r->count; i++) s->half[scree_previous(r->edge[i])].from = r->a;
  close_gap(s, r->half_edge);
  if (twin != SCREE_NONE) close_gap(s, twin);
  s->vertex[r->a].at = target;
  s->vertex[r->a].outgoing = scree_previous(r->edge[0]);
  for (uint32_t i = 0; i < r->count; i++)
    if (s->half[scree_previous(r->edge[i])].twin == SCREE_NONE)
      s->vertex[r->a].outgoing = scree_previous(r->edge[i]);
  s->vertex[r->b].outgoing = SCREE_NONE;
  s->flags[r->a] |= s->flags[r->b] & SCREE_VERTEX_ANCHOR;
}
