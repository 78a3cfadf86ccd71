/* A fuzz target is one file here that defines LLVMFuzzerTestOneInput, and a folder corpus/NAME of
 * the inputs worth keeping; CMakeLists.txt finds both. Nothing else is to be registered.
 *
 * In an ordinary build a target is linked with replay.c, and its test feeds it the corpus, under
 * whatever sanitizers the build has. In the `fuzz` preset (clang) it is linked with libFuzzer, and
 * its test also looks for new inputs for a short fixed time. To fuzz longer:
 *
 *   cmake --preset fuzz && ninja -C build/fuzz
 *   mkdir -p /tmp/found && build/fuzz/bin/fuzz_read_ply -max_total_time=600 /tmp/found \
 *     tests/fuzz/corpus/read_ply
 *   build/fuzz/bin/fuzz_read_ply -merge=1 tests/fuzz/corpus/read_ply /tmp/found   keeps the new
 *
 * checkpoint and run also begin with what fuzz_seeds writes. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

/* Must answer 0; anything wrong is a crash, a sanitizer's report, or a failed FUZZ_CHECK. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* To be counted up with every input that is taken for whole. A corpus of which nothing is says
 * nothing of what lies behind the first checks: replay.c fails. */
__attribute__((weak)) size_t fuzz_taken;

/* A property that must hold for every input. */
#define FUZZ_CHECK(condition)                                                                      \
  do {                                                                                             \
    if (!(condition)) abort();                                                                     \
  } while (0)
