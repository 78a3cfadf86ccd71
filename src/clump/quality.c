#include "clump/quality.h"

#include "base/alloc.h"
#include "base/eigen.h"
#include "base/math.h"

static const double pi = 3.14159265358979323846;
static const double least_gain = 1e-4; /* IoU below which a sphere is useless */

/* Spheres that a triangle's cost in the paper's criterion is set against: of counts from 10 to 50
 * for most bodies, which people choose. */
static const double volume_count = 200, distance_count = 5000;

enum {
  SURFACE_POINTS = 3000,
  EXPOSED_POINTS = 16000, /* shared out to the spheres, but to each at least */
  LEAST_DIRECTIONS = 256,
  NORMALS_APART = 8 /* normals are compared at every so many of them */
};

scree_status scree_judge_make(const scree_target *body, const scree_distance_field *field,
                              scree_ruler *ruler, scree_judge *judge, scree_error *error) {
  *judge = (scree_judge){.body = body, .field = field, .ruler = ruler};
  SCREE_TRY_ALLOC(judge->points, EXPOSED_POINTS + SCREE_MOST_SPHERES * LEAST_DIRECTIONS, error);
  return SCREE_OK;
}

void scree_judge_free(scree_judge *judge) {
  scree_free(judge->points);
  judge->points = NULL;
}

/* Sums over the exposed surface, by area. */
typedef struct surface_sums {
  double area, distance, height, height2, farthest, angle, angle_area;
  size_t count;
} surface_sums;

/* Answers how far it lies from the body's surface. */
static double add_point(scree_judge *j, vec3 p, vec3 normal, double area, surface_sums *sums) {
  const double at[3] = {p.x, p.y, p.z};
  double height = scree_distance_field_at(j->field, at);
  sums->area += area;
  sums->distance += area * fabs(height);
  sums->height += area * height;
  sums->height2 += area * height * height;
  if (sums->count++ % NORMALS_APART) return fabs(height);
  double distance;
  scree_target_point nearest = scree_target_nearest(j->body, p, &distance);
  sums->angle += area * scree_acos(fmax(-1, fmin(1, vec3_dot(normal, nearest.normal))));
  sums->angle_area += area;
  return fabs(height);
}

static surface_sums walk_surface(scree_judge *j, const scree_sphere *spheres, size_t count) {
  surface_sums sums = {0};
  float shares[SCREE_MOST_DIRECTIONS];
  const scree_directions *d = &j->directions;
  size_t each = EXPOSED_POINTS / count;
  each = each < LEAST_DIRECTIONS ? LEAST_DIRECTIONS : each;
  scree_directions_spread(&j->directions,
                          each > SCREE_MOST_DIRECTIONS ? SCREE_MOST_DIRECTIONS : each);
  j->point_count = 0;
  for (size_t i = 0; i < count; i++) {
    const scree_sphere *s = &spheres[i];
    double patch = 4 * pi * s->radius * s->radius / (double)d->count;
    scree_exposed_shares(d, spheres, count, i, shares);
    for (size_t k = 0; k < d->count; k++) {
      if (!(shares[k] > 0)) continue;
      vec3 n = {(double)d->x[k], (double)d->y[k], (double)d->z[k]};
      vec3 p = vec3_mad(vec3_load(s->centre), n, s->radius);
      double distance = add_point(j, p, n, patch * (double)shares[k], &sums);
      if (shares[k] <= 0.5f) continue;
      j->points[j->point_count++] = p;
      sums.farthest = fmax(sums.farthest, distance);
    }
  }
  return sums;
}

static bool is_covered(const scree_sphere *spheres, size_t count, size_t but, vec3 p) {
  for (size_t i = 0; i < count; i++) {
    vec3 d = vec3_sub(p, vec3_load(spheres[i].centre));
    if (i != but && vec3_dot(d, d) < spheres[i].radius * spheres[i].radius) return true;
  }
  return false;
}

/* From a point within the union to its surface: the nearest of the points there, and of the points
 * straight out from the spheres' centres. */
static double way_out(const scree_judge *j, const scree_sphere *spheres, size_t count, vec3 p) {
  double best2 = INFINITY;
  for (size_t k = 0; k < j->point_count; k++) {
    vec3 d = vec3_sub(j->points[k], p);
    best2 = scree_smaller(best2, vec3_dot(d, d));
  }
  double best = sqrt(best2);
  for (size_t i = 0; i < count; i++) {
    vec3 centre = vec3_load(spheres[i].centre), d = vec3_sub(p, centre);
    double length = vec3_norm(d), way = fabs(spheres[i].radius - length);
    if (way >= best || !(length > 0)) continue;
    vec3 foot = vec3_mad(centre, d, spheres[i].radius / length);
    if (!is_covered(spheres, count, i, foot)) best = way;
  }
  return best;
}

static double distance_to_union(const scree_judge *j, const scree_sphere *spheres, size_t count,
                                vec3 p) {
  double free = INFINITY;
  for (size_t i = 0; i < count; i++) {
    double d = vec3_norm(vec3_sub(p, vec3_load(spheres[i].centre))) - spheres[i].radius;
    free = fmin(free, d);
  }
  return free >= 0 ? free : way_out(j, spheres, count, p);
}

static scree_clump_gap gap_from_mesh(const scree_judge *j, const scree_sphere *spheres,
                                     size_t count) {
  scree_clump_gap gap = {0};
  for (size_t i = 0; i < SURFACE_POINTS; i++) {
    vec3 p = scree_target_sample(j->body, i, SURFACE_POINTS).at;
    double d = distance_to_union(j, spheres, count, p);
    gap.mean += d / SURFACE_POINTS;
    gap.maximum = fmax(gap.maximum, d);
  }
  return gap;
}

/* Principal moments of inertia about the centroid, from moments about the origin. */
static void principal_inertia(const double *m, double inertia[3]) {
  const double *about = m + SCREE_FIRST_INERTIA, *products = m + SCREE_FIRST_PRODUCT;
  const vec3 c = {m[1], m[2], m[3]};
  const double first[3] = {c.x, c.y, c.z}, c2 = vec3_dot(c, c);
  mat3 tensor, axes;
  for (int a = 0; a < 3; a++) {
    tensor.m[a][a] = about[a] - (c2 - first[a] * first[a]) / m[0];
    for (int b = 0; b < a; b++)
      tensor.m[a][b] = tensor.m[b][a] = first[a] * first[b] / m[0] - products[a + b - 1];
  }
  scree_eigen_symmetric(&tensor, inertia, &axes);
}

static double inertia_error(const double *clump, const double *body) {
  double a[3], b[3], worst = 0;
  principal_inertia(clump, a);
  principal_inertia(body, b);
  for (int k = 0; k < 3; k++) worst = fmax(worst, fabs(a[k] / b[k] - 1));
  return worst;
}

static double farthest_out(const scree_judge *j, const scree_sphere *spheres, size_t count) {
  double worst = 0;
  for (size_t i = 0; i < count; i++) {
    double distance;
    scree_target_nearest(j->body, vec3_load(spheres[i].centre), &distance);
    double depth = scree_distance_field_at(j->field, spheres[i].centre) < 0 ? distance : -distance;
    worst = fmax(worst, spheres[i].radius - depth);
  }
  return worst;
}

static void measure_volumes(scree_judge *j, const scree_sphere *spheres, size_t count,
                            scree_clump *c) {
  scree_alone alone[SCREE_MOST_SPHERES];
  scree_overlap o = scree_ruler_measure(j->ruler, spheres, count, alone);
  const double *m = o.moments;
  if (!(m[0] > 0)) return;
  c->iou = o.iou;
  c->union_volume = m[0] * j->body->scale * j->body->scale * j->body->scale;
  c->volume_error = m[0] - 1;
  c->centroid_error = sqrt(m[1] * m[1] + m[2] * m[2] + m[3] * m[3]) / m[0] / SCREE_UNIT_SIZE;
  c->inertia_error = inertia_error(m, j->body->moments);
  for (size_t i = 0; i < count; i++)
    c->useless_count += fabs(scree_overlap_loss(&o, &alone[i])) < least_gain;
}

scree_clump scree_judge_clump(scree_judge *j, const scree_sphere *spheres, size_t count) {
  scree_clump c = {.sphere_count = count};
  double scale = j->body->scale;
  measure_volumes(j, spheres, count, &c);
  surface_sums sums = walk_surface(j, spheres, count);
  scree_clump_gap back = gap_from_mesh(j, spheres, count);
  double mean = sums.distance / sums.area, height = sums.height / sums.area;
  c.to_mesh = (scree_clump_gap){scale * mean, scale * sums.farthest};
  c.from_mesh = (scree_clump_gap){scale * back.mean, scale * back.maximum};
  c.roughness = scale * sqrt(fmax(sums.height2 / sums.area - height * height, 0));
  c.slope_deg = sums.angle / sums.angle_area * 180 / pi;
  c.outside = scale * farthest_out(j, spheres, count);
  c.volume_criterion = 1 - c.iou + (double)count / volume_count;
  c.distance_criterion = (mean + back.mean) / 2 / SCREE_UNIT_SIZE + (double)count / distance_count;
  return c;
}
