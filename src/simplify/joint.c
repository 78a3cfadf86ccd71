/* Steps of Gauss and Newton in all vertices together. As in relax.c, but that every corner k of
 * witness j's triangle moves, and has the share b_jk of the nearest point: the witness's distance
 * d_j changes by -sum_k b_jk g_j.y_k. With weights w_j,
 *
 *     sum_j w_j (sum_k b_jk g_j.y_k - d_j)^2 + damping sum_k |y_k|^2 sum_j w_j b_jk^2 -> min
 *
 * What a level is judged by is the mean of its distances, and the greatest. So with m and F what
 * these were when the steps began, and W the sum of what the witnesses weigh in the mean, v_j, they
 * make the merit
 *
 *     2 / W sum_j v_j d_j + s m / 4 sum_j (d_j / F)^8
 *
 * less, whose second part is felt near the greatest only. Its gradient is that of the squares with
 *
 *     w_j = v_j / max(d_j, m / 10) + s W m / F^2 (d_j / F)^6
 *
 * (iteratively reweighted least squares). s is FAR_SHARE over that last sum as the steps began: a
 * change of the merit is then, over 2 m, one of the logarithm of the mean distance times the cube
 * root of (sum_j d_j^8)^(1/8), which stands for the greatest, as in a level's score. Vertices and
 * places on edges that are more than half as far, squared, from the surface kept stand in the sums
 * as well, with the second part alone.
 *
 * With n_k the sum of the doubled area vectors of vertex k's fan the volume changes by
 * sum_k n_k.y_k / 6, to first order; it is kept as in relax.c, by one pressure for all. */
#include "simplify/joint.h"

#include "base/lanes.h"
#include "base/parallel.h"

#include <string.h>

/* Of the mean distance: the least that counts in a weight. */
#define LEAST_DISTANCE 0.1
/* ... and below which a witness stands less and less for its own direction g and more for its
 * triangle's normal, as one above the inside does anyway: of next to nothing the direction is
 * rounding, which from step to step would grow until it decides. */
#define NO_DISTANCE 0.05
/* What all that lies far off weighs, against all witnesses: more brings it nearer, and leaves the
 * mean distance larger. A third is what the score of most scans gives it (scree_level_score). */
#define FAR_SHARE 0.333
/* Conjugate gradients end where the residual is so much smaller, squared, or after so many steps.
 */
#define ENOUGH 1e-6
enum { MOST_ITERATIONS = 40 };
/* Places are looked at above this share of the farthest's squared distance, or, where there are
 * none, of that again. */
#define LOOKED_ABOVE 0.5
/* Triangles that one thread asks at a time. */
enum { ASKED_AT_ONCE = 64 };
/* Looks for the farthest place, each for what is nearer than in the one before. */
enum { MOST_LOOKS = 4 };
/* Times that what the places leave of the volume is taken up by pressure: the rest falls
 * quadratically. */
enum { VOLUME_ROUNDS = 3 };

scree_status scree_joint_allocate(scree_joint *j, const scree_halfmesh *s, scree_error *error) {
  size_t vertices = s->vertex_count, half_edges = 3 * s->triangle_count;
  *j = (scree_joint){.free = NULL};
  SCREE_ALLOC_OR(j->free, vertices, error, out_of_memory);
  SCREE_ALLOC_OR(j->step, vertices, error, out_of_memory);
  SCREE_ALLOC_OR(j->per_n, vertices, error, out_of_memory);
  SCREE_ALLOC_OR(j->far, half_edges * SCREE_LEVEL_PLACES, error, out_of_memory);
  SCREE_ALLOC_OR(j->hints, half_edges, error, out_of_memory);
  SCREE_ALLOC_OR(j->own, vertices, error, out_of_memory);
  SCREE_ALLOC_OR(j->damped, vertices, error, out_of_memory);
  SCREE_ALLOC_OR(j->inverse, vertices, error, out_of_memory);
  SCREE_ALLOC_OR(j->shared, half_edges, error, out_of_memory);
  SCREE_ALLOC_OR(j->edges, half_edges, error, out_of_memory);
  SCREE_ALLOC_OR(j->n, vertices, error, out_of_memory);
  SCREE_ALLOC_OR(j->pull, vertices, error, out_of_memory);
  SCREE_ALLOC_OR(j->shares, vertices, error, out_of_memory);
  SCREE_ALLOC_OR(j->parts, s->triangle_count, error, out_of_memory);
  for (int i = 0; i < 8; i++) SCREE_ALLOC_OR(j->room[i / 4][i % 4], vertices, error, out_of_memory);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_joint_free(scree_joint *j) {
  scree_free(j->free);
  scree_free(j->step);
  scree_free(j->per_n);
  scree_free(j->far);
  scree_free(j->hints);
  scree_free(j->own);
  scree_free(j->damped);
  scree_free(j->inverse);
  scree_free(j->shared);
  scree_free(j->edges);
  scree_free(j->n);
  scree_free(j->pull);
  scree_free(j->shares);
  scree_free(j->parts);
  for (int i = 0; i < 8; i++) scree_free(j->room[i / 4][i % 4]);
}

/* Lists the places that are farther off than `least2`. */
static void list_far(scree_joint *j, const scree_memory *m, const scree_halfmesh *s,
                     double least2) {
  j->far_count = scree_memory_far_places(m, s, least2, j->hinted, j->hints, j->far);
  j->hinted = true;
}

void scree_joint_compact(scree_joint *j, const scree_halfmesh *s) {
  size_t count = 0;
  for (size_t t = 0; t < s->triangle_count && j->hinted; t++) {
    if (scree_is_gone(s, t)) continue;
    if (t > count) memcpy(j->hints + 3 * count, j->hints + 3 * t, 3 * sizeof *j->hints);
    count++;
  }
}

static double eighth_power(double distance2, double far2) {
  double ratio2 = distance2 / far2, ratio4 = ratio2 * ratio2;
  return ratio4 * ratio4;
}

static double sum_of_far(const scree_joint *j, const scree_memory *m, const scree_halfmesh *s) {
  double far = 0;
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    for (uint32_t k = m->first[t]; k != SCREE_NONE; k = m->witnesses[k].next)
      far += eighth_power(m->witnesses[k].distance2, j->far2);
  }
  for (size_t i = 0; i < j->far_count; i++) far += eighth_power(j->far[i].distance2, j->far2);
  return far;
}

static double merit_of(const scree_joint *j, double mean, double far) {
  return 2 * mean + j->far_share / 4 * j->mean * far;
}

double scree_joint_begin(scree_joint *j, const scree_memory *m, const scree_halfmesh *s,
                         double about2) {
  double of_witnesses2 = scree_memory_witness_stray(m, s);
  double least2 = LOOKED_ABOVE * fmax(about2, of_witnesses2);
  j->mean = scree_memory_mean(m);
  for (int look = 0; look < MOST_LOOKS; look++, least2 *= LOOKED_ABOVE) {
    list_far(j, m, s, least2);
    j->far2 = of_witnesses2;
    for (size_t i = 0; i < j->far_count; i++) j->far2 = fmax(j->far2, j->far[i].distance2);
    if (j->far2 > least2) break;
  }
  if (least2 != LOOKED_ABOVE * j->far2) scree_joint_look(j, m, s);
  double far = sum_of_far(j, m, s);
  j->far_share = FAR_SHARE / far;
  return merit_of(j, j->mean, far);
}

void scree_joint_look(scree_joint *j, const scree_memory *m, const scree_halfmesh *s) {
  list_far(j, m, s, LOOKED_ABOVE * j->far2);
}

double scree_joint_merit(const scree_joint *j, const scree_memory *m, const scree_halfmesh *s) {
  return merit_of(j, scree_memory_mean(m), sum_of_far(j, m, s));
}

/* The weights, see above. */
typedef struct weighing {
  double least, none, far_unit, far2;
} weighing;

static inline double far_weight(const weighing *w, double distance2) {
  double ratio2 = distance2 / w->far2;
  return w->far_unit * ratio2 * ratio2 * ratio2;
}

/* What a triangle's witnesses add to the equations: of its corners, own and with the next one the
 * same squares, pull and squared shares. Every fourth witness adds to the same lane. */
enum { SUM_LANES = 4 };
typedef double four_lanes __attribute__((vector_size(SUM_LANES * sizeof(double))));
typedef struct triangle_sums {
  double own[3][6][SUM_LANES], shared[3][6][SUM_LANES];
  double pull[3][3][SUM_LANES], shares[3][SUM_LANES];
} triangle_sums;

/* What some witnesses say, side by side: of the unit vector towards each the squares, and that
 * times the distance; the weight; the shares of the corners. */
typedef struct joint_sayings {
  double square[6][SCREE_POINTS], along[3][SCREE_POINTS];
  double weight[SCREE_POINTS], share[3][SCREE_POINTS];
} joint_sayings;

SCREE_LANES static void say_all_lanes(const double *corners, const scree_points *p,
                                      const double *weights, const weighing *w,
                                      joint_sayings *restrict out, int count) {
  vec3 a = vec3_load(corners), b = vec3_load(corners + 3), c = vec3_load(corners + 6);
  vec3 n = vec3_triangle_normal(a, b, c);
  double per_n2 = 1 / vec3_norm2(n), floor = w->least, far_unit = w->far_unit,
         per_far2 = 1 / w->far2, none2 = w->none * w->none, upright2 = per_n2 * none2;
  for (int i = 0; i < count; i++) {
    vec3 x = {p->nearest[0][i], p->nearest[1][i], p->nearest[2][i]};
    vec3 off = {p->at[0][i] - x.x, p->at[1][i] - x.y, p->at[2][i] - x.z};
    vec3 xa = vec3_sub(a, x), xb = vec3_sub(b, x), xc = vec3_sub(c, x);
    double distance = sqrt(p->distance2[i]), ratio2 = per_far2 * p->distance2[i];
    double most = distance > floor ? distance : floor;
    double towards = 1 / (p->distance2[i] + none2), upright = upright2 * towards;
    out->weight[i] = weights[i] / most + far_unit * ratio2 * ratio2 * ratio2;
    out->share[0][i] = per_n2 * vec3_dot(n, vec3_cross(xb, xc));
    out->share[1][i] = per_n2 * vec3_dot(n, vec3_cross(xc, xa));
    out->share[2][i] = per_n2 * vec3_dot(n, vec3_cross(xa, xb));
    out->square[0][i] = towards * off.x * off.x + upright * n.x * n.x;
    out->square[1][i] = towards * off.x * off.y + upright * n.x * n.y;
    out->square[2][i] = towards * off.x * off.z + upright * n.x * n.z;
    out->square[3][i] = towards * off.y * off.y + upright * n.y * n.y;
    out->square[4][i] = towards * off.y * off.z + upright * n.y * n.z;
    out->square[5][i] = towards * off.z * off.z + upright * n.z * n.z;
    out->along[0][i] = off.x;
    out->along[1][i] = off.y;
    out->along[2][i] = off.z;
  }
}

SCREE_LANES_INLINE void load_lanes(four_lanes *lanes, const double *from) {
  memcpy(lanes, from, sizeof *lanes);
}

SCREE_LANES_INLINE void store_lanes(double *to, const four_lanes *lanes) {
  memcpy(to, lanes, sizeof *lanes);
}

/* Of one corner all sums side by side: each by itself would wait for its addition before. */
SCREE_LANES_INLINE void sum_of_corner(const joint_sayings *restrict said, int corner, int count,
                                      triangle_sums *restrict sums) {
  const double *share = said->share[corner], *next = said->share[(corner + 1) % 3];
  four_lanes own[6], shared[6], pull[3], shares;
  for (int q = 0; q < 6; q++) load_lanes(&own[q], sums->own[corner][q]);
  for (int q = 0; q < 6; q++) load_lanes(&shared[q], sums->shared[corner][q]);
  for (int q = 0; q < 3; q++) load_lanes(&pull[q], sums->pull[corner][q]);
  load_lanes(&shares, sums->shares[corner]);
  for (int i = 0; i < count; i += SUM_LANES) {
    four_lanes of_corner, of_next, with_own, with_both, read;
    load_lanes(&of_corner, share + i);
    load_lanes(&of_next, next + i);
    load_lanes(&read, said->weight + i);
    with_own = read * of_corner;
    with_both = with_own * of_next;
    for (int q = 0; q < 3; q++) {
      load_lanes(&read, said->along[q] + i);
      pull[q] += with_own * read;
    }
    with_own *= of_corner;
    shares += with_own;
    for (int q = 0; q < 6; q++) {
      load_lanes(&read, said->square[q] + i);
      own[q] += with_own * read;
      shared[q] += with_both * read;
    }
  }
  for (int q = 0; q < 6; q++) store_lanes(sums->own[corner][q], &own[q]);
  for (int q = 0; q < 6; q++) store_lanes(sums->shared[corner][q], &shared[q]);
  for (int q = 0; q < 3; q++) store_lanes(sums->pull[corner][q], &pull[q]);
  store_lanes(sums->shares[corner], &shares);
}

SCREE_LANES static void sum_sayings_lanes(const joint_sayings *restrict said, int count,
                                          triangle_sums *restrict sums) {
  for (int corner = 0; corner < 3; corner++) sum_of_corner(said, corner, count, sums);
}

static void add_crowd(const double *corners, scree_points *points, double *weights,
                      const weighing *w, triangle_sums *sums) {
  joint_sayings said;
  int width = (points->count + SUM_LANES - 1) / SUM_LANES * SUM_LANES;
  for (int i = points->count; i < width; i++) weights[i] = 0;
  scree_points_closest(corners, points);
  for (int i = points->count; i < width; i++) {
    points->distance2[i] = 0;
    for (int k = 0; k < 3; k++) points->at[k][i] = points->nearest[k][i] = corners[k];
  }
  say_all_lanes(corners, points, weights, w, &said, width);
  sum_sayings_lanes(&said, width, sums);
  points->count = 0;
}

static double lane_sum(const double *lanes) {
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

static vec3 sum_of_pulls(double (*lanes)[SUM_LANES]) {
  return (vec3){lane_sum(lanes[0]), lane_sum(lanes[1]), lane_sum(lanes[2])};
}

static sym3 sum_of_squares(double (*lanes)[SUM_LANES]) {
  return (sym3){lane_sum(lanes[0]), lane_sum(lanes[1]), lane_sum(lanes[2]),
                lane_sum(lanes[3]), lane_sum(lanes[4]), lane_sum(lanes[5])};
}

static void ask_triangle(const scree_memory *m, const scree_halfmesh *s, uint32_t t,
                         const weighing *w, scree_joint_part *part) {
  vec3 at[3];
  double corners[9], weights[SCREE_POINTS];
  scree_points points;
  triangle_sums sums;
  points.count = 0;
  memset(&sums, 0, sizeof sums);
  scree_corners(s, t, at);
  for (size_t i = 0; i < 3; i++) vec3_store(corners + 3 * i, at[i]);
  for (uint32_t k = m->first[t]; k != SCREE_NONE; k = m->witnesses[k].next) {
    if (m->witnesses[k].distance2 <= scree_past_rounding(0)) continue; /* it has no direction */
    weights[points.count] = (double)m->witnesses[k].weight;
    scree_points_add(&points, m->witnesses[k].at);
    if (points.count == SCREE_POINTS) add_crowd(corners, &points, weights, w, &sums);
  }
  if (points.count > 0) add_crowd(corners, &points, weights, w, &sums);
  part->n = vec3_triangle_normal(at[0], at[1], at[2]);
  for (size_t k = 0; k < 3; k++) {
    part->own[k] = sum_of_squares(sums.own[k]);
    part->shared[k] = sum_of_squares(sums.shared[k]);
    part->pull[k] = sum_of_pulls(sums.pull[k]);
    part->shares[k] = lane_sum(sums.shares[k]);
  }
}

/* The triangles' parts of the equations, side by side. */
typedef struct asking {
  scree_joint *joint;
  const scree_memory *memory;
  const scree_halfmesh *s;
  weighing weighing;
} asking;

static void ask_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const asking *a = context;
  for (size_t t = begin; t < end; t++)
    if (!scree_is_gone(a->s, t))
      ask_triangle(a->memory, a->s, (uint32_t)t, &a->weighing, &a->joint->parts[t]);
}

static void add_part(scree_joint *j, const scree_halfmesh *s, uint32_t t) {
  const scree_joint_part *part = &j->parts[t];
  for (uint32_t k = 0; k < 3; k++) {
    uint32_t v = s->half[3 * t + k].from;
    j->n[v] = vec3_add(j->n[v], part->n);
    sym3_add(&j->own[v], &part->own[k]);
    j->shared[3 * t + k] = part->shared[k];
    j->pull[v] = vec3_add(j->pull[v], part->pull[k]);
    j->shares[v] += part->shares[k];
  }
}

/* Vertex v has this share of a place. */
static void add_end(scree_joint *j, uint32_t v, vec3 g, double weight, double share,
                    double distance) {
  sym3_add_square(&j->own[v], g, weight * share * share);
  j->pull[v] = vec3_mad(j->pull[v], g, weight * share * distance);
  j->shares[v] += weight * share * share;
}

static void add_far(scree_joint *j, const scree_halfmesh *s, const scree_far_place *p,
                    const weighing *w) {
  double distance = sqrt(p->distance2), weight = far_weight(w, p->distance2);
  vec3 g = vec3_scale(vec3_sub(p->nearest, p->at), 1 / distance);
  add_end(j, s->half[p->half_edge].from, g, weight, 1 - p->share, distance);
  add_end(j, scree_to(s, p->half_edge), g, weight, p->share, distance);
  sym3_add_square(&j->shared[p->half_edge], g, weight * p->share * (1 - p->share));
}

static double dot(const vec3 *a, const vec3 *b, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) sum += vec3_dot(a[i], b[i]);
  return sum;
}

static void multiply(const scree_joint *j, size_t count, const vec3 *x, vec3 *out) {
  for (size_t v = 0; v < count; v++) out[v] = sym3_mul_vec(&j->damped[v], x[v]);
  for (size_t i = 0; i < j->edge_count; i++) {
    uint32_t a = j->edges[i].ends[0], b = j->edges[i].ends[1];
    out[a] = vec3_add(out[a], sym3_mul_vec(&j->edges[i].shared, x[b]));
    out[b] = vec3_add(out[b], sym3_mul_vec(&j->edges[i].shared, x[a]));
  }
  for (size_t v = 0; v < count; v++)
    if (!j->free[v]) out[v] = (vec3){0, 0, 0};
}

/* Conjugate gradients, preconditioned by what each vertex has by itself. What is not free stays. */
static void solve(const scree_joint *j, size_t count, const vec3 *right, vec3 *const *room,
                  vec3 *x) {
  vec3 *r = room[0], *z = room[1], *p = room[2], *q = room[3];
  for (size_t v = 0; v < count; v++) {
    x[v] = (vec3){0, 0, 0};
    r[v] = j->free[v] ? right[v] : x[v];
    p[v] = z[v] = j->free[v] ? sym3_mul_vec(&j->inverse[v], r[v]) : x[v];
  }
  double rz = dot(r, z, count), enough = ENOUGH * rz;
  for (int i = 0; i < MOST_ITERATIONS && rz > enough; i++) {
    multiply(j, count, p, q);
    double along = rz / dot(p, q, count), before = rz;
    for (size_t v = 0; v < count; v++) {
      x[v] = vec3_mad(x[v], p[v], along);
      r[v] = vec3_mad(r[v], q[v], -along);
      if (j->free[v]) z[v] = sym3_mul_vec(&j->inverse[v], r[v]);
    }
    rz = dot(r, z, count);
    for (size_t v = 0; v < count; v++) p[v] = vec3_mad(z[v], p[v], rz / before);
  }
}

/* The ways and how pressure moves the vertices, side by side. */
typedef struct solving {
  const scree_joint *joint;
  size_t count; /* vertices */
} solving;

static void solve_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const solving *q = context;
  const scree_joint *j = q->joint;
  for (size_t i = begin; i < end; i++)
    solve(j, q->count, i == 0 ? j->pull : j->n, j->room[i], i == 0 ? j->step : j->per_n);
}

static void list_edges(scree_joint *j, const scree_halfmesh *s) {
  j->edge_count = 0;
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
    uint32_t twin = s->half[h].twin;
    if (s->half[h].from == SCREE_NONE || twin < h) continue;
    scree_joint_edge *edge = &j->edges[j->edge_count++];
    *edge = (scree_joint_edge){{s->half[h].from, scree_to(s, h)}, j->shared[h]};
    if (twin != SCREE_NONE) sym3_add(&edge->shared, &j->shared[twin]);
  }
}

bool scree_joint_fill(scree_joint *j, const scree_memory *m, const scree_halfmesh *s) {
  size_t vertices = s->vertex_count;
  if (!(j->mean > SCREE_SAME_DISTANCE)) return false;
  weighing w = {LEAST_DISTANCE * j->mean, NO_DISTANCE * j->mean,
                j->far_share * m->weight * j->mean / j->far2, j->far2};
  asking a = {j, m, s, w};
  memset(j->own, 0, vertices * sizeof *j->own);
  memset(j->shared, 0, 3 * s->triangle_count * sizeof *j->shared);
  memset(j->pull, 0, vertices * sizeof *j->pull);
  memset(j->n, 0, vertices * sizeof *j->n);
  memset(j->shares, 0, vertices * sizeof *j->shares);
  scree_parallel_for(s->triangle_count, ASKED_AT_ONCE, ask_block, &a);
  for (uint32_t t = 0; t < s->triangle_count; t++)
    if (!scree_is_gone(s, t)) add_part(j, s, t);
  for (size_t i = 0; i < j->far_count; i++) add_far(j, s, &j->far[i], &w);
  for (size_t v = 0; v < vertices; v++) {
    j->free[v] = j->free[v] && j->shares[v] > 0;
    if (!j->free[v]) j->n[v] = (vec3){0, 0, 0};
  }
  list_edges(j, s);
  return true;
}

bool scree_joint_solve(scree_joint *j, const scree_halfmesh *s, double damping) {
  size_t vertices = s->vertex_count;
  for (size_t v = 0; v < vertices; v++) {
    j->damped[v] = j->own[v];
    sym3_add_diagonal(&j->damped[v], damping * j->shares[v]);
    if (j->free[v]) j->inverse[v] = sym3_inverse(&j->damped[v]);
  }
  scree_parallel_for(2, 1, solve_block, &(solving){j, vertices});
  j->n_per_n = dot(j->n, j->per_n, vertices);
  if (!(j->n_per_n > 0)) return false;
  double pressure = dot(j->n, j->step, vertices) / j->n_per_n;
  for (size_t v = 0; v < vertices; v++) j->step[v] = vec3_mad(j->step[v], j->per_n[v], -pressure);
  return true;
}

/* Six times the volume with the vertices there, less that as they are. */
static double volume_change(const scree_halfmesh *s, const vec3 *places) {
  double sum = 0;
  for (uint32_t t = 0; t < s->triangle_count; t++) {
    vec3 at[3], to[3];
    if (scree_is_gone(s, t)) continue;
    scree_corners(s, t, at);
    for (size_t i = 0; i < 3; i++) to[i] = places[s->half[3 * t + i].from];
    sum += vec3_dot(to[0], vec3_cross(to[1], to[2])) - vec3_dot(at[0], vec3_cross(at[1], at[2]));
  }
  return sum;
}

void scree_joint_places(const scree_joint *j, const scree_halfmesh *s, vec3 *places) {
  for (size_t v = 0; v < s->vertex_count; v++)
    places[v] = j->free[v] ? vec3_add(s->vertex[v].at, j->step[v]) : s->vertex[v].at;
  for (int k = 0; k < VOLUME_ROUNDS; k++) {
    double pressure = -volume_change(s, places) / j->n_per_n;
    for (size_t v = 0; v < s->vertex_count; v++)
      if (j->free[v]) places[v] = vec3_mad(places[v], j->per_n[v], pressure);
  }
}
