/* Many spheres in several blocks: the same bits whatever the threads, after saving and loading, in
 * lanes, and where forces are gathered as a device does; forces against those of all pairs. */
#include "world/contact/spheres.h"
#include "base/alloc.h"
#include "base/rng.h"
#include "support/check.h"
#include "world/broad/broad.h"
#include "world/broad/spheres.h"
#include "world/state/save.h"
#include "world/step/checkpoint.h"

enum { SIDE = 21, COUNT = SIDE * SIDE * SIDE };
static const double radius = 1e-3;

/* Loosely packed, in no order, of two radii, as fast as `speed`, m/s. */
static scree_world *fill_world(const scree_world_options *o, const scree_material *material,
                               double speed, double second) {
  scree_error error;
  scree_world *world;
  CHECK_OK(scree_world_create(o, &world, &error), error);
  CHECK_OK(scree_world_add_material(world, material, NULL, &error), error);
  scree_particle *spheres[2];
  for (int k = 0; k < 2; k++)
    CHECK_OK(scree_particle_sphere(k ? second : radius, &spheres[k], &error), error);
  scree_rng rng = {.seed = 3};
  for (int n = 0; n < COUNT; n++) {
    const int i =
        (int)((long)n * 5003 % COUNT); /* in no order: the factor divides no power of 21 */
    const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
    scree_body body = scree_default_body();
    for (int k = 0; k < 3; k++) {
      body.position[k] = 1.98 * radius * at[k] + 1e-5 * scree_rng_uniform(&rng);
      body.velocity[k] = speed * 2 * (scree_rng_uniform(&rng) - 0.5);
      body.angular_velocity[k] = speed * 100 * (scree_rng_uniform(&rng) - 0.5);
    }
    CHECK_OK(scree_world_add_body(world, spheres[n % 5 == 0], 0, &body, NULL, &error), error);
  }
  for (int k = 0; k < 2; k++) scree_particle_free(spheres[k]);
  return world;
}

static scree_material soft(void) {
  scree_material material = scree_default_material();
  material.young = 1e6;
  material.rolling_friction = 0.1;
  return material;
}

static scree_world *make_world(void) {
  scree_world_options o = scree_default_world_options();
  o.gravity[2] = 0;
  const scree_material material = soft();
  return fill_world(&o, &material, 1, 0.8 * radius);
}

static void step(scree_world *world, size_t count) {
  scree_error error;
  CHECK_OK(scree_world_step(world, count, &error), error);
}

/* With threads, and saved and loaded in between. */
static void same_bits(void **state) {
  (void)state;
  scree_checksum hashes[3];
  uint64_t builds = 0;
  for (int run = 0; run < 3; run++) {
    scree_set_threads(run == 1 ? 2 : 1);
    scree_world *world = make_world();
    step(world, 60);
    if (run == 2) {
      scree_error error;
      unsigned char *bytes;
      size_t count;
      CHECK_OK(scree_world_pack(world, true, &bytes, &count, &error), error);
      scree_world_free(world);
      CHECK_OK(scree_world_unpack(bytes, count, "bytes", &world, &error), error);
      scree_free(bytes);
    }
    step(world, 60);
    hashes[run] = scree_world_hash(world);
    scree_timings timings;
    scree_world_timings(world, &timings);
    if (run == 0) builds = timings.broad_builds;
    scree_world_free(world);
  }
  scree_set_threads(0);
  assert_true(builds > 2);
  assert_memory_equal(&hashes[0], &hashes[1], sizeof *hashes);
  assert_memory_equal(&hashes[0], &hashes[2], sizeof *hashes);
}

/* A step by hand, pair by pair, each sphere gathering what acts on it. */
static void gathered(void **state) {
  (void)state;
  scree_error error;
  scree_world *summed = make_world(), *world = make_world();
  step(summed, 21);
  step(world, 20);
  CHECK_OK(scree_broad_update(world, &error), error);
  CHECK_OK(scree_spheres_list_seconds(world, &error), error);
  scree_spheres *s = &world->spheres;
  assert_int_equal(s->list.count, COUNT);
  assert_true(s->blocks.count > 2);
  scree_sphere_load(*loads)[2] = calloc(s->list.pairs.count, sizeof *loads);
  scree_sphere_load *apart = calloc(COUNT, sizeof *apart); /* of pairs in no order */
  for (size_t i = 0; i < s->list.count; i++) scree_spheres_load(world, i);
  size_t touching = 0, shared = 0;
  for (size_t k = s->list.pairs.count; k-- > 0;) {
    const scree_sphere_pair *two = &s->list.pairs.items[k];
    scree_sphere_result r;
    if (!scree_sphere_pair_is_due(world, two) || !scree_sphere_pair_step(world, k, &r)) continue;
    loads[k][0] = r.on_a;
    loads[k][1] = r.on_b;
    apart[two->a].force = vec3_add(apart[two->a].force, r.on_a.force);
    apart[two->b].force = vec3_add(apart[two->b].force, r.on_b.force);
    touching++;
    shared += two->a / SCREE_SPHERE_BLOCK != two->b / SCREE_SPHERE_BLOCK;
  }
  print_message("%zu pairs, %zu touch, %zu of two blocks\n", s->list.pairs.count, touching, shared);
  assert_true(touching > COUNT && shared > 100);
  for (size_t i = 0; i < s->list.count; i++) {
    scree_spheres_gather(world, i, (const scree_sphere_load(*)[2])loads);
    const vec3 force = s->load[i].force, there = summed->bodies.force[s->list.body[i]];
    assert_memory_equal(&force, &there, sizeof force);
    assert_memory_equal(&s->load[i].torque, &summed->bodies.torque[s->list.body[i]], sizeof force);
    assert_true(vec3_distance(force, apart[i].force) <= 1e-12 * (1 + vec3_norm(force)));
  }
  free(loads);
  free(apart);
  scree_world_free(summed);
  scree_world_free(world);
}

/* Listed are all whose distance is less than their radii, and each once. */
static void all_listed(void **state) {
  (void)state;
  scree_world *world = make_world();
  step(world, 100);
  scree_error error;
  CHECK_OK(scree_broad_update(world, &error), error);
  const scree_sphere_list *list = &world->spheres.list;
  size_t near = 0, found = 0;
  for (size_t i = 0; i < COUNT; i += 7) /* a sample */
    for (size_t j = 0; j < COUNT; j++) {
      const double reach =
          world->bodies.particle[i]->point_radii[0] + world->bodies.particle[j]->point_radii[0];
      if (i == j || !(vec3_distance(world->bodies.frame[i].position,
                                    world->bodies.frame[j].position) < reach))
        continue;
      near++;
      const uint32_t p = list->place_of[i], q = list->place_of[j], a = p < q ? p : q,
                     b = p < q ? q : p;
      size_t times = 0;
      for (uint32_t k = list->begin[a]; k < list->begin[a + 1]; k++)
        times += list->pairs.items[k].b == b;
      found += times;
    }
  assert_true(near > 100);
  assert_int_equal(near, found);
  scree_world_free(world);
}

/* Nearly at rest in a closed box, which presses them together. */
static scree_world *settled_world(scree_law law, double rolling, double surface_energy) {
  scree_error error;
  scree_world_options o = scree_default_world_options();
  scree_material material = soft();
  o.law = law;
  material.friction = 0.1; /* so that some slip */
  material.rolling_friction = rolling;
  material.surface_energy = surface_energy;
  scree_world *world = fill_world(&o, &material, 0.3, 0.975 * radius);
  for (int side = 0; side < 6; side++) {
    scree_wall wall = {.kind = SCREE_WALL_PLANE};
    const double middle = 0.5 * 1.98 * radius * (SIDE - 1), sign = side % 2 ? 1 : -1;
    wall.axis[side / 2] = -sign;
    wall.position[side / 2] = middle + sign * (middle + 0.98 * radius);
    CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  }
  return world;
}

/* After so many steps, one of all pairs by fours, and of each of the four alone; how many were left
 * of those that touch. */
static size_t same_in_lanes(scree_world *world, size_t steps, const char *name) {
  scree_error error;
  scree_spheres *s = &world->spheres;
  step(world, steps);
  CHECK_OK(scree_broad_update(world, &error), error);
  for (size_t i = 0; i < s->list.count; i++) scree_spheres_load(world, i);
  scree_sphere_lanes four = {.law = {scree_none, scree_none, scree_none, scree_none}};
  size_t taken = 0, left = 0;
  for (size_t k = 0; k + 3 < s->list.pairs.count; k += 4) {
    const uint32_t pairs[] = {(uint32_t)k, (uint32_t)k + 1, (uint32_t)k + 2, (uint32_t)k + 3};
    scree_sphere_contact before[4], after[4], *at[4];
    for (int l = 0; l < 4; l++) {
      const uint32_t contact = s->list.pairs.items[k + (size_t)l].contact;
      at[l] =
          contact == scree_none ? NULL : &s->list.contacts.items[contact & ~scree_sphere_touches];
      if (at[l]) before[l] = *at[l];
    }
    const unsigned served = scree_sphere_lanes_step(world, pairs, &four);
    for (int l = 0; l < 4; l++) {
      left += !(served >> l & 1) && scree_spheres_touch(&s->list.pairs.items[k + (size_t)l]);
      if (!(served >> l & 1)) {
        if (at[l]) assert_memory_equal(at[l], &before[l], sizeof before[l]);
        continue;
      }
      taken++;
      after[l] = *at[l];
      *at[l] = before[l];
      scree_sphere_result alone;
      assert_true(scree_sphere_pair_step(world, k + (size_t)l, &alone));
      assert_memory_equal(at[l], &after[l], sizeof after[l]);
      assert_memory_equal(&alone.on_a, &four.on_a[l], sizeof alone.on_a);
      assert_memory_equal(&alone.on_b, &four.on_b[l], sizeof alone.on_b);
      assert_true(alone.pair.contact.overlap == four.overlap[l]);
      assert_true(!alone.work.too_fast && !alone.work.pressed && alone.work.missing == 0);
    }
  }
  print_message("%s: %zu in lanes, %zu left\n", name, taken, left);
  assert_true(taken > COUNT / 2);
  return left;
}

static void in_lanes(void **state) {
  (void)state;
  static const struct {
    const char *name;
    scree_law law;
    double rolling, surface_energy;
  } cases[] = {{"linear", SCREE_LAW_LINEAR, 0.1, 0},
               {"without rolling", SCREE_LAW_LINEAR, 0, 0},
               {"cohesive", SCREE_LAW_LINEAR, 0.1, 0.01},
               {"Hertz", SCREE_LAW_HERTZ, 0.1, 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    scree_world *world = settled_world(cases[i].law, cases[i].rolling, cases[i].surface_energy);
    if (scree_sphere_lanes_serve(world)) {
      same_in_lanes(world, 20, cases[i].name);
      same_in_lanes(world, 400, cases[i].name);
    }
    scree_world_free(world);
  }
  scree_world *world = make_world();
  if (scree_sphere_lanes_serve(world)) assert_true(same_in_lanes(world, 40, "in motion") > 100);
  scree_world_free(world);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_bits),
      cmocka_unit_test(gathered),
      cmocka_unit_test(in_lanes),
      cmocka_unit_test(all_listed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
