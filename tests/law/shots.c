/* Nothing passes unseen: bodies of every kind, stiffness and law shot at planes, thin and thick
 * walls, closed and open, at up to eight times the speed that the soft spring bears, come back or
 * the run says what passed and how stiff it must be; none is found behind. Contacts pressed beyond
 * the overlap limit harden: restitution and ledger stay those of soft hits, and what is squeezed
 * between a heavy body and a floor is held, counted and told. With `full` twenty times as many. */
#include "support/law.h"

#include "support/plates.h"
#include "support/shapes.h"

enum { WALLS = 3, LAWS = 3, TRIES = 3, SOFT = 300, HARD = 500, SHOTS = 60 };
static const double radius = 6e-3, wide = 0.1, thick = 4e-3, young = 1e6;
static size_t more = 1;
/* A shot's energy missed, which few soft ones may exceed: the hysteretic law's balance is not
 * drawn. */
static const double ledger_share = 1e-3, may_exceed[LAWS] = {0, 0.05, 0};

static scree_world *make_world(scree_law law, double stiffness, double restitution) {
  scree_error error;
  scree_world *world = NULL;
  scree_world_options o = scree_default_world_options();
  scree_material m = {
      .young = stiffness, .density = 2000, .restitution = restitution, .friction = 0.5};
  o.gravity[2] = 0;
  o.law = law;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  m.young = 1e10;
  CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  return world;
}

static void add_mesh_wall(scree_world *world, scree_mesh *mesh) {
  scree_error error;
  scree_wall wall = {.kind = SCREE_WALL_MESH, .material = 1, .axis = {0, 0, 1}, .mesh = mesh};
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  scree_mesh_free(mesh);
}

/* A box, or a sheet, its upper side at z = 0. */
static scree_mesh make_slab(bool open, double deep, size_t facets, scree_rng *rng) {
  const vec3 square[4] = {{-wide, -wide, 0}, {wide, -wide, 0}, {wide, wide, 0}, {-wide, wide, 0}};
  scree_mesh mesh = open ? plates_of(square, 1) : shape_box(2 * wide, 2 * wide, deep);
  if (!open) shape_move(&mesh, (vec3){-wide, -wide, -deep});
  plates_split(&mesh, facets, rng);
  return mesh;
}

static scree_body start_of(double speed, double aside, scree_rng *rng) {
  const quat q = scree_rng_rotation(rng);
  const vec3 way = vec3_unit(vec3_mad((vec3){0, 0, -1}, scree_rng_direction(rng), aside));
  scree_body body = {.position = {0, 0, 1.3 * radius}, .orientation = {q.w, q.x, q.y, q.z}};
  vec3_store(body.velocity, vec3_scale(way, speed));
  vec3_store(body.angular_velocity, vec3_scale(scree_rng_direction(rng), 30));
  return body;
}

/* ---- at so many times the speed that presses a linear spring in by the limit ---- */

typedef struct shot {
  plates_body_kind shape;
  int wall; /* a plane, a box or a sheet */
  scree_law law;
  double times;
  uint64_t number;
} shot;

typedef struct outcome {
  bool told, behind;
  double kept, missed, deepest; /* shares of the energy; over the limit */
} outcome;

static outcome shoot(const shot *s) {
  scree_error error;
  scree_rng rng = {.seed = 77, .stream = s->number};
  scree_particle *particle = plates_body(s->shape, radius, &rng);
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  scree_world *world = make_world(s->law, young, 0.5);
  scree_mesh mesh = {0};
  if (s->wall == 0)
    law_floor(world);
  else
    mesh = make_slab(s->wall == 2, thick, 60, &rng), add_mesh_wall(world, &mesh);
  const double speed = s->times * 0.1 * m.size * sqrt(young * m.size / (2000 * m.volume)),
               end = 0.02 + 30 * radius / speed;
  scree_body body = start_of(speed, 0.3, &rng);
  const size_t index = law_body(world, particle, body);
  scree_observation o;
  outcome out = {.told = scree_world_step(world, 1, &error) != SCREE_OK};
  const double before = law_ledger(world, &o), energy = o.kinetic + o.rotational;
  while (!out.told && scree_world_time(world) < end && body.position[2] > -thick - 4 * radius &&
         !(body.position[2] > 2 * radius && body.velocity[2] > 0)) {
    out.told = scree_world_step(world, 5, &error) != SCREE_OK;
    scree_world_observe(world, &o);
    out.deepest = fmax(out.deepest, o.largest_overlap / (0.1 * m.size));
    scree_world_get_body(world, index, &body);
  }
  out.behind = !out.told && body.position[2] < 0;
  out.missed = fabs(law_ledger(world, &o) - before) / energy;
  out.kept = (o.kinetic + o.rotational) / energy;
  const scree_world_hardening h = scree_world_get_hardening(world, 1, 0);
  assert_true(out.told || (h.count > 0) == (h.deepest > 1));
  assert_int_equal(h.count, o.hardened_count);
  scree_world_free(world);
  scree_particle_free(particle);
  return out;
}

/* In the mean of some tries. */
static outcome shoot_some(shot s) {
  outcome all = {0};
  for (s.number = 0; s.number < TRIES; s.number++) {
    const outcome one = shoot(&s);
    all.told |= one.told;
    all.behind |= one.behind;
    all.kept += one.kept / TRIES;
    all.missed = fmax(all.missed, one.missed);
    all.deepest = fmax(all.deepest, one.deepest);
  }
  return all;
}

static void hits_are_held(void **state) {
  (void)state;
  static const double most_missed[LAWS] = {2e-3, 0.02, 2e-3};
  double deepest = 0, missed[LAWS] = {0}, off = 0;
  for (int law = 0; law < LAWS; law++)
    for (int shape = 0; shape < PLATES_BODIES; shape++)
      for (int wall = 0; wall < WALLS; wall++) {
        shot s = {(plates_body_kind)shape, wall, (scree_law)law, 0.7, 0};
        const outcome soft = shoot_some(s);
        s.times = law == SCREE_LAW_HERTZ ? 2.5 : 4;
        const outcome hard = shoot_some(s);
        if (soft.told || soft.behind || hard.told || hard.behind)
          fail_msg("law %d, shape %d, wall %d: %d %d %d %d", law, shape, wall, soft.told,
                   soft.behind, hard.told, hard.behind);
        assert_true(soft.deepest < 1 && hard.deepest > 1);
        deepest = fmax(deepest, hard.deepest);
        missed[law] = fmax(missed[law], hard.missed);
        off = fmax(off, fabs(hard.kept - soft.kept));
      }
  LAW_BELOW("L22", "at 4 (Hertz 2.5) times the limit's speed: overlap over it", deepest, 3);
  LAW_BELOW("L22", "energy kept beside that of soft hits", off, 0.1);
  for (int law = 0; law < LAWS; law++)
    LAW_BELOW("L17", "its ledger", missed[law], most_missed[law]);
}

/* Between these times of the limit's speed. */
static void shoot_at_random(size_t count, double low, double high, outcome *all, double off[LAWS],
                            size_t *told) {
  scree_rng rng = {.seed = 78};
  size_t shots[LAWS] = {0}, missing[LAWS] = {0};
  for (size_t i = 0; i < count; i++) {
    const shot s = {.shape = (plates_body_kind)scree_rng_below(&rng, PLATES_BODIES),
                    .wall = (int)scree_rng_below(&rng, WALLS),
                    .law = (scree_law)scree_rng_below(&rng, LAWS),
                    .times = low + (high - low) * scree_rng_uniform(&rng),
                    .number = i};
    const outcome out = shoot(&s);
    *told += out.told;
    all->behind |= out.behind;
    shots[s.law]++;
    missing[s.law] += !out.told && out.missed > ledger_share;
  }
  for (int law = 0; law < LAWS; law++) off[law] = (double)missing[law] / (double)shots[law];
}

static void soft_hits_keep_the_books(void **state) {
  (void)state;
  outcome all = {0};
  double off[LAWS];
  size_t told = 0;
  shoot_at_random(SOFT * more, 0.1, 0.95, &all, off, &told);
  assert_true(told == 0 && !all.behind);
  for (int law = 0; law < LAWS; law++)
    LAW_BELOW("L17", "share of soft shots whose ledger is off", off[law], may_exceed[law]);
}

static void none_is_behind(void **state) {
  (void)state;
  outcome all = {0};
  double off[LAWS];
  size_t told = 0;
  shoot_at_random(HARD * more, 1, 8, &all, off, &told);
  print_message("of %zu shots at 1 to 8 times the limit's speed %zu end the run\n", HARD * more,
                told);
  LAW_NEAR("L22", "behind a wall, and nothing was told", (double)all.behind, 0, 0);
  assert_true(told < HARD * more / 5);
}

/* A ball of 30 mm falls on a grain of 6 mm that lies on a floor: bisected, 5.9 times the stiffness
 * keeps it soft. */
static void a_squeezed_grain_is_told(void **state) {
  (void)state;
  for (int law = 0; law < LAWS; law++) {
    scree_world *world = make_world((scree_law)law, young, 0.5);
    law_floor(world);
    scree_particle *fine = law_sphere(3e-3), *big = law_sphere(15e-3);
    scree_body body = scree_default_body();
    body.position[2] = 3e-3;
    law_body(world, fine, body);
    body.position[2] = 6e-3 + 15.1e-3;
    body.velocity[2] = -0.6;
    law_body(world, big, body);
    scree_observation o;
    law_step(world, 1);
    const double before = law_ledger(world, &o), energy = o.kinetic;
    double missed = 0;
    while (scree_world_time(world) < 0.05) {
      law_step(world, 20);
      missed = fmax(missed, fabs(law_ledger(world, &o) - before));
    }
    scree_world_get_body(world, 1, &body);
    assert_true(body.velocity[2] > 0);
    const scree_world_hardening grains = scree_world_get_hardening(world, 0, 0),
                                floor = scree_world_get_hardening(world, 0, 1);
    print_message("grains %llu times to %.3g limits, %.3g times as stiff; floor %llu times\n",
                  (unsigned long long)grains.count, grains.deepest, grains.stiffness_missing,
                  (unsigned long long)floor.count);
    assert_true(grains.count > 0 && grains.deepest < 2.5 && grains.stiffness_missing > 2);
    LAW_BELOW("L17", "a squeezed grain: ledger", missed / energy, 1e-3);
    scree_world_free(world);
    scree_particle_free(fine);
    scree_particle_free(big);
  }
}

/* ---- at any speed, stiffness and thickness ---- */

typedef enum fate { HELD, TOLD, BEHIND, FATES } fate;

static double between(double low, double high, scree_rng *rng) {
  return low * pow(high / low, scree_rng_uniform(rng));
}

static fate watch(scree_world *world, size_t index, double speed, double deep, scree_error *error) {
  const double end = 0.02 + 30 * radius / speed, out = 2 * radius;
  scree_body body;
  do {
    if (scree_world_step(world, 20, error) != SCREE_OK) return TOLD;
    scree_world_get_body(world, index, &body);
    if (body.position[2] > out) return HELD;
  } while (scree_world_time(world) < end && body.position[2] > -deep - out);
  return body.position[2] > 0 ? HELD : BEHIND;
}

static fate shoot_anyhow(uint64_t number) {
  scree_rng rng = {.seed = 51, .stream = number};
  const int shape = (int)scree_rng_below(&rng, PLATES_BODIES);
  const bool open = scree_rng_below(&rng, 2);
  const double deep = between(1e-4, 1e-2, &rng), speed = between(1, 30, &rng),
               stiffness = between(1e5, 1e8, &rng);
  scree_error error;
  scree_world *world = make_world(SCREE_LAW_LINEAR, stiffness, 0.3);
  scree_mesh mesh = make_slab(open, deep, (size_t)between(12, 400, &rng), &rng);
  if (open && scree_rng_below(&rng, 2)) plates_turn(&mesh);
  add_mesh_wall(world, &mesh);
  scree_particle *particle = plates_body((plates_body_kind)shape, radius, &rng);
  const size_t index = law_body(world, particle, start_of(speed, 0.5, &rng));
  const fate what = watch(world, index, speed, open ? 0 : deep, &error);
  if (what == BEHIND)
    print_message("shot %llu: shape %d at %.3g m/s, E = %.3g N/m2, is behind a wall of %.3g mm\n",
                  (unsigned long long)number, shape, speed, stiffness, 1e3 * deep);
  if (what == TOLD) {
    assert_int_equal(error.status, SCREE_DIVERGED);
    assert_non_null(strstr(error.message, "body 0"));
  }
  scree_particle_free(particle);
  scree_world_free(world);
  return what;
}

static void nothing_passes_unseen(void **state) {
  (void)state;
  size_t counts[FATES] = {0}, shots = SHOTS * more;
  for (uint64_t i = 0; i < shots; i++) counts[shoot_anyhow(i)]++;
  print_message("of %zu shots %zu were held, %zu told\n", shots, counts[HELD], counts[TOLD]);
  LAW_NEAR("-", "behind a wall, and nothing was told", (double)counts[BEHIND], 0, 0);
  assert_true(counts[HELD] > shots / 4 && counts[TOLD] > 0);
}

/* Two bodies, of which none is a thin plate, meet head-on: neither is found behind the other. */
static fate meet(uint64_t number) {
  scree_rng rng = {.seed = 52, .stream = number};
  const double speed = between(1, 30, &rng), stiffness = between(1e5, 1e8, &rng);
  scree_error error;
  scree_world *world = make_world(SCREE_LAW_LINEAR, stiffness, 0.3);
  scree_particle *shapes[2];
  scree_body bodies[2];
  size_t index[2];
  for (int k = 0; k < 2; k++) {
    shapes[k] =
        plates_body((plates_body_kind)(1 + scree_rng_below(&rng, PLATES_BODIES - 1)), radius, &rng);
    quat q = scree_rng_rotation(&rng);
    double side = k ? -1 : 1, aside = 0.2 * radius * (scree_rng_uniform(&rng) - 0.5);
    bodies[k] = (scree_body){.position = {aside, 0, 1.3 * radius * side},
                             .velocity = {0, 0, -0.5 * speed * side},
                             .orientation = {q.w, q.x, q.y, q.z}};
    index[k] = law_body(world, shapes[k], bodies[k]);
  }
  fate what = HELD;
  const double end = 0.02 + 30 * radius / speed, apart = 2.8 * radius;
  double above = 0, aside = 0;
  do {
    if (scree_world_step(world, 20, &error) != SCREE_OK) what = TOLD;
    for (int k = 0; k < 2; k++) scree_world_get_body(world, index[k], &bodies[k]);
    above = bodies[0].position[2] - bodies[1].position[2];
    aside = hypot(bodies[0].position[0] - bodies[1].position[0],
                  bodies[0].position[1] - bodies[1].position[1]);
  } while (what == HELD && scree_world_time(world) < end && hypot(above, aside) < apart);
  if (what == HELD && above < -aside) what = BEHIND;
  if (what == BEHIND)
    print_message("meeting %llu: bodies at %.3g m/s, E = %.3g N/m2, are past each other\n",
                  (unsigned long long)number, speed, stiffness);
  for (int k = 0; k < 2; k++) scree_particle_free(shapes[k]);
  scree_world_free(world);
  return what;
}

static void no_bodies_pass_each_other_unseen(void **state) {
  (void)state;
  size_t counts[FATES] = {0}, shots = SHOTS * more;
  for (uint64_t i = 0; i < shots; i++) counts[meet(i)]++;
  print_message("of %zu meetings %zu held, %zu were told\n", shots, counts[HELD], counts[TOLD]);
  /* of two that turn in each other a place may come out by the side by which it came in */
  LAW_BELOW("-", "past each other, and nothing was told", (double)counts[BEHIND],
            1 + (double)shots / 500);
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "full") == 0) more = 20;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(hits_are_held),         cmocka_unit_test(soft_hits_keep_the_books),
      cmocka_unit_test(none_is_behind),        cmocka_unit_test(a_squeezed_grain_is_told),
      cmocka_unit_test(nothing_passes_unseen), cmocka_unit_test(no_bodies_pass_each_other_unseen)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
