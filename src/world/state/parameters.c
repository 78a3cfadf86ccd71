/* What a contact's law follows from: sizes, masses and materials.
 *
 * Rocky's rule: K = E L of each side, in series (physics of the paper's engine).
 * Hertz: 1/E* = sum (1 - nu^2)/E, 1/G* = sum 2 (2 - nu) (1 + nu)/E, 1/R* = sum 1/R, where R of a
 * clump is half its size and a mesh or wall has none. A contact that begins at v lasts 2.943
 * (m/h)^2/5 (4/5)^-2/5 v^-1/5 (Johnson 1985, Contact Mechanics, eq. 11.24); K is that of a linear
 * one which lasts as long for v = 1 m/s. */
#include "world/state/parameters.h"
#include "world/state/constants.h"
#include "world/state/joints.h"
#include "world/state/materials.h"

static const double pi = 3.14159265358979323846;

static bool is_round(const scree_particle *particle) {
  return particle && particle->measures.kind != SCREE_PARTICLE_MESH;
}

static double hertz_curvature_of(const scree_particle *particle) {
  if (!particle || !is_round(particle)) return 0;
  bool sphere = particle->measures.kind == SCREE_PARTICLE_SPHERE;
  return 1 / (sphere ? particle->point_radii[0] : 0.5 * particle->measures.size);
}

/* Stiffness of a linear contact that lasts as long as Hertz's, N/m: the turning point at x = (5/4 m
 * v^2/h)^2/5 after 1.4716 x/v. */
static double stiffness_of_hertz(double hertz, double mass) {
  const double two_fifths = 0.4, rise = 1.25 * mass / hertz; /* v = 1 m/s */
  double deepest = scree_exp(two_fifths * scree_log(rise)), time = 2 * 1.4716 * deepest;
  return mass * pi * pi / (time * time);
}

void scree_set_stiffness(const scree_world *world, const scree_contact_sides *sides,
                         scree_pair_law *law) {
  const scree_material *a = &world->materials.items[sides->material_a],
                       *b = &world->materials.items[sides->material_b];
  double ka = a->young * sides->size, kb = b->young * sides->size,
         factor = world->options.stiffness_factor;
  law->stiffness = factor * ka * kb / (ka + kb);
  law->hertz = law->mindlin = 0;
  if (world->options.law != SCREE_LAW_HERTZ || !(is_round(sides->a) || is_round(sides->b))) return;
  double ease = (1 - a->poisson * a->poisson) / a->young + (1 - b->poisson * b->poisson) / b->young,
         shear_ease = 2 * (2 - a->poisson) * (1 + a->poisson) / a->young +
                      2 * (2 - b->poisson) * (1 + b->poisson) / b->young,
         root = sqrt(1 / (hertz_curvature_of(sides->a) + hertz_curvature_of(sides->b)));
  law->hertz = 4.0 / 3 * factor * root / ease;
  law->mindlin = 8 * factor * root / shear_ease;
  law->stiffness = stiffness_of_hertz(law->hertz, sides->mass);
}

bool scree_are_spheres(const scree_world *world, const scree_neighbours *n) {
  const scree_particle *const *particles = (const scree_particle *const *)world->bodies.particle;
  if (particles[n->a]->measures.kind != SCREE_PARTICLE_SPHERE) return false;
  return n->wall ? scree_wall_is_analytic(&world->walls.items[n->b])
                 : particles[n->b]->measures.kind == SCREE_PARTICLE_SPHERE &&
                       !scree_joints_held(world, n->a, n->b); /* these ease, as meshes do */
}

double scree_thin_overlap(const scree_particle *particle) {
  /* rays grazing a notch find walls thinner than they are: never below four contact radii */
  const scree_particle_measures *m = &particle->measures;
  return scree_max(0.5 * m->thickness, 4 * particle->radius);
}

/* 1/r of a sphere; of any other body, 2/L. */
static double curvature_of(const scree_world *world, const scree_particle *particle) {
  bool sphere = particle->measures.kind == SCREE_PARTICLE_SPHERE;
  return sphere ? 1 / particle->point_radii[0] : 2 / scree_size_in(world, particle);
}

/* 1/(I + m r^2) of a sphere that rolls, about where it touches. */
static double ease_of_rolling(const scree_world *world, size_t body) {
  const scree_bodies *b = &world->bodies;
  double r = b->particle[body]->point_radii[0];
  return 1 / (b->inertia[body].x + b->mass[body] * r * r);
}

/* Rolling resistance of type C: the spring is 9/4 K (mu_r R)^2 (law.h). R of spheres is known. */
static void set_up_rolling(const scree_world *world, double rolling_friction, scree_neighbours *n) {
  n->law.rolling = rolling_friction;
  n->law.rolling_damping = 0;
  if (!n->spheres || !(rolling_friction > 0)) return;
  const scree_particle *sides[2] = {world->bodies.particle[n->a],
                                    n->wall ? NULL : world->bodies.particle[n->b]};
  const size_t bodies[2] = {n->a, n->b};
  double curvature = 0, ease = 0;
  for (int i = 0; i < 2; i++) {
    if (!sides[i]) continue;
    curvature += curvature_of(world, sides[i]);
    ease += ease_of_rolling(world, bodies[i]);
  }
  n->law.rolling = rolling_friction / curvature;
  double stiffness = 2.25 * n->law.stiffness * n->law.rolling * n->law.rolling;
  n->law.rolling_damping = 2 * rolling_damping_ratio * sqrt(stiffness / ease);
}

static double pull_of(const scree_world *world, const scree_material_contact *contact,
                      const scree_neighbours *n) {
  double curvature = curvature_of(world, world->bodies.particle[n->a]);
  if (!n->wall) curvature += curvature_of(world, world->bodies.particle[n->b]);
  return contact->pull_off + 1.5 * pi * contact->surface_energy / curvature;
}

static void set_up(const scree_world *world, scree_neighbours *n) {
  const scree_bodies *bodies = &world->bodies;
  const scree_particle *a = bodies->particle[n->a], *b = scree_shape_of(world, n->b, n->wall);
  double size = scree_size_in(world, a), mass = bodies->mass[n->a], thin = scree_thin_overlap(a);
  size_t material_a = bodies->material[n->a], material_b;
  if (n->wall) {
    material_b = world->walls.items[n->b].given.material;
  } else {
    material_b = bodies->material[n->b];
    size = scree_min(size, scree_size_in(world, b));
    mass = mass * bodies->mass[n->b] / (mass + bodies->mass[n->b]);
    thin = scree_min(thin, scree_thin_overlap(b));
  }
  const scree_material_pair *contact = &world->materials.contacts[material_a][material_b];
  const scree_contact_sides sides = {a, n->wall ? NULL : b, material_a, material_b, size, mass};
  scree_set_stiffness(world, &sides, &n->law);
  if (n->law.hertz > 0)
    n->law.damping = contact->hertz_damping * sqrt(mass * n->law.hertz);
  else if (world->options.law == SCREE_LAW_HYSTERETIC)
    n->law.damping = 0;
  else
    n->law.damping = 2 * contact->damping_ratio * sqrt(mass * n->law.stiffness);
  n->law.contact_time = pi * sqrt(mass / n->law.stiffness);
  n->law.friction = contact->given.friction;
  n->law.restitution = contact->given.restitution;
  n->law.pull = pull_of(world, &contact->given, n);
  set_up_rolling(world, contact->given.rolling_friction, n);
  n->law.smoothing = world->options.smoothing * size;
  n->law.limit = world->options.overlap_limit * size;
  n->law.thin = scree_min(n->law.limit, thin);
  n->law.reach = 0;
  if (a->face_count) n->law.reach += n->wall ? a->radius : scree_contact_radius(a, b);
  if (b && b->face_count) n->law.reach += n->wall ? b->radius : scree_contact_radius(b, a);
}

scree_neighbours scree_neighbours_new(const scree_world *world, uint32_t a, uint32_t b, bool wall) {
  scree_neighbours n = {.a = a, .b = b, .wall = wall};
  n.spheres = scree_are_spheres(world, &n);
  n.list.next_feature = n.list.end = -INFINITY;
  n.list.eased = !wall && scree_joints_held(world, a, b) ? INFINITY : 0;
  set_up(world, &n);
  return n;
}

/* Each when the first pair asks for it. */
void scree_spheres_set_up_laws(scree_world *world) {
  scree_spheres *s = &world->spheres;
  for (size_t i = 0; i < s->laws.count; i++) s->laws.items[i].stiffness = 0;
  for (size_t k = 0; k < s->list.pairs.count; k++) {
    const scree_sphere_pair *two = &s->list.pairs.items[k];
    scree_pair_law *law = &s->laws.items[two->law];
    if (law->stiffness > 0) continue;
    *law = scree_neighbours_new(world, s->list.body[two->a], s->list.body[two->b], false).law;
  }
}

void scree_neighbours_set_up(scree_world *world) {
  scree_spheres_set_up_laws(world);
  for (size_t k = 0; k < world->list.neighbours.count; k++) {
    scree_neighbours *n = &world->list.neighbours.items[k];
    scree_pair *pair = scree_pair_of(world, k);
    set_up(world, n);
    if (pair) pair->law = n->law;
  }
}
