/* Stiffness and time step.
 *
 * Rocky's rule: K = E L of each side, in series (physics of the paper's engine). The time step is a
 * fraction of the loading half of the shortest contact: dt = (pi/2) sqrt(m/K)/N with the reduced
 * mass m, over all pairs of
 * kinds of body and of kind of body and wall. A hit on a corner feels an effective mass up to seven
 * times smaller than m, which N = 15 still resolves. A hysteretic contact unloads in e times that
 * time: below e = 0.3 the step follows it.
 *
 * Hertz: 1/E* = sum (1 - nu^2)/E, 1/G* = sum 2 (2 - nu) (1 + nu)/E, 1/R* = sum 1/R, where R of a
 * clump is half its size and a mesh or wall has none. A contact that begins at v lasts 2.943
 * (m/h)^2/5 (4/5)^-2/5 v^-1/5 (Johnson 1985, Contact Mechanics, eq. 11.24); K is that of a linear
 * one which lasts as long for v = 1 m/s. */
#include "world/materials.h"

static const double pi = 3.14159265358979323846;
/* Of the loading, which the unloading of a hysteretic contact takes e times as long as. */
static const double least_unloading = 0.3;

static bool is_round(const scree_particle *particle) {
  return particle && particle->measures.kind != SCREE_PARTICLE_MESH;
}

static double curvature_of(const scree_particle *particle) {
  if (!particle || !is_round(particle)) return 0;
  bool sphere = particle->measures.kind == SCREE_PARTICLE_SPHERE;
  return 1 / (sphere ? particle->point_radii[0] : 0.5 * particle->measures.size);
}

/* Of a linear contact as long as Hertz's: the turning point at x = (5/4 m v^2/h)^2/5 after
 * 1.4716 x/v. */
static double stiffness_of_hertz(double hertz, double mass) {
  const double two_fifths = 0.4, rise = 1.25 * mass / hertz; /* v = 1 m/s */
  double deepest = scree_exp(two_fifths * scree_log(rise)), time = 2 * 1.4716 * deepest;
  return mass * pi * pi / (time * time);
}

void scree_set_stiffness(const scree_world *world, const scree_contact_sides *sides,
                         scree_pair_law *law) {
  const scree_material *a = &world->materials[sides->material_a],
                       *b = &world->materials[sides->material_b];
  double ka = a->young * sides->size, kb = b->young * sides->size,
         factor = world->options.stiffness_factor;
  law->stiffness = factor * ka * kb / (ka + kb);
  law->hertz = law->mindlin = 0;
  if (world->options.law != SCREE_LAW_HERTZ || !(is_round(sides->a) || is_round(sides->b))) return;
  double ease = (1 - a->poisson * a->poisson) / a->young + (1 - b->poisson * b->poisson) / b->young,
         shear_ease = 2 * (2 - a->poisson) * (1 + a->poisson) / a->young +
                      2 * (2 - b->poisson) * (1 + b->poisson) / b->young,
         root = sqrt(1 / (curvature_of(sides->a) + curvature_of(sides->b)));
  law->hertz = 4.0 / 3 * factor * root / ease;
  law->mindlin = 8 * factor * root / shear_ease;
  law->stiffness = stiffness_of_hertz(law->hertz, sides->mass);
}

/* Bodies of one particle and material are one kind. */
typedef struct body_kind {
  const scree_particle *particle;
  size_t material, body;
} body_kind;

enum { MOST_KINDS = 256 };

static double size_of(const scree_world *world, size_t body) {
  return scree_size_in(world, world->bodies.particle[body]);
}

static size_t list_kinds(const scree_world *world, body_kind *kinds) {
  size_t count = 0;
  const scree_bodies *bodies = &world->bodies;
  for (size_t i = 0; i < bodies->count; i++) {
    if (bodies->removed[i]) continue;
    size_t k = 0;
    while (k < count &&
           (kinds[k].particle != bodies->particle[i] || kinds[k].material != bodies->material[i]))
      k++;
    if (k < count) continue;
    if (count < MOST_KINDS) {
      kinds[count++] = (body_kind){bodies->particle[i], bodies->material[i], i};
      continue;
    }
    /* too many kinds to pair: keep the lightest per stiffness in the last place */
    const body_kind *last = &kinds[MOST_KINDS - 1];
    double ratio = bodies->mass[i] / size_of(world, i),
           kept = bodies->mass[last->body] / size_of(world, last->body);
    if (ratio < kept)
      kinds[MOST_KINDS - 1] = (body_kind){bodies->particle[i], bodies->material[i], i};
  }
  return count;
}

/* The contact that asks for the shortest step. */
typedef struct fastest_contact {
  double square; /* s^2, m/K, by what its unloading asks for */
  double mass, stiffness;
  size_t first, second;
  bool wall;
} fastest_contact;

static void consider(const scree_world *world, const scree_contact_sides *sides,
                     const fastest_contact *between, fastest_contact *fastest) {
  scree_pair_law law;
  scree_set_stiffness(world, sides, &law);
  const double e = world->contacts[sides->material_a][sides->material_b].given.restitution,
               steeper = world->options.law == SCREE_LAW_HYSTERETIC
                             ? scree_min(1, e / least_unloading)
                             : 1,
               square = sides->mass / law.stiffness * steeper * steeper;
  if (!(square < fastest->square)) return;
  *fastest = *between;
  fastest->square = square;
  fastest->mass = sides->mass;
  fastest->stiffness = law.stiffness;
}

static fastest_contact find_fastest(const scree_world *world, const body_kind *kinds,
                                    size_t count) {
  const scree_bodies *bodies = &world->bodies;
  fastest_contact fastest = {.square = INFINITY};
  for (size_t i = 0; i < count; i++) {
    const body_kind *a = &kinds[i];
    double mi = bodies->mass[a->body], li = size_of(world, a->body);
    for (size_t j = i; j < count; j++) {
      const body_kind *b = &kinds[j];
      double mj = bodies->mass[b->body];
      const scree_contact_sides sides = {a->particle,
                                         b->particle,
                                         a->material,
                                         b->material,
                                         scree_min(li, size_of(world, b->body)),
                                         mi * mj / (mi + mj)};
      consider(world, &sides, &(fastest_contact){.first = a->body, .second = b->body}, &fastest);
    }
    for (size_t w = 0; w < world->walls.count; w++) {
      const scree_contact_sides sides = {
          a->particle, NULL, a->material, world->walls.items[w].given.material, li, mi};
      consider(world, &sides, &(fastest_contact){.first = a->body, .second = w, .wall = true},
               &fastest);
    }
  }
  return fastest;
}

double scree_world_choose_time_step(const scree_world *world, char reason[256]) {
  body_kind kinds[MOST_KINDS];
  size_t count = list_kinds(world, kinds);
  const scree_world_options *o = &world->options;
  if (count == 0) {
    double dt = o->time_step > 0 ? o->time_step : 1e-5;
    if (reason) snprintf(reason, 256, "%.4g s: there are no bodies yet", dt);
    return dt;
  }
  const fastest_contact f = find_fastest(world, kinds, count);
  double dt = o->time_step > 0 ? o->time_step : 0.5 * pi * sqrt(f.square) / o->steps_per_contact;
  if (reason)
    snprintf(reason, 256,
             "%.4g s: %s, %.3g steps in a quarter period of the fastest contact, of body %zu with "
             "%s %zu (reduced mass %.3g kg, stiffness %.3g N/m)",
             dt, o->time_step > 0 ? "as given" : "automatic",
             0.5 * pi * sqrt(f.mass / f.stiffness) / dt, f.first, f.wall ? "wall" : "body",
             f.second, f.mass, f.stiffness);
  return dt;
}
