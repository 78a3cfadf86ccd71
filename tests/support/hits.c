#include "support/hits.h"

#include "base/rng.h"
#include "particle/closest.h"
#include "support/law.h"

enum { EDGE_SAMPLES = 40 };
/* m: so deep edges may lie unfelt, half the roundings of bodies of 50 mm; corners must not */
static const double edges_may = 1e-4;

double law_random_hit(scree_particle *particle, double steps, uint64_t number, bool damped) {
  law_setup setup = law_default();
  setup.restitution = damped ? 0.3 : 1;
  setup.friction = damped ? 0.5 : 0;
  setup.steps_per_contact = steps;
  scree_world *world = law_world(&setup);
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  scree_rng rng = {.seed = 5, .stream = number};
  double gap = 2 * m.bounding_radius;
  for (int side = 0; side < 2; side++) {
    scree_body body = scree_default_body();
    quat q = scree_rng_rotation(&rng);
    body.orientation[0] = q.w, body.orientation[1] = q.x;
    body.orientation[2] = q.y, body.orientation[3] = q.z;
    body.position[2] = (side ? -0.5 : 0.5) * gap;
    body.position[0] = side ? 0 : 0.3 * m.size * (2 * scree_rng_uniform(&rng) - 1);
    body.position[1] = side ? 0 : 0.3 * m.size * (2 * scree_rng_uniform(&rng) - 1);
    body.velocity[2] = side ? 1 : -1;
    vec3 spin = scree_rng_direction(&rng);
    vec3_store(body.angular_velocity, vec3_scale(spin, 5));
    law_body(world, particle, body);
  }
  scree_observation o;
  law_step(world, 1);
  double before = law_ledger(world, &o), highest = 0, after = before;
  int apart = 0;
  bool touched = false;
  for (int i = 0; i < 20000 && apart < 400; i++) {
    law_step(world, 5);
    law_ledger(world, &o);
    after = o.kinetic + o.rotational + o.elastic;
    highest = fmax(highest, after);
    touched |= o.pair_count > 0;
    apart = o.pair_count ? 0 : apart + (touched ? 1 : scree_world_time(world) > 0.1);
  }
  scree_world_free(world);
  return damped ? highest / before : after / before;
}

/* The orientation for which the mesh stands as it was drawn, then turned by q. */
static void stand(scree_particle *particle, quat q, scree_body *body) {
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  const double *o = m.orientation;
  quat drawn = quat_mul(q, (quat){o[0], o[1], o[2], o[3]});
  const double orientation[4] = {drawn.w, drawn.x, drawn.y, drawn.z};
  memcpy(body->orientation, orientation, sizeof orientation);
}

typedef struct placed {
  mat3 rotation;
  vec3 position;
  const scree_particle *particle;
} placed;

static placed place_of(const scree_world *world, size_t body) {
  scree_body b;
  scree_world_get_body(world, body, &b);
  const double *o = b.orientation;
  return (placed){quat_to_mat3((quat){o[0], o[1], o[2], o[3]}), vec3_load(b.position),
                  scree_world_body_particle(world, body)};
}

static vec3 point_of(const placed *p, vec3 x) {
  return vec3_add(mat3_mul_vec(&p->rotation, x), p->position);
}

static double depth_in(const placed *p, vec3 at) {
  vec3 x = mat3_tmul_vec(&p->rotation, vec3_sub(at, p->position));
  const uint32_t root = 0;
  uint32_t face;
  scree_box here = {x, x};
  if (!scree_box_meets(&here, &p->particle->box) || !scree_is_inside(p->particle, x)) return 0;
  return scree_nearest_face(p->particle, &root, 1, x, INFINITY, &face);
}

double law_depth_in(const scree_world *world, size_t body, vec3 at) {
  placed p = place_of(world, body);
  return depth_in(&p, at);
}

/* The deepest of the corners, and of points along the edges, of one body in the other, m. */
static double deepest_in(const scree_world *world, size_t of, size_t in, bool edges) {
  placed a = place_of(world, of), b = place_of(world, in);
  double deepest = 0;
  for (size_t i = 0; i < a.particle->point_count; i++)
    deepest = fmax(deepest, depth_in(&b, point_of(&a, a.particle->points[i])));
  for (size_t i = 0; edges && i < a.particle->edge_count; i++) {
    const scree_edge *e = &a.particle->edges[i];
    for (int k = 1; k < EDGE_SAMPLES; k++) {
      vec3 x = vec3_mad(e->start, e->along, e->length * k / EDGE_SAMPLES);
      deepest = fmax(deepest, depth_in(&b, point_of(&a, x)));
    }
  }
  return deepest;
}

static double depth_of_either(const scree_world *world, bool edges) {
  return fmax(deepest_in(world, 0, 1, edges), deepest_in(world, 1, 0, edges));
}

/* The observation is that of the step after the one that led to this depth: it saw it. */
static bool note_unfelt(const scree_observation *o, double depth, law_outcome *out) {
  double most = out->follow ? edges_may : 0;
  if (!(depth > most) || o->largest_overlap >= 0.5 * depth) return false;
  out->unfelt = fmax(out->unfelt, depth);
  return true;
}

void law_meet(const law_meeting *m, double speed, uint64_t number, law_outcome *out) {
  scree_error error;
  scree_world_options options = scree_default_world_options();
  options.gravity[2] = 0;
  options.overlap_limit = 0.12; /* the bars are 12 mm thick: 3.6 mm */
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&options, &world, &error), error);
  scree_material material = scree_default_material();
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  scree_rng rng = {.seed = 8, .stream = number};
  scree_particle_measures mu, ml;
  scree_particle_measure(m->upper, &mu);
  scree_particle_measure(m->lower, &ml);
  scree_body up = scree_default_body(), down = up;
  vec3 tilt = vec3_scale(scree_rng_direction(&rng), m->tilt * scree_rng_uniform(&rng));
  stand(m->upper, quat_mul(quat_from_rotation_vector(tilt), m->upper_turn), &up);
  stand(m->lower, m->lower_turn, &down);
  double apart = mu.bounding_radius + ml.bounding_radius;
  up.position[0] = m->offset + m->shift * (2 * scree_rng_uniform(&rng) - 1);
  up.position[1] = m->shift * (2 * scree_rng_uniform(&rng) - 1);
  up.position[2] = 0.5 * apart;
  down.position[2] = -0.5 * apart;
  up.velocity[2] = -0.5 * speed;
  down.velocity[2] = 0.5 * speed;
  size_t a = law_body(world, m->upper, up), b = law_body(world, m->lower, down);
  scree_observation o;
  double last = apart / speed + 0.05;
  bool touched = false, stopped = false;
  double free_since = 0;
  while (scree_world_time(world) < last && !stopped) {
    stopped = scree_world_step(world, 19, &error) != SCREE_OK;
    double depth = out->follow && touched ? depth_of_either(world, true) : 0;
    stopped = stopped || scree_world_step(world, 1, &error) != SCREE_OK;
    scree_world_observe(world, &o);
    note_unfelt(&o, depth, out);
    if (o.pair_count) touched = true, free_since = scree_world_time(world);
    if (touched && scree_world_time(world) > free_since + 0.003) break;
  }
  out->stopped += stopped;
  if (stopped) print_message("try %zu: %s\n", (size_t)number, error.message);
  if (stopped) { /* in the middle of a hit: nothing is told about its end */
    scree_world_free(world);
    return;
  }
  /* what begins to touch in the last step is felt in the next */
  double depth = depth_of_either(world, out->follow);
  scree_observation next;
  law_step(world, 1);
  scree_world_observe(world, &next);
  /* bodies that slide along each other touch by less than a micrometre: they are not stuck */
  out->stuck += touched && o.pair_count > 0 && o.largest_overlap > 1e-5;
  out->through += note_unfelt(&next, depth, out);
  scree_world_get_body(world, a, &up);
  scree_world_get_body(world, b, &down);
  if (m->offset == 0 && m->shift < 0.2 * mu.size) out->through += up.position[2] < down.position[2];
  scree_world_free(world);
}
