#include "clump/path.h"

#include "base/alloc.h"
#include "base/math.h"

#include <stdint.h>
#include <string.h>

static const float
    reach = 1.15f,        /* of a new sphere, in distances free: it will overlap its neighbours */
    apart2 = 1.5f * 1.5f; /* of found places, in distances free, squared */
static const double least_radius = 0.01;

static bool is_taken(size_t i, size_t j, size_t k) {
  return (i + j + k) % 2 == 0;
}

static void push(scree_sphere_sites *p, const double at[3], float value, double volume) {
  if (!(value < 0)) return;
  p->x[p->count] = (float)at[0];
  p->y[p->count] = (float)at[1];
  p->z[p->count] = (float)at[2];
  p->volume[p->count] = (float)volume;
  p->depth[p->count++] = -value;
}

/* Nodes of one cell's finer grid, each of which belongs to one cell alone. */
static void push_brick(const scree_distance_field *f, const size_t cell[3], const float *values,
                       scree_sphere_sites *p) {
  double fine = scree_distance_field_spacing(f), volume = 2 * fine * fine * fine;
  for (size_t i = 0; i < SCREE_FINER; i++)
    for (size_t j = 0; j < SCREE_FINER; j++)
      for (size_t k = 0; k < SCREE_FINER; k++) {
        if (!is_taken(i, j, k)) continue;
        const double at[3] = {f->low[0] + (double)cell[0] * f->step + (double)i * fine,
                              f->low[1] + (double)cell[1] * f->step + (double)j * fine,
                              f->low[2] + (double)cell[2] * f->step + (double)k * fine};
        push(p, at, values[(i * SCREE_BRICK_SIDE + j) * SCREE_BRICK_SIDE + k], volume);
      }
}

static void collect(const scree_distance_field *f, scree_sphere_sites *p) {
  size_t node = 0;
  for (size_t i = 0; i < f->n[0]; i++)
    for (size_t j = 0; j < f->n[1]; j++)
      for (size_t k = 0; k < f->n[2]; k++, node++) {
        const double at[3] = {f->low[0] + (double)i * f->step, f->low[1] + (double)j * f->step,
                              f->low[2] + (double)k * f->step};
        if (f->brick[node] < 0)
          push(p, at, f->values[node], f->step * f->step * f->step);
        else
          push_brick(f, (size_t[3]){i, j, k}, f->bricks[f->brick[node]], p);
      }
}

scree_status scree_sphere_sites_make(const scree_distance_field *field, scree_sphere_sites *places,
                                     scree_error *error) {
  size_t room = field->n[0] * field->n[1] * field->n[2] +
                field->brick_count * SCREE_FINER * SCREE_FINER * SCREE_FINER / 2;
  SCREE_CLEANUP(scree_sphere_sites_free) scree_sphere_sites p = {0};
  SCREE_TRY_ALLOC(p.x, room, error);
  SCREE_TRY_ALLOC(p.y, room, error);
  SCREE_TRY_ALLOC(p.z, room, error);
  SCREE_TRY_ALLOC(p.depth, room, error);
  SCREE_TRY_ALLOC(p.volume, room, error);
  collect(field, &p);
  SCREE_TRY_ALLOC(p.left, p.count, error);
  SCREE_TRY_ALLOC(p.cluster, p.count, error);
  *places = p;
  p = (scree_sphere_sites){0};
  return SCREE_OK;
}

void scree_sphere_sites_free(scree_sphere_sites *places) {
  scree_free(places->x);
  scree_free(places->y);
  scree_free(places->z);
  scree_free(places->depth);
  scree_free(places->volume);
  scree_free(places->left);
  scree_free(places->cluster);
  *places = (scree_sphere_sites){0};
}

static float distance2(const scree_sphere_sites *p, size_t i, float x, float y, float z) {
  float dx = p->x[i] - x, dy = p->y[i] - y, dz = p->z[i] - z;
  return dx * dx + dy * dy + dz * dz;
}

static void keep_off(scree_sphere_sites *p, const scree_sphere *s) {
  float x = (float)s->centre[0], y = (float)s->centre[1], z = (float)s->centre[2],
        r = (float)s->radius;
  for (size_t i = 0; i < p->count; i++) {
    float free = sqrtf(distance2(p, i, x, y, z)) - r;
    p->left[i] = free < p->left[i] ? free : p->left[i];
  }
}

static size_t deepest(const scree_sphere_sites *p) {
  size_t best = 0;
  for (size_t i = 1; i < p->count; i++)
    if (p->left[i] > p->left[best]) best = i;
  return best;
}

/* As counted by the points within: those that are free, and the sphere's volume outside. */
static double gain_of(const scree_sphere_sites *p, const scree_sphere *s, double outside) {
  const double pi = 3.14159265358979323846;
  float x = (float)s->centre[0], y = (float)s->centre[1], z = (float)s->centre[2],
        r2 = (float)(s->radius * s->radius), free = 0, inside = 0;
  for (size_t i = 0; i < p->count; i++) {
    if (distance2(p, i, x, y, z) >= r2) continue;
    inside += p->volume[i];
    if (p->left[i] > 0) free += p->volume[i];
  }
  double all = 4 * pi / 3 * s->radius * s->radius * s->radius;
  return (double)free - outside * fmax(0, all - (double)inside);
}

static void insert(scree_sphere_candidate *found, size_t count, scree_sphere_candidate place) {
  for (; count > 0 && found[count - 1].gain < place.gain; count--) found[count] = found[count - 1];
  found[count] = place;
}

size_t scree_sphere_sites_free_of(scree_sphere_sites *p, const scree_sphere *spheres, size_t count,
                                  double outside, scree_sphere_candidate *found, size_t most) {
  const float passed_over = 1e-30f; /* free, but never the deepest */
  size_t number = 0;
  if (p->count == 0) return 0;
  memcpy(p->left, p->depth, p->count * sizeof *p->left);
  for (size_t s = 0; s < count; s++) keep_off(p, &spheres[s]);
  while (number < most) {
    size_t best = deepest(p);
    float free = p->left[best], x = p->x[best], y = p->y[best], z = p->z[best];
    if (!(free > passed_over)) break;
    scree_sphere_candidate place = {
        {{(double)x, (double)y, (double)z}, fmax((double)(reach * free), least_radius)}, 0};
    place.gain = gain_of(p, &place.sphere, outside);
    insert(found, number++, place);
    for (size_t i = 0; number < most && i < p->count; i++)
      if (p->left[i] > 0 && distance2(p, i, x, y, z) <= apart2 * free * free)
        p->left[i] = passed_over;
  }
  return number;
}

/* ---- Spread evenly ---- */

enum { SPREAD_POINTS = 3000, LLOYD_ITERATIONS = 15 };

static size_t stride_of(const scree_sphere_sites *p) {
  return 1 + p->count / SPREAD_POINTS;
}

/* The first points, each the farthest from those before; `left` is the distance squared. */
static void spread_first(scree_sphere_sites *p, size_t count, scree_sphere *spheres) {
  size_t stride = stride_of(p), at = 0;
  for (size_t i = 0; i < p->count; i += stride) p->left[i] = INFINITY;
  for (size_t s = 0; s < count; s++) {
    float x = p->x[at], y = p->y[at], z = p->z[at];
    spheres[s] = (scree_sphere){{(double)x, (double)y, (double)z}, 0};
    for (size_t i = 0; i < p->count; i += stride) {
      float d = distance2(p, i, x, y, z);
      if (d < p->left[i]) p->left[i] = d, p->cluster[i] = (uint32_t)s;
      if (p->left[i] > p->left[at]) at = i;
    }
  }
}

/* Every point to the nearest centre. */
static void assign(scree_sphere_sites *p, size_t count, const scree_sphere *spheres) {
  for (size_t i = 0; i < p->count; i += stride_of(p)) p->left[i] = INFINITY;
  for (size_t s = 0; s < count; s++) {
    float x = (float)spheres[s].centre[0], y = (float)spheres[s].centre[1],
          z = (float)spheres[s].centre[2];
    for (size_t i = 0; i < p->count; i += stride_of(p)) {
      float d = distance2(p, i, x, y, z);
      if (d < p->left[i]) p->left[i] = d, p->cluster[i] = (uint32_t)s;
    }
  }
}

/* Centres to the centroids of their clusters, radii to spheres of their volumes. */
static void centre(const scree_sphere_sites *p, size_t count, scree_sphere *spheres) {
  double sums[SCREE_MOST_SPHERES][4] = {{0}}, all = 0;
  for (size_t i = 0; i < p->count; i += stride_of(p)) {
    double *sum = sums[p->cluster[i]], volume = (double)p->volume[i];
    sum[0] += volume * (double)p->x[i];
    sum[1] += volume * (double)p->y[i];
    sum[2] += volume * (double)p->z[i];
    sum[3] += volume;
    all += volume;
  }
  for (size_t s = 0; s < count; s++) {
    if (!(sums[s][3] > 0)) continue;
    for (int k = 0; k < 3; k++) spheres[s].centre[k] = sums[s][k] / sums[s][3];
    spheres[s].radius =
        fmax(least_radius, scree_cbrt(0.75 / 3.14159265358979323846 * sums[s][3] / all));
  }
}

bool scree_sphere_sites_spread(scree_sphere_sites *p, size_t count, scree_sphere *spheres) {
  if (p->count < count * stride_of(p)) return false;
  spread_first(p, count, spheres);
  for (int i = 0; i < LLOYD_ITERATIONS; i++) {
    centre(p, count, spheres);
    assign(p, count, spheres);
  }
  centre(p, count, spheres);
  return true;
}
