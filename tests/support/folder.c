#define _XOPEN_SOURCE 700 /* nftw */
#include "support/folder.h"

#include "support/check.h"

#include <ftw.h>

static char made[] = "/tmp/scree-test-XXXXXX";
static const char *folder = made;
static int partial_count;

int make_folder(void **state) {
  (void)state;
  const char *kept = getenv("SCREE_TEST_FOLDER");
  if (kept) folder = kept;
  return kept || mkdtemp(made) ? 0 : -1;
}

static int remove_one(const char *path, const struct stat *info, int type, struct FTW *place) {
  (void)info, (void)type, (void)place;
  if (strstr(path, ".part")) {
    print_error("%s is left behind\n", path);
    partial_count++;
  }
  return remove(path);
}

int remove_folder(void **state) {
  (void)state;
  if (folder != made) return 0;
  return nftw(folder, remove_one, 8, FTW_DEPTH | FTW_PHYS) || partial_count;
}

const char *in_folder(const char *name) {
  static char paths[8][400];
  static unsigned next;
  char *path = paths[next++ % 8];
  snprintf(path, sizeof paths[0], "%s/%s", folder, name);
  return path;
}

void put_in_folder(const char *name, const char *text) {
  FILE *file = fopen(in_folder(name), "wb");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

double sum_in_folder(const char *name, const char *begin, int column) {
  char line[400];
  FILE *file = fopen(in_folder(name), "r");
  assert_non_null(file);
  double sum = 0;
  assert_non_null(fgets(line, sizeof line, file));
  while (fgets(line, sizeof line, file)) {
    char *at = line;
    if (strncmp(line, begin, strlen(begin)) != 0) continue;
    for (int k = 0; k < column; k++) at = strchr(at, ',') + 1;
    sum += strtod(at, NULL);
  }
  fclose(file);
  return sum;
}
