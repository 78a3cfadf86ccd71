/* Feeds files, and all files of folders, to the fuzz target it is linked with. */
#define _DEFAULT_SOURCE
#include "fuzz/fuzz.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static size_t replayed;

static int replay_file(const char *path) {
  FILE *stream = fopen(path, "rb");
  if (!stream) {
    perror(path);
    return 1;
  }
  fseek(stream, 0, SEEK_END);
  long size = ftell(stream);
  rewind(stream);
  /* exactly the size, so that the address sanitizer sees the first byte too many */
  uint8_t *data = malloc(size > 0 ? (size_t)size : 1);
  if (!data || fread(data, 1, (size_t)size, stream) != (size_t)size) {
    fprintf(stderr, "%s: cannot read\n", path);
    free(data);
    fclose(stream);
    return 1;
  }
  fclose(stream);
  LLVMFuzzerTestOneInput(data, (size_t)size);
  free(data);
  replayed++;
  return 0;
}

static int replay_folder(const char *path) {
  DIR *folder = opendir(path);
  if (!folder) {
    perror(path);
    return 1;
  }
  int failed = 0;
  for (struct dirent *entry; (entry = readdir(folder));) {
    char file[4096];
    if (entry->d_name[0] == '.') continue;
    snprintf(file, sizeof file, "%s/%s", path, entry->d_name);
    failed |= replay_file(file);
  }
  closedir(folder);
  return failed;
}

int main(int argument_count, char **arguments) {
  int failed = 0;
  for (int i = 1; i < argument_count; i++) {
    struct stat info;
    bool is_folder = stat(arguments[i], &info) == 0 && S_ISDIR(info.st_mode);
    failed |= is_folder ? replay_folder(arguments[i]) : replay_file(arguments[i]);
  }
  printf("%zu inputs replayed, %zu of them taken for whole\n", replayed, fuzz_taken);
  return failed || fuzz_taken == 0;
}
