/* Exact orientation signs by floating-point expansions.
 *
 * A number is kept as an unevaluated sum of doubles of increasing magnitude that do not overlap, so
 * its sign is that of the last one. Sums and products of such expansions are exact (Shewchuk 1997,
 * theorems 7 (two-sum), 13 (fast expansion sum), 18 (two-product), 19 (scaling)); components that
 * come out zero are dropped on the way.
 *
 * Differs from the paper: there is one exact stage behind the filter instead of three adaptive
 * ones. It works on coordinate differences, whose rounding errors are mostly zero for points that
 * lie close together; dropping zeros then makes the expansions short and the stage cheap by itself.
 */
#include "mesh/predicates.h"

#include "base/exact.h"

/* h = e + f, zeros dropped; h must not alias e or f. Returns the length, at least 1. */
static int expansion_sum(int e_count, const double *e, int f_count, const double *f, double *h) {
  int i = 0, j = 0, count = 0;
  double sum = 0, error;
  while (i < e_count || j < f_count) {
    /* merged by magnitude */
    bool take_e = j >= f_count || (i < e_count && fabs(e[i]) < fabs(f[j]));
    double next = take_e ? e[i++] : f[j++];
    scree_two_sum(sum, next, &sum, &error);
    if (error != 0) h[count++] = error;
  }
  if (sum != 0 || count == 0) h[count++] = sum;
  return count;
}

/* h = b e, zeros dropped. */
static int expansion_scale(int e_count, const double *e, double b, double *h) {
  int count = 0;
  double sum, error;
  scree_two_product(e[0], b, &sum, &error);
  if (error != 0) h[count++] = error;
  for (int i = 1; i < e_count; i++) {
    double high, low;
    scree_two_product(e[i], b, &high, &low);
    scree_two_sum(sum, low, &sum, &error);
    if (error != 0) h[count++] = error;
    scree_quick_two_sum(high, sum, &sum, &error);
    if (error != 0) h[count++] = error;
  }
  if (sum != 0 || count == 0) h[count++] = sum;
  return count;
}

/* A coordinate difference, exact. */
typedef struct difference {
  int count;
  double part[2];
} difference;

static difference subtract(double a, double b) {
  double high, low;
  scree_two_sum(a, -b, &high, &low);
  if (low == 0) return (difference){1, {high, 0}};
  return (difference){2, {low, high}};
}

/* h = d e. */
static int expansion_times(int e_count, const double *e, difference d, double *h) {
  double low[32], high[32];
  if (d.count == 1) return expansion_scale(e_count, e, d.part[0], h);
  int low_count = expansion_scale(e_count, e, d.part[0], low);
  int high_count = expansion_scale(e_count, e, d.part[1], high);
  return expansion_sum(low_count, low, high_count, high, h);
}

/* h = a d - b c, at most 16 parts. */
static int minor(difference a, difference b, difference c, difference d, double *h) {
  double ad[8], bc[8];
  int ad_count = expansion_times(a.count, a.part, d, ad);
  int bc_count = expansion_times(b.count, b.part, c, bc);
  for (int i = 0; i < bc_count; i++) bc[i] = -bc[i];
  return expansion_sum(ad_count, ad, bc_count, bc, h);
}

static int sign_of(int count, const double *e) {
  double largest = e[count - 1];
  return (largest > 0) - (largest < 0);
}

int scree_orient2_exact(const double a[2], const double b[2], const double c[2]) {
  double det[16];
  difference ax = subtract(a[0], c[0]), ay = subtract(a[1], c[1]);
  difference bx = subtract(b[0], c[0]), by = subtract(b[1], c[1]);
  return sign_of(minor(ax, ay, bx, by, det), det);
}

/* One coordinate alike in all four points: they lie in an axis plane, as on most drawn parts. */
static bool flat_in(int k, const double *a, const double *b, const double *c, const double *d) {
  return a[k] == d[k] && b[k] == d[k] && c[k] == d[k];
}

int scree_orient3_exact(const double *a, const double *b, const double *c, const double *d) {
  if (flat_in(0, a, b, c, d) || flat_in(1, a, b, c, d) || flat_in(2, a, b, c, d)) return 0;
  difference p[3][3];
  const double *points[3] = {a, b, c};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) p[i][k] = subtract(points[i][k], d[k]);
  double term[3][64], partial[128], det[192];
  int count[3];
  for (int i = 0; i < 3; i++) {
    double m[16];
    difference *q = p[(i + 1) % 3], *r = p[(i + 2) % 3];
    int m_count = minor(q[0], q[1], r[0], r[1], m);
    count[i] = expansion_times(m_count, m, p[i][2], term[i]);
  }
  int partial_count = expansion_sum(count[0], term[0], count[1], term[1], partial);
  /* the determinant of a - d, b - d, c - d is negative where d is on the normal's side */
  return -sign_of(expansion_sum(partial_count, partial, count[2], term[2], det), det);
}
