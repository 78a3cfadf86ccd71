/* The places and costs of collapses by both methods, and what a collapse must not do. */
#include "support/oracle.h"

#include "mesh/bvh.h"
#include "mesh/intersect.h"
#include "simplify/cost.h"
#include "support/check.h"

/* What the rules name (docs/decimation.md). */
#define FLIP_COSINE  0.1
#define COARSE_FLIP  (-0.3) /* of `volume`, collapses one by one, below so many triangles */
#define COARSE_COUNT 1000
#define SLIVER_SHAPE 2e-3
#define FLAT_SHAPE   1e-10
#define FOLD_COSINE  (-0.857)
#define REACH_EDGES  4.0
#define VOLUME_PULL  1e-6
#define VOLUME_TIE   1e-9
#define VOLUME_STRAY 5.0
#define EQUAL_AREA   1e-9
#define QECD_PULL    1e-8
#define QECD_TIE     1e-12
#define QECD_SHAPE   0.3
#define QECD_MIDDLE  2e-15 /* of a surface of area 1 */

vec3 oracle_corner(const oracle *o, size_t t, size_t i) {
  return o->position[o->triangle[3 * t + i]];
}

bool oracle_has(const oracle *o, size_t t, uint32_t v) {
  const uint32_t *c = o->triangle + 3 * t;
  return c[0] == v || c[1] == v || c[2] == v;
}

vec3 oracle_area_vector(const oracle *o, size_t t) {
  return vec3_triangle_normal(oracle_corner(o, t, 0), oracle_corner(o, t, 1),
                              oracle_corner(o, t, 2));
}

void oracle_solve(double m[4][5], int n) {
  for (int i = 0; i < n; i++) {
    int pivot = i;
    for (int r = i + 1; r < n; r++)
      if (fabs(m[r][i]) > fabs(m[pivot][i])) pivot = r;
    for (int c = 0; c <= n; c++) {
      double swapped = m[i][c];
      m[i][c] = m[pivot][c];
      m[pivot][c] = swapped;
    }
    for (int r = 0; r < n; r++) {
      if (r == i) continue;
      double f = m[r][i] / m[i][i];
      for (int c = i; c <= n; c++) m[r][c] -= f * m[i][c];
    }
  }
  for (int i = 0; i < n; i++) m[i][n] /= m[i][i];
}

void oracle_add_square(double m[4][5], vec3 n, double rhs, double w) {
  double v[4] = {n.x, n.y, n.z, rhs};
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) m[i][j] += w * v[i] * v[j];
    m[i][4] += w * v[i] * v[3];
  }
}

/* ---- Method volume ---- */

/* The sum of the squared tetrahedra that the triangles of the edge sweep, each once. */
static double swept(const oracle *o, uint32_t a, uint32_t b, vec3 x) {
  double energy = 0;
  for (size_t t = 0; t < o->triangle_count; t++) {
    if (!oracle_has(o, t, a) && !oracle_has(o, t, b)) continue;
    double tetrahedron = vec3_dot(oracle_area_vector(o, t), vec3_sub(x, oracle_corner(o, t, 0)));
    energy += tetrahedron * tetrahedron;
  }
  return energy;
}

/* fallback < 0: the best place. */
static place volume_place(const oracle *o, uint32_t a, uint32_t b, int fallback) {
  static const double along[SCREE_FALLBACK_COUNT] = {0.5, 0, 1};
  place p = {.cost = INFINITY};
  vec3 pa = o->position[a], e = vec3_sub(o->position[b], pa), sum = {0, 0, 0};
  vec3 y = vec3_scale(e, fallback < 0 ? 0.5 : along[fallback]);
  double squares = 0, lengths = 0, level = 0, h[4][5] = {{0}};
  for (size_t t = 0; t < o->triangle_count; t++) {
    if (!oracle_has(o, t, a) && !oracle_has(o, t, b)) continue;
    vec3 n = oracle_area_vector(o, t);
    double d = vec3_dot(n, vec3_sub(oracle_corner(o, t, 0), pa));
    squares += vec3_norm2(n);
    lengths += vec3_norm(n);
    sum = vec3_add(sum, n);
    level += d;
    oracle_add_square(h, n, d, 1);
  }
  double norm = vec3_norm(sum), pull = VOLUME_PULL * squares;
  if (!(norm > 0 && squares > 0 && lengths > 0)) return p;
  vec3 n = vec3_scale(sum, 1 / norm);
  level /= norm;
  y = vec3_mad(y, n, level - vec3_dot(n, y));
  for (int step = 0; step < 3 && fallback < 0; step++) {
    double before[3] = {y.x, y.y, y.z}, m[4][5], unit[3] = {n.x, n.y, n.z};
    memcpy(m, h, sizeof m);
    for (int i = 0; i < 3; i++) {
      m[i][i] += pull;
      m[i][4] += pull * before[i];
      m[i][3] = m[3][i] = unit[i] * squares; /* scaled as the rest */
    }
    m[3][3] = 0;
    m[3][4] = level * squares;
    oracle_solve(m, 4);
    y = (vec3){m[0][4], m[1][4], m[2][4]};
  }
  double length2 = vec3_norm2(e);
  if (vec3_norm(vec3_mad(y, e, -0.5)) > REACH_EDGES * sqrt(length2)) return p;
  p.target = p.other = vec3_add(pa, y);
  double energy = swept(o, a, b, p.target);
  p.error = energy / squares;
  p.cost = (energy + VOLUME_TIE * squares * length2) / sqrt(lengths);
  p.slack = 1e-6 * p.cost + 1e-13 * squares * length2 / sqrt(lengths);
  p.stray = VOLUME_STRAY * sqrt(lengths);
  return p;
}

/* ---- Method qecd ---- */

static double plane_error(const oracle *o, uint32_t a, uint32_t b, vec3 x, double *trace) {
  double error = 0;
  *trace = 0;
  for (size_t t = 0; t < o->plane_count; t++) {
    double w = o->weight[t] * (o->share[a * o->plane_count + t] + o->share[b * o->plane_count + t]);
    double d = vec3_dot(o->plane[t], x) + o->offset[t];
    error += w * d * d;
    *trace += w;
  }
  return error;
}

static vec3 plane_minimum(const oracle *o, uint32_t a, uint32_t b, vec3 from, double pull) {
  double m[4][5] = {{0}};
  for (size_t t = 0; t < o->plane_count; t++) {
    double w = o->weight[t] * (o->share[a * o->plane_count + t] + o->share[b * o->plane_count + t]);
    if (w > 0) oracle_add_square(m, o->plane[t], -(vec3_dot(o->plane[t], from) + o->offset[t]), w);
  }
  for (int i = 0; i < 3; i++) {
    m[i][3] = m[i][4];
    m[i][i] += pull;
  }
  double three[4][5];
  memcpy(three, m, sizeof three);
  oracle_solve(three, 3);
  return vec3_add(from, (vec3){three[0][3], three[1][3], three[2][3]});
}

/* 2 area / longest edge^2 with the ends of the edge at x, or as they are where they are no ends. */
static double shape_at(const oracle *o, size_t t, uint32_t a, uint32_t b, const vec3 *x) {
  vec3 p[3];
  for (size_t i = 0; i < 3; i++) {
    uint32_t v = o->triangle[3 * t + i];
    p[i] = x && (v == a || v == b) ? *x : o->position[v];
  }
  double longest = fmax(vec3_norm2(vec3_sub(p[1], p[0])),
                        fmax(vec3_norm2(vec3_sub(p[2], p[1])), vec3_norm2(vec3_sub(p[0], p[2]))));
  return longest > 0 ? vec3_norm(vec3_triangle_normal(p[0], p[1], p[2])) / longest : 0;
}

static double qecd_middle(const oracle *o) {
  return QECD_MIDDLE * o->start_area * o->start_area;
}

static place qecd_place(const oracle *o, uint32_t a, uint32_t b, int fallback) {
  static const double along[SCREE_FALLBACK_COUNT] = {0.5, 0, 1};
  place p = {.cost = INFINITY};
  vec3 pa = o->position[a], pb = o->position[b], middle = vec3_scale(vec3_add(pa, pb), 0.5);
  double trace, error, worst = QECD_SHAPE;
  p.target = p.other = fallback < 0 ? middle : vec3_lerp(pa, pb, along[fallback]);
  error = plane_error(o, a, b, p.target, &trace);
  if (fallback < 0 && trace > 0) {
    vec3 x = plane_minimum(o, a, b, middle, QECD_PULL * trace);
    x = plane_minimum(o, a, b, x, QECD_PULL * trace);
    double least = plane_error(o, a, b, x, &trace), doubt = 1e-15 * trace;
    if (error > qecd_middle(o) && least < error) {
      if (error < qecd_middle(o) + doubt || least > error - doubt)
        p.other = p.target;
      else
        p.other = x;
      p.target = x;
      error = least;
    } else if (error > qecd_middle(o) - doubt) {
      p.other = x;
    }
  }
  for (size_t t = 0; t < o->triangle_count; t++)
    if (oracle_has(o, t, a) != oracle_has(o, t, b))
      worst = fmin(worst, shape_at(o, t, a, b, &p.target));
  if (!(worst > 0)) return p;
  double length2 = vec3_norm2(vec3_sub(pb, pa));
  p.error = trace > 0 ? error / trace : 0;
  p.cost = (error + QECD_TIE * trace * length2) / worst;
  p.slack = 1e-6 * p.cost + 2e-15 * trace / worst;
  return p;
}

place oracle_place_of(const oracle *o, uint32_t a, uint32_t b, int fallback) {
  return o->qecd ? qecd_place(o, a, b, fallback) : volume_place(o, a, b, fallback);
}

/* ---- What a collapse must not do ---- */

/* Exactly the two apexes are neighbours of both ends, and at least three triangles stay. */
static bool links_agree(const oracle *o, uint32_t a, uint32_t b) {
  size_t common = 0, staying = 0;
  uint8_t *next_to = calloc(o->vertex_count + 1, 1); /* never nothing (static analysis) */
  for (size_t t = 0; t < o->triangle_count; t++) {
    bool at_a = oracle_has(o, t, a), at_b = oracle_has(o, t, b);
    staying += at_a != at_b;
    for (size_t i = 0; i < 3; i++) {
      next_to[o->triangle[3 * t + i]] |= at_a ? 1 : 0;
      next_to[o->triangle[3 * t + i]] |= at_b ? 2 : 0;
    }
  }
  for (uint32_t v = 0; v < o->vertex_count; v++) common += v != a && v != b && next_to[v] == 3;
  free(next_to);
  return common == 2 && staying >= 3;
}

oracle oracle_collapsed(const oracle *o, uint32_t a, uint32_t b, vec3 x) {
  oracle n = *o;
  n.position = malloc(o->vertex_count * sizeof *n.position);
  n.triangle = malloc((3 * o->triangle_count + 1) * sizeof *n.triangle);
  memcpy(n.position, o->position, o->vertex_count * sizeof *n.position);
  n.position[a] = x;
  for (size_t t = 0; t < o->triangle_count; t++)
    for (size_t i = 0; i < 3; i++) {
      uint32_t v = o->triangle[3 * t + i];
      n.triangle[3 * t + i] = oracle_has(o, t, a) && oracle_has(o, t, b) ? 0 : v == b ? a : v;
    }
  return n;
}

bool oracle_gone(const oracle *o, size_t t) {
  return o->triangle[3 * t] == o->triangle[3 * t + 1];
}

static bool is_folded(vec3 n, vec3 m) {
  return vec3_dot(n, m) < FOLD_COSINE * vec3_norm(n) * vec3_norm(m);
}

int oracle_folds(const oracle *o, const bool *touched) {
  int count = 0;
  for (size_t t = 0; t < o->triangle_count; t++) {
    if (oracle_gone(o, t) || !touched[t]) continue;
    for (size_t u = 0; u < o->triangle_count; u++) {
      if (u == t || oracle_gone(o, u) || (touched[u] && u < t)) continue;
      int shared = 0;
      for (size_t i = 0; i < 3; i++) shared += oracle_has(o, u, o->triangle[3 * t + i]);
      if (shared == 2) count += is_folded(oracle_area_vector(o, t), oracle_area_vector(o, u));
    }
  }
  return count;
}

int oracle_meetings(const oracle *o, const bool *touched) {
  int count = 0;
  for (size_t t = 0; t < o->triangle_count; t++) {
    if (oracle_gone(o, t) || !touched[t]) continue;
    for (size_t u = 0; u < o->triangle_count; u++) {
      if (u == t || oracle_gone(o, u) || (touched[u] && u < t)) continue;
      count += scree_triangles_meet(&o->position[0].x, o->triangle + 3 * t, o->triangle + 3 * u) !=
               SCREE_MEET_NOT;
    }
  }
  return count;
}

bool oracle_triangles_stay_sound(const oracle *o, const oracle *after, uint32_t a, uint32_t b) {
  bool coarse = !o->qecd && !o->batched && o->triangle_count < COARSE_COUNT;
  double worst_before = 1, worst_after = 1, flip = coarse ? COARSE_FLIP : FLIP_COSINE;
  int flat_before = 0, flat_after = 0;
  for (size_t t = 0; t < o->triangle_count; t++) {
    if (!oracle_has(o, t, a) && !oracle_has(o, t, b)) continue;
    worst_before = fmin(worst_before, shape_at(o, t, a, b, NULL));
    flat_before += shape_at(o, t, a, b, NULL) < FLAT_SHAPE;
    if (oracle_gone(after, t)) continue;
    vec3 n = oracle_area_vector(o, t), m = oracle_area_vector(after, t);
    if (!(vec3_dot(n, m) > flip * vec3_norm(n) * vec3_norm(m))) return false;
    worst_after = fmin(worst_after, shape_at(after, t, a, b, NULL));
    flat_after += shape_at(after, t, a, b, NULL) < FLAT_SHAPE;
  }
  return (worst_after >= SLIVER_SHAPE || worst_after >= worst_before) && flat_after <= flat_before;
}

/* Of x from the box of three corners: the triangle is no nearer. */
static double box_distance2(const double *corners, vec3 x) {
  const double p[3] = {x.x, x.y, x.z};
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    double a = corners[k], b = corners[3 + k], c = corners[6 + k];
    double low = a < b ? a : b, high = a < b ? b : a;
    double below = (low < c ? low : c) - p[k], above = p[k] - (high > c ? high : c);
    double off = below > above ? below : above;
    if (off > 0) sum += off * off;
  }
  return sum;
}

/* From all triangles; most are known to be farther by their boxes (with some room for rounding). */
double oracle_start_distance2(const oracle *o, vec3 x) {
  double least = INFINITY;
  vec3 point;
  for (size_t t = 0; t < o->plane_count; t++)
    if (box_distance2(o->start + 9 * t, x) <= (1 + EQUAL_AREA) * least)
      least = fmin(least, scree_triangle_closest(o->start + 9 * t, x, &point));
  return least;
}

/* Not far from the first mesh for a level of two triangles less. */
static bool stays_near(const oracle *o, vec3 x) {
  return oracle_start_distance2(o, x) <
         STAND_OFF * STAND_OFF * o->start_area / (double)(o->triangle_count - 2);
}

bool oracle_may_collapse(const oracle *o, uint32_t a, uint32_t b, vec3 x) {
  if (!links_agree(o, a, b) || (!o->batched && !stays_near(o, x))) return false;
  oracle after = oracle_collapsed(o, a, b, x);
  bool ok = oracle_triangles_stay_sound(o, &after, a, b);
  if (ok) {
    bool *touched = calloc(o->triangle_count, sizeof *touched);
    for (size_t t = 0; t < o->triangle_count; t++)
      touched[t] = oracle_has(o, t, a) || oracle_has(o, t, b);
    ok = oracle_folds(&after, touched) <= oracle_folds(o, touched) &&
         oracle_meetings(&after, touched) <= oracle_meetings(o, touched);
    free(touched);
  }
  free(after.position);
  free(after.triangle);
  return ok;
}

/* ---- The stray ---- */

double oracle_triangle_distance2(const oracle *o, size_t t, vec3 p) {
  double corners[9];
  vec3 point;
  for (size_t i = 0; i < 3; i++) vec3_store(corners + 3 * i, oracle_corner(o, t, i));
  return scree_triangle_closest(corners, p, &point);
}

double oracle_patch_distance2(const oracle *after, uint32_t a, vec3 p, uint32_t *nearest) {
  double least = INFINITY, largest = -1;
  for (size_t t = 0; t < after->triangle_count; t++)
    if (!oracle_gone(after, t) && oracle_has(after, t, a))
      least = fmin(least, oracle_triangle_distance2(after, t, p));
  for (size_t t = 0; t < after->triangle_count; t++) {
    double area2 = vec3_norm2(oracle_area_vector(after, t));
    if (oracle_gone(after, t) || !oracle_has(after, t, a) || area2 <= (1 + EQUAL_AREA) * largest ||
        sqrt(oracle_triangle_distance2(after, t, p)) > sqrt(least) + EQUALLY_NEAR)
      continue;
    largest = area2;
    *nearest = (uint32_t)t;
  }
  return least;
}

double oracle_stray2_of(const oracle *o, uint32_t a, uint32_t b, vec3 x) {
  oracle after = oracle_collapsed(o, a, b, x);
  double worst = oracle_start_distance2(o, x);
  uint32_t nearest;
  for (size_t w = 0; w < o->vertex_count; w++) {
    if (!oracle_has(o, o->holder[w], a) && !oracle_has(o, o->holder[w], b)) continue;
    double distance2 = oracle_patch_distance2(&after, a, o->witness[w], &nearest);
    if (sqrt(distance2) > sqrt(o->held2[w]) + EQUALLY_NEAR) worst = fmax(worst, distance2);
  }
  for (size_t t = 0; t < after.triangle_count; t++)
    for (size_t i = 0; i < 3 && !oracle_gone(&after, t) && oracle_has(&after, t, a); i++)
      for (int part = 1; part < EDGE_PARTS; part++) {
        vec3 at = vec3_lerp(x, oracle_corner(&after, t, i), (double)part / EDGE_PARTS);
        worst = fmax(worst, oracle_start_distance2(o, at));
      }
  free(after.position);
  free(after.triangle);
  return worst;
}

/* ---- Doing it ---- */

void oracle_apply(oracle *o, uint32_t a, uint32_t b, vec3 x) {
  oracle after = oracle_collapsed(o, a, b, x);
  size_t kept = 0;
  for (size_t w = 0; w < o->vertex_count; w++)
    if (oracle_has(o, o->holder[w], a) || oracle_has(o, o->holder[w], b))
      o->held2[w] = oracle_patch_distance2(&after, a, o->witness[w], &o->holder[w]);
  for (size_t t = 0; t < o->triangle_count; t++) {
    if (oracle_gone(&after, t)) continue;
    for (size_t w = 0; w < o->vertex_count; w++)
      if (o->holder[w] == t) o->holder[w] = (uint32_t)kept;
    memmove(after.triangle + 3 * kept++, after.triangle + 3 * t, 3 * sizeof *after.triangle);
  }
  free(o->position);
  free(o->triangle);
  o->position = after.position;
  o->triangle = after.triangle;
  o->triangle_count = kept;
}

void oracle_apply_move(oracle *o, uint32_t v, vec3 x) {
  o->position[v] = x;
  for (size_t w = 0; w < o->vertex_count; w++)
    if (oracle_has(o, o->holder[w], v))
      o->held2[w] = oracle_patch_distance2(o, v, o->witness[w], &o->holder[w]);
}
