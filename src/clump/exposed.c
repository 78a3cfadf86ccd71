#include "clump/exposed.h"
#include "base/math.h"

#include <string.h>

static const double pi = 3.14159265358979323846, golden_angle = 2.399963229728653;

void scree_directions_spread(scree_directions *d, size_t count) {
  if (d->count == count) return;
  d->count = count;
  for (size_t i = 0; i < count; i++) {
    double z = 1 - (2 * (double)i + 1) / (double)count, r = sqrt(1 - z * z),
           angle = golden_angle * (double)i;
    d->x[i] = (float)(r * scree_cos(angle));
    d->y[i] = (float)(r * scree_sin(angle));
    d->z[i] = (float)z;
  }
}

/* Whether a lies within b, whose centre is so far from its own; the later of two equal ones does.
 */
static bool is_swallowed(const scree_sphere *a, const scree_sphere *b, double distance,
                         bool later) {
  double reach = distance + a->radius;
  return reach < b->radius || (reach <= b->radius && later);
}

/* Takes from the shares what sphere `other` covers: beyond the circle where both meet. */
static void cover(const scree_directions *d, const scree_sphere *s, vec3 towards, double distance,
                  double other_radius, float *shares) {
  double r = s->radius, patch = sqrt(4 * pi / (double)d->count);
  /* cosine, about the line to the other centre, of the circle */
  double rim = (distance * distance + r * r - other_radius * other_radius) / (2 * r * distance);
  /* over one patch's width across the rim the share falls from 1 to 0 */
  double slope = 1 / (patch * sqrt(fmax(1 - rim * rim, 0)) + 0.5 * patch * patch);
  vec3 n = vec3_scale(towards, -slope / distance);
  float x = (float)n.x, y = (float)n.y, z = (float)n.z, level = (float)(0.5 + rim * slope);
  for (size_t k = 0; k < d->count; k++) {
    float share = level + x * d->x[k] + y * d->y[k] + z * d->z[k];
    shares[k] = share < shares[k] ? share : shares[k];
  }
}

void scree_exposed_shares(const scree_directions *d, const scree_sphere *spheres, size_t count,
                          size_t index, float shares[SCREE_MOST_DIRECTIONS]) {
  const scree_sphere *s = &spheres[index];
  for (size_t k = 0; k < d->count; k++) shares[k] = 1;
  for (size_t j = 0; j < count; j++) {
    if (j == index) continue;
    vec3 towards = vec3_sub(vec3_load(spheres[j].centre), vec3_load(s->centre));
    double r = s->radius, other = spheres[j].radius, d2 = vec3_dot(towards, towards);
    if (d2 >= (r + other) * (r + other)) continue;
    double distance = sqrt(d2);
    if (is_swallowed(s, &spheres[j], distance, j < index)) {
      memset(shares, 0, d->count * sizeof *shares);
      return;
    }
    if (distance + other <= r) continue;
    cover(d, s, towards, distance, other, shares);
  }
  for (size_t k = 0; k < d->count; k++) shares[k] = shares[k] < 0 ? 0 : shares[k];
}
