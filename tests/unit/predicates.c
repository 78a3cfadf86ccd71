/* Orientation signs against integer arithmetic of 512 bits, on random and on nearly degenerate
 * points. */
#include "mesh/predicates.h"
#include "base/rng.h"
#include "support/check.h"

/* Two's complement, least significant limb first. */
enum { LIMBS = 16 };
typedef struct wide {
  uint32_t limb[LIMBS];
} wide;

static wide wide_from(double x, int shift) {
  /* x * 2^shift must be an integer */
  wide w;
  int exponent;
  double fraction = frexp(fabs(x), &exponent);
  uint64_t bits = (uint64_t)ldexp(fraction, 53);
  int up = exponent - 53 + shift;
  memset(&w, 0, sizeof w);
  if (x == 0) return w;
  assert_true(up >= 0 || (bits & ((1ull << -up) - 1)) == 0);
  if (up < 0) bits >>= -up, up = 0;
  for (int i = 0; i < 64; i++)
    if (bits >> i & 1) w.limb[(i + up) / 32] |= 1u << ((i + up) % 32);
  if (x > 0) return w;
  wide n = {{0}};
  int64_t borrow = 0;
  for (int i = 0; i < LIMBS; i++) {
    int64_t d = -(int64_t)w.limb[i] + borrow;
    n.limb[i] = (uint32_t)d;
    borrow = d < 0 ? -1 : 0;
  }
  return n;
}

static wide wide_add(wide a, wide b, bool subtract) {
  wide sum;
  int64_t carry = 0;
  for (int i = 0; i < LIMBS; i++) {
    int64_t s = (int64_t)a.limb[i] + (subtract ? -(int64_t)b.limb[i] : (int64_t)b.limb[i]) + carry;
    sum.limb[i] = (uint32_t)s;
    carry = s >> 32;
  }
  return sum;
}

static wide wide_times(wide a, wide b) {
  wide product = {{0}};
  for (int i = 0; i < LIMBS; i++) {
    uint64_t carry = 0;
    for (int j = 0; i + j < LIMBS; j++) {
      uint64_t s = (uint64_t)a.limb[i] * b.limb[j] + product.limb[i + j] + carry;
      product.limb[i + j] = (uint32_t)s;
      carry = s >> 32;
    }
  }
  return product;
}

static int wide_sign(wide a) {
  if (a.limb[LIMBS - 1] >> 31) return -1;
  for (int i = 0; i < LIMBS; i++)
    if (a.limb[i]) return 1;
  return 0;
}

static int oracle2(const double *a, const double *b, const double *c, int shift) {
  wide d[2][2];
  for (int k = 0; k < 2; k++) {
    d[0][k] = wide_add(wide_from(a[k], shift), wide_from(c[k], shift), true);
    d[1][k] = wide_add(wide_from(b[k], shift), wide_from(c[k], shift), true);
  }
  return wide_sign(wide_add(wide_times(d[0][0], d[1][1]), wide_times(d[0][1], d[1][0]), true));
}

static int oracle3(const double *const p[4], int shift) {
  wide d[3][3], det = {{0}};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      d[i][k] = wide_add(wide_from(p[i + 1][k], shift), wide_from(p[0][k], shift), true);
  for (int k = 0; k < 3; k++) {
    wide m = wide_add(wide_times(d[0][(k + 1) % 3], d[1][(k + 2) % 3]),
                      wide_times(d[0][(k + 2) % 3], d[1][(k + 1) % 3]), true);
    det = wide_add(det, wide_times(m, d[2][k]), false);
  }
  return wide_sign(det);
}

static int filtered_count, exact_zero_count;

static void compare(const double *const p[4], int shift) {
  int expected = oracle3(p, shift);
  assert_int_equal(scree_orient3(p[0], p[1], p[2], p[3]), expected);
  assert_int_equal(scree_orient3(p[1], p[0], p[2], p[3]), -expected);
  assert_int_equal(scree_orient3_exact(p[0], p[1], p[2], p[3]), expected);
  int sure = scree_orient3_sure(p[0], p[1], p[2], p[3]);
  assert_true(sure == 0 || sure == expected);
  filtered_count += sure != 0;
  exact_zero_count += expected == 0;
  int expected2 = oracle2(p[0], p[1], p[2], shift);
  assert_int_equal(scree_orient2(p[0], p[1], p[2]), expected2);
  assert_int_equal(scree_orient2_exact(p[0], p[1], p[2]), expected2);
}

/* Rounded to multiples of 2^-60 so that the oracle's integers hold them. */
static double grid(double x) {
  return ldexp(nearbyint(ldexp(x, 40)), -40) + ldexp((double)(int)(x * 1e6) * 7, -60);
}

static void random_points(void **state) {
  (void)state;
  scree_rng rng = {.seed = 11};
  for (int n = 0; n < 20000; n++) {
    double q[4][3];
    for (int i = 0; i < 12; i++) q[i / 3][i % 3] = grid(scree_rng_uniform(&rng) * 4 - 2);
    const double *p[4] = {q[0], q[1], q[2], q[3]};
    compare(p, 110);
  }
  assert_true(filtered_count > 19900);
}

/* A fourth point (and a third) computed to lie in the plane (on the line), then nudged by a few
 * units in the last place. */
static void nearly_flat(void **state) {
  (void)state;
  scree_rng rng = {.seed = 12};
  filtered_count = exact_zero_count = 0;
  for (int n = 0; n < 20000; n++) {
    double q[4][3], s = scree_rng_uniform(&rng), t = scree_rng_uniform(&rng);
    double offset = n % 3 == 0 ? 1000 : 0;
    for (int i = 0; i < 9; i++) q[i / 3][i % 3] = grid(scree_rng_uniform(&rng)) + offset;
    if (n % 2)
      for (int k = 0; k < 3; k++) q[2][k] = q[0][k] + s * (q[1][k] - q[0][k]);
    if (n % 5 == 0)
      for (int k = 0; k < 3; k++) q[1][k] = q[0][k] + ldexp(q[0][k] - offset, -20);
    for (int k = 0; k < 3; k++)
      q[3][k] = q[0][k] + s * (q[1][k] - q[0][k]) + t * (q[2][k] - q[0][k]);
    for (int nudge = (int)scree_rng_below(&rng, 3); nudge; nudge--) {
      double *c = &q[2 + scree_rng_below(&rng, 2)][scree_rng_below(&rng, 3)];
      *c = nextafter(*c, scree_rng_uniform(&rng) < 0.5 ? -1e9 : 1e9);
    }
    const double *p[4] = {q[0], q[1], q[2], q[3]};
    compare(p, 110);
  }
  /* the inputs are what they are meant to be: mostly beyond the filter */
  assert_true(filtered_count < 5000);
}

static void small_integers(void **state) {
  (void)state;
  scree_rng rng = {.seed = 13};
  filtered_count = exact_zero_count = 0;
  for (int n = 0; n < 20000; n++) {
    double q[4][3], scale = ldexp(1, (int)scree_rng_below(&rng, 60) - 30);
    for (int i = 0; i < 12; i++)
      q[i / 3][i % 3] = scale * ((double)scree_rng_below(&rng, 5) - 2 + (n % 2 ? 1e6 : 0));
    const double *p[4] = {q[0], q[1], q[2], q[3]};
    compare(p, 60);
  }
  assert_true(exact_zero_count > 2000);
}

/* The ends of the stated range: no sign is lost to underflow or overflow. */
static void range(void **state) {
  (void)state;
  double scales[] = {SCREE_EXACT_MIN, 1e-30, 1, 1e30, SCREE_EXACT_MAX};
  for (int i = 0; i < 5; i++) {
    double s = scales[i];
    double a[3] = {s, 0, 0}, b[3] = {0, s, 0}, c[3] = {0, 0, s}, o[3] = {0, 0, 0};
    double near_b[3] = {0, nextafter(s, 1e300), 0}, flat[3] = {s, s, -s};
    assert_int_equal(scree_orient3(a, b, c, o), -1);
    assert_int_equal(scree_orient3(a, c, b, o), 1);
    assert_int_equal(scree_orient3(a, b, c, flat), 0);
    assert_int_equal(scree_orient3(a, near_b, c, flat),
                     oracle3((const double *[]){(double[]){1, 0, 0}, (double[]){0, 1 + 0x1p-52, 0},
                                                (double[]){0, 0, 1}, (double[]){1, 1, -1}},
                             60));
    assert_int_equal(scree_orient2(a, b, o), 1);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(random_points), cmocka_unit_test(nearly_flat),
                                     cmocka_unit_test(small_integers), cmocka_unit_test(range)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
