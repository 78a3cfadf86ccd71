/* One step of Gauss and Newton for the sum of the squared distances of the fan's witnesses from
 * their triangles, after the local fits of Hoppe, DeRose, Duchamp, McDonald, Stuetzle, "Mesh
 * optimization" (SIGGRAPH 1993). With the nearest point of witness j's triangle at c_j, of which
 * the moving corner has the share b_j, g_j the unit vector from c_j to the witness and d_j the
 * distance, a move y changes d_j by -b_j g_j.y, so that
 *
 *     sum (b_j g_j.y - d_j)^2 + DAMPING sum b_j^2 |y|^2 -> min
 *
 * Theirs keeps c_j where it is in its triangle, which hardly lets a vertex slide along the surface;
 * sliding is what brings it to an edge or a corner of the scan.
 *
 * The volume changes by N.y / 6, N the sum of the doubled area vectors of the fan, which does not
 * depend on where in it the vertex lies: in the plane across N it is kept exactly.
 *
 * A witness is taken to stay with its triangle, so that its distance afterwards is found at once
 * and is an upper bound, as everywhere in stray.h. */
#include "simplify/relax.h"

/* Against the sum of the squared shares: the fan says little of some directions. */
#define DAMPING 0.05
/* A smaller gain of the sum is none, for what it costs to look at all edges around anew. */
#define LEAST_GAIN 5e-3

/* The equations in the plane: unknowns along u and w. */
typedef struct equations {
  vec3 u, w;
  double uu, uw, ww, u_rhs, w_rhs, shares;
} equations;

static void add_witness(equations *q, const scree_witness *witness, const double *corners) {
  vec3 c, a = vec3_load(corners + 3), b = vec3_load(corners + 6);
  vec3 n = vec3_triangle_normal(vec3_load(corners), a, b);
  double distance = sqrt(scree_triangle_closest(corners, witness->at, &c));
  if (!(distance > SCREE_SAME_DISTANCE)) return; /* it has no direction */
  double share = vec3_dot(n, vec3_cross(vec3_sub(a, c), vec3_sub(b, c))) / vec3_norm2(n);
  vec3 g = vec3_scale(vec3_sub(witness->at, c), share / distance);
  double u = vec3_dot(g, q->u), w = vec3_dot(g, q->w);
  q->uu += u * u;
  q->uw += u * w;
  q->ww += w * w;
  q->u_rhs += u * distance;
  q->w_rhs += w * distance;
  q->shares += share * share;
}

bool scree_relax_begin(const scree_memory *m, const scree_halfmesh *s, const scree_ring *fan,
                       scree_relaxation *r) {
  double corners[SCREE_RING_MAX][9];
  vec3 sum = {0, 0, 0};
  equations q = {.shares = 0};
  r->from = s->vertex[fan->a].at;
  r->sum = r->worst = 0;
  r->has_edges = false;
  scree_no_hints(&r->hints);
  scree_ring_corners(s, fan, r->from, corners);
  for (uint32_t i = 0; i < fan->count; i++)
    sum = vec3_add(sum, vec3_triangle_normal(vec3_load(corners[i]), vec3_load(corners[i] + 3),
                                             vec3_load(corners[i] + 6)));
  double norm = vec3_norm(sum);
  if (!(norm > 0)) return false;
  r->n = vec3_scale(sum, 1 / norm);
  vec3_frame(r->n, &q.u, &q.w);
  for (uint32_t i = 0; i < fan->count; i++)
    for (uint32_t j = m->first[fan->edge[i] / 3]; j != SCREE_NONE; j = m->witnesses[j].next) {
      r->sum += m->witnesses[j].distance2;
      r->worst = fmax(r->worst, m->witnesses[j].distance2);
      add_witness(&q, &m->witnesses[j], corners[i]);
    }
  r->worst = scree_past_rounding(r->worst);
  double uu = q.uu + DAMPING * q.shares, ww = q.ww + DAMPING * q.shares;
  double determinant = uu * ww - q.uw * q.uw;
  if (!(determinant > 0)) return false;
  double u = (q.u_rhs * ww - q.w_rhs * q.uw) / determinant;
  double w = (q.w_rhs * uu - q.u_rhs * q.uw) / determinant;
  r->step = vec3_mad(vec3_scale(q.u, u), q.w, w);
  return u * q.u_rhs + w * q.w_rhs > LEAST_GAIN * r->sum; /* what the equations promise */
}

vec3 scree_relax_place(const scree_relaxation *r, double share) {
  vec3 x = vec3_mad(r->from, r->step, share);
  /* back onto the plane, past rounding */
  return vec3_mad(x, r->n, -vec3_dot(r->n, vec3_sub(x, r->from)));
}

/* Afterwards, squared. A witness that lies on the surface may stand at the vertex that moves and be
 * held by any triangle there: the nearest counts. */
static double distance2_after(double (*corners)[9], const scree_ring *fan, uint32_t i,
                              const scree_witness *w) {
  vec3 point;
  double least = scree_triangle_closest(corners[i], w->at, &point);
  if (w->distance2 > scree_past_rounding(0)) return least;
  for (uint32_t k = 0; k < fan->count; k++)
    least = fmin(least, scree_triangle_closest(corners[k], w->at, &point));
  return least;
}

static bool witnesses_gain(const scree_memory *m, const scree_halfmesh *s, const scree_ring *fan,
                           vec3 x, const scree_relaxation *r, double *worst) {
  double corners[SCREE_RING_MAX][9], sum = 0, most = (1 - LEAST_GAIN) * r->sum;
  scree_ring_corners(s, fan, x, corners);
  for (uint32_t i = 0; i < fan->count; i++)
    for (uint32_t j = m->first[fan->edge[i] / 3]; j != SCREE_NONE; j = m->witnesses[j].next) {
      double distance2 = distance2_after(corners, fan, i, &m->witnesses[j]);
      sum += distance2;
      *worst = fmax(*worst, distance2);
      if (!(sum < most)) return false;
    }
  return true;
}

bool scree_relax_gains(const scree_memory *m, const scree_halfmesh *s, const scree_ring *fan,
                       vec3 x, scree_relaxation *r) {
  double worst = 0;
  if (!witnesses_gain(m, s, fan, x, r, &worst)) return false;
  if (worst <= r->worst && scree_memory_edges_within(m, s, fan, x, r->worst, &r->hints))
    return true;
  if (r->has_edges) return false;
  double was = r->worst; /* what is as far off on the edges now is found only where it decides */
  r->worst = scree_memory_edges_stray(m, s, fan, r->from, r->worst, &r->hints);
  r->has_edges = true;
  return r->worst > was && worst <= r->worst &&
         scree_memory_edges_within(m, s, fan, x, r->worst, &r->hints);
}
