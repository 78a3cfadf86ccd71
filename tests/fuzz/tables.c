/* Tables as text, by all who read them: rows, bodies and paths, curves; by the first byte. */
#define _GNU_SOURCE /* memfd_create */
#include "base/curve_file.h"
#include "fuzz/files.h"
#include "scene/named_table.h"
#include "scree.h"

#include <math.h>
#include <string.h>

enum { MOST = 1 << 16 };
static char text[MOST + 1];

/* Cells lie in the text, one behind the other. */
static scree_status read_rows(size_t size, scree_error *error) {
  scree_text_rows rows;
  scree_status status = scree_rows_open(&rows, "table", text, size, error);
  bool there = status == SCREE_OK;
  while (there && status == SCREE_OK) {
    status = scree_rows_next(&rows, &there);
    if (status != SCREE_OK || !there || rows.comment) continue;
    const char *last = text;
    FUZZ_CHECK(rows.count <= SCREE_MOST_CELLS);
    for (size_t i = 0; i < rows.count; i++) {
      FUZZ_CHECK(rows.cells[i] >= last && rows.cells[i] + strlen(rows.cells[i]) <= text + size);
      last = rows.cells[i] + strlen(rows.cells[i]);
    }
    if (rows.count) scree_cell_unit(rows.cells[rows.count - 1]);
  }
  return status;
}

static scree_status read_named(size_t size, scree_error *error) {
  static const scree_named_column known[] = {{"x", "m"}, {"t", "s"}, {"q", ""}, {"shape", NULL}};
  scree_named_table t;
  scree_status status = scree_named_open(&t, "table", text, size, known, 4, error);
  bool there = status == SCREE_OK;
  while (there && status == SCREE_OK) {
    double values[4] = {0};
    const char *words[4] = {NULL};
    status = scree_named_row(&t, values, words, &there);
    for (int k = 0; status == SCREE_OK && k < 3; k++) FUZZ_CHECK(!isnan(values[k]));
  }
  return status;
}

static scree_status read_curve(const uint8_t *data, size_t size, scree_error *error) {
  scree_curve_file curve = {0};
  char path[64];
  int fd = fuzz_file(data, size, path);
  scree_status status = scree_curve_file_read(path, &curve, error);
  close(fd);
  for (size_t i = 1; status == SCREE_OK && i < curve.count; i++)
    FUZZ_CHECK(curve.x[i] > curve.x[i - 1] && isfinite(curve.y[i]));
  scree_curve_file_free(&curve);
  return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  scree_error error = {0};
  size_t used = scree_memory_used();
  if (size < 1 || size > MOST) return 0;
  int which = data[0] % 3;
  memcpy(text, data + 1, size - 1);
  text[size - 1] = 0;
  scree_status status = which == 0   ? read_rows(size - 1, &error)
                        : which == 1 ? read_named(size - 1, &error)
                                     : read_curve(data + 1, size - 1, &error);
  FUZZ_CHECK(status == SCREE_OK || (error.message[0] && !strchr(error.message, '\n')));
  fuzz_taken += status == SCREE_OK && size > 8;
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
