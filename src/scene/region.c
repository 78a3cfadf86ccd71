#include "scene/region.h"

#include "base/math.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

scree_status scree_region_check(const scree_reader *r, const scree_region *region, bool ends) {
  const scree_plan_cylinder *c = region->cylinder;
  if (!c) return SCREE_OK;
  if (!given(&c->radius)) return scree_fail_place(r, &c->place, "needs a radius");
  if (given(c->at) && (!ends || c->length > 0)) return SCREE_OK;
  return scree_fail_place(r, &c->place, "needs at: [x, y, z]%s",
                          ends ? " and a length above 0" : "");
}

void scree_region_bounds(const scree_region *region, double low[3], double high[3]) {
  const scree_plan_cylinder *c = region->cylinder;
  if (!c) {
    memcpy(low, region->box->min, 3 * sizeof *low);
    memcpy(high, region->box->max, 3 * sizeof *high);
    return;
  }
  vec3 axis = vec3_unit(vec3_load(c->axis));
  const double n[3] = {axis.x, axis.y, axis.z};
  for (int k = 0; k < 3; k++) {
    double aside = c->radius * sqrt(fmax(0, 1 - n[k] * n[k])), end = c->length * n[k];
    low[k] = c->at[k] + fmin(0, end) - aside;
    high[k] = c->at[k] + fmax(0, end) + aside;
  }
}

bool scree_region_has(const scree_region *region, vec3 p) {
  const scree_plan_cylinder *c = region->cylinder;
  const double at[3] = {p.x, p.y, p.z};
  bool in = true;
  for (int k = 0; region->box && k < 3; k++)
    in = in && at[k] >= region->box->min[k] && at[k] <= region->box->max[k];
  if (!c) return in;
  vec3 axis = vec3_unit(vec3_load(c->axis)), d = vec3_sub(p, vec3_load(c->at));
  double along = vec3_dot(d, axis);
  if (c->length > 0 && (along < 0 || along > c->length)) return false;
  return vec3_norm(vec3_mad(d, axis, -along)) <= c->radius;
}

double scree_region_volume(const scree_region *region, vec3 along, double *height) {
  const scree_plan_cylinder *c = region->cylinder;
  *height = 0;
  if (c) {
    vec3 axis = vec3_unit(vec3_load(c->axis));
    double cosine = fmin(1, fabs(vec3_dot(axis, along))), sine = sqrt(1 - cosine * cosine);
    *height = c->length * cosine + 2 * c->radius * sine;
    return pi * c->radius * c->radius * c->length;
  }
  if (!region->box) return 0;
  vec3 sides = vec3_sub(vec3_load(region->box->max), vec3_load(region->box->min));
  *height = fabs(along.x) * sides.x + fabs(along.y) * sides.y + fabs(along.z) * sides.z;
  return sides.x * sides.y * sides.z;
}

vec3 scree_region_place(const scree_region *region, const double share[3], double thick) {
  const scree_plan_cylinder *c = region->cylinder;
  double at[3];
  if (!c) {
    const scree_plan_box *b = region->box;
    for (int k = 0; k < 3; k++) at[k] = b->min[k] + share[k] * (b->max[k] - b->min[k]);
    if (thick > 0) at[2] = b->min[2] + share[2] * thick;
    return vec3_load(at);
  }
  vec3 axis = vec3_unit(vec3_load(c->axis)), u, w;
  vec3_frame(axis, &u, &w);
  double r = c->radius * sqrt(share[0]), angle = 2 * pi * share[1],
         along = share[2] * (thick > 0 ? thick : c->length);
  if (thick > 0 && axis.z < 0) along = -along;
  return vec3_mad(vec3_mad(vec3_mad(vec3_load(c->at), axis, along), u, r * scree_cos(angle)), w,
                  r * scree_sin(angle));
}

/* A place along a unit vector so that the body lies within [low, high]; false: it is too long. */
static bool draw_along(const scree_placement *p, vec3 n, double low, double high, scree_rng *rng,
                       double *at) {
  double up, down, share = scree_rng_uniform(rng);
  scree_placement_reach(p, n, &up, &down);
  *at = low + down + share * (high - low - up - down);
  return high - low >= up + down;
}

static bool draw_in_box(const scree_plan_box *box, scree_placement *p, scree_rng *rng) {
  double at[3];
  bool fits = true;
  for (int k = 0; k < 3; k++) {
    vec3 n = {k == 0, k == 1, k == 2};
    fits = draw_along(p, n, box->min[k], box->max[k], rng, &at[k]) && fits;
  }
  p->position = vec3_load(at);
  return fits;
}

static bool draw_in_cylinder(const scree_plan_cylinder *c, scree_placement *p, scree_rng *rng) {
  vec3 axis = vec3_unit(vec3_load(c->axis)), u, w;
  double along;
  vec3_frame(axis, &u, &w);
  bool fits = draw_along(p, axis, 0, c->length, rng, &along);
  double r = c->radius * sqrt(scree_rng_uniform(rng)), a = 2 * pi * scree_rng_uniform(rng);
  vec3 at = vec3_mad(vec3_mad(vec3_scale(u, r * scree_cos(a)), w, r * scree_sin(a)), axis, along);
  p->position = vec3_add(vec3_load(c->at), at);
  scree_placement_settle(p);
  return fits && scree_placement_within(p, vec3_load(c->at), axis, c->radius);
}

bool scree_region_draw(const scree_region *region, scree_placement *p, scree_rng *rng) {
  bool within =
      region->box ? draw_in_box(region->box, p, rng) : draw_in_cylinder(region->cylinder, p, rng);
  scree_placement_settle(p);
  return within;
}
