/* Whether contacts are stiff enough for how fast bodies will hit: a linear spring is pressed by
 * v sqrt(m/K), and the law reads depths up to its limit only. The speed is that of the inlet and of
 * the fall from it to the lowest geometry, and beside that of the wall's motion; how much of it a
 * body has when it hits is not known, so what exceeds the limit is told. Where the inlet's velocity
 * alone presses a body in by half its size its middle passes the surface, and it would be pushed
 * out on the far side: that is refused. */
#include "scene/scene.h"

#include "world/materials.h"

static const double passes = 0.5; /* of the size */

/* ---- speeds ---- */

static double largest_of(const scree_table *table, bool slopes) {
  double largest = 0;
  for (size_t i = 0; i < table->count; i++) {
    const double *row = table->items[i];
    if (!slopes) largest = fmax(largest, fabs(row[1]));
    if (slopes && i && row[0] > table->items[i - 1][0])
      largest =
          fmax(largest, fabs(row[1] - table->items[i - 1][1]) / (row[0] - table->items[i - 1][0]));
  }
  return largest;
}

/* m: the farthest point of a geometry from an axis; 0 where it has no end. */
static double arm_of(const scree_scene *scene, size_t geometry, vec3 axis, vec3 through) {
  const scree_scene_geometry *g = &scene->geometry[geometry];
  double far = 0;
  for (size_t w = g->first_wall; w < g->first_wall + g->wall_count; w++) {
    const scree_world_wall *wall = scree_world_wall_at(scene->world, w);
    for (size_t v = 0; wall->surface && v < wall->surface->mesh.vertex_count; v++) {
      vec3 p = vec3_add(mat3_mul_vec(&wall->frame.rotation,
                                     vec3_load(wall->surface->mesh.positions + 3 * v)),
                        wall->frame.position),
           d = vec3_sub(p, through);
      far = fmax(far, vec3_norm(vec3_mad(d, axis, -vec3_dot(d, axis))));
    }
  }
  return far;
}

/* m/s of what stands out of a chain, as it goes round a wheel. */
static double speed_round(const scree_scene *scene, size_t geometry, double speed) {
  const scree_plan_round *c = scene->plan.geometry.items[geometry].copies;
  const vec3 axis = vec3_unit(vec3_load(c->axis)), first = vec3_load(c->through);
  const double far = fmin(arm_of(scene, geometry, axis, first),
                          arm_of(scene, geometry, axis, vec3_add(first, vec3_load(c->span))));
  return fabs(speed) * fmax(1, (far - vec3_norm(vec3_load(c->span))) / c->radius);
}

static double speed_on_path(const scree_scene *scene, size_t geometry,
                            const scree_plan_path *path) {
  double speed = 0;
  for (int k = 0; k < SCREE_PATH_COLUMNS; k++) {
    const vec3 axis = {k % 3 == 0, k % 3 == 1, k % 3 == 2};
    const double arm = k < 3 ? 1 : arm_of(scene, geometry, axis, vec3_load(path->through));
    speed += arm * largest_of(&path->tables[k], true);
  }
  return speed;
}

static const double two_pi = 6.283185307179586;

/* m/s of its fastest point; motions act together. */
static double speed_of_geometry(const scree_scene *scene, size_t index) {
  const scree_plan_geometry *g = &scene->plan.geometry.items[index];
  double speed = 0;
  for (size_t i = 0; i < g->motion.count; i++) {
    const scree_plan_motion *m = &g->motion.items[i];
    const scree_plan_translate *t = m->translate;
    const scree_plan_rotate *r = m->rotate;
    const scree_plan_vibrate *v = m->vibrate;
    if (t && !isnan(t->velocity[0])) speed += vec3_norm(vec3_load(t->velocity));
    if (t) speed += largest_of(&t->table, false) + largest_of(&t->positions, true);
    if (r) {
      double most = isnan(r->speed) ? 0 : fabs(r->speed);
      if (!isnan(r->amplitude)) most = two_pi * r->frequency * r->amplitude;
      most += largest_of(&r->table, false) + largest_of(&r->positions, true);
      speed += arm_of(scene, index, vec3_unit(vec3_load(r->axis)), vec3_load(r->through)) * most;
    }
    if (v) speed += two_pi * v->frequency * fabs(v->amplitude);
    if (m->crank)
      speed += m->crank->speed * m->crank->radius * (1 + m->crank->radius / m->crank->rod);
    if (m->round) speed += speed_round(scene, index, m->round->speed);
    if (m->path) speed += speed_on_path(scene, index, m->path);
  }
  return speed;
}

/* m: along gravity, from the highest corner of an inlet to the lowest of the geometry; 0 where the
 * geometry has no lowest. */
static double fall_from(const scree_scene *scene, const scree_scene_inlet *inlet) {
  vec3 down = vec3_load(scene->plan.gravity);
  if (!(vec3_norm(down) > 0)) return 0;
  down = vec3_unit(down);
  scree_scene_reach all = scree_scene_reach_of(scene), region;
  if (inlet->plan->layers && inlet->plan->layers->in) {
    vec3_store(region.low, inlet->layers.middle);
    vec3_store(region.high, inlet->layers.middle);
  } else {
    scree_scene_region_of(inlet->plan, region.low, region.high);
  }
  const double n[3] = {down.x, down.y, down.z};
  double from = 0, to = 0;
  for (int k = 0; k < 3; k++) {
    if (n[k] == 0) continue;
    from += n[k] * (n[k] > 0 ? region.low[k] : region.high[k]);
    to += n[k] * (n[k] > 0 ? all.high[k] : all.low[k]);
  }
  return isfinite(to - from) ? fmax(0, to - from) : 0;
}

/* ---- contacts ---- */

typedef struct touching {
  size_t shape, other; /* other: a shape, or a wall's geometry */
  bool is_wall;
} touching;

/* What is pressed by a speed of 1 m/s, m; its limit, and the size, m. */
static double give_of(const scree_scene *scene, const touching *t, double *size) {
  const scree_scene_shape *a = &scene->shapes[t->shape], *b = &scene->shapes[t->other];
  double mass = a->mass;
  size_t material = 0;
  *size = a->particle->measures.size;
  if (t->is_wall) {
    const scree_world_wall *w =
        scree_world_wall_at(scene->world, scene->geometry[t->other].first_wall);
    material = w->given.material;
  } else {
    material = b->material;
    mass = a->mass * b->mass / (a->mass + b->mass);
    *size = fmin(*size, b->particle->measures.size);
  }
  const scree_contact_sides sides = {
      a->particle, t->is_wall ? NULL : b->particle, a->material, material, *size, mass};
  scree_pair_law
      law; /* of Hertz's a linear one that lasts as long, which gives 6 % less at 1 m/s */
  scree_set_stiffness(scene->world, &sides, &law);
  return sqrt(mass / law.stiffness);
}

typedef struct search {
  const scree_scene *scene;
  scree_scene_softness worst;
  double worst_share; /* of the limit */
  double least;       /* of the size: what the stiffest gives way; infinity: there is none */
} search;

static void look(search *s, size_t inlet, const touching *t, double speed) {
  double size, give = give_of(s->scene, t, &size), share,
               limit = s->scene->world->options.overlap_limit * size;
  share = give * speed / limit;
  s->least = fmin(s->least, give * speed / size);
  if (!(share > s->worst_share)) return;
  s->worst_share = share;
  s->worst = (scree_scene_softness){.inlet = inlet,
                                    .shape = t->shape,
                                    .other = t->other,
                                    .is_wall = t->is_wall,
                                    .speed = speed,
                                    .overlap = give * speed,
                                    .limit = limit,
                                    .size = size,
                                    .stiffer = share * share};
}

static double fastest_wall(const scree_scene *scene) {
  double fastest = 0;
  for (size_t g = 0; g < scene->plan.geometry.count; g++)
    fastest = fmax(fastest, speed_of_geometry(scene, g));
  return fastest;
}

/* All that the bodies of an inlet may hit, at `speed` and beside that at the walls' own. */
static void look_at_inlet(search *s, size_t index, double speed, bool moving) {
  const scree_scene *scene = s->scene;
  const scree_scene_inlet *inlet = &scene->inlets[index];
  double of_walls = moving ? fastest_wall(scene) : 0;
  for (size_t k = 0; k < inlet->plan->shapes.count; k++) {
    touching t = {.shape = inlet->shapes[k], .is_wall = true};
    for (size_t g = 0; g < scene->plan.geometry.count; g++) {
      t.other = g;
      look(s, index, &t, speed + (moving ? speed_of_geometry(scene, g) : 0));
    }
    t.is_wall = false;
    for (size_t b = 0; b < SCREE_SCENE_SHAPES(scene); b++) {
      t.other = b;
      look(s, index, &t, fmax(speed, of_walls));
    }
  }
}

static double speed_of_inlet(const scree_scene_inlet *inlet) {
  return fmax(vec3_norm(vec3_load(inlet->plan->velocity)), inlet->layers.speed);
}

bool scree_scene_soft(const scree_scene *scene, scree_scene_softness *softness) {
  search s = {.scene = scene, .least = INFINITY};
  double g = vec3_norm(vec3_load(scene->plan.gravity));
  for (size_t i = 0; i < scene->plan.inlets.count; i++) {
    double speed = speed_of_inlet(&scene->inlets[i]);
    look_at_inlet(&s, i, sqrt(speed * speed + 2 * g * fall_from(scene, &scene->inlets[i])), true);
  }
  *softness = s.worst;
  softness->least = s.least;
  return s.worst_share > 1;
}

static const char *other_name(const scree_scene *scene, const scree_scene_softness *s) {
  return s->is_wall ? scree_scene_geometry_name(scene, s->other)
                    : scree_scene_shape_name(scene, s->other);
}

/* Pa: of the shape's material, that would hold; infinity where the other is too soft for any. Both
 * are in series, K = L / (1/Ea + 1/Eb). */
static double young_that_holds(const scree_scene *scene, const scree_scene_softness *s) {
  const scree_world *world = scene->world;
  size_t material = scene->shapes[s->shape].material, other;
  if (s->is_wall)
    other = scree_world_wall_at(world, scene->geometry[s->other].first_wall)->given.material;
  else
    other = scene->shapes[s->other].material;
  double a = world->materials[material].young, b = world->materials[other].young;
  if (material == other) return a * s->stiffer;
  double least = s->stiffer * a * b / (a + b);
  return least < b ? least * b / (b - least) : (double)INFINITY;
}

static void describe(const scree_scene *scene, const scree_scene_softness *s, char *text,
                     size_t size) {
  char remedy[200];
  double young = young_that_holds(scene, s), round = pow(10, floor(log10(young)) - 1);
  size_t material = scene->shapes[s->shape].material;
  if (isfinite(young) && scene->plan.materials.count)
    snprintf(remedy, sizeof remedy, "materials.%.60s.young %.3g Pa or more",
             scene->plan.materials.items[material].place.name, ceil(young / round) * round);
  else
    snprintf(remedy, sizeof remedy, "contact.stiffness_factor %.3g or more",
             ceil(10 * s->stiffer * scene->plan.contact->stiffness_factor) / 10);
  snprintf(text, size,
           "'%.60s' against '%.60s' at %.3g m/s is pressed in by v sqrt(m/K) = %.3g m, and the "
           "limit is %.3g m: %s would hold it, in %.3g times as many steps",
           scree_scene_shape_name(scene, s->shape), other_name(scene, s), s->speed, s->overlap,
           s->limit, remedy, sqrt(s->stiffer));
}

void scree_scene_describe_softness(const scree_scene *scene, const scree_scene_softness *softness,
                                   char *text, size_t size) {
  char middle[500];
  describe(scene, softness, middle, sizeof middle);
  snprintf(text, size, "inlets.%s: too soft, if bodies fall and are hit as fast as they may: %s",
           scree_scene_inlet_name(scene, softness->inlet), middle);
}

scree_status scree_scene_check_softness(const scree_scene *scene, scree_error *error) {
  search s = {.scene = scene};
  for (size_t i = 0; i < scene->plan.inlets.count; i++)
    look_at_inlet(&s, i, speed_of_inlet(&scene->inlets[i]), false);
  if (!(s.worst.overlap > passes * s.worst.size)) return SCREE_OK;
  char text[500];
  describe(scene, &s.worst, text, sizeof text);
  return scree_scene_fail(scene, &scene->inlets[s.worst.inlet].plan->place, error,
                          "enters so fast that bodies would pass what they hit: %s", text);
}
