/* favier: Favier, Abbaspour-Fard, Kremmer, Raji 1999, "Shape representation of axi-symmetrical,
 * non-spherical particles in discrete element simulation using multi-element model particles":
 * spheres at equal steps along the axis of a body of revolution, each as large as fits. Of other
 * bodies the axis is the longest principal one, and centres are the centroids of slices across it.
 *
 * ferellec: Ferellec and McDowell 2010, "A method to model realistic particle shape and inertia in
 * DEM": from surface points in random order a sphere grows inward along the normal until it touches
 * the surface again; points near its surface are represented and start none.
 *
 * bubble: Taghavi 2011, "Automatic clump generation based on mid-surface": spheres on the medial
 * surface, here those that touch from within at sample points; from the largest down to `ratio` of
 * it each is kept that meets no kept one at a larger angle than `angle_deg`.
 *
 * peeling: from the Euclidean distance (Angelidakis et al. 2021, "CLUMP"; Buchele, Poeschel,
 * Mueller 2026, "Multi-sphere shape generator", refine it): the next sphere is inscribed at the
 * point that lies deepest in what none covers yet. */
#include "clump/greedy.h"

#include "base/alloc.h"
#include "base/rng.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double represented = 0.01; /* ferellec: this near to a sphere, in sizes */
enum { SAMPLES = 4000, CLIMB_HALVINGS = 8 };

/* The largest sphere about the point that stays inside; radius 0 where it is outside. */
static scree_sphere inscribed(const scree_path *p, vec3 at) {
  scree_sphere s = {.radius = 0};
  double distance;
  vec3_store(s.centre, at);
  scree_target_nearest(p->body, at, &distance);
  if (scree_distance_field_at(&p->field, s.centre) < 0) s.radius = distance;
  return s;
}

static void put(scree_path *p, const scree_sphere *spheres, size_t count) {
  scree_trial *t = &p->best[count];
  t->count = count;
  for (size_t i = 0; i < count; i++) t->spheres[i] = spheres[i];
  t->overlap = scree_ruler_measure(&p->ruler, spheres, count, NULL);
}

/* Clumps of the first, the first two, ... */
static void put_all(scree_path *p, const scree_sphere *spheres, size_t count) {
  for (size_t n = 1; n <= count; n++) put(p, spheres, n);
}

/* ---- Favier ---- */

static vec3 slice_centroid(const scree_sphere_sites *places, double low, double high) {
  double volume = 0;
  vec3 sum = {0, 0, 0};
  for (size_t i = 0; i < places->count; i++) {
    double z = (double)places->z[i];
    if (z < low || z >= high) continue;
    volume += (double)places->volume[i];
    sum = vec3_mad(sum, (vec3){(double)places->x[i], (double)places->y[i], z},
                   (double)places->volume[i]);
  }
  return volume > 0 ? vec3_scale(sum, 1 / volume) : (vec3){INFINITY, 0, 0};
}

static void fill_favier(scree_path *p) {
  double low = p->body->low.z, length = p->body->high.z - low;
  for (size_t n = 1; n <= p->most; n++) {
    scree_sphere spheres[SCREE_MOST_SPHERES] = {0};
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
      vec3 at = slice_centroid(&p->places, low + length * (double)i / (double)n,
                               low + length * (double)(i + 1) / (double)n);
      if (at.x < INFINITY) spheres[count] = inscribed(p, at);
      if (at.x < INFINITY && spheres[count].radius > 0) count++;
    }
    if (count == n) put(p, spheres, n);
  }
}

/* ---- Peeling ---- */

/* From the surface, which the grid knows too roughly here, and from the spheres there are. */
static double free_distance(const scree_path *p, const scree_sphere *spheres, size_t count,
                            vec3 at) {
  double free = inscribed(p, at).radius;
  for (size_t i = 0; i < count; i++)
    free = fmin(free, vec3_norm(vec3_sub(at, vec3_load(spheres[i].centre))) - spheres[i].radius);
  return free;
}

/* To where it is deepest nearby, between the points of the grid: along the axes by halved steps. */
static vec3 climb(const scree_path *p, const scree_sphere *spheres, size_t count, vec3 at) {
  double best = free_distance(p, spheres, count, at), step = p->field.step / 2;
  for (int halvings = 0; halvings < CLIMB_HALVINGS;) {
    bool moved = false;
    for (int k = 0; k < 6; k++) {
      double way = k % 2 ? -step : step;
      vec3 next =
          vec3_add(at, (vec3){k / 2 == 0 ? way : 0, k / 2 == 1 ? way : 0, k / 2 == 2 ? way : 0});
      double free = free_distance(p, spheres, count, next);
      if (free <= best) continue;
      best = free;
      at = next;
      moved = true;
    }
    if (!moved) halvings++, step /= 2;
  }
  return at;
}

static void fill_peeling(scree_path *p) {
  scree_sphere spheres[SCREE_MOST_SPHERES];
  scree_sphere_candidate place;
  size_t count = 0;
  while (count < p->most && scree_sphere_sites_free_of(&p->places, spheres, count, 0, &place, 1)) {
    vec3 at = climb(p, spheres, count, vec3_load(place.sphere.centre));
    spheres[count] = inscribed(p, at);
    if (!(spheres[count].radius > 0)) break;
    count++;
  }
  put_all(p, spheres, count);
}

/* ---- Ferellec and McDowell ---- */

static scree_sphere touching(const scree_path *p, scree_target_point point) {
  scree_sphere s = {.radius = scree_target_tangent_radius(p->body, point)};
  vec3_store(s.centre, vec3_mad(point.at, point.normal, -s.radius));
  return s;
}

static bool is_represented(const scree_sphere *spheres, size_t count, vec3 point) {
  for (size_t i = 0; i < count; i++) {
    double d = vec3_norm(vec3_sub(point, vec3_load(spheres[i].centre))) - spheres[i].radius;
    if (fabs(d) <= represented * SCREE_UNIT_SIZE) return true;
  }
  return false;
}

static void fill_ferellec(scree_path *p, uint64_t seed, uint32_t *order) {
  scree_sphere spheres[SCREE_MOST_SPHERES];
  scree_rng rng = {.seed = seed};
  size_t count = 0;
  for (uint32_t i = 0; i < SAMPLES; i++) order[i] = i;
  scree_rng_shuffle(&rng, order, SAMPLES, sizeof *order);
  for (size_t i = 0; i < SAMPLES && count < p->most; i++) {
    scree_target_point point = scree_target_sample(p->body, order[i], SAMPLES);
    if (!is_represented(spheres, count, point.at)) spheres[count++] = touching(p, point);
  }
  put_all(p, spheres, count);
}

/* ---- Bubble pack ---- */

static int largest_first(const void *a, const void *b) {
  const scree_sphere *s = a, *t = b;
  if (s->radius != t->radius) return s->radius > t->radius ? -1 : 1;
  for (int k = 0; k < 3; k++)
    if (s->centre[k] != t->centre[k]) return s->centre[k] < t->centre[k] ? -1 : 1;
  return 0;
}

void scree_spheres_sort(scree_sphere *spheres, size_t count) {
  qsort(spheres, count, sizeof *spheres, largest_first);
}

/* 0 where they touch from outside, 180 degrees where one holds the other. */
static double meeting_angle(const scree_sphere *s, const scree_sphere *t) {
  vec3 d = vec3_sub(vec3_load(s->centre), vec3_load(t->centre));
  double cosine = (s->radius * s->radius + t->radius * t->radius - vec3_dot(d, d)) /
                  (2 * s->radius * t->radius);
  return 180 - 180 / pi * acos(fmax(-1, fmin(1, cosine)));
}

static void fill_bubble(scree_path *p, const scree_clump_options *o, scree_sphere *medial) {
  scree_sphere spheres[SCREE_MOST_SPHERES];
  size_t count = 0;
  for (size_t i = 0; i < SAMPLES; i++)
    medial[i] = touching(p, scree_target_sample(p->body, i, SAMPLES));
  scree_spheres_sort(medial, SAMPLES);
  for (size_t i = 0; i < SAMPLES && count < p->most; i++) {
    if (medial[i].radius < o->ratio * medial[0].radius) break;
    bool apart = true;
    for (size_t k = 0; k < count && apart; k++)
      apart = meeting_angle(&medial[i], &spheres[k]) <= o->angle_deg;
    if (apart) spheres[count++] = medial[i];
  }
  put_all(p, spheres, count);
}

scree_status scree_greedy_fill(scree_path *path, const scree_clump_options *options,
                               scree_error *error) {
  SCREE_SCRATCH(scree_sphere, scratch, SAMPLES, error);
  if (options->method == SCREE_CLUMP_FAVIER) fill_favier(path);
  if (options->method == SCREE_CLUMP_PEELING) fill_peeling(path);
  if (options->method == SCREE_CLUMP_FERELLEC)
    fill_ferellec(path, options->seed, (uint32_t *)scratch);
  if (options->method == SCREE_CLUMP_BUBBLE) fill_bubble(path, options, scratch);
  if (path->ruler.failed) return scree_fail_memory(error, 0, "the chords of a clump");
  if (!path->best[1].count)
    return scree_fail(error, SCREE_LIMIT, "the method %s finds no sphere inside",
                      scree_clump_method_name(options->method));
  return SCREE_OK;
}
