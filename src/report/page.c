/* The report as one page: the fixed part, the results of the folders as one JSON text, the levels'
 * files as base64, the script. It asks nothing of any network, and its content security policy
 * allows nothing but the one script and the one style sheet that it names by their hashes. Texts
 * from files are escaped where they stand: in the JSON `<` as \u003c, which its strings alone can
 * hold, so that no name ends the script element it is in; the script shows texts as text only.
 * web/ holds the page's sources; page.inc is what web/build.mjs makes of them. */
#include "base/alloc.h"
#include "base/array.h"
#include "base/file.h"
#include "report/json.h"
#include "report/json_check.h"
#include "report/levels.h"
#include "report/pile_pack.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "report/page.inc"

enum {
  MOST_RESULT_BYTES = 64 << 20,
  MOST_PICTURE_BYTES = 1300000, /* of heap.png: where there is no WebGL */
  LEAST_PILE_BYTES = 300000,    /* however many share the page */
  PATH_BYTES = 4096
};
static const char ending[] = ".levels";

/* What stands in the page as base64, behind the data that name it. */
typedef struct part {
  enum { LEVELS, PILE, PICTURE } kind;
  char *path; /* of a pile: its folder */
  char id[24];
} part;

typedef struct page {
  FILE *stream;
  scree_error *error;
  struct {
    part *items;
    size_t count, capacity;
  } parts;
  size_t used_bytes, pile_count; /* of levels and pictures; piles share what is left */
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

/* One JSON file as a member of the page's data. *text gets its content, to be freed, or NULL where
 * there is none; text may be NULL. */
static scree_status put_member(page *p, const char *folder, const char *name, const char *key,
                               char **text) {
  char *bytes, path[PATH_BYTES];
  size_t size;
  if (text) *text = NULL;
  scree_status status = read_part(folder, name, path, &bytes, &size, p->error);
  if (status != SCREE_OK || !bytes) return status;
  status = scree_json_check(bytes, size, path, p->error);
  if (status == SCREE_OK) {
    fprintf(p->stream, ",\n\"%s\": ", key);
    put_json(p->stream, bytes);
  }
  if (text && status == SCREE_OK)
    *text = bytes;
  else
    scree_free(bytes);
  return status;
}

/* ---- parts ---- */

/* Notes folder/name as a part where it exists; *added may be NULL. */
static scree_status add_part(page *p, int kind, const char *folder, const char *name,
                             const part **added) {
  char path[PATH_BYTES];
  struct stat info;
  if (added) *added = NULL;
  int length = snprintf(path, sizeof path, "%s/%s", folder, name);
  if (length >= PATH_BYTES || stat(path, &info) != 0) return SCREE_OK;
  if (kind == PICTURE && info.st_size > MOST_PICTURE_BYTES) return SCREE_OK;
  part made = {.kind = kind, .path = scree_strdup(kind == PILE ? folder : path)};
  snprintf(made.id, sizeof made.id, "part-%zu", p->parts.count);
  if (!made.path || !SCREE_PUSH(&p->parts, made)) {
    scree_free(made.path);
    return scree_fail_memory(p->error, PATH_BYTES, "the parts of a page");
  }
  if (kind == PILE)
    p->pile_count++;
  else
    p->used_bytes += (size_t)info.st_size;
  if (added) *added = &p->parts.items[p->parts.count - 1];
  return SCREE_OK;
}

/* A row [name, id] of the page's data. */
static void put_row(scree_json *json, const char *name, const part *added) {
  scree_json_row_array(json, NULL);
  scree_json_text(json, NULL, name);
  scree_json_text(json, NULL, added->id);
  scree_json_end(json);
}

typedef struct name_list {
  char **items;
  size_t count, capacity;
} name_list;

static void free_names(name_list *names) {
  for (size_t i = 0; i < names->count; i++) scree_free(names->items[i]);
  scree_free(names->items);
}

static int by_name(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* The names in a folder that do not begin with a point, sorted; none where there is no folder. */
static scree_status list_names(const char *folder, name_list *names, scree_error *error) {
  DIR *directory = opendir(folder);
  *names = (name_list){0};
  if (!directory) return SCREE_OK;
  scree_status status = SCREE_OK;
  for (struct dirent *entry; status == SCREE_OK && (entry = readdir(directory));) {
    if (entry->d_name[0] == '.') continue;
    char *copy = scree_strdup(entry->d_name);
    if (!copy || !SCREE_PUSH(names, copy)) {
      scree_free(copy);
      status = scree_fail_memory(error, 256, "a name");
    }
  }
  closedir(directory);
  if (names->count > 1) qsort(names->items, names->count, sizeof *names->items, by_name);
  return status;
}

static bool is_levels(const char *name) {
  size_t length = strlen(name);
  return length >= sizeof ending && !strcmp(name + length - (sizeof ending - 1), ending);
}

/* Whether the JSON text holds the name as a string: what an earlier choice left is no part. */
static bool holds_string(const char *json, const char *name) {
  char *quoted = NULL;
  size_t size;
  FILE *stream = open_memstream(&quoted, &size);
  if (!stream) return false;
  scree_json writer = scree_json_start(stream);
  scree_json_text(&writer, NULL, name);
  bool held = fclose(stream) == 0 && strstr(json, quoted);
  free(quoted);
  return held;
}

/* What the page calls each file of levels: [name, id]. */
static scree_status put_levels(page *p, const char *folder, const char *choice) {
  name_list names;
  char path[PATH_BYTES];
  snprintf(path, sizeof path, "%.4000s/levels", folder);
  scree_status status = list_names(path, &names, p->error);
  fputs(",\n\"levels\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_array(&json, NULL);
  for (size_t i = 0; i < names.count && status == SCREE_OK; i++) {
    const part *added;
    char *name = names.items[i], file[PATH_BYTES];
    if (!is_levels(name)) continue;
    snprintf(file, sizeof file, "levels/%s", name);
    name[strlen(name) - (sizeof ending - 1)] = 0;
    if (!holds_string(choice, name)) continue;
    status = add_part(p, LEVELS, folder, file, &added);
    if (added) put_row(&json, name, added);
  }
  scree_json_end(&json);
  free_names(&names);
  return status;
}

/* The next run that a study's points name as the pile to look at; NULL: no more. */
static const char *next_pile(const char *json, char key[64]) {
  static const char name[] = "\"pile\"";
  while ((json = strstr(json, name))) {
    json += sizeof name - 1;
    const char *at = json + strspn(json, " \t\n:");
    size_t length = *at == '"' ? strspn(at + 1, "0123456789abcdef") : 0;
    if (length == 0 || length >= 64 || at[1 + length] != '"') continue;
    memcpy(key, at + 1, length);
    key[length] = 0;
    return at;
  }
  return NULL;
}

/* Piles to look at: [run, id]. A heap's own has no run. */
static scree_status put_piles(page *p, const char *folder, const char *study) {
  char key[64], run[PATH_BYTES];
  const part *added;
  scree_status status = SCREE_OK;
  bool own = !study;
  fputs(",\n\"piles\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_array(&json, NULL);
  while (status == SCREE_OK && study && (study = next_pile(study, key))) {
    snprintf(run, sizeof run, "%.4000s/runs/%s", folder, key);
    status = add_part(p, PILE, run, "last.scree", &added);
    if (added) put_row(&json, key, added);
  }
  if (own) {
    status = add_part(p, PILE, folder, "last.scree", &added);
    if (added) put_row(&json, "", added);
  }
  scree_json_end(&json);
  return status;
}

static scree_status put_picture(page *p, const char *folder) {
  const part *added;
  scree_status status = add_part(p, PICTURE, folder, "heap.png", &added);
  if (added) fprintf(p->stream, ",\n\"picture\": \"%s\"", added->id);
  return status;
}

/* The part itself, where it stands in the page. */
static scree_status put_part(page *p, const part *it) {
  char *bytes = NULL;
  unsigned char *packed = NULL;
  size_t size = 0, all = SCREE_LEVELS_BYTES;
  scree_status status = SCREE_OK;
  if (it->kind == PILE) {
    size_t share = p->used_bytes < all ? (all - p->used_bytes) / p->pile_count : 0;
    status = scree_pile_pack(it->path, share > LEAST_PILE_BYTES ? share : LEAST_PILE_BYTES, &packed,
                             &size, p->error);
  } else {
    status = scree_file_read(it->path, MOST_RESULT_BYTES, &bytes, &size, p->error);
    if (status == SCREE_OK && it->kind == LEVELS)
      status = scree_levels_check(bytes, size, it->path, p->error);
  }
  if (status == SCREE_OK && !packed && !bytes)
    status = scree_fail(p->error, SCREE_IO, "%s: is no longer there", it->path);
  if (status == SCREE_OK && it->kind == PICTURE)
    fprintf(p->stream, "<img id=\"%s\" alt=\"The heap\" src=\"data:image/png;base64,", it->id);
  else if (status == SCREE_OK)
    fprintf(p->stream, "<script type=\"text/plain\" id=\"%s\">", it->id);
  if (status == SCREE_OK) {
    put_base64(p->stream, packed ? (const char *)packed : bytes, size);
    fputs(it->kind == PICTURE ? "\">\n" : "</script>\n", p->stream);
  }
  scree_free(packed);
  scree_free(bytes);
  return status;
}

/* ---- the page ---- */

static scree_status put_folder(page *p, const char *folder) {
  char *choice = NULL, *study = NULL, *heap = NULL;
  fputs("{\n\"folder\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_text(&json, NULL, folder);
  scree_status status = put_member(p, folder, "choice.json", "choice", &choice);
  if (status == SCREE_OK) status = put_member(p, folder, "study.json", "study", &study);
  if (status == SCREE_OK) status = put_member(p, folder, "result.json", "heap", &heap);
  if (status == SCREE_OK) status = put_member(p, folder, "provenance.json", "provenance", NULL);
  if (status == SCREE_OK && choice) status = put_levels(p, folder, choice);
  if (status == SCREE_OK && (study || heap)) status = put_piles(p, folder, study);
  if (status == SCREE_OK && heap) status = put_picture(p, folder);
  fputs("}", p->stream);
  scree_free(choice);
  scree_free(study);
  scree_free(heap);
  return status;
}

static bool has_file(const char *folder, const char *name) {
  char path[PATH_BYTES];
  struct stat info;
  int length = snprintf(path, sizeof path, "%s/%s", folder, name);
  return length < PATH_BYTES && stat(path, &info) == 0;
}

static bool has_results(const char *folder) {
  return has_file(folder, "choice.json") || has_file(folder, "study.json") ||
         has_file(folder, "result.json");
}

static scree_status add_name(page *p, name_list *folders, const char *path) {
  char *copy = scree_strdup(path);
  if (copy && SCREE_PUSH(folders, copy)) return SCREE_OK;
  scree_free(copy);
  return scree_fail_memory(p->error, strlen(path), "a path");
}

/* The folder itself, or those in it that have results: heaps at several levels. */
static scree_status find_results(page *p, const char *folder, name_list *found) {
  struct stat info;
  name_list names;
  size_t before = found->count;
  if (stat(folder, &info) != 0 || !S_ISDIR(info.st_mode))
    return scree_fail(p->error, SCREE_IO, "%s: is no folder", folder);
  if (has_results(folder)) return add_name(p, found, folder);
  scree_status status = list_names(folder, &names, p->error);
  for (size_t i = 0; i < names.count && status == SCREE_OK; i++) {
    char path[PATH_BYTES];
    int length = snprintf(path, sizeof path, "%s/%s", folder, names.items[i]);
    if (length < PATH_BYTES && has_results(path)) status = add_name(p, found, path);
  }
  free_names(&names);
  if (status == SCREE_OK && found->count == before)
    status = scree_fail(p->error, SCREE_BAD_FILE,
                        "%s: holds no results: neither choice.json of `scree choose -o` nor "
                        "result.json of `scree repose -o` nor study.json of `scree study`",
                        folder);
  return status;
}

/* What a reader without JavaScript sees. */
static scree_status put_summaries(page *p, const name_list *folders) {
  static const char *const names[] = {"choice.txt", "result.txt"};
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < 2 * folders->count && status == SCREE_OK; i++) {
    char *text, path[PATH_BYTES];
    size_t size;
    status = read_part(folders->items[i / 2], names[i % 2], path, &text, &size, p->error);
    if (status == SCREE_OK && text) put_html(p->stream, text);
    if (status == SCREE_OK) scree_free(text);
  }
  return status;
}

static scree_status put_page(page *p, const name_list *folders) {
  put_all(p->stream, page_top);
  scree_status status = put_summaries(p, folders);
  put_all(p->stream, page_middle);
  fputs("<script type=\"application/json\" id=\"data\">{\"version\": ", p->stream);
  scree_json json = scree_json_start(p->stream);
  scree_json_text(&json, NULL, scree_version());
  fputs(",\n\"folders\": [", p->stream);
  for (size_t i = 0; i < folders->count && status == SCREE_OK; i++) {
    if (i > 0) fputs(",\n", p->stream);
    status = put_folder(p, folders->items[i]);
  }
  fputs("]}</script>\n", p->stream);
  for (size_t i = 0; i < p->parts.count && status == SCREE_OK; i++)
    status = put_part(p, &p->parts.items[i]);
  fputs("<script type=\"module\">", p->stream);
  put_all(p->stream, page_script);
  fputs("</script>\n</body>\n</html>\n", p->stream);
  return status;
}

scree_status scree_page_write(const char *const *folders, size_t folder_count, const char *path,
                              bool overwrite, scree_error *error) {
  page p = {.error = error};
  name_list found = {0};
  scree_output output;
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < folder_count && status == SCREE_OK; i++)
    status = find_results(&p, folders[i], &found);
  if (status == SCREE_OK) status = scree_output_open(path, overwrite, &output, error);
  if (status == SCREE_OK) {
    p.stream = output.stream;
    status = put_page(&p, &found);
    if (status == SCREE_OK)
      status = scree_output_commit(&output, error);
    else
      scree_output_discard(&output);
  }
  for (size_t i = 0; i < p.parts.count; i++) scree_free(p.parts.items[i].path);
  scree_free(p.parts.items);
  free_names(&found);
  return status;
}
