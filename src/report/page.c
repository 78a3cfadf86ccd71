/* The report as one page: the fixed part, the results of the folders as one JSON text, the levels'
 * files as base64, the script. It asks nothing of any network, and its content security policy
 * allows nothing but the one script and the one style sheet that it names by their hashes. Texts
 * from files are escaped where they stand: in the JSON `<` as \u003c, which its strings alone can
 * hold, so that no name ends the script element it is in; the script shows texts as text only.
 * web/ holds the page's sources; page.inc is what web/build.mjs makes of them. */
#include "base/alloc.h"
#include "base/file.h"
#include "report/json.h"
#include "report/json_check.h"
#include "report/levels.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "report/page.inc"

enum { MOST_RESULT_BYTES = 64 << 20, PATH_BYTES = 4096 };
static const char ending[] = ".levels";

typedef struct page {
  FILE *stream;
  scree_error *error;
  size_t levels_count; /* so far, of all folders */
} page;

static void put_all(FILE *stream, const char *const *texts) {
  for (; *texts; texts++) fputs(*texts, stream);
}

static void put_html(FILE *stream, const char *text) {
  for (; *text; text++) {
    if (strchr("<>&\"'", *text))
      fprintf(stream, "&#%d;", *text);
    else
      putc(*text, stream);
  }
}

static void put_json(FILE *stream, const char *text) {
  for (; *text; text++) {
    if (*text == '<')
      fputs("\\u003c", stream);
    else
      putc(*text, stream);
  }
}

static void put_base64(FILE *stream, const char *bytes, size_t count) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const unsigned char *b = (const unsigned char *)bytes;
  for (size_t i = 0; i < count; i += 3) {
    size_t left = count - i;
    uint32_t word = (uint32_t)b[i] << 16;
    if (left > 1) word |= (uint32_t)b[i + 1] << 8;
    if (left > 2) word |= b[i + 2];
    char text[4] = {digits[word >> 18], digits[word >> 12 & 63],
                    left > 1 ? digits[word >> 6 & 63] : '=', left > 2 ? digits[word & 63] : '='};
    fwrite(text, 1, sizeof text, stream);
  }
}

/* ---- a folder's files ---- */

/* Reads folder/name, whose path is left in `path`; *bytes is NULL where there is none. */
static scree_status read_part(const char *folder, const char *name, char path[PATH_BYTES],
                              char **bytes, size_t *size, scree_error *error) {
  struct stat info;
  int length = snprintf(path, PATH_BYTES, "%s/%s", folder, name);
  if (length < 0 || length >= PATH_BYTES)
    return scree_fail(error, SCREE_LIMIT, "%.200s: the path is too long", folder);
  *bytes = NULL;
  if (stat(path, &info) != 0) return SCREE_OK;
  return scree_file_read(path, MOST_RESULT_BYTES, bytes, size, error);
}

/* One JSON file as a member of the page's data. */
static scree_status put_member(page *p, const char *folder, const char *name, const char *key,
                               bool *found) {
  char *bytes, path[PATH_BYTES];
  size_t size;
  scree_status status = read_part(folder, name, path, &bytes, &size, p->error);
  if (status != SCREE_OK || !bytes) return status;
  status = scree_json_check(bytes, size, path, p->error);
  if (status == SCREE_OK) {
    fprintf(p->stream, ",\n\"%s\": ", key);
    put_json(p->stream, bytes);
    if (found) *found = true;
  }
  scree_free(bytes);
  return status;
}

/* ---- levels ---- */

typedef struct name_list {
  char **items;
  size_t count;
} name_list;

static void free_names(name_list *names) {
  for (size_t i = 0; i < names->count; i++) scree_free(names->items[i]);
  scree_free(names->items);
}

static int by_name(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool is_levels(const char *name) {
  size_t length = strlen(name);
  return length >= sizeof ending && !strcmp(name + length - (sizeof ending - 1), ending);
}

/* The files of levels in a folder, sorted; none where the folder has none. */
static scree_status list_levels(const char *folder, name_list *names, scree_error *error) {
  char path[PATH_BYTES];
  int length = snprintf(path, sizeof path, "%s/levels", folder);
  DIR *directory = length > 0 && length < PATH_BYTES ? opendir(path) : NULL;
  *names = (name_list){0};
  if (!directory) return SCREE_OK;
  size_t capacity = 0;
  scree_status status = SCREE_OK;
  for (struct dirent *entry; status == SCREE_OK && (entry = readdir(directory));) {
    if (!is_levels(entry->d_name)) continue;
    if (names->count == capacity) {
      void *moved = scree_resize(names->items, capacity = 2 * capacity + 16, sizeof(char *));
      if (moved) names->items = moved;
      if (!moved) status = scree_fail_memory(error, capacity * sizeof(char *), "names");
    }
    char *copy = status == SCREE_OK ? scree_strdup(entry->d_name) : NULL;
    if (copy) names->items[names->count++] = copy;
    if (status == SCREE_OK && !copy) status = scree_fail_memory(error, 256, "a name");
  }
  closedir(directory);
  if (status == SCREE_OK && names->count > 1)
    qsort(names->items, names->count, sizeof *names->items, by_name);
  return status;
}

/* What the page calls each file of levels: [name, id]. */
static void put_levels_index(page *p, const name_list *names) {
  fputs(",\n\"levels\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_array(&json, NULL);
  for (size_t i = 0; i < names->count; i++) {
    char id[40];
    snprintf(id, sizeof id, "levels-%zu", p->levels_count + i);
    names->items[i][strlen(names->items[i]) - (sizeof ending - 1)] = 0;
    scree_json_row_array(&json, NULL);
    scree_json_text(&json, NULL, names->items[i]);
    scree_json_text(&json, NULL, id);
    scree_json_end(&json);
  }
  scree_json_end(&json);
  p->levels_count += names->count;
}

/* The same files, in the same order as they were counted. */
static scree_status put_levels(page *p, const char *folder) {
  name_list names;
  scree_status status = list_levels(folder, &names, p->error);
  for (size_t i = 0; i < names.count && status == SCREE_OK; i++) {
    char *bytes, name[300], path[PATH_BYTES];
    size_t size;
    snprintf(name, sizeof name, "levels/%.255s", names.items[i]);
    status = read_part(folder, name, path, &bytes, &size, p->error);
    if (status != SCREE_OK) break;
    if (!bytes)
      status = scree_fail(p->error, SCREE_IO, "%s: is no longer there", path);
    else
      status = scree_levels_check(bytes, size, path, p->error);
    if (status == SCREE_OK) {
      fprintf(p->stream, "<script type=\"text/plain\" id=\"levels-%zu\">", p->levels_count++);
      put_base64(p->stream, bytes, size);
      fputs("</script>\n", p->stream);
    }
    scree_free(bytes);
  }
  free_names(&names);
  return status;
}

/* ---- the page ---- */

static scree_status put_folder(page *p, const char *folder) {
  bool found = false;
  struct stat info;
  if (stat(folder, &info) != 0 || !S_ISDIR(info.st_mode))
    return scree_fail(p->error, SCREE_IO, "%s: is no folder", folder);
  name_list names;
  fputs("{\n\"folder\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_text(&json, NULL, folder);
  scree_status status = put_member(p, folder, "choice.json", "choice", &found);
  if (status == SCREE_OK) status = put_member(p, folder, "study.json", "study", &found);
  if (status == SCREE_OK) status = put_member(p, folder, "provenance.json", "provenance", NULL);
  if (status == SCREE_OK && !found)
    status = scree_fail(
        p->error, SCREE_BAD_FILE,
        "%s: holds no results: neither choice.json of `scree choose -o` nor study.json of "
        "`scree study`",
        folder);
  if (status != SCREE_OK) return status;
  status = list_levels(folder, &names, p->error);
  if (status == SCREE_OK) put_levels_index(p, &names);
  free_names(&names);
  fputs("}", p->stream);
  return status;
}

static scree_status put_summaries(page *p, const char *const *folders, size_t folder_count) {
  for (size_t i = 0; i < folder_count; i++) {
    char *text, path[PATH_BYTES];
    size_t size;
    scree_status status = read_part(folders[i], "choice.txt", path, &text, &size, p->error);
    if (status != SCREE_OK) return status;
    if (text) put_html(p->stream, text);
    scree_free(text);
  }
  return SCREE_OK;
}

static scree_status put_page(page *p, const char *const *folders, size_t folder_count) {
  put_all(p->stream, page_top);
  scree_status status = put_summaries(p, folders, folder_count);
  put_all(p->stream, page_middle);
  fputs("<script type=\"application/json\" id=\"data\">{\"version\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_text(&json, NULL, scree_version());
  fputs(",\n\"folders\": [", p->stream);
  for (size_t i = 0; i < folder_count && status == SCREE_OK; i++) {
    if (i > 0) fputs(",\n", p->stream);
    status = put_folder(p, folders[i]);
  }
  fputs("]}</script>\n", p->stream);
  p->levels_count = 0;
  for (size_t i = 0; i < folder_count && status == SCREE_OK; i++)
    status = put_levels(p, folders[i]);
  fputs("<script type=\"module\">", p->stream);
  put_all(p->stream, page_script);
  fputs("</script>\n</body>\n</html>\n", p->stream);
  return status;
}

scree_status scree_page_write(const char *const *folders, size_t folder_count, const char *path,
                              bool overwrite, scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status != SCREE_OK) return status;
  page p = {.stream = output.stream, .error = error};
  status = put_page(&p, folders, folder_count);
  if (status == SCREE_OK) return scree_output_commit(&output, error);
  scree_output_discard(&output);
  return status;
}
