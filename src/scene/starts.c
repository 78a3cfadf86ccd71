/* Where the bodies of an inlet begin, by places drawn as the inlet draws them, before any is there.
 *
 * A region is convex: two places in it see each other unless geometry is in between. Places that
 * see each other, also by way of others, are one part of the region; walls that cut it make more.
 * From each place a point falls freely, along its parabola, until it meets geometry or an outlet or
 * leaves the domain. Geometry is taken as it stands at the start. */
#include "scene/starts.h"

#include "particle/closest.h"

#include <string.h>

enum { PLACES = 128, DRAWS = 40 * PLACES, STREAM = 48, CHORDS = 64, MOST_CHORDS = 4096 };
/* Fewer are a corner that was seen by chance from nowhere, or a body at a rim. */
static const double told_share = 0.02;

typedef struct places {
  const scree_scene *scene;
  vec3 at[PLACES];
  int part[PLACES], count;
} places;

/* ---- what is in the way ---- */

static bool disc_parts(const scree_wall *wall, vec3 from, vec3 to) {
  vec3 n = vec3_unit(vec3_load(wall->axis)), at = vec3_load(wall->position);
  double a = vec3_dot(n, vec3_sub(from, at)), b = vec3_dot(n, vec3_sub(to, at));
  if ((a > 0) == (b > 0)) return false;
  vec3 d = vec3_sub(vec3_mad(from, vec3_sub(to, from), a / (a - b)), at);
  return wall->kind == SCREE_WALL_PLANE || vec3_norm(d) <= wall->radius;
}

static bool cylinder_parts(const scree_wall *wall, vec3 from, vec3 to) {
  vec3 axis = vec3_unit(vec3_load(wall->axis)), d = vec3_sub(from, vec3_load(wall->position)),
       way = vec3_sub(to, from);
  double along = vec3_dot(axis, d), rise = vec3_dot(axis, way);
  vec3 p = vec3_mad(d, axis, -along), v = vec3_mad(way, axis, -rise);
  double a = vec3_norm2(v), b = vec3_dot(p, v),
         root = b * b - a * (vec3_norm2(p) - wall->radius * wall->radius);
  for (int sign = -1; a > 0 && root >= 0 && sign <= 1; sign += 2) {
    double s = (-b + sign * sqrt(root)) / a, height = along + s * rise;
    if (s > 0 && s <= 1 && (wall->length == 0 || (height >= 0 && height <= wall->length)))
      return true;
  }
  return false;
}

static bool mesh_parts(const scree_world_wall *wall, vec3 from, vec3 to) {
  const mat3 *turn = &wall->frame.rotation;
  vec3 way = mat3_tmul_vec(turn, vec3_sub(to, from));
  scree_ray_interval ray = {mat3_tmul_vec(turn, vec3_sub(from, wall->frame.position)),
                            vec3_unit(way), 0, vec3_norm(way)};
  uint32_t face;
  return scree_next_passage(wall->surface, &ray, 0, SIZE_MAX, &face) < INFINITY;
}

/* Whether a wall is between two points, and which. */
static bool is_parted(const scree_scene *scene, vec3 from, vec3 to, size_t *wall) {
  for (size_t w = 0; w < scree_world_wall_count(scene->world); w++) {
    scree_wall one;
    scree_world_get_wall(scene->world, w, &one);
    *wall = w;
    if (one.kind == SCREE_WALL_MESH ? mesh_parts(scree_world_wall_at(scene->world, w), from, to)
        : one.kind == SCREE_WALL_CYLINDER ? cylinder_parts(&one, from, to)
                                          : disc_parts(&one, from, to))
      return true;
  }
  return false;
}

/* ---- parts of the region ---- */

/* Parts are named by the least of their places. */
static void join(places *p, int a, int b) {
  int low = p->part[a] < p->part[b] ? p->part[a] : p->part[b], high = p->part[a] + p->part[b] - low;
  for (int i = 0; i < p->count; i++)
    if (p->part[i] == high) p->part[i] = low;
}

static void find_parts(places *p) {
  size_t wall;
  for (int i = 0; i < p->count; i++) {
    p->part[i] = i;
    for (int k = i; k-- > 0;)
      if (p->part[k] != p->part[i] && !is_parted(p->scene, p->at[i], p->at[k], &wall))
        join(p, i, k);
  }
}

static int size_of_part(const places *p, int part) {
  int size = 0;
  for (int i = 0; i < p->count; i++) size += p->part[i] == part;
  return size;
}

static void measure_parts(places *p, scree_scene_starts *starts) {
  size_t wall = 0;
  int largest = 0, small = 0;
  find_parts(p);
  for (int i = 1; i < p->count; i++)
    if (size_of_part(p, i) > size_of_part(p, largest)) largest = i;
  for (int i = 0; i < p->count; i++) {
    bool other = p->part[i] != largest && size_of_part(p, p->part[i]) >= told_share * p->count;
    small += other;
    if (other && is_parted(p->scene, p->at[i], p->at[largest], &wall))
      starts->parted_by = scree_scene_wall_geometry(p->scene, wall);
  }
  starts->parted = (double)small / p->count;
}

/* ---- falling ---- */

static bool is_in_outlet(const scree_scene *scene, vec3 at) {
  double p[3];
  vec3_store(p, at);
  for (size_t i = 0; i < scene->plan.outlets.count; i++) {
    const scree_plan_box *box = scene->plan.outlets.items[i].box;
    if (scree_is_in(p, box->min, box->max)) return true;
  }
  return false;
}

/* The box that bodies are taken out beyond. */
static scree_scene_reach bounds_of(const scree_scene *scene) {
  scree_scene_reach reach = scree_scene_domain(scene);
  const scree_plan_domain *d = scene->plan.domain;
  if (d) memcpy(reach.low, d->min, sizeof reach.low);
  if (d) memcpy(reach.high, d->max, sizeof reach.high);
  return reach;
}

/* Whether a point that begins there leaves the domain before it meets anything. */
static bool falls_past(const scree_scene *scene, const scree_scene_reach *bounds, vec3 at,
                       vec3 velocity, double chord) {
  vec3 g = vec3_load(scene->plan.gravity);
  double step = chord / sqrt(vec3_norm2(velocity) + 2 * vec3_norm(g) * CHORDS * chord), p[3];
  size_t wall;
  for (int i = 0; i < MOST_CHORDS; i++) {
    vec3 next = vec3_mad(vec3_mad(at, velocity, step), g, 0.5 * step * step);
    velocity = vec3_mad(velocity, g, step);
    if (is_in_outlet(scene, next) || is_parted(scene, at, next, &wall)) return false;
    at = next;
    vec3_store(p, at);
    if (!scree_is_in(p, bounds->low, bounds->high)) return true;
  }
  return false;
}

static void measure_falls(const places *p, vec3 velocity, scree_scene_starts *starts) {
  const scree_scene *scene = p->scene;
  scree_scene_reach bounds = bounds_of(scene);
  double longest = 0;
  int past = 0;
  for (int k = 0; k < 3; k++)
    if (isfinite(bounds.high[k] - bounds.low[k]))
      longest = fmax(longest, bounds.high[k] - bounds.low[k]);
  bool moves = vec3_norm(velocity) > 0 || vec3_norm(vec3_load(scene->plan.gravity)) > 0;
  for (int i = 0; moves && longest > 0 && i < p->count; i++)
    past += falls_past(scene, &bounds, p->at[i], velocity, longest / CHORDS);
  starts->past = past < told_share * p->count ? 0 : (double)past / p->count;
}

static bool is_periodic(const scree_scene *scene) {
  const double *period = scene->world->options.period;
  return period[0] > 0 || period[1] > 0 || period[2] > 0;
}

bool scree_scene_look_at_starts(const scree_scene *scene, size_t index,
                                scree_scene_starts *starts) {
  const scree_plan_inlet *plan = scene->inlets[index].plan;
  places p = {.scene = scene};
  scree_rng rng = {scene->plan.seed, STREAM + index, 0};
  *starts = (scree_scene_starts){0};
  if ((plan->layers && plan->layers->in) || !scree_world_wall_count(scene->world)) return false;
  for (int i = 0; i < DRAWS && p.count < PLACES; i++) {
    scree_placement body;
    size_t wall;
    if (!scree_scene_draw_start(scene, index, (size_t)i % plan->shapes.count, &rng, &body) ||
        !scree_scene_is_clear(scene, &body, &wall))
      continue;
    p.at[p.count++] = body.position;
  }
  if (!p.count) return false;
  measure_parts(&p, starts);
  if (!is_periodic(scene)) measure_falls(&p, vec3_load(plan->velocity), starts);
  return starts->parted > 0 || starts->past > 0;
}
