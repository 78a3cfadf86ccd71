/* Edge collapse on half-edges, and its conditions.
 *
 * Topology: the link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999): a and b have exactly the
 * apexes c and d as common neighbours, compared as vertices of the mesh given; an edge between two
 * boundary vertices is itself boundary; at least three triangles stay.
 *
 * Geometry, of the new triangle i with doubled area vector m_i against the old n_i:
 *   flip      m_i.n_i > FLIP |m_i||n_i|
 *   shape     area over longest edge squared not below SLIVER, or not below the worst before
 *   fold      over all edges around, the number with normals more than 150 degrees apart does not
 *             grow: spokes and the edges to the triangles beyond. */
#include "simplify/collapse.h"

/* Cosine of the largest turn of a triangle's normal in one collapse (84 degrees). */
#define FLIP 0.1
/* Smallest 2 area / longest edge^2 of a new triangle, unless one was as bad before. */
#define SLIVER 2e-3

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
  while (s->twin[g] != SCREE_NONE) {
    g = scree_next(s->twin[g]);
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
  uint32_t twin = s->twin[h];
  r->half_edge = h;
  r->a = s->from[h];
  r->b = scree_to(s, h);
  r->c = s->from[scree_previous(h)];
  r->d = twin == SCREE_NONE ? SCREE_NONE : s->from[scree_previous(twin)];
}

bool scree_ring_gather(const scree_halfmesh *s, uint32_t h, scree_ring *r) {
  uint32_t twin = s->twin[h];
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

bool scree_collapse_keeps_topology(const scree_halfmesh *s, const scree_ring *r) {
  if ((s->flags[r->a] | s->flags[r->b]) & SCREE_VERTEX_LOCKED) return false;
  if (r->count < 3 && s->twin[r->half_edge] != SCREE_NONE && !scree_on_boundary(s, r->a) &&
      !scree_on_boundary(s, r->b))
    return false;
  if (r->count == 0) return false;
  uint32_t h = r->half_edge, twin = s->twin[h];
  if (twin != SCREE_NONE && scree_on_boundary(s, r->a) && scree_on_boundary(s, r->b)) return false;
  /* a triangle that hangs on by the edge alone would leave its apex without triangles */
  if (s->twin[scree_next(h)] == SCREE_NONE && s->twin[scree_previous(h)] == SCREE_NONE)
    return false;
  if (twin != SCREE_NONE && s->twin[scree_next(twin)] == SCREE_NONE &&
      s->twin[scree_previous(twin)] == SCREE_NONE)
    return false;
  uint32_t origin_c = s->origin[r->c], origin_d = r->d == SCREE_NONE ? SCREE_NONE : s->origin[r->d];
  if (origin_c == origin_d) return false;
  /* neighbours of a beside b, c, d against those of b */
  for (uint32_t i = 0; i < 2 * r->a_count; i++) {
    uint32_t e = r->edge[i / 2], v = i % 2 ? scree_to(s, e) : s->from[e];
    if (i % 2 == 0 && i > 0 && v == scree_to(s, r->edge[i / 2 - 1])) continue;
    uint32_t origin = s->origin[v];
    bool apex = origin == origin_c || origin == origin_d;
    if (apex && v != r->c && v != r->d) return false;
    if (apex) continue;
    for (uint32_t j = r->a_count; j < r->count; j++)
      if (s->origin[s->from[r->edge[j]]] == origin || s->origin[scree_to(s, r->edge[j])] == origin)
        return false;
  }
  for (uint32_t j = r->a_count; j < r->count; j++) {
    uint32_t v = s->from[r->edge[j]], origin = s->origin[v];
    if ((origin == origin_c || origin == origin_d) && v != r->c && v != r->d) return false;
  }
  return true;
}

static inline double squared_shape(vec3 n, vec3 e1, vec3 e2, vec3 e3) {
  double l2 = fmax(vec3_norm2(e1), fmax(vec3_norm2(e2), vec3_norm2(e3)));
  return l2 > 0 ? vec3_norm2(n) / (l2 * l2) : 0;
}

static vec3 normal_of(const scree_halfmesh *s, uint32_t h) {
  return vec3_triangle_normal(s->position[s->from[h]], s->position[scree_to(s, h)],
                              s->position[s->from[scree_previous(h)]]);
}

/* What the check keeps of each triangle of the ring. */
typedef struct sides {
  vec3 before[SCREE_RING_MAX], after[SCREE_RING_MAX];
} sides;

static bool check_triangles(const scree_halfmesh *s, scree_ring *r, scree_change *change,
                            sides *around) {
  vec3 pa = s->position[r->a], pb = s->position[r->b], x = change->target;
  double worst_before = 1, worst_after = 1, area = 0, volume = 0;
  r->low = vec3_min(vec3_min(pa, pb), x);
  r->high = vec3_max(vec3_max(pa, pb), x);
  for (uint32_t i = 0; i < r->count; i++) {
    vec3 p = i < r->a_count ? pa : pb;
    vec3 p1 = s->position[s->from[r->edge[i]]], p2 = s->position[scree_to(s, r->edge[i])];
    vec3 e = vec3_sub(p2, p1), d1 = vec3_sub(p1, p), d2 = vec3_sub(p2, p);
    vec3 f1 = vec3_sub(p1, x), f2 = vec3_sub(p2, x);
    vec3 n = vec3_cross(d1, d2), m = vec3_cross(f1, f2);
    double dot = vec3_dot(n, m), n2 = vec3_norm2(n), m2 = vec3_norm2(m);
    if (n2 > 0 && (!(dot > 0) || !(dot * dot > FLIP * FLIP * n2 * m2))) return false;
    if (!(m2 > 0)) return false;
    worst_before = fmin(worst_before, squared_shape(n, e, d1, d2));
    worst_after = fmin(worst_after, squared_shape(m, e, f1, f2));
    area += sqrt(m2) - sqrt(n2);
    volume += vec3_dot(n, vec3_sub(x, p));
    r->low = vec3_min(r->low, vec3_min(p1, p2));
    r->high = vec3_max(r->high, vec3_max(p1, p2));
    around->before[i] = n;
    around->after[i] = m;
  }
  vec3 n1 = normal_of(s, r->half_edge), n2 = {0, 0, 0};
  worst_before =
      fmin(worst_before, squared_shape(n1, vec3_sub(pb, pa), vec3_sub(s->position[r->c], pa),
                                       vec3_sub(s->position[r->c], pb)));
  if (r->d != SCREE_NONE) {
    n2 = normal_of(s, s->twin[r->half_edge]);
    worst_before =
        fmin(worst_before, squared_shape(n2, vec3_sub(pb, pa), vec3_sub(s->position[r->d], pa),
                                         vec3_sub(s->position[r->d], pb)));
  }
  change->area = 0.5 * (area - vec3_norm(n1) - vec3_norm(n2));
  change->volume = (volume + vec3_dot(vec3_add(n1, n2), vec3_sub(x, pa))) / 6;
  return worst_after >= SLIVER * SLIVER || worst_after >= worst_before;
}

/* Folds around before and after the collapse. An edge between two triangles of the ring is there
 * before and after; the edges to c and d change partners. */
static bool folds_do_not_grow(const scree_halfmesh *s, const scree_ring *r, const sides *around) {
  int before = 0, after = 0;
  for (uint32_t i = 0; i < r->count; i++) {
    uint32_t j = i + 1 == r->count ? 0 : i + 1, beyond = s->twin[r->edge[i]];
    if (scree_to(s, r->edge[i]) == s->from[r->edge[j]] && i != j)
      after += scree_folded(around->after[i], around->after[j]);
    if (beyond == SCREE_NONE) continue;
    vec3 n = normal_of(s, beyond);
    after += scree_folded(around->after[i], n);
    before += scree_folded(around->before[i], n);
  }
  if (after <= before) return true;
  vec3 n1 = normal_of(s, r->half_edge);
  for (uint32_t i = 0; i < r->count; i++) { /* rare: the spokes as they are now */
    uint32_t spoke = s->twin[scree_previous(r->edge[i])];
    if (spoke == SCREE_NONE) continue;
    before += scree_folded(around->before[i], normal_of(s, spoke));
  }
  if (r->d != SCREE_NONE) {
    vec3 n2 = normal_of(s, s->twin[r->half_edge]);
    before += scree_folded(n1, n2);
  }
  return after <= before;
}

bool scree_collapse_check(const scree_halfmesh *s, scree_ring *ring, scree_change *change) {
  sides around;
  return check_triangles(s, ring, change, &around) && folds_do_not_grow(s, ring, &around);
}

/* Joins the neighbours across the two other sides of the triangle of h, which goes. The apex may
 * need another outgoing half-edge. */
static void close_gap(scree_halfmesh *s, uint32_t h) {
  uint32_t next = scree_next(h), previous = scree_previous(h);
  uint32_t x = s->twin[next], y = s->twin[previous], apex = s->from[previous];
  if (x != SCREE_NONE) s->twin[x] = y;
  if (y != SCREE_NONE) s->twin[y] = x;
  if (s->outgoing[apex] == previous) s->outgoing[apex] = x != SCREE_NONE ? x : scree_next(y);
  for (uint32_t i = 0; i < 3; i++) s->from[h - h % 3 + i] = SCREE_NONE;
}

void scree_collapse_apply(scree_halfmesh *s, const scree_ring *r, vec3 target) {
  uint32_t twin = s->twin[r->half_edge];
  for (uint32_t i = r->a_count; i < r->count; i++) s->from[scree_previous(r->edge[i])] = r->a;
  close_gap(s, r->half_edge);
  if (twin != SCREE_NONE) close_gap(s, twin);
  s->position[r->a] = target;
  s->outgoing[r->a] = scree_previous(r->edge[0]);
  for (uint32_t i = 0; i < r->count; i++)
    if (s->twin[scree_previous(r->edge[i])] == SCREE_NONE)
      s->outgoing[r->a] = scree_previous(r->edge[i]);
  s->outgoing[r->b] = SCREE_NONE;
}
