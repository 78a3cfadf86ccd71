/* The bits of a short run with some of everything: the same for 1, 2, 3 and 8 threads, for gcc and
 * clang, with and without optimisation. A change of the physics changes the constants: see that the
 * law tests hold, then copy the new ones from the message. */
#include "support/check.h"
#include "support/mixed.h"
#include "support/threads.h"

#include <inttypes.h>

static bool on_device = false;

static scree_checksum run(scree_law law, size_t steps, int threads) {
  scree_error error;
  scree_observation o;
  use_threads(threads);
  scree_world *world = mixed_world(law);
  CHECK_OK(scree_world_step(world, steps, &error), error);
  scree_world_observe(world, &o);
  assert_true(o.contact_count > 2); /* it is about contacts */
  scree_checksum hash = scree_world_hash(world);
  scree_world_free(world);
  use_threads(0);
  return hash;
}

static void check(scree_law law, size_t steps, uint64_t high, uint64_t low) {
  static const int threads[] = {1, 2, 3, 8};
  const size_t counts = on_device ? 1 : sizeof threads / sizeof *threads;
  for (size_t i = 0; i < counts; i++) {
    scree_checksum hash = run(law, steps, threads[i]);
    if (hash.high != high || hash.low != low)
      fail_msg("%d threads: 0x%016" PRIx64 ", 0x%016" PRIx64, threads[i], hash.high, hash.low);
  }
}

static void linear(void **state) {
  (void)state;
  check(SCREE_LAW_LINEAR, 1500, 0x39f1d90ef8aff269, 0x751cb125a9aa4ab1);
}

static void hysteretic(void **state) {
  (void)state;
  check(SCREE_LAW_HYSTERETIC, 1500, 0x9f985e7945b0ebcb, 0x67db16af6989d536);
}

static void hertz(void **state) {
  (void)state;
  check(SCREE_LAW_HERTZ, 1500, 0x9703d09825ecb8f5, 0xe8fb76ae543e3a67);
}

/* With a backend's name: the same bits there. */
int main(int argc, char **argv) {
  scree_error error;
  on_device = argc > 1;
  if (on_device) CHECK_OK(scree_set_backend(argv[1], &error), error);
  const struct CMUnitTest tests[] = {cmocka_unit_test(linear), cmocka_unit_test(hysteretic),
                                     cmocka_unit_test(hertz)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
