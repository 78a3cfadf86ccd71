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
 * further constraints a small pull towards the middle of the edge decides there
 * (PULL). */
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
  vec3 p = s->position[v];
  uint32_t first = s->outgoing[v], g = first;
  vec3 e1 = vec3_sub(s->position[scree_to(s, g)], p);
  if (s->twin[g] == SCREE_NONE) add_boundary(h, e1, 1);
  do {
    vec3 e2 = vec3_sub(s->position[s->from[scree_previous(g)]], p);
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

/* Two unit vectors that span the plane across the unit vector n (Duff and
 * others 2017). */
static inline void frame(vec3 n, vec3 *u, vec3 *w) {
  double sign = copysign(1, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  *u = (vec3){1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  *w = (vec3){b, sign + n.y * n.y * a, -n.y};
}

/* Minimises y.H y - 2 g.y over the plane n.y = d, n a unit vector, from the
 * point nearest to `middle`: y moves by proximal steps, each minimising that
 * plus pull |y - y_before|^2. Where the surface decides, the step's error
 * shrinks by pull over the curvature every time, to nothing; where it does not,
 * y stays. */
static inline vec3 minimise_on_plane(const double *h, vec3 g, vec3 n, double d, vec3 middle,
                                     double pull) {
  vec3 u, w, y = vec3_mad(middle, n, d - vec3_dot(n, middle));
  frame(n, &u, &w);
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

/* E(y) = y.H y - 2 g.y + k and the plane n.y = d of an edge, y from its first
 * end. */
typedef struct problem {
  double h[10];
  vec3 p, e, g, n; /* n a unit vector */
  double k, d, trace, around;
  bool sound;
} problem;

static inline problem pose(const scree_halfmesh *s, uint32_t half_edge) {
  uint32_t a = s->from[half_edge], b = scree_to(s, half_edge), twin = s->twin[half_edge];
  const double *ha = s->sums[a], *hb = s->sums[b];
  problem q = {.p = s->position[a]};
  vec3 e = q.e = vec3_sub(s->position[b], q.p);
  vec3 to_c = vec3_sub(s->position[s->from[scree_previous(half_edge)]], q.p);
  vec3 n1 = vec3_cross(e, to_c), n2 = {0, 0, 0};
  for (int i = 0; i < 10; i++) q.h[i] = ha[i] + hb[i];
  add_outer(q.h, n1, -1);
  if (twin != SCREE_NONE) {
    vec3 to_d = vec3_sub(s->position[s->from[scree_previous(twin)]], q.p);
    n2 = vec3_cross(to_d, e);
    add_outer(q.h, n2, -1);
  } else {
    add_boundary(q.h, e, -1);
  }
  vec3 n = {q.h[NX] - n1.x - n2.x, q.h[NY] - n1.y - n2.y, q.h[NZ] - n1.z - n2.z};
  double norm = vec3_norm(n);
  q.g = multiply(hb, e);
  q.k = vec3_dot(e, q.g);
  q.trace = q.h[HXX] + q.h[HYY] + q.h[HZZ];
  q.around = q.h[AREA] - vec3_norm(n1) - vec3_norm(n2);
  q.sound = norm > 0 && q.trace > 0 && q.around > 0;
  if (!q.sound) return q;
  q.n = vec3_scale(n, 1 / norm);
  q.d = (hb[NX] * e.x + hb[NY] * e.y + hb[NZ] * e.z) / norm;
  return q;
}

static inline void answer(const problem *q, vec3 y, scree_candidate *out) {
  double length2 = vec3_norm2(q->e), off2 = vec3_norm2(vec3_mad(y, q->e, -0.5));
  if (!(off2 <= REACH * REACH * length2)) return;
  double energy = vec3_dot(y, multiply(q->h, y)) - 2 * vec3_dot(q->g, y) + q->k;
  if (!(energy > 0)) energy = 0;
  out->target = vec3_add(q->p, y);
  out->error = energy / q->trace;
  out->cost = (energy + TIE * q->trace * length2) / sqrt(q->around);
}

static void volume_evaluate(const scree_halfmesh *s, uint32_t half_edge, scree_candidate *out) {
  problem q = pose(s, half_edge);
  *out = (scree_candidate){.cost = INFINITY};
  if (!q.sound) return;
  answer(&q, minimise_on_plane(q.h, q.g, q.n, q.d, vec3_scale(q.e, 0.5), PULL * q.trace), out);
}

static void volume_fall_back(const scree_halfmesh *s, uint32_t half_edge, int fallback,
                             scree_candidate *out) {
  static const double along[SCREE_FALLBACK_COUNT] = {0.5, 0, 1};
  problem q = pose(s, half_edge);
  *out = (scree_candidate){.cost = INFINITY};
  if (!q.sound) return;
  vec3 y = vec3_scale(q.e, along[fallback]);
  for (int step = 0; step < 2; step++) y = vec3_mad(y, q.n, q.d - vec3_dot(q.n, y));
  answer(&q, y, out);
}

const scree_coster scree_volume_coster = {volume_sum, volume_evaluate, volume_fall_back, NULL};
