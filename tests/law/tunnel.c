/* L8: what hits fast must neither pass through nor stick. Two bodies meet head-on at 7.7 and 15.4
 * m/s, with random shifts and turns about the meeting that is named. Afterwards they must have come
 * apart, with no corner of one inside the other. */
#include "support/law.h"

#include "base/rng.h"
#include "particle/closest.h"
#include "support/shapes.h"
#include "support/solids.h"

enum { TRIES = 60 };

static const double degree = 3.14159265358979323846 / 180;

static scree_particle *particle_of(scree_mesh mesh) {
  scree_error error;
  scree_particle *particle = NULL;
  CHECK_OK(scree_particle_from_mesh(&mesh, NULL, &particle, &error), error);
  scree_mesh_free(&mesh);
  return particle;
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

typedef struct meeting {
  const char *name;
  scree_particle *upper, *lower;
  quat upper_turn, lower_turn;
  double shift, tilt, offset; /* random shift (m) and tilt (rad) of the upper; its x offset */
} meeting;

typedef struct outcome {
  size_t stuck, through, stopped;
} outcome;

static void meet(const meeting *m, double speed, uint64_t number, outcome *out) {
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
  out->stuck += touched && o.pair_count > 0;
  out->through += corners_inside(world, a, b) + corners_inside(world, b, a) > 0;
  scree_world_get_body(world, a, &up);
  scree_world_get_body(world, b, &down);
  if (m->offset == 0 && m->shift < 0.2 * mu.size) out->through += up.position[2] < down.position[2];
  scree_world_free(world);
}

static void nothing_passes_or_sticks(void **state) {
  (void)state;
  const quat none = {1, 0, 0, 0};
  quat quarter = quat_from_rotation_vector((vec3){0, 0, 90 * degree}),
       on_edge = quat_from_rotation_vector((vec3){45 * degree, 0, 0}),
       crossed = quat_mul(quarter, on_edge),
       on_corner = quat_from_rotation_vector((vec3){45 * degree, 35 * degree, 0}),
       notch_up = quat_from_rotation_vector((vec3){90 * degree, 0, 0}),
       hook_down = quat_from_rotation_vector((vec3){-90 * degree, 0, 0});
  scree_particle *bar = particle_of(shape_box(0.1, 0.012, 0.012)),
                 *cube = particle_of(shape_box(0.04, 0.04, 0.04)),
                 *plate = particle_of(shape_grid_box(0.1, 0.06, 0.015, 3)),
                 *notch = particle_of(solid_notch(0.06, 30 * degree, 0.05)),
                 *hook = particle_of(solid_hook(0.06, 0.014, 0.02)),
                 *stick = particle_of(shape_box(0.01, 0.08, 0.01));
  const meeting meetings[] = {
      {"crossed edges of bars", bar, bar, crossed, on_edge, 0.003, 0.2, 0},
      {"crossed bars, faces", bar, bar, quarter, none, 0.003, 0.2, 0},
      {"corner on face", cube, plate, on_corner, none, 0.003, 0.3, 0},
      {"plate on plate", plate, plate, none, none, 0.003, 0.02, 0},
      {"plate on plate, squarely", plate, plate, none, none, 0, 0, 0},
      {"bar into notch", stick, notch, none, notch_up, 0.004, 0.2, 0},
      {"edge of a cube into notch", cube, notch, on_edge, notch_up, 0.004, 0.2, 0},
      {"hooks", hook, hook, hook_down, notch_up, 0.01, 0.3, 0.02},
      {"hooks, any way", hook, hook, none, none, 0.02, 3.1, 0},
  };
  for (size_t i = 0; i < sizeof meetings / sizeof *meetings; i++)
    for (int fast = 0; fast < 2; fast++) {
      outcome out = {0};
      for (uint64_t k = 0; k < TRIES; k++) meet(&meetings[i], fast ? 15.4 : 7.7, k, &out);
      char what[80];
      snprintf(what, sizeof what, "%s, %g m/s: passed through", meetings[i].name,
               fast ? 15.4 : 7.7);
      LAW_NEAR("L8", what, (double)out.through, 0, 0);
      LAW_NEAR("L8", "stuck", (double)out.stuck, 0, 0);
      LAW_NEAR("L8", "stopped beyond the overlap limit", (double)out.stopped, 0, 0);
    }
  scree_particle *all[] = {bar, cube, plate, notch, hook, stick};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) scree_particle_free(all[i]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_passes_or_sticks)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
