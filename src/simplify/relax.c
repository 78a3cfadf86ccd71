/* One step of Gauss and Newton for the sum of the squared distances of the fan's witnesses from
 * their triangles, after the local fits of Hoppe, DeRose, Duchamp, McDonald, Stuetzle, "Mesh
 * optimization" (SIGGRAPH 1993). With the nearest point of witness j's triangle at c_j, of which
 * the moving corner has the share b_j, g_j the unit vector from c_j to the witness and d_j the
 * distance, a move y changes d_j by -b_j g_j.y, so that
 *
 *     sum (b_j g_j.y - d_j)^2 + DAMPING sum b_j^2 |y|^2 = y.H y - 2 g.y + sum d_j^2 -> min
 *
 * Theirs keeps c_j where it is in its triangle, which hardly lets a vertex slide along the surface;
 * sliding is what brings it to an edge or a corner of the scan.
 *
 * The volume changes by n.y / 6, n the sum of the doubled area vectors of the fan, which does not
 * depend on where in it the vertex lies. So with a pressure l,
 *
 *     y = H^-1 g - l H^-1 n
 *
 * keeps it where l = n.H^-1 g / n.H^-1 n. Each collapse keeps the volume by itself, and what it
 * takes off here and leaves too much there stays: the pressures of two vertices differ. With the
 * same pressure for both they keep it together, and the sum falls further, by
 * (l_a - l_b)^2 / (1 / n_a.H_a^-1 n_a + 1 / n_b.H_b^-1 n_b). Two that are no neighbours share no
 * triangle, so that their volumes add up exactly.
 *
 * A witness is taken to stay with its triangle, so that its distance afterwards is found at once
 * and is an upper bound, as everywhere in memory.h. */
#include "simplify/relax.h"

#include "base/lanes.h"
#include "base/sym3.h"

/* Against the sum of the squared shares: the fan says little of some directions. */
#define DAMPING 0.05
/* A smaller gain of the sum is none, for what it costs to look at all edges around anew. */
#define LEAST_GAIN 1e-2

typedef struct equations {
  sym3 h;
  vec3 g;
  double shares;
} equations;

/* What the witnesses of one triangle say, side by side: g and the share of each. */
typedef struct sayings {
  double g[3][SCREE_POINTS], share[SCREE_POINTS];
} sayings;

SCREE_LANES static void say_lanes(const double *corners, const scree_points *p, sayings *out,
                                  int count) {
  vec3 a = vec3_load(corners + 3), b = vec3_load(corners + 6);
  vec3 n = vec3_triangle_normal(vec3_load(corners), a, b);
  double n2 = vec3_norm2(n);
  for (int i = 0; i < count; i++) {
    vec3 at = {p->at[0][i], p->at[1][i], p->at[2][i]};
    vec3 c = {p->nearest[0][i], p->nearest[1][i], p->nearest[2][i]};
    double share = vec3_dot(n, vec3_cross(vec3_sub(a, c), vec3_sub(b, c))) / n2;
    vec3 g = vec3_scale(vec3_sub(at, c), share / sqrt(p->distance2[i]));
    out->g[0][i] = g.x;
    out->g[1][i] = g.y;
    out->g[2][i] = g.z;
    out->share[i] = share;
  }
}

static void add_points(equations *q, const double *corners, scree_points *points,
                       const float *weights) {
  sayings said;
  scree_points_closest(corners, points);
  say_lanes(corners, points, &said, points->count);
  for (int i = 0; i < points->count; i++) {
    double distance = sqrt(points->distance2[i]), share = said.share[i];
    double weight = (double)weights[i];
    vec3 g = {said.g[0][i], said.g[1][i], said.g[2][i]};
    if (!(distance > SCREE_SAME_DISTANCE)) continue; /* it has no direction */
    sym3_add_square(&q->h, g, weight);
    q->g = vec3_mad(q->g, g, weight * distance);
    q->shares += weight * share * share;
  }
  points->count = 0;
}

bool scree_pull_find(const scree_memory *m, const scree_halfmesh *s, const scree_ring *fan,
                     scree_pull *p) {
  double corners[SCREE_RING_MAX][9];
  equations q = {.shares = 0};
  scree_points points;
  float weights[SCREE_POINTS] = {0};
  points.count = 0;
  *p = (scree_pull){.from = s->vertex[fan->a].at};
  scree_ring_corners(s, fan, p->from, corners);
  for (uint32_t i = 0; i < fan->count; i++) {
    p->n = vec3_add(p->n, vec3_triangle_normal(vec3_load(corners[i]), vec3_load(corners[i] + 3),
                                               vec3_load(corners[i] + 6)));
    for (uint32_t j = m->first[fan->edge[i] / 3]; j != SCREE_NONE; j = m->witnesses[j].next) {
      p->sum += (double)m->witnesses[j].weight * m->witnesses[j].distance2;
      p->worst = fmax(p->worst, m->witnesses[j].distance2);
      weights[points.count] = m->witnesses[j].weight;
      scree_points_add(&points, m->witnesses[j].at);
      if (points.count == SCREE_POINTS) add_points(&q, corners[i], &points, weights);
    }
    if (points.count > 0) add_points(&q, corners[i], &points, weights);
  }
  if (!(q.shares > 0)) return false;
  sym3_add_diagonal(&q.h, DAMPING * q.shares); /* well away from singular */
  p->worst = scree_past_rounding(p->worst);
  p->free = sym3_solve(&q.h, q.g);
  p->per_n = sym3_solve(&q.h, p->n);
  p->gain = vec3_dot(q.g, p->free);
  p->n_free = vec3_dot(p->n, p->free);
  p->n_per_n = vec3_dot(p->n, p->per_n);
  return p->n_per_n > 0;
}

static void begin(const scree_pull *p, const scree_ring *fan, double pressure,
                  scree_relaxation *r) {
  r->fan = fan;
  r->from = p->from;
  r->n = p->n;
  r->step = vec3_mad(p->free, p->per_n, -pressure);
  r->sum = p->sum;
  r->worst = p->worst;
  r->has_edges = false;
  scree_no_hints(&r->hints);
}

bool scree_relax_alone(const scree_pull *p, const scree_ring *fan, scree_relaxation *r) {
  double pressure = p->n_free / p->n_per_n;
  begin(p, fan, pressure, r);
  return p->gain - pressure * p->n_free > LEAST_GAIN * p->sum; /* what the equations promise */
}

double scree_exchange_gain(const scree_pull *a, const scree_pull *b) {
  double difference = a->n_free / a->n_per_n - b->n_free / b->n_per_n;
  double gain = difference * difference / (1 / a->n_per_n + 1 / b->n_per_n);
  return gain > LEAST_GAIN * (a->sum + b->sum) ? gain : 0;
}

void scree_exchange_begin(const scree_pull *pulls, const scree_ring *fans, scree_relaxation *r) {
  double pressure = (pulls[0].n_free + pulls[1].n_free) / (pulls[0].n_per_n + pulls[1].n_per_n);
  for (int i = 0; i < 2; i++) begin(&pulls[i], &fans[i], pressure, &r[i]);
}

void scree_relax_places(const scree_relaxation *r, int count, double share, vec3 *places) {
  double volume = count == 2 ? share * vec3_dot(r[0].n, r[0].step) : 0; /* six times */
  for (int i = 0; i < count; i++) {
    vec3 y = vec3_scale(r[i].step, share), n = r[i].n;
    /* back onto the plane, past rounding */
    y = vec3_mad(y, n, ((i == 0 ? volume : -volume) - vec3_dot(n, y)) / vec3_norm2(n));
    places[i] = vec3_add(r[i].from, y);
  }
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

/* Adds to the sum while it is below `most`. */
static void add_witnesses(const scree_memory *m, const scree_halfmesh *s, const scree_ring *fan,
                          vec3 x, double most, double *sum, double *worst) {
  double corners[SCREE_RING_MAX][9];
  scree_ring_corners(s, fan, x, corners);
  for (uint32_t i = 0; i < fan->count; i++)
    for (uint32_t j = m->first[fan->edge[i] / 3]; j != SCREE_NONE && *sum < most;
         j = m->witnesses[j].next) {
      double distance2 = distance2_after(corners, fan, i, &m->witnesses[j]);
      *sum += (double)m->witnesses[j].weight * distance2;
      *worst = fmax(*worst, distance2);
    }
}

static double worst_of(const scree_relaxation *r, int count) {
  return count == 2 ? fmax(r[0].worst, r[1].worst) : r[0].worst;
}

static bool edges_within(const scree_memory *m, const scree_halfmesh *s, scree_relaxation *r,
                         int count, const vec3 *places) {
  double worst = worst_of(r, count);
  for (int i = 0; i < count; i++)
    if (!scree_memory_edges_within(m, s, r[i].fan, places[i], worst, &r[i].hints)) return false;
  return true;
}

bool scree_relax_gains(const scree_memory *m, const scree_halfmesh *s, scree_relaxation *r,
                       int count, const vec3 *places) {
  double before = 0, sum = 0, worst = 0, was = worst_of(r, count);
  for (int i = 0; i < count; i++) before += r[i].sum;
  double most = (1 - LEAST_GAIN) * before;
  for (int i = 0; i < count; i++) add_witnesses(m, s, r[i].fan, places[i], most, &sum, &worst);
  if (!(sum < most)) return false;
  if (worst <= was && edges_within(m, s, r, count, places)) return true;
  if (r[0].has_edges) return false;
  r[0].has_edges = true; /* what is as far off on the edges now is found only where it decides */
  for (int i = 0; i < count; i++)
    r[i].worst = scree_memory_edges_stray(m, s, r[i].fan, r[i].from, r[i].worst, &r[i].hints);
  double now = worst_of(r, count);
  return now > was && worst <= now && edges_within(m, s, r, count, places);
}
