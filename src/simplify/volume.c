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
 * The cost is (E + STRAY A D^4) / sqrt(A), A the doubled area around and D the
 * stray (stray.h): E is a sum over the area and says little of one place far off.
 *
 * Differs from theirs: flat fans leave E singular; instead of their ladder of
 * further constraints a small pull towards the middle of the edge decides there
 * (PULL). */
#include "base/lanes.h"
#include "simplify/cost.h"

#include <string.h>

/* Weight of the squared distance to the middle of the edge against the trace of
 * H, and proximal steps: places the vertex where the surface leaves it free
 * (flat, or along a crease). */
#define PULL 1e-6
enum { STEPS = 3 };
/* The same in the cost: orders collapses of equal cost, short edges first. Far
 * below the cost of anything that changes shape. */
#define TIE 1e-9
/* Weight of the stray. With D near the mean distance d, E is about A^2 d^2 over the number of
 * triangles, so that the stray counts from about a tenth of sqrt(A) on, and soon decides. */
#define STRAY 5.0
/* A vertex may not go farther from the middle of its edge than this many edge
 * lengths: the plane of equal volume is ill-defined where the normals cancel.
 */
#define REACH 4.0

enum { HXX, HXY, HXZ, HYY, HYZ, HZZ, NX, NY, NZ, AREA };

static inline void add_outer(double *h, vec3 n, double w) {
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

static inline vec3 multiply(const double *h, vec3 v) {
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
  memcpy(scree_sums_of(s, v), h, sizeof h);
}

/* Edges are evaluated side by side, one per lane: E(y) = y.H y - 2 g.y + k and the plane n.y = d,
 * y from the edge's first end. What one lane needs is gathered first. */
enum { LANES = 32 };

typedef struct lanes {
  double h[6][LANES], hb[6][LANES]; /* both ends' H, and that of the second */
  double n[3][LANES], nb[3][LANES]; /* N the same */
  double area[LANES];               /* doubled, of both fans */
  double e[3][LANES];               /* to the second end */
  double c[3][LANES], d[3][LANES];  /* to the apexes; on a boundary d is 0 */
  double along[LANES];              /* where the vertex is asked for; see solve */
  double y[3][LANES], cost[LANES], error[LANES], stray[LANES];
  double excess[LANES], trace[LANES], around[LANES];
} lanes;

static inline vec3 lane(double v[3][LANES], int i) {
  return (vec3){v[0][i], v[1][i], v[2][i]};
}

static inline void set_lane(double v[3][LANES], int i, vec3 p) {
  v[0][i] = p.x;
  v[1][i] = p.y;
  v[2][i] = p.z;
}

static void gather(const scree_halfmesh *s, uint32_t half_edge, lanes *q, int i) {
  uint32_t a = s->half[half_edge].from, b = scree_to(s, half_edge), twin = s->half[half_edge].twin;
  const double *ha = scree_sums_of(s, a), *hb = scree_sums_of(s, b);
  vec3 p = s->vertex[a].at, e = vec3_sub(s->vertex[b].at, p), to_d = {0, 0, 0};
  double h[6];
  for (int k = 0; k < 6; k++) h[k] = ha[k] + hb[k];
  if (twin != SCREE_NONE)
    to_d = vec3_sub(s->vertex[s->half[scree_previous(twin)].from].at, p);
  else
    add_boundary(h, e, -1);
  for (int k = 0; k < 6; k++) q->h[k][i] = h[k];
  for (int k = 0; k < 6; k++) q->hb[k][i] = hb[k];
  for (int k = 0; k < 3; k++) q->n[k][i] = ha[NX + k] + hb[NX + k];
  for (int k = 0; k < 3; k++) q->nb[k][i] = hb[NX + k];
  q->area[i] = ha[AREA] + hb[AREA];
  set_lane(q->e, i, e);
  set_lane(q->c, i, vec3_sub(s->vertex[s->half[scree_previous(half_edge)].from].at, p));
  set_lane(q->d, i, to_d);
}

/* Minimises y.H y - 2 g.y over the plane n.y = d, n a unit vector, from the
 * point nearest to `middle`: y moves by proximal steps, each minimising that
 * plus pull |y - y_before|^2. Where the surface decides, the step's error
 * shrinks by pull over the curvature every time, to nothing; where it does not,
 * y stays. */
static inline vec3 minimise_on_plane(const double *h, vec3 g, vec3 n, double d, vec3 middle,
                                     double pull) {
  vec3 u, w, y = vec3_mad(middle, n, d - vec3_dot(n, middle));
  vec3_frame(n, &u, &w);
  vec3 hu = multiply(h, u), hw = multiply(h, w), r = vec3_sub(g, multiply(h, y));
  double uu = vec3_dot(u, hu), uw = vec3_dot(u, hw), ww = vec3_dot(w, hw);
  double ru = vec3_dot(u, r), rw = vec3_dot(w, r);
  double a = uu + pull, c = ww + pull, inverse = 1 / (a * c - uw * uw), cu = 0, cw = 0;
  for (int step = 0; step < STEPS; step++) {
    double su = ru - uu * cu - uw * cw, sw = rw - uw * cu - ww * cw;
    cu += (su * c - sw * uw) * inverse;
    cw += (sw * a - su * uw) * inverse;
  }
  y = vec3_mad(vec3_mad(y, u, cu), w, cw);
  return vec3_mad(y, n, d - vec3_dot(n, y)); /* back onto the plane, past rounding */
}

static inline vec3 drop_on_plane(vec3 y, vec3 n, double d) {
  for (int step = 0; step < 2; step++) y = vec3_mad(y, n, d - vec3_dot(n, y));
  return y;
}

/* Solves and judges every lane. best: at the minimum; else on the plane, as near as may be to the
 * point `along` the edge. */
SCREE_LANES_INLINE void solve_lanes(lanes *q, bool best, int count) {
  for (int i = 0; i < count; i++) {
    vec3 e = lane(q->e, i), n1 = vec3_cross(e, lane(q->c, i)), n2 = vec3_cross(lane(q->d, i), e);
    double h[6], hb[6];
    for (int k = 0; k < 6; k++) {
      h[k] = q->h[k][i];
      hb[k] = q->hb[k][i];
    }
    add_outer(h, n1, -1);
    add_outer(h, n2, -1);
    vec3 n = vec3_sub(vec3_sub(lane(q->n, i), n1), n2), g = multiply(hb, e), y;
    double norm = vec3_norm(n), trace = h[HXX] + h[HYY] + h[HZZ], k = vec3_dot(e, g);
    double around = q->area[i] - vec3_norm(n1) - vec3_norm(n2);
    n = vec3_scale(n, 1 / norm);
    double d = vec3_dot(lane(q->nb, i), e) / norm;
    y = best ? minimise_on_plane(h, g, n, d, vec3_scale(e, 0.5), PULL * trace)
             : drop_on_plane(vec3_scale(e, q->along[i]), n, d);
    double length2 = vec3_norm2(e), off2 = vec3_norm2(vec3_mad(y, e, -0.5));
    double energy = vec3_dot(y, multiply(h, y)) - 2 * vec3_dot(g, y) + k;
    energy = energy > 0 ? energy : 0;
    double size = sqrt(around), cost = (energy + TIE * trace * length2) / size;
    q->excess[i] = off2 - REACH * REACH * length2;
    q->trace[i] = trace;
    q->around[i] = around;
    q->error[i] = energy / trace;
    q->stray[i] = STRAY * size;
    q->cost[i] = cost;
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
  vec3 p = s->vertex[s->half[half_edge].from].at;
  return (scree_candidate){.cost = q->cost[i],
                           .target = vec3_add(p, lane(q->y, i)),
                           .error = q->error[i],
                           .stray = q->stray[i]};
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
  static const double along[SCREE_FALLBACK_COUNT] = {0.5, 0, 1};
  lanes q;
  gather(s, half_edge, &q, 0);
  q.along[0] = along[fallback];
  solve_along(&q);
  *out = answer(s, half_edge, &q, 0);
}

const scree_coster scree_volume_coster = {volume_sum, volume_evaluate, NULL, volume_fall_back,
                                          NULL};
