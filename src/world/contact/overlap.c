/* The smooth maximum of overlaps (law.c has the equation). */
#include "world/contact/overlap.h"
#include "world/contact/law.h"

enum { NEWTON_STEPS = 30, CLOSED_ROUNDS = 3 };

/* Closed form. With h the highest overlap, d_i = h - o_i, x = h - t and k = kappa/(1 - kappa), the
 * features of a set all count where x > d_i, and the equation of the set is the quadratic
 *   (W - k2) x2 - 2 (D1 - k c) x + D2 - c2 = 0,   c = l0 + k (h + l0),
 * with W, D1, D2 the sums of w, w d, w d2. A set that its own root names is the solution, which is
 * unique. Features at rest lie close together, so that the first or second set is the one. False
 * when no set was found. */
static bool solve_closed(const scree_contact_point *contacts, size_t count, double l0, double k,
                         double highest, double *x, double *sum) {
  double c = l0 + k * (highest + l0), reach = INFINITY;
  for (int round = 0; round < CLOSED_ROUNDS; round++) {
    double taper = 0, first = 0, second = 0, farthest = 0, next = INFINITY;
    for (size_t i = 0; i < count; i++) {
      double d = highest - contacts[i].overlap, w = contacts[i].taper;
      if (d >= reach) {
        next = d < next ? d : next;
        continue;
      }
      taper += w;
      first += w * d;
      second += w * d * d;
      farthest = d > farthest ? d : farthest;
    }
    double a = taper - k * k, b = first - k * c, e = c * c - second, square = b * b + a * e;
    if (!(square >= 0)) {
      reach = farthest; /* far features spoil the quadratic: leave the farthest out */
      continue;
    }
    double root = sqrt(square);
    *x = b > 0 ? (b + root) / a : e / (root - b);
    if (farthest < *x && next >= *x && *x > 0) {
      *sum = taper * *x - first;
      return true;
    }
    reach = *x > 0 ? *x : farthest;
  }
  return false;
}

/* Newton from below the root, where the function is positive, falling and convex: every step stays
 * on that side. */
static void solve_by_steps(const scree_contact_point *contacts, size_t count, double l0, double k,
                           double *t, double *sum) {
  for (int step = 0; step < NEWTON_STEPS; step++) {
    double square = 0, l = l0 + k * (*t + l0);
    *sum = 0;
    for (size_t i = 0; i < count; i++) {
      double above = contacts[i].overlap - *t;
      if (above <= 0) continue;
      double weighted = contacts[i].taper * above;
      *sum += weighted;
      square += weighted * above;
    }
    double change = (square - l * l) / (2 * (*sum + l * k));
    *t += change;
    if (!(fabs(change) > 1e-15 * (l + fabs(*t)))) break;
  }
}

bool scree_solve_smooth_maximum(const scree_contact_point *contacts, size_t count, double l0,
                                double kappa, scree_smooth_maximum *result) {
  double highest = -l0, taper = 1, at_zero = 0;
  for (size_t i = 0; i < count; i++) {
    double o = contacts[i].overlap, above = o + l0;
    at_zero += contacts[i].taper * above * above;
    if (o > highest) highest = o, taper = contacts[i].taper;
  }
  if (!(at_zero > l0 * l0)) return false;
  double k = kappa / (1 - kappa), x, t, sum = 0;
  if (solve_closed(contacts, count, l0, k, highest, &x, &sum)) {
    t = highest - x;
  } else {
    t = scree_max(-l0, highest - (l0 + k * (highest + l0)) / sqrt(taper));
    solve_by_steps(contacts, count, l0, k, &t, &sum);
  }
  double m = (t + l0) / (1 - kappa), l = l0 + kappa * m;
  *result = (scree_smooth_maximum){m, t, sum * (1 - kappa) + kappa * l};
  return m > 0;
}

/* Beyond the limit l is no line in m: sum w (o - m + l)^2 = l^2, which falls in m, by Newton's
 * method between known places. */
static void widen(const scree_pair_law *law, double kappa, const scree_contact_list *contacts,
                  scree_smooth_maximum *result) {
  double low = hard_from * law->limit, high = INFINITY, m = result->value, sum = 0;
  scree_blend blend = {0};
  for (int step = 0; step < NEWTON_STEPS; step++) {
    double square = 0;
    blend = scree_blend_at(law, kappa, m);
    sum = 0;
    for (size_t i = 0; i < contacts->count; i++) {
      double above = contacts->items[i].overlap - m + blend.width;
      if (above <= 0) continue;
      double weighted = contacts->items[i].taper * above;
      sum += weighted;
      square += weighted * above;
    }
    double excess = square - blend.width * blend.width,
           next = m + 0.5 * excess / (sum * (1 - blend.slope) + blend.width * blend.slope);
    if (excess > 0) low = m;
    if (excess < 0) high = m;
    if (!(next > low && next < high)) next = high < INFINITY ? 0.5 * (low + high) : next;
    const bool found = !(fabs(next - m) > 1e-15 * m);
    m = next;
    if (found) break;
  }
  *result = (scree_smooth_maximum){m, m - blend.width,
                                   sum * (1 - blend.slope) + blend.width * blend.slope};
}

bool scree_find_smooth_maximum(const scree_pair_law *law, double kappa,
                               const scree_contact_list *contacts, scree_smooth_maximum *result) {
  if (contacts->count == 1 && contacts->items[0].taper == 1) {
    const double m = contacts->items[0].overlap;
    if (!(m > 0)) return false;
    const double width = scree_blend_at(law, kappa, m).width;
    *result = (scree_smooth_maximum){m, m - width, width};
    return true;
  }
  if (!scree_solve_smooth_maximum(contacts->items, contacts->count, law->smoothing, kappa, result))
    return false;
  if (result->value > hard_from * law->limit) widen(law, kappa, contacts, result);
  return true;
}
