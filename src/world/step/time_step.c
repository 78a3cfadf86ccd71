/* The time step.
 *
 * The time step is a fraction of the loading half of the shortest contact: dt = (pi/2) sqrt(m/K)/N
 * with the reduced mass m, over all pairs of kinds of body and of kind of body and wall. A hit on a
 * corner feels an effective mass up to seven times smaller than m, which N = 15 still resolves. A
 * hysteretic contact unloads in e times that time: below e = 0.3 the step follows it. A hit by
 * Hertz's law lasts longer the slower it is, as v^-1/5. */
#include "world/state/joints.h"
#include "world/state/materials.h"
#include "world/state/parameters.h"
#include "world/state/remote.h"
#include "world/step/stages.h"

static const double pi = 3.14159265358979323846;
/* Share of the loading's time that counts at the least: a hysteretic contact unloads in e times
 * that. */
static const double least_unloading = 0.3;

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
  const double
      e = world->materials.contacts[sides->material_a][sides->material_b].given.restitution,
      steeper = world->options.law == SCREE_LAW_HYSTERETIC ? scree_min(1, e / least_unloading) : 1,
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

/* Than at 1 m/s, for which K is. */
static double so_many_times_as_long(const scree_world *world) {
  const double v = world->options.law == SCREE_LAW_HERTZ ? world->hit_speed : 0;
  return v > 0 ? scree_exp(-0.2 * scree_log(v)) : 1;
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
  size_t held = 0;
  const double bond = scree_joints_time_step(world, &held), longer = so_many_times_as_long(world),
               touch = 0.5 * pi * sqrt(f.square) * longer / o->steps_per_contact,
               dt = o->time_step > 0 ? o->time_step : scree_min(bond, touch);
  if (reason && bond < touch) {
    snprintf(reason, 256,
             "%.4g s: %s, %.3g of a radian of the fastest joints, of body %zu; the fastest contact "
             "would bear %.3g times as much",
             dt, o->time_step > 0 ? "as given" : "automatic", 0.2 * dt / bond, held, touch / bond);
    return dt;
  }
  char at[40] = "";
  if (longer != 1) snprintf(at, sizeof at, " at 1 m/s, hit at %.3g", world->hit_speed);
  if (reason)
    snprintf(reason, 256,
             "%.4g s: %s, %.3g steps in a quarter period of the fastest contact, of body %zu with "
             "%s %zu (reduced mass %.3g kg, stiffness %.3g N/m%s)",
             dt, o->time_step > 0 ? "as given" : "automatic",
             0.5 * pi * sqrt(f.mass / f.stiffness) * longer / dt, f.first, f.wall ? "wall" : "body",
             f.second, f.mass, f.stiffness, at);
  return dt;
}

double scree_world_time_step(const scree_world *world, char reason[256]) {
  scree_world_bring(world, SCREE_PART_WALLS, NULL);
  return scree_world_choose_time_step(world, reason);
}
