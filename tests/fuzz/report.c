/* A folder of results with one file of the fuzzer's making: JSON, a summary, a file of levels, a
 * picture, a pile. A page that is whole, and in which nothing from a file is markup or script, or a
 * refusal in a sentence and no page. */
#define _GNU_SOURCE /* memfd_create, memmem, nftw */
#include "base/alloc.h"
#include "base/file.h"
#include "fuzz/folder.h"

#include <string.h>
#include <sys/stat.h>

typedef enum kind { CHOICE, STUDY, HEAP, POUR, ORIGIN, TEXT, LEVELS, PICTURE, PILE, KINDS } kind;

static const char *const names[KINDS] = {"choice.json",     "study.json",      "result.json",
                                         "drop.json",       "provenance.json", "choice.txt",
                                         "levels/a.levels", "heap.png",        "last.scree"};
static char page[96];
static size_t least_scripts; /* of a page without parts */

static void put(kind which, const void *bytes, size_t size) {
  fuzz_write(fuzz_in_folder(names[which]), bytes, size);
}

static size_t occurrences(const char *text, size_t size, const char *word) {
  size_t count = 0, length = strlen(word);
  for (const char *end = text + size; (text = memmem(text, (size_t)(end - text), word, length));
       text += length)
    count++;
  return count;
}

/* The page as it was written, to be freed. */
static char *read_page(size_t *size) {
  char *bytes;
  scree_error error;
  FUZZ_CHECK(scree_file_read(page, 0, &bytes, size, &error) == SCREE_OK);
  return bytes;
}

static scree_status write_page(scree_error *error) {
  const char *const folders[] = {fuzz_folder};
  unlink(page);
  return scree_page_write(folders, 1, page, false, error);
}

static void start(void) {
  scree_error error = {0};
  size_t size;
  fuzz_make_folder();
  snprintf(page, sizeof page, "%s/page.html", fuzz_folder);
  FUZZ_CHECK(mkdir(fuzz_in_folder("levels"), 0700) == 0);
  put(CHOICE, "{}", 2);
  FUZZ_CHECK(write_page(&error) == SCREE_OK);
  char *bytes = read_page(&size);
  least_scripts = occurrences(bytes, size, "</script>");
  scree_free(bytes);
}

/* The results' JSON ends where its element does, and no file opens or closes another. */
static void look_at_page(void) {
  static const char opening[] = "id=\"data\">";
  size_t size;
  char *bytes = read_page(&size), *data = memmem(bytes, size, opening, sizeof opening - 1);
  FUZZ_CHECK(data);
  char *end = memchr(data, '<', size - (size_t)(data - bytes));
  FUZZ_CHECK(end && !strncmp(end, "</script>\n", 10));
  size_t scripts = occurrences(bytes, size, "</script>");
  FUZZ_CHECK(scripts >= least_scripts && scripts <= least_scripts + 1);
  FUZZ_CHECK(!strcmp(bytes + size - 8, "</html>\n"));
  scree_free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static bool started;
  scree_error error = {0};
  size_t used = scree_memory_used();
  if (size < 1) return 0;
  if (!started) start();
  started = true;
  kind which = data[0] % KINDS;
  for (int i = 0; i < KINDS; i++) unlink(fuzz_in_folder(names[i]));
  if (which == ORIGIN || which == TEXT || which == LEVELS) put(CHOICE, "{\"name\": \"a\"}", 13);
  if (which == PICTURE || which == PILE) put(HEAP, "{}", 2);
  put(which, data + 1, size - 1);
  scree_status status = write_page(&error);
  FUZZ_CHECK(status == SCREE_OK || (error.message[0] && !strchr(error.message, '\n')));
  FUZZ_CHECK(status != SCREE_OUT_OF_MEMORY);
  if (status == SCREE_OK)
    look_at_page();
  else
    FUZZ_CHECK(access(page, F_OK) != 0);
  fuzz_taken += status == SCREE_OK;
  FUZZ_CHECK(scree_memory_used() == used);
  return 0;
}
