/* Looking ahead: how good the level is that a collapse makes, alone and with the moves after it. */
#include "support/check.h"
#include "support/oracle.h"

static oracle copy_of(const oracle *o) {
  oracle n = *o;
  n.position = malloc(o->vertex_count * sizeof *n.position);
  n.triangle = malloc((3 * o->triangle_count + 1) * sizeof *n.triangle);
  n.holder = malloc(o->vertex_count * sizeof *n.holder);
  n.held2 = malloc(o->vertex_count * sizeof *n.held2);
  memcpy(n.position, o->position, o->vertex_count * sizeof *n.position);
  memcpy(n.triangle, o->triangle, 3 * o->triangle_count * sizeof *n.triangle);
  memcpy(n.holder, o->holder, o->vertex_count * sizeof *n.holder);
  memcpy(n.held2, o->held2, o->vertex_count * sizeof *n.held2);
  return n;
}

static void free_copy(oracle *n) {
  free(n->position);
  free(n->triangle);
  free(n->holder);
  free(n->held2);
}

double oracle_farthest(const oracle *o) {
  double worst2 = 0;
  for (size_t w = 0; w < o->vertex_count; w++) worst2 = fmax(worst2, o->held2[w]);
  for (size_t h = 0; h < 3 * o->triangle_count; h++) {
    vec3 at = o->position[o->triangle[h]],
         to = o->position[o->triangle[h % 3 == 2 ? h - 2 : h + 1]];
    for (int part = 0; part < EDGE_PARTS; part++)
      worst2 =
          fmax(worst2, oracle_start_distance2(o, vec3_lerp(at, to, (double)part / EDGE_PARTS)));
  }
  return sqrt(worst2);
}

/* The survivor a, then its neighbours, counter-clockwise from the farthest; at last two of them. */
static void move_around(oracle *n, uint32_t a, bool *sure) {
  vec3 x[2];
  pair p;
  bool alone;
  if (oracle_find_move(n, a, x, sure)) oracle_apply_move(n, a, x[0]);
  uint32_t first = oracle_farthest_neighbour(n, a, &alone), v = first;
  *sure &= alone;
  do {
    if (oracle_find_move(n, v, x, sure)) oracle_apply_move(n, v, x[0]);
    v = oracle_beyond_side(n, a, v);
  } while (v != first);
  if (oracle_find_exchange(n, a, &p, x, sure))
    for (int k = 0; k < 2; k++) oracle_apply_move(n, p.v[k], x[k]);
}

static double score_of(const oracle *n, double farthest) {
  double mean = 0;
  for (size_t w = 0; w < n->vertex_count; w++) mean += sqrt(n->held2[w]) / (double)n->vertex_count;
  return fmax(mean, EQUALLY_NEAR) * cbrt(fmax(farthest, EQUALLY_NEAR));
}

double oracle_score_alone(const oracle *o, uint32_t a, uint32_t b, vec3 x) {
  oracle n = copy_of(o);
  double worst2 = pow(o->farthest, 2);
  oracle_apply(&n, a, b, x);
  for (size_t w = 0; w < n.vertex_count; w++)
    if (oracle_has(&n, n.holder[w], a)) worst2 = fmax(worst2, n.held2[w]);
  for (size_t t = 0; t < n.triangle_count; t++)
    for (size_t i = 0; i < 3 && oracle_has(&n, t, a); i++)
      for (int part = 0; part < EDGE_PARTS; part++) {
        vec3 at = vec3_lerp(x, oracle_corner(&n, t, i), (double)part / EDGE_PARTS);
        worst2 = fmax(worst2, oracle_start_distance2(o, at));
      }
  double score = score_of(&n, sqrt(worst2));
  free_copy(&n);
  return score;
}

double oracle_score_after(const oracle *o, uint32_t a, uint32_t b, vec3 x, bool *sure) {
  oracle n = copy_of(o);
  *sure = true;
  oracle_apply(&n, a, b, x);
  oracle_renew_farthest(&n);
  move_around(&n, a, sure);
  double score = score_of(&n, oracle_farthest(&n));
  free_copy(&n);
  return score;
}
