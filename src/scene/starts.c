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

typedef struct body_frame {
  vec3 position;
  mat3 rotation;
} body_frame;

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

/* ---- bodies of a table ---- */

/* What a start may lie in a sheet, as a share of the body's size: it comes out on its own side. */
static const double held_share = 0.04;

/* Whether a sheet passes through the body, drawn towards its centre by that share: through an edge
 * of a mesh, or near the centre of a sphere. */
static bool is_pierced(const scree_world_wall *wall, const scree_particle *particle,
                       const body_frame *body) {
  const scree_mesh *mesh = &particle->mesh;
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  vec3 at = body->position;
  mat3 into = mat3_tmul(&wall->frame.rotation, &body->rotation);
  vec3 centre = mat3_tmul_vec(&wall->frame.rotation, vec3_sub(at, wall->frame.position));
  if (!scree_is_near(wall->surface, centre, m.bounding_radius)) return false;
  for (size_t i = 0; m.kind != SCREE_PARTICLE_MESH && i < m.point_count; i++) {
    double p[3], radius;
    scree_particle_point(particle, i, p, &radius);
    if (scree_is_near(wall->surface, vec3_add(centre, mat3_mul_vec(&into, vec3_load(p))),
                      (1 - 2 * held_share) * radius))
      return true;
  }
  for (size_t e = 0; m.kind == SCREE_PARTICLE_MESH && e < 3 * mesh->triangle_count; e++) {
    const uint32_t *t = mesh->triangles + e / 3 * 3;
    vec3 ends[2] = {vec3_load(mesh->positions + 3 * (size_t)t[e % 3]),
                    vec3_load(mesh->positions + 3 * (size_t)t[(e + 1) % 3])};
    for (int k = 0; k < 2; k++)
      ends[k] = vec3_add(centre, vec3_scale(mat3_mul_vec(&into, ends[k]), 1 - 2 * held_share));
    vec3 way = vec3_sub(ends[1], ends[0]);
    scree_ray_interval ray = {ends[0], vec3_unit(way), 0, vec3_norm(way)};
    uint32_t face;
    if (scree_next_passage(wall->surface, &ray, 0, SIZE_MAX, &face) < INFINITY) return true;
  }
  return false;
}

scree_status scree_scene_check_pierced(const scree_scene *scene, scree_error *error) {
  for (size_t w = 0; w < scree_world_wall_count(scene->world); w++) {
    const scree_world_wall *wall = scree_world_wall_at(scene->world, w);
    if (!wall->surface || !wall->surface->sheet) continue;
    scree_body body;
    for (size_t b = 0; scree_scene_next_body(scene, &b, &body); b++) {
      const body_frame placed = {vec3_load(body.position), quat_to_mat3(scree_body_turn(&body))};
      size_t shape = scene->shape_of.items[b];
      if (!is_pierced(wall, scene->shapes[shape].particle, &placed)) continue;
      return scree_scene_fail(
          scene, &scene->plan.bodies->place, error,
          "the sheet '%s' passes through body %zu, a '%s' at (%g, %g, %g): a sheet holds what "
          "begins on one side of it",
          scree_scene_geometry_name(scene, scree_scene_wall_geometry(scene, w)), b + 1,
          scree_scene_shape_name(scene, shape), body.position[0], body.position[1],
          body.position[2]);
    }
  }
  return SCREE_OK;
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

/* Whether a place is in an outlet, of which is told; `open`: in one that is so from the start. */
static bool is_in_outlet(const scree_scene *scene, vec3 at, bool open, size_t *which) {
  double p[3];
  vec3_store(p, at);
  for (size_t i = 0; i < scene->plan.outlets.count; i++) {
    const scree_plan_outlet *o = &scene->plan.outlets.items[i];
    if ((open && o->from > 0) || !scree_is_in(p, o->box->min, o->box->max)) continue;
    *which = i;
    return true;
  }
  return false;
}

static void measure_taken(const places *p, scree_scene_starts *starts) {
  int taken = 0;
  for (int i = 0; i < p->count; i++)
    taken += is_in_outlet(p->scene, p->at[i], true, &starts->taken_by);
  starts->taken = taken < told_share * p->count ? 0 : (double)taken / p->count;
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
    if (is_in_outlet(scene, next, false, &wall) || is_parted(scene, at, next, &wall)) return false;
    at = next;
    vec3_store(p, at);
    if (!scree_is_in(p, bounds->low, bounds->high)) return true;
  }
  return true; /* along planes and cylinders without an end */
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

/* ---- round a gate ---- */

/* Walls are asked with whole bodies: each falls a stride where it can and else goes one to some
 * side, never up, for others would push it anywhere that is not above. */
enum { WALKS = 12, STRIDES = 4000 };

/* Whether the geometry stands at first and is drawn away later, as what closes an opening is. */
static bool is_gate(const scree_scene *scene, const scree_plan_geometry *g, double time) {
  if (g->slide || g->hinge) return (g->slide ? g->slide->from : g->hinge->from) > time;
  for (size_t i = 0; i < g->motion.count; i++) {
    const scree_plan_motion *m = &g->motion.items[i];
    bool later =
        m->during ? strcmp(m->during, scene->plan.phases.items[0].place.name) != 0 : m->from > time;
    if (!(m->translate || m->path) || !later) return false;
  }
  return g->motion.count > 0;
}

static bool step_clear(const scree_scene *scene, scree_placement *body, vec3 way) {
  scree_placement next = *body;
  size_t wall;
  next.position = vec3_add(body->position, way);
  scree_placement_settle(&next);
  if (!scree_scene_is_clear(scene, &next, &wall)) return false;
  *body = next;
  return true;
}

/* Whether the body gets to an outlet, or out of the domain, while all stands as at the start. */
static bool gets_out(const scree_scene *scene, scree_placement *body, scree_rng *rng) {
  scree_scene_reach bounds = bounds_of(scene);
  vec3 down = vec3_unit(vec3_load(scene->plan.gravity));
  double stride = 0.9 * fmin(body->half.x, fmin(body->half.y, body->half.z)), p[3];
  size_t outlet;
  for (int i = 0; i < STRIDES; i++) {
    if (!step_clear(scene, body, vec3_scale(down, stride))) {
      vec3 side = scree_rng_direction(rng);
      side = vec3_unit(vec3_mad(side, down, -vec3_dot(side, down)));
      step_clear(scene, body, vec3_scale(side, stride));
    }
    vec3_store(p, body->position);
    if (is_in_outlet(scene, body->position, true, &outlet) ||
        !scree_is_in(p, bounds.low, bounds.high))
      return true;
  }
  return false;
}

bool scree_scene_passes_gate(const scree_scene *scene, size_t index, size_t *gate) {
  const scree_plan_inlet *plan = scene->inlets[index].plan;
  scree_rng rng = {scene->plan.seed, STREAM / 2 + index, 0};
  size_t count = scene->plan.geometry.count, wall;
  for (*gate = 0; *gate < count; ++*gate)
    if (is_gate(scene, &scene->plan.geometry.items[*gate], plan->from)) break;
  if (*gate == count || is_periodic(scene) || !(vec3_norm(vec3_load(scene->plan.gravity)) > 0) ||
      (plan->layers && plan->layers->in))
    return false;
  for (int i = 0, walks = 0; i < DRAWS && walks < WALKS; i++) {
    scree_placement body;
    if (!scree_scene_draw_start(scene, index, (size_t)i % plan->shapes.count, &rng, &body) ||
        !scree_scene_is_clear(scene, &body, &wall))
      continue;
    walks++;
    if (gets_out(scene, &body, &rng)) return true;
  }
  return false;
}

bool scree_scene_look_at_starts(const scree_scene *scene, size_t index,
                                scree_scene_starts *starts) {
  const scree_plan_inlet *plan = scene->inlets[index].plan;
  places p = {.scene = scene};
  scree_rng rng = {scene->plan.seed, STREAM + index, 0};
  *starts = (scree_scene_starts){0};
  bool walls = scree_world_wall_count(scene->world) > 0;
  if ((plan->layers && plan->layers->in) || (!walls && !scene->plan.outlets.count)) return false;
  for (int i = 0; i < DRAWS && p.count < PLACES; i++) {
    scree_placement body;
    size_t wall;
    if (!scree_scene_draw_start(scene, index, (size_t)i % plan->shapes.count, &rng, &body) ||
        !scree_scene_is_clear(scene, &body, &wall))
      continue;
    p.at[p.count++] = body.position;
  }
  if (!p.count) return false;
  measure_taken(&p, starts);
  if (walls) measure_parts(&p, starts);
  if (walls && !is_periodic(scene)) measure_falls(&p, vec3_load(plan->velocity), starts);
  return starts->parted > 0 || starts->past > 0 || starts->taken > 0;
}
