#include "support/hits.h"

#include "base/rng.h"
#include "particle/closest.h"
#include "support/law.h"

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

static size_t corners_inside(scree_world *world, size_t of, size_t in) {
  scree_body a, b;
  scree_world_get_body(world, of, &a);
  scree_world_get_body(world, in, &b);
  const scree_particle *pa = scree_world_body_particle(world, of),
                       *pb = scree_world_body_particle(world, in);
  mat3 ra = quat_to_mat3(
           (quat){a.orientation[0], a.orientation[1], a.orientation[2], a.orientation[3]}),
       rb = quat_to_mat3(
           (quat){b.orientation[0], b.orientation[1], b.orientation[2], b.orientation[3]});
  size_t inside = 0;
  for (size_t i = 0; i < pa->point_count; i++) {
    vec3 x = vec3_add(mat3_mul_vec(&ra, pa->points[i]), vec3_load(a.position));
    inside += scree_is_inside(pb, mat3_tmul_vec(&rb, vec3_sub(x, vec3_load(b.position))));
  }
  return inside;
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
    stopped = scree_world_step(world, 20, &error) != SCREE_OK;
    scree_world_observe(world, &o);
    if (o.pair_count) touched = true, free_since = scree_world_time(world);
    if (touched && scree_world_time(world) > free_since + 0.003) break;
  }
  out->stopped += stopped;
  if (stopped) print_message("try %zu: %s\n", (size_t)number, error.message);
  if (stopped) { /* in the middle of a hit: nothing is told about its end */
    scree_world_free(world);
    return;
  }
  /* bodies that slide along each other touch by less than a micrometre: they are not stuck */
  out->stuck += touched && o.pair_count > 0 && o.largest_overlap > 1e-5;
  out->through += corners_inside(world, a, b) + corners_inside(world, b, a) > 0;
  scree_world_get_body(world, a, &up);
  scree_world_get_body(world, b, &down);
  if (m->offset == 0 && m->shift < 0.2 * mu.size) out->through += up.position[2] < down.position[2];
  scree_world_free(world);
}
