/* Oracles of the contact law: the force is the slope of the energy; lists and sleeping change
 * nothing; threads change nothing; a warm step allocates nothing; what leaves the model's range
 * stops. */
#include "support/law.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/rng.h"
#include "particle/closest.h"
#include "support/shapes.h"
#include "support/solids.h"
#include "support/threads.h"
#include "world/contact/contact.h"
#include "world/observe/replay.h"
#include "world/state/pairs.h"

#include <stdlib.h>

static scree_world *elastic_world(double skin) {
  scree_error error;
  scree_world_options o = scree_default_world_options();
  o.gravity[2] = 0;
  o.skin = skin;
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  scree_material m = scree_default_material();
  m.restitution = 1;
  m.friction = 0;
  CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  return world;
}

/* The pair's energy, and the force on body 0, at these poses (both at rest). */
static double energy_at(scree_world *world, const scree_body *a, const scree_body *b,
                        double force[3]) {
  law_place(world, 0, a);
  law_place(world, 1, b);
  law_step(world, 1);
  scree_observation o;
  scree_world_observe(world, &o);
  scree_body after;
  scree_world_get_body(world, 0, &after);
  double dt = scree_world_time_step(world, NULL), mass = scree_world_body_mass(world, 0);
  for (int k = 0; k < 3; k++) force[k] = mass * after.velocity[k] / dt;
  return o.elastic;
}

/* Moves b towards a along z until the energy is that of an overlap of about `depth`; false when the
 * two miss each other. */
static bool bring_together(scree_world *world, scree_body *a, scree_body *b, double depth) {
  double force[3], high = 0.25, low = 0;
  double stiffness = 0.5e8 * 0.03, target = 0.5 * stiffness * depth * depth;
  if (energy_at(world, a, b, force) > 0) return false;
  for (double z = high; z > 0; z -= 2e-4) { /* first touch from outside */
    b->position[2] = z;
    if (energy_at(world, a, b, force) > 0) {
      low = z;
      high = z + 2e-4;
      break;
    }
  }
  if (low == 0) return false;
  for (int i = 0; i < 40; i++) {
    b->position[2] = 0.5 * (low + high);
    if (energy_at(world, a, b, force) > target)
      low = b->position[2];
    else
      high = b->position[2];
  }
  return true;
}

static void turn_at_random(scree_rng *rng, scree_body *body) {
  quat q = scree_rng_rotation(rng);
  const double orientation[4] = {q.w, q.x, q.y, q.z};
  memcpy(body->orientation, orientation, sizeof orientation);
}

static void force_is_the_slope_of_the_energy(void **state) {
  (void)state;
  scree_particle *shapes[] = {shape_particle(shape_box(0.06, 0.04, 0.02)),
                              shape_particle(shape_icosphere(0.02, 1)),
                              shape_particle(solid_tray(0.06, 0.04, 0.02, 0.004)),
                              shape_particle(solid_hook(0.05, 0.012, 0.02))};
  scree_rng rng = {.seed = 11};
  double worst = 0;
  int tried = 0;
  for (int i = 0; i < 40; i++) {
    scree_world *world = elastic_world(0.02);
    scree_body a = scree_default_body(), b = a;
    turn_at_random(&rng, &a);
    turn_at_random(&rng, &b);
    b.position[0] = 0.01 * (2 * scree_rng_uniform(&rng) - 1);
    b.position[2] = 0.25;
    law_body(world, shapes[i % 4], a);
    law_body(world, shapes[(i / 4) % 4], b);
    if (bring_together(world, &a, &b, 5e-6 + 1e-5 * scree_rng_uniform(&rng))) {
      double force[3], size = 0, off = 0, unused[3];
      energy_at(world, &a, &b, force);
      const double h = 2e-9;
      for (int k = 0; k < 3; k++) {
        scree_body up = a, down = a;
        up.position[k] += h;
        down.position[k] -= h;
        double slope =
            (energy_at(world, &up, &b, unused) - energy_at(world, &down, &b, unused)) / (2 * h);
        size += force[k] * force[k];
        off += (force[k] + slope) * (force[k] + slope);
      }
      worst = fmax(worst, sqrt(off / size));
      tried++;
    }
    scree_world_free(world);
  }
  assert_true(tried > 25);
  LAW_BELOW("-", "force against the slope of the energy, relative", worst, 0.01);
  for (int i = 0; i < 4; i++) scree_particle_free(shapes[i]);
}

/* Two bodies tumble into each other; at many moments a fresh world with lists over everything gives
 * the same energy. */
static void lists_change_nothing(void **state) {
  (void)state;
  scree_particle *shapes[] = {shape_particle(shape_grid_box(0.06, 0.04, 0.02, 3)),
                              shape_particle(shape_icosphere(0.02, 2)),
                              shape_particle(solid_tray(0.06, 0.04, 0.02, 0.004))};
  scree_rng rng = {.seed = 12};
  double worst = 0;
  size_t compared = 0;
  for (int i = 0; i < 60; i++) {
    scree_world *world = elastic_world(0.02), *fresh = elastic_world(1);
    scree_body body[2];
    for (int k = 0; k < 2; k++) {
      body[k] = scree_default_body();
      turn_at_random(&rng, &body[k]);
      body[k].position[2] = k ? -0.035 : 0.035;
      body[k].position[0] = 0.005 * scree_rng_uniform(&rng);
      body[k].velocity[2] = k ? 0.2 : -0.2;
      vec3_store(body[k].angular_velocity, vec3_scale(scree_rng_direction(&rng), 5));
      law_body(world, shapes[(i + k * (i / 3)) % 3], body[k]);
      law_body(fresh, shapes[(i + k * (i / 3)) % 3], body[k]);
    }
    for (int step = 0; step < 12000; step++) {
      scree_observation o;
      scree_world_get_body(world, 0, &body[0]);
      scree_world_get_body(world, 1, &body[1]);
      law_step(world, 1);
      if (step % 200 && scree_world_step_count(world) % 3) continue;
      scree_world_observe(world, &o);
      if (step % 200 && o.pair_count == 0) continue;
      double unused[3], elastic = energy_at(fresh, &body[0], &body[1], unused);
      worst = fmax(worst, fabs(elastic - o.elastic) / fmax(elastic, 1e-9));
      compared += o.pair_count;
    }
    scree_world_free(world);
    scree_world_free(fresh);
  }
  print_message("%zu moments in contact\n", compared);
  assert_true(compared > 500);
  LAW_BELOW("-", "energy with lists and sleep against a fresh world", worst, 1e-6);
  for (int i = 0; i < 3; i++) scree_particle_free(shapes[i]);
}

/* Energy of a pair's contact at its bodies' frames, on a copy of its memory; its wrench too. */
static double energy_of_copy(const scree_world *world, const scree_pair *pair,
                             scree_pair_wrench *wrench) {
  scree_pair_copy copy = {0};
  assert_true(scree_copy_pair(world, pair, &copy));
  copy.pair.list.end = INFINITY; /* the present list */
  assert_true(scree_evaluate_copy(world, &copy));
  scree_free_pair_copy(&copy);
  *wrench = copy.pair.contact.wrench;
  return copy.pair.contact.elastic;
}

/* Force and torque on body 0 against central differences of the energy over its six motions. The
 * error relative to the force; torques by the size of the bodies. */
static double slope_error(scree_world *world, const scree_pair *pair) {
  const double h = 1e-9, arm = 0.03;
  scree_frame *frame = &world->bodies.frame[0];
  const scree_frame here = *frame;
  scree_pair_wrench wrench, unused;
  energy_of_copy(world, pair, &wrench);
  double size = vec3_norm(wrench.force), worst = 0;
  for (int k = 0; k < 6; k++) {
    double energy[2];
    for (int end = 0; end < 2; end++) {
      double move = end ? h : -h;
      vec3 axis = {k % 3 == 0 ? move : 0, k % 3 == 1 ? move : 0, k % 3 == 2 ? move : 0};
      if (k < 3) {
        frame->position = vec3_add(here.position, axis);
      } else {
        mat3 turn = quat_to_mat3(quat_from_rotation_vector(vec3_scale(axis, 1 / arm)));
        frame->rotation = mat3_mul(&turn, &here.rotation);
      }
      energy[end] = energy_of_copy(world, pair, &unused);
      *frame = here;
    }
    double slope = (energy[1] - energy[0]) / (2 * h);
    vec3 load = k < 3 ? wrench.force : vec3_scale(wrench.torque_a, 1 / arm);
    double got = k % 3 == 0 ? load.x : k % 3 == 1 ? load.y : load.z;
    worst = fmax(worst, fabs(got + slope) / size);
  }
  return worst;
}

/* Two of four shapes at 10 m/s, alike in both worlds. */
static void throw_at_each_other(scree_particle *const shapes[4], int i, scree_rng *rng,
                                scree_world *world, scree_world *other) {
  for (int k = 0; k < 2; k++) {
    scree_body body = scree_default_body();
    turn_at_random(rng, &body);
    body.position[2] = k ? -0.04 : 0.04;
    body.position[0] = 0.01 * scree_rng_uniform(rng);
    body.velocity[2] = k ? 5 : -5;
    vec3_store(body.angular_velocity, vec3_scale(scree_rng_direction(rng), 20));
    law_body(world, shapes[(i + k * (i / 4)) % 4], body);
    law_body(other, shapes[(i + k * (i / 4)) % 4], body);
  }
}

/* Bodies hit each other at 10 m/s, edges and corners far deeper than the roundings: at the moments
 * of the hit the force is the slope of the energy, but where weights change (their slopes are left
 * out: docs/background/physics.md) and where it gives back what that won or lost. The same hit
 * with lists that reach two and a half times farther takes the same course. */
static void deep_hits(void **state) {
  (void)state;
  scree_particle *shapes[] = {shape_particle(shape_box(0.06, 0.04, 0.02)),
                              shape_particle(shape_icosphere(0.02, 1)),
                              shape_particle(solid_tray(0.06, 0.04, 0.02, 0.004)),
                              shape_particle(solid_hook(0.05, 0.012, 0.02))};
  scree_rng rng = {.seed = 14};
  double apart = 0, deepest = 0;
  size_t moments = 0, off = 0;
  for (int i = 0; i < 60; i++) {
    scree_world *world = elastic_world(0.02), *wide = elastic_world(0.05);
    throw_at_each_other(shapes, i, &rng, world, wide);
    for (int step = 0; step < 1500; step++) {
      scree_observation o, same;
      law_step(world, 1);
      law_step(wide, 1);
      scree_world_observe(world, &o);
      scree_world_observe(wide, &same);
      if (o.pair_count == 0) continue;
      apart = fmax(apart, fabs(o.kinetic + o.rotational - same.kinetic - same.rotational) /
                              (same.kinetic + same.rotational));
      deepest = fmax(deepest, o.largest_overlap);
      if (step % 3) continue;
      moments++;
      off += slope_error(world, scree_pair_of(world, 0)) > 0.01;
    }
    scree_world_free(world);
    scree_world_free(wide);
  }
  print_message("%zu moments, overlaps up to %.3g m\n", moments, deepest);
  assert_true(moments > 300 && deepest > 3e-4);
  LAW_BELOW("-", "deep hits: energy, two skins of the lists", apart, 1e-6);
  LAW_BELOW("-", "share of moments with force off the slope by 1 %", (double)off / (double)moments,
            0.15);
  for (int i = 0; i < 4; i++) scree_particle_free(shapes[i]);
}

/* All features of both bodies among the sleepers, due at once: no search, no cones. */
static void wake_everything(scree_world *world, size_t k) {
  scree_neighbours *n = &world->list.neighbours.items[k];
  scree_pair *pair = scree_pair_of(world, k);
  const scree_particle *a = world->bodies.particle[n->a], *b = world->bodies.particle[n->b];
  size_t count = a->point_count + b->point_count + a->edge_count * b->edge_count, made = 0;
  scree_list_state *list = pair ? &pair->list : &n->list;
  if (list->end < INFINITY) { /* for the first time */
    scree_scratch hand = {.pools = &world->pools, .neighbours = n};
    n->sleeping.count = 0;
    while (!scree_reserve_sleeping(&hand, (uint32_t)count))
      assert_true(scree_pack_sleeping(&world->pools, world->list.neighbours.items,
                                      world->list.neighbours.count));
    scree_sleeping_feature *all = &world->pools.sleeping_features[n->sleeping.first];
    for (uint32_t i = 0; i < a->point_count; i++)
      all[made++] = (scree_sleeping_feature){0, i, 0, SCREE_FEATURE_POINT_FACE};
    for (uint32_t i = 0; i < b->point_count; i++)
      all[made++] = (scree_sleeping_feature){0, 0, i, SCREE_FEATURE_FACE_POINT};
    for (uint32_t i = 0; i < a->edge_count; i++)
      for (uint32_t j = 0; j < b->edge_count; j++)
        all[made++] = (scree_sleeping_feature){0, i, j, SCREE_FEATURE_EDGE_EDGE};
    n->sleeping.count = (uint32_t)made;
    if (pair) pair->active.count = 0;
    list->end = INFINITY;
  }
  for (uint32_t i = 0; i < n->sleeping.count; i++)
    world->pools.sleeping_features[n->sleeping.first + i].wake = -INFINITY;
  list->next_feature = -INFINITY;
  n->asleep = false;
}

/* How far apart in energy a world and the same by brute force come, of the whole; the deepest
 * overlap. */
static double apart_from_brute(scree_world *world, scree_world *brute, int steps, double *deepest) {
  double apart = 0;
  for (int step = 0; step < steps; step++) {
    scree_observation o, same;
    if (brute->list.neighbours.count > 0) {
      wake_everything(brute, 0);
      brute->list.slots.items[0].wake = -INFINITY;
    }
    law_step(world, 1);
    law_step(brute, 1);
    scree_world_observe(world, &o);
    scree_world_observe(brute, &same);
    double whole = o.kinetic + o.rotational + o.elastic;
    apart = fmax(apart, fabs(o.elastic - same.elastic) / whole);
    *deepest = fmax(*deepest, o.largest_overlap);
  }
  return apart;
}

/* A box, a hook, a tray and an icosphere of so many subdivisions. */
static void make_four(scree_particle *shapes[4], int subdivisions) {
  shapes[0] = shape_particle(shape_box(0.06, 0.04, 0.02));
  shapes[1] = shape_particle(solid_hook(0.05, 0.012, 0.02));
  shapes[2] = shape_particle(solid_tray(0.06, 0.04, 0.02, 0.004));
  shapes[3] = shape_particle(shape_icosphere(0.02, subdivisions));
}

/* Hits at 10 m/s beside the same with every feature of both bodies looked at in every step: the
 * same energies to rounding, however deep. The force's sums run in another order, and a hit at this
 * speed magnifies what that leaves. */
static void deep_hits_by_brute_force(void **state) {
  (void)state;
  scree_particle *shapes[4];
  make_four(shapes, 0);
  scree_rng rng = {.seed = 15};
  double apart = 0, deepest = 0;
  for (int i = 0; i < 32; i++) {
    scree_world *world = elastic_world(0.02), *brute = elastic_world(0.02);
    throw_at_each_other(shapes, i, &rng, world, brute);
    apart = fmax(apart, apart_from_brute(world, brute, 900, &deepest));
    scree_world_free(world);
    scree_world_free(brute);
  }
  assert_true(deepest > 3e-4);
  LAW_BELOW("-", "deep hits: energy, every feature in every step", apart, 1e-9);
  for (int i = 0; i < 4; i++) scree_particle_free(shapes[i]);
}

/* Bars with rounded backs, back to back across each other: beside the edges that meet lie many that
 * turn away from each other by more than their cones, and overlap nearly as much. Lists leave them
 * out, so they must not count. */
static void edges_that_turn_away_do_not_count(void **state) {
  (void)state;
  enum { ARC = 21 };
  double section[2 * (ARC + 2)] = {0};
  for (int i = 0; i < ARC; i++) {
    double angle = (3 * i - 30) * 3.14159265358979 / 180;
    section[2 * i] = -0.0005 * sin(angle);
    section[2 * i + 1] = 0.0005 * cos(angle);
  }
  section[2 * ARC] = -0.00025, section[2 * ARC + 1] = -0.002;
  section[2 * ARC + 2] = 0.00025, section[2 * ARC + 3] = -0.002;
  scree_particle *bar = shape_particle(solid_prism(section, ARC + 2, 0.03));
  scree_particle_measures m;
  scree_particle_measure(bar, &m);
  quat drawn = {m.orientation[0], m.orientation[1], m.orientation[2], m.orientation[3]},
       up = quat_from_rotation_vector((vec3){0.5 * 3.14159265358979, 0, 0}),
       down = quat_mul(quat_from_rotation_vector((vec3){0, 0, 0.5 * 3.14159265358979}),
                       quat_from_rotation_vector((vec3){-0.5 * 3.14159265358979, 0, 0}));
  scree_rng rng = {.seed = 17};
  double apart = 0, deepest = 0;
  for (int i = 0; i < 12; i++) {
    scree_world *world = elastic_world(0.02), *brute = elastic_world(0.02);
    for (int k = 0; k < 2; k++) {
      scree_body body = scree_default_body();
      vec3 tilt = vec3_scale(scree_rng_direction(&rng), 0.15 * scree_rng_uniform(&rng));
      quat q = quat_mul(quat_mul(quat_from_rotation_vector(tilt), k ? down : up), drawn);
      const double orientation[4] = {q.w, q.x, q.y, q.z};
      memcpy(body.orientation, orientation, sizeof orientation);
      body.position[2] = k ? 0.003 : -0.003;
      body.velocity[2] = k ? -8 : 8;
      vec3_store(body.angular_velocity, vec3_scale(scree_rng_direction(&rng), 100));
      law_body(world, bar, body);
      law_body(brute, bar, body);
    }
    apart = fmax(apart, apart_from_brute(world, brute, 600, &deepest));
    scree_world_free(world);
    scree_world_free(brute);
  }
  print_message("overlaps up to %.3g m\n", deepest);
  assert_true(deepest > 2e-4);
  LAW_BELOW("-", "rounded backs: energy, every feature in every step", apart, 1e-9);
  scree_particle_free(bar);
}

static scree_world *heap_of(scree_particle **shapes, size_t kinds, int count) {
  law_setup setup = law_default();
  setup.gravity = 9.81;
  setup.steps_per_contact = 20;
  scree_world *world = law_world(&setup);
  law_floor(world);
  scree_rng rng = {.seed = 13};
  for (int i = 0; i < count; i++) {
    scree_body body = scree_default_body();
    turn_at_random(&rng, &body);
    body.position[0] = 0.08 * (i % 3);
    body.position[1] = 0.08 * (i / 3 % 3);
    body.position[2] = 0.06 + 0.08 * (i / 9);
    body.velocity[2] = -2;
    law_body(world, shapes[(size_t)i % kinds], body);
  }
  return world;
}

static void threads_change_nothing(void **state) {
  (void)state;
  scree_particle *shapes[] = {
      shape_particle(shape_grid_box(0.06, 0.04, 0.02, 3)), shape_particle(shape_icosphere(0.02, 2)),
      shape_particle(solid_tray(0.06, 0.04, 0.02, 0.004)), law_sphere(0.02)};
  scree_checksum first = {0};
  const int threads[] = {1, 2, 3, 8};
  for (int i = 0; i < 4; i++) {
    use_threads(threads[i]);
    scree_world *world = heap_of(shapes, 4, 36);
    law_step(world, 15000);
    scree_observation o;
    scree_world_observe(world, &o);
    print_message("%zu pairs touch at %.3f s\n", o.pair_count, o.time);
    assert_true(o.pair_count > 5);
    scree_checksum hash = scree_world_hash(world);
    if (i == 0) first = hash;
    assert_true(hash.high == first.high && hash.low == first.low);
    scree_world_free(world);
  }
  use_threads(0);
  for (int i = 0; i < 4; i++) scree_particle_free(shapes[i]);
}

/* How many awake pairs there are, and how many do not lie behind the one before them. */
static size_t count_astray(const scree_world *world, size_t *count) {
  size_t astray = 0;
  uint32_t next = 0;
  *count = 0;
  for (size_t k = 0; k < world->list.neighbours.count; k++) {
    uint32_t pair = world->list.pair_of.items[k];
    if (pair == scree_none) continue;
    assert_int_equal(world->pairs.items[pair].neighbours, k);
    astray += pair != next;
    next = pair + 1;
    ++*count;
  }
  return astray;
}

/* Awake pairs that lie astray are brought into their order, and stay what they are. */
static void pairs_come_into_order(void **state) {
  (void)state;
  scree_particle *shapes[] = {shape_particle(shape_grid_box(0.06, 0.04, 0.02, 3)),
                              law_sphere(0.02)};
  scree_world *world = heap_of(shapes, 2, 144);
  size_t count, most = 0, sorted = 0;
  for (int i = 0; i < 700; i++) {
    law_step(world, 50);
    scree_checksum before = scree_world_hash(world);
    sorted += count_astray(world, &count) > count / 8 + 1;
    scree_pairs_tidy(world);
    assert_true(count_astray(world, &count) <= count / 8 + 1);
    if (count > most) most = count;
    scree_checksum after = scree_world_hash(world);
    assert_true(before.high == after.high && before.low == after.low);
    world->list.stale = true; /* or the step would look for them where they were */
  }
  print_message("sorted %zu times, up to %zu pairs\n", sorted, most);
  assert_true(sorted > 5 && most > 64);
  scree_world_free(world);
  for (int i = 0; i < 2; i++) scree_particle_free(shapes[i]);
}

/* A heap that has its neighbours allocates nothing. One in which balls still roll from neighbour to
 * neighbour allocates for pairs that are new, which is once in hundreds of steps. */
static void warm_steps_allocate_nothing(void **state) {
  (void)state;
  scree_particle *shapes[] = {shape_particle(shape_grid_box(0.06, 0.04, 0.02, 3)),
                              law_sphere(0.02)};
  for (size_t kinds = 1; kinds <= 2; kinds++) {
    scree_world *world = heap_of(shapes, kinds, 18);
    law_step(world, 80000);
    size_t before = scree_allocation_count();
    law_step(world, 2000);
    size_t count = scree_allocation_count() - before;
    scree_observation o;
    scree_world_observe(world, &o);
    print_message("%zu kinds: %zu allocations, %zu pairs touch\n", kinds, count, o.pair_count);
    assert_true(o.pair_count >= 18);
    assert_true(count <= (kinds == 1 ? 0 : 10));
    scree_world_free(world);
  }
  for (int i = 0; i < 2; i++) scree_particle_free(shapes[i]);
}

/* At 90 m/s it is pressed beyond its limit, comes back, and is counted; at 2 km/s no step sees it.
 */
static void what_leaves_the_range_is_told(void **state) {
  (void)state;
  scree_particle *box = shape_particle(shape_box(0.06, 0.04, 0.02));
  law_setup setup = law_default();
  for (int fast = 0; fast < 2; fast++) {
    scree_world *world = law_world(&setup);
    law_floor(world);
    scree_body body = scree_default_body();
    body.position[2] = 0.2;
    body.velocity[2] = fast ? -2000 : -90;
    law_body(world, box, body);
    scree_error error;
    scree_status status = scree_world_step(world, 20000, &error);
    scree_body after;
    scree_observation o;
    scree_world_observe(world, &o);
    scree_world_get_body(world, 0, &after);
    assert_true(isfinite(after.position[2]));
    assert_int_equal(status, fast ? SCREE_DIVERGED : SCREE_OK);
    assert_true(fast || (after.velocity[2] > 0 && o.hardened_count > 0 && o.stiffness_missing > 1));
    if (fast) {
      print_message("%s\n", error.message);
      assert_non_null(strstr(error.message, "would move"));
      assert_int_equal(scree_world_step(world, 1, NULL), SCREE_DIVERGED);
    }
    scree_world_free(world);
  }
  scree_particle_free(box);
}

static void unusable_meshes_are_refused(void **state) {
  (void)state;
  scree_error error;
  scree_particle *particle = NULL;
  scree_mesh box = shape_box(1, 1, 1);
  shape_flip(&box, 3);
  assert_int_equal(scree_particle_from_mesh(&box, NULL, &particle, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "wound against each other"));
  scree_mesh_free(&box);
  scree_mesh sheet = shape_sheet(0, 3);
  assert_int_equal(scree_particle_from_mesh(&sheet, NULL, &particle, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "open"));
  scree_mesh_free(&sheet);
  scree_mesh inside_out = shape_box(1, 1, 1);
  for (size_t t = 0; t < inside_out.triangle_count; t++) shape_flip(&inside_out, t);
  assert_int_equal(scree_particle_from_mesh(&inside_out, NULL, &particle, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "inside out"));
  scree_mesh_free(&inside_out);
  assert_null(particle);
  /* closed, manifold and of positive volume, but a box in a box, and two that cross */
  for (int crossing = 0; crossing < 2; crossing++) {
    scree_mesh one = shape_box(1, 1, 1), other = shape_box(0.5, 0.5, 0.5);
    shape_move(&other, crossing ? (vec3){0.7, 0.2, 0.3} : (vec3){0.2, 0.2, 0.2});
    scree_mesh both = shape_join(&one, &other);
    assert_int_equal(scree_particle_from_mesh(&both, NULL, &particle, &error), SCREE_BAD_MESH);
    print_message("%s\n", error.message);
    assert_non_null(strstr(error.message, crossing ? "crossing" : "nested shell"));
    scree_mesh_free(&one);
    scree_mesh_free(&other);
    scree_mesh_free(&both);
  }
  assert_null(particle);
}

static void features_follow_the_shape(void **state) {
  (void)state;
  for (size_t n = 1; n < 6; n++) {
    scree_particle *box = shape_particle(n == 1 ? shape_box(3, 2, 1) : shape_grid_box(3, 2, 1, n));
    scree_particle_measures m;
    scree_particle_measure(box, &m);
    assert_int_equal(m.point_count, 8);
    assert_int_equal(m.edge_count, 12);
    CHECK_NEAR(m.volume, 6, 1e-12);
    CHECK_NEAR(m.inertia[0], 6 * (2 * 2 + 1 * 1) / 12.0, 1e-12);
    CHECK_NEAR(m.inertia[2], 6 * (3 * 3 + 2 * 2) / 12.0, 1e-12);
    CHECK_NEAR(m.thickness, 1, 1e-9);
    scree_particle_free(box);
  }
}

/* The deepest of many points along the edges of `from` in `to`, which stands `relative` to it. */
static double sampled_depth(const scree_particle *from, const scree_particle *to,
                            const mat3 *rotation, vec3 shift) {
  enum { SAMPLES = 400 };
  const uint32_t root = 0;
  double deepest = 0;
  for (size_t i = 0; i < from->edge_count; i++)
    for (int k = 0; k <= SAMPLES; k++) {
      const scree_edge *e = &from->edges[i];
      vec3 x = vec3_mad(e->start, e->along, e->length * k / SAMPLES);
      x = vec3_add(mat3_mul_vec(rotation, x), shift);
      scree_box here = {x, x};
      uint32_t face;
      if (!scree_box_meets(&here, &to->box) || !scree_is_inside(to, x)) continue;
      deepest = fmax(deepest, scree_nearest_face(to, &root, 1, x, INFINITY, &face));
    }
  return deepest;
}

/* Depths of edges against samples: nothing is deeper than they say, and they miss no more than an
 * eighth. */
static void depth_of_edges(void **state) {
  (void)state;
  scree_particle *shapes[4];
  make_four(shapes, 1);
  scree_world *world = elastic_world(0.02);
  scree_rng rng = {.seed = 23};
  scree_scratch scratch = {0};
  assert_true(SCREE_RESERVE(&scratch.contacts, SCREE_DEPTHS));
  size_t deep = 0, missed = 0, apart = 0, unseen = 0;
  double beyond = 0;
  for (uint32_t i = 0; i < 4; i++) law_body(world, shapes[i], scree_default_body());
  for (int k = 0; k < 400; k++) {
    const double least = 2e-4 * (1 + k % 5);
    scree_pair pair = {.a = (uint32_t)k % 4, .b = (uint32_t)k / 4 % 4};
    const scree_particle *a = shapes[pair.a], *b = shapes[pair.b];
    scree_frame relative = {.rotation = quat_to_mat3(scree_rng_rotation(&rng))};
    relative.position = vec3_scale(scree_rng_direction(&rng), 0.045 * scree_rng_uniform(&rng));
    mat3 back = mat3_transpose(&relative.rotation);
    double sampled =
        fmax(sampled_depth(a, b, &relative.rotation, relative.position),
             sampled_depth(b, a, &back, vec3_neg(mat3_mul_vec(&back, relative.position))));
    scratch.contacts.count = 0;
    double depth = scree_depth_contacts(world, &pair, &relative, least, &scratch);
    deep += depth > least;
    bool cross = scree_surfaces_cross(a, b, &relative);
    apart += !cross;
    unseen += sampled > 0 && !cross;
    missed += 1.125 * depth < sampled;
    if (depth > least) beyond = fmax(beyond, depth - sampled);
  }
  scree_free(scratch.contacts.items);
  assert_true(deep > 100 && apart > 10);
  LAW_NEAR("-", "edges deep in the other body that are missed", (double)missed, 0, 0);
  LAW_NEAR("-", "edges in the other body while no surfaces cross", (double)unseen, 0, 0);
  LAW_BELOW("-", "deeper than samples are (m)", beyond, 1e-4); /* half the way between two */
  scree_world_free(world);
  for (int i = 0; i < 4; i++) scree_particle_free(shapes[i]);
}

/* By how much the widest of an edge's normals is outside the cone of a node above it, rad. */
static double outside(const scree_cone *node, const scree_cone *edge) {
  double between = acos(fmax(-1, fmin(1, vec3_dot(node->axis, edge->axis)))),
         wide = between + acos(edge->cosine);
  return fmin(wide, 3.14159265358979323846) - acos(node->cosine);
}

/* Nodes of an edge tree hold the normals of all edges below them: lists leave out whole nodes by
 * them. Edges that lie side by side in the tree may look opposite ways, to rounding: those of a
 * tray's walls did, and a ball went 2 mm into such an edge unfelt. */
static void cones_hold_the_edges_below(void **state) {
  (void)state;
  scree_particle *shapes[] = {shape_particle(shape_box(0.1, 0.05, 0.015)),
                              shape_particle(shape_box(0.06, 0.04, 0.002)),
                              shape_particle(solid_tray(0.06, 0.04, 0.02, 0.004)),
                              shape_particle(solid_hook(0.05, 0.012, 0.02)),
                              shape_particle(solid_notch(0.06, 0.5, 0.05)),
                              shape_particle(shape_icosphere(0.02, 2))};
  double worst = 0;
  for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) {
    const scree_tree *tree = &shapes[k]->edge_tree;
    uint32_t above[SCREE_TREE_STACK] = {0};
    /* every node, from the root down; then every edge below it */
    for (uint32_t i = 0; i < tree->node_count; i++) {
      int depth = 0;
      above[depth++] = i;
      while (depth > 0) {
        const scree_tree_node *node = &tree->nodes[above[--depth]];
        for (uint32_t e = 0; e < node->count; e++)
          worst = fmax(worst, outside(&tree->cones[i],
                                      &shapes[k]->edges[tree->order[node->first + e]].normals));
        if (node->count) continue;
        above[depth++] = node->first;
        above[depth++] = node->first + 1;
      }
    }
    scree_particle_free(shapes[k]);
  }
  LAW_BELOW("-", "normals outside the cones of trees (rad)", worst, 1e-7);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(features_follow_the_shape),
      cmocka_unit_test(cones_hold_the_edges_below),
      cmocka_unit_test(unusable_meshes_are_refused),
      cmocka_unit_test(force_is_the_slope_of_the_energy),
      cmocka_unit_test(lists_change_nothing),
      cmocka_unit_test(deep_hits),
      cmocka_unit_test(deep_hits_by_brute_force),
      cmocka_unit_test(edges_that_turn_away_do_not_count),
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(pairs_come_into_order),
      cmocka_unit_test(warm_steps_allocate_nothing),
      cmocka_unit_test(what_leaves_the_range_is_told),
      cmocka_unit_test(depth_of_edges),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
