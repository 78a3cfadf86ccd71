/* Whether contacts are stiff enough for how fast bodies will hit: a linear spring is pressed by
 * v sqrt(m/K), and the law reads depths up to its limit only. The speed is that of the inlet and of
 * the fall from it to the wall's lowest, and beside that of the wall's motion; how much of it a
 * body has when it hits is not known, so what exceeds the limit is told. Bodies of a table
 * likewise, by their own speeds. Where the inlet's velocity alone would press a linear spring in by
 * a body's size no hardened one holds it, and it would come out on the far side: that is refused.
 *
 * A body of mass M that squeezes a light one between itself, by K1, and a wall, by K2, stops
 * against both springs in series, Ks = K1 K2/(K1 + K2), and so presses with v sqrt(M Ks): the
 * softer of the two gives way by v sqrt(M Ks)/min(K1, K2). */
#include "scene/motions.h"
#include "scene/region.h"
#include "scene/scene.h"

#include "world/state/parameters.h"

static const double passes = 1; /* of the size */
/* So many times as heavy as another, a body squeezes it and is not moved by it. */
static const double heavy = 4;

/* ---- speeds ---- */

static scree_scene_reach region_of(const scree_scene_inlet *inlet) {
  scree_scene_reach region;
  if (inlet->plan->layers && inlet->plan->layers->in) {
    vec3_store(region.low, inlet->layers.middle);
    vec3_store(region.high, inlet->layers.middle);
  } else {
    scree_region_bounds(&SCREE_REGION_OF(inlet->plan), region.low, region.high);
  }
  return region;
}

static const double steep = 0.05; /* cosine: steeper planes are sides, which stop no fall */

/* m: from the highest corner of a region down to the lowest of a wall, of a plane under the corner
 * that is farthest above it; below 0: it is under none of the region. */
static double fall_to_wall(const scree_scene *scene, const scree_scene_reach *region, vec3 down,
                           size_t index) {
  scree_scene_reach reach = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  scree_scene_take_in_wall(scene, index, &reach);
  scree_wall wall;
  scree_world_get_wall(scene->world, index, &wall);
  const vec3 at = vec3_load(wall.position), normal = vec3_unit(vec3_load(wall.axis));
  const bool plane = wall.kind == SCREE_WALL_PLANE;
  const double against = -vec3_dot(normal, down);
  if (plane && against < steep) return -INFINITY;
  double highest = INFINITY, lowest = -INFINITY, deepest = -INFINITY;
  for (int corner = 0; corner < 8; corner++) {
    double from[3], to[3];
    for (int k = 0; k < 3; k++) {
      from[k] = corner >> k & 1 ? region->high[k] : region->low[k];
      to[k] = corner >> k & 1 ? reach.high[k] : reach.low[k];
    }
    highest = fmin(highest, vec3_dot(vec3_load(from), down));
    if (!plane) lowest = fmax(lowest, vec3_dot(vec3_load(to), down));
    deepest = fmax(deepest, vec3_dot(normal, vec3_sub(vec3_load(from), at)) / against);
  }
  if (plane) return deepest;
  return isfinite(lowest) ? lowest - highest : -INFINITY;
}

/* m: along gravity, from the highest corner of a region to the first plane under it; where there is
 * none, to the lowest of the geometry. */
static double fall_from(const scree_scene *scene, const scree_scene_reach *region) {
  const vec3 gravity = vec3_load(scene->plan.gravity);
  double planes = INFINITY, others = 0;
  for (size_t w = 0; vec3_norm(gravity) > 0 && w < scree_world_wall_count(scene->world); w++) {
    const double fall = fall_to_wall(scene, region, vec3_unit(gravity), w);
    if (scree_world_wall_at(scene->world, w)->given.kind != SCREE_WALL_PLANE)
      others = fmax(others, fall);
    else if (fall >= 0)
      planes = fmin(planes, fall);
  }
  return isfinite(planes) ? planes : others;
}

/* ---- contacts ---- */

typedef struct touching {
  size_t shape, other; /* other: a shape, or a wall's geometry */
  bool is_wall;
} touching;

static size_t material_of_wall(const scree_scene *scene, size_t geometry) {
  const size_t wall = scene->geometry[geometry].first_wall;
  return scree_world_wall_at(scene->world, wall)->given.material;
}

/* What a shape meets another shape or a geometry with: the mass of both in series, kg; the smaller
 * size, m; the stiffness, N/m, of Hertz's of a linear one that lasts as long, which gives 6 % less
 * at 1 m/s.
 */
typedef struct meeting {
  double mass, size, stiffness;
} meeting;

static meeting meet(const scree_scene *scene, const touching *t) {
  const scree_scene_shape *a = &scene->shapes[t->shape],
                          *b = t->is_wall ? NULL : &scene->shapes[t->other];
  meeting m = {.mass = a->mass, .size = a->particle->measures.size};
  if (b) {
    m.mass = a->mass * b->mass / (a->mass + b->mass);
    m.size = fmin(m.size, b->particle->measures.size);
  }
  const scree_contact_sides sides = {
      a->particle, b ? b->particle : NULL,
      a->material, b ? b->material : material_of_wall(scene, t->other),
      m.size,      m.mass};
  scree_pair_law law;
  scree_set_stiffness(scene->world, &sides, &law);
  m.stiffness = law.stiffness;
  return m;
}

typedef struct search {
  const scree_scene *scene;
  scree_scene_softness worst;
  double worst_share; /* of the limit */
  double least;       /* of the size: what the stiffest gives way; infinity: there is none */
  bool moving;        /* walls */
} search;

/* Bodies of an inlet, or of the table. */
typedef struct origin {
  size_t inlet, shape;
  double enters, gravity, falls; /* m/s, m/s2, m: at most */
  scree_scene_reach region;
} origin;

static void keep_worst(search *s, const scree_scene_softness *found) {
  const double share = found->overlap / found->limit;
  if (!(share > s->worst_share)) return;
  s->worst_share = share;
  s->worst = *found;
  s->worst.stiffer = share * share;
}

static void look(search *s, const origin *from, const touching *t, double speed) {
  const meeting m = meet(s->scene, t);
  const double overlap = speed * sqrt(m.mass / m.stiffness);
  s->least = fmin(s->least, overlap / m.size);
  keep_worst(s, &(scree_scene_softness){.inlet = from->inlet,
                                        .shape = t->shape,
                                        .other = t->other,
                                        .is_wall = t->is_wall,
                                        .squeezed = SIZE_MAX,
                                        .speed = speed,
                                        .energy = 0.5 * m.mass * speed * speed,
                                        .overlap = overlap,
                                        .limit = s->scene->world->options.overlap_limit * m.size,
                                        .size = m.size});
}

static double fastest_wall(const scree_scene *scene) {
  double fastest = 0;
  for (size_t g = 0; g < scene->plan.geometry.count; g++)
    fastest = fmax(fastest, scree_motions_fastest(scene, g));
  return fastest;
}

static double fallen(const origin *from, double falls) {
  return sqrt(from->enters * from->enters + 2 * from->gravity * falls);
}

/* What hits a geometry has fallen to its lowest. */
static double speed_on(const search *s, const origin *from, size_t geometry) {
  const scree_scene *scene = s->scene;
  const scree_scene_geometry *g = &scene->geometry[geometry];
  double falls = from->gravity > 0 ? -INFINITY : 0;
  for (size_t k = 0; falls < from->falls && k < g->wall_count; k++) {
    const vec3 down = vec3_unit(vec3_load(scene->plan.gravity));
    const double fall = fall_to_wall(scene, &from->region, down, g->first_wall + k);
    falls = fmax(falls, fall >= 0 ? fall : from->falls);
  }
  return fallen(from, fmin(falls, from->falls)) +
         (s->moving ? scree_motions_fastest(scene, geometry) : 0);
}

/* Everything that such a body may hit, at its speed and beside that at the walls' own. */
static void look_at_hits(search *s, const origin *from) {
  const scree_scene *scene = s->scene;
  touching t = {.shape = from->shape, .is_wall = true};
  for (t.other = 0; t.other < scene->plan.geometry.count; t.other++)
    look(s, from, &t, speed_on(s, from, t.other));
  t.is_wall = false;
  const double speed = fmax(fallen(from, from->falls), s->moving ? fastest_wall(scene) : 0);
  for (t.other = 0; t.other < SCREE_SCENE_SHAPES(scene); t.other++) look(s, from, &t, speed);
}

/* The lighter bodies that such a body may press against walls. */
static void look_at_squeezes(search *s, const origin *from) {
  const scree_scene *scene = s->scene;
  const double mass = scene->shapes[from->shape].mass;
  for (size_t k = 0; k < SCREE_SCENE_SHAPES(scene); k++) {
    if (scene->shapes[k].mass * heavy > mass) continue;
    const meeting above = meet(scene, &(touching){from->shape, k, false});
    for (size_t g = 0; g < scene->plan.geometry.count; g++) {
      const meeting below = meet(scene, &(touching){k, g, true});
      const double series = above.stiffness * below.stiffness / (above.stiffness + below.stiffness),
                   speed = speed_on(s, from, g);
      keep_worst(s,
                 &(scree_scene_softness){.inlet = from->inlet,
                                         .shape = from->shape,
                                         .other = g,
                                         .is_wall = true,
                                         .squeezed = k,
                                         .speed = speed,
                                         .energy = 0.5 * mass * speed * speed,
                                         .overlap = speed * sqrt(mass * series) /
                                                    fmin(above.stiffness, below.stiffness),
                                         .limit = scene->world->options.overlap_limit * below.size,
                                         .size = below.size});
    }
  }
}

double scree_scene_pinch_share(const scree_scene *scene, size_t shape, const size_t geometry[2]) {
  const double one = meet(scene, &(touching){shape, geometry[0], true}).stiffness,
               other = meet(scene, &(touching){shape, geometry[1], true}).stiffness;
  return fmax(one, other) / (one + other);
}

static double speed_of_inlet(const scree_scene_inlet *inlet) {
  return fmax(vec3_norm(vec3_load(inlet->plan->velocity)), inlet->layers.speed);
}

typedef void looker(search *s, const origin *from);

static double gravity_of(const scree_scene *scene) {
  return vec3_norm(vec3_load(scene->plan.gravity));
}

static origin origin_of_inlet(const scree_scene *scene, size_t index, double gravity) {
  const scree_scene_inlet *inlet = &scene->inlets[index];
  origin from = {.inlet = index, .enters = speed_of_inlet(inlet), .gravity = gravity};
  from.region = region_of(inlet);
  from.falls = gravity > 0 ? fall_from(scene, &from.region) : 0;
  return from;
}

double scree_scene_hit_speed(const scree_scene *scene) {
  static const double least = 0.1; /* what rests is pressed too */
  double speed = scene->plan.bodies ? 1 : least;
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    if (scene->inlets[i].plan->layers) {
      speed = fmax(speed, 1);
    } else {
      const origin from = origin_of_inlet(scene, i, gravity_of(scene));
      speed = fmax(speed, fallen(&from, from.falls));
    }
  return speed + fastest_wall(scene);
}

static void look_at_inlets(search *s, looker *at, double gravity) {
  const scree_scene *scene = s->scene;
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    const scree_scene_inlet *inlet = &scene->inlets[i];
    origin from = origin_of_inlet(scene, i, gravity);
    for (size_t k = 0; k < inlet->plan->shapes.count; k++) {
      from.shape = inlet->shapes[k];
      at(s, &from);
    }
  }
}

/* Those of a shape by the fastest of them, and the highest place of all. */
static void look_at_table(search *s, looker *at, double gravity) {
  const scree_scene *scene = s->scene;
  if (!scene->plan.bodies) return;
  origin from = {.inlet = SIZE_MAX, .gravity = gravity};
  memcpy(from.region.low, scene->table_low, sizeof from.region.low);
  memcpy(from.region.high, scene->table_high, sizeof from.region.high);
  from.falls = fall_from(scene, &from.region);
  for (size_t shape = 0; shape < SCREE_SCENE_SHAPES(scene); shape++) {
    double fastest = -1;
    for (size_t i = 0; i < scene->shape_of.count; i++) {
      scree_body body;
      if (scene->shape_of.items[i] != shape) continue;
      scree_world_get_body(scene->world, i, &body);
      fastest = fmax(fastest, vec3_norm(vec3_load(body.velocity)));
    }
    from.shape = shape;
    from.enters = fastest;
    if (fastest >= 0) at(s, &from);
  }
}

static bool look_at_all(search *s, looker *at, scree_scene_softness *softness) {
  const double gravity = gravity_of(s->scene);
  look_at_inlets(s, at, gravity);
  look_at_table(s, at, gravity);
  *softness = s->worst;
  softness->least = s->least;
  return s->worst_share > 1;
}

bool scree_scene_soft(const scree_scene *scene, scree_scene_softness *softness) {
  search s = {.scene = scene, .least = INFINITY, .moving = true};
  return look_at_all(&s, look_at_hits, softness);
}

bool scree_scene_squeezes(const scree_scene *scene, scree_scene_softness *softness) {
  search s = {.scene = scene, .least = INFINITY, .moving = true};
  return look_at_all(&s, look_at_squeezes, softness);
}

static const char *other_name(const scree_scene *scene, const scree_scene_softness *s) {
  return s->is_wall ? scree_scene_geometry_name(scene, s->other)
                    : scree_scene_shape_name(scene, s->other);
}

/* Pa: of the shape's material, that would hold; infinity where the other is too soft for any. Both
 * are in series, K = L / (1/Ea + 1/Eb). */
static double young_that_holds(const scree_scene *scene, const scree_scene_softness *s) {
  const scree_world *world = scene->world;
  size_t material = scene->shapes[s->shape].material,
         other = s->is_wall ? material_of_wall(scene, s->other) : scene->shapes[s->other].material;
  double a = world->materials.items[material].young, b = world->materials.items[other].young;
  if (material == other) return a * s->stiffer;
  double least = s->stiffer * a * b / (a + b);
  return least < b ? least * b / (b - least) : (double)INFINITY;
}

static void describe_remedy(const scree_scene *scene, const scree_scene_softness *s,
                            char text[200]) {
  const bool squeezed = s->squeezed < SIZE_MAX; /* of two contacts: all are to be stiffer */
  double young = squeezed ? (double)INFINITY : young_that_holds(scene, s),
         round = pow(10, floor(log10(young)) - 1);
  size_t material = scene->shapes[s->shape].material;
  if (isfinite(young) && scene->plan.materials.count)
    snprintf(text, 200, "materials.%.60s.young %.3g Pa or more",
             scene->plan.materials.items[material].place.name, ceil(young / round) * round);
  else
    snprintf(text, 200, "contact.stiffness_factor %.3g or more",
             ceil(10 * s->stiffer * scene->plan.contact->stiffness_factor) / 10);
}

/* A row of the table; the next place in the text. */
static char *describe_row(const scree_scene *scene, const scree_scene_softness *s, char *text,
                          const char *end) {
  char remedy[200], both[160];
  describe_remedy(scene, s, remedy);
  const char *one = scree_scene_shape_name(scene, s->shape), *other = other_name(scene, s);
  if (s->squeezed < SIZE_MAX)
    snprintf(both, sizeof both, "%.40s, pressed on %.40s by %.40s",
             scree_scene_shape_name(scene, s->squeezed), other, one);
  else
    snprintf(both, sizeof both, "%.40s on %.40s", one, other);
  return text + snprintf(text, (size_t)(end - text),
                         "\n  %-32s %9.3g %9.3g %10.3g %8.3g  %.120s, %.3g times the steps", both,
                         s->speed, s->energy, 1e3 * s->overlap, 1e3 * s->limit, remedy,
                         sqrt(s->stiffer));
}

bool scree_scene_describe_softness(const scree_scene *scene, char text[SCREE_REMARK]) {
  scree_scene_softness rows[2];
  const bool hits = scree_scene_soft(scene, &rows[0]),
             squeezes = scree_scene_squeezes(scene, &rows[1]);
  if (!hits && !squeezes) return false;
  const scree_scene_softness *worst =
      &rows[squeezes && !(hits && rows[0].stiffer > rows[1].stiffer)];
  const char *inlet = scree_scene_inlet_name(scene, worst->inlet), *end = text + SCREE_REMARK;
  char *at = text + snprintf(text, SCREE_REMARK,
                             "%s%.60s: too soft, if bodies fall and are hit as fast as they may: "
                             "beyond the limit contacts harden\n  %-32s %9s %9s %10s %8s  %s",
                             inlet ? "inlets." : "bodies", inlet ? inlet : "", "pair", "m/s",
                             "energy, J", "overlap mm", "limit mm", "soft with");
  if (hits) at = describe_row(scene, &rows[0], at, end);
  if (squeezes) describe_row(scene, &rows[1], at, end);
  return true;
}

scree_status scree_scene_check_softness(const scree_scene *scene, scree_error *error) {
  search s = {.scene = scene};
  look_at_inlets(&s, look_at_hits, 0);
  if (!(s.worst.overlap > passes * s.worst.size)) return SCREE_OK;
  char remedy[200];
  describe_remedy(scene, &s.worst, remedy);
  return scree_scene_fail(
      scene, &scene->inlets[s.worst.inlet].plan->place, error,
      "enters so fast that bodies would pass what they hit: '%.60s' against "
      "'%.60s' at %.3g m/s is pressed in by v sqrt(m/K) = %.3g m, more than its "
      "size; %.120s would keep it within %.3g m",
      scree_scene_shape_name(scene, s.worst.shape), other_name(scene, &s.worst), s.worst.speed,
      s.worst.overlap, remedy, s.worst.limit);
}

/* The geometry whose own books are off the most, where that is most of what is missed; else the
 * contact that is softest for what may hit it; their count: neither. */
static size_t blamed_part(const scree_scene *scene, double missing) {
  const size_t count = scene->plan.geometry.count;
  size_t worst = count;
  double largest = 0.5 * fabs(missing);
  for (size_t i = 0; i < count; i++) {
    double own = fabs(scree_scene_part_balance(scene, i));
    if (own >= largest) largest = own, worst = i;
  }
  return worst;
}

bool scree_scene_doubt_energy(const scree_scene *scene, char *text) {
  /* joints keep theirs to less than that, contacts of soft springs do not */
  const double told = scree_world_joint_count(scene->world) > 0 ? 1e-3 : 1e-2;
  scree_scene_book b;
  scree_scene_softness soft;
  scree_scene_get_book(scene, &b);
  if (!(fabs(b.ledger) > told)) return false;
  size_t part = blamed_part(scene, scree_scene_missing_energy(scene));
  char whose[200] = "; a shorter time step (contact.time_step) tells whether contacts have it";
  if (part < scene->plan.geometry.count)
    snprintf(whose, sizeof whose, "; the part '%.60s' has most of it",
             scree_scene_geometry_name(scene, part));
  else if (scree_scene_soft(scene, &soft))
    snprintf(whose, sizeof whose, "; '%.60s' on '%.60s' is the softest of its contacts",
             scree_scene_shape_name(scene, soft.shape),
             soft.is_wall ? scree_scene_geometry_name(scene, soft.other)
                          : scree_scene_shape_name(scene, soft.other));
  snprintf(text, SCREE_REMARK,
           "warning: the sums miss %.2g of the energy that changed its form, more than %g%s",
           b.ledger, told, whose);
  return true;
}
