/* Argument reduction and polynomials of Sun's fdlibm (1993), whose coefficients these are, in plain
 * arithmetic: no fused multiply-add, no tables, no rounding modes. */
#include "base/math.h"

#include "base/exact.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static const double quarter = 7.85398163397448278999e-01, half_turn = 3.1415926535897931160e+00,
                    half_turn_rest = 1.2246467991473531772e-16, /* pi - half_turn */
    full_turn = 6.2831853071795862320e+00;
static const double reducible = 1e6; /* by three parts of pi/2 of 33 bits each */
static const double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;

static uint64_t bits_of(double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

static double of_bits(uint64_t bits) {
  double x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* 2^n, for normal results. */
static double power_of_two(int n) {
  return of_bits((uint64_t)(n + 1023) << 52);
}

/* ---- sine and cosine ---- */

/* The sine of r + rest, |r| at most pi/4. */
static double sine_near_0(double r, double rest) {
  double z = r * r, v = z * r,
         p = 8.33333333332248946124e-03 +
             z * (-1.98412698298579493134e-04 +
                  z * (2.75573137070700676789e-06 +
                       z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  return r - ((z * (0.5 * rest - v * p) - rest) - v * -1.66666666666666324348e-01);
}

static double cosine_near_0(double r, double rest) {
  double z = r * r,
         p = z *
             (4.16666666666666019037e-02 +
              z * (-1.38888888888741095749e-03 +
                   z * (2.48015872894767294178e-05 +
                        z * (-2.75573143513906633035e-07 +
                             z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  double half = 0.5 * z, w = 1 - half;
  return w + (((1 - w) - half) + (z * p - r * rest));
}

/* x modulo the full turn, exactly: every difference is of numbers within a factor of two. */
static double without_turns(double x) {
  double size = fabs(x), turns = full_turn;
  while (turns <= 0.5 * size) turns *= 2;
  for (; turns >= full_turn; turns *= 0.5)
    if (size >= turns) size -= turns;
  return x < 0 ? -size : size;
}

/* x = n pi/2 + r + rest, n modulo 4. */
static int reduce(double x, double *r, double *rest) {
  if (fabs(x) <= quarter) {
    *r = x;
    *rest = 0;
    return 0;
  }
  if (fabs(x) > reducible) x = without_turns(x);
  int n = (int)(x * 6.36619772367581382433e-01 + (x < 0 ? -0.5 : 0.5));
  double a = x - n * 1.57079632673412561417e+00, w = n * 6.07710050630396597660e-11, b = a - w;
  w = n * 2.02226624879595063154e-21 - ((a - b) - w);
  *r = b - w;
  *rest = (b - *r) - w;
  return n & 3;
}

double scree_sin(double x) {
  double r, rest;
  if (!(fabs(x) < INFINITY)) return x - x;
  int n = reduce(x, &r, &rest);
  double v = n & 1 ? cosine_near_0(r, rest) : sine_near_0(r, rest);
  return n & 2 ? -v : v;
}

double scree_cos(double x) {
  double r, rest;
  if (!(fabs(x) < INFINITY)) return x - x;
  int n = reduce(x, &r, &rest);
  double v = n & 1 ? sine_near_0(r, rest) : cosine_near_0(r, rest);
  return (n + 1) & 2 ? -v : v;
}

/* ---- arc tangent and arc cosine ---- */

/* The arc tangent of a number that is not negative: by the tangent of the difference to 0, 1/2,
 * pi/4, 3/2 or pi/2. */
static double arc_tangent(double x) {
  double base = 0, rest = 0;
  if (x >= 2.4375) {
    base = 1.57079632679489655800e+00, rest = 6.12323399573676603587e-17;
    x = -1 / x;
  } else if (x >= 1.1875) {
    base = 9.82793723247329054082e-01, rest = 1.39033110312309984516e-17;
    x = (x - 1.5) / (1 + 1.5 * x);
  } else if (x >= 0.6875) {
    base = 7.85398163397448278999e-01, rest = 3.06161699786838301793e-17;
    x = (x - 1) / (x + 1);
  } else if (x >= 0.4375) {
    base = 4.63647609000806093515e-01, rest = 2.26987774529616870924e-17;
    x = (2 * x - 1) / (2 + x);
  }
  double z = x * x, w = z * z;
  double odd =
      z * (3.33333333333329318027e-01 +
           w * (1.42857142725034663711e-01 +
                w * (9.09088713343650656196e-02 +
                     w * (6.66107313738753120669e-02 +
                          w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02)))));
  double even =
      w * (-1.99999999998764832476e-01 +
           w * (-1.11111104054623557880e-01 +
                w * (-7.69187620504482999495e-02 +
                     w * (-5.83357013379057348645e-02 + w * -3.65315727442169155270e-02))));
  double fall = x * (odd + even);
  return base > 0 ? base - ((fall - rest) - x) : x - fall;
}

double scree_atan2(double y, double x) {
  if (x != x || y != y) return x + y;
  bool left = bits_of(x) >> 63, below = bits_of(y) >> 63;
  double size_x = fabs(x), size_y = fabs(y), angle = 0;
  if (size_x == INFINITY && size_y == INFINITY)
    angle = quarter;
  else if (size_y > 0 && !(size_y / size_x < 0x1p60)) /* straight up, from either side */
    angle = 0.5 * half_turn, left = false;
  else if (size_y > 0)
    angle = arc_tangent(size_y / size_x);
  if (left) angle = half_turn - (angle - half_turn_rest);
  return below ? -angle : angle;
}

double scree_acos(double x) {
  return scree_atan2(sqrt((1 - x) * (1 + x)), x);
}

/* ---- exponential, logarithm, cube root ---- */

double scree_exp(double x) {
  if (x != x) return x;
  if (x > 709.782712893383973096) return INFINITY;
  if (x < -745.13321910194110842) return 0;
  int n = (int)(x * 1.44269504088896338700e+00 + (x < 0 ? -0.5 : 0.5));
  double high = x - n * ln2_high, low = n * ln2_low, r = high - low, z = r * r;
  double c =
      r - z * (1.66666666666666019037e-01 +
               z * (-2.77777777770155933842e-03 +
                    z * (6.61375632143793436117e-05 +
                         z * (-1.65339022054652515390e-06 + z * 4.13813679705723846039e-08))));
  double v = 1 - ((low - (r * c) / (2 - c)) - high);
  int first = n / 2; /* in two factors: one alone may overflow, or not be normal */
  return v * power_of_two(first) * power_of_two(n - first);
}

double scree_log(double x) {
  if (!(x > 0) || x == INFINITY) return x == 0 ? -INFINITY : x < 0 ? NAN : x;
  int n = 0;
  if (x < 0x1p-1022) x *= 0x1p54, n = -54;
  uint64_t bits = bits_of(x);
  n += (int)(bits >> 52) - 1023;
  double m = of_bits((bits & 0xFFFFFFFFFFFFFu) | (uint64_t)1023 << 52);
  if (m > 1.41421356237309504880) m *= 0.5, n++;
  double f = m - 1, s = f / (2 + f), z = s * s, w = z * z, half = 0.5 * f * f;
  double r = w * (3.999999999940941908e-01 +
                  w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01)) +
             z * (6.666666666666735130e-01 +
                  w * (2.857142874366239149e-01 +
                       w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  return n * ln2_high - ((half - (s * (half + r) + n * ln2_low)) - f);
}

/* Two Newton steps from the logarithm's third. */
double scree_cbrt(double x) {
  if (x == 0 || !(fabs(x) < INFINITY)) return x;
  double size = fabs(x), root = scree_exp(scree_log(size) / 3);
  for (int i = 0; i < 2; i++) root -= (root - size / (root * root)) / 3;
  return x < 0 ? -root : root;
}

/* ---- powers of ten, by numbers of twice a double's digits ---- */

typedef struct two {
  double high, low;
} two;

static two add(two a, two b) {
  double sum, error;
  scree_two_sum(a.high, b.high, &sum, &error);
  scree_quick_two_sum(sum, error + (a.low + b.low), &sum, &error);
  return (two){sum, error};
}

static two multiply(two a, two b) {
  double product, error;
  scree_two_product(a.high, b.high, &product, &error);
  scree_quick_two_sum(product, error + (a.high * b.low + a.low * b.high), &product, &error);
  return (two){product, error};
}

static two divide(two a, double b) {
  double quotient = a.high / b, product, error;
  scree_two_product(quotient, b, &product, &error);
  scree_quick_two_sum(quotient, ((a.high - product) - error + a.low) / b, &quotient, &error);
  return (two){quotient, error};
}

/* The exponential of |x| up to 1.2: the series of x/64, squared six times. */
static two exponential(two x) {
  two small = divide(x, 64), sum = {1, 0};
  for (int k = 14; k > 0; k--) sum = add((two){1, 0}, divide(multiply(small, sum), k));
  for (int i = 0; i < 6; i++) sum = multiply(sum, sum);
  return sum;
}

double scree_power_of_ten(double x) {
  static const two ln10 = {2.302585092994045901e+00, -2.170756223382249351e-16};
  double whole = floor(x + 0.5), scale = 1;
  if (!(fabs(whole) <= 22)) return x > 0 ? INFINITY : x < 0 ? 0 : NAN;
  for (int i = 0; i < fabs(whole); i++) scale *= 10; /* exact so far */
  two power = exponential(multiply((two){x - whole, 0}, ln10));
  power = whole < 0 ? divide(power, scale) : multiply(power, (two){scale, 0});
  return power.high;
}

double scree_log10(double x) {
  static const double per_ln = 0.43429448190325182765;
  double whole = floor(scree_log(x) * per_ln + 0.5);
  return whole + scree_log(x / scree_power_of_ten(whole)) * per_ln;
}
