/* What can be said of a scene before its first step: what it will cost, and what is probably a
 * slip. An inlet that places at random holds a quarter of its volume, or little more; what it holds
 * makes room by falling out of it. */
#include "scene/starts.h"

static const double random_packing = 0.25; /* share of a region's volume that random places fill */
static const double body_seconds = 1e-6, mesh_seconds = 3e-6; /* a step, at rest, on one core */
static const double body_bytes = 97, triangle_bytes = 60;     /* of a frame */
enum { MOST_DIFFERENT = 300 }; /* times as large as all else, or as small: another unit */

/* ---- inlets ---- */

static double region_volume(const scree_plan_inlet *inlet, double *height, vec3 along) {
  const scree_plan_cylinder *c = inlet->cylinder;
  if (c) {
    vec3 axis = vec3_unit(vec3_load(c->axis));
    double cosine = fmin(1, fabs(vec3_dot(axis, along))), sine = sqrt(1 - cosine * cosine);
    *height = c->length * cosine + 2 * c->radius * sine;
    return 3.141592653589793 * c->radius * c->radius * c->length;
  }
  *height = 0;
  if (!inlet->box) return 0; /* layers in a geometry */
  vec3 sides = vec3_sub(vec3_load(inlet->box->max), vec3_load(inlet->box->min));
  *height = fabs(along.x) * sides.x + fabs(along.y) * sides.y + fabs(along.z) * sides.z;
  return sides.x * sides.y * sides.z;
}

/* Means by number over the inlet's shapes. */
static void mean_body(const scree_scene *scene, const scree_scene_inlet *inlet, double *volume,
                      double *mass) {
  const scree_weights *w = &inlet->plan->shapes;
  double shares = 0;
  *volume = *mass = 0;
  for (size_t k = 0; k < w->count; k++) {
    const scree_scene_shape *s = &scene->shapes[inlet->shapes[k]];
    *volume += w->values[k] * s->volume;
    *mass += w->values[k] * s->mass;
    shares += w->values[k];
  }
  *volume /= shares;
  *mass /= shares;
}

static double duration_of(const scree_scene *scene) {
  double time = scree_scene_duration(scene);
  return isfinite(time) ? time : scree_scene_phase_times(scene);
}

/* How many bodies the inlet is to let in, and how many it can; infinity where that is not known. */
static double wanted_of(const scree_scene *scene, const scree_scene_inlet *inlet, double *can) {
  const scree_plan_inlet *plan = inlet->plan;
  double volume, mass, height, end = duration_of(scene);
  *can = INFINITY;
  mean_body(scene, inlet, &volume, &mass);
  if (!isnan(plan->until)) end = fmin(end, plan->until);
  double time = fmax(0, end - plan->from), wanted = plan->count ? (double)plan->count : INFINITY;
  if (!isnan(plan->rate)) wanted = fmin(wanted, ceil(plan->rate * time));
  if (!isnan(plan->mass_rate)) wanted = fmin(wanted, ceil(plan->mass_rate * time / mass));
  if (plan->layers) return wanted;
  vec3 g = vec3_load(scene->plan.gravity), v = vec3_load(plan->velocity),
       along = vec3_norm(v) > 0 ? v : g;
  if (!(vec3_norm(along) > 0)) along = (vec3){0, 0, 1};
  along = vec3_unit(along);
  double holds = random_packing * region_volume(plan, &height, along) / volume,
         speed = vec3_norm(v), fall = fmax(0, vec3_dot(g, along)),
         clears = (speed + sqrt(speed * speed + 2 * fall * height)) / (2 * height); /* 1/s */
  *can = fmax(1, holds) * (1 + time * clears);
  return wanted;
}

/* ---- remarks ---- */

/* Of a body's size: contacts that give way by less than the first are stiffer than flows can tell;
 * the second is usual. */
static const double stiff_share = 3e-4, usual_share = 1e-2;
/* Cylinders of fewer particles across are told; the paper's has five. */
static const double narrow = 4.999;

typedef struct remarks {
  size_t wanted, count;
  char *text;
} remarks;

/* Whether the next remark is the one that is asked for. */
static bool is_asked(remarks *r) {
  return r->count++ == r->wanted;
}

static void remark_inlets(const scree_scene *scene, remarks *r) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    double can, wanted = wanted_of(scene, &scene->inlets[i], &can);
    bool open = isinf(wanted) || wanted <= 2 * can;
    if (!open && is_asked(r))
      snprintf(r->text, SCREE_REMARK,
               "%s: of %.0f bodies about %.0f will find room: a larger region, a longer time, a "
               "higher velocity, or layers",
               scene->inlets[i].plan->place.path, wanted, can);
  }
}

/* A cylinder that is filled and lifted: narrow ones jam. */
static void remark_cylinders(const scree_scene *scene, remarks *r) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    const scree_scene_inlet *inlet = &scene->inlets[i];
    double size = inlet->layers.size, width = 2 * inlet->layers.radius;
    if (inlet->plan->layers && width > 0 && width < narrow * size && is_asked(r))
      snprintf(r->text, SCREE_REMARK,
               "%s: the cylinder is %.3g m wide, %.2g particles: below five they may hang in it, "
               "below ten its wall shares in the angle",
               inlet->plan->place.path, width, width / size);
  }
}

static void remark_densities(const scree_scene *scene, remarks *r) {
  for (size_t m = 0; m < scene->plan.materials.count; m++) {
    const scree_plan_material *material = &scene->plan.materials.items[m];
    bool used = false;
    for (size_t s = 0; s < SCREE_SCENE_SHAPES(scene); s++)
      used = used || (scene->shapes[s].material == m && !(scene->plan.shapes.items[s].density > 0));
    if (used && scene->usual_density && scene->usual_density[m] && is_asked(r))
      snprintf(r->text, SCREE_REMARK, "%s: no density is given: %g kg/m3 is taken",
               material->place.path, material->density);
  }
}

/* m: diagonal of a geometry's box; 0 where it has no end or no surface. */
static double diagonal_of(const scree_scene *scene, size_t geometry) {
  const scree_scene_geometry *g = &scene->geometry[geometry];
  scree_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (size_t w = g->first_wall; w < g->first_wall + g->wall_count; w++) {
    const scree_particle *surface = scree_world_wall_at(scene->world, w)->surface;
    if (!surface) return 0;
    box.low = vec3_min(box.low, surface->box.low);
    box.high = vec3_max(box.high, surface->box.high);
  }
  return vec3_distance(box.low, box.high);
}

/* The largest of inlets and of other geometry. */
static double largest_other(const scree_scene *scene, size_t geometry) {
  double largest = 0, height;
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    largest = fmax(largest, cbrt(region_volume(scene->inlets[i].plan, &height, (vec3){0, 0, 1})));
  for (size_t i = 0; i < scene->plan.geometry.count; i++)
    if (i != geometry) largest = fmax(largest, diagonal_of(scene, i));
  return largest;
}

static void remark_units(const scree_scene *scene, remarks *r) {
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    const scree_plan_geometry *g = &scene->plan.geometry.items[i];
    double here = diagonal_of(scene, i), other = largest_other(scene, i);
    bool fits = !(here > 0) || !(other > 0) ||
                (here < MOST_DIFFERENT * other && MOST_DIFFERENT * here > other);
    if (!fits && is_asked(r))
      snprintf(r->text, SCREE_REMARK,
               "%s: %.60s is %.3g m across and all else %.3g m: is its unit right?", g->place.path,
               g->file.count ? g->file.items[0] : "it", here, other);
  }
}

static void remark_frames(const scree_scene *scene, remarks *r) {
  scree_scene_forecast f;
  double interval = scene->plan.output->frames;
  scree_scene_foretell(scene, &f);
  if (interval > 0 && interval < scene->time_step && is_asked(r))
    snprintf(r->text, SCREE_REMARK,
             "output.frames: %g s is shorter than a time step of %.3g s: there is a frame for "
             "every step",
             interval, scene->time_step);
  if (f.frame_count > 20000 && is_asked(r))
    snprintf(r->text, SCREE_REMARK, "output.frames: %.0f frames, up to %.3g GB", f.frame_count,
             1e-9 * f.frame_count * f.frame_bytes);
}

static void remark_softness(const scree_scene *scene, remarks *r) {
  scree_scene_softness soft;
  if (scree_scene_soft(scene, &soft) && is_asked(r))
    scree_scene_describe_softness(scene, &soft, r->text, SCREE_REMARK);
  if (soft.least > 0 && soft.least < stiff_share && is_asked(r))
    snprintf(r->text, SCREE_REMARK,
             "materials: the stiffest contact gives way by at most %.2g of a body's size, and 0.01 "
             "is usual: with `young` lower by a factor of %.1g a run takes 1/%.2g of the steps",
             soft.least, pow(usual_share / soft.least, 2), usual_share / soft.least);
}

/* The last, for it takes longest. */
static void remark_starts(const scree_scene *scene, remarks *r) {
  for (size_t i = 0; i < scene->plan.inlets.count && r->count <= r->wanted; i++) {
    const char *path = scene->inlets[i].plan->place.path;
    scree_scene_starts s;
    if (!scree_scene_look_at_starts(scene, i, &s)) continue;
    if (s.parted > 0 && is_asked(r))
      snprintf(
          r->text, SCREE_REMARK,
          "%s: '%s' cuts the region in parts: about %.0f %% of the bodies start outside of its "
          "largest part",
          path, scree_scene_geometry_name(scene, s.parted_by), 100 * s.parted);
    if (s.past > 0 && is_asked(r))
      snprintf(
          r->text, SCREE_REMARK,
          "%s: about %.0f %% of the bodies start where they fall past all geometry and outlets",
          path, 100 * s.past);
  }
}

bool scree_scene_remark(const scree_scene *scene, size_t index, char text[SCREE_REMARK]) {
  remarks r = {.wanted = index, .text = text};
  remark_softness(scene, &r);
  remark_densities(scene, &r);
  remark_units(scene, &r);
  remark_inlets(scene, &r);
  remark_cylinders(scene, &r);
  remark_frames(scene, &r);
  remark_starts(scene, &r);
  return r.count > index;
}

/* ---- cost ---- */

void scree_scene_foretell(const scree_scene *scene, scree_scene_forecast *forecast) {
  scree_scene_forecast f = {0};
  double time = duration_of(scene), now = scree_world_time(scene->world), seconds = 0,
         triangles = 0;
  f.step_count = fmax(0, ceil((time - now) / scene->time_step));
  f.frame_interval = scene->plan.output->frames;
  f.frames_are_instances = scene->plan.output->bodies == 0;
  (void)scree_world_time_step(scene->gallery, f.time_step_reason);
  f.body_count = (double)scene->shape_of.count; /* from a table, or before it goes on */
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    f.body_count -= (double)scene->inlets[i].entered;
    double can, wanted = wanted_of(scene, &scene->inlets[i], &can);
    f.body_count += floor(fmin(wanted, can));
  }
  for (size_t s = 0; s < SCREE_SCENE_SHAPES(scene); s++)
    seconds = fmax(seconds, scene->shapes[s].particle->face_count ? mesh_seconds : body_seconds);
  for (size_t w = 0; w < scree_world_wall_count(scene->world); w++)
    triangles += (double)scree_scene_wall_cells(scene, w);
  f.body_steps = f.step_count * f.body_count;
  f.seconds = f.body_steps * seconds;
  double interval = scene->plan.output->frames;
  double frames_before = now > 0 ? floor(now / interval) + 1 : 0;
  if (interval > 0) f.frame_count = fmin(floor(time / interval) + 1 - frames_before, f.step_count);
  f.frame_bytes = body_bytes * f.body_count + triangle_bytes * triangles;
  *forecast = f;
}
