/* What can be said of a scene before its first step, what it will cost and what is probably a slip,
 * and what its end is to be doubted for. An inlet that places at random holds a quarter of its
 * volume, or little more; what it holds makes room by falling out of it. */
#include "base/number.h"
#include "scene/geometry.h"
#include "scene/motions.h"
#include "scene/region.h"
#include "scene/sensors/sensor.h"
#include "scene/starts.h"

static const double random_packing = 0.25; /* share of a region's volume that random places fill */
/* A step on one core. It counts as much as a share of all steps that were measured: bodies that
 * still fly cost a fraction of those in contact. */
static const double body_seconds = 5e-7, mesh_seconds = 1.5e-6, trusted_share = 0.06;
/* Share of its time that a phase lasts which ends early where all is still. */
static const double early_share = 0.4;
static const double body_bytes = 104, triangle_bytes = 60; /* of a frame */
enum { MOST_DIFFERENT = 300 }; /* times as large as all else, or as small: another unit */

/* ---- inlets ---- */

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
  double holds =
             random_packing * scree_region_volume(&SCREE_REGION_OF(plan), along, &height) / volume,
         speed = vec3_norm(v), fall = fmax(0, vec3_dot(g, along)),
         clears = (speed + sqrt(speed * speed + 2 * fall * height)) / (2 * height); /* 1/s */
  *can = fmax(1, holds) * (1 + time * clears);
  return wanted;
}

/* ---- remarks ---- */

/* Shares of a body's size: contacts that give way by less than the first are stiffer than flows can
 * tell; the second is usual. */
static const double stiff_share = 3e-4, usual_share = 1e-2;
/* In narrower cylinders, in particles, the wall shares in the angle; with fewer particles than
 * make a heap wider than the cylinder by so much, there is none. */
static const double narrow = 9.99, wide_share = 1.3, fewest = 200;

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

/* Particles that a heap of a flank of 30 degrees needs to be so many wide at its foot: a cone of
 * 0.6 of solid volume. */
static double count_for(double radius) {
  return radius * radius * radius / 1.44;
}

/* Whether a cylinder that is filled and lifted, whose heap is to be measured, is too small: narrow
 * ones jam, few particles make no heap. What would do, and what it costs. */
static bool falls_short(const scree_scene *scene, const scree_scene_inlet *inlet,
                        char why[SCREE_REMARK], double *seconds) {
  double size = inlet->layers.size, across = 2 * inlet->layers.radius / size,
         wide = fmax(across, 10), count = (double)inlet->plan->count,
         enough = fmax(fewest, ceil(count_for(0.5 * wide_share * wide)));
  scree_scene_forecast f;
  if (!inlet->plan->layers || !(across > 0) || !scree_scene_pile_name(scene, 0)) return false;
  if (across >= narrow && count >= enough) return false;
  scree_scene_foretell(scene, &f);
  *seconds = (f.seconds + scree_scene_get_costs(scene).processor_seconds) * fmax(1, enough / count);
  if (across < narrow)
    snprintf(why, SCREE_REMARK,
             "the cylinder is %.3g m wide, %.2g particles; ten are needed, or they may hang and "
             "its wall shares in the angle: one of %.3g m with %.0f particles would do",
             across * size, across, 10 * size, fmax(count, enough));
  else
    snprintf(why, SCREE_REMARK,
             "%.0f particles in a cylinder %.3g of them wide make no heap that is wider; %.0f "
             "would do",
             count, across, enough);
  return true;
}

bool scree_scene_no_angle(const scree_scene *scene, char why[SCREE_REMARK], double *seconds) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    if (falls_short(scene, &scene->inlets[i], why, seconds)) return true;
  return false;
}

static void remark_cylinders(const scree_scene *scene, remarks *r) {
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    const scree_scene_inlet *inlet = &scene->inlets[i];
    char why[SCREE_REMARK], cost[SCREE_NUMBER_SIZE];
    double seconds;
    if (!falls_short(scene, inlet, why, &seconds) || !is_asked(r)) continue;
    scree_seconds_text(seconds, cost);
    snprintf(r->text, SCREE_REMARK, "%s: too small for an angle: %.700s, in about %s",
             inlet->plan->place.path, why, cost);
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
  const vec3 up = {0, 0, 1};
  double largest = 0, height;
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    largest = fmax(largest,
                   cbrt(scree_region_volume(&SCREE_REGION_OF(scene->inlets[i].plan), up, &height)));
  for (size_t i = 0; i < scene->plan.geometry.count; i++)
    if (i != geometry) largest = fmax(largest, diagonal_of(scene, i));
  return largest;
}

static void remark_units(const scree_scene *scene, remarks *r) {
  for (size_t i = 0; i < scene->plan.geometry.count; i++) {
    const scree_plan_geometry *g = &scene->plan.geometry.items[i];
    const char *name = scree_geometry_file_name(g, 0);
    double here = diagonal_of(scene, i), other = largest_other(scene, i);
    bool fits = !(here > 0) || !(other > 0) ||
                (here < MOST_DIFFERENT * other && MOST_DIFFERENT * here > other);
    if (!fits && is_asked(r))
      snprintf(r->text, SCREE_REMARK,
               "%s: %.60s is %.3g m across and all else %.3g m: is its unit right?", g->place.path,
               name ? name : "it", here, other);
  }
}

static void remark_rotations(const scree_scene *scene, remarks *r) {
  double axis[3];
  for (size_t i = 0; i < scene->plan.geometry.count; i++)
    if (scree_motions_sweep(scene, i, axis) && is_asked(r))
      snprintf(r->text, SCREE_REMARK,
               "%s: turns about [%g, %g, %g] through the origin, which is not the cylinder's axis, "
               "so that it sweeps about: `rotate` takes `axis` and `through`",
               scene->plan.geometry.items[i].place.path, axis[0], axis[1], axis[2]);
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
  char text[SCREE_REMARK];
  if (scree_scene_describe_softness(scene, text) && is_asked(r))
    snprintf(r->text, SCREE_REMARK, "%s", text);
  scree_scene_soft(scene, &soft);
  if (soft.least > 0 && soft.least < stiff_share && is_asked(r))
    snprintf(r->text, SCREE_REMARK,
             "materials: the stiffest contact gives way by at most %.2g of a body's size, and 0.01 "
             "is usual: with `young` lower by a factor of %.1g a run takes 1/%.2g of the steps",
             soft.least, pow(usual_share / soft.least, 2), usual_share / soft.least);
}

/* False where no geometry closes on bodies. */
static bool describe_pinch(const scree_scene *scene, char text[SCREE_REMARK]) {
  scree_scene_pinch p;
  if (!scree_scene_pinches(scene, duration_of(scene), &p)) return false;
  snprintf(text, SCREE_REMARK,
           "geometry.%.60s: closes on '%.60s' from %.3g to %.3g mm, where a '%.60s' may be: it is "
           "pressed in by %.3g mm, and beyond %.3g contacts harden, for walls press as hard as it "
           "takes; no stiffness, but a gap of %.3g mm or more would keep it soft",
           scree_scene_geometry_name(scene, p.geometry[0]),
           scree_scene_geometry_name(scene, p.geometry[1]), 1e3 * p.wide, 1e3 * p.narrow,
           scree_scene_shape_name(scene, p.shape), 1e3 * p.overlap, 1e3 * p.limit, 1e3 * p.room);
  return true;
}

/* The last two, for they take longest. */
static void remark_pinches(const scree_scene *scene, remarks *r) {
  char text[SCREE_REMARK];
  if (r->count <= r->wanted && describe_pinch(scene, text) && is_asked(r))
    snprintf(r->text, SCREE_REMARK, "%s", text);
}

static void remark_starts(const scree_scene *scene, remarks *r) {
  for (size_t i = 0; i < scene->plan.inlets.count && r->count <= r->wanted; i++) {
    const char *path = scene->inlets[i].plan->place.path;
    scree_scene_starts s;
    size_t gate;
    if (scree_scene_passes_gate(scene, i, &gate) && is_asked(r))
      snprintf(r->text, SCREE_REMARK,
               "%s: bodies get past '%s' to where they leave while it still stands: does it close "
               "the opening?",
               path, scree_scene_geometry_name(scene, gate));
    if (!scree_scene_look_at_starts(scene, i, &s)) continue;
    if (s.taken > 0 && is_asked(r))
      snprintf(r->text, SCREE_REMARK,
               "%s: about %.0f %% of the bodies start in the outlet '%s', which takes them out at "
               "once",
               path, 100 * s.taken, scree_scene_outlet_name(scene, s.taken_by));
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
  remark_rotations(scene, &r);
  remark_frames(scene, &r);
  remark_pinches(scene, &r);
  remark_starts(scene, &r);
  if (r.count == index && scree_scene_bodies_overlap(scene, text)) return true; /* a step's work */
  return r.count > index;
}

/* ---- of its end ---- */

/* Steps of Hertz's law suit the speed that was foreseen. */
static bool doubt_steps(const scree_scene *scene, char text[SCREE_REMARK]) {
  static const double told = 1.5; /* times that */
  const scree_plan_contact *contact = scene->plan.contact;
  const double foreseen = scene->gallery->hit_speed;
  double fastest = 0;
  size_t column = 0;
  if (scene->world->options.law != SCREE_LAW_HERTZ || contact->time_step > 0) return false;
  while (strcmp(scene->columns.items[column].name, "highest_speed") != 0) column++;
  for (size_t r = 0; r < scene->row_count; r++)
    fastest = fmax(fastest, scene->series.items[r * scene->columns.count + column]);
  if (!(fastest > told * foreseen)) return false;
  snprintf(text, SCREE_REMARK,
           "warning: bodies moved at up to %.3g m/s, and the steps suit hits at %.3g, as inlets, "
           "falls and walls give: contact.steps %.0f would follow them",
           fastest, foreseen, ceil(contact->steps * pow(fastest / foreseen, 0.2)));
  return true;
}

/* Some contacts hardened, and geometry closes on bodies, for which no stiffness is enough. */
static bool doubt_stiffness(const scree_scene *scene, char text[SCREE_REMARK]) {
  scree_scene_hardening h;
  return scree_scene_get_hardening(scene, 0, &h) && describe_pinch(scene, text);
}

bool scree_scene_doubt(const scree_scene *scene, size_t index, char text[SCREE_REMARK]) {
  for (size_t i = 0; i < scene->plan.sensors.count; i++) {
    const scree_scene_sensor *s = &scene->sensors[i];
    if (s->kind->doubt && s->kind->doubt(scene, s, text) && index-- == 0) return true;
  }
  if (scree_scene_doubt_energy(scene, text) && index-- == 0) return true;
  if (doubt_steps(scene, text) && index-- == 0) return true;
  return doubt_stiffness(scene, text) && index == 0;
}

/* ---- cost ---- */

/* Simulated time that is left, as it is expected: phases that may end early do. */
static double time_left(const scree_scene *scene) {
  double now = scree_world_time(scene->world), left = 0;
  if (scene->plan.phases.count == 0 || isfinite(scree_scene_duration(scene)))
    return fmax(0, duration_of(scene) - now);
  for (size_t i = scene->phase; i < scene->plan.phases.count; i++) {
    const scree_plan_phase *p = &scene->plan.phases.items[i];
    double time = p->time * (!isnan(p->still) && p->early ? early_share : 1);
    left += i == scene->phase ? fmax(0, time - (now - scene->phase_start)) : time;
  }
  return left;
}

/* Time until all that an inlet lets in are there. */
static double fill_time(const scree_scene *scene, const scree_plan_inlet *inlet) {
  double end = fmin(duration_of(scene), isnan(inlet->until) ? INFINITY : inlet->until);
  if (inlet->layers) return isnan(inlet->layers->pack_time) ? 0 : inlet->layers->pack_time;
  return inlet->count && !isnan(inlet->rate) ? fmin(end, (double)inlet->count / inlet->rate) : end;
}

/* So many steps of bodies on one core: as they were so far, and by what their kind usually costs.
 */
static double cost_of(const scree_scene *scene, double steps) {
  scree_scene_costs c = scree_scene_get_costs(scene);
  double seconds = 0, done = (double)c.body_steps, usual = trusted_share * (steps + done);
  for (size_t s = 0; s < SCREE_SCENE_SHAPES(scene); s++)
    seconds = fmax(seconds, scene->shapes[s].particle->face_count ? mesh_seconds : body_seconds);
  return usual > 0 ? steps * (c.processor_seconds + usual * seconds) / (done + usual) : 0;
}

void scree_scene_foretell(const scree_scene *scene, scree_scene_forecast *forecast) {
  scree_scene_forecast f = {0};
  double time = duration_of(scene), now = scree_world_time(scene->world), triangles = 0,
         left = time_left(scene), missing = 0;
  f.step_count = fmax(0, ceil((time - now) / scene->time_step));
  f.frame_interval = scene->plan.output->frames;
  f.frames_are_instances = scene->plan.output->bodies == 0;
  (void)scree_world_time_step(scene->gallery, f.time_step_reason);
  f.body_count = (double)scene->shape_of.count; /* from a table, or before it goes on */
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    const scree_plan_inlet *plan = scene->inlets[i].plan;
    double can, wanted = wanted_of(scene, &scene->inlets[i], &can),
                entered = (double)scene->inlets[i].entered, come = floor(fmin(wanted, can));
    f.body_count += come - entered;
    if (come > 0) /* half of what is to come, until it has */
      missing += 0.5 * (come - entered) * fmin(left, fill_time(scene, plan) * (1 - entered / come));
  }
  for (size_t w = 0; w < scree_world_wall_count(scene->world); w++)
    triangles += (double)scree_scene_wall_cells(scene, w);
  f.body_steps = f.step_count * f.body_count;
  f.seconds = cost_of(scene, fmax(0, left * f.body_count - missing) / scene->time_step);
  double interval = scene->plan.output->frames;
  double frames_before = now > 0 ? floor(now / interval) + 1 : 0;
  if (interval > 0) f.frame_count = fmin(floor(time / interval) + 1 - frames_before, f.step_count);
  f.frame_bytes = body_bytes * f.body_count + triangle_bytes * triangles;
  *forecast = f;
}
