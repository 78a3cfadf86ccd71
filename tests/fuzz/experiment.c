/* Experiment files: YAML as a tree, then as an experiment. What is accepted, printed and read again
 * is the same; what is refused leaves the experiment as it was. */
#define _GNU_SOURCE /* memfd_create */
#include "base/yaml.h"
#include "fuzz/files.h"

#include <stdio.h>
#include <string.h>

static char *print(const scree_experiment *experiment, size_t *size) {
  char *text = NULL;
  FILE *stream = open_memstream(&text, size);
  FUZZ_CHECK(stream);
  scree_experiment_print(experiment, stream);
  fclose(stream);
  return text;
}

static void read_again(const scree_experiment *experiment) {
  scree_experiment again;
  scree_error error;
  size_t size, size_again;
  char path[64], *text = print(experiment, &size);
  int fd = fuzz_file(text, size, path);
  FUZZ_CHECK(scree_experiment_preset("demo", &again, &error) == SCREE_OK);
  FUZZ_CHECK(scree_experiment_read(path, &again, &error) == SCREE_OK);
  close(fd);
  char *text_again = print(&again, &size_again);
  FUZZ_CHECK(size == size_again && memcmp(text, text_again, size) == 0);
  free(text);
  free(text_again);
  scree_experiment_free(&again);
}

static void refused(const scree_experiment *experiment, const scree_error *error) {
  scree_experiment untouched;
  scree_error other;
  size_t size, size_untouched;
  FUZZ_CHECK(error->message[0] && !strchr(error->message, '\n'));
  FUZZ_CHECK(scree_experiment_preset("paper", &untouched, &other) == SCREE_OK);
  char *text = print(experiment, &size), *same = print(&untouched, &size_untouched);
  FUZZ_CHECK(size == size_untouched && memcmp(text, same, size) == 0);
  free(text);
  free(same);
  scree_experiment_free(&untouched);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  scree_experiment experiment;
  scree_error error;
  scree_yaml root;
  size_t used = scree_memory_used();
  char path[64];
  scree_status parsed = scree_yaml_parse((const char *)data, size, "fuzz", &root, &error);
  FUZZ_CHECK(parsed == SCREE_OK || parsed == SCREE_BAD_FILE);
  if (parsed == SCREE_OK) scree_yaml_free(&root);
  int fd = fuzz_file(data, size, path);
  FUZZ_CHECK(scree_experiment_preset("paper", &experiment, &error) == SCREE_OK);
  scree_status status = scree_experiment_read(path, &experiment, &error);
  close(fd);
  /* values that do not go together are a bad argument */
  FUZZ_CHECK(status == SCREE_OK || status == SCREE_BAD_FILE || status == SCREE_BAD_ARGUMENT);
  FUZZ_CHECK(parsed == SCREE_OK || status == SCREE_BAD_FILE);
  fuzz_taken += status == SCREE_OK;
  if (status == SCREE_OK)
    read_again(&experiment);
  else
    refused(&experiment, &error);
  scree_experiment_free(&experiment);
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
