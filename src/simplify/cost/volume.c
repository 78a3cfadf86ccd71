/* Method `volume`: after Lindstrom and Turk, "Fast and memory efficient
 * polygonal simplification" (IEEE Visualization 1998) and "Evaluation of
 * memoryless simplification" (TVCG 5(2), 1999).
 *
 * A collapse of the edge (a, b) to x sweeps, for every triangle t of both fans,
 * the tetrahedron of t and x, of signed volume n_t.(x - p_t)/6, n_t the doubled
 * area vector and p_t any corner. The volume inside is kept exactly if
 *
 *     sum_t n_t.(x - p_t) = 0 (one plane)
 *
 * and on that plane x minimises the sum of the squared tetrahedra, sum_t
 * (n_t.(x - p_t))^2. All planes of a's fan pass through a, so with H = sum n
 * n^T and N = sum n per fan, and e = b - a, y = x - a:
 *
 *     E(y) = y.H_a y + (y - e).H_b (y - e) - [the two triangles that count
 * twice], (N_a + N_b - n_1 - n_2).y = N_b.e.
 *
 * H and N per vertex make an evaluation independent of the valence, and lose no
 * digits far from the origin. On a boundary the squared area swept along its
 * edges joins E as in their paper.
 *
 * Differs from theirs: flat fans leave E singular; instead of their ladder of
 * further constraints the vertex moves from the middle of the edge along the
 * two axes of H on the plane only where these are stiff (scree_tune.stiff). */
#include "base/lanes.h"
#include "simplify/cost/cost.h"
#include "simplify/tuning.h"

#include <string.h>

/* A vertex may not go farther from the middle of its edge than this many edge
 * lengths: the plane of equal volume is ill-defined where the normals cancel.
 */
#define REACH 4.0

enum { HXX, HXY, HXZ, HYY, HYZ, HZZ, NX, NY, NZ, AREA };

SCREE_LANES_INLINE void add_outer(double *h, vec3 n, double w) {
  h[HXX] += w * n.x * n.x;
  h[HXY] += w * n.x * n.y;
  h[HXZ] += w * n.x * n.z;
  h[HYY] += w * n.y * n.y;
  h[HYZ] += w * n.y * n.z;
  h[HZZ] += w * n.z * n.z;
}

/* (|e|^2 I - e e^T) |e|^2 w: the squared area swept along a boundary edge e,
 * times |e|^2. */
static inline void add_boundary(double *h, vec3 e, double w) {
  double l2 = vec3_norm2(e), d = w * l2 * l2;
  h[HXX] += d;
  h[HYY] += d;
  h[HZZ] += d;
  add_outer(h, e, -w * l2);
}

SCREE_LANES_INLINE vec3 multiply(const double *h, vec3 v) {
  return (vec3){h[HXX] * v.x + h[HXY] * v.y + h[HXZ] * v.z,
                h[HXY] * v.x + h[HYY] * v.y + h[HYZ] * v.z,
                h[HXZ] * v.x + h[HYZ] * v.y + h[HZZ] * v.z};
}

static void volume_sum(scree_halfmesh *s, uint32_t v) {
  double h[10] = {0};
  vec3 p = s->vertex[v].at;
  uint32_t first = s->vertex[v].outgoing, g = first;
  vec3 e1 = vec3_sub(s->vertex[scree_to(s, g)].at, p);
  if (s->half[g].twin == SCREE_NONE) add_boundary(h, e1, 1);
  do {
    vec3 e2 = vec3_sub(s->vertex[s->half[scree_previous(g)].from].at, p);
    vec3 n = vec3_cross(e1, e2);
    add_outer(h, n, 1);
    h[NX] += n.x;
    h[NY] += n.y;
    h[NZ] += n.z;
    h[AREA] += vec3_norm(n);
    e1 = e2;
    g = scree_turn(s, g);
  } while (g != SCREE_NONE && g != first);
  if (g == SCREE_NONE) add_boundary(h, e1, 1);
  memcpy(s->sums[v], h, sizeof h);
}

/* Edges are evaluated side by side, one per lane: with y from the middle of the edge, E(y) = y.H y
 * + 2 g.y + k and the plane n.y = d. What one lane needs is gathered first. */
enum { LANES = 32 };

typedef struct lanes {
  double ha[6][LANES], hb[6][LANES]; /* of the ends; on a boundary less what counts twice */
  double na[3][LANES], nb[3][LANES];
  double area[LANES];              /* doubled, of both fans */
  double e[3][LANES];              /* half of the edge */
  double c[3][LANES], d[3][LANES]; /* from the middle to the apexes; on a boundary d is e */
  double along[LANES];             /* where the vertex is asked for: e times this */
  double y[3][LANES], cost[LANES], error[LANES], around[LANES], excess[LANES], trace[LANES];
} lanes;

SCREE_LANES_INLINE vec3 lane(double v[3][LANES], int i) {
  return (vec3){v[0][i], v[1][i], v[2][i]};
}

SCREE_LANES_INLINE void set_lane(double v[3][LANES], int i, vec3 p) {
  v[0][i] = p.x;
  v[1][i] = p.y;
  v[2][i] = p.z;
}

static void gather(const scree_halfmesh *s, uint32_t half_edge, lanes *q, int i) {
  uint32_t a = s->half[half_edge].from, b = scree_to(s, half_edge), twin = s->half[half_edge].twin;
  const double *of_a = s->sums[a], *hb = s->sums[b];
  vec3 p = s->vertex[a].at, e = vec3_scale(vec3_sub(s->vertex[b].at, p), 0.5), to_d = e;
  vec3 middle = vec3_add(p, e);
  double ha[6];
  memcpy(ha, of_a, sizeof ha);
  if (twin != SCREE_NONE)
    to_d = vec3_sub(s->vertex[s->half[scree_previous(twin)].from].at, middle);
  else
    add_boundary(ha, vec3_scale(e, 2), -1);
  for (int k = 0; k < 6; k++) q->ha[k][i] = ha[k];
  for (int k = 0; k < 6; k++) q->hb[k][i] = hb[k];
  for (int k = 0; k < 3; k++) q->na[k][i] = of_a[NX + k];
  for (int k = 0; k < 3; k++) q->nb[k][i] = hb[NX + k];
  q->area[i] = of_a[AREA] + hb[AREA];
  set_lane(q->e, i, e);
  set_lane(q->c, i, vec3_sub(s->vertex[s->half[scree_previous(half_edge)].from].at, middle));
  set_lane(q->d, i, to_d);
}

SCREE_LANES_INLINE vec3 drop_on_plane(vec3 y, vec3 n, double d) {
  return vec3_mad(y, n, d - vec3_dot(n, y));
}

/* Where E is least along axis u from y; y where that is not stiff. */
SCREE_LANES_INLINE vec3 slide(const double *h, vec3 g, vec3 u, double least, vec3 y) {
  double stiff = vec3_dot(u, multiply(h, u));
  double step = -vec3_dot(u, vec3_add(multiply(h, y), g)) / stiff;
  return vec3_mad(y, u, stiff > least ? step : 0);
}

/* Minimises y.H y + 2 g.y over the plane n.y = d, n a unit vector, from the point nearest to the
 * middle, along the axes of H on the plane; the second time for rounding. */
SCREE_LANES_INLINE vec3 minimise_on_plane(const double *h, vec3 g, vec3 n, double d, double least) {
  vec3 u, w, y = vec3_scale(n, d);
  vec3_frame(n, &u, &w);
  vec3 hu = multiply(h, u), hw = multiply(h, w);
  double half = 0.5 * (vec3_dot(u, hu) - vec3_dot(w, hw)), uw = vec3_dot(u, hw);
  double r = sqrt(half * half + uw * uw), cosine2 = r > 0 ? half / r : 1; /* of twice the angle */
  double cosine = sqrt(0.5 * (1 + cosine2)), sine = copysign(sqrt(0.5 * (1 - cosine2)), uw);
  vec3 first = vec3_mad(vec3_scale(u, cosine), w, sine);
  vec3 second = vec3_mad(vec3_scale(w, cosine), u, -sine);
  for (int k = 0; k < 2; k++) {
    y = slide(h, g, first, least, y);
    y = slide(h, g, second, least, y);
  }
  return drop_on_plane(y, n, d);
}

/* Solves and judges every lane. best: at the minimum; else on the plane, as near as may be to the
 * point `along` the edge. */
SCREE_LANES_INLINE void solve_lanes(lanes *q, bool best, int count) {
  for (int i = 0; i < count; i++) {
    vec3 e = lane(q->e, i), c = lane(q->c, i), o = lane(q->d, i);
    vec3 n1 = vec3_scale(vec3_cross(e, c), 2), n2 = vec3_scale(vec3_cross(o, e), 2);
    double h[6], ha[6], hb[6];
    for (int k = 0; k < 6; k++) {
      ha[k] = q->ha[k][i];
      hb[k] = q->hb[k][i];
      h[k] = ha[k] + hb[k];
    }
    vec3 ga = multiply(ha, e), gb = multiply(hb, e), g = vec3_sub(ga, gb);
    add_outer(h, n1, -1);
    add_outer(h, n2, -1);
    vec3 na = lane(q->na, i), nb = lane(q->nb, i);
    vec3 n = vec3_sub(vec3_sub(vec3_add(na, nb), n1), n2);
    double norm = vec3_norm(n), trace = h[HXX] + h[HYY] + h[HZZ];
    double around = q->area[i] - vec3_norm(n1) - vec3_norm(n2);
    double d = vec3_dot(vec3_sub(nb, na), e) / norm;
    n = vec3_scale(n, 1 / norm);
    vec3 y = best ? minimise_on_plane(h, g, n, d, scree_tune.stiff * trace)
                  : drop_on_plane(drop_on_plane(vec3_scale(e, q->along[i]), n, d), n, d);
    double energy =
        vec3_dot(y, multiply(h, y)) + 2 * vec3_dot(g, y) + vec3_dot(e, vec3_add(ga, gb));
    energy = energy > 0 ? energy : 0;
    q->excess[i] = vec3_norm2(y) - 4 * REACH * REACH * vec3_norm2(e);
    q->trace[i] = trace;
    q->around[i] = around;
    q->error[i] = energy / trace;
    q->cost[i] = energy + scree_tune.tie * trace * 4 * vec3_norm2(e);
    set_lane(q->y, i, y);
  }
}

SCREE_LANES static void solve_best_volume(lanes *q, int count) {
  solve_lanes(q, true, count);
}

static void solve_along(lanes *q) {
  solve_lanes(q, false, 1);
}

/* Apart from solve_lanes, which has no branches for the compiler's sake. */
static scree_candidate answer(const scree_halfmesh *s, uint32_t half_edge, lanes *q, int i) {
  /* false also where the normals cancel and nothing is a number */
  if (!(q->excess[i] <= 0 && q->trace[i] > 0 && q->around[i] > 0))
    return (scree_candidate){.cost = INFINITY};
  vec3 middle = vec3_add(s->vertex[s->half[half_edge].from].at, lane(q->e, i));
  return (scree_candidate){.cost = q->cost[i],
                           .target = vec3_add(middle, lane(q->y, i)),
                           .error = q->error[i],
                           .area = q->around[i]};
}

static void volume_evaluate(const scree_halfmesh *s, const uint32_t *half_edges, size_t count,
                            scree_candidate *out) {
  lanes q;
  for (size_t begin = 0; begin < count; begin += LANES) {
    int filled = count - begin < LANES ? (int)(count - begin) : LANES;
    int width = (filled + 3) & ~3; /* whole vectors */
    for (int i = 0; i < width; i++)
      gather(s, half_edges[begin + (size_t)(i < filled ? i : 0)], &q, i);
    solve_best_volume(&q, width);
    for (int i = 0; i < filled; i++)
      out[begin + (size_t)i] = answer(s, half_edges[begin + (size_t)i], &q, i);
  }
}

static void volume_fall_back(const scree_halfmesh *s, uint32_t half_edge, int fallback,
                             scree_candidate *out) {
  static const double along[SCREE_FALLBACK_COUNT] = {0, -1, 1};
  lanes q;
  gather(s, half_edge, &q, 0);
  q.along[0] = along[fallback];
  solve_along(&q);
  *out = answer(s, half_edge, &q, 0);
}

const scree_coster scree_volume_coster = {volume_sum, volume_evaluate, volume_fall_back, NULL};
