/* Records of runs: what is read, written and read again is the same; what is refused is refused in
 * a sentence. */
#define _GNU_SOURCE /* memfd_create */
#include "study/record.h"
#include "base/file.h"
#include "fuzz/files.h"

#include <string.h>

static char written[64];

static void remove_written(void) {
  unlink(written);
}

static void write_and_read(const scree_study_record *record, char **bytes, size_t *count,
                           scree_study_record *again) {
  scree_error error;
  FUZZ_CHECK(scree_study_record_write(record, written, &error) == SCREE_OK);
  FUZZ_CHECK(scree_study_record_read(written, again, &error) == SCREE_OK);
  FUZZ_CHECK(scree_file_read(written, 0, bytes, count, &error) == SCREE_OK);
}

/* A record says the same once it has been written by us: texts are cut and made printable then. */
static void check_round(const scree_study_record *record) {
  scree_study_record once, twice;
  char *first, *second;
  size_t first_count, second_count;
  write_and_read(record, &first, &first_count, &once);
  write_and_read(&once, &second, &second_count, &twice);
  FUZZ_CHECK(once.series_count == record->series_count);
  FUZZ_CHECK(first_count == second_count && memcmp(first, second, first_count) == 0);
  scree_free(first);
  scree_free(second);
  scree_study_record_free(&once);
  scree_study_record_free(&twice);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static bool started;
  scree_study_record record;
  scree_error error = {0};
  size_t used = scree_memory_used();
  char path[64];
  if (!started) {
    fuzz_place(written, false);
    atexit(remove_written);
    started = true;
  }
  int fd = fuzz_file(data, size, path);
  scree_status status = scree_study_record_read(path, &record, &error);
  close(fd);
  FUZZ_CHECK(status == SCREE_OK || status == SCREE_BAD_FILE);
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK) {
    check_round(&record);
    scree_study_record_free(&record);
  } else {
    FUZZ_CHECK(error.message[0] && !strchr(error.message, '\n'));
  }
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
