/* What the child process that reads COLLADA and the like hands back, as one that a hostile file has
 * taken over would. */
#include "fuzz/reading.h"
#include "mesh/io/read.h"

enum { MOST_BYTES = 1 << 16 };

/* fitting: with a count that fits the bytes. */
static void take(scree_import_format format, bool fitting, const uint8_t *data, size_t size) {
  static _Alignas(double) char answer[MOST_BYTES];
  scree_read_options options = scree_default_read_options();
  scree_scan scan = {0};
  scree_error error = {0};
  size_t used = scree_memory_used();
  memcpy(answer, data, size);
  if (fitting && size >= sizeof(scree_import_answer)) {
    uint64_t count = (size - sizeof(scree_import_answer)) / (9 * sizeof(double));
    size = sizeof(scree_import_answer) + (size_t)count * 9 * sizeof(double);
    memcpy(answer, &count, sizeof count);
  }
  scree_reading r = {.name = "fuzz",
                     .bytes = data,
                     .byte_count = size,
                     .whole_count = size,
                     .options = &options,
                     .unit_m = options.unit_m,
                     .scan = &scan,
                     .error = &error};
  scree_reset_memory_peak();
  scree_status status = scree_import_take(&r, format, answer, size);
  FUZZ_CHECK(scree_memory_peak() - used <= FUZZ_BYTES_PER_BYTE * size + FUZZ_LEAST_BYTES);
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK) {
    fuzz_check_mesh(&scan.mesh);
    FUZZ_CHECK(strlen(scan.format) < sizeof scan.format);
  } else {
    FUZZ_CHECK(status == SCREE_BAD_FILE || status == SCREE_LIMIT);
    FUZZ_CHECK(error.message[0]);
    for (const char *c = error.message; *c; c++) FUZZ_CHECK(*c >= ' ' && *c <= '~');
  }
  scree_scan_free(&scan);
  FUZZ_CHECK(scree_memory_used() == used);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size < 1 || size > MOST_BYTES) return 0;
  scree_set_threads(1);
  take((scree_import_format)(data[0] / 2 % (SCREE_IMPORT_3DS + 1)), data[0] % 2 == 0, data + 1,
       size - 1);
  return 0;
}
