/* Checkpoints: the same bits after loading, refusal of everything that is not whole. */
#include "world/state/save.h"
#include "base/alloc.h"
#include "base/file.h"
#include "base/rng.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/mixed.h"
#include "support/threads.h"
#include "world/step/checkpoint.h"

#include <unistd.h>

typedef struct packed {
  unsigned char *bytes;
  size_t count;
} packed;

static void step(scree_world *world, size_t count) {
  scree_error error;
  CHECK_OK(scree_world_step(world, count, &error), error);
}

static packed pack(const scree_world *world) {
  scree_error error;
  packed p = {0};
  CHECK_OK(scree_world_pack(world, true, &p.bytes, &p.count, &error), error);
  return p;
}

static scree_world *unpack(packed p) {
  scree_error error;
  scree_world *world = NULL;
  CHECK_OK(scree_world_unpack(p.bytes, p.count, "memory", &world, &error), error);
  return world;
}

static void assert_same(const scree_world *a, const scree_world *b) {
  scree_checksum x = scree_world_hash(a), y = scree_world_hash(b);
  assert_true(x.high == y.high && x.low == y.low);
  scree_observation o, p;
  memset(&o, 0, sizeof o);
  memset(&p, 0, sizeof p);
  scree_world_observe(a, &o);
  scree_world_observe(b, &p);
  assert_memory_equal(&o, &p, sizeof o);
  /* what a world no longer needs is not to be seen in its checkpoint either */
  packed bytes_a = pack(a), bytes_b = pack(b);
  assert_int_equal(bytes_a.count, bytes_b.count);
  assert_memory_equal(bytes_a.bytes, bytes_b.bytes, bytes_a.count);
  scree_free(bytes_a.bytes);
  scree_free(bytes_b.bytes);
}

/* Saved at many moments, in the air, in impact and piled up; what was loaded packs to the same
 * bytes and goes on with the same bits, on another number of threads. */
static void continues(scree_law law, int rounds) {
  scree_world *world = mixed_world(law);
  for (int round = 0; round < rounds; round++) {
    packed p = pack(world);
    scree_world *loaded = unpack(p);
    packed again = pack(loaded);
    assert_int_equal(p.count, again.count);
    assert_memory_equal(p.bytes, again.bytes, p.count);
    use_threads(1 + round % 2);
    step(loaded, 150);
    use_threads(0);
    step(world, 150);
    assert_same(world, loaded);
    scree_world_free(loaded);
    scree_free(p.bytes);
    scree_free(again.bytes);
  }
  scree_observation o;
  scree_world_observe(world, &o);
  assert_true(o.contact_count > 2);
  scree_world_free(world);
}

static void continues_linear(void **state) {
  (void)state;
  continues(SCREE_LAW_LINEAR, 12);
}

static void continues_hysteretic(void **state) {
  (void)state;
  continues(SCREE_LAW_HYSTERETIC, 6);
}

static void continues_hertz(void **state) {
  (void)state;
  continues(SCREE_LAW_HERTZ, 6);
}

/* Changes made between save and load's continuation: both worlds take them alike. */
static void takes_changes(void **state) {
  (void)state;
  scree_error error;
  scree_world *worlds[2] = {mixed_world(SCREE_LAW_LINEAR)};
  step(worlds[0], 500);
  scree_world_remove_body(worlds[0], 3);
  packed p = pack(worlds[0]);
  worlds[1] = unpack(p);
  const double up[3] = {0, 0, 0.3}, still[3] = {0};
  for (int i = 0; i < 2; i++) {
    scree_body body = scree_default_body();
    body.position[2] = 0.4;
    scree_particle *particle = scree_world_body_particle(worlds[i], 5);
    CHECK_OK(scree_world_add_body(worlds[i], particle, 1, &body, NULL, &error), error);
    CHECK_OK(scree_world_set_wall_velocity(worlds[i], 1, up, still, &error), error);
    step(worlds[i], 500);
  }
  assert_same(worlds[0], worlds[1]);
  scree_world_free(worlds[0]);
  scree_world_free(worlds[1]);
  scree_free(p.bytes);
}

/* Walls in the midst of their motions, a belt, and a body that is pushed. */
static void motions_go_on(void **state) {
  (void)state;
  static const double table[6] = {0, 0, 0.1, 0.2, 0.5, -0.1};
  scree_error error;
  scree_wall_motion motions[4];
  for (int i = 0; i < 4; i++) motions[i] = scree_default_wall_motion();
  motions[0].law = SCREE_MOTION_SPEEDS, motions[0].table = table, motions[0].row_count = 3;
  motions[1].law = SCREE_MOTION_SINE, motions[1].amplitude = 0.003, motions[1].frequency = 20;
  motions[2].turns = true, motions[2].speed = 1, motions[2].through[0] = 0.01;
  motions[3].law = SCREE_MOTION_CRANK, motions[3].amplitude = 0.001, motions[3].rod = 0.01;
  motions[3].radius = 0.02, motions[3].span[0] = 0.01, motions[3].start = 0.005;
  scree_world *world = mixed_world(SCREE_LAW_LINEAR);
  CHECK_OK(scree_world_set_wall_motion(world, 3, &motions[2], 1, &error), error);
  CHECK_OK(scree_world_set_wall_motion(world, 1, motions, 3, &error), error);
  CHECK_OK(scree_world_set_wall_motion(world, 2, motions + 3, 1, &error), error);
  CHECK_OK(scree_world_set_wall_motion(world, 0, &motions[1], 1, &error), error);
  CHECK_OK(scree_world_set_wall_motion(world, 1, motions, 2, &error), error);
  CHECK_OK(scree_world_set_wall_surface(world, 2, (double[3]){0, 0.3, 0}, (double[3]){0},
                                        (double[3]){0.2, 0, 0.1}, &error),
           error);
  CHECK_OK(scree_world_set_body_force(world, 2, (double[3]){0.1, 0, 0}, (double[3]){0}, &error),
           error);
  step(world, 700);
  packed p = pack(world);
  scree_world *loaded = unpack(p);
  for (int k = 0; k < 3; k++) {
    step(world, 300);
    step(loaded, 300);
    assert_same(world, loaded);
  }
  scree_observation o;
  scree_world_observe(world, &o);
  assert_true(o.wall_work != 0 && o.applied_work != 0);
  scree_world_free(world);
  scree_world_free(loaded);
  scree_free(p.bytes);
}

/* The pairs of a body that is gone serve others, and what they knew does not show: a loaded world
 * has new ones. */
static void pairs_taken_again_know_nothing(void **state) {
  (void)state;
  scree_error error;
  scree_world *worlds[2] = {mixed_world(SCREE_LAW_LINEAR)};
  step(worlds[0], 1500);
  for (size_t i = 0; i < 5; i++) scree_world_remove_body(worlds[0], i);
  step(worlds[0], 100);
  packed p = pack(worlds[0]);
  worlds[1] = unpack(p);
  for (int i = 0; i < 2; i++) {
    scree_body body = scree_default_body();
    body.position[2] = 0.3;
    for (int k = 0; k < 4; k++) {
      body.position[0] = 0.05 * (k - 1.5);
      CHECK_OK(scree_world_add_body(worlds[i], scree_world_body_particle(worlds[i], 5), 1, &body,
                                    NULL, &error),
               error);
    }
  }
  for (int k = 0; k < 20; k++) {
    for (int i = 0; i < 2; i++) step(worlds[i], 100);
    assert_same(worlds[0], worlds[1]);
  }
  scree_world_free(worlds[0]);
  scree_world_free(worlds[1]);
  scree_free(p.bytes);
}

/* A diverged world is saved too and says what it said. */
static void keeps_failure(void **state) {
  (void)state;
  scree_error error, again;
  scree_world *world = mixed_world(SCREE_LAW_LINEAR);
  step(world, 100);
  scree_body body;
  scree_world_get_body(world, 2, &body);
  body.velocity[0] = 1e4;
  CHECK_OK(scree_world_set_body(world, 2, &body, &error), error);
  assert_int_equal(scree_world_step(world, 1, &error), SCREE_DIVERGED);
  packed p = pack(world);
  scree_world *loaded = unpack(p);
  assert_int_equal(scree_world_step(loaded, 1, &again), SCREE_DIVERGED);
  assert_string_equal(error.message, again.message);
  scree_world_free(world);
  scree_world_free(loaded);
  scree_free(p.bytes);
}

static void refuse(const unsigned char *bytes, size_t count) {
  scree_error error = {0};
  scree_world *world = NULL;
  assert_int_equal(scree_world_unpack(bytes, count, "damaged", &world, &error), SCREE_BAD_FILE);
  assert_null(world);
  assert_non_null(strstr(error.message, "damaged"));
  assert_null(strchr(error.message, '\n'));
}

/* Every bit of the header, and bits all over the rest; every length up to the header and many
 * beyond it; bytes too many. Copies have their exact size, for the address sanitizer. */
static void refuses_damage(void **state) {
  (void)state;
  scree_world *world = mixed_world(SCREE_LAW_LINEAR);
  step(world, 600);
  packed p = pack(world);
  size_t stride = p.count / 600 + 1;
  for (size_t at = 0; at < p.count; at += at < 40 ? 1 : stride)
    for (int bit = 0; bit < 8; bit += at < 40 ? 1 : 5) {
      p.bytes[at] ^= (unsigned char)(1u << bit);
      refuse(p.bytes, p.count);
      p.bytes[at] ^= (unsigned char)(1u << bit);
    }
  for (size_t count = 0; count < p.count; count += count < 64 ? 1 : stride) {
    unsigned char *cut = scree_alloc(count, 1);
    if (count) memcpy(cut, p.bytes, count);
    refuse(cut, count);
    scree_free(cut);
  }
  unsigned char *more = scree_alloc(p.count + 1, 1);
  memcpy(more, p.bytes, p.count);
  more[p.count] = 0;
  refuse(more, p.count + 1);
  refuse((const unsigned char *)"solid cube\nfacet normal 0 0 1\nouter loop\n", 41);
  scree_free(more);
  scree_free(p.bytes);
  scree_world_free(world);
}

/* Whole files of other versions: said in a sentence. The checksum is that of what follows. */
static void refuses_other_versions(void **state) {
  (void)state;
  scree_world *world = mixed_world(SCREE_LAW_LINEAR);
  packed p = pack(world);
  const unsigned char own = p.bytes[8], others[] = {0, 3, 4, own + 1};
  for (size_t i = 0; i < sizeof others; i++) {
    scree_error error = {0};
    scree_world *loaded = NULL;
    char expected[96];
    p.bytes[8] = others[i];
    assert_int_equal(scree_world_unpack(p.bytes, p.count, "old", &loaded, &error), SCREE_BAD_FILE);
    assert_null(loaded);
    snprintf(expected, sizeof expected, "old: version %u; this program reads version %u", others[i],
             own);
    assert_string_equal(error.message, expected);
  }
  p.bytes[8] = own;
  scree_world_free(unpack(p));
  scree_free(p.bytes);
  scree_world_free(world);
}

/* The checksum made to fit again. */
static void seal(packed forged) {
  scree_checksum sum = scree_checksum_of(forged.bytes + 40, forged.count - 40);
  for (size_t k = 0; k < 8; k++) {
    forged.bytes[24 + k] = (unsigned char)(sum.high >> 8 * k);
    forged.bytes[32 + k] = (unsigned char)(sum.low >> 8 * k);
  }
}

/* A clump has finite centres and positive radii, whatever a file says with a checksum that fits. */
static void refuses_clumps_that_cannot_be(void **state) {
  (void)state;
  const double centres[6] = {0, 0, 0, 0.0123, 0, 0}, radii[2] = {0.01, 0.00712345678};
  const double wrong[] = {0, -0.007, NAN, INFINITY};
  scree_world_options options = scree_default_world_options();
  scree_world *world = NULL;
  scree_particle *clump = NULL;
  scree_error error;
  CHECK_OK(scree_particle_clump(centres, radii, 2, NULL, &clump, &error), error);
  double centre[3], radius;
  scree_particle_point(clump, 1, centre, &radius);
  CHECK_OK(scree_world_create(&options, &world, &error), error);
  const scree_material plastic = scree_default_material();
  CHECK_OK(scree_world_add_material(world, &plastic, NULL, &error), error);
  CHECK_OK(scree_world_add_body(world, clump, 0, NULL, NULL, &error), error);
  packed p = pack(world);
  uint64_t bits, here;
  size_t at = 40, found = 0;
  memcpy(&bits, &radius, sizeof bits);
  for (size_t k = 40; k + sizeof here <= p.count; k++) {
    memcpy(&here, p.bytes + k, sizeof here);
    if (here == bits) at = k, found++;
  }
  assert_int_equal(found, 1);
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    memcpy(p.bytes + at, &wrong[i], sizeof radius);
    seal(p);
    refuse(p.bytes, p.count);
    if (isfinite(wrong[i])) continue;
    memcpy(p.bytes + at, &radius, sizeof radius);
    memcpy(p.bytes + at - sizeof radius, &wrong[i], sizeof radius); /* its centre's z */
    seal(p);
    refuse(p.bytes, p.count);
    memcpy(p.bytes + at - sizeof radius, &centre[2], sizeof radius);
  }
  memcpy(p.bytes + at, &radius, sizeof radius);
  seal(p);
  scree_world_free(unpack(p));
  scree_free(p.bytes);
  scree_world_free(world);
  scree_particle_free(clump);
}

/* The length and the checksum made to fit again: forged files must be refused or give a world that
 * can be stepped and freed. */
static void survives_forgery(void **state) {
  (void)state;
  scree_world *world = mixed_world(SCREE_LAW_LINEAR);
  step(world, 600);
  packed p = pack(world);
  scree_rng rng = {.seed = 5};
  size_t refused = 0;
  for (int n = 0; n < 200; n++) {
    packed forged = {scree_alloc(p.count, 1), p.count};
    memcpy(forged.bytes, p.bytes, p.count);
    size_t at = 40 + scree_rng_below(&rng, n % 2 ? 400 : p.count - 40);
    for (size_t k = at; k < at + 4 && k < p.count; k++)
      forged.bytes[k] = n % 3 ? (unsigned char)scree_rng_below(&rng, 256) : 255;
    seal(forged);
    scree_error error;
    scree_world *loaded = NULL;
    if (scree_world_unpack(forged.bytes, forged.count, "forged", &loaded, &error) == SCREE_OK)
      scree_world_hash(loaded);
    else
      refused++;
    scree_world_free(loaded);
    scree_free(forged.bytes);
  }
  assert_true(refused > 20);
  scree_free(p.bytes);
  scree_world_free(world);
}

/* Through files: refused when there, replaced when asked, and nothing left beside it. */
static void files(void **state) {
  (void)state;
  scree_error error;
  const char *path = in_folder("w.scree");
  scree_world *world = mixed_world(SCREE_LAW_LINEAR), *loaded = NULL;
  assert_int_equal(scree_world_load(path, &loaded, &error), SCREE_IO);
  CHECK_OK(scree_world_save(world, path, false, &error), error);
  assert_int_equal(scree_world_save(world, path, false, &error), SCREE_EXISTS);
  step(world, 50);
  CHECK_OK(scree_world_save(world, path, true, &error), error);
  CHECK_OK(scree_world_load(path, &loaded, &error), error);
  assert_same(world, loaded);
  scree_world_free(world);
  scree_world_free(loaded);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(continues_linear),       cmocka_unit_test(continues_hysteretic),
      cmocka_unit_test(continues_hertz),        cmocka_unit_test(takes_changes),
      cmocka_unit_test(motions_go_on),          cmocka_unit_test(pairs_taken_again_know_nothing),
      cmocka_unit_test(keeps_failure),          cmocka_unit_test(refuses_damage),
      cmocka_unit_test(refuses_other_versions), cmocka_unit_test(refuses_clumps_that_cannot_be),
      cmocka_unit_test(survives_forgery),       cmocka_unit_test(files),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
