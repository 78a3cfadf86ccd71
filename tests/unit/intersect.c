/* Triangle-triangle classification against an oracle that intersects small integer triangles in
 * floating point with a tolerance far below the smallest distance such triangles can have, then the
 * same pairs under exact integer affine maps that blow the filters. */
#include "mesh/index/intersect.h"
#include "base/rng.h"
#include "base/vec.h"
#include "support/check.h"

#define TINY 1e-9

typedef struct case_pair {
  double positions[18];
  uint32_t t[3], u[3];
} case_pair;

static vec3 corner(const case_pair *c, const uint32_t *t, int i) {
  return vec3_load(c->positions + 3 * t[i % 3]);
}

/* ---- The oracle ---- */

static bool in_triangle(const case_pair *c, const uint32_t *t, vec3 p) {
  vec3 n = vec3_triangle_normal(corner(c, t, 0), corner(c, t, 1), corner(c, t, 2));
  for (int i = 0; i < 3; i++) {
    vec3 a = corner(c, t, i), b = corner(c, t, i + 1);
    if (vec3_dot(vec3_cross(vec3_sub(b, a), vec3_sub(p, a)), n) < -TINY) return false;
  }
  return fabs(vec3_dot(n, vec3_sub(p, corner(c, t, 0)))) < TINY;
}

typedef struct point_set {
  vec3 items[64];
  int count;
} point_set;

static void add_point(point_set *set, vec3 p) {
  for (int i = 0; i < set->count; i++)
    if (vec3_distance(set->items[i], p) < TINY) return;
  set->items[set->count++] = p;
}

/* Where the edges of t pass through the plane of u, or end on it, or cross u's edges in the plane;
 * only points in both. */
static void edge_points(const case_pair *c, const uint32_t *t, const uint32_t *u, point_set *set) {
  vec3 n = vec3_triangle_normal(corner(c, u, 0), corner(c, u, 1), corner(c, u, 2));
  for (int i = 0; i < 3; i++) {
    vec3 a = corner(c, t, i), b = corner(c, t, i + 1);
    double da = vec3_dot(n, vec3_sub(a, corner(c, u, 0)));
    double db = vec3_dot(n, vec3_sub(b, corner(c, u, 0)));
    if (in_triangle(c, u, a)) add_point(set, a);
    if (da * db < 0) {
      vec3 p = vec3_lerp(a, b, da / (da - db));
      if (in_triangle(c, u, p)) add_point(set, p);
    }
    for (int j = 0; j < 3 && da == 0 && db == 0; j++) {
      vec3 e = vec3_sub(b, a), f0 = corner(c, u, j), f = vec3_sub(corner(c, u, j + 1), f0);
      vec3 ef = vec3_cross(e, f);
      double size = vec3_norm2(ef);
      if (size < TINY) continue;
      double s = vec3_dot(vec3_cross(vec3_sub(f0, a), f), ef) / size;
      double r = vec3_dot(vec3_cross(vec3_sub(f0, a), e), ef) / size;
      if (s > -TINY && s < 1 + TINY && r > -TINY && r < 1 + TINY) add_point(set, vec3_mad(a, e, s));
    }
  }
}

static bool on_shared(const case_pair *c, int shared, vec3 p) {
  if (shared == 0) return false;
  vec3 a = corner(c, c->t, 0);
  if (shared == 1) return vec3_distance(a, p) < TINY;
  vec3 b = corner(c, c->t, 1);
  return fabs(vec3_distance(a, p) + vec3_distance(b, p) - vec3_distance(a, b)) < TINY;
}

/* Strictly on both sides of the plane. */
static bool passes(const case_pair *c, const uint32_t *t, const uint32_t *u) {
  vec3 n = vec3_triangle_normal(corner(c, u, 0), corner(c, u, 1), corner(c, u, 2));
  bool above = false, below = false;
  for (int i = 0; i < 3; i++) {
    double d = vec3_dot(n, vec3_sub(corner(c, t, i), corner(c, u, 0)));
    above |= d > 0;
    below |= d < 0;
  }
  return above && below;
}

static double common_area(const point_set *set) {
  double most = 0;
  for (int i = 0; i < set->count; i++)
    for (int j = 0; j < i; j++)
      for (int k = 0; k < j; k++)
        most = fmax(most,
                    vec3_norm(vec3_triangle_normal(set->items[i], set->items[j], set->items[k])));
  return most;
}

static bool no_area(const case_pair *c, const uint32_t *t) {
  return vec3_norm(vec3_triangle_normal(corner(c, t, 0), corner(c, t, 1), corner(c, t, 2))) < TINY;
}

/* The first `shared` corners of t and u are the same vertices. */
static scree_meet oracle(const case_pair *c, int shared) {
  if (no_area(c, c->t) || no_area(c, c->u)) return SCREE_MEET_NOT;
  point_set set = {.count = 0};
  edge_points(c, c->t, c->u, &set);
  edge_points(c, c->u, c->t, &set);
  int beyond = 0;
  for (int i = 0; i < set.count; i++) beyond += !on_shared(c, shared, set.items[i]);
  if (beyond == 0) return SCREE_MEET_NOT;
  if (common_area(&set) > TINY) return SCREE_MEET_OVERLAP;
  bool cross = passes(c, c->t, c->u) && passes(c, c->u, c->t) && set.count >= 2;
  return cross ? SCREE_MEET_CROSS : SCREE_MEET_TOUCH;
}

/* ---- Pairs ---- */

static void random_pair(scree_rng *rng, int shared, int range, bool flat, case_pair *c) {
  for (int i = 0; i < 18; i++) {
    c->positions[i] = (double)scree_rng_below(rng, (uint64_t)range);
    if (flat && i % 3 == 2) c->positions[i] = c->positions[i - 1] - c->positions[i - 2];
  }
  for (uint32_t i = 0; i < 3; i++) {
    c->t[i] = i;
    c->u[i] = (int)i < shared ? i : i + 3;
  }
}

/* A different vertex at the same place is not a shared one: the oracle knows no such pairs only
 * because it compares indices too. */
static scree_meet shuffled(scree_rng *rng, const case_pair *c) {
  uint32_t t[3], u[3], r = (uint32_t)scree_rng_below(rng, 3), s = (uint32_t)scree_rng_below(rng, 3);
  bool flip = scree_rng_below(rng, 2), exchange = scree_rng_below(rng, 2);
  for (uint32_t i = 0; i < 3; i++) {
    t[i] = c->t[(i + r) % 3];
    u[i] = c->u[(flip ? 3 - i + s : i + s) % 3];
  }
  return exchange ? scree_triangles_meet(c->positions, u, t)
                  : scree_triangles_meet(c->positions, t, u);
}

/* x -> A x + b, with large integers; every value stays an exact double. */
static void affine(scree_rng *rng, case_pair *c) {
  double a[3][3], b[3];
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) a[i][j] = (double)scree_rng_below(rng, 2001) - 1000;
    a[i][i] += 3000;
    b[i] = ldexp((double)scree_rng_below(rng, 1024), 40);
  }
  for (int v = 0; v < 6; v++) {
    double p[3] = {c->positions[3 * v], c->positions[3 * v + 1], c->positions[3 * v + 2]};
    for (int i = 0; i < 3; i++)
      c->positions[3 * v + i] = a[i][0] * p[0] + a[i][1] * p[1] + a[i][2] * p[2] + b[i];
  }
}

static void check_pairs(int shared, int range, bool flat, uint64_t seed) {
  scree_rng rng = {.seed = seed, .stream = (uint64_t)shared};
  int seen[4] = {0};
  for (int n = 0; n < 30000; n++) {
    case_pair c;
    random_pair(&rng, shared, range, flat, &c);
    scree_meet expected = oracle(&c, shared);
    seen[expected]++;
    for (int variant = 0; variant < 2; variant++) {
      scree_meet got = shuffled(&rng, &c);
      if (got != expected) {
        for (int v = 0; v < 6; v++)
          print_error("%g %g %g\n", c.positions[3 * v], c.positions[3 * v + 1],
                      c.positions[3 * v + 2]);
        print_error("shared %d, variant %d: got %d, expected %d\n", shared, variant, (int)got,
                    (int)expected);
        fail();
      }
      affine(&rng, &c);
    }
  }
  assert_true(seen[SCREE_MEET_NOT] > 100);
  if (shared < 2) assert_true(seen[SCREE_MEET_TOUCH] > 100);
  if (shared < 2 && !flat) assert_true(seen[SCREE_MEET_CROSS] > 100);
  if (flat) assert_true(seen[SCREE_MEET_OVERLAP] > 100);
}

static void against_oracle(void **state) {
  (void)state;
  for (int shared = 0; shared <= 3; shared++) {
    if (shared < 3) check_pairs(shared, 4, false, 21);
    if (shared < 3) check_pairs(shared, 7, false, 22);
  }
  for (int shared = 0; shared <= 2; shared++) check_pairs(shared, 4, true, 23);
}

/* The interval test has no random case that touches only in exactly one crossing of edges. */
static void known_pairs(void **state) {
  (void)state;
  double p[] = {0, 0, 0,  4, 0, 0, 0, 4, 0, /* t */
                1, 1, -1, 1, 1, 1, 5, 5, 0 /* pierces it */};
  uint32_t t[] = {0, 1, 2}, u[] = {3, 4, 5}, same[] = {2, 1, 0};
  assert_int_equal(scree_triangles_meet(p, t, u), SCREE_MEET_CROSS);
  assert_int_equal(scree_triangles_meet(p, t, same), SCREE_MEET_OVERLAP);
  p[9] = p[10] = p[12] = p[13] = 2; /* now an edge crosses an edge */
  assert_int_equal(scree_triangles_meet(p, t, u), SCREE_MEET_TOUCH);
  p[9] = p[10] = p[12] = p[13] = nextafter(2, 3);
  assert_int_equal(scree_triangles_meet(p, t, u), SCREE_MEET_NOT);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(against_oracle),
                                     cmocka_unit_test(known_pairs)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
