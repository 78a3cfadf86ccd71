/* Decimal numbers against strtod, bit for bit. */
#include "base/number.h"
#include "fuzz/fuzz.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char text[4096];
  if (size >= sizeof text) return 0;
  memcpy(text, data, size);
  text[size] = 0;
  double got = 0;
  const char *end = scree_number_parse(text, text + size, &got);
  if (!end) return 0;
  FUZZ_CHECK(end > text && end <= text + size);
  text[end - text] = 0;
  for (char *p = text; *p; p++)
    if (*p == 'd' || *p == 'D') *p = 'e'; /* Fortran's exponent is not strtod's */
  double expected = strtod(text, NULL);
  uint64_t got_bits, expected_bits;
  memcpy(&got_bits, &got, sizeof got);
  memcpy(&expected_bits, &expected, sizeof expected);
  FUZZ_CHECK(got_bits == expected_bits);
  fuzz_taken++;
  return 0;
}
