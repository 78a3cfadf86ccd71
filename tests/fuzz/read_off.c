/* Reading of whatever calls itself OFF. */
#include "fuzz/reading.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_parse(data, size, 0);
  return 0;
}
