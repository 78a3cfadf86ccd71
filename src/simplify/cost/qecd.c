/* Method `qecd`: quadric edge collapse decimation as MeshLab 2025 does it with
 * its defaults, after Garland and Heckbert, "Surface simplification using
 * quadric error metrics" (SIGGRAPH 1997).
 *
 * The quadric of a triangle is the squared distance to its plane times twice
 * its area; of a vertex, the sum over its triangles, and after a collapse the
 * sum of both ends'. A boundary edge adds the plane through it, upright on its
 * triangle, with weight BOUNDARY. The vertex goes to the middle of the edge if
 * that costs nothing, else to the minimiser of the quadric (where it is
 * singular, to the minimiser nearest to the middle). The order is error /
 * min(q, 0.3), q the worst (2 area / longest edge^2) among the new triangles.
 *
 * Differs: quadrics live in the unit box in double; every edge stays in the
 * queue (MeshLab's loses about two thirds of them on updates). */
#include "base/lanes.h"
#include "simplify/cost/cost.h"

#include <string.h>

/* MeshLab's QualityThr and BoundaryQuadricWeight, and the error below which the
 * middle is taken: of a surface of area 1, so that its scale does not matter. */
#define QUALITY      0.3
#define BOUNDARY     0.5
#define MIDDLE_ERROR 2e-15
/* Pull to the middle relative to the trace: decides singular quadrics only; a
 * second step from where the first one ended removes its bias elsewhere. */
#define PULL 1e-8
#define TIE  1e-12
enum { XX, XY, XZ, YY, YZ, ZZ, X, Y, Z, ONE };

static void add_plane(double *q, vec3 n, double offset, double w) {
  q[XX] += w * n.x * n.x;
  q[XY] += w * n.x * n.y;
  q[XZ] += w * n.x * n.z;
  q[YY] += w * n.y * n.y;
  q[YZ] += w * n.y * n.z;
  q[ZZ] += w * n.z * n.z;
  q[X] += w * n.x * offset;
  q[Y] += w * n.y * offset;
  q[Z] += w * n.z * offset;
  q[ONE] += w * offset * offset;
}

SCREE_LANES_INLINE double value(const double *q, vec3 v) {
  double x = q[XX] * v.x + q[XY] * v.y + q[XZ] * v.z + 2 * q[X];
  double y = q[XY] * v.x + q[YY] * v.y + q[YZ] * v.z + 2 * q[Y];
  double z = q[XZ] * v.x + q[YZ] * v.y + q[ZZ] * v.z + 2 * q[Z];
  return v.x * x + v.y * y + v.z * z + q[ONE];
}

static void add_boundary(const scree_halfmesh *s, double *q, uint32_t h) {
  vec3 p = s->vertex[s->half[h].from].at, e = vec3_sub(s->vertex[scree_to(s, h)].at, p);
  vec3 n = vec3_cross(e, vec3_sub(s->vertex[s->half[scree_previous(h)].from].at, p));
  vec3 side = vec3_unit(vec3_cross(vec3_unit(e), vec3_unit(n)));
  add_plane(q, side, -vec3_dot(side, p), BOUNDARY * vec3_norm2(e));
}

static void qecd_sum(scree_halfmesh *s, uint32_t v) {
  double q[10] = {0};
  uint32_t first = s->vertex[v].outgoing, g = first, last;
  vec3 p = s->vertex[v].at;
  if (s->half[g].twin == SCREE_NONE) add_boundary(s, q, g);
  do {
    vec3 n = vec3_triangle_normal(p, s->vertex[scree_to(s, g)].at,
                                  s->vertex[s->half[scree_previous(g)].from].at);
    double doubled = vec3_norm(n);
    if (doubled > 0) {
      n = vec3_scale(n, 1 / doubled);
      add_plane(q, n, -vec3_dot(n, p), doubled);
    }
    last = g;
    g = scree_turn(s, g);
  } while (g != SCREE_NONE && g != first);
  if (g == SCREE_NONE) add_boundary(s, q, scree_previous(last));
  memcpy(s->sums[v], q, sizeof q);
}

static void qecd_merge(scree_halfmesh *s, uint32_t survivor, uint32_t gone) {
  const double *of_gone = s->sums[gone];
  double *of_survivor = s->sums[survivor];
  for (int i = 0; i < 10; i++) of_survivor[i] += of_gone[i];
}

/* Edges are evaluated side by side, one per lane. */
enum { LANES = 32 };

typedef struct lanes {
  double q[10][LANES]; /* of both ends */
  double m[3][LANES];  /* the middle, or the place asked for */
  double x[3][LANES];  /* the place chosen */
  double length2[LANES], trace[LANES], error[LANES], cost[LANES];
} lanes;

static void gather(const scree_halfmesh *s, uint32_t half_edge, double along, lanes *l, int i) {
  uint32_t a = s->half[half_edge].from, b = scree_to(s, half_edge);
  vec3 pa = s->vertex[a].at, pb = s->vertex[b].at, m = vec3_lerp(pa, pb, along);
  const double *of_a = s->sums[a], *of_b = s->sums[b];
  for (int k = 0; k < 10; k++) l->q[k][i] = of_a[k] + of_b[k];
  l->m[0][i] = m.x;
  l->m[1][i] = m.y;
  l->m[2][i] = m.z;
  l->length2[i] = vec3_norm2(vec3_sub(pb, pa));
}

/* L D L^T of the quadric's matrix with `pull` added to its diagonal; d is inverted. */
typedef struct factors {
  double l21, l31, l32, d1, d2, d3;
} factors;

SCREE_LANES_INLINE factors factorise(const double *q, double pull) {
  factors f;
  f.d1 = 1 / (q[XX] + pull);
  f.l21 = q[XY] * f.d1;
  f.l31 = q[XZ] * f.d1;
  double m22 = q[YY] + pull - f.l21 * q[XY], m32 = q[YZ] - f.l31 * q[XY];
  f.d2 = 1 / m22;
  f.l32 = m32 * f.d2;
  f.d3 = 1 / (q[ZZ] + pull - f.l31 * q[XZ] - f.l32 * m32);
  return f;
}

/* The minimiser of q + pull |v - m|^2. */
SCREE_LANES_INLINE vec3 minimise(const double *q, const factors *f, vec3 m) {
  /* right-hand side relative to m, where the solution is small */
  vec3 r = {-(q[XX] * m.x + q[XY] * m.y + q[XZ] * m.z + q[X]),
            -(q[XY] * m.x + q[YY] * m.y + q[YZ] * m.z + q[Y]),
            -(q[XZ] * m.x + q[YZ] * m.y + q[ZZ] * m.z + q[Z])};
  double y2 = r.y - f->l21 * r.x, y3 = r.z - f->l31 * r.x - f->l32 * y2;
  double z = y3 * f->d3, y = y2 * f->d2 - f->l32 * z, x = r.x * f->d1 - f->l21 * y - f->l31 * z;
  return vec3_add(m, (vec3){x, y, z});
}

/* best: the minimiser, where the middle is not as good as it; else the place asked for. The cost is
 * as if no new triangle were ill-shaped. */
SCREE_LANES_INLINE void solve_lanes(lanes *l, bool best, double middle_error, int count) {
  for (int i = 0; i < count; i++) {
    double q[10];
    for (int k = 0; k < 10; k++) q[k] = l->q[k][i];
    vec3 x = {l->m[0][i], l->m[1][i], l->m[2][i]};
    double trace = q[XX] + q[YY] + q[ZZ], error = value(q, x);
    if (best) {
      factors f = factorise(q, PULL * trace);
      vec3 least = minimise(q, &f, minimise(q, &f, x));
      double least_error = value(q, least);
      bool better = (error > middle_error) & (trace > 0) & (least_error < error);
      x.x = better ? least.x : x.x;
      x.y = better ? least.y : x.y;
      x.z = better ? least.z : x.z;
      error = better ? least_error : error;
    }
    error = error > 0 ? error : 0; /* rounding may take it below */
    l->cost[i] = (error + TIE * trace * l->length2[i]) / QUALITY;
    l->trace[i] = trace;
    l->error[i] = error;
    l->x[0][i] = x.x;
    l->x[1][i] = x.y;
    l->x[2][i] = x.z;
  }
}

SCREE_LANES static void solve_best_qecd(lanes *l, double middle_error, int count) {
  solve_lanes(l, true, middle_error, count);
}

static void solve_along(lanes *l) {
  solve_lanes(l, false, 0, 1);
}

static scree_candidate answer(const lanes *l, int i) {
  return (scree_candidate){.cost = l->cost[i],
                           .target = {l->x[0][i], l->x[1][i], l->x[2][i]},
                           .error = l->trace[i] > 0 ? l->error[i] / l->trace[i] : 0};
}

/* The worst shape among the triangles of v's fan, those with `other` apart,
 * once v lies at x, squared. */
static double worst_quality(const scree_halfmesh *s, uint32_t v, uint32_t other, vec3 x,
                            double worst) {
  uint32_t first = s->vertex[v].outgoing, g = first;
  do {
    uint32_t c1 = scree_to(s, g), c2 = s->half[scree_previous(g)].from;
    if (c1 != other && c2 != other) {
      vec3 e1 = vec3_sub(s->vertex[c1].at, x), e2 = vec3_sub(s->vertex[c2].at, x);
      double l12 = vec3_norm2(e1), l22 = vec3_norm2(e2), l32 = vec3_norm2(vec3_sub(e1, e2));
      double l2 = l12 > l22 ? l12 : l22;
      l2 = l32 > l2 ? l32 : l2;
      double doubled2 = vec3_norm2(vec3_cross(e1, e2)); /* quality squared: one root in all */
      if (!(doubled2 >= worst * l2 * l2)) worst = l2 > 0 ? doubled2 / (l2 * l2) : 0;
    }
    g = scree_turn(s, g);
  } while (g != SCREE_NONE && g != first);
  return worst;
}

/* The cost is infinite where a triangle would have no area. */
static void add_shape(const scree_halfmesh *s, uint32_t half_edge, scree_candidate *c) {
  uint32_t a = s->half[half_edge].from, b = scree_to(s, half_edge);
  double best = QUALITY * QUALITY;
  double worst = worst_quality(s, b, a, c->target, worst_quality(s, a, b, c->target, best));
  c->cost = worst > 0 ? c->cost * (QUALITY / sqrt(worst)) : INFINITY;
}

static void qecd_evaluate(const scree_halfmesh *s, const uint32_t *half_edges, size_t count,
                          scree_candidate *out) {
  lanes l;
  for (size_t begin = 0; begin < count; begin += LANES) {
    int filled = count - begin < LANES ? (int)(count - begin) : LANES;
    int width = (filled + 3) & ~3; /* whole vectors */
    for (int i = 0; i < width; i++)
      gather(s, half_edges[begin + (size_t)(i < filled ? i : 0)], 0.5, &l, i);
    solve_best_qecd(&l, MIDDLE_ERROR * s->area * s->area, width);
    for (int i = 0; i < filled; i++) {
      out[begin + (size_t)i] = answer(&l, i);
      add_shape(s, half_edges[begin + (size_t)i], &out[begin + (size_t)i]);
    }
  }
}

static void qecd_fall_back(const scree_halfmesh *s, uint32_t half_edge, int fallback,
                           scree_candidate *out) {
  static const double along[SCREE_FALLBACK_COUNT] = {0.5, 0, 1};
  lanes l;
  gather(s, half_edge, along[fallback], &l, 0);
  solve_along(&l);
  *out = answer(&l, 0);
  add_shape(s, half_edge, out);
}

const scree_coster scree_qecd_coster = {qecd_sum, qecd_evaluate, qecd_fall_back, qecd_merge};
