/* From a mesh to clumps of every count. */
#include "base/alloc.h"
#include "clump/greedy.h"
#include "clump/quality.h"
#include "particle/particle.h"

#include <string.h>

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
  scree_spheres_sort(to, count);
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
                                            : scree_greedy_fill(&path, o, error));
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
