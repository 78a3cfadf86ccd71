/* The report of `scree drop`: what the page is made of, and the page. */
#include "cli/drop.h"

#include "base/file.h"
#include "base/platform.h"
#include "report/provenance.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Name and source of each shape: a pour of another program may know neither. */
static void name_shapes(const drop_run *run, size_t count, const char **names, const char **sources,
                        char (*numbers)[32]) {
  for (size_t i = 0; i < count; i++) {
    snprintf(numbers[i], sizeof numbers[i], "shape %zu", i + 1);
    scree_pour_shape shape = scree_pour_get_shape(run->pour, i);
    names[i] = shape.name ? shape.name : numbers[i];
    sources[i] = shape.source;
  }
}

static scree_status write_json(const drop_run *run, const char *stopped_because,
                               scree_error *error) {
  char path[DROP_PATH_BYTES];
  size_t count = scree_pour_shape_count(run->pour);
  const char **texts = calloc(2 * count, sizeof *texts);
  char(*numbers)[32] = calloc(count, sizeof *numbers);
  if (!texts || !numbers) {
    free(texts);
    free(numbers);
    return drop_no_memory(error);
  }
  name_shapes(run, count, texts, texts + count, numbers);
  scree_status status = drop_path(run, "drop.json", path, error);
  scree_pour_entry entry = {.pour = run->pour,
                            .names = texts,
                            .sources = texts + count,
                            .stopped_because = stopped_because,
                            .command_line = run->call->command_line};
  if (status == SCREE_OK) status = scree_pour_json_write(&entry, path, true, error);
  free(texts);
  free(numbers);
  return status;
}

scree_status drop_write_report(drop_run *run, const char *stopped_because, const char *text,
                               scree_error *error) {
  char path[DROP_PATH_BYTES];
  scree_status status = drop_path(run, "last.world", path, error);
  if (status == SCREE_OK) status = scree_world_save(scree_pour_view(run->pour), path, true, error);
  if (status == SCREE_OK) status = write_json(run, stopped_because, error);
  if (status == SCREE_OK) status = drop_path(run, "drop.txt", path, error);
  if (status == SCREE_OK) status = scree_text_write(text, path, true, error);
  if (status == SCREE_OK) status = drop_path(run, "provenance.json", path, error);
  if (status == SCREE_OK)
    status = scree_provenance_write(&run->start, run->call->command_line, path, true, error);
  if (status == SCREE_OK) status = drop_path(run, "report.html", path, error);
  if (status == SCREE_OK) status = scree_page_write(&run->arguments->output, 1, path, true, error);
  return status;
}
