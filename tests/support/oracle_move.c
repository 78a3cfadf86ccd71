/* Moves after a collapse: the step that the witnesses ask for, and whether the engine was right. */
#include "support/oracle.h"

#include "mesh/bvh.h"
#include "simplify/halfmesh.h"
#include "support/check.h"

/* What the rules name (docs/decimation.md). */
#define RELAX_DAMP   0.05
#define RELAX_HALVES 3
#define FAR_SHARE    0.9

static oracle with_moved(const oracle *o, uint32_t v, vec3 x) {
  oracle n = *o;
  n.position = malloc(o->vertex_count * sizeof *n.position);
  memcpy(n.position, o->position, o->vertex_count * sizeof *n.position);
  n.position[v] = x;
  return n;
}

static bool may_move(const oracle *o, uint32_t v, vec3 x) {
  oracle after = with_moved(o, v, x);
  bool *touched = calloc(o->triangle_count, sizeof *touched);
  for (size_t t = 0; t < o->triangle_count; t++) touched[t] = oracle_has(o, t, v);
  bool ok = oracle_start_distance2(o, x) <
                STAND_OFF * STAND_OFF * o->start_area / (double)o->triangle_count &&
            oracle_triangles_stay_sound(o, &after, v, v) &&
            oracle_folds(&after, touched) <= oracle_folds(o, touched) &&
            oracle_meetings(&after, touched) <= oracle_meetings(o, touched);
  free(touched);
  free(after.position);
  return ok;
}

double oracle_off_around(const oracle *o, uint32_t v, double *worst) {
  double sum = 0, worst2 = 0;
  for (size_t w = 0; w < o->vertex_count; w++) {
    if (!oracle_has(o, o->holder[w], v)) continue;
    double distance2 = oracle_triangle_distance2(o, o->holder[w], o->witness[w]);
    for (size_t t = 0; t < o->triangle_count && o->held2[w] <= pow(EQUALLY_NEAR, 2); t++)
      if (oracle_has(o, t, v))
        distance2 = fmin(distance2, oracle_triangle_distance2(o, t, o->witness[w]));
    sum += distance2;
    worst2 = fmax(worst2, distance2);
  }
  if (!worst) return sum;
  for (size_t t = 0; t < o->triangle_count; t++)
    for (size_t i = 0; i < 3 && oracle_has(o, t, v); i++)
      for (int part = 1; part < EDGE_PARTS; part++) {
        vec3 at = vec3_lerp(o->position[v], oracle_corner(o, t, i), (double)part / EDGE_PARTS);
        worst2 = fmax(worst2, oracle_start_distance2(o, at));
      }
  *worst = sqrt(fmax(worst2, oracle_start_distance2(o, o->position[v])));
  return sum;
}

/* The step that the witnesses ask for where it is to change the volume by a sixth of this: of Gauss
 * and Newton, damped, with a multiplier for the volume. *promise: how much it should take off the
 * sum, where that is nothing; *pressure: the multiplier. False: they ask for nothing. */
static bool step_with_volume(const oracle *o, uint32_t v, double volume, vec3 *step,
                             double *promise, double *pressure) {
  double m[4][5] = {{0}}, shares = 0, rhs[3];
  vec3 sum = {0, 0, 0};
  *promise = 0;
  for (size_t t = 0; t < o->triangle_count; t++) {
    if (!oracle_has(o, t, v)) continue;
    vec3 n = oracle_area_vector(o, t), at[2];
    double corners[9];
    for (size_t i = 0, k = 0; i < 3; i++) {
      vec3_store(corners + 3 * i, oracle_corner(o, t, i));
      if (o->triangle[3 * t + i] != v) at[k++] = oracle_corner(o, t, i);
    }
    sum = vec3_add(sum, n);
    for (size_t w = 0; w < o->vertex_count; w++) {
      vec3 nearest;
      if (o->holder[w] != t) continue;
      double distance = sqrt(scree_triangle_closest(corners, o->witness[w], &nearest));
      if (distance <= EQUALLY_NEAR) continue;
      double share = vec3_norm(vec3_triangle_normal(nearest, at[0], at[1])) /
                     vec3_norm(oracle_area_vector(o, t));
      vec3 g = vec3_scale(vec3_sub(o->witness[w], nearest), share / distance);
      oracle_add_square(m, g, distance, 1);
      shares += share * share;
    }
  }
  *step = (vec3){0, 0, 0};
  if (!(shares > 0)) return false;
  double unit[3] = {sum.x, sum.y, sum.z}, norm = vec3_norm(sum);
  for (int i = 0; i < 3; i++) {
    rhs[i] = m[i][4];
    m[i][i] += RELAX_DAMP * shares;
    m[i][3] = m[3][i] = unit[i] / norm * shares; /* scaled as the rest */
  }
  m[3][4] = volume / norm * shares;
  oracle_solve(m, 4);
  for (int i = 0; i < 3; i++) *promise += rhs[i] * m[i][4];
  *pressure = m[3][4] * shares / norm;
  *step = (vec3){m[0][4], m[1][4], m[2][4]};
  return true;
}

void oracle_check_move(const oracle *o, uint32_t v, const vec3 *x) {
  double promise, pressure, worst, share = 1;
  vec3 step;
  step_with_volume(o, v, 0, &step, &promise, &pressure);
  double sum = oracle_off_around(o, v, &worst);
  worst = fmax(worst, o->farthest);
  if (promise <= (1 - 1e-6) * RELAX_GAIN * sum || !(promise > 0)) {
    if (x) fail_msg("vertex %u moved for %g of %g", v, promise, sum);
    return;
  }
  bool sure = promise > (1 + 1e-6) * RELAX_GAIN * sum;
  for (int k = 0; k < RELAX_HALVES; k++, share /= 2) {
    vec3 y = vec3_mad(o->position[v], step, share);
    bool here = x && vec3_norm(vec3_sub(*x, y)) <= 1e-6;
    oracle after = with_moved(o, v, here ? *x : y);
    double worst_after, sum_after = oracle_off_around(&after, v, &worst_after);
    double gain = (1 - RELAX_GAIN) * sum - sum_after, past = worst + EQUALLY_NEAR - worst_after;
    free(after.position);
    bool gains = gain > -1e-6 * sum && past > -EQUALLY_NEAR / 2;
    sure &= fabs(gain) > 1e-6 * sum && fabs(past) > EQUALLY_NEAR / 2;
    if (here && gains && may_move(o, v, *x)) return;
    if (here || (sure && gains && may_move(o, v, y)))
      fail_msg("vertex %u, share %g: %s", v, share, here ? "moved, not allowed" : "not moved");
  }
  if (x) fail_msg("vertex %u moved to no share of its step", v);
}

static bool are_neighbours(const oracle *o, uint32_t v, uint32_t w) {
  for (size_t t = 0; t < o->triangle_count; t++)
    if (oracle_has(o, t, v) && oracle_has(o, t, w)) return true;
  return false;
}

bool oracle_find_pair(const oracle *o, uint32_t v, uint32_t w, pair *p) {
  double promise, at_rest[2], moved[2], unit = 1e-3;
  *p = (pair){.v = {v, w}};
  if (v == w || are_neighbours(o, v, w)) return false;
  for (int k = 0; k < 2; k++) {
    if (!step_with_volume(o, p->v[k], 0, &p->step[k], &promise, &at_rest[k])) return false;
    step_with_volume(o, p->v[k], unit, &p->step[k], &promise, &moved[k]);
    p->sum += oracle_off_around(o, p->v[k], NULL);
  }
  double falls = (at_rest[0] - moved[0] + at_rest[1] - moved[1]) / unit;
  double volume = (at_rest[0] - at_rest[1]) / falls;
  step_with_volume(o, v, volume, &p->step[0], &promise, &moved[0]);
  step_with_volume(o, w, -volume, &p->step[1], &promise, &moved[1]);
  p->gain = (at_rest[0] - at_rest[1]) * volume;
  return true;
}

/* The pair's places at this share; the first may move, then the second. */
static bool pair_may_move(const oracle *o, const pair *p, double share, int first) {
  uint32_t v = p->v[first], w = p->v[1 - first];
  vec3 x = vec3_mad(o->position[v], p->step[first], share),
       y = vec3_mad(o->position[w], p->step[1 - first], share);
  oracle after = with_moved(o, v, x);
  bool ok = may_move(o, v, x) && may_move(&after, w, y);
  free(after.position);
  return ok;
}

/* By how much more than needed the sum falls, and the farthest place is nearer than `before`. */
static void pair_margins(const oracle *o, const pair *p, double share, double before, double *gain,
                         double *past) {
  double sum = 0, worst = 0;
  for (int k = 0; k < 2; k++) {
    uint32_t v = p->v[k];
    double worst_of;
    oracle after = with_moved(o, v, vec3_mad(o->position[v], p->step[k], share));
    sum += oracle_off_around(&after, v, &worst_of);
    worst = fmax(worst, worst_of);
    free(after.position);
  }
  *gain = (1 - RELAX_GAIN) * p->sum - sum;
  *past = before + EQUALLY_NEAR - worst;
}

void oracle_check_pair(const oracle *o, const pair *p, bool sure, const vec3 *x) {
  double share = 1, gain, past, worst[2];
  for (int k = 0; k < 2; k++) oracle_off_around(o, p->v[k], &worst[k]);
  double before = fmax(o->farthest, fmax(worst[0], worst[1]));
  for (int k = 0; k < RELAX_HALVES; k++, share /= 2) {
    bool here = x != NULL;
    for (int i = 0; i < 2 && here; i++)
      here = vec3_distance(x[i], vec3_mad(o->position[p->v[i]], p->step[i], share)) <= 1e-6;
    pair_margins(o, p, share, before, &gain, &past);
    bool gains = gain > -1e-6 * p->sum && past > -EQUALLY_NEAR / 2;
    sure &= fabs(gain) > 1e-6 * p->sum && fabs(past) > EQUALLY_NEAR / 2;
    if (here && gains && pair_may_move(o, p, share, 0)) return;
    if (here || (sure && gains && pair_may_move(o, p, share, 0) && pair_may_move(o, p, share, 1)))
      fail_msg("vertices %u and %u, share %g: %s", p->v[0], p->v[1], share,
               here ? "moved, not allowed" : "not moved");
  }
  if (x) fail_msg("vertices %u and %u moved to no share of their steps", p->v[0], p->v[1]);
}

pair oracle_best_pair(const oracle *o, uint32_t a, double *second) {
  pair best = {.gain = 0}, p;
  uint32_t *about = malloc(o->vertex_count * sizeof *about), count = 0;
  *second = 0;
  for (uint32_t v = 0; v < o->vertex_count; v++)
    if (are_neighbours(o, v, a)) about[count++] = v; /* a as well */
  for (uint32_t i = 0; i < count; i++)
    for (uint32_t j = 0; j < i; j++) {
      if (!oracle_find_pair(o, about[i], about[j], &p) ||
          !(p.gain > (1 - 1e-6) * RELAX_GAIN * p.sum))
        continue;
      *second = fmax(*second, fmin(p.gain, best.gain));
      if (p.gain > best.gain) best = p;
    }
  free(about);
  return best;
}

uint32_t oracle_beyond_side(const oracle *o, uint32_t v, uint32_t w) {
  for (size_t h = 0; h < 3 * o->triangle_count; h++)
    if (o->triangle[h] == v && o->triangle[h % 3 == 2 ? h - 2 : h + 1] == w)
      return o->triangle[h % 3 == 0 ? h + 2 : h - 1];
  return SCREE_NONE;
}

uint32_t oracle_farthest_neighbour(const oracle *o, uint32_t v, bool *alone) {
  uint32_t farthest = v;
  double most = 0, second = 0;
  for (size_t h = 0; h < 3 * o->triangle_count; h++) {
    uint32_t w = o->triangle[h];
    if (w == v || w == farthest || !oracle_has(o, h / 3, v)) continue;
    double distance = vec3_distance(o->position[w], o->position[v]);
    second = fmax(second, fmin(distance, most));
    if (distance > most) farthest = w;
    most = fmax(most, distance);
  }
  *alone = second < (1 - 1e-9) * most;
  return farthest;
}

void oracle_renew_farthest(oracle *o) {
  if (o->triangle_count > o->far_at) return;
  o->farthest = oracle_farthest(o);
  o->far_at = (size_t)(FAR_SHARE * (double)o->triangle_count);
}

bool oracle_find_move(const oracle *o, uint32_t v, vec3 *x, bool *sure) {
  double promise, pressure, worst, share = 1;
  vec3 step;
  step_with_volume(o, v, 0, &step, &promise, &pressure);
  double sum = oracle_off_around(o, v, &worst), least = RELAX_GAIN * sum;
  worst = fmax(worst, o->farthest);
  if (!(promise > 0)) return false;
  *sure &= fabs(promise - least) > 1e-6 * sum;
  for (int k = 0; k < RELAX_HALVES && promise > least; k++, share /= 2) {
    *x = vec3_mad(o->position[v], step, share);
    oracle after = with_moved(o, v, *x);
    double worst_after, gain = sum - least - oracle_off_around(&after, v, &worst_after);
    double past = worst + EQUALLY_NEAR - worst_after;
    free(after.position);
    *sure &= fabs(gain) > 1e-6 * sum && fabs(past) > EQUALLY_NEAR / 2;
    if (gain > 0 && past > 0 && may_move(o, v, *x)) return true;
  }
  return false;
}

bool oracle_find_exchange(const oracle *o, uint32_t a, pair *p, vec3 *x, bool *sure) {
  double second, share = 1, gain, past, worst[2];
  *p = oracle_best_pair(o, a, &second);
  if (!(p->gain > 0)) return false;
  *sure &= p->gain > (1 + 1e-6) * RELAX_GAIN * p->sum && second < (1 - 1e-6) * p->gain;
  for (int k = 0; k < 2; k++) oracle_off_around(o, p->v[k], &worst[k]);
  double before = fmax(o->farthest, fmax(worst[0], worst[1]));
  for (int k = 0; k < RELAX_HALVES; k++, share /= 2) {
    pair_margins(o, p, share, before, &gain, &past);
    *sure &= fabs(gain) > 1e-6 * p->sum && fabs(past) > EQUALLY_NEAR / 2;
    if (!(gain > 0 && past > 0)) continue;
    bool one = pair_may_move(o, p, share, 0), other = pair_may_move(o, p, share, 1);
    *sure &= one == other; /* which of them is first is the engine's to say */
    for (int i = 0; i < 2; i++) x[i] = vec3_mad(o->position[p->v[i]], p->step[i], share);
    if (one) return true;
  }
  return false;
}
