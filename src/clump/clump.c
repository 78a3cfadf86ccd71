/* From a mesh to clumps of every count. */
#include "base/alloc.h"
#include "base/math.h"
#include "base/rng.h"
#include "clump/path.h"
#include "clump/quality.h"
#include "particle/particle.h"

#include <stdlib.h>
#include <string.h>

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

/* Largest first, equal ones by their centres. */
static void spheres_sort(scree_sphere *spheres, size_t count) {
  qsort(spheres, count, sizeof *spheres, largest_first);
}

/* 0 where they touch from outside, 180 degrees where one holds the other. */
static double meeting_angle(const scree_sphere *s, const scree_sphere *t) {
  vec3 d = vec3_sub(vec3_load(s->centre), vec3_load(t->centre));
  double cosine = (s->radius * s->radius + t->radius * t->radius - vec3_dot(d, d)) /
                  (2 * s->radius * t->radius);
  return 180 - 180 / pi * scree_acos(fmax(-1, fmin(1, cosine)));
}

static void fill_bubble(scree_path *p, const scree_clump_options *o, scree_sphere *medial) {
  scree_sphere spheres[SCREE_MOST_SPHERES];
  size_t count = 0;
  for (size_t i = 0; i < SAMPLES; i++)
    medial[i] = touching(p, scree_target_sample(p->body, i, SAMPLES));
  spheres_sort(medial, SAMPLES);
  for (size_t i = 0; i < SAMPLES && count < p->most; i++) {
    if (medial[i].radius < o->ratio * medial[0].radius) break;
    bool apart = true;
    for (size_t k = 0; k < count && apart; k++)
      apart = meeting_angle(&medial[i], &spheres[k]) <= o->angle_deg;
    if (apart) spheres[count++] = medial[i];
  }
  put_all(p, spheres, count);
}

/* Fills path->best by the method, which is not SCREE_CLUMP_FITTED; where it gives fewer spheres
 * than path->most, larger counts have count 0. */
static scree_status greedy_fill(scree_path *path, const scree_clump_options *options,
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

enum { LARGEST_COUNT = 300 };

static const char *const names[] = {"fitted", "favier", "bubble", "ferellec", "peeling"};

const char *scree_clump_method_name(scree_clump_method method) {
  return (size_t)method < sizeof names / sizeof *names ? names[method] : NULL;
}

scree_clump_options scree_default_clump_options(void) {
  return (scree_clump_options){
      .most = 100, .outside = INFINITY, .ratio = 0.05, .angle_deg = 150, .seed = 1};
}

static scree_status check_options(const scree_clump_options *o, scree_error *error) {
  if (!scree_clump_method_name(o->method))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "no method of clumps has the number %d",
                      (int)o->method);
  if (o->most < 1 || o->most > LARGEST_COUNT)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu spheres; it must be 1 to %d", o->most,
                      LARGEST_COUNT);
  if (!(o->outside >= 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "spheres may stand out by %g m; it must not be below 0", o->outside);
  if (!(o->ratio > 0 && o->ratio <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "ratio %g; it must be above 0 and at most 1",
                      o->ratio);
  if (!(o->angle_deg >= 0 && o->angle_deg <= 180))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "angle %g degrees; it must be 0 to 180",
                      o->angle_deg);
  return SCREE_OK;
}

/* Into the mesh's coordinates. */
static void put_spheres(const scree_target *body, const scree_sphere *from, size_t count,
                        scree_sphere *to) {
  double centre[3];
  vec3_store(centre, body->centre);
  for (size_t i = 0; i < count; i++) {
    to[i].radius = body->scale * from[i].radius;
    for (int k = 0; k < 3; k++) {
      double x = 0;
      for (int a = 0; a < 3; a++) x += body->axes.m[a][k] * from[i].centre[a];
      to[i].centre[k] = centre[k] + body->scale * x;
    }
  }
  spheres_sort(to, count);
}

static void choose(scree_clumps *c) {
  for (size_t i = 1; i < c->clump_count; i++) {
    if (c->clumps[i].volume_criterion < c->clumps[c->recommended].volume_criterion)
      c->recommended = i;
    if (c->clumps[i].distance_criterion < c->clumps[c->by_distance].distance_criterion)
      c->by_distance = i;
  }
}

static scree_status collect(scree_path *p, scree_clumps *c, scree_error *error) {
  SCREE_CLEANUP(scree_judge_free) scree_judge judge = {0};
  size_t total = 0, used = 0;
  for (size_t n = 1; n <= p->most; n++) {
    c->clump_count += p->best[n].count > 0;
    total += p->best[n].count;
  }
  SCREE_TRY_ALLOC_ZERO(c->clumps, c->clump_count, error);
  SCREE_TRY_ALLOC(c->storage, total, error);
  SCREE_TRY(scree_judge_make(p->body, &p->field, &p->ruler, &judge, error));
  c->clump_count = 0;
  for (size_t n = 1; n <= p->most; n++) {
    const scree_trial *t = &p->best[n];
    if (!t->count) continue;
    scree_clump *clump = &c->clumps[c->clump_count++];
    *clump = scree_judge_clump(&judge, t->spheres, t->count);
    clump->spheres = c->storage + used;
    put_spheres(p->body, t->spheres, t->count, clump->spheres);
    used += t->count;
  }
  if (p->ruler.failed) return scree_fail_memory(error, 0, "the chords of a clump");
  choose(c);
  return SCREE_OK;
}

static scree_status make(const scree_target *body, const scree_clump_options *o,
                         const scree_progress *progress, scree_clumps *c, scree_error *error) {
  SCREE_CLEANUP(scree_path_free) scree_path path = {0};
  SCREE_TRY(scree_path_make(body, o->most, o->outside / body->scale, progress, &path, error));
  SCREE_TRY(o->method == SCREE_CLUMP_FITTED ? scree_path_search(&path, error)
                                            : greedy_fill(&path, o, error));
  c->size = SCREE_UNIT_SIZE * body->scale;
  c->thickness = body->scale * path.field.thickness;
  c->wall_cells = scree_distance_field_cells(&path.field);
  return collect(&path, c, error);
}

scree_status scree_clumps_make(const scree_mesh *mesh, const scree_clump_options *options,
                               const scree_progress *progress, scree_clumps *clumps,
                               scree_error *error) {
  scree_clump_options used = options ? *options : scree_default_clump_options();
  SCREE_CLEANUP(scree_clumps_free) scree_clumps c = {.method = used.method};
  SCREE_CLEANUP(scree_target_free) scree_target body = {0};
  SCREE_TRY(check_options(&used, error));
  SCREE_TRY(scree_target_make(mesh, &body, error));
  SCREE_TRY(scree_mesh_measure(mesh, &c.measures, error));
  SCREE_TRY(make(&body, &used, progress, &c, error));
  *clumps = c;
  c = (scree_clumps){0};
  return SCREE_OK;
}

void scree_clumps_free(scree_clumps *clumps) {
  if (!clumps) return;
  scree_free(clumps->clumps);
  scree_free(clumps->storage);
  *clumps = (scree_clumps){0};
}

const scree_clump *scree_clumps_of_count(const scree_clumps *clumps, size_t count) {
  size_t i = 0;
  while (i + 1 < clumps->clump_count && clumps->clumps[i + 1].sphere_count <= count) i++;
  return &clumps->clumps[i];
}

const scree_clump *scree_clumps_within(const scree_clumps *clumps, double tolerance) {
  for (size_t i = 0; i < clumps->clump_count; i++) {
    const scree_clump *c = &clumps->clumps[i];
    if ((c->to_mesh.mean + c->from_mesh.mean) / 2 <= tolerance * clumps->size) return c;
  }
  return NULL;
}

static scree_solid solid_of(const scree_measures *m) {
  scree_solid solid = {.volume = m->volume, .centre = vec3_load(m->centroid)};
  double half = 0.5 * (m->inertia[0][0] + m->inertia[1][1] + m->inertia[2][2]);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) solid.second.m[i][k] = (i == k ? half : 0) - m->inertia[i][k];
  return solid;
}

scree_status scree_clump_particle(const scree_clumps *clumps, const scree_clump *clump,
                                  scree_particle **particle, scree_error *error) {
  size_t count = clump->sphere_count;
  scree_solid solid = solid_of(&clumps->measures);
  SCREE_SCRATCH(double, centres, 3 * count, error);
  SCREE_SCRATCH(double, radii, count, error);
  for (size_t i = 0; i < count; i++) {
    memcpy(centres + 3 * i, clump->spheres[i].centre, 3 * sizeof *centres);
    radii[i] = clump->spheres[i].radius;
  }
  return scree_particle_clump_of(centres, radii, count, &solid, particle, error);
}

scree_status scree_clump_fit(const scree_mesh *mesh, size_t count, const scree_progress *progress,
                             scree_particle **particle, scree_error *error) {
  scree_clump_options o = scree_default_clump_options();
  SCREE_CLEANUP(scree_clumps_free) scree_clumps clumps = {0};
  o.most = count;
  SCREE_TRY(scree_clumps_make(mesh, &o, progress, &clumps, error));
  return scree_clump_particle(&clumps, scree_clumps_of_count(&clumps, count), particle, error);
}
